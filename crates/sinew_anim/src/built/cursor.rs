//! Samples a clip with cached keys around the current time.

use super::code::{Code, Key};
use super::{BuiltClip, TrackBlock, Tracks};
use crate::pose::{Pose, Quaternions, ROTATION, ROWS, SCALE, TRANSLATION};
use sinew_math::clamp;
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::{Block, LaneMask, Lanes, Vector3, WIDTH};

/// Index before a key is loaded; every key is later than this one.
const UNSET: u32 = u32::MAX / 2;
/// Index of a left key before the first key, so that the first key follows it.
const BEFORE: u32 = u32::MAX;

/// Time later than all key times; its negative is earlier. It is finite, so that interpolation with it stays finite.
const FOREVER: f32 = 1e30;

/// The two keys around a time, for eight tracks side by side.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
struct Span<const N: usize> {
    /// Time of the left key.
    start: [f32; WIDTH],
    /// Time of the right key.
    end: [f32; WIDTH],
    left: [[f32; WIDTH]; N],
    right: [[f32; WIDTH]; N],
    /// Index of the left key in its track.
    key: [u32; WIDTH],
}

impl<const N: usize> Span<N> {
    /// Returns a span that contains no time, so that the first access fills it.
    fn unset() -> Self {
        let nothing = [[0.0; WIDTH]; N];
        Self {
            start: [FOREVER; WIDTH],
            end: [-FOREVER; WIDTH],
            left: nothing,
            right: nothing,
            key: [UNSET; WIDTH],
        }
    }
}

/// Playback state of a character in a clip: the decoded keys around its last time.
///
/// A cursor is a cache. After another clip or a jump in time it is slower for one call, but it never changes the pose.
/// It has 360 bytes per eight animated rotations, and 296 bytes per eight animated translations or scales.
#[derive(Clone, Debug, Default)]
pub struct Cursor {
    fingerprint: u64,
    rotations: Vec<Span<4>>,
    translations: Vec<Span<3>>,
    scales: Vec<Span<3>>,
}

impl Cursor {
    /// Creates a cursor without a clip.
    pub fn new() -> Self {
        Self::default()
    }

    /// Copies another cursor into existing memory.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.fingerprint = other.fingerprint;
        self.rotations.clone_from(&other.rotations);
        self.translations.clone_from(&other.translations);
        self.scales.clone_from(&other.scales);
    }

    fn fit(&mut self, clip: &BuiltClip) {
        if self.fingerprint != clip.fingerprint {
            self.fingerprint = clip.fingerprint;
            unset(&mut self.rotations, clip.rotations.blocks.len());
            unset(&mut self.translations, clip.translations.blocks.len());
            unset(&mut self.scales, clip.scales.blocks.len());
        }
    }
}

fn unset<const N: usize>(spans: &mut Vec<Span<N>>, len: usize) {
    spans.clear();
    spans.resize(len, Span::unset());
}

impl BuiltClip {
    /// Writes the local transforms of all joints at `time`, seconds, to `out`. `time` is limited to the clip's
    /// duration (see [`Wrap`](crate::Wrap) and [`Playhead`](crate::Playhead) for times beyond it); NaN is 0. The
    /// result is within [`error_bound`](Self::error_bound) of [`sample`](crate::clip::sample::sample()) for the raw
    /// clip. Values between keys are linear; rotations are normalised (`nlerp`; keys are close enough for that).
    ///
    /// Any `cursor` works. Keeping one saves the key search while time moves by small steps, forward or backward. The
    /// cursor allocates for a clip larger than any before.
    ///
    /// # Panics
    /// If `out` is not as long as [`joints`](Self::joints).
    pub fn sample(&self, time: f32, cursor: &mut Cursor, out: &mut Pose) {
        assert_eq!(out.len(), self.joints(), "a pose has one local transform per joint");
        cursor.fit(self);
        out.copy_from(&self.base);
        let time = clamp(time, 0.0, self.duration);
        dispatch::run(Sample { clip: self, time, cursor, out: out.blocks_mut() });
    }
}

