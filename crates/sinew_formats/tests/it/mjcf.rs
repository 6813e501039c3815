//! MJCF: compares MuJoCo's humanoid with MuJoCo and small models with closed forms, and tests malicious bytes.

use crate::data::shared_data;
use core::f32::consts::FRAC_1_SQRT_2 as H;
use needs_data::needs_data;
use sinew_formats::mjcf::MjcfJoint;
use sinew_formats::{Error, MjcfModel, read_mjcf};
use sinew_math::{Random, Range, Rotation, SwingTwistLimit, Transform, Vec3, max};
use sinew_physics::{
    AxisMotion, BodyKind, JointCollision, JointKind, Shape, Softness, Spring, World, WorldDef,
};

fn humanoid_text() -> String {
    let path = shared_data().join("robots/mujoco_humanoid.xml");
    std::fs::read_to_string(path).expect("the humanoid is there")
}

fn humanoid() -> MjcfModel {
    read_mjcf(humanoid_text().as_bytes()).expect("the model can be read")
}

/// Converts from MuJoCo's axes to ours.
fn y_up([x, y, z]: [f32; 3]) -> Vec3 {
    Vec3::new(x, z, -y)
}

fn assert_close(found: Vec3, expected: Vec3, tolerance: f32, what: &str) {
    assert!((found - expected).length() <= tolerance, "{what}: {found}, expected {expected}");
}

/// Name, mass, centre of mass in the body's frame, trace of the inertia, position in the world; computed by
/// MuJoCo 4.0.0.
type BodyRow = (&'static str, f32, [f32; 3], f32, [f32; 3]);

const BODIES: [BodyRow; 16] = [
    ("torso", 5.853834, [-0.00386, 0.0, -0.04637], 0.114390, [0.0, 0.0, 1.282]),
    ("head", 3.053628, [0.0; 3], 0.029681, [0.0, 0.0, 1.472]),
    ("waist_lower", 2.261947, [0.0; 3], 0.023452, [-0.01, 0.0, 1.022]),
    ("pelvis", 6.616194, [-0.02, 0.0, 0.0], 0.128958, [-0.01, 0.0, 0.857]),
    ("thigh_right", 4.751751, [0.0, 0.005, -0.17], 0.158131, [-0.01, -0.1, 0.817]),
    ("shin_right", 2.755696, [0.0, 0.0, -0.15], 0.068406, [-0.01, -0.09, 0.417]),
    ("foot_right", 1.131141, [0.035, 0.0, 0.0], 0.013293, [-0.01, -0.09, 0.027]),
    ("thigh_left", 4.751751, [0.0, -0.005, -0.17], 0.158131, [-0.01, 0.1, 0.817]),
    ("shin_left", 2.755696, [0.0, 0.0, -0.15], 0.068406, [-0.01, 0.09, 0.417]),
    ("foot_left", 1.131141, [0.035, 0.0, 0.0], 0.013293, [-0.01, 0.09, 0.027]),
    ("upper_arm_right", 1.661080, [0.08, -0.08, -0.08], 0.033096, [0.0, -0.17, 1.342]),
    ("lower_arm_right", 0.961458, [0.09, 0.09, 0.09], 0.017253, [0.18, -0.35, 1.162]),
    ("hand_right", 0.268083, [0.0; 3], 0.000515, [0.36, -0.17, 1.342]),
    ("upper_arm_left", 1.661080, [0.08, 0.08, -0.08], 0.033096, [0.0, 0.17, 1.342]),
    ("lower_arm_left", 0.961458, [0.09, -0.09, 0.09], 0.017253, [0.18, 0.35, 1.162]),
    ("hand_left", 0.268083, [0.0; 3], 0.000515, [0.36, 0.17, 1.342]),
];

#[needs_data]
#[test]
fn humanoid_bodies_match_mujoco() {
    let model = humanoid();
    assert_eq!(model.bodies.len(), 1 + BODIES.len());
    assert_eq!(model.bodies[0].def.kind, BodyKind::Static);
    assert_eq!(model.bodies[0].def.shapes[0].shape, Shape::HalfSpace);
    let mut total = 0.0;
    for ((name, mass, center, trace, place), body) in BODIES.into_iter().zip(&model.bodies[1..]) {
        assert_eq!(body.name, name);
        let found = body.def.mass.expect("a mass");
        assert!(
            (found.mass - mass).abs() < 1e-5 * mass,
            "{name}: mass {} kg, expected {mass} kg",
            found.mass
        );
        assert_close(found.center, y_up(center), 1e-5, name);
        let moments = found.inertia.diagonal;
        assert!((moments.x + moments.y + moments.z - trace).abs() < 2e-6, "{name}: {moments}");
        assert_close(body.def.position, y_up(place), 1e-6, name);
        total += found.mass;
    }
    assert!((total - 40.844_02).abs() < 1e-4, "{total} kg");
}

/// Compares the full tensors of two bodies whose principal axes are not the frame's with MuJoCo 4.0.0.
#[needs_data]
#[test]
fn inertia_is_rotated_with_the_body() {
    let model = humanoid();
    // Diagonal and (yz, xz, xy), in our axes.
    for (name, diagonal, off) in [
        ("torso", [0.051135, 0.031288, 0.031967], [0.0, 0.0, -0.001666]),
        ("thigh_right", [0.074952, 0.008285, 0.074894], [-0.001961, 0.0, 0.0]),
        ("upper_arm_right", [0.011032; 3], [0.004873, -0.004873, 0.004873]),
        ("lower_arm_left", [0.005751; 3], [-0.002651; 3]),
    ] {
        let inertia = model.bodies[model.body(name).expect(name)].def.mass.expect("a mass").inertia;
        assert_close(inertia.diagonal, Vec3::from_array(diagonal), 2e-6, name);
        assert_close(inertia.off, Vec3::from_array(off), 2e-6, name);
    }
}

fn joint<'a>(model: &'a MjcfModel, child: &str) -> &'a MjcfJoint {
    let child = model.body(child).expect("the body is there");
    model.joints.iter().find(|joint| joint.child == child).expect("the body has a joint to its parent")
}

