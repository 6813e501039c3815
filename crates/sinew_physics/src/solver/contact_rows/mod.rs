//! Contact rows of one manifold: up to four normal rows solved as a block, friction at the centre, twist, rolling.

mod bounce;
mod disk;
pub(crate) mod lcp;
mod placed;
mod refresh;
mod row;
mod visit;

use super::articulation::batches::Batches;
use super::articulation::response::Response;
use super::articulation::response_cache::{CachedColumns, ResponseCache};
use super::articulation::tree::Link;
use crate::body::material::ContactMaterial;
use crate::collide::{MAX_POINTS, Manifold};
use crate::contact::ContactMemory;
use crate::solver::body::{SolverBody, add_row, free_response};
use crate::solver::sweep::policy::Firmness;
use crate::solver::tuning::{
    DEEP_SLOPS, IMPACT_JUMP, LASTING, REDUNDANCY, REFRESH_TURN_RESPONSE, REFRESH_TURN_RIM, RELAX_TURN,
};
use crate::spatial::{Vec6, ZERO6, add_scaled, angular};
use bounce::Approach;
pub(crate) use placed::PlacedShape;
pub(super) use placed::{Placed, found_anew, margin};
pub(super) use row::{NEVER, Softness, contact_softness, weights};
use row::{Pair, Row};
use sinew_math::{Mat3, Transform, Vec3, any_orthonormal, max};

/// Impulses of a manifold's rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactImpulses {
    normal: [f32; MAX_POINTS],
    friction: Vec3,
    twist: f32,
    rolling: Vec3,
}

impl ContactImpulses {
    /// Returns the sum of these impulses and `share` times `other`.
    pub fn plus(&self, other: &Self, share: f32) -> Self {
        Self {
            normal: core::array::from_fn(|i| self.normal[i] + other.normal[i] * share),
            friction: self.friction + other.friction * share,
            twist: self.twist + other.twist * share,
            rolling: self.rolling + other.rolling * share,
        }
    }
}

/// Largest number of rows of a manifold: normals, tangents, twist, rolling.
const MOST_ROWS: usize = MAX_POINTS + 2 + 1 + 3;

/// World axes about which torques resist rolling.
const AXES: [Vec3; 3] = [Vec3::X, Vec3::Y, Vec3::Z];

/// Impulses on body A and on body B.
pub(super) type Push = (Vec6, Vec6);

#[derive(Clone, Debug)]
pub(crate) struct ManifoldRows {
    /// Index in the world's contact array.
    pub contact: u32,
    /// Local indices of the bodies.
    pub a: u32,
    pub b: u32,
    /// Manifold of the step's beginning, or a newer one if a body turned fast.
    pub manifold: Manifold,
    /// True if the manifold was recomputed within the step.
    is_new: bool,
    through_particles: bool,
    shapes: [PlacedShape; 2],
    /// Radii of the shapes' roundings around their cores at the contact.
    rounds: [f32; 2],
    /// Turn within a substep above which the contact is recomputed, radians.
    most_turn: f32,
    normal: Vec3,
    count: usize,
    /// Cores of the surfaces at each point, in the principal frames, and their distances from the surfaces. The contact point of a ball
    /// does not rotate with the ball; that of a box's corner rotates with the box.
    core_a: [Vec3; MAX_POINTS],
    core_b: [Vec3; MAX_POINTS],
    a_moves: bool,
    b_moves: bool,
    material: ContactMaterial,
    slop: f32,
    soft: Softness,
    /// Firmness of the contact: factors on `soft` and on its bias rate, and the largest push-out speed.
    firmness: Firmness,
    /// Separations of the points at the present pose, metres. The rows are of the same pose.
    separation: [f32; MAX_POINTS],
    rows: [Row; MAX_POINTS],
    tangents: [Row; 2],
    tangent_axes: [Vec3; 2],
    spin: Row,
    /// Share of the load at each point at the start of the step: friction acts at the centre of pressure.
    weight: [f32; MAX_POINTS],
    /// Weighted distance of the points from the centre of friction, metres: lever arm of the twist friction.
    lever: f32,
    /// Columns of the rows: of the points, the tangents, the twist, and of torques about each axis if the contact resists rolling. `None`
    /// while the manifold is idle at this pose.
    pub columns: Option<CachedColumns>,
    /// Responses of the point rows to each other, computed with the columns.
    k: [[f32; MAX_POINTS]; MAX_POINTS],
    k_tangent: [[f32; 2]; 2],
    k_spin: f32,
    /// Response of the twist to each tangent.
    k_spin_tangent: [f32; 2],
    k_roll: Mat3,
    /// Approach of each point in this substep.
    approach: [Approach; MAX_POINTS],
    /// Normal speed at which each point leaves after a hit in this substep, m/s; 0 if it does not bounce.
    rebound: [f32; MAX_POINTS],
    /// Normal impulses of this substep, N·s.
    impulse: [f32; MAX_POINTS],
    /// Sum of the normal impulses that limit friction.
    load: f32,
    /// Lower bound of each point's impulse in `relax`, N·s.
    floor: [f32; MAX_POINTS],
    friction: Vec3,
    twist: f32,
    rolling: Vec3,
    pub memory: ContactMemory,
}

