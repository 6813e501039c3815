//! Builds blocks from the world's contacts, once a step.

use super::Contacts;
use super::block::{Block, Bounce, Memory, NONE, Rolling, ZERO8};
use super::chunks::Run;
use super::color::{Coloring, Edge};
use super::geometry::{Cores, Geometry};
use super::place::{respond, take_inertias};
use super::record::{Extra, Record};
use super::refresh::Found;
use super::write::write;
use crate::body::material::ContactMaterial;
use crate::collide::MAX_POINTS;
use crate::contact::{Contact, ContactMemory};
use crate::runner::TaskRunner;
use crate::slices::{MOST_NEAR, for_each_near};
use crate::solver::body::SolverBody;
use crate::solver::contact_rows::{Placed, Softness, contact_softness};
use crate::solver::contacts::classes::{Class, Color};
use crate::solver::tuning::REFRESH_TURN_RIM;
use crate::solver::view::View;
use crate::spatial::Vec6;
use core::ops::Range;
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::{Lanes, WIDTH};
use sinew_math::{Sym3, Vec3};

/// Number of blocks for which memory is reserved when another one is needed.
pub(super) const SPARE_BLOCKS: usize = 8;

/// Input for an island's contacts at the start of a step.
pub(in crate::solver) struct OfStep<'a> {
    pub view: &'a View<'a>,
    /// Bodies of the island; the first `moving` of them move.
    pub bodies: &'a [SolverBody],
    pub moving: usize,
    /// Substep of the island, seconds, and its length relative to the world's.
    pub h: f32,
    pub stretch: f32,
    pub runner: &'a dyn TaskRunner,
}

impl Contacts {
    /// Begins a new list of contacts.
    pub fn clear(&mut self) {
        self.tally = Default::default();
        self.coloring.clear();
        self.records.clear();
        self.extras.clear();
        self.drives = false;
        self.colors.clear();
        self.found.clear();
        self.rolling.clear();
        self.one.clear();
        self.two.clear();
        self.four.clear();
    }

    /// Reserves memory for `bodies` bodies and `contacts` contacts, also if this island has none: the next island may
    /// use it.
    pub fn make_room(&mut self, bodies: usize, contacts: usize) {
        for list in [&mut self.inverse, &mut self.moved, &mut self.centers] {
            list.clear();
            list.reserve(bodies);
        }
        self.turned.clear();
        self.turned.reserve(bodies);
        self.records.clear();
        self.records.reserve(contacts);
        self.extras.clear();
        self.extras.reserve(SPARE_BLOCKS * WIDTH);
        self.colors.reserve(SPARE_BLOCKS);
        let blocks = usize::min(contacts, SPARE_BLOCKS);
        self.one.make_room(blocks);
        self.two.make_room(blocks);
        self.four.make_room(blocks);
        self.coloring.make_room(bodies, contacts);
    }

    /// Colours the added contacts and writes them to blocks. Returns true if a surface moves relative to its body, or
    /// launches bodies.
    pub fn prepare(&mut self, of: &OfStep<'_>) -> bool {
        if self.coloring.edges.is_empty() {
            return false;
        }
        self.found.reserve(SPARE_BLOCKS * WIDTH);
        self.rolling.reserve(SPARE_BLOCKS);
        let colors = self.coloring.color(of.moving) as usize;
        self.colors.resize(colors, Color::default());
        self.take_inertias(of.bodies, of.moving);
        self.turned.clear();
        self.turned.resize(of.bodies.len(), 0.0);
        self.centers.clear();
        self.centers.extend(of.bodies.iter().map(|body| {
            let [x, y, z] = body.pose.translation.to_array();
            [x, y, z, 0.0, 0.0, 0.0, 0.0, 0.0]
        }));
        let soft = [true, false].map(|both_move| contact_softness(both_move, of.h));
        let Self {
            one, two, four, colors, coloring, records, extras, centers, inverse, rolling, found, ..
        } = self;
        let source = Source { of, edges: &coloring.edges, records, extras, centers, inverse, soft };
        let mut lists = Lists { rolling, found };
        for (color, run) in colors.iter_mut().zip(coloring.runs()) {
            color.one = one.append_for(run[0].len());
            color.two = two.append_for(run[1].len());
            color.four = four.append_for(run[2].len());
        }
        write_all((Run::all(one), Run::all(two), Run::all(four)), coloring, &source, of.runner);
        one.list_bounces();
        two.list_bounces();
        four.list_bounces();
        for (color, run) in colors.iter().zip(coloring.runs()).filter(|_| !source.extras.is_empty()) {
            one.list_extras(0, color.one.start, run[0], &source, &mut lists);
            two.list_extras(1, color.two.start, run[1], &source, &mut lists);
            four.list_extras(2, color.four.start, run[2], &source, &mut lists);
        }
        self.is_spoiled = false;
        self.found.sort_unstable_by_key(Found::place);
        self.make_room_for_conjugate(of.bodies.len());
        self.drives
    }
}

