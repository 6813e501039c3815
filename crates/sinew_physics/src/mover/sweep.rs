//! Capsule sweeps, sliding and depenetration.

use super::obstacle::Surroundings;
use super::planes::{MOST, Planes};
use super::segment::level;
use crate::boxes::Overlap;
use crate::mover::tuning::{
    ARRIVED_SKIN, BEARING_SKIN, BESIDE_RADIUS, COPLANAR_SKIN, LONGEST_DETOUR, LONGEST_WAY_OUT, SLIDE_AWAY,
    STOP_SKIN, TOUCH_SKIN,
};
use sinew_math::{Vec3, clamp, min};

/// Contact of the capsule with a near obstacle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    /// Unit normal from the obstacle to the capsule.
    pub normal: Vec3,
    pub distance: f32,
    /// Point on the obstacle.
    pub point: Vec3,
    /// Index of the obstacle in `Surroundings`.
    pub obstacle: usize,
}

/// Touches within a distance, nearest first; at most `MOST`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touches {
    all: [Touch; MOST],
    count: usize,
}

impl Touches {
    pub fn as_slice(&self) -> &[Touch] {
        &self.all[..self.count]
    }

    fn insert(&mut self, touch: Touch) {
        let mut at = self.count;
        while at > 0 && touch.distance < self.all[at - 1].distance {
            at -= 1;
        }
        if at == MOST {
            return;
        }
        let end = usize::min(self.count, MOST - 1);
        self.all.copy_within(at..end, at + 1);
        self.all[at] = touch;
        self.count = end + 1;
    }

    /// Removes touches behind the plane of a nearer one: the seam of two adjacent boxes, or the edge of the next
    /// triangle. Sweeps still stop at them.
    fn drop_hidden(&mut self, behind: f32) {
        let mut kept = 0;
        for i in 0..self.count {
            let touch = self.all[i];
            let hides = |nearer: &Touch| {
                (touch.point - nearer.point).dot(nearer.normal) < behind
                    && nearer.normal.dot(touch.normal) > 0.0
            };
            if !self.all[..kept].iter().any(hides) {
                self.all[kept] = touch;
                kept += 1;
            }
        }
        self.count = kept;
    }
}

/// Largest approach to a surface that still counts as sliding along it, as a share of the motion.
const ALONG: f32 = 1e-4;
const MOST_STEPS: usize = 48;
const MOST_SLIDES: usize = 8;
const MOST_PUSHES: usize = 8;

/// Rule by which planes change a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Course {
    /// Changes the motion as little as possible: in the air.
    Free,
    /// Changes the vertical part first: on the ground.
    Level,
}

/// Sliding parameters of a mover: its skin, slope limit and course.
#[derive(Clone, Copy, Debug)]
pub(super) struct Manner {
    pub skin: f32,
    /// Cosine of the steepest slope that the mover walks on.
    pub flattest: f32,
    pub course: Course,
}

impl Manner {
    pub fn stop(&self) -> f32 {
        STOP_SKIN * self.skin
    }
}

