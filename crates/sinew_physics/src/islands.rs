//! `islands` and `color`: which active bodies hang together through contacts, joints and particles.

use crate::arena::Arena;
use crate::body::Body;
use crate::contact::Contact;
use crate::joint::Joint;
use crate::particles::ParticleGroup;
use crate::project::{IslandParticles, Neighbors};
use crate::solver::IslandSolver;

/// Members of one island, by index, each list ascending.
#[derive(Clone, Debug, Default)]
pub(crate) struct Island {
    pub bodies: Vec<u32>,
    pub joints: Vec<u32>,
    /// Positions in the contact array. `color` puts those with static bodies last: what cannot move has the last word.
    pub contacts: Vec<u32>,
    /// Particle groups hang on its bodies or touch them.
    pub has_particles: bool,
}

impl Island {
    fn clear(&mut self) {
        self.bodies.clear();
        self.joints.clear();
        self.contacts.clear();
        self.has_particles = false;
    }
}

/// The unit of work: an island and the solver that runs its substeps, whose memory is kept from step to step.
#[derive(Clone, Debug, Default)]
pub(crate) struct IslandTask {
    pub island: Island,
    pub solver: IslandSolver,
    pub particles: IslandParticles,
}

/// Union-find over the slots of bodies, then of particle groups.
#[derive(Clone, Debug, Default)]
pub(crate) struct Islands {
    parent: Vec<u32>,
    island_of_root: Vec<u32>,
    tasks: Vec<IslandTask>,
    count: usize,
    /// Per slot of particle groups.
    neighbors: Vec<Neighbors>,
}

const NONE: u32 = u32::MAX;

impl Islands {
    /// The islands of this step, ordered by their smallest body.
    pub fn tasks(&self) -> &[IslandTask] {
        &self.tasks[..self.count]
    }

    /// Likewise, to be run.
    pub fn tasks_mut(&mut self) -> &mut [IslandTask] {
        &mut self.tasks[..self.count]
    }

    /// Finds the islands and takes the particle groups into them for the length of the step.
    pub fn find(
        &mut self,
        bodies: &Arena<Body>,
        joints: &Arena<Joint>,
        contacts: &[Contact],
        groups: &mut Arena<ParticleGroup>,
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
        self.collect(bodies, joints, contacts);
        for (index, group) in groups.iter_mut() {
            let near = core::mem::take(&mut self.neighbors[index as usize]);
            let group = core::mem::take(group);
            let task = self.task_of(first_group + index);
            task.island.has_particles = true;
            task.particles.groups.push((index, group, near));
        }
    }

    /// Gives the groups back.
    pub fn release(&mut self, groups: &mut Arena<ParticleGroup>) {
        for task in &mut self.tasks[..self.count] {
            for (index, group, near) in task.particles.groups.drain(..) {
                *groups.at_mut(index) = group;
                self.neighbors[index as usize] = near;
            }
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

    fn island_of(&mut self, body: u32) -> &mut Island {
        &mut self.task_of(body).island
    }

    fn task_of(&mut self, slot: u32) -> &mut IslandTask {
        let root = self.root(slot) as usize;
        if self.island_of_root[root] == NONE {
            self.island_of_root[root] = self.count as u32;
            if self.count == self.tasks.len() {
                self.tasks.push(IslandTask::default());
            }
            self.tasks[self.count].island.clear();
            self.count += 1;
        }
        &mut self.tasks[self.island_of_root[root] as usize]
    }

    fn collect(&mut self, bodies: &Arena<Body>, joints: &Arena<Joint>, contacts: &[Contact]) {
        self.count = 0;
        self.island_of_root.clear();
        self.island_of_root.resize(self.parent.len(), NONE);
        for (index, _) in bodies.iter().filter(|(_, body)| body.is_active()) {
            self.island_of(index).bodies.push(index);
        }
        let active = |index: &u32| bodies.at(*index).is_active();
        for (index, joint) in joints.iter().filter(|(_, joint)| joint.is_enabled()) {
            if let Some(body) = [joint.a, joint.b].into_iter().find(active) {
                self.island_of(body).joints.push(index);
            }
        }
        for (index, contact) in contacts.iter().enumerate().filter(|(_, contact)| contact.pushes()) {
            if let Some(body) = [contact.key.a, contact.key.b].into_iter().find(active) {
                self.island_of(body).contacts.push(index as u32);
            }
        }
    }

    /// `color`: contacts between moving bodies first, those with fixed ones last, each by key. With one scalar lane a
    /// colour is no more than this order.
    pub fn color(&mut self, bodies: &Arena<Body>, contacts: &[Contact]) {
        let fixed = |index: u32| !bodies.at(index).is_active();
        for task in &mut self.tasks[..self.count] {
            task.island.contacts.sort_unstable_by_key(|&i| {
                let key = contacts[i as usize].key;
                (fixed(key.a) || fixed(key.b), i)
            });
        }
    }
}
