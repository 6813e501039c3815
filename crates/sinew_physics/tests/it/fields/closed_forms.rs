//! Effects of single fields, compared with closed forms.

use crate::build::{box_body, capsule_body, sphere_body};
use sinew_math::{Rotation, Sym3, Transform, Vec3};
use sinew_physics::particles::{GroupDef, ParticleDef};
use sinew_physics::*;

pub fn weightless() -> World {
    World::new(WorldDef { gravity: Vec3::ZERO, sleeping: Sleeping::Off, ..WorldDef::default() })
}

pub fn run(world: &mut World, steps: usize) {
    for _ in 0..steps {
        world.step();
    }
}

/// Returns a body with a mass and a moment of inertia, without a shape.
pub fn point_mass(mass: f32, position: Vec3, linear_velocity: Vec3) -> BodyDef {
    let inertia = Sym3::from_diagonal(Vec3::splat(mass * 0.01));
    let mass = Some(MassProperties { mass, center: Vec3::ZERO, inertia });
    BodyDef { position, linear_velocity, mass, ..BodyDef::default() }
}

pub fn particle(mass: f32, radius: f32, position: Vec3) -> GroupDef {
    let velocity = Vec3::ZERO;
    GroupDef { particles: vec![ParticleDef { position, velocity, mass, radius }], ..GroupDef::default() }
}

pub fn close(found: f32, expected: f32, share: f32, what: &str) {
    let off = (found / expected - 1.0).abs();
    assert!(off <= share, "{what}: {found}, expected {expected}, relative error {off:e}");
}

#[test]
fn uniform_gravity_field_adds_to_the_worlds_gravity() {
    let mut world = World::new(WorldDef::default());
    let id = world.add_body(&sphere_body(0.1, Vec3::ZERO));
    let group = world.add_particles(&particle(0.2, 0.0, Vec3::X));
    let side = UniformGravity { acceleration: Vec3::new(3.0, 0.0, 0.0) };
    let field = world.add_field(&FieldDef::new(FieldKind::Uniform(side)));
    run(&mut world, 60);
    let time = 60.0 * world.def().dt();
    for v in [world.velocity(id).linear, world.particles(group).velocities()[0]] {
        close(v.x, 3.0 * time, 1e-5, "sideways");
        close(v.y, -9.81 * time, 1e-5, "down");
    }
    let mass = world.mass(id).mass;
    close(world.field_force(field, id).force.x, 3.0 * mass, 1e-6, "reported force of the field");
}

#[test]
fn a_circular_orbit_about_a_place_closes() {
    let mut world = weightless();
    let id = world.add_body(&point_mass(2.0, Vec3::X, Vec3::Y));
    let group = world.add_particles(&{
        let mut def = particle(0.1, 0.0, -Vec3::X);
        def.particles[0].velocity = -Vec3::Y;
        def
    });
    let pull = PointGravity { strength: 1.0, ..PointGravity::default() };
    world.add_field(&FieldDef::new(FieldKind::Point(pull)));
    let energy = world.energy().total();
    close(energy, -0.5 * 2.0 - 0.5 * 0.1, 1e-5, "energy of the orbit");
    run(&mut world, 377);
    // 2π seconds are 376.99 steps.
    let left = 377.0 * world.def().dt() - core::f32::consts::TAU;
    let at = world.transform(id).translation;
    assert!((at - Vec3::new(1.0, left, 0.0)).length() < 2e-3, "the orbiting body is at {at}");
    let at = world.particles(group).positions()[0];
    assert!((at + Vec3::new(1.0, left, 0.0)).length() < 2e-3, "the orbiting body is at {at}");
    close(world.energy().total(), energy, 1e-4, "energy after a turn");
}

