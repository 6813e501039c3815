//! Compares each storage form of vertex data with the original numbers.

use sinew_anim::{Primitive, Rig};
use sinew_formats::{ReadOptions, no_files, read_gltf};
use sinew_math::{Affine, Rotation, Vec3};

/// Reads a file with one mesh: `primitive` without its braces, accessors, views and the bytes of its only buffer;
/// returns the primitive.
fn read(primitive: &str, accessors: &str, views: &str, bytes: &[u8]) -> Primitive {
    let escaped: String = bytes.iter().map(|b| format!("%{b:02x}")).collect();
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{{primitive}}}]}}],
        "accessors":[{accessors}],"bufferViews":[{views}],
        "buffers":[{{"byteLength":{},"uri":"data:application/octet-stream,{escaped}"}}]}}"#,
        bytes.len()
    );
    let document = read_gltf(json.as_bytes(), ReadOptions::default(), &mut no_files).unwrap();
    document.rig.meshes[0].primitives[0].clone()
}

/// Returns the little-endian bytes of points.
fn floats(points: &[[f32; 3]]) -> Vec<u8> {
    points.iter().flatten().flat_map(|x| x.to_le_bytes()).collect()
}

const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
const POSITIONS: &str = r#"{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"}"#;
const VIEW: &str = r#"{"buffer":0,"byteLength":48}"#;

fn normal(p: &Primitive, triangle: usize) -> Vec3 {
    let corner = |k: usize| p.positions[p.indices[3 * triangle + k] as usize];
    (corner(1) - corner(0)).cross(corner(2) - corner(0))
}

#[test]
fn strips_and_fans_keep_their_winding() {
    let strip = read(r#""attributes":{"POSITION":0},"mode":5"#, POSITIONS, VIEW, &floats(&SQUARE));
    assert_eq!(strip.indices, [0, 1, 2, 1, 3, 2]);
    let around = [SQUARE[0], SQUARE[1], SQUARE[3], SQUARE[2]];
    let fan = read(r#""attributes":{"POSITION":0},"mode":6"#, POSITIONS, VIEW, &floats(&around));
    for part in [strip, fan] {
        assert_eq!([normal(&part, 0), normal(&part, 1)], [Vec3::Z; 2]);
    }
}

#[test]
fn indices_of_every_width_give_the_same_triangles() {
    for (component, index) in [
        (5121, vec![3, 1, 0]),
        (5123, vec![3, 0, 1, 0, 0, 0]),
        (5125, vec![3, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0]),
    ] {
        let mut bytes = floats(&SQUARE);
        let size = index.len();
        bytes.extend(index);
        let accessors = format!(
            r#"{POSITIONS},{{"bufferView":1,"componentType":{component},"count":3,"type":"SCALAR"}}"#
        );
        let views = format!(r#"{VIEW},{{"buffer":0,"byteOffset":48,"byteLength":{size}}}"#);
        let part = read(r#""attributes":{"POSITION":0},"indices":1"#, &accessors, &views, &bytes);
        assert_eq!(part.indices, [3, 1, 0]);
    }
}

#[test]
fn interleaved_and_sparse_positions_are_read() {
    let mut bytes = Vec::new();
    for p in SQUARE {
        bytes.extend(floats(&[p]));
        bytes.extend([0xFF; 4]);
    }
    let accessor = r#"{"bufferView":0,"byteOffset":0,"componentType":5126,"count":4,"type":"VEC3"}"#;
    let view = r#"{"buffer":0,"byteLength":60,"byteStride":16}"#;
    let part = read(r#""attributes":{"POSITION":0}"#, accessor, view, &bytes);
    assert_eq!(part.positions, SQUARE.map(Vec3::from_array));

    // Without a base, all elements are zero except the replaced one.
    let mut bytes = vec![2, 0, 0, 0];
    bytes.extend(floats(&[[7.0, 8.0, 9.0]]));
    let accessor = r#"{"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,
        "indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":0,"byteOffset":4}}}"#;
    let part = read(r#""attributes":{"POSITION":0}"#, accessor, r#"{"buffer":0,"byteLength":16}"#, &bytes);
    assert_eq!(part.positions, [Vec3::ZERO, Vec3::ZERO, Vec3::new(7.0, 8.0, 9.0)]);
}

#[test]
fn normalised_integers_follow_the_formula_of_the_format() {
    let bytes = [0x7F, 0x81, 0x80, 0, 0, 0, 64, 0];
    let accessor = r#"{"bufferView":0,"componentType":5120,"normalized":true,"count":2,"type":"VEC3"}"#;
    let view = r#"{"buffer":0,"byteLength":8,"byteStride":4}"#;
    let part = read(r#""attributes":{"POSITION":0}"#, accessor, view, &bytes);
    assert_eq!(part.positions, [Vec3::new(1.0, -1.0, -1.0), Vec3::new(0.0, 0.0, 64.0 / 127.0)]);
}

fn rig(json: &str) -> Rig {
    read_gltf(json.as_bytes(), ReadOptions::default(), &mut no_files).unwrap().rig
}

#[test]
fn node_matrix_becomes_an_equal_transform() {
    let rig = rig(r#"{"asset":{"version":"2.0"},"nodes":[
        {"matrix":[0,2,0,0, -3,0,0,0, 0,0,-4,0, 5,6,7,1]}]}"#);
    let map: Affine = rig.joints[0].rest.to_affine();
    for (point, image) in [(Vec3::X, [5.0, 8.0, 7.0]), (Vec3::Y, [2.0, 6.0, 7.0]), (Vec3::Z, [5.0, 6.0, 3.0])]
    {
        assert!(map.point(point).distance(Vec3::from_array(image)) < 1e-5, "{point}");
    }
    assert_eq!(rig.joints[0].rest.scale, Vec3::new(2.0, 3.0, -4.0));
}

#[test]
fn default_scene_and_all_skin_joints_are_read() {
    let rig = rig(r#"{"asset":{"version":"2.0"},"scene":1,"scenes":[{"nodes":[0]},{"nodes":[2]}],
        "skins":[{"joints":[4]}],
        "nodes":[{"name":"other"},{"name":"leaf","rotation":[0,0,0.6,0.8]},{"name":"root","children":[1]},
            {"name":"armature","children":[4]},{"name":"bone"}]}"#);
    let names: Vec<_> = rig.joints.iter().map(|j| (j.name.as_str(), j.parent, j.source)).collect();
    assert_eq!(names, [("root", None, 2), ("leaf", Some(0), 1), ("armature", None, 3), ("bone", Some(2), 4)]);
    assert_eq!(rig.joints[1].rest.rotation, Rotation::from_xyzw(0.0, 0.0, 0.6, 0.8));
    assert_eq!(rig.skins[0].joints, [3]);
    assert_eq!(rig.skins[0].inverse_bind, [Affine::IDENTITY]);
}
