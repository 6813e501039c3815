//! Hair at several frame rates side by side.

use crate::framework::actors::{Actor, Cast, Figure, Gone};
use crate::framework::camera_hint::CameraHint;
use crate::framework::curve::Curve;
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::Setup;
use crate::maned::{HAIR, maned};
use crate::mannequin::drills::running;
use crate::parts::floor;
use sinew::anim::TrackDef;
use sinew::math::trig::sin;
use sinew::math::{Affine, Rotation, Transform, Vec3, max};
use sinew::physics::World;
use sinew::ragdoll::{CharacterDef, SpringStep, SpringSwing};
use std::sync::Arc;

pub(in crate::scenes) const HAIR_RATES: Scene = Scene {
    chapter: Chapter::Characters,
    name: "hair",
    about: "a runner's hair at 30, 60, 144 and 240 frames a second: the curves coincide",
    steps: 240,
    settings: &[],
    build: hair,
};

/// Frame rates, frames a second.
const RATES: [u64; 4] = [30, 60, 144, 240];
/// Number of world steps after which every runner has a frame: a sixth of a second.
const COMMON: u64 = 10;
/// Distance from one runner to the next, metres.
const APART: f32 = 1.0;
/// Sideways displacement of a tip that counts as a swing, metres.
const LEAST_SWING: f32 = 0.1;
/// Sway of the runners from side to side, metres and turns per second, and amplitude of their rotation, radians.
const SWAY: f32 = 0.12;
const PACE: f32 = 1.3;
const TURN: f32 = 0.5;
/// Graph of the ponytails' tips, seen from behind: its left end, metres per second of time, and metres per metre.
const GRAPH: Vec3 = Vec3::new(2.0, 2.3, 0.0);
const GRAPH_SECOND: f32 = -1.0;
const GRAPH_METRE: f32 = 1.5;
/// Time from one dash of a curve to the next, seconds: a dozen frames of the coarsest rate.
const DASH: f32 = 0.4;

fn hair(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    let def = Arc::new(maned(&HAIR));
    let mut cast = Cast::of(def.rig.clone());
    let run = cast.add_cycle(&running(), Vec::new());
    let cast = Arc::new(cast);
    let runner = |index: usize| {
        let mut actor = Actor::new(&cast, Transform::IDENTITY);
        actor.animator.play(&cast.set, &TrackDef::new(run));
        let middle = Vec3::X * (APART * (index as f32 - 1.5));
        let rate = RATES[index];
        let mut runner = Runner {
            actor,
            swing: SpringSwing::new(),
            rate,
            frames: 0,
            middle,
            tips: Vec::new(),
            curve: Vec::new(),
        };
        runner.swing_on(&def, 0.0);
        runner
    };
    let runners = [0, 1, 2, 3].map(runner);
    Instance::new(world, Hair { def, runners, gone: Gone::default(), apart: 0.0, swung: 0.0 })
}

/// Runner whose hair has its own frame rate.
struct Runner {
    actor: Actor,
    swing: SpringSwing,
    /// Frame rate, frames a second.
    rate: u64,
    /// Number of frames so far.
    frames: u64,
    /// Position about which the runner sways.
    middle: Vec3,
    /// Tips of the hair's bones relative to `middle`, metres.
    tips: Vec<Vec3>,
    /// Path of the ponytail's tip: time, seconds, and sideways distance from the head, metres.
    curve: Vec<(f32, f32)>,
}

impl Runner {
    fn frame(&mut self, def: &CharacterDef) {
        self.frames += 1;
        self.swing_on(def, 1.0 / self.rate as f32);
    }

