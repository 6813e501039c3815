//! Quality of getting up: balance, sliding feet, and jumps of the pose where bodies hand over to clips.

use super::balance::unbalanced;
use super::{Fault, Verdict};
use crate::bake::{BakeInput, Baked, Frame};
use crate::character::{CharacterDef, CharacterEvent, State};
use crate::def::RagdollBodyDef;
use crate::tuning::{
    BLENDS_FOR, CLIP_FRAME, GRAVITY, HIPS_BEAR, JUMPS, LEANS, LEANS_FOR, SLIDES, SLIDES_LEAST, SNAPS,
    STANDS_NEAR, STANDS_UPRIGHT,
};
use sinew_anim::{Clip, JointIdx, LocalTransform, Wrap, local_to_model, sample};
use sinew_math::{Affine, Vec3, max, min};

/// Metrics of getting up, metres unless a field says otherwise; `None` if a character does not get up, or has no feet
/// with skin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RisingQuality {
    /// Largest slide of a foot over the floor while the foot is flat on it, over the stances of all get-ups. Only on
    /// horizontal floors. A foot that a lying or sitting character draws in carries no weight and does not count.
    pub foot_slide_m: Option<f32>,
    /// Largest motion of a body in the frame of a hand-over beyond its motion in the frames before and after: from
    /// bodies to a clip, and from a get-up to the next clip.
    pub pose_jump_m: Option<f32>,
    /// Largest speed of trunk or head in the blend from the bodies' pose into a get-up clip, beyond their largest speed
    /// in the clip itself, m/s; 0 if they are no faster.
    pub snap_m_s: Option<f32>,
    /// Longest time for which the centre of mass is more than 8 % of the height beside the skin that touches the floor,
    /// seconds: a body that rises like a board, or floats onto its feet. Only on horizontal floors.
    pub unbalanced_s: Option<f32>,
}

/// Measures all get-ups of a bake; `floor` is the height of the level floor (metres), if any.
///
/// # Panics
/// If the bake does not belong to the input.
pub fn measure_rising(input: &BakeInput<'_>, baked: &Baked, floor: Option<f32>) -> RisingQuality {
    let def = &*input.character;
    RisingQuality {
        foot_slide_m: floor.and_then(|floor| foot_slide(def, baked, floor)),
        pose_jump_m: pose_jump(def, baked),
        snap_m_s: snap(def, baked),
        unbalanced_s: floor.and_then(|_| unbalanced(def, baked)),
    }
}

impl RisingQuality {
    /// Returns the metrics that miss their thresholds, for a character of this height (metres).
    pub fn faults(&self, height: f32) -> Vec<Fault> {
        let mut faults = Vec::new();
        let help = "--clips FILE brings a clip to get up by that is made for this body";
        let mut hold = |figure: Option<f32>, bar: f32, what: &str| {
            // NaN does not meet the threshold.
            if let Some(figure) = figure.filter(|figure| *figure > bar || figure.is_nan()) {
                let cm = 100.0 * figure;
                let reason =
                    format!("getting up {what} by {cm:.1} cm, more than {:.1} cm; {help}", 100.0 * bar);
                faults.push(Fault { at_most: Verdict::Usable, reason });
            }
        };
        hold(self.foot_slide_m, max(SLIDES * height, SLIDES_LEAST), "a foot slides");
        hold(self.pose_jump_m, JUMPS * height, "the pose jumps");
        let bar = SNAPS * (GRAVITY * height).sqrt();
        if let Some(speed) = self.snap_m_s.filter(|speed| *speed > bar || speed.is_nan()) {
            let reason = format!(
                "it snaps into the clip by which it gets up: trunk or head are {speed:.1} m/s faster than in the clip, more than {bar:.1} m/s; \
                 --get-up NAME takes a clip that begins as it lies, {help}"
            );
            faults.push(Fault { at_most: Verdict::Usable, reason });
        }
        if let Some(seconds) = self.unbalanced_s.filter(|time| *time > LEANS_FOR || time.is_nan()) {
            let reason = format!(
                "getting up its centre of mass is more than {:.0} cm beside hands and feet for {seconds:.2} s, longer than \
                 {LEANS_FOR} s; {help}",
                100.0 * LEANS * height
            );
            faults.push(Fault { at_most: Verdict::Usable, reason });
        }
        faults
    }
}

/// Returns the joints of pelvis, trunk and head.
fn trunk(def: &CharacterDef) -> Vec<JointIdx> {
    let is_trunk = |(index, body): &(usize, &RagdollBodyDef)| {
        let role = body.role.as_str();
        *index == 0 || role == "head" || role.ends_with("hest") || role.starts_with("spine")
    };
    def.ragdoll.bodies.iter().enumerate().filter(is_trunk).map(|(_, body)| body.joint).collect()
}

/// Returns the largest speed of these joints between two poses, m/s.
fn speed(joints: &[JointIdx], [from, to]: [&[Affine]; 2], seconds: f32) -> f32 {
    joints.iter().fold(0.0, |most, &joint| {
        max(most, (to[joint].translation - from[joint].translation).length() / seconds)
    })
}

