//! Changes by which files vary a rig without changing the character: order of joints, units, axes, names.

use crate::build::{OTHERS, PEOPLE, built, check_sound};
use crate::data::rig;
use crate::disguise::{misnamed, nameless, shuffled, transformed, under_a_mirror, z_up};
use needs_data::needs_data;
use sinew_anim::Rig;
use sinew_math::Rotation;
use sinew_ragdoll::{BuildOptions, DropReport, RagdollBodyDef, RagdollDef, Verdict, drop_test, gate};

/// Checks that both ragdolls have the same bodies on the same joints, at the same positions, with the same masses.
fn check_same(what: &str, plain: &RagdollDef, other: &RagdollDef, place: &[usize]) {
    assert_eq!(plain.bodies.len(), other.bodies.len(), "{what}");
    let of = |joint: usize| other.bodies.iter().find(|body| body.joint == place[joint]);
    for a in &plain.bodies {
        let Some(b) = of(a.joint) else { panic!("{what}: no body on the joint of {}", a.role) };
        assert_eq!(a.role, b.role, "{what}, {}", a.bone);
        let (m, n) = (a.mass.mass, b.mass.mass);
        assert!((m - n).abs() < 0.01 * m, "{what}, {}: masses {m} and {n} kg", a.role);
        // The up direction of a fish is unknown, so positions are relative to the first body.
        let place = |def: &RagdollDef, body: &RagdollBodyDef| {
            def.bodies[0].character_from_body.inverse_point(body.character_from_body.translation)
        };
        let moved = (place(plain, a) - place(other, b)).length();
        assert!(moved < 0.01 * plain.height, "{what}, {}: moved by {moved} m", a.role);
    }
    let named = |def: &RagdollDef| -> Vec<[String; 2]> {
        let name = |body: usize| def.bodies[body].role.clone();
        let mut pairs: Vec<_> = def.disabled_pairs.iter().map(|&(a, b)| [name(a), name(b)]).collect();
        pairs.iter_mut().for_each(|pair| pair.sort());
        pairs.sort();
        pairs
    };
    assert_eq!(named(plain), named(other), "{what}: disabled pairs differ");
}

fn check_variant(rig: &Rig, what: &str, other: &Rig, place: &[usize]) -> [RagdollDef; 2] {
    let [plain, other] = [rig, other].map(|rig| built(rig, &BuildOptions::default()).0);
    check_sound(what, &other);
    check_same(what, &plain, &other, place);
    [plain, other]
}

/// A file with identical skeletons, which only their order distinguishes.
const COPIES: &str = "RecursiveSkeletons.glb";

fn rigs() -> impl Iterator<Item = (&'static str, Rig)> {
    let names = PEOPLE.into_iter().chain(OTHERS).filter(|&name| name != COPIES);
    names.map(|name| (name, rig(name)))
}

#[needs_data]
#[test]
fn joint_order_does_not_change_the_ragdoll() {
    for (name, rig) in rigs() {
        for seed in 0..3 {
            let (other, place) = shuffled(&rig, seed);
            check_variant(&rig, &format!("{name}, order {seed}"), &other, &place);
        }
    }
}

#[needs_data]
#[test]
fn identical_skeletons_stay_identical_in_any_order() {
    let rig = rig(COPIES);
    let masses = |rig: &Rig| {
        let (def, _) = built(rig, &BuildOptions::default());
        let mut masses: Vec<f32> = def.bodies.iter().map(|body| body.mass.mass).collect();
        masses.sort_by(f32::total_cmp);
        masses
    };
    let (plain, other) = (masses(&rig), masses(&shuffled(&rig, 0).0));
    assert_eq!(plain.len(), other.len());
    for (m, n) in plain.iter().zip(&other) {
        assert!((m - n).abs() < 0.01 * m, "{m} and {n} kg");
    }
}

