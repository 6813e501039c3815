//! Depth of two overlapping cores: the distance from the origin to the surface of their Minkowski difference. A
//! polytope expands toward the closest face of that surface (van den Bergen, "Proximity queries and penetration depth
//! computation on 3D game objects", GDC 2001).

use super::gjk::{self, Bridge, Cores, Simplex, Vertex, support};
use super::support::{Posed, Support};
use sinew_math::DVec3;

/// Share of the sizes by which the depth may differ from its lower bound.
const PRECISION: f64 = 1e-9;
/// Height, as a share of the sizes, below which a triangle or tetrahedron is flat.
const FLAT: f64 = 1e-9;
/// Height over a face, as a share of the sizes, below which a vertex counts as in the plane of the face.
const COPLANAR: f64 = 1e-13;
const MOST_VERTICES: usize = 96;
const MOST_FACES: usize = 2 * MOST_VERTICES;
/// Largest number of sides of the hole that a new vertex makes.
const MOST_SIDES: usize = 64;
/// Largest number of improvements of a round core's direction after the polytope is full.
const MOST_REFINEMENTS: usize = 32;

/// Largest number of restart directions of a full polytope, at least 25° from each other.
const MOST_STARTS: usize = 8;
const SAME_START: f64 = 0.9;
/// Gap to which cores are moved apart to find a better direction, as a share of the sizes. It is large enough that
/// rounding does not dominate the gap.
const BEYOND: f64 = 0.05;
/// Largest number of doublings of each change of direction.
const MOST_DOUBLINGS: u32 = 24;

#[derive(Clone, Copy, Default)]
struct Face {
    corners: [usize; 3],
    /// Unit normal, outward; 0 for a face without area, which only closes the polytope.
    normal: DVec3,
    /// Distance of the face's plane from the origin; infinite for a face without area.
    distance: f64,
}

/// A convex polytope inside the Minkowski difference.
struct Polytope {
    vertices: [Vertex; MOST_VERTICES],
    vertex_count: usize,
    faces: [Face; MOST_FACES],
    face_count: usize,
    size: f64,
}

/// Returns the shortest way out for two cores whose simplex contains the origin: the distance is 0 or negative, and B
/// moved by the depth along the normal touches A.
pub(super) fn deepest<A: Support, B: Support>(
    a: &Posed<'_, A>,
    b: &Posed<'_, B>,
    simplex: &Simplex,
) -> Bridge {
    let size = f64::from(a.solid.reach()) + f64::from(b.solid.reach());
    let corners = match tetrahedron(a, b, simplex, size) {
        Ok(corners) => corners,
        Err(flat) => return flat,
    };
    let mut polytope = Polytope::new(corners, size);
    let mut best: Option<Bridge> = None;
    let mut bound = 0.0;
    while let Some(face) = polytope.nearest_face() {
        let vertex = support(a, b, face.normal);
        let height = vertex.difference.dot(face.normal);
        bound = if face.distance > bound { face.distance } else { bound };
        let closed = height - face.distance <= PRECISION * size;
        if closed || best.is_none_or(|best| height < -best.distance) {
            best = Some(polytope.bridge(&face, height));
        }
        if closed || !polytope.grow(vertex) {
            break;
        }
    }
    let best = best.unwrap_or_else(|| touching(simplex, DVec3::Y));
    if best.distance > -2.0 * gjk::TOUCH * size {
        // The cores touch: the closest points that GJK found are the contact.
        let [on_a, on_b] = simplex.touching_ends();
        return Bridge { on_a, on_b, ..best };
    }
    if -best.distance - bound <= PRECISION * size {
        return best;
    }
    // Round cores have filled the polytope. Its remaining faces may still give shorter directions.
    let mut best = refined(a, b, best, size);
    let mut tried = [best.normal; MOST_STARTS];
    for count in 1..MOST_STARTS {
        let Some(face) = polytope.untried(&tried[..count], -best.distance) else { break };
        tried[count] = face.normal;
        let height = support(a, b, face.normal).difference.dot(face.normal);
        let other = refined(a, b, polytope.bridge(&face, height), size);
        if other.distance > best.distance {
            best = other;
        }
    }
    best
}

