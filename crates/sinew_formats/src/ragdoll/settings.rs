//! Settings of a ragdoll, version 1 (`NAME.ragdoll.json` beside `NAME.glb`), which override the automatic build.
//!
//! ```json
//! {
//!   "sinew": "ragdoll-settings",
//!   "version": 1,
//!   "shapes": "auto",
//!   "mass": 82,
//!   "sex": "m",
//!   "limits": "anatomy",
//!   "height": 1.83,
//!   "bones": {
//!     "head": { "shape": "sphere", "scale": 0.95 },
//!     "upperArm": { "limits_deg": { "swing_y": [-80, 80], "swing_z": [-70, 70], "twist": [-60, 60] } },
//!     "lowerLeg": { "type": "hinge", "limits_deg": { "twist": [-2, 130] }, "friction_torque": 2 },
//!     "leftHand": { "mass": 1.5 },
//!     "Cape_01": { "body": "drop" },
//!     "Bone_12": { "role": "hips" }
//!   },
//!   "ignore": ["Flag"],
//!   "disable_pairs": [["leftHand", "leftUpperLeg"]],
//!   "enable_pairs": [["leftUpperLeg", "rightUpperLeg"]],
//!   "springs": "names",
//!   "garments": [{ "chains": ["Cape_*"], "area_density": 0.5 }]
//! }
//! ```
//!
//! Every key but the first two is optional. `shapes` is `box`, `capsule` or `auto`; `mass` the total in kg; `sex` `m`
//! or `f`; `limits` `anatomy`, or `clips` to learn them from the file's clips. The unit of the rigged file is
//! `unit_scale` (metres), or follows from the `height` of the character. `up_axis` (`[0, 0, 1]`) is the file's up axis.
//! A bone is named by its role, by its role without the side (both sides; ranges are the left one's, mirrored on the
//! right) or by the name of the rig's joint. Keys of a bone: the `role` that replaces the detected one (only by the
//! joint's name), `body` (`keep` or `drop`), `shape` (`box`, `capsule`, `sphere`), its `scale`, `mass` in kg, `type`
//! and `limits_deg` of the joint to its parent as in [ragdoll files](super), each range separately, and
//! `friction_torque` in N·m. Joints listed in `ignore` and their descendants are not part of the body. `springs` is
//! `file` (the file's springs, else springs inferred from joint names), `names` (inferred), or `none`; an object states
//! it as `source`, and has `links`: a list, each with the `chains` of joints that are side by side and linked across
//! ([`LinkSettings`]), `closed` (default: if they form a ring), the `share` (0.5) and `holds_apart` (false); without it
//! the springs keep their own links. `garments` is `names` (inferred), `none`, or a list: each with the `chains` of
//! joints it is sewn from, or its `mesh`, and its cloth ([`Garment`]).
//!
//! ```
//! use sinew_formats::read_ragdoll_settings;
//!
//! let settings = read_ragdoll_settings(br#"{"sinew": "ragdoll-settings", "version": 1, "mass": 82}"#)?;
//! assert_eq!(settings.mass, Some(82.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::{read_range, read_up_axis};
use crate::container::json::{self, At};
use crate::error::{Error, Result, quoted};
use sinew_anim::garments::Backstop;
use sinew_anim::{Garment, Role, SpringLink};
use sinew_math::Range;
use sinew_ragdoll::settings::{
    BodyWish, BoneSettings, GarmentSettings, GarmentSource, JointWish, LinkSettings, MeshSettings, Settings,
    ShapeWish, SpringSource, Unit, nearest, role_named,
};
use sinew_ragdoll::{LimitSource, Sex, ShapeChoice};

const VERSION: usize = 1;

const ROOT_KEYS: [&str; 16] = [
    "sinew",
    "version",
    "comment",
    "shapes",
    "mass",
    "sex",
    "limits",
    "height",
    "unit_scale",
    "up_axis",
    "bones",
    "ignore",
    "disable_pairs",
    "enable_pairs",
    "springs",
    "garments",
];

