//! How high the bodies of a pile stand.

use super::squeeze::Touch;

/// The level of a body of which no way to what cannot move is known.
const UNSUPPORTED: u32 = u32::MAX;

/// Per moving body: bodies on the shortest way of touch down to what cannot move, itself among them.
#[derive(Clone, Debug, Default)]
pub(super) struct Levels {
    of: Vec<u32>,
}

impl Levels {
    /// Of so many moving bodies.
    pub fn count(&mut self, moving: usize, touches: &[Touch]) {
        self.of.clear();
        self.of.resize(moving, UNSUPPORTED);
        // To and fro, since bodies are numbered from the bottom up or from the top down more often than at random.
        while self.climb(touches.iter()) && self.climb(touches.iter().rev()) {}
    }

    /// Lowers each body to one level above what it touches; false if all were there already.
    fn climb<'a>(&mut self, touches: impl Iterator<Item = &'a Touch>) -> bool {
        let mut lowered = false;
        for &Touch { bodies: [a, b], .. } in touches {
            for (below, body) in [(a, b), (b, a)] {
                let above = self.of(below).saturating_add(1);
                match self.of.get_mut(body as usize) {
                    Some(level) if above < *level => (*level, lowered) = (above, true),
                    _ => {}
                }
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
