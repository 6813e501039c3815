//! Keeps trunk, hands and feet of an animated character out of the walls beside it.
//!
//! Rays from pelvis, hips and shoulders to the outermost points of each part find the wall, and the part moves out
//! along the wall's horizontal normal.

use super::clearance::{MOVABLE, spread};
use super::{CharacterDef, ground};
use crate::character::tuning::{PROBES_APART, PULLED_BACK, RETURNS, STEEPEST_TREAD};
use sinew_anim::LocalTransform;
use sinew_math::{Affine, Transform, Vec3, max, min, normalize_or};
use sinew_physics::ray::Ray;
use sinew_physics::{BodyKinds, QueryFilter, World};

/// Largest number of points of a part that are tested.
const MOST_POINTS: usize = 2;

/// Displacements of trunk, feet and hands out of walls, world, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct WallOffsets(pub [Vec3; MOVABLE]);

impl WallOffsets {
    pub fn are_zero(&self) -> bool {
        *self == Self::default()
    }

    /// Advances the displacements by a step; `model` is the pose without them, in character space. If `steps` is true,
    /// the feet step onto obstacles that are lower than the mover's highest step, so these are not walls for them.
    pub fn follow(
        &mut self,
        def: &CharacterDef,
        place: Transform,
        steps: bool,
        world: &World,
        model: &[Affine],
    ) {
        let dt = world.def().dt();
        let climbs = def.in_world.mover.as_ref().filter(|_| steps).map(|mover| mover.step_height);
        let least = place.translation.y + climbs.unwrap_or(f32::NEG_INFINITY);
        let mut palette = Vec::new();
        for (part, offset) in self.0.iter_mut().enumerate() {
            let ways = rays(def, part, model, &mut palette).map(|[from, to]| {
                let to = place.point(to);
                out_of_wall(world, place.point(from), Vec3 { y: max(to.y, least), ..to })
            });
            let need =
                ways.fold(Vec3::ZERO, |most, way| if way.length() > most.length() { way } else { most });
            let speed = if need.length() > offset.length() { PULLED_BACK } else { RETURNS };
            let change = need - *offset;
            *offset += change * min(speed * dt / max(change.length(), f32::MIN_POSITIVE), 1.0);
        }
    }

    /// Applies the displacements to the trunk and limbs of a pose; `place` is the character's transform.
    pub fn shift(
        &self,
        def: &CharacterDef,
        place: Transform,
        pose: &mut [LocalTransform],
        model: &mut Vec<Affine>,
    ) {
        if !self.are_zero() {
            let character_from_world = place.rotation.inverse();
            def.clearance().shift(def, self.0.map(|offset| character_from_world * offset), pose, model);
        }
    }
}

/// Returns rays from the inner end of a part to its outermost points, each as start and end in the space of `model`.
fn rays<'a>(
    def: &CharacterDef,
    part: usize,
    model: &[Affine],
    palette: &'a mut Vec<Affine>,
) -> impl Iterator<Item = [Vec3; 2]> + 'a {
    let from = def.clearance().origin(&def.ragdoll, part).map(|joint| model[joint].translation);
    let rays = from.map_or_else(Vec::new, |from| {
        let places = def.clearance().places(part, model, palette);
        let far = |point: Vec3| (point - from).length_squared();
        let points = spread(places, PROBES_APART * def.ragdoll.height, MOST_POINTS, far);
        points.into_iter().map(|point| [from, point]).collect()
    });
    rays.into_iter()
}

/// Returns the horizontal displacement of `to` out of the wall that a ray from `from` to `to` enters; zero if it enters
/// none.
fn out_of_wall(world: &World, from: Vec3, to: Vec3) -> Vec3 {
    let ray = Ray { origin: from, direction: to - from };
    let hit =
        world.query().filter(QueryFilter::of(BodyKinds::STATIC)).accept(ground::pushes(world)).first(&ray);
    let Some(hit) = hit.filter(|hit| hit.start.is_none() && hit.normal.y.abs() < STEEPEST_TREAD) else {
        return Vec3::ZERO;
    };
    let out = normalize_or(Vec3 { y: 0.0, ..hit.normal }, Vec3::ZERO);
    out * (hit.point - to).dot(out)
}
