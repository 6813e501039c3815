//! Which springs form trees, and the linear system of a step over them.
//!
//! Unknown are the velocities at the end of the step: `(M + h² K + h D) v⁺ = M v + h f` (Baraff & Witkin 1998), with
//! the axial stiffness `k n nᵀ`, the geometric stiffness `k max(0, 1 − L₀/L) (I − n nᵀ)` and the axial damping of
//! each spring. A spring adds one 3×3 block between its particles; where springs form trees, elimination from the
//! leaves to the root fills nothing in and the solution is exact in linear time. At rest the right-hand side is
//! zero, so that a chain hangs exactly where its forces balance, whatever the length of the step.

use super::SpringDef;
use sinew_math::{Sym3, Vec3, max};

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
    /// Springs that would close a loop: projected, not solved.
    loops: Vec<u32>,
}

impl Forest {
    /// A spanning forest in order of indices. Particles held in the world carry no motion, so trees end at them.
    pub fn new(particles: usize, springs: &[SpringDef], held_in_world: &[bool]) -> Self {
        let mut forest = Self::default();
        let mut touching: Vec<Vec<u32>> = vec![Vec::new(); particles];
        for (index, s) in springs.iter().enumerate() {
            let index = index as u32;
            match (held_in_world[s.a as usize], held_in_world[s.b as usize]) {
                (true, true) => {}
                (true, false) => forest.ties.push(Tie { particle: s.b, held: s.a, spring: index }),
                (false, true) => forest.ties.push(Tie { particle: s.a, held: s.b, spring: index }),
                (false, false) => {
                    touching[s.a as usize].push(index);
                    touching[s.b as usize].push(index);
                }
            }
        }
        let mut reached = held_in_world.to_vec();
        let mut in_tree = vec![false; springs.len()];
        for root in 0..particles {
            if core::mem::replace(&mut reached[root], true) {
                continue;
            }
            forest.roots.push(root as u32);
            let mut frontier = vec![root as u32];
            let mut next = 0;
            while next < frontier.len() {
                let parent = frontier[next];
                next += 1;
                for &spring in &touching[parent as usize] {
                    let s = &springs[spring as usize];
                    let child = if s.a == parent { s.b } else { s.a };
                    if !core::mem::replace(&mut reached[child as usize], true) {
                        in_tree[spring as usize] = true;
                        forest.links.push(Link { child, parent, spring });
                        frontier.push(child);
                    }
                }
            }
        }
        forest.links.reverse();
        let free = |s: &SpringDef| !held_in_world[s.a as usize] && !held_in_world[s.b as usize];
        let closes_loop = |k: &u32| !in_tree[*k as usize] && free(&springs[*k as usize]);
        forest.loops = (0..springs.len() as u32).filter(closes_loop).collect();
        forest
    }

    /// Springs that close a loop.
    pub fn loops(&self) -> &[u32] {
        &self.loops
    }
}

/// A spring during one step.
#[derive(Clone, Copy, Debug, Default)]
struct Load {
    /// Force on A, newtons.
    force: Vec3,
    /// `h² K + h D`, kg.
    block: Sym3,
}

impl Load {
    fn new(spring: &SpringDef, from_a: Vec3, h: f32) -> Self {
        let length = from_a.length();
        let direction = sinew_math::normalize_or(from_a, Vec3::Y);
        // A slack spring would have a negative geometric stiffness, with which the system may lose its solution.
        let taut = if length > 1e-9 { max(1.0 - spring.rest_length / length, 0.0) } else { 0.0 };
        let across = if spring.rest_length == 0.0 { spring.stiffness } else { spring.stiffness * taut };
        let axial = h * h * (spring.stiffness - across) + h * spring.damping;
        Self {
            force: direction * (spring.stiffness * (length - spring.rest_length)),
            block: Sym3::IDENTITY * (h * h * across) + Sym3::outer(direction) * axial,
        }
    }

    /// Impulse on A in a step at whose end A and B move at these velocities.
    fn impulse(&self, h: f32, velocity_a: Vec3, velocity_b: Vec3) -> Vec3 {
        self.force * h - self.block * (velocity_a - velocity_b)
    }
}

