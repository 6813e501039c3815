//! Folded cloth under a box, whose layers must not pass through each other.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, cuboid, fallen, floor};
use sinew::math::{ReadError, Reader, Vec3, Writer, max, min};
use sinew::physics::particles::{Cloth, ClothDef, ParticleGroup};
use sinew::physics::{BodyId, GroupId, Material, World};

pub(in crate::scenes) const FOLDED: Scene = Scene {
    chapter: Chapter::Particles,
    name: "folded",
    about: "a cloth folded five times falls on the ground and a box on it: its six layers do not pass through each other",
    steps: 360,
    settings: &[
        Setting::number("load", 0.2, (0.01, 10.0), "mass of the box, kg"),
        Setting::number(
            "thickness",
            0.028,
            (0.0, 0.036),
            "distance between the layers, metres; 0: they do not collide",
        ),
    ],
    build: folded,
};

/// Distance from one particle to the next, metres.
const GRID: f32 = 0.02;
const COLUMNS: u32 = 10;
/// Number of springs along a layer, and up to the next layer.
const LAYER: u32 = 12;
const FOLD: u32 = 2;
const FOLDS: u32 = 5;
const ROWS: u32 = (LAYER + FOLD) * FOLDS + LAYER;
/// Area density of the cloth, kg/m².
const DENSITY: f32 = 0.5;
/// Rise of each spring along a layer as a share of its length: layers lean until they lie flat.
const LEAN: f32 = 0.1;
/// Initial height of the lowest particle, metres.
const HEIGHT: f32 = 0.1;
/// Half extents of the box, metres.
const BOX: Vec3 = Vec3::new(0.08, 0.03, 0.08);
/// Middle of the cloth, and the initial height of the box, metres.
const ABOVE: Vec3 = Vec3::new(0.1, 0.5, 0.12);
/// Step after which the box is at rest and its pressure is measured.
const LIES: u64 = 240;
/// Number of steps in which the box falls freely.
const FALLS: u64 = 12;

fn cloth(thickness: f32) -> Cloth {
    let mut cloth = ClothDef {
        corner: Vec3::ZERO,
        across: Vec3::X * (COLUMNS as f32 * GRID),
        down: Vec3::Z * (ROWS as f32 * GRID),
        columns: COLUMNS,
        rows: ROWS,
        mass: DENSITY * (COLUMNS * ROWS) as f32 * GRID * GRID,
        stretching: 500.0,
        shearing: 50.0,
        bending: 1e-6,
        damping_ratio: 0.2,
        radius: 0.5 * GRID,
    }
    .build();
    let level = GRID * (1.0 - LEAN * LEAN).sqrt();
    let mut at = Vec3::Y * HEIGHT;
    for row in 0..=ROWS {
        for i in cloth.row(row) {
            let position = &mut cloth.group.particles[i as usize].position;
            *position = Vec3::new(position.x, at.y, at.z);
        }
        let (layer, within) = (row / (LAYER + FOLD), row % (LAYER + FOLD));
        let forth = if layer % 2 == 0 { level } else { -level };
        at += if within < LAYER { Vec3::new(0.0, LEAN * GRID, forth) } else { Vec3::Y * GRID };
    }
    cloth.group.thickness = thickness;
    cloth.group.iterations = 4;
    cloth.group.linear_damping = 0.5;
    cloth.group.material = Material { friction: 0.5, ..Material::default() };
    cloth
}

fn folded(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    let thickness = setup.number("thickness");
    let cloth = world.add_particles(&cloth(thickness).group);
    let mass = setup.number("load");
    let mut def = cuboid(BOX, ABOVE);
    def.shapes[0].density = mass / (8.0 * BOX.x * BOX.y * BOX.z);
    let load = world.add_body(&def);
    let watch = Watch { least: f32::INFINITY, ..Watch::default() };
    Instance::new(world, Folded { cloth, load, thickness, weight: mass * GRAVITY, watch })
}

#[derive(Default)]
struct Watch {
    /// Number of springs that pierced the cloth, summed over all checked steps.
    crossings: u32,
    /// Least distance of particles of different layers, metres.
    least: f32,
    /// Sum over steps of the force on the box, N, and the number of steps.
    pressed: f32,
    steps: u32,
    /// Distance of the box's free fall before it reaches the cloth, relative to the expected distance.
    fall: Option<f32>,
}

struct Folded {
    cloth: GroupId,
    load: BodyId,
    /// Distance between layers, metres.
    thickness: f32,
    /// Weight of the box, N.
    weight: f32,
    watch: Watch,
}

