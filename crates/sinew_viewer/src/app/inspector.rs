//! The right panel: the scene's description, settings, metrics, layers, stage times and state.

use super::names::{plain, value};
use super::{App, actor, editor, solver, style, timeline};
use crate::layers::Layer;
use crate::session::Subject;
use crate::stage_times::STAGES;
use egui::{Color32, RichText, ScrollArea, Sense, Slider, Stroke};
use sinew_picture::draw;
use sinew_scenes::scenes::{Domain, Expected, Metric};
use std::collections::VecDeque;

/// Width of the panel, points.
const WIDTH: f32 = 290.0;

/// Number of lines of a report that are visible without a click; they show sizes and counts.
const FIRST_LINES: usize = 2;

/// Shows the right panel.
pub(super) fn show(app: &mut App, ui: &mut egui::Ui) {
    let panel = egui::Panel::right("inspector").resizable(true).default_size(WIDTH).frame(style::panel());
    panel.show(ui, |ui| {
        ScrollArea::vertical().auto_shrink([false; 2]).show(ui, |ui| {
            ui.heading(app.session.subject().title().replace('_', " "));
            ui.label(RichText::new(app.session.subject().about()).color(style::FAINT));
            ui.add_space(6.0);
            settings(app, ui);
            character(app, ui);
            report(app, ui);
            if app.session.workbench().is_some() {
                section(ui, "Ragdoll", true, |ui| editor::show(app, ui));
                section(ui, "Findings", true, |ui| editor::findings(app, ui));
            }
            if app.session.ghost().is_some() {
                section(ui, "Second run", true, |ui| timeline::ghost(app, ui));
            }
            section(ui, "Figures", true, |ui| figures(app, ui));
            if app.session.is_live() {
                section(ui, "Solver", false, |ui| solver::show(&mut app.session, ui));
            }
            section(ui, "Layers", true, |ui| layers(app, ui));
            if !app.hides_times {
                section(ui, "Time by stage", true, |ui| stages(app, ui));
            }
            section(ui, "State", true, |ui| state(app, ui));
        });
    });
}

/// Shows buttons for the character of the scene, if it has one.
fn character(app: &mut App, ui: &mut egui::Ui) {
    let mut pressed = None;
    if let Some(character) = app.session.instance().directed().filter(|_| app.session.is_live()) {
        let leads = app.leads.is_some();
        section(ui, "Character", true, |ui| pressed = actor::show(character, leads, ui));
    }
    if let Some(pressed) = pressed {
        app.press(pressed);
    }
}

/// Shows the first lines of the report; the others are folded.
fn report(app: &App, ui: &mut egui::Ui) {
    let lines = app.session.report();
    let (first, others) = lines.split_at(lines.len().min(FIRST_LINES));
    let show = |ui: &mut egui::Ui, lines: &[String]| {
        lines.iter().for_each(|line| {
            ui.label(line);
        });
    };
    if !first.is_empty() {
        section(ui, "Report", true, |ui| show(ui, first));
    }
    if !others.is_empty() {
        section(ui, &format!("{} details", others.len()), false, |ui| show(ui, others));
    }
}

fn section(ui: &mut egui::Ui, title: &str, open: bool, add: impl FnOnce(&mut egui::Ui)) {
    egui::CollapsingHeader::new(RichText::new(title).strong()).default_open(open).show(ui, add);
}

