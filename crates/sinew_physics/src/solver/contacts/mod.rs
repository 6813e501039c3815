//! Contacts of an island in lanes: eight manifolds without a common moving body are solved together, by block Gauss-Seidel in impulse space
//! over the bodies' own masses, colour after colour.
//!
//! Rows are built once a step. From substep to substep only separations change; they are updated exactly from the motion of the bodies. The
//! manifold of a body that turns fast is recomputed and written to its lane.

mod block;
mod chunks;
mod classes;
mod color;
mod conjugate;
mod disk;
mod geometry;
mod memory;
mod place;
mod prepare;
mod record;
mod refresh;
mod store;
mod visit;
mod write;

pub(super) use prepare::{OfStep, placed};
pub(super) use record::Added;
pub(super) use refresh::Substep;

use crate::runner::TaskRunner;
use crate::slices::SharedRows;
use crate::solver::body::SolverBody;
use crate::solver::contacts::classes::{Class, Color, Each, Visitor};
use crate::solver::pass::Pass;
use crate::solver::sweep::policy::{Order, Sweeps};
use crate::solver::tuning::{FRICTION_BOUND_UPDATES, RELAX_TURN};
use crate::spatial::{self, Vec6, ZERO6, add_scaled, angular};
use block::{Block, Bounce, Memory, Rolling, ZERO8};
use chunks::{Parted, parted, shared};
use color::Coloring;
use conjugate::Conjugate;
use record::{Extra, Record};
use refresh::Found;
use sinew_math::dispatch::{self};
use sinew_math::lanes::Lanes;
use sinew_math::max;
use visit::Sweep;

/// All contacts of an island.
#[derive(Clone, Debug, Default)]
pub(crate) struct Contacts {
    one: Class<1, 1>,
    two: Class<2, 3>,
    four: Class<4, 10>,
    colors: Vec<Color>,
    rolling: Vec<Rolling>,
    coloring: Coloring,
    /// Records of the contacts in the order in which they were added, and the extra data that few of them have.
    records: Vec<Record>,
    extras: Vec<Extra>,
    /// True if a surface moves relative to its body, or launches bodies.
    drives: bool,
    /// Inverse mass and inertia of each body: 1/m, then xx, yy, zz, yz, xz, xy.
    inverse: Vec<Vec6>,
    /// World position of each body's centre at the start of the step, metres: x, y, z.
    centers: Vec<Vec6>,
    /// Motion of each body since the step began: translation, then rotation.
    moved: Vec<Vec6>,
    /// Angle through which each body has turned in the step so far, radians.
    turned: Vec<f32>,
    found: Vec<Found>,
    conjugate: Conjugate,
    /// Largest velocity change of each body in a conjugate step, by component, m/s or rad/s.
    changes: Vec<f32>,
    /// Largest energy of a sweep in this substep, J.
    most_energy: f32,
    is_spoiled: bool,
    tally: Tally,
}

/// Counts of the sweeps in a step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tally {
    pub manifolds: u64,
    pub points: u64,
    /// Number of manifolds that sweeps visited, and the bytes of their blocks.
    pub visits: u64,
    pub visited_bytes: u64,
}

