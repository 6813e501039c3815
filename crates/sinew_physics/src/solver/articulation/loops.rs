//! Joints that close loops. A few loops are solved exactly by the Schur complement of the tree (Baraff 1996): with the tree's inverse
//! inertia `W`, the loop rows `J` and `S = J W Jᵀ + Γ`, `λ = S⁻¹ (r − J dv)`. Many loops, or loops between trees, are solved by conjugate
//! gradients on the same equations. Each product `S p` is one pass through the trees, so the first round already distributes the load of a
//! net on ropes correctly, and every round removes energy, also if the iteration ends early.

use crate::joint::DIRECTIONS;
use crate::solver::articulation::batches::Batches;
use crate::solver::articulation::response::Response;
use crate::solver::articulation::response_cache::ResponseCache;
use crate::solver::articulation::tree::{self, Link, NONE};
use crate::solver::body::{SolverBody, free_response};
use crate::solver::joint::SolverJoint;
use crate::solver::tuning::{
    LOOP_RATE_TOLERANCE, LOOP_REDUNDANCY, LOOP_RESIDUAL_SHARE, LOOP_ROUNDS, MAX_EXACT_ROWS,
};
use crate::solver::{IslandSolver, Scratch};
use crate::spatial::{Vec6, ZERO6, add_scaled, dot};
use sinew_math::{clamp, max};

/// Loops of one tree that are solved together.
#[derive(Clone, Debug)]
struct Closure {
    tree: u32,
    /// Index of the closure's first joint among the loops.
    first: usize,
    count: usize,
    /// Number of the closure's rows, and the offsets of its matrices.
    rows: usize,
    inverse: usize,
    columns: usize,
}

/// All loops of an island.
#[derive(Clone, Debug, Default)]
pub(in crate::solver) struct Loops {
    /// Joints of the island; the joints of one closure are contiguous.
    pub joints: Vec<u32>,
    /// Closures of the island; empty if the loops are iterated.
    closures: Vec<Closure>,
    /// S⁻¹ of all closures, row by row.
    inverses: Vec<f32>,
    /// `W Jᵀ` of all closures: for each row, the velocity change of each link of the tree.
    columns: ResponseCache,
    scratch: Vec<f32>,
    gradient: Gradient,
}

/// Vectors of conjugate gradients.
#[derive(Clone, Debug, Default)]
struct Gradient {
    /// Residual of each row of the loops.
    residual: Vec<f32>,
    direction: Vec<f32>,
    answer: Vec<f32>,
    /// Velocity change of each moving body from the direction, and from all impulses so far.
    dv: Vec<Vec6>,
    sum: Vec<Vec6>,
}

impl Loops {
    pub fn clear(&mut self) {
        self.joints.clear();
        self.closures.clear();
    }

    pub fn is_empty(&self) -> bool {
        self.joints.is_empty()
    }

    pub fn are_iterated(&self) -> bool {
        self.closures.is_empty() && !self.joints.is_empty()
    }

    /// Loop joints whose effect the responses include; empty if the loops are iterated.
    pub fn closed_exactly(&self) -> &[u32] {
        if self.are_iterated() { &[] } else { &self.joints }
    }

    /// Groups the loops by tree. Many loops, or loops between trees, are left to the iteration.
    pub fn group(&mut self, joints: &[SolverJoint], links: &[Link]) {
        let tree = |body: u32| links.get(body as usize).map(|link| link.tree);
        let ends = |joint: u32| (tree(joints[joint as usize].a), tree(joints[joint as usize].b));
        let tree_of = |joint: u32| ends(joint).0.or(ends(joint).1).unwrap_or(NONE);
        self.joints.sort_unstable_by_key(|&joint| (tree_of(joint), joint));
        self.closures.clear();
        for (place, &joint) in self.joints.iter().enumerate() {
            let tree = tree_of(joint);
            match self.closures.last_mut() {
                Some(closure) if closure.tree == tree => closure.count += 1,
                _ => {
                    let (first, count) = (place, 1);
                    self.closures.push(Closure { tree, first, count, rows: 0, inverse: 0, columns: 0 });
                }
            }
        }
        let rows = |closure: &Closure| -> usize {
            let joints_of = &self.joints[closure.first..closure.first + closure.count];
            joints_of.iter().map(|&joint| joints[joint as usize].most_rows).sum()
        };
        let between = self.joints.iter().any(|&joint| matches!(ends(joint), (Some(a), Some(b)) if a != b));
        if between || self.closures.iter().any(|closure| rows(closure) > MAX_EXACT_ROWS) {
            self.closures.clear();
        }
    }

