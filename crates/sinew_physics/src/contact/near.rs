//! Pairs of shapes whose bounds in the trees overlap: candidates that persist from step to step. Pairs of a shape are
//! searched again only after the shape has left its bounds or was changed. Every step tests which candidates are near.
//!
//! The list is not part of the state. The bounds depend on history, but near pairs are always among the candidates, and
//! other pairs have no contact.

use crate::arena::Arena;
use crate::body::Body;
use crate::boxes::AxisOf;
use crate::collide::SeparationCache;
use crate::contact::filter::PairFilter;
use crate::contact::proxies::{Closing, Leaf, Owner, Proxies};
use crate::contact::tuning::GAP_ERROR;
use crate::contact::tuning::MARGIN;
use crate::contact::{Contact, ContactKey};
use sinew_math::max;

/// Two shapes that may come near each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NearPair {
    pub key: ContactKey,
    /// Tree leaves of the shapes' bounds, in the order of the key.
    pub leaves: [Leaf; 2],
    /// Guaranteed remaining gap, metres: the last computed gap of the shapes or of their bounds, minus their largest
    /// relative motion since. Valid only while the shapes have no contact.
    pub left: f32,
    /// Axis that separated the shapes when the gap was computed.
    axis: PackedAxis,
    /// True if the filters let the shapes collide.
    pub meets: bool,
    /// True if one of the shapes is a mesh or a height field.
    pub has_surface: bool,
}

impl NearPair {
    /// Creates a pair that is [not filtered](Self::met) yet.
    fn new(key: ContactKey, leaves: [Leaf; 2]) -> Self {
        let axis = PackedAxis::default();
        Self { key, leaves, left: f32::NEG_INFINITY, axis, meets: false, has_surface: false }
    }

    /// Copies the pair with the filter result of its shapes.
    fn met(&self, bodies: &Arena<Body>, filter: PairFilter<'_>) -> Self {
        let key = self.key;
        let is_surface =
            |body: u32, shape: u32| bodies.at(body).shapes[shape as usize].shape.surface().is_some();
        let has_surface = is_surface(key.a, key.shape_a) || is_surface(key.b, key.shape_b);
        Self { meets: filter.lets_meet(bodies, key), has_surface, ..*self }
    }

    pub fn parting(&self) -> SeparationCache {
        SeparationCache { axis: self.axis.unpack(), gap: f32::NEG_INFINITY }
    }

    /// Updates the gap by the shapes' motion; true if they must be searched for points.
    pub fn comes_near(&mut self, closing: &Closing) -> bool {
        self.left -= closing.moved;
        let is_far = self.left > max(MARGIN, closing.ahead);
        !is_far
    }

    /// Stores the gap between the shapes' bounds, metres, if it shows that a search would find no points; returns true
    /// in that case.
    pub fn is_apart(&mut self, closing: &Closing, gap: f32) -> bool {
        let is_far = !self.has_surface && gap - GAP_ERROR > max(MARGIN, closing.ahead);
        if is_far {
            self.left = gap - GAP_ERROR;
        }
        is_far
    }

    /// Records that the shapes were tested and have no points.
    pub fn part(&mut self, parting: &SeparationCache) {
        self.left = parting.gap - GAP_ERROR;
        self.axis = PackedAxis::new(parting.axis);
    }
}

/// An axis in four bytes: its kind in the lowest two bits, then twice fifteen bits.
#[derive(Clone, Copy, Debug, Default)]
struct PackedAxis(u32);

impl PackedAxis {
    const MOST: usize = (1 << 15) - 1;

    fn new(axis: Option<AxisOf>) -> Self {
        let (kind, i, j) = match axis {
            None => (0, 0, 0),
            Some(AxisOf::FaceA(i)) => (1, i, 0),
            Some(AxisOf::FaceB(i)) => (2, i, 0),
            Some(AxisOf::Edges(i, j)) => (3, i, j),
        };
        if i > Self::MOST || j > Self::MOST { Self(0) } else { Self(kind | (i << 2 | j << 17) as u32) }
    }

    fn unpack(self) -> Option<AxisOf> {
        let (i, j) = (self.0 as usize >> 2 & Self::MOST, self.0 as usize >> 17);
        match self.0 & 3 {
            1 => Some(AxisOf::FaceA(i)),
            2 => Some(AxisOf::FaceB(i)),
            3 => Some(AxisOf::Edges(i, j)),
            _ => None,
        }
    }
}

/// All near pairs, sorted by key.
#[derive(Clone, Debug, Default)]
pub(crate) struct NearPairs {
    pub list: Vec<NearPair>,
    fresh: Vec<NearPair>,
    next: Vec<NearPair>,
    /// Number of pairs found for enlarged bounds, plus one per search, since separated pairs were last removed.
    enlarged: usize,
    /// Version of the filter last applied.
    filter_version: u64,
}

