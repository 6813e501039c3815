//! Settings of the solver for the running scene.

use crate::session::Session;
use egui::{ComboBox, DragValue};
use sinew::math::Vec3;
use sinew::physics::{Quality, Sleeping};
use sinew_scenes::recording::Operation;

const QUALITIES: [(Quality, &str); 3] =
    [(Quality::Fast, "fast"), (Quality::Balanced, "balanced"), (Quality::Exact, "exact")];
/// Largest gravity that can be chosen, m/s².
const MOST_GRAVITY: f32 = 100.0;

/// Shows the settings; a change is an operation, which is recorded and can be undone.
pub(super) fn show(session: &mut Session, ui: &mut egui::Ui) {
    let def = session.world().def();
    let (was, gravity, substeps, dt) = (def.quality, def.gravity, def.substeps, def.dt());
    let (mut quality, mut down, mut sleeps) = (was, -gravity.y, session.may_sleep());
    ui.horizontal(|ui| {
        ui.label("Quality");
        let name = QUALITIES.iter().find(|(it, _)| *it == was).map_or("", |(_, name)| name);
        ComboBox::from_id_salt("quality").selected_text(name).show_ui(ui, |ui| {
            for (value, name) in QUALITIES {
                ui.selectable_value(&mut quality, value, name);
            }
        });
    });
    ui.horizontal(|ui| {
        ui.label("Gravity");
        let field = DragValue::new(&mut down).range(-MOST_GRAVITY..=MOST_GRAVITY).speed(0.1);
        ui.add(field.max_decimals(2).suffix(" m/s²"));
    });
    ui.checkbox(&mut sleeps, "bodies at rest fall asleep");
    let substep = 1e3 * f64::from(dt) / f64::from(substeps.max(1));
    ui.label(format!("{substeps} substeps of {substep:.2} ms"));
    if quality != was {
        session.apply(Operation::Solve { quality });
    }
    if down.to_bits() != (-gravity.y).to_bits() {
        session.apply(Operation::Gravity { gravity: Vec3::new(gravity.x, -down, gravity.z) });
    }
    if sleeps != session.may_sleep() {
        let sleeping = if sleeps { Sleeping::On } else { Sleeping::Off };
        session.apply(Operation::Sleep { sleeping });
    }
}
