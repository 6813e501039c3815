//! Settings that change results of the build stages: shapes, masses, limits, pairs.

use super::bodies::{named, no_bone};
use super::{BoneSettings, JointWish, Settings, SettingsError, ShapeWish};
use crate::build::{BuildOptions, BuildReport, Overrides, build_overridden};
use crate::def::{RagdollDef, RagdollJointDef};
use crate::doctor::{beyond_at_bind, scaled};
use crate::fit::{Fit, ShapeChoice};
use crate::limits::LimitSource;
use crate::masses::de_leva::Sex;
use core::f32::consts::PI;
use sinew_anim::roles::RigAnalysis;
use sinew_anim::{Rig, Take};
use sinew_math::{Range, SwingTwistLimit};
use sinew_physics::{JointKind, Shape};

/// Builds with the settings applied; the analysis is not changed any more.
pub(super) fn build(
    rig: &Rig,
    analysis: &RigAnalysis,
    options: &BuildOptions,
    settings: &Settings,
    takes: &[Take],
) -> Result<(RagdollDef, BuildReport), SettingsError> {
    let options = BuildOptions {
        shapes: settings.shapes.filter(|_| options.shapes == ShapeChoice::Auto).unwrap_or(options.shapes),
        mass: options.mass.or(settings.mass),
        sex: settings.sex.filter(|_| options.sex == Sex::Male).unwrap_or(options.sex),
        limits: settings.limits.filter(|_| options.limits == LimitSource::Anatomy).unwrap_or(options.limits),
    };
    let names: Vec<[String; 2]> = analysis
        .kept
        .iter()
        .map(|bone| [bone.role.name(), crate::build::joint_name(rig, bone.joint)])
        .collect();
    let wishes = Wishes::of(settings, &names)?;
    let overrides = Overrides {
        shape: &|body, fit, other| wishes.shape(body, fit, other),
        disable: wishes.pairs(&settings.disable, "disable_pairs")?,
        enable: wishes.pairs(&settings.enable, "enable_pairs")?,
        takes,
    };
    let (mut def, mut report) = build_overridden(rig, analysis, &options, &overrides)?;
    wishes.check_enabled(&def, settings)?;
    wishes.check_joints(&def, settings)?;
    wishes.check_masses(settings, options.mass)?;
    wishes.weigh(&mut def, options.mass);
    for joint in &mut def.joints {
        *joint = wishes.joint(joint);
    }
    report.notes.extend(def.joints.iter().filter_map(|joint| wishes.leaves_out_bind(&def, joint)));
    Ok((def, report))
}

/// The settings of each body.
struct Wishes<'a> {
    /// Role and bone of each body.
    names: &'a [[String; 2]],
    bodies: Vec<BoneSettings>,
}

impl<'a> Wishes<'a> {
    fn of(settings: &Settings, names: &'a [[String; 2]]) -> Result<Self, SettingsError> {
        let mut wishes = Self { names, bodies: vec![BoneSettings::default(); names.len()] };
        for (name, bone) in &settings.bones {
            let place = format!("bones.{name}");
            // A setting for a bone without a body has no effect, and its role may belong to a body.
            let only_a_role = BoneSettings { role: bone.role, ..BoneSettings::default() } == *bone;
            if bone.body == Some(super::BodyWish::Drop) || only_a_role && bone.role.is_some() {
                continue;
            }
            for body in wishes.named(name, &place)? {
                let is_both = names[body][0] != *name && names[body][1] != *name;
                let mirror = is_both && names[body][0].starts_with("right");
                wishes.bodies[body] = merged(wishes.bodies[body], bone, mirror);
            }
        }
        Ok(wishes)
    }

    /// Returns the bodies with that name.
    fn named(&self, name: &str, place: &str) -> Result<Vec<usize>, SettingsError> {
        let is = |body: &usize| named(name, &self.names[*body][0], &self.names[*body][1]);
        let found: Vec<usize> = (0..self.names.len()).filter(is).collect();
        if found.is_empty() {
            let known: Vec<String> = self.names.iter().flatten().cloned().collect();
            return Err(no_bone(name, &known, place));
        }
        Ok(found)
    }

    /// Returns pairs of bodies, the smaller index first.
    fn pairs(&self, pairs: &[[String; 2]], key: &str) -> Result<Vec<(usize, usize)>, SettingsError> {
        let mut out = Vec::new();
        for (index, [a, b]) in pairs.iter().enumerate() {
            let place = format!("{key}[{index}]");
            for &a in &self.named(a, &place)? {
                for &b in &self.named(b, &place)? {
                    if a != b {
                        out.push((usize::min(a, b), usize::max(a, b)));
                    }
                }
            }
        }
        Ok(out)
    }

