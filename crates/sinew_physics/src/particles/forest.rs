//! Trees of springs, and the linear system of a step over them.
//!
//! Unknown are the velocities at the end of the step: `(M + h² K + h D) v⁺ = M v + h f` (Baraff & Witkin 1998), with
//! the axial stiffness `k n nᵀ`, the geometric stiffness `k max(0, 1 − L₀/L) (I − n nᵀ)` and the axial damping of
//! each spring. A spring adds one 3×3 block between its particles; where springs form trees, elimination from the
//! leaves to the root fills nothing in and the solution is exact in linear time. At rest the right-hand side is
//! zero, so that a chain hangs exactly where its forces balance, whatever the length of the step.

use super::hub::Hub;
use super::{Resists, SpringDef};
use crate::id::BodyId;
use crate::particles::tuning::LENGTH_TOLERANCE;
use sinew_math::{Sym3, Vec3, max};

/// Rounds of Newton's method until springs have to be where they were foreseen.
const NEWTON_ROUNDS: u32 = 16;
/// Times that a round is halved.
const HALVINGS: u32 = 8;
/// Rounding of the energy that it lowers, as a share of the terms in it.
const MERIT_ROUNDING: f64 = 1e-7;

/// The spring between a particle and the next one toward the root.
#[derive(Clone, Copy, Debug)]
struct Link {
    child: u32,
    parent: u32,
    spring: u32,
}

/// A spring between a particle and one that is held in the world.
#[derive(Clone, Copy, Debug)]
struct Tie {
    particle: u32,
    held: u32,
    spring: u32,
}

/// The springs of a group, sorted by how they are solved.
#[derive(Clone, Debug, Default)]
pub(super) struct Forest {
    /// From the leaves to the roots.
    links: Vec<Link>,
    roots: Vec<u32>,
    ties: Vec<Tie>,
    /// Springs that are projected, not solved: those that would close a loop.
    loops: Vec<u32>,
    /// Particles that each body holds, and the hub of each particle.
    hubs: Vec<Vec<u32>>,
    hub_of: Vec<usize>,
}

/// Holder of a particle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Holder {
    Nothing,
    World,
    Body(BodyId),
}

/// Number of the hub of a particle that no body holds.
pub(super) const NO_HUB: usize = usize::MAX;

/// True if a spring between what these hold cannot change its length.
fn is_rigid([a, b]: [Holder; 2]) -> bool {
    a == b && a != Holder::Nothing
}

impl Forest {
    /// All springs projected, none solved: each particle is a tree of its own.
    pub fn without_trees(springs: &[SpringDef], holders: &[Holder]) -> Self {
        let ends = |k: u32| [springs[k as usize].a, springs[k as usize].b].map(|i| holders[i as usize]);
        Self {
            roots: (0..holders.len() as u32).filter(|&i| holders[i as usize] != Holder::World).collect(),
            loops: (0..springs.len() as u32).filter(|&k| !is_rigid(ends(k))).collect(),
            ..Self::with_hubs(holders)
        }
    }

    /// No springs yet.
    fn with_hubs(holders: &[Holder]) -> Self {
        let mut forest = Self { hub_of: vec![NO_HUB; holders.len()], ..Self::default() };
        let mut bodies: Vec<BodyId> = Vec::new();
        for (i, holder) in holders.iter().enumerate() {
            let Holder::Body(body) = *holder else { continue };
            let hub = bodies.iter().position(|&other| other == body).unwrap_or_else(|| {
                bodies.push(body);
                forest.hubs.push(Vec::new());
                bodies.len() - 1
            });
            forest.hubs[hub].push(i as u32);
            forest.hub_of[i] = hub;
        }
        forest
    }