/// Shows sliders of the scene's settings, and a button to restart it with them.
fn settings(app: &mut App, ui: &mut egui::Ui) {
    let Subject::Scene(scene, current, _) = app.session.subject().clone() else { return };
    let declared = scene.settings().declared();
    if declared.is_empty() {
        return;
    }
    let mut starts = false;
    section(ui, "Settings", true, |ui| {
        for setting in declared {
            let Some((_, value)) = app.sliders.iter_mut().find(|(key, _)| *key == setting.key) else {
                continue;
            };
            ui.label(
                RichText::new(format!("{}: {}", setting.key, setting.about)).small().color(style::FAINT),
            );
            ui.spacing_mut().slider_width = 170.0;
            starts |= match setting.domain {
                Domain::Number(lo, hi) => ui.add(Slider::new(value, lo..=hi)).drag_stopped(),
                Domain::Whole(lo, hi) => {
                    ui.add(Slider::new(value, f32::from(lo)..=f32::from(hi)).integer()).drag_stopped()
                }
                _ => {
                    ui.label(RichText::new("a file: give it by --set").small());
                    false
                }
            };
        }
        let differs = app.sliders.iter().any(|&(key, value)| current.get(key).to_bits() != value.to_bits());
        ui.horizontal(|ui| {
            starts |= differs && ui.button("Start with these").clicked();
            let about = "The present settings run beside the next ones, in green";
            if ui.selectable_label(app.pinned.is_some(), "Compare").on_hover_text(about).clicked() {
                let pinned = app.pinned.is_none().then(|| app.session.subject().clone());
                app.pinned = pinned;
            }
        });
    });
    if starts {
        let numbers =
            declared.iter().filter(|it| matches!(it.domain, Domain::Number(..) | Domain::Whole(..)));
        let value = |key: &str| app.sliders.iter().find(|(it, _)| *it == key).map(|it| it.1);
        let changed = numbers
            .filter_map(|it| Some((it, value(it.key)?)))
            .filter(|(it, value)| it.default.to_bits() != value.to_bits());
        let assignments: Vec<String> = changed.map(|(it, value)| format!("{}={value}", it.key)).collect();
        match Subject::scene(scene.name, &assignments) {
            Ok(subject) => app.open_with_settings(subject),
            Err(line) => app.tell(line),
        }
    }
}

/// Shows the names of the curves that a scene compares, in their colours.
fn legend(app: &App, ui: &mut egui::Ui) {
    for (number, curve) in app.session.instance().curves().into_iter().enumerate() {
        let [r, g, b] = draw::curve_color(number);
        let color = egui::Rgba::from_rgb(r, g, b);
        ui.horizontal(|ui| {
            let (place, _) = ui.allocate_exact_size(egui::vec2(14.0, 10.0), Sense::hover());
            ui.painter().rect_filled(place, 2.0, Color32::from(color));
            ui.label(curve.name);
        });
    }
}

fn figures(app: &App, ui: &mut egui::Ui) {
    legend(app, ui);
    let metrics = app.session.metrics();
    let beside = app.session.twin().map(sinew_scenes::scenes::Instance::metrics).unwrap_or_default();
    // The scene's expectations apply at its end.
    let is_over = match app.session.subject() {
        Subject::Scene(scene, ..) => app.session.world().step_count() >= u64::from(scene.steps),
        _ => true,
    };
    for (index, metric) in metrics.iter().enumerate() {
        let (name, unit) = plain(metric.name);
        let shown = metric.value.map_or("not yet".to_owned(), |it| value(it, unit));
        let color = match (metric.expected, metric.is_met()) {
            (Expected::Anything, _) => style::FAINT,
            (_, true) => style::GOOD,
            (_, false) if is_over => style::BAD,
            (_, false) => style::FAINT,
        };
        ui.horizontal(|ui| {
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.label(RichText::new(shown).monospace().color(color));
                ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                    ui.add(egui::Label::new(name).truncate()).on_hover_text(metric.name);
                });
            });
        });
        let beside = beside.iter().find(|it| it.name == metric.name).and_then(|it| it.value);
        if let Some(beside) = beside {
            ui.label(RichText::new(format!("beside {}", value(beside, unit))).small().color(timeline::GHOST));
        }
        let bar = match metric.expected {
            Expected::Near { value: closed, .. } => format!("closed form {}", value(closed, unit)),
            Expected::AtMost(most) => format!("at most {}", value(most, unit)),
            Expected::Anything => String::new(),
        };
        if !bar.is_empty() {
            ui.label(RichText::new(bar).small().color(style::FAINT));
        }
        if let Some(history) = app.history.get(index) {
            plot(ui, history, metric);
        }
    }
}

/// Relative rounding error of a 32-bit value.
const ROUNDING: f64 = 1e-6;

