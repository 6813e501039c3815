//! Sweep policy of an island: number and end of its sweeps; and firmness of its contacts.

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
    /// Velocity change in a sweep below which no other follows, m/s or rad/s. Rows ignore smaller changes.
    pub tolerance: f32,
    /// Share of the energy of the largest change in the substep below which no other sweep follows. After a hit this leaves a thirtieth of its
    /// speed (in a heap a tenth), and the next substep continues from there.
    pub small: f32,
    /// Speed, m/s, at which a body of the island's mean mass has the energy below which no other sweep follows; 0: only the tolerance ends
    /// sweeps. For islands with joints.
    pub enough: f32,
    pub order: Order,
    /// First sweep with conjugate steps; for free bodies.
    first_conjugate: usize,
}

/// Hardness of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Firmness {
    /// Softness as a share of what the contact's frequency says.
    pub softness: f32,
    /// Rate with which overlap is corrected, as a multiple of what the contact's frequency says.
    pub bias: f32,
    /// Fastest speed with which overlap is pushed apart, m/s.
    pub push_speed: f32,
}

impl Firmness {
    /// Between bodies that no joint holds. Nearly hard: what is soft sinks by a load that its own mass says nothing of, and a tower
    /// of 18 levels fell.
    pub const FREE: Self = Self { softness: 1e-3, bias: 1.0, push_speed: 3.0 };
    /// Firmness of contacts of a body that a joint holds. What stands on the edge of a foot must sink in a little, or it never comes
    /// to rest. What an impact drove in comes out no faster than 5.5 cm/s: that lifts it by 0.009 J/kg a step at most.
    pub const JOINTED: Self = Self { softness: 1.0, bias: 1.0, push_speed: 0.055 };
    /// Between a jointed body and one that moves by itself: what a pile bears on must be as hard as the pile, or a tower of unequal
    /// masses falls with a jointed pair on it.
    pub const ON_FREE: Self = Self { softness: 1e-3, bias: 1.0, push_speed: 0.055 };
    /// Between two bodies of one tree of joints: two legs under a heavy body would pass through each other (43 mm of a spider's
    /// 1.2 m, against 5 with a hundredth of the softness). Corrected four times as fast as others: joints corrected for the arc of
    /// a turning limb press it into what it touches by `½ ω² r h`, 5 cm/s at 7 rad/s.
    pub const WITHIN_TREE: Self = Self { softness: 0.01, bias: 4.0, push_speed: 0.5 };
}

/// Order of the contacts in a pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::solver) enum Order {
    /// Always forward: what cannot move has the last word in each sweep.
    #[default]
    Forward,
    /// Backward in every other sweep, the first among them. If all went one way, tall walls would lean that way.
    ToAndFro,
}

/// Sweep policy for islands with joints that are swept with the response of all links. What a sweep changes is soon next to nothing: a quarter of all
/// passes of falling figures went through all 24 for a thousandth of the first one's energy.
pub(super) const JOINTED: SweepPolicy = SweepPolicy {
    solve: 24,
    relax: 24,
    tolerance: 2e-3,
    small: 0.0,
    enough: 0.01,
    order: Order::Forward,
    first_conjugate: 1,
};
/// Sweep policy for heaps in which contacts and trees are solved by turns: most sweeps of a heap at rest end with the second, those
/// of a crash are needed (a chain of 70 links sank 85 mm into a wall with four).
pub(super) const TURNS: SweepPolicy = SweepPolicy {
    solve: 6,
    relax: 4,
    tolerance: 0.05,
    small: 0.0,
    enough: 0.1,
    order: Order::Forward,
    first_conjugate: 1,
};
/// Sweep policy for few bodies that weigh about the same: an overhang that all but tips over wants 24 sweeps. In `relax`
/// two (more, the more unequal masses are), since friction of the first knows only the impulses of `solve` (1.5 % too little).
const PILE: SweepPolicy = SweepPolicy {
    solve: 24,
    relax: 2,
    tolerance: 5e-4,
    small: 1e-3,
    enough: 0.0,
    order: Order::ToAndFro,
    first_conjugate: 4,
};
/// Sweep policy for a pile or heap of [`HEAP_CONTACTS`]. Loads that are known or guessed need few sweeps to be held, and what falls finds its loads
/// over some substeps. However unequal masses are, it has many contacts that share what one of them is wrong by.
const HEAP: SweepPolicy = SweepPolicy { solve: 5, relax: 4, first_conjugate: 2, ..PILE };
/// Sweep policy for unequal masses: a light body between heavy ones tosses what they do to each other to and fro, and what cannot move must have the
/// last word.
const UNEQUAL: SweepPolicy =
    SweepPolicy { solve: 96, tolerance: 2e-3, small: 0.0, order: Order::Forward, first_conjugate: 4, ..PILE };

/// At least, in `relax`, for islands in which springs of particles hold a body that bears a heavy load: they bear all that lies on it by pushing
/// it alone, and the contacts have to pass that on whole in one pass, or a box of 100 kg on a plank of 5 kg on ropes turns and gains energy.
/// Twelve sweeps are enough for that.
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
    /// For a pile of so many levels and contacts with a heaviest body `ratio` times as heavy as the lightest.
    ///
    /// A light body between heavy ones tosses what they do to each other to and fro. Exponents and bounds are what a tower of six
    /// cubes, each 8 times as heavy as the one below it, stands with.
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

    /// Fewer or more sweeps, which end later or sooner.
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

    /// Sweeps of contacts in blocks.
    pub fn of_blocks(&self, pass: Pass) -> Sweeps {
        let most = self.sweeps(pass);
        let Self { tolerance, small, order, first_conjugate, .. } = *self;
        Sweeps { most, tolerance, small, order, first_conjugate }
    }

    /// Sweeps of contacts and trees by turns.
    pub fn of_turns(&self, pass: Pass) -> Sweeps {
        Sweeps { first_conjugate: 1, ..self.of_blocks(pass) }
    }

    /// As long as the longer of two, in the order of this one: where trees have their turns, backward sweeps let what stands under
    /// joints creep (a tower of 18 levels under a rope fell).
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

/// Most sweeps of a pass, the change of a velocity in one below which there is no other, m/s or rad/s, and their order.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct Sweeps {
    pub most: usize,
    pub tolerance: f32,
    /// Share of the energy of the substep's largest change that is small enough for there to be no other sweep.
    pub small: f32,
    pub order: Order,
    /// The sweep from which on they are conjugate steps.
    pub first_conjugate: usize,
}