#[test]
fn gravity_between_masses_of_stars_does_not_overflow() {
    let mut world = World::new(WorldDef {
        gravity: Vec3::ZERO,
        step_nanoseconds: 3_600_000_000_000,
        ..WorldDef::default()
    });
    let star = |mass: f32, position: Vec3| {
        let inertia = Sym3::from_diagonal(Vec3::splat(mass));
        let mass = Some(MassProperties { mass, center: Vec3::ZERO, inertia });
        BodyDef { position, mass, ..BodyDef::default() }
    };
    let sun = world.add_body(&star(1.989e30, Vec3::ZERO));
    let earth = world.add_body(&star(5.972e24, Vec3::X * 1.496e11));
    let field = world.add_field(&FieldDef::new(FieldKind::Mutual(MutualGravity::default())));
    let (on_sun, on_earth) = (world.field_force(field, sun).force, world.field_force(field, earth).force);
    close(on_earth.x, -3.542e22, 1e-3, "the book's figure, N");
    assert_eq!(on_sun, -on_earth, "forces must be equal and opposite, bit for bit");
    run(&mut world, 24);
    close(world.velocity(earth).linear.x, -5.931e-3 * 86_400.0, 1e-2, "speed of the Earth after a day");
    let p = world.momentum().linear.x.abs() / (5.972e24 * 512.0);
    assert!(p < 1e-5, "momentum {p} of the Earth's momentum");
}

#[test]
fn mutual_gravity_is_equal_and_opposite() {
    // Bodies and particles in one field, without contacts.
    let mut world = weightless();
    let mut random = sinew_math::Random::new(3);
    for i in 0..12 {
        let def = point_mass(0.5 + i as f32, random.in_cube() * 3.0, random.in_cube());
        world.add_body(&def);
    }
    let mut group = GroupDef::default();
    for _ in 0..6 {
        let (position, velocity) = (random.in_cube() * 3.0, random.in_cube());
        group.particles.push(ParticleDef { position, velocity, mass: 0.5, radius: 0.0 });
    }
    world.add_particles(&group);
    let law = MutualGravity { constant: 0.5, softening: 0.1 };
    world.add_field(&FieldDef::new(FieldKind::Mutual(law)));
    let (before, energy) = (world.momentum(), world.energy());
    run(&mut world, 1000);
    let (after, now) = (world.momentum(), world.energy());
    // Σ|mv| ≈ 80 N·s.
    let drift = (after.linear - before.linear).length();
    assert!(drift < 80.0 * 1e-5, "momentum drifts by {drift} N·s");
    let drift = (after.angular - before.angular).length();
    assert!(drift < 5e-3, "angular momentum drifts by {drift} of {} N·m·s", before.angular.length());
    close(now.total(), energy.total(), 0.05, "energy, including close encounters");
    assert!((now.kinetic / energy.kinetic - 1.0).abs() > 0.1, "the bodies must exchange kinetic energy");
}

#[test]
fn drag_reaches_terminal_velocity() {
    // c = 0.3, k = 0.02, m g = 19.62: v = (√(c² + 4 k m g) − c) / 2k.
    let (c, k, weight) = (0.3f32, 0.02f32, 2.0 * 9.81f32);
    let steady = ((c * c + 4.0 * k * weight).sqrt() - c) / (2.0 * k);
    let mut world = World::new(WorldDef::default());
    let id = world.add_body(&point_mass(2.0, Vec3::ZERO, Vec3::ZERO));
    let group = world.add_particles(&particle(2.0, 0.0, Vec3::X));
    let drag = Drag { linear: c, quadratic: k, ..Drag::default() };
    world.add_field(&FieldDef::new(FieldKind::Drag(drag)));
    run(&mut world, 1200);
    close(-world.velocity(id).linear.y, steady, 3e-5, "terminal speed of a body");
    close(-world.particles(group).velocities()[0].y, steady, 3e-5, "a particle");
}

#[test]
fn drag_far_beyond_stability_stops_and_never_turns_back() {
    let mut world = World::new(WorldDef::default());
    let id = world.add_body(&point_mass(0.001, Vec3::ZERO, Vec3::X * 50.0));
    let group = world.add_particles(&{
        let mut def = particle(0.001, 0.0, Vec3::Y);
        def.particles[0].velocity = Vec3::X * 50.0;
        def
    });
    let drag = Drag { linear: 1e4, angular: 1e4, ..Drag::default() };
    world.add_field(&FieldDef::new(FieldKind::Drag(drag)));
    world.apply_angular_impulse(id, Vec3::splat(1e-4));
    for _ in 0..20 {
        world.step();
        let v = [world.velocity(id).linear, world.particles(group).velocities()[0]];
        assert!(v.iter().all(|v| v.x > -1e-6 && v.x < 1e-3), "{v:?}");
        assert!(world.velocity(id).angular.length() < 1e-3);
    }
    close(-world.velocity(id).linear.y, 0.001 * 9.81 / 1e4, 1e-3, "terminal speed under gravity");
}

