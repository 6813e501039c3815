//! Look of the panels.

use egui::{Color32, FontId, Frame, Margin, TextStyle};

/// Background of panels.
pub(super) const PANEL: Color32 = Color32::from_rgb(27, 30, 36);
/// Colour of secondary text.
pub(super) const FAINT: Color32 = Color32::from_rgb(150, 158, 170);
/// Colour of curves and bars.
pub(super) const ACCENT: Color32 = Color32::from_rgb(88, 166, 255);
/// Colour of a metric that meets its expectation.
pub(super) const GOOD: Color32 = Color32::from_rgb(96, 200, 130);
/// Colour of a metric that misses its expectation.
pub(super) const BAD: Color32 = Color32::from_rgb(240, 120, 100);

/// Sets the style, once.
pub(super) fn apply(ctx: &egui::Context) {
    let done = egui::Id::unique("sinew style");
    if ctx.data(|data| data.get_temp::<bool>(done)).is_some() {
        return;
    }
    ctx.data_mut(|data| data.insert_temp(done, true));
    ctx.set_theme(egui::Theme::Dark);
    ctx.all_styles_mut(|style| {
        for (text, size) in [
            (TextStyle::Body, 13.5),
            (TextStyle::Button, 13.5),
            (TextStyle::Small, 11.5),
            (TextStyle::Heading, 16.0),
        ] {
            style.text_styles.insert(text, FontId::proportional(size));
        }
        style.text_styles.insert(TextStyle::Monospace, FontId::monospace(12.5));
        // Show panels without a fade, because a screenshot might be taken during it.
        style.animation_time = 0.0;
        // Floating bars would cover values at the right edge.
        style.spacing.scroll = egui::style::ScrollStyle::solid();
        style.spacing.item_spacing = egui::vec2(8.0, 5.0);
        style.spacing.button_padding = egui::vec2(8.0, 3.0);
        style.visuals.panel_fill = PANEL;
        style.visuals.window_fill = PANEL;
        style.visuals.override_text_color = Some(Color32::from_rgb(225, 229, 235));
        style.visuals.selection.bg_fill = Color32::from_rgb(40, 88, 150);
    });
}

/// Returns the frame of a panel.
pub(super) fn panel() -> Frame {
    Frame::NONE.fill(PANEL).inner_margin(Margin::symmetric(12, 10))
}
