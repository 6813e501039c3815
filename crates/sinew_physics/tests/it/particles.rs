//! Particles and springs, compared with closed forms.

use crate::build::box_body;
use sinew_math::{Random, Reader, Rotation, Sym3, Transform, Vec3, Writer, trig};
use sinew_physics::particles::{
    Anchor, AttachmentDef, AttachmentTarget, GroupDef, Obstacle, ObstacleBody, ParticleDef, ParticleGroup,
    Resists, RopeDef, SpringDef,
};
use sinew_physics::{BodyDef, BodyId, BodyKind, Material, Shape, World, WorldDef};

const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);
const STATIC_BODY: ObstacleBody = ObstacleBody {
    center: Vec3::ZERO,
    linear_velocity: Vec3::ZERO,
    angular_velocity: Vec3::ZERO,
    inverse_mass: 0.0,
    inverse_inertia: Sym3::ZERO,
};

fn particle(position: Vec3, mass: f32, radius: f32) -> ParticleDef {
    ParticleDef { position, velocity: Vec3::ZERO, mass, radius }
}

fn held_in_world(particle: u32, place: Vec3) -> AttachmentDef {
    AttachmentDef { particle, target: AttachmentTarget::World(place) }
}

fn fixed(position: Vec3) -> Anchor {
    Anchor { position, ..Anchor::default() }
}

fn obstacle(shape: Shape, world_from_shape: Transform, friction: f32, restitution: f32) -> Obstacle {
    let previous = world_from_shape;
    Obstacle {
        shape,
        previous,
        world_from_shape,
        body: 0,
        material: Material { friction, restitution, ..Material::DEFAULT },
    }
}

/// Runs a group whose attachments are all fixed, with obstacles at rest.
fn run(group: &mut ParticleGroup, h: f32, seconds: f32, obstacles: &[Obstacle]) {
    let anchors: Vec<Anchor> =
        group.attachments().iter().map(|a| fixed(group.positions()[a.particle as usize])).collect();
    for _ in 0..(seconds / h).round() as u32 {
        group.substep(h, GRAVITY, &anchors, obstacles, &mut [STATIC_BODY]);
    }
}

/// Returns a chain of `masses` below a particle that is held at the origin.
fn chain(masses: &[f32], stiffness: f32, damping: f32, target: AttachmentTarget) -> GroupDef {
    let at = |k: usize| Vec3::new(0.0, -(k as f32), 0.0);
    let mut particles = vec![particle(at(0), 1.0, 0.0)];
    particles.extend(masses.iter().enumerate().map(|(k, m)| particle(at(k + 1), *m, 0.0)));
    let spring =
        |k: u32| SpringDef { a: k, b: k + 1, rest_length: 1.0, stiffness, damping, resists: Resists::Both };
    GroupDef {
        particles,
        springs: (0..masses.len() as u32).map(spring).collect(),
        attachments: vec![AttachmentDef { particle: 0, target }],
        ..GroupDef::default()
    }
}

const HOOK: AttachmentTarget = AttachmentTarget::World(Vec3::ZERO);

#[test]
fn free_fall_is_symplectic_euler() {
    let def = GroupDef { particles: vec![particle(Vec3::ZERO, 2.0, 0.1)], ..GroupDef::default() };
    let mut group = ParticleGroup::new(&def);
    let h = 1.0 / 240.0;
    run(&mut group, h, 1.0, &[]);
    let expected = -0.5 * 9.81 - 0.5 * 9.81 * h;
    assert!(
        (group.positions()[0].y - expected).abs() < 1e-4,
        "the particle is at {}, expected height {expected} m",
        group.positions()[0]
    );
    assert!((group.velocities()[0].y + 9.81).abs() < 1e-4);
}

