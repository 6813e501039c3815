//! Shapes placed in the world, and the contact between two such shapes.

use crate::body::shape::Shape;
use crate::collide::{Half, Manifold, collide, is_on_face, name_as_face};
use crate::solver::tuning::{FAR_CORNER, FLAT_SINE, LYING_SINE};
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

    /// Radius of the rounding around the shape's core in the direction of a normal (in the principal frame); 0 for shapes with corners.
    pub fn round(&self, normal: Vec3) -> f32 {
        match *self.shape {
            Shape::Sphere { radius } | Shape::Capsule { radius, .. } => radius,
            // Uses the radius of the thinner end, since the core is rounded by that radius on all sides.
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

    /// True if a curved part that [`Self::round`] does not cover faces a normal (in the principal frame): as the shape rolls, other points
    /// come into contact.
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

/// Margin of two shapes, metres: the largest separation of points that may touch within a substep in which the bodies turn by `turns`
/// radians and approach by `approach` metres.
pub(in crate::solver) fn margin(shapes: &[Placed<'_>; 2], turns: [f32; 2], approach: f32, slop: f32) -> f32 {
    let [a, b] = shapes.map(|placed| placed.shape.bounding_radius());
    let reach = a * turns[0] + b * turns[1];
    let turning = if reach < f32::INFINITY { reach } else { 0.0 };
    max(4.0 * slop + approach + turning, FAR_CORNER * min(a, b))
}

/// Recomputes the contact of two shapes at these poses; `None` if they are apart. A surface, or a ground solid that continues beside the
/// contact, is replaced by the plane of the known manifold through `on_surfaces` of A or B, since the surface itself would return all its
/// manifolds. Contacts on edges of a surface are not recomputed.
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
    let has_surface = a.shape.surface().is_some() || b.shape.surface().is_some();
    let Some(surface) = [Half::OfA, Half::OfB].into_iter().find(|half| is_on_face(known, *half)) else {
        if has_surface {
            return None;
        }
        collide(a.shape, &frames[0], b.shape, &frames[1], margin, &mut manifold);
        return (manifold.count > 0).then_some(manifold);
    };
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
