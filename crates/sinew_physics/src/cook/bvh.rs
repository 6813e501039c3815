//! A tree of bounds over triangles: the closest point of a mesh, and how often it winds around a point.

use crate::boxes::Aabb;
use sinew_math::{Vec3, abs3, max3, min3, normalize_or, trig};

/// Triangles in a leaf.
const LEAF: usize = 4;
/// A cluster counts as one dipole beyond this many of its radii (Barill et al. 2018 use 2).
const FAR: f32 = 2.0;
/// More levels than a balanced tree of 2³² leaves has.
const DEPTH: usize = 40;

/// A triangle mesh that answers where its surface is closest, and whether a point is inside.
#[derive(Clone, Debug)]
pub struct MeshBvh {
    nodes: Vec<Node>,
    /// Corners, in the order of leaves.
    triangles: Vec<[Vec3; 3]>,
    /// Number of each of them in the list that the tree was made from.
    numbers: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Aabb,
    /// First triangle of a leaf, else index of the second child; the first follows its parent.
    next: u32,
    /// Triangles of a leaf, 0 for an inner node.
    count: u32,
    /// Sum of areas times normals.
    dipole: Vec3,
    /// Its place: mean of the triangles' middles, by area.
    center: Vec3,
    /// Of the ball around `center` that holds all triangles.
    radius: f32,
}

/// The point of a mesh that is closest to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint {
    /// On the surface, metres.
    pub point: Vec3,
    /// From the point asked for, metres, ≥ 0.
    pub distance: f32,
    /// Of the triangle, unit, to the side from which its corners run counter-clockwise.
    pub normal: Vec3,
    /// Number of the triangle.
    pub triangle: u32,
}

impl MeshBvh {
    /// From triangles, by their corners in metres.
    ///
    /// # Panics
    /// If there is none, or a corner is not finite.
    pub fn new(triangles: &[[Vec3; 3]]) -> Self {
        assert!(!triangles.is_empty(), "a mesh has triangles");
        assert!(triangles.iter().flatten().all(|p| p.is_finite()), "corners are finite");
        let mut numbers: Vec<u32> = (0..triangles.len() as u32).collect();
        let mut nodes = Vec::with_capacity(triangles.len());
        grow(triangles, &mut numbers, 0, &mut nodes);
        let triangles = numbers.iter().map(|&i| triangles[i as usize]).collect();
        Self { nodes, triangles, numbers }
    }

    /// How many triangles there are.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Never: a mesh has triangles.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// The point of the surface closest to `p`; of several the one found first, always the same.
    pub fn closest_point(&self, p: Vec3) -> ClosestPoint {
        let (square, point, at) = self.search(p, f32::INFINITY);
        self.answer(square, point, at)
    }

    /// [`closest_point`](Self::closest_point), if it is nearer than `reach`, metres: faster where most is farther.
    pub fn closest_point_within(&self, p: Vec3, reach: f32) -> Option<ClosestPoint> {
        let (square, point, at) = self.search(p, reach * reach);
        (square < reach * reach).then(|| self.answer(square, point, at))
    }

    fn answer(&self, square: f32, point: Vec3, at: u32) -> ClosestPoint {
        let [a, b, c] = self.triangles[at as usize];
        let normal = normalize_or((b - a).cross(c - a), Vec3::Y);
        ClosestPoint { point, distance: square.sqrt(), normal, triangle: self.numbers[at as usize] }
    }

