//! Layers over the picture: the world's debug drawing, and additional views of bodies.

mod islands;
mod limits;
mod springs;

pub(crate) use limits::{Cone, add_cone, cone_of};

use sinew::math::{Transform, Vec3, max, min, normalize_or};
use sinew::physics::boxes::Aabb;
use sinew::physics::{BodyKind, DebugDraw, DrawKind, World};
use sinew_picture::{Line, LineDepth, draw};
use sinew_scenes::scenes::Figure;

/// A layer that can be switched on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Layer {
    /// Outlines of all shapes.
    Shapes,
    /// Lines from bodies to their joints.
    Joints,
    /// Contact normals, scaled by their load.
    Contacts,
    /// Axes at centres of mass.
    Centers,
    /// Displacement of each centre of mass in a tenth of a second.
    Velocities,
    /// Boxes around bodies.
    Bounds,
    /// Bodies instead of the skins of characters.
    Bones,
    /// Cones of joint limits, with the present rotation of the joint.
    Limits,
    /// Outlines in the colour of the island, grey for sleeping ones.
    Islands,
    /// Forces of fields on bodies.
    Fields,
    /// Springs of characters with their hit radii and colliders, and backstops of cloth.
    Springs,
}

impl Layer {
    /// All layers, in the order in which they are shown.
    pub const ALL: [Self; 11] = [
        Self::Shapes,
        Self::Joints,
        Self::Contacts,
        Self::Centers,
        Self::Velocities,
        Self::Bounds,
        Self::Bones,
        Self::Limits,
        Self::Islands,
        Self::Fields,
        Self::Springs,
    ];

    /// Returns the name of the layer.
    pub fn name(self) -> &'static str {
        match self {
            Self::Shapes => "shapes",
            Self::Joints => "joints",
            Self::Contacts => "contacts",
            Self::Centers => "centres of mass",
            Self::Velocities => "velocities",
            Self::Bounds => "bounds",
            Self::Bones => "bodies of skins",
            Self::Limits => "joint limits",
            Self::Islands => "islands",
            Self::Fields => "fields",
            Self::Springs => "springs and backstops",
        }
    }
}

/// Returns the linear colours of the world's debug drawing.
fn color(kind: DrawKind) -> [f32; 3] {
    match kind {
        DrawKind::Static => [0.30, 0.32, 0.35],
        DrawKind::Kinematic => [0.10, 0.45, 0.65],
        DrawKind::Awake => [0.95, 0.75, 0.10],
        DrawKind::Asleep => [0.35, 0.45, 0.60],
        DrawKind::Joint => [0.05, 0.75, 0.85],
        DrawKind::Spring => [0.80, 0.40, 0.05],
        DrawKind::Contact => [0.95, 0.05, 0.05],
        DrawKind::Object => [0.70, 0.05, 0.30],
    }
}

/// Time for which a velocity's arrow shows the displacement, seconds.
const WAY: f32 = 0.1;
/// Length of the axes at a centre of mass, as a share of the body's size.
const AXES: f32 = 0.35;
/// Length of a force as large as the body's weight (at 9.81 m/s²), in sizes of the body: longer arrows cross those of neighbours.
const FORCE: f32 = 0.5;
/// Longest and shortest arrow of a force, in sizes of the body.
const FORCE_RANGE: [f32; 2] = [0.04, 2.0];
/// Weight of a kilogram, N.
const WEIGHT: f32 = 9.81;

