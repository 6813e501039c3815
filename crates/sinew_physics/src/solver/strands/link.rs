//! A link of eight strands, or of eight pieces of one strand, side by side.

use super::super::flight::{Eight, ZERO, put, take};
use super::super::motion::Turn;
use super::order::{NONE, Placed};
use super::{SolvedBody, SolvedJoint, stiffness_of};
use crate::body::Velocity;
use crate::solver::view::{View, lasting_force};
use crate::spatial::join;
use sinew_math::lanes::{Lanes, Vector3, WIDTH};
use sinew_math::{Rotation, Transform, Vec3};

/// Bodies and the joints that attach them to the previous link or to the body that holds the strand ("parent").
#[derive(Clone, Debug)]
pub(super) struct Link {
    /// Indices of the bodies in the world.
    bodies: [u32; WIDTH],
    pub joints: [u32; WIDTH],
    /// 1 if the body is the joint's second one, −1 if it is the first.
    sign: Eight,
    pub mass: Eight,
    /// Principal moments, kg·m².
    pub inertia: [Eight; 3],
    /// Anchor of the joint on body and parent, in their principal frames, metres.
    pub anchor: [Eight; 3],
    pub parent_anchor: [Eight; 3],
    /// Moments that a unit of pull at the anchor adds to body and parent.
    pub stiffness: [Eight; 3],
    pub parent_stiffness: [Eight; 3],
    /// Acceleration by gravity and the forces of this step, m/s², and the torque of this step, N·m, world axes.
    pub acceleration: [Eight; 3],
    pub torque: [Eight; 3],
    pub linear_damping: Eight,
    pub angular_damping: Eight,
    pub position: [Eight; 3],
    pub rotation: [Eight; 4],
    pub velocity: [Eight; 3],
    pub spin: [Eight; 3],
    /// Bit set of the lanes whose bodies exceeded the world's speed limits.
    pub limited: u8,
    /// Angular momentum, world axes, N·m·s.
    pub momentum: [Eight; 3],
    /// Force of the joint on the body in the last substep, N.
    pub force: [Eight; 3],
    /// Impulses of the joint on the body in the substeps so far, torque about the anchor, N·s and N·m·s.
    pub pushed: [Eight; 3],
    pub turned: [Eight; 3],
    /// Vectors from the centres of mass of body and parent to the anchor, world axes; zero for a fixed parent.
    pub arm: [Eight; 3],
    pub parent_arm: [Eight; 3],
    /// Anchor of the body minus that of the parent, world axes.
    pub gap: [Eight; 3],
    /// Moments added for stability, kg·m².
    pub excess: [Eight; 3],
    /// The factor, see [`Swivel`](super::super::articulation::elimination::Swivel). For the first link of free strands, the last field is
    /// the inverse of the remaining mass.
    pub pivot: [Eight; 6],
    pub coupled: [[Eight; 3]; 3],
    pub passed: [Eight; 6],
    /// Requested velocity of the anchor relative to the parent's motion, m/s, and the remaining torque on the body, N·m·s.
    pub asked: [Eight; 3],
    pub left: [Eight; 3],
    /// Reference velocities for impulses: first those after the forces have acted, then those after the bodies have
    /// moved.
    pub start_velocity: [Eight; 3],
    pub start_spin: [Eight; 3],
    /// Velocities before the last correction.
    pub before_velocity: [Eight; 3],
    pub before_spin: [Eight; 3],
    /// Predicted pose.
    pub ahead: [Eight; 3],
    pub ahead_rotation: [Eight; 4],
}

const ZERO3: [Eight; 3] = [ZERO; 3];
const UPRIGHT: [Eight; 4] = [ZERO, ZERO, ZERO, [1.0; WIDTH]];

