//! Boxes on boxes.

use super::{Blueprint, damped, in_box, rotation};
use crate::parts::{cuboid, fixed};
use sinew::math::{Random, Rotation, Vec3};
use sinew::physics::Sleeping;

/// A square pyramid of 15 layers of unit cubes side by side.
pub fn box_pyramid() -> Blueprint {
    box_pyramid_of(15)
}

/// A square pyramid with `layers` layers.
pub fn box_pyramid_of(layers: usize) -> Blueprint {
    let mut scene = Blueprint::new("box_pyramid", Sleeping::Off, 300);
    scene.body(fixed(cuboid(Vec3::new(50.0, 1.0, 50.0), Vec3::NEG_Y)));
    for layer in 0..layers {
        let side = layers - layer;
        let middle = 0.5 * (side - 1) as f32;
        for (a, b) in (0..side).flat_map(|a| (0..side).map(move |b| (a, b))) {
            let at = Vec3::new(a as f32 - middle, 0.5 + layer as f32, b as f32 - middle);
            scene.body(damped(cuboid(Vec3::splat(0.5), at)));
        }
    }
    scene
}

/// A wall of 100 rows of unit cubes, one fewer in each row, as Box3D's `large_pyramid`.
pub fn large_pyramid() -> Blueprint {
    large_pyramid_of(100)
}

/// A wall with `rows` rows.
pub fn large_pyramid_of(rows: usize) -> Blueprint {
    let mut scene = Blueprint::new("large_pyramid", Sleeping::Off, 200);
    scene.body(fixed(cuboid(Vec3::new(400.0, 1.0, 400.0), Vec3::NEG_Y)));
    for row in 0..rows {
        for i in 0..rows - row {
            let x = i as f32 - 0.5 * (rows - row - 1) as f32;
            scene.body(cuboid(Vec3::splat(0.5), Vec3::new(x, 0.5 + row as f32, 0.0)));
        }
    }
    scene
}

/// 4,000 boxes of all sizes fall into a pit.
pub fn box_rain() -> Blueprint {
    box_rain_of(4000)
}

/// `count` boxes of all sizes fall into a pit.
pub fn box_rain_of(count: usize) -> Blueprint {
    const SIDE: usize = 12;
    /// Half of the pit's width, metres.
    const HALF: f32 = 8.4;
    let mut scene = Blueprint::new("box_rain", Sleeping::Off, 600);
    let outer = HALF + 2.0;
    scene.body(fixed(cuboid(Vec3::new(outer, 1.0, outer), Vec3::NEG_Y)));
    for side in [-1.0, 1.0] {
        let out = side * (HALF + 1.0);
        scene.body(fixed(cuboid(Vec3::new(1.0, 10.0, outer), Vec3::new(out, 10.0, 0.0))));
        scene.body(fixed(cuboid(Vec3::new(outer, 10.0, 1.0), Vec3::new(0.0, 10.0, out))));
    }
    let mut random = Random::new(3);
    for i in 0..count {
        let (layer, a, b) = (i / (SIDE * SIDE), i / SIDE % SIDE, i % SIDE);
        let place = |index: usize| (index as f32 - 5.5) * 1.4;
        let half_extents = in_box(&mut random, 0.1, 0.4);
        let mut def = cuboid(half_extents, Vec3::new(place(a), 2.0 + 1.4 * layer as f32, place(b)));
        def.rotation = rotation(&mut random);
        scene.body(damped(def));
    }
    scene
}

/// 10,000 boxes of all sizes, placed loosely beside and above each other in a pit, collapse to one heap.
pub fn boxes_10000() -> Blueprint {
    box_heap(20, 25)
}

/// A heap with `side` × `side` boxes in each of `layers` layers.
pub fn box_heap(side: usize, layers: usize) -> Blueprint {
    /// Spacing of the boxes, metres: with their limited rotation, no box extends more than half of the spacing from its
    /// centre along an axis.
    const APART: f32 = 0.86;
    /// Largest rotation of a box, radians.
    const TURN: f32 = 0.35;
    let mut scene = Blueprint::new("boxes_10000", Sleeping::Off, 240);
    let half = 0.5 * APART * side as f32;
    let (outer, height) = (half + 2.0, 0.5 * APART * layers as f32);
    scene.body(fixed(cuboid(Vec3::new(outer, 1.0, outer), Vec3::NEG_Y)));
    for out in [-1.0, 1.0].map(|side| side * (half + 1.0)) {
        scene.body(fixed(cuboid(Vec3::new(1.0, height, outer), Vec3::new(out, height, 0.0))));
        scene.body(fixed(cuboid(Vec3::new(outer, height, 1.0), Vec3::new(0.0, height, out))));
    }
    let mut random = Random::new(4);
    for i in 0..side * side * layers {
        let (layer, a, b) = (i / (side * side), i / side % side, i % side);
        let place = |index: usize| (index as f32 + 0.5) * APART;
        let half_extents = in_box(&mut random, 0.15, 0.3);
        let mut def = cuboid(half_extents, Vec3::new(place(a) - half, place(layer), place(b) - half));
        def.rotation = Rotation::from_axis_angle(random.direction(), random.range(0.0, TURN));
        scene.body(damped(def));
    }
    scene
}
