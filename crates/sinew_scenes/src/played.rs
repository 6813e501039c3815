//! A file's motion played as bones over a floor: motion capture has no skin, and thus no bodies.

use crate::framework::actors::Figure;
use crate::framework::camera_hint::{CameraHint, Trails};
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::parts::{GRAVITY, floor};
use sinew::anim::{Clip, LocalTransform, Rig, Wrap, local_to_model, rest_pose, sample};
use sinew::math::{Affine, ReadError, Reader, Vec3};
use sinew::physics::boxes::Aabb;
use sinew::physics::{DebugDraw, DrawKind, World, WorldDef};

/// Number of sampled times that measure how far a motion travels.
const LOOKS: u32 = 24;

/// A looping clip of a rig; `world_from_file` converts the file's space to the world, metres.
///
/// # Panics
/// If a channel moves a joint that the rig does not have.
pub fn played(rig: Rig, clip: Clip, world_from_file: &Affine) -> Instance {
    let mut world = World::new(WorldDef { gravity: Vec3::NEG_Y * GRAVITY, ..WorldDef::default() });
    world.add_body(&floor());
    let pose = rest_pose(&rig);
    let mut played = Played { rig, clip, root: *world_from_file, pose, model: Vec::new(), around: None };
    for look in 0..LOOKS {
        played.show(played.clip.duration * (look as f32 / LOOKS as f32));
        let joints = played.model.iter().map(|joint| joint.translation);
        let all = joints.map(|at| Aabb { min: at, max: at }).reduce(|a, b| a.merge(&b));
        played.around = played.around.into_iter().chain(all).reduce(|a, b| a.merge(&b));
    }
    played.show(0.0);
    Instance::new(world, played)
}

struct Played {
    rig: Rig,
    clip: Clip,
    root: Affine,
    pose: Vec<LocalTransform>,
    /// World from joint.
    model: Vec<Affine>,
    around: Option<Aabb>,
}

impl Played {
    /// Shows the pose at `seconds` of the clip.
    fn show(&mut self, seconds: f32) {
        sample(&self.clip, &self.rig, seconds, Wrap::Loop, &mut self.pose);
        local_to_model(&self.rig, &self.pose, &self.root, &mut self.model);
    }

    fn show_now(&mut self, world: &World) {
        let length = f64::from(self.clip.duration).max(1e-3);
        self.show((world.time() % length) as f32);
    }
}

impl Script for Played {
    fn after_step(&mut self, world: &mut World) {
        self.show_now(world);
    }

    fn load(&mut self, _: &mut Reader<'_>) -> Result<(), ReadError> {
        Ok(())
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let length = f64::from(self.clip.duration).max(1e-3);
        vec![
            Metric::new("clip_s", world.time() % length, Expected::Anything),
            Metric::new("clip_length_s", f64::from(self.clip.duration), Expected::Anything),
        ]
    }

    fn camera_hint(&self) -> CameraHint {
        CameraHint { direction: Vec3::new(1.0, 0.35, 0.5), bounds: self.around, trails: Trails::None }
    }

    fn draw(&self, _: &World, out: &mut dyn DebugDraw) {
        for (joint, node) in self.rig.joints.iter().enumerate() {
            if let Some(parent) = node.parent {
                out.line(self.model[parent].translation, self.model[joint].translation, DrawKind::Object);
            }
        }
    }

    fn figures(&self) -> Vec<Figure<'_>> {
        vec![Figure { rig: &self.rig, world_from_joint: &self.model }]
    }
}
