//! Tests of hints: clips, exporters, neighbouring files and doors show what skin and names do not.

use crate::toy;
use sinew_anim::contact::footsteps;
use sinew_anim::{
    Channel, Clip, Hints, Interpolation, Joint, LocalTransform, Property, Rig, RigAnalysis, Role, Side,
    analyze, analyze_hinted,
};
use sinew_math::{Affine, Rotation, Vec3, trig};
use std::f32::consts::TAU;

const KEYS: u8 = 24;

fn turns(joint: usize, seconds: f32, angle: impl Fn(f32) -> f32) -> Channel {
    let times: Vec<f32> = (0..=KEYS).map(|key| seconds * f32::from(key) / f32::from(KEYS)).collect();
    let keys = times.iter().map(|time| Rotation::from_axis_angle(Vec3::X, angle(TAU * time / seconds)));
    let values = keys.flat_map(|q| [q.x, q.y, q.z, q.w]).collect();
    let (property, interpolation) = (Property::Rotation, Interpolation::Linear);
    Channel { joint, property, interpolation, times, values }
}

fn joint(role: &str) -> usize {
    toy::BODY.iter().position(|(name, ..)| *name == role).expect("a part of the toy")
}

/// Returns a walk toward +Z or −Z: each knee bends while its leg swings forward.
fn walk(seconds: f32, toward: f32) -> Clip {
    let mut channels = Vec::new();
    for (side, phase) in [("left", 0.0), ("right", 0.5 * TAU)] {
        channels.push(turns(joint(&format!("{side}UpperLeg")), seconds, |t| {
            -0.4 * toward * trig::sin(t + phase)
        }));
        channels.push(turns(joint(&format!("{side}LowerLeg")), seconds, |t| {
            0.9 * toward * sinew_math::max(trig::cos(t + phase), 0.0)
        }));
    }
    Clip { name: String::new(), duration: seconds, channels }
}

/// Returns the toy body without names, with coat tails beside its legs that have more skin than the legs.
fn toy_in_a_coat() -> (Rig, Vec<usize>) {
    let mut rig = toy::body(|_| String::new());
    let mut tails = Vec::new();
    for x in [0.2, -0.2] {
        let mut parent = joint("hips");
        for (y, z) in [(0.85, -0.1), (0.5, -0.12), (0.12, -0.14)] {
            let place = Vec3::new(x, y, z);
            let on = -rig.skins[0].inverse_bind[parent].translation;
            let rest = LocalTransform { translation: place - on, ..LocalTransform::default() };
            let new = rig.joints.len();
            rig.joints.push(Joint { name: String::new(), parent: Some(parent), rest, source: new });
            rig.skins[0].joints.push(new);
            rig.skins[0].inverse_bind.push(Affine { translation: -place, ..Affine::IDENTITY });
            let primitive = &mut rig.meshes[0].primitives[0];
            let first = u32::try_from(primitive.positions.len()).expect("few");
            let corners = [Vec3::X * 0.15, Vec3::Y * 0.2, -Vec3::X * 0.15, -Vec3::Y * 0.12];
            primitive.positions.extend(corners.map(|corner| place + corner));
            primitive.joints.extend([[u16::try_from(new).expect("few"), 0, 0, 0]; 4]);
            primitive.weights.extend([[1.0, 0.0, 0.0, 0.0]; 4]);
            primitive.indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
            tails.push(new);
            parent = new;
        }
    }
    (rig, tails)
}

#[test]
fn alternately_swinging_chains_are_the_legs() {
    let (rig, tails) = toy_in_a_coat();
    let thigh = |found: &RigAnalysis| found.joint_with(Role::UpperLeg(Side::Left)).expect("a thigh");
    // Without clips the larger hanging chains count as legs.
    let still = analyze(&rig).expect("a skin");
    assert!(still.humanoid && tails.contains(&thigh(&still)), "{}", thigh(&still));
    let mut walks = walk(1.1, 1.0);
    // The tails swing as well, but in phase with each other.
    walks.channels.extend(tails.iter().map(|&tail| turns(tail, 1.1, |t| 0.3 * trig::sin(2.0 * t))));
    // Chains of which only one swings, or both swing together, are no legs.
    let kick = Clip { duration: 1.0, channels: vec![turns(tails[0], 1.0, trig::sin)], ..Clip::default() };
    let hop = Clip {
        duration: 1.0,
        channels: [tails[0], tails[3]].map(|tail| turns(tail, 1.0, trig::sin)).to_vec(),
        ..Clip::default()
    };
    let found = analyze_hinted(&rig, &Hints::of_clips(&rig, &[kick, hop, walks])).expect("a skin");
    assert!(found.humanoid, "{:?}", found.notes);
    for (part, role) in [
        ("leftUpperLeg", Role::UpperLeg(Side::Left)),
        ("leftLowerLeg", Role::LowerLeg(Side::Left)),
        ("rightFoot", Role::Foot(Side::Right)),
    ] {
        assert_eq!(found.joint_with(role), Some(joint(part)), "{part}");
    }
    assert!(tails.iter().all(|&tail| found.roles[tail].is_none()));
}

