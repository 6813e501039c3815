//! Footsteps found in a clip.

use sinew::anim::contact::{ContactSettings, FootContact, Ground, contacts, flatten_soles, sole_points};
use sinew::anim::legs::Legs;
use sinew::anim::{Clip, ClipEvent, LocalTransform, Rig, RigAnalysis, Side, Take};
use sinew::math::Vec3;

/// Seconds from look to look.
const FRAME_TIME: f64 = 1.0 / 60.0;

/// When feet come down in a clip, as events `footstep` with the payload `left` or `right`; `None` for a body without the
/// legs of a human, and for a clip that is too long. A foot that is down when the clip begins has come down before.
pub fn footsteps(rig: &Rig, analysis: &RigAnalysis, clip: &Clip) -> Option<Vec<ClipEvent>> {
    let feet = Legs::of(rig, analysis)?.feet;
    let too_long = 2.0 * f64::from(clip.duration) / FRAME_TIME >= Take::MOST_FRAMES as f64;
    if !analysis.humanoid || too_long {
        return None;
    }
    let mut take = Take::of(rig, clip, FRAME_TIME);
    let lap = take.duration() as f32;
    let repeats = is_loop(&take, feet[0].length / analysis.unit_scale);
    if repeats {
        // Twice in a row, so that a step at the seam is seen whole; the lap that is looked at lies in the middle.
        take.poses.extend_from_within(take.joints..);
    }
    let root = analysis.character_from_file();
    let (_, feet) = flatten_soles(&feet, &sole_points(rig, &root, &feet, &take));
    let points = sole_points(rig, &root, &feet, &take);
    let mut settings = ContactSettings::for_leg(feet[0].length);
    let ground = Ground::under(&take, &points, &settings);
    let points = ground.seen_from(&take, points);
    let pace = pace(&take, &points);
    settings.speed = settings.speed.map(|speed| speed + SLIDE * pace);
    let footfall = |contact: FootContact| {
        let time = match repeats {
            true => (0.5 * lap..1.5 * lap).contains(&contact.start).then_some(contact.start % lap),
            false => (contact.start > 0.0).then_some(contact.start),
        }?;
        let side = if contact.foot == Side::Left { "left" } else { "right" };
        Some(ClipEvent { payload: side.to_owned(), ..ClipEvent::new(time.min(clip.duration), "footstep") })
    };
    let found = contacts(&take, &feet, &points, ground.height, &settings);
    let mut events: Vec<ClipEvent> = found.into_iter().filter_map(footfall).collect();
    events.sort_by(|a, b| a.time.total_cmp(&b.time));
    Some(events)
}

/// Share of the body's speed by which feet may slide: a run is seldom drawn, or captured, to the speed of one.
const SLIDE: f32 = 0.2;

/// Speed of a body over its ground, metres a second: that of its feet from the first frame to the last.
fn pace(take: &Take, points: &[[[Vec3; 2]; 2]]) -> f32 {
    let middle = |frame: usize| points[frame].as_flattened().iter().sum::<Vec3>() * 0.25;
    let way = middle(points.len() - 1) - middle(0);
    let time = take.duration() as f32;
    if time > 0.0 { (way - Vec3::Y * way.y).length() / time } else { 0.0 }
}

/// Largest turn of a joint from the last pose to the first for a loop, radians; largest way, as a share of the leg.
const SEAM: f32 = 0.1;
/// Many loops end a frame before their first pose: what joints do in so many frames before the end comes on top of it.
const LAST_FRAMES: usize = 4;

/// True if the last pose is the first one again, on the same spot. `leg` is a leg's length in file units.
fn is_loop(take: &Take, leg: f32) -> bool {
    let last = take.frames() - 1;
    let before = take.pose(last.saturating_sub(LAST_FRAMES));
    let alike = |((a, b), c): ((&LocalTransform, &LocalTransform), &LocalTransform)| {
        let way = |to: &LocalTransform| (b.translation - to.translation).length();
        let turn = |to: &LocalTransform| b.rotation.angle_to(to.rotation);
        turn(a) < SEAM + turn(c) && way(a) < SEAM * leg + way(c)
    };
    last > LAST_FRAMES && take.pose(0).iter().zip(take.pose(last)).zip(before).all(alike)
}
