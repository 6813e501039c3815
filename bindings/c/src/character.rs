//! Characters: they play clips until they are hit, fall with their bodies, and get up.

use crate::border::{
    CallError, Handle, Outcome, SinewStatus, elements, error, exclusive, fill, free, give, give_handle,
    guard, shared, text,
};
use crate::types::{SinewBodyId, SinewPose, SinewVec3};
use crate::world::SinewWorld;
use sinew::math::{Reader, Writer};
use sinew::ragdoll::{Character, CharacterDef, State};
use sinew_bindings::{CharacterFile, Corrections, Motions, Wishes, embedded};
use std::ffi::{CString, c_char};
use std::path::Path;
use std::sync::Arc;

/// Kind of character: rig, ragdoll and motions, shared by any number of characters.
pub struct SinewCharacterDef {
    def: Arc<CharacterDef>,
    names: Vec<CString>,
}

/// Character in a world. Call `sinew_character_update` once after each `sinew_world_step`.
pub struct SinewCharacter {
    character: Handle<Character>,
}

/// State of a character, which determines the source of its pose.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SinewCharacterState {
    /// The pose is that of the clips.
    Animated = 0,
    /// The pose is that of the bodies, which fall or lie.
    Limp = 1,
    /// The pose is that of the bodies, which move to the start of a get-up clip.
    Preparing = 2,
    /// The pose is that of a get-up clip.
    GettingUp = 3,
    /// The pose is that of the clips, except for a limb that was hit.
    Flinching = 4,
    /// The pose is that of the bodies, which muscles pull toward the clips.
    Powered = 5,
}

/// Transform of a joint relative to its parent, in the file's units.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SinewLocalTransform {
    /// Position and rotation.
    pub pose: SinewPose,
    /// Scale along each axis.
    pub scale: SinewVec3,
}

/// Reads a character (GLB, glTF, VRM, FBX) and builds its ragdoll. If the file has no get-up clip, a humanoid gets the built-in ones. A
/// null path loads the built-in mannequin.
///
/// # Safety
/// `path` is null or text, `def` is null or points to room for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_character_def_load(
    path: *const c_char,
    def: *mut *mut SinewCharacterDef,
) -> SinewStatus {
    guard(|| {
        let file = if path.is_null() {
            embedded()
        } else {
            // SAFETY: the caller guarantees the conditions under `# Safety`.
            CharacterFile::load(Path::new(unsafe { text(path, "path") }?), &Corrections::default())?
        };
        let (ragdoll, _) = file.build(&Wishes::default())?;
        let made = file.character(&ragdoll, &Motions::default())?;
        let names = made
            .rig
            .joints
            .iter()
            .map(|joint| CString::new(joint.name.as_str()).unwrap_or_default())
            .collect();
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { give_handle(def, "def", SinewCharacterDef { def: Arc::new(made), names }) }
    })
}

/// Frees a kind of character; its characters remain valid. Null is allowed.
///
/// # Safety
/// `def` is null or came from `sinew_character_def_load` and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_character_def_free(def: *mut SinewCharacterDef) {
    // SAFETY: the caller guarantees the conditions under `# Safety`.
    unsafe { free(def) }
}

/// Stores the number of joints of the rig in `count`; a pose has as many transforms.
///
/// # Safety
/// `def` is null or a kind of character, `count` is null or points to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_character_def_joint_count(
    def: *const SinewCharacterDef,
    count: *mut usize,
) -> SinewStatus {
    // SAFETY: the caller guarantees the conditions under `# Safety`.
    guard(|| unsafe { give(count, "count", shared(def, "def")?.names.len()) })
}

/// Stores the name of a joint in `name`; valid as long as the kind of character.
///
/// # Safety
/// `def` is null or a kind of character, `name` is null or points to room for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_character_def_joint_name(
    def: *const SinewCharacterDef,
    joint: usize,
    name: *mut *const c_char,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let names = &unsafe { shared(def, "def") }?.names;
        let named = names.get(joint);
        let named = named
            .ok_or_else(|| error(SinewStatus::BadArgument, format!("no joint {joint} of {}", names.len())))?;
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { give(name, "name", named.as_ptr()) }
    })
}

