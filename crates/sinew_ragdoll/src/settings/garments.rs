//! Garments requested by settings: their chains and their cloth.

use super::{SettingsError, instead};
use crate::build::joint_name;
use sinew_anim::garments::{
    MOST_PARTICLES, MeshPart, MeshSheet, SheetError, SheetOptions, is_ring, lay_sheet, side_by_side,
};
use sinew_anim::{Garment, GarmentColumn, JointIdx, Rig, RigAnalysis, guess_garments};
use sinew_math::{Affine, Rotation, Vec3};

/// Source of the garments that a character wears.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum GarmentSource {
    /// No garments. Default, because files do not declare garments.
    #[default]
    None,
    /// Garments inferred from joint names ([`guess_garments`]).
    Names,
    /// The listed garments.
    Listed(Vec<GarmentSettings>),
}

/// A garment as described by settings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GarmentSettings {
    /// Names of the first joints of the garment's chains, side by side. A name that ends in `*` matches all joints with
    /// that prefix that are not descendants of another match, in spatial order.
    pub chains: Vec<String>,
    /// Mesh of the garment, if it has no chains.
    pub mesh: Option<MeshSettings>,
    /// True if the last chain is sewn to the first. `None`: sewn if the chains form a ring.
    pub closed: Option<bool>,
    /// Name and cloth of the garment; its columns are ignored.
    pub cloth: Garment,
}

/// A mesh of the character that is a garment, as described by settings.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshSettings {
    /// Name of the mesh, of its node, or of one of its materials.
    pub name: String,
    /// Depth below the mesh's highest point down to which bodies hold it, metres, ≥ 0; `None`: a tenth of its height.
    pub held: Option<f32>,
    /// Largest number of particles, at least 4: finer meshes are reduced. Default [`MOST_PARTICLES`].
    pub most_particles: usize,
}

impl MeshSettings {
    /// Creates settings for a mesh, with defaults for everything else.
    pub fn new(name: &str) -> Self {
        Self { name: name.to_owned(), held: None, most_particles: MOST_PARTICLES }
    }
}

impl GarmentSource {
    /// Returns true if the source lists a mesh.
    pub fn has_meshes(&self) -> bool {
        matches!(self, Self::Listed(listed) if listed.iter().any(|garment| garment.mesh.is_some()))
    }

    /// Removes the garments that are made from meshes.
    pub fn leave_meshes(&mut self) {
        if let Self::Listed(listed) = self {
            listed.retain(|garment| garment.mesh.is_none());
        }
    }

    /// Makes sheets of the listed meshes ([`Rig::sheets`]), with one new joint per particle. Call it before the rig is
    /// analysed for the build. `analysis` belongs to the current rig, with the requested unit and axis; nodes of its
    /// file have indices below `nodes`.
    ///
    /// # Errors
    /// For names that the rig does not have, with the nearest ones, and meshes that cannot be cloth; with the setting's
    /// key.
    pub fn lay_sheets(
        &self,
        rig: &mut Rig,
        analysis: &RigAnalysis,
        nodes: usize,
    ) -> Result<(), SettingsError> {
        let Self::Listed(listed) = self else { return Ok(()) };
        // New joints have no bind pose yet, and none of them moves the remaining meshes.
        for (index, garment) in listed.iter().enumerate() {
            let Some(mesh) = &garment.mesh else { continue };
            let located = |error: SheetError| mesh.error(rig, index, &error);
            let part = MeshPart::named(rig, &mesh.name).map_err(located)?;
            let options = SheetOptions {
                bind_model: &analysis.bind_model,
                metres_from_model: metres_from_model(analysis),
                spacing: garment.cloth.spacing,
                held: mesh.held,
                most_particles: mesh.most_particles,
                first_source: nodes + rig.sheets.iter().map(|sheet| sheet.joints.len()).sum::<usize>(),
            };
            if let Err(error) = lay_sheet(rig, &part, &options) {
                return Err(mesh.error(rig, index, &error));
            }
        }
        Ok(())
    }

    /// Returns the joints of garments, which are not part of the body: those of the listed chains and of all sheets.
    ///
    /// # Errors
    /// As [`garments`](Self::garments).
    pub fn joints(&self, rig: &Rig) -> Result<Vec<JointIdx>, SettingsError> {
        let garments = match self {
            Self::Listed(listed) => {
                let chains = listed.iter().enumerate().filter(|(_, garment)| garment.mesh.is_none());
                chains.map(|(index, garment)| garment.on(rig, index)).collect::<Result<Vec<_>, _>>()?
            }
            other => other.garments(rig)?,
        };
        let of_sheets = rig.sheets.iter().flat_map(|sheet| sheet.joints.iter().copied());
        Ok(garments.iter().flat_map(Garment::joints).chain(of_sheets).collect())
    }

