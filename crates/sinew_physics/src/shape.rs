//! Collision shapes, and whom they meet.

use crate::contact_rule::ContactRule;
use crate::material::Material;
use sinew_math::{Sym3, Transform, Vec3, min};

/// A convex shape in its own frame. All sizes are metres and positive.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Box around the origin.
    Box {
        /// Half of each side.
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
    /// Everything below the plane y = 0 of its frame. Static bodies only.
    HalfSpace,
}

impl Shape {
    /// Whether its sizes are finite and positive (a capsule's half height may be 0); the phrase says what is wrong.
    ///
    /// # Errors
    /// What is wrong, in lower case.
    pub fn check(&self) -> Result<(), &'static str> {
        // Written so that NaN fails.
        let positive = |x: f32| x > 0.0 && x < f32::INFINITY;
        match *self {
            Self::Box { half_extents: h } if !(positive(h.x) && positive(h.y) && positive(h.z)) => {
                Err("half extents of a box must be positive and finite")
            }
            Self::Sphere { radius } | Self::Capsule { radius, .. } if !positive(radius) => {
                Err("a radius must be positive and finite")
            }
            Self::Capsule { half_height, .. } if !(half_height == 0.0 || positive(half_height)) => {
                Err("half height of a capsule must not be negative, and finite")
            }
            _ => Ok(()),
        }
    }

    /// Radius of the largest ball inside, metres: half the width where the shape is thinnest. Infinite for a
    /// half-space.
    pub fn inner_radius(&self) -> f32 {
        match *self {
            Self::Box { half_extents: h } => min(min(h.x, h.y), h.z),
            Self::Sphere { radius } | Self::Capsule { radius, .. } => radius,
            Self::HalfSpace => f32::INFINITY,
        }
    }

    /// Radius of the smallest ball around the shape's origin that holds it, metres. Infinite for a half-space.
    pub fn bounding_radius(&self) -> f32 {
        match *self {
            Self::Box { half_extents } => half_extents.length(),
            Self::Sphere { radius } => radius,
            Self::Capsule { half_height, radius } => half_height + radius,
            Self::HalfSpace => f32::INFINITY,
        }
    }

    /// Width where the shape is thinnest, metres: what slop and speculative distance scale with. Infinite for a
    /// half-space.
    pub fn smallest_extent(&self) -> f32 {
        2.0 * self.inner_radius()
    }
}

/// Two shapes meet if each one's mask holds the other's layer, and they are not in the same negative group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Filter {
    /// Bits of the layers it is on. Default 1.
    pub layers: u32,
    /// Bits of the layers it meets. Default all.
    pub mask: u32,
    /// Same non-zero group: positive always meets, negative never. Default 0: none.
    pub group: i32,
}

impl Default for Filter {
    fn default() -> Self {
        Self { layers: 1, mask: u32::MAX, group: 0 }
    }
}

impl Filter {
    /// Whether two shapes meet.
    pub fn meets(self, other: Self) -> bool {
        if self.group != 0 && self.group == other.group {
            return self.group > 0;
        }
        self.layers & other.mask != 0 && other.layers & self.mask != 0
    }
}

/// A shape as part of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeDef {
    /// Geometry.
    pub shape: Shape,
    /// Shape frame in the body's frame.
    pub body_from_shape: Transform,
    /// kg/m³, ≥ 0. Default 1000. Counts only where the body's mass is not given.
    pub density: f32,
    /// Surface.
    pub material: Material,
    /// Whom it meets.
    pub filter: Filter,
    /// Whether it pushes.
    pub sensing: Sensing,
    /// What becomes of its contacts. Default: as they are.
    pub rule: ContactRule,
}

/// What a shape does to those it meets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sensing {
    /// It pushes them. Default.
    #[default]
    Solid,
    /// It only reports them.
    Sensor,
}

impl ShapeDef {
    /// Whether its numbers make sense; the phrase says what is wrong.
    ///
    /// # Errors
    /// What is wrong, in lower case.
    pub fn check(&self) -> Result<(), &'static str> {
        self.shape.check()?;
        self.material.check()?;
        self.rule.check()?;
        let placed = self.body_from_shape.is_finite();
        // Written so that NaN fails.
        let dense = (0.0..f32::INFINITY).contains(&self.density);
        if placed && dense {
            Ok(())
        } else {
            Err("a shape's pose and density must be finite, density not negative")
        }
    }

    /// At the body's origin, with defaults.
    pub fn new(shape: Shape) -> Self {
        Self {
            shape,
            body_from_shape: Transform::IDENTITY,
            density: 1000.0,
            material: Material::default(),
            filter: Filter::default(),
            sensing: Sensing::Solid,
            rule: ContactRule::Push,
        }
    }
}

/// Mass, centre of mass and inertia.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MassProperties {
    /// kg.
    pub mass: f32,
    /// Centre of mass in the frame at hand, metres.
    pub center: Vec3,
    /// Inertia about the centre of mass, in the axes of the frame at hand, kg·m².
    pub inertia: Sym3,
}
