//! Joints that close loops. Few of them in one tree are solved exactly, by the Schur complement of the tree (Baraff 1996):
//! with the tree's inverse inertia `W`, rows `J` of the loops and `S = J W Jᵀ + Γ`, `λ = S⁻¹ (r − J dv)`. Many of them, and
//! those between trees, are visited by the sweeps, joint by joint.

use super::contact_rows::Softness;
use super::response::Response;
use super::sweep::Pass;
use super::tree::Link;
use super::{IslandSolver, SolverBody, SolverJoint};
use crate::spatial::{Mat6, Vec6, ZERO6, ZERO66, add_scaled, dot, mul, spd_inverse};
use sinew_math::Sym3;

/// At most this many rows of loops are solved exactly in one tree.
pub(super) const MAX_EXACT_ROWS: usize = 24;
/// Added to the diagonal of S as a share of what the bodies would answer if nothing held them. Rows that say what the tree
/// says already (a planar four-bar linkage of hinges) answer with rounding errors of that size alone; what this leaves of
/// the others is removed by the position corrections.
const REDUNDANCY: f32 = 1e-5;
/// Stiffness of visited rows as a share of the substep rate, and damping ratio.
const STIFFNESS: f32 = 0.25;
const DAMPING_RATIO: f32 = 2.0;

/// A joint that closes a loop.
#[derive(Clone, Debug)]
pub(super) struct LoopJoint {
    pub joint: u32,
    /// In tree `tree` it is solved exactly; otherwise it is visited.
    closure: Option<u32>,
    /// `(J W Jᵀ + Γ)⁻¹` of its own rows.
    inverse: Mat6,
    /// Of this substep, row by row, if it is visited.
    pub impulse: Vec6,
}

/// The loops of one tree, solved together.
#[derive(Clone, Debug)]
struct Closure {
    tree: u32,
    /// Its joints among the loops.
    first: usize,
    count: usize,
    /// Rows of them, and where their matrices start.
    rows: usize,
    inverse: usize,
    columns: usize,
}

/// All loops of an island.
#[derive(Clone, Debug, Default)]
pub(super) struct Loops {
    /// Those of a closure are neighbours.
    pub joints: Vec<LoopJoint>,
    closures: Vec<Closure>,
    /// S⁻¹ of all closures, row by row.
    inverses: Vec<f32>,
    /// `W Jᵀ` of all closures: per row, per member of the tree, a velocity change.
    columns: Vec<Vec6>,
    scratch: Vec<f32>,
}

impl Loops {
    pub fn clear(&mut self) {
        self.joints.clear();
        self.closures.clear();
    }

    /// A joint that closes a loop, with its impulses of the last substep.
    pub fn push(&mut self, joint: u32, impulse: Vec6) {
        self.joints.push(LoopJoint { joint, closure: None, inverse: ZERO66, impulse });
    }

    /// Decides which are solved exactly.
    pub fn group(&mut self, joints: &[SolverJoint], links: &[Link]) {
        let tree_of = |of: &LoopJoint| {
            let joint = &joints[of.joint as usize];
            let tree = |body: u32| links.get(body as usize).map(|link| link.tree);
            match (tree(joint.a), tree(joint.b)) {
                (Some(a), Some(b)) if a != b => None,
                (a, b) => a.or(b),
            }
        };
        self.joints.sort_by_key(|of| (tree_of(of), of.joint));
        self.closures.clear();
        let mut first = 0;
        while first < self.joints.len() {
            let tree = tree_of(&self.joints[first]);
            let count = self.joints[first..].iter().take_while(|of| tree_of(of) == tree).count();
            let most: usize = self.joints[first..first + count]
                .iter()
                .map(|of| joints[of.joint as usize].most_rows())
                .sum();
            if let Some(tree) = tree.filter(|_| most <= MAX_EXACT_ROWS) {
                for of in &mut self.joints[first..first + count] {
                    of.closure = Some(self.closures.len() as u32);
                    of.impulse = ZERO6;
                }
                self.closures.push(Closure { tree, first, count, rows: 0, inverse: 0, columns: 0 });
            }
            first += count;
        }
    }

