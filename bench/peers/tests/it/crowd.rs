//! Characters that blend two clips, on every engine of this build with clips.

use crate::engines::engines_of;
use sinew_peers::quality::CrowdMeter;
use sinew_peers::scenes::Field;
use sinew_scenes::crowd::CrowdScene;

#[test]
fn poses_match_the_raw_clips() {
    let scene = CrowdScene::new(3);
    for engine in engines_of(Field::Animation) {
        let name = engine.describe().name;
        let mut crowd = engine.build_crowd(&scene).expect("an animation engine can play clips");
        let mut meter = CrowdMeter::new(&scene);
        // More than one whole loop.
        for step in 0..130 {
            crowd.step(step);
            for character in 0..3 {
                meter.observe(character, step, &crowd.pose(character, step));
            }
        }
        let quality = meter.finish();
        assert!(quality.rotation_error_max < 3e-4, "{name}: {quality:?}");
        assert!(quality.model_error_max < 1e-3, "{name}: {quality:?}");
        assert!(quality.rotation_error_max > 0.0, "{name}: 48-bit keys must show a quantization error");
    }
}

#[test]
fn wrong_pose_is_detected() {
    let scene = CrowdScene::new(1);
    for engine in engines_of(Field::Animation) {
        let name = engine.describe().name;
        let mut crowd = engine.build_crowd(&scene).expect("an animation engine can play clips");
        crowd.step(0);
        let mut pose = crowd.pose(0, 0);
        pose.places[7].y += 0.01;
        pose.sampled[1][3] = pose.sampled[1][4];
        let mut meter = CrowdMeter::new(&scene);
        meter.observe(0, 0, &pose);
        let quality = meter.finish();
        assert!((quality.model_error_max - 0.01).abs() < 1e-3, "{name}: {quality:?}");
        assert!(quality.rotation_error_max > 0.01, "{name}: {quality:?}");
    }
}
