//! The colour of a point: which triangle, lit how, seen through how much haze.

use crate::camera::View;
use crate::color::ColorTables;
use crate::raster::NOTHING;
use crate::scene::{Material, Model, Pattern, Scene, Sky};
use crate::shadow::ShadowMap;
use sinew::math::{Vec2, Vec3, abs3, clamp, max, min, normalize_or};

/// Share of the sky's brightness that falls on things. Less than all, as if much of it were hidden: shadows need to be dark to
/// be read.
const SKY_LIGHT: f32 = 0.55;

/// Pixels that [`Shader::flat_span`] shades at once.
pub(crate) const SPAN: usize = 16;

/// A drawn triangle: its number among these is its id in the layers.
///
/// Where a ray from the eye meets it is a quotient of dot products with vectors that belong to the triangle alone
/// (Möller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997, with the products regrouped):
/// `depth = k / (ray·m)`, second and third barycentric coordinate `(ray·p) / (ray·m)` and `(ray·q) / (ray·m)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    /// Index into the scene's models.
    model: u32,
    /// Indices into the model's vertices, all in range.
    corners: [u32; 3],
    m: Vec3,
    p: Vec3,
    q: Vec3,
    k: f32,
    /// Unit normal on the side of the eye.
    face: Vec3,
    /// −1 where the eye sees the back: vertex normals must be turned too.
    side: f32,
}

impl Triangle {
    pub(crate) fn new(model: u32, corners: [u32; 3], [a, b, c]: [Vec3; 3], eye: Vec3) -> Self {
        let (ab, ac, from_a) = (b - a, c - a, eye - a);
        let (normal, q) = (ab.cross(ac), from_a.cross(ab));
        let side = if normal.dot(from_a) < 0.0 { -1.0 } else { 1.0 };
        let face = normalize_or(normal, Vec3::Y) * side;
        Self { model, corners, m: -normal, p: ac.cross(from_a), q, k: ac.dot(q), face, side }
    }

    /// Intersection of a ray with the triangle; it is known to hit, or to pass within a pixel.
    #[inline(always)]
    fn meet(&self, eye: Vec3, ray: Vec3) -> Hit {
        let det = ray.dot(self.m);
        let inverse = if det == 0.0 { 0.0 } else { 1.0 / det };
        let depth = self.k * inverse;
        let second = clamp(ray.dot(self.p) * inverse, 0.0, 1.0);
        let third = clamp(ray.dot(self.q) * inverse, 0.0, 1.0);
        Hit { point: eye + ray * depth, shares: [second, third], depth, inverse }
    }

    /// Displacement of the place where a ray meets the plane while the ray itself moves by `step`.
    #[inline(always)]
    fn slip(&self, hit: &Hit, ray: Vec3, step: Vec3) -> Vec3 {
        (step - ray * (step.dot(self.m) * hit.inverse)) * hit.depth
    }
}

/// Intersection of a ray with the plane of a triangle.
struct Hit {
    /// World space.
    point: Vec3,
    /// Share of the second and the third corner.
    shares: [f32; 2],
    /// Metres along the ray's direction of depth 1.
    depth: f32,
    /// `1 / (ray·m)`, 0 for a ray along the plane.
    inverse: f32,
}

/// Colour and opacity of a surface as the eye sees it, translucent or solid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    /// Linear.
    pub(crate) color: [f32; 3],
    pub(crate) opacity: f32,
}

/// All that shading needs, for one picture.
pub(crate) struct Shader<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) view: &'a View,
    pub(crate) shadow: &'a ShadowMap,
    pub(crate) triangles: &'a [Triangle],
    pub(crate) tables: &'a ColorTables,
}

impl<'a> Shader<'a> {
    /// The sky behind a point of the picture, in pixels.
    pub(crate) fn sky(&self, x: f32, y: f32) -> [f32; 3] {
        let ray = self.view.ray(x, y);
        let height = clamp(ray.y / ray.length(), 0.0, 1.0);
        // The root brings the horizon's light close to the horizon, as thick air does.
        mix(self.scene.sky.horizon, self.scene.sky.zenith, height.sqrt())
    }

    /// Opacity of a triangle, 0 for none.
    pub(crate) fn opacity(&self, id: u32) -> f32 {
        if id == NOTHING { 0.0 } else { self.model(&self.triangles[id as usize]).material.opacity }
    }

