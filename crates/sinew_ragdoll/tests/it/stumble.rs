//! Powered characters that are pushed: they stay up, step, or fall.

use crate::actor::{shared, walker};
use crate::in_world::{level, run};
use core::f32::consts::PI;
use core::fmt::Write as _;
use sinew_math::{Random, Reader, Rotation, Transform, Vec3, Writer, max};
use sinew_physics::{BodyId, World, WorldDef};
use sinew_ragdoll::{Character, CharacterDef, CharacterEvent, MotionSet, Preset, QualityMeter, State};
use std::sync::Arc;

/// Returns the definition of a character that stands by default, or walks.
fn puppet() -> Arc<CharacterDef> {
    let mut def = walker();
    let motions = def.motions().clone();
    def.set_motions(MotionSet { idle: Some(1), ..motions }).expect("the motions were accepted before");
    shared(def)
}

/// Returns a powered character that has settled into standing or, if `walks`, into walking at its clip's speed.
fn powered(def: &Arc<CharacterDef>, walks: bool, phase: usize) -> (World, Character) {
    let mut world = level();
    let mut character = Character::spawn(&mut world, def, Transform::IDENTITY);
    if !walks {
        character.set_move(Vec3::ZERO);
    }
    run(&mut world, &mut character, 60);
    character.set_preset(&mut world, Preset::Powered);
    run(&mut world, &mut character, 60 + phase);
    assert_eq!(character.state(), State::Powered);
    (world, character)
}

fn steps_of(events: &[CharacterEvent]) -> u32 {
    let steps =
        |event: &CharacterEvent| if let CharacterEvent::Caught { steps } = event { *steps } else { 0 };
    events.iter().map(steps).sum()
}

#[test]
fn powered_character_steps_to_catch_a_push() {
    let def = puppet();
    let chest = def.body_named("chest").expect("the character has a chest");
    for way in [Vec3::X, -Vec3::X, Vec3::Z, -Vec3::Z, Vec3::new(0.7, 0.0, 0.7)] {
        let (mut world, mut character) = powered(&def, false, 0);
        let before = character.world_from_character().translation;
        character.hit(&mut world, chest, way * 60.0);
        assert!(character.stumbles() && character.events().contains(&CharacterEvent::Stumbled));
        let mut events = Vec::new();
        for _ in 0..180 {
            events.extend(run(&mut world, &mut character, 1));
        }
        assert_eq!(character.state(), State::Powered, "pushed along {way}: {events:?}");
        assert!((1..=4).contains(&steps_of(&events)), "pushed along {way}: {events:?}");
        assert!(!character.stumbles());
        let gone = character.world_from_character().translation - before;
        assert!(gone.dot(way) > 0.15 && gone.length() < 1.5, "pushed along {way}: stepped {gone}");
        let velocity = world.velocity(character.bodies()[0]).linear;
        assert!(velocity.length() < 0.1, "the character still moves: {velocity}");
    }
}

#[test]
fn planted_foot_stays_while_the_other_steps() {
    let def = puppet();
    let (chest, feet) = (
        def.body_named("chest").expect("the character has a chest"),
        ["leftFoot", "rightFoot"].map(|foot| def.body_named(foot).expect("it has feet")),
    );
    let (mut world, mut character) = powered(&def, false, 0);
    let place = |world: &World, character: &Character, foot: usize| {
        world.transform(character.bodies()[feet[foot]]).translation
    };
    let start = [0, 1].map(|foot| place(&world, &character, foot));
    character.hit(&mut world, chest, Vec3::Z * 60.0);
    // One foot stands until the first step is done.
    let mut gone = [0.0; 2];
    for _ in 0..15 {
        run(&mut world, &mut character, 1);
        for foot in 0..2 {
            let way = place(&world, &character, foot) - start[foot];
            gone[foot] = max(gone[foot], Vec3::new(way.x, 0.0, way.z).length());
        }
    }
    let (stands, steps) = if gone[0] < gone[1] { (gone[0], gone[1]) } else { (gone[1], gone[0]) };
    assert!(stands < 0.05 && steps > 0.2, "one foot moved {stands} m, the other {steps} m");
}

#[test]
fn light_push_needs_no_step_and_heavy_push_fells() {
    let def = puppet();
    let chest = def.body_named("chest").expect("the character has a chest");
    let (mut world, mut character) = powered(&def, false, 0);
    character.hit(&mut world, chest, Vec3::Z * 6.0);
    let events = run(&mut world, &mut character, 90);
    assert!(!events.contains(&CharacterEvent::Stumbled) && character.state() == State::Powered, "{events:?}");
    character.hit(&mut world, chest, Vec3::Z * 400.0);
    let events = run(&mut world, &mut character, 180);
    assert!(events.contains(&CharacterEvent::WentLimp), "{events:?}");
}

