//! The part of the right panel that shows and edits a ragdoll.

use super::{App, bench, style};
use crate::session::limits;
use egui::{ComboBox, DragValue, RichText, Slider};
use sinew::anim::roles::HUMANOID_ROLES;
use sinew::math::Range;
use sinew::physics::Shape;
use sinew::ragdoll::doctor::Severity;
use sinew::ragdoll::settings::ShapeWish;

/// Names of the ranges of a joint.
const RANGES: [&str; 3] = ["swing y", "swing z", "twist"];

/// Lists the doctor's findings; a click selects the body and points the camera at it.
pub(super) fn findings(app: &mut App, ui: &mut egui::Ui) {
    let Some(workbench) = app.session.workbench() else { return };
    let findings = workbench.findings().to_vec();
    if findings.is_empty() {
        ui.label(RichText::new("The doctor finds nothing wrong.").color(style::GOOD));
    }
    for finding in &findings {
        let color = match finding.severity {
            Severity::Error => style::BAD,
            _ => style::FAINT,
        };
        let title = format!("{}: {}", finding.code.name(), finding.bones.join(", "));
        let hover = format!("{}\n\n{}", finding.evidence, finding.fix);
        let shown = ui.selectable_label(false, RichText::new(title).color(color)).on_hover_text(hover);
        if shown.clicked() {
            bench::choose(app, finding.bodies.first().copied());
            bench::look_at_chosen(app);
            app.tell(finding.evidence.clone());
        }
    }
}

/// Lists the bodies of the ragdoll, and the settings of the selected one.
pub(super) fn show(app: &mut App, ui: &mut egui::Ui) {
    let Some(workbench) = app.session.workbench() else { return };
    let names: Vec<String> = workbench.def().bodies.iter().map(|body| body.role.clone()).collect();
    let file = workbench.to_file_name();
    let shown = app.bench.chosen.map_or("choose a body", |chosen| &names[chosen]);
    let mut chosen = app.bench.chosen;
    ui.horizontal(|ui| {
        ComboBox::from_id_salt("body").selected_text(shown).width(150.0).height(320.0).show_ui(ui, |ui| {
            for (body, name) in names.iter().enumerate() {
                ui.selectable_value(&mut chosen, Some(body), name);
            }
        });
        if ui.button("Look").on_hover_text("turn the camera to it").clicked() {
            bench::look_at_chosen(app);
        }
    });
    if chosen != app.bench.chosen {
        bench::choose(app, chosen);
    }
    if let Some(chosen) = chosen {
        let is_done = fields(app, ui, chosen);
        if is_done {
            bench::commit(app);
        }
    } else {
        let hint = "A click on a body of the ragdoll chooses it, [ and ] the next one.";
        ui.label(RichText::new(hint).small().color(style::FAINT));
    }
    if ui.button(format!("Save {file}")).on_hover_text("Ctrl+S").clicked() {
        bench::save(app);
    }
}

/// Shows the fields of a body; returns true if a change is to be applied now.
fn fields(app: &mut App, ui: &mut egui::Ui, chosen: usize) -> bool {
    let Some(workbench) = app.session.workbench() else { return false };
    let (body, has_rig) = (workbench.def().bodies[chosen].clone(), workbench.has_rig());
    let joint = workbench.def().joints.iter().find(|joint| joint.child == chosen).copied();
    ui.label(RichText::new(format!("bone {}", body.bone)).small().color(style::FAINT));
    let mut is_done = false;
    if has_rig {
        is_done |= role(app, ui, &body.role);
        is_done |= shape(app, ui, &body.shape);
    }
    let draft = &mut app.bench.draft;
    row(ui, "mass", |ui| {
        let mut mass = draft.mass.unwrap_or(body.mass.mass);
        let field =
            ui.add(DragValue::new(&mut mass).range(0.01..=1000.0).speed(0.05).suffix(" kg").max_decimals(2));
        if field.changed() {
            draft.mass = Some(mass);
        }
        is_done |= finished(&field);
    });
    if let Some(joint) = joint {
        row(ui, "friction", |ui| {
            let mut torque = draft.friction_torque.unwrap_or(joint.friction_torque);
            let field = ui.add(
                DragValue::new(&mut torque).range(0.0..=500.0).speed(0.05).suffix(" N·m").max_decimals(2),
            );
            if field.changed() {
                draft.friction_torque = Some(torque);
            }
            is_done |= finished(&field);
        });
        for axis in 0..3 {
            if limits(&joint.kind)[axis].is_some() {
                is_done |= range(app, ui, axis);
            }
        }
    }
    is_done
}

