//! Contacts of the feet with the ground, and the slide of the feet during contacts.

mod footsteps;

pub use footsteps::{Footsteps, NoFootsteps, footsteps};

use crate::clip::take::Take;
use crate::legs::Foot;
use crate::pose::local_to_model;
use crate::rig::Rig;
use crate::roles::Side;
use crate::tuning::{RUN_STANDS, WALK_STANDS};
use sinew_math::{Affine, Rotation, Vec3, clamp, max, min, trig};

/// A contact of a foot with the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FootContact {
    /// Side of the foot.
    pub foot: Side,
    /// Footfall: start of the contact, seconds from the start of the take.
    pub start: f32,
    /// End of the contact, seconds from the start of the take.
    pub end: f32,
}

/// Returns heels and balls of both feet in the space of `root`, metres: left then right foot, heel then ball; one entry
/// per frame of the take.
///
/// # Panics
/// If the take does not fit the rig.
pub fn sole_points(rig: &Rig, root: &Affine, feet: &[Foot; 2], take: &Take) -> Vec<[[Vec3; 2]; 2]> {
    let mut model = Vec::new();
    let points = |frame| {
        local_to_model(rig, take.pose(frame), root, &mut model);
        feet.each_ref().map(|foot| foot.points(&model))
    };
    (0..take.frames()).map(points).collect()
}

/// Returns the height of the floor under a motion, metres. In nine of ten frames the lowest point of both feet is at or
/// above it; the tenth is ignored as noise. `points` are those of [`sole_points`], metres, y up. 0 without points.
pub fn floor_under(points: &[[[Vec3; 2]; 2]]) -> f32 {
    tenth(points.iter().map(lowest).collect())
}

/// The ground under a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ground {
    /// Height of the ground, metres.
    pub height: f32,
    /// Velocity of the ground under a body that walks in place, m/s; zero under a body that moves forward. Its y
    /// component is 0.
    pub velocity: Vec3,
}

impl Ground {
    /// Derives the ground under a motion from its feet. The ground moves if both feet are alternately low for much of
    /// the time and then mostly move at one speed. `points` are those of [`sole_points`] of the take, y up, one entry
    /// per frame.
    pub fn under(take: &Take, points: &[[[Vec3; 2]; 2]], settings: &ContactSettings) -> Self {
        let height = floor_under(points);
        let lower_step = |frame: usize| {
            let k = usize::from(points[frame][1][1].y < points[frame][0][1].y);
            let [from, to] = [points[frame][k][1], points[frame + 1][k][1]];
            let step = (to - from) / take.frame_time as f32;
            (from.y - height < settings.height).then_some((k, Vec3::new(step.x, 0.0, step.z)))
        };
        let steps: Vec<(usize, Vec3)> = (0..points.len().saturating_sub(1)).filter_map(lower_step).collect();
        let median = |axis: usize| {
            let mut numbers: Vec<f32> = steps.iter().map(|(_, step)| step[axis]).collect();
            numbers.sort_by(f32::total_cmp);
            numbers.get(numbers.len() / 2).copied().unwrap_or(0.0)
        };
        let velocity = Vec3::new(median(0), 0.0, median(2));
        let alike = |step: Vec3| (step - velocity).length() < 0.3 * velocity.length();
        let of_foot = |foot: usize| steps.iter().filter(|&&(k, step)| k == foot && alike(step)).count();
        let (left, right) = (of_foot(0), of_foot(1));
        // Each foot of a runner is off the ground most of the time.
        let least = if velocity.length() > settings.run { RUN_STANDS } else { WALK_STANDS };
        let mostly = 2 * (left + right) > steps.len() && least * steps.len() > points.len();
        let take_turns = 4 * usize::min(left, right) > left + right;
        let moves = velocity.length() > settings.speed[1] && mostly && take_turns;
        Self { height, velocity: if moves { velocity } else { Vec3::ZERO } }
    }

    /// Converts points to positions relative to the ground, metres: a standing foot is at rest there. `points` are
    /// those of [`sole_points`], one entry per frame.
    pub fn seen_from(&self, take: &Take, mut points: Vec<[[Vec3; 2]; 2]>) -> Vec<[[Vec3; 2]; 2]> {
        for (frame, feet) in points.iter_mut().enumerate() {
            let way = self.velocity * take.time(frame);
            feet.as_flattened_mut().iter_mut().for_each(|point| *point -= way);
        }
        points
    }
}

/// Returns the tilt of each sole while the foot stands, radians, positive for toes up, and the feet with soles
/// flattened by it.
///
/// The tilt of a sole is uncertain in a reference pose, but follows from the heights of heel and ball while the foot
/// stands. Frames with tilts over 0.2 rad are ignored, because the foot then stands on its toes.
pub fn flatten_soles(feet: &[Foot; 2], points: &[[[Vec3; 2]; 2]]) -> ([f32; 2], [Foot; 2]) {
    let (mut tilts, mut flat) = ([0.0; 2], *feet);
    for k in 0..2 {
        let low = [0, 1].map(|point| tenth(points.iter().map(|frame| frame[k][point].y).collect()));
        let sole = flat[k].sole;
        let length = (sole[1] - sole[0]).length();
        let tilt = trig::asin(clamp((low[1] - low[0]) / max(length, 1e-6), -1.0, 1.0));
        if tilt.abs() < 0.2 {
            tilts[k] = tilt;
            flat[k].sole =
                sole.map(|point| flat[k].stance.inverse() * (toes_up(-tilt) * (flat[k].stance * point)));
        }
    }
    (tilts, flat)
}

/// Returns a rotation that raises the toes, in a body's own axes.
pub(crate) fn toes_up(angle: f32) -> Rotation {
    Rotation::from_axis_angle(Vec3::NEG_X, angle)
}

