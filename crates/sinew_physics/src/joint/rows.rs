//! Constraint rows and stops of a joint at a pose.

use super::def::{AxisMotion, JointKind};
use crate::spatial::{Vec6, ZERO6, join};
use sinew_math::limits::{hinge_angle, wrap};
use sinew_math::{Range, Rotation, SwingTwistLimit, Transform, Vec3};

/// Directions of a joint: translation along x, y, z of frame A (along the line between the anchors for a distance),
/// then twist about x, swing about y and z.
pub(crate) const DIRECTIONS: usize = 6;
/// Of these, the first rotation.
pub(crate) const TWIST: usize = 3;

/// What the rows of a joint are computed from: its definition without state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointGeometry {
    pub frame_a: Transform,
    pub frame_b: Transform,
    pub kind: JointKind,
}

/// The joint's frames in the world, and the arms of its anchors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointPose {
    /// World arm from A's centre of mass to its anchor, likewise B.
    pub arm_a: Vec3,
    pub arm_b: Vec3,
    /// Anchor of B less anchor of A, world, metres.
    pub gap: Vec3,
    pub rotation_a: Rotation,
    pub rotation_b: Rotation,
}

impl JointPose {
    pub fn new(joint: &JointGeometry, a: &Transform, b: &Transform) -> Self {
        let arm_a = a.rotation * joint.frame_a.translation;
        let arm_b = b.rotation * joint.frame_b.translation;
        Self {
            arm_a,
            arm_b,
            gap: (b.translation - a.translation) + (arm_b - arm_a),
            rotation_a: a.rotation * joint.frame_a.rotation,
            rotation_b: b.rotation * joint.frame_b.rotation,
        }
    }

    /// Rotation of frame B seen from frame A.
    pub fn relative(&self) -> Rotation {
        self.rotation_a.inverse() * self.rotation_b
    }

    /// Frame B seen from frame A.
    pub fn a_from_b(&self) -> Transform {
        Transform::new(self.rotation_a.inverse() * self.gap, self.relative())
    }

    /// Unit direction from A's anchor to B's; x of frame A where they coincide.
    fn line(&self) -> Vec3 {
        let length = self.gap.length();
        if length > 1e-6 { self.gap / length } else { self.rotation_a * Vec3::X }
    }

    fn axis(&self, i: usize) -> Vec3 {
        self.rotation_a * [Vec3::X, Vec3::Y, Vec3::Z][i]
    }
}

/// One row's Jacobian on both bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    pub a: Vec6,
    pub b: Vec6,
}

impl Row {
    /// Rate of the anchors' distance along a direction that stands still in the world.
    fn along(direction: Vec3, pose: &JointPose) -> Self {
        Self {
            a: join(-direction, -pose.arm_a.cross(direction)),
            b: join(direction, pose.arm_b.cross(direction)),
        }
    }

    /// The same along a direction that turns with A.
    fn along_turning(direction: Vec3, pose: &JointPose) -> Self {
        Self {
            a: join(-direction, -(pose.arm_a + pose.gap).cross(direction)),
            b: join(direction, pose.arm_b.cross(direction)),
        }
    }

    /// Rate of rotation of B about an axis, seen from A.
    fn about(axis: Vec3) -> Self {
        Self { a: join(Vec3::ZERO, -axis), b: join(Vec3::ZERO, axis) }
    }

    fn negated(self) -> Self {
        Self { a: self.a.map(|x| -x), b: self.b.map(|x| -x) }
    }
}

/// Rows `J_a v_a + J_b v_b` of one joint: those of locked directions first, then those of open ones.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointRows {
    /// Rows in use.
    pub count: usize,
    /// Of these, of locked directions.
    pub locked: usize,
    /// Position error of the locked rows, metres or radians.
    pub error: Vec6,
    /// Which direction each row is of.
    pub direction: [usize; DIRECTIONS],
    /// Jacobians of the two bodies, row by row.
    pub a: [Vec6; DIRECTIONS],
    pub b: [Vec6; DIRECTIONS],
}

