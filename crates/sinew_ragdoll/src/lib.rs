//! Builds ragdolls from rigs and bakes their motion into clips. No other crate depends on physics **and** animation.
//!
#![doc = include_str!("../doc/ragdoll.svg")]
//!
//! ```
//! use sinew::prelude::*;
//! use std::sync::Arc;
//!
//! let mannequin = sinew::mannequin::mannequin();
//! let analysis = analyze(&mannequin.rig)?;
//! let (ragdoll, report) = build(&mannequin.rig, &analysis, &BuildOptions::default())?;
//! println!("{} bodies, {:.0} kg; {:?}", ragdoll.bodies.len(), ragdoll.total_mass, report.notes);
//! let def = Arc::new(CharacterDef::new(mannequin.rig, ragdoll, &analysis.bind_model));
//!
//! let mut world = World::new(WorldDef::default());
//! world.add_body(&BodyDef::fixed(Shape::HalfSpace));
//! let mut hero = Character::spawn(&mut world, &def, Transform::IDENTITY);
//! hero.go_limp(&mut world);
//! for _ in 0..120 {
//!     world.step();
//!     hero.update(&mut world);
//! }
//! assert!(hero.world_from_character().translation.y < 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`build()`] makes a [`RagdollDef`] from a rig, [`Character`] is a character in a world, [`bake()`] writes a part of
//! its motion as a clip, and [`doctor()`] finds defects of a ragdoll.
#![forbid(unsafe_code)]

pub mod bake;
pub mod build;
pub mod character;
pub mod def;
pub mod doctor;
pub mod drive;
pub mod filter;
pub mod fit;
pub mod garments;
pub mod hand_over;
pub mod limits;
pub mod mapping;
pub mod masses;
mod owner;
pub mod quality;
pub mod ragdoll;
pub mod rig_match;
pub mod settings;
pub mod skin;
pub mod springs;
mod tuning;

pub use bake::{BakeDrive, BakeHit, BakeInput, BakeMover, BakeReturn, Baked, HitEffect, bake, bake_together};
pub use build::{BuildError, BuildOptions, BuildReport, build};
pub use character::{
    AfterSettling, Blow, Character, CharacterDef, CharacterEvent, Detail, Distances, FootPlanting,
    GettingReady, Grab, GrabPoint, Grip, GroundContact, HitBodies, InWorld, Limb, Locomotion, MotionError,
    MotionSet, Opening, Part, Preset, State, Toughness,
};
pub use def::{RagdollBodyDef, RagdollDef, RagdollJointDef};
pub use doctor::{Repair, cure, doctor};
pub use drive::{DriveMode, Drives, Muscle, Pin, torque_caps};
pub use fit::ShapeChoice;
pub use garments::GarmentRig;
pub use limits::LimitSource;
pub use mapping::Mapping;
pub use masses::de_leva::Sex;
pub use quality::{DropReport, FallQuality, QualityMeter, Verdict, drop_test, gate};
pub use ragdoll::{BodySettings, BodyState, Ragdoll};
pub use rig_match::RigMismatch;
pub use settings::{Settings, SettingsError, build_moving, build_with};
pub use skin::{Flaw, FlawKind, SkinMeter, SkinQuality, measure_skin};
pub use springs::{SpringRig, SpringStep, SpringSwing};
