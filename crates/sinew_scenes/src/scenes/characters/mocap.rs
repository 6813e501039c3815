//! One actor's motion on characters of other sizes and builds.

use crate::framework::actors::{Actor, Cast, Figure, Gone};
use crate::framework::camera_hint::{CameraHint, Trails};
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::performance::Performance;
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::mannequin::{WALK_SPEED, mannequin};
use crate::parts::floor;
use sinew::anim::retarget::Retargeted;
use sinew::anim::{LoopMode, Rig, TrackDef, local_to_model, rest_pose, skin_vertices};
use sinew::math::{Affine, Transform, Vec3, max};
use sinew::physics::World;
use std::sync::Arc;

pub(in crate::scenes) const RETARGET: Scene = Scene {
    chapter: Chapter::Characters,
    name: "retarget",
    about: "a walk retargeted from the mannequin onto a child of 0.8 m and a giant of 14 m",
    steps: 240,
    settings: &[],
    build: retargeted,
};

/// Motion of a user's file on three characters.
pub(in crate::scenes) const MOCAP: Scene = Scene {
    chapter: Chapter::Characters,
    name: "mocap",
    about: "a captured motion on the mannequin, a child of 0.8 m and a giant of 14 m",
    steps: 300,
    settings: &[Setting::motion("motion", "captured motion of a human actor")],
    build: captured,
};

/// Proportions of a character beside the mannequin.
struct Build {
    /// Height, metres.
    height: f32,
    /// Lengths of the legs and the arms and size of the head, relative to those of a mannequin with the same
    /// trunk.
    legs: f32,
    arms: f32,
    head: f32,
    /// Start of the character, metres.
    place: Vec3,
}

const CHILD: Build = Build { height: 0.8, legs: 0.72, arms: 0.8, head: 1.5, place: Vec3::new(1.4, 0.0, 1.0) };
const HUMAN: Build = Build { height: 1.75, legs: 1.0, arms: 1.0, head: 1.0, place: Vec3::ZERO };
/// Long legs and very short arms: a T-rex that a human actor would drive.
const GIANT: Build =
    Build { height: 14.0, legs: 1.15, arms: 0.45, head: 1.6, place: Vec3::new(-4.5, 0.0, -3.0) };

impl Build {
    /// Factor by which the vector to a joint is longer than the mannequin's, before the rig is scaled to
    /// `height`.
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

    /// Returns the mannequin with these proportions and its skin adapted to the new bones.
    fn rig(&self, from: &Rig) -> Rig {
        let mut rig = from.clone();
        for joint in &mut rig.joints {
            joint.rest.translation *= self.factor(&joint.name);
        }
        let mut model = bind(&rig);
        // Puts the feet on the ground, and the top of the head at the character's height.
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
    let performance = Performance::walk();
    let rigs = [&CHILD, &GIANT].map(|build| build.rig(&performance.rig));
    let mut character =
        |rig: &Rig, build: &Build| Character::new(&mut world, &performance, rig, build, LoopMode::Loop);
    let characters = [character(&rigs[0], &CHILD), character(&rigs[1], &GIANT)];
    let mut cast = Cast::of(performance.rig);
    let clip = cast.add(&performance.clip, Vec::new());
    let mut human = Actor::new(&Arc::new(cast), Transform::IDENTITY);
    human.animator.play(&human.cast.set, &TrackDef::new(clip));
    human.mark(&mut world);
    Instance::new(world, Retarget { human, characters, gone: Gone::default() })
}

fn captured(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    let rig = mannequin().rig;
    let character =
        |build: &Build| Character::new(&mut world, setup.motion(), &build.rig(&rig), build, LoopMode::Once);
    let characters = [&CHILD, &HUMAN, &GIANT].map(character);
    Instance::new(world, Captured { characters, gone: Gone::default() })
}

/// A character and the errors of its motion.
struct Character {
    actor: Actor,
    fitted: Retargeted,
    height: f32,
    /// Distance along z so far, metres.
    way: f32,
    /// Largest depth of a toe joint below the ground, metres.
    sunk: f32,
}

impl Character {
    /// Creates a character that plays a performance, which can be retargeted.
    fn new(world: &mut World, of: &Performance, rig: &Rig, build: &Build, loop_mode: LoopMode) -> Self {
        let fitted = of.fitted(rig).expect("both rigs are humanoids");
        let mut cast = Cast::of(rig.clone());
        let clip = cast.add(&fitted.clip(rig, "motion"), Vec::new());
        let mut actor = Actor::new(&Arc::new(cast), Transform::from_translation(build.place));
        actor.animator.play(&actor.cast.set, &TrackDef { loop_mode, ..TrackDef::new(clip) });
        actor.mark(world);
        Self { actor, fitted, height: build.height, way: 0.0, sunk: 0.0 }
    }

    /// Updates the animation, and moves the character against the velocity of its feet on the ground.
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

    /// Speed at which the character's feet slide, cm/s for each metre of height.
    fn slide(&self) -> f32 {
        100.0 * self.fitted.feet.slide[1].mean / self.height
    }

    /// Expected duration of a clip relative to the actor's: by Froude's law, the square root of the ratio of leg
    /// lengths.
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

    fn camera_hint(&self) -> CameraHint {
        CameraHint { direction: Vec3::new(0.9, 0.12, 1.0), trails: Trails::None, ..CameraHint::default() }
    }

    fn figures(&self) -> Vec<Figure<'_>> {
        [&self.human]
            .into_iter()
            .chain(self.characters.iter().map(|character| &character.actor))
            .map(Actor::figure)
            .collect()
    }
}

struct Captured {
    /// The child, the human and the giant.
    characters: [Character; 3],
    gone: Gone,
}

impl Script for Captured {
    fn before_step(&mut self, world: &mut World) {
        let dt = world.def().dt();
        for _ in self.gone.due(world) {
            self.characters.iter_mut().for_each(|character| character.update(dt));
        }
        self.characters.iter().for_each(|character| character.actor.lead_marks(world));
    }

    fn metrics(&self, _: &World) -> Vec<Metric> {
        let [child, human, giant] = &self.characters;
        let slide = |name, character: &Character| Metric::new(name, character.slide(), Expected::AtMost(1.0));
        let sunk = |name, character: &Character| {
            Metric::new(name, character.sunk, Expected::AtMost(0.02 * f64::from(character.height)))
        };
        let actor = 100.0 * human.fitted.actor_slide.mean;
        vec![
            Metric::new("actor_slide_cm_s", actor, Expected::Anything),
            slide("child_slide_cm_s_per_m", child),
            slide("human_slide_cm_s_per_m", human),
            slide("giant_slide_cm_s_per_m", giant),
            Metric::new("child_pace", child.fitted.pace, child.pace()),
            Metric::new("giant_pace", giant.fitted.pace, giant.pace()),
            sunk("child_sunk_m", child),
            sunk("human_sunk_m", human),
            sunk("giant_sunk_m", giant),
        ]
    }

    fn camera_hint(&self) -> CameraHint {
        CameraHint { direction: Vec3::new(0.9, 0.12, 1.0), trails: Trails::None, ..CameraHint::default() }
    }

    fn figures(&self) -> Vec<Figure<'_>> {
        self.characters.iter().map(|character| character.actor.figure()).collect()
    }
}
