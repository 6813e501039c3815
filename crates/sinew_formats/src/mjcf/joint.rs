//! From the hinges of a body to one joint.

use super::compiler::{Compiler, Limits, direction, y_up};
use super::defaults::Merged;
use super::notes::Notes;
use super::xml::{Element, Value, unsupported};
use crate::error::{Result, quoted};
use core::f32::consts::PI;
use sinew_math::{Mat3, Range, Rotation, SwingTwistLimit, Transform, Vec3, clamp, max};
use sinew_physics::JointKind;

/// What lets a body move in its parent.
pub(super) enum Freedom {
    /// Nothing: it is a part of its parent.
    Welded,
    /// All: it has no parent.
    Free,
    /// A `<joint type="ball">`.
    Ball(Pivot),
    /// One to three hinges, from the parent to the body.
    Hinges(Vec<Pivot>),
}

/// A `<joint>` of a body, in the body's frame.
pub(super) struct Pivot {
    pub name: String,
    anchor: Vec3,
    /// Of a hinge: of length 1.
    pub axis: Vec3,
    /// Radians from the pose of the file; `None`: unlimited.
    range: Option<Range>,
    /// Joint coordinate in the pose of the file, radians.
    pub reference: f32,
    /// N·m.
    pub friction: f32,
}

/// Cosine of the angle between hinges that are taken to be at right angles: 6° from it.
const NEARLY_PERPENDICULAR: f32 = 0.1;
/// Anchors that are farther apart are worth a note, metres.
const SAME_ANCHOR: f32 = 1e-3;

const UNREAD: [(&str, &str); 5] = [
    ("damping", "damping of joints"),
    ("stiffness", "springs of joints"),
    ("armature", "rotor inertia of joints"),
    ("solreflimit", "solreflimit"),
    ("solimplimit", "solimplimit"),
];

impl Freedom {
    /// Adds a `<joint>` to what the body has so far.
    pub fn and_joint(self, joint: &Merged<'_, '_>, compiler: &Compiler, notes: &mut Notes) -> Result<Self> {
        let kind = joint.get("type").map_or("hinge", Value::text);
        match (kind, self) {
            ("free", Self::Welded) => Ok(Self::Free),
            ("ball", Self::Welded) => Ok(Self::Ball(Pivot::read(joint, compiler, notes)?)),
            ("hinge", Self::Welded) => Ok(Self::Hinges(vec![Pivot::read(joint, compiler, notes)?])),
            ("hinge", Self::Hinges(mut hinges)) if hinges.len() < 3 => {
                hinges.push(Pivot::read(joint, compiler, notes)?);
                Ok(Self::Hinges(hinges))
            }
            ("free" | "ball" | "hinge", _) => {
                let what = "a body has one free joint, one ball joint, or up to three hinges";
                Err(unsupported(joint.element, what))
            }
            _ => Err(unsupported(joint.element, format!("joints of type {} are not read", quoted(kind)))),
        }
    }

    /// Names of its joints, if there are any.
    pub fn name(&self) -> Option<String> {
        match self {
            Self::Welded | Self::Free => None,
            Self::Ball(ball) => Some(ball.name.clone()),
            Self::Hinges(hinges) => {
                let names: Vec<_> = hinges.iter().map(|hinge| hinge.name.as_str()).collect();
                Some(names.join("+"))
            }
        }
    }

    /// Numbers that say where the body is in its parent.
    pub fn coordinates(&self) -> usize {
        match self {
            Self::Welded => 0,
            Self::Free => 7,
            Self::Ball(_) => 4,
            Self::Hinges(hinges) => hinges.len(),
        }
    }
}

impl Pivot {
    fn read(joint: &Merged<'_, '_>, compiler: &Compiler, notes: &mut Notes) -> Result<Self> {
        for (key, what) in UNREAD {
            if joint.get(key).is_some_and(|value| value.text().trim() != "0") {
                notes.left_out(what);
            }
        }
        let reference = compiler.radians(joint.get("ref").map_or(Ok(0.0), Value::number)?);
        let position = joint.get("pos").map_or(Ok([0.0; 3]), Value::numbers)?;
        let axis = match joint.get("axis") {
            Some(value) => direction(value, value.numbers()?)?,
            None => Vec3::Z,
        };
        Ok(Self {
            name: joint.element.attribute("name").unwrap_or_default().to_owned(),
            anchor: y_up(Vec3::from_array(position)),
            axis: y_up(axis),
            range: read_range(joint, compiler, reference)?,
            reference,
            friction: joint.get("frictionloss").map_or(Ok(0.0), Value::not_negative)?,
        })
    }
}

/// Radians from the pose of the file.
fn read_range(joint: &Merged<'_, '_>, compiler: &Compiler, reference: f32) -> Result<Option<Range>> {
    let Some(value) = joint.get("range") else { return Ok(None) };
    let by_range = compiler.limits == Limits::ByRange;
    let limited = match joint.get("limited") {
        None => by_range,
        Some(said) => said.word(&[("true", true), ("false", false), ("auto", by_range)])?,
    };
    let [lo, hi] = value.numbers()?;
    if !limited {
        return Ok(None);
    }
    if lo > hi {
        return Err(value.malformed("the lower end is above the upper one"));
    }
    let from_file = |angle: f32| compiler.radians(angle) - reference;
    let range = Range::new(from_file(lo), from_file(hi));
    Ok(Some(whole_turns_off(range)).filter(|range| range.hi - range.lo < 2.0 * PI))
}

