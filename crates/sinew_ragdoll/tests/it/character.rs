//! The state machine of a character.

use crate::actor::{floor, in_centimetres_and_z_up, kaykit, shared, somewhere, walker};
use needs_data::needs_data;
use sinew_anim::{Channel, ClipId, Cursor, Interpolation, Joint, LocalTransform, Pose, Property};
use sinew_math::{Reader, Rotation, Transform, Vec3, Writer, trig};
use sinew_physics::{BodyDef, BodyKind, Shape, ShapeDef, World, WorldDef};
use sinew_ragdoll::{
    AfterSettling, BuildOptions, Character, CharacterDef, CharacterEvent, DriveMode, MotionSet, Muscle,
    State, build,
};
use std::sync::Arc;

fn world() -> World {
    let mut world = World::new(WorldDef::default());
    world.add_body(&floor());
    world
}

/// Steps until `done`, at most `seconds`. Returns all events with their times.
fn run_until(
    world: &mut World,
    character: &mut Character,
    seconds: f32,
    done: impl Fn(&Character) -> bool,
) -> Vec<(f32, CharacterEvent)> {
    let mut events = Vec::new();
    let end = world.time() as f32 + seconds;
    while (world.time() as f32) < end && !done(character) {
        world.step();
        character.update(world);
        events.extend(character.events().iter().map(|&event| (world.time() as f32, event)));
    }
    events
}

/// A limp body with stiff joints stays on its feet; it used to dive to the floor to play its get-up clip.
#[test]
fn body_that_stands_needs_no_get_up_clip() {
    let mut def = walker();
    let motions = MotionSet { looped: None, ..def.motions().clone() };
    def.set_motions(motions).expect("the clips can be played");
    def.ragdoll.joints.iter_mut().for_each(|joint| joint.friction_torque = 1e4);
    for body in &mut def.ragdoll.bodies {
        if body.role.ends_with("Foot") {
            body.shape = Shape::Box { half_extents: Vec3::new(0.3, 0.05, 0.3) };
        }
    }
    let (def, mut world) = (shared(def), world());
    let mut character = Character::new(def, Transform::IDENTITY, 0.0);
    let head = place_of(&character, "head").y;
    character.go_limp(&mut world);
    let mut lowest = head;
    let mut clips = Vec::new();
    for _ in 0..600 {
        world.step();
        character.update(&mut world);
        lowest = f32::min(lowest, place_of(&character, "head").y);
        clips.extend(character.events().iter().filter_map(|event| match event {
            CharacterEvent::GettingUp { clip } => Some(*clip),
            _ => None,
        }));
    }
    assert!(lowest > 0.8 * head, "its head goes down to {lowest} m from {head} m");
    assert_eq!(clips, [None]);
    assert_eq!(character.state(), State::Animated);
}

/// Returns the world position of a joint, metres.
fn place_of(character: &Character, name: &str) -> Vec3 {
    let def = character.def();
    let joint = def.rig.joints.iter().position(|joint| joint.name == name).expect("the joint is there");
    let mut model = Vec::new();
    sinew_anim::local_to_model(&def.rig, character.pose(), &character.world_from_model(), &mut model);
    model[joint].translation
}

fn knocked_over(def: &Arc<CharacterDef>, impulse: Vec3) -> (World, Character) {
    let mut world = world();
    let mut character = Character::new(def.clone(), somewhere(), 0.0);
    run_until(&mut world, &mut character, 0.5, |_| false);
    let chest = def.body_named("chest").expect("the character has a chest");
    let work = character.hit(&mut world, chest, impulse);
    assert!(work > 0.0);
    (world, character)
}

#[test]
fn character_walks_at_its_speed() {
    let def = shared(walker());
    let mut world = world();
    let mut character = Character::new(def, somewhere(), 0.0);
    run_until(&mut world, &mut character, 2.0, |_| false);
    let way = character.world_from_character().translation - somewhere().translation;
    let expected = somewhere().rotation * Vec3::Z * sinew_scenes::mannequin::WALK_SPEED * world.time() as f32;
    assert!((way - expected).length() < 1e-3, "{way} for {expected}");
    assert_eq!(world.body_ids().count(), 1, "an animated character must have no bodies");
}

