//! The quality tool on states whose faults are known.

use sinew::math::{Range, Rotation, SwingTwistLimit, Transform, Vec3};
use sinew::physics::{BodyDef, BodyKind, Filter, JointKind, Shape, ShapeDef, Sleeping};
use sinew_peers::engine::{BodyState, ParticleState};
use sinew_peers::quality::{ClothMeter, Quality, QualityMeter};
use sinew_peers::scenes::ClothScene;
use sinew_scenes::blueprint::{Blueprint, BlueprintJoint};

fn scene(bodies: Vec<BodyDef>, joints: Vec<BlueprintJoint>) -> Blueprint {
    let gravity = Vec3::new(0.0, -10.0, 0.0);
    Blueprint {
        name: "by hand",
        gravity,
        sleeping: Sleeping::Off,
        steps: 1,
        bodies,
        joints,
        apart: Vec::new(),
    }
}

fn body(kind: BodyKind, shape: Shape, position: Vec3) -> BodyDef {
    BodyDef { kind, position, shapes: vec![ShapeDef::new(shape)], ..BodyDef::default() }
}

/// Returns a cube with sides of 1 m and a mass of 1000 kg.
fn cube(position: Vec3) -> BodyDef {
    body(BodyKind::Dynamic, Shape::Box { half_extents: Vec3::splat(0.5) }, position)
}

fn floor() -> BodyDef {
    body(BodyKind::Static, Shape::Box { half_extents: Vec3::new(9.0, 1.0, 9.0) }, Vec3::NEG_Y)
}

fn joint(a: usize, b: usize, at: Vec3, kind: JointKind) -> BlueprintJoint {
    BlueprintJoint { a, b, world_from_joint: Transform::from_translation(at), kind, friction_torque: 0.0 }
}

fn start(scene: &Blueprint) -> Vec<BodyState> {
    scene.bodies.iter().map(|def| BodyState::at(def.position, def.rotation)).collect()
}

/// Returns the result of a run whose steps end in these states.
fn judge(scene: &Blueprint, steps: &[Vec<BodyState>]) -> Quality {
    let mut meter = QualityMeter::new(scene, 1);
    for states in steps {
        meter.observe(states);
    }
    meter.finish(steps.last().expect("a step"))
}

fn close(a: f32, b: f32) {
    assert!((a - b).abs() < 1e-5, "{a} is not {b}");
}

/// Returns a hook at the origin and two level links of 1 m.
fn two_links() -> Blueprint {
    let ball = JointKind::Ball { limit: None };
    let hook = BodyDef { kind: BodyKind::Static, ..BodyDef::default() };
    let links = [0.5, 1.5].map(|x| cube(Vec3::X * x));
    let [first, second] = links;
    let end = cube(Vec3::X * 2.0);
    let joints = (0..3).map(|i| joint(i, i + 1, Vec3::X * i as f32, ball)).collect();
    scene(vec![hook, first, second, end], joints)
}

#[test]
fn a_gap_is_measured_where_the_joint_is() {
    let scene = two_links();
    let whole = start(&scene);
    let mut torn = whole.clone();
    // The first link rotates by a quarter turn about its own centre: both its joints open by √½ m.
    torn[1].world_from_body.rotation = Rotation::from_axis_angle(Vec3::Y, core::f32::consts::FRAC_PI_2);
    let opening = 0.5f32.sqrt();
    let quality = judge(&scene, &[torn.clone(), whole]).joints.expect("joints");
    close(quality.gap_peak, opening);
    close(quality.gap_end_max, 0.0);
    close(quality.stretch_peak.expect("a chain"), 2.0 * opening / 2.0);
    close(quality.stretch_end.expect("a chain"), 0.0);
    close(quality.gap_per_link.expect("a chain"), opening);
    let quality = judge(&scene, &[torn]).joints.expect("joints");
    close(quality.gap_end_max, opening);
    close(quality.gap_end_mean, 2.0 * opening / 3.0);
    close(quality.stretch_end.expect("a chain"), opening);
}

#[test]
fn branching_bodies_are_not_a_chain() {
    let mut scene = two_links();
    scene.bodies.push(cube(Vec3::Y));
    scene.joints.push(joint(1, 4, Vec3::Y, JointKind::Ball { limit: None }));
    let states = start(&scene);
    let quality = judge(&scene, &[states]).joints.expect("joints");
    assert_eq!((quality.stretch_end, quality.gap_per_link), (None, None));
    assert_eq!(quality.gap_end_max, 0.0);
}

