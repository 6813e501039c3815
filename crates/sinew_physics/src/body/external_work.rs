//! Energy added to a world within a step by motors and kinematic bodies.

/// Work of motors, kinematic bodies and movers on dynamic bodies within a step, J; negative if energy is removed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    /// Work of the motors of joints, pins included.
    pub drives: f32,
    /// Work of kinematic bodies, through contacts and joints.
    pub kinematic: f32,
    /// Work of movers on the bodies they push and stand on.
    pub movers: f32,
}

impl Work {
    /// Sum of the work of motors, kinematic bodies and movers, J.
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
