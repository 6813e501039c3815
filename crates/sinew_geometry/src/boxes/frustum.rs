//! View frustum: culling and picking.

use super::{Cuboid, PlacedBox, Sphere};
use crate::ray::{Ray, RayHit};
use sinew_math::{Transform, Vec2, Vec3, trig};

/// View frustum of a camera: a pyramid without its tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum {
    /// Frame of the camera: it looks along −z, x is right, y up.
    pub world_from_eye: Transform,
    /// Half width and half height of the view at a distance of 1 m, metres: tangents of half the field of view.
    pub slopes: Vec2,
    /// Distance of the near plane along the line of sight, metres, above 0.
    pub near: f32,
    /// Distance of the far plane along the line of sight, metres, above `near`.
    pub far: f32,
}

/// Position of a box or ball relative to a [`Frustum`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Visibility {
    /// The whole box is visible.
    Inside,
    /// A part is visible, or the test cannot rule that out.
    Intersects,
    /// No part is visible.
    Outside,
}

impl Frustum {
    /// Creates a frustum from the vertical angle of view (radians, above 0 and below π) and the ratio of the picture's
    /// width to its height.
    ///
    /// # Panics
    /// If a number is not finite or out of its range.
    pub fn new(world_from_eye: Transform, fov_y: f32, aspect: f32, near: f32, far: f32) -> Self {
        assert!(world_from_eye.is_finite(), "the frame of a camera must be finite");
        assert!(
            fov_y > 0.0 && fov_y < core::f32::consts::PI,
            "the angle of view must be above 0 and below π"
        );
        assert!(aspect > 0.0 && aspect < f32::INFINITY, "the aspect ratio must be positive and finite");
        assert!(
            near > 0.0 && near < far && far < f32::INFINITY,
            "0 < near < far must hold, with a finite far"
        );
        let slope = trig::tan(0.5 * fov_y);
        Self { world_from_eye, slopes: Vec2::new(slope * aspect, slope), near, far }
    }

    /// Returns the segment that a position in the picture covers, from the near plane to the far plane; use it for
    /// picking. x is −1 at the left edge and 1 at the right edge, y is −1 at the bottom and 1 at the top.
    pub fn ray(&self, screen: Vec2) -> Ray {
        let sight = Vec3::new(screen.x * self.slopes.x, screen.y * self.slopes.y, -1.0);
        Ray::between(
            self.world_from_eye.point(sight * self.near),
            self.world_from_eye.point(sight * self.far),
        )
    }

    /// Returns the eight corners. Of a corner's index, bit 0 is set on the right, bit 1 at the top, and bit 2 on the
    /// far plane.
    pub fn corners(&self) -> [Vec3; 8] {
        core::array::from_fn(|index| {
            let side = |k: usize| if index >> k & 1 == 1 { 1.0 } else { -1.0 };
            let Ray { origin, direction } = self.ray(Vec2::new(side(0), side(1)));
            if side(2) > 0.0 { origin + direction } else { origin }
        })
    }

    /// Classifies a box against the planes of the frustum (Assarsson & Möller 2000), and the frustum's corners against
    /// the faces of the box. Except for rounding, the result is never `Outside` if a part of the box is visible, and
    /// never `Inside` if a part is not. A box just outside an edge of the frustum may be reported as `Intersects`.
    pub fn sees(&self, cuboid: &impl Cuboid) -> Visibility {
        let placed = cuboid.placed();
        match self.across_planes(placed.center, |normal| placed.half_width(normal)) {
            Visibility::Intersects if self.is_beyond_a_face(&placed) => Visibility::Outside,
            visibility => visibility,
        }
    }

    /// Like [`sees`](Self::sees), for a ball; a ball just outside an edge or corner may be reported as `Intersects`.
    pub fn sees_sphere(&self, sphere: &Sphere) -> Visibility {
        self.across_planes(sphere.center, |_| sphere.radius)
    }

    /// Classifies a shape around `center` against the six planes. `reach` returns the shape's extent from the centre
    /// along a unit normal, metres.
    fn across_planes(&self, center: Vec3, reach: impl Fn(Vec3) -> f32) -> Visibility {
        let from_eye = center - self.world_from_eye.translation;
        let mut visibility = Visibility::Inside;
        for (normal, offset) in self.planes() {
            let (height, reach) = (normal.dot(from_eye) - offset, reach(normal));
            if height < -reach {
                return Visibility::Outside;
            }
            if height < reach {
                visibility = Visibility::Intersects;
            }
        }
        visibility
    }

    /// Returns each plane's inward unit normal, and its distance from the eye along that normal, metres.
    fn planes(&self) -> [(Vec3, f32); 6] {
        let Vec2 { x, y } = self.slopes;
        let side = |v: Vec3| (self.world_from_eye.rotation * v.normalize(), 0.0);
        let ahead = self.world_from_eye.rotation * Vec3::NEG_Z;
        [
            side(Vec3::new(1.0, 0.0, -x)),
            side(Vec3::new(-1.0, 0.0, -x)),
            side(Vec3::new(0.0, 1.0, -y)),
            side(Vec3::new(0.0, -1.0, -y)),
            (ahead, self.near),
            (-ahead, -self.far),
        ]
    }

    /// True if all corners of the frustum are beyond one face of the box.
    fn is_beyond_a_face(&self, placed: &PlacedBox) -> bool {
        let corners = self.corners().map(|p| placed.local_point(p));
        let beyond = |k: usize, side: f32| corners.iter().all(|q| q[k] * side > placed.half[k]);
        (0..3).any(|k| beyond(k, 1.0) || beyond(k, -1.0))
    }
}

/// Returns the index of the first box along a ray, and the hit. With a ray of [`Frustum::ray`], this is the object at a
/// position in the picture. Among equal hits the first box in the slice is returned.
pub fn pick<B: Cuboid>(boxes: &[B], ray: &Ray) -> Option<(usize, RayHit)> {
    let hits = boxes.iter().enumerate().filter_map(|(index, cuboid)| Some((index, cuboid.cast_ray(ray)?)));
    hits.reduce(|first, other| if other.1.fraction < first.1.fraction { other } else { first })
}
