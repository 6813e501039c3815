//! Mass, centre of mass and inertia of shapes, in closed form; a hull stores its own.

use crate::revolved::{self, TaperedCapsule, TruncatedCone};
use crate::shape::{MassProperties, Shape};
use core::f32::consts::PI;
use sinew_math::{Sym3, Transform, Vec3};

impl Shape {
    /// Volume, m³; 0 for half-spaces, which are unbounded, and for meshes and height fields, which may be open.
    pub fn volume(&self) -> f32 {
        match *self {
            Shape::Box { half_extents: h } => 8.0 * h.x * h.y * h.z,
            Shape::Sphere { radius } => ball_volume(radius),
            Shape::Capsule { half_height, radius } => {
                cylinder_volume(half_height, radius) + ball_volume(radius)
            }
            Shape::Cylinder { half_height, radius } => cylinder_volume(half_height, radius),
            Shape::Cone { half_height, radius } => cylinder_volume(half_height, radius) / 3.0,
            Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
                revolved::volume(&TaperedCapsule::new(half_height, radius_bottom, radius_top).slices())
            }
            Shape::HalfSpace | Shape::Mesh(_) | Shape::HeightField(_) => 0.0,
            Shape::Hull(ref hull) => hull.volume(),
        }
    }

    /// Mass properties in the shape's frame at `density` (kg/m³, ≥ 0); zero for shapes without volume.
    pub fn mass_properties(&self, density: f32) -> MassProperties {
        let mass = density * self.volume();
        let diagonal = match *self {
            Shape::Box { half_extents } => box_inertia(half_extents, mass),
            Shape::Sphere { radius } => Vec3::splat(0.4 * mass * radius * radius),
            Shape::Capsule { half_height, radius } => capsule_inertia(half_height, radius, density),
            Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
                let slices = TaperedCapsule::new(half_height, radius_bottom, radius_top).slices();
                return revolved::mass_properties(&slices, density);
            }
            Shape::Cylinder { half_height, radius } => {
                return revolved::mass_properties(
                    &TruncatedCone::cylinder(half_height, radius).slices(),
                    density,
                );
            }
            Shape::Cone { half_height, radius } => {
                return revolved::mass_properties(
                    &TruncatedCone::cone(half_height, radius).slices(),
                    density,
                );
            }
            Shape::HalfSpace | Shape::Mesh(_) | Shape::HeightField(_) => Vec3::ZERO,
            Shape::Hull(ref hull) => {
                return MassProperties { mass, center: hull.center(), inertia: hull.inertia() * density };
            }
        };
        MassProperties { mass, center: Vec3::ZERO, inertia: Sym3::from_diagonal(diagonal) }
    }
}

/// Moments of inertia of a box about its centre, along its axes, kg·m².
pub(crate) fn box_inertia(h: Vec3, mass: f32) -> Vec3 {
    Vec3::new(h.y * h.y + h.z * h.z, h.x * h.x + h.z * h.z, h.x * h.x + h.y * h.y) * (mass / 3.0)
}

fn ball_volume(radius: f32) -> f32 {
    4.0 / 3.0 * PI * radius * radius * radius
}

fn cylinder_volume(half_height: f32, radius: f32) -> f32 {
    2.0 * PI * half_height * radius * radius
}

/// Moments of inertia of a cylinder and two half balls, whose centres of mass are 3/8 r beyond the cylinder's ends;
/// axis along y.
fn capsule_inertia(half_height: f32, radius: f32, density: f32) -> Vec3 {
    let (h2, r2) = (half_height * half_height, radius * radius);
    let cylinder = density * cylinder_volume(half_height, radius);
    let caps = density * ball_volume(radius);
    let axial = 0.5 * cylinder * r2 + 0.4 * caps * r2;
    let across = cylinder * (0.25 * r2 + h2 / 3.0) + caps * (0.4 * r2 + h2 + 0.75 * half_height * radius);
    Vec3::new(across, axial, across)
}

impl MassProperties {
    /// Returns the combined properties of two bodies in the same frame (parallel axis theorem).
    #[must_use]
    pub fn combine(&self, other: &Self) -> Self {
        let mass = self.mass + other.mass;
        if mass <= 0.0 {
            return Self { mass, center: self.center, inertia: self.inertia + other.inertia };
        }
        // Positions are relative to this centre, because sums of large coordinates would lose small differences.
        let apart = other.center - self.center;
        let reduced = self.mass * other.mass / mass;
        Self {
            mass,
            center: self.center + apart * (other.mass / mass),
            inertia: self.inertia + other.inertia + point_inertia(apart) * reduced,
        }
    }

    /// Converts the properties to another frame.
    #[must_use]
    pub fn transformed(&self, frame_from_this: &Transform) -> Self {
        Self {
            mass: self.mass,
            center: frame_from_this.point(self.center),
            inertia: self.inertia.rotated(frame_from_this.rotation),
        }
    }

    /// Returns the same distribution with another total mass (kg, ≥ 0). If the mass was 0, the result is a point mass.
    #[must_use]
    pub fn scaled_to(&self, mass: f32) -> Self {
        let factor = if self.mass > 0.0 { mass / self.mass } else { 0.0 };
        Self { mass, center: self.center, inertia: self.inertia * factor }
    }
}

/// Inertia of a unit point mass at `r` about the origin, m²: `|r|² − r rᵀ`.
fn point_inertia(r: Vec3) -> Sym3 {
    Sym3::IDENTITY * r.dot(r) - Sym3::outer(r)
}
