//! `pairs`: candidate shape pairs, from the trees over their bounds.

use crate::activity::Activity;
use crate::arena::Arena;
use crate::body::Body;
use crate::collide::{Manifold, SeparationCache};
use crate::contact::filter::PairFilter;
use crate::contact::near::{NearPair, NearPairs, bear};
use crate::contact::proxies::Proxies;
use crate::contact::recycled::Recycled;
use crate::contact::tracking::ContactTracking;
use crate::contact::{Contact, ContactKey};
use crate::step::blows::Blows;

/// Trees and near pairs, and memory for the pair search.
#[derive(Clone, Debug, Default)]
pub(crate) struct BroadPhase {
    pub proxies: Proxies,
    pub near: NearPairs,
    /// Impacts that joints will transmit in this step.
    pub blows: Blows,
    /// Pairs without a contact that are near enough to have points, in order.
    pub asked: Vec<Asked>,
    /// New contacts, in order.
    pub born: Vec<Contact>,
}

/// A pair without a contact, and its search result.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asked {
    pub key: ContactKey,
    /// Position among the near pairs.
    pub pair: usize,
    pub parting: SeparationCache,
    pub manifold: Manifold,
    pub kept: Recycled,
}

impl BroadPhase {
    /// Updates `contacts`: sorted by key, for near pairs. Stores contacts that cannot change in `activity`, and records
    /// dropped touching contacts in `meetings`. Lists near pairs without a contact in `asked`, for `collide` to test.
    pub fn update(
        &mut self,
        bodies: &Arena<Body>,
        filter: PairFilter<'_>,
        meetings: &mut ContactTracking,
        contacts: &mut Vec<Contact>,
        activity: &mut Activity,
        dt: f32,
    ) {
        activity.return_contacts(contacts);
        self.proxies.update_motion(bodies, activity.movers(), &meetings.changed, dt);
        self.blows.widen(&mut self.proxies, bodies);
        self.near.update(&mut self.proxies, bodies, filter);
        self.sort_out(bodies, meetings, contacts, activity);
        bear(contacts, &mut self.born);
    }

    /// Merges pairs and contacts. Contacts of pairs that are no longer near are dropped, or stored in `activity` if
    /// they cannot have changed.
    fn sort_out(
        &mut self,
        bodies: &Arena<Body>,
        meetings: &mut ContactTracking,
        contacts: &mut Vec<Contact>,
        activity: &mut Activity,
    ) {
        self.asked.clear();
        self.born.clear();
        let mut keeper = Keeper { contacts, from: 0, to: 0, bodies, meetings, activity };
        let mut next = keeper.next_pair();
        for (place, pair) in self.near.list.iter_mut().enumerate() {
            while next < pair.key {
                keeper.part(1);
                next = keeper.next_pair();
            }
            let count = if next == pair.key { keeper.count_of(pair.key) } else { 0 };
            if count == 0 && !pair.meets {
                // The pair is tested again when its filters let the shapes collide.
                pair.left = f32::NEG_INFINITY;
                continue;
            }
            if count == 0 {
                let closing = self.proxies.closing(pair.key);
                let (key, leaves) = (pair.key, pair.leaves);
                if !pair.comes_near(&closing)
                    || pair.is_apart(&closing, self.proxies.gap(bodies, key, leaves))
                {
                    continue;
                }
            }
            let is_near = pair.meets && self.proxies.are_near(bodies, pair.key, pair.leaves);
            match (count, is_near) {
                (0, false) => {}
                (0, true) if pair.has_surface => {
                    self.born.push(Contact { has_surface: true, ..Contact::new(pair.key) });
                }
                (0, true) => self.asked.push(Asked::new(place, pair)),
                (_, false) => {
                    pair.left = f32::NEG_INFINITY;
                    keeper.part(count);
                }
                (1, true) if !pair.has_surface && keeper.next_is_idle() => {
                    // The contact had no points in the last step: from now on the pair stores the gap.
                    let parting = keeper.forget();
                    pair.part(&parting);
                    if pair.comes_near(&self.proxies.closing(pair.key)) {
                        self.asked.push(Asked::new(place, pair));
                    }
                }
                (_, true) => keeper.keep(count),
            }
            if count > 0 {
                next = keeper.next_pair();
            }
        }
        keeper.finish();
    }

