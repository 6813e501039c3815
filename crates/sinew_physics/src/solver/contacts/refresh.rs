//! Recomputes the manifolds of fast-turning bodies within the step, and writes them to their lanes.

use super::Contacts;
use super::block::{Block, HELD, Memory};
use super::color::Edge;
use super::geometry::{Cores, Geometry};
use super::prepare::{placed, write_impulses, write_material};
use super::store::memory_of;
use crate::collide::{MAX_POINTS, Manifold};
use crate::contact::slop;
use crate::runner::TaskRunner;
use crate::slices::for_each_mut;
use crate::solver::body::SolverBody;
use crate::solver::contact_rows::{Placed, found_anew, margin, weights};
use crate::solver::contacts::classes::Class;
use crate::solver::tuning::{REFRESH_TURN_LANES, REFRESH_TURN_LED, REFRESH_TURN_RIM};
use crate::solver::view::View;
use crate::spatial::{Vec6, angular, linear};
use sinew_math::lanes::WIDTH;
use sinew_math::{Transform, max, min};

/// A manifold whose lane is rewritten in each substep.
#[derive(Clone, Debug)]
pub(super) struct Found {
    /// Class, block and lane.
    place: [u32; 3],
    contact: u32,
    /// Local indices of the bodies.
    bodies: [u32; 2],
    manifold: Manifold,
    cores: Cores,
    /// The manifold is recomputed when a body has turned by more than this since the last time, radians.
    most_turn: f32,
    /// Turn of the faster body from the step's beginning to the last computation, radians.
    turned: f32,
    /// Manifold recomputed in this substep and not yet written.
    anew: Option<Manifold>,
}

impl Found {
    pub fn new(place: [u32; 3], edge: &Edge, manifold: Manifold, cores: Cores, most_turn: f32) -> Self {
        Self {
            place,
            contact: edge.contact,
            bodies: edge.bodies,
            manifold,
            cores,
            most_turn,
            turned: 0.0,
            anew: None,
        }
    }
}

/// Bodies after a substep.
pub(in crate::solver) struct Substep<'a> {
    pub view: &'a View<'a>,
    pub bodies: &'a [SolverBody],
    /// Poses at the start of the step.
    pub starts: &'a [Transform],
    pub velocities: &'a [Vec6],
    pub moving: usize,
    pub h: f32,
    pub runner: &'a dyn TaskRunner,
}

impl Substep<'_> {
    /// Angle by which a body turns in this substep, radians.
    fn turn(&self, body: u32) -> f32 {
        angular(&self.velocities[body as usize]).length() * self.h
    }
}

impl Contacts {
    /// Updates the contacts to the present poses: computes separations and recomputes the manifolds of fast-turning bodies.
    pub fn place(&mut self, substep: &Substep<'_>) {
        if self.is_empty() {
            return;
        }
        self.measure(substep.bodies, substep.starts, substep.runner);
        self.find_fast(substep);
        if self.found.is_empty() && !self.is_spoiled {
            return;
        }
        let mut found = core::mem::take(&mut self.found);
        for_each_mut(substep.runner, &mut found, |one| one.look(&self.turned, substep));
        for one in &mut found {
            match one.place[0] {
                0 => one.update(&mut self.one, &self.rolling, substep),
                1 => one.update(&mut self.two, &self.rolling, substep),
                _ => one.update(&mut self.four, &self.rolling, substep),
            }
        }
        self.found = found;
        self.take_inertias(substep.bodies, substep.moving);
        self.respond(substep.runner);
    }

    /// Lists the contacts of bodies that turn fast for the first time.
    fn find_fast(&mut self, substep: &Substep<'_>) {
        for (turned, body) in self.turned.iter_mut().zip(0..) {
            let turn = substep.turn(body);
            // The manifold of the step's beginning is accurate enough for slowly turning kinematic bodies, such as
            // limbs moved by clips.
            if (body as usize) < substep.moving || turn >= REFRESH_TURN_LED {
                *turned += turn;
            }
        }
        if !self.turned.iter().any(|&turned| turned >= REFRESH_TURN_LANES) {
            return;
        }
        let known = self.found.len();
        self.one.find_fast(0, substep, &self.turned, known, &mut self.found);
        self.two.find_fast(1, substep, &self.turned, known, &mut self.found);
        self.four.find_fast(2, substep, &self.turned, known, &mut self.found);
        self.found.sort_unstable_by_key(Found::place);
    }
}

