//! Settings that supply facts that the analysis cannot infer: roles, and joints that are not part of the body.

use super::bodies::placed;
use super::{Settings, SettingsError, instead};
use crate::build::joint_name;
use sinew_anim::roles::{Correction, CorrectionError, RigAnalysis, analyze_corrected};
use sinew_anim::{JointIdx, Rig};

/// Returns the correction that the settings request. If a value is set twice, the later setting wins.
pub(super) fn correction(rig: &Rig, settings: &Settings) -> Result<Correction, SettingsError> {
    let mut correction = Correction::default();
    for (name, bone) in &settings.bones {
        let Some(role) = bone.role else { continue };
        let joint = joints_named(rig, name, &place_of_role(name))?[0];
        correction.roles.retain(|&(other, at)| other != role && at != joint);
        correction.roles.push((role, joint));
    }
    for (index, name) in settings.ignore.iter().enumerate() {
        correction.ignored.extend(joints_named(rig, name, &format!("ignore[{index}]"))?);
    }
    correction.ignored.extend(settings.garments.joints(rig)?);
    Ok(correction)
}

fn place_of_role(bone: &str) -> String {
    format!("bones.{bone}.role")
}

/// Returns the analysis of the rig with the requested roles, axis and unit.
pub(super) fn corrected(
    rig: &Rig,
    seen: &Rig,
    analysis: &RigAnalysis,
    correction: &Correction,
    settings: &Settings,
) -> Result<RigAnalysis, SettingsError> {
    if correction.is_empty() {
        return placed(seen, analysis.clone(), settings);
    }
    let analyzed = analyze_corrected(rig, &analysis.hints, correction).map_err(|error| {
        let role = match error {
            CorrectionError::Twice(role)
            | CorrectionError::NoPart(role)
            | CorrectionError::NotHuman { role, .. } => role,
            CorrectionError::NoSkin(_) | CorrectionError::NothingLeft => {
                return SettingsError::at("ignore", error.to_string());
            }
        };
        let stated = settings.bones.iter().rev().find(|(_, bone)| bone.role == Some(role));
        let place = stated.map_or_else(|| "bones".to_owned(), |(name, _)| place_of_role(name));
        SettingsError::at(place, error.to_string())
    })?;
    placed(seen, analyzed, settings)
}

/// Returns the joints with that name, at least one.
fn joints_named(rig: &Rig, name: &str, place: &str) -> Result<Vec<JointIdx>, SettingsError> {
    let names: Vec<String> = (0..rig.joints.len()).map(|joint| joint_name(rig, joint)).collect();
    let found: Vec<JointIdx> = (0..names.len()).filter(|&joint| names[joint] == name).collect();
    if found.is_empty() {
        let what =
            format!("no bone `{}`; {}", name.escape_debug(), instead(name, names.iter().map(String::as_str)));
        return Err(SettingsError::at(place, what));
    }
    Ok(found)
}