#[test]
fn walking_direction_gives_the_front() {
    let mut rig = toy::body(|_| String::new());
    // Feet without toes give no direction.
    for foot in ["leftFoot", "rightFoot"].map(joint) {
        let place = Vec3::from_array(toy::BODY[foot].2);
        rig.meshes[0].primitives[0].positions[4 * foot + 3] = place - Vec3::Y * 0.1;
    }
    for toward in [1.0, -1.0] {
        let hints = Hints::of_clips(&rig, &[walk(1.1, toward)]);
        let found = analyze_hinted(&rig, &hints).expect("a skin");
        let ahead = found.character_from_model.rotation.inverse() * Vec3::Z;
        assert!((ahead - Vec3::Z * toward).length() < 1e-5, "{ahead}");
        let left = found.joint_with(Role::Hand(Side::Left)).expect("a left hand");
        assert_eq!(toy::BODY[left].0, if toward > 0.0 { "leftHand" } else { "rightHand" });
        assert!(
            found.notes.iter().any(|note| note.contains("from the walking direction")),
            "{:?}",
            found.notes
        );
    }
    // Names have priority over the walk.
    let mut named = toy::body(Role::name);
    named.meshes.clone_from(&rig.meshes);
    let backward = Hints::of_clips(&named, &[walk(1.1, -1.0)]);
    let found = analyze_hinted(&named, &backward).expect("a skin");
    let left = found.joint_with(Role::Hand(Side::Left)).expect("a left hand");
    assert_eq!(toy::BODY[left].0, "leftHand");
}

/// Returns the toy body, `units` tall, with a head `head` times as high.
fn tall(units: f32, head: f32) -> Rig {
    let mut rig = toy::body(Role::name);
    let crown = 4 * joint("head") + 3;
    let positions = &mut rig.meshes[0].primitives[0].positions;
    positions[crown] += Vec3::Y * (0.16 * (head - 1.0));
    let height = positions.iter().fold(0.0, |height, at| sinew_math::max(height, at.y));
    let factor = units / height;
    positions.iter_mut().for_each(|at| *at *= factor);
    rig.joints.iter_mut().for_each(|joint| joint.rest.translation *= factor);
    rig.skins[0].inverse_bind.iter_mut().for_each(|bind| bind.translation *= factor);
    rig
}

/// Returns the unit and its reason.
fn unit(rig: &Rig, hints: &Hints) -> (f32, String) {
    let found = analyze_hinted(rig, hints).expect("a skin");
    assert!(found.humanoid);
    (found.unit_scale, found.unit_guess.expect("the unit is guessed").note)
}

/// A body of 66 units is a man in inches, or a dwarf in centimetres.
#[test]
fn ambiguous_unit_is_decided_by_neighbouring_files_and_doors() {
    let rig = tall(66.0, 1.0);
    let (scale, note) = unit(&rig, &Hints::default());
    assert!(scale == 0.0254 && note.contains("may also be centimetres"), "{note}");
    for (hints, reason) in [
        (Hints { kin: vec![0.01, 1.0, 0.01], ..Hints::default() }, "files beside it are in centimetres"),
        (Hints { door: Some(0.8), ..Hints::default() }, "doors of its world are 0.80 m high"),
    ] {
        let (scale, note) = unit(&rig, &hints);
        assert!(scale == 0.01 && note.contains(reason) && note.contains("may also be inches"), "{note}");
    }
    // An unknown exporter, the exporter's usual unit for a dwarf, a single other file, and inconsistent files are no
    // hints; doors of normal height indicate a human.
    for hints in [
        Hints { exporter: "nobody".into(), ..Hints::default() },
        Hints { exporter: "Character Creator 4.2".into(), ..Hints::default() },
        Hints { kin: vec![0.01], ..Hints::default() },
        Hints { kin: vec![0.01, 1.0], ..Hints::default() },
        Hints { door: Some(2.05), ..Hints::default() },
    ] {
        assert_eq!(unit(&rig, &hints).0, 0.0254, "{hints:?}");
    }
    // Hints do not affect a human in metres.
    let hints = Hints { exporter: "DAZ".into(), kin: vec![0.01; 3], door: Some(0.8), ..Hints::default() };
    assert_eq!(unit(&tall(1.75, 1.0), &hints).0, 1.0);
}