/// Plots the history of a metric, and a line at its expected value.
fn plot(ui: &mut egui::Ui, history: &VecDeque<f64>, metric: &Metric) {
    let known: Vec<(usize, f64)> =
        history.iter().enumerate().filter(|(_, it)| it.is_finite()).map(|(i, &it)| (i, it)).collect();
    let (Some(&(first, _)), true) = (known.first(), known.len() > 1) else { return };
    let wanted = match metric.expected {
        Expected::Near { value, .. } | Expected::AtMost(value) => Some(value),
        Expected::Anything => None,
    };
    let all = || known.iter().map(|it| it.1).chain(wanted);
    let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
    // Changes within rounding count as constant.
    if high - low < ROUNDING * high.abs().max(1e-9) {
        return;
    }
    let (rect, _) = ui.allocate_exact_size(egui::vec2(ui.available_width(), 34.0), Sense::hover());
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 3.0, Color32::from_rgb(20, 22, 27));
    let inner = rect.shrink(4.0);
    let y = |value: f64| inner.bottom() - inner.height() * ((value - low) / (high - low)) as f32;
    let span = (history.len() - 1 - first).max(1) as f32;
    if let Some(wanted) = wanted {
        painter.hline(inner.x_range(), y(wanted), Stroke::new(1.0, Color32::from_rgb(110, 118, 130)));
    }
    let at = |&(i, value): &(usize, f64)| {
        egui::pos2(inner.left() + inner.width() * (i - first) as f32 / span, y(value))
    };
    painter.line(known.iter().map(at).collect(), Stroke::new(1.5, style::ACCENT));
}

fn layers(app: &mut App, ui: &mut egui::Ui) {
    for (number, layer) in Layer::ALL.into_iter().enumerate() {
        let mut on = app.layers.contains(&layer);
        let key = ["1", "2", "3", "4", "5", "6", "7", "8", "9", "0", "H"][number];
        if ui.checkbox(&mut on, format!("{key}  {}", layer.name())).changed() {
            app.toggle(layer);
        }
    }
}

fn stages(app: &App, ui: &mut egui::Ui) {
    let times = app.session.times().milliseconds();
    let total: f64 = times.iter().sum();
    let mut sorted: Vec<_> =
        STAGES.into_iter().zip(times).filter(|(_, time)| *time > 0.005 * total).collect();
    sorted.sort_by(|a, b| b.1.total_cmp(&a.1));
    if sorted.is_empty() {
        ui.label(RichText::new("no step yet").color(style::FAINT));
    }
    for (stage, time) in sorted {
        ui.horizontal(|ui| {
            ui.label(format!("{stage:?}"));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.label(RichText::new(format!("{time:.3} ms")).monospace());
                let share = (time / total) as f32;
                let (rect, _) = ui.allocate_exact_size(egui::vec2(48.0, 8.0), Sense::hover());
                ui.painter().rect_filled(rect, 2.0, Color32::from_rgb(20, 22, 27));
                let bar =
                    egui::Rect::from_min_size(rect.min, egui::vec2(rect.width() * share, rect.height()));
                ui.painter().rect_filled(bar, 2.0, style::ACCENT);
            });
        });
    }
}

fn state(app: &App, ui: &mut egui::Ui) {
    let world = app.session.world();
    let awake = world.body_ids().filter(|&id| world.is_awake(id)).count();
    let energy = world.energy();
    for (name, value) in [
        ("steps", world.step_count().to_string()),
        ("bodies", format!("{} ({awake} awake)", world.body_ids().count())),
        ("joints", world.joint_ids().count().to_string()),
        ("energy", format!("{:.4} J", energy.kinetic + energy.potential)),
        ("hash", format!("{:016x}", world.hash())),
    ] {
        ui.horizontal(|ui| {
            ui.label(name);
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.label(RichText::new(value).monospace());
            });
        });
    }
    if let Some(step) = app.session.diverged() {
        ui.label(RichText::new(format!("differs from the recording from step {step} on")).color(style::BAD));
    }
}
