//! Closed surfaces from cross-sections, with skin weights that blend from bone to bone along an axis.

use super::skeleton::Bone;
use crate::anim::{Primitive, smoothstep};
use crate::math::{Vec3, normalize_or, trig};

/// A rounded cross-section: an ellipse whose halves on the two sides of `u` may differ in depth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Section {
    pub(super) center: Vec3,
    /// Half-width, as a vector.
    pub(super) u: Vec3,
    /// Half-depth on the front, as a vector at right angles to `u`.
    pub(super) v: Vec3,
    /// Half-depth on the back as a multiple of the front's.
    pub(super) back: f32,
    /// Exponent of the superellipse's sine and cosine: 1 gives an ellipse, a smaller value a squarer section.
    pub(super) roundness: f32,
}

impl Section {
    pub(super) fn ellipse(center: Vec3, u: Vec3, v: Vec3) -> Self {
        Self { center, u, v, back: 1.0, roundness: 1.0 }
    }

    /// Returns the point at `turn` of a full revolution, 0..1.
    fn point(&self, turn: f32) -> Vec3 {
        let (sin, cos) = trig::sin_cos(turn * core::f32::consts::TAU);
        let v = if sin < 0.0 { self.v * self.back } else { self.v };
        self.center + self.u * signed_pow(cos, self.roundness) + v * signed_pow(sin, self.roundness)
    }

    fn combine(sections: [&Self; 4], k: [f32; 4]) -> Self {
        let [a, b, c, d] = sections;
        let vector = |f: fn(&Self) -> Vec3| f(a) * k[0] + f(b) * k[1] + (f(c) * k[2] + f(d) * k[3]);
        let scalar = |f: fn(&Self) -> f32| f(a) * k[0] + f(b) * k[1] + (f(c) * k[2] + f(d) * k[3]);
        Self {
            center: vector(|s| s.center),
            u: vector(|s| s.u),
            v: vector(|s| s.v),
            back: scalar(|s| s.back),
            roundness: scalar(|s| s.roundness),
        }
    }
}

fn signed_pow(x: f32, exponent: f32) -> f32 {
    let magnitude = if exponent == 1.0 { x.abs() } else { trig::pow(x.abs(), exponent) };
    if x < 0.0 { -magnitude } else { magnitude }
}

/// Weights of the Catmull-Rom spline through points 1 and 2 of four (Catmull and Rom 1974).
fn catmull_rom(t: f32) -> [f32; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [
        0.5 * (-t + 2.0 * t2 - t3),
        0.5 * (2.0 - 5.0 * t2 + 3.0 * t3),
        0.5 * (t + 4.0 * t2 - 3.0 * t3),
        0.5 * (t3 - t2),
    ]
}

/// Chain of bones along an axis, in order, that move vertices, with the blend zone between neighbours.
pub(super) struct Chain {
    first: Bone,
    borders: Vec<Border>,
}

struct Border {
    origin: Vec3,
    /// Unit vector toward the next bone.
    axis: Vec3,
    half_width: f32,
    next: Bone,
}

/// Up to four bones with weights that add up to 1.
type Influences = [(Bone, f32); 4];

impl Chain {
    /// Chain of a single bone, which moves all vertices.
    pub(super) fn rigid(bone: Bone) -> Self {
        Self { first: bone, borders: Vec::new() }
    }

    /// Adds `next` beyond the plane through `origin` perpendicular to `axis`; weights blend within ± `half_width`
    /// metres.
    pub(super) fn then(mut self, origin: Vec3, axis: Vec3, half_width: f32, next: Bone) -> Self {
        self.borders.push(Border { origin, axis: normalize_or(axis, Vec3::Y), half_width, next });
        self
    }

    fn at(&self, p: Vec3) -> Influences {
        let mut influences = [(self.first, 0.0); 4];
        let mut rest = 1.0;
        let mut bone = self.first;
        for (slot, border) in self.borders.iter().enumerate() {
            let along = (p - border.origin).dot(border.axis) / border.half_width;
            let passed = smoothstep(0.5 + 0.5 * along);
            influences[slot] = (bone, rest * (1.0 - passed));
            rest *= passed;
            bone = border.next;
        }
        influences[self.borders.len()] = (bone, rest);
        influences
    }
}

/// A closed surface: a tube through sections, with a dome at each end.
pub(super) struct Loft {
    /// At least two sections, in order along the tube.
    pub(super) sections: Vec<Section>,
    /// Vector from the first section's centre to the top of its dome.
    pub(super) start_tip: Vec3,
    /// Vector from the last section's centre to the top of its dome.
    pub(super) end_tip: Vec3,
    /// Number of vertices round a ring.
    pub(super) sides: usize,
    /// Number of rings from one section to the next.
    pub(super) rings_per_span: usize,
}

/// Number of rings of a dome without its pole.
const DOME_RINGS: usize = 3;

impl Loft {
    /// Makes an ellipsoid with the given half-axes.
    pub(super) fn ellipsoid(center: Vec3, u: Vec3, v: Vec3, tip: Vec3, sides: usize) -> Self {
        let section = Section::ellipse(center, u, v);
        Self { sections: vec![section; 2], start_tip: -tip, end_tip: tip, sides, rings_per_span: 0 }
    }

