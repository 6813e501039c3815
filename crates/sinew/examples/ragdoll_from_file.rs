//! A ragdoll: `cargo run -p sinew --example ragdoll_from_file -- character.glb`.
//!
//! A rigged file becomes bodies and joints, falls, and returns the pose for a renderer. Without a file, the
//! built-in mannequin is used.

use sinew::prelude::*;

fn rig() -> Result<Rig, Box<dyn std::error::Error>> {
    match std::env::args().nth(1).filter(|path| path.ends_with(".glb") || path.ends_with(".gltf")) {
        Some(path) => Ok(sinew::load(path)?.rig),
        None => Ok(sinew::mannequin::mannequin().rig),
    }
}

/// Builds a ragdoll and drops it.
pub fn main() {
    let rig = rig().expect("the file can be read");
    let analysis = analyze(&rig).expect("the rig has a skin");
    let (def, _) = build(&rig, &analysis, &BuildOptions::default()).expect("the rig has limbs");
    println!("{} bodies, {:.0} kg, {:.2} m tall", def.bodies.len(), def.total_mass, def.height);
    def.bodies
        .iter()
        .for_each(|body| println!("  {} of {:.1} kg: {:?}", body.role, body.mass.mass, body.shape));

    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let lifted = Transform::from_translation(Vec3::Y * 0.5);
    let start = |body: &sinew::ragdoll::RagdollBodyDef| BodyState {
        world_from_body: lifted * body.character_from_body,
        velocity: Velocity { linear: Vec3::X, angular: Vec3::ZERO },
    };
    let states: Vec<BodyState> = def.bodies.iter().map(start).collect();
    let ragdoll = Ragdoll::spawn(&mut world, &def, &states, &BodySettings::default());
    let top =
        |world: &World| ragdoll.bodies.iter().fold(0.0, |top, &id| f32::max(top, world.bounds(id).max.y));
    let before = top(&world);
    (0..300).for_each(|_| world.step());
    println!("it fell from {before:.2} m to {:.2} m", top(&world));
    assert!(top(&world) < 0.5 * before, "the ragdoll lies on the ground");
    let gap = ragdoll.joints.iter().fold(0.0, |most, &id| f32::max(most, world.joint_gap(id)));
    assert!(gap < 1e-3, "the joints hold: gap {gap} m");
}
