//! Sides of triangles that are longer than in the bind pose: where the skin tears.

use super::surface::{Side, Surface};
use crate::tuning::STRETCH_PERCENTILE;
use sinew_math::{Affine, max};

/// Growth of sides beyond their bind length, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Stretched {
    /// 99.9th percentile over the sides of all triangles and all poses.
    pub p999: f32,
    /// Largest growth of a side.
    pub max: f32,
    /// Index of the side with the largest growth, in [`Surface::sides`].
    pub side: Option<usize>,
}

/// Collects the growth of triangle edges over poses.
pub(super) struct Stretch {
    /// Length of each edge in the bind pose, metres.
    bound: Vec<f32>,
    /// Growth of each side in each pose, metres.
    longer: Vec<f32>,
    /// Metres per unit of the model space.
    unit_scale: f32,
    worst: Stretched,
}

impl Stretch {
    /// Creates the collection; `palette` belongs to the bind pose.
    pub fn new(surface: &Surface, palette: &[Affine], unit_scale: f32) -> Self {
        let bound = surface.sides.iter().map(|side| length(surface, palette, side) * unit_scale).collect();
        Self { bound, longer: Vec::new(), unit_scale, worst: Stretched::default() }
    }

    /// Adds a pose by its palette, model space.
    pub fn add(&mut self, surface: &Surface, palette: &[Affine]) {
        for (index, side) in surface.sides.iter().enumerate() {
            let longer = length(surface, palette, side) * self.unit_scale - self.bound[index];
            // A side that is not finite counts as infinitely long.
            let longer = if longer.is_finite() { max(longer, 0.0) } else { f32::INFINITY };
            self.longer.push(longer);
            if longer > self.worst.max {
                (self.worst.max, self.worst.side) = (longer, Some(index));
            }
        }
    }

    /// Returns the metrics over all poses since the last call; zeros where no side can stretch.
    pub fn take(&mut self, surface: &Surface) -> Stretched {
        let mut longer = core::mem::take(&mut self.longer);
        let worst = core::mem::take(&mut self.worst);
        // Sides that no pose stretches rank below the others.
        let share = 1.0 - (1.0 - STRETCH_PERCENTILE) / max(surface.stretchable, 1e-6);
        if longer.is_empty() || share <= 0.0 {
            return worst;
        }
        let rank = ((longer.len() as f64 * f64::from(share)) as usize).min(longer.len() - 1);
        let (_, &mut p999, _) = longer.select_nth_unstable_by(rank, f32::total_cmp);
        Stretched { p999, ..worst }
    }
}

/// Returns the length of all sides together, in units of the model space.
pub(super) fn total(surface: &Surface, palette: &[Affine]) -> f32 {
    surface.sides.iter().map(|side| length(surface, palette, side)).filter(|length| length.is_finite()).sum()
}

fn length(surface: &Surface, palette: &[Affine], &Side(a, b): &Side) -> f32 {
    (surface.place(palette, a) - surface.place(palette, b)).length()
}