#[test]
fn character_falls_settles_gets_up_and_walks_on() {
    let def = shared(walker());
    let (mut world, mut character) = knocked_over(&def, Vec3::new(60.0, 0.0, 30.0));
    assert_eq!(character.state(), State::Limp);
    assert_eq!(world.body_ids().count(), 1 + def.ragdoll.bodies.len());
    let events = run_until(&mut world, &mut character, 12.0, |c| c.state() == State::Animated);
    let needed = events.iter().filter(|(_, event)| !matches!(event, CharacterEvent::Preparing { .. }));
    let kinds: Vec<_> = needed.map(|(_, event)| core::mem::discriminant(event)).collect();
    // Events caused by the hit are reported by the next update.
    let expected = [
        CharacterEvent::WentLimp,
        CharacterEvent::Hit { body: 0 },
        CharacterEvent::Touched,
        CharacterEvent::Settled { since: 0.0 },
        CharacterEvent::GettingUp { clip: None },
        CharacterEvent::Up,
    ];
    assert_eq!(kinds, expected.map(|event| core::mem::discriminant(&event)), "{events:?}");
    assert_eq!(world.body_ids().count(), 1, "the bodies must be removed");
    assert!(place_of(&character, "head").y > 1.3);
    // The character accelerates gradually: it does not start at full walking speed.
    run_until(&mut world, &mut character, 0.35, |_| false);
    let before = character.world_from_character().translation;
    run_until(&mut world, &mut character, 1.0, |_| false);
    let way = (character.world_from_character().translation - before).length();
    assert!((way - sinew_scenes::mannequin::WALK_SPEED).abs() < 0.05, "{way} m in a second");
}

#[test]
fn get_up_clip_matches_the_lying_side() {
    let def = shared(walker());
    let mut clear = [0, 0];
    for impulse in [-90.0, 90.0, 40.0, -40.0] {
        let push = somewhere().rotation * Vec3::Z * impulse;
        let (mut world, mut character) = knocked_over(&def, push);
        run_until(&mut world, &mut character, 10.0, |c| c.state() == State::GettingUp);
        assert_eq!(character.state(), State::GettingUp);
        let Some(&CharacterEvent::GettingUp { clip: Some(clip) }) =
            character.events().iter().find(|event| matches!(event, CharacterEvent::GettingUp { .. }))
        else {
            panic!("the character got up without a clip: {:?}", character.events());
        };
        let name = &def.motions().clips[clip].name;
        let up = pelvis_forward(&character).y;
        // For other orientations the limbs decide.
        if up.abs() > 0.3 {
            assert_eq!(name.contains("supine"), up > 0.0, "{name}, lying {up}");
            clear[usize::from(up > 0.0)] += 1;
        }
    }
    assert!(
        clear.iter().all(|&falls| falls > 0),
        "the character never fell on one of the two sides: {clear:?}"
    );
}

/// Returns the direction in which the pelvis faces.
fn pelvis_forward(character: &Character) -> Vec3 {
    let def = character.def();
    let mut model = Vec::new();
    sinew_anim::local_to_model(&def.rig, character.pose(), &sinew_math::Affine::IDENTITY, &mut model);
    let mut bodies = Vec::new();
    def.mapping().bodies_from_model(&model, character.world_from_character(), &mut bodies);
    bodies[0].rotation * (def.ragdoll.bodies[0].character_from_body.rotation.inverse() * Vec3::Z)
}

#[test]
fn no_joint_jumps_on_state_changes() {
    let def = shared(walker());
    let (mut world, mut character) = knocked_over(&def, Vec3::new(-20.0, 0.0, 70.0));
    let joints = ["hips", "head", "leftHand", "rightFoot", "rightLowerLeg"];
    let places = |character: &Character| joints.map(|joint| place_of(character, joint));
    let mut last = places(&character);
    for _ in 0..600 {
        world.step();
        character.update(&mut world);
        let now = places(&character);
        for (joint, (a, b)) in joints.iter().zip(last.iter().zip(&now)) {
            let speed = (*b - *a).length() * 60.0;
            assert!(speed < 9.0, "{joint} moves at {speed} m/s, {:?}", character.events());
        }
        last = now;
    }
    assert_eq!(character.state(), State::Animated);
}

#[test]
fn character_set_to_stay_down_stays_down() {
    let mut def = walker();
    def.after_settling = AfterSettling::StayDown;
    let def = shared(def);
    let (mut world, mut character) = knocked_over(&def, Vec3::Z * 60.0);
    run_until(&mut world, &mut character, 9.0, |_| false);
    assert_eq!(character.state(), State::Limp);
    assert!(place_of(&character, "head").y < 0.4);
}

