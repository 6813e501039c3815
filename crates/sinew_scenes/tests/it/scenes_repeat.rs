//! Every scene gives the same bits on any number of threads, from snapshots and at any frame rate; settings are
//! checked.

use core::num::NonZero;
use core::sync::atomic::{AtomicUsize, Ordering};
use core::time::Duration;
use sinew::math::{Random, Reader, Transform, Writer};
use sinew::physics::stage::NoProfiler;
use sinew::physics::{Threads, World, WorldDef};
use sinew_scenes::scenes::{Instance, Scene, SettingError, find, registry};
use std::thread::{self, available_parallelism};

/// Returns the number of steps in which all bodies fall, hit and come to rest; fewer for scenes that are slow in
/// debug builds.
fn steps(scene: &Scene) -> u64 {
    match scene.name {
        "ragdoll_pile" => 4,
        "chain_100_links" | "net" => 6,
        _ => u64::min(u64::from(scene.steps), 180),
    }
}

fn started(scene: &Scene) -> Instance {
    let mut settings = scene.settings();
    if scene.name == "joint_grid" {
        settings.assign("side=6").expect("the scene has the setting");
    }
    scene.start(&settings)
}

fn poses(world: &World) -> Vec<Transform> {
    world.body_ids().map(|id| world.transform(id)).collect()
}

/// Calls `check` with every scene, on all cores.
fn with_every_scene(check: impl Fn(&Scene) + Sync) {
    let next = AtomicUsize::new(0);
    let worker = || {
        while let Some(scene) = registry().get(next.fetch_add(1, Ordering::Relaxed)) {
            check(scene);
        }
    };
    let workers = available_parallelism().map_or(1, NonZero::get);
    thread::scope(|scope| (0..workers).for_each(|_| _ = scope.spawn(worker)));
}

/// Hashes after each step of a run, and the poses after the step in which the frame rates are compared.
struct Reference {
    hashes: Vec<u64>,
    poses: Vec<Transform>,
}

#[test]
fn bits_are_equal_in_every_way_of_running() {
    with_every_scene(|scene| {
        // The first second; in full runs all steps.
        let full = std::env::var_os("SINEW_FULL").is_some();
        let of_frames = if full { steps(scene) } else { u64::min(steps(scene), 60) };
        let middle = steps(scene).div_ceil(20);
        let (mut run, mut saved) = (started(scene), Writer::new());
        let mut reference = Reference { hashes: Vec::new(), poses: Vec::new() };
        for step in 1..=steps(scene) {
            run.step();
            reference.hashes.push(run.world().hash());
            if step == middle {
                run.save(&mut saved);
            }
            if step == of_frames {
                reference.poses = poses(run.world());
            }
        }
        repeats_with_threads(scene, &reference);
        continues_from_a_snapshot(scene, &reference, (middle, saved.as_bytes()));
        repeats_at_any_frame_rate(scene, &reference, of_frames);
    });
}

fn repeats_with_threads(scene: &Scene, reference: &Reference) {
    let mut run = started(scene);
    for (step, &hash) in reference.hashes.iter().enumerate() {
        run.step_with(&Threads::new(2), &NoProfiler);
        assert_eq!(run.world().hash(), hash, "{} with 2 threads, step {step}", scene.name);
    }
}

fn continues_from_a_snapshot(scene: &Scene, reference: &Reference, (middle, saved): (u64, &[u8])) {
    let mut run = started(scene);
    run.load(&mut Reader::new(saved)).expect("the saved state must load");
    for (step, &hash) in reference.hashes.iter().enumerate().skip(middle as usize) {
        run.step();
        assert_eq!(run.world().hash(), hash, "{} restored, step {step}", scene.name);
    }
}

fn repeats_at_any_frame_rate(scene: &Scene, reference: &Reference, steps: u64) {
    for rate in [24, 60, 144] {
        let mut run = started(scene);
        let step = run.world().def().step_nanoseconds;
        // The last frame is as long as needed for the same number of steps.
        let mut left = steps * step;
        while left > 0 {
            let frame = u64::min(1_000_000_000 / rate, left);
            run.update(Duration::from_nanos(frame));
            left -= frame;
        }
        assert_eq!(run.world().step_count(), steps);
        let same = poses(run.world()) == reference.poses;
        assert!(same, "{}: the poses differ at {rate} frames per second", scene.name);
    }
}

