//! Nets: joints in loops. Nothing collides.

use super::{Blueprint, weighed_ghost};
use crate::parts::{ball, fixed, ghost};
use sinew::math::{Vec3, trig};
use sinew::physics::{BodyDef, BodyKind, Sleeping};

/// 100 × 100 balls 1 m apart in a plumb plane, neighbours joined halfway between them, the top row fixed, at rest.
///
/// Box3D's `joint_grid`: 9,900 balls of radius 0.4 m move. Of its 19,800 ball joints the 99 between fixed balls are left
/// out: 19,701.
pub fn joint_grid() -> Blueprint {
    let mut scene = Blueprint::new("joint_grid", Sleeping::Off, 100);
    weave(&mut scene, 100, |row, column| {
        let knot = ghost(ball(0.4, Vec3::new(column as f32, -(row as f32), 0.0)));
        if row == 0 { fixed(knot) } else { knot }
    });
    scene
}

/// A net of 12 × 12 knots of 0.25 kg, 0.5 m apart, let sag from its two upper corners, and 25 kg below the middle of
/// its lower edge: 265 ball joints, 121 loops.
pub fn net() -> Blueprint {
    const SIDE: usize = 12;
    const SPACING: f32 = 0.5;
    /// From the middle of the arc in which each row starts to its ends, radians.
    const HALF_ARC: f32 = 0.8;
    let mut scene = Blueprint::new("net", Sleeping::Off, 600);
    // Knots on a circle whose chords are the net's spacing.
    let turn = 2.0 * HALF_ARC / (SIDE - 1) as f32;
    let radius = 0.5 * SPACING / trig::sin(0.5 * turn);
    let place = |row: usize, column: usize| {
        let (sin, cos) = trig::sin_cos(column as f32 * turn - HALF_ARC);
        Vec3::new(radius * sin, -radius * cos - row as f32 * SPACING, 0.0)
    };
    weave(&mut scene, SIDE, |row, column| {
        let knot = weighed_ghost(0.25, ball(0.2, place(row, column)));
        if row == 0 && (column == 0 || column == SIDE - 1) { fixed(knot) } else { knot }
    });
    let lowest = place(SIDE - 1, SIDE / 2);
    let weight = scene.body(weighed_ghost(25.0, ball(0.2, lowest + Vec3::NEG_Y * SPACING)));
    scene.ball(knot_place(SIDE, SIDE - 1, SIDE / 2), weight, lowest + Vec3::NEG_Y * (0.5 * SPACING));
    scene
}

fn knot_place(side: usize, row: usize, column: usize) -> usize {
    row * side + column
}

/// Adds `side` rows of as many knots to an empty scene, and joins each that moves with those above and beside it.
fn weave(scene: &mut Blueprint, side: usize, knot: impl Fn(usize, usize) -> BodyDef) {
    for (row, column) in (0..side).flat_map(|row| (0..side).map(move |column| (row, column))) {
        let this = scene.body(knot(row, column));
        let above = (row > 0).then(|| knot_place(side, row - 1, column));
        let beside = (column > 0).then(|| knot_place(side, row, column - 1));
        for other in [above, beside].into_iter().flatten() {
            if [other, this].iter().any(|&place| scene.bodies[place].kind == BodyKind::Dynamic) {
                let middle = 0.5 * (scene.bodies[other].position + scene.bodies[this].position);
                scene.ball(other, this, middle);
            }
        }
    }
}