    /// Computes the matrices for the present rows. The response of each closed tree then includes its loops.
    pub fn respond(
        &mut self,
        joints: &[SolverJoint],
        bodies: &[SolverBody],
        (links, batches): (&[Link], &mut Batches),
        response: &mut Response,
    ) {
        self.inverses.clear();
        self.columns.clear();
        for closure in &mut self.closures {
            let loops = &self.joints[closure.first..closure.first + closure.count];
            let rows = || {
                loops.iter().flat_map(|&joint| {
                    let joint = &joints[joint as usize];
                    (0..joint.rows.count).map(move |row| (joint, row))
                })
            };
            closure.rows = rows().count();
            closure.columns = self.columns.end();
            for &joint in loops {
                let joint = &joints[joint as usize];
                let mut on = [[ZERO6; 2]; DIRECTIONS];
                for (row, on) in on[..joint.rows.count].iter_mut().enumerate() {
                    *on = [joint.rows.on_a(row), joint.rows.on_b(row)];
                }
                let on = on[..joint.rows.count].iter().map(<[Vec6; 2]>::each_ref);
                self.columns.add(response, (links, batches), [joint.a, joint.b], on);
            }
            let members = response.members(closure.tree).len();
            let columns = self.columns.from(closure.columns);
            let n = closure.rows;
            let s = &mut self.scratch;
            s.clear();
            for (k, (joint, row)) in rows().enumerate() {
                let [on_a, on_b] = [joint.rows.on_a(row), joint.rows.on_b(row)];
                for l in 0..n {
                    let column = &columns[l * members..(l + 1) * members];
                    let on =
                        |body: u32, j: &Vec6| response.slot(body).map_or(0.0, |slot| dot(j, &column[slot]));
                    let mut entry = on(joint.a, &on_a) + on(joint.b, &on_b);
                    if k == l {
                        let ends = [(joint.a, &on_a), (joint.b, &on_b)];
                        entry += joint.compliance(row)
                            + LOOP_REDUNDANCY * free_response(bodies, links.len(), ends);
                    }
                    s.push(entry);
                }
            }
            closure.inverse = self.inverses.len();
            invert(s, n, &mut self.inverses);
            response.close(closure.tree, columns, &self.inverses[closure.inverse..]);
        }
    }

    /// Sets `scratch.dv` to the additional velocity change by which the loops remove the rest of `scratch.loop_residuals` (row by row of
    /// each loop joint).
    pub fn close(&mut self, joints: &mut [SolverJoint], links: &[Link], scratch: &mut Scratch) {
        if self.are_iterated() {
            self.iterate(joints, links, scratch);
        } else {
            self.close_exactly(joints, scratch);
            tree::solve(links, 0..links.len(), &mut scratch.impulses, &[], &mut scratch.dv);
            self.keep_descent(joints, scratch);
        }
    }

