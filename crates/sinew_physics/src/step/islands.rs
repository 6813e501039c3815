//! The stages `islands` and `color`: groups active bodies that contacts, joints, particles or attraction connect.

use crate::arena::Arena;
use crate::body::external_work::Work;
use crate::context::StepContext;
use crate::field::Target;
use crate::island::Island;
use crate::particles::ParticleGroup;
use crate::runner::{Serial, TaskRunner};
use crate::solver::boundary::groups::{Neighbors, TakenGroup};
use crate::solver::flight::{Flight, flies};
use crate::solver::strands::Strands;
use crate::solver::{Solution, View};
use crate::step::tasks::{Queue, Task, Workspace, Workspaces};

/// Islands of a step: a union-find over the active bodies, then over the slots of particle groups. Each kind of member
/// is in one list for all islands: per-island lists would have to grow whenever islands change.
#[derive(Clone, Debug, Default)]
pub(crate) struct Islands {
    /// Active bodies, ascending. Their positions in this list are their numbers in the union-find.
    active: Vec<u32>,
    /// Number of each active body, by slot.
    places: Vec<u32>,
    /// Enabled joints of active bodies, ascending.
    holding: Vec<Tie>,
    /// Contacts that push, ascending.
    touching: Vec<Tie>,
    /// True for each contact, by position in the contact array, of which only one body is active.
    is_border: Vec<bool>,
    /// Memory for `color`.
    border: Vec<u32>,
    parent: Vec<u32>,
    island_of_root: Vec<u32>,
    count: usize,
    bodies: Lists,
    joints: Lists,
    contacts: Lists,
    groups: Lists,
    /// Neighbours of each particle group, by slot.
    neighbors: Vec<Neighbors>,
    /// Groups taken out of the world during the step, ordered by island.
    taken: Vec<TakenGroup>,
    solution: Solution,
    /// True if the solution belongs to the last step, and not to one before a snapshot was loaded.
    is_known: bool,
    /// True for each island that is a free-flying body or a strand and has already been solved in this step.
    flown: Vec<bool>,
    flight: Flight,
    strands: Strands,
    /// Free workspaces: one for each concurrent thread so far.
    idle: Vec<Workspace>,
    /// Workspace of each island, in lockstep mode.
    own: Vec<Workspace>,
}

const NONE: u32 = u32::MAX;

/// A joint or a contact by its index, and the numbers of its bodies; [`NONE`] for a body that is not active.
#[derive(Clone, Copy, Debug)]
struct Tie {
    index: u32,
    bodies: [u32; 2],
}

impl Tie {
    /// Number of the first of the two bodies that is active.
    fn either(self) -> Option<u32> {
        self.bodies.into_iter().find(|&place| place != NONE)
    }
}

