//! Converts the `<joint>` elements of a body to one joint.

use super::compiler::{Compiler, Limits, direction, quaternion, turn_y_up, y_up};
use super::defaults::Merged;
use super::notes::Notes;
use super::xml::{Element, Value, malformed, unsupported};
use crate::error::{Result, quoted};
use core::f32::consts::PI;
use sinew_math::{Mat3, Range, Rotation, SwingTwistLimit, Transform, Vec3, clamp, max, min};
use sinew_physics::{AxisMotion, JointKind, SixDof, Softness, Spring};

/// Joints between a body and its parent.
pub(super) enum Freedom {
    /// No motion: the body is fixed to its parent.
    Welded,
    /// Free motion: the body has no joint to a parent.
    Free,
    /// A `<joint type="ball">`.
    Ball(Pivot),
    /// A `<joint type="slide">`.
    Slide(Pivot),
    /// One to three hinges, from the parent to the body.
    Hinges(Vec<Pivot>),
}

/// A `<joint>` of a body, in the body's frame. Type-dependent numbers are in radians, or metres for a slide.
pub(super) struct Pivot {
    name: String,
    anchor: Vec3,
    /// Unit axis of the joint.
    axis: Vec3,
    /// Range relative to the file's pose; `None`: unlimited.
    range: Option<Range>,
    /// Coordinate in the pose of the file.
    reference: f32,
    /// Coordinate at which the joint's spring rests, relative to the file's pose.
    spring_rest: f32,
    stiffness: f32,
    damping: f32,
    /// Largest friction torque or force, N·m or N.
    friction: f32,
}

/// Quantity in which the numbers of a joint are given.
#[derive(Clone, Copy, PartialEq)]
enum Measure {
    Angle,
    Length,
}

/// Largest cosine of the angle between hinges that count as perpendicular: within 6°.
const NEARLY_PERPENDICULAR: f32 = 0.1;
/// Distance of anchors above which the reader adds a note, metres.
const SAME_ANCHOR: f32 = 1e-3;

const UNREAD: [(&str, &str); 4] = [
    ("armature", "rotor inertia of joints"),
    ("springdamper", "springdamper"),
    ("solreflimit", "solreflimit"),
    ("solimplimit", "solimplimit"),
];

impl Freedom {
    /// Adds a `<joint>` to the joints that the body has so far.
    pub fn and_joint(self, joint: &Merged<'_, '_>, compiler: &Compiler, notes: &mut Notes) -> Result<Self> {
        let kind = joint.get("type").map_or("hinge", Value::text);
        let mut read = |measure| Pivot::read(joint, measure, compiler, notes);
        match (kind, self) {
            ("free", Self::Welded) => Ok(Self::Free),
            ("ball", Self::Welded) => Ok(Self::Ball(read(Measure::Angle)?)),
            ("slide", Self::Welded) => Ok(Self::Slide(read(Measure::Length)?)),
            ("hinge", Self::Welded) => Ok(Self::Hinges(vec![read(Measure::Angle)?])),
            ("hinge", Self::Hinges(mut hinges)) if hinges.len() < 3 => {
                hinges.push(read(Measure::Angle)?);
                Ok(Self::Hinges(hinges))
            }
            ("free" | "ball" | "slide" | "hinge", _) => {
                let what = "a body has one free joint, one ball joint, one slide, or up to three hinges";
                Err(unsupported(joint.element, what))
            }
            _ => Err(malformed(joint.element, format!("no joint of type {}", quoted(kind)))),
        }
    }

    /// Returns the names of the body's joints, joined by `+`; `None` if it has none.
    pub fn name(&self) -> Option<String> {
        match self {
            Self::Welded | Self::Free => None,
            Self::Ball(pivot) | Self::Slide(pivot) => Some(pivot.name.clone()),
            Self::Hinges(hinges) => {
                let names: Vec<_> = hinges.iter().map(|hinge| hinge.name.as_str()).collect();
                Some(names.join("+"))
            }
        }
    }

    /// Number of coordinates of the body relative to its parent.
    pub fn coordinates(&self) -> usize {
        match self {
            Self::Welded => 0,
            Self::Free => 7,
            Self::Ball(_) => 4,
            Self::Slide(_) => 1,
            Self::Hinges(hinges) => hinges.len(),
        }
    }

    /// Returns the displacement from the file's pose at `coordinates`, the numbers in `value`, for a body with a joint;
    /// in the body's axes, about the joint's anchor.
    pub fn motion(&self, coordinates: &[f32], value: Value<'_>) -> Result<Transform> {
        Ok(match (self, coordinates) {
            (Self::Ball(_), &[w, x, y, z]) => {
                Transform::new(Vec3::ZERO, turn_y_up(quaternion(value, [w, x, y, z])?))
            }
            (Self::Slide(slide), &[along]) => {
                Transform::from_translation(slide.axis * (along - slide.reference))
            }
            (Self::Hinges(hinges), angles) => {
                let turns = hinges.iter().zip(angles).map(|(hinge, angle)| (hinge, angle - hinge.reference));
                Transform::new(Vec3::ZERO, turned(turns))
            }
            _ => Transform::IDENTITY,
        })
    }
}

