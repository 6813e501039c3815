//! The exact solve of eight trees: leaves to roots, then roots to leaves.

use super::Batch;
use super::node::{Kind, Node, Side, View};
use crate::joint::TWIST;
use crate::solver::articulation::elimination::{Matrix, Symmetric, Twist, times, transposed_times, zero};
use crate::solver::flight::{Eight, ZERO};
use crate::spatial::Vec6;
use sinew_math::dispatch::Kernel;
use sinew_math::lanes::{Lanes, Vector3, WIDTH};

/// Intermediate results of a solve for one link.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct Way {
    /// Impulse accumulated from the links below; on the way down, the velocity change of the link.
    pub twist: [Eight; 6],
    /// Remaining torque on the child of a ball joint (for a root also the force), or the impulse along each open axis.
    along: [Eight; 6],
    /// Requested velocity of the child at the anchor, relative to the parent's motion.
    asked: [Eight; 6],
}

impl Way {
    pub const NONE: Self = Self { twist: [ZERO; 6], along: [ZERO; 6], asked: [ZERO; 6] };
}

#[inline(always)]
fn load6<L: Lanes>([x, y, z, u, v, w]: &[Eight; 6]) -> Twist<L> {
    [Vector3::load(x, y, z), Vector3::load(u, v, w)]
}

#[inline(always)]
fn store6<L: Lanes>([v, w]: Twist<L>, to: &mut [Eight; 6]) {
    for (number, row) in [v.x, v.y, v.z, w.x, w.y, w.z].into_iter().zip(to) {
        number.store(row);
    }
}

#[inline(always)]
fn symmetric<L: Lanes>(view: impl View<L>, [a, b, c, d, e, f]: &[Eight; 6]) -> Symmetric<L> {
    Symmetric([
        view.number(a),
        view.number(b),
        view.number(c),
        view.number(d),
        view.number(e),
        view.number(f),
    ])
}

#[inline(always)]
fn rows<L: Lanes>(view: impl View<L>, [x, y, z]: &[[Eight; 3]; 3]) -> Matrix<L> {
    [view.vector(x), view.vector(y), view.vector(z)]
}

impl Node {
    /// Converts an impulse on the child at its centre and the requested velocity at the anchor to the impulse on the parent at the parent's
    /// centre.
    #[inline(always)]
    fn ascend<L: Lanes>(
        &self,
        view: impl View<L>,
        [force, torque]: Twist<L>,
        asked: Option<Twist<L>>,
        way: &mut Way,
    ) -> Twist<L> {
        if self.site.kind == Kind::Root {
            store6([torque, force - times(&rows(view, &self.coupled), torque)], &mut way.along);
            return [zero(), zero()];
        }
        let torque = torque - view.vector(&self.arm).cross(force);
        let mut through = [force, torque];
        match self.site.kind {
            Kind::Axes { held } => {
                for (axis, along) in self.axes[held..].iter().zip(&mut way.along) {
                    let by = view.vector(&axis.way).dot(through[1]) * view.number(&axis.inverse);
                    through[0] = through[0] - view.vector(&axis.force) * by;
                    through[1] = through[1] - view.vector(&axis.torque) * by;
                    by.store(along);
                }
            }
            kind => {
                for (number, row) in torque.to_array().into_iter().zip(&mut way.along) {
                    number.store(row);
                }
                let resisted = if kind == Kind::DrivenPoint {
                    symmetric(view, &self.gain).times(symmetric(view, &self.pivot).times(torque))
                } else {
                    zero()
                };
                through = [force - times(&rows(view, &self.coupled), torque), resisted];
            }
        }
        if let Some([v, w]) = asked {
            store6([v, w], &mut way.asked);
            // Impulse that resists the parent motion corresponding to the requested velocity of the anchor.
            let mass = symmetric(view, &self.passed_mass);
            through[0] = through[0] - mass.times(v);
            if self.site.kind != Kind::Point {
                let coupling = rows(view, &self.passed_coupling);
                through[0] = through[0] - times(&coupling, w);
                through[1] = through[1] - transposed_times(&coupling, v);
                through[1] = through[1] - symmetric(view, &self.passed_rotation).times(w);
            }
        }
        let [force, torque] = through;
        [force, torque + view.vector(&self.parent_arm).cross(force)]
    }

    /// Computes the velocity of the child at its centre from the velocity of the parent at the parent's centre. If no impulse acted below
    /// the joint, only the parent's velocity contributes.
    #[inline(always)]
    fn descend<L: Lanes>(&self, view: impl View<L>, [v, w]: Twist<L>, way: &Way, noted: Noted) -> Twist<L> {
        let is_pushed = noted != Noted::Nothing;
        let along = || if is_pushed { load6(&way.along) } else { [zero(), zero()] };
        if self.site.kind == Kind::Root {
            let [torque, force] = along();
            let v = symmetric(view, &self.passed_mass).times(force);
            let w = symmetric(view, &self.pivot).times(torque);
            return [v, w - transposed_times(&rows(view, &self.coupled), v)];
        }
        let (mut v, mut w) = (v + w.cross(view.vector(&self.parent_arm)), w);
        if noted == Noted::PushesAndAsked {
            let [slide, turn] = load6(&way.asked);
            (v, w) = (v + slide, w + turn);
        }
        match self.site.kind {
            Kind::Axes { held } => {
                for (axis, along) in self.axes[held..].iter().zip(&way.along).rev() {
                    let resisted = view.vector(&axis.force).dot(v) + view.vector(&axis.torque).dot(w);
                    let resisted = -resisted * view.number(&axis.inverse);
                    let by = if is_pushed { L::load(along) + resisted } else { resisted };
                    w = w + view.vector(&axis.way) * by;
                }
            }
            kind => {
                let coupled = transposed_times(&rows(view, &self.coupled), v);
                let [mut torque, _] = along();
                if kind == Kind::DrivenPoint {
                    torque = torque + symmetric(view, &self.gain).times(w);
                }
                w = if is_pushed || kind == Kind::DrivenPoint {
                    symmetric(view, &self.pivot).times(torque) - coupled
                } else {
                    -coupled
                };
            }
        }
        [v + view.vector(&self.arm).cross(w), w]
    }

