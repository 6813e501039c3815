//! Nets on static obstacles, eight particles at a time.
//!
//! A net has no trees, so each of its particles has independent contacts. On a ball, a box, a capsule or a half-space
//! that neither moves nor can be moved, the solve of `contact.rs` has a closed form: the particle sticks to the plane
//! that it touches, or slides on it by Coulomb's law. This is the case for most particles of a cloth: they touch at
//! most one of these solids and cannot hit other obstacles. They are processed in the lanes of `batches.rs`. The
//! **others** are moved out of the lanes, solved individually, and moved back (`in_eights.rs`).
//!
//! Rows move particles in lanes without regard to contacts. At the end of the iteration the motion through the touched
//! plane is reverted, with the corresponding friction: at rest the position and the normal impulse are the same,
//! because a static obstacle does not move. Testing the plane in each row, as `net.rs` must for yielding bodies, took
//! most of the time.

use super::batches::WAY;
use crate::boxes::Aabb;
use crate::particles::tuning::{DETOUR, IMPACT_SPEED, NO_SPEED, REACH_SHARE, ROUNDING};
use sinew_math::Vec3;
use sinew_math::dispatch::Kernel;
use sinew_math::lanes::{Block, LaneMask, Lanes, Vector3, WIDTH};

/// Numbers per particle in addition to those of `batches.rs`: velocity, height above the touched plane at the start of
/// the iteration, distance to the nearest other obstacle, friction and static friction of the plane, radius,
/// acceleration, plane normal.
pub(super) const STRIP: usize = 14;
const HEIGHT: usize = 3;
const CLEARANCE: usize = 4;
const FRICTION: usize = 5;
const HOLD: usize = 6;
const RADIUS: usize = 7;
pub(super) const ACCELERATION: usize = 8;
const NORMAL: usize = 11;

/// Lane data, and the particles in the lanes.
#[derive(Clone, Debug, Default)]
pub(super) struct Eights {
    pub strips: Vec<Block<STRIP>>,
    /// Bits of the lanes of each block that hold a free particle.
    pub present: Vec<u8>,
    /// Bits of the lanes that are solved in lanes in this iteration.
    pub easy: Vec<u8>,
    /// Bits of the lanes that touch a solid.
    pub touched: Vec<u8>,
    /// Bits of the lanes that may have hit something on their path.
    pub strayed: Vec<u8>,
    /// Bits of the common acceleration of all particles in the strips, m/s², if there is one.
    pub common_acceleration: Option<[u32; 3]>,
    /// True if the substep uses lanes.
    pub on: bool,
    /// Particles that are solved individually, ascending.
    pub others: Vec<u32>,
    /// Particles of rows that are projected individually, except attached ones.
    pub outside: Vec<u32>,
    /// Resting solids near the group.
    pub solids: Vec<Solid>,
    /// Indices of the obstacles that are not among `solids`.
    pub foreign: Vec<u32>,
    /// Bounds around the foreign obstacles, in this iteration.
    pub foreign_bounds: Vec<Aabb>,
}

/// A solid that neither moves nor can be moved. Each number is repeated in all lanes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solid {
    pub form: Form,
    /// Position of the solid's frame, world, metres.
    pub at: Block<3>,
    /// Friction and static friction of the surface, and 1 if particles bounce off it.
    pub surface: Block<3>,
}

#[expect(clippy::large_enum_variant, reason = "there are few, and each is read for every block")]
#[derive(Clone, Copy, Debug)]
pub(super) enum Form {
    /// Half extents, metres, and axes of a box, world.
    Box(Block<3>, [Block<3>; 3]),
    /// Half length and radius of a capsule, metres; direction of its axis, world. A sphere has half length 0.
    Round(Block<2>, Block<3>),
    /// Normal of a half-space, world.
    Half(Block<3>),
}

