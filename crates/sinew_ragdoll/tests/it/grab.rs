//! Grips: a character drags, lifts and releases bodies, and no body is thrown.

use crate::actor::{shared, walker};
use crate::in_world::level;
use sinew_math::{Rotation, Transform, Vec3, max, trig};
use sinew_physics::{BodyDef, BodyKind, JointDef, JointId, JointKind, Shape, ShapeDef, World};
use sinew_ragdoll::{Character, CharacterDef, CharacterEvent, Grab, GrabPoint, Grip, Preset, State};
use std::sync::Arc;

/// Upper bound on the speed of a limb, m/s.
const MOST_SPEED: f32 = 10.0;
/// Upper bound on the gap of a joint between limbs, metres.
const MOST_GAP: f32 = 0.01;

/// Upper bound on a grip's force, relative to the grip's maximum.
const MOST_FORCE: f32 = 1.25;

/// Extremes observed while a body is held.
#[derive(Debug, Default)]
struct Seen {
    /// Largest speed, m/s, force, N, and gap, metres.
    speed: f32,
    force: f32,
    gap: f32,
    slip: f32,
}

impl Seen {
    fn look(&mut self, world: &World, grips: &[JointId]) {
        let dynamic = world.body_ids().filter(|&body| world.kind(body) == BodyKind::Dynamic);
        self.speed = dynamic.map(|body| world.velocity(body).linear.length()).fold(self.speed, max);
        let owned = world.joint_ids().filter(|&joint| world.joint_owner(joint).is_some());
        self.gap = owned.map(|joint| world.joint_gap(joint)).fold(self.gap, max);
        for &grip in grips.iter().filter(|&&grip| world.contains_joint(grip)) {
            self.force = max(self.force, world.reaction(grip).force.length());
            self.slip = max(self.slip, world.joint_transform(grip).translation.length());
        }
    }

    /// Returns true if speed, gap and force are within `times` their bounds.
    fn is_within(&self, times: f32, grab: &Grab) -> bool {
        self.speed <= times * MOST_SPEED
            && self.gap <= times * MOST_GAP
            && self.force <= times * MOST_FORCE * grab.max_force
    }

    fn expect(&self, what: &str, grab: &Grab) {
        assert!(self.speed <= MOST_SPEED, "{what}: a limb moves at {} m/s", self.speed);
        assert!(self.gap <= MOST_GAP, "{what}: a joint gap is {} m", self.gap);
        // A contact or a stop may add to the force within one substep.
        assert!(self.force <= MOST_FORCE * grab.max_force, "{what}: the grip pulls with {} N", self.force);
    }
}

fn body(def: &CharacterDef, name: &str) -> usize {
    def.body_named(name).expect("the ragdoll has this body")
}

/// Returns a limp character at rest on the ground.
fn lying(world: &mut World, def: &Arc<CharacterDef>, place: Transform) -> Character {
    let mut character = Character::spawn(world, def, place);
    character.go_limp(world);
    for _ in 0..80 {
        world.step();
        character.update(world);
    }
    character
}

#[test]
fn mouse_grab_drags_a_limp_character() {
    let def = shared(walker());
    for limb in ["rightHand", "hips", "head", "leftFoot"] {
        let mut world = level();
        let mut puppet = lying(&mut world, &def, Transform::IDENTITY);
        let held = puppet.bodies()[body(&def, limb)];
        let at = world.center_of_mass(held);
        let mut mouse = GrabPoint::take(&mut world, held, at, &Grab::POINT).expect("the named item exists");
        let mut seen = Seen::default();
        for step in 0..800 {
            let target = match step / 60 {
                0 => at + Vec3::Y * 1.8,
                1 => at + Vec3::new(3.0, 1.8, 0.0),
                2 => at + Vec3::new(-3.0, 1.8, 2.0),
                3 => at + Vec3::new(0.0, 3.0, -2.0),
                4 => at + Vec3::new(5.0, -2.0, 5.0),
                5 => at + Vec3::new(0.0, 1.8, 0.0),
                // The target moves back and forth.
                6 | 7 => at + Vec3::new(if step % 20 < 10 { 3.0 } else { -3.0 }, 2.2, 0.0),
                _ => at + Vec3::Y * 2.5,
            };
            mouse.set_target(target);
            assert!(mouse.update(&mut world), "the grip opened");
            world.step();
            puppet.update(&mut world);
            seen.look(&world, &[mouse.joint()]);
            assert_eq!(puppet.state(), State::Limp);
        }
        let away = (world.center_of_mass(held) - mouse.target()).length();
        assert!(away < 0.1, "{limb} hangs {away} m from the mouse");
        mouse.release(&mut world);
        seen.expect(limb, &Grab::POINT);
        for _ in 0..900 {
            world.step();
            puppet.update(&mut world);
        }
        assert_eq!(puppet.state(), State::Animated, "released, it gets up");
    }
}

