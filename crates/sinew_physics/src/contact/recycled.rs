//! Recycled manifolds. While two bodies hardly move relative to each other, the same features touch. Then only the
//! separations are recomputed from points fixed in the bodies, along the normal of a face or across two edges.

use crate::body::shape::Shape;
use crate::body::{Body, BodyShape};
use crate::collide::{MAX_POINTS, Manifold, edge_directions};
use crate::contact::ContactKey;
use crate::contact::tuning::{RECYCLED_HALF_TURN, RECYCLED_SINE, RECYCLED_SLIP, SPECULATIVE_SLOPS};
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::{LaneMask, Lanes, Vector3, WIDTH};
use sinew_math::{ReadError, Reader, Rotation, Transform, Vec3, Writer, normalize_or};

/// Cosine above which a normal counts as that of a face, or as perpendicular to two edges.
const ON_FACE: f32 = 0.999_999;

/// A manifold as it was computed, in the frames of its bodies. Part of the state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Recycled {
    /// Number of points; zero if nothing is stored.
    count: usize,
    /// Rotation of B relative to A when the manifold was computed.
    a_from_b: Rotation,
    normal: Normal,
    /// Search distance of the points, metres.
    margin: f32,
    /// Slop of the two shapes, metres.
    slop: f32,
    /// Positions of the points on the surfaces of A and B, in their frames.
    places: Places,
}

/// Feature that the normal follows, in the frames of the bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Normal {
    /// Normal of a face of A (or of B).
    OfA(Vec3),
    OfB(Vec3),
    /// Normal perpendicular to an edge of A and an edge of B, both given as unit vectors.
    Across([Vec3; 2]),
}

impl Default for Normal {
    fn default() -> Self {
        Self::OfA(Vec3::ZERO)
    }
}

impl Normal {
    /// The feature that defines the normal of a manifold of boxes or hulls; `None` if it is neither a face nor two
    /// edges.
    fn find(shapes: [&BodyShape; 2], poses: [&Transform; 2], manifold: &Manifold) -> Option<Self> {
        let n = manifold.normal;
        let of_face = |side: usize, n: Vec3| {
            let shape_from_world =
                (poses[side].rotation * shapes[side].principal_from_shape.rotation).inverse();
            is_of_face(&shapes[side].shape, shape_from_world * n)
        };
        if of_face(0, n) {
            return Some(Self::OfA(poses[0].rotation.inverse() * n));
        }
        if of_face(1, -n) {
            return Some(Self::OfB(poses[1].rotation.inverse() * n));
        }
        let [point] = manifold.points() else { return None };
        let edges = edge_directions(shapes.map(|shape| &shape.shape), point.feature)?;
        let across = Self::Across(core::array::from_fn(|side| {
            normalize_or(shapes[side].principal_from_shape.rotation * edges[side], Vec3::ZERO)
        }));
        across.in_world(poses, n).filter(|across| across.dot(n) > ON_FACE).map(|_| across)
    }

    /// Normal at the current poses, world axes, on the previous side; `None` for nearly parallel edges.
    fn in_world(&self, poses: [&Transform; 2], before: Vec3) -> Option<Vec3> {
        match *self {
            Self::OfA(normal) => Some(poses[0].rotation * normal),
            Self::OfB(normal) => Some(poses[1].rotation * normal),
            Self::Across([a, b]) => {
                let across = (poses[0].rotation * a).cross(poses[1].rotation * b);
                let sine = across.length();
                let side = if across.dot(before) < 0.0 { -1.0 } else { 1.0 };
                (sine > RECYCLED_SINE).then(|| across * (side / sine))
            }
        }
    }

    fn save(&self, w: &mut Writer) {
        let (first, kind, second) = match *self {
            Self::OfA(normal) => (normal, 0, None),
            Self::OfB(normal) => (normal, 1, None),
            Self::Across([a, b]) => (a, 2, Some(b)),
        };
        w.vec3(first);
        w.u8(kind);
        second.into_iter().for_each(|second| w.vec3(second));
    }

    fn load(r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let (first, kind) = (r.vec3()?, r.u8()?);
        match kind {
            0 => Ok(Self::OfA(first)),
            1 => Ok(Self::OfB(first)),
            2 => Ok(Self::Across([first, r.vec3()?])),
            _ => Err(r.error("a contact follows neither a face nor two edges")),
        }
    }
}

/// Positions of four points on two surfaces: rows of x, y and z on A, then on B. The last row is padding, so that eight
/// numbers can be read from the start of any other row.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Places([[f32; MAX_POINTS]; 7]);

impl Places {
    fn put(&mut self, point: usize, on: [Vec3; 2]) {
        for (row, number) in self.0.iter_mut().zip(on.into_iter().flat_map(|place| place.to_array())) {
            row[point] = number;
        }
    }

    fn get(&self, point: usize) -> [Vec3; 2] {
        [0, 3]
            .map(|first| Vec3::new(self.0[first][point], self.0[first + 1][point], self.0[first + 2][point]))
    }

