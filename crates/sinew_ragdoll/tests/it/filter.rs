//! Pairs of bodies that may collide: overlaps in the bind pose, within the limits and in clips, and the remedy for
//! each.

use sinew_anim::roles::{Role, Side};
use sinew_math::{Rotation, Transform, Vec3};
use sinew_physics::Shape;
use sinew_ragdoll::build::bones::{Anatomy, Bone, Bones};
use sinew_ragdoll::filter::poses::Poses;
use sinew_ragdoll::filter::{FilterReport, Remedy, TOLERATED, filter_pairs};
use sinew_ragdoll::fit::{Fit, patch::Selection};

const HIPS: usize = 0;
const HAND: usize = 4;
const THIGH: usize = 5;
const HEAD: usize = 8;

/// Returns balls of 5 cm, far from each other: hips, spine, a left arm, a left thigh with shank and foot, a head.
fn body() -> (Bones, Vec<Fit>) {
    let left = Side::Left;
    let list = [
        (Role::Hips, None),
        (Role::Spine, Some(0)),
        (Role::UpperArm(left), Some(1)),
        (Role::LowerArm(left), Some(2)),
        (Role::Hand(left), Some(3)),
        (Role::UpperLeg(left), Some(0)),
        (Role::LowerLeg(left), Some(5)),
        (Role::Foot(left), Some(6)),
        (Role::Head, Some(1)),
    ];
    let place = |index: usize| Vec3::new(0.0, 0.3 * index as f32, 0.0);
    let bone =
        |(index, &(role, parent)): (usize, &(Role, Option<usize>))| Bone::new(0, role, parent, place(index));
    let bones = Bones::new(list.iter().enumerate().map(bone).collect(), Anatomy::Human, 1.75);
    let fit = |index: usize| Fit {
        shape: Shape::Sphere { radius: 0.05 },
        character_from_body: Transform::new(place(index), Rotation::IDENTITY),
        error: 0.0,
        area: 1.0,
        selection: Selection::Nothing,
    };
    (bones, (0..list.len()).map(fit).collect())
}

/// Returns poses in which, for this share, body `b` is at `distance` from body `a`.
fn meeting(fits: &[Fit], share: f32, (a, b): (usize, usize), distance: f32) -> Vec<Vec<Transform>> {
    let pose = |index: usize| {
        let mut pose: Vec<_> = fits.iter().map(|fit| fit.character_from_body).collect();
        if (index as f32) + 0.5 < 100.0 * share {
            pose[b].translation = pose[a].translation + Vec3::X * distance;
        }
        pose
    };
    (0..100).map(pose).collect()
}

fn found(report: &FilterReport, pair: (usize, usize)) -> Option<Remedy> {
    let disabled = report.disabled.contains(&pair);
    let remedy = report.overlaps.iter().find(|overlap| overlap.pair == pair).map(|overlap| overlap.remedy);
    assert_eq!(disabled, remedy == Some(Remedy::Disabled), "{report:?}");
    remedy
}

/// Returns the remedy for a pair that overlaps in these shares of the poses within the limits and of the clips.
fn remedy(pair: (usize, usize), distance: f32, limits: f32, clips: f32) -> Option<Remedy> {
    let (bones, mut fits) = body();
    let poses = Poses {
        within_limits: meeting(&fits, limits, pair, distance),
        of_clips: meeting(&fits, clips, pair, distance),
    };
    let report = filter_pairs(&bones, &mut fits, &poses);
    let seen = report.overlaps.iter().find(|overlap| overlap.pair == pair).map(|overlap| overlap.seen);
    if let Some(seen) = seen {
        assert!((seen.limits - limits).abs() < 1e-5, "{seen:?}");
        assert!((seen.clips.expect("there are clips") - clips).abs() < 1e-5, "{seen:?}");
    }
    found(&report, pair)
}

#[test]
fn limbs_that_overlap_rarely_collide() {
    for pair in [(HIPS, HAND), (HAND, THIGH), (HAND, HEAD)] {
        assert_eq!(remedy(pair, 0.02, 0.5, 0.0), None, "{pair:?}");
        assert_eq!(remedy(pair, 0.02, 0.5, 0.3).unwrap_or(Remedy::Tolerated), Remedy::Tolerated, "{pair:?}");
    }
}

#[test]
fn limbs_that_always_overlap_do_not_collide() {
    for pair in [(HIPS, HAND), (HAND, THIGH), (HAND, HEAD)] {
        assert_eq!(remedy(pair, 0.02, 0.95, 0.0), Some(Remedy::Disabled), "{pair:?}");
        assert_eq!(remedy(pair, 0.02, 0.0, 0.6), Some(Remedy::Disabled), "{pair:?}");
    }
    // No fall needs a collision between head and hips.
    assert_eq!(remedy((HIPS, HEAD), 0.02, 0.0, 0.05), Some(Remedy::Disabled));
    assert_eq!(remedy((HIPS, HEAD), 0.02, 0.0, 0.02), None);
}

/// Two balls of 5 cm with centres 9 cm apart overlap by 1 cm. Each ball is made a few per cent thinner; half of the
/// overlap is tolerated.
#[test]
fn limbs_that_graze_each_other_are_made_thinner() {
    let (bones, mut fits) = body();
    let poses = Poses { within_limits: Vec::new(), of_clips: meeting(&fits, 0.6, (HAND, THIGH), 0.09) };
    let report = filter_pairs(&bones, &mut fits, &poses);
    assert_eq!(found(&report, (HAND, THIGH)), Some(Remedy::Shrunk));
    for body in [HAND, THIGH] {
        let Shape::Sphere { radius } = fits[body].shape else { panic!("the shape stays a ball") };
        assert!((radius - 0.05 * report.scale[body]).abs() < 1e-6);
        assert!(2.0 * radius - 0.09 <= TOLERATED && report.scale[body] > 0.92, "{radius}");
    }
    assert!(report.scale.iter().filter(|&&scale| scale < 1.0).count() == 2);
}

/// In a rig bound with its hand in its thigh the hand can leave, so the pair collides like others.
#[test]
fn overlap_in_the_bind_pose_alone_disables_no_pair() {
    let (bones, mut fits) = body();
    let apart = Poses { within_limits: meeting(&fits, 0.0, (HAND, THIGH), 0.0), of_clips: Vec::new() };
    let often = Poses { within_limits: meeting(&fits, 0.5, (HAND, THIGH), 0.02), of_clips: Vec::new() };
    fits[THIGH].character_from_body.translation = fits[HAND].character_from_body.translation + Vec3::X * 0.03;
    let report = filter_pairs(&bones, &mut fits.clone(), &apart);
    assert_eq!(found(&report, (HAND, THIGH)), Some(Remedy::OnlyBound));
    let report = filter_pairs(&bones, &mut fits, &often);
    assert_eq!(found(&report, (HAND, THIGH)), Some(Remedy::Disabled));
}
