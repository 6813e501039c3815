//! Weights on chains of light links, whose joints iterative solvers cannot keep closed. There are no collisions and no
//! damping.

use super::{Blueprint, weighed_ghost};
use crate::parts::{ball, cuboid, hook, level_rod};
use sinew::math::{Rotation, Vec3};
use sinew::physics::Sleeping;

/// 10 horizontal rods of 1 kg with a ball of `ratio` kg at their end, released from rest.
pub fn chain_swing(ratio: f32, link_length: f32) -> Blueprint {
    ten_links("chain_swing", ratio, link_length, Vec3::X)
}

/// 10 vertical rods of 1 kg and 1 m with a ball of `ratio` kg below them, at rest.
pub fn chain_hang(ratio: f32) -> Blueprint {
    ten_links("chain_hang", ratio, 1.0, Vec3::NEG_Y)
}

fn ten_links(name: &'static str, ratio: f32, link_length: f32, along: Vec3) -> Blueprint {
    const LINKS: usize = 10;
    let mut scene = Blueprint::new(name, Sleeping::Off, 600);
    let turn = Rotation::from_arc(Vec3::X, along);
    let mut last = scene.body(hook());
    for i in 0..LINKS {
        let start = i as f32 * link_length;
        let mut rod = level_rod(start, link_length, 0.05 * link_length);
        rod.position = turn * rod.position;
        rod.rotation = turn * rod.rotation;
        let link = scene.body(weighed_ghost(1.0, rod));
        scene.ball(last, link, along * start);
        last = link;
    }
    let end = along * (LINKS as f32 * link_length);
    let weight = scene.body(weighed_ghost(ratio, ball(0.25 * link_length, end)));
    scene.ball(last, weight, end);
    scene
}

/// 10 horizontal chains of 100 capsules of 1 kg and 0.25 m, each with a ball of 100 kg at its end, released from rest.
pub fn chain_100_links() -> Blueprint {
    const LINKS: usize = 100;
    const LENGTH: f32 = 0.25;
    let mut scene = Blueprint::new("chain_100_links", Sleeping::Off, 600);
    for chain in 0..10 {
        let origin = Vec3::new(0.0, 40.0, (chain as f32 - 4.5) * 2.0);
        let mut anchor = hook();
        anchor.position = origin;
        let mut last = scene.body(anchor);
        for i in 0..LINKS {
            let start = LENGTH * i as f32;
            // Capsules a little longer than the distance between joints: 0.1 m, with a cap of 0.05 m at each end.
            let mut rod = level_rod(start - 0.025, 0.3, 0.05);
            rod.position += origin;
            let link = scene.body(weighed_ghost(1.0, rod));
            scene.ball(last, link, origin + Vec3::X * start);
            last = link;
        }
        let end = origin + Vec3::X * (LENGTH * LINKS as f32);
        let weight = scene.body(weighed_ghost(100.0, ball(0.4, end)));
        scene.ball(last, weight, end);
    }
    scene
}

/// A horizontal rope of 19 links of 1 m and 1 kg on a fixed link, with a block of 30 m and 1,800 kg at its end,
/// released from rest.
///
/// Sizes and masses of `HeavyRope` in the demonstration of Augmented Vertex Block Descent (Giles, Diaz & Yuksel 2025),
/// 0.5 m thick.
pub fn heavy_rope() -> Blueprint {
    rope("heavy_rope", 20, Vec3::X, Vec3::new(0.5, 0.25, 0.25), 15.0)
}

/// A vertical rope of 48 links of 1 m and 1 kg on a fixed link, with a block of 10 m and 200 kg below it, at rest.
///
/// Sizes and masses are those of `HangingRope` in the same demonstration as [`heavy_rope`].
pub fn hanging_rope() -> Blueprint {
    rope("hanging_rope", 50, Vec3::NEG_Y, Vec3::new(0.25, 0.5, 0.25), 5.0)
}

/// `count` boxes 1 m apart. The first is fixed; the last has half extents `weight_half` along x and y.
fn rope(name: &'static str, count: usize, along: Vec3, link_half: Vec3, weight_half: f32) -> Blueprint {
    let mut scene = Blueprint::new(name, Sleeping::Off, 600);
    let thickness = link_half.z;
    let volume = |half: Vec3| 8.0 * half.x * half.y * half.z;
    let weight_half_extents = Vec3::new(weight_half, weight_half, thickness);
    let mut last = scene.body(hook());
    for i in 1..count {
        let joint = along * (i as f32 - 0.5);
        let is_weight = i == count - 1;
        let half = if is_weight { weight_half_extents } else { link_half };
        let reach = if is_weight { weight_half } else { 0.5 };
        let mass = volume(half) / volume(link_half);
        let link = scene.body(weighed_ghost(mass, cuboid(half, joint + along * reach)));
        scene.ball(last, link, joint);
        last = link;
    }
    scene
}
