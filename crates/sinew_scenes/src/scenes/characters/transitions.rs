//! Transitions between motions: cut, crossfaded, inertialised.

use super::blending::facing;
use crate::framework::actors::{Actor, Cast, Figure, Gone};
use crate::framework::camera_hint::CameraHint;
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::mannequin::drills::{punch, running};
use crate::parts::floor;
use sinew::anim::{ClipId, Decay, Easing, LocalTransform, Pose, TrackDef, Transition};
use sinew::math::{Transform, Vec3, max};
use sinew::physics::World;
use std::sync::Arc;

pub(in crate::scenes) const TRANSITION: Scene = Scene {
    chapter: Chapter::Characters,
    name: "transition",
    about: "from a run to a boxer's guard by a cut, a crossfade and inertialisation: the largest accelerations",
    steps: 120,
    settings: &[Setting::number("seconds", 0.3, (0.1, 1.0), "duration of a transition")],
    build: transition,
};

/// Step before which the transition starts.
const START: u64 = 50;
/// Distance from one character to the next, metres.
const APART: f32 = 1.1;

fn transition(setup: &Setup<'_>) -> Instance {
    let seconds = setup.number("seconds");
    let mut world = setup.world();
    world.add_body(&floor());
    let mut cast = Cast::mannequin();
    let clips = [cast.add_cycle(&running(), Vec::new()), cast.add(&punch(), Vec::new())];
    let cast = Arc::new(cast);
    let ways = [
        Transition::Inertial { seconds: 0.0 },
        Transition::Crossfade { seconds, easing: Easing::Smooth },
        Transition::Inertial { seconds },
    ];
    let mut subject = |i: usize| {
        let place = Transform::from_translation(Vec3::X * (APART * (i as f32 - 1.0)));
        let mut actor = Actor::new(&cast, place);
        actor.animator.play(&cast.set, &TrackDef::new(clips[0]));
        actor.mark(&mut world);
        Subject { actor, transition: ways[i], history: History::default(), peaks: Vec::new() }
    };
    let subjects = [0, 1, 2].map(&mut subject);
    let alone = [0, 1].map(|i| {
        let mut actor = Actor::new(&cast, Transform::IDENTITY);
        if i == 0 {
            actor.animator.play(&cast.set, &TrackDef::new(clips[0]));
        }
        (actor, History::default())
    });
    Instance::new(
        world,
        Transitions { subjects, alone, clips, seconds, bounds: Vec::new(), gone: Gone::default() },
    )
}

/// The last three poses.
#[derive(Default)]
struct History(Vec<Pose>);

impl History {
    fn push(&mut self, pose: &Pose) {
        if self.0.len() == 3 {
            self.0.remove(0);
        }
        self.0.push(pose.clone());
    }

    /// Angular acceleration of a joint at the second of three poses, rad/s².
    fn acceleration(&self, joint: usize, dt: f32) -> f32 {
        let [a, b, c] = &self.0[..] else { return 0.0 };
        let [a, b, c] = [a, b, c].map(|pose| pose.get(joint));
        (velocity(&b, &c, dt) - velocity(&a, &b, dt)).length() / dt
    }

    /// Angular velocity of a joint since the previous step, rad/s.
    fn velocity(&self, joint: usize, dt: f32) -> Vec3 {
        match &self.0[..] {
            [.., a, b] => velocity(&a.get(joint), &b.get(joint), dt),
            _ => Vec3::ZERO,
        }
    }
}

fn velocity(a: &LocalTransform, b: &LocalTransform, dt: f32) -> Vec3 {
    a.rotation.angular_velocity_to(b.rotation, dt)
}

/// A character that changes from one clip to the other by one kind of transition.
struct Subject {
    actor: Actor,
    transition: Transition,
    history: History,
    /// Largest acceleration of each joint since the transition began, rad/s².
    peaks: Vec<f32>,
}

