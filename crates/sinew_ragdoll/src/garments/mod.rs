//! Garments that a character wears: capes, skirts and coats as cloth in the world.
//!
//! The chains of a [`Garment`](sinew_anim::Garment) are sewn side by side into **one sheet**: a grid of particles, fine enough for no limb to come between two of
//! them, whose first row a body of the ragdoll holds. It moves in the world's step, with all that is in it, and bears on the wearer as the wearer bears it.
//!
//! ```text
//!   seam    ●───○───●───○───●    held by a body          ● particle on a column
//!           │ ╳ │ ╳ │ ╳ │ ╳ │                            ○ particle between two
//!           ●───○───●───○───●    springs along threads
//!           │ ╳ │ ╳ │ ╳ │ ╳ │    and across them, bends, tethers to the seam
//!   hem     ●───○───●───○───●
//! ```
//!
//! Each joint turns as the sheet under its bone does: along the column, and about it by the columns beside it. Where the rest pose has the sheet within a
//! body, the sheet is made outside of it; joints turn from rest as the sheet turns from there, so that what is drawn is at rest what the artist made.
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
