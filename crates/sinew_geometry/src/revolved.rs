//! Solids of revolution about y: cylinders and cones as truncated cones, tapered capsules, and their slices. Lengths
//! are metres.

use crate::shape::MassProperties;
use core::f32::consts::PI;
use sinew_math::{Sym3, Vec2, Vec3, clamp, max, min};

/// Truncated cone along y from −`half_height` to `half_height`, with flat ends; metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TruncatedCone {
    /// Half the length, metres.
    pub half_height: f32,
    /// Radius of the end at −`half_height`, metres.
    pub bottom: f32,
    /// Radius of the end at `half_height`, metres.
    pub top: f32,
}

/// Convex hull of two balls on the y axis, neither inside the other; metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaperedCapsule {
    /// Half the distance between the balls' centres, metres.
    pub half_height: f32,
    /// Radius of the ball at −`half_height`, metres.
    pub bottom: f32,
    /// Radius of the ball at `half_height`, metres.
    pub top: f32,
}

/// Converts a point to the half-plane through the axis: distance from the axis, and height.
fn to_profile(p: Vec3) -> Vec2 {
    Vec2::new((p.x * p.x + p.z * p.z).sqrt(), p.y)
}

/// Converts a direction from the half-plane through the axis and `p` to three dimensions. If `p` is on the axis, the
/// half-plane through the x axis is used.
fn from_profile(v: Vec2, p: Vec3) -> Vec3 {
    let out = (p.x * p.x + p.z * p.z).sqrt();
    let (x, z) = if out > 1e-18 { (p.x / out, p.z / out) } else { (1.0, 0.0) };
    Vec3::new(x * v.x, v.y, z * v.x)
}

impl TruncatedCone {
    /// Returns a cylinder: a truncated cone with equal ends.
    pub fn cylinder(half_height: f32, radius: f32) -> Self {
        Self { half_height, bottom: radius, top: radius }
    }

    /// Returns a cone with its base at −`half_height` and its apex at `half_height`.
    pub fn cone(half_height: f32, radius: f32) -> Self {
        Self { half_height, bottom: radius, top: 0.0 }
    }

    /// Unit normal of the side, outward, in the half-plane through the axis (distance from the axis, height).
    pub fn side_normal(&self) -> Vec2 {
        let v = Vec2::new(2.0 * self.half_height, self.bottom - self.top);
        v / v.length()
    }

    /// Radius at a height, metres.
    pub fn radius_at(&self, y: f32) -> f32 {
        0.5 * (self.bottom + self.top) + 0.5 * (self.top - self.bottom) * (y / self.half_height)
    }

    /// Returns the signed distance of a point to the surface, metres, and the unit outward normal at the closest point
    /// of the surface.
    pub fn distance(&self, p: Vec3) -> (f32, Vec3) {
        let q = to_profile(p);
        let h = self.half_height;
        let (low, high) = (Vec2::new(self.bottom, -h), Vec2::new(self.top, h));
        let side = self.side_normal();
        let (beyond_side, beyond_ends) = ((q - low).dot(side), q.y.abs() - h);
        let end = Vec2::new(0.0, if q.y < 0.0 { -1.0 } else { 1.0 });
        let face = if beyond_side > beyond_ends { side } else { end };
        if beyond_side <= 0.0 && beyond_ends <= 0.0 {
            return (max(beyond_side, beyond_ends), from_profile(face, p));
        }
        let along = high - low;
        let t = clamp((q - low).dot(along) / along.dot(along), 0.0, 1.0);
        if beyond_side > 0.0 && t > 0.0 && t < 1.0 {
            // If the side is closest, its normal is exact at any distance.
            return (beyond_side, from_profile(side, p));
        }
        let candidates =
            [Vec2::new(min(q.x, low.x), -h), Vec2::new(min(q.x, high.x), h), low + along * t].map(|c| q - c);
        let nearer = |a: Vec2, b: Vec2| if b.dot(b) < a.dot(a) { b } else { a };
        let offset = candidates.into_iter().reduce(nearer).unwrap_or(face);
        let distance = offset.length();
        // Squares of tiny distances underflow.
        if distance > 1e-12 {
            (distance, from_profile(offset / distance, p))
        } else {
            (0.0, from_profile(face, p))
        }
    }

