//! Articulated inverse inertia: the velocity change of one body of a tree from an impulse on another, with the
//! joints holding. A contact that sees its link's own mass instead sinks: a 1 kg foot under 69 kg by 72 mm.

use super::loops::MAX_EXACT_ROWS;
use super::tree::{Link, NONE};
use crate::spatial::{Mat6, Vec6, ZERO6, ZERO66, add_scaled, transpose};
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::Lanes;

/// Blocks `W_ij` (6×6) between the bodies of each tree that carry rows, and their ancestors.
#[derive(Clone, Debug, Default)]
pub(crate) struct Response {
    /// Per body: its position among the members of its tree, or `NONE`.
    slot: Vec<u32>,
    /// Members of all trees, tree after tree, parents first.
    members: Vec<u32>,
    /// Per tree: range in `members`, start of its blocks.
    trees: Vec<TreeBlocks>,
    blocks: Vec<Mat6>,
}

#[derive(Clone, Copy, Debug, Default)]
struct TreeBlocks {
    first: usize,
    count: usize,
    blocks: usize,
}

impl Response {
    /// Chooses the members: `wanted` bodies with everything between them and the root. Links of a tree are contiguous.
    pub fn choose(&mut self, links: &[Link], tree_count: usize, wanted: &[bool]) {
        self.slot.clear();
        self.slot.resize(links.len(), NONE);
        for i in (0..links.len()).rev() {
            let parent = links[i].parent as usize;
            if (wanted[i] || self.slot[i] != NONE) && parent < links.len() {
                self.slot[parent] = 0;
            }
            if wanted[i] {
                self.slot[i] = 0;
            }
        }
        self.members.clear();
        self.trees.clear();
        self.trees.resize(tree_count, TreeBlocks::default());
        let mut blocks = 0;
        let mut i = 0;
        for (tree, entry) in self.trees.iter_mut().enumerate() {
            entry.first = self.members.len();
            entry.blocks = blocks;
            while i < links.len() && links[i].tree as usize == tree {
                if self.slot[i] != NONE {
                    self.slot[i] = (self.members.len() - entry.first) as u32;
                    self.members.push(i as u32);
                }
                i += 1;
            }
            entry.count = self.members.len() - entry.first;
            blocks += entry.count * entry.count;
        }
        self.blocks.resize(blocks, ZERO66);
    }

    /// Fills the blocks from the factored links: for `c` below `p`, `W_cj = A_c W_pj` with `A_c` the transfer of the
    /// joint, since nothing acts below it; `W_cc = L_c + A_c W_pp A_cᵀ`.
    pub fn fill(&mut self, links: &[Link]) {
        dispatch::run(Fill { response: self, links });
    }

    /// Members of a tree, parents first.
    pub fn members(&self, tree: u32) -> &[u32] {
        let tree = &self.trees[tree as usize];
        &self.members[tree.first..tree.first + tree.count]
    }

    /// Place of a body among the members of its tree; `None` for fixed bodies.
    pub fn slot(&self, body: u32) -> Option<usize> {
        self.slot.get(body as usize).map(|&slot| slot as usize)
    }

    /// Closes the loops of a tree: `W −= U S⁻¹ Uᵀ` with the columns U of the loop rows, `n` of them.
    pub fn close(&mut self, tree: u32, columns: &[Vec6], inverse: &[f32], n: usize) {
        let TreeBlocks { count, blocks, .. } = self.trees[tree as usize];
        for j in 0..count {
            // S⁻¹ U_jᵀ, row by row of S⁻¹.
            let mut answer = [ZERO6; MAX_EXACT_ROWS];
            for (k, line) in answer.iter_mut().enumerate().take(n) {
                for l in 0..n {
                    add_scaled(line, &columns[l * count + j], inverse[k * n + l]);
                }
            }
            for i in 0..count {
                let block = &mut self.blocks[blocks + i * count + j];
                for (k, line) in answer.iter().enumerate().take(n) {
                    let column = &columns[k * count + i];
                    for (row, factor) in block.iter_mut().zip(column) {
                        add_scaled(row, line, -factor);
                    }
                }
            }
        }
    }

