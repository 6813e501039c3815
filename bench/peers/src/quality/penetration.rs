//! Penetration of shapes.

use super::collides;
use crate::engine::{BodyState, Unsupported};
use crate::parry;
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::math::Pose;
use parry3d::query::sat;
use parry3d::shape::{Cuboid, SharedShape};
use sinew::math::Transform;
use sinew::physics::{BodyKind, Filter};
use sinew_scenes::blueprint::Blueprint;

/// Depths of the pairs of shapes that may collide, metres.
#[derive(Clone, Debug, PartialEq)]
pub struct PenetrationQuality {
    /// Largest depth at the end.
    pub end_max: f32,
    /// 99th percentile of the overlaps at the end.
    pub end_p99: f32,
    /// Largest depth after any measured step.
    pub run_max: f32,
    /// Interval of measured steps.
    pub every: usize,
}

pub(super) struct PenetrationMeter {
    shapes: Vec<Solid>,
    /// Pairs of bodies that do not collide because joints connect them or the scene disables them; the smaller index
    /// first, sorted.
    apart: Vec<(usize, usize)>,
    every: usize,
    run_max: f32,
}

/// A shape that can collide.
struct Solid {
    body: usize,
    is_dynamic: bool,
    filter: Filter,
    body_from_shape: Transform,
    shape: SharedShape,
}

impl PenetrationMeter {
    pub fn new(scene: &Blueprint, every: usize) -> Self {
        // Depths need all shapes of the scene: if Parry lacks one, no depth is measured.
        let shapes = Self::solids(scene).unwrap_or_default();
        let mut apart: Vec<_> = scene.joints.iter().map(|joint| ordered(joint.a, joint.b)).collect();
        apart.extend(scene.apart.iter().map(|&(a, b)| ordered(a, b)));
        apart.sort_unstable();
        Self { shapes, apart, every, run_max: 0.0 }
    }

    fn solids(scene: &Blueprint) -> Result<Vec<Solid>, Unsupported> {
        let mut solids = Vec::new();
        for (body, def) in scene.bodies.iter().enumerate() {
            for part in def.shapes.iter().filter(|part| collides(part)) {
                solids.push(Solid {
                    body,
                    is_dynamic: def.kind == BodyKind::Dynamic,
                    filter: part.filter,
                    body_from_shape: part.body_from_shape,
                    shape: parry::shape(&part.shape)?,
                });
            }
        }
        Ok(solids)
    }

    pub fn observe(&mut self, step: usize, states: &[BodyState]) {
        if step.is_multiple_of(self.every) {
            self.run_max = self.depths(states).into_iter().fold(self.run_max, f32::max);
        }
    }

    pub fn finish(&mut self, states: &[BodyState]) -> Option<PenetrationQuality> {
        if self.shapes.is_empty() {
            return None;
        }
        let mut depths = self.depths(states);
        depths.sort_unstable_by(f32::total_cmp);
        let end_max = depths.last().copied().unwrap_or(0.0);
        let rank = (depths.len() * 99).div_ceil(100);
        let end_p99 = if depths.is_empty() { 0.0 } else { depths[rank - 1] };
        Some(PenetrationQuality { end_max, end_p99, run_max: self.run_max.max(end_max), every: self.every })
    }

    /// Returns the depth of each pair that overlaps.
    fn depths(&self, states: &[BodyState]) -> Vec<f32> {
        let placed = self.shapes.iter().map(|shape| {
            let pose = parry::pose(states[shape.body].world_from_body * shape.body_from_shape);
            PlacedShape { shape, pose, bounds: shape.shape.compute_aabb(&pose) }
        });
        let mut placed: Vec<_> = placed.filter(PlacedShape::is_finite).collect();
        // Sweep along x: only shapes that start before another ends can overlap it.
        placed.sort_by(|a, b| a.bounds.mins.x.total_cmp(&b.bounds.mins.x));
        let mut depths = Vec::new();
        for (i, a) in placed.iter().enumerate() {
            let near = placed[i + 1..].iter().take_while(|b| b.bounds.mins.x <= a.bounds.maxs.x);
            let near = near.filter(|b| a.bounds.intersects(&b.bounds) && self.may_collide(a.shape, b.shape));
            depths.extend(near.filter_map(|b| a.depth_in(b)));
        }
        depths
    }

    fn may_collide(&self, a: &Solid, b: &Solid) -> bool {
        a.body != b.body
            && (a.is_dynamic || b.is_dynamic)
            && a.filter.meets(b.filter)
            && self.apart.binary_search(&ordered(a.body, b.body)).is_err()
    }
}

/// A shape in its current pose.
struct PlacedShape<'a> {
    shape: &'a Solid,
    pose: Pose,
    bounds: Aabb,
}

impl PlacedShape<'_> {
    /// Returns true if the pose is finite. Bodies with NaN count as lost, not as penetrating.
    fn is_finite(&self) -> bool {
        self.pose.is_finite()
    }

    fn depth_in(&self, other: &Self) -> Option<f32> {
        let depth = depth_of_shapes(&self.pose, &self.shape.shape, &other.pose, &other.shape.shape)?;
        // Separating the bounding boxes separates the shapes, so the depth cannot be larger.
        let overlap = self.bounds.maxs.min(other.bounds.maxs) - self.bounds.mins.max(other.bounds.mins);
        Some(depth.min(overlap.min_element()))
    }
}

/// Returns the smallest distance that separates two shapes, metres; `None` if they are apart.
fn depth_of_shapes(pose_a: &Pose, a: &SharedShape, pose_b: &Pose, b: &SharedShape) -> Option<f32> {
    if let (Some(a), Some(b)) = (a.as_cuboid(), b.as_cuboid()) {
        return depth_of_boxes(pose_a, a, pose_b, b);
    }
    let contact = parry3d::query::contact(pose_a, &**a, pose_b, &**b, 0.0);
    let contact = contact.expect("Parry supports every pair of our shapes")?;
    (contact.dist < 0.0).then_some(-contact.dist)
}

/// Returns the depth along the axis of least overlap of two boxes. Parry's `contact` finds the axis too, but measures
/// the depth from the nearest face to a corner, which may be at the other side: 3 m for a cube of 1 m on a slab of 2 m.
fn depth_of_boxes(pose_a: &Pose, a: &Cuboid, pose_b: &Pose, b: &Cuboid) -> Option<f32> {
    let b_in_a = pose_a.inv_mul(pose_b);
    let (faces_of_a, _) = sat::cuboid_cuboid_find_local_separating_normal_oneway(a, b, &b_in_a);
    let (faces_of_b, _) = sat::cuboid_cuboid_find_local_separating_normal_oneway(b, a, &b_in_a.inverse());
    let (edges, _) = sat::cuboid_cuboid_find_local_separating_edge_twoway(a, b, &b_in_a);
    let separation = faces_of_a.max(faces_of_b).max(edges);
    (separation < 0.0).then_some(-separation)
}

fn ordered(a: usize, b: usize) -> (usize, usize) {
    if a < b { (a, b) } else { (b, a) }
}
