//! Characters whose clips Bevy plays: the pose that its `AnimationPlayer` leaves is what they strive for.

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

/// The clips of this character are Bevy's: whatever animates its joints in `AnimationSystems`, an `AnimationPlayer` above all, gives
/// the pose that it has while it is animated, and that its muscles draw it to while it is powered. Put beside
/// [`CharacterBody`](crate::CharacterBody) or `CharacterScene` when it comes; later it does nothing.
///
/// Each fixed step takes the pose of the last frame. Where the character goes is said by
/// [`set_move`](sinew::ragdoll::Character::set_move); the speed of clips is the player's. It falls and gets up as others do, by the get-up clips
/// of its own motions; meanwhile the player goes on.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Default, Debug, PartialEq))]
#[require(Given)]
pub struct BevyAnimation {
    /// True if its clips go over the ground. Then the pelvis is held over the place where it is at rest, and what it sways by is lost.
    /// Default false: its clips stay in place.
    pub travels: bool,
}

/// Pose that the joints of a character were given by Bevy in the last frame.
#[derive(Component, Clone, Debug, Default)]
pub(crate) struct Given {
    /// As joints had it, in the order of the rig; empty before the first frame.
    joints: Vec<Place>,
    /// The same, with all that is above the pelvis at rest.
    pose: Option<Pose>,
}

/// Kinds of characters whose looped clip is Bevy's, each with the kind that it was made of.
pub(crate) type LedKinds = Vec<(Weak<CharacterDef>, Weak<CharacterDef>)>;

/// A kind of character, with a looped clip that is to come from outside.
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

/// Before each step.
pub(crate) fn feed_characters(mut characters: Query<(&mut CharacterHandle, &Given)>) {
    for (mut handle, given) in &mut characters {
        let Some(pose) = &given.pose else { continue };
        let def = handle.def().clone();
        if let Some(looped) = def.motions().looped {
            handle.animator_mut().feed(def.set(), def.clip(looped), pose);
        }
    }
}

/// Gives joints the pose that Bevy had left them in, for what it does not animate stays as it was.
pub(crate) fn give_back(characters: Query<(&CharacterJoints, &Given)>, mut transforms: Query<&mut Place>) {
    for (CharacterJoints(joints), given) in &characters {
        for (&joint, given) in joints.iter().zip(&given.joints) {
            if let Some(mut transform) = joint.and_then(|joint| transforms.get_mut(joint).ok()) {
                transform.set_if_neq(*given);
            }
        }
    }
}

/// Takes the pose that Bevy has given the joints, and shows the character's own instead.
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

/// Moves a flat pose so that its pelvis is over the place where it is at rest.
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
