//! Materials of surfaces, and rules that combine the materials of two shapes.

use sinew_geometry::DefError;
use sinew_math::{Vec3, max, min};

/// Material of a shape: friction, restitution, rolling resistance and surface velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
#[doc(alias = "PhysicsMaterial")]
#[doc(alias = "friction")]
#[doc(alias = "restitution")]
#[doc(alias = "bounciness")]
pub struct Material {
    /// Coulomb coefficient of sliding friction, ≥ 0. Default 0.6.
    pub friction: f32,
    /// Static friction coefficient, at least `friction`. `None`, the default: equal to `friction`.
    pub static_friction: Option<f32>,
    /// Coefficient of restitution: ratio of separation speed to approach speed, 0..=1. Default 0.
    pub restitution: f32,
    /// Rolling resistance: lever arm of the resisting torque, metres. Default 0.
    pub rolling: f32,
    /// Velocity of the surface relative to its body, m/s in the shape's frame: a conveyor, a moving walkway. Friction
    /// carries bodies along; the normal component has no effect. Default 0.
    pub surface_velocity: Vec3,
    /// Angular velocity of the surface about the shape's origin, rad/s in the shape's frame: a turntable. Default 0.
    pub surface_spin: Vec3,
    /// Rules that combine this material with that of the other shape.
    pub combine: CombineRules,
    /// User data, for example the substance for sounds. Default 0.
    pub tag: u32,
}

impl Material {
    /// Material with friction 0.6; all other values are zero.
    pub const DEFAULT: Self = Self {
        friction: 0.6,
        static_friction: None,
        restitution: 0.0,
        rolling: 0.0,
        surface_velocity: Vec3::ZERO,
        surface_spin: Vec3::ZERO,
        combine: CombineRules { friction: None, restitution: None, rolling: None },
        tag: 0,
    };

    /// Checks that the numbers of the material are valid; the error phrase names the problem.
    ///
    /// # Errors
    /// Returns a phrase that names the problem, in lower case.
    pub fn check(&self) -> Result<(), DefError> {
        // The comparison is false for NaN.
        let not_negative = |x: f32| (0.0..f32::INFINITY).contains(&x);
        let positive = not_negative(self.friction) && not_negative(self.rolling);
        if !(positive && not_negative(self.restitution)) {
            return Err(DefError::new("friction, restitution and rolling must not be negative, and finite"));
        }
        if !(self.friction..f32::INFINITY).contains(&self.hold()) {
            return Err(DefError::new("static friction must be no less than friction, and finite"));
        }
        if !(self.surface_velocity.is_finite() && self.surface_spin.is_finite()) {
            return Err(DefError::new("the velocity of a surface must be finite"));
        }
        Ok(())
    }

    /// Coefficient of static friction.
    fn hold(&self) -> f32 {
        self.static_friction.unwrap_or(self.friction)
    }

    /// True if the surface moves relative to its body.
    pub(crate) fn runs(&self) -> bool {
        self.surface_velocity != Vec3::ZERO || self.surface_spin != Vec3::ZERO
    }
}

impl Default for Material {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Rule that combines two numbers. If two surfaces request different rules, the one later in this list applies,
/// for either surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Combine {
    /// `(a + b) / 2`.
    Average,
    /// `√(a b)`.
    GeometricMean,
    /// `min(a, b)`.
    Minimum,
    /// `a b`.
    Multiply,
    /// `max(a, b)`.
    Maximum,
}

impl Combine {
    fn of(self, a: f32, b: f32) -> f32 {
        match self {
            Self::Average => 0.5 * (a + b),
            Self::GeometricMean => (a * b).sqrt(),
            Self::Minimum => min(a, b),
            Self::Multiply => a * b,
            Self::Maximum => max(a, b),
        }
    }
}

/// Combination rules of a surface. `None`, the default, leaves the choice to the other surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct CombineRules {
    /// Rule for both coefficients of friction. If neither side requests one: the geometric mean.
    pub friction: Option<Combine>,
    /// Rule for restitution. If neither side requests one: the maximum.
    pub restitution: Option<Combine>,
    /// Rule for rolling resistance. If neither side requests one: the maximum.
    pub rolling: Option<Combine>,
}

impl CombineRules {
    /// Combines the rules of a pair: friction, restitution, rolling.
    fn with(self, other: Self) -> [Combine; 3] {
        // `None` is less than every rule.
        let later = |a: Option<Combine>, b: Option<Combine>, default| Option::max(a, b).unwrap_or(default);
        [
            later(self.friction, other.friction, Combine::GeometricMean),
            later(self.restitution, other.restitution, Combine::Maximum),
            later(self.rolling, other.rolling, Combine::Maximum),
        ]
    }
}

