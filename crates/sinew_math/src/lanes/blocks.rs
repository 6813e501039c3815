//! Lists of records, stored field by field in blocks of eight.

use super::WIDTH;

/// Eight records of `F` numbers: row `f` holds number `f` of all eight.
///
/// A kernel reads a block as one stream for every `F`. One array per field would give `F` streams, which share cache
/// sets if the array lengths are powers of two.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub struct Block<const F: usize>(pub [[f32; WIDTH]; F]);

impl<const F: usize> Block<F> {
    /// Makes a block with the same record in all lanes.
    pub fn splat(record: [f32; F]) -> Self {
        Self(record.map(|number| [number; WIDTH]))
    }

    /// Returns the record in `lane`.
    ///
    /// # Panics
    /// If `lane` is not below [`WIDTH`].
    pub fn get(&self, lane: usize) -> [f32; F] {
        self.0.map(|row| row[lane])
    }

    /// Writes the record in `lane`.
    ///
    /// # Panics
    /// If `lane` is not below [`WIDTH`].
    pub fn set(&mut self, lane: usize, record: [f32; F]) {
        for (row, number) in self.0.iter_mut().zip(record) {
            row[lane] = number;
        }
    }
}

/// A list of records of `F` numbers, in [`Block`]s.
///
/// Unused lanes of the last block repeat a record, so that kernels may process them too.
#[derive(Clone, Debug, Default)]
pub struct Blocks<const F: usize> {
    blocks: Vec<Block<F>>,
    len: usize,
}

impl<const F: usize> Blocks<F> {
    /// Creates an empty list.
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the number of records.
    pub fn len(&self) -> usize {
        self.len
    }

    /// True if there are no records.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Adds a record at the end.
    pub fn push(&mut self, record: [f32; F]) {
        match (self.len % WIDTH, self.blocks.last_mut()) {
            (lane @ 1.., Some(block)) => block.set(lane, record),
            _ => self.blocks.push(Block::splat(record)),
        }
        self.len += 1;
    }

    /// Returns record `index`.
    ///
    /// # Panics
    /// If `index` is not below the list's length.
    pub fn get(&self, index: usize) -> [f32; F] {
        assert!(index < self.len, "record {index} of {}", self.len);
        self.blocks[index / WIDTH].get(index % WIDTH)
    }

    /// Removes all records and keeps the memory.
    pub fn clear(&mut self) {
        self.blocks.clear();
        self.len = 0;
    }

    /// Resizes to `len` records; new ones are zero.
    pub fn resize(&mut self, len: usize) {
        self.blocks.resize(len.div_ceil(WIDTH), Block::splat([0.0; F]));
        for index in self.len..len {
            self.blocks[index / WIDTH].set(index % WIDTH, [0.0; F]);
        }
        self.len = len;
    }

    /// Returns the blocks; the last one is padded.
    pub fn blocks(&self) -> &[Block<F>] {
        &self.blocks
    }

    /// Returns the blocks for writing; the last one is padded.
    pub fn blocks_mut(&mut self) -> &mut [Block<F>] {
        &mut self.blocks
    }
}

impl<const F: usize> Extend<[f32; F]> for Blocks<F> {
    fn extend<I: IntoIterator<Item = [f32; F]>>(&mut self, records: I) {
        let records = records.into_iter();
        self.blocks.reserve(records.size_hint().0.div_ceil(WIDTH));
        for record in records {
            self.push(record);
        }
    }
}

impl<const F: usize> FromIterator<[f32; F]> for Blocks<F> {
    fn from_iter<I: IntoIterator<Item = [f32; F]>>(records: I) -> Self {
        let mut blocks = Self::new();
        blocks.extend(records);
        blocks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stored_records_are_returned_and_padding_repeats_one() {
        let records: Vec<[f32; 3]> = (0..19).map(|i| [i as f32, -(i as f32), 0.5]).collect();
        let mut blocks: Blocks<3> = records.iter().copied().collect();
        assert_eq!((blocks.len(), blocks.blocks().len()), (19, 3));
        for (i, record) in records.iter().enumerate() {
            assert_eq!(blocks.get(i), *record);
        }
        for lane in 3..WIDTH {
            assert_eq!(blocks.blocks()[2].get(lane), records[16]);
        }
        blocks.resize(18);
        blocks.resize(20);
        assert_eq!((blocks.len(), blocks.get(17), blocks.get(18)), (20, records[17], [0.0; 3]));
        blocks.clear();
        assert!(blocks.is_empty() && blocks.blocks().is_empty());
    }

    #[test]
    #[should_panic = "record 19 of 19"]
    fn padding_records_cannot_be_read() {
        let blocks: Blocks<1> = (0..19).map(|i| [i as f32]).collect();
        blocks.get(19);
    }
}