    fn check_enabled(&self, def: &RagdollDef, settings: &Settings) -> Result<(), SettingsError> {
        for (index, pair) in settings.enable.iter().enumerate() {
            let place = format!("enable_pairs[{index}]");
            for (a, b) in self.pairs(core::slice::from_ref(pair), "enable_pairs")? {
                if def.joints.iter().any(|joint| (joint.parent, joint.child) == (a, b)) {
                    let what = format!("`{}` and `{}` are joined: they never collide", pair[0], pair[1]);
                    return Err(SettingsError::at(place, what));
                }
            }
        }
        Ok(())
    }

    /// Rejects settings that a body's joint does not have.
    fn check_joints(&self, def: &RagdollDef, settings: &Settings) -> Result<(), SettingsError> {
        let kept = settings.bones.iter().filter(|(_, bone)| bone.body != Some(super::BodyWish::Drop));
        for (name, bone) in kept {
            let asked = |key: &str, is_given: bool| is_given.then(|| format!("bones.{name}.{key}"));
            let swing = asked("limits_deg.swing_y", bone.swing_y.is_some())
                .or_else(|| asked("limits_deg.swing_z", bone.swing_z.is_some()));
            let twist = asked("limits_deg.twist", bone.twist.is_some());
            let any = swing.clone().or_else(|| twist.clone());
            let any_or_type = any
                .clone()
                .or_else(|| asked("type", bone.joint.is_some()))
                .or_else(|| asked("friction_torque", bone.friction_torque.is_some()));
            let Some(place) = &any_or_type else { continue };
            for body in self.named(name, place)? {
                let Some(joint) = def.joints.iter().find(|joint| joint.child == body) else {
                    let what = format!("`{name}` is the first body, which has no joint to a parent");
                    return Err(SettingsError::at(place.clone(), what));
                };
                let (place, what) = match (self.joint(joint).kind, &swing, &twist, &any) {
                    (JointKind::Hinge { .. }, Some(place), ..) => (
                        place,
                        format!("`{name}` is a hinge, which has `twist` only; \"type\": \"ball\" has swings"),
                    ),
                    (JointKind::Universal { .. }, _, Some(place), _) => {
                        (place, format!("`{name}` is a universal joint, which has swings only"))
                    }
                    (JointKind::Fixed, .., Some(place)) => (
                        place,
                        format!("`{name}` has a fixed joint, which has no limits; \"type\" sets another"),
                    ),
                    _ => continue,
                };
                return Err(SettingsError::at(place.clone(), what));
            }
        }
        Ok(())
    }

    /// Returns a note on ranges of the settings that leave out the bind pose.
    fn leaves_out_bind(&self, def: &RagdollDef, joint: &RagdollJointDef) -> Option<String> {
        let wish = &self.bodies[joint.child];
        [wish.swing_y, wish.swing_z, wish.twist].iter().any(Option::is_some).then_some(())?;
        let beyond = beyond_at_bind(def, joint).to_degrees();
        (beyond > 1.0).then(|| {
            let [role, bone] = &self.names[joint.child];
            format!(
                "the bind pose of {role} ({bone}) is {beyond:.0}° beyond its `limits_deg`: a ragdoll that starts there is pushed; \
                 `ragdoll doctor --fix` widens them"
            )
        })
    }

    /// Rejects masses of bones that leave none of the total for the other bodies.
    fn check_masses(&self, settings: &Settings, total: Option<f32>) -> Result<(), SettingsError> {
        let Some(total) = total else { return Ok(()) };
        let given: Vec<f32> = self.bodies.iter().filter_map(|wish| wish.mass).collect();
        let sum: f32 = given.iter().sum();
        if sum < total || given.is_empty() || given.len() == self.bodies.len() {
            return Ok(());
        }
        let of_bone = settings.bones.iter().rev().find(|(_, bone)| bone.mass.is_some());
        let place = of_bone.map_or("mass".to_owned(), |(name, _)| format!("bones.{name}.mass"));
        let what = format!(
            "masses of bones add up to {sum} kg, which leaves nothing of the total of {total} kg for the other bodies"
        );
        Err(SettingsError::at(place, what))
    }

    /// Returns the shape of a body: `fit` is the build's shape, `other` computes a shape of another kind.
    fn shape(&self, body: usize, fit: Fit, other: &dyn Fn(ShapeChoice) -> Fit) -> Fit {
        let wish = &self.bodies[body];
        let mut fit = match wish.shape {
            None => fit,
            Some(ShapeWish::Box) => other(ShapeChoice::Box),
            Some(ShapeWish::Capsule) => other(ShapeChoice::Capsule),
            Some(ShapeWish::Sphere) => {
                let cuboid = other(ShapeChoice::Box);
                let volume = cuboid.shape.volume();
                let radius = sinew_math::trig::cbrt(0.75 * volume / PI);
                Fit { shape: Shape::Sphere { radius }, ..cuboid }
            }
        };
        if let Some(scale) = wish.scale {
            fit.shape = scaled(&fit.shape, scale);
        }
        fit
    }

