//! Ragdolls: bodies and joints built from a rigged file, or read from a definition.

use crate::border::{SinewStatus, error, exclusive, fill, free, give, give_handle, guard, shared, text};
use crate::types::{SinewBodyId, SinewPose};
use crate::world::SinewWorld;
use sinew::physics::Velocity;
use sinew::ragdoll::{BodySettings, BodyState, Ragdoll, RagdollDef};
use sinew_bindings::{Wishes, embedded, load_ragdoll};
use std::ffi::{CString, c_char};
use std::path::Path;

/// Ragdoll as data, which can be added to worlds.
pub struct SinewRagdoll {
    def: RagdollDef,
    roles: Vec<CString>,
}

impl SinewRagdoll {
    fn new(def: RagdollDef) -> Self {
        let roles =
            def.bodies.iter().map(|body| CString::new(body.role.as_str()).unwrap_or_default()).collect();
        Self { def, roles }
    }
}

/// Reads a ragdoll definition (`.json`) or an MJCF model (`.xml`), or builds the ragdoll of a character (GLB, glTF, VRM, FBX). A null path
/// loads that of the built-in mannequin.
///
/// # Safety
/// `path` is null or text, `ragdoll` is null or points to room for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_ragdoll_load(
    path: *const c_char,
    ragdoll: *mut *mut SinewRagdoll,
) -> SinewStatus {
    guard(|| {
        let def = if path.is_null() {
            embedded().build(&Wishes::default())?.0
        } else {
            // SAFETY: the caller guarantees the conditions under `# Safety`.
            load_ragdoll(Path::new(unsafe { text(path, "path") }?))?.def
        };
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { give_handle(ragdoll, "ragdoll", SinewRagdoll::new(def)) }
    })
}

/// Frees a ragdoll; its bodies in worlds remain. Null is allowed.
///
/// # Safety
/// `ragdoll` is null or came from `sinew_ragdoll_load` and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_ragdoll_free(ragdoll: *mut SinewRagdoll) {
    // SAFETY: the caller guarantees the conditions under `# Safety`.
    unsafe { free(ragdoll) }
}

/// Stores the number of bodies of the ragdoll in `count`.
///
/// # Safety
/// `ragdoll` is null or a ragdoll, `count` is null or points to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_ragdoll_body_count(
    ragdoll: *const SinewRagdoll,
    count: *mut usize,
) -> SinewStatus {
    // SAFETY: the caller guarantees the conditions under `# Safety`.
    guard(|| unsafe { give(count, "count", shared(ragdoll, "ragdoll")?.def.bodies.len()) })
}

/// Stores the role of a body in `role`, such as "head" or "leftUpperArm"; valid as long as the ragdoll.
///
/// # Safety
/// `ragdoll` is null or a ragdoll, `role` is null or points to room for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_ragdoll_role(
    ragdoll: *const SinewRagdoll,
    body: usize,
    role: *mut *const c_char,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let roles = &unsafe { shared(ragdoll, "ragdoll") }?.roles;
        let named = roles.get(body);
        let named = named
            .ok_or_else(|| error(SinewStatus::BadArgument, format!("no body {body} of {}", roles.len())))?;
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { give(role, "role", named.as_ptr()) }
    })
}

/// Adds a ragdoll to a world in its bind pose, standing at a pose (+Y up, facing +Z), at rest. Stores the ids of its bodies in `ids`, in
/// the order of the definition. If `ids` is too small, the world is unchanged.
///
/// # Safety
/// `world` is null or a world that no other thread uses, `ragdoll` is null or a ragdoll; `ids` has room for `capacity`, `count` is null or
/// points to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_ragdoll_spawn(
    ragdoll: *const SinewRagdoll,
    world: *mut SinewWorld,
    pose: SinewPose,
    ids: *mut SinewBodyId,
    capacity: usize,
    count: *mut usize,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let (def, world) = unsafe { (&shared(ragdoll, "ragdoll")?.def, exclusive(world, "world")?) };
        let pose = pose.read("the pose")?;
        // SAFETY: the caller guarantees the conditions under `# Safety`. Stale ids are written first, so that a lack of room is found before the world is changed.
        unsafe { fill(&vec![SinewBodyId { bits: u64::MAX }; def.bodies.len()], ids, capacity, count) }?;
        let states: Vec<BodyState> = def
            .bodies
            .iter()
            .map(|body| BodyState {
                world_from_body: pose * body.character_from_body,
                velocity: Velocity::default(),
            })
            .collect();
        let settings = BodySettings::default();
        let spawned = world.world.change(|world| Ok(Ragdoll::spawn(world, def, &states, &settings)))?;
        let bodies: Vec<SinewBodyId> = spawned.bodies.into_iter().map(SinewBodyId::from).collect();
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { fill(&bodies, ids, capacity, count) }
    })
}
