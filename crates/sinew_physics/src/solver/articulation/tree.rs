//! Joint trees: the joints of a tree are solved exactly, in linear time, from the leaves to the root and back.
//!
//! Each joint's open directions are eliminated from the articulated inertia of its child, see
//! [`elimination`](crate::solver::articulation::elimination). A tree has no fill-in. The result solves `M dv = impulses + Jᵀ λ`, `J dv + Γ
//! λ = residuals`, with Γ zero for rigid rows and `1/gain` for springs, motors and dry friction.

use crate::joint::{DIRECTIONS, JointRows, TWIST};
use crate::solver::articulation::elimination::{
    Elimination, Freedom, Inertia, Sequence, Swivel, Twist, wide,
};
use crate::solver::joint::SolverJoint;
use crate::solver::tuning::{LEAST_AXIS_SHARE, LEAST_AXIS_SQUARE};
use crate::spatial::{Mat6, UNITS, Vec6, ZERO6, ZERO66, join};
use core::ops::Range;
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::{Lanes, Real, Vector3};
use sinew_math::{Vec3, any_orthonormal};

/// Index that stands for no parent, no joint or no slot.
pub(crate) const NONE: u32 = u32::MAX;

/// Vector of six ones, with zeros in the two unused lanes.
const SIX: Vec6 = [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0];

/// A moving body as a node of its tree. Nodes of a tree are contiguous, parents before children.
#[derive(Clone, Debug)]
pub(crate) struct Link {
    /// Local index of the parent body: a moving body with a smaller index, or a fixed body if this root is grounded.
    pub parent: u32,
    /// Local index of the joint to the parent.
    pub joint: u32,
    /// Index of the link's tree.
    pub tree: u32,
    /// Number of rows that request a velocity, and their indices.
    asking: usize,
    row: [u8; DIRECTIONS],
    /// Velocity of this body for a unit residual of each requesting row with the parent at rest, and the impulse on the parent.
    follow: [Vec6; DIRECTIONS],
    pass: [Vec6; DIRECTIONS],
    /// Bit set of the rows whose gains push both bodies.
    pushing: u8,
    /// Velocity of this body for velocities of its parent when nothing acts below the joint: rows, and columns.
    carry: Mat6,
    carry_columns: Mat6,
    /// Response to an impulse on this body with its parent at rest.
    own: Mat6,
}

impl Link {
    pub fn new(parent: u32, joint: u32, tree: u32) -> Self {
        Self {
            parent,
            joint,
            tree,
            asking: 0,
            row: [0; DIRECTIONS],
            follow: [ZERO6; DIRECTIONS],
            pass: [ZERO6; DIRECTIONS],
            pushing: 0,
            carry: ZERO66,
            carry_columns: ZERO66,
            own: ZERO66,
        }
    }

    /// Velocity of this body for a velocity of its parent when nothing acts below the joint.
    #[inline(always)]
    pub fn carried<L: Lanes>(&self, parent: &Vec6) -> L {
        sum(&self.carry_columns, parent)
    }

    /// Impulse on the parent caused by an impulse on this body.
    #[inline(always)]
    pub fn passed_up<L: Lanes>(&self, impulse: &Vec6) -> L {
        sum(&self.carry, impulse)
    }

    /// Response to an impulse on this body with its parent at rest.
    #[inline(always)]
    pub fn alone<L: Lanes>(&self, impulse: &Vec6) -> L {
        sum(&self.own, impulse)
    }

    /// Computes [`carried`](Self::carried) for eight velocities of the parent, one in each lane.
    #[inline(always)]
    pub fn carried_all<L: Lanes>(&self, parent: &Mat6) -> [L; 6] {
        sums(&self.carry_columns, parent)
    }

    /// Computes [`passed_up`](Self::passed_up) for eight impulses.
    #[inline(always)]
    pub fn passed_up_all<L: Lanes>(&self, impulses: &Mat6) -> [L; 6] {
        sums(&self.carry, impulses)
    }

    /// Computes [`alone`](Self::alone) for eight impulses.
    #[inline(always)]
    pub fn alone_all<L: Lanes>(&self, impulses: &Mat6) -> [L; 6] {
        sums(&self.own, impulses)
    }