/// Returns the force of a wind of 10 m/s along x on a free body at rest.
fn blown(def: &BodyDef, wind: Wind) -> Wrench {
    let mut world = weightless();
    let id = world.add_body(def);
    let field = world.add_field(&FieldDef::new(FieldKind::Wind(wind)));
    world.field_force(field, id)
}

#[test]
fn wind_force_follows_projected_area() {
    let wind = Wind { velocity: Vec3::X * 10.0, density: 1.2, drag: 1.1, ..Wind::default() };
    let pressure = 0.5 * 1.2 * 100.0 * 1.1;
    let pi = core::f32::consts::PI;
    let ball = blown(&sphere_body(0.3, Vec3::Y), wind);
    close(ball.force.x, pressure * pi * 0.09, 1e-5, "ball");
    let mut random = sinew_math::Random::new(2);
    for _ in 0..100 {
        let rotation = random.rotation();
        let half = Vec3::new(0.1, 0.2, 0.4);
        let axes = rotation.to_mat3();
        let n = Vec3::new(axes.x_axis.x, axes.y_axis.x, axes.z_axis.x);
        let shadow =
            4.0 * (n.x.abs() * half.y * half.z + n.y.abs() * half.x * half.z + n.z.abs() * half.x * half.y);
        let brick = blown(&BodyDef { rotation, ..box_body(half, Vec3::ZERO) }, wind);
        close(brick.force.x, pressure * shadow, 1e-4, "box");
        assert!(
            brick.force.y.abs() + brick.force.z.abs() < 1e-3,
            "wind without lift must act along its direction only"
        );
        let capsule = blown(&BodyDef { rotation, ..capsule_body(0.5, 0.1, Vec3::ZERO) }, wind);
        let across = (1.0 - n.y * n.y).sqrt();
        close(capsule.force.x, pressure * (0.2 * across + pi * 0.01), 1e-4, "capsule");
    }
}

#[test]
fn a_tilted_plate_gets_lift() {
    let wind = Wind { velocity: Vec3::X * 10.0, density: 1.2, drag: 1.0, lift: 0.8, gusts: None };
    // The face of the plate points to −x and up, 30° from the direction of the stream.
    let rotation = Rotation::from_axis_angle(Vec3::Z, -30f32.to_radians());
    let def = BodyDef { rotation, ..box_body(Vec3::new(1e-6, 0.5, 0.5), Vec3::ZERO) };
    let Wrench { force, torque } = blown(&def, wind);
    let (sin, cos) = sinew_math::trig::sin_cos(30f32.to_radians());
    let pressure = 0.5 * 1.2 * 100.0;
    close(force.x, pressure * cos, 1e-4, "drag");
    close(force.y, -pressure * 0.8 * cos * sin, 1e-4, "lift");
    assert!(torque.length() < 1e-3, "the torque about the centre must vanish; it is {torque}");
}

#[test]
fn wind_accelerates_a_free_body_by_the_closed_form() {
    let mut world = weightless();
    let plate = world.add_body(&box_body(Vec3::new(0.01, 0.5, 0.5), Vec3::ZERO));
    let group = world.add_particles(&particle(0.01, 0.05, Vec3::Y * 3.0));
    let wind = Wind { velocity: Vec3::X * 10.0, ..Wind::default() };
    world.add_field(&FieldDef::new(FieldKind::Wind(wind)));
    // dv/dt = (w − v)²/L with L = 2 m/(ρ C A): v = w² t/(L + w t).
    let length = 2.0 * world.mass(plate).mass / 1.225;
    run(&mut world, 300);
    let time = 300.0 * world.def().dt();
    close(world.velocity(plate).linear.x, 100.0 * time / (length + 10.0 * time), 2e-3, "plate");
    let length = 2.0 * 0.01 / (1.225 * core::f32::consts::PI * 0.0025);
    let v = world.particles(group).velocities()[0].x;
    close(v, 100.0 * time / (length + 10.0 * time), 2e-3, "particle");
}

