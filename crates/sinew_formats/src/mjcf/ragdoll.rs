//! Converts a model to a ragdoll: one shape per body, joints that only rotate.

use super::{MjcfJoint, MjcfModel};
use crate::error::{Error, Result, quoted};
use core::f32::consts::{FRAC_PI_2, PI};
use sinew_math::{Mat3, Range, Rotation, SwingTwistLimit, Transform, Vec3, clamp};
use sinew_physics::{
    Aabb, AxisMotion, BodyKind, Hull, JointKind, MassProperties, Shape, ShapeDef, SixDof, Softness,
};
use sinew_ragdoll::{RagdollBodyDef, RagdollDef, RagdollJointDef};

/// Density of the ball that replaces the shape of a body without shapes, kg/m³.
const FLESH: f32 = 1000.0;

/// A character of an MJCF file as a ragdoll.
#[derive(Clone, Debug, PartialEq)]
pub struct MjcfRagdoll {
    /// Ragdoll in character space: the model's x is forward (+Z), its lowest point at y = 0. `joint` of a body is its
    /// index in the model; roles are derived from its name.
    pub def: RagdollDef,
    /// Spring of each joint.
    pub springs: Vec<Option<Softness>>,
    /// Notes on changes, one sentence each.
    pub notes: Vec<String>,
}

impl MjcfModel {
    /// Converts the model's first tree of moving bodies to a ragdoll.
    ///
    /// Several shapes of a body become their convex hull; a body without a shape gets a ball of its mass. Two hinges
    /// become a universal joint, whose range is an ellipse instead of a rectangle.
    ///
    /// # Errors
    /// If no body of the model moves, a joint slides or is a rod, or a body has no name.
    pub fn to_ragdoll(&self) -> Result<MjcfRagdoll> {
        let root = self.bodies.iter().position(|body| body.def.kind == BodyKind::Dynamic);
        let root =
            root.ok_or_else(|| Error::unsupported("no body moves, so there is no ragdoll", "worldbody"))?;
        let mut notes = Vec::new();
        let mut kept: Vec<usize> = vec![root];
        let mut joints: Vec<&MjcfJoint> = Vec::new();
        for joint in &self.joints {
            if joint.child != root && kept.contains(&joint.parent) {
                kept.push(joint.child);
                joints.push(joint);
            }
        }
        let own = |body: usize| kept.iter().position(|&one| one == body);
        // Forward is +x in the file and +Z here.
        let ahead = Transform::new(Vec3::ZERO, Rotation::from_axis_angle(Vec3::Y, -FRAC_PI_2));
        let shaped: Vec<(Shape, Transform)> =
            kept.iter().map(|&body| self.one_shape(body, &mut notes)).collect::<Result<_>>()?;
        let place = |at: usize| {
            let def = &self.bodies[kept[at]].def;
            ahead * Transform::new(def.position, def.rotation) * shaped[at].1
        };
        let bounds =
            (0..kept.len()).map(|at| shaped[at].0.aabb(&place(at))).reduce(|all: Aabb, one| all.merge(&one));
        let (floor, height) = bounds.map_or((0.0, 0.0), |all| (all.min.y, all.max.y - all.min.y));
        let lifted = Transform::from_translation(Vec3::Y * -floor);
        let body = |at: usize| RagdollBodyDef {
            bone: self.bodies[kept[at]].name.clone(),
            joint: kept[at],
            merged: Vec::new(),
            role: role_of(&self.bodies[kept[at]].name, at),
            confidence: 0.5,
            shape: shaped[at].0.clone(),
            character_from_body: lifted * place(at),
            mass: self.bodies[kept[at]].def.mass.unwrap_or_default().transformed(&shaped[at].1.inverse()),
        };
        let bodies: Vec<RagdollBodyDef> = (0..kept.len()).map(body).collect();
        let defs = joints.iter().zip(1..).map(|(joint, child)| {
            let parent = own(joint.parent).expect("joints of bodies that are kept");
            let [of_parent, of_child] = [parent, child].map(|at| shaped[at].1.inverse());
            turning(joint, &mut notes).map(|(kind, axes)| RagdollJointDef {
                parent,
                child,
                frame_parent: of_parent * joint.frame_a * axes,
                frame_child: of_child * joint.frame_b * axes,
                kind,
                friction_torque: joint.friction_torque,
            })
        });
        let defs: Vec<RagdollJointDef> = defs.collect::<Result<_>>()?;
        let pairs = self.excluded_pairs.iter().filter_map(|&(a, b)| Some((own(a)?, own(b)?)));
        let upright = Transform::new(Vec3::ZERO, Rotation::from_axis_angle(Vec3::X, -FRAC_PI_2));
        let def = RagdollDef {
            total_mass: bodies.iter().map(|body| body.mass.mass).sum(),
            bodies,
            joints: defs,
            disabled_pairs: pairs.map(|(a, b)| (usize::min(a, b), usize::max(a, b))).collect(),
            dropped_bones: Vec::new(),
            height,
            unit_scale: 1.0,
            up_axis: Vec3::Z,
            character_from_model: lifted * ahead * upright,
        };
        let springs = joints.iter().map(|joint| joint.spring.map(|spring| spring.softness));
        // A spring without stiffness is only a damper.
        let springs = springs
            .map(|softness| softness.filter(|s| !matches!(s, Softness::Stiffness { stiffness: 0.0, .. })));
        Ok(MjcfRagdoll { def, springs: springs.collect(), notes })
    }

