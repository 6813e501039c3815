//! Keys of the keyboard.

use super::{App, bench, mouse, walk};
use crate::layers::Layer;
use egui::Key;
use sinew::math::Vec3;

impl App {
    /// Handles the keys of a frame, unless a text field has the keyboard focus.
    pub(super) fn keys(&mut self, ui: &egui::Ui) {
        let ctx = ui.ctx();
        if ctx.egui_wants_keyboard_input() {
            return;
        }
        let pressed = |key: Key| ctx.input(|input| input.key_pressed(key));
        let typed = |text: &str| {
            ctx.input(|input| {
                input.events.iter().any(|event| matches!(event, egui::Event::Text(it) if it == text))
            })
        };
        if pressed(Key::Space) {
            self.running = !self.running;
        }
        if pressed(Key::N) || typed(".") {
            self.running = false;
            self.step();
        }
        if pressed(Key::R) {
            self.restart();
        }
        self.bench_keys(ctx);
        if pressed(Key::F) {
            self.frame();
        }
        if pressed(Key::G) {
            walk::toggle(self);
        }
        if pressed(Key::C) {
            self.follow(self.follows.is_none());
            self.tell(if self.follows.is_some() { "the camera follows" } else { "the camera stays" });
        }
        if pressed(Key::B) {
            let at = ui.input(|input| input.pointer.hover_pos());
            mouse::throw(self, at.filter(|at| self.area.contains(*at)));
        }
        if pressed(Key::P) || pressed(Key::F12) {
            self.wants_screenshot = true;
        }
        if pressed(Key::X) {
            self.probe.is_on = !self.probe.is_on;
        }
        if typed("?") || pressed(Key::F1) {
            self.shows_help = !self.shows_help;
        }
        if typed("/") {
            self.focuses_search = true;
        }
        if pressed(Key::Escape) {
            self.search.clear();
            self.shows_help = false;
            self.shows_hints = false;
        }
        use Key::{H, Num0, Num1, Num2, Num3, Num4, Num5, Num6, Num7, Num8, Num9};
        let keys = [Num1, Num2, Num3, Num4, Num5, Num6, Num7, Num8, Num9, Num0, H];
        for (key, layer) in keys.into_iter().zip(Layer::ALL) {
            if pressed(key) {
                self.toggle(layer);
            }
        }
        self.fly(ctx);
    }

    /// Handles keys that change a ragdoll, or seek in a recording.
    fn bench_keys(&mut self, ctx: &egui::Context) {
        let pressed = |key: Key| ctx.input(|input| input.key_pressed(key));
        // Ctrl may be released by the end of a slow frame, so this uses the event's own modifiers.
        let is_save = |event: &egui::Event| matches!(event, egui::Event::Key { key: Key::S, pressed: true, modifiers, .. } if modifiers.command);
        let saves = |input: &egui::InputState| input.events.iter().any(is_save);
        if ctx.input(saves) {
            bench::save(self);
        }
        let reverts = |event: &egui::Event| match event {
            egui::Event::Key { key: Key::Z, pressed: true, modifiers, .. } if modifiers.command => {
                Some(modifiers.shift)
            }
            egui::Event::Key { key: Key::Y, pressed: true, modifiers, .. } if modifiers.command => Some(true),
            _ => None,
        };
        if let Some(redo) = ctx.input(|input| input.events.iter().find_map(reverts)) {
            self.undo(redo);
        }
        for (key, by) in [(Key::OpenBracket, -1), (Key::CloseBracket, 1)] {
            if pressed(key) {
                bench::choose_next(self, by);
            }
        }
        for (key, sign) in [(Key::Minus, -1.0), (Key::Equals, 1.0), (Key::Plus, 1.0)] {
            if pressed(key) {
                bench::widen(self, sign);
            }
        }
        let at = self.session.world().step_count();
        for (key, step) in [
            (Key::ArrowLeft, at.saturating_sub(1)),
            (Key::ArrowRight, at + 1),
            (Key::Home, 0),
            (Key::End, u64::MAX),
        ] {
            if pressed(key) {
                self.seek(step);
            }
        }
    }

    /// Moves the camera while keys are held.
    fn fly(&mut self, ctx: &egui::Context) {
        let (seconds, fast) = ctx.input(|input| (input.stable_dt.min(0.1), input.modifiers.shift));
        if ctx.input(|input| input.modifiers.command) {
            return;
        }
        let held = |key: Key| ctx.input(|input| f32::from(u8::from(input.key_down(key))));
        if self.leads.is_some() {
            return walk::lead(self, held(Key::D) - held(Key::A), held(Key::W) - held(Key::S), fast);
        }
        let way =
            Vec3::new(held(Key::D) - held(Key::A), held(Key::E) - held(Key::Q), held(Key::W) - held(Key::S));
        if way != Vec3::ZERO {
            self.orbit.shift(way * (seconds * if fast { 2.4 } else { 0.8 }));
            ctx.request_repaint();
        }
    }
}
