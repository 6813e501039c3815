//! Physics for characters: give it a rigged file, and it falls, collides, is hit, gets up and walks on.
//!
#![doc = include_str!("../doc/fall.svg")]
//!
#![cfg_attr(feature = "ragdoll", doc = "```")]
#![cfg_attr(not(feature = "ragdoll"), doc = "```ignore")]
//! use sinew::prelude::*;
//! use std::sync::Arc;
//!
//! let mut world = World::new(WorldDef::default());
//! world.add_body(&BodyDef::fixed(Shape::HalfSpace)); // the ground
//! let def = Arc::new(sinew::mannequin::character()); // or the `def` of `sinew::load_character("hero.glb")`
//! let mut hero = Character::spawn(&mut world, &def, Transform::IDENTITY);
//! hero.set_move(Vec3::Z * 1.2); // walk, m/s
//! for step in 0..900 {
//!     if step == 90 {
//!         let chest = def.body_named("chest").expect("the character has this body");
//!         hero.hit(&mut world, chest, Vec3::new(60.0, 0.0, -60.0)); // N·s
//!     }
//!     world.step(); // 1/60 s
//!     hero.update(&mut world);
//! }
//! assert_eq!(hero.state(), State::Animated, "it has fallen, is up again and walks");
//! ```
//!
//! Start with [`World`](physics::World) and [`Character`](ragdoll::Character). The guide
//! (`docs/guide` in the repository) has characters, joints, cloth, cost, rollback and tuning by symptom.
//!
//! This is the crate to depend on. Each module is one of its member crates; [`prelude`] has the names that most
//! programs need.
//!
//! | feature | brings | default |
//! |---|---|---|
//! | `ragdoll` | `ragdoll`: from rig to ragdoll, animated to limp and back | yes |
//! | `formats` | `formats`: files in and out, `load`, `load_character`; needs `ragdoll` | yes |
//! | `pictures` | base colour pictures of files, for `Textures::Decode` | no |
//! | `fbx` | FBX files among those; compiles C | no |
//! | `parallel` | `all_threads`: a world stepped by every core of the machine | yes |
//! | `sse2` | kernels for x86-64 processors without AVX2, in builds without debug assertions; a third of the compile time | yes |
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

#[cfg(feature = "formats")]
mod loaded;
pub mod mannequin;
#[cfg(feature = "ragdoll")]
pub mod motions;
pub mod prelude;
#[cfg(feature = "formats")]
mod source;

#[cfg(feature = "formats")]
pub use loaded::{LoadCharacterError, LoadedCharacter, character_of, load_character};
#[cfg(feature = "formats")]
pub use source::{CharacterSource, character_hints};

/// Reads a character from a GLB, glTF, VRM or VRMA with the files next to it: rig, clips, and the data needed to write
/// a clip back into the same file. Pictures are left out.
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
/// Returns an error that names the file, the problem, and its location; see [`formats::read_gltf`].
#[cfg(feature = "formats")]
pub fn load(path: impl AsRef<std::path::Path>) -> formats::Result<formats::Document> {
    formats::load_gltf(path, formats::ReadOptions::default())
}

/// Makes a thread pool of all hardware threads, for `World::step_with`. The result of a step does not depend on it.
#[cfg(feature = "parallel")]
pub fn all_threads() -> physics::Threads {
    physics::Threads::new(std::thread::available_parallelism().map_or(1, core::num::NonZero::get))
}

/// Pages whose code is compiled and run by `cargo test --doc`.
#[cfg(all(doctest, feature = "formats"))]
mod pages {
    macro_rules! pages {
        ($($name:ident: $file:literal,)*) => {
            $(#[doc = include_str!($file)] struct $name;)*
        };
    }

    pages! {
        Readme: "../../../README.md",
        WorldPage: "../../../docs/world.md",
        CharacterPage: "../../../docs/character.md",
        MoverPage: "../../../docs/mover.md",
        GuideIntroduction: "../../../docs/guide/src/introduction.md",
        GuideFirstRagdoll: "../../../docs/guide/src/first_ragdoll.md",
        GuideYourCharacter: "../../../docs/guide/src/your_character.md",
        GuideBaking: "../../../docs/guide/src/baking.md",
        GuideWorlds: "../../../docs/guide/src/worlds.md",
        GuideCharacters: "../../../docs/guide/src/characters.md",
        GuideJoints: "../../../docs/guide/src/joints.md",
        GuideQueriesAndEvents: "../../../docs/guide/src/queries_and_events.md",
        GuideClothAndRope: "../../../docs/guide/src/cloth_and_rope.md",
        GuidePerformance: "../../../docs/guide/src/performance.md",
        GuideDeterminism: "../../../docs/guide/src/determinism.md",
        GuideSymptoms: "../../../docs/guide/src/symptoms.md",
        GuideFromRapier: "../../../docs/guide/src/from_rapier.md",
        GuideFromAvian: "../../../docs/guide/src/from_avian.md",
        GuideFromJolt: "../../../docs/guide/src/from_jolt.md",
        GuideFromUnity: "../../../docs/guide/src/from_unity.md",
        GuideFromUnreal: "../../../docs/guide/src/from_unreal.md",
        GuideBook: "../../../docs/guide/src/book.md",
    }
}
