//! Fewer boxes: what costs least is dropped or merged, until no more are left than wanted.

use super::Scale;
use super::block::Block;
use super::bvh::MeshBvh;
use super::fit::{cluster, orientations};
use super::sample::SurfacePoint;
use crate::boxes::{Aabb, Overlap};
use sinew_math::{Random, Rotation, Vec3, max3, min};

/// Points of a candidate's surface that are held against the mesh.
const SURFACE: usize = 96;
/// Neighbours that a box may merge with.
const NEIGHBORS: usize = 10;

/// A box on its way.
#[derive(Clone)]
struct Entry {
    block: Block,
    bounds: Aabb,
    /// Points of the mesh to which it is the closest.
    points: Vec<u32>,
    /// Neither dropped nor merged so far.
    alive: bool,
}

/// What can be done to come by with one box less.
#[derive(Clone, Copy)]
enum Step {
    /// Leave out a box.
    Drop(usize),
    /// Put a box in the place of two.
    Merge(usize, usize, Block),
}

struct Candidate {
    step: Step,
    /// What it added to the integral of squared distances when last looked at, m⁴.
    cost: f32,
    /// How many boxes were left then.
    seen: usize,
}

/// Boxes, points of the mesh, and what may become of them.
pub(super) struct Reduction<'a> {
    bvh: &'a MeshBvh,
    points: &'a [SurfacePoint],
    /// Of the mesh that each point stands for, square metres.
    area: f32,
    scale: Scale,
    entries: Vec<Entry>,
    candidates: Vec<Candidate>,
    left: usize,
}

