//! A camera that follows its subject.

use sinew::math::{Vec3, min, trig};

/// Time in which the lag shrinks to 1/e, seconds, long enough that swinging limbs do not shake the camera.
const LAG: f32 = 0.3;
/// Largest distance of the subject from the centre, as a share of the camera's distance: a fall down stairs stays in
/// the picture, and after a jump the camera arrives without a lag.
const REACH: f32 = 0.16;

/// Point that follows a subject with a smooth lag, metres, world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chase(Vec3);

impl Chase {
    /// Creates a camera that points at the subject.
    pub fn at(subject: Vec3) -> Self {
        Self(subject)
    }

    /// Moves the point toward the subject for a time in seconds, or at once if the time is infinite; returns its
    /// displacement. `distance` is that of the camera from its target.
    pub fn go(&mut self, subject: Vec3, seconds: f32, distance: f32) -> Vec3 {
        let lag = subject - self.0;
        let length = lag.length();
        if !(length > 0.0 && length.is_finite()) {
            return Vec3::ZERO;
        }
        let left = min(length * trig::exp(-seconds / LAG), REACH * distance);
        let way = lag * (1.0 - left / length);
        self.0 += way;
        way
    }
}

#[cfg(test)]
mod tests {
    use super::{Chase, REACH};
    use sinew::math::Vec3;

    #[test]
    fn camera_moves_smoothly_and_keeps_its_subject_in_view() {
        let mut chase = Chase::at(Vec3::ZERO);
        let way = chase.go(Vec3::X * 0.1, 0.02, 5.0);
        assert!(way.x > 0.0 && way.x < 0.1, "{way:?}");
        let far = Vec3::new(40.0, -3.0, 7.0);
        chase.go(far, 0.02, 5.0);
        assert!((chase.0 - far).length() < REACH * 5.0 + 1e-4);
        chase.go(far, f32::INFINITY, 5.0);
        assert!((chase.0 - far).length() < 1e-4);
        assert_eq!(chase.go(chase.0, 0.02, 5.0), Vec3::ZERO);
        assert_eq!(chase.go(Vec3::NAN, 0.02, 5.0), Vec3::ZERO);
    }
}