/// Returns a character that stands at a limb of a lying one, turned away from it, and has grabbed the limb.
fn dragging(
    def: &Arc<CharacterDef>,
    limb: &str,
    phase: usize,
    grab: &Grab,
) -> (World, Character, Character, Option<JointId>) {
    let mut world = level();
    let mut victim = lying(&mut world, def, Transform::IDENTITY);
    let held = victim.bodies()[body(def, limb)];
    let (at, hips) = (world.center_of_mass(held), world.center_of_mass(victim.bodies()[0]));
    let away = (at - hips) * Vec3::new(1.0, 0.0, 1.0);
    let turn = Rotation::from_axis_angle(Vec3::Y, trig::atan2(away.x, away.z) + 0.1 * phase as f32);
    let place = at + turn * Vec3::new(-0.25, 0.0, 0.2);
    let place = Transform::new(Vec3::new(place.x, 0.0, place.z), turn);
    let mut hero = Character::spawn(&mut world, def, place);
    hero.set_move(Vec3::ZERO);
    for _ in 0..20 + 8 * phase {
        world.step();
        hero.update(&mut world);
        victim.update(&mut world);
    }
    let joint = hero.grab(&mut world, "leftHand", held, grab);
    (world, hero, victim, joint)
}

/// Eleven of twelve starts stay within the bounds, and none exceeds them twofold. A limb dragged over the ground
/// catches and turns chaotically, and the peak force varies with it.
#[test]
fn walker_drags_a_limp_character() {
    let def = shared(walker());
    let grab = Grab { reach: 1.5, ..Grab::HAND };
    let (mut all, mut beyond) = (0, 0);
    for limb in ["leftHand", "rightHand", "rightFoot", "leftLowerArm"] {
        let (mut dragged, mut tried) = (0, 0);
        for phase in 0..6 {
            let (mut world, mut hero, mut victim, joint) = dragging(&def, limb, phase, &grab);
            // A walker that stumbled over the other before grabbing it is skipped.
            let Some(joint) = joint.filter(|_| hero.state() == State::Animated) else { continue };
            tried += 1;
            let lay = world.center_of_mass(victim.bodies()[0]);
            let mut seen = Seen::default();
            let mut from = Vec3::ZERO;
            for step in 0..300 {
                if step == 60 {
                    from = hero.world_from_character().translation;
                    hero.set_move(hero.world_from_character().rotation * Vec3::Z * 1.2);
                }
                world.step();
                hero.update(&mut world);
                victim.update(&mut world);
                if world.contains_joint(joint) {
                    seen.look(&world, &[joint]);
                    assert_eq!(victim.state(), State::Limp, "{limb}: a held character must not get up");
                }
            }
            assert!(seen.is_within(2.0, &grab), "{limb}, {phase}: {seen:?}");
            (all, beyond) = (all + 1, beyond + usize::from(!seen.is_within(1.0, &grab)));
            let gone = (hero.world_from_character().translation - from).length();
            assert!(
                gone > 0.95 * 1.2 * 4.0 && hero.state() == State::Animated,
                "{limb}: the character walked {gone} m"
            );
            dragged += usize::from((world.center_of_mass(victim.bodies()[0]) - lay).length() > 3.0);
        }
        assert!(tried >= 3 && dragged + 1 >= tried, "{limb}: dragged {dragged} m of {tried} m");
    }
    assert!(12 * beyond <= all, "{beyond} of {all} readings exceed the bounds");
}

#[test]
#[should_panic(expected = "`Character::grab` takes hold of it")]
fn holding_a_body_of_a_character_panics() {
    let def = shared(walker());
    let mut world = level();
    let other = lying(&mut world, &def, Transform::IDENTITY);
    let mut hero = Character::spawn(&mut world, &def, Transform::from_translation(Vec3::X * 3.0));
    hero.hold(&mut world, "rightHand", other.bodies()[0], &Grip::default());
}

#[test]
fn grip_releases_at_its_maximum_force() {
    let def = shared(walker());
    // The victim is fixed to the world.
    let grab = Grab { reach: 1.5, ..Grab::HAND };
    let (mut world, mut hero, mut victim, joint) = dragging(&def, "leftHand", 1, &grab);
    let joint = joint.expect("the point is in reach");
    let ground = world.add_body(&BodyDef { kind: BodyKind::Static, ..BodyDef::default() });
    let hips = victim.bodies()[0];
    let place = world.transform(hips);
    let nail = JointDef::between(ground, hips, place, Transform::IDENTITY, JointKind::Fixed);
    world.add_joint(&nail);
    let mut seen = Seen::default();
    let mut let_go = None;
    hero.set_move(hero.world_from_character().rotation * Vec3::Z * 1.2);
    for step in 0..200 {
        world.step();
        hero.update(&mut world);
        victim.update(&mut world);
        seen.look(&world, &[joint]);
        if hero.events().iter().any(|event| matches!(event, CharacterEvent::LetGo { .. })) {
            let_go.get_or_insert(step);
        }
    }
    seen.expect("fixed", &grab);
    assert!(let_go.is_some(), "a hand must release a fixed body");
    assert_eq!(hero.state(), State::Animated);
    // A crate hangs on a grip: the grip holds it if its weight is slightly less than the grip's force, and drops it if
    // slightly more.
    for (share, holds) in [(0.85, true), (1.05, false)] {
        let mut world = level();
        let side = 0.5;
        let density = share * grab.max_force / 9.81 / (side * side * side);
        let crate_ =
            ShapeDef { density, ..ShapeDef::new(Shape::Box { half_extents: Vec3::splat(0.5 * side) }) };
        let held = world.add_body(&BodyDef::dynamic(crate_).at(Vec3::Y * 1.5));
        let top = Vec3::Y * (1.5 + 0.5 * side);
        let slip = 0.4;
        let mut crane =
            GrabPoint::take(&mut world, held, top, &Grab { slip, ..grab }).expect("the named item exists");
        crane.set_target(top + Vec3::Y * 0.3);
        let (mut held_on, mut most) = (true, 0.0);
        for _ in 0..300 {
            held_on &= crane.update(&mut world);
            world.step();
            if held_on {
                most = max(most, world.reaction(crane.joint()).force.length());
            }
        }
        let y = world.transform(held).translation.y;
        assert!(most <= grab.max_force, "{most} N");
        assert_eq!(held_on && y > 1.7, holds, "{share} of the grip's force, at a height of {y} m");
    }
}

