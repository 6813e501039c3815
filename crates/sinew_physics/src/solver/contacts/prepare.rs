//! From the world's contacts to blocks: once a step.

use super::block::{Block, Bounce, HELD, Memory, NONE, Rolling, ZERO8};
use super::color::Edge;
use super::geometry::{Cores, Geometry};
use super::refind::{self, Found};
use super::{Class, Color, Contacts};
use crate::collide::MAX_POINTS;
use crate::contact::{Contact, ContactMemory, slop};
use crate::material::ContactMaterial;
use crate::solver::contact_rows::{Placed, Softness, contact_softness, weights};
use crate::solver::effort::Firmness;
use crate::solver::{SolverBody, View};
use core::ops::Range;
use sinew_math::lanes::WIDTH;
use sinew_math::{Sym3, Vec3, min};

/// Share of the slop that is left overlapping.
const DEAD_ZONE: f32 = 0.2;

/// Blocks for which there is room at once where another is needed.
pub(super) const SPARE_BLOCKS: usize = 8;

/// What an island's contacts are made from, when a step begins.
pub(in crate::solver) struct OfStep<'a> {
    pub view: &'a View<'a>,
    /// Those that move first, so many.
    pub bodies: &'a [SolverBody],
    pub moving: usize,
    /// Substep of the island, seconds, and how many times as long as the world's it is.
    pub h: f32,
    pub stretch: f32,
}

/// What lanes are written from.
struct Source<'a> {
    of: &'a OfStep<'a>,
    /// Softness between moving bodies, and against fixed ones.
    soft: [Softness; 2],
}

/// Two numbers of a contact's class: the most points of its blocks.
fn class_of(points: usize) -> u32 {
    match points {
        0 | 1 => 0,
        2 => 1,
        _ => 2,
    }
}

impl Contacts {
    /// Begins a list of contacts.
    pub fn clear(&mut self) {
        self.tally = Default::default();
        self.coloring.clear();
        self.colors.clear();
        self.found.clear();
        self.rolling.clear();
        self.one.clear();
        self.two.clear();
        self.four.clear();
    }

    /// Lists for so many bodies and contacts, also for an island that has none: memory goes on to the next.
    pub fn make_room(&mut self, bodies: usize, contacts: usize) {
        for list in [&mut self.inverse, &mut self.moved] {
            list.clear();
            list.reserve(bodies);
        }
        self.stir.clear();
        self.stir.reserve(bodies);
        self.colors.reserve(SPARE_BLOCKS);
        let blocks = usize::min(contacts, SPARE_BLOCKS);
        self.one.make_room(blocks);
        self.two.make_room(blocks);
        self.four.make_room(blocks);
        self.coloring.make_room(bodies, contacts);
    }

    /// Adds a contact of two local bodies.
    pub fn push(&mut self, contact: u32, bodies: [u32; 2], points: usize, firmness: Firmness) {
        self.tally.manifolds += 1;
        self.tally.points += points as u64;
        self.coloring.edges.push(Edge::new(contact, bodies, class_of(points), firmness));
    }

    /// Colours what was added and writes it to blocks. Gives whether a surface moves along its body, or throws off what touches it.
    pub fn prepare(&mut self, of: &OfStep<'_>) -> bool {
        if self.coloring.edges.is_empty() {
            return false;
        }
        self.found.reserve(SPARE_BLOCKS * WIDTH);
        self.rolling.reserve(SPARE_BLOCKS);
        let colors = self.coloring.color(of.moving) as usize;
        self.colors.resize(colors, Color::default());
        let soft = [true, false].map(|both_move| contact_softness(both_move, of.h));
        let source = Source { of, soft };
        let Self { one, two, four, colors, coloring, rolling, found, .. } = self;
        let mut color = usize::MAX;
        let mut into = Into { rolling, found, drives: false };
        for run in coloring.runs() {
            let [first, ..] = run else { continue };
            if first.color() as usize != color {
                color = first.color() as usize;
                // Classes that this colour has none of.
                let (one, two, four) = (one.count, two.count, four.count);
                colors[color] = Color { one: one..one, two: two..two, four: four..four };
            }
            let color = &mut colors[color];
            match first.class {
                0 => color.one = one.write(run, &source, 0, &mut into),
                1 => color.two = two.write(run, &source, 1, &mut into),
                _ => color.four = four.write(run, &source, 2, &mut into),
            }
        }
        let drives = into.drives;
        self.found.sort_unstable_by_key(Found::place);
        self.make_room_for_conjugate(of.bodies.len());
        self.take_inertias(of.bodies, of.moving);
        self.respond();
        drives
    }
}

/// Lists beside the blocks.
struct Into<'a> {
    rolling: &'a mut Vec<Rolling>,
    found: &'a mut Vec<Found>,
    /// A surface moves along its body, or throws off what touches it.
    drives: bool,
}

impl<const N: usize, const T: usize> Class<N, T> {
    fn clear(&mut self) {
        self.count = 0;
        self.bounces.clear();
    }

    /// For so many blocks and what may bounce in them.
    fn make_room(&mut self, blocks: usize) {
        self.blocks.reserve(blocks.saturating_sub(self.blocks.len()));
        self.memory.reserve(blocks.saturating_sub(self.memory.len()));
        self.bounces.reserve(blocks);
    }

