//! Malicious bytes: each gives an error with a location, without a panic and without large allocations.

use crate::data::{GLTF, files, shared_data};
use needs_data::needs_data;
use sinew_formats::{
    Error, MotionOptions, ReadOptions, Result, Textures, append_clip, load_gltf, no_files, read_gltf,
    read_mjcf, read_motion, read_obj, read_ragdoll, read_world,
};
use sinew_math::Random;
use std::path::Path;

const DECODE: ReadOptions = ReadOptions { textures: Textures::Decode };

/// Returns the error of the reader for a JSON text, or "" if the text is accepted.
fn complaint(json: &str) -> String {
    read_gltf(json.as_bytes(), DECODE, &mut no_files).err().map(|e| e.to_string()).unwrap_or_default()
}

/// Returns a GLB of a JSON text and a binary chunk.
fn glb(json: &str, bin: &[u8]) -> Vec<u8> {
    let padded = json.to_owned() + &" ".repeat(json.len().next_multiple_of(4) - json.len());
    let total = 12 + 8 + padded.len() + 8 + bin.len();
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((total as u32).to_le_bytes());
    for (kind, data) in [(b"JSON", padded.as_bytes()), (b"BIN\0", bin)] {
        bytes.extend((data.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(data);
    }
    bytes
}

/// Returns a skinned triangle, small enough to cut at every byte. `joints` are the twelve slots of its vertices.
fn triangle(joints: [u8; 12]) -> Vec<u8> {
    let json = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
        "nodes":[{"mesh":0,"skin":0},{"name":"bone"}],"skins":[{"joints":[1]}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2}}]}],
        "animations":[{"channels":[{"sampler":0,"target":{"node":1,"path":"translation"}}],
            "samplers":[{"input":3,"output":0}]}],
        "accessors":[
            {"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
            {"bufferView":1,"componentType":5121,"count":3,"type":"VEC4"},
            {"bufferView":2,"componentType":5121,"normalized":true,"count":3,"type":"VEC4"},
            {"bufferView":3,"componentType":5126,"count":3,"type":"SCALAR"}],
        "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":12},
            {"buffer":0,"byteOffset":48,"byteLength":12},{"buffer":0,"byteOffset":60,"byteLength":12}],
        "buffers":[{"byteLength":72}]}"#;
    let mut bin = Vec::new();
    bin.extend([0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()));
    bin.extend(joints);
    bin.extend([255, 0, 0, 0, 200, 55, 0, 0, 0, 0, 0, 0]);
    bin.extend([0.0_f32, 0.5, 1.0].iter().flat_map(|x| x.to_le_bytes()));
    glb(json, &bin)
}

#[test]
fn complete_triangle_is_read() {
    let document = read_gltf(&triangle([0; 12]), DECODE, &mut no_files).unwrap();
    let part = &document.rig.meshes[0].primitives[0];
    assert_eq!(part.indices, [0, 1, 2]);
    assert_eq!(part.weights[1], [200.0 / 255.0, 55.0 / 255.0, 0.0, 0.0]);
    assert_eq!(part.weights[2], [1.0, 0.0, 0.0, 0.0]);
    assert_eq!(document.clips[0].channels[0].times, [0.0, 0.5, 1.0]);
}

#[test]
fn every_prefix_of_a_glb_is_rejected() {
    let whole = triangle([0; 12]);
    for length in 0..whole.len() {
        let error = read_gltf(&whole[..length], DECODE, &mut no_files).unwrap_err();
        assert!(!error.what.is_empty() && !error.where_.is_empty(), "{length}: {error}");
    }
}

