//! How hard the sweeps of an island try, and how hard its contacts are.

use super::IslandSolver;
use super::sweep::Pass;
use sinew_math::{max, min};

/// Visits of all rows per pass, most of which end sooner.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Effort {
    solve: usize,
    relax: usize,
    /// Change of a velocity in a sweep below which there need not be another, m/s or rad/s. What rows would do about less
    /// is left alone.
    pub tolerance: f32,
    /// Of contacts.
    contact: Firmness,
    /// Of those between bodies of one tree of joints.
    within: Firmness,
    pub order: Order,
}

/// How hard a contact is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Firmness {
    /// Softness as a share of what the contact's frequency says.
    pub softness: f32,
    /// Fastest speed with which overlap is pushed apart, m/s.
    pub push_speed: f32,
}

/// Of the contacts in a pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Order {
    /// What cannot move has the last word in each sweep.
    #[default]
    Forward,
    /// Backward in every other sweep, the first among them. If all went one way, tall walls would lean that way.
    ToAndFro,
}

/// Of a heavy body on a jointed light one. What stands on the edge of a foot must sink in a little, or it never comes to rest; but
/// two legs under a heavy body would pass through each other (43 mm of a spider's 1.2 m, against 5 with a hundredth of it). What an
/// impact drove into the ground comes out no faster than 5.5 cm/s: that lifts it by 0.009 J/kg a step at most.
const JOINTED: Effort = Effort {
    solve: 24,
    relax: 24,
    tolerance: 2e-3,
    contact: Firmness { softness: 1.0, push_speed: 0.055 },
    within: Firmness { softness: 0.01, push_speed: 0.5 },
    order: Order::Forward,
};
/// Of contacts of free bodies.
const HARD: Firmness = Firmness { softness: 1e-3, push_speed: 3.0 };
/// Of a pile of bodies that weigh about the same. Nearly hard, which one sweep could not do: a tower of 18 levels fell before its
/// loads were found, and what is soft sinks by a load that its own mass says nothing of. In `relax` two sweeps, since friction of
/// the first knows only the impulses of `solve` (1.5 % too little).
const PILE: Effort =
    Effort { solve: 24, relax: 2, tolerance: 2e-3, contact: HARD, within: HARD, order: Order::ToAndFro };
/// Of a pile that `PILE` is for. What one end of it feels reaches the other in as many sweeps as it has levels: a wall of a hundred
/// leaned by 0.8 m within 17 s.
const LEVELS: f32 = 10.0;
/// The most for high and unequal ones.
const MOST_SOLVE: f32 = 256.0;
const MOST_RELAX: f32 = 128.0;
const LEAST_TOLERANCE: f32 = 1e-6;
/// Beyond this ratio of masses the light ones are squeezed out if what cannot move does not have the last word.
const EVEN: f32 = 4.0;

impl Effort {
    /// For a pile of so many levels with a heaviest body `ratio` times as heavy as the lightest.
    ///
    /// A light body between heavy ones tosses what they do to each other to and fro. Exponents and bounds are what a tower of six
    /// cubes, each 8 times as heavy as the one below it, stands with.
    fn of_pile(levels: u32, ratio: f32) -> Self {
        let root = ratio.sqrt();
        let height = max(1.0, levels as f32 / LEVELS);
        Self {
            solve: min(PILE.solve as f32 * height * root.sqrt(), MOST_SOLVE) as usize,
            relax: min(PILE.relax as f32 * height * root, MOST_RELAX) as usize,
            tolerance: max(PILE.tolerance / (height * ratio), LEAST_TOLERANCE),
            order: if ratio <= EVEN { PILE.order } else { Order::Forward },
            ..PILE
        }
    }

    pub fn sweeps(&self, pass: Pass) -> usize {
        match pass {
            Pass::Relax => self.relax,
            Pass::Solve | Pass::Restitution => self.solve,
        }
    }
}

impl IslandSolver {
    /// After the contacts are there.
    pub(super) fn choose_effort(&mut self) {
        self.effort = if self.is_articulated() {
            JOINTED
        } else {
            Effort::of_pile(self.levels.highest(), self.mass_ratio())
        };
        let tree = |body: u32| self.links.get(body as usize).map(|link| link.tree);
        for rows in &mut self.manifolds {
            let is_within = tree(rows.a).is_some() && tree(rows.a) == tree(rows.b);
            rows.set_firmness(if is_within { self.effort.within } else { self.effort.contact });
        }
    }

    /// Of the heaviest to the lightest of those that touch each other, as they answer to impulses.
    pub(super) fn mass_ratio(&self) -> f32 {
        let moving = &self.bodies[..self.links.len()];
        let (mut lightest, mut heaviest) = (f32::INFINITY, 0.0);
        for rows in &self.manifolds {
            if let (Some(a), Some(b)) = (moving.get(rows.a as usize), moving.get(rows.b as usize)) {
                let [a, b] = [a, b].map(|body| body.mass * body.ballast);
                lightest = min(lightest, min(a, b));
                heaviest = max(heaviest, max(a, b));
            }
        }
        if heaviest > lightest { heaviest / lightest } else { 1.0 }
    }
}