impl Surroundings<'_> {
    /// Returns the touches within `reach` of the capsule, metres.
    fn near(&self, center: Vec3, reach: f32) -> Touches {
        let nothing = Touch { normal: Vec3::ZERO, distance: 0.0, point: Vec3::ZERO, obstacle: 0 };
        let mut touches = Touches { all: [nothing; MOST], count: 0 };
        let bounds = self.bounds(center, Vec3::ZERO, reach);
        for (number, obstacle) in self.obstacles.iter().enumerate() {
            if !self.is_there(obstacle) || !obstacle.bounds.overlaps(&bounds) {
                continue;
            }
            let Some(gap) = self.gap(obstacle, center) else { continue };
            if gap.distance <= reach {
                let touch =
                    Touch { normal: gap.normal, distance: gap.distance, point: gap.on_a, obstacle: number };
                touches.insert(touch);
            }
        }
        touches
    }

    /// Returns the touches of the capsule within its skin and slightly beyond.
    pub fn touches(&self, center: Vec3, skin: f32) -> Touches {
        let mut touches = self.near(center, skin * (1.0 + TOUCH_SKIN));
        touches.drop_hidden(COPLANAR_SKIN * skin);
        touches
    }

    /// Returns the touches that may support the capsule, slightly farther away than those that stop it.
    pub fn bearers(&self, center: Vec3, skin: f32) -> Touches {
        let mut touches = self.near(center, skin * (1.0 + BEARING_SKIN));
        touches.drop_hidden(COPLANAR_SKIN * skin);
        touches
    }

    /// Returns the share of a motion until an obstacle is at the stop distance from the capsule, and the touch with
    /// that obstacle.
    pub fn sweep(&self, center: Vec3, way: Vec3, manner: &Manner) -> (f32, Option<Touch>) {
        let length = way.length();
        let (mut first, mut hit) = (1.0, None);
        if length <= 0.0 {
            return (first, hit);
        }
        let bounds = self.bounds(center, way, manner.skin);
        for (number, obstacle) in self.obstacles.iter().enumerate() {
            if !self.is_there(obstacle) || !obstacle.bounds.overlaps(&bounds) {
                continue;
            }
            let mut share = 0.0;
            for _ in 0..MOST_STEPS {
                let Some((gap, hidden)) = self.look(obstacle, center + way * share) else { break };
                let approach = -way.dot(gap.normal);
                // A convex obstacle is behind the plane at its nearest point.
                if approach <= ALONG * length {
                    break;
                }
                let left = gap.distance - manner.stop();
                if hidden && left <= ARRIVED_SKIN * manner.skin {
                    // The capsule is beside a face, in its plane: the motion may still pass over the face.
                    share += BESIDE_RADIUS * self.radius / length;
                } else if left <= ARRIVED_SKIN * manner.skin {
                    let touch = Touch {
                        normal: gap.normal,
                        distance: gap.distance,
                        point: gap.on_a,
                        obstacle: number,
                    };
                    (first, hit) = (share, Some(touch));
                    break;
                } else {
                    share += left / approach;
                }
                if share >= first {
                    break;
                }
            }
        }
        (first, hit)
    }

    /// Returns the planes that restrict motion at the capsule's position.
    pub fn planes(&self, center: Vec3, manner: &Manner) -> Planes {
        // A sweep's stop is ignored within the skin; otherwise the capsule would hit the next of two adjacent walls.
        let away = |touch: &Touch| min(manner.skin - touch.distance, SLIDE_AWAY * manner.skin);
        self.planes_of(center, manner, |touch, wall| if wall.is_some() { 0.0 } else { away(touch) })
    }

    /// Returns the planes of the capsule's touches, with `least` as the smallest allowed motion along each normal. A
    /// slope that is too steep also adds a vertical wall; `least` gets the normal of that wall.
    pub fn planes_of(
        &self,
        center: Vec3,
        manner: &Manner,
        least: impl Fn(&Touch, Option<Vec3>) -> f32,
    ) -> Planes {
        let mut planes = Planes::new();
        for touch in self.touches(center, manner.skin).as_slice() {
            planes.push(touch.normal, least(touch, None));
            let rise = touch.normal.dot(self.up);
            if rise > 0.0 && rise < manner.flattest {
                let wall = level(touch.normal, self.up);
                planes.push(wall, least(touch, Some(wall)));
            }
        }
        planes
    }

    /// Returns the end position of a motion that slides along the obstacles.
    pub fn slide(&self, mut center: Vec3, way: Vec3, manner: &Manner) -> Vec3 {
        let mut left = way;
        for _ in 0..MOST_SLIDES {
            let mut planes = self.planes(center, manner);
            let turn = |planes: &Planes| match manner.course {
                Course::Free => planes.closest(left),
                Course::Level => planes.closest_level(left, self.up),
            };
            // Between walls that diverge slightly, the motion that keeps the skin clear of both is long and useless.
            let longest = LONGEST_DETOUR * left.length() + manner.skin;
            let turned = turn(&planes).filter(|turned| turned.length() <= longest).or_else(|| {
                planes.stop();
                turn(&planes)
            });
            let turned = turned.unwrap_or(Vec3::ZERO);
            if turned.length_squared() < 1e-14 {
                break;
            }
            let (share, hit) = self.sweep(center, turned, manner);
            center += turned * share;
            left *= 1.0 - share;
            if hit.is_none() {
                break;
            }
        }
        center
    }

    /// Returns the position of the capsule after depenetration, by the shortest displacement that causes no other
    /// overlap.
    pub fn recover(&self, mut center: Vec3, manner: &Manner) -> Vec3 {
        let (stop, reach) = (manner.stop(), 0.5 * self.radius);
        for _ in 0..MOST_PUSHES {
            let touches = self.near(center, stop * 0.9);
            if touches.as_slice().is_empty() {
                break;
            }
            let around = self.near(center, reach + manner.skin);
            let mut planes = Planes::new();
            for touch in around.as_slice() {
                planes.push(touch.normal, clamp(stop - touch.distance, -reach, reach));
            }
            let deepest = &touches.as_slice()[0];
            let lacking = stop - deepest.distance;
            let out = planes.closest(Vec3::ZERO).filter(|out| out.length() <= LONGEST_WAY_OUT * lacking);
            let out = out.unwrap_or(deepest.normal * (0.5 * lacking));
            let length = out.length();
            center += if length > reach { out * (reach / length) } else { out };
        }
        center
    }
}