#[test]
fn one_mass_stretches_its_spring_by_mg_over_k() {
    for substeps in [1.0, 2.0, 8.0] {
        let mut group = ParticleGroup::new(&chain(&[1.0], 1000.0, 5.0, HOOK));
        run(&mut group, 1.0 / (60.0 * substeps), 10.0, &[]);
        let stretch = -group.positions()[1].y - 1.0;
        assert!((stretch / 0.00981 - 1.0).abs() < 1e-3, "{substeps} substeps: stretch {stretch}");
        let pull = group.attachment_impulses()[0].y * 60.0 * substeps;
        assert!((pull + 2.0 * 9.81).abs() < 1e-2, "{substeps} substeps: {pull} N at the hook");
    }
}

/// Every spring of a chain is stretched by the weight below it, even in a chain of a hundred links.
#[test]
fn a_chain_stretches_by_mg_over_k_link_by_link() {
    let mut masses = [0.1; 10];
    masses[9] = 10.0;
    for substeps in [1.0, 2.0, 8.0] {
        let mut group = ParticleGroup::new(&chain(&masses, 20_000.0, 100.0, HOOK));
        run(&mut group, 1.0 / (60.0 * substeps), 20.0, &[]);
        for k in 0..10 {
            let below: f32 = masses[k..].iter().sum();
            let stretch = group.positions()[k].y - group.positions()[k + 1].y - 1.0;
            let expected = below * 9.81 / 20_000.0;
            assert!(
                (stretch / expected - 1.0).abs() < 1e-3,
                "{substeps} substeps, link {k}: stretch {stretch}, expected {expected}"
            );
        }
    }
}

#[test]
fn a_mass_on_a_spring_swings_at_its_frequency() {
    let mut group = ParticleGroup::new(&chain(&[1.0], 1000.0, 0.0, HOOK));
    let h = 1.0 / 960.0;
    let (mut crossings, mut before) = (Vec::new(), -1.0);
    for k in 0..960 {
        group.substep(h, Vec3::new(0.0, -50.0, 0.0), &[fixed(Vec3::ZERO)], &[], &mut []);
        let from_rest = -group.positions()[1].y - 1.05;
        if before < 0.0 && from_rest >= 0.0 {
            crossings.push((k as f32 - from_rest / (from_rest - before)) * h);
        }
        before = from_rest;
    }
    let periods = (crossings.len() - 1) as f32;
    let period = (crossings[crossings.len() - 1] - crossings[0]) / periods;
    let expected = core::f32::consts::TAU / 1000f32.sqrt();
    assert!((period / expected - 1.0).abs() < 0.01, "period {period} s, expected {expected} s");
}

/// A rope of 12 m between hooks 10 m apart hangs as a catenary: a = 4.6954 m, sag 2.9234 m, tension at the ends that of
/// the weight of 7.6189 m of rope.
#[test]
fn a_rope_hangs_as_a_catenary() {
    let mut def = RopeDef {
        from: Vec3::ZERO,
        to: Vec3::new(12.0, 0.0, 0.0),
        links: 60,
        mass: 1.2,
        stiffness: 5.0e4,
        radius: 0.0,
    }
    .build()
    .group;
    let depth = (6.0f32 * 6.0 - 5.0 * 5.0).sqrt();
    for (k, p) in def.particles.iter_mut().enumerate() {
        let t = k as f32 / 60.0;
        p.position = Vec3::new(10.0 * t, -depth * (1.0 - (2.0 * t - 1.0).abs()), 0.0);
    }
    def.linear_damping = 2.0;
    def.attachments = vec![held_in_world(0, Vec3::ZERO), held_in_world(60, Vec3::new(10.0, 0.0, 0.0))];
    let mut group = ParticleGroup::new(&def);
    run(&mut group, 1.0 / 480.0, 20.0, &[]);
    let (a, sag) = (4.6954f64, 2.9234f64);
    let lowest = group.positions().iter().map(|p| p.y).fold(0.0, f32::min);
    assert!(
        (f64::from(-lowest) / sag - 1.0).abs() < 0.005,
        "the lowest point is at {lowest} m, expected sag {sag} m"
    );
    for p in group.positions() {
        let y = a * ((f64::from(p.x) - 5.0) / a).cosh() - a - sag;
        assert!(
            (f64::from(p.y) - y).abs() < 0.005 * sag,
            "the rope passes through {p}, expected height {y} m"
        );
    }
    let pull = group.attachment_impulses()[0].length() * 480.0;
    let expected = 7.6189 * 0.1 * 9.81;
    assert!((pull / expected - 1.0).abs() < 0.005, "{pull} N at the hook, expected {expected} N");
}

