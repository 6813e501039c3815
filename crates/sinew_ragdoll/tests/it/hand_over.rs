//! Hand-over of momentum from the animated pose to the ragdoll.

use crate::actor::{floor, kaykit, shared, somewhere, walker};
use needs_data::needs_data;
use sinew_anim::{
    AnimatedClip, AnimationSet, Animator, BuiltClip, ClipId, Easing, LocalTransform, LoopMode, Skeleton,
    TrackDef, Transition, Wrap, local_to_model, sample,
};
use sinew_math::{Affine, Random, Rotation, Transform, Vec3, max};
use sinew_physics::{Velocity, World, WorldDef};
use sinew_ragdoll::hand_over::{SpeedBound, body_velocities, body_velocity};
use sinew_ragdoll::{BodySettings, BodyState, Character, CharacterDef, Ragdoll};
use sinew_scenes::mannequin::WALK_SPEED;
use std::sync::Arc;

/// Returns the world poses of the bodies in the walk at a time, computed without a `Character`.
fn carried_bodies(def: &CharacterDef, at: Transform, time: f32) -> Vec<Transform> {
    let mut pose = def.rest().to_vec();
    sample(&def.motions().clips[0], &def.rig, time, Wrap::Loop, &mut pose);
    let walked = at * Transform::from_translation(Vec3::Z * WALK_SPEED * time);
    let mut model = Vec::new();
    local_to_model(&def.rig, &pose, &Affine::IDENTITY, &mut model);
    let mut bodies = Vec::new();
    def.mapping().bodies_from_model(&model, walked, &mut bodies);
    bodies
}

/// Momentum of rigid bodies that follow the walk.
struct Carried {
    linear: Vec3,
    /// Angular momentum about the common centre of mass.
    angular: Vec3,
    /// Sum of the magnitudes of the bodies' shares; in the vector sum, limbs that swing against each other would
    /// cancel.
    swing: f32,
}

/// Computes the momentum by central differences over `dt` on either side.
fn carried_momentum(def: &CharacterDef, at: Transform, time: f32, dt: f32) -> Carried {
    let [before, now, after] = [time - dt, time, time + dt].map(|time| carried_bodies(def, at, time));
    momentum_of_motion(def, &before, &now, &after, 2.0 * dt)
}

/// Returns the momentum at `now` of bodies that move from `before` to `after` within `dt`.
fn momentum_of_motion(
    def: &CharacterDef,
    before: &[Transform],
    now: &[Transform],
    after: &[Transform],
    dt: f32,
) -> Carried {
    let bodies = &def.ragdoll.bodies;
    let total: f32 = bodies.iter().map(|body| body.mass.mass).sum();
    let center = |body: usize, pose: &[Transform]| pose[body].point(bodies[body].mass.center);
    let common = (0..bodies.len())
        .fold(Vec3::ZERO, |sum, body| sum + center(body, now) * (bodies[body].mass.mass / total));
    let mut sum = Carried { linear: Vec3::ZERO, angular: Vec3::ZERO, swing: 0.0 };
    for (body, def) in bodies.iter().enumerate() {
        let p = (center(body, after) - center(body, before)) * (def.mass.mass / dt);
        // The rotation matrix minus its transpose contains the axis. Unlike the tested code this needs no logarithm.
        let turn = (after[body].rotation * before[body].rotation.inverse()).to_mat3();
        let axis = Vec3::new(
            turn.y_axis.z - turn.z_axis.y,
            turn.z_axis.x - turn.x_axis.z,
            turn.x_axis.y - turn.y_axis.x,
        );
        let spin = axis * 0.5 / dt;
        sum.linear += p;
        let r = now[body].rotation;
        let share = (center(body, now) - common).cross(p) + r * (def.mass.inertia * (r.inverse() * spin));
        sum.angular += share;
        sum.swing += share.length();
    }
    sum
}

