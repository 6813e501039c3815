//! Contact rows of one manifold: up to four normal rows solved as a block, friction at the centre, twist, rolling.

use super::response::Response;
use super::sweep::Pass;
use super::tree::Link;
use super::{REDUNDANCY, SolverBody, disk, free_response, lcp};
use crate::collide::{Half, MAX_POINTS, Manifold, collide, is_on_face, name_as_face};
use crate::contact::{ContactMemory, PointImpulse};
use crate::material::ContactMaterial;
use crate::shape::Shape;
use crate::spatial::{Vec6, ZERO6, add_scaled, angular, dot, join, linear};
use sinew_math::{Mat3, Rotation, Transform, Vec3, any_orthonormal, max, min};

/// Fastest speed with which overlap is pushed apart, m/s.
const PUSH_SPEED: f32 = 3.0;
/// Approach below which nothing bounces, m/s.
const BOUNCE_SPEED: f32 = 1.0;
/// What static friction leaves of the speed of two surfaces along each other, m/s, if they slide: more than loads that have
/// not converged make of it in a substep.
const SLIP_SPEED: f32 = 0.005;
/// Distance over time of a point that no substep brings to touch, m/s.
const NEVER: f32 = 1e6;
/// An impulse that grew by more than this factor since the substep before is an impact.
pub(super) const IMPACT_JUMP: f32 = 2.0;
/// Overlap beyond this many slops is deep.
const DEEP: f32 = 2.0;
/// Share of the slop that is left overlapping.
const DEAD_ZONE: f32 = 0.2;
/// A body that turns by more than this within a substep has its contacts looked for anew, radians.
const REFIND_TURN: f32 = 0.03;
/// Likewise where a rim rolls: however slowly, what pushes from where the rim was turns the body as much as it gyrates.
const ROLL_TURN: f32 = 1e-4;
/// Then points this far apart count, as a share of the smaller bounding radius: a hand between thigh and floor that spins
/// off one corner meets the other within the substep.
const FAR_CORNER: f32 = 0.4;
/// A body that turns by less than this within a substep counts as being where it was, radians.
const RELAX_TURN: f32 = 0.15;
/// Contact stiffness as a frequency, Hz, against moving and against fixed bodies, and damping ratio.
const CONTACT_HERTZ: f32 = 30.0;
const FIXED_HERTZ: f32 = 60.0;
const CONTACT_DAMPING: f32 = 10.0;
/// Contacts are soft to changes of their load, not to the load that lasts for longer than this, seconds: a pile would sag by
/// all the weight it bears (30 rows of cubes by a quarter of a cube). Without any delay tall piles never come to rest.
const LASTING: f32 = 1.0 / 60.0;

/// Coefficients of a soft constraint (Catto, "Soft Constraints", GDC 2011).
#[derive(Clone, Copy, Debug)]
pub(super) struct Softness {
    /// 1/s.
    pub bias_rate: f32,
    pub mass_scale: f32,
    pub impulse_scale: f32,
}

impl Softness {
    pub fn new(hertz: f32, damping_ratio: f32, h: f32) -> Self {
        let omega = 2.0 * core::f32::consts::PI * hertz;
        let a1 = 2.0 * damping_ratio + h * omega;
        let a2 = h * omega * a1;
        let a3 = 1.0 / (1.0 + a2);
        Self { bias_rate: omega / a1, mass_scale: a2 * a3, impulse_scale: a3 }
    }
}

/// The two bodies that a row acts on.
#[derive(Clone, Copy, Debug)]
struct Pair {
    a: u32,
    b: u32,
}

/// A row's Jacobian on both bodies.
#[derive(Clone, Copy, Debug)]
struct Row {
    a: Vec6,
    b: Vec6,
}

impl Row {
    const ZERO: Self = Self { a: ZERO6, b: ZERO6 };

    fn at(direction: Vec3, arm_a: Vec3, arm_b: Vec3) -> Self {
        Self { a: join(-direction, -arm_a.cross(direction)), b: join(direction, arm_b.cross(direction)) }
    }