/// Two parallel springs form a loop: each stretches half as much as a single one.
#[test]
fn a_spring_that_closes_a_loop_shares_the_load() {
    let mut def =
        chain(&[1.0], 1000.0, 5.0, AttachmentTarget::Body { body: BodyId::from_bits(0), point: Vec3::ZERO });
    def.springs.push(def.springs[0]);
    let mut group = ParticleGroup::new(&def);
    run(&mut group, 1.0 / 480.0, 10.0, &[]);
    let stretch = -group.positions()[1].y - 1.0;
    assert!((stretch / 0.004_905 - 1.0).abs() < 0.02, "the spring is stretched by {stretch} m");
    let pull = group.attachment_impulses()[0].y * 480.0;
    assert!((pull + 2.0 * 9.81).abs() < 0.2, "{pull} N at the hook");
}

/// A point body of 1 kg on a spring that would diverge if it acted one substep late: it gains no energy and keeps its
/// momentum.
#[test]
fn a_stiff_spring_moves_a_light_body_both_ways() {
    let target = AttachmentTarget::Body { body: BodyId::from_bits(0), point: Vec3::ZERO };
    let mut def = chain(&[5.0], 1.0e6, 0.0, target);
    def.particles[0].mass = 0.01;
    def.particles[1].velocity = Vec3::new(1.0, 0.5, 0.0);
    let mut group = ParticleGroup::new(&def);
    let (mut position, mut velocity) = (Vec3::ZERO, Vec3::ZERO);
    let h = 1.0 / 240.0;
    for _ in 0..2400 {
        let anchor = Anchor { position, velocity, gained: Vec3::ZERO, body: Some(0) };
        let body = ObstacleBody {
            center: position,
            linear_velocity: velocity,
            inverse_mass: 1.0,
            inverse_inertia: Sym3::IDENTITY,
            ..ObstacleBody::default()
        };
        group.substep(h, Vec3::ZERO, &[anchor], &[], &mut [body]);
        velocity += group.attachment_impulses()[0];
        position += velocity * h;
        let stretch = (group.positions()[1] - position).length() - 1.0;
        assert!(stretch.abs() < 0.02, "the spring is stretched by {stretch} m");
    }
    // The 10 g of the attached particle move with the body.
    let momentum = velocity * 1.01 + group.velocities()[1] * 5.0;
    assert!((momentum - Vec3::new(5.0, 2.5, 0.0)).length() < 0.01 * 5.6, "momentum {momentum} N·s");
}

#[test]
fn particles_at_100_metres_per_second_do_not_tunnel() {
    let plate = Shape::Box { half_extents: Vec3::new(2.0, 0.005, 2.0) };
    let mut random = Random::new(1);
    for case in 0..200 {
        let frame = Transform::new(random.in_cube(), random.rotation());
        let up = frame.rotation * Vec3::Y;
        let aim = frame.point(random.in_cube() * Vec3::new(0.5, 0.0, 0.5));
        let mut way = random.direction();
        if way.dot(up) > -0.3 {
            way = -up;
        }
        let radius = if case % 2 == 0 { 0.0 } else { 0.02 };
        let def = GroupDef {
            particles: vec![ParticleDef {
                position: aim - way * random.range(0.5, 2.0),
                velocity: way * 100.0,
                mass: 0.1,
                radius,
            }],
            ..GroupDef::default()
        };
        let mut group = ParticleGroup::new(&def);
        let plate = obstacle(plate.clone(), frame, 0.9, 0.0);
        for _ in 0..20 {
            group.substep(1.0 / 120.0, Vec3::ZERO, &[], core::slice::from_ref(&plate), &mut [STATIC_BODY]);
            let height = (group.positions()[0] - frame.translation).dot(up);
            assert!(height > 0.005 + radius - 1e-4, "case {case}: the particle is at height {height} m");
        }
    }
}

