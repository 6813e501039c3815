//! Opens files: as the bodies of a world, or as a character or ragdoll on the workbench.

use super::subject::{NamedFile, has_extension};
use super::workbench::Workbench;
use sinew::anim::{Wrap, analyze_skeleton, rest_pose, sample};
use sinew::character_of;
use sinew::formats::{
    Error, MotionFile, MotionOptions, ReadOptions, Textures, load_motion, read_bytes, read_gltf, read_motion,
    read_ragdoll, read_world,
};
use sinew::physics::{World, WorldDef};
use sinew::ragdoll::Settings;
use sinew_scenes::played::played;
use sinew_scenes::scenes::Instance;
use sinew_scenes::staged::staged;
use std::path::Path;

/// Content of a file.
pub(super) enum Opened {
    /// Bodies or a character on a stage, and lines that describe them.
    World(Box<Instance>, Vec<String>),
    /// A motion without a skin, which plays, and lines that describe it.
    Motion(Box<Instance>, Vec<String>),
    /// A ragdoll, which can be edited.
    Workbench(Box<Workbench>),
}

/// Opens a file by its path.
pub(super) fn open(path: &Path) -> Result<Opened, Error> {
    let name = path.display().to_string();
    let title = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    if has_extension(path, "json") {
        return of_json(&read_bytes(path)?, &title).map_err(|error| error.with_file(name));
    }
    of_motion(load_motion(path, &motion_options())?, &title).map_err(|error| error.with_file(name))
}

/// Opens files without a folder, like [`open`].
pub(super) fn open_dropped(files: &[NamedFile]) -> Result<Opened, Error> {
    let [NamedFile { name, bytes }, beside @ ..] = files else {
        return Err(Error::unsupported("nothing was dropped", ""));
    };
    if has_extension(Path::new(name), "json") {
        return of_json(bytes, name).map_err(|error| error.with_file(name.clone()));
    }
    let file = read_motion(bytes, &motion_options(), &mut |relative: &str| companion(beside, relative));
    file.and_then(|file| of_motion(file, name)).map_err(|error| error.with_file(name.clone()))
}

/// Returns the content of a file dropped with another one, by its path relative to that. Pages give names
/// without folders.
fn companion(beside: &[NamedFile], relative: &str) -> Result<Vec<u8>, Error> {
    let last = relative.rsplit('/').next().unwrap_or(relative);
    let found = beside.iter().find(|file| file.name == last);
    let missing = || Error::io(format!("'{relative}' was not dropped with it"));
    found.map(|file| file.bytes.clone()).ok_or_else(missing)
}

/// Opens the character of dropped files on a stage.
pub(super) fn stage(files: &[NamedFile]) -> Result<Opened, Error> {
    let [NamedFile { name, bytes }, beside @ ..] = files else {
        return Err(Error::unsupported("nothing was dropped", ""));
    };
    let options = ReadOptions { textures: Textures::Decode };
    let document = read_gltf(bytes, options, &mut |relative: &str| companion(beside, relative))
        .map_err(|error| error.with_file(name.clone()))?;
    let loaded = character_of(document, name, &Settings::default());
    let loaded = loaded.map_err(|error| Error::unsupported(error.to_string(), ""))?;
    let report = loaded.notes.clone();
    Ok(Opened::World(Box::new(staged(loaded.def)), report))
}

fn motion_options() -> MotionOptions<'static> {
    let gltf = ReadOptions { textures: Textures::Decode };
    MotionOptions { gltf, ..MotionOptions::default() }
}

/// Opens a ragdoll or a world.
fn of_json(bytes: &[u8], name: &str) -> Result<Opened, Error> {
    let kind = serde_json::from_slice::<serde_json::Value>(bytes);
    if kind.is_ok_and(|value| value["sinew"] == "ragdoll") {
        return Ok(Opened::Workbench(Box::new(Workbench::of_bodies(read_ragdoll(bytes)?, name))));
    }
    let bodies = read_world(bytes)?;
    let mut world = World::new(WorldDef::default());
    bodies.iter().for_each(|body| {
        world.add_body(body);
    });
    Ok(Opened::World(Box::new(Instance::of_world(world)), vec![format!("{} bodies", bodies.len())]))
}

fn of_motion(file: MotionFile, name: &str) -> Result<Opened, Error> {
    let refused = |what: String| Error::unsupported(what, "");
    if file.rig.skins.is_empty() && !file.clips.is_empty() {
        return of_skeleton(file).map_err(refused);
    }
    Ok(Opened::Workbench(Box::new(Workbench::of_character(file, name).map_err(refused)?)))
}

/// Opens the first clip of a skeleton without skin, such as motion capture.
fn of_skeleton(file: MotionFile) -> Result<Opened, String> {
    let MotionFile { rig, mut clips, notes, .. } = file;
    let count = clips.len();
    let clip = clips.swap_remove(0);
    let mut pose = rest_pose(&rig);
    sample(&clip, &rig, 0.0, Wrap::Clamp, &mut pose);
    let analysis = analyze_skeleton(&rig, &pose).map_err(|error| error.to_string())?;
    let roles = analysis.roles.iter().flatten().count();
    let mut report = vec![
        format!("{} joints, {roles} with a role; clip '{}' of {count}", rig.joints.len(), clip.name),
        format!("{:.2} m, {:.2} s", analysis.height, clip.duration),
        "motion capture has no skin: no ragdoll is built".to_owned(),
    ];
    report.extend(notes.into_iter().chain(analysis.notes.clone()));
    let instance = played(rig, clip, &analysis.character_from_file());
    Ok(Opened::Motion(Box::new(instance), report))
}
