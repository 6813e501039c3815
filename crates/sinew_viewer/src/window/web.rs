//! A canvas of a page, and the page around it.

use super::{Screen, Told, Viewer};
use crate::app::{App, Options, Order};
use crate::gpu::GpuError;
use crate::painter::Panels;
use crate::session::{NamedFile, Subject};
use sinew_scenes::scenes::{Scene, registry};
use sinew_scenes::staged::Sample;
use std::cell::RefCell;
use std::future::Future;
use wasm_bindgen::prelude::*;
use web_sys::HtmlCanvasElement;
use winit::event_loop::{EventLoop, EventLoopProxy};
use winit::platform::web::{EventLoopExtWebSys, WindowAttributesExtWebSys};
use winit::window::{Window, WindowAttributes};

#[wasm_bindgen]
extern "C" {
    /// Writes an error to the browser's console.
    #[wasm_bindgen(js_namespace = console, js_name = error)]
    fn console_error(line: &str);
    /// Page around the canvas, an object with the methods below.
    pub type Page;
    /// Shows a message of the viewer.
    #[wasm_bindgen(method)]
    fn tell(this: &Page, line: &str);
    /// Shows the reason why nothing is drawn.
    #[wasm_bindgen(method)]
    fn failed(this: &Page, line: &str);
    /// Reports a frame: subject and number of steps, the subject's position in the picture (NaN: out of sight), and whether the
    /// simulation runs and the camera follows.
    #[wasm_bindgen(method)]
    fn shown(this: &Page, title: &str, steps: f64, x: f32, y: f32, runs: bool, follows: bool);
    /// Offers a file to the user.
    #[wasm_bindgen(method)]
    fn keep(this: &Page, name: &str, bytes: &[u8]);
    /// Saves the canvas as a picture.
    #[wasm_bindgen(method)]
    fn picture(this: &Page, name: &str);
}

/// A viewer on a page, which can receive files.
#[wasm_bindgen]
pub struct Shown {
    proxy: EventLoopProxy<Told>,
    files: Vec<NamedFile>,
}

#[wasm_bindgen]
impl Shown {
    /// Adds one of the files that were dropped together.
    pub fn file(&mut self, name: String, bytes: Vec<u8>) {
        self.files.push(NamedFile { name, bytes });
    }

    /// Opens the added files: shows the first one that can be shown, on the stage of the demo or on the workbench.
    ///
    /// # Errors
    /// One line: none of the files can be shown.
    pub fn open(&mut self, on_stage: bool) -> Result<(), String> {
        let files = std::mem::take(&mut self.files);
        if on_stage {
            let subject = Subject::staged(files).map_err(|error| error.to_string())?;
            self.send(Told::Order(Order::Open(Box::new(subject))));
        } else {
            self.send(Told::Files(files));
        }
        Ok(())
    }

    /// Shows a scene.
    ///
    /// # Errors
    /// One line: there is no scene of that name.
    pub fn scene(&self, name: &str) -> Result<(), String> {
        let subject = Subject::scene(name, &[])?;
        self.send(Told::Order(Order::Open(Box::new(subject))));
        Ok(())
    }

    /// Shows a built-in character; an unknown name shows the mannequin.
    pub fn sample(&self, name: &str) {
        let sample = Sample::ALL.into_iter().find(|sample| sample.name() == name);
        let subject = Subject::Sample(sample.unwrap_or(Sample::Mannequin));
        self.send(Told::Order(Order::Open(Box::new(subject))));
    }

    /// Acts like the button of that name; an unknown name does nothing.
    pub fn order(&self, name: &str) {
        if let Some(order) = Order::named(name) {
            self.send(Told::Order(order));
        }
    }

    fn send(&self, told: Told) {
        // If the viewer has ended, nothing receives the message; the page learns of the end by another message.
        let _ = self.proxy.send_event(told);
    }
}

/// Returns all scenes as lines of a name, a chapter and a description, with tabs between them.
#[wasm_bindgen]
pub fn scenes() -> String {
    let line = |scene: &Scene| format!("{}\t{}\t{}", scene.name, scene.chapter.title(), scene.about);
    registry().iter().map(line).collect::<Vec<_>>().join("\n")
}