/// A moving plate takes a resting particle along.
#[test]
fn a_fast_plate_takes_a_particle_along() {
    let def =
        GroupDef { particles: vec![particle(Vec3::new(0.0, 1.0, 0.0), 0.1, 0.0)], ..GroupDef::default() };
    let mut group = ParticleGroup::new(&def);
    let plate = Shape::Box { half_extents: Vec3::new(1.0, 0.005, 1.0) };
    let (h, velocity) = (1.0 / 120.0, Vec3::new(0.0, 100.0, 0.0));
    for k in 1..20 {
        let center = velocity * (h * k as f32);
        let mut body = [ObstacleBody { center, linear_velocity: velocity, ..STATIC_BODY }];
        let previous = Transform::from_translation(center - velocity * h);
        let plate =
            Obstacle { previous, ..obstacle(plate.clone(), Transform::from_translation(center), 0.5, 0.0) };
        group.substep(h, Vec3::ZERO, &[], &[plate], &mut body);
        assert!(group.positions()[0].y > center.y, "step {k}");
    }
    assert!((group.velocities()[0].y - 100.0).abs() < 0.1);
}

#[test]
fn bounces_return_the_square_of_the_restitution() {
    let h = 1.0 / 480.0;
    for restitution in [0.5f32, 0.8] {
        let def = GroupDef {
            particles: vec![particle(Vec3::new(0.0, 5.0, 0.0), 1.0, 0.0)],
            material: Material { restitution, ..Material::default() },
            ..GroupDef::default()
        };
        let mut group = ParticleGroup::new(&def);
        let ground = obstacle(Shape::HalfSpace, Transform::IDENTITY, 0.5, 0.0);
        let (mut apexes, mut rising) = (Vec::new(), false);
        while apexes.len() < 3 {
            run(&mut group, h, h, core::slice::from_ref(&ground));
            let speed = group.velocities()[0].y;
            if rising && speed <= 0.0 {
                apexes.push(group.positions()[0].y);
            }
            rising = speed > 0.0;
        }
        for (n, apex) in apexes.into_iter().enumerate() {
            let expected = 5.0 * trig::pow(restitution, 2.0 * (n + 1) as f32);
            assert!(
                (apex / expected - 1.0).abs() < 0.02,
                "restitution {restitution}, bounce {n}: apex {apex} m, expected {expected} m"
            );
        }
    }
}

/// A particle slides exactly if the slope is steeper than the friction angle. Its acceleration is gravity along the
/// slope minus friction.
#[test]
fn friction_holds_below_its_angle_and_slides_above() {
    let friction: f32 = 0.5;
    let h = 1.0 / 480.0;
    for degrees in [26.0f32, 27.2, 35.0] {
        let angle = degrees.to_radians();
        let def = GroupDef {
            particles: vec![particle(Vec3::ZERO, 0.3, 0.0)],
            material: Material { friction, ..Material::default() },
            ..GroupDef::default()
        };
        let mut group = ParticleGroup::new(&def);
        let frame = Transform::new(Vec3::ZERO, Rotation::from_axis_angle(Vec3::Z, angle));
        let slope = obstacle(Shape::HalfSpace, frame, friction, 0.0);
        run(&mut group, h, 2.0, &[slope]);
        let way = group.positions()[0].length();
        let rate = 9.81 * (trig::sin(angle) - friction * trig::cos(angle));
        if rate < 0.0 {
            assert!(way < 1e-4, "{degrees}°: the particle slid {way} m");
        } else {
            let expected = 0.5 * rate * 4.0;
            assert!((way / expected - 1.0).abs() < 0.01, "{degrees}°: slid {way} m, expected {expected} m");
        }
    }
}

