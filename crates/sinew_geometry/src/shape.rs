//! Collision shapes: their kinds and sizes.

use crate::boxes::Aabb;
use crate::def_error::DefError;
use crate::hull::{Hull, HullError};
use crate::triangles::{HeightField, Mesh, MeshError, Surface};
use sinew_math::{Sym3, Vec3, abs3, max, max3, min};
use std::sync::Arc;

/// A shape in its own frame. All sizes are in metres and positive unless noted. All shapes are convex, except meshes
/// and height fields.
#[doc(alias = "collider")]
#[doc(alias = "SharedShape")]
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Shape {
    /// Box around the origin.
    Box {
        /// Half extents.
        half_extents: Vec3,
    },
    /// Ball around the origin.
    Sphere {
        /// Radius.
        radius: f32,
    },
    /// Segment along y from −`half_height` to `half_height`, with a radius.
    Capsule {
        /// Half the length of the segment, without the caps; may be 0.
        half_height: f32,
        /// Radius.
        radius: f32,
    },
    /// Convex hull of two balls on the y axis, around −`half_height` and `half_height`. Neither ball may contain the
    /// other: the radii differ by less than the distance between the centres.
    TaperedCapsule {
        /// Half the distance between the balls' centres.
        half_height: f32,
        /// Radius of the ball at −`half_height`.
        radius_bottom: f32,
        /// Radius of the ball at `half_height`.
        radius_top: f32,
    },
    /// Flat-ended cylinder along y from −`half_height` to `half_height`.
    Cylinder {
        /// Half the length.
        half_height: f32,
        /// Radius.
        radius: f32,
    },
    /// Cone along y: its base at −`half_height`, its apex at `half_height`.
    Cone {
        /// Half the distance from base to apex.
        half_height: f32,
        /// Radius of the base.
        radius: f32,
    },
    /// The half-space below the plane y = 0 of its frame. Static bodies only.
    HalfSpace,
    /// Convex solid with flat faces; its origin may be outside.
    Hull(#[cfg_attr(feature = "serde", serde(with = "crate::serial::hull"))] Arc<Hull>),
    /// Surface of one-sided triangles. It has no volume and so no mass of its own: use it for static and kinematic
    /// bodies, or give the body a mass.
    Mesh(#[cfg_attr(feature = "serde", serde(with = "crate::serial::mesh"))] Arc<Mesh>),
    /// Terrain over the x and z axes, solid from above. Like a mesh, it has no mass of its own.
    HeightField(#[cfg_attr(feature = "serde", serde(with = "crate::serial::height_field"))] Arc<HeightField>),
}

/// Short constructors. They do not check sizes; [`Shape::check`] and `World` do.
impl Shape {
    /// Returns a box around the origin by its half extents, metres.
    #[doc(alias = "box")]
    pub fn cuboid(half_extents: Vec3) -> Self {
        Self::Box { half_extents }
    }

    /// Returns a ball around the origin by its radius, metres.
    #[doc(alias = "ball")]
    pub fn sphere(radius: f32) -> Self {
        Self::Sphere { radius }
    }

    /// Returns a capsule along y by half the length of its segment, without the caps, and its radius, metres.
    pub fn capsule(half_height: f32, radius: f32) -> Self {
        Self::Capsule { half_height, radius }
    }

    /// Returns a cylinder along y by half its length and its radius, metres.
    pub fn cylinder(half_height: f32, radius: f32) -> Self {
        Self::Cylinder { half_height, radius }
    }

    /// Returns a cone along y by half the distance from base to apex and the radius of its base, metres.
    pub fn cone(half_height: f32, radius: f32) -> Self {
        Self::Cone { half_height, radius }
    }

    /// Builds the convex hull of points, metres.
    ///
    /// # Errors
    /// If the points span no solid: see [`Hull::new`].
    #[doc(alias = "convex_hull")]
    pub fn hull(points: &[Vec3]) -> Result<Self, HullError> {
        Hull::new(points).map(|hull| Self::Hull(Arc::new(hull)))
    }

    /// Builds a mesh from vertices (metres) and three vertex indices per triangle, counter-clockwise seen from outside.
    ///
    /// # Errors
    /// If a number is not finite or an index is out of range: see [`Mesh::new`].
    #[doc(alias = "trimesh")]
    pub fn mesh(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        Mesh::new(vertices, triangles).map(|mesh| Self::Mesh(Arc::new(mesh)))
    }
}

impl Shape {
    /// Checks that the sizes are finite and positive (a capsule's half height may be 0), and that no end of a tapered
    /// capsule contains the other.
    ///
    /// # Errors
    /// The reason for the first invalid size, in lower case.
    pub fn check(&self) -> Result<(), DefError> {
        // The comparison is false for NaN, so NaN is rejected.
        let positive = |x: f32| x > 0.0 && x < f32::INFINITY;
        match *self {
            Self::Box { half_extents: h } if !(positive(h.x) && positive(h.y) && positive(h.z)) => {
                Err(DefError::new("half extents of a box must be positive and finite"))
            }
            Self::Sphere { radius } | Self::Capsule { radius, .. } if !positive(radius) => {
                Err(DefError::new("a radius must be positive and finite"))
            }
            Self::Capsule { half_height, .. } if !(half_height == 0.0 || positive(half_height)) => {
                Err(DefError::new("half height of a capsule must not be negative, and finite"))
            }
            Self::TaperedCapsule { half_height, radius_bottom, radius_top } => {
                if !(positive(half_height) && positive(radius_bottom) && positive(radius_top)) {
                    Err(DefError::new(
                        "half height and radii of a tapered capsule must be positive and finite",
                    ))
                } else if (radius_bottom - radius_top).abs() >= 2.0 * half_height {
                    Err(DefError::new("one end of a tapered capsule must not hold the other"))
                } else {
                    Ok(())
                }
            }
            Self::Cylinder { half_height, radius } if !(positive(half_height) && positive(radius)) => {
                Err(DefError::new("half height and radius of a cylinder must be positive and finite"))
            }
            Self::Cone { half_height, radius } if !(positive(half_height) && positive(radius)) => {
                Err(DefError::new("half height and radius of a cone must be positive and finite"))
            }
            _ => Ok(()),
        }
    }

    /// Radius of the largest inscribed ball, metres. For a hull, the ball is centred at the hull's centre of mass.
    /// Infinite for half-spaces, meshes and height fields.
    #[inline]
    pub fn inner_radius(&self) -> f32 {
        match *self {
            Self::Box { half_extents: h } => min(min(h.x, h.y), h.z),
            Self::Sphere { radius } | Self::Capsule { radius, .. } => radius,
            Self::TaperedCapsule { radius_bottom, radius_top, .. } => max(radius_bottom, radius_top),
            Self::Cylinder { half_height, radius } => min(half_height, radius),
            // Radius of the circle inscribed in the cone's cross section, an isosceles triangle: twice the triangle's
            // area divided by its perimeter.
            Self::Cone { half_height, radius } => {
                let slant = (radius * radius + 4.0 * half_height * half_height).sqrt();
                2.0 * half_height * (radius / (radius + slant))
            }
            Self::HalfSpace | Self::Mesh(_) | Self::HeightField(_) => f32::INFINITY,
            Self::Hull(ref hull) => hull.inner_radius(),
        }
    }

    /// Radius of the smallest ball around the shape's origin that contains the shape, metres. Infinite for a
    /// half-space.
    #[inline]
    pub fn bounding_radius(&self) -> f32 {
        match *self {
            Self::Box { half_extents } => half_extents.length(),
            Self::Sphere { radius } => radius,
            Self::Capsule { half_height, radius } => half_height + radius,
            Self::TaperedCapsule { half_height, radius_bottom, radius_top } => {
                half_height + max(radius_bottom, radius_top)
            }
            Self::Cylinder { half_height, radius } | Self::Cone { half_height, radius } => {
                (half_height * half_height + radius * radius).sqrt()
            }
            Self::HalfSpace => f32::INFINITY,
            Self::Mesh(ref mesh) => reach(&mesh.bounds()),
            Self::HeightField(ref field) => reach(&field.bounds()),
            Self::Hull(ref hull) => hull.bounding_radius(),
        }
    }

    /// True if the shape has a volume, from which a density gives its mass.
    #[inline]
    pub fn is_solid(&self) -> bool {
        !matches!(self, Self::HalfSpace | Self::Mesh(_) | Self::HeightField(_))
    }

    /// Twice the [`inner_radius`](Self::inner_radius), metres; slop and speculative distance scale with it. Infinite
    /// for half-spaces, meshes and height fields.
    #[inline]
    pub fn smallest_extent(&self) -> f32 {
        2.0 * self.inner_radius()
    }
}

/// Distance from the origin to the farthest corner of bounds, metres.
fn reach(bounds: &Aabb) -> f32 {
    max3(abs3(bounds.min), abs3(bounds.max)).length()
}

/// Mass, centre of mass and inertia.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MassProperties {
    /// Mass, kg.
    pub mass: f32,
    /// Centre of mass in the given frame, metres.
    pub center: Vec3,
    /// Inertia about the centre of mass, in the axes of the given frame, kg·m².
    pub inertia: Sym3,
}

impl Shape {
    /// Returns the shape as a surface, if it consists of triangles.
    #[inline]
    pub fn surface(&self) -> Option<Surface<'_>> {
        match self {
            Self::Mesh(mesh) => Some(Surface::Mesh(mesh)),
            Self::HeightField(field) => Some(Surface::HeightField(field)),
            _ => None,
        }
    }
}
