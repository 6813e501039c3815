//! A captured walk on several bodies.

use needs_data::needs_data;
use sinew_scenes::scenes::{SettingError, find};

const WALK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/mocap/cmu_12_01_walk.bvh");

#[needs_data]
#[test]
fn captured_walk_fits_three_bodies() {
    let scene = find("mocap").expect("the scene is registered");
    let mut settings = scene.settings();
    settings.assign(&format!("motion={WALK}")).expect("the walk can be read");
    assert_eq!(settings.check(), Ok(()));
    let mut run = scene.start(&settings);
    for _ in 0..60 {
        run.step();
    }
    assert_eq!(run.figures().len(), 3);
    for metric in run.metrics() {
        println!("{} = {:?}, {:?}", metric.name, metric.value, metric.expected);
        assert!(metric.is_met(), "{metric:?}");
    }
}

#[test]
fn files_without_motion_are_refused() {
    let scene = find("mocap").expect("the scene is registered");
    let mut settings = scene.settings();
    let missing = settings.check().expect_err("the scene must require its file");
    assert_eq!(missing.to_string(), "`motion` is not set: it takes the path of a captured motion, a BVH");
    let absent = settings.assign("motion=no/such.bvh").expect_err("a missing file must be refused");
    assert!(matches!(absent, SettingError::File(_)) && absent.to_string() == "no/such.bvh: no such folder");
    let other = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");
    let refused = settings
        .assign(&format!("motion={other}"))
        .expect_err("a file that is no BVH must be refused")
        .to_string();
    assert!(refused.starts_with(other), "{refused}");
}
