//! Ragdolls and animations of Jolt: a small file in this module, malicious bytes, and Jolt's own human.

use crate::data::shared_data;
use needs_data::needs_data;
use sinew_anim::{Clip, Interpolation, LocalTransform, Property, Rig, Wrap, rest_pose, sample};
use sinew_formats::{JoltRagdoll, read_jolt_animation, read_jolt_ragdoll};
use sinew_math::{Random, Rotation, Transform, Vec3};
use sinew_physics::{BodyDef, JointKind, Shape, World, WorldDef};
use sinew_ragdoll::hand_over::{SpeedBound, body_velocity};
use sinew_ragdoll::{BodySettings, BodyState, DriveMode, Drives, Muscle, Pin, Ragdoll};

/// Two parts: a ball, and a capsule half a metre above it; the joint is midway between them.
const SMALL: &str = r#"TOS 1.00

declare RagdollSettings 2
  mSkeleton instance Skeleton
  mParts array instance RagdollSettings::Part

declare Skeleton 1
  mJoints array instance Skeleton::Joint

declare Skeleton::Joint 2
  mName string
  mParentName string

declare RagdollSettings::Part 7
  mPosition vec3
  mRotation quat
  mShape instance ShapeSettings
  mCollisionGroup instance CollisionGroup
  mOverrideMassProperties uint32
  mMassPropertiesOverride instance MassProperties
  mToParent instance TwoBodyConstraintSettings

declare MassProperties 2
  mMass float
  mInertia mat44

declare CollisionGroup 3
  mGroupFilter instance GroupFilter
  mGroupID uint32
  mSubGroupID uint32

object RagdollSettings 00000001
  00000002
  2
      0 1 0
      0 0 0 1
      00000003
        00000000
        0
        0
      0
        0
        0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0
      00000000
      0 1.5 0
      0 0 0.707106781 0.707106781
      00000004
        00000000
        0
        1
      1
        3.5
        0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0
      00000005

object Skeleton 00000002
  2
      "root"
      ""
      "tip"
      "root"

declare SphereShapeSettings 4
  mUserData uint32
  mDensity float
  mMaterial instance PhysicsMaterial
  mRadius float

object SphereShapeSettings 00000003
  0
  1000
  00000000
  0.1

declare StaticCompoundShapeSettings 2
  mUserData uint32
  mSubShapes array instance CompoundShapeSettings::SubShapeSettings

declare CompoundShapeSettings::SubShapeSettings 4
  mShape instance ShapeSettings
  mPosition vec3
  mRotation quat
  mUserData uint32

object StaticCompoundShapeSettings 00000004
  0
  1
      00000006
      0.25 0 0
      0 0 0 1
      0

declare SwingTwistConstraintSettings 14
  mDrawConstraintSize float
  mPosition1 vec3
  mTwistAxis1 vec3
  mPlaneAxis1 vec3
  mPosition2 vec3
  mTwistAxis2 vec3
  mPlaneAxis2 vec3
  mNormalHalfConeAngle float
  mPlaneHalfConeAngle float
  mTwistMinAngle float
  mTwistMaxAngle float
  mMaxFrictionTorque float
  mSwingMotorSettings instance MotorSettings
  mTwistMotorSettings instance MotorSettings

declare MotorSettings 6
  mFrequency float
  mDamping float
  mMinForceLimit float
  mMaxForceLimit float
  mMinTorqueLimit float
  mMaxTorqueLimit float

object SwingTwistConstraintSettings 00000005
  0.1
  0 1.5 0
  0 1 0
  0 0 1
  0 1.5 0
  0 1 0
  0 0 1
  0.5
  0.25
  -0.125
  0.375
  2.5
    20
    2
    -3.40282347e+38
    3.40282347e+38
    -500
    500
    20
    2
    -3.40282347e+38
    3.40282347e+38
    -500
    500

declare CapsuleShapeSettings 5
  mUserData uint32
  mDensity float
  mMaterial instance PhysicsMaterial
  mRadius float
  mHalfHeightOfCylinder float

object CapsuleShapeSettings 00000006
  0
  1000
  00000000
  0.05
  0.2
"#;

fn close(a: Vec3, b: Vec3) {
    assert!((a - b).length() < 1e-5, "{a} is not {b}");
}