struct Sample<'a> {
    clip: &'a BuiltClip,
    time: f32,
    cursor: &'a mut Cursor,
    out: &'a mut [Block<ROWS>],
}

impl Kernel for Sample<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { clip, time, cursor, out } = self;
        for (tracks, span) in clip.rotations.blocks.iter().zip(&mut cursor.rotations) {
            let block = &mut out[tracks.block];
            let share = advance::<L, _, 4>(clip, &clip.rotations, tracks, ROTATION, time, span);
            rotations_between(span, share).store(block);
        }
        for (tracks, span) in clip.translations.blocks.iter().zip(&mut cursor.translations) {
            let share = advance::<L, _, 3>(clip, &clip.translations, tracks, TRANSLATION, time, span);
            store_between(span, share, TRANSLATION, &mut out[tracks.block]);
        }
        for (tracks, span) in clip.scales.blocks.iter().zip(&mut cursor.scales) {
            let share = advance::<L, _, 3>(clip, &clip.scales, tracks, SCALE, time, span);
            store_between(span, share, SCALE, &mut out[tracks.block]);
        }
    }
}

/// Moves a block's keys to `time`; returns the position between left and right key in each lane, 0 to 1.
#[inline(always)]
fn advance<L: Lanes, C: Code<N>, const N: usize>(
    clip: &BuiltClip,
    all: &Tracks<C>,
    tracks: &TrackBlock<C>,
    row: usize,
    time: f32,
    span: &mut Span<N>,
) -> L {
    let now = L::splat(time);
    let mut stale = (L::lt(now, L::load(&span.start)) | L::ge(now, L::load(&span.end))).bits();
    while stale != 0 {
        let lane = stale.trailing_zeros() as usize;
        stale &= stale - 1;
        refill(clip, all, tracks, row, time, span, lane);
    }
    let start = L::load(&span.start);
    (now - start) / (L::load(&span.end) - start)
}

#[inline(always)]
fn rotations_between<L: Lanes>(span: &Span<4>, share: L) -> Quaternions<L> {
    let [x, y, z, w] = &span.left;
    let left = Quaternions { v: Vector3::load(x, y, z), w: L::load(w) };
    let [x, y, z, w] = &span.right;
    let right = Quaternions { v: Vector3::load(x, y, z), w: L::load(w) };
    let sum = left.plus(right.minus(left).times(share));
    sum.unit(sum.dot(sum))
}

#[inline(always)]
fn store_between<L: Lanes>(span: &Span<3>, share: L, row: usize, block: &mut Block<ROWS>) {
    let [x, y, z] = &span.left;
    let left = Vector3::<L>::load(x, y, z);
    let [x, y, z] = &span.right;
    let [x, y, z] = (left + (Vector3::load(x, y, z) - left) * share).to_array();
    x.store(&mut block.0[row]);
    y.store(&mut block.0[row + 1]);
    z.store(&mut block.0[row + 2]);
}

/// Loads the keys around `time` into one lane. Usually the right key becomes the left one, and the next key the right
/// one.
fn refill<C: Code<N>, const N: usize>(
    clip: &BuiltClip,
    all: &Tracks<C>,
    tracks: &TrackBlock<C>,
    row: usize,
    time: f32,
    span: &mut Span<N>,
    lane: usize,
) {
    // Shows the compiler that the index is in bounds.
    let lane = lane % WIDTH;
    let track = &tracks.tracks[lane];
    let keys = &all.keys[track.first as usize..][..track.count as usize];
    if let Some(next) = keys.get(span.key[lane].wrapping_add(2) as usize) {
        let end = clip.times[usize::from(next.time)];
        if span.end[lane] <= time && time < end {
            span.key[lane] = span.key[lane].wrapping_add(1);
            span.start[lane] = span.end[lane];
            span.end[lane] = end;
            for i in 0..N {
                span.left[i][lane] = span.right[i][lane];
            }
            span.set_right(lane, track.code.decode(next.packed));
            return;
        }
    }
    search(clip, keys, (tracks, row), time, span, lane);
}