/// Material of a contact: the combination of two materials.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactMaterial {
    /// Coulomb coefficient of sliding friction.
    pub friction: f32,
    /// Static friction coefficient, at least `friction`.
    pub static_friction: f32,
    /// Coefficient of restitution.
    pub restitution: f32,
    /// Lever arm of rolling resistance, metres.
    pub rolling: f32,
    /// Velocity of B's surface minus that of A's at the contact, in addition to the velocities of the bodies, world
    /// axes, m/s: friction brings the surfaces, not the bodies, to relative rest. The normal component has no effect.
    pub velocity: Vec3,
    /// Angular velocity of B's surface minus that of A's, in addition to those of the bodies, world axes, rad/s. Unlike
    /// that of `velocity`, its normal component acts.
    pub spin: Vec3,
    /// Separation speed that the contact enforces, m/s, ≥ 0, for example of a trampoline. Only a
    /// [modifier](crate::ContactModifier) sets it.
    pub launch: f32,
}

impl ContactMaterial {
    /// Contact material of two materials, in either order. Velocities depend on the contact point: they are 0 here.
    pub fn of(a: &Material, b: &Material) -> Self {
        let [friction, restitution, rolling] = a.combine.with(b.combine);
        Self {
            friction: friction.of(a.friction, b.friction),
            static_friction: friction.of(a.hold(), b.hold()),
            restitution: restitution.of(a.restitution, b.restitution),
            rolling: rolling.of(a.rolling, b.rolling),
            ..Self::default()
        }
    }

    /// True if the contact's surfaces move relative to their bodies or launch bodies.
    pub(crate) fn drives(&self) -> bool {
        self.velocity != Vec3::ZERO || self.spin != Vec3::ZERO || self.launch != 0.0
    }

    pub(crate) fn is_valid(&self) -> bool {
        // The comparison is false for NaN.
        let not_negative = |x: f32| (0.0..f32::INFINITY).contains(&x);
        let positive =
            [self.friction, self.restitution, self.rolling, self.launch].into_iter().all(not_negative);
        positive
            && (self.friction..f32::INFINITY).contains(&self.static_friction)
            && self.velocity.is_finite()
            && self.spin.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_math::Random;

    const RULES: [Option<Combine>; 6] = [
        None,
        Some(Combine::Average),
        Some(Combine::GeometricMean),
        Some(Combine::Minimum),
        Some(Combine::Multiply),
        Some(Combine::Maximum),
    ];

    fn random_material(random: &mut Random) -> Material {
        let mut rule = || RULES[(random.unit() * 5.999) as usize];
        let combine = CombineRules { friction: rule(), restitution: rule(), rolling: rule() };
        let friction = random.range(0.0, 1.5);
        let static_friction = (random.unit() < 0.5).then(|| friction + random.unit());
        let (restitution, rolling) = (random.unit(), random.range(0.0, 0.1));
        Material { friction, static_friction, restitution, rolling, combine, ..Material::DEFAULT }
    }

    #[test]
    fn combined_material_is_symmetric_and_static_friction_is_not_below_sliding() {
        let mut random = Random::new(5);
        for _ in 0..100_000 {
            let (a, b) = (random_material(&mut random), random_material(&mut random));
            let surface = ContactMaterial::of(&a, &b);
            assert_eq!(surface, ContactMaterial::of(&b, &a), "{a:?} {b:?}");
            assert!(
                surface.static_friction >= surface.friction,
                "static friction of {a:?} and {b:?} is too low: {surface:?}"
            );
            assert!(surface.is_valid(), "{a:?} and {b:?} give an invalid {surface:?}");
        }
    }

    #[test]
    fn later_combine_rule_wins_and_none_defers_to_the_other_side() {
        let rules = |friction| CombineRules { friction, ..CombineRules::default() };
        for (i, &a) in RULES.iter().enumerate() {
            for (j, &b) in RULES.iter().enumerate() {
                let [taken, ..] = rules(a).with(rules(b));
                assert_eq!(taken, RULES[usize::max(i, j)].unwrap_or(Combine::GeometricMean));
            }
        }
        let value = |rule: Combine| rule.of(0.2, 0.8);
        let all = RULES.into_iter().flatten().map(value).collect::<Vec<_>>();
        let expected = [0.5, 0.4, 0.2, 0.16, 0.8];
        assert!(all.iter().zip(expected).all(|(x, y)| (x - y).abs() < 1e-6), "{all:?}");
    }

    #[test]
    fn invalid_material_numbers_are_named_in_the_error() {
        for wrong in [
            Material { friction: f32::NAN, ..Material::DEFAULT },
            Material { restitution: -0.1, ..Material::DEFAULT },
            Material { static_friction: Some(0.5), ..Material::DEFAULT },
            Material { static_friction: Some(f32::NAN), ..Material::DEFAULT },
            Material { surface_velocity: Vec3::splat(f32::INFINITY), ..Material::DEFAULT },
            Material { surface_spin: Vec3::new(0.0, f32::NAN, 0.0), ..Material::DEFAULT },
        ] {
            assert!(wrong.check().is_err(), "{wrong:?}");
        }
    }
}
