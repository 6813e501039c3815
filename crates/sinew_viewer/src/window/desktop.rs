//! The window of a desktop.

use super::{Screen, Told, Viewer, ViewerError, no_window};
use crate::app::{App, Options};
use crate::gpu::{GpuError, wait};
use crate::painter::Panels;
use crate::session::NamedFile;
use sinew_picture::{PictureFormat, encode};
use std::future::Future;
use winit::dpi::LogicalSize;
use winit::event_loop::EventLoop;
use winit::window::{Window, WindowAttributes};

/// Initial size of the window, points.
const SIZE: [f32; 2] = [1280.0, 760.0];

/// Opens a window with these options, and returns when it is closed.
///
/// # Errors
/// If there is no window system, no driver, or the subject cannot be started.
pub fn open(options: Options) -> Result<(), ViewerError> {
    let host = Host { size: options.size.unwrap_or(SIZE) };
    let app = App::new(options).map_err(ViewerError::Subject)?;
    let event_loop = EventLoop::with_user_event().build().map_err(|error| no_window(&error))?;
    let mut viewer = Viewer::new(app, host);
    event_loop.run_app(&mut viewer).map_err(|error| no_window(&error))?;
    viewer.app.keep_preferences();
    if let Some(line) = viewer.screen.and_then(|screen| screen.failure) {
        return Err(ViewerError::Subject(line));
    }
    viewer.error.map_or(Ok(()), |error| Err(error.into()))
}

/// The desktop and its services for the window.
pub(super) struct Host {
    size: [f32; 2],
}

impl Host {
    pub fn attributes(&self) -> WindowAttributes {
        let [width, height] = self.size;
        Window::default_attributes().with_inner_size(LogicalSize::new(width, height))
    }

    /// Returns the graphics interfaces that the window may use: the environment may name fewer.
    pub fn backends(&self) -> wgpu::Backends {
        wgpu::Backends::all()
    }

    /// Returns the screen; on a desktop there is no wait.
    pub fn await_screen(&self, screen: impl Future<Output = Result<Box<Screen>, GpuError>>) -> Option<Told> {
        Some(Told::Screen(wait(screen)))
    }

    /// Does nothing: [`open`] returns the error to the caller.
    pub fn failed(&self, _: &GpuError) {}

    /// Does nothing: no page shows the frames.
    pub fn shown(&self, _: &App) {}

    /// Writes a picture of the window into the working folder.
    pub fn picture(
        &self,
        screen: &mut Screen,
        app: &App,
        panels: &Panels,
        name: &str,
    ) -> Result<String, String> {
        let image = screen.painter.picture(app, panels).map_err(|error| error.to_string())?;
        let bytes = encode::encode(PictureFormat::Png, &[image], 1).map_err(|error| error.to_string())?;
        self.keep(&NamedFile { name: name.to_owned(), bytes })
    }

    /// Writes a file into the working folder, and returns its full path.
    pub fn keep(&self, file: &NamedFile) -> Result<String, String> {
        sinew::formats::write_atomic(&file.name, &file.bytes).map_err(|error| error.to_string())?;
        let path = std::path::absolute(&file.name).map_err(|error| error.to_string())?;
        Ok(path.display().to_string())
    }
}
