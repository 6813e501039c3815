//! The substeps of eight strands side by side.

use super::super::flight::{Eight, load};
use super::cuts::Cuts;
use super::factor::{factor, place_arms, place_gaps};
use super::joints::{Asked, StrandEnds, ascend, descend, descend_ahead, largest, take_back};
use super::link::{Hook, Link};
use super::motion::{Kinetic, end_substep, integrate_position, integrate_velocity, work_of_forces};
use super::pieces::{Tips, all, whole_all, whole_max, whole_sum};
use crate::solver::tuning::{
    CLOSING_SPEED, DIVERGED_SPEED, DIVERGED_SPIN, ENERGY_SLACK, MAX_INNER_TURN, POSITION_CORRECTIONS,
    POSITION_ROUNDING, POSITION_TOLERANCE, RATE_SHARE, REFINEMENTS, TORN,
};
use sinew_math::dispatch::Kernel;
use sinew_math::lanes::{First, LaneMask, Lanes, WIDTH};

/// Substep length and limits of the strands' step.
#[derive(Clone, Copy)]
pub(super) struct Pace {
    /// Length of the substep, seconds.
    pub h: f32,
    pub substeps: u32,
    /// Limits of speed and spin, m/s and rad/s.
    pub max_speed: f32,
    pub max_spin: f32,
}

/// Steps a bundle. Returns the bit set of the lanes in which a safeguard of the islands would have acted; the results of these lanes are
/// invalid.
pub(super) struct Advance<'a> {
    pub links: &'a mut [Link],
    /// Fixed bodies that hold the strands, if there are any.
    pub hook: Option<&'a Hook>,
    /// Joints between the lanes if these are pieces of one strand.
    pub cuts: Option<&'a mut Cuts>,
    /// 1 in the lanes whose last place is filled.
    pub full: &'a Eight,
    pub pace: Pace,
    /// Number of strands or pieces, from the first lane on.
    pub lanes: usize,
}

/// Steps a single strand, without the other lanes.
pub(super) struct Alone<'a>(pub Advance<'a>);

impl Kernel for Alone<'_> {
    type Output = u8;

    #[inline(always)]
    fn run<L: Lanes>(self) -> u8 {
        self.0.run::<First>()
    }
}

impl Kernel for Advance<'_> {
    type Output = u8;

    #[inline(always)]
    fn run<L: Lanes>(self) -> u8 {
        let Self { links, hook, cuts, full, pace, lanes } = self;
        let mut ends = StrandEnds { hook, cuts, tips: Tips::<L>::new(full, links.len()) };
        let bounds = Bounds::of(links, &ends);
        place_arms(links, &mut ends);
        place_gaps(links, &ends);
        factor(links, &mut ends, &pace);
        let used = first_lanes::<L>(lanes);
        let mut sound = used;
        for _ in 0..pace.substeps {
            let kinetic = integrate_velocity::<L>(links, &pace);
            let kinetic = Kinetic { before: ends.sum(kinetic.before), start: ends.sum(kinetic.start) };
            sound = sound & solve(links, &mut ends, &pace, kinetic, bounds, used);
            integrate_position(links, &mut ends, &pace);
            place_arms(links, &mut ends);
            factor(links, &mut ends, &pace);
            relax(links, &mut ends, pace.h, used);
            let end = end_substep(links, &mut ends);
            let end = ends.sum(end);
            // Joints cannot add energy.
            let slack = L::max(kinetic.start, bounds.mass) * L::splat(ENERGY_SLACK);
            sound = ends.every(sound & L::le(end, kinetic.start + slack));
            if !sound.any() {
                break;
            }
        }
        !sound.bits()
    }
}

/// Mass and reach of eight strands, which scale their bounds.
#[derive(Clone, Copy)]
struct Bounds<L> {
    /// Mass of all links, kg.
    mass: L,
    /// Largest coordinate, metres.
    reach: L,
}

