//! Springs stated by a VRM: `VRMC_springBone` 1.0 with extended colliders and limits, and VRM 0's `secondaryAnimation`.

use super::scene::Scene;
use super::source::Source;
use crate::container::json::At;
use crate::error::Result;
use serde_json::Value;
use sinew_anim::springs::{ColliderShape, LimitKind, Side};
use sinew_anim::{JointIdx, SpringBone, SpringChain, SpringCollider, SpringLimit, Springs};
use sinew_anim::{local_to_model, rest_pose};
use sinew_math::{Affine, Rotation, Vec3, clamp, normalize_or};

const VERSION_1: &str = "VRMC_springBone";
const EXTENDED: &str = "VRMC_springBone_extended_collider";
const LIMIT: &str = "VRMC_springBone_limit";
/// Bone length that VRM 0 assumes for a joint without a child, metres.
const VIRTUAL_TAIL: f32 = 0.07;
/// Largest number of warnings; each searches the whole file for its location.
const MOST_WARNINGS: usize = 16;
/// Memory of a collider reference, bytes; limited by the file size.
const REFERENCE: usize = size_of::<usize>();

/// Format in which a file states its springs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpringFormat {
    /// `secondaryAnimation` of VRM 0.
    Vrm0,
    /// `VRMC_springBone` of VRM 1.
    Vrm1,
}

impl SpringFormat {
    /// Returns the format of a glTF's JSON; `None` without springs. If both exist, the newer one is read.
    pub(super) fn of(json: &Value) -> Option<Self> {
        let extensions = json.get("extensions")?;
        let stated = |at: Option<&Value>| at.is_some_and(|at| !at.is_null());
        if stated(extensions.get(VERSION_1)) {
            return Some(Self::Vrm1);
        }
        stated(extensions.get("VRM")?.get("secondaryAnimation")).then_some(Self::Vrm0)
    }

    /// Returns the name for people: `VRM 0`, `VRM 1`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Vrm0 => "VRM 0",
            Self::Vrm1 => "VRM 1",
        }
    }
}

/// Reads the springs of a file; adds a line to `warnings` per omission.
pub(super) fn read(source: &Source<'_>, scene: &Scene, warnings: &mut Vec<String>) -> Result<Springs> {
    let Some(extensions) = source.root.get("extensions")? else { return Ok(Springs::default()) };
    let mut reader = Reader::new(source, scene);
    if let Some(at) = extensions.get(VERSION_1)? {
        reader.version_1(at)?;
    } else if let Some(vrm) = extensions.get("VRM")?
        && let Some(at) = vrm.get("secondaryAnimation")?
    {
        reader.version_0(at)?;
    }
    warnings.append(&mut reader.warnings);
    Ok(reader.springs)
}

struct Reader<'a, 's> {
    source: &'a Source<'s>,
    scene: &'a Scene,
    /// Rest pose in model space.
    rest: Vec<Affine>,
    /// End of each joint's subtree; joints are in depth-first order.
    ends: Vec<JointIdx>,
    /// True for joints that are already in a chain.
    taken: Vec<bool>,
    springs: Springs,
    warnings: Vec<String>,
}

impl<'a, 's> Reader<'a, 's> {
    fn new(source: &'a Source<'s>, scene: &'a Scene) -> Self {
        let mut rest = Vec::new();
        local_to_model(&scene.rig, &rest_pose(&scene.rig), &Affine::IDENTITY, &mut rest);
        let taken = vec![false; rest.len()];
        let mut ends: Vec<JointIdx> = (1..=rest.len()).collect();
        for (joint, node) in scene.rig.joints.iter().enumerate().rev() {
            if let Some(parent) = node.parent {
                ends[parent] = ends[parent].max(ends[joint]);
            }
        }
        Self { source, scene, rest, ends, taken, springs: Springs::default(), warnings: Vec::new() }
    }

    /// Returns the joint of a node; `None` for a node outside the scene.
    fn joint(&self, at: At<'_>) -> Result<Option<JointIdx>> {
        Ok(self.scene.joint_of_node[at.index(self.source.nodes.len(), "nodes")?])
    }