/// Finds the keys around `time` by a full search.
#[cold]
fn search<C: Code<N>, const N: usize>(
    clip: &BuiltClip,
    keys: &[Key],
    (tracks, row): (&TrackBlock<C>, usize),
    time: f32,
    span: &mut Span<N>,
    lane: usize,
) {
    let Some(first) = keys.first() else {
        let base = &clip.base.blocks()[tracks.block].0;
        span.hold(lane, core::array::from_fn(|i| base[row + i][lane]), -FOREVER, FOREVER);
        return;
    };
    let time_of = |key: &Key| clip.times[usize::from(key.time)];
    let value_of = |key: &Key| tracks.tracks[lane].code.decode(key.packed);
    if time < time_of(first) {
        span.key[lane] = BEFORE;
        span.hold(lane, value_of(first), -FOREVER, time_of(first));
        return;
    }
    let left = last_not_after(keys, time, time_of);
    span.key[lane] = left;
    let (left, right) = (&keys[left as usize], keys.get(left as usize + 1));
    let Some(right) = right else {
        span.hold(lane, value_of(left), time_of(left), FOREVER);
        return;
    };
    span.set_left(lane, value_of(left));
    span.set_right(lane, value_of(right));
    (span.start[lane], span.end[lane]) = (time_of(left), time_of(right));
}

fn last_not_after(keys: &[Key], time: f32, time_of: impl Fn(&Key) -> f32) -> u32 {
    (keys.partition_point(|key| time_of(key) <= time) - 1) as u32
}

impl<const N: usize> Span<N> {
    /// Holds one value from `start` to `end`.
    fn hold(&mut self, lane: usize, value: [f32; N], start: f32, end: f32) {
        self.set_left(lane, value);
        self.set_right(lane, value);
        (self.start[lane], self.end[lane]) = (start, end);
    }

    #[inline(always)]
    fn set_left(&mut self, lane: usize, value: [f32; N]) {
        for i in 0..N {
            self.left[i][lane] = value[i];
        }
    }

    #[inline(always)]
    fn set_right(&mut self, lane: usize, value: [f32; N]) {
        for i in 0..N {
            self.right[i][lane] = value[i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::{Channel, Clip, Interpolation, Property};
    use crate::rig::{Joint, LocalTransform, Rig};
    use sinew_math::Random;
    use sinew_math::dispatch::{Level, run_at};

    #[test]
    fn samples_have_the_same_bits_on_all_registers() {
        let mut random = Random::new(1);
        let joint =
            |source| Joint { name: String::new(), parent: None, rest: LocalTransform::default(), source };
        let rig = Rig { joints: (0..19).map(joint).collect(), ..Rig::default() };
        let mut clip = Clip { name: String::new(), duration: 1.0, channels: Vec::new() };
        for joint in 0..19 {
            for property in [Property::Rotation, Property::Translation, Property::Scale] {
                let values = (0..3 * property.width()).map(|_| random.range(0.1, 1.0)).collect();
                let (interpolation, times) =
                    (Interpolation::Linear, vec![0.0, 0.3 + 0.3 * random.unit(), 1.0]);
                clip.channels.push(Channel { joint, property, interpolation, times, values });
            }
        }
        let clip =
            BuiltClip::build(&clip, &rig, &crate::built::ClipBuildOptions::default()).expect("a good clip");
        for time in [0.0, 0.2, 0.45, 0.9, 1.0] {
            let on = |level| {
                let (mut cursor, mut out) = (Cursor::new(), Pose::new(19));
                cursor.fit(&clip);
                run_at(level, Sample { clip: &clip, time, cursor: &mut cursor, out: out.blocks_mut() });
                out
            };
            for level in Level::available() {
                assert_eq!(on(level), on(Level::Scalar), "{level:?} at {time}");
            }
        }
    }
}
