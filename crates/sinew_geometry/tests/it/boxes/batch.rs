//! Batches of eight boxes: their bits equal those of single boxes at every SIMD level of the processor, their results
//! equal enumeration, and their hash is the same on all processors.

use super::oracle::WideBox;
use super::overlap::{check, tolerances};
use super::random_pairs::{obb, pair};
use crate::cases::cases;
use sinew_geometry::Obb;
use sinew_geometry::boxes::batch::{
    Axes, ContainsPoints, FindOverlaps, FindSeparations, Pairs, Points, SeparatingAxis, Separation,
    Separations, SignedDistances,
};
use sinew_geometry::boxes::{Cuboid, Overlap, Penetration};
use sinew_math::dispatch::{self, Level};
use sinew_math::{Random, StableHasher, Vec3};

/// Number of cases, all of which always run: they take microseconds.
const CASES: usize = 100_000;

/// Hash of the results for the soup, on x86-64, aarch64 and wasm.
const GOLDEN: u64 = 0xeb39_4a58_1e5a_bc31;

fn bit(bytes: &[u8], index: usize) -> bool {
    bytes[index / 8] >> (index % 8) & 1 == 1
}

/// Returns the bits of a number, equal for all NaN: their sign and payload are not defined.
fn bits(number: f32) -> u32 {
    if number.is_nan() { f32::NAN.to_bits() } else { number.to_bits() }
}

/// Returns a point in, on, near or far from a box.
fn point_about(of: &Obb, random: &mut Random) -> Vec3 {
    let corner = random.in_cube().map(|x| if x < 0.0 { -1.0 } else { 1.0 });
    let place = match random.index(5) {
        0 => corner,
        1 => corner.with_x(random.range(-1.0, 1.0)),
        2 => random.in_cube() * 1e4,
        _ => random.in_cube() * 1.5,
    };
    of.center + of.rotation * (place * of.half_extents)
}

fn contained(level: Level, of: &Obb, points: &Points) -> Vec<u8> {
    let mut inside = vec![u8::MAX; points.len().div_ceil(8)];
    dispatch::run_at(level, ContainsPoints { obb: of, points, inside: &mut inside });
    inside
}

fn distances(level: Level, of: &Obb, points: &Points) -> Vec<f32> {
    let mut distances = vec![f32::MAX; points.len()];
    dispatch::run_at(level, SignedDistances { obb: of, points, distances: &mut distances });
    distances
}

fn overlapping(level: Level, pairs: &Pairs) -> Vec<u8> {
    let mut overlapping = vec![u8::MAX; pairs.len().div_ceil(8)];
    dispatch::run_at(level, FindOverlaps { pairs, overlapping: &mut overlapping });
    overlapping
}

fn separated(level: Level, axes: Axes, pairs: &Pairs) -> Separations {
    let mut found = Separations::new();
    dispatch::run_at(level, FindSeparations { pairs, axes, found: &mut found });
    assert_eq!(found.len(), pairs.len());
    found
}

fn pairs_of(boxes: &[[Obb; 2]]) -> Pairs {
    let mut pairs = Pairs::new();
    for [a, b] in boxes {
        pairs.push(a, b);
    }
    pairs
}

#[test]
fn batched_points_give_the_results_of_single_points() {
    let mut random = Random::new(61);
    let (mut asked, mut held) = (0, 0);
    while asked < CASES {
        let of = obb(&mut random);
        let points: Vec<Vec3> = (0..random.index(40)).map(|_| point_about(&of, &mut random)).collect();
        let batch = Points::from(&points[..]);
        for level in Level::available() {
            let (inside, distances) = (contained(level, &of, &batch), distances(level, &of, &batch));
            for (k, &point) in points.iter().enumerate() {
                assert_eq!(
                    bit(&inside, k),
                    of.contains_point(point),
                    "{level:?}: wrong answer for point {point} in {of:?}"
                );
                let (found, one) = (distances[k], of.signed_distance(point));
                // A single box counts closer points as on the surface.
                let is_same =
                    found.to_bits() == one.to_bits() || (found.abs() <= 1e-12 && one.abs() <= 1e-12);
                assert!(is_same, "{level:?}: distance {found:e} in lanes, {one:e} alone: {point} and {of:?}");
            }
            let beyond = inside.last().map_or(0, |last| u32::from(*last) >> ((points.len() - 1) % 8 + 1));
            assert_eq!(beyond, 0, "{level:?}: an absent point counts as inside");
        }
        held += points.iter().filter(|point| of.contains_point(**point)).count();
        asked += points.len();
    }
    assert!((15..60).contains(&(held * 100 / asked)), "{held} of {asked} points are inside");
}

