//! FBX: a small text file made here, against closed forms.

use sinew_anim::{LocalTransform, Wrap, local_to_model, rest_pose, sample, skin_vertices};
use sinew_formats::{ErrorKind, MotionFile, read_fbx};
use sinew_math::{Affine, Random, Vec3, trig};
use std::fmt::Write as _;

/// Ticks of a second.
const SECOND: u64 = 46_186_158_000;

/// Corners of the box that hangs on the leg, centimetres, z up: 10 × 10 × 80.
fn corners() -> [[i32; 3]; 8] {
    core::array::from_fn(|i| {
        let at = |bit: usize, low, high| if i >> bit & 1 == 0 { low } else { high };
        [at(0, 5, 15), at(1, -5, 5), at(2, 20, 100)]
    })
}

fn array(name: &str, numbers: &[f64]) -> String {
    let text: Vec<String> = numbers.iter().map(ToString::to_string).collect();
    format!("{name}: *{} {{\n a: {}\n}}\n", numbers.len(), text.join(","))
}

fn limb(id: u32, name: &str, at: [i32; 3]) -> String {
    let [x, y, z] = at;
    format!(
        "Model: {id}, \"Model::{name}\", \"LimbNode\" {{\n Version: 232\n Properties70: {{\n \
         P: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",{x},{y},{z}\n }}\n}}\n"
    )
}

/// A cluster of the corners in `range`, on a limb that stood at `at` without a rotation.
fn cluster(id: u32, range: core::ops::Range<usize>, at: [f64; 3]) -> String {
    let matrix =
        |[x, y, z]: [f64; 3]| [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, y, z, 1.0];
    let indices: Vec<f64> = range.map(|i| i as f64).collect();
    format!(
        "Deformer: {id}, \"SubDeformer::\", \"Cluster\" {{\n Version: 100\n{}{}{}{}}}\n",
        array("Indexes", &indices),
        array("Weights", &vec![1.0; indices.len()]),
        array("Transform", &matrix(at.map(|x| -x))),
        array("TransformLink", &matrix(at)),
    )
}

/// Hips at a height of 1 m, a thigh 10 cm beside them and a shank 40 cm below, z up in centimetres. The thigh turns by 90°
/// about x within a second; a box is bound to thigh (upper four corners) and shank (lower four).
fn leg() -> String {
    let mut text = String::from(
        "; FBX 7.4.0 project file\nFBXHeaderExtension: {\n FBXHeaderVersion: 1003\n FBXVersion: 7400\n Creator: \"tests\"\n}\n\
         GlobalSettings: {\n Version: 1000\n Properties70: {\n",
    );
    for (name, value) in [
        ("UpAxis", 2),
        ("UpAxisSign", 1),
        ("FrontAxis", 1),
        ("FrontAxisSign", -1),
        ("CoordAxis", 0),
        ("CoordAxisSign", 1),
        ("UnitScaleFactor", 1),
        ("TimeMode", 6),
    ] {
        let _ = writeln!(text, " P: \"{name}\", \"int\", \"Integer\", \"\",{value}");
    }
    text.push_str(" }\n}\nObjects: {\n");
    text += &limb(100, "hips", [0, 0, 100]);
    text += &limb(101, "thigh", [10, 0, 0]);
    text += &limb(102, "shank", [0, 0, -40]);
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let polygons: Vec<f64> =
        faces.iter().flat_map(|&[a, b, c, d]| [a, b, c, -d - 1]).map(f64::from).collect();
    let positions: Vec<f64> = corners().as_flattened().iter().map(|&x| f64::from(x)).collect();
    let _ = write!(
        text,
        "Geometry: 200, \"Geometry::box\", \"Mesh\" {{\n{}{}}}\n",
        array("Vertices", &positions),
        array("PolygonVertexIndex", &polygons)
    );
    text += "Model: 201, \"Model::box\", \"Mesh\" {\n Version: 232\n}\n";
    text += "Deformer: 300, \"Deformer::\", \"Skin\" {\n Version: 101\n}\n";
    text += &cluster(301, 4..8, [10.0, 0.0, 100.0]);
    text += &cluster(302, 0..4, [10.0, 0.0, 60.0]);
    let _ = write!(
        text,
        "AnimationStack: 400, \"AnimStack::bend\", \"\" {{\n Properties70: {{\n \
         P: \"LocalStop\", \"KTime\", \"Time\", \"\",{SECOND}\n }}\n}}\n\
         AnimationLayer: 401, \"AnimLayer::base\", \"\" {{\n}}\n\
         AnimationCurveNode: 402, \"AnimCurveNode::R\", \"\" {{\n Properties70: {{\n \
         P: \"d|X\", \"Number\", \"\", \"A\",0\n }}\n}}\n\
         AnimationCurve: 403, \"AnimCurve::\", \"\" {{\n Default: 0\n KeyVer: 4008\n{}{}{}{}{}}}\n}}\n",
        array("KeyTime", &[0.0, SECOND as f64]),
        array("KeyValueFloat", &[0.0, 90.0]),
        array("KeyAttrFlags", &[4.0]),
        array("KeyAttrDataFloat", &[0.0; 4]),
        array("KeyAttrRefCount", &[2.0]),
    );
    text.push_str("Connections: {\n");
    for (from, to) in [
        (100, 0),
        (101, 100),
        (102, 101),
        (201, 0),
        (200, 201),
        (300, 200),
        (301, 300),
        (302, 300),
        (101, 301),
        (102, 302),
        (401, 400),
        (402, 401),
    ] {
        let _ = writeln!(text, " C: \"OO\",{from},{to}");
    }
    text += " C: \"OP\",402,101, \"Lcl Rotation\"\n C: \"OP\",403,402, \"d|X\"\n}\n";
    text
}

