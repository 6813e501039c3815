//! Sets of slots of an arena.

/// Set of slots with one bit per slot, so that iteration is in ascending order. A second level of bits over the words
/// of the first makes visiting a few members among a million slots cheap.
#[derive(Clone, Debug, Default)]
pub(crate) struct SlotSet {
    members: Vec<u64>,
    /// One bit per non-zero word of `members`.
    words: Vec<u64>,
}

const BITS: u32 = u64::BITS;

impl SlotSet {
    /// Reserves the slots below `count`.
    pub fn reserve(&mut self, count: usize) {
        let words = count.div_ceil(BITS as usize);
        if words > self.members.len() {
            self.members.resize(words, 0);
            self.words.resize(words.div_ceil(BITS as usize), 0);
        }
    }

    /// Adds or removes a slot, which must be reserved.
    pub fn set(&mut self, slot: u32, member: bool) {
        let word = slot / BITS;
        let bits = &mut self.members[word as usize];
        set_bit(bits, slot % BITS, member);
        let any = *bits != 0;
        set_bit(&mut self.words[(word / BITS) as usize], word % BITS, any);
    }

    /// Members, ascending.
    pub fn iter(&self) -> impl Iterator<Item = u32> {
        let filled = self.words.iter().enumerate().flat_map(|(i, &bits)| ones(i as u32 * BITS, bits));
        filled.flat_map(|word| ones(word * BITS, self.members[word as usize]))
    }
}

fn set_bit(bits: &mut u64, bit: u32, on: bool) {
    *bits = *bits & !(1 << bit) | u64::from(on) << bit;
}

/// Positions of the set bits, counted from `first`.
fn ones(first: u32, mut bits: u64) -> impl Iterator<Item = u32> {
    core::iter::from_fn(move || {
        let place = (bits != 0).then(|| first + bits.trailing_zeros());
        bits &= bits.wrapping_sub(1);
        place
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_math::Random;
    use std::collections::BTreeSet;

    #[test]
    fn slot_set_equals_a_sorted_set() {
        let mut random = Random::new(5);
        let (mut set, mut expected) = (SlotSet::default(), BTreeSet::new());
        for most in [1, 64, 65, 5000, 70_000] {
            set.reserve(most);
            for _ in 0..400 {
                let slot = random.index(most) as u32;
                let member = random.index(3) > 0;
                set.set(slot, member);
                if member {
                    expected.insert(slot)
                } else {
                    expected.remove(&slot)
                };
            }
            assert!(set.iter().eq(expected.iter().copied()), "{most} slots");
        }
        assert!(expected.len() > 500);
    }
}
