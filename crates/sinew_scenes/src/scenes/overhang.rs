//! Blocks that lean out over the edge of a table.

use super::flight::Flight;
use super::metric::{Expected, Metric};
use super::parts::{ball, cuboid, fixed, floor};
use super::{Instance, Scene, Script, Setup};
use sinew::math::{Vec3, max};
use sinew::physics::{BodyId, World};

pub(super) const BLOCK_OVERHANG: Scene = Scene {
    name: "block_overhang",
    about: "stacks of 2 to 10 blocks lean out over a table: they stand at 98 % of the harmonic series, fall at 102 %",
    steps: 300,
    settings: &[],
    build: block_overhang,
};

/// 1 m long.
const BLOCK: Vec3 = Vec3::new(0.5, 0.1, 0.2);
const TABLE: Vec3 = Vec3::new(2.0, 0.5, 3.5);
/// From stack to stack, metres.
const APART: f32 = 0.6;
const COUNTS: [usize; 5] = [2, 3, 4, 5, 10];
/// Shares of the largest overhang.
const STANDING: f32 = 0.98;
const FALLING: f32 = 1.02;
/// How far the top block of a stack that stands may have moved, metres.
const MOST_MOVED: f32 = 0.01;

fn block_overhang(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    // Its edge is at x = 0.
    world.add_body(&fixed(cuboid(TABLE, Vec3::new(-TABLE.x, TABLE.y, 0.0))));
    let mut stacks = |share: f32, first: usize| {
        let stack = |(i, &count): (usize, &usize)| {
            let z = ((first + i) as f32 - 4.5) * APART;
            add_stack(&mut world, count, share, z)
        };
        COUNTS.iter().enumerate().map(stack).collect::<Vec<_>>()
    };
    let (standing, falling) = (stacks(STANDING, 0), stacks(FALLING, COUNTS.len()));
    let plumb = world.add_body(&ball(0.1, Vec3::new(2.0, 2.0, 0.0)));
    let flight = Flight::new(&world, vec![plumb]);
    Instance::new(world, Overhang { standing, falling, flight })
}

/// Block `k` from the top reaches `share · L / 2k` beyond the one below it, or the table; gives the top block and where
/// it is.
fn add_stack(world: &mut World, count: usize, share: f32, z: f32) -> (BodyId, Vec3) {
    let mut end = 0.0;
    let mut top = None;
    for k in (1..=count).rev() {
        end += share * BLOCK.x / k as f32;
        let y = 2.0 * TABLE.y + BLOCK.y * (2 * (count - k) + 1) as f32;
        let place = Vec3::new(end - BLOCK.x, y, z);
        top = Some((world.add_body(&cuboid(BLOCK, place)), place));
    }
    top.expect("a stack has blocks")
}

struct Overhang {
    /// Top blocks with the places where they were put.
    standing: Vec<(BodyId, Vec3)>,
    falling: Vec<(BodyId, Vec3)>,
    /// Of a ball beside them.
    flight: Flight,
}

impl Script for Overhang {
    fn after_step(&mut self, world: &mut World) {
        self.flight.after_step(world);
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let moved = |&(id, place): &(BodyId, Vec3)| (world.center_of_mass(id) - place).length();
        let worst = self.standing.iter().map(moved).fold(0.0, max);
        let fallen = self.falling.iter().filter(|stack| moved(stack) > BLOCK.x).count() as u32;
        let all = Expected::Near { value: COUNTS.len() as f64, tolerance: 0.0 };
        vec![
            Metric::new("standing_moved_m", worst, Expected::AtMost(f64::from(MOST_MOVED))),
            Metric::new("fallen", fallen, all),
            self.flight.metric(),
        ]
    }
}
