//! Boxes with their axes computed: coordinates, corners, widths.

use sinew_math::{Transform, Vec3, max3, min, min3};

/// A box with its axes computed. Convert a box once to run many queries on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedBox {
    /// Centre, metres.
    pub center: Vec3,
    /// Unit vectors along the box's axes: the columns of the rotation's matrix.
    pub axes: [Vec3; 3],
    /// Half extents along the axes, metres, ≥ 0.
    pub half: Vec3,
}

impl PlacedBox {
    /// Creates a box around the origin of a frame, along the axes of the frame. `half` are its half extents, metres;
    /// they must be ≥ 0, which is not checked.
    pub fn new(half: Vec3, frame: &Transform) -> Self {
        let m = frame.rotation.to_mat3();
        Self { center: frame.translation, axes: [m.x_axis, m.y_axis, m.z_axis], half }
    }

    /// Converts a direction to coordinates along the box's axes.
    pub fn local_vector(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.axes[0]), v.dot(self.axes[1]), v.dot(self.axes[2]))
    }

    /// Converts a point to coordinates in the box's frame.
    pub fn local_point(&self, p: Vec3) -> Vec3 {
        self.local_vector(p - self.center)
    }

    /// Converts a vector from the box's frame to the space that contains the box.
    pub fn vector(&self, v: Vec3) -> Vec3 {
        self.axes[0] * v.x + self.axes[1] * v.y + self.axes[2] * v.z
    }

    /// Converts a point from the box's frame to the space that contains the box.
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.center + self.vector(p)
    }

    /// Corner `index` in the box's frame: bit k of the index is set on the positive side of axis k.
    pub(crate) fn local_vertex(&self, index: usize) -> Vec3 {
        let side = |k: usize| if index >> k & 1 == 1 { self.half[k] } else { -self.half[k] };
        Vec3::new(side(0), side(1), side(2))
    }

    /// Corner `index` in the space that contains the box.
    pub(crate) fn vertex(&self, index: usize) -> Vec3 {
        self.point(self.local_vertex(index))
    }

    /// Index of the corner furthest along `direction`.
    pub(crate) fn support(&self, direction: Vec3) -> usize {
        let d = self.local_vector(direction);
        usize::from(d.x > 0.0) | usize::from(d.y > 0.0) << 1 | usize::from(d.z > 0.0) << 2
    }

    /// Point of the box closest to `p`; `p` itself if it is inside.
    pub(crate) fn closest(&self, p: Vec3) -> Vec3 {
        let local = self.local_point(p);
        self.point(max3(min3(local, self.half), -self.half))
    }

    /// Half of the box's width along the unit vector `n`.
    pub(crate) fn half_width(&self, n: Vec3) -> f32 {
        let d = self.local_vector(n);
        self.half.x * d.x.abs() + self.half.y * d.y.abs() + self.half.z * d.z.abs()
    }

    /// Smallest half extent, metres.
    pub(crate) fn thinnest(&self) -> f32 {
        min(min(self.half.x, self.half.y), self.half.z)
    }

    /// Returns the face whose normal is closest to `direction`: the index of its axis, and 1 or −1 for its side.
    pub(crate) fn facing(&self, direction: Vec3) -> (usize, f32) {
        let d = self.local_vector(direction);
        let axis = largest_axis(d);
        (axis, sign(d[axis]))
    }
}

/// Index of the component with the largest absolute value; the lowest index among equals.
pub(crate) fn largest_axis(v: Vec3) -> usize {
    let mut best = 0;
    for k in 1..3 {
        if v[k].abs() > v[best].abs() {
            best = k;
        }
    }
    best
}

/// Sign of a number: −1 for negative numbers, otherwise 1.
pub(crate) fn sign(x: f32) -> f32 {
    if x < 0.0 { -1.0 } else { 1.0 }
}
