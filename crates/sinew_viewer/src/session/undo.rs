//! Undo and redo of operations and edits.

use super::{Run, Session};
use sinew::ragdoll::settings::BoneSettings;
use sinew_scenes::recording::{Operation, RecorderMark};

/// Largest number of changes that can be undone; each keeps the whole state of a scene.
const MOST: usize = 20;

/// Changes that can be undone and redone, the last one at the end.
#[derive(Debug, Default)]
pub(super) struct Undo {
    past: Vec<Change>,
    future: Vec<Change>,
    /// True while a slider is dragged, which gives many operations.
    slides: bool,
}

/// Way back from a change.
#[derive(Debug)]
enum Change {
    /// State of the run.
    Moment(Box<RecorderMark>),
    /// Edits of a body of the ragdoll.
    Wish(usize, BoneSettings),
}

impl Undo {
    /// Returns true if an operation begins a change that can be undone: motions of the mouse within a pull, releases and steps of
    /// a walk do not.
    pub fn begins(&mut self, operation: &Operation) -> bool {
        let slides = matches!(operation, Operation::Gravity { .. });
        let continues = core::mem::replace(&mut self.slides, slides) && slides;
        let is_part =
            matches!(operation, Operation::Lead { .. } | Operation::Release | Operation::Steer { .. });
        !continues && !is_part
    }

    /// Stores the state before an operation.
    pub fn changed(&mut self, before: RecorderMark) {
        self.push(Change::Moment(Box::new(before)));
    }

    /// Stores the edits of a body before a new one.
    pub fn edited(&mut self, body: usize, before: BoneSettings) {
        self.push(Change::Wish(body, before));
    }

    fn push(&mut self, change: Change) {
        self.future.clear();
        if self.past.len() == MOST {
            self.past.remove(0);
        }
        self.past.push(change);
    }

    /// Returns the edits alone: states of a run end with it.
    pub fn of_edits(mut self) -> Self {
        for list in [&mut self.past, &mut self.future] {
            list.retain(|change| matches!(change, Change::Wish(..)));
        }
        self
    }

    /// Undoes or redoes the last change of a session; returns false if there is none.
    pub fn go(&mut self, session: &mut Session, redo: bool) -> Result<bool, String> {
        let (from, to) =
            if redo { (&mut self.future, &mut self.past) } else { (&mut self.past, &mut self.future) };
        let Some(change) = from.pop() else { return Ok(false) };
        match change {
            Change::Moment(mark) => {
                let Run::Live(recorder) = &mut session.run else { return Ok(false) };
                to.push(Change::Moment(Box::new(recorder.mark())));
                if !recorder.go_to(&mark) {
                    return Err("this scene cannot return to an earlier state".to_owned());
                }
                // The second run has no saved state of that time, so it is dropped.
                session.twin = None;
                session.begin_trails();
                let steps = session.world().step_count() as usize;
                session.poses.truncate(steps + 1);
            }
            Change::Wish(body, wish) => {
                let workbench = session.workbench.as_mut().ok_or("there is no ragdoll to edit")?;
                to.push(Change::Wish(body, workbench.wish(body)));
                workbench.set_wish(body, wish)?;
                for list in [from, to] {
                    list.retain(|change| matches!(change, Change::Wish(..)));
                }
                session.restart().map_err(|error| error.to_string())?;
            }
        }
        Ok(true)
    }
}
