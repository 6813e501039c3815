//! Rotations as matrices, as quaternions and as quotients of vectors, beside rotating bodies.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::weightless_world;
use crate::framework::setting::{Setting, Setup};
use crate::parts::{ball, cuboid, fixed, ghost};
use core::f32::consts::TAU;
use sinew::math::{
    Mat3, MatrixDrift, Orthonormalization, Quaternion, Rotation, Sym3, Transform, Vec3, max, orthonormalize,
    skew, trig,
};
use sinew::physics::{BodyDef, BodyId, BodyKind, MassProperties, Shape, ShapeDef, Velocity, World};

pub(in crate::scenes) const MATRIX_DRIFT: Scene = Scene {
    chapter: Chapter::FreeMotion,
    name: "matrix_drift",
    about: "a matrix that is rotated step by step grows; corrected after each step it stays a rotation",
    steps: 600,
    settings: &[Setting::number("spin", 2.0, (0.1, 5.0), "angular velocity of the body, rad/s")],
    build: matrix_drift,
};

/// Unit axis of a rotation in a general direction.
fn oblique() -> Vec3 {
    Vec3::new(1.0, 2.0, 2.0) / 3.0
}

fn kinematic(def: BodyDef) -> BodyDef {
    BodyDef { kind: BodyKind::Kinematic, ..ghost(def) }
}

fn matrix_drift(setup: &Setup<'_>) -> Instance {
    let mut world = weightless_world();
    let spin = oblique() * setup.number("spin");
    let cube = |x: f32| ghost(cuboid(Vec3::splat(0.3), Vec3::X * x));
    let body = world.add_body(&BodyDef { angular_velocity: spin, ..cube(-2.5) });
    let [polar, gram_schmidt] = [2.5, 5.0].map(|x| world.add_body(&kinematic(cube(x))));
    let tips = Vec3::AXES.map(|axis| {
        let tip = kinematic(ball(0.08, axis));
        world.add_body(&BodyDef { linear_velocity: spin.cross(axis), ..tip })
    });
    Instance::new(world, Drift { body, polar, gram_schmidt, tips, spin })
}

/// Bodies that show the matrices: the uncorrected one as three points, the orthonormalised ones as poses.
struct Drift {
    /// A body that the world rotates.
    body: BodyId,
    polar: BodyId,
    gram_schmidt: BodyId,
    /// Points at the ends of the uncorrected matrix's columns, about the origin: each moves along its tangent for a
    /// step, which is `R + dt ω × R`.
    tips: [BodyId; 3],
    /// Angular velocity, rad/s.
    spin: Vec3,
}

impl Drift {
    fn bare(&self, world: &World) -> Mat3 {
        let [x, y, z] = self.tips.map(|tip| world.center_of_mass(tip));
        Mat3::from_cols(x, y, z)
    }

    fn rotation(world: &World, id: BodyId) -> Rotation {
        world.transform(id).rotation
    }
}