/// Memory of one step's system: inertia and right-hand side of each particle, blocks of each spring.
#[derive(Clone, Debug, Default)]
pub(super) struct System {
    /// kg: the particle's own, and what its target adds.
    pub inertia: Vec<Sym3>,
    /// kg·m/s: momentum at the end of the step without springs.
    pub momentum: Vec<Vec3>,
    /// Particles whose velocity is given.
    pub fixed: Vec<bool>,
    loads: Vec<Load>,
    /// `(S + B)⁻¹` of each particle with its link.
    inverse: Vec<Sym3>,
}

impl System {
    pub fn new(particles: usize, springs: usize) -> Self {
        Self {
            inertia: vec![Sym3::ZERO; particles],
            momentum: vec![Vec3::ZERO; particles],
            fixed: vec![false; particles],
            loads: vec![Load::default(); springs],
            inverse: vec![Sym3::ZERO; particles],
        }
    }

    /// Velocities at the end of a step of `h` seconds; those of fixed particles are read.
    pub fn solve(
        &mut self,
        forest: &Forest,
        springs: &[SpringDef],
        positions: &[Vec3],
        h: f32,
        velocities: &mut [Vec3],
    ) {
        for tie in &forest.ties {
            let (load, on_particle) = self.load(springs, positions, tie.spring, tie.particle, h);
            self.momentum[tie.particle as usize] +=
                on_particle * h + load.block * velocities[tie.held as usize];
            self.inertia[tie.particle as usize] += load.block;
        }
        for link in &forest.links {
            let (_, on_child) = self.load(springs, positions, link.spring, link.child, h);
            self.momentum[link.child as usize] += on_child * h;
            self.momentum[link.parent as usize] -= on_child * h;
        }
        self.eliminate(forest, velocities);
        for &root in &forest.roots {
            let root = root as usize;
            if !self.fixed[root] {
                velocities[root] = self.inertia[root].inverse() * self.momentum[root];
            }
        }
        for link in forest.links.iter().rev() {
            let (child, parent) = (link.child as usize, link.parent as usize);
            if !self.fixed[child] {
                let pull = self.loads[link.spring as usize].block * velocities[parent];
                velocities[child] = self.inverse[child] * (self.momentum[child] + pull);
            }
        }
    }

    /// Evaluates a spring; the force on `particle`, one of its two.
    fn load(
        &mut self,
        springs: &[SpringDef],
        positions: &[Vec3],
        spring: u32,
        particle: u32,
        h: f32,
    ) -> (Load, Vec3) {
        let s = &springs[spring as usize];
        let load = Load::new(s, positions[s.b as usize] - positions[s.a as usize], h);
        self.loads[spring as usize] = load;
        (load, if s.a == particle { load.force } else { -load.force })
    }

    /// Leaves to roots. With S the child's inertia so far and B the spring's block, the parent's gains
    /// `B − B (S + B)⁻¹ B = S (S + B)⁻¹ B`: in the second form a stiff spring does not cancel itself out.
    fn eliminate(&mut self, forest: &Forest, velocities: &[Vec3]) {
        for link in &forest.links {
            let (child, parent) = (link.child as usize, link.parent as usize);
            let (inertia, block) = (self.inertia[child], self.loads[link.spring as usize].block);
            if self.fixed[child] {
                self.inertia[parent] += block;
                self.momentum[parent] += block * velocities[child];
                continue;
            }
            let inverse = (inertia + block).inverse();
            self.inverse[child] = inverse;
            let felt = inertia.to_mat3() * inverse.to_mat3() * block.to_mat3();
            self.inertia[parent] += Sym3::from_mat3(&felt);
            let momentum = block * (inverse * self.momentum[child]);
            self.momentum[parent] += momentum;
        }
    }

    /// Adds to `sums` the impulse of each tree spring on each of its particles that is fixed or held.
    pub fn add_reactions(
        &self,
        forest: &Forest,
        springs: &[SpringDef],
        h: f32,
        velocities: &[Vec3],
        sums: &mut [Vec3],
    ) {
        let of_links = forest.links.iter().map(|link| link.spring);
        for spring in of_links.chain(forest.ties.iter().map(|tie| tie.spring)) {
            let s = &springs[spring as usize];
            let (a, b) = (s.a as usize, s.b as usize);
            if self.fixed[a] || self.fixed[b] {
                let impulse = self.loads[spring as usize].impulse(h, velocities[a], velocities[b]);
                sums[a] += impulse;
                sums[b] -= impulse;
            }
        }
    }
}
