//! Ragdoll files: the example of the documentation, round trips, errors.

use crate::world::documented_example;
use needs_data::needs_data;
use serde_json::{Value, json};
use sinew_formats::{ReadOptions, load_gltf, read_ragdoll, write_ragdoll};
use sinew_math::{Random, Range, SwingTwistLimit, Sym3, Transform, Vec3};
use sinew_physics::{JointKind, MassProperties, Shape};
use sinew_ragdoll::{BuildOptions, RagdollBodyDef, RagdollDef, RagdollJointDef, Repair, build, cure};

fn example() -> String {
    documented_example(include_str!("../../src/ragdoll.rs"))
}

#[test]
fn documented_example_is_read() {
    let def = read_ragdoll(example().as_bytes()).unwrap();
    assert_eq!(def.bodies[1].merged, [6]);
    assert_eq!(def.joints[0].parent, 0);
    assert_eq!(def.disabled_pairs, [(0, 1)]);
    assert_eq!(def.dropped_bones, ["LeftHandThumb1"]);
    let limit = SwingTwistLimit {
        swing_y: Range::degrees(-40.0, 40.0),
        swing_z: Range::degrees(-20.0, 110.0),
        twist: Range::degrees(-35.0, 35.0),
    };
    assert_eq!(def.joints[0].kind, JointKind::Ball { limit: Some(limit) });
    assert_eq!(read_ragdoll(write_ragdoll(&def).as_bytes()).unwrap(), def);
}

fn random_limit(random: &mut Random) -> SwingTwistLimit {
    SwingTwistLimit {
        swing_y: Range::new(-random.range(0.0, 3.0), random.range(0.0, 3.0)),
        swing_z: Range::new(-random.range(0.0, 3.0), random.range(0.0, 3.0)),
        twist: Range::new(-core::f32::consts::PI, random.range(-3.0, core::f32::consts::PI)),
    }
}

fn random_body(random: &mut Random, index: usize) -> RagdollBodyDef {
    let principal = Vec3::new(random.range(0.001, 2.0), random.range(0.001, 2.0), random.range(0.001, 2.0));
    RagdollBodyDef {
        // Names are not unique in real rigs.
        bone: format!("bone \"{}\"", index / 2 * 2),
        joint: random.index(1000),
        merged: (0..random.index(3)).map(|_| random.index(1000)).collect(),
        role: format!("spine_{index}"),
        confidence: random.unit(),
        shape: Shape::Capsule { half_height: random.unit(), radius: random.range(0.01, 1.0) },
        character_from_body: Transform::new(random.in_cube(), random.rotation()),
        mass: MassProperties {
            mass: random.range(0.1, 30.0),
            center: random.in_cube(),
            inertia: Sym3::from_rotated_diagonal(random.rotation(), principal),
        },
    }
}

#[test]
fn written_files_read_back_equal() {
    let mut random = Random::new(11);
    let mut def = RagdollDef {
        bodies: (0..40).map(|i| random_body(&mut random, i)).collect(),
        joints: Vec::new(),
        disabled_pairs: vec![(0, 3), (7, 2), (38, 39)],
        dropped_bones: vec!["a".into(), String::new()],
        total_mass: 71.3,
        height: 1.83,
        unit_scale: 0.01,
        up_axis: Vec3::new(0.0, 0.0, -1.0),
        character_from_model: Transform::new(random.in_cube(), random.rotation()),
    };
    for child in 1..def.bodies.len() {
        let limit = (random.index(4) > 0).then(|| random_limit(&mut random));
        let kind = match random.index(4) {
            0 => JointKind::Ball { limit },
            1 => JointKind::Hinge { limit: limit.map(|l| l.twist) },
            2 => JointKind::Universal { limit },
            _ => JointKind::Fixed,
        };
        def.joints.push(RagdollJointDef {
            parent: random.index(child),
            child,
            frame_parent: Transform::new(random.in_cube(), random.rotation()),
            frame_child: Transform::new(random.in_cube(), random.rotation()),
            kind,
            friction_torque: random.unit(),
        });
    }
    let back = read_ragdoll(write_ragdoll(&def).as_bytes()).unwrap();
    assert_eq!(back, def);
    // Equality treats −0 as 0; a snapshot does not.
    assert_eq!(format!("{back:?}"), format!("{def:?}"));
}

#[test]
fn written_zeros_keep_their_sign() {
    let mut def = read_ragdoll(example().as_bytes()).unwrap();
    let limit = SwingTwistLimit {
        swing_y: Range::new(-0.0, 0.0),
        swing_z: Range::new(-1.0, -0.0),
        twist: Range::new(-0.0, -0.0),
    };
    def.joints[0].kind = JointKind::Universal { limit: Some(limit) };
    def.joints[0].frame_child = Transform::from_translation(Vec3::new(-0.0, 0.0, -0.0));
    def.bodies[1].character_from_body.translation = Vec3::new(0.5, -0.0, 0.0);
    let back = read_ragdoll(write_ragdoll(&def).as_bytes()).unwrap();
    assert_eq!(format!("{back:?}"), format!("{def:?}"));
}

