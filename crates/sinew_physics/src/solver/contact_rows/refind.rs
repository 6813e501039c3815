//! The contact of two bodies that turn fast is looked for again within the step.

use super::ManifoldRows;
use crate::collide::{Half, Manifold, collide, is_on_face, name_as_face};
use crate::contact::{ContactMemory, PointImpulse};
use crate::shape::Shape;
use crate::solver::SolverBody;
use crate::spatial::{Vec6, angular, linear};
use sinew_math::{Rotation, Transform, Vec3, max, min};

/// A body that turns by more than this within a substep has its contacts looked for anew, radians.
pub(super) const REFIND_TURN: f32 = 0.01;
/// Likewise where a rim rolls: however slowly, what pushes from where the rim was turns the body as much as it gyrates.
pub(super) const ROLL_TURN: f32 = 1e-4;
/// Then points this far apart count, as a share of the smaller bounding radius: a hand between thigh and floor that spins
/// off one corner meets the other within the substep.
const FAR_CORNER: f32 = 0.4;

/// One of the two shapes of a manifold.
#[derive(Clone, Debug)]
pub(crate) struct PlacedShape {
    pub shape: Shape,
    pub principal_from_shape: Transform,
}

/// A cylinder whose axis leans by less than this sine against the plane across the normal lies on its side.
const LYING_SINE: f32 = 0.1;

/// One whose end leans by less than this sine stands on it.
const FLAT_SINE: f32 = 0.01;

impl PlacedShape {
    pub fn new(shape: Shape, principal_from_shape: Transform) -> Self {
        Self { shape, principal_from_shape }
    }

    /// Radius of the rounding around its core where it meets a normal (in the principal frame); 0 of what has corners.
    pub(super) fn round(&self, normal: Vec3) -> f32 {
        match self.shape {
            Shape::Sphere { radius } | Shape::Capsule { radius, .. } => radius,
            // The thinner end's: what a core is rounded by all around.
            Shape::TaperedCapsule { radius_bottom, radius_top, .. } => min(radius_bottom, radius_top),
            Shape::Cylinder { radius, .. } => {
                let axis = self.principal_from_shape.rotation * Vec3::Y;
                if axis.dot(normal).abs() < LYING_SINE { radius } else { 0.0 }
            }
            Shape::Box { .. }
            | Shape::Cone { .. }
            | Shape::Hull(_)
            | Shape::HalfSpace
            | Shape::Mesh(_)
            | Shape::HeightField(_) => 0.0,
        }
    }

    /// Whether it meets a normal (in the principal frame) with what is curved but not by [`Self::round`]: as it rolls, other
    /// points come down.
    pub(super) fn has_rim(&self, normal: Vec3) -> bool {
        let axis = || self.principal_from_shape.rotation * Vec3::Y;
        match self.shape {
            Shape::Cylinder { .. } => self.round(normal) == 0.0 && axis().cross(normal).length() > FLAT_SINE,
            Shape::Cone { .. } => axis().cross(normal).length() > FLAT_SINE,
            Shape::TaperedCapsule { radius_bottom, radius_top, .. } => radius_bottom != radius_top,
            _ => false,
        }
    }
}

impl ManifoldRows {
    /// Looks for the contact anew if a body turned fast in this substep: the points of the step's beginning say nothing
    /// of the corner that swings in. Impulses go on by feature. A pair that has come apart keeps its rows.
    pub fn refind(&mut self, bodies: &[SolverBody], velocities: &[Vec6], h: f32) {
        let turn = |body: u32| angular(&velocities[body as usize]).length() * h;
        if turn(self.a) < self.most_turn && turn(self.b) < self.most_turn {
            return;
        }
        let [a, b] = &self.shapes;
        let (pose_a, pose_b) = (bodies[self.a as usize].pose, bodies[self.b as usize].pose);
        let relative = linear(&velocities[self.b as usize]) - linear(&velocities[self.a as usize]);
        let reach = a.shape.bounding_radius() * turn(self.a) + b.shape.bounding_radius() * turn(self.b);
        let turning = if reach < f32::INFINITY { reach } else { 0.0 };
        let far_corner = FAR_CORNER * min(a.shape.bounding_radius(), b.shape.bounding_radius());
        let margin = max(4.0 * self.slop + relative.length() * h + turning, far_corner);
        let frames = [pose_a * a.principal_from_shape, pose_b * b.principal_from_shape];
        let Some(manifold) = self.found_anew(frames, [pose_a, pose_b], margin) else { return };
        let impulse = self.impulse.map(|now| PointImpulse { now, ..PointImpulse::default() });
        let of_substep = ContactMemory { points: impulse, ..self.memory }.matched(&self.manifold, &manifold);
        let memory = self.memory.matched(&self.manifold, &manifold);
        let mean = self.rebound[..self.count].iter().sum::<f32>() / self.count as f32;
        let (was, rebound) = (self.manifold, self.rebound);
        for (i, point) in manifold.points().iter().enumerate() {
            let known = was.points().iter().position(|p| p.feature == point.feature);
            self.rebound[i] = known.map_or(mean, |k| rebound[k]);
            self.impulse[i] = of_substep.points[i].now;
        }
        self.memory = memory;
        self.manifold = manifold;
        self.take_manifold(bodies);
    }

    /// The contact at the present poses, if there is one. Of a surface the plane stands that the manifold lies on: the surface
    /// itself would answer for all its manifolds at once. What lies on its edges stays as it was found.
    fn found_anew(&self, frames: [Transform; 2], poses: [Transform; 2], margin: f32) -> Option<Manifold> {
        static PLANE: Shape = Shape::HalfSpace;
        let [a, b] = &self.shapes;
        let plane = |origin: Vec3, normal: Vec3| Transform::new(origin, Rotation::from_arc(Vec3::Y, normal));
        let mut manifold = Manifold::default();
        let surface = match (a.shape.surface(), b.shape.surface()) {
            (None, None) => {
                collide(&a.shape, &frames[0], &b.shape, &frames[1], margin, &mut manifold);
                return (manifold.count > 0).then_some(manifold);
            }
            (Some(_), _) => Half::OfA,
            _ => Half::OfB,
        };
        if !is_on_face(&self.manifold, surface) {
            return None;
        }
        match surface {
            Half::OfA => {
                let ground = plane(poses[0].point(self.core_a[0]), self.normal);
                collide(&PLANE, &ground, &b.shape, &frames[1], margin, &mut manifold);
            }
            Half::OfB => {
                let ground = plane(poses[1].point(self.core_b[0]), -self.normal);
                collide(&a.shape, &frames[0], &PLANE, &ground, margin, &mut manifold);
            }
        }
        name_as_face(&mut manifold, surface);
        (manifold.count > 0).then_some(manifold)
    }
}