/// A particle that starts inside a solid leaves at 0.5 m/s, keeps no velocity from that motion, and does not stretch
/// its spring.
#[test]
fn particles_that_start_inside_a_shape_leave_it_slowly() {
    let h = 1.0 / 480.0;
    let slab = obstacle(Shape::Box { half_extents: Vec3::new(1.0, 0.5, 1.0) }, Transform::IDENTITY, 0.3, 0.0);
    let def = GroupDef {
        particles: vec![
            particle(Vec3::new(0.0, 0.46, 0.0), 1e-3, 0.01),
            particle(Vec3::new(0.1, 0.52, 0.0), 1e-3, 0.01),
        ],
        springs: vec![SpringDef::new([0, 1], Vec3::new(0.1, 0.06, 0.0).length(), 3e3)],
        ..GroupDef::default()
    };
    let mut group = ParticleGroup::new(&def);
    for step in 1..=100 {
        group.substep(h, GRAVITY, &[], core::slice::from_ref(&slab), &mut [STATIC_BODY]);
        let (inside, beside) = (group.positions()[0], group.positions()[1]);
        let height = f32::min(0.46 + 0.5 * h * step as f32, 0.51);
        assert!(
            (inside.y - height).abs() < 2e-3,
            "step {step}: at {inside:?}, expected a height of {height} m"
        );
        assert!((beside.y - 0.51).abs() < 0.02 && group.velocities()[1].length() < 0.6, "{beside:?}");
        assert!(group.stretch(0).abs() < 2e-3, "step {step}: stretched by {} m", group.stretch(0));
    }
    assert!(group.velocities().iter().all(|v| v.length() < 0.01), "{:?}", group.velocities());
}

/// Particles slide on a movable body as on the ground, by gravity minus Coulomb friction, although they are up to a
/// hundred million times lighter.
#[test]
fn particles_slide_on_heavy_bodies_as_on_the_ground() {
    let (angle, friction) = (0.6f32, 0.4);
    let tilt = Rotation::from_axis_angle(Vec3::new(0.48, 0.6, 0.64), angle);
    let up = tilt * Vec3::Y;
    let down = (GRAVITY - up * GRAVITY.dot(up)).normalize();
    let rate = GRAVITY.dot(down) + friction * GRAVITY.dot(up);
    let slope = obstacle(Shape::HalfSpace, Transform::new(Vec3::ZERO, tilt), friction, 0.0);
    let joined = SpringDef::new([0, 1], 0.1, 1e4);
    for (mass, inverse_mass, springs) in [
        (1e-2, 1e-3, vec![]),
        (1e-4, 1e-2, vec![]),
        (1e-4, 1e-4, vec![]),
        (1e-2, 1e-3, vec![joined]),
        (1e-4, 1e-2, vec![joined]),
        (1e-4, 1e-4, vec![joined]),
    ] {
        let ends = [Vec3::ZERO, tilt * Vec3::new(0.06, 0.0, 0.08)];
        let def = GroupDef {
            particles: ends.map(|at| particle(at, mass, 0.0)).to_vec(),
            material: Material { friction, ..Material::default() },
            springs,
            ..GroupDef::default()
        };
        let mut group = ParticleGroup::new(&def);
        for _ in 0..480 {
            // The body is held: the test resets its velocity in each substep.
            let inverse_inertia = Sym3::IDENTITY * inverse_mass;
            let mut body = [ObstacleBody { inverse_mass, inverse_inertia, ..STATIC_BODY }];
            group.substep(1.0 / 480.0, GRAVITY, &[], core::slice::from_ref(&slope), &mut body);
        }
        for (&begin, &end) in ends.iter().zip(group.positions()) {
            let off = (end - begin - down * (0.5 * rate)).length();
            assert!(off < 0.02 * rate, "{mass} kg on {} kg: off by {off} m", 1.0 / inverse_mass);
        }
    }
}

