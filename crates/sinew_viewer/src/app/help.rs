//! Initial hints, the list of keys, and the line with the last message.

use super::{App, style};
use egui::{Align2, Color32, FontId, Grid, RichText};

/// Hints shown at the start; a small picture shows only the first.
const HINTS: [&str; 3] = [
    "Click to push him; drag a body to pull it, the background to look around",
    "Press B to throw a ball, Space to pause, R to start again",
    "Choose a scene at the left, or drop a file on the window; ? shows all keys",
];

/// Keys, each with its effect.
const KEYS: [(&str, &str); 24] = [
    ("left drag", "on a body: pull it; on the background: look around"),
    ("right drag", "look around"),
    ("middle drag, Shift + drag", "shift the view"),
    ("wheel", "nearer, farther"),
    ("W A S D, Q E", "fly; with Shift faster"),
    ("G", "W A S D walk the character, and no more"),
    ("Ctrl+Z, Ctrl+Y", "undo and redo what you did; edits and settings too"),
    ("X", "show body, point and normal below the pointer"),
    ("F; C", "see all of the scene; go along with it"),
    ("Space", "run, pause"),
    ("N, .", "one step"),
    ("R", "start again"),
    ("B", "throw a ball at what the mouse points at"),
    ("1 to 9, 0, H", "layers"),
    ("click, [ and ]", "choose a body of a ragdoll; its handles change limits and size"),
    ("- and =", "narrow or widen the limits of its joint by 5°"),
    ("Ctrl+S", "save the ragdoll as .sinew.json"),
    ("Left, Right, Home, End", "through a recording, step by step"),
    ("drop a second recording", "of the same scene: it goes along as a ghost"),
    ("/", "search scenes; Enter opens the first"),
    ("P, F12", "write a picture of the window"),
    ("drop a file", "character (GLB, VRM, FBX), world (.json), recording (.sinewrec)"),
    ("?, F1", "this help"),
    ("Escape", "close it"),
];

/// Shows the hints and the last message over the picture.
pub(super) fn overlay(app: &App, ui: &mut egui::Ui) {
    let area = app.area;
    let font = FontId::proportional(14.0);
    if app.shows_hints {
        let hints = if area.width() > super::ROOMY { &HINTS[..] } else { &HINTS[..1] };
        let mut top = area.left_top() + egui::vec2(16.0, 16.0);
        for line in hints {
            top.y = plate(ui, top, Align2::LEFT_TOP, line, &font).bottom() + 12.0;
        }
    }
    if let Some((message, _)) = &app.message {
        plate(ui, area.left_bottom() + egui::vec2(16.0, -16.0), Align2::LEFT_BOTTOM, message, &font);
    }
    if !app.running {
        plate(ui, area.right_top() + egui::vec2(-16.0, 16.0), Align2::RIGHT_TOP, "paused", &font);
    }
}

/// Draws a line of text on a dark plate, readable over any picture; returns its rectangle.
fn plate(ui: &egui::Ui, at: egui::Pos2, align: Align2, text: &str, font: &FontId) -> egui::Rect {
    let width = 0.7 * ui.max_rect().width();
    let galley = ui.painter().layout(text.to_owned(), font.clone(), Color32::WHITE, width);
    let rect = align.anchor_size(at, galley.size());
    ui.painter().rect_filled(rect.expand2(egui::vec2(8.0, 4.0)), 4.0, Color32::from_black_alpha(170));
    ui.painter().galley(rect.min, galley, Color32::WHITE);
    rect
}

/// Shows all keys.
pub(super) fn window(app: &mut App, ctx: &egui::Context) {
    let mut open = app.shows_help;
    let window = egui::Window::new("Keys").open(&mut open).collapsible(false).resizable(false);
    let window = window.vscroll(true).max_height(ctx.content_rect().height() - 80.0);
    window.anchor(Align2::CENTER_CENTER, [0.0, 0.0]).show(ctx, |ui| {
        Grid::new("keys").num_columns(2).spacing([24.0, 7.0]).show(ui, |ui| {
            for (key, what) in KEYS {
                ui.label(RichText::new(key).strong());
                ui.label(RichText::new(what).color(style::FAINT));
                ui.end_row();
            }
        });
    });
    app.shows_help = open;
}
