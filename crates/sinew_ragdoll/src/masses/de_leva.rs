//! Anthropometry of adults: P. de Leva, "Adjustments to Zatsiorsky-Seluyanov's segment inertia parameters",
//! Journal of Biomechanics 29 (1996), table 4.
//!
//! ```
//! use sinew_ragdoll::Sex;
//! use sinew_ragdoll::masses::de_leva::table;
//!
//! let male = table(Sex::Male);
//! let thigh = male.thigh.mass * male.reference_mass;
//! assert!((thigh - 10.3).abs() < 0.1, "{thigh} kg");
//! ```

/// Sex, which selects body proportions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sex {
    /// Male: 73.0 kg at 1.741 m.
    #[default]
    Male,
    /// Female: 61.9 kg at 1.735 m.
    Female,
}

/// Mass distribution of one segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Share of the body's mass.
    pub mass: f32,
    /// Distance of the centre of mass from the proximal end, as a share of the segment's length.
    pub center: f32,
    /// Radii of gyration about the centre, shares of the length: about the sagittal (fore and aft), transverse
    /// (side to side) and longitudinal axis.
    pub gyration: [f32; 3],
}

const fn segment(mass: f32, center: f32, sagittal: f32, transverse: f32, longitudinal: f32) -> Segment {
    Segment {
        mass: mass / 100.0,
        center: center / 100.0,
        gyration: [sagittal / 100.0, transverse / 100.0, longitudinal / 100.0],
    }
}

/// The table of one sex. Limb segments appear once: both sides are equal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Table {
    /// Mass of the reference body, kg.
    pub reference_mass: f32,
    /// Height of the reference body, metres.
    pub reference_height: f32,
    /// Mass of head and neck, as a share of the body's mass.
    pub head: f32,
    /// Upper, middle and lower trunk: share of the body's mass, and length in millimetres.
    pub trunk: [(f32, f32); 3],
    /// Segment from shoulder to elbow.
    pub upper_arm: Segment,
    /// Segment from elbow to wrist.
    pub forearm: Segment,
    /// Segment from wrist to third metacarpal.
    pub hand: Segment,
    /// Segment from hip to knee.
    pub thigh: Segment,
    /// Segment from knee to ankle.
    pub shank: Segment,
    /// Segment from heel to toe tip.
    pub foot: Segment,
}

/// Share of the neck in head and neck: 1.2 % of the body's mass. The table combines the two; the neck is separated as a
/// cylinder 11 cm wide and 10 cm high.
pub const NECK_OF_HEAD: f32 = 0.17;
/// Share of each shoulder girdle in the upper trunk, if it is a separate body.
pub const GIRDLE_OF_UPPER_TRUNK: f32 = 0.10;
/// Share of the toes in the foot, if the toes are a body of their own.
pub const TOES_OF_FOOT: f32 = 0.2;

const MALE: Table = Table {
    reference_mass: 73.0,
    reference_height: 1.741,
    head: 0.0694,
    trunk: [(0.1596, 170.7), (0.1633, 215.5), (0.1117, 145.7)],
    upper_arm: segment(2.71, 57.72, 28.5, 26.9, 15.8),
    forearm: segment(1.62, 45.74, 27.6, 26.5, 12.1),
    hand: segment(0.61, 79.00, 62.8, 51.3, 40.1),
    thigh: segment(14.16, 40.95, 32.9, 32.9, 14.9),
    shank: segment(4.33, 44.59, 25.5, 24.9, 10.3),
    foot: segment(1.37, 44.15, 25.7, 24.5, 12.4),
};

const FEMALE: Table = Table {
    reference_mass: 61.9,
    reference_height: 1.735,
    head: 0.0668,
    trunk: [(0.1545, 142.5), (0.1465, 205.3), (0.1247, 181.5)],
    upper_arm: segment(2.55, 57.54, 27.8, 26.0, 14.8),
    forearm: segment(1.38, 45.59, 26.1, 25.7, 9.4),
    hand: segment(0.56, 74.74, 53.1, 45.4, 33.5),
    thigh: segment(14.78, 36.12, 36.9, 36.4, 16.2),
    shank: segment(4.81, 44.16, 27.1, 26.7, 9.3),
    foot: segment(1.29, 40.14, 29.9, 27.9, 13.9),
};

/// Returns the table of a sex.
pub fn table(sex: Sex) -> &'static Table {
    match sex {
        Sex::Male => &MALE,
        Sex::Female => &FEMALE,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_table_adds_up_to_a_whole_body() {
        for sex in [Sex::Male, Sex::Female] {
            let t = table(sex);
            let limbs = [t.upper_arm, t.forearm, t.hand, t.thigh, t.shank, t.foot];
            let total = t.head
                + t.trunk.iter().map(|part| part.0).sum::<f32>()
                + 2.0 * limbs.iter().map(|s| s.mass).sum::<f32>();
            assert!((total - 1.0).abs() < 2e-4, "{sex:?}: {total}");
        }
    }
}
