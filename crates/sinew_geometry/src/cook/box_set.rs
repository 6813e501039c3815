//! A set of boxes: distance to the faces of the boxes, outer surface and volume of their union.

use super::fitted::{bounds, sample_surface};
use crate::boxes::Aabb;
use crate::boxes::{Cuboid, Obb, PlacedBox};
use sinew_math::{Random, Vec3, max3, min};

/// Boxes with their bounds.
pub(super) struct BoxSet<'a> {
    boxes: &'a [Obb],
    placed: Vec<PlacedBox>,
    bounds: Vec<Aabb>,
}

impl<'a> BoxSet<'a> {
    pub fn new(boxes: &'a [Obb]) -> Self {
        let placed = boxes.iter().map(Cuboid::placed).collect();
        Self { boxes, placed, bounds: boxes.iter().map(bounds).collect() }
    }

    /// Distance to the nearest face of any box, metres, for points inside and outside. Infinite without boxes.
    pub fn distance_to_faces(&self, p: Vec3) -> f32 {
        let mut nearest = f32::INFINITY;
        for (placed, bounds) in self.placed.iter().zip(&self.bounds) {
            let outside = max3(max3(bounds.min - p, p - bounds.max), Vec3::ZERO);
            if outside.length_squared() < nearest * nearest {
                nearest = min(nearest, placed.signed_distance(p).abs());
            }
        }
        nearest
    }

    /// Iterates over the boxes that contain a point.
    fn around(&self, p: Vec3) -> impl Iterator<Item = usize> {
        let holds = move |i: &usize| {
            let Aabb { min, max } = self.bounds[*i];
            let within =
                min.x < p.x && p.x < max.x && min.y < p.y && p.y < max.y && min.z < p.z && p.z < max.z;
            within && self.placed[*i].signed_distance(p) < 0.0
        };
        (0..self.placed.len()).filter(holds)
    }

    /// Samples about `count` points of the boxes' faces, uniform by area, and drops those inside another box.
    pub fn outer_surface(&self, count: usize, random: &mut Random) -> Vec<Vec3> {
        let total: f32 = self.boxes.iter().map(Cuboid::surface_area).sum();
        let (mut outer, mut own) = (Vec::new(), Vec::new());
        for (i, block) in self.boxes.iter().enumerate() {
            own.clear();
            let share = (block.surface_area() / total * count as f32).ceil();
            sample_surface(block, share as usize, random, &mut own);
            outer.extend(own.iter().copied().filter(|&p| self.around(p).all(|j| j == i)));
        }
        outer
    }

    /// Estimates the volume of the union, m³: each sample point counts divided by the number of boxes that contain it.
    pub fn volume(&self, random: &mut Random) -> f32 {
        const SAMPLES: usize = 100_000;
        let total: f32 = self.boxes.iter().map(Cuboid::volume).sum();
        let mut volume = 0.0;
        for (block, placed) in self.boxes.iter().zip(&self.placed) {
            let count = usize::max((block.volume() / total * SAMPLES as f32) as usize, 64);
            let mut share = 0.0;
            for _ in 0..count {
                let p = placed.point(random.in_cube() * block.half_extents);
                // Because of rounding, the sample may be just outside its own box.
                share += 1.0 / usize::max(self.around(p).count(), 1) as f32;
            }
            volume += block.volume() * share / count as f32;
        }
        volume
    }
}
