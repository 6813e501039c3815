//! Cached nearby obstacles of each particle, so that a particle is not tested against all obstacles.
//!
//! A list is valid while its particle and all obstacles stay within the margins for which it was built. A particle
//! outside its margin is tested against all obstacles. Once many are outside, or an obstacle is, all lists are rebuilt.
//! Excluded obstacles cannot be hit: the results equal those of testing all obstacles, bit for bit, so lists are not
//! part of the state.

use super::contact::{Grip, Placed, distance_at_least};
use super::{BackstopDef, ParticleGroup};
use crate::boxes::Aabb;
use crate::particles::tuning::DETOUR;
use crate::particles::tuning::{LIST_ITERATIONS, LIST_ROOM};
use sinew_math::{Vec3, max};

/// Capacity of all lists together, in indices per particle.
const SHARE: usize = 32;
/// Lists are rebuilt when more than one in this number is invalid.
const LOST_ONE_IN: usize = 16;

/// Lists of nearby obstacles of all particles.
#[derive(Clone, Debug, Default)]
pub(super) struct Near {
    /// Bounds of each obstacle with a margin.
    fat_bounds: Vec<Aabb>,
    /// Position of each particle when its list was built, world, metres.
    origins: Vec<Vec3>,
    /// Smallest distance of all excluded obstacles from the particle's surface at the position in `origins`, metres;
    /// `None` without a list.
    reaches: Vec<Option<f32>>,
    /// The same distance from each particle's current position; 0 or less if its list is invalid.
    beyond: Vec<f32>,
    /// Indices of obstacles, list by list, each ascending.
    obstacles: Vec<u32>,
    /// End of each particle's list in `obstacles`.
    ends: Vec<usize>,
    /// Lower bound of the distance of all shapes from each particle's surface at the last measurement, metres: minus
    /// infinity if unknown.
    distances: Vec<f32>,
    /// Position of the particle at the last measurement, world, metres, and the value of `drift` then.
    measured_at: Vec<Vec3>,
    drifts: Vec<f32>,
    /// Displacement of shapes in this step's previous iterations, metres: sum of the largest in each iteration.
    drift: f32,
    /// Largest displacement of a shape in this iteration, metres.
    way: f32,
    /// Backstop of each particle, or `u32::MAX`; empty for a group without backstops. Backstops are the last obstacles,
    /// and in no list.
    backstop_of: Vec<u32>,
    backstops: usize,
    /// Capacity of `obstacles`; a list that does not fit is not built.
    most: usize,
}

impl Near {
    /// Reserves lists for `count` particles; builds none.
    pub fn new(count: usize, backstops: &[BackstopDef]) -> Self {
        let mut backstop_of = vec![u32::MAX; if backstops.is_empty() { 0 } else { count }];
        for (index, backstop) in backstops.iter().enumerate() {
            backstop_of[backstop.particle as usize] = index as u32;
        }
        Self {
            backstop_of,
            backstops: backstops.len(),
            origins: vec![Vec3::ZERO; count],
            reaches: vec![None; count],
            beyond: vec![0.0; count],
            obstacles: Vec::with_capacity(SHARE * count),
            ends: vec![0; count],
            distances: vec![f32::NEG_INFINITY; count],
            measured_at: vec![Vec3::ZERO; count],
            drifts: vec![0.0; count],
            most: SHARE * count,
            ..Self::default()
        }
    }

    /// Indices, among `count` obstacles, of all within `distance` (m) of a particle's surface, and possibly of others,
    /// ascending; the particle's own backstop is always included.
    pub fn within(&self, i: usize, distance: f32, count: usize) -> impl Iterator<Item = usize> {
        let common = self.common(count);
        let (list, all) = if self.beyond[i] > distance { (self.list(i), 0..0) } else { (&[][..], 0..common) };
        let own = self.backstop_of.get(i).filter(|&&own| own != u32::MAX).map(|&own| common + own as usize);
        list.iter().map(|&obstacle| obstacle as usize).chain(all).chain(own)
    }

    /// Number of obstacles, of `count` in all, that are not backstops.
    pub fn common(&self, count: usize) -> usize {
        count - self.backstops
    }

    /// Marks all distances as unknown.
    pub fn forget_distances(&mut self) {
        self.distances.fill(f32::NEG_INFINITY);
        self.drift = 0.0;
        self.way = 0.0;
    }

    /// Stores the smallest distance of all obstacles from a particle's surface at the start of an iteration, metres.
    pub fn note_distance(&mut self, i: usize, at: Vec3, distance: f32) {
        (self.distances[i], self.measured_at[i], self.drifts[i]) = (distance, at, self.drift);
    }

