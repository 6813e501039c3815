//! Quickhull (Barber, Dobkin and Huhdanpaa, "The Quickhull Algorithm for Convex Hulls", ACM TOMS 1996) in whole
//! numbers, so that the triangles form an exactly convex surface. Points on a face or an edge are dropped.

use super::HullError;
use std::collections::BinaryHeap;

/// Point with coordinates of at most 24 bits: differences, their products and plane heights then fit in 25, 50 and 77
/// bits.
pub(super) type Point = [i64; 3];

/// A triangle on the hull, counter-clockwise from outside.
#[derive(Clone)]
pub(super) struct Triangle {
    pub corners: [u32; 3],
    /// Index of the neighbour across the side from corner k to the next.
    pub neighbors: [u32; 3],
    pub plane: Plane,
    /// Outside points assigned to the triangle, the furthest last.
    outside: Vec<u32>,
    alive: bool,
}

/// Plane `normal · p = offset`, with a normal of any length.
#[derive(Clone)]
pub(super) struct Plane {
    normal: Point,
    offset: i128,
    /// Length of the normal: twice the triangle's area.
    pub length: f64,
}

impl Plane {
    /// True if the angle between the normals is below 90°.
    pub fn faces_like(&self, other: &Self) -> bool {
        dot(self.normal, other.normal) > 0
    }

    /// Outward bend of a polygon at b between a and c, in grid steps; negative if the polygon, seen against the normal,
    /// has a dent at b.
    pub fn bulge(&self, [a, b, c]: [Point; 3]) -> f64 {
        let chord = sub(c, a);
        let turn = cross(sub(b, a), sub(c, b));
        let chord_length = dot(chord, chord) as f64;
        dot(turn, self.normal) as f64 / (self.length * chord_length.sqrt())
    }

    fn through(points: &[Point], [a, b, c]: [u32; 3]) -> Self {
        let [a, b, c] = [a, b, c].map(|i| points[i as usize]);
        let normal = cross(sub(b, a), sub(c, a));
        let square: f64 = normal.iter().map(|&x| x as f64 * x as f64).sum();
        Self { normal, offset: dot(normal, a), length: square.sqrt() }
    }

    /// Returns the height of a point times the normal's length; exact.
    fn height(&self, p: Point) -> i128 {
        dot(self.normal, p) - self.offset
    }

    /// Returns the height of a point, in grid steps.
    pub fn distance(&self, p: Point) -> f64 {
        self.height(p) as f64 / self.length
    }
}

fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: Point, b: Point) -> i128 {
    (0..3).map(|k| i128::from(a[k]) * i128::from(b[k])).sum()
}

/// Returns the triangles of the hull of `points`, with at most `budget` (≥ 4) corners. The furthest outside point is
/// always added next, so that dropped points are as little outside as possible.
pub(super) fn hull(points: &[Point], budget: usize) -> Result<Vec<Triangle>, HullError> {
    let mut hull = Growing::simplex(points)?;
    for _ in 4..budget {
        let Some(triangle) = hull.next() else { break };
        hull.take_in_furthest(triangle);
    }
    Ok(hull.finish())
}

struct Growing<'a> {
    points: &'a [Point],
    triangles: Vec<Triangle>,
    /// Triangles with outside points, keyed by the bits of the distance of the furthest; the bits sort like the
    /// distances.
    queue: BinaryHeap<(u64, u32)>,
}

impl<'a> Growing<'a> {
    /// Returns four points that span a large volume.
    fn simplex(points: &'a [Point]) -> Result<Self, HullError> {
        if points.len() < 4 {
            return Err(HullError::TooFewPoints);
        }
        let furthest = |score: &dyn Fn(Point) -> i128| {
            let best = (0..points.len()).max_by_key(|&i| (score(points[i]), core::cmp::Reverse(i)));
            best.filter(|&i| score(points[i]) > 0).map(|i| i as u32)
        };
        // Points are sorted and different, so the first is a corner of the hull.
        let from = points[0];
        let along = furthest(&|p| dot(sub(p, from), sub(p, from))).ok_or(HullError::TooFewPoints)?;
        let line = sub(points[along as usize], from);
        let beside = furthest(&|p| {
            let area = cross(sub(p, from), line);
            dot(area, area)
        });
        let beside = beside.ok_or(HullError::Collinear)?;
        let plane = Plane::through(points, [0, along, beside]);
        let apex = furthest(&|p| plane.height(p).abs()).ok_or(HullError::Coplanar)?;
        let (b, c) = if plane.height(points[apex as usize]) < 0 { (along, beside) } else { (beside, along) };
        let mut hull = Self { points, triangles: Vec::new(), queue: BinaryHeap::new() };
        for corners in [[0, b, c], [apex, b, 0], [apex, c, b], [apex, 0, c]] {
            hull.push(corners, [0; 3]);
        }
        hull.link_simplex();
        hull.share_out((0..points.len() as u32).collect(), 0);
        Ok(hull)
    }

