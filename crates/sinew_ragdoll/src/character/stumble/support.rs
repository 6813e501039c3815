//! Ground area covered by the feet.

use sinew_math::Vec3;

/// Convex hull of the soles on the ground, seen from above: a line along each sole, and a rim around the lines.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Support {
    points: [Vec3; 4],
    count: usize,
    /// Half the width of a sole, metres.
    rim: f32,
}

impl Support {
    pub fn new(rim: f32) -> Self {
        Self { rim, ..Self::default() }
    }

    /// Adds a sole from heel to ball; heights are ignored.
    pub fn add(&mut self, [heel, ball]: [Vec3; 2]) {
        for point in [heel, ball] {
            self.points[self.count] = level(point);
            self.count += 1;
        }
    }

    /// Returns the point of the support that is nearest to `point`; `point` itself if there is no support.
    pub fn nearest(&self, point: Vec3) -> Vec3 {
        let (point, points) = (level(point), &self.points[..self.count]);
        let mut nearest: Option<Vec3> = None;
        for (i, &a) in points.iter().enumerate() {
            for (j, &b) in points.iter().enumerate().skip(i + 1) {
                if points[j + 1..].iter().any(|&c| is_in(point, [a, b, c])) {
                    return point;
                }
                let on = on_line(point, a, b);
                if nearest.is_none_or(|old| (on - point).length() < (old - point).length()) {
                    nearest = Some(on);
                }
            }
        }
        let Some(nearest) = nearest else { return point };
        let away = point - nearest;
        let far = away.length();
        if far <= self.rim { point } else { nearest + away * (self.rim / far) }
    }

    /// Returns the horizontal distance of a point from the support, metres; 0 inside.
    pub fn outside(&self, point: Vec3) -> f32 {
        (level(point) - self.nearest(point)).length()
    }
}

/// Returns the horizontal part of a vector.
pub(in crate::character) fn level(v: Vec3) -> Vec3 {
    Vec3::new(v.x, 0.0, v.z)
}

/// Returns the point nearest to `point` on the line from `a` to `b`.
fn on_line(point: Vec3, a: Vec3, b: Vec3) -> Vec3 {
    let way = b - a;
    let square = way.dot(way);
    let share = if square > 0.0 { sinew_math::clamp((point - a).dot(way) / square, 0.0, 1.0) } else { 0.0 };
    a + way * share
}

fn is_in(point: Vec3, [a, b, c]: [Vec3; 3]) -> bool {
    let side = |from: Vec3, to: Vec3| {
        let (edge, way) = (to - from, point - from);
        edge.z * way.x - edge.x * way.z
    };
    let sides = [side(a, b), side(b, c), side(c, a)];
    sides.iter().all(|&s| s > 0.0) || sides.iter().all(|&s| s < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f32, z: f32) -> Vec3 {
        Vec3::new(x, 0.3, z)
    }

    #[test]
    fn two_soles_support_points_between_them() {
        let mut support = Support::new(0.05);
        assert_eq!(support.outside(at(3.0, 1.0)), 0.0, "a point cannot be outside an empty support");
        support.add([at(0.1, -0.05), at(0.1, 0.15)]);
        assert!((support.outside(at(0.0, 0.0)) - 0.05).abs() < 1e-6);
        support.add([at(-0.1, 0.25), at(-0.1, 0.45)]);
        for inside in [at(0.0, 0.2), at(0.14, 0.0), at(-0.1, 0.49), at(0.0, 0.15)] {
            assert_eq!(support.outside(inside), 0.0, "{inside}");
        }
        assert!((support.outside(at(-0.1, 0.6)) - 0.1).abs() < 1e-6);
        // Test a point across the corner of the hull.
        assert!(support.outside(at(0.15, 0.45)) > 0.03);
        let nearest = support.nearest(at(2.0, 0.05));
        assert!((nearest - Vec3::new(0.15, 0.0, 0.05)).length() < 1e-6, "{nearest}");
    }
}