impl Subject {
    /// Largest ratio of the joints' peaks to their bounds.
    fn worst(&self, bounds: &[f32]) -> f32 {
        self.peaks.iter().zip(bounds).map(|(peak, bound)| peak / bound).fold(0.0, max)
    }
}

struct Transitions {
    /// Subjects whose motion is cut, crossfaded and inertialised.
    subjects: [Subject; 3],
    /// Characters that play each clip alone, not drawn: the motion of the joints without a transition.
    alone: [(Actor, History); 2],
    clips: [ClipId; 2],
    seconds: f32,
    /// Bound of each joint's acceleration, rad/s²: the largest value so far of the acceleration in a clip plus
    /// `6 |x₀|/t₁² + 4 |v₀|/t₁`.
    bounds: Vec<f32>,
    gone: Gone,
}

impl Transitions {
    fn step(&mut self, step: u64, dt: f32) {
        if step == START {
            let [_, (second, history)] = &mut self.alone;
            *history = History::default();
            second.animator.play(&second.cast.set, &TrackDef::new(self.clips[1]));
            second.update(0.0);
            for Subject { actor, transition, .. } in &mut self.subjects {
                actor.animator.transition(&actor.cast.set, &TrackDef::new(self.clips[1]), *transition);
            }
        }
        for (actor, history) in &mut self.alone {
            history.push(actor.animator.pose());
            actor.update(dt);
        }
        for subject in &mut self.subjects {
            subject.actor.update(dt);
            subject.history.push(subject.actor.animator.pose());
        }
        let lasts = (self.seconds / dt) as u64 + 2;
        if (START..START + lasts).contains(&step) {
            self.watch(dt);
        }
    }

    /// Updates the bounds. They use the largest distance of the clips, and the largest rate at which they separate,
    /// during the transition.
    fn watch(&mut self, dt: f32) {
        let [(_, first), (_, second)] = &self.alone;
        let joints = self.subjects[0].actor.animator.pose().len();
        self.bounds.resize(joints, ROUNDING);
        for joint in 0..joints {
            let [from, to] = [first, second].map(|history| history.0[history.0.len() - 1].get(joint));
            let offset = (from.rotation * to.rotation.inverse()).to_scaled_axis();
            let velocity = first.velocity(joint, dt) - second.velocity(joint, dt);
            let time = Decay { offset, velocity }.shortened(self.seconds);
            let apart = 6.0 * offset.length() / (time * time) + 4.0 * velocity.length() / time;
            let own = max(first.acceleration(joint, dt), second.acceleration(joint, dt));
            self.bounds[joint] = max(self.bounds[joint], own + apart);
        }
        for Subject { history, peaks, .. } in &mut self.subjects {
            peaks.resize(joints, 0.0);
            for (joint, peak) in peaks.iter_mut().enumerate() {
                *peak = max(*peak, history.acceleration(joint, dt));
            }
        }
    }
}

/// Rounding error of accelerations computed from differences of poses, rad/s².
const ROUNDING: f32 = 0.5;

impl Script for Transitions {
    fn before_step(&mut self, world: &mut World) {
        let dt = world.def().dt();
        for step in self.gone.due(world) {
            self.step(step, dt);
        }
        for Subject { actor, .. } in &mut self.subjects {
            actor.pose();
            actor.lead_marks(world);
        }
    }

    fn metrics(&self, _: &World) -> Vec<Metric> {
        let [cut, crossfade, inertial] = self.subjects.each_ref().map(|subject| subject.worst(&self.bounds));
        vec![
            Metric::new("cut_over_bound", cut, Expected::Anything),
            Metric::new("crossfade_over_bound", crossfade, Expected::AtMost(1.0)),
            Metric::new("inertial_over_bound", inertial, Expected::AtMost(1.0)),
        ]
    }

    fn camera_hint(&self) -> CameraHint {
        facing()
    }

    fn figures(&self) -> Vec<Figure<'_>> {
        self.subjects.iter().map(|subject| subject.actor.figure()).collect()
    }
}
