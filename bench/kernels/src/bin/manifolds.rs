//! Contact manifolds of two shapes, compared with Parry's: the same random pairs, without cached data.
//!
//! `manifolds` prints nanoseconds per pair and the number of touching pairs; `manifolds ENGINE KINDS` (as `sinew box-hull`) runs one engine
//! on one kind of pair ten times, for `valgrind --tool=callgrind`.
#![forbid(unsafe_code)]

use parry3d::math::{Pose, Rotation as ParryRotation, Vector};
use parry3d::query::{ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher};
use parry3d::shape::SharedShape;
use sinew_geometry::collide::{Manifold, collide};
use sinew_geometry::{Hull, Shape};
use sinew_math::{Random, Transform, Vec3};
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

/// Number of pairs of each kind.
const PAIRS: usize = 4_096;
/// Number of rounds over all pairs.
const ROUNDS: usize = 10;
/// Search distance for points, metres.
const MARGIN: f32 = 0.02;

const KINDS: [&str; 5] = ["box", "ball", "capsule", "cylinder", "hull"];

/// Two shapes in the form of both engines.
struct Pair {
    shapes: [Shape; 2],
    frames: [Transform; 2],
    theirs: [SharedShape; 2],
    b_in_a: Pose,
}

fn shape(kind: &str, random: &mut Random) -> (Shape, SharedShape) {
    let [x, y, z] = [0; 3].map(|_| random.range(0.2, 0.6));
    match kind {
        "box" => (Shape::Box { half_extents: Vec3::new(x, y, z) }, SharedShape::cuboid(x, y, z)),
        "ball" => (Shape::Sphere { radius: x }, SharedShape::ball(x)),
        "capsule" => (Shape::Capsule { half_height: y, radius: x }, SharedShape::capsule_y(y, x)),
        "cylinder" => (Shape::Cylinder { half_height: y, radius: x }, SharedShape::cylinder(y, x)),
        "hull" => {
            let points: Vec<Vec3> = (0..16).map(|_| random.direction() * Vec3::new(x, y, z)).collect();
            let hull = Hull::new(&points).expect("points in general position");
            let corners: Vec<Vector> = hull.vertices().iter().map(|v| Vector::new(v.x, v.y, v.z)).collect();
            let theirs = SharedShape::convex_hull(&corners).expect("corners of a hull");
            (Shape::Hull(Arc::new(hull)), theirs)
        }
        _ => panic!("no such kind: {kind} (of {KINDS:?})"),
    }
}

fn pose(frame: &Transform) -> Pose {
    let (p, q) = (frame.translation, frame.rotation);
    Pose::from_parts(Vector::new(p.x, p.y, p.z), ParryRotation::from_xyzw(q.x, q.y, q.z, q.w))
}

/// Returns random pairs, about half of which touch.
fn pairs(kinds: [&str; 2]) -> Vec<Pair> {
    let mut random = Random::new(11);
    let pair = |_| {
        let [(a, their_a), (b, their_b)] = kinds.map(|kind| shape(kind, &mut random));
        let frames = [0; 2].map(|_| Transform::new(random.in_cube() * 0.6, random.rotation()));
        let b_in_a = pose(&frames[0]).inverse() * pose(&frames[1]);
        Pair { shapes: [a, b], frames, theirs: [their_a, their_b], b_in_a }
    };
    (0..PAIRS).map(pair).collect()
}

/// Returns the number of touching pairs.
fn sinew(pairs: &[Pair]) -> usize {
    let mut manifold = Manifold::default();
    let touches = |pair: &&Pair| {
        let ([a, b], [from_a, from_b]) = (&pair.shapes, &pair.frames);
        collide(a, from_a, b, from_b, MARGIN, &mut manifold);
        black_box(&manifold).count > 0
    };
    pairs.iter().filter(touches).count()
}

fn parry(pairs: &[Pair]) -> usize {
    let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
    let mut workspace = None;
    let touches = |pair: &&Pair| {
        manifolds.clear();
        workspace = None;
        let [a, b] = &pair.theirs;
        let dispatcher = DefaultQueryDispatcher;
        let found =
            dispatcher.contact_manifolds(&pair.b_in_a, &**a, &**b, MARGIN, &mut manifolds, &mut workspace);
        found.expect("Parry knows every pair of these");
        black_box(&manifolds).iter().any(|manifold| !manifold.points.is_empty())
    };
    pairs.iter().filter(touches).count()
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [engine, kinds] = arguments.as_slice() {
        let (a, b) = kinds.split_once('-').expect("two kinds, as box-hull");
        let pairs = pairs([a, b]);
        let ask = if engine == "parry" { parry } else { sinew };
        println!("{} of {PAIRS} touch", (0..ROUNDS).map(|_| ask(&pairs)).max().unwrap_or(0));
        return;
    }
    println!("pair, ns a pair and pairs of {PAIRS} that touch: Sinew, Parry");
    for (i, a) in KINDS.iter().enumerate() {
        for b in &KINDS[i..] {
            let pairs = pairs([a, b]);
            let measured = [sinew as fn(&[Pair]) -> usize, parry].map(|ask| {
                let mut best = f64::INFINITY;
                let mut count = 0;
                for _ in 0..ROUNDS {
                    let start = Instant::now();
                    count = ask(&pairs);
                    best = f64::min(best, start.elapsed().as_secs_f64());
                }
                (best * 1e9 / PAIRS as f64, count)
            });
            let [(ours, count), (theirs, their_count)] = measured;
            println!("{a}-{b}: {ours:.0} ({count}), {theirs:.0} ({their_count})");
        }
    }
}
