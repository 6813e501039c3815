//! Poses the mannequin: trunk by rotations, hands and feet by position.

use super::skeleton::{ANKLE_HEIGHT, Bone, HIPS_ABOVE_HIP, Side, bind_offset, bind_position, left_arm_axes};
use crate::anim::LocalTransform;
use crate::math::{Mat3, Rotation, Vec3, clamp, normalize_or, trig};

/// Distance from the centre of the knee to its skin in front, metres.
const KNEE_RADIUS: f32 = 0.056;

/// A rotation in degrees: x leans forward, y turns left, z tips right. Applied in the order z, x, y.
pub(super) type Turn = Vec3;

/// A whole-body posture in world space (+Y up, floor at y = 0), metres and degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Posture {
    /// Position of the hips joint.
    pub(super) pelvis: Vec3,
    /// Rotation of the pelvis relative to the world.
    pub(super) pelvis_turn: Turn,
    /// Rotation of each trunk joint relative to its parent.
    pub(super) spine: Turn,
    pub(super) chest: Turn,
    pub(super) neck: Turn,
    pub(super) head: Turn,
    pub(super) left_foot: Foot,
    pub(super) right_foot: Foot,
    pub(super) left_hand: Hand,
    pub(super) right_hand: Hand,
}

/// Position and rotation of a foot. The leg follows by inverse kinematics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Foot {
    /// Position of the ankle.
    pub(super) ankle: Vec3,
    /// Rotation of the foot relative to the world; zero is flat and points along +Z.
    pub(super) turn: Turn,
    /// Angle by which the toes bend up relative to the foot, degrees.
    pub(super) toes: f32,
    /// Angle by which the knee's hinge turns outward relative to the pelvis, degrees.
    pub(super) knee_out: f32,
}

/// Position of the wrist and pose of the hand. The arm follows by inverse kinematics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hand {
    /// Position of the wrist.
    pub(super) wrist: Vec3,
    /// 0: in line with the forearm; 1: palm flat on the floor.
    pub(super) flat: f32,
    /// Direction of the fingers of a flat hand, degrees: 0 along +Z, 90 outward.
    pub(super) fingers_out: f32,
    /// Angle by which the elbow turns outward and up from behind the body, about the line from shoulder to wrist,
    /// degrees.
    pub(super) elbow_out: f32,
}

/// Angles of an arm that hangs from the chest, degrees.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hanging {
    /// Angle of the upper arm forward of straight down.
    pub(super) forward: f32,
    /// Angle of the upper arm away from the body.
    pub(super) out: f32,
    /// Bend angle of the elbow.
    pub(super) elbow: f32,
}

impl Foot {
    /// Returns a foot flat on the floor, toes a little outward.
    pub(super) fn flat(side: Side, x: f32, z: f32, out: f32) -> Self {
        let turn = Vec3::new(0.0, out * side.sign(), 0.0);
        Self { ankle: Vec3::new(x, ANKLE_HEIGHT, z), turn, toes: 0.0, knee_out: out }
    }

    /// Like [`flat`](Self::flat), with the heel lifted by `pitch` degrees about the ball; the toes stay down.
    pub(super) fn on_ball(side: Side, x: f32, z: f32, out: f32, pitch: f32) -> Self {
        let flat = Self::flat(side, x, z, out);
        let ball = bind_position(Bone::LeftToes) - bind_position(Bone::LeftFoot);
        let contact = flat.ankle + turn(flat.turn) * ball;
        let raised = Vec3::new(pitch, flat.turn.y, 0.0);
        Self { ankle: contact - turn(raised) * ball, turn: raised, toes: pitch, ..flat }
    }
}

/// Converts a turn to a rotation.
pub(super) fn turn(degrees: Turn) -> Rotation {
    let about = |axis: Vec3, angle: f32| Rotation::from_axis_angle(axis, angle.to_radians());
    about(Vec3::Y, degrees.y) * about(Vec3::X, degrees.x) * about(Vec3::Z, degrees.z)
}

