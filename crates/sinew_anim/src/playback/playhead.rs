//! Position of a track in a clip, and the moments that it passes.

/// Largest lap number, in either direction, of a saved playhead: beyond it seconds lose precision.
const MOST_LAPS: u64 = 1 << 53;

/// Continuation after the end of a clip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LoopMode {
    /// Continues at the start; end and start are one time.
    #[default]
    Loop,
    /// Backward, then forward again.
    PingPong,
    /// Stops: the last pose holds, and played backward the first.
    Once,
}

/// A position in a clip: whole laps, and time within one.
///
/// They are separate so that time keeps precision in a long run, and passed moments are found by comparing positions,
/// whatever the steps in between. A lap is once through the clip, in either direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Playhead {
    mode: LoopMode,
    length: f64,
    at: Place,
    /// True before any event was passed: an event exactly here is still to come.
    is_fresh: bool,
}

/// Laps, and clip seconds in the direction of the lap: 0 to the clip's length, which only [`LoopMode::Once`] reaches.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(crate) struct Place {
    pub lap: i64,
    pub time: f64,
}

impl Playhead {
    /// Creates a playhead at `start`, clip seconds: beyond the clip's ends in another lap, or clamped if it plays once.
    /// A clip without length, a pose, plays once.
    ///
    /// # Panics
    /// If `length` is negative, or a number is not finite.
    pub fn new(mode: LoopMode, length: f32, start: f64) -> Self {
        assert!(length >= 0.0 && length.is_finite(), "the length of a clip must be at least 0, not {length}");
        let at = Place { lap: 0, time: 0.0 };
        let mode = if length > 0.0 { mode } else { LoopMode::Once };
        let mut playhead = Self { mode, length: f64::from(length), at, is_fresh: true };
        playhead.seek(start);
        playhead
    }

    /// Continuation after the end.
    pub fn mode(&self) -> LoopMode {
        self.mode
    }

    /// Time to sample the clip at, seconds from its start, 0 to its length.
    pub fn clip_time(&self) -> f32 {
        self.clip_time_of(self.at) as f32
    }

    /// Whole laps since time 0, less than 0 before it.
    pub fn lap(&self) -> i64 {
        self.at.lap
    }

    pub(crate) fn place(&self) -> Place {
        self.at
    }

    pub(crate) fn is_fresh(&self) -> bool {
        self.is_fresh
    }

    pub(crate) fn length(&self) -> f64 {
        self.length
    }

    /// The playhead when it was at `place`; `None` if it cannot have been there.
    pub(crate) fn restored(mode: LoopMode, length: f32, at: Place, is_fresh: bool) -> Option<Self> {
        let mode = if length > 0.0 { mode } else { LoopMode::Once };
        let length = f64::from(length);
        let is_inside = match mode {
            LoopMode::Once => at.lap == 0 && at.time >= 0.0 && at.time <= length,
            LoopMode::Loop | LoopMode::PingPong => {
                at.time >= 0.0 && at.time < length && at.lap.unsigned_abs() <= MOST_LAPS
            }
        };
        is_inside.then_some(Self { mode, length, at, is_fresh })
    }

    /// Jumps to `time`, clip seconds as in [`new`](Self::new), and passes nothing on its way.
    ///
    /// # Panics
    /// If `time` is not finite.
    pub fn seek(&mut self, time: f64) {
        assert!(time.is_finite(), "the time must be finite, not {time}");
        self.at = self.moved(Place { lap: 0, time: 0.0 }, time);
        self.is_fresh = true;
    }

    /// Advances by `seconds` of the clip, backward if negative.
    ///
    /// # Panics
    /// If `seconds` is not finite.
    pub fn advance(&mut self, seconds: f64) -> Passage {
        assert!(seconds.is_finite(), "the time must be finite, not {seconds}");
        self.move_to(self.moved(self.at, seconds), seconds < 0.0)
    }

    pub(crate) fn move_to(&mut self, to: Place, is_backward: bool) -> Passage {
        let passage = Passage { playhead: *self, to, is_backward };
        self.at = to;
        self.is_fresh = false;
        passage
    }

    /// True if it has reached the end in the direction of `speed` and stays there.
    pub fn is_at_end(&self, speed: f64) -> bool {
        let end = if speed < 0.0 { 0.0 } else { self.length };
        self.mode == LoopMode::Once && speed != 0.0 && self.at.time == end
    }

    fn moved(&self, from: Place, seconds: f64) -> Place {
        let time = from.time + seconds;
        if self.mode == LoopMode::Once {
            let inside = if time > 0.0 { time } else { 0.0 };
            return Place { lap: 0, time: if inside < self.length { inside } else { self.length } };
        }
        let laps = (time / self.length).floor();
        let rest = time - laps * self.length;
        // The quotient is rounded, so the remainder may lie just outside.
        let (laps, rest) = if rest < 0.0 {
            (laps - 1.0, rest + self.length)
        } else if rest >= self.length {
            (laps + 1.0, rest - self.length)
        } else {
            (laps, rest)
        };
        let (laps, rest) = if rest >= self.length { (laps + 1.0, 0.0) } else { (laps, rest) };
        Place { lap: from.lap.saturating_add(laps as i64), time: rest }
    }