/// Rotation of a body by its hinges. MuJoCo applies them in order, each in the axes left by the previous ones.
fn turned<'a>(hinges: impl Iterator<Item = (&'a Pivot, f32)>) -> Rotation {
    hinges
        .fold(Rotation::IDENTITY, |turn, (hinge, angle)| turn * Rotation::from_axis_angle(hinge.axis, angle))
}

impl Pivot {
    fn read(
        joint: &Merged<'_, '_>,
        measure: Measure,
        compiler: &Compiler,
        notes: &mut Notes,
    ) -> Result<Self> {
        for (key, what) in UNREAD {
            if joint.get(key).is_some_and(|value| value.text().trim() != "0") {
                notes.left_out(what);
            }
        }
        let number = |key: &str| joint.get(key).map_or(Ok(0.0), Value::number);
        let not_negative = |key: &str| joint.get(key).map_or(Ok(0.0), Value::not_negative);
        let in_si = |number: f32| match measure {
            Measure::Angle => compiler.radians(number),
            Measure::Length => number,
        };
        let reference = in_si(number("ref")?);
        let position = joint.get("pos").map_or(Ok([0.0; 3]), Value::numbers)?;
        let axis = match joint.get("axis") {
            Some(value) => direction(value, value.numbers()?)?,
            None => Vec3::Z,
        };
        let range = read_range(joint, compiler.limits)?
            .map(|[lo, hi]| Range::new(in_si(lo) - reference, in_si(hi) - reference));
        let range = match measure {
            Measure::Angle => range.filter(|range| range.hi - range.lo < 2.0 * PI).map(whole_turns_off),
            Measure::Length => range,
        };
        Ok(Self {
            name: joint.element.attribute("name").unwrap_or_default().to_owned(),
            anchor: y_up(Vec3::from_array(position)),
            axis: y_up(axis),
            range,
            reference,
            spring_rest: in_si(number("springref")?) - reference,
            stiffness: not_negative("stiffness")?,
            damping: not_negative("damping")?,
            friction: not_negative("frictionloss")?,
        })
    }
}

/// Reads a range in the unit of the file; `None`: unlimited.
fn read_range(joint: &Merged<'_, '_>, limits: Limits) -> Result<Option<[f32; 2]>> {
    let Some(value) = joint.get("range") else { return Ok(None) };
    let by_range = limits == Limits::ByRange;
    let limited = match joint.get("limited") {
        None => by_range,
        Some(said) => said.word(&[("true", true), ("false", false), ("auto", by_range)])?,
    };
    let [lo, hi] = value.numbers()?;
    if limited && lo > hi {
        return Err(value.malformed("the lower end is above the upper one"));
    }
    Ok(limited.then_some([lo, hi]))
}

/// Shifts a range of angles by whole turns so that its centre is within ±π.
fn whole_turns_off(range: Range) -> Range {
    let turns = (range.center() / (2.0 * PI)).round() * (2.0 * PI);
    Range::new(range.lo - turns, range.hi - turns)
}

/// Joint of a body, in the body's frame.
pub(super) struct BodyJoint {
    /// Joint frame in the body's frame.
    pub frame: Transform,
    pub kind: JointKind,
    pub spring: Option<Spring>,
    /// Largest friction torque or force, N·m or N.
    pub friction: f32,
}

impl BodyJoint {
    /// Joint of a welded body.
    pub const WELD: Self =
        Self { frame: Transform::IDENTITY, kind: JointKind::Fixed, spring: None, friction: 0.0 };

    /// Joint of a ball, whose single range limits the total angle from the file's pose.
    pub fn of_ball(ball: &Pivot) -> Self {
        let limit = ball.range.map(|range| {
            let within = Range::symmetric(max(range.hi, 0.0));
            SwingTwistLimit { swing_y: within, swing_z: within, twist: within }
        });
        let frame = Transform::from_translation(ball.anchor);
        let spring = softest_spring(core::slice::from_ref(ball), Transform::IDENTITY);
        Self { frame, kind: JointKind::Ball { limit }, spring, friction: ball.friction }
    }

    /// Joint of a slider, along its axis.
    pub fn of_slide(slide: &Pivot) -> Self {
        let frame = Transform::new(slide.anchor, Rotation::from_arc(Vec3::X, slide.axis));
        let rest = Transform::from_translation(Vec3::X * slide.spring_rest);
        let spring = softest_spring(core::slice::from_ref(slide), rest);
        Self { frame, kind: JointKind::Slider { limit: slide.range }, spring, friction: slide.friction }
    }

