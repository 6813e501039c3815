//! Defects known from ragdolls of other tools, injected into a healthy ragdoll: the doctor reports exactly the injected
//! defect and repairs it.

use crate::actor::walker;
use needs_data::needs_data;
use sinew_math::{Range, Rotation, SwingTwistLimit, Sym3, Transform, Vec3};
use sinew_physics::{Hull, JointKind, MassProperties, Shape, Softness};
use sinew_ragdoll::doctor::{Code, Finding, Severity, limit_reach};
use sinew_ragdoll::skin::FlawKind;
use sinew_ragdoll::{
    BuildOptions, Flaw, RagdollBodyDef, RagdollDef, RagdollJointDef, Repair, Verdict, build, cure, doctor,
    drop_test, gate,
};

/// Returns a healthy ragdoll with its rig.
fn healthy() -> Repair {
    let def = walker().ragdoll;
    Repair { reference: Some(def.clone()), ..Repair::new(def) }
}

/// Returns the healthy ragdoll of a rig from another author, if the data are present.
fn healthy_other_ragdoll() -> Repair {
    let rig = crate::data::rig("mannequiny.glb");
    let analysis = sinew_anim::analyze(&rig).expect("the rig has a skin");
    let (def, _) = build(&rig, &analysis, &BuildOptions::default()).expect("the rig can be built");
    Repair { reference: Some(def.clone()), ..Repair::new(def) }
}

fn body(def: &RagdollDef, role: &str) -> usize {
    def.bodies.iter().position(|body| body.role == role).unwrap_or_else(|| panic!("no {role}"))
}

fn joint<'a>(repair: &'a mut Repair, role: &str) -> &'a mut RagdollJointDef {
    let body = body(&repair.def, role);
    &mut repair.def.joints[body - 1]
}

fn cone(y: f32, z: f32, twist: [f32; 2]) -> JointKind {
    let half = |degrees: f32| Range::degrees(-degrees, degrees);
    let limit =
        SwingTwistLimit { swing_y: half(y), swing_z: half(z), twist: Range::degrees(twist[0], twist[1]) };
    JointKind::Ball { limit: Some(limit) }
}

/// Sets up a joint as other tools do: the bind pose is its zero.
fn zeroed(repair: &mut Repair, role: &str, kind: JointKind) {
    let def = &repair.def;
    let joint = def.joints[body(def, role) - 1];
    let turn = |body: usize| def.bodies[body].character_from_body.rotation;
    let axes = turn(joint.child) * joint.frame_child.rotation;
    let rotation = turn(joint.parent).inverse() * axes;
    let frame_parent = Transform { rotation, ..joint.frame_parent };
    *self::joint(repair, role) = RagdollJointDef { frame_parent, kind, ..joint };
}

fn every_joint(repair: &mut Repair, kind: JointKind) {
    for child in 1..repair.def.bodies.len() {
        let role = repair.def.bodies[child].role.clone();
        zeroed(repair, &role, kind);
    }
}

/// Removes these bodies; nothing else may be attached to them.
fn without(repair: &mut Repair, roles: &[&str]) {
    let def = &mut repair.def;
    for role in roles {
        let gone = body(def, role);
        assert!(def.joints.iter().all(|joint| joint.parent != gone), "another body has the role {role}");
        def.bodies.remove(gone);
        def.joints.remove(gone - 1);
        let moved = |body: &mut usize| *body -= usize::from(*body > gone);
        def.joints.iter_mut().for_each(|joint| {
            moved(&mut joint.parent);
            moved(&mut joint.child);
        });
        def.disabled_pairs.retain(|&(a, b)| a != gone && b != gone);
        def.disabled_pairs.iter_mut().for_each(|(a, b)| {
            moved(a);
            moved(b);
        });
    }
}

fn thicker(repair: &mut Repair, role: &str, factor: f32) {
    let body = body(&repair.def, role);
    let shape = &mut repair.def.bodies[body].shape;
    *shape = match *shape {
        Shape::Capsule { half_height, radius } => Shape::Capsule { half_height, radius: factor * radius },
        Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => Shape::TaperedCapsule {
            half_height,
            radius_bottom: factor * radius_bottom,
            radius_top: factor * radius_top,
        },
        Shape::Box { half_extents } => Shape::Box { half_extents: half_extents * factor },
        ref other => panic!("{role} is a {other:?}"),
    };
}

