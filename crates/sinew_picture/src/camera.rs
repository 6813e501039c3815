use crate::pipeline::raster::LANE_NUMBERS;
use sinew::math::lanes::{Lanes, Vector3};
use sinew::math::{Vec3, clamp, max, normalize_or, trig};
use sinew::physics::boxes::Aabb;

/// An upright pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Position of the eye, world space, metres.
    pub position: Vec3,
    /// Centre of the picture, world space, metres. Shadows are sharpest around this point.
    pub target: Vec3,
    /// Angle between the upper and the lower edge of the picture, radians, above 0 and below π.
    pub fov_y: f32,
}

/// A vertical field of view without visible distortion of a person, radians (35°).
const PORTRAIT_FOV: f32 = 0.610_865_24;

impl Camera {
    /// Returns a camera with a field of view of 35° that looks at a ball from `direction` (from the ball to the camera, any length),
    /// so that the ball just fits between the upper and the lower edge of the picture.
    pub fn framing(center: Vec3, radius: f32, direction: Vec3) -> Self {
        let distance = framing_distance(radius, PORTRAIT_FOV);
        let direction = normalize_or(direction, Vec3::Z);
        Self { position: center + direction * distance, target: center, fov_y: PORTRAIT_FOV }
    }

    /// Returns a camera with a field of view of 35° that looks at the centre of a box (world space, metres) from
    /// `direction` (toward the camera, any length). Its distance is just enough for the whole box on a picture `aspect`
    /// times as wide as high.
    pub fn framing_box(bounds: &Aabb, direction: Vec3, aspect: f32) -> Self {
        let back = normalize_or(direction, Vec3::Z);
        let right = normalize_or(Vec3::Y.cross(back), Vec3::X);
        let up = back.cross(right);
        let half_height = trig::tan(0.5 * PORTRAIT_FOV);
        let half_width = half_height * aspect;
        let (center, half) = (bounds.center(), (bounds.max - bounds.min) * 0.5);
        let mut distance = 2.0 * NEAR;
        for corner in 0..8 {
            let sign = |bit: usize| if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
            let corner = Vec3::new(half.x * sign(0), half.y * sign(1), half.z * sign(2));
            let across = max(corner.dot(right).abs() / half_width, corner.dot(up).abs() / half_height);
            distance = max(distance, corner.dot(back) + across);
        }
        Self { position: center + back * distance, target: center, fov_y: PORTRAIT_FOV }
    }
}

/// Axes of a camera's picture, unit length, world space, and the picture's half extents at a distance of 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureAxes {
    /// Direction to the right.
    pub right: Vec3,
    /// Direction up on the picture.
    pub up: Vec3,
    /// Direction into the picture.
    pub forward: Vec3,
    /// Half of the picture's width at depth 1.
    pub half_width: f32,
    /// Half of the picture's height at depth 1.
    pub half_height: f32,
}

impl Camera {
    /// Returns the axes of a picture `aspect` times as wide as high.
    pub fn axes(&self, aspect: f32) -> PictureAxes {
        let forward = normalize_or(self.target - self.position, -Vec3::Z);
        // With a view straight up or down, any right-hand direction is valid.
        let right = normalize_or(forward.cross(Vec3::Y), Vec3::X);
        let up = right.cross(forward);
        let half_height = trig::tan(0.5 * clamp(self.fov_y, 0.01, 3.1));
        PictureAxes { right, up, forward, half_width: half_height * aspect, half_height }
    }
}

/// Returns the distance from the eye at which a ball just fits into the field of view, metres.
fn framing_distance(radius: f32, fov_y: f32) -> f32 {
    radius / trig::sin(0.5 * fov_y)
}

/// A camera that follows a character smoothly. The camera stands still while the character stays near the centre of the picture, and
/// otherwise glides after the character.
#[derive(Clone, Debug, PartialEq)]
pub struct FollowCamera {
    /// Direction from the subject to the camera, unit, world space.
    pub direction: Vec3,
    /// Distance from the centre of the view to the camera, metres.
    pub distance: f32,
    /// Vertical field of view, as [`Camera::fov_y`].
    pub fov_y: f32,
    /// Time in which the lag behind the subject shrinks to 1/e, seconds, above 0. Default 0.35.
    pub time_constant: f32,
    /// Distance that the subject may move from the centre before the camera follows, metres. Default a fifth of the
    /// radius.
    pub slack: f32,
    /// Largest distance of the subject from the centre, metres. Default 0.7 of the radius.
    pub reach: f32,
    target: Vec3,
}

