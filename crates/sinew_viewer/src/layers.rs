//! Layers over the picture: what the world draws of itself, and what else one wants to see of bodies.

use sinew::math::{Transform, Vec3};
use sinew::physics::boxes::Aabb;
use sinew::physics::{BodyKind, DebugDraw, DrawKind, World};
use sinew_picture::{Line, LineDepth, draw};

/// A layer that can be switched on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Layer {
    /// Outlines of all shapes.
    Shapes,
    /// From bodies to their joints.
    Joints,
    /// Contact normals.
    Contacts,
    /// Axes at centres of mass.
    Centers,
    /// Way of each centre of mass in a tenth of a second.
    Velocities,
    /// Boxes around bodies.
    Bounds,
    /// Bodies in place of the skins of characters.
    Bones,
}

impl Layer {
    /// All layers, in the order in which they are shown.
    pub const ALL: [Self; 7] = [
        Self::Shapes,
        Self::Joints,
        Self::Contacts,
        Self::Centers,
        Self::Velocities,
        Self::Bounds,
        Self::Bones,
    ];

    /// Name of the layer.
    pub fn name(self) -> &'static str {
        match self {
            Self::Shapes => "shapes",
            Self::Joints => "joints",
            Self::Contacts => "contacts",
            Self::Centers => "centres of mass",
            Self::Velocities => "velocities",
            Self::Bounds => "bounds",
            Self::Bones => "bodies of skins",
        }
    }
}

/// Linear colours of what the world draws.
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

/// Seconds of way that an arrow of a velocity is long.
const WAY: f32 = 0.1;
/// Length of the axes at a centre of mass, as a share of the body's size.
const AXES: f32 = 0.35;

/// Adds the lines of the layers that are on.
pub fn draw(world: &World, layers: &[Layer], lines: &mut Vec<Line>) {
    let on = |layer: Layer| layers.contains(&layer);
    if [Layer::Shapes, Layer::Joints, Layer::Contacts].into_iter().any(on) {
        world.draw(&mut Chosen { layers, lines });
    }
    let moving = world.body_ids().filter(|&id| world.kind(id) != BodyKind::Static);
    for id in moving {
        let center = world.center_of_mass(id);
        let bounds = world.bounds(id);
        if on(Layer::Centers) {
            let size = (bounds.max - bounds.min).max_element();
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
    }
}

fn add_box(bounds: &Aabb, lines: &mut Vec<Line>) {
    let shape = sinew::physics::Shape::Box { half_extents: (bounds.max - bounds.min) * 0.5 };
    let place = Transform::from_translation(bounds.center());
    lines.extend(draw::wire(&shape, place, [0.45, 0.25, 0.65], LineDepth::Tested));
}

/// Lines of the world whose layers are on.
struct Chosen<'a> {
    layers: &'a [Layer],
    lines: &'a mut Vec<Line>,
}

impl DebugDraw for Chosen<'_> {
    fn line(&mut self, from: Vec3, to: Vec3, kind: DrawKind) {
        let layer = match kind {
            DrawKind::Static | DrawKind::Kinematic | DrawKind::Awake | DrawKind::Asleep => Layer::Shapes,
            DrawKind::Joint => Layer::Joints,
            DrawKind::Contact => Layer::Contacts,
            // Painted always.
            DrawKind::Spring | DrawKind::Object => return,
        };
        if self.layers.contains(&layer) {
            self.lines.push(Line { from, to, color: color(kind), depth: LineDepth::OnTop });
        }
    }
}
