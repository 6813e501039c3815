//! Checks that a rig made by code and written to a file reads back equal.

use sinew_anim::{
    Channel, Clip, Interpolation, Joint, LocalTransform, Primitive, Property, Rig, RigMesh, Skin,
};
use sinew_formats::{Document, ReadOptions, no_files, read_gltf, write_gltf};
use sinew_math::{Affine, Rotation, Vec2, Vec3};

fn joint(name: &str, parent: Option<usize>, height: f32) -> Joint {
    let rotation = Rotation::from_axis_angle(Vec3::X, 0.3);
    let rest = LocalTransform { translation: Vec3::Y * height, rotation, scale: Vec3::splat(1.5) };
    Joint { name: name.into(), parent, rest, source: 0 }
}

fn triangle() -> Primitive {
    Primitive {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(0.5, -2.0, 0.25)],
        normals: vec![Vec3::Z; 3],
        uvs: vec![Vec2::new(0.0, 0.0), Vec2::new(1.0, 0.0), Vec2::new(0.5, 1.0)],
        colors: vec![[1.0, 0.5, 0.25, 1.0]; 3],
        indices: vec![0, 2, 1],
        base_color: [0.25, 0.5, 0.75, 1.0],
        ..Primitive::default()
    }
}

/// Returns two joints, a skinned mesh, and a rigid mesh on the first joint, whose node is between the joints in the
/// file.
fn rig() -> Rig {
    let skinned = Primitive {
        joints: vec![[1, 0, 0, 0], [0, 1, 0, 0], [1, 0, 0, 0]],
        weights: vec![[1.0, 0.0, 0.0, 0.0], [0.25, 0.75, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]],
        ..triangle()
    };
    let mesh = |name: &str, skin, primitive| RigMesh {
        name: name.into(),
        joint: 0,
        skin,
        primitives: vec![primitive],
    };
    let bind = Affine::from_scale_rotation_translation(
        Vec3::ONE,
        Rotation::from_axis_angle(Vec3::Y, 1.0),
        Vec3::new(1.0, 2.0, 3.0),
    );
    Rig {
        joints: vec![joint("hip", None, 1.0), joint("knee", Some(0), -0.5), joint("post", None, 0.0)],
        skins: vec![Skin {
            name: "skin".into(),
            joints: vec![0, 1],
            inverse_bind: vec![bind, Affine::IDENTITY],
        }],
        meshes: vec![mesh("hat", None, triangle()), mesh("body", Some(0), skinned)],
        ..Rig::default()
    }
}

fn clip(name: &str, joint: usize) -> Clip {
    let channel = Channel {
        joint,
        property: Property::Translation,
        interpolation: Interpolation::Linear,
        times: vec![0.0, 0.5],
        values: vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
    };
    Clip { name: name.into(), duration: 0.5, channels: vec![channel] }
}

fn written(rig: &Rig, clips: &[Clip]) -> Document {
    let bytes = write_gltf(rig, clips).unwrap();
    read_gltf(&bytes, ReadOptions::default(), &mut no_files).unwrap()
}

#[test]
fn joints_skins_and_meshes_round_trip() {
    let rig = rig();
    let back = written(&rig, &[]).rig;
    for (index, joint) in rig.joints.iter().enumerate() {
        let read = back.joints.iter().find(|read| read.source == index).unwrap();
        assert_eq!((&read.name, read.rest), (&joint.name, joint.rest));
        let parent = read.parent.map(|parent| back.joints[parent].source);
        assert_eq!(parent, joint.parent);
    }
    assert_eq!(back.skins[0].inverse_bind, rig.skins[0].inverse_bind);
    let slots = back.skins[0].joints.iter().map(|&slot| back.joints[slot].source);
    assert_eq!(slots.collect::<Vec<_>>(), rig.skins[0].joints);
    for mesh in &rig.meshes {
        let read = back.meshes.iter().find(|read| read.name == mesh.name).unwrap();
        assert_eq!(read.skin, mesh.skin);
        // Slots with weight 0 may differ in general, but not in this rig.
        assert_eq!(read.primitives, mesh.primitives);
    }
}

#[test]
fn written_clips_move_the_same_joints() {
    let document = written(&rig(), &[clip("first", 1), clip("second", 2)]);
    let moved: Vec<_> = document
        .clips
        .iter()
        .map(|clip| (clip.name.as_str(), document.rig.joints[clip.channels[0].joint].name.as_str()))
        .collect();
    assert_eq!(moved, [("first", "knee"), ("second", "post")]);
    assert_eq!(document.clips[0].channels[0].values, clip("first", 1).channels[0].values);
}

#[test]
fn rig_without_meshes_is_written() {
    let rig = Rig { meshes: Vec::new(), skins: Vec::new(), ..rig() };
    let document = written(&rig, &[clip("only", 0)]);
    assert_eq!(document.rig.joints.len(), 3);
    assert!(document.rig.meshes.is_empty());
}