    /// A spanning forest in order of indices. Particles held in the world carry no motion, so trees end at them; those that one body holds are
    /// one node.
    pub fn new(springs: &[SpringDef], holders: &[Holder]) -> Self {
        let mut forest = Self::with_hubs(holders);
        let mut touching: Vec<Vec<u32>> = vec![Vec::new(); holders.len()];
        for (index, s) in springs.iter().enumerate() {
            let index = index as u32;
            match [s.a, s.b].map(|i| holders[i as usize]) {
                ends if is_rigid(ends) => {}
                [Holder::World, _] => forest.ties.push(Tie { particle: s.b, held: s.a, spring: index }),
                [_, Holder::World] => forest.ties.push(Tie { particle: s.a, held: s.b, spring: index }),
                _ => {
                    touching[s.a as usize].push(index);
                    touching[s.b as usize].push(index);
                    forest.loops.push(index);
                }
            }
        }
        let mut reached: Vec<bool> = holders.iter().map(|&holder| holder == Holder::World).collect();
        let mut in_tree = vec![false; springs.len()];
        let mut frontier = Vec::new();
        // What a body gathers as a root is all that the group brings to it.
        let first_held: Vec<u32> = forest.hubs.iter().map(|hub| hub[0]).collect();
        for root in first_held.into_iter().chain(0..holders.len() as u32) {
            if reached[root as usize] {
                continue;
            }
            forest.roots.push(root);
            frontier.clear();
            forest.reach(root, &mut reached, &mut frontier);
            let mut next = 0;
            while next < frontier.len() {
                let parent = frontier[next];
                next += 1;
                for &spring in &touching[parent as usize] {
                    let s = &springs[spring as usize];
                    let child = if s.a == parent { s.b } else { s.a };
                    if !reached[child as usize] {
                        in_tree[spring as usize] = true;
                        forest.links.push(Link { child, parent, spring });
                        forest.reach(child, &mut reached, &mut frontier);
                    }
                }
            }
        }
        forest.links.reverse();
        forest.loops.retain(|&spring| !in_tree[spring as usize]);
        forest
    }

    /// Puts a particle in the frontier of a tree, and those that the same body holds.
    fn reach(&self, i: u32, reached: &mut [bool], frontier: &mut Vec<u32>) {
        let alone = [i];
        let node = self.hubs.get(self.hub_of[i as usize]).map_or(&alone[..], |hub| &hub[..]);
        for &particle in node {
            reached[particle as usize] = true;
            frontier.push(particle);
        }
    }

    /// Particles that each body holds.
    pub fn hubs(&self) -> &[Vec<u32>] {
        &self.hubs
    }

    /// Hub of a particle, or `NO_HUB`.
    pub fn hub_of(&self, i: usize) -> usize {
        self.hub_of[i]
    }

    /// True if there are springs to be solved, so that particles hear of each other.
    pub fn has_trees(&self) -> bool {
        !(self.links.is_empty() && self.ties.is_empty())
    }

    /// Springs of the linear system.
    pub fn solved_springs(&self) -> impl Iterator<Item = u32> {
        let of_links = self.links.iter().map(|link| link.spring);
        of_links.chain(self.ties.iter().map(|tie| tie.spring))
    }

    /// Springs that are projected.
    pub fn loops(&self) -> &[u32] {
        &self.loops
    }
}

/// A spring during one step: with its damping, which is that of its length between the step's ends, a spring again.
#[derive(Clone, Copy, Debug, Default)]
struct Load {
    /// Its length when the step begins, at least the rest length if it resists stretch alone, metres.
    begun: f32,
    /// Damping over the length of the step, N/m.
    rate: f32,
    /// Vector from A to B where the spring is linearised, metres.
    from_a: Vec3,
    /// Force on A, newtons, extrapolated from there to where the step begins.
    force: Vec3,
    /// `h² K + h D`, kg.
    block: Sym3,
}