const GARMENT_KEYS: [&str; 19] = [
    "comment",
    "name",
    "chains",
    "mesh",
    "held",
    "most_particles",
    "closed",
    "area_density",
    "radius",
    "spacing",
    "stretching",
    "shearing",
    "bending",
    "damping_ratio",
    "drag",
    "friction",
    "meets_arms",
    "thickness",
    "backstop",
];

/// Range of the number of particles of a sheet; each is a joint in the file.
const SHEET_PARTICLES: core::ops::RangeInclusive<usize> = 4..=4000;

const BONE_KEYS: [&str; 9] =
    ["comment", "role", "body", "shape", "scale", "mass", "type", "limits_deg", "friction_torque"];

/// Reads the settings of a settings file. Bone names are resolved when the settings are applied to a rig.
///
/// # Errors
/// Returns an error that names the location: unknown keys, with the nearest known one; values out of range; both a
/// height and a unit.
pub fn read_ragdoll_settings(bytes: &[u8]) -> Result<Settings> {
    let value = json::parse(bytes)?;
    let root = At::root(&value);
    json::check_header(root, "ragdoll-settings", VERSION)?;
    only(root, &ROOT_KEYS)?;
    let unit = match (root.get("unit_scale")?, root.get("height")?) {
        (Some(_), Some(height)) => {
            return Err(height.malformed("`unit_scale` sets the same: give one of the two"));
        }
        (Some(scale), None) => Some(Unit::Scale(scale.positive()?)),
        (None, Some(height)) => Some(Unit::Height(height.positive()?)),
        (None, None) => None,
    };
    let mut settings = Settings {
        shapes: word(root, "shapes", &SHAPES)?,
        mass: root.get("mass")?.map(At::positive).transpose()?,
        sex: word(root, "sex", &[("m", Sex::Male), ("f", Sex::Female)])?,
        limits: word(root, "limits", &LIMITS)?,
        unit,
        up_axis: root.get("up_axis")?.map(read_up_axis).transpose()?,
        bones: Vec::new(),
        ignore: read_names(root, "ignore")?,
        disable: read_pairs(root, "disable_pairs")?,
        enable: read_pairs(root, "enable_pairs")?,
        springs: None,
        spring_links: None,
        garments: root.get("garments")?.map(read_garments).transpose()?.unwrap_or_default(),
    };
    if let Some(springs) = root.get("springs")? {
        (settings.springs, settings.spring_links) = read_springs(springs)?;
    }
    if let Some(bones) = root.get("bones")? {
        let object = bones.value().as_object().ok_or_else(|| bones.malformed("must be an object"))?;
        for name in object.keys() {
            settings.bones.push((name.clone(), read_bone(bones.need(name)?)?));
        }
    }
    Ok(settings)
}

const SHAPES: [(&str, ShapeChoice); 3] =
    [("auto", ShapeChoice::Auto), ("box", ShapeChoice::Box), ("capsule", ShapeChoice::Capsule)];

const SPRINGS: [(&str, SpringSource); 3] =
    [("file", SpringSource::File), ("names", SpringSource::Names), ("none", SpringSource::None)];

const LIMITS: [(&str, LimitSource); 2] = [("anatomy", LimitSource::Anatomy), ("clips", LimitSource::Clips)];

