//! Undo and redo: operations and edits within a run, and settings between runs.

use super::mouse::Mouse;
use super::{App, bench};
use crate::session::Subject;

impl App {
    /// Undoes or redoes the last operation, edit or change of settings.
    pub fn undo(&mut self, redo: bool) {
        match self.session.undo(redo) {
            Err(line) => self.tell(line),
            Ok(true) => {
                let chosen = self.bench.chosen;
                (self.starts, self.mouse) = (self.starts + 1, Mouse::default());
                bench::choose(self, chosen);
                self.tell(if redo { "done again" } else { "undone" });
            }
            Ok(false) => self.undo_settings(redo),
        }
    }

    /// Opens the scene with the settings before the last change (undo) or after it (redo).
    fn undo_settings(&mut self, redo: bool) {
        let list = if redo { &mut self.future } else { &mut self.past };
        let Some(subject) = list.pop() else {
            return self.tell(if redo { "nothing to redo" } else { "nothing to undo" });
        };
        let now = self.session.subject().clone();
        if redo {
            self.past.push(now);
        } else {
            self.future.push(now);
        }
        self.reopen(subject);
    }

    /// Opens the scene with other settings; undo restores the present ones.
    pub(super) fn open_with_settings(&mut self, subject: Subject) {
        self.past.push(self.session.subject().clone());
        self.future.clear();
        self.reopen(subject);
    }

    /// Opens a subject and keeps the lists of undo and redo and the pinned run.
    fn reopen(&mut self, subject: Subject) {
        let [past, future] = [&mut self.past, &mut self.future].map(core::mem::take);
        let pinned = self.pinned.take();
        self.open(subject);
        if let Some(subject) = &pinned {
            self.session.set_twin(subject);
        }
        (self.past, self.future, self.pinned) = (past, future, pinned);
    }
}
