//! Volume and centre of the part of a shape below a water plane, in closed form.

mod revolved;

use crate::revolved::{TaperedCapsule, TruncatedCone};
use crate::shape::Shape;
use core::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use revolved::revolved_below;
use sinew_math::trig::{acos, asin};
use sinew_math::{Transform, Vec3, clamp, max, normalize_or};

/// Surface of the water.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaterPlane {
    /// Unit vector out of the water.
    pub normal: Vec3,
    /// Height of the surface along the normal, metres: water is where `normal · x ≤ height`.
    pub height: f32,
}

impl WaterPlane {
    /// Height of a point above the surface, metres; negative below.
    pub fn above(&self, point: Vec3) -> f32 {
        self.normal.dot(point) - self.height
    }
}

/// Submerged part of a shape.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Submerged {
    /// Volume, m³.
    pub volume: f32,
    /// Volume times centre, m⁴. The moment of a body is the sum of the moments of its parts.
    moment: Vec3,
}

impl Submerged {
    /// Creates the part from its volume and its moment.
    fn of_moment(volume: f32, moment: Vec3) -> Self {
        Self { volume, moment }
    }

    fn new(volume: f32, center: Vec3) -> Self {
        Self { volume, moment: center * volume }
    }

    /// Centre of the submerged volume, in the frame of the query, metres; the origin if nothing is under water.
    pub fn center(&self) -> Vec3 {
        if self.volume > 0.0 { self.moment / self.volume } else { Vec3::ZERO }
    }

    fn plus(self, other: Self) -> Self {
        Self { volume: self.volume + other.volume, moment: self.moment + other.moment }
    }

    /// Scales the part by a length, then moves it.
    fn placed(self, scale: f32, to: Vec3) -> Self {
        let volume = self.volume * scale * scale * scale;
        Self { volume, moment: self.moment * (scale * scale * scale * scale) + to * volume }
    }
}

impl Shape {
    /// Returns the part of the placed shape below the water surface: its volume, and its centre in the world. The
    /// result is exact up to about 1e-5 of the volume; it is zero for half-spaces, meshes and height fields.
    pub fn submerged(&self, world_from_shape: &Transform, plane: &WaterPlane) -> Submerged {
        // Computed in the shape's frame, where all coordinates are small.
        let normal = world_from_shape.rotation.inverse() * plane.normal;
        let height = -plane.above(world_from_shape.translation);
        let reach = self.bounding_radius();
        let local = if height >= reach {
            let whole = self.mass_properties(1.0);
            Submerged::new(whole.mass, whole.center)
        } else if height <= -reach {
            Submerged::default()
        } else {
            match *self {
                Self::Box { half_extents } => box_below(half_extents, &WaterPlane { normal, height }),
                Self::Sphere { radius } => ball_below(height / radius, normal).placed(radius, Vec3::ZERO),
                Self::Capsule { half_height, radius } => {
                    capsule_below(half_height / radius, normal, height / radius).placed(radius, Vec3::ZERO)
                }
                Self::TaperedCapsule { half_height, radius_bottom, radius_top } => {
                    let slices = TaperedCapsule::new(half_height, radius_bottom, radius_top).slices();
                    revolved_below(&slices, &WaterPlane { normal, height })
                }
                Self::Cylinder { half_height, radius } => {
                    cylinder_below(half_height / radius, normal, height / radius).placed(radius, Vec3::ZERO)
                }
                Self::Cone { half_height, radius } => {
                    let slices = TruncatedCone::cone(half_height, radius).slices();
                    revolved_below(&slices, &WaterPlane { normal, height })
                }
                Self::HalfSpace | Self::Mesh(_) | Self::HeightField(_) => Submerged::default(),
                Self::Hull(ref hull) => {
                    let faces = hull.faces().map(|face| face.corners().map(|k| hull.vertices()[k]));
                    submerged_hull(faces, &WaterPlane { normal, height })
                }
            }
        };
        Submerged {
            volume: local.volume,
            moment: world_from_shape.rotation * local.moment + world_from_shape.translation * local.volume,
        }
    }
}

/// Part of the unit ball with `n·x ≤ s`, −1 ≤ s ≤ 1. A cap of height `h = 1 + s` has the volume `π h² (3 − h)/3`, and
/// its centre is at the distance `3 (2 − h)²/(4 (3 − h))` from the ball's centre.
fn ball_below(s: f32, normal: Vec3) -> Submerged {
    let h = 1.0 + clamp(s, -1.0, 1.0);
    let down = 0.75 * (2.0 - h) * (2.0 - h) / (3.0 - h);
    Submerged::new(PI / 3.0 * h * h * (3.0 - h), normal * -down)
}

