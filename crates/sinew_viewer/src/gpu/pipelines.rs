//! Pipelines: combinations of shader, data and target.

use super::device::Gpu;
use super::samples::{DEPTH, SAMPLES};

/// Numbers of a vertex: position, normal, texture coordinates, colour.
pub(crate) const VERTEX: usize = 3 + 3 + 2 + 3;
/// Numbers of an instance: three rows, colour, second colour, palette and faces.
pub(crate) const INSTANCE: usize = 6 * 4;
/// Numbers of a line: two ends and a colour.
pub(crate) const LINE: usize = 9;
/// Numbers of a skinned vertex beside those of a vertex: two with four slots, four weights.
pub(crate) const SKIN: usize = 2 + 4;

/// All pipelines, and the layouts of their inputs.
#[derive(Debug)]
pub(crate) struct Pipelines {
    pub frame_layout: wgpu::BindGroupLayout,
    pub shadow_layout: wgpu::BindGroupLayout,
    pub picture_layout: wgpu::BindGroupLayout,
    pub solid: wgpu::RenderPipeline,
    pub skin: wgpu::RenderPipeline,
    pub translucent: wgpu::RenderPipeline,
    pub solid_shadow: wgpu::RenderPipeline,
    pub skin_shadow: wgpu::RenderPipeline,
    pub sky: wgpu::RenderPipeline,
    pub line: wgpu::RenderPipeline,
    pub line_on_top: wgpu::RenderPipeline,
}

/// Parameters that differ between pipelines.
struct Kind<'a> {
    vertex: &'a str,
    /// Name of the fragment shader; `None` for shadows.
    fragment: Option<&'a str>,
    buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    compare: wgpu::CompareFunction,
    writes_depth: bool,
    blend: Option<wgpu::BlendState>,
}

impl Pipelines {
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        let device = &gpu.device;
        let module = device.create_shader_module(wgpu::include_wgsl!("shader.wgsl"));
        let frame_layout = layout(device, "frame", &[uniform(0), numbers_texture(1)]);
        let shadow_layout = layout(device, "shadow", &[depth_texture(0), sampler(1, true)]);
        let picture_layout = layout(device, "picture", &[color_texture(0), sampler(1, false)]);
        let all = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("all"),
            bind_group_layouts: &[Some(&frame_layout), Some(&shadow_layout), Some(&picture_layout)],
            immediate_size: 0,
        });
        let only_frame = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("only the frame"),
            bind_group_layouts: &[Some(&frame_layout)],
            immediate_size: 0,
        });
        let vertex_attributes =
            wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x2, 3 => Float32x3];
        let instance_attributes = wgpu::vertex_attr_array![
            4 => Float32x4, 5 => Float32x4, 6 => Float32x4, 7 => Float32x4, 8 => Float32x4, 9 => Float32x4];
        let skin_attributes = wgpu::vertex_attr_array![10 => Uint16x4, 11 => Float32x4];
        let line_attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x3];
        let of = |numbers: usize, step_mode, attributes| {
            Some(wgpu::VertexBufferLayout { array_stride: 4 * numbers as u64, step_mode, attributes })
        };
        let each_vertex = wgpu::VertexStepMode::Vertex;
        let each_instance = wgpu::VertexStepMode::Instance;
        let solid = [
            of(VERTEX, each_vertex, &vertex_attributes[..]),
            of(INSTANCE, each_instance, &instance_attributes[..]),
        ];
        let skinned = [solid[0].clone(), solid[1].clone(), of(SKIN, each_vertex, &skin_attributes[..])];
        let line = [of(LINE, each_instance, &line_attributes[..])];
        let nearer = wgpu::CompareFunction::GreaterEqual;
        let make = |kind: Kind<'_>| pipeline(device, &module, &all, &only_frame, format, &kind);
        let surface = |vertex, buffers, blend| {
            let fragment = Some("surface_fragment");
            make(Kind { vertex, fragment, buffers, compare: nearer, writes_depth: true, blend })
        };
        let shadow = |vertex, buffers| {
            let compare = wgpu::CompareFunction::LessEqual;
            make(Kind { vertex, fragment: None, buffers, compare, writes_depth: true, blend: None })
        };
        let over = |vertex, fragment, buffers, compare| {
            make(Kind {
                vertex,
                fragment: Some(fragment),
                buffers,
                compare,
                writes_depth: false,
                blend: None,
            })
        };
        let always = wgpu::CompareFunction::Always;
        Self {
            solid: surface("solid_vertex", &solid, None),
            skin: surface("skin_vertex", &skinned, None),
            translucent: surface("solid_vertex", &solid, Some(wgpu::BlendState::ALPHA_BLENDING)),
            solid_shadow: shadow("solid_shadow", &solid),
            skin_shadow: shadow("skin_shadow", &skinned),
            sky: over("sky_vertex", "sky_fragment", &[], always),
            line: over("line_vertex", "line_fragment", &line, nearer),
            line_on_top: over("line_vertex", "line_fragment", &line, always),
            frame_layout,
            shadow_layout,
            picture_layout,
        }
    }
}

