//! Files that are dropped on the viewer.

use crate::hands::viewer;
use crate::pictures::look;
use sinew::anim::{Wrap, analyze, local_to_model, rest_pose, sample};
use sinew::formats::{
    BvhWriteOptions, ReadOptions, no_files, read_gltf, write_bvh, write_gltf, write_ragdoll,
};
use sinew::math::Affine;
use sinew::ragdoll::{BuildOptions, build};
use sinew_viewer::{Headless, NamedFile, Session, Subject};
use std::path::{Path, PathBuf};

/// Returns an empty folder of this test.
pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    if folder.exists() {
        std::fs::remove_dir_all(&folder).expect("the folder can be removed");
    }
    std::fs::create_dir_all(&folder).expect("the target folder exists");
    folder
}

/// Returns the mannequin as a file.
pub fn mannequin_glb() -> Vec<u8> {
    let mannequin = sinew::mannequin::mannequin();
    write_gltf(&mannequin.rig, &mannequin.clips).expect("the rig can be written as glTF")
}

#[test]
fn dropped_character_falls() {
    let Some(mut viewer) = viewer("pendulum", [640, 360]) else { return };
    let path = folder("dropped_character").join("mannequin.glb");
    std::fs::write(&path, mannequin_glb()).expect("the folder exists");
    viewer.app_mut().open_file(&path);
    let session = viewer.app().session();
    assert_eq!(session.subject().title(), "mannequin.glb");
    assert!(session.report()[0].ends_with("4 clips"), "{:?}", session.report());
    falls(&mut viewer, "dropped");
}

/// Returns the height of the highest body, metres.
fn height(viewer: &Headless) -> f32 {
    let world = viewer.app().session().world();
    world.body_ids().map(|id| world.transform(id).translation.y).fold(0.0, f32::max)
}

/// Runs two seconds of steps, after which standing characters lie on the ground.
fn falls(viewer: &mut Headless, name: &str) {
    let before = height(viewer);
    for _ in 0..120 {
        viewer.key(egui::Key::N);
        viewer.frame().expect("the card draws");
    }
    look(name, &viewer.frame().expect("the card draws"));
    assert_eq!(viewer.app().session().world().step_count(), 120);
    let after = height(viewer);
    assert!(before > 1.2 && after < 0.5 * before, "highest body at {before} m, later at {after} m");
}

/// A dropped ragdoll without its rig: its bodies fall.
#[test]
fn dropped_ragdoll_falls() {
    let Some(mut viewer) = viewer("pendulum", [640, 360]) else { return };
    let mannequin = sinew::mannequin::mannequin();
    let analysis = analyze(&mannequin.rig).expect("the rig has a skin");
    let (def, _) = build(&mannequin.rig, &analysis, &BuildOptions::default()).expect("and bones");
    let path = folder("dropped_ragdoll").join("mannequin.sinew.json");
    std::fs::write(&path, write_ragdoll(&def)).expect("the folder exists");
    viewer.app_mut().open_file(&path);
    let session = viewer.app().session();
    assert_eq!(session.subject().title(), "mannequin.sinew.json");
    assert_eq!(session.world().body_ids().count(), def.bodies.len() + 1);
    falls(&mut viewer, "dropped_ragdoll");
}

/// Bytes with names, as a page passes them: a glTF finds the file beside it, and has the bits of the same file on a disk.
#[test]
fn dropped_bytes_load_like_files() {
    let Some(mut viewer) = viewer("pendulum", [640, 360]) else { return };
    let folder = folder("dropped_on_a_page");
    let glb = mannequin_glb();
    let (json, binary) = parts(&glb);
    let mut json: serde_json::Value = serde_json::from_slice(json).expect("the chunk is JSON");
    json["buffers"][0]["uri"] = "mannequin.bin".into();
    let json = json.to_string().into_bytes();
    std::fs::write(folder.join("mannequin.gltf"), &json).expect("the folder exists");
    std::fs::write(folder.join("mannequin.bin"), binary).expect("the folder exists");
    viewer.app_mut().open_file(&folder.join("mannequin.gltf"));
    falls(&mut viewer, "with_a_folder");
    let hash = viewer.app().session().world().hash();
    let file = |name: &str, bytes: &[u8]| NamedFile { name: name.into(), bytes: bytes.to_vec() };
    viewer.app_mut().open_dropped(vec![file("mannequin.bin", binary), file("mannequin.gltf", &json)]);
    assert_eq!(viewer.app().session().subject().title(), "mannequin.gltf");
    falls(&mut viewer, "without_a_folder");
    assert_eq!(viewer.app().session().world().hash(), hash);
    viewer.app_mut().open_dropped(vec![file("alone.gltf", &json)]);
    let line = viewer.app().message().expect("a line");
    assert!(line.contains("alone.gltf") && line.contains("mannequin.bin"), "{line}");
    assert_eq!(viewer.app().session().subject().title(), "mannequin.gltf");
}

