//! Random avatar files: the mannequin with many strands of hair, as VRM 1 (`VRMC_springBone` with extended colliders
//! and limits) and VRM 0 (`secondaryAnimation`), with random values in all fields of these formats.

use sinew::anim::springs::{ColliderShape, LimitKind, Side};
use sinew::anim::{
    Joint, LocalTransform, Rig, SpringBone, SpringChain, SpringCollider, SpringLimit, Springs,
};
use sinew::formats::gltf::{SpringFormat, write_gltf};
use sinew::math::{Affine, Random, Rotation, Vec3};

/// Returns a rig with springs as a VRM file. Features that VRM 0 lacks are omitted.
pub fn vrm(rig: &Rig, format: SpringFormat) -> Vec<u8> {
    let bytes = write_gltf(rig, &[]).expect("a rig made by code can be written");
    let length = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
    let (text, rest) = (&bytes[20..20 + length], &bytes[20 + length..]);
    let text = std::str::from_utf8(text).expect("JSON").trim_end();
    let head = text.strip_suffix('}').expect("an object");
    let springs = match format {
        SpringFormat::Vrm0 => version_0(&rig.springs),
        SpringFormat::Vrm1 => version_1(&rig.springs),
    };
    let mut text = format!("{head},\"extensions\":{{{springs}}}}}");
    text += &" ".repeat(text.len().next_multiple_of(4) - text.len());
    let mut vrm = b"glTF\x02\0\0\0".to_vec();
    vrm.extend((20 + text.len() + rest.len()).to_le_bytes()[..4].iter());
    vrm.extend(text.len().to_le_bytes()[..4].iter());
    vrm.extend(b"JSON");
    vrm.extend(text.as_bytes());
    vrm.extend(rest);
    vrm
}

fn list<T>(items: impl IntoIterator<Item = T>, text: impl Fn(T) -> String) -> String {
    format!("[{}]", items.into_iter().map(text).collect::<Vec<_>>().join(","))
}

fn array(v: Vec3) -> String {
    format!("{:?}", v.to_array())
}

/// Returns the springs as `VRMC_springBone`: one group per collider; each spring lists one joint more than it has
/// bones.
fn version_1(springs: &Springs) -> String {
    let spring = |chain: &SpringChain| {
        let last = chain.bones.last().expect("it has some").joint + 1;
        let mut joints: Vec<String> = chain.bones.iter().map(joint_1).collect();
        joints.push(format!("{{\"node\":{last}}}"));
        let center = chain.center.map_or(String::new(), |joint| format!(",\"center\":{joint}"));
        format!(
            "{{\"name\":\"{}\",\"joints\":[{}],\"colliderGroups\":{:?}{center}}}",
            chain.name,
            joints.join(","),
            chain.colliders
        )
    };
    format!(
        "\"VRMC_springBone\":{{\"specVersion\":\"1.0\",\"colliders\":{},\"colliderGroups\":{},\"springs\":{}}}",
        list(&springs.colliders, collider_1),
        list(0..springs.colliders.len(), |index| format!("{{\"colliders\":[{index}]}}")),
        list(&springs.chains, spring)
    )
}

fn joint_1(bone: &SpringBone) -> String {
    let limit = bone.limit.map_or(String::new(), |limit| {
        let kind = match limit.kind {
            LimitKind::Cone { angle } => format!("\"cone\":{{\"angle\":{angle:?}"),
            LimitKind::Hinge { angle } => format!("\"hinge\":{{\"angle\":{angle:?}"),
            LimitKind::Spherical { phi, theta } => format!("\"spherical\":{{\"phi\":{phi:?},\"theta\":{theta:?}"),
        };
        let Rotation { x, y, z, w } = limit.rotation;
        format!(
            ",\"extensions\":{{\"VRMC_springBone_limit\":{{\"limit\":{{{kind},\"rotation\":[{x:?},{y:?},{z:?},{w:?}]}}}}}}}}"
        )
    });
    format!(
        "{{\"node\":{},\"stiffness\":{:?},\"gravityPower\":1.0,\"gravityDir\":{},\"dragForce\":{:?},\"hitRadius\":{:?}{limit}}}",
        bone.joint,
        bone.stiffness,
        array(bone.gravity),
        bone.drag,
        bone.radius
    )
}