#[test]
fn ambiguous_unit_is_decided_by_head_size_and_stride() {
    // Heads have similar sizes, so a character whose head is two fifths of its height is a dwarf.
    let [(plain, _), (dwarf, note)] = [1.0, 7.0].map(|head| unit(&tall(115.0, head), &Hints::default()));
    assert!(plain == 0.01 && dwarf == 0.01 && note.contains("its head is 4"), "{note}");
    let rig = tall(75.0, 5.0);
    assert_eq!(unit(&rig, &Hints::default()).0, 0.0254);
    // Legs of 0.38 m take faster steps than legs of 0.97 m.
    let (scale, note) = unit(&rig, &Hints::of_clips(&rig, &[walk(0.5, 1.0)]));
    assert!(scale == 0.01 && note.contains("a stride of 0.50 s is that of legs of"), "{note}");
    let (scale, note) = unit(&rig, &Hints::of_clips(&rig, &[walk(1.1, 1.0)]));
    assert!(scale == 0.0254 && note.contains("a stride of 1.10 s"), "{note}");
    // An idle that sways slowly is no stride.
    let named = |name: &str, seconds: f32| Clip { name: name.into(), ..walk(seconds, 1.0) };
    let (scale, note) = unit(&rig, &Hints::of_clips(&rig, &[named("Idle", 1.1), named("Walk", 0.5)]));
    assert!(scale == 0.01 && note.contains("a stride of 0.50 s"), "{note}");
}

#[test]
fn human_of_implausible_size_is_scaled() {
    for (units, scaled) in [(0.57, true), (5.75, true), (1.2, false), (2.3, false)] {
        let rig = tall(units, 1.0);
        let found = analyze_hinted(&rig, &Hints::default()).expect("a skin");
        let guess = found.unit_guess.expect("the unit is guessed");
        assert_eq!(guess.is_scaled, scaled, "{units}: {}", guess.note);
        let height = if scaled { 1.75 } else { units };
        assert!((found.height - height).abs() < 0.01, "{units}: {} m", found.height);
    }
    // A character with fast steps is short if its head is large, and in a hurry if its head is small.
    for (head, is_short) in [(5.0, true), (1.0, false)] {
        let rig = tall(0.57, head);
        let scale = unit(&rig, &Hints::of_clips(&rig, &[walk(0.5, 1.0)])).0;
        assert_eq!(scale == 1.0, is_short, "{scale}");
    }
}

/// Returns a creature that is a chain of joints of the given length.
fn worm(length: f32, name: &str) -> Rig {
    let mut rig = toy::body(|_| String::new());
    for (joint, (_, parent, place)) in toy::BODY.iter().enumerate() {
        // All joints on one line, so that it is no human.
        let at = Vec3::new(0.0, 0.0, length * (joint as f32 - 8.0) / 18.0);
        let by = at - Vec3::from_array(*place);
        rig.skins[0].inverse_bind[joint].translation = -at;
        let on = toy::BODY
            .iter()
            .position(|(name, ..)| name == parent)
            .map_or(Vec3::ZERO, |on| Vec3::new(0.0, 0.0, length * (on as f32 - 8.0) / 18.0));
        rig.joints[joint].rest.translation = at - on;
        rig.meshes[0].primitives[0].positions[4 * joint..4 * joint + 4].iter_mut().for_each(|p| *p += by);
    }
    rig.meshes[0].name = name.into();
    rig
}

#[test]
fn named_animal_gets_the_size_of_its_species() {
    let length = |name: &str, units: f32| {
        let found = analyze_hinted(&worm(units, name), &Hints::default()).expect("a skin");
        assert!(!found.humanoid, "{:?}", found.notes);
        (found.unit_scale, found.unit_guess.expect("the unit is guessed"))
    };
    for (name, units, unit) in [
        ("", 2.7, 1.0),
        ("Wolf", 2.7, 0.0),
        ("Wolf", 170.0, 0.01),
        ("Horse_Body", 2.4, 1.0),
        ("wolf_bot", 2.7, 1.0),
    ] {
        let (found, guess) = length(name, units);
        assert_eq!(guess.is_scaled, unit == 0.0, "{name}: {}", guess.note);
        assert!(unit == 0.0 || found == unit, "{name}: {}", guess.note);
        assert!(
            unit > 0.0
                || guess
                    .note
                    .contains("since a grown wolf (by the names of the file and in it) is 1.02 to 2.55 m"),
            "{}",
            guess.note
        );
    }
}

/// In drawn walks the feet move back at changing speeds.
#[test]
fn walk_with_changing_foot_speed_has_a_walking_speed() {
    let rig = tall(1.75, 1.0);
    let found = analyze_hinted(&rig, &Hints::default()).expect("a skin");
    let clip = |sway: f32| {
        let mut channels = Vec::new();
        for (side, phase) in [("left", 0.0), ("right", 0.5 * TAU)] {
            let thigh = joint(&format!("{side}UpperLeg"));
            channels.push(turns(thigh, 1.0, move |t| {
                let s = trig::sin(t + phase);
                -sway * s * s * s
            }));
            let shank = joint(&format!("{side}LowerLeg"));
            channels.push(turns(shank, 1.0, move |t| 0.9 * sinew_math::max(trig::cos(t + phase), 0.0)));
        }
        Clip { name: String::new(), duration: 1.0, channels }
    };
    let speed = |clip: &Clip| footsteps(&rig, &found, clip).expect("the rig has legs").speed;
    let walk = speed(&clip(0.5));
    assert!((0.4..2.5).contains(&walk), "{walk} m/s");
    assert_eq!(speed(&clip(0.0)), 0.0);
}