impl Script for Drift {
    fn after_step(&mut self, world: &mut World) {
        let spin = world.velocity(self.body).angular;
        for tip in self.tips {
            let linear = spin.cross(world.center_of_mass(tip));
            world.set_velocity(tip, Velocity { linear, angular: Vec3::ZERO });
        }
        let turn = Mat3::IDENTITY + skew(spin) * world.def().dt();
        let methods = [Orthonormalization::Polar, Orthonormalization::GramSchmidt];
        for (id, method) in [self.polar, self.gram_schmidt].into_iter().zip(methods) {
            let Transform { translation, rotation } = world.transform(id);
            let mended = orthonormalize(&(turn * rotation.to_mat3()), method);
            world.set_transform(id, Transform::new(translation, mended.rotation));
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let steps = world.step_count();
        // A tangent of length θ ends at a radius of √(1 + θ²), at the angle atan θ instead of θ.
        let step = self.spin.length() * world.def().dt();
        let growth = (0..steps).fold(1.0, |growth, _| growth * (1.0 + f64::from(step * step)));
        let lag = steps as f32 * (step - trig::atan2(step, 1.0));
        // The rounding error of each step's correction is added.
        let lag = Expected::Near { value: lag.into(), tolerance: 0.005 * f64::from(lag) + 5e-5 };
        let bare = MatrixDrift::of(&self.bare(world));
        let body = Self::rotation(world, self.body);
        let [polar, gram_schmidt] = [self.polar, self.gram_schmidt].map(|id| Self::rotation(world, id));
        let exact = Rotation::from_scaled_axis(self.spin * world.time() as f32);
        let deviation = |r: Rotation| MatrixDrift::of(&r.to_mat3()).deviation;
        let square = 2f64.sqrt();
        vec![
            Metric::new("bare_determinant", bare.determinant, Expected::near(growth, 1e-3)),
            Metric::new("bare_deviation", bare.deviation, Expected::near(square * (growth - 1.0), 2e-3)),
            Metric::new("polar_deviation", deviation(polar), Expected::AtMost(2e-6)),
            Metric::new("polar_lag_rad", polar.angle_to(body), lag),
            Metric::new("gram_schmidt_deviation", deviation(gram_schmidt), Expected::AtMost(2e-6)),
            Metric::new("gram_schmidt_lag_rad", gram_schmidt.angle_to(body), Expected::Anything),
            Metric::new("body_deviation", deviation(body), Expected::AtMost(2e-6)),
            Metric::new("body_length_error", (body.length() - 1.0).abs(), Expected::AtMost(3e-7)),
            Metric::new("body_angle_error_rad", body.angle_to(exact), Expected::AtMost(1e-4)),
        ]
    }
}

pub(in crate::scenes) const VERSOR: Scene = Scene {
    chapter: Chapter::FreeMotion,
    name: "versor",
    about: "the quotient of two vectors rotates and scales one into the other; a body follows it",
    steps: 480,
    settings: &[],
    build: versor,
};

/// Number of steps from the first vector to the second.
const JOURNEY: u64 = 240;

fn versor(_: &Setup<'_>) -> Instance {
    let mut world = weightless_world();
    let [from, to] = [Vec3::new(0.8, 0.3, 0.4), Vec3::new(-0.5, 1.2, 0.6)];
    let [from, to] = [from, to].map(|at| world.add_body(&fixed(ghost(ball(0.06, at)))));
    let start = world.center_of_mass(from);
    let walker = world.add_body(&ghost(cuboid(Vec3::splat(0.05), start)));
    let journey = Journey { from, to, walker, half_way: None, arrived: None };
    journey.go_on(&mut world);
    Instance::new(world, journey)
}

/// A body that moves from one position to another, and beyond, by equal rotations and equal factors.
struct Journey {
    from: BodyId,
    to: BodyId,
    walker: BodyId,
    half_way: Option<Vec3>,
    arrived: Option<Transform>,
}

impl Journey {
    /// Quaternion that maps the first position to the second.
    fn quotient(&self, world: &World) -> Quaternion {
        let at = |id| world.center_of_mass(id);
        Quaternion::quotient(at(self.to), at(self.from)).expect("neither position is the origin")
    }

