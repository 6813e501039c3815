//! Compares inverse kinematics with closed forms.

use crate::toy;
use sinew_anim::ik::{
    FootGround, FootPlacement, LookAt, Pole, TwoBone, TwoBoneGoal, look_at, place_feet, solve_two_bone,
    two_bone_ik,
};
use sinew_anim::{LocalTransform, Rig, Role, local_to_model, rest_pose};
use sinew_math::{Affine, Random, Rotation, Vec3};

const LIMB: TwoBone = TwoBone { upper: 0, lower: 1, end: 2 };

fn model(rig: &Rig, local: &[LocalTransform]) -> Vec<Affine> {
    let mut out = Vec::new();
    local_to_model(rig, local, &Affine::IDENTITY, &mut out);
    out
}

/// Returns the positions of middle joint and end of a limb after the solution.
fn bent(root: Vec3, middle: Vec3, end: Vec3, goal: &TwoBoneGoal) -> [Vec3; 2] {
    let found = solve_two_bone(root, middle, end, goal);
    let knee = root + found.upper * (middle - root) * found.stretch;
    [knee, knee + found.lower * (end - middle) * found.stretch]
}

#[test]
fn target_within_reach_is_reached() {
    let mut random = Random::new(1);
    for case in 0..20_000 {
        let [root, middle, end] = [random.in_cube(), random.in_cube(), random.in_cube()];
        let (a, b) = ((middle - root).length(), (end - middle).length());
        let target = root + random.direction() * random.range((a - b).abs(), a + b);
        let pole = if case % 2 == 0 { Pole::Keep(random.in_cube()) } else { Pole::Toward(random.in_cube()) };
        let [knee, tip] = bent(root, middle, end, &TwoBoneGoal::at(target, pole));
        let off = (tip - target).length();
        assert!(off < 3e-6 * (1.0 + a + b), "case {case}: {off}");
        assert!(((knee - root).length() - a).abs() < 1e-5 && ((tip - knee).length() - b).abs() < 1e-5);
    }
}

#[test]
fn middle_joint_bends_toward_the_pole() {
    let mut random = Random::new(2);
    for _ in 0..5000 {
        let [root, middle, end, pole] =
            [random.in_cube(), random.in_cube(), random.in_cube(), random.direction()];
        let full = (middle - root).length() + (end - middle).length();
        let way = random.direction();
        let across = pole - way * pole.dot(way);
        if across.length() < 0.1 {
            continue;
        }
        let target = root + way * (0.8 * full);
        let [knee, _] = bent(root, middle, end, &TwoBoneGoal::at(target, Pole::Toward(pole)));
        let side = knee - root - way * (knee - root).dot(way);
        assert!(
            side.length() < 1e-4 || side.dot(across) > 0.999 * side.length() * across.length(),
            "{side} {across}"
        );
    }
}

#[test]
fn limb_already_at_its_target_does_not_turn() {
    let mut random = Random::new(3);
    for _ in 0..2000 {
        let [root, middle, end] = [random.in_cube(), random.in_cube(), random.in_cube()];
        // A limb that is bent by less than five degrees may be turned by the pole.
        if (middle - root).cross(end - root).length() < 0.1 * (middle - root).length() * (end - root).length()
        {
            continue;
        }
        let found = solve_two_bone(root, middle, end, &TwoBoneGoal::at(end, Pole::Keep(Vec3::Z)));
        let turned = found.upper.angle_to(Rotation::IDENTITY) + found.lower.angle_to(Rotation::IDENTITY);
        assert!(turned < 5e-3 && found.miss < 1e-5, "{turned}");
    }
}

#[test]
fn limb_points_at_a_target_out_of_reach() {
    let (root, middle, end) = (Vec3::ZERO, Vec3::new(0.1, -0.5, 0.0), Vec3::new(0.0, -0.9, 0.0));
    let full = middle.length() + (end - middle).length();
    let far = TwoBoneGoal::at(Vec3::new(3.0, 0.0, 4.0), Pole::Keep(Vec3::Z));
    let [_, tip] = bent(root, middle, end, &far);
    assert!((tip - Vec3::new(0.6, 0.0, 0.8) * full).length() < 1e-5);
    assert!((solve_two_bone(root, middle, end, &far).miss - (5.0 - full)).abs() < 1e-5);
    // The limb is stretched by the allowed factor, or as far as needed.
    let [_, tip] = bent(root, middle, end, &TwoBoneGoal { stretch: 1.5, ..far });
    assert!((tip.length() - 1.5 * full).abs() < 1e-5);
    let [_, tip] = bent(root, middle, end, &TwoBoneGoal { stretch: 9.0, ..far });
    assert!((tip - far.target).length() < 1e-4);
}