impl Load {
    /// At the beginning of a step of `h` seconds, B at `from_a` from A.
    fn new(spring: &SpringDef, from_a: Vec3, h: f32) -> Self {
        let length = from_a.length();
        let begun = match spring.resists {
            Resists::Both => length,
            Resists::Stretch => max(length, spring.rest_length),
        };
        let mut load = Self { begun, rate: spring.damping / h, ..Self::default() };
        load.linearise(spring, from_a, Vec3::ZERO, h);
        load
    }

    /// Tension when it is so long at the end of the step, N; 0 where it is slack.
    fn tension(&self, spring: &SpringDef, length: f32) -> f32 {
        let tension = spring.stiffness * (length - spring.rest_length) + self.rate * (length - self.begun);
        if spring.resists == Resists::Stretch { max(tension, 0.0) } else { tension }
    }

    /// Energy that the step pays for that tension, J: its integral over the length, from where there is none.
    fn energy(&self, spring: &SpringDef, from_a: Vec3) -> f64 {
        let tension = f64::from(self.tension(spring, from_a.length()));
        0.5 * tension * tension / f64::from(spring.stiffness + self.rate)
    }

    /// Linearises where B is at `from_a` from A, which velocities have brought about of which A's is `ahead` of B's.
    fn linearise(&mut self, spring: &SpringDef, from_a: Vec3, ahead: Vec3, h: f32) {
        let length = from_a.length();
        let direction = sinew_math::normalize_or(from_a, Vec3::Y);
        (self.from_a, self.force, self.block) = (from_a, Vec3::ZERO, Sym3::ZERO);
        let tension = self.tension(spring, length);
        if spring.resists == Resists::Stretch && tension == 0.0 {
            return;
        }
        // A slack spring would have a negative geometric stiffness, with which the system may lose its solution.
        let across = match length > 1e-9 {
            true => max(tension / length, 0.0),
            false if spring.rest_length == 0.0 => spring.stiffness,
            false => 0.0,
        };
        let axial = spring.stiffness + self.rate;
        let stiffness = Sym3::IDENTITY * across + Sym3::outer(direction) * (axial - across);
        self.force = direction * tension + stiffness * ahead * h;
        self.block = stiffness * (h * h);
    }

    /// Impulse on A in a step at whose end A and B move at these velocities.
    fn impulse(&self, h: f32, velocity_a: Vec3, velocity_b: Vec3) -> Vec3 {
        self.force * h - self.block * (velocity_a - velocity_b)
    }

    /// True if the force at the end of the step differs from the linearised one by more than `LENGTH_TOLERANCE` of the length stretches it.
    fn is_bent(&self, spring: &SpringDef, from_a: Vec3, ahead: Vec3, h: f32) -> bool {
        let length = from_a.length();
        let force = sinew_math::normalize_or(from_a, Vec3::Y) * self.tension(spring, length);
        let error = force - (self.force - self.block * ahead * (1.0 / h));
        let bar = LENGTH_TOLERANCE * max(self.begun, spring.rest_length) * (spring.stiffness + self.rate);
        error.length_squared() > bar * bar
    }
}

/// Freedom of a particle in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Freedom {
    /// Anything.
    #[default]
    Free,
    /// Only at right angles to a unit normal; along it, its velocity is given.
    Along { normal: Vec3, speed: f32 },
    /// Nothing: its velocity is given.
    Fixed,
}

/// Memory of one step's system, by particle and by spring.
#[derive(Clone, Debug, Default)]
pub(super) struct System {
    /// kg: the particle's own, and where nothing is in trees what its anchor adds.
    pub inertia: Vec<Sym3>,
    /// kg·m/s: momentum at the end of the step without springs and contacts.
    pub momentum: Vec<Vec3>,
    /// Inertia that contacts add, kg.
    pub added_inertia: Vec<Sym3>,
    /// Momentum that contacts add, kg·m/s.
    pub added_momentum: Vec<Vec3>,
    /// The velocity of a fixed particle is read from the velocities.
    pub freedom: Vec<Freedom>,
    /// Bodies that hold particles.
    pub hubs: Vec<Hub>,
    /// Place of each held particle on its body, world, metres.
    pub points: Vec<Vec3>,
    loads: Vec<Load>,
    /// Velocities and impulses of springs that Newton's method has come from.
    last_velocities: Vec<Vec3>,
    last_impulses: Vec<Vec3>,
    /// Inertia and momentum of each particle with all that hangs below it.
    gathered_inertia: Vec<Sym3>,
    gathered_momentum: Vec<Vec3>,
    /// Velocity gained per impulse while the parent keeps its velocity.
    response: Vec<Sym3>,
}