/// Declares a visitor: its fields, and its operation on a block.
macro_rules! visitor {
    ($(#[$doc:meta])* $name:ident $(<$life:lifetime>)? { $($field:ident: $type:ty),* },
     |$self:ident, $block:ident, $memory:ident, $bounces:ident| $body:expr) => {
        $(#[$doc])*
        struct $name $(<$life>)? { $($field: $type),* }

        impl $(<$life>)? Visitor for $name $(<$life>)? {
            #[inline(always)]
            fn visit<L: Lanes, const N: usize, const T: usize>(
                &mut $self,
                $block: &mut Block<N, T>,
                $memory: &mut Memory<N>,
                $bounces: &mut [Bounce<N>],
            ) {
                $body
            }
        }
    };
}

visitor!(
    /// Recomputes the responses of rewritten blocks.
    Respond<'a> { inverse: &'a [Vec6], all: bool },
    |self, block, _memory, _bounces| {
        if core::mem::take(&mut block.is_stale) || self.all {
            place::take_inertias::<L, N, T>(block, self.inverse);
            place::respond::<L, N, T>(block);
        }
    }
);

parted!(Respond<'_>);

visitor!(
    /// Computes separations at the present poses.
    Measure<'a> { moved: &'a [Vec6] },
    |self, block, memory, _bounces| place::measure::<L, N, T>(block, memory, &place::Moved(self.moved))
);

parted!(Measure<'_>);

visitor!(
    /// Sets the target rates of the points in a pass.
    Aim { pass: Pass, h: f32 },
    |self, block, memory, bounces| {
        if self.pass == Pass::Restitution && memory.bounce != block::NONE {
            bounces[memory.bounce as usize].held = block.impulse;
        }
        place::aim::<L, N, T>(block, memory, bounces, self.pass, self.h);
    }
);

parted!(Aim);

visitor!(
    /// Raises the lower bounds of impulses in `relax`.
    RaiseFloor<'a> { velocities: &'a [Vec6], h: f32 },
    |self, block, _memory, _bounces| place::raise_floor::<L, N, T>(block, self.velocities, self.h)
);

visitor!(
    /// Applies the starting impulses.
    WarmStart<'a> { rolling: SharedRows<'a, Rolling>, velocities: SharedRows<'a, Vec6> },
    |self, block, memory, _bounces| {
        memory::warm_start::<L, N, T>(block, memory, &mut self.rolling, &mut self.velocities);
    }
);

parted!(WarmStart<'_>);

visitor!(
    /// Adds the impulses of all rows to those of the bodies.
    AddImpulses<'a> { rolling: &'a [Rolling], impulses: &'a mut [Vec6], sign: f32 },
    |self, block, _memory, _bounces| {
        memory::add_impulses::<L, N, T>(block, self.rolling, self.impulses, self.sign);
    }
);

visitor!(
    /// Stores the impulses for the next substep.
    EndSubstep { h: f32 },
    |self, block, memory, _bounces| memory::end_substep::<L, N, T>(block, memory, self.h)
);

parted!(EndSubstep);

visitor!(
    /// Records the approach of the points.
    BeginApproach<'a> { velocities: &'a [Vec6] },
    |self, block, memory, bounces| {
        if memory.bounce != block::NONE {
            memory::begin_approach::<L, N, T>(block, &mut bounces[memory.bounce as usize], self.velocities);
        }
    }
);

visitor!(
    /// Records the speed toward the surface added by forces.
    PullApproach<'a> { velocities: &'a [Vec6] },
    |self, block, memory, bounces| {
        if memory.bounce != block::NONE {
            memory::pull_approach::<L, N, T>(block, &mut bounces[memory.bounce as usize], self.velocities);
        }
    }
);

visitor!(
    /// Finds the points that will bounce.
    EndApproach { h: f32, any: bool },
    |self, block, memory, bounces| {
        if memory.bounce != block::NONE {
            let bounce = &mut bounces[memory.bounce as usize];
            memory::end_approach::<L, N, T>(block, bounce, L::load(&memory.restitution), self.h);
            self.any |= bounce.rebound.iter().flatten().any(|&speed| speed > 0.0);
        }
    }
);

visitor!(
    /// Restores the impulses after the bounce.
    EndBounce {},
    |self, block, memory, bounces| {
        if memory.bounce != block::NONE {
            memory::end_bounce::<L, N, T>(block, memory, &bounces[memory.bounce as usize]);
        }
    }
);

impl Visitor for Sweep<'_> {
    #[inline(always)]
    fn visit<L: Lanes, const N: usize, const T: usize>(
        &mut self,
        block: &mut Block<N, T>,
        _: &mut Memory<N>,
        _: &mut [Bounce<N>],
    ) {
        self.visit_block::<L, N, T>(block);
    }
}

