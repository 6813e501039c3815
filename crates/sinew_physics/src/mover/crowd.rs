//! Movers in order along an axis, so that each looks at those near it alone.

use super::Mover;
use crate::arena::Arena;
use crate::boxes::Aabb;
use sinew_math::{Vec3, abs3, max, max3, min3};

/// All movers, by where their centres were when the stage began, along the axis on which they lie farthest apart.
#[derive(Default)]
pub(super) struct Crowd {
    axis: usize,
    order: Vec<(f32, u32)>,
    /// Largest half extent of a mover along the axis, metres.
    widest: f32,
    /// Most that one has moved along the axis since, metres.
    drift: f32,
}

impl Crowd {
    /// Puts them in order.
    pub fn sort(&mut self, movers: &Arena<Mover>) {
        let (mut lo, mut hi, mut widest) = (Vec3::INFINITY, Vec3::NEG_INFINITY, Vec3::ZERO);
        for (_, mover) in movers.iter() {
            let center = mover.center();
            (lo, hi) = (min3(lo, center), max3(hi, center));
            widest = max3(widest, mover.half_extents());
        }
        let spread = hi - lo;
        self.axis = (1..3).fold(0, |most, axis| if spread[axis] > spread[most] { axis } else { most });
        (self.widest, self.drift) = (widest[self.axis], 0.0);
        self.order.clear();
        self.order.extend(movers.iter().map(|(index, mover)| (mover.center()[self.axis], index)));
        self.order.sort_unstable_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)));
    }

    /// One of them has moved in this stage.
    pub fn note(&mut self, from: Vec3, to: Vec3) {
        self.drift = max(self.drift, (to[self.axis] - from[self.axis]).abs());
    }

    /// Those that may reach into a region, and others.
    pub fn near(&self, region: &Aabb) -> impl Iterator<Item = u32> {
        let room = self.widest + self.drift;
        let (lo, hi) = (region.min[self.axis] - room, region.max[self.axis] + room);
        let first = self.order.partition_point(|&(at, _)| at < lo);
        self.order[first..].iter().take_while(move |&&(at, _)| at <= hi).map(|&(_, index)| index)
    }
}

impl Mover {
    /// Half of its bounds, metres.
    pub(super) fn half_extents(&self) -> Vec3 {
        abs3(self.def.up * self.half_height()) + Vec3::splat(self.def.radius)
    }
}
