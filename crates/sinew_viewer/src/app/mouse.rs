//! Mouse input in the picture: grab, pull, throw; rotate, pan and zoom the camera.

use super::{App, bench};
use egui::{CursorIcon, PointerButton, Pos2, Sense};
use sinew::math::{Vec3, min, normalize_or};
use sinew::physics::ray::Ray;
use sinew::physics::{BodyHit, BodyId, BodyKind, BodyKinds, QueryFilter};
use sinew_scenes::recording::Operation;

/// Radius of a thrown ball, metres.
const BALL: f32 = 0.12;
/// Density of a thrown ball, that of water, kg/m³: the ball weighs 7 kg.
const DENSITY: f32 = 1000.0;
/// Speed of a thrown ball, m/s.
const THROW: f32 = 14.0;
/// Rotation of the camera per point of mouse motion, radians.
const TURN: f32 = 0.0065;

/// Impulse of a push, N·s (a shove with both hands that makes a man fall), and the largest speed that a push gives to a
/// light body, m/s.
const SHOVE: f32 = 130.0;
const SHOVE_SPEED: f32 = 6.0;
/// Factor from the slope of the view to the slope of a push; small, so that pushes go along the ground.
const LIFT: f32 = 0.3;
/// Distance beside a character at which a push still reaches it, as a share of the camera's distance.
const FINGER: f32 = 0.06;

/// State of the mouse.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Mouse {
    /// Distance of the grabbed point from the camera along the viewing direction, metres.
    held: Option<f32>,
}

impl Mouse {
    pub fn is_busy(self) -> bool {
        self.held.is_some()
    }
}

/// Handles mouse input in the picture.
pub(super) fn act(app: &mut App, ui: &mut egui::Ui) {
    let response = ui.allocate_rect(app.area, Sense::click_and_drag());
    if response.drag_started_by(PointerButton::Primary)
        && let Some(at) = ui.input(|input| input.pointer.press_origin())
        && !bench::take(app, at)
    {
        grab(app, at);
    }
    if app.bench.is_busy() {
        if let Some(at) = response.interact_pointer_pos() {
            bench::drag(app, &ray(app, at));
        }
        if !ui.input(|input| input.pointer.primary_down()) {
            bench::release(app);
        }
    }
    if response.clicked_by(PointerButton::Primary)
        && app.session.workbench().is_some()
        && let Some(at) = response.interact_pointer_pos()
    {
        let body = body_at(app, &ray(app, at)).map(|hit| hit.body);
        bench::pick(app, body);
    } else if response.clicked_by(PointerButton::Primary)
        && (app.hides_panels || app.session.subject().is_staged())
        && let Some(at) = response.interact_pointer_pos()
    {
        push(app, at);
    }
    if let (Some(depth), Some(at)) = (app.mouse.held, response.interact_pointer_pos()) {
        let to = at_depth(app, &ray(app, at), depth);
        app.session.apply(Operation::Lead { to });
    }
    if app.mouse.held.is_some() && !ui.input(|input| input.pointer.primary_down()) {
        app.mouse.held = None;
        app.session.apply(Operation::Release);
        app.tell("let go");
    }
    let shift = ui.input(|input| input.modifiers.shift);
    let turns =
        response.dragged_by(PointerButton::Primary) && app.mouse.held.is_none() && !app.bench.is_busy()
            || response.dragged_by(PointerButton::Secondary);
    let delta = response.drag_delta();
    if response.dragged_by(PointerButton::Middle) || turns && shift {
        let by = 1.0 / app.area.height().max(1.0);
        app.orbit.shift(Vec3::new(-delta.x * by, delta.y * by, 0.0));
    } else if turns {
        app.orbit.turn(-delta.x * TURN, delta.y * TURN);
    }
    if response.hovered() || app.mouse.is_busy() {
        show_grip(app, ui);
    }
    // A page scrolls by the wheel.
    if response.hovered() && !app.hides_panels {
        let scroll = ui.input(|input| input.smooth_scroll_delta.y);
        if scroll != 0.0 {
            app.orbit.zoom((-0.0022 * scroll).exp2());
        }
    }
}

/// Sets the cursor that shows whether a drag would pull the body below it.
fn show_grip(app: &App, ui: &egui::Ui) {
    if !app.session.is_live() || app.bench.is_busy() {
        return;
    }
    let at = ui.input(|input| input.pointer.hover_pos());
    let below = at.and_then(|at| body_at(app, &ray(app, at)));
    let world = app.session.world();
    if app.mouse.is_busy() {
        ui.ctx().set_cursor_icon(CursorIcon::Grabbing);
    } else if below.is_some_and(|hit| world.kind(hit.body) == BodyKind::Dynamic) {
        ui.ctx().set_cursor_icon(CursorIcon::Grab);
    }
}

