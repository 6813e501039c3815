//! Balls rain on the cabin: on its boxes, or on its render mesh.

use crate::cabin::{Prop, Site};
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, body, fixed};
use sinew::math::{Vec3, clamp, max, trig};
use sinew::physics::cook::MeshBvh;
use sinew::physics::particles::{GroupDef, ParticleDef};
use sinew::physics::{BodyDef, GroupId, Mesh, Shape, World};
use std::sync::Arc;

pub(in crate::scenes) const CABIN: Scene = Scene {
    chapter: Chapter::Shows,
    name: "cabin",
    about: "balls rain on the cabin's boxes, or with mesh=1 on its render mesh, to compare gaps and speeds",
    steps: 300,
    settings: &[
        Setting::whole("mesh", 0, (0, 1), "1: the balls meet the render mesh instead of the boxes"),
        Setting::whole("balls", 150, (1, 5000), "how many"),
        Setting::whole("detail", 2, (1, 8), "bands of facets around each edge of the render mesh"),
    ],
    build: cabin,
};

/// Radius of a ball, metres.
const RADIUS: f32 = 0.08;
/// Initial height of the lowest ball, metres: above the ridge.
const HEIGHT: f32 = 8.0;
/// Least number of steps for which all balls fall freely.
const FALLING: u64 = 6;
/// Distance from a box at which a ball rests on the box or has just hit it, metres.
const TOUCHING: f32 = 1e-3;
/// Number of steps between two checks of contacts.
const LOOK_EVERY: u64 = 10;

fn cabin(setup: &Setup<'_>) -> Instance {
    let props = Site::CabinWithStairs.props();
    let triangles = render_mesh(&props, setup.whole("detail"));
    let mesh = MeshBvh::new(&triangles);
    let mut world = setup.world();
    let with_mesh = setup.whole("mesh") == 1;
    for prop in props.iter().filter(|prop| !with_mesh || !is_box(prop)) {
        world.add_body(&prop.body);
    }
    if with_mesh {
        world.add_body(&level(&triangles));
    }
    let balls = world.add_particles(&rain(setup.whole("balls")));
    Instance::new(world, Rain { balls, mesh, fall: None, contacts: Contacts::default() })
}

fn is_box(prop: &Prop) -> bool {
    matches!(prop.body.shapes[0].shape, Shape::Box { .. })
}

/// Returns a body with the triangles as its shape.
fn level(triangles: &[[Vec3; 3]]) -> BodyDef {
    let indices: Vec<[u32; 3]> = (0..triangles.len() as u32).map(|t| [0, 1, 2].map(|k| 3 * t + k)).collect();
    let mesh = Mesh::new(triangles.as_flattened(), &indices).expect("the render mesh has triangles");
    fixed(body(Shape::Mesh(Arc::new(mesh)), Vec3::ZERO))
}

/// Balls of 100 g in layers, in a pattern whose period matches no edge of the cabin.
fn rain(count: usize) -> GroupDef {
    const ACROSS: usize = 10;
    let ball = |i: usize| {
        let (row, column, layer) = (i / ACROSS % ACROSS, i % ACROSS, i / (ACROSS * ACROSS));
        // Golden-ratio shifts keep layers from falling onto the same points.
        let shift = 0.618_034 * layer as f32;
        let (x, z) = (row as f32 + shift % 1.0, column as f32 + 1.7 * shift % 1.0);
        let position = Vec3::new(0.62 * x - 3.0, HEIGHT + 0.5 * layer as f32, 0.95 * z - 7.0);
        ParticleDef { position, velocity: Vec3::ZERO, mass: 0.1, radius: RADIUS }
    };
    GroupDef { particles: (0..count).map(ball).collect(), ..GroupDef::default() }
}

/// Returns the triangles of an artist's model of the boxes: each edge rounded.
fn render_mesh(props: &[Prop], detail: usize) -> Vec<[Vec3; 3]> {
    let mut triangles = Vec::new();
    for prop in props {
        if let Shape::Box { half_extents } = prop.body.shapes[0].shape {
            let body = &prop.body;
            let place = |p: Vec3| body.rotation * p + body.position;
            rounded_box(half_extents, detail, |corners| triangles.push(corners.map(place)));
        }
    }
    triangles
}

/// Largest radius of an edge of the render mesh, metres.
const ROUNDING: f32 = 0.03;