/// Returns the particles of each triangle, two triangles a cell.
fn triangles() -> impl Iterator<Item = [usize; 3]> {
    let wide = COLUMNS as usize + 1;
    let cells = (0..ROWS as usize).flat_map(move |row| (0..COLUMNS as usize).map(move |c| row * wide + c));
    cells.flat_map(move |a| [[a, a + 1, a + wide], [a + 1, a + wide + 1, a + wide]])
}

/// Number of pairs of a spring and a triangle that the spring pierces, except where it is an edge of the triangle.
fn crossings(positions: &[Vec3]) -> u32 {
    let wide = COLUMNS as usize + 1;
    let along = (0..positions.len() - wide).map(|i| [i, i + wide]);
    let across = (0..positions.len()).filter(|i| i % wide + 1 < wide).map(|i| [i, i + 1]);
    let threads: Vec<[usize; 2]> = along.chain(across).collect();
    let mut count = 0;
    for triangle in triangles() {
        let corners = triangle.map(|i| positions[i]);
        for ends in &threads {
            let apart = !ends.iter().any(|end| triangle.contains(end));
            count += u32::from(apart && pierces(ends.map(|i| positions[i]), corners));
        }
    }
    count
}

/// True if a line from one point to another goes through a triangle of the cloth.
fn pierces([p, q]: [Vec3; 2], [a, b, c]: [Vec3; 3]) -> bool {
    let far = 4.0 * GRID;
    if (p - a).length_squared() > far * far {
        return false;
    }
    let volume = |a: Vec3, b: Vec3, c: Vec3, d: Vec3| (b - a).cross(c - a).dot(d - a);
    if volume(a, b, c, p) * volume(a, b, c, q) >= 0.0 {
        return false;
    }
    let sides = [volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)];
    sides.iter().all(|&side| side > 0.0) || sides.iter().all(|&side| side < 0.0)
}

/// Smallest distance of two particles that are more than one spring apart in the cloth, metres.
fn least_apart(positions: &[Vec3]) -> f32 {
    let wide = COLUMNS as usize + 1;
    let mut least = f32::INFINITY;
    for (i, &p) in positions.iter().enumerate() {
        for (j, &q) in positions[..i].iter().enumerate() {
            if i / wide - j / wide > 1 || (i % wide).abs_diff(j % wide) > 1 {
                least = min(least, (p - q).length_squared());
            }
        }
    }
    least.sqrt()
}

/// Force of the cloth on the box, N, upward.
fn force(world: &World, group: &ParticleGroup) -> f32 {
    let substep = world.def().dt() / world.def().substeps as f32;
    group.body_impulses().iter().map(|hit| hit.impulse.y).sum::<f32>() / substep
}

impl Script for Folded {
    fn after_step(&mut self, world: &mut World) {
        let group = world.particles(self.cloth);
        let step = world.step_count();
        if step.is_multiple_of(10) {
            self.watch.crossings += crossings(group.positions());
            self.watch.least = min(self.watch.least, least_apart(group.positions()));
        }
        if step == FALLS {
            let way = ABOVE.y - world.center_of_mass(self.load).y;
            self.watch.fall = Some(way / fallen(world) as f32);
        }
        if step > LIES && group.is_awake() {
            self.watch.pressed += force(world, group);
            self.watch.steps += 1;
        }
    }

    fn save(&self, out: &mut Writer) {
        out.u32(self.watch.crossings);
        out.f32(self.watch.least);
        out.f32(self.watch.pressed);
        out.u32(self.watch.steps);
        out.f32(self.watch.fall.unwrap_or(0.0));
    }

    fn load(&mut self, bytes: &mut Reader<'_>) -> Result<(), ReadError> {
        let (crossings, least) = (bytes.u32()?, bytes.f32()?);
        let (pressed, steps) = (bytes.f32()?, bytes.u32()?);
        let fall = Some(bytes.f32()?).filter(|fall| *fall > 0.0);
        self.watch = Watch { crossings, least, pressed, steps, fall };
        Ok(())
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let pressed = self.watch.pressed / self.watch.steps as f32;
        let height = world.center_of_mass(self.load).y - BOX.y - 0.5 * GRID;
        vec![
            Metric::new("crossings", self.watch.crossings as f32, Expected::AtMost(0.0)),
            Metric::new(
                "deepest_m",
                max(self.thickness - self.watch.least, 0.0),
                Expected::AtMost(f64::from(0.5 * GRID)),
            ),
            Metric::new(
                "layers_under_box",
                height / self.thickness,
                Expected::Near { value: 5.0, tolerance: 0.75 },
            ),
            Metric::awaited("fall_over_closed_form", self.watch.fall, Expected::near(1.0, 0.005)),
            Metric::new("borne_n", pressed, Expected::near(self.weight, 0.25)),
        ]
    }
}
