//! Pops at hand-over to bodies and back: accelerations of joints greater than the offset and the duration of a
//! transition require, measured as for transitions between clips.

use core::fmt;
use sinew_anim::{Cursor, Decay, LocalTransform, Pose, local_to_model};
use sinew_math::{Affine, Rotation, Transform, Vec3, max, min};
use sinew_physics::{World, WorldDef};
use sinew_ragdoll::{Character, CharacterDef, CharacterEvent, RagdollBodyDef};
use std::sync::Arc;

const DT: f32 = 1.0 / 60.0;
/// Number of observed steps after a hand-over.
const WINDOW: usize = 24;
/// Number of steps of clips before hand-over, and of all steps: one cycle of a walk.
const BEFORE: usize = 12;
const LAP: usize = 72;
/// Transition times into a get-up clip and into the looped clip, seconds.
const INTO: [f32; 2] = [0.35, 0.3];

/// Angular and linear rate.
type Rates = [Vec3; 2];

/// Returns the observed joint transforms: the pelvis in the world, others relative to their parents.
fn seen(character: &Character) -> Vec<Transform> {
    let def = character.def();
    let mut model = Vec::new();
    local_to_model(&def.rig, character.pose(), &character.world_from_model(), &mut model);
    let mut seen: Vec<Transform> =
        character.pose().iter().map(|local| Transform::new(local.translation, local.rotation)).collect();
    for head in def.mapping().heads() {
        seen[head] = model[head].to_rigid();
    }
    seen
}

fn turn(from: Rotation, to: Rotation) -> Vec3 {
    (to * from.inverse()).to_scaled_axis()
}

fn rates(a: Transform, b: Transform) -> Rates {
    [turn(a.rotation, b.rotation) / DT, (b.translation - a.translation) / DT]
}

/// Returns the centres of mass of the bodies, with their rotations, in the animated pose.
fn centers(character: &Character) -> Vec<Transform> {
    let def = character.def();
    let (mut model, mut bodies) = (Vec::new(), Vec::new());
    local_to_model(&def.rig, character.pose(), &Affine::IDENTITY, &mut model);
    def.mapping().bodies_from_model(&model, character.world_from_character(), &mut bodies);
    let at_center = |(body, def): (&Transform, &RagdollBodyDef)| {
        Transform::new(body.point(def.mass.center), body.rotation)
    };
    bodies.iter().zip(&def.ragdoll.bodies).map(at_center).collect()
}

/// Budget of a joint in a window.
#[derive(Clone, Copy, Default)]
struct Budget([f32; 2]);

/// A time window in which pops are measured.
struct Window {
    kind: usize,
    left: usize,
    budgets: Vec<Budget>,
}

pub struct Pops {
    def: Arc<CharacterDef>,
    last: Vec<Vec<Transform>>,
    window: Option<Window>,
    worst: [(f32, String); 3],
    count: [u32; 3],
}

impl Pops {
    pub fn new(def: &Arc<CharacterDef>) -> Self {
        Self { def: def.clone(), last: Vec::new(), window: None, worst: Default::default(), count: [0; 3] }
    }

    /// Starts to observe another character.
    pub fn begin(&mut self, character: &Character) {
        self.last = vec![seen(character)];
        self.window = None;
    }

    /// Compares body velocities at hand-over with those of the last animated step, relative to their change from step
    /// to step while animated. The push is excluded. The later effect of joint friction, limits and floor is physics
    /// and not counted.
    pub fn go_limp(&mut self, character: &Character) {
        let mut world = World::new(WorldDef::default());
        let mut animated = character.clone();
        let mut places = vec![centers(&animated)];
        let mut given: Vec<Rates> = Vec::new();
        for step in 1..LAP {
            animated.update(&mut world);
            places.push(centers(&animated));
            if step == BEFORE {
                let mut limp = animated.clone();
                limp.go_limp(&mut world);
                let bodies = &limp.ragdoll().expect("the character is limp").bodies;
                let velocity = |&body| [world.velocity(body).angular, world.velocity(body).linear];
                given = bodies.iter().map(velocity).collect();
            }
        }
        self.count[2] += 1;
        for (body, given) in given.iter().enumerate() {
            let rate: Vec<Rates> = places.windows(2).map(|w| rates(w[0][body], w[1][body])).collect();
            for i in 0..2 {
                let own = rate.windows(2).map(|w| (w[1][i] - w[0][i]).length() / DT).fold(0.0, max);
                let jump = (given[i] - rate[BEFORE - 1][i]).length() / DT;
                let ratio = jump / (1.2 * own + [0.5, 0.05][i]);
                if ratio > self.worst[2].0 {
                    let role = &self.def.ragdoll.bodies[body].role;
                    self.worst[2] = (ratio, format!("{role}, {}", ["turn", "way"][i]));
                }
            }
        }
    }