/// Saved at a random step, every scene continues equally in a new world and on two threads. Scenes with their own
/// functions or objects are left out, because a new world does not have them.
#[test]
fn snapshot_loaded_into_an_unrelated_world_continues_equally() {
    let mut met = 0;
    for (number, scene) in registry().iter().enumerate() {
        let mut run = started(scene);
        let middle = Random::new(number as u64).index(steps(scene) as usize) as u64;
        (0..middle).for_each(|_| run.step());
        let (mut saved, mut shapes) = (Writer::new(), Writer::new());
        run.save(&mut saved);
        run.world().save_shapes(&mut shapes);
        let mut stranger = started(scene);
        let mut world = World::new(WorldDef::default());
        world.load_shapes(&mut Reader::new(shapes.as_bytes())).expect("the saved shape library must load");
        *stranger.world_mut() = world;
        if stranger.load(&mut Reader::new(saved.as_bytes())).is_err() {
            continue;
        }
        met += 1;
        for step in middle..u64::min(steps(scene), middle + 60) {
            run.step();
            stranger.step_with(&Threads::new(2), &NoProfiler);
            assert_eq!(stranger.world().hash(), run.world().hash(), "{}, step {step}", scene.name);
        }
    }
    assert!(met * 10 > registry().len() * 9, "only {met} of {} scenes can be loaded", registry().len());
}

/// A brawl saved at any step, with characters in every state, continues in a new world as in its own.
#[test]
fn saved_brawl_continues_in_an_unrelated_world() {
    let scene = find("brawl").expect("the scene is registered");
    for powered in 0..2 {
        let mut settings = scene.settings();
        settings.assign("hits=12").expect("the value is in range");
        settings.assign(&format!("powered={powered}")).expect("the value is in range");
        let mut run = scene.start(&settings);
        for round in 0..3 {
            (0..150).for_each(|_| run.step());
            let (mut saved, mut shapes) = (Writer::new(), Writer::new());
            run.save(&mut saved);
            run.world().save_shapes(&mut shapes);
            let mut stranger = scene.start(&settings);
            let mut world = World::new(WorldDef::default());
            world
                .load_shapes(&mut Reader::new(shapes.as_bytes()))
                .expect("the saved shape library must load");
            *stranger.world_mut() = world;
            stranger.load(&mut Reader::new(saved.as_bytes())).expect("the saved state must load");
            for step in 0..60 {
                run.step();
                stranger.step_with(&Threads::new(2), &NoProfiler);
                let [mut own, mut other] = [Writer::new(), Writer::new()];
                run.save(&mut own);
                stranger.save(&mut other);
                assert!(
                    own.as_bytes() == other.as_bytes(),
                    "the bytes differ: powered {powered}, round {round}, step {step}"
                );
            }
        }
    }
}

#[test]
fn settings_are_checked() {
    let scene = find("mass_ratio").expect("the scene is registered");
    let mut settings = scene.settings();
    settings.assign("links=3").expect("the value is in range");
    // The scene has two trees, one of which hangs on a hook.
    assert_eq!(scene.start(&settings).world().joint_ids().count(), 2 + 3);
    assert_eq!(scene.start(&scene.settings()).world().joint_ids().count(), 39 + 40);

    let mut refused = |assignment: &str| {
        settings.assign(assignment).expect_err("the assignment must be refused").to_string()
    };
    assert_eq!(refused("links"), "`links` is not key=value");
    assert_eq!(refused("lnks=3"), "no setting `lnks`; there is ratio, links");
    let domain = "it takes a whole number from 2 to 200";
    for value in ["1", "201", "2.5", "", "many"] {
        assert_eq!(refused(&format!("links={value}")), format!("`links` does not allow `{value}`: {domain}"));
    }
    for value in ["NaN", "inf", "0.5", "1e9"] {
        assert!(refused(&format!("ratio={value}")).contains("a number from 1 to 1000000"), "{value}");
    }
    assert_eq!(settings.get("links"), 3.0);
    let none = find("free_fall").expect("the scene is registered").settings().assign("x=1");
    assert_eq!(none, Err(SettingError::UnknownKey { key: "x".into(), known: vec![] }));
}

#[test]
fn scene_and_setting_names_need_no_quotes_on_a_command_line() {
    for scene in registry() {
        let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
        let plain = |name: &str| name.chars().all(fits);
        assert!(plain(scene.name) && !scene.about.is_empty());
        for setting in scene.settings().declared() {
            assert!(plain(setting.key), "{}", setting.key);
            let default = format!("{}={}", setting.key, setting.default);
            scene.settings().assign(&default).expect("a default must be in its own range");
        }
    }
}
