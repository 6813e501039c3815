//! The rectangle of least area around points of a plane.
//!
//! ```
//! use sinew_math::Vec2;
//! use sinew_ragdoll::fit::rectangle::{least_rectangle, rectangle_area};
//!
//! // A square that stands on a corner.
//! let mut points = vec![Vec2::X, Vec2::Y, -Vec2::X, -Vec2::Y, Vec2::ZERO];
//! let side = least_rectangle(&mut points);
//! assert!((rectangle_area(&points, side) - 2.0).abs() < 1e-5);
//! assert!((rectangle_area(&points, Vec2::X) - 4.0).abs() < 1e-5);
//! ```

use sinew_math::Vec2;

/// Returns a unit vector along one side of the smallest rectangle around the points; the other side is perpendicular.
/// The result is X if the points span no area.
///
/// One side of that rectangle is collinear with a side of the convex hull (Freeman & Shapira, CACM 1975).
pub fn least_rectangle(points: &mut Vec<Vec2>) -> Vec2 {
    let hull = convex_hull(points);
    let mut best = (f32::INFINITY, Vec2::X);
    for i in 0..hull.len() {
        let side = hull[(i + 1) % hull.len()] - hull[i];
        let length = side.length();
        if length < 1e-9 {
            continue;
        }
        let u = side / length;
        let area = rectangle_area(&hull, u);
        if area < best.0 {
            best = (area, u);
        }
    }
    best.1
}

/// Returns the area of the rectangle around the points with a side along the unit vector `u`.
pub fn rectangle_area(points: &[Vec2], u: Vec2) -> f32 {
    let extent = |axis: Vec2| {
        let (lo, hi) = points.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(lo, hi), p| {
            let x = p.dot(axis);
            (sinew_math::min(lo, x), sinew_math::max(hi, x))
        });
        hi - lo
    };
    extent(u) * extent(Vec2::new(-u.y, u.x))
}

/// Returns the corners of the convex hull, counter-clockwise (Andrew's monotone chain). Sorts the points.
pub fn convex_hull(points: &mut Vec<Vec2>) -> Vec<Vec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let mut hull: Vec<Vec2> = Vec::new();
    let mut half = |run: &mut dyn Iterator<Item = Vec2>| {
        let start = hull.len();
        for point in run {
            while hull.len() >= start + 2 {
                let (a, b) = (hull[hull.len() - 2], hull[hull.len() - 1]);
                if (b - a).perp_dot(point - a) > 0.0 {
                    break;
                }
                hull.pop();
            }
            hull.push(point);
        }
        hull.pop();
    };
    half(&mut points.iter().copied());
    half(&mut points.iter().rev().copied());
    hull
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_math::trig;

    #[test]
    fn side_of_a_turned_rectangle_is_found() {
        let u = Vec2::new(trig::cos(0.4), trig::sin(0.4));
        let v = Vec2::new(-u.y, u.x);
        let mut points: Vec<_> = (0..=10)
            .flat_map(|i| (0..=3).map(move |j| (i as f32 / 10.0, j as f32 / 3.0)))
            .map(|(s, t)| u * (3.0 * s) + v * t)
            .collect();
        let side = least_rectangle(&mut points);
        assert!(side.dot(u).abs() > 0.9999 || side.dot(v).abs() > 0.9999, "{side}");
        assert!((rectangle_area(&points, side) - 3.0).abs() < 1e-4);
    }

    #[test]
    fn points_on_a_line_give_x() {
        assert_eq!(least_rectangle(&mut vec![Vec2::ZERO; 3]), Vec2::X);
    }
}