type Plant = (&'static str, Code, fn(&mut Repair));

/// Defects of other tools: code, and function that injects the defect into a definition.
const DEFECTS: [Plant; 28] = [
    ("UE: every generated limit is 45°", Code::LimitsAllAlike, |p| {
        every_joint(p, cone(45.0, 45.0, [-45.0, 45.0]));
    }),
    ("Unity: a limit below 5°", Code::LimitTooNarrow, |p| {
        zeroed(p, "neck", cone(2.0, 2.0, [-30.0, 30.0]));
    }),
    ("Unity: 20 kg in all", Code::MassImplausible, |p| scale_mass(p, 20.0 / p.def.total_mass)),
    ("Unity: masses that ask for massScale", Code::MassRatio, |p| {
        let hand = body(&p.def, "leftHand");
        p.def.bodies[hand].mass.mass *= 0.02;
        p.def.bodies[hand].mass.inertia = p.def.bodies[hand].mass.inertia * 0.02;
    }),
    ("Jolt: a knee that bends both ways", Code::BendsBothWays, |p| {
        joint(p, "leftLowerLeg").kind = JointKind::Hinge { limit: Some(Range::degrees(-60.0, 60.0)) };
    }),
    ("Jolt: its cone for a knee", Code::BendsBothWays, |p| {
        zeroed(p, "rightLowerLeg", cone(60.0, 15.0, [-10.0, 10.0]));
    }),
    ("Box3D: thighs whose twists are no mirror images", Code::LimitsNotMirrored, |p| {
        zeroed(p, "leftUpperLeg", cone(50.0, 40.0, [-60.0, 40.0]));
        zeroed(p, "rightUpperLeg", cone(50.0, 40.0, [-30.0, 60.0]));
    }),
    ("Godot: joints without limits", Code::LimitsMissing, |p| {
        every_joint(p, JointKind::Ball { limit: None });
    }),
    ("SMPL: ±180° everywhere", Code::LimitsMissing, |p| {
        every_joint(p, cone(180.0, 180.0, [-180.0, 180.0]));
    }),
    ("Godot: the head is a leaf, and has no body", Code::HeadWithoutBody, |p| without(p, &["head"])),
    ("Godot: only the first child gets a body", Code::LimbWithoutBody, |p| {
        without(p, &["rightHand", "rightLowerArm", "rightUpperArm"]);
    }),
    ("Godot: a forearm without its hand", Code::LimbWithoutBody, |p| without(p, &["rightHand"])),
    ("shock2quest: bodies overlap at spawn", Code::OverlapAtStart, |p| {
        thicker(p, "leftUpperLeg", 1.9);
        thicker(p, "rightUpperLeg", 1.9);
    }),
    ("shock2quest: no self-collision", Code::NoSelfCollision, |p| {
        let count = p.def.bodies.len();
        p.def.disabled_pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b))).collect();
    }),
    ("shock2quest: frames without rotation", Code::IdentityFrames, |p| {
        for role in ["leftFoot", "rightFoot"] {
            let joint = joint(p, role);
            joint.frame_parent = Transform::from_translation(joint.frame_parent.translation);
            joint.frame_child = Transform::from_translation(joint.frame_child.translation);
        }
    }),
    ("frames at the origins of both bodies", Code::IdentityFrames, |p| {
        let joint = joint(p, "leftLowerLeg");
        (joint.frame_parent, joint.frame_child) = (Transform::IDENTITY, Transform::IDENTITY);
    }),
    ("shock2quest: the hip is anchored at the pelvis's origin", Code::AnchorsApart, |p| {
        joint(p, "leftUpperLeg").frame_parent.translation = Vec3::ZERO;
    }),
    ("the thigh swings about the pelvis's origin", Code::PivotOffBone, |p| {
        let (pelvis, thigh) = (p.def.bodies[0].character_from_body, body(&p.def, "leftUpperLeg"));
        let thigh = p.def.bodies[thigh].character_from_body;
        let joint = joint(p, "leftUpperLeg");
        joint.frame_parent.translation = Vec3::ZERO;
        joint.frame_child.translation = thigh.inverse_point(pelvis.translation);
    }),
    ("stretch: an elbow torn open by 5 cm", Code::AnchorsApart, |p| {
        joint(p, "leftLowerArm").frame_child.translation += Vec3::Y * 0.05;
    }),
    ("an elbow whose range leaves out the bind pose", Code::LimitViolatedAtBind, |p| {
        joint(p, "leftLowerArm").kind = JointKind::Hinge { limit: Some(Range::degrees(60.0, 140.0)) };
    }),
    ("a file in centimetres", Code::WrongUnit, |p| enlarge(p, 100.0)),
    ("a file in inches taken as metres", Code::WrongUnit, |p| enlarge(p, 39.37)),
    ("a forearm like a wire", Code::TinyShape, |p| {
        let forearm = body(&p.def, "leftLowerArm");
        p.def.bodies[forearm].shape = Shape::Capsule { half_height: 0.1, radius: 0.0005 };
    }),
    ("a hand of 3 m", Code::HugeShape, |p| {
        let hand = body(&p.def, "leftHand");
        p.def.bodies[hand].shape = Shape::Box { half_extents: Vec3::new(0.02, 1.5, 0.04) };
        let mass = &mut p.def.bodies[hand].mass;
        mass.inertia = Sym3::from_diagonal(Vec3::new(0.1, 0.1, 0.1));
    }),
    ("a shank half as thick again as the other", Code::SidesDiffer, |p| {
        thicker(p, "leftLowerLeg", 1.45);
    }),
    ("an inertia of another body", Code::InertiaOutOfProportion, |p| {
        let thigh = body(&p.def, "leftUpperLeg");
        p.def.bodies[thigh].mass.inertia = p.def.bodies[thigh].mass.inertia * 60.0;
    }),
    ("a motor of 400 Hz", Code::StiffnessAboveNyquist, |p| {
        p.springs = vec![None; p.def.joints.len()];
        p.springs[2] = Some(Softness::Frequency { hertz: 400.0, damping_ratio: 1.0 });
    }),
    ("a foot without mass", Code::MassNotPositive, |p| {
        let foot = body(&p.def, "leftFoot");
        p.def.bodies[foot].mass = MassProperties { mass: 0.0, ..MassProperties::default() };
    }),
];

