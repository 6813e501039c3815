//! Characters with clips played by Bevy: their target pose is that of Bevy's `AnimationPlayer`.

use crate::characters::{CharacterHandle, CharacterJoints, write_joints};
use bevy_ecs::prelude::*;
#[cfg(feature = "reflect")]
use bevy_reflect::std_traits::ReflectDefault;
use bevy_time::{Fixed, Time};
use bevy_transform::components::Transform as Place;
use sinew::anim::{Clip, LocalTransform, Pose, local_to_model};
use sinew::ragdoll::{CharacterDef, Locomotion, MotionSet, Opening};
use sinew_math::{Affine, Rotation, Transform, Vec3};
use std::sync::{Arc, Weak};

/// A character whose clips Bevy plays. Any animation of its joints in `AnimationSystems`, usually by an `AnimationPlayer`, sets the pose
/// of the animated character and the target of the muscles of the powered one. Insert this component together with
/// [`CharacterBody`](crate::CharacterBody) or `CharacterScene`; inserted later, it has no effect.
///
/// Each fixed step uses the pose of the last frame. [`set_move`](sinew::ragdoll::Character::set_move) sets the character's velocity; the
/// player sets the speed of clips. The character falls like any other and gets up by the get-up clips of its own motions, while the player
/// continues.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Default, Debug, PartialEq))]
#[require(Given)]
pub struct BevyAnimation {
    /// True if the clips move over the ground. The pelvis is then held over its rest position, which removes its sway. Default false: the
    /// clips stay in place.
    pub travels: bool,
}

/// Pose that Bevy gave the joints of a character in the last frame.
#[derive(Component, Clone, Debug, Default)]
pub(crate) struct Given {
    /// Poses of the joints, in the order of the rig; empty before the first frame.
    joints: Vec<Place>,
    /// Pose with all joints above the pelvis at rest.
    pose: Option<Pose>,
}

/// Kinds of characters with clips played by Bevy, each with the kind that it was derived from.
pub(crate) type LedKinds = Vec<(Weak<CharacterDef>, Weak<CharacterDef>)>;

/// Returns a kind of character whose looped clip is supplied from outside.
pub(crate) fn led(kinds: &mut LedKinds, def: &Arc<CharacterDef>) -> Arc<CharacterDef> {
    kinds.retain(|(_, led)| led.strong_count() > 0);
    let known = kinds.iter().find(|(of, _)| core::ptr::eq(of.as_ptr(), Arc::as_ptr(def)));
    if let Some(led) = known.and_then(|(_, led)| led.upgrade()) {
        return led;
    }
    let mut led = CharacterDef::clone(def);
    let own = def.motions().clone();
    let outside = Clip { name: "Bevy".to_owned(), duration: 1.0, channels: Vec::new() };
    let (looped, clips) = (Some(own.clips.len()), [own.clips, vec![outside]].concat());
    let (locomotion, opening) = (Locomotion::InPlace, Opening::Looped);
    let motions = MotionSet { clips, looped, faster: Vec::new(), idle: None, locomotion, opening, ..own };
    led.set_motions(motions).expect("a clip without channels beside those that it plays already");
    let led = Arc::new(led);
    kinds.push((Arc::downgrade(def), Arc::downgrade(&led)));
    led
}

/// Passes the poses to the characters before each step.
pub(crate) fn feed_characters(mut characters: Query<(&mut CharacterHandle, &Given)>) {
    for (mut handle, given) in &mut characters {
        let Some(pose) = &given.pose else { continue };
        let def = handle.def().clone();
        if let Some(looped) = def.motions().looped {
            handle.animator_mut().feed(def.set(), def.clip(looped), pose);
        }
    }
}

/// Restores the pose that Bevy left, so that joints without animation keep it.
pub(crate) fn give_back(characters: Query<(&CharacterJoints, &Given)>, mut transforms: Query<&mut Place>) {
    for (CharacterJoints(joints), given) in &characters {
        for (&joint, given) in joints.iter().zip(&given.joints) {
            if let Some(mut transform) = joint.and_then(|joint| transforms.get_mut(joint).ok()) {
                transform.set_if_neq(*given);
            }
        }
    }
}

/// Stores the pose that Bevy gave the joints, and shows the character's own pose instead.
pub(crate) fn take_and_show(
    time: Res<Time<Fixed>>,
    interpolation: Res<crate::Interpolation>,
    mut characters: Query<(&BevyAnimation, &CharacterHandle, &CharacterJoints, &mut Given)>,
    mut transforms: Query<&mut Place>,
    mut pose: Local<Vec<LocalTransform>>,
    mut model: Local<Vec<Affine>>,
) {
    let alpha = interpolation.alpha(&time);
    for (settings, handle, CharacterJoints(joints), mut given) in &mut characters {
        let def = handle.def();
        let place = |(joint, rest): (&Option<Entity>, &LocalTransform)| {
            let transform = joint.and_then(|joint| transforms.get(joint).ok());
            transform.copied().unwrap_or_else(|| to_place(rest))
        };
        given.joints.clear();
        given.joints.extend(joints.iter().zip(def.rest()).map(place));
        pose.clear();
        pose.extend(given.joints.iter().map(to_local));
        def.mapping().flatten(&def.rig, &mut pose);
        if settings.travels {
            hold_in_place(def, &mut pose, &mut model);
        }
        match &mut given.pose {
            Some(given) => pose.iter().enumerate().for_each(|(joint, local)| given.set(joint, local)),
            none => *none = Some(pose.iter().copied().collect()),
        }
        handle.interpolated(alpha, &mut pose);
        write_joints(joints, &pose, &mut transforms);
    }
}

/// Moves a flat pose so that its pelvis is over its rest position.
fn hold_in_place(def: &CharacterDef, pose: &mut [LocalTransform], model: &mut Vec<Affine>) {
    let pelvis = def.ragdoll.bodies[0].joint;
    let root = def.mapping().character_from_model();
    let [rest, now] = [def.rest(), &*pose].map(|pose| {
        local_to_model(&def.rig, pose, &Affine::IDENTITY, model);
        root.point(model[pelvis].translation) * Vec3::new(1.0, 0.0, 1.0)
    });
    def.mapping().reframe(pose, Transform::IDENTITY, Transform::from_translation(now - rest));
}

pub(crate) fn to_place(local: &LocalTransform) -> Place {
    let LocalTransform { translation, rotation, scale } = *local;
    Place { translation, rotation: crate::pose::to_quat(rotation), scale }
}

fn to_local(place: &Place) -> LocalTransform {
    let [x, y, z, w] = place.rotation.to_array();
    let rotation = Rotation::from_xyzw(x, y, z, w).normalize();
    LocalTransform { translation: place.translation, rotation, scale: place.scale }
}