impl JointRows {
    /// Rows of all locked directions, and of those open ones that are asked for.
    pub fn new(joint: &JointGeometry, pose: &JointPose, open: [bool; DIRECTIONS]) -> Self {
        let mut rows = Self {
            count: 0,
            locked: 0,
            error: ZERO6,
            direction: [0; DIRECTIONS],
            a: [ZERO6; DIRECTIONS],
            b: [ZERO6; DIRECTIONS],
        };
        let locks = locks(&joint.kind);
        for i in (0..DIRECTIONS).filter(|&i| locks[i]) {
            let (error, row) = locked_row(&joint.kind, &locks, pose, i);
            rows.push(i, error, row);
        }
        rows.locked = rows.count;
        for i in open_directions(joint.kind).filter(|&i| open[i]) {
            rows.push(i, 0.0, open_row(&joint.kind, pose, i));
        }
        rows
    }

    fn push(&mut self, direction: usize, error: f32, row: Row) {
        self.error[self.count] = error;
        self.direction[self.count] = direction;
        self.a[self.count] = row.a;
        self.b[self.count] = row.b;
        self.count += 1;
    }
}

/// Position errors of the locked rows alone, in the order of [`JointRows`].
pub(crate) fn locked_error(joint: &JointGeometry, pose: &JointPose) -> Vec6 {
    let locks = locks(&joint.kind);
    let mut error = ZERO6;
    for (row, i) in (0..DIRECTIONS).filter(|&i| locks[i]).enumerate() {
        error[row] = locked_row(&joint.kind, &locks, pose, i).0;
    }
    error
}

/// Which directions are held.
pub(crate) fn locks(kind: &JointKind) -> [bool; DIRECTIONS] {
    match kind {
        JointKind::Ball { .. } => [true, true, true, false, false, false],
        JointKind::Hinge { .. } => [true, true, true, false, true, true],
        JointKind::Universal { .. } => [true, true, true, true, false, false],
        JointKind::Fixed => [true; 6],
        JointKind::Slider { .. } => [false, true, true, true, true, true],
        JointKind::Distance { range } => [range.lo == range.hi, false, false, false, false, false],
        JointKind::SixDof(six) => {
            let [x, y, z] = six.linear;
            [x, y, z, six.twist, six.swing_y, six.swing_z].map(|motion| motion == AxisMotion::Locked)
        }
    }
}

/// A distance joint knows one translation only.
fn exists(kind: &JointKind, direction: usize) -> bool {
    !matches!(kind, JointKind::Distance { .. }) || direction == 0
}

/// Error and row of a locked direction.
fn locked_row(kind: &JointKind, locks: &[bool; 6], pose: &JointPose, direction: usize) -> (f32, Row) {
    if direction >= TWIST {
        let (error, axis) = locked_rotation(locks, pose, direction);
        return (error, Row::about(axis));
    }
    if let JointKind::Distance { range } = kind {
        return (pose.gap.length() - range.lo, Row::along(pose.line(), pose));
    }
    if locks[..TWIST] == [true; 3] {
        // A point: any axes will do, and those of the world need no turning.
        let axis = [Vec3::X, Vec3::Y, Vec3::Z][direction];
        return (axis.dot(pose.gap), Row::along(axis, pose));
    }
    let axis = pose.axis(direction);
    (axis.dot(pose.gap), Row::along_turning(axis, pose))
}

