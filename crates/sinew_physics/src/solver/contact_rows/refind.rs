//! The contact of two bodies that turn fast is looked for again within the step.

use super::ManifoldRows;
use super::bounce::Approach;
use crate::body::shape::Shape;
use crate::collide::{Half, Manifold, collide, is_on_face, name_as_face};
use crate::contact::{ContactMemory, PointImpulse};
use crate::convex::support::{Core, Posed, wide};
use crate::solver::tuning::{FAR_CORNER, FLAT_SINE, FORESEEN_DEPTH, LYING_SINE};
use crate::solver::{SolverBody, advance};
use crate::spatial::{Vec6, angular, linear};
use sinew_math::{Rotation, Transform, Vec3, max, min};

/// One of the two shapes of a manifold.
#[derive(Clone, Debug)]
pub(crate) struct PlacedShape {
    pub shape: Shape,
    pub principal_from_shape: Transform,
}

impl PlacedShape {
    pub fn new(shape: Shape, principal_from_shape: Transform) -> Self {
        Self { shape, principal_from_shape }
    }

    pub(super) fn placed(&self) -> Placed<'_> {
        Placed { shape: &self.shape, principal_from_shape: &self.principal_from_shape }
    }
}

/// A shape in the principal frame of its body.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct Placed<'a> {
    pub shape: &'a Shape,
    pub principal_from_shape: &'a Transform,
}

