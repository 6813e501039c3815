//! Joint trees: the joints of a tree are solved exactly, in linear time, by block LDLᵀ from the leaves to the root.
//!
//! For child `c`, joint rows `J_c v_c + J_p v_p + Γ λ = r` and parent `p` (Baraff 1996; a tree has no fill-in):
//! ```text
//! P  = M'_c⁻¹                  M'_c: inertia of c with all that hangs below it
//! D  = J_c P J_cᵀ + Γ          Y = P J_cᵀ
//! M'_p += J_pᵀ D⁻¹ J_p
//! ```
//! Γ is zero for rigid rows, the compliance of springs, motors and dry friction for the others.

use super::SolverJoint;
use crate::joint::DIRECTIONS;
use crate::spatial::{Mat6, Vec6, ZERO6, ZERO66, add_scaled, mul_transposed, spd_inverse, transpose};
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::Lanes;

/// No parent, no joint, no slot.
pub(crate) const NONE: u32 = u32::MAX;

/// A moving body as a node of its tree. Nodes of a tree are contiguous, parents before children.
#[derive(Clone, Debug)]
pub(crate) struct Link {
    /// Local index of the parent body: a moving one before it, or a fixed one if this root is grounded.
    pub parent: u32,
    /// Local index of the joint to the parent.
    pub joint: u32,
    /// Which tree.
    pub tree: u32,
    /// Rows in use, and how many of them are rigid.
    pub rows: usize,
    pub rigid: usize,
    /// Jacobians of child and parent, row by row.
    pub child: [Vec6; 6],
    pub parent_rows: [Vec6; 6],
    /// Those of the parent column by column.
    parent_columns: Mat6,
    /// Γ, row by row.
    pub compliance: Vec6,
    /// P.
    pub inverse: Mat6,
    /// Rows of Yᵀ.
    pub y: [Vec6; 6],
    /// Rows of Y.
    y_columns: Mat6,
    /// D⁻¹.
    pub d_inverse: Mat6,
}

impl Link {
    pub fn new(parent: u32, joint: u32, tree: u32) -> Self {
        Self {
            parent,
            joint,
            tree,
            rows: 0,
            rigid: 0,
            child: [ZERO6; 6],
            parent_rows: [ZERO6; 6],
            parent_columns: ZERO66,
            compliance: ZERO6,
            inverse: ZERO66,
            y: [ZERO6; 6],
            y_columns: ZERO66,
            d_inverse: ZERO66,
        }
    }

    /// Takes the rows of its joint at the present pose.
    pub fn take_rows(&mut self, joint: &SolverJoint, child_is_b: bool) {
        let rows = &joint.rows;
        self.rows = rows.count;
        self.rigid = joint.rigid;
        (self.child, self.parent_rows) = if child_is_b { (rows.b, rows.a) } else { (rows.a, rows.b) };
        for row in 0..DIRECTIONS {
            self.compliance[row] = joint.compliance(row);
        }
    }

    /// `−Y D⁻¹ J_p`: velocity that this body takes on from its parent's, when nothing acts below the joint.
    #[inline(always)]
    pub fn transfer<L: Lanes>(&self) -> [L; 6] {
        let mut out = [L::splat(0.0); 6];
        for row in 0..self.rows {
            let line = combined::<L>(&self.parent_rows[..self.rows], &self.d_inverse[row]);
            for (i, out) in out.iter_mut().enumerate() {
                *out = *out + line * L::splat(-self.y[row][i]);
            }
        }
        out
    }

    /// `P − Y D⁻¹ Yᵀ`: response to an impulse on this body while its parent is held.
    #[inline(always)]
    pub fn response_with_parent_held<L: Lanes>(&self) -> [L; 6] {
        let mut out = [L::splat(0.0); 6];
        for (out, line) in out.iter_mut().zip(&self.inverse) {
            *out = L::load(line);
        }
        for row in 0..self.rows {
            let line = combined::<L>(&self.y[..self.rows], &self.d_inverse[row]);
            for (i, out) in out.iter_mut().enumerate() {
                *out = *out + line * L::splat(-self.y[row][i]);
            }
        }
        out
    }

