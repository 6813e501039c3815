//! Arms, gaps and the factor at the present pose of the links.

use super::super::articulation::elimination::{Freedom, Inertia, Swivel, Symmetric, zero};
use super::super::flight::{Eight, load, store};
use super::super::motion::{narrow, widen};
use super::joints::StrandEnds;
use super::link::{Link, load_turn};
use super::pieces::{all, handed_up, masked};
use super::substep::Pace;
use sinew_math::lanes::{Lanes, Real, Vector3};

/// Computes the arms of the joints at the present pose.
#[inline(always)]
pub(super) fn place_arms<L: Lanes>(links: &mut [Link], ends: &mut StrandEnds<'_, L>) {
    for i in 0..links.len() {
        let arm = load_turn::<L>(&links[i].rotation).turned(load(&links[i].anchor));
        store(arm, &mut links[i].arm);
        if i > 0 {
            let parent_arm = load_turn::<L>(&links[i - 1].rotation).turned(load(&links[i].parent_anchor));
            store(parent_arm, &mut links[i].parent_arm);
        }
    }
    if let Some(cuts) = &mut ends.cuts {
        cuts.place_arms(links, ends.hook, ends.tips);
    }
}

/// Computes the gaps of the joints from their arms.
#[inline(always)]
pub(super) fn place_gaps<L: Lanes>(links: &mut [Link], ends: &StrandEnds<'_, L>) {
    for i in 0..links.len() {
        let (position, arm) = (load::<L>(&links[i].position), load::<L>(&links[i].arm));
        let [parent, parent_arm] = match (i.checked_sub(1), ends.hooks()) {
            (Some(parent), _) => [load(&links[parent].position), load(&links[i].parent_arm)],
            (None, Some(hook)) => [load(&hook.position), load(&hook.arm)],
            (None, None) => [position, arm],
        };
        let gap = (position - parent) + (arm - parent_arm);
        store(masked(gap, ends.tips.within(all::<L>(), i)), &mut links[i].gap);
    }
    if let Some(cuts) = &ends.cuts {
        cuts.place_gaps(links, ends.hook, ends.tips);
    }
}

/// Computes the factor, from the end of the strand on, with the geometric stiffness `h² k_g` of the joints' forces
/// where it exceeds the inertia. The links below a link act on it as a direction-dependent mass at the joint.
#[inline(always)]
pub(super) fn factor<L: Lanes>(links: &mut [Link], ends: &mut StrandEnds<'_, L>, pace: &Pace) {
    factor_pieces::<L>(links, ends, pace);
    if let Some(cuts) = &mut ends.cuts {
        cuts.factor(links, ends.hook.is_some(), ends.tips);
    }
}

#[inline(always)]
fn factor_pieces<L: Lanes>(links: &mut [Link], ends: &StrandEnds<'_, L>, pace: &Pace) {
    let (none, h2) = (L::splat(0.0), L::splat(pace.h * pace.h));
    let mut below = Below { mass: Symmetric::zero(), arm: zero::<L>(), stiffness: zero::<L>() };
    let of_cut = if ends.cuts.is_some() { handed_up(stiffness_above(&links[0], h2)) } else { zero::<L>() };
    for (i, link) in links.iter_mut().enumerate().rev() {
        below.stiffness = ends.tips.below(i, below.stiffness, of_cut);
        if i + 1 == ends.tips.place {
            below.mass = within::<L>(below.mass, ends.tips.full_wide);
        }
        let (arm, force) = (load::<L>(&link.arm), load::<L>(&link.force));
        let pull = L::max(arm.dot(force), none) * h2;
        let inertia = load::<L>(&link.inertia);
        let excess = (load::<L>(&link.stiffness) * pull + below.stiffness) - inertia;
        let excess = Vector3::new(L::max(excess.x, none), L::max(excess.y, none), L::max(excess.z, none));
        store(excess, &mut link.excess);
        let tensor = load_turn::<L>(&link.rotation).rotated_diagonal(inertia + excess);
        let whole = at_anchor::<L>(tensor, L::load(&link.mass), arm, &below);
        let is_jointed = i > 0 || ends.holds_first();
        let mut swivel = Swivel::at_anchor(if is_jointed { Freedom::Rotation } else { Freedom::All }, whole);
        let through = swivel.factor().mass;
        let (pivot, coupled) = swivel.pivots();
        keep::<L>(&pivot, &mut link.pivot);
        for (row, kept) in coupled.into_iter().zip(&mut link.coupled) {
            store(narrow::<L>(row), kept);
        }
        let passed = if is_jointed { through } else { swivel.inverse_mass() };
        keep::<L>(&passed, &mut link.passed);
        below = Below { mass: through, arm: load(&link.parent_arm), stiffness: stiffness_above(link, h2) };
    }
}

