//! Kinds of characters: rig, ragdoll and motions, shared by characters.

use crate::border::{Failure, Outcome, refused};
use crate::drive::drive_mode;
use crate::types::{CharacterOptions, Names};
use crate::values::{Options, json_text};
use js_sys::{Array, Object, Reflect, Uint8Array};
use sinew::formats::{Error, ReadOptions, no_files, read_gltf, read_ragdoll_settings, write_gltf};
use sinew::ragdoll::settings::{GarmentSource, SpringSource, Unit};
use sinew::ragdoll::{AfterSettling, Locomotion, MotionSet, RagdollBodyDef, Settings, Toughness};
use std::sync::Arc;
use wasm_bindgen::prelude::*;

/// A kind of character, built from a GLB, glTF or VRM file. Characters share it: create one per file.
#[wasm_bindgen]
pub struct CharacterDef {
    pub(crate) def: Arc<sinew::ragdoll::CharacterDef>,
    notes: Vec<String>,
}

const KNOWN: [&str; 12] = [
    "name",
    "settings",
    "files",
    "height",
    "mass",
    "springs",
    "garments",
    "looped",
    "afterSettling",
    "falling",
    "toughness",
    "tellsContacts",
];

/// Returns the name of a body for JavaScript: its role, or else its bone's name.
pub fn bone_name(body: &RagdollBodyDef) -> String {
    if body.role.is_empty() { body.bone.clone() } else { body.role.clone() }
}

fn names(list: impl Iterator<Item = String>) -> Names {
    JsValue::from(list.map(JsValue::from).collect::<Array>()).unchecked_into()
}

/// Converts options to ragdoll settings.
fn settings(options: &Options<'_>) -> Outcome<Settings> {
    let mut settings = match options.get("settings") {
        None => Settings::default(),
        Some(given) => {
            let text = json_text(&given)?;
            read_ragdoll_settings(text.as_bytes()).map_err(|error| Failure(format!("settings: {error}")))?
        }
    };
    settings.mass = options.number("mass")?.or(settings.mass);
    settings.unit = options.number("height")?.map(Unit::Height).or(settings.unit);
    const SPRINGS: [(&str, SpringSource); 3] =
        [("file", SpringSource::File), ("names", SpringSource::Names), ("none", SpringSource::None)];
    let springs = options.word("springs", &SPRINGS.map(|(word, _)| word))?;
    settings.springs = springs.map(|index| SPRINGS[index].1).or(settings.springs);
    match options.word("garments", &["names", "none"])? {
        Some(0) => settings.garments = GarmentSource::Names,
        Some(_) => settings.garments = GarmentSource::None,
        None => {}
    }
    Ok(settings)
}

/// Applies options to a definition.
fn adjust(def: &mut sinew::ragdoll::CharacterDef, options: &Options<'_>) -> Outcome {
    if let Some(looped) = options.text("looped")? {
        let motions = def.motions().clone();
        let index = motions.clips.iter().position(|clip| clip.name == looped);
        let index = index.ok_or_else(|| {
            let clips: Vec<&str> = motions.clips.iter().map(|clip| clip.name.as_str()).collect();
            Failure(format!("no clip is called '{looped}'; there are {}", clips.join(", ")))
        })?;
        if motions.looped != Some(index) {
            let (faster, locomotion) = (Vec::new(), Locomotion::ByClip);
            let motions = MotionSet { looped: Some(index), faster, locomotion, ..motions };
            def.set_motions(motions).map_err(|error| Failure(error.to_string()))?;
        }
    }
    match options.word("afterSettling", &["getUp", "stayDown"])? {
        Some(0) => def.after_settling = AfterSettling::GetUp,
        Some(_) => def.after_settling = AfterSettling::StayDown,
        None => {}
    }
    if let Some(falling) = options.get("falling") {
        def.falling = drive_mode(&falling)?;
    }
    if let Some(toughness) = options.number("toughness")? {
        def.in_world.toughness =
            if toughness > 0.0 { Toughness::Impulse(toughness) } else { Toughness::None };
    }
    def.in_world.tells_contacts = options.flag("tellsContacts")?.unwrap_or(false);
    Ok(())
}

