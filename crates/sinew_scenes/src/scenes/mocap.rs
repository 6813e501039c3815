//! One actor's motion on characters of other sizes and builds.

use super::actors::{Actor, Cast, Figure, Gone};
use super::metric::{Expected, Metric};
use super::parts::floor;
use super::sight::{Sight, Trails};
use super::{Instance, Scene, Script, Setup};
use crate::mannequin::{WALK_SPEED, mannequin};
use sinew::anim::retarget::{Body, Pace, RetargetOptions, Retargeted, retarget};
use sinew::anim::{Rig, TrackDef, analyze_skeleton, local_to_model, rest_pose, skin_vertices};
use sinew::math::{Affine, Transform, Vec3, max};
use sinew::physics::World;
use std::sync::Arc;

pub(super) const RETARGET: Scene = Scene {
    name: "retarget",
    about: "a walk retargeted from the mannequin onto a child of 0.8 m and a giant of 14 m",
    steps: 240,
    settings: &[],
    build: retargeted,
};

/// What a character is beside the mannequin.
struct Build {
    /// Metres.
    height: f32,
    /// Of the legs, the arms and the head, beside a mannequin of the same trunk.
    legs: f32,
    arms: f32,
    head: f32,
    /// Where it begins.
    place: Vec3,
}

const CHILD: Build = Build { height: 0.8, legs: 0.72, arms: 0.8, head: 1.5, place: Vec3::new(1.4, 0.0, 1.0) };
/// Long legs and hardly any arms: what a human actor would drive as a T-rex.
const GIANT: Build =
    Build { height: 14.0, legs: 1.15, arms: 0.45, head: 1.6, place: Vec3::new(-4.5, 0.0, -3.0) };

impl Build {
    /// How much longer than the mannequin's the way to a joint is, before all is brought to its height.
    fn factor(&self, joint: &str) -> f32 {
        let is = |parts: &[&str]| parts.iter().any(|part| joint.ends_with(part));
        if is(&["LowerLeg", "Foot"]) {
            self.legs
        } else if is(&["LowerArm", "Hand"]) {
            self.arms
        } else {
            1.0
        }
    }

    /// The mannequin with these proportions, its skin drawn over the new bones.
    fn rig(&self, from: &Rig) -> Rig {
        let mut rig = from.clone();
        for joint in &mut rig.joints {
            joint.rest.translation *= self.factor(&joint.name);
        }
        let mut model = bind(&rig);
        // Feet on the ground again, and the head's top where it should be.
        let lift = self.lowest(&model, &rig);
        let head = rig.joints.iter().position(|joint| joint.name == "head").unwrap_or(0);
        let crown = model[head].translation.y - lift + HEAD * self.head;
        let scale = self.height / crown;
        for (index, joint) in rig.joints.iter_mut().enumerate() {
            joint.rest.translation *= scale;
            if joint.name == "hips" {
                joint.rest.translation.y -= lift * scale;
            }
            let size = scale * if index == head { self.head } else { 1.0 };
            model[index] = Affine { linear: model[index].linear * size, ..model[index] };
        }
        let place = bind(&rig);
        for (joint, place) in model.iter_mut().zip(&place) {
            joint.translation = place.translation;
        }
        for primitive in 0..rig.meshes[0].primitives.len() {
            let (mut positions, mut normals) = (Vec::new(), Vec::new());
            skin_vertices(from, 0, primitive, &model, &mut positions, &mut normals);
            let part = &mut rig.meshes[0].primitives[primitive];
            (part.positions, part.normals) = (positions, normals);
        }
        let skin = &mut rig.skins[0];
        for (&joint, inverse) in skin.joints.iter().zip(&mut skin.inverse_bind) {
            *inverse = place[joint].inverse();
        }
        rig
    }

    fn lowest(&self, model: &[Affine], rig: &Rig) -> f32 {
        let foot = rig.joints.iter().position(|joint| joint.name == "leftFoot").unwrap_or(0);
        model[foot].translation.y - ANKLE
    }
}

/// Height of the mannequin's crown above its head's joint, and of its ankles above the soles, metres.
const HEAD: f32 = 0.19;
const ANKLE: f32 = 0.08;

fn bind(rig: &Rig) -> Vec<Affine> {
    let mut model = Vec::new();
    local_to_model(rig, &rest_pose(rig), &Affine::IDENTITY, &mut model);
    model
}