#[needs_data]
#[test]
fn humanoid_joints_match_mujoco() {
    let model = humanoid();
    assert_eq!(model.joints.len(), 15);
    let pose = model.rest_pose();
    for (child, anchor, twist_axis) in [
        ("waist_lower", [-0.01, 0.0, 1.087], [0.0, 1.0, 0.0]),
        ("pelvis", [-0.01, 0.0, 0.957], [1.0, 0.0, 0.0]),
        ("thigh_right", [-0.01, -0.1, 0.817], [0.0, 1.0, 0.0]),
        ("shin_left", [-0.01, 0.09, 0.437], [0.0, -1.0, 0.0]),
        // Two hinges, 4 cm apart in the file.
        ("foot_right", [-0.01, -0.09, 0.087], [0.8944, 0.0, 0.4472]),
        ("upper_arm_left", [0.0, 0.17, 1.342], [0.0, -H, -H]),
        ("lower_arm_right", [0.18, -0.35, 1.162], [0.0, -H, H]),
    ] {
        let joint = joint(&model, child);
        for (body, frame) in [(joint.parent, joint.frame_a), (joint.child, joint.frame_b)] {
            let world = pose[body] * frame;
            assert_close(world.translation, y_up(anchor), 2e-6, child);
            assert_close(world.rotation * Vec3::X, y_up(twist_axis), 1e-4, child);
        }
    }
    assert_eq!(joint(&model, "head").kind, JointKind::Fixed);
    assert_eq!(joint(&model, "hand_left").kind, JointKind::Fixed);
    assert_eq!(joint(&model, "thigh_right").name, "hip_x_right+hip_z_right+hip_y_right");
}

fn assert_range(found: Range, lo: f32, hi: f32) {
    let expected = Range::degrees(lo, hi);
    assert!(max((found.lo - expected.lo).abs(), (found.hi - expected.hi).abs()) < 1e-6, "{found:?}");
}

/// Returns the limits of a joint that swings about one axis and twists.
fn two_ranges(joint: &MjcfJoint) -> [Range; 2] {
    let JointKind::SixDof(six) = joint.kind else { panic!("{:?}", joint.kind) };
    assert_eq!((six.linear, six.swing_z), ([AxisMotion::Locked; 3], AxisMotion::Locked));
    [six.swing_y, six.twist].map(|motion| match motion {
        AxisMotion::Limited(range) => range,
        _ => panic!("{motion:?}"),
    })
}