impl<const N: usize, const T: usize> Class<N, T> {
    /// Adds contacts of fast-turning bodies to the list, the first `known` entries of which are sorted.
    fn find_fast(
        &self,
        class: u32,
        substep: &Substep<'_>,
        turned: &[f32],
        known: usize,
        found: &mut Vec<Found>,
    ) {
        for place in 0..self.count {
            for lane in 0..WIDTH {
                let (block, contact) = (&self.blocks[place], self.memory[place].contacts[lane]);
                let bodies = [0, 1].map(|end| block.bodies[end][lane] & !HELD);
                if contact == super::block::NONE
                    || bodies.iter().all(|&body| turned[body as usize] < REFRESH_TURN_LANES)
                {
                    continue;
                }
                let at = [class, place as u32, lane as u32];
                if found[..known].binary_search_by_key(&at, Found::place).is_ok() {
                    continue;
                }
                let of = &substep.view.contacts[contact as usize];
                if of.key.is_through_particles() {
                    continue;
                }
                let starts = bodies.map(|body| substep.starts[body as usize]);
                let cores =
                    Cores::new(&of.manifold, starts, rounds(substep.view, contact, starts, &of.manifold));
                found.push(Found {
                    place: at,
                    contact,
                    bodies,
                    manifold: of.manifold,
                    cores,
                    most_turn: REFRESH_TURN_LANES,
                    turned: 0.0,
                    anew: None,
                });
            }
        }
    }
}