/// Eight points relative to the centre of a box, in its axes.
struct InBox<L> {
    p: Vector3<L>,
    /// Distances beyond the faces along each axis, metres, negative inside.
    beyond: Vector3<L>,
    /// Positive part of `beyond`.
    outside: Vector3<L>,
    /// Largest of `beyond`.
    deepest: L,
    /// Distance of a point outside, metres; 0 inside.
    distance: L,
}

impl<L: Lanes> InBox<L> {
    #[inline(always)]
    fn new(half: Vector3<L>, axes: &[Vector3<L>; 3], from: Vector3<L>) -> Self {
        let zero = L::splat(0.0);
        let p = Vector3::new(from.dot(axes[0]), from.dot(axes[1]), from.dot(axes[2]));
        let beyond = p.abs() - half;
        let outside = Vector3::new(L::max(beyond.x, zero), L::max(beyond.y, zero), L::max(beyond.z, zero));
        let deepest = L::max(L::max(beyond.x, beyond.y), beyond.z);
        Self { p, beyond, outside, deepest, distance: outside.length() }
    }

    #[inline(always)]
    fn is_out(&self) -> L::Mask {
        L::gt(self.distance, L::splat(1e-12))
    }

    /// Signed distance, metres; negative inside.
    #[inline(always)]
    fn signed_distance(&self) -> L {
        L::select(self.is_out(), self.distance, self.deepest)
    }

    /// Outward normal; inside, that of the nearest face.
    #[inline(always)]
    fn normal(&self, axes: &[Vector3<L>; 3]) -> Vector3<L> {
        let Self { p, beyond, outside, deepest, .. } = *self;
        let (is_out, one) = (self.is_out(), L::splat(1.0));
        let share = one / self.distance;
        let (on_x, on_y) = (L::ge(beyond.x, deepest), L::ge(beyond.y, deepest));
        let x = L::select(is_out, outside.x * share, one.masked(on_x));
        let y = L::select(is_out, outside.y * share, one.masked(on_y & !on_x));
        let z = L::select(is_out, outside.z * share, one.masked(!(on_x | on_y)));
        let (x, y, z) = (signed(x, p.x), signed(y, p.y), signed(z, p.z));
        axes[0] * x + axes[1] * y + axes[2] * z
    }
}

/// Outward normal of a ball at offset `from` (m) of that `length` from its centre.
#[inline(always)]
fn round_normal<L: Lanes>(from: Vector3<L>, length: L) -> Vector3<L> {
    let (is_out, one) = (L::gt(length, L::splat(1e-12)), L::splat(1.0));
    let share = one / length;
    Vector3::new(
        (from.x * share).masked(is_out),
        L::select(is_out, from.y * share, one),
        (from.z * share).masked(is_out),
    )
}

/// Returns `number`, which is not negative, with the sign of `like`; positive if `like` is zero.
#[inline(always)]
fn signed<L: Lanes>(number: L, like: L) -> L {
    L::select(L::lt(like, L::splat(0.0)), -number, number)
}

impl Eights {
    /// Creates lanes for particles with these radii, some of them attached; rows that are projected individually
    /// contain the `outside` particles.
    pub fn new(per_lane: usize, radii: &[f32], attached: &[u32], mut outside: Vec<u32>) -> Self {
        let mut strips = vec![Block::splat([0.0; STRIP]); per_lane];
        let mut present = vec![0; per_lane];
        for (i, &radius) in radii.iter().enumerate() {
            let (block, lane) = (i % per_lane, i / per_lane);
            strips[block].0[RADIUS][lane] = radius;
            present[block] |= u8::from(attached[i] == u32::MAX) << lane;
        }
        outside.retain(|&i| attached[i as usize] == u32::MAX);
        outside.sort_unstable();
        outside.dedup();
        let others = Vec::with_capacity(radii.len());
        let [easy, touched, strayed] = [(); 3].map(|()| vec![0; per_lane]);
        Self { strips, present, easy, touched, strayed, others, outside, ..Self::default() }
    }