/// Improves the best direction of a full polytope if the cores are round. Moves B out along the direction, slightly
/// beyond contact. If the cores' gap then has a different direction, that direction is a shorter way out. Nearly
/// concentric round cores are nearly equally deep in all directions, so the change of direction is doubled while that
/// reduces the depth.
fn refined<A: Support, B: Support>(
    a: &Posed<'_, A>,
    b: &Posed<'_, B>,
    mut best: Bridge,
    size: f64,
) -> Bridge {
    let depth = |normal: DVec3| support(a, b, normal).difference.dot(normal);
    for _ in 0..MOST_REFINEMENTS {
        let way = best.normal * (BEYOND * size - best.distance);
        let moved = Posed { solid: b.solid, axes: b.axes, center: b.center + way };
        let Cores::Apart(gap) = gjk::closest(a, &moved) else { break };
        let (mut normal, mut height) = (gap.normal, depth(gap.normal));
        let aside = normal - best.normal * normal.dot(best.normal);
        for doubling in 1..MOST_DOUBLINGS {
            let further = (best.normal + aside * f64::from(1u32 << doubling)).normalize();
            let its_height = depth(further);
            if its_height >= height {
                break;
            }
            (normal, height) = (further, its_height);
        }
        let gained = -best.distance - height;
        if gained <= 0.0 {
            break;
        }
        best = Bridge { on_a: gap.on_a, on_b: gap.on_b - way, distance: -height, normal };
        if gained <= PRECISION * size {
            break;
        }
    }
    best
}

/// Returns the contact of cores that touch without common interior, with the normal `normal`.
fn touching(simplex: &Simplex, normal: DVec3) -> Bridge {
    let Vertex { on_a, on_b, .. } = simplex.vertices[0];
    Bridge { on_a, on_b, distance: 0.0, normal }
}

/// Returns four non-coplanar points of the difference: those of the simplex, and others if there are too few. A flat
/// difference has no depth; then the error is the contact along its normal.
fn tetrahedron<A: Support, B: Support>(
    a: &Posed<'_, A>,
    b: &Posed<'_, B>,
    simplex: &Simplex,
    size: f64,
) -> Result<[Vertex; 4], Bridge> {
    let flat = FLAT * size;
    let p0 = simplex.vertices[0];
    let known = &simplex.vertices[..simplex.count];
    let furthest = |directions: &[DVec3], least: f64, distance: &dyn Fn(DVec3) -> f64| {
        let asked = directions.iter().flat_map(|d| [*d, -*d]).map(|d| support(a, b, d));
        let all = known.iter().copied().chain(asked);
        let far = |x: Vertex, y: Vertex| {
            if distance(y.difference) > distance(x.difference) { y } else { x }
        };
        all.reduce(far).filter(|vertex| distance(vertex.difference) > least)
    };
    let from_point = |p: DVec3| (p - p0.difference).length();
    let Some(p1) = furthest(&[DVec3::X, DVec3::Y, DVec3::Z], flat, &from_point) else {
        return Err(touching(simplex, DVec3::Y));
    };
    let along = (p1.difference - p0.difference).normalize();
    let (u, v) = across(along);
    let from_line = |p: DVec3| (p - p0.difference).cross(along).length();
    // Far enough from the line to make a triangle with an area (no side is twice as long as the first).
    let Some(p2) = furthest(&[u, v, u + v, u - v], 4.0 * flat, &from_line) else {
        return Err(touching(simplex, u));
    };
    let normal = along.cross(p2.difference - p0.difference).normalize();
    let from_plane = |p: DVec3| (p - p0.difference).dot(normal).abs();
    let Some(p3) = furthest(&[normal], flat, &from_plane) else {
        return Err(touching(simplex, normal));
    };
    Ok([p0, p1, p2, p3])
}

/// Returns two unit vectors perpendicular to a unit vector and to each other.
fn across(n: DVec3) -> (DVec3, DVec3) {
    let (x, y, z) = (n.x.abs(), n.y.abs(), n.z.abs());
    let axis = if x <= y && x <= z {
        DVec3::X
    } else if y <= z {
        DVec3::Y
    } else {
        DVec3::Z
    };
    let u = n.cross(axis).normalize();
    (u, n.cross(u))
}

