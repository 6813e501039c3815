//! An arch of stones.

use super::Blueprint;
use crate::parts::{body, cuboid, fixed, made_of};
use sinew::math::{Vec3, trig};
use sinew::physics::{Hull, Material, Shape, Sleeping};
use std::sync::Arc;

/// Half the span, and the parameter `a` of the stones' centre line, a catenary `y = −a cosh(x / a)`, metres.
const HALF_SPAN: f32 = 3.5;
const PARAMETER: f32 = 2.0;
/// Thickness of the stones across the line of thrust, and half of their width along the arch's axis, metres.
const THICKNESS: f32 = 0.4;
const HALF_WIDTH: f32 = 0.25;
/// Half extents of a pier and of a block on top, metres.
const PIER_HALF: Vec3 = Vec3::new(0.6, 0.25, 0.5);
const BLOCK_HALF: Vec3 = Vec3::new(0.3, 0.15, 0.25);
const MASONRY: Material = Material { friction: 0.6, restitution: 0.0, rolling: 0.0, ..Material::DEFAULT };

/// A catenary arch of `stones` stones (an odd number) without mortar on two level piers, with blocks on top of the
/// keystone. Order: the piers, the stones from −x to +x, the blocks.
///
/// The centre line of the stones is an inverted hanging chain, which is the line of thrust of the arch's own weight
/// (Hooke 1675). The thrust is therefore perpendicular to the joints between the stones.
pub fn arch(stones: usize, blocks: usize) -> Blueprint {
    let mut scene = Blueprint::new("arch", Sleeping::On, 600);
    for side in [-1.0, 1.0] {
        let at = Vec3::new(side * HALF_SPAN, -PIER_HALF.y, 0.0);
        scene.body(fixed(made_of(cuboid(PIER_HALF, at), MASONRY)));
    }
    for ends in joints(stones).windows(2) {
        let middle = 0.5 * (ends[0].middle + ends[1].middle);
        let corners: Vec<Vec3> = ends.iter().flat_map(Joint::corners).map(|at| at - middle).collect();
        let stone = Shape::Hull(Arc::new(Hull::new(&corners).expect("a stone's corners span a solid")));
        scene.body(made_of(body(stone, middle), MASONRY));
    }
    // The keystone's top is horizontal.
    let [keystone, _] = joints(stones)[stones / 2].ends();
    for i in 0..blocks {
        let at = Vec3::Y * (keystone.y + BLOCK_HALF.y * (2 * i + 1) as f32);
        scene.body(made_of(cuboid(BLOCK_HALF, at), MASONRY));
    }
    scene
}

/// Joint between two stones, or between a stone and its pier, in the plane z = 0.
#[derive(Clone, Copy)]
pub(crate) struct Joint {
    /// Midpoint between the joint's ends.
    pub middle: Vec3,
    /// Vector from the midpoint to the joint's outer end.
    pub half: Vec3,
}

impl Joint {
    /// Returns the outer and the inner end of the joint.
    pub fn ends(&self) -> [Vec3; 2] {
        [self.middle + self.half, self.middle - self.half]
    }

    fn corners(&self) -> impl Iterator<Item = Vec3> + use<> {
        let across = Vec3::Z * HALF_WIDTH;
        self.ends().into_iter().flat_map(move |end| [end - across, end + across])
    }
}

/// The joints of `stones` stones, from −x to +x: perpendicular to the catenary and equally spaced along it, except for
/// the level joints at the feet of the arch.
///
/// With `s` along the catenary from its crown `y = −√(a² + s²)`, the outward normal is along `(s, a)`.
pub(crate) fn joints(stones: usize) -> Vec<Joint> {
    let a = PARAMETER;
    let (grown, shrunk) = (trig::exp(HALF_SPAN / a), trig::exp(-HALF_SPAN / a));
    let (foot, foot_height) = (0.5 * a * (grown - shrunk), 0.5 * a * (grown + shrunk));
    let joint = |i: usize| {
        let s = foot * (2.0 * i as f32 / stones as f32 - 1.0);
        let y = (a * a + s * s).sqrt();
        if i == 0 || i == stones {
            // Half the width of a horizontal cut through the thickness.
            let half = Vec3::X * (0.5 * THICKNESS * foot_height / s);
            return Joint { middle: Vec3::X * (HALF_SPAN * s / foot), half };
        }
        let x = if s < 0.0 { -a * trig::ln((y - s) / a) } else { a * trig::ln((y + s) / a) };
        Joint {
            middle: Vec3::new(x, foot_height - y, 0.0),
            half: Vec3::new(s, a, 0.0) * (0.5 * THICKNESS / y),
        }
    };
    (0..=stones).map(joint).collect()
}
