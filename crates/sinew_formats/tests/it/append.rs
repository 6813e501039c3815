//! Writes a clip into the user's own file: all old content stays, and the clip reads back equal.

use crate::data::{GLTF, files, shared_data};
use needs_data::needs_data;
use serde_json::{Value, json};
use sinew_anim::{Channel, Clip, Interpolation, Property};
use sinew_formats::{Container, Document, ReadOptions, append_clip, load_gltf, no_files, read_gltf};

/// Returns a motion of every joint that has neither a matrix nor a skinned mesh, with every kind of channel.
fn motion(document: &Document) -> Clip {
    let free = |joint: &usize| {
        let node = &document.json["nodes"][document.rig.joints[*joint].source];
        node.get("matrix").is_none() && node.get("skin").is_none()
    };
    let mut clip = Clip { name: "Moved".into(), duration: 1.1, channels: Vec::new() };
    for joint in (0..document.rig.joints.len()).filter(free) {
        let times = vec![0.0, 0.1, 1.1];
        clip.channels.push(Channel {
            joint,
            property: Property::Rotation,
            interpolation: Interpolation::Linear,
            times: times.clone(),
            values: vec![0.0, 0.0, 0.0, 1.0, 0.6, 0.0, 0.0, 0.8, 0.0, 0.6, 0.8, 0.0],
        });
        clip.channels.push(Channel {
            joint,
            property: Property::Translation,
            interpolation: Interpolation::CubicSpline,
            times,
            values: (0..27).map(|i| i as f32 * 0.1).collect(),
        });
        clip.channels.push(Channel {
            joint,
            property: Property::Scale,
            interpolation: Interpolation::Step,
            times: vec![0.25],
            values: vec![1.0, 1.0, 1.0],
        });
    }
    clip
}

/// Checks that `new` has everything in `old` at the same path; lists may be longer. Paths in `allowed` may differ.
fn assert_kept(old: &Value, new: &Value, path: &str, allowed: &dyn Fn(&str) -> bool) {
    if allowed(path) {
        return;
    }
    match (old, new) {
        (Value::Object(old), Value::Object(new)) => {
            let order: Vec<_> = new.keys().filter(|k| old.contains_key(*k)).collect();
            let kept: Vec<_> = old.keys().filter(|k| new.contains_key(*k)).collect();
            assert_eq!(order, kept, "{path}: order of keys");
            for (key, value) in old {
                let path = format!("{path}.{key}");
                assert_kept(value, new.get(key).unwrap_or(&Value::Null), &path, allowed);
            }
        }
        (Value::Array(old), Value::Array(new)) => {
            assert!(new.len() >= old.len(), "{path}");
            for (i, value) in old.iter().enumerate() {
                assert_kept(value, &new[i], &format!("{path}[{i}]"), allowed);
            }
        }
        _ => assert_eq!(old, new, "{path}"),
    }
}

#[needs_data]
#[test]
fn appending_keeps_the_old_content() {
    let data = shared_data();
    for path in files(&data.join("rigs"), &GLTF) {
        let old = load_gltf(&path, ReadOptions::default()).unwrap();
        let clip = motion(&old);
        let extras = json!({"sinew_events": []});
        let bytes = append_clip(&old, &clip, "Moved", Some(extras.clone())).unwrap();
        // Keeps the outputs for the Khronos glTF validator.
        if let Some(folder) = std::env::var_os("SINEW_KEEP_OUTPUTS") {
            let name = path.file_name().unwrap().to_str().unwrap();
            std::fs::write(std::path::Path::new(&folder).join(format!("{name}.glb")), &bytes).unwrap();
        }
        let new = read_gltf(&bytes, ReadOptions::default(), &mut no_files).unwrap();

        let from_text = old.container == Container::Gltf;
        assert_kept(&old.json, &new.json, "", &|path| {
            path == ".buffers[0].byteLength"
                || from_text
                    && (path == ".buffers[0].uri" || path.starts_with(".images[") && path.ends_with(".uri"))
        });
        if let Some(bin) = &old.bin {
            assert!(new.bin.as_ref().unwrap().starts_with(bin), "{}", path.display());
        }
        assert_eq!(new.rig, old.rig, "{}", path.display());
        assert_eq!(new.clips.last(), Some(&clip), "{}", path.display());
        assert_eq!(new.clips[..old.clips.len()], old.clips, "{}", path.display());
        assert_eq!(new.json["animations"][old.clips.len()]["extras"], extras);
    }
}

