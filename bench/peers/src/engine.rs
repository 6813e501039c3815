//! Interface of a measured engine.

use core::str::FromStr;
use serde_json::{Value, json};
use sinew::math::{Rotation, SwingTwistLimit, Transform, Vec3};
use sinew::physics::Quality;
use sinew_scenes::blueprint::{Blueprint, BlueprintJoint};
use thiserror::Error;

use crate::scenes::{BoxPairs, ClothScene, Field, RayScene};
use sinew_scenes::crowd::CrowdScene;

/// Work per step, the setting by which an engine trades time for accuracy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Effort {
    /// The engine's default.
    #[default]
    Default,
    /// Number of substeps of a step, for peers: Rapier's solver iterations, Box3D's substeps, Jolt's collision steps.
    Substeps(u32),
    /// Quality of Sinew's world.
    Quality(Quality),
}

impl FromStr for Effort {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "fast" => Ok(Self::Quality(Quality::Fast)),
            "balanced" => Ok(Self::Quality(Quality::Balanced)),
            "exact" => Ok(Self::Quality(Quality::Exact)),
            _ => match text.parse() {
                Ok(substeps @ 1..=64) => Ok(Self::Substeps(substeps)),
                _ => Err("fast, balanced or exact (Sinew), or 1 to 64 substeps (peers)".into()),
            },
        }
    }
}

/// An engine under measurement, with its default settings.
///
/// If an engine cannot run a scene it returns [`Unsupported`], never a similar scene.
pub trait Engine: Sync {
    /// Returns name, version and settings.
    fn describe(&self) -> Description;

    /// Returns the fields of the engine; other scenes are skipped.
    fn fields(&self) -> &'static [Field] {
        &[Field::Physics]
    }

    /// Returns a world with all of the blueprint, before its first step.
    ///
    /// # Errors
    /// If the engine lacks a feature or the kind of effort.
    fn build_at(&self, scene: &Blueprint, effort: Effort) -> Result<Box<dyn Simulation>, Unsupported>;

    /// Returns [`Engine::build_at`] the engine's default effort.
    ///
    /// # Errors
    /// If the engine lacks a feature.
    fn build(&self, scene: &Blueprint) -> Result<Box<dyn Simulation>, Unsupported> {
        self.build_at(scene, Effort::Default)
    }

    /// Returns a cloth over obstacles.
    ///
    /// # Errors
    /// If the engine lacks a feature.
    fn build_cloth(&self, _scene: &ClothScene) -> Result<Box<dyn ClothSimulation>, Unsupported> {
        Err(Unsupported::new("no cloth"))
    }

    /// Returns static boxes, ready for rays.
    ///
    /// # Errors
    /// If the engine lacks a feature.
    fn build_rays(&self, _scene: &RayScene) -> Result<Box<dyn RayCaster>, Unsupported> {
        Err(Unsupported::new("no rays"))
    }

    /// Returns pairs of boxes, in the form in which the engine tests them.
    ///
    /// # Errors
    /// If the engine lacks a feature.
    fn build_boxes(&self, _pairs: &BoxPairs) -> Result<Box<dyn OverlapTester>, Unsupported> {
        Err(Unsupported::new("no public test of two boxes for overlap"))
    }

    /// Returns characters, each with its own memory, before the first pose.
    ///
    /// # Errors
    /// If the engine lacks a feature.
    fn build_crowd<'a>(&self, _crowd: &'a CrowdScene) -> Result<Box<dyn Crowd + 'a>, Unsupported> {
        Err(Unsupported::new("no animation"))
    }
}

/// A world of bodies.
pub trait Simulation {
    /// Takes one step of 1/60 s on the calling thread.
    fn step(&mut self);

    /// Replaces `out` by the state of every body, including static ones, in the blueprint's order.
    fn states(&self, out: &mut Vec<BodyState>);

