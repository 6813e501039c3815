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
    /// A part is visible, or the test could not decide.
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
        assert!(world_from_eye.is_finite(), "the place of an eye must be finite");
        assert!(fov_y > 0.0 && fov_y < core::f32::consts::PI, "an angle of view is above 0 and below π");
        assert!(aspect > 0.0 && aspect < f32::INFINITY, "a picture has a width and a height");
        assert!(near > 0.0 && near < far && far < f32::INFINITY, "the near plane is before the far one");
        let slope = trig::tan(0.5 * fov_y);
        Self { world_from_eye, slopes: Vec2::new(slope * aspect, slope), near, far }
    }

    /// Returns the segment under a position in the picture, from the near plane to the far one. x is −1 at the left
    /// edge and 1 at the right, y is −1 at the bottom and 1 at the top. For picking.
    pub fn ray(&self, screen: Vec2) -> Ray {
        let sight = Vec3::new(screen.x * self.slopes.x, screen.y * self.slopes.y, -1.0);
        Ray::between(
            self.world_from_eye.point(sight * self.near),
            self.world_from_eye.point(sight * self.far),
        )
    }

    /// Returns the corners: bit 0 of the index is set on the right, bit 1 at the top, bit 2 on the far plane.
    pub fn corners(&self) -> [Vec3; 8] {
        core::array::from_fn(|index| {
            let side = |k: usize| if index >> k & 1 == 1 { 1.0 } else { -1.0 };
            let Ray { origin, direction } = self.ray(Vec2::new(side(0), side(1)));
            if side(2) > 0.0 { origin + direction } else { origin }
        })
    }

    /// Returns the position of a box relative to the frustum, by the box's extent across each plane (Assarsson & Möller
    /// 2000), and by the frustum's corners beyond each face of the box. Never `Outside` if a part is visible, nor
    /// `Inside` if a part is not, except for rounding; a box just outside an edge may be reported as intersecting.
    pub fn sees(&self, cuboid: &impl Cuboid) -> Visibility {
        let placed = cuboid.placed();
        match self.across_planes(placed.center, |normal| placed.half_width(normal)) {
            Visibility::Intersects if self.is_beyond_a_face(&placed) => Visibility::Outside,
            visibility => visibility,
        }
    }

    /// [`sees`](Self::sees) for a ball.
    pub fn sees_sphere(&self, sphere: &Sphere) -> Visibility {
        self.across_planes(sphere.center, |_| sphere.radius)
    }

    /// Returns the visibility of a shape around `center` that extends by `reach` along a unit normal, metres.
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

    /// Returns the inward unit normals, and the offsets of the planes along them from the eye, metres.
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

/// Returns the index of the first box that a segment hits, and the hit: the object under a position in the picture,
/// with [`Frustum::ray`]. Among equal hits the first in the slice is returned.
pub fn pick<B: Cuboid>(boxes: &[B], ray: &Ray) -> Option<(usize, RayHit)> {
    let hits = boxes.iter().enumerate().filter_map(|(index, cuboid)| Some((index, cuboid.cast_ray(ray)?)));
    hits.reduce(|first, other| if other.1.fraction < first.1.fraction { other } else { first })
}
