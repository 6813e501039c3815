//! `sinew convert` and `sinew events`: clips between formats and characters, and their footsteps.

use crate::contract::check_keys;
use crate::sinew::{Folder, shared_data, sinew};
use needs_data::needs_data;
use sinew::anim::{Wrap, rest_pose, sample};
use sinew::formats::{MotionFile, MotionOptions, ReadOptions, load_gltf, load_motion};

fn load(path: &str) -> MotionFile {
    load_motion(path, &MotionOptions::default()).expect("the written file can be read")
}

/// Largest difference between poses of joints with equal names, radians and metres, at key times of the first file.
fn difference(a: &MotionFile, b: &MotionFile) -> (f32, f32) {
    let (mut from, mut to) = (rest_pose(&a.rig), rest_pose(&b.rig));
    let (mut turn, mut shift) = (0.0_f32, 0.0_f32);
    for k in 0..=20 {
        let time = a.clips[0].duration * k as f32 / 20.0;
        sample(&a.clips[0], &a.rig, time, Wrap::Clamp, &mut from);
        sample(&b.clips[0], &b.rig, time, Wrap::Clamp, &mut to);
        for (i, joint) in a.rig.joints.iter().enumerate().filter(|(_, joint)| !joint.name.is_empty()) {
            let own =
                b.rig.joints.iter().position(|own| own.name == joint.name).expect("all joints are there");
            turn = turn.max(from[i].rotation.angle_to(to[own].rotation));
            shift = shift.max((from[i].translation - to[own].translation).length());
        }
    }
    (turn, shift)
}

const BVH: &str = "HIERARCHY\nROOT hips\n{\n OFFSET 0 90 0\n CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation\n \
    JOINT leg\n {\n  OFFSET 10 0 0\n  CHANNELS 3 Zrotation Yrotation Xrotation\n  End Site\n  {\n   OFFSET 0 -45 0\n  }\n }\n}\n\
    MOTION\nFrames: 3\nFrame Time: 0.05\n0 90 0 0 0 0 0 0 0\n1 91 5 10 0 0 0 20 30\n2 90 10 20 0 0 0 40 60\n";

#[test]
fn bvh_to_glb_and_back() {
    let folder = Folder::new("convert-bvh");
    let bvh = folder.file("kick.bvh", BVH);
    folder.file(
        "kick.events.json",
        r#"{"sinew":"events","version":1,"clips":[{"clip":"kick","events":[{"time":0.05,"name":"kick"}]}]}"#,
    );
    let (glb, again) = (folder.path("kick.glb"), folder.path("again.bvh"));
    let object = sinew(&["convert", &bvh, &glb, "--json"]).json();
    check_keys("convert", &object);
    assert_eq!(object["outputs"], serde_json::json!([glb]));
    let (before, between) = (load(&bvh), load(&glb));
    assert_eq!(between.events, before.events);
    assert_eq!((between.rig.skins.len(), between.clips[0].name.as_str()), (1, "kick"));
    let (turn, shift) = difference(&before, &between);
    assert!(turn < 1e-6 && shift < 1e-6, "{turn} rad, {shift} m");
    let object = sinew(&["convert", &glb, "-o", &again, "--json"]).json();
    assert_eq!(object["outputs"][1], folder.path("again.events.json"));
    let after = load(&again);
    assert_eq!((after.rig.joints.len(), after.frame_time.map(f64::round)), (3, Some(0.0)));
    assert_eq!(after.events[0][0].name, "kick");
    let (turn, shift) = difference(&before, &after);
    assert!(turn < 1e-4 && shift < 1e-4, "{turn} rad, {shift} m");
    assert!((after.clips[0].duration - 0.1).abs() < 1e-6);
}

