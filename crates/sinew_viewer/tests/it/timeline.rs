//! Recordings on a timeline: seeking back and forth gives the same bits; a second run beside the first.

use crate::hands::{settled, viewer};
use crate::pictures::look;
use egui::Key;
use sinew::math::Vec3;
use sinew_scenes::recording::{Difference, Operation, Recorder, Recording};
use sinew_viewer::{Session, Subject};
use std::time::{Duration, Instant};

const SIZE: [u32; 2] = [1280, 760];

/// Returns a recording of a scene; a body is struck before a step, if one is given.
pub fn recorded(scene: &str, steps: u64, strike: Option<u64>) -> Recording {
    let mut recorder = Recorder::start(scene, &[]).expect("the scene exists");
    for step in 0..steps {
        if strike == Some(step) {
            let world = recorder.instance().world();
            // In scenes with only particles no body is struck.
            if let Some(body) = world.body_ids().filter(|&id| world.mass(id).mass > 0.0).last() {
                let (point, mass) = (world.center_of_mass(body), world.mass(body).mass);
                recorder.apply(Operation::Push { body, impulse: Vec3::new(1.5, 0.5, 0.0) * mass, point });
            }
        }
        recorder.step();
    }
    recorder.finish()
}

fn played(recording: &Recording) -> Subject {
    Subject::Recording("run.sinewrec".into(), Box::new(recording.clone()))
}

/// Seeks to a step, however long it takes.
fn seek(session: &mut Session, step: u64) {
    while !session.seek(step, Instant::now() + Duration::from_secs(1)) {}
}

/// Scenes of bodies, joints, particles, and characters: after any seek the state is that
/// of the recording, and so are the metrics.
#[test]
fn seeking_gives_the_same_bits() {
    for scene in ["stack", "pendulum", "rope_on_box", "stairs", "two_tracks", "flag", "dominoes"] {
        let recording = recorded(scene, 130, Some(40));
        let mut session = Session::start(played(&recording)).expect("the recording can be opened");
        let mut figures = vec![session.metrics()];
        while session.step() {
            figures.push(session.metrics());
        }
        assert_eq!(session.diverged(), None, "{scene}");
        assert_eq!(session.world().step_count(), 130, "{scene}");
        for step in [90, 30, 31, 0, 64, 61, 130, 59, 1] {
            seek(&mut session, step);
            let world = session.world();
            assert_eq!(world.step_count(), step, "{scene}");
            if step > 0 {
                assert_eq!(world.hash(), recording.steps[step as usize - 1].hash, "{scene}, step {step}");
            }
            assert_eq!(session.metrics(), figures[step as usize], "{scene}, step {step}");
            assert_eq!(session.past_metrics().len() as u64, step + 1, "{scene}");
        }
        // From the new step the replay continues as recorded.
        while session.step() {}
        assert_eq!(session.diverged(), None, "{scene}");
        assert_eq!(session.world().hash(), recording.steps[129].hash, "{scene}");
    }
}

#[test]
fn second_run_is_drawn_as_a_ghost() {
    let (plain, struck) = (recorded("stack", 100, None), recorded("stack", 100, Some(30)));
    let mut session = Session::start(played(&plain)).expect("the recording can be opened");
    session.set_ghost("struck.sinewrec", struck).expect("both recordings are of the same scene");
    let ghost = session.ghost().expect("the session has a ghost");
    let Some(Difference::State { step, body: Some((_, [a, b])) }) = ghost.difference().cloned() else {
        panic!("{:?}", ghost.difference())
    };
    assert_eq!(step, 31, "the impulse must act in the step after it");
    assert_ne!(a, b);
    for step in [100, 20, 30, 31] {
        seek(&mut session, step);
        let ghost = session.ghost().expect("the session has a ghost").world();
        assert_eq!(ghost.step_count(), step);
        assert_eq!(ghost.hash() == session.world().hash(), step < 31, "step {step}");
    }
    let other = recorded("pendulum", 10, None);
    let error = session.set_ghost("other.sinewrec", other).expect_err("of another scene");
    assert!(error.to_string().contains("other.sinewrec"), "{error}");
    let mut live =
        Session::start(Subject::scene("stack", &[]).expect("a scene")).expect("the scene can be opened");
    assert!(live.set_ghost("plain.sinewrec", plain).is_err());
}

/// A button puts the current run on a timeline; keys and the mouse seek in it.
#[test]
fn dragging_the_timeline_seeks() {
    let Some(mut viewer) = viewer("stack", SIZE) else { return };
    let recording = recorded("stack", 100, Some(10));
    viewer.app_mut().open(played(&recording));
    settled(&mut viewer);
    viewer.key(Key::End);
    viewer.frame().expect("the card draws");
    let at = |viewer: &sinew_viewer::Headless| viewer.app().session().world().step_count();
    let arrive = |viewer: &mut sinew_viewer::Headless| {
        for _ in 0..1000 {
            viewer.app_mut().advance();
        }
        viewer.frame().expect("the card draws");
    };
    arrive(&mut viewer);
    assert_eq!(at(&viewer), 100);
    viewer.key(Key::ArrowLeft);
    viewer.frame().expect("the card draws");
    arrive(&mut viewer);
    assert_eq!(at(&viewer), 99);
    viewer.app_mut().compare_with("plain.sinewrec", recorded("stack", 100, None));
    let line = viewer.app().message().expect("the viewer shows a message").to_owned();
    assert!(line.contains("differs from step 11 on: body "), "{line}");
    // The bar is above the buttons, right of the scenes and of the step number.
    let area = viewer.app().area();
    let (x, y) = (0.5 * (area.left() + 150.0 + SIZE[0] as f32 - 18.0), area.bottom() + 22.0);
    viewer.move_to(x, y);
    viewer.button(x, y, true);
    viewer.frame().expect("the card draws");
    viewer.button(x, y, false);
    viewer.frame().expect("the card draws");
    arrive(&mut viewer);
    let middle = at(&viewer);
    assert!((40..=60).contains(&middle), "step {middle}");
    assert_eq!(viewer.app().session().world().hash(), recording.steps[middle as usize - 1].hash);
    look("timeline", &settled(&mut viewer));
}
