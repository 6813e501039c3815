//! The viewer without a window: keys, search, mouse, and pictures.

use crate::pictures::{gpu, look};
use egui::Key;
use sinew_picture::Image;
use sinew_viewer::{App, Headless, Options, Subject};

const SIZE: [u32; 2] = [1280, 760];

/// Returns a paused viewer of a scene with pictures of a size in pixels.
pub fn viewer(scene: &str, size: [u32; 2]) -> Option<Headless> {
    let subject = Some(Subject::scene(scene, &[]).expect("the scene exists"));
    let app = App::new(Options { subject, paused: true, ..Options::default() }).expect("the viewer starts");
    Some(Headless::new(app, gpu()?, size))
}

/// Draws frames until the panels have their final sizes; returns the last one.
pub fn settled(viewer: &mut Headless) -> Image {
    (0..3).map(|_| viewer.frame().expect("the card draws")).last().expect("three frames")
}

#[test]
fn scenes_and_panels() {
    let Some(mut viewer) = viewer("pendulum", SIZE) else { return };
    for _ in 0..20 {
        viewer.key(Key::N);
        viewer.app_mut().advance();
        viewer.frame().expect("the card draws");
    }
    let image = settled(&mut viewer);
    look("panels", &image);
    assert_eq!(viewer.app().session().world().step_count(), 20);
    viewer.text("?");
    let help = settled(&mut viewer);
    look("help", &help);
    assert_ne!(help, image);
}

#[test]
fn search_opens_a_scene() {
    let Some(mut viewer) = viewer("pendulum", SIZE) else { return };
    settled(&mut viewer);
    viewer.text("/");
    settled(&mut viewer);
    viewer.text("dominoes");
    look("search", &settled(&mut viewer));
    viewer.key(Key::Enter);
    settled(&mut viewer);
    assert_eq!(viewer.app().session().subject().title(), "dominoes");
    look("dominoes", &settled(&mut viewer));
}

/// A drag pulls the body under the mouse, is recorded, and the recording replays to the same bits.
#[test]
fn drag_pulls_a_body_and_is_recorded() {
    let Some(mut viewer) = viewer("stack", SIZE) else { return };
    settled(&mut viewer);
    let world = viewer.app().session().world();
    let body = world.body_ids().filter(|&id| world.mass(id).mass > 0.0).last().expect("something moves");
    let before = world.transform(body).translation;
    let at = viewer.app().on_screen(before).expect("the body is visible");
    viewer.move_to(at.x, at.y);
    viewer.frame().expect("the card draws");
    viewer.button(at.x, at.y, true);
    viewer.frame().expect("the card draws");
    for i in 1..=40 {
        viewer.move_to(at.x + 3.0 * i as f32, at.y - 2.0 * i as f32);
        viewer.key(Key::N);
        viewer.frame().expect("the card draws");
    }
    look("drag", &viewer.frame().expect("the card draws"));
    viewer.button(at.x + 120.0, at.y - 80.0, false);
    viewer.frame().expect("the card draws");
    let session = viewer.app().session();
    let moved = (session.world().transform(body).translation - before).length();
    assert!(moved > 0.1, "the character moved only {moved} m");
    let recording = session.recording().expect("a scene is recorded");
    assert!(recording.steps.iter().any(|step| !step.operations.is_empty()));
    let mut replay =
        sinew_scenes::recording::Replay::start(recording.clone()).expect("the recording can be replayed");
    let mut steps = 0;
    while let Some(step) = replay.step() {
        assert_eq!(step.found, step.recorded, "step {}", step.step);
        steps += 1;
    }
    assert_eq!(steps, 40);
}

#[test]
fn ball_is_thrown_and_layers_are_drawn() {
    let Some(mut viewer) = viewer("ragdoll_drop", SIZE) else { return };
    let plain = settled(&mut viewer);
    let bodies = viewer.app().session().world().body_ids().count();
    viewer.key(Key::B);
    viewer.frame().expect("the card draws");
    assert_eq!(viewer.app().session().world().body_ids().count(), bodies + 1);
    for _ in 0..30 {
        viewer.key(Key::N);
        viewer.frame().expect("the card draws");
    }
    for key in [Key::Num1, Key::Num2, Key::Num3] {
        viewer.key(key);
    }
    let layered = settled(&mut viewer);
    look("layers", &layered);
    assert_ne!(plain, layered);
}

/// A file that cannot be shown gives a message, and the viewer continues.
#[test]
fn invalid_file_gives_a_message() {
    let Some(mut viewer) = viewer("pendulum", SIZE) else { return };
    viewer.app_mut().open_file("nowhere.json".as_ref());
    assert_eq!(viewer.app().message(), Some("nowhere.json: no such file"));
    assert_eq!(viewer.app().session().subject().title(), "pendulum");
    look("message", &settled(&mut viewer));
}