    /// Scales the solution of an ill-conditioned closure. The inverse of a closure with nearly dependent rows is mostly rounding error: if
    /// the solution does not halve the residual, uses the fraction that reduces the residual most.
    fn keep_descent(&mut self, joints: &mut [SolverJoint], scratch: &mut Scratch) {
        let Gradient { residual, direction: lambda, .. } = &self.gradient;
        let (mut square, mut along, mut answered, mut row) = (0.0, 0.0, 0.0, 0);
        for &joint in &self.joints {
            let joint = &joints[joint as usize];
            let rate = joint.rate(&scratch.dv);
            for (k, rate) in rate.iter().enumerate().take(joint.rows.count) {
                let answer = rate + joint.compliance(k) * lambda[row];
                square += residual[row] * residual[row];
                along += residual[row] * answer;
                answered += answer * answer;
                row += 1;
            }
        }
        // Compares |r − a|² with |r|².
        if answered - 2.0 * along <= -0.75 * square || answered <= 0.0 {
            return;
        }
        let share = clamp(along / answered, 0.0, 1.0);
        for dv in &mut scratch.dv {
            *dv = dv.map(|x| x * share);
        }
        let mut lambda = lambda.iter();
        for &joint in &self.joints {
            let joint = &mut joints[joint as usize];
            for (impulse, lambda) in joint.impulse[..joint.rows.count].iter_mut().zip(&mut lambda) {
                *impulse -= (1.0 - share) * lambda;
            }
        }
    }

    /// Computes the impulses of the loops and applies them to the bodies.
    fn close_exactly(&mut self, joints: &mut [SolverJoint], scratch: &mut Scratch) {
        scratch.impulses.fill(ZERO6);
        let Gradient { residual, direction: lambdas, .. } = &mut self.gradient;
        residual.clear();
        lambdas.clear();
        for closure in &self.closures {
            let range = closure.first..closure.first + closure.count;
            let left = &mut self.scratch;
            left.clear();
            for (&joint, residual) in
                self.joints[range.clone()].iter().zip(&scratch.loop_residuals[range.clone()])
            {
                let joint = &joints[joint as usize];
                let rate = joint.rate(&scratch.dv);
                left.extend((0..joint.rows.count).map(|row| residual[row] - rate[row]));
            }
            if closure.rows == 0 {
                continue;
            }
            residual.extend_from_slice(left);
            let mut lines = self.inverses[closure.inverse..].chunks_exact(closure.rows);
            for &joint in &self.joints[range] {
                let joint = &mut joints[joint as usize];
                let mut of_rows = ZERO6;
                for row in 0..joint.rows.count {
                    let line = lines.next().unwrap_or_default();
                    let lambda = line.iter().zip(left.iter()).fold(0.0, |sum, (s, r)| sum + s * r);
                    lambdas.push(lambda);
                    joint.impulse[row] += lambda;
                    of_rows[row] = lambda;
                }
                joint.push(&of_rows, &mut scratch.impulses, 1.0);
            }
        }
    }

    /// Conjugate gradients (Hestenes and Stiefel 1952) on `S λ = r − J dv`.
    fn iterate(&mut self, joints: &mut [SolverJoint], links: &[Link], scratch: &mut Scratch) {
        let g = &mut self.gradient;
        g.residual.clear();
        for (&joint, residual) in self.joints.iter().zip(&scratch.loop_residuals) {
            let joint = &joints[joint as usize];
            let rate = joint.rate(&scratch.dv);
            g.residual.extend((0..joint.rows.count).map(|row| residual[row] - rate[row]));
        }
        g.direction.clone_from(&g.residual);
        g.sum.clear();
        g.sum.resize(links.len(), ZERO6);
        g.dv.resize(links.len(), ZERO6);
        let mut square = dot_of(&g.residual, &g.residual);
        let enough = max(LOOP_RESIDUAL_SHARE * square, LOOP_RATE_TOLERANCE * LOOP_RATE_TOLERANCE);
        for _ in 0..LOOP_ROUNDS {
            if square <= enough {
                break;
            }
            answer(&self.joints, joints, links, scratch, g);
            let curvature = dot_of(&g.direction, &g.answer);
            if curvature <= 0.0 {
                break; // only rounding error is left
            }
            let step = square / curvature;
            let mut row = 0;
            for &joint in &self.joints {
                let joint = &mut joints[joint as usize];
                for impulse in &mut joint.impulse[..joint.rows.count] {
                    *impulse += step * g.direction[row];
                    g.residual[row] -= step * g.answer[row];
                    row += 1;
                }
            }
            for (sum, dv) in g.sum.iter_mut().zip(&g.dv) {
                add_scaled(sum, dv, step);
            }
            let before = square;
            square = dot_of(&g.residual, &g.residual);
            let keep = square / before;
            for (direction, residual) in g.direction.iter_mut().zip(&g.residual) {
                *direction = residual + keep * *direction;
            }
        }
        scratch.dv.clone_from(&g.sum);
    }
}