    /// Sets masses from the settings; with a total, the other bodies share the rest.
    fn weigh(&self, def: &mut RagdollDef, total: Option<f32>) {
        let wanted = |body: usize| self.bodies[body].mass;
        let given: f32 = (0..def.bodies.len()).filter_map(wanted).sum();
        let free: f32 =
            (0..def.bodies.len()).filter(|&b| wanted(b).is_none()).map(|b| def.bodies[b].mass.mass).sum();
        let rest = total.map(|total| (total - given) / free).filter(|rest| *rest > 0.0).unwrap_or(1.0);
        let rest = if given > 0.0 { rest } else { 1.0 };
        for body in 0..def.bodies.len() {
            let mass = &mut def.bodies[body].mass;
            let factor = wanted(body).map_or(rest, |wanted| wanted / mass.mass);
            mass.mass *= factor;
            mass.inertia = mass.inertia * factor;
        }
        def.total_mass = def.bodies.iter().map(|body| body.mass.mass).sum();
    }

    fn joint(&self, joint: &RagdollJointDef) -> RagdollJointDef {
        let wish = &self.bodies[joint.child];
        RagdollJointDef {
            kind: kind(joint.kind, wish),
            friction_torque: wish.friction_torque.unwrap_or(joint.friction_torque),
            ..*joint
        }
    }
}

/// Returns the joint kind with the requested ranges.
fn kind(kind: JointKind, wish: &BoneSettings) -> JointKind {
    const SHUT: Range = Range::new(0.0, 0.0);
    const OPEN: Range = Range::new(-PI, PI);
    let open = SwingTwistLimit { swing_y: OPEN, swing_z: OPEN, twist: OPEN };
    let (own, limit) = match kind {
        JointKind::Ball { limit } => (JointWish::Ball, limit.unwrap_or(open)),
        JointKind::Universal { limit } => {
            (JointWish::Universal, SwingTwistLimit { twist: SHUT, ..limit.unwrap_or(open) })
        }
        JointKind::Hinge { limit } => {
            let twist = limit.unwrap_or(OPEN);
            (JointWish::Hinge, SwingTwistLimit { swing_y: SHUT, swing_z: SHUT, twist })
        }
        _ => (JointWish::Fixed, SwingTwistLimit { swing_y: SHUT, swing_z: SHUT, twist: SHUT }),
    };
    let is_wanted = [wish.swing_y, wish.swing_z, wish.twist].iter().any(Option::is_some);
    if !is_wanted && wish.joint.is_none_or(|joint| joint == own) {
        return kind;
    }
    let limit = SwingTwistLimit {
        swing_y: wish.swing_y.unwrap_or(limit.swing_y),
        swing_z: wish.swing_z.unwrap_or(limit.swing_z),
        twist: wish.twist.unwrap_or(limit.twist),
    };
    match wish.joint.unwrap_or(own) {
        JointWish::Ball => JointKind::Ball { limit: Some(limit) },
        JointWish::Universal => JointKind::Universal { limit: Some(limit) },
        JointWish::Hinge => JointKind::Hinge { limit: Some(limit.twist) },
        JointWish::Fixed => JointKind::Fixed,
    }
}

/// Merges two settings of a bone: the later one wins. With `mirror`, ranges of the left side are applied to the right:
/// swing about z and twist change sign.
fn merged(old: BoneSettings, new: &BoneSettings, mirror: bool) -> BoneSettings {
    let turned = |range: Range| if mirror { Range::new(-range.hi, -range.lo) } else { range };
    // A hinge bends in the same direction on both sides.
    let bends = new.joint == Some(JointWish::Hinge) || new.swing_y.is_none() && new.swing_z.is_none();
    let twist = if bends { new.twist } else { new.twist.map(turned) };
    BoneSettings {
        role: new.role.or(old.role),
        body: new.body.or(old.body),
        shape: new.shape.or(old.shape),
        scale: new.scale.or(old.scale),
        mass: new.mass.or(old.mass),
        joint: new.joint.or(old.joint),
        swing_y: new.swing_y.or(old.swing_y),
        swing_z: new.swing_z.map(turned).or(old.swing_z),
        twist: twist.or(old.twist),
        friction_torque: new.friction_torque.or(old.friction_torque),
    }
}
