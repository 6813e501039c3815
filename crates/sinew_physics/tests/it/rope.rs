//! Particles and springs in a world, coupled with bodies in both directions.

use crate::build::{box_body, floor, sphere_body};
use sinew_math::Vec3;
use sinew_physics::particles::{
    AttachmentDef, AttachmentTarget, GroupDef, ParticleDef, Resists, RopeDef, SpringDef,
};
use sinew_physics::*;

fn run(world: &mut World, steps: usize) {
    for _ in 0..steps {
        world.step();
    }
}

/// Adds one mass on one spring of 1000 N/m under the origin.
fn hung_mass(world: &mut World, mass: f32) -> GroupId {
    let particle = |y, mass| ParticleDef { position: Vec3::Y * y, velocity: Vec3::ZERO, mass, radius: 0.01 };
    world.add_particles(&GroupDef {
        particles: vec![particle(0.0, 1.0), particle(-0.5, mass)],
        springs: vec![SpringDef {
            a: 0,
            b: 1,
            rest_length: 0.5,
            stiffness: 1000.0,
            damping: 20.0,
            resists: Resists::Both,
        }],
        attachments: vec![AttachmentDef { particle: 0, target: AttachmentTarget::World(Vec3::ZERO) }],
        ..GroupDef::default()
    })
}

#[test]
fn a_mass_stretches_its_spring_by_mg_over_k() {
    for substeps in [1, 4, 8] {
        let mut world = World::new(WorldDef { substeps, ..WorldDef::default() });
        let id = hung_mass(&mut world, 2.0);
        run(&mut world, 600);
        let stretch = -0.5 - world.particles(id).positions()[1].y;
        let expected = 2.0 * 9.81 / 1000.0;
        assert!(
            (stretch / expected - 1.0).abs() < 1e-3,
            "{substeps} substeps: stretch {stretch}, expected {expected}"
        );
    }
}

#[test]
fn a_rope_holds_a_body_and_hangs_from_a_beam() {
    let mut world = World::new(WorldDef::default());
    let mut beam = box_body(Vec3::new(0.5, 0.1, 0.1), Vec3::new(0.0, 3.0, 0.0));
    beam.kind = BodyKind::Static;
    let beam = world.add_body(&beam);
    let weight = world.add_body(&sphere_body(0.1, Vec3::new(0.0, 1.8, 0.0)));
    let mut rope = RopeDef {
        from: Vec3::new(0.0, 2.9, 0.0),
        to: Vec3::new(0.0, 1.9, 0.0),
        links: 10,
        mass: 0.2,
        stiffness: 5000.0,
        radius: 0.01,
    }
    .build()
    .group;
    let hold =
        |particle, body, point| AttachmentDef { particle, target: AttachmentTarget::Body { body, point } };
    // Without this damping the weight would swing for minutes.
    rope.damp(2.0);
    // Measured with an accuracy of some micrometres.
    rope.sleeping = Sleeping::Off;
    rope.attachments = vec![hold(0, beam, -Vec3::Y * 0.1), hold(10, weight, Vec3::Y * 0.1)];
    world.add_particles(&rope);
    let mass = world.mass(weight).mass;
    run(&mut world, 900);
    // The weight stretches the whole rope; the rope's own weight acts on half of it on average.
    let sunk = 1.8 - world.transform(weight).translation.y;
    let expected = (mass + 0.1) * 9.81 / 5000.0;
    assert!((sunk / expected - 1.0).abs() < 0.002, "sunk by {sunk} m, expected {expected} m");
    // At the end of a step, the pull of the last substep has acted but the weight of the next one has not: g h.
    assert!(world.velocity(weight).linear.length() < 0.05);
}

