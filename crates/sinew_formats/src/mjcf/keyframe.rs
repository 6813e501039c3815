//! Keyframes: named poses.

use super::bodies::Tree;
use super::compiler::{quaternion, turn_y_up, y_up};
use super::joint::Freedom;
use super::xml::{Element, Value, children};
use super::{MjcfJoint, MjcfKeyframe};
use crate::error::Result;
use sinew_math::{Transform, Vec3};

/// Reads the keyframes of a document.
pub(super) fn read(root: Element<'_>, tree: &Tree<'_>, joints: &[MjcfJoint]) -> Result<Vec<MjcfKeyframe>> {
    let keys = children(root)
        .filter(|(tag, _)| *tag == "keyframe")
        .flat_map(|(_, keyframe)| children(keyframe))
        .filter(|(tag, _)| *tag == "key");
    let read_key = |(_, key): (&str, Element<'_>)| {
        let name = key.attribute("name").unwrap_or_default().to_owned();
        let mut keyframe = MjcfKeyframe { name, placed: Vec::new(), moved: Vec::new() };
        if let Some(value) = Value::of(key, "qpos") {
            keyframe.fill(value, tree, joints)?;
        }
        Ok(keyframe)
    };
    keys.map(read_key).collect()
}

impl MjcfKeyframe {
    /// Computes poses from the coordinates of all joints: body after body, joint after joint.
    fn fill(&mut self, value: Value<'_>, tree: &Tree<'_>, joints: &[MjcfJoint]) -> Result<()> {
        let coordinates = value.list()?;
        let wanted: usize = tree.links.iter().map(|link| link.freedom.coordinates()).sum();
        if coordinates.len() != wanted {
            let what = format!("takes {wanted} numbers for this model, not {}", coordinates.len());
            return Err(value.malformed(what));
        }
        let mut rest = &coordinates[..];
        for (body, link) in tree.links.iter().enumerate() {
            let of_body;
            (of_body, rest) = rest.split_at(link.freedom.coordinates());
            match (&link.freedom, of_body) {
                (Freedom::Free, &[x, y, z, qw, qx, qy, qz]) => {
                    let rotation = turn_y_up(quaternion(value, [qw, qx, qy, qz])?);
                    self.placed.push((body, Transform::new(y_up(Vec3::new(x, y, z)), rotation)));
                }
                (Freedom::Welded, _) => {}
                (freedom, coordinates) => {
                    let motion = freedom.motion(coordinates, value)?;
                    let joint = joints.binary_search_by_key(&body, |joint| joint.child);
                    let joint = joint.expect("a body that moves in its parent has a joint");
                    let axes = Transform::new(Vec3::ZERO, joints[joint].frame_b.rotation);
                    self.moved.push((joint, axes.inverse() * motion * axes));
                }
            }
        }
        Ok(())
    }
}
