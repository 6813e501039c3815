//! Physics for characters: give it a rigged file, and it falls, collides, is hit, gets up and walks on.
//!
//! The crate to add; each module is one of the crates it is made of, [`prelude`] the names that most programs need.
//!
//! | feature | brings | default |
//! |---|---|---|
//! | `ragdoll` | `ragdoll`: from rig to ragdoll, animated to limp and back | yes |
//! | `formats` | `formats`: files in and out, `load`; needs `ragdoll` | yes |
//! | `fbx` | FBX files among those; compiles C | no |
//! | `parallel` | `all_threads`: a world stepped by every core of the machine | yes |
//! | `serde` | `Serialize` and `Deserialize` for definitions (`BodyDef`, `JointDef` ...) | no |
#![forbid(unsafe_code)]

pub use sinew_anim as anim;
#[cfg(feature = "formats")]
pub use sinew_formats as formats;
pub use sinew_geometry as geometry;
pub use sinew_math as math;
pub use sinew_physics as physics;
#[cfg(feature = "ragdoll")]
pub use sinew_ragdoll as ragdoll;

pub mod mannequin;
#[cfg(feature = "ragdoll")]
pub mod motions;
pub mod prelude;

/// Reads a character from a GLB, glTF, VRM or VRMA with the files beside it: rig, clips, and what is needed to write a
/// clip back into the same file. Pictures are left out.
///
/// ```no_run
/// use sinew::anim::analyze;
/// use sinew::ragdoll::{BuildOptions, build};
///
/// let document = sinew::load("x.glb")?;
/// let analysis = analyze(&document.rig)?;
/// let (ragdoll, report) = build(&document.rig, &analysis, &BuildOptions::default())?;
/// println!("{} bodies, {} kg", ragdoll.bodies.len(), ragdoll.total_mass);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Names the file, what is wrong with it, and where; see [`formats::read_gltf`].
#[cfg(feature = "formats")]
pub fn load(path: impl AsRef<std::path::Path>) -> formats::Result<formats::Document> {
    formats::load_gltf(path, formats::ReadOptions::default())
}

/// Runs a step on as many threads as the machine can at once: for `World::step_with`. The result does not depend on it.
#[cfg(feature = "parallel")]
pub fn all_threads() -> physics::Threads {
    physics::Threads::new(std::thread::available_parallelism().map_or(1, core::num::NonZero::get))
}

/// The README's example.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;

/// The guide to worlds, whose code is tested.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/world.md")]
struct WorldPage;

/// The guide to characters, whose code is tested.
#[cfg(all(doctest, feature = "ragdoll"))]
#[doc = include_str!("../../../docs/character.md")]
struct CharacterPage;