    fn about(axis: Vec3) -> Self {
        Self { a: join(Vec3::ZERO, -axis), b: join(Vec3::ZERO, axis) }
    }

    fn rate(&self, pair: Pair, velocities: &[Vec6]) -> f32 {
        dot(&self.a, &velocities[pair.a as usize]) + dot(&self.b, &velocities[pair.b as usize])
    }

    /// Velocity changes of both bodies per unit impulse of this row, as a row.
    fn response(&self, pair: Pair, links: &[Link], response: &Response) -> Self {
        let (a, b) = (pair.a as usize, pair.b as usize);
        let mut out = Self { a: response.at(links, a, a, &self.a), b: response.at(links, b, b, &self.b) };
        add_scaled(&mut out.a, &response.at(links, a, b, &self.b), 1.0);
        add_scaled(&mut out.b, &response.at(links, b, a, &self.a), 1.0);
        out
    }

    fn dot(&self, other: &Self) -> f32 {
        dot(&self.a, &other.a) + dot(&self.b, &other.b)
    }
}

/// Impulses of a manifold's rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Given {
    normal: [f32; MAX_POINTS],
    friction: Vec3,
    twist: f32,
    rolling: Vec3,
}

impl Given {
    /// With `share` of another.
    pub fn plus(&self, other: &Self, share: f32) -> Self {
        Self {
            normal: core::array::from_fn(|i| self.normal[i] + other.normal[i] * share),
            friction: self.friction + other.friction * share,
            twist: self.twist + other.twist * share,
            rolling: self.rolling + other.rolling * share,
        }
    }
}

/// Motion of a point along its normal, in a substep.
#[derive(Clone, Copy, Debug, Default)]
struct Approach {
    /// At its beginning, m/s; negative if it comes nearer.
    rate: f32,
    /// Likewise, metres; 0 if it overlaps.
    gap: f32,
    /// What forces and joints add in the substep before contacts, toward the surface, m/s; not negative.
    pull: f32,
}

impl Approach {
    /// Speed at the surface, m/s. A velocity of symplectic Euler is that of half a substep ago, and what pulls goes on between
    /// here and the surface.
    fn speed_at_surface(&self, h: f32) -> f32 {
        let now = self.rate - 0.5 * self.pull;
        if now < 0.0 { (now * now + 2.0 * (self.pull / h) * self.gap).sqrt() } else { 0.0 }
    }
}

/// What a manifold's normal rows are to reach: `K (x − old) + rate + soft x ≥ 0`, complementary to `x ≥ 0`.
#[derive(Clone, Copy, Debug, Default)]
struct NormalProblem {
    /// Of the gap with what is added to it, m/s; negative if it closes too fast.
    rate: [f32; MAX_POINTS],
    /// Impulses so far, N·s.
    old: [f32; MAX_POINTS],
    /// m/s per N·s.
    soft: [f32; MAX_POINTS],
}

/// Change of impulse of a manifold: on A and on B.
pub(super) type Push = (Vec6, Vec6);

