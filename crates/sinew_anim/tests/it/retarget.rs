//! Tests of captured motions retargeted to bodies of other sizes and builds.

use crate::mocap::{Actor, actor, character, imitation};
use needs_data::needs_data;
use sinew_anim::contact::{ContactSettings, contacts, floor_under, foot_slide, lowest, sole_points};
use sinew_anim::legs::Legs;
use sinew_anim::retarget::{
    Body, Feet, Pace, Reference, RetargetError, RetargetOptions, Retargeted, retarget, stand,
};
use sinew_anim::{Clip, FootContact, Property, Rig, RigAnalysis, Role, Side, Take, local_to_model};
use sinew_formats::bvh::{BvhOptions, BvhRows, read_bvh};
use sinew_math::{Affine, Random, Vec3, direction};

const WALK: &str = "cmu_12_01_walk.bvh";

fn onto(actor: &Actor, rig: &Rig, analysis: &RigAnalysis, options: &RetargetOptions) -> Retargeted {
    let body = Body { rig: &actor.rig, analysis: &actor.analysis };
    retarget(body, &actor.clip, Body { rig, analysis }, options).unwrap()
}

/// Scales a character by `times`.
fn scaled(rig: &Rig, analysis: &RigAnalysis, times: f32) -> (Rig, RigAnalysis) {
    let mut rig = rig.clone();
    for joint in rig.joints.iter_mut().filter(|joint| joint.parent.is_none()) {
        joint.rest.translation *= times;
        joint.rest.scale *= times;
    }
    for skin in &mut rig.skins {
        for (&joint, inverse) in skin.joints.iter().zip(&mut skin.inverse_bind) {
            let bind = analysis.bind_model[joint];
            let grown = Affine { linear: bind.linear * times, translation: bind.translation * times };
            // Vertices are unchanged: the skin's bind matrices grow.
            let before = bind * *inverse;
            *inverse = grown.inverse()
                * Affine { linear: before.linear * times, translation: before.translation * times };
        }
    }
    let found = sinew_anim::analyze(&rig).unwrap().with_unit_scale(analysis.unit_scale);
    (rig, found)
}

/// Returns the largest angle between the directions of a bone in the two bodies' own axes over all frames, degrees.
fn bone_error(
    actor: &Actor,
    from: &Take,
    rig: &Rig,
    analysis: &RigAnalysis,
    to: &Take,
    [a, b]: [Role; 2],
) -> f32 {
    let way = |rig: &Rig, analysis: &RigAnalysis, take: &Take, frame: usize| {
        let mut model = Vec::new();
        local_to_model(rig, take.pose(frame), &analysis.character_from_file(), &mut model);
        let place = |role: Role| model[analysis.joint_with(role).unwrap()].translation;
        direction(place(b) - place(a)).unwrap()
    };
    let angle = |frame: usize| {
        let cos = way(&actor.rig, &actor.analysis, from, frame).dot(way(rig, analysis, to, frame));
        sinew_math::trig::acos(sinew_math::clamp(cos, -1.0, 1.0)).to_degrees()
    };
    (0..to.frames()).map(angle).fold(0.0, sinew_math::max)
}

#[needs_data]
#[test]
fn captured_walk_is_analysed_correctly() {
    let walk = actor(WALK);
    assert_eq!(walk.reference, Reference::Stated);
    let name = |role: Role| walk.analysis.joint_with(role).map(|joint| walk.rig.joints[joint].name.as_str());
    for (role, expected) in [
        (Role::Hips, "Hips"),
        (Role::UpperLeg(Side::Left), "LeftUpLeg"),
        (Role::LowerLeg(Side::Right), "RightLeg"),
        (Role::Foot(Side::Left), "LeftFoot"),
        (Role::Toes(Side::Left), "LeftToeBase"),
        (Role::UpperArm(Side::Left), "LeftArm"),
        (Role::LowerArm(Side::Right), "RightForeArm"),
        (Role::Hand(Side::Right), "RightHand"),
        (Role::Head, "Head"),
    ] {
        assert_eq!(name(role), Some(expected), "{role:?}: {:?}", walk.analysis.notes);
    }
    assert!((walk.analysis.height - 1.6).abs() < 0.2, "{}", walk.analysis.height);
    let take = Take::of(&walk.rig, &walk.clip, 1.0 / 60.0);
    let feet = Legs::of(&walk.rig, &walk.analysis).unwrap().feet;
    let points = sole_points(&walk.rig, &walk.analysis.character_from_file(), &feet, &take);
    let floor = floor_under(&points);
    let found = contacts(&take, &feet, &points, floor, &ContactSettings::for_leg(feet[0].length));
    println!("floor {floor}, {found:?}");
    // Feet alternate, and each is on the ground for about six tenths of the time.
    let inner = &found[1..found.len() - 1];
    assert!(found.len() >= 6, "{found:?}");
    assert!(inner.windows(2).all(|pair| pair[0].foot != pair[1].foot), "{found:?}");
    assert!(inner.iter().all(|contact| (0.3..0.95).contains(&(contact.end - contact.start))), "{found:?}");
    assert!(foot_slide(&take, &feet, &points, &found).mean < 0.25);
}

