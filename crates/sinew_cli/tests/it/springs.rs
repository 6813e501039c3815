//! Hair in `bake`, `inspect` and `ragdoll doctor`: an avatar with springs, and one whose joints are only called so.

use crate::contract::check_keys;
use crate::sinew::{Folder, glb, gltf_files, shared_data, sinew};
use serde_json::{Value, json};
use sinew::anim::springs::ColliderShape;
use sinew::anim::{Clip, Property, Rig};
use sinew::formats::{ReadOptions, load_gltf};
use sinew::math::Rotation;
use sinew_scenes::maned::{HAIR, maned_rig};

/// The springs of a rig, as `VRMC_springBone`.
fn extension(rig: &Rig) -> Value {
    let collider = |collider: &sinew::anim::SpringCollider| {
        let ColliderShape::Sphere { offset, radius, .. } = collider.shape else { panic!("a ball") };
        json!({"node": collider.joint, "shape": {"sphere": {"offset": offset.to_array(), "radius": radius}}})
    };
    let spring = |chain: &sinew::anim::SpringChain| {
        let joint = |bone: &sinew::anim::SpringBone| {
            json!({"node": bone.joint, "stiffness": bone.stiffness, "gravityPower": -bone.gravity.y,
                "dragForce": bone.drag, "hitRadius": bone.radius})
        };
        let mut joints: Vec<Value> = chain.bones.iter().map(joint).collect();
        joints.push(json!({"node": chain.bones.last().expect("it has some").joint + 1}));
        json!({"name": chain.name, "joints": joints, "colliderGroups": [0]})
    };
    let springs = &rig.springs;
    json!({
        "specVersion": "1.0",
        "colliders": springs.colliders.iter().map(collider).collect::<Vec<_>>(),
        "colliderGroups": [{"colliders": [0]}],
        "springs": springs.chains.iter().map(spring).collect::<Vec<_>>(),
    })
}

/// The mannequin with hair, as a VRM.
fn avatar() -> Vec<u8> {
    let rig = maned_rig(&HAIR);
    let bytes = glb(&rig, &[]);
    let length = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
    let mut document: Value = serde_json::from_slice(&bytes[20..20 + length]).expect("JSON");
    document["extensions"] = json!({ "VRMC_springBone": extension(&rig) });
    let mut text = document.to_string();
    text += &" ".repeat(text.len().next_multiple_of(4) - text.len());
    let rest = &bytes[20 + length..];
    let mut vrm = b"glTF\x02\0\0\0".to_vec();
    vrm.extend((20 + text.len() + rest.len()).to_le_bytes()[..4].iter());
    vrm.extend(text.len().to_le_bytes()[..4].iter());
    vrm.extend(b"JSON");
    vrm.extend(text.as_bytes());
    vrm.extend(rest);
    vrm
}

/// Largest turn of a hair's joint in a clip, radians.
fn swings(clip: &Clip, rig: &Rig) -> f32 {
    let mut most = 0.0_f32;
    for channel in &clip.channels {
        if channel.property == Property::Rotation && rig.joints[channel.joint].name.starts_with("hair_") {
            let turn = |q: &[f32]| Rotation::from_xyzw(q[0], q[1], q[2], q[3]).to_scaled_axis().length();
            most = channel.values.chunks(4).map(turn).fold(most, f32::max);
        }
    }
    most
}