/// Returns the part of a convex polyhedron below the surface. `faces` are the corners of each face in order,
/// counter-clockwise seen from outside. The centre is in the frame of the corners.
///
/// By the divergence theorem, the volume is the sum of the tetrahedra between one point and the triangles of all
/// clipped faces and of the cut. The point is **on the water surface**, so the tetrahedra over the cut have no volume
/// and are left out.
pub fn submerged_hull<F>(faces: impl Iterator<Item = F>, plane: &WaterPlane) -> Submerged
where
    F: Iterator<Item = Vec3> + Clone,
{
    let apex = plane.normal * plane.height;
    let mut sum = Submerged::default();
    for face in faces {
        let mut fan: Option<(Vec3, Vec3)> = None;
        clip(face, plane, |corner| {
            fan = match fan {
                None => Some((corner, corner)),
                Some((first, last)) => {
                    let volume = (first - apex).dot((last - apex).cross(corner - apex)) / 6.0;
                    sum = sum.plus(Submerged::new(volume, (apex + first + last + corner) * 0.25));
                    Some((first, corner))
                }
            };
        });
    }
    sum
}

/// Visits the corners of the submerged part of a polygon, in order (Sutherland and Hodgman 1974).
fn clip(face: impl Iterator<Item = Vec3> + Clone, plane: &WaterPlane, mut corner: impl FnMut(Vec3)) {
    let Some(last) = face.clone().last() else { return };
    let (mut from, mut above_from) = (last, plane.above(last));
    for to in face {
        let above_to = plane.above(to);
        if (above_from > 0.0) != (above_to > 0.0) {
            corner(from + (to - from) * (above_from / (above_from - above_to)));
        }
        if above_to <= 0.0 {
            corner(to);
        }
        (from, above_from) = (to, above_to);
    }
}

fn box_below(half: Vec3, plane: &WaterPlane) -> Submerged {
    let faces: [[Vec3; 4]; 6] = core::array::from_fn(|face| {
        let (k, side) = (face / 2, if face % 2 == 0 { 1.0 } else { -1.0 });
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        [(1.0, 1.0), (-side, side), (-1.0, -1.0), (side, -side)].map(|(u, v)| {
            let mut corner = Vec3::ZERO;
            corner[k] = side * half[k];
            corner[i] = u * half[i];
            corner[j] = v * half[j];
            corner
        })
    });
    submerged_hull(faces.into_iter().map(<[Vec3; 4]>::into_iter), plane)
}

/// Part of a capsule of radius 1 along y with `n·x ≤ s`: of its cylinder and its two half balls.
fn capsule_below(half_height: f32, normal: Vec3, s: f32) -> Submerged {
    let cap = Vec3::Y * half_height;
    [Vec3::Y, Vec3::NEG_Y].iter().zip([cap, -cap]).fold(
        cylinder_below(half_height, normal, s),
        |sum, (&axis, center)| {
            sum.plus(half_ball_below(axis, normal, s - normal.dot(center)).placed(1.0, center))
        },
    )
}

/// Part with `n·x ≤ s` of the half of the unit ball on the side `a·x ≥ 0`, by the divergence theorem. With `Ω` the area
/// of the remaining sphere, `A₁` of the flat side and `A₂` of the cut, `V = (Ω + s A₂)/3`. The moment is a quarter of
/// the sum of each face's moment times its distance; that of the sphere is `A₁ a − A₂ n`, since a closed surface has no
/// vector area. `Ω` is the half sphere minus its lens with the cap above the water, by Gauss and Bonnet.
fn half_ball_below(a: Vec3, n: Vec3, s: f32) -> Submerged {
    if s >= 1.0 {
        return Submerged::new(2.0 / 3.0 * PI, a * 0.375);
    }
    if s <= -1.0 {
        return Submerged::default();
    }
    let cos = clamp(a.dot(n), -1.0, 1.0);
    let across = a - n * cos;
    let sin = max(across.length(), 1e-6);
    let rho = max((1.0 - s * s).sqrt(), 1e-6);
    // Position along `across` at which the flat side meets the cut, in units of the cut's radius.
    let q = clamp(-s * cos / (sin * rho), -1.0, 1.0);
    let cut = rho * rho * segment(-q);
    let cut_moment = 2.0 / 3.0 * rho * rho * rho * (1.0 - q * q) * (1.0 - q * q).sqrt();
    let flat = segment(clamp(s / sin, -1.0, 1.0));
    let corner = acos(clamp(-cos / rho, -1.0, 1.0));
    let sphere = 2.0 * PI - (2.0 * corner - s * 2.0 * acos(q));
    let moment = (a * flat - n * (cut * (1.0 - s * s)) + across * (s * cut_moment / sin)) * 0.25;
    Submerged { volume: max((sphere + s * cut) / 3.0, 0.0), moment }
}

