//! A 64-bit hash that is the same on every machine and in all releases of this crate with the same major version.

/// Hash of `bytes`, as [`StableHasher`] computes it.
pub fn hash_bytes(bytes: &[u8]) -> u64 {
    let mut hasher = StableHasher::default();
    hasher.write(bytes);
    hasher.finish()
}

/// Streaming hash: mixes eight bytes at a time into the state by a folded 64×64→128-bit product. The hash does not
/// depend on how the input is split into calls. It is not secure against deliberate collisions.
#[derive(Clone, Debug)]
pub struct StableHasher {
    state: u64,
    pending: [u8; 8],
    filled: usize,
    length: u64,
}

const PRIME_A: u64 = 0x9E37_79B9_7F4A_7C15;
const PRIME_B: u64 = 0xD1B5_4A32_D192_ED03;

fn fold(a: u64, b: u64) -> u64 {
    let product = u128::from(a) * u128::from(b);
    (product as u64) ^ ((product >> 64) as u64)
}

impl Default for StableHasher {
    fn default() -> Self {
        Self { state: PRIME_B, pending: [0; 8], filled: 0, length: 0 }
    }
}

impl StableHasher {
    /// Adds bytes to the hash.
    pub fn write(&mut self, bytes: &[u8]) {
        self.length += bytes.len() as u64;
        for &byte in bytes {
            self.pending[self.filled] = byte;
            self.filled += 1;
            if self.filled == 8 {
                self.mix();
            }
        }
    }

    fn mix(&mut self) {
        let word = u64::from_le_bytes(self.pending);
        self.state = fold(self.state ^ word, PRIME_A).wrapping_add(PRIME_B);
        self.pending = [0; 8];
        self.filled = 0;
    }

    /// Returns the hash of all bytes written.
    pub fn finish(&self) -> u64 {
        let mut last = self.clone();
        if last.filled > 0 {
            last.mix();
        }
        fold(last.state ^ last.length, PRIME_A ^ PRIME_B)
    }
}