    /// Those that the sweeps visit.
    fn visited(&self) -> impl Iterator<Item = &LoopJoint> {
        self.joints.iter().filter(|of| of.closure.is_none())
    }

    pub fn has_visited(&self) -> bool {
        self.visited().next().is_some()
    }

    pub fn has_exact(&self) -> bool {
        !self.closures.is_empty()
    }

    /// Matrices for the present rows; the response of each closed tree becomes that with its loops closed.
    pub fn respond(
        &mut self,
        joints: &[SolverJoint],
        bodies: &[SolverBody],
        links: &[Link],
        response: &mut Response,
    ) {
        for of in self.joints.iter_mut().filter(|of| of.closure.is_none()) {
            of.respond(&joints[of.joint as usize], bodies, links, response);
        }
        self.inverses.clear();
        self.columns.clear();
        for closure in &mut self.closures {
            let loops = &self.joints[closure.first..closure.first + closure.count];
            let rows = || {
                loops.iter().flat_map(|of| {
                    let joint = &joints[of.joint as usize];
                    (0..joint.rows.count).map(move |row| (joint, row))
                })
            };
            closure.rows = rows().count();
            closure.columns = self.columns.len();
            for (joint, row) in rows() {
                let rows = [(joint.a, &joint.rows.a[row]), (joint.b, &joint.rows.b[row])];
                response.column(closure.tree, rows, &mut self.columns);
            }
            let members = response.members(closure.tree).len();
            let columns = &self.columns[closure.columns..];
            let n = closure.rows;
            let s = &mut self.scratch;
            s.clear();
            for (k, (joint, row)) in rows().enumerate() {
                for l in 0..n {
                    let column = &columns[l * members..(l + 1) * members];
                    let on =
                        |body: u32, j: &Vec6| response.slot(body).map_or(0.0, |slot| dot(j, &column[slot]));
                    let mut entry = on(joint.a, &joint.rows.a[row]) + on(joint.b, &joint.rows.b[row]);
                    if k == l {
                        entry += joint.compliance(row) + REDUNDANCY * joint.free_response(row, bodies);
                    }
                    s.push(entry);
                }
            }
            closure.inverse = self.inverses.len();
            invert(s, n, &mut self.inverses);
            response.close(closure.tree, columns, &self.inverses[closure.inverse..], n);
        }
    }

    /// Impulses of the exact loops that make up for what `dv` leaves of `residuals` (row by row of each loop joint), put on
    /// the bodies.
    pub fn close(&mut self, joints: &[SolverJoint], residuals: &[Vec6], dv: &[Vec6], impulses: &mut [Vec6]) {
        for closure in &self.closures {
            let range = closure.first..closure.first + closure.count;
            let left = &mut self.scratch;
            left.clear();
            for (of, residual) in self.joints[range.clone()].iter().zip(&residuals[range.clone()]) {
                let joint = &joints[of.joint as usize];
                let rate = joint.rate(dv);
                left.extend((0..joint.rows.count).map(|row| residual[row] - rate[row]));
            }
            let inverse = &self.inverses[closure.inverse..];
            let mut k = 0;
            for of in &self.joints[range] {
                let joint = &joints[of.joint as usize];
                for row in 0..joint.rows.count {
                    let line = &inverse[k * closure.rows..(k + 1) * closure.rows];
                    let lambda = line.iter().zip(left.iter()).fold(0.0, |sum, (s, r)| sum + s * r);
                    super::limit_rows::add_row(impulses, joint.a, &joint.rows.a[row], lambda);
                    super::limit_rows::add_row(impulses, joint.b, &joint.rows.b[row], lambda);
                    k += 1;
                }
            }
        }
    }
}

impl LoopJoint {
    pub fn is_exact(&self) -> bool {
        self.closure.is_some()
    }

