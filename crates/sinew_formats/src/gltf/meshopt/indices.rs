//! Streams of indices: triangles by recent edges and vertices (extension, appendix A, mode 1), and sequences as
//! differences from the last two indices (mode 2).

use super::{Reader, unzigzag};

type Indices = Result<Vec<u32>, &'static str>;

/// The last 16 entries.
struct Recent<T> {
    items: [T; 16],
    next: usize,
}

impl<T: Copy> Recent<T> {
    fn new(item: T) -> Self {
        Self { items: [item; 16], next: 0 }
    }

    fn push(&mut self, item: T) {
        self.items[self.next & 15] = item;
        self.next = self.next.wrapping_add(1);
    }

    /// Returns the entry pushed `by` entries ago: 1 is the last.
    fn back(&self, by: usize) -> T {
        self.items[self.next.wrapping_sub(by) & 15]
    }
}

struct Triangles<'a> {
    data: Reader<'a>,
    edges: Recent<[u32; 2]>,
    vertices: Recent<u32>,
    /// The lowest unused index.
    next: u32,
    /// The last index written.
    last: u32,
    out: Vec<u32>,
}

/// Decodes `count` indices, three per triangle.
pub(super) fn decode_triangles(bytes: &[u8], count: usize) -> Indices {
    if !count.is_multiple_of(3) {
        return Err("triangles have three corners");
    }
    let version = match bytes.first() {
        Some(0xE0) => 0,
        Some(0xE1) => 1,
        _ => return Err("it does not have the first byte of triangles"),
    };
    let mut reader = Reader { rest: &bytes[1..] };
    let codes = reader.take(count / 3)?;
    let length = reader.rest.len().checked_sub(16).ok_or("it is cut off")?;
    let (data, table) = reader.rest.split_at(length);
    let mut state = Triangles {
        data: Reader { rest: data },
        edges: Recent::new([u32::MAX; 2]),
        vertices: Recent::new(u32::MAX),
        next: 0,
        last: 0,
        out: Vec::with_capacity(count),
    };
    let fifo_codes = if version == 1 { 13 } else { 15 };
    for &code in codes {
        match code {
            0..0xF0 => state.by_edge(code, fifo_codes)?,
            0xF0..0xFE => state.by_table(table[usize::from(code & 15)]),
            _ => state.free(code)?,
        }
    }
    if state.data.rest.is_empty() { Ok(state.out) } else { Err("bytes are left over") }
}

impl Triangles<'_> {
    fn fresh(&mut self) -> u32 {
        let index = self.next;
        self.next = self.next.wrapping_add(1);
        index
    }

    /// Reads an index as its difference from the last.
    fn explicit(&mut self) -> Result<u32, &'static str> {
        self.last = self.last.wrapping_add(unzigzag(self.data.varint()?));
        Ok(self.last)
    }

    fn push(&mut self, [a, b, c]: [u32; 3], edges: &[[u32; 2]]) {
        self.out.extend([a, b, c]);
        edges.iter().for_each(|&edge| self.edges.push(edge));
    }

    /// Reads a triangle at a recent edge.
    fn by_edge(&mut self, code: u8, fifo_codes: u8) -> Result<(), &'static str> {
        let [a, b] = self.edges.back(1 + usize::from(code >> 4));
        let third = code & 15;
        let c = match third {
            0 => self.fresh(),
            _ if third < fifo_codes => self.vertices.back(1 + usize::from(third)),
            15 => self.explicit()?,
            // 13 and 14 mean one less and one more than the last index.
            _ => {
                self.last = if third == 13 { self.last.wrapping_sub(1) } else { self.last.wrapping_add(1) };
                self.last
            }
        };
        if third == 0 || third >= fifo_codes {
            self.vertices.push(c);
        }
        self.push([a, b, c], &[[c, b], [a, c]]);
        Ok(())
    }

    /// Reads a triangle that starts with a new vertex; a code from the table gives the other two.
    fn by_table(&mut self, code: u8) {
        let a = self.fresh();
        let corner = |state: &mut Self, code: u8| match code {
            0 => state.fresh(),
            _ => state.vertices.back(usize::from(code)),
        };
        let b = corner(self, code >> 4);
        let c = corner(self, code & 15);
        self.vertices.push(a);
        self.new_vertices([(code >> 4, b), (code & 15, c)]);
        self.push([a, b, c], &[[b, a], [c, b], [a, c]]);
    }

    /// Reads a triangle of any three vertices.
    fn free(&mut self, code: u8) -> Result<(), &'static str> {
        let others = self.data.byte()?;
        if others == 0 {
            self.next = 0;
        }
        let first = if code == 0xFE { 0 } else { 15 };
        let codes = [first, others >> 4, others & 15];
        let mut corners = [0; 3];
        for (corner, code) in corners.iter_mut().zip(codes) {
            *corner = match code {
                0 => self.fresh(),
                15 => 0,
                _ => self.vertices.back(usize::from(code)),
            };
        }
        for (corner, code) in corners.iter_mut().zip(codes) {
            if code == 15 {
                *corner = self.explicit()?;
            }
        }
        let [a, b, c] = corners;
        self.vertices.push(a);
        self.new_vertices([(codes[1], b), (codes[2], c)]);
        self.push(corners, &[[b, a], [c, b], [a, c]]);
        Ok(())
    }

    /// Stores the indices that were new or explicit.
    fn new_vertices(&mut self, corners: [(u8, u32); 2]) {
        for (code, index) in corners {
            if code == 0 || code == 15 {
                self.vertices.push(index);
            }
        }
    }
}

/// Decodes `count` indices in any order.
pub(super) fn decode_sequence(bytes: &[u8], count: usize) -> Indices {
    match bytes.first() {
        Some(0xD0 | 0xD1) => {}
        _ => return Err("it does not have the first byte of indices"),
    }
    // The four padding bytes let decoders read ahead.
    let length = bytes.len().checked_sub(5).ok_or("it is cut off")?;
    let mut reader = Reader { rest: &bytes[1..1 + length] };
    let mut last = [0_u32; 2];
    let mut out = Vec::with_capacity(count.min(length));
    for _ in 0..count {
        let code = reader.varint()?;
        let last = &mut last[(code & 1) as usize];
        *last = last.wrapping_add(unzigzag(code >> 1));
        out.push(*last);
    }
    if reader.rest.is_empty() { Ok(out) } else { Err("bytes are left over") }
}