#[test]
fn impulse_threshold_decides_without_steps() {
    let mut def = walker();
    def.in_world.most_steps = 0;
    let (mut world, mut character) = powered(&shared(def), true, 0);
    character.hit(&mut world, 2, Vec3::X * 60.0);
    assert_eq!(character.state(), State::Limp);
}

#[test]
fn stumble_survives_a_snapshot() {
    let def = puppet();
    for steps in [2, 9, 20, 35, 50] {
        let (mut world, mut character) = powered(&def, false, 0);
        character.hit(&mut world, 2, Vec3::new(20.0, 0.0, 55.0));
        run(&mut world, &mut character, steps);
        let mut w = Writer::new();
        world.save(&mut w);
        character.save(&mut w);
        run(&mut world, &mut character, 60);
        let bytes = w.into_bytes();
        let mut reader = Reader::new(&bytes);
        let mut other_world = World::new(WorldDef::default());
        let mut other = Character::new(def.clone(), Transform::IDENTITY, 0.0);
        other_world.load(&mut reader).expect("the snapshot is valid");
        other.load(&mut reader).expect("the snapshot is valid");
        run(&mut other_world, &mut other, 60);
        assert_eq!(world.hash(), other_world.hash(), "after {steps}");
    }
}

/// Results of pushes of one size.
#[derive(Default)]
struct Tally {
    stood: u32,
    stepped: u32,
    fell: u32,
}

impl Tally {
    fn all(&self) -> u32 {
        self.stood + self.stepped + self.fell
    }

    fn upright(&self) -> f32 {
        1.0 - self.fell as f32 / self.all() as f32
    }
}

/// Impulses of the pushes, N·s.
const SIZES: [f32; 5] = [20.0, 60.0, 100.0, 150.0, 200.0];

/// Any body of a character is pushed in any horizontal direction at any time, standing or walking: 500 times if
/// `SINEW_FULL` is set, otherwise a tenth.
#[test]
fn random_pushes_are_mostly_survived() {
    let def = puppet();
    let each = if std::env::var_os("SINEW_FULL").is_some() { 100 } else { 10 };
    let mut random = Random::new(60);
    let mut table = String::from("push, N·s | stood | stepped | fell | upright\n");
    let mut meter = QualityMeter::new(&def.ragdoll, 8.0);
    let mut tallies = Vec::new();
    for size in SIZES {
        let mut tally = Tally::default();
        for index in 0..each {
            let (mut world, mut character) = powered(&def, index % 2 == 0, random.index(64));
            let body = random.index(def.ragdoll.bodies.len());
            let way = Rotation::from_axis_angle(Vec3::Y, random.range(-PI, PI)) * Vec3::Z;
            character.hit(&mut world, body, way * size);
            let mut events = character.events().to_vec();
            for _ in 0..180 {
                meter.before_step(&world);
                world.step();
                let ragdoll = character.ragdoll().expect("the ragdoll has bodies").clone();
                meter.after_driven_step(&world, &ragdoll);
                character.update(&mut world);
                events.extend_from_slice(character.events());
                if character.state() != State::Powered {
                    break;
                }
            }
            assert_eq!(world.events().quarantined.len(), 0);
            if character.state() != State::Powered {
                tally.fell += 1;
            } else if events.contains(&CharacterEvent::Stumbled) || steps_of(&events) > 0 {
                tally.stepped += 1;
            } else {
                tally.stood += 1;
            }
        }
        let Tally { stood, stepped, fell } = tally;
        let upright = 100.0 * tally.upright();
        writeln!(table, "{size} | {stood} | {stepped} | {fell} | {upright:.0} %").expect("a string");
        tallies.push(tally);
    }
    let quality = meter.quality();
    println!("{table}{quality:?}");
    assert_eq!(quality.nan, 0);
    assert!(quality.joint_gap_p99_m < 1e-3 && quality.joint_gap_max_m < 5e-3, "{quality:?}");
    assert!(quality.limit_overshoot_p99_deg < 2.0 && quality.limit_overshoot_max_deg < 4.0, "{quality:?}");
    assert!(quality.nonadjacent_overlap_max_m < 0.01, "{quality:?}");
    assert!(quality.energy_gain_max < 0.01, "{quality:?}");
    assert!(tallies[0].upright() >= 0.9, "{table}");
    assert!(tallies[1].upright() >= 0.6, "{table}");
}

