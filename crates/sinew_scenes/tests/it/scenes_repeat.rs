//! Every scene gives the same bits in every way of running it; its settings are checked.

use core::time::Duration;
use sinew::math::{Random, Reader, Transform, Writer};
use sinew::physics::stage::NoProfiler;
use sinew::physics::{Threads, World, WorldDef};
use sinew_scenes::scenes::{Instance, Scene, SettingError, find, registry};

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
        settings.assign("side=6").expect("it has that setting");
    }
    scene.start(&settings)
}

/// The first second; in full runs all of [`steps`].
fn first_steps(scene: &Scene) -> u64 {
    if std::env::var_os("SINEW_FULL").is_some() { steps(scene) } else { u64::min(steps(scene), 60) }
}

fn stepped(scene: &Scene, steps: u64) -> Instance {
    let mut run = started(scene);
    for _ in 0..steps {
        run.step();
    }
    run
}

fn poses(world: &World) -> Vec<Transform> {
    world.body_ids().map(|id| world.transform(id)).collect()
}

#[test]
fn bits_repeat_on_a_second_run_and_with_threads() {
    for scene in registry() {
        let hash = stepped(scene, steps(scene)).world().hash();
        assert_eq!(stepped(scene, steps(scene)).world().hash(), hash, "{} again", scene.name);
        let mut threaded = started(scene);
        for _ in 0..steps(scene) {
            threaded.step_with(&Threads::new(2), &NoProfiler);
        }
        assert_eq!(threaded.world().hash(), hash, "{} with 2 threads", scene.name);
    }
}

#[test]
fn bits_are_equal_at_any_frame_rate() {
    for scene in registry() {
        let steps = first_steps(scene);
        let expected = poses(stepped(scene, steps).world());
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
            assert!(poses(run.world()) == expected, "{}: other poses at {rate} frames a second", scene.name);
        }
    }
}

#[test]
fn restored_run_continues_equally() {
    for scene in registry() {
        let mut run = started(scene);
        let (middle, end) = (steps(scene).div_ceil(20), steps(scene));
        for _ in 0..middle {
            run.step();
        }
        let mut saved = Writer::new();
        run.save(&mut saved);
        let mut restored = started(scene);
        restored.load(&mut Reader::new(saved.as_bytes())).expect("it was just saved");
        for step in middle..end {
            run.step();
            restored.step();
            assert_eq!(restored.world().hash(), run.world().hash(), "{}, step {step}", scene.name);
        }
    }
}

/// Like [`restored_run_continues_equally`], in a new world and on two threads. Scenes with their own functions or
/// objects are left out, because a new world does not have them.
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
        world.load_shapes(&mut Reader::new(shapes.as_bytes())).expect("they were just saved");
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
    let scene = find("brawl").expect("the registry has it");
    for powered in 0..2 {
        let mut settings = scene.settings();
        settings.assign("hits=12").expect("it is in range");
        settings.assign(&format!("powered={powered}")).expect("it is in range");
        let mut run = scene.start(&settings);
        for round in 0..3 {
            (0..150).for_each(|_| run.step());
            let (mut saved, mut shapes) = (Writer::new(), Writer::new());
            run.save(&mut saved);
            run.world().save_shapes(&mut shapes);
            let mut stranger = scene.start(&settings);
            let mut world = World::new(WorldDef::default());
            world.load_shapes(&mut Reader::new(shapes.as_bytes())).expect("they were just saved");
            *stranger.world_mut() = world;
            stranger.load(&mut Reader::new(saved.as_bytes())).expect("it was just saved");
            for step in 0..60 {
                run.step();
                stranger.step_with(&Threads::new(2), &NoProfiler);
                let [mut own, mut other] = [Writer::new(), Writer::new()];
                run.save(&mut own);
                stranger.save(&mut other);
                assert!(
                    own.as_bytes() == other.as_bytes(),
                    "other bytes: powered {powered}, round {round}, step {step}"
                );
            }
        }
    }
}

#[test]
fn settings_are_checked() {
    let scene = find("mass_ratio").expect("the registry has it");
    let mut settings = scene.settings();
    settings.assign("links=3").expect("a whole number in range");
    // The scene has two trees, one of which hangs on a hook.
    assert_eq!(scene.start(&settings).world().joint_ids().count(), 2 + 3);
    assert_eq!(scene.start(&scene.settings()).world().joint_ids().count(), 39 + 40);

    let mut refused = |assignment: &str| settings.assign(assignment).expect_err("invalid").to_string();
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
    let none = find("free_fall").expect("the registry has it").settings().assign("x=1");
    assert_eq!(none, Err(SettingError::UnknownKey { key: "x".into(), known: vec![] }));
}

#[test]
fn names_and_settings_are_valid_on_a_command_line() {
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