    #[inline(always)]
    fn model(&self, triangle: &Triangle) -> &'a Model {
        &self.scene.models[triangle.model as usize]
    }

    /// Colour and opacity of triangle `id` as the eye sees it at a point of the picture, in pixels.
    pub(crate) fn surface(&self, id: u32, x: f32, y: f32) -> Seen {
        let triangle = &self.triangles[id as usize];
        let model = self.model(triangle);
        let ray = self.view.ray(x, y);
        let hit = triangle.meet(self.view.eye, ray);
        let normal = if model.normals.len() == model.positions.len() {
            let normals = triangle.corners.map(|corner| model.normals[corner as usize]);
            normalize_or(blend3(normals, hit.shares) * triangle.side, triangle.face)
        } else {
            triangle.face
        };
        let base = self.base_color(model, triangle, &hit, ray);
        let lit = self.light(base, hit.point, normal, triangle.face);
        let distance_squared = hit.depth * hit.depth * ray.length_squared();
        let half_haze = self.scene.sky.haze_distance * self.scene.sky.haze_distance;
        let haze = distance_squared / (distance_squared + max(half_haze, 1e-6));
        Seen { color: mix(lit, self.scene.sky.horizon, haze), opacity: model.material.opacity }
    }

    /// True if a triangle has one normal, and one colour or a checker: [`Self::flat_span`] then shades it.
    #[inline(always)]
    pub(crate) fn is_flat(&self, id: u32) -> bool {
        let model = self.model(&self.triangles[id as usize]);
        let vertices = model.positions.len();
        let has_picture = model.material.texture.is_some() && model.uvs.len() == vertices;
        !has_picture && model.normals.len() != vertices && model.colors.len() != vertices
    }

    /// [`Self::surface`] of a flat triangle in the middles of pixels side by side, from `x` on in the row `y`: the same numbers, many at
    /// a time.
    pub(crate) fn flat_span(&self, id: u32, x: usize, y: usize) -> [[f32; 3]; SPAN] {
        let triangle = &self.triangles[id as usize];
        let Material { color, pattern, .. } = &self.model(triangle).material;
        let y = y as f32 + 0.5;
        // Plain loops over plain numbers, which the compiler does several at a time.
        let (mut rays, mut points) = ([Vec3::ZERO; SPAN], [Vec3::ZERO; SPAN]);
        let (mut inverses, mut depths) = ([0.0; SPAN], [0.0; SPAN]);
        for i in 0..SPAN {
            let ray = self.view.ray((x + i) as f32 + 0.5, y);
            let det = ray.dot(triangle.m);
            rays[i] = ray;
            inverses[i] = if det == 0.0 { 0.0 } else { 1.0 / det };
            depths[i] = triangle.k * inverses[i];
            points[i] = self.view.eye + ray * depths[i];
        }
        let mut shares = [0.0; SPAN];
        let mut other_color = *color;
        if let Pattern::Checker { size, other } = *pattern {
            other_color = other;
            let size = max(size, 1e-3);
            let [across, down] = self.view.ray_per_pixel();
            for i in 0..SPAN {
                let hit = Hit { point: points[i], shares: [0.0; 2], depth: depths[i], inverse: inverses[i] };
                let covered =
                    abs3(triangle.slip(&hit, rays[i], across)) + abs3(triangle.slip(&hit, rays[i], down));
                shares[i] = checker(points[i], covered, size);
            }
        }
        let normal = triangle.face;
        let cos = normal.dot(self.shadow.to_sun);
        let mut suns = [0.0; SPAN];
        if cos > 0.0 {
            let lift = self.shadow.lift(normal, cos);
            for i in 0..SPAN {
                suns[i] = cos * self.shadow.light_off(points[i] + lift);
            }
        }
        let around = self.around(normal);
        let (sun, horizon) = (self.scene.sun.color, self.scene.sky.horizon);
        let half_haze = max(self.scene.sky.haze_distance * self.scene.sky.haze_distance, 1e-6);
        let mut seen = [[0.0; 3]; SPAN];
        for i in 0..SPAN {
            let distance_squared = depths[i] * depths[i] * rays[i].length_squared();
            let haze = distance_squared / (distance_squared + half_haze);
            for channel in 0..3 {
                let base = color[channel] + (other_color[channel] - color[channel]) * shares[i];
                let lit = base * (around[channel] + sun[channel] * suns[i]);
                seen[i][channel] = lit + (horizon[channel] - lit) * haze;
            }
        }
        seen
    }

    fn base_color(&self, model: &Model, triangle: &Triangle, hit: &Hit, ray: Vec3) -> [f32; 3] {
        let Material { color, texture, pattern, .. } = &model.material;
        let mut base = *color;
        if let Pattern::Checker { size, other } = *pattern {
            let [across, down] = self.view.ray_per_pixel().map(|step| abs3(triangle.slip(hit, ray, step)));
            base = mix(base, other, checker(hit.point, across + down, max(size, 1e-3)));
        }
        if model.colors.len() == model.positions.len() {
            let colors = triangle.corners.map(|corner| Vec3::from_array(model.colors[corner as usize]));
            base = multiply(base, blend3(colors, hit.shares).to_array());
        }
        if let Some(texture) = texture
            && model.uvs.len() == model.positions.len()
        {
            let [a, b, c] = triangle.corners.map(|corner| model.uvs[corner as usize]);
            let uv = a + (b - a) * hit.shares[0] + (c - a) * hit.shares[1];
            let pixel = hit.depth * self.view.pixel_size();
            // Seen at a slant a pixel covers more; up to a point, for sharp texture is worth some shimmer.
            let cos_view = max(triangle.face.dot(self.view.eye - hit.point) / hit.depth, 0.15);
            let texels = texture.texels() * uv_per_area([a, b, c], triangle.m) * pixel * pixel / cos_view;
            base = multiply(base, texture.sample(uv, texture.level_for(texels), self.tables));
        }
        base
    }

    /// A matt surface under the sun and a sky that is bright above and dark below.
    fn light(&self, base: [f32; 3], point: Vec3, normal: Vec3, face: Vec3) -> [f32; 3] {
        let around = self.around(normal);
        let cos = normal.dot(self.shadow.to_sun);
        let mut sun = 0.0;
        if cos > 0.0 {
            sun = cos * self.shadow.light_off(point + self.shadow.lift(face, face.dot(self.shadow.to_sun)));
        }
        let color = self.scene.sun.color;
        core::array::from_fn(|i| base[i] * (around[i] + color[i] * sun))
    }

    /// Light of the sky on a surface.
    #[inline(always)]
    fn around(&self, normal: Vec3) -> [f32; 3] {
        let Sky { zenith, horizon, ground, .. } = self.scene.sky;
        let above = mix(horizon, zenith, 0.6).map(|channel| channel * SKY_LIGHT);
        mix(ground, above, 0.5 + 0.5 * normal.y)
    }
}