#[test]
fn a_rope_falls_over_a_box_and_rests_on_it() {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    let crate_body = world.add_body(&box_body(Vec3::splat(0.25), Vec3::new(0.0, 0.25, 0.0)));
    let mut rope = RopeDef {
        from: Vec3::new(-1.0, 0.8, 0.02),
        to: Vec3::new(1.0, 0.8, 0.02),
        links: 40,
        mass: 1.0,
        stiffness: 2000.0,
        radius: 0.01,
    }
    .build()
    .group;
    // Without damping, the hanging ends would swing for minutes.
    rope.linear_damping = 0.5;
    let id = world.add_particles(&rope);
    run(&mut world, 600);
    let rope = world.particles(id);
    let lowest = rope.positions().iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
    let highest = rope.positions().iter().map(|p| p.y).fold(0.0, f32::max);
    assert!(lowest > 0.0 && highest > 0.5 && highest < 0.53, "lowest {lowest} m, highest {highest} m");
    assert!(rope.velocities().iter().all(|v| v.length() < 0.02));
    assert!((world.transform(crate_body).translation - Vec3::new(0.0, 0.25, 0.0)).length() < 0.01);
}

#[test]
fn rope_and_body_keep_their_momentum_together() {
    let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
    let body = world.add_body(&sphere_body(0.1, Vec3::ZERO));
    let mut rope = RopeDef {
        from: Vec3::X * 0.1,
        to: Vec3::X * 1.1,
        links: 5,
        mass: 1.0,
        stiffness: 500.0,
        radius: 0.01,
    }
    .build()
    .group;
    rope.attachments =
        vec![AttachmentDef { particle: 0, target: AttachmentTarget::Body { body, point: Vec3::X * 0.1 } }];
    for (i, particle) in rope.particles.iter_mut().enumerate().skip(1) {
        particle.velocity = Vec3::new(0.0, i as f32, 0.0);
    }
    world.add_particles(&rope);
    let before = world.momentum().linear;
    run(&mut world, 300);
    let after = world.momentum().linear;
    assert!((after - before).length() < 1e-5 * before.length(), "momentum {before:?} became {after:?}");
}

#[test]
fn restored_and_threaded_worlds_with_particles_match_the_original() {
    let build = || {
        let mut world = World::new(WorldDef::default());
        floor(&mut world);
        hung_mass(&mut world, 1.0);
        world.add_body(&box_body(Vec3::splat(0.2), Vec3::new(0.3, 0.2, 0.0)));
        world.add_particles(
            &RopeDef {
                from: Vec3::new(-0.5, 0.6, 0.0),
                to: Vec3::new(0.9, 0.7, 0.1),
                links: 20,
                mass: 0.5,
                stiffness: 800.0,
                radius: 0.01,
            }
            .build()
            .group,
        );
        world
    };
    let mut world = build();
    run(&mut world, 60);
    let mut w = sinew_math::Writer::new();
    world.save(&mut w);
    let mut copy = World::new(WorldDef::default());
    copy.load(&mut sinew_math::Reader::new(w.as_bytes())).expect("the snapshot must load");
    let mut threaded = build();
    for _ in 0..60 {
        threaded.step_with(&Threads::new(2), &stage::NoProfiler);
    }
    for _ in 0..120 {
        world.step();
        copy.step();
        threaded.step_with(&Threads::new(2), &stage::NoProfiler);
        assert_eq!(world.hash(), copy.hash());
        assert_eq!(world.hash(), threaded.hash());
    }
}

#[test]
fn a_rope_pulls_through_a_body_that_it_holds_twice() {
    let mut world = World::new(WorldDef::default());
    let bodies = [(-1.0, 1.0), (-2.0, 10.0)].map(|(y, mass)| {
        let mut def = box_body(Vec3::splat(0.1), Vec3::Y * y);
        def.shapes[0].density = mass / 0.008;
        def.sleeping = Sleeping::Off;
        world.add_body(&def)
    });
    let particle = |y| ParticleDef { position: Vec3::Y * y, velocity: Vec3::ZERO, mass: 1e-3, radius: 0.01 };
    let mut group = GroupDef {
        particles: [0.0, -0.9, -1.1, -1.9].map(particle).to_vec(),
        springs: vec![SpringDef::new([0, 1], 0.9, 5000.0), SpringDef::new([2, 3], 0.8, 5000.0)],
        sleeping: Sleeping::Off,
        ..GroupDef::default()
    };
    for spring in &mut group.springs {
        *spring = spring.damped(1.0, [f32::INFINITY, 10.0]);
    }
    group.hold_in_world(&[0]);
    for (particle, body, side) in [(1, bodies[0], 0.1), (2, bodies[0], -0.1), (3, bodies[1], 0.1)] {
        group.hold(particle, AttachmentTarget::Body { body, point: Vec3::Y * side });
    }
    let id = world.add_particles(&group);
    run(&mut world, 600);
    let hung = [11.0, 10.0].map(|mass| mass * 9.81 / 5000.0);
    for (k, expected) in hung.into_iter().enumerate() {
        let stretch = world.particles(id).stretch(k);
        assert!(
            (stretch / expected - 1.0).abs() < 1e-3,
            "spring {k}: stretch {stretch}, expected {expected}"
        );
    }
}