    /// True if a particle is solved in a lane in this iteration.
    pub fn is_easy(&self, i: usize) -> bool {
        self.easy[i % self.easy.len()] >> (i / self.easy.len()) & 1 == 1
    }
}

/// Gap to the nearest solid, and to the nearest of all others. Normal, friction and bounce are those of the nearest
/// solid, if a particle touches it.
struct Surroundings<L: Lanes> {
    gap: L,
    normal: Vector3<L>,
    beside: L,
    friction: L,
    hold: L,
    bounces: L,
}

impl<L: Lanes> Surroundings<L> {
    /// Tests all solids; a particle touches one within `reach`, metres.
    #[inline(always)]
    fn look(solids: &[Solid], p: Vector3<L>, radius: L, reach: L) -> Self {
        let (zero, far) = (L::splat(0.0), L::splat(f32::MAX));
        let normal = Vector3::splat(Vec3::Y);
        let mut found = Self { gap: far, normal, beside: far, friction: zero, hold: zero, bounces: zero };
        for solid in solids {
            let from = p - vector(&solid.at);
            match &solid.form {
                Form::Box(half, axes) => {
                    let axes = axes.each_ref().map(vector::<L>);
                    let place = InBox::new(vector(half), &axes, from);
                    let (touched, nearer) = found.meet(place.signed_distance() - radius, reach);
                    if touched {
                        found.touch(solid, place.normal(&axes), nearer);
                    }
                }
                Form::Round(Block([half, size]), axis) => {
                    let (axis, half) = (vector(axis), L::load(half));
                    let along = L::max(L::min(from.dot(axis), half), -half);
                    let from = from - axis * along;
                    let length = from.length();
                    let (touched, nearer) = found.meet(length - L::load(size) - radius, reach);
                    if touched {
                        found.touch(solid, round_normal(from, length), nearer);
                    }
                }
                Form::Half(normal) => {
                    let normal = vector(normal);
                    let (touched, nearer) = found.meet(from.dot(normal) - radius, reach);
                    if touched {
                        found.touch(solid, normal, nearer);
                    }
                }
            }
        }
        found
    }

    /// Includes the gap to a solid. Returns true if any lane is within `reach`, and the lanes in which the solid is the
    /// nearest so far.
    #[inline(always)]
    fn meet(&mut self, gap: L, reach: L) -> (bool, L::Mask) {
        let nearer = L::lt(gap, self.gap);
        self.beside = L::min(L::max(self.gap, gap), self.beside);
        self.gap = L::min(gap, self.gap);
        (L::le(gap, reach).any(), nearer)
    }

    /// Stores the surface of a solid in the lanes in which it is the nearest.
    #[inline(always)]
    fn touch(&mut self, solid: &Solid, normal: Vector3<L>, nearer: L::Mask) {
        let Block([friction, hold, bounces]) = &solid.surface;
        self.normal = select(nearer, normal, self.normal);
        self.friction = L::select(nearer, L::load(friction), self.friction);
        self.hold = L::select(nearer, L::load(hold), self.hold);
        self.bounces = L::select(nearer, L::load(bounces), self.bounces);
    }

    /// Velocity of a free particle after its contact, by Coulomb's law for a particle alone.
    #[inline(always)]
    fn held(&self, free: Vector3<L>, touching: L::Mask, per_second: L) -> Vector3<L> {
        let zero = L::splat(0.0);
        let rise = -L::max(self.gap, zero) * per_second;
        let along = free.dot(self.normal);
        let push = rise - along;
        let pressed = touching & L::gt(push, L::splat(NO_SPEED));
        let slip = free - self.normal * along;
        let speed = slip.length();
        let share = L::max(L::splat(1.0) - self.friction * push / speed, zero);
        let share = share.masked(L::gt(speed, self.hold * push));
        let held = self.normal * rise + slip * share;
        select(pressed, held, free)
    }
}

