//! Every pair of kinds compared with the support functions of both: a search over all directions, in `f64`. 1,000 cases
//! of each pair, or 100,000 with `SINEW_FULL` set, as `cargo xtask ci --full` does.

use super::placed::{Kind, Placed, all_pairs, gap, random_rotation, random_shape, unit, wide};
use crate::cases::cases;
use sinew_geometry::collide::{Manifold, ManifoldPoint};
use sinew_geometry::{Shape, convex};
use sinew_math::{Random, Transform, Vec3};
use std::collections::BTreeMap;

/// Returns the largest gap over all directions: the distance of two convex shapes, or minus the depth of their overlap.
/// It tests candidate directions and, in one of ten cases, searches from the best ones.
fn true_gap(a: &Placed, b: &Placed, random: &mut Random) -> f64 {
    if a.shape == Shape::HalfSpace {
        return gap(a, b, wide(a.frame.rotation * Vec3::Y));
    }
    let (ma, mb) = (a.frame.rotation.to_mat3(), b.frame.rotation.to_mat3());
    let axes_a = [ma.x_axis, ma.y_axis, ma.z_axis];
    let axes_b = [mb.x_axis, mb.y_axis, mb.z_axis];
    let mut candidates: Vec<Vec3> = axes_a.into_iter().chain(axes_b).collect();
    candidates.extend(axes_a.iter().flat_map(|u| axes_b.iter().map(|v| u.cross(*v))));
    candidates.push(b.frame.translation - a.frame.translation);
    candidates.extend((0..40).map(|_| random.direction()));
    let mut scored: Vec<(f64, [f64; 3])> = candidates
        .into_iter()
        .flat_map(|v| [v, -v])
        .filter_map(|v| unit(wide(v)))
        .map(|n| (gap(a, b, n), n))
        .collect();
    scored.sort_by(|x, y| y.0.total_cmp(&x.0));
    scored.truncate(2);
    if random.index(10) > 0 {
        return scored[0].0;
    }
    let refined = scored.into_iter().map(|(g, n)| refine(a, b, g, n, random));
    refined.fold(f64::NEG_INFINITY, f64::max)
}

/// Improves the gap by random steps of decreasing size: the gap has kinks on which a search along fixed directions
/// stops.
fn refine(a: &Placed, b: &Placed, mut best: f64, mut n: [f64; 3], random: &mut Random) -> f64 {
    let mut step = 0.2;
    while step > 1e-6 {
        let mut moved = false;
        for _ in 0..24 {
            let offset = wide(random.direction());
            let Some(other) = unit([0, 1, 2].map(|k| n[k] + step * offset[k])) else { continue };
            let g = gap(a, b, other);
            if g > best {
                (best, n, moved) = (g, other, true);
            }
        }
        if !moved {
            step *= 0.6;
        }
    }
    best
}

/// Returns two shapes near contact: overlapping by up to a third of their size or apart by up to a tenth.
fn random_pair(ka: Kind, kb: Kind, random: &mut Random) -> (Placed, Placed) {
    let scale = [0.01, 0.1, 1.0, 10.0][random.index(4)];
    let ratio = [1.0, 1.0, 5.0][random.index(3)];
    let common = random.rotation();
    let place = |kind: Kind, scale: f32, random: &mut Random| Placed {
        shape: random_shape(kind, scale, random),
        frame: Transform::new(random.in_cube() * scale, common * random_rotation(random)),
    };
    let a = place(ka, scale, random);
    let mut b = place(kb, scale * ratio, random);
    b.frame.translation += random.direction() * scale;
    let wanted = scale * random.range(-0.3, 0.1);
    for _ in 0..2 {
        let now = way(&a, &b);
        b.frame.translation += now.normal * (wanted - now.distance);
    }
    (a, b)
}

/// Returns the gap by GJK and EPA, whose direction is also tested.
fn way(a: &Placed, b: &Placed) -> convex::Gap {
    convex::gap(&a.shape, &a.frame, &b.shape, &b.frame).expect("one of the two shapes is bounded")
}

fn nearest(manifold: &Manifold) -> f64 {
    manifold.points().iter().map(|p| f64::from(p.separation)).fold(f64::INFINITY, f64::min)
}

/// Returns the allowed difference between the gap along a normal and the largest gap: faces are preferred to slightly
/// better edges, and their normals to slightly different ones.
fn preference(ka: Kind, kb: Kind, a: &Placed, b: &Placed, truth: f64) -> f64 {
    let thinnest = f64::from(a.shape.inner_radius().min(b.shape.inner_radius()));
    match (ka, kb) {
        (Kind::HalfSpace, _) | (Kind::Box | Kind::Sphere, Kind::Sphere) | (Kind::Sphere, Kind::Capsule) => {
            0.0
        }
        // The closer two cores are, the more rounding rotates the direction between them; the gap is measured at their
        // contact.
        (Kind::Capsule, Kind::Capsule) => {
            let cores = truth + f64::from(a.shape.inner_radius() + b.shape.inner_radius());
            let size = f64::from(a.size() + b.size());
            (2e-7 * size * size / cores.max(1e-9 * size)).min(1e-3 * size)
        }
        // Close to a surface, rounding dominates the direction to the closest point.
        (Kind::Sphere, _) | (_, Kind::Sphere) => 1e-3 * f64::from(a.size() + b.size()),
        _ => 0.06 * truth.abs() + 0.011 * thinnest + 2e-3 * f64::from(a.size() + b.size()),
    }
}