    /// Makes contacts of the tested pairs with points; stores the gap of the other pairs.
    pub fn answer(&mut self, contacts: &mut Vec<Contact>, weigh: impl Fn(&mut Contact)) {
        self.born.clear();
        for asked in &self.asked {
            if asked.manifold.count > 0 {
                let Asked { key, manifold, kept, .. } = *asked;
                let mut contact = Contact { manifold, kept, ..Contact::new(key) };
                weigh(&mut contact);
                self.born.push(contact);
            } else {
                self.near.list[asked.pair].part(&asked.parting);
            }
        }
        bear(contacts, &mut self.born);
    }
}

impl Asked {
    fn new(pair: usize, near: &NearPair) -> Self {
        Self {
            key: near.key,
            pair,
            parting: near.parting(),
            manifold: Manifold::default(),
            kept: Recycled::default(),
        }
    }
}

/// The contacts of the last step, each of which is kept or dropped.
struct Keeper<'a> {
    contacts: &'a mut Vec<Contact>,
    /// Positions of the first undecided contact, and for the next kept one.
    from: usize,
    to: usize,
    bodies: &'a Arena<Body>,
    meetings: &'a mut ContactTracking,
    activity: &'a mut Activity,
}

impl Keeper<'_> {
    /// Pair of the first undecided contact; the maximum if there is none.
    fn next_pair(&self) -> ContactKey {
        let end = ContactKey { a: u32::MAX, b: u32::MAX, shape_a: u32::MAX, shape_b: u32::MAX, part: 0 };
        self.contacts.get(self.from).map_or(end, |contact| ContactKey { part: 0, ..contact.key })
    }

    /// Number of contacts of a pair, from the first undecided one on.
    fn count_of(&self, key: ContactKey) -> usize {
        let rest = &self.contacts[self.from..];
        rest.iter().take_while(|contact| contact.key.is_of_pair(key)).count()
    }

    /// True if the first undecided contact has no points and nothing to report.
    fn next_is_idle(&self) -> bool {
        self.contacts[self.from].is_idle()
    }

    fn keep(&mut self, count: usize) {
        if self.to != self.from {
            self.contacts.copy_within(self.from..self.from + count, self.to);
        }
        self.from += count;
        self.to += count;
    }

    /// Drops an idle contact, and returns the separating axis and gap of its shapes.
    fn forget(&mut self) -> SeparationCache {
        self.from += 1;
        self.contacts[self.from - 1].parting()
    }

    fn part(&mut self, count: usize) {
        for _ in 0..count {
            let contact = self.contacts[self.from];
            self.from += 1;
            let lies_still = |index: u32| {
                let body = self.bodies.at(index);
                !body.can_touch() && !body.quarantined
            };
            if !lies_still(contact.key.a) || !lies_still(contact.key.b) {
                self.meetings.part(self.bodies, &contact);
            } else if !contact.is_idle() {
                // The approach speed is not that of the step in which the contact returns.
                self.activity.put_aside(Contact { approach: 0.0, ..contact });
            }
        }
    }

    fn finish(mut self) {
        let rest = self.contacts.len() - self.from;
        self.part(rest);
        self.contacts.truncate(self.to);
    }
}

#[cfg(test)]
mod tests {
    //! Tests that compare the pairs with those found by testing every shape against every other.

    use super::*;
    use crate::body::def::{BodyDef, BodyKind, WorldDef};
    use crate::body::shape::{Filter, Sensing, Shape, ShapeDef};
    use crate::boxes::{Aabb, Overlap};
    use crate::contact::proxies::Owner;
    use crate::contact::seams::Seams;
    use crate::contact::tuning::MARGIN;
    use crate::id::{BodyId, ShapeId};
    use crate::{MassUpdate, Velocity, World};
    use core::ops::ControlFlow;
    use sinew_math::{Random, Reader, Transform, Vec3, Writer};

