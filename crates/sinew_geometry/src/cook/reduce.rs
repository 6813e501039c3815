//! Reduces a set of boxes: drops or merges the cheapest until the requested number remains.

use super::Scale;
use super::bvh::MeshBvh;
use super::fit::{cluster, orientations};
use super::fitted::{around, bounds, sample_surface};
use super::sample::MeshPoint;
use super::settle::settled;
use super::solid::is_seen_from_inside;
use crate::boxes::{Aabb, Cuboid, Obb, Overlap, PlacedBox};
use sinew_math::{Random, Rotation, Vec3, max3, min};

/// Number of points of a candidate's surface that are compared with the mesh.
const SURFACE: usize = 64;
/// Number of neighbours that a box may merge with.
const NEIGHBORS: usize = 8;

/// A box during the reduction.
#[derive(Clone)]
struct Entry {
    block: Obb,
    placed: PlacedBox,
    bounds: Aabb,
    /// Points of the mesh to which this box is the closest.
    points: Vec<u32>,
    /// Integral of the squared distances to and from the box's surface, m⁴, and the number of boxes at which it was
    /// computed.
    cost: f32,
    seen: usize,
    /// True if the box has been neither dropped nor merged.
    alive: bool,
}

/// A step that removes one box.
#[derive(Clone, Copy)]
enum Step {
    /// Drop a box.
    Drop(usize),
    /// Replaces two boxes by one.
    Merge(usize, usize, Obb),
}

struct Candidate {
    step: Step,
    /// Increase of the integral of squared distances at the last computation, m⁴.
    cost: f32,
    /// Number of boxes at that time.
    seen: usize,
}

/// Boxes, points of the mesh, and candidate reductions.
pub(super) struct Reduction<'a> {
    bvh: &'a MeshBvh,
    points: &'a [MeshPoint],
    /// Area that each mesh point represents, m².
    area: f32,
    scale: Scale,
    entries: Vec<Entry>,
    candidates: Vec<Candidate>,
    left: usize,
}

impl<'a> Reduction<'a> {
    /// Prepares the reduction of `blocks` for a mesh with sample `points`, each of which represents `area` square
    /// metres.
    pub fn new(bvh: &'a MeshBvh, points: &'a [MeshPoint], area: f32, scale: Scale, blocks: &[Obb]) -> Self {
        let entries: Vec<Entry> = blocks.iter().map(|&block| Entry::new(block)).collect();
        let left = entries.len();
        let mut reduction = Self { bvh, points, area, scale, entries, candidates: Vec::new(), left };
        for point in 0..points.len() as u32 {
            reduction.give(point);
        }
        for i in 0..left {
            reduction.propose(Step::Drop(i));
            reduction.propose_merges(i, |other| other > i);
        }
        reduction
    }

    /// Drops or merges boxes until at most `most` boxes remain and every further step would be visible; returns the
    /// boxes. Calls `tick` with the number of remaining boxes after each step.
    pub fn run(mut self, most: usize, tick: &mut dyn FnMut(usize)) -> Vec<Obb> {
        // Squared distance below which an error is invisible; multiplied by the affected area.
        let free = self.scale.unseen * self.scale.unseen;
        while self.left > 1 {
            let cheaper = |a: usize, b: usize| {
                if self.candidates[b].cost < self.candidates[a].cost { b } else { a }
            };
            let Some(index) = (0..self.candidates.len()).reduce(cheaper) else { break };
            let Candidate { step, cost, seen } = self.candidates[index];
            if seen != self.left {
                // The neighbourhood may have changed, so recompute the cost.
                self.candidates[index] = Candidate { step, cost: self.cost(&step), seen: self.left };
                continue;
            }
            if self.left <= most && cost > free * self.extent(&step) {
                break;
            }
            self.candidates.swap_remove(index);
            self.apply(step);
            tick(self.left);
        }
        let alive = self.entries.iter().filter(|entry| entry.alive);
        alive
            .map(|entry| {
                let points: Vec<MeshPoint> = entry.points.iter().map(|&p| self.points[p as usize]).collect();
                settled(entry.block, &points, self.scale)
            })
            .collect()
    }