/// Locked rotation: error in radians and world axis whose dot product with `ω_b − ω_a` is its rate.
fn locked_rotation(locks: &[bool; 6], pose: &JointPose, direction: usize) -> (f32, Vec3) {
    let (ra, x_b) = (pose.rotation_a, pose.rotation_b * Vec3::X);
    if locks[TWIST..] == [true; 3] {
        let error = pose.relative().to_scaled_axis();
        let i = direction - TWIST;
        return ([error.x, error.y, error.z][i], pose.axis(i));
    }
    match direction {
        TWIST => {
            // The twist rate is ω·(x_a + x_b)/(1 + x_a·x_b). C = ½ (1 + x_a·x_b) θ fades where a swing of half a turn leaves
            // the twist θ undefined, instead of growing beyond all bounds: Ċ = ω · ½ (x_a + x_b + θ x_b × x_a).
            let (swing, twist) = pose.relative().swing_twist(Vec3::X);
            let (x_b, angle) = (swing * Vec3::X, twist.twist_angle(Vec3::X));
            let sum = Vec3::X + x_b;
            (angle * 0.5 * sum.x, ra * ((sum + x_b.cross(Vec3::X) * angle) * 0.5))
        }
        // C = −z_a · x_b and y_a · x_b keep x_b out of the planes it would swing into. Ċ = (x_b × y_a) · (ω_b − ω_a).
        4 => {
            let z = ra * Vec3::Z;
            (-z.dot(x_b), z.cross(x_b))
        }
        _ => {
            let y = ra * Vec3::Y;
            (y.dot(x_b), x_b.cross(y))
        }
    }
}

/// Number of directions that are held.
pub(crate) fn locked_count(kind: &JointKind) -> usize {
    locks(kind).iter().filter(|&&lock| lock).count()
}

/// Directions that are not held.
pub(crate) fn open_directions(kind: JointKind) -> impl Iterator<Item = usize> {
    let locks = locks(&kind);
    (0..DIRECTIONS).filter(move |&i| !locks[i] && exists(&kind, i))
}

/// Row of an open direction.
pub(crate) fn open_row(kind: &JointKind, pose: &JointPose, direction: usize) -> Row {
    let locks = locks(kind);
    match direction {
        0 if matches!(kind, JointKind::Distance { .. }) => Row::along(pose.line(), pose),
        0..TWIST => Row::along_turning(pose.axis(direction), pose),
        // With one swing locked the twist is about the axis that B carries.
        TWIST if locks[4] != locks[5] => Row::about(pose.rotation_b * Vec3::X),
        _ => Row::about(pose.axis(direction - TWIST)),
    }
}

/// How far an open direction is from a wanted pose of frame B in frame A, metres or radians.
pub(crate) fn displacement(kind: &JointKind, pose: &JointPose, direction: usize, wanted: &Transform) -> f32 {
    if direction >= TWIST {
        let error = pose.relative() * wanted.rotation.inverse();
        let error = error.to_scaled_axis();
        return [error.x, error.y, error.z][direction - TWIST];
    }
    if matches!(kind, JointKind::Distance { .. }) {
        return pose.gap.length() - wanted.translation.x;
    }
    let error = pose.rotation_a.inverse() * pose.gap - wanted.translation;
    [error.x, error.y, error.z][direction]
}

/// At most this many stops has a joint: swing, twist below and above, then below and above for x, y, z.
pub(crate) const MAX_STOPS: usize = 9;
/// Stops that face each other share a memory: swing, twist, x, y, z.
pub(crate) const MAX_LIMITS: usize = 5;

/// The end of a free motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stop {
    /// Which memory it has.
    pub limit: usize,
    /// Metres or radians left; negative when violated.
    pub room: f32,
    /// Gradient of the room in frame A: rotation for the first two limits, translation for the others.
    pub axis: Vec3,
    /// Rate of the room.
    pub row: Row,
}

/// Whether a limit is of a rotation.
pub(crate) fn turns(limit: usize) -> bool {
    limit < 2
}