#[test]
fn character_stands_up_without_a_clip() {
    let mut def = walker();
    let motions = MotionSet { get_ups: Vec::new(), ..def.motions().clone() };
    def.set_motions(motions).expect("the motions were accepted before");
    let def = shared(def);
    let (mut world, mut character) = knocked_over(&def, Vec3::Z * 60.0);
    let events = run_until(&mut world, &mut character, 10.0, |c| c.state() == State::Animated);
    assert!(events.iter().any(|(_, event)| *event == CharacterEvent::GettingUp { clip: None }), "{events:?}");
    assert!(place_of(&character, "head").y > 1.3);
}

#[test]
fn character_follows_stairs_down() {
    let def = shared(walker());
    let mut world = world();
    for step in 0..4 {
        let top = 0.17 * (4 - step) as f32;
        world.add_body(&BodyDef {
            kind: BodyKind::Static,
            position: Vec3::new(0.0, 0.5 * top, 0.3 * step as f32),
            shapes: vec![ShapeDef::new(Shape::Box { half_extents: Vec3::new(1.0, 0.5 * top, 0.15) })],
            ..BodyDef::default()
        });
    }
    let mut character = Character::new(def, Transform::from_translation(Vec3::Y * 0.68), 0.0);
    run_until(&mut world, &mut character, 3.0, |_| false);
    let place = character.world_from_character().translation;
    assert!(place.y.abs() < 1e-3 && place.z > 3.0, "{place}");
}

#[test]
fn restored_character_continues_identically() {
    let def = shared(walker());
    for seconds in [0.3, 1.0, 3.4, 5.0] {
        let (mut world, mut character) = knocked_over(&def, Vec3::new(60.0, 0.0, 30.0));
        run_until(&mut world, &mut character, seconds, |_| false);
        let mut saved = Writer::new();
        world.save(&mut saved);
        character.save(&mut saved);
        let bytes = saved.into_bytes();
        run_until(&mut world, &mut character, 2.0, |_| false);

        let mut other_world = World::new(WorldDef::default());
        let mut other = Character::new(def.clone(), Transform::IDENTITY, 0.0);
        let mut reader = Reader::new(&bytes);
        other_world.load(&mut reader).expect("the world's snapshot is valid");
        other.load(&mut reader).expect("the character's snapshot is valid");
        run_until(&mut other_world, &mut other, 2.0, |_| false);
        assert_eq!(world.hash(), other_world.hash(), "after {seconds} s");
        assert_eq!(character.pose(), other.pose(), "after {seconds} s");
        assert_eq!(character.state(), other.state());

        for length in (0..bytes.len()).step_by(97) {
            let mut reader = Reader::new(&bytes[..length]);
            let whole = other_world.load(&mut reader).is_ok() && other.load(&mut reader).is_ok();
            assert!(!whole, "{length} of {} bytes", bytes.len());
        }
    }
}

#[test]
fn get_up_clips_are_recognised_by_their_motion() {
    let def = walker();
    let mut clips = def.motions().clips.clone();
    let expected = def.motions().get_ups.clone();
    assert_eq!(def.get_ups_among(&clips), expected, "get-up clips were not recognised by their names");
    for (index, clip) in clips.iter_mut().enumerate() {
        clip.name = format!("take {index}");
    }
    assert_eq!(def.get_ups_among(&clips), expected, "get-up clips were not recognised by their motion");
    clips[0].name = "Rig|Stand-Up".into();
    assert_eq!(
        def.get_ups_among(&clips),
        [0, expected[0], expected[1]],
        "the user's choice must have priority"
    );
}

#[test]
fn joints_without_bodies_keep_their_secondary_motion() {
    // A finger on a hand that sways in all clips, and toes, which no clip moves.
    let def = waving();
    let mut world = world();
    let mut character = Character::new(def.clone(), somewhere(), 0.0);
    run_until(&mut world, &mut character, 0.4, |_| false);
    let joint =
        |name: &str| def.rig.joints.iter().position(|joint| joint.name == name).expect("the joint exists");
    let (finger, toes) = (joint("finger"), joint("leftToes"));
    assert!(def.mapping().free().contains(&finger) && !def.mapping().free().contains(&toes));
    let before = character.pose()[finger].rotation;
    character.go_limp(&mut world);
    let mut frozen = None;
    let (mut last, mut way, mut step, mut steps) = (before, 0.0, 0.0, 0);
    while character.ragdoll().is_some() {
        world.step();
        character.update(&mut world);
        let now = character.pose()[finger].rotation;
        step = sinew_math::max(step, last.angle_to(now));
        way += last.angle_to(now);
        last = now;
        steps += 1;
        // The joints' last motion has decayed by then.
        if character.state() == State::Limp && steps > 20 {
            let now = character.pose()[toes].rotation;
            assert_eq!(*frozen.get_or_insert(now), now, "toes must not move while the character lies");
        }
    }
    // The finger sways 0.5 rad to either side once per cycle of about a second: 2 rad per cycle, at most about π rad/s.
    assert!(way > 1.0, "the finger rotated by only {way} rad");
    assert!(step < 1.1 * core::f32::consts::PI / 60.0, "the finger jumped by {step} rad");
}