#[test]
fn chunk_with_a_length_of_four_gibibytes_is_rejected() {
    let mut bytes = triangle([0; 12]);
    bytes[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
    let error = read_gltf(&bytes, DECODE, &mut no_files).unwrap_err();
    let there = bytes.len() - 20;
    assert_eq!(error.to_string(), format!("chunk claims 4294967295 bytes, {there} are there (byte 12)"));
}

#[test]
fn text_file_is_rejected_as_glb() {
    let error = read_gltf(b"hello\n", DECODE, &mut no_files).unwrap_err();
    let said = error.with_file("x.glb").to_string();
    assert_eq!(said, "x.glb: not a glTF file: begins neither with `glTF` nor with `{` (byte 0)");
}

#[test]
fn joint_index_out_of_range_is_rejected() {
    let error =
        read_gltf(&triangle([0, 0, 0, 0, 0, 7, 0, 0, 0, 0, 0, 0]), DECODE, &mut no_files).unwrap_err();
    assert_eq!(
        error.to_string(),
        "vertex 1: joint index 7 is out of range: the skin has 1 (meshes[0].primitives[0].attributes.JOINTS_0)"
    );
}

#[test]
fn errors_name_the_place() {
    for (json, expected) in [
        (r#"{"asset":{"version":"1.0"}}"#, "glTF version `1.0` is not supported, only 2.0 (asset.version)"),
        ("{}", "`asset` is missing (top level)"),
        (r#"{"asset":7}"#, "must be an object (asset)"),
        (r#"{"asset":"#, "not JSON: EOF while parsing a value (line 1 column 9)"),
        (
            r#"{"asset":{"version":"2.0"},"extensionsRequired":["EXT_magic"]}"#,
            "needs the extension `EXT_magic`, which is not supported (extensionsRequired[0])",
        ),
        (
            r#"{"asset":{"version":"2.0"},"nodes":[{"children":[1]},{"children":[9]}]}"#,
            "index 9 is out of range: there are 2 nodes (nodes[1].children[0])",
        ),
        (
            r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"children":[1]},{"children":[0]}]}"#,
            "node is its own ancestor, or listed twice in a scene (nodes[0])",
        ),
        (
            r#"{"asset":{"version":"2.0"},"scenes":[{}],"skins":[{"joints":[1]}],
                "nodes":[{"children":[1]},{"children":[0]}]}"#,
            "node is its own ancestor (nodes[1])",
        ),
        (
            r#"{"asset":{"version":"2.0"},"nodes":[{"translation":[0,1e39,0]}]}"#,
            "number is too large (nodes[0].translation[1])",
        ),
        (
            r#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":9,"uri":"data:;base64,AAAA"}]}"#,
            "buffer claims 9 bytes, 3 are there (buffers[0].byteLength)",
        ),
        (
            r#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":9,"uri":"../../etc/passwd"}]}"#,
            "URI `../../etc/passwd` leaves the folder of the file (buffers[0].uri)",
        ),
        (
            r#"{"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
                "accessors":[{"componentType":5126,"count":4000000000,"type":"VEC3"}]}"#,
            "4000000000 elements are more than the size of the file justifies (accessors[0])",
        ),
    ] {
        assert_eq!(complaint(json), expected);
    }
}

/// Checks that one mesh placed by very many nodes does not use much memory.
#[test]
fn memory_of_instances_is_bounded() {
    let bin = vec![0; 1_200_000];
    let nodes = vec![r#"{"mesh":0}"#; 20_000].join(",");
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{nodes}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],"buffers":[{{"byteLength":1200000}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":100000,"type":"VEC3"}}],
        "bufferViews":[{{"buffer":0,"byteLength":1200000}}]}}"#
    );
    let error = read_gltf(&glb(&json, &bin), DECODE, &mut no_files).unwrap_err();
    assert!(error.what.contains("more than the size of the file justifies"), "{error}");
}

