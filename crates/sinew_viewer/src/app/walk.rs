//! Keys that control a character.

use super::App;
use sinew::math::{Vec3, normalize_or};
use sinew_scenes::recording::Operation;

/// Speeds of a walk and of a run, m/s.
const SPEEDS: [f32; 2] = [1.4, 3.2];
/// Height of the camera's target above the soles, metres.
const EYES: f32 = 1.1;

/// Switches the keys between the scene's character and the camera.
pub(super) fn toggle(app: &mut App) {
    let place = app.session.instance().steered().filter(|_| app.session.is_live());
    match (app.leads, place) {
        (None, Some(place)) => {
            app.leads = Some(Vec3::ZERO);
            app.orbit.target = place + Vec3::Y * EYES;
            app.orbit.distance = app.orbit.distance.min(6.0);
            app.follows = None;
            app.running = true;
            app.tell("W A S D walk, with Shift they run; G ends it");
        }
        (None, None) => app.tell("no character here can be steered"),
        (Some(_), _) => {
            app.session.apply(Operation::Steer { way: Vec3::ZERO });
            app.leads = None;
            app.follow(app.session.subject().is_staged() || app.session.workbench().is_some());
            app.tell("the keys move the camera again");
        }
    }
}

/// Moves the character to the right and ahead, relative to the camera.
pub(super) fn lead(app: &mut App, right: f32, ahead: f32, fast: bool) {
    let axes = app.camera().axes(1.0);
    let level = |v: Vec3| normalize_or(Vec3::new(v.x, 0.0, v.z), Vec3::ZERO);
    let way = level(axes.right) * right + level(axes.forward) * ahead;
    let way = normalize_or(way, Vec3::ZERO) * SPEEDS[usize::from(fast)];
    if app.leads != Some(way) {
        app.leads = Some(way);
        app.session.apply(Operation::Steer { way });
    }
    if let Some(place) = app.session.instance().steered() {
        app.orbit.target = place + Vec3::Y * EYES;
    }
}