#[derive(Clone, Debug)]
pub(crate) struct ManifoldRows {
    /// Place in the world's contact array.
    pub contact: u32,
    /// Local bodies.
    pub a: u32,
    pub b: u32,
    /// As last found: at the step's beginning, or since, if a body turned fast.
    pub manifold: Manifold,
    shapes: [PlacedShape; 2],
    /// Radii of the shapes' roundings around their cores, where they meet.
    rounds: [f32; 2],
    /// Bodies turn by less than this in a substep or the contact is looked for anew, radians.
    most_turn: f32,
    normal: Vec3,
    count: usize,
    /// Cores of the surfaces at each point, in the principal frames, and their distances from the surfaces: a ball's
    /// contact does not turn with it, a box's corner does.
    core_a: [Vec3; MAX_POINTS],
    core_b: [Vec3; MAX_POINTS],
    a_moves: bool,
    b_moves: bool,
    material: ContactMaterial,
    slop: f32,
    soft: Softness,
    /// Share of that softness, but for the bias.
    softness: f32,
    /// Of the present pose.
    separation: [f32; MAX_POINTS],
    rows: [Row; MAX_POINTS],
    tangents: [Row; 2],
    tangent_axes: [Vec3; 2],
    spin: Row,
    /// Share of the load that each point had when the step began: friction acts at the centre of pressure.
    weight: [f32; MAX_POINTS],
    /// Weighted distance of the points from that centre: lever of the twist friction.
    lever: f32,
    /// Responses.
    k: [[f32; MAX_POINTS]; MAX_POINTS],
    k_tangent: [[f32; 2]; 2],
    k_spin: f32,
    /// Of the twist to the tangents.
    k_spin_tangent: [f32; 2],
    k_roll: Mat3,
    /// How each point comes in, in this substep.
    approach: [Approach; MAX_POINTS],
    /// Normal speed with which each point leaves what it hit in this substep, m/s; 0 if it does not bounce.
    rebound: [f32; MAX_POINTS],
    /// Impulses of this substep.
    impulse: [f32; MAX_POINTS],
    /// Sum of the normal impulses that friction is limited by.
    load: f32,
    /// What `relax` may not go below.
    floor: [f32; MAX_POINTS],
    friction: Vec3,
    twist: f32,
    rolling: Vec3,
    pub memory: ContactMemory,
}

/// One of the two shapes of a manifold.
#[derive(Clone, Debug)]
pub(crate) struct PlacedShape {
    pub shape: Shape,
    pub principal_from_shape: Transform,
}

/// A cylinder whose axis leans by less than this sine against the plane across the normal lies on its side.
const LYING_SINE: f32 = 0.1;
/// One whose end leans by less than this sine stands on it.
const FLAT_SINE: f32 = 0.01;

impl PlacedShape {
    pub fn new(shape: Shape, principal_from_shape: Transform) -> Self {
        Self { shape, principal_from_shape }
    }

    /// Radius of the rounding around its core where it meets a normal (in the principal frame); 0 of what has corners.
    fn round(&self, normal: Vec3) -> f32 {
        match self.shape {
            Shape::Sphere { radius } | Shape::Capsule { radius, .. } => radius,
            // The thinner end's: what a core is rounded by all around.
            Shape::TaperedCapsule { radius_bottom, radius_top, .. } => min(radius_bottom, radius_top),
            Shape::Cylinder { radius, .. } => {
                let axis = self.principal_from_shape.rotation * Vec3::Y;
                if axis.dot(normal).abs() < LYING_SINE { radius } else { 0.0 }
            }
            Shape::Box { .. }
            | Shape::Cone { .. }
            | Shape::Hull(_)
            | Shape::HalfSpace
            | Shape::Mesh(_)
            | Shape::HeightField(_) => 0.0,
        }
    }

    /// Whether it meets a normal (in the principal frame) with what is curved but not by [`Self::round`]: as it rolls, other
    /// points come down.
    fn has_rim(&self, normal: Vec3) -> bool {
        let axis = || self.principal_from_shape.rotation * Vec3::Y;
        match self.shape {
            Shape::Cylinder { .. } => self.round(normal) == 0.0 && axis().cross(normal).length() > FLAT_SINE,
            Shape::Cone { .. } => axis().cross(normal).length() > FLAT_SINE,
            Shape::TaperedCapsule { radius_bottom, radius_top, .. } => radius_bottom != radius_top,
            _ => false,
        }
    }
}

