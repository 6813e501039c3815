//! Rasteriser: finds the samples of a picture that a triangle covers, in exact integers, so that triangles with a common edge cover
//! every sample once (top-left rule). Processes eight samples of neighbouring pixels in lanes.

use crate::pipeline::clip::ClipVertex;
use core::ops::Range;
use sinew::math::dispatch::{self, Kernel};
use sinew::math::lanes::{LaneMask, Lanes, WIDTH};

/// Fixed-point units per pixel.
const UNIT: i64 = 256;

/// Returns the largest whole number up to `x`, limited to `i32`. `f32::floor` is a function call on plain x86-64, and each pixel needs
/// it several times.
#[inline(always)]
pub(crate) fn floor(x: f32) -> i32 {
    let toward_zero = x as i32;
    if toward_zero as f32 > x { toward_zero.saturating_sub(1) } else { toward_zero }
}

/// Depth and triangle of every sample of a picture, or of a band of its rows. The samples of a pixel are side by side.
#[derive(Clone, Debug)]
pub(crate) struct Samples {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Positions of the samples in a pixel, 1/256 pixel from its centre: one, or four.
    offsets: &'static [[i64; 2]],
    /// Number of samples from a row to the next: whole lanes, so that no lane reaches into another row.
    stride: usize,
    /// Depth of each sample, `1 / w`: larger is nearer, 0 is empty.
    depth: Vec<f32>,
    /// Triangle of each sample; [`NOTHING`] if there is none.
    ids: Vec<u32>,
}

/// Id of a sample that no triangle covers.
pub(crate) const NOTHING: u32 = u32::MAX;

/// A quantity that changes linearly over the picture.
#[derive(Clone, Copy, Debug)]
struct Ramp {
    x0: f32,
    y0: f32,
    at_origin: f32,
    per_x: f32,
    per_y: f32,
}

/// A triangle on the picture, with its corners ordered so that its area is positive.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Footprint {
    /// Corners, 1/256 pixel from the upper left corner of the picture.
    corners: [[i64; 2]; 3],
    depth: Ramp,
    id: u32,
}

/// Winding of a triangle's corners as seen from the camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Winding {
    CounterClockwise,
    Clockwise,
}

/// A corner on the picture in pixels from the upper left corner, with its depth (larger is nearer).
#[derive(Clone, Copy, Debug)]
pub(crate) struct ScreenVertex {
    pub(crate) x: f32,
    pub(crate) y: f32,
    pub(crate) depth: f32,
}

impl ScreenVertex {
    /// Applies the perspective division. The depth is `1 / w`, which is linear over the picture.
    pub(crate) fn from_clip([x, y, w]: ClipVertex, width: usize, height: usize) -> Self {
        let depth = 1.0 / w;
        Self {
            x: (x * depth + 1.0) * (0.5 * width as f32),
            y: (1.0 - y * depth) * (0.5 * height as f32),
            depth,
        }
    }
}

impl Footprint {
    /// Returns `None` if the corners lie on one line after rounding to 1/256 pixel.
    pub(crate) fn new(vertices: [ScreenVertex; 3], id: u32) -> Option<(Self, Winding)> {
        let fixed = |v: ScreenVertex| [v.x, v.y].map(|pixels| i64::from(floor(pixels * UNIT as f32 + 0.5)));
        let [a, b, c] = [fixed(vertices[0]), fixed(vertices[1]), fixed(vertices[2])];
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        if area == 0 {
            return None;
        }
        let depths = [vertices[0].depth, vertices[1].depth, vertices[2].depth];
        let depth = Ramp::through([a, b, c], depths, area);
        // y points down on the picture, so a positive area appears clockwise.
        if area > 0 {
            Some((Self { corners: [a, b, c], depth, id }, Winding::Clockwise))
        } else {
            Some((Self { corners: [a, c, b], depth, id }, Winding::CounterClockwise))
        }
    }
}

