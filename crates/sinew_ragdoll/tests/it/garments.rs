//! Garments: built from chains of bones, attached to the body, driving the bones; through teleports, snapshots, falls
//! and bakes.

use sinew_anim::{Garment, GarmentColumn, Property, guess_garments, local_to_model};
use sinew_math::{Reader, Transform, Vec3, Writer, max, min};
use sinew_physics::particles::ParticleGroup;
use sinew_physics::{BodyDef, Shape, World, WorldDef};
use sinew_ragdoll::{BakeHit, BakeInput, Character, CharacterDef, Detail, State, bake};
use sinew_scenes::dressed::{CAPE, Chains, SKIRT, dressed, dressed_rig};
use std::sync::Arc;

pub fn ground(gravity: Vec3) -> World {
    let mut world = World::new(WorldDef { gravity, ..WorldDef::default() });
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    world
}

fn earth() -> Vec3 {
    WorldDef::default().gravity
}

/// Returns a walking character with these garments, and its world.
fn walking(garments: &[&Chains]) -> (World, Character) {
    let mut world = ground(earth());
    let def = Arc::new(dressed(garments, |_| ()));
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    character.set_move(Vec3::Z * 1.3);
    (world, character)
}

pub fn go_on(world: &mut World, character: &mut Character, steps: u32) {
    for _ in 0..steps {
        world.step();
        character.update(world);
    }
}

/// Returns true if a spring joins two particles. Particles are stored line after line.
fn is_joined(group: &ParticleGroup, a: usize, b: usize) -> bool {
    group.springs().iter().any(|spring| {
        [spring.a, spring.b] == [a as u32, b as u32] || [spring.b, spring.a] == [a as u32, b as u32]
    })
}

/// Returns the relative change of each spring's length since rest.
fn stretches(group: &ParticleGroup) -> impl Iterator<Item = f32> {
    let at = group.positions();
    group
        .springs()
        .iter()
        .map(|s| ((at[s.b as usize] - at[s.a as usize]).length() / s.rest_length - 1.0).abs())
}

pub fn mean_stretch(group: &ParticleGroup) -> f32 {
    stretches(group).sum::<f32>() / group.springs().len() as f32
}

fn largest_stretch(group: &ParticleGroup) -> f32 {
    stretches(group).fold(0.0, max)
}

#[test]
fn skirt_is_closed_and_cape_is_open() {
    let def = dressed(&[&SKIRT, &CAPE], |_| ());
    let worn = def.garments();
    let names: Vec<(&str, usize, bool)> =
        worn.source().iter().map(|g| (g.name.as_str(), g.columns.len(), g.closed)).collect();
    assert_eq!(names, [("cape", CAPE.columns, false), ("skirt", SKIRT.columns, true)]);
    assert!(worn.left_out().is_empty());
    // The last joint of each chain is at the hem.
    assert_eq!(worn.joints().len(), CAPE.columns * CAPE.bones + SKIRT.columns * SKIRT.bones);
    let mut world = ground(earth());
    let character = Character::spawn(&mut world, &Arc::new(def), Transform::IDENTITY);
    for (&id, closed) in character.garments().iter().zip([false, true]) {
        let group = world.particles(id);
        let (count, lines) = (group.positions().len(), group.attachments().len());
        let rows = count / lines;
        assert_eq!(count, rows * lines, "a grid");
        // Test the hem particles of the first and the last line.
        assert_eq!(is_joined(group, rows - 1, count - 1), closed);
        assert!(is_joined(group, rows - 1, 2 * rows - 1) && is_joined(group, 0, 1));
        let longest = group.springs().iter().map(|spring| spring.rest_length).fold(0.0, max);
        assert!(longest < 1.45 * 0.05, "the gap between chains is {longest} m");
    }
}

#[test]
fn garments_are_found_by_bone_names() {
    let mut rig = dressed_rig(&[&SKIRT]);
    // Columns are listed in another order than around the waist; each still is next to the right ones.
    let first = rig.joints.len() - SKIRT.columns * (SKIRT.bones + 1);
    let rests: Vec<_> = rig.joints.iter().map(|joint| joint.rest).collect();
    for column in 0..SKIRT.columns {
        let [own, place] = [column, (column * 3) % SKIRT.columns].map(|at| first + at * (SKIRT.bones + 1));
        rig.joints[own].name = format!("Skirt_{column}_0");
        for down in 0..=SKIRT.bones {
            rig.joints[own + down].rest = rests[place + down];
        }
    }
    let order: Vec<usize> = guess_garments(&rig)[0]
        .columns
        .iter()
        .map(|column| (column.joints[0] - first) / (SKIRT.bones + 1))
        .collect();
    let step = |pair: &[usize]| (pair[1] + SKIRT.columns - pair[0]) % SKIRT.columns;
    let steps: Vec<usize> = order.windows(2).map(step).collect();
    assert!(steps.iter().all(|&step| step == steps[0]) && [3, 7].contains(&steps[0]), "{order:?}");
    // A single chain, or chains with another name, are not garments.
    for joint in &mut rig.joints[first + SKIRT.bones + 1..] {
        joint.name = "strand".to_owned();
    }
    assert!(guess_garments(&rig).is_empty());
}

