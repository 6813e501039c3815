//! Characters with externally animated joints: here by a system in place of Bevy's `AnimationPlayer`.

use super::characters::scene;
use super::*;
use bevy_app::{AnimationSystems, PostUpdate};
use bevy_sinew::sinew::anim::{LocalTransform, Wrap, sample};
use bevy_sinew::sinew::mannequin;
use bevy_sinew::sinew::ragdoll::{CharacterDef, State};
use bevy_transform::TransformSystems;
use std::sync::Arc;

/// Joints of a character, their poses in this frame, and the joints without animation.
#[derive(Resource)]
struct Player {
    joints: Vec<Entity>,
    pose: Vec<LocalTransform>,
    still: usize,
}

/// Replaces Bevy's animation, without curves: writes joints, regardless of other writers.
fn play(player: Res<Player>, mut transforms: Query<&mut Transform>) {
    for (index, (&joint, local)) in player.joints.iter().zip(&player.pose).enumerate() {
        let mut transform = transforms.get_mut(joint).expect("the joint has a transform");
        if index != player.still {
            let [x, y, z, w] = [local.rotation.x, local.rotation.y, local.rotation.z, local.rotation.w];
            transform.translation = local.translation;
            transform.rotation = Quat::from_xyzw(x, y, z, w);
        }
    }
}

/// Returns the largest angle between the joints of two poses, radians.
fn apart(a: &[LocalTransform], b: &[LocalTransform]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a.rotation.angle_to(b.rotation)).fold(0.0, f32::max)
}

/// A walker on the spot: its frames and its character.
struct Walker {
    app: App,
    entity: Entity,
    def: Arc<CharacterDef>,
    travels: bool,
    given: Vec<Vec<LocalTransform>>,
}

impl Walker {
    fn new(travels: bool) -> Self {
        let mut app = app();
        ground(&mut app);
        let def = Arc::new(mannequin::character());
        let entity = app.world_mut().spawn((CharacterBody(def.clone()), BevyAnimation { travels })).id();
        let joints = scene(&mut app, entity, &def.rig);
        for (&joint, rest) in joints.iter().zip(def.rest()) {
            app.world_mut().get_mut::<Transform>(joint).expect("the entity has this component").translation =
                rest.translation;
        }
        let still = def.rig.joints.iter().position(|joint| joint.name.to_lowercase().contains("head"));
        let (still, pose) = (still.expect("the character has a head"), def.rest().to_vec());
        app.insert_resource(Player { joints, pose, still });
        let play = play.in_set(AnimationSystems).before(TransformSystems::Propagate);
        app.add_systems(PostUpdate, play.ambiguous_with_all());
        Self { app, entity, def, travels, given: Vec::new() }
    }

    /// Runs a frame, in which the player advances the walk.
    fn frame(&mut self) {
        let def = &self.def;
        let walk = &def.motions().clips[def.motions().looped.expect("the character has a looped clip")];
        let mut pose = def.rest().to_vec();
        let time = self.given.len() as f32 * DT % walk.duration;
        sample(walk, &def.rig, time, Wrap::Loop, &mut pose);
        def.mapping().flatten(&def.rig, &mut pose);
        // The pelvis has no horizontal motion.
        let pelvis = def.ragdoll.bodies[0].joint;
        pose[pelvis].translation = def.rest()[pelvis].translation;
        let mut player = self.app.world_mut().resource_mut::<Player>();
        pose[player.still] = def.rest()[player.still];
        player.pose.clone_from(&pose);
        if self.travels {
            let way = math::Transform::from_translation(Vec3::Z * (self.given.len() as f32 * DT));
            def.mapping().reframe(&mut player.pose, way, math::Transform::IDENTITY);
        }
        self.given.push(pose);
        self.app.update();
    }

    fn handle(&self) -> &CharacterHandle {
        self.app.world().get::<CharacterHandle>(self.entity).expect("the entity has this component")
    }