/// Returns the bytes of a glTF's companion file from the object that maps paths to bytes.
fn file_of(files: &JsValue, path: &str) -> Result<Vec<u8>, Error> {
    let found = Reflect::get(files, &JsValue::from_str(path)).unwrap_or_default();
    found.dyn_ref::<Uint8Array>().map_or_else(|| no_files(path), |bytes| Ok(bytes.to_vec()))
}

#[wasm_bindgen]
impl CharacterDef {
    /// Reads a GLB, glTF or VRM, finds the roles of its joints, builds the ragdoll, and chooses walk, idle and get-ups among its clips.
    /// A human that lacks one of these gets the built-in one.
    pub fn load(bytes: &[u8], options: Option<CharacterOptions>) -> Outcome<CharacterDef> {
        let value: JsValue = options.map(JsValue::from).unwrap_or_default();
        let options = Options::of(&value, "options", &KNOWN)?;
        let name = options.text("name")?.unwrap_or_else(|| "the file".to_owned());
        let settings = settings(&options)?;
        let files = options.get("files").unwrap_or_else(|| Object::new().into());
        let loaded = refused(|| {
            let document = read_gltf(bytes, ReadOptions::default(), &mut |path: &str| file_of(&files, path))
                .map_err(|error| Failure(error.with_file(&name).to_string()))?;
            sinew::character_of(document, &name, &settings).map_err(|error| Failure(error.to_string()))
        })??;
        let mut def = loaded.def;
        refused(|| adjust(&mut def, &options))??;
        Ok(CharacterDef { def: Arc::new(def), notes: loaded.notes })
    }

    /// Assumptions about the file, chosen clips, and missing parts, one sentence each.
    #[wasm_bindgen(getter)]
    pub fn notes(&self) -> Names {
        names(self.notes.iter().cloned())
    }

    /// Names of the joints, in the order of poses.
    #[wasm_bindgen(getter)]
    pub fn joints(&self) -> Names {
        names(self.def.rig.joints.iter().map(|joint| joint.name.clone()))
    }

    /// Index of the glTF node of each joint; 4294967295 for a joint without one.
    #[wasm_bindgen(getter)]
    pub fn nodes(&self) -> Vec<u32> {
        let node = |source: usize| u32::try_from(source).unwrap_or(u32::MAX);
        self.def.rig.joints.iter().map(|joint| node(joint.source)).collect()
    }

    /// Names of the bodies for `hit`, `hold` and others: roles such as "chest", or else names of bones.
    #[wasm_bindgen(getter)]
    pub fn bones(&self) -> Names {
        names(self.def.ragdoll.bodies.iter().map(bone_name))
    }

    /// Index of the joint that carries each body.
    #[wasm_bindgen(getter, js_name = boneJoints)]
    pub fn bone_joints(&self) -> Vec<u32> {
        self.def.ragdoll.bodies.iter().map(|body| body.joint as u32).collect()
    }

    /// Names of the clips for `play`, including built-in ones.
    #[wasm_bindgen(getter)]
    pub fn clips(&self) -> Names {
        names(self.def.motions().clips.iter().map(|clip| clip.name.clone()))
    }

    /// Height, metres.
    #[wasm_bindgen(getter)]
    pub fn height(&self) -> f32 {
        self.def.ragdoll.height
    }

    /// Mass, kg.
    #[wasm_bindgen(getter)]
    pub fn mass(&self) -> f32 {
        self.def.ragdoll.total_mass
    }

    /// Number of swinging bone chains, such as hair.
    #[wasm_bindgen(getter)]
    pub fn springs(&self) -> usize {
        self.def.rig.springs.chains.len()
    }

    /// Indices of the joints that swing.
    #[wasm_bindgen(getter, js_name = springJoints)]
    pub fn spring_joints(&self) -> Vec<u32> {
        let bones = self.def.rig.springs.chains.iter().flat_map(|chain| &chain.bones);
        bones.map(|bone| bone.joint as u32).collect()
    }

    /// Number of garments.
    #[wasm_bindgen(getter)]
    pub fn garments(&self) -> usize {
        self.def.garments().source().len()
    }
}

/// Returns a GLB of the built-in mannequin, 1.75 m, with a walk and two get-ups, for tests without a file.
#[wasm_bindgen(js_name = mannequinGlb)]
pub fn mannequin_glb() -> Outcome<Vec<u8>> {
    let mannequin = sinew::mannequin::mannequin();
    write_gltf(&mannequin.rig, &mannequin.clips).map_err(|error| Failure(error.to_string()))
}
