//! Compares passed events with a closed formula: each is passed exactly once, for any step lengths.

use crate::cases;
use sinew_anim::{LoopMode, Passage, Playhead};
use sinew_math::Random;

/// Unit of all times, 1/1024 s. Times are whole multiples of it, so that the formula uses integers and no step is
/// rounded.
const UNIT: f64 = 1.0 / 1024.0;

/// Returns the time since lap 0 began, in units, in the direction of the laps.
fn unfolded(playhead: &Playhead, length: i64) -> i64 {
    let in_lap = if playhead.mode() == LoopMode::PingPong && playhead.lap().rem_euclid(2) == 1 {
        length - (f64::from(playhead.clip_time()) / UNIT) as i64
    } else {
        (f64::from(playhead.clip_time()) / UNIT) as i64
    };
    playhead.lap() * length + in_lap
}

/// Counts the integers n with `e + n · period` in (from, to] going forward, in [to, from) going backward, and including
/// `from` if `counts_start`.
fn times(from: i64, to: i64, e: i64, period: i64, counts_start: bool) -> i64 {
    let up_to = |t: i64| (t - e).div_euclid(period);
    let start = i64::from(counts_start && (from - e).rem_euclid(period) == 0);
    start + if to >= from { up_to(to) - up_to(from) } else { up_to(from - 1) - up_to(to - 1) }
}

/// Returns the number of crossings of one motion from `from` to `to`, by the closed formula.
fn expected(mode: LoopMode, length: i64, e: i64, from: i64, to: i64, is_fresh: bool) -> i64 {
    match mode {
        // The end of a loop does not count as its start.
        LoopMode::Loop => times(from, to, e, length, is_fresh && e != length),
        LoopMode::PingPong if e == 0 || e == length => times(from, to, e, 2 * length, is_fresh),
        LoopMode::PingPong => {
            times(from, to, e, 2 * length, is_fresh) + times(from, to, -e, 2 * length, is_fresh)
        }
        LoopMode::Once => {
            let is_passed = if to >= from { from < e && e <= to } else { to <= e && e < from };
            i64::from(is_passed || (is_fresh && from == e))
        }
    }
}

/// Counts the crossings of a step and checks the position of each.
fn count(passage: Passage, mode: LoopMode, length: i64, e: i64, from: i64, way: i64) -> i64 {
    let mut last: Option<f64> = None;
    let mut number = 0;
    let all: Vec<_> = passage.crossings((e as f64 * UNIT) as f32).collect();
    for crossing in &all {
        let distance = (crossing.distance / UNIT) as i64;
        assert_eq!(distance as f64 * UNIT, crossing.distance, "the event must be at a whole number of units");
        assert!(if way < 0 { (way..=0).contains(&distance) } else { (0..=way).contains(&distance) });
        let at = from + distance;
        let is_there = match mode {
            LoopMode::Loop => (at - e).rem_euclid(length) == 0,
            LoopMode::PingPong => [e, -e].iter().any(|e| (at - e).rem_euclid(2 * length) == 0),
            LoopMode::Once => at == e,
        };
        assert!(is_there, "{mode:?}: event at {e}, length {length}, passed at {at}");
        let lap = at.div_euclid(length);
        assert!(crossing.lap() == lap || mode == LoopMode::Once);
        if mode != LoopMode::PingPong {
            assert!(
                last.is_none_or(|last| (crossing.distance - last) * way as f64 > 0.0),
                "crossings must be in order"
            );
        }
        last = Some(crossing.distance);
        number += 1;
    }
    number
}

#[test]
fn every_event_is_passed_exactly_once_for_any_steps() {
    let mut random = Random::new(11);
    let modes = [LoopMode::Loop, LoopMode::PingPong, LoopMode::Once];
    for playback in 0..cases(1_000_000) {
        let mode = modes[random.index(3)];
        let length = 1 + random.index(600) as i64;
        let e = [0, length, random.index(length as usize + 1) as i64][random.index(3)];
        let start = random.index(3 * length as usize) as i64 - length;
        let mut playhead = Playhead::new(mode, (length as f64 * UNIT) as f32, start as f64 * UNIT);
        let mut is_fresh = true;
        for _ in 0..3 {
            // Motion in one direction is split into random steps; pauses are steps of length zero.
            let direction = if random.index(2) == 0 { 1 } else { -1 };
            let from = unfolded(&playhead, length);
            let (mut way, mut fired) = (0, 0);
            let longest = 1 + random.index(3 * length as usize);
            for _ in 0..1 + random.index(6) {
                let step = direction * random.index(longest) as i64;
                let at = unfolded(&playhead, length);
                let passage = playhead.advance(step as f64 * UNIT);
                fired += count(passage, mode, length, e, at, step);
                way += step;
            }
            let to = unfolded(&playhead, length);
            let end = if mode == LoopMode::Once { (from + way).clamp(0, length) } else { from + way };
            assert_eq!(to, end, "playback {playback}");
            let formula = expected(mode, length, e, from, to, is_fresh);
            assert_eq!(
                fired, formula,
                "playback {playback}: {mode:?}, event at {e}, length {length}, from {from} to {to}"
            );
            is_fresh = false;
            if random.index(4) == 0 {
                playhead.seek(random.index(2 * length as usize) as f64 * UNIT);
                is_fresh = true;
            }
        }
    }
}

#[test]
fn long_playback_does_not_drift() {
    let mut playhead = Playhead::new(LoopMode::Loop, 0.7, 0.0);
    let mut passed = 0_usize;
    // One day in steps of a second.
    for _ in 0..86_400 {
        passed += playhead.advance(1.0).crossings(0.3).count();
    }
    let laps = 86_400.0 / f64::from(0.7_f32);
    assert_eq!(passed, (laps - 0.3 / 0.7).floor() as usize + 1);
    let time = (laps - laps.floor()) * f64::from(0.7_f32);
    assert!((f64::from(playhead.clip_time()) - time).abs() < 1e-6);
}

#[test]
fn step_over_many_cycles_counts_events_in_constant_time() {
    let mut playhead = Playhead::new(LoopMode::Loop, 0.5, 0.0);
    let crossings = playhead.advance(1e9).crossings(0.25);
    assert_eq!(crossings.take(3).map(|crossing| crossing.distance).collect::<Vec<_>>(), [0.25, 0.75, 1.25]);
    assert_eq!(playhead.lap(), 2_000_000_000);
}

#[test]
fn clip_of_zero_length_has_time_zero() {
    let mut playhead = Playhead::new(LoopMode::Loop, 0.0, 3.0);
    assert_eq!(playhead.advance(1.0).crossings(0.0).count(), 1);
    assert_eq!(playhead.advance(1.0).crossings(0.0).count(), 0);
    assert_eq!((playhead.clip_time(), playhead.mode()), (0.0, LoopMode::Once));
}

#[test]
#[should_panic = "finite"]
fn non_finite_time_panics() {
    Playhead::new(LoopMode::Loop, 1.0, 0.0).advance(f64::NAN);
}