/// Result of one sweep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Swept {
    /// Largest change of a velocity component, m/s or rad/s.
    pub largest: f32,
    /// Sum of the energies of the blocks' changes, J.
    pub energy: f32,
}

impl Contacts {
    pub fn is_empty(&self) -> bool {
        self.colors.is_empty()
    }

    /// Visits every block, colour by colour.
    fn each<V: Visitor>(&mut self, visitor: V) -> V {
        let Self { one, two, four, colors, .. } = self;
        dispatch::run(Each { one, two, four, colors, visitor })
    }

    /// Computes separations at the present poses. The caller rewrites the manifolds of bodies that turn fast.
    fn measure(&mut self, bodies: &[SolverBody], starts: &[sinew_math::Transform], runner: &dyn TaskRunner) {
        self.moved.clear();
        for (body, start) in bodies.iter().zip(starts) {
            let by = body.pose.translation - start.translation;
            let turned = body.pose.rotation * start.rotation.inverse();
            self.moved.push([by.x, by.y, by.z, turned.x, turned.y, turned.z, turned.w, 0.0]);
        }
        let moved = core::mem::take(&mut self.moved);
        self.each_at_once(runner, Measure { moved: &moved });
        self.moved = moved;
    }

    /// Takes inverse masses and inertias of bodies at their present poses; those of fixed bodies, from `moving` on, are zero.
    fn take_inertias(&mut self, bodies: &[SolverBody], moving: usize) {
        self.inverse.clear();
        self.inverse.extend(bodies.iter().enumerate().map(|(i, body)| {
            if i >= moving {
                return ZERO6;
            }
            let m = body.inverse_inertia;
            let inverse_mass = 1.0 / (body.mass * body.mass_scale);
            let (d, o) = (m.diagonal, m.off);
            [inverse_mass, d.x, d.y, d.z, o.x, o.y, o.z, 0.0]
        }));
    }

    fn respond(&mut self, runner: &dyn TaskRunner) {
        let inverse = core::mem::take(&mut self.inverse);
        let all = core::mem::take(&mut self.is_spoiled);
        self.each_at_once(runner, Respond { inverse: &inverse, all });
        self.inverse = inverse;
    }

    /// Marks all responses for recomputation after inertias have changed.
    pub fn spoil(&mut self) {
        self.is_spoiled = true;
    }

    /// Records the approach of the points at the start of the substep.
    pub fn begin_approach(&mut self, velocities: &[Vec6]) {
        if self.may_bounce() {
            self.each(BeginApproach { velocities });
        }
    }

    /// Records the speed toward the surface added by forces.
    pub fn pull_approach(&mut self, velocities: &[Vec6]) {
        if self.may_bounce() {
            self.each(PullApproach { velocities });
        }
    }

    /// Finds the points that will bounce. Returns true if there are any.
    pub fn end_approach(&mut self, h: f32) -> bool {
        self.may_bounce() && self.each(EndApproach { h, any: false }).any
    }

    fn may_bounce(&self) -> bool {
        !(self.one.bounces.is_empty() && self.two.bounces.is_empty() && self.four.bounces.is_empty())
    }

    /// Applies the starting impulses to the bodies.
    pub fn warm_start(&mut self, velocities: &mut [Vec6], runner: &dyn TaskRunner) {
        let mut rolling = core::mem::take(&mut self.rolling);
        let visitor = WarmStart { rolling: shared(&mut rolling), velocities: shared(velocities) };
        self.each_parted(runner, Order::Forward, visitor);
        self.rolling = rolling;
    }