fn scale_mass(repair: &mut Repair, factor: f32) {
    for body in &mut repair.def.bodies {
        body.mass.mass *= factor;
        body.mass.inertia = body.mass.inertia * factor;
    }
    repair.def.total_mass *= factor;
}

fn enlarge(repair: &mut Repair, factor: f32) {
    let def = &mut repair.def;
    let place = |at: &mut Transform| at.translation *= factor;
    for body in &mut def.bodies {
        place(&mut body.character_from_body);
        body.shape = match body.shape {
            Shape::Box { half_extents } => Shape::Box { half_extents: half_extents * factor },
            Shape::Capsule { half_height, radius } => {
                Shape::Capsule { half_height: half_height * factor, radius: radius * factor }
            }
            Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => Shape::TaperedCapsule {
                half_height: half_height * factor,
                radius_bottom: radius_bottom * factor,
                radius_top: radius_top * factor,
            },
            Shape::Sphere { radius } => Shape::Sphere { radius: radius * factor },
            Shape::Hull(ref hull) => {
                let corners: Vec<Vec3> = hull.vertices().iter().map(|&corner| corner * factor).collect();
                Shape::Hull(Hull::new(&corners).expect("as good as it was").into())
            }
            ref other => panic!("{other:?}"),
        };
        body.mass.center *= factor;
        body.mass.inertia = body.mass.inertia * (factor * factor);
    }
    for joint in &mut def.joints {
        place(&mut joint.frame_parent);
        place(&mut joint.frame_child);
    }
    def.height *= factor;
    def.unit_scale *= factor;
}

fn codes(findings: &[Finding]) -> Vec<Code> {
    let mut codes: Vec<Code> = findings.iter().map(|finding| finding.code).collect();
    codes.sort_unstable();
    codes.dedup();
    codes
}

#[test]
fn healthy_ragdoll_has_no_findings() {
    assert_eq!(doctor(&healthy()), []);
    assert_eq!(doctor(&Repair::new(walker().ragdoll)), []);
}