    /// Appends blocks with the contacts of a run. Gives which blocks.
    fn write(&mut self, run: &[Edge], source: &Source<'_>, class: u32, into: &mut Into<'_>) -> Range<usize> {
        let first = self.count;
        for edges in run.chunks(WIDTH) {
            let place = self.count;
            self.count += 1;
            if self.blocks.len() < self.count {
                // Room for some that come and go, so that a pile which settles asks for no more.
                self.blocks.reserve(SPARE_BLOCKS);
                self.memory.reserve(SPARE_BLOCKS);
                self.bounces.reserve(SPARE_BLOCKS);
                self.blocks.push(Block::empty());
                self.memory.push(Memory::empty());
            }
            let (block, memory) = (&mut self.blocks[place], &mut self.memory[place]);
            (block.rolling, memory.bounce) = (NONE, NONE);
            for lane in 0..WIDTH {
                // Empty lanes repeat the last contact, and hold its bodies.
                let edge = &edges[usize::min(lane, edges.len() - 1)];
                let is_empty = lane >= edges.len();
                let written = Lane { source, edge, place: [class, place as u32, lane as u32], is_empty };
                written.write(block, memory, &mut self.bounces, into);
            }
        }
        first..self.count
    }
}

/// One contact on its way to a lane.
struct Lane<'a> {
    source: &'a Source<'a>,
    edge: &'a Edge,
    /// Class, block and lane.
    place: [u32; 3],
    is_empty: bool,
}

impl Lane<'_> {
    fn write<const N: usize, const T: usize>(
        &self,
        block: &mut Block<N, T>,
        memory: &mut Memory<N>,
        bounces: &mut Vec<Bounce<N>>,
        into: &mut Into<'_>,
    ) {
        let OfStep { view, bodies, moving, stretch, .. } = *self.source.of;
        let (contact, lane) = (&view.contacts[self.edge.contact as usize], self.place[2] as usize);
        let ends = self.edge.bodies;
        let moves = ends.map(|body| (body as usize) < moving);
        for end in 0..2 {
            let held = if moves[end] && !self.is_empty { 0 } else { HELD };
            block.bodies[end][lane] = ends[end] | held;
        }
        memory.contacts[lane] = if self.is_empty { NONE } else { self.edge.contact };
        let poses = ends.map(|body| &bodies[body as usize].pose);
        let shapes = placed(view, contact);
        let in_principal = |end: usize| poses[end].rotation.inverse() * contact.manifold.normal;
        let (mut rounds, mut rolls) = ([0.0; 2], false);
        for end in 0..2 {
            if shapes[end].is_curved() {
                rounds[end] = shapes[end].round(in_principal(end));
                rolls |= shapes[end].has_rim(in_principal(end));
            }
        }
        let slop = slop(min(shapes[0].shape.smallest_extent(), shapes[1].shape.smallest_extent()));
        let weights = weights(&contact.memory, &contact.manifold, if rolls { slop } else { f32::INFINITY });
        let centers = poses.map(|pose| pose.translation);
        let geometry = Geometry::of_manifold(&contact.manifold, centers, rounds, moves, &weights);
        geometry.write(block, memory, lane);
        self.write_softness(block, memory, slop);
        let material = view.modifiers.material(view.bodies, view.contacts, self.edge.contact);
        write_material(block, memory, lane, &material, &geometry);
        let kept = contact.memory.of_substeps(stretch);
        write_impulses(block, memory, lane, &kept, &geometry);
        if self.is_empty {
            return;
        }
        if material.restitution > 0.0 && memory.bounce == NONE {
            memory.bounce = bounces.len() as u32;
            bounces.push(Bounce::NONE);
        }
        if material.rolling > 0.0 {
            if block.rolling == NONE {
                block.rolling = into.rolling.len() as u32;
                into.rolling.push(Rolling::NONE);
            }
            let rolling = &mut into.rolling[block.rolling as usize];
            write_rolling(
                rolling,
                lane,
                &material,
                kept.rolling,
                ends.map(|body| &bodies[body as usize]),
                moves,
            );
        }
        into.drives |= material.drives();
        if rolls {
            let cores = Cores::new(&contact.manifold, poses.map(|pose| *pose), rounds);
            into.found.push(Found::new(self.place, self.edge, contact.manifold, cores, refind::ROLL_TURN));
        }
    }

    fn write_softness<const N: usize, const T: usize>(
        &self,
        block: &Block<N, T>,
        memory: &mut Memory<N>,
        slop: f32,
    ) {
        let lane = self.place[2] as usize;
        let (firmness, soft) = (self.edge.firmness, &self.source.soft);
        let both_move = block.bodies.iter().all(|bodies| bodies[lane] & HELD == 0);
        let soft = if both_move { &soft[0] } else { &soft[1] };
        memory.dead_zone[lane] = DEAD_ZONE * slop;
        memory.bias_rate[lane] = soft.bias_rate;
        memory.push_speed[lane] = firmness.push_speed;
        // Of the mean response of the points: its sum is divided here.
        memory.softness[lane] = firmness.softness * soft.impulse_scale / soft.mass_scale / (N * N) as f32;
    }
}

/// The shapes of a contact, in their bodies' principal frames.
pub(super) fn placed<'a>(view: &View<'a>, contact: &Contact) -> [Placed<'a>; 2] {
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

/// Impulses of the last substep, and sums of the step so far.
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
    material: &ContactMaterial,
    impulse: Vec3,
    bodies: [&SolverBody; 2],
    moves: [bool; 2],
) {
    let mut response = Sym3::ZERO;
    for (body, _) in bodies.into_iter().zip(moves).filter(|(_, moves)| *moves) {
        response += body.inverse_inertia;
    }
    let inverse = response.inverse();
    rolling.lever[lane] = material.rolling;
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
    /// Of lanes that do not resist.
    const NONE: Self = Self { lever: ZERO8, inverse: [ZERO8; 6], trace: ZERO8, impulse: [ZERO8; 3] };
}
