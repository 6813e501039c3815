//! Draws pictures on the GPU.

use super::device::Gpu;
use super::lists::{Lists, address};
use super::meshes::{Palette, RigMeshes, Solids, Stream, upload};
use super::pipelines::Pipelines;
use super::samples::{DEPTH, Target, texture};
use crate::stage::Stage;
use sinew::math::{Vec3, normalize_or};
use sinew_picture::{Camera, NEAR, Scene, Texture};
use std::collections::HashMap;
use std::sync::Arc;

/// Texels along a side of the shadow map.
const SHADOW_TEXELS: u32 = 2048;
/// Depth of the shadow volume to each side of the camera's target, in shadow radii.
const SHADOW_DEPTH: f32 = 6.0;
/// Half the width of a line, pixels.
const LINE_HALF_WIDTH: f32 = 0.8;

/// Draws stages. Keeps meshes and textures on the card between pictures.
#[derive(Debug)]
pub struct StageRenderer {
    format: wgpu::TextureFormat,
    pipelines: Pipelines,
    lists: Lists,
    solids: Solids,
    rigs: HashMap<usize, RigMeshes>,
    white: Arc<wgpu::BindGroup>,
    /// Textures by address of the image, which is kept alive so that its address stays unique.
    textures: HashMap<usize, (Arc<Texture>, Arc<wgpu::BindGroup>)>,
    view: wgpu::Buffer,
    /// Data of the frame, for the views of the sun and of the eye.
    frame: wgpu::BindGroup,
    shadow: wgpu::BindGroup,
    shadow_map: wgpu::TextureView,
    instances: Stream,
    palette: Palette,
    vertices: Stream,
    indices: Stream,
    lines: Stream,
}

