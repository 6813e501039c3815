//! Motions among a file's own clips.

use crate::anim::contact::{Footsteps, footsteps};
use crate::anim::{Clip, Interpolation, Rig, RigAnalysis};
use crate::math::max;
use crate::ragdoll::{CharacterDef, Locomotion, MotionSet};

/// Words in names of walks, idles and get-ups, ignoring case, blanks, `-` and `_`.
const WALK: &str = "walk";
const IDLE: &str = "idle";
const FASTER: [&str; 3] = ["jog", "run", "sprint"];
/// Words in the names of clips that do not move forward, or that contain other motions as well.
const NOT_AHEAD: [&str; 11] =
    ["back", "left", "right", "strafe", "turn", "stop", "start", "jump", "shoot", "attack", "aim"];
const GET_UP: [&str; 3] = ["getup", "standup", "gettingup"];
/// Name of clips that `sinew bake` adds (falls simulated before), with or without a number.
const BAKED: &str = "sinew";

/// Motions of a file's own clips.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OwnMotions {
    /// The clips, and their purposes.
    pub motions: MotionSet,
    /// Notes on the choices and on missing clips, one sentence each.
    pub notes: Vec<String>,
}

/// Chooses the motions of a character among its file's own clips.
///
/// | motion | clip |
/// |---|---|
/// | `looped` | the clip of [`looped_among`] |
/// | `faster` | for each of `jog`, `run` and `sprint`, the clip with the shortest name that contains the word and runs ahead |
/// | `idle` | the clip with the shortest name that contains `idle`, unless it is the looped one |
/// | `get_ups` | the clips of [`CharacterDef::get_ups_among`] that are neither looped nor idle |
/// | `events` | footfalls of the looped and the faster clips ([`footsteps`]) |
/// | `locomotion` | forward at the speed of the feet if the looped clip walks on the spot, else by the clip |
///
/// # Panics
/// If the analysis or a clip does not belong to the character's rig.
pub fn own_motions(def: &CharacterDef, analysis: &RigAnalysis, clips: Vec<Clip>) -> OwnMotions {
    let looped = looped_among(&def.rig, analysis, &clips);
    let idles = (0..clips.len()).filter(|&clip| plain(&clips[clip].name).contains(IDLE));
    let idle = idles.min_by_key(|&clip| clips[clip].name.len()).filter(|&clip| Some(clip) != looped);
    let mut get_ups = def.get_ups_among(&clips);
    get_ups.retain(|&clip| Some(clip) != looped && Some(clip) != idle);
    let mut notes = Vec::new();
    let name = |clip: usize| format!("\"{}\"", clips[clip].name);
    match looped {
        Some(clip) => notes.push(format!("{} is the clip that loops", name(clip))),
        None => notes.push("the file has no clip that loops".to_owned()),
    }
    notes.extend(idle.map(|clip| format!("{} is the clip that stands", name(clip))));
    if !get_ups.is_empty() {
        let names: Vec<String> = get_ups.iter().map(|&clip| name(clip)).collect();
        notes.push(format!("it gets up by {}", names.join(" or ")));
    }
    let mut motions =
        MotionSet { looped, idle, get_ups, locomotion: Locomotion::ByClip, ..MotionSet::default() };
    let is_walk = |clip: usize| plain(&clips[clip].name).contains(WALK);
    let faster = if looped.is_some_and(is_walk) { faster_among(&clips) } else { Vec::new() };
    for clip in looped.into_iter().chain(faster) {
        let is_looped = looped == Some(clip);
        let found = match footsteps(&def.rig, analysis, &clips[clip]) {
            Ok(found) if found.events.is_empty() => Err("no foot comes to rest on the ground".to_owned()),
            Ok(found) => Ok(found),
            Err(reason) => Err(reason.to_string()),
        };
        match found {
            Ok(Footsteps { events, speed }) => {
                motions.events.extend(events.into_iter().map(|event| (clip, event)));
                let locomotion = if speed > 0.0 { Locomotion::Forward { speed } } else { Locomotion::ByClip };
                if is_looped {
                    motions.locomotion = locomotion;
                } else {
                    notes.push(format!("{} is a faster clip", name(clip)));
                    motions.faster.push((clip, locomotion));
                }
            }
            Err(reason) if is_looped => notes.push(format!("{} has no footsteps: {reason}", name(clip))),
            Err(reason) => {
                notes.push(format!(
                    "{} is left out because its steps cannot be matched: {reason}",
                    name(clip)
                ));
            }
        }
    }
    motions.clips = clips;
    OwnMotions { motions, notes }
}

