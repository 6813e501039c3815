//! Metrics of a run, and their expectations.

/// Expectation of a metric at the end of a scene's steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Expected {
    /// The value of a closed form within a tolerance.
    Near {
        /// Value of the closed form.
        value: f64,
        /// Absolute tolerance, in the metric's unit.
        tolerance: f64,
    },
    /// At most this value.
    AtMost(f64),
    /// Any value; the metric is only printed.
    Anything,
}

impl Expected {
    /// Expects a value within a relative tolerance.
    pub(crate) fn near(value: impl Into<f64>, share: f64) -> Self {
        let value = value.into();
        Self::Near { value, tolerance: value.abs() * share }
    }
}

/// A metric of a run, computed only from queries of the world. Its name ends in its unit: `_m`, `_s`, `_j`, `_deg` and
/// so on; shares and counts have none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metric {
    /// Name, unique in its scene.
    pub name: &'static str,
    /// Measured value; `None` if the measured event has not happened yet.
    pub value: Option<f64>,
    /// Expectation of the value.
    pub expected: Expected,
}

impl Metric {
    pub(crate) fn new(name: &'static str, value: impl Into<f64>, expected: Expected) -> Self {
        Self { name, value: Some(value.into()), expected }
    }

    /// Creates the metric of an event that may not have happened yet.
    pub(crate) fn awaited(name: &'static str, value: Option<f32>, expected: Expected) -> Self {
        Self { name, value: value.map(f64::from), expected }
    }

    /// Returns true if the metric meets its expectation. An event with an expectation must have happened.
    pub fn is_met(&self) -> bool {
        match (self.expected, self.value) {
            (Expected::Anything, _) => true,
            (Expected::Near { value, tolerance }, Some(found)) => (found - value).abs() <= tolerance,
            (Expected::AtMost(most), Some(found)) => found <= most,
            (_, None) => false,
        }
    }
}