/// Returns a world with a plank on this many ropes, each attached to the plank at two particles and held at both ends.
fn hung_plank(ropes: usize) -> World {
    const LINK: f32 = 0.15;
    const HALF: Vec3 = Vec3::new(0.13, 0.02, 0.8);
    let mut world = World::new(WorldDef::default());
    let mut def = BodyDef {
        linear_velocity: Vec3::Y * 0.2,
        angular_velocity: Vec3::new(0.3, 0.2, 1.0),
        sleeping: Sleeping::Off,
        ..box_body(HALF, Vec3::ZERO)
    };
    def.shapes[0].density = 5.0 / (8.0 * HALF.x * HALF.y * HALF.z);
    let plank = world.add_body(&def);
    let sides: &[f32] = if ropes == 1 { &[0.0] } else { &[-HALF.z, HALF.z] };
    for z in sides.iter().map(|&z| Vec3::Z * z) {
        let ends = [-1.5, 1.5].map(|x| Vec3::X * x * LINK + z);
        let def = RopeDef { from: ends[0], to: ends[1], links: 3, mass: 2.0, stiffness: 4e4, radius: 0.01 };
        let mut group = def.build().group;
        // A tension of 400 N stretches the ropes; they have no damping.
        for spring in &mut group.springs {
            (spring.rest_length, spring.damping) = (LINK - 0.01, 0.0);
        }
        group.sleeping = Sleeping::Off;
        // These particles are inside the plank.
        group.filter.mask = 0;
        group.hold_in_world(&[0, 3]);
        for (knot, x) in [(1, -0.5), (2, 0.5)] {
            group.hold(knot, AttachmentTarget::Body { body: plank, point: Vec3::X * x * LINK + z });
        }
        world.add_particles(&group);
    }
    world
}

#[test]
fn a_plank_on_taut_ropes_gains_no_energy() {
    for ropes in [1, 2] {
        let mut world = hung_plank(ropes);
        let begin = world.energy().total();
        for step in 0..600 {
            world.step();
            let now = world.energy().total();
            assert!(
                now < begin + 0.5,
                "{ropes} ropes, step {step}: the energy rose from {begin} J to {now} J"
            );
        }
    }
}

/// A stiff rope without external forces keeps its momentum and energy. Its springs pull with many thousand times its
/// momentum in each substep; lost rounding errors once made it writhe and change its velocity within a step.
#[test]
fn a_stiff_rope_keeps_its_motion() {
    for (stiffness, velocity) in [(1e3, 1.0), (1e5, 1.0), (1e5, 10.0)] {
        let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
        let rope = RopeDef {
            from: Vec3::Y * 2.0,
            to: Vec3::new(1.0, 2.7, -0.9),
            links: 15,
            mass: 0.08,
            stiffness,
            radius: 0.02,
        };
        let mut group = rope.build().group;
        let thrown = Vec3::new(0.0, -velocity, 0.3 * velocity);
        group.particles.iter_mut().for_each(|particle| particle.velocity = thrown);
        let id = world.add_particles(&group);
        let begin = world.energy().total();
        for step in 0..60 {
            world.step();
            let what = format!("{stiffness} N at {velocity} m/s, step {step}");
            let apart = world.momentum().linear / 0.08 - thrown;
            assert!(apart.length() < 1e-3 * velocity, "{what}: the velocity is off by {apart:?}");
            let gain = world.energy().total() - begin;
            assert!(gain.abs() < 1e-3 * begin, "{what}: the energy rose by {gain} J from {begin} J");
            assert!(
                world.particles(id).elastic_energy() < 1e-3 * begin,
                "{what}: the elastic energy must stay near 0"
            );
        }
    }
}