    /// Adds the impulses of the residuals of rows with gains that request no velocity.
    pub fn push_gains(&self, joint: &SolverJoint, residuals: &Vec6, impulses: &mut [Vec6]) {
        if self.pushing == 0 {
            return;
        }
        let mut of_rows = ZERO6;
        for row in (joint.rigid..joint.rows.count).filter(|&row| self.pushing & 1 << row != 0) {
            of_rows[row] = residuals[row] * joint.gain(row);
        }
        joint.push(&of_rows, impulses, 1.0);
    }

    /// Marks all rows that are not rigid as pushing, so that none requests a velocity.
    pub fn push_all_gains(&mut self, joints: &[SolverJoint]) {
        self.pushing = joints
            .get(self.joint as usize)
            .map_or(0, |joint| (joint.rigid..joint.rows.count).fold(0, |bits, row| bits | 1 << row));
    }

    /// Eliminates the joint's open directions. Returns the articulated inertia that the parent gets.
    #[inline(always)]
    fn factor<L: Lanes>(
        &mut self,
        joint: Option<&SolverJoint>,
        is_b: bool,
        inertia: &Inertia<f64>,
    ) -> Inertia<f64> {
        (self.asking, self.pushing) = (0, 0);
        let Some(joint) = joint else {
            let mut free = Swivel::new(Freedom::All, [wide(Vec3::ZERO); 2], inertia);
            free.factor();
            self.condense::<L>(&free);
            return Inertia::zero();
        };
        if joint.is_point() {
            let mut swivel = self.swivel(joint, is_b, inertia);
            let through = swivel.factor();
            self.condense::<L>(&swivel);
            self.answer_point(&through, is_b);
            self.answer_rows(TWIST, &swivel, &through, swivel.parent_arm());
            return through;
        }
        let mut sequence = self.sequence(joint, is_b, inertia);
        let through = sequence.factor();
        self.condense::<L>(&sequence);
        let holds_point = joint.rigid >= TWIST && joint.rows.locks_point();
        if holds_point {
            self.answer_point(&through, is_b);
        }
        let answered = if holds_point { TWIST } else { 0 };
        self.answer_rows(answered, &sequence, &through, sequence.parent_arm());
        // If all directions are open, the rest is rounding error.
        if joint.rows.count == 0 { Inertia::zero() } else { through }
    }

    /// Applies the elimination to unit velocities and impulses, one in each lane, in double precision: in single precision, the rounding
    /// error of light bodies between heavy ones would exceed their mass.
    #[inline(always)]
    fn condense<L: Lanes>(&mut self, by: &impl Elimination<f64>) {
        let [x, y, z, u, v, w] = &UNITS;
        let units =
            [widen::<L>(x), widen::<L>(y), widen::<L>(z), widen::<L>(u), widen::<L>(v), widen::<L>(w)];
        let mut kept = [L::Wide::splat(0.0); 6];
        if self.joint != NONE {
            let [x, y, z, u, v, w] = narrow_lanes::<L>(by.descend(twist(units), &kept));
            store([x, y, z, u, v, w], &mut self.carry);
            let none = L::splat(0.0);
            let [x, y, z, u, v, w, ..] = L::transpose([x, y, z, u, v, w, none, none]);
            store([x, y, z, u, v, w], &mut self.carry_columns);
        }
        // By symmetry, the impulses on the parent are the columns of the carried velocities.
        by.ascend(twist(units), &mut kept);
        store(narrow_lanes::<L>(by.descend_alone(&kept)), &mut self.own);
    }

    /// Sets the rows that lock a point: they request the anchor velocities caused by unit velocities of the parent.
    #[inline(always)]
    fn answer_point(&mut self, through: &Inertia<f64>, is_b: bool) {
        let sign = if is_b { 1.0 } else { -1.0 };
        for (k, (force, torque)) in through.mass.rows().into_iter().zip(through.coupling).enumerate() {
            self.follow[k] = self.carry_columns[k].map(|x| x * sign);
            self.pass[k] = narrow([force, torque]).map(|x| -sign * x);
        }
    }

