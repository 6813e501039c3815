//! Tree of bounds over triangles, for the closest point of a mesh and its winding number around a point.

use crate::boxes::Aabb;
use crate::triangles::{Branch, DEPTH, Tree, closest_on_triangle, normal};
use core::ops::Range;
use sinew_math::{Vec3, abs3, max3, trig};

/// Distance, in radii of a cluster, beyond which the cluster is approximated by one dipole (Barill et al. 2018 use 2).
const FAR: f32 = 2.0;

/// A triangle mesh with queries for the closest point of its surface, and for whether a point is inside.
#[derive(Clone, Debug)]
pub struct MeshBvh {
    tree: Tree,
    /// Cluster of the triangles below each tree node.
    clusters: Vec<Cluster>,
    /// Corners of the triangles, in leaf order.
    triangles: Vec<[Vec3; 3]>,
    /// Indices of the triangles in the original list, in leaf order.
    numbers: Vec<u32>,
}

/// Dipole of a cluster of triangles.
#[derive(Clone, Copy, Debug, Default)]
struct Cluster {
    /// Sum of the triangles' areas times their normals, m².
    dipole: Vec3,
    area: f32,
    /// Area-weighted mean of the triangles' centroids.
    center: Vec3,
    /// Radius of a ball around `center` that contains all triangles, metres.
    radius: f32,
}

/// Closest point of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint {
    /// Point on the surface, metres.
    pub point: Vec3,
    /// Distance from the query point, metres, ≥ 0.
    pub distance: f32,
    /// Unit normal of the triangle, on the side from which its corners are counter-clockwise.
    pub normal: Vec3,
    /// Index of the triangle.
    pub triangle: u32,
}

impl MeshBvh {
    /// Builds the tree from triangles, given by their corners in metres.
    ///
    /// # Panics
    /// If there is no triangle, or a corner is not finite.
    pub fn new(triangles: &[[Vec3; 3]]) -> Self {
        assert!(!triangles.is_empty(), "a mesh has triangles");
        assert!(triangles.iter().flatten().all(|p| p.is_finite()), "corners are finite");
        let mut numbers: Vec<u32> = (0..triangles.len() as u32).collect();
        let tree = Tree::new(&mut numbers, &|number| triangles[number as usize]);
        let triangles: Vec<[Vec3; 3]> = numbers.iter().map(|&i| triangles[i as usize]).collect();
        let clusters = clusters(&tree, &triangles);
        Self { tree, clusters, triangles, numbers }
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Always false: a mesh has triangles.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Returns the point of the surface closest to `p`; if there are several, the choice is deterministic.
    pub fn closest_point(&self, p: Vec3) -> ClosestPoint {
        let (square, point, at) = self.search(p, f32::INFINITY);
        self.answer(square, point, at)
    }

    /// Returns [`closest_point`](Self::closest_point) if it is nearer than `reach`, metres; faster if most of the mesh
    /// is farther.
    pub fn closest_point_within(&self, p: Vec3, reach: f32) -> Option<ClosestPoint> {
        let (square, point, at) = self.search(p, reach * reach);
        (square < reach * reach).then(|| self.answer(square, point, at))
    }

    fn answer(&self, square: f32, point: Vec3, at: u32) -> ClosestPoint {
        let normal = normal(&self.triangles[at as usize]);
        ClosestPoint { point, distance: square.sqrt(), normal, triangle: self.numbers[at as usize] }
    }

    /// Returns the squared distance, the closest point and the triangle's index, if that distance is below `square`;
    /// otherwise `square`, zero and 0.
    fn search(&self, p: Vec3, square: f32) -> (f32, Vec3, u32) {
        let mut best = (square, Vec3::ZERO, 0);
        self.tree.nearest(p, square, |places| {
            for at in places {
                let (point, _) = closest_on_triangle(&self.triangles[at as usize], p);
                let square = (point - p).length_squared();
                if square < best.0 {
                    best = (square, point, at);
                }
            }
            best.0
        });
        best
    }

    /// Generalised winding number of the surface around `p`: 1 inside a closed mesh, 0 outside, a value between them
    /// near holes; negative if the faces point inward (Jacobson, Kavan & Sorkine-Hornung 2013; distant clusters as
    /// dipoles, Barill, Dickson, Schmidt, Levin & Jacobson 2018, eq. 6).
    pub fn winding_number(&self, p: Vec3) -> f32 {
        let mut solid_angle = 0.0;
        let mut open = [0_u32; DEPTH];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let Cluster { dipole, center, radius, .. } = self.clusters[open[count] as usize];
            let away = center - p;
            let distance = away.length();
            if distance > FAR * radius {
                solid_angle += dipole.dot(away) / (distance * distance * distance);
                continue;
            }
            match self.tree.branch(open[count]) {
                Branch::Leaf(places) => {
                    let triangles = triangles_in(&self.triangles, places);
                    solid_angle += triangles.iter().map(|triangle| solid_angle_of(triangle, p)).sum::<f32>();
                }
                Branch::Nodes([first, second]) => {
                    open[count] = second;
                    open[count + 1] = first;
                    count += 2;
                }
            }
        }
        solid_angle / (4.0 * core::f32::consts::PI)
    }
}

fn triangles_in(triangles: &[[Vec3; 3]], places: Range<u32>) -> &[[Vec3; 3]] {
    &triangles[places.start as usize..places.end as usize]
}

/// Returns the clusters of the nodes of a tree over triangles in leaf order.
fn clusters(tree: &Tree, triangles: &[[Vec3; 3]]) -> Vec<Cluster> {
    let mut clusters = vec![Cluster::default(); tree.len()];
    // Nodes below a node have higher numbers.
    for node in (0..tree.len() as u32).rev() {
        let bounds = tree.bounds_below(node);
        clusters[node as usize] = match tree.branch(node) {
            Branch::Leaf(places) => Cluster::of(triangles_in(triangles, places), &bounds),
            Branch::Nodes(both) => Cluster::join(both.map(|index| clusters[index as usize]), &bounds),
        };
    }
    clusters
}

impl Cluster {
    fn of(triangles: &[[Vec3; 3]], bounds: &Aabb) -> Self {
        let (mut dipole, mut moment, mut area) = (Vec3::ZERO, Vec3::ZERO, 0.0);
        for &[a, b, c] in triangles {
            let normal = (b - a).cross(c - a) * 0.5;
            let size = normal.length();
            dipole += normal;
            moment += (a + b + c) * (size / 3.0);
            area += size;
        }
        Self::within(bounds, dipole, moment, area)
    }

    fn join([a, b]: [Self; 2], bounds: &Aabb) -> Self {
        let moment = a.center * a.area + b.center * b.area;
        Self::within(bounds, a.dipole + b.dipole, moment, a.area + b.area)
    }

    fn within(bounds: &Aabb, dipole: Vec3, moment: Vec3, area: f32) -> Self {
        let center = if area > 0.0 { moment / area } else { bounds.center() };
        let reach = max3(abs3(bounds.max - center), abs3(bounds.min - center));
        Self { dipole, area, center, radius: reach.length() }
    }
}

/// Solid angle of a triangle seen from `p`, positive if it faces away (van Oosterom & Strackee 1983, eq. 8).
fn solid_angle_of(triangle: &[Vec3; 3], p: Vec3) -> f32 {
    let [a, b, c] = triangle.map(|corner| corner - p);
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let numerator = a.dot(b.cross(c));
    let denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * trig::atan2(numerator, denominator)
}