    /// As [`joint`](Self::joint), for VRM 0, where −1 means none.
    fn joint_or_none(&self, at: Option<At<'_>>) -> Result<Option<JointIdx>> {
        match at {
            Some(at) if at.value().as_f64() != Some(-1.0) => self.joint(at),
            _ => Ok(None),
        }
    }

    /// True if `below` is a descendant of `above`.
    fn is_above(&self, above: JointIdx, below: JointIdx) -> bool {
        above < below && below < self.ends[above]
    }

    fn warn(&mut self, at: At<'_>, what: &str) {
        if self.warnings.len() < MOST_WARNINGS {
            self.warnings.push(format!("spring left out: {what} ({})", at.path()));
        }
    }

    fn version_1(&mut self, at: At<'_>) -> Result<()> {
        let colliders = at.list("colliders")?;
        // Index of each collider among the kept ones.
        let mut kept = Vec::with_capacity(colliders.len());
        for &collider in &colliders {
            let joint = self.joint(collider.need("node")?)?;
            let shape = collider_shape(collider)?;
            kept.push(joint.map(|_| self.springs.colliders.len()));
            self.springs.colliders.extend(joint.map(|joint| SpringCollider { joint, shape }));
        }
        let mut groups = Vec::new();
        for group in at.list("colliderGroups")? {
            let mut members = Vec::new();
            for member in group.list("colliders")? {
                members.extend(kept[member.index(colliders.len(), "colliders")?]);
            }
            groups.push(members);
        }
        for spring in at.list("springs")? {
            self.spring(spring, &groups)?;
        }
        Ok(())
    }