    /// Returns the shape of a body, and the shape's frame in the body's frame.
    fn one_shape(&self, body: usize, notes: &mut Vec<String>) -> Result<(Shape, Transform)> {
        let MjcfBodyShapes { name, shapes, mass } = MjcfBodyShapes::of(self, body);
        if name.is_empty() {
            return Err(Error::unsupported(format!("body {body} has no name"), "worldbody"));
        }
        match shapes {
            [one] => Ok((one.shape.clone(), one.body_from_shape)),
            [] => {
                let radius = sinew_math::trig::cbrt(mass.mass / FLESH * 0.75 / PI);
                notes.push(format!("{} has no shape: it gets a ball of its mass", quoted(name)));
                Ok((Shape::Sphere { radius }, Transform::from_translation(mass.center)))
            }
            several => {
                let points: Vec<Vec3> = several.iter().flat_map(outline).collect();
                let hull = Hull::new(&points)
                    .map_err(|error| Error::unsupported(format!("{}: {error}", quoted(name)), "worldbody"))?;
                notes.push(format!("the {} shapes of {} became their hull", several.len(), quoted(name)));
                Ok((Shape::Hull(hull.into()), Transform::IDENTITY))
            }
        }
    }
}

struct MjcfBodyShapes<'a> {
    name: &'a str,
    shapes: &'a [ShapeDef],
    mass: MassProperties,
}

impl<'a> MjcfBodyShapes<'a> {
    fn of(model: &'a MjcfModel, body: usize) -> Self {
        let body = &model.bodies[body];
        Self { name: &body.name, shapes: &body.def.shapes, mass: body.def.mass.unwrap_or_default() }
    }
}

/// Returns points whose hull is the shape, or smaller by at most 4 % of its radius; in the body's frame.
fn outline(shape: &ShapeDef) -> Vec<Vec3> {
    let ball = |center: Vec3, radius: f32| {
        let mut points = Vec::new();
        for x in -1..=1_i8 {
            for y in -1..=1_i8 {
                for z in -1..=1_i8 {
                    let v = Vec3::new(f32::from(x), f32::from(y), f32::from(z));
                    if v != Vec3::ZERO {
                        points.push(center + v * (radius / v.length()));
                    }
                }
            }
        }
        points
    };
    let points = match shape.shape {
        Shape::Sphere { radius } => ball(Vec3::ZERO, radius),
        Shape::Capsule { half_height, radius } => {
            let end = Vec3::Y * half_height;
            [ball(end, radius), ball(-end, radius)].concat()
        }
        ref other => {
            let half = other.aabb(&Transform::IDENTITY);
            let corner = |i: usize| {
                let pick = |bit: usize, lo: f32, hi: f32| if i >> bit & 1 == 0 { lo } else { hi };
                let (lo, hi) = (half.min, half.max);
                Vec3::new(pick(0, lo.x, hi.x), pick(1, lo.y, hi.y), pick(2, lo.z, hi.z))
            };
            (0..8).map(corner).collect()
        }
    };
    points.into_iter().map(|p| shape.body_from_shape.point(p)).collect()
}