/// Area of the part with `x ≤ c` of the unit disk, −1 ≤ c ≤ 1.
fn segment(c: f32) -> f32 {
    FRAC_PI_2 + asin(c) + c * root(c)
}

fn root(c: f32) -> f32 {
    max(1.0 - c * c, 0.0).sqrt()
}

/// Part of a cylinder of radius 1 along y with `n·x ≤ s`. It consists of whole disks in one range of heights, and in
/// another range of disks that the water surface cuts at `x = c(y)`, where x is the direction from the axis up to the
/// surface.
fn cylinder_below(half_height: f32, normal: Vec3, s: f32) -> Submerged {
    // The cylinder is mirrored so that smaller y is deeper.
    let (mirror, cos) = if normal.y < 0.0 { (-1.0, -normal.y) } else { (1.0, normal.y) };
    let flat = Vec3::new(normal.x, 0.0, normal.z);
    let sin = max(flat.length(), 1e-6);
    let up = normalize_or(flat, Vec3::X);
    let reach = |c: f32| if cos > 1e-6 { clamp((s - c * sin) / cos, -half_height, half_height) } else { 0.0 };
    let (whole, partly) = if cos > 1e-6 {
        (reach(1.0), reach(-1.0))
    } else if s >= sin {
        (half_height, half_height)
    } else {
        (-half_height, half_height)
    };
    let below = Submerged::new(PI * (whole + half_height), Vec3::Y * (0.5 * (whole - half_height)));
    let at = |y: f32| clamp((s - y * cos) / sin, -1.0, 1.0);
    let (low, high) = (at(partly), at(whole));
    let (volume, along, aside) =
        if high - low < 0.3 { wedge_by_rule(whole, partly, at) } else { wedge(s, cos, sin, low, high) };
    let cut = Submerged { volume, moment: Vec3::Y * along + up * aside };
    let Submerged { volume, moment } = below.plus(cut);
    Submerged { volume, moment: Vec3::new(moment.x, moment.y * mirror, moment.z) }
}

/// Returns the volume of the cut part between `c = low` and `high`, and its moments along the axis and toward the
/// surface. Uses the antiderivatives of the disk's segment `A(c)`, of `c A(c)` and of the segment's moment `−⅔ (1 −
/// c²)^(3/2)`; `dy = −(sin/cos) dc`.
fn wedge(s: f32, cos: f32, sin: f32, low: f32, high: f32) -> (f32, f32, f32) {
    let area = |c: f32| FRAC_PI_2 * c + c * asin(c) + root(c) - root(c) * root(c) * root(c) / 3.0;
    let area_moment = |c: f32| {
        let arc = FRAC_PI_4 * c * c + (0.5 * c * c - 0.25) * asin(c) + 0.25 * c * root(c);
        arc + 0.125 * (asin(c) - c * (1.0 - 2.0 * c * c) * root(c))
    };
    let aside = |c: f32| -(c * (5.0 - 2.0 * c * c) * root(c) + 3.0 * asin(c)) / 12.0;
    let slope = sin / cos;
    let volume = area(high) - area(low);
    let along = (volume * s - (area_moment(high) - area_moment(low)) * sin) / cos;
    (slope * volume, slope * along, slope * (aside(high) - aside(low)))
}

/// Like [`wedge`], from `from` to `to` along the axis, by the three-point Gauss rule. Used if the cut hardly changes,
/// where rounding would dominate the differences in [`wedge`].
fn wedge_by_rule(from: f32, to: f32, at: impl Fn(f32) -> f32) -> (f32, f32, f32) {
    const NODES: [(f32, f32); 3] =
        [(-0.774_596_67, 0.555_555_56), (0.0, 0.888_888_9), (0.774_596_67, 0.555_555_56)];
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    NODES.iter().fold((0.0, 0.0, 0.0), |(volume, along, aside), &(node, weight)| {
        let y = middle + half * node;
        let (c, weight) = (at(y), weight * half);
        let area = weight * segment(c);
        let lever = -2.0 / 3.0 * root(c) * root(c) * root(c);
        (volume + area, along + area * y, aside + weight * lever)
    })
}
