//! Explosions: their effect on the bodies and particles of a world.

use crate::body::def::BodyKind;
use crate::body::shape::Shape;
use crate::field::{Explosion, Form, Occlusion, Target};
use crate::id::BodyId;
use crate::query::{BodyKinds, QueryFilter};
use crate::ray::Ray;
use crate::world::World;
use sinew_math::Vec3;

impl World {
    /// Applies an explosion: the affected dynamic bodies and particles get their new velocity immediately, and wake.
    /// The next step reports impulses on kinematic bodies in [`Events::pushed`](crate::Events::pushed).
    ///
    /// # Panics
    /// If [`Explosion::check`] rejects the explosion.
    pub fn explode(&mut self, explosion: &Explosion) {
        if let Err(what) = explosion.check() {
            panic!("{what}");
        }
        let bodies: Vec<BodyId> = self.body_ids().filter(|&id| self.kind(id) != BodyKind::Static).collect();
        for id in bodies {
            for shape in 0..self.expect(id).shapes.len() {
                self.blast_shape(explosion, id, shape);
            }
        }
        let groups: Vec<_> = self.group_ids().collect();
        for id in groups {
            for particle in 0..self.particles(id).positions().len() {
                let target = Target::of_particle(self.particles(id), particle);
                let Form::Particle { radius, layers, .. } = target.form else { continue };
                let (impulse, to) = explosion.push(&Shape::Sphere { radius }, &target.pose);
                if layers & explosion.layers != 0 && !self.shelters(explosion, to) {
                    self.particles_mut(id).apply_impulse(particle as u32, impulse);
                }
            }
        }
    }

    fn blast_shape(&mut self, explosion: &Explosion, id: BodyId, shape: usize) {
        let body = self.expect(id);
        let s = &body.shapes[shape];
        let (impulse, point) = explosion.push(&s.shape, &body.world_from_shape(shape));
        let reached = body.surface(shape).filter.layers & explosion.layers != 0 && impulse != Vec3::ZERO;
        if reached && !self.shelters(explosion, point) {
            self.apply_impulse(id, impulse, point);
        }
    }

    fn shelters(&self, explosion: &Explosion, point: Vec3) -> bool {
        let ray = Ray { origin: explosion.center, direction: point - explosion.center };
        explosion.occlusion == Occlusion::Static
            && self.query().filter(QueryFilter::of(BodyKinds::STATIC)).any(&ray)
    }
}
