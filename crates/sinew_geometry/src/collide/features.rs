//! Contact of any two convex solids, from their supporting features along a known direction.

use super::clip_features::{Clipped, clip};
use super::feature::{WHOLE, pair};
use super::manifold::{Manifold, ManifoldPoint, SeparationCache};
use super::placed::{Segment, sign};
use super::reduce::push_best;
use crate::convex::feature::Feature;
use crate::convex::support::{Posed, Support, wide};
use crate::convex::{Gap, apart_along, meet};
use sinew_math::{Vec3, min};

/// Least cosine between a face's normal and the direction at which the face may be in contact: about 18°.
const FACING: f32 = 0.95;
/// Share of the gap by which edges and corners must be better than a face to be preferred; see also
/// [`PREFERENCE_OF_SIZE`]. Faces give more points and are more stable.
const PREFERENCE: f32 = 0.05;
/// Share of the thinner solid's half width that is added to this preference for faces.
const PREFERENCE_OF_SIZE: f32 = 0.01;
/// Sine between the normal and a face's normal below which the two count as equal.
const FACE_SINE: f32 = 2e-3;
/// Sine below which edges count as parallel and touch along a line.
const PARALLEL_SINE: f32 = 0.05;
/// Parallel edges touch along a line if each is near the plane that contains the other edge and the normal: within this
/// share of the thinner solid's half width.
const SIDEWAYS_SHARE: f32 = 0.25;
/// Direction that breaks ties between faces of A and B, so that the order of the solids does not decide between them:
/// see `axes`.
const TIE_DIRECTION: Vec3 = Vec3::new(0.331, 0.873, 0.357);

/// Finds the contact of any two convex solids. GJK and EPA give the direction and the gap.
pub(crate) fn collide<A: Support, B: Support>(
    a: &Posed<'_, A>,
    b: &Posed<'_, B>,
    margin: f32,
    cache: &mut SeparationCache,
    out: &mut Manifold,
) {
    let gap = meet(a, b);
    if gap.distance <= margin {
        manifold_of_features(a, b, &gap, margin, out);
    } else {
        cache.gap = gap.distance;
    }
}

/// Finds the contact of two solids that are closest, or overlap deepest, along `gap.normal`. The result is a face with
/// the other solid's feature clipped to it, the ends of two parallel edges, or the single point of `gap`. Points
/// further apart than `margin` are dropped.
pub(crate) fn manifold_of_features<A: Support, B: Support>(
    a: &Posed<'_, A>,
    b: &Posed<'_, B>,
    gap: &Gap,
    margin: f32,
    out: &mut Manifold,
) {
    let thinnest = min(a.solid.thinnest(), b.solid.thinnest());
    let tolerance = min(0.0005, 0.01 * thinnest);
    let features = [a.feature(gap.normal), b.feature(-gap.normal)];
    let pairing = Pairing {
        features: &features,
        roundings: [a.solid.rounding(), b.solid.rounding()],
        gap,
        thinnest,
        margin,
        tolerance,
    };
    let slack = PREFERENCE * gap.distance.abs() + PREFERENCE_OF_SIZE * thinnest;
    let along = |normal: Vec3| apart_along(a, b, wide(normal)) as f32;
    let touched = match pairing.reference(slack, along) {
        Some((of, apart)) => pairing.push_faces(of, apart, out),
        None => pairing.push_edges(out),
    };
    if !touched {
        out.normal = gap.normal;
        out.count = 0;
        out.push((gap.on_a + gap.on_b) * 0.5, gap.distance, pair(WHOLE, WHOLE));
    }
}

/// Supporting features of A and B, and their gap.
struct Pairing<'a> {
    features: &'a [Feature; 2],
    roundings: [f32; 2],
    gap: &'a Gap,
    thinnest: f32,
    margin: f32,
    tolerance: f32,
}

/// Name of one of the two solids.
#[derive(Clone, Copy, PartialEq)]
enum Of {
    A,
    B,
}

impl Of {
    fn other(self) -> Self {
        if self == Self::A { Self::B } else { Self::A }
    }
}

