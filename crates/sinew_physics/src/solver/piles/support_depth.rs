//! Support depth of the bodies of a pile: the number of levels from the ground.

use crate::solver::piles::touch::Touch;

/// The level of a body without a known path to the ground.
const UNSUPPORTED: u32 = u32::MAX;

/// For each body: number of bodies on the shortest path of touches down to a fixed body, the body itself included.
#[derive(Clone, Debug, Default)]
pub(in crate::solver) struct SupportDepth {
    of: Vec<u32>,
}

impl SupportDepth {
    /// Computes the levels of `bodies` bodies, of which the first `moving` move.
    pub fn count(&mut self, moving: usize, bodies: usize, touches: &[Touch]) {
        self.of.clear();
        self.of.resize(moving, UNSUPPORTED);
        self.of.resize(bodies, 0);
        // Touches with the ground come last. Directions alternate afterwards, since bodies are usually numbered from
        // the bottom up or from the top down.
        let moves = |touch: &Touch| touch.bodies.iter().all(|&body| (body as usize) < moving);
        self.climb(touches[touches.iter().rposition(moves).map_or(0, |last| last + 1)..].iter());
        while self.climb(touches.iter()) && self.climb(touches.iter().rev()) {}
    }

    /// Lowers each body to one level above a body that it touches; returns false if nothing changed.
    fn climb<'a>(&mut self, touches: impl Iterator<Item = &'a Touch>) -> bool {
        let mut lowered = false;
        for &Touch { bodies: [a, b], .. } in touches {
            let [of_a, of_b] = [a, b].map(|body| self.of[body as usize]);
            if of_b > of_a.saturating_add(1) {
                (self.of[b as usize], lowered) = (of_a + 1, true);
            } else if of_a > of_b.saturating_add(1) {
                (self.of[a as usize], lowered) = (of_b + 1, true);
            }
        }
        lowered
    }

    /// Level of a body; 0 for a fixed body.
    pub fn of(&self, body: u32) -> u32 {
        self.of.get(body as usize).copied().unwrap_or(0)
    }

    /// The highest level; 0 if no body stands on a fixed one.
    pub fn highest(&self) -> u32 {
        self.of.iter().copied().filter(|&level| level != UNSUPPORTED).fold(0, u32::max)
    }
}
