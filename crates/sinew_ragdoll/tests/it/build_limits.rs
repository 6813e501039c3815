//! Joint limits in anatomical terms, on hand-made skeletons: the direction in which knees bend and limit cones point.

use sinew_anim::roles::{Role, Side};
use sinew_math::{Range, Rotation, Transform, Vec3, limits::hinge_angle, trig};
use sinew_physics::{JointKind, MassProperties, Shape};
use sinew_ragdoll::build::bones::{Anatomy, Bone, Bones};
use sinew_ragdoll::fit::{Fit, patch::Selection};
use sinew_ragdoll::limits::friction::friction_torques;
use sinew_ragdoll::limits::{JointPlan, joints};

/// Returns a person of 1.75 m whose arms hang `drop` radians below the horizontal.
fn person(drop: f32) -> Bones {
    let mut list = vec![
        Bone::new(0, Role::Hips, None, Vec3::new(0.0, 1.0, 0.0)),
        Bone::new(1, Role::Spine, Some(0), Vec3::new(0.0, 1.1, 0.0)),
        Bone::new(2, Role::Head, Some(1), Vec3::new(0.0, 1.55, 0.0)),
    ];
    for side in [Side::Left, Side::Right] {
        let s = if side == Side::Left { 1.0 } else { -1.0 };
        let arm = Vec3::new(s * trig::cos(drop), -trig::sin(drop), 0.0);
        let shoulder = Vec3::new(s * 0.2, 1.45, 0.0);
        let first = list.len();
        let mut add = |role, parent, head| list.push(Bone::new(0, role, Some(parent), head));
        add(Role::UpperArm(side), 1, shoulder);
        add(Role::LowerArm(side), first, shoulder + arm * 0.28);
        add(Role::Hand(side), first + 1, shoulder + arm * 0.55);
        add(Role::UpperLeg(side), 0, Vec3::new(s * 0.1, 0.95, 0.0));
        add(Role::LowerLeg(side), first + 3, Vec3::new(s * 0.1, 0.52, 0.0));
        add(Role::Foot(side), first + 4, Vec3::new(s * 0.1, 0.09, 0.0));
        add(Role::Toes(side), first + 5, Vec3::new(s * 0.1, 0.02, 0.15));
    }
    Bones::new(list, Anatomy::Human, 1.75)
}

/// Returns fitted bodies with random frame rotations, on which limits must not depend.
fn fits(bones: &Bones) -> Vec<Fit> {
    (0..bones.list.len())
        .map(|i| {
            let middle = bones.tail(i).map_or_else(
                || bones.list[i].head + bones.direction(i, None) * 0.1,
                |tail| (bones.list[i].head + tail) * 0.5,
            );
            let turn = Rotation::from_scaled_axis(Vec3::new(i as f32, 1.0, -0.3 * i as f32));
            Fit {
                shape: Shape::Sphere { radius: 0.05 },
                character_from_body: Transform::new(middle, turn),
                error: 0.0,
                area: 1.0,
                selection: Selection::Nothing,
            }
        })
        .collect()
}

fn plans(bones: &Bones) -> Vec<JointPlan> {
    joints(bones, &fits(bones), 75.0)
}

fn index(bones: &Bones, role: Role) -> usize {
    bones.list.iter().position(|bone| bone.role == role).expect("made by hand")
}

/// Returns the joint rotation at the bind pose, parent frame to child frame, and the parent's frame in character axes.
fn at_bind(bones: &Bones, plan: &JointPlan) -> (Rotation, Rotation) {
    let fits = fits(bones);
    let of = |body: usize, frame: Transform| fits[body].character_from_body.rotation * frame.rotation;
    let (parent, child) =
        (of(plan.def.parent, plan.def.frame_parent), of(plan.def.child, plan.def.frame_child));
    (parent.inverse() * child, parent)
}

/// Returns the position of a point attached to the child for the joint rotation `joint`, in character space.
fn moved(bones: &Bones, child: usize, joint: Rotation, point: Vec3) -> Vec3 {
    let plan = &plans(bones)[child - 1];
    let (bind, parent) = at_bind(bones, plan);
    let pivot = bones.list[child].head;
    let turn = parent * joint * bind.inverse() * parent.inverse();
    pivot + turn * (point - pivot)
}

fn hinge(plan: &JointPlan) -> Range {
    match plan.def.kind {
        JointKind::Hinge { limit: Some(limit) } => limit,
        other => panic!("not a hinge: {other:?}"),
    }
}