#[needs_data]
#[test]
fn humanoid_ranges_follow_its_classes() {
    let model = humanoid();
    let JointKind::Hinge { limit: Some(knee) } = joint(&model, "shin_right").kind else { panic!("a hinge") };
    assert_range(knee, -160.0, 2.0);
    let limit = |child: &str| match joint(&model, child).kind {
        JointKind::Ball { limit: Some(limit) } => limit,
        kind => panic!("{child}: {kind:?}"),
    };
    // Hips: twist about y, and swings about x and z. With right-handed axes, the z axis of one side points down.
    for (side, z) in [("thigh_right", (-35.0, 60.0)), ("thigh_left", (-35.0, 60.0))] {
        let hip = limit(side);
        assert_range(hip.twist, -150.0, 20.0);
        assert_range(hip.swing_y, -30.0, 10.0);
        assert_range(hip.swing_z, z.0, z.1);
    }
    for range in two_ranges(joint(&model, "upper_arm_left")) {
        assert_range(range, -85.0, 60.0);
    }
}

#[needs_data]
#[test]
fn disabled_pairs_match_mujoco() {
    let model = humanoid();
    let excluded = |a: &str, b: &str| {
        let (a, b) = (model.body(a).expect(a), model.body(b).expect(b));
        let joined = model.joints.iter().any(|joint| {
            let pair = (joint.parent, joint.child);
            (pair == (a, b) || pair == (b, a)) && joint.collision == JointCollision::Disabled
        });
        joined || model.excluded_pairs.contains(&(a.min(b), a.max(b)))
    };
    // Jointed bodies, bodies excluded by the file, a part of a part, and a part jointed to the whole.
    assert!(excluded("thigh_left", "shin_left") && excluded("waist_lower", "thigh_left"));
    assert!(excluded("head", "torso") && excluded("head", "upper_arm_left"));
    assert!(excluded("hand_right", "upper_arm_right") && excluded("head", "waist_lower"));
    assert!(!excluded("thigh_left", "thigh_right") && !excluded("hand_right", "torso"));
    assert!(!excluded("torso", "world") && !excluded("head", "pelvis"));
}

/// Compares the positions of bodies in keyframes with MuJoCo 4.0.0, without feet, whose two hinges are 4 cm apart
/// in the file.
#[needs_data]
#[test]
fn keyframes_match_mujoco() {
    let model = humanoid();
    for (keyframe, rows) in [
        (
            "prone",
            [
                ("torso", [0.4, 0.0, 0.0758], [0.7325, 0.0, 0.6808, 0.0]),
                ("pelvis", [-0.0252, 0.0, 0.0714], [0.7072, 0.0, 0.707, 0.0]),
                ("thigh_right", [-0.0652, -0.1, 0.0714], [0.7163, 0.0034, 0.6977, -0.0021]),
                ("shin_left", [-0.4639, 0.0869, 0.0678], [0.5835, -0.0037, 0.8121, 0.0015]),
                ("lower_arm_right", [0.1655, -0.2728, 0.0824], [-0.2941, -0.3456, 0.8463, -0.279]),
                ("hand_left", [-0.1301, 0.3611, 0.0375], [-0.2941, 0.3456, 0.8463, 0.279]),
            ],
        ),
        (
            "supine",
            [
                ("head", [-0.5898, 0.0, 0.0897], [0.7228, 0.0, -0.6911, 0.0]),
                ("waist_lower", [-0.142, 0.0, 0.0757], [0.631, 0.0, -0.7758, 0.0]),
                ("thigh_left", [0.0587, 0.1, 0.1175], [0.7397, 0.0015, -0.6728, -0.0114]),
                ("shin_right", [0.4568, -0.0847, 0.0803], [0.7255, -0.0013, -0.6882, 0.0115]),
                ("upper_arm_left", [-0.4599, 0.17, 0.0839], [0.8836, -0.1733, -0.4217, 0.1065]),
                ("hand_right", [0.0378, -0.5389, 0.0416], [0.7428, 0.3967, 0.2953, -0.4513]),
            ],
        ),
    ] {
        let pose = model.pose(model.keyframe(keyframe).expect(keyframe));
        for (name, place, [w, x, y, z]) in rows {
            let at = pose[model.body(name).expect(name)];
            assert_close(at.translation, y_up(place), 1e-4, name);
            let turn = Rotation::from_xyzw(x, z, -y, w).normalize();
            assert!(
                at.rotation.angle_to(turn) < 3e-4,
                "{name}: rotation {:?}, expected {turn:?}",
                at.rotation
            );
        }
    }
}

