//! Simulates many random falls: pose × velocity × terrain.

use super::drop_test::{carried, measure, worse};
use super::{FallQuality, Verdict, judge};
use crate::def::RagdollDef;
use crate::limits::sample::random_turn;
use crate::ragdoll::{BodySettings, BodyState, Ragdoll, colliding_pairs};
use sinew_math::{Random, Rotation, Transform, Vec3, min};
use sinew_physics::{BodyDef, BodyKind, Serial, Shape, ShapeDef, TaskRunner, World, WorldDef};
use std::sync::{Mutex, PoisonError};

/// Longest duration of a fall, seconds.
const SECONDS: f32 = 10.0;
/// Share of a joint's range that a random pose uses.
const POSE_SHARE: f32 = 0.6;
/// Number of attempts to find a random pose in which no two bodies overlap.
const TRIES: u32 = 16;

/// Result of [`gate`].
#[derive(Clone, Debug, PartialEq)]
pub struct GateReport {
    /// Number of falls.
    pub spawns: usize,
    /// Number of falls with each verdict: good, usable, bad.
    pub verdicts: [usize; 3],
    /// The worst value of each metric.
    pub worst: FallQuality,
    /// Number of the first fall with the worst verdict, to replay it.
    pub worst_spawn: u64,
    /// Reasons for the verdict of that fall, one sentence each; empty if the verdict is good.
    pub worst_reasons: Vec<String>,
    /// Numbers of the falls that are bad, ascending.
    pub bad: Vec<u64>,
    /// Violations of the hard requirements, by fall.
    pub misses: Vec<Miss>,
    lowest: Verdict,
}

/// A fall that violates a hard requirement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Miss {
    /// Number of the fall: [`random_fall`] replays it.
    pub spawn: u64,
    /// Threshold that the fall does not meet.
    pub bar: Bar,
    /// Value of the metric.
    pub value: f32,
}

/// Threshold that every random fall must meet (specification, section 4).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bar {
    /// No body has a state that is not finite.
    Finite,
    /// [`FallQuality::energy_gain_max`] is below 0.01.
    EnergyGain,
    /// [`FallQuality::joint_gap_p99_m`] is below 1 mm.
    JointGap,
}

impl Bar {
    /// All thresholds.
    pub const ALL: [Self; 3] = [Self::Finite, Self::EnergyGain, Self::JointGap];

    /// Returns the metric's key in reports.
    pub fn key(self) -> &'static str {
        match self {
            Self::Finite => "nan",
            Self::EnergyGain => "energy_gain_max",
            Self::JointGap => "joint_gap_p99_m",
        }
    }

    /// Returns the metric, and the side of the threshold on which it is; NaN does not meet the threshold.
    fn of(self, quality: &FallQuality) -> (f32, Side) {
        let (value, holds) = match self {
            Self::Finite => (quality.nan as f32, quality.nan == 0),
            Self::EnergyGain => (quality.energy_gain_max, quality.energy_gain_max < 0.01),
            Self::JointGap => (quality.joint_gap_p99_m, quality.joint_gap_p99_m < 1e-3),
        };
        (value, if holds { Side::Inside } else { Side::Outside })
    }
}

/// Side of a threshold on which a metric is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Inside,
    Outside,
}

impl Default for GateReport {
    /// Returns the report of zero falls.
    fn default() -> Self {
        Self {
            spawns: 0,
            verdicts: [0; 3],
            worst: FallQuality::default(),
            worst_spawn: 0,
            worst_reasons: Vec::new(),
            bad: Vec::new(),
            misses: Vec::new(),
            lowest: Verdict::Good,
        }
    }
}

impl GateReport {
    /// Merges two reports; `later` has the higher numbers.
    pub fn and(mut self, later: Self) -> Self {
        if later.spawns == 0 {
            return self;
        }
        if self.spawns == 0 {
            return later;
        }
        self.worst = worse(self.worst, later.worst);
        if later.lowest < self.lowest {
            self.lowest = later.lowest;
            (self.worst_spawn, self.worst_reasons) = (later.worst_spawn, later.worst_reasons);
        }
        self.spawns += later.spawns;
        for (count, more) in self.verdicts.iter_mut().zip(later.verdicts) {
            *count += more;
        }
        self.bad.extend(later.bad);
        self.misses.extend(later.misses);
        self
    }