/// W makes the scene's character walk away from the camera, releasing W stops it, and the recording replays
/// the same.
#[test]
fn keys_move_a_walking_character() {
    let Some(mut viewer) = viewer("street", [640, 360]) else { return };
    settled(&mut viewer);
    let place = |viewer: &Headless| viewer.app().session().instance().steered().expect("somebody is led");
    let before = place(&viewer);
    viewer.key(Key::G);
    viewer.frame().expect("the card draws");
    viewer.hold(Key::W, true);
    viewer.frame().expect("the card draws");
    for _ in 0..60 {
        viewer.app_mut().step();
    }
    let (after, camera) = (place(&viewer), viewer.app().camera());
    look("walk", &viewer.frame().expect("the card draws"));
    let way = after - before;
    let ahead = camera.target - camera.position;
    assert!(way.length() > 0.8, "it walked {way}");
    let level = |v: sinew::math::Vec3| sinew::math::Vec3::new(v.x, 0.0, v.z).normalize();
    assert!(level(way).dot(level(ahead)) > 0.9, "the character walked {way}, the camera looks along {ahead}");
    viewer.hold(Key::W, false);
    viewer.frame().expect("the card draws");
    for _ in 0..30 {
        viewer.app_mut().step();
    }
    let stands = place(&viewer);
    for _ in 0..20 {
        viewer.app_mut().step();
    }
    assert!((place(&viewer) - stands).length() < 0.02, "it stands");
    let recording = viewer.app().session().recording().expect("a scene is recorded").to_bytes();
    let recording = sinew_scenes::recording::Recording::read(&recording).expect("the recording can be read");
    let mut replay =
        sinew_scenes::recording::Replay::start(recording).expect("the recording can be replayed");
    while let Some(step) = replay.step() {
        assert_eq!(step.found, step.recorded, "step {}", step.step);
    }
    assert_eq!(replay.instance().steered(), Some(place(&viewer)));
}

/// The first scene opens with characters drawn with their skin, which stay in the picture.
#[test]
fn first_scene_stays_in_view() {
    let Some(gpu) = gpu() else { return };
    let options = Options { hides_times: true, steps: Some(300), ..Options::default() };
    let app = App::new(options).expect("the viewer starts");
    assert!(!app.session().instance().figures().is_empty());
    let mut viewer = Headless::new(app, gpu, SIZE);
    settled(&mut viewer);
    while viewer.app().session().world().step_count() < 300 {
        viewer.app_mut().advance();
        viewer.frame().expect("the card draws");
        let (camera, instance) = (viewer.app().camera(), viewer.app().session().instance());
        assert!(camera.position.y > 0.0);
        for figure in instance.figures() {
            let to = figure.world_from_joint[0].translation - camera.position;
            let angle = to.angle_between(camera.target - camera.position);
            assert!(angle < 0.5, "a character is {angle} rad from the centre of the view");
        }
    }
    look("first", &settled(&mut viewer));
}

/// A thrown ball is undone and done again; edits of gravity too.
#[test]
fn operations_are_undone() {
    let subject = Some(Subject::scene("stack", &[]).expect("the scene exists"));
    let mut app =
        App::new(Options { subject, paused: true, ..Options::default() }).expect("the viewer starts");
    (0..10).for_each(|_| app.step());
    let before = app.session().world().hash();
    let mut session_bodies = app.session().world().body_ids().count();
    app.obey(sinew_viewer::Order::Throw);
    (0..30).for_each(|_| app.step());
    let after = app.session().world().hash();
    assert_eq!(app.session().world().body_ids().count(), session_bodies + 1);
    app.undo(false);
    assert_eq!((app.session().world().hash(), app.message()), (before, Some("undone")));
    app.undo(true);
    assert_eq!((app.session().world().hash(), app.message()), (after, Some("done again")));
    session_bodies += 1;
    assert_eq!(app.session().world().body_ids().count(), session_bodies);
    // The recording matches the run after undo and redo.
    let recording = app.session().recording().expect("a scene is recorded").clone();
    assert_eq!(recording.steps.len(), 40);
    let mut replay =
        sinew_scenes::recording::Replay::start(recording).expect("the recording can be replayed");
    while let Some(step) = replay.step() {
        assert_eq!(step.found, step.recorded, "step {}", step.step);
    }
    app.undo(false);
    app.undo(false);
    assert_eq!(app.message(), Some("nothing to undo"));
}
