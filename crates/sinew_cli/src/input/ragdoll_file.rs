//! Any source of a ragdoll: a rigged character, a Sinew definition, an MJCF model.

use crate::failure::{Failure, Result};
use crate::input::files::CharacterFile;
use crate::input::settings_arg::SettingsArg;
use crate::input::source::{name, read_bytes};
use sinew::anim::Garment;
use sinew::formats::{Textures, read_model, read_ragdoll};
use sinew::ragdoll::{BuildOptions, RagdollDef, Repair};
use std::path::Path;

/// A ragdoll with its source.
pub struct RagdollFile {
    /// Name of the file, as given by the user.
    pub name: String,
    /// The ragdoll, its springs, and data of its rig.
    pub repair: Repair,
    /// Notes of reading and building, one sentence each.
    pub notes: Vec<String>,
    /// The rigged file from which the ragdoll was built, if there is one.
    pub character: Option<CharacterFile>,
    /// Garments requested by the settings.
    pub garments: Vec<Garment>,
}

impl RagdollFile {
    /// Rejects settings for a finished ragdoll: settings only affect a build.
    pub fn check_settings(&self, settings: &SettingsArg) -> Result<()> {
        if let Some(option) = settings.given().filter(|_| self.repair.reference.is_none()) {
            let what = "changes how a ragdoll is built: name a character, not a definition or a model";
            return Err(Failure::Usage(format!("{option} {what}")));
        }
        Ok(())
    }

    /// Reads a file of any of the three kinds; for a character builds the ragdoll.
    pub fn load(path: &Path, textures: Textures, settings: &SettingsArg) -> Result<Self> {
        let name = name(path);
        let bytes = read_bytes(path)?;
        match kind_of(&bytes) {
            Kind::Definition => Ok(Self {
                repair: Repair::new(read_ragdoll(&bytes).map_err(|error| error.with_file(&name))?),
                name,
                notes: Vec::new(),
                character: None,
                garments: Vec::new(),
            }),
            Kind::Mjcf => {
                let model = read_model(&bytes).and_then(|model| Ok((model.to_ragdoll()?, model.notes)));
                let (ragdoll, mut notes) = model.map_err(|error| error.with_file(&name))?;
                notes.extend(ragdoll.notes);
                let repair = Repair { springs: ragdoll.springs, ..Repair::new(ragdoll.def) };
                Ok(Self { repair, name, notes, character: None, garments: Vec::new() })
            }
            Kind::Character => {
                drop(bytes);
                let (character, settings) = settings.load_character(path, textures)?;
                let (def, report) = settings.build(&character, &BuildOptions::default())?;
                let repair = Repair { reference: Some(def.clone()), ..Repair::new(def) };
                let garments = settings.garments(&character)?;
                Ok(Self { repair, name, notes: report.notes, character: Some(character), garments })
            }
        }
    }
}

/// Returns true if the bytes are a character, not a definition or a model.
pub fn is_character(bytes: &[u8]) -> bool {
    matches!(kind_of(bytes), Kind::Character)
}

/// Reads a definition for a character, with joints matched by name.
pub fn read_definition(path: &Path, character: &CharacterFile) -> Result<RagdollDef> {
    let name = name(path);
    let bytes = read_bytes(path).map_err(|error| error.with_file(&name))?;
    if bytes.starts_with(b"glTF") {
        let what = "a character, not the definition of a ragdoll: `sinew ragdoll build` writes one";
        return Err(Failure::of_file(&name, what));
    }
    let def = read_ragdoll(&bytes).map_err(|error| error.with_file(&name))?;
    def.for_rig(&character.document.rig).map_err(|error| {
        let place = format!("bodies[{}]", error.body());
        Failure::at(&name, format!("{error} ({})", character.name), place)
    })
}

enum Kind {
    Definition,
    Mjcf,
    Character,
}

/// Detects the kind: a glTF is JSON too, but has an `asset` at its top and no `sinew` key.
fn kind_of(bytes: &[u8]) -> Kind {
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes).trim_ascii_start();
    match text.first() {
        Some(b'<') => Kind::Mjcf,
        Some(b'{') if is_ours(text) => Kind::Definition,
        _ => Kind::Character,
    }
}

/// Returns true if an object's first key is `"sinew"`, or a later one is and there is no `asset`.
fn is_ours(text: &[u8]) -> bool {
    text[1..].trim_ascii_start().starts_with(b"\"sinew\"")
        || text.windows(7).any(|word| word == b"\"sinew\"")
            && serde_json::from_slice::<serde_json::Map<String, serde_json::Value>>(text)
                .is_ok_and(|object| object.contains_key("sinew") && !object.contains_key("asset"))
}
