//! A canvas of a page, and the page around it.

use super::{Screen, Told, Viewer};
use crate::app::{App, Options};
use crate::gpu::GpuError;
use crate::painter::Panels;
use crate::session::{NamedFile, Subject};
use std::cell::RefCell;
use std::future::Future;
use wasm_bindgen::prelude::*;
use web_sys::HtmlCanvasElement;
use winit::event_loop::{EventLoop, EventLoopProxy};
use winit::platform::web::{EventLoopExtWebSys, WindowAttributesExtWebSys};
use winit::window::{Window, WindowAttributes};

#[wasm_bindgen]
extern "C" {
    /// An error of the browser's console.
    #[wasm_bindgen(js_namespace = console, js_name = error)]
    fn console_error(line: &str);
    /// Page around the canvas, an object with the methods below.
    pub type Page;
    /// A message of the viewer.
    #[wasm_bindgen(method)]
    fn tell(this: &Page, line: &str);
    /// The line why nothing is drawn.
    #[wasm_bindgen(method)]
    fn failed(this: &Page, line: &str);
    /// Subject and number of steps of the frame that is shown.
    #[wasm_bindgen(method)]
    fn shown(this: &Page, title: &str, steps: f64);
    /// A file to be kept.
    #[wasm_bindgen(method)]
    fn keep(this: &Page, name: &str, bytes: &[u8]);
    /// The canvas should be saved as a picture.
    #[wasm_bindgen(method)]
    fn picture(this: &Page, name: &str);
}

/// A viewer on a page: files can be given to it.
#[wasm_bindgen]
pub struct Shown {
    proxy: EventLoopProxy<Told>,
    files: Vec<NamedFile>,
}

#[wasm_bindgen]
impl Shown {
    /// One of the files that were dropped together.
    pub fn file(&mut self, name: String, bytes: Vec<u8>) {
        self.files.push(NamedFile { name, bytes });
    }

    /// All of them have been given: the first that can be shown is shown.
    pub fn open(&mut self) {
        // Nobody hears it if the viewer has ended, which is told on its own.
        let _ = self.proxy.send_event(Told::Files(std::mem::take(&mut self.files)));
    }
}

/// Shows a scene with settings `key=value` in a canvas; without a scene that of the first minute. With `steps` it is stepped so
/// far as fast as it goes, and tells its hash.
///
/// # Errors
/// One line: there is no such scene, it refuses a setting, or the page has no loop of events.
#[wasm_bindgen]
pub fn show(
    canvas: HtmlCanvasElement,
    page: Page,
    scene: Option<String>,
    settings: Vec<String>,
    steps: Option<u32>,
    webgl: bool,
    hides_browser: bool,
) -> Result<Shown, String> {
    // WebAssembly alone says `unreachable` and no more.
    std::panic::set_hook(Box::new(|what| console_error(&what.to_string())));
    let subject = scene.map(|name| Subject::scene(&name, &settings)).transpose()?;
    let steps = steps.map(u64::from);
    let app = App::new(Options { subject, steps, hides_browser, ..Options::default() })?;
    let event_loop = EventLoop::with_user_event().build().map_err(|error| error.to_string())?;
    let proxy: EventLoopProxy<Told> = event_loop.create_proxy();
    let told = RefCell::default();
    let host = Host { canvas, page, webgl, proxy: proxy.clone(), told };
    event_loop.spawn_app(Viewer::new(app, host));
    Ok(Shown { proxy, files: Vec::new() })
}

/// A page, and its services for the viewer.
pub(super) struct Host {
    canvas: HtmlCanvasElement,
    page: Page,
    /// True to draw by WebGL2 also where there is WebGPU.
    webgl: bool,
    proxy: EventLoopProxy<Told>,
    /// The last message.
    told: RefCell<String>,
}

impl Host {
    pub fn attributes(&self) -> WindowAttributes {
        Window::default_attributes().with_canvas(Some(self.canvas.clone()))
    }

    /// Kinds of cards that it may draw by.
    pub fn backends(&self) -> wgpu::Backends {
        if self.webgl { wgpu::Backends::GL } else { wgpu::Backends::all() }
    }

    /// The screen, which is known later.
    pub fn await_screen(
        &self,
        screen: impl Future<Output = Result<Box<Screen>, GpuError>> + 'static,
    ) -> Option<Told> {
        let proxy = self.proxy.clone();
        wasm_bindgen_futures::spawn_local(async move {
            // Nobody hears it if the page is gone.
            let _ = proxy.send_event(Told::Screen(screen.await));
        });
        None
    }

    /// Has the page say why nothing is drawn.
    pub fn failed(&self, error: &GpuError) {
        let line = match error {
            GpuError::NoDriver(why) => {
                format!("this browser draws neither by WebGPU nor by WebGL2 here ({why})")
            }
            GpuError::Driver { name, what } => format!("'{name}' is not enough: {what}"),
            GpuError::NoWindow(why) | GpuError::Lost(why) => format!("nothing can be drawn: {why}"),
        };
        self.page.failed(&line);
    }

    /// Tells the page of a frame.
    pub fn shown(&self, app: &App) {
        let line = app.message().unwrap_or_default();
        if *self.told.borrow() != line {
            line.clone_into(&mut self.told.borrow_mut());
            self.page.tell(line);
        }
        let session = app.session();
        self.page.shown(&session.subject().title(), session.world().step_count() as f64);
    }

    /// Has the page keep a picture of the canvas.
    pub fn picture(&self, _: &mut Screen, _: &App, _: &Panels, name: &str) -> Result<(), String> {
        self.page.picture(name);
        Ok(())
    }

    /// Has the page keep a file.
    pub fn keep(&self, file: &NamedFile) -> Result<(), String> {
        self.page.keep(&file.name, &file.bytes);
        Ok(())
    }
}
