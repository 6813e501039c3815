//! Interactive editing of a ragdoll: selects a body, and changes its limits and sizes by handles and keys.

use super::App;
use crate::layers::{Cone, add_cone, cone_of};
use crate::session::limits;
use crate::stage::Stage;
use egui::{Color32, Pos2, Stroke};
use sinew::math::{Range, Transform, Vec3, clamp, max, normalize_or};
use sinew::physics::ray::Ray;
use sinew::physics::{BodyId, Shape};
use sinew::ragdoll::doctor::scaled;
use sinew::ragdoll::settings::BoneSettings;
use sinew_picture::{LineDepth, draw};

/// Largest distance at which a handle can be grabbed, points.
const REACH: f32 = 11.0;
/// Change of a limit by one key press, radians (5°).
const KEY_TURN: f32 = 5.0 * core::f32::consts::PI / 180.0;
/// Widest swing to each side, radians. It is below half a turn, because the direction of such a swing is not defined.
const WIDEST: f32 = 170.0 * core::f32::consts::PI / 180.0;
/// Smallest and largest factor on a fitted shape.
pub(super) const SCALES: [f32; 2] = [0.3, 3.0];
/// Linear colour of the selection.
const CHOSEN: [f32; 3] = [1.0, 0.35, 0.05];

/// Selection and changes on the workbench.
#[derive(Clone, Debug, Default)]
pub(super) struct Bench {
    /// Selected body, by its index in the definition.
    pub chosen: Option<usize>,
    /// Changes in progress.
    pub draft: BoneSettings,
    /// Handle that the mouse holds.
    held: Option<Handle>,
}

/// Handle in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Handle {
    /// End of a range: the index of the range (0: swing about y, 1: swing about z, 2: hinge), and true for its upper
    /// end.
    Limit(usize, bool),
    /// Side of the shape. The numbers are the shape's scale factor and its radius (metres) when the handle was grabbed.
    Size(f32, f32),
}

impl Bench {
    pub fn is_busy(&self) -> bool {
        self.held.is_some()
    }
}

/// Returns the selected body: its index in the definition, and its id in the world.
fn body_of(app: &App) -> Option<(usize, BodyId)> {
    let chosen = app.bench.chosen?;
    Some((chosen, *app.session.ragdoll().get(chosen)?))
}

/// Selects a body by its index in the definition, or none.
pub(super) fn choose(app: &mut App, body: Option<usize>) {
    let Some(workbench) = app.session.workbench() else { return };
    let body = body.filter(|&body| body < workbench.def().bodies.len());
    let draft = body.map(|body| workbench.wish(body)).unwrap_or_default();
    let line = body.map(|body| {
        let body = &workbench.def().bodies[body];
        format!("chose {} ({}), {:.2} kg", body.role, body.bone, body.mass.mass)
    });
    app.bench = Bench { chosen: body, draft, held: None };
    if let Some(line) = line {
        app.tell(line);
    }
}

/// Selects the next or the previous body of the ragdoll.
pub(super) fn choose_next(app: &mut App, by: isize) {
    let Some(count) = app.session.workbench().map(|it| it.def().bodies.len()) else { return };
    let next = match app.bench.chosen {
        Some(at) => (at as isize + by).rem_euclid(count as isize) as usize,
        None if by > 0 => 0,
        None => count - 1,
    };
    choose(app, Some(next));
}

/// Selects the body at a point, or nothing if the body does not belong to the ragdoll.
pub(super) fn pick(app: &mut App, body: Option<BodyId>) {
    let found = app.session.ragdoll().iter().position(|&it| Some(it) == body);
    if found.is_some() || app.bench.chosen.is_some() {
        choose(app, found);
    }
}

/// Applies the draft: rebuilds the ragdoll and drops it again.
pub(super) fn commit(app: &mut App) {
    let Some(chosen) = app.bench.chosen else { return };
    let draft = app.bench.draft;
    if app.session.workbench().is_none_or(|workbench| workbench.wish(chosen) == draft) {
        return;
    }
    let line = match app.session.edit(chosen, draft) {
        Ok(()) => {
            app.begin_again();
            let workbench = app.session.workbench();
            let body = workbench.map(|it| (&it.def().bodies[chosen], it.findings().len()));
            body.map_or_else(String::new, |(body, findings)| {
                format!("made {} anew: {:.2} kg; {findings} findings", body.role, body.mass.mass)
            })
        }
        Err(line) => {
            let wish = app.session.workbench().map(|workbench| workbench.wish(chosen));
            app.bench.draft = wish.unwrap_or_default();
            line
        }
    };
    app.tell(line);
}

/// Returns the ranges of the selected body's joint, with the changes in progress, radians.
pub(super) fn ranges(app: &App) -> [Option<Range>; 3] {
    let joint = app
        .bench
        .chosen
        .and_then(|chosen| app.session.workbench()?.def().joints.iter().find(|joint| joint.child == chosen));
    let [y, z, twist] = joint.map(|joint| limits(&joint.kind)).unwrap_or_default();
    let draft = &app.bench.draft;
    [
        y.map(|it| draft.swing_y.unwrap_or(it)),
        z.map(|it| draft.swing_z.unwrap_or(it)),
        twist.map(|it| draft.twist.unwrap_or(it)),
    ]
}