    /// Returns the fraction of `direction` (≥ 0) and the unit normal at which a half-line from outside enters the
    /// solid. Uses `f64`, because the quadratic of a cone loses a small radius over a long distance.
    pub fn enter(&self, origin: Vec3, direction: Vec3) -> Option<(f32, Vec3)> {
        let [ox, oy, oz] = origin.to_array().map(f64::from);
        let [dx, dy, dz] = direction.to_array().map(f64::from);
        let h = f64::from(self.half_height);
        let mean = 0.5 * (f64::from(self.bottom) + f64::from(self.top));
        let slope = 0.5 * (f64::from(self.top) - f64::from(self.bottom)) / h;
        // Range of the line between the planes of the ends.
        let (mut first, mut last) = (0.0, f64::INFINITY);
        if dy == 0.0 {
            if oy.abs() > h {
                return None;
            }
        } else {
            let side = if dy > 0.0 { 1.0 } else { -1.0 };
            let (enter, leave) = ((-side * h - oy) / dy, (side * h - oy) / dy);
            (first, last) = (if enter > 0.0 { enter } else { 0.0 }, leave);
        }
        if first > last || first == f64::INFINITY {
            return None;
        }
        // Excess beyond the side, f = ρ² − r², is quadratic along the line.
        let [x, y, z] = [ox + dx * first, oy + dy * first, oz + dz * first];
        let (radius, growth) = (mean + slope * y, slope * dy);
        let c = x * x + z * z - radius * radius;
        if c <= 0.0 {
            let end = Vec3::new(0.0, if dy > 0.0 { -1.0 } else { 1.0 }, 0.0);
            return Some((first as f32, end));
        }
        let a = dx * dx + dz * dz - growth * growth;
        let half_b = x * dx + z * dz - radius * growth;
        let root = half_b * half_b - a * c;
        // First root after the start, in the form without cancellation. The quadratic has no such root if the line does
        // not approach the side.
        let steep = root.sqrt() - half_b;
        if root < 0.0 || steep <= 0.0 {
            return None;
        }
        let t = c / steep;
        let y_there = y + dy * t;
        if first + t > last || mean + slope * y_there < 0.0 {
            return None;
        }
        let at = Vec3::new((x + dx * t) as f32, 0.0, (z + dz * t) as f32);
        Some(((first + t) as f32, from_profile(self.side_normal(), at)))
    }

    /// Returns the slices of the solid.
    pub fn slices(&self) -> [Slice; 1] {
        let h = f64::from(self.half_height);
        let mean = 0.5 * (f64::from(self.bottom) + f64::from(self.top));
        let slope = 0.5 * (f64::from(self.top) - f64::from(self.bottom)) / h;
        [Slice { from: -h, to: h, radius_squared: [mean * mean, 2.0 * mean * slope, slope * slope] }]
    }
}

impl TaperedCapsule {
    /// Creates the convex hull of a ball of radius `bottom` around y = −`half_height` and a ball of radius `top` around
    /// y = `half_height`.
    pub fn new(half_height: f32, bottom: f32, top: f32) -> Self {
        Self { half_height, bottom, top }
    }

    /// Unit normal out of the side, in the half-plane through the axis.
    pub fn side_normal(&self) -> Vec2 {
        let sin = (self.bottom - self.top) / (2.0 * self.half_height);
        // Uses the product, because the square loses precision near 1.
        Vec2::new(max((1.0 - sin) * (1.0 + sin), 0.0).sqrt(), sin)
    }

    /// Returns the truncated cone between the circles along which the side touches the balls, and the height of that
    /// cone's centre.
    pub fn side(&self) -> (TruncatedCone, f32) {
        let n = self.side_normal();
        let (low, high) = (-self.half_height + self.bottom * n.y, self.half_height + self.top * n.y);
        let side =
            TruncatedCone { half_height: 0.5 * (high - low), bottom: self.bottom * n.x, top: self.top * n.x };
        (side, 0.5 * (low + high))
    }

    /// Returns the centres and radii of the two balls.
    pub fn balls(&self) -> [(Vec3, f32); 2] {
        let up = Vec3::new(0.0, self.half_height, 0.0);
        [(-up, self.bottom), (up, self.top)]
    }