#[test]
fn small_ragdoll_matches_its_file() {
    let JoltRagdoll { rig, def, motors } = read_jolt_ragdoll(SMALL.as_bytes()).unwrap();
    assert_eq!(rig.joints.iter().map(|joint| joint.name.as_str()).collect::<Vec<_>>(), ["root", "tip"]);
    assert_eq!(rig.joints[1].parent, Some(0));
    close(rig.joints[1].rest.translation, Vec3::Y * 0.5);
    assert_eq!(def.bodies[0].shape, Shape::Sphere { radius: 0.1 });
    let volume = 4.0 / 3.0 * core::f32::consts::PI * 0.001;
    assert!((def.bodies[0].mass.mass - 1000.0 * volume).abs() < 1e-3);
    assert_eq!(def.bodies[1].mass.mass, 3.5);
    let model_from_character = def.character_from_model.inverse();
    let bodies: Vec<Transform> =
        def.bodies.iter().map(|body| model_from_character * body.character_from_body).collect();
    // The capsule's own x axis, along which it is offset by 0.25, points up.
    close(bodies[1].translation, Vec3::Y * 1.75);
    let joint = def.joints[0];
    for (body, frame) in [(bodies[0], joint.frame_parent), (bodies[1], joint.frame_child)] {
        let frame = body * frame;
        close(frame.translation, Vec3::Y * 1.5);
        close(frame.rotation * Vec3::X, Vec3::Y);
        close(frame.rotation * Vec3::Z, Vec3::Z);
    }
    let JointKind::Ball { limit: Some(limit) } = joint.kind else { panic!("{:?}", joint.kind) };
    assert_eq!((limit.swing_y.hi, limit.swing_z.hi), (0.25, 0.5));
    assert_eq!((limit.twist.lo, limit.twist.hi, joint.friction_torque), (-0.125, 0.375, 2.5));
    let motor = motors[1].expect("the joint has a motor");
    assert_eq!((motor.hertz, motor.damping_ratio, motor.max_torque), (20.0, 2.0, 500.0));
}

/// Returns an animation of one joint of [`SMALL`].
fn animation(times: [f32; 2]) -> String {
    format!(
        "TOS 1.00\ndeclare SkeletalAnimation 1\n  mAnimatedJoints array instance A\ndeclare A 2\n  mJointName string\n  \
         mKeyframes array instance K\ndeclare K 3\n  mRotation quat\n  mTranslation vec3\n  mTime float\n\
         object SkeletalAnimation 00000001\n  1\n      \"tip\"\n      2\n          0 0 0 1\n          0 0.5 0\n          \
         {}\n          0 0 0.6 0.8\n          0 0.5 0.25\n          {}\n",
        times[0], times[1]
    )
}

#[test]
fn animation_is_read_as_keys_per_joint() {
    let rig = read_jolt_ragdoll(SMALL.as_bytes()).unwrap().rig;
    let clip = read_jolt_animation(animation([0.0, 0.5]).as_bytes(), &rig).unwrap();
    assert_eq!(clip.duration, 0.5);
    let [places, turns] = &clip.channels[..] else { panic!("two channels") };
    assert_eq!((places.property, places.joint), (Property::Translation, 1));
    assert_eq!(places.values, [0.0, 0.5, 0.0, 0.0, 0.5, 0.25]);
    assert_eq!((turns.interpolation, turns.times.as_slice()), (Interpolation::Linear, &[0.0, 0.5][..]));
    assert_eq!(turns.values[4..], [0.0, 0.0, 0.6, 0.8]);
    let error = read_jolt_animation(animation([0.5, 0.5]).as_bytes(), &rig).unwrap_err();
    assert_eq!(error.to_string(), "a key that is not after the previous one (line 18)");
    let error = read_jolt_animation(animation([0.0, 1.0]).as_bytes(), &Rig::default()).unwrap_err();
    assert_eq!(error.to_string(), "`tip` is not a joint of the skeleton (line 13)");
    let error = read_jolt_animation(SMALL.as_bytes(), &rig).unwrap_err();
    assert!(error.to_string().starts_with("no animation in it"), "{error}");
}

