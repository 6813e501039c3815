//! The falling character: its ragdoll, and its own or the built-in motions.

use super::clips::Motions;
use super::lies::lies;
use crate::failure::{Failure, Result};
use crate::input::files::CharacterFile;
use sinew::CharacterSource;
use sinew::anim::retarget::RetargetError;
use sinew::math::Vec3;
use sinew::motions::{BuiltinError, set_motions_with_builtin};
use sinew::ragdoll::{AfterSettling, CharacterDef, GroundContact, Locomotion, MotionSet, RagdollDef};

/// Get-ups that the user wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GetUps {
    /// Clips of the files, else built-in motions.
    Any,
    /// Clips of the files only.
    OfFiles,
    /// The clip with this index.
    Clip(usize),
    /// None.
    None,
}

/// Source of the get-up clips of a character.
#[derive(Clone, Debug, PartialEq)]
pub enum GetsUpBy {
    /// The file's own clips, or those of `--clips`.
    Own,
    /// The built-in motions.
    Builtin,
    /// Not wanted.
    Unwanted,
    /// No clips; contains the reason, appended to 'it does not get up: '.
    Nothing(String),
    /// The built-in motions, none of which works on this body; contains the reason, as above.
    Unfit(String),
}

impl GetsUpBy {
    /// Returns the flaw of a human that stays down because no built-in motion fits it.
    pub fn flaw(&self) -> Option<String> {
        let Self::Unfit(why) = self else { return None };
        Some(format!("it does not get up: {why}"))
    }
}

/// Advice for a user whose character has no get-up clips.
const CLIPS_HELP: &str = "--clips adds a file with a get-up clip, named for example 'get up'";

/// Returns the character and the source of its get-up motions.
pub fn actor(
    file: &CharacterFile,
    ragdoll: RagdollDef,
    motions: Motions,
    wanted: GetUps,
) -> Result<(CharacterDef, GetsUpBy)> {
    let CharacterFile { name, source: CharacterSource { document, analysis, .. } } = file;
    let failed = |error| Failure::of_file(name, error);
    let mut def = CharacterDef::new(document.rig.clone(), ragdoll, &analysis.bind_model);
    def.ground_contact = GroundContact::Enforced;
    let get_ups = match wanted {
        GetUps::Clip(clip) => vec![clip],
        _ => {
            let mut get_ups = def.get_ups_among(&motions.clips);
            get_ups.retain(|&clip| Some(clip) != motions.looped);
            get_ups
        }
    };
    let Motions { clips, looped, ahead, .. } = motions;
    // Otherwise a character that lies in its file would walk along its own axes into the floor.
    let is_lying = lies(&def.ragdoll, analysis.hints.up.unwrap_or(Vec3::Y));
    let locomotion = match ahead {
        _ if is_lying => Locomotion::Exact,
        0.0 => Locomotion::ByClip,
        speed => Locomotion::Forward { speed },
    };
    let own = MotionSet { clips, looped, get_ups, locomotion, ..MotionSet::default() };
    if wanted == GetUps::None {
        def.after_settling = AfterSettling::StayDown;
        def.set_motions(own).map_err(failed)?;
        return Ok((def, GetsUpBy::Unwanted));
    }
    if !own.get_ups.is_empty() {
        def.set_motions(own).map_err(failed)?;
        return Ok((def, GetsUpBy::Own));
    }
    let gets_up_by = if wanted == GetUps::Any {
        match set_motions_with_builtin(&mut def, analysis, own.clone()) {
            Ok(()) => return Ok((def, GetsUpBy::Builtin)),
            Err(BuiltinError::Motion(error)) => return Err(failed(error)),
            Err(BuiltinError::Retarget(RetargetError::NotHumanoid(_))) => GetsUpBy::Nothing(format!(
                "the built-in motions are for humans, and this character is not human; {CLIPS_HELP}"
            )),
            Err(error) => GetsUpBy::Unfit(format!("{error}; {CLIPS_HELP}")),
        }
    } else {
        GetsUpBy::Nothing(format!(
            "it has no get-up clip, and --no-builtin-motions leaves out the built-in ones; {CLIPS_HELP}"
        ))
    };
    // A lying body without a get-up motion would float to its feet.
    def.after_settling = AfterSettling::StayDown;
    def.set_motions(own).map_err(failed)?;
    Ok((def, gets_up_by))
}