    /// Velocity of the child at the anchor that the residuals of the locked rows request. Open rows apply impulses instead and request no
    /// velocity.
    #[inline(always)]
    fn asked<L: Lanes>(&self, residuals: [L; WIDTH]) -> Twist<L> {
        let sign = L::load(&self.sign);
        let [x, y, z, ..] = residuals;
        let mut turned = zero();
        if let Kind::Axes { held } = self.site.kind {
            for (axis, residual) in self.axes[..held].iter().zip(&residuals[TWIST..]) {
                turned = turned + Side.vector(&axis.way) * *residual;
            }
        }
        [Vector3::new(x, y, z) * sign, turned * sign]
    }
}

impl Batch {
    /// Loads one record of each tree for link `i`, field by field.
    #[inline(always)]
    pub(super) fn load<L: Lanes>(&self, i: usize, from: &[Vec6]) -> [L; WIDTH] {
        let mut records = [L::splat(0.0); WIDTH];
        for (record, first) in records.iter_mut().zip(self.first) {
            *record = L::load(&from[first + i]);
        }
        L::transpose(records)
    }

    /// Writes one record of each tree for link `i`.
    #[inline(always)]
    pub(super) fn store<L: Lanes>(&self, i: usize, [v, w]: Twist<L>, to: &mut [Vec6]) {
        let none = L::splat(0.0);
        let records = L::transpose([v.x, v.y, v.z, w.x, w.y, w.z, none, none]);
        for (record, first) in records.into_iter().zip(self.first).take(self.lanes) {
            record.store(&mut to[first + i]);
        }
    }

    /// Velocities or impulses of link `i`.
    #[inline(always)]
    pub(super) fn twist<L: Lanes>(&self, i: usize, from: &[Vec6]) -> Twist<L> {
        let [x, y, z, u, v, w, ..] = self.load::<L>(i, from);
        [Vector3::new(x, y, z), Vector3::new(u, v, w)]
    }
}

/// Values that the ascent stored for a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Noted {
    Nothing,
    Pushes,
    PushesAndAsked,
}

/// Ascends through link `i`, on which an impulse acts in addition to the accumulated one.
#[inline(always)]
pub(super) fn up<L: Lanes>(
    ways: &mut [Way],
    (node, i): (&Node, usize),
    view: impl View<L>,
    [f, t]: Twist<L>,
    asked: Option<Twist<L>>,
) {
    let [force, torque] = load6(&ways[i].twist);
    let [f, t] = node.ascend(view, [force + f, torque + t], asked, &mut ways[i]);
    if let Some(parent) = ways.get_mut(node.site.parent as usize) {
        let [force, torque] = load6(&parent.twist);
        store6([force + f, torque + t], &mut parent.twist);
    }
}

/// Descends to link `i`. Returns its velocity change.
#[inline(always)]
pub(super) fn down<L: Lanes>(
    ways: &mut [Way],
    (node, i): (&Node, usize),
    view: impl View<L>,
    noted: Noted,
) -> Twist<L> {
    let parent = ways.get(node.site.parent as usize).map_or([zero(), zero()], |way| load6(&way.twist));
    let answer = node.descend(view, parent, &ways[i], noted);
    store6(answer, &mut ways[i].twist);
    answer
}

/// Clears the accumulated impulses.
#[inline(always)]
pub(super) fn begin(ways: &mut [Way]) {
    for way in ways {
        way.twist = [ZERO; 6];
    }
}

/// Computes the velocity change of every body of a batch from impulses on the bodies and residuals of the locked joint rows. An empty list
/// of residuals means zero residuals.
pub(super) struct SolveBatch<'a> {
    pub batch: &'a Batch,
    pub ways: &'a mut [Way],
    pub impulses: &'a [Vec6],
    pub residuals: &'a [Vec6],
    pub dv: &'a mut [Vec6],
}

impl Kernel for SolveBatch<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { batch, ways, impulses, residuals, dv } = self;
        let ways = &mut ways[..batch.nodes.len()];
        begin(ways);
        let noted = if residuals.is_empty() { Noted::Pushes } else { Noted::PushesAndAsked };
        for (i, node) in batch.nodes.iter().enumerate().rev() {
            let impulse = batch.twist::<L>(i, impulses);
            let asked = (noted == Noted::PushesAndAsked).then(|| node.asked(batch.load::<L>(i, residuals)));
            up(ways, (node, i), Side, impulse, asked);
        }
        for (i, node) in batch.nodes.iter().enumerate() {
            let answer = down::<L>(ways, (node, i), Side, noted);
            batch.store(i, answer, dv);
        }
    }
}
