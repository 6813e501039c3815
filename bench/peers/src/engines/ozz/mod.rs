//! ozz-animation-rs: sampling, blending and model space as in its own examples.

mod archive;

use crate::engine::{CharacterPose, Crowd, Description, Engine, Simulation, Unsupported};
use crate::scenes::Field;
use glam::Mat4;
use ozz_animation_rs::{
    Animation, Archive, BlendingJobRc, BlendingLayer, LocalToModelJobRc, SamplingContext, SamplingJobRc,
    Skeleton, SoaTransform,
};
use sinew::math::{Rotation, Vec3};
use sinew_scenes::blueprint::Blueprint;
use sinew_scenes::crowd::{CrowdScene, DURATION};
use std::cell::RefCell;
use std::rc::Rc;

/// Engine ozz-animation-rs.
pub struct Ozz;

impl Engine for Ozz {
    fn describe(&self) -> Description {
        Description {
            name: "ozz",
            version: "0.11.0".into(),
            flags: format!("{}, RUSTC_BOOTSTRAP=1", env!("PEERS_FLAGS")),
            settings: "defaults; four lanes of std::simd, keys of 16-bit floats and 48-bit rotations".into(),
        }
    }

    fn fields(&self) -> &'static [Field] {
        &[Field::Animation]
    }

    fn build(&self, _scene: &Blueprint) -> Result<Box<dyn Simulation>, Unsupported> {
        Err(Unsupported::new("no bodies"))
    }

    fn build_crowd<'a>(&self, scene: &'a CrowdScene) -> Result<Box<dyn Crowd + 'a>, Unsupported> {
        Ok(Box::new(OzzCrowd::new(scene)))
    }
}

type Locals = Rc<RefCell<Vec<SoaTransform>>>;

/// A sampling context for each clip and the matrices of each character; intermediate buffers are shared.
struct OzzCrowd<'a> {
    scene: &'a CrowdScene,
    characters: Vec<OzzCharacter>,
    blend: BlendingJobRc,
    sampled: [Locals; 2],
}

struct OzzCharacter {
    samples: [SamplingJobRc; 2],
    to_model: LocalToModelJobRc,
    model: Rc<RefCell<Vec<Mat4>>>,
}

impl<'a> OzzCrowd<'a> {
    fn new(scene: &'a CrowdScene) -> Self {
        let mut archive = Archive::from_vec(archive::skeleton(scene)).expect("an archive");
        let skeleton = Rc::new(Skeleton::from_archive(&mut archive).expect("a skeleton"));
        let animations = scene.clips.each_ref().map(|clip| {
            let mut archive = Archive::from_vec(archive::animation(scene, clip)).expect("an archive");
            Rc::new(Animation::from_archive(&mut archive).expect("an animation"))
        });
        let locals = || Rc::new(RefCell::new(vec![SoaTransform::IDENTITY; skeleton.num_soa_joints()]));
        let (sampled, blended) = ([locals(), locals()], locals());
        let mut blend = BlendingJobRc::default();
        blend.set_skeleton(skeleton.clone());
        blend.set_output(blended.clone());
        blend.layers_mut().extend(sampled.iter().map(|locals| BlendingLayer::new(locals.clone())));
        let character = |_| {
            let samples = [0, 1].map(|i| sampling(&animations[i], &sampled[i]));
            let model = Rc::new(RefCell::new(vec![Mat4::IDENTITY; skeleton.num_joints()]));
            let mut to_model = LocalToModelJobRc::default();
            to_model.set_skeleton(skeleton.clone());
            to_model.set_input(blended.clone());
            to_model.set_output(model.clone());
            OzzCharacter { samples, to_model, model }
        };
        let characters = (0..scene.characters.len()).map(character).collect();
        Self { scene, characters, blend, sampled }
    }

    fn sample(&mut self, character: usize, step: usize) {
        let times = self.scene.times(character, step);
        for (job, time) in self.characters[character].samples.iter_mut().zip(times) {
            job.set_ratio(time / DURATION);
            job.run().expect("a valid job");
        }
    }
}

fn sampling(animation: &Rc<Animation>, output: &Locals) -> SamplingJobRc {
    let mut job = SamplingJobRc::default();
    job.set_animation(animation.clone());
    job.set_context(SamplingContext::new(animation.num_tracks()));
    job.set_output(output.clone());
    job
}

impl Crowd for OzzCrowd<'_> {
    fn step(&mut self, step: usize) {
        for character in 0..self.characters.len() {
            self.sample(character, step);
            let weight = self.scene.characters[character].weight;
            let layers = self.blend.layers_mut();
            (layers[0].weight, layers[1].weight) = (1.0 - weight, weight);
            self.blend.run().expect("a valid job");
            self.characters[character].to_model.run().expect("a valid job");
        }
    }

    fn pose(&mut self, character: usize, step: usize) -> CharacterPose {
        self.sample(character, step);
        let joints = self.scene.rig.joints.len();
        let rotation = |locals: &[SoaTransform], joint: usize| {
            let (four, lane) = (&locals[joint / 4].rotation, joint % 4);
            Rotation::from_xyzw(four.x[lane], four.y[lane], four.z[lane], four.w[lane])
        };
        let rotations = |locals: &Locals| {
            let locals = locals.borrow();
            (0..joints).map(|joint| rotation(&locals, joint)).collect()
        };
        let place = |matrix: &Mat4| {
            let [x, y, z] = matrix.w_axis.truncate().to_array();
            Vec3::new(x, y, z)
        };
        CharacterPose {
            sampled: self.sampled.each_ref().map(rotations),
            places: self.characters[character].model.borrow().iter().map(place).collect(),
        }
    }
}