const WITH_MATRIX: &str = r#"{"asset":{"version":"2.0"},"nodes":[
    {"matrix":[0,1,0,0, -1,0,0,0, 0,0,1,0, 5,6,7,1],"children":[1]},{"name":"leaf"}]}"#;

fn shift(joint: usize, to: [f32; 3]) -> Channel {
    Channel {
        joint,
        property: Property::Translation,
        interpolation: Interpolation::Linear,
        times: vec![0.0],
        values: to.to_vec(),
    }
}

#[test]
fn matrix_is_replaced_only_if_the_clip_moves_its_node() {
    let document = read_gltf(WITH_MATRIX.as_bytes(), ReadOptions::default(), &mut no_files).unwrap();
    let still =
        Clip { channels: vec![shift(0, [5.0, 6.0, 7.0]), shift(1, [1.0, 0.0, 0.0])], ..Clip::default() };
    let bytes = append_clip(&document, &still, "", None).unwrap();
    let new = read_gltf(&bytes, ReadOptions::default(), &mut no_files).unwrap();
    assert_eq!(new.json["nodes"], document.json["nodes"]);
    assert_eq!(new.clips[0].channels, [shift(1, [1.0, 0.0, 0.0])]);

    let moving = Clip { channels: vec![shift(0, [5.0, 6.0, 8.0])], ..Clip::default() };
    let bytes = append_clip(&document, &moving, "", None).unwrap();
    let new = read_gltf(&bytes, ReadOptions::default(), &mut no_files).unwrap();
    assert!(new.json["nodes"][0].get("matrix").is_none());
    assert_eq!(new.rig, document.rig);
    assert_eq!(new.clips[0].channels, moving.channels);
}

#[test]
fn numbers_are_copied_with_every_digit() {
    let text = r#"{"asset":{"version":"2.0","extras":[0.10000000149011612,1e-45,123456789012345678,
        2.2250738585072011e-308,-0.0,9007199254740993]},"nodes":[{}]}"#;
    let document = read_gltf(text.as_bytes(), ReadOptions::default(), &mut no_files).unwrap();
    let clip = Clip { channels: vec![shift(0, [1.0, 0.0, 0.0])], ..Clip::default() };
    let bytes = append_clip(&document, &clip, "", None).unwrap();
    let new = read_gltf(&bytes, ReadOptions::default(), &mut no_files).unwrap();
    assert_eq!(new.json["asset"], document.json["asset"]);
    let text = String::from_utf8_lossy(&bytes);
    assert!(text.contains("0.10000000149011612,1e-45,123456789012345678,"), "{text}");
}

#[test]
fn clip_without_motion_is_rejected_in_one_line() {
    let document = read_gltf(WITH_MATRIX.as_bytes(), ReadOptions::default(), &mut no_files).unwrap();
    let error = append_clip(&document, &Clip::default(), "", None).unwrap_err();
    assert_eq!(error.to_string(), "the clip moves nothing: there is no channel to write (animations)");
}

/// A strip of skin with a morph target, and the target's weight in the mesh.
const STRIP: &[u8] = include_bytes!("../../../../fuzz/seeds/gltf/strip_nan_normals.glb");

#[test]
fn morph_targets_are_kept() {
    let old = read_gltf(STRIP, ReadOptions::default(), &mut no_files).unwrap();
    let bytes = append_clip(&old, &motion(&old), "Moved", None).unwrap();
    let new = read_gltf(&bytes, ReadOptions::default(), &mut no_files).unwrap();
    let mesh = |document: &Document| document.json["meshes"][0].clone();
    assert!(mesh(&old)["primitives"][0]["targets"][0]["POSITION"].is_u64(), "the file has a target");
    assert_eq!(mesh(&new), mesh(&old));
    let offsets = |document: &Document| {
        let accessor = &mesh(document)["primitives"][0]["targets"][0]["POSITION"];
        let json = &document.json;
        let accessor = &json["accessors"][usize::try_from(accessor.as_u64().unwrap()).unwrap()];
        let view = &json["bufferViews"][usize::try_from(accessor["bufferView"].as_u64().unwrap()).unwrap()];
        let number = |key: &str| usize::try_from(view[key].as_u64().unwrap_or(0)).unwrap();
        let start = number("byteOffset");
        document.bin.as_ref().unwrap()[start..start + number("byteLength")].to_vec()
    };
    assert!(offsets(&old).iter().any(|&byte| byte != 0));
    assert_eq!(offsets(&new), offsets(&old));
    assert_eq!(new.clips.len(), old.clips.len() + 1);
}