#[needs_data]
#[test]
fn every_capture_is_recognised_as_human() {
    for (name, reference) in
        [("cmu_01_01_jumps.bvh", Some(Reference::Stated)), ("cmu_02_03_run_iclone.bvh", None)]
    {
        let found = actor(name);
        assert!(found.analysis.humanoid, "{name}: {:?}", found.analysis.notes);
        assert!(
            reference.is_none_or(|expected| found.reference == expected),
            "{name}: {:?}",
            found.reference
        );
        assert!(Legs::of(&found.rig, &found.analysis).is_some(), "{name}");
    }
}

#[needs_data]
#[test]
fn walk_fits_every_body() {
    let (walk, man, mannequin) = (actor(WALK), character("CesiumMan.glb"), character("mannequiny.glb"));
    let child = scaled(&mannequin.0, &mannequin.1, 0.8 / mannequin.1.height);
    let giant = scaled(&mannequin.0, &mannequin.1, 14.0 / mannequin.1.height);
    assert!((giant.1.height - 14.0).abs() < 0.01 && (child.1.height - 0.8).abs() < 0.001);
    for (name, (rig, analysis)) in
        [("CesiumMan", &man), ("mannequiny", &mannequin), ("child", &child), ("giant", &giant)]
    {
        let options = RetargetOptions { pace: Pace::Froude, ..RetargetOptions::default() };
        let found = onto(&walk, rig, analysis, &options);
        let slide = found.feet.slide.map(|slide| 100.0 * slide.mean / analysis.height);
        println!(
            "{name}: legs × {:.2}, slide {:.2} → {:.3} cm/s per m, farthest {:.1} mm, shifted {:.1} cm, lowered {:.1} cm, \
             miss {:.2} mm, {} contacts",
            found.scale,
            slide[0],
            slide[1],
            1e3 * found.feet.slide[1].farthest,
            1e2 * found.feet.shifted,
            1e2 * found.feet.lowered,
            1e3 * found.feet.miss,
            found.contacts.len()
        );
        assert!(slide[1] < 1.0, "{name}: feet slide at {slide:?} cm/s per metre of height");
        assert!(found.feet.miss < 0.002 * analysis.height, "{name}: {}", found.feet.miss);
        assert!(found.feet.shifted < 0.06 * analysis.height, "{name}: {}", found.feet.shifted);
        assert!((f64::from(found.pace) - f64::from(found.scale).sqrt()).abs() < 1e-5);
        assert!(
            found.take.poses.iter().all(|local| local.rotation.is_finite() && local.translation.is_finite())
        );
        // The same is true for contacts that are detected independently in the new motion.
        let legs = Legs::of(rig, analysis).unwrap();
        let points = sole_points(rig, &analysis.character_from_file(), &legs.feet, &found.take);
        let settings = ContactSettings::for_leg(legs.feet[0].length);
        let seen = contacts(&found.take, &legs.feet, &points, analysis.floor, &settings);
        let own = foot_slide(&found.take, &legs.feet, &points, &seen);
        let own = 100.0 * own.mean / analysis.height;
        println!("{name}: {own:.2} cm/s per m in {} contacts of its own", seen.len());
        assert!(
            own < 1.0 && seen.len() == found.contacts.len(),
            "{name}: feet slide at {own} cm/s per metre of height"
        );
        // Soles are on or above the floor, and one of them is always near it.
        let heights: Vec<f32> =
            points.iter().map(|frame| (lowest(frame) - analysis.floor) / analysis.height).collect();
        assert!(heights.iter().all(|&h| h > -1e-3 && h < 0.02), "{name}: {heights:?}");
    }
}

