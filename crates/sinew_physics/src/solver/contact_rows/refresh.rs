//! Recomputes the contact of two fast-turning bodies within the step.

use super::ManifoldRows;
use super::bounce::Approach;
use super::placed::{PlacedShape, found_anew, margin};
use crate::collide::Manifold;
use crate::contact::{ContactMemory, PointImpulse};
use crate::convex::support::{Core, Posed, wide};
use crate::solver::body::{SolverBody, advance};
use crate::solver::tuning::PREDICTED_DEPTH;
use crate::spatial::{Vec6, angular, linear};
use sinew_math::{Transform, Vec3, max, min};

/// Angle by which a body turns within a substep, radians.
fn turn(velocities: &[Vec6], body: u32, h: f32) -> f32 {
    angular(&velocities[body as usize]).length() * h
}

impl ManifoldRows {
    /// Recomputes the contact if a body turned fast in this substep: the points of the step's beginning do not include a corner that swings
    /// in. Matches impulses by feature. A pair that has separated keeps its rows.
    pub fn refresh_points(&mut self, bodies: &[SolverBody], velocities: &[Vec6], h: f32) {
        if self.turns(velocities, h)
            && let Some(manifold) = self.found_anew(self.poses(bodies), self.margin(velocities, h))
        {
            self.go_on_with(manifold, self.poses(bodies));
        }
    }

    /// Predicts the contact at the poses to which the velocities of this substep lead. Points without rows may come into contact there, and
    /// would penetrate deeply before they are detected. In that case the predicted manifold replaces the present one, shifted along a
    /// straight line to the present poses, and the caller computes its responses. Returns true if it was replaced.
    pub fn predict_points(&mut self, bodies: &[SolverBody], velocities: &[Vec6], h: f32) -> bool {
        if !self.turns(velocities, h) {
            return false;
        }
        let poses =
            [self.a, self.b].map(|body| advance(&bodies[body as usize].pose, &velocities[body as usize], h));
        let deepest = |separations: &mut dyn Iterator<Item = f32>| separations.fold(0.0, min);
        let least = deepest(&mut self.separation[..self.count].iter().copied()) - PREDICTED_DEPTH;
        if self.apart_along_normal(poses) > least {
            return false;
        }
        let Some(manifold) = self.found_anew(poses, self.margin(velocities, h)) else { return false };
        if deepest(&mut manifold.points().iter().map(|point| point.separation)) > least {
            return false;
        }
        self.go_on_with(manifold, poses);
        self.place(poses);
        for i in 0..self.count {
            let rate = self.rows[i].rate(self.pair(), velocities);
            self.separation[i] -= rate * h;
            self.approach[i] = Approach { rate, gap: max(self.separation[i], 0.0), pull: 0.0 };
        }
        true
    }

    /// Gap of the shapes along the present normal with the bodies at these poses, metres: at most the gap along the best separating axis.
    fn apart_along_normal(&self, poses: [Transform; 2]) -> f32 {
        let origin = poses[1].translation;
        let extent = |end: usize, core: Vec3, direction: Vec3| {
            let PlacedShape { shape, principal_from_shape } = &self.shapes[end];
            match Core::of(shape) {
                Some(solid) => {
                    let frame = poses[end] * *principal_from_shape;
                    Posed::new(&solid, &frame, origin).extent(wide(direction)) as f32
                }
                // The other side is a plane or a face.
                None => (poses[end].point(core) - origin).dot(direction),
            }
        };
        -extent(0, self.core_a[0], self.normal) - extent(1, self.core_b[0], -self.normal)
    }

    /// Returns true if a body turns so fast in this substep that other points come into contact.
    fn turns(&self, velocities: &[Vec6], h: f32) -> bool {
        [self.a, self.b].iter().any(|&body| turn(velocities, body, h) >= self.most_turn)
    }

    /// Largest separation of points that may touch within this substep, metres.
    fn margin(&self, velocities: &[Vec6], h: f32) -> f32 {
        let relative = linear(&velocities[self.b as usize]) - linear(&velocities[self.a as usize]);
        let turns = [self.a, self.b].map(|body| turn(velocities, body, h));
        let [a, b] = &self.shapes;
        margin(&[a.placed(), b.placed()], turns, relative.length() * h, self.slop)
    }

    /// Replaces the manifold by one that was computed at these poses. Matches impulses by feature.
    fn go_on_with(&mut self, manifold: Manifold, poses: [Transform; 2]) {
        let impulse = self.impulse.map(|now| PointImpulse { now, ..PointImpulse::default() });
        let of_substep = ContactMemory { points: impulse, ..self.memory }.matched(&self.manifold, &manifold);
        self.memory = self.memory.matched(&self.manifold, &manifold);
        let mean = self.rebound[..self.count].iter().sum::<f32>() / self.count as f32;
        let (was, rebound) = (self.manifold, self.rebound);
        for (i, point) in manifold.points().iter().enumerate() {
            let known = was.points().iter().position(|p| p.feature == point.feature);
            self.rebound[i] = known.map_or(mean, |k| rebound[k]);
            self.impulse[i] = of_substep.points[i].now;
        }
        (self.manifold, self.is_new) = (manifold, true);
        self.take_manifold(poses);
    }

    /// Recomputes the contact at these poses; `None` if the shapes are apart.
    fn found_anew(&self, poses: [Transform; 2], margin: f32) -> Option<Manifold> {
        let [a, b] = &self.shapes;
        let on_surfaces = [poses[0].point(self.core_a[0]), poses[1].point(self.core_b[0])];
        found_anew([a.placed(), b.placed()], poses, margin, &self.manifold, on_surfaces)
    }
}