/// Slop of two shapes, metres.
fn slop_of(shapes: &[Placed<'_>; 2]) -> f32 {
    slop(min(shapes[0].shape.smallest_extent(), shapes[1].shape.smallest_extent()))
}

/// Radii of the roundings of a contact's shapes at the contact.
fn rounds(view: &View<'_>, contact: u32, poses: [Transform; 2], manifold: &Manifold) -> [f32; 2] {
    let shapes = placed(view, &view.contacts[contact as usize]);
    [0, 1].map(|end: usize| shapes[end].round(poses[end].rotation.inverse() * manifold.normal))
}

impl Found {
    /// Recomputes the contact if a body turned fast in this substep: the points of the step's beginning do not include a corner that swings
    /// in.
    fn look(&mut self, turned: &[f32], substep: &Substep<'_>) {
        let turned = self.bodies.iter().fold(0.0, |most, &body| max(most, turned[body as usize]));
        if turned - self.turned < self.most_turn {
            return;
        }
        self.turned = turned;
        let poses = self.bodies.map(|body| substep.bodies[body as usize].pose);
        let contact = &substep.view.contacts[self.contact as usize];
        let shapes = placed(substep.view, contact);
        let on_surfaces = [0, 1].map(|end: usize| poses[end].point(self.cores.points[end][0]));
        let margin = self.margin(substep, &shapes, slop_of(&shapes));
        self.anew = found_anew(shapes, poses, margin, &self.manifold, on_surfaces);
    }

    /// Writes the present contact to its lane. Matches impulses by feature. A pair that has separated keeps its rows.
    fn update<const N: usize, const T: usize>(
        &mut self,
        class: &mut Class<N, T>,
        rolling: &[super::Rolling],
        substep: &Substep<'_>,
    ) {
        let [_, place, lane] = self.place.map(|number| number as usize);
        let poses = self.bodies.map(|body| substep.bodies[body as usize].pose);
        let (block, memory) = (&mut class.blocks[place], &mut class.memory[place]);
        let contact = &substep.view.contacts[self.contact as usize];
        let shapes = placed(substep.view, contact);
        let mut of_lane = memory_of(block, memory, rolling, lane, 1.0);
        if let Some(manifold) = self.anew.take() {
            let manifold = fitted(&manifold, N);
            of_lane = of_lane.matched(&self.manifold, &manifold);
            if memory.bounce != super::block::NONE {
                let bounce = &mut class.bounces[memory.bounce as usize];
                carry_rebounds(&mut bounce.rebound, lane, &self.manifold, &manifold);
            }
            self.manifold = manifold;
            self.cores = Cores::new(&manifold, poses, rounds(substep.view, self.contact, poses, &manifold));
        }
        let in_principal = |end: usize| poses[end].rotation.inverse() * self.cores.normal;
        let rolls = shapes[0].has_rim(in_principal(0)) || shapes[1].has_rim(in_principal(1));
        self.most_turn = if rolls { REFRESH_TURN_RIM } else { REFRESH_TURN_LANES };
        let weights = weights(&of_lane, &self.manifold, if rolls { slop_of(&shapes) } else { f32::INFINITY });
        let moves = self.bodies.map(|body| (body as usize) < substep.moving);
        let geometry = Geometry::new(&self.cores, poses, moves, &weights);
        self.write(block, memory, &geometry, &of_lane, substep);
    }

    fn write<const N: usize, const T: usize>(
        &self,
        block: &mut Block<N, T>,
        memory: &mut Memory<N>,
        geometry: &Geometry,
        of_lane: &crate::contact::ContactMemory,
        substep: &Substep<'_>,
    ) {
        let lane = self.place[2] as usize;
        let (loads, totals) = ([block.load[lane], block.last_load[lane]], of_lane.total_friction);
        geometry.write(block, memory, lane);
        let view = substep.view;
        let material = view.modifiers.material(view.bodies, view.contacts, self.contact);
        write_material(block, memory, lane, &material, geometry);
        write_impulses(block, memory, lane, of_lane, geometry);
        [block.load[lane], block.last_load[lane]] = loads;
        for (i, point) in of_lane.points.iter().enumerate().take(N) {
            memory.total[i][lane] = point.total;
        }
        for (k, tangent) in geometry.tangents().into_iter().enumerate() {
            memory.total_friction[k][lane] = totals.dot(tangent);
        }
    }

    /// Largest separation of points that may touch within this substep, metres.
    fn margin(&self, substep: &Substep<'_>, shapes: &[Placed<'_>; 2], slop: f32) -> f32 {
        let [a, b] = self.bodies.map(|body| linear(&substep.velocities[body as usize]));
        let turns = self.bodies.map(|body| substep.turn(body));
        margin(shapes, turns, (b - a).length() * substep.h, slop)
    }

    pub fn place(&self) -> [u32; 3] {
        self.place
    }

    pub fn class(&self) -> u32 {
        self.place[0]
    }

    pub fn contact(&self) -> u32 {
        self.contact
    }

    /// Manifold that was computed last.
    pub fn manifold(&self) -> Manifold {
        self.manifold
    }
}

/// Selects the deepest points of a manifold, at most as many as the lane has room for.
fn fitted(manifold: &Manifold, room: usize) -> Manifold {
    if manifold.count <= room {
        return *manifold;
    }
    let mut points = manifold.points;
    points[..manifold.count].sort_by(|p, q| p.separation.total_cmp(&q.separation));
    let mut fitted = Manifold { count: room, ..*manifold };
    fitted.points[..room].copy_from_slice(&points[..room]);
    fitted
}

/// Matches rebound speeds by feature; new points get the mean.
fn carry_rebounds<const N: usize>(
    rebounds: &mut [[f32; WIDTH]; N],
    lane: usize,
    old: &Manifold,
    new: &Manifold,
) {
    let count = usize::min(old.count, N);
    let mut was = [0.0; MAX_POINTS];
    for i in 0..count {
        was[i] = rebounds[i][lane];
    }
    let mean = was[..count].iter().sum::<f32>() / usize::max(count, 1) as f32;
    for i in 0..usize::min(new.count, N) {
        let known = old.points().iter().position(|point| point.feature == new.points[i].feature);
        rebounds[i][lane] = known.map_or(mean, |k| was[k]);
    }
}