    /// Computes the child's velocity and the impulse on the parent for the anchor velocities that the rows from `first` on request. Both
    /// are computed in double precision, because they nearly cancel for a heavy child.
    #[inline(always)]
    fn answer_rows<E: Elimination<f64>>(
        &mut self,
        first: usize,
        by: &E,
        through: &Inertia<f64>,
        parent_arm: Vector3<f64>,
    ) {
        for (follow, pass) in self.follow.iter_mut().zip(&mut self.pass).take(self.asking).skip(first) {
            let [x, y, z, u, v, w, ..] = follow.map(f64::from);
            let [v, w] = twist([x, y, z, u, v, w]);
            *follow = narrow(by.follow([v, w], &[0.0; 6]));
            // Impulse that resists the parent motion corresponding to the requested velocity of the anchor.
            let [force, torque] = through.times([v - w.cross(parent_arm), w]);
            *pass = narrow([-force, -torque]);
        }
    }

    /// Eliminates a ball joint.
    #[inline(always)]
    fn swivel(&mut self, joint: &SolverJoint, is_b: bool, inertia: &Inertia<f64>) -> Swivel<f64> {
        let rows = &joint.rows;
        let (arms, sign) = arms(rows, is_b);
        let driven = rows.count > rows.locked;
        let freedom = if driven { Freedom::DrivenRotation } else { Freedom::Rotation };
        let mut swivel = Swivel::new(freedom, arms.map(wide), inertia);
        for (row, axis) in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate() {
            self.ask(row, join(axis * sign, Vec3::ZERO));
        }
        for row in rows.locked..rows.count {
            let (axis, gain) = (rows.axis[row], f64::from(joint.gain(row)));
            swivel.gain.add_outer(wide(axis), gain);
            if gain > swivel.weight(true, wide(axis)) {
                self.ask(row, join(Vec3::ZERO, axis * sign));
            } else {
                self.pushing |= 1 << row;
            }
        }
        swivel
    }

    /// Eliminates any other joint.
    #[inline(always)]
    fn sequence(&mut self, joint: &SolverJoint, is_b: bool, inertia: &Inertia<f64>) -> Sequence<f64> {
        let rows = &joint.rows;
        let (arms, sign) = arms(rows, is_b);
        let mut sequence = Sequence::new(arms.map(wide), inertia);
        for turns in [false, true] {
            let Ways { way, row, count } = Ways::new(rows, turns);
            for (k, way) in way.into_iter().enumerate() {
                let row = usize::from(row[k]);
                let gain = if k >= count { 0.0 } else { f64::from(joint.gain(row)) };
                if k < count {
                    // Rows with gains above the inertia request a velocity, those below push: otherwise rounding errors would dominate
                    // either.
                    if row < joint.rigid || gain > sequence.weight(turns, wide(way)) {
                        let way = way * sign;
                        self.ask(row, if turns { join(Vec3::ZERO, way) } else { join(way, Vec3::ZERO) });
                    } else {
                        self.pushing |= 1 << row;
                    }
                    if row < joint.rigid {
                        continue;
                    }
                }
                sequence.push(turns, wide(way), gain);
            }
        }
        sequence
    }

    /// Adds a row that requests a motion of this body at the anchor, for [`answer_rows`](Self::answer_rows).
    #[inline(always)]
    fn ask(&mut self, row: usize, way: Vec6) {
        (self.row[self.asking], self.follow[self.asking]) = (row as u8, way);
        self.asking += 1;
    }
}

/// Arms of the child and its parent, and the sign with which rows act on the child.
#[inline(always)]
pub(in crate::solver) fn arms(rows: &JointRows, is_b: bool) -> ([Vec3; 2], f32) {
    if is_b { ([rows.arm_b, rows.arm_a], 1.0) } else { ([rows.arm_a, rows.arm_b], -1.0) }
}

#[inline(always)]
fn twist<R: Real>([x, y, z, u, v, w]: [R; 6]) -> Twist<R> {
    [Vector3::new(x, y, z), Vector3::new(u, v, w)]
}

#[inline(always)]
fn flat<R: Real>([v, w]: Twist<R>) -> [R; 6] {
    [v.x, v.y, v.z, w.x, w.y, w.z]
}

