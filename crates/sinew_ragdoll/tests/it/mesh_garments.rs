//! Garments made from meshes of the character: reduced, attached at the top, worn and drawn, through walks, falls,
//! snapshots and scaling.

use crate::garments::{go_on, ground, mean_stretch};
use sinew_anim::{
    Channel, Clip, Garment, Interpolation, Joint, LocalTransform, Property, SpringBone, SpringChain, Springs,
    local_to_model, skin_vertices,
};
use sinew_math::{Affine, Reader, Transform, Vec3, Writer, max};
use sinew_physics::particles::{GroupDef, ParticleDef};
use sinew_physics::{World, WorldDef};
use sinew_ragdoll::{Character, CharacterDef, MotionSet};
use sinew_scenes::skirted::{CELLS, joint, lay_skirt, skirted, skirted_rig};
use std::sync::Arc;

/// Spacing at which the cells of the coarse skirt are kept, metres.
const COARSE: f32 = 0.1;

/// Returns the world positions and normals of the skirt's vertices, as drawn.
fn drawn(character: &Character) -> (Vec<Vec3>, Vec<Vec3>) {
    let rig = &character.def().rig;
    let (mut model, mut places, mut normals) = (Vec::new(), Vec::new(), Vec::new());
    local_to_model(rig, character.pose(), &Affine::IDENTITY, &mut model);
    skin_vertices(rig, rig.sheets[0].mesh, 0, &model, &mut places, &mut normals);
    let to_world = character.def().mapping().world_from_model(character.world_from_character());
    (places.iter().map(|&place| to_world.point(place)).collect(), normals)
}

/// Returns the largest depth of a particle in a body with which it collides, metres.
fn deepest(world: &World, character: &Character) -> f32 {
    let group = world.particles(character.garments()[0]);
    let mut deepest = 0.0;
    for (index, &id) in character.bodies().iter().enumerate() {
        if group.passes().contains(&id) {
            continue;
        }
        let shape = &character.def().ragdoll.bodies[index].shape;
        let frame = world.transform(id);
        let held: Vec<u32> = group.attachments().iter().map(|held| held.particle).collect();
        for (particle, &at) in (0..).zip(group.positions()) {
            if !held.contains(&particle) {
                deepest = max(deepest, -shape.signed_distance(&frame, at).0);
            }
        }
    }
    deepest
}

#[test]
fn mesh_garment_starts_where_it_is_drawn_and_is_held_at_the_top() {
    let def = Arc::new(skirted(|_| ()));
    let mut world = ground(Vec3::ZERO);
    let character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    let group = world.particles(character.garments()[0]);
    let sheet = &def.rig.sheets[0];
    let held = sheet.held.iter().filter(|held| **held).count();
    assert_eq!((group.positions().len(), group.attachments().len()), (sheet.joints.len(), held));
    assert_eq!(group.faces(), sheet.faces);
    // A ring of particles around the waist is held: four of the 45 centimetres.
    assert!((20..120).contains(&held), "{held} of {}", sheet.joints.len());
    let mass: f32 = group.masses().iter().sum();
    let area: f32 = sheet
        .faces
        .iter()
        .map(|face| {
            let [a, b, c] = face.map(|at| group.positions()[at as usize]);
            0.5 * (b - a).cross(c - a).length()
        })
        .sum();
    assert!((mass / (0.4 * area) - 1.0).abs() < 0.1, "mass {mass} kg of an area of {area} m²");
    let whole = 0.4 * sheet.areas.iter().sum::<f32>();
    assert!((mass / whole - 1.0).abs() < 1e-3, "mass of the mesh: {mass} kg, expected {whole} kg");
    assert!(deepest(&world, &character) < 1e-3, "particles start inside a body");
}

