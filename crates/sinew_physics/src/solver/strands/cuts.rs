//! Long strands, cut into eight pieces that are solved side by side.
//!
//! Each piece is a free strand in its own lane. The responses of its two ends to forces at either end make one 3×3 block for each cut joint
//! and one for the joint that holds the strand. Together they form a tridiagonal system (the Schur complement of the joints within pieces),
//! which is solved in 64 bits. With the impulses of those joints, the pieces move as one strand.

use super::super::articulation::elimination::{Matrix, Symmetric, columns, times, transposed_times, zero};
use super::super::flight::{Eight, ZERO, load, put, store};
use super::factor::kept;
use super::joints::{Asked, answer, rows, slide};
use super::link::{Hook, Link, load_turn};
use super::pieces::{Tips, handed_down, handed_up, masked, select};
use crate::solver::motion::Turn;
use sinew_math::Vec3;
use sinew_math::lanes::{Lanes, Vector3, WIDTH};

/// The joints between the pieces of a strand, each in the lane of the piece below it; the first lane has the joint that holds the strand.
#[derive(Clone, Debug)]
pub(super) struct Cuts {
    /// Vector from the centre of the last link of each piece to the joint below it, world axes, metres.
    arm: [Eight; 3],
    /// Factor: inverses of the pivots, and the share of each joint's remaining rate that is added to the joint above.
    inverse: [Symmetric<f64>; WIDTH],
    through: [Matrix<f64>; WIDTH],
    /// Impulses on the pieces' first links by the last solve, and their sums since the last [`take_given`](Self::take_given), N·s.
    last: [Eight; 3],
    given: [Eight; 3],
}

impl Cuts {
    pub const EMPTY: Self = Self {
        arm: [ZERO; 3],
        inverse: [Symmetric([0.0; 6]); WIDTH],
        through: [[Vector3 { x: 0.0, y: 0.0, z: 0.0 }; 3]; WIDTH],
        last: [ZERO; 3],
        given: [ZERO; 3],
    };

    /// Vector from the centre of the last link of each piece to the joint below it.
    #[inline(always)]
    fn arm<L: Lanes>(&self) -> Vector3<L> {
        load(&self.arm)
    }

    /// Computes the arms of the joints' upper bodies at the present pose.
    #[inline(always)]
    pub fn place_arms<L: Lanes>(&mut self, links: &mut [Link], hook: Option<&Hook>, tips: Tips<L>) {
        let [last, before] = tips.of(links).map(|link| &link.rotation);
        let arm = turn_above::<L>(last, before, tips).turned(load(&links[0].parent_anchor));
        store(arm, &mut links[0].parent_arm);
        let [_, first] = hook.map_or([Vec3::ZERO; 2], Hook::first);
        put(first, &mut links[0].parent_arm, 0);
        store(handed_up(load::<L>(&links[0].parent_arm)), &mut self.arm);
    }

    /// Computes the gaps at the present poses.
    #[inline(always)]
    pub fn place_gaps<L: Lanes>(&self, links: &mut [Link], hook: Option<&Hook>, tips: Tips<L>) {
        let [last, before] = tips.of(links).map(|link| &link.position);
        let [first, _] = hook.map_or([Vec3::ZERO; 2], Hook::first);
        let above = handed_down(tips.pick(load(last), load(before)), first);
        let link = &mut links[0];
        let gap = (load::<L>(&link.position) - above) + (load::<L>(&link.arm) - load(&link.parent_arm));
        keep_gap(gap, link, hook.is_some());
    }

    /// Computes and returns the gaps at the poses to which the velocities lead.
    #[inline(always)]
    pub fn look_ahead<L: Lanes>(&self, links: &mut [Link], hook: Option<&Hook>, tips: Tips<L>) -> Vector3<L> {
        let [last, before] = tips.of(links);
        let turn = turn_above::<L>(&last.ahead_rotation, &before.ahead_rotation, tips);
        let [position, arm] = hook.map_or([Vec3::ZERO; 2], Hook::first);
        let above = handed_down(tips.pick(load(&last.ahead), load(&before.ahead)), position);
        let link = &mut links[0];
        let mut parent_arm = [ZERO; 3];
        store(turn.turned(load(&link.parent_anchor)), &mut parent_arm);
        put(arm, &mut parent_arm, 0);
        let own = load_turn::<L>(&link.ahead_rotation).turned(load(&link.anchor));
        let gap = (load::<L>(&link.ahead) - above) + (own - load(&parent_arm));
        keep_gap(gap, link, hook.is_some())
    }