#[test]
fn characters_holding_each_other_stay_together() {
    let def = shared(walker());
    for powered in [[false, false], [true, false], [true, true]] {
        let mut world = level();
        let mut pair =
            [0.0, 0.45].map(|x| Character::spawn(&mut world, &def, Transform::from_translation(Vec3::X * x)));
        for (character, powered) in pair.iter_mut().zip(powered) {
            if powered {
                character.set_preset(&mut world, Preset::Powered);
            }
        }
        for _ in 0..10 {
            world.step();
            pair.iter_mut().for_each(|character| character.update(&mut world));
        }
        for (character, powered) in pair.iter_mut().zip(powered) {
            if !powered {
                character.go_limp(&mut world);
            }
        }
        let grab = Grab { reach: 0.6, drops: false, ..Grab::HAND };
        let mut grips = Vec::new();
        for (who, hand) in [(0, "leftHand"), (1, "rightHand")] {
            let other = pair[1 - who].bodies()[body(&def, "chest")];
            grips.push(pair[who].grab(&mut world, hand, other, &grab).expect("the points are in reach"));
        }
        let mut seen = Seen::default();
        for _ in 0..400 {
            world.step();
            pair.iter_mut().for_each(|character| character.update(&mut world));
            seen.look(&world, &grips);
        }
        let apart =
            (world.center_of_mass(pair[0].bodies()[0]) - world.center_of_mass(pair[1].bodies()[0])).length();
        seen.expect(&format!("powered {powered:?}"), &grab);
        assert!(apart < 1.0, "{apart} m apart");
        let held: usize = pair.iter().map(|character| character.held().count()).sum();
        assert!(held == 2, "{held} grips still hold");
    }
}

#[test]
fn character_carried_over_the_shoulder_stays_on() {
    let def = shared(walker());
    let mut world = level();
    let mut victim = lying(&mut world, &def, Transform::IDENTITY);
    let lies = world.center_of_mass(victim.bodies()[0]);
    let place = Transform::from_translation(Vec3::new(lies.x + 0.9, 0.0, lies.z));
    let mut hero = Character::spawn(&mut world, &def, place);
    hero.set_move(Vec3::ZERO);
    for _ in 0..10 {
        world.step();
        hero.update(&mut world);
        victim.update(&mut world);
    }
    let hips = victim.bodies()[0];
    let chest = hero.bodies()[body(&def, "chest")];
    // The victim is over the left shoulder, held at the hips.
    let shoulder =
        world.transform(chest).inverse_point(world.center_of_mass(chest) + Vec3::new(0.2, 0.3, 0.0));
    let grab = Grab { max_force: 3000.0, reach: 2.0, to: Some(shoulder), speed: 1.0, ..Grab::HAND };
    let grip = hero.grab(&mut world, "chest", hips, &grab).expect("the point is in reach");
    let mut seen = Seen::default();
    for step in 0..600 {
        if step == 180 {
            hero.set_move(Vec3::Z * 1.2);
        }
        world.step();
        hero.update(&mut world);
        victim.update(&mut world);
        seen.look(&world, &[grip]);
    }
    let at = world.center_of_mass(hips) - hero.world_from_character().translation;
    seen.expect("carried", &grab);
    assert!(
        at.y > 1.2 && (at - Vec3::Y * at.y).length() < 0.4,
        "the load hangs at {at} from the carrier's feet"
    );
    assert!(hero.world_from_character().translation.z > lies.z + 6.0, "the carrier must not stop walking");
    assert_eq!((hero.state(), victim.state()), (State::Animated, State::Limp));
    assert!(hero.release(&mut world, hips));
    for _ in 0..900 {
        world.step();
        hero.update(&mut world);
        victim.update(&mut world);
    }
    assert_eq!(victim.state(), State::Animated, "put down, it gets up");
}
