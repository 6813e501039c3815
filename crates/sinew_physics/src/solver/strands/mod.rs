//! Strands: unbranched chains of plain ball joints without contacts, up to eight of one length side by side.
//!
//! The method is that of the islands ([`joints`](super::articulation::joints)): SHAKE and RATTLE over the exact factor of the chain, with
//! geometric stiffness. An unbranched chain of ball joints needs less bookkeeping: it has no rows, residuals only in three directions a
//! joint, and no external impulses, and the values passed from link to link stay in registers. If a strand reaches a state in which a
//! safeguard of the islands would act, the islands' solver repeats its whole step.

mod cuts;
mod factor;
mod joints;
mod link;
mod motion;
mod order;
mod pieces;
mod substep;

use super::boundary::solution::{SolvedBody, SolvedJoint};
use super::flight::Eight;
use crate::context::StepContext;
use crate::island::Island;
use crate::joint::Joint;
use crate::slices::for_each_mut;
use crate::solver::sweep::choice::stretch_of;
use crate::solver::tuning::CUT_STRANDS;
use crate::solver::view::View;
use crate::stage::Counter;
use core::ops::Range;
use cuts::Cuts;
use link::{Hook, Link};
use order::Order;
use sinew_math::Vec3;
use sinew_math::dispatch;
use sinew_math::lanes::WIDTH;
use substep::{Advance, Alone, Pace};

/// Number of most recent bundles searched for a free lane. If all lengths differ, a longer search costs more than half-empty bundles.
const OPEN: usize = 32;

/// All strands of a step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Strands {
    /// Bundles in use, followed by unused bundles whose memory is kept.
    bundles: Vec<Bundle>,
    used: usize,
    order: Order,
}

/// Up to eight strands of one length, each held by a fixed body or all free.
#[derive(Clone, Debug)]
struct Bundle {
    /// Indices of the islands, lane by lane.
    islands: Vec<u32>,
    /// Links, from the held end on.
    links: Vec<Link>,
    is_held: bool,
    hook: Hook,
    /// True if the lanes are the pieces of one strand.
    is_cut: bool,
    /// Joints between the pieces.
    cuts: Box<Cuts>,
    /// 1 in the lanes whose last place is filled, 0 in the others.
    full: Eight,
    /// Length of the bundle's substeps relative to the world's.
    stretch: f32,
    /// Number of used lanes when the unused lanes were last filled.
    filled: usize,
    /// Bit set of the lanes whose step the islands' solver has to repeat.
    left: u8,
}

/// A strand after its step.
pub(crate) struct SolvedStrand<'a> {
    bundle: &'a Bundle,
    /// Lane of the strand, or the lanes of its pieces.
    lanes: Range<usize>,
    /// Index of the strand's island.
    pub island: usize,
}

impl Strands {
    /// Removes all strands.
    pub fn clear(&mut self) {
        self.used = 0;
    }

    /// Adds an island if it is a strand.
    pub fn add(&mut self, number: usize, island: &Island<'_>, view: &View<'_>) {
        if !self.order.find(island, view) {
            return;
        }
        let (count, is_held, stretch) =
            (self.order.links.len(), self.order.is_held(), stretch_of(island, view));
        if count >= CUT_STRANDS {
            self.add_pieces(number, stretch, view);
            return;
        }
        let fits = |bundle: &Bundle| {
            let has_room = bundle.islands.len() < WIDTH;
            !bundle.is_cut
                && has_room
                && bundle.links.len() == count
                && bundle.is_held == is_held
                && bundle.stretch == stretch
        };
        let first = self.used.saturating_sub(OPEN);
        let place = self.bundles[first..self.used].iter().rposition(fits);
        let place = place.map_or_else(|| self.open(count), |place| first + place);
        let bundle = &mut self.bundles[place];
        (bundle.is_held, bundle.stretch) = (is_held, stretch);
        let lane = bundle.islands.len();
        bundle.islands.push(number as u32);
        if let Some(first) = self.order.links.first().filter(|_| is_held) {
            bundle.hook.write(lane, first, view);
        }
        for (link, placed) in bundle.links.iter_mut().zip(&self.order.links) {
            link.write(lane, placed, view);
        }
    }

    /// Adds the strand found last as eight pieces.
    fn add_pieces(&mut self, number: usize, stretch: f32, view: &View<'_>) {
        let (count, is_held) = (self.order.links.len(), self.order.is_held());
        let (least, longer) = (count / WIDTH, count % WIDTH);
        let place = self.open(count.div_ceil(WIDTH));
        let bundle = &mut self.bundles[place];
        (bundle.is_held, bundle.stretch, bundle.filled) = (is_held, stretch, 0);
        bundle.is_cut = true;
        bundle.islands.push(number as u32);
        if let Some(first) = self.order.links.first().filter(|_| is_held) {
            bundle.hook.write(0, first, view);
        }
        let mut rest = &self.order.links[..];
        for lane in 0..WIDTH {
            let piece;
            (piece, rest) = rest.split_at(least + usize::from(lane < longer));
            for (link, placed) in bundle.links.iter_mut().zip(piece) {
                link.write(lane, placed, view);
            }
            let is_full = piece.len() == bundle.links.len();
            bundle.full[lane] = if is_full { 1.0 } else { 0.0 };
            if let Some(last) = bundle.links.last_mut().filter(|_| !is_full) {
                last.clear(lane);
            }
        }
    }

