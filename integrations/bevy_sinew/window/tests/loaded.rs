//! A rigged file read by Bevy's loader and played by Bevy's player becomes a character by one component.

use bevy::asset::io::memory::{Dir, MemoryAssetReader};
use bevy::asset::io::{AssetSourceBuilder, AssetSourceId};
use bevy::ecs::schedule::{LogLevel, ScheduleBuildSettings};
use bevy::gltf::{Gltf, GltfAssetLabel, GltfPlugin};
use bevy::image::ImagePlugin;
use bevy::mesh::MeshPlugin;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy::world_serialization::{WorldAssetRoot, WorldSerializationPlugin};
use bevy_sinew::math::{Rotation, Transform as Pose};
use bevy_sinew::sinew::anim::{Wrap, analyze, sample};
use bevy_sinew::sinew::ragdoll::State;
use bevy_sinew::sinew::{formats, mannequin};
use bevy_sinew::{
    BevyAnimation, CharacterHandle, CharacterJoints, CharacterScene, Collider, Interpolation, Physics,
    RigidBody, Shape, SinewGltfPlugin, SinewPlugin,
};
use std::path::Path;
use std::time::Duration;

/// Largest distance of a joint's entity from its pose on the body that carries it, metres: a tenth of a millimetre, for
/// rounding.
const OFF: f32 = 1e-4;

/// Returns an app without a window that loads and plays a file; each update is a fixed step.
fn app() -> App {
    let dir = Dir::default();
    let mannequin = mannequin::mannequin();
    let bytes =
        formats::write_gltf(&mannequin.rig, &mannequin.clips).expect("the rig can be written as glTF");
    dir.insert_asset(Path::new("hero.glb"), bytes);
    let mut app = App::new();
    let reader = move || Box::new(MemoryAssetReader { root: dir.clone() }) as _;
    app.register_asset_source(AssetSourceId::Default, AssetSourceBuilder::new(reader));
    app.add_plugins((MinimalPlugins, AssetPlugin::default(), TransformPlugin, ImagePlugin::default()));
    app.add_plugins((MeshPlugin, WorldSerializationPlugin, GltfPlugin::default(), AnimationPlugin));
    app.add_plugins((SinewPlugin::default(), SinewGltfPlugin));
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1)).insert_resource(Interpolation::Off);
    app.configure_schedules(ScheduleBuildSettings {
        ambiguity_detection: LogLevel::Error,
        ..ScheduleBuildSettings::default()
    });
    app.finish();
    app.cleanup();
    app.world_mut().spawn((RigidBody::Static, Collider::from(Shape::HalfSpace)));
    app
}

/// The loaded scene as a character, and Bevy's player for it.
struct Hero {
    app: App,
    entity: Entity,
    player: Entity,
    walk: AnimationNodeIndex,
}

impl Hero {
    /// Loads the scene and plays the walk by Bevy's player.
    fn new() -> Self {
        let mut app = app();
        let server = app.world().resource::<AssetServer>().clone();
        let file: Handle<Gltf> = server.load("hero.glb");
        let scene = WorldAssetRoot(server.load(GltfAssetLabel::Scene(0).from_asset("hero.glb")));
        let place = Transform::from_xyz(2.0, 0.0, -1.0);
        let hero = (scene, CharacterScene(server.load("hero.glb")), BevyAnimation::default(), place);
        let entity = app.world_mut().spawn(hero).id();
        let ready = |app: &mut App| {
            app.update();
            app.world().get::<CharacterJoints>(entity).is_some()
        };
        while !ready(&mut app) {
            assert!(!server.load_state(&file).is_failed(), "Bevy reads the file");
            std::thread::sleep(Duration::from_millis(5));
        }
        let clip = app.world().resource::<Assets<Gltf>>().get(&file).expect("the file is loaded");
        let clip = clip.named_animations["walk"].clone();
        let (graph, walk) = AnimationGraph::from_clip(clip);
        let graph = app.world_mut().resource_mut::<Assets<AnimationGraph>>().add(graph);
        let world = app.world_mut();
        let player = world.query_filtered::<Entity, With<AnimationPlayer>>().single(world);
        let player = player.expect("Bevy gives the scene one player");
        world.entity_mut(player).insert(AnimationGraphHandle(graph));
        let mut hero = Self { app, entity, player, walk };
        hero.animation().repeat();
        // Bevy needs an update to use a new graph.
        hero.run(1);
        hero
    }

    fn animation(&mut self) -> &mut bevy::animation::ActiveAnimation {
        let player = self.app.world_mut().get_mut::<AnimationPlayer>(self.player);
        player.expect("the scene has a player").into_inner().play(self.walk)
    }

    fn run(&mut self, updates: usize) {
        (0..updates).for_each(|_| self.app.update());
    }

    fn handle(&self) -> &CharacterHandle {
        self.app.world().get(self.entity).expect("the entity has this component")
    }

    /// Returns the height of the pelvis, metres.
    fn height(&self) -> f32 {
        self.app.world().resource::<Physics>().transform(self.handle().bodies()[0]).translation.y
    }

