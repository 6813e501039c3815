//! Bones of a rig for the stages of the build: the kept ones, in character space, parents before children.
//!
//! ```
//! use sinew_anim::roles::{Role, Side};
//! use sinew_math::Vec3;
//! use sinew_ragdoll::build::bones::{Anatomy, Bone, Bones};
//!
//! let list = vec![
//!     Bone::new(0, Role::Hips, None, Vec3::new(0.0, 1.0, 0.0)),
//!     Bone::new(1, Role::UpperLeg(Side::Left), Some(0), Vec3::new(0.1, 0.9, 0.0)),
//!     Bone::new(2, Role::LowerLeg(Side::Left), Some(1), Vec3::new(0.1, 0.5, 0.0)),
//! ];
//! let bones = Bones::new(list, Anatomy::Human, 1.75);
//! assert_eq!(bones.continuation(1), Some(2));
//! assert!((bones.length(1).expect("it ends at the knee") - 0.4).abs() < 1e-6);
//! ```

use crate::build::part::{Part, Side, part_of_role};
use sinew_anim::JointIdx;
use sinew_anim::roles::Role;
use sinew_math::{Vec3, max, normalize_or};

/// One kept bone, the source of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Bone {
    /// Rig joint that carries the bone.
    pub joint: JointIdx,
    /// Rig joints that move rigidly with the bone.
    pub merged: Vec<JointIdx>,
    /// Role of the bone in the body.
    pub role: Role,
    /// Confidence of the role, 0..=1.
    pub confidence: f32,
    /// Body part that the role names.
    pub part: Part,
    /// Side of the body.
    pub side: Side,
    /// Index of the parent bone; smaller than the bone's own. `None` for the first.
    pub parent: Option<usize>,
    /// Pivot of the joint to the parent, character space at the bind pose, metres.
    pub head: Vec3,
    /// True for props: a prop is not the end of a bone, and its joint is fixed.
    pub is_prop: bool,
}

/// The kept bones of a character.
#[derive(Clone, Debug, PartialEq)]
pub struct Bones {
    /// The bones, parents before children; the first is the pelvis.
    pub list: Vec<Bone>,
    /// Indices of the children of each bone, without props.
    pub children: Vec<Vec<usize>>,
    /// Anatomy tables that apply: those of a human, or those of a creature.
    pub anatomy: Anatomy,
    /// Height in the bind pose, metres.
    pub height: f32,
}

/// Anatomy of a character, by the tables that apply to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anatomy {
    /// Two arms, two legs, a head: anthropometry and joint ranges of humans.
    Human,
    /// Anything else: masses from volumes, joint ranges by kind of limb.
    Creature,
}

impl Bones {
    /// Creates the tree of bones.
    ///
    /// # Panics
    /// If a parent's index is not smaller than its child's.
    pub fn new(list: Vec<Bone>, anatomy: Anatomy, height: f32) -> Self {
        let mut children = vec![Vec::new(); list.len()];
        for (index, bone) in list.iter().enumerate() {
            if let Some(parent) = bone.parent {
                assert!(parent < index, "bone {index} comes before its parent {parent}");
                if !bone.is_prop {
                    children[parent].push(index);
                }
            }
        }
        Self { list, children, anatomy, height }
    }

    /// Returns the child that continues the bone: the forearm of an upper arm, the neck of a chest. `None` for the end
    /// of a chain, or if no child continues the bone better than the others.
    pub fn continuation(&self, bone: usize) -> Option<usize> {
        let children = &self.children[bone];
        let wanted = self.list[bone].part.continued_by();
        wanted
            .iter()
            .find_map(|part| children.iter().copied().find(|&child| self.list[child].part == *part))
            .or_else(|| (children.len() == 1 && wanted.is_empty()).then(|| children[0]))
    }

    /// Returns the end of the bone, character space: the pivot of its continuation, else the mean of its children's
    /// pivots. `None` at the end of a chain, or if that point is the bone's own pivot.
    pub fn tail(&self, bone: usize) -> Option<Vec3> {
        let children = &self.children[bone];
        let tail = match self.continuation(bone) {
            Some(child) => self.list[child].head,
            None if children.is_empty() => return None,
            None => {
                children.iter().fold(Vec3::ZERO, |sum, &c| sum + self.list[c].head) / children.len() as f32
            }
        };
        ((tail - self.list[bone].head).length() > 1e-3 * self.height).then_some(tail)
    }

    /// Returns the unit vector from pivot to tail; at the end of a chain, from the pivot to `middle` (the centroid of
    /// the bone's surface). Without either, the direction from the parent's pivot, or up.
    pub fn direction(&self, bone: usize, middle: Option<Vec3>) -> Vec3 {
        let head = self.list[bone].head;
        let onward = self.list[bone]
            .parent
            .map_or(Vec3::Y, |parent| normalize_or(head - self.list[parent].head, Vec3::Y));
        self.tail(bone).or(middle).map_or(onward, |end| normalize_or(end - head, onward))
    }

    /// Returns the distance from pivot to tail, metres; `None` at the end of a chain.
    pub fn length(&self, bone: usize) -> Option<f32> {
        self.tail(bone).map(|tail| (tail - self.list[bone].head).length())
    }

    /// Returns the first bone of this part on this side.
    pub fn find(&self, part: Part, side: Side) -> Option<usize> {
        self.list.iter().position(|bone| bone.part == part && bone.side == side)
    }

    /// Returns the bone of the other side; `None` for bones without a side.
    pub fn twin(&self, bone: usize) -> Option<usize> {
        let role = self.list[bone].role;
        role.side()?;
        self.list.iter().position(|other| other.role == role.mirror())
    }

    /// Returns true if a bone is in the body's plane of symmetry, so that its left and right halves are equal.
    pub fn is_central(&self, bone: usize) -> bool {
        let bone = &self.list[bone];
        let aside = (bone.head.x - self.plane_of_symmetry()).abs();
        bone.side == Side::Middle && bone.part != Part::Limb && aside < 0.02 * self.size()
    }

    /// Returns the size of the character, metres: the height of a human; for a creature, whose up axis may be unknown,
    /// twice the distance from its first bone to the furthest.
    pub fn size(&self) -> f32 {
        match self.anatomy {
            Anatomy::Human => self.height,
            Anatomy::Creature => {
                let away = |bone: &Bone| (bone.head - self.list[0].head).length();
                2.0 * self.list.iter().map(away).fold(0.0, max)
            }
        }
    }

    /// Returns the x coordinate of the plane between left and right, which contains the pelvis; character space,
    /// metres.
    pub fn plane_of_symmetry(&self) -> f32 {
        self.list[0].head.x
    }

    /// Returns the number of joints between two bones of the tree.
    pub fn distance(&self, a: usize, b: usize) -> usize {
        let (mut a, mut b, mut steps) = (a, b, 0);
        while a != b {
            // Parents have smaller indices, so the larger one is never the common ancestor.
            let later = if a > b { &mut a } else { &mut b };
            let Some(parent) = self.list[*later].parent else { return usize::MAX };
            *later = parent;
            steps += 1;
        }
        steps
    }
}

impl Bone {
    /// Creates a bone from its role.
    pub fn new(joint: JointIdx, role: Role, parent: Option<usize>, head: Vec3) -> Self {
        let (part, side) = part_of_role(role);
        Self { joint, merged: Vec::new(), role, confidence: 1.0, part, side, parent, head, is_prop: false }
    }
}
