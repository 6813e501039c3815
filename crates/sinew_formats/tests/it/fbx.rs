//! FBX: compares a small text file with closed forms.

use crate::fbx_file::{corners, leg, pictured_leg};
use sinew_anim::{LocalTransform, Wrap, local_to_model, rest_pose, sample, skin_vertices};
use sinew_formats::{Error, ErrorKind, MotionFile, ReadOptions, Textures, read_fbx, read_fbx_with};
use sinew_math::{Affine, Random, Vec3, trig};

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
fn joints_are_converted_to_metres_and_y_up() {
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
fn thigh_rotates_evenly() {
    let file = read_fbx(leg().as_bytes()).unwrap();
    assert_eq!((file.clips.len(), file.clips[0].name.as_str(), file.clips[0].duration), (1, "bend", 1.0));
    let shank = file.rig.joints.iter().position(|joint| joint.name == "shank").unwrap();
    for k in 0..=20 {
        let time = k as f32 / 20.0;
        let (sin, cos) = trig::sin_cos(core::f32::consts::FRAC_PI_2 * time);
        // The angle is linear in time, as with slerp between keys about one axis.
        near(pose_at(&file, time)[shank].translation, Vec3::new(0.1, 1.0 - 0.4 * cos, -0.4 * sin));
    }
}

#[test]
fn skin_follows_its_bones() {
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
        assert!(wanted.iter().any(|corner| (*corner - *p).length() < 1e-5), "{p} is not a corner of the box");
    }
    // Faces point outward: the enclosed volume is that of the box.
    let triangles = part.indices.chunks_exact(3).map(|t| [0, 1, 2].map(|k| positions[t[k] as usize]));
    let volume: f32 = triangles.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
    assert!((volume - 0.1 * 0.1 * 0.8).abs() < 1e-6, "{volume}");
    // After the rotation about the thigh's joint at (0.1, 1, 0), points that were below the joint are behind
    // it.
    skin_vertices(rig, 0, 0, &pose_at(&file, 1.0), &mut positions, &mut normals);
    for p in &positions {
        let back = Vec3::new(p.x, 1.0 + p.z, -(p.y - 1.0));
        assert!(wanted.iter().any(|corner| (*corner - back).length() < 1e-5), "{p} has not turned");
    }
}

#[test]
fn truncated_file_does_not_panic() {
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
fn random_bytes_do_not_panic() {
    let text = leg().into_bytes();
    let mut random = Random::new(0xFB);
    for _ in 0..300 {
        let mut bytes = text.clone();
        for _ in 0..1 + random.index(8) {
            let at = random.index(bytes.len());
            bytes[at] = random.index(256) as u8;
        }
        if let Ok(file) = read_fbx(&bytes) {
            // All channels refer to existing joints.
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

/// Returns a PNG of one red pixel.
const RED: [u8; 70] = [
    137, 80, 78, 71, 13, 10, 26, 10, 0, 0, 0, 13, 73, 72, 68, 82, 0, 0, 0, 1, 0, 0, 0, 1, 8, 6, 0, 0, 0, 31,
    21, 196, 137, 0, 0, 0, 13, 73, 68, 65, 84, 120, 156, 99, 248, 207, 192, 240, 31, 0, 5, 0, 1, 255, 137,
    153, 61, 29, 0, 0, 0, 0, 73, 69, 78, 68, 174, 66, 96, 130,
];

#[test]
fn material_keeps_its_colour_and_picture() {
    let png = RED.to_vec();
    let decode = ReadOptions { textures: Textures::Decode };
    let missing = |_: &str| Err(Error::io("no such file"));
    // The picture is in the file.
    let text = pictured_leg(Some(&png), "skin.png");
    let file = read_fbx_with(text.as_bytes(), decode, &mut |path| missing(path)).unwrap();
    let part = &file.rig.meshes[0].primitives[0];
    assert_eq!((part.texture, part.base_color), (Some(0), [1.0; 4]), "{:?}", file.notes);
    assert_eq!(file.rig.textures[0].rgba, [255, 0, 0, 255]);
    // The picture is beside the file; its folder on another machine is ignored.
    let text = pictured_leg(None, "skin.png");
    let mut asked = Vec::new();
    let mut beside = |path: &str| {
        asked.push(path.to_owned());
        if path == "skin.png" { Ok(png.clone()) } else { missing(path) }
    };
    let file = read_fbx_with(text.as_bytes(), decode, &mut beside).unwrap();
    assert_eq!(file.rig.textures.len(), 1, "{:?}", file.notes);
    assert!(asked.iter().all(|path| !path.contains("..") && !path.contains(':')), "{asked:?}");
    // The picture is missing, broken, or not requested: the colour stays, and a note names the picture.
    let broken = pictured_leg(Some(&png[..20]), "skin.png");
    for (text, options) in [(&text, decode), (&broken, decode), (&text, ReadOptions::default())] {
        let file = read_fbx_with(text.as_bytes(), options, &mut |path| missing(path)).unwrap();
        let part = &file.rig.meshes[0].primitives[0];
        assert_eq!((part.texture, part.base_color), (None, [0.5, 0.25, 1.0, 1.0]));
        assert!(
            file.notes.iter().any(|note| note.contains("picture") || note.contains("textures")),
            "{:?}",
            file.notes
        );
    }
}
