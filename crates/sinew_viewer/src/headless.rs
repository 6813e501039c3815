//! The viewer without a window, for tests and pictures: takes events and returns pictures.

use crate::app::App;
use crate::gpu::{Gpu, GpuError};
use crate::painter::Painter;
use egui::{Event, Modifiers, PointerButton, Pos2, RawInput, Rect, Vec2, pos2};
use sinew_picture::Image;

/// A viewer without a window.
pub struct Headless {
    app: App,
    ctx: egui::Context,
    painter: Painter,
    size: [u32; 2],
    events: Vec<Event>,
    frames: u32,
    /// True if Ctrl is held in the next frame.
    holds_ctrl: bool,
}

impl Headless {
    /// Creates a viewer with a size in pixels, one pixel per point.
    pub fn new(app: App, gpu: Gpu, size: [u32; 2]) -> Self {
        let painter = Painter::new(gpu, wgpu::TextureFormat::Rgba8Unorm, size);
        Self {
            app,
            ctx: egui::Context::default(),
            painter,
            size,
            events: Vec::new(),
            frames: 0,
            holds_ctrl: false,
        }
    }

    /// Returns the viewer.
    pub fn app(&self) -> &App {
        &self.app
    }

    /// Returns the viewer, mutable, for operations that no event triggers.
    pub fn app_mut(&mut self) -> &mut App {
        &mut self.app
    }

    /// Presses and releases a key before the next frame.
    pub fn key(&mut self, key: egui::Key) {
        for pressed in [true, false] {
            self.events.push(Event::Key {
                key,
                physical_key: None,
                pressed,
                repeat: false,
                modifiers: Modifiers::NONE,
            });
        }
    }

    /// Presses and holds a key, or releases it.
    pub fn hold(&mut self, key: egui::Key, pressed: bool) {
        let modifiers = Modifiers::NONE;
        self.events.push(Event::Key { key, physical_key: None, pressed, repeat: false, modifiers });
    }

    /// Presses and releases a key with Ctrl before the next frame.
    pub fn ctrl(&mut self, key: egui::Key) {
        for pressed in [true, false] {
            let modifiers = Modifiers { ctrl: true, command: true, ..Modifiers::NONE };
            self.events.push(Event::Key { key, physical_key: None, pressed, repeat: false, modifiers });
        }
        self.holds_ctrl = true;
    }

    /// Types text before the next frame.
    pub fn text(&mut self, text: &str) {
        self.events.push(Event::Text(text.to_owned()));
    }

    /// Moves the mouse to a point, in points from the upper left corner.
    pub fn move_to(&mut self, x: f32, y: f32) {
        self.events.push(Event::PointerMoved(pos2(x, y)));
    }

    /// Presses or releases the left button at a point, in points from the upper left corner.
    pub fn button(&mut self, x: f32, y: f32, pressed: bool) {
        self.events.push(Event::PointerButton {
            pos: pos2(x, y),
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        });
    }

    /// Runs one frame with the events since the last one, and returns its picture.
    ///
    /// # Errors
    /// If the picture cannot be read back from the GPU.
    pub fn frame(&mut self) -> Result<Image, GpuError> {
        let [width, height] = self.size.map(|side| side as f32);
        self.frames += 1;
        let ctrl = std::mem::take(&mut self.holds_ctrl);
        let modifiers = Modifiers { ctrl, command: ctrl, ..Modifiers::NONE };
        // egui receives modifiers as separate events.
        self.events.insert(0, Event::ModifiersChanged(modifiers));
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, Vec2::new(width, height))),
            // The time of egui advances by a fixed amount per frame, so that a test is repeatable.
            time: Some(f64::from(self.frames) / 60.0),
            events: std::mem::take(&mut self.events),
            focused: true,
            ..RawInput::default()
        };
        let (app, ctx) = (&mut self.app, &self.ctx);
        let output = ctx.run_ui(input, |ui| app.ui(ui));
        let panels = self.painter.panels(ctx, output);
        let image = self.painter.picture(app, &panels);
        self.painter.finish(&panels);
        image
    }
}
