//! Rigs of boxes built in code: a human, a dog, a beetle.

use sinew_anim::{Joint, LocalTransform, Primitive, Rig, RigMesh, Skin};
use sinew_math::{Affine, Vec3};

/// Name, parent's name, joint position, lowest and highest corner of its box; metres.
type Bone = (&'static str, &'static str, [f32; 3], [f32; 3], [f32; 3]);

/// Parts of the centre and the left side (+X). Each left part is mirrored; the mirrored name has `R` for the last `L`.
struct Figure {
    middle: &'static [Bone],
    left: &'static [Bone],
}

const BLOCK_MAN: Figure = Figure {
    middle: &[
        ("hips", "", [0.0, 0.95, 0.0], [-0.17, 0.84, -0.11], [0.17, 1.04, 0.11]),
        ("spine", "hips", [0.0, 1.04, 0.0], [-0.15, 1.04, -0.1], [0.15, 1.24, 0.1]),
        ("chest", "spine", [0.0, 1.24, 0.0], [-0.18, 1.24, -0.12], [0.18, 1.48, 0.12]),
        ("neck", "chest", [0.0, 1.48, 0.0], [-0.05, 1.48, -0.05], [0.05, 1.55, 0.05]),
        ("head", "neck", [0.0, 1.55, 0.0], [-0.08, 1.55, -0.09], [0.08, 1.8, 0.11]),
    ],
    left: &[
        ("upper_arm.L", "chest", [0.19, 1.43, 0.0], [0.19, 1.38, -0.05], [0.47, 1.48, 0.05]),
        ("forearm.L", "upper_arm.L", [0.47, 1.43, 0.0], [0.47, 1.39, -0.04], [0.72, 1.47, 0.04]),
        ("hand.L", "forearm.L", [0.72, 1.43, 0.0], [0.72, 1.41, -0.05], [0.9, 1.45, 0.05]),
        ("thigh.L", "hips", [0.1, 0.9, 0.0], [0.03, 0.5, -0.08], [0.17, 0.9, 0.08]),
        ("shin.L", "thigh.L", [0.1, 0.5, 0.0], [0.04, 0.09, -0.06], [0.16, 0.5, 0.06]),
        ("foot.L", "shin.L", [0.1, 0.09, 0.0], [0.05, 0.0, -0.07], [0.15, 0.09, 0.2]),
    ],
};

const DOG: Figure = Figure {
    middle: &[
        ("pelvis", "", [0.0, 0.55, -0.3], [-0.11, 0.44, -0.4], [0.11, 0.66, -0.1]),
        ("back", "pelvis", [0.0, 0.57, -0.1], [-0.11, 0.44, -0.1], [0.11, 0.67, 0.15]),
        ("ribs", "back", [0.0, 0.57, 0.15], [-0.12, 0.4, 0.15], [0.12, 0.68, 0.38]),
        ("neck", "ribs", [0.0, 0.62, 0.38], [-0.06, 0.56, 0.38], [0.06, 0.76, 0.52]),
        ("head", "neck", [0.0, 0.7, 0.52], [-0.07, 0.64, 0.52], [0.07, 0.82, 0.76]),
        ("tail", "pelvis", [0.0, 0.6, -0.4], [-0.03, 0.57, -0.66], [0.03, 0.63, -0.4]),
    ],
    left: &[
        ("front_leg.L", "ribs", [0.1, 0.5, 0.3], [0.05, 0.24, 0.25], [0.15, 0.5, 0.36]),
        ("front_shin.L", "front_leg.L", [0.1, 0.24, 0.3], [0.07, 0.05, 0.26], [0.13, 0.24, 0.34]),
        ("front_paw.L", "front_shin.L", [0.1, 0.05, 0.3], [0.06, 0.0, 0.26], [0.14, 0.05, 0.4]),
        ("hind_leg.L", "pelvis", [0.1, 0.5, -0.3], [0.05, 0.25, -0.37], [0.16, 0.5, -0.22]),
        ("hind_shin.L", "hind_leg.L", [0.1, 0.25, -0.32], [0.07, 0.05, -0.37], [0.13, 0.25, -0.28]),
        ("hind_paw.L", "hind_shin.L", [0.1, 0.05, -0.32], [0.06, 0.0, -0.36], [0.14, 0.05, -0.22]),
    ],
};