/// Shows a scene with settings `key=value` in a canvas; without a scene the demo. `steps` are taken at full speed, and then the hash is
/// shown. `panels` are `all`, `few` (without the list of scenes) or `none`; without panels keys and the wheel move the page as well.
///
/// # Errors
/// One line: there is no such scene, the scene refuses a setting, or the page has no event loop.
#[wasm_bindgen]
pub fn show(
    canvas: HtmlCanvasElement,
    page: Page,
    scene: Option<String>,
    settings: Vec<String>,
    steps: Option<u32>,
    webgl: bool,
    panels: &str,
) -> Result<Shown, String> {
    // Without this hook, WebAssembly reports a panic only as `unreachable`.
    std::panic::set_hook(Box::new(|what| console_error(&what.to_string())));
    let subject = scene.map(|name| Subject::scene(&name, &settings)).transpose()?;
    let steps = steps.map(u64::from);
    let (hides_browser, hides_panels) = (panels == "few", panels == "none");
    let app = App::new(Options { subject, steps, hides_browser, hides_panels, ..Options::default() })?;
    let event_loop = EventLoop::with_user_event().build().map_err(|error| error.to_string())?;
    let proxy: EventLoopProxy<Told> = event_loop.create_proxy();
    let told = RefCell::default();
    let host = Host { canvas, page, webgl, is_part: hides_panels, proxy: proxy.clone(), told };
    event_loop.spawn_app(Viewer::new(app, host));
    Ok(Shown { proxy, files: Vec::new() })
}

/// The page and its services for the viewer.
pub(super) struct Host {
    canvas: HtmlCanvasElement,
    page: Page,
    /// True to draw by WebGL2 even if there is WebGPU.
    webgl: bool,
    /// True if the canvas is a part of its page.
    is_part: bool,
    proxy: EventLoopProxy<Told>,
    /// Last message shown.
    told: RefCell<String>,
}

impl Host {
    pub fn attributes(&self) -> WindowAttributes {
        let attributes = Window::default_attributes().with_canvas(Some(self.canvas.clone()));
        // On a page, do not activate the window: it would take the focus, and the browser would scroll to it.
        attributes.with_prevent_default(!self.is_part).with_active(!self.is_part)
    }

    /// Returns the graphics interfaces that the canvas may use.
    pub fn backends(&self) -> wgpu::Backends {
        if self.webgl { wgpu::Backends::GL } else { wgpu::Backends::all() }
    }

    /// Starts to wait for the screen, which arrives as a message.
    pub fn await_screen(
        &self,
        screen: impl Future<Output = Result<Box<Screen>, GpuError>> + 'static,
    ) -> Option<Told> {
        let proxy = self.proxy.clone();
        wasm_bindgen_futures::spawn_local(async move {
            // If the page was closed, nothing receives the message.
            let _ = proxy.send_event(Told::Screen(screen.await));
        });
        None
    }

    /// Shows the reason why nothing is drawn on the page.
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

    /// Reports a frame to the page.
    pub fn shown(&self, app: &App) {
        let line = app.message().unwrap_or_default();
        if *self.told.borrow() != line {
            line.clone_into(&mut self.told.borrow_mut());
            self.page.tell(line);
        }
        let session = app.session();
        let [x, y] = app.subject_place().unwrap_or([f32::NAN; 2]);
        let steps = session.world().step_count() as f64;
        self.page.shown(&session.subject().title(), steps, x, y, app.is_running(), app.is_following());
    }

    /// Saves a picture of the canvas through the page.
    pub fn picture(&self, _: &mut Screen, _: &App, _: &Panels, name: &str) -> Result<String, String> {
        self.page.picture(name);
        Ok(name.to_owned())
    }

    /// Offers a file to the user through the page.
    pub fn keep(&self, file: &NamedFile) -> Result<String, String> {
        self.page.keep(&file.name, &file.bytes);
        Ok(file.name.clone())
    }
}