/// Adds an animated character to a world at a pose (+Y up, facing +Z). Rays can hit its bodies.
///
/// # Safety
/// `def` is null or a kind of character, `world` is null or a world that no other thread uses, `character` is null or room for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_character_spawn(
    def: *const SinewCharacterDef,
    world: *mut SinewWorld,
    pose: SinewPose,
    character: *mut *mut SinewCharacter,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let (def, world) = unsafe { (&shared(def, "def")?.def, exclusive(world, "world")?) };
        crate::border::room(character, "character")?;
        let pose = pose.read("the pose")?;
        let spawned = world.world.change(|world| Ok(Character::spawn(world, def, pose)))?;
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { give_handle(character, "character", SinewCharacter { character: Handle::new(spawned) }) }
    })
}

/// Removes a character from its world and frees it. If the character is in another world, or one of its bodies was removed, it is freed
/// anyway, and the status is `SINEW_STATUS_STALE_ID`.
///
/// # Safety
/// `character` came from `sinew_character_spawn` and is not used afterwards; `world` is null or a world that no other thread uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_character_despawn(
    character: *mut SinewCharacter,
    world: *mut SinewWorld,
) -> SinewStatus {
    guard(|| {
        crate::border::room(character, "character")?;
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let SinewCharacter { character } = *unsafe { Box::from_raw(character) };
        let character = character.get()?.clone();
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let world = &mut unsafe { exclusive(world, "world") }?.world;
        is_here(&character, world.get()?)?;
        world.change(|world| {
            character.despawn(world);
            Ok(())
        })
    })
}

/// Frees a character without removing its bodies, for a world that is freed, too. Null is allowed.
///
/// # Safety
/// `character` is null or came from `sinew_character_spawn` and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_character_free(character: *mut SinewCharacter) {
    // SAFETY: the caller guarantees the conditions under `# Safety`.
    unsafe { free(character) }
}

/// Checks that every body of the character is in the world.
fn is_here(character: &Character, world: &sinew::physics::World) -> Outcome {
    let gone = character.bodies().iter().find(|&&body| !world.contains(body));
    match gone {
        None => Ok(()),
        Some(body) => Err(error(
            SinewStatus::StaleId,
            format!("the character's body {:#x} is not in this world", body.to_bits()),
        )),
    }
}

/// Changes a character and its world together.
///
/// # Safety
/// Both are null or used by no other thread.
unsafe fn together<R>(
    character: *mut SinewCharacter,
    world: *mut SinewWorld,
    call: impl FnOnce(&mut Character, &mut sinew::physics::World) -> Outcome<R>,
) -> Outcome<R> {
    // SAFETY: the caller guarantees the conditions under `# Safety`.
    let (character, world) = unsafe { (exclusive(character, "character")?, exclusive(world, "world")?) };
    is_here(character.character.get()?, world.world.get()?)?;
    world.world.change(|world| character.character.change(|character| call(character, world)))
}

/// Updates the character after a step of its world.
///
/// # Safety
/// `character` and `world` are null or used by no other thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_character_update(
    character: *mut SinewCharacter,
    world: *mut SinewWorld,
) -> SinewStatus {
    guard(|| {
        let update = |character: &mut Character, world: &mut sinew::physics::World| {
            character.update(world);
            Ok(())
        };
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { together(character, world, update) }
    })
}

/// Hits a body, given by its role ("chest") or its joint's name, with an impulse, N·s, world axes. The character falls, or flinches if
/// the hit is weak.
///
/// # Safety
/// `character` and `world` are null or used by no other thread, `body` is null or text.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_character_hit(
    character: *mut SinewCharacter,
    world: *mut SinewWorld,
    body: *const c_char,
    impulse: SinewVec3,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let name = unsafe { text(body, "body") }?;
        let impulse = impulse.read("the impulse")?;
        let hit = |character: &mut Character, world: &mut sinew::physics::World| {
            let body = character.def().body_named(name).ok_or_else(|| no_body(character.def(), name))?;
            character.hit(world, body, impulse);
            Ok(())
        };
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { together(character, world, hit) }
    })
}

fn no_body(def: &CharacterDef, name: &str) -> CallError {
    let roles: Vec<&str> = def.ragdoll.bodies.iter().map(|body| body.role.as_str()).collect();
    error(SinewStatus::BadArgument, format!("no body is called '{name}'; there are {}", roles.join(", ")))
}

