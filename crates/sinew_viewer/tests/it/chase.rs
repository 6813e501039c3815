//! The camera follows a subject, which stays in the picture for every aspect ratio and every motion of the subject.

use sinew::math::Vec3;
use sinew_scenes::recording::Operation;
use sinew_scenes::staged::{Sample, staged};
use sinew_viewer::{Chase, Orbit, bounds};

/// Pictures of a phone, a tablet, a window and a wide screen: width over height.
const ASPECTS: [f32; 4] = [0.8, 1.1, 1.5, 2.6];
/// Time of the run: the walk, the fall, the get-up, and the second start.
const STEPS: u32 = 60 * 25;
/// Frames a second of a slow machine: two steps a frame.
const FRAME: f32 = 1.0 / 30.0;
/// Least distance of the subject's centre from the edges, as a share of the picture.
const EDGE: f32 = 0.12;

/// Returns the position of a point in the picture, 0 to 1 from the upper left corner.
fn place(orbit: &Orbit, point: Vec3, aspect: f32) -> [f32; 2] {
    let camera = orbit.camera();
    let axes = camera.axes(aspect);
    let way = point - camera.position;
    let depth = way.dot(axes.forward);
    [
        0.5 + 0.5 * way.dot(axes.right) / (depth * axes.half_width),
        0.5 - 0.5 * way.dot(axes.up) / (depth * axes.half_height),
    ]
}

/// Returns the largest distance of the subject from the centre of a picture, as a share of the picture, for every
/// aspect, with a camera that follows or stands.
fn outermost(sample: Sample, follows: bool, pushes: bool) -> [f32; 4] {
    let mut stage = staged(sample.character());
    let first = bounds(&stage);
    let direction = stage.camera_hint().direction;
    let mut cameras =
        ASPECTS.map(|aspect| (Orbit::framing(&first, direction, aspect), Chase::at(first.center())));
    let mut most = [0.0_f32; 4];
    for step in 0..STEPS {
        if pushes && step % 200 == 150 {
            let body = stage.bodies_of_figures()[0];
            let impulse = Vec3::new(if step % 400 == 150 { 150.0 } else { -150.0 }, 0.0, 60.0);
            Operation::Push { body, impulse, point: Vec3::ZERO }.apply_to(&mut stage);
        }
        stage.step();
        if step % 2 != 0 {
            continue; // no frame
        }
        let subject = bounds(&stage).center();
        for (k, (orbit, chase)) in cameras.iter_mut().enumerate() {
            if follows {
                orbit.target += chase.go(subject, FRAME, orbit.distance);
                orbit.rise_above(stage.world());
                let camera = orbit.camera().position;
                assert!(camera.y > 0.0, "the camera is at {camera:?} after {step} steps");
            }
            let [x, y] = place(orbit, subject, ASPECTS[k]);
            most[k] = most[k].max((x - 0.5).abs()).max((y - 0.5).abs());
        }
    }
    most
}

#[test]
fn following_camera_keeps_the_subject_in_the_picture() {
    let pushed = (Sample::Mannequin, true);
    for (sample, pushes) in Sample::ALL.into_iter().map(|sample| (sample, false)).chain([pushed]) {
        let most = outermost(sample, true, pushes);
        println!("{}, pushed {pushes}: {most:.3?}", sample.name());
        let is_inside = most.iter().all(|&most| most < 0.5 - EDGE);
        assert!(
            is_inside,
            "{}, pushed {pushes}, aspects {ASPECTS:?}: {most:?} from the centre",
            sample.name()
        );
    }
}

/// The test above can fail: a camera that does not move loses the subject.
#[test]
fn fixed_camera_loses_the_subject() {
    let most = outermost(Sample::Mannequin, false, false);
    assert!(most[2] > 0.6, "{most:?}");
}
