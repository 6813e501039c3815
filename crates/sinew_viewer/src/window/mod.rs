//! The window: receives events and shows frames, on the desktop in a window of the system, in a browser in a canvas of
//! the page.

#[cfg(not(target_arch = "wasm32"))]
mod desktop;
#[cfg(target_arch = "wasm32")]
pub mod web;

use crate::app::{App, Order};
use crate::gpu::{Gpu, GpuError};
use crate::painter::{Painter, Panels};
use crate::session::NamedFile;
use std::sync::{Arc, Mutex};
use web_time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow};
use winit::window::{Window, WindowId};

#[cfg(not(target_arch = "wasm32"))]
use desktop::Host;
#[cfg(not(target_arch = "wasm32"))]
pub use desktop::open;
#[cfg(target_arch = "wasm32")]
use web::Host;

/// Time between frames while nothing moves by itself.
const IDLE: Duration = Duration::from_millis(200);

/// Reason why the viewer could not be shown, in one line.
#[derive(Debug, thiserror::Error)]
pub enum ViewerError {
    /// The GPU or the window system failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The subject cannot be shown.
    #[error("{0}")]
    Subject(String),
}

/// Returns an error as one line, without the source location that other libraries add.
fn one_line(error: &dyn std::fmt::Display) -> String {
    let line = error.to_string().lines().map(str::trim).collect::<Vec<_>>().join(" ");
    let said =
        line.rsplit_once(".rs:").and_then(|(_, rest)| rest.split_once(": ")).map(|(_, said)| said.to_owned());
    said.unwrap_or(line).trim_end_matches('.').to_owned()
}

/// The app with its host, its screen and the last GPU error.
struct Viewer {
    app: App,
    host: Host,
    screen: Option<Screen>,
    /// True if the next frame differs from the last one without input.
    moves: bool,
    error: Option<GpuError>,
}

/// Message to the viewer beside the events of the system.
enum Told {
    /// The screen, or the error; a browser provides it later.
    Screen(Result<Box<Screen>, GpuError>),
    /// Files dropped on the page.
    #[cfg_attr(
        not(target_arch = "wasm32"),
        expect(dead_code, reason = "on a desktop, files are dropped as paths")
    )]
    Files(Vec<NamedFile>),
    /// An order of the page.
    #[cfg_attr(
        not(target_arch = "wasm32"),
        expect(dead_code, reason = "on a desktop, keys take the place of the page's buttons")
    )]
    Order(Order),
}

/// A window and its renderer.
struct Screen {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    painter: Painter,
    ctx: egui::Context,
    input: egui_winit::State,
    /// Errors of the driver since the last frame.
    complaints: Arc<Mutex<Vec<String>>>,
    /// Subject in the window's title.
    title: String,
    /// Reason of a failed drawing.
    failure: Option<String>,
}

impl Viewer {
    fn new(app: App, host: Host) -> Self {
        Self { app, host, screen: None, moves: true, error: None }
    }
}

impl ApplicationHandler<Told> for Viewer {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.screen.is_some() {
            return;
        }
        let title = format!("Sinew: {}", self.app.session().subject().title());
        let window = event_loop.create_window(self.host.attributes().with_title(title));
        match window.map_err(|error| no_window(&error)) {
            Ok(window) => {
                let display = Box::new(event_loop.owned_display_handle());
                let mut descriptor = wgpu::InstanceDescriptor::new_with_display_handle_from_env(display);
                descriptor.backends &= self.host.backends();
                if let Some(told) = self.host.await_screen(Screen::new(Arc::new(window), descriptor)) {
                    self.user_event(event_loop, told);
                }
            }
            Err(error) => self.user_event(event_loop, Told::Screen(Err(error))),
        }
    }

    fn user_event(&mut self, event_loop: &ActiveEventLoop, told: Told) {
        match told {
            Told::Screen(Ok(screen)) => {
                self.app.tell(format!("drawn by {}", screen.painter.gpu.name()));
                screen.window.request_redraw();
                self.screen = Some(*screen);
            }
            Told::Screen(Err(error)) => {
                self.host.failed(&error);
                self.error = Some(error);
                event_loop.exit();
            }
            Told::Files(files) => self.app.open_dropped(files),
            Told::Order(order) => self.app.obey(order),
        }
        self.moves = true;
    }

    fn new_events(&mut self, _: &ActiveEventLoop, cause: StartCause) {
        if matches!(cause, StartCause::ResumeTimeReached { .. }) {
            self.moves = true;
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
                screen.frame(&mut self.app, &self.host);
                if self.app.is_closing() {
                    event_loop.exit();
                }
                self.moves = self.app.is_moving() || screen.ctx.has_requested_repaint();
                event_loop.set_control_flow(if self.moves {
                    ControlFlow::Wait
                } else {
                    ControlFlow::WaitUntil(Instant::now() + IDLE)
                });
            }
            _ => {}
        }
        self.moves |= response.repaint;
    }

    fn about_to_wait(&mut self, _: &ActiveEventLoop) {
        if let Some(screen) = self.screen.as_ref().filter(|_| self.moves) {
            screen.window.request_redraw();
        }
    }
}

