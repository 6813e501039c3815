//! Once warm, playing a character allocates nothing.

use crate::stage;
use sinew_anim::{
    AnimatedClip, AnimationSet, Animator, Easing, Event, Mask, ModelPose, Skeleton, TrackDef, Transition,
};
use sinew_math::{Affine, Random};

#[test]
fn a_warm_update_allocates_nothing() {
    let mut set = AnimationSet::new(Skeleton::new(&stage::rig()));
    let mut random = Random::new(1);
    for duration in [1.0, 0.75, 1.5] {
        let clip = stage::build(&stage::swaying(&mut random, duration), sinew_anim::Fill::Rest);
        set.add_clip(AnimatedClip { events: vec![Event::new(0.3, "a"), Event::new(0.0, "b")], ..clip });
    }
    let mask = set.add_mask(Mask::splat(stage::JOINTS, 0.5));
    let clips: Vec<_> = set.clips().collect();
    let mut animator = Animator::new(&set);
    animator.play(&set, &TrackDef { layer: 1, mask: Some(mask), speed: -0.7, ..TrackDef::new(clips[2]) });
    let [walk, run] = [0, 1].map(|i| TrackDef { sync_group: Some(0), ..TrackDef::new(clips[i]) });
    animator.play(&set, &walk);
    animator.play(&set, &run);
    let mut model = ModelPose::default();
    let mut cycle = |animator: &mut Animator| {
        for i in 0..100 {
            if i % 25 == 0 {
                let to = TrackDef::new(clips[i / 25 % 3]);
                let seconds = 0.2;
                let transition = match i / 25 % 2 {
                    0 => Transition::Inertial { seconds },
                    _ => Transition::Crossfade { seconds, easing: Easing::Smooth },
                };
                animator.transition(&set, &to, transition);
            }
            animator.update(&set, 1.0 / 60.0);
            set.skeleton().to_model(animator.pose(), &Affine::IDENTITY, &mut model);
        }
    };
    cycle(&mut animator);
    cycle(&mut animator);
    let counted = allocation_counter::measure(|| cycle(&mut animator));
    assert_eq!(counted.count_total, 0);
}
