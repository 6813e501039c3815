//! User functions, registered by number for snapshots.

/// Registered functions, ascending by number. Not part of a snapshot: code cannot be saved.
#[derive(Clone, Debug)]
pub(crate) struct Registered<F>(Vec<(u32, F)>);

impl<F> Default for Registered<F> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<F: Copy> Registered<F> {
    /// Registers a function, replacing an earlier one with this number.
    pub fn set(&mut self, number: u32, function: F) {
        match self.0.binary_search_by_key(&number, |&(n, _)| n) {
            Ok(place) => self.0[place].1 = function,
            Err(place) => self.0.insert(place, (number, function)),
        }
    }

    pub fn find(&self, number: u32) -> Option<F> {
        let place = self.0.binary_search_by_key(&number, |&(n, _)| n).ok()?;
        Some(self.0[place].1)
    }

    pub fn has(&self, number: u32) -> bool {
        self.find(number).is_some()
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}