fn no_window(error: &dyn std::fmt::Display) -> GpuError {
    GpuError::NoWindow(one_line(error))
}

impl Screen {
    async fn new(window: Arc<Window>, descriptor: wgpu::InstanceDescriptor) -> Result<Box<Self>, GpuError> {
        // In a page this is WebGPU if available, else WebGL2; no desktop has WebGPU.
        let instance = wgpu::util::new_instance_with_webgpu_detection(descriptor).await;
        let surface = instance.create_surface(window.clone()).map_err(|error| no_window(&error))?;
        let gpu = Gpu::open_for(&instance, Some(&surface)).await?;
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
        // Panels are blended as bytes of sRGB, so the shader writes those bytes if the window accepts them.
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
        let title = String::new();
        Ok(Box::new(Self { window, surface, config, painter, ctx, input, complaints, title, failure: None }))
    }

    fn resize(&mut self, size: [u32; 2]) {
        if size.contains(&0) {
            return;
        }
        [self.config.width, self.config.height] = size;
        self.surface.configure(&self.painter.gpu.device, &self.config);
        self.painter.resize(size);
    }

    /// Runs and draws one frame.
    fn frame(&mut self, app: &mut App, host: &Host) {
        app.advance();
        let title = app.session().subject().title();
        if self.title != title {
            self.window.set_title(&format!("Sinew: {title}"));
            self.title = title;
        }
        let input = self.input.take_egui_input(&self.window);
        let output = self.ctx.run_ui(input, |ui| app.ui(ui));
        self.input.handle_platform_output(&self.window, output.platform_output.clone());
        let panels = self.painter.panels(&self.ctx, output);
        self.show(app, &panels);
        if app.takes_screenshot() {
            let world = app.session().world();
            let name = format!("sinew-{}-{}.png", app.session().subject().title(), world.step_count());
            match host.picture(self, app, &panels, &name) {
                Ok(path) => app.tell(format!("wrote {path}")),
                Err(line) => app.tell(line),
            }
        }
        if let Some(path) = app.due_screenshot()
            && let Err(line) = host.picture(self, app, &panels, &path.display().to_string())
        {
            self.failure = Some(line);
        }
        for file in app.take_files() {
            match host.keep(&file) {
                Ok(path) => app.tell(format!("wrote {path}")),
                Err(line) => app.tell(line),
            }
        }
        self.painter.finish(&panels);
        if let Ok(mut complaints) = self.complaints.lock()
            && let Some(complaint) = complaints.drain(..).next()
        {
            app.tell(format!("the driver complains: {complaint}"));
        }
        host.shown(app);
    }

    fn show(&mut self, app: &App, panels: &Panels) {
        use wgpu::CurrentSurfaceTexture::{Lost, Outdated, Suboptimal, Success};
        let device = &self.painter.gpu.device;
        let texture = match self.surface.get_current_texture() {
            Success(texture) | Suboptimal(texture) => texture,
            Outdated | Lost => return self.surface.configure(device, &self.config),
            // The window is not visible now.
            _ => return,
        };
        let mut encoder = device.create_command_encoder(&Default::default());
        let view = texture.texture.create_view(&Default::default());
        self.painter.paint(app, panels, &view, &mut encoder);
        self.painter.gpu.queue.submit([encoder.finish()]);
        self.window.pre_present_notify();
        self.painter.gpu.queue.present(texture);
    }
}