/// Loads a vector that is the same in every lane.
#[inline(always)]
fn vector<L: Lanes>(Block([x, y, z]): &Block<3>) -> Vector3<L> {
    Vector3::load(x, y, z)
}

/// Selects `a` where the mask is true, otherwise `b`.
#[inline(always)]
fn select<L: Lanes>(mask: L::Mask, a: Vector3<L>, b: Vector3<L>) -> Vector3<L> {
    Vector3::new(L::select(mask, a.x, b.x), L::select(mask, a.y, b.y), L::select(mask, a.z, b.z))
}

/// Kernel that starts an iteration: finds contacts and velocities in lanes.
pub(super) struct Approach<'a> {
    pub eights: &'a mut Eights,
    pub particles: &'a mut [Block<{ super::batches::FIELDS }>],
    pub h: f32,
    pub damping: f32,
}

impl Kernel for Approach<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { eights, particles, h, damping } = self;
        let Eights { strips, present, easy, touched, solids, foreign_bounds, .. } = eights;
        let (zero, per_second) = (L::splat(0.0), L::splat(1.0 / h));
        let (h, damping, detour) = (L::splat(h), L::splat(damping), L::splat(DETOUR));
        let blocks = strips.iter_mut().zip(particles.iter_mut()).zip(present.iter());
        for (((Block(strip), Block(particle)), present), (easy, touched)) in
            blocks.zip(easy.iter_mut().zip(touched.iter_mut()))
        {
            let from = Vector3::<L>::load(&particle[0], &particle[1], &particle[2]);
            let radius = L::load(&strip[RADIUS]);
            let begun = Vector3::<L>::load(&strip[0], &strip[1], &strip[2]) * damping;
            store(begun, strip, 0);
            let pull =
                Vector3::<L>::load(&strip[ACCELERATION], &strip[ACCELERATION + 1], &strip[ACCELERATION + 2]);
            let reach = L::splat(2.0) * h * h * pull.length() + L::splat(REACH_SHARE) * radius;
            let mut velocity = begun + pull * h;
            let found = Surroundings::look(solids, from, radius, reach);
            let touching = L::le(found.gap, reach);
            let mut foreign = L::splat(f32::MAX);
            for bounds in foreign_bounds.iter() {
                foreign = L::min(foreign, distance_at_least(bounds, from) - radius);
            }
            let clearance = L::min(L::select(touching, found.beside, found.gap), foreign);
            clearance.store(&mut strip[CLEARANCE]);
            *touched = touching.bits();
            let mut rebounds = 0;
            if *touched != 0 {
                velocity = found.held(velocity, touching, per_second);
                let approaches = L::lt(begun.dot(found.normal), L::splat(-IMPACT_SPEED));
                rebounds = (touching & L::gt(found.bounces, zero) & approaches).bits();
                L::select(touching, found.gap, L::splat(f32::MAX)).store(&mut strip[HEIGHT]);
                found.friction.store(&mut strip[FRICTION]);
                found.hold.store(&mut strip[HOLD]);
                store(found.normal, strip, NORMAL);
            }
            let way = velocity * h;
            store(way, particle, WAY);
            let sight = reach + detour * (begun.length() * h);
            let is_far = is_beyond(clearance, way) & L::gt(foreign, sight);
            *easy = is_far.bits() & !rebounds & *present;
        }
    }
}

/// Writes a vector into three fields from `first` on.
#[inline(always)]
fn store<L: Lanes, const F: usize>(vector: Vector3<L>, fields: &mut [[f32; WIDTH]; F], first: usize) {
    vector.x.store(&mut fields[first]);
    vector.y.store(&mut fields[first + 1]);
    vector.z.store(&mut fields[first + 2]);
}

