//! Self-collision: particles of a group without a common spring keep the group's thickness as distance.
//!
//! Pairs come from a list that is valid while no particle has moved by half of the list's margin (Verlet 1967). Excess
//! pairs have no effect, and the list is in the order of its particles. The results therefore equal those of testing
//! all pairs, bit for bit, and the list is not part of the state. Each pair is a row that only presses along the line
//! between its particles, on the side at the start of the iteration. Particles that move by more than their distance
//! within an iteration pass through.
//!
//! Layers that carry a load are thousands of times lighter than the load: rows that share impulses by mass let the load
//! through. Layers on an immovable obstacle are therefore solved from the obstacle outward, and a particle yields to a
//! load from above only as far as its support allows (shock propagation: Guendelman, Bridson and Fedkiw, "Nonconvex
//! Rigid Bodies with Stacking", 2003). The layers transmit the pressing impulse to the surface at the bottom, and
//! friction between layers uses all of the impulse. Impulses from below are shared by mass: a light particle that did
//! not yield would push with momentum that it does not have.

use super::tuning::{BEARING, SELF_PUSH_SPEED, SELF_ROOM, SELF_SWEEPS};
use super::{ParticleGroup, SpringDef};
use sinew_math::{Vec3, max, min, normalize_or};

/// Pairs of particles that may touch, and their search.
#[derive(Clone, Debug, Default)]
pub(super) struct SelfCollision {
    /// Distance between the particles of a pair, metres.
    thickness: f32,
    /// Particles connected to each particle by a spring.
    joined: Lists,
    /// Particles within reach of each particle.
    near: Lists,
    /// Pairs within reach, both ways, ascending.
    pairs: Vec<[u32; 2]>,
    /// Particles by the hash of their cell, ascending.
    cells: Vec<(u64, u32)>,
    /// Position of each particle at the last pair search, world, metres; empty before the first.
    found_at: Vec<Vec3>,
    /// Particles in the solving order of their pairs: each after its support.
    order: Vec<u32>,
    /// Number of particles in that order whose pairs have been started.
    next: usize,
    /// State of each particle in the order.
    turns: Vec<Turn>,
    /// Normal of each particle's support: of unit length once the particle is processed, before that the sum over all
    /// its supports.
    supports: Vec<Vec3>,
    /// Length of the sum of each particle's support normals.
    bearing: Vec<f32>,
    /// Displacement in the iteration of the surface that finally supports each particle, metres.
    ways: Vec<Vec3>,
    /// Coefficient of friction of that surface.
    grips: Vec<f32>,
    /// Impulse pressed into each particle and transmitted to its support, N·s.
    loads: Vec<f32>,
    /// Pairs that touch, in the order in which they are solved.
    rows: Vec<Row>,
}

/// State of a particle in the order in which pairs are solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Turn {
    /// The particle has no known support.
    Loose,
    /// The particle is in the solving order.
    Listed,
    /// The pairs of the particle are solved.
    Done,
}

/// Two particles that touch.
#[derive(Clone, Copy, Debug)]
struct Row {
    below: u32,
    above: u32,
    /// Normal from the lower particle to the upper one, unit length.
    normal: Vec3,
    /// Part of the impulse on the lower particle that its support takes, outward.
    held: Vec3,
    /// Target distance along the normal, metres.
    goal: f32,
    /// Impulse, N·s.
    impulse: f32,
}

/// A list for each particle, contiguous in memory.
#[derive(Clone, Debug, Default)]
struct Lists {
    items: Vec<u32>,
    /// End of each list.
    ends: Vec<usize>,
}

impl Lists {
    /// Fills the lists from ascending pairs: the second particle of a pair goes into the list of the first.
    fn fill(&mut self, count: usize, pairs: &[[u32; 2]]) {
        self.items.clear();
        self.items.extend(pairs.iter().map(|pair| pair[1]));
        self.ends.clear();
        self.ends.resize(count, 0);
        for &[a, _] in pairs {
            self.ends[a as usize] += 1;
        }
        let mut end = 0;
        for count in &mut self.ends {
            end += *count;
            *count = end;
        }
    }

