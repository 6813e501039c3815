//! Finds footsteps in a clip.

use super::{ContactSettings, FootContact, Ground, contacts, flatten_soles, sole_points};
use crate::clip::Clip;
use crate::clip::take::Take;
use crate::event::ClipEvent;
use crate::legs::Legs;
use crate::rig::{LocalTransform, Rig};
use crate::roles::{RigAnalysis, Side};
use crate::tuning::{LAST_FRAMES, LOOP_SEAM, ONE_WAY, STEP_FRAME_TIME, STEP_SLIDE};
use sinew_math::{Vec3, max, min};

/// Footsteps of a clip, and the speed of its walk on the spot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Footsteps {
    /// An event `footstep` with the payload `left` or `right` at each footfall, by time. A foot that is on the ground
    /// at the start has no footfall there, unless the clip loops.
    pub events: Vec<ClipEvent>,
    /// Speed of the ground relative to a walk on the spot, m/s; 0 for a clip that travels or stands.
    pub speed: f32,
}

/// Reason why a clip has no footsteps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoFootsteps {
    /// The character is not a humanoid.
    #[error("footsteps are found on the two legs of a human, and this is none")]
    NotHumanoid,
    /// A leg has no joint for the hip, the knee or the ankle.
    #[error("a leg lacks its hip, its knee or its ankle")]
    LegIncomplete,
    /// The clip has more frames than [`Take::MOST_FRAMES`] allows.
    #[error("the clip is too long to be examined")]
    TooLong,
}

/// Finds the footfalls of a clip: the times at which the ball of a foot comes to rest on the ground. A clip whose
/// last pose equals its first counts as a loop. A walk on the spot is recognised by feet that alternately move back
/// at one speed.
///
/// # Errors
/// If the character lacks the legs of a human, or the clip is too long.
///
/// # Panics
/// If the analysis or the clip does not fit the rig.
pub fn footsteps(rig: &Rig, analysis: &RigAnalysis, clip: &Clip) -> Result<Footsteps, NoFootsteps> {
    if !analysis.humanoid {
        return Err(NoFootsteps::NotHumanoid);
    }
    let feet = Legs::of(rig, analysis).ok_or(NoFootsteps::LegIncomplete)?.feet;
    if 2.0 * f64::from(clip.duration) / STEP_FRAME_TIME >= Take::MOST_FRAMES as f64 {
        return Err(NoFootsteps::TooLong);
    }
    let mut take = Take::of(rig, clip, STEP_FRAME_TIME);
    let lap = take.duration() as f32;
    let repeats = is_loop(&take, feet[0].length / analysis.unit_scale);
    if repeats {
        // Two laps are searched, so that a step at the seam is complete; the footfalls of one lap are kept.
        take.poses.extend_from_within(take.joints..);
    }
    let root = analysis.character_from_file();
    let (_, feet) = flatten_soles(&feet, &sole_points(rig, &root, &feet, &take));
    let points = sole_points(rig, &root, &feet, &take);
    let mut settings = ContactSettings::for_leg(feet[0].length);
    let mut ground = Ground::under(&take, &points, &settings);
    if repeats && ground.velocity == Vec3::ZERO {
        ground.velocity = strides_on_the_spot(&take, &points, &settings).unwrap_or(Vec3::ZERO);
    }
    if ground.velocity.length() > settings.run {
        // A runner's foot is on the ground for about half as long as a walker's.
        settings.shortest *= 0.5;
    }
    let points = ground.seen_from(&take, points);
    let pace = pace(&take, &points);
    settings.speed = settings.speed.map(|speed| speed + STEP_SLIDE * pace);
    let footfall = |contact: FootContact| {
        let time = match repeats {
            true => (0.5 * lap..1.5 * lap).contains(&contact.start).then_some(contact.start % lap),
            false => (contact.start > 0.0).then_some(contact.start),
        }?;
        let side = if contact.foot == Side::Left { "left" } else { "right" };
        Some(ClipEvent { payload: side.to_owned(), ..ClipEvent::new(min(time, clip.duration), "footstep") })
    };
    let found = contacts(&take, &feet, &points, ground.height, &settings);
    let mut events: Vec<ClipEvent> = found.into_iter().filter_map(footfall).collect();
    events.sort_by(|a, b| a.time.total_cmp(&b.time));
    Ok(Footsteps { events, speed: ground.velocity.length() })
}

/// Velocity of the ground under a looped walk on the spot whose feet move back at changing speeds, as drawn walks do,
/// m/s: the mean velocity of the lower foot. `None` if that foot does not mostly move one way, or one foot is rarely
/// lower.
fn strides_on_the_spot(take: &Take, points: &[[[Vec3; 2]; 2]], settings: &ContactSettings) -> Option<Vec3> {
    let middle = |foot: [Vec3; 2]| (foot[0] + foot[1]) * 0.5;
    let steps: Vec<(usize, Vec3)> = points
        .windows(2)
        .map(|pair| {
            let foot =
                usize::from(min(pair[0][1][0].y, pair[0][1][1].y) < min(pair[0][0][0].y, pair[0][0][1].y));
            let step = middle(pair[1][foot]) - middle(pair[0][foot]);
            (foot, Vec3::new(step.x, 0.0, step.z))
        })
        .collect();
    let sum = steps.iter().fold(Vec3::ZERO, |sum, (_, step)| sum + *step);
    let all: f32 = steps.iter().map(|(_, step)| step.length()).sum();
    let of_right = steps.iter().filter(|(foot, _)| *foot == 1).count();
    let rarer = usize::min(of_right, steps.len() - of_right);
    let velocity = sum / max(take.duration() as f32, 1e-6);
    let is_walk = sum.length() > ONE_WAY * all && 4 * rarer > steps.len();
    let stays = pace(take, points) < 0.25 * velocity.length();
    (is_walk && stays && velocity.length() > settings.speed[1]).then_some(velocity)
}

/// Mean speed of a body over its ground, m/s, from the midpoint between its feet in the first and the last frame.
fn pace(take: &Take, points: &[[[Vec3; 2]; 2]]) -> f32 {
    let middle = |frame: usize| points[frame].as_flattened().iter().sum::<Vec3>() * 0.25;
    let way = middle(points.len() - 1) - middle(0);
    let time = take.duration() as f32;
    if time > 0.0 { (way - Vec3::Y * way.y).length() / time } else { 0.0 }
}

/// True if the last pose equals the first one, on the same spot. `leg` is a leg's length in file units.
fn is_loop(take: &Take, leg: f32) -> bool {
    let last = take.frames() - 1;
    let before = take.pose(last.saturating_sub(LAST_FRAMES));
    let alike = |((a, b), c): ((&LocalTransform, &LocalTransform), &LocalTransform)| {
        let way = |to: &LocalTransform| (b.translation - to.translation).length();
        let turn = |to: &LocalTransform| b.rotation.angle_to(to.rotation);
        turn(a) < LOOP_SEAM + turn(c) && way(a) < LOOP_SEAM * leg + way(c)
    };
    last > LAST_FRAMES && take.pose(0).iter().zip(take.pose(last)).zip(before).all(alike)
}
