//! Settings for the angles, rotations and masses of a model, and conversion from its axes to ours.

use super::notes::Notes;
use super::xml::{Element, Value, children};
use crate::error::Result;
use sinew_math::{Mat3, Rotation, Vec3};

/// Settings for reading the numbers of a file.
pub(super) struct Compiler {
    angle: Angle,
    /// Axes of Euler angles in the file's frame, intrinsic or extrinsic.
    euler: [(Vec3, Axes); 3],
    /// Rule that decides whether a joint with a range is limited if the file does not say so.
    pub limits: Limits,
    pub inertia: InertiaFrom,
}

#[derive(Clone, Copy)]
enum Angle {
    Degrees,
    Radians,
}

/// Axes of Euler angles: moving or fixed.
#[derive(Clone, Copy)]
enum Axes {
    /// Intrinsic: the axes rotate with the preceding rotations.
    Moving,
    Fixed,
}

/// Rule that decides whether a joint with a range is limited if the file does not say so.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Limits {
    ByRange,
    OnlyIfSaid,
}

/// Source of the masses of bodies.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum InertiaFrom {
    /// Mass from `<inertial>` if present, otherwise from geoms.
    Either,
    Geoms,
    Inertial,
}

const IGNORED: [&str; 5] =
    ["boundmass", "boundinertia", "settotalmass", "balanceinertia", "inertiagrouprange"];

impl Compiler {
    /// Reads the settings of a document from its `<compiler>` elements; the last one wins.
    pub fn read(root: Element<'_>, notes: &mut Notes) -> Result<Self> {
        let mut compiler = Self {
            angle: Angle::Degrees,
            euler: [(Vec3::X, Axes::Moving), (Vec3::Y, Axes::Moving), (Vec3::Z, Axes::Moving)],
            limits: Limits::ByRange,
            inertia: InertiaFrom::Either,
        };
        for (_, element) in children(root).filter(|(tag, _)| *tag == "compiler") {
            for attribute in element.attributes() {
                compiler.set(Value::new(element, attribute), notes)?;
            }
        }
        Ok(compiler)
    }

    fn set(&mut self, value: Value<'_>, notes: &mut Notes) -> Result<()> {
        match value.key() {
            "angle" => {
                self.angle = value.word(&[("degree", Angle::Degrees), ("radian", Angle::Radians)])?;
            }
            "eulerseq" => self.euler = euler_sequence(value)?,
            "autolimits" => {
                self.limits = value.word(&[("true", Limits::ByRange), ("false", Limits::OnlyIfSaid)])?;
            }
            "inertiafromgeom" => {
                self.inertia = value.word(&[
                    ("auto", InertiaFrom::Either),
                    ("true", InertiaFrom::Geoms),
                    ("false", InertiaFrom::Inertial),
                ])?;
            }
            "coordinate" if value.text() != "local" => {
                return Err(value.unsupported("only local coordinates are read"));
            }
            key => {
                if let Some(known) = IGNORED.iter().find(|ignored| **ignored == key) {
                    notes.left_out(known);
                }
            }
        }
        Ok(())
    }

    /// Converts an angle of the file to radians.
    pub fn radians(&self, angle: f32) -> f32 {
        match self.angle {
            Angle::Degrees => angle.to_radians(),
            Angle::Radians => angle,
        }
    }

    /// Reads a rotation of the file, given by one of [`ORIENTATIONS`], in our axes.
    pub fn rotation(&self, value: Value<'_>) -> Result<Rotation> {
        let rotation = match value.key() {
            "quat" => quaternion(value, value.numbers()?)?,
            "axisangle" => {
                let [x, y, z, angle] = value.numbers()?;
                Rotation::from_axis_angle(direction(value, [x, y, z])?, self.radians(angle))
            }
            "euler" => self.euler_rotation(value.numbers()?),
            "xyaxes" => {
                let [a, b, c, d, e, f] = value.numbers()?;
                let (x, y) = (direction(value, [a, b, c])?, direction(value, [d, e, f])?);
                let z = x.cross(y);
                if z.length() < 1e-6 {
                    return Err(value.malformed("the two axes are parallel"));
                }
                Rotation::from_mat3_lossy(&Mat3::from_cols(x, y, z))
            }
            _ => Rotation::from_arc(Vec3::Z, direction(value, value.numbers()?)?),
        };
        Ok(turn_y_up(rotation.normalize()))
    }

    fn euler_rotation(&self, angles: [f32; 3]) -> Rotation {
        let mut rotation = Rotation::IDENTITY;
        for ((axis, axes), angle) in self.euler.into_iter().zip(angles) {
            let turn = Rotation::from_axis_angle(axis, self.radians(angle));
            rotation = match axes {
                Axes::Moving => rotation * turn,
                Axes::Fixed => turn * rotation,
            };
        }
        rotation
    }
}

/// Attributes for a rotation, of which an element may have at most one.
pub(super) const ORIENTATIONS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];

fn euler_sequence(value: Value<'_>) -> Result<[(Vec3, Axes); 3]> {
    let axis = |letter| match letter {
        'x' => Some((Vec3::X, Axes::Moving)),
        'y' => Some((Vec3::Y, Axes::Moving)),
        'z' => Some((Vec3::Z, Axes::Moving)),
        'X' => Some((Vec3::X, Axes::Fixed)),
        'Y' => Some((Vec3::Y, Axes::Fixed)),
        'Z' => Some((Vec3::Z, Axes::Fixed)),
        _ => None,
    };
    let axes: Option<Vec<_>> = value.text().chars().take(4).map(axis).collect();
    let axes = axes.and_then(|axes| axes.try_into().ok());
    axes.ok_or_else(|| value.malformed("takes three letters, each one of xyzXYZ"))
}

/// Reads a quaternion (w, x, y, z) of any length but 0, in the file's axes.
pub(super) fn quaternion(value: Value<'_>, [w, x, y, z]: [f32; 4]) -> Result<Rotation> {
    let rotation = Rotation::from_xyzw(x, y, z, w);
    if rotation.dot(rotation) < 1e-12 {
        return Err(value.malformed("a quaternion of 0 is no rotation"));
    }
    Ok(rotation.normalize())
}

/// Normalises a vector that is not zero, in the file's axes.
pub(super) fn direction(value: Value<'_>, vector: [f32; 3]) -> Result<Vec3> {
    let vector = Vec3::from_array(vector);
    let length = vector.length();
    if length < 1e-6 {
        return Err(value.malformed("the vector has no direction"));
    }
    Ok(vector / length)
}

/// Converts from the file's axes (x forward, y left, z up) to ours (x forward, y up, z right): an exact quarter turn
/// about x.
pub(super) fn y_up(v: Vec3) -> Vec3 {
    Vec3::new(v.x, v.z, -v.y)
}

/// Converts a rotation to our axes.
pub(super) fn turn_y_up(r: Rotation) -> Rotation {
    Rotation::from_xyzw(r.x, r.z, -r.y, r.w)
}
