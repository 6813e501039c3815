//! Arms, gaps and the factor at the pose to which the links have come.

use super::super::articulation::elimination::{Freedom, Inertia, Swivel, Symmetric, zero};
use super::super::flight::{Eight, load, store};
use super::super::motion::{narrow, widen};
use super::link::{Hook, Link, load_turn};
use super::substep::Pace;
use sinew_math::lanes::{Lanes, Vector3};

/// Arms of the joints at the present pose.
#[inline(always)]
pub(super) fn place_arms<L: Lanes>(links: &mut [Link]) {
    for i in 0..links.len() {
        let arm = load_turn::<L>(&links[i].rotation).turned(load(&links[i].anchor));
        store(arm, &mut links[i].arm);
        if i > 0 {
            let parent_arm = load_turn::<L>(&links[i - 1].rotation).turned(load(&links[i].parent_anchor));
            store(parent_arm, &mut links[i].parent_arm);
        }
    }
}

/// Gaps of the joints, from their arms.
#[inline(always)]
pub(super) fn place_gaps<L: Lanes>(links: &mut [Link], hook: Option<&Hook>) {
    for i in 0..links.len() {
        let (position, arm) = (load::<L>(&links[i].position), load::<L>(&links[i].arm));
        let [parent, parent_arm] = match (i.checked_sub(1), hook) {
            (Some(parent), _) => [load(&links[parent].position), load(&links[i].parent_arm)],
            (None, Some(hook)) => [load(&hook.position), load(&hook.arm)],
            (None, None) => [position, arm],
        };
        store((position - parent) + (arm - parent_arm), &mut links[i].gap);
    }
}

/// The factor, from the end of the strand on, with geometric stiffness `h² k_g` of the joints' forces as far as it exceeds the
/// inertia. All that a link feels of those below it is a mass at the joint, which depends on the direction.
#[inline(always)]
pub(super) fn factor<L: Lanes>(links: &mut [Link], is_held: bool, pace: &Pace) {
    let (none, h2) = (L::splat(0.0), L::splat(pace.h * pace.h));
    let mut below = Below { mass: Symmetric::zero(), arm: zero::<L>(), stiffness: zero::<L>() };
    for (i, link) in links.iter_mut().enumerate().rev() {
        let (arm, parent_arm, force) =
            (load::<L>(&link.arm), load::<L>(&link.parent_arm), load::<L>(&link.force));
        let pull = L::max(arm.dot(force), none) * h2;
        let inertia = load::<L>(&link.inertia);
        let excess = (load::<L>(&link.stiffness) * pull + below.stiffness) - inertia;
        let excess = Vector3::new(L::max(excess.x, none), L::max(excess.y, none), L::max(excess.z, none));
        store(excess, &mut link.excess);
        let tensor = load_turn::<L>(&link.rotation).rotated_diagonal(inertia + excess);
        let whole = at_anchor::<L>(tensor, L::load(&link.mass), arm, &below);
        let is_jointed = i > 0 || is_held;
        let mut swivel = Swivel::at_anchor(if is_jointed { Freedom::Rotation } else { Freedom::All }, whole);
        let through = swivel.factor().mass;
        let (pivot, coupled) = swivel.pivots();
        keep::<L>(&pivot, &mut link.pivot);
        for (row, kept) in coupled.into_iter().zip(&mut link.coupled) {
            store(narrow::<L>(row), kept);
        }
        let passed = if is_jointed { through } else { swivel.inverse_mass() };
        keep::<L>(&passed, &mut link.passed);
        let pull = L::max(-parent_arm.dot(force), none) * h2;
        below = Below { mass: through, arm: parent_arm, stiffness: load::<L>(&link.parent_stiffness) * pull };
    }
}

/// Inertia that a link feels of those below it.
struct Below<L: Lanes> {
    /// At the joint, kg.
    mass: Symmetric<L::Wide>,
    /// From the link's centre of mass to the joint, world axes.
    arm: Vector3<L>,
    /// Moments that the joint's pull adds to the link, kg·m².
    stiffness: Vector3<L>,
}

/// Articulated inertia about the anchor of a link with such a tensor about its centre: diagonal, and yz, xz, xy.
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

/// With the digits of the solve.
#[inline(always)]
fn keep<L: Lanes>(Symmetric(from): &Symmetric<L::Wide>, to: &mut [Eight; 6]) {
    for (number, row) in from.iter().zip(to) {
        L::narrow(*number).store(row);
    }
}

/// As it was kept.
#[inline(always)]
pub(super) fn kept<L: Lanes>([a, b, c, d, e, f]: &[Eight; 6]) -> Symmetric<L> {
    Symmetric([L::load(a), L::load(b), L::load(c), L::load(d), L::load(e), L::load(f)])
}
