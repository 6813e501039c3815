//! Characters that play clips beside a scene's world.

use crate::mannequin::drills::Cycle;
use crate::mannequin::mannequin;
use crate::parts::{body, ghost};
use core::ops::Range;
use sinew::anim::{
    AnimatedClip, AnimationSet, Animator, BuiltClip, Clip, ClipBuildOptions, ClipEvent, ClipId,
    LocalTransform, Markers, Rig, RootMotionOptions, Skeleton, extract_root_motion, local_to_model,
};
use sinew::math::{Affine, Transform, Vec3};
use sinew::physics::{BodyDef, BodyId, BodyKind, DebugDraw, DrawKind, Shape, Velocity, World};
use std::sync::Arc;

/// A character as drawn in a picture, by its skin.
#[derive(Clone, Copy, Debug)]
pub struct Figure<'a> {
    /// Joints and meshes of the character.
    pub rig: &'a Rig,
    /// Transform of each joint from its own space to the world, metres.
    pub world_from_joint: &'a [Affine],
}

/// A rig and its clips.
pub(crate) struct Cast {
    pub rig: Rig,
    pub set: AnimationSet,
}

impl Cast {
    /// The mannequin, without clips.
    pub fn mannequin() -> Self {
        Self::of(mannequin().rig)
    }

    pub fn of(rig: Rig) -> Self {
        Self { set: AnimationSet::new(Skeleton::new(&rig)), rig }
    }

    pub fn add(&mut self, clip: &Clip, events: Vec<ClipEvent>) -> ClipId {
        let clip = AnimatedClip { events, ..AnimatedClip::from(self.built(clip)) };
        self.set.add_clip(clip)
    }

    /// Adds a cycle, with its translation converted to root motion and its footfalls as the phase.
    pub fn add_cycle(&mut self, cycle: &Cycle, events: Vec<ClipEvent>) -> ClipId {
        let (still, motion) = extract_root_motion(&cycle.clip, &self.rig, &RootMotionOptions::on_ground(0));
        let clip = self.built(&still);
        let markers = Markers::new(cycle.strikes.to_vec());
        self.set.add_clip(AnimatedClip { clip, events, markers, motion: Some(motion) })
    }

    fn built(&self, clip: &Clip) -> BuiltClip {
        BuiltClip::build(clip, &self.rig, &ClipBuildOptions::default()).expect("the clip fits the rig")
    }

    /// Index of the joint of that name.
    pub fn joint(&self, name: &str) -> usize {
        let place = self.rig.joints.iter().position(|joint| joint.name == name);
        place.expect("the rig has a joint of that name")
    }
}

/// A character that plays its clips.
pub(crate) struct Actor {
    pub cast: Arc<Cast>,
    pub animator: Animator,
    /// World from character.
    pub place: Transform,
    pub local: Vec<LocalTransform>,
    /// World from joint.
    pub model: Vec<Affine>,
    /// Ball in the world for each marked joint, and the joint's index.
    marks: Vec<(BodyId, usize)>,
}

/// Marked joints, as in motion capture.
const MARKED: [&str; 5] = ["head", "leftHand", "rightHand", "leftFoot", "rightFoot"];

impl Actor {
    pub fn new(cast: &Arc<Cast>, place: Transform) -> Self {
        let animator = Animator::new(&cast.set);
        let (local, model) = (Vec::new(), Vec::new());
        let mut actor = Self { cast: cast.clone(), animator, place, local, model, marks: Vec::new() };
        actor.pose();
        actor
    }

    /// Adds balls that mark head, hands and feet, follow them, and collide with nothing.
    pub fn mark(&mut self, world: &mut World) {
        for name in MARKED {
            let joint = self.cast.joint(name);
            let ball = ghost(body(Shape::Sphere { radius: 0.03 }, self.model[joint].translation));
            let ball = world.add_body(&BodyDef { kind: BodyKind::Kinematic, ..ball });
            self.marks.push((ball, joint));
        }
    }

    /// Sets velocities that move the balls to their joints in the next step of the world.
    pub fn lead_marks(&self, world: &mut World) {
        let dt = world.def().dt();
        for &(ball, joint) in &self.marks {
            let way = self.model[joint].translation - world.transform(ball).translation;
            world.set_velocity(ball, Velocity { linear: way / dt, ..Velocity::default() });
        }
    }

    /// Advances the animation and moves the character by its root motion.
    pub fn update(&mut self, seconds: f32) {
        self.animator.update(&self.cast.set, seconds);
    }

    /// Moves the character by the animation's root motion.
    pub fn go(&mut self) {
        self.place = self.place * self.animator.root_motion();
    }

    /// Updates the joints from the animation.
    pub fn pose(&mut self) {
        self.local.clear();
        self.local.extend(self.animator.pose().iter());
        local_to_model(&self.cast.rig, &self.local, &Affine::from(self.place), &mut self.model);
    }

    pub fn figure(&self) -> Figure<'_> {
        Figure { rig: &self.cast.rig, world_from_joint: &self.model }
    }
}

/// Number of world steps that an animation has followed. After a world is restored during a run, the animation catches
/// up from its start.
#[derive(Default)]
pub(crate) struct Gone(u64);

impl Gone {
    /// Returns the numbers of the steps up to the next one; each number is returned only once.
    pub fn due(&mut self, world: &World) -> Range<u64> {
        let next = u64::max(self.0, world.step_count() + 1);
        core::mem::replace(&mut self.0, next)..next
    }
}

/// Draws a mark of the given size (metres) on a floor at y = 0.
pub(crate) fn mark_floor(at: Vec3, size: f32, out: &mut dyn DebugDraw) {
    let at = Vec3::new(at.x, 0.01, at.z);
    for arm in [Vec3::X, Vec3::Z, Vec3::new(0.7, 0.0, 0.7), Vec3::new(0.7, 0.0, -0.7)] {
        out.line(at - arm * size, at + arm * size, DrawKind::Object);
    }
}
