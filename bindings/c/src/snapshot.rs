//! State of a world as bytes, and its hash.

use crate::border::{SinewStatus, elements, error, exclusive, fill, give, guard, shared};
use crate::world::SinewWorld;
use sinew::math::{Reader, Writer};

/// Stores the hash of the complete state in `hash`: the same on every machine, for every number of threads.
///
/// # Safety
/// `world` is null or a world that no other thread changes, `hash` is null or points to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_hash(world: *const SinewWorld, hash: *mut u64) -> SinewStatus {
    // SAFETY: the caller guarantees the conditions under `# Safety`.
    guard(|| unsafe { give(hash, "hash", shared(world, "world")?.world.get()?.hash()) })
}

/// Saves a world to a buffer; stores the number of bytes in `size`, also if the capacity is too small.
///
/// # Safety
/// `world` is null or a world that no other thread changes; `bytes` has room for `capacity`, `size` is null or points to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_save(
    world: *const SinewWorld,
    bytes: *mut u8,
    capacity: usize,
    size: *mut usize,
) -> SinewStatus {
    guard(|| {
        let mut w = Writer::new();
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { shared(world, "world") }?.world.get()?.save(&mut w);
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { fill(w.as_bytes(), bytes, capacity, size) }
    })
}

/// Restores a saved world. If the bytes are invalid, the world is unchanged.
///
/// # Safety
/// `world` is null or a world that no other thread uses, `bytes` has `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_load(
    world: *mut SinewWorld,
    bytes: *const u8,
    size: usize,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let (world, bytes) = unsafe { (exclusive(world, "world")?, elements(bytes, size, "bytes")?) };
        world.world.change(|world| {
            let loaded = world.load(&mut Reader::new(bytes));
            loaded.map_err(|what| error(SinewStatus::BadSnapshot, what.to_string()))
        })
    })
}
