//! Characters that each blend two clips, for performance measurements.

use sinew::anim::{
    BlendLayer, Blender, BuiltClip, Channel, Clip, ClipBuildOptions, Cursor, Interpolation, Joint,
    LocalTransform, ModelPose, Pose, Property, Rig, Skeleton,
};
use sinew::math::{Affine, Random, Rotation, Vec3, trig};

/// Joints of the rig.
const JOINTS: usize = 50;
/// Number of joints in a row; each further row is attached to one joint of the first.
const ROW: usize = 10;
/// Number of keys of each moving track: two seconds at 30 Hz.
const KEYS: u16 = 61;
/// Length of both clips, seconds.
pub const DURATION: f32 = 2.0;
/// Number of steps in the duration of a clip.
const STEPS_PER_LOOP: usize = 120;

/// The characters, their clips and start times.
#[derive(Clone)]
pub struct CrowdScene {
    /// Five rows of ten joints, about 0.2 m apart.
    pub rig: Rig,
    /// Clips that loop: a rotation for every joint, a translation for the root, a key each 1/30 s.
    pub clips: [Clip; 2],
    /// One entry per character.
    pub characters: Vec<Character>,
}

/// Parameters of one character.
#[derive(Clone, Copy, Debug)]
pub struct Character {
    /// Start time in each clip, seconds.
    pub start: [f32; 2],
    /// Blend weight of the second clip.
    pub weight: f32,
}

impl CrowdScene {
    /// Creates the same `characters` characters every time.
    pub fn new(characters: usize) -> Self {
        let mut random = Random::new(11);
        let rig = Rig { joints: (0..JOINTS).map(|i| joint(i, &mut random)).collect(), ..Rig::default() };
        let clips = [clip(&rig, &mut random), clip(&rig, &mut random)];
        let mut character = || Character {
            start: [random.range(0.0, DURATION), random.range(0.0, DURATION)],
            weight: random.range(0.2, 0.8),
        };
        Self { rig, clips, characters: (0..characters).map(|_| character()).collect() }
    }

    /// Time within each clip after `step` more steps of 1/60 s, seconds.
    pub fn times(&self, character: usize, step: usize) -> [f32; 2] {
        let passed = (step % STEPS_PER_LOOP) as f32 / 60.0;
        self.characters[character].start.map(|start| {
            let time = start + passed;
            if time < DURATION { time } else { time - DURATION }
        })
    }
}

/// State of a [`CrowdScene`] in Sinew: cursors and a model pose for each character, and intermediate poses that all
/// characters share.
pub struct Crowd {
    scene: CrowdScene,
    skeleton: Skeleton,
    clips: [BuiltClip; 2],
    characters: Vec<Playing>,
    blender: Blender,
    sampled: [Pose; 2],
    blended: Pose,
}

#[derive(Clone, Default)]
struct Playing {
    cursors: [Cursor; 2],
    model: ModelPose,
}

impl Crowd {
    /// Creates the state before the first pose.
    pub fn new(scene: CrowdScene) -> Self {
        let joints = scene.rig.joints.len();
        let built = |clip| {
            BuiltClip::build(clip, &scene.rig, &ClipBuildOptions::default()).expect("the clip fits the rig")
        };
        Self {
            skeleton: Skeleton::new(&scene.rig),
            clips: scene.clips.each_ref().map(built),
            characters: vec![Playing::default(); scene.characters.len()],
            blender: Blender::default(),
            sampled: [Pose::new(joints), Pose::new(joints)],
            blended: Pose::new(joints),
            scene,
        }
    }

    /// Samples both clips for every character at its times after `step` steps, blends them, and converts the results to
    /// model poses.
    pub fn step(&mut self, step: usize) {
        for character in 0..self.characters.len() {
            self.sample(character, step);
            let weight = self.scene.characters[character].weight;
            let [first, second] = &self.sampled;
            let layers = [BlendLayer::new(first, 1.0 - weight), BlendLayer::new(second, weight)];
            self.blender.blend(self.skeleton.rest(), &layers, &mut self.blended);
            let model = &mut self.characters[character].model;
            self.skeleton.to_model(&self.blended, &Affine::IDENTITY, model);
        }
    }

    /// Samples and blends both clips at a character's times after `step` steps.
    pub fn sample(&mut self, character: usize, step: usize) -> &[Pose; 2] {
        let times = self.scene.times(character, step);
        let cursors = &mut self.characters[character].cursors;
        for i in 0..2 {
            self.clips[i].sample(times[i], &mut cursors[i], &mut self.sampled[i]);
        }
        &self.sampled
    }

    /// Model pose of a character in the last step.
    pub fn model(&self, character: usize) -> &ModelPose {
        &self.characters[character].model
    }
}

fn joint(index: usize, random: &mut Random) -> Joint {
    let parent = match index {
        0 => None,
        _ if index.is_multiple_of(ROW) => Some(4),
        _ => Some(index - 1),
    };
    let rest = LocalTransform {
        translation: random.direction() * random.range(0.1, 0.3),
        rotation: Rotation::from_scaled_axis(random.direction() * random.range(0.0, 0.5)),
        ..LocalTransform::default()
    };
    Joint { name: format!("joint{index}"), parent, rest, source: index }
}

fn clip(rig: &Rig, random: &mut Random) -> Clip {
    let times: Vec<f32> = (0..KEYS).map(|key| f32::from(key) / 30.0).collect();
    let channel = |joint, property, values| {
        let (interpolation, times) = (Interpolation::Linear, times.clone());
        Channel { joint, property, interpolation, times, values }
    };
    let mut channels = Vec::new();
    for (joint, Joint { rest, .. }) in rig.joints.iter().enumerate() {
        let (axis, most) = (random.direction(), random.range(0.1, 0.6));
        let (turns, start) =
            (if joint % 2 == 0 { 1.0 } else { 2.0 }, random.range(0.0, core::f32::consts::TAU));
        let at = |time: f32| {
            let angle = most * trig::sin(start + time * turns * core::f32::consts::TAU / DURATION);
            rest.rotation * Rotation::from_scaled_axis(axis * angle)
        };
        let values = times.iter().map(|&time| at(time)).flat_map(|q| [q.x, q.y, q.z, q.w]).collect();
        channels.push(channel(joint, Property::Rotation, values));
    }
    let sway = |time: f32| trig::sin(time * core::f32::consts::TAU / DURATION);
    let places = times.iter().map(|&time| Vec3::new(0.05 * sway(time), 0.95 + 0.03 * sway(2.0 * time), 0.0));
    channels.push(channel(0, Property::Translation, places.flat_map(|p| [p.x, p.y, p.z]).collect()));
    Clip { name: "clip".into(), duration: DURATION, channels }
}
