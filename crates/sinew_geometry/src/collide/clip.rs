//! Clips a face to the prism over another face and names the features in contact.

use super::feature;
use super::placed::PlacedBox;
use crate::hull::Polytope;
use sinew_math::{Vec3, any_orthonormal};

/// A corner of the clipped face.
#[derive(Clone, Copy, Default)]
pub(super) struct Corner {
    /// Position in the reference face's frame, whose z axis is the face's normal.
    pub local: Vec3,
    /// Feature of the reference shape.
    pub reference: u16,
    /// Feature of the incident shape.
    pub incident: u16,
    /// Edge of the incident face, or side of the reference face, on which the side from this corner to the next lies.
    side: Side,
}

/// Origin of a side of the clipped face.
#[derive(Clone, Copy, Default, PartialEq)]
enum Side {
    /// An edge of the incident face, by its feature.
    Incident(u16),
    /// A side of the reference face, by its index.
    Reference(u16),
    #[default]
    None,
}

/// A convex polygon of at most `N` corners.
pub(super) struct Polygon<const N: usize> {
    corners: [Corner; N],
    count: usize,
}

impl<const N: usize> Polygon<N> {
    fn new() -> Self {
        Self { corners: [Corner::default(); N], count: 0 }
    }

    pub fn corners(&self) -> &[Corner] {
        &self.corners[..self.count]
    }

    fn push(&mut self, corner: Corner) {
        // Rounding could produce one more corner on a sliver; that corner is dropped.
        if self.count < N {
            self.corners[self.count] = corner;
            self.count += 1;
        }
    }
}

/// A convex face to which another face is clipped. Its sides are numbered in clipping order.
pub(super) trait Reference {
    /// Feature name of the face.
    fn feature(&self) -> u16;
    /// Outward unit normal.
    fn normal(&self) -> Vec3;
    /// Converts a point to the face's frame.
    fn local(&self, p: Vec3) -> Vec3;
    /// Converts a point from the face's frame to the frame of the pair.
    fn point(&self, local: Vec3) -> Vec3;
    /// Number of sides.
    fn sides(&self) -> usize;
    /// Returns the line of a side, in the face's frame.
    fn side(&self, number: usize) -> Line;
    /// Name of the edge at a side.
    fn edge(&self, side: usize) -> u16;
    /// Name of the corner where two sides meet; `later` is the later of the two.
    fn vertex(&self, earlier: usize, later: usize) -> u16;
}

/// A line in the plane of a face: `outward · x = offset`.
#[derive(Clone, Copy)]
pub(super) struct Line {
    /// Unit vector; z is 0.
    pub outward: Vec3,
    pub offset: f32,
}

/// A corner of an incident face: its position, its name, and the name of the edge from it to the next.
pub(super) type Incident = (Vec3, u16, u16);

/// Clips the incident face to the prism over the reference face (Sutherland & Hodgman 1974). `face` is the feature name
/// of the incident face, `corners` its corners. The prism is widened by `tolerance`, so that rounding does not change
/// the names of corners on its sides.
pub(super) fn clip<const N: usize>(
    reference: &impl Reference,
    face: u16,
    corners: impl Iterator<Item = Incident>,
    tolerance: f32,
) -> Polygon<N> {
    let mut polygon = Polygon::new();
    for (corner, vertex, edge) in corners {
        polygon.push(Corner {
            local: reference.local(corner),
            reference: reference.feature(),
            incident: vertex,
            side: Side::Incident(edge),
        });
    }
    for side in 0..reference.sides() {
        cut(&mut polygon, reference, face, side, tolerance);
    }
    polygon
}

/// Removes the part of the polygon beyond one side of the reference face.
fn cut<const N: usize>(
    polygon: &mut Polygon<N>,
    reference: &impl Reference,
    face: u16,
    side: usize,
    tolerance: f32,
) {
    let Line { outward, offset } = reference.side(side);
    let mut beyond = [0.0; N];
    let mut all_within = true;
    for (beyond, c) in beyond.iter_mut().zip(polygon.corners()) {
        *beyond = (c.local.x * outward.x + c.local.y * outward.y) - (offset + tolerance);
        all_within &= *beyond <= 0.0;
    }
    if all_within {
        return;
    }
    let mut out = Polygon::new();
    let corners = polygon.corners();
    for (k, from) in corners.iter().enumerate() {
        let next = if k + 1 < corners.len() { k + 1 } else { 0 };
        let (to, d0, d1) = (&corners[next], beyond[k], beyond[next]);
        if d0 <= 0.0 {
            out.push(*from);
        }
        if (d0 <= 0.0) != (d1 <= 0.0) {
            let mut corner =
                Corner { local: from.local + (to.local - from.local) * (d0 / (d0 - d1)), ..*from };
            match from.side {
                Side::Incident(edge) => (corner.reference, corner.incident) = (reference.edge(side), edge),
                Side::Reference(other) => {
                    (corner.reference, corner.incident) = (reference.vertex(usize::from(other), side), face);
                }
                Side::None => {}
            }
            // Where the outline crosses outward, it continues along this side of the reference face.
            if d0 <= 0.0 {
                corner.side = Side::Reference(side as u16);
            }
            out.push(corner);
        }
    }
    *polygon = out;
}

/// Largest number of corners of a quadrilateral that four planes have clipped.
pub(super) const BOX_CORNERS: usize = 8;

/// A face of a box.
pub(super) struct BoxFace<'a> {
    of: &'a PlacedBox,
    axis: usize,
    sign: f32,
    center: Vec3,
    normal: Vec3,
    /// Axes of the box along the face's sides.
    sides: [usize; 2],
    along: [Vec3; 2],
}