impl Islands {
    /// The islands of this step, ordered by their smallest body.
    pub fn iter(&self) -> impl Iterator<Item = Island<'_>> {
        (0..self.count).map(|i| self.at(i))
    }

    fn at(&self, i: usize) -> Island<'_> {
        Island {
            bodies: self.bodies.of(i),
            joints: self.joints.of(i),
            contacts: self.contacts.of(i),
            groups: self.groups.of(i),
            is_flown: self.flown[i],
        }
    }

    /// Sum of the work in all islands.
    pub fn work(&self) -> Work {
        self.solution.work[..self.count].iter().fold(Work::default(), |sum, work| sum + *work)
    }

    /// Results of the islands.
    pub fn solution(&self) -> &Solution {
        &self.solution
    }

    /// Bodies moved by forces in the last step, each once; `None` if unknown.
    pub fn moved(&self) -> Option<impl Iterator<Item = u32>> {
        self.is_known.then(|| self.solution.bodies.iter().map(|body| body.index))
    }

    /// Marks the solution as unknown.
    pub fn forget(&mut self) {
        self.is_known = false;
    }

    /// Computes the islands and takes the particle groups out of the world for the step.
    pub fn find(&mut self, view: &View<'_>, groups: &mut Arena<ParticleGroup>) {
        self.is_known = true;
        self.number(view, groups.slot_count());
        self.join_touching_and_held();
        let first_group = self.active.len() as u32;
        self.neighbors.resize(groups.slot_count(), Neighbors::default());
        for (index, group) in awake(groups) {
            self.neighbors[index as usize].find(group, view);
            for i in 0..self.neighbors[index as usize].bodies.len() {
                let body = self.neighbors[index as usize].bodies[i];
                if let Some(place) = self.place(body) {
                    self.join(first_group + index, place);
                }
            }
        }
        self.join_attracted(view, groups);
        self.collect();
        for (index, _) in awake(groups) {
            let island = self.island_of(first_group + index);
            self.groups.push(island, index);
        }
        for lists in [&mut self.bodies, &mut self.joints, &mut self.contacts, &mut self.groups] {
            lists.sort(self.count, self.parent.len());
        }
        self.flight.clear();
        self.strands.clear();
        self.flown.clear();
        self.flown.reserve(self.parent.len());
        self.flown.resize(self.count, false);
        for (_, group) in groups.iter_mut().filter(|(_, group)| group.is_awake()) {
            group.begin_step();
        }
        self.taken.extend(self.groups.numbers.iter().map(|&index| TakenGroup {
            index,
            group: core::mem::take(groups.at_mut(index)),
            near: core::mem::take(&mut self.neighbors[index as usize]),
        }));
    }

    /// Lists the active bodies and numbers them, in order of their indices, for the union-find.
    fn number(&mut self, view: &View<'_>, groups: usize) {
        let View { bodies, activity, .. } = view;
        for body in self.active.drain(..) {
            self.places[body as usize] = NONE;
        }
        self.active.extend(activity.active());
        self.places.resize(bodies.slot_count(), NONE);
        for (place, &body) in self.active.iter().enumerate() {
            self.places[body as usize] = place as u32;
        }
        self.list_joints(view);
        self.touching.clear();
        self.is_border.clear();
        self.is_border.resize(view.contacts.len(), false);
        for (index, contact) in view.contacts.iter().enumerate().filter(|(_, contact)| contact.pushes()) {
            let bodies = [contact.key.a, contact.key.b].map(|body| self.places[body as usize]);
            self.touching.push(Tie { index: index as u32, bodies });
            self.is_border[index] = bodies.contains(&NONE);
        }
        self.parent.clear();
        self.parent.extend(0..(self.active.len() + groups) as u32);
    }

    /// Lists the enabled joints by index. The later of its active bodies lists each joint: if joints were created after
    /// their bodies, parents first, the list is already sorted.
    fn list_joints(&mut self, view: &View<'_>) {
        self.holding.clear();
        for (place, &body) in self.active.iter().enumerate() {
            for &index in view.activity.joints_of.body(body) {
                let joint = view.joints.at(index);
                let bodies = [joint.a, joint.b].map(|body| self.places[body as usize]);
                let is_later = bodies.iter().all(|&other| other == NONE || other <= place as u32);
                if is_later && joint.is_enabled() {
                    self.holding.push(Tie { index, bodies });
                }
            }
        }
        if !self.holding.is_sorted_by_key(|tie| tie.index) {
            self.holding.sort_unstable_by_key(|tie| tie.index);
        }
    }

    /// Number of a body, if it is active.
    fn place(&self, body: u32) -> Option<u32> {
        Some(self.places[body as usize]).filter(|&place| place != NONE)
    }

    fn join_touching_and_held(&mut self) {
        for at in 0..self.touching.len() {
            self.join_ends(self.touching[at]);
        }
        for at in 0..self.holding.len() {
            self.join_ends(self.holding[at]);
        }
    }

    fn join_ends(&mut self, tie: Tie) {
        let [a, b] = tie.bodies;
        if a != NONE && b != NONE {
            self.join(a, b);
        }
    }

    /// Joins bodies and groups that attract each other through a field to one island.
    fn join_attracted(&mut self, view: &View<'_>, groups: &Arena<ParticleGroup>) {
        for (field, _) in view.fields.mutual() {
            let mut first = None;
            for place in 0..self.active.len() {
                let body = view.bodies.at(self.active[place]);
                if field.reaches(&Target::of_body(body)) {
                    self.join(*first.get_or_insert(place as u32), place as u32);
                }
            }
            for (index, group) in awake(groups) {
                if field.reaches_group(group) {
                    let place = self.active.len() as u32 + index;
                    self.join(*first.get_or_insert(place), place);
                }
            }
        }
    }

    /// Returns the groups to the world.
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

    /// Joins two sets. The smaller root wins, so that the result does not depend on the order of the unions.
    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[u32::max(a, b) as usize] = u32::min(a, b);
    }

    /// Returns the island of the body or group with this number; assigns a new island to the first member of an island.
    fn island_of(&mut self, place: u32) -> u32 {
        let root = self.root(place) as usize;
        if self.island_of_root[root] == NONE {
            self.island_of_root[root] = self.count as u32;
            self.count += 1;
        }
        self.island_of_root[root]
    }

    fn collect(&mut self) {
        self.count = 0;
        for lists in [&mut self.bodies, &mut self.joints, &mut self.contacts, &mut self.groups] {
            lists.clear();
        }
        self.island_of_root.clear();
        self.island_of_root.resize(self.parent.len(), NONE);
        for place in 0..self.active.len() {
            let island = self.island_of(place as u32);
            self.bodies.push(island, self.active[place]);
        }
        for i in 0..self.holding.len() {
            let tie = self.holding[i];
            if let Some(place) = tie.either() {
                let island = self.island_of(place);
                self.joints.push(island, tie.index);
            }
        }
        for i in 0..self.touching.len() {
            let tie = self.touching[i];
            if let Some(place) = tie.either() {
                let island = self.island_of(place);
                self.contacts.push(island, tie.index);
            }
        }
    }

    /// `color`: puts contacts between moving bodies first and those with fixed bodies last, each sorted by key. With
    /// one scalar lane no further colours are needed.
    pub fn color(&mut self) {
        for island in 0..self.count {
            let list = self.contacts.of_mut(island);
            let mut kept = 0;
            self.border.clear();
            for at in 0..list.len() {
                let index = list[at];
                if self.is_border[index as usize] {
                    self.border.push(index);
                } else {
                    list[kept] = index;
                    kept += 1;
                }
            }
            list[kept..].copy_from_slice(&self.border);
        }
    }

    /// `flight`: steps bodies without contacts and joints, and strands; [`run`](Self::run) skips them.
    pub fn fly(&mut self, view: &View<'_>, context: &StepContext<'_>) {
        let mut flight = core::mem::take(&mut self.flight);
        for i in 0..self.count {
            let island = self.at(i);
            if flies(&island, view) {
                flight.add(island.bodies[0], view);
                self.flown[i] = true;
            }
        }
        flight.run(view, context);
        self.flight = flight;
        self.run_strands(view, context, |_| true);
        for strand in self.strands.solved() {
            self.flown[strand.island] = true;
        }
    }

    /// Repeats strands that no object has disturbed after a lockstep step, so that their results are as without
    /// objects.
    pub fn fly_undisturbed(&mut self, view: &View<'_>, context: &StepContext<'_>) {
        let own = core::mem::take(&mut self.own);
        self.run_strands(view, context, |island| !own[island].solver.is_disturbed());
        self.own = own;
        let mut solution = core::mem::take(&mut self.solution);
        self.take_strands(&mut solution);
        self.solution = solution;
    }

    fn run_strands(&mut self, view: &View<'_>, context: &StepContext<'_>, takes: impl Fn(usize) -> bool) {
        let mut strands = core::mem::take(&mut self.strands);
        for i in (0..self.count).filter(|&i| takes(i)) {
            strands.add(i, &self.at(i), view);
        }
        strands.run(view, context);
        self.strands = strands;
    }

    /// Calls `work` once for each remaining island, on `runner`'s threads, for its whole step.
    pub fn run(&mut self, runner: &dyn TaskRunner, work: impl Fn(&mut Task<'_>) + Sync) {
        let mut idle = core::mem::take(&mut self.idle);
        self.run_in(Workspaces::Idle(&mut idle), runner, work);
        self.idle = idle;
    }

    /// Calls `work` once for each remaining island, for a part of its step. Each island keeps its workspace between
    /// parts.
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
        mut workspaces: Workspaces<'_>,
        runner: &dyn TaskRunner,
        work: impl Fn(&mut Task<'_>) + Sync,
    ) {
        let mut solution = core::mem::take(&mut self.solution);
        let mut taken = core::mem::take(&mut self.taken);
        solution.resize(
            self.count,
            self.bodies.numbers.len(),
            self.joints.numbers.len(),
            self.contacts.numbers.len(),
        );
        let mut flown = self.flight.solved();
        for i in (0..self.count).filter(|&i| self.flown[i] && self.joints.range(i).is_empty()) {
            solution.work[i] = Work::default();
            let solved = &mut solution.bodies[self.bodies.range(i).start];
            *solved = flown.next().unwrap_or(*solved);
        }
        self.take_strands(&mut solution);
        let left = self.iter().filter(|island| !island.is_flown).count();
        let large = self.iter().filter(|island| !island.is_flown && island.is_large()).count();
        if large > 0 {
            let queue = Queue::new((self.iter(), true), &mut taken, &mut solution, workspaces.reborrow());
            queue.run(&Serial, large, &work);
        }
        let queue = Queue::new((self.iter(), false), &mut taken, &mut solution, workspaces);
        queue.run(runner, left - large, work);
        (self.solution, self.taken) = (solution, taken);
    }

    /// Copies the results of the strands to `solution`.
    fn take_strands(&self, solution: &mut Solution) {
        for strand in self.strands.solved() {
            solution.work[strand.island] = Work::default();
            let (bodies, joints) = (self.bodies.range(strand.island), self.joints.range(strand.island));
            for (solved, body) in solution.bodies[bodies].iter_mut().zip(strand.bodies()) {
                *solved = body;
            }
            for (solved, joint) in solution.joints[joints].iter_mut().zip(strand.joints()) {
                *solved = joint;
            }
        }
    }

    /// Returns the workspaces and the particle groups, both in the order of islands, between two parts of a step.
    pub fn halted(&mut self) -> (&mut [Workspace], &mut [TakenGroup]) {
        (&mut self.own[..self.count], &mut self.taken)
    }
}

/// Groups that do not sleep, with their slots.
fn awake(groups: &Arena<ParticleGroup>) -> impl Iterator<Item = (u32, &ParticleGroup)> {
    groups.iter().filter(|(_, group)| group.is_awake())
}

/// Ascending lists of numbers, one list per island, contiguous in memory.
#[derive(Clone, Debug, Default)]
struct Lists {
    /// Island and number, in the order pushed.
    pairs: Vec<(u32, u32)>,
    numbers: Vec<u32>,
    /// End of each island's list in `numbers`.
    ends: Vec<usize>,
}

impl Lists {
    fn clear(&mut self) {
        self.pairs.clear();
    }

    fn push(&mut self, island: u32, number: u32) {
        self.pairs.push((island, number));
    }

    /// Builds the lists from the pushed items, each in push order, by counting sort. Reserves space for the `most`
    /// possible islands.
    fn sort(&mut self, islands: usize, most: usize) {
        self.ends.clear();
        self.ends.reserve(most);
        self.ends.resize(islands, 0);
        for &(island, _) in &self.pairs {
            self.ends[island as usize] += 1;
        }
        let mut start = 0;
        for end in &mut self.ends {
            // `end` is the start of the list until the list is filled.
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
