//! A flock: `cargo run -p sinew --example flock`.
//!
//! Birds are bodies: they bounce off each other and off the tower in their way. A custom object makes them a flock
//! (Reynolds, "Flocks, Herds, and Schools", SIGGRAPH 1987): each bird avoids near birds, matches its neighbours'
//! velocity, and stays with them. All birds are attracted to a position that changes from time to time, and none leaves
//! the aviary.

use sinew::prelude::*;
use std::time::Duration;

const BIRDS: usize = 40;
/// Mass of a bird, kg.
const MASS: f32 = 0.05;
/// Cruising speed, m/s.
const SPEED: f32 = 5.0;
/// Largest acceleration of a wing, m/s².
const AGILITY: f32 = 25.0;
/// Distance at which a bird reacts to others, and distance that it keeps, m.
const SIGHT: f32 = 3.0;
const CLEARANCE: f32 = 0.8;
/// Radius of the aviary, m.
const AVIARY: f32 = 12.0;
/// Time until the flock chooses another target, seconds.
const PATIENCE: f32 = 4.0;

/// Birds that fly together.
struct Flock {
    birds: Vec<BodyId>,
    /// Target position, and time until the flock chooses another, seconds.
    goal: Vec3,
    patience: f32,
    /// Seed of the next target position.
    seed: u64,
    /// Position and velocity of each bird in the current substep.
    seen: Vec<(Vec3, Vec3)>,
}

impl Flock {
    fn new(seed: u64) -> Self {
        Self { birds: Vec::new(), goal: Vec3::ZERO, patience: 0.0, seed, seen: Vec::new() }
    }

    fn choose_goal(&mut self) {
        let mut random = Random::new(self.seed);
        (self.goal, self.patience) = (random.direction() * (0.6 * AVIARY), PATIENCE);
        self.seed = random.bits();
    }

    /// Returns the wanted acceleration of bird `i`.
    fn steer(&self, i: usize) -> Vec3 {
        let (place, velocity) = self.seen[i];
        let (mut apart, mut center, mut drift, mut count) = (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, 0.0);
        for (j, &(other, flies)) in self.seen.iter().enumerate() {
            let (away, distance) = (place - other, (place - other).length());
            if j == i || distance > SIGHT || distance == 0.0 {
                continue;
            }
            if distance < CLEARANCE {
                apart += away * (CLEARANCE / distance - 1.0);
            }
            (center, drift, count) = (center + other, drift + flies, count + 1.0);
        }
        let to_goal = (self.goal - place).normalize_or_zero();
        let mut wish = apart * 60.0 + to_goal * 4.0 + velocity * (SPEED / velocity.length().max(0.1) - 1.0);
        if count > 0.0 {
            wish += (center / count - place) * 1.0 + (drift / count - velocity) * 3.0;
        }
        wish * (AGILITY / wish.length().max(AGILITY))
    }

    /// Returns the length of the mean of the birds' directions: 0 for random directions, 1 for equal ones.
    fn order(&self, world: &World) -> f32 {
        let direction = |&id: &BodyId| world.velocity(id).linear.normalize_or_zero();
        self.birds.iter().map(direction).sum::<Vec3>().length() / self.birds.len() as f32
    }
}

