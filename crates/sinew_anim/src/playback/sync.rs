//! Phases, by which loops of different lengths are kept in step.

use crate::playback::playhead::{Place, Playhead};

/// Times in a looped clip that correspond one by one to those of other clips: left foot down, right foot down. Time is
/// stretched between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Markers {
    times: Vec<f32>,
}

impl Default for Markers {
    /// A marker only at the start of the clip, so that whole laps match.
    fn default() -> Self {
        Self { times: vec![0.0] }
    }
}

/// Phase of a looped clip between its markers: number of passed markers, and the share of the way to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase {
    /// Number of the last marker, counted through all laps.
    pub marker: i64,
    /// Share of the time to the next marker that has passed, 0 to 1, 1 excluded.
    pub share: f64,
}

impl Markers {
    /// Creates markers at `times`, clip seconds.
    ///
    /// # Panics
    /// If there are no markers, or they are not strictly increasing from 0 or later.
    pub fn new(times: Vec<f32>) -> Self {
        assert!(times.first().is_some_and(|&first| first >= 0.0), "markers start at 0 or later");
        assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "markers are in order");
        assert!(times.iter().all(|time| time.is_finite()), "markers are finite");
        Self { times }
    }

    /// Times of the markers, seconds from the clip's start, increasing.
    pub fn times(&self) -> &[f32] {
        &self.times
    }

    fn len(&self) -> i64 {
        self.times.len() as i64
    }

    /// Time of marker `index`, counted through all laps, clip seconds from the start of lap 0.
    fn time(&self, index: i64, length: f64) -> f64 {
        let marker = index.rem_euclid(self.len());
        index.div_euclid(self.len()) as f64 * length + f64::from(self.times[marker as usize])
    }

    /// Returns the phase at a position of a loop of `length` seconds.
    pub(crate) fn phase(&self, place: Place, length: f64) -> Phase {
        let passed = self.times.partition_point(|&time| f64::from(time) <= place.time) as i64 - 1;
        let (start, end) = (self.time(passed, length), self.time(passed + 1, length));
        let share = (place.time - start) / (end - start);
        let marker = place.lap.saturating_mul(self.len()).saturating_add(passed);
        Phase { marker, share: if share < 1.0 { share } else { 1.0_f64.next_down() } }
    }

    /// Returns the position in a loop of `length` seconds at a phase.
    pub(crate) fn place(&self, phase: Phase, length: f64) -> Place {
        let (lap, marker) = (phase.marker.div_euclid(self.len()), phase.marker.rem_euclid(self.len()));
        let (start, end) = (self.time(marker, length), self.time(marker + 1, length));
        let time = start + phase.share * (end - start);
        // The position may be after the last marker, before the first marker of the next lap.
        if time >= length { Place { lap: lap + 1, time: time - length } } else { Place { lap, time } }
    }
}

/// Returns the position of a follower at the phase of its leader.
pub(crate) fn follow(leader: &Playhead, markers: &Markers, follower: &Playhead, own: &Markers) -> Place {
    match_place(leader.place(), leader.length(), markers, follower.length(), own)
}

/// Returns the position in a loop of `to_length` seconds at the phase of a position in another loop. Clips with
/// different numbers of markers match by whole laps.
pub(crate) fn match_place(
    place: Place,
    length: f64,
    markers: &Markers,
    to_length: f64,
    to: &Markers,
) -> Place {
    if markers.len() == to.len() {
        return to.place(markers.phase(place, length), to_length);
    }
    let time = place.time / length * to_length;
    Place { lap: place.lap, time: if time < to_length { time } else { to_length.next_down() } }
}