impl FollowCamera {
    /// Returns a camera that frames a ball of `radius` metres around `subject`, seen from `direction` (toward the camera, any length).
    pub fn new(subject: Vec3, radius: f32, direction: Vec3) -> Self {
        Self {
            direction: normalize_or(direction, Vec3::Z),
            distance: framing_distance(radius, PORTRAIT_FOV),
            fov_y: PORTRAIT_FOV,
            time_constant: 0.35,
            slack: 0.2 * radius,
            reach: 0.7 * radius,
            target: subject,
        }
    }

    /// Returns a portrait view: 40° off the facing direction of a character, 16° above, so that front, side and top are visible.
    /// `facing` is horizontal, any length.
    pub fn three_quarter(subject: Vec3, radius: f32, facing: Vec3) -> Self {
        let front = normalize_or(Vec3::new(facing.x, 0.0, facing.z), Vec3::Z);
        let left = Vec3::Y.cross(front);
        let (sin_turn, cos_turn) = trig::sin_cos(0.698_131_7);
        let (sin_lift, cos_lift) = trig::sin_cos(0.279_252_68);
        let direction = (front * cos_turn + left * sin_turn) * cos_lift + Vec3::Y * sin_lift;
        Self::new(subject, radius, direction)
    }

    /// Moves the camera for `dt` seconds toward the present position of the subject. A subject that is not finite is ignored.
    ///
    /// Exponential decay of the lag, solved exactly over `dt`: two half steps are one whole step.
    pub fn update(&mut self, subject: Vec3, dt: f32) {
        if !subject.is_finite() {
            return;
        }
        let lag = subject - self.target;
        let distance = lag.length();
        if distance <= self.slack {
            return;
        }
        let decay = trig::exp(-max(dt, 0.0) / max(self.time_constant, 1e-6));
        let left_over = clamp(self.slack + (distance - self.slack) * decay, 0.0, max(self.reach, self.slack));
        self.target = subject - lag * (left_over / distance);
    }

    /// Returns the camera at its present position.
    pub fn camera(&self) -> Camera {
        Camera {
            position: self.target + self.direction * self.distance,
            target: self.target,
            fov_y: self.fov_y,
        }
    }
}

/// Smallest depth that is drawn, metres.
pub const NEAR: f32 = 0.05;

/// A camera prepared for a picture size: world → clip space and pixel → ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    pub(crate) eye: Vec3,
    /// Rows of the map from world to clip space, without the translation: x and y already divided by the picture's half size at depth
    /// 1.
    rows: [Vec3; 3],
    /// Ray through the upper left corner of the picture, and change of the ray per pixel to the right and down.
    corner_ray: Vec3,
    ray_per_pixel: [Vec3; 2],
}

impl View {
    pub(crate) fn new(camera: &Camera, width: u32, height: u32) -> Self {
        let PictureAxes { right, up, forward, half_height, .. } = camera.axes(1.0);
        let half_width = half_height * width as f32 / height as f32;
        Self {
            eye: camera.position,
            rows: [right / half_width, up / half_height, forward],
            corner_ray: forward - right * half_width + up * half_height,
            ray_per_pixel: [
                right * (2.0 * half_width / width as f32),
                up * (-2.0 * half_height / height as f32),
            ],
        }
    }

    /// Returns clip coordinates: the picture spans ±w in x and y, w is the depth in metres.
    #[inline(always)]
    pub(crate) fn clip_from_world(&self, p: Vec3) -> [f32; 3] {
        let v = p - self.eye;
        [v.dot(self.rows[0]), v.dot(self.rows[1]), v.dot(self.rows[2])]
    }

    /// Returns the ray, with depth 1, through a point of the picture in pixels from the upper left corner.
    #[inline(always)]
    pub(crate) fn ray(&self, x: f32, y: f32) -> Vec3 {
        self.corner_ray + self.ray_per_pixel[0] * x + self.ray_per_pixel[1] * y
    }

