//! `islands` and `color`: which active bodies hang together through contacts, joints, particles and attraction.

use crate::arena::Arena;
use crate::body::Body;
use crate::contact::Contact;
use crate::field::{Fields, Target};
use crate::joint::Joint;
use crate::particles::ParticleGroup;
use crate::project::{Neighbors, TakenGroup};
use crate::runner::TaskRunner;
use crate::solver::Solution;
use crate::tasks::{Queue, Task, Workspace, Workspaces};

/// Members of one island, by index, each list ascending.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Island<'a> {
    pub bodies: &'a [u32],
    pub joints: &'a [u32],
    /// Positions in the contact array. `color` puts those with static bodies last: what cannot move has the last word.
    pub contacts: &'a [u32],
    /// Particle groups that hang on its bodies or may touch them.
    pub groups: &'a [u32],
}

/// Union-find over the slots of bodies, then of particle groups. Everything of one kind lies in one list for all islands:
/// memory that belonged to an island would have to grow whenever another takes its place.
#[derive(Clone, Debug, Default)]
pub(crate) struct Islands {
    parent: Vec<u32>,
    island_of_root: Vec<u32>,
    count: usize,
    bodies: Lists,
    joints: Lists,
    contacts: Lists,
    groups: Lists,
    /// Per slot of particle groups.
    neighbors: Vec<Neighbors>,
    /// Out of the world for the length of the step, island after island.
    taken: Vec<TakenGroup>,
    solution: Solution,
    /// One for each thread that has worked at the same time as others.
    idle: Vec<Workspace>,
    /// One for each island, where they go in lockstep.
    own: Vec<Workspace>,
}

const NONE: u32 = u32::MAX;

