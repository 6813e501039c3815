//! Garments that settings ask for: of which chains, of what cloth.

use super::{SettingsError, instead};
use crate::build::joint_name;
use sinew_anim::garments::{is_ring, side_by_side};
use sinew_anim::{Garment, GarmentColumn, JointIdx, Rig, guess_garments};

/// Source of the garments that a character wears.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum GarmentSource {
    /// None. Default: no file states any.
    #[default]
    None,
    /// Garments that names of joints tell ([`guess_garments`]).
    Names,
    /// These.
    Listed(Vec<GarmentSettings>),
}

/// Garment as settings describe it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GarmentSettings {
    /// Names of the joints that its chains start at, side by side; one that ends in `*` stands for all joints whose names begin so and that do not hang on
    /// another such, in the order in which they lie side by side.
    pub chains: Vec<String>,
    /// True: the last chain is sewn to the first. `None`: if they stand in a ring.
    pub closed: Option<bool>,
    /// Name and cloth; its columns do not matter.
    pub cloth: Garment,
}

impl GarmentSource {
    /// Garments of a rig.
    ///
    /// # Errors
    /// Names that the rig does not have, with the nearest ones, and less than two chains: with the place.
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

/// Chains that a name stands for, side by side, at least one.
pub(super) fn columns(rig: &Rig, name: &str, place: &str) -> Result<Vec<GarmentColumn>, SettingsError> {
    let tops = tops(rig, name, place)?;
    let below: Vec<GarmentColumn> = tops.iter().map(|&top| GarmentColumn::below(rig, top)).collect();
    Ok(if name.ends_with('*') { side_by_side(rig, &below) } else { below })
}

/// Joints that a name of a chain stands for, at least one.
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
