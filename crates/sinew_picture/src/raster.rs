//! Rasterizer: the samples of a picture that a triangle covers, in exact integers, so that triangles that share an edge cover every
//! sample between them once (top-left rule).

use crate::clip::ClipVertex;

/// Fixed-point units per pixel.
const UNIT: i64 = 256;

/// The whole number at or below `x`, limited to `i32`. `f32::floor` is a function call on plain x86-64, and this is
/// wanted several times a pixel.
#[inline(always)]
pub(crate) fn floor(x: f32) -> i32 {
    let toward_zero = x as i32;
    if toward_zero as f32 > x { toward_zero.saturating_sub(1) } else { toward_zero }
}

/// One depth and one triangle per pixel, for one sample position within the pixels.
#[derive(Clone, Debug)]
pub(crate) struct Layer {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Position of the sample in its pixel, 1/256 pixel from the middle.
    pub(crate) offset: [i64; 2],
    /// `1 / w`: larger is nearer, 0 where nothing is.
    pub(crate) depth: Vec<f32>,
    /// Triangle per pixel; [`NOTHING`] where none is.
    pub(crate) ids: Vec<u32>,
}

/// The id of no triangle.
pub(crate) const NOTHING: u32 = u32::MAX;

/// A number that changes linearly over the picture.
#[derive(Clone, Copy, Debug)]
struct Ramp {
    x0: f32,
    y0: f32,
    at_origin: f32,
    per_x: f32,
    per_y: f32,
}

/// A triangle on the picture, turned so that its area is positive.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Footprint {
    /// 1/256 pixel from the upper left corner of the picture.
    corners: [[i64; 2]; 3],
    depth: Ramp,
    id: u32,
}