fn read_bone(at: At<'_>) -> Result<BoneSettings> {
    only(at, &BONE_KEYS)?;
    let bodies = [("keep", BodyWish::Keep), ("drop", BodyWish::Drop)];
    let shapes = [("box", ShapeWish::Box), ("capsule", ShapeWish::Capsule), ("sphere", ShapeWish::Sphere)];
    let joints = [
        ("ball", JointWish::Ball),
        ("hinge", JointWish::Hinge),
        ("universal", JointWish::Universal),
        ("fixed", JointWish::Fixed),
    ];
    let mut bone = BoneSettings {
        role: at.get("role")?.map(read_role).transpose()?,
        body: word(at, "body", &bodies)?,
        shape: word(at, "shape", &shapes)?,
        scale: at.get("scale")?.map(At::positive).transpose()?,
        mass: at.get("mass")?.map(At::positive).transpose()?,
        joint: word(at, "type", &joints)?,
        friction_torque: at.get("friction_torque")?.map(At::not_negative).transpose()?,
        ..BoneSettings::default()
    };
    if let Some(limits) = at.get("limits_deg")? {
        only(limits, &["swing_y", "swing_z", "twist"])?;
        let swing = |key: &str| -> Result<Option<Range>> {
            let Some(at) = limits.get(key)? else { return Ok(None) };
            let range = read_range(at)?;
            if range.lo > 0.0 || range.hi < 0.0 {
                return Err(at.malformed("a swing's range must contain zero"));
            }
            Ok(Some(range))
        };
        bone.swing_y = swing("swing_y")?;
        bone.swing_z = swing("swing_z")?;
        bone.twist = limits.get("twist")?.map(read_range).transpose()?;
    }
    Ok(bone)
}

fn read_springs(at: At<'_>) -> Result<(Option<SpringSource>, Option<Vec<LinkSettings>>)> {
    if at.value().as_str().is_some() {
        return Ok((Some(one_of(at, &SPRINGS)?), None));
    }
    only(at, &["comment", "source", "links"])?;
    let links = at.get("links")?.map(|links| links.items()?.into_iter().map(read_links).collect());
    Ok((word(at, "source", &SPRINGS)?, links.transpose()?))
}

fn read_links(at: At<'_>) -> Result<LinkSettings> {
    only(at, &["comment", "chains", "closed", "share", "holds_apart"])?;
    at.need("chains")?;
    let usual = SpringLink::default();
    let share = match at.get("share")? {
        Some(at) => {
            let share = at.positive()?;
            if share > 1.0 {
                return Err(at.malformed("a share is at most 1"));
            }
            share
        }
        None => usual.share,
    };
    let holds_apart = at.get("holds_apart")?.map_or(Ok(usual.holds_apart), At::bool)?;
    Ok(LinkSettings {
        chains: read_names(at, "chains")?,
        closed: at.get("closed")?.map(At::bool).transpose()?,
        link: SpringLink { share, holds_apart, ..usual },
    })
}

fn read_garments(at: At<'_>) -> Result<GarmentSource> {
    if at.value().as_str().is_some() {
        return one_of(at, &[("names", GarmentSource::Names), ("none", GarmentSource::None)]);
    }
    at.items()?.into_iter().map(read_garment).collect::<Result<_>>().map(GarmentSource::Listed)
}

fn read_garment(at: At<'_>) -> Result<GarmentSettings> {
    only(at, &GARMENT_KEYS)?;
    let mesh = read_mesh(at)?;
    let usual = Garment::default();
    let within = |key: &str, usual: f32, range: [f32; 2]| within(at, key, usual, range);
    let cloth = Garment {
        name: at.get("name")?.map(At::str).transpose()?.unwrap_or_default().to_owned(),
        area_density: within("area_density", usual.area_density, [1e-3, 1e3])?,
        radius: within("radius", usual.radius, [1e-4, 10.0])?,
        spacing: within("spacing", usual.spacing, [1e-4, 10.0])?,
        stretching: within("stretching", usual.stretching, [1e-3, 1e9])?,
        shearing: within("shearing", usual.shearing, [0.0, 1e9])?,
        bending: within("bending", usual.bending, [0.0, 1e9])?,
        damping_ratio: within("damping_ratio", usual.damping_ratio, [0.0, 100.0])?,
        drag: within("drag", usual.drag, [0.0, 100.0])?,
        friction: within("friction", usual.friction, [0.0, 100.0])?,
        meets_arms: at.get("meets_arms")?.map(At::bool).transpose()?,
        thickness: within("thickness", usual.thickness, [0.0, 1.0])?,
        backstop: at.get("backstop")?.map(read_backstop).transpose()?,
        ..usual
    };
    Ok(GarmentSettings {
        chains: read_names(at, "chains")?,
        mesh,
        closed: at.get("closed")?.map(At::bool).transpose()?,
        cloth,
    })
}

