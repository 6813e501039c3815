//! Angles of more than a full turn.

/// Sum of the changes of an angle that changes by less than half a turn per step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Turn {
    last: Option<f32>,
    /// Sum of the motion, radians.
    sum: f64,
    /// Time in which the angle moved, s.
    time: f64,
}

impl Turn {
    pub fn after_step(&mut self, angle: f32, dt: f32) {
        use core::f32::consts::{PI, TAU};
        if let Some(last) = self.last {
            let way = angle - last;
            let way = if way > PI {
                way - TAU
            } else if way < -PI {
                way + TAU
            } else {
                way
            };
            self.sum += f64::from(way);
            self.time += f64::from(dt);
        }
        self.last = Some(angle);
    }

    /// Mean rate of the angle, rad/s.
    pub fn rate(&self) -> Option<f32> {
        (self.time > 0.0).then(|| (self.sum / self.time) as f32)
    }
}
