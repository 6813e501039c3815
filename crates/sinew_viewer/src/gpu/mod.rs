//! Drawing by the GPU: device, meshes, pipelines, pictures.

mod device;
mod lists;
mod meshes;
mod offscreen;
mod pipelines;
mod renderer;
mod samples;

#[cfg(not(target_arch = "wasm32"))]
pub(crate) use device::wait;
pub use device::{Gpu, GpuError};
pub use offscreen::Offscreen;
pub(crate) use offscreen::{read_back, rows_of};
pub use renderer::StageRenderer;
pub use samples::Target;
pub(crate) use samples::texture;