    /// Surface area that a step affects, m².
    fn extent(&self, step: &Step) -> f32 {
        match *step {
            Step::Drop(i) => self.entries[i].block.surface_area(),
            Step::Merge(a, b, _) => {
                min(self.entries[a].block.surface_area(), self.entries[b].block.surface_area())
            }
        }
    }

    fn apply(&mut self, step: Step) {
        let (gone, heir) = match step {
            Step::Drop(i) => ([i, i], None),
            Step::Merge(a, b, block) => ([a, b], Some(block)),
        };
        let mut points = Vec::new();
        for i in gone {
            self.entries[i].alive = false;
            points.append(&mut self.entries[i].points);
        }
        self.left -= 1;
        self.candidates.retain(|candidate| match candidate.step {
            Step::Drop(i) => !gone.contains(&i),
            Step::Merge(a, b, _) => !gone.contains(&a) && !gone.contains(&b),
        });
        if let Some(block) = heir {
            self.entries.push(Entry::new(block));
        }
        points.into_iter().for_each(|point| self.give(point));
        if heir.is_some() {
            let last = self.entries.len() - 1;
            self.propose(Step::Drop(last));
            self.propose_merges(last, |_| true);
        }
    }

    fn propose(&mut self, step: Step) {
        let candidate = self.candidate(step);
        self.candidates.push(candidate);
    }

    fn candidate(&mut self, step: Step) -> Candidate {
        Candidate { step, cost: self.cost(&step), seen: self.left }
    }

    fn propose_merges(&mut self, i: usize, accept: impl Fn(usize) -> bool) {
        for j in self.neighbors(i) {
            if accept(j) {
                let candidates = self.merged(i, j).map(|block| self.candidate(Step::Merge(i, j, block)));
                let cheapest = candidates.into_iter().reduce(|a, b| if b.cost < a.cost { b } else { a });
                self.candidates.extend(cheapest);
            }
        }
    }

    /// Increase of the integral of squared distances by a step, m⁴.
    fn cost(&mut self, step: &Step) -> f32 {
        match *step {
            Step::Drop(i) => {
                let change = |&point: &u32| {
                    let p = self.points[point as usize].position;
                    let now = self.entries[i].placed.signed_distance(p);
                    let then = self.nearest(p, i).1;
                    then * then - now * now
                };
                self.entries[i].points.iter().map(change).sum::<f32>() * self.area
            }
            Step::Merge(i, j, block) => {
                if is_seen_from_inside(self.bvh, &block) && !self.is_inside_another(block.center) {
                    // Prevents a merge of the floor and the ceiling of a room.
                    return f32::INFINITY;
                }
                let before = self.cost_of(i) + self.cost_of(j);
                let points = [i, j].map(|k| self.points_cost(&block, &self.entries[k].points));
                points[0] + points[1] + self.surface_cost(&block, [i, j]) - before
            }
        }
    }

    /// Integral of squared distances of one box, m⁴; cached while the set does not change.
    fn cost_of(&mut self, i: usize) -> f32 {
        if self.entries[i].seen != self.left {
            let Entry { block, ref points, .. } = self.entries[i];
            let cost = self.points_cost(&block, points) + self.surface_cost(&block, [i, i]);
            (self.entries[i].cost, self.entries[i].seen) = (cost, self.left);
        }
        self.entries[i].cost
    }

    /// Assigns a point of the mesh to the box with the closest surface.
    fn give(&mut self, point: u32) {
        let p = self.points[point as usize].position;
        let (nearest, _) = self.nearest(p, usize::MAX);
        if let Some(i) = nearest {
            self.entries[i].points.push(point);
        }
    }

    /// Returns the box other than `without` whose faces are closest to `p`, and the distance, metres.
    fn nearest(&self, p: Vec3, without: usize) -> (Option<usize>, f32) {
        let mut best = (None, f32::INFINITY);
        for (i, entry) in self.entries.iter().enumerate() {
            if !entry.alive || i == without {
                continue;
            }
            let from_center = (p - entry.placed.center).length();
            if from_center - entry.block.half_extents.length() < best.1 {
                let distance = entry.placed.signed_distance(p).abs();
                if distance < best.1 {
                    best = (Some(i), distance);
                }
            }
        }
        best
    }