#[test]
fn batched_pairs_give_the_results_of_single_pairs() {
    let mut random = Random::new(62);
    let boxes: Vec<[Obb; 2]> = (0..CASES + 3).map(|_| pair(&mut random)).collect();
    let pairs = pairs_of(&boxes);
    for level in Level::available() {
        let overlapping = overlapping(level, &pairs);
        let separated = separated(level, Axes::Fifteen, &pairs);
        for (k, ([a, b], found)) in boxes.iter().zip(separated.iter()).enumerate() {
            assert_eq!(bit(&overlapping, k), a.overlaps(b), "{level:?}: wrong overlap of {a:?} and {b:?}");
            let one = Separation::between(a, b);
            assert_eq!(
                found.distance.to_bits(),
                one.distance.to_bits(),
                "{level:?}: the batch has another distance for {a:?} and {b:?}"
            );
            assert_eq!(found.axis, one.axis, "{level:?}: the batch has another axis for {a:?} and {b:?}");
        }
        assert_eq!(overlapping[CASES / 8] >> 3, 0, "{level:?}: an absent pair counts as overlapping");
    }
}

/// Depth, direction and gap equal those of an enumeration, in either order.
#[test]
fn separations_match_enumeration() {
    let mut random = Random::new(63);
    for _ in 0..cases(100_000) {
        let [a, b] = pair(&mut random);
        let (wide_a, wide_b) = (WideBox::from(&a), WideBox::from(&b));
        let tolerances = tolerances(&wide_a, &wide_b, 0.0);
        let (found, back) = (Separation::between(&a, &b), Separation::between(&b, &a));
        let way = (found.distance <= 0.0)
            .then(|| Penetration { depth: -found.distance, direction: found.axis.direction(&a, &b) });
        check(way, |shift, grow| wide_a.meets(&wide_b.moved(shift), grow), tolerances, &mut random)
            .unwrap_or_else(|what| panic!("{what}: {a:?} {b:?} {found:?}"));
        let apart = f64::from((found.distance - back.distance).abs());
        assert!(apart <= tolerances[1], "distances {found:?} and {back:?} of {a:?} and {b:?}");
    }
}

#[test]
fn separation_of_face_axes_never_exceeds_that_of_all_axes() {
    let mut random = Random::new(64);
    let boxes: Vec<[Obb; 2]> = (0..CASES).map(|_| pair(&mut random)).collect();
    let pairs = pairs_of(&boxes);
    let [mut faces, mut all] = [Separations::new(), Separations::new()];
    pairs.face_separations(&mut faces);
    pairs.separations(&mut all);
    let mut edges = 0;
    for (face, all) in faces.iter().zip(all.iter()) {
        assert!(face.distance <= all.distance);
        edges += usize::from(face != all);
    }
    assert!(edges > CASES / 50, "edge axes were better in only {edges} cases");
}

/// Returns two boxes in which number `index` of twenty is replaced by `value`.
fn spoilt(boxes: &[Obb; 2], index: usize, value: f32) -> [Obb; 2] {
    let mut boxes = *boxes;
    let of = &mut boxes[index / 10];
    let q = &mut of.rotation;
    *[
        &mut of.center.x,
        &mut of.center.y,
        &mut of.center.z,
        &mut q.x,
        &mut q.y,
        &mut q.z,
        &mut q.w,
        &mut of.half_extents.x,
        &mut of.half_extents.y,
        &mut of.half_extents.z,
    ][index % 10] = value;
    boxes
}

