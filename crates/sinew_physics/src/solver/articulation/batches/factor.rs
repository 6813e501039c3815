//! Factors eight trees: eliminates the open directions of the joints from the leaves to the roots, in double precision.

use super::MOST_LINKS;
use super::node::{Axis, Kind, Node};
use crate::solver::articulation::elimination::{Freedom, Inertia, Swivel, Symmetric};
use crate::solver::flight::{Eight, load, store};
use crate::solver::motion::{Turn, narrow, widen};
use sinew_math::dispatch::Kernel;
use sinew_math::lanes::{Lanes, Vector3};

/// Factors all trees of a batch.
pub(super) struct Factor<'a>(pub &'a mut [Node]);

impl Kernel for Factor<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        factor::<L>(self.0);
    }
}

#[inline(always)]
fn factor<L: Lanes>(nodes: &mut [Node]) {
    let mut below = [Inertia::<L::Wide>::zero(); MOST_LINKS];
    for (i, node) in nodes.iter_mut().enumerate().rev() {
        let turn = Turn::<L> {
            vector: load(&[node.rotation[0], node.rotation[1], node.rotation[2]]),
            real: L::load(&node.rotation[3]),
        };
        let [d, o] = turn.rotated_diagonal(load(&node.moments));
        let tensor = [d.x, o.z, o.y, d.y, o.x, d.z];
        for (number, row) in tensor.into_iter().zip(&mut node.tensor) {
            number.store(row);
        }
        let mut whole = below[i];
        whole.add(&Inertia::of_body(L::load(&node.mass).widen(), wide::<L>(&node.tensor)));
        let parent_arm = widen(load::<L>(&node.parent_arm));
        let through = match node.site.kind {
            Kind::Root => {
                let mut free = Swivel::at_anchor(Freedom::All, whole);
                free.factor();
                keep_pivots::<L>(node, &free);
                keep::<L>(&free.inverse_mass(), &mut node.passed_mass);
                continue;
            }
            Kind::Point => {
                let mut swivel =
                    Swivel::at_anchor(Freedom::Rotation, whole.shifted(widen(load::<L>(&node.arm))));
                let through = swivel.factor().mass;
                keep_pivots::<L>(node, &swivel);
                keep::<L>(&through, &mut node.passed_mass);
                through.at(-parent_arm)
            }
            Kind::DrivenPoint => {
                let at = whole.shifted(widen(load::<L>(&node.arm)));
                let mut swivel = Swivel::at_anchor(Freedom::DrivenRotation, at);
                swivel.gain = wide::<L>(&node.gain);
                let through = swivel.factor();
                keep_pivots::<L>(node, &swivel);
                keep_passed::<L>(node, &through);
                through.shifted(-parent_arm)
            }
            Kind::Axes { held } => {
                let start = whole.shifted(widen(load::<L>(&node.arm)));
                let mut left = start;
                for axis in &mut node.axes[held..] {
                    eliminate::<L>(axis, &start, &mut left);
                }
                keep_passed::<L>(node, &left);
                left.shifted(-parent_arm)
            }
        };
        below[node.site.parent as usize & (MOST_LINKS - 1)].add(&through);
    }
}

#[inline(always)]
fn eliminate<L: Lanes>(axis: &mut Axis, start: &Inertia<L::Wide>, left: &mut Inertia<L::Wide>) {
    let way = widen(load::<L>(&axis.way));
    let ([force, torque], inverse) = left.eliminate(start, (true, way), L::load(&axis.gain).widen());
    store(narrow::<L>(force), &mut axis.force);
    store(narrow::<L>(torque), &mut axis.torque);
    L::narrow(inverse).store(&mut axis.inverse);
}

#[inline(always)]
fn keep_pivots<L: Lanes>(node: &mut Node, swivel: &Swivel<L::Wide>) {
    let (pivot, coupled) = swivel.pivots();
    keep::<L>(&pivot, &mut node.pivot);
    keep_rows::<L>(coupled, &mut node.coupled);
}

#[inline(always)]
fn keep_passed<L: Lanes>(node: &mut Node, through: &Inertia<L::Wide>) {
    keep::<L>(&through.mass, &mut node.passed_mass);
    keep_rows::<L>(through.coupling, &mut node.passed_coupling);
    keep::<L>(&through.rotation, &mut node.passed_rotation);
}

/// Rounds to the precision of the solve and stores the result.
#[inline(always)]
fn keep<L: Lanes>(Symmetric(from): &Symmetric<L::Wide>, to: &mut [Eight; 6]) {
    for (number, row) in from.iter().zip(to) {
        L::narrow(*number).store(row);
    }
}

#[inline(always)]
fn keep_rows<L: Lanes>(from: [Vector3<L::Wide>; 3], to: &mut [[Eight; 3]; 3]) {
    for (row, to) in from.into_iter().zip(to) {
        store(narrow::<L>(row), to);
    }
}

/// Loads a stored matrix in double precision.
#[inline(always)]
fn wide<L: Lanes>(from: &[Eight; 6]) -> Symmetric<L::Wide> {
    let [a, b, c, d, e, f] = from;
    let (a, b, c) = (L::load(a).widen(), L::load(b).widen(), L::load(c).widen());
    let (d, e, f) = (L::load(d).widen(), L::load(e).widen(), L::load(f).widen());
    Symmetric([a, b, c, d, e, f])
}