#[test]
fn invalid_garment_chains_are_skipped() {
    let mut def = dressed(&[&CAPE], |_| ());
    let joint = |name: &str| {
        def.rig.joints.iter().position(|joint| joint.name == name).expect("the named item exists")
    };
    let (leg, cape) = (joint("leftUpperLeg"), joint("cape_0_0"));
    let column = |top| GarmentColumn::below(&def.rig, top);
    // Bodies move the legs, and a single remaining chain is not a sheet.
    let legs = Garment { columns: vec![column(leg), column(cape)], ..Garment::default() };
    // A chain in two garments belongs to the first.
    let twice = Garment { columns: vec![column(cape), column(joint("cape_1_0"))], ..Garment::default() };
    def.set_garments(&[legs, twice]);
    assert!(def.garments().is_empty());
    assert!(def.garments().left_out().contains(&leg) && def.garments().left_out().contains(&cape));
}

#[test]
fn garment_bones_keep_the_bind_pose_without_gravity() {
    let mut def = dressed(&[&SKIRT, &CAPE], |_| ());
    def.set_motions(sinew_ragdoll::MotionSet::default()).expect("none");
    let mut world = ground(Vec3::ZERO);
    let mut character = Character::spawn(&mut world, &Arc::new(def), Transform::IDENTITY);
    go_on(&mut world, &mut character, 60);
    let def = character.def().clone();
    let pairs = character.pose().iter().zip(character.pose_without_springs());
    let most = pairs.map(|(worn, rest)| worn.rotation.angle_to(rest.rotation)).fold(0.0, max);
    assert!(most < 0.01, "without gravity the bones rotate by {most} rad");
    // With gravity the hem sinks, and only free bones turn noticeably.
    assert!(def.garments().particles().all(|count| count > 100));
}

#[test]
fn garment_bones_follow_the_sheet() {
    let (mut world, mut character) = walking(&[&SKIRT, &CAPE]);
    let mut model = Vec::new();
    for second in 1..=4 {
        go_on(&mut world, &mut character, 45);
        let def = character.def().clone();
        local_to_model(&def.rig, character.pose(), &character.world_from_model(), &mut model);
        let moved = character.pose().iter().zip(character.pose_without_springs());
        let turned = moved.map(|(worn, rest)| worn.rotation.angle_to(rest.rotation)).fold(0.0, max);
        assert!(turned > 0.1, "after {second} s the garment swings by {turned} rad");
        for (garment, &id) in def.garments().source().iter().zip(character.garments()) {
            let positions = world.particles(id).positions();
            for joint in garment.joints() {
                let place = model[joint].translation;
                let away = positions.iter().map(|p| (*p - place).length()).fold(f32::INFINITY, min);
                // Bones keep their length although the sheet is wavy, so the tolerance is an eighth of the cape's
                // length.
                let bar = if garment.closed { 0.045 } else { 0.12 };
                assert!(away < bar, "{} is {away} m from the sheet", def.rig.joints[joint].name);
            }
        }
    }
}

#[test]
fn sheet_that_starts_inside_the_body_stays_slow() {
    // A skirt so tight that bodies of hips and thighs contain most of it.
    const TIGHT: Chains =
        Chains { place: |across, down| (SKIRT.place)(across, down) * Vec3::new(0.7, 1.0, 0.7), ..SKIRT };
    let mut def = dressed(&[&TIGHT], |_| ());
    def.set_motions(sinew_ragdoll::MotionSet::default()).expect("none");
    let mut world = ground(earth());
    let mut character = Character::spawn(&mut world, &Arc::new(def), Transform::IDENTITY);
    let mut fastest = 0.0;
    for _ in 0..120 {
        go_on(&mut world, &mut character, 1);
        let group = world.particles(character.garments()[0]);
        fastest = group.velocities().iter().map(|v| v.length()).fold(fastest, max);
    }
    // The bound is the speed of a fall from the seam to the ground.
    assert!(fastest < 4.4, "{fastest} m/s");
    let group = world.particles(character.garments()[0]);
    let now = group.velocities().iter().map(|v| v.length()).fold(0.0, max);
    assert!(now < 0.2 && mean_stretch(group) < 0.03, "{now} m/s, {}", mean_stretch(group));
}