impl Placed<'_> {
    /// True if any part of the shape has a rounding or a rim.
    pub fn is_curved(&self) -> bool {
        !matches!(
            self.shape,
            Shape::Box { .. } | Shape::Hull(_) | Shape::HalfSpace | Shape::Mesh(_) | Shape::HeightField(_)
        )
    }

    /// Radius of the rounding around its core where it meets a normal (in the principal frame); 0 of what has corners.
    pub fn round(&self, normal: Vec3) -> f32 {
        match *self.shape {
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

    /// True if it meets a normal (in the principal frame) with a curved part that [`Self::round`] does not cover: as it rolls,
    /// other points come down.
    pub fn has_rim(&self, normal: Vec3) -> bool {
        let axis = || self.principal_from_shape.rotation * Vec3::Y;
        match *self.shape {
            Shape::Cylinder { .. } => self.round(normal) == 0.0 && axis().cross(normal).length() > FLAT_SINE,
            Shape::Cone { .. } => axis().cross(normal).length() > FLAT_SINE,
            Shape::TaperedCapsule { radius_bottom, radius_top, .. } => radius_bottom != radius_top,
            _ => false,
        }
    }
}

/// Angle through which a body turns within a substep, radians.
fn turn(velocities: &[Vec6], body: u32, h: f32) -> f32 {
    angular(&velocities[body as usize]).length() * h
}

impl ManifoldRows {
    /// Looks for the contact anew if a body turned fast in this substep: the points of the step's beginning say nothing
    /// of the corner that swings in. Impulses go on by feature. A pair that has come apart keeps its rows.
    pub fn refind(&mut self, bodies: &[SolverBody], velocities: &[Vec6], h: f32) {
        if self.turns(velocities, h)
            && let Some(manifold) = self.found_anew(self.poses(bodies), self.margin(velocities, h))
        {
            self.go_on_with(manifold, self.poses(bodies));
        }
    }

    /// Looks where the velocities of this substep lead to: points that its rows do not know may come down there, and would be
    /// in by far before they are found. Then it takes the contact there, as if it had come that way along a straight line; the
    /// caller computes its responses. Gives whether it did.
    pub fn predict_points(&mut self, bodies: &[SolverBody], velocities: &[Vec6], h: f32) -> bool {
        if !self.turns(velocities, h) {
            return false;
        }
        let poses =
            [self.a, self.b].map(|body| advance(&bodies[body as usize].pose, &velocities[body as usize], h));
        let deepest = |separations: &mut dyn Iterator<Item = f32>| separations.fold(0.0, min);
        let least = deepest(&mut self.separation[..self.count].iter().copied()) - FORESEEN_DEPTH;
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

    /// Gap of the shapes along the present normal if the bodies are at these poses, metres: no more than along the normal that
    /// parts them best.
    fn apart_along_normal(&self, poses: [Transform; 2]) -> f32 {
        let origin = poses[1].translation;
        let extent = |end: usize, core: Vec3, direction: Vec3| {
            let PlacedShape { shape, principal_from_shape } = &self.shapes[end];
            match Core::of(shape) {
                Some(solid) => {
                    let frame = poses[end] * *principal_from_shape;
                    Posed::new(&solid, &frame, origin).extent(wide(direction)) as f32
                }
                // A plane, or a face.
                None => (poses[end].point(core) - origin).dot(direction),
            }
        };
        -extent(0, self.core_a[0], self.normal) - extent(1, self.core_b[0], -self.normal)
    }

    /// True if a body turns so fast in this substep that other points come down.
    fn turns(&self, velocities: &[Vec6], h: f32) -> bool {
        [self.a, self.b].iter().any(|&body| turn(velocities, body, h) >= self.most_turn)
    }

    /// Largest separation of points that this substep may bring together, metres.
    fn margin(&self, velocities: &[Vec6], h: f32) -> f32 {
        let relative = linear(&velocities[self.b as usize]) - linear(&velocities[self.a as usize]);
        let turns = [self.a, self.b].map(|body| turn(velocities, body, h));
        let [a, b] = &self.shapes;
        margin(&[a.placed(), b.placed()], turns, relative.length() * h, self.slop)
    }

    /// Takes a manifold that was found at these poses. Impulses go on by feature.
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

    /// The contact at these poses, if there is one.
    fn found_anew(&self, poses: [Transform; 2], margin: f32) -> Option<Manifold> {
        let [a, b] = &self.shapes;
        let on_surfaces = [poses[0].point(self.core_a[0]), poses[1].point(self.core_b[0])];
        found_anew([a.placed(), b.placed()], poses, margin, &self.manifold, on_surfaces)
    }
}

/// Margin of two shapes, metres: the largest separation of points that a substep may bring together in which the bodies turn by
/// `turns` radians and approach by `approach` metres.
pub(in crate::solver) fn margin(shapes: &[Placed<'_>; 2], turns: [f32; 2], approach: f32, slop: f32) -> f32 {
    let [a, b] = shapes.map(|placed| placed.shape.bounding_radius());
    let reach = a * turns[0] + b * turns[1];
    let turning = if reach < f32::INFINITY { reach } else { 0.0 };
    max(4.0 * slop + approach + turning, FAR_CORNER * min(a, b))
}

/// The contact of two shapes at these poses, if there is one. Of a surface the plane stands that the manifold known so far lies on,
/// through `on_surfaces` of A or B: the surface itself would answer for all its manifolds at once. What lies on its edges stays as it
/// was found.
pub(in crate::solver) fn found_anew(
    [a, b]: [Placed<'_>; 2],
    poses: [Transform; 2],
    margin: f32,
    known: &Manifold,
    on_surfaces: [Vec3; 2],
) -> Option<Manifold> {
    static PLANE: Shape = Shape::HalfSpace;
    let frames = [poses[0] * *a.principal_from_shape, poses[1] * *b.principal_from_shape];
    let plane = |origin: Vec3, normal: Vec3| Transform::new(origin, Rotation::from_arc(Vec3::Y, normal));
    let mut manifold = Manifold::default();
    let surface = match (a.shape.surface(), b.shape.surface()) {
        (None, None) => {
            collide(a.shape, &frames[0], b.shape, &frames[1], margin, &mut manifold);
            return (manifold.count > 0).then_some(manifold);
        }
        (Some(_), _) => Half::OfA,
        _ => Half::OfB,
    };
    if !is_on_face(known, surface) {
        return None;
    }
    match surface {
        Half::OfA => {
            let ground = plane(on_surfaces[0], known.normal);
            collide(&PLANE, &ground, b.shape, &frames[1], margin, &mut manifold);
        }
        Half::OfB => {
            let ground = plane(on_surfaces[1], -known.normal);
            collide(a.shape, &frames[0], &PLANE, &ground, margin, &mut manifold);
        }
    }
    name_as_face(&mut manifold, surface);
    (manifold.count > 0).then_some(manifold)
}
