//! How hard the sweeps of an island try, and how hard its contacts are.

use super::contact_rows::ManifoldRows;
use super::sweep::Pass;
use super::{IslandSolver, Scratch, SolverBody};
use sinew_math::{max, min};

/// Visits of all rows per pass, most of which end sooner.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Effort {
    solve: usize,
    relax: usize,
    /// Change of a velocity in a sweep below which there need not be another, m/s or rad/s. What rows would do about less
    /// is left alone.
    pub tolerance: f32,
    /// Softness of contacts as a share of what their frequency says.
    pub softness: f32,
    pub order: Order,
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

/// Of a heavy body on a jointed light one. What stands on the edge of a foot must sink in a little, or it never comes to rest.
const JOINTED: Effort =
    Effort { solve: 24, relax: 24, tolerance: 2e-3, softness: 1.0, order: Order::Forward };
/// Of a pile of bodies that weigh about the same. Nearly hard, which one sweep could not do: a tower of 18 levels fell before its
/// loads were found, and what is soft sinks by a load that its own mass says nothing of. In `relax` two sweeps, since friction of
/// the first knows only the impulses of `solve` (1.5 % too little).
const PILE: Effort = Effort { solve: 24, relax: 2, tolerance: 2e-3, softness: 1e-3, order: Order::ToAndFro };
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
            let ratio = mass_ratio(&self.bodies[..self.links.len()], &self.manifolds);
            Effort::of_pile(self.count_levels(), ratio)
        };
        for rows in &mut self.manifolds {
            rows.soften(self.effort.softness);
        }
    }

    /// Most bodies on the shortest way of touch from a body down to what cannot move; 0 if nothing stands on that.
    fn count_levels(&mut self) -> u32 {
        let Self { manifolds, links, scratch: Scratch { levels, .. }, .. } = self;
        levels.clear();
        levels.resize(links.len(), UNSUPPORTED);
        // To and fro, since bodies are numbered from the bottom up or from the top down more often than at random.
        while climb(manifolds.iter(), levels) && climb(manifolds.iter().rev(), levels) {}
        levels.iter().copied().filter(|&level| level != UNSUPPORTED).fold(0, u32::max)
    }
}

/// The level of a body of which no way to what cannot move is known.
const UNSUPPORTED: u32 = u32::MAX;

/// Lowers each body to one level above what it touches; false if all were there already.
fn climb<'a>(manifolds: impl Iterator<Item = &'a ManifoldRows>, levels: &mut [u32]) -> bool {
    let mut lowered = false;
    for rows in manifolds {
        for (below, body) in [(rows.a, rows.b), (rows.b, rows.a)] {
            let above = levels.get(below as usize).map_or(1, |level| level.saturating_add(1));
            match levels.get_mut(body as usize) {
                Some(level) if above < *level => (*level, lowered) = (above, true),
                _ => {}
            }
        }
    }
    lowered
}

/// Of the heaviest to the lightest of those that touch each other.
fn mass_ratio(moving: &[SolverBody], manifolds: &[ManifoldRows]) -> f32 {
    let (mut lightest, mut heaviest) = (f32::INFINITY, 0.0);
    for rows in manifolds {
        if let (Some(a), Some(b)) = (moving.get(rows.a as usize), moving.get(rows.b as usize)) {
            lightest = min(lightest, min(a.mass, b.mass));
            heaviest = max(heaviest, max(a.mass, b.mass));
        }
    }
    if heaviest > lightest { heaviest / lightest } else { 1.0 }
}
