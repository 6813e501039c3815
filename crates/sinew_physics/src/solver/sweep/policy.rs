//! Sweep policy of an island: number of sweeps, and conditions that end them; and firmness of its contacts.

use crate::body::def::Quality;
use crate::solver::pass::Pass;
use crate::solver::tuning::{
    GRADED_RATIO, HEAP_CONTACTS, LEAST_SWEEP_TOLERANCE, MOST_RELAX_SWEEPS, MOST_SOLVE_SWEEPS, POLICY_LEVELS,
    TO_AND_FRO_RATIO,
};
use sinew_math::{max, min};

/// Number of sweeps of a pass and the conditions that end them.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::solver) struct SweepPolicy {
    solve: usize,
    relax: usize,
    /// Velocity change in a sweep below which no other sweep follows, m/s or rad/s. Rows ignore smaller changes.
    pub tolerance: f32,
    /// Share of the energy of the largest change in the substep below which no other sweep follows. After a hit this leaves a
    /// thirtieth of its speed (in a heap a tenth), and the next substep continues from there.
    pub small: f32,
    /// Speed, m/s, at which a body of the island's mean mass has the energy below which no other sweep follows. With 0 only the
    /// tolerance ends sweeps. For islands with joints.
    pub enough: f32,
    pub order: Order,
    /// First sweep with conjugate steps; for free bodies.
    first_conjugate: usize,
}

/// Hardness of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Firmness {
    /// Softness as a share of that from the contact's frequency.
    pub softness: f32,
    /// Rate at which overlap is corrected, as a multiple of that from the contact's frequency.
    pub bias: f32,
    /// Largest speed at which overlap is pushed apart, m/s.
    pub push_speed: f32,
}

impl Firmness {
    /// For contacts between bodies without joints. Nearly hard: soft contacts sink under any load, for any mass of the bodies,
    /// and a tower of 18 levels fell.
    pub const FREE: Self = Self { softness: 1e-3, bias: 1.0, push_speed: 3.0 };
    /// For contacts of jointed bodies. A body on the edge of a foot must sink in slightly; otherwise it never comes to rest. Overlap
    /// from an impact is pushed out at no more than 5.5 cm/s: that adds at most 0.009 J/kg a step.
    pub const JOINTED: Self = Self { softness: 1.0, bias: 1.0, push_speed: 0.055 };
    /// For contacts between a jointed body and a free one. The support of a pile must be as hard as the pile; otherwise a tower of
    /// unequal masses falls with a jointed pair on it.
    pub const ON_FREE: Self = Self { softness: 1e-3, bias: 1.0, push_speed: 0.055 };
    /// For contacts between two bodies of one tree of joints. Softer contacts let two legs under a heavy body pass through each other
    /// (43 mm of a spider's 1.2 m, against 5 with a hundredth of the softness). Corrected four times as fast as others: joint
    /// corrections for the arc of a turning limb press it into an obstacle by `½ ω² r h`, 5 cm/s at 7 rad/s.
    pub const WITHIN_TREE: Self = Self { softness: 0.01, bias: 4.0, push_speed: 0.5 };
}

/// Order of the contacts in a pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::solver) enum Order {
    /// Always forward: contacts with fixed bodies come last in each sweep.
    #[default]
    Forward,
    /// Backward in every other sweep, the first among them. With one direction only, tall walls would lean to one side.
    ToAndFro,
}

/// Sweep policy for islands with joints that are swept with the response of all links. Changes soon become negligible: a quarter
/// of all passes of falling ragdolls went through all 24 sweeps for a thousandth of the first one's energy.
pub(super) const JOINTED: SweepPolicy = SweepPolicy {
    solve: 24,
    relax: 24,
    tolerance: 2e-3,
    small: 0.0,
    enough: 0.01,
    order: Order::Forward,
    first_conjugate: 1,
};
/// Sweep policy for heaps in which contacts and trees are solved by turns. Most sweeps of a heap at rest end with the second; in
/// a crash all are needed (a chain of 70 links sank 85 mm into a wall with four).
pub(super) const TURNS: SweepPolicy = SweepPolicy {
    solve: 6,
    relax: 4,
    tolerance: 0.05,
    small: 0.0,
    enough: 0.1,
    order: Order::Forward,
    first_conjugate: 1,
};
/// Sweep policy for few bodies of similar mass: an overhang that almost tips over needs 24 sweeps. In `relax` two (more for
/// unequal masses), since friction of the first uses only the impulses of `solve` (1.5 % too small).
const PILE: SweepPolicy = SweepPolicy {
    solve: 24,
    relax: 2,
    tolerance: 5e-4,
    small: 1e-3,
    enough: 0.0,
    order: Order::ToAndFro,
    first_conjugate: 4,
};
/// Sweep policy for a pile or heap of [`HEAP_CONTACTS`] contacts. Known or guessed loads need few sweeps, and the loads of falling
/// bodies converge over some substeps. However unequal the masses, the many contacts share the error of each one.
const HEAP: SweepPolicy = SweepPolicy { solve: 5, relax: 4, first_conjugate: 2, ..PILE };
/// Sweep policy for unequal masses: the impulses of heavy bodies on a light one between them alternate from sweep to sweep, and
/// contacts with fixed bodies must come last.
const UNEQUAL: SweepPolicy =
    SweepPolicy { solve: 96, tolerance: 2e-3, small: 0.0, order: Order::Forward, first_conjugate: 4, ..PILE };

