//! Figures of a run, and their bars.

/// Expectation of a figure at the end of a scene's steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Expected {
    /// A closed form and its tolerance.
    Near {
        /// The closed form.
        value: f64,
        /// Absolute, in the figure's unit.
        tolerance: f64,
    },
    /// No more than this.
    AtMost(f64),
    /// Printed for interest.
    Anything,
}

impl Expected {
    /// Within a share of the value itself.
    pub(crate) fn near(value: impl Into<f64>, share: f64) -> Self {
        let value = value.into();
        Self::Near { value, tolerance: value.abs() * share }
    }
}

/// A figure of a run, computed from queries to the world alone. The unit is the end of its name: `_m`, `_s`, `_j`, `_deg` …; shares and
/// counts have none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metric {
    /// Unique in its scene.
    pub name: &'static str,
    /// `None` if the measured event has not happened yet.
    pub value: Option<f64>,
    /// Expectation of the value.
    pub expected: Expected,
}

impl Metric {
    pub(crate) fn new(name: &'static str, value: impl Into<f64>, expected: Expected) -> Self {
        Self { name, value: Some(value.into()), expected }
    }

    /// Figure of something that may not have happened yet.
    pub(crate) fn awaited(name: &'static str, value: Option<f32>, expected: Expected) -> Self {
        Self { name, value: value.map(f64::from), expected }
    }

    /// Returns true if the figure meets its expectation. An event with an expectation must have happened.
    pub fn is_met(&self) -> bool {
        match (self.expected, self.value) {
            (Expected::Anything, _) => true,
            (Expected::Near { value, tolerance }, Some(found)) => (found - value).abs() <= tolerance,
            (Expected::AtMost(most), Some(found)) => found <= most,
            (_, None) => false,
        }
    }
}
