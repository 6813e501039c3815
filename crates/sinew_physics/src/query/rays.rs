//! Batch ray casts for the first hits. The rays traverse the trees in turns, so that memory latencies overlap. Eight
//! leaf boxes are tested together with SIMD. The shape itself then tests each candidate of that test, so the answers
//! equal those of single rays.

use super::candidates::{Reach, sweep, what_is_left};
use super::kind::sealed::{Ask, Reply};
use super::{BodyHit, Query, keep_first};
use crate::body::shape::Shape;
use crate::boxes::Obb;
use crate::boxes::batch::{NUMBERS, Record};
use crate::contact::proxies::Owner;
use crate::id::BodyId;
use crate::ray::{CLEARLY_OUTSIDE, Ray};
use crate::slabs::Slabs;
use crate::tree::{Stop, Sweep, Traversal, Tree};
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::{LaneMask, Lanes, Vector3, WIDTH};
use sinew_math::{Transform, Vec3};

/// Number of rays in flight: while eight of them wait for a box test, the others continue.
const UNDER_WAY: usize = 2 * WIDTH;

/// Finds the [`first`](Query::first) answer of each ray. Fewer than eight rays are cast one after the other.
pub(super) fn first_each<P: Fn(BodyId, u32) -> bool>(
    query: &Query<'_, P>,
    rays: &[Ray],
    hits: &mut [Option<BodyHit>],
) {
    if rays.len() < WIDTH {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = query.best(ray);
        }
    } else {
        first_each_by(|stream| dispatch::run(stream), query, rays, hits);
    }
}

/// Finds the [`first`](Query::first) answer of each ray, as a batch, through the kernel's dispatcher.
fn first_each_by<P: Fn(BodyId, u32) -> bool>(
    run: impl Fn(Stream<'_, '_, P>),
    query: &Query<'_, P>,
    rays: &[Ray],
    hits: &mut [Option<BodyHit>],
) {
    let proxies = &query.world.broad.proxies;
    hits.fill(None);
    for (ray, hit) in rays.iter().zip(&mut *hits).filter(|(ray, _)| way(ray).is_some()) {
        for &owner in proxies.unbounded() {
            ask(query, owner, ray, hit);
        }
    }
    for (tree, owners) in proxies.trees() {
        run(Stream { query, tree, owners, rays, hits, begun: 0 });
    }
}

/// Returns the sweep of a ray; `None` for a ray without answers.
fn way(ray: &Ray) -> Option<Sweep> {
    match ray.reach()? {
        Reach::Swept(start, direction) => sweep(&start, direction),
        Reach::Box(_) | Reach::Near(..) => None,
    }
}

/// Tests a ray against the shape of `owner`, and replaces the ray's hit if the new one is better.
fn ask<P: Fn(BodyId, u32) -> bool>(query: &Query<'_, P>, owner: Owner, ray: &Ray, hit: &mut Option<BodyHit>) {
    let answer = query.meet(owner, |id, shape, frame| ray.ask(id, shape, frame));
    if let Some(answer) = answer.flatten() {
        keep_first(hit, answer);
    }
}

/// Rays that traverse one tree, with their best hits so far.
struct Stream<'a, 'w, P> {
    query: &'a Query<'w, P>,
    tree: &'a Tree,
    owners: &'a [Owner],
    rays: &'a [Ray],
    hits: &'a mut [Option<BodyHit>],
    /// Number of started rays.
    begun: usize,
}

/// A ray in flight.
struct Rider {
    ray: usize,
    sweep: Sweep,
    flight: Traversal,
}

impl Rider {
    fn idle() -> Self {
        let [origin, direction, half_extents] = Default::default();
        let sweep = Sweep { origin, direction, half_extents, limit: 0.0 };
        Self { ray: 0, sweep, flight: Traversal::ended() }
    }
}

