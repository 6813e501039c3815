//! Pictures without a window.

use super::device::{Gpu, GpuError};
use super::renderer::StageRenderer;
use super::samples::{Target, texture};
use crate::stage::Stage;
use sinew_picture::{Camera, Image, add_captions};

/// Format of pictures that are read back: sRGB bytes are written directly.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Draws pictures of one size without a window.
#[derive(Debug)]
pub struct Offscreen {
    gpu: Gpu,
    renderer: StageRenderer,
    target: Target,
    picture: wgpu::Texture,
    /// Rows of a picture that is read back, each padded.
    rows: wgpu::Buffer,
}

impl Offscreen {
    /// Creates the target for pictures of a size in pixels.
    pub fn new(gpu: Gpu, size: [u32; 2]) -> Self {
        let target = Target::new(&gpu, FORMAT, size);
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
        let picture = texture(&gpu, "picture", FORMAT, target.size, 1, usage);
        let rows = rows_of(&gpu, &picture);
        Self { renderer: StageRenderer::new(&gpu, FORMAT), gpu, target, picture, rows }
    }

    /// Returns the device that draws.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Draws one picture with its captions.
    ///
    /// # Errors
    /// If the picture does not come back from the card.
    pub fn render(&mut self, stage: &Stage<'_>, camera: &Camera) -> Result<Image, GpuError> {
        let Self { gpu, renderer, target, picture, rows } = self;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let view = picture.create_view(&Default::default());
        renderer.render(gpu, stage, camera, target, &view, &mut encoder);
        let mut image = read_back(gpu, picture, rows, encoder)?;
        add_captions(&mut image, &stage.scene.captions);
        Ok(image)
    }
}

/// Returns the bytes of a row in a buffer.
fn padded(width: u32) -> u32 {
    (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

/// Creates a buffer for the rows of a texture.
pub(crate) fn rows_of(gpu: &Gpu, picture: &wgpu::Texture) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("rows"),
        size: u64::from(padded(picture.width())) * u64::from(picture.height()),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    })
}

/// Reads back a texture of four bytes a pixel after the encoder's work; `rows` must have room for the
/// texture.
pub(crate) fn read_back(
    gpu: &Gpu,
    picture: &wgpu::Texture,
    rows: &wgpu::Buffer,
    mut encoder: wgpu::CommandEncoder,
) -> Result<Image, GpuError> {
    let (width, height) = (picture.width(), picture.height());
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(padded(width)),
        rows_per_image: Some(height),
    };
    let buffer = wgpu::TexelCopyBufferInfo { buffer: rows, layout };
    encoder.copy_texture_to_buffer(picture.as_image_copy(), buffer, picture.size());
    gpu.queue.submit([encoder.finish()]);
    let lost = |error: &dyn std::fmt::Display| GpuError::Lost(error.to_string());
    let (told, heard) = std::sync::mpsc::channel();
    rows.map_async(wgpu::MapMode::Read, .., move |result| {
        // If the wait below failed, there is no receiver.
        let _ = told.send(result);
    });
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| lost(&error))?;
    heard.recv().map_err(|error| lost(&error))?.map_err(|error| lost(&error))?;
    let bytes = rows.get_mapped_range(..).map_err(|error| lost(&error))?;
    let row = |row: &[u8]| row[..4 * width as usize].to_vec();
    let mut rgba: Vec<u8> = bytes.chunks(padded(width) as usize).flat_map(row).collect();
    if matches!(picture.format(), wgpu::TextureFormat::Bgra8Unorm | wgpu::TextureFormat::Bgra8UnormSrgb) {
        rgba.chunks_exact_mut(4).for_each(|pixel| pixel.swap(0, 2));
    }
    // The picture of a window is opaque.
    rgba.chunks_exact_mut(4).for_each(|pixel| pixel[3] = 255);
    drop(bytes);
    rows.unmap();
    Ok(Image { width, height, rgba })
}