impl Polytope {
    fn new(corners: [Vertex; 4], size: f64) -> Self {
        let mut polytope = Self {
            vertices: [Vertex::default(); MOST_VERTICES],
            vertex_count: 4,
            faces: [Face::default(); MOST_FACES],
            face_count: 0,
            size,
        };
        polytope.vertices[..4].copy_from_slice(&corners);
        let [a, b, c, d] = corners.map(|vertex| vertex.difference);
        // Corners are counter-clockwise seen from outside.
        let turned = (b - a).cross(c - a).dot(d - a) > 0.0;
        for [i, j, k] in [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]] {
            polytope.push_face(if turned { [i, k, j] } else { [i, j, k] });
        }
        polytope
    }

    fn push_face(&mut self, corners: [usize; 3]) {
        let [a, b, c] = corners.map(|index| self.vertices[index].difference);
        let across = (b - a).cross(c - a);
        let doubled_area = across.length();
        let longest = (b - a).length() + (c - a).length();
        self.faces[self.face_count] = if doubled_area > FLAT * self.size * longest {
            let normal = across / doubled_area;
            Face { corners, normal, distance: normal.dot(a) }
        } else {
            Face { corners, normal: DVec3::ZERO, distance: f64::INFINITY }
        };
        self.face_count += 1;
    }

    /// Returns the face whose plane has the smallest signed distance from the origin; the first among equals. `None` if
    /// no face has an area.
    fn nearest_face(&self) -> Option<Face> {
        let nearer = |x: Face, y: Face| if y.distance < x.distance { y } else { x };
        let faces = self.faces[..self.face_count].iter().copied();
        faces.reduce(nearer).filter(|face| face.distance < f64::INFINITY)
    }

    /// Returns the nearest face whose plane is closer than `distance`, in a direction that has not been tried.
    fn untried(&self, tried: &[DVec3], distance: f64) -> Option<Face> {
        let new = |face: &&Face| tried.iter().all(|other| other.dot(face.normal) < SAME_START);
        let faces = self.faces[..self.face_count].iter().filter(|face| face.distance < distance);
        faces.filter(new).copied().reduce(|x, y| if y.distance < x.distance { y } else { x })
    }

    /// Returns the way out along a face's normal. The points belong to the origin's projection, in the coplanar face
    /// that contains the projection or comes closest to it.
    fn bridge(&self, face: &Face, height: f64) -> Bridge {
        let image = face.normal * face.distance;
        let plane = |other: &&Face| {
            (other.distance - face.distance).abs() <= PRECISION * self.size
                && other.normal.dot(face.normal) > 1.0 - PRECISION
        };
        let least = |weights: &[f64; 3]| {
            let lesser = |x: f64, y: f64| if y < x { y } else { x };
            weights.iter().copied().fold(f64::INFINITY, lesser)
        };
        let in_plane = self.faces[..self.face_count].iter().filter(plane);
        let weighted = in_plane.map(|other| (other, self.weights(other, image)));
        let holder = weighted.reduce(|x, y| if least(&y.1) > least(&x.1) { y } else { x });
        let (carrier, weights) = holder.unwrap_or((face, [1.0, 0.0, 0.0]));
        // If the projection is beside all faces, use the nearest combination of corners.
        let weights = weights.map(|weight| if weight > 0.0 { weight } else { 0.0 });
        let sum = weights[0] + weights[1] + weights[2];
        let mixed = |of: fn(&Vertex) -> DVec3| {
            let terms = carrier.corners.iter().zip(weights);
            terms.fold(DVec3::ZERO, |at, (&index, weight)| at + of(&self.vertices[index]) * (weight / sum))
        };
        Bridge {
            on_a: mixed(|vertex| vertex.on_a),
            on_b: mixed(|vertex| vertex.on_b),
            distance: -height,
            normal: face.normal,
        }
    }

    /// Barycentric weights of a point in the face's plane; a weight is negative beyond the side opposite its corner.
    fn weights(&self, face: &Face, point: DVec3) -> [f64; 3] {
        let [a, b, c] = face.corners.map(|index| self.vertices[index].difference - point);
        let areas = [b.cross(c), c.cross(a), a.cross(b)].map(|area| area.dot(face.normal));
        let sum = areas[0] + areas[1] + areas[2];
        areas.map(|area| area / sum)
    }

    /// Adds a vertex: the faces visible from it are replaced by faces to their outline. Returns false, with an unusable
    /// polytope, if there is no room.
    fn grow(&mut self, vertex: Vertex) -> bool {
        if self.vertex_count == MOST_VERTICES {
            return false;
        }
        let new = self.vertex_count;
        self.vertices[new] = vertex;
        self.vertex_count += 1;

        let mut outline = [(0, 0); MOST_SIDES];
        let mut sides = 0;
        let mut kept = 0;
        for index in 0..self.face_count {
            let face = self.faces[index];
            if vertex.difference.dot(face.normal) - face.distance <= COPLANAR * self.size {
                self.faces[kept] = face;
                kept += 1;
                continue;
            }
            let [i, j, k] = face.corners;
            for side in [(i, j), (j, k), (k, i)] {
                // A side between two removed faces is found once in each direction.
                if let Some(at) = outline[..sides].iter().position(|other| *other == (side.1, side.0)) {
                    sides -= 1;
                    outline[at] = outline[sides];
                } else if sides < MOST_SIDES {
                    outline[sides] = side;
                    sides += 1;
                } else {
                    return false;
                }
            }
        }
        self.face_count = kept;
        if sides < 3 || kept + sides > MOST_FACES {
            return false;
        }
        for &(i, j) in &outline[..sides] {
            self.push_face([i, j, new]);
        }
        true
    }
}
