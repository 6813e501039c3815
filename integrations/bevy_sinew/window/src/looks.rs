//! Appearance of shapes, movers, ropes and characters.

use bevy::asset::io::AssetSourceBuilder;
use bevy::asset::io::memory::{Dir, MemoryAssetReader};
use bevy::color::palettes::css;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::gltf::GltfAssetLabel;
use bevy::prelude::*;
use bevy::world_serialization::WorldAssetRoot;
use bevy_sinew::sinew::formats::write_gltf;
use bevy_sinew::sinew::ragdoll::CharacterDef;
use bevy_sinew::{CharacterBody, Collider, Mover, ParticlesHandle, Physics, RigidBody, Shape};
use std::path::PathBuf;
use std::sync::Arc;

/// Half size of the drawn part of a half-space, metres.
const GROUND: f32 = 60.0;
/// Thickness at which ropes are drawn, metres.
const ROPE: f32 = 0.02;

/// Skins of characters as files in memory, one for each kind.
#[derive(Resource)]
pub struct Files {
    dir: Dir,
    kinds: Vec<Arc<CharacterDef>>,
}

/// Adds files that Bevy's loader finds under `kind://`. Call it before Bevy's `AssetPlugin` is added.
pub fn files(app: &mut App) -> Files {
    let files = Files { dir: Dir::default(), kinds: Vec::new() };
    let dir = files.dir.clone();
    let reader = move || Box::new(MemoryAssetReader { root: dir.clone() }) as _;
    app.register_asset_source("kind", AssetSourceBuilder::new(reader));
    files
}

/// Draws the entities of an example.
pub fn add(app: &mut App, files: Files, camera: Transform) {
    app.insert_resource(files);
    app.insert_resource(ClearColor(Color::srgb(0.62, 0.72, 0.82)));
    app.insert_resource(GlobalAmbientLight { brightness: 400.0, ..GlobalAmbientLight::default() });
    // Bevy's default tone mapping needs tables of a separate feature.
    app.world_mut().spawn((Camera3d::default(), Tonemapping::Reinhard, camera));
    let sun = Transform::from_xyz(3.0, 8.0, -2.0).looking_at(Vec3::ZERO, Vec3::Y);
    let light =
        DirectionalLight { illuminance: 8000.0, shadow_maps_enabled: true, ..DirectionalLight::default() };
    app.world_mut().spawn((light, sun));
    app.add_systems(Update, (dress_bodies, dress_movers, dress_characters, string_ropes, place_ropes));
}

/// Returns the mesh of a shape, in its own axes; `None` for shapes that the examples lack.
fn mesh(shape: &Shape) -> Option<Mesh> {
    Some(match *shape {
        Shape::Box { half_extents } => Cuboid { half_size: half_extents }.into(),
        Shape::Sphere { radius } => Sphere::new(radius).into(),
        Shape::Capsule { half_height, radius } => Capsule3d::new(radius, 2.0 * half_height).into(),
        Shape::Cylinder { half_height, radius } => Cylinder::new(radius, 2.0 * half_height).into(),
        Shape::HalfSpace => Plane3d::new(Vec3::Y, Vec2::splat(GROUND)).into(),
        _ => return None,
    })
}

fn dress_bodies(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    new: Query<(Entity, &Collider, &RigidBody), Added<Collider>>,
) {
    for (entity, Collider(shapes), body) in &new {
        let color = match body {
            RigidBody::Static => css::GRAY,
            _ => css::ORANGE,
        };
        let material =
            materials.add(StandardMaterial { perceptual_roughness: 0.9, ..Color::from(color).into() });
        commands.entity(entity).insert_if_new(Visibility::default());
        for def in shapes {
            let Some(mesh) = mesh(&def.shape) else { continue };
            let place = def.body_from_shape;
            let turn = place.rotation;
            let rotation = Quat::from_xyzw(turn.x, turn.y, turn.z, turn.w);
            let place = Transform { translation: place.translation, rotation, ..Transform::default() };
            commands.spawn((
                Mesh3d(meshes.add(mesh)),
                MeshMaterial3d(material.clone()),
                place,
                ChildOf(entity),
            ));
        }
    }
}

fn dress_movers(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    new: Query<(Entity, &Mover), Added<Mover>>,
) {
    for (entity, Mover(def)) in &new {
        let mesh = meshes.add(Capsule3d::new(def.radius, def.height - 2.0 * def.radius));
        let material = materials.add(Color::from(css::STEEL_BLUE));
        let place = Transform::from_translation(Vec3::Y * 0.5 * def.height);
        commands.entity(entity).insert_if_new(Visibility::default());
        commands.spawn((Mesh3d(mesh), MeshMaterial3d(material), place, ChildOf(entity)));
    }
}

/// Gives characters the scene of their rig, like Bevy's loader; from then on the plugin moves its joints.
fn dress_characters(
    mut commands: Commands,
    mut files: ResMut<Files>,
    server: Res<AssetServer>,
    new: Query<(Entity, &CharacterBody), Added<CharacterBody>>,
) {
    for (entity, CharacterBody(def)) in &new {
        let known = files.kinds.iter().position(|kind| Arc::ptr_eq(kind, def));
        let index = known.unwrap_or_else(|| {
            let bytes = write_gltf(&def.rig, &[]).expect("a rig alone can be written");
            files.dir.insert_asset(&PathBuf::from(format!("{}.glb", files.kinds.len())), bytes);
            files.kinds.push(def.clone());
            files.kinds.len() - 1
        });
        let scene = GltfAssetLabel::Scene(0).from_asset(format!("kind://{index}.glb"));
        commands.entity(entity).insert(WorldAssetRoot(server.load(scene)));
    }
}

/// A piece of a rope: between two particles of a group.
#[derive(Component)]
struct Piece {
    of: Entity,
    ends: [u32; 2],
}

fn string_ropes(
    mut commands: Commands,
    physics: Res<Physics>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    new: Query<(Entity, &ParticlesHandle), Added<ParticlesHandle>>,
) {
    for (of, handle) in &new {
        let mesh = meshes.add(Cylinder::new(0.5 * ROPE, 1.0));
        let material = materials.add(Color::from(css::SADDLE_BROWN));
        for spring in physics.particles(handle.id()).springs() {
            let piece = Piece { of, ends: [spring.a, spring.b] };
            commands.spawn((piece, Mesh3d(mesh.clone()), MeshMaterial3d(material.clone())));
        }
    }
}

fn place_ropes(
    physics: Res<Physics>,
    handles: Query<&ParticlesHandle>,
    mut pieces: Query<(&Piece, &mut Transform)>,
) {
    for (piece, mut transform) in &mut pieces {
        let Ok(handle) = handles.get(piece.of) else { continue };
        let group = physics.particles(handle.id());
        let [a, b] = piece.ends.map(|end| group.positions()[end as usize]);
        let rotation = Quat::from_rotation_arc(Vec3::Y, (b - a).normalize_or(Vec3::Y));
        let scale = Vec3::new(1.0, (b - a).length(), 1.0);
        *transform = Transform { translation: a.midpoint(b), rotation, scale };
    }
}
