//! World methods for movers: creation, control, queries.

use super::obstacle::{Surroundings, gather};
use super::{Bearer, Mover, MoverDef, MoverGround};
use crate::body::material::Material;
use crate::body::shape::Filter;
use crate::id::{MoverId, ShapeId};
use crate::world::World;
use sinew_math::Vec3;

impl World {
    /// Adds a mover. It moves from the next step on.
    ///
    /// # Panics
    /// If [`MoverDef::check`] rejects the definition.
    pub fn add_mover(&mut self, def: &MoverDef) -> MoverId {
        if let Err(what) = def.check() {
            panic!("{what}");
        }
        self.movers.all.insert(Mover::new(def))
    }

    /// Removes a mover.
    #[track_caller]
    pub fn remove_mover(&mut self, id: MoverId) {
        self.movers.all.take(id);
        for (_, mover) in self.movers.all.iter_mut() {
            if mover.ground.is_some_and(|footing| footing.on == Bearer::Mover(id)) {
                mover.leave_ground();
            }
        }
    }

    /// Returns a mover.
    #[track_caller]
    pub fn mover(&self, id: MoverId) -> &Mover {
        self.movers.all.expect(id)
    }

    /// True if the id names an existing mover.
    pub fn contains_mover(&self, id: MoverId) -> bool {
        self.movers.all.get(id).is_some()
    }

    /// Iterates over the ids of all movers, by index.
    pub fn mover_ids(&self) -> impl Iterator<Item = MoverId> {
        self.movers.all.ids()
    }

    /// Returns the ground under a mover; `None` in the air and on steep slopes.
    #[track_caller]
    pub fn mover_ground(&self, id: MoverId) -> Option<MoverGround> {
        let footing = self.mover(id).ground?;
        let (shape, mover) = match footing.on {
            Bearer::Shape { body, shape } => (Some(ShapeId { body, shape }), None),
            Bearer::Mover(mover) => (None, Some(mover)),
        };
        let material = shape.map_or(Material::DEFAULT, |shape| self.material(shape));
        let super::Footing { point, normal, velocity, .. } = footing;
        Some(MoverGround { shape, mover, point, normal, velocity, material })
    }

    /// Sets a mover's walking velocity, m/s, relative to the ground; its vertical component has no effect.
    #[track_caller]
    pub fn set_mover_walk(&mut self, id: MoverId, velocity: Vec3) {
        assert!(velocity.is_finite(), "a velocity must be finite, not {velocity:?} ({id:?})");
        self.expect_mover(id).walk = velocity;
    }

    /// Throws a mover: it leaves the ground with this world velocity, m/s.
    #[track_caller]
    pub fn set_mover_velocity(&mut self, id: MoverId, velocity: Vec3) {
        assert!(velocity.is_finite(), "a velocity must be finite, not {velocity:?} ({id:?})");
        let mover = self.expect_mover(id);
        mover.ground = None;
        mover.velocity = velocity;
    }

    /// Makes a mover jump in the next step with this upward speed, m/s, relative to the ground, if ground supports the
    /// mover then. The mover rises by `speed² / 2g`.
    #[track_caller]
    pub fn mover_jump(&mut self, id: MoverId, speed: f32) {
        assert!(
            (0.0..f32::INFINITY).contains(&speed),
            "the speed of a jump is finite and not negative, not {speed:?} ({id:?})"
        );
        self.expect_mover(id).jump = speed;
    }

    /// Teleports a mover's feet to a position, at rest, without a sweep.
    #[track_caller]
    pub fn set_mover_position(&mut self, id: MoverId, position: Vec3) {
        assert!(position.is_finite(), "a mover's position must be finite, not {position:?} ({id:?})");
        let mover = self.expect_mover(id);
        (mover.position, mover.previous) = (position, position);
        (mover.ground, mover.velocity) = (None, Vec3::ZERO);
    }

    /// Changes a mover's height, keeping its feet. Returns false and changes nothing if there is no space to grow.
    ///
    /// # Panics
    /// If the height is less than twice the radius, or not finite.
    #[track_caller]
    pub fn set_mover_height(&mut self, id: MoverId, height: f32) -> bool {
        let now = self.mover(id);
        let fits = height >= 2.0 * now.def.radius && height < f32::INFINITY;
        assert!(fits, "a mover's height is at least twice its radius, not {height} ({id:?})");
        if height > now.def.height && !self.has_room(id, height) {
            return false;
        }
        self.expect_mover(id).def.height = height;
        true
    }

    /// Sets the collision filter of a mover.
    #[track_caller]
    pub fn set_mover_filter(&mut self, id: MoverId, filter: Filter) {
        self.expect_mover(id).def.filter = filter;
    }

    /// True if no obstacle is in the space into which a mover would grow.
    #[track_caller]
    fn has_room(&self, id: MoverId, height: f32) -> bool {
        let mut grown = self.mover(id).clone();
        let old = grown.center();
        grown.def.height = height;
        let (center, skin) = (grown.center(), grown.def.skin);
        let bounds = Surroundings::new(&self.bodies, &[], &grown).bounds(center, Vec3::ZERO, skin);
        let mut obstacles = Vec::new();
        let all = &self.movers.all;
        gather(self, (all, all.iter().map(|(other, _)| other)), id.index, &bounds, &mut obstacles);
        let sight = Surroundings::new(&self.bodies, &obstacles, &grown);
        let low = Surroundings::new(&self.bodies, &obstacles, self.mover(id));
        // An obstacle that already touches the mover is allowed.
        obstacles.iter().all(|obstacle| {
            let distance = |sight: &Surroundings<'_>, center| {
                sight.gap(obstacle, center).map_or(skin, |gap| gap.distance)
            };
            let (before, after) = (distance(&low, old), distance(&sight, center));
            after >= 0.5 * skin || after >= before - 1e-4
        })
    }

    #[track_caller]
    fn expect_mover(&mut self, id: MoverId) -> &mut Mover {
        self.movers.all.expect_mut(id)
    }
}
