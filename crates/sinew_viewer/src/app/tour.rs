//! A run of all scenes to their ends, which records whether each meets its expectations.

use sinew_scenes::scenes::{Scene, registry};

/// A run through all scenes.
#[derive(Clone, Debug, Default)]
pub(super) struct Tour {
    /// Scenes that have ended, each with true if it met its expectations.
    results: Vec<(&'static str, bool)>,
    pub runs: bool,
}

impl Tour {
    /// Begins a tour.
    pub fn begun() -> Self {
        Self { runs: true, results: Vec::new() }
    }

    /// Returns the result of a scene, if the tour has run it.
    pub fn result(&self, name: &str) -> Option<bool> {
        self.results.iter().find(|(it, _)| *it == name).map(|(_, is_met)| *is_met)
    }

    /// Returns the number of scenes that have ended.
    pub fn count(&self) -> usize {
        self.results.len()
    }

    /// Returns the next scene; `None` at the end.
    pub fn next(&self) -> Option<&'static Scene> {
        registry().get(self.results.len())
    }

    /// Records the result of the scene that has ended.
    pub fn note(&mut self, is_met: bool) {
        if let Some(scene) = self.next() {
            self.results.push((scene.name, is_met));
        }
    }

    /// Describes the results in a line.
    pub fn told(&self) -> String {
        let short: Vec<&str> = self.results.iter().filter(|it| !it.1).map(|it| it.0).collect();
        let count = self.results.len();
        match &short[..] {
            [] => format!("all {count} scenes meet their expectations"),
            short => format!("{} of {count} scenes fall short: {}", short.len(), short.join(", ")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Tour;
    use sinew_scenes::scenes::registry;

    #[test]
    fn every_scene_has_one_note() {
        let mut tour = Tour::begun();
        let last = registry().last().expect("there are scenes").name;
        while let Some(scene) = tour.next() {
            tour.note(scene.name != last);
        }
        let count = registry().len();
        assert_eq!(tour.told(), format!("1 of {count} scenes fall short: {last}"));
        assert_eq!((tour.result(last), tour.result(registry()[0].name)), (Some(false), Some(true)));
    }
}