    /// Advances to the time of its next frame by `seconds`; at the start all hair hangs at rest.
    fn swing_on(&mut self, def: &CharacterDef, seconds: f32) {
        let time = self.frames as f32 / self.rate as f32;
        let phase = sin(core::f32::consts::TAU * PACE * time);
        let way = Vec3::X * (SWAY * phase);
        self.actor.place =
            Transform::new(self.middle + way, Rotation::from_axis_angle(Vec3::Y, TURN * phase));
        self.actor.update(seconds);
        self.actor.pose();
        let springs = def.springs();
        self.swing.step(&SpringStep {
            rig: springs,
            pose: &self.actor.local,
            world_from_model: Affine::from(self.actor.place),
            bodies: &[],
            world: None,
            seconds,
        });
        for (joint, &turn) in springs.joints().zip(self.swing.turns()) {
            self.actor.local[joint].rotation = turn;
        }
        let root = Affine::from(self.actor.place);
        sinew::anim::local_to_model(&def.rig, &self.actor.local, &root, &mut self.actor.model);
        let tip =
            |bone: &sinew::anim::SpringBone| self.actor.model[bone.joint].point(bone.tail) - self.middle;
        let chains = &springs.source().chains;
        self.tips.clear();
        self.tips.extend(chains.iter().flat_map(|chain| &chain.bones).map(tip));
        let root = self.actor.model[chains[0].bones[0].joint].translation - self.middle;
        self.curve.push((time, self.tips[chains[0].bones.len() - 1].x - root.x));
    }
}

struct Hair {
    def: Arc<CharacterDef>,
    runners: [Runner; 4],
    gone: Gone,
    /// Largest distance between the same tips at one time, relative to the length of their bone.
    apart: f32,
    /// Largest sideways distance of the ponytail's tip from its root, metres.
    swung: f32,
}

impl Hair {
    fn compare(&mut self) {
        let [first, rest @ ..] = &self.runners;
        let bones = self.def.springs().source().chains.iter().flat_map(|chain| &chain.bones);
        for (index, bone) in bones.enumerate() {
            for other in rest {
                let apart = (other.tips[index] - first.tips[index]).length() / bone.tail.length();
                self.apart = max(self.apart, apart);
            }
        }
    }
}

impl Script for Hair {
    fn before_step(&mut self, world: &mut World) {
        for step in self.gone.due(world) {
            for runner in &mut self.runners {
                while (runner.frames + 1) * 60 <= step * runner.rate {
                    runner.frame(&self.def);
                }
                let side = runner.curve.last().map_or(0.0, |(_, side)| side.abs());
                self.swung = max(self.swung, side);
            }
            if step > 0 && step.is_multiple_of(COMMON) {
                self.compare();
            }
        }
    }

    fn metrics(&self, _: &World) -> Vec<Metric> {
        vec![
            // Without this expectation, hair that never moves would pass.
            Metric::awaited(
                "apart_over_length",
                (self.swung > LEAST_SWING).then_some(self.apart),
                Expected::AtMost(0.05),
            ),
            Metric::new("swung_m", self.swung, Expected::Anything),
        ]
    }

    fn camera_hint(&self) -> CameraHint {
        CameraHint { direction: Vec3::new(-0.1, 0.12, -1.0), ..CameraHint::default() }
    }

    /// The finest curve is solid; each coarser curve is drawn over it with shorter dashes, so that coinciding curves
    /// stay visible.
    fn curves(&self) -> Vec<Curve> {
        let place =
            |&(time, side): &(f32, f32)| GRAPH + Vec3::new(time * GRAPH_SECOND, side * GRAPH_METRE, 0.0);
        let curve = |(rank, runner): (usize, &Runner)| {
            let share = (rank + 1) as f32 / RATES.len() as f32;
            let is_drawn = |pair: &&[(f32, f32)]| (pair[1].0 / DASH - 0.01).rem_euclid(1.0) < share;
            let pieces = runner.curve.windows(2).filter(is_drawn);
            Curve {
                name: format!("{} frames a second", runner.rate),
                pieces: pieces.map(|pair| [place(&pair[0]), place(&pair[1])]).collect(),
            }
        };
        self.runners.iter().enumerate().rev().map(curve).collect()
    }

    fn figures(&self) -> Vec<Figure<'_>> {
        self.runners.iter().map(|runner| runner.actor.figure()).collect()
    }
}
