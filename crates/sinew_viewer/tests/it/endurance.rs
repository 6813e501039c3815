//! Memory while many scenes open and close, and processor time of a frame.

use crate::hands::viewer;
use crate::pictures::{gpu, look};
use sinew::math::Vec3;
use sinew_picture::{Camera, Scene};
use sinew_scenes::scenes::registry;
use sinew_viewer::{Offscreen, Session, Stage, Subject, stage};
use std::time::Instant;

/// Number of times that each scene is opened. `SINEW_ROUNDS` overrides it.
const ROUNDS: usize = 50;

/// Growth of the resident memory from the fifth round to the last that counts as noise, bytes.
const NOISE: u64 = 32 << 20;

/// Returns the resident memory of this process, bytes; `None` where the system does not report it.
fn resident() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS"))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? << 10)
}

/// Returns the processor time of this thread, ms; `None` where the system does not report it.
fn thread_time() -> Option<f64> {
    let schedule = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(schedule.split_whitespace().next()?.parse::<f64>().ok()? / 1e6)
}

/// Opens every scene repeatedly, with a picture of each: memory does not grow, and no GPU call fails (which
/// panics).
#[test]
#[ignore = "some 40 s a round in a debug build: `cargo xtask ci --full`"]
fn every_scene_opens_and_closes() {
    let Some(mut viewer) = viewer("pendulum", [320, 200]) else { return };
    let rounds = std::env::var("SINEW_ROUNDS").ok().and_then(|text| text.parse().ok()).unwrap_or(ROUNDS);
    let mut slowest: Vec<(f64, &str)> = Vec::new();
    let mut early = None;
    for round in 0..rounds {
        for scene in registry() {
            let subject = Subject::scene(scene.name, &[]).expect("the scene is in the registry");
            let start = Instant::now();
            viewer.app_mut().open(subject);
            viewer.frame().expect("the card draws");
            assert_eq!(viewer.app().session().subject().title(), scene.name);
            if round == 0 {
                slowest.push((start.elapsed().as_secs_f64() * 1e3, scene.name));
            }
        }
        if round == 4 {
            early = resident();
        }
        println!("round {round}: {} MiB", resident().unwrap_or_default() >> 20);
    }
    slowest.sort_by(|a, b| b.0.total_cmp(&a.0));
    let median = slowest[slowest.len() / 2].0;
    println!(
        "{} scenes; to their first picture: median {median:.0} ms, slowest {:.0?}",
        slowest.len(),
        &slowest[..5]
    );
    if let (Some(early), Some(late)) = (early, resident()) {
        assert!(
            late < early + NOISE,
            "memory: {} MiB after five rounds, {} MiB at the end",
            early >> 20,
            late >> 20
        );
    }
}

/// Prints the time that encoding a frame with a hundred skinned characters takes, beside an empty stage, which
/// reads back as much.
#[test]
#[ignore = "a measurement, which asserts no time: `cargo xtask ci --full`"]
fn a_frame_with_a_hundred_figures() {
    let Some(gpu) = gpu() else { return };
    let subject = Subject::scene("street", &["n=100".to_owned()]).expect("the scene exists");
    let mut session = Session::start(subject).expect("the scene can be opened");
    for _ in 0..60 {
        session.step();
    }
    let direction = Vec3::new(0.4, 0.5, 1.0);
    let camera = Camera::framing_box(&sinew_viewer::bounds(session.instance()), direction, 16.0 / 9.0);
    let mut offscreen = Offscreen::new(gpu, [1280, 720]);
    let mut frame = |is_empty: bool| {
        let (start, before) = (Instant::now(), thread_time());
        let stage = if is_empty { Stage::of(Scene::default()) } else { stage(&session, &camera, &[]) };
        assert!(is_empty || stage.figures.len() >= 100, "{} figures", stage.figures.len());
        let picture = offscreen.render(&stage, &camera).expect("the card draws");
        look(if is_empty { "empty" } else { "street" }, &picture);
        (thread_time().zip(before).map_or(f64::NAN, |(after, before)| after - before), start.elapsed())
    };
    let mut times: Vec<(f64, f64)> = (0..15)
        .map(|_| {
            let ((empty, _), (full, until)) = (frame(true), frame(false));
            (full - empty, until.as_secs_f64() * 1e3)
        })
        .collect();
    times.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (encoding, until) = times[times.len() / 2];
    println!("encoding {encoding:.2} ms of the thread, {until:.0} ms until the picture is back");
}
