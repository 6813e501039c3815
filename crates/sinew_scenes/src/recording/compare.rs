//! Finds the first step at which two recordings differ, and how.

use super::format::{KeyFrame, Recording};
use super::record::Replay;
use sinew::math::Transform;
use sinew::physics::{BodyId, World};

/// First difference of two recordings.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// The recordings have different scenes or settings.
    Scene,
    /// The states differ after `step` steps, and were equal before.
    State {
        /// Number of steps taken.
        step: u64,
        /// First body whose pose differs, with both poses; `None` if no pose differs, or if neither recording can be
        /// replayed.
        body: Option<(BodyId, [Transform; 2])>,
    },
    /// One recording has more steps; all common steps are equal.
    Length {
        /// Number of steps that both recordings have.
        common: u64,
    },
}

/// Returns the first difference of two recordings; `None` if all steps are equal.
pub fn compare(a: &Recording, b: &Recording) -> Option<Difference> {
    if (&a.scene, &a.settings) != (&b.scene, &b.settings) {
        return Some(Difference::Scene);
    }
    let differs = a.steps.iter().zip(&b.steps).position(|(a, b)| a.hash != b.hash);
    let Some(place) = differs else {
        let common = a.steps.len().min(b.steps.len()) as u64;
        return (a.steps.len() != b.steps.len()).then_some(Difference::Length { common });
    };
    let step = place as u64 + 1;
    let body = match (state_at(a, step), state_at(b, step)) {
        (Some(a), Some(b)) => first_body(&poses(a.instance().world()), &poses(b.instance().world())),
        // Recordings that this version cannot replay are compared by their key frames.
        _ => first_of_key_frames(a, b, step),
    };
    Some(Difference::State { step, body })
}

/// Replays a recording up to a step; `None` if its state diverged on the way.
fn state_at(recording: &Recording, step: u64) -> Option<Replay> {
    let mut replay = Replay::start(recording.clone()).ok()?;
    for _ in 0..step {
        let taken = replay.step()?;
        if taken.found != taken.recorded {
            return None;
        }
    }
    Some(replay)
}

type Poses = Vec<(BodyId, Transform)>;

fn poses(world: &World) -> Poses {
    world.body_ids().map(|id| (id, world.transform(id))).collect()
}

fn first_body(a: &Poses, b: &Poses) -> Option<(BodyId, [Transform; 2])> {
    let differing =
        |(a, b): (&(BodyId, Transform), &(BodyId, Transform))| (a != b).then_some((a.0, [a.1, b.1]));
    a.iter().zip(b).find_map(differing)
}

fn first_of_key_frames(a: &Recording, b: &Recording, step: u64) -> Option<(BodyId, [Transform; 2])> {
    let after = |frame: &&KeyFrame| frame.step >= step;
    let pairs = a.key_frames.iter().filter(after);
    let mut pairs = pairs.filter_map(|a| Some((a, b.key_frames.iter().find(|b| b.step == a.step)?)));
    pairs.find_map(|(a, b)| first_body(&a.bodies, &b.bodies))
}
