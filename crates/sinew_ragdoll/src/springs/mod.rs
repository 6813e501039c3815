//! Springs worn by a character: hair, tails, ears, straps, skirts. They follow every motion of the character (clips,
//! mover, muscles, falls) and collide with their own colliders, the character's body, the world and other characters.
//!
//! **Law.** Every spring bone has a tip at the bone's length from its joint. The law is the reference of
//! [VRMC_springBone 1.0](https://github.com/vrm-c/vrm-specification/tree/master/specification/VRMC_springBone-1.0),
//! which advances the tip by Verlet integration once per frame, so its motion depends on the frame rate. Authors tune
//! springs at 60 frames per second; here the springs **always tick at 60 Hz** ([`TICK`]), for any step of the world:
//!
//! ```text
//! x' = x + (1 − drag) (x − x₋₁) + TICK (stiffness r + gravity + drag · wind)      then the length, limits, colliders
//! ```
//!
//! with the joint's position and rest direction `r` at the time of the tick, on a parabola through the last three
//! poses. Between two ticks the shown state continues the last one along the closed form of the sampled motion, free
//! flight through a medium with a constant force: after the share `ρ` of a tick, with `d = 1 − drag`,
//!
//! ```text
//! x(ρ) = x + v ρ + (x − x₋₁ − v) d (1 − d^ρ) / (1 − d),      v = TICK · force / (1 − d)
//! ```
//!
//! which equals the tick for `ρ = 1`. The effect of length, limits and colliders over the whole tick is part of the
//! tip's force, so a tip that they hold at rest is shown at rest, even inside a collider. The interpolation stores
//! nothing, so errors do not accumulate: the path is the same at 30 and 240 steps per second except for motion between
//! two poses (ADR 0020).
//!
//! Springs are massless to the character: they follow its motion and exert no force on it.
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
//!     // The character is carried to its left, faster and faster.
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