/// World position and rotation of each joint, computed parent first.
struct Placed {
    position: [Vec3; Bone::COUNT],
    rotation: [Rotation; Bone::COUNT],
}

impl Placed {
    fn at(&self, bone: Bone) -> (Vec3, Rotation) {
        (self.position[bone.index()], self.rotation[bone.index()])
    }

    fn set(&mut self, bone: Bone, world: Rotation) {
        let parent = bone.parent().map_or((Vec3::ZERO, Rotation::IDENTITY), |p| self.at(p));
        self.position[bone.index()] = parent.0 + parent.1 * bind_offset(bone);
        self.rotation[bone.index()] = world.normalize();
    }

    fn set_local(&mut self, bone: Bone, local: Rotation) {
        let parent = bone.parent().map_or(Rotation::IDENTITY, |p| self.at(p).1);
        self.set(bone, parent * local);
    }
}

impl Posture {
    /// Upright posture on both feet with hanging arms: the end of every clip that ends on its feet.
    pub(super) fn standing() -> Self {
        let hand = Hand { wrist: Vec3::ZERO, flat: 0.0, fingers_out: 0.0, elbow_out: 0.0 };
        let posture = Self {
            pelvis: Vec3::new(0.0, 0.916 + HIPS_ABOVE_HIP, 0.0),
            pelvis_turn: Vec3::new(2.0, 0.0, 0.0),
            spine: Vec3::new(-2.0, 0.0, 0.0),
            chest: Vec3::ZERO,
            neck: Vec3::new(3.0, 0.0, 0.0),
            head: Vec3::new(-3.0, 0.0, 0.0),
            left_foot: Foot::flat(Side::Left, 0.105, 0.0, 8.0),
            right_foot: Foot::flat(Side::Right, -0.105, 0.0, 8.0),
            left_hand: hand,
            right_hand: hand,
        };
        posture.with_arms(Hanging { forward: 2.0, out: 7.0, elbow: 16.0 })
    }

    /// Returns the posture with both arms hanging symmetrically.
    pub(super) fn with_arms(self, hanging: Hanging) -> Self {
        self.with_arm(Side::Left, hanging).with_arm(Side::Right, hanging)
    }

    /// Returns the posture with one arm hanging from the current chest.
    pub(super) fn with_arm(mut self, side: Side, hanging: Hanging) -> Self {
        let placed = self.place_trunk();
        let (shoulder, _) = placed.at(Bone::LeftUpperArm.on(side));
        let chest = placed.at(Bone::Chest).1;
        let arm = turn(Vec3::new(-hanging.forward, 0.0, hanging.out * side.sign()));
        let fore = arm * turn(Vec3::new(-hanging.elbow, 0.0, 0.0));
        let (upper_length, fore_length) = (Limb::arm(side).upper.length(), Limb::arm(side).lower.length());
        let wrist =
            shoulder + chest * (arm * (Vec3::NEG_Y * upper_length) + fore * (Vec3::NEG_Y * fore_length));
        let hand = if side == Side::Left { &mut self.left_hand } else { &mut self.right_hand };
        *hand = Hand { wrist, flat: 0.0, fingers_out: 0.0, elbow_out: 0.0 };
        self
    }

    /// Returns the posture with one knee on the floor behind the hip, and the ankle behind the knee, `height` above
    /// the floor and `x` to the left.
    pub(super) fn with_knee_down(mut self, side: Side, x: f32, height: f32, pitch: f32, toes: f32) -> Self {
        let hip = self.place_trunk().at(Bone::LeftUpperLeg.on(side)).0;
        let leg = Limb::leg(side);
        let behind = |bone: Vec3, drop: f32, aside: f32| {
            let left = bone.length_squared() - drop * drop - aside * aside;
            if left > 0.0 { left.sqrt() } else { 0.0 }
        };
        let knee_z = hip.z - behind(leg.upper, hip.y - KNEE_RADIUS, x - hip.x);
        let ankle = Vec3::new(x, height, knee_z - behind(leg.lower, height - KNEE_RADIUS, 0.0));
        let foot = if side == Side::Left { &mut self.left_foot } else { &mut self.right_foot };
        *foot = Foot { ankle, turn: Vec3::new(pitch, 0.0, 0.0), toes, knee_out: 0.0 };
        self
    }