#[test]
fn bvh_options_are_applied() {
    let folder = Folder::new("convert-options");
    let bvh = folder.file("kick.bvh", BVH);
    let out = folder.path("out.bvh");
    let run = sinew(&[
        "convert",
        &bvh,
        &out,
        "--unit-in",
        "cm",
        "--unit",
        "m",
        "--up",
        "z",
        "--order",
        "xyz",
        "--fps",
        "40",
        "--rest-frame",
    ]);
    assert_eq!(run.code, Some(0), "{run:?}");
    let text = std::fs::read_to_string(&out).expect("the file can be read");
    assert!(text.contains("Frame Time: 0.025000000") && text.contains("Frames: 6\n"), "{text}");
    assert!(text.contains("Xrotation Yrotation Zrotation") && text.contains("End Site"), "{text}");
    let row = text.lines().nth_back(4).expect("the first frame of the motion");
    // 90 cm above the ground, now along z and in metres.
    assert!(
        row.starts_with("0.000000 -0.000000 0.900000") || row.starts_with("0.000000 0.000000 0.900000"),
        "{row}"
    );
}

#[test]
fn clips_are_retargeted_to_another_body() {
    let folder = Folder::new("convert-onto");
    let mannequin = folder.mannequin();
    let (bvh, out) = (folder.path("walk.bvh"), folder.path("out.glb"));
    assert_eq!(sinew(&["convert", &mannequin, &bvh]).code, Some(0));
    // A giant with the same proportions.
    let run = sinew(&["convert", &bvh, "--unit-in", "0.02", "--onto", &mannequin, &out]);
    assert!(run.code == Some(0) && run.stdout.contains("matched by role"), "{run:?}");
    assert!(run.stdout.contains("legs 0.50 times as long"), "{run:?}");
    let document = load_gltf(&out, ReadOptions::default()).expect("the glTF can be read");
    let names: Vec<&str> = document.clips.iter().map(|clip| clip.name.as_str()).collect();
    assert_eq!(names, ["Walk", "walk"]);
    // Other commands accept clips in the same way.
    let baked = folder.path("baked.glb");
    let run =
        sinew(&["bake", &mannequin, "--clips", &bvh, "--clip", "walk", "--seconds", "0.1", "-o", &baked]);
    assert!(run.code == Some(0) && run.stdout.contains("plays clip walk"), "{run:?}");
    // The same skeleton keeps the keys unchanged.
    let same = sinew(&["convert", &out, "--clip", "Walk", "--onto", &mannequin, &folder.path("same.glb")]);
    assert!(same.stdout.contains("taken as it is"), "{same:?}");
}

#[test]
fn fbx_to_glb() {
    let folder = Folder::new("convert-fbx");
    let fbx = folder.file("leg.fbx", crate::fbx_file::leg());
    let inspected = sinew(&["inspect", &fbx, "--json"]).json();
    check_keys("inspect", &inspected);
    assert_eq!((&inspected["container"], &inspected["clips"][0]["name"]), (&"fbx".into(), &"bend".into()));
    let out = folder.path("leg.glb");
    let run = sinew(&["convert", &fbx, &out]);
    assert!(run.code == Some(0) && !run.stdout.contains("bones are drawn"), "{run:?}");
    let (before, after) = (load(&fbx), load(&out));
    assert_eq!((after.rig.meshes.len(), after.rig.skins.len()), (1, 1));
    assert_eq!(after.rig.meshes[0].primitives[0].indices, before.rig.meshes[0].primitives[0].indices);
    let (turn, shift) = difference(&before, &after);
    assert!(turn < 1e-6 && shift < 1e-6, "{turn} rad, {shift} m");
    let run = sinew(&["convert", &fbx, &folder.path("leg.bvh")]);
    assert!(run.code == Some(0) && run.stdout.contains("1 mesh and 1 skin"), "{run:?}");
    assert!(!run.stdout.contains("scale channels"), "no scale changes: {run:?}");
    // A rigged FBX is accepted wherever a character is.
    assert_eq!(sinew(&["bake", &fbx, "-o", &folder.path("fall.glb"), "--seconds", "0.1"]).code, Some(0));
    let cut = folder.file("cut.fbx", &crate::fbx_file::leg()[..900]);
    assert!(sinew(&["inspect", &cut]).refusal(1).starts_with(&format!("error: {cut}: ")));
}