impl Ramp {
    fn through([a, b, c]: [[i64; 2]; 3], values: [f32; 3], area: i64) -> Self {
        let pixels = |fixed: i64| fixed as f32 / UNIT as f32;
        let (bx, by) = (pixels(b[0] - a[0]), pixels(b[1] - a[1]));
        let (cx, cy) = (pixels(c[0] - a[0]), pixels(c[1] - a[1]));
        let (vb, vc) = (values[1] - values[0], values[2] - values[0]);
        let det = area as f32 / (UNIT * UNIT) as f32;
        Self {
            x0: pixels(a[0]),
            y0: pixels(a[1]),
            at_origin: values[0],
            per_x: (vb * cy - vc * by) / det,
            per_y: (vc * bx - vb * cx) / det,
        }
    }
}

impl Samples {
    /// Creates an empty picture.
    ///
    /// # Panics
    /// If there are neither one nor four samples a pixel.
    pub(crate) fn new(width: usize, height: usize, offsets: &'static [[i64; 2]]) -> Self {
        assert!(matches!(offsets.len(), 1 | 4), "{} samples a pixel", offsets.len());
        let stride = (width * offsets.len()).next_multiple_of(WIDTH);
        let all = stride * height;
        Self { width, height, offsets, stride, depth: vec![0.0; all], ids: vec![NOTHING; all] }
    }

    /// Returns the triangles of the samples of neighbouring pixels.
    #[inline(always)]
    pub(crate) fn ids(&self, x: usize, y: usize, pixels: usize) -> &[u32] {
        let (start, count) = (y * self.stride + x * self.offsets.len(), pixels * self.offsets.len());
        &self.ids[start..start + count]
    }

    /// Returns the depth of the first sample of a pixel.
    pub(crate) fn depth(&self, x: usize, y: usize) -> f32 {
        self.depth[y * self.stride + x * self.offsets.len()]
    }

    /// Returns the position of a sample from the upper left corner of its pixel, in pixels.
    #[inline(always)]
    pub(crate) fn place(&self, sample: usize) -> [f32; 2] {
        self.offsets[sample].map(|o| 0.5 + o as f32 / UNIT as f32)
    }

    /// Splits the picture into at most `most` bands of rows.
    pub(crate) fn bands(&mut self, most: usize) -> impl Iterator<Item = Band<'_>> {
        let rows = self.height.div_ceil(most.max(1)).max(1);
        let (width, stride, height, offsets) = (self.width, self.stride, self.height, self.offsets);
        let chunks = self.depth.chunks_mut(rows * stride).zip(self.ids.chunks_mut(rows * stride));
        chunks.enumerate().map(move |(band, (depth, ids))| Band {
            area: Area { width, stride, rows: band * rows..height.min((band + 1) * rows) },
            offsets,
            depth,
            ids,
        })
    }
}

/// Rows of a picture that one thread draws.
pub(crate) struct Band<'a> {
    area: Area,
    offsets: &'static [[i64; 2]],
    depth: &'a mut [f32],
    ids: &'a mut [u32],
}

impl Band<'_> {
    pub(crate) fn clear(&mut self) {
        self.depth.fill(0.0);
        self.ids.fill(NOTHING);
    }

    /// Clears the band so that only surfaces nearer than `behind` are drawn.
    pub(crate) fn clear_in_front_of(&mut self, behind: &Self) {
        self.depth.copy_from_slice(behind.depth);
        self.ids.fill(NOTHING);
    }

    /// Draws triangles in order, each where it is nearer than the present content. At equal depths the first triangle stays.
    pub(crate) fn draw(&mut self, footprints: &[Footprint]) {
        dispatch::run(Draw { band: self, footprints });
    }
}

struct Draw<'a, 'b> {
    band: &'a mut Band<'b>,
    footprints: &'a [Footprint],
}

impl Kernel for Draw<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Band { area, offsets, depth, ids } = self.band;
        let lattice = Lattice::new(offsets);
        for footprint in self.footprints {
            let mut nearest = Nearest { depth, ids, id: footprint.id };
            scan::<L>(footprint, area, &lattice, &mut nearest);
        }
    }
}