#[test]
fn errors_name_their_line() {
    for (from, to, what) in [
        ("TOS 1.00", "TOF 1.00", "not a text object file: does not begin with `TOS` (line 1)"),
        ("\"root\"\n      \"\"", "\"root\"\n      \"tip\"", "`tip` is not a joint before `root` (line 59)"),
        ("SphereShapeSettings", "TorusShapeSettings", "a shape of class `TorusShapeSettings` (line 69)"),
        (
            "  mRadius float\n\nobject Sphere",
            "  mRadius quaternions\n\nobject Sphere",
            "unknown type `quaternions` of a member (line 67)",
        ),
        (
            "  0.1\n\ndeclare Static",
            "  -0.1\n\ndeclare Static",
            "a radius must be positive and finite (line 69)",
        ),
        ("      0 1.5 0\n", "      0 nan 0\n", "a line without a finite number (line 45)"),
        ("      00000005\n", "      00000009\n", "names object 00000009, which does not exist (line 54)"),
        ("  0.375\n", "  0.375.0\n", "`0.375.0` is not a finite number (line 128)"),
    ] {
        let text = SMALL.replace(from, to);
        assert_ne!(text, SMALL);
        let error = read_jolt_ragdoll(text.as_bytes()).unwrap_err();
        assert_eq!(error.to_string(), what);
    }
    let endless = "TOS 1.00\ndeclare A 1\n  a array instance B\ndeclare B 0\nobject A 00000001\n  4000000000\n      x\n";
    assert!(read_jolt_ragdoll(endless.as_bytes()).is_err());
}

#[test]
fn prefixes_and_changed_bytes_give_results_or_errors() {
    for length in 0..SMALL.len() - 1 {
        assert!(read_jolt_ragdoll(&SMALL.as_bytes()[..length]).is_err() || length + 4 > SMALL.len());
    }
    let mut random = Random::new(5);
    for _ in 0..3000 {
        let mut bytes = SMALL.as_bytes().to_vec();
        for _ in 0..1 + random.index(3) {
            let at = random.index(bytes.len());
            bytes[at] = random.index(128) as u8;
        }
        if let Ok(JoltRagdoll { def, .. }) = read_jolt_ragdoll(&bytes) {
            assert!(def.bodies.iter().all(|body| body.mass.mass > 0.0));
        }
    }
}

/// Returns Jolt's human and one of its clips.
fn human(clip: &str) -> (JoltRagdoll, Clip) {
    let folder = shared_data().join("peers/jolt");
    let ragdoll = read_jolt_ragdoll(&std::fs::read(folder.join("Human.tof")).unwrap()).unwrap();
    let clip = std::fs::read(folder.join("Human").join(clip)).unwrap();
    let clip = read_jolt_animation(&clip, &ragdoll.rig).unwrap();
    (ragdoll, clip)
}

#[needs_data]
#[test]
fn jolts_human_is_read_completely() {
    let (JoltRagdoll { rig, def, motors }, clip) = human("walk.tof");
    assert_eq!((def.bodies.len(), def.joints.len(), rig.joints.len()), (23, 22, 23));
    assert!(motors[1..].iter().all(|motor| motor.is_some_and(|motor| motor.hertz == 20.0)));
    assert!((1.4..2.1).contains(&def.height), "{} m", def.height);
    assert!((50.0..120.0).contains(&def.total_mass), "{} kg", def.total_mass);
    let role = |bone: &str| def.bodies.iter().find(|body| body.bone == bone).map(|body| body.role.as_str());
    println!(
        "mass {} kg, height {} m, roles {:?}",
        def.total_mass,
        def.height,
        def.bodies.iter().map(|b| &b.role).collect::<Vec<_>>()
    );
    assert_eq!(role("L_Leg_sjnt_1"), Some("leftLowerLeg"));
    assert_eq!(role("R_Arm_sjnt_1"), Some("rightLowerArm"));
    assert!((2.0..4.0).contains(&clip.duration) && clip.channels.len() == 46, "{} s", clip.duration);
    // In the rest pose the anchors of each joint coincide, and no joint is far beyond its limits.
    for joint in &def.joints {
        let [a, b] = [(joint.parent, joint.frame_parent), (joint.child, joint.frame_child)]
            .map(|(body, frame)| def.bodies[body].character_from_body * frame);
        assert!((a.translation - b.translation).length() < 1e-4);
        let JointKind::Ball { limit: Some(limit) } = joint.kind else { panic!() };
        let beyond = limit.overshoot(a.rotation.inverse() * b.rotation).to_degrees();
        assert!(beyond < 5.0, "{}: {beyond} degrees", def.bodies[joint.child].bone);
    }
}

/// Returns the model poses of the joints, which have no scale.
fn model_poses(rig: &Rig, pose: &[LocalTransform]) -> Vec<Transform> {
    let mut model: Vec<Transform> = Vec::new();
    for (joint, own) in rig.joints.iter().zip(pose) {
        let own = Transform::new(own.translation, own.rotation);
        model.push(joint.parent.map_or(own, |parent| model[parent] * own));
    }
    model
}