fn blend3([a, b, c]: [Vec3; 3], [second, third]: [f32; 2]) -> Vec3 {
    a + (b - a) * second + (c - a) * third
}

#[inline(always)]
fn mix(a: [f32; 3], b: [f32; 3], amount: f32) -> [f32; 3] {
    core::array::from_fn(|i| a[i] + (b[i] - a[i]) * amount)
}

fn multiply(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    core::array::from_fn(|i| a[i] * b[i])
}

/// Area of a triangle in texture coordinates over its area in the world, 1/m²; `normal` is twice the latter long.
fn uv_per_area([a, b, c]: [Vec2; 3], normal: Vec3) -> f32 {
    let on_texture = ((b - a).x * (c - a).y - (b - a).y * (c - a).x).abs();
    on_texture / max(normal.length(), 1e-12)
}

/// Share of the second colour in a box of `footprint` around `p`: 0 and 1 within squares, between where the box
/// covers several. Mean of a product of two square waves, each integrated in closed form.
#[inline(always)]
fn checker(p: Vec3, footprint: Vec3, size: f32) -> f32 {
    0.5 - 0.5
        * square_wave_mean(p.x / size, footprint.x / size)
        * square_wave_mean(p.z / size, footprint.z / size)
}

/// Mean over `x ± width/2` of the wave that is 1 on [0, 1), −1 on [1, 2), and so on.
#[inline(always)]
fn square_wave_mean(x: f32, width: f32) -> f32 {
    let width = clamp(width, 1e-3, 8.0);
    clamp((triangle_wave(x + 0.5 * width) - triangle_wave(x - 0.5 * width)) / width, -1.0, 1.0)
}

/// Integral of the square wave from 0: up to 1 at odd numbers, 0 at even ones.
#[inline(always)]
fn triangle_wave(x: f32) -> f32 {
    let phase = x - 2.0 * whole_below(0.5 * x);
    min(phase, 2.0 - phase)
}

/// The whole number at or below `x`, up to 2²²; beyond it nobody sees a checker. Without a conversion to integers, so that several go
/// at once.
#[inline(always)]
fn whole_below(x: f32) -> f32 {
    /// Magnitude at which `f32` numbers are whole.
    const WHOLE: f32 = 12_582_912.0;
    let x = clamp(x, -4_194_304.0, 4_194_304.0);
    let nearest = (x + WHOLE) - WHOLE;
    if nearest > x { nearest - 1.0 } else { nearest }
}