impl Islands {
    /// The islands of this step, ordered by their smallest body.
    pub fn iter(&self) -> impl Iterator<Item = Island<'_>> {
        (0..self.count).map(|i| Island {
            bodies: self.bodies.of(i),
            joints: self.joints.of(i),
            contacts: self.contacts.of(i),
            groups: self.groups.of(i),
        })
    }

    /// What came of them.
    pub fn solution(&self) -> &Solution {
        &self.solution
    }

    /// Finds the islands and takes the particle groups into them for the length of the step.
    pub fn find(
        &mut self,
        bodies: &Arena<Body>,
        joints: &Arena<Joint>,
        contacts: &[Contact],
        groups: &mut Arena<ParticleGroup>,
        fields: &Fields<'_>,
        dt: f32,
    ) {
        let first_group = bodies.slot_count() as u32;
        self.parent.clear();
        self.parent.extend(0..first_group + groups.slot_count() as u32);
        let active = |index: u32| bodies.at(index).is_active();
        for contact in contacts.iter().filter(|contact| contact.pushes()) {
            if active(contact.key.a) && active(contact.key.b) {
                self.join(contact.key.a, contact.key.b);
            }
        }
        let joins = |joint: &Joint| joint.is_enabled() && active(joint.a) && active(joint.b);
        for (_, joint) in joints.iter().filter(|(_, joint)| joins(joint)) {
            self.join(joint.a, joint.b);
        }
        self.neighbors.resize(groups.slot_count(), Neighbors::default());
        for (index, group) in groups.iter() {
            self.neighbors[index as usize].find(group, bodies, dt);
            for i in 0..self.neighbors[index as usize].bodies.len() {
                let body = self.neighbors[index as usize].bodies[i];
                if active(body) {
                    self.join(first_group + index, body);
                }
            }
        }
        self.join_attracted(bodies, groups, fields);
        self.collect(bodies, joints, contacts);
        for (index, _) in groups.iter() {
            let island = self.island_of(first_group + index);
            self.groups.push(island, index);
        }
        for lists in [&mut self.bodies, &mut self.joints, &mut self.contacts, &mut self.groups] {
            lists.sort(self.count, self.parent.len());
        }
        for (_, group) in groups.iter_mut() {
            group.begin_step();
        }
        self.taken.extend(self.groups.numbers.iter().map(|&index| TakenGroup {
            index,
            group: core::mem::take(groups.at_mut(index)),
            near: core::mem::take(&mut self.neighbors[index as usize]),
        }));
    }

    /// All that a field lets attract each other.
    fn join_attracted(&mut self, bodies: &Arena<Body>, groups: &Arena<ParticleGroup>, fields: &Fields<'_>) {
        let first_group = bodies.slot_count() as u32;
        for (field, _) in fields.mutual() {
            let reached = |body: &Body| body.is_active() && field.reaches(&Target::of_body(body));
            let bodies = bodies.iter().filter(|(_, body)| reached(body)).map(|(index, _)| index);
            let reached = |group: &ParticleGroup| {
                (0..group.positions().len()).any(|i| field.reaches(&Target::of_particle(group, i)))
            };
            let groups = groups.iter().filter(|(_, group)| reached(group)).map(|(i, _)| first_group + i);
            let mut first = None;
            for slot in bodies.chain(groups) {
                self.join(*first.get_or_insert(slot), slot);
            }
        }
    }

    /// Gives the groups back.
    pub fn release(&mut self, groups: &mut Arena<ParticleGroup>) {
        for TakenGroup { index, group, near } in self.taken.drain(..) {
            *groups.at_mut(index) = group;
            self.neighbors[index as usize] = near;
        }
    }

    fn root(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            self.parent[i as usize] = self.parent[self.parent[i as usize] as usize];
            i = self.parent[i as usize];
        }
        i
    }

    /// The smaller root wins, so that the result does not depend on the order of joining.
    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[u32::max(a, b) as usize] = u32::min(a, b);
    }

    /// Number of the island of a slot; a new one if it is the first of its island.
    fn island_of(&mut self, slot: u32) -> u32 {
        let root = self.root(slot) as usize;
        if self.island_of_root[root] == NONE {
            self.island_of_root[root] = self.count as u32;
            self.count += 1;
        }
        self.island_of_root[root]
    }

    fn collect(&mut self, bodies: &Arena<Body>, joints: &Arena<Joint>, contacts: &[Contact]) {
        self.count = 0;
        for lists in [&mut self.bodies, &mut self.joints, &mut self.contacts, &mut self.groups] {
            lists.clear();
        }
        self.island_of_root.clear();
        self.island_of_root.resize(self.parent.len(), NONE);
        for (index, _) in bodies.iter().filter(|(_, body)| body.is_active()) {
            let island = self.island_of(index);
            self.bodies.push(island, index);
        }
        let active = |index: &u32| bodies.at(*index).is_active();
        for (index, joint) in joints.iter().filter(|(_, joint)| joint.is_enabled()) {
            if let Some(body) = [joint.a, joint.b].into_iter().find(active) {
                let island = self.island_of(body);
                self.joints.push(island, index);
            }
        }
        for (index, contact) in contacts.iter().enumerate().filter(|(_, contact)| contact.pushes()) {
            if let Some(body) = [contact.key.a, contact.key.b].into_iter().find(active) {
                let island = self.island_of(body);
                self.contacts.push(island, index as u32);
            }
        }
    }

    /// `color`: contacts between moving bodies first, those with fixed ones last, each by key. With one scalar lane a
    /// colour is no more than this order.
    pub fn color(&mut self, bodies: &Arena<Body>, contacts: &[Contact]) {
        let fixed = |index: u32| !bodies.at(index).is_active();
        for island in 0..self.count {
            self.contacts.of_mut(island).sort_unstable_by_key(|&i| {
                let key = contacts[i as usize].key;
                (fixed(key.a) || fixed(key.b), i)
            });
        }
    }

    /// Calls `work` once for each island, on `runner`'s threads: all that there is to do for it in this step.
    pub fn run(&mut self, runner: &dyn TaskRunner, work: impl Fn(&mut Task<'_>) + Sync) {
        let mut idle = core::mem::take(&mut self.idle);
        self.run_in(Workspaces::Idle(&mut idle), runner, work);
        self.idle = idle;
    }

    /// Likewise for a part of it: each island finds its workspace as the part before left it.
    pub fn run_part(&mut self, runner: &dyn TaskRunner, work: impl Fn(&mut Task<'_>) + Sync) {
        let mut own = core::mem::take(&mut self.own);
        if own.len() < self.count {
            own.resize_with(self.count, Workspace::default);
        }
        self.run_in(Workspaces::Own(&mut own), runner, work);
        self.own = own;
    }

    fn run_in(
        &mut self,
        workspaces: Workspaces<'_>,
        runner: &dyn TaskRunner,
        work: impl Fn(&mut Task<'_>) + Sync,
    ) {
        let mut solution = core::mem::take(&mut self.solution);
        let mut taken = core::mem::take(&mut self.taken);
        solution.resize(self.bodies.numbers.len(), self.joints.numbers.len(), self.contacts.numbers.len());
        Queue::new(self.iter(), &mut taken, &mut solution, workspaces).run(runner, self.count, work);
        (self.solution, self.taken) = (solution, taken);
    }

    /// Between two parts: the workspaces in the order of islands, and the particle groups.
    pub fn halted(&mut self) -> (&mut [Workspace], &mut [TakenGroup]) {
        (&mut self.own[..self.count], &mut self.taken)
    }
}

/// Ascending lists of numbers, one for each island, one after the other in memory.
#[derive(Clone, Debug, Default)]
struct Lists {
    /// Island and number, as they come.
    pairs: Vec<(u32, u32)>,
    numbers: Vec<u32>,
    /// Where the list of each island ends.
    ends: Vec<usize>,
}

impl Lists {
    fn clear(&mut self) {
        self.pairs.clear();
    }

    fn push(&mut self, island: u32, number: u32) {
        self.pairs.push((island, number));
    }

    /// Makes the lists of what was pushed, each in the order in which it came: a counting sort. Makes room for the `most`
    /// islands that there can be.
    fn sort(&mut self, islands: usize, most: usize) {
        self.ends.clear();
        self.ends.reserve(most);
        self.ends.resize(islands, 0);
        for &(island, _) in &self.pairs {
            self.ends[island as usize] += 1;
        }
        let mut start = 0;
        for end in &mut self.ends {
            // Where the list starts, until it is filled.
            start += core::mem::replace(end, start);
        }
        self.numbers.resize(self.pairs.len(), 0);
        for &(island, number) in &self.pairs {
            let end = &mut self.ends[island as usize];
            self.numbers[*end] = number;
            *end += 1;
        }
    }

    fn range(&self, island: usize) -> core::ops::Range<usize> {
        let start = if island == 0 { 0 } else { self.ends[island - 1] };
        start..self.ends[island]
    }

    fn of(&self, island: usize) -> &[u32] {
        &self.numbers[self.range(island)]
    }

    fn of_mut(&mut self, island: usize) -> &mut [u32] {
        let range = self.range(island);
        &mut self.numbers[range]
    }
}
