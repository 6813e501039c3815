//! Random boxes and pairs: near and far, touching, contained, flat, aligned and nearly aligned.

use super::oracle::{WideBox, cross};
use crate::cases::half_extents;
use crate::wide::{add, dot, length, wide};
use sinew_geometry::Obb;
use sinew_math::{Random, Rotation, Vec3};

/// Returns a random rotation: in a third of the cases the identity, in another third nearly the identity.
pub fn rotation(random: &mut Random) -> Rotation {
    match random.index(3) {
        0 => Rotation::IDENTITY,
        1 => Rotation::from_scaled_axis(random.in_cube() * 0.02),
        _ => random.rotation(),
    }
}

/// Returns a position within a metre of the origin or, in a quarter of the cases, 10 km away.
pub fn place(random: &mut Random) -> Vec3 {
    if random.index(4) == 0 { random.direction() * 1e4 } else { random.in_cube() }
}

/// Returns a box of millimetres to hundreds of metres.
pub fn obb(random: &mut Random) -> Obb {
    let scale = [0.001, 0.1, 1.0, 100.0][random.index(4)];
    Obb::new(place(random), random.rotation(), half_extents(scale, random))
}

/// Returns two boxes: near each other, touching, one in the other, or far apart.
pub fn pair(random: &mut Random) -> [Obb; 2] {
    let a = obb(random);
    let ratio = [0.1, 1.0, 1.0, 5.0][random.index(4)];
    let scale = a.half_extents.length() * ratio + 1e-3;
    let mut b = Obb::new(a.center, a.rotation * rotation(random), half_extents(scale, random));
    let reach = a.half_extents.length() + b.half_extents.length();
    match random.index(8) {
        0 | 1 => b.center = touching(&a, &b, random),
        2 => {
            b.half_extents *= 0.2;
            b.center = a.center + a.rotation * (a.half_extents * random.in_cube() * 0.5);
        }
        3 => b.center = a.center + random.direction() * (reach * random.range(2.0, 1e4)),
        4 => {}
        _ => b.center = a.center + random.in_cube() * reach,
    }
    [a, b]
}

/// Returns the centre of B at which B's extent along a separating axis begins where A's ends.
fn touching(a: &Obb, b: &Obb, random: &mut Random) -> Vec3 {
    let (wa, wb) = (WideBox::from(a), WideBox::from(b));
    let (i, j) = (random.index(3), random.index(3));
    let n = [wa.axes[i], wb.axes[j], cross(wa.axes[i], wb.axes[j])][random.index(3)];
    if length(n) < 1e-3 {
        return a.center;
    }
    let n = n.map(|x| x / length(n));
    let beside = wide(a.center + random.in_cube() * a.half_extents.length() * 0.5);
    let at = wb.moved(add(beside, wb.center, -1.0));
    let gap = -at.support(n.map(|x| -x)) - wa.support(n);
    debug_assert!(dot(n, n) > 0.99);
    let center = add(at.center, n, -gap);
    Vec3::new(center[0] as f32, center[1] as f32, center[2] as f32)
}
