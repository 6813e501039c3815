use crate::camera::{Camera, NEAR, View};
use crate::color::ColorTables;
use crate::image::Image;
use crate::overlay;
use crate::pipeline::clip::{clip, is_whole, unseen};
use crate::pipeline::raster::{Band, Footprint, NOTHING, Samples, ScreenVertex, Winding};
use crate::pipeline::shade::{SPAN, Shader, Triangle};
use crate::pipeline::shadow::ShadowMap;
use crate::scene::{Faces, Model, Scene, ShadowCasting};
use sinew::math::Vec3;
use sinew::math::dispatch::{self, Kernel};
use sinew::math::lanes::{Lanes, WIDTH};

/// Size and quality of pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RenderSettings {
    /// Width in pixels, 1..=8192. Default 640.
    pub width: u32,
    /// Height in pixels, 1..=8192. Default 360.
    pub height: u32,
    /// Smoothing of edges. Default four samples.
    pub antialiasing: Antialiasing,
    /// Texels along a side of the shadow map, 16..=8192. Default 1280.
    pub shadow_texels: u32,
    /// Number of threads, at least 1 (the default). The picture does not depend on the number.
    pub threads: usize,
}

/// Smoothing of edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Antialiasing {
    /// One sample at the centre of each pixel: jagged, twice as fast.
    Off,
    /// Four samples a pixel on a rotated grid: near-vertical and near-horizontal edges get all five steps.
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
    /// Returns the positions of the samples within a pixel, 1/256 pixel from its centre.
    fn offsets(self) -> &'static [[i64; 2]] {
        match self {
            Self::Off => &[[0, 0]],
            Self::Samples4 => &[[-32, -96], [96, -32], [32, 96], [-96, 32]],
        }
    }
}

/// Largest coordinate of a corner that is drawn, metres: squares of larger ones would exceed the range of `f32`.
const FARTHEST: f32 = 1e7;

/// Draws scenes, and keeps its buffers from picture to picture.
#[derive(Clone, Debug)]
pub struct Renderer {
    settings: RenderSettings,
    tables: ColorTables,
    shadow: ShadowMap,
    triangles: Vec<Triangle>,
    solid: Samples,
    translucent: Samples,
    footprints: Footprints,
}

/// Footprints to draw, solid and translucent ones separately.
#[derive(Clone, Debug, Default)]
struct Footprints {
    solid: Vec<Footprint>,
    translucent: Vec<Footprint>,
}

impl Renderer {
    /// Creates a renderer.
    ///
    /// # Panics
    /// If a size is outside the range that [`RenderSettings`] gives.
    pub fn new(settings: RenderSettings) -> Self {
        let RenderSettings { width, height, antialiasing, shadow_texels, threads } = settings;
        assert!(
            (1..=8192).contains(&width) && (1..=8192).contains(&height),
            "a picture must have 1 to 8192 pixels a side, not {width} × {height}"
        );
        assert!(
            (16..=8192).contains(&shadow_texels),
            "a shadow map must have 16 to 8192 texels a side, not {shadow_texels}"
        );
        assert!(threads >= 1, "a renderer needs at least one thread");
        let samples = Samples::new(width as usize, height as usize, antialiasing.offsets());
        Self {
            settings,
            tables: ColorTables::new(),
            shadow: ShadowMap::new(shadow_texels as usize),
            triangles: Vec::new(),
            solid: samples.clone(),
            translucent: samples,
            footprints: Footprints::default(),
        }
    }

    /// Returns size and quality, as given.
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
        self.shadow.finish();
        self.draw();
        let mut image = self.shade(scene, &view);
        overlay::draw_lines(&mut image, &scene.lines, &view, &self.solid, &self.tables);
        overlay::draw_captions(&mut image, &scene.captions, &self.tables);
        image
    }

    /// Adds a model's triangles to the shadow map and to the list that is drawn.
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
            if visible && project(points, id, material.faces, view, &self.solid, list) {
                self.triangles.push(Triangle::new(index as u32, corners, points, view.eye));
            }
        }
    }

    fn draw(&mut self) {
        let footprints = &self.footprints;
        let threads = self.settings.threads;
        let pairs = self.solid.bands(threads).zip(self.translucent.bands(threads)).collect();
        share(threads, pairs, |(mut solid, mut translucent): (Band<'_>, Band<'_>)| {
            solid.clear();
            solid.draw(&footprints.solid);
            if !footprints.translucent.is_empty() {
                translucent.clear_in_front_of(&solid);
                translucent.draw(&footprints.translucent);
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
            dispatch::run(ShadeRow { renderer: self, shader: &shader, y, row });
        });
        Image { width: self.settings.width, height: self.settings.height, rgba }
    }

    /// Returns linear colours, by channel, of neighbouring pixels that show one flat triangle and nothing else; else `None`.
    #[inline(always)]
    fn span<L: Lanes>(&self, shader: &Shader<'_>, x: usize, y: usize) -> Option<[L; 3]> {
        if !self.footprints.translucent.is_empty() {
            return None;
        }
        let ids = self.solid.ids(x, y, SPAN);
        let id = ids[0];
        if id == NOTHING || ids[ids.len() - 1] != id || !shader.is_flat(id) {
            return None;
        }
        for ids in ids.chunks_exact(WIDTH) {
            let mut others = 0;
            for other in ids {
                others |= other ^ id;
            }
            if others != 0 {
                return None;
            }
        }
        Some(shader.flat_span(id, x, y))
    }

    /// Returns the linear colour of a pixel: every triangle in it is shaded once, at the mean position of its samples.
    fn pixel(&self, shader: &Shader<'_>, x: usize, y: usize) -> [f32; 3] {
        let solid = mean(&self.solid, x, y, |id, sample| {
            let (px, py) = (x as f32 + sample[0], y as f32 + sample[1]);
            if id == NOTHING { shader.sky(px, py) } else { shader.surface(id, px, py).color }
        });
        if self.footprints.translucent.is_empty() {
            return solid;
        }
        let mut seen_through = 0.0;
        let translucent = mean(&self.translucent, x, y, |id, sample| {
            if id == NOTHING {
                return [0.0; 3];
            }
            let surface = shader.surface(id, x as f32 + sample[0], y as f32 + sample[1]);
            surface.color.map(|channel| channel * surface.opacity)
        });
        let ids = self.translucent.ids(x, y, 1);
        for &id in ids {
            seen_through += 1.0 - shader.opacity(id);
        }
        seen_through /= ids.len() as f32;
        core::array::from_fn(|i| translucent[i] + solid[i] * seen_through)
    }
}