impl Pairing<'_> {
    /// Returns the solid whose face the other feature is clipped to, and the distance of the solids along the face's
    /// normal; `None` if no face qualifies. The face's normal must be near the gap's direction, the other feature must
    /// be more than a corner, and the gap along the face's normal must be within `slack` of the largest gap.
    fn reference(&self, slack: f32, apart_along: impl Fn(Vec3) -> f32) -> Option<(Of, f32)> {
        let score = |of: Of| {
            let feature = self.feature(of);
            let outward = self.outward(of);
            let facing = feature.normal.dot(outward);
            if !feature.is_face() || facing < FACING {
                return None;
            }
            let lean = feature.normal.cross(outward).length();
            if lean <= FACE_SINE {
                return Some(self.gap.distance);
            }
            if self.feature(of.other()).corners().len() < 2 {
                return None;
            }
            let normal = if of == Of::A { feature.normal } else { -feature.normal };
            Some(apart_along(normal)).filter(|apart| *apart >= self.gap.distance - slack)
        };
        match (score(Of::A), score(Of::B)) {
            (Some(x), Some(y)) => {
                let tied = (x - y).abs() <= self.tolerance;
                let a_wins = if tied { self.feature(Of::A).normal.dot(TIE_DIRECTION) > 0.0 } else { x > y };
                Some(if a_wins { (Of::A, x) } else { (Of::B, y) })
            }
            (Some(x), None) => Some((Of::A, x)),
            (None, Some(y)) => Some((Of::B, y)),
            (None, None) => None,
        }
    }

    fn feature(&self, of: Of) -> &Feature {
        &self.features[of as usize]
    }

    /// Normal from solid `of` to the other.
    fn outward(&self, of: Of) -> Vec3 {
        if of == Of::A { self.gap.normal } else { -self.gap.normal }
    }

    /// Pushes the other feature clipped to the face of solid `of`; `apart` is the distance of the solids along the
    /// face's normal. Returns false if the solids are separated and the other feature is beside the face, so that the
    /// points would not give their distance.
    fn push_faces(&self, of: Of, apart: f32, out: &mut Manifold) -> bool {
        let other = of.other();
        let (reference, incident) = (self.feature(of), self.feature(other));
        let (r_reference, r_incident) = (self.roundings[of as usize], self.roundings[other as usize]);
        let outward = reference.normal;
        let origin = reference.corners()[0].point;

        let mut points = [ManifoldPoint::default(); super::clip_features::MOST_POINTS + 1];
        let (mut count, mut nearest) = (0, f32::INFINITY);
        for Clipped { point, reference, incident } in clip(reference, incident, self.tolerance).points() {
            let height = (*point - origin).dot(outward);
            let separation = height - r_reference - r_incident;
            nearest = min(separation, nearest);
            if separation <= self.margin {
                let names = [*reference, *incident];
                let feature = pair(names[of as usize], names[other as usize]);
                let position = *point - outward * (r_incident + 0.5 * separation);
                points[count] = ManifoldPoint { position, separation, feature };
                count += 1;
            }
        }
        if nearest > apart + self.tolerance {
            if apart > 0.0 {
                return false;
            }
            // The deepest point of a round face is not among its corners.
            let position = (self.gap.on_a + self.gap.on_b) * 0.5;
            points[count] = ManifoldPoint { position, separation: apart, feature: pair(WHOLE, WHOLE) };
            count += 1;
        }
        out.normal = if of == Of::A { outward } else { -outward };
        push_best(&points[..count], self.tolerance, out);
        out.count > 0
    }

    /// Pushes the two ends of the part along which two edges run side by side; returns false if there is no such part.
    fn push_edges(&self, out: &mut Manifold) -> bool {
        let [a, b] = self.features.each_ref().map(Feature::corners);
        let ([a0, a1], [b0, b1]) = (a, b) else { return false };
        let n = self.gap.normal;
        let (edge, other) = (Segment { ends: [a0.point, a1.point] }, Segment { ends: [b0.point, b1.point] });
        let (along, along_b) = (a1.point - a0.point, b1.point - b0.point);
        let (length, length_b) = (along.length(), along_b.length());
        let parallel = along.cross(along_b).length() <= PARALLEL_SINE * length * length_b;
        let across =
            along.dot(n).abs() <= PARALLEL_SINE * length && along_b.dot(n).abs() <= PARALLEL_SINE * length_b;
        if !(parallel && across) || length <= 0.0 || length_b <= 0.0 {
            return false;
        }
        // The direction uses both edges, so that their order does not matter.
        let common = along / length + along_b * (sign(along.dot(along_b)) / length_b);
        let run = along.dot(common);
        let place = |p: Vec3| (p - a0.point).dot(common) / run;
        let (t0, t1) = (place(b0.point), place(b1.point));
        let mut ends = [(0.0, a0.name), (1.0, a1.name)].map(|(t, name)| (t, name, WHOLE));
        let ((low, low_name), (high, high_name)) =
            if t0 < t1 { ((t0, b0.name), (t1, b1.name)) } else { ((t1, b1.name), (t0, b0.name)) };
        if low > 0.0 {
            ends[0] = (low, WHOLE, low_name);
        }
        if high < 1.0 {
            ends[1] = (high, WHOLE, high_name);
        }
        if (ends[1].0 - ends[0].0) * length < 0.1 * self.thinnest {
            return false;
        }
        let bridges = ends.map(|(t, name_a, name_b)| {
            let on_a = edge.at(t);
            let on_b = other.at((t - t0) / (t1 - t0));
            (on_a, on_b, pair(name_a, name_b))
        });
        let sideways = |(on_a, on_b, _): &(Vec3, Vec3, u32)| {
            let offset = *on_b - *on_a;
            (offset - n * offset.dot(n)).length()
        };
        if bridges.iter().any(|bridge| sideways(bridge) > SIDEWAYS_SHARE * self.thinnest) {
            return false;
        }
        out.normal = n;
        let [round_a, round_b] = self.roundings;
        for (on_a, on_b, feature) in bridges {
            let separation = (on_b - on_a).dot(n) - round_a - round_b;
            if separation <= self.margin {
                let position = (on_a + on_b) * 0.5 + n * (0.5 * (round_a - round_b));
                out.push(position, separation, feature);
            }
        }
        out.count > 0
    }
}