impl StageRenderer {
    /// Creates a renderer of stages for targets of that format.
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        let pipelines = Pipelines::new(gpu, format);
        let white = Texture::new(1, 1, vec![255; 4]).expect("a texel has four bytes");
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let shadow_map = texture(gpu, "shadow map", DEPTH, [SHADOW_TEXELS; 2], 1, usage);
        let shadow_map = shadow_map.create_view(&Default::default());
        let view = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("view"),
            size: 4 * VIEW as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let stream = |label, usage| Stream::new(gpu, label, usage);
        let palette = Palette::new(gpu);
        Self {
            format,
            lists: Lists::default(),
            solids: Solids::default(),
            rigs: HashMap::new(),
            white: Arc::new(upload(gpu, &pipelines, &white)),
            textures: HashMap::new(),
            frame: frame_group(gpu, &pipelines, &view, &palette),
            shadow: shadow_group(gpu, &pipelines, &shadow_map),
            view,
            shadow_map,
            instances: stream("instances", wgpu::BufferUsages::VERTEX),
            palette,
            vertices: stream("models", wgpu::BufferUsages::VERTEX),
            indices: stream("models", wgpu::BufferUsages::INDEX),
            lines: stream("lines", wgpu::BufferUsages::VERTEX),
            pipelines,
        }
    }

    /// Drops the meshes of the last subject, because another may get its addresses.
    pub fn forget(&mut self) {
        self.rigs.clear();
        self.textures.clear();
        self.solids = Solids::default();
    }

    /// Draws a stage into a view of the target's size and format.
    pub fn render(
        &mut self,
        gpu: &Gpu,
        stage: &Stage<'_>,
        camera: &Camera,
        target: &Target,
        into: &wgpu::TextureView,
        encoder: &mut wgpu::CommandEncoder,
    ) {
        self.upload(gpu, stage, camera, target);
        self.draw_shadows(encoder);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &target.color,
                depth_slice: None,
                resolve_target: Some(into),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Discard,
                },
            })],
            depth_stencil_attachment: Some(depth_of(&target.depth, 0.0, wgpu::StoreOp::Discard)),
            ..Default::default()
        });
        let [left, top, width, height] = target.area;
        pass.set_viewport(left, top, width, height, 0.0, 1.0);
        pass.set_bind_group(0, &self.frame, &[]);
        pass.set_pipeline(&self.pipelines.sky);
        pass.draw(0..3, 0..1);
        pass.set_bind_group(1, &self.shadow, &[]);
        self.draw_surfaces(&mut pass, &stage.scene);
        self.draw_lines(&mut pass);
    }

    fn upload(&mut self, gpu: &Gpu, stage: &Stage<'_>, camera: &Camera, target: &Target) {
        for figure in &stage.figures {
            let make = || RigMeshes::new(gpu, &self.pipelines, &self.white, figure.rig);
            self.rigs.entry(address(figure.rig)).or_insert_with(make);
        }
        for texture in stage.scene.models.iter().filter_map(|model| model.material.texture.as_ref()) {
            let make = || (texture.clone(), Arc::new(upload(gpu, &self.pipelines, texture)));
            self.textures.entry(Arc::as_ptr(texture).addr()).or_insert_with(make);
        }
        let rigs = &self.rigs;
        self.lists.fill(gpu, stage, &mut self.solids, |rig| &rigs[&rig]);
        let encodes = !self.format.is_srgb();
        let view = view_numbers(&stage.scene, camera, [target.area[2], target.area[3]], encodes);
        gpu.queue.write_buffer(&self.view, 0, bytemuck::cast_slice(&view));
        self.instances.write(gpu, bytemuck::cast_slice(&self.lists.instances));
        self.vertices.write(gpu, bytemuck::cast_slice(&self.lists.vertices));
        self.indices.write(gpu, bytemuck::cast_slice(&self.lists.indices));
        self.lines.write(gpu, bytemuck::cast_slice(&self.lists.lines));
        if self.palette.write(gpu, &mut self.lists.palette) {
            self.frame = frame_group(gpu, &self.pipelines, &self.view, &self.palette);
        }
    }

    fn draw_shadows(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadows"),
            depth_stencil_attachment: Some(depth_of(&self.shadow_map, 1.0, wgpu::StoreOp::Store)),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.frame, &[]);
        pass.set_pipeline(&self.pipelines.solid_shadow);
        self.draw_solids(&mut pass);
        self.bind_models(&mut pass);
        for draw in self.lists.models.iter().filter(|draw| draw.casts) {
            pass.draw_indexed(draw.indices.clone(), 0, draw.instance..draw.instance + 1);
        }
        pass.set_pipeline(&self.pipelines.skin_shadow);
        self.draw_figures(&mut pass, |_, _| {});
    }

    fn draw_surfaces(&self, pass: &mut wgpu::RenderPass<'_>, scene: &Scene) {
        pass.set_pipeline(&self.pipelines.solid);
        pass.set_bind_group(2, &*self.white, &[]);
        self.draw_solids(pass);
        self.draw_models(pass, scene, false);
        pass.set_pipeline(&self.pipelines.skin);
        self.draw_figures(pass, |pass, texture| pass.set_bind_group(2, texture, &[]));
        pass.set_pipeline(&self.pipelines.translucent);
        self.draw_models(pass, scene, true);
    }

    fn draw_solids(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_vertex_buffer(1, self.instances.buffer.slice(..));
        for (mesh, instances) in self.solids.list.iter().zip(&self.lists.solids) {
            if !instances.is_empty() {
                pass.set_vertex_buffer(0, mesh.vertices.slice(..));
                pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(0..mesh.count, 0, instances.clone());
            }
        }
    }

    fn bind_models(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_vertex_buffer(0, self.vertices.buffer.slice(..));
        pass.set_index_buffer(self.indices.buffer.slice(..), wgpu::IndexFormat::Uint32);
        pass.set_vertex_buffer(1, self.instances.buffer.slice(..));
    }

    fn draw_models(&self, pass: &mut wgpu::RenderPass<'_>, scene: &Scene, translucent: bool) {
        self.bind_models(pass);
        for draw in self.lists.models.iter().filter(|draw| draw.is_translucent == translucent) {
            let model = &scene.models[draw.model];
            let texture =
                model.material.texture.as_ref().filter(|_| model.uvs.len() == model.positions.len());
            let texture =
                texture.map_or(&self.white, |texture| &self.textures[&Arc::as_ptr(texture).addr()].1);
            pass.set_bind_group(2, &**texture, &[]);
            pass.draw_indexed(draw.indices.clone(), 0, draw.instance..draw.instance + 1);
        }
    }

    fn draw_figures(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        bind: impl Fn(&mut wgpu::RenderPass<'_>, &wgpu::BindGroup),
    ) {
        for draw in &self.lists.figures {
            let part = &self.rigs[&draw.rig].parts[draw.part];
            bind(pass, &part.texture);
            pass.set_vertex_buffer(0, part.geometry.vertices.slice(..));
            pass.set_vertex_buffer(2, part.skin.slice(..));
            pass.set_index_buffer(part.geometry.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..part.geometry.count, 0, draw.instances.clone());
        }
    }

    fn draw_lines(&self, pass: &mut wgpu::RenderPass<'_>) {
        let (hidden, all) = (self.lists.hidden_lines, self.lists.line_count());
        pass.set_vertex_buffer(0, self.lines.buffer.slice(..));
        for (pipeline, lines) in
            [(&self.pipelines.line, 0..hidden), (&self.pipelines.line_on_top, hidden..all)]
        {
            if !lines.is_empty() {
                pass.set_pipeline(pipeline);
                pass.draw(0..6, lines);
            }
        }
    }
}