/// Shades a row of a picture.
struct ShadeRow<'a> {
    renderer: &'a Renderer,
    shader: &'a Shader<'a>,
    y: usize,
    row: &'a mut [u8],
}

impl Kernel for ShadeRow<'_> {
    type Output = ();

    // Compute spans in plain loops, for which the compiler uses wide registers.
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { renderer, shader, y, row } = self;
        let (width, tables) = (row.len() / 4, &renderer.tables);
        let mut x = 0;
        while x < width {
            let pixels = row[4 * x..].as_chunks_mut::<4>().0.first_chunk_mut::<SPAN>();
            if let Some(pixels) = pixels
                && let Some(colors) = renderer.span::<L>(shader, x, y)
            {
                tables.write_srgb(colors, pixels);
                x += SPAN;
            } else {
                let color = renderer.pixel(shader, x, y);
                row[4 * x..4 * x + 3].copy_from_slice(&tables.to_srgb3(color));
                x += 1;
            }
        }
    }
}

/// Calls `work` for every item. The items are dealt to the threads in turn, because neighbouring items cost about the
/// same, so all threads get about the same load.
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

/// Returns the corners of a triangle, unless one is missing, not finite or too far out.
fn points_of(model: &Model, corners: [u32; 3]) -> Option<[Vec3; 3]> {
    let point = |corner: u32| model.positions.get(corner as usize).copied();
    let points = [point(corners[0])?, point(corners[1])?, point(corners[2])?];
    // NaN fails every comparison.
    let near = |p: &Vec3| p.x.abs() < FARTHEST && p.y.abs() < FARTHEST && p.z.abs() < FARTHEST;
    points.iter().all(near).then_some(points)
}

/// Appends the visible parts of a triangle; returns false if there are none.
fn project(
    points: [Vec3; 3],
    id: u32,
    faces: Faces,
    view: &View,
    picture: &Samples,
    list: &mut Vec<Footprint>,
) -> bool {
    let before = list.len();
    let [a, b, c] = points;
    let triangle = [view.clip_from_world(a), view.clip_from_world(b), view.clip_from_world(c)];
    if unseen(&triangle, NEAR) {
        return false;
    }
    let polygon;
    let corners = if is_whole(&triangle, NEAR) {
        triangle.as_slice()
    } else {
        polygon = clip(triangle, NEAR);
        polygon.corners()
    };
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

/// Returns the mean over a pixel's samples of `shade(id, position in the pixel)`, which is called once per different id.
#[inline(always)]
fn mean(samples: &Samples, x: usize, y: usize, mut shade: impl FnMut(u32, [f32; 2]) -> [f32; 3]) -> [f32; 3] {
    let ids = samples.ids(x, y, 1);
    let first_id = ids[0];
    if ids[1..].iter().all(|&id| id == first_id) {
        return shade(first_id, [0.5; 2]);
    }
    let mut sum = [0.0; 3];
    for (first, &id) in ids.iter().enumerate() {
        if ids[..first].contains(&id) {
            continue;
        }
        let (mut count, mut place) = (0.0, [0.0; 2]);
        for same in (first..ids.len()).filter(|&later| ids[later] == id) {
            let sample = samples.place(same);
            place = [place[0] + sample[0], place[1] + sample[1]];
            count += 1.0;
        }
        // Limit each colour to white, because a brighter one would outweigh the others and make the edge jagged again.
        let color = shade(id, place.map(|p| p / count)).map(|channel| sinew::math::clamp(channel, 0.0, 1.0));
        for i in 0..3 {
            sum[i] += color[i] * count;
        }
    }
    sum.map(|channel| channel / ids.len() as f32)
}
