//! The window: events of the system in, frames out.

use crate::app::{App, Options};
use crate::gpu::{Gpu, GpuError};
use crate::painter::{Painter, Panels};
use sinew_picture::{PictureFormat, encode};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::LogicalSize;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::window::{Window, WindowId};

/// Size of the window at first, points.
const SIZE: [f32; 2] = [1280.0, 760.0];
/// Wait between frames where nothing moves by itself.
const IDLE: Duration = Duration::from_millis(200);

/// Why the viewer could not be shown. One line.
#[derive(Debug, thiserror::Error)]
pub enum ViewerError {
    /// The card or the window system.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The subject cannot be shown.
    #[error("{0}")]
    Subject(String),
}

/// Opens a window on what the options say, and returns when it is closed.
///
/// # Errors
/// If there is no window system, no driver, or the subject cannot be started.
pub fn open(options: Options) -> Result<(), ViewerError> {
    let size = options.size.unwrap_or(SIZE);
    let app = App::new(options).map_err(ViewerError::Subject)?;
    let event_loop = EventLoop::new().map_err(|error| GpuError::NoWindow(one_line(&error)))?;
    let mut viewer = Viewer { app, size, screen: None, error: None };
    event_loop.run_app(&mut viewer).map_err(|error| GpuError::NoWindow(one_line(&error)))?;
    viewer.app.keep_preferences();
    viewer.error.map_or(Ok(()), |error| Err(error.into()))
}

/// An error as one line, without the place in the source of others at which it came up.
fn one_line(error: &dyn std::fmt::Display) -> String {
    let line = error.to_string().lines().map(str::trim).collect::<Vec<_>>().join(" ");
    let said =
        line.rsplit_once(".rs:").and_then(|(_, rest)| rest.split_once(": ")).map(|(_, said)| said.to_owned());
    said.unwrap_or(line).trim_end_matches('.').to_owned()
}

struct Viewer {
    app: App,
    size: [f32; 2],
    screen: Option<Screen>,
    error: Option<GpuError>,
}

/// A window with all that draws into it.
struct Screen {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    painter: Painter,
    ctx: egui::Context,
    input: egui_winit::State,
    /// Complaints of the driver since the last frame.
    complaints: Arc<Mutex<Vec<String>>>,
}

impl ApplicationHandler for Viewer {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.screen.is_some() {
            return;
        }
        match Screen::new(event_loop, &self.app, self.size) {
            Ok(screen) => {
                self.app.tell(format!("drawn by {}", screen.painter.gpu.name()));
                self.screen = Some(screen);
            }
            Err(error) => {
                self.error = Some(error);
                event_loop.exit();
            }
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(screen) = &mut self.screen else { return };
        let response = screen.input.on_window_event(&screen.window, &event);
        match event {
            WindowEvent::CloseRequested => event_loop.exit(),
            WindowEvent::Resized(size) => screen.resize([size.width, size.height]),
            WindowEvent::DroppedFile(path) => self.app.open_file(&path),
            WindowEvent::RedrawRequested => {
                screen.frame(&mut self.app);
                if self.app.is_closing() {
                    event_loop.exit();
                }
                let moves = self.app.is_moving() || screen.ctx.has_requested_repaint();
                event_loop.set_control_flow(if moves {
                    ControlFlow::Poll
                } else {
                    ControlFlow::WaitUntil(Instant::now() + IDLE)
                });
            }
            _ => {}
        }
        if response.repaint {
            screen.window.request_redraw();
        }
    }

    fn about_to_wait(&mut self, _: &ActiveEventLoop) {
        if let Some(screen) = &self.screen {
            screen.window.request_redraw();
        }
    }
}