    /// Sets the neighbours of the first four triangles by their sides.
    fn link_simplex(&mut self) {
        for i in 0..4 {
            for k in 0..3 {
                let [from, to] = side(&self.triangles[i], k);
                let across = |t: &Triangle| (0..3).any(|m| side(t, m) == [to, from]);
                let neighbor = self.triangles.iter().position(across).expect("a tetrahedron is closed");
                self.triangles[i].neighbors[k] = neighbor as u32;
            }
        }
    }

    fn push(&mut self, corners: [u32; 3], neighbors: [u32; 3]) {
        let plane = Plane::through(self.points, corners);
        self.triangles.push(Triangle { corners, neighbors, plane, outside: Vec::new(), alive: true });
    }

    /// Assigns each point to one of the triangles from index `first` on whose plane it is outside; drops points that
    /// are outside none of them.
    fn share_out(&mut self, orphans: Vec<u32>, first: usize) {
        let points = self.points;
        for i in orphans {
            let p = points[i as usize];
            if let Some(seen) = self.triangles[first..].iter_mut().find(|t| t.plane.height(p) > 0) {
                seen.outside.push(i);
            }
        }
        for (index, triangle) in self.triangles.iter_mut().enumerate().skip(first) {
            let height = |&k: &usize| triangle.plane.height(points[triangle.outside[k] as usize]);
            let best = (0..triangle.outside.len()).max_by_key(|k| (height(k), core::cmp::Reverse(*k)));
            if let Some(k) = best {
                let distance = triangle.plane.distance(points[triangle.outside[k] as usize]);
                let last = triangle.outside.len() - 1;
                triangle.outside.swap(k, last);
                self.queue.push((distance.to_bits(), index as u32));
            }
        }
    }

    /// Returns the triangle with the furthest outside point.
    fn next(&mut self) -> Option<u32> {
        while let Some((_, triangle)) = self.queue.pop() {
            if self.triangles[triangle as usize].alive {
                return Some(triangle);
            }
        }
        None
    }

    /// Replaces all triangles visible from the furthest point of `seed` by triangles between that point and the
    /// horizon.
    fn take_in_furthest(&mut self, seed: u32) {
        let apex =
            self.triangles[seed as usize].outside.pop().expect("a queued triangle has an outside point");
        let p = self.points[apex as usize];
        let (mut horizon, mut orphans, mut open) = (Vec::new(), Vec::new(), vec![seed]);
        self.triangles[seed as usize].alive = false;
        while let Some(index) = open.pop() {
            orphans.append(&mut self.triangles[index as usize].outside);
            for k in 0..3 {
                let beyond = self.triangles[index as usize].neighbors[k];
                let neighbor = &mut self.triangles[beyond as usize];
                if !neighbor.alive {
                    continue;
                }
                if neighbor.plane.height(p) > 0 {
                    neighbor.alive = false;
                    open.push(beyond);
                } else {
                    horizon.push((side(&self.triangles[index as usize], k), beyond));
                }
            }
        }
        self.close(apex, &horizon);
        self.share_out(orphans, self.triangles.len() - horizon.len());
    }

    /// Adds a triangle for each side of the horizon, which is one ring.
    fn close(&mut self, apex: u32, horizon: &[([u32; 2], u32)]) {
        let first = self.triangles.len();
        let mut starts: Vec<(u32, u32)> = Vec::with_capacity(horizon.len());
        for (k, &([from, to], beyond)) in horizon.iter().enumerate() {
            starts.push((from, (first + k) as u32));
            self.push([from, to, apex], [beyond, 0, 0]);
            let neighbor = &mut self.triangles[beyond as usize];
            let k_there = (0..3).find(|&m| side(neighbor, m) == [to, from]).expect("neighbours share a side");
            neighbor.neighbors[k_there] = (first + k) as u32;
        }
        starts.sort_unstable();
        for k in first..self.triangles.len() {
            let to = self.triangles[k].corners[1];
            let at = starts.binary_search_by_key(&to, |s| s.0).expect("the horizon is a ring");
            let next = starts[at].1;
            self.triangles[k].neighbors[1] = next;
            self.triangles[next as usize].neighbors[2] = k as u32;
        }
    }

    /// Returns the remaining triangles, renumbered.
    fn finish(self) -> Vec<Triangle> {
        let mut number = vec![u32::MAX; self.triangles.len()];
        let alive = |t: &&Triangle| t.alive;
        let living = self.triangles.iter().enumerate().filter(|(_, t)| t.alive);
        for (new, (old, _)) in living.enumerate() {
            number[old] = new as u32;
        }
        let mut triangles: Vec<Triangle> = self.triangles.iter().filter(alive).cloned().collect();
        for triangle in &mut triangles {
            triangle.neighbors = triangle.neighbors.map(|n| number[n as usize]);
        }
        triangles
    }
}

/// Returns the corner indices of the side from corner k to the next.
pub(super) fn side(triangle: &Triangle, k: usize) -> [u32; 2] {
    [triangle.corners[k], triangle.corners[(k + 1) % 3]]
}
