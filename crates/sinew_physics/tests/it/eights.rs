//! Cloth on resting solids: Coulomb's law holds on a slope of every kind, with few and with many obstacles.

use sinew_math::{Rotation, Transform, Vec3, trig};
use sinew_physics::particles::{ClothDef, GroupDef, Obstacle, ObstacleBody, ParticleGroup, SpringDef};
use sinew_physics::{Material, Shape};

const H: f32 = 1.0 / 240.0;
const GRAVITY: f32 = 9.81;
const RADIUS: f32 = 0.02;
const FRICTION: f32 = 0.5;

fn obstacle(shape: Shape, frame: Transform) -> Obstacle {
    let material = Material { friction: FRICTION, ..Material::DEFAULT };
    Obstacle { shape, previous: frame, world_from_shape: frame, body: 0, material }
}

/// Returns solids whose surface passes through the origin, tilted by `slope`.
fn slopes(slope: Rotation) -> [Obstacle; 4] {
    let below = |depth: f32, turn| Transform::new(slope * Vec3::Y * -depth, turn);
    let along = slope * Rotation::from_axis_angle(Vec3::Z, -90_f32.to_radians());
    [
        obstacle(Shape::HalfSpace, below(0.0, slope)),
        obstacle(Shape::Box { half_extents: Vec3::new(5.0, 0.5, 5.0) }, below(0.5, slope)),
        obstacle(Shape::Sphere { radius: 80.0 }, below(80.0, slope)),
        obstacle(Shape::Capsule { half_height: 5.0, radius: 80.0 }, below(80.0, along)),
    ]
}

/// Returns a cloth on the slope.
fn cloth(slope: Rotation) -> GroupDef {
    let (across, down) = (slope * Vec3::X * 0.2, Vec3::Z * 0.2);
    let corner = slope * Vec3::Y * RADIUS - (across + down) * 0.5;
    let def = ClothDef {
        corner,
        across,
        down,
        columns: 5,
        rows: 5,
        mass: 0.1,
        stretching: 1e3,
        shearing: 1e3,
        bending: 1e-3,
        damping_ratio: 0.0,
        radius: RADIUS,
    };
    let mut group = def.build().group;
    group.material.friction = FRICTION;
    group.linear_damping = 0.0;
    group
}

/// Returns an obstacle and `beside` boxes away from it. With more than 16 obstacles, particles are solved one by one.
fn crowded(solid: Obstacle, beside: usize) -> Vec<Obstacle> {
    let far = |k| Transform::from_translation(Vec3::new(1e3, 0.0, 10.0 * k as f32));
    let boxes = (0..beside).map(|k| obstacle(Shape::Box { half_extents: Vec3::ONE }, far(k)));
    core::iter::once(solid).chain(boxes).collect()
}

/// Returns the mean displacement of the particles down the slope in `substeps`, metres, with `beside` more boxes.
fn way_down(angle: f32, solid: usize, beside: usize, substeps: usize) -> f32 {
    let slope = Rotation::from_axis_angle(Vec3::Z, angle);
    let obstacles = crowded(slopes(slope)[solid].clone(), beside);
    let mut group = ParticleGroup::new(&cloth(slope));
    let mean = |group: &ParticleGroup| {
        group.positions().iter().copied().sum::<Vec3>() / group.positions().len() as f32
    };
    let start = mean(&group);
    let mut bodies = [ObstacleBody::default()];
    for _ in 0..substeps {
        group.substep(H, Vec3::Y * -GRAVITY, &[], &obstacles, &mut bodies);
    }
    let moved = mean(&group) - start;
    let off = moved.dot(slope * Vec3::Y).abs() + moved.z.abs();
    assert!(off < 2e-3, "solid {solid}: the particle is {off} m away from the slope");
    moved.dot(slope * -Vec3::X)
}

#[test]
fn cloth_slides_down_a_slope_by_coulombs_law() {
    let (angle, substeps) = (45_f32.to_radians(), 120);
    let pull = GRAVITY * (trig::sin(angle) - FRICTION * trig::cos(angle));
    let time = substeps as f32 * H;
    let expected = 0.5 * pull * time * (time + H);
    for solid in 0..4 {
        for beside in [0, 16] {
            let way = way_down(angle, solid, beside, substeps);
            assert!(
                (way / expected - 1.0).abs() < 0.02,
                "solid {solid}, {beside} other obstacles: slid {way} m, expected {expected} m"
            );
        }
    }
}

#[test]
fn cloth_stays_on_a_slope_that_friction_holds() {
    for solid in 0..4 {
        for beside in [0, 16] {
            let way = way_down(trig::atan2(0.4, 1.0), solid, beside, 120);
            assert!(way.abs() < 2e-3, "solid {solid}, {beside} other obstacles: crept {way} m");
        }
    }
}

/// Returns `[stretch, height]` of a cloth over a ball, metres: the means over the springs and over the particles.
/// `beside` is the number of distant boxes. `start` raises some particles by micrometres, which changes the folds.
fn over_a_ball(beside: usize, start: usize) -> [f32; 2] {
    let obstacles = crowded(obstacle(Shape::Sphere { radius: 0.3 }, Transform::IDENTITY), beside);
    let def = ClothDef {
        corner: Vec3::new(-0.5, 0.35, -0.5),
        across: Vec3::X,
        down: Vec3::Z,
        columns: 20,
        rows: 20,
        mass: 1.0,
        stretching: 1e3,
        shearing: 1e3,
        bending: 1e-3,
        damping_ratio: 0.0,
        radius: RADIUS,
    };
    let mut def = def.build().group;
    (def.material.friction, def.linear_damping) = (FRICTION, 2.0);
    for (i, particle) in def.particles.iter_mut().enumerate() {
        particle.position.y += 1e-6 * (i * start % 11) as f32;
    }
    let mut group = ParticleGroup::new(&def);
    let mut bodies = [ObstacleBody::default()];
    for _ in 0..1200 {
        group.substep(H, Vec3::Y * -GRAVITY, &[], &obstacles, &mut bodies);
    }
    let at = group.positions();
    let length = |s: &SpringDef| (at[s.a as usize] - at[s.b as usize]).length();
    let stretches = group.springs().iter().map(|s| (length(s) / s.rest_length - 1.0).abs());
    let deepest = at.iter().fold(f32::INFINITY, |least, p| f32::min(least, p.length()));
    assert!(
        deepest > 0.3 + RADIUS - 1e-4,
        "{beside} other obstacles: a particle is {deepest} m from the centre"
    );
    let heights = at.iter().map(|p| p.y).sum::<f32>() / at.len() as f32;
    [stretches.sum::<f32>() / group.springs().len() as f32, heights]
}

/// In SIMD lanes, contacts stop particles after all springs; one by one, they stop them within each spring. Different
/// folds change the stretch by up to 4 %, so the test compares means over eight starts.
#[test]
fn cloth_over_a_ball_has_the_same_mean_pose_in_lanes_and_one_by_one() {
    let [lanes, others] = [0, 16].map(|beside| {
        let all: [[f32; 2]; 8] = core::array::from_fn(|start| over_a_ball(beside, start));
        [0, 1].map(|k| all.iter().map(|figures| figures[k]).sum::<f32>() / all.len() as f32)
    });
    assert!(
        (lanes[0] / others[0] - 1.0).abs() < 0.02,
        "mean stretch {} in lanes, {} one by one",
        lanes[0],
        others[0]
    );
    assert!(
        (lanes[1] - others[1]).abs() < 1e-3,
        "mean height {} m in lanes, {} m one by one",
        lanes[1],
        others[1]
    );
}
