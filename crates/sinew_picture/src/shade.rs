//! The colour of a point: which triangle, lit how, seen through how much haze.

use crate::camera::View;
use crate::color::ColorTables;
use crate::raster::NOTHING;
use crate::scene::{Material, Model, Pattern, Scene};
use crate::shadow::ShadowMap;
use sinew::math::{Vec2, Vec3, abs3, clamp, max, min, normalize_or};

/// A drawn triangle: its number among these is its id in the layers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    /// Index into the scene's models.
    pub(crate) model: u32,
    /// Indices into the model's vertices, all in range.
    pub(crate) corners: [u32; 3],
}

/// What a translucent or solid surface sends to the eye.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    /// Linear.
    pub(crate) color: [f32; 3],
    pub(crate) opacity: f32,
}

/// All that shading needs, for one picture.
pub(crate) struct Shader<'a> {
    scene: &'a Scene,
    view: &'a View,
    shadow: &'a ShadowMap,
    triangles: &'a [Triangle],
    tables: &'a ColorTables,
    /// Side of a pixel at depth 1, metres.
    pixel_size: f32,
}

/// Where a ray meets the plane of a triangle.
struct Hit {
    /// World space.
    point: Vec3,
    /// Share of the second and the third corner.
    shares: [f32; 2],
    /// Metres along the ray's direction of depth 1.
    depth: f32,
}

impl<'a> Shader<'a> {
    pub(crate) fn new(
        scene: &'a Scene,
        view: &'a View,
        shadow: &'a ShadowMap,
        triangles: &'a [Triangle],
        tables: &'a ColorTables,
        height: usize,
    ) -> Self {
        let middle = 0.5 * height as f32;
        let pixel_size = (view.ray(0.0, middle + 0.5) - view.ray(0.0, middle - 0.5)).length();
        Self { scene, view, shadow, triangles, tables, pixel_size }
    }

    /// The sky behind a point of the picture, in pixels.
    pub(crate) fn sky(&self, x: f32, y: f32) -> [f32; 3] {
        let ray = self.view.ray(x, y);
        let height = clamp(ray.y / ray.length(), 0.0, 1.0);
        // The root brings the horizon's light close to the horizon, as thick air does.
        mix(self.scene.sky.horizon, self.scene.sky.zenith, height.sqrt())
    }

    /// Opacity of a triangle, 0 for none.
    pub(crate) fn opacity(&self, id: u32) -> f32 {
        if id == NOTHING { 0.0 } else { self.model(id).material.opacity }
    }

    fn model(&self, id: u32) -> &'a Model {
        &self.scene.models[self.triangles[id as usize].model as usize]
    }

    /// What triangle `id` sends to the eye at a point of the picture, in pixels.
    pub(crate) fn surface(&self, id: u32, x: f32, y: f32) -> Seen {
        let model = self.model(id);
        let corners = self.triangles[id as usize].corners.map(|corner| corner as usize);
        let points = corners.map(|corner| model.positions[corner]);
        let ray = self.view.ray(x, y);
        let hit = meet(self.view.eye, ray, points);
        let face = normalize_or((points[1] - points[0]).cross(points[2] - points[0]), Vec3::Y);
        let side = if face.dot(ray) > 0.0 { -1.0 } else { 1.0 };
        let normal = if model.normals.len() == model.positions.len() {
            let normals = corners.map(|corner| model.normals[corner]);
            normalize_or(blend3(normals, hit.shares), face) * side
        } else {
            face * side
        };
        let cos_view = face.dot(ray).abs() / ray.length();
        let pixel_area = hit.depth * self.pixel_size * (hit.depth * self.pixel_size) / max(cos_view, 0.15);
        let base = self.base_color(model, corners, &hit, pixel_area, (x, y), points);
        let lit = self.light(base, hit.point, normal, face * side);
        let distance = hit.depth * ray.length() / max(self.scene.sky.haze_distance, 1e-3);
        let haze = 1.0 - 1.0 / (1.0 + distance * distance);
        Seen { color: mix(lit, self.scene.sky.horizon, haze), opacity: model.material.opacity }
    }

    fn base_color(
        &self,
        model: &Model,
        corners: [usize; 3],
        hit: &Hit,
        pixel_area: f32,
        (x, y): (f32, f32),
        points: [Vec3; 3],
    ) -> [f32; 3] {
        let Material { color, texture, pattern, .. } = &model.material;
        let mut base = *color;
        if let Pattern::Checker { size, other } = *pattern {
            let beside = meet(self.view.eye, self.view.ray(x + 1.0, y), points).point;
            let below = meet(self.view.eye, self.view.ray(x, y + 1.0), points).point;
            let footprint = abs3(beside - hit.point) + abs3(below - hit.point);
            base = mix(base, other, checker(hit.point, footprint, max(size, 1e-3)));
        }
        if model.colors.len() == model.positions.len() {
            let colors = corners.map(|corner| Vec3::from_array(model.colors[corner]));
            base = multiply(base, blend3(colors, hit.shares).to_array());
        }
        if let Some(texture) = texture
            && model.uvs.len() == model.positions.len()
        {
            let [a, b, c] = corners.map(|corner| model.uvs[corner]);
            let uv = a + (b - a) * hit.shares[0] + (c - a) * hit.shares[1];
            let texels = texture.texels() * pixel_area * uv_per_area([a, b, c], points);
            base = multiply(base, texture.sample(uv, texture.level_for(texels), self.tables));
        }
        base
    }

    /// A matt surface under the sun and a sky that is bright above and dark below.
    fn light(&self, base: [f32; 3], point: Vec3, normal: Vec3, face: Vec3) -> [f32; 3] {
        let sky = &self.scene.sky;
        let around = mix(sky.ground, mix(sky.horizon, sky.zenith, 0.5), 0.5 + 0.5 * normal.y);
        let cos = normal.dot(self.shadow.to_sun);
        let mut sun = [0.0; 3];
        if cos > 0.0 {
            let light = cos * self.shadow.light_at(point, face, face.dot(self.shadow.to_sun));
            sun = self.scene.sun.color.map(|channel| channel * light);
        }
        core::array::from_fn(|i| base[i] * (around[i] + sun[i]))
    }
}

