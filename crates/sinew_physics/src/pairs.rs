//! `pairs`: which shapes may meet, found by the trees over their bounds.

use crate::activity::Activity;
use crate::arena::Arena;
use crate::body::Body;
use crate::contact::{Contact, ContactKey};
use crate::filter::PairFilter;
use crate::meetings::Meetings;
use crate::proxies::{Owner, Proxies};

/// The trees, and what pairs are found with.
#[derive(Clone, Debug, Default)]
pub(crate) struct BroadPhase {
    pub proxies: Proxies,
    keys: Vec<ContactKey>,
    next: Vec<Contact>,
}

impl BroadPhase {
    /// Brings `contacts` up to date: sorted by key, one for each pair that may meet. Those to which nothing can happen are
    /// put aside; what touched and is dropped, `meetings` tell of.
    pub fn update(
        &mut self,
        bodies: &Arena<Body>,
        filter: PairFilter<'_>,
        meetings: &mut Meetings,
        contacts: &mut Vec<Contact>,
        activity: &mut Activity,
        dt: f32,
    ) {
        activity.return_contacts(contacts);
        self.proxies.follow(bodies, activity, dt);
        self.keys.clear();
        let keys = &mut self.keys;
        let mut visit = |p, q| {
            let key = key(p, q);
            if filter.lets_meet(bodies, key) {
                keys.push(key);
            }
        };
        self.proxies.pairs(bodies, activity, &mut visit);
        self.proxies.pairs_of_changed(bodies, &meetings.stirred, &mut visit);
        self.keys.sort_unstable();
        self.merge(bodies, meetings, contacts, activity);
    }

    /// Merges the sorted keys with the sorted contacts: old ones keep their memory, and those that were not found go, or
    /// are put aside where nothing about them can have changed.
    fn merge(
        &mut self,
        bodies: &Arena<Body>,
        meetings: &mut Meetings,
        contacts: &mut Vec<Contact>,
        activity: &mut Activity,
    ) {
        let lies_still = |index: u32| !bodies.at(index).can_touch() && !bodies.at(index).quarantined;
        let mut part_with = |contact: Contact| {
            if lies_still(contact.key.a) && lies_still(contact.key.b) {
                // What it came in with was not of the step in which it comes back.
                activity.put_aside(Contact { approach: 0.0, ..contact });
            } else {
                meetings.part(bodies, &contact);
            }
        };
        self.next.clear();
        let mut old = contacts.iter().copied().peekable();
        for &key in &self.keys {
            while let Some(contact) = old.next_if(|contact| contact.key < key) {
                part_with(contact);
            }
            let before = self.next.len();
            while let Some(contact) = old.next_if(|contact| contact.key.is_of_pair(key)) {
                self.next.push(contact);
            }
            if self.next.len() == before {
                self.next.push(Contact::new(key));
            }
        }
        old.for_each(part_with);
        core::mem::swap(contacts, &mut self.next);
    }
}

fn key(p: Owner, q: Owner) -> ContactKey {
    ContactKey::new((p.body, p.shape), (q.body, q.shape))
}

#[cfg(test)]
mod tests {
    //! Pairs against trying every shape with every other.

    use super::*;
    use crate::boxes::{Aabb, Overlap};
    use crate::def::{BodyDef, BodyKind, WorldDef};
    use crate::id::BodyId;
    use crate::proxies::MARGIN;
    use crate::shape::{Filter, Shape, ShapeDef};
    use crate::{Velocity, World};
    use sinew_math::{Random, Reader, Transform, Vec3, Writer};

    /// Cases: a hundredth unless `SINEW_FULL` is set.
    fn cases(all: usize) -> usize {
        if std::env::var_os("SINEW_FULL").is_some() { all } else { all / 100 }
    }

    /// The bounds within which contacts of a shape are looked for, written down once more.
    fn grown(body: &Body, shape: usize, dt: f32) -> Aabb {
        let speed = body.velocity.linear.length() + body.velocity.angular.length() * body.reach();
        let motion = if body.kind == BodyKind::Static { 0.0 } else { speed * dt };
        body.shapes[shape].shape.aabb(&body.world_from_shape(shape)).expand(MARGIN + motion)
    }