    fn of(&self, i: u32) -> &[u32] {
        let start = if i == 0 { 0 } else { self.ends[i as usize - 1] };
        &self.items[start..self.ends[i as usize]]
    }
}

impl SelfCollision {
    /// Creates the search for `count` particles with these springs at a distance of `thickness` metres.
    pub fn new(count: usize, thickness: f32, springs: &[SpringDef]) -> Self {
        let mut both: Vec<[u32; 2]> = springs.iter().map(|s| [s.a, s.b]).collect();
        both.extend(both.clone().into_iter().map(|[a, b]| [b, a]));
        both.sort_unstable();
        both.dedup();
        let mut own = Self { thickness, turns: vec![Turn::Loose; count], ..Self::default() };
        own.joined.fill(count, &both);
        (own.supports, own.ways) = (vec![Vec3::ZERO; count], vec![Vec3::ZERO; count]);
        (own.bearing, own.loads, own.grips) = (vec![0.0; count], vec![0.0; count], vec![0.0; count]);
        own.order = Vec::with_capacity(count);
        own
    }

    /// True if no particle has moved by half of the list's margin.
    fn holds(&self, positions: &[Vec3]) -> bool {
        let most = 0.5 * SELF_ROOM * self.thickness;
        let mut ways = self.found_at.iter().zip(positions);
        self.found_at.len() == positions.len()
            && ways.all(|(from, to)| (*to - *from).length_squared() < most * most)
    }

    /// Finds all pairs within reach.
    fn find(&mut self, positions: &[Vec3]) {
        let reach = (1.0 + SELF_ROOM) * self.thickness;
        self.found_at.clear();
        self.found_at.extend_from_slice(positions);
        self.cells.clear();
        self.cells.extend((0_u32..).zip(positions).map(|(i, &p)| (cell(coordinates(p, reach)), i)));
        self.cells.sort_unstable();
        let mut pairs = core::mem::take(&mut self.pairs);
        pairs.clear();
        for (i, &position) in (0_u32..).zip(positions) {
            let center = coordinates(position, reach);
            for neighbor in 0..27 {
                let shift = [neighbor % 3 - 1, neighbor / 3 % 3 - 1, neighbor / 9 - 1];
                let key = cell([0, 1, 2].map(|axis: usize| center[axis].wrapping_add(shift[axis])));
                let from = self.cells.partition_point(|&(other, _)| other < key);
                let others = self.cells[from..].iter().take_while(|&&(other, _)| other == key);
                for &(_, j) in others.filter(|&&(_, j)| j != i) {
                    let near = (positions[j as usize] - position).length_squared() < reach * reach;
                    if near && self.joined.of(i).binary_search(&j).is_err() {
                        pairs.push([i, j]);
                    }
                }
            }
        }
        pairs.sort_unstable();
        // Different cells may have the same hash.
        pairs.dedup();
        self.near.fill(positions.len(), &pairs);
        self.rows.clear();
        self.rows.reserve(pairs.len() / 2);
        self.pairs = pairs;
    }

    /// Clears the data of the last iteration.
    fn begin(&mut self) {
        self.order.clear();
        self.rows.clear();
        self.next = 0;
        self.turns.fill(Turn::Loose);
        self.supports.fill(Vec3::ZERO);
        self.bearing.fill(0.0);
        self.loads.fill(0.0);
        self.ways.fill(Vec3::ZERO);
        self.grips.fill(0.0);
    }

    fn list(&mut self, i: u32) {
        self.turns[i as usize] = Turn::Listed;
        self.order.push(i);
    }

    fn take_turn(&mut self, i: usize) {
        self.turns[i] = Turn::Done;
        self.supports[i] = normalize_or(self.supports[i], Vec3::ZERO);
    }

    /// Stores a touching pair. If the lower particle has a support, it supports the upper one.
    fn bear(&mut self, row: Row) {
        self.rows.push(row);
        let above = row.above as usize;
        if self.supports[row.below as usize].dot(row.normal) <= BEARING {
            return;
        }
        // A particle that already touches a surface keeps that surface as its support.
        if self.turns[above] == Turn::Loose {
            self.list(row.above);
            self.ways[above] = self.ways[row.below as usize];
            self.grips[above] = self.grips[row.below as usize];
        }
        self.supports[above] += row.normal;
        self.bearing[above] = self.supports[above].length();
    }
}