impl System {
    pub fn new(particles: usize, springs: usize, hubs: usize) -> Self {
        let (matrices, vectors) = (vec![Sym3::ZERO; particles], vec![Vec3::ZERO; particles]);
        Self {
            inertia: matrices.clone(),
            momentum: vectors.clone(),
            added_inertia: matrices.clone(),
            added_momentum: vectors.clone(),
            freedom: vec![Freedom::Free; particles],
            hubs: vec![Hub::new(); hubs],
            points: vectors.clone(),
            loads: vec![Load::default(); springs],
            last_velocities: vectors.clone(),
            last_impulses: vectors.clone(),
            gathered_inertia: matrices.clone(),
            gathered_momentum: vectors,
            response: matrices,
        }
    }

    /// Evaluates the springs of the forest for a step of `h` seconds.
    pub fn load_springs(&mut self, forest: &Forest, springs: &[SpringDef], positions: &[Vec3], h: f32) {
        for spring in forest.solved_springs() {
            let s = &springs[spring as usize];
            let from_a = positions[s.b as usize] - positions[s.a as usize];
            self.loads[spring as usize] = Load::new(s, from_a, h);
        }
    }

    /// Velocities at the end of the step, and the impulses of springs with which they come about, by Newton's method: springs
    /// are linearised anew where the velocities just found would bring them, until none is there other than foreseen.
    ///
    /// A link of a whip that turns far within the step would else be stretched by that, and hold energy that nobody paid.
    /// A step of the method is shortened until it lowers the energy of which the end of the step is the least (`merit`), so that none
    /// makes it worse.
    pub fn settle_springs(
        &mut self,
        forest: &Forest,
        springs: &[SpringDef],
        positions: &[Vec3],
        h: f32,
        (velocities, impulses): (&mut [Vec3], &mut [Vec3]),
    ) {
        self.solve(forest, springs, h, velocities);
        self.spring_impulses(forest, springs, h, velocities, impulses);
        let mut merit = None;
        for _ in 0..NEWTON_ROUNDS {
            if !self.follow_springs(forest, springs, (positions, velocities), h) {
                return;
            }
            let before = merit.unwrap_or_else(|| self.merit(forest, springs, (positions, velocities), h));
            self.last_velocities.copy_from_slice(velocities);
            self.hubs.iter_mut().for_each(|hub| hub.last_velocity = hub.velocity);
            self.last_impulses.copy_from_slice(impulses);
            self.solve(forest, springs, h, velocities);
            self.spring_impulses(forest, springs, h, velocities, impulses);
            let mut after = self.merit(forest, springs, (positions, velocities), h);
            for _ in 0..HALVINGS {
                if after.0 <= before.0 + MERIT_ROUNDING * before.1 {
                    break;
                }
                for (now, last) in velocities.iter_mut().zip(&self.last_velocities) {
                    *now = (*now + *last) * 0.5;
                }
                for hub in &mut self.hubs {
                    hub.velocity = core::array::from_fn(|k| (hub.velocity[k] + hub.last_velocity[k]) * 0.5);
                }
                for (now, last) in impulses.iter_mut().zip(&self.last_impulses) {
                    *now = (*now + *last) * 0.5;
                }
                after = self.merit(forest, springs, (positions, velocities), h);
            }
            merit = Some(after);
        }
    }