fn pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    all: &wgpu::PipelineLayout,
    only_frame: &wgpu::PipelineLayout,
    format: wgpu::TextureFormat,
    kind: &Kind<'_>,
) -> wgpu::RenderPipeline {
    let targets =
        [Some(wgpu::ColorTargetState { format, blend: kind.blend, write_mask: wgpu::ColorWrites::ALL })];
    let fragment = kind.fragment.map(|entry| wgpu::FragmentState {
        module,
        entry_point: Some(entry),
        compilation_options: Default::default(),
        targets: &targets,
    });
    let samples = if kind.fragment.is_some() { SAMPLES } else { 1 };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(kind.vertex),
        layout: Some(if kind.fragment == Some("surface_fragment") { all } else { only_frame }),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(kind.vertex),
            compilation_options: Default::default(),
            buffers: kind.buffers,
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(kind.writes_depth),
            depth_compare: Some(kind.compare),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
        fragment,
        multiview_mask: None,
        cache: None,
    })
}

fn layout(
    device: &wgpu::Device,
    label: &str,
    entries: &[wgpu::BindGroupLayoutEntry],
) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
}

fn entry(binding: u32, visibility: wgpu::ShaderStages, ty: wgpu::BindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None }
}

fn buffer(ty: wgpu::BufferBindingType) -> wgpu::BindingType {
    wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None }
}

fn uniform(binding: u32) -> wgpu::BindGroupLayoutEntry {
    entry(binding, wgpu::ShaderStages::VERTEX_FRAGMENT, buffer(wgpu::BufferBindingType::Uniform))
}

fn numbers_texture(binding: u32) -> wgpu::BindGroupLayoutEntry {
    let sample_type = wgpu::TextureSampleType::Float { filterable: false };
    wgpu::BindGroupLayoutEntry { visibility: wgpu::ShaderStages::VERTEX, ..image(binding, sample_type) }
}

fn color_texture(binding: u32) -> wgpu::BindGroupLayoutEntry {
    image(binding, wgpu::TextureSampleType::Float { filterable: true })
}

fn depth_texture(binding: u32) -> wgpu::BindGroupLayoutEntry {
    image(binding, wgpu::TextureSampleType::Depth)
}

fn image(binding: u32, sample_type: wgpu::TextureSampleType) -> wgpu::BindGroupLayoutEntry {
    let view_dimension = wgpu::TextureViewDimension::D2;
    let ty = wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false };
    entry(binding, wgpu::ShaderStages::FRAGMENT, ty)
}

fn sampler(binding: u32, compares: bool) -> wgpu::BindGroupLayoutEntry {
    use wgpu::SamplerBindingType::{Comparison, Filtering};
    let ty = wgpu::BindingType::Sampler(if compares { Comparison } else { Filtering });
    entry(binding, wgpu::ShaderStages::FRAGMENT, ty)
}