/// Depths and triangles of samples while a triangle is drawn.
struct Nearest<'a> {
    depth: &'a mut [f32],
    ids: &'a mut [u32],
    id: u32,
}

impl Cells for Nearest<'_> {
    #[inline(always)]
    fn visit<L: Lanes>(&mut self, Pixel { start, .. }: Pixel, z: L, inside: L::Mask) {
        let depth = self.depth[start..].first_chunk_mut::<WIDTH>();
        let (Some(depth), Some(ids)) = (depth, self.ids[start..].first_chunk_mut::<WIDTH>()) else { return };
        let old = L::load(depth);
        let is_nearer = L::gt(z, old) & inside;
        L::select(is_nearer, z, old).store(depth);
        // Select integers through their bits as floats. The bits may be those of a NaN or a subnormal, but no
        // arithmetic uses them.
        let (mut bits, mut chosen) = ([0.0; WIDTH], [0.0; WIDTH]);
        for i in 0..WIDTH {
            bits[i] = f32::from_bits(ids[i]);
        }
        let id = L::splat(f32::from_bits(self.id));
        L::select(is_nearer, id, L::load(&bits)).store(&mut chosen);
        for i in 0..WIDTH {
            ids[i] = chosen[i].to_bits();
        }
    }
}

/// Column at which an edge begins or ends each row of a triangle, updated from row to row without a division.
#[derive(Clone, Copy, Debug)]
struct EdgeWalk {
    /// Quotient and remainder of `value / pace`, with `value` the edge function at column 0 of the row.
    quotient: i64,
    rest: i64,
    quotient_step: i64,
    rest_step: i64,
    /// Magnitude of the edge function's change per column; 1 for a horizontal edge.
    pace: i64,
    side: Side,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    /// Inside is to the right of the edge.
    Left,
    /// Inside is to the left of the edge.
    Right,
    /// The whole row is inside or outside.
    Level,
}

impl EdgeWalk {
    /// Creates the edge from `a` to `b`, starting at the row whose samples have height `y`; `x` is the sample of column 0.
    fn new(a: [i64; 2], b: [i64; 2], x: i64, y: i64) -> Self {
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let value = dx * (y - a[1]) - dy * (x - a[0]);
        // Samples exactly on a left or top edge belong to the triangle, samples on other edges to its neighbour.
        let value = if dy < 0 || (dy == 0 && dx > 0) { value } else { value - 1 };
        let (pace, side) = match dy {
            0 => (1, Side::Level),
            ..0 => (-dy * UNIT, Side::Left),
            _ => (dy * UNIT, Side::Right),
        };
        let row_step = dx * UNIT;
        Self {
            quotient: value.div_euclid(pace),
            rest: value.rem_euclid(pace),
            quotient_step: row_step.div_euclid(pace),
            rest_step: row_step.rem_euclid(pace),
            pace,
            side,
        }
    }

    /// Narrows the columns `first..=last` to those inside, then moves down one row.
    #[inline(always)]
    fn next_row(&mut self, first: &mut i64, last: &mut i64) {
        match self.side {
            Side::Left => *first = i64::max(*first, -self.quotient),
            Side::Right => *last = i64::min(*last, self.quotient),
            Side::Level if self.quotient < 0 => *last = -1,
            Side::Level => {}
        }
        self.quotient += self.quotient_step;
        self.rest += self.rest_step;
        if self.rest >= self.pace {
            self.rest -= self.pace;
            self.quotient += 1;
        }
    }
}

/// The edge function of a small triangle at eight samples, stepped by eight: not negative on the inside.
#[derive(Clone, Copy, Debug)]
struct EdgeSteps {
    values: [i32; WIDTH],
    per_pixel: i32,
    per_row: i32,
}

