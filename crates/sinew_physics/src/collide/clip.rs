//! The face of one box cut to the prism over a face of another, with the names of the features that meet.

use super::feature;
use super::placed::PlacedBox;
use sinew_math::Vec3;

/// A quadrilateral cut by four planes has at most eight corners.
pub(super) const MAX_CORNERS: usize = 8;

/// A corner of the cut face.
#[derive(Clone, Copy, Default)]
pub(super) struct Corner {
    /// Along the reference face's first and second side and its normal, from its centre.
    pub local: Vec3,
    /// Feature of the reference box.
    pub reference: u16,
    /// Feature of the incident box.
    pub incident: u16,
    /// What the side from this corner to the next one lies on.
    side: Side,
}

#[derive(Clone, Copy, Default, PartialEq)]
enum Side {
    /// An edge of the incident face, by its feature.
    Incident(u16),
    /// A side of the reference face, by its number.
    Reference(usize),
    #[default]
    None,
}

/// A convex polygon.
#[derive(Default)]
pub(super) struct Polygon {
    corners: [Corner; MAX_CORNERS],
    count: usize,
}

impl Polygon {
    pub fn corners(&self) -> &[Corner] {
        &self.corners[..self.count]
    }

    fn push(&mut self, corner: Corner) {
        // Rounding could make a ninth corner of a sliver; it adds nothing.
        if self.count < MAX_CORNERS {
            self.corners[self.count] = corner;
            self.count += 1;
        }
    }
}

/// A face of a box: its axis and side, the axes of its sides, its centre.
pub(super) struct Face<'a> {
    pub of: &'a PlacedBox,
    pub axis: usize,
    pub sign: f32,
}

impl Face<'_> {
    /// Unit, outward.
    pub fn normal(&self) -> Vec3 {
        self.of.axes[self.axis] * self.sign
    }

    pub fn feature(&self) -> u16 {
        feature::face(self.axis, self.sign)
    }

    /// The axes along the face's sides.
    fn sides(&self) -> [usize; 2] {
        [(self.axis + 1) % 3, (self.axis + 2) % 3]
    }

    pub fn center(&self) -> Vec3 {
        self.of.center + self.normal() * self.of.half[self.axis]
    }

    /// Index of the corner on the given sides of the two side axes.
    fn corner(&self, positive: [bool; 2]) -> usize {
        let [u, v] = self.sides();
        usize::from(self.sign > 0.0) << self.axis
            | usize::from(positive[0]) << u
            | usize::from(positive[1]) << v
    }

    /// The four corners in turn.
    fn corners(&self) -> [usize; 4] {
        [[false, false], [true, false], [true, true], [false, true]].map(|p| self.corner(p))
    }

    /// Coordinates of a point along the sides and the normal.
    fn local(&self, p: Vec3) -> Vec3 {
        let (offset, [u, v]) = (p - self.center(), self.sides());
        Vec3::new(offset.dot(self.of.axes[u]), offset.dot(self.of.axes[v]), offset.dot(self.normal()))
    }

    /// From the face's coordinates to the frame of the pair.
    pub fn point(&self, local: Vec3) -> Vec3 {
        let [u, v] = self.sides();
        self.center() + self.of.axes[u] * local.x + self.of.axes[v] * local.y + self.normal() * local.z
    }

    /// Feature of the edge on side `number`: 0 and 1 are the negative and positive side of the first side axis.
    fn edge(&self, number: usize) -> u16 {
        let [u, v] = self.sides();
        let positive = number % 2 == 1;
        if number < 2 {
            feature::edge(v, self.corner([positive, false]))
        } else {
            feature::edge(u, self.corner([false, positive]))
        }
    }

    /// Feature of the corner where two of those sides meet.
    fn vertex(&self, side_a: usize, side_b: usize) -> u16 {
        let (first, second) = if side_a < 2 { (side_a, side_b) } else { (side_b, side_a) };
        feature::vertex(self.corner([first % 2 == 1, second % 2 == 1]))
    }
}

/// The part of the incident face that lies over or under the reference face, widened by `tolerance` so that corners
/// which lie on its sides keep their names under rounding (Sutherland & Hodgman 1974).
pub(super) fn clip(reference: &Face<'_>, incident: &Face<'_>, tolerance: f32) -> Polygon {
    let mut polygon = Polygon::default();
    let corners = incident.corners();
    let [u, v] = incident.sides();
    for (k, index) in corners.into_iter().enumerate() {
        polygon.push(Corner {
            local: reference.local(incident.of.vertex(index)),
            reference: reference.feature(),
            incident: feature::vertex(index),
            side: Side::Incident(feature::edge(if k % 2 == 0 { u } else { v }, index)),
        });
    }
    let half = reference.sides().map(|axis| reference.of.half[axis] + tolerance);
    for number in 0..4 {
        polygon = cut(&polygon, reference, incident, number, half[number / 2]);
    }
    polygon
}

/// Cuts away what lies beyond one side of the reference face.
fn cut(polygon: &Polygon, reference: &Face<'_>, incident: &Face<'_>, number: usize, half: f32) -> Polygon {
    let beyond = |c: &Corner| {
        let x = c.local[number / 2];
        (if number % 2 == 1 { x } else { -x }) - half
    };
    let mut out = Polygon::default();
    let corners = polygon.corners();
    for (k, from) in corners.iter().enumerate() {
        let to = &corners[(k + 1) % corners.len()];
        let (d0, d1) = (beyond(from), beyond(to));
        if d0 <= 0.0 {
            out.push(*from);
        }
        if (d0 <= 0.0) != (d1 <= 0.0) {
            let mut corner =
                Corner { local: from.local + (to.local - from.local) * (d0 / (d0 - d1)), ..*from };
            match from.side {
                Side::Incident(edge) => (corner.reference, corner.incident) = (reference.edge(number), edge),
                Side::Reference(other) => {
                    (corner.reference, corner.incident) =
                        (reference.vertex(other, number), incident.feature());
                }
                Side::None => {}
            }
            // Where the outline leaves, it goes on along this side of the reference face.
            if d0 <= 0.0 {
                corner.side = Side::Reference(number);
            }
            out.push(corner);
        }
    }
    out
}