    /// Positions on one body's surface in the first lanes; the other lanes are undefined.
    #[inline(always)]
    fn on<L: Lanes>(&self, side: usize) -> Vector3<L> {
        let rows = self.0.as_flattened();
        let row = |number: usize| {
            let from = &rows[(3 * side + number) * MAX_POINTS..];
            L::load(from.first_chunk().expect("there is a row more"))
        };
        Vector3::new(row(0), row(1), row(2))
    }
}

/// True if a direction in the frame of a solid is the normal of one of its faces.
fn is_of_face(shape: &Shape, direction: Vec3) -> bool {
    match shape {
        Shape::Box { .. } => direction.abs().cmpgt(Vec3::splat(ON_FACE)).any(),
        Shape::Hull(hull) => hull.faces().any(|face| face.normal().dot(direction) > ON_FACE),
        _ => false,
    }
}

impl Recycled {
    /// Stores a new manifold. Stores nothing unless both shapes are solids with flat faces that touch at a face or two
    /// edges: other points are as cheap to find as to update, and rolling bodies change theirs every step.
    pub fn new([a, b]: [&Body; 2], key: ContactKey, (margin, slop): (f32, f32), manifold: &Manifold) -> Self {
        let shapes = [(a, key.shape_a), (b, key.shape_b)].map(|(body, shape)| &body.shapes[shape as usize]);
        let is_flat = |shape: &Shape| matches!(shape, Shape::Box { .. } | Shape::Hull(_));
        if manifold.count == 0 || !shapes.iter().all(|shape| is_flat(&shape.shape)) {
            return Self::default();
        }
        let [pose_a, pose_b] = [a.world_from_principal, b.world_from_principal];
        let n = manifold.normal;
        let Some(normal) = Normal::find(shapes, [&pose_a, &pose_b], manifold) else {
            return Self::default();
        };
        let mut places = Places::default();
        for (k, point) in manifold.points().iter().enumerate() {
            let half = n * (0.5 * point.separation);
            let on =
                [pose_a.inverse_point(point.position - half), pose_b.inverse_point(point.position + half)];
            places.put(k, on);
        }
        Self {
            count: manifold.count,
            a_from_b: pose_a.rotation.inverse() * pose_b.rotation,
            normal,
            margin,
            slop,
            places,
        }
    }

    /// Updates a manifold to the current poses if the bodies have hardly moved relative to each other since it was
    /// computed. Returns false, leaving it unchanged, if it must be recomputed.
    pub fn renew(&self, [a, b]: [&Body; 2], margin: f32, manifold: &mut Manifold) -> bool {
        if self.count == 0 || self.count != manifold.count || margin > self.margin {
            return false;
        }
        let [pose_a, pose_b] = [a.world_from_principal, b.world_from_principal];
        let a_from_b = pose_a.rotation.inverse() * pose_b.rotation;
        if a_from_b.dot(self.a_from_b).abs() < RECYCLED_HALF_TURN {
            return false;
        }
        let Some(normal) = self.normal.in_world([&pose_a, &pose_b], manifold.normal) else { return false };
        dispatch::run(Renew { recycled: self, poses: [pose_a, pose_b], normal, margin, manifold })
    }

    /// Smallest search distance of the points, metres; 0 if nothing is stored.
    pub fn least_margin(&self) -> f32 {
        if self.count > 0 { SPECULATIVE_SLOPS * self.slop } else { 0.0 }
    }

    /// Drops the stored manifold.
    pub fn drop(&mut self) {
        self.count = 0;
    }

    pub fn save(&self, w: &mut Writer) {
        w.count(self.count);
        if self.count == 0 {
            return;
        }
        w.rotation(self.a_from_b);
        self.normal.save(w);
        w.f32(self.margin);
        w.f32(self.slop);
        for point in 0..self.count {
            self.places.get(point).into_iter().for_each(|on| w.vec3(on));
        }
    }

    pub fn load(r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let count = r.count(24)?;
        if count > MAX_POINTS {
            return Err(r.error("a contact keeps too many points"));
        }
        if count == 0 {
            return Ok(Self::default());
        }
        let (a_from_b, normal) = (r.rotation()?, Normal::load(r)?);
        let (margin, slop) = (r.f32()?, r.f32()?);
        let mut places = Places::default();
        for point in 0..count {
            places.put(point, [r.vec3()?, r.vec3()?]);
        }
        Ok(Self { count, a_from_b, normal, margin, slop, places })
    }
}

/// Updates the points of a manifold to the current poses with SIMD. Returns false, and changes nothing, if a point has
/// slipped too far or is beyond the margin.
struct Renew<'a> {
    recycled: &'a Recycled,
    poses: [Transform; 2],
    /// Current normal of the manifold, world axes.
    normal: Vec3,
    margin: f32,
    manifold: &'a mut Manifold,
}

