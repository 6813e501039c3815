//! Driven ragdolls: held by a pin, guided through a walk, hit.

use crate::framework::actors::Gone;
use crate::framework::camera_hint::{CameraHint, Trails};
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::ragdolls::{bind_pose, placed, ragdoll_of_mannequin, spawn_at};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::mannequin::{Mannequin, mannequin};
use crate::parts::{GRAVITY, cuboid, fixed, floor};
use sinew::anim::{Clip, LocalTransform, Rig, Wrap, analyze, local_to_model, rest_pose, sample};
use sinew::math::{Affine, Rotation, Transform, Vec3, max};
use sinew::physics::{Velocity, World};
use sinew::ragdoll::hand_over::{SpeedBound, body_velocities};
use sinew::ragdoll::{
    BodySettings, BodyState, BuildOptions, CharacterDef, DriveMode, Drives, Muscle, Pin, Ragdoll, RagdollDef,
    build,
};

pub(in crate::scenes) const POWERED: Scene = Scene {
    chapter: Chapter::Ragdolls,
    name: "powered",
    about: "the mannequin, pinned by its pelvis over a stand, holds its pose with its muscles; one arm is limp",
    steps: 480,
    settings: &[Setting::number("hertz", 5.0, (1.0, 30.0), "frequency of its muscles, Hz")],
    build: powered,
};

pub(in crate::scenes) const HIT_REACTION: Scene = Scene {
    chapter: Chapter::Ragdolls,
    name: "hit_reaction",
    about: "pins and muscles move the mannequin through a walk on the spot; a hit on a hand pushes the arm away, and it returns",
    steps: 480,
    settings: &[Setting::number("impulse", 20.0, (0.0, 60.0), "impulse on the hand, N·s")],
    build: hit_reaction,
};

/// Height of the soles at which the pelvis of the first is pinned, metres.
const STAND: f32 = 0.4;

fn powered(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    let def = ragdoll_of_mannequin();
    let place = Vec3::Y * STAND;
    let targets: Vec<_> = placed(&def, &bind_pose(&def), Rotation::IDENTITY, place).collect();
    let ragdoll = spawn_at(&mut world, &def, &bind_pose(&def), Rotation::IDENTITY, place, Vec3::ZERO);
    // The post is behind the pelvis.
    let post =
        Vec3::new(targets[0].translation.x, 0.5 * targets[0].translation.y, targets[0].translation.z - 0.4);
    world.add_body(&fixed(cuboid(Vec3::new(0.06, post.y, 0.06), post)));
    let muscle = Muscle { hertz: setup.number("hertz"), ..Muscle::ALIVE };
    let mut drives = Drives::new(&def);
    drives.set_all(DriveMode::Powered(muscle), 0.0);
    drives.set(0, DriveMode::Pinned(muscle, Pin { hertz: 10.0, ..Pin::FIRM }), 0.0);
    drives.set_from(&def, body(&def, "leftUpperArm"), DriveMode::Limp, 0.0);
    let mut held = Held { def, ragdoll, drives, targets, work: 0.0 };
    held.drive(&mut world);
    Instance::new(world, held)
}

fn body(def: &RagdollDef, role: &str) -> usize {
    def.bodies.iter().position(|body| body.role == role).expect("the mannequin has a body of this role")
}

fn mass(def: &RagdollDef) -> f32 {
    def.bodies.iter().map(|body| body.mass.mass).sum()
}

/// A ragdoll held in place.
struct Held {
    def: RagdollDef,
    ragdoll: Ragdoll,
    drives: Drives,
    targets: Vec<Transform>,
    /// Work of the ragdoll's drives, J.
    work: f32,
}

impl Held {
    fn drive(&mut self, world: &mut World) {
        let still = vec![Velocity::default(); self.targets.len()];
        self.drives.apply(world, &self.def, &self.ragdoll, &self.targets, &still);
    }

    /// Distance of a body from its target, metres.
    fn off(&self, world: &World, body: usize) -> f32 {
        let center = self.def.bodies[body].mass.center;
        (world.center_of_mass(self.ragdoll.bodies[body]) - self.targets[body].point(center)).length()
    }

    /// Angle of a hanging upper arm from the vertical, degrees.
    fn hang(&self, world: &World) -> f32 {
        let arm = body(&self.def, "leftUpperArm");
        let joint = self.def.joints[arm - 1];
        let shoulder = (world.transform(self.ragdoll.bodies[arm]) * joint.frame_child).translation;
        let way = world.center_of_mass(self.ragdoll.bodies[arm]) - shoulder;
        Rotation::from_arc(Vec3::NEG_Y, way / way.length()).angle_to(Rotation::IDENTITY).to_degrees()
    }
}

