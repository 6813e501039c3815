//! Scene in which a character of a file falls limp on a floor. Pictures show its skin, or its bodies if it has no skin.

use crate::framework::actors::Figure;
use crate::framework::acts::{Act, Directed};
use crate::framework::camera_hint::{CameraHint, Trails};
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::parts::{GRAVITY, floor};
use sinew::anim::{Rig, RigAnalysis, local_to_model};
use sinew::math::{Affine, ReadError, Reader, Rotation, Transform, Vec3, Writer};
use sinew::physics::boxes::Aabb;
use sinew::physics::{BodyId, GroupId, World, WorldDef};
use sinew::ragdoll::{
    AfterSettling, BodySettings, BodyState, BuildError, BuildOptions, BuildReport, Character, CharacterDef,
    Opening, QualityMeter, Ragdoll, RagdollDef, build,
};
use std::sync::Arc;

/// Height of the soles above the floor at the start, as a share of the character's height.
const HEIGHT: f32 = 0.4;
/// Forward lean at the start, radians: an upright character would not fall over.
const LEAN: f32 = 0.35;

/// A character that falls limp on a floor, and the report on its ragdoll. The fall begins with the first step, in the
/// rest pose of the file.
///
/// # Errors
/// If no ragdoll can be built.
pub fn fall_of(rig: Rig, analysis: &RigAnalysis) -> Result<(Instance, BuildReport), BuildError> {
    let (ragdoll, report) = build(&rig, analysis, &BuildOptions::default())?;
    Ok((fall_with(rig, ragdoll, &analysis.bind_model), report))
}

/// [`fall_of`] with an existing ragdoll of that rig. `bind_model` is `RigAnalysis::bind_model`.
pub fn fall_with(rig: Rig, ragdoll: RagdollDef, bind_model: &[Affine]) -> Instance {
    fall_of_character(CharacterDef::new(rig, ragdoll, bind_model))
}

/// A character with motions, which falls limp from its rest pose and stays down until the user instructs it.
pub fn fall_of_character(mut def: CharacterDef) -> Instance {
    def.after_settling = AfterSettling::StayDown;
    def.set_opening(Opening::Rest);
    let def = Arc::new(def);
    let mut world = floor_alone();
    let mut character = Character::spawn(&mut world, &def, start(&def.ragdoll));
    character.go_limp(&mut world);
    let mut meter = QualityMeter::new(&def.ragdoll, SECONDS);
    meter.went_limp();
    meter.before_step(&world);
    let mut fallen = Fallen { def, character, meter, directed: Directed::default(), model: Vec::new() };
    fallen.show();
    Instance::new(world, fallen)
}

/// The bodies of a ragdoll without its rig, falling from the pose in which it was built, and their ids.
pub fn fall_of_bodies(def: &RagdollDef) -> (Instance, Vec<BodyId>) {
    let mut world = floor_alone();
    let world_from_character = start(def);
    let states: Vec<BodyState> = def
        .bodies
        .iter()
        .map(|body| BodyState {
            world_from_body: world_from_character * body.character_from_body,
            ..BodyState::default()
        })
        .collect();
    let ragdoll = Ragdoll::spawn(&mut world, def, &states, &BodySettings::default());
    (Instance::of_world(world), ragdoll.bodies)
}

fn floor_alone() -> World {
    let mut world = World::new(WorldDef { gravity: Vec3::NEG_Y * GRAVITY, ..WorldDef::default() });
    world.add_body(&floor());
    world
}

/// World from character at the start of a fall.
fn start(def: &RagdollDef) -> Transform {
    Transform::new(Vec3::Y * (HEIGHT * def.height), Rotation::from_axis_angle(Vec3::X, LEAN))
}

/// Half extents of the box that a camera keeps in the picture, as shares of the character's height: large enough for a
/// lying body and for raised arms.
pub(crate) const ROOM: Vec3 = Vec3::new(0.5, 0.56, 0.5);

/// Returns the centre of the bounds of all joints, world space, metres.
pub(crate) fn middle(model: &[Affine]) -> Vec3 {
    let points = model.iter().map(|joint| Aabb { min: joint.translation, max: joint.translation });
    points.reduce(|a, b| a.merge(&b)).unwrap_or_default().center()
}