#[test]
fn each_defect_is_reported_alone() {
    let mut wrong = Vec::new();
    for (what, code, plant) in DEFECTS {
        let mut repair = healthy();
        plant(&mut repair);
        let findings = doctor(&repair);
        if codes(&findings) != [code] {
            wrong.push(format!("{what}: {findings:#?}"));
        }
        for finding in &findings {
            // The finding names the affected body, unless it concerns the whole ragdoll.
            let named = finding.bodies.first().map(|&body| repair.def.bodies[body].role.as_str());
            let is_told = named.is_none_or(|role| finding.evidence.contains(role));
            let of_all = matches!(code, Code::MassImplausible | Code::LimitsAllAlike);
            assert!(is_told || of_all, "{what}: {}", finding.evidence);
            assert!(!finding.fixed && !finding.bones.is_empty(), "{what}");
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The doctor also finds the defects on a body of other proportions, in another pose, with collar bones.
#[needs_data]
#[test]
fn defects_of_a_foreign_rig_are_reported() {
    let stranger = healthy_other_ragdoll();
    assert_eq!(doctor(&stranger), []);
    let mut wrong = Vec::new();
    for (what, code, plant) in DEFECTS {
        let mut repair = stranger.clone();
        plant(&mut repair);
        let findings = doctor(&repair);
        let (cured, findings_after) = cure(&repair);
        let left = doctor(&cured);
        if codes(&findings) != [code]
            || !left.is_empty()
            || findings_after.iter().any(|finding| !finding.fixed)
        {
            wrong.push(format!("{what}: {findings:#?} left: {left:#?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn defects_are_repaired_and_the_ragdoll_falls_well() {
    let stride = if std::env::var_os("SINEW_FULL").is_some() { 1 } else { 5 };
    let mut wrong = Vec::new();
    for (index, (what, code, plant)) in DEFECTS.into_iter().enumerate() {
        let mut repair = healthy();
        plant(&mut repair);
        let (cured, findings) = cure(&repair);
        let left = doctor(&cured);
        if !findings.iter().all(|finding| finding.fixed) || !left.is_empty() {
            wrong.push(format!("{what} ({}): {findings:#?} left: {left:#?}", code.name()));
            continue;
        }
        let fallen = gate(&cured.def, 1);
        assert_eq!(fallen.worst.nan, 0, "{what}");
        assert!(fallen.worst.energy_gain_max < 0.02, "{what}: {:?}", fallen.worst);
        if index % stride == 0 {
            falls_well(&cured.def, what);
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Checks eight drops and a wall impact: energy does not grow, no joint opens, and the ragdoll comes to rest.
fn falls_well(def: &RagdollDef, what: &str) {
    let report = drop_test(def);
    assert_eq!(report.drop.nan + report.wall.nan, 0, "{what}");
    let gap = sinew_math::max(report.drop.joint_gap_max_m, report.wall.joint_gap_max_m);
    assert!(gap < 5e-3 && report.drop.asleep_s.is_some(), "{what}: {:?}", report.reasons);
    let gain = sinew_math::max(report.drop.energy_gain_max, report.wall.energy_gain_max);
    assert!(gain < 0.02, "{what}: the energy rose by {gain}");
}

/// Findings of severity error are harmful: the simulation shows the harm.
#[test]
fn findings_of_severity_error_show_in_simulation() {
    let mut wrong = Vec::new();
    for (what, code, plant) in DEFECTS {
        if !matches!(code, Code::OverlapAtStart | Code::AnchorsApart | Code::LimitViolatedAtBind) {
            continue;
        }
        let mut repair = healthy();
        plant(&mut repair);
        let findings = doctor(&repair);
        assert_eq!(findings[0].severity, Severity::Error, "{what}");
        if !findings[0].evidence.contains("left alone without gravity") {
            wrong.push(format!("{what}: {findings:#?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Returns three upright pieces; the last is folded back to 120° relative to the second one, and its hinge can turn
/// further by `range`.
fn folding(range: Range) -> RagdollDef {
    let piece = |role: &str, x: f32, z: f32| {
        let shape = Shape::Capsule { half_height: 0.12, radius: 0.05 };
        RagdollBodyDef {
            bone: role.into(),
            joint: 0,
            merged: Vec::new(),
            role: role.into(),
            confidence: 1.0,
            mass: shape.mass_properties(1000.0),
            shape,
            character_from_body: Transform::from_translation(Vec3::new(x, 0.2, z)),
        }
    };
    let (sin, cos) = sinew_math::trig::sin_cos(120.0_f32.to_radians());
    // The piece moves on a circle of 14 cm about x = 10 cm: at 180° it would be 4 cm behind the centre of the first
    // piece.
    let (x, z) = (0.1 + 0.14 * cos, -0.14 * sin);
    let bodies = vec![piece("limb_0_0", 0.0, 0.0), piece("limb_0_1", 0.12, 0.0), piece("limb_0_2", x, z)];
    // Create a hinge about y, at the given points of both bodies.
    let upright = sinew_math::Rotation::from_arc(Vec3::X, Vec3::Y);
    let hinge = |parent: usize, at: Vec3, range: Range| {
        let frame = |body: usize| Transform::new(bodies[body].character_from_body.inverse_point(at), upright);
        RagdollJointDef {
            parent,
            child: parent + 1,
            frame_parent: frame(parent),
            frame_child: frame(parent + 1),
            kind: JointKind::Hinge { limit: Some(range) },
            friction_torque: 0.1,
        }
    };
    let joints = vec![
        hinge(0, Vec3::new(0.06, 0.2, 0.0), Range::degrees(-20.0, 20.0)),
        hinge(1, Vec3::new(0.1, 0.2, 0.0), range),
    ];
    let total_mass = bodies.iter().map(|body| body.mass.mass).sum();
    let height = 0.4;
    RagdollDef {
        bodies,
        joints,
        total_mass,
        height,
        unit_scale: 1.0,
        up_axis: Vec3::Y,
        ..RagdollDef::default()
    }
}

#[test]
fn contact_against_a_limit_is_reported() {
    let free = Repair::new(folding(Range::degrees(-60.0, 10.0)));
    assert_eq!(doctor(&free), []);
    let folded = Repair::new(folding(Range::degrees(-2.0, 60.0)));
    let findings = doctor(&folded);
    assert_eq!(codes(&findings), [Code::CollisionFightsLimit], "{findings:#?}");
    let (cured, _) = cure(&folded);
    assert_eq!(doctor(&cured), []);
    assert_eq!(cured.def.disabled_pairs, [(0, 2)]);
}

/// Returns a tail of hinges, each 0.9° beyond its limit: too little for a finding each.
fn strained() -> RagdollDef {
    let link = |index: u8| {
        let shape = Shape::Capsule { half_height: 0.03, radius: 0.02 };
        RagdollBodyDef {
            bone: format!("tail {index}"),
            joint: index.into(),
            merged: Vec::new(),
            role: format!("tail_{index}"),
            confidence: 1.0,
            mass: shape.mass_properties(1000.0),
            shape,
            character_from_body: Transform::from_translation(Vec3::Y * (0.05 + 0.1 * f32::from(index))),
        }
    };
    let bodies: Vec<RagdollBodyDef> = (0..12).map(link).collect();
    let hinge = |parent: usize| RagdollJointDef {
        parent,
        child: parent + 1,
        frame_parent: Transform::from_translation(Vec3::Y * 0.05),
        frame_child: Transform::from_translation(Vec3::Y * -0.05),
        kind: JointKind::Hinge { limit: Some(Range::degrees(0.9, 30.0)) },
        friction_torque: 0.0,
    };
    let joints = (0..11).map(hinge).collect();
    let total_mass = bodies.iter().map(|body| body.mass.mass).sum();
    let (height, up_axis) = (1.2, Vec3::Y);
    RagdollDef { bodies, joints, total_mass, height, unit_scale: 1.0, up_axis, ..RagdollDef::default() }
}

#[test]
fn self_motion_is_found_by_simulation() {
    let repair = Repair::new(strained());
    let findings = doctor(&repair);
    assert_eq!(codes(&findings), [Code::MovesByItself], "{findings:#?}");
    let (cured, findings_after) = cure(&repair);
    assert!(findings_after[0].fixed && doctor(&cured).is_empty(), "{findings_after:#?}");
}

#[test]
fn non_finite_numbers_are_reported_without_panics() {
    let mut repair = healthy();
    repair.def.bodies[3].character_from_body.translation.x = f32::NAN;
    let findings = doctor(&repair);
    assert_eq!(codes(&findings), [Code::NotFinite]);
    let (cured, findings) = cure(&repair);
    assert!(!findings[0].fixed && cured.def.bodies.len() == repair.def.bodies.len());
    let mut heavy = healthy();
    heavy.def.bodies[3].mass.mass = f32::INFINITY;
    assert_eq!(codes(&doctor(&heavy)), [Code::MassNotPositive]);
}

/// A head cannot be added without the rig; the report has a note on it.
#[test]
fn irreparable_defect_is_reported() {
    let mut repair = healthy();
    repair.reference = None;
    without(&mut repair, &["head"]);
    let (_, findings) = cure(&repair);
    assert_eq!(codes(&findings), [Code::HeadWithoutBody]);
    assert!(!findings[0].fixed);
}

#[test]
fn codes_have_distinct_names() {
    let mut names: Vec<&str> = Code::ALL.iter().map(|code| code.name()).collect();
    let kebab = |name: &str| name.chars().all(|c| c.is_ascii_lowercase() || c == '-');
    assert!(names.iter().all(|name| kebab(name)), "{names:?}");
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), Code::ALL.len());
}

/// The table of codes in the docs matches the code.
#[test]
fn the_page_lists_every_code() {
    let page = include_str!("../../../../docs/ragdoll.md");
    for code in Code::ALL {
        let (name, severity) = (code.name(), code.severity().name());
        let row = format!("| `{name}` | {severity} | {} | {} |\n", code.cause(), code.fix());
        assert!(page.contains(&row), "docs/ragdoll.md lacks\n{row}");
    }
}

/// From the centre of its cone, a joint can rotate to the ends of the cone; from another rotation, through the
/// remaining range.
#[test]
fn joint_reach_follows_its_limits() {
    let limit = SwingTwistLimit {
        swing_y: Range::degrees(-20.0, 50.0),
        swing_z: Range::degrees(-30.0, 10.0),
        twist: Range::degrees(-40.0, 70.0),
    };
    let ball = JointKind::Ball { limit: Some(limit) };
    let reach = |kind: &JointKind, bind, axis| limit_reach(kind, bind, axis).to_degrees();
    let middle = Rotation::IDENTITY;
    for (axis, degrees) in [
        (Vec3::X, 70.0),
        (-Vec3::X, 40.0),
        (Vec3::Y, 50.0),
        (-Vec3::Y, 20.0),
        (Vec3::Z, 10.0),
        (-Vec3::Z, 30.0),
    ] {
        let found = reach(&ball, middle, axis);
        assert!((found - degrees).abs() < 0.02, "{axis}: {found}");
    }
    let bent = Rotation::from_axis_angle(Vec3::X, 25.0_f32.to_radians());
    let hinge = JointKind::Hinge { limit: Some(Range::degrees(-2.0, 140.0)) };
    assert!((reach(&hinge, bent, Vec3::X) - 115.0).abs() < 0.02);
    assert!((reach(&hinge, bent, -Vec3::X) - 27.0).abs() < 0.02);
    assert_eq!(limit_reach(&JointKind::Ball { limit: None }, middle, Vec3::Y), core::f32::consts::PI);
}

/// The remedy for a knee names a range that leads to no other finding.
#[test]
fn advice_on_a_knee_leads_to_no_other_finding() {
    let ranges = |repair: &Repair| -> Vec<(Code, String)> {
        let of_joints = [Code::BendsBothWays, Code::LimitViolatedAtBind];
        let found = doctor(repair).into_iter().filter(|found| of_joints.contains(&found.code));
        found.map(|found| (found.code, found.fix)).collect()
    };
    for bend in [-60_f32, -29.0] {
        let mut repair = healthy();
        joint(&mut repair, "leftLowerArm").kind =
            JointKind::Hinge { limit: Some(Range::degrees(bend, 142.0)) };
        let found = ranges(&repair);
        assert_eq!(found.len(), 1, "{found:?}");
        let (_, range) = found[0].1.split_once("\"twist\": [").expect("a range");
        let (lo, rest) = range.split_once(", ").expect("two numbers");
        let (hi, _) = rest.split_once(']').expect("an end");
        let [lo, hi] = [lo, hi].map(|number| number.parse::<f32>().expect("a number"));
        joint(&mut repair, "leftLowerArm").kind = JointKind::Hinge { limit: Some(Range::degrees(lo, hi)) };
        assert_eq!(ranges(&repair), [], "{lo} to {hi}");
    }
}

/// A finding on the skin names the bone in its remedy, as the judge does.
#[test]
fn remedy_for_skin_names_the_bone() {
    let flaw = Flaw {
        kind: FlawKind::Uncovered,
        evidence: "80 % of the skin is near its body".to_owned(),
        remedy: "--body Ear1.L gives that part a body of its own".to_owned(),
        bodies: vec![0],
        bones: vec!["Head".to_owned()],
        at_most: Verdict::Usable,
    };
    let repair = Repair { skin: vec![flaw.clone()], ..healthy() };
    let found = doctor(&repair);
    let skin =
        found.iter().find(|found| found.code == Code::SkinUncovered).expect("the doctor reports a finding");
    assert_eq!(skin.fix, flaw.remedy);
}
