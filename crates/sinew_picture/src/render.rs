use crate::camera::{Camera, NEAR, View};
use crate::clip::clip;
use crate::color::ColorTables;
use crate::image::Image;
use crate::overlay;
use crate::raster::{Footprint, Layer, NOTHING, ScreenVertex, Winding};
use crate::scene::{Faces, Model, Scene, ShadowCasting};
use crate::shade::{SPAN, Shader, Triangle};
use crate::shadow::ShadowMap;
use sinew::math::Vec3;

/// Size and quality of pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RenderSettings {
    /// Pixels across, 1..=8192. Default 640.
    pub width: u32,
    /// Pixels down, 1..=8192. Default 360.
    pub height: u32,
    /// Default four samples.
    pub antialiasing: Antialiasing,
    /// Texels along a side of the shadow map, 16..=8192. Default 1280.
    pub shadow_texels: u32,
    /// Threads that share the work, at least 1 (the default). The picture is the same with any number.
    pub threads: usize,
}

/// Smoothing of edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Antialiasing {
    /// One sample in the middle of each pixel: jagged, twice as fast.
    Off,
    /// Four samples a pixel on a turned grid: near-vertical and near-horizontal edges get all five steps.
    #[default]
    Samples4,
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self {
            width: 640,
            height: 360,
            antialiasing: Antialiasing::default(),
            shadow_texels: 1280,
            threads: 1,
        }
    }
}

impl Antialiasing {
    /// Places within a pixel, 1/256 pixel from its middle.
    fn offsets(self) -> &'static [[i64; 2]] {
        match self {
            Self::Off => &[[0, 0]],
            Self::Samples4 => &[[-32, -96], [96, -32], [32, 96], [-96, 32]],
        }
    }
}

/// Corners farther out than this (in any coordinate, metres) are not drawn: their squares would leave `f32`'s range.
const FARTHEST: f32 = 1e7;

/// Draws scenes. Keeps its buffers from picture to picture.
#[derive(Clone, Debug)]
pub struct Renderer {
    settings: RenderSettings,
    tables: ColorTables,
    shadow: ShadowMap,
    triangles: Vec<Triangle>,
    solid: Vec<Layer>,
    translucent: Vec<Layer>,
    footprints: Footprints,
}

/// Footprints that the layers are to draw, split by how they are seen.
#[derive(Clone, Debug, Default)]
struct Footprints {
    solid: Vec<Footprint>,
    translucent: Vec<Footprint>,
}

impl Renderer {
    /// # Panics
    /// Where a size lies outside the range that [`RenderSettings`] gives.
    pub fn new(settings: RenderSettings) -> Self {
        let RenderSettings { width, height, antialiasing, shadow_texels, threads } = settings;
        assert!((1..=8192).contains(&width) && (1..=8192).contains(&height), "picture of {width} × {height}");
        assert!((16..=8192).contains(&shadow_texels), "shadow map of {shadow_texels} texels");
        assert!(threads >= 1, "a picture needs a thread");
        let layer = |&offset: &[i64; 2]| Layer::new(width as usize, height as usize, offset);
        let layers: Vec<Layer> = antialiasing.offsets().iter().map(layer).collect();
        Self {
            settings,
            tables: ColorTables::new(),
            shadow: ShadowMap::new(shadow_texels as usize),
            triangles: Vec::new(),
            solid: layers.clone(),
            translucent: layers,
            footprints: Footprints::default(),
        }
    }

    /// Size and quality, as given.
    pub fn settings(&self) -> RenderSettings {
        self.settings
    }

    /// Draws one picture.
    pub fn render(&mut self, scene: &Scene, camera: &Camera) -> Image {
        let view = View::new(camera, self.settings.width, self.settings.height);
        self.shadow.begin(scene.sun.direction, camera.target, scene.sun.shadow_radius);
        self.triangles.clear();
        self.footprints.solid.clear();
        self.footprints.translucent.clear();
        for (index, model) in scene.models.iter().enumerate() {
            self.add(model, index, &view);
        }
        self.draw_layers();
        let mut image = self.shade(scene, &view);
        overlay::draw_lines(&mut image, &scene.lines, &view, &self.solid[0], &self.tables);
        overlay::draw_captions(&mut image, &scene.captions, &self.tables);
        image
    }