/// Returns true if a field's value is final: the field was released or lost focus.
fn finished(field: &egui::Response) -> bool {
    field.drag_stopped() || field.lost_focus() || field.changed() && !field.dragged() && !field.has_focus()
}

fn row(ui: &mut egui::Ui, name: &str, add: impl FnOnce(&mut egui::Ui)) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(name).color(style::FAINT));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), add);
    });
}

/// Shows the lower and upper end of a range, degrees; returns true if a change is final.
fn range(app: &mut App, ui: &mut egui::Ui, axis: usize) -> bool {
    let Some(Range { lo, hi }) = bench::ranges(app)[axis] else { return false };
    let (mut low, mut high, mut is_done) = (lo.to_degrees(), hi.to_degrees(), false);
    row(ui, RANGES[axis], |ui| {
        let (lowest, highest) =
            if axis < 2 { (-170.0..=0.0, 0.0..=170.0) } else { (-175.0..=high, low..=175.0) };
        // Draws the upper end first, because the row is filled from the right.
        for (value, range) in [(&mut high, highest), (&mut low, lowest)] {
            let field = ui.add(DragValue::new(value).range(range).speed(0.5).suffix("°").max_decimals(1));
            is_done |= finished(&field);
        }
    });
    let differs = |a: f32, b: f32| (a - b).abs() > 1e-3;
    if differs(low, lo.to_degrees()) || differs(high, hi.to_degrees()) {
        bench::set_range(app, axis, Range::degrees(low, high));
    }
    is_done
}

fn role(app: &mut App, ui: &mut egui::Ui, name: &str) -> bool {
    let before = app.bench.draft.role;
    row(ui, "role", |ui| {
        ComboBox::from_id_salt("role").selected_text(name).width(130.0).height(320.0).show_ui(ui, |ui| {
            ui.selectable_value(&mut app.bench.draft.role, None, "as found");
            for role in HUMANOID_ROLES {
                ui.selectable_value(&mut app.bench.draft.role, Some(role), role.name());
            }
        });
    });
    app.bench.draft.role != before
}

fn shape(app: &mut App, ui: &mut egui::Ui, shape: &Shape) -> bool {
    let (before, mut is_done) = (app.bench.draft.shape, false);
    let name = match shape {
        Shape::Box { .. } => "box",
        Shape::Capsule { .. } | Shape::TaperedCapsule { .. } => "capsule",
        Shape::Sphere { .. } => "sphere",
        _ => "other",
    };
    row(ui, "shape", |ui| {
        ComboBox::from_id_salt("shape").selected_text(name).width(130.0).show_ui(ui, |ui| {
            let wishes = [
                (None, "as fits better"),
                (Some(ShapeWish::Box), "box"),
                (Some(ShapeWish::Capsule), "capsule"),
                (Some(ShapeWish::Sphere), "sphere"),
            ];
            for (wish, name) in wishes {
                ui.selectable_value(&mut app.bench.draft.shape, wish, name);
            }
        });
    });
    row(ui, "size", |ui| {
        let mut scale = app.bench.draft.scale.unwrap_or(1.0);
        let [least, most] = bench::SCALES;
        ui.spacing_mut().slider_width = 110.0;
        let field =
            ui.add(Slider::new(&mut scale, least..=most).logarithmic(true).max_decimals(2).suffix(" ×"));
        if field.changed() {
            app.bench.draft.scale = Some(scale);
        }
        is_done |= finished(&field);
    });
    is_done || app.bench.draft.shape != before
}
