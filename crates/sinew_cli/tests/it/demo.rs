//! `sinew demo`: complete output from a real simulation.

use crate::contract::check_keys;
use crate::sinew::{Folder, sinew};
use sinew::anim::{LocalTransform, local_to_model};
use sinew::formats::{ReadOptions, load_gltf};
use sinew::math::Vec3;
use sinew::ragdoll::{BakeInput, Baked, FallQuality, State, bake};
use sinew_scenes::cabin::{PORCH_HEIGHT, Site};
use sinew_scenes::demo::Demo;

/// Long enough to fall and come to rest, also after hanging over the railing.
const SECONDS: f32 = 9.0;

fn fall(demo: &Demo) -> Baked {
    bake(&BakeInput { seconds: SECONDS, ..demo.input() })
}

/// Checks the limits of section 4 of the specification, for a fall slower than 15 m/s.
fn check_gates(what: &str, q: &FallQuality) {
    assert_eq!(q.nan, 0, "{what}");
    let gates = [
        ("energy gain", q.energy_gain_max, 0.01),
        ("joint gap p99, m", q.joint_gap_p99_m, 1e-3),
        ("joint gap, m", q.joint_gap_max_m, 5e-3),
        ("limit overshoot p99, degrees", q.limit_overshoot_p99_deg, 2.0),
        ("limit overshoot, degrees", q.limit_overshoot_max_deg, 4.0),
        ("penetration at rest, m", q.penetration_rest_max_m, 5e-3),
    ];
    for (figure, value, limit) in gates {
        assert!(value < limit, "{what}: {figure} is {value}, limit {limit}");
    }
    assert!(q.first_contact_s.is_some() && q.settled_s.is_some(), "{what}: {q:?}");
}

/// Joint positions in the world, in a pose.
fn positions(demo: &Demo, baked: &Baked, pose: &[LocalTransform]) -> Vec<Vec3> {
    let mut model = Vec::new();
    local_to_model(&demo.character.rig, pose, &baked.world_from_model, &mut model);
    model.iter().map(|joint| joint.translation).collect()
}

/// Joint positions in the last limp frame.
fn lying(demo: &Demo, baked: &Baked) -> Vec<Vec3> {
    let limp = baked.frames.iter().rev().find(|frame| frame.state == State::Limp);
    positions(demo, baked, &limp.expect("the character goes limp").pose)
}

fn farthest_apart(a: &[Vec3], b: &[Vec3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (*a - *b).length()).fold(0.0, f32::max)
}

fn highest(points: &[Vec3]) -> f32 {
    points.iter().map(|point| point.y).fold(f32::MIN, f32::max)
}

#[test]
fn other_hits_give_other_falls_of_the_same_quality() {
    let demo = Demo::new(Site::CabinWithStairs);
    let shown = fall(&demo);
    check_gates("as shown", &shown.quality);
    let impulse = demo.hits[0].impulse;
    for (what, impulse) in [
        ("a hit 1 % harder", impulse * 1.01),
        ("a hit from the side", Vec3::new(impulse.z, impulse.y, -impulse.x)),
    ] {
        let mut other = demo.clone();
        other.hits[0].impulse = impulse;
        let baked = fall(&other);
        check_gates(what, &baked.quality);
        let apart = farthest_apart(&lying(&demo, &shown), &lying(&other, &baked));
        assert!(apart > 0.01, "{what}: the limp poses differ by only {apart} m");
    }
}

#[test]
fn demo_falls_down_the_stairs_and_flat_without_them() {
    let stairs = Demo::new(Site::CabinWithStairs);
    let baked = fall(&stairs);
    let limp = baked.frames.iter().find(|frame| frame.state == State::Limp).expect("the character goes limp");
    let drop = highest(&positions(&stairs, &baked, &limp.pose)) - highest(&lying(&stairs, &baked));
    assert!(drop > PORCH_HEIGHT, "it falls by {drop} m");

    let flat = Demo::new(Site::Flat);
    let baked = fall(&flat);
    check_gates("without stairs", &baked.quality);
    let height = highest(&lying(&flat, &baked));
    assert!(height < 0.45, "the highest joint is {height} m above the ground");
}

#[test]
fn equal_demos_give_equal_states() {
    let demo = Demo::new(Site::CabinWithStairs);
    let hash = || bake(&BakeInput { seconds: 3.0, ..demo.input() }).hash;
    assert_eq!(hash(), hash());
}

#[test]
fn demo_writes_file_picture_and_report() {
    let folder = Folder::new("demo");
    let out = folder.path("new/folder");
    let object = sinew(&["demo", "--out", &out, "--json"]).json();
    check_keys("demo", &object);
    for happened in ["first_contact_s", "settled_s", "up_s"] {
        assert!(object[happened].is_number(), "{happened}: {object:#}");
    }
    let read = |name: &str| std::fs::read(folder.path(&format!("new/folder/{name}"))).expect(name);
    let figures: serde_json::Value = serde_json::from_slice(&read("report.json")).expect("a JSON object");
    assert_eq!(figures, object);
    assert!(read("demo.gif").starts_with(b"GIF89a"));
    let document = load_gltf(folder.path("new/folder/demo.glb"), ReadOptions::default()).expect("a GLB");
    assert_eq!((document.clips.len(), document.rig.skins.len()), (1, 1));
    assert!(document.rig.meshes.iter().any(|mesh| mesh.name == "cabin"), "the file must contain the stairs");
}