impl<L: Lanes> Bounds<L> {
    #[inline(always)]
    fn of(links: &[Link], ends: &StrandEnds<'_, L>) -> Self {
        let mut bounds = Self { mass: L::splat(0.0), reach: L::splat(0.0) };
        for (i, link) in links.iter().enumerate() {
            bounds.mass = bounds.mass + L::load(&link.mass).masked(ends.tips.within(all::<L>(), i));
            bounds.reach = L::max(bounds.reach, largest(load::<L>(&link.position)));
        }
        Self { mass: ends.sum(bounds.mass), reach: ends.largest(bounds.reach) }
    }
}

/// Returns the mask of the first `count` lanes.
#[inline(always)]
fn first_lanes<L: Lanes>(count: usize) -> L::Mask {
    let mut numbers = [0.0; WIDTH];
    for (lane, number) in numbers.iter_mut().enumerate() {
        *number = lane as f32;
    }
    L::lt(L::load(&numbers), L::splat(count as f32))
}

impl<L: Lanes> StrandEnds<'_, L> {
    /// Sum over the lanes of each strand.
    #[inline(always)]
    fn sum(&self, of_lanes: L) -> L {
        if self.cuts.is_some() { whole_sum(of_lanes) } else { of_lanes }
    }

    /// Largest value over the lanes of each strand.
    #[inline(always)]
    fn largest(&self, of_lanes: L) -> L {
        if self.cuts.is_some() { whole_max(of_lanes) } else { of_lanes }
    }

    /// True where the mask is true in every lane of the strand.
    #[inline(always)]
    fn every(&self, in_lanes: L::Mask) -> L::Mask {
        if self.cuts.is_some() { whole_all::<L>(in_lanes) } else { in_lanes }
    }
}

/// Solves the joints exactly, then by SHAKE. A correction that does not halve the gap is the last one; a correction that widens the gap is
/// undone. Returns the lanes in which no safeguard acts.
#[inline(always)]
fn solve<L: Lanes>(
    links: &mut [Link],
    ends: &mut StrandEnds<'_, L>,
    pace: &Pace,
    kinetic: Kinetic<L>,
    bounds: Bounds<L>,
    used: L::Mask,
) -> L::Mask {
    let Pace { h, .. } = *pace;
    let mut widest = L::splat(0.0);
    for link in links.iter() {
        widest = L::max(widest, largest(load::<L>(&link.gap)));
    }
    let widest = ends.largest(widest);
    // Joints with larger gaps close over several substeps.
    let mut sound = L::le(widest, L::splat(CLOSING_SPEED * h));
    ascend(links, ends, Asked::Closed, h);
    let mut error = descend_ahead(links, ends, all::<L>(), h);
    sound = sound & turn_within::<L>(links, MAX_INNER_TURN / h);
    let tolerance = L::max(L::splat(POSITION_TOLERANCE), bounds.reach * L::splat(POSITION_ROUNDING));
    let mut going = used & L::ge(error, tolerance);
    for _ in 0..POSITION_CORRECTIONS {
        if !going.any() {
            break;
        }
        ascend(links, ends, Asked::Corrected, h);
        let left = descend_ahead(links, ends, going, h);
        let worse = going & L::gt(left, error);
        if worse.any() {
            take_back(links, ends, worse, h);
        }
        let better = L::lt(left, L::splat(0.5) * error);
        error = L::select(going & !worse, left, error);
        going = going & better & L::ge(left, tolerance);
    }
    sound = sound & L::lt(error, L::splat(TORN)) & is_sane::<L>(links, pace);
    if ends.hook.is_some() {
        // Links rise at most as far as their kinetic energy allows.
        let there = kinetic.before + L::max(kinetic.before, bounds.mass) * L::splat(ENERGY_SLACK);
        sound = sound & L::le(-ends.sum(work_of_forces::<L>(links, pace)), there);
    }
    sound
}

/// Brings the joint velocities to zero at the new pose (RATTLE). Very unequal masses need more than one solve.
#[inline(always)]
fn relax<L: Lanes>(links: &mut [Link], ends: &mut StrandEnds<'_, L>, h: f32, used: L::Mask) {
    let mut going = used;
    for _ in 0..=REFINEMENTS {
        ascend(links, ends, Asked::Rest, h);
        let left = descend(links, ends, going);
        going = going & L::gt(left.rate, left.fastest * L::splat(RATE_SHARE));
        if !going.any() {
            break;
        }
    }
}