fn pose_at(file: &MotionFile, time: f32) -> Vec<Affine> {
    let mut pose: Vec<LocalTransform> = rest_pose(&file.rig);
    if let [clip] = &file.clips[..] {
        sample(clip, &file.rig, time, Wrap::Clamp, &mut pose);
    }
    let mut model = Vec::new();
    local_to_model(&file.rig, &pose, &Affine::IDENTITY, &mut model);
    model
}

fn near(a: Vec3, b: Vec3) {
    assert!((a - b).length() < 1e-5, "{a} is not {b}");
}

#[test]
fn joints_stand_in_metres_with_y_up() {
    let file = read_fbx(leg().as_bytes()).unwrap();
    let joints: Vec<(&str, Option<usize>)> =
        file.rig.joints.iter().map(|joint| (joint.name.as_str(), joint.parent)).collect();
    let place = |name: &str| joints.iter().position(|&(own, _)| own == name).unwrap();
    let [hips, thigh, shank] = ["hips", "thigh", "shank"].map(place);
    assert_eq!((joints[hips].1, joints[thigh].1, joints[shank].1), (None, Some(hips), Some(thigh)));
    assert!(file.rig.joints.iter().enumerate().all(|(i, joint)| joint.parent.is_none_or(|p| p < i)));
    let mut model = Vec::new();
    local_to_model(&file.rig, &rest_pose(&file.rig), &Affine::IDENTITY, &mut model);
    near(model[hips].translation, Vec3::Y);
    near(model[thigh].translation, Vec3::new(0.1, 1.0, 0.0));
    near(model[shank].translation, Vec3::new(0.1, 0.6, 0.0));
    assert!(file.rig.joints.iter().all(|joint| (joint.rest.scale - Vec3::ONE).length() < 1e-6));
    assert_eq!((file.generator.as_str(), file.frame_time), ("tests", Some(1.0 / 30.0)));
}

#[test]
fn the_thigh_turns_evenly() {
    let file = read_fbx(leg().as_bytes()).unwrap();
    assert_eq!((file.clips.len(), file.clips[0].name.as_str(), file.clips[0].duration), (1, "bend", 1.0));
    let shank = file.rig.joints.iter().position(|joint| joint.name == "shank").unwrap();
    for k in 0..=20 {
        let time = k as f32 / 20.0;
        let (sin, cos) = trig::sin_cos(core::f32::consts::FRAC_PI_2 * time);
        // Linear in the angle, as slerp between keys of one axis is.
        near(pose_at(&file, time)[shank].translation, Vec3::new(0.1, 1.0 - 0.4 * cos, -0.4 * sin));
    }
}

#[test]
fn the_skin_follows_its_bones() {
    let file = read_fbx(leg().as_bytes()).unwrap();
    let rig = &file.rig;
    assert_eq!((rig.meshes.len(), rig.skins.len(), rig.meshes[0].skin), (1, 1, Some(0)));
    let part = &rig.meshes[0].primitives[0];
    assert_eq!(part.indices.len(), 36);
    let in_metres = |[x, y, z]: [i32; 3]| Vec3::new(x as f32, z as f32, -y as f32) * 0.01;
    let wanted = corners().map(in_metres);
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    let mut model = Vec::new();
    local_to_model(rig, &rest_pose(rig), &Affine::IDENTITY, &mut model);
    skin_vertices(rig, 0, 0, &model, &mut positions, &mut normals);
    for p in &positions {
        assert!(wanted.iter().any(|corner| (*corner - *p).length() < 1e-5), "{p} is no corner of the box");
    }
    // Faces look outwards: the volume enclosed is that of the box.
    let triangles = part.indices.chunks_exact(3).map(|t| [0, 1, 2].map(|k| positions[t[k] as usize]));
    let volume: f32 = triangles.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
    assert!((volume - 0.1 * 0.1 * 0.8).abs() < 1e-6, "{volume}");
    // After the turn: about the thigh's joint at (0.1, 1, 0), what was below is behind.
    skin_vertices(rig, 0, 0, &pose_at(&file, 1.0), &mut positions, &mut normals);
    for p in &positions {
        let back = Vec3::new(p.x, 1.0 + p.z, -(p.y - 1.0));
        assert!(wanted.iter().any(|corner| (*corner - back).length() < 1e-5), "{p} has not turned");
    }
}

#[test]
fn a_cut_anywhere_is_no_panic() {
    let text = leg();
    let mut refused = 0;
    for length in 0..text.len() {
        if let Err(error) = read_fbx(&text.as_bytes()[..length]) {
            assert!(error.kind != ErrorKind::Io && !error.where_.is_empty(), "{error}");
            assert!(!error.what.contains('\n'));
            refused += 1;
        }
    }
    assert!(refused > 100, "{refused} of {}", text.len());
}

#[test]
fn garbage_is_no_panic() {
    let text = leg().into_bytes();
    let mut random = Random::new(0xFB);
    for _ in 0..300 {
        let mut bytes = text.clone();
        for _ in 0..1 + random.index(8) {
            let at = random.index(bytes.len());
            bytes[at] = random.index(256) as u8;
        }
        if let Ok(file) = read_fbx(&bytes) {
            // What passes can be used.
            let joints = file.rig.joints.len();
            assert!(file.clips.iter().flat_map(|clip| &clip.channels).all(|channel| channel.joint < joints));
            if joints > 0 {
                pose_at(&file, 0.5);
            }
        }
    }
    let error = read_fbx(b"Kaydara FBX Binary  \0\x1a\0\xe8\x1c\0\0").unwrap_err();
    assert_eq!(error.kind, ErrorKind::Malformed);
}