impl EdgeSteps {
    /// Creates the edge from `a` to `b`, starting at the samples of the pixel with the corner `at`. All three are so near to each
    /// other that the products fit 32 bits.
    #[inline(always)]
    fn new(a: [i64; 2], b: [i64; 2], at: [i64; 2], lattice: &Lattice) -> Self {
        let (dx, dy) = ((b[0] - a[0]) as i32, (b[1] - a[1]) as i32);
        let (x, y) = ((at[0] - a[0]) as i32, (at[1] - a[1]) as i32);
        // The top-left rule, as in `EdgeWalk`.
        let belongs = i32::from(dy < 0 || (dy == 0 && dx > 0));
        let at_corner = dx * y - dy * x + belongs - 1;
        let mut values = [0; WIDTH];
        for i in 0..WIDTH {
            values[i] = at_corner + dx * lattice.y[i] - dy * lattice.x[i];
        }
        Self { values, per_pixel: -dy * UNIT as i32, per_row: dx * UNIT as i32 }
    }

    #[inline(always)]
    fn step(&mut self, by: i32) {
        for value in &mut self.values {
            *value += by;
        }
    }
}

/// Pixels and samples of the eight lanes, relative to a first pixel.
pub(crate) struct Lattice {
    /// Number of pixels with eight samples.
    pixels: i64,
    /// Positions of the samples from the corner of the first pixel, 1/256 pixel.
    x: [i32; WIDTH],
    y: [i32; WIDTH],
    /// Columns from the first pixel on.
    columns: [f32; WIDTH],
    /// Positions of the samples in their own pixels, 1/256 pixel: one for each lane.
    x_in_pixel: [f32; WIDTH],
    y_in_pixel: [f32; WIDTH],
    /// Positions of the samples in a pixel, 1/256 pixel: one for each sample.
    places: [[i64; 2]; 4],
    samples: usize,
}

impl Lattice {
    #[inline(always)]
    pub(crate) fn new(offsets: &[[i64; 2]]) -> Self {
        let samples = offsets.len();
        let mut lattice = Self {
            pixels: (WIDTH / samples) as i64,
            x: [0; WIDTH],
            y: [0; WIDTH],
            columns: [0.0; WIDTH],
            x_in_pixel: [0.0; WIDTH],
            y_in_pixel: [0.0; WIDTH],
            places: [[0; 2]; 4],
            samples,
        };
        for (sample, offset) in offsets.iter().enumerate() {
            lattice.places[sample] = [UNIT / 2 + offset[0], UNIT / 2 + offset[1]];
        }
        for i in 0..WIDTH {
            let ([x, y], pixel) = (lattice.places[i % samples], i / samples);
            lattice.x[i] = (x + pixel as i64 * UNIT) as i32;
            lattice.y[i] = y as i32;
            lattice.columns[i] = pixel as f32;
            (lattice.x_in_pixel[i], lattice.y_in_pixel[i]) = (x as f32, y as f32);
        }
        lattice
    }
}

/// Rows of a picture with their layout in memory.
#[derive(Clone, Debug)]
pub(crate) struct Area {
    /// Width in pixels.
    pub(crate) width: usize,
    /// Number of samples from a row to the next.
    pub(crate) stride: usize,
    pub(crate) rows: Range<usize>,
}

/// Column and row of a pixel, and index of its first sample in an area's memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pixel {
    pub(crate) column: usize,
    pub(crate) row: usize,
    pub(crate) start: usize,
}

/// Receives the results of [`scan`].
pub(crate) trait Cells {
    /// Receives the depths of eight neighbouring samples, from the first of a pixel on, and the mask of covered ones: at least one is
    /// covered. Mark it `#[inline(always)]`.
    fn visit<L: Lanes>(&mut self, pixel: Pixel, depth: L, inside: L::Mask);
}

/// A triangle's depth at eight samples.
#[derive(Clone, Copy)]
struct Depths<L> {
    at_origin: L,
    per_x: L,
    columns: L,
    from_x0: L,
}

impl<L: Lanes> Depths<L> {
    #[inline(always)]
    fn new(ramp: &Ramp, lattice: &Lattice) -> Self {
        Self {
            at_origin: L::splat(0.0),
            per_x: L::splat(ramp.per_x),
            columns: L::load(&lattice.columns),
            from_x0: L::load(&lattice.x_in_pixel) / L::splat(UNIT as f32) - L::splat(ramp.x0),
        }
    }