    /// Hands a model's triangles to the shadow map and to the list that the layers draw.
    fn add(&mut self, model: &Model, index: usize, view: &View) {
        let material = &model.material;
        let visible = material.opacity > 0.0;
        for corners in model.indices.chunks_exact(3) {
            let corners = [corners[0], corners[1], corners[2]];
            let Some(points) = points_of(model, corners) else { continue };
            if material.shadow == ShadowCasting::Yes && visible {
                self.shadow.cast(points);
            }
            let list = if material.opacity >= 1.0 {
                &mut self.footprints.solid
            } else {
                &mut self.footprints.translucent
            };
            let id = self.triangles.len() as u32;
            if visible && project(points, id, material.faces, view, &self.solid[0], list) {
                self.triangles.push(Triangle::new(index as u32, corners, points, view.eye));
            }
        }
    }

    fn draw_layers(&mut self) {
        let footprints = &self.footprints;
        let pairs = self.solid.iter_mut().zip(&mut self.translucent).collect();
        share(self.settings.threads, pairs, |(solid, translucent): (&mut Layer, &mut Layer)| {
            solid.clear();
            footprints.solid.iter().for_each(|footprint| solid.draw(footprint));
            if !footprints.translucent.is_empty() {
                translucent.clear_in_front_of(solid);
                footprints.translucent.iter().for_each(|footprint| translucent.draw(footprint));
            }
        });
    }

    fn shade(&self, scene: &Scene, view: &View) -> Image {
        let width = self.settings.width as usize;
        let height = self.settings.height as usize;
        let Self { shadow, triangles, tables, .. } = self;
        let shader = Shader { scene, view, shadow, triangles, tables };
        let mut rgba = vec![255; width * height * 4];
        let rows = rgba.chunks_exact_mut(width * 4).enumerate().collect();
        share(self.settings.threads, rows, |(y, row): (usize, &mut [u8])| {
            let mut x = 0;
            while x < width {
                if let Some(colors) = self.span(&shader, x, y) {
                    for (pixel, color) in row[4 * x..].chunks_exact_mut(4).zip(colors) {
                        pixel[..3].copy_from_slice(&self.tables.to_srgb3(color));
                    }
                    x += SPAN;
                } else {
                    let color = self.pixel(&shader, x, y);
                    row[4 * x..4 * x + 3].copy_from_slice(&self.tables.to_srgb3(color));
                    x += 1;
                }
            }
        });
        Image { width: self.settings.width, height: self.settings.height, rgba }
    }

    /// Linear colours of pixels side by side that show one flat triangle and nothing else; `None` if they do not.
    #[inline(always)]
    fn span(&self, shader: &Shader<'_>, x: usize, y: usize) -> Option<[[f32; 3]; SPAN]> {
        let width = self.settings.width as usize;
        if x + SPAN > width || !self.footprints.translucent.is_empty() {
            return None;
        }
        let start = y * width + x;
        let id = self.solid[0].ids[start];
        let shows_it = |layer: &Layer| layer.ids[start..start + SPAN].iter().all(|other| *other == id);
        let is_one =
            id != NOTHING && self.solid[0].ids[start + SPAN - 1] == id && self.solid.iter().all(shows_it);
        (is_one && shader.is_flat(id)).then(|| shader.flat_span(id, x, y))
    }

