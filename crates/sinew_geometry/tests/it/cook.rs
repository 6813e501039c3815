//! Cooking of meshes to boxes: closed forms, brute force, invalid input.

use sinew_geometry::boxes::Cuboid;
use sinew_geometry::cook::{CookError, CookOptions, Cooked, MeshBvh, cook};
use sinew_geometry::{Obb, Shape};
use sinew_math::{Mat3, Random, Rotation, Vec3, trig};

/// Vertices and triangles, counter-clockwise seen from outside.
#[derive(Clone, Default)]
struct Mesh {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl Mesh {
    fn polygon(&mut self, corners: &[Vec3]) {
        let first = self.positions.len() as u32;
        self.positions.extend(corners);
        self.triangles.extend((1..corners.len() as u32 - 1).map(|k| [first, first + k, first + k + 1]));
    }

    /// Adds a box without the faces `left_out` (−x, +x, −y, +y, −z, +z).
    fn block(&mut self, center: Vec3, half: Vec3, rotation: Rotation, left_out: &[usize]) {
        const FACES: [[usize; 4]; 6] =
            [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        for (_, face) in FACES.iter().enumerate().filter(|(i, _)| !left_out.contains(i)) {
            let sign = |i: usize, bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
            let corner =
                |&i: &usize| center + rotation * (half * Vec3::new(sign(i, 0), sign(i, 1), sign(i, 2)));
            self.polygon(&face.iter().map(corner).collect::<Vec<_>>());
        }
    }

    /// Extrudes an outline in x and y (counter-clockwise, in convex pieces) along z from 0 to `depth`.
    fn prism(outline: &[[f32; 2]], pieces: &[&[usize]], depth: f32) -> Self {
        let mut mesh = Self::default();
        let at = |i: usize, z: f32| Vec3::new(outline[i][0], outline[i][1], z);
        for piece in pieces {
            mesh.polygon(&piece.iter().map(|&i| at(i, depth)).collect::<Vec<_>>());
            mesh.polygon(&piece.iter().rev().map(|&i| at(i, 0.0)).collect::<Vec<_>>());
        }
        for i in 0..outline.len() {
            let j = (i + 1) % outline.len();
            mesh.polygon(&[at(i, 0.0), at(j, 0.0), at(j, depth), at(i, depth)]);
        }
        mesh
    }

    fn sphere(radius: f32, rings: u32) -> Self {
        let mut mesh = Self::default();
        let around = 2 * rings;
        let at = |i: u32, j: u32| {
            let turn = |k: u32| trig::sin_cos(core::f32::consts::PI * k as f32 / rings as f32);
            let ((su, cu), (sv, cv)) = (turn(i), turn(j));
            Vec3::new(su * cv, cu, -su * sv) * radius
        };
        for i in 0..rings {
            for j in 0..around {
                mesh.polygon(&[at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        mesh
    }

    fn cook(&self, max_boxes: usize) -> Cooked {
        let options = CookOptions { max_boxes, ..CookOptions::default() };
        let cooked = cook(&self.positions, &self.triangles, &options, &mut |_| {}).expect("a good mesh");
        assert!((1..=max_boxes).contains(&cooked.boxes.len()), "{} boxes", cooked.boxes.len());
        cooked
    }

    fn corners(&self) -> Vec<[Vec3; 3]> {
        self.triangles.iter().map(|t| t.map(|i| self.positions[i as usize])).collect()
    }
}

/// Returns a closed flight of steps, each `rise` high and `run` deep, descending along x.
fn stairs(steps: usize, rise: f32, run: f32, width: f32) -> Mesh {
    let mut outline = vec![[0.0, 0.0], [steps as f32 * run, 0.0]];
    let mut pieces = Vec::new();
    for step in 0..steps {
        let (x, y) = ((steps - step) as f32 * run, (step + 1) as f32 * rise);
        outline.extend([[x, y], [x - run, y]]);
    }
    // The side of each step as a column; corners on the ground between columns are added to the outline.
    let grounds: Vec<[f32; 2]> = (1..steps).map(|k| [k as f32 * run, 0.0]).collect();
    outline.splice(1..1, grounds);
    for k in 0..steps {
        // Column between ground corners k and k + 1; its top has two corners of the outline.
        let top = 2 * (steps - 1 - k) + steps + 1;
        pieces.push(vec![k, k + 1, top, top + 1]);
    }
    let pieces: Vec<&[usize]> = pieces.iter().map(Vec::as_slice).collect();
    Mesh::prism(&outline, &pieces, width)
}

fn top(block: &Obb) -> f32 {
    block.center.y + block.half_extents.y
}

#[test]
fn rotated_box_becomes_one_equal_box() {
    let mut random = Random::new(1);
    for _ in 0..50 {
        let mut mesh = Mesh::default();
        let (center, rotation) = (random.in_cube() * 20.0, random.rotation());
        let half = random.in_cube() * 0.9 + Vec3::splat(1.0);
        mesh.block(center, half, rotation, &[]);
        let cooked = mesh.cook(150);
        assert_eq!(cooked.boxes.len(), 1);
        assert!(cooked.deviation.distance_max < 1e-3, "{cooked:?}");
        let ratio = cooked.deviation.volume_ratio.expect("the mesh is closed");
        assert!((ratio - 1.0).abs() < 1e-3, "{ratio}");
        assert_eq!(cooked.repairs.open_edges, 0);
    }
}

#[test]
fn l_shape_becomes_two_boxes() {
    let outline = [[0.0, 0.0], [1.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    // The corner on the lower edge is not a corner of the left piece, as in meshes modelled by hand.
    let mesh = Mesh::prism(&outline, &[&[0, 1, 4, 5, 6], &[1, 2, 3, 4]], 1.5);
    let cooked = mesh.cook(150);
    assert_eq!(cooked.boxes.len(), 2, "{cooked:?}");
    assert!(cooked.deviation.distance_max < 1e-3, "{cooked:?}");
    assert!((cooked.deviation.volume_ratio.expect("closed") - 1.0).abs() < 0.01, "{cooked:?}");
}

#[test]
fn stairs_become_one_box_per_step() {
    let mesh = stairs(9, 0.18, 0.28, 1.2);
    let cooked = mesh.cook(150);
    assert!(cooked.deviation.distance_max < 1e-3, "{cooked:?}");
    assert_eq!(cooked.boxes.len(), 9);
    for step in 1..=9 {
        let height = step as f32 * 0.18;
        assert!(
            cooked.boxes.iter().any(|block| (top(block) - height).abs() < 1e-3),
            "no box for step {step}"
        );
    }
}

/// Returns a closed flight of steps whose treads are level except for a worn edge: the last `worn` of the run descends
/// by `drop`.
fn worn_stairs(steps: usize, [rise, run, width]: [f32; 3], worn: f32, drop: f32) -> Mesh {
    let mut outline: Vec<[f32; 2]> = (0..=steps).map(|k| [k as f32 * run, 0.0]).collect();
    for step in 0..steps {
        let (x, y) = ((steps - step) as f32 * run, (step + 1) as f32 * rise);
        outline.extend([[x, y - drop], [x - worn * run, y], [x - run, y]]);
    }
    let pieces: Vec<Vec<usize>> = (0..steps)
        .map(|k| {
            let top = steps + 1 + 3 * (steps - 1 - k);
            vec![k, k + 1, top, top + 1, top + 2]
        })
        .collect();
    let pieces: Vec<&[usize]> = pieces.iter().map(Vec::as_slice).collect();
    Mesh::prism(&outline, &pieces, width)
}

#[test]
fn treads_stay_level_and_keep_their_height() {
    let [rise, run, width] = [0.18, 0.30, 1.2];
    let about = Rotation::from_axis_angle(Vec3::Y, 0.4);
    for (worn, drop) in [(0.0, 0.0), (0.4, 0.02), (0.45, 0.022)] {
        let mut mesh = worn_stairs(6, [rise, run, width], worn, drop);
        for position in &mut mesh.positions {
            *position = about * *position;
        }
        let cooked = mesh.cook(150);
        for step in 0..6 {
            let height = (6 - step) as f32 * rise;
            // Behind the worn part of the tread.
            let at = about * Vec3::new((step as f32 + 0.25) * run, height, 0.5 * width);
            let under = cooked.boxes.iter().filter(|block| block.signed_distance(at - Vec3::Y * 0.04) < 0.0);
            let found = under.map(|block| {
                let up = block.rotation * Vec3::Y;
                (block.center.dot(up) + block.half_extents.y - at.dot(up), up.y)
            });
            let (off, up) = found.fold((f32::NEG_INFINITY, 0.0), |a, b| if b.0 > a.0 { b } else { a });
            assert!(
                off.abs() < 2e-3 && up > 0.999_999,
                "{worn}, step {step}: off by {off} m, up {up}: {cooked:?}"
            );
        }
    }
}

#[test]
fn mesh_of_few_triangles_uses_the_budget() {
    // A barn: four walls with a gateway, and a gable roof.
    let mut mesh = Mesh::default();
    let no_faces: [usize; 0] = [];
    mesh.block(Vec3::new(-4.0, 1.5, 0.0), Vec3::new(0.1, 1.5, 6.0), Rotation::IDENTITY, &no_faces);
    mesh.block(Vec3::new(4.0, 1.5, 0.0), Vec3::new(0.1, 1.5, 6.0), Rotation::IDENTITY, &no_faces);
    mesh.block(Vec3::new(0.0, 1.5, -6.0), Vec3::new(4.0, 1.5, 0.1), Rotation::IDENTITY, &no_faces);
    mesh.block(Vec3::new(-2.75, 1.5, 6.0), Vec3::new(1.25, 1.5, 0.1), Rotation::IDENTITY, &no_faces);
    mesh.block(Vec3::new(2.75, 1.5, 6.0), Vec3::new(1.25, 1.5, 0.1), Rotation::IDENTITY, &no_faces);
    let roof = Mesh::prism(&[[-4.5, 3.0], [4.5, 3.0], [0.0, 6.0]], &[&[0, 1, 2]], 13.0);
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(roof.positions.iter().map(|p| *p - Vec3::Z * 6.5));
    mesh.triangles.extend(roof.triangles.iter().map(|t| t.map(|i| i + first)));
    let [few, many] = [12, 150].map(|most| mesh.cook(most));
    assert!(few.boxes.len() <= 12 && many.boxes.len() > 15, "{} and {}", few.boxes.len(), many.boxes.len());
    // With 13 boxes, which cells of the usual size give, the deviation is 0.15 m.
    let [few, many] = [few, many].map(|cooked| cooked.deviation.distance_p95);
    assert!(many < 0.09 && many < 0.2 * few, "{few} and {many} m");
}

#[test]
fn boxes_of_a_ball_are_within_the_tolerance() {
    let mesh = Mesh::sphere(1.0, 16);
    let few = mesh.cook(20).deviation;
    let many = mesh.cook(150).deviation;
    assert!(few.distance_p95 < 0.13 && many.distance_p95 < 0.07, "{few:?}, {many:?}");
    for deviation in [few, many] {
        let ratio = deviation.volume_ratio.expect("closed");
        assert!((0.9..1.15).contains(&ratio), "{ratio}");
    }
}

#[test]
fn overlapping_parts_are_counted_once() {
    let mut mesh = Mesh::default();
    mesh.block(Vec3::ZERO, Vec3::ONE, Rotation::IDENTITY, &[]);
    mesh.block(Vec3::new(1.0, 0.5, 0.25), Vec3::ONE, Rotation::from_axis_angle(Vec3::Y, 0.3), &[]);
    let cooked = mesh.cook(150);
    assert_eq!((cooked.boxes.len(), cooked.parts), (2, 2));
    let ratio = cooked.deviation.volume_ratio.expect("closed");
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
}

#[test]
fn sheet_becomes_a_plate_behind_its_face() {
    let mut mesh = Mesh::default();
    mesh.polygon(&[Vec3::ZERO, Vec3::new(0.0, 0.0, 3.0), Vec3::new(4.0, 0.0, 3.0), Vec3::new(4.0, 0.0, 0.0)]);
    let cooked = mesh.cook(150);
    assert_eq!((cooked.boxes.len(), cooked.deviation.volume_ratio), (1, None));
    let plate = cooked.boxes[0];
    // 1 % of the diagonal of 5 m, or thinner; the drawn face is the top of the plate.
    assert!(top(&plate).abs() < 1e-3, "{plate:?}");
    assert!(cooked.deviation.distance_max < 0.051, "{cooked:?}");
    assert!(plate.half_extents.y > 1e-3, "{plate:?}");
}

#[test]
fn room_with_inward_faces_stays_hollow() {
    let mut mesh = Mesh::default();
    mesh.block(Vec3::ZERO, Vec3::new(3.0, 1.5, 2.0), Rotation::IDENTITY, &[]);
    for triangle in &mut mesh.triangles {
        triangle.swap(1, 2);
    }
    let cooked = mesh.cook(150);
    let inside = |p: Vec3| cooked.boxes.iter().any(|block| block.signed_distance(p) < 0.0);
    assert!(!inside(Vec3::ZERO) && !inside(Vec3::new(2.8, 1.3, -1.8)), "{cooked:?}");
    // Behind each face.
    for face in [Vec3::X * 3.01, Vec3::NEG_X * 3.01, Vec3::Y * 1.51, Vec3::NEG_Y * 1.51, Vec3::Z * 2.01] {
        assert!(inside(face), "{face}: {cooked:?}");
    }
    assert!(cooked.deviation.distance_p95 < 0.08, "{cooked:?}");
}

#[test]
fn open_shell_is_filled_only_if_boxes_inside_are_closer_than_plates() {
    let bottom = [2];
    let mut house = Mesh::default();
    house.block(Vec3::ZERO, Vec3::new(2.0, 2.0, 2.0), Rotation::IDENTITY, &bottom);
    let cooked = house.cook(150);
    assert!(cooked.boxes.iter().all(|block| block.signed_distance(Vec3::ZERO) > 0.0), "hollow: {cooked:?}");
    assert!(cooked.deviation.distance_p95 < 0.08, "{cooked:?}");
    let mut slab = Mesh::default();
    slab.block(Vec3::ZERO, Vec3::new(2.0, 0.05, 2.0), Rotation::IDENTITY, &bottom);
    assert_eq!(slab.cook(150).boxes.len(), 1);
}

#[test]
fn box_budget_is_kept_at_the_least_error() {
    // Pairs of blocks with a gap of 1 cm, one block with a small bump: the least important parts are dropped first.
    let mut mesh = Mesh::default();
    for row in 0..10 {
        for column in 0..10 {
            let center = Vec3::new(column as f32 * 0.51, 0.0, row as f32 * 4.0);
            mesh.block(center, Vec3::splat(0.25), Rotation::IDENTITY, &[]);
        }
    }
    let cooked = mesh.cook(10);
    assert_eq!((cooked.boxes.len(), cooked.parts), (10, 100));
    assert!(cooked.deviation.distance_p95 < 0.26, "{cooked:?}");
    for block in &cooked.boxes {
        assert!((block.half_extents.x - 2.545).abs() < 1e-3, "a row: {block:?}");
    }
    assert_eq!(mesh.cook(1).boxes.len(), 1);
}

/// A mesh with so many parts that comparing all pairs would take minutes.
#[test]
fn thousands_of_parts_finish_quickly() {
    let mut mesh = Mesh::default();
    for i in 0..4000 {
        let center = Vec3::new((i % 20) as f32, (i / 20 % 10) as f32, (i / 200) as f32);
        mesh.block(center, Vec3::splat(0.3), Rotation::IDENTITY, &[]);
    }
    let cooked = mesh.cook(150);
    assert_eq!(cooked.parts, 4000);
    let reached = |p: Vec3| cooked.boxes.iter().any(|block| block.signed_distance(p) < 0.01);
    assert!([Vec3::ZERO, Vec3::new(19.0, 9.0, 19.0)].into_iter().all(reached), "{cooked:?}");
}

#[test]
fn equal_meshes_give_equal_boxes() {
    let mesh = Mesh::sphere(2.0, 20);
    assert_eq!(mesh.cook(30), mesh.cook(30));
}

#[test]
fn invalid_meshes_are_rejected_with_their_place() {
    let mut mesh = Mesh::default();
    mesh.block(Vec3::ZERO, Vec3::ONE, Rotation::IDENTITY, &[]);
    let refuse = |mesh: &Mesh| {
        let result = cook(&mesh.positions, &mesh.triangles, &CookOptions::default(), &mut |_| {});
        let error = result.expect_err("a bad mesh");
        (error, error.to_string(), error.place())
    };
    let mut bad = mesh.clone();
    bad.positions[5].y = f32::NAN;
    let (error, what, place) = refuse(&bad);
    assert_eq!(error, CookError::NotFinite { triangle: 2, vertex: 5 });
    assert_eq!(
        (what.as_str(), place.as_str()),
        ("a coordinate is not finite or beyond 10⁶ m", "triangle 2, vertex 5")
    );
    let mut bad = mesh.clone();
    bad.triangles[7][1] = 99;
    let (_, what, place) = refuse(&bad);
    assert_eq!(
        (what.as_str(), place.as_str()),
        ("index 99 is out of range: there are 24 vertices", "triangle 7")
    );
    assert_eq!(refuse(&Mesh::default()).1, "there are no triangles");
    let mut flat = mesh.clone();
    flat.positions.fill(Vec3::X);
    assert_eq!(refuse(&flat).1, "none of the 12 triangles has an area");
    // An unused vertex has no effect.
    mesh.positions.push(Vec3::splat(f32::INFINITY));
    assert_eq!(mesh.cook(150).boxes.len(), 1);
}

#[test]
fn degenerate_and_repeated_triangles_are_dropped() {
    let mut mesh = Mesh::default();
    mesh.block(Vec3::ZERO, Vec3::ONE, Rotation::IDENTITY, &[]);
    let (first, last) = (mesh.triangles[0], mesh.triangles[11]);
    mesh.triangles.extend([[3, 3, 9], [first[1], first[2], first[0]], [last[0], last[0], last[0]]]);
    let repairs = mesh.cook(150).repairs;
    assert_eq!((repairs.degenerate, repairs.repeated, repairs.open_edges), (2, 1, 0));
}

/// Each of a few random, mostly invalid meshes gives boxes or an error.
#[test]
fn random_meshes_give_boxes_or_errors() {
    let mut random = Random::new(11);
    for case in 0..21 {
        let count = 3 + random.index(30);
        let scale = [1e-6, 1.0, 1e5][random.index(3)];
        let positions: Vec<Vec3> = (0..count)
            .map(|_| {
                let p = random.in_cube() * scale;
                // Some meshes are flat, some are on a line.
                Vec3::new(p.x, if case % 3 == 0 { 0.0 } else { p.y }, if case % 7 == 0 { 0.0 } else { p.z })
            })
            .collect();
        let mut corner = || random.index(count) as u32;
        let triangles: Vec<[u32; 3]> = (0..12).map(|_| [corner(), corner(), corner()]).collect();
        match cook(
            &positions,
            &triangles,
            &CookOptions { max_boxes: 20, ..CookOptions::default() },
            &mut |_| {},
        ) {
            Ok(cooked) => {
                assert!((1..=20).contains(&cooked.boxes.len()));
                for block in &cooked.boxes {
                    let shape = Shape::Box { half_extents: block.half_extents };
                    assert!(shape.check().is_ok() && block.to_transform().is_finite(), "{block:?}");
                }
            }
            Err(error) => assert!(matches!(error, CookError::NoTriangles { .. }), "{error}"),
        }
    }
}

#[test]
fn closest_points_equal_brute_force() {
    let mut random = Random::new(5);
    let triangles: Vec<[Vec3; 3]> = (0..300)
        .map(|_| {
            let corner = random.in_cube() * 5.0;
            [corner, corner + random.in_cube(), corner + random.in_cube()]
        })
        .collect();
    let bvh = MeshBvh::new(&triangles);
    for _ in 0..2000 {
        let p = random.in_cube() * 7.0;
        let found = bvh.closest_point(p);
        let least = triangles.iter().map(|t| brute_distance(t, p)).fold(f32::INFINITY, f32::min);
        assert!((found.distance - least).abs() < 1e-4, "{} and {least}", found.distance);
        assert!((found.distance - (found.point - p).length()).abs() < 1e-5);
        assert!((brute_distance(&triangles[found.triangle as usize], p) - least).abs() < 1e-4);
    }
}

/// Distance to a triangle: to its plane if p is over the triangle, otherwise to the nearest edge.
fn brute_distance(&[a, b, c]: &[Vec3; 3], p: Vec3) -> f32 {
    let normal = (b - a).cross(c - a).normalize();
    let above = Mat3::from_cols(b - a, c - a, normal).inverse() * (p - a);
    if above.x >= 0.0 && above.y >= 0.0 && above.x + above.y <= 1.0 {
        return above.z.abs();
    }
    let to_edge = |a: Vec3, b: Vec3| {
        let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        (a + (b - a) * t - p).length()
    };
    to_edge(a, b).min(to_edge(b, c)).min(to_edge(c, a))
}

#[test]
fn winding_numbers_distinguish_inside_and_outside() {
    let mut random = Random::new(6);
    let (sphere, mut open) = (Mesh::sphere(1.0, 24), Mesh::default());
    open.block(Vec3::ZERO, Vec3::ONE, Rotation::IDENTITY, &[3]);
    let [sphere, open] = [sphere, open].map(|mesh| {
        let corners: Vec<_> =
            mesh.corners().into_iter().filter(|[a, b, c]| (b - a).cross(c - a).length() > 0.0).collect();
        MeshBvh::new(&corners)
    });
    for _ in 0..2000 {
        let p = random.in_cube() * 2.0;
        if (p.length() - 1.0).abs() > 0.02 {
            let expected = if p.length() < 1.0 { 1.0 } else { 0.0 };
            assert!((sphere.winding_number(p) - expected).abs() < 0.06, "{p}: {}", sphere.winding_number(p));
        }
    }
    // Five of six faces, each of which covers a sixth of all directions.
    assert!((open.winding_number(Vec3::ZERO) - 5.0 / 6.0).abs() < 1e-5);
}