/// Order of a triangle's corners as seen from the camera.
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
    /// Perspective division. `1 / w` is the depth: it alone is linear over the picture.
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
    /// `None` where the corners lie on one line once they are rounded to 1/256 pixel.
    pub(crate) fn new(vertices: [ScreenVertex; 3], id: u32) -> Option<(Self, Winding)> {
        let fixed = |v: ScreenVertex| [v.x, v.y].map(|pixels| i64::from(floor(pixels * UNIT as f32 + 0.5)));
        let [a, b, c] = [fixed(vertices[0]), fixed(vertices[1]), fixed(vertices[2])];
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        if area == 0 {
            return None;
        }
        let depths = [vertices[0].depth, vertices[1].depth, vertices[2].depth];
        let depth = Ramp::through([a, b, c], depths, area);
        // y runs down on the picture, so a positive area is clockwise to the eye.
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

impl Layer {
    pub(crate) fn new(width: usize, height: usize, offset: [i64; 2]) -> Self {
        let pixels = width * height;
        Self { width, height, offset, depth: vec![0.0; pixels], ids: vec![NOTHING; pixels] }
    }

    pub(crate) fn clear(&mut self) {
        self.depth.fill(0.0);
        self.ids.fill(NOTHING);
    }

    /// Empties the layer so that only what is nearer than `behind` will show.
    pub(crate) fn clear_in_front_of(&mut self, behind: &Self) {
        self.depth.copy_from_slice(&behind.depth);
        self.ids.fill(NOTHING);
    }

    /// Middle of the sample in a pixel, from its upper left corner, in pixels.
    pub(crate) fn sample_position(&self) -> [f32; 2] {
        self.offset.map(|o| 0.5 + o as f32 / UNIT as f32)
    }

    /// Draws a triangle where it is nearer than what is there. At equal depths the first drawn stays.
    pub(crate) fn draw(&mut self, footprint: &Footprint) {
        let Self { width, height, offset, depth, ids } = self;
        scan(footprint, *width, *height, *offset, |pixels, ramp| {
            let row = depth[pixels.clone()].iter_mut().zip(&mut ids[pixels]);
            for (column, (depth, id)) in row.enumerate() {
                // Chosen, not branched: so that several pixels go at once.
                let z = ramp.at(column);
                let is_nearer = z > *depth;
                *depth = if is_nearer { z } else { *depth };
                *id = if is_nearer { footprint.id } else { *id };
            }
        });
    }
}

/// Column where one edge begins or ends a row, walked down row by row without a division.
#[derive(Clone, Copy, Debug)]
struct EdgeWalk {
    /// `floor(value / pace)`, with the rest, where `value` is the edge function at column 0 of the row.
    quotient: i64,
    rest: i64,
    quotient_step: i64,
    rest_step: i64,
    /// Change of the edge function per column, without its sign; 1 for a horizontal edge.
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
    /// The edge from `a` to `b`, starting at the row whose samples have height `y`; `x` is the sample of column 0.
    fn new(a: [i64; 2], b: [i64; 2], x: i64, y: i64) -> Self {
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let value = dx * (y - a[1]) - dy * (x - a[0]);
        // Samples exactly on a left or top edge belong to the triangle, those on others to its neighbour.
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

    /// Narrows the columns `first..=last` to those inside, then goes down one row.
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

/// Depth along a row of a picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowDepth {
    at_origin: f32,
    per_x: f32,
    /// From where the depth is `at_origin` to the row's first pixel, pixels, in two parts: the first is a whole number.
    first: i32,
    from_x0: f32,
}

impl RowDepth {
    /// Depth so many pixels after the first.
    #[inline(always)]
    pub(crate) fn at(&self, column: usize) -> f32 {
        self.at_origin + self.per_x * ((self.first + column as i32) as f32 + self.from_x0)
    }
}

/// Calls `visit(pixels, depth)` for every row of a `width × height` picture with pixels whose sample, `offset` (in 1/256 pixel)
/// from its middle, is covered.
#[inline(always)]
pub(crate) fn scan(
    footprint: &Footprint,
    width: usize,
    height: usize,
    offset: [i64; 2],
    mut visit: impl FnMut(core::ops::Range<usize>, RowDepth),
) {
    let [a, b, c] = footprint.corners;
    let (sample_x, sample_y) = (UNIT / 2 + offset[0], UNIT / 2 + offset[1]);
    let top = a[1].min(b[1]).min(c[1]) - sample_y;
    let bottom = a[1].max(b[1]).max(c[1]) - sample_y;
    let first_row = (-(-top).div_euclid(UNIT)).max(0);
    let last_row = bottom.div_euclid(UNIT).min(height as i64 - 1);
    if first_row > last_row {
        return;
    }
    let y = first_row * UNIT + sample_y;
    let mut edges = [(a, b), (b, c), (c, a)].map(|(from, to)| EdgeWalk::new(from, to, sample_x, y));
    let ramp = footprint.depth;
    let from_x0 = sample_x as f32 / UNIT as f32 - ramp.x0;
    for row in first_row..=last_row {
        let (mut first, mut last) = (0, width as i64 - 1);
        for edge in &mut edges {
            edge.next_row(&mut first, &mut last);
        }
        let from_y0 = (row * UNIT + sample_y) as f32 / UNIT as f32 - ramp.y0;
        let depth_row = ramp.at_origin + ramp.per_y * from_y0;
        if first <= last {
            let start = row as usize * width;
            let depth = RowDepth { at_origin: depth_row, per_x: ramp.per_x, first: first as i32, from_x0 };
            visit(start + first as usize..start + last as usize + 1, depth);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew::math::Random;

    const SIZE: usize = 40;

    fn vertex(random: &mut Random) -> ScreenVertex {
        ScreenVertex {
            x: random.range(-12.0, 52.0),
            y: random.range(-12.0, 52.0),
            depth: random.range(0.1, 1.0),
        }
    }

    fn coverage(vertices: [ScreenVertex; 3], offset: [i64; 2]) -> Vec<u32> {
        let mut counts = vec![0; SIZE * SIZE];
        if let Some((footprint, _)) = Footprint::new(vertices, 0) {
            scan(&footprint, SIZE, SIZE, offset, |pixels, _| {
                counts[pixels].iter_mut().for_each(|count| *count += 1);
            });
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
    fn covers_what_the_half_planes_say() {
        let mut random = Random::new(11);
        for case in 0..600 {
            let mut vertices = [vertex(&mut random), vertex(&mut random), vertex(&mut random)];
            if case % 3 == 0 {
                // Whole and half pixels put corners and edges exactly on samples.
                vertices = vertices.map(|v| ScreenVertex { x: v.x.floor() + 0.5, y: v.y.floor() + 0.5, ..v });
            }
            let offset = [[0, 0], [-32, -96], [96, -32]][case % 3];
            let Some((footprint, _)) = Footprint::new(vertices, 0) else { continue };
            let counts = coverage(vertices, offset);
            for (pixel, &count) in counts.iter().enumerate() {
                let x = (pixel % SIZE) as i64 * UNIT + UNIT / 2 + offset[0];
                let y = (pixel / SIZE) as i64 * UNIT + UNIT / 2 + offset[1];
                assert_eq!(count == 1, inside(footprint.corners, x, y), "case {case}, pixel {pixel}");
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
                let part = coverage([center, rim[i], rim[(i + 1) % 4]], [0, 0]);
                total.iter_mut().zip(part).for_each(|(sum, count)| *sum += count);
            }
            assert!(total.iter().all(|&count| count == 1));
        }
    }

    #[test]
    fn depth_is_linear_and_the_nearer_wins() {
        let corner = |x: f32, y: f32, depth: f32| ScreenVertex { x, y, depth };
        let mut layer = Layer::new(SIZE, SIZE, [0, 0]);
        layer.clear();
        let tilted = [corner(0.0, 0.0, 0.0), corner(80.0, 0.0, 2.0), corner(0.0, 80.0, 0.0)];
        let level = [corner(0.0, 0.0, 0.5), corner(0.0, 80.0, 0.5), corner(80.0, 0.0, 0.5)];
        for (id, vertices) in [tilted, level].into_iter().enumerate() {
            let (footprint, winding) = Footprint::new(vertices, id as u32).expect("has an area");
            assert_eq!(winding, [Winding::Clockwise, Winding::CounterClockwise][id]);
            layer.draw(&footprint);
        }
        for x in 0..SIZE {
            let slope = (x as f32 + 0.5) / 40.0;
            assert_eq!(layer.ids[x], u32::from(slope <= 0.5), "column {x}");
            let expected = if slope > 0.5 { slope } else { 0.5 };
            assert!((layer.depth[x] - expected).abs() < 1e-6);
        }
    }
}