/// Input for the lanes.
pub(super) struct Source<'a> {
    pub of: &'a OfStep<'a>,
    pub edges: &'a [Edge],
    /// Records of the edges, and the extra data of a few of them.
    pub records: &'a [Record],
    pub extras: &'a [Extra],
    /// Centre of each body, and its inverse mass and inverse inertia.
    pub centers: &'a [Vec6],
    inverse: &'a [Vec6],
    /// Softness of contacts between two moving bodies, and of contacts with a fixed body.
    pub soft: [Softness; 2],
}

/// Lists of rolling resistances and of manifolds to recompute, which accompany the blocks.
struct Lists<'a> {
    rolling: &'a mut Vec<Rolling>,
    found: &'a mut Vec<Found>,
}

/// Blocks of a class, and the edges to write to them, eight for each block.
enum Job<'a> {
    One(Run<'a, 1, 1>, &'a [u32]),
    Two(Run<'a, 2, 3>, &'a [u32]),
    Four(Run<'a, 4, 10>, &'a [u32]),
}

/// Writes the blocks of a job.
struct Write<'a, 'b> {
    job: Job<'b>,
    source: &'a Source<'a>,
}

impl Kernel for Write<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        match self.job {
            Job::One(run, edges) => write_run::<L, 1, 1>(run, edges, self.source),
            Job::Two(run, edges) => write_run::<L, 2, 3>(run, edges, self.source),
            Job::Four(run, edges) => write_run::<L, 4, 10>(run, edges, self.source),
        }
    }
}

#[inline(always)]
fn write_run<L: Lanes, const N: usize, const T: usize>(
    run: Run<'_, N, T>,
    edges: &[u32],
    source: &Source<'_>,
) {
    for ((block, memory), edges) in run.blocks.iter_mut().zip(run.memory).zip(edges.chunks(WIDTH)) {
        let bounces = write::<L, N, T>(block, memory, edges, source);
        take_inertias::<L, N, T>(block, source.inverse);
        respond::<L, N, T>(block);
        memory.bounce = if bounces { MAY_BOUNCE } else { NONE };
    }
}

/// Writes the blocks of all classes.
fn write_all(
    (mut one, mut two, mut four): (Run<'_, 1, 1>, Run<'_, 2, 3>, Run<'_, 4, 10>),
    coloring: &Coloring,
    source: &Source<'_>,
    runner: &dyn TaskRunner,
) {
    let blocks = |edges: &[u32]| edges.len().div_ceil(WIDTH);
    let mut jobs = coloring.runs().flat_map(|[ones, twos, fours]| {
        [
            Job::One(one.take(blocks(ones)), ones),
            Job::Two(two.take(blocks(twos)), twos),
            Job::Four(four.take(blocks(fours)), fours),
        ]
    });
    loop {
        let mut some = [const { None }; MOST_NEAR];
        let mut count = 0;
        for (place, job) in some.iter_mut().zip(&mut jobs) {
            *place = Some(job);
            count += 1;
        }
        if count == 0 {
            return;
        }
        for_each_near(runner, &mut some[..count], |job| {
            if let Some(job) = job.take() {
                dispatch::run(Write { job, source });
            }
        });
    }
}

/// Placeholder for the bounce index of a block that may bounce.
const MAY_BOUNCE: u32 = 0;

impl<const N: usize, const T: usize> Class<N, T> {
    fn clear(&mut self) {
        self.count = 0;
        self.bounces.clear();
    }

    /// Reserves memory for `blocks` blocks and their bounces.
    fn make_room(&mut self, blocks: usize) {
        self.blocks.reserve(blocks.saturating_sub(self.blocks.len()));
        self.memory.reserve(blocks.saturating_sub(self.memory.len()));
        self.bounces.reserve(blocks);
    }

    /// Appends a block with unspecified contents.
    #[inline(always)]
    fn append(&mut self) -> usize {
        self.count += 1;
        if self.blocks.len() < self.count {
            // Reserve spare blocks for contacts that come and go, so that a settling pile does not allocate.
            self.blocks.reserve(SPARE_BLOCKS);
            self.memory.reserve(SPARE_BLOCKS);
            self.bounces.reserve(SPARE_BLOCKS);
            self.blocks.push(Block::empty());
            self.memory.push(Memory::empty());
        }
        self.count - 1
    }

    /// Appends blocks for `contacts` contacts. Returns their range.
    fn append_for(&mut self, contacts: usize) -> Range<usize> {
        let first = self.count;
        for _ in 0..contacts.div_ceil(WIDTH) {
            self.append();
        }
        first..self.count
    }

    /// Assigns bounce indices to the blocks that may bounce.
    fn list_bounces(&mut self) {
        for memory in self.memory[..self.count].iter_mut().filter(|memory| memory.bounce != NONE) {
            memory.bounce = self.bounces.len() as u32;
            self.bounces.push(Bounce::NONE);
        }
    }

    /// Lists the extra data of the contacts written to blocks from `first` on.
    fn list_extras(
        &mut self,
        class: u32,
        first: usize,
        run: &[u32],
        source: &Source<'_>,
        lists: &mut Lists<'_>,
    ) {
        for (place, edges) in (first..).zip(run.chunks(WIDTH)) {
            for (lane, &edge) in edges.iter().enumerate() {
                let edge = &source.edges[edge as usize];
                if edge.extra != NONE {
                    let at = [class, place as u32, lane as u32];
                    let block = &mut self.blocks[place];
                    block.rolling = lists.add(source, edge, at, block.rolling);
                }
            }
        }
    }
}

impl Lists<'_> {
    /// Adds the extra data of a contact. Returns the index of the block's rolling resistance.
    fn add(&mut self, source: &Source<'_>, edge: &Edge, at: [u32; 3], rolling: u32) -> u32 {
        let OfStep { view, bodies, moving, stretch, .. } = *source.of;
        let extra = &source.extras[edge.extra as usize];
        let bodies = edge.bodies.map(|body| &bodies[body as usize]);
        if extra.rolls {
            let manifold = view.contacts[edge.contact as usize].manifold;
            let cores = Cores::new(&manifold, bodies.map(|body| body.pose), extra.rounds);
            self.found.push(Found::new(at, edge, manifold, cores, REFRESH_TURN_RIM));
        }
        if extra.rolling <= 0.0 {
            return rolling;
        }
        let place = if rolling == NONE { self.rolling.len() as u32 } else { rolling };
        if rolling == NONE {
            self.rolling.push(Rolling::NONE);
        }
        let moves = edge.bodies.map(|body| (body as usize) < moving);
        let impulse = extra.impulse * stretch;
        write_rolling(
            &mut self.rolling[place as usize],
            at[2] as usize,
            extra.rolling,
            impulse,
            bodies,
            moves,
        );
        place
    }
}