/// Möller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997; here the ray is known to hit, or to
/// pass within a pixel.
#[inline(always)]
fn meet(eye: Vec3, ray: Vec3, [a, b, c]: [Vec3; 3]) -> Hit {
    let (ab, ac, from_a) = (b - a, c - a, eye - a);
    let (p, q) = (ray.cross(ac), from_a.cross(ab));
    let det = ab.dot(p);
    let inverse = if det == 0.0 { 0.0 } else { 1.0 / det };
    let depth = ac.dot(q) * inverse;
    let second = clamp(from_a.dot(p) * inverse, 0.0, 1.0);
    let third = clamp(ray.dot(q) * inverse, 0.0, 1.0);
    Hit { point: eye + ray * depth, shares: [second, third], depth }
}

fn blend3([a, b, c]: [Vec3; 3], [second, third]: [f32; 2]) -> Vec3 {
    a + (b - a) * second + (c - a) * third
}

fn mix(a: [f32; 3], b: [f32; 3], amount: f32) -> [f32; 3] {
    core::array::from_fn(|i| a[i] + (b[i] - a[i]) * amount)
}

fn multiply(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    core::array::from_fn(|i| a[i] * b[i])
}

/// Area of a triangle in texture coordinates over its area in the world, 1/m².
fn uv_per_area([a, b, c]: [Vec2; 3], [p, q, r]: [Vec3; 3]) -> f32 {
    let on_texture = ((b - a).x * (c - a).y - (b - a).y * (c - a).x).abs();
    let in_world = (q - p).cross(r - p).length();
    on_texture / max(in_world, 1e-12)
}

/// Share of the second colour in a box of `footprint` around `p`: 0 and 1 within squares, between where the box
/// covers several. Mean of a product of two square waves, each integrated in closed form.
fn checker(p: Vec3, footprint: Vec3, size: f32) -> f32 {
    0.5 - 0.5
        * square_wave_mean(p.x / size, footprint.x / size)
        * square_wave_mean(p.z / size, footprint.z / size)
}

/// Mean over `x ± width/2` of the wave that is 1 on [0, 1), −1 on [1, 2), and so on.
fn square_wave_mean(x: f32, width: f32) -> f32 {
    let width = clamp(width, 1e-3, 8.0);
    clamp((triangle_wave(x + 0.5 * width) - triangle_wave(x - 0.5 * width)) / width, -1.0, 1.0)
}

/// Integral of the square wave from 0: up to 1 at odd numbers, 0 at even ones.
fn triangle_wave(x: f32) -> f32 {
    let phase = x - 2.0 * (0.5 * x).floor();
    min(phase, 2.0 - phase)
}
