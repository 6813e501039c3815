//! Position errors of joints at given poses, eight side by side.

use super::turn::Turn;
use crate::joint::def::JointKind;
use crate::solver::articulation::tree::Link;
use crate::solver::joint::SolverJoint;
use crate::spatial::{Vec6, ZERO6, largest};
use sinew_math::dispatch::Kernel;
use sinew_math::lanes::{Lanes, Vector3, WIDTH};
use sinew_math::{Transform, Vec3};

/// Computes for each link the velocity change at its joint that removes the joint's position error within a substep. Returns the largest
/// error, m or rad.
pub(in crate::solver) struct FindErrors<'a> {
    pub links: &'a [Link],
    pub joints: &'a [SolverJoint],
    /// Poses of all bodies, and the velocities that lead to them.
    pub poses: &'a [Transform],
    pub velocities: &'a [Vec6],
    /// Length of the substep, seconds.
    pub h: f32,
    pub residuals: &'a mut [Vec6],
}

/// Kinds of joints whose errors are computed in lanes.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    /// Locks a point.
    Point,
    /// Locks a point and an axis.
    Hinge,
    Other,
}

impl Form {
    #[inline(always)]
    fn of(joint: &SolverJoint) -> Self {
        match joint.geometry.kind {
            JointKind::Hinge { .. } if joint.rigid == HINGE_ROWS => Self::Hinge,
            _ if joint.is_point() => Self::Point,
            _ => Self::Other,
        }
    }
}

/// Number of rows of an anchor; a hinge has two more for its axis.
const POINT_ROWS: usize = 3;
const HINGE_ROWS: usize = 5;

impl Kernel for FindErrors<'_> {
    type Output = f32;

    #[inline(always)]
    fn run<L: Lanes>(self) -> f32 {
        let Self { links, joints, poses, velocities, h, residuals } = self;
        let mut most = L::splat(0.0);
        for (links, residuals) in links.chunks(WIDTH).zip(residuals.chunks_mut(WIDTH)) {
            let of = |link: &Link| joints.get(link.joint as usize);
            let Some(first) = links.iter().find_map(of) else {
                residuals.fill(ZERO6);
                continue;
            };
            let mut eight = [first; WIDTH];
            for (joint, link) in eight.iter_mut().zip(links) {
                *joint = of(link).unwrap_or(first);
            }
            let rows = errors_of::<L>(&eight, poses);
            for ((row, link), residual) in rows.into_iter().zip(links).zip(residuals) {
                let mut error = ZERO6;
                if let Some(joint) = of(link) {
                    let form = Form::of(joint);
                    if form == Form::Other {
                        error = joint.position_error(poses, velocities, h);
                    } else {
                        row.store(&mut error);
                        if form == Form::Point {
                            error[POINT_ROWS..].fill(0.0);
                        }
                        joint.leave_open(&mut error);
                    }
                }
                let error = L::load(&error);
                most = L::max(most, error.abs());
                (-error / L::splat(h)).store(residual);
            }
        }
        let mut all = ZERO6;
        most.store(&mut all);
        largest(&all)
    }
}

/// Errors of eight joints, row by row: the gap between the anchors and, if any joint is a hinge, the deviation of B's
/// axis from two planes of A.
#[inline(always)]
fn errors_of<L: Lanes>(eight: &[&SolverJoint; WIDTH], poses: &[Transform]) -> [L; WIDTH] {
    let (mut at_a, mut at_b) = ([&Transform::IDENTITY; WIDTH], [&Transform::IDENTITY; WIDTH]);
    for k in 0..WIDTH {
        (at_a[k], at_b[k]) = (&poses[eight[k].a as usize], &poses[eight[k].b as usize]);
    }
    let [turn_a, turn_b] = [rotation!(at_a, rotation), rotation!(at_b, rotation)];
    let arm_a = turn_a.turned(vector!(eight, geometry.frame_a.translation));
    let arm_b = turn_b.turned(vector!(eight, geometry.frame_b.translation));
    let gap = (vector!(at_b, translation) - vector!(at_a, translation)) + (arm_b - arm_a);
    let zero = L::splat(0.0);
    let mut swings = [zero; 2];
    if eight.iter().any(|joint| Form::of(joint) == Form::Hinge) {
        let a = turn_a.product(rotation!(eight, geometry.frame_a.rotation));
        let b = turn_b.product(rotation!(eight, geometry.frame_b.rotation));
        let x = b.turned_axis(Vec3::X);
        swings = [-a.turned_axis(Vec3::Z).dot(x), a.turned_axis(Vec3::Y).dot(x)];
    }
    L::transpose([gap.x, gap.y, gap.z, swings[0], swings[1], zero, zero, zero])
}
