//! One tip: its motion over a tick and over a part of a tick, and its constraints.

use super::collide::{Gap, Placed, Surroundings};
use super::rig::Bone;
use super::step::SpringStep;
use super::tuning::SLIGHT_DRAG;
use sinew_anim::LocalTransform;
use sinew_math::trig::pow;
use sinew_math::{Affine, Mat3, Rotation, Vec3, normalize_or};

/// Number of times that a tip is pushed out of the world within a tick. One is not enough, because a corner has two
/// sides.
const PUSHES: usize = 2;

/// A bone with all constraints and forces on its tip.
pub(super) struct Around<'a> {
    pub placed: &'a [Placed],
    /// Displacement of each collider since the last tick, for continuous collision.
    pub moved: &'a [Option<Affine>],
    pub step: &'a SpringStep<'a>,
    pub meets: Option<Surroundings<'a>>,
    pub index: usize,
    pub held: &'a Held<'a>,
}

impl Around<'_> {
    /// Returns the position of the tip one tick later, from its position `tip`, displacement `way` and an added
    /// displacement `push`; `from` is its world position.
    #[inline]
    pub fn tick(&self, tip: Vec3, from: Vec3, way: Vec3, push: Vec3) -> Vec3 {
        let [keeps, pushed] = flight(self.held.bone.drag, 1.0);
        let next = self.held.hold(tip, way * keeps + push * pushed);
        self.push_out(self.stopped(from, next), None)
    }

    /// Returns the end position of a tip that moves from one position to another. A tip does not pass through a
    /// collider or the world, even if it is so fast that its end position alone would not touch them.
    #[inline]
    fn stopped(&self, from: Vec3, mut next: Vec3) -> Vec3 {
        let (rig, bone) = (self.step.rig, self.held.bone);
        if !self.placed.is_empty() {
            for &collider in &rig.chains[bone.chain].colliders {
                let Some(moved) = &self.moved[collider] else { continue };
                if let Some(to) = self.placed[collider].stop(moved.point(from), next, bone.radius) {
                    next = self.held.hold(to, Vec3::ZERO);
                }
            }
        }
        if let Some(to) = self.meets.and_then(|meets| meets.stop(from, next, bone.radius)) {
            next = self.held.hold(to, Vec3::ZERO);
        }
        next
    }

    /// Returns the position of the tip after the share `rho` of a tick that ends at `whole`. Constraints and pushes act
    /// as evenly in time as the spring, so a tip at rest stays. Colliders allow the same depth as at the end of the
    /// tick.
    pub fn part(&self, tip: Vec3, way: Vec3, whole: Vec3, rho: f32) -> Vec3 {
        let drag = self.held.bone.drag;
        let acts = whole - tip - way * flight(drag, 1.0)[0];
        let [keeps, pushed] = flight(drag, rho);
        self.push_out(self.held.hold(tip, way * keeps + acts * pushed), Some(whole))
    }

    /// Pushes the tip out of every collider in sequence; if `as_far_as` is given, only until it is no deeper than this
    /// position.
    #[inline]
    fn push_out(&self, mut next: Vec3, as_far_as: Option<Vec3>) -> Vec3 {
        let (rig, bone) = (self.step.rig, self.held.bone);
        if !self.placed.is_empty() {
            for &collider in &rig.chains[bone.chain].colliders {
                let touch = |tip| self.placed[collider].touch(tip, bone.radius);
                next = self.held.out_of(touch, as_far_as, next).unwrap_or(next);
            }
        }
        let mut meets = rig.meets[self.index];
        while meets != 0 {
            let body = meets.trailing_zeros() as usize;
            meets &= meets - 1;
            let Some(frame) = self.step.bodies.get(body) else { break };
            let touch = |tip| {
                let (distance, direction) = rig.bodies[body].signed_distance(frame, tip);
                let distance = distance - bone.radius;
                (distance < 0.0).then_some(Gap { direction, distance })
            };
            next = self.held.out_of(touch, as_far_as, next).unwrap_or(next);
        }
        let Some(meets) = self.meets else { return next };
        for _ in 0..PUSHES {
            let Some(out) = self.held.out_of(|tip| meets.touch(tip, bone.radius), as_far_as, next) else {
                break;
            };
            next = out;
        }
        next
    }
}

/// Relation of a joint to the tip of its bone.
pub(super) struct Held<'a> {
    pub bone: &'a Bone,
    /// Rest rotation in the space of the joint's parent, and the tip's direction there, unit.
    rest: Rotation,
    seen_axis: Vec3,
    world_from_parent: &'a Mat3,
    /// World position of the joint.
    pub place: Vec3,
    /// Length of the bone, metres.
    length: f32,
    /// Direction of the bone at rest, world, unit.
    pub axis: Vec3,
}