/// Returns the walker with an extra finger that sways in all of its clips.
fn waving() -> Arc<CharacterDef> {
    let plain = walker();
    let mut rig = plain.rig.clone();
    let hand =
        rig.joints.iter().position(|joint| joint.name == "leftHand").expect("the character has a hand");
    let rest = LocalTransform { translation: Vec3::new(0.05, -0.05, 0.0), ..LocalTransform::default() };
    rig.joints.push(Joint { name: "finger".into(), parent: Some(hand), rest, source: rig.joints.len() });
    let finger = rig.joints.len() - 1;
    let mut motions = plain.motions().clone();
    for clip in &mut motions.clips {
        let times: Vec<f32> = (0..=30_u8).map(|key| clip.duration * f32::from(key) / 30.0).collect();
        let phase = |time: f32| core::f32::consts::TAU * time / clip.duration;
        let sway = |time: f32| Rotation::from_axis_angle(Vec3::Z, 0.5 * trig::sin(phase(time)));
        let values = times.iter().map(|&time| sway(time)).flat_map(|q| [q.x, q.y, q.z, q.w]).collect();
        let (property, interpolation) = (Property::Rotation, Interpolation::Linear);
        clip.channels.push(Channel { joint: finger, property, interpolation, times, values });
    }
    let analysis = sinew_anim::analyze(&rig).expect("the rig has a skin");
    let (ragdoll, _) = build(&rig, &analysis, &BuildOptions::default()).expect("the rig has bones");
    let mut def = CharacterDef::new(rig, ragdoll, &analysis.bind_model);
    def.set_motions(motions).expect("clips that can be played");
    shared(def)
}

#[test]
fn hit_while_getting_up_makes_the_character_limp_again() {
    let def = shared(walker());
    for wanted in [State::Preparing, State::GettingUp] {
        // A push makes the character fall onto its side.
        let side = somewhere().rotation * Vec3::X;
        let (mut world, mut character) = knocked_over(&def, side * 90.0);
        run_until(&mut world, &mut character, 9.0, |c| c.state() == wanted);
        if character.state() != wanted {
            // After this fall the character need not be rolled over.
            assert_eq!(wanted, State::Preparing);
            continue;
        }
        let bodies = world.body_ids().count();
        character.hit(&mut world, 0, Vec3::new(20.0, 30.0, 0.0));
        assert_eq!(character.state(), State::Limp);
        assert!(character.events().contains(&CharacterEvent::WentLimp), "{:?}", character.events());
        let events = run_until(&mut world, &mut character, 12.0, |c| c.state() == State::Animated);
        assert!(
            events.iter().any(|(_, event)| *event == CharacterEvent::Up),
            "no `Up` event in {events:?}; {bodies} bodies"
        );
        assert_eq!(world.body_ids().count(), 1, "the bodies and their drives must be removed");
    }
}

#[test]
fn a_powered_fall_keeps_more_of_its_pose() {
    let bend = |falling: DriveMode| {
        let mut def = walker();
        def.falling = falling;
        let def = shared(def);
        let (mut world, mut character) = knocked_over(&def, Vec3::new(60.0, 0.0, 30.0));
        let knee =
            def.rig.joints.iter().position(|joint| joint.name == "leftLowerLeg").expect("the rig has a knee");
        let (mut off, mut steps) = (0.0, 0);
        for _ in 0..40 {
            world.step();
            character.update(&mut world);
            off += character.pose()[knee].rotation.angle_to(character.animator().pose().get(knee).rotation);
            steps += 1;
        }
        let events = run_until(&mut world, &mut character, 12.0, |c| c.state() == State::Animated);
        assert!(events.iter().any(|(_, event)| *event == CharacterEvent::Up), "{events:?}");
        off / steps as f32
    };
    let (limp, powered) = (bend(DriveMode::Limp), bend(DriveMode::Powered(Muscle::ALIVE)));
    assert!(powered < 0.6 * limp, "mean error {powered} rad powered, {limp} rad limp");
}