    fn respond(&mut self, joint: &SolverJoint, bodies: &[SolverBody], links: &[Link], response: &Response) {
        let (a, b) = (joint.a as usize, joint.b as usize);
        let n = joint.rows.count;
        let mut k = ZERO66;
        for column in 0..n {
            let (ja, jb) = (&joint.rows.a[column], &joint.rows.b[column]);
            let mut on_a = response.at(links, a, a, ja);
            add_scaled(&mut on_a, &response.at(links, a, b, jb), 1.0);
            let mut on_b = response.at(links, b, b, jb);
            add_scaled(&mut on_b, &response.at(links, b, a, ja), 1.0);
            for row in 0..n {
                k[row][column] = dot(&joint.rows.a[row], &on_a) + dot(&joint.rows.b[row], &on_b);
            }
            k[column][column] += joint.compliance(column) + REDUNDANCY * joint.free_response(column, bodies);
        }
        self.inverse = spd_inverse(&k, n).unwrap_or(ZERO66);
    }

    /// Change of impulse, row by row: rigid rows are a soft constraint in `solve`, as stiff as the substep allows, and
    /// rigid in `relax`.
    fn visit(&mut self, joint: &SolverJoint, velocities: &[Vec6], pass: Pass, h: f32) -> Vec6 {
        let soft = Softness::new(STIFFNESS / h, DAMPING_RATIO, h);
        let rate = joint.rate(velocities);
        let mut wanted = ZERO6;
        for row in 0..joint.rows.count {
            wanted[row] = if row >= joint.rigid {
                joint.wanted(row) - rate[row] - joint.compliance(row) * self.impulse[row]
            } else if pass == Pass::Solve {
                -soft.mass_scale * (rate[row] + soft.bias_rate * joint.rows.error[row])
            } else {
                -rate[row]
            };
        }
        let mut change = mul(&self.inverse, &wanted);
        for row in 0..joint.rigid {
            if pass == Pass::Solve {
                change[row] -= soft.impulse_scale * self.impulse[row];
            }
        }
        add_scaled(&mut self.impulse, &change, 1.0);
        change
    }
}

impl SolverJoint {
    /// Answer of a row to its own impulse if nothing else held the bodies.
    fn free_response(&self, row: usize, bodies: &[SolverBody]) -> f32 {
        let on = |body: u32, j: &Vec6| {
            let body = &bodies[body as usize];
            if body.inverse_inertia == Sym3::ZERO { 0.0 } else { dot(j, &body.velocity_change(j)) }
        };
        on(self.a, &self.rows.a[row]) + on(self.b, &self.rows.b[row])
    }
}

impl IslandSolver {
    /// Starts visited loops from the last substep's impulses.
    pub(super) fn warm_start_loops(&mut self) {
        for of in &self.loops.joints {
            let joint = &self.joints[of.joint as usize];
            for row in 0..joint.rows.count {
                let impulse = of.impulse[row];
                super::limit_rows::add_row(&mut self.impulses, joint.a, &joint.rows.a[row], impulse);
                super::limit_rows::add_row(&mut self.impulses, joint.b, &joint.rows.b[row], impulse);
            }
        }
    }

    pub(super) fn visit_loops(&mut self, pass: Pass, backward: bool) {
        for k in 0..self.loops.joints.len() {
            let i = if backward { self.loops.joints.len() - 1 - k } else { k };
            if self.loops.joints[i].closure.is_some() {
                continue;
            }
            let joint = &self.joints[self.loops.joints[i].joint as usize];
            let change = self.loops.joints[i].visit(joint, &self.velocities, pass, self.h);
            let (mut on_a, mut on_b) = (ZERO6, ZERO6);
            for row in 0..joint.rows.count {
                add_scaled(&mut on_a, &joint.rows.a[row], change[row]);
                add_scaled(&mut on_b, &joint.rows.b[row], change[row]);
            }
            self.push(joint.a, joint.b, &(on_a, on_b));
        }
    }
}

/// Inverse of a symmetric positive definite matrix by LDLᵀ, appended to `out`. A pivot that is not positive all the same
/// drops its row.
fn invert(m: &mut [f32], n: usize, out: &mut Vec<f32>) {
    // L below the diagonal, 1/D on it, in place.
    for i in 0..n {
        for j in 0..i {
            let mut sum = m[i * n + j];
            for k in 0..j {
                sum -= m[i * n + k] * m[j * n + k];
            }
            m[i * n + j] = sum; // L·D until it is divided below
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
        // Row by row of the result, which is symmetric.
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