    /// Joint of one to three perpendicular hinges, of which the first is nearest to the parent.
    ///
    /// The body rotates by `R₁ R₂ R₃`. With the **last** hinge's axis as x, the last hinge is exactly the twist. With
    /// two hinges the first one is exactly the swing. With three, `R₁ R₂` is a swing about both other axes and, to
    /// second order, a twist of `2 atan(tan ½θ₁ tan ½θ₂)`; the swings lie within an ellipse per quadrant instead of a
    /// rectangle. Hinges of limbs usually have the widest range last (hip flexion), where this approximation is best.
    pub fn of_hinges(hinges: &[Pivot], element: Element<'_>, notes: &mut Notes) -> Result<Self> {
        let axes = joint_axes(hinges, element)?;
        let kind = match hinges {
            [] => JointKind::Fixed,
            [hinge] => JointKind::Hinge { limit: hinge.range },
            [first, last] => JointKind::SixDof(SixDof {
                linear: [AxisMotion::Locked; 3],
                twist: within(last.range),
                swing_y: within(first.range.map(|range| swing(first, range, notes))),
                swing_z: AxisMotion::Locked,
            }),
            [first, middle, .., last] => {
                let open = Range::symmetric(PI);
                let mut side = |hinge: &Pivot| hinge.range.map_or(open, |range| swing(hinge, range, notes));
                let (swing_y, mut swing_z) = (side(first), side(middle));
                if middle.axis.dot(axes * Vec3::Z) < 0.0 {
                    swing_z = Range::new(-swing_z.hi, -swing_z.lo);
                }
                let limit = SwingTwistLimit { swing_y, swing_z, twist: last.range.unwrap_or(open) };
                JointKind::Ball { limit: Some(limit) }
            }
        };
        let at_rest = turned(hinges.iter().map(|hinge| (hinge, hinge.spring_rest)));
        let rest = Transform::new(Vec3::ZERO, axes.inverse() * at_rest * axes);
        let differs =
            |hinge: &Pivot| (hinge.stiffness, hinge.damping) != (hinges[0].stiffness, hinges[0].damping);
        if hinges.iter().any(differs) {
            notes.changed(format!("springs of {} differ; all became the softest", names(hinges)));
        }
        Ok(Self {
            frame: Transform::new(shared_anchor(hinges, notes), axes),
            kind,
            spring: softest_spring(hinges, rest),
            friction: hinges.iter().map(|hinge| hinge.friction).fold(0.0, max),
        })
    }
}

fn within(range: Option<Range>) -> AxisMotion {
    range.map_or(AxisMotion::Free, AxisMotion::Limited)
}

/// Converts the range of a hinge to a swing range: at most half a turn each way, and including 0.
fn swing(hinge: &Pivot, range: Range, notes: &mut Notes) -> Range {
    if range.lo > 0.0 || range.hi < 0.0 {
        let name = quoted(&hinge.name);
        notes.changed(format!("the range of {name} is widened to hold the pose of the file"));
    }
    Range::new(clamp(range.lo, -PI, 0.0), clamp(range.hi, 0.0, PI))
}

/// Returns the softest spring of a body's joints, so that no direction is stiffer than in the file.
fn softest_spring(pivots: &[Pivot], rest: Transform) -> Option<Spring> {
    let least = |of: fn(&Pivot) -> f32| pivots.iter().map(of).reduce(min).unwrap_or_default();
    let (stiffness, damping) = (least(|pivot| pivot.stiffness), least(|pivot| pivot.damping));
    let softness = Softness::Stiffness { stiffness, damping };
    (stiffness > 0.0 || damping > 0.0).then_some(Spring { softness, rest })
}

fn names(hinges: &[Pivot]) -> String {
    let names: Vec<_> = hinges.iter().map(|hinge| quoted(&hinge.name)).collect();
    names.join(" and ")
}

/// Returns the axes of the joint in the body's frame: x along the last hinge, y along the first of several.
fn joint_axes(hinges: &[Pivot], element: Element<'_>) -> Result<Rotation> {
    let [first, .., last] = hinges else {
        let one = hinges.first();
        return Ok(one.map_or(Rotation::IDENTITY, |hinge| Rotation::from_arc(Vec3::X, hinge.axis)));
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

/// Returns the mean anchor of the hinges, in the body's frame.
fn shared_anchor(hinges: &[Pivot], notes: &mut Notes) -> Vec3 {
    let sum: Vec3 = hinges.iter().map(|hinge| hinge.anchor).sum();
    let apart = hinges.iter().map(|hinge| (hinge.anchor - hinges[0].anchor).length()).fold(0.0, max);
    if apart > SAME_ANCHOR {
        let names = names(hinges);
        notes.changed(format!("{names} are {apart:.3} m apart; they became one, in the middle"));
    }
    sum / max(hinges.len() as f32, 1.0)
}
