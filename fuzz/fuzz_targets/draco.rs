//! A Draco stream in a glTF that states the size of its content: it is read, or refused with the location of the error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_formats::{ReadOptions, no_files, read_gltf};

/// A GLB whose only mesh is the stream, with that many vertices and triangles by its accessors.
fn glb(stream: &[u8], vertices: usize, triangles: usize) -> Vec<u8> {
    let accessor = |component: u32, kind: &str, count: usize| {
        format!(r#"{{"componentType":{component},"type":"{kind}","count":{count}}}"#)
    };
    let accessors = [
        accessor(5125, "SCALAR", 3 * triangles),
        accessor(5126, "VEC3", vertices),
        accessor(5126, "VEC2", vertices),
        accessor(5121, "VEC4", vertices),
        accessor(5126, "VEC4", vertices),
    ];
    let length = stream.len();
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"extensionsUsed":["KHR_draco_mesh_compression"],
"extensionsRequired":["KHR_draco_mesh_compression"],"buffers":[{{"byteLength":{length}}}],
"bufferViews":[{{"buffer":0,"byteLength":{length}}}],"accessors":[{}],
"nodes":[{{"mesh":0,"skin":0}},{{}},{{}}],"skins":[{{"joints":[1,2]}}],
"meshes":[{{"primitives":[{{"indices":0,
"attributes":{{"POSITION":1,"TEXCOORD_0":2,"JOINTS_0":3,"WEIGHTS_0":4}},
"extensions":{{"KHR_draco_mesh_compression":{{"bufferView":0,
"attributes":{{"POSITION":0,"TEXCOORD_0":1,"JOINTS_0":2,"WEIGHTS_0":3}}}}}}}}]}}]}}"#,
        accessors.join(",")
    );
    let (mut text, mut bin) = (json.into_bytes(), stream.to_vec());
    text.resize(text.len().div_ceil(4) * 4, b' ');
    bin.resize(bin.len().div_ceil(4) * 4, 0);
    let size = |bytes: &[u8]| (bytes.len() as u32).to_le_bytes();
    let mut glb = [b"glTF".as_slice(), &2u32.to_le_bytes(), &[0; 4]].concat();
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &bin)] {
        glb.extend([size(chunk).as_slice(), kind.as_slice(), chunk].concat());
    }
    let total = size(&glb);
    glb[8..12].copy_from_slice(&total);
    glb
}

fuzz_target!(|bytes: &[u8]| {
    let [vertices, triangles, stream @ ..] = bytes else { return };
    let file = glb(stream, usize::from(*vertices), usize::from(*triangles));
    if let Err(error) = read_gltf(&file, ReadOptions::default(), &mut no_files) {
        assert!(!error.what.is_empty() && !error.where_.is_empty(), "{error}");
    }
});
