//! One box against many points.

use crate::boxes::Obb;
use sinew_math::Vec3;
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::{Block, Blocks, LaneMask, Lanes, Real, Vector3, WIDTH};

/// Points, stored in groups of eight.
#[derive(Clone, Debug, Default)]
pub struct Points(Blocks<3>);

impl Points {
    /// Creates an empty list.
    pub fn new() -> Self {
        Self::default()
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// True if there are no points.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Adds a point at the end, metres.
    pub fn push(&mut self, point: Vec3) {
        self.0.push(point.to_array());
    }

    /// Point `index`, metres.
    ///
    /// # Panics
    /// If the index is out of range.
    pub fn get(&self, index: usize) -> Vec3 {
        Vec3::from_array(self.0.get(index))
    }

    /// Removes all points and keeps the memory.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}

impl Extend<Vec3> for Points {
    fn extend<I: IntoIterator<Item = Vec3>>(&mut self, points: I) {
        self.0.extend(points.into_iter().map(|point| point.to_array()));
    }
}

impl FromIterator<Vec3> for Points {
    fn from_iter<I: IntoIterator<Item = Vec3>>(points: I) -> Self {
        let mut list = Self::new();
        list.extend(points);
        list
    }
}

impl From<&[Vec3]> for Points {
    fn from(points: &[Vec3]) -> Self {
        points.iter().copied().collect()
    }
}

impl Obb {
    /// Finds the points in the box or on its surface. Bit `k` of `inside[i]` is set if point `8 i + k` is inside; bits
    /// beyond the last point are 0. A point with NaN is outside.
    ///
    /// # Panics
    /// If `inside` does not have one byte for every eight points, rounded up.
    pub fn contains_points(&self, points: &Points, inside: &mut [u8]) {
        dispatch::run(ContainsPoints { obb: self, points, inside });
    }

    /// Computes each point's distance from the box's surface, metres, negative inside. The distance is exact except for
    /// rounding, up to 1e19 m; it is NaN for a point with NaN.
    ///
    /// # Panics
    /// If `distances` is not as long as `points`.
    pub fn signed_distances(&self, points: &Points, distances: &mut [f32]) {
        dispatch::run(SignedDistances { obb: self, points, distances });
    }
}

/// A box with its axes computed, repeated in every lane.
struct Placed<R> {
    center: Vector3<R>,
    /// Unit vectors along the box's axes.
    axes: [Vector3<R>; 3],
    half: Vector3<R>,
}

impl<R: Real> Placed<R> {
    #[inline(always)]
    fn new(obb: &Obb) -> Self {
        let m = obb.rotation.to_mat3();
        Self {
            center: Vector3::splat(obb.center),
            axes: [Vector3::splat(m.x_axis), Vector3::splat(m.y_axis), Vector3::splat(m.z_axis)],
            half: Vector3::splat(obb.half_extents),
        }
    }

    /// Absolute coordinates of a point along the axes of the box, from the centre.
    #[inline(always)]
    fn aside(&self, point: Vector3<R>) -> Vector3<R> {
        let offset = point - self.center;
        let [x, y, z] = self.axes;
        Vector3::new(offset.dot(x), offset.dot(y), offset.dot(z)).abs()
    }

    #[inline(always)]
    fn contains(&self, point: Vector3<R>) -> R::Mask {
        let aside = self.aside(point);
        R::le(aside.x, self.half.x) & R::le(aside.y, self.half.y) & R::le(aside.z, self.half.z)
    }

    /// Returns the signed distance: outside, the length of the excess beyond the faces; inside, minus the distance to
    /// the nearest face.
    #[inline(always)]
    fn signed_distance(&self, point: Vector3<R>) -> R {
        let zero = R::splat(0.0);
        let beyond = self.aside(point) - self.half;
        // `max` returns its second argument if one is NaN, so in this order NaN propagates in each component.
        let outside = Vector3::new(R::max(zero, beyond.x), R::max(zero, beyond.y), R::max(zero, beyond.z));
        let nearest = R::max(R::max(beyond.x, beyond.y), beyond.z);
        outside.length() + R::min(nearest, zero)
    }
}

/// Kernel of [`Obb::contains_points`], for callers that choose the SIMD type.
#[derive(Debug)]
pub struct ContainsPoints<'a> {
    /// The box.
    pub obb: &'a Obb,
    /// Points to test.
    pub points: &'a Points,
    /// Output: one byte for every eight points.
    pub inside: &'a mut [u8],
}

impl Kernel for ContainsPoints<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let obb = Placed::<L>::new(self.obb);
        let blocks = self.points.0.blocks();
        assert_eq!(self.inside.len(), blocks.len(), "`inside` must have one byte for every eight points");
        for (Block(rows), inside) in blocks.iter().zip(&mut *self.inside) {
            *inside = obb.contains(load(rows)).bits();
        }
        if let (tail @ 1.., Some(last)) = (self.points.len() % WIDTH, self.inside.last_mut()) {
            *last &= (1 << tail) - 1;
        }
    }
}

/// Kernel of [`Obb::signed_distances`], for callers that choose the SIMD type.
#[derive(Debug)]
pub struct SignedDistances<'a> {
    /// The box.
    pub obb: &'a Obb,
    /// Points whose distances are computed.
    pub points: &'a Points,
    /// Output: one distance per point, metres.
    pub distances: &'a mut [f32],
}

impl Kernel for SignedDistances<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let obb = Placed::<L>::new(self.obb);
        let blocks = self.points.0.blocks();
        assert_eq!(
            self.distances.len(),
            self.points.len(),
            "`distances` must have one distance for every point"
        );
        let (whole, tail) = self.distances.as_chunks_mut::<WIDTH>();
        for (Block(rows), distances) in blocks.iter().zip(&mut *whole) {
            obb.signed_distance(load(rows)).store(distances);
        }
        if let Some(Block(rows)) = blocks.get(whole.len()) {
            let mut distances = [0.0; WIDTH];
            obb.signed_distance(load(rows)).store(&mut distances);
            tail.copy_from_slice(&distances[..tail.len()]);
        }
    }
}

#[inline(always)]
fn load<L: Lanes>([x, y, z]: &[[f32; WIDTH]; 3]) -> Vector3<L> {
    Vector3::load(x, y, z)
}
