//! User preferences that are stored between starts.

use crate::layers::Layer;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Preferences of a user.
#[derive(Clone, Debug, PartialEq)]
pub struct Preferences {
    /// Layers that are switched on.
    pub layers: Vec<Layer>,
    /// Number of threads for steps, at least 1.
    pub threads: usize,
}

impl Default for Preferences {
    fn default() -> Self {
        Self { layers: Vec::new(), threads: 1 }
    }
}

impl Preferences {
    /// Returns the file of the preferences: `sinew/viewer.json` in the system's folder for configuration; `None` if
    /// there is no such folder.
    pub fn path() -> Option<PathBuf> {
        let folder = |name: &str| std::env::var_os(name).filter(|path| !path.is_empty()).map(PathBuf::from);
        let config = folder("XDG_CONFIG_HOME")
            .or_else(|| folder("APPDATA"))
            .or_else(|| folder("HOME").map(|home| home.join(".config")))?;
        Some(config.join("sinew").join("viewer.json"))
    }

    /// Reads the preferences from `path`; missing or invalid entries have their defaults.
    pub fn load(path: &Path) -> Self {
        let bytes = std::fs::read(path).unwrap_or_default();
        let value: Value = serde_json::from_slice(&bytes).unwrap_or_default();
        let named = |name: &Value| Layer::ALL.into_iter().find(|layer| Some(layer.name()) == name.as_str());
        let layers = value["layers"].as_array().into_iter().flatten().filter_map(named).collect();
        let threads = value["threads"].as_u64().unwrap_or(1).clamp(1, 64) as usize;
        Self { layers, threads }
    }

    /// Writes the preferences to `path`; ignores errors.
    pub fn save(&self, path: &Path) {
        let layers: Vec<&str> = self.layers.iter().map(|layer| layer.name()).collect();
        let value = json!({"sinew": "viewer", "version": 1, "layers": layers, "threads": self.threads});
        if let Some(folder) = path.parent() {
            // If nothing can be written, the next start uses the defaults.
            let _ = std::fs::create_dir_all(folder);
        }
        let _ = sinew::formats::write_atomic(path, format!("{value:#}\n").as_bytes());
    }
}