impl<'a> Reduction<'a> {
    /// Of `blocks` that stand for a mesh of which `points` are known, each for `area` square metres.
    pub fn new(
        bvh: &'a MeshBvh,
        points: &'a [SurfacePoint],
        area: f32,
        scale: Scale,
        blocks: &[Block],
    ) -> Self {
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

    /// Boxes that are left when no more than `most` are, and none can go without being missed. `tick` is told how
    /// many are left after each step.
    pub fn run(mut self, most: usize, tick: &mut dyn FnMut(usize)) -> Vec<Block> {
        // Squared distance, times the area concerned, that nobody sees.
        let free = self.scale.unseen * self.scale.unseen;
        while self.left > 1 {
            let cheaper = |a: usize, b: usize| {
                if self.candidates[b].cost < self.candidates[a].cost { b } else { a }
            };
            let Some(index) = (0..self.candidates.len()).reduce(cheaper) else { break };
            let Candidate { step, cost, seen } = self.candidates[index];
            if seen != self.left {
                // Much may have changed around it.
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
        self.entries.iter().filter(|entry| entry.alive).map(|entry| entry.block).collect()
    }

    /// The area that a step concerns, square metres.
    fn extent(&self, step: &Step) -> f32 {
        match *step {
            Step::Drop(i) => self.entries[i].block.area(),
            Step::Merge(a, b, _) => min(self.entries[a].block.area(), self.entries[b].block.area()),
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
        let cost = self.cost(&step);
        self.candidates.push(Candidate { step, cost, seen: self.left });
    }

    fn propose_merges(&mut self, i: usize, accept: impl Fn(usize) -> bool) {
        for j in self.neighbors(i) {
            if accept(j) {
                self.propose(Step::Merge(i, j, self.merged(i, j)));
            }
        }
    }

    /// What a step adds to the integral of squared distances, m⁴.
    fn cost(&self, step: &Step) -> f32 {
        match *step {
            Step::Drop(i) => {
                let change = |&point: &u32| {
                    let p = self.points[point as usize].position;
                    let now = self.entries[i].block.signed_distance(p);
                    let then = self.nearest(p, i).1;
                    then * then - now * now
                };
                self.entries[i].points.iter().map(change).sum::<f32>() * self.area
            }
            Step::Merge(i, j, block) => {
                let [a, b] = [&self.entries[i], &self.entries[j]];
                let before = self.points_cost(&a.block, &a.points)
                    + self.points_cost(&b.block, &b.points)
                    + self.surface_cost(&a.block, [i, i])
                    + self.surface_cost(&b.block, [j, j]);
                self.points_cost(&block, &a.points)
                    + self.points_cost(&block, &b.points)
                    + self.surface_cost(&block, [i, j])
                    - before
            }
        }
    }

    /// Gives a point of the mesh to the box whose surface is closest.
    fn give(&mut self, point: u32) {
        let p = self.points[point as usize].position;
        let (nearest, _) = self.nearest(p, usize::MAX);
        if let Some(i) = nearest {
            self.entries[i].points.push(point);
        }
    }

    /// The box whose faces are closest to `p`, one left out, and how far they are.
    fn nearest(&self, p: Vec3, without: usize) -> (Option<usize>, f32) {
        let mut best = (None, f32::INFINITY);
        for (i, entry) in self.entries.iter().enumerate() {
            if !entry.alive || i == without {
                continue;
            }
            let from_center = (p - entry.block.world_from_block.translation).length();
            if from_center - entry.block.half_extents.length() < best.1 {
                let distance = entry.block.signed_distance(p).abs();
                if distance < best.1 {
                    best = (Some(i), distance);
                }
            }
        }
        best
    }

    /// The nearest boxes by the gap between bounds, then by the size of what holds both.
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

    /// The smallest single box around two: along the axes of either, of the world, or of the mesh there.
    fn merged(&self, i: usize, j: usize) -> Block {
        let [a, b] = [&self.entries[i], &self.entries[j]];
        let corners = [a.block.corners(), b.block.corners()].concat();
        let rotations = [a, b].map(|entry| entry.block.world_from_block.rotation);
        let points = a.points.iter().chain(&b.points);
        let facing = cluster(points.map(|&p| (self.points[p as usize].normal, 1.0)));
        let tried = rotations.into_iter().chain([Rotation::IDENTITY]).chain(orientations(&facing).take(1));
        let blocks =
            tried.map(|rotation| Block::around(corners.iter().copied(), rotation, self.scale.thinnest));
        blocks.reduce(|a, b| if b.volume() < 0.999 * a.volume() { b } else { a }).unwrap_or(a.block)
    }

    /// Integral of squared distance from the points' area to a box, m⁴.
    fn points_cost(&self, block: &Block, points: &[u32]) -> f32 {
        let square = |&point: &u32| {
            let distance = block.signed_distance(self.points[point as usize].position);
            distance * distance
        };
        points.iter().map(square).sum::<f32>() * self.area
    }

    /// Integral of squared distance to the mesh over a box's surface outside all other boxes, m⁴. `own` are those that
    /// it stands for.
    fn surface_cost(&self, block: &Block, own: [usize; 2]) -> f32 {
        // The same points of the same box, so that costs can be compared.
        let mut points = Vec::with_capacity(SURFACE);
        block.sample(SURFACE, &mut Random::new(0), &mut points);
        let square = |&p: &Vec3| {
            let distance = self.bvh.closest_point(p).distance;
            distance * distance
        };
        let outer = points.iter().filter(|&&p| !self.is_inside_another(p, own));
        outer.map(square).sum::<f32>() * (block.area() / SURFACE as f32)
    }

    fn is_inside_another(&self, p: Vec3, own: [usize; 2]) -> bool {
        let holds = |(i, entry): (usize, &Entry)| {
            entry.alive
                && !own.contains(&i)
                && entry.bounds.overlaps(&Aabb { min: p, max: p })
                && entry.block.signed_distance(p) < -self.scale.thinnest
        };
        self.entries.iter().enumerate().any(holds)
    }
}

impl Entry {
    fn new(block: Block) -> Self {
        Self { block, bounds: block.bounds(), points: Vec::new(), alive: true }
    }
}