#[test]
fn round_angles_are_written_with_few_digits() {
    let mut def = read_ragdoll(example().as_bytes()).unwrap();
    def.joints[0].kind = JointKind::Hinge { limit: Some(Range::degrees(-2.5, 140.0)) };
    let text = write_ragdoll(&def);
    assert!(text.contains(r#""limits_deg": { "twist": [-2.5, 140] }"#), "{text}");
}

#[test]
fn errors_name_the_place() {
    let text = example();
    for (from, to, expected) in [
        (
            r#""rig_joint": 5"#,
            r#""rig_joint": -5"#,
            "must be a whole number, 0 or more (bodies[1].rig_joint)",
        ),
        (
            r#""parent": "Hips""#,
            r#""parent": "Head""#,
            "no body above has the bone name `Head` (bodies[1].joint.parent)",
        ),
        (
            r#""parent": "Hips""#,
            r#""parent": "LeftUpLeg""#,
            "a parent must come before its child (bodies[1].joint.parent)",
        ),
        ("[-40, 40]", "[40, -40]", "the lower end comes first (bodies[1].joint.limits_deg.swing_y)"),
        ("[-40, 40]", "[4, 40]", "a swing's range must contain zero (bodies[1].joint.limits_deg.swing_y)"),
        (
            "[-35, 35]",
            "[-35, 350]",
            "must lie between -180 and 180 degrees (bodies[1].joint.limits_deg.twist[1])",
        ),
        (r#""kg": 40"#, r#""kg": 0"#, "must be more than 0 (bodies[0].mass.kg)"),
        (r#""kg": 40"#, r#""kg": 1e30"#, "a mass or moment out of range (bodies[0].mass)"),
        (
            r#""position": [0, 0.95, 0]"#,
            r#""position": [0, 3e38, 0]"#,
            "lies more than 1,000 km away (bodies[0].position)",
        ),
        (
            r#""radius": 0.07"#,
            r#""radius": 1e-20"#,
            "is smaller than a micrometre or larger than 1,000 km (bodies[1].shape)",
        ),
        (r#""height": 1.7"#, r#""height": 1e30"#, "must lie between a millionth and a million (height)"),
        (
            r#""up_axis": [0, 1, 0]"#,
            r#""up_axis": [0, 1, 1]"#,
            "must be a unit vector along an axis (up_axis)",
        ),
        (
            r#""type": "box", "half_extents": [0.16, 0.1, 0.1]"#,
            r#""type": "half_space""#,
            "a body of a ragdoll cannot be a half_space (bodies[0].shape)",
        ),
    ] {
        assert!(text.contains(from), "{from}");
        let error = read_ragdoll(text.replacen(from, to, 1).as_bytes()).unwrap_err();
        assert_eq!(error.to_string(), expected);
    }
}

#[test]
fn randomly_changed_bytes_do_not_panic() {
    let whole = example().into_bytes();
    let mut random = Random::new(5);
    for _ in 0..2000 {
        let mut bytes = whole.clone();
        for _ in 0..=random.index(4) {
            let at = random.index(bytes.len());
            bytes[at] = random.index(256) as u8;
        }
        if let Ok(def) = read_ragdoll(&bytes) {
            assert_eq!(read_ragdoll(write_ragdoll(&def).as_bytes()).unwrap(), def);
        }
    }
}

/// Wrong numbers in a whole body are rejected, or examined, fixed and written again.
#[needs_data]
#[test]
fn invalid_values_are_rejected_or_reported_by_the_doctor() {
    let data = crate::data::shared_data();
    let document = load_gltf(data.join("rigs/mannequiny.glb"), ReadOptions::default()).unwrap();
    let analysis = sinew_anim::analyze(&document.rig).unwrap();
    let (def, _) = build(&document.rig, &analysis, &BuildOptions::default()).unwrap();
    let whole: Value = serde_json::from_str(&write_ragdoll(&def)).unwrap();
    let mut places = Vec::new();
    numbers(&whole, String::new(), &mut places);
    assert!(places.len() > 300, "{} numbers", places.len());
    let mut random = Random::new(23);
    let cases = if std::env::var_os("SINEW_FULL").is_some() { 3000 } else { 40 };
    let mut read = 0;
    for _ in 0..cases {
        let mut lying = whole.clone();
        for _ in 0..=random.index(3) {
            let place = lying.pointer_mut(&places[random.index(places.len())]).unwrap();
            let factor = [0.0, -1.0, 0.5, 3.0, 1e3, 1e-4, 1e5, 1e-8][random.index(8)];
            *place = json!(place.as_f64().unwrap_or(1.0) * factor + f64::from(random.range(-0.1, 0.1)));
        }
        let Ok(def) = read_ragdoll(lying.to_string().as_bytes()) else { continue };
        read += 1;
        let (cured, _) = cure(&Repair::new(def));
        match read_ragdoll(write_ragdoll(&cured.def).as_bytes()) {
            Ok(back) => assert!(back == cured.def, "the written definition reads back differently"),
            Err(error) => panic!("a repaired definition is refused: {error}"),
        }
    }
    assert!(10 * read > cases, "only {read} of {cases} definitions were read");
}

/// Returns JSON pointers to all numbers.
fn numbers(value: &Value, at: String, places: &mut Vec<String>) {
    match value {
        Value::Number(_) => places.push(at),
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(i, item)| numbers(item, format!("{at}/{i}"), places));
        }
        Value::Object(map) => {
            map.iter().for_each(|(key, item)| numbers(item, format!("{at}/{key}"), places));
        }
        _ => {}
    }
}