    /// The energy of which the velocities at the end of the step are the least, J, and the size of its terms:
    /// `½ v·M v − p·v`, and what springs have there.
    fn merit(
        &self,
        forest: &Forest,
        springs: &[SpringDef],
        (positions, velocities): (&[Vec3], &[Vec3]),
        h: f32,
    ) -> (f64, f64) {
        let (mut sum, mut size) = (0.0, 0.0);
        for (i, &v) in velocities.iter().enumerate() {
            if self.freedom[i] != Freedom::Fixed {
                let own = 0.5 * v.dot((self.inertia[i] + self.added_inertia[i]) * v);
                let given = (self.momentum[i] + self.added_momentum[i]).dot(v);
                sum += f64::from(own) - f64::from(given);
                size += f64::from(own) + f64::from(given.abs());
            }
        }
        for hub in &self.hubs {
            let (own, terms) = hub.merit();
            sum += f64::from(own);
            size += f64::from(terms);
        }
        for spring in forest.solved_springs() {
            let s = &springs[spring as usize];
            let energy = self.loads[spring as usize].energy(s, at_end(s, positions, velocities, h).0);
            sum += energy;
            size += energy;
        }
        (sum, size)
    }

    /// Linearises the springs anew where these velocities would bring them, if any would be there other than foreseen; whether there was
    /// one.
    fn follow_springs(
        &mut self,
        forest: &Forest,
        springs: &[SpringDef],
        (positions, velocities): (&[Vec3], &[Vec3]),
        h: f32,
    ) -> bool {
        let bent = forest.solved_springs().any(|spring| {
            let s = &springs[spring as usize];
            let (from_a, ahead) = at_end(s, positions, velocities, h);
            self.loads[spring as usize].is_bent(s, from_a, ahead, h)
        });
        if bent {
            for spring in forest.solved_springs() {
                let s = &springs[spring as usize];
                let (from_a, ahead) = at_end(s, positions, velocities, h);
                self.loads[spring as usize].linearise(s, from_a, ahead, h);
            }
        }
        bent
    }

    /// Velocities at the end of the step.
    pub fn solve(&mut self, forest: &Forest, springs: &[SpringDef], h: f32, velocities: &mut [Vec3]) {
        for i in 0..velocities.len() {
            self.gathered_inertia[i] = self.inertia[i] + self.added_inertia[i];
            self.gathered_momentum[i] = self.momentum[i] + self.added_momentum[i];
        }
        for tie in &forest.ties {
            let (i, load) = (tie.particle as usize, self.loads[tie.spring as usize]);
            let force = if springs[tie.spring as usize].a == tie.particle { load.force } else { -load.force };
            self.gathered_momentum[i] += force * h + load.block * velocities[tie.held as usize];
            self.gathered_inertia[i] += load.block;
        }
        self.gather(forest, springs, h, velocities);
        for &root in &forest.roots {
            let root = root as usize;
            if self.gather_hub(forest, root) {
                self.move_hub(forest, root, velocities);
                continue;
            }
            let inverse = self.gathered_inertia[root].inverse();
            self.response[root] = constrained(&inverse, &self.freedom[root]);
            velocities[root] = self.velocity(root, &inverse, Vec3::ZERO, velocities);
        }
        for link in forest.links.iter().rev() {
            let (child, load) = (link.child as usize, self.loads[link.spring as usize]);
            let inverse = (self.gathered_inertia[child] + load.block).inverse();
            velocities[child] = self.velocity(child, &inverse, velocities[link.parent as usize], velocities);
            if self.is_in_hub(forest, child) {
                let hub = forest.hub_of[child];
                let seen = self.hubs[hub].seen_at(self.points[child]);
                self.hubs[hub].follow(self.points[child], velocities[child], seen);
                let on_child =
                    if springs[link.spring as usize].a == link.child { load.force } else { -load.force };
                let pull = on_child * h + load.block * velocities[link.parent as usize];
                self.hubs[hub].add_at(self.points[child], load.block, pull);
                self.move_hub(forest, child, velocities);
            }
        }
    }