    /// Computes P, Y, D⁻¹ from the articulated inertia of the child.
    #[inline(always)]
    fn factor(&mut self, inertia: &Mat6) {
        self.inverse = robust_inverse(inertia, 6);
        let mut d = ZERO66;
        self.y = ZERO66;
        for row in 0..self.rows {
            self.y[row] = mul_transposed(&self.inverse, &self.child[row]);
        }
        self.y_columns = transpose(&self.y);
        self.parent_columns = transpose(&self.parent_rows);
        for row in 0..self.rows {
            d[row] = mul_transposed(&self.y_columns, &self.child[row]);
            d[row][row] += self.compliance[row];
        }
        self.d_inverse = robust_inverse(&d, self.rows);
    }

    /// `J_pᵀ D⁻¹ J_p`: what this joint adds to its parent's inertia.
    #[inline(always)]
    fn add_to_parent(&self, inertia: &mut Mat6) {
        for row in 0..self.rows {
            let mut line = ZERO6;
            for k in 0..self.rows {
                add_scaled(&mut line, &self.parent_rows[k], self.d_inverse[row][k]);
            }
            for (i, m) in inertia.iter_mut().enumerate() {
                add_scaled(m, &line, self.parent_rows[row][i]);
            }
        }
    }
}

/// The sum of rows, each times its factor.
#[inline(always)]
fn combined<L: Lanes>(rows: &[Vec6], factors: &Vec6) -> L {
    let mut sum = L::splat(0.0);
    for (row, &factor) in rows.iter().zip(factors) {
        sum = sum + L::load(row) * L::splat(factor);
    }
    sum
}

/// Inverse of a matrix that is positive definite but for rounding: a bad pivot raises the diagonal and tries again
/// (as Newton Dynamics does); what stays bad gives zero, so the row does nothing, never a NaN.
#[inline(always)]
fn robust_inverse(m: &Mat6, n: usize) -> Mat6 {
    let mut m = *m;
    for _ in 0..6 {
        if let Some(inverse) = spd_inverse(&m, n) {
            return inverse;
        }
        for (i, row) in m.iter_mut().enumerate().take(n) {
            row[i] += 1e-6 + row[i].abs() * 1e-4;
        }
    }
    ZERO66
}

/// Factors all trees: `inertia` holds the bodies' own inertias and is overwritten by the articulated ones.
pub(crate) fn factor(links: &mut [Link], inertia: &mut [Mat6]) {
    dispatch::run(Factor { links, inertia });
}

/// Plain arithmetic, which the compiler puts on the registers that it is entered with.
struct Factor<'a> {
    links: &'a mut [Link],
    inertia: &'a mut [Mat6],
}

impl Kernel for Factor<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { links, inertia } = self;
        for i in (0..links.len()).rev() {
            let m = inertia[i];
            links[i].factor(&m);
            let parent = links[i].parent as usize;
            if parent < links.len() {
                links[i].add_to_parent(&mut inertia[parent]);
            }
        }
    }
}

/// Velocity change of every body from impulses on the bodies and residuals of the joint rows: solves
/// `M dv = impulses + Jᵀ λ`, `J dv + Γ λ = residuals`. `impulses` and `residuals` are used up.
pub(crate) fn solve(links: &[Link], impulses: &mut [Vec6], residuals: &mut [Vec6], dv: &mut [Vec6]) {
    dispatch::run(Solve { links, impulses, residuals, dv });
}

/// Plain arithmetic, as in [`Factor`]. P and D⁻¹ are symmetric: their rows are their columns.
struct Solve<'a> {
    links: &'a [Link],
    impulses: &'a mut [Vec6],
    residuals: &'a mut [Vec6],
    dv: &'a mut [Vec6],
}

impl Kernel for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { links, impulses, residuals, dv } = self;
        // Leaf to root: what the subtree below a joint pushes through it.
        for (i, link) in links.iter().enumerate().rev() {
            add_scaled(&mut residuals[i], &mul_transposed(&link.y_columns, &impulses[i]), -1.0);
            let parent = link.parent as usize;
            if parent < links.len() {
                let push = mul_transposed(&link.d_inverse, &residuals[i]);
                add_scaled(&mut impulses[parent], &mul_transposed(&link.parent_rows, &push), 1.0);
            }
        }
        // Root to leaf.
        for (i, link) in links.iter().enumerate() {
            let parent = link.parent as usize;
            if parent < links.len() {
                add_scaled(&mut residuals[i], &mul_transposed(&link.parent_columns, &dv[parent]), -1.0);
            }
            let lambda = mul_transposed(&link.d_inverse, &residuals[i]);
            dv[i] = mul_transposed(&link.inverse, &impulses[i]);
            add_scaled(&mut dv[i], &mul_transposed(&link.y, &lambda), 1.0);
        }
    }
}
