//! The timeline of a recording: current step, first divergence, and first difference to a second run.

use super::{App, style};
use egui::{Color32, RichText, Sense, Stroke};
use sinew_scenes::recording::Difference;

/// Height of the bar, points.
const HEIGHT: f32 = 22.0;
/// Colour of the second run.
pub(super) const GHOST: Color32 = Color32::from_rgb(80, 200, 190);

/// Returns the first step at which the second run differs.
fn parting(app: &App) -> Option<u64> {
    match app.session.ghost()?.difference()? {
        Difference::State { step, .. } => Some(*step),
        Difference::Length { common } => Some(*common),
        Difference::Scene => None,
    }
}

/// Shows the timeline; a click or a drag seeks.
pub(super) fn show(app: &mut App, ui: &mut egui::Ui) {
    let Some(length) = app.session.length() else { return };
    let at = app.seeking.unwrap_or(app.session.world().step_count());
    ui.horizontal(|ui| {
        ui.label(RichText::new(format!("step {at} of {length}")).monospace());
        let width = ui.available_width();
        let (rect, response) = ui.allocate_exact_size(egui::vec2(width, HEIGHT), Sense::click_and_drag());
        let inner = rect.shrink2(egui::vec2(6.0, 0.0));
        let x = |step: u64| inner.left() + inner.width() * (step as f32 / length.max(1) as f32);
        let painter = ui.painter();
        let line =
            egui::Rect::from_x_y_ranges(inner.x_range(), rect.center().y - 3.0..=rect.center().y + 3.0);
        painter.rect_filled(line, 3.0, Color32::from_rgb(20, 22, 27));
        let done = egui::Rect::from_x_y_ranges(inner.left()..=x(at), line.y_range());
        painter.rect_filled(done, 3.0, style::ACCENT);
        for (step, color) in [(app.session.diverged(), style::BAD), (parting(app), GHOST)] {
            if let Some(step) = step {
                painter.vline(x(step), rect.y_range(), Stroke::new(2.0, color));
            }
        }
        painter.circle_filled(egui::pos2(x(at), rect.center().y), 6.0, Color32::WHITE);
        if let Some(pos) = response.interact_pointer_pos() {
            let share = ((pos.x - inner.left()) / inner.width().max(1.0)).clamp(0.0, 1.0);
            app.seek((share * length as f32).round() as u64);
        }
    });
}

/// Shows the second run's name, and the first difference.
pub(super) fn ghost(app: &mut App, ui: &mut egui::Ui) {
    let Some(ghost) = app.session.ghost() else { return };
    ui.label(RichText::new(ghost.name()).color(GHOST));
    let line = told(ghost.difference());
    let place = match ghost.difference() {
        Some(Difference::State { body, step }) => Some((*step, *body)),
        _ => None,
    };
    ui.label(line);
    if let Some((step, body)) = place
        && ui.button("Go there").clicked()
    {
        app.seek(step);
        if let Some((_, [place, _])) = body {
            app.orbit.target = place.translation;
        }
    }
}

/// Describes a difference in a line.
pub(super) fn told(difference: Option<&Difference>) -> String {
    match difference {
        None => "equal in every step".to_owned(),
        Some(Difference::Scene) => "of another scene".to_owned(),
        Some(Difference::Length { common }) => format!("equal for {common} steps; one has more"),
        Some(Difference::State { step, body: None }) => {
            format!("differs from step {step} on, but not in the pose of a body")
        }
        Some(Difference::State { step, body: Some((id, [a, b])) }) => {
            let apart = (a.translation - b.translation).length();
            let turned = a.rotation.angle_to(b.rotation).to_degrees();
            let body = id.to_bits() as u32;
            format!("differs from step {step} on: body {body}, by {apart:.2e} m and {turned:.2e}°")
        }
    }
}
