//! A life: settings of a world and the deeds before each step, all derived from a seed.

use crate::deeds::{self, Deed, MAKERS};
use crate::extension;
use crate::numbers::{Numbers, Taste, Temper};
use sinew_math::Vec3;
use sinew_physics::*;

/// Ground of a life.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ground {
    HalfSpace,
    /// A box so thick that the shortest way out of it is upward.
    Box,
    /// Abutting boxes.
    Boxes,
    Mesh,
}

/// A deed before a step.
#[derive(Clone, Copy)]
pub struct Act {
    pub step: u32,
    /// Number that identifies the deed in this life; also the seed of the deed's numbers.
    pub number: u64,
    pub deed: &'static Deed,
}

#[derive(Clone)]
pub struct Life {
    pub taste: Taste,
    pub temper: Temper,
    pub ground: Ground,
    pub def: WorldDef,
    pub acts: Vec<Act>,
    pub steps: u32,
}

/// Deeds after which the energy check is impossible, and the share of lives without them.
const STIRRING: [&str; 5] = ["add_force", "set_force", "add_field", "add_particles", "add_object"];
const PLAIN: f32 = 0.3;
/// Number of steps after the last deed, in which the world is only checked.
const QUIET: u32 = 50;

impl Life {
    /// Returns the life of a seed.
    pub fn of(seed: u64) -> Self {
        let mut n = Numbers::new(seed ^ 0x5eed_0000, Taste::Any, Temper::Calm);
        let taste = n.one_of(&[Taste::Round, Taste::Equal, Taste::Bounds, Taste::Any, Taste::Any]);
        let temper = if n.chance(0.25) { Temper::Wild } else { Temper::Calm };
        let ground =
            n.one_of(&[Ground::HalfSpace, Ground::HalfSpace, Ground::Box, Ground::Boxes, Ground::Mesh]);
        let busy = extension::BUSY.start + n.index(extension::BUSY.len()) as u32;
        let mut life = Self {
            taste,
            temper,
            ground,
            def: settings(&mut n, temper),
            acts: Vec::new(),
            steps: busy + QUIET,
        };
        let all = deeds::all();
        let makers: Vec<&'static Deed> = MAKERS
            .iter()
            .chain(extension::MAKERS)
            .filter_map(|name| all.iter().copied().find(|deed| deed.name == *name))
            .collect();
        let plain = Numbers::new(!seed, Taste::Any, Temper::Calm).chance(PLAIN);
        let mut push = |step, number, deed: &'static Deed| {
            if !(plain && STIRRING.contains(&deed.name)) {
                life.acts.push(Act { step, number, deed });
            }
        };
        for _ in 0..4 + n.index(16) {
            let deed = n.one_of(&makers);
            push(0, n.bits(), deed);
        }
        let total: u32 = all.iter().map(|deed| deed.weight).sum();
        let rate = n.one_of(&[0.1, 0.3, 0.8]);
        for step in 1..busy {
            let count = usize::from(n.chance(rate)) + if n.chance(0.05 * rate) { n.index(10) } else { 0 };
            for _ in 0..count {
                let mut left = n.index(total as usize) as u32;
                let deed = all.iter().find(|deed| {
                    let is_it = left < deed.weight;
                    left = left.saturating_sub(deed.weight);
                    is_it
                });
                push(step, n.bits(), deed.expect("the drawn number is below the sum of all weights"));
            }
        }
        life
    }

    /// Returns a calm life that does each deed twice, six deeds before each step. It makes the calls that are rare in
    /// other lives.
    pub fn of_each_deed(seed: u64) -> Self {
        let mut n = Numbers::new(!seed, Taste::Any, Temper::Calm);
        let all = deeds::all();
        let is_maker = |deed: &&&Deed| MAKERS.iter().chain(extension::MAKERS).any(|name| *name == deed.name);
        let made = all.iter().filter(is_maker).cycle().take(16).map(|&deed| (0, deed));
        let done = (0..2 * all.len()).map(|place| (1 + place as u32 / 6, all[place % all.len()]));
        let acts: Vec<Act> =
            made.chain(done).map(|(step, deed)| Act { step, number: n.bits(), deed }).collect();
        let steps = 1 + acts.last().map_or(0, |act| act.step) + QUIET;
        let (taste, temper, ground) = (Taste::Any, Temper::Calm, Ground::HalfSpace);
        Self { taste, temper, ground, def: WorldDef::default(), acts, steps }
    }

    /// Returns the numbers for a deed of this life.
    pub fn numbers(&self, act: &Act) -> Numbers {
        Numbers::new(act.number, self.taste, self.temper)
    }

    /// Returns the initial world of the life and its ground.
    pub fn world(&self) -> (World, BodyId) {
        let mut world = World::new(self.def.clone());
        crate::functions::register(&mut world);
        let floor = match self.ground {
            Ground::HalfSpace => world.add_body(&BodyDef::fixed(Shape::HalfSpace)),
            Ground::Box => {
                let slab = Shape::cuboid(Vec3::new(50.0, 10.0, 50.0));
                world.add_body(&BodyDef::fixed(slab).at(Vec3::NEG_Y * 10.0))
            }
            Ground::Boxes => {
                let tile = |x, z| BodyDef::fixed(Shape::cuboid(Vec3::splat(1.0))).at(Vec3::new(x, -1.0, z));
                let side = || (-3..=3).map(|i| 2.0 * i as f32);
                let tiles: Vec<BodyId> = side()
                    .flat_map(|x| side().map(move |z| (x, z)))
                    .map(|(x, z)| world.add_body(&tile(x, z)))
                    .collect();
                tiles[0]
            }
            Ground::Mesh => {
                let corners = [(-50.0, -50.0), (50.0, -50.0), (50.0, 50.0), (-50.0, 50.0)];
                let points = corners.map(|(x, z)| Vec3::new(x, 0.0, z));
                let mesh = Shape::mesh(&points, &[[0, 2, 1], [0, 3, 2]]).expect("the mesh is valid");
                world.add_body(&BodyDef::fixed(mesh))
            }
        };
        (world, floor)
    }
}

fn settings(n: &mut Numbers, temper: Temper) -> WorldDef {
    let mut def = WorldDef::default();
    if n.chance(0.1) {
        def.sleeping = Sleeping::Off;
    }
    if n.chance(0.2) {
        def.quality = n.one_of(&[Quality::Fast, Quality::Exact]);
    }
    if n.chance(0.2) {
        def.substeps = n.one_of(&[1, 2, 8]);
    }
    if n.chance(0.1) {
        def.step_nanoseconds = n.one_of(&[8_333_333, 33_333_333]);
    }
    if n.chance(0.1) {
        def.gravity = n.one_of(&[Vec3::ZERO, Vec3::new(0.0, -1.62, 0.0)]);
    }
    if n.chance(0.2) {
        def.hit_speed = n.one_of(&[0.0, 0.1]);
    }
    if temper == Temper::Wild && n.chance(0.2) {
        def.max_speed = n.one_of(&[1e-3, 1e6, 1e20, f32::MAX]);
        def.max_turn = n.one_of(&[1e-3, 1e6, f32::MAX]);
    }
    def
}
