use std::collections::VecDeque;

/// Source of the first report of a footstep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FootstepSource {
    /// Event of a clip.
    Clip,
    /// Contact reported by physics.
    Contact,
}

/// A footstep: a foot came down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footstep {
    /// The foot, by a number that the user chooses.
    pub foot: u32,
    /// Time, seconds on the user's clock.
    pub time: f64,
    /// Source of the first report.
    pub source: FootstepSource,
}

/// Merges a clip's footsteps and physical contacts into one list of steps.
///
/// Events and contacts within the window after a step of the same foot belong to that step: the contact after an
/// event, the event after a contact, and repeated contacts of a bouncing foot.
#[derive(Clone, Debug)]
pub struct FootstepMerger {
    window: f64,
    /// The last step of each foot, oldest first; none is older than the window.
    last: VecDeque<Footstep>,
}

impl FootstepMerger {
    /// Creates a merger with a `window` in seconds, longer than the delay between clip and physics and shorter than
    /// a step; 0.15 suits most characters.
    ///
    /// # Panics
    /// If `window` is negative or not finite.
    pub fn new(window: f64) -> Self {
        assert!(
            window >= 0.0 && window.is_finite(),
            "the window must be finite and at least 0, not {window}"
        );
        Self { window, last: VecDeque::new() }
    }

    /// Adds the steps of an update to `steps`, by time, each only once. `clip` and `contacts` are `(foot, time)`, in
    /// any order, not earlier than those of previous updates; a time of `NaN` is ignored.
    pub fn merge(&mut self, clip: &[(u32, f64)], contacts: &[(u32, f64)], steps: &mut Vec<Footstep>) {
        let first = steps.len();
        let with = |source| move |&(foot, time): &(u32, f64)| Footstep { foot, time, source };
        steps.extend(clip.iter().map(with(FootstepSource::Clip)));
        steps.extend(contacts.iter().map(with(FootstepSource::Contact)));
        // If a clip's step and a contact have the same time, the clip's step is kept.
        steps[first..].sort_unstable_by(|a, b| {
            let rank = |step: &Footstep| (step.foot, step.source == FootstepSource::Contact);
            a.time.total_cmp(&b.time).then(rank(a).cmp(&rank(b)))
        });
        let mut kept = first;
        for i in first..steps.len() {
            if self.is_new(steps[i]) {
                steps[kept] = steps[i];
                kept += 1;
            }
        }
        steps.truncate(kept);
    }

    fn is_new(&mut self, step: Footstep) -> bool {
        if step.time.is_nan() {
            return false;
        }
        while self.last.front().is_some_and(|last| step.time - last.time > self.window) {
            self.last.pop_front();
        }
        let is_new = self.last.iter().all(|last| last.foot != step.foot);
        if is_new {
            self.last.push_back(step);
        }
        is_new
    }
}
