//! Springs that a character wears: hair, tails, ears, straps, skirts. They swing behind whatever moves the character (clips,
//! the mover, its muscles, its fall), and come up against colliders of their own, its body, the world and others in it.
//!
//! **Law.** Every spring bone has a tip that is held at the bone's length from its joint. The law is the reference of
//! [VRMC_springBone 1.0](https://github.com/vrm-c/vrm-specification/tree/master/specification/VRMC_springBone-1.0), which
//! advances the tip by Verlet's rule once a frame and therefore swings otherwise at every frame rate. Authors tune it at 60 frames a
//! second; here it **always ticks at 60 Hz** ([`TICK`]), whatever the step of the world:
//!
//! ```text
//! x' = x + (1 − drag) (x − x₋₁) + TICK (stiffness r + gravity + drag · wind)      then the length, limits, colliders
//! ```
//!
//! with the joint's place and rest direction `r` at the time of the tick, on a parabola through the last three poses. What is shown at
//! times between two ticks continues the last one along the closed form of the motion that it samples, free flight
//! through a medium with a constant force: after the share `ρ` of a tick, with `d = 1 − drag`,
//!
//! ```text
//! x(ρ) = x + v ρ + (x − x₋₁ − v) d (1 − d^ρ) / (1 − d),      v = TICK · force / (1 − d)
//! ```
//!
//! which is the tick itself for `ρ = 1`. What length, limits and colliders do to the tip in the whole tick is part of its force: a tip that
//! they keep at rest is shown at rest, also where it cannot get out of them. Nothing of it is kept, so errors do not add up: the path is the same at 30 and 240 steps
//! a second but for what lies between two poses (ADR 0020).
//!
//! Springs are light: they take their motion from the character and give none back.
//!
//! ```
//! use sinew_anim::rest_pose;
//! use sinew_math::{Affine, Transform, Vec3};
//! use sinew_ragdoll::{SpringStep, SpringSwing};
//!
//! let def = sinew_scenes::maned::maned(&sinew_scenes::maned::HAIR); // the mannequin, with hair
//! let pose = rest_pose(&def.rig);
//! let mut swing = SpringSwing::new();
//! for frame in 0..30u16 {
//!     // It is carried to its left, faster and faster.
//!     let world_from_model = Affine::from(Transform::from_translation(Vec3::X * 0.002 * f32::from(frame * frame)));
//!     let (rig, seconds) = (def.springs(), 1.0 / 60.0);
//!     swing.step(&SpringStep { rig, pose: &pose, world_from_model, bodies: &[], world: None, seconds });
//! }
//! let turned = def.springs().joints().zip(swing.turns());
//! let most = turned.map(|(joint, &turn)| pose[joint].rotation.angle_to(turn)).fold(0.0, f32::max);
//! assert!(most > 0.1, "its hair lags behind: {most} rad");
//! ```

mod collide;
mod distance;
mod limit;
mod rig;
mod save;
mod step;
mod tip;
mod tuning;

pub use rig::SpringRig;
pub use step::{SpringStep, SpringSwing};
pub use tuning::TICK;