#[test]
fn gusts_are_smooth_bounded_and_equal_for_equal_seeds() {
    let gusts = |seed| Gusts { speed: 4.0, length: 2.0, time: 0.5, seed };
    let wind = |seed| Wind { velocity: Vec3::X * 10.0, gusts: Some(gusts(seed)), ..Wind::default() };
    let (mut sum, mut square, mut step) = (Vec3::ZERO, 0.0, 0.0f32);
    let count = 20_000;
    for i in 0..count {
        let at = |i: i32| wind(7).at(Vec3::new(0.01, 0.013, -0.008) * i as f32, i as u64 * 5_000_000);
        let gust = at(i) - Vec3::X * 10.0;
        assert!(gust.abs().cmple(Vec3::splat(4.0)).all(), "a gust exceeds its bound: {gust}");
        step = step.max((at(i + 1) - at(i)).length());
        sum += gust;
        square += gust.length_squared() / 3.0;
    }
    let (mean, deviation) = (sum.length() / count as f32, (square / count as f32).sqrt());
    assert!(mean < 0.3, "mean {mean}");
    assert!((0.28..0.36).contains(&(deviation / 4.0)), "deviation {deviation}");
    assert!(step < 0.4, "the velocity jumps by {step} m/s within 2 cm and 5 ms");
    let place = Vec3::new(1.3, 0.2, 0.9);
    assert_eq!(wind(1).at(place, 123_456), wind(1).at(place, 123_456));
    assert_ne!(wind(1).at(place, 123_456), wind(2).at(place, 123_456));
}

#[test]
fn floating_depth_follows_density() {
    for (name, def, share) in [
        ("box", box_body(Vec3::new(0.5, 0.2, 0.4), Vec3::new(-5.0, 0.1, 0.0)), 0.3),
        ("ball", sphere_body(0.3, Vec3::new(0.0, 0.1, 0.0)), 0.6),
        (
            "capsule",
            BodyDef {
                rotation: Rotation::from_axis_angle(Vec3::Z, 1.2),
                ..capsule_body(0.5, 0.2, Vec3::new(5.0, 0.1, 0.0))
            },
            0.7,
        ),
    ] {
        let mut world = World::new(WorldDef { sleeping: Sleeping::Off, ..WorldDef::default() });
        let mut def = def;
        def.shapes[0].density = 1000.0 * share;
        let id = world.add_body(&def);
        let water = Buoyancy { damping: 3.0, ..Buoyancy::default() };
        world.add_field(&FieldDef::new(FieldKind::Buoyancy(water)));
        run(&mut world, 1200);
        let (shape, at) = world.shapes(id).next().expect("the body has a shape");
        let plane = field::WaterPlane { normal: Vec3::Y, height: 0.0 };
        close(shape.submerged(&at, &plane).volume / shape.volume(), share, 1e-3, name);
        assert!(world.velocity(id).linear.length() < 1e-3, "{name}: must be at rest");
    }
}

#[test]
fn sinking_bodies_reach_terminal_velocity() {
    let mut world = World::new(WorldDef::default());
    let mut def = sphere_body(0.1, Vec3::Y * -5.0);
    def.shapes[0].density = 2500.0;
    let id = world.add_body(&def);
    let flow = Vec3::X * 0.7;
    let water = Buoyancy { damping: 4.0, drag: 0.0, flow, ..Buoyancy::default() };
    world.add_field(&FieldDef::new(FieldKind::Buoyancy(water)));
    run(&mut world, 900);
    close(-world.velocity(id).linear.y, 1.5 * 9.81 / 4.0, 1e-4, "sinking speed (ρ_b/ρ − 1) g/c");
    close(world.velocity(id).linear.x, 0.7, 1e-4, "drift speed of the flow");
}