#[needs_data]
#[test]
fn omitted_features_are_noted() {
    let model = humanoid();
    for note in [
        "`ankle_y_right` and `ankle_x_right` are 0.040 m apart; they became one, in the middle",
        "springs of `abdomen_z` and `abdomen_y` differ; all became the softest",
        "left out: rotor inertia of joints (21)",
        "left out: tendons (2)",
        "left out: actuators (21)",
    ] {
        assert!(
            model.notes.iter().any(|found| found == note),
            "the note {note} is missing in {:#?}",
            model.notes
        );
    }
}

fn read(text: &str) -> MjcfModel {
    read_mjcf(text.as_bytes()).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// Reads a model with one free body.
fn one_body(settings: &str, attributes: &str, contents: &str) -> MjcfModel {
    read(&format!(
        "<mujoco>{settings}<worldbody><body {attributes}><freejoint/>{contents}</body></worldbody></mujoco>"
    ))
}

/// Compares quaternions (w, x, y, z) with MuJoCo 4.0.0.
#[test]
fn rotations_match_mujoco() {
    for (settings, attributes, [w, x, y, z]) in [
        ("", "euler='10 20 30'", [0.9437144, 0.1276794, 0.1448781, 0.2685358]),
        ("<compiler eulerseq='zyX'/>", "euler='10 20 30'", [0.9515485, 0.2392983, 0.1448781, 0.1276794]),
        (
            "<compiler angle='radian' eulerseq='XYZ'/>",
            "euler='.1 .2 .3'",
            [0.9833474, 0.0342708, 0.1060205, 0.1435722],
        ),
        ("", "axisangle='1 2 3 40'", [0.9396926, 0.0914087, 0.1828175, 0.2742262]),
        ("", "xyaxes='1 2 0 0 1 1'", [0.713799, 0.462707, 0.2859687, 0.441152]),
        ("", "zaxis='1 1 1'", [0.8880738, -0.3250576, 0.3250576, 0.0]),
        ("", "quat='2 0 1 0'", [0.8944272, 0.0, 0.4472136, 0.0]),
    ] {
        let found = one_body(settings, attributes, "<geom size='.1'/>").bodies[1].def.rotation;
        let expected = Rotation::from_xyzw(x, z, -y, w);
        assert!(found.angle_to(expected) < 1e-3, "{attributes}: {found:?}, expected {expected:?}");
        let straight = found.dot(expected).abs();
        assert!((straight - 1.0).abs() < 1e-6, "{attributes}: dot product {straight}");
    }
}

/// Compares a rotated box, a capsule with a given mass, a ball, and a given tensor with MuJoCo 4.0.0.
#[test]
fn masses_of_rotated_shapes_match_mujoco() {
    let geoms = "<geom type='box' size='.1 .2 .3' pos='.5 0 0' euler='20 0 0' density='500'/>
        <geom type='capsule' size='.05' fromto='0 0 0 0 .3 .4' mass='2'/>
        <geom type='sphere' size='.1' pos='0 0 -.2'/>";
    let mass = one_body("", "", geoms).bodies[1].def.mass.expect("a mass");
    assert!((mass.mass - 30.188_79).abs() < 1e-4);
    assert_close(mass.center, y_up([0.397_498_5, 0.009_937_46, -0.014_500_68]), 1e-6, "centre");
    assert_close(mass.inertia.diagonal, Vec3::new(1.394_992, 1.756_950, 2.277_274), 1e-5, "diagonal");
    assert_close(mass.inertia.off, Vec3::new(-0.038_972, -0.119_250, -0.174_008), 1e-5, "off the diagonal");

    let inertial = "<inertial pos='.1 .2 .3' mass='2' fullinertia='3 2 2.5 .1 .2 .3'/>";
    let mass = one_body("", "", inertial).bodies[1].def.mass.expect("a mass");
    assert_close(mass.center, y_up([0.1, 0.2, 0.3]), 1e-7, "centre");
    assert_close(mass.inertia.diagonal, Vec3::new(3.0, 2.5, 2.0), 1e-6, "diagonal");
    assert_close(mass.inertia.off, Vec3::new(-0.3, -0.1, 0.2), 1e-6, "off the diagonal");
}

/// Reads a model of a body on hinges with one keyframe and wide ranges.
fn on_hinges(axes: &[Vec3], angles: &[f32], range: [f32; 2]) -> MjcfModel {
    let vector = |v: Vec3| format!("{} {} {}", v.x, v.y, v.z);
    let joints: String = axes
        .iter()
        .map(|&axis| format!("<joint axis='{}' range='{} {}'/>", vector(axis), range[0], range[1]))
        .collect();
    let qpos: Vec<_> = angles.iter().map(f32::to_string).collect();
    read(&format!(
        "<mujoco><worldbody><body><freejoint/><geom size='.1'/><body pos='1 0 0'>{joints}<geom size='.1'/></body>
        </body></worldbody><keyframe><key qpos='0 0 0 1 0 0 0 {}'/></keyframe></mujoco>",
        qpos.join(" ")
    ))
}

#[test]
fn two_hinges_become_one_swing_and_one_twist() {
    let mut random = Random::new(11);
    for _ in 0..200 {
        let turn = random.rotation();
        let [first, last] = [turn * Vec3::X, turn * Vec3::Y];
        let angles = [random.range(-1.4, 1.0), random.range(-1.4, 1.0)];
        let model = on_hinges(&[first, last], &angles, [-85.0, 60.0]);
        let (swing, twist) = SwingTwistLimit::angles(model.keyframes[0].moved[0].1.rotation);
        assert_close(swing, Vec3::Y * angles[0], 2e-5, "swing");
        assert!((twist - angles[1]).abs() < 2e-5, "{twist} for {}", angles[1]);
        for range in two_ranges(&model.joints[0]) {
            assert_range(range, -85.0, 60.0);
        }
    }
}

#[test]
fn three_hinges_keep_their_separate_ranges() {
    let mut random = Random::new(12);
    for case in 0..300 {
        let (turn, hand) = (random.rotation(), [1.0, -1.0][case % 2]);
        let axes = [turn * Vec3::X, turn * Vec3::Y, turn * Vec3::Z * hand];
        let used = case % 3;
        let mut angles = [0.0; 3];
        angles[used] = random.range(-1.5, 1.5);
        let model = on_hinges(&axes, &angles, [-60.0, 30.0]);
        let JointKind::Ball { limit: Some(limit) } = model.joints[0].kind else { panic!("a ball") };
        // Each hinge alone stops at the end of its own range, with right-handed and left-handed axes.
        let beyond = Range::degrees(-60.0, 30.0).excess(angles[used]);
        let found = limit.overshoot(model.keyframes[0].moved[0].1.rotation);
        assert!(
            (found - beyond).abs() < 1e-4,
            "hinge {used} at {}: overshoot {found}, expected {beyond}",
            angles[used]
        );
    }
}

#[test]
fn ranges_follow_compiler_reference_and_joint() {
    let range = |settings: &str, joint: &str| {
        let model = read(&format!(
            "<mujoco>{settings}<worldbody><body><joint {joint}/><geom size='.1'/></body></worldbody></mujoco>"
        ));
        assert_eq!(model.joints[0].collision, JointCollision::Enabled);
        let JointKind::Hinge { limit } = model.joints[0].kind else { panic!("a hinge") };
        limit
    };
    assert_range(range("", "range='-10 20'").unwrap(), -10.0, 20.0);
    assert_range(range("", "range='-10 20' ref='5'").unwrap(), -15.0, 15.0);
    // The centre of a range is within half a turn of the file's pose.
    assert_range(range("", "range='170 200'").unwrap(), -190.0, -160.0);
    assert_range(range("", "range='350 370'").unwrap(), -10.0, 10.0);
    let radian = "<compiler angle='radian'/>";
    assert_eq!(range(radian, "range='-1 2'"), Some(Range::new(-1.0, 2.0)));
    assert_eq!(range("", "range='-10 20' limited='false'"), None);
    assert_eq!(range("", "range='-180 180'"), None);
    assert_eq!(range("<compiler autolimits='false'/>", "range='-10 20'"), None);
    assert_eq!(range("", ""), None);
}

#[test]
fn nearest_nested_class_applies() {
    let model = read(
        "<mujoco><default><geom size='.1'/><default class='a'><geom size='.2' type='capsule'/>
            <default class='b'><geom size='.3 .5'/></default></default></default>
        <worldbody><body childclass='a'><freejoint/>
            <geom fromto='0 0 0 0 0 1'/><geom class='b'/><geom class='main'/>
            <body childclass='b'><geom pos='1 0 0'/></body></body></worldbody></mujoco>",
    );
    let shapes: Vec<_> =
        model.bodies.iter().flat_map(|body| &body.def.shapes).map(|def| def.shape.clone()).collect();
    let capsule = |radius| Shape::Capsule { radius, half_height: 0.5 };
    assert_eq!(shapes, [capsule(0.2), capsule(0.3), Shape::Sphere { radius: 0.1 }, capsule(0.3)]);
}

#[test]
fn shapes_collide_if_either_filter_accepts_the_other() {
    let model = read(
        "<mujoco><worldbody><geom type='plane' size='0 0 1'/><body><freejoint/>
            <geom size='.1' contype='1' conaffinity='0'/><geom size='.1' contype='0' conaffinity='2'/>
            <geom size='.1' contype='0' conaffinity='0'/><geom size='.1' contype='4' conaffinity='1'/>
        </body></worldbody></mujoco>",
    );
    let filters: Vec<_> =
        model.bodies.iter().flat_map(|body| &body.def.shapes).map(|def| def.filter).collect();
    let meets: Vec<_> = filters.iter().map(|filter| filter.meets(filters[0])).collect();
    assert_eq!(meets, [true, true, false, false, true]);
    let with_last: Vec<_> = filters.iter().map(|filter| filter.meets(filters[4])).collect();
    assert_eq!(with_last, [true, true, false, false, false]);
}

/// Returns the error of the reader for contents of a `<mujoco>`, or "" if they are accepted.
fn complaint(contents: &str) -> String {
    let text = format!("<mujoco>\n{contents}</mujoco>");
    read_mjcf(text.as_bytes()).err().map(|error| error.to_string()).unwrap_or_default()
}

#[test]
fn errors_name_the_place() {
    let body = |contents: &str| format!("<worldbody><body>\n  {contents}</body></worldbody>");
    for (contents, expected) in [
        ("<wordbody/>".into(), "no section `wordbody` (line 2 column 1)"),
        ("<include file='/etc/passwd'/>".into(), "files that include others are not read (line 2 column 1)"),
        ("<body>".into(), "not XML: expected 'body' tag, not 'mujoco' (line 2 column 7)"),
        (body("<geom size='x'/>"), "`size`: `x` is no number (line 3 column 9)"),
        (body("<geom size='nan'/>"), "`size`: `nan` is not within ±1e9 (line 3 column 9)"),
        (body("<geom size='0'/>"), "`size`: a radius must be positive and finite (line 3 column 9)"),
        (body("<geom/>"), "`size` is missing (line 3 column 3)"),
        (body("<geom type='mesh'/>"), "`type`: `mesh` is not read (line 3 column 9)"),
        (body("<geom size='1' class='c'/>"), "`class`: no class `c` (line 3 column 18)"),
        (body("<geom size='1' pos='1 2'/>"), "`pos`: takes 3 numbers, not 2 (line 3 column 18)"),
        (body("<joint axis='0 0 0'/>"), "`axis`: the vector has no direction (line 3 column 10)"),
        (body("<joint type='slid'/>"), "no joint of type `slid` (line 3 column 3)"),
        (body("<joint range='2 1'/>"), "`range`: the lower end is above the upper one (line 3 column 10)"),
        (
            body("<joint/>"),
            "mass and inertia of a moving body must be positive and finite (line 2 column 12)",
        ),
        (
            body("<joint/><joint axis='1 0 1'/><geom size='1'/>"),
            "hinges of one body must be at right angles to each other (line 2 column 12)",
        ),
        (
            body("<geom size='1' quat='1 0 0 0' euler='0 0 0'/>"),
            "`euler`: `quat` sets the same (line 3 column 33)",
        ),
        (
            "<compiler eulerseq='xyzx'/>".into(),
            "`eulerseq`: takes three letters, each one of xyzXYZ (line 2 column 11)",
        ),
        (
            "<contact><exclude body1='world' body2='b'/></contact>".into(),
            "`body2`: no body `b` (line 2 column 33)",
        ),
        (
            "<keyframe><key qpos='1'/></keyframe>".into(),
            "`qpos`: takes 0 numbers for this model, not 1 (line 2 column 16)",
        ),
    ] {
        assert_eq!(complaint(&contents), expected);
    }
    assert_eq!(
        read_mjcf(b"<robot/>").unwrap_err().with_file("r.xml").to_string(),
        "r.xml: not an MJCF file: begins with `robot` (line 1 column 1)"
    );
    assert_eq!(read_mjcf(b"\xff<").unwrap_err().to_string(), "not UTF-8 (byte 0)");
}

/// Deeply nested files do not cause deep recursion.
#[test]
fn deep_nesting_is_rejected_without_stack_overflow() {
    let nested = |tag: &str, end: &str, count: usize| tag.repeat(count) + &end.repeat(count);
    let bodies = nested("<body><joint/><geom size='1'/>", "</body>", 100_000);
    assert!(complaint(&format!("<worldbody>{bodies}</worldbody>")).contains("more than 1024 bodies"));
    let classes: String = (0..100_000).map(|i| format!("<default class='{i}'>")).collect();
    let classes = classes + &"</default>".repeat(100_000);
    assert!(complaint(&format!("<default>{classes}</default>")).contains("nested more than 32 deep"));
    let sites = nested("<site>", "</site>", 100_000);
    assert_eq!(complaint(&format!("<worldbody>{sites}</worldbody>")), "");
}

#[test]
fn oversized_models_are_rejected() {
    let attributes: String = (0..2000).map(|i| format!(" a{i}=''")).collect();
    assert_eq!(complaint(&format!("<size{attributes}/>")), "more than 1000 attributes (line 2)");
    assert_eq!(complaint("<size xmlns:a='b'/>"), "XML namespaces are not read (line 2)");
    let laughs = "<!DOCTYPE m [<!ENTITY a 'ha'>]><mujoco/>";
    assert!(read_mjcf(laughs.as_bytes()).unwrap_err().what.contains("DTD"));
    let long = format!("<mujoco>{}</mujoco>", " ".repeat(5 << 20));
    assert!(read_mjcf(long.as_bytes()).unwrap_err().what.contains("more than the 4194304 that are read"));
}

fn assert_one_line(error: &Error) {
    let text = error.to_string();
    assert!(!text.chars().any(char::is_control) && text.len() < 600, "{text}");
    assert!(!error.where_.is_empty(), "{text}");
}

/// Reads a model, adds it to a world in each of its poses, and steps the world.
fn read_and_try(bytes: &[u8]) -> Result<(), Error> {
    let model = read_mjcf(bytes)?;
    let poses = model.keyframes.iter().map(|keyframe| model.pose(keyframe));
    for pose in poses.chain([model.rest_pose()]) {
        let mut world = World::new(WorldDef::default());
        model.spawn_at(&mut world, &pose);
        world.step();
    }
    Ok(())
}

#[needs_data]
#[test]
fn every_prefix_of_the_humanoid_is_rejected() {
    let text = humanoid_text();
    let text = text.trim_end();
    let step = if std::env::var_os("SINEW_FULL").is_some() { 1 } else { 37 };
    for length in (0..text.len()).step_by(step) {
        assert_one_line(&read_mjcf(&text.as_bytes()[..length]).expect_err("half a file"));
    }
}

/// Changes random bytes of the humanoid, and replaces its numbers by extreme ones: 10,000 cases with `SINEW_FULL`
/// set, otherwise a hundredth.
#[needs_data]
#[test]
fn mutated_humanoids_do_not_panic() {
    const WORDS: [&str; 10] = ["0", "-1", "1e9", "1e-30", "nan", "1e40", "", "\"", "<body>", "0 0 0 0"];
    let text = humanoid_text();
    let cases = if std::env::var_os("SINEW_FULL").is_some() { 10_000 } else { 100 };
    // Starts after the comment at the head of the file.
    let start = text.find("<mujoco").expect("the root");
    let mut random = Random::new(5);
    let (mut read, mut refused) = (0, 0);
    for case in 0..cases {
        let mut bytes = text.as_bytes()[start..].to_vec();
        for _ in 0..=random.index(4) {
            let at = random.index(bytes.len());
            if case % 2 == 0 {
                bytes[at] = random.index(256) as u8;
            } else if let Some(digit) = bytes[at..].iter().position(u8::is_ascii_digit) {
                let word = WORDS[random.index(WORDS.len())];
                bytes.splice(at + digit..=at + digit, word.bytes());
            }
        }
        match read_and_try(&bytes) {
            Ok(()) => read += 1,
            Err(error) => {
                refused += 1;
                assert_one_line(&error);
            }
        }
    }
    println!("{read} read, {refused} refused");
    assert!(read > cases / 20 && refused > cases / 5, "{read} files read, {refused} refused");
}

#[test]
fn free_body_is_placed_with_its_children() {
    let model = read(
        "<mujoco><worldbody><body name='a' pos='0 0 1'><freejoint/><geom size='.1'/>
            <body name='b' pos='1 0 0'><geom size='.1'/></body></body></worldbody>
        <keyframe><key name='k' qpos='1 2 3 0 0 0 2'/></keyframe></mujoco>",
    );
    let pose = model.pose(model.keyframe("k").expect("the model has this keyframe"));
    assert_close(pose[1].translation, y_up([1.0, 2.0, 3.0]), 1e-6, "a");
    // The pose after half a turn about the file's z.
    assert_close(pose[2].translation, y_up([0.0, 2.0, 3.0]), 1e-6, "b");
    assert_eq!(model.rest_pose()[2], Transform::from_translation(Vec3::new(1.0, 1.0, 0.0)));
}

#[test]
fn springs_and_slides_match_the_file() {
    let model = read(
        "<mujoco><worldbody><body pos='0 0 1'><joint type='slide' axis='0 0 2' range='-.5 .25' ref='.125' stiffness='30'
            damping='4' springref='.25' frictionloss='3'/><geom size='.1'/>
            <body><joint axis='0 1 0' damping='2' stiffness='3'/>
                <joint axis='1 0 0' damping='1' stiffness='6' springref='90'/>
                <geom size='.1'/></body></body></worldbody>
        <keyframe><key qpos='.375 0 0'/></keyframe></mujoco>",
    );
    let [slide, hinges] = &model.joints[..] else { panic!("two joints") };
    assert_eq!(slide.kind, JointKind::Slider { limit: Some(Range::new(-0.625, 0.125)) });
    let Some(Spring { softness, rest }) = slide.spring else { panic!("a spring") };
    assert_eq!(softness, Softness::Stiffness { stiffness: 30.0, damping: 4.0 });
    assert_eq!((rest.translation, slide.friction_torque), (Vec3::X * 0.125, 3.0));
    assert_close(model.pose(&model.keyframes[0])[1].translation, Vec3::Y * 1.25, 1e-6, "slid");

    let Some(Spring { softness, rest }) = hinges.spring else { panic!("a spring") };
    assert_eq!(softness, Softness::Stiffness { stiffness: 3.0, damping: 1.0 });
    // The last hinge is the twist.
    let quarter = Rotation::from_axis_angle(Vec3::X, core::f32::consts::FRAC_PI_2);
    assert!(rest.rotation.angle_to(quarter) < 1e-3, "{rest:?}");
}

/// Checks that ζ = 0.2 gives a restitution of `exp(−0.2π/√0.96)` in both notations.
#[test]
fn contact_properties_match_the_file() {
    let material = |attributes: &str| {
        let model = one_body("", "", &format!("<geom size='.1' {attributes}/>"));
        model.bodies.iter().flat_map(|body| &body.def.shapes).next().expect("the model has a geom").material
    };
    assert_eq!(material("").friction, 1.0);
    let rubber = material("friction='.8 .01 .002' condim='6' solref='.02 .2'");
    assert_eq!((rubber.friction, rubber.rolling), (0.8, 0.002));
    assert!((rubber.restitution - 0.526_62).abs() < 1e-4, "{rubber:?}");
    assert!((material("solref='-400 -8'").restitution - 0.526_62).abs() < 1e-4);
    assert_eq!(material("friction='.8 .01 .002'").rolling, 0.0);
    assert_eq!(material("solref='.02 1'").restitution, 0.0);
    assert_eq!(material("solref='0 0'").restitution, 0.0);
}