/// A skirt is put on in mid-stride, where the thighs intersect its bones' positions. The skirt starts outside the legs,
/// with its lengths kept.
#[test]
fn sheet_put_on_in_mid_stride_starts_outside_the_legs() {
    let (mut deepest, mut stretch): (f32, f32) = (0.0, 0.0);
    for steps in [20, 27, 34, 41, 48, 55] {
        let (mut world, mut character) = walking(&[&SKIRT]);
        character.set_level_of_detail(&mut world, Detail::Keyed);
        go_on(&mut world, &mut character, steps);
        character.set_level_of_detail(&mut world, Detail::Full);
        assert_eq!(character.garments().len(), 1, "it is worn at once");
        let group = world.particles(character.garments()[0]);
        stretch = max(stretch, mean_stretch(group));
        let is_free = |particle: u32| group.attachments().iter().all(|held| held.particle != particle);
        for (body, &id) in character.def().ragdoll.bodies.iter().zip(character.bodies()) {
            if !group.passes().contains(&id) {
                let frame = world.transform(id);
                let free = (0..).zip(group.positions()).filter(|(particle, _)| is_free(*particle));
                let depth = free.map(|(_, &at)| -body.shape.signed_distance(&frame, at).0);
                deepest = depth.fold(deepest, max);
            }
        }
    }
    assert!(deepest < 0.005, "{deepest} m in a body");
    assert!(stretch < 0.05, "stretch {stretch}");
}

#[test]
fn teleport_moves_garments_and_reset_restores_them() {
    let (mut world, mut character) = walking(&[&CAPE]);
    go_on(&mut world, &mut character, 50);
    let to = Transform::from_translation(Vec3::new(40.0, 0.0, -30.0));
    let moved = to * character.world_from_character().inverse();
    let id = character.garments()[0];
    let before: Vec<Vec3> = world.particles(id).positions().to_vec();
    character.teleport(&mut world, to);
    for (now, before) in world.particles(id).positions().iter().zip(&before) {
        assert!((*now - moved.point(*before)).length() < 1e-4);
    }
    go_on(&mut world, &mut character, 1);
    let stretch = largest_stretch(world.particles(id));
    assert!(stretch < 0.2, "the garment lags behind: stretch {stretch}");
    // A particle is displaced; the reset puts it back to the pose.
    world.particles_mut(id).set_position(20, to.point(Vec3::new(0.0, 3.0, 0.0)));
    character.reset_garments(&mut world);
    let stretch = largest_stretch(world.particles(character.garments()[0]));
    assert!(stretch < 0.2, "{stretch}");
    assert_eq!(world.group_ids().count(), 1);
}

fn bytes(character: &Character) -> Vec<u8> {
    let mut w = Writer::new();
    character.save(&mut w);
    w.into_bytes()
}

#[test]
fn snapshot_during_a_swing_continues_identically() {
    let (mut world, mut character) = walking(&[&SKIRT]);
    go_on(&mut world, &mut character, 40);
    character.go_limp(&mut world);
    go_on(&mut world, &mut character, 20);
    let mut w = Writer::new();
    world.save(&mut w);
    let mut other = World::new(WorldDef::default());
    other.load(&mut Reader::new(w.as_bytes())).expect("the saved state is valid");
    let saved = bytes(&character);
    let mut copy = Character::new(character.def().clone(), Transform::IDENTITY, 0.0);
    copy.load(&mut Reader::new(&saved)).expect("the saved state is valid");
    assert_eq!(copy.pose(), character.pose());
    for _ in 0..60 {
        go_on(&mut world, &mut character, 1);
        go_on(&mut other, &mut copy, 1);
        assert_eq!(bytes(&copy), bytes(&character));
        assert_eq!(copy.pose(), character.pose());
    }
    assert!(copy.load(&mut Reader::new(&saved[..saved.len() - 5])).is_err());
    // Loading into a character without garments fails.
    let bare = Arc::new(CharacterDef::clone(&sinew::mannequin::character()));
    assert!(Character::new(bare, Transform::IDENTITY, 0.0).load(&mut Reader::new(&saved)).is_err());
}

#[test]
fn garments_exist_while_bodies_do() {
    let (mut world, mut character) = walking(&[&SKIRT, &CAPE]);
    assert_eq!(world.group_ids().count(), 2);
    character.set_level_of_detail(&mut world, Detail::Keyed);
    assert_eq!((world.group_ids().count(), character.garments().len()), (0, 0));
    go_on(&mut world, &mut character, 2);
    assert_eq!(character.pose(), character.pose_without_springs());
    character.set_level_of_detail(&mut world, Detail::Full);
    go_on(&mut world, &mut character, 2);
    assert_eq!(world.group_ids().count(), 2);
    character.despawn(&mut world);
    assert_eq!((world.group_ids().count(), world.body_ids().count()), (0, 1));
}