/// With softness, the limb's reach and its rate of change are continuous, and the reach stays below the full length.
#[test]
fn soft_limb_straightens_smoothly() {
    let (root, middle, end) = (Vec3::ZERO, Vec3::new(0.2, -0.5, 0.0), Vec3::new(0.0, -1.0, 0.0));
    let full = 2.0 * middle.length();
    let reach = |far: f32| {
        let goal = TwoBoneGoal { softness: 0.1, ..TwoBoneGoal::at(Vec3::X * far, Pole::Keep(Vec3::Z)) };
        bent(root, middle, end, &goal)[1].length()
    };
    let steps: Vec<f32> = (60..160).map(|i| reach(full * i as f32 / 100.0)).collect();
    assert!(steps.iter().all(|&r| r < full));
    assert!((steps[20] - 0.8 * full).abs() < 1e-5);
    for three in steps.windows(3) {
        assert!(
            three[1] > three[0] && (three[2] - 2.0 * three[1] + three[0]).abs() < 2e-3 * full,
            "{three:?}"
        );
    }
}

#[test]
fn degenerate_input_gives_finite_rotations() {
    let places = [Vec3::ZERO, Vec3::X, Vec3::X * 2.0, -Vec3::X, Vec3::splat(1e-20), Vec3::splat(1e18)];
    let mut cases = 0;
    for root in places {
        for middle in places {
            for end in places {
                for target in places.into_iter().chain([Vec3::splat(f32::NAN), Vec3::splat(f32::INFINITY)]) {
                    for pole in
                        [Pole::Keep(Vec3::ZERO), Pole::Toward(Vec3::X), Pole::Toward(Vec3::splat(f32::NAN))]
                    {
                        let goal =
                            TwoBoneGoal { softness: 0.2, stretch: 1.2, ..TwoBoneGoal::at(target, pole) };
                        let found = solve_two_bone(root, middle, end, &goal);
                        assert!(
                            found.upper.is_finite() && found.lower.is_finite() && found.stretch.is_finite()
                        );
                        assert!(
                            (found.upper.length() - 1.0).abs() < 1e-4,
                            "root {root}, middle {middle}, end {end}, target {target}"
                        );
                        cases += 1;
                    }
                }
            }
        }
    }
    assert_eq!(cases, 6 * 6 * 6 * 8 * 3);
}

#[test]
fn solver_updates_local_and_model_poses_consistently() {
    let mut random = Random::new(4);
    for _ in 0..200 {
        let rig = toy::chain(5, Vec3::new(0.0, 0.4, 0.1));
        let mut local: Vec<LocalTransform> = toy::random_pose(&mut random, 5);
        local.iter_mut().for_each(|joint| joint.scale = Vec3::ONE);
        let mut after = model(&rig, &local);
        let limb = TwoBone { upper: 1, lower: 2, end: 4 };
        let place = |joint: usize, model: &[Affine]| model[joint].translation;
        let (a, b) =
            ((place(2, &after) - place(1, &after)).length(), (place(4, &after) - place(2, &after)).length());
        let target = place(1, &after) + random.direction() * random.range((a - b).abs() + 0.01, a + b);
        two_bone_ik(&rig, limb, &TwoBoneGoal::at(target, Pole::Keep(Vec3::X)), &mut local, &mut after);
        assert!((place(4, &after) - target).length() < 1e-5 * (1.0 + a + b));
        for (x, y) in model(&rig, &local).iter().zip(&after) {
            assert!((x.translation - y.translation).length() < 1e-5);
        }
        // The target is already reached, so a partial weight changes nothing.
        let before = local.clone();
        let half = TwoBoneGoal { weight: 0.5, ..TwoBoneGoal::at(target, Pole::Keep(Vec3::X)) };
        two_bone_ik(&rig, limb, &half, &mut local, &mut after);
        assert!(before.iter().zip(&local).all(|(x, y)| x.rotation.angle_to(y.rotation) < 5e-3));
        let none = TwoBoneGoal { weight: 0.0, ..half };
        let before = local.clone();
        two_bone_ik(&rig, limb, &none, &mut local, &mut after);
        assert_eq!(before, local);
    }
}