fn retargeted(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    let actor = mannequin();
    let walk = &actor.clips[actor.motions.walk];
    let analysis = analyze_skeleton(&actor.rig, &rest_pose(&actor.rig)).expect("the mannequin has bones");
    let from = Body { rig: &actor.rig, analysis: &analysis };
    let mut character = |build: &Build| {
        let rig = build.rig(&actor.rig);
        let analysis = analyze_skeleton(&rig, &rest_pose(&rig)).expect("so has what is made of it");
        // A giant is not taken for a human in other units.
        let analysis = analysis.with_unit_scale(1.0);
        let options =
            RetargetOptions { frame_time: 1.0 / 30.0, pace: Pace::Froude, ..RetargetOptions::default() };
        let fitted = retarget(from, walk, Body { rig: &rig, analysis: &analysis }, &options);
        let fitted = fitted.expect("both are humanoids");
        let clip = fitted.clip(&rig, "walk");
        Character::new(&mut world, rig, &clip, fitted, build)
    };
    let characters = [character(&CHILD), character(&GIANT)];
    let mut cast = Cast::of(actor.rig.clone());
    let clip = cast.add(walk, Vec::new());
    let mut human = Actor::new(&Arc::new(cast), Transform::IDENTITY);
    human.animator.play(&human.cast.set, &TrackDef::new(clip));
    human.mark(&mut world);
    Instance::new(world, Retarget { human, characters, gone: Gone::default() })
}

/// A character and how its motion fits.
struct Character {
    actor: Actor,
    fitted: Retargeted,
    height: f32,
    /// Along z so far, metres.
    way: f32,
    /// How deep an ankle came to be below its height in the reference pose, metres.
    sunk: f32,
}

impl Character {
    fn new(world: &mut World, rig: Rig, clip: &sinew::anim::Clip, fitted: Retargeted, build: &Build) -> Self {
        let mut cast = Cast::of(rig);
        let clip = cast.add(clip, Vec::new());
        let mut actor = Actor::new(&Arc::new(cast), Transform::from_translation(build.place));
        actor.animator.play(&actor.cast.set, &TrackDef::new(clip));
        actor.mark(world);
        Self { actor, fitted, height: build.height, way: 0.0, sunk: 0.0 }
    }

    /// Goes against the ground that its feet push back.
    fn update(&mut self, dt: f32) {
        self.actor.update(dt);
        let step = self.fitted.ground.velocity * -dt;
        self.way += step.z;
        self.actor.place.translation += step;
        self.actor.pose();
        for toes in ["leftToes", "rightToes"] {
            let joint = self.actor.cast.joint(toes);
            self.sunk = max(self.sunk, -self.actor.model[joint].translation.y);
        }
    }

    /// Of its feet, cm/s for each metre of height.
    fn slide(&self) -> f32 {
        100.0 * self.fitted.feet.slide[1].mean / self.height
    }

    /// Length of a clip over that of the actor's: by Froude's law the root of the ratio of their legs.
    fn pace(&self) -> Expected {
        Expected::near(self.fitted.scale.sqrt(), 1e-6)
    }

    fn speed(&self) -> Expected {
        Expected::near(WALK_SPEED * self.fitted.scale.sqrt(), 0.01)
    }
}

struct Retarget {
    human: Actor,
    characters: [Character; 2],
    gone: Gone,
}

impl Script for Retarget {
    fn before_step(&mut self, world: &mut World) {
        let dt = world.def().dt();
        for _ in self.gone.due(world) {
            self.human.update(dt);
            self.human.place.translation.z += WALK_SPEED * dt;
            self.human.pose();
            self.characters.iter_mut().for_each(|character| character.update(dt));
        }
        self.human.lead_marks(world);
        self.characters.iter().for_each(|character| character.actor.lead_marks(world));
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let [child, giant] = &self.characters;
        let speed = |character: &Character| character.way / max(world.time() as f32, 1e-6);
        vec![
            Metric::new("child_speed_m_s", speed(child), child.speed()),
            Metric::new("giant_speed_m_s", speed(giant), giant.speed()),
            Metric::new("child_pace", child.fitted.pace, child.pace()),
            Metric::new("giant_pace", giant.fitted.pace, giant.pace()),
            Metric::new("child_slide_cm_s_per_m", child.slide(), Expected::AtMost(1.0)),
            Metric::new("giant_slide_cm_s_per_m", giant.slide(), Expected::AtMost(1.0)),
            Metric::new("child_sunk_m", child.sunk, Expected::AtMost(0.01 * 0.8)),
            Metric::new("giant_sunk_m", giant.sunk, Expected::AtMost(0.01 * 14.0)),
        ]
    }

    fn sight(&self) -> Sight {
        Sight { direction: Vec3::new(0.9, 0.12, 1.0), trails: Trails::None, ..Sight::default() }
    }

    fn figures(&self) -> Vec<Figure<'_>> {
        [&self.human]
            .into_iter()
            .chain(self.characters.iter().map(|character| &character.actor))
            .map(Actor::figure)
            .collect()
    }
}