/// In the bind pose the skirt and its normals are drawn as the artist made them, although particles were moved out of
/// the hips.
#[test]
fn garment_bones_keep_the_bind_pose_without_gravity() {
    let moving = skirted(|_| ());
    let bind_model = sinew_anim::analyze(&moving.rig).expect("the rig has a skin").bind_model;
    let mut def = CharacterDef::new(moving.rig.clone(), moving.ragdoll.clone(), &bind_model);
    def.set_garments(moving.garments().source());
    let mut world = ground(Vec3::ZERO);
    let mut character = Character::spawn(&mut world, &Arc::new(def), Transform::IDENTITY);
    go_on(&mut world, &mut character, 1);
    let rest = &moving.rig.meshes[moving.rig.sheets[0].mesh].primitives[0];
    let (places, normals) = drawn(&character);
    let off = places.iter().zip(&rest.positions).map(|(a, b)| (*a - *b).length()).fold(0.0, max);
    assert!(off < 0.01, "drawn {off} m off");
    let turn = normals.iter().zip(&rest.normals).map(|(a, b)| a.dot(*b)).fold(1.0, sinew_math::min);
    assert!(turn > 0.95, "normals must rotate with the body: {turn}");
    let group = world.particles(character.garments()[0]);
    let moved = group.positions().iter().zip(&moving.rig.sheets[0].joints);
    let moved = moved.map(|(&at, &joint)| (at - bind_model[joint].translation).length()).fold(0.0, max);
    assert!(moved > 0.003, "particles moved by only {moved} m");
}

#[test]
fn mesh_garment_stays_on_through_a_walk_and_a_fall() {
    let def = Arc::new(skirted(|_| ()));
    let mut world = ground(WorldDef::default().gravity);
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    character.set_move(Vec3::Z * 1.3);
    let (mut inside, mut stretch, mut swung): (f32, f32, f32) = (0.0, 0.0, 0.0);
    let bound = drawn(&character).0;
    for step in 0..240 {
        go_on(&mut world, &mut character, 1);
        if step > 30 {
            inside = max(inside, deepest(&world, &character));
            stretch = max(stretch, mean_stretch(world.particles(character.garments()[0])));
        }
        let hem = drawn(&character).0;
        assert!(hem.iter().all(|place| place.is_finite()));
        let moved = |at: usize| character.world_from_character().inverse_point(hem[at]) - bound[at];
        swung = max(swung, moved(CELLS[1] / 2).length());
    }
    assert!(inside < 0.01, "{inside} m inside a body while walking");
    // The first steps are long: feet on the ground wait until the clips reach the mover's speed.
    assert!(stretch < 0.05, "the stretch of a thread is {stretch}");
    assert!(swung > 0.02, "the skirt swings by only {swung} m");
    character.go_limp(&mut world);
    go_on(&mut world, &mut character, 120);
    let hips = world.center_of_mass(character.bodies()[0]);
    let (places, _) = drawn(&character);
    let far = places.iter().map(|&place| (place - hips).length()).fold(0.0, max);
    assert!(
        hips.y < 0.5 && far < 0.9,
        "the wearer must lie in its skirt: hips at {} m, hem {far} m from them",
        hips.y
    );
    let low = places.iter().map(|place| place.y).fold(1.0, sinew_math::min);
    assert!(low > -0.03, "the skirt sinks into the floor to {low} m");
}

#[test]
fn snapshot_of_a_swinging_mesh_garment_continues_identically() {
    let def = Arc::new(skirted(|_| ()));
    let mut world = ground(WorldDef::default().gravity);
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    character.set_move(Vec3::Z * 1.3);
    go_on(&mut world, &mut character, 40);
    let mut w = Writer::new();
    world.save(&mut w);
    character.save(&mut w);
    let bytes = w.into_bytes();
    let mut reader = Reader::new(&bytes);
    let mut copy = World::new(WorldDef::default());
    copy.load(&mut reader).expect("the snapshot is valid");
    let mut again = Character::new(def.clone(), Transform::IDENTITY, 0.0);
    again.load(&mut reader).expect("the snapshot is valid");
    assert_eq!(again.pose(), character.pose());
    for _ in 0..40 {
        go_on(&mut world, &mut character, 1);
        go_on(&mut copy, &mut again, 1);
        assert_eq!((copy.hash(), again.pose()), (world.hash(), character.pose()));
    }
}