#[test]
fn ragdoll_inherits_the_momentum_of_the_walk() {
    let def = shared(walker());
    // The time is between keys (30 a second): at a key the clip's velocity is discontinuous.
    const PHASE: f32 = 0.01;
    for frame in 0..32 {
        let steps = 2 * frame;
        let mut world = World::new(WorldDef::default());
        world.add_body(&floor());
        let mut character = Character::new(def.clone(), somewhere(), PHASE);
        for _ in 0..steps {
            world.step();
            character.update(&mut world);
        }
        character.go_limp(&mut world);
        let momentum = world.momentum();
        let ragdoll = character.ragdoll().expect("the character is limp");
        let (mut mass, mut moment) = (0.0, Vec3::ZERO);
        for &body in &ragdoll.bodies {
            mass += world.mass(body).mass;
            moment += world.center_of_mass(body) * world.mass(body).mass;
        }
        let about_center = momentum.angular - (moment / mass).cross(momentum.linear);
        let time = PHASE + steps as f32 * world.def().dt();
        let start = somewhere() * Transform::from_translation(Vec3::Z * -WALK_SPEED * PHASE);
        let carried = carried_momentum(&def, start, time, 0.003);
        let error = (momentum.linear - carried.linear).length() / carried.linear.length();
        assert!(
            error < 0.01,
            "step {steps}: linear momentum {}, expected {}",
            momentum.linear,
            carried.linear
        );
        let error = (about_center - carried.angular).length() / carried.swing;
        assert!(error < 0.01, "step {steps}: angular momentum {about_center}, expected {}", carried.angular);
    }
}

#[test]
fn hand_over_keeps_spin_and_centre_velocity() {
    let center = Vec3::new(0.1, 0.2, -0.05);
    let spin = Vec3::new(1.0, -2.0, 0.5);
    let (dt, pivot) = (0.01, Vec3::new(3.0, 1.0, 2.0));
    let before = Transform::new(Vec3::new(3.4, 1.2, 2.0), Rotation::from_axis_angle(Vec3::Z, 0.3));
    let turn = Rotation::from_scaled_axis(spin * dt);
    let after = Transform::new(turn * (before.translation - pivot) + pivot, turn * before.rotation);
    let Velocity { linear, angular } = body_velocity(before, after, center, dt, SpeedBound::default());
    assert!((angular - spin).length() < 1e-3, "{angular}");
    let middle = (before.point(center) + after.point(center)) * 0.5;
    assert!((linear - spin.cross(middle - pivot)).length() < 1e-3, "{linear}");
}

#[test]
fn hand_over_speeds_are_bounded() {
    let bound = SpeedBound { linear: 2.0, angular: 3.0 };
    let after = Transform::new(Vec3::X, Rotation::from_axis_angle(Vec3::Y, 1.0));
    let velocity = body_velocity(Transform::IDENTITY, after, Vec3::ZERO, 0.01, bound);
    assert!((velocity.linear - Vec3::X * 2.0).length() < 1e-5);
    assert!((velocity.angular - Vec3::Y * 3.0).length() < 1e-5);
}

/// Returns the body poses `seconds` ahead, from an animator that is advanced separately.
fn bodies_in(character: &Character, seconds: f32) -> Vec<Transform> {
    let def = character.def();
    let mut animator = character.animator().clone();
    animator.update(def.set(), seconds);
    let pose: Vec<_> = animator.pose().iter().collect();
    let mut model = Vec::new();
    local_to_model(&def.rig, &pose, &Affine::IDENTITY, &mut model);
    let mut bodies = Vec::new();
    // The mannequin's model space is its character space.
    def.mapping().bodies_from_model(
        &model,
        character.world_from_character() * animator.root_motion(),
        &mut bodies,
    );
    bodies
}

