//! The falling character: its ragdoll, and its own or the built-in motions.

use super::clips::Motions;
use super::lies::lies;
use crate::failure::{Failure, Result};
use crate::input::files::CharacterFile;
use crate::report::table::shown;
use sinew::CharacterSource;
use sinew::anim::Clip;
use sinew::anim::retarget::RetargetError;
use sinew::math::Vec3;
use sinew::motions::{BuiltinError, set_motions_with_builtin};
use sinew::ragdoll::{AfterSettling, CharacterDef, GroundContact, Locomotion, MotionSet, RagdollDef};

/// Get-ups that the user has chosen.
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
    /// The clip with this name, played backwards because it ends lying.
    Reversed(String),
    /// The built-in motions.
    Builtin,
    /// No source: the user chose no get-ups.
    Unwanted,
    /// The character has no clips to get up. Contains the reason, which follows 'it does not get up: ' in messages.
    Nothing(String),
    /// None of the built-in motions works on this body. Contains the reason, as above.
    Unfit(String),
}

impl GetsUpBy {
    /// Returns the flaw of a human that stays down because no built-in motion works on its body.
    pub fn flaw(&self) -> Option<String> {
        let Self::Unfit(why) = self else { return None };
        Some(format!("it does not get up: {why}"))
    }
}

/// Returns advice for a user whose character has no get-up clips; `fall`: a clip that ends lying.
fn clips_help(fall: Option<&str>) -> String {
    let adds = "--clips adds a file with a get-up clip, named for example 'get up'";
    match fall {
        Some(name) => format!("--get-up '{}' plays that clip backwards; {adds}", shown(name)),
        None => adds.to_owned(),
    }
}

/// Height of the centre of mass above which a character stands, and height below which it lies, as shares of its height
/// in the bind pose.
const STANDS: f32 = 0.7;
const LIES: f32 = 0.5;

/// Returns whether a character stands at the start of a clip and lies at its end, for example in a death.
fn ends_lying(def: &CharacterDef, clip: &Clip) -> bool {
    let [start, end] = def.heights_in(clip);
    start > STANDS && end < LIES
}

/// Returns the index of the get-up clip that the user chose: the clip, or a copy of it played backwards if it ends
/// lying.
fn chosen(
    file: &str,
    def: &CharacterDef,
    motions: &mut Motions,
    clip: usize,
) -> Result<(usize, Option<String>)> {
    let motion = &motions.clips[clip];
    if ends_lying(def, motion) {
        let name = motion.name.clone();
        motions.clips.push(motion.reversed());
        return Ok((motions.clips.len() - 1, Some(name)));
    }
    if def.heights_in(motion).into_iter().all(|height| height > STANDS) {
        let what = format!("'{}' begins and ends standing; a get-up begins lying", shown(&motion.name));
        return Err(Failure::at(file, what, "--get-up"));
    }
    Ok((clip, None))
}

/// Returns the character and the source of its get-up motions.
pub fn actor(
    file: &CharacterFile,
    ragdoll: RagdollDef,
    mut motions: Motions,
    wanted: GetUps,
) -> Result<(CharacterDef, GetsUpBy)> {
    let CharacterFile { name, source: CharacterSource { document, analysis, .. } } = file;
    let failed = |error| Failure::of_file(name, error);
    let mut def = CharacterDef::new(document.rig.clone(), ragdoll, &analysis.bind_model);
    def.ground_contact = GroundContact::Enforced;
    let mut reversed = None;
    let get_ups = match wanted {
        GetUps::Clip(clip) => {
            let (clip, name) = chosen(name, &def, &mut motions, clip)?;
            reversed = name;
            vec![clip]
        }
        _ => {
            let mut get_ups = def.get_ups_among(&motions.clips);
            get_ups.retain(|&clip| Some(clip) != motions.looped);
            get_ups
        }
    };
    let Motions { clips, looped, ahead, .. } = motions;
    let is_fall = |clip: &&Clip| ends_lying(&def, clip);
    let help = clips_help(clips.iter().find(is_fall).map(|clip| clip.name.as_str()));
    // Without this, a character that lies in its file would walk along its own forward axis into the floor.
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
        return Ok((def, reversed.map_or(GetsUpBy::Own, GetsUpBy::Reversed)));
    }
    let gets_up_by = if wanted == GetUps::Any {
        match set_motions_with_builtin(&mut def, analysis, own.clone()) {
            Ok(()) => return Ok((def, GetsUpBy::Builtin)),
            Err(BuiltinError::Motion(error)) => return Err(failed(error)),
            Err(BuiltinError::Retarget(RetargetError::NotHumanoid(_))) => GetsUpBy::Nothing(format!(
                "the built-in motions are for humans, and this character is not human; {help}"
            )),
            Err(error) => GetsUpBy::Unfit(format!("{error}; {help}")),
        }
    } else {
        GetsUpBy::Nothing(format!(
            "it has no get-up clip, and --no-builtin-motions leaves out the built-in ones; {help}"
        ))
    };
    // A lying body without a get-up motion would float to its feet.
    def.after_settling = AfterSettling::StayDown;
    def.set_motions(own).map_err(failed)?;
    Ok((def, gets_up_by))
}
