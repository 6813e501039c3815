//! Heaps on wavy ground: as Box3D's wave pile and mesh drop, which show by the step at which they sleep that a run can be
//! repeated.

use super::{Blueprint, in_box, rotation};
use crate::parts::{ball, body, cuboid, fixed};
use core::f32::consts::TAU;
use sinew::math::{Random, Rotation, Vec3, trig};
use sinew::physics::{BodyDef, Filter, Shape, Sleeping};

/// 100 balls, capsules and boxes fall onto waves, five by five in four layers.
pub fn wave_pile() -> Blueprint {
    const SIDE: usize = 5;
    const LAYERS: usize = 4;
    const SPACING: f32 = 1.7;
    let mut scene = Blueprint::new("wave_pile", Sleeping::On, 600);
    waves(&mut scene, &Waves { cells: 20, height: 0.6, frequencies: [0.06, 0.08] }, Filter::default());
    let mut random = Random::new(5);
    for i in 0..SIDE * SIDE * LAYERS {
        let (layer, row, column) = (i / (SIDE * SIDE), i / SIDE % SIDE, i % SIDE);
        let place = |index: usize| (index as f32 - 0.5 * (SIDE - 1) as f32) * SPACING;
        let jitter = in_box(&mut random, -0.3, 0.3) * Vec3::new(1.0, 0.3, 1.0);
        let at = Vec3::new(place(row), 2.5 + 1.6 * layer as f32, place(column)) + jitter;
        let def = match i % 3 {
            0 => ball(0.5, at),
            1 => body(Shape::Capsule { half_height: 0.3, radius: 0.35 }, at),
            _ => cuboid(Vec3::new(0.45, 0.3, 0.55), at),
        };
        let turn = rotation(&mut random);
        scene.body(BodyDef { rotation: turn, angular_damping: DAMPING, ..def });
    }
    scene
}

/// 400 sticks of 4 × 40 × 8 cm, which meet only the ground, fall onto waves from 5 m, spinning.
pub fn mesh_drop() -> Blueprint {
    const SIDE: usize = 20;
    const GROUND: u32 = 1;
    const STICKS: u32 = 2;
    let mut scene = Blueprint::new("mesh_drop", Sleeping::On, 600);
    let ground = Filter { layers: GROUND, ..Filter::default() };
    waves(&mut scene, &Waves { cells: 40, height: 0.5, frequencies: [0.2, 0.1] }, ground);
    let mut random = Random::new(9);
    for i in 0..SIDE * SIDE {
        let place = |index: usize| 0.5 * (index as f32 - 0.5 * SIDE as f32);
        let at = Vec3::new(place(i / SIDE), 5.0, place(i % SIDE));
        let mut stick = cuboid(Vec3::new(0.02, 0.2, 0.04), at);
        stick.shapes[0].filter = Filter { layers: STICKS, mask: GROUND, ..Filter::default() };
        stick.linear_velocity = in_box(&mut random, -1.0, 1.0);
        stick.angular_velocity = in_box(&mut random, -5.0, 5.0);
        scene.body(stick);
    }
    scene
}

/// Of the turning of what rolls on the waves, 1/s.
const DAMPING: f32 = 0.5;

/// A product of two sines over square cells of 1 m, around the origin.
struct Waves {
    /// Along each side.
    cells: usize,
    /// From the middle to the crests, metres.
    height: f32,
    /// Along x and z, 1/m.
    frequencies: [f32; 2],
}

impl Waves {
    /// Height at a place, and its slopes along x and z.
    fn at(&self, x: f32, z: f32) -> (f32, [f32; 2]) {
        let [wx, wz] = self.frequencies.map(|frequency| TAU * frequency);
        let ((sin_x, cos_x), (sin_z, cos_z)) = (trig::sin_cos(wx * x), trig::sin_cos(wz * z));
        (self.height * sin_x * sin_z, [self.height * wx * cos_x * sin_z, self.height * wz * sin_x * cos_z])
    }
}

/// Tiles of 1 m along a tangent plane of the waves each.
fn waves(scene: &mut Blueprint, waves: &Waves, filter: Filter) {
    const THICK: f32 = 1.0;
    let place = |index: usize| index as f32 + 0.5 - 0.5 * waves.cells as f32;
    for (x, z) in (0..waves.cells).flat_map(|i| (0..waves.cells).map(move |j| (place(i), place(j)))) {
        let (y, [dx, dz]) = waves.at(x, z);
        let up = Vec3::new(-dx, 1.0, -dz).normalize();
        let mut tile = cuboid(Vec3::new(0.6, 0.5 * THICK, 0.6), Vec3::new(x, y, z) - up * (0.5 * THICK));
        tile.rotation = Rotation::from_arc(Vec3::Y, up);
        tile.shapes[0].filter = filter;
        scene.body(fixed(tile));
    }
}
