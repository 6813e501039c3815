//! Nets on what stands still, eight particles side by side.
//!
//! A net has no trees, so that each of its particles meets what it touches alone. On a ball, a box, a capsule or a half-space that
//! neither moves nor can be moved, what the solve of `contact.rs` comes to has a closed form: the particle sticks to the plane that
//! it touches, or slides on it by Coulomb's law. Most particles of a cloth are such: they touch at most one of these, and surely
//! meet nothing else on their way. They go through the iteration in the lanes of `batches.rs`; the **others** are taken out
//! of these, solved one by one, and put back (`in_eights.rs`).
//!
//! Rows move those in lanes as if nothing were there. What this takes through the plane that a particle touches is taken back when the
//! iteration ends, with friction by as much: at rest the same place and the same press, since what stands still is moved by neither. To
//! ask for the plane in each row, as `net.rs` must where a body gives way, took most of the time.

use super::batches::WAY;
use crate::boxes::Aabb;
use crate::particles::tuning::{DETOUR, IMPACT_SPEED, NO_SPEED, REACH_SHARE, ROUNDING};
use sinew_math::Vec3;
use sinew_math::dispatch::Kernel;
use sinew_math::lanes::{Block, LaneMask, Lanes, Vector3, WIDTH};

/// Numbers of a particle beside those of `batches.rs`: velocity, height above the plane that it touches when the iteration begins, distance from all else, its
/// friction and static friction, radius, acceleration, normal of that plane.
pub(super) const STRIP: usize = 14;
const HEIGHT: usize = 3;
const CLEARANCE: usize = 4;
const FRICTION: usize = 5;
const HOLD: usize = 6;
const RADIUS: usize = 7;
pub(super) const ACCELERATION: usize = 8;
const NORMAL: usize = 11;

/// The lanes' own numbers, and who is in them.
#[derive(Clone, Debug, Default)]
pub(super) struct Eights {
    pub strips: Vec<Block<STRIP>>,
    /// Lanes of each block that hold a particle that is not attached.
    pub present: Vec<u8>,
    /// Lanes that go through this iteration as such.
    pub easy: Vec<u8>,
    /// Lanes of these that have met something on their way.
    pub strayed: Vec<u8>,
    /// Acceleration of all particles in the strips, m/s², if they have one there.
    pub common_pull: Option<Vec3>,
    /// The substep goes through lanes.
    pub on: bool,
    /// Particles that do not, ascending.
    pub others: Vec<u32>,
    /// Particles of rows that are projected one by one, but for attached ones.
    pub outside: Vec<u32>,
    /// Solids that stand still.
    pub solids: Vec<Solid>,
    /// Indices of the other obstacles.
    pub foreign: Vec<u32>,
    /// Around these, in this iteration.
    pub foreign_bounds: Vec<Aabb>,
}

/// A solid that neither moves nor can be moved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solid {
    pub form: Form,
    /// Place of its frame, world, metres.
    pub at: Vec3,
    pub friction: f32,
    pub static_friction: f32,
    pub bounces: bool,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Form {
    /// Half of each side, and axes.
    Box(Vec3, [Vec3; 3]),
    /// Half of a segment, world, its direction, and the radius round it.
    Round(f32, Vec3, f32),
    /// Normal.
    Half(Vec3),
}

impl Solid {
    /// Signed distance, metres, and outward normal.
    #[inline(always)]
    fn distance<L: Lanes>(&self, p: Vector3<L>) -> (L, Vector3<L>) {
        let from = p - Vector3::splat(self.at);
        match self.form {
            Form::Box(half, axes) => box_distance(half, axes, from),
            Form::Round(half, axis, radius) => {
                let axis = Vector3::splat(axis);
                let along = L::max(L::min(from.dot(axis), L::splat(half)), L::splat(-half));
                let from = from - axis * along;
                let length = from.length();
                let is_out = L::gt(length, L::splat(1e-12));
                let share = L::splat(1.0) / length;
                let one = L::splat(1.0);
                let normal = Vector3::new(
                    (from.x * share).masked(is_out),
                    L::select(is_out, from.y * share, one),
                    (from.z * share).masked(is_out),
                );
                (length - L::splat(radius), normal)
            }
            Form::Half(normal) => (from.dot(Vector3::splat(normal)), Vector3::splat(normal)),
        }
    }
}

