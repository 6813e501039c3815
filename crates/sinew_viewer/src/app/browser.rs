//! The scenes by chapter, with a search.

use super::{App, style};
use crate::session::Subject;
use egui::{Key, RichText, ScrollArea, TextEdit};
use sinew_scenes::scenes::{Chapter, Scene, registry};

/// Width of the panel, points.
const WIDTH: f32 = 250.0;

/// Shows the list of scenes; a click opens one.
pub(super) fn show(app: &mut App, ui: &mut egui::Ui) {
    let panel = egui::Panel::left("scenes").resizable(true).default_size(WIDTH).frame(style::panel());
    panel.show(ui, |ui| {
        let search = ui.horizontal(|ui| {
            let clears = !app.search.is_empty();
            let width = ui.available_width() - if clears { 28.0 } else { 0.0 };
            let field = TextEdit::singleline(&mut app.search).hint_text("Search scenes  ( / )");
            let field = ui.add(field.desired_width(width));
            if clears && ui.button("×").on_hover_text("Clear").clicked() {
                app.search.clear();
            }
            field
        });
        let search = search.inner;
        if std::mem::take(&mut app.focuses_search) {
            search.request_focus();
        }
        let entered = search.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        let found: Vec<&'static Scene> =
            registry().iter().filter(|scene| matches(scene, &app.search)).collect();
        let mut chosen = if entered { found.first().copied() } else { None };
        let runs = app.tour.runs;
        let label = if runs {
            format!("Stop ({} of {})", app.tour.count(), registry().len())
        } else {
            "Run all scenes".to_owned()
        };
        if ui
            .small_button(label)
            .on_hover_text("Each to its end at full speed; ✔ meets its expectations")
            .clicked()
        {
            app.tour();
        }
        ui.add_space(4.0);
        ScrollArea::vertical().auto_shrink([false; 2]).show(ui, |ui| {
            chosen = list(app, ui, &found).or(chosen);
        });
        if let Some(scene) = chosen {
            choose(app, scene);
        }
    });
}

/// Returns true if each word of the search is in a scene's name, description or chapter.
fn matches(scene: &Scene, search: &str) -> bool {
    let text = format!("{} {} {}", scene.name, scene.about, scene.chapter.title()).to_lowercase();
    search.to_lowercase().split_whitespace().all(|word| text.contains(word))
}

/// Returns the chapters in the order of their first scenes.
fn chapters(found: &[&'static Scene]) -> Vec<Chapter> {
    let mut chapters: Vec<Chapter> = found.iter().map(|scene| scene.chapter).collect();
    chapters.sort_unstable();
    chapters.dedup();
    chapters
}

fn list(app: &App, ui: &mut egui::Ui, found: &[&'static Scene]) -> Option<&'static Scene> {
    let mut chosen = None;
    let current = match app.session.subject() {
        Subject::Scene(scene, ..) => Some(*scene),
        _ => None,
    };
    if found.is_empty() {
        ui.label(RichText::new("No scene has these words.").color(style::FAINT));
    }
    for chapter in chapters(found) {
        let is_open = !app.search.is_empty() || current.is_some_and(|scene| scene.chapter == chapter);
        let header = egui::CollapsingHeader::new(RichText::new(chapter.title()).strong());
        let header = header.id_salt(chapter.title()).default_open(is_open);
        let header = if app.search.is_empty() { header } else { header.open(Some(true)) };
        header.show(ui, |ui| {
            for scene in found.iter().copied().filter(|scene| scene.chapter == chapter) {
                let is_current = current.is_some_and(|it| it.name == scene.name);
                let mark = match app.tour.result(scene.name) {
                    Some(true) => "✔ ",
                    Some(false) => "✘ ",
                    None => "",
                };
                let name = format!("{mark}{}", scene.name.replace('_', " "));
                if ui.selectable_label(is_current, name).on_hover_text(scene.about).clicked() {
                    chosen = Some(scene);
                }
            }
        });
    }
    chosen
}

fn choose(app: &mut App, scene: &'static Scene) {
    match Subject::scene(scene.name, &[]) {
        Ok(subject) => {
            app.shows_hints = false;
            app.open(subject);
        }
        Err(line) => app.tell(line),
    }
}