/// Moments that the pull of a link's joint adds to the parent of the link, kg·m².
#[inline(always)]
fn stiffness_above<L: Lanes>(link: &Link, h2: L) -> Vector3<L> {
    let pull = L::max(-load::<L>(&link.parent_arm).dot(load(&link.force)), L::splat(0.0)) * h2;
    load::<L>(&link.parent_stiffness) * pull
}

/// Keeps the values in the lanes of the mask, and sets zero elsewhere.
#[inline(always)]
fn within<L: Lanes>(
    Symmetric(mut numbers): Symmetric<L::Wide>,
    mask: <L::Wide as Real>::Mask,
) -> Symmetric<L::Wide> {
    for number in &mut numbers {
        *number = number.masked(mask);
    }
    Symmetric(numbers)
}

/// Inertia of the links below, as it acts on a link.
struct Below<L: Lanes> {
    /// Mass at the joint, kg.
    mass: Symmetric<L::Wide>,
    /// Vector from the link's centre of mass to the joint, world axes.
    arm: Vector3<L>,
    /// Moments that the joint's pull adds to the link, kg·m².
    stiffness: Vector3<L>,
}

/// Articulated inertia about the anchor of a link with the given tensor about its centre: diagonal, and yz, xz, xy.
#[inline(always)]
fn at_anchor<L: Lanes>(
    [diagonal, off]: [Vector3<L>; 2],
    mass: L,
    arm: Vector3<L>,
    below: &Below<L>,
) -> Inertia<L::Wide> {
    let (d, o, mass, r) = (widen(diagonal), widen(off), mass.widen(), widen(arm));
    let mut whole = below.mass.at(r - widen(below.arm));
    let [a, b, c] = &mut whole.coupling;
    let m = r * mass;
    (a.y, a.z) = (a.y - m.z, a.z + m.y);
    (b.x, b.z) = (b.x + m.z, b.z - m.x);
    (c.x, c.y) = (c.x - m.y, c.y + m.x);
    let (x, y, z) = (m.x * r.x, m.y * r.y, m.z * r.z);
    let own =
        [d.x + (y + z), o.z - m.x * r.y, o.y - m.x * r.z, d.y + (x + z), o.x - m.y * r.z, d.z + (x + y)];
    whole.rotation = whole.rotation.plus(&Symmetric(own));
    let [xx, _, _, yy, _, zz] = &mut whole.mass.0;
    (*xx, *yy, *zz) = (*xx + mass, *yy + mass, *zz + mass);
    whole
}

/// Rounds to the precision of the solve and stores the matrix.
#[inline(always)]
fn keep<L: Lanes>(Symmetric(from): &Symmetric<L::Wide>, to: &mut [Eight; 6]) {
    for (number, row) in from.iter().zip(to) {
        L::narrow(*number).store(row);
    }
}

/// Loads a stored matrix.
#[inline(always)]
pub(super) fn kept<L: Lanes>([a, b, c, d, e, f]: &[Eight; 6]) -> Symmetric<L> {
    Symmetric([L::load(a), L::load(b), L::load(c), L::load(d), L::load(e), L::load(f)])
}
