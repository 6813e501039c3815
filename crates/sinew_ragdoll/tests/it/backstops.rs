//! Backstops of garments: they keep cloth out of the drawn body where no ragdoll body fills the mesh, and do not
//! disturb cloth elsewhere.

use crate::garments::{go_on, ground, mean_stretch};
use sinew_anim::garments::Backstop;
use sinew_math::{Transform, Vec3, max};
use sinew_physics::particles::ParticleGroup;
use sinew_physics::{Shape, World, WorldDef};
use sinew_ragdoll::{Character, CharacterDef, MotionSet};
use sinew_scenes::dressed::{CAPE, Chains, SKIRT, dressed};
use std::sync::Arc;

fn worn(chains: &Chains, backstop: Option<Backstop>) -> CharacterDef {
    dressed(&[chains], |garment| garment.backstop = backstop)
}

/// Scales the width of a shape by `factor`.
fn thinner(shape: &Shape, factor: f32) -> Shape {
    match *shape {
        Shape::Capsule { half_height, radius } => Shape::Capsule { half_height, radius: radius * factor },
        Shape::Box { half_extents } => Shape::Box { half_extents: half_extents * factor },
        Shape::Sphere { radius } => Shape::Sphere { radius: radius * factor },
        Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => Shape::TaperedCapsule {
            half_height,
            radius_bottom: radius_bottom * factor,
            radius_top: radius_top * factor,
        },
        ref other => panic!("the mannequin has no {other:?}"),
    }
}

/// Returns a character whose bodies are half as thick as its mesh.
fn character_with_thin_bodies(backstop: Option<Backstop>) -> CharacterDef {
    let full = worn(&SKIRT, backstop);
    let mut ragdoll = full.ragdoll.clone();
    ragdoll.bodies.iter_mut().for_each(|body| body.shape = thinner(&body.shape, 0.5));
    let analysis = sinew_anim::analyze(&full.rig).expect("the rig has a skin");
    let mut def = CharacterDef::new(full.rig.clone(), ragdoll, &analysis.bind_model);
    def.set_garments(full.garments().source());
    def
}

/// Returns the largest depth of a free particle in the mannequin's fitted bodies, which represent its mesh; metres.
fn deepest(world: &World, character: &Character, drawn: &CharacterDef) -> f32 {
    let group = world.particles(character.garments()[0]);
    let is_free = |particle: u32| group.attachments().iter().all(|held| held.particle != particle);
    let mut deepest: f32 = 0.0;
    for (body, &id) in drawn.ragdoll.bodies.iter().zip(character.bodies()) {
        if !group.passes().contains(&id) {
            let frame = world.transform(id);
            let free = (0..).zip(group.positions()).filter(|(particle, _)| is_free(*particle));
            let depth = free.map(|(_, &at)| -body.shape.signed_distance(&frame, at).0);
            deepest = depth.fold(deepest, max);
        }
    }
    deepest
}

/// A strong wind from the front presses a skirt onto thighs and hips that no body fills.
#[test]
fn cloth_stays_out_of_the_mesh_where_no_body_is() {
    let drawn = worn(&SKIRT, None);
    let pressed = |backstop: Option<Backstop>| {
        let mut world = ground(Vec3::new(0.0, -9.81, -12.0));
        let mut character = Character::spawn(
            &mut world,
            &Arc::new(character_with_thin_bodies(backstop)),
            Transform::IDENTITY,
        );
        let rest = deepest(&world, &character, &drawn);
        let mut most: f32 = 0.0;
        for _ in 0..120 {
            go_on(&mut world, &mut character, 1);
            most = max(most, deepest(&world, &character, &drawn));
        }
        let fastest = world.particles(character.garments()[0]).velocities().iter().map(|v| v.length());
        (rest, most, fastest.fold(0.0, max))
    };
    let (rest, bare, _) = pressed(None);
    assert!(bare > rest + 0.02, "without a backstop the cloth is {bare} m deep, at rest {rest} m");
    let (_, stopped, fastest) = pressed(Some(Backstop { distance: 0.005, radius: 0.2 }));
    assert!(stopped < rest + 0.006, "with a backstop the cloth is {stopped} m deep, at rest {rest} m");
    assert!(fastest < 0.3, "the cloth moves at {fastest} m/s");
}