    /// Advances the displacement of shapes to the next iteration.
    fn drift_on(&mut self, placed: &[Placed]) {
        self.drift += self.way;
        self.way = placed.iter().fold(0.0, |most, placed| max(most, placed.way));
    }

    /// Lower bound of the distance of all obstacles from a particle's surface, minus their motion in this iteration,
    /// metres.
    fn clearance(&self, i: usize, at: Vec3) -> f32 {
        let moved = (at - self.measured_at[i]).length() + (self.drift - self.drifts[i]) + self.way;
        self.distances[i] - moved - rounding_at(at)
    }

    /// Smallest distance of obstacles that [`within`](Self::within) excludes from a particle's surface, metres.
    pub fn left_out_from(&self, i: usize, distance: f32) -> f32 {
        if self.beyond[i] > distance { self.beyond[i] } else { f32::INFINITY }
    }

    fn list(&self, i: usize) -> &[u32] {
        let start = if i == 0 { 0 } else { self.ends[i - 1] };
        &self.obstacles[start..self.ends[i]]
    }

    /// True if each obstacle is within its margin.
    fn holds(&self, placed: &[Placed]) -> bool {
        self.fat_bounds.len() == placed.len()
            && self.fat_bounds.iter().zip(placed).all(|(fat, placed)| fat.contains(&placed.bounds))
    }

    fn make_fat_bounds(&mut self, placed: &[Placed]) {
        self.fat_bounds.clear();
        self.fat_bounds.extend(placed.iter().map(|placed| {
            let way = (placed.end.translation - placed.start.translation).length();
            placed.bounds.expand(LIST_ROOM + LIST_ITERATIONS * way)
        }));
    }

    /// Builds the list of particle `i`, a ball of `radius` at `at`: all obstacles within `reach` of its surface,
    /// metres.
    fn push(&mut self, i: usize, at: Vec3, radius: f32, reach: f32) {
        let start = self.obstacles.len();
        self.reaches[i] = (start < self.most).then_some(reach);
        self.origins[i] = at;
        for (index, fat) in self.fat_bounds.iter().enumerate() {
            if distance_at_least(fat, at) - radius > reach {
                continue;
            }
            if self.obstacles.len() == self.most {
                self.obstacles.truncate(start);
                self.reaches[i] = None;
                break;
            }
            self.obstacles.push(index as u32);
        }
        self.ends[i] = self.obstacles.len();
    }

    /// Updates `beyond` of a particle for its current position `at`.
    pub fn follow(&mut self, i: usize, at: Vec3) {
        self.beyond[i] = match self.reaches[i] {
            Some(reach) => reach - (at - self.origins[i]).length() - rounding_at(at),
            None => 0.0,
        };
    }
}

/// Rounding error of a position, metres.
fn rounding_at(place: Vec3) -> f32 {
    1e-5 + 1e-6 * (place.x.abs() + place.y.abs() + place.z.abs())
}

impl ParticleGroup {
    /// Finds the particles that may be close to a shape, and ensures that most of these have a valid list for this
    /// iteration.
    pub(super) fn find_near(&mut self, h: f32) {
        let common = self.near.common(self.placed.len());
        let holds = self.near.holds(&self.placed[..common]);
        if !holds {
            self.near.forget_distances();
        }
        self.near.drift_on(&self.placed);
        self.find_close(h);
        let mut lost = 0;
        for &i in &self.close {
            let i = i as usize;
            self.near.follow(i, self.positions[i]);
            lost += usize::from(self.near.reaches[i].is_some() && self.near.beyond[i] <= self.sights[i]);
        }
        if holds && lost * LOST_ONE_IN <= self.positions.len() {
            return;
        }
        self.near.make_fat_bounds(&self.placed[..common]);
        self.near.obstacles.clear();
        for i in 0..self.positions.len() {
            let time = LIST_ITERATIONS * h;
            let speed = self.velocities[i].length() + self.accelerations[i].length() * time;
            let room = LIST_ROOM + self.radii[i] + speed * (time + DETOUR * h);
            let reach = self.sight(i, h) + room;
            self.near.push(i, self.positions[i], self.radii[i], reach);
            self.near.follow(i, self.positions[i]);
        }
    }