/// Returns a mannequin whose last vertices are bound to `neutral_bone`.
fn with_loose_vertices(count: usize) -> sinew_anim::Rig {
    let mut rig = sinew::mannequin::mannequin().rig;
    let mesh = rig.meshes.iter_mut().find(|mesh| mesh.skin.is_some()).expect("a skin");
    let skin = &mut rig.skins[mesh.skin.expect("a skin")];
    let slot = u16::try_from(skin.joints.len()).expect("few");
    skin.joints.push(rig.joints.len());
    skin.inverse_bind.push(sinew_math::Affine::IDENTITY);
    let primitive =
        mesh.primitives.iter_mut().find(|primitive| primitive.joints.len() > count).expect("skin");
    let first = primitive.joints.len() - count;
    primitive.joints[first..].fill([slot, 0, 0, 0]);
    primitive.weights[first..].fill([1.0, 0.0, 0.0, 0.0]);
    let source = rig.joints.len();
    rig.joints.push(sinew_anim::Joint {
        name: "neutral_bone".into(),
        parent: None,
        rest: sinew_anim::LocalTransform::default(),
        source,
    });
    rig
}

#[test]
fn inferred_weights_of_loose_vertices_are_written() {
    let file = sinew_formats::write_gltf(&with_loose_vertices(5), &[]).unwrap();
    let read = |bytes: &[u8]| read_gltf(bytes, ReadOptions::default(), &mut no_files).unwrap();
    let document = read(&file);
    assert_eq!(document.warnings, ["5 vertices have no bone: they follow the nearest skin"]);
    let neutral = document.rig.joints.iter().position(|joint| joint.name == "neutral_bone");
    let moves = |document: &Document| {
        let of_mesh = |mesh: &sinew_anim::RigMesh| {
            let joints = &document.rig.skins[mesh.skin?].joints;
            let mut slots = mesh.primitives.iter().flat_map(|part| part.joints.iter().map(|slots| slots[0]));
            slots.any(|slot| Some(joints[usize::from(slot)]) == neutral).then_some(())
        };
        document.rig.meshes.iter().find_map(of_mesh).is_some()
    };
    assert!(!moves(&document), "the neutral bone moves skin");
    let again = read(&append_clip(&document, &motion(&document), "moved", None).unwrap());
    assert_eq!(again.warnings, Vec::<String>::new(), "the file has no loose vertex any more");
    assert!(again.rig.skins == document.rig.skins, "the skins differ");
    let parts = |document: &Document| document.rig.meshes[0].primitives.clone();
    for (new, old) in parts(&again).iter().zip(parts(&document)) {
        assert!(new.positions == old.positions && new.joints == old.joints && new.indices == old.indices);
        let off = |(a, b): (&f32, &f32)| (a - b).abs();
        let weights = new.weights.as_flattened().iter().zip(old.weights.as_flattened());
        assert!(weights.map(off).fold(0.0, f32::max) < 1e-6, "other weights");
    }
}

#[test]
fn clip_with_keys_before_zero_starts_at_zero() {
    let mannequin = sinew::mannequin::mannequin();
    let mut clip = mannequin.clips[0].clone();
    let (duration, first) = (clip.duration, clip.channels[0].times[0]);
    clip.channels.iter_mut().flat_map(|channel| &mut channel.times).for_each(|time| *time -= 0.125);
    clip.duration -= 0.125;
    let file = sinew_formats::write_gltf(&mannequin.rig, &[clip]).unwrap();
    let document = read_gltf(&file, ReadOptions::default(), &mut no_files).unwrap();
    let read = &document.clips[0];
    assert!((read.channels[0].times[0] - first).abs() < 1e-6, "{} s", read.channels[0].times[0]);
    assert!((read.duration - duration).abs() < 1e-6, "{} s", read.duration);
    assert!(document.warnings[0].contains("keys from -0.125 s on"), "{:?}", document.warnings);
}