/// Returns momentum, angular momentum about the origin, and centre of mass of all bodies.
fn motion(world: &World, def: &CharacterDef, bodies: &[BodyId]) -> [Vec3; 3] {
    let [mut momentum, mut spin, mut center] = [Vec3::ZERO; 3];
    for (&id, body) in bodies.iter().zip(&def.ragdoll.bodies) {
        let (place, velocity, mass) = (world.center_of_mass(id), world.velocity(id), body.mass);
        let turn = world.transform(id).rotation;
        momentum += velocity.linear * mass.mass;
        spin += place.cross(velocity.linear * mass.mass);
        spin += turn * (mass.inertia * (turn.inverse() * velocity.angular));
        center += place * (mass.mass / def.ragdoll.total_mass);
    }
    [momentum, spin, center]
}

/// Returns the distance of a floor point from the support polygon of the planted feet, metres, 0 inside; `None` if no
/// foot is planted.
fn outside(character: &Character, point: Vec3) -> Option<f32> {
    // Extents around ankle and ball (heel, toes, sides), and the height of a lifted ankle; metres.
    let [heel, toes, rim, up] = [0.06, 0.08, 0.045, 0.15];
    let def = character.def();
    let mut model = Vec::new();
    sinew_anim::local_to_model(&def.rig, character.pose(), &character.world_from_model(), &mut model);
    let joint = |name: &str| {
        let index = def.rig.joints.iter().position(|joint| joint.name == name).expect("it has such a joint");
        model[index].translation
    };
    let level = |v: Vec3| Vec3::new(v.x, 0.0, v.z);
    let mut corners = Vec::new();
    for side in ["left", "right"] {
        let (ankle, ball) = (joint(&format!("{side}Foot")), joint(&format!("{side}Toes")));
        if ankle.y < up {
            let ahead = level(ball - ankle) * (1.0 / level(ball - ankle).length());
            let across = Vec3::new(ahead.z, 0.0, -ahead.x) * rim;
            for end in [ankle - ahead * heel, ball + ahead * toes] {
                corners.extend([level(end) + across, level(end) - across]);
            }
        }
    }
    let beyond = |way: Vec3| {
        let far = corners.iter().map(|corner| corner.dot(way)).fold(f32::NEG_INFINITY, max);
        point.dot(way) - far
    };
    let ways = (0..64).map(|i| Rotation::from_axis_angle(Vec3::Y, i as f32 * 0.0982) * Vec3::Z);
    (!corners.is_empty()).then(|| ways.map(beyond).fold(0.0, max))
}

/// The external force (net force minus weight), averaged over a tenth of a second, is the force that the feet would
/// have to exert. Two values are bounded: the distance outside of the planted soles at which the force acts on the
/// floor (metres), and the ratio of its horizontal and vertical parts.
#[test]
fn balance_forces_act_near_the_soles() {
    const OVER: usize = 6;
    let def = puppet();
    let chest = def.body_named("chest").expect("the character has a chest");
    for (size, bar) in [(20.0, 0.05), (60.0, 0.12), (100.0, 0.35)] {
        let (mut far, mut slip) = (Vec::new(), Vec::new());
        for way in 0..8 {
            let (mut world, mut character) = powered(&def, way % 2 == 0, 5 * way);
            let way = Rotation::from_axis_angle(Vec3::Y, 0.785 * way as f32) * Vec3::Z;
            character.hit(&mut world, chest, way * size);
            let dt = OVER as f32 * world.def().dt();
            let weight = Vec3::NEG_Y * (9.81 * def.ragdoll.total_mass);
            for _ in 0..12 {
                let [p, l, c] = motion(&world, &def, character.bodies());
                let mut center = c * (1.0 / OVER as f32);
                for _ in 1..OVER {
                    run(&mut world, &mut character, 1);
                    center += motion(&world, &def, character.bodies())[2] * (1.0 / OVER as f32);
                }
                run(&mut world, &mut character, 1);
                if character.state() != State::Powered {
                    break;
                }
                let [to, turned, _] = motion(&world, &def, character.bodies());
                let force = (to - p) * (1.0 / dt) - weight;
                let moment = (turned - l) * (1.0 / dt) - center.cross(weight);
                let on = Vec3::new(moment.z, 0.0, -moment.x) * (1.0 / force.y);
                far.extend(outside(&character, on));
                slip.push(Vec3::new(force.x, 0.0, force.z).length() / force.y);
            }
        }
        far.sort_by(f32::total_cmp);
        slip.sort_by(f32::total_cmp);
        let part = |all: &[f32], share: f32| all[(share * (all.len() - 1) as f32) as usize];
        let (half, most) = (part(&far, 0.5), part(&far, 0.9));
        let (grip, grips) = (part(&slip, 0.5), part(&slip, 0.9));
        println!(
            "{size} N·s: outside of the soles by {half:.3} m (half), {most:.3} (9 of 10); along the floor {grip:.2}, {grips:.2} of the force up"
        );
        assert!(
            half < bar && grip < 0.4 && grips < 1.0,
            "size {size}: half-way at {half} m, grip {grip}, grips {grips}"
        );
    }
}