    /// Sets the velocity that turns the body by one step's fraction of the quotient.
    fn go_on(&self, world: &mut World) {
        let (q, dt) = (self.quotient(world), world.def().dt());
        let axis = q.axis().expect("the two positions are not collinear with the origin");
        let (share, place) = (1.0 / JOURNEY as f32, world.center_of_mass(self.walker));
        let linear = (q.power(share).apply(place) - place) / dt;
        let angular = axis * (q.angle() * share / dt);
        world.set_velocity(self.walker, Velocity { linear, angular });
    }
}

impl Script for Journey {
    fn after_step(&mut self, world: &mut World) {
        let pose = world.transform(self.walker);
        match world.step_count() {
            step if step == JOURNEY / 2 => self.half_way = Some(pose.translation),
            step if step == JOURNEY => self.arrived = Some(pose),
            _ => {}
        }
        self.go_on(world);
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let [from, to, now] = [self.from, self.to, self.walker].map(|id| world.center_of_mass(id));
        let q = self.quotient(world);
        let gap = |place: Option<Vec3>, expected: Vec3| place.map(|place| (place - expected).length());
        // The midpoint has the geometric mean of the lengths, on the line that bisects the angle.
        let middle = (from.normalize() + to.normalize()).normalize() * (from.length() * to.length()).sqrt();
        let turned = self.arrived.map(|pose| (pose.rotation * from.normalize() - to.normalize()).length());
        let scale = f64::from(to.length()) / f64::from(from.length());
        let angle = trig::acos(from.dot(to) / (from.length() * to.length()));
        vec![
            Metric::new("scale", q.norm(), Expected::near(scale, 1e-6)),
            Metric::new("angle_rad", q.angle(), Expected::near(angle, 1e-6)),
            Metric::awaited("half_way_gap_m", gap(self.half_way, middle), Expected::AtMost(1e-4)),
            Metric::awaited(
                "arrival_gap_m",
                gap(self.arrived.map(|pose| pose.translation), to),
                Expected::AtMost(1e-4),
            ),
            Metric::awaited("arrival_turn_error", turned, Expected::AtMost(1e-4)),
            Metric::new("as_far_again_gap_m", (now - q.apply(to)).length(), Expected::AtMost(5e-4)),
        ]
    }
}

pub(in crate::scenes) const HELPERS: Scene = Scene {
    chapter: Chapter::FreeMotion,
    name: "quaternion_helpers",
    about: "the same rotation by each of five operations: from axis and angle, from matrix, normalise, inverse, to matrix",
    steps: 60,
    settings: &[Setting::number("spin", 0.5, (0.0, 1.0), "angular velocity of the bodies, rad/s")],
    build: helpers,
};

/// A third of a turn about (1, 1, 1): x goes to y, y to z, z to x.
fn third() -> (Vec3, f32) {
    (Vec3::ONE.normalize(), TAU / 3.0)
}

fn helpers(setup: &Setup<'_>) -> Instance {
    let mut world = weightless_world();
    let ((axis, angle), spin) = (third(), setup.number("spin"));
    let turn = Rotation::from_axis_angle(axis, angle);
    let columns = turn.to_mat3();
    let turned = |x: f32, rotation: Rotation| BodyDef {
        rotation,
        angular_velocity: axis * spin,
        ..ghost(cuboid(Vec3::splat(0.3), Vec3::X * x))
    };
    let bodies = [
        turned(-3.0, turn),
        turned(-1.5, Rotation::from_mat3(&Mat3::from_cols(Vec3::Y, Vec3::Z, Vec3::X))),
        turned(0.0, Rotation::from_xyzw(7.0, 7.0, 7.0, 7.0).normalize()),
        BodyDef { angular_velocity: axis * -spin, ..turned(1.5, turn.inverse()) },
        BodyDef { angular_velocity: axis * spin, ..tripod(3.0, &columns) },
    ];
    let [from_axis_and_angle, from_matrix, normalised, inverse, to_matrix] =
        bodies.map(|body| world.add_body(&body));
    let script = Helpers { from_axis_and_angle, from_matrix, normalised, inverse, to_matrix, columns, spin };
    Instance::new(world, script)
}

/// Three balls at the ends of a matrix's columns, as one body that is not rotated.
fn tripod(x: f32, m: &Mat3) -> BodyDef {
    let ends = [m.x_axis, m.y_axis, m.z_axis].map(|end| {
        let body_from_shape = Transform::from_translation(end * 0.5);
        ShapeDef { body_from_shape, ..ShapeDef::new(Shape::Sphere { radius: 0.1 }) }
    });
    let core = ShapeDef::new(Shape::Sphere { radius: 0.2 });
    let shapes = ends.into_iter().chain([core]).collect();
    // Equal inertia about every axis, so that the body does not tumble.
    let inertia = Sym3::from_diagonal(Vec3::splat(0.1));
    let mass = Some(MassProperties { mass: 1.0, center: Vec3::ZERO, inertia });
    ghost(BodyDef { position: Vec3::X * x, shapes, mass, ..BodyDef::default() })
}

struct Helpers {
    from_axis_and_angle: BodyId,
    from_matrix: BodyId,
    normalised: BodyId,
    inverse: BodyId,
    to_matrix: BodyId,
    /// Matrix from which one of the bodies is made, in the body's own axes.
    columns: Mat3,
    /// Angular velocity, rad/s.
    spin: f32,
}

impl Script for Helpers {
    fn metrics(&self, world: &World) -> Vec<Metric> {
        let rotation = |id| world.transform(id).rotation;
        let turned = rotation(self.from_axis_and_angle);
        let (axis, angle) = turned.to_axis_angle();
        let (about, start) = third();
        let expected = start + self.spin * world.time() as f32;
        let apart = |id| rotation(id).angle_to(turned);
        let undone = (turned * rotation(self.inverse)).angle_to(Rotation::IDENTITY);
        let ends =
            Vec3::AXES.map(|end| (rotation(self.to_matrix) * (self.columns * end) - turned * end).length());
        let farthest = ends.into_iter().fold(0.0, max);
        vec![
            Metric::new("turned_rad", angle, Expected::near(expected, 1e-5)),
            Metric::new("axis_error", (axis - about).length(), Expected::AtMost(1e-5)),
            Metric::new("from_matrix_apart_rad", apart(self.from_matrix), Expected::AtMost(1e-5)),
            Metric::new("normalised_apart_rad", apart(self.normalised), Expected::AtMost(1e-5)),
            Metric::new("inverse_apart_rad", undone, Expected::AtMost(1e-5)),
            Metric::new("to_matrix_apart", farthest, Expected::AtMost(1e-5)),
        ]
    }
}
