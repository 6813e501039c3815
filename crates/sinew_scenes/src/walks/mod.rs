//! Random walks of a capsule over uneven ground, for Sinew's mover and others: the ground, the wanted velocities, and a
//! flood fill that finds the reachable positions.

mod room;
mod terrain;

pub use room::Room;
pub use terrain::Terrain;

use sinew::math::trig::{cos, sin};
use sinew::math::{Random, Vec3, max};
use sinew::physics::{MoverDef, MoverId, World};

/// Number of steps of a random walk, and of steps between turns.
pub const STEPS: usize = 120;
const TURNS: usize = 20;
/// Number of steps in which a walker comes to rest before the positions around it are checked.
const SETTLES: usize = 60;
/// Depth from which a capsule counts as inside a body, metres.
pub const INSIDE: f32 = 0.005;
/// Displacement in a step from which the walk checks whether the capsule has passed through a body, metres. A smaller
/// displacement leaves the capsule's axis on the same side.
const LONG: f32 = 0.25;

/// A walker: Sinew's mover, or the controller of another engine.
pub trait Walker {
    /// Lowest point of the walker's capsule, world, metres.
    fn feet(&self) -> Vec3;

    /// Returns true if the ground supports the walker.
    fn is_grounded(&self) -> bool;

    /// Takes one step of 1/60 s with a wanted velocity over the ground, m/s.
    fn step(&mut self, wish: Vec3);
}

/// Mover of all walks: [`MoverDef`]'s defaults, with an acceleration that reaches the wanted speed in a few steps.
pub fn capsule() -> MoverDef {
    MoverDef { ground_acceleration: 300.0, ..MoverDef::default() }
}

/// Sinew's mover in a separate world.
pub struct Ours {
    world: World,
    id: MoverId,
}

impl Ours {
    /// A mover with its feet at a position.
    pub fn new(mut world: World, feet: Vec3) -> Self {
        let id = world.add_mover(&MoverDef { position: feet, ..capsule() });
        Self { world, id }
    }

    /// Removes the mover and returns its world.
    pub fn leave(mut self) -> World {
        self.world.remove_mover(self.id);
        self.world
    }
}

impl Walker for Ours {
    fn feet(&self) -> Vec3 {
        self.world.mover(self.id).position()
    }

    fn is_grounded(&self) -> bool {
        self.world.mover(self.id).is_grounded()
    }

    fn step(&mut self, wish: Vec3) {
        self.world.set_mover_walk(self.id, wish);
        self.world.step();
    }
}

/// Counts of walks.
#[derive(Clone, Debug)]
pub struct Tally {
    /// Free space around a capsule that counts as room, metres. Default 8 mm: more than a mover's skin.
    pub margin: f32,
    /// Number of walks.
    pub walks: usize,
    /// Number of steps of all walks, without those to reachable positions.
    pub steps: usize,
    /// Number of steps after which the capsule was inside a body by more than [`INSIDE`].
    pub inside: usize,
    /// Largest depth inside a body, metres.
    pub deepest: f32,
    /// Number of walks that went through a body or under the ground, and ended there.
    pub through: usize,
    /// Number of walks that ended on the ground, from which a flood fill searched for reachable positions.
    pub floods: usize,
    /// Sum over all walks of the positions found by each walk's largest flood fill.
    pub places: usize,
    /// Number of flood fills whose last position was not reached.
    pub stuck: usize,
    /// Description of each fault, with its seed.
    pub wrong: Vec<String>,
}

impl Default for Tally {
    fn default() -> Self {
        Self {
            margin: 0.008,
            walks: 0,
            steps: 0,
            inside: 0,
            deepest: 0.0,
            through: 0,
            floods: 0,
            places: 0,
            stuck: 0,
            wrong: Vec::new(),
        }
    }
}

impl Tally {
    /// Walks at random for two seconds from the walker's position, at up to `fast` m/s, with a new direction every
    /// third of a second; then walks to the farthest position that a flood fill finds.
    pub fn walk(
        &mut self,
        on: &Terrain,
        walker: &mut dyn Walker,
        name: &str,
        fast: f32,
        random: &mut Random,
    ) {
        self.walks += 1;
        if let Err(what) = self.wander(on, walker, fast, random) {
            self.wrong.push(format!("{name}: {what}"));
        } else if let Err(what) = self.explore(on, walker) {
            self.stuck += 1;
            self.wrong.push(format!("{name}: stuck {what}"));
        }
    }

    /// Walks at random and returns the worst fault.
    fn wander(
        &mut self,
        on: &Terrain,
        walker: &mut dyn Walker,
        fast: f32,
        random: &mut Random,
    ) -> Result<(), String> {
        let (mut wish, mut worst, mut place) = (Vec3::ZERO, 0.0_f32, Vec3::ZERO);
        for step in 0..STEPS {
            if step % TURNS == 0 {
                let (angle, speed) = (random.range(0.0, 6.3), random.range(0.0, fast));
                wish = Vec3::new(cos(angle), 0.0, sin(angle)) * speed;
            }
            let before = walker.feet();
            walker.step(wish);
            let now = walker.feet();
            let deep = on.depth(now);
            self.steps += 1;
            self.inside += usize::from(deep > INSIDE);
            if deep > worst {
                (worst, place) = (deep, now);
            }
            self.deepest = max(self.deepest, deep);
            let is_through = (now - before).length() > LONG && on.parts(before, now);
            if is_through || now.y < -0.01 {
                self.through += 1;
                return Err(format!("the capsule passed through a body between {before} and {now}"));
            }
        }
        if worst > INSIDE {
            Err(format!("the capsule is {worst} m inside a body at {place}"))
        } else {
            Ok(())
        }
    }

    /// Lets a walker stand still, and sends it to the farthest reachable position; returns where it is stuck. A walker
    /// that slides off an edge on the way searches again from there.
    fn explore(&mut self, on: &Terrain, walker: &mut dyn Walker) -> Result<(), String> {
        const TRIES: usize = 3;
        let (mut places, mut stuck) = (0, None);
        for _ in 0..TRIES {
            (0..SETTLES).for_each(|_| walker.step(Vec3::ZERO));
            if !walker.is_grounded() {
                break;
            }
            let room = Room::around(on, walker.feet(), self.margin);
            places = usize::max(places, room.len());
            match room.walk(walker) {
                Ok(()) => {
                    stuck = None;
                    break;
                }
                Err([to, from]) => {
                    stuck = Some(format!("stuck at {} on the way from {from} to {to}", walker.feet()));
                }
            }
        }
        self.floods += usize::from(places > 0);
        self.places += places;
        stuck.map_or(Ok(()), Err)
    }
}
