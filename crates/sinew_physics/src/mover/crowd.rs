//! Movers sorted along an axis, so that each tests only nearby ones.

use crate::boxes::Aabb;
use sinew_math::{Vec3, max, max3, min3};

/// All movers, sorted by their centres at the start of the stage, along the axis of their largest extent.
#[derive(Default)]
pub(super) struct Crowd {
    axis: usize,
    order: Vec<(f32, u32)>,
    /// Largest half extent of a mover along the axis, metres.
    widest: f32,
    /// Largest motion of a mover along the axis since the sort, metres.
    drift: f32,
}

impl Crowd {
    /// Sorts the movers that the iterator gives as index, centre and half extents, metres.
    pub fn sort<M: Iterator<Item = (u32, Vec3, Vec3)>>(&mut self, movers: impl Fn() -> M) {
        let (mut lo, mut hi, mut widest) = (Vec3::INFINITY, Vec3::NEG_INFINITY, Vec3::ZERO);
        for (_, center, half) in movers() {
            (lo, hi, widest) = (min3(lo, center), max3(hi, center), max3(widest, half));
        }
        let spread = hi - lo;
        self.axis = (1..3).fold(0, |most, axis| if spread[axis] > spread[most] { axis } else { most });
        (self.widest, self.drift) = (widest[self.axis], 0.0);
        self.order.clear();
        self.order.extend(movers().map(|(index, center, _)| (center[self.axis], index)));
        self.order.sort_unstable_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)));
    }

    /// Records the motion of one mover in this stage.
    pub fn note(&mut self, from: Vec3, to: Vec3) {
        self.drift = max(self.drift, (to[self.axis] - from[self.axis]).abs());
    }

    /// Returns all movers that overlap a region and some that do not, in their order along the axis.
    pub fn near(&self, region: &Aabb) -> impl Iterator<Item = u32> {
        let room = self.widest + self.drift;
        let (lo, hi) = (region.min[self.axis] - room, region.max[self.axis] + room);
        let first = self.order.partition_point(|&(at, _)| at < lo);
        self.order[first..].iter().take_while(move |&&(at, _)| at <= hi).map(|&(_, index)| index)
    }
}
