//! Shadow map: an orthographic depth picture from the sun, which finds the points in shadow.

use crate::pipeline::clip::{clip, is_whole, unseen};
use crate::pipeline::raster::{Area, Cells, Footprint, Lattice, NOTHING, Pixel, ScreenVertex, floor, scan};
use sinew::math::dispatch::{self, Kernel};
use sinew::math::lanes::{LaneMask, Lanes, WIDTH};
use sinew::math::{Vec3, any_orthonormal, clamp, max, min, normalize_or};

/// Heights toward the sun, around one point of the world.
#[derive(Clone, Debug)]
pub(crate) struct ShadowMap {
    /// Texels along a side.
    size: usize,
    /// Height toward the sun per texel; −∞ for empty ones. Rows are whole lanes.
    heights: Vec<f32>,
    /// Largest height in each square of [`BLOCK`] texels. It decides most points quickly, because most points are above
    /// all shapes that could shade them.
    highest: Vec<f32>,
    /// Triangles that [`Self::finish`] draws into the map.
    casting: Vec<Footprint>,
    /// Texels that the triangles may have raised.
    raised: Texels,
    /// Direction toward the sun, unit.
    pub(crate) to_sun: Vec3,
    /// Axes from world to map: the edges of the map are at ±1.
    axes: [Vec3; 2],
    /// The focus along the axes, rounded to whole texels, so that shadows do not crawl when the camera moves.
    center: [f32; 2],
    focus: Vec3,
    /// Side of a texel in the world, metres.
    texel: f32,
}

/// Texels along a side of a square of [`ShadowMap::highest`].
const BLOCK: usize = 16;

/// A rectangle of texels, ends included; empty if `first` is beyond `last`.
#[derive(Clone, Copy, Debug)]
struct Texels {
    first: [usize; 2],
    last: [usize; 2],
}

impl Texels {
    const NONE: Self = Self { first: [usize::MAX; 2], last: [0; 2] };

    #[inline(always)]
    fn include(&mut self, first_column: usize, last_column: usize, row: usize) {
        self.first = [usize::min(self.first[0], first_column), usize::min(self.first[1], row)];
        self.last = [usize::max(self.last[0], last_column), usize::max(self.last[1], row)];
    }
}

impl ShadowMap {
    pub(crate) fn new(size: usize) -> Self {
        Self {
            size,
            heights: vec![f32::NEG_INFINITY; size * size.next_multiple_of(WIDTH)],
            highest: vec![f32::NEG_INFINITY; size.div_ceil(BLOCK) * size.div_ceil(BLOCK)],
            casting: Vec::new(),
            raised: Texels::NONE,
            to_sun: Vec3::Y,
            axes: [Vec3::X, Vec3::Z],
            center: [0.0; 2],
            focus: Vec3::ZERO,
            texel: 1.0,
        }
    }

    /// Returns the number of texels from a row to the next.
    #[inline(always)]
    fn stride(&self) -> usize {
        self.size.next_multiple_of(WIDTH)
    }

    /// Starts an empty map with a radius of `radius` metres around `focus`.
    pub(crate) fn begin(&mut self, to_sun: Vec3, focus: Vec3, radius: f32) {
        self.to_sun = normalize_or(to_sun, Vec3::Y);
        let radius = max(radius, 1e-3);
        let across = any_orthonormal(self.to_sun);
        self.axes = [across / radius, self.to_sun.cross(across) / radius];
        self.focus = if focus.is_finite() { focus } else { Vec3::ZERO };
        let texel_on_map = 2.0 / self.size as f32;
        self.center = self.axes.map(|axis| (self.focus.dot(axis) / texel_on_map).floor() * texel_on_map);
        self.texel = texel_on_map * radius;
        let Texels { first: [left, top], last: [right, bottom] } = self.raised;
        if left <= right {
            let stride = self.stride();
            for row in self.heights.chunks_exact_mut(stride).take(bottom + 1).skip(top) {
                row[left..=right].fill(f32::NEG_INFINITY);
            }
        }
        self.highest.fill(f32::NEG_INFINITY);
        self.casting.clear();
        self.raised = Texels::NONE;
    }

    /// Returns the position on the map, ±1 at its edges, and the height toward the sun.
    #[inline(always)]
    fn map_from_world(&self, p: Vec3) -> [f32; 3] {
        let [across, up] = self.axes;
        [p.dot(across) - self.center[0], p.dot(up) - self.center[1], (p - self.focus).dot(self.to_sun)]
    }

