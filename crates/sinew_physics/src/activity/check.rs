//! Verifies the bookkeeping against a brute-force recomputation.

use super::Activity;
use crate::body::Rest;
use crate::contact::ContactKey;
use crate::world::World;
use std::collections::{BTreeMap, BTreeSet};

impl World {
    /// Panics unless the incremental bookkeeping matches the bodies, joints and contacts.
    pub(crate) fn check_bookkeeping(&self) {
        let Activity { joints_of, active, kinematic, next, .. } = &self.activity;
        let bodies = || self.bodies.iter();
        assert!(active.iter().eq(bodies().filter(|(_, body)| body.is_active()).map(|(index, _)| index)));
        let is_kinematic = |&index: &u32| self.bodies.at(index).kind == crate::BodyKind::Kinematic;
        assert!(kinematic.iter().copied().eq(bodies().map(|(index, _)| index).filter(is_kinematic)));
        for (index, body) in bodies() {
            let has = |joint: &crate::joint::Joint| joint.a == index || joint.b == index;
            let joints = self.joints.iter().filter(|(_, joint)| has(joint)).map(|(joint, _)| joint);
            assert!(joints_of.body(index).iter().copied().eq(joints), "joints of body {index}");
            if body.is_awake() {
                assert_eq!(next[index as usize], index, "an awake body is in no ring");
            }
        }
        self.check_rings();
        self.check_contacts();
    }

    /// Panics unless each ring contains exactly the sleeping bodies with one island number.
    fn check_rings(&self) {
        let mut islands: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
        for (index, body) in self.bodies.iter() {
            if let Rest::Asleep { island } = body.rest {
                islands.entry(island).or_default().insert(index);
            }
        }
        for members in islands.values() {
            for &index in members {
                let ring: BTreeSet<u32> =
                    core::iter::once(index).chain(self.activity.asleep_with(index)).collect();
                assert_eq!(&ring, members, "the island of body {index}");
            }
        }
    }

    /// Panics unless each contact is in exactly one list, the step's list is ordered, and stored sleeping contacts
    /// cannot change.
    fn check_contacts(&self) {
        assert!(self.contacts.is_sorted_by(|p, q| p.key < q.key));
        let keys: BTreeSet<ContactKey> = self.contacts_in_order().map(|contact| contact.key).collect();
        assert_eq!(keys.len(), self.contacts_in_order().count(), "each contact is in one list only");
        for contact in self.activity.aside.iter() {
            let still = |body: u32| !self.bodies.at(body).can_touch();
            assert!(still(contact.key.a) && still(contact.key.b), "{:?}", contact.key);
        }
    }

    /// Panics unless the islands of the last step equal those found by flood fill over contacts and joints.
    pub(crate) fn check_islands(&self) {
        let mut label: BTreeMap<u32, u32> = BTreeMap::new();
        for island in self.islands.iter() {
            label.extend(island.bodies.iter().map(|&body| (body, body)));
        }
        let touching = self.islands.iter().flat_map(|island| island.contacts);
        let touching = touching.map(|&at| &self.contacts[at as usize].key).map(|key| (key.a, key.b));
        let holding = self.islands.iter().flat_map(|island| island.joints);
        let holding = holding.map(|&at| self.joints.at(at)).map(|joint| (joint.a, joint.b));
        let ties: Vec<(u32, u32)> = touching.chain(holding).collect();
        loop {
            let before = label.clone();
            for (a, b) in &ties {
                if let (Some(&p), Some(&q)) = (label.get(a), label.get(b)) {
                    label.insert(*a, u32::min(p, q));
                    label.insert(*b, u32::min(p, q));
                }
            }
            if label == before {
                break;
            }
        }
        for island in self.islands.iter() {
            assert!(island.bodies.is_sorted());
            let first = island.bodies[0];
            assert!(island.bodies.iter().all(|body| label[body] == first), "{:?}", island.bodies);
            assert_eq!(label.values().filter(|&&l| l == first).count(), island.bodies.len());
        }
    }
}

use crate::body::def::{BodyDef, BodyKind, WorldDef};
use crate::body::shape::{Sensing, Shape, ShapeDef};
use crate::id::{BodyId, JointId};
use crate::joint::def::{JointDef, JointKind};
use crate::runner::Threads;
use crate::stage::NoProfiler;
use crate::{Strength, Velocity};
use sinew_math::{Random, Reader, Transform, Vec3, Writer};

const STEPS: u32 = 500;
/// Number of steps between two random changes of a world.
const PAUSE: usize = 25;

/// A floor, a lift, a sensor over both, and piles that settle.
struct Yard {
    world: World,
    random: Random,
    floor: BodyId,
    lift: BodyId,
    loose: Vec<BodyId>,
    joints: Vec<JointId>,
}

fn solid(shape: Shape) -> ShapeDef {
    ShapeDef::new(shape)
}

fn cuboid(kind: BodyKind, half_extents: Vec3, position: Vec3, sensing: Sensing) -> BodyDef {
    let shapes = vec![ShapeDef { sensing, ..solid(Shape::Box { half_extents }) }];
    BodyDef { kind, position, shapes, ..BodyDef::default() }
}

