//! The piece of skin to which one shape is fitted: evenly spaced samples and second moments.
//!
//! ```
//! use sinew_math::Vec3;
//! use sinew_ragdoll::fit::patch::{Patch, Symmetry, bounds};
//! use sinew_ragdoll::fit::surface::Share;
//!
//! // A flat piece of skin, 20 cm by 10 cm, all of it a bone's own.
//! let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
//! let halves = [
//!     [corner(0.0, 0.0), corner(0.2, 0.0), corner(0.2, 0.1)],
//!     [corner(0.0, 0.0), corner(0.2, 0.1), corner(0.0, 0.1)],
//! ];
//! let shares = halves.map(|corners| Share { corners, weight: 1.0, most: true });
//! let patch = Patch::select(&shares, Symmetry::AsIs).expect("it has skin");
//! assert!((patch.area - 0.02).abs() < 1e-4);
//! assert!((patch.center - corner(0.1, 0.05)).length() < 1e-3);
//! let (low, high) = bounds(&patch.samples, |point| point.x);
//! assert!(low >= 0.0 && high <= 0.2);
//! ```

use crate::fit::surface::{Share, for_each_part};
use crate::tuning::{LEAST_AREA, SAMPLES};
use sinew_math::{Sym3, Vec3, clamp, max, min};

/// Selection of the skin triangles used for a bone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Selection {
    /// Triangles on which the bone's mean weight is at least this.
    Weight(f32),
    /// Triangles on which no other bone has more weight.
    Most,
    /// No triangles: the bone moves almost no skin.
    Nothing,
    /// Triangles of the same bone on the other side, without the object that this side carries.
    Twin,
}

/// A sample of the surface.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Position in character space, metres.
    pub point: Vec3,
    /// Area that the sample represents, m².
    pub area: f32,
}

/// Samples and moments of a bone's piece of skin.
#[derive(Clone, Debug)]
pub struct Patch {
    /// Samples of about equal area.
    pub samples: Vec<Sample>,
    /// Area-weighted mean of the surface, character space, metres.
    pub center: Vec3,
    /// Area-weighted covariance of the surface, m².
    pub covariance: Sym3,
    /// Area of the piece, m².
    pub area: f32,
    /// Selection by which the patch's triangles were chosen.
    pub selection: Selection,
}

/// Symmetry of a patch: unchanged, or made symmetric by adding its mirror image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Symmetry {
    /// The patch is unchanged.
    AsIs,
    /// The patch includes its mirror image in the plane of this x, metres.
    Mirrored(f32),
}

impl Patch {
    /// Selects the surface of a bone: triangles of weight ≥ 0.5, or ≥ 0.3 if the former are too few or flat, or those
    /// on which the bone has the most weight. `None` if there are no triangles.
    pub fn select(shares: &[Share], symmetry: Symmetry) -> Option<Self> {
        let choices =
            [Selection::Weight(0.5), Selection::Weight(0.3), Selection::Most, Selection::Weight(0.05)];
        let moved: f32 = shares.iter().map(|share| triangle_area(&share.corners) * share.weight).sum();
        let mut best: Option<Self> = None;
        for selection in choices {
            let chosen: Vec<[Vec3; 3]> = shares
                .iter()
                .filter(|share| match selection {
                    Selection::Weight(least) => share.weight >= least,
                    Selection::Most => share.most,
                    Selection::Nothing | Selection::Twin => false,
                })
                .map(|share| share.corners)
                .collect();
            let Some(patch) = Self::of_triangles(&chosen, selection, symmetry) else { continue };
            if patch.area >= LEAST_AREA * moved && patch.is_solid() {
                return Some(patch);
            }
            if best.as_ref().is_none_or(|b| patch.area > 2.0 * b.area) {
                best = Some(patch);
            }
        }
        best
    }

    /// Returns true if the patch extends in three directions; otherwise its axes are meaningless.
    fn is_solid(&self) -> bool {
        let (value, _) = self.covariance.eigen();
        value.z > 1e-4 * value.x
    }