    fn is_way_back(&self, lap: i64) -> bool {
        self.mode == LoopMode::PingPong && lap.rem_euclid(2) == 1
    }

    fn clip_time_of(&self, place: Place) -> f64 {
        if self.is_way_back(place.lap) { self.length - place.time } else { place.time }
    }

    /// Clip seconds from `a` to `b`, in the direction of the laps.
    pub(crate) fn distance(&self, a: Place, b: Place) -> f64 {
        b.lap.saturating_sub(a.lap) as f64 * self.length + (b.time - a.time)
    }
}

/// Passes from one position to another: forward everything after the first up to the second, backward everything before
/// the first down to the second.
///
/// Several steps therefore pass the same events as one step over the same distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// The previous position.
    playhead: Playhead,
    to: Place,
    is_backward: bool,
}

/// A passed moment of a clip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    pub(crate) place: Place,
    /// Distance from the start of the passage, clip seconds, negative backward.
    pub distance: f64,
}

impl Crossing {
    /// Lap in which it was passed.
    pub fn lap(&self) -> i64 {
        self.place.lap
    }
}

/// Recurring moment of a clip: its place in each period, and the number of laps per period.
#[derive(Clone, Copy)]
struct Recurring {
    at: Place,
    /// Number of laps per period; 0: the moment does not recur.
    period: i64,
}

impl Recurring {
    /// Number of its last occurrence at or before `place`, or before it.
    fn last(&self, place: Place, counts: impl Fn(f64, f64) -> bool) -> i64 {
        let laps = place.lap.saturating_sub(self.at.lap);
        let (number, rest) = if self.period == 0 {
            (0, laps)
        } else {
            (laps.div_euclid(self.period), laps.rem_euclid(self.period))
        };
        if rest > 0 || (rest == 0 && counts(self.at.time, place.time)) { number } else { number - 1 }
    }

    fn place(&self, number: i64) -> Place {
        Place { lap: self.at.lap + number * self.period, time: self.at.time }
    }
}

impl Passage {
    /// Every passage of the moment `time` of the clip, 0 to its length, in order. The first step after a start or a
    /// seek passes a moment exactly there too.
    pub fn crossings(self, time: f32) -> impl Iterator<Item = Crossing> {
        self.recurring(f64::from(time)).into_iter().flatten().flat_map(move |moment| self.of(moment))
    }

    fn recurring(&self, time: f64) -> [Option<Recurring>; 2] {
        let length = self.playhead.length;
        let forth = |period| Recurring { at: Place { lap: 0, time }, period };
        // The end of a lap is the start of the next one.
        let end = |period| Recurring { at: Place { lap: 1, time: 0.0 }, period };
        match self.playhead.mode {
            LoopMode::Once => [Some(forth(0)), None],
            LoopMode::Loop if time >= length => [Some(end(1)), None],
            LoopMode::Loop => [Some(forth(1)), None],
            LoopMode::PingPong if time >= length => [Some(end(2)), None],
            LoopMode::PingPong if time <= 0.0 => [Some(forth(2)), None],
            LoopMode::PingPong => {
                let back = Recurring { at: Place { lap: 1, time: length - time }, period: 2 };
                // The one that comes first from here, first.
                let is_back_first = self.playhead.is_way_back(self.playhead.at.lap) != self.is_backward;
                if is_back_first { [Some(back), Some(forth(2))] } else { [Some(forth(2)), Some(back)] }
            }
        }
    }

    fn of(self, moment: Recurring) -> impl Iterator<Item = Crossing> {
        let (from, to) = (self.playhead.at, self.to);
        let not_after = |place| moment.last(place, |moment, place| moment <= place);
        let before = |place| moment.last(place, |moment, place| moment < place);
        let (first, last) = if self.is_backward {
            (before(to) + 1, if self.is_fresh_at(&moment) { not_after(from) } else { before(from) })
        } else {
            (if self.is_fresh_at(&moment) { before(from) } else { not_after(from) } + 1, not_after(to))
        };
        let count = (last - first + 1).max(0);
        (0..count).map(move |i| {
            let place = moment.place(if self.is_backward { last - i } else { first + i });
            Crossing { place, distance: self.playhead.distance(from, place) }
        })
    }

    /// True if a start at the moment counts as passing it: the end of a loop is not its start.
    fn is_fresh_at(&self, moment: &Recurring) -> bool {
        let is_end_of_loop = self.playhead.mode == LoopMode::Loop && moment.at.lap == 1;
        self.playhead.is_fresh && !is_end_of_loop
    }
}