#[needs_data]
#[test]
fn vrm_animation_moves_only_its_joints() {
    let data = shared_data();
    let folder = Folder::new("convert-vrma");
    let file = |name: &str| data.join("rigs").join(name).display().to_string();
    let out = folder.path("out.glb");
    let run =
        sinew(&["convert", &file("vrma_test.vrma"), "--onto", &file("CoolLoops_mixamorig_vrm0.vrm"), &out]);
    assert!(run.code == Some(0) && run.stdout.contains("left out of a VRM animation"), "{run:?}");
    let document = load_gltf(&out, ReadOptions::default()).expect("the glTF can be read");
    let clip = document.clips.last().expect("the clip is there");
    let span = |role: &str| {
        let joint = document.rig.stated_roles.iter().find(|(name, _)| name == role).expect("a bone").1;
        let mut pose = rest_pose(&document.rig);
        let mut at = |time: f32| {
            sample(clip, &document.rig, time, Wrap::Clamp, &mut pose);
            pose[joint].rotation
        };
        let start = at(0.0);
        (1..=30).map(|k| at(k as f32 / 10.0).angle_to(start)).fold(0.0, f32::max)
    };
    assert!(span("rightUpperArm") > 0.3, "{}", span("rightUpperArm"));
    for still in ["leftUpperArm", "leftLowerLeg", "rightUpperLeg", "spine", "head"] {
        assert!(span(still) < 2e-3, "{still}: {}", span(still));
    }
}

#[test]
fn impossible_conversions_are_rejected() {
    let folder = Folder::new("convert-refused");
    let mannequin = folder.mannequin();
    let bvh = folder.file("kick.bvh", BVH);
    let refused = |arguments: &[&str], code: i32, what: &str| {
        let before = folder.names();
        let run = sinew(arguments);
        assert!(run.refusal(code).contains(what), "{run:?}");
        assert_eq!(folder.names(), before);
    };
    let out = folder.path("out.bvh");
    refused(&["convert", &bvh, &bvh], 2, "is an input");
    refused(&["convert", &mannequin, &out, "--clip", "Fly"], 1, "no clip 'Fly'; there is Walk");
    refused(
        &["convert", &bvh, "--onto", &mannequin, &folder.path("out.glb")],
        1,
        "neither those of the character",
    );
    let cut = folder.file("cut.bvh", &BVH[..BVH.len() - 9]);
    refused(&["convert", &cut, &folder.path("out.glb")], 1, "(line");
    refused(&["events", "detect", &bvh], 1, "footsteps are found on the two legs of a human");
}

#[test]
fn footsteps_of_the_mannequin() {
    let folder = Folder::new("events");
    let (mannequin, out) = (folder.mannequin(), folder.path("mannequin.events.json"));
    let object = sinew(&["events", "detect", &mannequin, "-o", &out, "--json"]).json();
    check_keys("events detect", &object);
    let events = object["clips"][0]["events"].as_array().expect("events");
    let of = |side: &str| events.iter().filter(|event| event["payload"] == side).count();
    assert!(of("left") >= 1 && of("left").abs_diff(of("right")) <= 1, "{object:#}");
    // The written events are found beside the file and not proposed again.
    let inspected = sinew(&["inspect", &mannequin, "--json"]).json();
    assert_eq!(inspected["clips"][0]["events"].as_array().map(Vec::len), Some(events.len()));
    let again = sinew(&["events", "detect", &mannequin, "--json"]).json();
    assert_eq!(again["clips"][0]["events"], serde_json::json!([]));
}

#[needs_data]
#[test]
fn every_captured_file_becomes_a_glb() {
    let data = shared_data();
    let folder = Folder::new("convert-mocap");
    for entry in std::fs::read_dir(data.join("mocap")).expect("the folder exists") {
        let path = entry.expect("an entry").path().display().to_string();
        let out = folder.path("out.glb");
        let run = sinew(&["convert", &path, &out]);
        assert!(run.code == Some(0) && run.stderr.is_empty(), "{path}: {run:?}");
        load(&out);
    }
}