/// A character added outside of the world gets its bodies, and its garments with them, when it falls.
#[test]
fn new_bodies_come_with_garments() {
    let mut world = ground(earth());
    let def = Arc::new(dressed(&[&CAPE], |_| ()));
    let mut character = Character::new(def, Transform::IDENTITY, 0.0);
    character.go_limp(&mut world);
    go_on(&mut world, &mut character, 30);
    assert_eq!((character.state(), world.group_ids().count()), (State::Limp, 1));
    character.despawn(&mut world);
    assert_eq!(world.group_ids().count(), 0);
}

#[test]
fn bake_includes_garment_bones() {
    let def = Arc::new(dressed(&[&CAPE], |_| ()));
    let mut bare = CharacterDef::clone(&def);
    bare.set_garments(&[]);
    let floor = [BodyDef::fixed(Shape::HalfSpace)];
    let hits = [BakeHit { time: 0.5, body: 0, impulse: Vec3::new(0.0, 0.0, -150.0) }];
    let baked = |def: Arc<CharacterDef>| {
        let input = BakeInput { bodies: &floor, hits: &hits, seconds: 1.5, ..BakeInput::new(def) };
        bake(&input)
    };
    let worn = baked(def.clone());
    let turns = |joint: usize| {
        worn.clip
            .channels
            .iter()
            .any(|c| c.joint == joint && c.property == Property::Rotation && c.times.len() > 2)
    };
    assert!(def.garments().joints().all(turns));
    // Garment bones also move before the fall.
    let joint = def.garments().joints().next().expect("the rig has bones");
    let swings = worn.frames.iter().filter(|frame| frame.time < 0.5);
    let most = swings.map(|frame| frame.pose[joint].rotation.angle_to(def.rest()[joint].rotation));
    assert!(most.fold(0.0, max) > 0.02, "the garment must swing while walking");
    let bare = baked(Arc::new(bare));
    assert!(
        !bare.clip.channels.iter().any(|channel| def.garments().joints().any(|joint| joint == channel.joint))
    );
}

#[test]
fn settings_choose_the_garments() {
    use sinew_ragdoll::settings::{GarmentSettings, GarmentSource};
    let rig = dressed_rig(&[&SKIRT, &CAPE]);
    let listed = |chains: &[&str]| {
        let chains = chains.iter().map(|name| (*name).to_owned()).collect();
        GarmentSource::Listed(vec![GarmentSettings { chains, ..GarmentSettings::default() }])
    };
    let by_names = GarmentSource::Names.garments(&rig).expect("names are no error");
    let pattern = &listed(&["skirt_*"]).garments(&rig).expect("there are such")[0];
    assert_eq!((pattern.columns.len(), pattern.closed), (SKIRT.columns, true));
    assert_eq!(pattern.columns, by_names[1].columns);
    let some = &listed(&["cape_1_0", "cape_0_0"]).garments(&rig).expect("there are such")[0];
    assert_eq!((some.columns.len(), some.columns[0].joints.len()), (2, CAPE.bones + 1));
    for (chains, place, hint) in [
        (["cape_*", "skrit_0_0"], "garments[0].chains[1]", "skirt_0_0"),
        (["cape_4_6", "hut_*"], "garments[0].chains[1]", "the nearest"),
    ] {
        let error = listed(&chains).garments(&rig).expect_err("no such bone");
        let sinew_ragdoll::SettingsError::Setting { place: at, what } = error else { panic!("of a setting") };
        assert!(at == place && what.contains(hint), "{at}: {what}");
    }
    let error = listed(&["cape_0_0"]).garments(&rig).expect_err("one chain is no cloth");
    assert!(error.to_string().contains("two chains"), "{error}");
}

#[test]
fn garment_bones_do_not_shape_the_body() {
    use sinew_ragdoll::settings::GarmentSource;
    use sinew_ragdoll::{BuildOptions, Settings, build_with};
    let (rig, bare) = (dressed_rig(&[&SKIRT, &CAPE]), sinew_scenes::mannequin::mannequin().rig);
    let of = |rig: &sinew_anim::Rig, settings: &Settings| {
        let analysis = sinew_anim::analyze(rig).expect("the rig has a skin");
        build_with(rig, &analysis, &BuildOptions::default(), settings).expect("it can be built").0
    };
    let settings = Settings { garments: GarmentSource::Names, ..Settings::default() };
    let (dressed, bare) = (of(&rig, &settings), of(&bare, &Settings::default()));
    let shapes = |def: &sinew_ragdoll::RagdollDef| -> Vec<_> {
        def.bodies.iter().map(|body| (body.shape.clone(), body.mass, body.character_from_body)).collect()
    };
    assert_eq!(shapes(&dressed), shapes(&bare), "a skirt must not change the shapes");
    assert_ne!(
        shapes(&of(&rig, &Settings::default())),
        shapes(&bare),
        "without settings the skirt changes the shapes"
    );
}
