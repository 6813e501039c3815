//! Momentum of the animated pose and of the ragdoll that takes over.

use crate::actor::{floor, shared, somewhere, walker};
use sinew_anim::{Wrap, local_to_model, sample};
use sinew_math::{Affine, Rotation, Transform, Vec3};
use sinew_physics::{Velocity, World, WorldDef};
use sinew_ragdoll::hand_over::{SpeedBound, body_velocity};
use sinew_ragdoll::{Character, CharacterDef};
use sinew_scenes::mannequin::WALK_SPEED;

/// World poses of the bodies as the walk has them at a time, without a `Character`.
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

/// Momentum of rigid bodies carried by the walk.
struct Carried {
    linear: Vec3,
    /// About the common centre of mass.
    angular: Vec3,
    /// Sum of the bodies' shares of it without regard to direction: limbs that swing against each other cancel.
    swing: f32,
}

/// By central differences over `dt` on either side.
fn carried_momentum(def: &CharacterDef, at: Transform, time: f32, dt: f32) -> Carried {
    let [before, now, after] = [time - dt, time, time + dt].map(|time| carried_bodies(def, at, time));
    let bodies = &def.ragdoll.bodies;
    let total: f32 = bodies.iter().map(|body| body.mass.mass).sum();
    let center = |body: usize, pose: &[Transform]| pose[body].point(bodies[body].mass.center);
    let common = (0..bodies.len())
        .fold(Vec3::ZERO, |sum, body| sum + center(body, &now) * (bodies[body].mass.mass / total));
    let mut sum = Carried { linear: Vec3::ZERO, angular: Vec3::ZERO, swing: 0.0 };
    for (body, def) in bodies.iter().enumerate() {
        let p = (center(body, &after) - center(body, &before)) * (def.mass.mass / (2.0 * dt));
        // The turn's matrix minus its transpose holds the axis: no logarithm, unlike the code under test.
        let turn = (after[body].rotation * before[body].rotation.inverse()).to_mat3();
        let axis = Vec3::new(
            turn.y_axis.z - turn.z_axis.y,
            turn.z_axis.x - turn.x_axis.z,
            turn.x_axis.y - turn.y_axis.x,
        );
        let spin = axis * 0.5 / (2.0 * dt);
        sum.linear += p;
        let r = now[body].rotation;
        let share = (center(body, &now) - common).cross(p) + r * (def.mass.inertia * (r.inverse() * spin));
        sum.angular += share;
        sum.swing += share.length();
    }
    sum
}

#[test]
fn ragdoll_has_the_momentum_of_the_walk() {
    let def = shared(walker());
    // Between the clip's keys (30 a second), at which its velocity jumps and has no one value.
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
        let ragdoll = character.ragdoll().expect("it is limp");
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
        assert!(error < 0.01, "step {steps}: linear {} for {}", momentum.linear, carried.linear);
        let error = (about_center - carried.angular).length() / carried.swing;
        assert!(error < 0.01, "step {steps}: angular {about_center} for {}", carried.angular);
    }
}

#[test]
fn a_turning_body_hands_over_its_spin_and_the_speed_of_its_center() {
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
fn speeds_are_bounded() {
    let bound = SpeedBound { linear: 2.0, angular: 3.0 };
    let after = Transform::new(Vec3::X, Rotation::from_axis_angle(Vec3::Y, 1.0));
    let velocity = body_velocity(Transform::IDENTITY, after, Vec3::ZERO, 0.01, bound);
    assert!((velocity.linear - Vec3::X * 2.0).length() < 1e-5);
    assert!((velocity.angular - Vec3::Y * 3.0).length() < 1e-5);
}
