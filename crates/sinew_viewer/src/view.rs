//! Converts a running scene to a stage, and moves the user's camera.

use crate::layers::{self, Layer};
use crate::session::Session;
use crate::stage::Stage;
use sinew::math::{Rotation, Vec3, clamp, max, min, normalize_or, trig};
use sinew::physics::boxes::Aabb;
use sinew::physics::ray::Ray;
use sinew::physics::{BodyKind, BodyKinds, QueryFilter, World};
use sinew_picture::world::{self, Canvas, Frame, Kinematic, Lines};
use sinew_picture::{Camera, Line, LineDepth, RenderMaterial, Scene, Sky, Sun, draw};
use sinew_scenes::scenes::Instance;

/// Smallest distance between the camera and its target, metres.
const NEAREST: f32 = 0.1;
/// Largest distance between the camera and its target, metres.
const FARTHEST: f32 = 20_000.0;
/// Steepest angle of the view up or down, radians. A camera that looks straight down has no defined heading.
const STEEPEST: f32 = 1.54;
/// Field of view, radians (45°): wider than in pictures, for interactive use.
const FOV: f32 = core::f32::consts::FRAC_PI_4;
/// Least height of the camera above the ground, as a share of its distance, so that the near plane cuts nothing off.
const CLEARANCE: f32 = 0.02;
/// Upward component of a normal from which on a surface counts as ground, not as a wall.
const LEVEL: f32 = 0.7;
/// Length of a ray from the eye, metres.
const SIGHT: f32 = 1e5;

/// Returns the bounds of a scene's subject, world space, metres.
pub fn bounds(instance: &Instance) -> Aabb {
    let mut lines = Lines::default();
    instance.draw(&mut lines);
    lines.list.append(&mut curves(instance));
    let joints = instance.figures().into_iter().flat_map(|figure| figure.world_from_joint);
    let joints = joints.map(|joint| joint.translation).map(|at| Aabb { min: at, max: at });
    let all = world::subject(instance.world()).into_iter().chain(lines.bounds()).chain(joints);
    let all = instance.camera_hint().bounds.or(all.reduce(|a, b| a.merge(&b)));
    let all = all.unwrap_or(Aabb::around(Vec3::ZERO, Vec3::ONE));
    let is_sound = all.min.is_finite() && all.max.is_finite();
    if is_sound { all } else { Aabb::around(Vec3::ZERO, Vec3::ONE) }
}

/// Returns the lines that draw the curves that a scene compares.
fn curves(instance: &Instance) -> Vec<Line> {
    let curves = instance.curves();
    draw::curves(curves.iter().map(|curve| &curve.pieces[..]))
}

/// Extends bounds to the ground below them, if the ground is close enough for a visible fall.
pub(crate) fn with_ground(bounds: &Aabb, world: &World) -> Aabb {
    let size = (bounds.max - bounds.min).length();
    let fall = max(6.0 * size, 1.0);
    let down = Ray { origin: bounds.center(), direction: Vec3::NEG_Y * fall };
    let ground = world.query().filter(QueryFilter::of(BodyKinds::STATIC)).first(&down);
    let Some(hit) = ground else { return *bounds };
    bounds.merge(&Aabb { min: hit.point, max: hit.point })
}

/// A camera that rotates around a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// Point around which the camera rotates, metres, world space.
    pub target: Vec3,
    /// Angle of the direction to the camera from +z toward +x, radians.
    pub yaw: f32,
    /// Angle of the direction to the camera above the horizontal, radians.
    pub pitch: f32,
    /// Distance from the target to the camera, metres.
    pub distance: f32,
}

impl Orbit {
    /// Returns a camera that frames bounds from `direction`, in a picture `aspect` times as wide as high.
    pub fn framing(bounds: &Aabb, direction: Vec3, aspect: f32) -> Self {
        let bounds = bounds.expand(max(0.1 * (bounds.max - bounds.min).length(), 0.05));
        let camera = Camera::framing_box(&bounds, direction, aspect);
        let way = normalize_or(direction, Vec3::Z);
        // The field of view is wider than in pictures, so the distance may be smaller.
        let nearer = trig::tan(0.5 * camera.fov_y) / trig::tan(0.5 * FOV);
        let distance = (camera.position - camera.target).length() * nearer * 1.1;
        let pitch = trig::asin(clamp(way.y, -1.0, 1.0));
        Self {
            target: camera.target,
            yaw: trig::atan2(way.x, way.z),
            pitch: clamp(pitch, -STEEPEST, STEEPEST),
            distance: clamp(distance, NEAREST, FARTHEST),
        }
    }