const BEETLE: Figure = Figure {
    middle: &[
        ("body", "", [0.0, 0.16, -0.02], [-0.13, 0.1, -0.26], [0.13, 0.26, 0.1]),
        ("head", "body", [0.0, 0.15, 0.1], [-0.08, 0.09, 0.1], [0.08, 0.2, 0.24]),
    ],
    left: &[
        ("leg1.L", "body", [0.12, 0.14, 0.06], [0.12, 0.12, 0.04], [0.26, 0.16, 0.08]),
        ("tip1.L", "leg1.L", [0.26, 0.14, 0.06], [0.24, 0.0, 0.04], [0.28, 0.14, 0.08]),
        ("leg2.L", "body", [0.12, 0.14, -0.06], [0.12, 0.12, -0.08], [0.28, 0.16, -0.04]),
        ("tip2.L", "leg2.L", [0.28, 0.14, -0.06], [0.26, 0.0, -0.08], [0.3, 0.14, -0.04]),
        ("leg3.L", "body", [0.12, 0.14, -0.18], [0.12, 0.12, -0.2], [0.26, 0.16, -0.16]),
        ("tip3.L", "leg3.L", [0.26, 0.14, -0.18], [0.24, 0.0, -0.2], [0.28, 0.14, -0.16]),
    ],
};

/// Returns a human of sixteen boxes.
pub fn block_man() -> Rig {
    BLOCK_MAN.rig()
}

/// Returns a dog of eighteen boxes.
pub fn dog() -> Rig {
    DOG.rig()
}

/// Returns a beetle of fourteen boxes.
pub fn beetle() -> Rig {
    BEETLE.rig()
}

impl Figure {
    fn rig(&self) -> Rig {
        let mut boxes = Boxes::default();
        self.middle.iter().for_each(|bone| boxes.add(bone, false));
        for mirrored in [false, true] {
            self.left.iter().for_each(|bone| boxes.add(bone, mirrored));
        }
        boxes.rig()
    }
}

#[derive(Default)]
struct Boxes {
    joints: Vec<Joint>,
    places: Vec<Vec3>,
    skin: Primitive,
}

impl Boxes {
    fn add(&mut self, &(name, parent, place, low, high): &Bone, mirrored: bool) {
        let named = |name: &str| if mirrored { name.replace(".L", ".R") } else { name.to_owned() };
        let way = if mirrored { Vec3::new(-1.0, 1.0, 1.0) } else { Vec3::ONE };
        let [place, a, b] = [place, low, high].map(|at| Vec3::from_array(at) * way);
        let on = self.joints.iter().position(|joint| joint.name == named(parent));
        let under = on.map_or(Vec3::ZERO, |on| self.places[on]);
        let rest = LocalTransform { translation: place - under, ..LocalTransform::default() };
        let source = self.joints.len();
        self.joints.push(Joint { name: named(name), parent: on, rest, source });
        self.places.push(place);
        let first = u32::try_from(self.skin.positions.len()).expect("the count fits");
        let slot = u16::try_from(source).expect("the count fits");
        for corner in 0..8 {
            let pick = |axis: usize| if corner >> axis & 1 == 0 { a[axis] } else { b[axis] };
            self.skin.positions.push(Vec3::new(pick(0), pick(1), pick(2)));
            self.skin.joints.push([slot, 0, 0, 0]);
            self.skin.weights.push([1.0, 0.0, 0.0, 0.0]);
        }
        // Outward faces; a mirror reverses their winding.
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        for [p, q, r, s] in faces {
            let (q, s) = if mirrored { (s, q) } else { (q, s) };
            self.skin.indices.extend([p, q, r, p, r, s].map(|corner: u32| first + corner));
        }
    }

    fn rig(self) -> Rig {
        let inverse_bind =
            self.places.iter().map(|&place| Affine { translation: -place, ..Affine::IDENTITY }).collect();
        let skin = Skin { name: "boxes".into(), joints: (0..self.joints.len()).collect(), inverse_bind };
        let mesh = RigMesh { name: "boxes".into(), joint: 0, skin: Some(0), primitives: vec![self.skin] };
        Rig { joints: self.joints, skins: vec![skin], meshes: vec![mesh], ..Rig::default() }
    }
}