    /// Returns the garments of a rig whose sheets exist ([`lay_sheets`](Self::lay_sheets)).
    ///
    /// # Errors
    /// For names that the rig does not have, with the nearest ones, fewer than two chains, and a mesh without a sheet;
    /// with the setting's key.
    pub fn garments(&self, rig: &Rig) -> Result<Vec<Garment>, SettingsError> {
        match self {
            Self::None => Ok(Vec::new()),
            Self::Names => Ok(guess_garments(rig)),
            Self::Listed(listed) => {
                listed.iter().enumerate().map(|(index, garment)| garment.on(rig, index)).collect()
            }
        }
    }
}

impl GarmentSettings {
    fn on(&self, rig: &Rig, index: usize) -> Result<Garment, SettingsError> {
        if let Some(mesh) = &self.mesh {
            return match rig.sheets.iter().find(|sheet| sheet.name == mesh.name) {
                Some(sheet) => Ok(Garment { sheet: Some(MeshSheet::clone(sheet)), ..self.cloth.clone() }),
                None => Err(SettingsError::at(
                    format!("garments[{index}].mesh"),
                    "no sheet was made of that mesh",
                )),
            };
        }
        let mut columns = Vec::new();
        for (chain, name) in self.chains.iter().enumerate() {
            columns.extend(self::columns(rig, name, &format!("garments[{index}].chains[{chain}]"))?);
        }
        if columns.len() < 2 {
            let what = format!("a garment is sewn of two chains at least, and this has {}", columns.len());
            return Err(SettingsError::at(format!("garments[{index}].chains"), what));
        }
        let closed = self.closed.unwrap_or_else(|| is_ring(rig, &columns));
        Ok(Garment { columns, closed, ..self.cloth.clone() })
    }
}

impl MeshSettings {
    fn error(&self, rig: &Rig, index: usize, error: &SheetError) -> SettingsError {
        let place = |key: &str| format!("garments[{index}].{key}");
        match error {
            SheetError::Unknown => {
                let names = MeshPart::names(rig);
                let shown = self.name.escape_debug();
                let instead = instead(&self.name, names.iter().map(String::as_str));
                SettingsError::at(place("mesh"), format!("no mesh or material `{shown}` on bones; {instead}"))
            }
            SheetError::AllHeld | SheetError::MostlyLoose if self.held.is_some() => {
                SettingsError::at(place("held"), error.to_string())
            }
            error => SettingsError::at(place("mesh"), error.to_string()),
        }
    }
}

/// Returns the transform from model space to metres with +Y up, at any position.
fn metres_from_model(analysis: &RigAnalysis) -> Affine {
    Affine::from_scale_rotation_translation(
        Vec3::splat(analysis.unit_scale),
        Rotation::from_arc(analysis.up_axis, Vec3::Y),
        Vec3::ZERO,
    )
}

/// Returns the chains that a name matches, side by side, at least one.
pub(super) fn columns(rig: &Rig, name: &str, place: &str) -> Result<Vec<GarmentColumn>, SettingsError> {
    let tops = tops(rig, name, place)?;
    let below: Vec<GarmentColumn> = tops.iter().map(|&top| GarmentColumn::below(rig, top)).collect();
    Ok(if name.ends_with('*') { side_by_side(rig, &below) } else { below })
}

/// Returns the joints that a chain name matches, at least one.
fn tops(rig: &Rig, name: &str, place: &str) -> Result<Vec<JointIdx>, SettingsError> {
    let names: Vec<String> = (0..rig.joints.len()).map(|joint| joint_name(rig, joint)).collect();
    let fits = |joint: JointIdx| match name.strip_suffix('*') {
        Some(start) => names[joint].starts_with(start),
        None => names[joint] == name,
    };
    let hangs = |joint: JointIdx| {
        let mut at = rig.joints[joint].parent;
        while let Some(parent) = at.filter(|&parent| !fits(parent)) {
            at = rig.joints[parent].parent;
        }
        at.is_some()
    };
    let found: Vec<JointIdx> = (0..names.len()).filter(|&joint| fits(joint) && !hangs(joint)).collect();
    if found.is_empty() {
        let what =
            format!("no bone `{}`; {}", name.escape_debug(), instead(name, names.iter().map(String::as_str)));
        return Err(SettingsError::at(place, what));
    }
    Ok(found)
}
