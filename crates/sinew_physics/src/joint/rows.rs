//! Constraint rows and stops of a joint at a pose.

use super::def::{AxisMotion, JointKind};
use crate::spatial::{Vec6, ZERO6, angular, join, linear};
use sinew_math::limits::{LimitState, hinge_angle, wrap};
use sinew_math::{Range, Rotation, SwingTwistLimit, Transform, Vec3};

/// Directions of a joint: translation along x, y, z of frame A (along the line between the anchors for a distance),
/// then twist about x, swing about y and z.
pub(crate) const DIRECTIONS: usize = 6;
/// Index of the first rotation among the directions.
pub(crate) const TWIST: usize = 3;

/// Definition of a joint without state: the geometry of its rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointGeometry {
    pub frame_a: Transform,
    pub frame_b: Transform,
    pub kind: JointKind,
}

/// Frames of a joint in the world, and the arms of its anchors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointPose {
    /// Vector from A's centre of mass to A's anchor, world, metres, and the same for B.
    pub arm_a: Vec3,
    pub arm_b: Vec3,
    /// Position of B's anchor minus that of A's, world, metres.
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

    /// Rotation of frame B relative to frame A.
    pub fn relative(&self) -> Rotation {
        self.rotation_a.inverse() * self.rotation_b
    }

    /// Frame B relative to frame A.
    pub fn a_from_b(&self) -> Transform {
        Transform::new(self.rotation_a.inverse() * self.gap, self.relative())
    }

    /// Unit direction from A's anchor to B's; x of frame A where the anchors coincide.
    fn line(&self) -> Vec3 {
        let length = self.gap.length();
        if length > 1e-6 { self.gap / length } else { self.rotation_a * Vec3::X }
    }

    fn axis(&self, i: usize) -> Vec3 {
        self.rotation_a * [Vec3::X, Vec3::Y, Vec3::Z][i]
    }
}

/// Jacobian of one row on both bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    pub a: Vec6,
    pub b: Vec6,
}

impl Row {
    /// Row for the rate of the anchors' distance along a direction fixed in the world.
    fn along(direction: Vec3, pose: &JointPose) -> Self {
        Self {
            a: join(-direction, -pose.arm_a.cross(direction)),
            b: join(direction, pose.arm_b.cross(direction)),
        }
    }

    /// Row for the rate of the anchors' distance along a direction that rotates with A.
    fn along_turning(direction: Vec3, pose: &JointPose) -> Self {
        Self {
            a: join(-direction, -(pose.arm_a + pose.gap).cross(direction)),
            b: join(direction, pose.arm_b.cross(direction)),
        }
    }

    /// Row for the rate of rotation of B relative to A about an axis.
    fn about(axis: Vec3) -> Self {
        Self { a: join(Vec3::ZERO, -axis), b: join(Vec3::ZERO, axis) }
    }
}

/// Rows `J_a v_a + J_b v_b` of one joint: rows of locked directions first, then those of open directions.
///
/// Each row has an axis. A translation row measures the anchors' motion along the axis, a rotation row the frames'
/// rotation about the axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointRows {
    /// Number of rows.
    pub count: usize,
    /// Number of rows of locked directions, which come first.
    pub locked: usize,
    /// Position error of the locked rows, metres or radians.
    pub error: Vec6,
    /// World vectors from the centres of mass to the points at which translation rows act, metres.
    pub arm_a: Vec3,
    pub arm_b: Vec3,
    /// World axis of each row.
    pub axis: [Vec3; DIRECTIONS],
    /// Direction of each row, 0 to 5.
    direction: [u8; DIRECTIONS],
}

impl JointRows {
    /// No rows.
    pub const NONE: Self = Self {
        count: 0,
        locked: 0,
        error: ZERO6,
        arm_a: Vec3::ZERO,
        arm_b: Vec3::ZERO,
        axis: [Vec3::ZERO; DIRECTIONS],
        direction: [0; DIRECTIONS],
    };

