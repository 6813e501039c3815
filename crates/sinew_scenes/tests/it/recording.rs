//! Recordings: equal replays, the first difference, and files of other versions.

use sinew::math::hash::hash_bytes;
use sinew::math::{Random, Vec3};
use sinew::physics::stage::NoProfiler;
use sinew::physics::{BodyKind, Quality, Sleeping, Threads};
use sinew_scenes::recording::{Difference, KeyFrame, Operation, Recorder, Recording, Replay, compare};
use sinew_scenes::scenes::Act;

/// Records a stack that is pulled, struck and shot at; `harder` changes one push.
fn played(harder: f32) -> Recording {
    let mut recorder = Recorder::start("stack", &[]).expect("the scene is registered");
    let world = recorder.instance().world();
    let body = world
        .body_ids()
        .filter(|&id| world.kind(id) == BodyKind::Dynamic)
        .last()
        .expect("the scene has a dynamic body");
    let point = world.center_of_mass(body);
    for step in 0..90 {
        match step {
            5 => recorder.apply(Operation::Grab { body, point }),
            6..30 => recorder
                .apply(Operation::Lead { to: point + Vec3::new(0.05, 0.02, 0.01) * (step - 5) as f32 }),
            30 => recorder.apply(Operation::Release),
            40 => recorder.apply(Operation::Push { body, impulse: Vec3::X * harder, point }),
            50 => recorder.apply(Operation::Throw {
                position: Vec3::new(-3.0, 1.0, 0.0),
                velocity: Vec3::X * 12.0,
                radius: 0.15,
                density: 800.0,
            }),
            60 => recorder.apply(Operation::Put {
                position: Vec3::new(0.0, 4.0, 0.0),
                half_extents: Vec3::splat(0.2),
                density: 500.0,
            }),
            70 => recorder.apply(Operation::Gravity { gravity: Vec3::NEG_Y * 3.7 }),
            74 => recorder.apply(Operation::Solve { quality: Quality::Exact }),
            78 => recorder.apply(Operation::Sleep { sleeping: Sleeping::Off }),
            82 => recorder.apply(Operation::Act { act: Act::Play(3) }),
            _ => {}
        }
        recorder.step();
    }
    recorder.finish()
}

#[test]
fn recording_repeats_its_states_on_any_number_of_threads() {
    let recording = Recording::read(&played(1.0).to_bytes()).expect("a written recording must be readable");
    assert_eq!(recording, played(1.0));
    assert_eq!(recording.key_frames.iter().map(|frame| frame.step).collect::<Vec<_>>(), [0, 30, 60, 90]);
    let mut replay = Replay::start(recording.clone()).expect("the scene starts");
    let threads = Threads::new(2);
    let mut steps = 0;
    while let Some(step) = replay.step_with(&threads, &NoProfiler) {
        steps += 1;
        assert_eq!((step.step, step.found), (steps, step.recorded));
    }
    assert_eq!(steps, 90);
    // The operations had effects: the pulled body moved, the ball and the box exist.
    let KeyFrame { bodies, .. } = &recording.key_frames[3];
    assert_eq!(bodies.len(), recording.key_frames[0].bodies.len() + 2);
}

#[test]
fn first_difference_is_found() {
    let (a, b) = (played(1.0), played(1.001));
    assert_eq!(compare(&a, &a), None);
    let Some(Difference::State { step, body: Some((id, [mine, theirs])) }) = compare(&a, &b) else {
        panic!("{:?}", compare(&a, &b));
    };
    // The state differs after the 41st step, because the push came before it.
    assert_eq!(step, 41);
    assert!(mine != theirs && (mine.translation - theirs.translation).length() < 1e-3, "{id:?}");
    let short = Recording { steps: a.steps[..50].to_vec(), ..a.clone() };
    assert_eq!(compare(&a, &short), Some(Difference::Length { common: 50 }));
    let other = Recording { scene: "pendulum".into(), ..a.clone() };
    assert_eq!(compare(&a, &other), Some(Difference::Scene));
    // Recordings that cannot be replayed are compared by their key frames: here of a scene that no longer exists.
    let [gone, moved] = [&a, &b].map(|it| Recording { scene: "long_gone".into(), ..it.clone() });
    let Some(Difference::State { step: 41, body: Some(_) }) = compare(&gone, &moved) else {
        panic!("{:?}", compare(&gone, &moved));
    };
}

#[test]
fn tampered_hash_is_reported_at_its_step() {
    let mut recording = played(1.0);
    recording.steps[17].hash ^= 1;
    let mut replay = Replay::start(recording).expect("the scene starts");
    let wrong = std::iter::from_fn(|| replay.step()).find(|step| step.found != step.recorded);
    assert_eq!(wrong.map(|step| step.step), Some(18));
}

