//! Definition of a field.

use super::custom::PARAMETERS;
use super::{Buoyancy, Drag, MutualGravity, PointGravity, Region, UniformGravity, Wind};
use crate::arena::Item;
use crate::id::FieldId;
use sinew_geometry::DefError;
use sinew_math::Transform;

/// Definition of a field: its law, region and filter.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FieldDef {
    /// Kind of the field.
    pub kind: FieldKind,
    /// Region in which the field acts, tested at a body's centre of mass and a particle's position. Default everywhere.
    pub region: Region,
    /// Bits of the layers ([`Filter::layers`](crate::Filter)) that the field acts on. The field reaches a body if one
    /// of its shapes is on one of them, or if the body has no shape. Default all.
    pub layers: u32,
}

/// Kind of a field: the law by which it acts.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum FieldKind {
    /// Uniform acceleration, in addition to the world's own.
    Uniform(UniformGravity),
    /// Attraction toward a point.
    Point(PointGravity),
    /// Mutual attraction of bodies and particles.
    Mutual(MutualGravity),
    /// Moving air, with drag and lift by exposed area; still air is a wind of zero velocity.
    Wind(Wind),
    /// Drag by a velocity law, independent of the shape.
    Drag(Drag),
    /// Water below a plane.
    Buoyancy(Buoyancy),
    /// A function of the user, by the number under which it was registered
    /// ([`World::register_field`](crate::World::register_field)), with parameters.
    Custom {
        /// Number of the function.
        function: u32,
        /// Parameters with which the function is called.
        parameters: [f32; PARAMETERS],
    },
}

impl Item for FieldDef {
    type Id = FieldId;
}

impl FieldDef {
    /// Returns a field that acts everywhere, on all layers.
    pub fn new(kind: FieldKind) -> Self {
        Self { kind, region: Region::Everywhere, layers: u32::MAX }
    }

    /// Checks that the numbers of the definition are valid; the error phrase names the problem.
    ///
    /// # Errors
    /// Returns a phrase that names the problem, in lower case.
    pub fn check(&self) -> Result<(), DefError> {
        self.region.check()?;
        match &self.kind {
            FieldKind::Uniform(field) => field.check(),
            FieldKind::Point(field) => field.check(),
            FieldKind::Mutual(field) => field.check(),
            FieldKind::Wind(field) => field.check(),
            FieldKind::Drag(field) => field.check(),
            FieldKind::Buoyancy(field) => field.check(),
            FieldKind::Custom { parameters, .. } => {
                let finite = parameters.iter().all(|x| x.is_finite());
                if finite { Ok(()) } else { Err(DefError::new("a field's parameters must be finite")) }
            }
        }
    }
}

impl FieldKind {
    /// True if the field's effect on a body at rest changes with time.
    pub(crate) fn changes_by_itself(&self) -> bool {
        match self {
            Self::Wind(wind) => wind.gusts.is_some(),
            Self::Custom { .. } => true,
            Self::Uniform(_) | Self::Point(_) | Self::Mutual(_) | Self::Drag(_) | Self::Buoyancy(_) => false,
        }
    }
}

/// True if the pose is finite and its rotation is a unit quaternion.
pub(super) fn is_pose(pose: &Transform) -> bool {
    pose.is_finite() && (pose.rotation.length() - 1.0).abs() < 1e-3
}

/// True if a number is finite and not negative; false for NaN.
pub(super) fn not_negative(x: f32) -> bool {
    (0.0..f32::INFINITY).contains(&x)
}

/// True if a number is finite and positive; false for NaN.
pub(super) fn positive(x: f32) -> bool {
    x > 0.0 && x < f32::INFINITY
}
