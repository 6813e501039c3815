//! Springs of cloth that one core solves per second: 100 by 100 free particles, threads and diagonals, without
//! contacts.
//!
//! The difference of substeps with many and few iterations gives the time of an iteration; cloth with a single spring gives the
//! particles' share.
#![forbid(unsafe_code)]

use sinew_math::Vec3;
use sinew_physics::Sleeping;
use sinew_physics::particles::{ClothDef, GroupDef};
use sinew_physics::{World, WorldDef};
use std::time::Instant;

/// Number of cells along a side.
const CELLS: u32 = 99;
/// Number of steps of a sample; the fastest sample counts.
const STEPS: usize = 30;
/// Number of iterations of a substep, few and many.
const ITERATIONS: [u32; 2] = [2, 42];
/// Number of substeps of a step.
const SUBSTEPS: f64 = 4.0;

/// Returns a cloth with threads and diagonals, without bends.
fn cloth() -> GroupDef {
    let side = 0.04 * CELLS as f32;
    ClothDef {
        corner: Vec3::ZERO,
        across: Vec3::X * side,
        down: Vec3::Z * side,
        columns: CELLS,
        rows: CELLS,
        mass: 0.002 * (CELLS * CELLS) as f32,
        stretching: 2e3,
        shearing: 2e3,
        bending: 0.0,
        damping_ratio: 0.0,
        radius: 0.02,
    }
    .build()
    .group
}

/// Returns the time of an iteration, seconds.
fn seconds(group: &GroupDef) -> f64 {
    let least = ITERATIONS.map(|iterations| {
        let mut world = World::new(WorldDef { sleeping: Sleeping::Off, ..WorldDef::default() });
        world.add_particles(&GroupDef { iterations, ..group.clone() });
        let step = |_| {
            let start = Instant::now();
            world.step();
            start.elapsed().as_secs_f64()
        };
        (0..STEPS).map(step).fold(f64::INFINITY, f64::min)
    });
    (least[1] - least[0]) / (SUBSTEPS * f64::from(ITERATIONS[1] - ITERATIONS[0]))
}

fn main() {
    let cloth = cloth();
    let mut bare = cloth.clone();
    bare.springs.truncate(1);
    let (whole, particles) = (seconds(&cloth), seconds(&bare));
    let springs = cloth.springs.len() as f64 / 1e9;
    println!(
        "{} springs: {:.2} G/s, with the passes over {} particles {:.2} G/s",
        cloth.springs.len(),
        springs / (whole - particles),
        cloth.particles.len(),
        springs / whole,
    );
}