    /// Returns the signed distance and the outward normal at the closest point of the surface.
    pub fn distance(&self, p: Vec3) -> (f32, Vec3) {
        let (q, n) = (to_profile(p), self.side_normal());
        // The line through the point along the side's normal meets the axis at this height divided by the cosine `n.x`,
        // which may be 0.
        let foot = q.y * n.x - q.x * n.y;
        let reach = self.half_height * n.x;
        if foot.abs() < reach {
            let low = Vec2::new(0.0, -self.half_height);
            return ((q - low).dot(n) - self.bottom, from_profile(n, p));
        }
        let [low, high] = self.balls();
        let (center, radius) = if foot < 0.0 { low } else { high };
        let offset = p - center;
        let length = offset.length();
        let normal = if length > 1e-12 { offset / length } else { from_profile(n, p) };
        (length - radius, normal)
    }

    /// Returns the slices of the solid.
    pub fn slices(&self) -> [Slice; 3] {
        let (h, bottom, top) = (f64::from(self.half_height), f64::from(self.bottom), f64::from(self.top));
        let sin = (bottom - top) / (2.0 * h);
        let (low, high) = (-h + bottom * sin, h + top * sin);
        let ball = |center: f64, radius: f64| [radius * radius - center * center, 2.0 * center, -1.0];
        // Along the side the radius is a linear function of the height, from one circle to the other.
        let cos = ((1.0 - sin) * (1.0 + sin)).sqrt();
        let (start, end) = (bottom * cos, top * cos);
        let slope = (end - start) / (high - low);
        let at_zero = start - slope * low;
        [
            Slice { from: -h - bottom, to: low, radius_squared: ball(-h, bottom) },
            Slice {
                from: low,
                to: high,
                radius_squared: [at_zero * at_zero, 2.0 * at_zero * slope, slope * slope],
            },
            Slice { from: high, to: h + top, radius_squared: ball(h, top) },
        ]
    }
}

/// Solid of revolution between two heights whose radius at height y is the root of `a + b y + c y²`: a part of a ball,
/// cylinder or cone.
#[derive(Clone, Copy, Debug)]
pub struct Slice {
    /// Smallest height, metres.
    pub from: f64,
    /// Largest height, metres.
    pub to: f64,
    /// Squared radius as a polynomial of the height, `[a, b, c]` for `a + b y + c y²`, m².
    pub radius_squared: [f64; 3],
}

impl Slice {
    /// Squared radius at a height, m², ≥ 0.
    pub fn radius_squared_at(&self, y: f64) -> f64 {
        let [a, b, c] = self.radius_squared;
        let squared = a + y * (b + y * c);
        if squared > 0.0 { squared } else { 0.0 }
    }

    /// `∫ r²`, `∫ r² y`, `∫ r² y²` and `∫ r⁴` over the height of the slice.
    fn integrals(&self) -> [f64; 4] {
        let [a, b, c] = self.radius_squared;
        // Integrated powers of y.
        let (mut low, mut high) = (1.0, 1.0);
        let p: [f64; 5] = core::array::from_fn(|k| {
            (low, high) = (low * self.from, high * self.to);
            (high - low) / (k + 1) as f64
        });
        [
            a * p[0] + b * p[1] + c * p[2],
            a * p[1] + b * p[2] + c * p[3],
            a * p[2] + b * p[3] + c * p[4],
            a * a * p[0]
                + 2.0 * a * b * p[1]
                + (b * b + 2.0 * a * c) * p[2]
                + 2.0 * b * c * p[3]
                + c * c * p[4],
        ]
    }
}

/// Returns the total volume of slices, m³.
pub fn volume(slices: &[Slice]) -> f32 {
    (slices.iter().map(|slice| slice.integrals()[0]).sum::<f64>() * f64::from(PI)) as f32
}

/// Returns the mass properties of slices of one solid at `density` (kg/m³), in the frame of the solid.
///
/// A disk of radius r and mass m has the moment of inertia `½ m r²` about the axis and `¼ m r²` about a diameter.
pub fn mass_properties(slices: &[Slice], density: f32) -> MassProperties {
    let mut sums = [0.0; 4];
    for slice in slices {
        for (sum, part) in sums.iter_mut().zip(slice.integrals()) {
            *sum += part;
        }
    }
    let [area, moment, second, fourth] = sums;
    let center = moment / area;
    let per_length = f64::from(density) * f64::from(PI);
    let axial = (0.5 * per_length * fourth) as f32;
    let across = (per_length * (0.25 * fourth + second - moment * center)) as f32;
    MassProperties {
        mass: (per_length * area) as f32,
        center: Vec3::new(0.0, center as f32, 0.0),
        inertia: Sym3::from_diagonal(Vec3::new(across, axial, across)),
    }
}
