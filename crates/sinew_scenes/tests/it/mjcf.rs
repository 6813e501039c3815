//! MuJoCo's humanoid.

use needs_data::needs_data;
use sinew_scenes::scenes::{Metric, SettingError, find, registry};

const HUMANOID: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/robots/mujoco_humanoid.xml");

fn unmet(pose: u32, gravity_factor: f32) -> Vec<Metric> {
    let scene = find("mjcf_drop").expect("the scene is registered");
    let mut settings = scene.settings();
    settings.assign(&format!("file={HUMANOID}")).expect("the humanoid can be read");
    settings.assign(&format!("pose={pose}")).expect("the pose exists");
    let mut run = scene.start_under(&settings, gravity_factor);
    for _ in 0..scene.steps {
        run.step();
    }
    let mut metrics = run.metrics();
    for metric in &metrics {
        println!("pose {pose}: {} = {:?}, {:?}", metric.name, metric.value, metric.expected);
    }
    metrics.retain(|metric| !metric.is_met());
    metrics
}

#[needs_data]
#[test]
fn mujocos_humanoid_rests_as_high_as_in_mujoco() {
    for pose in 0..=2 {
        assert_eq!(unmet(pose, 1.0), []);
    }
    for factor in [0.99, 1.01] {
        assert!(!unmet(1, factor).is_empty(), "no metric misses its limit at {factor} g");
    }
}

#[test]
fn the_mjcf_scene_needs_its_file_and_is_unlisted() {
    let scene = find("mjcf_drop").expect("the scene is registered");
    assert!(registry().iter().all(|listed| listed.name != scene.name));
    let mut settings = scene.settings();
    let missing = settings.check().expect_err("the scene must require its file");
    assert_eq!(missing.to_string(), "`file` is not set: it takes the path of a model in MJCF");
    let absent = settings.assign("file=no/such.xml").expect_err("a missing file must be refused");
    assert!(matches!(absent, SettingError::File(_)) && absent.to_string() == "no/such.xml: no such folder");
    assert_eq!(find("pendulum").expect("the scene is registered").settings().check(), Ok(()));
}
