//! Joint limits learned from motion: centre, ellipse of swing, range of twist, and which joints are hinges.

use crate::clip::take::Take;
use crate::rig::{JointIdx, LocalTransform, Rig};
pub use crate::tuning::COVERAGE;
use crate::tuning::{HINGE_PLAY, LEAST_HINGE};
use sinew_math::{
    Mat3, Range, Rotation, SwingTwistLimit, Sym3, Vec3, any_orthonormal, clamp, direction, max, min, trig,
};

/// A joint that rotates about only one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearnedHinge {
    /// Unit axis, in the joint's own axes.
    pub axis: Vec3,
    /// Range of the angle about the axis, radians from [`LearnedLimit::center`].
    pub range: Range,
    /// Remaining rotation about other axes, radians.
    pub off_axis: f32,
}

/// Joint limit that contains the joint's rotation in nearly all frames of all takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearnedLimit {
    /// Joint of the limit.
    pub joint: JointIdx,
    /// The joint's local rotation at the centre of its range.
    pub center: Rotation,
    /// Rotation from the axes of the limit to the joint's own: x along the bone, y and z along the axes of the swing's
    /// ellipse.
    pub frame: Rotation,
    /// Half-angles of the ellipse: swing about y, swing about z, radians.
    pub swing: [f32; 2],
    /// Range of the rotation about the bone, radians from the centre.
    pub twist: Range,
    /// Axis and range of a hinge; `None` for other joints.
    pub hinge: Option<LearnedHinge>,
    /// Number of frames that were used.
    pub samples: usize,
}

impl LearnedLimit {
    /// Returns the rotation away from the centre, in the axes of the limit.
    fn away(&self, local: Rotation) -> Rotation {
        let own = self.center.inverse() * local;
        (self.frame.inverse() * own * self.frame).normalize()
    }

    /// Returns the nearest local rotation within the limit: swing moved toward the centre, twist clamped. For a hinge,
    /// returns only the rotation about its axis.
    pub fn project(&self, local: Rotation) -> Rotation {
        if let Some(hinge) = self.hinge {
            let angle = (self.center.inverse() * local).twist_angle(hinge.axis);
            let angle = clamp(angle, hinge.range.lo, hinge.range.hi);
            return (self.center * Rotation::from_axis_angle(hinge.axis, angle)).normalize();
        }
        let (swing, twist) = SwingTwistLimit::angles(self.away(local));
        let (y, z) = (swing.y / max(self.swing[0], 1e-6), swing.z / max(self.swing[1], 1e-6));
        let over = max((y * y + z * z).sqrt(), 1.0);
        let kept_twist = clamp(twist, self.twist.lo, self.twist.hi);
        if over <= 1.0 && kept_twist == twist {
            return local;
        }
        let kept = Rotation::from_scaled_axis(swing / over) * Rotation::from_axis_angle(Vec3::X, kept_twist);
        (self.center * self.frame * kept * self.frame.inverse()).normalize()
    }

    /// Converts the limit to a swing-twist limit for a joint whose frames are `center * frame` on the parent and
    /// `frame` on the joint itself.
    pub fn swing_twist(&self) -> SwingTwistLimit {
        let [y, z] = self.swing.map(Range::symmetric);
        SwingTwistLimit { swing_y: y, swing_z: z, twist: self.twist }
    }
}

/// Learns the limits of every rotating joint of a rig from its motion in `takes`. One frame in two hundred may be
/// outside the limits. Angles are radians, of local rotations; the result is sorted by joint, without joints that have
/// no limit.
///
/// # Panics
/// If a take does not fit the rig.
pub fn learn_limits(rig: &Rig, takes: &[&Take]) -> Vec<LearnedLimit> {
    assert!(takes.iter().all(|take| take.joints == rig.joints.len()), "the takes must fit the rig");
    let learn = |joint: JointIdx| {
        let of_take = |take: &&Take| {
            take.of_joint(joint).map(|local: LocalTransform| local.rotation).collect::<Vec<_>>()
        };
        let turns: Vec<Rotation> = takes.iter().flat_map(of_take).filter(|turn| turn.is_finite()).collect();
        learn_limit(joint, bone(rig, joint), &turns)
    };
    (0..rig.joints.len()).filter_map(learn).collect()
}

/// Direction of a joint's bone in its own axes: to the furthest child; x if there is none.
fn bone(rig: &Rig, joint: JointIdx) -> Vec3 {
    let children = rig.joints.iter().filter(|child| child.parent == Some(joint));
    let farthest = children
        .map(|child| child.rest.translation)
        .reduce(|a, b| if b.length_squared() > a.length_squared() { b } else { a });
    farthest.and_then(direction).unwrap_or(Vec3::X)
}

