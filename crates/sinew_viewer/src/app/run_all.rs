//! The button that runs all scenes.

use super::App;
use super::tour::Tour;
use crate::session::Subject;
use sinew_scenes::scenes::Metric;

impl App {
    /// Starts to run all scenes to their ends, one after the other, or stops the tour in progress. Keeps the results.
    pub(super) fn tour(&mut self) {
        if self.tour.runs {
            self.tour.runs = false;
            (self.goal, self.running) = (None, false);
            return;
        }
        self.tour = Tour::begun();
        self.open_next();
    }

    /// Opens the next scene of the tour; after the last one the tour ends.
    fn open_next(&mut self) {
        let Some(scene) = self.tour.next() else {
            self.tour.runs = false;
            return self.tell(self.tour.told());
        };
        if let Ok(subject) = Subject::scene(scene.name, &[]) {
            self.open(subject);
            (self.goal, self.running) = (Some(u64::from(scene.steps)), true);
        }
    }

    /// Records the result of a scene that has ended, and opens the next one.
    pub(super) fn go_on_touring(&mut self) {
        if !self.tour.runs || self.goal.is_some() {
            return;
        }
        let next = self.tour.next().map(|scene| scene.name);
        if next != Some(self.session.subject().title().as_str()) {
            self.tour.runs = false;
            return;
        }
        let is_met = self.session.metrics().iter().all(Metric::is_met);
        self.tour.note(is_met);
        self.open_next();
    }
}
