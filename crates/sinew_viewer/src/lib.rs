//! Shows scenes, characters and recordings in a window, drawn by the GPU.
//!
//! [`App`] is the viewer without a window: a running [`Session`], input, a camera, panels. [`open`] shows it in a window,
//! [`Headless`] returns pictures of it. [`Offscreen`] draws a [`Stage`] without input or panels.
#![forbid(unsafe_code)]

mod app;
mod chase;
mod gpu;
mod headless;
mod layers;
mod painter;
mod preferences;
mod session;
mod stage;
mod stage_times;
mod view;
mod window;

pub use app::{App, Options, Order};
pub use chase::Chase;
pub use gpu::{Gpu, GpuError, Offscreen, StageRenderer, Target};
pub use headless::Headless;
pub use layers::Layer;
pub use preferences::Preferences;
pub use session::{Ghost, NamedFile, Session, Subject, Workbench, limits};
pub use stage::Stage;
pub use stage_times::{STAGES, StageTimes};
pub use view::{Orbit, bounds, stage};
pub use window::ViewerError;
#[cfg(not(target_arch = "wasm32"))]
pub use window::open;
#[cfg(target_arch = "wasm32")]
pub use window::web;