/// Result of a check: a description of the fault, if there is one.
type Verdict = Result<(), String>;

fn hold(holds: bool, otherwise: impl FnOnce() -> String) -> Verdict {
    if holds { Ok(()) } else { Err(otherwise()) }
}

/// Checks random cases of each pair of kinds; for each failing pair, reports the number of failures and the first.
fn judge(seed: u64, mut of: impl FnMut(Kind, Kind, &Placed, &Placed, &mut Random) -> Verdict) {
    let mut random = Random::new(seed);
    let mut wrong = Vec::new();
    for (ka, kb) in all_pairs() {
        let mut failures = 0;
        let mut first = None;
        for case in 0..cases(100_000) {
            let (a, b) = random_pair(ka, kb, &mut random);
            if let Err(what) = of(ka, kb, &a, &b, &mut random) {
                failures += 1;
                first.get_or_insert_with(|| format!("case {case}: {what}\n{a:?}\n{b:?}"));
            }
        }
        wrong.extend(first.map(|first| format!("{ka:?} {kb:?}: {failures} wrong, the first: {first}\n")));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The normal is the best direction, the separation is the gap along it, and there is a manifold exactly if the shapes
/// are within the margin.
#[test]
fn separation_matches_the_support_functions() {
    judge(1, |ka, kb, a, b, random| {
        let size = f64::from(a.size() + b.size());
        let margin = 0.05 * a.size().max(b.size());
        let m = a.collide(b, margin);
        // Every direction bounds the gap from below; the search may miss the best direction, so it also uses these.
        let along_of = |normal: Vec3| unit(wide(normal)).map_or(f64::NEG_INFINITY, |n| gap(a, b, n));
        let along = if m.count > 0 { along_of(m.normal) } else { f64::NEG_INFINITY };
        let truth = true_gap(a, b, random).max(along).max(along_of(way(a, b).normal));
        let context = |what: &str| format!("{what}: true gap {truth}, {along} along the normal, {m:?}");
        let rounding = 2e-5 * size;
        if m.count == 0 {
            return hold(truth > f64::from(margin) - rounding, || context("missed"));
        }
        hold(truth <= f64::from(margin) + rounding, || context("invented"))?;
        hold((m.normal.length() - 1.0).abs() < 1e-4, || context("not unit"))?;
        let preference = preference(ka, kb, a, b, truth);
        hold(along > truth - preference - rounding, || context("the normal is not the best direction"))?;
        hold(nearest(&m) > along - rounding - 1e-4 * size, || context("too deep"))?;
        // Over a plane the deepest point is always in the manifold; otherwise only for shapes that do not touch yet.
        if ka == Kind::HalfSpace {
            return hold(nearest(&m) < truth + rounding, || context("the deepest point is missing"));
        }
        let slack = preference + 1e-3 * size;
        hold(truth <= 0.0 || nearest(&m) < truth + slack, || context("too far"))
    });
}

/// A point is half-way between the surfaces along the normal, on both shapes, except for nearly parallel edges, ends of
/// tilted capsules, and deep overlaps without face or edge contact.
#[test]
fn contact_points_lie_between_the_surfaces() {
    let mut tallies: BTreeMap<String, Tally> = BTreeMap::new();
    judge(2, |ka, kb, a, b, _| {
        let tally = tallies.entry(format!("{ka:?} {kb:?}")).or_default();
        let size = a.size().max(b.size());
        let m = a.collide(b, 0.05 * size);
        for p in m.points() {
            let half = m.normal * (0.5 * p.separation);
            let (on_a, _) = a.shape.signed_distance(&a.frame, p.position - half);
            let (on_b, _) = b.shape.signed_distance(&b.frame, p.position + half);
            let away = on_a.abs().max(on_b.abs()) / size;
            tally.points += 1;
            tally.off += u32::from(away > 0.01);
            tally.far += u32::from(away > 0.05);
        }
        hold(m.points().iter().all(|p| p.separation <= 0.05 * size), || {
            format!("a point is beyond the margin: {m:?}")
        })
    });
    for (pair, tally) in &tallies {
        println!("{pair}: {tally:?}");
        let Tally { points, off, far } = *tally;
        assert!(points > cases(50_000), "{pair}: {tally:?}");
        assert!(off * 10 < points && far * 50 < points, "{pair}: {tally:?}");
    }
    let [points, off] =
        [|t: &Tally| t.points, |t: &Tally| t.off].map(|of| tallies.values().map(of).sum::<u32>());
    assert!(off * 100 < points, "{off} of {points} points are not on a surface");
}

/// Number of points, and of those off a surface by more than a hundredth and by more than a twentieth of the larger
/// shape.
#[derive(Debug, Default)]
struct Tally {
    points: u32,
    off: u32,
    far: u32,
}

/// True if two results of one query are equally good: the shapes are equally far apart along both normals, within
/// [`preference`], and the separations agree. Rounding then decides which one is returned, and the position along level
/// directions.
fn is_tie(kind: Kind, a: &Placed, b: &Placed, ab: &Manifold, ba: &Manifold) -> bool {
    let slack = preference(kind, kind, a, b, nearest(ab)) + 2e-5 * f64::from(a.size().max(b.size()));
    let along = [ab.normal, -ba.normal].map(|normal| gap(a, b, wide(normal)));
    (along[0] - along[1]).abs() < slack && (nearest(ab) - nearest(ba)).abs() < slack
}

/// Swapped shapes give the opposite normal, the same points, and features with exchanged halves. Rarely, two shapes of
/// one kind may give another result that is equally good.
#[test]
fn exchanged_shapes_give_the_mirrored_contact() {
    let mut ties: BTreeMap<(Kind, Kind), u32> = BTreeMap::new();
    judge(3, |ka, kb, a, b, _| {
        let size = a.size().max(b.size());
        let (ab, ba) = (a.collide(b, 0.05 * size), b.collide(a, 0.05 * size));
        hold((ab.count == 0) == (ba.count == 0), || {
            format!("only one order has a manifold\n{ab:?}\n{ba:?}")
        })?;
        let exchanged = is_exchanged(ka, kb, size, &ab, &ba);
        if exchanged.is_err() && ka == kb && is_tie(ka, a, b, &ab, &ba) {
            *ties.entry((ka, kb)).or_default() += 1;
            return Ok(());
        }
        exchanged
    });
    println!("pairs with another, equally good result after the exchange: {ties:?}");
    assert!(ties.values().all(|&ties| ties <= 2 + cases(100_000) / 1_000), "{ties:?}");
}

/// Checks that one manifold is the other with exchanged shapes.
fn is_exchanged(ka: Kind, kb: Kind, size: f32, ab: &Manifold, ba: &Manifold) -> Verdict {
    let context = |what: &str| format!("{what}\n{ab:?}\n{ba:?}");
    hold((ab.normal + ba.normal).length() < 1e-3, || context("the normals are not opposite"))?;
    // Hulls with many corners per face may keep other points: see `hull::pairs`.
    if (ka, kb) == (Kind::Hull, Kind::Hull) {
        return Ok(());
    }
    hold(ab.count == ba.count, || context("the numbers of points differ"))?;
    for p in ab.points() {
        let far = |q: &ManifoldPoint| (q.position - p.position).length();
        let twin = ba.points().iter().min_by(|q, r| far(q).total_cmp(&far(r))).expect("equal counts");
        hold(far(twin) < 2e-3 * size, || context("a point differs"))?;
        hold((p.separation - twin.separation).abs() < 1e-3 * size, || context("a separation differs"))?;
        let same = ka == kb || p.feature == twin.feature.rotate_left(16);
        hold(same, || context("a feature differs"))?;
    }
    Ok(())
}

/// Moving both shapes together moves the contact with them.
#[test]
fn contacts_rotate_with_the_shapes() {
    let mut other = 0;
    judge(6, |ka, kb, a, b, random| {
        let size = a.size().max(b.size());
        let margin = 0.05 * size;
        let motion = Transform::new(random.in_cube() * size, random.rotation());
        let [c, d] = [a, b].map(|p| Placed { shape: p.shape.clone(), frame: motion * p.frame });
        let (here, there) = (a.collide(b, margin), c.collide(&d, margin));
        let (near, far) = (nearest(&here), nearest(&there));
        let context = || format!("{near} and {far}: {here:?}\n{there:?}\n{motion:?}");
        let slack = preference(ka, kb, a, b, near) + 1e-3 * f64::from(size);
        if here.count == 0 || there.count == 0 {
            let at_margin = |separation: f64| separation > f64::from(margin) - slack;
            return hold(at_margin(near) && at_margin(far), context);
        }
        // A world direction decides ties, and rounding decides near ties.
        other += u32::from((motion.rotation * here.normal - there.normal).length() > 0.05);
        hold((near - far).abs() < slack, context)
    });
    println!("{other} manifolds have another normal after the rotation");
    assert!(other < 35 * cases(1_000), "{other} manifolds have another normal after the rotation");
}