/// The same range with its middle within ±π.
fn whole_turns_off(range: Range) -> Range {
    let turns = (range.center() / (2.0 * PI)).round() * (2.0 * PI);
    Range::new(range.lo - turns, range.hi - turns)
}

/// The joint that a freedom becomes, as the body sees it.
pub(super) struct BodyJoint {
    /// Joint frame in the body's frame.
    pub frame: Transform,
    pub kind: JointKind,
    /// N·m.
    pub friction: f32,
}

impl BodyJoint {
    /// Of a welded body.
    pub const WELD: Self = Self { frame: Transform::IDENTITY, kind: JointKind::Fixed, friction: 0.0 };

    /// Of a ball joint, whose one range is that of the whole angle from the pose of the file.
    pub fn of_ball(ball: &Pivot) -> Self {
        let limit = ball.range.map(|range| {
            let within = Range::symmetric(range.hi);
            SwingTwistLimit { swing_y: within, swing_z: within, twist: within }
        });
        let frame = Transform::from_translation(ball.anchor);
        Self { frame, kind: JointKind::Ball { limit }, friction: ball.friction }
    }

    /// Of one to three hinges at right angles to each other, the first next to the parent.
    ///
    /// The body turns by `R₁ R₂ R₃`. A swing and a twist are `R₁ R₂ R₃` with the **last** hinge's axis as x: what that
    /// hinge does is the twist, exactly. With two hinges the first one is all of the swing, exactly. With three, `R₁ R₂`
    /// is a swing about both other axes and, to second order, a twist of `2 atan(tan ½θ₁ tan ½θ₂)`; and the swings lie
    /// within an ellipse for each quadrant, not within a rectangle. Hinges of limbs have the widest range last (bending
    /// a hip), for which this fits best.
    pub fn of_hinges(hinges: &[Pivot], element: Element<'_>, notes: &mut Notes) -> Result<Self> {
        let frame = Transform::new(shared_anchor(hinges, notes), joint_axes(hinges, element)?);
        let around = |range: Option<Range>| range.unwrap_or(Range::symmetric(PI));
        let kind = match hinges {
            [hinge] => JointKind::Hinge { limit: hinge.range },
            [first, rest @ .., last] => {
                let swing_z = match rest {
                    [middle] => {
                        let z = frame.rotation * Vec3::Z;
                        let range = swing(middle, notes);
                        if middle.axis.dot(z) < 0.0 { Range::new(-range.hi, -range.lo) } else { range }
                    }
                    _ => Range::symmetric(0.0),
                };
                let limit =
                    SwingTwistLimit { swing_y: swing(first, notes), swing_z, twist: around(last.range) };
                JointKind::Ball { limit: Some(limit) }
            }
            [] => JointKind::Fixed,
        };
        let friction = hinges.iter().map(|hinge| hinge.friction).fold(0.0, max);
        Ok(Self { frame, kind, friction })
    }
}

/// The range of a hinge as a swing: no more than half a turn each way, and 0 inside.
fn swing(hinge: &Pivot, notes: &mut Notes) -> Range {
    let Some(range) = hinge.range else { return Range::symmetric(PI) };
    if range.lo > 0.0 || range.hi < 0.0 {
        notes
            .changed(format!("the range of {} is widened to hold the pose of the file", quoted(&hinge.name)));
    }
    Range::new(clamp(range.lo, -PI, 0.0), clamp(range.hi, 0.0, PI))
}

/// Axes of the joint in the body's frame: x along the last hinge, y along the first of several.
fn joint_axes(hinges: &[Pivot], element: Element<'_>) -> Result<Rotation> {
    let [first, .., last] = hinges else {
        return Ok(hinges
            .first()
            .map_or(Rotation::IDENTITY, |hinge| Rotation::from_arc(Vec3::X, hinge.axis)));
    };
    for (index, a) in hinges.iter().enumerate() {
        if hinges[index + 1..].iter().any(|b| a.axis.dot(b.axis).abs() > NEARLY_PERPENDICULAR) {
            return Err(unsupported(element, "hinges of one body must be at right angles to each other"));
        }
    }
    let x = last.axis;
    let y = (first.axis - x * x.dot(first.axis)).normalize();
    Ok(Rotation::from_mat3(&Mat3::from_cols(x, y, x.cross(y))).normalize())
}

/// The one point about which the body turns, in its frame.
fn shared_anchor(hinges: &[Pivot], notes: &mut Notes) -> Vec3 {
    let sum: Vec3 = hinges.iter().map(|hinge| hinge.anchor).sum();
    let middle = sum / max(hinges.len() as f32, 1.0);
    let apart = hinges.iter().map(|hinge| (hinge.anchor - hinges[0].anchor).length()).fold(0.0, max);
    if apart > SAME_ANCHOR {
        let names: Vec<_> = hinges.iter().map(|hinge| quoted(&hinge.name)).collect();
        let names = names.join(" and ");
        notes
            .changed(format!("{names} are {apart:.3} m apart; here they turn about the point in the middle"));
    }
    middle
}