#[test]
fn overshoot_equals_the_rotation_beyond_each_limit() {
    let limit = SwingTwistLimit {
        swing_y: Range::symmetric(0.5),
        swing_z: Range::symmetric(0.5),
        twist: Range::symmetric(0.3),
    };
    let kinds =
        [JointKind::Ball { limit: Some(limit) }, JointKind::Hinge { limit: Some(Range::new(-0.2, 0.4)) }];
    let turned = |kind: JointKind, rotations: &[Rotation]| {
        let scene = scene(vec![floor(), cube(Vec3::Y)], vec![joint(0, 1, Vec3::Y, kind)]);
        let steps: Vec<_> = rotations
            .iter()
            .map(|&rotation| {
                let mut states = start(&scene);
                states[1].world_from_body.rotation = rotation;
                states
            })
            .collect();
        judge(&scene, &steps).limits.expect("limits")
    };
    let about = |axis: Vec3, angle: f32| Rotation::from_axis_angle(axis.normalize(), angle);

    let inside = turned(kinds[0], &[about(Vec3::Y, 0.49), about(Vec3::X, -0.29)]);
    assert_eq!((inside.cone.joints, inside.cone.exceeded_run, inside.twist.exceeded_run), (1, 0, 0));
    close(inside.cone.worst_run, 0.0);

    // The whole swing counts, not its components; a joint that came back counts for the run alone.
    let cone = turned(kinds[0], &[about(Vec3::new(0.0, 1.0, 1.0), 0.8), about(Vec3::Z, 0.55)]).cone;
    close(cone.worst_run, 0.3);
    close(cone.worst_end, 0.05);
    assert_eq!((cone.exceeded_run, cone.exceeded_end), (1, 0));

    let twist = turned(kinds[0], &[about(Vec3::X, -0.45)]).twist;
    close(twist.worst_end, 0.15);
    assert_eq!((twist.exceeded_run, twist.exceeded_end), (1, 1));

    let hinge = turned(kinds[1], &[about(Vec3::X, 0.65), about(Vec3::X, -0.25)]);
    close(hinge.hinge.worst_run, 0.25);
    close(hinge.hinge.worst_end, 0.05);
    assert_eq!((hinge.hinge.exceeded_run, hinge.hinge.exceeded_end, hinge.axis.exceeded_run), (1, 0, 0));

    let off_axis = turned(kinds[1], &[about(Vec3::Z, 0.2)]);
    close(off_axis.axis.worst_end, 0.2);
    assert_eq!((off_axis.axis.exceeded_end, off_axis.hinge.exceeded_end), (1, 0));
}

#[test]
fn depth_is_the_shortest_way_out() {
    let scene = scene(vec![floor(), cube(Vec3::Y * 0.5), cube(Vec3::Y * 1.5)], vec![]);
    let mut states = start(&scene);
    // The first cube is 20 mm in the floor, and the edge of the second is 50 mm in the first.
    states[1].world_from_body.translation.y = 0.48;
    states[2].world_from_body.translation.y = 0.98 + 0.5f32.sqrt() - 0.05;
    states[2].world_from_body.rotation = Rotation::from_axis_angle(Vec3::X, core::f32::consts::FRAC_PI_4);
    let quality = judge(&scene, &[states]).penetration.expect("shapes");
    close(quality.end_max, 0.05);
    close(quality.run_max, 0.05);
}

/// Parry's own `contact` returns 3 m for some of these.
#[test]
fn touching_cubes_have_no_depth() {
    for x in -8..=8 {
        let at = Vec3::new(x as f32, 0.5 - 1e-6, 0.37 * x as f32);
        let scene = scene(vec![floor(), cube(at)], vec![]);
        let quality = judge(&scene, &[start(&scene)]).penetration.expect("shapes");
        assert!(quality.end_max < 1e-5, "{} m", quality.end_max);
    }
}

#[test]
fn depth_of_capsules_and_balls_follows_their_radii() {
    let capsule = Shape::Capsule { half_height: 0.5, radius: 0.2 };
    let ball = Shape::Sphere { radius: 0.3 };
    let bodies = vec![
        body(BodyKind::Dynamic, capsule, Vec3::ZERO),
        body(BodyKind::Dynamic, ball, Vec3::new(0.46, 0.2, 0.0)),
    ];
    let scene = scene(bodies, vec![]);
    let quality = judge(&scene, &[start(&scene)]).penetration.expect("shapes");
    assert!((quality.end_max - 0.04).abs() < 1e-3, "{} m", quality.end_max);
}

#[test]
fn disabled_pairs_have_no_depth() {
    let ball = JointKind::Ball { limit: None };
    let inside = [cube(Vec3::Y * 3.0), cube(Vec3::Y * 3.2)];
    let jointed = scene(inside.to_vec(), vec![joint(0, 1, Vec3::Y * 3.0, ball)]);
    assert_eq!(judge(&jointed, &[start(&jointed)]).penetration.expect("shapes").end_max, 0.0);
    let free = scene(inside.to_vec(), vec![]);
    close(judge(&free, &[start(&free)]).penetration.expect("shapes").end_max, 0.8);
    let mut ghosts = free;
    for def in &mut ghosts.bodies {
        def.shapes[0].filter = Filter { mask: 0, ..Filter::default() };
    }
    assert_eq!(judge(&ghosts, &[start(&ghosts)]).penetration, None);
}