/// Sets a range of the draft, radians.
pub(super) fn set_range(app: &mut App, axis: usize, range: Range) {
    let draft = &mut app.bench.draft;
    *[&mut draft.swing_y, &mut draft.swing_z, &mut draft.twist][axis] = Some(range);
}

/// Widens or narrows all ranges of the selected joint by one key step.
pub(super) fn widen(app: &mut App, sign: f32) {
    let ranges = ranges(app);
    if ranges == [None; 3] {
        if app.session.workbench().is_some() {
            app.tell("choose a body with a limited joint: [ and ], or a click");
        }
        return;
    }
    for (axis, range) in ranges.into_iter().enumerate() {
        let Some(Range { lo, hi }) = range else { continue };
        let by = sign * KEY_TURN;
        let (lo, hi) = if axis < 2 {
            (clamp(lo - by, -WIDEST, 0.0), clamp(hi + by, 0.0, WIDEST))
        } else {
            let middle = 0.5 * (lo + hi);
            (clamp(lo - by, -WIDEST, max(middle, -WIDEST)), clamp(hi + by, middle, WIDEST))
        };
        set_range(app, axis, Range::new(lo, hi));
    }
    commit(app);
    tell_limits(app);
}

fn tell_limits(app: &mut App) {
    let names = ["swing y", "swing z", "twist"];
    let told = names.into_iter().zip(ranges(app)).filter_map(|(name, range)| {
        let Range { lo, hi } = range?;
        Some(format!("{name} {:.0} to {:.0}°", lo.to_degrees(), hi.to_degrees()))
    });
    let told: Vec<String> = told.collect();
    let role = app.bench.chosen.and_then(|chosen| Some(&app.session.workbench()?.def().bodies[chosen].role));
    let line = format!("limits of {}: {}", role.map_or("", String::as_str), told.join(", "));
    app.tell(line);
}

/// Exports the ragdoll as a file, for the host to write.
pub(super) fn save(app: &mut App) {
    match app.session.workbench().map(crate::session::Workbench::to_file) {
        Some(file) => app.files.push(file),
        None => app.tell("only ragdolls of files can be saved"),
    }
}

/// Points the camera at the selected body.
pub(super) fn look_at_chosen(app: &mut App) {
    let Some((_, body)) = body_of(app) else { return };
    let world = app.session.world();
    let bounds = world.bounds(body);
    let size = (bounds.max - bounds.min).length();
    app.orbit.target = world.center_of_mass(body);
    app.orbit.distance = clamp(4.0 * size, 0.3, max(app.orbit.distance, 0.3));
}

/// Returns the limits of the selected joint, with the changes in progress.
fn cone(app: &App) -> Option<Cone> {
    let (_, body) = body_of(app)?;
    let world = app.session.world();
    // The joint to the parent has the body as its second one.
    let mut joints = world.joints_of(body).map(|id| world.joint(id));
    let joint = joints.find(|joint| joint.body_b == body)?;
    let cone = cone_of(world, &joint)?;
    Some(Cone { ranges: ranges(app), ..cone })
}

/// Returns, for the selected body, the transform from shape to world, the shape, and its radius, metres.
fn shape(app: &App) -> Option<(Transform, Shape, f32)> {
    let (_, body) = body_of(app)?;
    let (shape, place) = app.session.world().shapes(body).next()?;
    let radius = match shape {
        Shape::Box { half_extents } => half_extents.x,
        Shape::Capsule { radius, .. } | Shape::Sphere { radius } => radius,
        Shape::TaperedCapsule { radius_bottom, radius_top, .. } => 0.5 * (radius_bottom + radius_top),
        _ => shape.bounding_radius(),
    };
    Some((place, shape, radius))
}

/// Returns the handles of the selection, each with its position in the world.
fn handles(app: &App) -> Vec<(Handle, Vec3)> {
    let mut list = Vec::new();
    if let Some(cone) = cone(app) {
        let axes = if cone.is_hinge { 2..3 } else { 0..2 };
        for axis in axes {
            let Some(Range { lo, hi }) = cone.ranges[axis] else { continue };
            for (is_upper, angle) in [(false, lo), (true, hi)] {
                list.push((Handle::Limit(axis, is_upper), cone.handle(axis, angle)));
            }
        }
    }
    if let Some((place, _, radius)) = shape(app)
        && app.session.workbench().is_some_and(crate::session::Workbench::has_rig)
    {
        let scale = app.bench.draft.scale.unwrap_or(1.0);
        let was = app.session.workbench().zip(app.bench.chosen).and_then(|(it, body)| it.wish(body).scale);
        let drawn = radius * scale / was.unwrap_or(1.0);
        list.push((Handle::Size(scale, drawn), place.point(Vec3::X * drawn)));
    }
    list
}

