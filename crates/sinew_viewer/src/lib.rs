//! Scenes, characters and recordings in a window, drawn by the graphics card.
//!
//! [`App`] is the viewer without a window: a running [`Session`], input, a camera, panels. [`open`] puts it into a window,
//! [`Headless`] into pictures. [`Offscreen`] draws a [`Stage`] without any of that.
#![forbid(unsafe_code)]

mod app;
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

pub use app::{App, Options};
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
