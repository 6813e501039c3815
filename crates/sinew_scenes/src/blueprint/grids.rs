//! Nets of joints that form loops, without collisions.

use super::{Blueprint, weighed_ghost};
use crate::parts::{ball, body, fixed, ghost};
use sinew::math::{Rotation, Vec3, trig};
use sinew::physics::{BodyDef, BodyKind, Shape, Sleeping};

/// 100 × 100 balls 1 m apart in a vertical plane, neighbours joined halfway between them, the top row fixed, at rest.
///
/// Box3D's `joint_grid`: 9,900 balls of radius 0.4 m move. It has 19,701 ball joints: the 99 of 19,800 between fixed
/// balls are omitted.
pub fn joint_grid() -> Blueprint {
    joint_grid_of(100)
}

/// A net with `side` rows of `side` balls.
pub fn joint_grid_of(side: usize) -> Blueprint {
    let mut scene = Blueprint::new("joint_grid", Sleeping::Off, 100);
    let place = |row: usize, column: usize| Vec3::new(column as f32, -(row as f32), 0.0);
    for (row, column) in cells(side) {
        let knot = ghost(ball(0.4, place(row, column)));
        scene.body(if row == 0 { fixed(knot) } else { knot });
    }
    for [a, b] in neighbors(side) {
        if [a, b].iter().any(|&knot| scene.bodies[knot].kind == BodyKind::Dynamic) {
            let [from, to] = [a, b].map(|knot| scene.bodies[knot].position);
            scene.ball(a, b, 0.5 * (from + to));
        }
    }
    scene
}

/// A net of 8 × 8 knots of 0.1 kg with rods of 0.5 m and 0.1 kg between neighbours, released to sag from its two upper
/// corners, with 20 kg below the midpoint of its lower edge: 112 rods, 225 ball joints, 49 loops.
pub fn net() -> Blueprint {
    const SIDE: usize = 8;
    const SPACING: f32 = 0.5;
    /// Half angle of the arc in which each row starts, radians.
    const HALF_ARC: f32 = 1.0;
    let mut scene = Blueprint::new("net", Sleeping::Off, 600);
    // Knots on a circle whose chords are the net's spacing.
    let turn = 2.0 * HALF_ARC / (SIDE - 1) as f32;
    let radius = 0.5 * SPACING / trig::sin(0.5 * turn);
    let place = |row: usize, column: usize| {
        let (sin, cos) = trig::sin_cos(column as f32 * turn - HALF_ARC);
        Vec3::new(radius * sin, -radius * cos - row as f32 * SPACING, 0.0)
    };
    for (row, column) in cells(SIDE) {
        let knot = weighed_ghost(0.1, ball(0.05, place(row, column)));
        let is_corner = row == 0 && (column == 0 || column == SIDE - 1);
        scene.body(if is_corner { fixed(knot) } else { knot });
    }
    for [a, b] in neighbors(SIDE) {
        let [from, to] = [a, b].map(|knot| scene.bodies[knot].position);
        let rod = scene.body(weighed_ghost(0.1, rod_between(from, to, 0.02)));
        scene.ball(a, rod, from);
        scene.ball(rod, b, to);
    }
    let lowest = SIDE * (SIDE - 1) + SIDE / 2;
    let anchor = scene.bodies[lowest].position;
    let weight = scene.body(weighed_ghost(20.0, ball(0.2, anchor + Vec3::NEG_Y * SPACING)));
    scene.ball(lowest, weight, anchor);
    scene
}

/// Returns row and column of each knot of a square net, row by row.
fn cells(side: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..side).flat_map(move |row| (0..side).map(move |column| (row, column)))
}

/// Pairs of neighbouring knots of a square net, by their indices in [`cells`].
fn neighbors(side: usize) -> impl Iterator<Item = [usize; 2]> {
    cells(side).flat_map(move |(row, column)| {
        let this = row * side + column;
        let above = (row > 0).then(|| [this - side, this]);
        let beside = (column > 0).then(|| [this - 1, this]);
        above.into_iter().chain(beside)
    })
}

/// A capsule from one point to another.
fn rod_between(from: Vec3, to: Vec3, radius: f32) -> BodyDef {
    let along = to - from;
    let half_height = 0.5 * along.length() - radius;
    let rod = body(Shape::Capsule { half_height, radius }, 0.5 * (from + to));
    BodyDef { rotation: Rotation::from_arc(Vec3::Y, along.normalize()), ..rod }
}