    /// Returns the nearest boxes, ordered by the gap between bounds, then by the size of the common bounds.
    fn neighbors(&self, i: usize) -> Vec<usize> {
        let bounds = self.entries[i].bounds;
        let mut near: Vec<(f32, f32, usize)> = Vec::new();
        for (j, entry) in self.entries.iter().enumerate() {
            if j != i && entry.alive {
                let other = entry.bounds;
                let gap = max3(max3(bounds.min - other.max, other.min - bounds.max), Vec3::ZERO).length();
                let both = bounds.merge(&other);
                near.push((gap, (both.max - both.min).length(), j));
            }
        }
        near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        near.into_iter().take(NEIGHBORS).map(|(_, _, j)| j).collect()
    }

    /// Returns two candidates for a single box that replaces boxes `i` and `j`: the smallest box around both, along the
    /// axes of either box, of the world, or of the mesh there; and the plate behind their faces.
    fn merged(&self, i: usize, j: usize) -> [Obb; 2] {
        let [a, b] = [&self.entries[i], &self.entries[j]];
        let corners = [a.block.corners(), b.block.corners()].concat();
        let rotations = [a, b].map(|entry| entry.block.rotation);
        let points = || a.points.iter().chain(&b.points).map(|&p| &self.points[p as usize]);
        let facing = cluster(points().map(|p| (p.normal, 1.0)));
        let along_faces = orientations(&facing).next();
        let tried = rotations.into_iter().chain([Rotation::IDENTITY]).chain(along_faces);
        let blocks = tried.map(|rotation| around(corners.iter().copied(), rotation, self.scale.thinnest));
        let around_both = blocks.reduce(|a, b| if b.volume() < 0.999 * a.volume() { b } else { a });
        let around_both = around_both.unwrap_or(a.block);
        let Some(rotation) = along_faces else { return [around_both; 2] };
        let normal: Vec3 = points().map(|p| p.normal).sum();
        // The box is behind the faces if they face one direction, and centred if they face all directions.
        let behind = normal * (-self.scale.thickness / points().count() as f32);
        let plate = points().flat_map(|p| [p.position, p.position + behind]);
        [around_both, around(plate, rotation, self.scale.thinnest)]
    }

    /// Integral of the squared distance from the points' area to a box, m⁴.
    fn points_cost(&self, block: &Obb, points: &[u32]) -> f32 {
        let placed = block.placed();
        let square = |&point: &u32| {
            let distance = placed.signed_distance(self.points[point as usize].position);
            distance * distance
        };
        points.iter().map(square).sum::<f32>() * self.area
    }

    /// Integral of the squared distance to the mesh over the part of a box's surface outside all other boxes, m⁴. `own`
    /// are the boxes that `block` replaces.
    fn surface_cost(&self, block: &Obb, own: [usize; 2]) -> f32 {
        // Uses the same points for the same box, so that costs can be compared.
        let mut points = Vec::with_capacity(SURFACE);
        sample_surface(block, SURFACE, &mut Random::new(0), &mut points);
        let square = |&p: &Vec3| {
            let distance = self.bvh.closest_point(p).distance;
            distance * distance
        };
        let own_bounds = bounds(block);
        let near = |&(i, entry): &(usize, &Entry)| {
            entry.alive && !own.contains(&i) && entry.bounds.overlaps(&own_bounds)
        };
        let others: Vec<&Entry> =
            self.entries.iter().enumerate().filter(near).map(|(_, entry)| entry).collect();
        let hidden = |p: Vec3| others.iter().any(|entry| entry.holds(p, self.scale.thinnest));
        let outer = points.iter().filter(|&&p| !hidden(p));
        outer.map(square).sum::<f32>() * (block.surface_area() / SURFACE as f32)
    }

    fn is_inside_another(&self, p: Vec3) -> bool {
        self.entries.iter().any(|entry| entry.alive && entry.holds(p, self.scale.thinnest))
    }
}

impl Entry {
    fn new(block: Obb) -> Self {
        Self {
            block,
            placed: block.placed(),
            bounds: bounds(&block),
            points: Vec::new(),
            cost: 0.0,
            seen: usize::MAX,
            alive: true,
        }
    }

    /// True if a point is inside the box by more than `least`, metres.
    fn holds(&self, p: Vec3, least: f32) -> bool {
        self.bounds.overlaps(&Aabb { min: p, max: p }) && self.placed.signed_distance(p) < -least
    }
}
