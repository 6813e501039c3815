//! Kernels and their data.

use crate::counted::{self, Operations};
use sinew_geometry::boxes::Obb;
use sinew_geometry::boxes::batch::{
    Axes, ContainsPoints, FindOverlaps, FindSeparations, Pairs, Points, Separations, SignedDistances,
};
use sinew_math::dispatch::{self, Level};
use sinew_math::{Random, Vec3};
use std::hint::black_box;

/// Number of points: with their results they fit the second-level cache.
const POINTS: usize = 8_192;

/// Number of pairs, for the same reason.
const PAIRS: usize = 2_048;

/// A kernel and its data.
pub struct Work {
    /// Name in the table.
    pub name: &'static str,
    kind: Kind,
}

enum Kind {
    Contains { obb: Obb, points: Points, inside: Vec<u8> },
    Distances { obb: Obb, points: Points, distances: Vec<f32> },
    Overlaps { pairs: Pairs, overlapping: Vec<u8> },
    Separations { axes: Axes, pairs: Pairs, found: Separations },
}

/// Returns all kernels.
pub fn all() -> Vec<Work> {
    let mut random = Random::new(7);
    let obb = cuboid(&mut random);
    let points: Points = (0..POINTS).map(|_| random.in_cube() * 2.0).collect();
    let mut pairs = Pairs::new();
    for _ in 0..PAIRS {
        let (a, b) = (cuboid(&mut random), cuboid(&mut random));
        pairs.push(&a, &b);
    }
    let separations = |axes| Kind::Separations { axes, pairs: pairs.clone(), found: Separations::new() };
    let work = |name, kind| Work { name, kind };
    vec![
        work("point_in_obb", Kind::Contains { obb, points: points.clone(), inside: vec![0; POINTS / 8] }),
        work("point_obb_distance", Kind::Distances { obb, points, distances: vec![0.0; POINTS] }),
        work("obb_obb_overlap", Kind::Overlaps { pairs: pairs.clone(), overlapping: vec![0; PAIRS / 8] }),
        work("obb_obb_6_axes", separations(Axes::Faces)),
        work("obb_obb_15_axes", separations(Axes::Fifteen)),
    ]
}

/// Returns a box near the origin: about half of the pairs overlap.
fn cuboid(random: &mut Random) -> Obb {
    let mut half = || random.range(0.2, 0.8);
    let half_extents = Vec3::new(half(), half(), half());
    Obb::new(random.in_cube(), random.rotation(), half_extents)
}

impl Work {
    /// Returns the number of items of a run.
    pub fn items(&self) -> usize {
        match &self.kind {
            Kind::Contains { points, .. } | Kind::Distances { points, .. } => points.len(),
            Kind::Overlaps { pairs, .. } | Kind::Separations { pairs, .. } => pairs.len(),
        }
    }

    /// Runs once over the data.
    pub fn run_at(&mut self, level: Level) {
        match &mut self.kind {
            Kind::Contains { obb, points, inside } => {
                dispatch::run_at(level, ContainsPoints { obb: black_box(obb), points, inside });
                black_box(inside);
            }
            Kind::Distances { obb, points, distances } => {
                dispatch::run_at(level, SignedDistances { obb: black_box(obb), points, distances });
                black_box(distances);
            }
            Kind::Overlaps { pairs, overlapping } => {
                dispatch::run_at(level, FindOverlaps { pairs, overlapping });
                black_box(overlapping);
            }
            Kind::Separations { axes, pairs, found } => {
                dispatch::run_at(level, FindSeparations { pairs, axes: *axes, found });
                black_box(found);
            }
        }
    }

    /// Returns the operations of a run.
    pub fn operations(&self) -> Operations {
        match &self.kind {
            Kind::Contains { obb, points, inside } => {
                counted::count(ContainsPoints { obb, points, inside: &mut inside.clone() })
            }
            Kind::Distances { obb, points, distances } => {
                counted::count(SignedDistances { obb, points, distances: &mut distances.clone() })
            }
            Kind::Overlaps { pairs, overlapping } => {
                counted::count(FindOverlaps { pairs, overlapping: &mut overlapping.clone() })
            }
            Kind::Separations { axes, pairs, found } => {
                counted::count(FindSeparations { pairs, axes: *axes, found: &mut found.clone() })
            }
        }
    }
}
