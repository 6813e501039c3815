//! Particles and sleepers.

use super::{Nap, nap, run};
use sinew_math::Vec3;
use sinew_physics::particles::{GroupDef, ParticleDef};

fn grains(height: f32) -> GroupDef {
    let grain = |i: u32| ParticleDef {
        position: Vec3::new(0.03 * i as f32 - 0.1, height, 0.02),
        velocity: Vec3::ZERO,
        mass: 0.01,
        radius: 0.01,
    };
    GroupDef { particles: (0..8).map(grain).collect(), ..GroupDef::default() }
}

#[test]
fn what_particles_strike_wakes_as_they_come() {
    // From 1 m above the crate, 0.45 s.
    let Nap { mut world, sleeper, .. } = nap();
    world.add_particles(&grains(1.41));
    run(&mut world, 24);
    assert!(!world.is_awake(sleeper), "they are 0.2 m away");
    run(&mut world, 5);
    assert!(world.is_awake(sleeper));
}

#[test]
fn what_particles_lie_on_sleeps() {
    let Nap { mut world, sleeper, .. } = nap();
    let id = world.add_particles(&grains(0.41));
    run(&mut world, 30);
    let group = world.particles(id);
    assert!(group.positions().iter().all(|at| (at.y - 0.41).abs() < 1e-3), "they lie on it");
    assert!(!world.is_awake(sleeper), "they were put down gently");
}

#[test]
fn what_flies_past_wakes_nobody() {
    let Nap { mut world, sleeper, .. } = nap();
    let mut def = grains(0.5);
    def.gravity_scale = 0.0;
    for particle in &mut def.particles {
        particle.velocity = Vec3::Z * -20.0;
        particle.position.z = 3.0;
    }
    world.add_particles(&def);
    run(&mut world, 30);
    assert!(!world.is_awake(sleeper));
}