    /// Observes the character after an update.
    pub fn watch(&mut self, character: &Character) {
        let now = seen(character);
        if let (Some(window), [.., before, last]) = (&mut self.window, &self.last[..]) {
            for joint in 0..now.len() {
                let (old, new) = (rates(before[joint], last[joint]), rates(last[joint], now[joint]));
                for i in 0..2 {
                    let ratio = (new[i] - old[i]).length() / DT / window.budgets[joint].0[i];
                    if ratio > self.worst[window.kind].0 {
                        let name = &self.def.rig.joints[joint].name;
                        let at = WINDOW - window.left;
                        self.worst[window.kind] =
                            (ratio, format!("{name}, {}, step {at}", ["turn", "way"][i]));
                    }
                }
            }
            window.left -= 1;
            if window.left == 0 {
                self.window = None;
            }
        }
        for event in character.events() {
            let kind = match event {
                CharacterEvent::GettingUp { clip: Some(_) } => 0,
                CharacterEvent::Up => 1,
                _ => continue,
            };
            self.count[kind] += 1;
            let budgets = self.budgets(character, &now, kind);
            self.window = Some(Window { kind, left: WINDOW, budgets });
        }
        if self.last.len() == 2 {
            self.last.remove(0);
        }
        self.last.push(now);
    }

    /// Computes `6 |x₀|/t₁² + 4 |v₀|/t₁` plus the clip's own acceleration.
    fn budgets(&self, character: &Character, now: &[Transform], kind: usize) -> Vec<Budget> {
        let animator = character.animator();
        let track = animator.tracks().last().expect("it plays a clip");
        let clip = &self.def.set().clip(track.def().clip).clip;
        let start = track.playhead().clip_time();
        let mut cursor = Cursor::new();
        let mut to = |step: usize| {
            let mut pose = Pose::new(clip.joints());
            let time = start + step as f32 * DT;
            let loops = kind == 1 && time > clip.duration();
            clip.sample(if loops { time - clip.duration() } else { time }, &mut cursor, &mut pose);
            pose
        };
        let poses: Vec<Pose> = (0..WINDOW + 2).map(&mut to).collect();
        let before = self.last.last().expect("there was a step before");
        let heads: Vec<usize> = self.def.mapping().heads().collect();
        let plain = |local: LocalTransform| Transform::new(local.translation, local.rotation);
        let of = |joint: usize| {
            let rate: Vec<Rates> = poses
                .windows(2)
                .map(|pair| rates(plain(pair[0].get(joint)), plain(pair[1].get(joint))))
                .collect();
            let own =
                |i: usize| rate.windows(2).map(|pair| (pair[1][i] - pair[0][i]).length() / DT).fold(0.0, max);
            let (from, target) = (plain(character.pose()[joint]), plain(poses[0].get(joint)));
            let offsets = [turn(target.rotation, from.rotation), from.translation - target.translation];
            let old = rates(before[joint], now[joint]);
            Budget([0, 1].map(|i| {
                let velocity = if heads.contains(&joint) {
                    // In another frame the velocity is at most the sum of both.
                    Vec3::X * (old[i].length() + rate[0][i].length())
                } else {
                    old[i] - rate[0][i]
                };
                let decay = Decay { offset: offsets[i], velocity };
                let whole = INTO[kind];
                let time = if heads.contains(&joint) {
                    // The joint may return as fast as both together; then the decay is shorter, down to a third of the
                    // time.
                    let soonest = 5.0 * decay.offset.length() / max(velocity.length(), 1e-6);
                    max(min(whole, soonest), whole / 3.0)
                } else {
                    decay.shortened(whole)
                };
                let asked = 6.0 * decay.offset.length() / (time * time) + 4.0 * velocity.length() / time;
                asked + 1.2 * own(i) + [0.5, 0.05][i]
            }))
        };
        (0..now.len()).map(of).collect()
    }

    /// Returns the worst ratio; above 1 there is a pop.
    pub fn worst(&self) -> f32 {
        self.worst.iter().fold(0.0, |worst, (ratio, _)| max(worst, *ratio))
    }
}

impl fmt::Display for Pops {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (kind, name) in ["bodies to get-up", "get-up to loop", "clip to bodies"].iter().enumerate() {
            let (ratio, place) = &self.worst[kind];
            let count = self.count[kind];
            writeln!(f, "  {name}: {count} times, worst {ratio:.3} of the budget ({place})")?;
        }
        Ok(())
    }
}