/// Coordinates of the cell of a point.
fn coordinates(point: Vec3, size: f32) -> [i32; 3] {
    point.to_array().map(|x| (x / size).floor() as i32)
}

/// Hash of a cell: 21 bits per coordinate.
fn cell(coordinates: [i32; 3]) -> u64 {
    coordinates.into_iter().fold(0, |number, c| number << 21 | u64::from(c as u32 & 0x1f_ffff))
}

impl ParticleGroup {
    /// Distance between particles without a common spring, metres; 0 if there is no self-collision.
    pub fn thickness(&self) -> f32 {
        self.self_collision.as_ref().map_or(0.0, |own| own.thickness)
    }

    /// Pushes particles of the group apart that would overlap at the end of the iteration.
    pub(super) fn part_particles(&mut self, h: f32) {
        let Some(mut own) = self.self_collision.take() else { return };
        if !own.holds(&self.positions) {
            own.find(&self.positions);
        }
        own.begin();
        // Particles on immovable obstacles come first, then those on movable bodies, then the rest.
        for fixed in [true, false] {
            self.list_first(&mut own, fixed);
            self.part_listed(&mut own, h);
        }
        for i in 0..self.positions.len() as u32 {
            if own.turns[i as usize] == Turn::Loose {
                own.list(i);
                self.part_listed(&mut own, h);
            }
        }
        for _ in 1..SELF_SWEEPS {
            for row in &mut own.rows {
                self.press(row, h);
            }
        }
        self.hand_down(&mut own);
        self.rub_pairs(&own, h);
        self.push_out(&own, h);
        self.self_collision = Some(own);
    }

    /// Lists the particles that touch fixed surfaces (`fixed`), or those that touch movable bodies.
    fn list_first(&self, own: &mut SelfCollision, fixed: bool) {
        for &i in &self.solved {
            let at = i as usize;
            let Some(touch) = &self.touches[at] else { continue };
            let backing = self.backings[at];
            if backing > 0.0 && (backing >= 1.0) == fixed && own.turns[at] == Turn::Loose {
                own.supports[at] = self.press_normals[at];
                own.ways[at] = self.placed[touch.obstacle].displacement(touch.point);
                own.grips[at] = touch.material.friction;
                own.list(i);
            }
        }
    }

    /// Solves the pairs of all listed particles in order, and then those of the particles that they support.
    fn part_listed(&mut self, own: &mut SelfCollision, h: f32) {
        while let Some(&i) = own.order.get(own.next) {
            own.next += 1;
            own.take_turn(i as usize);
            for k in 0..own.near.of(i).len() {
                let j = own.near.of(i)[k];
                if own.turns[j as usize] != Turn::Done {
                    self.part(own, i, j, h);
                }
            }
        }
    }

    /// Pushes a particle off one that is processed, and records whether that one supports it.
    fn part(&mut self, own: &mut SelfCollision, below: u32, above: u32, h: f32) {
        let (b, a) = (below as usize, above as usize);
        let apart = self.positions[a] - self.positions[b];
        if apart.length_squared() >= own.thickness * own.thickness {
            return;
        }
        let before = self.previous[a] - self.previous[b];
        // Pairs that would have passed each other return to their previous sides.
        let side = if apart.dot(before) > 0.0 { apart } else { before };
        let normal = normalize_or(side, normalize_or(apart, Vec3::Y));
        // Only loads from above meet an unyielding support: impulses from below would push with momentum that does not
        // exist.
        let way = |i: usize| (self.positions[i] - self.previous[i] - own.ways[b]).dot(normal);
        let (fallen, risen) = (max(-way(a), 0.0), max(way(b), 0.0));
        // A particle without a support below that is pressed from above shares the load by mass.
        let is_borne = own.bearing[b] > 0.0 && fallen > 0.0;
        let share = if is_borne { fallen / (fallen + risen) } else { 0.0 };
        let held = own.supports[b] * (share * max(normal.dot(own.supports[b]), 0.0));
        // A body is lifted out by the pressing impulse; the remaining overlap is resolved without lasting velocity.
        let out = if self.lifts(a) { SELF_PUSH_SPEED * h } else { 0.0 };
        let goal = min(own.thickness, before.length() + out);
        let mut row = Row { below, above, normal, held, goal, impulse: 0.0 };
        self.press(&mut row, h);
        own.bear(row);
    }

