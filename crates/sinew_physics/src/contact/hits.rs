//! Hits: fast contacts, with the impulse that stopped them.

use crate::arena::Arena;
use crate::body::Body;
use crate::body::def::BodyKind;
use crate::body::material::Material;
use crate::contact::tracking::{load_shape_id, save_shape_id, shape_ids};
use crate::contact::tuning::STILL_COMING;
use crate::contact::{Contact, ContactKey, Effect};
use crate::id::ShapeId;
use sinew_math::{ReadError, Reader, Vec3, Writer, max, normalize_or};

/// Two shapes that hit each other; A is the one with the smaller body index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Shape with the smaller body index.
    pub a: ShapeId,
    /// Shape with the larger body index.
    pub b: ShapeId,
    /// Point of the hit, world, metres: the impulse-weighted mean of the contact points; on the surface of the body
    /// that is not dynamic, if there is one.
    pub point: Vec3,
    /// Normal from A to B, unit length, world axes.
    pub normal: Vec3,
    /// Approach speed along the normal, m/s, at the first contact, at the start of the step.
    pub approach: f32,
    /// Normal impulse, N·s: the sum over all contact points.
    pub impulse: f32,
    /// Largest normal impulse at one contact point, N·s.
    pub greatest: f32,
    /// Materials of A and B.
    pub materials: [Material; 2],
}

/// A hit in progress at the end of the step: the next step reports it with its whole impulse.
#[derive(Clone, Copy, Debug, PartialEq)]
struct OpenHit {
    a: ShapeId,
    b: ShapeId,
    point: Vec3,
    normal: Vec3,
    approach: f32,
    impulse: f32,
    greatest: f32,
}

/// Hits in progress, in the order of pairs. Part of the snapshot.
#[derive(Clone, Debug, Default)]
pub(crate) struct OpenHits {
    list: Vec<OpenHit>,
    next: Vec<OpenHit>,
    /// Pairs that approached faster than `threshold` in this step. Not part of the snapshot, because a step clears the
    /// list.
    fast: Vec<ContactKey>,
    threshold: f32,
}

impl OpenHit {
    fn key(&self) -> ContactKey {
        ContactKey::new((self.a.body.index, self.a.shape), (self.b.body.index, self.b.shape))
    }
}

impl OpenHits {
    /// Starts a step with `contacts` contacts; the step reports hits faster than `threshold` (m/s).
    pub fn start(&mut self, contacts: usize, threshold: f32) {
        self.threshold = threshold;
        self.fast.clear();
        self.fast.reserve(contacts + self.list.len());
    }

    /// Records a pair as a hit if it approaches fast enough.
    pub fn note(&mut self, pair: &[Contact]) {
        if pair.iter().any(|contact| contact.approach >= self.threshold) {
            self.fast.push(ContactKey { part: 0, ..pair[0].key });
        }
    }

    /// Reports the hits of this step: of [recorded](Self::note) pairs and of hits in progress.
    pub fn report(&mut self, bodies: &Arena<Body>, contacts: &[Contact], hits: &mut Vec<Hit>) {
        hits.clear();
        self.next.clear();
        self.fast.extend(self.list.iter().map(OpenHit::key));
        self.fast.sort_unstable();
        self.fast.dedup();
        hits.reserve(contacts.len());
        self.next.reserve(contacts.len());
        for key in self.fast.drain(..) {
            let rest = &contacts[contacts.partition_point(|contact| contact.key < key)..];
            let count = rest.iter().take_while(|contact| contact.key.is_of_pair(key)).count();
            let pair = &rest[..count];
            if pair.first().is_none_or(|contact| contact.effect != Effect::Push) {
                continue;
            }
            let (a, b) = shape_ids(bodies, key);
            let begun = self.list.binary_search_by_key(&key, OpenHit::key).ok().map(|at| &self.list[at]);
            let begun = begun.filter(|hit| (hit.a, hit.b) == (a, b));
            let hit = hit_of(bodies, pair, (a, b), begun);
            if hit.impulse <= 0.0 {
                continue;
            }
            if begun.is_none() && closing_speed(bodies, pair) > STILL_COMING * hit.approach {
                let Hit { point, normal, approach, impulse, greatest, .. } = hit;
                self.next.push(OpenHit { a, b, point, normal, approach, impulse, greatest });
            } else {
                hits.push(hit);
            }
        }
        core::mem::swap(&mut self.list, &mut self.next);
    }

    pub fn save(&self, w: &mut Writer) {
        w.count(self.list.len());
        for hit in &self.list {
            save_shape_id(w, hit.a);
            save_shape_id(w, hit.b);
            w.vec3(hit.point);
            w.vec3(hit.normal);
            for x in [hit.approach, hit.impulse, hit.greatest] {
                w.f32(x);
            }
        }
    }

    pub fn load(r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let mut list = Vec::new();
        for _ in 0..r.count(60)? {
            let (a, b) = (load_shape_id(r)?, load_shape_id(r)?);
            let (point, normal) = (r.vec3()?, r.vec3()?);
            let (approach, impulse, greatest) = (r.f32()?, r.f32()?, r.f32()?);
            list.push(OpenHit { a, b, point, normal, approach, impulse, greatest });
        }
        Ok(Self { list, ..Self::default() })
    }
}

/// Combines all contacts of a pair into one hit, including the previous step's share.
fn hit_of(
    bodies: &Arena<Body>,
    pair: &[Contact],
    (a, b): (ShapeId, ShapeId),
    begun: Option<&OpenHit>,
) -> Hit {
    let (mut approach, mut impulse, mut greatest) = (0.0, 0.0, 0.0);
    let (mut point, mut normal) = (Vec3::ZERO, Vec3::ZERO);
    if let Some(begun) = begun {
        (approach, impulse, greatest) = (begun.approach, begun.impulse, begun.greatest);
        (point, normal) = (begun.point * impulse, begun.normal * impulse);
    }
    for contact in pair {
        approach = max(approach, contact.approach);
        // The points are half way between the surfaces. Between a dynamic and another body, the hit is on the other's
        // surface.
        let on = match [a, b].map(|id| bodies.at(id.body.index).kind == BodyKind::Dynamic) {
            [true, false] => 0.5,
            [false, true] => -0.5,
            _ => 0.0,
        };
        for (place, given) in contact.manifold.points().iter().zip(&contact.memory.points) {
            let (place, given) =
                (place.position + contact.manifold.normal * (on * place.separation), given.total);
            impulse += given;
            greatest = max(greatest, given);
            point += place * given;
            normal += contact.manifold.normal * given;
        }
    }
    let material = |id: ShapeId| bodies.at(id.body.index).surface(id.shape as usize).material;
    Hit {
        a,
        b,
        point: point / max(impulse, f32::MIN_POSITIVE),
        normal: normalize_or(normal, pair[0].manifold.normal),
        approach,
        impulse,
        greatest,
        materials: [material(a), material(b)],
    }
}

/// Largest approach speed of the points with an impulse at the end of the step, m/s.
fn closing_speed(bodies: &Arena<Body>, pair: &[Contact]) -> f32 {
    let mut fastest = 0.0;
    for contact in pair {
        let (a, b) = (bodies.at(contact.key.a), bodies.at(contact.key.b));
        for (place, _) in contact.impulses().filter(|&(_, given)| given > 0.0) {
            let relative = b.velocity.at(place - b.center()) - a.velocity.at(place - a.center());
            fastest = max(fastest, -relative.dot(contact.manifold.normal));
        }
    }
    fastest
}