    /// Returns [`Self::ray`] through the centres of pixels side by side, the first at `x`.
    #[inline(always)]
    pub(crate) fn rays<L: Lanes>(&self, x: f32, y: f32) -> Vector3<L> {
        let x = L::splat(x) + L::load(&LANE_NUMBERS) + L::splat(0.5);
        let [across, down] = self.ray_per_pixel.map(Vector3::splat);
        Vector3::splat(self.corner_ray) + across * x + down * L::splat(y)
    }

    /// Returns the change of [`Self::ray`] from a pixel to the next, to the right and down.
    #[inline(always)]
    pub(crate) fn ray_per_pixel(&self) -> [Vec3; 2] {
        self.ray_per_pixel
    }

    /// Returns the side of a pixel at depth 1, metres.
    pub(crate) fn pixel_size(&self) -> f32 {
        self.ray_per_pixel[1].length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_and_clip_space_are_inverse() {
        let camera =
            Camera { position: Vec3::new(3.0, 2.0, 5.0), target: Vec3::new(0.0, 1.0, 0.0), fov_y: 0.7 };
        let view = View::new(&camera, 640, 360);
        for (x, y) in [(0.0, 0.0), (640.0, 10.0), (320.0, 180.0), (17.5, 359.5)] {
            let [cx, cy, w] = view.clip_from_world(camera.position + view.ray(x, y) * 4.0);
            let (px, py) = ((cx / w + 1.0) * 320.0, (1.0 - cy / w) * 180.0);
            assert!(
                (px - x).abs() < 1e-2 && (py - y).abs() < 1e-2 && (w - 4.0).abs() < 1e-4,
                "{px} {py} {w}"
            );
        }
    }

    #[test]
    fn following_does_not_depend_on_the_frame_rate() {
        let mut coarse = FollowCamera::three_quarter(Vec3::Y, 2.0, Vec3::X);
        let mut fine = coarse.clone();
        let goal = Vec3::new(1.2, 0.4, -0.3);
        coarse.update(goal, 0.5);
        for _ in 0..60 {
            fine.update(goal, 0.5 / 60.0);
        }
        assert!((coarse.camera().target - fine.camera().target).length() < 1e-4);
        assert!((coarse.camera().target - Vec3::Y).length() > 0.5);
    }

    #[test]
    fn the_camera_follows_and_ignores_small_motion() {
        let mut follow = FollowCamera::new(Vec3::ZERO, 2.0, Vec3::Z);
        follow.update(Vec3::new(0.3, 0.0, 0.0), 0.1);
        assert_eq!(follow.camera().target, Vec3::ZERO);
        follow.update(Vec3::new(90.0, 0.0, 0.0), 0.001);
        assert!((follow.camera().target - Vec3::new(90.0, 0.0, 0.0)).length() <= follow.reach + 1e-3);
        follow.update(Vec3::NAN, 0.1);
        assert!(follow.camera().target.is_finite());
    }

    #[test]
    fn framing_fits_the_box_and_no_more() {
        let bounds = Aabb { min: Vec3::new(-1.0, 0.0, 2.0), max: Vec3::new(4.0, 0.5, 2.2) };
        for direction in [Vec3::Z, Vec3::new(0.4, 0.3, 1.0), Vec3::new(-1.0, 2.0, 0.1), Vec3::Y] {
            let camera = Camera::framing_box(&bounds, direction, 16.0 / 9.0);
            let view = View::new(&camera, 640, 360);
            let mut farthest = 0.0;
            for corner in 0..8 {
                let pick = |bit: usize, lo: f32, hi: f32| if corner >> bit & 1 == 1 { hi } else { lo };
                let Aabb { min, max } = bounds;
                let corner = Vec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z));
                let [x, y, w] = view.clip_from_world(corner);
                farthest = sinew::math::max(farthest, sinew::math::max((x / w).abs(), (y / w).abs()));
            }
            assert!((farthest - 1.0).abs() < 1e-3, "from {direction}: farthest corner at {farthest}");
        }
    }

    #[test]
    fn framing_fits_the_ball() {
        let camera = Camera::framing(Vec3::new(0.0, 1.0, 0.0), 1.0, Vec3::new(1.0, 0.4, 1.0));
        let distance = (camera.position - camera.target).length();
        assert!((trig::asin(1.0 / distance) - 0.5 * camera.fov_y).abs() < 1e-4);
    }
}