impl<'a> Held<'a> {
    /// Creates the relation for a joint at the transform `place`.
    #[inline(always)]
    pub fn new(bone: &'a Bone, local: &LocalTransform, world_from_parent: &'a Mat3, place: Vec3) -> Self {
        let rest = local.rotation;
        let (seen_axis, along) = if local.scale == Vec3::ONE {
            let axis = rest * bone.axis;
            (axis, axis * bone.length)
        } else {
            let along = rest * (bone.tail * local.scale);
            (normalize_or(along, bone.axis), along)
        };
        let along = *world_from_parent * along;
        let length = along.length();
        Self { bone, rest, seen_axis, world_from_parent, place, length, axis: along / length }
    }

    /// Returns false if the bone has no length, so that it does not swing.
    #[inline(always)]
    pub fn has_length(&self) -> bool {
        self.length > 1e-12 && self.length < f32::INFINITY
    }

    /// Converts a world direction to the space of the joint's parent, unit.
    #[inline]
    fn seen(&self, v: Vec3) -> Vec3 {
        // Use the rows of the inverse, up to a common factor.
        let m = self.world_from_parent;
        let (x, y, z) = (m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
        let seen = Vec3::new(v.dot(x), v.dot(y), v.dot(z));
        normalize_or(if m.x_axis.dot(x) < 0.0 { -seen } else { seen }, self.seen_axis)
    }

    /// Returns the local rotation that puts the tip at this position.
    #[inline]
    pub fn turn_to(&self, tip: Vec3) -> Rotation {
        (Rotation::from_arc(self.seen_axis, self.seen(tip - self.place)) * self.rest).normalize()
    }

    /// Returns the position of the tip at rest.
    pub fn rest(&self) -> Vec3 {
        self.place + self.axis * self.length
    }

    /// Returns the position nearest to `tip + by` at the bone's length and in a direction that the bone's limit allows.
    #[inline]
    pub fn hold(&self, tip: Vec3, by: Vec3) -> Vec3 {
        // Subtract first, so that small displacements lose no digits to the world position.
        let mut direction = normalize_or((tip - self.place) + by, self.axis);
        if let Some(limit) = &self.bone.limit {
            let seen = self.rest.inverse() * self.seen(direction);
            let held = limit.hold(seen);
            if held != seen {
                direction = normalize_or(*self.world_from_parent * (self.rest * held), self.axis);
            }
        }
        self.place + direction * self.length
    }

    /// Pushes a tip out of a collider until it is no deeper than the position `as_far_as`; `None`: until it is outside.
    #[inline]
    fn out_of(
        &self,
        touch: impl Fn(Vec3) -> Option<Gap>,
        as_far_as: Option<Vec3>,
        tip: Vec3,
    ) -> Option<Vec3> {
        let gap = touch(tip)?;
        let depth = as_far_as.and_then(&touch).map_or(0.0, |gap| gap.distance);
        let by = gap.distance - depth;
        (by < 0.0).then(|| self.hold(tip, -gap.direction * by))
    }
}

/// Returns the displacement of a free tip in the share `rho` of a tick, as shares of the displacement in the previous
/// tick and of the push per tick.
fn flight(drag: f32, rho: f32) -> [f32; 2] {
    let keeps = 1.0 - drag;
    if rho == 1.0 {
        return [keeps, 1.0];
    }
    if drag < SLIGHT_DRAG {
        return [keeps * rho, 0.5 * rho * (rho + 1.0)];
    }
    let slowed = if keeps > 0.0 { keeps * (1.0 - pow(keeps, rho)) / drag } else { 0.0 };
    [slowed, (rho - slowed) / drag]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_a_tick_leads_to_the_whole() {
        let (way, push) = (Vec3::new(0.03, -0.01, 0.02), Vec3::new(0.0, 0.016, -0.004));
        for drag in [0.0, 5e-4, 0.01, 0.4, 0.9, 1.0] {
            let flight = |way: Vec3, push: Vec3, drag, rho| {
                let [keeps, pushed] = flight(drag, rho);
                way * keeps + push * pushed
            };
            let near = flight(way, push, drag, 0.999_999);
            let whole = flight(way, push, drag, 1.0);
            assert!(
                (near - whole).length() < 1e-4 * (1.0 + drag) * 0.1,
                "drag {drag}: {near} near ρ = 1, {whole} at ρ = 1"
            );
            assert_eq!(flight(way, push, drag, 0.0), Vec3::ZERO);
        }
        // Free flight against drag has a closed form: without a push, two half ticks equal one tick.
        let [half, _] = flight(0.64, 0.5);
        assert!((half - 0.36 * 0.4 / 0.64).abs() < 1e-7, "{half}");
    }
}
