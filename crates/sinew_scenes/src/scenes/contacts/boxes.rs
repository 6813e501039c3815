//! Boxes: the empty space in their axis-aligned bounds, and the depth of a point in a rotated box.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{ball, cuboid, fallen, fixed, ghost, tilt};
use sinew::math::{Rotation, Vec3, max, trig};
use sinew::physics::boxes::{Cuboid, Penetration, SurfacePoint};
use sinew::physics::{BodyDef, BodyId, DebugDraw, DrawKind, Obb, Shape, World};

pub(in crate::scenes) const AABB_VS_OBB: Scene = Scene {
    chapter: Chapter::Contacts,
    name: "aabb_vs_obb",
    about: "a box rotates: its axis-aligned bounds change their size, its oriented box does not",
    steps: 360,
    settings: &[Setting::number("slenderness", 4.0, (1.0, 100.0), "length of the box over its width")],
    build: aabb_vs_obb,
};

/// Half extent of the box across, metres.
const HALF_WIDTH: f32 = 0.25;
/// Angular velocity of one turn in 360 steps, rad/s.
const TURNING: f32 = core::f32::consts::TAU / 6.0;

fn aabb_vs_obb(setup: &Setup<'_>) -> Instance {
    let mut world = setup.sleepless_world();
    let slenderness = setup.number("slenderness");
    let def = cuboid(Vec3::new(slenderness * HALF_WIDTH, HALF_WIDTH, HALF_WIDTH), Vec3::ZERO);
    let angular_velocity = Vec3::Z * TURNING;
    let body = world.add_body(&BodyDef { gravity_scale: 0.0, angular_velocity, ..def });
    let volume = volumes(&world, body)[1];
    Instance::new(
        world,
        Turning { body, slenderness, volume, ratio_sum: 0.0, ratio_max: 0.0, off: 0.0, drift: 0.0 },
    )
}

/// Volumes of a body's bounds, and of the oriented box that is its shape, m³.
fn volumes(world: &World, body: BodyId) -> [f32; 2] {
    let oriented = world.shapes(body).map(|(shape, frame)| match shape {
        Shape::Box { half_extents } => Obb::from_transform(&frame, half_extents).volume(),
        _ => shape.volume(),
    });
    [world.bounds(body).volume(), oriented.sum()]
}

struct Turning {
    body: BodyId,
    slenderness: f32,
    /// Volume of the oriented box at the start, m³.
    volume: f32,
    /// Sum of the ratio of the bounds' volume to the oriented box's, over all steps.
    ratio_sum: f64,
    ratio_max: f32,
    /// Largest relative error of a ratio against its closed form.
    off: f32,
    /// Largest relative change of the oriented box's volume.
    drift: f32,
}

impl Turning {
    /// Returns the ratio of the volumes: half extents `a`, `b` rotated by `θ` reach `a |cos θ| + b |sin θ|` and `a |sin
    /// θ| + b |cos θ|`; their product over `a b` is `1 + (a/b + b/a) |sin θ cos θ|`.
    fn closed_form(&self, angle: f32) -> f32 {
        let (sin, cos) = trig::sin_cos(angle);
        1.0 + (self.slenderness + 1.0 / self.slenderness) * (sin * cos).abs()
    }
}

impl Script for Turning {
    /// Draws the bounds.
    fn draw(&self, world: &World, out: &mut dyn DebugDraw) {
        let bounds = world.bounds(self.body);
        let corner = |bits: usize| {
            let pick = |bit: usize, lo: f32, hi: f32| if bits >> bit & 1 == 1 { hi } else { lo };
            let (lo, hi) = (bounds.min, bounds.max);
            Vec3::new(pick(0, lo.x, hi.x), pick(1, lo.y, hi.y), pick(2, lo.z, hi.z))
        };
        for bits in 0..8 {
            for edge in [1, 2, 4].into_iter().filter(|edge| bits & edge == 0) {
                out.line(corner(bits), corner(bits | edge), DrawKind::Object);
            }
        }
    }

    fn after_step(&mut self, world: &mut World) {
        let [bounds, oriented] = volumes(world, self.body);
        let ratio = bounds / oriented;
        let expected = self.closed_form(TURNING * world.time() as f32);
        self.ratio_sum += f64::from(ratio);
        self.ratio_max = max(self.ratio_max, ratio);
        self.off = max(self.off, (ratio / expected - 1.0).abs());
        self.drift = max(self.drift, (oriented / self.volume - 1.0).abs());
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let steps = world.step_count() as f64;
        // |sin θ cos θ| is 1/2 at its largest and 1/π on average.
        let worst = self.closed_form(core::f32::consts::FRAC_PI_4);
        let mean = 1.0 + f64::from(worst - 1.0) * core::f64::consts::FRAC_2_PI;
        vec![
            Metric::new("bounds_over_box_max", self.ratio_max, Expected::near(worst, 1e-5)),
            Metric::new("bounds_over_box_mean", self.ratio_sum / steps, Expected::near(mean, 2e-4)),
            // The angle is rounded in every substep: a few 1e-5 rad in a turn.
            Metric::new("closed_form_error_max", self.off, Expected::AtMost(3e-5)),
            Metric::new("box_volume_change_max", self.drift, Expected::AtMost(1e-6)),
        ]
    }
}