    /// True if a particle touches a movable body, which the pressing impulse lifts.
    fn lifts(&self, i: usize) -> bool {
        self.backings[i] > 0.0 && self.backings[i] < 1.0
    }

    /// Moves the two particles of a row to their distance; the total impulse never pulls.
    fn press(&mut self, row: &mut Row, h: f32) {
        let (below, above) = (row.below as usize, row.above as usize);
        let missing = row.goal - (self.positions[above] - self.positions[below]).dot(row.normal);
        let ends = [(below, row.held - row.normal), (above, row.normal)];
        let (change, _) = self.row_impulse(&ends.into_iter(), missing / h, 0.0);
        let change = max(change, -row.impulse);
        row.impulse += change;
        for (i, force) in ends {
            self.nudge(i, force * change, h);
        }
    }

    /// Transmits each particle's pressing impulse to its support.
    fn hand_down(&mut self, own: &mut SelfCollision) {
        for row in own.rows.iter_mut().rev() {
            let (below, above) = (row.below as usize, row.above as usize);
            let along = max(row.normal.dot(own.supports[above]), 0.0);
            let share = if own.bearing[above] > 0.0 { along / own.bearing[above] } else { 0.0 };
            let carried = own.loads[above] * share;
            let into = max(row.normal.dot(own.supports[below]), 0.0);
            if own.bearing[below] == 0.0 {
                self.rooms[below] -= carried * into;
            } else {
                own.loads[below] += row.impulse * row.held.dot(own.supports[below]) + carried * into;
            }
            row.impulse += carried;
        }
    }

    /// Applies friction to pairs, by the total pressing impulse, from the surfaces outward.
    fn rub_pairs(&mut self, own: &SelfCollision, h: f32) {
        for row in &own.rows {
            let (below, above) = (row.below as usize, row.above as usize);
            let relative = self.velocities[above] - self.velocities[below];
            let slip = relative - row.normal * relative.dot(row.normal);
            let along = normalize_or(slip, Vec3::ZERO);
            let limit = self.material.friction * row.impulse;
            let weights = [self.weights[below], self.weights[above]];
            if limit <= 0.0 || weights[1] <= 0.0 {
                continue;
            }
            // The ground takes the upper particle's impulse, up to the friction of the supports between them.
            let ground = own.ways[below] / h;
            let brought = max((self.velocities[above] - ground).dot(along), 0.0);
            let met = max((ground - self.velocities[below]).dot(along), 0.0);
            let is_borne = own.bearing[below] > 0.0 && brought > 0.0;
            let share = if is_borne { brought / (brought + met) } else { 0.0 };
            let grip = min(own.grips[below], self.material.friction) * row.impulse;
            let held = min(slip.length() * share / weights[1], grip);
            self.nudge(above, along * -held, h);
            let left = max(slip.length() - held * weights[1], 0.0) / (weights[0] + weights[1]);
            let shared = along * min(left, max(limit - held, 0.0));
            self.nudge(above, -shared, h);
            self.nudge(below, shared, h);
        }
    }

    /// Resolves overlaps slowly, without lasting velocity.
    fn push_out(&mut self, own: &SelfCollision, h: f32) {
        for row in &own.rows {
            let (below, above) = (row.below as usize, row.above as usize);
            let apart = self.positions[above] - self.positions[below];
            let out = min(own.thickness - apart.dot(row.normal), SELF_PUSH_SPEED * h);
            let support = if own.bearing[below] > 0.0 { own.supports[below] } else { Vec3::ZERO };
            let yielding = support * max(row.normal.dot(support), 0.0) - row.normal;
            let weights = [self.weights[below], self.weights[above]];
            let sum = weights[0] * yielding.length_squared() + weights[1];
            if out > 0.0 && sum > 0.0 && !self.lifts(above) {
                self.positions[below] += yielding * (out / sum * weights[0]);
                self.positions[above] += row.normal * (out / sum * weights[1]);
            }
        }
    }
}
