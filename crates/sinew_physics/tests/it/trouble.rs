//! Numeric failures: bodies with numbers that are not finite are stopped and reported; all other bodies continue.

use crate::build::{floor, sphere_body};
use sinew_math::{Transform, Vec3};
use sinew_physics::field::PARAMETERS;
use sinew_physics::particles::{AttachmentDef, AttachmentTarget, GroupDef, ParticleDef};
use sinew_physics::*;

/// Field function that gives bodies faster than 1 m/s a force of NaN.
fn poison(point: &FieldPoint, _: &[f32; PARAMETERS]) -> Wrench {
    let force = if point.velocity.length() > 1.0 { Vec3::splat(f32::NAN) } else { Vec3::ZERO };
    Wrench { force, ..Wrench::default() }
}

fn poisoned() -> World {
    let mut world = World::new(WorldDef::default());
    world.register_field(1, poison);
    world.add_field(&FieldDef::new(FieldKind::Custom { function: 1, parameters: [0.0; PARAMETERS] }));
    world
}

fn particle(position: Vec3) -> GroupDef {
    let particle = ParticleDef { position, velocity: Vec3::ZERO, mass: 0.1, radius: 0.05 };
    GroupDef { particles: vec![particle], ..GroupDef::default() }
}

#[test]
fn nonfinite_particles_are_rolled_back() {
    let mut world = poisoned();
    let group = world.add_particles(&particle(Vec3::Y));
    world.mark();
    let mut told = 0;
    for _ in 0..30 {
        world.step();
        told += world.events().rolled_back.iter().filter(|&&id| id == group).count();
        let group = world.particles(group);
        assert!(group.positions()[0].is_finite() && group.velocities()[0].is_finite());
    }
    assert!(told > 0, "a fall faster than 1 m/s must be reported");
    world.mark();
    let hash = world.hash();
    world.reset();
    assert_eq!(world.hash(), hash, "the loaded state must equal the saved state");
}

#[test]
fn a_quarantined_body_acts_as_a_fixed_anchor() {
    let mut world = poisoned();
    let body = world.add_body(&sphere_body(0.1, Vec3::Y * 5.0));
    let mut def = particle(Vec3::Y * 5.0);
    def.filter.mask = 0;
    def.attachments =
        vec![AttachmentDef { particle: 0, target: AttachmentTarget::Body { body, point: Vec3::ZERO } }];
    let group = world.add_particles(&def);
    let mut quarantined = false;
    for _ in 0..60 {
        world.step();
        quarantined |= world.events().quarantined.contains(&body);
    }
    assert!(quarantined, "a fall faster than 1 m/s must be quarantined");
    let gap = world.particles(group).positions()[0] - world.transform(body).translation;
    assert!(gap.length() < 0.01, "the particle is off its quarantined body by {gap}");
}

#[test]
fn body_that_attracts_a_satellite_does_not_sleep() {
    let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
    world.add_field(&FieldDef::new(FieldKind::Mutual(MutualGravity {
        constant: 1e-3,
        ..MutualGravity::default()
    })));
    let mut star = sphere_body(0.05, Vec3::ZERO);
    star.mass = Some(MassProperties {
        mass: 1000.0,
        inertia: sinew_math::Sym3::from_diagonal(Vec3::ONE),
        ..Default::default()
    });
    world.add_body(&star);
    let mut satellite = particle(Vec3::X);
    satellite.particles[0].velocity = Vec3::Z;
    satellite.particles[0].mass = 1e-3;
    let group = world.add_particles(&satellite);
    for _ in 0..600 {
        world.step();
        let radius = world.particles(group).positions()[0].length();
        assert!((radius - 1.0).abs() < 0.02, "radius {radius} m after {} s", world.time());
    }
}

#[test]
fn low_limit_of_linear_speed_does_not_limit_spin() {
    let mut world = World::new(WorldDef { max_speed: 50.0, ..WorldDef::default() });
    floor(&mut world);
    let mut ball = sphere_body(0.1, Vec3::Y * 0.0999);
    ball.angular_velocity = Vec3::Y * 200.0;
    let ball = world.add_body(&ball);
    for _ in 0..10 {
        world.step();
    }
    assert!(world.velocity(ball).angular.y > 150.0, "{:?}", world.velocity(ball));
}

#[test]
fn set_transform_normalizes_the_rotation() {
    let mut world = World::new(WorldDef::default());
    let ball = world.add_body(&sphere_body(0.1, Vec3::ZERO));
    let long = sinew_math::Rotation::from_xyzw(0.0, 0.0, 0.0, 3.0);
    world.set_transform(ball, sinew_math::Transform::new(Vec3::X, long));
    assert_eq!(world.transform(ball).rotation.length(), 1.0);
}