    fn spring(&mut self, spring: At<'_>, groups: &[Vec<usize>]) -> Result<()> {
        let limit = limit(spring)?;
        let mut joints: Vec<(JointIdx, At<'_>)> = Vec::new();
        for at in spring.list("joints")? {
            let Some(joint) = self.joint(at.need("node")?)? else { continue };
            if let Some(&(last, _)) = joints.last()
                && !self.is_above(last, joint)
            {
                self.warn(at, "a joint must hang on the one before it");
                break;
            }
            joints.push((joint, at));
        }
        let mut bones = Vec::new();
        for pair in joints.windows(2) {
            let [(joint, at), (next, _)] = [pair[0], pair[1]];
            let mut bone = bone(at, limit)?;
            (bone.joint, bone.tail) = (joint, self.tail_1(joint, next));
            if core::mem::replace(&mut self.taken[joint], true) {
                self.warn(at, "its joint is in another spring");
                continue;
            }
            bones.push(bone);
        }
        let center = spring.get("center")?;
        let center = center.map(|at| self.joint(at)).transpose()?.flatten();
        let colliders = self.colliders(spring, groups)?;
        self.keep(SpringChain { name: spring.name(), bones, center, colliders, hits_body: false });
        Ok(())
    }

    /// Returns the tip of a bone in VRM 1: the next joint of the chain, a descendant.
    fn tail_1(&self, joint: JointIdx, next: JointIdx) -> Vec3 {
        let node = &self.scene.rig.joints[next];
        let is_child = node.parent == Some(joint);
        if is_child { node.rest.translation } else { self.seen_from(joint, self.rest[next].translation) }
    }

    /// Converts a point of model space to a joint's own space.
    fn seen_from(&self, joint: JointIdx, point: Vec3) -> Vec3 {
        let seen = self.rest[joint].inverse().point(point);
        if seen.is_finite() { seen } else { Vec3::ZERO }
    }

    /// Returns the colliders of the groups that a spring lists, each only once, in order.
    fn colliders(&self, spring: At<'_>, groups: &[Vec<usize>]) -> Result<Vec<usize>> {
        let mut named = Vec::new();
        for at in spring.list("colliderGroups")? {
            let group = at.index(groups.len(), "collider groups")?;
            self.source.spend(at, groups[group].len(), REFERENCE)?;
            named.extend_from_slice(&groups[group]);
        }
        let mut seen = vec![false; if named.is_empty() { 0 } else { self.springs.colliders.len() }];
        named.retain(|&collider| !core::mem::replace(&mut seen[collider], true));
        Ok(named)
    }

    fn keep(&mut self, chain: SpringChain) {
        if !chain.bones.is_empty() {
            self.springs.chains.push(chain);
        }
    }

    fn version_0(&mut self, at: At<'_>) -> Result<()> {
        let mut groups = Vec::new();
        for group in at.list("colliderGroups")? {
            let joint = self.joint_or_none(group.get("node")?)?;
            let mut members = Vec::new();
            for ball in group.list("colliders")? {
                let offset = unity(ball.get("offset")?, Vec3::ZERO)?;
                let radius = number(ball, "radius", 0.0, At::not_negative)?;
                let Some(joint) = joint else { continue };
                members.push(self.springs.colliders.len());
                let shape = ColliderShape::Sphere { offset, radius, keeps: Side::Outside };
                self.springs.colliders.push(SpringCollider { joint, shape });
            }
            groups.push(members);
        }
        let mut children: Vec<Vec<JointIdx>> = vec![Vec::new(); self.rest.len()];
        for (joint, node) in self.scene.rig.joints.iter().enumerate() {
            node.parent.iter().for_each(|&parent| children[parent].push(joint));
        }
        for group in at.list("boneGroups")? {
            self.bone_group(group, &groups, &children)?;
        }
        Ok(())
    }

    /// Reads a group of VRM 0: every joint below its roots swings.
    fn bone_group(&mut self, group: At<'_>, groups: &[Vec<usize>], children: &[Vec<JointIdx>]) -> Result<()> {
        let settings = bone_0(group)?;
        let center = self.joint_or_none(group.get("center")?)?;
        let name = group.value().get("comment").and_then(|c| c.as_str()).unwrap_or_default().to_owned();
        for at in group.list("bones")? {
            let Some(root) = self.joint_or_none(Some(at))? else { continue };
            let (mut open, mut bones) = (vec![root], Vec::new());
            while let Some(joint) = open.pop() {
                if core::mem::replace(&mut self.taken[joint], true) {
                    continue;
                }
                bones.push(SpringBone { joint, tail: self.tail_0(joint, children), ..settings });
                open.extend(children[joint].iter().rev());
            }
            if bones.is_empty() {
                self.warn(at, "its joint is in another spring");
            }
            let colliders = self.colliders(group, groups)?;
            self.keep(SpringChain { name: name.clone(), bones, center, colliders, hits_body: false });
        }
        Ok(())
    }

    /// Returns the tip of a bone in VRM 0: the first child, else a position beyond the joint, in the direction from its
    /// parent.
    fn tail_0(&self, joint: JointIdx, children: &[Vec<JointIdx>]) -> Vec3 {
        if let Some(&child) = children[joint].first() {
            return self.scene.rig.joints[child].rest.translation;
        }
        let Some(parent) = self.scene.rig.joints[joint].parent else { return Vec3::ZERO };
        let at = self.rest[joint].translation;
        let onward = normalize_or(at - self.rest[parent].translation, Vec3::ZERO);
        self.seen_from(joint, at + onward * VIRTUAL_TAIL)
    }
}

/// Reads the number under an optional key.
fn number<'a>(at: At<'a>, key: &str, default: f32, read: impl FnOnce(At<'a>) -> Result<f32>) -> Result<f32> {
    at.get(key)?.map_or(Ok(default), read)
}

/// Reads the settings of a VRM 1 joint, without joint and tip.
fn bone(at: At<'_>, of_spring: Option<SpringLimit>) -> Result<SpringBone> {
    let usual = SpringBone::default();
    let down = Vec3::from_array(at.numbers_or("gravityDir", [0.0, -1.0, 0.0])?);
    Ok(SpringBone {
        stiffness: number(at, "stiffness", usual.stiffness, At::not_negative)?,
        gravity: down * number(at, "gravityPower", 0.0, At::f32)?,
        drag: clamp(number(at, "dragForce", usual.drag, At::f32)?, 0.0, 1.0),
        radius: number(at, "hitRadius", 0.0, At::not_negative)?,
        limit: limit(at)?.or(of_spring),
        ..usual
    })
}

/// Reads the settings of a VRM 0 bone group; the format misspells `stiffness`.
fn bone_0(at: At<'_>) -> Result<SpringBone> {
    let usual = SpringBone::default();
    let down = unity(at.get("gravityDir")?, -Vec3::Y)?;
    Ok(SpringBone {
        stiffness: number(at, "stiffiness", usual.stiffness, At::not_negative)?,
        gravity: down * number(at, "gravityPower", 0.0, At::f32)?,
        drag: clamp(number(at, "dragForce", usual.drag, At::f32)?, 0.0, 1.0),
        radius: number(at, "hitRadius", 0.0, At::not_negative)?,
        ..usual
    })
}

/// Reads a vector of VRM 0: an object, in Unity's left-handed axes.
fn unity(at: Option<At<'_>>, default: Vec3) -> Result<Vec3> {
    let Some(at) = at else { return Ok(default) };
    let axis = |key| number(at, key, 0.0, At::f32);
    Ok(Vec3::new(axis("x")?, axis("y")?, -axis("z")?))
}

/// Reads the shape of a collider: that of the extension if present, else the plain one, which is the fallback.
fn collider_shape(collider: At<'_>) -> Result<ColliderShape> {
    let extended = match collider.get("extensions")? {
        Some(extensions) => match extensions.get(EXTENDED)? {
            Some(extended) => extended.get("shape")?,
            None => None,
        },
        None => None,
    };
    let at = match extended {
        Some(shape) => shape,
        None => collider.need("shape")?,
    };
    let point = |at: At<'_>, key: &str| Ok(Vec3::from_array(at.numbers_or(key, [0.0; 3])?));
    let radius = |at: At<'_>| number(at, "radius", 0.0, At::not_negative);
    let keeps = |at: At<'_>| -> Result<Side> {
        let inside = extended.is_some() && at.get("inside")?.map_or(Ok(false), At::bool)?;
        Ok(if inside { Side::Inside } else { Side::Outside })
    };
    if let Some(at) = at.get("sphere")? {
        return Ok(ColliderShape::Sphere {
            offset: point(at, "offset")?,
            radius: radius(at)?,
            keeps: keeps(at)?,
        });
    }
    if let Some(at) = at.get("capsule")? {
        return Ok(ColliderShape::Capsule {
            offset: point(at, "offset")?,
            tail: point(at, "tail")?,
            radius: radius(at)?,
            keeps: keeps(at)?,
        });
    }
    if let Some(at) = at.get("plane")? {
        let normal = Vec3::from_array(at.numbers_or("normal", [0.0, 0.0, 1.0])?);
        return Ok(ColliderShape::Plane {
            offset: point(at, "offset")?,
            normal: normalize_or(normal, Vec3::Z),
        });
    }
    Err(at.malformed("must have a sphere, a capsule or a plane"))
}