/// Input for a manifold's rows.
pub(crate) struct ManifoldSource<'a> {
    pub contact: u32,
    /// True if particles between the shapes carry the points: the manifold is not recomputed.
    pub through_particles: bool,
    pub a: u32,
    pub b: u32,
    pub a_moves: bool,
    pub b_moves: bool,
    pub manifold: &'a Manifold,
    pub memory: ContactMemory,
    pub material: ContactMaterial,
    pub slop: f32,
    pub shapes: [PlacedShape; 2],
    pub h: f32,
}

impl ManifoldRows {
    pub fn new(source: &ManifoldSource<'_>, bodies: &[SolverBody]) -> Self {
        let n = source.manifold.normal;
        let mut rows = Self {
            contact: source.contact,
            a: source.a,
            b: source.b,
            manifold: *source.manifold,
            is_new: false,
            through_particles: source.through_particles,
            shapes: source.shapes.clone(),
            rounds: [0.0; 2],
            most_turn: REFRESH_TURN_RESPONSE,
            normal: n,
            count: source.manifold.count,
            core_a: [Vec3::ZERO; MAX_POINTS],
            core_b: [Vec3::ZERO; MAX_POINTS],
            a_moves: source.a_moves,
            b_moves: source.b_moves,
            material: source.material,
            slop: source.slop,
            soft: contact_softness(source.a_moves && source.b_moves, source.h),
            firmness: Firmness::default(),
            separation: [0.0; MAX_POINTS],
            rows: [Row::ZERO; MAX_POINTS],
            tangents: [Row::ZERO; 2],
            tangent_axes: [Vec3::ZERO; 2],
            spin: Row::about(n),
            weight: [0.0; MAX_POINTS],
            lever: 0.0,
            columns: None,
            k: [[0.0; MAX_POINTS]; MAX_POINTS],
            k_tangent: [[0.0; 2]; 2],
            k_spin: 0.0,
            k_spin_tangent: [0.0; 2],
            k_roll: Mat3::ZERO,
            approach: [Approach::default(); MAX_POINTS],
            rebound: [0.0; MAX_POINTS],
            impulse: [0.0; MAX_POINTS],
            load: 0.0,
            floor: [0.0; MAX_POINTS],
            friction: source.memory.friction,
            twist: source.memory.twist,
            rolling: source.memory.rolling,
            memory: source.memory.of_new_step(),
        };
        let poses = rows.poses(bodies);
        rows.take_manifold(poses);
        rows.place(poses);
        rows
    }

    /// Manifold of the contact, if it was recomputed within the step.
    pub fn found(&self) -> Option<Manifold> {
        self.is_new.then_some(self.manifold)
    }

    /// Sets the firmness.
    pub fn set_firmness(&mut self, firmness: Firmness) {
        self.firmness = firmness;
    }

    /// Poses of the manifold's two bodies in the world.
    pub fn poses(&self, bodies: &[SolverBody]) -> [Transform; 2] {
        [self.a, self.b].map(|body| bodies[body as usize].pose)
    }

    /// Computes the cores of the points of the manifold, which was computed at these poses.
    fn take_manifold(&mut self, [pose_a, pose_b]: [Transform; 2]) {
        self.normal = self.manifold.normal;
        self.count = self.manifold.count;
        self.spin = Row::about(self.normal);
        let n = self.normal;
        let [a, b] = &self.shapes;
        let [in_a, in_b] = [pose_a, pose_b].map(|pose| pose.rotation.inverse() * n);
        let [a, b] = [a.placed(), b.placed()];
        let [round_a, round_b] =
            if self.through_particles { [0.0; 2] } else { [a.round(in_a), b.round(in_b)] };
        self.rounds = [round_a, round_b];
        // For a rim, only the point on which it rolls bears load.
        let (most_turn, bearing) = match a.has_rim(in_a) || b.has_rim(in_b) {
            _ if self.through_particles => (f32::INFINITY, f32::INFINITY),
            true => (REFRESH_TURN_RIM, self.slop),
            false => (REFRESH_TURN_RESPONSE, f32::INFINITY),
        };
        self.most_turn = most_turn;
        self.weight = weights(&self.memory, &self.manifold, bearing);
        for (i, point) in self.manifold.points().iter().enumerate() {
            let half = n * (0.5 * point.separation);
            self.core_a[i] = pose_a.inverse_point(point.position - half - n * round_a);
            self.core_b[i] = pose_b.inverse_point(point.position + half + n * round_b);
        }
    }