/// World poses of the bodies during a clip.
struct Stage {
    ragdoll: JoltRagdoll,
    clip: Clip,
    joint_from_body: Vec<Transform>,
}

impl Stage {
    fn new(ragdoll: JoltRagdoll, clip: Clip) -> Self {
        let model = model_poses(&ragdoll.rig, &rest_pose(&ragdoll.rig));
        let turn = ragdoll.def.character_from_model.inverse();
        let bodies = ragdoll.def.bodies.iter().zip(&model);
        let joint_from_body =
            bodies.map(|(body, joint)| joint.inverse() * turn * body.character_from_body).collect();
        Self { ragdoll, clip, joint_from_body }
    }

    fn poses(&self, time: f32) -> Vec<Transform> {
        let rig = &self.ragdoll.rig;
        let mut pose = rest_pose(rig);
        sample(&self.clip, rig, time, Wrap::Clamp, &mut pose);
        let model = model_poses(rig, &pose);
        model.iter().zip(&self.joint_from_body).map(|(joint, body)| *joint * *body).collect()
    }

    fn states(&self, time: f32, dt: f32) -> Vec<BodyState> {
        let (before, after) = (self.poses(time - dt), self.poses(time));
        let bodies = self.ragdoll.def.bodies.iter().zip(before.iter().zip(&after));
        bodies
            .map(|(body, (&before, &after))| BodyState {
                world_from_body: after,
                velocity: body_velocity(before, after, body.mass.center, dt, SpeedBound::default()),
            })
            .collect()
    }

    /// Returns the root mean square, over joints and over time after the first second, of the angle between a
    /// joint and the clip, degrees; and the largest mean force of the pins, N.
    fn track(&self, mode: DriveMode) -> (f32, f32) {
        let def = &self.ragdoll.def;
        let mut world = World::new(WorldDef::default());
        world.add_body(&BodyDef::fixed(Shape::HalfSpace));
        let dt = world.def().dt();
        let ragdoll = Ragdoll::spawn(&mut world, def, &self.states(dt, dt), &BodySettings::default());
        let caps = self.ragdoll.motors.iter().map(|motor| motor.map_or(0.0, |motor| motor.max_torque));
        let mut drives = Drives::with_torques(def, caps.collect());
        drives.set_all(mode, 0.0);
        let (mut sum, mut count, mut force) = (0.0, 0, 0.0);
        let steps = (self.clip.duration / dt) as usize;
        for step in 2..steps {
            let time = step as f32 * dt;
            let states = self.states(time, dt);
            let targets: Vec<Transform> = states.iter().map(|state| state.world_from_body).collect();
            let velocities: Vec<_> = states.iter().map(|state| state.velocity).collect();
            drives.apply(&mut world, def, &ragdoll, &targets, &velocities);
            world.step();
            if time < 1.0 {
                continue;
            }
            force += drives.pin_effort(&world).0 * dt;
            for joint in &def.joints {
                let seen =
                    |poses: &dyn Fn(usize) -> Rotation| poses(joint.parent).inverse() * poses(joint.child);
                let wanted = seen(&|body| targets[body].rotation);
                let is = seen(&|body| world.transform(ragdoll.bodies[body]).rotation);
                sum += is.angle_to(wanted) * is.angle_to(wanted);
                count += 1;
            }
        }
        ((sum / count as f32).sqrt().to_degrees(), force / (steps as f32 * dt - 1.0))
    }
}

#[needs_data]
#[test]
fn motors_track_the_walk_of_jolts_human() {
    let (ragdoll, clip) = human("walk.tof");
    let stage = Stage::new(ragdoll, clip);
    let (pinned, force) = stage.track(DriveMode::Pinned(Muscle::STIFF, Pin::FIRM));
    println!("pinned: {pinned} degrees, {force} N");
    let (alive, force) = stage.track(DriveMode::Pinned(Muscle::ALIVE, Pin { hertz: 5.0, ..Pin::FIRM }));
    println!("pinned at 5 Hz: {alive} degrees, {force} N");
    let (powered, _) = stage.track(DriveMode::Powered(Muscle::STIFF));
    println!("powered, not pinned: {powered} degrees");
    assert!(pinned < 6.0, "{pinned} degrees");
    assert!(powered < 20.0, "{powered} degrees");
}