    /// Rows of all locked directions, and of the free directions requested by `open`.
    pub fn new(joint: &JointGeometry, pose: &JointPose, open: [bool; DIRECTIONS]) -> Self {
        let kind = &joint.kind;
        let locks = locks(kind);
        let arm_a = if turns_with_a(kind, &locks) { pose.arm_a + pose.gap } else { pose.arm_a };
        let mut rows = Self { arm_a, arm_b: pose.arm_b, ..Self::NONE };
        each_locked(kind, &locks, pose, |direction, error, axis| rows.push(direction, error, axis));
        rows.locked = rows.count;
        if open != [false; DIRECTIONS] {
            for i in open_directions(*kind).filter(|&i| open[i]) {
                rows.push(i, 0.0, open_axis(kind, &locks, pose, i));
            }
        }
        rows
    }

    #[inline(always)]
    fn push(&mut self, direction: usize, error: f32, axis: Vec3) {
        self.error[self.count] = error;
        self.direction[self.count] = direction as u8;
        self.axis[self.count] = axis;
        self.count += 1;
    }

    /// Direction of a row.
    #[inline(always)]
    pub fn direction(&self, row: usize) -> usize {
        usize::from(self.direction[row])
    }

    /// True for a row of rotation.
    #[inline(always)]
    pub fn turns(&self, row: usize) -> bool {
        self.direction(row) >= TWIST
    }

    /// True if the anchors are locked together. The first three rows are then along the axes of the world.
    pub fn locks_point(&self) -> bool {
        self.locked >= TWIST && self.direction(TWIST - 1) < TWIST
    }

    /// Jacobian of a row on A.
    pub fn on_a(&self, row: usize) -> Vec6 {
        self.jacobian(row, self.arm_a).map(|x| -x)
    }

    /// Jacobian of a row on B.
    pub fn on_b(&self, row: usize) -> Vec6 {
        self.jacobian(row, self.arm_b)
    }

    fn jacobian(&self, row: usize, arm: Vec3) -> Vec6 {
        let axis = self.axis[row];
        if self.turns(row) { join(Vec3::ZERO, axis) } else { join(axis, arm.cross(axis)) }
    }

    /// Returns the total impulse of the rows, linear and angular: about the centre of A, and about that of B. Subtract
    /// the first from A's momentum, and add the second to B's.
    pub fn impulse(&self, of_rows: &Vec6) -> [Vec6; 2] {
        let [x, y, z, ..] = *of_rows;
        let (first, mut force) =
            if self.locks_point() { (TWIST, Vec3::new(x, y, z)) } else { (0, Vec3::ZERO) };
        let mut torque = Vec3::ZERO;
        for row in first..self.count {
            let part = self.axis[row] * of_rows[row];
            *(if self.turns(row) { &mut torque } else { &mut force }) += part;
        }
        [self.arm_a, self.arm_b].map(|arm| join(force, torque + arm.cross(force)))
    }

    /// Computes `J v`, row by row, for the velocities of A and B.
    #[inline]
    pub fn rate(&self, a: &Vec6, b: &Vec6) -> Vec6 {
        let turn = angular(b) - angular(a);
        let slide = (linear(b) + angular(b).cross(self.arm_b)) - (linear(a) + angular(a).cross(self.arm_a));
        let mut out = ZERO6;
        let mut first = 0;
        if self.locks_point() {
            [out[0], out[1], out[2]] = slide.to_array();
            first = TWIST;
        }
        for row in first..self.count {
            out[row] = self.axis[row].dot(if self.turns(row) { turn } else { slide });
        }
        out
    }
}

/// True if translation rows rotate with A. The rows of a locked point and of a distance do not.
fn turns_with_a(kind: &JointKind, locks: &[bool; 6]) -> bool {
    locks[..TWIST] != [true; 3] && !matches!(kind, JointKind::Distance { .. })
}

/// Position errors of the locked directions, in the row order of [`JointRows`], metres or radians.
pub(crate) fn locked_error(joint: &JointGeometry, pose: &JointPose) -> Vec6 {
    let (mut all, mut count) = (ZERO6, 0);
    each_locked(&joint.kind, &locks(&joint.kind), pose, |_, error, _| {
        all[count] = error;
        count += 1;
    });
    all
}

/// True for each locked direction.
#[inline]
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

/// True if the joint has this direction: a distance joint has only one translation.
fn exists(kind: &JointKind, direction: usize) -> bool {
    !matches!(kind, JointKind::Distance { .. }) || direction == 0
}

