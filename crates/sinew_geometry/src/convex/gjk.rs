//! Gap between two cores: the point of their Minkowski difference that is closest to the origin (Gilbert, Johnson &
//! Keerthi, "A fast procedure for computing the distance between complex objects in three-dimensional space", IEEE J.
//! Robotics and Automation 4(2), 1988).

use super::support::{Posed, Support};
use sinew_math::DVec3;

/// Difference between the squared distance and its lower bound at which the search ends, as a share of the squared
/// distance. Directions are accurate to its square root, 1e-6.
const PRECISION: f64 = 1e-12;
/// Distance below which cores count as touching, as a share of the sizes; below the precision of `f32` positions.
pub(super) const TOUCH: f64 = 3e-8;
/// Height, relative to the edges, below which a tetrahedron is flat.
const THIN: f64 = 1e-12;
/// Largest number of steps, a safeguard: polytopes take about as many steps as they have nearby faces, round cores
/// about 30.
const MOST_STEPS: usize = 128;

/// A point of the Minkowski difference A − B, and the points of A and B that give it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Vertex {
    pub difference: DVec3,
    pub on_a: DVec3,
    pub on_b: DVec3,
}

/// Returns the point of A − B that is furthest along `direction`.
pub(super) fn support<A: Support, B: Support>(
    a: &Posed<'_, A>,
    b: &Posed<'_, B>,
    direction: DVec3,
) -> Vertex {
    let (on_a, on_b) = (a.support(direction), b.support(-direction));
    Vertex { difference: on_a - on_b, on_a, on_b }
}

/// Up to four points of A − B, and their weights for the point of their convex hull closest to the origin.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Simplex {
    pub vertices: [Vertex; 4],
    weights: [f64; 4],
    pub count: usize,
}

/// Closest points of two separated cores.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bridge {
    pub on_a: DVec3,
    pub on_b: DVec3,
    pub distance: f64,
    /// Unit normal from A to B.
    pub normal: DVec3,
}

/// Number of steps without improvement after which the search ends.
const MOST_STALLS: u32 = 12;

/// Result of the search for two cores.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::large_enum_variant, reason = "the value is on the stack, for one pair")]
pub(super) enum Cores {
    Apart(Bridge),
    /// The cores overlap: the simplex contains the origin, or touches it.
    Overlapping(Simplex),
}

/// Finds the closest points of two cores, unless they touch or overlap.
pub(super) fn closest<A: Support, B: Support>(a: &Posed<'_, A>, b: &Posed<'_, B>) -> Cores {
    let size = f64::from(a.solid.reach()) + f64::from(b.solid.reach());
    let offset = b.center - a.center;
    let start = if offset.length() > TOUCH * size { offset } else { DVec3::X };
    let mut simplex = Simplex::of(support(a, b, start));
    let mut nearest = simplex.nearest();
    // The best separating direction and the closest points are stored separately: at distances small against the sizes,
    // rounding prevents computing one from the other.
    let (mut apart, mut toward_a) = (f64::NEG_INFINITY, DVec3::X);
    let (mut shortest, mut bridge) = (f64::INFINITY, simplex);
    let mut stalls = 0;
    for _ in 0..MOST_STEPS {
        let squared = nearest.dot(nearest);
        let length = squared.sqrt();
        if length <= TOUCH * size {
            return Cores::Overlapping(simplex);
        }
        if squared < shortest {
            (shortest, bridge) = (squared, simplex);
        } else {
            stalls += 1;
        }
        let vertex = support(a, b, -nearest);
        // Lower bound of the difference, along the direction to its nearest point.
        let bound = vertex.difference.dot(nearest);
        if bound / length > apart {
            (apart, toward_a) = (bound / length, nearest / length);
        }
        let exact = squared - bound <= PRECISION * squared;
        if exact || stalls > MOST_STALLS || simplex.holds(vertex.difference) {
            break;
        }
        simplex.push(vertex);
        let proof = if apart > 0.0 { Known::Apart } else { Known::Nothing };
        if simplex.reduce(proof) {
            return Cores::Overlapping(simplex);
        }
        nearest = simplex.nearest();
    }
    if apart <= TOUCH * size {
        return Cores::Overlapping(bridge);
    }
    let [on_a, on_b] = bridge.ends();
    Cores::Apart(Bridge { on_a, on_b, distance: apart, normal: -toward_a })
}

/// Knowledge of a separating direction. If one is known, no simplex contains the origin, even if rounding suggests so.
#[derive(Clone, Copy, PartialEq)]
enum Known {
    Nothing,
    Apart,
}

impl Simplex {
    fn of(vertex: Vertex) -> Self {
        let mut simplex = Self { count: 1, ..Self::default() };
        simplex.vertices[0] = vertex;
        simplex.weights[0] = 1.0;
        simplex
    }

    fn push(&mut self, vertex: Vertex) {
        self.vertices[self.count] = vertex;
        self.count += 1;
    }

    fn holds(&self, difference: DVec3) -> bool {
        self.vertices[..self.count].iter().any(|vertex| vertex.difference == difference)
    }

