//! Poses of a bake at the frame rate of its clip.

use super::{BakeInput, Frame};
use crate::character::Character;
use sinew_anim::LocalTransform;
use sinew_math::{Transform, clamp};

/// Resamples poses at step times to frames at the clip's rate.
pub(super) struct Frames {
    pub list: Vec<Frame>,
    fps: f32,
    seconds: f32,
    world_from_character: Transform,
    /// Pose and time of the last step, for the frames between the last and the next step.
    last: Vec<LocalTransform>,
    last_time: f32,
    now: Vec<LocalTransform>,
}

impl Frames {
    pub fn new(input: &BakeInput<'_>) -> Self {
        Self {
            list: Vec::with_capacity(1 + (clamp(input.seconds, 0.0, 3600.0) * input.fps) as usize),
            fps: input.fps,
            seconds: input.seconds,
            world_from_character: input.world_from_character,
            last: Vec::new(),
            last_time: 0.0,
            now: Vec::new(),
        }
    }

    /// Adds the frames between the last step and the present one.
    pub fn add_until(&mut self, character: &Character, time: f32) {
        self.now.clear();
        self.now.extend_from_slice(character.pose());
        // All frames are relative to the character's start.
        character.def().mapping().reframe(
            &mut self.now,
            character.world_from_character(),
            self.world_from_character,
        );
        if self.last.is_empty() {
            self.last.clone_from(&self.now);
        }
        loop {
            let at = self.list.len() as f32 / self.fps;
            if at > time || at > self.seconds {
                break;
            }
            let span = time - self.last_time;
            let t = if span > 0.0 { clamp((at - self.last_time) / span, 0.0, 1.0) } else { 1.0 };
            let pose = self.last.iter().zip(&self.now).map(|(a, b)| between(a, b, t)).collect();
            self.list.push(Frame { time: at, state: character.state(), pose });
        }
        core::mem::swap(&mut self.last, &mut self.now);
        self.last_time = time;
    }
}

fn between(a: &LocalTransform, b: &LocalTransform, t: f32) -> LocalTransform {
    // A joint at rest keeps the same bits in all frames.
    if a == b {
        return *a;
    }
    LocalTransform {
        translation: a.translation * (1.0 - t) + b.translation * t,
        rotation: a.rotation.nlerp(b.rotation, t),
        scale: a.scale * (1.0 - t) + b.scale * t,
    }
}
