//! Exact solve of a strand's joints: an ascent to its first link, and a descent.

use super::super::articulation::elimination::{times, transposed_times, zero};
use super::super::flight::{Eight, load, store};
use super::super::motion::Turn;
use super::cuts::Cuts;
use super::factor::kept;
use super::link::{Hook, Link, load_turn, store_turn};
use super::pieces::{Tips, all, masked, select, whole_max};
use sinew_math::lanes::{Lanes, Vector3};

/// Ends of strands: fixed bodies that hold them, or the cuts between the pieces of one strand.
pub(super) struct StrandEnds<'a, L: Lanes> {
    /// Fixed bodies that hold the strands; only that in the first lane is used if the strand is cut.
    pub hook: Option<&'a Hook>,
    pub cuts: Option<&'a mut Cuts>,
    pub tips: Tips<L>,
}

impl<'a, L: Lanes> StrandEnds<'a, L> {
    /// True if the first link of every lane is jointed to a fixed body.
    #[inline(always)]
    pub fn holds_first(&self) -> bool {
        self.hook.is_some() && self.cuts.is_none()
    }

    /// True if a joint holds the first link of most lanes.
    #[inline(always)]
    pub fn joins_first(&self) -> bool {
        self.hook.is_some() || self.cuts.is_some()
    }

    /// Returns impulses and angular impulses of the last links on the cut joints, about the links' centres, since the last call.
    #[inline(always)]
    pub fn take_given(&mut self) -> [Vector3<L>; 2] {
        match &mut self.cuts {
            Some(cuts) => cuts.take_given(),
            None => [zero(), zero()],
        }
    }

    /// Fixed bodies to which the first links of all lanes are jointed.
    #[inline(always)]
    pub fn hooks(&self) -> Option<&'a Hook> {
        if self.cuts.is_none() { self.hook } else { None }
    }
}

/// Motion that the joints are to make.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Asked {
    /// The anchors stop moving relative to each other.
    Rest,
    /// The gaps close within the substep.
    Closed,
    /// The gaps at the poses to which the present velocities lead close.
    Corrected,
}

/// Ascends from the end of the strand to its first link: computes the requested motion of each joint and the impulse of the links below on
/// it.
#[inline(always)]
pub(super) fn ascend<L: Lanes>(links: &mut [Link], ends: &mut StrandEnds<'_, L>, asked: Asked, h: f32) {
    ascend_pieces::<L>(links, ends, asked, h);
    if let Some(cuts) = &mut ends.cuts {
        cuts.close(links, ends.hook.is_some(), ends.tips, (asked, h));
    }
}

#[inline(always)]
fn ascend_pieces<L: Lanes>(links: &mut [Link], ends: &StrandEnds<'_, L>, asked: Asked, h: f32) {
    let rate = L::splat(1.0 / h);
    let (mut force, mut arm_below) = (zero::<L>(), zero::<L>());
    for i in (0..links.len()).rev() {
        force = ends.tips.below(i, force, zero());
        let (before, rest) = links.split_at_mut(i);
        let link = &mut rest[0];
        let arm = load::<L>(&link.arm);
        let torque = (arm_below - arm).cross(force);
        store(torque, &mut link.left);
        force = force - times(&rows::<L>(&link.coupled), torque);
        let passed = kept::<L>(&link.passed);
        if i == 0 && !ends.holds_first() {
            store(passed.times(force), &mut link.asked);
            return;
        }
        let mut wanted = zero::<L>();
        if asked != Asked::Corrected {
            wanted = -slide::<L>(link, before.last());
        }
        if asked != Asked::Rest {
            wanted = wanted - load::<L>(&link.gap) * rate;
        }
        store(wanted, &mut link.asked);
        force = force - passed.times(wanted);
        arm_below = load(&link.parent_arm);
    }
}

/// Velocity of a body's anchor relative to that of its parent; a fixed parent is at rest.
#[inline(always)]
pub(super) fn slide<L: Lanes>(link: &Link, parent: Option<&Link>) -> Vector3<L> {
    let of_body = load::<L>(&link.velocity) + load::<L>(&link.spin).cross(load(&link.arm));
    match parent {
        Some(parent) => {
            of_body - (load::<L>(&parent.velocity) + load::<L>(&parent.spin).cross(load(&link.parent_arm)))
        }
        None => of_body,
    }
}

/// Velocity change of a link for the velocity change of its parent.
#[inline(always)]
pub(super) fn answer<L: Lanes>(link: &Link, [v, w]: [Vector3<L>; 2]) -> [Vector3<L>; 2] {
    let at = (v + w.cross(load(&link.parent_arm))) + load(&link.asked);
    let spin =
        kept::<L>(&link.pivot).times(load(&link.left)) - transposed_times(&rows::<L>(&link.coupled), at);
    [at + load::<L>(&link.arm).cross(spin), spin]
}

#[inline(always)]
pub(super) fn rows<L: Lanes>([x, y, z]: &[[Eight; 3]; 3]) -> [Vector3<L>; 3] {
    [load(x), load(y), load(z)]
}

/// Largest velocity components of a strand, and the remaining opening rate of its joints, m/s and rad/s.
#[derive(Clone, Copy)]
pub(super) struct Left<L> {
    pub fastest: L,
    pub rate: L,
}

