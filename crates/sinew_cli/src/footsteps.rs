//! Footsteps found in a clip.

use sinew::anim::contact::{ContactSettings, FootContact, Ground, contacts, flatten_soles, sole_points};
use sinew::anim::legs::Legs;
use sinew::anim::{Clip, Event, Rig, RigAnalysis, Side, Take};

/// Seconds from look to look.
const FRAME_TIME: f64 = 1.0 / 60.0;

/// When feet come down in a clip, as events `footstep` with the payload `left` or `right`; `None` for a body without the
/// legs of a human. A foot that is down when the clip begins has come down before, but for a loop at whose end it is up.
pub fn footsteps(rig: &Rig, analysis: &RigAnalysis, clip: &Clip) -> Option<Vec<Event>> {
    let feet = Legs::of(rig, analysis)?.feet;
    let too_long = f64::from(clip.duration) / FRAME_TIME >= Take::MOST_FRAMES as f64;
    if !analysis.humanoid || too_long {
        return None;
    }
    let root = analysis.character_from_file();
    let take = Take::of(rig, clip, FRAME_TIME);
    let (_, feet) = flatten_soles(&feet, &sole_points(rig, &root, &feet, &take));
    let points = sole_points(rig, &root, &feet, &take);
    let settings = ContactSettings::for_leg(feet[0].length);
    let ground = Ground::under(&take, &points, &settings);
    let points = ground.seen_from(&take, points);
    let steps = contacts(&take, &feet, &points, ground.height, &settings);
    let end = take.duration() as f32;
    let is_down_at_end = |foot: Side| {
        steps.iter().any(|contact| contact.foot == foot && contact.end >= end - FRAME_TIME as f32)
    };
    let loops = is_loop(&take);
    let begins = |contact: &&FootContact| contact.start > 0.0 || (loops && !is_down_at_end(contact.foot));
    let event = |contact: &FootContact| {
        let side = if contact.foot == Side::Left { "left" } else { "right" };
        let time = contact.start.min(clip.duration);
        Event { payload: side.to_owned(), ..Event::new(time, "footstep") }
    };
    Some(steps.iter().filter(begins).map(event).collect())
}

/// Largest turn of a joint from the last pose to the first for a loop, radians.
const SEAM: f32 = 0.1;

/// Whether the last pose is the first one again, wherever the body is.
fn is_loop(take: &Take) -> bool {
    let (first, last) = (take.pose(0), take.pose(take.frames() - 1));
    let turns = first.iter().zip(last).map(|(a, b)| a.rotation.angle_to(b.rotation));
    take.frames() > 1 && turns.fold(0.0, f32::max) < SEAM
}
