//! Meshes and textures on the GPU.

use super::device::Gpu;
use super::pipelines::{Pipelines, SKIN, VERTEX};
use super::samples::texture;
use crate::stage::Form;
use sinew::anim::{Primitive, Rig, TextureImage};
use sinew::math::{Transform, Vec2, Vec3};
use sinew::physics::Shape;
use sinew_picture::{Model, RenderMaterial, Texture, draw};
use std::collections::HashMap;
use std::sync::Arc;

/// Triangles on the GPU.
#[derive(Debug)]
pub(crate) struct Mesh {
    pub vertices: wgpu::Buffer,
    pub indices: wgpu::Buffer,
    pub count: u32,
}

/// Unique meshes of the solids.
#[derive(Debug, Default)]
pub(crate) struct Solids {
    by_key: HashMap<Key, usize>,
    pub list: Vec<Mesh>,
    /// Shapes whose address is a key; keeping them alive keeps the address unique.
    kept: Vec<Shape>,
}

#[derive(Debug, PartialEq, Eq, Hash)]
enum Key {
    Fields,
    Ball,
    Cube,
    Cylinder,
    Cone,
    /// Half height and radii of a capsule, bits.
    Round([u32; 3]),
    /// Address of the data of a shape.
    Data(usize),
}

impl Solids {
    /// Returns the index of the mesh of a form.
    pub fn number(&mut self, gpu: &Gpu, form: &Form) -> usize {
        let key = key(form);
        if let Some(&number) = self.by_key.get(&key) {
            return number;
        }
        if let Form::Shape(shape) = form {
            self.kept.push(shape.clone());
        }
        let mut vertices = Vec::new();
        let model = model(form);
        push_vertices(&model, &mut vertices);
        self.list.push(Mesh::new(gpu, &vertices, &model.indices));
        self.by_key.insert(key, self.list.len() - 1);
        self.list.len() - 1
    }
}

fn key(form: &Form) -> Key {
    let address = |pointer: *const u8| Key::Data(pointer.addr());
    match form {
        Form::Fields => Key::Fields,
        Form::Ball => Key::Ball,
        Form::Cube => Key::Cube,
        Form::Cylinder => Key::Cylinder,
        Form::Cone => Key::Cone,
        Form::Shape(shape) => match shape {
            Shape::Hull(data) => address(Arc::as_ptr(data).cast()),
            Shape::Mesh(data) => address(Arc::as_ptr(data).cast()),
            Shape::HeightField(data) => address(Arc::as_ptr(data).cast()),
            Shape::Capsule { half_height, radius } => {
                Key::Round([*half_height, *radius, *radius].map(f32::to_bits))
            }
            Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
                Key::Round([*half_height, *radius_bottom, *radius_top].map(f32::to_bits))
            }
            Shape::Box { .. } => Key::Cube,
            Shape::Sphere { .. } | Shape::HalfSpace => Key::Ball,
            Shape::Cylinder { .. } => Key::Cylinder,
            Shape::Cone { .. } => Key::Cone,
        },
    }
}

fn model(form: &Form) -> Model {
    let of = |shape: &Shape| draw::shape(shape, Transform::IDENTITY, RenderMaterial::default());
    match form {
        Form::Fields => draw::ball(1.0, Transform::IDENTITY, RenderMaterial::default()),
        Form::Ball => of(&Shape::Sphere { radius: 1.0 }),
        Form::Cube => of(&Shape::Box { half_extents: Vec3::ONE }),
        Form::Cylinder => of(&Shape::Cylinder { half_height: 1.0, radius: 1.0 }),
        Form::Cone => of(&Shape::Cone { half_height: 1.0, radius: 1.0 }),
        Form::Shape(shape) => of(shape),
    }
}

/// Appends a model's vertices as numbers.
pub(crate) fn push_vertices(model: &Model, numbers: &mut Vec<f32>) {
    let count = model.positions.len();
    let has = |len: usize| len == count;
    for i in 0..count {
        let normal = if has(model.normals.len()) { model.normals[i] } else { Vec3::ZERO };
        let uv = if has(model.uvs.len()) { model.uvs[i] } else { Vec2::ZERO };
        let color = if has(model.colors.len()) { model.colors[i] } else { [1.0; 3] };
        push_vertex(numbers, model.positions[i], normal, uv, color);
    }
}

