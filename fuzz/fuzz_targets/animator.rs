//! The state of an animator: an accepted state can be advanced, and is saved as the same bytes.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_anim::{
    AnimatedClip, AnimationSet, Animator, BuiltClip, Channel, Clip, ClipBuildOptions, ClipEvent,
    Interpolation, Joint, LocalTransform, Mask, Property, Rig, Skeleton, TrackDef, Transition,
};
use sinew_math::{Reader, Writer};

const JOINTS: usize = 3;

fuzz_target!(|bytes: &[u8]| {
    let set = set();
    if let Ok(mut animator) = Animator::load(&set, &mut Reader::new(bytes)) {
        let saved = saved(&animator, &set);
        let again = Animator::load(&set, &mut Reader::new(&saved)).expect("what we write we read");
        assert_eq!(saved, self::saved(&again, &set));
        animator.update(&set, 0.1);
    }
    // Nearly all bytes fail at the header: so one good state, with some of its bytes replaced.
    let mut state = saved(&busy(&set), &set);
    for change in bytes.chunks_exact(3) {
        let place = usize::from(u16::from_le_bytes([change[0], change[1]])) % state.len();
        state[place] = change[2];
    }
    if let Ok(mut animator) = Animator::load(&set, &mut Reader::new(&state)) {
        animator.update(&set, 0.1);
        animator.update(&set, 0.0);
    }
});

fn saved(animator: &Animator, set: &AnimationSet) -> Vec<u8> {
    let mut out = Writer::new();
    animator.save(set, &mut out);
    out.into_bytes()
}

fn busy(set: &AnimationSet) -> Animator {
    let clips: Vec<_> = set.clips().collect();
    let mut animator = Animator::new(set);
    animator.play(set, &TrackDef { speed: -1.5, sync_group: Some(1), ..TrackDef::new(clips[0]) });
    animator.play(set, &TrackDef { weight: 0.5, start: 0.3, ..TrackDef::new(clips[1]) });
    animator.update(set, 0.4);
    animator.transition(set, &TrackDef::new(clips[1]), Transition::Inertial { seconds: 0.4 });
    animator.update(set, 0.05);
    animator
}

fn set() -> AnimationSet {
    let joint = |source: usize| Joint {
        name: String::new(),
        parent: source.checked_sub(1),
        rest: LocalTransform::default(),
        source,
    };
    let rig = Rig { joints: (0..JOINTS).map(joint).collect(), ..Rig::default() };
    let mut set = AnimationSet::new(Skeleton::new(&rig));
    for duration in [1.0, 0.7] {
        let channel = |joint| Channel {
            joint,
            property: Property::Rotation,
            interpolation: Interpolation::Linear,
            times: vec![0.0, 0.5 * duration, duration],
            values: vec![0.0, 0.0, 0.0, 1.0, 0.6, 0.0, 0.0, 0.8, 0.0, 0.0, 0.0, 1.0],
        };
        let clip = Clip { name: String::new(), duration, channels: (0..JOINTS).map(channel).collect() };
        let clip = BuiltClip::build(&clip, &rig, &ClipBuildOptions::default()).expect("a good clip");
        let events = vec![ClipEvent::new(0.5, "middle"), ClipEvent::new(0.0, "start")];
        set.add_clip(AnimatedClip { events, ..AnimatedClip::from(clip) });
    }
    set.add_mask(Mask::splat(JOINTS, 0.5));
    set
}