/// A body carries the weight of a particle.
#[test]
fn a_body_carries_the_weight_of_a_particle() {
    let def =
        GroupDef { particles: vec![particle(Vec3::new(0.2, 0.1, 0.0), 2.0, 0.0)], ..GroupDef::default() };
    let mut group = ParticleGroup::new(&def);
    let table =
        obstacle(Shape::Box { half_extents: Vec3::new(1.0, 0.1, 1.0) }, Transform::IDENTITY, 0.5, 0.0);
    let h = 1.0 / 240.0;
    for step in 0..240 {
        // The body is held: the test resets its velocity in each substep.
        let mut body = [ObstacleBody { inverse_mass: 0.1, inverse_inertia: Sym3::IDENTITY, ..STATIC_BODY }];
        group.substep(h, GRAVITY, &[], core::slice::from_ref(&table), &mut body);
        let impulses = group.body_impulses();
        if step > 60 {
            let sum: f32 = impulses.iter().map(|hit| hit.impulse.y).sum();
            assert!((sum + 2.0 * 9.81 * h).abs() < 2e-3, "impulses on the body: {impulses:?}");
            assert!((impulses[0].point - Vec3::new(0.2, 0.1, 0.0)).length() < 2e-3);
            assert!((body[0].linear_velocity.y - 0.1 * sum).abs() < 1e-4);
        }
    }
}

/// A rope that falls over a box comes to rest on it with hanging ends, and does not sink into the box.
#[test]
fn a_rope_over_a_box_rests() {
    let mut def = RopeDef {
        from: Vec3::new(-1.5, 0.6, 0.0),
        to: Vec3::new(1.5, 0.6, 0.0),
        links: 60,
        mass: 0.6,
        stiffness: 2000.0,
        radius: 0.02,
    }
    .build()
    .group;
    def.linear_damping = 0.5;
    let mut group = ParticleGroup::new(&def);
    let block = obstacle(Shape::Box { half_extents: Vec3::splat(0.5) }, Transform::IDENTITY, 0.6, 0.0);
    run(&mut group, 1.0 / 480.0, 15.0, core::slice::from_ref(&block));
    let fastest = group.velocities().iter().map(|v| v.length()).fold(0.0, f32::max);
    assert!(fastest < 1e-3, "the fastest particle moves at {fastest} m/s");
    for p in group.positions() {
        let (distance, _) = block.shape.signed_distance(&block.world_from_shape, *p);
        assert!(distance > 0.02 - 0.001, "the particle at {p} is {distance} m from the box");
    }
    let ends = [group.positions()[0], group.positions()[60]];
    assert!(
        ends.iter().all(|p| p.y < -0.2 && p.y > -0.8),
        "the ends of the rope must hang; they are at {ends:?}"
    );
}

/// A heavy rope lands on a light free box: momentum is exchanged, and neither gets a high speed.
#[test]
fn a_heavy_rope_and_a_light_box_share_momentum() {
    for rope_mass in [0.1, 1.0, 5.0] {
        let mut def = RopeDef {
            from: Vec3::new(-0.45, 0.6, 0.0),
            to: Vec3::new(0.45, 0.6, 0.0),
            links: 20,
            mass: rope_mass,
            stiffness: 1000.0,
            radius: 0.02,
        }
        .build()
        .group;
        let start = Vec3::new(0.3, -0.8, 0.0);
        for p in &mut def.particles {
            p.velocity = start;
        }
        let mut group = ParticleGroup::new(&def);
        let mut body =
            ObstacleBody { inverse_mass: 2.0, inverse_inertia: Sym3::IDENTITY * 12.0, ..STATIC_BODY };
        let h = 1.0 / 480.0;
        let mut rotation = Rotation::IDENTITY;
        for _ in 0..480 {
            body.center += body.linear_velocity * h;
            rotation = rotation.integrate(body.angular_velocity, h);
            let frame = Transform::new(body.center, rotation);
            let block = obstacle(Shape::Box { half_extents: Vec3::splat(0.5) }, frame, 0.6, 0.0);
            let mut bodies = [body];
            group.substep(h, Vec3::ZERO, &[], &[block], &mut bodies);
            body = bodies[0];
            let of_rope: Vec3 = group.velocities().iter().zip(group.masses()).map(|(v, m)| *v * *m).sum();
            let lost = start * rope_mass - of_rope - body.linear_velocity * 0.5;
            assert!(lost.length() < 2e-3 * rope_mass, "{rope_mass} kg: lost momentum {lost}");
            let fastest = group.velocities().iter().map(|v| v.length()).fold(0.0, f32::max);
            assert!(fastest < 2.0, "{rope_mass} kg: fastest particle {fastest} m/s");
            assert!(body.linear_velocity.length() < 2.0, "{rope_mass} kg: {body:?}");
        }
        assert!(body.linear_velocity.y < -0.05, "{rope_mass} kg: {body:?}");
    }
}