/// Returns the tenth percentile; 0 for no numbers.
fn tenth(mut numbers: Vec<f32>) -> f32 {
    numbers.sort_by(f32::total_cmp);
    numbers.get(numbers.len() / 10).copied().unwrap_or(0.0)
}

/// Height of the lowest point of both feet, metres, y up.
pub fn lowest(points: &[[Vec3; 2]; 2]) -> f32 {
    points.as_flattened().iter().map(|point| point.y).fold(f32::INFINITY, min)
}

/// Thresholds for standing feet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactSettings {
    /// Speeds of the ball of a foot, m/s: the foot lands below the first and leaves above the second.
    pub speed: [f32; 2],
    /// Largest height of the ball above the floor, metres.
    pub height: f32,
    /// Speed over the ground from which a body runs, m/s.
    pub run: f32,
    /// Shortest time on the ground, and shortest time off the ground, seconds; shorter times count as noise.
    pub shortest: f32,
}

impl ContactSettings {
    /// Returns the settings for legs of `length` (metres, hip to floor): those of an adult, scaled by Froude's law.
    pub fn for_leg(length: f32) -> Self {
        let size = length / 0.9;
        let time = size.sqrt();
        // Humans begin to run at a Froude number v²/(g l) of 0.5 (Alexander 1989).
        let run = (0.5 * 9.81 * length).sqrt();
        Self { speed: [0.3 * time, 0.45 * time], height: 0.05 * size, run, shortest: 0.07 * time }
    }
}

/// Finds the contacts of each foot, by height and speed of its ball. `points` are those of [`sole_points`], [relative
/// to the ground](Ground::seen_from) if the ground moves, one entry per frame; `floor` is the height of the ground,
/// metres. Times are seconds from the start of the take. Sorted by start; left before right.
pub fn contacts(
    take: &Take,
    feet: &[Foot; 2],
    points: &[[[Vec3; 2]; 2]],
    floor: f32,
    settings: &ContactSettings,
) -> Vec<FootContact> {
    let mut found = Vec::new();
    for (k, foot) in feet.iter().enumerate() {
        let balls: Vec<Vec3> = points.iter().map(|frame| frame[k][1]).collect();
        for [first, last] in standing(take, &balls, floor, settings) {
            found.push(FootContact { foot: foot.side, start: take.time(first), end: take.time(last) });
        }
    }
    found.sort_by(|a, b| a.start.total_cmp(&b.start).then(a.foot.cmp(&b.foot)));
    found
}

/// Returns the first and last frame of every contact.
fn standing(take: &Take, balls: &[Vec3], floor: f32, settings: &ContactSettings) -> Vec<[usize; 2]> {
    let shortest = take.frames_in(settings.shortest).max(1);
    let mut spans: Vec<[usize; 2]> = Vec::new();
    let mut stands = false;
    for frame in 0..balls.len() {
        let most = settings.speed[usize::from(stands)];
        let low = balls[frame].y - floor < settings.height;
        let stood = core::mem::replace(&mut stands, low && speed(take, balls, frame) < most);
        match (stands, spans.last_mut()) {
            (true, Some(span)) if stood || frame - span[1] <= shortest => span[1] = frame,
            (true, _) => spans.push([frame, frame]),
            (false, _) => {}
        }
    }
    spans.retain(|span| span[1] - span[0] >= shortest);
    spans
}

/// Speed over the ground, m/s, by a difference over 33 ms, because captured points tremble.
fn speed(take: &Take, points: &[Vec3], frame: usize) -> f32 {
    let reach = take.frames_in(0.016).max(1);
    let (from, to) = (frame.saturating_sub(reach), (frame + reach).min(points.len() - 1));
    let way = points[to] - points[from];
    let time = take.time(to) - take.time(from);
    if time > 0.0 { way.length() / time } else { 0.0 }
}

/// Slide of the feet while they stand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FootSlide {
    /// Mean speed over the ground, m/s: distance slid divided by standing time.
    pub mean: f32,
    /// Largest distance of a foot from its landing position within one contact, metres.
    pub farthest: f32,
    /// Total standing time of both feet, seconds.
    pub time: f32,
}

/// Measures the slide of the balls of the feet over the ground (x and z, metres) during `contacts` (seconds of the
/// take). `points` are those of [`sole_points`], [relative to the ground](Ground::seen_from) if the ground moves, one
/// entry per frame.
pub fn foot_slide(
    take: &Take,
    feet: &[Foot; 2],
    points: &[[[Vec3; 2]; 2]],
    contacts: &[FootContact],
) -> FootSlide {
    let (mut way, mut slide) = (0.0, FootSlide::default());
    let flat = |v: Vec3| Vec3::new(v.x, 0.0, v.z).length();
    for contact in contacts {
        let Some(k) = feet.iter().position(|foot| foot.side == contact.foot) else { continue };
        let [first, last] = frames_of(take, contact, points.len());
        for frame in first..last {
            way += flat(points[frame + 1][k][1] - points[frame][k][1]);
            slide.farthest = max(slide.farthest, flat(points[frame + 1][k][1] - points[first][k][1]));
        }
        slide.time += (last - first) as f32 * take.frame_time as f32;
    }
    slide.mean = if slide.time > 0.0 { way / slide.time } else { 0.0 };
    slide
}

/// First and last frame of a contact in a take of `frames` frames.
pub(crate) fn frames_of(take: &Take, contact: &FootContact, frames: usize) -> [usize; 2] {
    let last = frames.saturating_sub(1);
    [contact.start, contact.end].map(|time| usize::min(take.frames_in(max(time, 0.0)), last))
}
