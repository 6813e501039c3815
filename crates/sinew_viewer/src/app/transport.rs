//! The bottom bar: run, pause, step, speed, and step time.

use super::{App, Side, style, timeline};
use egui::{RichText, Slider};

/// Shows the bottom bar.
pub(super) fn show(app: &mut App, ui: &mut egui::Ui) {
    egui::Panel::bottom("transport").frame(style::panel()).show(ui, |ui| {
        timeline::show(app, ui);
        if app.is_narrow {
            ui.horizontal_wrapped(|ui| {
                folds(app, ui);
                run(app, ui);
                ui.label(format!("{:7.2} s", app.session.world().time()));
                outcome(app, ui);
            });
            return;
        }
        ui.horizontal(|ui| {
            run(app, ui);
            ui.separator();
            ui.label(RichText::new("speed").color(style::FAINT));
            ui.add(Slider::new(&mut app.speed, 0.02..=2.0).logarithmic(true).max_decimals(2).suffix(" ×"));
            ui.separator();
            ui.label(RichText::new("threads").color(style::FAINT));
            let mut threads = app.session.threads();
            let most = std::thread::available_parallelism().map_or(1, usize::from);
            if ui.add(egui::DragValue::new(&mut threads).range(1..=most)).changed() {
                app.session.set_threads(threads);
            }
            ui.separator();
            times(app, ui);
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| outcome(app, ui));
        });
    });
}

/// Shows buttons that open and close the panels of a narrow window, one at a time.
fn folds(app: &mut App, ui: &mut egui::Ui) {
    for (side, name) in [(Side::Scenes, "Scenes"), (Side::Figures, "Figures")] {
        let is_open = app.unfolded == Some(side);
        let is_there = side == Side::Figures || !app.hides_browser;
        if is_there && ui.selectable_label(is_open, name).clicked() {
            app.unfolded = if is_open { None } else { Some(side) };
        }
    }
}

fn run(app: &mut App, ui: &mut egui::Ui) {
    let label = if app.running { "Pause" } else { "Run" };
    if ui.button(label).on_hover_text("Space").clicked() {
        app.running = !app.running;
    }
    if ui.button("Step").on_hover_text("N").clicked() {
        app.running = false;
        app.step();
    }
    if ui.button("Restart").on_hover_text("R").clicked() {
        app.restart();
    }
}

fn times(app: &App, ui: &mut egui::Ui) {
    let world = app.session.world();
    ui.label(format!("{:7.2} s", world.time()));
    if !app.hides_times {
        let step = 1e3 * app.session.step_time().as_secs_f64();
        ui.label(format!("{step:.2} ms a step")).on_hover_text("wall time of the last step");
    }
    if app.running && !app.hides_times {
        ui.label(format!("{:.0} fps", 1.0 / app.frame_time.max(1e-3)));
    }
}

/// Shows buttons for help and for saving the run.
fn outcome(app: &mut App, ui: &mut egui::Ui) {
    if ui.button("?").on_hover_text("All keys").clicked() {
        app.shows_help = !app.shows_help;
    }
    if app.session.recording().is_some()
        && ui.button("Replay").on_hover_text("What was done so far, on a timeline").clicked()
    {
        app.replay();
    }
    if app.session.workbench().is_some()
        && ui.button("Save GLB").on_hover_text("What was just played, as a clip in the file").clicked()
    {
        app.save_glb();
    }
    if app.session.recording().is_some()
        && ui.button("Save recording").on_hover_text("The operations and the resulting states").clicked()
    {
        app.save_recording();
    }
}