impl App {
    /// Returns the handles of the ragdoll's selected body, each with its name and position in the window,
    /// points.
    pub fn handles(&self) -> Vec<(&'static str, Pos2)> {
        let name = |handle: &Handle| match handle {
            Handle::Limit(axis, upper) => [
                ["swing y low", "swing y high"],
                ["swing z low", "swing z high"],
                ["hinge low", "hinge high"],
            ][*axis][usize::from(*upper)],
            Handle::Size(..) => "size",
        };
        let list = handles(self);
        list.iter().filter_map(|(handle, at)| Some((name(handle), self.on_screen(*at)?))).collect()
    }
}

/// Grabs the handle at a point of the window; returns false if there is none.
pub(super) fn take(app: &mut App, at: Pos2) -> bool {
    let near = handles(app).into_iter().filter_map(|(handle, point)| {
        let distance = (app.on_screen(point)? - at).length();
        (distance < REACH).then_some((handle, distance))
    });
    let nearest = near.min_by(|a, b| a.1.total_cmp(&b.1)).map(|it| it.0);
    app.bench.held = nearest;
    nearest.is_some()
}

/// Drags the grabbed handle to the point of its path that is nearest to a ray.
pub(super) fn drag(app: &mut App, ray: &Ray) {
    match app.bench.held {
        Some(Handle::Limit(axis, is_upper)) => {
            let (Some(cone), Some(range)) = (cone(app), ranges(app)[axis]) else { return };
            let Some(angle) = angle_of(&cone, axis, ray) else { return };
            let Range { mut lo, mut hi } = range;
            let (least, most) = if axis < 2 { (0.0, 0.0) } else { (lo, hi) };
            if is_upper {
                hi = clamp(angle, least, WIDEST);
            } else {
                lo = clamp(angle, -WIDEST, most);
            }
            set_range(app, axis, Range::new(lo, hi));
        }
        Some(Handle::Size(scale, radius)) => {
            let Some((place, ..)) = shape(app) else { return };
            let across = place.rotation * Vec3::X;
            let along = along_line(place.translation, across, ray);
            let [least, most] = SCALES;
            app.bench.draft.scale = Some(clamp(scale * along / max(radius, 1e-4), least, most));
        }
        None => {}
    }
}

/// Releases the handle and applies its changes.
pub(super) fn release(app: &mut App) {
    let held = app.bench.held.take();
    commit(app);
    if matches!(held, Some(Handle::Limit(..))) {
        tell_limits(app);
    }
}

/// Returns the angle of a range at the point that a ray meets, radians.
fn angle_of(cone: &Cone, axis: usize, ray: &Ray) -> Option<f32> {
    use sinew::math::trig::atan2;
    let local = cone.frame.inverse();
    let (origin, way) = (local.point(ray.origin), local.rotation * ray.direction);
    let way = normalize_or(way, Vec3::X);
    let normal = [Vec3::Y, Vec3::Z, Vec3::X][axis];
    let slope = way.dot(normal);
    let point = if slope.abs() > 0.1 {
        origin - way * (origin.dot(normal) / slope)
    } else {
        // For an edge-on view, use the point nearest to the joint.
        origin - way * origin.dot(way)
    };
    let angle = match axis {
        0 => atan2(-point.z, point.x),
        1 => atan2(point.y, point.x),
        _ => atan2(point.z, point.y),
    };
    angle.is_finite().then_some(angle)
}

/// Returns the position on a line, metres from its origin, nearest to a ray.
fn along_line(origin: Vec3, way: Vec3, ray: &Ray) -> f32 {
    let eye = normalize_or(ray.direction, Vec3::Z);
    let between = ray.origin - origin;
    let cos = way.dot(eye);
    (between.dot(way) - between.dot(eye) * cos) / max(1.0 - cos * cos, 1e-4)
}

/// Draws the selection: its outline and its limits.
pub(super) fn draw(app: &App, stage: &mut Stage<'_>) {
    if let Some((place, mut shape, radius)) = shape(app) {
        if let Some((Handle::Size(_, drawn), _)) = handles(app).last() {
            shape = scaled(&shape, drawn / max(radius, 1e-6));
        }
        stage.scene.lines.extend(draw::wire(&shape, place, CHOSEN, LineDepth::OnTop));
    }
    if let Some(cone) = cone(app) {
        add_cone(&cone, Some([0.95, 0.55, 0.05]), &mut stage.scene.lines);
    }
}

/// Draws the handles over the picture.
pub(super) fn overlay(app: &App, ui: &egui::Ui) {
    for (handle, point) in handles(app) {
        let Some(at) = app.on_screen(point).filter(|at| app.area.contains(*at)) else { continue };
        let is_held = app.bench.held.is_some_and(|held| match (held, handle) {
            (Handle::Size(..), Handle::Size(..)) => true,
            (held, handle) => held == handle,
        });
        let fill = match handle {
            Handle::Limit(..) => Color32::from_rgb(255, 170, 40),
            Handle::Size(..) => Color32::from_rgb(255, 110, 60),
        };
        let radius = if is_held { 7.0 } else { 5.0 };
        ui.painter().circle(at, radius, fill, Stroke::new(1.5, Color32::from_black_alpha(200)));
    }
}
