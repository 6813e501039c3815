//! A scene by its name, with its `--set` values.

use crate::failure::{Failure, Result};
use sinew::ragdoll::settings::instead;
use sinew_scenes::scenes::{Scene, SettingError, Settings, find, registry};

/// Returns the scene of that name and its settings, ready to be started.
pub fn choose(name: &str, assignments: &[String]) -> Result<(&'static Scene, Settings)> {
    let unknown = || {
        let instead = instead(name, registry().iter().map(|scene| scene.name));
        Failure::Usage(format!("no scene '{name}'; {instead}; 'sinew scenes' lists all"))
    };
    let scene = find(name).ok_or_else(unknown)?;
    let mut settings = scene.settings();
    for assignment in assignments {
        settings.assign(assignment).map_err(refused)?;
    }
    settings.check().map_err(refused)?;
    Ok((scene, settings))
}

fn refused(error: SettingError) -> Failure {
    match error {
        SettingError::File(error) => error.into(),
        error => Failure::Usage(format!("--set: {error}")),
    }
}