impl Script for Held {
    fn before_step(&mut self, world: &mut World) {
        self.drive(world);
    }

    fn after_step(&mut self, world: &mut World) {
        self.work += world.work().total();
    }

    fn work_in(&self, _: &World) -> f32 {
        self.work
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let force = self.drives.pin_force(world, 0).force;
        let of = |role: &str| f64::from(self.off(world, body(&self.def, role)));
        let gaps = self.ragdoll.joints.iter().map(|&joint| world.joint_gap(joint)).fold(0.0, max);
        vec![
            Metric::new("pin_force_n", force.y, Expected::near(mass(&self.def) * GRAVITY, 0.003)),
            Metric::new("held_arm_off_m", of("rightHand"), Expected::AtMost(0.06)),
            Metric::new("head_off_m", of("head"), Expected::AtMost(0.03)),
            Metric::new("limp_arm_hangs_off_deg", self.hang(world), Expected::AtMost(15.0)),
            Metric::new("limp_arm_off_m", of("leftHand"), Expected::Anything),
            Metric::new("joint_gap_max_m", gaps, Expected::AtMost(1e-4)),
            Metric::new("work_in_j", self.work, Expected::Anything),
        ]
    }

    fn camera_hint(&self) -> CameraHint {
        CameraHint { direction: Vec3::new(0.3, 0.15, 1.0), trails: Trails::None, ..CameraHint::default() }
    }
}

/// Step after which the hand is hit.
const HIT: u64 = 180;
/// Height of the soles at which no foot reaches the floor, metres.
const AIR: f32 = 0.25;

fn hit_reaction(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    let Mannequin { rig, mut clips, motions } = mannequin();
    let analysis = analyze(&rig).expect("the mannequin has a skin");
    let (ragdoll, _) = build(&rig, &analysis, &BuildOptions::default()).expect("the rig has bones");
    let walk = clips.swap_remove(motions.walk);
    let def = CharacterDef::new(rig, ragdoll, &analysis.bind_model);
    let walk = Walk { def, walk };
    let dt = world.def().dt();
    let states = walk.states(0, dt);
    let ragdoll = Ragdoll::spawn(&mut world, &walk.def.ragdoll, &states, &BodySettings::default());
    let mut drives = Drives::new(&walk.def.ragdoll);
    drives.set_all(DriveMode::Pinned(Muscle::ALIVE, Pin { hertz: 4.0, ..Pin::FIRM }), 0.0);
    let start = vertical_momentum(&world, &ragdoll);
    let mut led = Led {
        hand: body(&walk.def.ragdoll, "leftLowerArm"),
        walk,
        ragdoll,
        drives,
        gone: Gone::default(),
        impulse: setup.number("impulse"),
        work: 0.0,
        lifted: 0.0,
        start,
        arm_off: [0.0; 3],
        legs_off: [0.0; 2],
    };
    led.drive(&mut world, 0);
    Instance::new(world, led)
}

fn vertical_momentum(world: &World, ragdoll: &Ragdoll) -> f32 {
    ragdoll.bodies.iter().map(|&body| world.velocity(body).linear.y * world.mass(body).mass).sum()
}

/// Motion of a clip as poses of bodies.
struct Walk {
    def: CharacterDef,
    walk: Clip,
}

impl Walk {
    fn bodies(&self, time: f32) -> Vec<Transform> {
        let rig: &Rig = &self.def.rig;
        let mut pose: Vec<LocalTransform> = rest_pose(rig);
        sample(&self.walk, rig, time, Wrap::Loop, &mut pose);
        self.def.mapping().flatten(rig, &mut pose);
        let (mut model, mut bodies) = (Vec::new(), Vec::new());
        local_to_model(rig, &pose, &Affine::IDENTITY, &mut model);
        self.def.mapping().bodies_from_model(&model, Transform::from_translation(Vec3::Y * AIR), &mut bodies);
        bodies
    }

    /// Returns the target states of the bodies after `steps` steps.
    fn states(&self, steps: u64, dt: f32) -> Vec<BodyState> {
        let time = steps as f32 * dt;
        let (before, now) = (self.bodies(time - dt), self.bodies(time));
        let mut velocities = Vec::new();
        body_velocities(&self.def.ragdoll, &before, &now, dt, SpeedBound::default(), &mut velocities);
        let poses = now.into_iter().zip(velocities);
        poses.map(|(world_from_body, velocity)| BodyState { world_from_body, velocity }).collect()
    }
}