/// Checks that deep chains of nodes do not cause deep recursion.
#[test]
fn chain_of_100_000_nodes_is_read() {
    let nodes: Vec<_> = (1..100_000).map(|i| format!(r#"{{"children":[{i}]}}"#)).collect();
    let json = format!(r#"{{"asset":{{"version":"2.0"}},"nodes":[{},{{}}]}}"#, nodes.join(","));
    let document = read_gltf(json.as_bytes(), DECODE, &mut no_files).unwrap();
    assert_eq!(document.rig.joints.len(), 100_000);
    assert_eq!(document.rig.joints[99_999].parent, Some(99_998));
}

/// Reads a file and, if that works, checks the promises of the types.
fn read_and_check(bytes: &[u8], path: &Path) -> Result<()> {
    let folder = path.parent().unwrap();
    let mut beside = |name: &str| std::fs::read(folder.join(name)).or_else(|_| no_files(name));
    let document = read_gltf(bytes, DECODE, &mut beside)?;
    crate::rigs::assert_sound(&document);
    if let Some(clip) = document.clips.iter().find(|c| !c.channels.is_empty()) {
        append_clip(&document, clip, "again", None).map(drop)?;
    }
    Ok(())
}

fn assert_one_line(error: &Error) {
    let text = error.to_string();
    assert!(!text.chars().any(char::is_control) && text.len() < 600, "{text}");
}

#[needs_data]
#[test]
fn malicious_files_give_errors() {
    let data = shared_data();
    let (mut read, mut refused) = (0, 0);
    for folder in ["bad_input", "negative", "worlds"] {
        for path in files(&data.join(folder), &GLTF) {
            match read_and_check(&std::fs::read(&path).unwrap(), &path) {
                Ok(()) => read += 1,
                Err(e) => {
                    refused += 1;
                    let e = e.with_file(path.file_name().unwrap().to_str().unwrap());
                    assert_one_line(&e);
                    println!("{e}");
                }
            }
        }
    }
    println!("{read} read, {refused} refused");
    assert!(read > 60 && refused > 40, "{read} files read, {refused} refused");
}

#[needs_data]
#[test]
fn valid_files_without_characters_are_read() {
    let data = shared_data();
    for path in files(&data.join("negative"), &GLTF) {
        load_gltf(&path, DECODE).unwrap_or_else(|e| panic!("{e}"));
    }
}

/// Changes random bytes in small rigs: 2,000 cases with `SINEW_FULL` set, otherwise a tenth.
#[needs_data]
#[test]
fn mutated_rigs_do_not_panic() {
    let data = shared_data();
    let cases = if std::env::var_os("SINEW_FULL").is_some() { 2000 } else { 200 };
    for (seed, name) in ["RiggedSimple.glb", "SimpleSkin.gltf", "vrma_test.vrma"].iter().enumerate() {
        let path = data.join("rigs").join(name);
        let whole = std::fs::read(&path).unwrap();
        let mut random = Random::new(seed as u64);
        for _ in 0..cases {
            let mut bytes = whole.clone();
            for _ in 0..=random.index(8) {
                let at = random.index(bytes.len());
                bytes[at] = random.index(256) as u8;
            }
            if let Err(e) = read_and_check(&bytes, &path) {
                assert_one_line(&e);
            }
        }
    }
}

/// Passes bytes to each reader that may accept them.
fn read_as_whatever(bytes: &[u8], path: &Path) {
    let folder = path.parent().unwrap();
    let mut beside = |name: &str| std::fs::read(folder.join(name)).or_else(|_| no_files(name));
    let told = |error: Option<Error>| error.iter().for_each(assert_one_line);
    told(read_motion(bytes, &MotionOptions::default(), &mut beside).err());
    match path.extension().and_then(|e| e.to_str()) {
        Some("obj") => told(read_obj(bytes).err()),
        Some("xml") => told(read_mjcf(bytes).err()),
        Some("json") => {
            told(read_ragdoll(bytes).err());
            told(read_world(bytes).err());
        }
        _ => {}
    }
}

/// Truncates every short file at every 64th byte; the result is an error or a shorter file, never a panic. Files up to
/// 256 KiB with `SINEW_FULL` set.
#[test]
fn truncated_files_give_errors_or_shorter_files() {
    const EXTENSIONS: [&str; 10] = ["glb", "gltf", "vrm", "vrma", "bvh", "fbx", "obj", "xml", "json", "txt"];
    let longest = if std::env::var_os("SINEW_FULL").is_some() { 256 << 10 } else { 6 << 10 };
    let seeds = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/seeds")).to_path_buf();
    let (mut whole, mut cut) = (0, 0);
    for path in [seeds, shared_data()]
        .iter()
        .filter(|folder| folder.is_dir())
        .flat_map(|folder| files(folder, &EXTENSIONS))
    {
        if std::fs::metadata(&path).is_ok_and(|data| data.len() > longest) {
            continue;
        }
        let bytes = std::fs::read(&path).unwrap();
        for end in (0..bytes.len()).step_by(64) {
            read_as_whatever(&bytes[..end], &path);
            cut += 1;
        }
        whole += 1;
    }
    println!("{whole} files, {cut} cuts");
    assert!(whole >= 8, "{whole} files");
}