    fn rings(&self) -> Vec<Section> {
        let mut rings = Vec::new();
        let first = &self.sections[0];
        rings.extend((1..=DOME_RINGS).map(|k| dome_ring(first, self.start_tip, DOME_RINGS + 1 - k)));
        let last = self.sections.len() - 1;
        for span in 0..last {
            let s = |i: usize| &self.sections[i];
            let around = [s(span.saturating_sub(1)), s(span), s(span + 1), s(usize::min(span + 2, last))];
            for k in 0..self.rings_per_span {
                let t = k as f32 / self.rings_per_span as f32;
                rings.push(Section::combine(around, catmull_rom(t)));
            }
        }
        rings.push(self.sections[last]);
        rings.extend((1..=DOME_RINGS).map(|k| dome_ring(&self.sections[last], self.end_tip, k)));
        rings
    }

    /// Adds the surface to `primitive`, with vertices weighted by `chain`.
    pub(super) fn build(&self, chain: &Chain, primitive: &mut Primitive) {
        let rings = self.rings();
        let base = primitive.positions.len();
        let mut positions = vec![self.sections[0].center + self.start_tip];
        for ring in &rings {
            positions.extend((0..self.sides).map(|i| ring.point(i as f32 / self.sides as f32)));
        }
        positions.push(self.sections[self.sections.len() - 1].center + self.end_tip);
        let triangles = tube_triangles(rings.len(), self.sides);
        let triangles =
            if encloses_positive(&positions, &triangles) { triangles } else { flipped(triangles) };
        primitive.normals.extend(smooth_normals(&positions, &triangles));
        for &p in &positions {
            let influences = chain.at(p);
            primitive.joints.push(influences.map(|(bone, _)| slot(bone)));
            primitive.weights.push(influences.map(|(_, weight)| weight));
        }
        primitive.positions.extend(positions);
        primitive.indices.extend(triangles.into_iter().flatten().map(|i| (base + i) as u32));
    }
}

/// Skin slot of a bone; the root has none.
pub(super) fn slot(bone: Bone) -> u16 {
    bone as u16 - 1
}

/// Returns ring `k` of a dome over `base`: 0 is the base, `DOME_RINGS + 1` would be the pole.
fn dome_ring(base: &Section, tip: Vec3, k: usize) -> Section {
    let angle = k as f32 / (DOME_RINGS + 1) as f32 * core::f32::consts::FRAC_PI_2;
    let (sin, cos) = trig::sin_cos(angle);
    Section { center: base.center + tip * sin, u: base.u * cos, v: base.v * cos, ..*base }
}

/// Returns the triangles of `rings` rings of `sides` vertices between two poles (the first and the last vertex).
fn tube_triangles(rings: usize, sides: usize) -> Vec<[usize; 3]> {
    let vertex = |ring: usize, side: usize| 1 + ring * sides + side % sides;
    let (start, end) = (0, 1 + rings * sides);
    let mut triangles = Vec::with_capacity(2 * rings * sides);
    for side in 0..sides {
        triangles.push([start, vertex(0, side + 1), vertex(0, side)]);
        for ring in 1..rings {
            let (a, b) = (vertex(ring - 1, side), vertex(ring - 1, side + 1));
            let (c, d) = (vertex(ring, side), vertex(ring, side + 1));
            triangles.push([a, b, c]);
            triangles.push([b, d, c]);
        }
        triangles.push([vertex(rings - 1, side), vertex(rings - 1, side + 1), end]);
    }
    triangles
}

fn flipped(triangles: Vec<[usize; 3]>) -> Vec<[usize; 3]> {
    triangles.into_iter().map(|[a, b, c]| [a, c, b]).collect()
}

/// Returns true if the enclosed volume is positive, so that the triangles are counter-clockwise seen from outside.
fn encloses_positive(positions: &[Vec3], triangles: &[[usize; 3]]) -> bool {
    let volume: f32 =
        triangles.iter().map(|&[a, b, c]| positions[a].cross(positions[b]).dot(positions[c])).sum();
    volume > 0.0
}

/// Returns vertex normals: the sum of the adjacent triangles' area vectors.
fn smooth_normals(positions: &[Vec3], triangles: &[[usize; 3]]) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; positions.len()];
    for &[a, b, c] in triangles {
        let area = (positions[b] - positions[a]).cross(positions[c] - positions[a]);
        for i in [a, b, c] {
            sums[i] += area;
        }
    }
    sums.into_iter().map(|n| normalize_or(n * 1e6, Vec3::Y)).collect()
}

/// Adds the mirror image of all vertices and triangles in the plane x = 0; left bones become right bones.
pub(super) fn mirror(primitive: &mut Primitive) {
    let count = primitive.positions.len();
    let flip = |v: Vec3| Vec3::new(-v.x, v.y, v.z);
    for i in 0..count {
        primitive.positions.push(flip(primitive.positions[i]));
        primitive.normals.push(flip(primitive.normals[i]));
        primitive.weights.push(primitive.weights[i]);
        let joints = primitive.joints[i].map(|s| slot(Bone::from_index(usize::from(s) + 1).mirrored()));
        primitive.joints.push(joints);
    }
    let offset = count as u32;
    let triangles = primitive.indices.chunks_exact(3);
    let mirrored: Vec<u32> = triangles.flat_map(|t| [t[0] + offset, t[2] + offset, t[1] + offset]).collect();
    primitive.indices.extend(mirrored);
}