/// Every vertex of coarse cells is a particle, and the diagonals of cells are soft, as in a woven grid.
#[test]
fn coarse_mesh_is_used_as_its_own_sheet() {
    let mut rig = skirted_rig([20, 8]);
    let sheet = lay_skirt(&mut rig, 400, COARSE).expect("the mesh can become cloth");
    let sheet = &rig.sheets[sheet];
    // The buckle is not connected to the rest.
    assert_eq!((sheet.joints.len(), sheet.vertices), (20 * 9, 20 * 9 + 4));
    let bare = skirted(|_| ());
    let analysis = sinew_anim::analyze(&rig).expect("the rig has a skin");
    let mut def = CharacterDef::new(rig.clone(), bare.ragdoll.clone(), &analysis.bind_model);
    def.set_garments(&[Garment::of_sheet(sheet)]);
    let mut world = ground(Vec3::ZERO);
    let character = Character::spawn(&mut world, &Arc::new(def), Transform::IDENTITY);
    let group = world.particles(character.garments()[0]);
    let usual = Garment::default();
    let soft = group.springs().iter().filter(|spring| spring.stiffness == 0.5 * usual.shearing).count();
    // One of the 160 cells is slightly too skewed.
    assert!((316..=320).contains(&soft), "expected two diagonals for each cell, found {soft}");
    let others = group.springs().iter().map(|s| s.stiffness).filter(|&k| k != 0.5 * usual.shearing);
    let (low, high) = others.fold((f32::MAX, 0.0), |(low, high), k| (sinew_math::min(low, k), max(high, k)));
    assert!(low > 0.25 * usual.stretching && high < 4.0 * usual.stretching, "{low} to {high} N/m");
    assert!(group.bends().len() > 20 * 8, "{} bends", group.bends().len());
    let free = group.positions().len() - group.attachments().len();
    assert_eq!(group.tethers().len(), free);
}

/// Returns a coarse skirt whose hem is weighted to an additional joint `flare`, which has the named parent or none.
fn flared(parent: Option<&str>) -> CharacterDef {
    let mut rig = skirted_rig([20, 8]);
    let source = rig.joints.len();
    let parent = parent.map(|name| joint(&rig, name));
    rig.joints.push(Joint { name: "flare".into(), parent, rest: LocalTransform::default(), source });
    let skin = &mut rig.skins[0];
    let above = parent.and_then(|parent| skin.joints.iter().position(|&joint| joint == parent));
    skin.inverse_bind.push(above.map_or(Affine::IDENTITY, |slot| skin.inverse_bind[slot]));
    skin.joints.push(source);
    let slot = skin.joints.len() as u16 - 1;
    let skirt = rig.meshes.iter_mut().find(|mesh| mesh.name == "Skirt").expect("the named item exists");
    let primitive = &mut skirt.primitives[0];
    for (vertex, place) in primitive.positions.iter().enumerate().filter(|(_, place)| place.y < 0.65) {
        assert!(place.y > 0.4, "the vertex must stay at the skirt's height");
        primitive.joints[vertex] = [slot, 0, 0, 0];
        primitive.weights[vertex] = [1.0, 0.0, 0.0, 0.0];
    }
    let sheet = lay_skirt(&mut rig, 400, COARSE).expect("the mesh can become cloth");
    let flare = rig.sheets[sheet].joints.iter().filter(|&&at| rig.joints[at].parent == Some(source)).count();
    assert!(flare >= 20, "only {flare} vertices are weighted to the particles");
    let garment = Garment::of_sheet(&rig.sheets[sheet]);
    let analysis = sinew_anim::analyze(&rig).expect("the rig has a skin");
    let mut def = CharacterDef::new(rig, skirted(|_| ()).ragdoll.clone(), &analysis.bind_model);
    def.set_garments(&[garment]);
    def
}

/// Clips may scale hidden parts to zero.
#[test]
fn joint_scaled_to_zero_gives_finite_positions() {
    let mut def = flared(Some("hips"));
    let hidden = Channel {
        joint: joint(&def.rig, "flare"),
        property: Property::Scale,
        interpolation: Interpolation::Linear,
        times: vec![0.0, 1.0],
        values: vec![0.0; 6],
    };
    let clip = Clip { name: "hidden".into(), duration: 1.0, channels: vec![hidden] };
    def.set_motions(MotionSet { clips: vec![clip], looped: Some(0), ..MotionSet::default() })
        .expect("it can");
    let mut world = ground(WorldDef::default().gravity);
    let mut character = Character::spawn(&mut world, &Arc::new(def), Transform::IDENTITY);
    go_on(&mut world, &mut character, 20);
    let flare = joint(&character.def().rig, "flare");
    assert_eq!(character.pose()[flare].scale, Vec3::ZERO, "the scale is zero in this test");
    assert!(character.pose().iter().all(|local| local.to_affine().is_finite()));
}

