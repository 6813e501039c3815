//! Planks that lean out over the edge of a table.

use crate::framework::flight::Flight;
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{ball, cuboid, fixed, floor};
use sinew::math::{Vec3, max};
use sinew::physics::{BodyId, World};

pub(in crate::scenes) const BLOCK_OVERHANG: Scene = Scene {
    chapter: Chapter::Contacts,
    name: "block_overhang",
    about: "stacks of 2 to 10 planks overhang a table: at 98 % of the harmonic series they stand, at 102 % they fall",
    steps: 300,
    settings: &[Setting::number("thickness", 0.1, (0.02, 1.0), "thickness of a plank of 4 m, m")],
    build: block_overhang,
};

/// Half the length of a plank, metres. Contacts sink by their slop, 2 % of the thickness but at most 5 mm. Planks of
/// this length and thickness tilt by the slop, but less than the 2 % that the overhang leaves.
const HALF_LENGTH: f32 = 2.0;
const HALF_WIDTH: f32 = 0.3;
const TABLE: Vec3 = Vec3::new(6.0, 2.0, 5.0);
/// Distance from stack to stack, metres.
const APART: f32 = 0.8;
const COUNTS: [usize; 5] = [2, 3, 4, 5, 10];
/// Shares of the largest possible overhang.
const STANDING: f32 = 0.98;
const FALLING: f32 = 1.02;
/// Largest allowed motion of the top plank of a standing stack, metres: ten soft contacts sink and tilt by 0.1 m.
const MOST_MOVED: f32 = 0.12;

fn block_overhang(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    // The edge of the table is at x = 0.
    world.add_body(&fixed(cuboid(TABLE, Vec3::new(-TABLE.x, TABLE.y, 0.0))));
    let mut stacks = |share: f32, first: usize| {
        let stack = |(i, &count): (usize, &usize)| {
            let z = ((first + i) as f32 - 4.5) * APART;
            add_stack(&mut world, setup.number("thickness"), count, share, z)
        };
        COUNTS.iter().enumerate().map(stack).collect::<Vec<_>>()
    };
    let (standing, falling) = (stacks(STANDING, 0), stacks(FALLING, COUNTS.len()));
    let plumb = world.add_body(&ball(0.1, Vec3::new(10.0, 6.0, 0.0)));
    let flight = Flight::new(&world, vec![plumb]);
    Instance::new(world, Overhang { standing, falling, flight })
}

/// Builds a stack: plank `k` from the top reaches `share · L / 2k` beyond the one below it, or the table. Returns the
/// top plank and its position.
fn add_stack(world: &mut World, thickness: f32, count: usize, share: f32, z: f32) -> (BodyId, Vec3) {
    let half = Vec3::new(HALF_LENGTH, 0.5 * thickness, HALF_WIDTH);
    let mut end = 0.0;
    let mut top = None;
    for k in (1..=count).rev() {
        end += share * HALF_LENGTH / k as f32;
        let y = 2.0 * TABLE.y + half.y * (2 * (count - k) + 1) as f32;
        let place = Vec3::new(end - HALF_LENGTH, y, z);
        top = Some((world.add_body(&cuboid(half, place)), place));
    }
    top.expect("a stack has planks")
}

struct Overhang {
    /// Top planks with their initial positions.
    standing: Vec<(BodyId, Vec3)>,
    falling: Vec<(BodyId, Vec3)>,
    /// Free fall of a ball beside the stacks.
    flight: Flight,
}

impl Script for Overhang {
    fn after_step(&mut self, world: &mut World) {
        self.flight.after_step(world);
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let moved = |&(id, place): &(BodyId, Vec3)| (world.center_of_mass(id) - place).length();
        let worst = self.standing.iter().map(moved).fold(0.0, max);
        let fallen = self.falling.iter().filter(|stack| moved(stack) > HALF_LENGTH).count() as u32;
        let all = Expected::Near { value: COUNTS.len() as f64, tolerance: 0.0 };
        vec![
            Metric::new("standing_moved_m", worst, Expected::AtMost(f64::from(MOST_MOVED))),
            Metric::new("fallen", fallen, all),
            self.flight.metric(),
        ]
    }
}
