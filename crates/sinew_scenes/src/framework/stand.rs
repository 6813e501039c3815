//! Bodies that should stay where they are placed.

use super::camera_hint::{CameraHint, Trails};
use super::flight::Flight;
use super::instance::Script;
use super::metric::{Expected, Metric};
use sinew::math::{Transform, Vec3, max};
use sinew::physics::boxes::Aabb;
use sinew::physics::{BodyId, World};

/// Largest allowed motion of standing bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bars {
    /// Sideways motion of any body, metres.
    pub shift: f64,
    /// Sideways motion of the last body, metres.
    pub top_drift: f64,
    /// Downward motion of any body, metres. Soft contacts sink under the weight above them.
    pub sink: f64,
    /// Rotation of any body, degrees.
    pub turn: f64,
    /// Deepest overlap of two bodies at the end, metres.
    pub depth: f64,
    /// Time from the start to the sleep of the last body, seconds.
    pub asleep: Expected,
}

/// Measures standing bodies.
pub(crate) struct Stand {
    /// Target transform of each body, the top one last.
    placed: Vec<(BodyId, Transform)>,
    /// Free fall of a body, to verify gravity.
    flight: Flight,
    bars: Bars,
    /// Bounds around all standing bodies.
    bounds: Aabb,
    asleep: Option<f32>,
}

impl Stand {
    /// Creates the measurement of bodies at their present positions.
    pub fn new(world: &World, bodies: &[BodyId], flight: Flight, bars: Bars) -> Self {
        let placed: Vec<_> = bodies.iter().map(|&id| (id, center(world, id))).collect();
        let centers = placed.iter().map(|(_, at)| Aabb::around(at.translation, Vec3::ZERO));
        let bounds = centers.reduce(|a, b| a.merge(&b)).expect("at least one body stands");
        let bounds = bounds.expand(0.1 * bounds.half_extents().length());
        Self { placed, flight, bars, bounds, asleep: None }
    }

    fn worst(&self, world: &World, of: impl Fn(Transform, Transform) -> f32) -> f32 {
        self.placed.iter().fold(0.0, |worst, &(id, from)| max(worst, of(from, center(world, id))))
    }
}

/// Centre of mass of a body, with the body's rotation.
pub(crate) fn center(world: &World, id: BodyId) -> Transform {
    Transform::new(world.center_of_mass(id), world.transform(id).rotation)
}

/// Horizontal distance of two transforms, metres.
pub(crate) fn shift(from: Transform, to: Transform) -> f32 {
    let moved = to.translation - from.translation;
    Vec3::new(moved.x, 0.0, moved.z).length()
}

/// Returns the deepest overlap of one of these bodies with any other body, metres.
pub(crate) fn deepest(world: &World, bodies: impl Iterator<Item = BodyId>) -> f32 {
    bodies.fold(0.0, |deepest, id| {
        world.neighbors(id).fold(deepest, |deepest, other| max(deepest, world.overlap(id, other)))
    })
}

impl Script for Stand {
    fn after_step(&mut self, world: &mut World) {
        self.flight.after_step(world);
        if self.asleep.is_none() && self.placed.iter().all(|&(id, _)| !world.is_awake(id)) {
            self.asleep = Some(world.time() as f32);
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let Bars { shift: most_shift, top_drift, sink, turn, depth, asleep } = self.bars;
        let &(top, from) = self.placed.last().expect("at least one body stands");
        let at_most = |name, value: f32, most: f64| Metric::new(name, value, Expected::AtMost(most));
        vec![
            self.flight.metric(),
            at_most("shift_max_m", self.worst(world, shift), most_shift),
            at_most("top_drift_m", shift(from, center(world, top)), top_drift),
            at_most("sink_max_m", self.worst(world, |a, b| a.translation.y - b.translation.y), sink),
            at_most(
                "turn_max_deg",
                self.worst(world, |a, b| a.rotation.angle_to(b.rotation)).to_degrees(),
                turn,
            ),
            at_most("depth_max_m", deepest(world, self.placed.iter().map(|&(id, _)| id)), depth),
            Metric::awaited("asleep_s", self.asleep, asleep),
        ]
    }

    fn camera_hint(&self) -> CameraHint {
        CameraHint { bounds: Some(self.bounds), trails: Trails::None, ..CameraHint::default() }
    }
}