    /// Adds to `out` the velocity changes of all members of the tree of a moving body from an impulse on it.
    pub fn answer(&self, links: &[Link], body: u32, impulse: &Vec6, out: &mut [Vec6]) {
        let TreeBlocks { count, blocks, .. } = self.trees[links[body as usize].tree as usize];
        // W is symmetric: the row of blocks of the body, transposed, is its column, and lies in one piece of memory.
        let row = blocks + self.slot[body as usize] as usize * count;
        dispatch::run(Spread { impulse, blocks: &self.blocks[row..row + count], out });
    }
}

/// The blocks of all trees.
struct Fill<'a> {
    response: &'a mut Response,
    links: &'a [Link],
}

impl Kernel for Fill<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { response, links } = self;
        for tree in &response.trees {
            let members = &response.members[tree.first..tree.first + tree.count];
            let n = tree.count;
            let blocks = &mut response.blocks[tree.blocks..tree.blocks + n * n];
            for (c, &body) in members.iter().enumerate() {
                let link = &links[body as usize];
                let mut own = link.response_with_parent_held::<L>();
                let parent = link.parent as usize;
                // The root is always the first member.
                if parent < links.len() {
                    let p = response.slot[parent] as usize;
                    let mut transfer = ZERO66;
                    store(link.transfer::<L>(), &mut transfer);
                    for j in 0..c {
                        let mut block = ZERO66;
                        store(product::<L>(&transfer, &blocks[p * n + j]), &mut block);
                        blocks[j * n + c] = transpose(&block);
                        blocks[c * n + j] = block;
                    }
                    let through = product::<L>(&transfer, &blocks[p * n + c]);
                    for (own, add) in own.iter_mut().zip(through) {
                        *own = *own + add;
                    }
                }
                store(own, &mut blocks[c * n + c]);
            }
        }
    }
}

/// `a b`
#[inline(always)]
fn product<L: Lanes>(a: &Mat6, b: &Mat6) -> [L; 6] {
    let [r0, r1, r2, r3, r4, r5] = b;
    let (r0, r1, r2) = (L::load(r0), L::load(r1), L::load(r2));
    let (r3, r4, r5) = (L::load(r3), L::load(r4), L::load(r5));
    let mut out = [L::splat(0.0); 6];
    for (out, a) in out.iter_mut().zip(a) {
        *out = r0 * L::splat(a[0])
            + r1 * L::splat(a[1])
            + r2 * L::splat(a[2])
            + r3 * L::splat(a[3])
            + r4 * L::splat(a[4])
            + r5 * L::splat(a[5]);
    }
    out
}

/// Six rows into a matrix.
#[inline(always)]
fn store<L: Lanes>(rows: [L; 6], out: &mut Mat6) {
    for (row, out) in rows.into_iter().zip(out) {
        row.store(out);
    }
}

/// Velocity changes of the members of a tree from an impulse on one of them.
struct Spread<'a> {
    impulse: &'a Vec6,
    /// Transposed, one a member.
    blocks: &'a [Mat6],
    out: &'a mut [Vec6],
}

impl Kernel for Spread<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let [p0, p1, p2, p3, p4, p5, ..] = *self.impulse;
        let (p0, p1, p2) = (L::splat(p0), L::splat(p1), L::splat(p2));
        let (p3, p4, p5) = (L::splat(p3), L::splat(p4), L::splat(p5));
        for (out, block) in self.out.iter_mut().zip(self.blocks) {
            let [r0, r1, r2, r3, r4, r5] = block;
            let change = L::load(r0) * p0
                + L::load(r1) * p1
                + L::load(r2) * p2
                + L::load(r3) * p3
                + L::load(r4) * p4
                + L::load(r5) * p5;
            (L::load(out) + change).store(out);
        }
    }
}