/// What a manifold's rows are made from.
pub(crate) struct ManifoldSource<'a> {
    pub contact: u32,
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
        let hertz = if source.a_moves && source.b_moves { CONTACT_HERTZ } else { FIXED_HERTZ };
        let mut rows = Self {
            contact: source.contact,
            a: source.a,
            b: source.b,
            manifold: *source.manifold,
            shapes: source.shapes.clone(),
            rounds: [0.0; 2],
            most_turn: REFIND_TURN,
            normal: n,
            count: source.manifold.count,
            core_a: [Vec3::ZERO; MAX_POINTS],
            core_b: [Vec3::ZERO; MAX_POINTS],
            a_moves: source.a_moves,
            b_moves: source.b_moves,
            material: source.material,
            slop: source.slop,
            soft: Softness::new(min(hertz, 0.25 / source.h), CONTACT_DAMPING, source.h),
            softness: 1.0,
            separation: [0.0; MAX_POINTS],
            rows: [Row::ZERO; MAX_POINTS],
            tangents: [Row::ZERO; 2],
            tangent_axes: [Vec3::ZERO; 2],
            spin: Row::about(n),
            weight: [0.0; MAX_POINTS],
            lever: 0.0,
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
        rows.take_manifold(bodies);
        rows.place(bodies);
        rows
    }

    /// Has it give by so much of what its frequency says.
    pub fn soften(&mut self, share: f32) {
        self.softness = share;
    }

    /// Cores of the manifold's points at the present poses.
    fn take_manifold(&mut self, bodies: &[SolverBody]) {
        let (pose_a, pose_b) = (bodies[self.a as usize].pose, bodies[self.b as usize].pose);
        self.normal = self.manifold.normal;
        self.count = self.manifold.count;
        self.spin = Row::about(self.normal);
        let n = self.normal;
        let [a, b] = &self.shapes;
        let [in_a, in_b] = [pose_a, pose_b].map(|pose| pose.rotation.inverse() * n);
        let [round_a, round_b] = [a.round(in_a), b.round(in_b)];
        self.rounds = [round_a, round_b];
        // Of a rim, the points beside the one that it rolls on bear nothing.
        let (most_turn, bearing) = match a.has_rim(in_a) || b.has_rim(in_b) {
            true => (ROLL_TURN, self.slop),
            false => (REFIND_TURN, f32::INFINITY),
        };
        self.most_turn = most_turn;
        self.weight = weights(&self.memory, &self.manifold, bearing);
        for (i, point) in self.manifold.points().iter().enumerate() {
            let half = n * (0.5 * point.separation);
            self.core_a[i] = pose_a.inverse_point(point.position - half - n * round_a);
            self.core_b[i] = pose_b.inverse_point(point.position + half + n * round_b);
        }
    }

    /// Looks for the contact anew if a body turned fast in this substep: the points of the step's beginning say nothing
    /// of the corner that swings in. Impulses go on by feature. A pair that has come apart keeps its rows.
    pub fn refind(&mut self, bodies: &[SolverBody], velocities: &[Vec6], h: f32) {
        let turn = |body: u32| angular(&velocities[body as usize]).length() * h;
        if turn(self.a) < self.most_turn && turn(self.b) < self.most_turn {
            return;
        }
        let [a, b] = &self.shapes;
        let (pose_a, pose_b) = (bodies[self.a as usize].pose, bodies[self.b as usize].pose);
        let relative = linear(&velocities[self.b as usize]) - linear(&velocities[self.a as usize]);
        let reach = a.shape.bounding_radius() * turn(self.a) + b.shape.bounding_radius() * turn(self.b);
        let turning = if reach < f32::INFINITY { reach } else { 0.0 };
        let far_corner = FAR_CORNER * min(a.shape.bounding_radius(), b.shape.bounding_radius());
        let margin = max(4.0 * self.slop + relative.length() * h + turning, far_corner);
        let frames = [pose_a * a.principal_from_shape, pose_b * b.principal_from_shape];
        let Some(manifold) = self.found_anew(frames, [pose_a, pose_b], margin) else { return };
        let impulse = self.impulse.map(|now| PointImpulse { now, ..PointImpulse::default() });
        let of_substep = ContactMemory { points: impulse, ..self.memory }.matched(&self.manifold, &manifold);
        let memory = self.memory.matched(&self.manifold, &manifold);
        let mean = self.rebound[..self.count].iter().sum::<f32>() / self.count as f32;
        let (was, rebound) = (self.manifold, self.rebound);
        for (i, point) in manifold.points().iter().enumerate() {
            let known = was.points().iter().position(|p| p.feature == point.feature);
            self.rebound[i] = known.map_or(mean, |k| rebound[k]);
            self.impulse[i] = of_substep.points[i].now;
        }
        self.memory = memory;
        self.manifold = manifold;
        self.take_manifold(bodies);
    }

    /// The contact at the present poses, if there is one. Of a surface the plane stands that the manifold lies on: the surface
    /// itself would answer for all its manifolds at once. What lies on its edges stays as it was found.
    fn found_anew(&self, frames: [Transform; 2], poses: [Transform; 2], margin: f32) -> Option<Manifold> {
        static PLANE: Shape = Shape::HalfSpace;
        let [a, b] = &self.shapes;
        let plane = |origin: Vec3, normal: Vec3| Transform::new(origin, Rotation::from_arc(Vec3::Y, normal));
        let mut manifold = Manifold::default();
        let surface = match (a.shape.surface(), b.shape.surface()) {
            (None, None) => {
                collide(&a.shape, &frames[0], &b.shape, &frames[1], margin, &mut manifold);
                return (manifold.count > 0).then_some(manifold);
            }
            (Some(_), _) => Half::OfA,
            _ => Half::OfB,
        };
        if !is_on_face(&self.manifold, surface) {
            return None;
        }
        match surface {
            Half::OfA => {
                let ground = plane(poses[0].point(self.core_a[0]), self.normal);
                collide(&PLANE, &ground, &b.shape, &frames[1], margin, &mut manifold);
            }
            Half::OfB => {
                let ground = plane(poses[1].point(self.core_b[0]), -self.normal);
                collide(&a.shape, &frames[0], &PLANE, &ground, margin, &mut manifold);
            }
        }
        name_as_face(&mut manifold, surface);
        (manifold.count > 0).then_some(manifold)
    }

    fn pair(&self) -> Pair {
        Pair { a: self.a, b: self.b }
    }

    /// Separations and Jacobians at the present pose.
    pub fn place(&mut self, bodies: &[SolverBody]) {
        let (pose_a, pose_b) = (bodies[self.a as usize].pose, bodies[self.b as usize].pose);
        let n = self.normal;
        let mut points = [Vec3::ZERO; MAX_POINTS];
        let mut center = Vec3::ZERO;
        for i in 0..self.count {
            let on_a = pose_a.point(self.core_a[i]) + n * self.rounds[0];
            let on_b = pose_b.point(self.core_b[i]) - n * self.rounds[1];
            self.separation[i] = (on_b - on_a).dot(n);
            points[i] = match self.rounds.map(|round| round > 0.0).into() {
                // Where a ball touches goes along with the ball, also on a table that moves away under it.
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

    /// Effective masses from the response of the bodies.
    pub fn respond(&mut self, bodies: &[SolverBody], links: &[Link], response: &Response) {
        let pair = self.pair();
        let least =
            |row: &Row| REDUNDANCY * free_response(bodies, links.len(), [(pair.a, &row.a), (pair.b, &row.b)]);
        let mut answers = [Row::ZERO; MAX_POINTS];
        for i in 0..self.count {
            answers[i] = self.rows[i].response(pair, links, response);
        }
        for i in 0..self.count {
            for j in 0..self.count {
                self.k[i][j] = self.rows[i].dot(&answers[j]);
            }
            self.k[i][i] += least(&self.rows[i]);
        }
        let across = self.tangents.map(|row| row.response(pair, links, response));
        for i in 0..2 {
            for j in 0..2 {
                self.k_tangent[i][j] = self.tangents[i].dot(&across[j]);
            }
            self.k_tangent[i][i] += least(&self.tangents[i]);
        }
        self.k_spin_tangent = across.map(|answer| self.spin.dot(&answer));
        self.k_spin = self.spin.dot(&self.spin.response(pair, links, response)) + least(&self.spin);
        if self.material.rolling > 0.0 {
            let columns = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| {
                let answer = Row::about(axis).response(pair, links, response);
                angular(&answer.b) - angular(&answer.a) + axis * least(&Row::about(axis))
            });
            self.k_roll = Mat3::from_cols(columns[0], columns[1], columns[2]);
        }
    }

    /// Puts the starting impulses on the bodies: those of the last substep, unless they jumped up from the one before:
    /// an impact must not be repeated. Judged for the manifold as a whole, since at rest the load wanders between points.
    pub fn warm_start(&mut self, impulses: &mut [Vec6]) {
        let (mut now, mut before) = (0.0, 0.0);
        for point in &self.memory.points[..self.count] {
            now += point.now;
            before += point.before;
        }
        let share = if now > IMPACT_JUMP * before { before / now } else { 1.0 };
        for i in 0..self.count {
            self.impulse[i] = self.memory.points[i].now * share;
        }
        self.friction = (self.memory.friction - self.normal * self.normal.dot(self.memory.friction)) * share;
        self.floor = [0.0; MAX_POINTS];
        self.twist = self.memory.twist * share;
        self.rolling = self.memory.rolling * share;
        let push = self.total_push();
        super::limit_rows::add_row(impulses, self.a, &push.0, 1.0);
        super::limit_rows::add_row(impulses, self.b, &push.1, 1.0);
    }

    /// Impulses of this substep.
    pub(super) fn given(&self) -> Given {
        Given { normal: self.impulse, friction: self.friction, twist: self.twist, rolling: self.rolling }
    }

    /// Adds a share of impulses to those of this substep; the caller puts them on the bodies. Gives the largest speed that
    /// one of them makes by itself, m/s or rad/s.
    pub(super) fn give(&mut self, more: &Given, share: f32) -> f32 {
        let Given { normal, friction, twist, rolling } = self.given().plus(more, share);
        (self.impulse, self.friction, self.twist, self.rolling) = (normal, friction, twist, rolling);
        let k = self.k_tangent[0][0] + self.k_tangent[1][1];
        let mut most = max(more.friction.length() * k, more.twist.abs() * self.k_spin);
        for i in 0..self.count {
            most = max(most, more.normal[i].abs() * self.k[i][i]);
        }
        most * share
    }

    /// Overlaps by much more than contacts at rest do.
    pub fn is_deep(&self) -> bool {
        self.separation[..self.count].iter().any(|s| *s < -DEEP * self.slop)
    }

    /// What all rows put on the bodies in this substep.
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

    /// Starts from nothing.
    pub fn forget(&mut self) {
        self.impulse = [0.0; MAX_POINTS];
        self.friction = Vec3::ZERO;
        self.twist = 0.0;
        self.rolling = Vec3::ZERO;
    }

    /// `relax` may take back what `solve` gave too much, but not from bodies that turned by more than a little since: an
    /// impulse taken back at another pose than it was given at puts energy in (a hand went from 70 to 2,700 rad/s).
    pub fn begin_relax(&mut self, velocities: &[Vec6], h: f32) {
        let turn = |body: u32| angular(&velocities[body as usize]).length() * h;
        let still = turn(self.a) < RELAX_TURN && turn(self.b) < RELAX_TURN;
        self.floor = if still { [0.0; MAX_POINTS] } else { self.impulse };
    }

    /// Takes the normal impulses as they are for the load of friction.
    pub fn weigh(&mut self) {
        self.load = self.impulse[..self.count].iter().fold(0.0, |sum, p| sum + max(*p, 0.0));
    }

    /// Likewise, but unless this is a hit the normal impulses that the last substep ended with: what few sweeps know of this
    /// one's is off to one side, that sum is not, since it is what held the body up.
    pub fn weigh_by_memory(&mut self) {
        self.weigh();
        let last = self.memory.points[..self.count].iter().fold(0.0, |sum, p| sum + p.now);
        if self.load <= IMPACT_JUMP * last && last <= IMPACT_JUMP * self.load {
            self.load = last;
        }
    }

    fn add(&self, push: &mut Push, row: &Row, impulse: f32) {
        add_scaled(&mut push.0, &row.a, impulse);
        add_scaled(&mut push.1, &row.b, impulse);
    }

    /// What the normal rows are to reach at the present velocities.
    fn normal_problem(&self, velocities: &[Vec6], pass: Pass, h: f32) -> NormalProblem {
        let (pair, biased) = (self.pair(), pass == Pass::Solve);
        let mut mean = 0.0;
        for row in &self.k[..self.count] {
            for k in &row[..self.count] {
                mean += k;
            }
        }
        // The block's softness is taken at the manifold's centre; taken at each point a 1 kg foot under 69 kg sinks 7 mm.
        let at_center =
            self.softness * self.soft.impulse_scale / self.soft.mass_scale * mean / self.count as f32;
        let mut problem = NormalProblem::default();
        for i in 0..self.count {
            let s = self.separation[i];
            let bias = if pass == Pass::Restitution && self.rebound[i] > 0.0 {
                -self.rebound[i]
            } else if s > 0.0 && self.comes_to_bounce(i) && !biased {
                NEVER
            } else if s > 0.0 {
                s / h
            } else if biased {
                let push = max(self.soft.bias_rate * min(s + DEAD_ZONE * self.slop, 0.0), -PUSH_SPEED);
                min(push, -self.material.launch)
            } else {
                -self.material.launch
            };
            let soft = if biased && s <= 0.0 { at_center } else { 0.0 };
            problem.soft[i] = soft;
            problem.old[i] = self.impulse[i] - self.floor[i];
            let lasting = self.memory.points[i].lasting;
            problem.rate[i] = self.rows[i].rate(pair, velocities) + bias - soft * lasting;
        }
        problem
    }

    /// One visit of the normal rows as a block.
    pub fn visit_normal(&mut self, velocities: &[Vec6], pass: Pass, h: f32) -> Push {
        let NormalProblem { rate, old, soft } = self.normal_problem(velocities, pass, h);
        let new = lcp::solve(&self.k, &rate, &old, &soft, self.count);
        let mut push = (ZERO6, ZERO6);
        for i in 0..self.count {
            let row = self.rows[i];
            self.add(&mut push, &row, new[i] - old[i]);
            self.impulse[i] = new[i] + self.floor[i];
        }
        push
    }

    /// One visit of friction, limited by the load that was weighed last: a 2×2 row limited to the circle, twist about the
    /// normal. What static friction does not hold slides.
    pub fn visit_friction(&mut self, velocities: &[Vec6]) -> Push {
        let pair = self.pair();
        let mut push = (ZERO6, ZERO6);
        let k = &self.k_tangent;
        let old = self.tangent_axes.map(|axis| self.friction.dot(axis));
        let slip = |i: usize| {
            self.tangents[i].rate(pair, velocities) + self.material.velocity.dot(self.tangent_axes[i])
        };
        let rates = [slip(0), slip(1)];
        let b = [0, 1].map(|i| k[i][0] * old[0] + k[i][1] * old[1] - rates[i]);
        let ContactMaterial { friction, static_friction, .. } = self.material;
        let mut new = disk::least_energy(k, b, static_friction * self.load);
        let mut grip = static_friction;
        let slip = [0, 1].map(|i| k[i][0] * new[0] + k[i][1] * new[1] - b[i]);
        if static_friction > friction && slip[0] * slip[0] + slip[1] * slip[1] > SLIP_SPEED * SLIP_SPEED {
            new = disk::least_energy(k, b, friction * self.load);
            grip = friction;
        }
        for i in 0..2 {
            let row = self.tangents[i];
            self.add(&mut push, &row, new[i] - old[i]);
        }
        self.friction = self.tangent_axes[0] * new[0] + self.tangent_axes[1] * new[1];
        if self.k_spin > 1e-12 {
            // After the tangents: a light hand turns far about a contact beside its centre, and to answer both at once
            // overshoots, sweep by sweep more.
            let [k0, k1] = self.k_spin_tangent;
            let rate = self.spin.rate(pair, velocities)
                + self.material.spin.dot(self.normal)
                + k0 * (new[0] - old[0])
                + k1 * (new[1] - old[1]);
            let wanted = self.twist - rate / self.k_spin;
            let most = grip * self.lever * self.load;
            let slip = max(wanted.abs() - most, 0.0) * self.k_spin * self.lever;
            let most = if slip > SLIP_SPEED { friction * self.lever * self.load } else { most };
            let new = sinew_math::clamp(wanted, -most, most);
            self.add(&mut push, &self.spin, new - self.twist);
            self.twist = new;
        }
        push
    }

    /// One visit of the rolling resistance: a torque against the relative rotation, at most `rolling × load`.
    pub fn visit_rolling(&mut self, velocities: &[Vec6]) -> Option<Push> {
        if self.material.rolling <= 0.0 {
            return None;
        }
        let w = angular(&velocities[self.b as usize]) - angular(&velocities[self.a as usize]);
        let new = disk::step_in_ball(&self.k_roll, self.rolling, w, self.material.rolling * self.load);
        let mut push = (ZERO6, ZERO6);
        self.add(&mut push, &Row::about(new - self.rolling), 1.0);
        self.rolling = new;
        Some(push)
    }

    /// How its points come in, when the substep begins.
    pub fn begin_approach(&mut self, velocities: &[Vec6]) {
        for i in 0..self.bouncy_count() {
            let rate = self.rows[i].rate(self.pair(), velocities);
            self.approach[i] = Approach { rate, gap: max(self.separation[i], 0.0), pull: 0.0 };
        }
    }

    /// What the forces and the joints have added to that.
    pub fn pull_approach(&mut self, velocities: &[Vec6]) {
        for i in 0..self.bouncy_count() {
            let rate = self.rows[i].rate(self.pair(), velocities);
            self.approach[i].pull = max(self.approach[i].rate - rate, 0.0);
        }
    }

    /// Points that came in fast and were hit will bounce, to the height that their speed at the surface is good for.
    pub fn end_approach(&mut self, h: f32) {
        self.rebound = [0.0; MAX_POINTS];
        for i in 0..self.bouncy_count() {
            let speed = self.approach[i].speed_at_surface(h);
            if self.impulse[i] > 0.0 && speed > BOUNCE_SPEED {
                self.rebound[i] = self.material.restitution * speed + 0.5 * self.approach[i].pull;
            }
        }
    }

    /// A point that will bounce, but has not touched yet: `relax` must not brake it on its way.
    fn comes_to_bounce(&self, i: usize) -> bool {
        self.material.restitution > 0.0 && self.impulse[i] == 0.0
    }

    /// Points that may bounce.
    fn bouncy_count(&self) -> usize {
        if self.material.restitution > 0.0 { self.count } else { 0 }
    }

    /// Whether a point leaves what it hit.
    pub fn bounces(&self) -> bool {
        (0..self.bouncy_count()).any(|i| self.rebound[i] > 0.0)
    }

    /// What the bounce of this substep added to its impulses.
    pub fn add_bounce(&mut self) {
        for i in 0..self.count {
            let point = &mut self.memory.points[i];
            point.total += max(self.impulse[i], 0.0) - point.now;
        }
    }

    /// Impulses of this substep become memory.
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

/// Shares of the load by point, smoothed so that a point which is about to bear some has a say: one whose separation is at
/// most `bearing`, if there is any.
fn weights(memory: &ContactMemory, manifold: &Manifold, bearing: f32) -> [f32; MAX_POINTS] {
    let points = manifold.points();
    let total: f32 = memory.points[..points.len()].iter().map(|point| point.now).sum();
    let bears = |separation: f32| separation <= bearing;
    let heirs = points.iter().filter(|point| bears(point.separation)).count();
    let mut weights = [0.0; MAX_POINTS];
    for (i, point) in points.iter().enumerate() {
        let even = match heirs {
            0 => 1.0 / points.len() as f32,
            _ if bears(point.separation) => 1.0 / heirs as f32,
            _ => 0.0,
        };
        let share = if total > 0.0 { memory.points[i].now / total } else { even };
        weights[i] = 0.8 * share + 0.2 * even;
    }
    weights
}
