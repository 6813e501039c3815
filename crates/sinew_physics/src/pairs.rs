//! `pairs`: which shapes may meet. Sweep and prune along x over the bounds of all shapes.

use crate::arena::Arena;
use crate::body::Body;
use crate::boxes::{Aabb, Overlap};
use crate::contact::{Contact, ContactKey};
use crate::def::BodyKind;
use crate::filter::PairFilter;
use sinew_math::Vec3;

/// Bounds of one shape, grown by how far it may move within the step.
#[derive(Clone, Copy, Debug)]
struct Proxy {
    bounds: Aabb,
    body: u32,
    shape: u32,
    can_touch: bool,
}

/// Sorted bounds; kept between steps because their order hardly changes.
#[derive(Clone, Debug, Default)]
pub(crate) struct BroadPhase {
    proxies: Vec<Proxy>,
    stale: bool,
    open: Vec<u32>,
    keys: Vec<ContactKey>,
    next: Vec<Contact>,
}

/// Distance within which contacts are looked for, beside the motion of the step, metres.
const MARGIN: f32 = 0.02;

impl BroadPhase {
    /// Bodies or shapes came or went: collect the proxies anew.
    pub fn invalidate(&mut self) {
        self.stale = true;
    }

    /// Brings `contacts` up to date: sorted by key, one for each pair that may meet.
    pub fn update(
        &mut self,
        bodies: &Arena<Body>,
        filter: PairFilter<'_>,
        contacts: &mut Vec<Contact>,
        dt: f32,
    ) {
        self.refresh(bodies, dt);
        self.sweep(bodies, filter);
        self.keys.sort_unstable();
        self.merge(bodies, contacts);
    }

    fn refresh(&mut self, bodies: &Arena<Body>, dt: f32) {
        if self.stale {
            self.proxies.clear();
            for (body, b) in bodies.iter() {
                for shape in 0..b.shapes.len() as u32 {
                    let bounds = Aabb { min: Vec3::ZERO, max: Vec3::ZERO };
                    self.proxies.push(Proxy { bounds, body, shape, can_touch: false });
                }
            }
        }
        for proxy in &mut self.proxies {
            let body = bodies.at(proxy.body);
            proxy.can_touch = body.can_touch();
            if proxy.can_touch || self.stale || body.kind != BodyKind::Static {
                let frame = body.world_from_shape(proxy.shape as usize);
                let bounds = body.shapes[proxy.shape as usize].shape.aabb(&frame);
                let motion =
                    (body.velocity.linear.length() + body.velocity.angular.length() * body.reach()) * dt;
                proxy.bounds = bounds.expand(MARGIN + motion);
            }
        }
        self.stale = false;
        self.sort();
    }

    /// By lower x, then by body and shape: insertion sort, since the order is nearly right already.
    fn sort(&mut self) {
        let before = |p: &Proxy, q: &Proxy| {
            (p.bounds.min.x, p.body, p.shape).partial_cmp(&(q.bounds.min.x, q.body, q.shape))
                == Some(core::cmp::Ordering::Less)
        };
        for i in 1..self.proxies.len() {
            let mut j = i;
            while j > 0 && before(&self.proxies[j], &self.proxies[j - 1]) {
                self.proxies.swap(j, j - 1);
                j -= 1;
            }
        }
    }

    fn sweep(&mut self, bodies: &Arena<Body>, filter: PairFilter<'_>) {
        self.keys.clear();
        self.open.clear();
        for (i, proxy) in self.proxies.iter().enumerate() {
            let proxies = &self.proxies;
            self.open.retain(|&j| proxies[j as usize].bounds.max.x >= proxy.bounds.min.x);
            for &j in &self.open {
                let other = &proxies[j as usize];
                if (proxy.can_touch || other.can_touch)
                    && proxy.bounds.overlaps(&other.bounds)
                    && filter.lets_meet(bodies, key(proxy, other))
                {
                    self.keys.push(key(proxy, other));
                }
            }
            self.open.push(i as u32);
        }
    }

    /// Merges the sorted keys with the sorted contacts: old ones keep their memory; contacts of sleepers stay.
    fn merge(&mut self, bodies: &Arena<Body>, contacts: &mut Vec<Contact>) {
        self.next.clear();
        let mut old = contacts.iter().copied().peekable();
        for &key in &self.keys {
            while let Some(contact) = old.next_if(|contact| contact.key < key) {
                self.next.extend(stays(bodies, &contact).then_some(contact));
            }
            let known = old.next_if(|contact| contact.key == key);
            self.next.push(known.unwrap_or_else(|| Contact::new(key)));
        }
        self.next.extend(old.filter(|contact| stays(bodies, contact)));
        core::mem::swap(contacts, &mut self.next);
    }
}

/// A contact that was not found again stays only if nothing about it can have changed.
fn stays(bodies: &Arena<Body>, contact: &Contact) -> bool {
    [contact.key.a, contact.key.b].into_iter().all(|index| {
        let body = bodies.at(index);
        !body.can_touch() && !body.quarantined
    })
}

fn key(p: &Proxy, q: &Proxy) -> ContactKey {
    ContactKey::new((p.body, p.shape), (q.body, q.shape))
}