    /// True if a body that moves holds it.
    fn is_in_hub(&self, forest: &Forest, i: usize) -> bool {
        forest.hub_of[i] != NO_HUB && self.freedom[i] != Freedom::Fixed
    }

    /// Gathers what the body of a particle holds, if one that moves does; whether there is one.
    fn gather_hub(&mut self, forest: &Forest, i: usize) -> bool {
        if !self.is_in_hub(forest, i) {
            return false;
        }
        let hub = forest.hub_of[i];
        let held = |&i: &u32| {
            let i = i as usize;
            (self.points[i], self.gathered_inertia[i], self.gathered_momentum[i])
        };
        self.hubs[hub].gather(forest.hubs[hub].iter().map(held));
        true
    }

    /// Gives all that the body of a particle holds the velocities of its points.
    fn move_hub(&self, forest: &Forest, i: usize, velocities: &mut [Vec3]) {
        let hub = forest.hub_of[i];
        for &held in &forest.hubs[hub] {
            velocities[held as usize] = self.hubs[hub].velocity_at(self.points[held as usize]);
        }
    }

    /// Velocities at the end of the step of particles that no springs of the forest join.
    pub fn solve_apart(&mut self, particles: &[u32], velocities: &mut [Vec3]) {
        for &i in particles {
            let i = i as usize;
            self.gathered_momentum[i] = self.momentum[i] + self.added_momentum[i];
            let inverse = (self.inertia[i] + self.added_inertia[i]).inverse();
            self.response[i] = constrained(&inverse, &self.freedom[i]);
            velocities[i] = self.velocity(i, &inverse, Vec3::ZERO, velocities);
        }
    }

    /// Leaves to roots: each parent feels the inertia and momentum of what hangs below it.
    fn gather(&mut self, forest: &Forest, springs: &[SpringDef], h: f32, velocities: &[Vec3]) {
        for link in &forest.links {
            let (child, parent) = (link.child as usize, link.parent as usize);
            let Load { force, block, .. } = self.loads[link.spring as usize];
            if self.gather_hub(forest, child) {
                let seen = self.hubs[forest.hub_of[child]].seen_at(self.points[child]);
                (self.gathered_inertia[child], self.gathered_momentum[child]) = seen;
            }
            let on_child = if springs[link.spring as usize].a == link.child { force * h } else { -force * h };
            self.gathered_momentum[child] += on_child;
            self.gathered_momentum[parent] -= on_child;

            let inertia = self.gathered_inertia[child];
            let inverse = (inertia + block).inverse();
            self.response[child] = constrained(&inverse, &self.freedom[child]);
            let velocity = self.velocity(child, &inverse, Vec3::ZERO, velocities);
            let momentum = self.passed_on(child, &inverse, &block, velocity);
            self.gathered_momentum[parent] += momentum;
            self.gathered_inertia[parent] += felt_by_parent(&inertia, &inverse, &block, &self.freedom[child]);
        }
    }

    /// Velocity of a particle under the momentum of what hangs below it, on a parent that has a velocity, m/s.
    ///
    /// The pull of a stiff spring on what moves along with it is many thousand times their momentum, and its rounding would be as large as that: so it is that of
    /// what they have more than the parent's velocity gives them.
    fn velocity(&self, i: usize, inverse: &Sym3, parent: Vec3, velocities: &[Vec3]) -> Vec3 {
        let free = || {
            let more = self.gathered_momentum[i] - self.gathered_inertia[i] * parent;
            parent + self.response[i] * more
        };
        match self.freedom[i] {
            Freedom::Free => free(),
            Freedom::Along { normal, speed } => {
                let along = *inverse * normal;
                free() + along * ((speed - normal.dot(parent)) / normal.dot(along))
            }
            Freedom::Fixed => velocities[i],
        }
    }