fn collider_1(collider: &SpringCollider) -> String {
    let (plain, extended) = match collider.shape {
        ColliderShape::Sphere { offset, radius, keeps } => {
            let ball = format!("\"offset\":{},\"radius\":{radius:?}", array(offset));
            let inside = format!("\"sphere\":{{{ball},\"inside\":true}}");
            (format!("\"sphere\":{{{ball}}}"), (keeps == Side::Inside).then_some(inside))
        }
        ColliderShape::Capsule { offset, tail, radius, keeps } => {
            let ends = format!("\"offset\":{},\"tail\":{},\"radius\":{radius:?}", array(offset), array(tail));
            let inside = format!("\"capsule\":{{{ends},\"inside\":true}}");
            (format!("\"capsule\":{{{ends}}}"), (keeps == Side::Inside).then_some(inside))
        }
        ColliderShape::Plane { offset, normal } => {
            let plane = format!("\"plane\":{{\"offset\":{},\"normal\":{}}}", array(offset), array(normal));
            ("\"sphere\":{\"offset\":[0,-10000,0]}".to_owned(), Some(plane))
        }
    };
    let extended = extended.map_or(String::new(), |shape| {
        format!(
            ",\"extensions\":{{\"VRMC_springBone_extended_collider\":{{\"specVersion\":\"1.0\",\"shape\":{{{shape}}}}}}}"
        )
    });
    format!("{{\"node\":{},\"shape\":{{{plain}}}{extended}}}", collider.joint)
}

/// Returns the springs as `secondaryAnimation`: one group per chain, whose first joint swings with all its descendants.
/// Shapes that this format lacks are omitted.
fn version_0(springs: &Springs) -> String {
    let unity = |v: Vec3| format!("{{\"x\":{:?},\"y\":{:?},\"z\":{:?}}}", v.x, v.y, -v.z);
    let balls = |collider: &SpringCollider| {
        let ball = match collider.shape {
            ColliderShape::Sphere { offset, radius, keeps: Side::Outside } => {
                format!("{{\"offset\":{},\"radius\":{radius:?}}}", unity(offset))
            }
            _ => String::new(),
        };
        format!("{{\"node\":{},\"colliders\":[{ball}]}}", collider.joint)
    };
    let group = |chain: &SpringChain| {
        let bone = &chain.bones[0];
        format!(
            "{{\"comment\":\"{}\",\"stiffiness\":{:?},\"gravityPower\":1.0,\"gravityDir\":{},\"dragForce\":{:?},\
             \"center\":{},\"hitRadius\":{:?},\"bones\":[{}],\"colliderGroups\":{:?}}}",
            chain.name,
            bone.stiffness,
            unity(bone.gravity),
            bone.drag,
            chain.center.map_or("-1".to_owned(), |joint| joint.to_string()),
            bone.radius,
            bone.joint,
            chain.colliders
        )
    };
    format!(
        "\"VRM\":{{\"secondaryAnimation\":{{\"boneGroups\":{},\"colliderGroups\":{}}}}}",
        list(&springs.chains, group),
        list(&springs.colliders, balls)
    )
}

/// Directions of strands from the head: down, sideways, out and up.
const WAYS: [Vec3; 6] = [
    Vec3::new(0.0, -0.06, -0.02),
    Vec3::new(0.05, -0.03, 0.0),
    Vec3::new(-0.05, 0.0, 0.02),
    Vec3::new(0.0, 0.0, -0.07),
    Vec3::new(0.02, 0.05, 0.0),
    Vec3::new(0.0, -0.08, 0.0),
];

/// Adds a strand of three to six bones per direction to the head, without springs yet. Returns the joints of each
/// strand, including its end.
pub fn strands(rig: &mut Rig) -> Vec<Vec<usize>> {
    let head = rig.joints.iter().position(|joint| joint.name == "head").expect("the character has a head");
    let mut strands = Vec::new();
    for (index, &way) in WAYS.iter().chain(&WAYS).enumerate() {
        let (mut parent, mut joints) = (head, Vec::new());
        let root = Vec3::new(way.x, 0.1, way.z).normalize() * 0.1 + Vec3::Y * 0.05;
        for link in 0..=3 + index % 4 {
            let joint = rig.joints.len();
            let translation = if link == 0 { root } else { way };
            // Every other strand curls.
            let curl = if index % 2 == 0 { 0.0 } else { 0.2 };
            let rotation = Rotation::from_axis_angle(Vec3::X, curl);
            let rest = LocalTransform { translation, rotation, ..LocalTransform::default() };
            let name = format!("strand_{index}_{link}");
            rig.joints.push(Joint { name, parent: Some(parent), rest, source: joint });
            joints.push(joint);
            parent = joint;
        }
        strands.push(joints);
    }
    strands
}

/// Rate at which springs come to rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Calming {
    /// Usual drag and stiffness of avatars.
    Soon,
    /// Almost no stiffness, or no drag.
    Late,
}