/// Returns the kind of the ragdoll's joint, and the transform from its frame to the frame of the MJCF joint.
fn turning(joint: &MjcfJoint, notes: &mut Vec<String>) -> Result<(JointKind, Transform)> {
    let unsupported = |what: &str| {
        let name = quoted(&joint.name);
        Err(Error::unsupported(format!("{name} {what}: joints of a ragdoll only rotate"), "worldbody"))
    };
    let (twist, swing) = match joint.kind {
        JointKind::Ball { .. } | JointKind::Hinge { .. } | JointKind::Universal { .. } | JointKind::Fixed => {
            return Ok((joint.kind, Transform::IDENTITY));
        }
        JointKind::SixDof(SixDof { linear, twist, swing_y, swing_z: AxisMotion::Locked })
            if linear == [AxisMotion::Locked; 3] =>
        {
            (twist, swing_y)
        }
        JointKind::Slider { .. } => return unsupported("slides"),
        _ => return unsupported("is a rod or has a motion that limbs lack"),
    };
    let range = |motion: AxisMotion| match motion {
        AxisMotion::Limited(range) => Range::new(clamp(range.lo, -PI, 0.0), clamp(range.hi, 0.0, PI)),
        AxisMotion::Free => Range::symmetric(PI),
        AxisMotion::Locked => Range::symmetric(0.0),
    };
    notes.push(format!("the two hinges {} became one joint with an elliptic range", quoted(&joint.name)));
    // The y axis remains that of the first hinge; z becomes the axis of the last hinge, which was x.
    let axes = Rotation::from_mat3(&Mat3::from_cols(-Vec3::Z, Vec3::Y, Vec3::X));
    let limit =
        SwingTwistLimit { swing_y: range(swing), swing_z: range(twist), twist: Range::symmetric(0.0) };
    Ok((JointKind::Universal { limit: Some(limit) }, Transform::new(Vec3::ZERO, axes)))
}

/// Returns the role given by a body's name, else `limb_n_0`.
fn role_of(name: &str, index: usize) -> String {
    let name = name.to_ascii_lowercase();
    let words: Vec<&str> = name.split(|c: char| !c.is_ascii_alphanumeric()).collect();
    let has = |parts: &[&str]| parts.iter().any(|part| name.contains(part));
    let is_left = name.starts_with("left") || name.ends_with("left") || words.contains(&"l");
    let is_right = name.starts_with("right") || name.ends_with("right") || words.contains(&"r");
    let part = match () {
        () if has(&["upperarm", "upper_arm", "humerus"]) => "UpperArm",
        () if has(&["lowerarm", "lower_arm", "forearm"]) => "LowerArm",
        () if has(&["upperleg", "upper_leg", "thigh", "femur"]) => "UpperLeg",
        () if has(&["lowerleg", "lower_leg", "shin", "shank", "calf", "knee"]) => "LowerLeg",
        () if has(&["hand", "wrist"]) => "Hand",
        () if has(&["foot", "ankle"]) => "Foot",
        () if has(&["toe"]) => "Toes",
        () if has(&["clavicle", "shoulder", "collar"]) => "Shoulder",
        () => "",
    };
    match (part, is_left, is_right) {
        ("", ..) => {}
        (part, true, false) => return format!("left{part}"),
        (part, false, true) => return format!("right{part}"),
        _ => {}
    }
    let middle = [
        (&["head"][..], "head"),
        (&["neck"], "neck"),
        (&["pelvis", "hips", "root", "butt"], "hips"),
        (&["upperchest", "upper_chest"], "upperChest"),
        (&["chest", "torso", "thorax"], "chest"),
        (&["waist", "spine", "abdomen", "lwaist"], "spine"),
    ];
    let found = middle.iter().find(|(words, _)| has(words)).map(|(_, role)| (*role).to_owned());
    found.unwrap_or_else(|| format!("limb_{index}_0"))
}