    #[inline(always)]
    fn on_row(self, row: i64, ramp: &Ramp, lattice: &Lattice) -> Self {
        // Sums of whole numbers are exact.
        let y = (L::splat((row * UNIT) as f32) + L::load(&lattice.y_in_pixel)) / L::splat(UNIT as f32);
        let at_origin = L::splat(ramp.at_origin) + L::splat(ramp.per_y) * (y - L::splat(ramp.y0));
        Self { at_origin, ..self }
    }

    #[inline(always)]
    fn at(&self, column: i64) -> L {
        self.at_origin + self.per_x * (L::splat(column as f32) + self.columns + self.from_x0)
    }
}

/// Columns and rows of pixels with samples within a triangle's bounds.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    columns: [i64; 2],
    rows: [i64; 2],
    is_small: bool,
}

impl Bounds {
    /// Returns `None` if the triangle can cover no sample of the area.
    #[inline(always)]
    fn new([a, b, c]: [[i64; 2]; 3], area: &Area) -> Option<Self> {
        let least = [a[0].min(b[0]).min(c[0]), a[1].min(b[1]).min(c[1])];
        let most = [a[0].max(b[0]).max(c[0]), a[1].max(b[1]).max(c[1])];
        let first = [least[0].div_euclid(UNIT), least[1].div_euclid(UNIT)];
        let last = [most[0].div_euclid(UNIT), most[1].div_euclid(UNIT)];
        let columns = [first[0].max(0), last[0].min(area.width as i64 - 1)];
        let rows = [first[1].max(area.rows.start as i64), last[1].min(area.rows.end as i64 - 1)];
        let is_small = last[0] - first[0] < SMALL && last[1] - first[1] < SMALL;
        (columns[0] <= columns[1] && rows[0] <= rows[1]).then_some(Self { columns, rows, is_small })
    }
}

/// Number of columns and rows below which a triangle is small: its edge functions are evaluated at all samples of its bounds. For
/// larger triangles these numbers would not fit; they are drawn by the crossings of edges and rows.
const SMALL: i64 = 48;

/// Visits all samples of an area that a triangle covers, row by row.
#[inline(always)]
pub(crate) fn scan<L: Lanes>(footprint: &Footprint, area: &Area, lattice: &Lattice, cells: &mut impl Cells) {
    if let Some(bounds) = Bounds::new(footprint.corners, area) {
        if bounds.is_small {
            scan_small::<L>(footprint, &bounds, area, lattice, cells);
        } else {
            scan_large::<L>(footprint, &bounds, area, lattice, cells);
        }
    }
}

#[inline(always)]
fn scan_small<L: Lanes>(
    footprint: &Footprint,
    bounds: &Bounds,
    area: &Area,
    lattice: &Lattice,
    cells: &mut impl Cells,
) {
    let [a, b, c] = footprint.corners;
    let pixels = lattice.pixels;
    let (first, [top, bottom]) = (bounds.columns[0] / pixels * pixels, bounds.rows);
    let at = [first * UNIT, top * UNIT];
    let mut edges = [
        EdgeSteps::new(a, b, at, lattice),
        EdgeSteps::new(b, c, at, lattice),
        EdgeSteps::new(c, a, at, lattice),
    ];
    let depths = Depths::<L>::new(&footprint.depth, lattice);
    for row in top..=bottom {
        let depths = depths.on_row(row, &footprint.depth, lattice);
        let mut along = edges;
        let start = (row as usize - area.rows.start) * area.stride;
        let mut column = first;
        while column <= bounds.columns[1] {
            let mut signs = [0.0; WIDTH];
            for i in 0..WIDTH {
                let outside = (along[0].values[i] | along[1].values[i] | along[2].values[i]) as u32 >> 31;
                // 1 or −1.
                signs[i] = f32::from_bits(outside << 31 | 1f32.to_bits());
            }
            let inside = L::gt(L::load(&signs), L::splat(0.0));
            if inside.any() {
                let start = start + column as usize * lattice.samples;
                let pixel = Pixel { column: column as usize, row: row as usize, start };
                cells.visit(pixel, depths.at(column), inside);
            }
            for edge in &mut along {
                edge.step(edge.per_pixel * pixels as i32);
            }
            column += pixels;
        }
        for edge in &mut edges {
            edge.step(edge.per_row);
        }
    }
}