#[test]
fn gaze_is_limited_to_its_largest_angle() {
    let rig = toy::chain(3, Vec3::Y);
    let with = |target: Vec3, max_yaw: f32, max_pitch: f32| {
        let mut local = rest_pose(&rig);
        let mut after = model(&rig, &local);
        let look =
            LookAt { joint: 2, forward: Vec3::Z, up: Vec3::Y, target, max_yaw, max_pitch, weight: 1.0 };
        let found = look_at(&rig, &look, &mut local, &mut after);
        (after[2].vector(Vec3::Z), found)
    };
    let eye = Vec3::Y * 3.0;
    let (gaze, found) = with(eye + Vec3::new(3.0, 1.0, 4.0), 3.0, 3.0);
    assert!((gaze - Vec3::new(3.0, 1.0, 4.0) / 26.0_f32.sqrt()).length() < 1e-6 && found.left < 1e-3);
    // The target is a quarter turn to the left, of which a third is allowed.
    let (gaze, found) = with(eye + Vec3::X, core::f32::consts::FRAC_PI_6, 1.0);
    assert!((gaze - Vec3::new(0.5, 0.0, 0.75_f32.sqrt())).length() < 1e-5);
    assert!((found.left - core::f32::consts::FRAC_PI_3).abs() < 1e-3);
    let (gaze, _) = with(eye + Vec3::Y, 1.0, 0.4);
    assert!((gaze.y - sinew_math::trig::sin(0.4)).abs() < 1e-5);
    for target in [eye, Vec3::splat(f32::NAN)] {
        let (gaze, found) = with(target, 1.0, 1.0);
        assert_eq!((gaze, found.turned), (Vec3::Z, 0.0));
    }
}

/// On a ramp and on a step, both ankles keep the height above the ground that they had above the floor.
#[test]
fn feet_are_placed_on_uneven_ground() {
    let rig = toy::body(Role::name);
    let joint = |name: &str| rig.joints.iter().position(|joint| joint.name == name).unwrap();
    let leg = |side: &str| TwoBone {
        upper: joint(&format!("{side}UpperLeg")),
        lower: joint(&format!("{side}LowerLeg")),
        end: joint(&format!("{side}Foot")),
    };
    let legs = [leg("left"), leg("right")];
    let settings = FootPlacement {
        up: Vec3::Y,
        forward: Vec3::Z,
        floor: 0.0,
        ankle_height: 0.1,
        free_height: 0.1,
        max_step: 0.4,
        max_tilt: 0.5,
    };
    let stair = |p: Vec3| Some(FootGround { height: if p.x > 0.0 { 0.2 } else { 0.0 }, normal: Vec3::Y });
    let slope = 0.3;
    let normal = Vec3::new(-slope, 1.0, 0.0) / (1.0 + slope * slope).sqrt();
    let ramp = move |p: Vec3| Some(FootGround { height: slope * p.x, normal });
    let place = |ground: &dyn Fn(Vec3) -> Option<FootGround>| {
        let mut local = rest_pose(&rig);
        let mut after = model(&rig, &local);
        let placed = place_feet(&rig, joint("hips"), &legs, &settings, ground, &mut local, &mut after);
        (placed, after)
    };
    let (placed, after) = place(&stair);
    assert!((after[legs[0].end].translation - Vec3::new(0.1, 0.3, 0.0)).length() < 1e-3, "{placed:?}");
    assert!((after[legs[1].end].translation - Vec3::new(-0.1, 0.1, 0.0)).length() < 1e-3, "{placed:?}");
    // The bent knee moves forward, and the pelvis keeps its height.
    assert!(after[legs[0].lower].translation.z > 0.1 && placed.pelvis.abs() < 1e-2, "{placed:?}");
    let (placed, after) = place(&ramp);
    for (leg, foot) in legs.iter().zip(placed.feet) {
        let ankle = after[leg.end].translation;
        let away = (ankle - Vec3::Y * slope * ankle.x).dot(Vec3::Y) * normal.y;
        assert!((away - 0.1).abs() < 2e-3, "{away}");
        assert!((foot.tilted - sinew_math::trig::atan2(slope, 1.0)).abs() < 1e-3);
        assert!((after[leg.end].vector(Vec3::Y) - normal).length() < 1e-3);
    }
    assert!(placed.pelvis < -0.01);
    let (placed, _) = place(&|_| None);
    assert_eq!(placed, sinew_anim::ik::PlacedFeet::default());
}

#[test]
fn limb_within_a_chain_is_solved() {
    let rig = toy::chain(3, Vec3::Y);
    let mut local = rest_pose(&rig);
    let mut after = model(&rig, &local);
    let goal = TwoBoneGoal::at(Vec3::new(1.0, 2.0, 0.0), Pole::Toward(Vec3::X));
    let found = two_bone_ik(&rig, LIMB, &goal, &mut local, &mut after);
    // Two sides of a rhombus: root at (0, 1, 0), bones of length 1, target at distance √2.
    assert!(found.miss < 1e-6 && (after[1].translation - Vec3::new(1.0, 1.0, 0.0)).length() < 1e-5);
}