    fn weighted(&self, of: impl Fn(&Vertex) -> DVec3) -> DVec3 {
        let terms = self.vertices[..self.count].iter().zip(self.weights);
        terms.fold(DVec3::ZERO, |sum, (vertex, weight)| sum + of(vertex) * weight)
    }

    /// Point of a reduced simplex closest to the origin.
    fn nearest(&self) -> DVec3 {
        self.weighted(|vertex| vertex.difference)
    }

    /// Points on A and B that give the point closest to the origin.
    fn ends(&self) -> [DVec3; 2] {
        [self.weighted(|vertex| vertex.on_a), self.weighted(|vertex| vertex.on_b)]
    }

    /// Returns the points on A and B for the point of the simplex's surface closest to the origin. For touching cores
    /// the distance of these points equals the depth.
    pub fn touching_ends(mut self) -> [DVec3; 2] {
        if self.count == 4 {
            self.reduce(Known::Apart);
        }
        self.ends()
    }

    /// Keeps only the vertices that span the point closest to the origin, with their weights. Returns true and keeps
    /// all if the simplex contains the origin.
    fn reduce(&mut self, known: Known) -> bool {
        let p: [DVec3; 4] = self.vertices.map(|vertex| vertex.difference);
        let (carriers, weights) = match self.count {
            1 => ([0, 0, 0], [1.0, 0.0, 0.0]),
            2 => on_segment([p[0], p[1]], [0, 1]),
            3 => on_triangle(&p, [0, 1, 2]),
            _ if known == Known::Nothing && holds_origin(&p) => return true,
            _ => on_tetrahedron(&p),
        };
        let kept = *self;
        self.count = 0;
        for (index, weight) in carriers.into_iter().zip(weights) {
            if weight > 0.0 {
                self.weights[self.count] = weight;
                self.push(kept.vertices[index]);
            }
        }
        false
    }
}

/// Three vertices by index, with their weights; the weight of an unused vertex is 0.
type Carriers = ([usize; 3], [f64; 3]);

/// Returns the vertices and weights that give the nearest point; the first among equals.
fn nearest_of<const N: usize>(p: &[DVec3; 4], all: [Carriers; N]) -> Carriers {
    let squared = |(carriers, weights): &Carriers| {
        let terms = carriers.iter().zip(weights);
        let point = terms.fold(DVec3::ZERO, |sum, (&index, &weight)| sum + p[index] * weight);
        point.dot(point)
    };
    let mut nearest = all[0];
    let mut shortest = squared(&nearest);
    for other in &all[1..] {
        let length = squared(other);
        if length < shortest {
            (nearest, shortest) = (*other, length);
        }
    }
    nearest
}

fn on_segment([p, q]: [DVec3; 2], [i, j]: [usize; 2]) -> Carriers {
    let along = q - p;
    let squared = along.dot(along);
    let t = if squared > 0.0 { -p.dot(along) / squared } else { 0.0 };
    if t <= 0.0 {
        ([i, j, j], [1.0, 0.0, 0.0])
    } else if t >= 1.0 {
        ([j, i, i], [1.0, 0.0, 0.0])
    } else {
        ([i, j, j], [1.0 - t, t, 0.0])
    }
}

/// Uses the areas that the origin's projection spans with the sides: if one is not positive, the closest point is on a
/// side.
fn on_triangle(p: &[DVec3; 4], at: [usize; 3]) -> Carriers {
    let [i, j, k] = at;
    let [a, b, c] = at.map(|index| p[index]);
    let normal = (b - a).cross(c - a);
    let squared = normal.dot(normal);
    let areas = [b.cross(c).dot(normal), c.cross(a).dot(normal), a.cross(b).dot(normal)];
    if squared > 0.0 && areas.iter().all(|area| *area > 0.0) {
        let sum = areas[0] + areas[1] + areas[2];
        return (at, areas.map(|area| area / sum));
    }
    nearest_of(p, [on_segment([a, b], [i, j]), on_segment([b, c], [j, k]), on_segment([c, a], [k, i])])
}

const FACES: [[usize; 4]; 4] = [[0, 1, 2, 3], [0, 2, 3, 1], [0, 3, 1, 2], [1, 3, 2, 0]];

/// True if the origin is on the inner side of all faces of a tetrahedron that is not flat.
fn holds_origin(p: &[DVec3; 4]) -> bool {
    FACES.iter().all(|&[i, j, k, opposite]| {
        let normal = (p[j] - p[i]).cross(p[k] - p[i]);
        let (of_origin, across) = (-p[i].dot(normal), p[opposite] - p[i]);
        let of_opposite = across.dot(normal);
        let thick = of_opposite.abs() > THIN * normal.length() * across.length();
        thick && of_origin * of_opposite > 0.0
    })
}

/// Returns the vertices of the face that comes closest. Tests all faces, because for a flat tetrahedron rounding
/// decides on which side of a face the origin is.
fn on_tetrahedron(p: &[DVec3; 4]) -> Carriers {
    nearest_of(p, FACES.map(|[i, j, k, _]| on_triangle(p, [i, j, k])))
}
