//! Structures built to stand: stacks, a tower, a house of cards.

use super::Blueprint;
use crate::parts::{cuboid, floor, made_of};
use core::f32::consts::{FRAC_PI_2, PI};
use sinew::math::{Rotation, Transform, Vec3, trig};
use sinew::physics::{BodyDef, Material, Sleeping};

/// Cubes of 0.5 m on top of each other, each `ratio` times as heavy as the one below.
pub fn stack_mass_ratio(boxes: usize, ratio: f32) -> Blueprint {
    const HALF: f32 = 0.25;
    let mut scene = on_floor("stack_mass_ratio");
    // Density of the lowest cube, kg/m³.
    let mut density = 1.0;
    for i in 0..boxes {
        let mut def = cuboid(Vec3::splat(HALF), Vec3::Y * (HALF * (2 * i + 1) as f32));
        def.shapes[0].density = density;
        scene.body(def);
        density *= ratio;
    }
    scene
}

/// Cubes on top of each other, the lowest of 0.125 m, each twice as large as the one below.
pub fn stack_ratio(boxes: usize) -> Blueprint {
    let mut scene = on_floor("stack_ratio");
    let (mut half, mut height) = (0.0625, 0.0);
    for _ in 0..boxes {
        height += 2.0 * half;
        scene.body(cuboid(Vec3::splat(half), Vec3::Y * (height - half)));
        half *= 2.0;
    }
    scene
}

/// A tower of blocks of 75 × 15 × 25 mm, three to a level, each level across the one below.
pub fn jenga(levels: usize) -> Blueprint {
    const HALF: Vec3 = Vec3::new(0.0375, 0.0075, 0.0125);
    /// Gap between neighbours of a level, metres.
    const GAP: f32 = 0.0002;
    let mut scene = on_floor("jenga");
    for level in 0..levels {
        let turn = if level.is_multiple_of(2) { 0.0 } else { FRAC_PI_2 };
        let rotation = Rotation::from_axis_angle(Vec3::Y, turn);
        for side in [-1.0, 0.0, 1.0] {
            let across = rotation * (Vec3::Z * (side * (2.0 * HALF.z + GAP)));
            let at = across + Vec3::Y * (HALF.y * (2 * level + 1) as f32);
            scene.body(BodyDef { rotation, ..cuboid(HALF, at) });
        }
    }
    scene
}

/// A house of cards 0.4 m long, 0.2 m wide and 2 mm thick, with `pairs` leaning pairs in the lowest storey and one
/// fewer in each storey above; friction 0.7.
pub fn cards(pairs: usize) -> Blueprint {
    const SURFACE: Material = Material { friction: 0.7, ..Material::DEFAULT };
    let mut scene = Blueprint::new("cards", Sleeping::On, 600);
    scene.body(made_of(floor(), SURFACE));
    for Transform { translation, rotation } in house_of_cards(pairs) {
        let card = cuboid(0.5 * Vec3::new(THICKNESS, LENGTH, WIDTH), translation);
        scene.body(BodyDef { rotation, ..made_of(card, SURFACE) });
    }
    scene
}

fn on_floor(name: &'static str) -> Blueprint {
    let mut scene = Blueprint::new(name, Sleeping::On, 600);
    scene.body(floor());
    scene
}

// Thickness of a card, metres.
const THICKNESS: f32 = 0.002;
const LENGTH: f32 = 0.4;
const WIDTH: f32 = 0.2;
/// Tilt of each leaning card from the vertical, radians.
const LEAN: f32 = 25.0 * PI / 180.0;
/// Spacing of the pairs, metres: the lying cards reach over both tops, but not to the feet of the next storey.
const PITCH: f32 = 0.38;

/// Poses of all cards, storey by storey: x along their thickness, y along their length.
///
/// Each lying card except the first rests with its left end on the right end of the previous one, like shingles. The
/// pairs on it are tilted by the same angle.
fn house_of_cards(pairs: usize) -> Vec<Transform> {
    let flat = Rotation::from_axis_angle(Vec3::Z, FRAC_PI_2);
    let place = |i: usize| Vec3::X * (PITCH * (i as f32 - 0.5 * (pairs - 1) as f32));
    let mut cards = Vec::new();
    let mut feet: Vec<_> = (0..pairs).map(|i| Transform::from_translation(place(i))).collect();
    while !feet.is_empty() {
        cards.extend(feet.iter().flat_map(|&foot| leaning(foot)));
        let tops: Vec<Vec3> = feet.iter().map(|foot| foot.point(Vec3::Y * (2.0 * middle()))).collect();
        let shingle = |(i, pair): (usize, &[Vec3])| {
            let left = if i == 0 { pair[0] } else { pair[0] + Vec3::Y * THICKNESS };
            lying(left, pair[1])
        };
        let ceiling: Vec<Transform> = tops.windows(2).enumerate().map(shingle).collect();
        cards.extend(ceiling.iter().map(|&card| card * Transform::new(Vec3::ZERO, flat)));
        let above = Transform::from_translation(Vec3::Y * (0.5 * THICKNESS));
        feet = ceiling.iter().map(|&card| card * above).collect();
    }
    cards
}

/// Height of the centre of a leaning card, metres: half the height of its uppermost corner.
fn middle() -> f32 {
    let (sin, cos) = trig::sin_cos(LEAN);
    0.5 * (THICKNESS * sin + LENGTH * cos)
}

/// Returns the transforms of two leaning cards on a plane, whose tops touch above the origin of `foot`.
fn leaning(foot: Transform) -> [Transform; 2] {
    let (sin, cos) = trig::sin_cos(LEAN);
    let out = 0.5 * (THICKNESS * cos + LENGTH * sin);
    [-1.0, 1.0].map(|side| {
        let lean = Rotation::from_axis_angle(Vec3::Z, side * LEAN);
        foot * Transform::new(Vec3::new(side * out, middle(), 0.0), lean)
    })
}

/// Returns the transform of the centre of a card on two points: x from the left to the right point, y up.
fn lying(left: Vec3, right: Vec3) -> Transform {
    let turn = Rotation::from_arc(Vec3::X, (right - left).normalize());
    Transform::new(0.5 * (left + right) + turn * (Vec3::Y * (0.5 * THICKNESS)), turn)
}