    /// Unit normal out of the fixed body; `None` between two moving ones, whose local indices are below `moving`.
    pub fn outward(&self, moving: usize) -> Option<Vec3> {
        match [self.a, self.b].map(|body| (body as usize) < moving) {
            [true, true] => None,
            [_, true] => Some(self.normal),
            _ => Some(-self.normal),
        }
    }

    fn pair(&self) -> Pair {
        Pair { a: self.a, b: self.b }
    }

    /// Computes separations and Jacobians at these poses.
    pub fn place(&mut self, [pose_a, pose_b]: [Transform; 2]) {
        let n = self.normal;
        let mut points = [Vec3::ZERO; MAX_POINTS];
        let mut center = Vec3::ZERO;
        for i in 0..self.count {
            let on_a = pose_a.point(self.core_a[i]) + n * self.rounds[0];
            let on_b = pose_b.point(self.core_b[i]) - n * self.rounds[1];
            self.separation[i] = (on_b - on_a).dot(n);
            points[i] = match self.rounds.map(|round| round > 0.0).into() {
                // The contact point moves with a ball, also on a table that moves away under it.
                (true, false) => on_a,
                (false, true) => on_b,
                _ if !self.b_moves => on_a,
                _ if !self.a_moves => on_b,
                _ => (on_a + on_b) * 0.5,
            };
            center += points[i] * self.weight[i];
        }
        self.lever = 0.0;
        for i in 0..self.count {
            self.rows[i] = Row::at(n, points[i] - pose_a.translation, points[i] - pose_b.translation);
            self.lever += (points[i] - center).length() * self.weight[i];
        }
        let t1 = any_orthonormal(n);
        self.tangent_axes = [t1, n.cross(t1)];
        let (arm_a, arm_b) = (center - pose_a.translation, center - pose_b.translation);
        self.tangents = self.tangent_axes.map(|axis| Row::at(axis, arm_a, arm_b));
    }

    /// Computes the columns of the rows and their responses to each other. Returns the position of the columns.
    pub(in crate::solver) fn respond(
        &mut self,
        bodies: &[SolverBody],
        (links, batches): (&[Link], &mut Batches),
        response: &Response,
        columns: &mut ResponseCache,
    ) -> CachedColumns {
        let pair = self.pair();
        let least =
            |row: &Row| REDUNDANCY * free_response(bodies, links.len(), [(pair.a, &row.a), (pair.b, &row.b)]);
        let mut rows = [Row::ZERO; MOST_ROWS];
        rows[..self.count].copy_from_slice(&self.rows[..self.count]);
        let (tangents, spin, roll) = (self.count, self.count + 2, self.count + 3);
        rows[tangents..spin].copy_from_slice(&self.tangents);
        rows[spin] = self.spin;
        rows[roll..roll + 3].copy_from_slice(&AXES.map(Row::about));
        let count = if self.material.rolling > 0.0 { roll + 3 } else { roll };
        let bodies = [pair.a, pair.b];
        let strip = columns.add(response, (links, batches), bodies, rows[..count].iter().map(Row::ends));
        self.columns = Some(strip);
        let places = ResponseCache::places(response, links, bodies);
        let answer = |k: usize| {
            let [a, b] = columns.ends(strip.column(k), places);
            Row { a, b }
        };
        for j in 0..self.count {
            let answer = answer(j);
            for i in 0..self.count {
                self.k[i][j] = self.rows[i].dot(&answer);
            }
            self.k[j][j] += least(&self.rows[j]);
        }
        let across = [answer(tangents), answer(tangents + 1)];
        for i in 0..2 {
            for j in 0..2 {
                self.k_tangent[i][j] = self.tangents[i].dot(&across[j]);
            }
            self.k_tangent[i][i] += least(&self.tangents[i]);
        }
        self.k_spin_tangent = across.map(|answer| self.spin.dot(&answer));
        self.k_spin = self.spin.dot(&answer(spin)) + least(&self.spin);
        if self.material.rolling > 0.0 {
            let axes = [0, 1, 2].map(|axis| {
                let answer = answer(roll + axis);
                angular(&answer.b) - angular(&answer.a) + AXES[axis] * least(&rows[roll + axis])
            });
            self.k_roll = Mat3::from_cols(axes[0], axes[1], axes[2]);
        }
        strip
    }

