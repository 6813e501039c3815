//! Similarity of two poses, independent of position and heading.
//!
//! The method is that of motion graphs (Kovar, Gleicher, Pighin, SIGGRAPH 2002, §3.1): one pose is rotated about the
//! vertical and moved so that its points are as near as possible to those of the other; the remaining distance is the
//! difference.

use crate::character::tuning::{STICK, STICK_WEIGHT};
use crate::def::{RagdollBodyDef, RagdollDef};
use crate::mapping::Mapping;
use sinew_anim::JointIdx;
use sinew_math::{Affine, Rotation, Transform, Vec3, min, trig};

/// Points of a body that are compared between poses, with their weights.
#[derive(Clone, Debug)]
pub(super) struct Landmarks {
    /// Joints of the bodies, in the order of the bodies.
    joints: Vec<JointIdx>,
    /// Bodies whose orientation is compared too, by the ends of two short sticks, forward and up. The pelvis is the
    /// first.
    trunk: Vec<(usize, Rotation)>,
    /// Weights of the points: the joints, then the ends of the sticks. Their sum is 1.
    weights: Vec<f32>,
    /// Length of the sticks, metres.
    stick: f32,
}

/// The landmarks of a pose, in character or world space.
#[derive(Clone, Debug)]
pub(super) struct Stance {
    pub points: Vec<Vec3>,
    /// Rotation of the pelvis relative to its bind pose.
    pub pelvis: Rotation,
}

/// Motion that aligns one stance with another, and the remaining distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct PoseSimilarity {
    /// Rotation about the vertical, followed by a translation.
    pub motion: Transform,
    /// Remaining distance: root of the weighted mean of squared distances, metres.
    pub distance: f32,
}

/// Returns the weight of a body's joint, by its role.
fn weight(body: &RagdollBodyDef) -> f32 {
    let has = |part: &str| body.role.ends_with(part);
    if has("Foot") || has("LowerLeg") || body.role == "hips" || body.role == "head" {
        1.0
    } else if has("Hand") || has("LowerArm") {
        0.5
    } else {
        0.25
    }
}

impl Landmarks {
    pub fn new(def: &RagdollDef) -> Self {
        let bind = |body: usize| (body, def.bodies[body].character_from_body.rotation.inverse());
        let chest = ["upperChest", "chest"]
            .iter()
            .find_map(|role| def.bodies.iter().position(|body| body.role == *role));
        let trunk: Vec<_> = core::iter::once(0).chain(chest.filter(|&body| body > 0)).map(bind).collect();
        let sticks = core::iter::repeat_n(STICK_WEIGHT, 2 * trunk.len());
        let shares: Vec<f32> = def.bodies.iter().map(weight).chain(sticks).collect();
        let total: f32 = shares.iter().sum();
        Self {
            joints: def.bodies.iter().map(|body| body.joint).collect(),
            trunk,
            weights: shares.iter().map(|share| share / total).collect(),
            stick: STICK * def.height,
        }
    }

    /// Computes the stance of a pose in model space at `world_from_character`. `points` and `bodies` are buffers.
    pub fn stance(
        &self,
        mapping: &Mapping,
        model: &[Affine],
        world_from_character: Transform,
        mut points: Vec<Vec3>,
        bodies: &mut Vec<Transform>,
    ) -> Stance {
        let world = mapping.world_from_model(world_from_character);
        points.clear();
        points.extend(self.joints.iter().map(|&joint| world.point(model[joint].translation)));
        mapping.bodies_from_model(model, world_from_character, bodies);
        let mut pelvis = Rotation::IDENTITY;
        for (index, &(body, body_from_bind)) in self.trunk.iter().enumerate() {
            let turn = bodies[body].rotation * body_from_bind;
            points.extend([Vec3::Z, Vec3::Y].map(|axis| points[body] + turn * axis * self.stick));
            if index == 0 {
                pelvis = turn;
            }
        }
        Stance { points, pelvis }
    }

    /// Returns the bodies whose orientation is compared, the pelvis first.
    pub fn trunk_bodies(&self) -> impl Iterator<Item = usize> {
        self.trunk.iter().map(|&(body, _)| body)
    }

    /// Aligns `from` with `to`, so that both have the same lowest height.
    pub fn compare(&self, from: &Stance, to: &Stance) -> PoseSimilarity {
        let middle = |stance: &Stance| {
            let mean =
                self.weights.iter().zip(&stance.points).fold(Vec3::ZERO, |sum, (&w, &point)| sum + point * w);
            let lowest = stance.points.iter().map(|point| point.y).fold(mean.y, min);
            Vec3::new(mean.x, lowest, mean.z)
        };
        let (from_middle, to_middle) = (middle(from), middle(to));
        let pairs = || {
            let both = from.points.iter().zip(&to.points);
            self.weights.iter().zip(both).map(|(&w, (&a, &b))| (w, a - from_middle, b - to_middle))
        };
        let (cos, sin) = pairs().fold((0.0, 0.0), |(cos, sin), (w, a, b)| {
            (cos + w * (a.x * b.x + a.z * b.z), sin + w * (a.z * b.x - a.x * b.z))
        });
        let turn = Rotation::from_axis_angle(Vec3::Y, trig::atan2(sin, cos));
        let squares = pairs().fold(0.0, |sum, (w, a, b)| sum + w * (turn * a - b).length_squared());
        let motion = Transform::new(to_middle - turn * from_middle, turn);
        PoseSimilarity { motion, distance: squares.sqrt() }
    }
}