/// Rounds to single precision.
#[inline(always)]
fn narrow(twist: Twist<f64>) -> Vec6 {
    let [x, y, z, u, v, w] = flat(twist);
    [x, y, z, u, v, w, 0.0, 0.0].map(|x| x as f32)
}

#[inline(always)]
fn widen<L: Lanes>(from: &Vec6) -> L::Wide {
    L::load(from).widen()
}

/// Rounds to single precision, with zeros in the unused lanes of the register.
#[inline(always)]
fn narrow_lanes<L: Lanes>(twist: Twist<L::Wide>) -> [L; 6] {
    let six = L::gt(L::load(&SIX), L::splat(0.0));
    let [x, y, z, u, v, w] = flat(twist);
    [
        L::narrow(x).masked(six),
        L::narrow(y).masked(six),
        L::narrow(z).masked(six),
        L::narrow(u).masked(six),
        L::narrow(v).masked(six),
        L::narrow(w).masked(six),
    ]
}

#[inline(always)]
fn store<L: Lanes>(rows: [L; 6], to: &mut Mat6) {
    for (row, to) in rows.into_iter().zip(to) {
        row.store(to);
    }
}

/// Directions in which a joint's child translates or rotates. Each of the first `count` changes its own row by one unit and no other row;
/// the rest change none. A row that is nearly dependent on the others has no direction.
pub(in crate::solver) struct Ways {
    pub way: [Vec3; 3],
    pub row: [u8; 3],
    pub count: usize,
}

impl Ways {
    #[inline(always)]
    pub fn new(rows: &JointRows, turns: bool) -> Self {
        if !turns && rows.locks_point() {
            return Self { way: [Vec3::X, Vec3::Y, Vec3::Z], row: [0, 1, 2], count: 3 };
        }
        let mut ways = Self { way: [Vec3::ZERO; 3], row: [0; 3], count: 0 };
        let mut axes = [Vec3::ZERO; 3];
        for row in (0..rows.count).filter(|&row| rows.turns(row) == turns) {
            let axis = rows.axis[row];
            if is_apart(axis, &axes[..ways.count]) {
                (ways.row[ways.count], axes[ways.count]) = (row as u8, axis);
                ways.count += 1;
            }
        }
        let [x, y, z] = axes;
        ways.way = match ways.count {
            0 => [Vec3::X, Vec3::Y, Vec3::Z],
            1 => {
                let across = any_orthonormal(x / x.length());
                [x / x.length_squared(), across, x.cross(across)]
            }
            2 => {
                let across = x.cross(y);
                let scale = 1.0 / across.length_squared();
                [y.cross(across) * scale, across.cross(x) * scale, across]
            }
            _ => {
                let across = y.cross(z);
                let scale = 1.0 / across.dot(x);
                [across * scale, z.cross(x) * scale, x.cross(y) * scale]
            }
        };
        ways
    }
}

/// Returns true if an axis is sufficiently independent of the others.
#[inline(always)]
fn is_apart(axis: Vec3, others: &[Vec3]) -> bool {
    let square = axis.length_squared();
    // The share of the last edge of a triangle or box that is perpendicular to the others.
    let (left, of) = match *others {
        [] => return square > LEAST_AXIS_SQUARE,
        [x] => (x.cross(axis).length_squared(), x.length_squared()),
        [x, y, ..] => {
            let across = x.cross(y);
            let off = across.dot(axis);
            (off * off, across.length_squared())
        }
    };
    square > LEAST_AXIS_SQUARE && left > LEAST_AXIS_SHARE * of * square
}

/// Factors the trees of some links: `inertia` holds the bodies' own inertias and is overwritten by the articulated ones.
#[inline(never)]
pub(crate) fn factor(
    links: &mut [Link],
    range: Range<usize>,
    joints: &[SolverJoint],
    inertia: &mut [Inertia<f64>],
) {
    dispatch::run(Factor { links, range, joints, inertia });
}

/// Kernel of [`factor`]: plain arithmetic, which the compiler vectorises for the instruction set of its caller.
struct Factor<'a> {
    links: &'a mut [Link],
    range: Range<usize>,
    joints: &'a [SolverJoint],
    inertia: &'a mut [Inertia<f64>],
}