/// Returns the depth of each particle below its backstop's ball, metres; negative above the ball.
fn depths(world: &World, group: &ParticleGroup) -> Vec<f32> {
    let depth = |stop: &sinew_physics::particles::BackstopDef| {
        let particle = stop.particle as usize;
        let center = world.transform(stop.body).point(stop.center);
        stop.radius + group.radii()[particle] - (group.positions()[particle] - center).length()
    };
    group.backstops().iter().map(depth).collect()
}

/// Each free particle has a backstop behind its rest position, on the nearest body: the legs below the hips of a skirt,
/// never an arm beside it.
#[test]
fn each_free_particle_has_a_backstop_on_the_nearest_body() {
    let backstop = Backstop { distance: 0.03, radius: 0.25 };
    let mut def = worn(&SKIRT, Some(backstop));
    def.set_motions(MotionSet::default()).expect("none");
    let mut world = ground(Vec3::ZERO);
    let character = Character::spawn(&mut world, &Arc::new(def), Transform::IDENTITY);
    let group = world.particles(character.garments()[0]);
    assert_eq!(group.backstops().len() + group.attachments().len(), group.positions().len());
    let role = |body| {
        let index = character.bodies().iter().position(|&id| id == body).expect("a body of the wearer");
        character.def().ragdoll.bodies[index].role.as_str()
    };
    let mut roles: Vec<&str> = group.backstops().iter().map(|stop| role(stop.body)).collect();
    roles.sort_unstable();
    roles.dedup();
    assert!(roles.contains(&"leftUpperLeg") && roles.contains(&"rightUpperLeg"), "{roles:?}");
    assert!(
        roles.iter().all(|role| role.ends_with("Leg") || *role == "hips" || *role == "spine"),
        "{roles:?}"
    );
    for (stop, depth) in group.backstops().iter().zip(depths(&world, group)) {
        assert_eq!(stop.radius, 0.25);
        assert!((depth + 0.03).abs() < 1e-3, "the particle is {depth} m inside its backstop");
        let (place, center) =
            (group.positions()[stop.particle as usize], world.transform(stop.body).point(stop.center));
        let out = Vec3::new(place.x, 0.0, place.z);
        assert!((place - center).dot(out) > 0.0, "the backstop must be inside the skirt");
    }
    let of_giant = character.def().scaled(2.0);
    let giant = Character::spawn(&mut world, &Arc::new(of_giant), Transform::IDENTITY);
    let group = world.particles(giant.garments()[0]);
    assert!(group.backstops().iter().all(|stop| stop.radius == 0.5));
    let depths = depths(&world, group);
    assert!(depths.iter().all(|depth| (depth + 0.06).abs() < 2e-3), "{depths:?}");
}

/// While the wearer walks, the cloth stays out of its backstops, stretches no more than without them, and swings.
#[test]
fn backstops_do_not_disturb_a_walk() {
    for chains in [&SKIRT, &CAPE] {
        let def = worn(chains, Some(Backstop { distance: 0.02, radius: 0.2 }));
        let mut world = ground(WorldDef::default().gravity);
        let mut character = Character::spawn(&mut world, &Arc::new(def), Transform::IDENTITY);
        character.set_move(Vec3::Z * 1.3);
        let (mut depth, mut stretch): (f32, f32) = (0.0, 0.0);
        for step in 0..240 {
            go_on(&mut world, &mut character, 1);
            let group = world.particles(character.garments()[0]);
            if step > 30 {
                depth = depths(&world, group).into_iter().fold(depth, max);
                stretch = max(stretch, mean_stretch(group));
            }
        }
        assert!(depth < 0.005, "{} is {depth} m inside its backstops", chains.name);
        // The first steps are long: feet on the ground wait until the clips reach the mover's speed.
        assert!(stretch < 0.05, "the stretch of {} is {stretch}", chains.name);
    }
}