/// The surface of a box with rounded edges, with `bands` of facets over each half of an edge.
fn rounded_box(half: Vec3, bands: usize, mut out: impl FnMut([Vec3; 3])) {
    let thin = sinew::math::min(half.x, sinew::math::min(half.y, half.z));
    let radius = sinew::math::min(ROUNDING, 0.4 * thin);
    let core = half - Vec3::splat(radius);
    // Points along a side of a face: over one edge, across the flat part, over the other edge.
    let along = |i: usize| match i <= bands {
        true => (-1.0, i as f32 / bands as f32 - 1.0),
        false => (1.0, (i - bands - 1) as f32 / bands as f32),
    };
    for face in 0..6 {
        let (axis, sign) = (face / 2, if face % 2 == 0 { -1.0 } else { 1.0 });
        let [u_axis, v_axis] = [(axis + 1) % 3, (axis + 2) % 3];
        let at = |i: usize, j: usize| {
            let ((u_side, u), (v_side, v)) = (along(i), along(j));
            let (mut corner, mut outward) = (Vec3::ZERO, Vec3::ZERO);
            (corner[axis], corner[u_axis], corner[v_axis]) = (sign, u_side, v_side);
            (outward[axis], outward[u_axis], outward[v_axis]) = (sign, u, v);
            corner * core + outward.normalize() * radius
        };
        for i in 0..2 * bands + 1 {
            for j in 0..2 * bands + 1 {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                let halves = if sign > 0.0 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] };
                halves.into_iter().for_each(&mut out);
            }
        }
    }
}

/// Comparison of the mesh with the boxes at the balls that touch the boxes.
#[derive(Default)]
struct Contacts {
    count: u32,
    /// Sum and largest of the gaps between the mesh and the balls, metres.
    gap_sum: f32,
    gap_max: f32,
    /// Sum of the angles between the normals of box and mesh, radians.
    angle_sum: f32,
}

struct Rain {
    balls: GroupId,
    mesh: MeshBvh,
    /// Mean acceleration of the free fall, m/s².
    fall: Option<f32>,
    contacts: Contacts,
}

impl Rain {
    /// Returns the distance of a ball from the closest box, and the direction out of that box.
    fn closest_box(world: &World, p: Vec3) -> Option<(f32, Vec3)> {
        let shapes = world.body_ids().flat_map(|id| world.shapes(id));
        let boxes = shapes.filter(|(shape, _)| matches!(shape, Shape::Box { .. }));
        let distances = boxes.map(|(shape, frame)| shape.signed_distance(&frame, p));
        distances.reduce(|a, b| if b.0 < a.0 { b } else { a })
    }

    fn look(&mut self, world: &World) {
        for &p in world.particles(self.balls).positions() {
            let Some((distance, normal)) = Self::closest_box(world, p) else { return };
            if (distance - RADIUS).abs() < TOUCHING {
                let closest = self.mesh.closest_point(p);
                let away = (p - closest.point) / closest.distance;
                let gap = (closest.distance - RADIUS).abs();
                self.contacts.count += 1;
                self.contacts.gap_sum += gap;
                self.contacts.gap_max = max(self.contacts.gap_max, gap);
                self.contacts.angle_sum += trig::acos(clamp(away.dot(normal), -1.0, 1.0));
            }
        }
    }
}

impl Script for Rain {
    fn after_step(&mut self, world: &mut World) {
        if world.step_count() == FALLING {
            self.fall = Some(-world.particles(self.balls).velocities()[0].y / world.time() as f32);
        }
        if world.step_count().is_multiple_of(LOOK_EVERY) {
            self.look(world);
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let Contacts { count, gap_sum, gap_max, angle_sum } = self.contacts;
        let mean = |sum: f32| (count > 0).then(|| sum / count as f32);
        let through = world.particles(self.balls).positions().iter().filter(|p| p.y < 0.0).count();
        // The sharp corner extends beyond the rounded one by (√3 − 1) radii of the rounding.
        let corner = (3.0_f32.sqrt() - 1.0) * ROUNDING + TOUCHING;
        vec![
            Metric::awaited("fall_m_s2", self.fall, Expected::near(GRAVITY, 1e-3)),
            Metric::new("contacts", count, Expected::Anything),
            Metric::awaited("contact_error_mean_m", mean(gap_sum), Expected::Anything),
            Metric::new("contact_error_max_m", gap_max, Expected::AtMost(f64::from(corner))),
            Metric::awaited(
                "normal_error_mean_deg",
                mean(angle_sum).map(f32::to_degrees),
                Expected::Anything,
            ),
            Metric::new("fallen_through", through as f32, Expected::AtMost(0.0)),
            Metric::new("mesh_triangles", self.mesh.len() as f32, Expected::Anything),
        ]
    }
}