/// A rope over a frictionless pulley carries the weight at its end along its whole length.
#[test]
fn a_rope_over_a_pulley_carries_its_weight_undiminished() {
    const LINKS: u32 = 40;
    let (reach, link) = (0.51, 0.05);
    let quarter = core::f32::consts::FRAC_PI_2 * reach;
    let at = |k: u32| {
        let s = k as f32 * link - 0.5;
        let angle = s.clamp(0.0, quarter) / reach;
        let on_arc = Vec3::new(reach * trig::sin(angle), reach * trig::cos(angle), 0.0);
        on_arc + Vec3::new(s.min(0.0), -(s - quarter).max(0.0), 0.0)
    };
    let mut particles: Vec<ParticleDef> = (0..=LINKS).map(|k| particle(at(k), 0.02, 0.01)).collect();
    particles[LINKS as usize].mass = 2.0;
    let spring = |k: u32| SpringDef {
        a: k,
        b: k + 1,
        rest_length: link,
        stiffness: 1.0e5,
        damping: 5.0,
        resists: Resists::Both,
    };
    let def = GroupDef {
        particles,
        springs: (0..LINKS).map(spring).collect(),
        attachments: vec![held_in_world(0, at(0))],
        material: Material { friction: 0.0, ..Material::default() },
        linear_damping: 1.0,
        ..GroupDef::default()
    };
    let mut group = ParticleGroup::new(&def);
    let along_z = Rotation::from_axis_angle(Vec3::X, core::f32::consts::FRAC_PI_2);
    let pulley = Shape::Capsule { half_height: 1.0, radius: 0.5 };
    let pulley = obstacle(pulley, Transform::new(Vec3::ZERO, along_z), 0.0, 0.0);
    run(&mut group, 1.0 / 480.0, 20.0, &[pulley]);
    let pull = group.attachment_impulses()[0].x * 480.0;
    // The weight at the end, and the weight of the rope over its height.
    let drop = group.positions()[0].y - group.positions()[LINKS as usize].y;
    let expected = 9.81 * (2.0 + 0.02 * drop / link);
    assert!((pull / expected - 1.0).abs() < 0.01, "{pull} N at the hook, expected {expected} N");
}

#[test]
fn loaded_group_continues_with_the_same_bits() {
    let mut def = RopeDef {
        from: Vec3::new(-1.0, 0.7, 0.1),
        to: Vec3::new(1.0, 0.7, 0.0),
        links: 20,
        mass: 0.5,
        stiffness: 1000.0,
        radius: 0.02,
    }
    .build()
    .group;
    def.attachments = vec![held_in_world(0, def.particles[0].position)];
    def.springs.push(SpringDef {
        a: 3,
        b: 9,
        rest_length: 0.5,
        stiffness: 100.0,
        damping: 1.0,
        resists: Resists::Both,
    });
    let block = obstacle(Shape::Box { half_extents: Vec3::splat(0.5) }, Transform::IDENTITY, 0.6, 0.1);
    let mut group = ParticleGroup::new(&def);
    let h = 1.0 / 480.0;
    run(&mut group, h, 1.0, core::slice::from_ref(&block));
    let mut out = Writer::new();
    group.save(&mut out);
    let bytes = out.into_bytes();
    let mut input = Reader::new(&bytes);
    let mut twin = ParticleGroup::load(&mut input).expect("the snapshot must load");
    input.finish().expect("the group's bytes must be read completely");
    run(&mut group, h, 0.5, core::slice::from_ref(&block));
    run(&mut twin, h, 0.5, &[block]);
    let bits = |g: &ParticleGroup| {
        let mut out = Writer::new();
        g.save(&mut out);
        out.into_bytes()
    };
    assert_eq!(bits(&group), bits(&twin));

    for length in 0..bytes.len() {
        assert!(ParticleGroup::load(&mut Reader::new(&bytes[..length])).is_err());
    }
    let mut random = Random::new(2);
    for _ in 0..2000 {
        let mut broken = bytes.clone();
        let at = random.index(broken.len());
        broken[at] = random.bits() as u8;
        // Damaged bytes give an error or a valid group, never a panic.
        if let Ok(group) = ParticleGroup::load(&mut Reader::new(&broken)) {
            assert_eq!(group.positions().len(), group.masses().len());
        }
    }
}