#[needs_data]
#[test]
fn units_and_axes_do_not_change_the_ragdoll() {
    for (name, rig) in rigs() {
        let same: Vec<usize> = (0..rig.joints.len()).collect();
        for (scale, turn) in [(0.01, Rotation::IDENTITY), (100.0, z_up()), (1.0, z_up())] {
            let what = format!("{name}, {scale} times, {turn:?}");
            check_variant(&rig, &what, &transformed(&rig, scale, turn), &same);
        }
    }
}

#[needs_data]
#[test]
fn mirroring_parent_node_does_not_change_the_ragdoll() {
    for (name, rig) in rigs() {
        let place: Vec<usize> = (1..=rig.joints.len()).collect();
        check_variant(&rig, name, &under_a_mirror(&rig), &place);
    }
}

/// Rigs that need their names: names show which of two joints at one position is the pelvis, or where a shoulder ends.
const NAMED: [&str; 2] = ["quaternius_cyberpunk_Character.glb", "quaternius_Robot.glb"];

#[needs_data]
#[test]
fn nameless_and_misnamed_joints_give_the_same_ragdoll() {
    for (name, rig) in rigs() {
        let same: Vec<usize> = (0..rig.joints.len()).collect();
        for (what, other) in [("no names", nameless(&rig)), ("other names", misnamed(&rig))] {
            let what = format!("{name}, {what}");
            if NAMED.contains(&name) {
                let [plain, other] = [&rig, &other].map(|rig| built(rig, &BuildOptions::default()).0);
                check_sound(&what, &other);
                assert!(other.bodies.iter().any(|body| body.role == "head"), "{what}: no human");
                let (m, n) = (plain.total_mass, other.total_mass);
                assert!((m - n).abs() < 0.01 * m, "{what}: masses {m} and {n} kg");
            } else {
                check_variant(&rig, &what, &other, &same);
            }
        }
    }
}

/// Checks that a ragdoll falls no worse than another. A fall is chaotic: for any rig, three in a thousand miss a
/// threshold for comfort, and one of these may be among the eight drops. In that case a hundred random falls of each
/// are compared. The numbers of failures may differ by two standard deviations, or by three plus one where failures are
/// rare.
pub fn check_falls(what: &str, plain: &RagdollDef, other: &RagdollDef) {
    let worse = Falls::of(plain).worse(plain, other);
    assert!(worse.is_none(), "{what}: {}", worse.unwrap_or_default());
}

/// Falls of a ragdoll, as the reference for others.
pub struct Falls {
    drops: DropReport,
    /// Counts of verdicts of a hundred random falls, good to bad; computed on demand.
    hundred: Option<[usize; 3]>,
}

impl Falls {
    pub fn of(def: &RagdollDef) -> Self {
        Self { drops: drop_test(def), hundred: None }
    }

    /// Describes how another ragdoll falls worse than `plain`, whose falls are `self`; see [`check_falls`].
    pub fn worse(&mut self, plain: &RagdollDef, other: &RagdollDef) -> Option<String> {
        let (before, after) = (&self.drops, drop_test(other));
        if after.verdict >= before.verdict {
            return None;
        }
        let before_all = *self.hundred.get_or_insert_with(|| gate(plain, 100).verdicts);
        let after_all = gate(other, 100).verdicts;
        let spread = |of: usize| {
            let share = of as f32 / 100.0;
            (2.0 * (2.0 * 100.0 * share * (1.0 - share)).sqrt()) as usize
        };
        let fewer_good = before_all[0].saturating_sub(after_all[0]);
        let more_bad = after_all[2].saturating_sub(before_all[2]);
        let falls_worse =
            fewer_good > spread(before_all[0]).max(3) || more_bad > spread(before_all[2]).max(1);
        let described =
            format!("{:?}, not {:?}; {after_all:?}, not {before_all:?}", after.reasons, before.reasons);
        (after.verdict == Verdict::Bad || falls_worse).then_some(described)
    }
}

/// Applies all changes together.
#[needs_data]
#[test]
fn disguised_rig_falls_no_worse() {
    for (name, rig) in rigs() {
        let (other, place) = shuffled(&transformed(&rig, 100.0, z_up()), 5);
        let [plain, other] = check_variant(&rig, name, &other, &place);
        check_falls(name, &plain, &other);
    }
}