impl<P: Fn(BodyId, u32) -> bool> Kernel for Stream<'_, '_, P> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self) {
        let mut riders: [Rider; UNDER_WAY] = core::array::from_fn(|_| Rider::idle());
        // Rays that continue come first.
        let mut order: [usize; UNDER_WAY] = core::array::from_fn(|number| number);
        let mut going = UNDER_WAY;
        let mut nodes = [0; UNDER_WAY];
        let mut meetings = Meetings::NONE;
        loop {
            let mut place = 0;
            while place < going && meetings.count < WIDTH {
                let number = order[place];
                let rider = &mut riders[number];
                let goes_on = match rider.flight.next_stop() {
                    Stop::Node(node) => {
                        nodes[place] = node;
                        place += 1;
                        true
                    }
                    Stop::Leaf(leaf) => !self.arrive(rider, number, leaf, &mut meetings),
                    Stop::End => self.begin(rider),
                };
                if !goes_on {
                    going -= 1;
                    order[place] = order[going];
                }
            }
            for (&number, &node) in order.iter().zip(&nodes).take(place) {
                riders[number].flight.enter::<L>(self.tree, node);
            }
            if meetings.count == WIDTH || going == 0 {
                if meetings.count == 0 {
                    return;
                }
                self.decide(&mut riders, meetings.possible::<L>(), &meetings);
                for &(number, _) in meetings.who() {
                    order[going] = number;
                    going += 1;
                }
                meetings.count = 0;
            }
        }
    }
}

impl<P: Fn(BodyId, u32) -> bool> Stream<'_, '_, P> {
    /// Starts the next ray; returns false if there is none.
    #[inline(always)]
    fn begin(&mut self, rider: &mut Rider) -> bool {
        while let Some(ray) = self.rays.get(self.begun) {
            let number = self.begun;
            self.begun += 1;
            if let Some(sweep) = way(ray) {
                (rider.ray, rider.sweep) = (number, sweep);
                rider.flight.start(self.tree, &sweep);
                self.shorten(rider);
                return true;
            }
        }
        false
    }

    /// Returns true if a ray at a leaf must wait for a batch test; otherwise tests the shape, and the ray continues.
    #[inline(always)]
    fn arrive(&mut self, rider: &mut Rider, number: usize, leaf: u32, meetings: &mut Meetings) -> bool {
        let (owner, ray) = (self.owners[leaf as usize], &self.rays[rider.ray]);
        let limit = rider.flight.limit;
        let waits = self.query.meet(owner, |_, shape, frame| match *shape {
            Shape::Box { half_extents } if !ray.is_long() => {
                meetings.add((number, owner), ray, &placed(half_extents, frame), limit);
                true
            }
            _ => false,
        });
        if waits == Some(false) {
            ask(self.query, owner, ray, &mut self.hits[rider.ray]);
            self.shorten(rider);
        }
        waits == Some(true)
    }

    /// Tests the boxes whose bits are set in a mask.
    fn decide(&mut self, riders: &mut [Rider; UNDER_WAY], possible: u8, meetings: &Meetings) {
        for (place, &(number, owner)) in meetings.who().iter().enumerate() {
            if possible & (1 << place) != 0 {
                let rider = &mut riders[number];
                ask(self.query, owner, &self.rays[rider.ray], &mut self.hits[rider.ray]);
                self.shorten(rider);
            }
        }
    }

    /// Shortens a ray to its hit.
    #[inline(always)]
    fn shorten(&self, rider: &mut Rider) {
        if let Some(hit) = &self.hits[rider.ray] {
            rider.flight.limit = what_is_left(&rider.sweep, hit.rank());
        }
    }
}

fn placed(half_extents: Vec3, frame: &Transform) -> Obb {
    Obb { center: frame.translation, rotation: frame.rotation, half_extents }
}

/// Rays that wait for a box test, one per SIMD lane.
struct Meetings {
    boxes: [[f32; WIDTH]; NUMBERS],
    origins: [[f32; WIDTH]; 3],
    directions: [[f32; WIDTH]; 3],
    limits: [f32; WIDTH],
    /// Index of the ray at each box, and the box's owner.
    who: [(usize, Owner); WIDTH],
    count: usize,
}

impl Meetings {
    const NONE: Self = Self {
        boxes: [[0.0; WIDTH]; NUMBERS],
        origins: [[0.0; WIDTH]; 3],
        directions: [[0.0; WIDTH]; 3],
        limits: [0.0; WIDTH],
        who: [(0, Owner { body: 0, shape: 0 }); WIDTH],
        count: 0,
    };

    #[inline(always)]
    fn who(&self) -> &[(usize, Owner)] {
        &self.who[..self.count]
    }

    /// Adds a ray and its box; fewer than eight may be waiting.
    #[inline(always)]
    fn add(&mut self, who: (usize, Owner), ray: &Ray, obb: &Obb, limit: f32) {
        let place = self.count % WIDTH;
        for (row, number) in self.boxes.iter_mut().zip(Record::of(obb).to_array()) {
            row[place] = number;
        }
        for axis in 0..3 {
            self.origins[axis][place] = ray.origin[axis];
            self.directions[axis][place] = ray.direction[axis];
        }
        (self.limits[place], self.who[place]) = (limit, who);
        self.count += 1;
    }

