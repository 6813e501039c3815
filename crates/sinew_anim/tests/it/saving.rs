//! Saved animator state: loading restores it exactly, and any other bytes give an error.

use crate::stage;
use sinew_anim::{
    AnimatedClip, AnimationSet, Animator, ClipEvent, Easing, EndAction, EventPolicy, LoopMode, Mask,
    Skeleton, TrackDef, Transition,
};
use sinew_math::{Random, Reader, Writer};

fn set() -> AnimationSet {
    let mut set = AnimationSet::new(Skeleton::new(&stage::rig()));
    let mut random = Random::new(1);
    for duration in [1.0, 0.7, 1.3] {
        let clip = stage::build(&stage::swaying(&mut random, duration), sinew_anim::Fill::Rest);
        let policy = EventPolicy { on_interrupt: true, ..EventPolicy::default() };
        let events =
            vec![ClipEvent { policy, ..ClipEvent::new(0.5, "middle") }, ClipEvent::new(0.0, "start")];
        set.add_clip(AnimatedClip { events, ..clip });
    }
    set.add_mask(Mask::splat(stage::JOINTS, 0.5));
    set
}

/// Returns an animator with one of every kind of ongoing action.
fn busy(set: &AnimationSet, random: &mut Random) -> Animator {
    let clips: Vec<_> = set.clips().collect();
    let mut animator = Animator::new(set);
    for i in 0..4 {
        let id = animator.play(
            set,
            &TrackDef {
                weight: random.unit(),
                speed: random.range(-2.0, 2.0),
                start: random.unit(),
                loop_mode: [LoopMode::Loop, LoopMode::PingPong, LoopMode::Once, LoopMode::Loop][i],
                layer: (i / 3) as u8,
                sync_group: (i % 3 == 0).then_some(2),
                ..TrackDef::new(clips[i % 3])
            },
        );
        animator.fade(id, random.unit(), random.range(0.1, 2.0), Easing::In, EndAction::Pause);
    }
    for _ in 0..random.index(9) {
        animator.update(set, random.range(0.0, 0.1));
    }
    let transition = match random.index(2) {
        0 => Transition::Inertial { seconds: 0.4 },
        _ => Transition::Crossfade { seconds: 0.4, easing: Easing::Smooth },
    };
    animator.transition(set, &TrackDef::new(clips[random.index(3)]), transition);
    for _ in 0..random.index(3) {
        animator.update(set, random.range(0.0, 0.1));
    }
    if random.index(2) == 0 {
        let id = animator.tracks().next().expect("one at least").id();
        animator.stop(set, id);
    }
    animator
}

fn saved(animator: &Animator, set: &AnimationSet) -> Vec<u8> {
    let mut out = Writer::new();
    animator.save(set, &mut out);
    out.into_bytes()
}

#[test]
fn loaded_animator_continues_identically() {
    let (set, mut random) = (set(), Random::new(2));
    for round in 0..40 {
        let mut animator = busy(&set, &mut random);
        let bytes = saved(&animator, &set);
        let mut reader = Reader::new(&bytes);
        let mut loaded = Animator::load(&set, &mut reader)
            .unwrap_or_else(|error| panic!("round {round}: load fails: {error}"));
        assert_eq!(reader.remaining(), 0);
        assert_eq!(saved(&loaded, &set), bytes);
        assert_eq!(loaded.pose(), animator.pose());
        for step in 0..30 {
            let dt = random.range(0.0, 0.1);
            animator.update(&set, dt);
            loaded.update(&set, dt);
            assert_eq!(loaded.pose(), animator.pose(), "round {round}: other state in step {step}");
            assert_eq!(loaded.events(), animator.events());
            assert_eq!(loaded.root_motion(), animator.root_motion());
        }
        let next = TrackDef::new(set.clips().next().expect("a clip"));
        assert_eq!(loaded.play(&set, &next), animator.play(&set, &next));
    }
}

#[test]
fn corrupted_bytes_give_an_error_or_a_valid_state() {
    let (set, mut random) = (set(), Random::new(3));
    let bytes = saved(&busy(&set, &mut random), &set);
    for end in 0..bytes.len() {
        assert!(Animator::load(&set, &mut Reader::new(&bytes[..end])).is_err(), "cut at {end}");
    }
    let mut refused = 0;
    for _ in 0..4_000 {
        let mut changed = bytes.clone();
        for _ in 0..1 + random.index(3) {
            let at = random.index(changed.len());
            changed[at] = [0, 0xFF, 0x7F, 0x80, random.index(256) as u8][random.index(5)];
        }
        match Animator::load(&set, &mut Reader::new(&changed)) {
            Err(_) => refused += 1,
            Ok(mut animator) => {
                animator.update(&set, 0.0);
                animator.update(&set, 0.1);
            }
        }
    }
    assert!(refused > 400, "{refused}");
}

#[test]
fn state_of_another_set_is_rejected() {
    let (set, other) = (set(), stage::set(9));
    let bytes = saved(&Animator::new(&set), &set);
    let error = Animator::load(&other, &mut Reader::new(&bytes)).expect_err("another set");
    assert_eq!(error.to_string(), "the state belongs to another set of clips (at byte 16)");
}

#[test]
fn state_with_too_many_cycles_is_rejected() {
    let (set, clip) = (set(), 0);
    let clip = set.clips().nth(clip).expect("a clip");
    let load = |change: &dyn Fn(&mut Vec<u8>, &[u8]), def: &TrackDef| {
        let mut animator = Animator::new(&set);
        animator.play(&set, def);
        animator.play(&set, &TrackDef { speed: 1.25, ..*def });
        let mut bytes = saved(&animator, &set);
        change(&mut bytes, &1.25_f32.to_le_bytes());
        Animator::load(&set, &mut Reader::new(&bytes)).map(|_| ()).map_err(|error| error.to_string())
    };
    let place_of = |bytes: &[u8], what: &[u8]| {
        bytes
            .windows(what.len())
            .position(|window| window == what)
            .expect("the saved bytes contain the value")
    };
    let alone = TrackDef::new(clip);
    assert_eq!(load(&|_, _| {}, &alone), Ok(()));
    let faster = |bytes: &mut Vec<u8>, speed: &[u8]| {
        let place = place_of(bytes, speed);
        bytes[place..place + 4].copy_from_slice(&1e30_f32.to_le_bytes());
    };
    assert!(load(&faster, &alone).is_err_and(|error| error.contains("a track is too fast")));
    // The bytes after the speed are the start, three kinds, no mask, a group, and the cycles.
    let farther = |bytes: &mut Vec<u8>, speed: &[u8]| {
        let place = place_of(bytes, speed) + 4 + 4 + 3 + 1 + 2;
        bytes[place + 4] = 1;
    };
    let together = TrackDef { sync_group: Some(1), ..alone };
    assert_eq!(load(&|_, _| {}, &together), Ok(()));
    assert!(load(&farther, &together).is_err_and(|error| error.contains("far from its sync group")));
}

#[test]
#[should_panic(expected = "the speed must be finite and at most 1000")]
fn track_with_excessive_speed_panics() {
    let set = set();
    let clip = set.clips().next().expect("a clip");
    Animator::new(&set).play(&set, &TrackDef { speed: 2e3, ..TrackDef::new(clip) });
}