/// Lanes in which every link turns more slowly than the limit, rad/s.
#[inline(always)]
fn turn_within<L: Lanes>(links: &[Link], most: f32) -> L::Mask {
    let most = L::splat(most * most);
    let mut within = L::le(most, most);
    for link in links {
        let spin = load::<L>(&link.spin);
        within = within & L::le(spin.dot(spin), most);
    }
    within
}

/// Lanes in which all velocities are finite and within the limits of the world.
#[inline(always)]
fn is_sane<L: Lanes>(links: &[Link], pace: &Pace) -> L::Mask {
    let (speed, turn) = (L::splat(DIVERGED_SPEED * pace.max_speed), L::splat(DIVERGED_SPIN));
    let mut sane = L::le(speed, speed);
    for link in links {
        sane = sane & L::lt(largest(load::<L>(&link.velocity)), speed);
        sane = sane & L::lt(largest(load::<L>(&link.spin)), turn);
    }
    sane
}

#[cfg(test)]
mod tests {
    use super::super::super::flight::{put, take};
    use super::*;
    use sinew_math::dispatch::{self, Level, run_at};
    use sinew_math::{Random, Vec3};

    const PACE: Pace = Pace { h: 1.0 / 240.0, substeps: 4, max_speed: 4000.0, max_spin: 377.0 };

    fn advance<'a>(links: &'a mut [Link], hook: Option<&'a Hook>, lanes: usize) -> Advance<'a> {
        Advance { links, hook, cuts: None, full: &[1.0; WIDTH], pace: PACE, lanes }
    }

    /// Horizontal strands that swing, each with its own masses and velocities.
    fn random_links(count: usize) -> Vec<Link> {
        let mut random = Random::new(5);
        let mut links = vec![Link::EMPTY; count];
        for (i, link) in links.iter_mut().enumerate() {
            for lane in 0..WIDTH {
                let mass = random.range(0.5, 20.0);
                link.mass[lane] = mass;
                put(Vec3::new(0.02, 0.03, 0.001) * mass, &mut link.inertia, lane);
                put(Vec3::Z * -0.2, &mut link.anchor, lane);
                put(Vec3::Z * 0.2, &mut link.parent_anchor, lane);
                put(super::super::stiffness_of(Vec3::Z), &mut link.stiffness, lane);
                put(super::super::stiffness_of(Vec3::Z), &mut link.parent_stiffness, lane);
                put(Vec3::Z * (0.4 * i as f32 + 0.2), &mut link.position, lane);
                put(Vec3::Y * -9.81, &mut link.acceleration, lane);
                put(random.direction() * 2.0, &mut link.velocity, lane);
                put(random.direction() * 3.0, &mut link.spin, lane);
            }
        }
        links
    }

    fn bits(links: &[Link], lane: usize) -> Vec<u32> {
        let mut bits = Vec::new();
        for link in links {
            for of in [&link.position, &link.velocity, &link.spin, &link.force, &link.pushed, &link.turned] {
                bits.extend(take(of, lane).to_array().map(f32::to_bits));
            }
            bits.extend(link.rotation.map(|row| row[lane].to_bits()));
        }
        bits
    }

    #[test]
    fn strands_have_the_same_bits_at_every_simd_level_and_alone() {
        for hook in [Some(&Hook::EMPTY), None] {
            let step = |level: Level| {
                let mut links = random_links(6);
                let left = run_at(level, advance(&mut links, hook, WIDTH));
                assert_eq!(left, 0, "{level:?}");
                links
            };
            let expected = step(Level::Scalar);
            assert_ne!(bits(&expected, 0), bits(&random_links(6), 0));
            for level in Level::available() {
                let links = step(level);
                assert!((0..WIDTH).all(|lane| bits(&links, lane) == bits(&expected, lane)), "{level:?}");
            }
            let mut links = random_links(6);
            let left = dispatch::run(Alone(advance(&mut links, hook, 1)));
            assert_eq!((left, bits(&links, 0)), (0, bits(&expected, 0)));
        }
    }