#[test]
fn fields_act_only_in_their_region_and_on_their_layers() {
    let mut world = weightless();
    let push = FieldKind::Uniform(UniformGravity { acceleration: Vec3::X });
    let region = Region::ball(Vec3::ZERO, 2.0, Fade::Linear);
    let field = world.add_field(&FieldDef { region, layers: 2, ..FieldDef::new(push) });
    let mut on_layer = |layers, x| {
        let mut def = sphere_body(0.1, Vec3::X * x);
        def.shapes[0].filter.layers = layers;
        let id = world.add_body(&def);
        world.field_force(field, id).force.x / world.mass(id).mass
    };
    assert_eq!(on_layer(1, 0.0), 0.0, "a body on another layer must get no force");
    assert_eq!(on_layer(2, 2.5), 0.0, "a body outside the region must get no force");
    close(on_layer(3, 0.5), 0.75, 1e-6, "the force must fade linearly within the margin");
    close(on_layer(2, 0.0), 1.0, 1e-6, "force in the middle of the region");
    let half = Region::Inside {
        shape: Shape::Box { half_extents: Vec3::splat(1.0) },
        world_from_shape: Transform::from_translation(Vec3::X * 10.0),
        margin: 0.5,
        fade: Fade::Smooth,
    };
    assert_eq!(half.weight(Vec3::X * 10.0), 1.0);
    assert_eq!(half.weight(Vec3::X * 10.75), 0.5);
    assert_eq!(half.weight(Vec3::X * 11.5), 0.0);
}

#[test]
fn an_explosion_pushes_by_area_and_distance() {
    let mut world = weightless();
    let near = world.add_body(&sphere_body(0.2, Vec3::X * 1.2));
    let far = world.add_body(&sphere_body(0.2, Vec3::X * -3.2));
    let beyond = world.add_body(&sphere_body(0.2, Vec3::Y * 5.0));
    let hidden = world.add_body(&sphere_body(0.2, Vec3::Z * 2.2));
    let brick = world.add_body(&box_body(Vec3::splat(0.2), Vec3::Z * -2.2));
    let wall = box_body(Vec3::new(1.0, 1.0, 0.05), Vec3::Z);
    world.add_body(&BodyDef { kind: BodyKind::Static, ..wall });
    let group = world.add_particles(&particle(0.5, 0.2, Vec3::Y * -1.2));
    let blast = Explosion::new(Vec3::ZERO, 4.0, 1000.0);
    world.explode(&Explosion { occlusion: Occlusion::Static, ..blast });
    let area = core::f32::consts::PI * 0.04;
    let gained = |id| world.velocity(id).linear * world.mass(id).mass;
    close(gained(near).x, 1000.0 * area * 0.75, 1e-5, "impulse at a quarter of the radius");
    close(-gained(far).x, 1000.0 * area * 0.25, 1e-5, "impulse at three quarters of the radius");
    assert_eq!(gained(beyond), Vec3::ZERO);
    assert_eq!(gained(hidden), Vec3::ZERO, "a body behind the wall must get no impulse");
    close(-gained(brick).z, 1000.0 * 0.16 * 0.5, 1e-5, "impulse on the face toward the explosion");
    close(-world.particles(group).velocities()[0].y * 0.5, 1000.0 * area * 0.75, 1e-5, "a particle");
    world.explode(&blast);
    close(
        world.velocity(hidden).linear.z * world.mass(hidden).mass,
        1000.0 * area * 0.5,
        1e-5,
        "impulse behind the wall without occlusion",
    );
}

fn spring(at: &FieldPoint, parameters: &[f32; field::PARAMETERS]) -> Wrench {
    Wrench { force: -at.position * parameters[0], torque: -at.angular_velocity * parameters[1] }
}

#[test]
fn registered_user_function_acts_as_a_field() {
    let mut world = weightless();
    let id = world.add_body(&point_mass(1.0, Vec3::X, Vec3::ZERO));
    let group = world.add_particles(&particle(1.0, 0.0, Vec3::Y));
    world.register_field(3, spring);
    let mut parameters = [0.0; field::PARAMETERS];
    parameters[0] = 4.0;
    world.add_field(&FieldDef::new(FieldKind::Custom { function: 3, parameters }));
    run(&mut world, 377);
    // With ω = 2 rad/s, two whole turns take 2π s.
    assert!((world.transform(id).translation - Vec3::X).length() < 0.02);
    assert!((world.particles(group).positions()[0] - Vec3::Y).length() < 0.02);
}

#[test]
#[should_panic(expected = "is registered")]
fn field_with_an_unregistered_function_is_refused() {
    let parameters = [0.0; field::PARAMETERS];
    weightless().add_field(&FieldDef::new(FieldKind::Custom { function: 3, parameters }));
}