pub(in crate::scenes) const POINT_IN_OBB: Scene = Scene {
    chapter: Chapter::Contacts,
    name: "point_in_obb",
    about: "probes fall through a tilted box; queries give their depth and the direction out of it",
    steps: 48,
    settings: &[Setting::number("tilt", 25.0, (0.0, 40.0), "rotation of the box about z, degrees")],
    build: point_in_obb,
};

/// Half extents of the box, metres.
const HALF_EXTENTS: Vec3 = Vec3::new(1.5, 0.25, 0.5);
/// Height of the probes at the start, metres.
const START_HEIGHT: f32 = 1.5;
/// Positions along x of the probes' vertical lines, metres.
const LINES: [f32; 5] = [-0.4, -0.2, 0.0, 0.2, 0.4];

fn point_in_obb(setup: &Setup<'_>) -> Instance {
    let mut world = setup.sleepless_world();
    let rotation = tilt(setup.number("tilt"));
    let def = ghost(fixed(cuboid(HALF_EXTENTS, Vec3::ZERO)));
    let obb = world.add_body(&BodyDef { rotation, ..def });
    let probe = |x: f32| ghost(ball(0.02, Vec3::new(x, START_HEIGHT, 0.0)));
    let probes =
        LINES.map(|x| Probe { id: world.add_body(&probe(x)), x, last: None, entered: None, left: None });
    Instance::new(world, Probes { obb, rotation, probes, depth_off: 0.0, turned: 0.0, wrong_sides: 0 })
}

struct Probe {
    id: BodyId,
    x: f32,
    /// Signed distance to the box in the last step, metres.
    last: Option<f32>,
    /// Times at which the probe entered and left, seconds.
    entered: Option<f64>,
    left: Option<f64>,
}

impl Probe {
    /// Records when the surface was crossed within the last step, in which the distance changed almost linearly.
    fn pass(&mut self, distance: f32, world: &World) {
        if let Some(last) = self.last.filter(|last| (*last > 0.0) != (distance > 0.0)) {
            let left_over = f64::from(distance / (distance - last));
            let time = world.time() - left_over * f64::from(world.def().dt());
            *(if last > 0.0 { &mut self.entered } else { &mut self.left }) = Some(time);
        }
        self.last = Some(distance);
    }
}

struct Probes {
    obb: BodyId,
    rotation: Rotation,
    probes: [Probe; LINES.len()],
    /// Largest deviation of a depth from its closed form, metres.
    depth_off: f32,
    /// Largest deviation of a direction from the normal of the nearer face, radians.
    turned: f32,
    /// Number of times that the world's inside test and the sign of the distance disagreed.
    wrong_sides: u32,
}

impl Probes {
    /// Height of a probe over the centre plane of the box, by the formula of free fall, metres.
    fn height(&self, x: f32, fallen: f64) -> f32 {
        (self.rotation * Vec3::Y).dot(Vec3::new(x, (f64::from(START_HEIGHT) - fallen) as f32, 0.0))
    }

    /// Time at which a probe is at a height over the centre plane, seconds: `y = y₀ − g t (t + h) / 2` on the line `x`,
    /// solved for `t` (see [`fallen`]).
    fn time_at(&self, x: f32, over: f32, world: &World) -> f64 {
        let normal = self.rotation * Vec3::Y;
        let y = f64::from((over - normal.x * x) / normal.y);
        let h = f64::from(world.def().dt()) / f64::from(world.def().substeps);
        let drop = 2.0 * (f64::from(START_HEIGHT) - y) / f64::from(crate::parts::GRAVITY);
        (0.25 * h * h + drop).sqrt() - 0.5 * h
    }
}

impl Script for Probes {
    fn after_step(&mut self, world: &mut World) {
        let normal = self.rotation * Vec3::Y;
        for k in 0..self.probes.len() {
            let Probe { id, x, .. } = self.probes[k];
            let at = world.transform(id).translation;
            let Some(SurfacePoint { distance, .. }) = world.nearest_surface(self.obb, at) else { continue };
            self.probes[k].pass(distance, world);
            self.wrong_sides += u32::from(world.contains_point(self.obb, at) != (distance <= 0.0));
            let height = self.height(x, fallen(world));
            if let Some(Penetration { depth, direction }) = world.point_penetration(self.obb, at) {
                self.depth_off = max(self.depth_off, (depth - (HALF_EXTENTS.y - height.abs())).abs());
                let out = if height < 0.0 { -normal } else { normal };
                self.turned = max(self.turned, trig::asin(out.cross(direction).length()));
            }
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let first = &self.probes[0];
        let expected = |over: f32| Expected::near(self.time_at(first.x, over, world), 5e-4);
        let inside = |p: &Probe| Some((p.left? - p.entered?) as f32);
        let [top, bottom] = [HALF_EXTENTS.y, -HALF_EXTENTS.y];
        let of_first = self.time_at(first.x, bottom, world) - self.time_at(first.x, top, world);
        vec![
            Metric::awaited("entered_s", first.entered.map(|t| t as f32), expected(top)),
            Metric::awaited("left_s", first.left.map(|t| t as f32), expected(bottom)),
            Metric::awaited("inside_s", inside(first), Expected::near(of_first, 5e-3)),
            Metric::new("depth_error_max_m", self.depth_off, Expected::AtMost(1e-5)),
            Metric::new("direction_error_max_deg", self.turned.to_degrees(), Expected::AtMost(1e-3)),
            Metric::new("wrong_sides", self.wrong_sides, Expected::AtMost(0.0)),
        ]
    }
}