/// Returns the joint positions in character space (metres) in a clip of the set.
fn places(def: &CharacterDef, clip: ClipId, time: f32) -> Vec<Vec3> {
    let clip = &def.set().clip(clip).clip;
    let mut pose = Pose::new(clip.joints());
    clip.sample(time, &mut Cursor::new(), &mut pose);
    let pose: Vec<LocalTransform> = pose.iter().collect();
    let mut model = Vec::new();
    sinew_anim::local_to_model(&def.rig, &pose, &def.mapping().character_from_model(), &mut model);
    model.iter().map(|joint| joint.translation).collect()
}

/// Returns the name of the corresponding joint on the other side.
fn other_side(name: &str) -> String {
    let sides = [("left", "right"), ("right", "left")];
    let ends = [(".l", ".r"), (".r", ".l")];
    let swapped = |&(from, to): &(&str, &str)| name.strip_prefix(from).map(|rest| format!("{to}{rest}"));
    let at_end = |&(from, to): &(&str, &str)| name.strip_suffix(from).map(|rest| format!("{rest}{to}"));
    sides.iter().find_map(swapped).or_else(|| ends.iter().find_map(at_end)).unwrap_or_else(|| name.to_owned())
}

#[test]
fn every_get_up_has_a_mirrored_clip() {
    check_mirrors("file", &in_centimetres_and_z_up());
}

#[needs_data]
#[test]
fn every_kaykit_get_up_has_a_mirrored_clip() {
    check_mirrors("KayKit", &kaykit());
}

fn check_mirrors(name: &str, def: &CharacterDef) {
    let clips: Vec<ClipId> = def.set().clips().collect();
    let own = def.motions().clips.len();
    assert_eq!(clips.len(), own + def.motions().get_ups.len());
    let mut worst = 0.0;
    for (index, &get_up) in def.motions().get_ups.iter().enumerate() {
        for k in 0..=10 {
            let time = def.motions().clips[get_up].duration * k as f32 / 10.0;
            let (plain, image) = (places(def, clips[get_up], time), places(def, clips[own + index], time));
            for joint in def.ragdoll.bodies.iter().map(|body| body.joint) {
                let wanted = other_side(&def.rig.joints[joint].name);
                let twin = def.rig.joints.iter().position(|other| other.name == wanted).expect("a twin");
                let mirrored = Vec3::new(-plain[twin].x, plain[twin].y, plain[twin].z);
                worst = sinew_math::max(worst, (image[joint] - mirrored).length());
            }
        }
    }
    // Tolerance: linear interpolation between 30 poses a second, and the rounding of built clips.
    println!("{name}: {worst} m off");
    assert!(worst < 5e-3, "{name}: {worst} m off");
}

#[test]
fn a_character_that_falls_or_lies_allocates_nothing() {
    for falling in [DriveMode::Limp, DriveMode::Powered(Muscle::ALIVE)] {
        let mut def = walker();
        def.falling = falling;
        def.after_settling = AfterSettling::StayDown;
        let (mut world, mut character) = knocked_over(&shared(def), Vec3::new(60.0, 0.0, 30.0));
        run_until(&mut world, &mut character, 0.2, |_| false);
        let mut count = 0;
        for _ in 0..300 {
            world.step();
            count += allocation_counter::measure(|| character.update(&mut world)).count_total;
        }
        // Allowed allocations: events for a contact and for settling.
        assert!(count <= 1, "{falling:?}: {count} allocations");
    }
}

#[test]
fn a_body_that_is_rolled_over_allocates_nothing() {
    let def = shared(walker());
    let mut rolled = 0;
    for push in [90.0, -90.0, 60.0] {
        let (mut world, mut character) = knocked_over(&def, somewhere().rotation * Vec3::X * push);
        run_until(&mut world, &mut character, 9.0, |c| c.state() == State::Preparing);
        // Pins are created in the first steps.
        run_until(&mut world, &mut character, 0.2, |c| c.state() != State::Preparing);
        let mut count = 0;
        for _ in 0..20 {
            world.step();
            let update = allocation_counter::measure(|| character.update(&mut world));
            if character.state() == State::Preparing {
                (rolled, count) = (rolled + 1, count + update.count_total);
            }
        }
        assert_eq!(count, 0, "pushed by {push}");
    }
    assert!(rolled > 10, "{rolled} steps");
}
