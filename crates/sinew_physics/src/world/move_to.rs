//! Velocities that move bodies to target poses, individually or with SIMD.

use crate::body::Velocity;
use crate::body::def::BodyKind;
use crate::id::BodyId;
use crate::solver::motion::Turn;
use crate::world::World;
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::{Block, LaneMask, Lanes, Vector3, WIDTH};
use sinew_math::{Rotation, Transform, Vec3};

impl World {
    /// Gives a body the velocity with which it reaches a pose (world) in `seconds`: for platforms and other kinematic
    /// bodies that follow given poses and push obstacles. The body keeps that velocity until you change it; call this
    /// before each step with the length of the step, [`WorldDef::dt`](crate::WorldDef::dt). The body rotates the short
    /// way.
    ///
    /// ```
    /// use sinew_math::{Transform, Vec3};
    /// use sinew_physics::{BodyDef, Shape, World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default());
    /// let lift = world.add_body(&BodyDef::kinematic(Shape::cuboid(Vec3::new(1.0, 0.1, 1.0))));
    /// let dt = world.def().dt();
    /// for floor in 1..=60 {
    ///     world.move_to(lift, Transform::from_translation(Vec3::Y * 0.02 * floor as f32), dt);
    ///     world.step();
    /// }
    /// assert!((world.transform(lift).translation.y - 1.2).abs() < 1e-4);
    /// assert!((world.velocity(lift).linear.y - 1.2).abs() < 1e-3);
    /// ```
    ///
    /// # Panics
    /// If the velocity would not be finite, or the time is not positive and finite.
    #[doc(alias = "set_next_kinematic_position")]
    #[doc(alias = "MoveKinematic")]
    #[doc(alias = "kinematic target")]
    #[track_caller]
    pub fn move_to(&mut self, id: BodyId, world_from_body: Transform, seconds: f32) {
        assert!(
            world_from_body.is_finite(),
            "a body's pose must be finite, not {world_from_body:?} ({id:?})"
        );
        assert!(
            seconds > 0.0 && seconds < f32::INFINITY,
            "a time is positive and finite, not {seconds:?} ({id:?})"
        );
        let body = self.expect_mut(id);
        let from = body.world_from_principal;
        let turned = (world_from_body.rotation * body.principal_from_body.rotation.inverse()).normalize();
        let center = world_from_body.translation - turned * body.principal_from_body.translation;
        let velocity = Velocity {
            linear: (center - from.translation) / seconds,
            angular: from.rotation.angular_velocity_to(turned, seconds),
        };
        assert!(
            velocity.linear.is_finite() && velocity.angular.is_finite(),
            "a velocity must be finite, not {velocity:?} ({id:?})"
        );
        self.go_on(id, velocity);
    }

    /// Gives many bodies the velocities that continue their motion: body `i` moved from `before[i]` to `now[i]` within
    /// `seconds`, and continues that motion for the same time. Equivalent to [`move_to`](Self::move_to) with the
    /// extrapolated pose, bit for bit, at less than half the cost: for bodies of characters, whose next pose is not
    /// known yet.
    ///
    /// # Panics
    /// If there is not one pose per body in each list, or `move_to` would panic.
    #[track_caller]
    pub fn lead_all(&mut self, ids: &[BodyId], before: &[Transform], now: &[Transform], seconds: f32) {
        let all = ids.len() == before.len() && ids.len() == now.len();
        assert!(all, "each body has been at a pose and is at one");
        assert!(
            seconds > 0.0 && seconds < f32::INFINITY,
            "a time is positive and finite, not {seconds:?} ({ids:?})"
        );
        let mut block = Block::splat([0.0; NUMBERS]);
        let poses = before.chunks(WIDTH).zip(now.chunks(WIDTH));
        for (ids, (before, now)) in ids.chunks(WIDTH).zip(poses) {
            for (lane, &id) in ids.iter().enumerate() {
                let body = self.expect(id);
                let frames =
                    [&body.world_from_principal, &body.principal_from_body, &before[lane], &now[lane]];
                for (at, frame) in frames.into_iter().enumerate() {
                    for (row, number) in numbers(frame).into_iter().enumerate() {
                        block.0[7 * at + row][lane] = number;
                    }
                }
            }
            let found = dispatch::run(FindVelocities { block: &block, seconds });
            for (lane, &id) in ids.iter().enumerate() {
                if found.plain >> lane & 1 == 1 {
                    self.go_on(id, found.velocity(lane));
                } else {
                    self.move_to(id, ahead(&before[lane], &now[lane]), seconds);
                }
            }
        }
    }

    /// Sets a body's velocity. A kinematic body that keeps moving neither wakes nor loses its contacts.
    fn go_on(&mut self, id: BodyId, velocity: Velocity) {
        let body = self.bodies.at_mut(id.index);
        if body.kind == BodyKind::Kinematic && !body.velocity.is_zero() && !velocity.is_zero() {
            body.velocity = velocity;
        } else {
            self.set_velocity(id, velocity);
        }
    }
}

/// Returns the extrapolated pose of a body that continues its motion.
fn ahead(before: &Transform, now: &Transform) -> Transform {
    let turn = now.rotation * before.rotation.inverse();
    Transform::new(now.translation + (now.translation - before.translation), turn * now.rotation)
}