    /// Momentum that a child hands on to its parent, kg·m/s: the spring's block times the velocity that it has while the parent rests. Of a stiff spring it is what
    /// the child does not keep.
    fn passed_on(&self, child: usize, inverse: &Sym3, block: &Sym3, velocity: Vec3) -> Vec3 {
        let (inertia, momentum) = (self.gathered_inertia[child], self.gathered_momentum[child]);
        if self.freedom[child] == Freedom::Fixed || !is_stiff(block, &inertia) {
            return *block * velocity;
        }
        let pushed = match self.freedom[child] {
            Freedom::Along { normal, speed } => {
                let along = *inverse * normal;
                normal * ((speed - along.dot(momentum)) / normal.dot(along))
            }
            Freedom::Free | Freedom::Fixed => Vec3::ZERO,
        };
        momentum + pushed - inertia * velocity
    }

    /// The impulse of the tree springs on each particle.
    fn spring_impulses(
        &self,
        forest: &Forest,
        springs: &[SpringDef],
        h: f32,
        velocities: &[Vec3],
        sums: &mut [Vec3],
    ) {
        sums.fill(Vec3::ZERO);
        for spring in forest.solved_springs() {
            let s = &springs[spring as usize];
            let (a, b) = (s.a as usize, s.b as usize);
            let impulse = self.loads[spring as usize].impulse(h, velocities[a], velocities[b]);
            sums[a] += impulse;
            sums[b] -= impulse;
        }
    }
}

/// Vector from A to B of a spring at the end of the step, and how far the velocity of A is ahead of that of B.
fn at_end(s: &SpringDef, positions: &[Vec3], velocities: &[Vec3], h: f32) -> (Vec3, Vec3) {
    let [a, b] = [s.a as usize, s.b as usize];
    let ahead = velocities[a] - velocities[b];
    (positions[b] - positions[a] - ahead * h, ahead)
}

/// The inverse inertia of a particle that may not gain velocity along the normal: `W − W n nᵀ W / (n·W n)`.
fn constrained(inverse: &Sym3, freedom: &Freedom) -> Sym3 {
    match freedom {
        Freedom::Free => *inverse,
        Freedom::Along { normal, .. } => {
            let along = *inverse * *normal;
            *inverse - Sym3::outer(along) * (1.0 / normal.dot(along))
        }
        Freedom::Fixed => Sym3::ZERO,
    }
}

/// True if a spring's block outweighs the inertia below it, so that this is what is left of their difference.
fn is_stiff(block: &Sym3, inertia: &Sym3) -> bool {
    let size = |m: &Sym3| m.to_mat3().x_axis.x + m.to_mat3().y_axis.y + m.to_mat3().z_axis.z;
    size(block) > size(inertia)
}

/// With S the child's inertia, B the spring's block and W its response, the parent gains `B − B W B`. Free, that is
/// `S (S + B)⁻¹ B`, or `S − S (S + B)⁻¹ S`: whichever of both is the smaller, the other one would cancel itself out.
fn felt_by_parent(inertia: &Sym3, inverse: &Sym3, block: &Sym3, freedom: &Freedom) -> Sym3 {
    let stiff = is_stiff(block, inertia);
    let free = || {
        let last = if stiff { inertia } else { block };
        let product = Sym3::from_mat3(&(inertia.to_mat3() * inverse.to_mat3() * last.to_mat3()));
        if stiff { *inertia - product } else { product }
    };
    match freedom {
        Freedom::Free => free(),
        Freedom::Along { normal, .. } => {
            let along = *inverse * *normal;
            let back = if stiff { *normal - *inertia * along } else { *block * along };
            free() + Sym3::outer(back) * (1.0 / normal.dot(along))
        }
        Freedom::Fixed => *block,
    }
}