#[test]
fn an_avatars_hair_moves_in_its_bake() {
    let folder = Folder::new("springs");
    let file = folder.file("avatar.vrm", avatar());
    let object = sinew(&["inspect", &file, "--json"]).json();
    check_keys("inspect", &object);
    assert_eq!(object["springs"][0]["name"], "hair_back");
    assert_eq!(object["springs"][0]["joints"].as_array().map(Vec::len), Some(5));
    assert_eq!(
        object["spring_colliders"][0],
        json!({"joint": "head", "shape": "sphere", "radius": 0.09, "inside": false})
    );
    let text = sinew(&["inspect", &file]).stdout;
    assert!(text.contains("Springs, 1 collider") && text.contains("hair_left"), "{text}");

    let out = folder.path("fall.vrm");
    let bake = |more: &[&str]| {
        let object = sinew(&[&["bake", &file, "--seconds", "3", "-o", &out, "--json"], more].concat()).json();
        check_keys("bake", &object);
        let document = load_gltf(&out, ReadOptions::default()).expect("it can be read");
        let clip = document.clips.last().expect("a clip");
        (object["springs"].clone(), swings(clip, &document.rig), object["hash"].clone())
    };
    let (springs, moved, hash) = bake(&[]);
    assert_eq!(springs, json!({"chains": 3, "bones": 13, "left_out": []}));
    assert!(moved > 0.3, "the hair of one who falls turns by {moved} rad");
    let (springs, moved, bare) = bake(&["--no-springs"]);
    assert_eq!((&springs["bones"], moved), (&json!(0), 0.0));
    assert_ne!(hash, bare);
    folder.file("avatar.ragdoll.json", r#"{"sinew":"ragdoll-settings","version":1,"springs":"none"}"#);
    assert_eq!(bake(&[]).0["bones"], 0);
    assert_eq!(bake(&["--guess-springs"]).0["bones"], 13, "what the file states goes before names");
}

#[test]
fn names_swing_only_when_asked() {
    let folder = Folder::new("guessed");
    let mut rig = maned_rig(&HAIR);
    rig.springs = sinew::anim::Springs::default();
    let file = folder.file("maned.glb", glb(&rig, &[]));
    let note = sinew(&["ragdoll", "doctor", &file]).stdout;
    assert!(note.contains("hair_back_0, hair_left_0, hair_right_0 could swing"), "{note}");
    let out = folder.path("fall.glb");
    let springs = |more: &[&str]| {
        let arguments = [&["bake", &file, "--seconds", "1", "-o", &out, "--json"], more].concat();
        sinew(&arguments).json()["springs"].clone()
    };
    assert_eq!(springs(&[])["bones"], 0);
    // Strands stick out and have no skin: without springs of the file they are things that are carried, with a body each.
    let guessed = springs(&["--guess-springs"]);
    assert_eq!(
        (&guessed["bones"], &guessed["left_out"]),
        (&json!(10), &json!(["hair_back_0", "hair_left_0", "hair_right_0"]))
    );
    assert_eq!(springs(&["--guess-springs", "--no-body", "hair_back_0"])["bones"], 11);
    let both = sinew(&["bake", &file, "-o", &out, "--no-springs", "--guess-springs"]);
    assert_eq!(both.code, Some(2));
    assert!(both.stderr.contains("cannot be used with"), "{both:?}");
}

/// A file whose springs lie gives one line.
#[test]
fn springs_that_lie_are_one_line() {
    let folder = Folder::new("lying");
    let json = r#"{"asset":{"version":"2.0"},"nodes":[{}],
        "extensions":{"VRMC_springBone":{"springs":[{"joints":[{"node":7}]}]}}}"#;
    let file = folder.file("liar.gltf", json);
    let line = sinew(&["inspect", &file]);
    let line = line.refusal(1);
    assert!(line.contains("index 7 is out of range") && line.contains("springs[0].joints[0].node"), "{line}");
}

/// Every avatar of the shared data bakes with its springs.
#[test]
fn shared_avatars_bake() {
    let Some(data) = shared_data() else { return };
    let folder = Folder::new("avatars");
    let out = folder.path("fall.vrm");
    for file in gltf_files(&data.join("rigs")).iter().filter(|file| file.ends_with(".vrm")) {
        if file.contains("unskinned") {
            // Nothing to build a ragdoll from.
            continue;
        }
        let object = sinew(&["bake", file, "--seconds", "1", "-o", &out, "--json"]).json();
        assert!(object["springs"]["bones"].is_u64() && object["nan"] == 0, "{file}: {object:#}");
    }
}
