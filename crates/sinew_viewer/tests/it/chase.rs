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

/// Returns the largest distance of the subject from the centre of a picture, as a share of the picture, with a camera
/// that follows or stands.
fn outermost(sample: Sample, aspect: f32, follows: bool, pushes: bool) -> f32 {
    let mut stage = staged(sample.character());
    let first = bounds(&stage);
    let mut orbit = Orbit::framing(&first, stage.camera_hint().direction, aspect);
    let mut chase = Chase::at(first.center());
    let mut most: f32 = 0.0;
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
        if follows {
            orbit.target += chase.go(subject, FRAME, orbit.distance);
            orbit.rise_above(stage.world());
            let camera = orbit.camera().position;
            assert!(camera.y > 0.0, "the camera is at {camera:?} after {step} steps");
        }
        let [x, y] = place(&orbit, subject, aspect);
        most = most.max((x - 0.5).abs()).max((y - 0.5).abs());
    }
    most
}

#[test]
fn following_camera_keeps_the_subject_in_the_picture() {
    for aspect in ASPECTS {
        for sample in Sample::ALL {
            let most = outermost(sample, aspect, true, false);
            println!("{} {aspect}: {most:.3}", sample.name());
            assert!(most < 0.5 - EDGE, "{} {aspect}: {most}", sample.name());
        }
        let most = outermost(Sample::Mannequin, aspect, true, true);
        println!("pushed {aspect}: {most:.3}");
        assert!(most < 0.5 - EDGE, "aspect {aspect}: the figure is {most} from the centre");
    }
}

/// The test above can fail: a camera that does not move loses the subject.
#[test]
fn fixed_camera_loses_the_subject() {
    assert!(outermost(Sample::Mannequin, 1.5, false, false) > 0.6);
}