    /// Returns the camera.
    pub fn camera(&self) -> Camera {
        Camera { position: self.target + self.back() * self.distance, target: self.target, fov_y: FOV }
    }

    /// Returns the direction from the target to the camera, unit.
    fn back(&self) -> Vec3 {
        let (sin_yaw, cos_yaw) = trig::sin_cos(self.yaw);
        let (sin, cos) = trig::sin_cos(self.pitch);
        Vec3::new(sin_yaw * cos, sin, cos_yaw * cos)
    }

    /// Rotates the camera by angles, radians.
    pub fn turn(&mut self, yaw: f32, pitch: f32) {
        self.yaw += yaw;
        self.pitch = clamp(self.pitch + pitch, -STEEPEST, STEEPEST);
    }

    /// Moves camera and target to the right, up and forward relative to the camera, each as a multiple of their
    /// distance.
    pub fn shift(&mut self, by: Vec3) {
        let axes = self.camera().axes(1.0);
        self.target += (axes.right * by.x + axes.up * by.y + axes.forward * by.z) * self.distance;
    }

    /// Multiplies the camera's distance by a factor: below 1 is nearer.
    pub fn zoom(&mut self, factor: f32) {
        self.distance = clamp(self.distance * factor, NEAREST, FARTHEST);
    }

    /// Raises the camera if it would be in or below the ground.
    pub fn rise_above(&mut self, world: &World) {
        let way = Ray { origin: self.target, direction: self.back() * self.distance };
        let ground = world.query().filter(QueryFilter::of(BodyKinds::STATIC)).first(&way);
        if let Some(hit) = ground.filter(|hit| hit.normal.y > LEVEL) {
            let above = max(CLEARANCE * self.distance, 0.02);
            let lowest = clamp((hit.point.y + above - self.target.y) / self.distance, -1.0, 1.0);
            self.pitch = clamp(max(self.pitch, trig::asin(lowest)), -STEEPEST, STEEPEST);
        }
    }

    /// Returns the ray through a point of the picture (0 to 1, from the upper left corner), up to the far plane.
    pub fn ray(&self, x: f32, y: f32, aspect: f32) -> Ray {
        let camera = self.camera();
        let axes = camera.axes(aspect);
        let direction = axes.forward
            + axes.right * (axes.half_width * (2.0 * x - 1.0))
            + axes.up * (axes.half_height * (1.0 - 2.0 * y));
        Ray { origin: camera.position, direction: direction.normalize() * SIGHT }
    }
}

/// Returns the stage of a session in its present state.
pub fn stage<'a>(session: &'a Session, camera: &Camera, layers: &[Layer]) -> Stage<'a> {
    let instance = session.instance();
    let around = bounds(instance);
    let distance = (camera.position - camera.target).length();
    let size = 0.5 * (around.max - around.min).length();
    // Limit the size by the objects near the camera and by the content.
    let radius = clamp(distance * 0.5, 0.05, max(size, 1.0));
    let mut stage = Stage {
        scene: Scene {
            sun: Sun { shadow_radius: clamp(1.2 * distance, 1.0, max(2.0 * size, 8.0)), ..Sun::default() },
            sky: Sky { haze_distance: max(45.0, 12.0 * max(size, distance)), ..Sky::default() },
            ..Scene::default()
        },
        ..Stage::default()
    };
    let shows_skins = !layers.contains(&Layer::Bones);
    let (figures, bodies, worn) = if shows_skins {
        (instance.figures(), instance.bodies_of_figures(), instance.garments_of_figures())
    } else {
        Default::default()
    };
    let kinematic = if figures.is_empty() { Kinematic::Solid } else { Kinematic::Wire };
    world::paint_all_but(
        instance.world(),
        &bodies,
        worn,
        &Frame { center: camera.target, radius, kinematic, colors: instance.colors() },
        &mut stage,
    );
    stage.figures = figures;
    let mut lines = Lines::default();
    instance.draw(&mut lines);
    stage.scene.lines.append(&mut lines.list);
    stage.scene.lines.append(&mut curves(instance));
    stage.scene.lines.extend(session.trails().lines());
    let with_springs = if layers.contains(&Layer::Springs) { instance.figures() } else { Vec::new() };
    layers::draw(instance.world(), &with_springs, layers, &mut stage.scene.lines);
    if let Some([from, to]) = session.hands().spring(instance.world()) {
        stage.scene.lines.push(Line { from, to, color: [0.9, 0.1, 0.5], depth: LineDepth::OnTop });
        stage.ball(0.012 * distance, sinew::math::Transform::new(to, Rotation::IDENTITY), [0.9, 0.1, 0.5]);
    }
    if let Some(ghost) = session.ghost() {
        add_ghost(ghost.world(), instance.world(), &mut stage);
    }
    if let Some(twin) = session.twin() {
        add_ghost(twin.world(), instance.world(), &mut stage);
    }
    if !has_floor(session) {
        add_grid(&around, &mut stage);
    }
    stage
}