    /// Sweeps over all blocks until the velocities stop changing. Returns the number of sweeps.
    pub fn sweep(
        &mut self,
        pass: Pass,
        sweeps: Sweeps,
        velocities: &mut [Vec6],
        (h, runner): (f32, &dyn TaskRunner),
    ) -> usize {
        if self.is_empty() {
            return 0;
        }
        self.begin_pass(pass, velocities, h, runner);
        if pass == Pass::Solve {
            self.most_energy = 0.0;
        }
        for done in 1..=sweeps.most {
            let conjugate = done >= sweeps.first_conjugate && pass != Pass::Restitution;
            if conjugate {
                self.before_conjugate(velocities, &[]);
            }
            let swept = self.sweep_once((pass, sweeps, done), velocities, runner);
            // From the second sweep on, friction uses the present loads.
            self.most_energy = max(self.most_energy, swept.energy);
            let is_small = swept.energy < sweeps.small * self.most_energy;
            if (done > 1 || pass == Pass::Solve) && (is_small || swept.largest < sweeps.tolerance) {
                return done;
            }
            if conjugate && done < sweeps.most {
                self.after_conjugate(swept.energy, (velocities, &mut []), runner, None);
            }
        }
        sweeps.most
    }

    /// Prepares the first sweep of a pass.
    pub fn begin_pass(&mut self, pass: Pass, velocities: &[Vec6], h: f32, runner: &dyn TaskRunner) {
        if self.may_bounce() {
            self.each(Aim { pass, h });
        } else {
            self.each_at_once(runner, Aim { pass, h });
        }
        let whirls = |v: &Vec6| angular(v).length() * h >= RELAX_TURN;
        if pass == Pass::Relax && velocities.iter().any(whirls) {
            self.each(RaiseFloor { velocities, h });
        }
        self.start_conjugate();
    }

    /// Visits all blocks; `done` counts from 1.
    pub fn sweep_once(
        &mut self,
        (pass, sweeps, done): (Pass, Sweeps, usize),
        velocities: &mut [Vec6],
        runner: &dyn TaskRunner,
    ) -> Swept {
        let is_backward = sweeps.order == Order::ToAndFro && !done.is_multiple_of(2);
        let order = if is_backward { Order::ToAndFro } else { Order::Forward };
        let mut rolling = core::mem::take(&mut self.rolling);
        let visitor = Sweep {
            velocities: shared(velocities),
            rolling: shared(&mut rolling),
            pass,
            step: self.conjugate.step,
            updates_friction_bound: done <= FRICTION_BOUND_UPDATES,
            largest: ZERO8,
            energy: ZERO8,
        };
        let Sweep { largest, energy, .. } = self.each_parted(runner, order, visitor);
        self.rolling = rolling;
        self.tally.visits += self.tally.manifolds;
        self.tally.visited_bytes += self.swept_bytes() as u64;
        Swept { largest: spatial::largest(&largest), energy: energy.iter().sum() }
    }

    /// Returns the counts of the step so far.
    pub fn tally(&self) -> Tally {
        self.tally
    }

    /// Size of the data that a sweep visits, bytes.
    fn swept_bytes(&self) -> usize {
        self.one.swept_bytes() + self.two.swept_bytes() + self.four.swept_bytes()
    }

    /// Size of the blocks, bytes.
    pub fn bytes(&self) -> usize {
        self.one.bytes() + self.two.bytes() + self.four.bytes()
    }

    /// Adds the impulses of all rows in this substep, times `sign`, to those of the moving bodies.
    pub fn add_impulses(&mut self, impulses: &mut [Vec6], sign: f32) {
        if self.is_empty() {
            return;
        }
        let (rolling, mut given) = (core::mem::take(&mut self.rolling), core::mem::take(&mut self.moved));
        given.clear();
        given.resize(self.inverse.len(), ZERO6);
        self.each(AddImpulses { rolling: &rolling, impulses: &mut given, sign });
        for (sum, given) in impulses.iter_mut().zip(&given) {
            add_scaled(sum, given, 1.0);
        }
        (self.rolling, self.moved) = (rolling, given);
    }

    /// Stores the impulses of this substep for the next one.
    pub fn end_substep(&mut self, h: f32, runner: &dyn TaskRunner) {
        self.each_at_once(runner, EndSubstep { h });
    }

    /// Restores the impulses after the bounce.
    pub fn end_bounce(&mut self) {
        self.each(EndBounce {});
    }
}