/// Descends the strand in the lanes of the mask and updates the velocities only.
#[inline(always)]
pub(super) fn descend<L: Lanes>(links: &mut [Link], ends: &StrandEnds<'_, L>, going: L::Mask) -> Left<L> {
    let none = L::splat(0.0);
    let mut left = Left { fastest: none, rate: none };
    let (mut answered, mut before) = ([zero::<L>(); 2], [zero::<L>(); 2]);
    for (i, link) in links.iter_mut().enumerate() {
        answered = answer(link, answered);
        let mask = ends.tips.within(going, i);
        let velocity = load::<L>(&link.velocity) + masked(answered[0], mask);
        let spin = load::<L>(&link.spin) + masked(answered[1], mask);
        store(velocity, &mut link.velocity);
        store(spin, &mut link.spin);
        left.fastest = L::max(left.fastest, L::max(largest(velocity), largest(spin)));
        if i > 0 || ends.holds_first() {
            let of_parent = before[0] + before[1].cross(load(&link.parent_arm));
            let rate = (velocity + spin.cross(load(&link.arm))) - of_parent;
            left.rate = L::max(left.rate, largest(masked(rate, ends.tips.within(all::<L>(), i))));
        }
        before = [velocity, spin];
    }
    if let Some(cuts) = &ends.cuts {
        left.rate = L::max(left.rate, largest(cuts.slide(links, ends.hook.is_some(), ends.tips)));
        left = Left { fastest: whole_max(left.fastest), rate: whole_max(left.rate) };
    }
    left
}

/// Descends the strand in the lanes of the mask and computes the poses to which the velocities lead. Returns the largest gap there, m.
#[inline(always)]
pub(super) fn descend_ahead<L: Lanes>(
    links: &mut [Link],
    ends: &StrandEnds<'_, L>,
    going: L::Mask,
    h: f32,
) -> L {
    let mut answered = [zero::<L>(); 2];
    let mut parent = Parent::<L>::of_hook(ends.hooks());
    let mut most = L::splat(0.0);
    for (i, link) in links.iter_mut().enumerate() {
        answered = answer(link, answered);
        let [velocity, spin] = [load::<L>(&link.velocity), load::<L>(&link.spin)];
        let mask = ends.tips.within(going, i);
        store(velocity, &mut link.before_velocity);
        store(spin, &mut link.before_spin);
        store(velocity + masked(answered[0], mask), &mut link.velocity);
        store(spin + masked(answered[1], mask), &mut link.spin);
        parent = look_ahead(link, parent, i > 0 || ends.holds_first(), h);
        let gap = masked(load::<L>(&link.gap), ends.tips.within(all::<L>(), i));
        store(gap, &mut link.gap);
        // The state above a cut is not updated here.
        if i > 0 || ends.cuts.is_none() {
            most = L::max(most, largest(gap));
        }
    }
    look_ahead_of_cuts(links, ends, most)
}

/// Computes the gaps at cuts, after those within pieces, the largest of which is `most`. Returns the largest gap of the strand.
#[inline(always)]
fn look_ahead_of_cuts<L: Lanes>(links: &mut [Link], ends: &StrandEnds<'_, L>, most: L) -> L {
    match &ends.cuts {
        Some(cuts) => whole_max(L::max(most, largest(cuts.look_ahead(links, ends.hook, ends.tips)))),
        None => most,
    }
}

/// Undoes the last correction in the lanes of the mask.
#[inline(always)]
pub(super) fn take_back<L: Lanes>(links: &mut [Link], ends: &mut StrandEnds<'_, L>, mask: L::Mask, h: f32) {
    let mut parent = Parent::<L>::of_hook(ends.hooks());
    for (i, link) in links.iter_mut().enumerate() {
        let (velocity, spin) = (load::<L>(&link.velocity), load::<L>(&link.spin));
        store(select(mask, load(&link.before_velocity), velocity), &mut link.velocity);
        store(select(mask, load(&link.before_spin), spin), &mut link.spin);
        parent = look_ahead(link, parent, i > 0 || ends.holds_first(), h);
        let gap = masked(load::<L>(&link.gap), ends.tips.within(all::<L>(), i));
        store(gap, &mut link.gap);
    }
    look_ahead_of_cuts(links, ends, L::splat(0.0));
    if let Some(cuts) = &mut ends.cuts {
        cuts.take_back::<L>();
    }
}

/// Predicted placement of a parent.
#[derive(Clone, Copy)]
struct Parent<L> {
    position: Vector3<L>,
    rotation: Turn<L>,
    /// Vector from a fixed parent to the anchor.
    arm: Vector3<L>,
    is_fixed: bool,
}

impl<L: Lanes> Parent<L> {
    #[inline(always)]
    fn of_hook(hook: Option<&Hook>) -> Self {
        let (one, none) = (L::splat(1.0), zero::<L>());
        let [position, arm] = match hook {
            Some(hook) => [load(&hook.position), load(&hook.arm)],
            None => [none, none],
        };
        Self { position, rotation: Turn { vector: none, real: one }, arm, is_fixed: true }
    }
}

/// Predicts the pose to which a body's velocities lead, and the gap of its joint there.
#[inline(always)]
fn look_ahead<L: Lanes>(link: &mut Link, parent: Parent<L>, is_jointed: bool, h: f32) -> Parent<L> {
    let position = load::<L>(&link.position) + load::<L>(&link.velocity) * L::splat(h);
    let half = load::<L>(&link.spin) * L::splat(0.5 * h);
    let rotation = load_turn::<L>(&link.rotation).then(Turn::by_half_angles(half));
    store(position, &mut link.ahead);
    store_turn(rotation, &mut link.ahead_rotation);
    if is_jointed {
        let parent_arm =
            if parent.is_fixed { parent.arm } else { parent.rotation.turned(load(&link.parent_anchor)) };
        let arm = rotation.turned(load(&link.anchor));
        store((position - parent.position) + (arm - parent_arm), &mut link.gap);
    }
    Parent { position, rotation, arm: parent.arm, is_fixed: false }
}

/// Returns the largest component of a vector.
#[inline(always)]
pub(super) fn largest<L: Lanes>(v: Vector3<L>) -> L {
    let v = v.abs();
    L::max(v.x, L::max(v.y, v.z))
}