/// A ragdoll that follows a walk.
struct Led {
    walk: Walk,
    ragdoll: Ragdoll,
    drives: Drives,
    gone: Gone,
    hand: usize,
    impulse: f32,
    /// Work of the drives, J.
    work: f32,
    /// Sum of the pins' upward forces over the steps, N·s.
    lifted: f32,
    /// Upward momentum at the start, N·s.
    start: f32,
    /// Largest distance of the arm from the clip's pose, metres: before the hit, in the second after it, in the last
    /// second.
    arm_off: [f32; 3],
    /// Largest distance of the thighs from the clip's pose, metres: before the hit and since.
    legs_off: [f32; 2],
}

impl Led {
    /// Sets the actions of step number `step` (from 0).
    fn drive(&mut self, world: &mut World, step: u64) {
        let states = self.walk.states(step + 1, world.def().dt());
        let targets: Vec<Transform> = states.iter().map(|state| state.world_from_body).collect();
        let velocities: Vec<Velocity> = states.iter().map(|state| state.velocity).collect();
        self.drives.apply(world, &self.walk.def.ragdoll, &self.ragdoll, &targets, &velocities);
    }

    fn off(&self, world: &World, role: &str, wanted: &[BodyState]) -> f32 {
        let def = &self.walk.def.ragdoll;
        let body = body(def, role);
        let goal = wanted[body].world_from_body.point(def.bodies[body].mass.center);
        (world.center_of_mass(self.ragdoll.bodies[body]) - goal).length()
    }

    fn watch(&mut self, world: &World) {
        let steps = world.step_count();
        let wanted = self.walk.states(steps, world.def().dt());
        let arm = self.off(world, "leftLowerArm", &wanted);
        let legs = max(self.off(world, "leftUpperLeg", &wanted), self.off(world, "rightUpperLeg", &wanted));
        let seen = |all: &mut f32, now: f32| *all = max(*all, now);
        match steps {
            // The pins pull the ragdoll into place.
            0..60 => {}
            60..=HIT => {
                seen(&mut self.arm_off[0], arm);
                seen(&mut self.legs_off[0], legs);
            }
            _ => {
                seen(&mut self.legs_off[1], legs);
                if steps <= HIT + 60 {
                    seen(&mut self.arm_off[1], arm);
                } else if steps > HIT + 240 {
                    seen(&mut self.arm_off[2], arm);
                }
            }
        }
    }
}

impl Script for Led {
    fn before_step(&mut self, world: &mut World) {
        let due = self.gone.due(world);
        let last = due.end - 1;
        for step in due {
            if step == HIT {
                self.drives.hit(&self.walk.def.ragdoll, self.hand, self.impulse);
            }
            if step < last {
                self.drives.skip(world.def().dt());
            } else {
                self.drive(world, step);
            }
        }
    }

    fn after_step(&mut self, world: &mut World) {
        self.work += world.work().total();
        for body in 0..self.ragdoll.bodies.len() {
            self.lifted += self.drives.pin_force(world, body).force.y * world.def().dt();
        }
        self.watch(world);
        if world.step_count() == HIT {
            let hand = self.ragdoll.bodies[self.hand];
            world.apply_impulse_at_center(hand, Vec3::NEG_Z * self.impulse);
        }
    }

    fn work_in(&self, _: &World) -> f32 {
        self.work
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let time = world.time() as f32;
        let gained = vertical_momentum(world, &self.ragdoll) - self.start;
        let weight = mass(&self.walk.def.ragdoll) * GRAVITY;
        let gaps = self.ragdoll.joints.iter().map(|&joint| world.joint_gap(joint)).fold(0.0, max);
        let arm = self.arm_off;
        vec![
            Metric::new("carried_n", (self.lifted - gained) / max(time, 1e-6), Expected::near(weight, 0.003)),
            Metric::new("arm_off_before_m", arm[0], Expected::AtMost(0.03)),
            Metric::new("arm_off_hit_m", arm[1], Expected::Anything),
            Metric::new("arm_off_after_m", arm[2], Expected::AtMost(0.03)),
            Metric::new("legs_off_before_m", self.legs_off[0], Expected::AtMost(0.03)),
            Metric::new("legs_off_since_m", self.legs_off[1], Expected::AtMost(0.04)),
            Metric::new("joint_gap_max_m", gaps, Expected::AtMost(1e-4)),
            Metric::new("work_in_j", self.work, Expected::Anything),
        ]
    }

    fn camera_hint(&self) -> CameraHint {
        CameraHint { direction: Vec3::new(0.8, 0.2, 0.6), trails: Trails::None, ..CameraHint::default() }
    }
}