#[test]
fn momentum_matches_random_blends_of_clips() {
    let def = shared(walker());
    let mut random = Random::new(3);
    let mass = def.ragdoll.total_mass;
    let (mut worst, mut checked) = ([0.0_f32; 2], 0);
    for _ in 0..60 {
        let mut world = World::new(WorldDef::default());
        let mut character = Character::new(def.clone(), somewhere(), random.range(0.0, 1.0));
        for step in 0..40 {
            if step % 9 == 3 {
                let clip = random.index(4);
                let clip = TrackDef {
                    start: random.range(0.0, 1.0),
                    speed: random.range(0.3, 1.5),
                    // A looped get-up clip would jump from standing to lying, so it plays once.
                    loop_mode: if clip < 2 { LoopMode::Loop } else { LoopMode::Once },
                    ..TrackDef::new(def.clip(clip))
                };
                let seconds = random.range(0.1, 0.5);
                let transition = match random.index(2) {
                    0 => Transition::Inertial { seconds },
                    _ => Transition::Crossfade { seconds, easing: Easing::Smooth },
                };
                character.animator_mut().transition(def.set(), &clip, transition);
            }
            world.step();
            character.update(&mut world);
        }
        // Use three points, because speeds change within a transition. At a key of a clip speeds are discontinuous;
        // points at twice the distance then give another result.
        let start = |h: f32| {
            let [now, ahead, further] = [0.0, h, 2.0 * h].map(|seconds| bodies_in(&character, seconds));
            let soon = momentum_of_motion(&def, &now, &now, &ahead, h);
            let both = momentum_of_motion(&def, &now, &now, &further, 2.0 * h);
            Carried {
                linear: soon.linear * 2.0 - both.linear,
                angular: soon.angular * 2.0 - both.angular,
                swing: soon.swing,
            }
        };
        let (carried, wider) = (start(5e-4), start(1e-3));
        // A body with little net motion still has moving limbs.
        let scale = [max(carried.linear.length(), 0.3 * mass), max(carried.swing, 0.5)];
        let apart = [carried.linear - wider.linear, carried.angular - wider.angular];
        if max(apart[0].length() / scale[0], apart[1].length() / scale[1]) > 0.004 {
            continue;
        }
        checked += 1;
        character.go_limp(&mut world);
        let momentum = world.momentum();
        let ragdoll = character.ragdoll().expect("the character is limp");
        let moment = ragdoll
            .bodies
            .iter()
            .fold(Vec3::ZERO, |sum, &body| sum + world.center_of_mass(body) * world.mass(body).mass);
        let about_center = momentum.angular - (moment / mass).cross(momentum.linear);
        let linear = (momentum.linear - carried.linear).length() / scale[0];
        let angular = (about_center - carried.angular).length() / scale[1];
        worst = [max(worst[0], linear), max(worst[1], angular)];
    }
    assert!(checked > 40, "{checked} of 60 times were not at a key");
    println!("largest errors of {checked} mixtures: linear {:.4}, angular {:.4}", worst[0], worst[1]);
    assert!(worst.iter().all(|&error| error < 0.01), "{worst:?}");
}

/// An animator that blends the walker's clips at random, evaluated as poses of bodies.
struct Mixer {
    def: CharacterDef,
    set: AnimationSet,
    clips: Vec<ClipId>,
    animator: Animator,
    place: Transform,
}

impl Mixer {
    fn new(random: &mut Random) -> Self {
        let def = walker();
        let mut set = AnimationSet::new(Skeleton::new(&def.rig));
        let clips = def.motions().clips.iter().map(|clip| {
            let built =
                BuiltClip::build(clip, &def.rig, &Default::default()).expect("the walker's clips are good");
            set.add_clip(AnimatedClip::from(built))
        });
        let clips = clips.collect();
        let place = Transform::new(random.in_cube() * 3.0, random.rotation());
        Self { animator: Animator::new(&set), def, set, clips, place }
    }

    /// Starts a track in addition to the others, or cross-fades to it.
    fn change(&mut self, random: &mut Random) {
        let track = TrackDef {
            weight: random.range(0.2, 1.0),
            speed: random.range(0.5, 1.5),
            start: random.range(0.0, 1.5),
            ..TrackDef::new(self.clips[random.index(self.clips.len())])
        };
        let seconds = random.range(0.1, 0.6);
        match random.index(3) {
            0 => _ = self.animator.play(&self.set, &track),
            1 => {
                let way = Transition::Crossfade { seconds, easing: Easing::Smooth };
                self.animator.transition(&self.set, &track, way);
            }
            _ => _ = self.animator.transition(&self.set, &track, Transition::Inertial { seconds }),
        }
    }

    fn step(&mut self, dt: f32, out: &mut Vec<Transform>) {
        self.animator.update(&self.set, dt);
        // The code that moves the character translates and rotates it as well.
        let turn = Rotation::from_scaled_axis(Vec3::Y * 0.9 * dt);
        self.place = Transform::new(
            self.place.translation + Vec3::new(1.0, 0.2, 0.5) * dt,
            turn * self.place.rotation,
        );
        let mut pose: Vec<LocalTransform> = self.animator.pose().iter().collect();
        self.def.mapping().flatten(&self.def.rig, &mut pose);
        let mut model = Vec::new();
        local_to_model(&self.def.rig, &pose, &Affine::IDENTITY, &mut model);
        self.def.mapping().bodies_from_model(&model, self.place, out);
    }
}

