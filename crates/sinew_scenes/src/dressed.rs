//! The mannequin in a skirt and a cape: chains of bones around its waist and down its back, with a skin as artists make
//! it.

use sinew::anim::{
    Garment, Joint, JointIdx, LocalTransform, Primitive, Rig, RigMesh, Skin, analyze, guess_garments,
};
use sinew::math::trig::{cos, sin};
use sinew::math::{Affine, Transform, Vec3, max};
use sinew::ragdoll::{BuildOptions, CharacterDef, build};

/// Bone chains of a garment.
pub struct Chains {
    /// Prefix of the joint names.
    pub name: &'static str,
    /// Name of the joint to which the garment is attached.
    pub on: &'static str,
    /// Number of chains.
    pub columns: usize,
    /// Number of bones in a chain, which has one joint more.
    pub bones: usize,
    /// True if the last chain is next to the first.
    pub closed: bool,
    /// Returns the position in the bind pose, metres, at a fraction across and a fraction down the garment, 0..=1.
    pub place: fn(f32, f32) -> Vec3,
    /// Linear RGBA colour.
    pub color: [f32; 4],
}

/// A skirt to the knees.
pub const SKIRT: Chains = Chains {
    name: "skirt",
    on: "hips",
    columns: 10,
    bones: 3,
    closed: true,
    place: |across, down| {
        let angle = core::f32::consts::TAU * across;
        let (wide, deep) = (0.165 + 0.115 * down, 0.125 + 0.135 * down);
        Vec3::new(wide * sin(angle), 1.0 - 0.45 * down, deep * cos(angle))
    },
    color: [0.30, 0.04, 0.07, 1.0],
};

/// A cape to the calves.
pub const CAPE: Chains = Chains {
    name: "cape",
    on: "chest",
    columns: 5,
    bones: 6,
    closed: false,
    place: |across, down| {
        let (side, wide) = (1.0 - 2.0 * across, 0.2 + 0.1 * down);
        Vec3::new(wide * side, 1.42 - 0.96 * down, -0.125 - 0.085 * down - 0.02 * (1.0 - side * side))
    },
    color: [0.05, 0.09, 0.25, 1.0],
};

/// Number of skin cells between two joints, across and down.
const PARTS: usize = 4;

/// Rig of the mannequin with these garments.
///
/// # Panics
/// If the mannequin has no joint with the name [`Chains::on`] of a garment.
pub fn dressed_rig(garments: &[&Chains]) -> Rig {
    let mut rig = crate::mannequin::mannequin().rig;
    for chains in garments {
        let first = rig.joints.len();
        let on = rig
            .joints
            .iter()
            .position(|joint| joint.name == chains.on)
            .expect("the rig has the joint that carries the garment");
        for column in 0..chains.columns {
            chains.add_column(&mut rig, on, column);
        }
        chains.add_skin(&mut rig, first);
    }
    rig
}

impl Chains {
    /// Number of gaps between chains.
    fn gaps(&self) -> usize {
        if self.closed { self.columns } else { self.columns - 1 }
    }

    /// Position of a joint in the bind pose.
    fn joint(&self, column: usize, at: usize) -> Vec3 {
        (self.place)(column as f32 / self.gaps() as f32, at as f32 / self.bones as f32)
    }

    fn add_column(&self, rig: &mut Rig, on: JointIdx, column: usize) {
        let (mut parent, mut above) = (on, Vec3::ZERO);
        let mut at = Some(on);
        // Joints of the mannequin are not rotated in its bind pose.
        while let Some(joint) = at {
            above += rig.joints[joint].rest.translation;
            at = rig.joints[joint].parent;
        }
        for bone in 0..=self.bones {
            let place = self.joint(column, bone);
            let rest = LocalTransform { translation: place - above, ..LocalTransform::default() };
            let source = rig.joints.len();
            let name = format!("{}_{column}_{bone}", self.name);
            rig.joints.push(Joint { name, parent: Some(parent), rest, source });
            (parent, above) = (source, place);
        }
    }

    /// Adds a skin over the chains, whose joints begin at `first`; each vertex moves with bones of its two neighbouring
    /// chains.
    fn add_skin(&self, rig: &mut Rig, first: JointIdx) {
        let joints = self.bones + 1;
        let slot = |column: usize, bone: usize| ((column % self.columns) * joints + bone) as u16;
        let mut primitive = Primitive { base_color: self.color, ..Primitive::default() };
        let (wide, high) = (self.gaps() * PARTS, self.bones * PARTS);
        for across in 0..=wide {
            let column = usize::min(across / PARTS, self.gaps() - 1);
            let share = (across - column * PARTS) as f32 / PARTS as f32;
            for down in 0..=high {
                // Half a bone on either side of a joint is weighted to both bones.
                let along = down as f32 / PARTS as f32 - 0.5;
                let upper = usize::min(max(along, 0.0) as usize, self.bones - 1);
                let lower = usize::min(upper + 1, self.bones - 1);
                let next = if lower == upper { 0.0 } else { max(along - upper as f32, 0.0) };
                let slots = [
                    slot(column, upper),
                    slot(column, lower),
                    slot(column + 1, upper),
                    slot(column + 1, lower),
                ];
                let [here, there] = [1.0 - share, share];
                primitive.joints.push(slots);
                primitive.weights.push([
                    here * (1.0 - next),
                    here * next,
                    there * (1.0 - next),
                    there * next,
                ]);
                primitive
                    .positions
                    .push((self.place)(across as f32 / wide as f32, down as f32 / high as f32));
            }
        }
        let vertex = |across: usize, down: usize| (across * (high + 1) + down) as u32;
        for across in 0..wide {
            for down in 0..high {
                let [a, b] = [vertex(across, down), vertex(across + 1, down)];
                let [c, d] = [vertex(across + 1, down + 1), vertex(across, down + 1)];
                // Add triangles for both sides.
                primitive.indices.extend([a, b, c, a, c, d, a, c, b, a, d, c]);
            }
        }
        let skin_joints: Vec<JointIdx> = (first..rig.joints.len()).collect();
        let bind = |&joint: &JointIdx| {
            let place = self.joint((joint - first) / joints, (joint - first) % joints);
            Affine::from(Transform::from_translation(-place))
        };
        let inverse_bind = skin_joints.iter().map(bind).collect();
        let name = self.name.to_owned();
        rig.skins.push(Skin { name: name.clone(), joints: skin_joints, inverse_bind });
        let skin = Some(rig.skins.len() - 1);
        rig.meshes.push(RigMesh { name, joint: first, skin, primitives: vec![primitive] });
    }
}

/// The mannequin in these garments as a character: the motions of
/// [`mannequin::character`](crate::mannequin::character), and the garments detected by joint names, each changed by
/// `adjust`.
///
/// # Panics
/// Never panics, because the character is valid.
pub fn dressed(garments: &[&Chains], adjust: impl Fn(&mut Garment)) -> CharacterDef {
    let bare = crate::mannequin::mannequin().rig;
    let (ragdoll, _) =
        build(&bare, &analyze(&bare).expect("the mannequin has a skin"), &BuildOptions::default())
            .expect("the rig can be built");
    let rig = dressed_rig(garments);
    let analysis = analyze(&rig).expect("the mannequin has a skin");
    let mut worn = guess_garments(&rig);
    worn.iter_mut().for_each(adjust);
    let mut def = CharacterDef::new(rig, ragdoll, &analysis.bind_model);
    def.set_motions(crate::mannequin::character().motions().clone())
        .expect("the mannequin's clips are valid");
    def.set_garments(&worn);
    def
}
