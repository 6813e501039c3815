//! The scenes have their documented sizes, and reports have all keys.

use sinew_peers::engine::{Effort, Engine};
use sinew_peers::engines;
use sinew_peers::mjcf::mjcf;
use sinew_peers::run::{Judging, Start, run};
use sinew_peers::scenes::{self, BoxPairs, ClothScene, RayScene, SCENES, Work};

fn sinew() -> &'static dyn Engine {
    engines::find("sinew").and_then(|entry| entry.engine).expect("ours is always there")
}

#[test]
fn names_are_found_once() {
    for scene in SCENES {
        let same = SCENES.iter().filter(|other| other.name == scene.name).count();
        assert_eq!(same, 1, "{}", scene.name);
        assert!(scenes::find(scene.name).is_some());
    }
    assert!(scenes::find("no such scene").is_none());
}

#[test]
fn numbers_of_bodies_and_joints_match_the_documentation() {
    let counts = |name: &str| {
        let Work::Bodies(scene) = (scenes::find(name).expect("a scene").work)() else { panic!("no bodies") };
        (scene.bodies.len(), scene.dynamic().count(), scene.joints.len())
    };
    assert_eq!(counts("ragdoll_pile"), (1_551, 1_500, 1_400));
    assert_eq!(counts("box_pyramid"), (1_241, 1_240, 0));
    assert_eq!(counts("box_rain"), (4_005, 4_000, 0));
    assert_eq!(counts("chain_100_links"), (1_020, 1_010, 1_010));
    assert_eq!(counts("large_pyramid").1, 5_050);
    assert_eq!(counts("boxes_10000").1, 10_000);
    assert_eq!(counts("crowd_pile"), (1_905, 1_900, 1_800));
}

/// Engines are compared by the same descriptions, so these must not name one engine's features.
#[test]
fn every_engine_has_our_ragdolls() {
    let crowd = scenes::find("crowd_pile").expect("a scene");
    for entry in engines::ENGINES {
        let Some(engine) = entry.engine.filter(|engine| engine.fields().contains(&crowd.field)) else {
            continue;
        };
        let report = run(engine, crowd, Start::Perturbed(1), Some(1), (Judging::Off, Effort::Default));
        assert!(report["cpu_ms"]["median"].is_number(), "{report}");
    }
}

#[test]
fn mujoco_gets_every_figure_and_wall() {
    let Work::Bodies(scene) = (scenes::find("humanoid_pile_10").expect("a scene").work)() else {
        panic!("no bodies")
    };
    let exported = mjcf(&scene);
    assert_eq!(exported["figures"].as_array().map(Vec::len), Some(10));
    assert_eq!(exported["walls"].as_array().map(Vec::len), Some(4));
    assert!(exported["friction"].as_f64().is_some_and(|friction| (friction - 0.7).abs() < 1e-6));
    let text = exported["mjcf"].as_str().expect("a model");
    assert_eq!(text.matches("<freejoint").count(), 1);
    assert_eq!(text.matches("<inertial").count(), 19);
}

#[test]
fn every_step_gets_its_rays_and_pairs() {
    let scene = RayScene::new();
    assert_eq!(scene.rays_of_step(0), 0..1_000);
    assert_eq!(scene.rays_of_step(100), 0..1_000);
    assert_eq!(scene.rays_of_step(199), 99_000..100_000);
    let pairs = BoxPairs::new(100, 25);
    assert_eq!(pairs.pairs_of_step(3), 75..100);
    assert_eq!(pairs.pairs_of_step(4), 0..25);
}

#[test]
fn the_cloth_is_a_square_of_four_metres() {
    let scene = ClothScene::new();
    assert_eq!(scene.structural_links().len(), 2 * 99 * 100);
    let far = scene.position(99, 99);
    assert!((far.x - 1.98).abs() < 1e-4 && (far.z - 1.98).abs() < 1e-4);
    for i in scene.pinned() {
        assert!((scene.position(i / scene.side, i % scene.side).z + 1.98).abs() < 1e-4);
    }
}

#[test]
fn unsupported_scenes_are_reported() {
    let cloth = scenes::find("cloth").expect("a scene");
    let report = run(sinew(), cloth, Start::Own, Some(1), (Judging::Off, Effort::Default));
    assert_eq!(report["scene"], "cloth");
    assert!(report["unsupported"].as_str().is_some_and(|why| !why.is_empty()));
    assert!(report.get("cpu_ms").is_none());
}

#[test]
fn report_has_all_keys() {
    let chain = scenes::find("chain_hang_100").expect("a scene");
    let report = run(sinew(), chain, Start::Own, Some(12), (Judging::On, Effort::Default));
    assert_eq!((&report["engine"], &report["steps"]), (&"sinew".into(), &12.into()));
    assert_eq!((&report["bodies"], &report["joints"]), (&12.into(), &11.into()));
    for key in ["median", "p99", "mean", "last_third", "best"] {
        assert!(report["cpu_ms"][key].as_f64().is_some_and(|ms| ms >= 0.0), "{key}");
    }
    for key in ["version", "flags", "settings"] {
        assert!(report[key].as_str().is_some_and(|text| !text.is_empty()), "{key}");
    }
    assert!(report["quality"]["joint_gap_peak_m"].as_f64().is_some_and(|gap| gap < 1e-3));
    assert!(report["quality"]["stretch_end"].is_number());
    let without = run(sinew(), chain, Start::Own, Some(2), (Judging::Off, Effort::Default));
    assert!(without.get("quality").is_none());
}
