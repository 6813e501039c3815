//! Tests of reading any file with clips by one function.

use crate::data::{bar, files, shared_data};
use needs_data::needs_data;
use sinew_anim::ClipEvent;
use sinew_formats::{
    BvhWriteOptions, ErrorKind, MotionFormat, MotionOptions, no_files, read_motion, write_bvh, write_gltf,
};

#[test]
fn format_is_detected_from_bytes() {
    let is = |bytes: &[u8], format: MotionFormat| assert_eq!(MotionFormat::of(bytes).unwrap(), format);
    is(b"glTF\x02\0\0\0", MotionFormat::Glb);
    is(b" \n{\"asset\":{}}", MotionFormat::Gltf);
    is(b"\xEF\xBB\xBF\r\nhierarchy\n", MotionFormat::Bvh);
    is(b"{\"Frames\": []}", MotionFormat::DeepMimic);
    is(b"{\"Skeleton\": {}}", MotionFormat::DeepMimicCharacter);
    is(b"Kaydara FBX Binary  \0", MotionFormat::Fbx);
    is(b"; FBX 7.4.0 project file", MotionFormat::Fbx);
    for (bytes, what) in [(&b""[..], "empty"), (b"solid cube", "unknown first bytes"), (b"{", "not JSON")] {
        let error = MotionFormat::of(bytes).unwrap_err();
        assert!(error.kind == ErrorKind::Malformed && error.what.contains(what), "{error}");
    }
}

#[test]
fn clip_is_equal_from_both_formats() {
    let (rig, clip) = bar();
    let glb = write_gltf(&rig, std::slice::from_ref(&clip)).unwrap();
    let from_glb = read_motion(&glb, &MotionOptions::default(), &mut no_files).unwrap();
    assert_eq!(
        (from_glb.format, &from_glb.rig.joints, &from_glb.clips),
        (MotionFormat::Glb, &rig.joints, &vec![clip.clone()])
    );
    let bvh = write_bvh(&rig, &clip, &BvhWriteOptions::default()).unwrap().text;
    let from_bvh = read_motion(bvh.as_bytes(), &MotionOptions::default(), &mut no_files).unwrap();
    assert_eq!(
        (from_bvh.clips.len(), from_bvh.events.len(), from_bvh.clips[0].duration),
        (1, 1, clip.duration)
    );
    assert!((from_bvh.frame_time.unwrap() - 1.0 / 60.0).abs() < 1e-6);
}

#[test]
fn deepmimic_clip_without_its_character_is_rejected() {
    let clip = br#"{"Loop":"wrap","Frames":[[0.1]]}"#;
    let error = read_motion(clip, &MotionOptions::default(), &mut no_files).unwrap_err();
    assert!(error.kind == ErrorKind::Unsupported && error.what.contains("character"), "{error}");
}

#[test]
fn vrm_animation_has_the_roles_of_its_bones() {
    let json = r#"{"asset":{"version":"2.0"},"extensionsUsed":["VRMC_vrm_animation"],
        "nodes":[{"name":"a","children":[1]},{"name":"b"},{"name":"smile"}],
        "extensions":{"VRMC_vrm_animation":{"specVersion":"1.0","humanoid":{"humanBones":
            {"spine":{"node":1},"hips":{"node":0}}},"expressions":{"preset":{"happy":{"node":2}}}}}}"#;
    let file = read_motion(json.as_bytes(), &MotionOptions::default(), &mut no_files).unwrap();
    assert_eq!(file.rig.stated_roles, [("hips".to_owned(), 0), ("spine".to_owned(), 1)]);
    assert_eq!(file.notes, ["left out of a VRM animation: expressions of the face"]);
}

#[cfg(feature = "fs")]
#[needs_data]
#[test]
fn every_captured_file_loads_by_one_function() {
    let data = shared_data();
    let found = files(&data.join("mocap"), &["bvh", "txt"]);
    assert!(found.len() >= 9);
    for path in found {
        let file = sinew_formats::load_motion(&path, &MotionOptions::default()).unwrap();
        let is_character = file.format == MotionFormat::DeepMimicCharacter;
        assert_eq!((file.clips.len(), file.events.len()), (usize::from(!is_character), file.clips.len()));
        if let [clip] = &file.clips[..] {
            assert_eq!(clip.name, path.file_stem().unwrap().to_string_lossy());
        }
    }
}

#[cfg(feature = "fs")]
#[test]
fn events_file_applies_to_the_named_clips() {
    use sinew_formats::{events_path, load_motion, write_events, write_motion};
    let folder = std::env::temp_dir().join(format!("sinew-formats-events-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("bar.glb");
    let (rig, clip) = bar();
    let clips = [
        sinew_anim::Clip { name: "a".into(), ..clip.clone() },
        sinew_anim::Clip { name: "b".into(), ..clip },
    ];
    let own = [vec![ClipEvent::new(0.1, "own")], vec![ClipEvent::new(0.1, "own")]];
    std::fs::write(&path, write_motion(&rig, &clips, &own).unwrap()).unwrap();
    assert_eq!(load_motion(&path, &MotionOptions::default()).unwrap().events, own);
    let beside = events_path(&path);
    assert_eq!(beside.file_name().unwrap(), "bar.events.json");
    std::fs::write(&beside, write_events(&clips, &[Vec::new(), vec![ClipEvent::new(0.2, "beside")]]))
        .unwrap();
    let read = load_motion(&path, &MotionOptions::default()).unwrap();
    assert_eq!(read.events, [own[0].clone(), vec![ClipEvent::new(0.2, "beside")]]);
    std::fs::write(&beside, "{}").unwrap();
    let error = load_motion(&path, &MotionOptions::default()).unwrap_err();
    assert!(error.file.ends_with("bar.events.json") && error.where_ == "top level", "{error}");
    std::fs::remove_dir_all(&folder).unwrap();
}