/// Calls `put` with direction, error and axis of each locked direction, in ascending order.
#[inline(always)]
fn each_locked(kind: &JointKind, locks: &[bool; 6], pose: &JointPose, mut put: impl FnMut(usize, f32, Vec3)) {
    if let JointKind::Distance { range } = kind {
        if locks[0] {
            put(0, pose.gap.length() - range.lo, pose.line());
        }
        return;
    }
    if locks[..TWIST] == [true; 3] {
        // For a point any axes are valid; world axes need no rotation.
        put(0, pose.gap.x, Vec3::X);
        put(1, pose.gap.y, Vec3::Y);
        put(2, pose.gap.z, Vec3::Z);
    } else {
        for i in (0..TWIST).filter(|&i| locks[i]) {
            let axis = pose.axis(i);
            put(i, axis.dot(pose.gap), axis);
        }
    }
    let [twist, swing_y, swing_z] = [locks[TWIST], locks[4], locks[5]];
    if twist && swing_y && swing_z {
        let error = pose.relative().to_scaled_axis();
        for (i, error) in [error.x, error.y, error.z].into_iter().enumerate() {
            put(TWIST + i, error, pose.axis(i));
        }
        return;
    }
    let ra = pose.rotation_a;
    if twist {
        // The twist rate is ω·(x_a + x_b)/(1 + x_a·x_b). C = ½ (1 + x_a·x_b) θ vanishes where a swing of half a turn
        // leaves the twist θ undefined, instead of growing without bound: Ċ = ω · ½ (x_a + x_b + θ x_b × x_a).
        let (swing, twist) = pose.relative().swing_twist(Vec3::X);
        let (x_b, angle) = (swing * Vec3::X, twist.twist_angle(Vec3::X));
        let sum = Vec3::X + x_b;
        put(TWIST, angle * 0.5 * sum.x, ra * ((sum + x_b.cross(Vec3::X) * angle) * 0.5));
    }
    // C = −z_a · x_b and y_a · x_b keep x_b out of the planes it would swing into. Ċ = (x_b × y_a) · (ω_b − ω_a).
    if swing_y || swing_z {
        let x_b = pose.rotation_b * Vec3::X;
        if swing_y {
            let z = ra * Vec3::Z;
            put(4, -z.dot(x_b), z.cross(x_b));
        }
        if swing_z {
            let y = ra * Vec3::Y;
            put(5, y.dot(x_b), x_b.cross(y));
        }
    }
}

/// Number of locked directions.
pub(crate) fn locked_count(kind: &JointKind) -> usize {
    locks(kind).iter().filter(|&&lock| lock).count()
}

/// Directions of the joint that are not locked.
pub(crate) fn open_directions(kind: JointKind) -> impl Iterator<Item = usize> {
    let locks = locks(&kind);
    (0..DIRECTIONS).filter(move |&i| !locks[i] && exists(&kind, i))
}

/// Row of an open direction.
pub(crate) fn open_row(kind: &JointKind, pose: &JointPose, direction: usize) -> Row {
    let locks = locks(kind);
    let axis = open_axis(kind, &locks, pose, direction);
    match direction {
        TWIST.. => Row::about(axis),
        _ if turns_with_a(kind, &locks) => Row::along_turning(axis, pose),
        _ => Row::along(axis, pose),
    }
}

/// Axis of an open direction.
fn open_axis(kind: &JointKind, locks: &[bool; 6], pose: &JointPose, direction: usize) -> Vec3 {
    match direction {
        0 if matches!(kind, JointKind::Distance { .. }) => pose.line(),
        0..TWIST => pose.axis(direction),
        // With one swing locked, the twist axis rotates with B.
        TWIST if locks[4] != locks[5] => pose.rotation_b * Vec3::X,
        _ => pose.axis(direction - TWIST),
    }
}

/// Deviation in an open direction from a requested pose of frame B in frame A, metres or radians.
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

/// Largest number of stops of a joint: swing, twist below and above, then below and above for x, y, z.
pub(crate) const MAX_STOPS: usize = 9;
/// Number of limits of a joint: swing, twist, x, y, z. Opposite stops share the stored impulse of a limit.
pub(crate) const MAX_LIMITS: usize = 5;

/// Limit of a free motion in one direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stop {
    /// Index of the stop's stored impulse among the joint's limits.
    pub limit: usize,
    /// Remaining distance to the stop, metres or radians; negative beyond the stop.
    pub slack: f32,
    /// Gradient of the slack in frame A: rotation for the first two limits, translation for the others.
    pub axis: Vec3,
}