/// Learns the limit of one joint from any number of its rotations, or of any two frames that rotate against each other.
/// `bone` is a unit vector in the joint's own axes. `None` if the joint does not rotate.
pub fn learn_limit(joint: JointIdx, bone: Vec3, turns: &[Rotation]) -> Option<LearnedLimit> {
    let mean = mean(turns)?;
    let across = any_orthonormal(bone);
    let frame = Rotation::from_mat3(&Mat3::from_cols(bone, across, bone.cross(across)));
    let whole = Range::new(0.0, 0.0);
    let mut limit = LearnedLimit {
        joint,
        center: mean,
        frame,
        swing: [0.0; 2],
        twist: whole,
        hinge: None,
        samples: turns.len(),
    };
    // The mean rotation is the start of the search for the centre of the range.
    limit.hinge = hinge(turns, mean);
    if let Some(hinge) = &mut limit.hinge {
        let middle = hinge.range.center();
        limit.center = (mean * Rotation::from_axis_angle(hinge.axis, middle)).normalize();
        hinge.range = Range::new(hinge.range.lo - middle, hinge.range.hi - middle);
    } else {
        limit.find_center(turns);
    }
    limit.turn_to_main_axes(turns);
    limit.measure(turns);
    let most = max(max(limit.swing[0], limit.swing[1]), limit.twist.hi - limit.twist.lo);
    (most > 1e-3).then_some(limit)
}

impl LearnedLimit {
    /// Returns twist about x and swing about y and z of every rotation, radians from the centre.
    fn angles(&self, turns: &[Rotation]) -> Vec<[f32; 3]> {
        let angles = |&turn: &Rotation| {
            let (swing, twist) = SwingTwistLimit::angles(self.away(turn));
            [twist, swing.y, swing.z]
        };
        turns.iter().map(angles).collect()
    }

    /// Moves the centre to the middle of the ranges of twist and swing.
    fn find_center(&mut self, turns: &[Rotation]) {
        for _ in 0..3 {
            let angles = self.angles(turns);
            let middle = [0, 1, 2].map(|k| covered(angles.iter().map(|angle| angle[k]).collect()).center());
            let step = self.frame * Vec3::from_array(middle);
            self.center = (self.center * Rotation::from_scaled_axis(step)).normalize();
        }
    }

    /// Rotates the frame about the bone so that y and z are the principal axes of the swing.
    fn turn_to_main_axes(&mut self, turns: &[Rotation]) {
        let (mut yy, mut zz, mut yz) = (0.0, 0.0, 0.0);
        for [_, y, z] in self.angles(turns) {
            (yy, zz, yz) = (yy + y * y, zz + z * z, yz + y * z);
        }
        let angle = 0.5 * trig::atan2(2.0 * yz, yy - zz);
        self.frame = (self.frame * Rotation::from_axis_angle(Vec3::X, angle)).normalize();
    }

    /// Measures the half-axes of an ellipse with the proportions of the swing's spread, and the range of the twist.
    fn measure(&mut self, turns: &[Rotation]) {
        let angles = self.angles(turns);
        let reach = [1, 2].map(|k| {
            let range = covered(angles.iter().map(|angle| angle[k]).collect());
            max(max(range.hi, -range.lo), 1e-5)
        });
        let radius = |angle: &[f32; 3]| {
            let (y, z) = (angle[1] / reach[0], angle[2] / reach[1]);
            (y * y + z * z).sqrt()
        };
        let mut radii: Vec<f32> = angles.iter().map(radius).collect();
        radii.sort_by(f32::total_cmp);
        let most = radii[at_share(radii.len(), COVERAGE)];
        self.swing = reach.map(|reach| min(reach * most, core::f32::consts::PI));
        self.twist = covered(angles.iter().map(|angle| angle[0]).collect());
    }
}

/// Returns the range of the central [`COVERAGE`] of all numbers.
///
/// # Panics
/// If there are no numbers.
pub fn covered(mut numbers: Vec<f32>) -> Range {
    numbers.sort_by(f32::total_cmp);
    let tail = 0.5 * (1.0 - COVERAGE);
    Range::new(numbers[at_share(numbers.len(), tail)], numbers[at_share(numbers.len(), 1.0 - tail)])
}

fn at_share(count: usize, share: f32) -> usize {
    ((count - 1) as f32 * share).round() as usize
}

/// Returns the mean of rotations: the rotations from the mean to all of them sum to zero (Karcher mean).
fn mean(turns: &[Rotation]) -> Option<Rotation> {
    let mut mean = *turns.first()?;
    for _ in 0..8 {
        let sum: Vec3 = turns.iter().map(|&turn| (mean.inverse() * turn).to_scaled_axis()).sum();
        mean = (mean * Rotation::from_scaled_axis(sum / turns.len() as f32)).normalize();
    }
    Some(mean)
}

/// Returns the single axis of a joint, or `None` if there is no such axis. The axis is the principal axis of the
/// rotations from `mean`; the range is measured from there.
fn hinge(turns: &[Rotation], mean: Rotation) -> Option<LearnedHinge> {
    let own: Vec<Rotation> = turns.iter().map(|&turn| (mean.inverse() * turn).normalize()).collect();
    let mut spread = Sym3::from_diagonal(Vec3::ZERO);
    for turn in &own {
        let outer = Sym3::outer(turn.to_scaled_axis());
        spread = Sym3 { diagonal: spread.diagonal + outer.diagonal, off: spread.off + outer.off };
    }
    let (_, axes) = spread.eigen();
    let axis = axes * Vec3::X;
    let range = covered(own.iter().map(|turn| turn.twist_angle(axis)).collect());
    let mut beside: Vec<f32> =
        own.iter().map(|turn| turn.swing_twist(axis).0.to_scaled_axis().length()).collect();
    beside.sort_by(f32::total_cmp);
    let off_axis = beside[at_share(beside.len(), COVERAGE)];
    let width = range.hi - range.lo;
    (width > LEAST_HINGE && off_axis < HINGE_PLAY * width).then_some(LearnedHinge { axis, range, off_axis })
}
