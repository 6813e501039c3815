//! Clips a feature of one solid to the prism over a face of another and names the features in contact.

use super::feature::WHOLE;
use crate::convex::feature::{Corner, Feature, MOST_CORNERS};
use sinew_math::{Vec3, normalize_or};

/// Largest number of points of a clipped feature: each side of the face can add a corner.
pub(super) const MOST_POINTS: usize = 2 * MOST_CORNERS;

/// A point of the clipped feature.
#[derive(Clone, Copy, Default)]
pub(super) struct Clipped {
    pub point: Vec3,
    /// Name of the feature of the reference solid.
    pub reference: u16,
    /// Name of the feature of the incident solid.
    pub incident: u16,
}

/// A corner of the outline while clipping.
#[derive(Clone, Copy, Default)]
struct Outline {
    at: Clipped,
    /// Edge of the incident feature or of the reference face that contains the side from this corner to the next.
    side: Side,
}

#[derive(Clone, Copy, Default)]
enum Side {
    /// A side of the incident feature, by name.
    Incident(u16),
    /// A side of the reference face, by number.
    Reference(usize),
    #[default]
    None,
}

/// The clipped feature: a polygon, a segment, a point, or empty.
pub(super) struct Cut {
    points: [Clipped; MOST_POINTS],
    count: usize,
}

impl Cut {
    pub fn points(&self) -> &[Clipped] {
        &self.points[..self.count]
    }
}

/// Clips the incident feature to the prism over and under the face (Sutherland & Hodgman 1974). The prism is widened by
/// `tolerance`, so that corners on its sides keep their names under rounding.
pub(super) fn clip(face: &Feature, incident: &Feature, tolerance: f32) -> Cut {
    let mut outline = [Outline::default(); MOST_POINTS];
    let mut count = incident.corners().len();
    for (to, Corner { point, name, side }) in outline.iter_mut().zip(incident.corners()) {
        let at = Clipped { point: *point, reference: face.name, incident: *name };
        *to = Outline { at, side: Side::Incident(*side) };
    }
    let sides = face.corners().len();
    for number in 0..sides {
        let from = face.corners()[number].point;
        let along = face.corners()[(number + 1) % sides].point - from;
        let outward = normalize_or(along.cross(face.normal), Vec3::ZERO);
        let beyond = |p: Vec3| (p - from).dot(outward) - tolerance;
        let mut next = [Outline::default(); MOST_POINTS];
        count = cut(&outline[..count], face, incident, number, beyond, &mut next);
        outline = next;
    }
    Cut { points: outline.map(|corner| corner.at), count }
}

/// Removes the part of the outline beyond one side of the face; returns the number of remaining corners.
fn cut(
    outline: &[Outline],
    face: &Feature,
    incident: &Feature,
    number: usize,
    beyond: impl Fn(Vec3) -> f32,
    out: &mut [Outline; MOST_POINTS],
) -> usize {
    let mut count = 0;
    let mut push = |corner: Outline| {
        // Rounding could produce one more corner on a sliver; that corner is dropped.
        if count < MOST_POINTS {
            out[count] = corner;
            count += 1;
        }
    };
    for (k, from) in outline.iter().enumerate() {
        let d0 = beyond(from.at.point);
        if d0 <= 0.0 {
            push(*from);
        }
        // A segment has no side from its end back to its start.
        if k + 1 == outline.len() && incident.corners().len() < 3 {
            break;
        }
        let to = &outline[(k + 1) % outline.len()];
        let d1 = beyond(to.at.point);
        if (d0 <= 0.0) == (d1 <= 0.0) {
            continue;
        }
        let mut corner = *from;
        corner.at.point = from.at.point + (to.at.point - from.at.point) * (d0 / (d0 - d1));
        match from.side {
            Side::Incident(name) => {
                (corner.at.reference, corner.at.incident) = (face.corners()[number].side, name);
            }
            Side::Reference(other) => {
                (corner.at.reference, corner.at.incident) =
                    (corner_between(face, other, number), incident.name);
            }
            Side::None => {}
        }
        // Where the outline crosses outward, it continues along this side of the face.
        if d0 <= 0.0 {
            corner.side = Side::Reference(number);
        }
        push(corner);
    }
    count
}

/// Name of the corner of the face at which two sides meet; `WHOLE` if they do not meet.
fn corner_between(face: &Feature, one: usize, other: usize) -> u16 {
    let sides = face.corners().len();
    if (one + 1) % sides == other {
        face.corners()[other].name
    } else if (other + 1) % sides == one {
        face.corners()[one].name
    } else {
        WHOLE
    }
}