impl Kernel for Renew<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Lanes>(self) -> bool {
        let Self { recycled, poses: [a, b], normal, margin, manifold } = self;
        let n = Vector3::<L>::splat(normal);
        let arm = recycled.places.on::<L>(0).turned(a.rotation);
        let offset = Vector3::splat(b.translation - a.translation);
        let gap = offset + recycled.places.on::<L>(1).turned(b.rotation) - arm;
        let separation = gap.dot(n);
        let slip = gap - n * separation;
        let most = RECYCLED_SLIP * recycled.slop * (RECYCLED_SLIP * recycled.slop);
        // Comparisons with NaN are false.
        let holds = L::le(slip.dot(slip), L::splat(most)) & L::le(separation, L::splat(margin));
        let all = u8::MAX >> (WIDTH - recycled.count);
        if holds.bits() & all != all {
            return false;
        }
        let position = Vector3::splat(a.translation) + (arm + gap * L::splat(0.5));
        let mut rows = [[0.0; WIDTH]; 4];
        for (row, numbers) in rows.iter_mut().zip([position.x, position.y, position.z, separation]) {
            numbers.store(row);
        }
        manifold.normal = normal;
        for (k, point) in manifold.points[..recycled.count].iter_mut().enumerate() {
            point.position = Vec3::new(rows[0][k], rows[1][k], rows[2][k]);
            point.separation = rows[3][k];
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::def::{BodyDef, BodyKind};
    use crate::body::shape::ShapeDef;
    use crate::collide::collide;
    use crate::contact::slop;
    use sinew_math::Random;

    const MARGIN: f32 = 0.02;

    fn found([a, b]: [&Body; 2]) -> Manifold {
        let [(shape_a, from_a), (shape_b, from_b)] =
            [a, b].map(|body| (&body.shapes[0].shape, body.world_from_shape(0)));
        let mut manifold = Manifold::default();
        collide(shape_a, &from_a, shape_b, &from_b, MARGIN, &mut manifold);
        manifold
    }

    fn put(body: &mut Body, shift: Vec3, turn: Vec3) {
        let Transform { translation, rotation } = body.world_from_principal;
        body.world_from_principal =
            Transform::new(translation + shift, Rotation::from_scaled_axis(turn) * rotation);
    }

    /// Boxes stacked and slightly moved: recycled points have the same separations as recomputed points. Positions are
    /// not compared: nearly parallel edges cross at other points after a small motion.
    #[test]
    fn recycled_points_have_the_separations_of_recomputed_points() {
        let mut random = Random::new(14);
        let key = ContactKey { a: 0, b: 1, shape_a: 0, shape_b: 0, part: 0 };
        let (mut kept, mut dropped, mut same) = (0, 0, 0);
        for case in 0..4_000 {
            let mut boxed = |at: Vec3| {
                let half_extents = Vec3::new(0.3, 0.3, 0.3) + random.in_cube() * 0.1;
                let shapes = vec![ShapeDef::new(Shape::Box { half_extents })];
                Body::new(&BodyDef { kind: BodyKind::Dynamic, position: at, shapes, ..BodyDef::default() })
            };
            let (mut a, mut b) = (boxed(Vec3::ZERO), boxed(Vec3::Y * 0.6));
            put(&mut b, random.in_cube() * 0.1, random.in_cube() * 0.02);
            let mut manifold = found([&a, &b]);
            if manifold.count == 0 {
                continue;
            }
            let of = Recycled::new([&a, &b], key, (MARGIN, slop(0.4)), &manifold);
            // Moves both boxes together, and B slightly or beyond the limit.
            let (shift, turn) = (random.in_cube(), random.in_cube());
            for body in [&mut a, &mut b] {
                let around =
                    Transform::new(Vec3::ZERO, Rotation::from_scaled_axis(turn)) * body.world_from_principal;
                body.world_from_principal = Transform::new(around.translation + shift, around.rotation);
            }
            let most = [0.1, 0.5, 20.0][random.index(3)];
            put(&mut b, random.in_cube() * (2e-3 * most), random.in_cube() * (2e-3 * most));
            let before = manifold;
            if !of.renew([&a, &b], MARGIN, &mut manifold) {
                assert_eq!(manifold, before, "case {case}");
                dropped += 1;
                continue;
            }
            kept += 1;
            let anew = found([&a, &b]);
            // The other box's face may be equally good: tilted by up to 3 degrees, with its own feature numbers.
            assert!(
                anew.normal.dot(manifold.normal) > 0.998,
                "case {case}: new {anew:?}, recycled {manifold:?}"
            );
            for point in manifold.points() {
                if let Some(other) = anew.points().iter().find(|other| other.feature == point.feature) {
                    same += 1;
                    let off = (other.separation - point.separation).abs();
                    assert!(off < 2e-4, "case {case}: off by {off} m, new {anew:?}, recycled {manifold:?}");
                }
            }
        }
        assert!(
            kept > 1_000 && dropped > 500 && same > 3 * kept,
            "{kept} manifolds kept, {dropped} dropped, {same} equal"
        );
    }
}
