//! One of every shape on one of every floor.

use crate::blueprint::waves::Waves;
use crate::framework::flight::Flight;
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{body, cuboid, fixed, floor, made_of, tilt};
use sinew::math::{Rotation, Vec3, max};
use sinew::physics::{BodyDef, BodyId, Hull, Material, Shape, World};
use std::sync::Arc;

pub(in crate::scenes) const SHOWROOM: Scene = Scene {
    chapter: Chapter::Shows,
    name: "showroom",
    about: "one of every shape falls on a half-space, a box, a mesh and a height field, and rests at its height",
    steps: 300,
    settings: &[
        Setting::number("drop", 0.2, (0.15, 5.0), "initial height above the rest pose, m"),
        Setting::number("tilt", 20.0, (0.0, 30.0), "initial angle from the rest pose, degrees"),
    ],
    build,
};

/// Half the side of a floor, and the distance between the centres of neighbouring floors, metres.
const HALF_SIDE: f32 = 3.0;
const NEXT_FLOOR: f32 = 6.5;
/// Distance between neighbouring bodies on a floor, metres: some are on corners, some on edges, some inside of
/// triangles of 1 m.
const NEXT_BODY: f32 = 1.5;
/// Height difference from a floor to the next one, metres.
const STAIR: f32 = 0.5;
/// Material that stops rolling bodies, because their path has no closed form.
const SURFACE: Material = Material { friction: 0.6, restitution: 0.0, rolling: 0.05, ..Material::DEFAULT };

fn build(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    let turn = Rotation::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), setup.number("tilt").to_radians());
    let lifted = Vec3::Y * setup.number("drop");
    let mut floors: Vec<Floor> = Vec::new();
    for (number, (figure, ground)) in grounds().into_iter().enumerate() {
        let [column, row] = [number % 2, number / 2].map(|place| (place as f32 - 0.5) * NEXT_FLOOR);
        let top = Vec3::new(column, STAIR * number as f32, -row);
        world.add_body(&BodyDef { position: top + ground.position, ..ground });
        let shown = exhibits().into_iter().enumerate().map(|(i, Exhibit { shape, lies, height })| {
            let [x, z] = [i % 3, i / 3].map(|place| (place as f32 - 1.0) * NEXT_BODY);
            let at = top + Vec3::new(x, height, z) + lifted;
            let def = BodyDef { rotation: turn * lies, ..made_of(body(shape, at), SURFACE) };
            (world.add_body(&def), top.y + height)
        });
        floors.push(Floor { figure, shown: shown.collect() });
    }
    let (ball, _) = floors[0].shown[BALL];
    let flight = Flight::new(&world, vec![ball]);
    Instance::new(world, Showroom { floors, flight, asleep: None })
}

/// Names of metrics, and for each a floor whose surface is at the height of the origin.
fn grounds() -> [(&'static str, BodyDef); 4] {
    let flat = Waves { cells: (2.0 * HALF_SIDE) as usize, height: 0.0, frequencies: [0.0; 2] };
    let half_extents = Vec3::new(HALF_SIDE, 0.25, HALF_SIDE);
    let plate = cuboid(half_extents, Vec3::NEG_Y * half_extents.y);
    [
        ("half_space_error_m", floor()),
        ("box_error_m", fixed(plate)),
        ("mesh_error_m", flat.mesh()),
        ("height_field_error_m", flat.field()),
    ]
}

/// A shape, its rest orientation, and the rest height of its centre of mass, metres.
struct Exhibit {
    shape: Shape,
    lies: Rotation,
    height: f32,
}

/// Index of the ball among the exhibits, which cannot tilt.
const BALL: usize = 1;

fn exhibits() -> [Exhibit; 7] {
    let upright = |shape, height| Exhibit { shape, lies: Rotation::IDENTITY, height };
    let lying = |shape, height| Exhibit { shape, lies: tilt(90.0), height };
    let (radius, half_height) = (0.25, 0.3);
    let half_extents = Vec3::new(0.35, 0.2, 0.3);
    let radius_top = 0.15;
    let tapered = Shape::TaperedCapsule { half_height, radius_bottom: radius, radius_top };
    // Share of the way from the lower ball to the upper one.
    let share = 0.5 + 0.5 * tapered.mass_properties(1.0).center.y / half_height;
    let reach = 0.4;
    let corners: Vec<Vec3> = Vec3::AXES.into_iter().flat_map(|axis| [axis * reach, axis * -reach]).collect();
    let octahedron = Hull::new(&corners).expect("the octahedron's corners span a solid");
    [
        upright(Shape::Box { half_extents }, half_extents.y),
        upright(Shape::Sphere { radius }, radius),
        lying(Shape::Capsule { half_height, radius }, radius),
        lying(tapered, radius + (radius_top - radius) * share),
        upright(Shape::Cylinder { half_height, radius }, half_height),
        // The centre of a cone is at a quarter of its height.
        upright(Shape::Cone { half_height, radius }, 0.5 * half_height),
        upright(Shape::Hull(Arc::new(octahedron)), reach / 3.0_f32.sqrt()),
    ]
}

/// Exhibits on one floor.
struct Floor {
    /// Name of the floor's metric.
    figure: &'static str,
    /// Bodies with the expected heights of their centres of mass.
    shown: Vec<(BodyId, f32)>,
}

struct Showroom {
    floors: Vec<Floor>,
    flight: Flight,
    /// Time at which the floor's bodies fell asleep, seconds.
    asleep: Option<f32>,
}

impl Script for Showroom {
    fn after_step(&mut self, world: &mut World) {
        self.flight.after_step(world);
        let mut shown = self.floors.iter().flat_map(|floor| &floor.shown);
        if self.asleep.is_none() && shown.all(|&(id, _)| !world.is_awake(id)) {
            self.asleep = Some(world.time() as f32);
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let mut metrics = vec![self.flight.metric()];
        metrics.extend(self.floors.iter().map(|Floor { figure, shown }| {
            let error = |&(id, height): &(BodyId, f32)| (world.center_of_mass(id).y - height).abs();
            let worst = shown.iter().map(error).fold(0.0, max);
            Metric::new(figure, worst, Expected::AtMost(0.001))
        }));
        metrics.push(Metric::awaited("asleep_s", self.asleep, Expected::AtMost(4.0)));
        metrics
    }
}
