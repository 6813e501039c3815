//! Fewer boxes: what costs least is dropped or merged, until no more are left than wanted.

use super::Scale;
use super::block::Block;
use super::bvh::MeshBvh;
use super::fit::{cluster, orientations};
use super::sample::SurfacePoint;
use sinew_math::{Random, Rotation, Vec3, max3, min};

/// Points of a candidate's surface that are held against the mesh.
const SURFACE: usize = 96;
/// Neighbours that a box may merge with.
const NEIGHBORS: usize = 10;

/// A box on its way.
#[derive(Clone)]
struct Entry {
    block: Block,
    /// Points of the mesh to which it is the closest.
    points: Vec<u32>,
    /// Integral of squared distance to the mesh over its surface, m⁴.
    surface: f32,
    /// Neither dropped nor merged so far.
    alive: bool,
}

/// What can be done to come by with one box less.
#[derive(Clone, Copy)]
enum Step {
    Drop(usize),
    Merge(usize, usize, Block, f32),
}

struct Candidate {
    /// What it adds to the integral of squared distances, m⁴.
    cost: f32,
    step: Step,
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
    random: Random,
}

impl<'a> Reduction<'a> {
    pub fn new(
        bvh: &'a MeshBvh,
        points: &'a [SurfacePoint],
        area: f32,
        scale: Scale,
        blocks: &[Block],
    ) -> Self {
        let random = Random::new(blocks.len() as u64);
        let mut reduction =
            Self { bvh, points, area, scale, entries: Vec::new(), candidates: Vec::new(), random };
        let entry = |&block| Entry { block, points: Vec::new(), surface: 0.0, alive: true };
        reduction.entries = blocks.iter().map(entry).collect();
        for i in 0..blocks.len() {
            let around = reduction.neighbors(i);
            reduction.entries[i].surface = reduction.surface_cost(&blocks[i], &around);
        }
        for point in 0..points.len() as u32 {
            reduction.give(point);
        }
        for i in 0..reduction.entries.len() {
            reduction.propose(i);
        }
        reduction
    }

    /// Boxes that are left when no more than `most` are, and none can go without being missed. `tick` is told how
    /// many are left after each step.
    pub fn run(mut self, most: usize, tick: &mut dyn FnMut(usize)) -> Vec<Block> {
        let mut left = self.entries.len();
        // Squared distance, times the area concerned, that nobody sees.
        let free = self.scale.unseen * self.scale.unseen;
        while left > 1 {
            let cheapest = (0..self.candidates.len())
                .reduce(|a, b| if self.candidates[b].cost < self.candidates[a].cost { b } else { a });
            let Some(index) = cheapest else { break };
            if left <= most && self.candidates[index].cost > free * self.extent(&self.candidates[index].step)
            {
                break;
            }
            let Candidate { step, .. } = self.candidates.swap_remove(index);
            self.apply(step);
            left -= 1;
            tick(left);
        }
        self.entries.iter().filter(|entry| entry.alive).map(|entry| entry.block).collect()
    }

    /// The area that a step concerns, square metres.
    fn extent(&self, step: &Step) -> f32 {
        match *step {
            Step::Drop(i) => self.entries[i].block.area(),
            Step::Merge(a, b, ..) => min(self.entries[a].block.area(), self.entries[b].block.area()),
        }
    }

    fn apply(&mut self, step: Step) {
        let (gone, heir) = match step {
            Step::Drop(i) => ([i, i], None),
            Step::Merge(a, b, block, surface) => ([a, b], Some((block, surface))),
        };
        let mut touched = self.neighbors(gone[0]);
        touched.extend(self.neighbors(gone[1]));
        let mut points = Vec::new();
        for i in gone {
            self.entries[i].alive = false;
            points.append(&mut self.entries[i].points);
        }
        if let Some((block, surface)) = heir {
            touched.push(self.entries.len());
            self.entries.push(Entry { block, points: Vec::new(), surface, alive: true });
        }
        points.into_iter().for_each(|point| self.give(point));
        touched.retain(|&i| self.entries[i].alive);
        touched.sort_unstable();
        touched.dedup();
        let is_stale = |step: &Step| match *step {
            Step::Drop(i) => gone.contains(&i) || touched.contains(&i),
            Step::Merge(a, b, ..) => gone.contains(&a) || gone.contains(&b),
        };
        self.candidates.retain(|candidate| !is_stale(&candidate.step));
        for &i in &touched {
            self.propose_drop(i);
        }
        if heir.is_some() {
            self.propose_merges(self.entries.len() - 1, |_| true);
        }
    }

