//! Notes on what a reader leaves out or changes, so that nobody has to find out by surprise.

/// Collects notes, each once, with the number of times that it applies: memory does not grow with the file.
#[derive(Default)]
pub(crate) struct Notes {
    left_out: Vec<(&'static str, usize)>,
    changed: Vec<String>,
}

/// Most sentences about single joints.
const MOST_CHANGES: usize = 64;

impl Notes {
    /// One more thing of that sort is in the file and not in the model.
    pub fn left_out(&mut self, what: &'static str) {
        match self.left_out.iter_mut().find(|(known, _)| *known == what) {
            Some((_, count)) => *count += 1,
            None => self.left_out.push((what, 1)),
        }
    }

    /// The model says something else than the file.
    pub fn changed(&mut self, sentence: String) {
        if self.changed.len() < MOST_CHANGES {
            self.changed.push(sentence);
        }
    }

    /// A sentence each.
    pub fn into_sentences(self) -> Vec<String> {
        let left_out = self.left_out.into_iter().map(|(what, count)| format!("left out: {what} ({count})"));
        self.changed.into_iter().chain(left_out).collect()
    }
}