    /// Applies the starting impulses to the bodies: those of the last substep. If they increased sharply, scales them down to the sum of
    /// the substep before, since an impact must not be repeated. At rest the load moves between points, so the sums are compared.
    pub fn warm_start(&mut self, impulses: &mut [Vec6]) {
        let (mut now, mut before) = (0.0, 0.0);
        for point in &self.memory.points[..self.count] {
            now += point.now;
            before += point.before;
        }
        let before = max(before, 0.0);
        let share = if now > IMPACT_JUMP * before { before / now } else { 1.0 };
        for i in 0..self.count {
            self.impulse[i] = self.memory.points[i].now * share;
        }
        self.friction = (self.memory.friction - self.normal * self.normal.dot(self.memory.friction)) * share;
        self.floor = [0.0; MAX_POINTS];
        self.twist = self.memory.twist * share;
        self.rolling = self.memory.rolling * share;
        self.add_impulses(impulses, 1.0);
    }

    /// Adds the present impulses of the manifold, times `sign`, to those of its bodies.
    pub fn add_impulses(&self, impulses: &mut [Vec6], sign: f32) {
        let push = self.total_push();
        add_row(impulses, self.a, &push.0, sign);
        add_row(impulses, self.b, &push.1, sign);
    }

    /// Impulses of this substep.
    pub(super) fn impulses(&self) -> ContactImpulses {
        ContactImpulses {
            normal: self.impulse,
            friction: self.friction,
            twist: self.twist,
            rolling: self.rolling,
        }
    }

    /// Adds `share` times `more` to the impulses of this substep; the caller applies them to the bodies. Returns the largest speed change
    /// that any single impulse causes, m/s or rad/s.
    pub(super) fn apply(&mut self, more: &ContactImpulses, share: f32) -> f32 {
        let ContactImpulses { normal, friction, twist, rolling } = self.impulses().plus(more, share);
        (self.impulse, self.friction, self.twist, self.rolling) = (normal, friction, twist, rolling);
        let k = self.k_tangent[0][0] + self.k_tangent[1][1];
        let mut most = max(more.friction.length() * k, more.twist.abs() * self.k_spin);
        for i in 0..self.count {
            most = max(most, more.normal[i].abs() * self.k[i][i]);
        }
        most * share
    }

    /// True if the shapes overlap by much more than at rest.
    pub fn is_deep(&self) -> bool {
        self.separation[..self.count].iter().any(|s| *s < -DEEP_SLOPS * self.slop)
    }

    /// Total impulses of all rows on the two bodies in this substep.
    pub fn total_push(&self) -> Push {
        let mut push = (ZERO6, ZERO6);
        for i in 0..self.count {
            self.add(&mut push, &self.rows[i], self.impulse[i]);
        }
        for (row, axis) in self.tangents.iter().zip(self.tangent_axes) {
            self.add(&mut push, row, self.friction.dot(axis));
        }
        self.add(&mut push, &Row::about(self.normal * self.twist + self.rolling), 1.0);
        push
    }

    /// Clears the impulses.
    pub fn forget(&mut self) {
        self.impulse = [0.0; MAX_POINTS];
        self.friction = Vec3::ZERO;
        self.twist = 0.0;
        self.rolling = Vec3::ZERO;
    }

    /// Sets the lower bounds for `relax`, which may take back excess impulses of `solve`, except from bodies that turned by more than a
    /// small angle since: an impulse taken back at another pose adds energy (a hand went from 70 to 2,700 rad/s).
    pub fn begin_relax(&mut self, velocities: &[Vec6], h: f32) {
        let turn = |body: u32| angular(&velocities[body as usize]).length() * h;
        let still = turn(self.a) < RELAX_TURN && turn(self.b) < RELAX_TURN;
        self.floor = if still { [0.0; MAX_POINTS] } else { self.impulse };
    }

    fn add(&self, push: &mut Push, row: &Row, impulse: f32) {
        add_scaled(&mut push.0, &row.a, impulse);
        add_scaled(&mut push.1, &row.b, impulse);
    }

    /// Stores the impulses of this substep for the next one.
    pub fn end_substep(&mut self, h: f32) {
        for i in 0..self.count {
            let point = &mut self.memory.points[i];
            point.before = point.now;
            point.now = max(self.impulse[i], 0.0);
            point.total += point.now;
            point.lasting += (point.now - point.lasting) * (h / (h + LASTING));
        }
        self.memory.friction = self.friction;
        self.memory.total_friction += self.friction;
        self.memory.twist = self.twist;
        self.memory.rolling = self.rolling;
    }
}