    /// Every number of the posture, in one fixed order, for interpolation.
    pub(super) fn numbers(&mut self) -> Vec<&mut f32> {
        let Self { pelvis, pelvis_turn, spine, chest, neck, head, .. } = self;
        let mut vectors = vec![pelvis, pelvis_turn, spine, chest, neck, head];
        let mut scalars = Vec::new();
        for foot in [&mut self.left_foot, &mut self.right_foot] {
            vectors.extend([&mut foot.ankle, &mut foot.turn]);
            scalars.extend([&mut foot.toes, &mut foot.knee_out]);
        }
        for hand in [&mut self.left_hand, &mut self.right_hand] {
            vectors.push(&mut hand.wrist);
            scalars.extend([&mut hand.flat, &mut hand.fingers_out, &mut hand.elbow_out]);
        }
        let of_vectors = vectors.into_iter().flat_map(|v| [&mut v.x, &mut v.y, &mut v.z]);
        of_vectors.chain(scalars).collect()
    }

    /// Local transforms of all joints, in the rig's order.
    pub(super) fn solve(&self) -> Vec<LocalTransform> {
        let mut placed = self.place_trunk();
        for side in Side::BOTH {
            self.place_arm(side, &mut placed);
            self.place_leg(side, &mut placed);
        }
        let local = |bone: Bone| {
            let parent = bone.parent().map_or(Rotation::IDENTITY, |p| placed.at(p).1);
            let translation = if bone == Bone::Hips { self.pelvis } else { bind_offset(bone) };
            let rotation = (parent.inverse() * placed.at(bone).1).normalize();
            LocalTransform { translation, rotation, scale: Vec3::ONE }
        };
        Bone::all().map(local).collect()
    }

    fn place_trunk(&self) -> Placed {
        let mut placed =
            Placed { position: [Vec3::ZERO; Bone::COUNT], rotation: [Rotation::IDENTITY; Bone::COUNT] };
        placed.set(Bone::Hips, turn(self.pelvis_turn));
        placed.position[Bone::Hips.index()] = self.pelvis;
        let trunk = [
            (Bone::Spine, self.spine),
            (Bone::Chest, self.chest),
            (Bone::Neck, self.neck),
            (Bone::Head, self.head),
        ];
        for (bone, degrees) in trunk {
            placed.set_local(bone, turn(degrees));
        }
        for limb in [Bone::LeftShoulder, Bone::LeftUpperArm, Bone::LeftUpperLeg] {
            for side in Side::BOTH {
                placed.set_local(limb.on(side), Rotation::IDENTITY);
            }
        }
        placed
    }

    fn place_leg(&self, side: Side, placed: &mut Placed) {
        let foot = if side == Side::Left { &self.left_foot } else { &self.right_foot };
        let pelvis = placed.at(Bone::Hips).1;
        let hip = placed.at(Bone::LeftUpperLeg.on(side)).0;
        let outward = turn(Vec3::new(0.0, foot.knee_out * side.sign(), 0.0));
        let (thigh, shank) = Limb::leg(side).reach(foot.ankle - hip, pelvis * (outward * Vec3::X));
        placed.set(Bone::LeftUpperLeg.on(side), thigh);
        placed.set(Bone::LeftLowerLeg.on(side), shank);
        placed.set(Bone::LeftFoot.on(side), turn(foot.turn));
        placed.set_local(Bone::LeftToes.on(side), turn(Vec3::new(-foot.toes, 0.0, 0.0)));
    }

