//! Eight drops and a wall hit that every ragdoll must pass.

use super::meter::CALM;
use super::{FallQuality, QualityMeter, Verdict, judge};
use crate::def::RagdollDef;
use crate::ragdoll::{BodySettings, BodyState, Ragdoll};
use sinew_math::{Rotation, Transform, Vec3, max, min};
use sinew_physics::{BodyDef, BodyId, BodyKind, Shape, ShapeDef, Velocity, World, WorldDef};

/// Distance from the lowest point to the floor at the start of a drop, metres.
const HEIGHT: f32 = 1.0;
/// Longest duration of a drop, seconds.
const DROP_SECONDS: f32 = 10.0;
/// Speed of the ragdoll in the wall hit, m/s, and duration of the hit, seconds.
const WALL_SPEED: f32 = 15.0;
const WALL_SECONDS: f32 = 3.0;

/// Result of [`drop_test`].
#[derive(Clone, Debug, PartialEq)]
pub struct DropReport {
    /// The worst value of each metric over the 8 drops; a time is `None` if any drop lacks the event.
    pub drop: FallQuality,
    /// Metrics of each drop.
    pub drops: Vec<FallQuality>,
    /// Metrics of the wall hit.
    pub wall: FallQuality,
    /// Poses of the bodies in each drop.
    pub falls: Vec<Fallen>,
    /// Verdict on the ragdoll.
    pub verdict: Verdict,
    /// Reasons for the verdict, one sentence each.
    pub reasons: Vec<String>,
}

/// Course of a drop onto the plane y = 0: poses of the bodies, and time in the air.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fallen {
    /// World poses of the bodies, four times a second from the release on, and at the end.
    pub poses: Vec<Vec<Transform>>,
    /// Time in which no body was within 1 cm of the floor, seconds, counted from the first calm: every body below 0.3
    /// m/s after a body touched the floor.
    pub airborne_s: f32,
    has_touched: bool,
    is_calm: bool,
}

/// Number of steps of 1/60 s between two poses of a [`Fallen`].
const STEPS_A_POSE: u32 = 15;
/// Distance from the floor above which a body counts as in the air, metres.
const IN_THE_AIR: f32 = 0.01;

impl Fallen {
    fn see(&mut self, step: u32, world: &World, def: &RagdollDef, ragdoll: &Ragdoll) {
        if step.is_multiple_of(STEPS_A_POSE) {
            self.keep(world, ragdoll);
        }
        let lowest = def.bodies.iter().zip(&ragdoll.bodies).fold(f32::INFINITY, |lowest, (body, &id)| {
            min(lowest, body.shape.aabb(&world.transform(id)).min.y)
        });
        let is_touching = lowest < IN_THE_AIR;
        self.has_touched |= is_touching;
        let is_slow = |&body: &BodyId| world.velocity(body).linear.length() < CALM;
        self.is_calm |= self.has_touched && ragdoll.bodies.iter().all(is_slow);
        if self.is_calm && !is_touching {
            self.airborne_s += world.def().dt();
        }
    }

    fn keep(&mut self, world: &World, ragdoll: &Ragdoll) {
        let mut poses = Vec::new();
        ragdoll.poses(world, &mut poses);
        self.poses.push(poses);
    }
}

/// Drops the ragdoll from 1 m in eight orientations and throws it at a wall at 15 m/s.
///
/// # Panics
/// If `build` could not have produced the definition: for instance no bodies, or masses that are not positive.
pub fn drop_test(def: &RagdollDef) -> DropReport {
    let (drops, falls): (Vec<_>, Vec<_>) =
        releases().into_iter().map(|(turn, spin)| drop_once(def, turn, spin)).unzip();
    let drop = drops.iter().copied().reduce(worse).unwrap_or_default();
    let wall = wall_hit(def);
    let (verdict, reasons) = judge(&drop, &wall);
    DropReport { drop, drops, wall, falls, verdict, reasons }
}

/// Returns the orientations and angular velocities (rad/s) of the eight drops: standing, on the face, on the back, on
/// each side, on the head, and two that tumble. The drop on the head is slightly tilted: a symmetric body with a large
/// head can balance upright on it for seconds, independent of how well it settles.
fn releases() -> [(Rotation, Vec3); 8] {
    let turned = |axis, degrees: f32| Rotation::from_axis_angle(axis, degrees.to_radians());
    let askew = turned(Vec3::Z, 40.0) * turned(Vec3::X, 25.0);
    [
        (Rotation::IDENTITY, Vec3::ZERO),
        (turned(Vec3::X, 90.0), Vec3::ZERO),
        (turned(Vec3::X, -90.0), Vec3::ZERO),
        (turned(Vec3::Z, 90.0), Vec3::ZERO),
        (turned(Vec3::Z, -90.0), Vec3::ZERO),
        (turned(Vec3::Z, 8.0) * turned(Vec3::X, 180.0), Vec3::ZERO),
        (askew, Vec3::new(3.0, 1.0, -2.0)),
        (askew.inverse(), Vec3::new(-4.0, 2.0, 3.0)),
    ]
}

/// Returns a static half-space with its surface at y = 0.
fn floor() -> BodyDef {
    BodyDef { kind: BodyKind::Static, shapes: vec![ShapeDef::new(Shape::HalfSpace)], ..BodyDef::default() }
}

fn drop_once(def: &RagdollDef, turn: Rotation, spin: Vec3) -> (FallQuality, Fallen) {
    let mut world = World::new(WorldDef::default());
    world.add_body(&floor());
    let ragdoll = released(&mut world, def, turn, spin, Vec3::ZERO);
    let mut fallen = Fallen::default();
    let see = |step: u32, world: &World| fallen.see(step, world, def, &ragdoll);
    let quality = measure_seen(&mut world, def, &ragdoll, DROP_SECONDS, see);
    fallen.keep(&world, &ragdoll);
    (quality, fallen)
}

