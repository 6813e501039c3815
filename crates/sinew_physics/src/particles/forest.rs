//! Trees of springs in a group.
//!
//! A spring adds one 3×3 block between its particles to the linear system of a step. If springs form trees, elimination
//! from the leaves to the root adds no further blocks, and the solution is exact in linear time.

use super::SpringDef;
use crate::id::BodyId;

/// Spring between a particle and its parent, the next particle toward the root.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub child: u32,
    pub parent: u32,
    pub spring: u32,
}

/// Spring between a particle and another one that is attached to the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tie {
    pub particle: u32,
    pub held: u32,
    pub spring: u32,
}

/// The springs of a group, sorted by how they are solved.
#[derive(Clone, Debug, Default)]
pub(super) struct Forest {
    /// Links from the leaves to the roots.
    links: Vec<Link>,
    roots: Vec<u32>,
    ties: Vec<Tie>,
    /// Springs that close a loop, with their ends.
    closings: Vec<(u32, [u32; 2])>,
    /// Springs that are projected, not solved in the linear system.
    projected: Vec<u32>,
    /// Particles attached to each body, and the hub of each particle.
    hubs: Vec<Vec<u32>>,
    hub_of: Vec<usize>,
}

/// Object that a particle is attached to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Holder {
    Nothing,
    World,
    Body(BodyId),
}

/// Hub number of a particle that is attached to no body.
pub(super) const NO_HUB: usize = usize::MAX;

/// True if both ends of a spring are attached to the same object, so that its length is constant.
fn is_rigid([a, b]: [Holder; 2]) -> bool {
    a == b && a != Holder::Nothing
}

impl Forest {
    /// Creates a forest without links: all springs are projected, and each particle is its own tree.
    pub fn without_trees(springs: &[SpringDef], holders: &[Holder]) -> Self {
        let ends = |k: u32| [springs[k as usize].a, springs[k as usize].b].map(|i| holders[i as usize]);
        Self {
            roots: (0..holders.len() as u32).filter(|&i| holders[i as usize] != Holder::World).collect(),
            projected: (0..springs.len() as u32).filter(|&k| !is_rigid(ends(k))).collect(),
            ..Self::with_hubs(holders)
        }
    }

    /// Creates a forest without springs, with the hubs of the particles.
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

    /// Creates a spanning forest in order of indices. Trees end at particles attached to the world, because these do
    /// not move; the particles of one body form one node.
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
                    forest.closings.push((index, [s.a, s.b]));
                }
            }
        }
        let mut reached: Vec<bool> = holders.iter().map(|&holder| holder == Holder::World).collect();
        let mut in_tree = vec![false; springs.len()];
        let mut frontier = Vec::new();
        // Hubs are roots first, because the loads that a root body gathers are all that the group contributes to the
        // body.
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
        forest.closings.retain(|&(spring, _)| !in_tree[spring as usize]);
        forest
    }

    /// Adds a particle to a tree's frontier, with the other particles of the same body.
    fn reach(&self, i: u32, reached: &mut [bool], frontier: &mut Vec<u32>) {
        let alone = [i];
        let node = self.hubs.get(self.hub_of[i as usize]).map_or(&alone[..], |hub| &hub[..]);
        for &particle in node {
            reached[particle as usize] = true;
            frontier.push(particle);
        }
    }

    /// Particles attached to each body.
    pub fn hubs(&self) -> &[Vec<u32>] {
        &self.hubs
    }

    /// Hub of a particle, or `NO_HUB`.
    pub fn hub_of(&self, i: usize) -> usize {
        self.hub_of[i]
    }

    /// True if springs are solved in the linear system, so that particles affect each other.
    pub fn has_trees(&self) -> bool {
        !(self.links.is_empty() && self.ties.is_empty())
    }

    /// Links from the leaves to the roots.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// One particle of each tree.
    pub fn roots(&self) -> &[u32] {
        &self.roots
    }

    /// Springs to particles that are attached to the world.
    pub fn ties(&self) -> &[Tie] {
        &self.ties
    }

    /// Springs that close a loop, with their ends.
    pub fn closings(&self) -> &[(u32, [u32; 2])] {
        &self.closings
    }

    /// Springs of the linear system.
    pub fn solved_springs(&self) -> impl Iterator<Item = u32> {
        let of_links = self.links.iter().map(|link| link.spring);
        of_links
            .chain(self.ties.iter().map(|tie| tie.spring))
            .chain(self.closings.iter().map(|&(spring, _)| spring))
    }

    /// Springs that are projected.
    pub fn projected(&self) -> &[u32] {
        &self.projected
    }
}