    fn place_arm(&self, side: Side, placed: &mut Placed) {
        let hand = if side == Side::Left { &self.left_hand } else { &self.right_hand };
        let chest = placed.at(Bone::Chest).1;
        let shoulder = placed.at(Bone::LeftUpperArm.on(side)).0;
        let behind = chest * side.vector(Vec3::new(0.3, -0.8, -1.0));
        let way = hand.wrist - shoulder;
        let swivel = (hand.elbow_out * side.sign()).to_radians();
        let elbow = Rotation::from_axis_angle(normalize_or(way, Vec3::NEG_Y), swivel) * behind;
        let (upper, fore) = Limb::arm(side).reach(way, elbow.cross(way));
        placed.set(Bone::LeftUpperArm.on(side), upper);
        placed.set(Bone::LeftLowerArm.on(side), fore);
        let flat = flat_hand(side, hand.fingers_out);
        placed.set(Bone::LeftHand.on(side), fore.nlerp(flat, hand.flat));
    }
}

/// World rotation of a hand whose palm is on the floor.
fn flat_hand(side: Side, fingers_out: f32) -> Rotation {
    let axes = left_arm_axes();
    let (fingers, palm) = (side.vector(axes.fore), side.vector(axes.palm));
    let (sin, cos) = trig::sin_cos(fingers_out.to_radians());
    from_pairs([fingers, palm], [side.vector(Vec3::new(sin, 0.0, cos)), Vec3::NEG_Y])
}

/// The rotation that takes two orthonormal vectors to two others.
fn from_pairs(from: [Vec3; 2], to: [Vec3; 2]) -> Rotation {
    let basis = |[a, b]: [Vec3; 2]| Rotation::from_mat3(&Mat3::from_cols(a, b, a.cross(b)));
    basis(to) * basis(from).inverse()
}

/// A limb of two bones with a hinge, in the bind pose.
struct Limb {
    upper: Vec3,
    lower: Vec3,
    /// A positive rotation of the lower bone about it bends the limb. Unit, perpendicular to both bones.
    hinge: Vec3,
}

impl Limb {
    fn between(joints: [Bone; 3], side: Side, hinge: impl Fn(Vec3) -> Vec3) -> Self {
        let [a, b, c] = joints.map(|bone| bind_position(bone.on(side)));
        Self { upper: b - a, lower: c - b, hinge: hinge((b - a).normalize()) }
    }

    fn leg(side: Side) -> Self {
        Self::between([Bone::LeftUpperLeg, Bone::LeftLowerLeg, Bone::LeftFoot], side, |_| Vec3::X)
    }

    fn arm(side: Side) -> Self {
        Self::between([Bone::LeftUpperArm, Bone::LeftLowerArm, Bone::LeftHand], side, |along| {
            along.cross(Vec3::Z)
        })
    }

    /// Returns the world rotations of the two bones that bring the limb's end to `target` (relative to its root), with
    /// the hinge's axis as near to `hinge` as possible. A target out of reach is approached; the limb never stretches
    /// fully.
    fn reach(&self, target: Vec3, hinge: Vec3) -> (Rotation, Rotation) {
        let (a, b) = (self.upper.length(), self.lower.length());
        let along = normalize_or(target, Vec3::NEG_Y);
        let distance = clamp(target.length(), 0.3 * (a + b), 0.999 * (a + b));
        let hinge = normalize_or(hinge - along * hinge.dot(along), Vec3::X);
        // Law of cosines: distance of the middle joint along the line to the target, and from it.
        let foot = (a * a + distance * distance - b * b) / (2.0 * distance);
        let height = clamp(a * a - foot * foot, 0.0, a * a).sqrt();
        let upper = along * foot + along.cross(hinge) * height;
        let lower = along * distance - upper;
        let bone =
            |rest: Vec3, now: Vec3| from_pairs([self.hinge, rest.normalize()], [hinge, now.normalize()]);
        (bone(self.upper, upper), bone(self.lower, lower))
    }
}
