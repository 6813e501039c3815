//! Garments that a character wears: capes, skirts and coats as cloth in the world.
//!
//! The chains of a [`Garment`](sinew_anim::Garment) become **one sheet**: a grid of particles, fine enough that no limb
//! fits between two of them. A body of the ragdoll holds the first row. The sheet is simulated in the world's step with
//! two-way coupling to the wearer.
//!
//! ```text
//!   seam    ●───○───●───○───●    held by a body          ● particle on a column
//!           │ ╳ │ ╳ │ ╳ │ ╳ │                            ○ particle between two
//!           ●───○───●───○───●    springs along threads
//!           │ ╳ │ ╳ │ ╳ │ ╳ │    and across them, bends, tethers to the seam
//!   hem     ●───○───●───○───●
//! ```
//!
//! Each joint rotates with the sheet under its bone: along the column, and about the column with the neighbouring
//! columns. Where the rest pose has the sheet inside a body, the sheet is moved outside. Joints rotate relative to
//! rest, so the drawn garment at rest is as the artist made it.
//!
//! ```
//! use sinew_math::{Transform, Vec3};
//! use sinew_physics::{World, WorldDef};
//! use sinew_ragdoll::Character;
//! use sinew_scenes::dressed::{CAPE, dressed};
//! use std::sync::Arc;
//!
//! let def = Arc::new(dressed(&[&CAPE], |garment| garment.area_density = 0.6));
//! let mut world = World::new(WorldDef::default());
//! let mut hero = Character::spawn(&mut world, &def, Transform::IDENTITY);
//! for _ in 0..30 {
//!     world.step();
//!     hero.update(&mut world);
//! }
//! let sheet = world.particles(hero.garments()[0]);
//! assert_eq!(sheet.positions().len(), def.garments().particles().sum::<usize>());
//! let turned = def.garments().joints().map(|joint| hero.pose()[joint].rotation.angle_to(def.rest()[joint].rotation));
//! assert!(turned.fold(0.0, f32::max) > 0.01, "it swings as he walks");
//! ```

mod backing;
mod grid;
mod mesh;
mod rig;
mod sheet;
mod wear;

pub use rig::GarmentRig;
pub(crate) use wear::{Wearer, Worn};
