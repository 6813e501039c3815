//! Finds the allowed motion closest to a wanted one, for a few planes.

use sinew_math::Vec3;

/// Largest number of planes; those of farther touches are dropped.
pub(super) const MOST: usize = 24;

/// Bound on motion along a direction: `normal · x ≥ least`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub normal: Vec3,
    pub least: f32,
}

/// Set of a few planes, in a fixed array.
#[derive(Clone, Copy, Debug)]
pub(super) struct Planes {
    all: [Plane; MOST],
    count: usize,
}

/// Violation of a plane that counts as rounding, as a share of the motion's length, and in metres.
const FORGIVEN: f32 = 1e-5;
const FORGIVEN_LENGTH: f32 = 1e-7;
/// Largest cross product of two planes' normals at which the planes count as parallel. Three planes whose determinant
/// is below the square of this number have no corner.
const PARALLEL: f32 = 1e-3;

impl Planes {
    pub fn new() -> Self {
        Self { all: [Plane { normal: Vec3::ZERO, least: 0.0 }; MOST], count: 0 }
    }

    pub fn push(&mut self, normal: Vec3, least: f32) {
        let as_before = |plane: &Plane| plane.normal.dot(normal) > 0.99999;
        if let Some(same) = self.all[..self.count].iter_mut().find(|plane| as_before(plane)) {
            if least > same.least {
                *same = Plane { normal, least };
            }
        } else if self.count < MOST {
            self.all[self.count] = Plane { normal, least };
            self.count += 1;
        }
    }

    /// Forbids every approach to the planes from now on.
    pub fn stop(&mut self) {
        self.all[..self.count].iter_mut().for_each(|plane| plane.least = 0.0);
    }

    fn allow(&self, x: Vec3, scale: f32) -> bool {
        let forgiven = FORGIVEN * scale + FORGIVEN_LENGTH;
        self.all[..self.count].iter().all(|plane| plane.normal.dot(x) >= plane.least - forgiven)
    }

    /// Returns the allowed motion closest to `wanted`: unchanged, on one plane, along the crease of two or at the
    /// corner of three. `None` if the planes contradict each other.
    pub fn closest(&self, wanted: Vec3) -> Option<Vec3> {
        let scale = wanted.length();
        if self.allow(wanted, scale) {
            return Some(wanted);
        }
        let mut best: Option<(f32, Vec3)> = None;
        let mut consider = |x: Vec3| {
            let square = (x - wanted).length_squared();
            if best.is_none_or(|(least, _)| square < least) && self.allow(x, scale) {
                best = Some((square, x));
            }
        };
        let planes = &self.all[..self.count];
        for (i, p) in planes.iter().enumerate() {
            consider(wanted + p.normal * (p.least - p.normal.dot(wanted)));
            for (j, q) in planes[..i].iter().enumerate() {
                if let Some(x) = on_crease(wanted, p, q) {
                    consider(x);
                }
                for r in &planes[..j] {
                    if let Some(x) = corner(p, q, r) {
                        consider(x);
                    }
                }
            }
        }
        best.map(|(_, x)| x)
    }

    /// Returns the closest allowed motion, with a smaller weight on the vertical: planes reduce the climb first.
    pub fn closest_level(&self, wanted: Vec3, up: Vec3) -> Option<Vec3> {
        const UP: f32 = 0.03;
        let squeeze = |v: Vec3, by: f32| v + up * (v.dot(up) * (by - 1.0));
        let mut squeezed = Self::new();
        for plane in &self.all[..self.count] {
            let normal = squeeze(plane.normal, 1.0 / UP);
            let length = normal.length();
            squeezed.push(normal / length, plane.least / length);
        }
        squeezed.closest(squeeze(wanted, UP)).map(|x| squeeze(x, 1.0 / UP))
    }
}

fn on_crease(wanted: Vec3, p: &Plane, q: &Plane) -> Option<Vec3> {
    let c = p.normal.dot(q.normal);
    let free = p.normal.cross(q.normal).length_squared();
    if free < PARALLEL * PARALLEL {
        return None;
    }
    let (a, b) = (p.least - p.normal.dot(wanted), q.least - q.normal.dot(wanted));
    Some(wanted + p.normal * ((a - c * b) / free) + q.normal * ((b - c * a) / free))
}

fn corner(p: &Plane, q: &Plane, r: &Plane) -> Option<Vec3> {
    let span = p.normal.dot(q.normal.cross(r.normal));
    if span.abs() < PARALLEL * PARALLEL {
        return None;
    }
    let sum = q.normal.cross(r.normal) * p.least
        + r.normal.cross(p.normal) * q.least
        + p.normal.cross(q.normal) * r.least;
    Some(sum / span)
}
