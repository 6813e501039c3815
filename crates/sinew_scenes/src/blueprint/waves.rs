//! Heaps on wavy ground, modelled on Box3D's wave pile and mesh drop, which verify repeatability by the step at which
//! all bodies sleep.

use super::{Blueprint, in_box, rotation};
use crate::parts::{ball, body, cuboid, fixed, made_of};
use core::f32::consts::TAU;
use sinew::math::{Random, Vec3, trig};
use sinew::physics::{BodyDef, Filter, HeightField, HeightFieldDef, Hull, Material, Mesh, Shape, Sleeping};
use std::sync::Arc;

/// 100 balls, capsules and boxes fall onto waves, five by five in four layers.
pub fn wave_pile() -> Blueprint {
    const SIDE: usize = 5;
    const LAYERS: usize = 4;
    const SPACING: f32 = 1.7;
    let mut scene = Blueprint::new("wave_pile", Sleeping::On, 600);
    scene.body(Waves { cells: 20, height: 0.6, frequencies: [0.06, 0.08] }.field());
    let mut random = Random::new(5);
    for i in 0..SIDE * SIDE * LAYERS {
        let (layer, row, column) = (i / (SIDE * SIDE), i / SIDE % SIDE, i % SIDE);
        let place = |index: usize| (index as f32 - 0.5 * (SIDE - 1) as f32) * SPACING;
        let jitter = in_box(&mut random, -0.3, 0.3) * Vec3::new(1.0, 0.3, 1.0);
        let at = Vec3::new(place(row), 2.5 + 1.6 * layer as f32, place(column)) + jitter;
        let (def, radius) = match i % 3 {
            0 => (ball(0.5, at), 0.5),
            1 => (body(Shape::Capsule { half_height: 0.3, radius: 0.35 }, at), 0.35),
            _ => (cuboid(Vec3::new(0.45, 0.3, 0.55), at), 0.25 * 0.3),
        };
        scene.body(BodyDef { rotation: rotation(&mut random), ..made_of(def, rolling(radius)) });
    }
    scene
}

/// 400 sticks of 4 × 40 × 8 cm, which collide with the ground only, fall spinning onto waves from 5 m.
pub fn mesh_drop() -> Blueprint {
    const SIDE: usize = 20;
    const GROUND: u32 = 1;
    const STICKS: u32 = 2;
    let mut scene = Blueprint::new("mesh_drop", Sleeping::On, 600);
    let mut ground = Waves { cells: 40, height: 0.5, frequencies: [0.2, 0.1] }.mesh();
    ground.shapes[0].filter.layers = GROUND;
    scene.body(ground);
    let mut random = Random::new(9);
    for i in 0..SIDE * SIDE {
        let place = |index: usize| 0.5 * (index as f32 - 0.5 * SIDE as f32);
        let at = Vec3::new(place(i / SIDE), 5.0, place(i % SIDE));
        let mut stick = made_of(cuboid(Vec3::new(0.02, 0.2, 0.04), at), rolling(0.25 * 0.02));
        stick.shapes[0].filter = Filter { layers: STICKS, mask: GROUND, ..Filter::default() };
        stick.linear_velocity = in_box(&mut random, -1.0, 1.0);
        stick.angular_velocity = in_box(&mut random, -5.0, 5.0);
        scene.body(stick);
    }
    scene
}

/// 64 rocks, no two alike, pour onto waves, four by four in four layers.
pub fn rocks() -> Blueprint {
    const SIDE: usize = 4;
    const LAYERS: usize = 4;
    const SPACING: f32 = 1.2;
    let mut scene = Blueprint::new("rocks", Sleeping::On, 600);
    scene.body(Waves { cells: 20, height: 0.6, frequencies: [0.06, 0.08] }.field());
    let mut random = Random::new(11);
    for i in 0..SIDE * SIDE * LAYERS {
        let (layer, row, column) = (i / (SIDE * SIDE), i / SIDE % SIDE, i % SIDE);
        let place = |index: usize| (index as f32 - 0.5 * (SIDE - 1) as f32) * SPACING;
        let at = Vec3::new(place(row), 1.6 + SPACING * layer as f32, place(column));
        let rock = rock(&mut random);
        let surface = rolling(0.25 * rock.inner_radius());
        let def = made_of(body(Shape::Hull(Arc::new(rock)), at), surface);
        scene.body(BodyDef { rotation: rotation(&mut random), ..def });
    }
    scene
}

/// The hull of points drawn from the surface of an ellipsoid.
fn rock(random: &mut Random) -> Hull {
    const CORNERS: usize = 14;
    let half_axes = in_box(random, 0.25, 0.5);
    let corners: Vec<Vec3> = (0..CORNERS).map(|_| half_axes * (rotation(random) * Vec3::Y)).collect();
    Hull::new(&corners).expect("the points span a solid")
}

/// Rolling resistance as a share of the radius of a rolling body. Shapes without roundings have a quarter of the
/// resistance of their largest inscribed ball.
const ROLLING: f32 = 0.3;

fn rolling(radius: f32) -> Material {
    Material { rolling: ROLLING * radius, ..Material::default() }
}

/// Ground whose height is a product of two sines.
pub(crate) struct Waves {
    /// Number of cells of 1 m along each side.
    pub cells: usize,
    /// Height of the crests above the mean height, metres.
    pub height: f32,
    /// Spatial frequencies along x and z, 1/m.
    pub frequencies: [f32; 2],
}

impl Waves {
    /// Height of the corner in a row and a column, metres.
    fn height(&self, row: usize, column: usize) -> f32 {
        let [along_x, along_z] = self.frequencies.map(|frequency| TAU * frequency);
        self.height * trig::sin(along_x * column as f32) * trig::sin(along_z * row as f32)
    }

    /// Heights of all corners, row after row.
    fn heights(&self) -> impl Iterator<Item = f32> {
        let side = self.cells + 1;
        (0..side).flat_map(move |row| (0..side).map(move |column| self.height(row, column)))
    }

    /// Position of the ground's first corner with the ground's centre at the origin, metres.
    fn corner(&self) -> Vec3 {
        Vec3::new(-0.5, 0.0, -0.5) * self.cells as f32
    }

    pub fn field(&self) -> BodyDef {
        let side = self.cells + 1;
        let def = HeightFieldDef {
            columns: side,
            rows: side,
            spacing: [1.0; 2],
            heights: self.heights().collect(),
            holes: Vec::new(),
        };
        let field = HeightField::new(def).expect("the height field is valid");
        fixed(body(Shape::HeightField(Arc::new(field)), self.corner()))
    }

    pub fn mesh(&self) -> BodyDef {
        let side = self.cells as u32 + 1;
        let place = |i: usize| Vec3::new((i % side as usize) as f32, 0.0, (i / side as usize) as f32);
        let vertices: Vec<Vec3> = self.heights().enumerate().map(|(i, y)| place(i) + Vec3::Y * y).collect();
        let cells = (0..side - 1).flat_map(|row| (0..side - 1).map(move |column| row * side + column));
        let halves = |a: u32| [[a, a + side, a + side + 1], [a, a + side + 1, a + 1]];
        let triangles: Vec<[u32; 3]> = cells.flat_map(halves).collect();
        let mesh = Mesh::new(&vertices, &triangles).expect("the mesh is valid");
        fixed(body(Shape::Mesh(Arc::new(mesh)), self.corner()))
    }
}
