//! Buttons for a character: clips, hits, drives, getting up, walking.

use super::style;
use egui::{ComboBox, RichText};
use sinew::ragdoll::{Character, State};
use sinew_scenes::scenes::Act;

/// Button that a user has pressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pressed {
    Hit,
    Walk,
    Act(Act),
}

/// Returns the message for an instruction that the character executes.
pub(super) fn told(act: Act, character: &Character) -> String {
    match act {
        Act::Play(clip) => {
            let clips = &character.def().motions().clips;
            format!("plays {}", clips.get(clip as usize).map_or("", |clip| &clip.name))
        }
        Act::Limp => "goes limp".to_owned(),
        Act::Powered => "moves by its muscles".to_owned(),
        Act::GetUp => "gets up".to_owned(),
    }
}

fn state(character: &Character) -> &'static str {
    match character.state() {
        State::Animated => "follows its clips",
        State::Flinching => "flinches",
        State::Powered => "moves by its muscles",
        State::Limp => "is down",
        State::Preparing => "is about to get up",
        State::GettingUp => "gets up",
    }
}

/// Shows the buttons; returns the one that was pressed. `leads` is true while keys walk the character.
pub(super) fn show(character: &Character, leads: bool, ui: &mut egui::Ui) -> Option<Pressed> {
    let mut pressed = None;
    ui.label(RichText::new(state(character)).color(style::FAINT));
    ui.horizontal_wrapped(|ui| {
        let buttons = [
            ("Hit", Pressed::Hit, "Pushes it away from the camera"),
            ("Limp", Pressed::Act(Act::Limp), "Falls without muscles"),
            ("Powered", Pressed::Act(Act::Powered), "Its muscles follow its clips and keep its balance"),
            ("Get up", Pressed::Act(Act::GetUp), "Gets up and follows its clips"),
        ];
        for (name, what, about) in buttons {
            if ui.button(name).on_hover_text(about).clicked() {
                pressed = Some(what);
            }
        }
        if ui
            .add(egui::Button::selectable(leads, "Walk").frame_when_inactive(true))
            .on_hover_text("W A S D walk, with Shift run (G)")
            .clicked()
        {
            pressed = Some(Pressed::Walk);
        }
    });
    let clips = &character.def().motions().clips;
    if clips.is_empty() {
        return pressed;
    }
    ComboBox::from_id_salt("clips").selected_text("Play clip").width(ui.available_width()).show_ui(
        ui,
        |ui| {
            for (index, clip) in clips.iter().enumerate() {
                if ui.selectable_label(false, &clip.name).clicked() {
                    pressed = Some(Pressed::Act(Act::Play(index as u32)));
                }
            }
        },
    );
    pressed
}