    /// Number of test cases: a hundredth of `all` unless `SINEW_FULL` is set.
    fn cases(all: usize) -> usize {
        if std::env::var_os("SINEW_FULL").is_some() { all } else { all / 100 }
    }

    /// Bounds for the contact search of a shape, computed independently.
    fn grown(body: &Body, shape: usize, dt: f32) -> Aabb {
        let speed = body.velocity.linear.length() + body.velocity.angular.length() * body.reach();
        let motion = if body.kind == BodyKind::Static { 0.0 } else { speed * dt };
        body.shapes[shape].shape.aabb(&body.world_from_shape(shape)).expand(MARGIN + motion)
    }

    fn key(p: Owner, q: Owner) -> ContactKey {
        ContactKey::new((p.body, p.shape), (q.body, q.shape))
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
        let filter = Filter { layers: 1 << random.index(2), mask: random.index(4) as u32, group: 0 };
        ShapeDef { body_from_shape, filter, sensing: some_sensing(random), ..ShapeDef::new(shape) }
    }

    fn some_sensing(random: &mut Random) -> Sensing {
        if random.unit() < 0.2 { Sensing::Sensor } else { Sensing::Solid }
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
        let shapes = world.bodies.at(id.index).shapes.len();
        let shape = ShapeId { body: id, shape: random.index(shapes) as u32 };
        match random.index(12) {
            0 => world.remove_body(id),
            1 | 2 => drop(add(world, random, range)),
            3 => world.set_transform(id, Transform::new(random.in_cube() * range, random.rotation())),
            4 => world.set_velocity(id, Velocity { linear: random.in_cube() * 20.0, ..Velocity::default() }),
            5 => world.set_velocity(id, Velocity::default()),
            6 => _ = world.add_shape(id, &some_shape(random, BodyKind::Dynamic), MassUpdate::Keep),
            7 => world.set_shape(shape, &some_shape(random, BodyKind::Dynamic), MassUpdate::Keep),
            8 if shapes > 1 => world.remove_shape(shape, MassUpdate::Keep),
            9 if world.bodies.at(id.index).shapes.iter().all(|shape| shape.shape != Shape::HalfSpace) => {
                let kinds = [BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic];
                world.set_kind(id, kinds[random.index(3)]);
            }
            10 => world.set_sensing(shape, some_sensing(random)),
            _ => {
                let other = ids[random.index(ids.len())];
                if other != id {
                    world.disable_pair(id, other);
                }
            }
        }
    }

    /// Checks that the next step will find all pairs. Returns their number.
    fn check(world: &mut World, case: usize) -> usize {
        let dt = world.def.dt();
        let PairFilter { parted, version, .. } = world.parted.filter(&world.joints);
        let parted = parted.to_vec();
        let filter = PairFilter { parted: &parted, function: None, version };
        let World { bodies, broad, meetings, contacts, activity, .. } = &mut *world;
        broad.update(bodies, filter, meetings, contacts, activity, dt);
        let tried = tried(world, filter);
        let BroadPhase { proxies, near, .. } = &world.broad;
        let near = near.list.iter();
        let near = near.filter(|pair| pair.meets && proxies.are_near(&world.bodies, pair.key, pair.leaves));
        let found: Vec<ContactKey> = near.map(|pair| pair.key).collect();
        assert_eq!(found, tried, "case {case}");
        tried.len()
    }