#[inline(always)]
fn scan_large<L: Lanes>(
    footprint: &Footprint,
    bounds: &Bounds,
    area: &Area,
    lattice: &Lattice,
    cells: &mut impl Cells,
) {
    let [a, b, c] = footprint.corners;
    let [top, bottom] = bounds.rows;
    let mut edges = lattice
        .places
        .map(|[x, y]| [(a, b), (b, c), (c, a)].map(|(from, to)| EdgeWalk::new(from, to, x, top * UNIT + y)));
    let depths = Depths::<L>::new(&footprint.depth, lattice);
    for row in top..=bottom {
        let depths = depths.on_row(row, &footprint.depth, lattice);
        let (mut from, mut to) = ([0.0; WIDTH], [0.0; WIDTH]);
        let (mut least, mut most) = (i64::MAX, -1);
        for (sample, edges) in edges.iter_mut().take(lattice.samples).enumerate() {
            let (mut first, mut last) = (0, area.width as i64 - 1);
            for edge in edges {
                edge.next_row(&mut first, &mut last);
            }
            if first <= last {
                (least, most) = (i64::min(least, first), i64::max(most, last));
            } else {
                (first, last) = (0, -1);
            }
            for lane in (sample..WIDTH).step_by(lattice.samples) {
                (from[lane], to[lane]) = (first as f32, last as f32);
            }
        }
        let (from, to) = (L::load(&from), L::load(&to));
        let start = (row as usize - area.rows.start) * area.stride;
        let mut column = if most < 0 { 0 } else { least / lattice.pixels * lattice.pixels };
        while column <= most {
            let columns = L::splat(column as f32) + depths.columns;
            let inside = L::ge(columns, from) & L::le(columns, to);
            if inside.any() {
                let start = start + column as usize * lattice.samples;
                let pixel = Pixel { column: column as usize, row: row as usize, start };
                cells.visit(pixel, depths.at(column), inside);
            }
            column += lattice.pixels;
        }
    }
}

/// The number of each lane.
pub(crate) const LANE_NUMBERS: [f32; WIDTH] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

#[cfg(test)]
mod tests {
    use super::*;
    use sinew::math::Random;
    use sinew::math::lanes::Scalar;

    const SIZE: usize = 40;

    fn vertex(random: &mut Random) -> ScreenVertex {
        ScreenVertex {
            x: random.range(-12.0, 52.0),
            y: random.range(-12.0, 52.0),
            depth: random.range(0.1, 1.0),
        }
    }

