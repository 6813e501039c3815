//! Shapes placed in the frame in which a pair is examined, and the distances that the pairs share.

use sinew_math::{Transform, Vec3, clamp, max3, min3};

/// Plane with solid matter below it.
pub(super) struct Plane {
    /// Unit, out of the matter.
    pub normal: Vec3,
    /// Of the plane along the normal.
    pub offset: f32,
}

impl Plane {
    pub fn new(frame: &Transform) -> Self {
        let normal = frame.rotation * Vec3::Y;
        Self { normal, offset: normal.dot(frame.translation) }
    }

    /// Height of a point over the plane.
    pub fn height(&self, p: Vec3) -> f32 {
        p.dot(self.normal) - self.offset
    }
}

/// Ball.
pub(super) struct Ball {
    pub center: Vec3,
    pub radius: f32,
}

impl Ball {
    pub fn new(radius: f32, frame: &Transform) -> Self {
        Self { center: frame.translation, radius }
    }
}

/// Capsule: a core segment and a radius.
pub(super) struct Pill {
    pub core: Segment,
    /// Unit direction of the core, also where the core is a point.
    pub axis: Vec3,
    pub radius: f32,
}

impl Pill {
    pub fn new(half_height: f32, radius: f32, frame: &Transform) -> Self {
        let axis = frame.rotation * Vec3::Y;
        let reach = axis * half_height;
        let core = Segment { ends: [frame.translation - reach, frame.translation + reach] };
        Self { core, axis, radius }
    }
}

/// Box with any orientation.
pub(super) struct Obb {
    pub center: Vec3,
    /// Unit directions of its sides.
    pub axes: [Vec3; 3],
    pub half: Vec3,
}

impl Obb {
    pub fn new(half: Vec3, frame: &Transform) -> Self {
        let m = frame.rotation.to_mat3();
        Self { center: frame.translation, axes: [m.x_axis, m.y_axis, m.z_axis], half }
    }

    /// Coordinates of a direction along the box's axes.
    pub fn local_vector(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.axes[0]), v.dot(self.axes[1]), v.dot(self.axes[2]))
    }

    /// Coordinates of a point in the box's frame.
    pub fn local_point(&self, p: Vec3) -> Vec3 {
        self.local_vector(p - self.center)
    }

    /// From the box's frame to the frame of the pair.
    pub fn vector(&self, v: Vec3) -> Vec3 {
        self.axes[0] * v.x + self.axes[1] * v.y + self.axes[2] * v.z
    }

    /// From the box's frame to the frame of the pair.
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.center + self.vector(p)
    }

    /// Corner `index` in the box's frame: bit k set means the positive side of axis k.
    pub fn local_vertex(&self, index: usize) -> Vec3 {
        let side = |k: usize| if index >> k & 1 == 1 { self.half[k] } else { -self.half[k] };
        Vec3::new(side(0), side(1), side(2))
    }

    /// Corner `index` in the frame of the pair.
    pub fn vertex(&self, index: usize) -> Vec3 {
        self.point(self.local_vertex(index))
    }

    /// The corner furthest along `direction`.
    pub fn support(&self, direction: Vec3) -> usize {
        let d = self.local_vector(direction);
        usize::from(d.x > 0.0) | usize::from(d.y > 0.0) << 1 | usize::from(d.z > 0.0) << 2
    }

    /// The box's point closest to `p`; `p` itself if it is inside.
    pub fn closest(&self, p: Vec3) -> Vec3 {
        let local = self.local_point(p);
        self.point(max3(min3(local, self.half), -self.half))
    }

    /// Half of the box's width along the unit vector `n`.
    pub fn half_width(&self, n: Vec3) -> f32 {
        let d = self.local_vector(n);
        self.half.x * d.x.abs() + self.half.y * d.y.abs() + self.half.z * d.z.abs()
    }

    /// Shortest half side.
    pub fn thinnest(&self) -> f32 {
        sinew_math::min(sinew_math::min(self.half.x, self.half.y), self.half.z)
    }

    /// The face whose normal is closest to `direction`: its axis and side.
    pub fn facing(&self, direction: Vec3) -> (usize, f32) {
        let d = self.local_vector(direction);
        let axis = largest_axis(d);
        (axis, sign(d[axis]))
    }
}

/// The index of the component of largest magnitude; the lowest one among equals.
pub(super) fn largest_axis(v: Vec3) -> usize {
    let mut best = 0;
    for k in 1..3 {
        if v[k].abs() > v[best].abs() {
            best = k;
        }
    }
    best
}

/// −1 for negative numbers, else 1.
pub(super) fn sign(x: f32) -> f32 {
    if x < 0.0 { -1.0 } else { 1.0 }
}

/// Unit direction of the offset between two cores whose radii add up to `radii`, or `fallback` if the cores touch:
/// then the offset is rounding.
pub(super) fn direction_or(offset: Vec3, radii: f32, fallback: Vec3) -> Vec3 {
    let length = offset.length();
    if length > 1e-3 * radii { offset / length } else { fallback }
}

/// Line segment; its ends may coincide.
#[derive(Clone, Copy)]
pub(super) struct Segment {
    pub ends: [Vec3; 2],
}

impl Segment {
    /// Point at parameter `t`, 0..=1.
    pub fn at(&self, t: f32) -> Vec3 {
        self.ends[0] + (self.ends[1] - self.ends[0]) * t
    }

    /// Parameter of the point closest to `p`, 0..=1.
    pub fn closest(&self, p: Vec3) -> f32 {
        let d = self.ends[1] - self.ends[0];
        let length_squared = d.dot(d);
        if length_squared > f32::MIN_POSITIVE {
            clamp((p - self.ends[0]).dot(d) / length_squared, 0.0, 1.0)
        } else {
            0.5
        }
    }

    /// Parameters of the closest points of two segments (Ericson 2005, §5.1.9). For parallel segments, one of the
    /// closest pairs.
    pub fn closest_to_segment(&self, other: &Self) -> (f32, f32) {
        let (d1, d2) = (self.ends[1] - self.ends[0], other.ends[1] - other.ends[0]);
        let r = self.ends[0] - other.ends[0];
        let (a, e, f) = (d1.dot(d1), d2.dot(d2), d2.dot(r));
        if e <= f32::MIN_POSITIVE {
            return (self.closest(other.ends[0]), 0.5);
        }
        if a <= f32::MIN_POSITIVE {
            return (0.5, other.closest(self.ends[0]));
        }
        let (b, c) = (d1.dot(d2), d1.dot(r));
        // a e sin²: by the cross product, since a e − b² cancels for long near-parallel segments.
        let cross = d1.cross(d2);
        let denominator = cross.dot(cross);
        let s =
            if denominator > 1e-12 * a * e { clamp((b * f - c * e) / denominator, 0.0, 1.0) } else { 0.5 };
        let t = clamp((b * s + f) / e, 0.0, 1.0);
        (self.closest(other.at(t)), t)
    }
}