    /// The closest point, its squared distance, if that is less than `square`, and the triangle's place.
    fn search(&self, p: Vec3, square: f32) -> (f32, Vec3, u32) {
        let mut best = (square, Vec3::ZERO, 0);
        let mut open = [(0_u32, 0.0_f32); DEPTH];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (index, beyond) = open[count];
            if beyond >= best.0 {
                continue;
            }
            let node = &self.nodes[index as usize];
            if node.count > 0 {
                for at in node.next..node.next + node.count {
                    let point = closest_on_triangle(&self.triangles[at as usize], p);
                    let square = (point - p).length_squared();
                    if square < best.0 {
                        best = (square, point, at);
                    }
                }
                continue;
            }
            let [near, far] = [index + 1, node.next].map(|i| (i, self.square_to(i, p)));
            let (near, far) = if far.1 < near.1 { (far, near) } else { (near, far) };
            open[count] = far;
            open[count + 1] = near;
            count += 2;
        }
        best
    }

    fn square_to(&self, node: u32, p: Vec3) -> f32 {
        let bounds = &self.nodes[node as usize].bounds;
        let outside = max3(max3(bounds.min - p, p - bounds.max), Vec3::ZERO);
        outside.length_squared()
    }

    /// The generalised winding number of the surface around `p`: 1 inside a closed mesh, 0 outside, between them where
    /// it has holes; negative where its faces look inward (Jacobson, Kavan & Sorkine-Hornung 2013; distant clusters
    /// as dipoles, Barill, Dickson, Schmidt, Levin & Jacobson 2018, eq. 6).
    pub fn winding_number(&self, p: Vec3) -> f32 {
        let mut solid_angle = 0.0;
        let mut open = [0_u32; DEPTH];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let index = open[count];
            let node = &self.nodes[index as usize];
            let away = node.center - p;
            let distance = away.length();
            if distance > FAR * node.radius {
                solid_angle += node.dipole.dot(away) / (distance * distance * distance);
            } else if node.count > 0 {
                let triangles = &self.triangles[node.next as usize..(node.next + node.count) as usize];
                solid_angle += triangles.iter().map(|triangle| solid_angle_of(triangle, p)).sum::<f32>();
            } else {
                open[count] = node.next;
                open[count + 1] = index + 1;
                count += 2;
            }
        }
        solid_angle / (4.0 * core::f32::consts::PI)
    }
}

/// Appends the tree over the triangles `numbers`, the first of which is the leaves' number `offset`.
fn grow(triangles: &[[Vec3; 3]], numbers: &mut [u32], offset: u32, nodes: &mut Vec<Node>) {
    let place = nodes.len();
    let mut node = summary(triangles, numbers);
    node.next = offset;
    node.count = numbers.len() as u32;
    nodes.push(node);
    if numbers.len() <= LEAF {
        return;
    }
    let axis = longest_axis(node.bounds.max - node.bounds.min);
    let middle = |i: &u32| {
        let [a, b, c] = triangles[*i as usize];
        a[axis] + b[axis] + c[axis]
    };
    // Halves by number: the depth stays that of a balanced tree, whatever the mesh.
    let half = numbers.len() / 2;
    numbers.select_nth_unstable_by(half, |i, j| middle(i).total_cmp(&middle(j)).then(i.cmp(j)));
    let (low, high) = numbers.split_at_mut(half);
    grow(triangles, low, offset, nodes);
    nodes[place].next = nodes.len() as u32;
    nodes[place].count = 0;
    grow(triangles, high, offset + half as u32, nodes);
}

fn longest_axis(extent: Vec3) -> usize {
    let longer = |a: usize, b: usize| if extent[b] > extent[a] { b } else { a };
    longer(longer(0, 1), 2)
}

fn summary(triangles: &[[Vec3; 3]], numbers: &[u32]) -> Node {
    let first = triangles[numbers[0] as usize][0];
    let mut bounds = Aabb { min: first, max: first };
    let (mut dipole, mut moment, mut area) = (Vec3::ZERO, Vec3::ZERO, 0.0);
    for &number in numbers {
        let [a, b, c] = triangles[number as usize];
        bounds.min = min3(min3(bounds.min, a), min3(b, c));
        bounds.max = max3(max3(bounds.max, a), max3(b, c));
        let normal = (b - a).cross(c - a) * 0.5;
        let size = normal.length();
        dipole += normal;
        moment += (a + b + c) * (size / 3.0);
        area += size;
    }
    let center = if area > 0.0 { moment / area } else { bounds.center() };
    let reach = max3(abs3(bounds.max - center), abs3(bounds.min - center));
    Node { bounds, next: 0, count: 0, dipole, center, radius: reach.length() }
}

/// Solid angle of a triangle seen from `p`, positive where it turns its back (van Oosterom & Strackee 1983, eq. 8).
fn solid_angle_of(triangle: &[Vec3; 3], p: Vec3) -> f32 {
    let [a, b, c] = triangle.map(|corner| corner - p);
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let numerator = a.dot(b.cross(c));
    let denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * trig::atan2(numerator, denominator)
}

/// The point of a triangle closest to `p`, by the region of its plane that p lies over (Ericson 2005, §5.1.5).
fn closest_on_triangle(&[a, b, c]: &[Vec3; 3], p: Vec3) -> Vec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let scale = 1.0 / (va + vb + vc);
    a + ab * (vb * scale) + ac * (vc * scale)
}