fn depth_of(
    view: &wgpu::TextureView,
    clear: f32,
    store: wgpu::StoreOp,
) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store }),
        stencil_ops: None,
    }
}

fn frame_group(gpu: &Gpu, pipelines: &Pipelines, view: &wgpu::Buffer, palette: &Palette) -> wgpu::BindGroup {
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("frame"),
        layout: &pipelines.frame_layout,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: view.as_entire_binding() },
            wgpu::BindGroupEntry {
                binding: 1,
                resource: wgpu::BindingResource::TextureView(&palette.view()),
            },
        ],
    })
}

fn shadow_group(gpu: &Gpu, pipelines: &Pipelines, map: &wgpu::TextureView) -> wgpu::BindGroup {
    let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        compare: Some(wgpu::CompareFunction::LessEqual),
        ..Default::default()
    });
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("shadow"),
        layout: &pipelines.shadow_layout,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(map) },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&sampler) },
        ],
    })
}

/// Numbers of the shader's view: two matrices and eleven vectors.
const VIEW: usize = 2 * 16 + 11 * 4;

/// Returns the shader's view, in the order of its fields.
fn view_numbers(scene: &Scene, camera: &Camera, [width, height]: [f32; 2], encodes: bool) -> Vec<f32> {
    let axes = camera.axes(width / height);
    let eye = camera.position;
    let (right, up) = (axes.right * axes.half_width, axes.up * axes.half_height);
    let to_sun = normalize_or(scene.sun.direction, Vec3::Y);
    let across_sun = normalize_or(to_sun.cross(Vec3::Y), Vec3::X);
    let up_sun = across_sun.cross(-to_sun);
    let radius = scene.sun.shadow_radius.max(1e-3);
    let mut numbers = Vec::with_capacity(VIEW);
    // The depth is NEAR over the distance: 1 at the nearest, 0 infinitely far.
    let row = |axis: Vec3, offset: f32| [axis.x, axis.y, axis.z, offset];
    let picture = [
        row(axes.right / axes.half_width, -eye.dot(axes.right) / axes.half_width),
        row(axes.up / axes.half_height, -eye.dot(axes.up) / axes.half_height),
        [0.0, 0.0, 0.0, NEAR],
        row(axes.forward, -eye.dot(axes.forward)),
    ];
    let target = camera.target;
    let depth = 2.0 * SHADOW_DEPTH * radius;
    let sun = [
        row(across_sun / radius, -target.dot(across_sun) / radius),
        row(up_sun / radius, -target.dot(up_sun) / radius),
        row(-to_sun / depth, 0.5 + target.dot(to_sun) / depth),
        [0.0, 0.0, 0.0, 1.0],
    ];
    for rows in [picture, sun] {
        // The shader expects columns.
        numbers.extend((0..16).map(|i| rows[i % 4][i / 4]));
    }
    let texel = 2.0 * radius / SHADOW_TEXELS as f32;
    let haze = scene.sky.haze_distance * scene.sky.haze_distance;
    let mut push = |v: [f32; 3], w: f32| numbers.extend([v[0], v[1], v[2], w]);
    push(eye.to_array(), texel);
    push((axes.forward - right + up).to_array(), 0.0);
    push((right * 2.0).to_array(), 0.0);
    push((up * -2.0).to_array(), 0.0);
    push(to_sun.to_array(), 0.0);
    push(scene.sun.color, 0.0);
    push(scene.sky.zenith, 0.0);
    push(scene.sky.horizon, haze.max(1e-6));
    push(scene.sky.ground, 0.0);
    push(scene.sky.light_from_above(), 0.0);
    push([width, height, LINE_HALF_WIDTH], f32::from(u8::from(encodes)));
    debug_assert_eq!(numbers.len(), VIEW);
    numbers
}
