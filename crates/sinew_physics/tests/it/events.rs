//! Events of random worlds, compared with an oracle that computes them from the poses of each step, for every number of
//! threads and across snapshots, while bodies are added, removed and changed.

use sinew_math::{Random, Reader, Transform, Vec3, Writer};
use sinew_physics::stage::NoProfiler;
use sinew_physics::*;
use std::collections::BTreeSet;

const STEPS: usize = 120;
/// Magnitude of a gap, metres, below which the oracle does not judge a pair, because rounding decides whether it
/// overlaps. The second value applies if a body sleeps: sleeping bodies keep their last result.
const UNSURE: f64 = 3e-5;
const UNSURE_ASLEEP: f64 = 0.02;

/// A shape of the oracle, in world coordinates: a box, or a ball if `radius` is not 0.
struct Solid {
    center: [f64; 3],
    axes: [[f64; 3]; 3],
    half: [f64; 3],
    radius: f64,
}

type Three = [f64; 3];

fn dot(a: Three, b: Three) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Three, b: Three) -> Three {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn minus(a: Three, b: Three) -> Three {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn wide(v: Vec3) -> Three {
    v.to_array().map(f64::from)
}

impl Solid {
    fn new(shape: &Shape, frame: &Transform) -> Self {
        let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| wide(frame.rotation * axis));
        let (half, radius) = match *shape {
            Shape::Box { half_extents } => (wide(half_extents), 0.0),
            Shape::Sphere { radius } => ([0.0; 3], f64::from(radius)),
            _ => unreachable!("the test makes only boxes and balls"),
        };
        Self { center: wide(frame.translation), axes, half, radius }
    }

    /// Returns half the length of the solid along a unit direction.
    fn reach(&self, along: Three) -> f64 {
        (0..3).map(|i| self.half[i] * dot(self.axes[i], along).abs()).sum::<f64>() + self.radius
    }

    /// Returns the gap between two solids. For overlapping boxes it is minus the depth of the shortest way out; for
    /// separate boxes it is a lower bound of the gap.
    fn gap(&self, other: &Self) -> f64 {
        let apart = minus(other.center, self.center);
        if self.radius > 0.0 && other.radius > 0.0 {
            return dot(apart, apart).sqrt() - self.radius - other.radius;
        }
        if self.radius > 0.0 || other.radius > 0.0 {
            let (ball, cuboid) = if self.radius > 0.0 { (self, other) } else { (other, self) };
            return cuboid.gap_to(ball.center) - ball.radius;
        }
        let crossed = (0..9).map(|k| cross(self.axes[k / 3], other.axes[k % 3]));
        let faces = self.axes.into_iter().chain(other.axes);
        faces.chain(crossed).fold(f64::NEG_INFINITY, |gap, axis| {
            let length = dot(axis, axis).sqrt();
            if length < 1e-6 {
                return gap;
            }
            let axis = axis.map(|x| x / length);
            gap.max(dot(apart, axis).abs() - self.reach(axis) - other.reach(axis))
        })
    }

    /// Returns the signed distance of a point from a box.
    fn gap_to(&self, point: Three) -> f64 {
        let local: [f64; 3] =
            core::array::from_fn(|i| dot(minus(point, self.center), self.axes[i]).abs() - self.half[i]);
        let outside = local.map(|x| x.max(0.0));
        dot(outside, outside).sqrt() + local.into_iter().fold(f64::NEG_INFINITY, f64::max).min(0.0)
    }
}

/// Pairs whose touch has begun and has not ended.
#[derive(Default)]
struct Told {
    bodies: BTreeSet<(BodyId, BodyId)>,
    shapes: BTreeSet<(ShapeId, ShapeId)>,
}

/// Checks that no touch begins twice or ends without a begin, and that lists are sorted.
fn follow<T: Ord + Copy + core::fmt::Debug, K: Ord>(
    told: &mut BTreeSet<T>,
    begin: &[T],
    end: &[T],
    order: impl Fn(&T) -> K,
) {
    assert!(begin.is_sorted_by(|p, q| order(p) < order(q)), "begin events are not sorted: {begin:?}");
    assert!(end.is_sorted_by(|p, q| order(p) < order(q)), "end events are not sorted: {end:?}");
    for pair in end {
        assert!(told.remove(pair), "{pair:?} ends without a begin event");
    }
    for pair in begin {
        assert!(told.insert(*pair), "{pair:?} began twice");
    }
}

impl Told {
    fn follow(&mut self, (begin, end): Lists<'_, BodyId>, (shapes_begin, shapes_end): Lists<'_, ShapeId>) {
        follow(&mut self.bodies, begin, end, |pair| *pair);
        let order = |(a, b): &(ShapeId, ShapeId)| (a.body, b.body, a.shape, b.shape);
        follow(&mut self.shapes, shapes_begin, shapes_end, order);
        let of_shapes: BTreeSet<_> = self.shapes.iter().map(|(a, b)| (a.body, b.body)).collect();
        assert_eq!(self.bodies, of_shapes, "two bodies touch exactly while any of their shapes touch");
    }
}

type Lists<'a, T> = (&'a [(T, T)], &'a [(T, T)]);

fn random_shape(r: &mut Random) -> ShapeDef {
    let shape = match r.index(2) {
        0 => Shape::Box { half_extents: Vec3::new(r.range(0.1, 0.5), r.range(0.1, 0.5), r.range(0.1, 0.5)) },
        _ => Shape::Sphere { radius: r.range(0.1, 0.4) },
    };
    let body_from_shape = Transform::new(r.in_cube() * 0.3, r.rotation());
    let sensing = if r.unit() < 0.2 { Sensing::Sensor } else { Sensing::Solid };
    let rule = if r.unit() < 0.1 { ContactRule::Ghost } else { ContactRule::Push };
    ShapeDef { body_from_shape, filter: random_filter(r), sensing, rule, ..ShapeDef::new(shape) }
}

fn random_filter(r: &mut Random) -> Filter {
    let group = [0, 0, 0, -1, 2][r.index(5)];
    Filter { layers: 1 << r.index(2), mask: if r.unit() < 0.3 { 1 } else { u32::MAX }, group }
}

fn random_body(r: &mut Random) -> BodyDef {
    let kind = [BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic, BodyKind::Dynamic][r.index(4)];
    let velocity = if kind == BodyKind::Static { Vec3::ZERO } else { r.in_cube() * 3.0 };
    BodyDef {
        kind,
        position: random_place(r),
        rotation: r.rotation(),
        linear_velocity: velocity,
        angular_velocity: velocity,
        shapes: (0..=r.index(2)).map(|_| random_shape(r)).collect(),
        ..BodyDef::default()
    }
}

fn random_place(r: &mut Random) -> Vec3 {
    r.in_cube() * 1.5 + Vec3::Y * 1.7
}

fn random_world(r: &mut Random) -> World {
    let mut world = World::new(WorldDef::default());
    let half_extents = Vec3::new(5.0, 0.5, 5.0);
    world.add_body(&BodyDef {
        kind: BodyKind::Static,
        position: Vec3::Y * -0.5,
        shapes: vec![ShapeDef {
            filter: Filter { layers: 3, ..Filter::default() },
            ..ShapeDef::new(Shape::Box { half_extents })
        }],
        ..BodyDef::default()
    });
    for _ in 0..14 {
        world.add_body(&random_body(r));
    }
    world
}

/// Changes the world at random between two steps.
fn disturb(world: &mut World, r: &mut Random, parted: &mut BTreeSet<(BodyId, BodyId)>) {
    let ids: Vec<BodyId> = world.body_ids().skip(1).collect();
    if ids.len() < 2 {
        return;
    }
    let (id, other) = (ids[r.index(ids.len())], ids[r.index(ids.len())]);
    let shapes: Vec<ShapeId> = world.shape_ids(id).collect();
    let shape = shapes[r.index(shapes.len())];
    match r.index(40) {
        0 => world.set_transform(id, Transform::new(random_place(r), r.rotation())),
        1 => world.set_filter(shape, random_filter(r)),
        2 => world.set_sensing(shape, [Sensing::Solid, Sensing::Sensor][r.index(2)]),
        3 => world.set_contact_rule(shape, [ContactRule::Push, ContactRule::Ghost][r.index(2)]),
        4 if id != other => {
            world.disable_pair(id, other);
            // Ids are made from bits, so that the other worlds accept them too.
            let [a, b] = [id, other].map(|id| BodyId::from_bits(id.to_bits()));
            parted.insert((BodyId::min(a, b), BodyId::max(a, b)));
        }
        5 => {
            if let Some((a, b)) = parted.pop_first()
                && world.contains(a)
                && world.contains(b)
            {
                world.enable_pair(b, a);
            }
        }
        6 if ids.len() > 8 => world.remove_body(id),
        7 => {
            world.add_body(&random_body(r));
        }
        8 if world.kind(id) != BodyKind::Static => {
            let velocity = if r.unit() < 0.5 { Vec3::ZERO } else { r.in_cube() * 3.0 };
            world.set_velocity(id, Velocity { linear: velocity, angular: velocity });
        }
        _ => {}
    }
}

/// Returns the pairs of shapes that pushed each other in the last step.
fn pushing_pairs(world: &World) -> BTreeSet<(ShapeId, ShapeId)> {
    let pushing = world.contacts().filter(|contact| contact.impulse() > 0.0);
    pushing.map(|contact| (contact.a, contact.b)).collect()
}

/// Returns the gap up to which a touching pair still touches, metres: 0.2 % of the smallest extent, at most 0.5 mm.
fn release_gap(p: &Solid, q: &Solid) -> f64 {
    let extent = |s: &Solid| 2.0 * (s.radius + s.half.into_iter().fold(f64::INFINITY, f64::min));
    (0.002 * extent(p).min(extent(q))).min(5e-4)
}

/// Calls `found` with each pair of shapes that surely touches or surely does not, whether it touches, and whether it is
/// a sensor pair. Skips uncertain pairs. `parted`: disabled pairs; `touched`: pairs that touched before the step.
fn judge_pairs(
    world: &World,
    parted: &BTreeSet<(BodyId, BodyId)>,
    touched: &BTreeSet<(ShapeId, ShapeId)>,
    mut found: impl FnMut((ShapeId, ShapeId), bool, bool),
) {
    let ids: Vec<BodyId> = world.body_ids().collect();
    let pushed = pushing_pairs(world);
    let solids: Vec<Vec<Solid>> = ids
        .iter()
        .map(|&id| world.shapes(id).map(|(shape, frame)| Solid::new(&shape, &frame)).collect())
        .collect();
    for (i, &a) in ids.iter().enumerate() {
        for (j, &b) in ids.iter().enumerate().skip(i + 1) {
            let lies = |id| world.kind(id) == BodyKind::Dynamic && !world.is_awake(id);
            let unsure = if lies(a) || lies(b) { UNSURE_ASLEEP } else { UNSURE };
            for (s, t) in world.shape_ids(a).flat_map(|s| world.shape_ids(b).map(move |t| (s, t))) {
                let (p, q) = (&solids[i][s.shape as usize], &solids[j][t.shape as usize]);
                let senses = [s, t].map(|id| world.sensing(id) == Sensing::Sensor);
                let kinds = [world.kind(a), world.kind(b)];
                let pushes = kinds.contains(&BodyKind::Dynamic);
                let moves = pushes || kinds.contains(&BodyKind::Kinematic);
                let kinds_meet = match senses {
                    [true, true] => false,
                    [false, false] => pushes,
                    _ => moves,
                };
                let meets = kinds_meet && world.filter(s).meets(world.filter(t)) && !parted.contains(&(a, b));
                let senses = senses != [false, false];
                let gap =
                    p.gap(q) - if touched.contains(&(s, t)) && !senses { release_gap(p, q) } else { 0.0 };
                let pushed = !senses && pushed.contains(&(s, t));
                if gap.abs() > unsure || pushed || !meets {
                    found((s, t), meets && (gap < 0.0 || pushed), senses);
                }
            }
        }
    }
}

/// A world that runs on some number of threads, or is reloaded while it runs; all of them must report equal events.
struct Way {
    world: World,
    threads: usize,
    restores: bool,
}

impl Way {
    fn step(&mut self, count: usize) {
        if self.restores && count.is_multiple_of(3) {
            let mut w = Writer::new();
            self.world.save(&mut w);
            self.world = World::new(WorldDef::default());
            self.world.load(&mut Reader::new(w.as_bytes())).expect("the snapshot must load");
        }
        self.world.step_with(&Threads::new(self.threads), &NoProfiler);
    }
}

/// Compares the events of a seed's world with the oracle, in all ways to run it; returns the number of judged pairs.
fn check(seed: u64) -> usize {
    let ways = [(1, false), (2, false), (4, false), (1, true)];
    let mut ways = ways.map(|(threads, restores)| {
        let world = random_world(&mut Random::new(seed));
        Way { world, threads, restores }
    });
    let (mut touching, mut sensed, mut seen) = (Told::default(), Told::default(), 0);
    let mut parted = BTreeSet::new();
    for step in 0..STEPS {
        let before = parted.clone();
        for way in &mut ways {
            parted = before.clone();
            disturb(&mut way.world, &mut Random::new(seed << 20 | step as u64), &mut parted);
        }
        let mut expected = Vec::new();
        judge_pairs(&ways[0].world, &parted, &touching.shapes, |pair, touches, senses| {
            expected.push((pair, touches, senses));
        });
        ways.iter_mut().for_each(|way| way.step(step));
        let [first, others @ ..] = &ways;
        let events = first.world.events();
        for other in others {
            assert_eq!(events, other.world.events(), "seed {seed} step {step}, {} threads", other.threads);
        }
        let order = |hit: &Hit| (hit.a.body, hit.b.body, hit.a.shape, hit.b.shape);
        assert!(events.hits.is_sorted_by(|p, q| order(p) < order(q)));
        touching.follow((&events.begin, &events.end), (&events.shapes_begin, &events.shapes_end));
        let sensor_shapes = (&events.sensor_shapes_begin[..], &events.sensor_shapes_end[..]);
        sensed.follow((&events.sensor_begin, &events.sensor_end), sensor_shapes);
        for (pair, touches, senses) in expected {
            let told = [touching.shapes.contains(&pair), sensed.shapes.contains(&pair)];
            let right = [touches && !senses, touches && senses];
            assert_eq!(told, right, "seed {seed} step {step}: wrong event for {pair:?}");
            seen += 1;
        }
    }
    let hashes: Vec<u64> = ways.iter().map(|way| way.world.hash()).collect();
    assert!(hashes.iter().all(|hash| *hash == hashes[0]), "seed {seed}: hashes differ: {hashes:?}");
    seen
}

#[test]
fn events_match_an_oracle_of_poses_for_any_threads_and_across_snapshots() {
    let full = std::env::var_os("SINEW_FULL").is_some();
    let seen: usize = (0..if full { 200 } else { 6 }).map(check).sum();
    assert!(seen > if full { 100_000 } else { 3_000 }, "only {seen} pairs of shapes were checked");
}

/// Putting a body to sleep just outside a sensor ends its overlap; just inside, the overlap continues.
#[test]
fn sleeping_beside_a_sensor_ends_the_overlap() {
    for seed in 0..100 {
        let mut random = Random::new(seed);
        let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
        let sensor = ShapeDef { sensing: Sensing::Sensor, ..ShapeDef::new(Shape::sphere(0.4)) };
        world.add_body(&BodyDef::fixed(sensor));
        let (speed, until) = (random.range(0.5, 6.0), random.range(0.8, 1.0));
        let start = Vec3::X * random.range(-1.2, 0.5);
        let ball = BodyDef { linear_velocity: Vec3::X * speed, ..BodyDef::dynamic(Shape::sphere(0.5)) };
        let ball = world.add_body(&ball.at(start));
        let (mut begun, mut slept) = (0, false);
        for _ in 0..300 {
            world.step();
            begun += world.events().sensor_begin.len();
            begun -= world.events().sensor_end.len();
            if !slept && world.transform(ball).translation.x > until {
                world.put_to_sleep(ball);
                slept = true;
            }
        }
        let inside = usize::from(world.transform(ball).translation.x <= 0.9);
        assert_eq!(begun, inside, "seed {seed}: at {}", world.transform(ball).translation.x);
    }
}

/// The step limits huge speeds, and its events for them are finite.
#[test]
fn extreme_hits_are_reported_finite() {
    let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
    let corners = [(-50.0, -50.0), (50.0, -50.0), (50.0, 50.0), (-50.0, 50.0)];
    let points = corners.map(|(x, z)| Vec3::new(x, 0.0, z));
    let ground = Shape::mesh(&points, &[[0, 2, 1], [0, 3, 2]]).expect("the mesh is valid");
    world.add_body(&BodyDef::fixed(ground));
    let mut last = None;
    for i in 0..7 {
        let at = Vec3::new((i / 5) as f32 * 0.41, 0.2 + (i % 5) as f32 * 0.405, 1.0);
        last = Some(world.add_body(&BodyDef::dynamic(Shape::cuboid(Vec3::splat(0.2))).at(at)));
    }
    let last = last.expect("at least one hit is reported");
    let bouncy = Material { friction: 0.25, restitution: 0.5, ..Material::default() };
    let cone = ShapeDef { material: bouncy, ..ShapeDef::new(Shape::cone(0.5, 0.25)) };
    world.add_shape(last, &cone, MassUpdate::Keep);
    world.apply_impulse(last, Vec3::new(0.0, -0.25, -f32::MAX), Vec3::new(0.41, 0.705, 1.0));
    for step in 0..10 {
        world.step();
        for hit in &world.events().hits {
            let numbers = [hit.approach, hit.impulse, hit.greatest];
            let finite =
                numbers.iter().all(|x| x.is_finite()) && hit.point.is_finite() && hit.normal.is_finite();
            assert!(finite, "step {step}: a hit has a number that is not finite: {hit:?}");
        }
    }
}