    /// Returns the joints of the skinned mesh that bodies carry: name, pose as Bevy draws it, and pose on the body.
    fn joints_and_bodies(&mut self) -> Vec<(String, Pose, Pose)> {
        let world = self.app.world_mut();
        let mut skins = world.query::<&SkinnedMesh>();
        let skinned = skins.iter(world).next().expect("the scene has a skin").joints.clone();
        let handle = self.handle();
        let def = handle.def();
        let bind = analyze(&def.rig).expect("the rig has a skin").bind_model;
        let found = self.app.world().get::<CharacterJoints>(self.entity).expect("the joints were found");
        let physics = self.app.world().resource::<Physics>();
        let carried = def.ragdoll.bodies.iter().zip(handle.bodies()).map(|(body, &id)| {
            let entity = found.0[body.joint].expect("each joint has an entity");
            assert!(skinned.contains(&entity), "{}: the mesh uses it", body.bone);
            let drawn = self
                .app
                .world()
                .get::<GlobalTransform>(entity)
                .expect("the entity has this component")
                .affine();
            let (_, turn, at) = drawn.to_scale_rotation_translation();
            let drawn = Pose::new(at, Rotation::from_xyzw(turn.x, turn.y, turn.z, turn.w).normalize());
            let character_from_joint = (def.mapping().character_from_model() * bind[body.joint]).to_rigid();
            let body_from_joint = body.character_from_body.inverse() * character_from_joint;
            (body.bone.clone(), drawn, physics.transform(id) * body_from_joint)
        });
        carried.collect()
    }

    fn go_limp(&mut self) {
        self.app.world_mut().resource_scope(|world, mut physics: Mut<Physics>| {
            let mut handle =
                world.get_mut::<CharacterHandle>(self.entity).expect("the entity has this component");
            handle.go_limp(&mut physics);
        });
    }

    /// Returns the number of remaining entities of the scene.
    fn parts(&mut self) -> usize {
        let world = self.app.world_mut();
        world
            .query_filtered::<(), Or<(With<Name>, With<SkinnedMesh>, With<GlobalTransform>)>>()
            .iter(world)
            .count()
    }
}

#[test]
fn bevys_player_poses_the_character() {
    let mut hero = Hero::new();
    // The reference is our own sampling of the original clip, in its own joint order.
    let own = mannequin::character();
    let walk = &own.motions().clips[own.motions().looped.expect("the character has a looped clip")];
    let mut most = 0.0f32;
    for part in [0.1, 0.35, 0.6, 0.85] {
        let time = part * walk.duration;
        hero.animation().seek_to(time).pause();
        // The next frame's step uses a frame's animation.
        hero.run(2);
        let mut due = own.rest().to_vec();
        sample(walk, &own.rig, time, Wrap::Loop, &mut due);
        own.mapping().flatten(&own.rig, &mut due);
        let rig = &hero.handle().def().rig;
        let pose = hero.handle().pose_without_springs();
        let pelvis = own.ragdoll.bodies[0].joint;
        for (joint, (due, rest)) in own.rig.joints.iter().zip(due.iter().zip(own.rest())).skip(pelvis) {
            let is = rig.joints.iter().position(|of| of.name == joint.name).expect("the file has it");
            let off = pose[is].rotation.angle_to(due.rotation);
            assert!(off < 0.01, "at {time} s, {}: off by {off} rad", joint.name);
            most = most.max(due.rotation.angle_to(rest.rotation));
        }
    }
    assert!(most > 0.5, "the walk moves only {most} rad");
}

#[test]
fn mesh_follows_the_fall() {
    let mut hero = Hero::new();
    hero.run(40);
    assert_eq!(hero.handle().state(), State::Animated);
    let stands = hero.height();
    hero.go_limp();
    let start = hero.joints_and_bodies();
    for frame in 0..90 {
        hero.run(1);
        assert_eq!(hero.handle().state(), State::Limp, "frame {frame}");
        for (bone, drawn, on_body) in hero.joints_and_bodies() {
            let off = (drawn.translation - on_body.translation).length();
            let turned = drawn.rotation.angle_to(on_body.rotation);
            assert!(off < OFF && turned < 1e-3, "frame {frame}, {bone}: off by {off} m and {turned} rad");
        }
    }
    assert!(hero.height() < 0.4 * stands, "{} m of {stands}", hero.height());
    let moved = |((_, a, _), (_, b, _)): (&(String, Pose, Pose), &(String, Pose, Pose))| {
        (a.translation - b.translation).length()
    };
    let moved = start.iter().zip(&hero.joints_and_bodies()).map(moved).fold(0.0, f32::max);
    assert!(moved > 1.0, "the head moves only {moved} m");
    assert!(!hero.animation().is_paused(), "the player is paused");
}

#[test]
fn despawn_during_a_fall_removes_everything() {
    let mut hero = Hero::new();
    hero.run(20);
    let stands = hero.height();
    hero.go_limp();
    hero.run(25);
    assert!(
        (0.3 * stands..0.95 * stands).contains(&hero.height()),
        "the character is not falling: height {} m",
        hero.height()
    );
    let limbs = hero.handle().bodies().to_vec();
    let joints = hero.handle().def().rig.joints.len();
    assert!(hero.parts() > joints, "{} parts", hero.parts());
    hero.app.world_mut().despawn(hero.entity);
    hero.run(3);
    let physics = hero.app.world().resource::<Physics>();
    let left = (physics.body_ids().count(), physics.joint_ids().count(), physics.mover_ids().count());
    assert_eq!(left, (1, 0, 0), "only the ground may remain");
    assert!(limbs.iter().all(|&limb| physics.entity(limb).is_none()));
    assert_eq!((physics.len(), hero.parts()), (1, 1), "only the ground may remain");
    // Bevy frees its assets once nothing uses the file any more.
    assert_eq!(hero.app.world().resource::<Assets<Mesh>>().len(), 0);
    assert_eq!(hero.app.world().resource::<Assets<Gltf>>().len(), 0);
}