/// Returns the largest speed of the trunk in a clip, m/s.
fn speed_in_clip(def: &CharacterDef, baked: &Baked, clip: &Clip, trunk: &[JointIdx]) -> f32 {
    let mut pose: Vec<LocalTransform> = def.rest().to_vec();
    let (mut last, mut model) = (Vec::new(), Vec::new());
    let count = (clip.duration / CLIP_FRAME) as usize;
    (0..=count).fold(0.0, |most, frame| {
        sample(clip, &def.rig, frame as f32 * CLIP_FRAME, Wrap::Clamp, &mut pose);
        core::mem::swap(&mut last, &mut model);
        local_to_model(&def.rig, &pose, &baked.world_from_model, &mut model);
        if frame == 0 { 0.0 } else { max(most, speed(trunk, [&last, &model], CLIP_FRAME)) }
    })
}

fn snap(def: &CharacterDef, baked: &Baked) -> Option<f32> {
    let trunk = trunk(def);
    let rises = baked.events.iter().filter_map(|&(time, event)| match event {
        CharacterEvent::GettingUp { clip: Some(clip) } => Some((time, &def.motions().clips[clip])),
        _ => None,
    });
    let (mut last, mut model) = (Vec::new(), Vec::new());
    rises
        .map(|(time, clip)| {
            let blends = |frame: &&Frame| (time..time + BLENDS_FOR).contains(&frame.time);
            let first = baked.frames.iter().position(|frame| blends(&frame)).unwrap_or(0);
            let begins = first.saturating_sub(1);
            let count = baked.frames[first..].iter().take_while(blends).count() + first - begins;
            let mut fastest = 0.0;
            for pair in baked.frames[begins..begins + count].windows(2) {
                model_of(def, baked, &pair[0], &mut last);
                model_of(def, baked, &pair[1], &mut model);
                fastest = max(fastest, speed(&trunk, [&last, &model], pair[1].time - pair[0].time));
            }
            max(fastest - speed_in_clip(def, baked, clip, &trunk), 0.0)
        })
        .reduce(max)
}

fn model_of(def: &CharacterDef, baked: &Baked, frame: &Frame, model: &mut Vec<Affine>) {
    local_to_model(&def.rig, &frame.pose, &baked.world_from_model, model);
}

fn foot_slide(def: &CharacterDef, baked: &Baked, floor: f32) -> Option<f32> {
    let near = STANDS_NEAR * def.ragdoll.height;
    let hips = def.ragdoll.bodies[0].joint;
    let bears = floor + HIPS_BEAR * def.bind()[hips].translation.y;
    let mut farthest = None;
    let (mut model, mut palette) = (Vec::new(), Vec::new());
    for foot in def.soles() {
        // Points and slide of the stance so far.
        let mut stance: Option<(Vec<Vec3>, f32)> = None;
        for frame in &baked.frames {
            if frame.state != State::GettingUp {
                stance = None;
                continue;
            }
            model_of(def, baked, frame, &mut model);
            let up = model[foot.joint].to_rigid().rotation * foot.up;
            let places = foot.places(&model, &mut palette);
            let is_on = |place: Vec3| place.y < floor + near;
            let is_up = up.y >= STANDS_UPRIGHT && model[hips].translation.y >= bears;
            if !is_up || !places.iter().any(|&place| is_on(place)) {
                stance = None;
                continue;
            }
            let mut slide = 0.0;
            if let Some((before, sum)) = stance {
                let both = before.iter().zip(&places).filter(|(a, b)| is_on(**a) && is_on(**b));
                let ways = both.map(|(a, b)| ((b.x - a.x) * (b.x - a.x) + (b.z - a.z) * (b.z - a.z)).sqrt());
                // One point of a foot that rolls or rotates does not move.
                slide = sum + ways.reduce(min).unwrap_or(0.0);
            }
            farthest = Some(max(farthest.unwrap_or(0.0), slide));
            stance = Some((places, slide));
        }
    }
    farthest
}

fn pose_jump(def: &CharacterDef, baked: &Baked) -> Option<f32> {
    let frames = &baked.frames;
    let mut farthest = None;
    let mut models: [Vec<Affine>; 4] = Default::default();
    for k in 1..frames.len().saturating_sub(2) {
        let (before, after) = (frames[k].state, frames[k + 1].state);
        let is_handed = matches!(
            (before, after),
            (State::Limp | State::Preparing, State::GettingUp) | (State::GettingUp, State::Animated)
        );
        if !is_handed {
            continue;
        }
        for (model, frame) in models.iter_mut().zip(&frames[k - 1..]) {
            model_of(def, baked, frame, model);
        }
        for body in &def.ragdoll.bodies {
            let way = |i: usize| {
                (models[i + 1][body.joint].translation - models[i][body.joint].translation).length()
            };
            let jump = way(1) - max(way(0), way(2));
            farthest = Some(max(farthest.unwrap_or(0.0), jump));
        }
    }
    farthest
}