impl NearPairs {
    /// Updates the list after [`Proxies::update_motion`].
    pub fn update(&mut self, proxies: &mut Proxies, bodies: &Arena<Body>, filter: PairFilter<'_>) {
        if proxies.has_pending() {
            self.fresh.clear();
            let fresh = &mut self.fresh;
            proxies.search(bodies, |(p, leaf_p), (q, leaf_q)| {
                let key = key(p, q);
                let leaves = if key.a == p.body { [leaf_p, leaf_q] } else { [leaf_q, leaf_p] };
                fresh.push(NearPair::new(key, leaves));
            });
            self.fresh.sort_unstable_by_key(|pair| pair.key);
            self.fresh.dedup_by_key(|pair| pair.key);
            if proxies.only_enlarged() && self.enlarged + self.fresh.len() <= self.list.len() / 8 {
                self.add(bodies, filter);
            } else {
                self.merge(proxies, bodies, filter);
            }
            proxies.clear_pending();
        }
        // A user function is called in every step; `meets` stores its last result.
        let asks = core::mem::replace(&mut self.filter_version, filter.version) != filter.version
            || filter.function.is_some();
        if asks {
            for pair in &mut self.list {
                pair.meets = filter.lets_meet(bodies, pair.key);
            }
        }
    }

    /// Adds new pairs. Old pairs remain, although their bounds may no longer overlap.
    fn add(&mut self, bodies: &Arena<Body>, filter: PairFilter<'_>) {
        self.enlarged += self.fresh.len() + 1;
        let list = &mut self.list;
        self.fresh.retain(|pair| list.binary_search_by_key(&pair.key, |old| old.key).is_err());
        for pair in &mut self.fresh {
            *pair = pair.met(bodies, filter);
        }
        insert_sorted(list, &mut self.fresh, |pair| pair.key);
    }

    /// Removes pairs of pending shapes unless the search found them again; those keep their data.
    fn merge(&mut self, proxies: &Proxies, bodies: &Arena<Body>, filter: PairFilter<'_>) {
        let prunes = self.enlarged > 0;
        let only_enlarged = proxies.only_enlarged();
        self.enlarged = 0;
        self.next.clear();
        let mut fresh = self.fresh.iter().peekable();
        for old in &self.list {
            while let Some(pair) = fresh.next_if(|pair| pair.key < old.key) {
                self.next.push(pair.met(bodies, filter));
            }
            if let Some(pair) = fresh.next_if(|pair| pair.key == old.key) {
                let known = NearPair { left: old.left, axis: old.axis, ..*pair };
                self.next.push(if only_enlarged { *old } else { known.met(bodies, filter) });
            } else if !(old.leaves.iter().any(|&leaf| proxies.is_pending(leaf))
                || prunes && proxies.are_parted(old.leaves))
            {
                self.next.push(*old);
            }
        }
        self.next.extend(fresh.map(|pair| pair.met(bodies, filter)));
        core::mem::swap(&mut self.list, &mut self.next);
    }
}

/// Inserts `new` items in order; both lists are sorted by key.
pub(crate) fn insert_sorted<T: Copy, K: Ord>(list: &mut Vec<T>, new: &mut Vec<T>, key: impl Fn(&T) -> K) {
    let mut left = list.len();
    list.extend_from_slice(new);
    let mut end = list.len();
    // Merges from the back, where there is space.
    while let Some(item) = new.pop() {
        let place = list[..left].partition_point(|other| key(other) < key(&item));
        let moved = left - place;
        list.copy_within(place..left, end - moved);
        (left, end) = (place, end - moved - 1);
        list[end] = item;
    }
}

fn key(p: Owner, q: Owner) -> ContactKey {
    ContactKey::new((p.body, p.shape), (q.body, q.shape))
}

/// Inserts new contacts in order; both lists are sorted by key.
pub(crate) fn bear(contacts: &mut Vec<Contact>, born: &mut Vec<Contact>) {
    insert_sorted(contacts, born, |contact| contact.key);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_axis_unpacks_to_the_same_axis() {
        let most = PackedAxis::MOST;
        let axes = [
            None,
            Some(AxisOf::FaceA(0)),
            Some(AxisOf::FaceA(most)),
            Some(AxisOf::FaceB(5)),
            Some(AxisOf::Edges(0, 0)),
            Some(AxisOf::Edges(7, most)),
            Some(AxisOf::Edges(most, 3)),
        ];
        for axis in axes {
            assert_eq!(PackedAxis::new(axis).unpack(), axis);
        }
        assert_eq!(PackedAxis::new(Some(AxisOf::Edges(most + 1, 0))).unpack(), None);
    }
}