fn push_vertex(numbers: &mut Vec<f32>, position: Vec3, normal: Vec3, uv: Vec2, color: [f32; 3]) {
    let start = numbers.len();
    numbers.extend(position.to_array());
    numbers.extend(normal.to_array());
    numbers.extend(uv.to_array());
    numbers.extend(color);
    debug_assert_eq!(numbers.len() - start, VERTEX);
}

impl Mesh {
    fn new(gpu: &Gpu, vertices: &[f32], indices: &[u32]) -> Self {
        let count = vertices.len() / VERTEX;
        // Triangles with missing corners are skipped, as in pictures.
        let whole = |corners: &&[u32]| corners.iter().all(|&corner| (corner as usize) < count);
        let indices: Vec<u32> =
            indices.chunks_exact(3).filter(whole).flat_map(|corners| corners.iter().copied()).collect();
        Self {
            vertices: filled(gpu, "vertices", wgpu::BufferUsages::VERTEX, bytemuck::cast_slice(vertices)),
            indices: filled(gpu, "indices", wgpu::BufferUsages::INDEX, bytemuck::cast_slice(&indices)),
            count: indices.len() as u32,
        }
    }
}

/// Creates a buffer with these bytes.
fn filled(gpu: &Gpu, label: &str, usage: wgpu::BufferUsages, bytes: &[u8]) -> wgpu::Buffer {
    let size = (bytes.len() as u64).next_multiple_of(4).max(4);
    let usage = usage | wgpu::BufferUsages::COPY_DST;
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage,
        mapped_at_creation: false,
    });
    gpu.queue.write_buffer(&buffer, 0, bytes);
    buffer
}

/// A buffer that is rewritten for each picture, and grows.
#[derive(Debug)]
pub(crate) struct Stream {
    pub buffer: wgpu::Buffer,
    label: &'static str,
    usage: wgpu::BufferUsages,
}

impl Stream {
    pub fn new(gpu: &Gpu, label: &'static str, usage: wgpu::BufferUsages) -> Self {
        Self { buffer: filled(gpu, label, usage, &[0; 256]), label, usage }
    }

    /// Writes the buffer; returns true if it was replaced.
    pub fn write(&mut self, gpu: &Gpu, bytes: &[u8]) -> bool {
        if bytes.len() as u64 <= self.buffer.size() {
            gpu.queue.write_buffer(&self.buffer, 0, bytes);
            return false;
        }
        let size = (bytes.len() as u64 * 3 / 2).next_multiple_of(256);
        self.buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(self.label),
            size,
            usage: self.usage | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        gpu.queue.write_buffer(&self.buffer, 0, bytes);
        true
    }
}

/// Matrices in a row of the palette's texture, the same as in the shader. A matrix takes three texels; rows of this length fit
/// every card.
const PALETTE_ROW: usize = 512;
/// Numbers of a row.
const PALETTE_NUMBERS: usize = PALETTE_ROW * 12;

/// The matrices of all characters as a texture that is rewritten for each picture, and grows.
#[derive(Debug)]
pub(crate) struct Palette {
    texture: wgpu::Texture,
}

impl Palette {
    pub fn new(gpu: &Gpu) -> Self {
        Self { texture: Self::texture(gpu, 1) }
    }

    fn texture(gpu: &Gpu, rows: u32) -> wgpu::Texture {
        let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
        let size = [3 * PALETTE_ROW as u32, rows];
        texture(gpu, "palette", wgpu::TextureFormat::Rgba32Float, size, 1, usage)
    }

    pub fn view(&self) -> wgpu::TextureView {
        self.texture.create_view(&Default::default())
    }

    /// Writes the texture, with the last row padded; returns true if it was replaced.
    pub fn write(&mut self, gpu: &Gpu, numbers: &mut Vec<f32>) -> bool {
        numbers.resize(numbers.len().next_multiple_of(PALETTE_NUMBERS), 0.0);
        let rows = (numbers.len() / PALETTE_NUMBERS) as u32;
        let grows = rows > self.texture.height();
        if grows {
            self.texture = Self::texture(gpu, rows.next_power_of_two());
        }
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * PALETTE_NUMBERS as u32),
            rows_per_image: None,
        };
        let size = wgpu::Extent3d { width: 3 * PALETTE_ROW as u32, height: rows, depth_or_array_layers: 1 };
        if rows > 0 {
            let bytes = bytemuck::cast_slice(numbers);
            gpu.queue.write_texture(self.texture.as_image_copy(), bytes, layout, size);
        }
        grows
    }
}