/// Duration of a fall for which the quality meter reserves memory at the start, seconds.
const SECONDS: f32 = 10.0;

/// The falling character.
struct Fallen {
    def: Arc<CharacterDef>,
    character: Character,
    meter: QualityMeter,
    directed: Directed,
    /// World from joint.
    model: Vec<Affine>,
}

impl Fallen {
    fn show(&mut self) {
        let root = self.character.world_from_model();
        local_to_model(&self.def.rig, self.character.pose(), &root, &mut self.model);
    }
}

impl Script for Fallen {
    fn before_step(&mut self, world: &mut World) {
        self.meter.before_step(world);
    }

    fn after_step(&mut self, world: &mut World) {
        self.directed.work += world.work().total();
        if let Some(ragdoll) = self.character.ragdoll().filter(|_| !self.directed.is_directed) {
            self.meter.after_step(world, ragdoll);
        }
        self.character.update(world);
        self.directed.go_on(&mut self.character);
        self.show();
    }

    fn save(&self, out: &mut Writer) {
        self.character.save(out);
        self.directed.save(out);
    }

    fn load(&mut self, bytes: &mut Reader<'_>) -> Result<(), ReadError> {
        self.character.load(bytes)?;
        self.directed = Directed::load(bytes)?;
        self.show();
        Ok(())
    }

    /// Returns the metrics with the thresholds of a drop test.
    fn work_in(&self, _: &World) -> f32 {
        self.directed.work
    }

    fn metrics(&self, _: &World) -> Vec<Metric> {
        let q = self.meter.quality();
        vec![
            Metric::new("joint_gap_p99_m", q.joint_gap_p99_m, Expected::AtMost(1e-3)),
            Metric::new("joint_gap_max_m", q.joint_gap_max_m, Expected::AtMost(5e-3)),
            Metric::new("limit_overshoot_p99_deg", q.limit_overshoot_p99_deg, Expected::AtMost(2.0)),
            Metric::new("limit_overshoot_max_deg", q.limit_overshoot_max_deg, Expected::AtMost(4.0)),
            Metric::new("nonadjacent_overlap_max_m", q.nonadjacent_overlap_max_m, Expected::AtMost(0.01)),
            Metric::new("penetration_max_m", q.penetration_max_m, Expected::Anything),
            Metric::awaited("settled_s", q.settled_s, Expected::Anything),
            Metric::awaited("asleep_s", q.asleep_s, Expected::AtMost(6.0)),
        ]
    }

    /// View from the side, with room in the direction of the fall, +z.
    fn camera_hint(&self) -> CameraHint {
        let height = self.def.ragdoll.height;
        if self.directed.is_directed {
            let bounds = Aabb::around(middle(&self.model), ROOM * height);
            return CameraHint {
                direction: Vec3::new(1.0, 0.35, 0.5),
                bounds: Some(bounds),
                trails: Trails::None,
            };
        }
        let bounds =
            Aabb { min: Vec3::new(-0.4, 0.0, -0.3) * height, max: Vec3::new(0.4, 1.4, 1.3) * height };
        CameraHint { direction: Vec3::new(1.0, 0.35, 0.5), bounds: Some(bounds), trails: Trails::None }
    }

    fn figures(&self) -> Vec<Figure<'_>> {
        vec![Figure { rig: &self.def.rig, world_from_joint: &self.model }]
    }

    fn bodies_of_figures(&self) -> Vec<BodyId> {
        self.character.bodies().to_vec()
    }

    fn garments_of_figures(&self) -> &[GroupId] {
        self.character.garments()
    }

    fn strike(&mut self, world: &mut World, body: BodyId, impulse: Vec3, _: Vec3) {
        if let Some(body) = self.character.body_index(body) {
            self.character.hit(world, body, impulse);
        }
    }

    fn steer(&mut self, way: Vec3) {
        self.directed.steer(way, &mut self.character);
    }

    fn steered(&self) -> Option<Vec3> {
        Some(self.character.world_from_character().translation)
    }

    fn act(&mut self, world: &mut World, act: Act) {
        self.directed.act(act, &mut self.character, world);
    }

    fn directed(&self) -> Option<&Character> {
        Some(&self.character)
    }
}