    /// Adds a triangle that casts a shadow after [`Self::finish`].
    pub(crate) fn cast(&mut self, corners: [Vec3; 3]) {
        let place = |i: usize| self.map_from_world(corners[i]);
        let on_map = [place(0), place(1), place(2)];
        let flat = |i: usize| [on_map[i][0], on_map[i][1], 1.0];
        let triangle = [flat(0), flat(1), flat(2)];
        if unseen(&triangle, 0.5) {
            return;
        }
        let polygon;
        let corners = if is_whole(&triangle, 0.5) {
            triangle.as_slice()
        } else {
            polygon = clip(triangle, 0.5);
            polygon.corners()
        };
        let half = 0.5 * self.size as f32;
        let slope = HeightOverMap::through(on_map);
        let vertex = |[x, y, _]: [f32; 3]| ScreenVertex {
            x: (x + 1.0) * half,
            y: (1.0 - y) * half,
            depth: slope.at(x, y),
        };
        for i in 2..corners.len() {
            let fan = [vertex(corners[0]), vertex(corners[i - 1]), vertex(corners[i])];
            if let Some((footprint, _)) = Footprint::new(fan, NOTHING) {
                self.casting.push(footprint);
            }
        }
    }

    /// Draws the added triangles into the map.
    pub(crate) fn finish(&mut self) {
        dispatch::run(Raise(self));
    }

    /// Returns the share of the sun's light, 0..=1, that reaches a point of a surface with unit `normal` (toward the viewer).
    ///
    /// Mean of 3 × 3 bilinear comparisons. The point is first moved off the surface just far enough that the widest
    /// tap cannot hit the surface itself: `d / cos θ ≥ 1.5 √2 · texel · tan θ`.
    #[cfg(test)]
    pub(crate) fn light_at(&self, point: Vec3, normal: Vec3, cos_to_sun: f32) -> f32 {
        self.light_off(point + self.lift(normal, cos_to_sun))
    }

    /// Returns the offset that moves a point off its surface, with unit `normal` (toward the viewer), for [`Self::light_off`].
    #[inline(always)]
    pub(crate) fn lift(&self, normal: Vec3, cos_to_sun: f32) -> Vec3 {
        let sin = max(0.0, 1.0 - cos_to_sun * cos_to_sun).sqrt();
        normal * (self.texel * (0.6 + 2.2 * sin))
    }

    /// Returns true if nothing shades any point on the segment between two points that are already moved off their surface. This is
    /// a quick test: false is not certain.
    #[inline(always)]
    pub(crate) fn is_lit_between(&self, from: Vec3, to: Vec3) -> bool {
        let half = 0.5 * self.size as f32;
        let ([x0, y0, _], [x1, y1, _]) = (self.map_from_world(from), self.map_from_world(to));
        let place = |x: f32, y: f32| [(x + 1.0) * half - 1.5, (1.0 - y) * half - 1.5];
        let (from, to) = (place(x0, y0), place(x1, y1));
        let Texels { first, last } = self.raised;
        // Points between may be rounded differently, by far less than a texel; the test of a point reads four texels from its own
        // on.
        let beside = |axis: usize| {
            min(from[axis], to[axis]) > last[axis] as f32 + 1.0
                || max(from[axis], to[axis]) < first[axis] as f32 - 5.0
        };
        first[0] > last[0] || beside(0) || beside(1)
    }

    /// Returns [`Self::light_at`] of a point that is already moved off its surface.
    #[inline(always)]
    pub(crate) fn light_off(&self, point: Vec3) -> f32 {
        let [x, y, height] = self.map_from_world(point);
        // The last tenth fades out, so that shadows end softly at the edge of the map.
        let fade = 10.0 * (1.0 - max(x.abs(), y.abs()));
        if fade.is_nan() || fade <= 0.0 {
            return 1.0;
        }
        let size = self.size;
        let half = 0.5 * size as f32;
        let (column, row) = ((x + 1.0) * half - 1.5, (1.0 - y) * half - 1.5);
        let (left, top) = (floor(column), floor(row));
        let (fx, fy) = (column - left as f32, row - top as f32);
        let last = size as i32 - 4;
        if left < 0 || top < 0 || left > last || top > last {
            return 1.0;
        }
        let (near, far) =
            ([left, top].map(|i| i as usize / BLOCK), [left, top].map(|i| (i as usize + 3) / BLOCK));
        let blocks = size.div_ceil(BLOCK);
        let is_below = |column: usize, row: usize| self.highest[row * blocks + column] <= height;
        if is_below(near[0], near[1])
            && is_below(far[0], near[1])
            && is_below(near[0], far[1])
            && is_below(far[0], far[1])
        {
            return 1.0;
        }
        self.share_of_light(height, [left as usize, top as usize], [fx, fy], fade)
    }

    /// Returns the share of light by 3 × 3 bilinear comparisons from a texel on.
    fn share_of_light(&self, height: f32, [left, top]: [usize; 2], [fx, fy]: [f32; 2], fade: f32) -> f32 {
        let mut hidden = 0.0;
        for (j, weight_of_row) in [1.0 - fy, 1.0, 1.0, fy].into_iter().enumerate() {
            let start = (top + j) * self.stride() + left;
            let row = &self.heights[start..start + 4];
            let above = |i: usize| if row[i] > height { 1.0 } else { 0.0 };
            hidden += ((1.0 - fx) * above(0) + above(1) + above(2) + fx * above(3)) * weight_of_row;
        }
        1.0 - hidden * (1.0 / 9.0) * clamp(fade, 0.0, 1.0)
    }
}

