//! The colour of a point: its triangle, its light, and the haze in front of it.

use crate::camera::View;
use crate::color::ColorTables;
use crate::pipeline::raster::NOTHING;
use crate::pipeline::shadow::ShadowMap;
use crate::scene::{Model, Pattern, RenderMaterial, Scene};
use sinew::math::lanes::{Lanes, Real, Vector3, WIDTH};
use sinew::math::{Vec2, Vec3, abs3, clamp, max, normalize_or};

/// Number of pixels that [`Shader::flat_span`] shades in one call.
pub(crate) const SPAN: usize = WIDTH;

/// A drawn triangle; its index is its id in the layers.
///
/// The intersection with a ray from the eye follows from dot products with vectors of the triangle (Möller and Trumbore, "Fast,
/// Minimum Storage Ray/Triangle Intersection", 1997, with the products regrouped): `depth = k / (ray·m)`, second and third
/// barycentric coordinate `(ray·p) / (ray·m)` and `(ray·q) / (ray·m)`.
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
    /// Unit normal toward the eye.
    face: Vec3,
    /// −1 if the back is visible and vertex normals must be reversed, else 1.
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

    /// Returns the intersection of a ray with the triangle; the ray must hit the triangle or pass within a pixel.
    #[inline(always)]
    fn meet(&self, eye: Vec3, ray: Vec3) -> Hit {
        let det = ray.dot(self.m);
        let inverse = if det == 0.0 { 0.0 } else { 1.0 / det };
        let depth = self.k * inverse;
        let second = clamp(ray.dot(self.p) * inverse, 0.0, 1.0);
        let third = clamp(ray.dot(self.q) * inverse, 0.0, 1.0);
        Hit { point: eye + ray * depth, shares: [second, third], depth, inverse }
    }

    /// Displacement of the intersection of a ray with the plane when the ray changes by `step`.
    #[inline(always)]
    fn slip(&self, hit: &Hit, ray: Vec3, step: Vec3) -> Vec3 {
        (step - ray * (step.dot(self.m) * hit.inverse)) * hit.depth
    }
}

/// Intersection of a ray with the plane of a triangle.
struct Hit {
    /// Intersection, world space, metres.
    point: Vec3,
    /// Barycentric coordinates of the second and the third corner.
    shares: [f32; 2],
    /// Depth, metres.
    depth: f32,
    /// `1 / (ray·m)`, 0 for a ray along the plane.
    inverse: f32,
}

/// Visible colour and opacity of a surface, translucent or solid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    /// Linear colour.
    pub(crate) color: [f32; 3],
    pub(crate) opacity: f32,
}

/// Data for shading one picture.
pub(crate) struct Shader<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) view: &'a View,
    pub(crate) shadow: &'a ShadowMap,
    pub(crate) triangles: &'a [Triangle],
    pub(crate) tables: &'a ColorTables,
}

impl<'a> Shader<'a> {
    /// Returns the linear colour of the sky behind a point of the picture, in pixels.
    pub(crate) fn sky(&self, x: f32, y: f32) -> [f32; 3] {
        let ray = self.view.ray(x, y);
        let height = clamp(ray.y / ray.length(), 0.0, 1.0);
        // The root brings the horizon's light close to the horizon, as thick air does.
        mix(self.scene.sky.horizon, self.scene.sky.zenith, height.sqrt())
    }

    /// Returns the opacity of a triangle, 0 for [`NOTHING`].
    pub(crate) fn opacity(&self, id: u32) -> f32 {
        if id == NOTHING { 0.0 } else { self.model(&self.triangles[id as usize]).material.opacity }
    }