/// Meshes of a rig on the GPU: its parts, each with slots and weights.
#[derive(Debug)]
pub(crate) struct RigMeshes {
    pub parts: Vec<RigPart>,
}

/// A primitive of a rig.
#[derive(Debug)]
pub(crate) struct RigPart {
    /// Number of the mesh in the rig.
    pub mesh: usize,
    pub geometry: Mesh,
    pub skin: wgpu::Buffer,
    pub color: [f32; 3],
    pub texture: Arc<wgpu::BindGroup>,
}

impl RigMeshes {
    pub fn new(gpu: &Gpu, pipelines: &Pipelines, white: &Arc<wgpu::BindGroup>, rig: &Rig) -> Self {
        // A surface with an invalid image keeps its plain colour.
        let picture = |image: &TextureImage| {
            let texture = Texture::new(image.width, image.height, image.rgba.clone()).ok()?;
            Some(Arc::new(upload(gpu, pipelines, &texture)))
        };
        let textures: Vec<_> = rig.textures.iter().map(picture).collect();
        let part = |mesh: usize, primitive: &Primitive| {
            let texture = primitive.texture.and_then(|index| textures.get(index).cloned().flatten());
            let mut vertices = Vec::new();
            push_vertices(&surface(primitive), &mut vertices);
            let [r, g, b, _] = primitive.base_color;
            RigPart {
                mesh,
                geometry: Mesh::new(gpu, &vertices, &primitive.indices),
                skin: skin(gpu, primitive, rig.meshes[mesh].skin.is_some()),
                color: [r, g, b],
                texture: texture.unwrap_or_else(|| white.clone()),
            }
        };
        let of_mesh = |(mesh, of): (usize, &sinew::anim::RigMesh)| {
            of.primitives.iter().map(|primitive| part(mesh, primitive)).collect::<Vec<_>>()
        };
        Self { parts: rig.meshes.iter().enumerate().flat_map(of_mesh).collect() }
    }
}

/// Returns a primitive as it is in its file.
fn surface(primitive: &Primitive) -> Model {
    Model {
        positions: primitive.positions.clone(),
        normals: primitive.normals.clone(),
        uvs: primitive.uvs.clone(),
        colors: primitive.colors.iter().map(|&[r, g, b, _]| [r, g, b]).collect(),
        ..Model::default()
    }
}

/// Returns the joint slots and weights of a primitive; without any, the primitive follows the first slot.
fn skin(gpu: &Gpu, primitive: &Primitive, is_skinned: bool) -> wgpu::Buffer {
    let mut numbers = Vec::with_capacity(SKIN * primitive.positions.len());
    for vertex in 0..primitive.positions.len() {
        let slots = primitive.joints.get(vertex).filter(|_| is_skinned).copied();
        let weights = primitive.weights.get(vertex).filter(|_| is_skinned).copied();
        let ([a, b, c, d], weights) = slots.zip(weights).unwrap_or(([0; 4], [1.0, 0.0, 0.0, 0.0]));
        let pair = |low: u16, high: u16| u32::from(low) | u32::from(high) << 16;
        numbers.extend([pair(a, b), pair(c, d)]);
        numbers.extend(weights.map(f32::to_bits));
    }
    filled(gpu, "skin", wgpu::BufferUsages::VERTEX, bytemuck::cast_slice(&numbers))
}

/// Uploads a texture with its smaller copies.
pub(crate) fn upload(gpu: &Gpu, pipelines: &Pipelines, picture: &Texture) -> wgpu::BindGroup {
    let most = gpu.device.limits().max_texture_dimension_2d;
    let levels: Vec<_> = picture.levels().skip_while(|(w, h, _)| *w.max(h) > most).collect();
    let size = |width: u32, height: u32| wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let made = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("picture"),
        size: size(levels[0].0, levels[0].1),
        mip_level_count: levels.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8UnormSrgb,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (level, &(width, height, rgba)) in levels.iter().enumerate() {
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None };
        let place = wgpu::TexelCopyTextureInfo {
            texture: &made,
            mip_level: level as u32,
            origin: wgpu::Origin3d::ZERO,
            aspect: wgpu::TextureAspect::All,
        };
        gpu.queue.write_texture(place, rgba, layout, size(width, height));
    }
    let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        address_mode_u: wgpu::AddressMode::Repeat,
        address_mode_v: wgpu::AddressMode::Repeat,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    });
    let view = made.create_view(&Default::default());
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("picture"),
        layout: &pipelines.picture_layout,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&sampler) },
        ],
    })
}