    /// Opening velocities of the joints; zero in the first lane of a free strand.
    #[inline(always)]
    pub fn slide<L: Lanes>(&self, links: &[Link], is_held: bool, tips: Tips<L>) -> Vector3<L> {
        let [last, before] = tips.of(links);
        let velocity = tips.pick(load(&last.velocity), load(&before.velocity));
        let spin = tips.pick(load(&last.spin), load(&before.spin));
        let above = handed_down(velocity + spin.cross(self.arm()), Vec3::ZERO);
        masked(slide(&links[0], None) - above, holds::<L>(is_held))
    }

    /// Computes the factor from those of the pieces.
    #[inline(always)]
    pub fn factor<L: Lanes>(&mut self, links: &[Link], is_held: bool, tips: Tips<L>) {
        let (one, none) = (L::splat(1.0), L::splat(0.0));
        // Responses of each piece's last end and first end to a force at the last end.
        let first = kept::<L>(&links[0].passed);
        let (mut own, mut across) = (first, first.rows());
        for (i, link) in links.iter().enumerate() {
            let r = self.arm_below(links, i, tips) - load(&link.arm);
            let [x, y, z] = rows::<L>(&link.coupled);
            let handed = [
                Vector3::new(one, none, none) - x.cross(r),
                Vector3::new(none, one, none) - y.cross(r),
                Vector3::new(none, none, one) - z.cross(r),
            ];
            let [i0, i1, i2] = across;
            let beyond =
                [transposed_times(&handed, i0), transposed_times(&handed, i1), transposed_times(&handed, i2)];
            let [u, v, w] = columns(&handed);
            let [a, b, c] = [own.times(u), own.times(v), own.times(w)];
            let pivot = kept::<L>(&link.pivot);
            let [r, s, t] =
                [Vector3::new(none, r.z, -r.y), Vector3::new(-r.z, none, r.x), Vector3::new(r.y, -r.x, none)];
            let [d, e, f] = [pivot.times(r), pivot.times(s), pivot.times(t)];
            let further = Symmetric([
                u.dot(a) + r.dot(d),
                u.dot(b) + r.dot(e),
                u.dot(c) + r.dot(f),
                v.dot(b) + s.dot(e),
                v.dot(c) + s.dot(f),
                w.dot(c) + t.dot(f),
            ]);
            if i == tips.place {
                for (row, beyond) in across.iter_mut().zip(beyond) {
                    *row = select(tips.full, beyond, *row);
                }
                for (number, further) in own.0.iter_mut().zip(further.0) {
                    *number = L::select(tips.full, further, *number);
                }
            } else {
                (own, across) = (further, beyond);
            }
        }
        self.eliminate(&Ends::new(first, own, across), is_held);
    }

    /// Eliminates the blocks from the last joint to the first.
    fn eliminate(&mut self, ends: &Ends, is_held: bool) {
        for k in (0..WIDTH).rev() {
            let mut pivot = symmetric_in(&ends.first, k);
            if k > 0 {
                pivot = pivot.plus(&symmetric_in(&ends.last, k - 1));
            }
            if let Some(below) = self.inverse.get(k + 1) {
                let across = ends.across.each_ref().map(|row| vector_in(row, k));
                let [x, y, z] = across.map(|row| below.times(row));
                let [u, v, w] = across;
                let taken = [x.dot(u), x.dot(v), x.dot(w), y.dot(v), y.dot(w), z.dot(w)];
                pivot = pivot.minus(&Symmetric(taken));
                self.through[k] = [x, y, z];
            }
            self.inverse[k] = if k > 0 || is_held { pivot.inverse() } else { Symmetric([0.0; 6]) };
        }
    }

    /// Closes the joints between pieces, after the pieces have been solved as free strands: gives each joint its requested motion.
    #[inline(always)]
    pub fn close<L: Lanes>(
        &mut self,
        links: &mut [Link],
        is_held: bool,
        tips: Tips<L>,
        (asked, h): (Asked, f32),
    ) {
        let (mut answered, mut before) = ([zero::<L>(); 2], [zero::<L>(); 2]);
        for link in links.iter() {
            (before, answered) = (answered, answer(link, answered));
        }
        let [v, w] = [tips.pick(answered[0], before[0]), tips.pick(answered[1], before[1])];
        let mut rate = load::<L>(&links[0].asked) - handed_down(v + w.cross(self.arm()), Vec3::ZERO);
        if asked != Asked::Corrected {
            rate = rate + self.slide(links, is_held, tips);
        }
        if asked != Asked::Rest {
            rate = rate + load::<L>(&links[0].gap) * L::splat(1.0 / h);
        }
        store(-rate, &mut self.last);
        self.solve();
        let given = load::<L>(&self.last);
        store(load::<L>(&self.given) + given, &mut self.given);
        let of_cut = -handed_up(given);
        let mut force = zero::<L>();
        for i in (0..links.len()).rev() {
            force = tips.below(i, force, of_cut);
            let torque = (self.arm_below(links, i, tips) - load(&links[i].arm)).cross(force);
            let link = &mut links[i];
            store(load::<L>(&link.left) + torque, &mut link.left);
            force = force - times(&rows::<L>(&link.coupled), torque);
        }
        let moved = kept::<L>(&links[0].passed).times(force + given);
        store(load::<L>(&links[0].asked) + moved, &mut links[0].asked);
    }