/// Returns settings of a strand from stiff to limp, with and without optional values.
fn settings(random: &mut Random, calming: Calming) -> SpringBone {
    let (stiffness, drag) = match calming {
        Calming::Soon => {
            ([0.3, 0.5, 1.0, 2.0, 4.0][random.index(5)], [0.1, 0.25, 0.4, 0.7, 1.0][random.index(5)])
        }
        Calming::Late => ([0.05, 0.2, 1.0][random.index(3)], [0.0, 0.0, 0.4, 1.0][random.index(4)]),
    };
    let to = Vec3::new(random.range(-0.3, 0.3), random.range(-1.5, -0.1), random.range(-0.3, 0.3));
    let limits = [
        LimitKind::Cone { angle: random.range(0.05, 1.5) },
        LimitKind::Hinge { angle: random.range(0.05, 1.5) },
        LimitKind::Spherical { phi: random.range(0.05, 1.5), theta: random.range(0.05, 1.0) },
    ];
    let rotation = Rotation::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), random.range(-0.3, 0.3));
    let kind = limits[random.index(3)];
    SpringBone {
        stiffness,
        gravity: if random.index(3) == 0 { Vec3::ZERO } else { to * stiffness },
        drag,
        radius: [0.0, 0.01, 0.03][random.index(3)],
        limit: (random.index(3) == 0).then_some(SpringLimit { kind, rotation }),
        ..SpringBone::default()
    }
}

/// Returns the position of a strand's joint at rest, in the head's space.
fn place(rig: &Rig, joints: &[usize]) -> Vec3 {
    let along = |at: Affine, &joint: &usize| at * rig.joints[joint].rest.to_affine();
    joints.iter().fold(Affine::IDENTITY, along).translation
}

/// Returns a shape that touches or contains a point of a strand, in the head's space; the strand starts at `root`.
fn touching(random: &mut Random, root: Vec3, place: Vec3, thick: f32) -> ColliderShape {
    let out = random.direction();
    let radius = random.range(0.02, 0.1);
    // The tip is up to 1 cm inside of the collider, or up to 3 cm outside.
    let middle = place - out * (radius + thick - random.range(-0.01, 0.03));
    match random.index(5) {
        0 => ColliderShape::Sphere { offset: middle, radius, keeps: Side::Outside },
        1 => {
            let tail = middle + random.direction() * 0.1;
            ColliderShape::Capsule { offset: middle, tail, radius, keeps: Side::Outside }
        }
        2 => ColliderShape::Plane { offset: place + out * (random.range(-0.01, 0.03) - thick), normal: out },
        3 => {
            let radius = (place - root).length() * random.range(0.7, 1.05) + thick;
            ColliderShape::Sphere { offset: root, radius, keeps: Side::Inside }
        }
        _ => {
            let tail = root + (place - root) * random.range(0.5, 1.0);
            ColliderShape::Capsule {
                offset: root,
                tail,
                radius: random.range(0.03, 0.06),
                keeps: Side::Inside,
            }
        }
    }
}

/// Returns springs on strands, each with its own settings and up to two colliders that it touches at rest.
pub fn random_avatar(rig: &Rig, strands: &[Vec<usize>], calming: Calming, random: &mut Random) -> Springs {
    let mut springs = Springs::default();
    for joints in strands {
        let head = rig.joints[joints[0]].parent.expect("its parent is the head");
        let usual = settings(random, calming);
        let mut colliders = Vec::new();
        for _ in 0..random.index(3) {
            let last = 1 + random.index(joints.len() - 1);
            let (root, tip) = (place(rig, &joints[..1]), place(rig, &joints[..=last]));
            colliders.push(springs.colliders.len());
            let shape = touching(random, root, tip, usual.radius);
            springs.colliders.push(SpringCollider { joint: head, shape });
        }
        let softer = random.index(2) == 0;
        let bone = |pair: &[usize]| {
            let tail = rig.joints[pair[1]].rest.translation;
            SpringBone { joint: pair[0], tail, ..usual }
        };
        let mut bones: Vec<SpringBone> = joints.windows(2).map(bone).collect();
        if softer {
            // The springs are softer toward the end, as modellers make them.
            bones.iter_mut().enumerate().for_each(|(index, bone)| bone.stiffness /= 1.0 + index as f32);
        }
        let center = [None, None, Some(head), Some(0)][random.index(4)];
        let name = rig.joints[joints[0]].name.clone();
        springs.chains.push(SpringChain { name, bones, center, colliders, hits_body: false });
    }
    springs
}