/// Smallest policy in `relax` for islands in which particle springs hold a body that bears a heavy load. The springs carry the
/// whole load by pushing that body alone, and the contacts must transmit all of it in one pass; otherwise a box of 100 kg on a
/// plank of 5 kg on ropes turns and gains energy. Twelve sweeps suffice for that box; 24 leave a margin.
pub(in crate::solver) const HUNG: SweepPolicy = SweepPolicy {
    solve: 0,
    relax: 24,
    tolerance: 1e-5,
    small: 0.0,
    enough: 0.0,
    order: Order::Forward,
    first_conjugate: 1,
};

impl SweepPolicy {
    /// Returns the policy for a pile of `levels` levels and `contacts` contacts, with a heaviest body `ratio` times as heavy as the
    /// lightest.
    ///
    /// Impulses of heavy bodies on a light one between them alternate from sweep to sweep. Exponents and bounds were chosen so that a
    /// tower of six cubes stands, each 8 times as heavy as the one below it.
    pub(super) fn of_pile(levels: u32, ratio: f32, contacts: usize) -> Self {
        let root = ratio.sqrt();
        if ratio <= GRADED_RATIO {
            let relax = (PILE.relax as f32 * root) as usize;
            let even = if contacts < HEAP_CONTACTS { Self { relax, ..PILE } } else { HEAP };
            return Self {
                order: if ratio <= TO_AND_FRO_RATIO { even.order } else { Order::Forward },
                ..even
            };
        }
        let height = max(1.0, levels as f32 / POLICY_LEVELS);
        Self {
            solve: min(UNEQUAL.solve as f32 * height * root.sqrt(), MOST_SOLVE_SWEEPS) as usize,
            relax: min(UNEQUAL.relax as f32 * height * root, MOST_RELAX_SWEEPS) as usize,
            tolerance: max(UNEQUAL.tolerance / (height * ratio), LEAST_SWEEP_TOLERANCE),
            ..UNEQUAL
        }
    }

    /// Returns a policy with fewer or more sweeps, and larger or smaller tolerances.
    pub(super) fn of_quality(self, quality: Quality) -> Self {
        let [sweeps, finer] = match quality {
            Quality::Fast => [0.5, 2.0],
            Quality::Balanced => return self,
            Quality::Exact => [2.0, 0.25],
        };
        let times = |most: usize| usize::max((most as f32 * sweeps) as usize, 1);
        Self {
            solve: times(self.solve),
            relax: times(self.relax),
            tolerance: self.tolerance * finer,
            small: self.small * finer,
            enough: self.enough * finer,
            ..self
        }
    }

    /// Sweeps for contacts in blocks.
    pub fn of_blocks(&self, pass: Pass) -> Sweeps {
        let most = self.sweeps(pass);
        let Self { tolerance, small, order, first_conjugate, .. } = *self;
        Sweeps { most, tolerance, small, order, first_conjugate }
    }

    /// Sweeps for contacts and trees by turns.
    pub fn of_turns(&self, pass: Pass) -> Sweeps {
        Sweeps { first_conjugate: 1, ..self.of_blocks(pass) }
    }

    /// Returns the larger numbers of sweeps and the smaller tolerances of both policies, with the order of this one: for trees solved
    /// by turns, backward sweeps let bodies under joints creep (a tower of 18 levels under a rope fell).
    pub(in crate::solver) fn at_least(self, other: Self) -> Self {
        Self {
            solve: usize::max(self.solve, other.solve),
            relax: usize::max(self.relax, other.relax),
            tolerance: min(self.tolerance, other.tolerance),
            small: min(self.small, other.small),
            enough: min(self.enough, other.enough),
            order: self.order,
            first_conjugate: self.first_conjugate,
        }
    }

    pub fn sweeps(&self, pass: Pass) -> usize {
        match pass {
            Pass::Relax => self.relax,
            Pass::Solve | Pass::Restitution => self.solve,
        }
    }
}

/// Number of sweeps of a pass, the velocity change in a sweep below which no other sweep follows, m/s or rad/s, and their order.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct Sweeps {
    pub most: usize,
    pub tolerance: f32,
    /// Share of the energy of the substep's largest change below which no other sweep follows.
    pub small: f32,
    pub order: Order,
    /// First sweep with a conjugate step.
    pub first_conjugate: usize,
}