impl Yard {
    fn new(seed: u64) -> Self {
        let mut world = World::new(WorldDef::default());
        let floor =
            BodyDef { kind: BodyKind::Static, shapes: vec![solid(Shape::HalfSpace)], ..BodyDef::default() };
        let floor = world.add_body(&floor);
        let flat = Vec3::new(0.6, 0.05, 0.6);
        let lift = cuboid(BodyKind::Kinematic, flat, Vec3::Y * 0.05, Sensing::Solid);
        let lift = world.add_body(&lift);
        let zone = cuboid(BodyKind::Kinematic, Vec3::splat(1.0), Vec3::ZERO, Sensing::Sensor);
        world.add_body(&zone);
        let (loose, joints) = (Vec::new(), Vec::new());
        let mut yard = Self { world, random: Random::new(seed), floor, lift, loose, joints };
        for _ in 0..14 {
            yard.drop_one();
        }
        yard
    }

    fn drop_one(&mut self) {
        let random = &mut self.random;
        let place = |random: &mut Random| random.range(-1.2, 1.2);
        let at = Vec3::new(place(random), random.range(0.2, 0.8), place(random));
        let half = Vec3::new(random.range(0.05, 0.2), 0.1, random.range(0.05, 0.2));
        let def = cuboid(BodyKind::Dynamic, half, at, Sensing::Solid);
        self.loose.push(self.world.add_body(&def));
    }

    fn any(&mut self) -> BodyId {
        self.loose[self.random.index(self.loose.len())]
    }

    /// Random changes that a game may make between two steps.
    fn meddle(&mut self) {
        let id = self.any();
        let up = Vec3::Y * self.random.range(0.0, 1.0);
        match self.random.index(11) {
            0 => self.world.wake(id),
            1 => self.world.apply_impulse_at_center(id, up),
            2 => {
                let mut pose = self.world.transform(id);
                pose.translation += up;
                self.world.set_transform(id, pose);
            }
            3 => self.remove(id),
            4 => self.drop_one(),
            5 => self.join(id),
            6 if !self.joints.is_empty() => {
                let joint = self.joints.swap_remove(self.random.index(self.joints.len()));
                self.world.remove_joint(joint);
            }
            7 => {
                let floor = self.world.transform(self.floor);
                self.world.set_transform(self.floor, floor);
            }
            8 => self.world.set_velocity(self.lift, Velocity::default()),
            9 => {
                let led = self.world.kind(id) == BodyKind::Kinematic;
                self.world.set_kind(id, if led { BodyKind::Dynamic } else { BodyKind::Kinematic });
            }
            _ => {
                let linear = Vec3::Y * self.random.range(-0.1, 0.2);
                self.world.set_velocity(self.lift, Velocity { linear, ..Velocity::default() });
            }
        }
    }

    fn remove(&mut self, id: BodyId) {
        if self.loose.len() > 5 {
            let world = &mut self.world;
            self.loose.retain(|&other| other != id);
            world.remove_body(id);
            self.joints.retain(|&joint| world.contains_joint(joint));
        }
    }

    fn join(&mut self, id: BodyId) {
        let other = if self.random.index(3) == 0 { self.lift } else { self.any() };
        let pushed = [id, other].iter().any(|&id| self.world.kind(id) == BodyKind::Dynamic);
        if other != id && pushed {
            let (a, b) = (self.world.transform(id), self.world.transform(other));
            let between = Transform::from_translation((a.translation + b.translation) * 0.5);
            let def = JointDef::new(id, other, a, b, between, JointKind::Ball { limit: None });
            let strength = Strength { force: self.random.range(20.0, 400.0), ..Strength::UNBREAKABLE };
            self.joints.push(self.world.add_joint(&JointDef { strength, ..def }));
        }
    }
}

#[test]
fn bookkeeping_rebuilt_each_step_gives_the_same_bits() {
    let (mut asleep, mut awake, mut aside) = (0, 0, 0);
    for seed in 0..6 {
        let mut yard = Yard::new(seed);
        let mut anew = World::new(WorldDef::default());
        let mut quiet = 100;
        for step in 0..STEPS {
            quiet -= 1;
            if quiet == 0 {
                yard.meddle();
                quiet = 1 + yard.random.index(PAUSE);
            }
            let mut bytes = Writer::new();
            yard.world.save(&mut bytes);
            anew.load(&mut Reader::new(bytes.as_bytes())).expect("a saved world loads");
            yard.world.step();
            anew.step_with(&Threads::new(1 + (seed % 4) as usize), &NoProfiler);
            assert_eq!(yard.world.hash(), anew.hash(), "seed {seed}, step {step}");
            for world in [&yard.world, &anew] {
                world.check_bookkeeping();
                world.check_islands();
            }
            let sleepers = yard.loose.iter().filter(|&&id| !yard.world.is_awake(id)).count();
            asleep += sleepers;
            awake += yard.loose.len() - sleepers;
            aside += yard.world.activity.contacts().count();
        }
    }
    assert!(asleep > 5_000 && awake > 5_000 && aside > 5_000, "{asleep} asleep, {awake} awake, {aside}");
}
