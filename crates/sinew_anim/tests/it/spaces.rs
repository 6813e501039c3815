//! Tests of blend spaces and footstep merging.

use sinew_anim::{Footstep, FootstepMerger, FootstepSource, weights_on_line, weights_on_plane};
use sinew_math::{Random, Vec2};

#[test]
fn one_dimensional_space_blends_the_two_neighbours() {
    let places = [0.0, 1.5, 4.0];
    let mut weights = [0.0; 3];
    for (at, expected) in [
        (-1.0, [1.0, 0.0, 0.0]),
        (0.75, [0.5, 0.5, 0.0]),
        (1.5, [0.0, 1.0, 0.0]),
        (3.5, [0.0, 0.2, 0.8]),
        (9.0, [0.0, 0.0, 1.0]),
        (f32::NAN, [1.0, 0.0, 0.0]),
    ] {
        weights_on_line(&places, at, &mut weights);
        let error: f32 = weights.iter().zip(expected).map(|(a, b)| (a - b).abs()).sum();
        assert!(error < 1e-6, "at {at}: {weights:?}");
    }
    weights_on_line(&[2.0, 2.0], 2.0, &mut weights[..2]);
    assert_eq!(weights[..2], [1.0, 0.0]);
}

#[test]
fn planar_weights_are_continuous_and_one_at_their_clip() {
    let mut random = Random::new(1);
    for _ in 0..300 {
        let places: Vec<Vec2> = (0..2 + random.index(7))
            .map(|_| Vec2::new(random.range(-2.0, 2.0), random.range(-2.0, 2.0)))
            .collect();
        let mut weights = vec![0.0; places.len()];
        for i in 0..places.len() {
            weights_on_plane(&places, places[i], &mut weights);
            assert!((weights[i] - 1.0).abs() < 1e-4, "{weights:?} at {i}");
        }
        let mut at = Vec2::new(random.range(-3.0, 3.0), random.range(-3.0, 3.0));
        weights_on_plane(&places, at, &mut weights);
        for _ in 0..50 {
            let before = weights.clone();
            at += Vec2::new(random.range(-1e-3, 1e-3), random.range(-1e-3, 1e-3));
            weights_on_plane(&places, at, &mut weights);
            assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-5);
            assert!(weights.iter().all(|weight| (0.0..=1.0).contains(weight)));
            let closest = (0..places.len())
                .flat_map(|i| (0..i).map(move |j| (i, j)))
                .map(|(i, j)| (places[i] - places[j]).length())
                .fold(f32::INFINITY, sinew_math::min);
            let jump = before.iter().zip(&weights).map(|(a, b)| (a - b).abs()).fold(0.0, sinew_math::max);
            assert!(
                jump < 0.05 + 0.02 / closest,
                "the weights jump by {jump} at {at}; the closest two clips are {closest} apart"
            );
        }
    }
    // Four directions and standing: halfway between forward and right, both have half of the weight.
    let cross = [Vec2::ZERO, Vec2::X, Vec2::Y, -Vec2::X, -Vec2::Y];
    let mut weights = [0.0; 5];
    weights_on_plane(&cross, Vec2::new(0.5, 0.5), &mut weights);
    assert!((weights[1] - weights[2]).abs() < 1e-6 && weights[3] == 0.0 && weights[4] == 0.0);
    weights_on_plane(&cross, Vec2::new(f32::INFINITY, 0.0), &mut weights);
    assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-5);
}

#[test]
fn contact_and_event_of_one_step_are_merged() {
    let mut merger = FootstepMerger::new(0.15);
    let mut steps = Vec::new();
    merger.merge(&[(0, 1.0)], &[(0, 1.05), (1, 1.02)], &mut steps);
    // The contact comes one update before its event, and the other foot bounces.
    merger.merge(&[], &[(1, 1.5), (1, 1.55)], &mut steps);
    merger.merge(&[(1, 1.6), (0, 1.61)], &[(0, f64::NAN)], &mut steps);
    let step = |foot, time, source| Footstep { foot, time, source };
    assert_eq!(
        steps,
        [
            step(0, 1.0, FootstepSource::Clip),
            step(1, 1.02, FootstepSource::Contact),
            step(1, 1.5, FootstepSource::Contact),
            step(0, 1.61, FootstepSource::Clip),
        ]
    );
}

#[test]
fn merged_steps_do_not_depend_on_the_updates() {
    let mut random = Random::new(2);
    for _ in 0..200 {
        let (mut clip, mut contacts) = (Vec::new(), Vec::new());
        for i in 0..20 {
            let (foot, time) = (i % 2, f64::from(i) * 0.4 + f64::from(random.unit()) * 0.05);
            if random.index(5) > 0 {
                clip.push((foot, time));
            }
            if random.index(5) > 0 {
                contacts.push((foot, time + f64::from(random.range(-0.05, 0.05))));
            }
        }
        let mut whole = Vec::new();
        FootstepMerger::new(0.15).merge(&clip, &contacts, &mut whole);
        let (mut merger, mut parts, mut start) = (FootstepMerger::new(0.15), Vec::new(), -1.0);
        while start < 9.0 {
            let end = start + f64::from(random.unit());
            let of = |all: &[(u32, f64)]| -> Vec<(u32, f64)> {
                all.iter().copied().filter(|(_, time)| *time > start && *time <= end).collect()
            };
            merger.merge(&of(&clip), &of(&contacts), &mut parts);
            start = end;
        }
        assert_eq!(whole, parts);
        assert!(
            whole.windows(2).all(|pair| pair[0].foot != pair[1].foot || pair[1].time - pair[0].time > 0.3)
        );
    }
}