/// Reads the limit of a joint or a spring from its extension.
fn limit(holder: At<'_>) -> Result<Option<SpringLimit>> {
    let Some(extensions) = holder.get("extensions")? else { return Ok(None) };
    let Some(at) = extensions.get(LIMIT)? else { return Ok(None) };
    // The draft's example omits the object that its schema requires.
    let at = at.get("limit")?.unwrap_or(at);
    let angle = |at: At<'_>, key: &str, most: f32| -> Result<f32> {
        Ok(clamp(at.need(key)?.not_negative()?, 0.0, most))
    };
    let (kind, at) = if let Some(at) = at.get("cone")? {
        (LimitKind::Cone { angle: angle(at, "angle", core::f32::consts::PI)? }, at)
    } else if let Some(at) = at.get("hinge")? {
        (LimitKind::Hinge { angle: angle(at, "angle", core::f32::consts::PI)? }, at)
    } else if let Some(at) = at.get("spherical")? {
        let phi = angle(at, "phi", core::f32::consts::PI)?;
        (LimitKind::Spherical { phi, theta: angle(at, "theta", core::f32::consts::FRAC_PI_2)? }, at)
    } else {
        return Err(at.malformed("must have a cone, a hinge or a spherical limit"));
    };
    let [x, y, z, w] = at.numbers_or("rotation", [0.0, 0.0, 0.0, 1.0])?;
    let rotation = Rotation::from_xyzw(x, y, z, w);
    let is_turn = rotation.length() > 0.0 && rotation.length() < f32::INFINITY;
    let rotation = if is_turn { rotation.normalize() } else { Rotation::IDENTITY };
    Ok(Some(SpringLimit { kind, rotation }))
}
