//! Render targets: colours and depths with several samples a pixel.

use super::device::Gpu;

/// Number of samples a pixel.
pub(crate) const SAMPLES: u32 = 4;
/// Depth of a pixel: 0 infinitely far, 1 at the nearest.
pub(crate) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Colours and depths of a picture while it is drawn.
#[derive(Debug)]
pub struct Target {
    pub(crate) size: [u32; 2],
    pub(crate) color: wgpu::TextureView,
    pub(crate) depth: wgpu::TextureView,
    /// Part of the target that the picture fills: left, top, width and height, pixels.
    pub(crate) area: [f32; 4],
}

impl Target {
    /// Creates the samples for pictures of a size in pixels, each side at least 1.
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat, size: [u32; 2]) -> Self {
        let size = size.map(|side| side.max(1));
        let view = |format: wgpu::TextureFormat| {
            texture(gpu, "samples", format, size, SAMPLES, wgpu::TextureUsages::RENDER_ATTACHMENT)
                .create_view(&Default::default())
        };
        let [width, height] = size.map(|side| side as f32);
        Self { size, color: view(format), depth: view(DEPTH), area: [0.0, 0.0, width, height] }
    }

    /// Returns width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Restricts drawing to a part of the target: left, top, width and height, pixels.
    pub fn set_area(&mut self, [left, top, width, height]: [f32; 4]) {
        let most = self.size.map(|side| side as f32);
        let (left, top) = (left.clamp(0.0, most[0] - 1.0), top.clamp(0.0, most[1] - 1.0));
        self.area = [left, top, width.clamp(1.0, most[0] - left), height.clamp(1.0, most[1] - top)];
    }
}

/// Creates a plain texture without smaller copies.
pub(crate) fn texture(
    gpu: &Gpu,
    label: &str,
    format: wgpu::TextureFormat,
    [width, height]: [u32; 2],
    sample_count: u32,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}