/// The shapes of a contact, in their bodies' principal frames.
pub(in crate::solver) fn placed<'a>(view: &View<'a>, contact: &Contact) -> [Placed<'a>; 2] {
    let key = contact.key;
    [(key.a, key.shape_a), (key.b, key.shape_b)].map(|(body, shape)| {
        let shape = &view.bodies.at(body).shapes[shape as usize];
        Placed { shape: &shape.shape, principal_from_shape: &shape.principal_from_shape }
    })
}

pub(super) fn write_material<const N: usize, const T: usize>(
    block: &mut Block<N, T>,
    memory: &mut Memory<N>,
    lane: usize,
    material: &ContactMaterial,
    geometry: &Geometry,
) {
    block.sliding[lane] = material.friction;
    block.holding[lane] = material.static_friction;
    let [t0, t1] = geometry.tangents();
    block.surface[0][lane] = t0.dot(material.velocity);
    block.surface[1][lane] = t1.dot(material.velocity);
    block.surface[2][lane] = geometry.normal().dot(material.spin);
    memory.launch[lane] = material.launch;
    memory.restitution[lane] = material.restitution;
}

/// Writes the impulses of the last substep, and the sums of the step so far.
pub(super) fn write_impulses<const N: usize, const T: usize>(
    block: &mut Block<N, T>,
    memory: &mut Memory<N>,
    lane: usize,
    from: &ContactMemory,
    geometry: &Geometry,
) {
    for i in 0..N {
        let point = if i < MAX_POINTS { from.points[i] } else { Default::default() };
        block.impulse[i][lane] = point.now;
        memory.before[i][lane] = point.before;
        memory.total[i][lane] = 0.0;
        memory.lasting[i][lane] = point.lasting;
    }
    let tangents = geometry.tangents();
    for (k, tangent) in tangents.into_iter().enumerate() {
        block.friction[k][lane] = from.friction.dot(tangent);
        memory.total_friction[k][lane] = 0.0;
    }
    block.twist[lane] = from.twist;
    block.load[lane] = 0.0;
    block.last_load[lane] = 0.0;
}

fn write_rolling(
    rolling: &mut Rolling,
    lane: usize,
    lever: f32,
    impulse: Vec3,
    bodies: [&SolverBody; 2],
    moves: [bool; 2],
) {
    let mut response = Sym3::ZERO;
    for (body, _) in bodies.into_iter().zip(moves).filter(|(_, moves)| *moves) {
        response += body.inverse_inertia;
    }
    let inverse = response.inverse();
    rolling.lever[lane] = lever;
    rolling.trace[lane] = response.diagonal.x + response.diagonal.y + response.diagonal.z;
    let numbers = [inverse.diagonal.to_array(), inverse.off.to_array()];
    for (row, number) in rolling.inverse.iter_mut().zip(numbers.into_iter().flatten()) {
        row[lane] = number;
    }
    for (row, number) in rolling.impulse.iter_mut().zip(impulse.to_array()) {
        row[lane] = number;
    }
}

impl Rolling {
    /// Rolling resistance of lanes without resistance.
    const NONE: Self = Self { lever: ZERO8, inverse: [ZERO8; 6], trace: ZERO8, impulse: [ZERO8; 3] };
}