/// Reads a number within a range; `usual` if absent.
fn within(at: At<'_>, key: &str, usual: f32, [least, most]: [f32; 2]) -> Result<f32> {
    let Some(at) = at.get(key)? else { return Ok(usual) };
    // Other messages are clearer for values of 0 and below.
    let number = if least > 0.0 { at.positive()? } else { at.not_negative()? };
    if number < least || number > most {
        return Err(at.malformed(format!("must lie between {least} and {most}")));
    }
    Ok(number)
}

fn read_backstop(at: At<'_>) -> Result<Backstop> {
    only(at, &["comment", "distance", "radius"])?;
    at.need("distance")?;
    let distance = within(at, "distance", 0.0, [0.0, 10.0])?;
    let radius = within(at, "radius", Backstop::default().radius, [1e-3, 10.0])?;
    Ok(Backstop { distance, radius })
}

/// Reads the mesh of a garment; `None` if the garment consists of chains.
fn read_mesh(at: At<'_>) -> Result<Option<MeshSettings>> {
    let Some(mesh) = at.get("mesh")? else {
        for key in ["held", "most_particles"] {
            if let Some(there) = at.get(key)? {
                return Err(there.malformed("only a garment with a `mesh` has it"));
            }
        }
        at.need("chains")?;
        return Ok(None);
    };
    for key in ["chains", "closed"] {
        if let Some(there) = at.get(key)? {
            return Err(there.malformed("a garment has `chains` or a `mesh`, not both"));
        }
    }
    let usual = MeshSettings::new(mesh.str()?);
    let most_particles = match at.get("most_particles")? {
        None => usual.most_particles,
        Some(most) => {
            let number = most.usize()?;
            if !SHEET_PARTICLES.contains(&number) {
                return Err(most.malformed("must lie between 4 and 4000"));
            }
            number
        }
    };
    Ok(Some(MeshSettings {
        held: at.get("held")?.map(At::not_negative).transpose()?,
        most_particles,
        ..usual
    }))
}

fn read_role(at: At<'_>) -> Result<Role> {
    role_named(at.str()?).map_err(|what| at.malformed(what))
}

fn read_names(root: At<'_>, key: &str) -> Result<Vec<String>> {
    root.list(key)?.into_iter().map(|name| Ok(name.str()?.to_owned())).collect()
}

fn read_pairs(root: At<'_>, key: &str) -> Result<Vec<[String; 2]>> {
    let read = |pair: At<'_>| {
        let [a, b] = pair.items()?[..] else { return Err(pair.malformed("must name two bones")) };
        Ok([a.str()?.to_owned(), b.str()?.to_owned()])
    };
    root.list(key)?.into_iter().map(read).collect()
}

/// Reads one of the words in a list; `None` if the key is absent.
fn word<T: Clone>(at: At<'_>, key: &str, words: &[(&str, T)]) -> Result<Option<T>> {
    at.get(key)?.map(|at| one_of(at, words)).transpose()
}

/// Returns the meaning of a word in a list.
fn one_of<T: Clone>(at: At<'_>, words: &[(&str, T)]) -> Result<T> {
    let said = at.str()?;
    let found = words.iter().find(|(word, _)| *word == said).map(|(_, meaning)| meaning.clone());
    found.ok_or_else(|| {
        let known: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
        unknown(at, "word", said, &known)
    })
}

/// Rejects keys outside `known`; the error names the nearest known key.
fn only(at: At<'_>, known: &[&str]) -> Result<()> {
    let object = at.value().as_object().ok_or_else(|| at.malformed("must be an object"))?;
    match object.keys().find(|key| !known.contains(&key.as_str())) {
        Some(key) => Err(unknown(at, "key", key, known)),
        None => Ok(()),
    }
}

fn unknown(at: At<'_>, what: &str, said: &str, known: &[&str]) -> Error {
    let hint = nearest(said, known.iter().copied())
        .map_or_else(|| format!("known are {}", known.join(", ")), |near| format!("did you mean `{near}`?"));
    at.malformed(format!("unknown {what} {}; {hint}", quoted(said)))
}
