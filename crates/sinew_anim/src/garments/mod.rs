//! Garments of a rig: capes, skirts and coats on chains of joints, given by the user ([`Garment::on_chains`]) or
//! guessed from names ([`guess_garments`]), and meshes used as cloth ([`lay_sheet`]).
//!
//! Plain data: `sinew_ragdoll::garments` simulates them. Unlike springs, whose chains swing separately, a garment is
//! **one sheet**: its chains are sewn together side by side, and forces with bodies act both ways.
//!
//! ```
//! use sinew_anim::{Garment, Joint, LocalTransform, Rig};
//! use sinew_math::Vec3;
//!
//! let mut rig = Rig::default();
//! let mut add = |name: &str, parent, x: f32, y: f32| {
//!     let rest = LocalTransform { translation: Vec3::new(x, y, 0.0), ..LocalTransform::default() };
//!     rig.joints.push(Joint { name: name.into(), parent, rest, source: rig.joints.len() });
//!     rig.joints.len() - 1
//! };
//! let chest = add("chest", None, 0.0, 1.4);
//! for (name, x) in [("cape_l", 0.2), ("cape_r", -0.2), ("cape_m", 0.0)] {
//!     let top = add(&format!("{name}_1"), Some(chest), x, 0.0);
//!     let middle = add(&format!("{name}_2"), Some(top), 0.0, -0.4);
//!     add(&format!("{name}_3"), Some(middle), 0.0, -0.4);
//! }
//! // Side by side, in any order of the file.
//! let cape = &sinew_anim::guess_garments(&rig)[0];
//! let tops = cape.columns.iter().map(|column| rig.joints[column.joints[0]].name.as_str());
//! assert_eq!((tops.collect::<Vec<_>>(), cape.closed), (vec!["cape_l_1", "cape_m_1", "cape_r_1"], false));
//! ```

mod columns;
mod guess;
pub(crate) mod mesh_sheet;
mod sheet;
mod ways;

pub use crate::tuning::MOST_PARTICLES;
pub use columns::{is_ring, side_by_side};
pub use guess::guess_garments;
pub use mesh_sheet::MeshSheet;
pub use sheet::{MeshPart, SheetError, SheetOptions, lay_sheet};
pub use ways::Ways;

use crate::rig::{JointIdx, Rig};
use sinew_math::Vec3;

/// Garment of cloth on the bones of a rig. Default: no columns, and the cloth of a cape.
#[derive(Clone, Debug, PartialEq)]
pub struct Garment {
    /// Name for people, or `""`.
    pub name: String,
    /// Chains of joints, side by side; no joint is in two. Empty for a sheet.
    pub columns: Vec<GarmentColumn>,
    /// Mesh of a garment without chains.
    pub sheet: Option<MeshSheet>,
    /// True: the last column is sewn to the first, as in a skirt. Default false.
    pub closed: bool,
    /// Mass per square metre of cloth, kg/m². Default 0.4: wool.
    pub area_density: f32,
    /// Distance of the cloth's mid-surface from bodies, metres. Default 0.015.
    pub radius: f32,
    /// Largest distance between neighbouring particles, metres. A limb of radius `R` does not pass between four
    /// particles if the square of the spacing is below `2 (2 R radius + radius²)`. Default 0.05, which stops shins.
    pub spacing: f32,
    /// Stiffness of a square of cloth against stretching along a thread, N/m. Default 2000.
    pub stretching: f32,
    /// Stiffness of a square of cloth against stretching along a diagonal, N/m, ≥ 0. Default 100.
    pub shearing: f32,
    /// Bending stiffness per width, N·m, ≥ 0. Default 1e-4.
    pub bending: f32,
    /// Damping ratio of each spring, ≥ 0. Default 0.2.
    pub damping_ratio: f32,
    /// Drag of still air, 1/s, ≥ 0. Default 0.5.
    pub drag: f32,
    /// Friction on bodies, ≥ 0. Default 0.3.
    pub friction: f32,
    /// False: the wearer's own arms pass through the garment. `None`: arms collide only if the garment is held above
    /// the pelvis, because swinging arms would catch a skirt against the thigh in every step.
    pub meets_arms: Option<bool>,
    /// Distance of folds from each other, metres, ≥ 0. Default 0: folds pass through each other.
    pub thickness: f32,
    /// Limit of the penetration into the body where shapes do not stop the cloth. Default `None`: no limit.
    pub backstop: Option<Backstop>,
}

/// Backstop of a garment: keeps each particle out of a ball behind its rest position, fixed to the nearest body part.
/// Keeps cloth out of drawn parts that no shape covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Backstop {
    /// Depth below its rest position that a particle may reach, inward along the garment's normal, metres, ≥ 0. Default
    /// 0.
    pub distance: f32,
    /// Radius of the ball, metres, positive. Default 0.2: nearly flat at the trunk, and no wider than a stride at a
    /// thigh.
    pub radius: f32,
}

impl Default for Backstop {
    fn default() -> Self {
        Self { distance: 0.0, radius: 0.2 }
    }
}

impl Default for Garment {
    fn default() -> Self {
        Self {
            name: String::new(),
            columns: Vec::new(),
            sheet: None,
            closed: false,
            area_density: 0.4,
            radius: 0.015,
            spacing: 0.05,
            stretching: 2000.0,
            shearing: 100.0,
            bending: 1e-4,
            damping_ratio: 0.2,
            drag: 0.5,
            friction: 0.3,
            meets_arms: None,
            thickness: 0.0,
            backstop: None,
        }
    }
}

/// Column of a garment: a chain of joints from the seam, where the body holds it, to the hem.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GarmentColumn {
    /// Joints from the seam to the hem, each the parent of the next.
    pub joints: Vec<JointIdx>,
    /// Position of the hem in the last joint's own space, file units. Zero: the last joint is at the hem and does not
    /// rotate.
    pub tip: Vec3,
}

impl Garment {
    /// Makes a garment on the chains that start at the joints `tops`, side by side; closed if they form a ring.
    ///
    /// # Panics
    /// If a joint does not exist.
    pub fn on_chains(rig: &Rig, tops: &[JointIdx]) -> Self {
        let columns: Vec<GarmentColumn> = tops.iter().map(|&top| GarmentColumn::below(rig, top)).collect();
        Self { closed: is_ring(rig, &columns), columns, ..Self::default() }
    }

    /// Makes a garment of a sheet.
    pub fn of_sheet(sheet: &MeshSheet) -> Self {
        Self { sheet: Some(sheet.clone()), ..Self::default() }
    }

    /// Iterates over all joints of the garment, by column or particle.
    pub fn joints(&self) -> impl Iterator<Item = JointIdx> {
        let of_columns = self.columns.iter().flat_map(|column| column.joints.iter().copied());
        of_columns.chain(self.sheet.iter().flat_map(|sheet| sheet.joints.iter().copied()))
    }
}