    /// Linear colour of a pixel: every triangle in it is shaded once, in the middle of its samples.
    fn pixel(&self, shader: &Shader<'_>, x: usize, y: usize) -> [f32; 3] {
        let index = y * self.settings.width as usize + x;
        let solid = mean_of_layers(&self.solid, index, |id, sample| {
            let (px, py) = (x as f32 + sample[0], y as f32 + sample[1]);
            if id == NOTHING { shader.sky(px, py) } else { shader.surface(id, px, py).color }
        });
        if self.footprints.translucent.is_empty() {
            return solid;
        }
        let mut seen_through = 0.0;
        let translucent = mean_of_layers(&self.translucent, index, |id, sample| {
            if id == NOTHING {
                return [0.0; 3];
            }
            let surface = shader.surface(id, x as f32 + sample[0], y as f32 + sample[1]);
            surface.color.map(|channel| channel * surface.opacity)
        });
        for layer in &self.translucent {
            seen_through += 1.0 - shader.opacity(layer.ids[index]);
        }
        seen_through /= self.translucent.len() as f32;
        core::array::from_fn(|i| translucent[i] + solid[i] * seen_through)
    }
}

/// Does the work on every item, split over threads by turns: neighbours cost alike, so the shares come out even.
fn share<T: Send>(threads: usize, items: Vec<T>, work: impl Fn(T) + Sync) {
    if threads == 1 {
        items.into_iter().for_each(work);
        return;
    }
    let mut shares: Vec<Vec<T>> = (0..threads).map(|_| Vec::new()).collect();
    for (i, item) in items.into_iter().enumerate() {
        shares[i % threads].push(item);
    }
    std::thread::scope(|scope| {
        for share in shares {
            scope.spawn(|| share.into_iter().for_each(&work));
        }
    });
}

/// The corners of a triangle, unless one is missing, not finite or too far out.
fn points_of(model: &Model, corners: [u32; 3]) -> Option<[Vec3; 3]> {
    let point = |corner: u32| model.positions.get(corner as usize).copied();
    let points = [point(corners[0])?, point(corners[1])?, point(corners[2])?];
    // NaN fails every comparison.
    let near = |p: &Vec3| p.x.abs() < FARTHEST && p.y.abs() < FARTHEST && p.z.abs() < FARTHEST;
    points.iter().all(near).then_some(points)
}

/// Appends the parts of a triangle that lie on the picture; false where there are none.
fn project(
    points: [Vec3; 3],
    id: u32,
    faces: Faces,
    view: &View,
    picture: &Layer,
    list: &mut Vec<Footprint>,
) -> bool {
    let before = list.len();
    let [a, b, c] = points;
    let polygon = clip([view.clip_from_world(a), view.clip_from_world(b), view.clip_from_world(c)], NEAR);
    let corners = polygon.corners();
    for i in 2..corners.len() {
        let vertex = |i: usize| ScreenVertex::from_clip(corners[i], picture.width, picture.height);
        let fan = [vertex(0), vertex(i - 1), vertex(i)];
        if let Some((footprint, winding)) = Footprint::new(fan, id)
            && (faces == Faces::Both || winding == Winding::CounterClockwise)
        {
            list.push(footprint);
        }
    }
    list.len() > before
}

/// Mean over a pixel's samples of `shade(id, place in the pixel)`, called once per different id.
#[inline(always)]
fn mean_of_layers(
    layers: &[Layer],
    index: usize,
    mut shade: impl FnMut(u32, [f32; 2]) -> [f32; 3],
) -> [f32; 3] {
    let first_id = layers[0].ids[index];
    if layers[1..].iter().all(|layer| layer.ids[index] == first_id) {
        return shade(first_id, [0.5; 2]);
    }
    let mut sum = [0.0; 3];
    for (first, layer) in layers.iter().enumerate() {
        let id = layer.ids[index];
        if layers[..first].iter().any(|earlier| earlier.ids[index] == id) {
            continue;
        }
        let (mut count, mut place) = (0.0, [0.0; 2]);
        for same in layers[first..].iter().filter(|later| later.ids[index] == id) {
            let sample = same.sample_position();
            place = [place[0] + sample[0], place[1] + sample[1]];
            count += 1.0;
        }
        // Brighter than white would outweigh its neighbours and bring the jagged edge back.
        let color = shade(id, place.map(|p| p / count)).map(|channel| sinew::math::clamp(channel, 0.0, 1.0));
        for i in 0..3 {
            sum[i] += color[i] * count;
        }
    }
    sum.map(|channel| channel / layers.len() as f32)
}