    /// Checks that queries between two steps find every shape at its pose.
    fn check_bounds(world: &World, case: usize) {
        for (index, body) in world.bodies.iter() {
            for shape in (0..body.shapes.len()).filter(|&i| body.shapes[i].shape != Shape::HalfSpace) {
                let bounds = body.shapes[shape].shape.aabb(&body.world_from_shape(shape));
                let own = Owner { body: index, shape: shape as u32 };
                let found = world.broad.proxies.overlapping(&bounds, |owner| {
                    if owner == own { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
                });
                assert!(found.is_break(), "case {case}: shape {own:?} is outside its bounds");
            }
        }
    }

    #[test]
    fn near_pairs_equal_those_of_a_brute_force_search() {
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
                    (0..1 + random.index(8)).for_each(|_| world.step());
                    check_bounds(&world, case);
                }
                if random.unit() < 0.1 {
                    let mut w = Writer::new();
                    world.save(&mut w);
                    saved.push(w.into_bytes());
                }
                if random.unit() < 0.1 && !saved.is_empty() {
                    let bytes = &saved[random.index(saved.len())];
                    world.load(&mut Reader::new(bytes)).expect("a saved world loads");
                }
                found += check(&mut world, case);
                case += 1;
            }
        }
        assert!(found > case, "only {found} pairs in {case} cases");
    }

    /// Steps a heap of all kinds of shapes and returns the number of near pairs that were skipped.
    fn skipped(random: &mut Random, steps: usize) -> usize {
        let mut world = World::new(WorldDef::default());
        let far = [0.0, 30.0, 3e4][random.index(3)];
        let floor = BodyDef {
            kind: BodyKind::Static,
            position: Vec3::new(far, -1.0, 0.0),
            shapes: vec![ShapeDef::new(Shape::Box { half_extents: Vec3::new(9.0, 1.0, 9.0) })],
            ..BodyDef::default()
        };
        world.add_body(&floor);
        for _ in 0..30 {
            let points: Vec<Vec3> = (0..12).map(|_| random.in_cube() * 0.3).collect();
            let shape = match random.index(6) {
                0 => Shape::Hull(std::sync::Arc::new(crate::hull::Hull::new(&points).expect("a hull"))),
                1 => Shape::Cylinder { half_height: 0.2, radius: 0.15 },
                _ => some_shape(random, BodyKind::Dynamic).shape,
            };
            let mut body = BodyDef {
                position: Vec3::new(far, 2.0, 0.0) + random.in_cube() * 2.0,
                rotation: random.rotation(),
                angular_velocity: random.in_cube() * 9.0,
                shapes: vec![ShapeDef::new(shape)],
                ..BodyDef::default()
            };
            body.shapes[0].body_from_shape = Transform::new(random.in_cube() * 0.2, random.rotation());
            world.add_body(&body);
        }
        let mut count = 0;
        for _ in 0..steps {
            if random.unit() < 0.02 {
                change(&mut world, random, 2.0);
            }
            check(&mut world, 0);
            let PairFilter { parted, version, .. } = world.parted.filter(&world.joints);
            let parted = parted.to_vec();
            let filter = PairFilter { parted: &parted, function: None, version };
            let World { bodies, broad, contacts, def, .. } = &world;
            let seams = Seams { bodies, proxies: &broad.proxies, filter };
            for (place, pair) in broad.near.list.iter().enumerate() {
                let asked = broad.asked.binary_search_by_key(&place, |asked| asked.pair).is_ok();
                let known = contacts.iter().any(|contact| contact.key.is_of_pair(pair.key));
                if pair.meets && !asked && !known {
                    let (a, b) = (bodies.at(pair.key.a), bodies.at(pair.key.b));
                    let mut asked = Asked::new(place, pair);
                    let ahead = crate::contact::proxies::Ahead { most: f32::INFINITY, blow: 0.0 };
                    crate::step::collide::ask((a, b, &seams), &mut asked, ahead, def.dt());
                    let found = asked.manifold;
                    assert_eq!(
                        found.count, 0,
                        "pair {:?} with {} left has points: {found:?}",
                        pair.key, pair.left
                    );
                    count += 1;
                }
            }
            world.step();
        }
        count
    }

    #[test]
    fn skipped_pairs_have_no_contact_points() {
        let mut random = Random::new(12);
        let worlds = cases(600);
        let count: usize = (0..worlds).map(|_| skipped(&mut random, 250)).sum();
        assert!(count > 3_000 * worlds, "only {count} pairs in {worlds} worlds");
    }
}