/// Returns the two chunks of a GLB.
fn parts(glb: &[u8]) -> (&[u8], &[u8]) {
    let length = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().expect("four bytes")) as usize;
    let json = 20 + length(12);
    (&glb[20..json], &glb[json + 8..json + 8 + length(json)])
}

#[test]
fn unreadable_files_give_a_message_and_change_nothing() {
    let Some(mut viewer) = viewer("pendulum", [640, 360]) else { return };
    let folder = folder("dropped_nonsense");
    let nonsense: [(&str, &[u8]); 6] = [
        ("cut.glb", b"glTF\x02\0\0\0\xff\0\0\0"),
        ("empty.vrm", b""),
        ("noise.fbx", b"Kaydara FBX Binary  \0\x1a\0\xff\xff\xff\xff"),
        ("world.json", b"{\"bodies\": ["),
        ("cut.sinewrec", b"sinewrec\x01\0"),
        ("picture.png", b"\x89PNG"),
    ];
    for (name, bytes) in nonsense {
        let path = folder.join(name);
        std::fs::write(&path, bytes).expect("the folder exists");
        viewer.app_mut().open_file(&path);
        let line = viewer.app().message().expect("a line").to_owned();
        println!("{line}");
        assert!(line.contains(name) && !line.contains('\n'), "{name}: {line}");
        assert_eq!(viewer.app().session().subject().title(), "pendulum", "{name}");
    }
}

/// A motion without a skin plays as bones.
#[test]
fn dropped_bvh_plays() {
    let Some(mut viewer) = viewer("pendulum", [640, 360]) else { return };
    let mannequin = sinew::mannequin::mannequin();
    let walk = &mannequin.clips[0];
    let bvh =
        write_bvh(&mannequin.rig, walk, &BvhWriteOptions::default()).expect("the clip can be written as BVH");
    let file = NamedFile { name: "walk.bvh".into(), bytes: bvh.text.into_bytes() };
    viewer.app_mut().open_dropped(vec![file]);
    assert_eq!(viewer.app().session().subject().title(), "walk.bvh", "{:?}", viewer.app().message());
    println!("{:?}", viewer.app().session().report());
    let head = |viewer: &Headless| {
        let figures = viewer.app().session().instance().figures();
        let rig = figures[0].rig;
        let head = rig.joints.iter().position(|joint| joint.name == "head").expect("the rig has this joint");
        figures[0].world_from_joint[head].translation
    };
    let before = head(&viewer);
    assert!((1.2..2.0).contains(&before.y), "the head is at {before}; expected metres, feet on the floor");
    let still = viewer.frame().expect("the card draws");
    for _ in 0..20 {
        viewer.app_mut().step();
    }
    let moved = viewer.frame().expect("the card draws");
    look("bvh", &moved);
    assert!((head(&viewer) - before).length() > 0.02, "it walks");
    assert_ne!(still, moved);
}

/// The saved file has the played motion as an additional clip with the same joint poses.
#[test]
fn played_motion_is_saved_as_glb() {
    let glb = mannequin_glb();
    let file = NamedFile { name: "mannequin.glb".into(), bytes: glb.clone() };
    let subject = Subject::dropped(vec![file]).expect("the file is a character");
    let mut session = Session::start(subject).expect("the character can be opened");
    assert!(session.to_glb().expect_err("no step yet").contains("nothing"));
    let poses: Vec<Vec<Affine>> = (0..=90)
        .map(|i| {
            if i > 0 {
                session.step();
            }
            session.instance().figures()[0].world_from_joint.to_vec()
        })
        .collect();
    let written = session.to_glb().expect("the session can be written as GLB");
    assert_eq!(written.name, "mannequin-played.glb");
    let mut none = no_files;
    let document =
        read_gltf(&written.bytes, ReadOptions::default(), &mut none).expect("the glTF can be read");
    let clip = document.clips.last().expect("the file has clips");
    assert_eq!((document.clips.len(), clip.name.as_str()), (5, "played"));
    assert!((clip.duration - 1.5).abs() < 1e-4, "{} s", clip.duration);
    // In the file the character stands upright at the world's origin with its soles on the floor; the unit is the metre.
    let root = Affine::from(session.workbench().expect("a ragdoll").def().character_from_model);
    let mut model = Vec::new();
    let mut pose = rest_pose(&document.rig);
    let mut worst = 0.0_f32;
    for (i, then) in poses.iter().enumerate() {
        sample(clip, &document.rig, i as f32 / 60.0, Wrap::Clamp, &mut pose);
        local_to_model(&document.rig, &pose, &root, &mut model);
        for (now, then) in model.iter().zip(then) {
            worst = worst.max((now.translation - then.translation).length());
        }
    }
    println!("farthest joint {worst} m");
    assert!(worst < 5e-4, "{worst} m");
}