/// Numbers per body: the pose of its principal frame in the world, the pose of its frame in the principal frame, and
/// the poses `before` and `now`.
const NUMBERS: usize = 4 * 7;

/// Kernel that finds the velocities of eight bodies whose motion continues for `seconds`.
struct FindVelocities<'a> {
    block: &'a Block<NUMBERS>,
    seconds: f32,
}

/// Velocities of eight bodies.
struct Velocities {
    linear: [[f32; WIDTH]; 3],
    angular: [[f32; WIDTH]; 3],
    /// Bit `k` is set if lane `k` is finite and its rotation is small enough for the series.
    plain: u8,
}

impl Velocities {
    fn velocity(&self, lane: usize) -> Velocity {
        let of = |rows: &[[f32; WIDTH]; 3]| Vec3::from_array(rows.map(|row| row[lane]));
        Velocity { linear: of(&self.linear), angular: of(&self.angular) }
    }
}

#[inline(always)]
fn numbers(frame: &Transform) -> [f32; 7] {
    let Transform { translation: t, rotation: r } = frame;
    [t.x, t.y, t.z, r.x, r.y, r.z, r.w]
}

#[inline(always)]
fn frame<L: Lanes>(rows: &[[f32; WIDTH]]) -> (Vector3<L>, Turn<L>) {
    let translation = Vector3::load(&rows[0], &rows[1], &rows[2]);
    let vector = Vector3::load(&rows[3], &rows[4], &rows[5]);
    (translation, Turn { vector, real: L::load(&rows[6]) })
}

#[inline(always)]
fn is_finite<L: Lanes>(v: Vector3<L>) -> L::Mask {
    let end = L::splat(f32::INFINITY);
    L::lt(v.x.abs(), end) & L::lt(v.y.abs(), end) & L::lt(v.z.abs(), end)
}

impl Kernel for FindVelocities<'_> {
    type Output = Velocities;

    // Performs the operations of `ahead`, `move_to`, `Rotation::normalize` and `Rotation::angular_velocity_to` in the
    // same order.
    #[inline(always)]
    fn run<L: Lanes>(self) -> Velocities {
        let rows = &self.block.0;
        let (from, start) = frame::<L>(&rows[..7]);
        let (origin, own) = frame::<L>(&rows[7..14]);
        let (was, before) = frame::<L>(&rows[14..21]);
        let (is, now) = frame::<L>(&rows[21..]);
        let (to, end) = (is + (is - was), now.product(before.inverse()).product(now));
        let [one, seconds] = [L::splat(1.0), L::splat(self.seconds)];
        let Turn { vector: v, real: w } = end.product(own.inverse());
        let length = (v.x * v.x + v.y * v.y + (v.z * v.z + w * w)).sqrt();
        let scale = one / length;
        let turned = Turn { vector: v * scale, real: w * scale };
        let linear = to - turned.turned(origin) - from;
        let linear = Vector3::new(linear.x / seconds, linear.y / seconds, linear.z / seconds);
        let Turn { vector, real } = turned.product(start.inverse());
        let back = L::lt(real, L::splat(0.0));
        let vector = Vector3::new(
            L::select(back, -vector.x, vector.x),
            L::select(back, -vector.y, vector.y),
            L::select(back, -vector.z, vector.z),
        );
        let square = vector.dot(vector);
        let angular = vector * (L::splat(2.0) * Rotation::half_angle_over_sine(square) / seconds);
        // `normalize` returns the identity for shorter and for infinite quaternions.
        let plain = L::gt(length, L::splat(1e-12))
            & L::lt(length, L::splat(f32::INFINITY))
            & L::le(square, L::splat(Rotation::SHORT_TURN))
            & is_finite(linear)
            & is_finite(angular);
        let mut out =
            Velocities { linear: [[0.0; WIDTH]; 3], angular: [[0.0; WIDTH]; 3], plain: plain.bits() };
        for (rows, v) in [(&mut out.linear, linear), (&mut out.angular, angular)] {
            v.x.store(&mut rows[0]);
            v.y.store(&mut rows[1]);
            v.z.store(&mut rows[2]);
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_math::Random;
    use sinew_math::dispatch::Level;

    #[test]
    fn velocities_have_the_same_bits_at_every_width() {
        let mut random = Random::new(3);
        for _ in 0..100 {
            let mut block = Block::splat([0.0; NUMBERS]);
            for lane in 0..WIDTH {
                let turn = Rotation::from_scaled_axis(random.in_cube() * 0.3);
                let from = Transform::new(random.in_cube(), random.rotation());
                let own = Transform::new(random.in_cube(), random.rotation());
                let before = from * own;
                let now = Transform::new(before.translation + random.in_cube() * 0.1, turn * before.rotation);
                let mut record = [0.0; NUMBERS];
                for (at, frame) in [from, own, before, now].iter().enumerate() {
                    record[7 * at..][..7].copy_from_slice(&numbers(frame));
                }
                block.set(lane, record);
            }
            let seconds = random.range(0.001, 0.1);
            let of = |level| dispatch::run_at(level, FindVelocities { block: &block, seconds });
            let all = |v: &Velocities| {
                ([v.linear, v.angular].map(|rows| rows.map(|row| row.map(f32::to_bits))), v.plain)
            };
            let scalar = all(&of(Level::Scalar));
            for level in Level::available() {
                assert_eq!(all(&of(level)), scalar, "{level:?}");
            }
        }
    }
}