/// Every humanoid of the data can perform the walk, including rigs with feet outside the leg hierarchy.
#[needs_data]
#[test]
fn every_humanoid_walks() {
    let walk = actor(WALK);
    for name in [
        "RiggedFigure.glb",
        "kaykit_Knight.glb",
        "mesh2motion_human_rigify.glb",
        "quaternius_cyberpunk_Character.glb",
        "CoolLoops_mixamorig_vrm0.vrm",
    ] {
        let (rig, analysis) = character(name);
        let found = onto(&walk, &rig, &analysis, &RetargetOptions::default());
        let slide = 100.0 * found.feet.slide[1].mean / analysis.height;
        println!(
            "{name}: legs × {:.2}, slide {slide:.3} cm/s per m, miss {:.4} m",
            found.scale, found.feet.miss
        );
        assert!(slide < 1.0, "{name}: feet slide at {slide} cm/s per metre of height");
        // Bones keep their lengths in any hierarchy.
        let (mut model, place) = (Vec::new(), |role: Role| analysis.joint_with(role).unwrap());
        let length = |model: &[Affine], side: Side| {
            let at = |role: Role| model[place(role)].translation;
            [
                (at(Role::LowerLeg(side)) - at(Role::UpperLeg(side))).length(),
                (at(Role::Foot(side)) - at(Role::LowerLeg(side))).length(),
                (at(Role::UpperLeg(side)) - at(Role::Hips)).length(),
            ]
        };
        for frame in (0..found.take.frames()).step_by(7) {
            local_to_model(&rig, found.take.pose(frame), &Affine::IDENTITY, &mut model);
            for side in [Side::Left, Side::Right] {
                for (now, bind) in length(&model, side).into_iter().zip(length(&analysis.bind_model, side)) {
                    assert!(
                        (now / bind - 1.0).abs() < 0.02,
                        "{name}, frame {frame}, {side:?}: length {now}, in the bind pose {bind}"
                    );
                }
            }
        }
    }
}