#[test]
fn knees_bend_backward_and_elbows_forward() {
    for drop in [0.0, 0.7, 1.4] {
        let bones = person(drop);
        let bend = Rotation::from_axis_angle(Vec3::X, 90f32.to_radians());
        for side in [Side::Left, Side::Right] {
            let knee = index(&bones, Role::LowerLeg(side));
            let ankle = bones.list[index(&bones, Role::Foot(side))].head;
            let foot = moved(&bones, knee, bend, ankle);
            let back = Vec3::new(ankle.x, 0.52, -0.43);
            assert!((foot - back).length() < 1e-3, "{side:?}: the ankle is at {foot}");

            let elbow = index(&bones, Role::LowerArm(side));
            let wrist = bones.list[index(&bones, Role::Hand(side))].head;
            let hand = moved(&bones, elbow, bend, wrist);
            let front = bones.list[elbow].head + Vec3::Z * 0.27;
            assert!((hand - front).length() < 1e-3, "{side:?} at {drop}: the wrist is at {hand}");
        }
    }
}

#[test]
fn hinge_limits_equal_the_table() {
    let bones = person(0.7);
    let plans = plans(&bones);
    let knee = &plans[index(&bones, Role::LowerLeg(Side::Left)) - 1];
    assert!((hinge(knee).hi.to_degrees() - 142.0).abs() < 1e-3);
    assert!((hinge(knee).lo.to_degrees() + 2.0).abs() < 1e-3);
    assert!(hinge_angle(at_bind(&bones, knee).0).abs() < 1e-3, "straight legs must be at 0");
}

#[test]
fn hinge_angle_of_a_bent_bind_pose_counts_from_straight() {
    let mut bones = person(0.7);
    // The left shank points 30° backward.
    let knee = index(&bones, Role::LowerLeg(Side::Left));
    let ankle = index(&bones, Role::Foot(Side::Left));
    let angle = 30f32.to_radians();
    bones.list[ankle].head =
        bones.list[knee].head + Vec3::new(0.0, -trig::cos(angle), -trig::sin(angle)) * 0.43;
    let plan = &plans(&bones)[knee - 1];
    assert!((hinge_angle(at_bind(&bones, plan).0).to_degrees() - 30.0).abs() < 0.1);
    assert!(
        (hinge(plan).hi.to_degrees() - 142.0).abs() < 1e-3,
        "142° must count from straight, not from the bind pose"
    );
}

#[test]
fn hips_reach_farther_forward_than_back() {
    let bones = person(0.7);
    for side in [Side::Left, Side::Right] {
        let thigh = index(&bones, Role::UpperLeg(side));
        let plan = &plans(&bones)[thigh - 1];
        let (bind, parent) = at_bind(&bones, plan);
        let JointKind::Ball { limit: Some(limit) } = plan.def.kind else { panic!("a hip is a ball joint") };
        let beyond = |turn: Vec3| {
            let turned = Rotation::from_scaled_axis(turn) * parent * bind;
            limit.overshoot(parent.inverse() * turned).to_degrees()
        };
        let out = if side == Side::Left { 1.0 } else { -1.0 };
        assert_eq!(beyond(Vec3::ZERO), 0.0, "standing");
        assert_eq!(beyond(-Vec3::X * 110f32.to_radians()), 0.0, "110° forward");
        assert!(beyond(Vec3::X * 40f32.to_radians()) > 10.0, "40° back");
        assert_eq!(beyond(Vec3::Z * out * 30f32.to_radians()), 0.0, "30° outward");
        assert!(
            beyond(-Vec3::Z * out * 50f32.to_radians()) > 10.0,
            "50° across the other leg must be out of reach"
        );
    }
}

#[test]
fn shoulders_reach_the_same_places_from_any_bind_pose() {
    let reach = |drop: f32, side: Side, direction: Vec3| {
        let bones = person(drop);
        let arm = index(&bones, Role::UpperArm(side));
        let plan = &plans(&bones)[arm - 1];
        let (bind, parent) = at_bind(&bones, plan);
        let JointKind::Ball { limit: Some(limit) } = plan.def.kind else { panic!("a ball joint") };
        let now = bones.direction(arm, None);
        let turned = Rotation::from_arc(now, direction) * parent * bind;
        -limit.swing_state(parent.inverse() * turned).slack
    };
    for side in [Side::Left, Side::Right] {
        let out = if side == Side::Left { Vec3::X } else { -Vec3::X };
        for drop in [0.0, 0.7, 1.3] {
            for inside in [-Vec3::Y, out, Vec3::Z] {
                let beyond = reach(drop, side, inside);
                assert!(beyond < 0.0, "{side:?} bound at {drop}: {inside} is {beyond} rad out of reach");
            }
            let behind = (-Vec3::Z * 0.9 - out * 0.43).normalize();
            assert!(
                reach(drop, side, behind) > 0.1,
                "{side:?} bound at {drop}: the hand reaches behind the back"
            );
        }
    }
}