    /// Computes second moments by the closed form for triangles (Gottschalk, "Collision Queries using Oriented Bounding
    /// Boxes", 2000, §5.3), about the first corner to avoid cancellation.
    fn of_triangles(triangles: &[[Vec3; 3]], selection: Selection, symmetry: Symmetry) -> Option<Self> {
        let origin = triangles.first()?[0];
        let (mut area, mut first, mut second) = (0.0, Vec3::ZERO, Sym3::ZERO);
        for corners in triangles {
            let [p, q, r] = corners.map(|corner| corner - origin);
            let a = triangle_area(corners);
            let middle = (p + q + r) / 3.0;
            area += a;
            first += middle * a;
            let sum = Sym3::outer(middle) * 9.0 + Sym3::outer(p) + Sym3::outer(q) + Sym3::outer(r);
            second += sum * (a / 12.0);
        }
        if !(area > 1e-10 && area.is_finite()) {
            return None;
        }
        let mean = first / area;
        let mut patch = Self {
            samples: sample(triangles, area),
            center: origin + mean,
            covariance: second * (1.0 / area) - Sym3::outer(mean),
            area,
            selection,
        };
        if let Symmetry::Mirrored(x) = symmetry {
            patch.mirror(x);
        }
        Some(patch)
    }

    fn mirror(&mut self, x: f32) {
        let image = |p: Vec3| Vec3::new(2.0 * x - p.x, p.y, p.z);
        let images: Vec<_> =
            self.samples.iter().map(|s| Sample { point: image(s.point), area: s.area }).collect();
        self.samples.extend(images);
        let aside = self.center.x - x;
        let v = &mut self.covariance;
        v.diagonal.x += aside * aside;
        // The products of x with y and z change sign in the mirror image.
        v.off = Vec3::new(v.off.x, 0.0, 0.0);
        self.center.x = x;
    }

    /// Returns the area-weighted quantiles of `f` over the samples, one for each of the given shares.
    pub fn quantiles<const N: usize>(&self, shares: [f32; N], f: impl Fn(Vec3) -> f32) -> [f32; N] {
        let mut values: Vec<_> = self.samples.iter().map(|s| (f(s.point), s.area)).collect();
        quantiles_of(&mut values, shares)
    }
}

/// Returns the weighted quantiles of `values`, pairs of value and weight, one for each of the given shares. Sorts
/// `values`.
///
/// # Panics
/// If `values` is empty.
pub fn quantiles_of<const N: usize>(values: &mut [(f32, f32)], shares: [f32; N]) -> [f32; N] {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f32 = values.iter().map(|v| v.1).sum();
    shares.map(|share| {
        let mut sum = 0.0;
        let reached = values.iter().find(|(_, weight)| {
            sum += weight;
            sum >= share * total
        });
        reached.unwrap_or(&values[values.len() - 1]).0
    })
}

fn triangle_area(corners: &[Vec3; 3]) -> f32 {
    0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).length()
}

/// Returns the centres of equal subdivisions of the triangles. Large triangles are cut finer, so that coarse meshes are
/// sampled as evenly as fine ones.
fn sample(triangles: &[[Vec3; 3]], area: f32) -> Vec<Sample> {
    let mut samples = Vec::new();
    for corners in triangles {
        let a = triangle_area(corners);
        let cuts = clamp((a * SAMPLES / area).sqrt() + 0.999, 1.0, 16.0) as usize;
        let [p, q, r] = *corners;
        let part = a / (cuts * cuts) as f32;
        for_each_part(cuts, |at| {
            let middle = at.map(|[u, v]| (q - p) * u + (r - p) * v);
            samples.push(Sample { point: p + (middle[0] + middle[1] + middle[2]) / 3.0, area: part });
        });
    }
    samples
}

/// Returns the smallest and the largest value of `f` over the samples.
pub fn bounds(samples: &[Sample], f: impl Fn(Vec3) -> f32) -> (f32, f32) {
    samples.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(lo, hi), s| {
        let x = f(s.point);
        (min(lo, x), max(hi, x))
    })
}