impl Link {
    pub const EMPTY: Self = Self {
        bodies: [NONE; WIDTH],
        joints: [NONE; WIDTH],
        sign: ZERO,
        mass: [1.0; WIDTH],
        inertia: [[1.0; WIDTH]; 3],
        anchor: ZERO3,
        parent_anchor: ZERO3,
        stiffness: ZERO3,
        parent_stiffness: ZERO3,
        acceleration: ZERO3,
        torque: ZERO3,
        linear_damping: ZERO,
        angular_damping: ZERO,
        position: ZERO3,
        rotation: UPRIGHT,
        velocity: ZERO3,
        spin: ZERO3,
        limited: 0,
        momentum: ZERO3,
        force: ZERO3,
        pushed: ZERO3,
        turned: ZERO3,
        arm: ZERO3,
        parent_arm: ZERO3,
        gap: ZERO3,
        excess: ZERO3,
        pivot: [ZERO; 6],
        coupled: [ZERO3; 3],
        passed: [ZERO; 6],
        asked: ZERO3,
        left: ZERO3,
        start_velocity: ZERO3,
        start_spin: ZERO3,
        before_velocity: ZERO3,
        before_spin: ZERO3,
        ahead: ZERO3,
        ahead_rotation: UPRIGHT,
    };

    /// Writes a body of the world and its joint into a lane.
    pub fn write(&mut self, lane: usize, placed: &Placed, view: &View<'_>) {
        let body = view.bodies.at(placed.body);
        let Transform { translation, rotation } = body.world_from_principal;
        let (force, torque) = lasting_force(body, view);
        (self.bodies[lane], self.joints[lane]) = (placed.body, placed.joint);
        self.limited &= !(1 << lane);
        self.sign[lane] = if placed.is_b { 1.0 } else { -1.0 };
        self.mass[lane] = body.mass;
        put(body.inertia, &mut self.inertia, lane);
        put(force / body.mass, &mut self.acceleration, lane);
        put(torque, &mut self.torque, lane);
        self.linear_damping[lane] = body.linear_damping;
        self.angular_damping[lane] = body.angular_damping;
        put(translation, &mut self.position, lane);
        for (row, number) in self.rotation.iter_mut().zip([rotation.x, rotation.y, rotation.z, rotation.w]) {
            row[lane] = number;
        }
        put(body.velocity.linear, &mut self.velocity, lane);
        put(body.velocity.angular, &mut self.spin, lane);
        self.write_joint(lane, placed, view);
        put(Vec3::ZERO, &mut self.pushed, lane);
        put(Vec3::ZERO, &mut self.turned, lane);
    }