#[test]
fn right_is_the_mirror_image_of_left() {
    let bones = person(0.4);
    let plans = plans(&bones);
    for bone in 0..bones.list.len() {
        let Some(twin) = bones.twin(bone).filter(|_| bones.list[bone].role.is_left()) else { continue };
        let (l, r) = (&plans[bone - 1].def, &plans[twin - 1].def);
        match (l.kind, r.kind) {
            (JointKind::Hinge { limit: Some(a) }, JointKind::Hinge { limit: Some(b) }) => {
                assert!((a.lo - b.lo).abs() < 1e-4 && (a.hi - b.hi).abs() < 1e-4);
            }
            (JointKind::Ball { limit: Some(a) }, JointKind::Ball { limit: Some(b) })
            | (JointKind::Universal { limit: Some(a) }, JointKind::Universal { limit: Some(b) }) => {
                assert_eq!(a.swing_y, b.swing_y);
                assert_eq!((a.swing_z.lo, a.swing_z.hi), (-b.swing_z.hi, -b.swing_z.lo));
                assert_eq!((a.twist.lo, a.twist.hi), (-b.twist.hi, -b.twist.lo));
            }
            other => panic!("the two sides have different kinds: {other:?}"),
        }
        // A mirror keeps the x component of a rotation axis and negates the others. The same holds for a rotation's
        // vector part.
        let (a, b) = (at_bind(&bones, &plans[bone - 1]).1, at_bind(&bones, &plans[twin - 1]).1);
        let along = |frame: Rotation| frame * Vec3::X;
        let mirrored = if matches!(l.kind, JointKind::Hinge { .. }) {
            Vec3::new(along(a).x, -along(a).y, -along(a).z)
        } else {
            Vec3::new(-along(a).x, along(a).y, along(a).z)
        };
        assert!((mirrored - along(b)).length() < 1e-4, "{:?}", bones.list[bone].role);
    }
}

#[test]
fn every_bind_pose_is_within_the_limits() {
    for drop in [-1.5, -0.5, 0.0, 0.7, 1.5] {
        let bones = person(drop);
        for plan in plans(&bones) {
            let (joint, _) = at_bind(&bones, &plan);
            let beyond = match plan.def.kind {
                JointKind::Ball { limit: Some(limit) } => limit.overshoot(joint),
                JointKind::Universal { limit: Some(limit) } => -limit.swing_state(joint).slack,
                JointKind::Hinge { limit: Some(limit) } => limit.excess(hinge_angle(joint)),
                _ => 0.0,
            };
            assert!(
                beyond <= 0.0,
                "{:?} at {drop}: {beyond} beyond the limit",
                bones.list[plan.def.child].role
            );
        }
    }
}

/// Bodies are 5 kg centred 0.1 m below the joint and 3 kg 0.4 m above it; the joint carries at most the smaller of the
/// two moments. Its friction is a fifth of this moment, or the table's torque if that is larger.
#[test]
fn creature_joint_friction_follows_the_carried_moment() {
    let list = vec![
        Bone::new(0, Role::SpineSegment(0), None, Vec3::ZERO),
        Bone::new(1, Role::SpineSegment(1), Some(0), Vec3::Y),
    ];
    let bones = |anatomy| Bones::new(list.clone(), anatomy, 1.75);
    let mass = |mass: f32| MassProperties { mass, ..MassProperties::default() };
    let masses = [mass(5.0), mass(3.0)];
    let torque = |anatomy, total: f32| {
        let bones = bones(anatomy);
        let mut fits = fits(&bones);
        for (fit, height) in fits.iter_mut().zip([0.9, 1.4]) {
            fit.character_from_body.translation = Vec3::Y * height;
        }
        let plans = joints(&bones, &fits, total);
        (friction_torques(&bones, &fits, &masses, &plans)[0], plans[0].def.friction_torque)
    };
    let (resists, table) = torque(Anatomy::Creature, 8.0);
    assert!(
        table < 0.5 && (resists - 0.2 * 9.81 * 0.5).abs() < 1e-4,
        "friction {resists} N·m, in the table {table} N·m"
    );
    let (resists, table) = torque(Anatomy::Creature, 800.0);
    assert!(resists == table && table > 5.0, "friction {resists} N·m, in the table {table} N·m");
    let (resists, table) = torque(Anatomy::Human, 8.0);
    assert_eq!(resists, table);
}