/// The stops of a joint, each at its own place; those that it does not have are `None`.
pub(crate) fn stops(kind: &JointKind, pose: &JointPose) -> [Option<Stop>; MAX_STOPS] {
    let mut out = [None; MAX_STOPS];
    let mut put = |place: usize, room: f32, axis: Vec3| {
        let row = Row::about(pose.rotation_a * axis);
        out[place] = Some(Stop { limit: place.div_ceil(2), room, axis, row });
    };
    let (cone, twist) = rotation_limits(kind);
    if let Some(limit) = cone {
        let state = limit.swing_state(pose.relative());
        put(0, state.room, state.axis);
    }
    if let JointKind::Hinge { limit: Some(range) } = kind {
        // Measured from the middle and wrapped, as for a twist.
        let half = 0.5 * (range.hi - range.lo);
        let angle = wrap(hinge_angle(pose.relative()) - range.center());
        put(1, half + angle, Vec3::X);
        put(2, half - angle, -Vec3::X);
    } else if let Some(range) = twist {
        let [below, above] = twist_stops(range, pose.relative());
        put(1, below.room, below.axis);
        put(2, above.room, above.axis);
    }
    for (i, range) in linear_limits(kind).into_iter().enumerate() {
        let Some(range) = range else { continue };
        let (at, axis, row) = if let JointKind::Distance { .. } = kind {
            let line = pose.line();
            (pose.gap.length(), pose.rotation_a.inverse() * line, Row::along(line, pose))
        } else {
            let axis = pose.axis(i);
            (axis.dot(pose.gap), [Vec3::X, Vec3::Y, Vec3::Z][i], Row::along_turning(axis, pose))
        };
        let limit = 2 + i;
        out[3 + 2 * i] = Some(Stop { limit, room: at - range.lo, axis, row });
        out[4 + 2 * i] = Some(Stop { limit, room: range.hi - at, axis: -axis, row: row.negated() });
    }
    out
}

/// Cone and twist range of a joint; a hinge's range is read where it is used.
fn rotation_limits(kind: &JointKind) -> (Option<SwingTwistLimit>, Option<Range>) {
    match *kind {
        JointKind::Ball { limit: Some(limit) } => (Some(limit), Some(limit.twist)),
        JointKind::Universal { limit } => (limit, None),
        JointKind::SixDof(six) => {
            let open = Range::symmetric(core::f32::consts::PI);
            let range = |motion: AxisMotion| match motion {
                AxisMotion::Limited(range) => Some(range),
                _ => None,
            };
            let (y, z) = (range(six.swing_y), range(six.swing_z));
            let cone = (y.is_some() || z.is_some()).then(|| SwingTwistLimit {
                swing_y: y.unwrap_or(open),
                swing_z: z.unwrap_or(open),
                twist: open,
            });
            (cone, range(six.twist))
        }
        _ => (None, None),
    }
}

fn linear_limits(kind: &JointKind) -> [Option<Range>; 3] {
    match *kind {
        JointKind::Slider { limit } => [limit, None, None],
        JointKind::Distance { range } if range.lo < range.hi => [Some(range), None, None],
        JointKind::SixDof(six) => six.linear.map(|motion| match motion {
            AxisMotion::Limited(range) => Some(range),
            _ => None,
        }),
        _ => [None; 3],
    }
}

fn twist_stops(twist: Range, relative: Rotation) -> [sinew_math::limits::LimitState; 2] {
    let free = Range::symmetric(core::f32::consts::PI);
    SwingTwistLimit { swing_y: free, swing_z: free, twist }.twist_states(relative)
}

/// How far a joint is beyond its limits of rotation, radians.
pub(crate) fn overshoot(kind: &JointKind, pose: &JointPose) -> f32 {
    let beyond = |stop: &Stop| if turns(stop.limit) { -stop.room } else { 0.0 };
    let stops = stops(kind, pose);
    stops.iter().flatten().map(beyond).fold(0.0, sinew_math::max)
}

/// How far the anchors are from where the joint allows them to be, metres.
pub(crate) fn anchor_gap(kind: &JointKind, pose: &JointPose) -> f32 {
    let locks = locks(kind);
    if locks[..TWIST] == [true; 3] {
        return pose.gap.length();
    }
    let mut square = 0.0;
    for i in (0..TWIST).filter(|&i| locks[i]) {
        let (error, _) = locked_row(kind, &locks, pose, i);
        square += error * error;
    }
    for stop in stops(kind, pose).into_iter().flatten().filter(|stop| !turns(stop.limit) && stop.room < 0.0) {
        square += stop.room * stop.room;
    }
    square.sqrt()
}