    /// Solves for the impulses, from the requested rates in `last`.
    fn solve(&mut self) {
        let mut left = [zero::<f64>(); WIDTH];
        for k in (0..WIDTH).rev() {
            left[k] = vector_in(&self.last, k);
            if let Some(below) = left.get(k + 1) {
                left[k] = left[k] + times(&self.through[k], *below);
            }
        }
        let mut above = zero::<f64>();
        for k in 0..WIDTH {
            let mut impulse = self.inverse[k].times(left[k]);
            if k > 0 {
                impulse = impulse + transposed_times(&self.through[k - 1], above);
            }
            above = impulse;
            for (row, number) in self.last.iter_mut().zip(impulse.to_array()) {
                row[k] = number as f32;
            }
        }
    }

    /// Subtracts the impulses of the last solve.
    #[inline(always)]
    pub fn take_back<L: Lanes>(&mut self) {
        store(load::<L>(&self.given) - load(&self.last), &mut self.given);
    }

    /// Returns impulse and angular impulse of the last link of each piece on the joint below it, about the link's centre, and resets the
    /// sums.
    #[inline(always)]
    pub fn take_given<L: Lanes>(&mut self) -> [Vector3<L>; 2] {
        let force = handed_up(load::<L>(&self.given));
        self.given = [ZERO; 3];
        [force, self.arm::<L>().cross(force)]
    }

    /// Vector from the centre of link `i` to the joint below it.
    #[inline(always)]
    fn arm_below<L: Lanes>(&self, links: &[Link], i: usize, tips: Tips<L>) -> Vector3<L> {
        let below = links.get(i + 1).map_or(zero(), |below| load(&below.parent_arm));
        tips.below(i, below, self.arm())
    }
}

/// Rotations of the links above the first links of the pieces.
#[inline(always)]
fn turn_above<L: Lanes>(last: &[Eight; 4], before: &[Eight; 4], tips: Tips<L>) -> Turn<L> {
    let [last, before] = [load_turn::<L>(last), load_turn::<L>(before)];
    let vector = handed_down(tips.pick(last.vector, before.vector), Vec3::ZERO);
    let real = L::select(tips.full, last.real, before.real);
    // The first lane has no link above; any rotation is valid there.
    let real = handed_down(Vector3::new(real, real, real), Vec3::ONE).x;
    Turn { vector, real }
}

/// Lanes in which a joint holds the first link.
#[inline(always)]
fn holds<L: Lanes>(is_held: bool) -> L::Mask {
    let mut holds = [1.0; WIDTH];
    holds[0] = f32::from(u8::from(is_held));
    L::lt(L::splat(0.5), L::load(&holds))
}

#[inline(always)]
fn keep_gap<L: Lanes>(gap: Vector3<L>, link: &mut Link, is_held: bool) -> Vector3<L> {
    let gap = masked(gap, holds::<L>(is_held));
    store(gap, &mut link.gap);
    gap
}

/// Responses of the ends of the pieces to forces at them, m/s per N·s.
struct Ends {
    first: [Eight; 6],
    last: [Eight; 6],
    /// Rows of the first end's response to forces at the last end.
    across: [[Eight; 3]; 3],
}

impl Ends {
    #[inline(always)]
    fn new<L: Lanes>(first: Symmetric<L>, last: Symmetric<L>, across: Matrix<L>) -> Self {
        let mut ends = Self { first: [ZERO; 6], last: [ZERO; 6], across: [[ZERO; 3]; 3] };
        for (number, row) in first.0.into_iter().zip(&mut ends.first) {
            number.store(row);
        }
        for (number, row) in last.0.into_iter().zip(&mut ends.last) {
            number.store(row);
        }
        for (row, to) in across.into_iter().zip(&mut ends.across) {
            store(row, to);
        }
        ends
    }
}

fn symmetric_in(rows: &[Eight; 6], lane: usize) -> Symmetric<f64> {
    Symmetric(rows.map(|row| f64::from(row[lane])))
}

fn vector_in([x, y, z]: &[Eight; 3], lane: usize) -> Vector3<f64> {
    Vector3::new(f64::from(x[lane]), f64::from(y[lane]), f64::from(z[lane]))
}