#[inline(always)]
fn box_distance<L: Lanes>(half: Vec3, axes: [Vec3; 3], from: Vector3<L>) -> (L, Vector3<L>) {
    let zero = L::splat(0.0);
    let axes = axes.map(Vector3::<L>::splat);
    let p = Vector3::new(from.dot(axes[0]), from.dot(axes[1]), from.dot(axes[2]));
    let beyond = p.abs() - Vector3::splat(half);
    let outside = Vector3::new(L::max(beyond.x, zero), L::max(beyond.y, zero), L::max(beyond.z, zero));
    let distance = outside.length();
    let is_out = L::gt(distance, L::splat(1e-12));
    let share = L::splat(1.0) / distance;
    // From inside the nearest face.
    let deepest = L::max(L::max(beyond.x, beyond.y), beyond.z);
    let (on_x, on_y) = (L::ge(beyond.x, deepest), L::ge(beyond.y, deepest));
    let one = L::splat(1.0);
    let x = L::select(is_out, outside.x * share, one.masked(on_x));
    let y = L::select(is_out, outside.y * share, one.masked(on_y & !on_x));
    let z = L::select(is_out, outside.z * share, one.masked(!(on_x | on_y)));
    let (x, y, z) = (signed(x, p.x), signed(y, p.y), signed(z, p.z));
    (L::select(is_out, distance, deepest), axes[0] * x + axes[1] * y + axes[2] * z)
}

/// A number with the sign of another, positive for zero.
#[inline(always)]
fn signed<L: Lanes>(number: L, like: L) -> L {
    L::select(L::lt(like, L::splat(0.0)), -number, number)
}

impl Eights {
    /// For particles with these radii, of which some are attached; rows that are projected one by one reach those of `outside`.
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
        let (easy, strayed) = (vec![0; per_lane], vec![0; per_lane]);
        Self { strips, present, easy, strayed, others, outside, ..Self::default() }
    }

    /// True if a particle goes through this iteration in a lane.
    pub fn is_easy(&self, i: usize) -> bool {
        self.easy[i % self.easy.len()] >> (i / self.easy.len()) & 1 == 1
    }
}

/// The solid that a particle touches at most, and how far away everything else is.
struct Surroundings<L: Lanes> {
    gap: L,
    normal: Vector3<L>,
    beside: L,
    friction: L,
    hold: L,
    bounces: L,
}

impl<L: Lanes> Surroundings<L> {
    #[inline(always)]
    fn look(solids: &[Solid], p: Vector3<L>, radius: L) -> Self {
        let (zero, far) = (L::splat(0.0), L::splat(f32::MAX));
        let normal = Vector3::splat(Vec3::Y);
        let mut found = Self { gap: far, normal, beside: far, friction: zero, hold: zero, bounces: zero };
        for solid in solids {
            let (distance, normal) = solid.distance(p);
            let gap = distance - radius;
            let nearer = L::lt(gap, found.gap);
            found.beside = L::min(L::select(nearer, found.gap, gap), found.beside);
            found.gap = L::select(nearer, gap, found.gap);
            found.normal.x = L::select(nearer, normal.x, found.normal.x);
            found.normal.y = L::select(nearer, normal.y, found.normal.y);
            found.normal.z = L::select(nearer, normal.z, found.normal.z);
            found.friction = L::select(nearer, L::splat(solid.friction), found.friction);
            found.hold = L::select(nearer, L::splat(solid.static_friction), found.hold);
            found.bounces = L::select(nearer, L::splat(f32::from(u8::from(solid.bounces))), found.bounces);
        }
        found
    }
}