/// True where a particle with displacement `way` (m) cannot reach an obstacle at distance `clearance` (m).
#[inline(always)]
fn is_beyond<L: Lanes>(clearance: L, way: Vector3<L>) -> L::Mask {
    L::gt(clearance, L::splat(0.0))
        & L::gt(clearance * clearance, L::splat(DETOUR) * L::splat(DETOUR) * way.dot(way))
}

/// A lower bound of the distance from a point to anything inside `bounds`, metres.
#[inline(always)]
fn distance_at_least<L: Lanes>(bounds: &Aabb, p: Vector3<L>) -> L {
    let (low, high) = (Vector3::<L>::splat(bounds.min) - p, p - Vector3::splat(bounds.max));
    L::max(L::max(L::max(low.x, high.x), L::max(low.y, high.y)), L::max(low.z, high.z))
}

/// Kernel that ends an iteration: applies contacts to the displacements in lanes.
pub(super) struct Depart<'a> {
    pub eights: &'a mut Eights,
    pub particles: &'a mut [Block<{ super::batches::FIELDS }>],
    pub h: f32,
}

impl Kernel for Depart<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { eights, particles, h } = self;
        let Eights { strips, easy, touched, strayed, .. } = eights;
        let per_second = L::splat(1.0 / h);
        let blocks = strips.iter_mut().zip(particles.iter_mut()).zip(easy.iter());
        for (((Block(strip), Block(particle)), easy), (touched, strayed)) in
            blocks.zip(touched.iter().zip(strayed.iter_mut()))
        {
            let from = Vector3::<L>::load(&particle[0], &particle[1], &particle[2]);
            let mut way = Vector3::<L>::load(&particle[WAY], &particle[WAY + 1], &particle[WAY + 2]);
            let mut clear = u8::MAX;
            if *touched != 0 {
                let (rubbed, above) = rubbed(way, strip);
                (way, clear) = (rubbed, above.bits());
            }
            clear &= is_beyond(L::load(&strip[CLEARANCE]), way).bits();
            *strayed = *easy & !clear;
            let to = from + way;
            let velocity = way * per_second;
            if *easy == u8::MAX && *strayed == 0 {
                store(to, particle, 0);
                store(velocity, strip, 0);
                continue;
            }
            let mut numbers = [[0.0; WIDTH]; 9];
            for (k, vector) in [to, velocity, way].into_iter().enumerate() {
                store(vector, &mut numbers, 3 * k);
            }
            for lane in 0..WIDTH {
                let (is_easy, strays) = (*easy >> lane & 1 == 1, *strayed >> lane & 1 == 1);
                for k in 0..3 {
                    if is_easy {
                        strip[k][lane] = numbers[3 + k][lane];
                        particle[WAY + k][lane] = numbers[6 + k][lane];
                    }
                    if is_easy && !strays {
                        particle[k][lane] = numbers[k][lane];
                    }
                }
            }
        }
    }
}

/// Displacement after the reaction of the touched plane, with friction, and true where it does not end below the plane.
#[inline(always)]
fn rubbed<L: Lanes>(way: Vector3<L>, strip: &[[f32; WIDTH]; STRIP]) -> (Vector3<L>, L::Mask) {
    let zero = L::splat(0.0);
    let normal = Vector3::<L>::load(&strip[NORMAL], &strip[NORMAL + 1], &strip[NORMAL + 2]);
    let height = L::load(&strip[HEIGHT]);
    let along = way.dot(normal);
    let press = L::max(-L::max(height, zero) - along, zero);
    let slip = way - normal * along;
    let length = slip.length();
    let share = L::max(L::splat(1.0) - L::load(&strip[FRICTION]) * press / length, zero);
    let share = share.masked(L::gt(length, L::load(&strip[HOLD]) * press));
    let rubbed = normal * (along + press) + slip * share;
    let way = select(L::gt(press, zero), rubbed, way);
    (way, L::gt(height + way.dot(normal), L::splat(-ROUNDING)))
}