    /// Returns the angle to the pose of the frame before the last, radians: a step runs before its frame's
    /// animation.
    fn off(&self) -> f32 {
        apart(self.handle().pose_without_springs(), &self.given[self.given.len() - 2])
    }

    /// Returns the angular velocity of each body, rad/s.
    fn spins(&self) -> Vec<Vec3> {
        let bodies = self.handle().bodies().iter();
        bodies.map(|&body| physics(&self.app).velocity(body).angular).collect()
    }

    fn go_limp(&mut self) {
        self.app.world_mut().resource_scope(|world, mut physics: Mut<Physics>| {
            world
                .get_mut::<CharacterHandle>(self.entity)
                .expect("the entity has this component")
                .go_limp(&mut physics);
        });
    }
}

#[test]
fn character_follows_bevys_animation() {
    let mut walker = Walker::new(false);
    let mut most = 0.0f32;
    for step in 0..90 {
        walker.frame();
        // The joints are found in the first step.
        if step > 3 {
            assert!(walker.off() < 0.02, "step {step}: {} rad", walker.off());
            most = most.max(apart(&walker.given[step], &walker.given[0]));
        }
    }
    assert!(most > 0.3, "the walk moves the joint by only {most} rad");
    // The character moves at the requested velocity, not by its clips.
    assert!(walker.handle().world_from_character().translation.length() < 0.01);
    let mut handle = walker
        .app
        .world_mut()
        .get_mut::<CharacterHandle>(walker.entity)
        .expect("the entity has this component");
    handle.set_move(Vec3::Z);
    (0..60).for_each(|_| walker.frame());
    let way = walker.handle().world_from_character().translation;
    assert!(way.z > 0.7, "{way}");
}

#[test]
fn character_animated_by_bevy_falls_and_gets_up() {
    let mut walker = Walker::new(false);
    (0..70).for_each(|_| walker.frame());
    let led = walker.spins();
    walker.go_limp();
    let fastest = led.iter().map(|spin| spin.length()).fold(0.0, f32::max);
    let lost = led.iter().zip(walker.spins()).map(|(led, now)| (*led - now).length()).fold(0.0, f32::max);
    assert!(fastest > 1.0 && lost < 0.4 * fastest, "the hand-over loses {lost} of {fastest} rad/s");
    // The joints show the fall although the player continues.
    (0..45).for_each(|_| walker.frame());
    assert_eq!(walker.handle().state(), State::Limp);
    let player = walker.app.world().resource::<Player>();
    for (&joint, local) in player.joints.iter().zip(walker.handle().pose()) {
        let shown =
            walker.app.world().get::<Transform>(joint).expect("the entity has this component").rotation;
        let of = Quat::from_xyzw(local.rotation.x, local.rotation.y, local.rotation.z, local.rotation.w);
        assert!(shown.angle_between(of) < 1e-3);
    }
    assert!(walker.off() > 0.3, "the joints do not follow the fall");
    // After getting up the character shows the player's pose, including the head, which nothing has animated
    // since.
    for _ in 0..900 {
        walker.frame();
        if walker.handle().state() == State::Animated && walker.off() < 0.02 {
            return;
        }
    }
    panic!("{:?}, joints are {} rad from the target pose", walker.handle().state(), walker.off());
}

#[test]
fn travelling_clips_are_held_in_place() {
    let mut walker = Walker::new(true);
    let pelvis = walker.def.ragdoll.bodies[0].joint;
    for step in 0..90 {
        walker.frame();
        if step > 3 {
            assert!(walker.off() < 0.02, "step {step}: {} rad", walker.off());
            let off = walker.handle().pose()[pelvis].translation - walker.def.rest()[pelvis].translation;
            assert!(off.length() < 1e-3, "step {step}: {off}");
        }
    }
    assert!(walker.handle().world_from_character().translation.length() < 0.01);
}