    fn tried(world: &World, filter: PairFilter<'_>) -> Vec<ContactKey> {
        let mut keys = Vec::new();
        let dt = world.def.dt();
        for (a, p) in world.bodies.iter() {
            for (b, q) in world.bodies.iter().filter(|&(b, _)| a < b) {
                let touches = p.can_touch() || q.can_touch();
                for (shape_a, shape_b) in
                    (0..p.shapes.len()).flat_map(|i| (0..q.shapes.len()).map(move |j| (i, j)))
                {
                    let (owner_a, owner_b) =
                        (Owner { body: a, shape: shape_a as u32 }, Owner { body: b, shape: shape_b as u32 });
                    if touches
                        && grown(p, shape_a, dt).overlaps(&grown(q, shape_b, dt))
                        && filter.lets_meet(&world.bodies, key(owner_a, owner_b))
                    {
                        keys.push(key(owner_a, owner_b));
                    }
                }
            }
        }
        keys.sort_unstable();
        keys
    }

    fn some_shape(random: &mut Random, kind: BodyKind) -> ShapeDef {
        let size = if random.unit() < 0.1 { 2.0 } else { 0.2 };
        let shape = match random.index(if kind == BodyKind::Static { 8 } else { 7 }) {
            0..3 => Shape::Box { half_extents: (random.in_cube() * size).abs() + Vec3::splat(1e-3) },
            3..5 => Shape::Sphere { radius: size * (0.1 + random.unit()) },
            5..7 => Shape::Capsule { half_height: size * random.unit(), radius: 0.5 * size },
            _ => Shape::HalfSpace,
        };
        let body_from_shape = Transform::new(random.in_cube() * size, random.rotation());
        let filter = Filter { layers: 1 << random.index(2), mask: 1 + random.index(3) as u32, group: 0 };
        ShapeDef { body_from_shape, filter, ..ShapeDef::new(shape) }
    }

    fn add(world: &mut World, random: &mut Random, range: f32) -> BodyId {
        let kind =
            [BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic, BodyKind::Dynamic][random.index(4)];
        let count = if random.unit() < 0.02 { 100 } else { 1 + random.index(3) };
        world.add_body(&BodyDef {
            kind,
            position: random.in_cube() * range,
            rotation: random.rotation(),
            linear_velocity: random.in_cube() * 4.0,
            angular_velocity: random.in_cube() * 4.0,
            shapes: (0..count).map(|_| some_shape(random, kind)).collect(),
            ..BodyDef::default()
        })
    }

    fn change(world: &mut World, random: &mut Random, range: f32) {
        let ids: Vec<BodyId> = world.body_ids().collect();
        let Some(&id) = ids.get(random.index(ids.len().max(1))) else { return };
        match random.index(7) {
            0 => world.remove_body(id),
            1 | 2 => drop(add(world, random, range)),
            3 => world.set_transform(id, Transform::new(random.in_cube() * range, random.rotation())),
            4 => world.set_velocity(id, Velocity { linear: random.in_cube() * 20.0, ..Velocity::default() }),
            5 => world.set_velocity(id, Velocity::default()),
            _ => {
                let other = ids[random.index(ids.len())];
                if other != id {
                    world.disable_pair(id, other);
                }
            }
        }
    }

    /// What the next step will find, and whether it is what there is to find.
    fn check(world: &mut World, case: usize) -> usize {
        let dt = world.def.dt();
        let parted = world.parted.filter(&world.joints).parted.to_vec();
        let filter = PairFilter { parted: &parted, function: None };
        let World { bodies, broad, meetings, contacts, activity, .. } = &mut *world;
        broad.update(bodies, filter, meetings, contacts, activity, dt);
        let tried = tried(world, filter);
        assert_eq!(world.broad.keys, tried, "case {case}");
        tried.len()
    }

    #[test]
    fn pairs_are_those_that_trying_all_finds() {
        let mut random = Random::new(11);
        let (mut case, mut found) = (0, 0);
        while case < cases(100_000) {
            let mut world = World::new(WorldDef::default());
            let range = [2.0, 6.0, 1e5][random.index(3)];
            for _ in 0..random.index(40) {
                add(&mut world, &mut random, range);
            }
            let mut saved: Vec<Vec<u8>> = Vec::new();
            for _ in 0..20 {
                for _ in 0..random.index(6) {
                    change(&mut world, &mut random, range);
                }
                if random.unit() < 0.3 {
                    world.step();
                }
                if random.unit() < 0.1 {
                    let mut w = Writer::new();
                    world.save(&mut w);
                    saved.push(w.into_bytes());
                }
                if random.unit() < 0.1 && !saved.is_empty() {
                    let bytes = &saved[random.index(saved.len())];
                    world.load(&mut Reader::new(bytes)).expect("it was saved");
                }
                found += check(&mut world, case);
                case += 1;
            }
        }
        assert!(found > case, "{found} pairs in {case} cases say little");
    }
}
