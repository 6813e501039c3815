//! A link of eight trees side by side.

use crate::joint::TWIST;
use crate::solver::articulation::tree::{NONE, Ways, arms};
use crate::solver::flight::{Eight, ZERO, put};
use crate::solver::{SolverBody, SolverJoint};
use sinew_math::Vec3;
use sinew_math::lanes::{Lanes, Vector3, WIDTH};

/// Elimination of a link's joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// No joint: the first link of its tree.
    Root,
    /// A ball joint without springs or friction.
    Point,
    /// A ball joint whose rotation is resisted by springs or friction.
    DrivenPoint,
    /// A point with `held` locked rotations; the open rotations, with or without resistance, are eliminated one after the other.
    Axes { held: usize },
}

/// Position of a link in its tree, and its elimination.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Site {
    /// Index of the parent link.
    pub parent: u32,
    pub kind: Kind,
}

/// A body of each of eight trees, and the joint to its parent.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
pub(super) struct Node {
    pub site: Site,
    /// Effective mass for impulses, kg.
    pub mass: Eight,
    /// Effective moments about the principal axes, kg·m², and the rotation of these axes.
    pub moments: [Eight; 3],
    pub rotation: [Eight; 4],
    /// Inertia in world axes, kg·m²: xx, xy, xz, yy, yz, zz.
    pub tensor: [Eight; 6],
    /// World arms from the centres of mass of child and parent to the anchor.
    pub arm: [Eight; 3],
    pub parent_arm: [Eight; 3],
    /// 1 if the body is the joint's second one, −1 if it is the first.
    pub sign: Eight,
    /// Gains of the springs and friction that resist a ball joint's rotation.
    pub gain: [Eight; 6],
    /// (B + G)⁻¹, and rows of C (B + G)⁻¹, see [`Swivel`](crate::solver::articulation::elimination::Swivel).
    pub pivot: [Eight; 6],
    pub coupled: [[Eight; 3]; 3],
    /// Articulated inertia about the anchor that the parent gets. For a root, `passed_mass` is the inverse of the remaining mass.
    pub passed_mass: [Eight; 6],
    pub passed_coupling: [[Eight; 3]; 3],
    pub passed_rotation: [Eight; 6],
    pub axes: [Axis; 3],
}

/// A rotation axis, locked or open.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    /// Rotation of the child for one unit of the row.
    pub way: [Eight; 3],
    pub gain: Eight,
    /// Momentum and inverse pivot of an open axis, see [`Sequence`](crate::solver::articulation::elimination::Sequence).
    pub force: [Eight; 3],
    pub torque: [Eight; 3],
    pub inverse: Eight,
}

const ZERO3: [Eight; 3] = [ZERO; 3];

impl Axis {
    const EMPTY: Self = Self { way: ZERO3, gain: ZERO, force: ZERO3, torque: ZERO3, inverse: ZERO };
}

impl Node {
    pub const EMPTY: Self = Self {
        site: Site { parent: NONE, kind: Kind::Root },
        mass: [1.0; WIDTH],
        moments: [[1.0; WIDTH]; 3],
        rotation: [ZERO, ZERO, ZERO, [1.0; WIDTH]],
        tensor: [ZERO; 6],
        arm: ZERO3,
        parent_arm: ZERO3,
        sign: [1.0; WIDTH],
        gain: [ZERO; 6],
        pivot: [ZERO; 6],
        coupled: [ZERO3; 3],
        passed_mass: [ZERO; 6],
        passed_coupling: [ZERO3; 3],
        passed_rotation: [ZERO; 6],
        axes: [Axis::EMPTY; 3],
    };

    /// Writes a body into a lane.
    pub fn write_body(&mut self, lane: usize, body: &SolverBody) {
        self.mass[lane] = body.mass * body.mass_scale;
        put((body.inertia + body.excess) * body.mass_scale, &mut self.moments, lane);
        let r = body.pose.rotation;
        for (row, number) in self.rotation.iter_mut().zip([r.x, r.y, r.z, r.w]) {
            row[lane] = number;
        }
    }

    /// Writes the joint to the parent into a lane.
    pub fn write_joint(&mut self, lane: usize, joint: &SolverJoint, is_b: bool) {
        let ([arm, parent_arm], sign) = arms(&joint.rows, is_b);
        put(arm, &mut self.arm, lane);
        put(parent_arm, &mut self.parent_arm, lane);
        self.sign[lane] = sign;
        let rows = &joint.rows;
        match self.site.kind {
            Kind::Root | Kind::Point => {}
            Kind::DrivenPoint => {
                self.gain.iter_mut().for_each(|row| row[lane] = 0.0);
                for row in rows.locked..rows.count {
                    let (v, gain) = (rows.axis[row], joint.gain(row));
                    let u = v * gain;
                    for (row, outer) in self.gain.iter_mut().zip([
                        u.x * v.x,
                        u.x * v.y,
                        u.x * v.z,
                        u.y * v.y,
                        u.y * v.z,
                        u.z * v.z,
                    ]) {
                        row[lane] += outer;
                    }
                }
            }
            Kind::Axes { held } => self.write_axes(lane, joint, held),
        }
    }

    /// Writes the axes of the locked rotations in the order of their rows, then those of the free rotations.
    fn write_axes(&mut self, lane: usize, joint: &SolverJoint, held: usize) {
        let rows = &joint.rows;
        let Ways { way, row, count } = Ways::new(rows, true);
        // An axis that is nearly dependent on the others has no direction. Joints with such an axis do not correct their rows here.
        let is_whole = count >= held && (0..held).all(|k| usize::from(row[k]) == TWIST + k);
        for (k, axis) in self.axes.iter_mut().enumerate() {
            let is_asked = k >= held || is_whole;
            put(if is_asked { way[k] } else { Vec3::ZERO }, &mut axis.way, lane);
            axis.gain[lane] = if k >= held && k < count { joint.gain(usize::from(row[k])) } else { 0.0 };
        }
    }

    /// Copies the first tree into the lanes from `lanes` on, so that no unused lane takes longer than a used one.
    pub fn fill(&mut self, lanes: usize) {
        if lanes == WIDTH {
            return;
        }
        let fill = |row: &mut Eight| {
            for lane in lanes..WIDTH {
                row[lane] = row[0];
            }
        };
        let Self { mass, moments, rotation, arm, parent_arm, sign, gain, axes, .. } = self;
        [mass, sign].into_iter().for_each(fill);
        moments.iter_mut().chain(rotation).chain(arm).chain(parent_arm).chain(gain).for_each(fill);
        for axis in axes {
            axis.way.iter_mut().chain([&mut axis.gain]).for_each(fill);
        }
    }
}

/// Access to the numbers of a node in lanes: those of eight trees, or those of one tree in all lanes.
pub(super) trait View<L: Lanes>: Copy {
    fn number(self, of: &Eight) -> L;

    #[inline(always)]
    fn vector(self, of: &[Eight; 3]) -> Vector3<L> {
        Vector3::new(self.number(&of[0]), self.number(&of[1]), self.number(&of[2]))
    }
}

/// Eight trees, one in each lane.
#[derive(Clone, Copy)]
pub(super) struct Side;

impl<L: Lanes> View<L> for Side {
    #[inline(always)]
    fn number(self, of: &Eight) -> L {
        L::load(of)
    }
}

/// The tree of one lane, repeated in all lanes.
#[derive(Clone, Copy)]
pub(super) struct One(pub usize);

impl<L: Lanes> View<L> for One {
    #[inline(always)]
    fn number(self, of: &Eight) -> L {
        L::splat(of[self.0 & (WIDTH - 1)])
    }
}