/// A huge velocity is reduced to the world's limit in its direction and reported once, even if its square exceeds the
/// range of `f32`.
#[test]
fn extreme_impulses_are_limited_and_reported() {
    for (on_floor, jointed) in [(false, false), (true, false), (false, true)] {
        for impulse in [1e10, 1e18, 1e20, 1e30, 3e38] {
            let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
            if on_floor {
                floor(&mut world);
            }
            let body = world.add_body(&sphere_body(0.1, Vec3::Y * 0.1));
            if jointed {
                let other = world.add_body(&sphere_body(0.1, Vec3::Y * 0.4));
                let [a, b, between] = [0.1, 0.4, 0.25].map(|y| Transform::from_translation(Vec3::Y * y));
                world.add_joint(&JointDef::new(body, other, a, b, between, JointKind::Ball { limit: None }));
            }
            world.apply_impulse_at_center(body, Vec3::X * impulse);
            world.step();
            let v = world.velocity(body).linear;
            let what = format!("{impulse:e} on floor {on_floor}, jointed {jointed}: {v}");
            assert!(v.x > 1999.0 && v.length() < 4000.5, "{what}");
            assert!(world.events().limited.contains(&body), "{what}");
            assert!(world.events().quarantined.is_empty(), "{what}");
            world.set_velocity(body, Velocity::default());
            world.step();
            assert!(world.events().limited.is_empty(), "{what}");
        }
    }
}

/// A blow against a head of 3 kg on a light neck rotates the neck at over 10,000 rad/s in the first solve. The step
/// limits the relative motion, but the momentum stays in the island, also while the island stands on a floor.
#[test]
fn a_hard_blow_keeps_its_momentum_on_a_floor() {
    for impulse in [100.0, 2000.0, 6000.0] {
        let mut world = World::new(WorldDef::default());
        floor(&mut world);
        let [base, neck, head] =
            [(0.1, 0.1, 10.0), (0.24, 0.03, 0.6), (0.38, 0.1, 3.1)].map(|(y, radius, mass)| {
                let mut shape = ShapeDef::new(Shape::sphere(radius));
                shape.density = mass / (4.189 * radius * radius * radius);
                shape.material.friction = 0.0;
                world.add_body(&BodyDef::dynamic(shape).at(Vec3::Y * y))
            });
        for (a, b, [at, below, above]) in [(base, neck, [0.2, 0.1, 0.24]), (neck, head, [0.28, 0.24, 0.38])] {
            let [from, to, between] = [below, above, at].map(|y| Transform::from_translation(Vec3::Y * y));
            world.add_joint(&JointDef::new(a, b, from, to, between, JointKind::Ball { limit: None }));
        }
        world.apply_impulse_at_center(head, Vec3::X * impulse);
        for step in 0..30 {
            world.step();
            let momentum: f32 =
                [base, neck, head].map(|id| world.velocity(id).linear.x * world.mass(id).mass).iter().sum();
            assert!(
                (momentum - impulse).abs() < 0.02 * impulse,
                "impulse {impulse} N·s, step {step}: momentum {momentum} N·s"
            );
        }
    }
}

#[test]
fn extreme_spins_are_limited_and_reported() {
    for impulse in [1e10, 1e20, 1e30, 3e38] {
        let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
        let body = world.add_body(&sphere_body(0.1, Vec3::ZERO));
        world.apply_angular_impulse(body, Vec3::Y * impulse);
        world.step();
        let spin = world.velocity(body).angular;
        // At most a quarter turn in each of four substeps.
        let most = core::f32::consts::FRAC_PI_2 * 240.0;
        assert!(
            (spin.y - most).abs() < 1e-3 * most && spin.x.abs() + spin.z.abs() < 1e-3,
            "impulse {impulse:e}: spin {spin} rad/s"
        );
        assert_eq!(world.events().limited, [body], "impulse {impulse:e}: the limited body must be reported");
    }
}

/// Contact rows extrapolate the surface of a fast spinning body along its tangent, to positions that it never reaches.
/// They once pushed a cone on a slider away permanently, and reported a touch.
#[test]
fn an_extreme_kinematic_spin_pushes_nothing_far_away() {
    for spin in [1e4, 1e6, 1e12] {
        let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
        let arm = ShapeDef {
            body_from_shape: Transform::from_translation(Vec3::X * 0.3),
            ..ShapeDef::new(Shape::sphere(0.2))
        };
        let led = BodyDef { angular_velocity: Vec3::new(0.3 * spin, 0.0, spin), ..BodyDef::kinematic(arm) };
        world.add_body(&led);
        let cone = Shape::cone(0.1, 0.1);
        let body = world.add_body(&BodyDef::dynamic(cone).at(Vec3::new(3.0, 2.5, 0.3)));
        for step in 0..60 {
            world.step();
            assert_eq!(
                world.velocity(body),
                Velocity::default(),
                "spin {spin:e}, step {step}: the body must stay untouched"
            );
            assert!(
                world.events().begin.is_empty(),
                "spin {spin:e}, step {step}: the body must stay untouched"
            );
        }
    }
}

#[test]
fn kinematic_bodies_beyond_f32_are_slowed_and_reported() {
    let mut world = World::new(WorldDef::default());
    let led = BodyDef { linear_velocity: Vec3::X * f32::MAX, ..BodyDef::kinematic(Shape::sphere(0.5)) };
    let body = world.add_body(&led);
    for step in 0..120 {
        world.step();
        assert_eq!(world.events().limited, [body], "step {step}");
        assert_eq!(world.velocity(body).linear, Vec3::X * 1e6, "step {step}");
        assert!(world.transform(body).is_finite(), "step {step}");
    }
}