/// Kernel that draws all added triangles into a map.
struct Raise<'a>(&'a mut ShadowMap);

impl Kernel for Raise<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let ShadowMap { size, heights, highest, casting, raised, .. } = self.0;
        let area = Area { width: *size, stride: size.next_multiple_of(WIDTH), rows: 0..*size };
        let lattice = Lattice::new(&[[0, 0]]);
        let mut rising = Rising { size: *size, heights, highest, raised };
        for footprint in casting.iter() {
            scan::<L>(footprint, &area, &lattice, &mut rising);
        }
        casting.clear();
    }
}

/// A map into which triangles are drawn.
struct Rising<'a> {
    size: usize,
    heights: &'a mut [f32],
    highest: &'a mut [f32],
    raised: &'a mut Texels,
}

impl Cells for Rising<'_> {
    #[inline(always)]
    fn visit<L: Lanes>(&mut self, Pixel { column, row, start }: Pixel, height: L, inside: L::Mask) {
        let Some(chunk) = self.heights[start..].first_chunk_mut::<WIDTH>() else { return };
        let old = L::load(chunk);
        let is_higher = L::gt(height, old) & inside;
        if !is_higher.any() {
            return;
        }
        L::select(is_higher, height, old).store(chunk);
        self.raised.include(column, (column + WIDTH - 1).min(self.size - 1), row);
        // Heights change monotonically along a row: the greatest is at one of the ends.
        let (bits, mut heights) = (is_higher.bits(), [0.0; WIDTH]);
        height.store(&mut heights);
        let (first, last) = (bits.trailing_zeros() as usize, 7 - bits.leading_zeros() as usize);
        let block = &mut self.highest[row / BLOCK * self.size.div_ceil(BLOCK) + column / BLOCK];
        *block = max(*block, max(heights[first], heights[last]));
    }
}

/// The height of a triangle's plane as a linear function of the position on the map.
#[derive(Clone, Copy, Debug)]
struct HeightOverMap {
    base: [f32; 3],
    per_x: f32,
    per_y: f32,
}

impl HeightOverMap {
    fn through([a, b, c]: [[f32; 3]; 3]) -> Self {
        let (bx, by, bz) = (b[0] - a[0], b[1] - a[1], b[2] - a[2]);
        let (cx, cy, cz) = (c[0] - a[0], c[1] - a[1], c[2] - a[2]);
        let det = bx * cy - cx * by;
        // A triangle that is seen edge-on covers no texel, so any finite slope is correct.
        let inverse = if det.abs() > 1e-12 { 1.0 / det } else { 0.0 };
        Self { base: a, per_x: (bz * cy - cz * by) * inverse, per_y: (cz * bx - bz * cx) * inverse }
    }

    fn at(&self, x: f32, y: f32) -> f32 {
        self.base[2] + (x - self.base[0]) * self.per_x + (y - self.base[1]) * self.per_y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slab_shades_what_is_below_and_not_itself() {
        let mut map = ShadowMap::new(256);
        map.begin(Vec3::Y, Vec3::ZERO, 4.0);
        let [a, b, c, d] =
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, z]| Vec3::new(x, 1.0, z));
        map.cast([a, b, c]);
        map.cast([a, c, d]);
        map.finish();
        assert_eq!(map.light_at(Vec3::new(0.2, 0.0, -0.3), Vec3::Y, 1.0), 0.0);
        assert_eq!(map.light_at(Vec3::new(1.5, 0.0, 0.0), Vec3::Y, 1.0), 1.0);
        assert_eq!(map.light_at(Vec3::new(0.2, 1.0, -0.3), Vec3::Y, 1.0), 1.0);
        assert_eq!(map.light_at(Vec3::new(50.0, 0.0, 0.0), Vec3::Y, 1.0), 1.0);
        let edge = map.light_at(Vec3::new(1.0, 0.0, 0.0), Vec3::Y, 1.0);
        assert!(edge > 0.2 && edge < 0.8, "{edge}");
    }

    #[test]
    fn slanted_surfaces_do_not_shade_themselves() {
        let mut map = ShadowMap::new(128);
        for tilt in [0.1, 0.4, 0.7, 0.95] {
            let to_sun = Vec3::new(tilt, (1.0f32 - tilt * tilt).sqrt(), 0.0);
            map.begin(to_sun, Vec3::new(0.31, 0.0, 0.17), 3.0);
            let corner = |x: f32, z: f32| Vec3::new(x, 0.0, z);
            map.cast([corner(-30.0, -30.0), corner(30.0, -30.0), corner(30.0, 30.0)]);
            map.cast([corner(-30.0, -30.0), corner(30.0, 30.0), corner(-30.0, 30.0)]);
            map.finish();
            for i in 0..400 {
                let p = Vec3::new((i % 20) as f32 * 0.093 - 1.0, 0.0, (i / 20) as f32 * 0.087 - 1.0);
                assert_eq!(map.light_at(p, Vec3::Y, to_sun.y), 1.0, "tilt {tilt}, {p}");
            }
        }
    }
}