/// The walk with joint names of other conventions, without every second name, and without names: the result is the
/// same.
#[needs_data]
#[test]
fn walk_is_the_same_for_other_joint_names() {
    let (walk, (rig, analysis)) = (actor(WALK), character("mannequiny.glb"));
    let parts = [
        ("UpLeg", "UpperLeg"),
        ("ForeArm", "LowerArm"),
        ("ToeBase", "Toes"),
        ("Leg", "LowerLeg"),
        ("Arm", "UpperArm"),
        ("Shoulder", "Clavicle"),
    ];
    let dialect = |name: &str| {
        for (side, letter) in [("Left", "L"), ("Right", "R")] {
            if let Some(part) = name.strip_prefix(side) {
                let known = parts.iter().find(|(own, _)| *own == part).map_or(part, |(_, other)| other);
                return format!("{known}_{letter}");
            }
        }
        name.to_owned()
    };
    assert_eq!(dialect("LeftUpLeg"), "UpperLeg_L");
    type Naming<'a> = &'a dyn Fn(usize, &str) -> String;
    let namings: [(&str, Naming<'_>); 4] = [
        ("UpperLeg_L", &|_, name| dialect(name)),
        ("every second", &|i, name| if i % 2 == 0 { name.to_owned() } else { String::new() }),
        ("the others", &|i, name| if i % 2 == 1 { name.to_owned() } else { format!("joint{i}") }),
        ("none", &|i, _| format!("joint{i}")),
    ];
    for (what, name) in namings {
        let mut other = walk.rig.clone();
        other.joints.iter_mut().enumerate().for_each(|(i, joint)| joint.name = name(i, &joint.name));
        let (found, reference) = stand(&other, &walk.clip, None).expect("bones");
        for role in [
            Role::Hips,
            Role::UpperLeg(Side::Left),
            Role::LowerLeg(Side::Right),
            Role::Foot(Side::Left),
            Role::UpperArm(Side::Right),
            Role::LowerArm(Side::Left),
        ] {
            assert_eq!(found.joint_with(role), walk.analysis.joint_with(role), "{what}: {role:?}");
        }
        // Without names, a finger may serve as the hand and the crown as the head.
        for role in [Role::Hand(Side::Right), Role::Head] {
            let [told, own] = [&found, &walk.analysis].map(|of| of.joint_with(role).expect("a human's"));
            let mut up = std::iter::successors(Some(told), |&joint| walk.rig.joints[joint].parent);
            assert!(up.any(|joint| joint == own), "{what}: joint {told} for {own}, role {role:?}");
        }
        let named = Actor { rig: other, clip: walk.clip.clone(), analysis: found, reference };
        let moved = onto(&named, &rig, &analysis, &RetargetOptions::default());
        let slide = 100.0 * moved.feet.slide[1].mean / analysis.height;
        assert!(
            slide < 1.0 && moved.contacts.len() >= 6,
            "{what}: feet slide at {slide} cm/s per metre of height"
        );
    }
}

/// Returns the largest height of the lowest point of both soles above its minimum, metres.
fn in_the_air(rig: &Rig, analysis: &RigAnalysis, take: &Take) -> f32 {
    let legs = Legs::of(rig, analysis).unwrap();
    let mut model = Vec::new();
    let mut heights = Vec::new();
    for frame in 0..take.frames() {
        local_to_model(rig, take.pose(frame), &analysis.character_from_file(), &mut model);
        let soles = legs.feet.iter().flat_map(|foot| foot.points(&model)).map(|point| point.y);
        heights.push(soles.fold(f32::INFINITY, f32::min));
    }
    heights.iter().copied().fold(0.0, f32::max) - heights.iter().copied().fold(f32::INFINITY, f32::min)
}

/// Hops, a run whose skeleton has no natural rest pose, and a run and get-up in DeepMimic format can be retargeted.
#[needs_data]
#[test]
fn every_capture_moves_a_character() {
    let (rig, analysis) = character("mannequiny.glb");
    let files = ["cmu_01_01_jumps.bvh", "cmu_02_03_run_iclone.bvh", "mixed_rotation_orders.bvh"];
    let [hops, run, mixed] = files.map(actor);
    let imitated = ["deepmimic_run.txt", "deepmimic_getup_faceup.txt"].map(imitation);
    let all = [
        ("hops", &hops),
        ("run", &run),
        ("mixed", &mixed),
        ("imitated run", &imitated[0]),
        ("get-up", &imitated[1]),
    ];
    for (name, actor) in all {
        let found = onto(actor, &rig, &analysis, &RetargetOptions::default());
        let slide = 100.0 * found.feet.slide[1].mean / analysis.height;
        println!(
            "{name}: {:?}, legs × {:.2}, {} contacts, slide {slide:.3} cm/s per m, lowered {:.1} cm, unmatched {:?}",
            actor.reference,
            found.scale,
            found.contacts.len(),
            100.0 * found.feet.lowered,
            found.unmatched
        );
        assert!(
            slide < 1.0 && found.take.poses.iter().all(|local| local.rotation.is_finite()),
            "{name}: {slide}"
        );
        if name == "hops" {
            let [jumped, hopped] = [
                in_the_air(&actor.rig, &actor.analysis, &Take::of(&actor.rig, &actor.clip, 1.0 / 60.0)),
                in_the_air(&rig, &analysis, &found.take),
            ];
            assert!(jumped > 0.1, "{jumped} m");
            assert!(
                (hopped / (jumped * found.scale) - 1.0).abs() < 0.3,
                "jump height {hopped} m on the target, {jumped} m in the source"
            );
        }
        // Relative to the hips, the head is in the direction of the actor's head.
        let source = Take::of(&actor.rig, &actor.clip, 1.0 / 60.0);
        let off = bone_error(actor, &source, &rig, &analysis, &found.take, [Role::Hips, Role::Head]);
        assert!(off < 30.0, "{name}: {off}°");
    }
}

/// The walk without root motion: the moving ground is detected, and feet stand as long as before.
#[needs_data]
#[test]
fn walk_in_place_is_recognised_as_a_walk() {
    let (walk, (rig, analysis)) = (actor(WALK), character("mannequiny.glb"));
    let mut on_the_spot = Actor { clip: walk.clip.clone(), rig: walk.rig.clone(), ..walk };
    let shifts = on_the_spot.clip.channels.iter_mut().find(|c| c.property == Property::Translation).unwrap();
    let last = shifts.times.len() - 1;
    let place = |values: &[f32], key: usize| Vec3::from_slice(&values[3 * key..]);
    let way = place(&shifts.values, last) - place(&shifts.values, 0);
    let speed = Vec3::new(way.x, 0.0, way.z) / shifts.times[last];
    for (key, &time) in shifts.times.iter().enumerate() {
        let at = place(&shifts.values, key) - speed * time;
        shifts.values[3 * key..3 * key + 3].copy_from_slice(&at.to_array());
    }
    let walk = actor(WALK);
    let far = onto(&walk, &rig, &analysis, &RetargetOptions::default());
    let near = onto(&on_the_spot, &rig, &analysis, &RetargetOptions::default());
    assert_eq!(far.ground.velocity, Vec3::ZERO);
    let off = (near.ground.velocity + speed * near.scale).length();
    assert!(off < 0.1 * speed.length() * near.scale, "{} for {}", near.ground.velocity, speed * near.scale);
    assert_eq!(far.contacts.len(), near.contacts.len());
    for (a, b) in far.contacts.iter().zip(&near.contacts) {
        assert!(
            a.foot == b.foot && (a.start - b.start).abs() < 0.06 && (a.end - b.end).abs() < 0.06,
            "{a:?} {b:?}"
        );
    }
    assert!(100.0 * near.feet.slide[1].mean < analysis.height);
}

/// Clips made for one character move another; a file of clips without a skin does, too.
#[needs_data]
#[test]
fn authored_clips_move_other_characters() {
    let (man, man_analysis) = character("CesiumMan.glb");
    let to = Body { rig: &man, analysis: &man_analysis };
    for name in ["mannequiny.glb", "kaykit_mannequin/Med_Simulation.glb"] {
        let (rig, clips) = crate::rigs::load(&format!("rigs/{name}"));
        for clip in &clips {
            let analysis =
                sinew_anim::analyze(&rig).or_else(|_| stand(&rig, clip, None).map(|found| found.0)).unwrap();
            assert!(analysis.humanoid, "{name}, {}: {:?}", clip.name, analysis.notes);
            let found =
                retarget(Body { rig: &rig, analysis: &analysis }, clip, to, &RetargetOptions::default())
                    .unwrap();
            let slide = 100.0 * found.feet.slide[1].mean / man_analysis.height;
            println!(
                "{name}, {}: {} contacts, slide {slide:.3} cm/s per m, ground {}",
                clip.name,
                found.contacts.len(),
                found.ground.velocity
            );
            assert!(
                slide < 1.0 && found.take.poses.iter().all(|local| local.rotation.is_finite()),
                "{name}, {}",
                clip.name
            );
        }
    }
}

/// Bones that ground contact does not correct point in the actor's directions.
#[needs_data]
#[test]
fn bones_point_in_the_actors_directions() {
    let (walk, man, mannequin) = (actor(WALK), character("CesiumMan.glb"), character("mannequiny.glb"));
    let source = Take::of(&walk.rig, &walk.clip, 1.0 / 60.0);
    for (rig, analysis) in [&man, &mannequin] {
        let free = RetargetOptions { feet: Feet::Free, ..RetargetOptions::default() };
        let found = onto(&walk, rig, analysis, &free);
        for side in [Side::Left, Side::Right] {
            use Role::{Foot, Hand, LowerArm, LowerLeg, UpperArm, UpperLeg};
            for bone in [
                [UpperLeg(side), LowerLeg(side)],
                [LowerLeg(side), Foot(side)],
                [UpperArm(side), LowerArm(side)],
                [LowerArm(side), Hand(side)],
            ] {
                let off = bone_error(&walk, &source, rig, analysis, &found.take, bone);
                assert!(off < 0.2, "{bone:?}: {off}°");
            }
        }
    }
}

/// Knees and elbows bend forward for any joint axes of a rig.
#[needs_data]
#[test]
fn knees_bend_forward() {
    let (walk, man, mannequin) = (actor(WALK), character("CesiumMan.glb"), character("mannequiny.glb"));
    for (rig, analysis) in [&man, &mannequin] {
        let found = onto(&walk, rig, analysis, &RetargetOptions::default());
        let joint = |role: Role| analysis.joint_with(role).unwrap();
        let mut model = Vec::new();
        for frame in 0..found.take.frames() {
            local_to_model(rig, found.take.pose(frame), &analysis.character_from_file(), &mut model);
            let place = |role: Role| model[joint(role)].translation;
            let left = place(Role::UpperLeg(Side::Left)) - place(Role::UpperLeg(Side::Right));
            let forward = direction(left.cross(Vec3::Y)).unwrap();
            for side in [Side::Left, Side::Right] {
                let (hip, knee, ankle) =
                    (place(Role::UpperLeg(side)), place(Role::LowerLeg(side)), place(Role::Foot(side)));
                let bulge = (knee - (hip + ankle) * 0.5).dot(forward);
                assert!(
                    bulge > -0.03 * analysis.height,
                    "frame {frame}, {side:?}: the knee is {bulge} m before the line from hip to ankle"
                );
            }
        }
    }
}

/// Foot contact causes no jerk: the largest change of a leg joint's speed between frames stays near that with free
/// feet.
#[needs_data]
#[test]
fn foot_contact_does_not_pop() {
    let (walk, (rig, analysis)) = (actor(WALK), character("mannequiny.glb"));
    let jerk = |feet: Feet| {
        let found = onto(&walk, &rig, &analysis, &RetargetOptions { feet, ..RetargetOptions::default() });
        let legs = Legs::of(&rig, &analysis)
            .unwrap()
            .feet
            .map(|foot| [foot.leg.upper, foot.leg.lower, foot.leg.end]);
        let of_joint = |&joint: &usize| {
            let turns: Vec<_> = found.take.of_joint(joint).map(|local| local.rotation).collect();
            let step = |three: &[sinew_math::Rotation]| {
                let speed = |k: usize| three[k].angular_velocity_to(three[k + 1], 1.0);
                (speed(1) - speed(0)).length().to_degrees()
            };
            turns.windows(3).map(step).fold(0.0, sinew_math::max)
        };
        legs.as_flattened().iter().map(of_joint).fold(0.0, sinew_math::max)
    };
    let (free, held) = (jerk(Feet::Free), jerk(Feet::Locked));
    println!("largest change of a leg joint's step: {free:.2}° free, {held:.2}° held");
    assert!(
        held < 1.5 * free + 1.0,
        "largest change of a leg joint's step: {held}° with locked feet, {free}° with free feet"
    );
}

#[needs_data]
#[test]
fn retargeting_to_the_same_body_changes_nothing() {
    let walk = actor(WALK);
    let free = RetargetOptions { feet: Feet::Free, ..RetargetOptions::default() };
    let found = onto(&walk, &walk.rig, &walk.analysis, &free);
    assert!((found.scale - 1.0).abs() < 1e-6 && found.unmatched.is_empty());
    let source = Take::of(&walk.rig, &walk.clip, 1.0 / 60.0);
    for &(role, joint, same) in &found.pairs {
        assert_eq!(joint, same);
        let worst = source
            .of_joint(joint)
            .zip(found.take.of_joint(joint))
            .map(|(a, b)| a.rotation.angle_to(b.rotation));
        // A joint above one without a role also applies that joint's rotation.
        let above = walk.rig.joints[joint].parent;
        if above.is_none_or(|above| found.pairs.iter().any(|pair| pair.1 == above)) {
            let worst = worst.fold(0.0, sinew_math::max);
            assert!(worst < 2e-3, "{role:?}: {worst}");
        }
    }
}

#[needs_data]
#[test]
fn clip_and_take_are_the_same_motion() {
    let (walk, (rig, analysis)) = (actor(WALK), character("mannequiny.glb"));
    let found = onto(
        &walk,
        &rig,
        &analysis,
        &RetargetOptions { pace: Pace::Times(2.0), ..RetargetOptions::default() },
    );
    assert!((f64::from(walk.clip.duration) * 2.0 - found.take.duration()).abs() < 0.02);
    let clip: Clip = found.clip(&rig, "walk");
    let again = Take::of(&rig, &clip, found.take.frame_time);
    assert_eq!(again.frames(), found.take.frames());
    let off = |(a, b): (&sinew_anim::LocalTransform, &sinew_anim::LocalTransform)| {
        sinew_math::max(a.rotation.angle_to(b.rotation), (a.translation - b.translation).length())
    };
    assert!(again.poses.iter().zip(&found.take.poses).map(off).fold(0.0, sinew_math::max) < 2e-3);
    let first: &FootContact = &found.contacts[0];
    assert!(first.start >= 0.0 && first.end > first.start);
}

#[needs_data]
#[test]
fn rig_without_roles_is_rejected() {
    let (walk, (rig, analysis)) = (actor(WALK), character("Fox.glb"));
    let body = Body { rig: &walk.rig, analysis: &walk.analysis };
    let fox = Body { rig: &rig, analysis: &analysis };
    let refused = |a, b, options| retarget(a, &walk.clip, b, &options).unwrap_err();
    let plain = RetargetOptions::default();
    assert_eq!(refused(body, fox, plain), RetargetError::NotHumanoid("character"));
    assert_eq!(refused(fox, body, plain), RetargetError::NotHumanoid("actor"));
    let still = RetargetOptions { pace: Pace::Times(0.0), ..plain };
    assert_eq!(refused(body, body, still).to_string(), "the pace must be above 0 and finite");
    let frozen = RetargetOptions { frame_time: f64::NAN, ..plain };
    assert_eq!(refused(body, body, frozen).to_string(), "the frame time must be above 0 and finite");
}

/// Changes random bytes of files: a readable file can be analysed and retargeted, or gives an error.
#[needs_data]
#[test]
fn corrupted_captures_give_results_or_errors() {
    let whole = crate::rigs::bytes("mocap/cmu_12_01_walk.bvh");
    let (rig, analysis) = character("mannequiny.glb");
    // The skeleton and forty rows of motion.
    let rows: Vec<&[u8]> = whole.split_inclusive(|&byte| byte == b'\n').take(227).collect();
    let whole = rows.concat();
    let options = BvhOptions { rows: BvhRows::AsPresent, ..BvhOptions::default() };
    let cases = if std::env::var_os("SINEW_FULL").is_some() { 2000 } else { 150 };
    let (mut random, mut carried) = (Random::new(31), 0);
    for _ in 0..cases {
        let mut bytes = whole.clone();
        for _ in 0..=random.index(12) {
            // Half of the changes are in the skeleton.
            let within = [5000, bytes.len()][random.index(2)];
            let at = random.index(within);
            bytes[at] = *b"0123456789eE.- {}X\n".get(random.index(40)).unwrap_or(&bytes[at]);
        }
        let Ok(document) = read_bvh(&bytes, options) else { continue };
        let Ok((found, _)) = stand(&document.rig, &document.clip, document.rest_pose.as_deref()) else {
            continue;
        };
        let actor = Body { rig: &document.rig, analysis: &found };
        let plain = RetargetOptions::default();
        carried += usize::from(
            retarget(actor, &document.clip, Body { rig: &rig, analysis: &analysis }, &plain).is_ok(),
        );
    }
    println!("{carried} of {cases} carried over");
    assert!(carried > cases / 10);
    let endless = Clip { duration: 1e12, ..Clip::default() };
    let body = Body { rig: &rig, analysis: &analysis };
    let refused = retarget(body, &endless, body, &RetargetOptions::default()).unwrap_err();
    assert!(matches!(refused, RetargetError::TooLong(_)), "{refused}");
}

/// Slide of two synthetic feet: one stands, and the other is dragged at 0.3 m/s for a second.
#[needs_data]
#[test]
fn slide_of_synthetic_feet_is_measured_correctly() {
    let walk = actor(WALK);
    let feet = Legs::of(&walk.rig, &walk.analysis).unwrap().feet;
    let take = Take { frame_time: 0.1, joints: 1, poses: vec![sinew_anim::LocalTransform::default(); 21] };
    let point = |frame: usize| {
        let dragged = Vec3::new(0.6 * 0.05 * frame as f32, 0.0, 0.8 * -0.0375 * frame as f32);
        [[Vec3::ZERO; 2], [dragged, dragged]]
    };
    let points: Vec<_> = (0..21).map(point).collect();
    let stood = |foot: Side, start: f32, end: f32| FootContact { foot, start, end };
    let left = foot_slide(&take, &feet, &points, &[stood(Side::Left, 0.0, 2.0)]);
    assert_eq!((left.mean, left.farthest), (0.0, 0.0));
    let speed = (0.3_f32 * 0.3 + 0.3 * 0.3).sqrt();
    let right = foot_slide(&take, &feet, &points, &[stood(Side::Right, 0.5, 1.5)]);
    assert!(
        (right.mean - speed).abs() < 1e-4
            && (right.farthest - speed).abs() < 1e-4
            && (right.time - 1.0).abs() < 1e-6
    );
    let both =
        foot_slide(&take, &feet, &points, &[stood(Side::Left, 0.5, 1.5), stood(Side::Right, 0.5, 1.5)]);
    assert!((both.mean - 0.5 * speed).abs() < 1e-4);
    assert_eq!(foot_slide(&take, &feet, &points, &[]).mean, 0.0);
}