/// The root of an armature moves part of the hem; the rest of the skirt is attached as before.
#[test]
fn particles_without_a_body_follow_the_sheet() {
    let def = flared(None);
    assert!(def.garments().left_out().is_empty(), "{} are left out", def.garments().left_out().len());
    let mut world = ground(WorldDef::default().gravity);
    let mut character = Character::spawn(&mut world, &Arc::new(def), Transform::IDENTITY);
    go_on(&mut world, &mut character, 30);
    assert_eq!(character.garments().len(), 1);
    assert!(mean_stretch(world.particles(character.garments()[0])) < 0.03);
}

/// A character's snapshot is loaded beside another world's snapshot: missing garments are created again.
#[test]
fn missing_garments_are_created_again() {
    let mut def = flared(Some("hips"));
    let mut world = ground(WorldDef::default().gravity);
    let mut character = Character::spawn(&mut world, &Arc::new(def.clone()), Transform::IDENTITY);
    go_on(&mut world, &mut character, 2);
    let mut w = Writer::new();
    character.save(&mut w);
    let garments = def.garments().source().to_vec();
    def.set_garments(&[]);
    for has_another in [true, false] {
        let mut other = ground(WorldDef::default().gravity);
        let mut bare = Character::spawn(&mut other, &Arc::new(def.clone()), Transform::IDENTITY);
        go_on(&mut other, &mut bare, 2);
        if has_another {
            let particle = ParticleDef { position: Vec3::Y, velocity: Vec3::ZERO, mass: 1.0, radius: 0.01 };
            let id = other.add_particles(&GroupDef { particles: vec![particle], ..GroupDef::default() });
            assert_eq!(id, character.garments()[0], "the ids are equal in this test");
        }
        let mut dressed = def.clone();
        dressed.set_garments(&garments);
        let mut copy = Character::new(Arc::new(dressed), Transform::IDENTITY, 0.0);
        copy.load(&mut Reader::new(w.as_bytes())).expect("the saved state is valid");
        go_on(&mut other, &mut copy, 2);
        let group = other.particles(copy.garments()[0]);
        assert_eq!(group.positions().len(), 20 * 9);
        assert!(mean_stretch(group) < 0.03);
    }
}

/// Returns the skirt on an intermediate bone below the hips, and the index of this bone. The bone is a spring if
/// `is_sprung`.
fn on_a_spring(is_sprung: bool) -> (CharacterDef, usize) {
    let mut rig = skirted_rig([20, 8]);
    let (hips, bone) = (joint(&rig, "hips"), rig.joints.len());
    let bind_model = sinew_anim::analyze(&rig).expect("the rig has a skin").bind_model;
    rig.joints.push(Joint {
        name: "band".into(),
        parent: Some(hips),
        rest: LocalTransform::default(),
        source: bone,
    });
    let skin = &mut rig.skins[0];
    let slot = skin.joints.iter().position(|&at| at == hips).expect("it moves the skin");
    let new = skin.joints.len() as u16;
    skin.joints.push(bone);
    skin.inverse_bind.push(bind_model[hips].inverse());
    let skirt = rig.meshes.last_mut().expect("the rig has a skirt");
    skirt.primitives[0].joints.iter_mut().flatten().filter(|at| **at == slot as u16).for_each(|at| *at = new);
    lay_skirt(&mut rig, 400, COARSE).expect("the mesh can become cloth");
    let garment = Garment::of_sheet(&rig.sheets[0]);
    let bare = skirted(|_| ());
    let analysis = sinew_anim::analyze(&rig).expect("the rig has a skin");
    let mut def = CharacterDef::new(rig, bare.ragdoll.clone(), &analysis.bind_model);
    def.set_motions(bare.motions().clone()).expect("the file's clips can be played");
    let swinging = SpringBone {
        joint: bone,
        tail: Vec3::NEG_Y * 0.3,
        stiffness: 1.0,
        gravity: Vec3::ZERO,
        drag: 0.2,
        radius: 0.0,
        limit: None,
    };
    let chain = SpringChain { bones: vec![swinging], ..SpringChain::default() };
    if is_sprung {
        def.set_springs(&Springs { chains: vec![chain], ..Springs::default() });
    }
    def.set_garments(&[garment]);
    (def, bone)
}

