//! Number and sizes of random cases.

use sinew_math::{Random, Vec3};

/// Returns the number of cases to run of `all`: a hundredth unless `SINEW_FULL` is set, as `cargo xtask ci --full` does.
pub fn cases(all: u32) -> u32 {
    if std::env::var_os("SINEW_FULL").is_some() { all } else { all / 100 }
}

/// Returns half extents between 0.2 and 1 of `scale`; in a quarter of the cases some of them are 0.
pub fn half_extents(scale: f32, random: &mut Random) -> Vec3 {
    let flat = random.index(4) == 0;
    let mut side = || if flat && random.index(2) == 0 { 0.0 } else { scale * random.range(0.2, 1.0) };
    Vec3::new(side(), side(), side())
}