impl Screen {
    fn new(event_loop: &ActiveEventLoop, app: &App, [width, height]: [f32; 2]) -> Result<Self, GpuError> {
        let no_window = |error: &dyn std::fmt::Display| GpuError::NoWindow(one_line(error));
        let attributes = Window::default_attributes()
            .with_title(format!("Sinew: {}", app.session().subject().title()))
            .with_inner_size(LogicalSize::new(width, height));
        let window = Arc::new(event_loop.create_window(attributes).map_err(|error| no_window(&error))?);
        let display = Box::new(event_loop.owned_display_handle());
        let descriptor = wgpu::InstanceDescriptor::new_with_display_handle_from_env(display);
        let instance = wgpu::Instance::new(descriptor);
        let surface = instance.create_surface(window.clone()).map_err(|error| no_window(&error))?;
        let gpu = Gpu::open_for(&instance, Some(&surface))?;
        let complaints = Arc::new(Mutex::new(Vec::new()));
        let heard = complaints.clone();
        gpu.device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            if let Ok(mut heard) = heard.lock() {
                heard.push(one_line(&error));
            }
        }));
        let size = window.inner_size();
        let (width, height) = (size.width.max(1), size.height.max(1));
        let config = surface.get_default_config(&gpu.adapter, width, height);
        let mut config = config.ok_or_else(|| no_window(&"the driver cannot draw into it"))?;
        // Panels are mixed as bytes of sRGB, so we write those bytes ourselves where the window takes them.
        let plain = config.format.remove_srgb_suffix();
        if surface.get_capabilities(&gpu.adapter).formats.contains(&plain) {
            config.format = plain;
        }
        surface.configure(&gpu.device, &config);
        let ctx = egui::Context::default();
        let most = Some(gpu.device.limits().max_texture_dimension_2d as usize);
        let scale = Some(window.scale_factor() as f32);
        let input = egui_winit::State::new(ctx.clone(), egui::ViewportId::ROOT, &window, scale, None, most);
        let painter = Painter::new(gpu, config.format, [width, height]);
        Ok(Self { window, surface, config, painter, ctx, input, complaints })
    }

    fn resize(&mut self, size: [u32; 2]) {
        if size.contains(&0) {
            return;
        }
        [self.config.width, self.config.height] = size;
        self.surface.configure(&self.painter.gpu.device, &self.config);
        self.painter.resize(size);
    }

    /// One frame.
    fn frame(&mut self, app: &mut App) {
        app.advance();
        let input = self.input.take_egui_input(&self.window);
        let output = self.ctx.run_ui(input, |ui| app.ui(ui));
        self.input.handle_platform_output(&self.window, output.platform_output.clone());
        let panels = self.painter.panels(&self.ctx, output);
        self.show(app, &panels);
        if app.takes_screenshot() {
            let line = self.write_picture(app, &panels);
            app.tell(line);
        }
        self.painter.finish(&panels);
        if let Ok(mut complaints) = self.complaints.lock()
            && let Some(complaint) = complaints.drain(..).next()
        {
            app.tell(format!("the driver complains: {complaint}"));
        }
    }

    fn show(&mut self, app: &App, panels: &Panels) {
        use wgpu::CurrentSurfaceTexture::{Lost, Outdated, Suboptimal, Success};
        let device = &self.painter.gpu.device;
        let texture = match self.surface.get_current_texture() {
            Success(texture) | Suboptimal(texture) => texture,
            Outdated | Lost => return self.surface.configure(device, &self.config),
            // Nothing is seen of it now.
            _ => return,
        };
        let mut encoder = device.create_command_encoder(&Default::default());
        let view = texture.texture.create_view(&Default::default());
        self.painter.paint(app, panels, &view, &mut encoder);
        self.painter.gpu.queue.submit([encoder.finish()]);
        self.window.pre_present_notify();
        self.painter.gpu.queue.present(texture);
    }

    /// Writes a picture of the window into the working folder; a line that says so.
    fn write_picture(&mut self, app: &App, panels: &Panels) -> String {
        let world = app.session().world();
        let name = format!("sinew-{}-{}.png", app.session().subject().title(), world.step_count());
        let image = match self.painter.picture(app, panels) {
            Ok(image) => image,
            Err(error) => return error.to_string(),
        };
        let written = encode::encode(PictureFormat::Png, &[image], 1)
            .map_err(|error| error.to_string())
            .and_then(|bytes| sinew::formats::write_atomic(&name, &bytes).map_err(|error| error.to_string()));
        written.map_or_else(|what| what, |()| format!("wrote {name}"))
    }
}
