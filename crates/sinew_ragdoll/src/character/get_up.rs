//! From lying to standing: which clip, where, and which way round.

use super::animate::Motion;
use super::{Character, CharacterDef, Event, State, ground};
use sinew_anim::{LocalTransform, SampleCache, Wrap, local_to_model, sample};
use sinew_math::{Affine, Rotation, Transform, Vec3, max, min, trig};
use sinew_physics::World;

/// Seconds of the fade from the bodies' pose into a get-up clip.
const FADE_TO_GET_UP: f32 = 0.4;
/// Seconds of the fade from lying to standing, without a clip.
const FADE_TO_STAND: f32 = 0.8;
/// Seconds of the fade from the end of the get-up clip into the looped one.
const FADE_TO_LOOP: f32 = 0.3;
/// How far above the pelvis the ground is sought, metres.
const ABOVE_PELVIS: f32 = 0.3;

/// Where the pelvis is and which way its own up, forward and left point.
#[derive(Clone, Copy, Debug)]
struct Pelvis {
    position: Vec3,
    axes: [Vec3; 3],
}

impl Pelvis {
    fn new(def: &CharacterDef, world_from_body: Transform) -> Self {
        let body = &def.ragdoll.bodies[0];
        let turn = world_from_body.rotation * body.character_from_body.rotation.inverse();
        Self {
            position: world_from_body.translation,
            axes: [Vec3::Y, Vec3::Z, Vec3::X].map(|axis| turn * axis),
        }
    }

    /// Of a pose, in character space.
    fn of_pose(def: &CharacterDef, pose: &[LocalTransform]) -> Self {
        let mut model = Vec::new();
        local_to_model(&def.rig, pose, &Affine::IDENTITY, &mut model);
        let mut bodies = Vec::new();
        def.mapping().bodies_from_model(&model, Transform::IDENTITY, &mut bodies);
        Self::new(def, bodies[0])
    }

    /// 1 lying on the back, −1 on the face, 0 on a side or upright.
    fn supine(&self) -> f32 {
        self.axes[1].y
    }

    /// Where a character must stand for this pelvis, of its pose, to be above or below `other` in the world and to
    /// point the same way. The heading is compared by the axis that is most level in both.
    fn placed_at(&self, other: &Self, height: f32) -> Transform {
        let level = |v: Vec3| Vec3::new(v.x, 0.0, v.z);
        let common = |k: usize| min(level(self.axes[k]).length(), level(other.axes[k]).length());
        let axis =
            [0, 1, 2].into_iter().reduce(|a, b| if common(b) > common(a) { b } else { a }).unwrap_or(0);
        let heading = |v: Vec3| trig::atan2(v.x, v.z);
        let yaw = heading(other.axes[axis]) - heading(self.axes[axis]);
        let turn = Rotation::from_axis_angle(Vec3::Y, yaw);
        let place = other.position - turn * self.position;
        Transform::new(Vec3::new(place.x, height, place.z), turn)
    }
}

/// The flat pose at the start of a clip, or the rest pose.
fn first_pose(def: &CharacterDef, clip: Option<usize>) -> Vec<LocalTransform> {
    let mut pose = def.rest().to_vec();
    if let Some(clip) = clip {
        sample(&def.clips[clip], &def.rig, 0.0, Wrap::Clamp, &mut pose);
        def.mapping().flatten(&def.rig, &mut pose);
    }
    pose
}

impl Character {
    /// Gives the pose back to the clips, by the get-up clip whose start lies most like the body does.
    pub(super) fn get_up(&mut self, world: &mut World) {
        let pelvis = Pelvis::new(&self.def, self.scratch.after[0]);
        let candidates = self.def.get_ups.iter().map(|&clip| {
            let starts = Pelvis::of_pose(&self.def, &first_pose(&self.def, Some(clip)));
            ((starts.supine() - pelvis.supine()).abs(), clip)
        });
        let clip = candidates.reduce(|a, b| if b.0 < a.0 { b } else { a }).map(|(_, clip)| clip);
        if let Some(ragdoll) = self.ragdoll.take() {
            ragdoll.despawn(world);
        }
        self.events.push(Event::GettingUp { clip });
        match clip {
            Some(index) => {
                self.play(world, pelvis, clip, Wrap::Clamp, FADE_TO_GET_UP);
                self.motion.ends = max(self.def.clips[index].duration, FADE_TO_GET_UP);
            }
            None => {
                self.play(world, pelvis, self.def.looped, Wrap::Loop, FADE_TO_STAND);
                self.motion.ends = FADE_TO_STAND;
            }
        }
        self.state = State::GettingUp;
    }

    /// Back to the looped clip.
    pub(super) fn stand(&mut self, world: &World) {
        let mut bodies = core::mem::take(&mut self.scratch.after);
        self.bodies_of_pose(self.world_from_character, &mut bodies);
        let pelvis = Pelvis::new(&self.def, bodies[0]);
        self.scratch.after = bodies;
        self.play(world, pelvis, self.def.looped, Wrap::Loop, FADE_TO_LOOP);
        self.state = State::Animated;
        self.events.push(Event::Up);
    }

    /// Starts a clip where the pelvis is, faded in from the present pose.
    fn play(&mut self, world: &World, pelvis: Pelvis, clip: Option<usize>, wrap: Wrap, fade: f32) {
        let height = ground::below(world, pelvis.position, ABOVE_PELVIS)
            .unwrap_or(self.world_from_character.translation.y);
        let from = self.world_from_character;
        let to = Pelvis::of_pose(&self.def, &first_pose(&self.def, clip)).placed_at(&pelvis, height);
        self.def.mapping().reframe(&mut self.pose, from, to);
        self.world_from_character = to;
        self.root_velocity = Vec3::ZERO;
        let mut faded = core::mem::take(&mut self.motion.from);
        faded.clear();
        faded.extend_from_slice(&self.pose);
        let cache = SampleCache::default();
        let ends = f32::INFINITY;
        self.motion = Motion { clip, wrap, phase: 0.0, time: 0.0, from: faded, fade, ends, cache };
    }
}
