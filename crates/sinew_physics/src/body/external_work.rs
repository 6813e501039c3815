//! Energy that comes into a world within a step: of motors, and of bodies that move by themselves.

/// Work done on dynamic bodies within a step, J. What it takes out of them is negative.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    /// Work of the motors of joints, pins included.
    pub drives: f32,
    /// Work of kinematic bodies, through contacts and joints.
    pub kinematic: f32,
    /// Work of movers on what they push and stand on.
    pub movers: f32,
}

impl Work {
    /// All together, J.
    pub fn total(self) -> f32 {
        self.drives + self.kinematic + self.movers
    }
}

impl core::ops::Add for Work {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            drives: self.drives + other.drives,
            kinematic: self.kinematic + other.kinematic,
            movers: self.movers + other.movers,
        }
    }
}
