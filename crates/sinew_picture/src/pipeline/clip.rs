//! Clips triangles at the near plane, and far outside the picture at the limits of fixed-point coordinates.

/// Clip space of a [`View`](crate::camera::View): x, y, w; the picture spans ±w.
pub(crate) type ClipVertex = [f32; 3];

/// Largest distance of a corner from the picture's centre, in half pictures. Nearer corners are not changed, so that
/// clipping, which rounds, happens off screen.
const GUARD: f32 = 2.0;

/// A triangle cut by five planes has at most this many corners.
const MOST_CORNERS: usize = 8;

/// The part of a triangle that the rasteriser can draw: a convex polygon of 0 or 3..=8 corners in the same order.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Polygon {
    corners: [ClipVertex; MOST_CORNERS],
    count: usize,
}

impl Polygon {
    pub(crate) fn corners(&self) -> &[ClipVertex] {
        &self.corners[..self.count]
    }
}

/// Clips a triangle to depths of at least `near` and to the guard band (Sutherland and Hodgman, "Reentrant Polygon
/// Clipping", CACM 1974).
pub(crate) fn clip(triangle: [ClipVertex; 3], near: f32) -> Polygon {
    let mut polygon = Polygon { corners: [[0.0; 3]; MOST_CORNERS], count: 0 };
    if unseen(&triangle, near) {
        return polygon;
    }
    polygon.corners[..3].copy_from_slice(&triangle);
    polygon.count = 3;
    for plane in 0..5 {
        if polygon.corners().iter().any(|&v| distance(plane, v, near) < 0.0) {
            polygon = cut(&polygon, plane, near);
        }
    }
    polygon
}

/// Returns true if the whole triangle is beyond one edge of the picture or before the near plane.
#[inline]
pub(crate) fn unseen(triangle: &[ClipVertex; 3], near: f32) -> bool {
    triangle.iter().all(|v| v[0] > v[2])
        || triangle.iter().all(|v| v[0] < -v[2])
        || triangle.iter().all(|v| v[1] > v[2])
        || triangle.iter().all(|v| v[1] < -v[2])
        || triangle.iter().all(|v| v[2] < near)
}

/// Returns true if clipping does not change the triangle.
#[inline]
pub(crate) fn is_whole(triangle: &[ClipVertex; 3], near: f32) -> bool {
    (0..5).all(|plane| triangle.iter().all(|&v| distance(plane, v, near) >= 0.0))
}

/// Returns the distance inside a plane: 0 near, 1–4 the guard band right, left, top, bottom.
fn distance(plane: usize, [x, y, w]: ClipVertex, near: f32) -> f32 {
    match plane {
        0 => w - near,
        1 => GUARD * w - x,
        2 => GUARD * w + x,
        3 => GUARD * w - y,
        _ => GUARD * w + y,
    }
}

fn cut(polygon: &Polygon, plane: usize, near: f32) -> Polygon {
    let mut result = Polygon { corners: [[0.0; 3]; MOST_CORNERS], count: 0 };
    let mut push = |v: ClipVertex| {
        // Rounding may make an almost flat polygon cross a plane more than twice; the surplus is too thin to see.
        if result.count < MOST_CORNERS {
            result.corners[result.count] = v;
            result.count += 1;
        }
    };
    let corners = polygon.corners();
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let (da, db) = (distance(plane, a, near), distance(plane, b, near));
        if da >= 0.0 {
            push(a);
        }
        if (da >= 0.0) != (db >= 0.0) {
            // Clip always from the inner to the outer corner, so that both triangles at this edge get the same bits.
            let (inner, outer, di, do_) = if da >= 0.0 { (a, b, da, db) } else { (b, a, db, da) };
            let t = di / (di - do_);
            push(core::array::from_fn(|k| inner[k] + (outer[k] - inner[k]) * t));
        }
    }
    if result.count < 3 {
        result.count = 0;
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(polygon: &Polygon) -> f32 {
        let p: Vec<[f32; 2]> = polygon.corners().iter().map(|v| [v[0] / v[2], v[1] / v[2]]).collect();
        (1..p.len().saturating_sub(1))
            .map(|i| {
                let (a, b) =
                    ([p[i][0] - p[0][0], p[i][1] - p[0][1]], [p[i + 1][0] - p[0][0], p[i + 1][1] - p[0][1]]);
                0.5 * (a[0] * b[1] - a[1] * b[0])
            })
            .sum()
    }

    #[test]
    fn a_triangle_inside_is_untouched() {
        let triangle = [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.9, 1.0]];
        assert_eq!(clip(triangle, 0.1).corners(), &triangle);
        assert!(is_whole(&triangle, 0.1) && !unseen(&triangle, 0.1));
        assert!(!is_whole(&[[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 2.1, 1.0]], 0.1));
    }

    #[test]
    fn a_huge_triangle_becomes_the_guard_band() {
        let polygon = clip([[-100.0, -100.0, 1.0], [300.0, -100.0, 1.0], [-100.0, 300.0, 1.0]], 0.1);
        assert!((area(&polygon) - 4.0 * GUARD * GUARD).abs() < 1e-3, "{polygon:?}");
    }

    #[test]
    fn clipping_keeps_the_part_in_front() {
        let polygon = clip([[0.0, 0.5, 1.0], [-0.5, -0.5, 1.0], [0.0, 0.0, -1.0]], 0.5);
        assert_eq!(polygon.corners().len(), 4);
        assert!(polygon.corners().iter().all(|v| v[2] >= 0.5));
        assert!(clip([[0.0, 0.0, -1.0], [1.0, 0.0, -1.0], [0.0, 1.0, -2.0]], 0.5).corners().is_empty());
    }
}