    fn of_fall(spawn: u64, quality: FallQuality) -> Self {
        // A fall has no wall hit, so its own metrics serve as both.
        let (verdict, reasons) = judge(&quality, &quality);
        let is = |wanted: Verdict| usize::from(verdict == wanted);
        let misses = Bar::ALL.into_iter().filter_map(|bar| match bar.of(&quality) {
            (_, Side::Inside) => None,
            (value, Side::Outside) => Some(Miss { spawn, bar, value }),
        });
        Self {
            spawns: 1,
            verdicts: [is(Verdict::Good), is(Verdict::Usable), is(Verdict::Bad)],
            worst: quality,
            worst_spawn: spawn,
            worst_reasons: if verdict == Verdict::Good { Vec::new() } else { reasons },
            bad: if verdict == Verdict::Bad { vec![spawn] } else { Vec::new() },
            misses: misses.collect(),
            lowest: verdict,
        }
    }
}

/// Simulates `spawns` falls; fall `k` does not depend on `spawns`.
pub fn gate(def: &RagdollDef, spawns: usize) -> GateReport {
    gate_on(def, 0..spawns as u64, &Serial)
}

/// Simulates the falls with these numbers, on the threads of `runner`. The report does not depend on the runner.
pub fn gate_on(def: &RagdollDef, spawns: core::ops::Range<u64>, runner: &dyn TaskRunner) -> GateReport {
    let count = usize::try_from(spawns.end.saturating_sub(spawns.start)).unwrap_or(usize::MAX);
    let queue = Mutex::new(spawns);
    let fallen = Mutex::new(Vec::new());
    runner.run(count, &|| {
        // A free thread starts the next fall: some falls last three times as long as others.
        loop {
            let next = queue.lock().unwrap_or_else(PoisonError::into_inner).next();
            let Some(spawn) = next else { break };
            let report = GateReport::of_fall(spawn, random_fall(def, spawn));
            fallen.lock().unwrap_or_else(PoisonError::into_inner).push((spawn, report));
        }
    });
    let mut fallen = fallen.into_inner().unwrap_or_else(PoisonError::into_inner);
    // DETERMINISM: the order in which falls end depends on the threads.
    fallen.sort_unstable_by_key(|&(spawn, _)| spawn);
    fallen.into_iter().fold(GateReport::default(), |sum, (_, report)| sum.and(report))
}

/// Simulates one random fall: number `seed` of a [`gate`].
pub fn random_fall(def: &RagdollDef, seed: u64) -> FallQuality {
    let mut random = Random::new(seed);
    let mut world = World::new(WorldDef::default());
    for body in random_ground(&mut random) {
        world.add_body(&body);
    }
    let states = posed(def, &mut random);
    let ragdoll = Ragdoll::spawn(&mut world, def, &states, &BodySettings::default());
    measure(&mut world, def, &ragdoll, SECONDS)
}

/// Returns the static bodies of a terrain: a bare floor, or a floor with a slope, stairs or scattered boxes. All except
/// slopes are at most 1.1 m high.
pub fn random_ground(random: &mut Random) -> Vec<BodyDef> {
    let fixed = |position: Vec3, rotation: Rotation, shape: Shape| BodyDef {
        kind: BodyKind::Static,
        position,
        rotation,
        shapes: vec![ShapeDef::new(shape)],
        ..BodyDef::default()
    };
    let mut ground = vec![fixed(Vec3::ZERO, Rotation::IDENTITY, Shape::HalfSpace)];
    match random.index(4) {
        0 => {}
        1 => {
            let tilt = Rotation::from_axis_angle(random.direction(), random.range(0.0, 0.5));
            ground.push(fixed(Vec3::ZERO, tilt, Shape::Box { half_extents: Vec3::new(3.0, 0.3, 3.0) }));
        }
        2 => ground.extend((0..6).map(|step| {
            let top = 0.17 * (6 - step) as f32;
            let half_extents = Vec3::new(1.5, 0.5 * top, 0.15);
            let position = Vec3::new(0.0, 0.5 * top, 0.3 * step as f32 - 0.6);
            fixed(position, Rotation::IDENTITY, Shape::Box { half_extents })
        })),
        _ => {
            for _ in 0..6 {
                let half_extents =
                    Vec3::new(random.range(0.1, 0.5), random.range(0.05, 0.4), random.range(0.1, 0.5));
                let position = Vec3::new(random.range(-1.0, 1.0), half_extents.y, random.range(-1.0, 1.0));
                let upright = Rotation::from_axis_angle(Vec3::Y, random.range(-3.0, 3.0));
                ground.push(fixed(position, upright, Shape::Box { half_extents }));
            }
        }
    }
    ground
}