/// Returns the clips that go forward: for each word the one with the shortest name.
fn faster_among(clips: &[Clip]) -> Vec<usize> {
    let ahead = |clip: &usize| {
        let name = plain(&clips[*clip].name);
        !NOT_AHEAD.iter().any(|word| name.contains(word)) && moves(&clips[*clip])
    };
    let of_word = |word: &&str| {
        let called = (0..clips.len()).filter(|&clip| has_word(&clips[clip].name, word));
        called.filter(ahead).min_by_key(|&clip| clips[clip].name.len())
    };
    let mut found: Vec<usize> = FASTER.iter().filter_map(of_word).collect();
    found.dedup();
    found
}

/// Returns true if a word of `name` starts with `word`. A word starts after a character that is no letter, or with a
/// capital letter after a small one.
fn has_word(name: &str, word: &str) -> bool {
    let mut last = ' ';
    name.char_indices().any(|(at, c)| {
        let begins = !last.is_alphabetic() || c.is_uppercase() && last.is_lowercase();
        last = c;
        begins && name[at..].to_lowercase().starts_with(word)
    })
}

/// Index of the clip that a character plays by default. Returns the first moving clip named a walk (preferably one in
/// which both feet land); else the first whose name contains `idle`; else the first that is neither a get-up nor a
/// baked fall. `None` if there is none of these.
///
/// # Panics
/// If the analysis or a clip does not belong to the rig.
pub fn looped_among(rig: &Rig, analysis: &RigAnalysis, clips: &[Clip]) -> Option<usize> {
    let names: Vec<String> = clips.iter().map(|clip| plain(&clip.name)).collect();
    let is_get_up = |clip: usize| GET_UP.iter().any(|word| names[clip].contains(word));
    let is_baked = |clip: usize| {
        let number = names[clip].strip_prefix(BAKED);
        number.is_some_and(|number| number.chars().all(|c| c.is_ascii_digit()))
    };
    let is_walk = |&clip: &usize| names[clip].contains(WALK) && !is_baked(clip) && moves(&clips[clip]);
    let walks: Vec<usize> = (0..clips.len()).filter(is_walk).collect();
    let takes_turns = |&clip: &usize| {
        let steps = footsteps(rig, analysis, &clips[clip]).unwrap_or_default().events;
        ["left", "right"].iter().all(|side| steps.iter().any(|step| step.payload == *side))
    };
    let walk = match walks[..] {
        [] | [_] => walks.first().copied(),
        _ => walks.iter().copied().find(takes_turns).or(walks.first().copied()),
    };
    let idle = || names.iter().position(|name| name.contains(IDLE));
    let first = || (0..clips.len()).find(|&clip| !is_get_up(clip) && !is_baked(clip));
    walk.or_else(idle).or_else(first)
}

/// Smallest difference of a key from the first key that counts as motion, as a share of the channel's largest number.
const MOVES: f32 = 0.01;

/// Returns true if any joint of a clip moves. A static pose is not a walk, even if its name says so.
fn moves(clip: &Clip) -> bool {
    clip.channels.iter().any(|channel| {
        let width = channel.property.width();
        // A cubic key has a slope before its value and one after it.
        let cubic = channel.interpolation == Interpolation::CubicSpline;
        let (stride, at) = if cubic { (3 * width, width) } else { (width, 0) };
        let keys: Vec<&[f32]> = channel.values.chunks_exact(stride).map(|key| &key[at..at + width]).collect();
        let Some(first) = keys.first() else { return false };
        let size = keys.iter().flat_map(|key| key.iter()).fold(1e-6, |most, value| max(most, value.abs()));
        keys.iter().any(|key| key.iter().zip(*first).any(|(a, b)| (a - b).abs() > MOVES * size))
    })
}

/// Returns a name in small letters, without blanks, `-` and `_`.
fn plain(name: &str) -> String {
    name.chars().filter(|c| !matches!(c, ' ' | '_' | '-')).flat_map(char::to_lowercase).collect()
}