/// Makes the character limp at its present velocity.
///
/// # Safety
/// `character` and `world` are null or used by no other thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_character_go_limp(
    character: *mut SinewCharacter,
    world: *mut SinewWorld,
) -> SinewStatus {
    guard(|| {
        let fall = |character: &mut Character, world: &mut sinew::physics::World| {
            character.go_limp(world);
            Ok(())
        };
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { together(character, world, fall) }
    })
}

/// Stores the state of the character in `state`.
///
/// # Safety
/// `character` is null or one that no other thread changes, `state` is null or points to room.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_character_state(
    character: *const SinewCharacter,
    state: *mut SinewCharacterState,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let now = match unsafe { shared(character, "character") }?.character.get()?.state() {
            State::Animated => SinewCharacterState::Animated,
            State::Limp => SinewCharacterState::Limp,
            State::Preparing => SinewCharacterState::Preparing,
            State::GettingUp => SinewCharacterState::GettingUp,
            State::Flinching => SinewCharacterState::Flinching,
            State::Powered => SinewCharacterState::Powered,
        };
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { give(state, "state", now) }
    })
}

/// Stores the ids of the character's bodies in the world in `ids`, in the order of the ragdoll.
///
/// # Safety
/// `character` is null or one that no other thread changes; `ids` has room for `capacity`, `count` is null or points to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_character_bodies(
    character: *const SinewCharacter,
    ids: *mut SinewBodyId,
    capacity: usize,
    count: *mut usize,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let bodies = unsafe { shared(character, "character") }?.character.get()?.bodies();
        let bodies: Vec<SinewBodyId> = bodies.iter().map(|&body| body.into()).collect();
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { fill(&bodies, ids, capacity, count) }
    })
}

/// Stores the transforms of all joints relative to their parents in `pose`, in the order of the file.
///
/// # Safety
/// `character` is null or one that no other thread changes; `pose` has room for `capacity`, `count` is null or points to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_character_pose(
    character: *const SinewCharacter,
    pose: *mut SinewLocalTransform,
    capacity: usize,
    count: *mut usize,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let now = unsafe { shared(character, "character") }?.character.get()?.pose();
        let local = |local: &sinew::anim::LocalTransform| SinewLocalTransform {
            pose: sinew::math::Transform::new(local.translation, local.rotation).into(),
            scale: local.scale.into(),
        };
        let all: Vec<SinewLocalTransform> = now.iter().map(local).collect();
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { fill(&all, pose, capacity, count) }
    })
}

/// Stores the matrix from the file's model space to the world in `matrix`, 3 rows of 4: the parent transform of the pose.
///
/// # Safety
/// `character` is null or one that no other thread changes, `matrix` is null or has room for 12 numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_character_world_from_model(
    character: *const SinewCharacter,
    matrix: *mut f32,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let affine = unsafe { shared(character, "character") }?.character.get()?.world_from_model();
        let (m, t) = (affine.linear, affine.translation);
        let rows = [
            [m.x_axis.x, m.y_axis.x, m.z_axis.x, t.x],
            [m.x_axis.y, m.y_axis.y, m.z_axis.y, t.y],
            [m.x_axis.z, m.y_axis.z, m.z_axis.z, t.z],
        ];
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { fill(rows.as_flattened(), matrix, 12, &mut 0) }
    })
}

/// Saves a character to a buffer, in addition to the snapshot of its world; see `sinew_world_save`.
///
/// # Safety
/// `character` is null or one that no other thread changes; `bytes` has room for `capacity`, `size` is null or points to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_character_save(
    character: *const SinewCharacter,
    bytes: *mut u8,
    capacity: usize,
    size: *mut usize,
) -> SinewStatus {
    guard(|| {
        let mut w = Writer::new();
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { shared(character, "character") }?.character.get()?.save(&mut w);
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { fill(w.as_bytes(), bytes, capacity, size) }
    })
}

/// Restores a saved character of the same kind. If the bytes are invalid, the character is unchanged.
///
/// # Safety
/// `character` is null or used by no other thread, `bytes` has `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_character_load(
    character: *mut SinewCharacter,
    bytes: *const u8,
    size: usize,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let (character, bytes) =
            unsafe { (exclusive(character, "character")?, elements(bytes, size, "bytes")?) };
        character.character.change(|character| {
            let mut loaded = character.clone();
            let outcome = loaded.load(&mut Reader::new(bytes));
            outcome.map_err(|what| error(SinewStatus::BadSnapshot, what.to_string()))?;
            *character = loaded;
            Ok(())
        })
    })
}
