//! The window of `sinew view`.

use super::View;
use crate::failure::{Failure, Result};
use crate::report::Report;

impl View {
    /// Opens the window and returns when it is closed.
    #[cfg(feature = "viewer")]
    pub(super) fn open(&self) -> Result<Report> {
        use crate::input::scene_choice::choose;
        use serde_json::json;
        use sinew_scenes::scenes::find;
        use sinew_viewer::{Options, Preferences, Subject, open};
        use std::path::Path;

        let subject = match self.subject.as_deref() {
            None => None,
            Some(name) if find(name).is_some() || Path::new(name).extension().is_none() => {
                let (scene, settings) = choose(name, &self.settings)?;
                Some(Subject::Scene(scene, Box::new(settings), self.settings.clone()))
            }
            Some(_) if !self.settings.is_empty() => {
                return Err(Failure::Usage("--set is for scenes; a file has none".into()));
            }
            Some(name) => Some(Subject::file(Path::new(name))?),
        };
        let title = subject.as_ref().map(Subject::title);
        let dt = sinew::physics::WorldDef::default().dt();
        let steps = self.at.map(|seconds| (seconds / dt).round() as u64);
        let options = Options {
            // A screenshot shows one time, so the window is paused.
            paused: self.paused || self.screenshot.is_some() && steps.is_none(),
            steps,
            hides_times: self.screenshot.is_some(),
            screenshot: self.screenshot.clone(),
            subject,
            log: self.log,
            preferences: Preferences::path(),
            ghost: self.ghost.clone(),
            ..Options::default()
        };
        open(options).map_err(|error| Failure::of_file(title.clone().unwrap_or("view".into()), error))?;
        let outputs: Vec<String> = self.screenshot.iter().map(|path| path.display().to_string()).collect();
        Ok(Report { json: json!({"subject": title, "outputs": outputs}), text: String::new() })
    }

    /// Returns the error that the build has no window, with the command that adds it.
    #[cfg(not(feature = "viewer"))]
    pub(super) fn open(&self) -> Result<Report> {
        use crate::input::scene_choice::choose;
        use std::path::Path;

        // Errors of the subject come first: another build does not fix them.
        match self.subject.as_deref() {
            Some(name) if Path::new(name).extension().is_none() => drop(choose(name, &self.settings)?),
            Some(name) if !Path::new(name).exists() => return Err(Failure::of_file(name, "no such file")),
            _ => {}
        }
        let given: Vec<_> = std::env::args().skip(1).collect();
        Err(Failure::Usage(format!(
            "this 'sinew' was built without its window; 'cargo run --release --features viewer -- {}' builds and opens it; \
             --picture OUT and --movie OUT need none",
            given.join(" ")
        )))
    }
}