impl Stop {
    /// Row for the rate of the slack.
    pub fn row(&self, kind: &JointKind, pose: &JointPose) -> Row {
        let axis = pose.rotation_a * self.axis;
        if turns(self.limit) {
            Row::about(axis)
        } else if let JointKind::Distance { .. } = kind {
            Row::along(axis, pose)
        } else {
            Row::along_turning(axis, pose)
        }
    }
}

/// True if the limit with this index limits a rotation.
pub(crate) fn turns(limit: usize) -> bool {
    limit < 2
}

/// The stops of a joint, each in its slot; missing ones are `None`.
pub(crate) fn stops(kind: &JointKind, pose: &JointPose) -> [Option<Stop>; MAX_STOPS] {
    let mut out = [None; MAX_STOPS];
    each_stop(kind, pose, [f32::INFINITY; 2], |place, stop| out[place] = Some(stop));
    out
}

/// Calls `put` for the stops of a joint in slot order. May omit stops with more slack than the given distance and
/// angle, which saves computing their axes.
#[inline]
pub(crate) fn each_stop(
    kind: &JointKind,
    pose: &JointPose,
    [slide, turn]: [f32; 2],
    mut put: impl FnMut(usize, Stop),
) {
    let (cone, twist_range) = rotation_limits(kind);
    if cone.is_some() || twist_range.is_some() {
        let (swing, twist) = pose.relative().swing_twist(Vec3::X);
        if let Some(LimitState { slack, axis }) = cone.and_then(|limit| limit.swing_within(swing, turn)) {
            put(0, Stop { limit: 0, slack, axis });
        }
        if let Some(states) = twist_range.and_then(|range| twist_only(range).twist_within(swing, twist, turn))
        {
            for (place, LimitState { slack, axis }) in (1..).zip(states) {
                put(place, Stop { limit: 1, slack, axis });
            }
        }
    } else if let JointKind::Hinge { limit: Some(range) } = kind {
        // The angle is measured from the middle of the range and wrapped, like a twist.
        let half = 0.5 * (range.hi - range.lo);
        let angle = wrap(hinge_angle(pose.relative()) - range.center());
        if half - angle.abs() < turn {
            put(1, Stop { limit: 1, slack: half + angle, axis: Vec3::X });
            put(2, Stop { limit: 1, slack: half - angle, axis: -Vec3::X });
        }
    }
    for (i, range) in linear_limits(kind).into_iter().enumerate() {
        let Some(range) = range else { continue };
        let (at, axis) = if let JointKind::Distance { .. } = kind {
            (pose.gap.length(), pose.rotation_a.inverse() * pose.line())
        } else {
            (pose.axis(i).dot(pose.gap), [Vec3::X, Vec3::Y, Vec3::Z][i])
        };
        let (below, above) = (at - range.lo, range.hi - at);
        if below < slide || above < slide {
            put(3 + 2 * i, Stop { limit: 2 + i, slack: below, axis });
            put(4 + 2 * i, Stop { limit: 2 + i, slack: above, axis: -axis });
        }
    }
}

/// Cone and twist range of a joint; a hinge's range is not included.
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

fn twist_only(twist: Range) -> SwingTwistLimit {
    let free = Range::symmetric(core::f32::consts::PI);
    SwingTwistLimit { swing_y: free, swing_z: free, twist }
}

/// Largest angle beyond a rotation limit, radians; 0 inside.
pub(crate) fn overshoot(kind: &JointKind, pose: &JointPose) -> f32 {
    let beyond = |stop: &Stop| if turns(stop.limit) { -stop.slack } else { 0.0 };
    let stops = stops(kind, pose);
    stops.iter().flatten().map(beyond).fold(0.0, sinew_math::max)
}

/// Distance of the anchors from their allowed range, metres.
pub(crate) fn anchor_gap(kind: &JointKind, pose: &JointPose) -> f32 {
    let locks = locks(kind);
    if locks[..TWIST] == [true; 3] {
        return pose.gap.length();
    }
    let mut square = 0.0;
    each_locked(kind, &locks, pose, |direction, error, _| {
        square += if direction < TWIST { error * error } else { 0.0 };
    });
    for stop in stops(kind, pose).into_iter().flatten().filter(|stop| !turns(stop.limit) && stop.slack < 0.0)
    {
        square += stop.slack * stop.slack;
    }
    square.sqrt()
}