    /// Returns true if a dynamic body is awake.
    fn is_awake(&self) -> bool;
}

/// A cloth and its obstacles.
pub trait ClothSimulation {
    /// Takes one step of 1/60 s on the calling thread.
    fn step(&mut self);

    /// Replaces `out` by the state of every particle, row by row.
    fn particles(&self, out: &mut Vec<ParticleState>);
}

/// Static boxes for rays.
pub trait RayCaster {
    /// Returns the number of the scene's rays in `range` that hit a box; finds the closest hit of each.
    fn count_hits(&mut self, range: core::ops::Range<usize>) -> usize;
}

/// Pairs of boxes that may overlap.
pub trait OverlapTester {
    /// Returns the number of the pairs in `range` that overlap.
    fn count_overlaps(&mut self, range: core::ops::Range<usize>) -> usize;
}

/// Characters that play clips.
pub trait Crowd {
    /// Samples both clips for every character at its times of this step, blends them, and computes the model
    /// poses.
    fn step(&mut self, step: usize);

    /// Returns a character's result of the last step, number `step`.
    fn pose(&mut self, character: usize, step: usize) -> CharacterPose;
}

/// Result of a character's joints.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CharacterPose {
    /// For each clip, the sampled rotation of every joint relative to its parent.
    pub sampled: [Vec<Rotation>; 2],
    /// Origin of every joint of the blended pose, model space, metres.
    pub places: Vec<Vec3>,
}

/// Pose and velocity of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyState {
    /// World position and orientation of the body's **origin** (not of its centre of mass).
    pub world_from_body: Transform,
    /// Velocity of the **centre of mass**, m/s.
    pub linear_velocity: Vec3,
    /// Angular velocity, rad/s, world axes.
    pub angular_velocity: Vec3,
}

impl BodyState {
    /// Returns the state of a body at rest.
    pub fn at(position: Vec3, rotation: Rotation) -> Self {
        Self { world_from_body: Transform::new(position, rotation), ..Self::default() }
    }
}

/// Place and velocity of a particle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ParticleState {
    /// Position, world, metres.
    pub position: Vec3,
    /// Velocity, m/s.
    pub velocity: Vec3,
}

/// Description that is printed beside every result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Description {
    /// Name on the command line.
    pub name: &'static str,
    /// Version of the code that runs.
    pub version: String,
    /// Compiler flags.
    pub flags: String,
    /// Solver settings, in words; starts with "defaults" if the settings are the defaults.
    pub settings: String,
}

impl Description {
    /// Returns the description as part of a report.
    pub fn to_json(&self) -> Value {
        json!({
            "engine": self.name,
            "version": self.version,
            "flags": self.flags,
            "settings": self.settings,
        })
    }
}

/// Feature that an engine lacks to run a scene.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{0}")]
pub struct Unsupported(String);

impl Unsupported {
    /// Creates the error from the reason in words, lower case, without a full stop.
    pub fn new(why: impl Into<String>) -> Self {
        Self(why.into())
    }
}

/// Returns the half-angle of a limit whose swing is a circular cone, radians.
///
/// # Errors
/// If the limit's sides differ: peers have cones only.
pub fn circular_cone(limit: &SwingTwistLimit) -> Result<f32, Unsupported> {
    let half = limit.swing_y.hi;
    let sides = [-limit.swing_y.lo, limit.swing_z.hi, -limit.swing_z.lo];
    if sides.iter().all(|side| (side - half).abs() < 1e-5) {
        Ok(half)
    } else {
        Err(Unsupported::new("a swing cone that is not circular"))
    }
}

/// Returns the frames of a joint in its two bodies in the start pose.
pub fn joint_frames(scene: &Blueprint, joint: &BlueprintJoint) -> [Transform; 2] {
    [joint.a, joint.b].map(|place| {
        let body = &scene.bodies[place];
        Transform::new(body.position, body.rotation).inverse() * joint.world_from_joint
    })
}
