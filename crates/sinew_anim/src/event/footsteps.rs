use std::collections::VecDeque;

/// Source that saw a footstep first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FootstepSource {
    /// An event of a clip.
    Clip,
    /// A contact that physics reported.
    Contact,
}

/// A foot came down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footstep {
    /// The foot, by a number of the user's.
    pub foot: u32,
    /// When, seconds on the user's clock.
    pub time: f64,
    /// Who saw it first.
    pub source: FootstepSource,
}

/// Makes one list of steps out of a clip's footsteps and of physical contacts: what both see is one step.
///
/// Of one foot, whatever comes within the window after a step is that step again: the contact that belongs to an event, the
/// event that belongs to a contact, and a foot that bounces.
#[derive(Clone, Debug)]
pub struct FootstepMerger {
    window: f64,
    /// The last step of each foot, oldest first; none is older than the window.
    last: VecDeque<Footstep>,
}

impl FootstepMerger {
    /// `window` in seconds: longer than clip and physics are apart, shorter than a step; 0.15 suits most.
    ///
    /// # Panics
    /// If `window` is negative or not finite.
    pub fn new(window: f64) -> Self {
        assert!(window >= 0.0 && window.is_finite(), "a window is 0 or longer, not {window}");
        Self { window, last: VecDeque::new() }
    }

    /// Adds to `steps` those of an update, by time, each once. `clip` and `contacts` are `(foot, time)`, in any order, and no
    /// earlier than those of the updates before; `NaN` counts for nothing.
    pub fn merge(&mut self, clip: &[(u32, f64)], contacts: &[(u32, f64)], steps: &mut Vec<Footstep>) {
        let first = steps.len();
        let with = |source| move |&(foot, time): &(u32, f64)| Footstep { foot, time, source };
        steps.extend(clip.iter().map(with(FootstepSource::Clip)));
        steps.extend(contacts.iter().map(with(FootstepSource::Contact)));
        // Of a clip's step and a contact at one moment the clip's stays.
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