/// Least displacement and rotation with which a ghost is drawn beside the body, metres and radians.
const SEEN: f32 = 1e-3;
/// Linear colour of a ghost.
const GHOST: [f32; 3] = [0.05, 0.55, 0.50];

/// Adds the bodies of a second run that differ from those of the first.
fn add_ghost(ghost: &World, first: &World, stage: &mut Stage<'_>) {
    // Ids belong to one world, so bodies are matched by their order.
    let places: Vec<_> = first.body_ids().map(|id| first.transform(id)).collect();
    for (number, id) in ghost.body_ids().enumerate().filter(|(_, id)| ghost.kind(*id) != BodyKind::Static) {
        let place = ghost.transform(id);
        let same = places.get(number);
        let is_beside = same.is_some_and(|same| {
            (same.translation - place.translation).length() < SEEN
                && same.rotation.angle_to(place.rotation) < SEEN
        });
        if is_beside {
            continue;
        }
        for (shape, place) in ghost.shapes(id) {
            let material = RenderMaterial { opacity: 0.45, ..RenderMaterial::new(GHOST) };
            stage.scene.models.push(draw::shape(&shape, place, material));
            stage.scene.lines.extend(draw::wire(&shape, place, GHOST, LineDepth::Tested));
        }
    }
}

/// Returns true if the world has a static shape other than balls and capsules.
fn has_floor(session: &Session) -> bool {
    use sinew::physics::Shape;
    let world = session.world();
    let mut shapes =
        world.body_ids().filter(|&id| world.kind(id) == BodyKind::Static).flat_map(|id| world.shapes(id));
    shapes.any(|(shape, _)| !matches!(shape, Shape::Sphere { .. } | Shape::Capsule { .. }))
}

/// Adds a level grid below floating bodies, which shows the vertical and distances.
fn add_grid(around: &Aabb, stage: &mut Stage<'_>) {
    let size = max((around.max - around.min).max_element(), 0.5);
    let mut cell = 0.01;
    while cell * 10.0 < size {
        cell *= 10.0;
    }
    let y = around.min.y - 0.02 * size;
    let count = 10;
    let snap = |x: f32| (x / cell).round() * cell;
    let center = Vec3::new(snap(around.center().x), y, snap(around.center().z));
    let reach = cell * min((size / cell).ceil() * 1.5, count as f32);
    let reach = (reach / cell).ceil() * cell;
    let steps = (2.0 * reach / cell).round() as i32;
    for i in 0..=steps {
        let offset = i as f32 * cell - reach;
        let color = if i == steps / 2 { [0.30, 0.33, 0.37] } else { [0.48, 0.53, 0.58] };
        for (along, across) in [(Vec3::X, Vec3::Z), (Vec3::Z, Vec3::X)] {
            let middle = center + across * offset;
            let (from, to) = (middle - along * reach, middle + along * reach);
            stage.scene.lines.push(Line { from, to, color, depth: LineDepth::Tested });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew::physics::{BodyDef, Shape, WorldDef};

    #[test]
    fn camera_stays_above_the_ground() {
        let mut world = World::new(WorldDef::default());
        world.add_body(&BodyDef::fixed(Shape::HalfSpace));
        world.step();
        for (height, distance) in [(1.0, 5.0), (0.2, 40.0), (0.5, 0.3)] {
            let target = Vec3::new(0.0, height, 0.0);
            let mut orbit = Orbit { target, yaw: 0.4, pitch: 0.6, distance };
            let before = orbit;
            orbit.rise_above(&world);
            assert_eq!(orbit, before, "it is above");
            orbit.turn(0.0, -3.0);
            orbit.rise_above(&world);
            assert!(
                orbit.camera().position.y > 0.01,
                "height {height}, distance {distance}: {:?}",
                orbit.camera()
            );
        }
        // A camera whose target is below the ground is not raised.
        let mut below = Orbit { target: Vec3::NEG_Y, yaw: 0.0, pitch: -0.5, distance: 3.0 };
        let before = below;
        below.rise_above(&world);
        assert_eq!(below, before);
    }
}
