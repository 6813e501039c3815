//! Random numbers for the calls of a life: round, equal, at their bounds, zero, huge, or arbitrary.

use sinew_math::{Random, Rotation, Transform, Vec3};
use sinew_physics::Velocity;

/// Kind of numbers that a life uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taste {
    /// A few round numbers, such as people write.
    Round,
    /// The same number for all calls with the same range.
    Equal,
    /// The smallest or the largest number of the range.
    Bounds,
    /// Any number of the range.
    Any,
}

/// Range of the arguments of a life's calls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Temper {
    /// Sizes and speeds that are usual in games.
    Calm,
    /// Like `Calm`, but sometimes extreme numbers, up to the largest possible.
    Wild,
}

/// Source of the numbers for one deed.
pub struct Numbers {
    random: Random,
    pub taste: Taste,
    pub temper: Temper,
}

const HUGE: [f32; 7] = [1e3, 1e6, 1e9, 1e12, 1e20, 1e30, f32::MAX];
const TINY: [f32; 4] = [0.0, 1e-3, 1e-12, f32::MIN_POSITIVE];
const ROUND: [f32; 9] = [0.0, 0.1, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 100.0];
/// Share of extreme numbers in a wild life.
const WILD_SHARE: f32 = 0.08;

impl Numbers {
    pub fn new(seed: u64, taste: Taste, temper: Temper) -> Self {
        Self { random: Random::new(seed), taste, temper }
    }

    /// Returns arbitrary bits, by which deeds choose.
    pub fn bits(&mut self) -> u64 {
        self.random.bits()
    }

    pub fn chance(&mut self, probability: f32) -> bool {
        self.random.unit() < probability
    }

    pub fn index(&mut self, count: usize) -> usize {
        self.random.index(count)
    }

    pub fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.random.index(all.len())]
    }

    /// Returns a number of a range, according to the taste of the life.
    pub fn between(&mut self, lo: f32, hi: f32) -> f32 {
        match self.taste {
            Taste::Any => self.random.range(lo, hi),
            Taste::Bounds => self.one_of(&[lo, hi]),
            Taste::Equal => lo + 0.5 * (hi - lo),
            Taste::Round => {
                let inside = |x: &f32| (lo..=hi).contains(x);
                let round: Vec<f32> = ROUND.iter().copied().filter(inside).collect();
                if round.is_empty() { hi } else { self.one_of(&round) }
            }
        }
    }

    /// Returns a number of either sign, at most this far from 0; in a wild life sometimes extreme.
    pub fn signed(&mut self, most: f32) -> f32 {
        let sign = if self.chance(0.5) { 1.0 } else { -1.0 };
        if self.is_wild() {
            let all = if self.chance(0.7) { self.one_of(&HUGE) } else { self.one_of(&TINY) };
            return sign * all;
        }
        if self.chance(0.2) { 0.0 } else { sign * self.between(0.0, most) }
    }

    /// Returns a number of a non-negative range; in a wild life sometimes an extreme one.
    pub fn least(&mut self, lo: f32, hi: f32) -> f32 {
        if self.is_wild() { self.one_of(&HUGE) } else { self.between(lo, hi) }
    }

    fn is_wild(&mut self) -> bool {
        self.temper == Temper::Wild && self.chance(WILD_SHARE)
    }

    pub fn vector(&mut self, most: f32) -> Vec3 {
        Vec3::new(self.signed(most), self.signed(most), self.signed(most))
    }

    /// Returns a direction for a joint or a surface.
    pub fn direction(&mut self) -> Vec3 {
        match self.taste {
            Taste::Any => self.random.direction(),
            _ => self.one_of(&[Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_Y]),
        }
    }

    pub fn rotation(&mut self) -> Rotation {
        let quarter = core::f32::consts::FRAC_PI_2;
        match self.taste {
            Taste::Any => {
                if self.chance(0.6) {
                    self.random.rotation()
                } else {
                    Rotation::IDENTITY
                }
            }
            Taste::Equal => Rotation::IDENTITY,
            _ => {
                let axis = self.direction();
                let turns = self.index(4) as f32;
                Rotation::from_axis_angle(axis, quarter * turns)
            }
        }
    }

    /// Returns a point above the floor, near the other objects.
    pub fn place(&mut self) -> Vec3 {
        let (x, z) = (self.signed(3.0), self.signed(3.0));
        Vec3::new(x, self.between(0.5, 3.0), z)
    }

    pub fn pose(&mut self) -> Transform {
        Transform::new(self.place(), self.rotation())
    }

    pub fn velocity(&mut self) -> Velocity {
        Velocity { linear: self.vector(5.0), angular: self.vector(5.0) }
    }
}
