//! Scenes as plain data: bodies and joints agree with their descriptions' counts, and joints fit.

use sinew_scenes::blueprint::{self, Blueprint};

fn check(scene: &Blueprint, bodies: usize, dynamic: usize, joints: usize) {
    let (world, body_ids, joint_ids) = scene.build();
    let name = scene.name;
    assert_eq!(
        (body_ids.len(), scene.dynamic().count(), joint_ids.len()),
        (bodies, dynamic, joints),
        "{name}"
    );
    for (def, &id) in scene.bodies.iter().zip(&body_ids) {
        assert!((world.transform(id).translation - def.position).length() < 1e-5, "{name}");
    }
    for &joint in &joint_ids {
        // The tolerance is a few units in the last place of a position 100 m from the origin.
        assert!(world.joint_gap(joint) < 5e-5, "{name}: a gap of {} m", world.joint_gap(joint));
        assert!(world.joint_overshoot(joint) < 1e-3, "{name}");
    }
}

#[test]
fn blueprints_have_their_described_sizes() {
    check(&blueprint::ragdoll_pile(), 1551, 1500, 1400);
    check(&blueprint::rain(), 1 + 100 + 300 * 15, 300 * 15, 300 * 14);
    check(&blueprint::ragdolls(), 1 + 4 + 8 * 15, 8 * 15, 8 * 14);
    check(&blueprint::wave_pile(), 101, 100, 0);
    check(&blueprint::mesh_drop(), 401, 400, 0);
    check(&blueprint::rocks(), 65, 64, 0);
    check(&blueprint::arch(15, 4), 2 + 15 + 4, 15 + 4, 0);
    check(&blueprint::crowd_pile(), 5 + 1900, 1900, 1800);
    check(&blueprint::humanoid_pile(10), 5 + 190, 190, 180);
    check(&blueprint::humanoid_lying(), 1 + 19, 19, 18);
    check(&blueprint::ragdoll_column(6), 1 + 90, 90, 84);
    check(&blueprint::ragdoll_on_boxes(5), 1 + 55 + 15, 55 + 15, 14);
    check(&blueprint::boxes_10000(), 10_005, 10_000, 0);
    check(&blueprint::box_pyramid(), 1241, 1240, 0);
    check(&blueprint::box_rain(), 4005, 4000, 0);
    check(&blueprint::large_pyramid(), 5051, 5050, 0);
    check(&blueprint::stack_mass_ratio(10, 10.0), 11, 10, 0);
    check(&blueprint::stack_ratio(6), 7, 6, 0);
    check(&blueprint::jenga(18), 55, 54, 0);
    check(&blueprint::cards(3), 1 + 15, 15, 0);
    check(&blueprint::cards(5), 1 + 40, 40, 0);
    check(&blueprint::chain_100_links(), 10 * 102, 10 * 101, 10 * 101);
    check(&blueprint::chain_swing(1000.0, 0.25), 12, 11, 11);
    check(&blueprint::chain_hang(100.0), 12, 11, 11);
    check(&blueprint::heavy_rope(), 20, 19, 19);
    check(&blueprint::hanging_rope(), 50, 49, 49);
    check(&blueprint::net(), 64 + 112 + 1, 62 + 112 + 1, 225);
    check(&blueprint::joint_grid_of(30), 900, 870, 1740 - 29);
    let full = blueprint::joint_grid();
    assert_eq!((full.bodies.len(), full.dynamic().count(), full.joints.len()), (10_000, 9_900, 19_800 - 99));
}

/// Returns the largest initial depth of a moving body in a fixed one or in a moving one at least `stride` indices away,
/// metres.
fn overlap(scene: &Blueprint, stride: usize) -> f32 {
    /// Distance of their centres above which two bodies do not touch, metres.
    const NEAR: f32 = 1.1;
    let (world, bodies, _) = scene.build();
    let far = |a: usize, b: usize| {
        let moves = scene.bodies[a].kind == scene.bodies[b].kind;
        let apart = (scene.bodies[a].position - scene.bodies[b].position).length();
        moves && (a.abs_diff(b) < stride || apart > NEAR)
    };
    let mut deepest = 0.0;
    for a in scene.dynamic() {
        for b in (0..scene.bodies.len()).filter(|&b| b < a && !far(a, b)) {
            deepest = f32::max(deepest, world.overlap(bodies[a], bodies[b]));
        }
    }
    deepest
}

#[test]
fn figures_and_boxes_of_heaps_start_apart() {
    // Bodies of one humanoid follow each other, and may overlap where the definition disables the pair.
    let heaps = [(blueprint::humanoid_lying(), 19), (blueprint::humanoid_pile(33), 19)];
    for (scene, stride) in heaps.into_iter().chain([(blueprint::box_heap(6, 6), 1)]) {
        let overlap = overlap(&scene, stride);
        assert!(overlap < 1e-3, "{}: bodies overlap by {overlap} m at the start", scene.name);
    }
}

#[test]
fn perturbed_start_differs_slightly_and_joints_fit() {
    let scene = blueprint::humanoid_pile(10);
    let moved = scene.clone().perturbed(3, 1e-4);
    let apart = |place: usize| (scene.bodies[place].position - moved.bodies[place].position).length();
    assert!(scene.dynamic().all(|place| apart(place) > 0.0 && apart(place) < 2e-4));
    assert!((0..5).all(|place| apart(place) == 0.0), "walls must not be displaced");
    check(&moved, 195, 190, 180);
    let again = scene.clone().perturbed(3, 1e-4);
    assert_eq!(moved.build().0.hash(), again.build().0.hash());
    assert_ne!(moved.build().0.hash(), scene.clone().perturbed(4, 1e-4).build().0.hash());
}

fn mass_ratio(scene: &Blueprint) -> f32 {
    let (world, bodies, _) = scene.build();
    let masses: Vec<f32> = scene.dynamic().map(|place| world.mass(bodies[place]).mass).collect();
    masses[masses.len() - 1] / masses[0]
}

#[test]
fn masses_match_the_descriptions() {
    assert_eq!(mass_ratio(&blueprint::stack_mass_ratio(4, 10.0)), 1000.0);
    assert_eq!(mass_ratio(&blueprint::stack_ratio(6)), 32768.0);
    assert_eq!(mass_ratio(&blueprint::heavy_rope()), 1800.0);
    assert_eq!(mass_ratio(&blueprint::hanging_rope()), 200.0);
    assert_eq!(mass_ratio(&blueprint::chain_swing(1000.0, 0.5)), 1000.0);
}
