//! Position of a track in a clip, and the events that it passes.

/// Largest lap number, in either direction, of a saved playhead; seconds lose precision beyond it.
const MOST_LAPS: u64 = 1 << 53;

/// Continuation after the end of a clip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LoopMode {
    /// The clip continues at the start; its end and its start count as the same time.
    #[default]
    Loop,
    /// The clip plays backward, then forward again.
    PingPong,
    /// The clip stops: the last pose holds, or the first one if it is played backward.
    Once,
}

/// A position in a clip: whole laps, and time within the lap.
///
/// They are separate so that time keeps its precision in a long run, and passed times are found by comparing positions,
/// for steps of any size. A lap is one pass through the clip, in either direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Playhead {
    mode: LoopMode,
    length: f64,
    at: Place,
    /// True before any event was passed: an event exactly here has not been passed yet.
    is_fresh: bool,
}

/// Laps, and clip seconds in the direction of the lap, from 0 to the clip's length. Only [`LoopMode::Once`] reaches the
/// length.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(crate) struct Place {
    pub lap: i64,
    pub time: f64,
}

impl Playhead {
    /// Creates a playhead at `start`, clip seconds. A start beyond the clip's ends is in another lap, or clamped if the
    /// clip plays once. A clip without length, a pose, plays once.
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

    /// Time at which to sample the clip, seconds from its start, 0 to its length.
    pub fn clip_time(&self) -> f32 {
        self.clip_time_of(self.at) as f32
    }

    /// Number of whole laps since time 0; negative before time 0.
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

    /// Restores a playhead at `at`; `None` if a playhead cannot have that position.
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

    /// Jumps to `time`, clip seconds as in [`new`](Self::new), without passing events.
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

    /// True if the playhead has reached the end in the direction of `speed` and stays there.
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
        // The quotient is rounded, so the remainder may be just outside the clip.
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

/// Passage from one position to another. Forward it passes the times after the first position up to the second;
/// backward, the times before the first position down to the second.
///
/// Several steps therefore pass the same events as one step over the same distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// The previous position.
    playhead: Playhead,
    to: Place,
    is_backward: bool,
}

/// Passage of a playhead over a time of its clip.
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

/// Recurring time of a clip: its position in each period, and the number of laps per period.
#[derive(Clone, Copy)]
struct Recurring {
    at: Place,
    /// Number of laps per period; 0: the time does not recur.
    period: i64,
}

impl Recurring {
    /// Returns the number of the last occurrence at or before `place`, or only before `place`, as `counts` decides.
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
    /// Returns each crossing of the clip time `time`, 0 to the clip's length, in order. The first step after a start or
    /// a seek also crosses a time equal to its start.
    pub fn crossings(self, time: f32) -> impl Iterator<Item = Crossing> {
        self.recurring(f64::from(time)).into_iter().flatten().flat_map(move |moment| self.of(moment))
    }

    fn recurring(&self, time: f64) -> [Option<Recurring>; 2] {
        let length = self.playhead.length;
        let forth = |period| Recurring { at: Place { lap: 0, time }, period };
        // The end of a lap is the start of the next lap.
        let end = |period| Recurring { at: Place { lap: 1, time: 0.0 }, period };
        match self.playhead.mode {
            LoopMode::Once => [Some(forth(0)), None],
            LoopMode::Loop if time >= length => [Some(end(1)), None],
            LoopMode::Loop => [Some(forth(1)), None],
            LoopMode::PingPong if time >= length => [Some(end(2)), None],
            LoopMode::PingPong if time <= 0.0 => [Some(forth(2)), None],
            LoopMode::PingPong => {
                let back = Recurring { at: Place { lap: 1, time: length - time }, period: 2 };
                // The passage that comes first from the current position is first.
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

    /// True if a start at this time counts as passing it; the end of a loop is not its start.
    fn is_fresh_at(&self, moment: &Recurring) -> bool {
        let is_end_of_loop = self.playhead.mode == LoopMode::Loop && moment.at.lap == 1;
        self.playhead.is_fresh && !is_end_of_loop
    }
}
