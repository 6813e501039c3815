//! Support depth of the bodies of a pile: how high each of them stands.

use crate::solver::piles::touch::Touch;

/// The level of a body of which no way to what cannot move is known.
const UNSUPPORTED: u32 = u32::MAX;

/// Per body: bodies on the shortest way of touch down to what cannot move, itself among them.
#[derive(Clone, Debug, Default)]
pub(in crate::solver) struct SupportDepth {
    of: Vec<u32>,
}

impl SupportDepth {
    /// Counts the levels of `bodies` bodies, of which the first `moving` move.
    pub fn count(&mut self, moving: usize, bodies: usize, touches: &[Touch]) {
        self.of.clear();
        self.of.resize(moving, UNSUPPORTED);
        self.of.resize(bodies, 0);
        // What touches the ground comes last. Then to and fro, since bodies are numbered from the bottom up or from the top down more often than at random.
        let moves = |touch: &Touch| touch.bodies.iter().all(|&body| (body as usize) < moving);
        self.climb(touches[touches.iter().rposition(moves).map_or(0, |last| last + 1)..].iter());
        while self.climb(touches.iter()) && self.climb(touches.iter().rev()) {}
    }

    /// Lowers each body to one level above what it touches; false if all were there already.
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

    /// 0 of what cannot move.
    pub fn of(&self, body: u32) -> u32 {
        self.of.get(body as usize).copied().unwrap_or(0)
    }

    /// 0 if nothing stands on what cannot move.
    pub fn highest(&self) -> u32 {
        self.of.iter().copied().filter(|&level| level != UNSUPPORTED).fold(0, u32::max)
    }
}