/// Begins an iteration.
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
        let Eights { strips, present, easy, solids, foreign_bounds, .. } = eights;
        let (zero, per_second) = (L::splat(0.0), L::splat(1.0 / h));
        let (h, damping) = (L::splat(h), L::splat(damping));
        let (detour, one) = (L::splat(DETOUR), L::splat(1.0));
        for (((Block(strip), Block(particle)), present), easy) in
            strips.iter_mut().zip(particles.iter_mut()).zip(present.iter()).zip(easy.iter_mut())
        {
            let from = Vector3::<L>::load(&particle[0], &particle[1], &particle[2]);
            let radius = L::load(&strip[RADIUS]);
            let begun = Vector3::<L>::load(&strip[0], &strip[1], &strip[2]) * damping;
            let pull =
                Vector3::<L>::load(&strip[ACCELERATION], &strip[ACCELERATION + 1], &strip[ACCELERATION + 2]);
            let free = begun + pull * h;
            let found = Surroundings::look(solids, from, radius);
            let reach = L::splat(2.0) * h * h * pull.length() + L::splat(REACH_SHARE) * radius;
            let touching = L::le(found.gap, reach);
            let mut clearance = L::select(touching, found.beside, found.gap);
            let sight = reach + detour * (begun.length() * h);
            let mut foreign = L::splat(f32::MAX);
            for bounds in foreign_bounds.iter() {
                foreign = L::min(foreign, distance_at_least(bounds, from) - radius);
            }
            clearance = L::min(clearance, foreign);
            // Coulomb's law for a particle alone.
            let rise = -L::max(found.gap, zero) * per_second;
            let along = free.dot(found.normal);
            let push = rise - along;
            let pressed = touching & L::gt(push, L::splat(NO_SPEED));
            let slip = free - found.normal * along;
            let speed = slip.length();
            let share = L::max(one - found.friction * push / speed, zero);
            let share = share.masked(L::gt(speed, found.hold * push));
            let held = found.normal * rise + slip * share;
            let velocity = Vector3::new(
                L::select(pressed, held.x, free.x),
                L::select(pressed, held.y, free.y),
                L::select(pressed, held.z, free.z),
            );
            let way = velocity * h;
            let is_far = L::gt(clearance, zero)
                & L::gt(clearance * clearance, detour * detour * way.dot(way))
                & L::gt(foreign, sight);
            let rebounds = touching
                & L::gt(found.bounces, zero)
                & L::lt(begun.dot(found.normal), L::splat(-IMPACT_SPEED));
            *easy = (is_far & !rebounds).bits() & *present;
            begun.x.store(&mut strip[0]);
            begun.y.store(&mut strip[1]);
            begun.z.store(&mut strip[2]);
            L::select(touching, found.gap, L::splat(f32::MAX)).store(&mut strip[HEIGHT]);
            clearance.store(&mut strip[CLEARANCE]);
            found.friction.store(&mut strip[FRICTION]);
            found.hold.store(&mut strip[HOLD]);
            found.normal.x.store(&mut strip[NORMAL]);
            found.normal.y.store(&mut strip[NORMAL + 1]);
            found.normal.z.store(&mut strip[NORMAL + 2]);
            way.x.store(&mut particle[WAY]);
            way.y.store(&mut particle[WAY + 1]);
            way.z.store(&mut particle[WAY + 2]);
        }
    }
}

/// No more than the distance from a point of what lies in these bounds.
#[inline(always)]
fn distance_at_least<L: Lanes>(bounds: &Aabb, p: Vector3<L>) -> L {
    let (low, high) = (Vector3::<L>::splat(bounds.min) - p, p - Vector3::splat(bounds.max));
    L::max(L::max(L::max(low.x, high.x), L::max(low.y, high.y)), L::max(low.z, high.z))
}

/// Ends it.
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
        let Eights { strips, easy, strayed, .. } = eights;
        let (zero, one, per_second) = (L::splat(0.0), L::splat(1.0), L::splat(1.0 / h));
        for (((Block(strip), Block(particle)), easy), strayed) in
            strips.iter_mut().zip(particles.iter_mut()).zip(easy.iter()).zip(strayed.iter_mut())
        {
            let from = Vector3::<L>::load(&particle[0], &particle[1], &particle[2]);
            let way = Vector3::<L>::load(&particle[WAY], &particle[WAY + 1], &particle[WAY + 2]);
            let normal = Vector3::<L>::load(&strip[NORMAL], &strip[NORMAL + 1], &strip[NORMAL + 2]);
            // The plane holds what the net has pressed through it, with friction.
            let height = L::load(&strip[HEIGHT]);
            let along = way.dot(normal);
            let press = L::max(-L::max(height, zero) - along, zero);
            let slip = way - normal * along;
            let length = slip.length();
            let share = L::max(one - L::load(&strip[FRICTION]) * press / length, zero);
            let share = share.masked(L::gt(length, L::load(&strip[HOLD]) * press));
            let rubbed = normal * (along + press) + slip * share;
            let pressed = L::gt(press, zero);
            let way = Vector3::new(
                L::select(pressed, rubbed.x, way.x),
                L::select(pressed, rubbed.y, way.y),
                L::select(pressed, rubbed.z, way.z),
            );
            let clearance = L::load(&strip[CLEARANCE]);
            let is_far = L::gt(clearance, zero)
                & L::gt(clearance * clearance, L::splat(DETOUR * DETOUR) * way.dot(way));
            let above = L::gt(height + way.dot(normal), L::splat(-ROUNDING));
            let bits = (is_far & above).bits() & *easy;
            *strayed = *easy & !bits;
            let to = from + way;
            let velocity = way * per_second;
            let stored = [to.x, to.y, to.z, velocity.x, velocity.y, velocity.z, way.x, way.y, way.z];
            if *easy == u8::MAX && *strayed == 0 {
                for k in 0..3 {
                    stored[k].store(&mut particle[k]);
                    stored[3 + k].store(&mut strip[k]);
                }
                continue;
            }
            let mut numbers = [[0.0; WIDTH]; 9];
            for k in 0..9 {
                stored[k].store(&mut numbers[k]);
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
