//! Seeded noise that is smooth in space and time.

use sinew_math::{Random, Vec3};

/// Value noise at a position (in cells) and a time (a cell and a fraction, 0..1): each component is in −1..=1.
pub(super) fn turbulence(place: Vec3, (time, within): (u64, f32), seed: u64) -> Vec3 {
    // Positions beyond the integer range saturate: the noise is constant there.
    let floor = Vec3::new(place.x.floor(), place.y.floor(), place.z.floor());
    let cell = [floor.x, floor.y, floor.z].map(|x| x as i64 as u64);
    let between = place - floor;
    let blend = [between.x, between.y, between.z, within].map(|u| u * u * (3.0 - 2.0 * u));
    let mut sum = Vec3::ZERO;
    for corner in 0..16u64 {
        let mut weight = 1.0;
        for (k, u) in blend.iter().enumerate() {
            weight *= if corner >> k & 1 == 1 { *u } else { 1.0 - u };
        }
        let at = |k: usize| cell[k].wrapping_add(corner >> k & 1);
        sum += lattice([at(0), at(1), at(2), time.wrapping_add(corner >> 3)], seed) * weight;
    }
    sum
}

/// Random vector of a lattice point, uniform in the cube −1..1: hashes each coordinate into the state.
fn lattice(cell: [u64; 4], seed: u64) -> Vec3 {
    let mut state = seed;
    for x in cell {
        state = Random::new(state ^ x).bits();
    }
    Random::new(state).in_cube()
}