impl Kernel for Factor<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { links, range, joints, inertia } = self;
        for i in range.rev() {
            let joint = joints.get(links[i].joint as usize);
            let is_b = joint.is_some_and(|joint| joint.b as usize == i);
            let through = links[i].factor::<L>(joint, is_b, &inertia[i]);
            if let Some(parent) = inertia.get_mut(links[i].parent as usize) {
                parent.add(&through);
            }
        }
    }
}

/// Computes the velocity change of every body of the trees in `range`, from impulses on the bodies and residuals of the joint rows, except
/// for [those that push](Link::push_gains). An empty list of residuals means zero residuals. `impulses` are overwritten.
#[inline(never)]
pub(crate) fn solve(
    links: &[Link],
    range: Range<usize>,
    impulses: &mut [Vec6],
    residuals: &[Vec6],
    dv: &mut [Vec6],
) {
    dispatch::run(Solve { links, range, impulses, residuals, dv });
}

/// Kernel of [`solve`]: plain arithmetic, as in [`Factor`].
struct Solve<'a> {
    links: &'a [Link],
    range: Range<usize>,
    impulses: &'a mut [Vec6],
    residuals: &'a [Vec6],
    dv: &'a mut [Vec6],
}

impl Kernel for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { links, range, impulses, residuals, dv } = self;
        solve_in::<L>(links, range, impulses, residuals, dv);
    }
}

/// Computes [`solve`] within a kernel.
#[inline(always)]
pub(in crate::solver) fn solve_in<L: Lanes>(
    links: &[Link],
    range: Range<usize>,
    impulses: &mut [Vec6],
    residuals: &[Vec6],
    dv: &mut [Vec6],
) {
    let (impulses, dv) = (&mut impulses[..links.len()], &mut dv[..links.len()]);
    // Leaf to root: the impulse that the subtree below each joint applies to the parent.
    for i in range.clone().rev() {
        let link = &links[i];
        let (mut own, mut through) = (L::splat(0.0), link.passed_up::<L>(&impulses[i]));
        if let Some(residuals) = residuals.get(i) {
            for ((follow, pass), row) in link.follow.iter().zip(&link.pass).zip(link.row).take(link.asking) {
                let residual = L::splat(residuals[usize::from(row) & 7]);
                own = own + L::load(follow) * residual;
                through = through + L::load(pass) * residual;
            }
        }
        own.store(&mut dv[i]);
        let parent = link.parent as usize;
        if parent < i {
            (L::load(&impulses[parent]) + through).store(&mut impulses[parent]);
        }
    }
    // Root to leaf: the velocities.
    for i in range {
        let link = &links[i];
        let mut v = L::load(&dv[i]) + link.alone::<L>(&impulses[i]);
        let parent = link.parent as usize;
        if parent < i {
            v = v + link.carried::<L>(&dv[parent]);
        }
        v.store(&mut dv[i]);
    }
}

/// Sum of six rows, each times its factor.
#[inline(always)]
pub(crate) fn sum<L: Lanes>(rows: &Mat6, by: &Vec6) -> L {
    let [r0, r1, r2, r3, r4, r5] = rows;
    (L::load(r0) * L::splat(by[0]) + L::load(r1) * L::splat(by[1]))
        + (L::load(r2) * L::splat(by[2]) + L::load(r3) * L::splat(by[3]))
        + (L::load(r4) * L::splat(by[4]) + L::load(r5) * L::splat(by[5]))
}

/// Computes eight times [`sum`], with the factors in lanes: each number of the rows is broadcast to all lanes.
#[inline(always)]
fn sums<L: Lanes>(rows: &Mat6, by: &Mat6) -> [L; 6] {
    let [x, y, z, u, v, w] = by;
    let by: [L; 6] = [L::load(x), L::load(y), L::load(z), L::load(u), L::load(v), L::load(w)];
    let mut out = [L::splat(0.0); 6];
    for (k, out) in out.iter_mut().enumerate() {
        *out = (L::splat(rows[0][k]) * by[0] + L::splat(rows[1][k]) * by[1])
            + (L::splat(rows[2][k]) * by[2] + L::splat(rows[3][k]) * by[3])
            + (L::splat(rows[4][k]) * by[4] + L::splat(rows[5][k]) * by[5]);
    }
    out
}