    #[test]
    fn non_finite_lane_is_rejected_and_leaves_other_lanes_unchanged() {
        let mut expected = random_links(4);
        dispatch::run(advance(&mut expected, None, WIDTH));
        let mut links = random_links(4);
        put(Vec3::splat(f32::NAN), &mut links[2].velocity, 3);
        put(Vec3::X * 1e6, &mut links[1].position, 5);
        let left = dispatch::run(advance(&mut links, None, WIDTH));
        assert_eq!(left, 1 << 3 | 1 << 5);
        for lane in [0, 1, 2, 4, 6, 7] {
            assert_eq!(bits(&links, lane), bits(&expected, lane), "{lane}");
        }
    }

    /// Distributes the links of the first lane over eight lanes.
    fn cut(whole: &[Link]) -> (Vec<Link>, Eight) {
        let (least, longer) = (whole.len() / WIDTH, whole.len() % WIDTH);
        let mut links = vec![Link::EMPTY; whole.len().div_ceil(WIDTH)];
        let (mut full, mut rest) = ([1.0; WIDTH], whole);
        for lane in 0..WIDTH {
            let piece;
            (piece, rest) = rest.split_at(least + usize::from(lane < longer));
            for (link, from) in links.iter_mut().zip(piece) {
                link.copy_lane(lane, from, 0);
            }
            full[lane] = f32::from(u8::from(piece.len() == links.len()));
        }
        (links, full)
    }

    /// Largest gap of all joints, metres; unused lanes have none.
    fn widest(links: &[Link]) -> f32 {
        links.iter().flat_map(|link| link.gap.as_flattened()).fold(0.0, |most, gap| f32::max(most, gap.abs()))
    }

    #[test]
    fn strand_cut_into_pieces_moves_as_the_whole_strand() {
        for (count, hook) in [(24, Some(&Hook::EMPTY)), (29, Some(&Hook::EMPTY)), (26, None), (40, None)] {
            let mut whole = random_links(count);
            for link in &mut whole {
                let slower = |row: &mut Eight| *row = row.map(|number| 0.3 * number);
                link.velocity.iter_mut().chain(&mut link.spin).for_each(slower);
            }
            let (links, full) = cut(&whole);
            let left = dispatch::run(Alone(advance(&mut whole, hook, 1)));
            assert_eq!(left, 0, "{count} links");
            let (open, mut results) = (widest(&whole), Vec::new());
            for level in Level::available() {
                let (mut links, mut cuts) = (links.clone(), Cuts::EMPTY);
                let (cuts, full, lanes) = (Some(&mut cuts), &full, WIDTH);
                let advance = Advance { links: &mut links, hook, cuts, full, pace: PACE, lanes };
                assert_eq!(run_at(level, advance), 0, "{count} links, {level:?}");
                results.push((0..WIDTH).map(|lane| bits(&links, lane)).collect::<Vec<_>>());
                let mut whole = whole.iter();
                for (lane, full) in full.iter().enumerate() {
                    let length = links.len() - usize::from(*full == 0.0);
                    for (link, expected) in links[..length].iter().zip(&mut whole) {
                        for (of, from, most) in [
                            (&link.position, &expected.position, 2e-5),
                            (&link.velocity, &expected.velocity, 2e-3),
                            (&link.spin, &expected.spin, 1e-2),
                        ] {
                            let off = (take(of, lane) - take(from, 0)).length();
                            assert!(off < most, "{count} links, lane {lane}: off by {off}");
                        }
                    }
                }
                assert!(whole.next().is_none());
                // Corrections end when those of the whole strand do, so the remaining gaps are similar.
                assert!(widest(&links) < 2.0 * open + 1e-6, "{count} links: {} m", widest(&links));
            }
            assert!(results.iter().all(|result| *result == results[0]), "{count} links");
        }
    }
}