/// Springs above the skirt's joints change neither the cloth nor its drawn position.
#[test]
fn cloth_below_spring_bones_is_drawn_at_its_particles() {
    let walk = |is_sprung| {
        let (def, bone) = on_a_spring(is_sprung);
        let borne = def.rig.sheets[0].joints.iter().filter(|&&at| def.rig.joints[at].parent == Some(bone));
        assert!(borne.count() > 20, "the bone carries part of the skirt");
        let mut world = ground(WorldDef::default().gravity);
        let mut character = Character::spawn(&mut world, &Arc::new(def), Transform::IDENTITY);
        character.set_move(Vec3::Z * 1.3);
        let mut frames = Vec::new();
        for _ in 0..40 {
            go_on(&mut world, &mut character, 1);
            let turn = character.pose()[bone].rotation;
            let turn = turn.angle_to(character.pose_without_springs()[bone].rotation);
            frames.push((world.hash(), turn, drawn(&character).0));
        }
        frames
    };
    let mut swung = 0.0;
    for ((hash, turn, places), (still_hash, _, still)) in walk(true).iter().zip(walk(false)) {
        assert_eq!(*hash, still_hash, "the cloth is the same");
        let off = places.iter().zip(&still).map(|(a, b)| (*a - *b).length()).fold(0.0, max);
        assert!(off < 1e-4, "drawn {off} m off; the bone rotated by {turn}");
        swung = max(swung, *turn);
    }
    assert!(swung > 0.1, "the bone must swing: {swung}");
}

/// A skirt has ten cells around, each wider than a leg: cells are split for the cloth, so that no leg passes between
/// particles.
#[test]
fn legs_do_not_pass_through_a_coarse_mesh() {
    let deepest_face = |spacing: f32| {
        let mut rig = skirted_rig([10, 4]);
        let sheet = lay_skirt(&mut rig, 400, spacing).expect("the mesh can become cloth");
        let garment = Garment { spacing, ..Garment::of_sheet(&rig.sheets[sheet]) };
        let bare = skirted(|_| ());
        let analysis = sinew_anim::analyze(&rig).expect("the rig has a skin");
        let mut def = CharacterDef::new(rig, bare.ragdoll.clone(), &analysis.bind_model);
        def.set_motions(bare.motions().clone()).expect("the file's clips can be played");
        def.set_garments(&[garment]);
        let mut world = ground(WorldDef::default().gravity);
        let mut character = Character::spawn(&mut world, &Arc::new(def), Transform::IDENTITY);
        character.set_move(Vec3::Z * 1.3);
        let mut deepest: f32 = 0.0;
        for step in 0..240 {
            go_on(&mut world, &mut character, 1);
            if step > 30 {
                deepest = max(deepest, deepest_middle(&world, &character));
            }
        }
        let group = world.particles(character.garments()[0]);
        assert!(mean_stretch(group) < 0.03, "{}", mean_stretch(group));
        (group.positions().len(), deepest)
    };
    let (few, coarse) = deepest_face(0.5);
    let (many, split) = deepest_face(Garment::default().spacing);
    assert!(few == 50 && (200..=400).contains(&many), "{few} particles coarse, {many} split");
    assert!(coarse > 0.025, "without the split the body must pass through: {coarse} m");
    assert!(split < 0.015, "depth {split} m with the split, {coarse} m without");
}

/// Returns the largest depth of the centre of a face without attached corners in bodies with which it collides, metres.
fn deepest_middle(world: &World, character: &Character) -> f32 {
    let group = world.particles(character.garments()[0]);
    let held: Vec<u32> = group.attachments().iter().map(|held| held.particle).collect();
    let hangs = |face: &&[u32; 3]| face.iter().all(|corner| !held.contains(corner));
    let middles: Vec<Vec3> = group
        .faces()
        .iter()
        .filter(hangs)
        .map(|face| face.iter().map(|&corner| group.positions()[corner as usize]).sum::<Vec3>() / 3.0)
        .collect();
    let mut deepest: f32 = 0.0;
    for (body, &id) in character.def().ragdoll.bodies.iter().zip(character.bodies()) {
        if !group.passes().contains(&id) {
            let frame = world.transform(id);
            let depth = middles.iter().map(|&at| -body.shape.signed_distance(&frame, at).0);
            deepest = depth.fold(deepest, max);
        }
    }
    deepest
}
