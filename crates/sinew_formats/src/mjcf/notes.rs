//! Notes on content that a reader omits or changes.

/// Collects notes, each with its count, so that memory does not grow with the file.
#[derive(Default)]
pub(crate) struct Notes {
    left_out: Vec<(&'static str, usize)>,
    changed: Vec<String>,
}

/// Largest number of sentences about single joints.
const MOST_CHANGES: usize = 64;

impl Notes {
    /// Records a feature of the file that the model lacks.
    pub fn left_out(&mut self, what: &'static str) {
        match self.left_out.iter_mut().find(|(known, _)| *known == what) {
            Some((_, count)) => *count += 1,
            None => self.left_out.push((what, 1)),
        }
    }

    /// Records a difference between the model and the file.
    pub fn changed(&mut self, sentence: String) {
        if self.changed.len() < MOST_CHANGES {
            self.changed.push(sentence);
        }
    }

    /// Returns the notes, one sentence each.
    pub fn into_sentences(self) -> Vec<String> {
        let left_out = self.left_out.into_iter().map(|(what, count)| format!("left out: {what} ({count})"));
        self.changed.into_iter().chain(left_out).collect()
    }
}