#[test]
fn nan_affects_only_its_own_lane() {
    let mut random = Random::new(65);
    let boxes: [[Obb; 2]; 8] = core::array::from_fn(|_| pair(&mut random));
    let whole = pairs_of(&boxes);
    for index in 0..20 {
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let lane = index % 8;
            let mut boxes = boxes;
            boxes[lane] = spoilt(&boxes[lane], index, value);
            let pairs = pairs_of(&boxes);
            for level in Level::available() {
                for axes in [Axes::Faces, Axes::Fifteen] {
                    let (found, sound) = (separated(level, axes, &pairs), separated(level, axes, &whole));
                    for k in 0..8 {
                        let (found, sound) = (found.get(k).distance, sound.get(k).distance);
                        let is_infinite_size = value.is_infinite() && index % 10 > 6;
                        if k != lane {
                            assert_eq!(found.to_bits(), sound.to_bits());
                        } else if !is_infinite_size {
                            assert!(
                                found.is_nan(),
                                "{level:?} {axes:?}: input {index} is {value}: distance {found}"
                            );
                        }
                    }
                }
                let overlapping = overlapping(level, &pairs);
                assert!(
                    value.is_infinite() || !bit(&overlapping, lane),
                    "{level:?}: invalid input {index} counts as overlapping"
                );
            }
        }
    }
}

#[test]
fn point_with_nan_is_in_no_box() {
    let of = obb(&mut Random::new(66));
    for level in Level::available() {
        for k in 0..3 {
            let mut point = of.center;
            point[k] = f32::NAN;
            let points: Points = [of.center, point].into_iter().collect();
            assert_eq!(contained(level, &of, &points), [0b01]);
            let distances = distances(level, &of, &points);
            assert!(distances[0] <= 0.0 && distances[1].is_nan(), "{level:?}: distances {distances:?}");
        }
    }
}

/// Returns pairs of boxes of all sizes, and with NaN, for which every processor must give the same result.
fn soup() -> Vec<[Obb; 2]> {
    let mut random = Random::new(67);
    let mut soup: Vec<[Obb; 2]> = (0..2_000).map(|_| pair(&mut random)).collect();
    for scale in [1e-44, 1e-38, 1e-20, 1e-8, 1e8, 1e18, 1e25, 3e38] {
        for _ in 0..50 {
            let mut boxes = pair(&mut random);
            for of in &mut boxes {
                of.center *= scale;
                of.half_extents *= scale;
            }
            soup.push(boxes);
        }
    }
    let corners = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -0.0, f32::MAX, f32::from_bits(1), -1.0];
    for index in 0..20 {
        for value in corners {
            soup.push(spoilt(&pair(&mut random), index, value));
        }
    }
    soup
}

/// Index of an axis in the order in which axes are tested.
fn place(axis: SeparatingAxis) -> u8 {
    match axis {
        SeparatingAxis::FaceOfA(k) => k,
        SeparatingAxis::FaceOfB(k) => 3 + k,
        SeparatingAxis::Edges(i, j) => 6 + 3 * i + j,
    }
}

#[test]
fn golden_soup_of_boxes() {
    let soup = soup();
    let pairs = pairs_of(&soup);
    for level in Level::available() {
        let mut hasher = StableHasher::default();
        let mut write = |number: f32| hasher.write(&bits(number).to_le_bytes());
        for axes in [Axes::Faces, Axes::Fifteen] {
            for found in separated(level, axes, &pairs).iter() {
                write(found.distance);
                // Between boxes with NaN no axis is the best.
                write(if found.distance.is_nan() { f32::NAN } else { f32::from(place(found.axis)) });
            }
        }
        for eight in overlapping(level, &pairs) {
            write(f32::from(eight));
        }
        let points: Points = soup.iter().map(|[_, b]| b.center).collect();
        for [of, _] in &soup[..100] {
            distances(level, of, &points).into_iter().for_each(&mut write);
            contained(level, of, &points).into_iter().for_each(|eight| write(f32::from(eight)));
        }
        assert_eq!(hasher.finish(), GOLDEN, "{level:?}: {:#018x}", hasher.finish());
    }
}

#[test]
#[should_panic = "one byte for every eight points"]
fn short_result_slice_for_points_panics() {
    let points: Points = [Vec3::ZERO; 9].into_iter().collect();
    Obb::default().contains_points(&points, &mut [0]);
}

#[test]
#[should_panic = "one distance for every point"]
fn short_result_slice_for_distances_panics() {
    let points: Points = [Vec3::ZERO; 9].into_iter().collect();
    Obb::default().signed_distances(&points, &mut [0.0; 16]);
}
