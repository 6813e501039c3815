//! A camera that keeps a moving subject in the picture.

use sinew::math::{Vec3, max};
use sinew::physics::boxes::Aabb;
use sinew_picture::Camera;

/// Smoothing window of the camera's path, to each side, seconds.
const CALM: f32 = 0.6;
/// Margin around the subject, as a share of its size: hair and hats extend beyond the bodies.
const MARGIN: f32 = 0.08;
/// The camera does not move if the total extent is at most this many times the largest momentary extent.
const STILL: f32 = 1.7;

/// Returns the distance at which haze hides half of a surface, metres, for a subject of this radius (metres): large
/// subjects are seen from afar.
pub fn haze_distance(radius: f32) -> f32 {
    max(45.0, 15.0 * radius)
}

/// Camera poses of all pictures, with the same direction and distance.
#[derive(Clone, Debug)]
pub struct Framing {
    centers: Vec<Vec3>,
    half: Vec3,
    /// Direction from the subject to the camera, of any length.
    direction: Vec3,
}

impl Framing {
    /// Creates the framing of these boxes, one per picture (metres, world), at `fps` pictures per second.
    ///
    /// # Panics
    /// If there is no box.
    pub fn new(boxes: &[Aabb], fps: f32, direction: Vec3) -> Self {
        let whole = boxes.iter().copied().reduce(|a, b| a.merge(&b)).expect("at least one box is given");
        let size = |bounds: &Aabb| (bounds.max - bounds.min).length();
        let largest = boxes.iter().map(size).fold(0.0, max);
        let reach = (CALM * fps) as usize;
        let mean = |i: usize| {
            let near = &boxes[i.saturating_sub(reach)..(i + reach + 1).min(boxes.len())];
            near.iter().map(Aabb::center).sum::<Vec3>() / near.len() as f32
        };
        let centers: Vec<Vec3> = if size(&whole) <= STILL * largest {
            vec![whole.center(); boxes.len()]
        } else {
            (0..boxes.len()).map(mean).collect()
        };
        let larger = |a: Vec3, b: Vec3| Vec3::new(max(a.x, b.x), max(a.y, b.y), max(a.z, b.z));
        let half = boxes.iter().zip(&centers).fold(Vec3::ZERO, |half, (bounds, &center)| {
            larger(half, larger(bounds.max - center, center - bounds.min))
        });
        let least = max(MARGIN * half.length(), 1e-3);
        Self { centers, half: half + Vec3::splat(least), direction }
    }

    /// Returns the framing from another direction (any length).
    pub fn seen_from(&self, direction: Vec3) -> Self {
        Self { direction, ..self.clone() }
    }

    /// Returns half the diagonal of a picture's visible area, metres.
    pub fn radius(&self) -> f32 {
        self.half.length()
    }

    /// Returns the camera of a picture; the camera does not move after the last one.
    pub fn camera(&self, frame: usize, aspect: f32) -> Camera {
        let center = self.centers[frame.min(self.centers.len() - 1)];
        let shown = Aabb { min: center - self.half, max: center + self.half };
        Camera::framing_box(&shown, self.direction, aspect)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the bounds of a body that walks 12 m and lies down.
    fn walk(frame: usize) -> Aabb {
        let height = if frame % 100 > 60 { 0.3 } else { 1.8 };
        let at = Vec3::X * (0.06 * frame as f32);
        Aabb { min: at - Vec3::new(0.4, 0.0, 0.4), max: at + Vec3::new(0.4, height, 0.4) }
    }

    /// Returns true if the camera's picture contains a whole box, by the angles of its corners.
    fn shows(camera: &Camera, bounds: &Aabb, aspect: f32) -> bool {
        let back = (camera.position - camera.target).normalize();
        let right = Vec3::Y.cross(back).normalize();
        let up = back.cross(right);
        let half = sinew::math::trig::tan(0.5 * camera.fov_y);
        (0..8).all(|corner| {
            let pick = |bit: u8, lo: f32, hi: f32| if corner >> bit & 1 == 1 { hi } else { lo };
            let (min, max) = (bounds.min, bounds.max);
            let point = Vec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z));
            let way = point - camera.position;
            let depth = -way.dot(back);
            depth > 0.0
                && (way.dot(up) / depth).abs() < half
                && (way.dot(right) / depth).abs() < half * aspect
        })
    }

    #[test]
    fn subject_is_always_inside_the_picture() {
        let boxes: Vec<Aabb> = (0..200).map(walk).collect();
        for direction in [Vec3::new(0.75, 0.4, 0.75), Vec3::new(-1.0, 0.1, 0.2), Vec3::new(0.1, 3.0, 0.3)] {
            let framing = Framing::new(&boxes, 20.0, direction);
            for (frame, bounds) in boxes.iter().enumerate() {
                let camera = framing.camera(frame, 1.6);
                assert!(
                    shows(&camera, bounds, 1.6),
                    "bounds outside of the picture in frame {frame}, seen from {direction}"
                );
                // The camera follows closely enough for the subject to be visible.
                assert!(
                    (camera.position - bounds.center()).length() < 8.0,
                    "camera too far away in frame {frame}, seen from {direction}"
                );
            }
        }
    }

    #[test]
    fn camera_does_not_move_for_a_stationary_subject() {
        let boxes: Vec<Aabb> = (0..20).map(walk).collect();
        let framing = Framing::new(&boxes, 20.0, Vec3::ONE);
        assert_eq!(framing.camera(0, 1.6), framing.camera(19, 1.6));
    }
}