fn wall_hit(def: &RagdollDef) -> FallQuality {
    let mut world = World::new(WorldDef::default());
    world.add_body(&floor());
    let half_extents = Vec3::new(4.0, 3.0, 0.25);
    // Start half a metre in front of the farthest point, so that long creatures do not start inside the wall.
    let pivot = def.bodies[0].character_from_body.translation;
    let front = def
        .bodies
        .iter()
        .fold(0.0, |front, body| max(front, body.shape.aabb(&body.character_from_body).max.z - pivot.z));
    let reach = front + 0.5;
    world.add_body(&BodyDef {
        kind: BodyKind::Static,
        position: Vec3::new(0.0, half_extents.y, reach + half_extents.z),
        shapes: vec![ShapeDef::new(Shape::Box { half_extents })],
        ..BodyDef::default()
    });
    let ragdoll = released(&mut world, def, Rotation::IDENTITY, Vec3::ZERO, Vec3::Z * WALL_SPEED);
    measure(&mut world, def, &ragdoll, WALL_SECONDS)
}

/// Adds the ragdoll in its bind pose, rotated and moving as one rigid piece, [`HEIGHT`] above the floor.
fn released(world: &mut World, def: &RagdollDef, turn: Rotation, spin: Vec3, speed: Vec3) -> Ragdoll {
    let pivot = def.bodies[0].character_from_body.translation;
    let turned = Transform::new(-(turn * pivot), turn);
    let lowest = def.bodies.iter().fold(f32::INFINITY, |lowest, body| {
        min(lowest, body.shape.aabb(&(turned * body.character_from_body)).min.y)
    });
    let world_from_character = Transform::from_translation(Vec3::Y * (HEIGHT - lowest)) * turned;
    let states = carried(def, world_from_character, spin, speed);
    Ragdoll::spawn(world, def, &states, &BodySettings::default())
}

/// Returns the states of the bodies in the bind pose, moving as one rigid body that spins about its pelvis.
pub(super) fn carried(
    def: &RagdollDef,
    world_from_character: Transform,
    spin: Vec3,
    speed: Vec3,
) -> Vec<BodyState> {
    let pivot = world_from_character.point(def.bodies[0].character_from_body.translation);
    let state = |world_from_body: Transform, center: Vec3| BodyState {
        world_from_body,
        velocity: Velocity {
            linear: speed + spin.cross(world_from_body.point(center) - pivot),
            angular: spin,
        },
    };
    def.bodies
        .iter()
        .map(|body| state(world_from_character * body.character_from_body, body.mass.center))
        .collect()
}

/// Steps until the ragdoll sleeps, or the time is over, and returns the metrics.
pub(super) fn measure(world: &mut World, def: &RagdollDef, ragdoll: &Ragdoll, seconds: f32) -> FallQuality {
    measure_seen(world, def, ragdoll, seconds, |_, _| ())
}

/// Like [`measure`]; also passes the world and the step number to a callback after each step.
fn measure_seen(
    world: &mut World,
    def: &RagdollDef,
    ragdoll: &Ragdoll,
    seconds: f32,
    mut see: impl FnMut(u32, &World),
) -> FallQuality {
    let mut meter = QualityMeter::new(def, seconds);
    let steps = (seconds / world.def().dt()) as u32;
    let steps_of_rest = (0.5 / world.def().dt()) as u32 + 1;
    let mut asleep = 0;
    for step in 0..steps {
        meter.before_step(world);
        world.step();
        meter.after_step(world, ragdoll);
        see(step, world);
        let all = ragdoll.bodies.iter().all(|&body| !world.is_awake(body));
        asleep = if all { asleep + 1 } else { 0 };
        // The metrics at rest cover the first half second of rest.
        if asleep > steps_of_rest {
            break;
        }
    }
    meter.quality()
}

/// Returns the worse value of each metric.
pub(super) fn worse(a: FallQuality, b: FallQuality) -> FallQuality {
    let later = |a: Option<f32>, b: Option<f32>| Some(max(a?, b?));
    FallQuality {
        energy_gain_max: max(a.energy_gain_max, b.energy_gain_max),
        work_in_j: max(a.work_in_j, b.work_in_j),
        joint_gap_max_m: max(a.joint_gap_max_m, b.joint_gap_max_m),
        joint_gap_p99_m: max(a.joint_gap_p99_m, b.joint_gap_p99_m),
        limit_overshoot_max_deg: max(a.limit_overshoot_max_deg, b.limit_overshoot_max_deg),
        limit_overshoot_p99_deg: max(a.limit_overshoot_p99_deg, b.limit_overshoot_p99_deg),
        penetration_max_m: max(a.penetration_max_m, b.penetration_max_m),
        penetration_rest_max_m: max(a.penetration_rest_max_m, b.penetration_rest_max_m),
        nonadjacent_overlap_max_m: max(a.nonadjacent_overlap_max_m, b.nonadjacent_overlap_max_m),
        first_contact_s: later(a.first_contact_s, b.first_contact_s),
        settled_s: later(a.settled_s, b.settled_s),
        up_s: later(a.up_s, b.up_s),
        settled_omega_max: later(a.settled_omega_max, b.settled_omega_max),
        asleep_s: later(a.asleep_s, b.asleep_s),
        calm_to_asleep_s: later(a.calm_to_asleep_s, b.calm_to_asleep_s),
        nan: a.nan + b.nan,
    }
}