/// The position of a particle before a wall stopped it must not affect its next contacts, because snapshots do not
/// contain it.
#[test]
fn an_impact_does_not_change_a_loaded_worlds_future() {
    // The impacts happen in different substeps.
    for delay in 0..16 {
        let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
        let wall = box_body(Vec3::ONE, Vec3::X);
        world.add_body(&BodyDef { kind: BodyKind::Static, ..wall });
        // This particle is beside the path, too slow to count as moving and too fast to rest.
        let trembling = box_body(Vec3::splat(0.05), Vec3::new(-0.13, 0.065, 0.0));
        world.add_body(&BodyDef { linear_velocity: Vec3::Y * 0.03, ..trembling });
        let position = Vec3::X * (-1.0 - 0.03 * delay as f32);
        let shot = ParticleDef { velocity: Vec3::X * 30.0, ..particle(position, 0.1, 0.01) };
        let material = Material { friction: 0.0, restitution: 0.05, ..Material::DEFAULT };
        let def = GroupDef { particles: vec![shot], material, ..GroupDef::default() };
        let group = world.add_particles(&def);
        for step in 0..8 {
            let mut out = Writer::new();
            world.save(&mut out);
            let mut twin = World::new(WorldDef::default());
            twin.load(&mut Reader::new(out.as_bytes())).expect("the snapshot must load");
            twin.step();
            world.step();
            assert_eq!(twin.hash(), world.hash(), "delay {delay}, step {step}: the hashes differ");
        }
        let speed = -world.particles(group).velocities()[0].x;
        assert!((speed - 1.5).abs() < 0.01, "the particle leaves the wall at {speed} m/s, expected 1.5 m/s");
    }
}

/// A particle falls through a body that its group ignores and rests on the one below, also after a snapshot is loaded.
#[test]
fn a_group_passes_through_its_ignored_bodies() {
    let mut world = World::new(WorldDef { gravity: GRAVITY, ..WorldDef::default() });
    let shelf = |height: f32| {
        BodyDef::fixed(Shape::Box { half_extents: Vec3::new(1.0, 0.1, 1.0) }).at(Vec3::Y * height)
    };
    let (upper, lower) = (world.add_body(&shelf(2.0)), world.add_body(&shelf(0.0)));
    let group = |passes: Vec<BodyId>| GroupDef {
        particles: vec![particle(Vec3::Y * 2.5, 0.1, 0.05)],
        passes,
        ..GroupDef::default()
    };
    let through = world.add_particles(&group(vec![upper]));
    let stopped = world.add_particles(&group(Vec::new()));
    assert_eq!(world.particles(through).passes(), [upper]);
    (0..20).for_each(|_| world.step());
    let mut w = Writer::new();
    world.save(&mut w);
    let mut again = World::new(WorldDef::default());
    again.load(&mut Reader::new(w.as_bytes())).expect("the snapshot must load");
    for world in [&mut world, &mut again] {
        (0..120).for_each(|_| world.step());
        let height = |group| world.particles(group).positions()[0].y;
        assert!((height(through) - 0.15).abs() < 1e-3 && (height(stopped) - 2.15).abs() < 1e-3);
    }
    assert_eq!(world.particles(through).positions(), again.particles(through).positions());
    _ = lower;
}
