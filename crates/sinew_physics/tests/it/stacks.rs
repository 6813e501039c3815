//! Bodies that carry many times their own weight.

use crate::build::{box_body, floor};
use sinew_math::{Random, Vec3, trig};
use sinew_physics::*;

const HALF: f32 = 0.25;

/// Adds a tower of cubes with masses from the bottom up, kg.
fn tower(world: &mut World, masses: &[f32]) -> Vec<BodyId> {
    masses.iter().enumerate().map(|(i, &mass)| cube(world, place(i), mass)).collect()
}

/// Returns the position of the centre of a cube of the tower.
fn place(i: usize) -> Vec3 {
    Vec3::Y * (HALF * (2 * i + 1) as f32)
}

fn cube(world: &mut World, position: Vec3, mass: f32) -> BodyId {
    let mut def = box_body(Vec3::splat(HALF), position);
    def.shapes[0].density = mass / (8.0 * HALF * HALF * HALF);
    world.add_body(&def)
}

fn world_with_floor() -> World {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    world
}

fn run(world: &mut World, steps: usize) {
    for _ in 0..steps {
        world.step();
    }
}

/// Returns the upward force of the floor (the first body) on a body in the last step, N.
fn floor_force(world: &World, on: BodyId) -> f64 {
    let of_floor = world.contacts_of(on).filter(|contact| contact.normal.y > 0.9 && contact.b.body == on);
    let impulse = |contact: BodyContact| contact.points().iter().map(|p| f64::from(p.impulse)).sum::<f64>();
    of_floor.map(impulse).sum::<f64>() / f64::from(world.def().dt())
}

#[test]
fn towers_of_any_masses_stand_and_load_the_floor_by_their_weight() {
    towers_of_any_masses_shift_by(1e-3);
}

#[test]
#[ignore = "known gap since contacts are solved in SIMD lanes: the largest of 40 shifts is 0.62 mm (ADR 0015, 0017)"]
fn towers_of_any_masses_shift_by_a_tenth_of_a_millimetre() {
    towers_of_any_masses_shift_by(1e-4);
}

/// Builds forty random towers and checks that each cube ends at most this far to the side, metres.
fn towers_of_any_masses_shift_by(most_aside: f32) {
    let mut random = Random::new(71);
    for case in 0..40 {
        let levels = 2 + random.index(9);
        let decades = 9.0 * random.unit();
        let rises = case % 2 == 0;
        let mut mass = |i: usize| {
            let share = if rises { i as f32 / (levels - 1) as f32 } else { random.unit() };
            trig::pow(10.0, decades * share)
        };
        let masses: Vec<f32> = (0..levels).map(&mut mass).collect();
        let mut world = world_with_floor();
        let cubes = tower(&mut world, &masses);
        run(&mut world, 30);
        let weight = 9.81 * masses.iter().map(|&m| f64::from(m)).sum::<f64>();
        let borne = floor_force(&world, cubes[0]);
        assert!(
            (borne / weight - 1.0).abs() < 0.01,
            "force {borne} N, weight {weight} N, case {case}, {masses:?}"
        );
        run(&mut world, 270);
        for (i, &id) in cubes.iter().enumerate() {
            let off = world.transform(id).translation - place(i);
            let (aside, sunk) = (Vec3::new(off.x, 0.0, off.z).length(), -off.y);
            assert!(
                aside < most_aside && sunk < 0.005,
                "cube {i} moved {aside} m aside, {sunk} m down, case {case}, {masses:?}"
            );
        }
    }
}

#[test]
fn unsqueezed_bodies_keep_their_mass_beside_heavy_ones() {
    let mut world = world_with_floor();
    let light = cube(&mut world, place(0), 0.1);
    cube(&mut world, place(0) + Vec3::X * (2.0 * HALF), 1e6);
    for _ in 0..20 {
        world.step();
        let borne = floor_force(&world, light);
        assert!(
            (borne / 0.981 - 1.0).abs() < 1e-5,
            "the floor carries {borne} N, expected the cube's weight of 0.981 N"
        );
    }
}

#[test]
fn light_body_hit_by_a_heavy_one_moves_at_its_speed() {
    let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
    let light = cube(&mut world, Vec3::ZERO, 0.1);
    let heavy = cube(&mut world, -Vec3::X * 0.6, 1e6);
    world.set_velocity(heavy, Velocity { linear: Vec3::X * 10.0, angular: Vec3::ZERO });
    run(&mut world, 10);
    let v = world.velocity(light).linear;
    assert!(
        (v - Vec3::X * 10.0).length() < 1e-5,
        "velocity of the light body {v:?}, expected 10 m/s along x"
    );
}

/// A wall of 30 rows of cubes stays at rest, although, unlike in small piles, the sweeps end before they converge.
#[test]
fn a_wall_at_rest_stays_at_rest() {
    const ROWS: usize = 30;
    let mut world = world_with_floor();
    for (row, i) in (0..ROWS).flat_map(|row| (0..ROWS - row).map(move |i| (row, i))) {
        let along = i as f32 - 0.5 * (ROWS - row - 1) as f32;
        cube(&mut world, place(row) + Vec3::X * (2.0 * HALF * along), 125.0);
    }
    run(&mut world, 60);
    for step in 60..160 {
        world.step();
        let energy = world.energy().kinetic;
        // 1 cm/s of all cubes is 2.9 J; one substep without contacts gives 48 J.
        assert!(energy < 5.0, "energy {energy} J in step {step}");
    }
}