/// A file of format 1 from an earlier version, with an operation of an unknown kind, which must stay readable.
const KEPT: &str = "\
    73696e6577726563 01000000 05000000302e302e31 09000000667265655f66616c6c 00000000 8988883c \
    01000000 efcdab8967452301 02000000 01000000 03 03000000 c80102 \
    01000000 0000000000000000 01000000 0100000000000000 \
    0000803f 00000040 00004040 00000000 00000000 00000000 0000803f";

#[test]
fn stored_file_is_read() {
    let digits: Vec<u8> = KEPT.bytes().filter(|byte| !byte.is_ascii_whitespace()).collect();
    let byte =
        |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).expect("ASCII"), 16).expect("hexadecimal");
    let bytes: Vec<u8> = digits.chunks(2).map(byte).collect();
    let recording = Recording::read(&bytes).expect("the stored file must be readable");
    assert_eq!((recording.made_by.as_str(), recording.scene.as_str()), ("0.0.1", "free_fall"));
    assert_eq!(recording.steps[0].operations, [Operation::Release]);
    assert_eq!(recording.steps[0].hash, 0x0123_4567_89ab_cdef);
    assert_eq!(recording.key_frames[0].bodies[0].1.translation, Vec3::new(1.0, 2.0, 3.0));
    let mut replay = Replay::start(recording).expect("the scene still exists");
    let step = replay.step().expect("the recording has a step");
    assert_ne!(step.found, step.recorded);
    let refused = |bytes: &[u8]| Recording::read(bytes).expect_err("the bytes must be refused").to_string();
    assert_eq!(refused(b"nothing of the kind"), "is no recording (byte 0)");
    let later = [&bytes[..8], &[9, 0, 0, 0], &bytes[12..]].concat();
    assert_eq!(refused(&later), "is a recording of format 9; this version reads 1, 2 and 4 (byte 8)");
}

/// A single flipped bit anywhere is reported.
#[test]
fn every_flipped_bit_is_reported() {
    let bytes = played(1.0).to_bytes();
    for bit in 0..8 * bytes.len() {
        let mut flipped = bytes.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        assert!(Recording::read(&flipped).is_err(), "bit {bit} of {}", 8 * bytes.len());
    }
}

#[test]
fn wrong_poses_in_key_frames_are_reported() {
    let mut recording = played(1.0);
    let frame = &mut recording.key_frames[1];
    let (step, body) = (frame.step, frame.bodies[0].0);
    frame.bodies[0].1.translation.x += 1e-6;
    let mut replay = Replay::start(recording).expect("the scene starts");
    assert_eq!(replay.misplaced(), None);
    let found = std::iter::from_fn(|| replay.step().map(|step| (step.step, replay.misplaced())));
    let wrong: Vec<_> = found.filter_map(|(step, body)| Some((step, body?.to_bits()))).collect();
    assert_eq!(wrong, [(step, body.to_bits())]);
}

/// Rewrites the checksums of a file's blocks.
fn rewrite_checksums(bytes: &mut [u8]) {
    let mut at = 12;
    while let Some(length) = bytes.get(at..at + 4) {
        let length = u32::from_le_bytes(length.try_into().expect("four bytes")) as usize;
        let Some(content) = bytes.get(at + 4..at + 4 + length) else { return };
        let sum = hash_bytes(content).to_le_bytes();
        at += 4 + length;
        let Some(place) = bytes.get_mut(at..at + 8) else { return };
        place.copy_from_slice(&sum);
        at += 8;
    }
}

/// Damaged files with valid checksums are read or refused, and those that are read replay without a panic.
#[test]
fn hostile_files_are_refused() {
    let bytes = played(1.0).to_bytes();
    for end in 0..bytes.len().min(600) {
        assert!(Recording::read(&bytes[..end]).is_err(), "cut at {end}");
    }
    let mut random = Random::new(7);
    let mut refused = 0;
    for _ in 0..300 {
        let mut bytes = bytes.clone();
        for _ in 0..4 {
            let place = random.index(bytes.len());
            bytes[place] = random.index(256) as u8;
        }
        rewrite_checksums(&mut bytes);
        let Ok(recording) = Recording::read(&bytes) else {
            refused += 1;
            continue;
        };
        if let Ok(mut replay) = Replay::start(recording) {
            for _ in 0..70 {
                replay.step();
            }
        }
    }
    assert!(refused > 0, "no mutation was refused");
}