    /// Gives a point of the mesh to the box whose surface is closest.
    fn give(&mut self, point: u32) {
        let p = self.points[point as usize].position;
        let (nearest, _) = self.nearest(p, &[]);
        if let Some(i) = nearest {
            self.entries[i].points.push(point);
        }
    }

    /// The box whose faces are closest to `p`, without some, and how far they are.
    fn nearest(&self, p: Vec3, without: &[usize]) -> (Option<usize>, f32) {
        let mut best = (None, f32::INFINITY);
        for (i, entry) in self.entries.iter().enumerate() {
            if !entry.alive || without.contains(&i) {
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

    fn propose(&mut self, i: usize) {
        self.propose_drop(i);
        self.propose_merges(i, |other| other > i);
    }

    fn propose_drop(&mut self, i: usize) {
        let cost: f32 = self.entries[i]
            .points
            .iter()
            .map(|&point| {
                let p = self.points[point as usize].position;
                let now = self.entries[i].block.signed_distance(p);
                let then = self.nearest(p, &[i]).1;
                (then * then - now * now) * self.area
            })
            .sum();
        self.candidates.push(Candidate { cost, step: Step::Drop(i) });
    }

    fn propose_merges(&mut self, i: usize, accept: impl Fn(usize) -> bool) {
        for j in self.neighbors(i) {
            if accept(j) {
                let candidate = self.merge(i, j);
                self.candidates.push(candidate);
            }
        }
    }

    /// The nearest boxes by the gap between bounds, then by the size of what holds both.
    fn neighbors(&self, i: usize) -> Vec<usize> {
        let bounds = self.entries[i].block.bounds();
        let mut near: Vec<(f32, f32, usize)> = Vec::new();
        for (j, entry) in self.entries.iter().enumerate() {
            if j != i && entry.alive {
                let other = entry.block.bounds();
                let gap = max3(max3(bounds.min - other.max, other.min - bounds.max), Vec3::ZERO).length();
                let both = bounds.merge(&other);
                near.push((gap, (both.max - both.min).length(), j));
            }
        }
        near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        near.into_iter().take(NEIGHBORS).map(|(_, _, j)| j).collect()
    }

    /// The best single box instead of two.
    fn merge(&mut self, i: usize, j: usize) -> Candidate {
        let [a, b] = [&self.entries[i], &self.entries[j]];
        let points: Vec<u32> = a.points.iter().chain(&b.points).copied().collect();
        let before = a.surface
            + b.surface
            + self.points_cost(&a.block, &a.points)
            + self.points_cost(&b.block, &b.points);
        let corners = [a.block.corners(), b.block.corners()].concat();
        let rotations = [a, b].map(|entry| entry.block.world_from_block.rotation);
        let facing = cluster(points.iter().map(|&p| (self.points[p as usize].normal, 1.0)));
        let tried = rotations.into_iter().chain([Rotation::IDENTITY]).chain(orientations(&facing).take(1));
        let blocks =
            tried.map(|rotation| Block::around(corners.iter().copied(), rotation, self.scale.thinnest));
        let smallest = blocks.reduce(|a, b| if b.volume() < 0.999 * a.volume() { b } else { a });
        let block = smallest.unwrap_or(self.entries[i].block);
        let mut around = [self.neighbors(i), self.neighbors(j)].concat();
        around.retain(|&k| k != i && k != j);
        let surface = self.surface_cost(&block, &around);
        let cost = self.points_cost(&block, &points) + surface - before;
        Candidate { cost, step: Step::Merge(i, j, block, surface) }
    }

    /// Integral of squared distance from the points' area to a box, m⁴.
    fn points_cost(&self, block: &Block, points: &[u32]) -> f32 {
        let square = |&point: &u32| {
            let distance = block.signed_distance(self.points[point as usize].position);
            distance * distance
        };
        points.iter().map(square).sum::<f32>() * self.area
    }

    /// Integral of squared distance to the mesh over a box's surface outside the boxes around it, m⁴.
    fn surface_cost(&mut self, block: &Block, around: &[usize]) -> f32 {
        let mut points = Vec::with_capacity(SURFACE);
        block.sample(SURFACE, &mut self.random, &mut points);
        points.retain(|&p| {
            around.iter().all(|&i| self.entries[i].block.signed_distance(p) > -self.scale.thinnest)
        });
        let square = |&p: &Vec3| {
            let distance = self.bvh.closest_point(p).distance;
            distance * distance
        };
        points.iter().map(square).sum::<f32>() * (block.area() / SURFACE as f32)
    }
}