#[test]
fn depth_is_measured_every_nth_step() {
    let scene = scene(vec![floor(), cube(Vec3::Y * 0.5)], vec![]);
    let depths = [0.0, 0.3, 0.1, 0.2, 0.0];
    let mut meter = QualityMeter::new(&scene, 2);
    let mut states = start(&scene);
    for depth in depths {
        states[1].world_from_body.translation.y = 0.5 - depth;
        meter.observe(&states);
    }
    let quality = meter.finish(&states).penetration.expect("shapes");
    close(quality.run_max, 0.3);
    close(quality.end_max, 0.0);
    assert_eq!(quality.every, 2);
}

#[test]
fn energy_sums_motion_spin_and_height() {
    let mut def = cube(Vec3::Y * 2.0);
    def.linear_velocity = Vec3::X * 3.0;
    let scene = scene(vec![floor(), def], vec![]);
    let mut spinning = start(&scene);
    spinning[1].world_from_body.translation.y = 1.0;
    spinning[1].angular_velocity = Vec3::new(0.0, 6.0, 0.0);
    let energy = judge(&scene, &[spinning]).energy;
    // ½ m v² = 4,500 J, m g y = 20,000 J; then ½ m/6 ω² = 3,000 J and 10,000 J.
    assert!((energy.total_start - 24_500.0).abs() < 0.1);
    assert!((energy.kinetic_end - 3_000.0).abs() < 0.1);
    assert!((energy.total_end - 13_000.0).abs() < 0.1);
    assert_eq!(energy.total_peak, energy.total_start);
}

#[test]
fn bodies_below_the_floor_or_without_numbers_are_lost() {
    let scene = scene(vec![floor(), cube(Vec3::Y), cube(Vec3::Y * 2.0), cube(Vec3::Y * 3.0)], vec![]);
    let mut states = start(&scene);
    states[1].world_from_body.translation = Vec3::new(12.0, -4.0, 0.0);
    let place = judge(&scene, &[states.clone()]).place;
    assert_eq!(place.lost, 1);
    close(place.displacement_max, 13.0);
    assert!((place.mean_height - 1.0 / 3.0).abs() < 1e-6);
    states[2].world_from_body.translation.x = f32::NAN;
    let quality = judge(&scene, &[states]);
    assert_eq!(quality.place.lost, 2);
    assert!(quality.to_json()["displacement_max_m"].is_null(), "a non-finite number must become null");
}

#[test]
fn bodies_without_contacts_are_never_lost() {
    let mut hook = floor();
    hook.shapes[0].filter = Filter { mask: 0, ..Filter::default() };
    let hung = scene(vec![hook, cube(Vec3::NEG_Y * 9.0)], vec![]);
    assert_eq!(judge(&hung, &[start(&hung)]).place.lost, 0, "bodies below the hook must not count as lost");
    let mut ghost = cube(Vec3::NEG_Y * 9.0);
    ghost.shapes[0].filter = Filter { mask: 0, ..Filter::default() };
    let fallen = scene(vec![floor(), ghost], vec![]);
    assert_eq!(
        judge(&fallen, &[start(&fallen)]).place.lost,
        0,
        "bodies that do not collide must not count as lost"
    );
}

#[test]
fn a_cloth_pulled_by_a_tenth_is_stretched_by_half_of_that_on_average() {
    let scene = ClothScene::new();
    let particles: Vec<_> = (0..scene.side * scene.side)
        .map(|i| {
            let (row, column) = (i / scene.side, i % scene.side);
            let rest = scene.position(row, column);
            let position = Vec3::new(1.1 * rest.x, rest.y, rest.z);
            ParticleState { position, velocity: Vec3::Y * 2.0 }
        })
        .collect();
    let quality = ClothMeter::new(&scene).finish(&particles);
    assert!((quality.stretch_mean - 0.05).abs() < 1e-4, "{}", quality.stretch_mean);
    assert!((quality.stretch_max - 0.1).abs() < 1e-4, "{}", quality.stretch_max);
    assert!((quality.kinetic_energy - 40.0).abs() < 1e-3);
    assert_eq!(quality.depth_max, 0.0);
    let mut sunk = particles;
    sunk[0].position = Vec3::new(-1.0, 0.8 + 0.7, 0.2);
    assert!((ClothMeter::new(&scene).finish(&sunk).depth_max - 0.1).abs() < 1e-5);
}
