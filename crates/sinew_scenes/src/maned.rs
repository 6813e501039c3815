//! The mannequin with hair: a ponytail and two braids of rigid links on its head, with springs as in avatar files.

use sinew::anim::springs::{ColliderShape, Side};
use sinew::anim::{
    Joint, JointIdx, LocalTransform, Primitive, Rig, RigMesh, SpringBone, SpringChain, SpringCollider,
    Springs, analyze,
};
use sinew::math::Vec3;
use sinew::ragdoll::{BuildOptions, CharacterDef, build};

/// Strand of hair.
struct Strand {
    name: &'static str,
    /// Position of the strand's root, and vector of each link, in the head's axes, metres.
    root: Vec3,
    link: Vec3,
    links: usize,
}

const STRANDS: [Strand; 3] = [
    Strand {
        name: "hair_back",
        root: Vec3::new(0.0, 0.14, -0.1),
        link: Vec3::new(0.0, -0.055, -0.03),
        links: 5,
    },
    Strand {
        name: "hair_left",
        root: Vec3::new(0.09, 0.08, 0.0),
        link: Vec3::new(0.02, -0.06, 0.0),
        links: 4,
    },
    Strand {
        name: "hair_right",
        root: Vec3::new(-0.09, 0.08, 0.0),
        link: Vec3::new(-0.02, -0.06, 0.0),
        links: 4,
    },
];

/// Settings of the hair, typical for avatars.
pub const HAIR: SpringBone = SpringBone {
    joint: 0,
    tail: Vec3::ZERO,
    stiffness: 0.8,
    gravity: Vec3::new(0.0, -0.2, 0.0),
    drag: 0.4,
    radius: 0.015,
    limit: None,
};

const COLOR: [f32; 4] = [0.10, 0.05, 0.03, 1.0];
/// Half a link's thickness, metres.
const THIN: f32 = 0.02;

/// Rig of the mannequin with hair, its springs with these `settings`, and a ball for the head as their collider.
///
/// # Panics
/// Never panics, because the mannequin has a head.
pub fn maned_rig(settings: &SpringBone) -> Rig {
    let mut rig = crate::mannequin::mannequin().rig;
    let head = rig.joints.iter().position(|joint| joint.name == "head").expect("the character has a head");
    let shape = ColliderShape::Sphere { offset: Vec3::Y * 0.1, radius: 0.09, keeps: Side::Outside };
    let colliders = vec![SpringCollider { joint: head, shape }];
    let chains = STRANDS.iter().map(|strand| grow(&mut rig, head, strand, settings)).collect();
    rig.springs = Springs { chains, colliders, ..Springs::default() };
    rig
}

/// Adds the joints and links of a strand, and a joint for its end.
fn grow(rig: &mut Rig, head: JointIdx, strand: &Strand, settings: &SpringBone) -> SpringChain {
    let mut parent = head;
    let mut bones = Vec::new();
    for link in 0..=strand.links {
        let joint = rig.joints.len();
        let translation = if link == 0 { strand.root } else { strand.link };
        let rest = LocalTransform { translation, ..LocalTransform::default() };
        let name = format!("{}_{link}", strand.name);
        let parts = rig.joints.len();
        rig.joints.push(Joint { name, parent: Some(parent), rest, source: parts });
        if link < strand.links {
            bones.push(SpringBone { joint, tail: strand.link, ..*settings });
            let name = strand.name.to_owned();
            rig.meshes.push(RigMesh { name, joint, skin: None, primitives: vec![spindle(strand.link)] });
        }
        parent = joint;
    }
    SpringChain { name: strand.name.to_owned(), bones, center: None, colliders: vec![0], hits_body: false }
}

/// Mesh of a link: two pyramids on a common square, at 30 % of the link's length.
fn spindle(way: Vec3) -> Primitive {
    let along = way / way.length();
    let side = sinew::math::any_orthonormal(along) * THIN;
    let other = along.cross(side);
    let belly = way * 0.3;
    let corners = [Vec3::ZERO, belly + side, belly + other, belly - side, belly - other, way];
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for turn in 0..4 {
        let (a, b) = (1 + turn, 1 + (turn + 1) % 4);
        for corner in [0, b, a, 5, a, b] {
            indices.push(positions.len() as u32);
            positions.push(corners[corner]);
        }
    }
    Primitive { positions, indices, base_color: COLOR, ..Primitive::default() }
}

/// The mannequin with hair as a character: the motions of [`mannequin::character`](crate::mannequin::character).
///
/// # Panics
/// Never panics, because the character can be built.
pub fn maned(settings: &SpringBone) -> CharacterDef {
    let rig = maned_rig(settings);
    let analysis = analyze(&rig).expect("the mannequin has a skin");
    let (ragdoll, _) = build(&rig, &analysis, &BuildOptions::default()).expect("the rig can be built");
    let mut def = CharacterDef::new(rig, ragdoll, &analysis.bind_model);
    def.set_motions(crate::mannequin::character().motions().clone())
        .expect("the mannequin's clips are valid");
    def
}
