//! Draws the viewer as pixels: the picture, and the panels over it.

use crate::app::App;
use crate::gpu::{Gpu, GpuError, StageRenderer, Target, read_back, rows_of, texture};
use egui_wgpu::{RendererOptions, ScreenDescriptor};
use sinew_picture::Image;

/// Draws a viewer into textures of one format.
pub(crate) struct Painter {
    pub gpu: Gpu,
    format: wgpu::TextureFormat,
    renderer: StageRenderer,
    panels: egui_wgpu::Renderer,
    target: Target,
    /// Key of the session whose meshes are on the GPU.
    shown: u64,
}

/// Panels of a frame, ready to be drawn.
pub(crate) struct Panels {
    jobs: Vec<egui::ClippedPrimitive>,
    screen: ScreenDescriptor,
    free: Vec<egui::TextureId>,
}

impl Painter {
    pub fn new(gpu: Gpu, format: wgpu::TextureFormat, size: [u32; 2]) -> Self {
        let options = RendererOptions { dithering: false, ..RendererOptions::default() };
        Self {
            renderer: StageRenderer::new(&gpu, format),
            panels: egui_wgpu::Renderer::new(&gpu.device, format, options),
            target: Target::new(&gpu, format, size),
            format,
            gpu,
            shown: 0,
        }
    }

    pub fn resize(&mut self, size: [u32; 2]) {
        self.target = Target::new(&self.gpu, self.format, size);
    }

    /// Uploads the changes of a frame's panels.
    pub fn panels(&mut self, ctx: &egui::Context, output: egui::FullOutput) -> Panels {
        let egui::FullOutput { mut textures_delta, shapes, pixels_per_point, .. } = output;
        for (id, deltas) in textures_delta.set.drain() {
            for delta in &deltas {
                self.panels.update_texture(&self.gpu.device, &self.gpu.queue, id, delta);
            }
        }
        let free = textures_delta.free.drain().collect();
        let screen = ScreenDescriptor { size_in_pixels: self.target.size(), pixels_per_point };
        Panels { jobs: ctx.tessellate(shapes, pixels_per_point), screen, free }
    }

    /// Draws a viewer into a view of the painter's size and format.
    pub fn paint(
        &mut self,
        app: &App,
        panels: &Panels,
        into: &wgpu::TextureView,
        encoder: &mut wgpu::CommandEncoder,
    ) {
        let start = app.subject_key();
        if self.shown != start {
            self.renderer.forget();
            self.shown = start;
        }
        let (area, scale) = (app.area(), panels.screen.pixels_per_point);
        self.target.set_area([area.left(), area.top(), area.width(), area.height()].map(|x| x * scale));
        self.renderer.render(&self.gpu, &app.stage(), &app.camera(), &self.target, into, encoder);
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        self.panels.update_buffers(device, queue, encoder, &panels.jobs, &panels.screen);
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("panels"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: into,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        self.panels.render(&mut pass.forget_lifetime(), &panels.jobs, &panels.screen);
    }

    /// Frees textures that the panels no longer show, after drawing.
    pub fn finish(&mut self, panels: &Panels) {
        panels.free.iter().for_each(|id| self.panels.free_texture(id));
    }

    /// Returns a picture of the viewer.
    ///
    /// # Errors
    /// If the GPU does not return the picture.
    pub fn picture(&mut self, app: &App, panels: &Panels) -> Result<Image, GpuError> {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
        let picture = texture(&self.gpu, "screenshot", self.format, self.target.size(), 1, usage);
        let rows = rows_of(&self.gpu, &picture);
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.paint(app, panels, &picture.create_view(&Default::default()), &mut encoder);
        read_back(&self.gpu, &picture, &rows, encoder)
    }
}