impl PhysicsObject for Flock {
    fn kind(&self) -> &'static str {
        "flock"
    }

    /// Adds the birds at random positions with random velocities.
    fn init(&mut self, world: &mut World) {
        let mut random = Random::new(self.seed);
        let radius = 0.1;
        let density = MASS / Shape::Sphere { radius }.mass_properties(1.0).mass;
        let mut hatch = |_| {
            world.add_body(&BodyDef {
                position: random.direction() * (0.7 * AVIARY),
                linear_velocity: random.direction() * SPEED,
                gravity_scale: 0.0,
                ..BodyDef::dynamic(ShapeDef { density, ..ShapeDef::new(Shape::Sphere { radius }) })
            })
        };
        self.birds = (0..BIRDS).map(&mut hatch).collect();
        self.seed = random.bits();
    }

    fn add_forces(&mut self, forces: &mut Forces<'_>) {
        self.patience -= forces.h();
        if self.patience <= 0.0 {
            self.choose_goal();
        }
        self.seen.clear();
        let see = |&id: &BodyId| (forces.center_of_mass(id), forces.velocity(id).linear);
        self.seen.extend(self.birds.iter().map(see));
        for (i, &id) in self.birds.iter().enumerate() {
            forces.apply_force_at_center(id, self.steer(i) * MASS);
        }
    }

    /// Moves birds outside of the aviary's net, which is not a shape, back inside, with the velocity of that motion.
    fn satisfy_constraints(&mut self, corrections: &mut Corrections<'_>) {
        for &id in &self.birds {
            let place = corrections.center_of_mass(id);
            let outside = place.length() - AVIARY;
            if outside > 0.0 {
                let back = -place.normalize() * (outside / corrections.h());
                corrections.correct(id, back * MASS, place);
            }
        }
    }

    fn draw(&self, world: &World, out: &mut dyn DebugDraw) {
        for &id in &self.birds {
            let place = world.center_of_mass(id);
            out.line(place, place + world.velocity(id).linear * 0.1, DrawKind::Object);
        }
    }

    fn save(&self, w: &mut Writer) {
        w.count(self.birds.len());
        for id in &self.birds {
            w.u64(id.to_bits());
        }
        w.vec3(self.goal);
        w.f32(self.patience);
        w.u64(self.seed);
    }

    fn load(&mut self, r: &mut Reader<'_>) -> Result<(), ReadError> {
        self.birds.clear();
        for _ in 0..r.count(8)? {
            self.birds.push(BodyId::from_bits(r.u64()?));
        }
        self.goal = r.vec3()?;
        self.patience = r.f32()?;
        self.seed = r.u64()?;
        Ok(())
    }
}

/// Simulates `seconds` in frames of 1/30 s; returns the largest distance of a bird beyond the net and the smallest
/// distance between two birds, m.
fn fly(world: &mut World, flock: ObjectId, seconds: u32) -> (f32, f32) {
    let (mut outside, mut apart) = (0.0, f32::INFINITY);
    for _ in 0..seconds * 30 {
        world.update(Duration::from_nanos(33_333_334));
        let birds = &world.object::<Flock>(flock).birds;
        let places: Vec<Vec3> = birds.iter().map(|&id| world.center_of_mass(id)).collect();
        for (i, place) in places.iter().enumerate() {
            outside = f32::max(outside, place.length() - AVIARY);
            apart = places[..i].iter().fold(apart, |least, other| least.min((*place - *other).length()));
        }
    }
    (outside, apart)
}

/// Lets the flock form, and checks that a snapshot has its whole state.
pub fn main() {
    let mut world = World::new(WorldDef::default());
    let tower = Shape::Capsule { half_height: AVIARY, radius: 0.5 };
    world.add_body(&BodyDef::fixed(tower));
    let flock = world.add_object(Box::new(Flock::new(7)));
    world.mark();
    let order = |world: &World| world.object::<Flock>(flock).order(world);
    let hatched = order(&world);
    let (outside, apart) = fly(&mut world, flock, 15);
    println!("{BIRDS} birds: order {hatched:.2} when hatched, {:.2} after 15 s", order(&world));
    println!("{:.1} mm out at most, {apart:.3} m apart at least", outside * 1e3);
    assert!(hatched < 0.4 && order(&world) > 0.8, "a swarm has become a flock");
    assert!(outside < 1e-3, "no bird is outside the aviary");
    assert!(apart > 0.2 - 0.01, "balls do not pass through each other");

    let after = world.hash();
    world.reset();
    assert_eq!(order(&world), hatched);
    fly(&mut world, flock, 15);
    assert_eq!(world.hash(), after, "the same flight again, bit for bit");

    let mut snapshot = Writer::new();
    world.save(&mut snapshot);
    let mut other = World::new(WorldDef::default());
    other.register_kind(|| Box::new(Flock::new(0)));
    other.load(&mut Reader::new(snapshot.as_bytes())).expect("the saved state can be loaded");
    let goes_on = [&mut world, &mut other].map(|world| {
        fly(world, flock, 5);
        world.hash()
    });
    assert_eq!(goes_on[0], goes_on[1]);
    println!("reset: the same again; a snapshot goes on in another world: state {after:016x}");
}