    /// Lists the particles that are attached or near a shape; the others drop their contacts.
    fn find_close(&mut self, h: f32) {
        self.close.clear();
        for at in 0..self.one_by_one() {
            let i = self.one(at);
            let sight = self.sight(i, h);
            let clearance = self.near.clearance(i, self.positions[i]);
            if clearance > sight && self.attachment_of[i] == u32::MAX {
                self.clearances[i] = clearance;
                if self.grips[i] != Grip::Off {
                    (self.grips[i], self.contact_impulses[i]) = (Grip::Off, Vec3::ZERO);
                }
                continue;
            }
            self.sights[i] = sight;
            self.close.push(i as u32);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::material::Material;
    use crate::body::shape::Shape;
    use crate::particles::{
        Anchor, AttachmentDef, AttachmentTarget, GroupDef, Obstacle, ObstacleBody, ParticleDef, Resists,
        SpringDef,
    };
    use sinew_math::{Random, Sym3, Transform, Writer};

    const H: f32 = 1.0 / 240.0;
    const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);
    const SUBSTEPS: usize = 600;
    const FLOOR: u32 = 0;

    /// Loose balls, and points of which the first is attached; springs connect `links` of them to it.
    fn rain(random: &mut Random, links: u32, iterations: u32) -> GroupDef {
        let mut ball = |radius: f32| ParticleDef {
            position: Vec3::new(random.range(-3.0, 3.0), random.range(1.0, 4.0), random.range(-3.0, 3.0)),
            velocity: random.in_cube() * 12.0,
            mass: random.range(0.01, 0.2),
            radius,
        };
        let mut particles: Vec<ParticleDef> = (0..40).map(|_| ball(0.05)).collect();
        particles.extend((0..20).map(|_| ball(0.0)));
        let string = |a: u32| SpringDef {
            damping: 0.1,
            resists: Resists::Stretch,
            ..SpringDef::new([a, a + 1], 0.2, 200.0)
        };
        let target = AttachmentTarget::World(particles[40].position);
        GroupDef {
            particles,
            springs: (40..40 + links).map(string).collect(),
            attachments: vec![AttachmentDef { particle: 40, target }],
            material: Material { friction: 0.5, restitution: 0.4, ..Material::DEFAULT },
            iterations,
            ..GroupDef::default()
        }
    }

    /// A floor and boxes, balls and capsules, each with its own body; one in `moving_in` moves and rotates, and half of
    /// these are dynamic.
    fn surroundings(random: &mut Random, moving_in: usize) -> (Vec<Obstacle>, Vec<ObstacleBody>) {
        let (mut obstacles, mut bodies) = (Vec::new(), Vec::new());
        for k in 0..80 {
            let place = Vec3::new(random.range(-3.0, 3.0), random.range(0.0, 2.0), random.range(-3.0, 3.0));
            let size = random.range(0.05, 0.4);
            let (shape, frame) = match k % 4 {
                _ if k == FLOOR as usize => (Shape::HalfSpace, Transform::IDENTITY),
                0 => (Shape::Sphere { radius: size }, Transform::from_translation(place)),
                1 => (
                    Shape::Capsule { half_height: size, radius: 0.1 },
                    Transform::new(place, random.rotation()),
                ),
                _ => {
                    let half_extents = Vec3::new(size, 0.1, 0.3);
                    (Shape::Box { half_extents }, Transform::new(place, random.rotation()))
                }
            };
            let mut body = ObstacleBody { center: frame.translation, ..ObstacleBody::default() };
            if k % moving_in == 1 {
                body.linear_velocity = random.in_cube() * 4.0;
                body.angular_velocity = random.in_cube() * 8.0;
                body.inverse_mass = (k % 2) as f32;
                body.inverse_inertia = Sym3::from_diagonal(Vec3::splat(20.0 * body.inverse_mass));
            }
            let material = Material { friction: 0.5, restitution: 0.4, ..Material::DEFAULT };
            let world_from_shape = frame;
            obstacles.push(Obstacle { shape, previous: frame, world_from_shape, body: k as u32, material });
            bodies.push(body);
        }
        (obstacles, bodies)
    }

    fn fly(obstacles: &mut [Obstacle], bodies: &mut [ObstacleBody]) {
        for (o, body) in obstacles.iter_mut().zip(bodies).filter(|(o, _)| o.body != FLOOR) {
            let (from, turn) = (o.world_from_shape, body.angular_velocity);
            o.previous = from;
            if body.linear_velocity != Vec3::ZERO {
                // Moves back and forth among the balls.
                let out = from.translation - Vec3::Y;
                if out.length() > 2.5 && out.dot(body.linear_velocity) > 0.0 {
                    body.linear_velocity = -body.linear_velocity;
                }
                let to = from.translation + body.linear_velocity * H;
                o.world_from_shape = Transform::new(to, from.rotation.integrate(turn, H));
                body.center = to;
            }
        }
    }

    fn bits(group: &ParticleGroup, bodies: &[ObstacleBody]) -> Vec<u8> {
        let mut out = Writer::new();
        group.save(&mut out);
        for body in bodies {
            out.vec3(body.linear_velocity);
            out.vec3(body.angular_velocity);
        }
        for hit in group.body_impulses() {
            out.u32(hit.body);
            out.vec3(hit.impulse);
            out.vec3(hit.point);
        }
        out.into_bytes()
    }

    #[test]
    fn cached_lists_give_the_same_bits_as_testing_all_obstacles() {
        // Cases: constant motion; only particles move; a few bodies pass through resting particles.
        for (seed, links, moving_in) in [(0, 19, 5), (1, 19, usize::MAX), (2, 0, 27)] {
            let mut random = Random::new(seed);
            let def = rain(&mut random, links, 1 + seed as u32);
            let (mut obstacles, mut bodies) = surroundings(&mut random, moving_in);
            let anchors = [Anchor { position: def.particles[40].position, ..Anchor::default() }];
            let mut listed = ParticleGroup::new(&def);
            let mut trying_all = listed.clone();
            trying_all.near.most = 0;
            let (mut tried, mut touching) = (0, 0);
            for substep in 0..SUBSTEPS {
                fly(&mut obstacles, &mut bodies);
                let mut same_bodies = bodies.clone();
                listed.substep(H, GRAVITY, &anchors, &obstacles, &mut bodies);
                trying_all.substep(H, GRAVITY, &anchors, &obstacles, &mut same_bodies);
                assert_eq!(
                    bits(&listed, &bodies),
                    bits(&trying_all, &same_bodies),
                    "seed {seed}, substep {substep}: other bits"
                );
                assert_eq!(trying_all.near.within(3, 0.0, obstacles.len()).count(), obstacles.len());
                let sight = |i| listed.near.within(i, listed.sight(i, H), obstacles.len());
                tried += (0..def.particles.len()).map(|i| sight(i).count()).sum::<usize>();
                touching += listed.touches.iter().flatten().count();
            }
            let pairs = SUBSTEPS * def.particles.len() * obstacles.len();
            assert!(tried * 4 < pairs, "seed {seed}: {tried} of {pairs} pairs are tested");
            assert!(touching > SUBSTEPS, "seed {seed}: only {touching} contacts");
        }
    }

    #[test]
    fn loose_particles_on_static_obstacles_do_not_affect_each_other() {
        let mut random = Random::new(3);
        let all = GroupDef { attachments: Vec::new(), ..rain(&mut random, 0, 2) };
        let (obstacles, bodies) = surroundings(&mut random, usize::MAX);
        let still: Vec<ObstacleBody> = bodies
            .iter()
            .map(|body| ObstacleBody { center: body.center, ..ObstacleBody::default() })
            .collect();
        let run = |def: &GroupDef| {
            let mut group = ParticleGroup::new(def);
            for _ in 0..SUBSTEPS {
                group.begin_step();
                group.substep(H, GRAVITY, &[], &obstacles, &mut still.clone());
            }
            group
        };
        let together = run(&all);
        for (i, &particle) in all.particles.iter().enumerate() {
            let alone = run(&GroupDef { particles: vec![particle], ..all.clone() });
            assert_eq!(together.positions[i], alone.positions[0], "particle {i}");
            assert_eq!(together.velocities[i], alone.velocities[0], "particle {i}");
        }
    }

    #[test]
    fn distant_obstacle_that_reaches_a_resting_particle_hits_it() {
        let ball =
            ParticleDef { position: Vec3::new(0.0, 0.1, 0.0), velocity: Vec3::ZERO, mass: 1.0, radius: 0.1 };
        let mut group = ParticleGroup::new(&GroupDef { particles: vec![ball], ..GroupDef::default() });
        let obstacle = |shape, frame, body| Obstacle {
            shape,
            previous: frame,
            world_from_shape: frame,
            body,
            material: Material { friction: 0.0, ..Material::default() },
        };
        let mut obstacles = [
            obstacle(Shape::HalfSpace, Transform::IDENTITY, FLOOR),
            obstacle(
                Shape::Box { half_extents: Vec3::splat(0.5) },
                Transform::from_translation(Vec3::new(-5.0, 0.5, 0.0)),
                1,
            ),
        ];
        let moving = ObstacleBody { linear_velocity: Vec3::X * 4.0, ..ObstacleBody::default() };
        let mut bodies = [ObstacleBody::default(), moving];
        for _ in 0..480 {
            fly(&mut obstacles, &mut bodies);
            bodies[1].linear_velocity = Vec3::X * 4.0;
            group.substep(H, GRAVITY, &[], &obstacles, &mut bodies);
        }
        // The front of the box is at −4.5 m + 2 s × 4 m/s.
        let ahead = group.positions()[0].x - 3.5;
        assert!((ahead - 0.1).abs() < 1e-3, "the ball is {ahead} m ahead of the box");
    }
}