/// Returns the linear and angular momentum of a ragdoll, the latter about its common centre of mass.
fn momentum_of_ragdoll(world: &World, ragdoll: &Ragdoll) -> (Vec3, Vec3) {
    let momentum = world.momentum();
    let (mut mass, mut moment) = (0.0, Vec3::ZERO);
    for &body in &ragdoll.bodies {
        mass += world.mass(body).mass;
        moment += world.center_of_mass(body) * world.mass(body).mass;
    }
    (momentum.linear, momentum.angular - (moment / mass).cross(momentum.linear))
}

#[test]
fn ragdoll_inherits_the_momentum_of_any_blend() {
    let mut random = Random::new(21);
    let dt = 1.0 / 60.0;
    let mut least = f32::INFINITY;
    for case in 0..60 {
        let mut mixer = Mixer::new(&mut random);
        let (mut before, mut now) = (Vec::new(), Vec::new());
        for frame in 0..5 + random.index(60) {
            if frame % 8 == 0 {
                mixer.change(&mut random);
            }
            core::mem::swap(&mut before, &mut now);
            mixer.step(dt, &mut now);
        }
        let def = &mixer.def;
        let mut velocities = Vec::new();
        body_velocities(&def.ragdoll, &before, &now, dt, SpeedBound::default(), &mut velocities);
        let poses = now.iter().zip(&velocities);
        let states: Vec<BodyState> =
            poses.map(|(&world_from_body, &velocity)| BodyState { world_from_body, velocity }).collect();
        let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
        let body_settings = BodySettings { angular_damping: 0.0, ..BodySettings::default() };
        let ragdoll = Ragdoll::spawn(&mut world, &def.ragdoll, &states, &body_settings);
        let animated = momentum_of_motion(def, &before, &now, &now, dt);
        least = sinew_math::min(least, animated.linear.length());
        for step in 0..3 {
            let (linear, angular) = momentum_of_ragdoll(&world, &ragdoll);
            let error = (linear - animated.linear).length() / max(animated.linear.length(), 10.0);
            assert!(
                error < 0.01,
                "case {case}, step {step}: linear momentum {linear}, expected {}",
                animated.linear
            );
            let error = (angular - animated.angular).length() / max(animated.swing, 1.0);
            assert!(
                error < 0.01,
                "case {case}, step {step}: angular momentum {angular}, expected {}",
                animated.angular
            );
            world.step();
        }
    }
    assert!(
        least > 10.0,
        "the animated bodies must move in every step; their least momentum is {least} kg·m/s"
    );
}

/// Returns the largest angular acceleration of a body in the first step after going limp, at several phases, in the
/// air: only joints act on limbs, no floor or push. In the last run joints have the friction of the definition.
fn first_jolt(def: &Arc<CharacterDef>) -> f32 {
    let mut jolt = 0.0;
    for start in [0.0, 0.2, 0.45, 0.7] {
        let mut world = World::new(WorldDef::default());
        let place = Transform::from_translation(Vec3::Y * 30.0);
        let mut character = Character::new(def.clone(), place, start);
        for _ in 0..10 {
            world.step();
            character.update(&mut world);
        }
        character.go_limp(&mut world);
        let ragdoll = character.ragdoll().expect("the character is limp").clone();
        let spins = |world: &World| -> Vec<Vec3> {
            ragdoll.bodies.iter().map(|&body| world.velocity(body).angular).collect()
        };
        let before = spins(&world);
        for step in 0..13 {
            world.step();
            character.update(&mut world);
            if step == 0 {
                let jolts = before.iter().zip(spins(&world)).map(|(&a, b)| (b - a).length() * 60.0);
                jolt = jolts.fold(jolt, max);
            }
        }
        for (joint, &id) in def.ragdoll.joints.iter().zip(&ragdoll.joints) {
            assert_eq!(world.joint(id).friction_torque, joint.friction_torque);
        }
    }
    jolt
}

#[test]
fn joint_friction_does_not_stop_limbs_at_once() {
    check_friction(walker());
}

#[needs_data]
#[test]
fn joint_friction_does_not_stop_kaykit_limbs_at_once() {
    check_friction(kaykit());
}

fn check_friction(def: CharacterDef) {
    let mut smooth = def.clone();
    smooth.ragdoll.joints.iter_mut().for_each(|joint| joint.friction_torque = 0.0);
    let [usual, without] = [def, smooth].map(|def| first_jolt(&shared(def)));
    println!("{usual} rad/s² in the first step, {without} without friction");
    // The remaining acceleration comes from limits that a clip exceeds.
    assert!(usual <= 1.001 * without, "in the first step {usual} rad/s², without friction {without} rad/s²");
}