    struct Counts<'a>(&'a mut [u32]);

    impl Cells for Counts<'_> {
        fn visit<L: Lanes>(&mut self, Pixel { start, .. }: Pixel, _: L, inside: L::Mask) {
            for (lane, count) in self.0[start..start + WIDTH].iter_mut().enumerate() {
                *count += u32::from(inside.bits() >> lane & 1);
            }
        }
    }

    /// Counts of the coverage of each sample, row by row.
    fn coverage(vertices: [ScreenVertex; 3], offsets: &[[i64; 2]]) -> Vec<u32> {
        let stride = SIZE * offsets.len();
        let mut counts = vec![0; SIZE * stride];
        if let Some((footprint, _)) = Footprint::new(vertices, 0) {
            let area = Area { width: SIZE, stride, rows: 0..SIZE };
            scan::<Scalar>(&footprint, &area, &Lattice::new(offsets), &mut Counts(&mut counts));
        }
        counts
    }

    /// The three half-plane tests at one sample, straight from the definition.
    fn inside(corners: [[i64; 2]; 3], x: i64, y: i64) -> bool {
        (0..3).all(|i| {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            let value = dx * (y - a[1]) - dy * (x - a[0]);
            value > 0 || (value == 0 && (dy < 0 || (dy == 0 && dx > 0)))
        })
    }

    #[test]
    fn coverage_matches_half_planes() {
        let mut random = Random::new(11);
        for case in 0..600 {
            let mut vertices = [vertex(&mut random), vertex(&mut random), vertex(&mut random)];
            if case % 3 == 0 {
                // Whole and half pixels put corners and edges exactly on samples.
                vertices = vertices.map(|v| ScreenVertex { x: v.x.floor() + 0.5, y: v.y.floor() + 0.5, ..v });
            }
            let offsets: &[_] =
                if case % 2 == 0 { &[[0, 0]] } else { &[[-32, -96], [96, -32], [32, 96], [-96, 32]] };
            let Some((footprint, _)) = Footprint::new(vertices, 0) else { continue };
            let counts = coverage(vertices, offsets);
            for (cell, &count) in counts.iter().enumerate() {
                let (pixel, offset) = (cell / offsets.len(), offsets[cell % offsets.len()]);
                let x = (pixel % SIZE) as i64 * UNIT + UNIT / 2 + offset[0];
                let y = (pixel / SIZE) as i64 * UNIT + UNIT / 2 + offset[1];
                assert_eq!(count == 1, inside(footprint.corners, x, y), "case {case}, sample {cell}");
                assert!(count <= 1);
            }
        }
    }

    #[test]
    fn a_fan_covers_every_sample_once() {
        let mut random = Random::new(5);
        for _ in 0..300 {
            // Four corners beyond the picture around a random point inside: four triangles tile the picture.
            let center = ScreenVertex {
                x: (random.range(2.0, 38.0) * 2.0).floor() * 0.5,
                y: (random.range(2.0, 38.0) * 2.0).floor() * 0.5,
                depth: 1.0,
            };
            let mut outside = |x: f32, y: f32| ScreenVertex {
                x: x + random.range(-9.0, 9.0),
                y: y + random.range(-9.0, 9.0),
                depth: 1.0,
            };
            let rim =
                [outside(-10.0, -10.0), outside(50.0, -10.0), outside(50.0, 50.0), outside(-10.0, 50.0)];
            let mut total = vec![0; SIZE * SIZE];
            for i in 0..4 {
                let part = coverage([center, rim[i], rim[(i + 1) % 4]], &[[0, 0]]);
                total.iter_mut().zip(part).for_each(|(sum, count)| *sum += count);
            }
            assert!(total.iter().all(|&count| count == 1));
        }
    }

    #[test]
    fn depth_is_linear_and_the_nearer_wins() {
        let corner = |x: f32, y: f32, depth: f32| ScreenVertex { x, y, depth };
        let mut samples = Samples::new(SIZE, SIZE, &[[0, 0]]);
        let tilted = [corner(0.0, 0.0, 0.0), corner(80.0, 0.0, 2.0), corner(0.0, 80.0, 0.0)];
        let level = [corner(0.0, 0.0, 0.5), corner(0.0, 80.0, 0.5), corner(80.0, 0.0, 0.5)];
        for (id, vertices) in [tilted, level].into_iter().enumerate() {
            let (footprint, winding) = Footprint::new(vertices, id as u32).expect("has an area");
            assert_eq!(winding, [Winding::Clockwise, Winding::CounterClockwise][id]);
            samples.bands(3).for_each(|mut band| band.draw(&[footprint]));
        }
        for x in 0..SIZE {
            let slope = (x as f32 + 0.5) / 40.0;
            assert_eq!(samples.ids(x, 0, 1)[0], u32::from(slope <= 0.5), "column {x}");
            let expected = if slope > 0.5 { slope } else { 0.5 };
            assert!((samples.depth(x, 0) - expected).abs() < 1e-6);
        }
    }
}