    /// Opens another bundle, for strands or pieces of `count` links.
    fn open(&mut self, count: usize) -> usize {
        if self.used == self.bundles.len() {
            self.bundles.push(Bundle::empty());
        }
        let bundle = &mut self.bundles[self.used];
        bundle.islands.clear();
        bundle.islands.reserve(WIDTH);
        (bundle.is_cut, bundle.full) = (false, [1.0; WIDTH]);
        if bundle.links.len() != count {
            bundle.links.resize(count, Link::EMPTY);
            bundle.filled = 0;
        }
        self.used += 1;
        self.used - 1
    }

    /// Steps all strands.
    pub fn run(&mut self, view: &View<'_>, context: &StepContext<'_>) {
        for_each_mut(context.runner, &mut self.bundles[..self.used], |bundle| {
            let (h, substeps) = view.pace.stretched(bundle.stretch);
            bundle.run(Pace { h, substeps, max_speed: view.def.max_speed, max_spin: view.def.max_turn / h });
        });
        if context.profiler.is_counting() {
            for strand in self.solved() {
                let links = strand.links().count() as u64;
                let (_, substeps) = view.pace.stretched(strand.bundle.stretch);
                context.profiler.count(Counter::Bodies, links);
                context.profiler.count(Counter::BodySubsteps, links * u64::from(substeps));
                context.profiler.count(Counter::Joints, strand.joint_links().count() as u64);
            }
        }
    }

    /// Strands whose step is valid, so that the islands' solver does not repeat it.
    pub fn solved(&self) -> impl Iterator<Item = SolvedStrand<'_>> {
        self.bundles[..self.used].iter().flat_map(|bundle| {
            let done = (0..bundle.islands.len()).filter(|lane| bundle.left & 1 << lane == 0);
            let lanes = |lane| if bundle.is_cut { 0..WIDTH } else { lane..lane + 1 };
            done.map(move |lane| SolvedStrand {
                bundle,
                lanes: lanes(lane),
                island: bundle.islands[lane] as usize,
            })
        })
    }
}

impl Bundle {
    fn empty() -> Self {
        Self {
            islands: Vec::new(),
            links: Vec::new(),
            is_held: false,
            hook: Hook::EMPTY,
            is_cut: false,
            cuts: Box::new(Cuts::EMPTY),
            full: [1.0; WIDTH],
            stretch: 1.0,
            filled: 0,
            left: 0,
        }
    }

    fn run(&mut self, pace: Pace) {
        let lanes = if self.is_cut { WIDTH } else { self.islands.len() };
        if !self.is_cut && lanes > 1 && lanes != self.filled {
            self.links.iter_mut().for_each(|link| link.fill(lanes));
            self.hook.fill(lanes);
            self.filled = lanes;
        }
        let hook = self.is_held.then_some(&self.hook);
        let (links, cuts, full) = (&mut self.links[..], self.is_cut.then_some(&mut *self.cuts), &self.full);
        let advance = Advance { links, hook, cuts, full, pace, lanes };
        self.left = if lanes > 1 { dispatch::run(advance) } else { dispatch::run(Alone(advance)) };
    }

    /// Number of links in a lane.
    fn length(&self, lane: usize) -> usize {
        self.links.len() - usize::from(self.full[lane] == 0.0)
    }
}

impl SolvedStrand<'_> {
    /// Poses and velocities of the links after the step.
    pub fn bodies(&self) -> impl Iterator<Item = SolvedBody> {
        self.links().map(|(link, lane)| link.body(lane))
    }

    /// State that the joints keep for the next step.
    pub fn joints(&self) -> impl Iterator<Item = SolvedJoint> {
        self.joint_links().map(|(link, lane)| link.joint(lane))
    }

    fn joint_links(&self) -> impl Iterator<Item = (&Link, usize)> {
        self.links().filter(|(link, lane)| link.joints[*lane] != order::NONE)
    }

    /// Links and their lanes, from the first link on.
    fn links(&self) -> impl Iterator<Item = (&Link, usize)> {
        let bundle = self.bundle;
        self.lanes
            .clone()
            .flat_map(move |lane| bundle.links[..bundle.length(lane)].iter().map(move |link| (link, lane)))
    }
}

/// True for a joint that only locks a point.
fn is_plain(joint: &Joint) -> bool {
    use crate::joint::def::JointKind;
    joint.kind == JointKind::Ball { limit: None } && joint.drive.is_limp() && joint.drive.friction == 0.0
}

/// Geometric stiffness about the principal axes that a unit of pull at an anchor adds to the moments: row sums of `1 − r̂ r̂ᵀ`, so that the
/// inertia stays diagonal.
fn stiffness_of(anchor: Vec3) -> Vec3 {
    let axis = sinew_math::normalize_or(anchor, Vec3::X);
    let off = sinew_math::abs3(axis);
    Vec3::new(
        1.0 - axis.x * axis.x + off.x * (off.y + off.z),
        1.0 - axis.y * axis.y + off.y * (off.x + off.z),
        1.0 - axis.z * axis.z + off.z * (off.x + off.y),
    )
}