/// Computes `S p` for the direction `p`, and the velocities that it causes.
fn answer(loops: &[u32], joints: &[SolverJoint], links: &[Link], scratch: &mut Scratch, g: &mut Gradient) {
    scratch.impulses.fill(ZERO6);
    let mut push = g.direction.iter();
    for &joint in loops {
        let joint = &joints[joint as usize];
        let mut of_rows = ZERO6;
        for (of_row, &p) in of_rows[..joint.rows.count].iter_mut().zip(&mut push) {
            *of_row = p;
        }
        joint.push(&of_rows, &mut scratch.impulses, 1.0);
    }
    tree::solve(links, 0..links.len(), &mut scratch.impulses, &[], &mut g.dv);
    g.answer.clear();
    for &joint in loops {
        let joint = &joints[joint as usize];
        let rate = joint.rate(&g.dv);
        for row in 0..joint.rows.count {
            g.answer.push(rate[row] + joint.compliance(row) * g.direction[g.answer.len()]);
        }
    }
}

fn dot_of(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).fold(0.0, |sum, (x, y)| sum + x * y)
}

impl IslandSolver {
    /// Warm-starts iterated loops with the impulses of the last substep.
    pub(in crate::solver) fn warm_start_loops(&mut self) {
        if !self.loops.are_iterated() {
            return;
        }
        for &joint in &self.loops.joints {
            let joint = &mut self.joints[joint as usize];
            for row in 0..joint.rows.count {
                joint.impulse[row] = joint.warm_impulse[joint.rows.direction(row)];
            }
            let [on_a, on_b] = joint.rows.impulse(&joint.impulse);
            for (body, push, sign) in [(joint.a as usize, on_a, -1.0), (joint.b as usize, on_b, 1.0)] {
                if body < self.links.len() {
                    let change = self.bodies[body].velocity_change(&push);
                    add_scaled(&mut self.velocities[body], &change, sign);
                }
            }
        }
    }

    /// Stores the impulses of the substep for the next warm start.
    pub(in crate::solver) fn end_loops(&mut self) {
        for &joint in &self.loops.joints {
            let joint = &mut self.joints[joint as usize];
            joint.warm_impulse = ZERO6;
            for row in 0..joint.rows.count {
                joint.warm_impulse[joint.rows.direction(row)] = joint.impulse[row];
            }
        }
    }
}

/// Appends the inverse of a symmetric positive definite matrix to `out`, by LDLᵀ. If rounding makes a pivot non-positive, its row is
/// dropped.
fn invert(m: &mut [f32], n: usize, out: &mut Vec<f32>) {
    // L below the diagonal, 1/D on it, in place.
    for i in 0..n {
        for j in 0..i {
            let mut sum = m[i * n + j];
            for k in 0..j {
                sum -= m[i * n + k] * m[j * n + k];
            }
            m[i * n + j] = sum; // L·D, divided by D below
        }
        let mut pivot = m[i * n + i];
        for k in 0..i {
            pivot -= m[i * n + k] * m[i * n + k] * m[k * n + k];
            m[i * n + k] *= m[k * n + k];
        }
        let safe = pivot > 0.0 && pivot < f32::INFINITY;
        m[i * n + i] = if safe { 1.0 / pivot } else { 0.0 };
    }
    let start = out.len();
    out.resize(start + n * n, 0.0);
    let out = &mut out[start..];
    for column in 0..n {
        // Computes the result row by row; the result is symmetric.
        let x = &mut out[column * n..(column + 1) * n];
        x[column] = 1.0;
        for i in column..n {
            for k in column..i {
                x[i] -= m[i * n + k] * x[k];
            }
        }
        for i in 0..n {
            x[i] *= m[i * n + i];
        }
        for i in (0..n).rev() {
            for k in i + 1..n {
                x[i] -= m[k * n + i] * x[k];
            }
        }
    }
}