/// Pushes the body at a point of the picture away from the camera.
fn push(app: &mut App, at: Pos2) {
    let ray = ray(app, at);
    let Some((body, point)) = pushed(app, &ray) else { return };
    let way = ray.direction * Vec3::new(1.0, LIFT, 1.0);
    let mass = app.session.world().mass(body).mass;
    let is_led = app.session.world().kind(body) == BodyKind::Kinematic;
    let size = if is_led { SHOVE } else { min(SHOVE, SHOVE_SPEED * mass) };
    app.shows_hints = false;
    app.session.apply(Operation::Push { body, impulse: normalize_or(way, Vec3::Z) * size, point });
    app.tell("pushed");
}

/// Pushes the subject away from the camera.
pub(super) fn push_subject(app: &mut App) {
    push(app, subject(app));
}

/// Returns the position of the subject in the window, points; the centre of the picture if the subject is out of sight.
fn subject(app: &App) -> Pos2 {
    let place = app.subject_place().map(|[x, y]| app.area.lerp_inside(egui::vec2(x, y)));
    place.filter(|at| app.area.contains(*at)).unwrap_or(app.area.center())
}

/// Returns the body that a ray hits, and the point; if it hits none, the nearest body of a character beside the ray,
/// because a finger is wide.
fn pushed(app: &App, ray: &Ray) -> Option<(BodyId, Vec3)> {
    let world = app.session.world();
    let of_figures = app.session.instance().bodies_of_figures();
    let all = QueryFilter::of(BodyKinds::DYNAMIC | BodyKinds::KINEMATIC | BodyKinds::STATIC);
    let hit = world.query().filter(all).first(ray);
    if let Some(hit) = hit
        && (world.kind(hit.body) == BodyKind::Dynamic || of_figures.contains(&hit.body))
    {
        return Some((hit.body, hit.point));
    }
    let way = ray.direction.normalize();
    let beside = of_figures.into_iter().map(|body| {
        let center = world.center_of_mass(body);
        let from = center - ray.origin;
        ((from - way * from.dot(way)).length(), body, center)
    });
    let nearest = beside.min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.filter(|near| near.0 < FINGER * app.orbit.distance).map(|(_, body, center)| (body, center))
}

/// Throws a ball from the camera at a point of the window, or at the subject.
pub(super) fn throw(app: &mut App, at: Option<Pos2>) {
    let ray = ray(app, at.unwrap_or_else(|| subject(app)));
    let way = ray.direction.normalize();
    // The ball scales with the world.
    let size = (app.orbit.distance / 6.0).clamp(0.2, 20.0);
    let position = ray.origin + way * (2.5 * BALL * size);
    let velocity = way * (THROW * size.sqrt());
    app.session.apply(Operation::Throw { position, velocity, radius: BALL * size, density: DENSITY });
    app.tell("threw a ball");
}

pub(super) fn ray(app: &App, at: Pos2) -> Ray {
    let (area, at) = (app.area, at - app.area.min);
    app.orbit.ray(at.x / area.width(), at.y / area.height(), area.width() / area.height())
}

/// Returns the distance of a point from the camera along the viewing direction, metres.
fn depth(app: &App, point: Vec3) -> f32 {
    let camera = app.camera();
    (point - camera.position).dot(camera.axes(1.0).forward)
}

/// Returns the point of a ray at a distance along the viewing direction.
fn at_depth(app: &App, ray: &Ray, depth: f32) -> Vec3 {
    let way = ray.direction.normalize();
    ray.origin + way * (depth / way.dot(app.camera().axes(1.0).forward).max(1e-3))
}

/// Returns the first body on a ray.
fn body_at(app: &App, ray: &Ray) -> Option<BodyHit> {
    let world = app.session.world();
    world.query().filter(QueryFilter::of(BodyKinds::DYNAMIC | BodyKinds::STATIC)).first(ray)
}

fn grab(app: &mut App, at: Pos2) {
    if !app.session.is_live() {
        return;
    }
    let Some(BodyHit { body, point, .. }) = body_at(app, &ray(app, at)) else { return };
    let world = app.session.world();
    if world.kind(body) != BodyKind::Dynamic {
        return;
    }
    app.mouse.held = Some(depth(app, point));
    app.shows_hints = false;
    app.session.apply(Operation::Grab { body, point });
    app.tell(format!("holds body {} at {:.2} {:.2} {:.2}", body.to_bits() as u32, point.x, point.y, point.z));
}