impl<'a> BoxFace<'a> {
    /// Creates a face from its axis and sign.
    pub fn new(of: &'a PlacedBox, axis: usize, sign: f32) -> Self {
        let normal = of.axes[axis] * sign;
        let sides = [[1, 2], [2, 0], [0, 1]][axis];
        let center = of.center + normal * of.half[axis];
        Self { of, axis, sign, center, normal, sides, along: sides.map(|side| of.axes[side]) }
    }

    /// Index of the corner on the positive or negative side of each of the two side axes.
    fn corner(&self, positive: [bool; 2]) -> usize {
        let [u, v] = self.sides;
        usize::from(self.sign > 0.0) << self.axis
            | usize::from(positive[0]) << u
            | usize::from(positive[1]) << v
    }

    /// Returns the four corners, in order around the face.
    pub fn corners(&self) -> impl Iterator<Item = Incident> {
        let [u, v] = self.sides;
        let sides = [([false, false], u), ([true, false], v), ([true, true], u), ([false, true], v)];
        sides.into_iter().map(move |(positive, along)| {
            let index = self.corner(positive);
            (self.of.vertex(index), feature::vertex(index), feature::edge(along, index))
        })
    }
}

/// Sides 0 and 1 are on the negative and the positive side of the first side axis, sides 2 and 3 on those of the
/// second.
impl Reference for BoxFace<'_> {
    fn feature(&self) -> u16 {
        feature::face(self.axis, self.sign)
    }

    fn normal(&self) -> Vec3 {
        self.normal
    }

    fn local(&self, p: Vec3) -> Vec3 {
        let (offset, [u, v]) = (p - self.center, self.along);
        Vec3::new(offset.dot(u), offset.dot(v), offset.dot(self.normal))
    }

    fn point(&self, local: Vec3) -> Vec3 {
        let [u, v] = self.along;
        self.center + u * local.x + v * local.y + self.normal * local.z
    }

    fn sides(&self) -> usize {
        4
    }

    fn side(&self, number: usize) -> Line {
        let mut outward = Vec3::ZERO;
        outward[number / 2] = if number % 2 == 1 { 1.0 } else { -1.0 };
        Line { outward, offset: self.of.half[self.sides[number / 2]] }
    }

    fn edge(&self, side: usize) -> u16 {
        let [u, v] = self.sides;
        let positive = side % 2 == 1;
        if side < 2 {
            feature::edge(v, self.corner([positive, false]))
        } else {
            feature::edge(u, self.corner([false, positive]))
        }
    }

    fn vertex(&self, earlier: usize, later: usize) -> u16 {
        feature::vertex(self.corner([earlier % 2 == 1, later % 2 == 1]))
    }
}

/// A face of a polytope.
pub(super) struct PolytopeFace<'a> {
    of: &'a Polytope<'a>,
    face: usize,
    /// Axes of the face's frame: two in the plane of the face, and the outward normal.
    axes: [Vec3; 3],
    origin: Vec3,
}

impl<'a> PolytopeFace<'a> {
    pub fn new(of: &'a Polytope<'a>, face: usize) -> Self {
        let normal = of.planes[face].normal;
        let u = any_orthonormal(normal);
        let height = of.planes[face].height(of.center);
        Self { of, face, axes: [u, normal.cross(u), normal], origin: of.center - normal * height }
    }

    /// Returns the corners, in order around the face.
    pub fn corners(&self) -> impl Iterator<Item = Incident> {
        let Polytope { vertices, topology, .. } = *self.of;
        topology.sides(self.face).map(move |side| {
            let corner = topology.ends(side)[0];
            (vertices[corner], feature::vertex(corner), feature::half_edge(topology, side))
        })
    }

    /// Index of the half-edge at a side.
    fn half_edge(&self, side: usize) -> usize {
        self.of.topology.sides(self.face).start + side
    }
}

/// Sides are numbered in the order of the half-edges.
impl Reference for PolytopeFace<'_> {
    fn feature(&self) -> u16 {
        feature::face_number(self.face)
    }

    fn normal(&self) -> Vec3 {
        self.axes[2]
    }

    fn local(&self, p: Vec3) -> Vec3 {
        let offset = p - self.origin;
        Vec3::new(offset.dot(self.axes[0]), offset.dot(self.axes[1]), offset.dot(self.axes[2]))
    }

    fn point(&self, local: Vec3) -> Vec3 {
        self.origin + self.axes[0] * local.x + self.axes[1] * local.y + self.axes[2] * local.z
    }

    fn sides(&self) -> usize {
        self.of.topology.sides(self.face).len()
    }

    fn side(&self, number: usize) -> Line {
        let [from, to] = self.of.edge(self.half_edge(number)).ends.map(|p| self.local(p));
        let along = to - from;
        // Corners are counter-clockwise, so the outside is to the right.
        let right = Vec3::new(along.y, -along.x, 0.0);
        let outward = right / right.length();
        Line { outward, offset: outward.x * from.x + outward.y * from.y }
    }

    fn edge(&self, side: usize) -> u16 {
        feature::half_edge(self.of.topology, self.half_edge(side))
    }

    fn vertex(&self, earlier: usize, later: usize) -> u16 {
        // The last side meets the first one at the start of the first.
        let wraps = earlier == 0 && later + 1 == self.sides() && later > 1;
        let side = self.half_edge(if wraps { 0 } else { later });
        feature::vertex(self.of.topology.ends(side)[0])
    }
}