    fn write_joint(&mut self, lane: usize, placed: &Placed, view: &View<'_>) {
        let (mut anchor, mut parent_anchor, mut force) = (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
        if placed.joint != NONE {
            let joint = view.joints.at(placed.joint);
            let anchors = [joint.frame_a.translation, joint.frame_b.translation];
            (anchor, parent_anchor) = (anchors[usize::from(placed.is_b)], anchors[usize::from(!placed.is_b)]);
            force = joint.force * self.sign[lane];
        }
        put(anchor, &mut self.anchor, lane);
        put(parent_anchor, &mut self.parent_anchor, lane);
        put(stiffness_of(anchor), &mut self.stiffness, lane);
        put(stiffness_of(parent_anchor), &mut self.parent_stiffness, lane);
        put(force, &mut self.force, lane);
    }

    /// Empties a lane: a body at rest without joints and forces.
    pub fn clear(&mut self, lane: usize) {
        (self.bodies[lane], self.joints[lane]) = (NONE, NONE);
        (self.mass[lane], self.linear_damping[lane], self.angular_damping[lane]) = (1.0, 0.0, 0.0);
        for vector in self.vectors() {
            put(Vec3::ZERO, vector, lane);
        }
        put(Vec3::ONE, &mut self.inertia, lane);
        for (row, number) in self.rotation.iter_mut().zip([0.0, 0.0, 0.0, 1.0]) {
            row[lane] = number;
        }
    }

    /// Copies a lane of another link into a lane of this one.
    #[cfg(test)]
    pub fn copy_lane(&mut self, lane: usize, from: &Self, of: usize) {
        self.mass[lane] = from.mass[of];
        for (row, from) in self.rotation.iter_mut().zip(&from.rotation) {
            row[lane] = from[of];
        }
        for (vector, from) in self.vectors().into_iter().zip(from.clone().vectors()) {
            for (row, from) in vector.iter_mut().zip(from) {
                row[lane] = from[of];
            }
        }
    }

    /// Vectors that are written at the start of a step.
    fn vectors(&mut self) -> [&mut [Eight; 3]; 11] {
        [
            &mut self.inertia,
            &mut self.anchor,
            &mut self.parent_anchor,
            &mut self.stiffness,
            &mut self.parent_stiffness,
            &mut self.acceleration,
            &mut self.torque,
            &mut self.position,
            &mut self.velocity,
            &mut self.spin,
            &mut self.force,
        ]
    }

    /// Copies the first lane into the lanes from `lanes` on, so that no unused lane takes longer than a used one.
    pub fn fill(&mut self, lanes: usize) {
        let fill = |row: &mut Eight| {
            for lane in lanes..WIDTH {
                row[lane] = row[0];
            }
        };
        [&mut self.mass, &mut self.linear_damping, &mut self.angular_damping].into_iter().for_each(fill);
        self.rotation.iter_mut().for_each(fill);
        for vector in self.vectors() {
            vector.iter_mut().for_each(fill);
        }
    }

    pub fn body(&self, lane: usize) -> SolvedBody {
        let [x, y, z, w] = self.rotation.map(|row| row[lane]);
        SolvedBody {
            index: self.bodies[lane],
            pose: Transform::new(take(&self.position, lane), Rotation::from_xyzw(x, y, z, w)),
            velocity: Velocity { linear: take(&self.velocity, lane), angular: take(&self.spin, lane) },
            is_limited: self.limited >> lane & 1 == 1,
        }
    }

    /// State that the joint keeps for the next step. A plain joint has neither limits nor motors.
    pub fn joint(&self, lane: usize) -> SolvedJoint {
        let sign = self.sign[lane];
        SolvedJoint {
            index: self.joints[lane],
            force: take(&self.force, lane) * sign,
            reaction: join(take(&self.pushed, lane) * sign, take(&self.turned, lane) * sign),
            ..SolvedJoint::default()
        }
    }
}

/// Rotations of eight bodies.
#[inline(always)]
pub(super) fn load_turn<L: Lanes>([x, y, z, w]: &[Eight; 4]) -> Turn<L> {
    Turn { vector: Vector3::load(x, y, z), real: L::load(w) }
}

#[inline(always)]
pub(super) fn store_turn<L: Lanes>(turn: Turn<L>, [x, y, z, w]: &mut [Eight; 4]) {
    turn.vector.x.store(x);
    turn.vector.y.store(y);
    turn.vector.z.store(z);
    turn.real.store(w);
}

/// Fixed bodies that hold eight strands.
#[derive(Clone, Debug)]
pub(super) struct Hook {
    /// Centre of the fixed body, and the vector from the centre to the anchor, world axes.
    pub position: [Eight; 3],
    pub arm: [Eight; 3],
}

impl Hook {
    pub const EMPTY: Self = Self { position: ZERO3, arm: ZERO3 };

    /// Writes the fixed body that holds the strand with the given first link.
    pub fn write(&mut self, lane: usize, first: &Placed, view: &View<'_>) {
        let joint = view.joints.at(first.joint);
        let Transform { translation, rotation } = view.bodies.at(first.parent).world_from_principal;
        let frame = if first.is_b { &joint.frame_a } else { &joint.frame_b };
        put(translation, &mut self.position, lane);
        put(rotation * frame.translation, &mut self.arm, lane);
    }

    /// Centre of the fixed body and vector to the anchor in the first lane.
    pub fn first(&self) -> [Vec3; 2] {
        [take(&self.position, 0), take(&self.arm, 0)]
    }

    /// Fills the unused lanes like [`Link::fill`].
    pub fn fill(&mut self, lanes: usize) {
        for row in self.position.iter_mut().chain(&mut self.arm) {
            for lane in lanes..WIDTH {
                row[lane] = row[0];
            }
        }
    }
}