/// Returns a random pose within the limits, with a random position and motion.
fn posed(def: &RagdollDef, random: &mut Random) -> Vec<BodyState> {
    let turn = random.rotation();
    let (spin, speed) = (random.in_cube() * 6.0, random.in_cube() * 5.0);
    let pose = random_pose(def, random);
    let lowest = pose.iter().zip(&def.bodies).fold(f32::INFINITY, |lowest, (&at, body)| {
        let turned = Transform::new(Vec3::ZERO, turn) * at;
        min(lowest, body.shape.aabb(&turned).min.y)
    });
    // Start above the highest terrain.
    let height = random.range(1.3, 2.5) - lowest;
    let world_from_character = Transform::new(Vec3::Y * height, turn);
    let mut states = carried(def, world_from_character, spin, speed);
    let pivot = states[0].world_from_body.translation;
    for ((state, at), body) in states.iter_mut().zip(pose).zip(&def.bodies) {
        state.world_from_body = world_from_character * at;
        let center = state.world_from_body.point(body.mass.center);
        state.velocity.linear = speed + spin.cross(center - pivot);
    }
    states
}

/// Returns a random pose within the limits in which no two bodies that are meant to collide overlap, if one is found in
/// a few tries: poses of the bodies in character space.
pub fn random_pose(def: &RagdollDef, random: &mut Random) -> Vec<Transform> {
    let mut shrink = POSE_SHARE;
    let mut pose = turned_joints(def, random, shrink);
    for _ in 0..TRIES {
        if !overlaps(def, &pose) {
            break;
        }
        shrink *= 0.8;
        pose = turned_joints(def, random, shrink);
    }
    pose
}

/// Returns body poses in character space with joints at random angles, within a share of their ranges.
fn turned_joints(def: &RagdollDef, random: &mut Random, share: f32) -> Vec<Transform> {
    let mut pose: Vec<_> = def.bodies.iter().map(|body| body.character_from_body).collect();
    for joint in &def.joints {
        let turned = random_turn(joint.kind, random, share);
        pose[joint.child] = pose[joint.parent]
            * joint.frame_parent
            * Transform::new(Vec3::ZERO, turned)
            * joint.frame_child.inverse();
    }
    pose
}

/// Returns true if two bodies that are meant to collide overlap.
fn overlaps(def: &RagdollDef, pose: &[Transform]) -> bool {
    let states: Vec<_> =
        pose.iter().map(|&world_from_body| BodyState { world_from_body, ..BodyState::default() }).collect();
    let mut world = World::new(WorldDef::default());
    let ragdoll = Ragdoll::spawn(&mut world, def, &states, &BodySettings::default());
    // Pairs that overlap at the start are not among the colliding ones.
    ragdoll.colliding.len() < colliding_pairs(def).len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bar_that_a_fall_breaks_is_named() {
        let fine = FallQuality { energy_gain_max: 0.009, joint_gap_p99_m: 9e-4, ..FallQuality::default() };
        assert_eq!(GateReport::of_fall(3, fine).misses, []);
        let broken = FallQuality { energy_gain_max: 0.01, joint_gap_p99_m: f32::NAN, nan: 2, ..fine };
        let report = GateReport::of_fall(1, fine).and(GateReport::of_fall(7, broken));
        let found: Vec<_> = report.misses.iter().map(|miss| (miss.spawn, miss.bar)).collect();
        assert_eq!(found, [(7, Bar::Finite), (7, Bar::EnergyGain), (7, Bar::JointGap)]);
        assert_eq!((report.spawns, report.worst_spawn), (2, 1), "neither ever slept, so both are bad");
        assert_eq!((report.bad, report.verdicts), (vec![1, 7], [0, 0, 2]));
    }
}