    #[inline(always)]
    fn model(&self, triangle: &Triangle) -> &'a Model {
        &self.scene.models[triangle.model as usize]
    }

    /// Returns visible colour and opacity of triangle `id` at a point of the picture, in pixels.
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

    /// Returns true if a triangle has one normal, and one colour or a checker: [`Self::flat_span`] then shades it.
    #[inline(always)]
    pub(crate) fn is_flat(&self, id: u32) -> bool {
        let model = self.model(&self.triangles[id as usize]);
        let vertices = model.positions.len();
        let has_picture = model.material.texture.is_some() && model.uvs.len() == vertices;
        !has_picture && model.normals.len() != vertices && model.colors.len() != vertices
    }

    /// Returns the colours of a flat triangle at the centres of neighbouring pixels, from `x` on in row `y`, by
    /// channel: the same numbers as [`Self::surface`].
    #[inline(always)]
    pub(crate) fn flat_span<L: Lanes>(&self, id: u32, x: usize, y: usize) -> [L; 3] {
        let triangle = &self.triangles[id as usize];
        let RenderMaterial { color, pattern, .. } = &self.model(triangle).material;
        let rays = self.view.rays::<L>(x as f32, y as f32 + 0.5);
        let m = Vector3::splat(triangle.m);
        let det = rays.dot(m);
        let inverses = L::select(L::eq(det, L::splat(0.0)), L::splat(0.0), L::splat(1.0) / det);
        let depths = L::splat(triangle.k) * inverses;
        let points = Vector3::splat(self.view.eye) + rays * depths;
        let (mut other_color, mut shares) = (*color, L::splat(0.0));
        if let Pattern::Checker { size, other } = *pattern {
            other_color = other;
            let [across, down] = self.view.ray_per_pixel();
            let (across, down) = (Vector3::splat(across), Vector3::splat(down));
            let across = (across - rays * (across.dot(m) * inverses)) * depths;
            let down = (down - rays * (down.dot(m) * inverses)) * depths;
            let covered = across.abs() + down.abs();
            shares = checker([points.x, points.z], [covered.x, covered.z], L::splat(max(size, 1e-3)));
        }
        let suns = self.suns(triangle.face, points, depths);
        let around = self.around(triangle.face);
        let (sun, horizon) = (self.scene.sun.color, self.scene.sky.horizon);
        let half_haze = max(self.scene.sky.haze_distance * self.scene.sky.haze_distance, 1e-6);
        let distance_squared = depths * depths * rays.dot(rays);
        let haze = distance_squared / (distance_squared + L::splat(half_haze));
        let mut seen = [L::splat(0.0); 3];
        for (channel, seen) in seen.iter_mut().enumerate() {
            let base = L::splat(color[channel]) + L::splat(other_color[channel] - color[channel]) * shares;
            let lit = base * (L::splat(around[channel]) + L::splat(sun[channel]) * suns);
            *seen = lit + (L::splat(horizon[channel]) - lit) * haze;
        }
        seen
    }

    /// Returns the sunlight on neighbouring points of a flat triangle.
    #[inline(always)]
    fn suns<L: Lanes>(&self, face: Vec3, points: Vector3<L>, depths: L) -> L {
        let cos = face.dot(self.shadow.to_sun);
        if cos.is_nan() || cos <= 0.0 {
            return L::splat(0.0);
        }
        let lift = self.shadow.lift(face, cos);
        let lifted = points + Vector3::splat(lift);
        let [mut x, mut y, mut z, mut depth] = [[0.0; SPAN]; 4];
        lifted.x.store(&mut x);
        lifted.y.store(&mut y);
        lifted.z.store(&mut z);
        depths.store(&mut depth);
        // If one of the rays hits the plane only behind the eye, the segment between the two points is not valid.
        let is_before = depth[0] > 0.0 && depth[SPAN - 1] > 0.0;
        let (first, last) = (Vec3::new(x[0], y[0], z[0]), Vec3::new(x[SPAN - 1], y[SPAN - 1], z[SPAN - 1]));
        if is_before && self.shadow.is_lit_between(first, last) {
            return L::splat(cos);
        }
        let mut suns = [0.0; SPAN];
        for i in 0..SPAN {
            suns[i] = cos * self.shadow.light_off(Vec3::new(x[i], y[i], z[i]));
        }
        L::load(&suns)
    }

    fn base_color(&self, model: &Model, triangle: &Triangle, hit: &Hit, ray: Vec3) -> [f32; 3] {
        let RenderMaterial { color, texture, pattern, .. } = &model.material;
        let mut base = *color;
        if let Pattern::Checker { size, other } = *pattern {
            let [across, down] = self.view.ray_per_pixel().map(|step| abs3(triangle.slip(hit, ray, step)));
            let covered = across + down;
            let share = checker([hit.point.x, hit.point.z], [covered.x, covered.z], max(size, 1e-3));
            base = mix(base, other, share);
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
            // On a slanted surface a pixel covers more texels. Limit this effect, because a sharp texture is worth some
            // shimmer.
            let cos_view = max(triangle.face.dot(self.view.eye - hit.point) / hit.depth, 0.15);
            let texels = texture.texels() * uv_per_area([a, b, c], triangle.m) * pixel * pixel / cos_view;
            base = multiply(base, texture.sample(uv, texture.level_for(texels), self.tables));
        }
        base
    }

    /// Returns the light of a matt surface under the sun and a sky that is bright above and dark below.
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

    /// Returns the light of the sky on a surface.
    #[inline(always)]
    fn around(&self, normal: Vec3) -> [f32; 3] {
        let sky = &self.scene.sky;
        mix(sky.ground, sky.light_from_above(), 0.5 + 0.5 * normal.y)
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

/// Returns the area of a triangle in texture coordinates over its area in the world, 1/m²; the length of `normal` is twice the
/// latter.
fn uv_per_area([a, b, c]: [Vec2; 3], normal: Vec3) -> f32 {
    let on_texture = ((b - a).x * (c - a).y - (b - a).y * (c - a).x).abs();
    on_texture / max(normal.length(), 1e-12)
}

/// Returns the share of the second colour in a box of `footprint` around `p`, both along x and z: 0 or 1 within a square, between
/// these if the box covers several. Mean of a product of two square waves, each integrated in closed form.
#[inline(always)]
fn checker<R: Real>(p: [R; 2], footprint: [R; 2], size: R) -> R {
    let half = R::splat(0.5);
    half - half
        * square_wave_mean(p[0] / size, footprint[0] / size)
        * square_wave_mean(p[1] / size, footprint[1] / size)
}

/// Returns the mean over `x ± width/2` of the wave that is 1 on [0, 1), −1 on [1, 2), and so on.
#[inline(always)]
fn square_wave_mean<R: Real>(x: R, width: R) -> R {
    let half = R::splat(0.5);
    let width = limited(width, 1e-3, 8.0);
    let mean = (triangle_wave(x + half * width) - triangle_wave(x - half * width)) / width;
    limited(mean, -1.0, 1.0)
}

/// Returns the integral of the square wave from 0: it rises to 1 at odd numbers and falls to 0 at even ones.
#[inline(always)]
fn triangle_wave<R: Real>(x: R) -> R {
    let two = R::splat(2.0);
    let phase = x - two * whole_below(R::splat(0.5) * x);
    R::min(phase, two - phase)
}

/// Returns the largest whole number up to `x`, for `x` up to 2²²; beyond that no checker is visible. Avoids integers, so that lanes
/// can be used.
#[inline(always)]
fn whole_below<R: Real>(x: R) -> R {
    /// Magnitude from which `f32` numbers are whole.
    const WHOLE: f32 = 12_582_912.0;
    let x = limited(x, -4_194_304.0, 4_194_304.0);
    let nearest = (x + R::splat(WHOLE)) - R::splat(WHOLE);
    R::select(R::gt(nearest, x), nearest - R::splat(1.0), nearest)
}

/// Limits lanes like [`clamp`].
#[inline(always)]
pub(crate) fn limited<R: Real>(x: R, least: f32, most: f32) -> R {
    R::min(R::max(x, R::splat(least)), R::splat(most))
}
