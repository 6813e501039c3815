//! Topology of corners, edges and faces: half-edges, stored face by face.

use sinew_math::Vec3;

/// Plane of a face: `normal · x ≤ offset` inside.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Plane {
    /// Outward unit normal.
    pub normal: Vec3,
    pub offset: f32,
}

impl Plane {
    /// Height of a point over the plane, metres.
    pub fn height(&self, p: Vec3) -> f32 {
        self.normal.dot(p) - self.offset
    }
}

/// A side of a face, counter-clockwise from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct HalfEdge {
    /// Index of the corner at which the half-edge starts.
    pub origin: u8,
    /// Index of the face to which the half-edge belongs.
    pub face: u8,
    /// Index of the half-edge of the same edge in the other face, with the opposite direction.
    pub twin: u16,
}

/// Half-edges of a face: `count` of them, starting at `first`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Loop {
    pub first: u16,
    pub count: u16,
}

/// Faces and half-edges of a polytope, without the positions of its corners.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Topology<'a> {
    pub faces: &'a [Loop],
    pub half_edges: &'a [HalfEdge],
}

impl<'a> Topology<'a> {
    /// Indices of the half-edges of a face, in order.
    pub fn sides(self, face: usize) -> core::ops::Range<usize> {
        let Loop { first, count } = self.faces[face];
        usize::from(first)..usize::from(first + count)
    }

    /// Iterates over the corner indices of a face, in order.
    pub fn corners(self, face: usize) -> impl ExactSizeIterator<Item = usize> + Clone + use<'a> {
        self.sides(face).map(move |side| usize::from(self.half_edges[side].origin))
    }

    /// Iterates over the half-edges that represent an edge: one per pair.
    pub fn edge_numbers(self) -> impl Iterator<Item = usize> + 'a {
        (0..self.half_edges.len()).filter(move |&side| self.is_first(side))
    }

    /// True if a half-edge exists and represents its edge.
    pub fn has_edge(self, side: usize) -> bool {
        side < self.half_edges.len() && self.is_first(side)
    }

    /// True if a half-edge represents its edge.
    pub fn is_first(self, side: usize) -> bool {
        side < usize::from(self.half_edges[side].twin)
    }

    /// Index of the half-edge that represents the edge of `side`.
    pub fn edge_of(self, side: usize) -> usize {
        usize::min(side, usize::from(self.half_edges[side].twin))
    }

    /// Indices of the corners where a half-edge starts and ends.
    pub fn ends(self, side: usize) -> [usize; 2] {
        let HalfEdge { origin, twin, .. } = self.half_edges[side];
        [origin, self.half_edges[usize::from(twin)].origin].map(usize::from)
    }

    /// Indices of the faces on both sides of a half-edge, its own face first.
    pub fn faces_of(self, side: usize) -> [usize; 2] {
        let HalfEdge { face, twin, .. } = self.half_edges[side];
        [face, self.half_edges[usize::from(twin)].face].map(usize::from)
    }
}

/// An owned [`Topology`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Outline {
    faces: Vec<Loop>,
    half_edges: Vec<HalfEdge>,
}

impl Outline {
    /// Builds the topology of a polytope from the corners of each face, counter-clockwise from outside.
    ///
    /// # Errors
    /// A description of the problem, if the faces are not the surface of one solid without holes in which three or more
    /// faces meet at each corner.
    pub fn new(loops: &[Vec<u8>], corners: usize) -> Result<Self, &'static str> {
        let (mut faces, mut half_edges, mut ends) = (Vec::new(), Vec::new(), Vec::new());
        for (face, ring) in loops.iter().enumerate() {
            if ring.len() < 3 {
                return Err("a face of a hull has fewer than three corners");
            }
            if ring.iter().any(|&corner| usize::from(corner) >= corners) {
                return Err("a face of a hull refers to a missing corner");
            }
            faces.push(Loop { first: half_edges.len() as u16, count: ring.len() as u16 });
            for (k, &origin) in ring.iter().enumerate() {
                half_edges.push(HalfEdge { origin, face: face as u8, twin: 0 });
                ends.push([origin, ring[(k + 1) % ring.len()]]);
            }
        }
        let mut order: Vec<u16> = (0..half_edges.len() as u16).collect();
        order.sort_unstable_by_key(|&side| ends[usize::from(side)]);
        if order.windows(2).any(|pair| ends[usize::from(pair[0])] == ends[usize::from(pair[1])]) {
            return Err("two faces of a hull have a side with the same direction");
        }
        for (side, &[from, to]) in ends.iter().enumerate() {
            let across = order.binary_search_by_key(&[to, from], |&other| ends[usize::from(other)]);
            half_edges[side].twin = order[across.map_err(|_| "a hull is not closed")?];
        }
        let outline = Self { faces, half_edges };
        outline.check(corners)?;
        Ok(outline)
    }

    /// Checks that the faces form one closed surface without handles (Euler: V − E + F = 2), with one fan of faces
    /// around each corner.
    fn check(&self, corners: usize) -> Result<(), &'static str> {
        let mut leaving = vec![0_u32; corners];
        let mut start = vec![None; corners];
        for (side, half_edge) in self.half_edges.iter().enumerate() {
            leaving[usize::from(half_edge.origin)] += 1;
            start[usize::from(half_edge.origin)] = Some(side);
        }
        for (start, &leaving) in start.into_iter().zip(&leaving) {
            let around = start.map_or(0, |start| self.turns_around(start));
            if leaving < 3 || around != leaving {
                return Err("fewer than three faces, or two fans of faces, meet at a corner of a hull");
            }
        }
        let euler = corners as i64 - self.half_edges.len() as i64 / 2 + self.faces.len() as i64;
        if euler != 2 || self.connected() != self.faces.len() {
            return Err("a hull is not one solid without holes");
        }
        Ok(())
    }

    /// Number of half-edges that leave a corner, counted around the corner.
    fn turns_around(&self, start: usize) -> u32 {
        let (mut side, mut count) = (start, 0);
        loop {
            side = self.next(usize::from(self.half_edges[side].twin));
            count += 1;
            if side == start {
                return count;
            }
        }
    }

    /// Returns the half-edge that follows `side` around its face.
    fn next(&self, side: usize) -> usize {
        let Loop { first, count } = self.faces[usize::from(self.half_edges[side].face)];
        let after = side + 1;
        if after == usize::from(first + count) { usize::from(first) } else { after }
    }

    /// Number of faces connected to the first face, including it.
    fn connected(&self) -> usize {
        let mut met = vec![false; self.faces.len()];
        let (mut open, mut count) = (vec![0], 1);
        met[0] = true;
        while let Some(face) = open.pop() {
            for side in self.topology().sides(face) {
                let [_, next] = self.topology().faces_of(side);
                if !core::mem::replace(&mut met[next], true) {
                    count += 1;
                    open.push(next);
                }
            }
        }
        count
    }

    pub fn topology(&self) -> Topology<'_> {
        Topology { faces: &self.faces, half_edges: &self.half_edges }
    }
}
