//! The mannequin as a character, for tests.

use sinew_anim::{Clip, Joint, LocalTransform, Rig, analyze};
use sinew_math::{Rotation, Transform, Vec3};
use sinew_physics::{BodyDef, BodyKind, Shape, ShapeDef};
use sinew_ragdoll::{BuildOptions, CharacterDef, Locomotion, build};
use sinew_scenes::mannequin::{Mannequin, Motions, mannequin};
use std::sync::Arc;

/// Walks, and gets up by either clip.
pub fn walker() -> CharacterDef {
    let Mannequin { rig, clips, motions } = mannequin();
    character(rig, clips, motions)
}

fn character(rig: Rig, clips: Vec<Clip>, motions: Motions) -> CharacterDef {
    let analysis = analyze(&rig).expect("the mannequin has a skin");
    let (ragdoll, _) = build(&rig, &analysis, &BuildOptions::default()).expect("it has bones");
    let mut def = CharacterDef::new(rig, ragdoll, &analysis.bind_model);
    def.clips = clips;
    def.looped = Some(motions.walk);
    def.get_ups = vec![motions.get_up_supine, motions.get_up_prone];
    def.locomotion = Locomotion::Forward { speed: motions.walk_speed };
    def
}

pub fn shared(def: CharacterDef) -> Arc<CharacterDef> {
    Arc::new(def)
}

pub fn floor() -> BodyDef {
    BodyDef { kind: BodyKind::Static, shapes: vec![ShapeDef::new(Shape::HalfSpace)], ..BodyDef::default() }
}

/// A place away from the origin, turned.
pub fn somewhere() -> Transform {
    Transform::new(Vec3::new(1.5, 0.0, -2.0), Rotation::from_axis_angle(Vec3::Y, 0.7))
}

/// The walker as an exporter may write it: under an armature node that makes the file centimetres and Z-up.
pub fn in_centimetres_and_z_up() -> CharacterDef {
    let Mannequin { mut rig, mut clips, motions } = mannequin();
    let armature = LocalTransform {
        rotation: Rotation::from_axis_angle(Vec3::X, 0.5 * core::f32::consts::PI),
        scale: Vec3::splat(100.0),
        ..LocalTransform::default()
    };
    for joint in &mut rig.joints {
        joint.parent = Some(joint.parent.map_or(0, |parent| parent + 1));
    }
    let name = "Armature".to_owned();
    rig.joints.insert(0, Joint { name, parent: None, rest: armature, source: 0 });
    rig.skins.iter_mut().flat_map(|skin| &mut skin.joints).for_each(|joint| *joint += 1);
    rig.meshes.iter_mut().for_each(|mesh| mesh.joint += 1);
    clips.iter_mut().flat_map(|clip| &mut clip.channels).for_each(|channel| channel.joint += 1);
    character(rig, clips, motions)
}
