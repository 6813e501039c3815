//! The mannequin as a character, for tests.

use crate::data;
use sinew_anim::retarget::{Body, RetargetOptions, retarget};
use sinew_anim::{Channel, Clip, Joint, LocalTransform, Rig, RigAnalysis, Role, Side, analyze};
use sinew_math::{Rotation, Transform, Vec3};
use sinew_physics::{BodyDef, BodyKind, Shape, ShapeDef};
use sinew_ragdoll::{BuildOptions, CharacterDef, Locomotion, MotionSet, build};
use sinew_scenes::mannequin::{Mannequin, Motions, mannequin};
use std::sync::Arc;

/// Returns the mannequin with a walk and both get-up clips.
pub fn walker() -> CharacterDef {
    let Mannequin { rig, clips, motions } = mannequin();
    character(rig, clips, motions)
}

/// Returns the walker with a sword in its right hand. The sword's joints have no counterpart in the ragdoll, and no
/// clip moves them.
pub fn armed_walker() -> CharacterDef {
    let Mannequin { mut rig, clips, motions } = mannequin();
    let hand = analyze(&rig).expect("the rig has a skin").joint_with(Role::Hand(Side::Right));
    let rest = LocalTransform {
        translation: Vec3::new(-1.48, -0.63, -0.05),
        rotation: Rotation::from_scaled_axis(Vec3::new(-1.1, -1.4, -1.1)),
        ..LocalTransform::default()
    };
    for (name, parent) in [("sword", hand), ("blade", Some(rig.joints.len()))] {
        let source = rig.joints.len();
        rig.joints.push(Joint { name: name.into(), parent, rest, source });
    }
    character(rig, clips, motions)
}

fn character(rig: Rig, clips: Vec<Clip>, motions: Motions) -> CharacterDef {
    let analysis = analyze(&rig).expect("the mannequin has a skin");
    let (ragdoll, _) = build(&rig, &analysis, &BuildOptions::default()).expect("the rig has bones");
    let mut def = CharacterDef::new(rig, ragdoll, &analysis.bind_model);
    let motions = MotionSet {
        clips,
        looped: Some(motions.walk),
        get_ups: vec![motions.get_up_supine, motions.get_up_prone],
        locomotion: Locomotion::Forward { speed: motions.walk_speed },
        ..MotionSet::default()
    };
    def.set_motions(motions).expect("the mannequin's clips can be played");
    def
}

pub fn shared(def: CharacterDef) -> Arc<CharacterDef> {
    Arc::new(def)
}

pub fn floor() -> BodyDef {
    BodyDef { kind: BodyKind::Static, shapes: vec![ShapeDef::new(Shape::HalfSpace)], ..BodyDef::default() }
}

/// Returns a pose away from the origin, turned about the vertical.
pub fn somewhere() -> Transform {
    Transform::new(Vec3::new(1.5, 0.0, -2.0), Rotation::from_axis_angle(Vec3::Y, 0.7))
}

/// Returns the walker as some exporters write it: under an armature node that scales to centimetres and rotates to Z
/// up.
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

/// Returns the KayKit mannequin of the shared data, with its own walk and its own get-up from its back; the get-up from
/// its face is retargeted from the built-in mannequin. `None` if the data are absent.
pub fn kaykit() -> CharacterDef {
    let of = |name: &str| data::document(&format!("kaykit_mannequin/{name}"));
    let rig = of("manny_med_mod.gltf").rig;
    let analysis = analyze(&rig).expect("the rig has a skin");
    let (ragdoll, _) = build(&rig, &analysis, &BuildOptions::default()).expect("the rig has bones");
    let own = |file: &str, clip: &str| {
        let document = of(file);
        let clip = document.clips.iter().find(|own| own.name.ends_with(clip)).expect("it has that clip");
        let renamed = |channel: &Channel| {
            let name = &document.rig.joints[channel.joint].name;
            let joint = rig.joints.iter().position(|joint| joint.name == *name)?;
            Some(Channel { joint, ..channel.clone() })
        };
        Clip { channels: clip.channels.iter().filter_map(renamed).collect(), ..clip.clone() }
    };
    let clips = vec![
        own("Med_MovementBasic.glb", "Walking_A"),
        own("Med_Simulation.glb", "Lie_StandUp"),
        from_face_on(&rig, &analysis),
    ];
    let mut def = CharacterDef::new(rig, ragdoll, &analysis.bind_model);
    let locomotion = Locomotion::Forward { speed: 1.2 };
    let motions =
        MotionSet { clips, looped: Some(0), get_ups: vec![1, 2], locomotion, ..MotionSet::default() };
    def.set_motions(motions).expect("clips of a file that was read can be played");
    def
}

/// Returns the built-in mannequin's get-up from its face, retargeted to another rig.
fn from_face_on(rig: &Rig, analysis: &RigAnalysis) -> Clip {
    let Mannequin { rig: actor, clips, motions } = mannequin();
    let own = analyze(&actor).expect("the mannequin has a skin");
    let (from, to) = (Body { rig: &actor, analysis: &own }, Body { rig, analysis });
    let clip = &clips[motions.get_up_prone];
    let fitted = retarget(from, clip, to, &RetargetOptions::default()).expect("both are humans");
    fitted.clip(rig, "get_up_prone")
}