    /// Returns a bit mask of the rays that may hit their box before their limit: rays that enter it in time, and rays
    /// that start so close to it that they need an exact test.
    #[inline(always)]
    fn possible<L: Lanes>(&self) -> u8 {
        let [[x, y, z], [u, v, w]] = [&self.origins, &self.directions];
        let obb = Record::<L>::load(self.boxes.each_ref());
        let origin = obb.inverse_point(Vector3::load(x, y, z));
        let slabs = Slabs::new(obb.half, origin, obb.inverse_vector(Vector3::load(u, v, w)));
        let beyond = origin.abs() - obb.half;
        let clearly = L::splat(CLEARLY_OUTSIDE);
        let outside = L::gt(beyond.x, clearly) | L::gt(beyond.y, clearly) | L::gt(beyond.z, clearly);
        let in_time = L::le(slabs.enter, L::load(&self.limits));
        ((slabs.is_entered() & in_time) | !outside).bits()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BodyDef, BodyKind, Filter, QueryFilter, ShapeDef, World, WorldDef};
    use sinew_math::Random;
    use sinew_math::dispatch::{Level, run_at};

    /// Returns a world of mostly boxes, static and moving, one or several per body, some of them filtered out.
    fn world(random: &mut Random) -> World {
        let mut world = World::new(WorldDef::default());
        let size = |random: &mut Random| random.range(0.1, 0.8);
        for _ in 0..random.index(120) {
            let count = 1 + random.index(2);
            let shapes = (0..count).map(|_| {
                let shape = match random.index(6) {
                    0 => Shape::Sphere { radius: size(random) },
                    1 => Shape::Capsule { half_height: size(random), radius: size(random) },
                    _ => Shape::Box { half_extents: Vec3::new(size(random), size(random), size(random)) },
                };
                let filter = Filter { layers: 1 << random.index(3), ..Filter::default() };
                let body_from_shape = Transform::new(random.in_cube(), random.rotation());
                ShapeDef { filter, body_from_shape, ..ShapeDef::new(shape) }
            });
            let shapes = shapes.collect();
            let kind = [BodyKind::Static, BodyKind::Static, BodyKind::Dynamic][random.index(3)];
            world.add_body(&BodyDef { kind, position: random.in_cube() * 4.0, shapes, ..BodyDef::default() });
        }
        if random.index(3) == 0 {
            world.add_body(&BodyDef::fixed(Shape::HalfSpace));
        }
        world
    }

    /// Returns a random ray, sometimes axis-parallel, without length, very long or not finite.
    fn ray(random: &mut Random) -> Ray {
        let (origin, mut direction) = (random.in_cube() * 5.0, random.in_cube() * 9.0);
        match random.index(12) {
            0 => direction = Vec3::ZERO,
            1 => direction[random.index(3)] = 0.0,
            2 => direction = Vec3::Y * -direction.x,
            3 => direction *= [1e-20, 1e6, 1e16, 1e30][random.index(4)],
            4 => direction.y = [f32::NAN, f32::INFINITY][random.index(2)],
            5 => return Ray { origin: Vec3::X * [f32::NAN, 1e20][random.index(2)], direction },
            _ => {}
        }
        Ray { origin, direction }
    }

    #[test]
    fn batch_hits_equal_single_ray_hits_at_every_simd_width() {
        let mut random = Random::new(409);
        let (mut hits, mut inside) = (0, 0);
        for _ in 0..80 {
            let world = world(&mut random);
            let rays: Vec<Ray> = (0..random.index(200)).map(|_| ray(&mut random)).collect();
            let meets = Filter { mask: 1 + random.index(7) as u32, ..Filter::default() };
            let query = world.query().filter(QueryFilter { meets, ..QueryFilter::default() });
            let query = query.accept(|body, shape| (body.index + shape) % 5 != 0);
            let single: Vec<_> = rays.iter().map(|ray| query.first(ray)).collect();
            for level in Level::available() {
                let mut each = vec![None; rays.len()];
                first_each_by(|stream| run_at(level, stream), &query, &rays, &mut each);
                for ((ray, each), single) in rays.iter().zip(each).zip(&single) {
                    assert_eq!(each, *single, "{level:?}: {ray:?}");
                }
            }
            hits += single.iter().flatten().count();
            inside += single.iter().flatten().filter(|hit| hit.start.is_some()).count();
        }
        assert!(hits > 1000 && inside > 50, "{hits} hits, {inside} from inside");
    }
}
