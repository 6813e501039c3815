//! Articulated inverse inertia: the velocity change of one body of a tree from an impulse on another, with the
//! joints holding. A contact that sees its link's own mass instead sinks: a 1 kg foot under 69 kg by 72 mm.

use super::loops::MAX_EXACT_ROWS;
use super::tree::{Link, NONE, store, sum};
use crate::spatial::{Mat6, Vec6, ZERO6, ZERO66, add_scaled, transpose};
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::Lanes;

/// Blocks `W_ij` (6×6) between the bodies of each tree that carry rows, and their ancestors. Those above the diagonal are needed
/// where loops are closed only: what a body gets from an impulse on an earlier one it has from its parent.
#[derive(Clone, Debug, Default)]
pub(crate) struct Response {
    /// Per body: its position among the members of its tree, or `NONE`.
    slot: Vec<u32>,
    /// Members of all trees, tree after tree, parents first.
    members: Vec<u32>,
    /// Place of each one's parent among them; 0 of a root.
    above: Vec<u32>,
    /// Per tree: range in `members`, start of its blocks.
    trees: Vec<TreeBlocks>,
    blocks: Vec<Mat6>,
}

#[derive(Clone, Copy, Debug, Default)]
struct TreeBlocks {
    first: usize,
    count: usize,
    blocks: usize,
    /// All blocks are there, not only those on and below the diagonal.
    full: bool,
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
        self.above.clear();
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
                    let parent = self.slot.get(links[i].parent as usize);
                    self.above.push(parent.map_or(0, |&place| place));
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

    /// Bytes that are filled.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.blocks[..]) + size_of_val(&self.members[..]) + size_of_val(&self.slot[..])
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
        self.trees[tree as usize].full = true;
        for i in 0..count {
            for j in 0..i {
                self.blocks[blocks + j * count + i] = transpose(&self.blocks[blocks + i * count + j]);
            }
        }
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

    /// Makes `out`, which is zero, the velocity changes of all members of the tree of a moving body from an impulse on it. Where
    /// it is the only member, adds to its velocity.
    pub fn answer(&self, links: &[Link], body: u32, impulse: &Vec6, out: &mut [Vec6]) {
        let TreeBlocks { first, count, blocks, full } = self.trees[links[body as usize].tree as usize];
        let slot = self.slot[body as usize] as usize;
        // W is symmetric: the row of blocks of the body, transposed, is its column, and lies in one piece of memory.
        let row = blocks + slot * count;
        let known = if full { count } else { slot + 1 };
        let blocks = &self.blocks[row..row + known];
        if full || count == 1 {
            dispatch::run(Spread { impulse, blocks, out });
            return;
        }
        let later = first + known..first + count;
        let (members, above) = (&self.members[later.clone()], &self.above[later]);
        dispatch::run(SpreadDown { impulse, blocks, members, above, links, out });
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
                let mut own = load::<L>(link.response_with_parent_held());
                let parent = link.parent as usize;
                // The root is always the first member.
                if parent < links.len() {
                    let p = response.above[tree.first + c] as usize;
                    let carry = link.carry::<L>();
                    let (above, row) = blocks.split_at_mut(c * n);
                    for j in 0..=p {
                        store(product(&carry, &above[p * n + j]), &mut row[j]);
                    }
                    for j in p + 1..c {
                        // Not above this body: an impulse there moves this one by way of its parent.
                        let other = &links[members[j] as usize];
                        let by = row[response.above[tree.first + j] as usize];
                        for (out, by) in row[j].iter_mut().zip(&by) {
                            other.carried::<L>(by).store(out);
                        }
                    }
                    // A W_pp Aᵀ is A times the parent's answer to this body.
                    let through = product(&carry, &transpose(&row[p]));
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
pub(super) fn product<L: Lanes>(a: &[[L; 6]; 6], b: &Mat6) -> [L; 6] {
    let [r0, r1, r2, r3, r4, r5] = load::<L>(b);
    let mut out = [L::splat(0.0); 6];
    for (out, [a0, a1, a2, a3, a4, a5]) in out.iter_mut().zip(a) {
        *out = (r0 * *a0 + r1 * *a1) + (r2 * *a2 + r3 * *a3) + (r4 * *a4 + r5 * *a5);
    }
    out
}

/// The rows of a matrix.
#[inline(always)]
pub(super) fn load<L: Lanes>(m: &Mat6) -> [L; 6] {
    let [r0, r1, r2, r3, r4, r5] = m;
    [L::load(r0), L::load(r1), L::load(r2), L::load(r3), L::load(r4), L::load(r5)]
}

/// Velocity changes of the members of a tree from an impulse on one of them: of those up to it by its row of blocks, of later ones,
/// on which nothing acts, by what their parents carry over.
struct SpreadDown<'a> {
    impulse: &'a Vec6,
    blocks: &'a [Mat6],
    /// Later bodies and the places of their parents.
    members: &'a [u32],
    above: &'a [u32],
    links: &'a [Link],
    out: &'a mut [Vec6],
}

impl Kernel for SpreadDown<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { impulse, blocks, members, above, links, out } = self;
        for (out, block) in out.iter_mut().zip(blocks) {
            sum::<L>(block, impulse).store(out);
        }
        for (k, (&body, &above)) in members.iter().zip(above).enumerate() {
            let (before, rest) = out.split_at_mut(blocks.len() + k);
            links[body as usize].carried::<L>(&before[above as usize]).store(&mut rest[0]);
        }
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
        for (out, block) in self.out.iter_mut().zip(self.blocks) {
            (L::load(out) + sum::<L>(block, self.impulse)).store(out);
        }
    }
}