/// Adds the lines of the layers that are on.
pub fn draw(world: &World, figures: &[Figure<'_>], layers: &[Layer], lines: &mut Vec<Line>) {
    let on = |layer: Layer| layers.contains(&layer);
    if [Layer::Shapes, Layer::Joints].into_iter().any(on) {
        world.draw(&mut Chosen { layers, lines });
    }
    if on(Layer::Contacts) {
        add_contacts(world, lines);
    }
    if on(Layer::Limits) {
        let joints = world.joint_ids().filter_map(|id| cone_of(world, &world.joint(id)));
        joints.for_each(|cone| add_cone(&cone, None, lines));
    }
    if on(Layer::Springs) {
        springs::add_springs(figures, lines);
        springs::add_backstops(world, lines);
    }
    if on(Layer::Islands) {
        islands::add(world, lines);
    }
    let moving = world.body_ids().filter(|&id| world.kind(id) != BodyKind::Static);
    for id in moving {
        let center = world.center_of_mass(id);
        let bounds = world.bounds(id);
        let size = (bounds.max - bounds.min).max_element();
        if on(Layer::Centers) {
            let frame = Transform::new(center, world.transform(id).rotation);
            lines.extend(draw::axes(frame, AXES * size, LineDepth::OnTop));
        }
        if on(Layer::Velocities) {
            let to = center + world.velocity(id).linear * WAY;
            lines.push(Line { from: center, to, color: [0.05, 0.65, 0.10], depth: LineDepth::OnTop });
        }
        if on(Layer::Bounds) {
            add_box(&bounds, lines);
        }
        if on(Layer::Fields) && world.kind(id) == BodyKind::Dynamic {
            let force =
                world.field_ids().fold(Vec3::ZERO, |sum, field| sum + world.field_force(field, id).force);
            add_force(center, force, world.mass(id).mass, size, [0.45, 0.10, 0.75], lines);
        }
    }
}

/// Adds an arrow scaled by the ratio of a force to the weight of a mass, kg.
fn add_force(at: Vec3, force: Vec3, mass: f32, size: f32, color: [f32; 3], lines: &mut Vec<Line>) {
    let weights = force.length() / max(mass * WEIGHT, 1e-9);
    if weights < 1e-4 {
        return;
    }
    let [shortest, longest] = FORCE_RANGE;
    let way = normalize_or(force, Vec3::Y);
    let length = size * min(max(FORCE * weights, shortest), longest);
    let to = at + way * length;
    let across = normalize_or(way.cross(Vec3::Y), Vec3::X);
    let barb = 0.2 * length;
    for [from, to] in [[at, to], [to, to + (across - way) * barb], [to, to - (across + way) * barb]] {
        lines.push(Line { from, to, color, depth: LineDepth::OnTop });
    }
}

/// Adds contact forces on the second body of each contact, and crosses for points without load.
fn add_contacts(world: &World, lines: &mut Vec<Line>) {
    let red = color(DrawKind::Contact);
    for contact in world.contacts() {
        let bodies = [contact.a.body, contact.b.body].into_iter();
        let moving = bodies.filter(|&id| world.kind(id) == BodyKind::Dynamic);
        let lightest = moving.min_by(|&a, &b| world.mass(a).mass.total_cmp(&world.mass(b).mass));
        let Some(lightest) = lightest else { continue };
        let bounds = world.bounds(lightest);
        let (size, mass) = ((bounds.max - bounds.min).max_element(), world.mass(lightest).mass);
        for point in contact.points() {
            let force = contact.normal * (point.impulse / world.def().dt());
            add_force(point.position, force, mass, size, red, lines);
            let half = 0.03 * size;
            for arm in [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| axis * half) {
                let (from, to) = (point.position - arm, point.position + arm);
                let color = if point.impulse > 0.0 { red } else { [0.95, 0.55, 0.55] };
                lines.push(Line { from, to, color, depth: LineDepth::OnTop });
            }
        }
    }
}

fn add_box(bounds: &Aabb, lines: &mut Vec<Line>) {
    let shape = sinew::physics::Shape::Box { half_extents: (bounds.max - bounds.min) * 0.5 };
    let place = Transform::from_translation(bounds.center());
    lines.extend(draw::wire(&shape, place, [0.45, 0.25, 0.65], LineDepth::Tested));
}

/// Lines of the world in the enabled layers.
struct Chosen<'a> {
    layers: &'a [Layer],
    lines: &'a mut Vec<Line>,
}

impl DebugDraw for Chosen<'_> {
    fn line(&mut self, from: Vec3, to: Vec3, kind: DrawKind) {
        let layer = match kind {
            DrawKind::Static | DrawKind::Kinematic | DrawKind::Awake | DrawKind::Asleep => Layer::Shapes,
            DrawKind::Joint => Layer::Joints,
            // These kinds are always drawn, or drawn with their forces.
            DrawKind::Spring | DrawKind::Object | DrawKind::Contact => return,
        };
        if self.layers.contains(&layer) {
            self.lines.push(Line { from, to, color: color(kind), depth: LineDepth::OnTop });
        }
    }
}
