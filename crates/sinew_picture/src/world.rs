//! Draws a physics world as models and lines: movable bodies in colours, static ones in grey.

use crate::draw;
use crate::scene::{Line, LineDepth, Model, RenderMaterial, Scene};
use sinew::math::{Transform, Vec3, max};
use sinew::physics::boxes::Aabb;
use sinew::physics::particles::{ParticleGroup, SpringDef};
use sinew::physics::{
    BodyId, BodyKind, DebugDraw, DrawKind, GroupId, JointDef, JointId, JointKind, Shape, SixDof, World,
};
use std::collections::{HashMap, HashSet, VecDeque};

/// Part of a world shown in a picture. Its size determines how thick small and thin objects are drawn so that they are
/// visible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame<'a> {
    /// Centre of the frame, world space, metres.
    pub center: Vec3,
    /// Radius of the frame around its centre, metres, above 0.
    pub radius: f32,
    /// Drawing mode of kinematic bodies.
    pub kinematic: Kinematic,
    /// Linear colours of individual bodies; the others have the colours of their kind.
    pub colors: &'a [(BodyId, [f32; 3])],
}

/// Drawing mode of kinematic bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kinematic {
    /// The bodies are drawn like others.
    Solid,
    /// Only the edges of the bodies are drawn, so that they do not hide the character whose clips move them.
    Wire,
}

/// Linear colours of bodies, assigned in the order of the bodies.
const COLORS: [[f32; 3]; 8] = [
    [0.62, 0.10, 0.06],
    [0.06, 0.22, 0.52],
    [0.78, 0.42, 0.05],
    [0.05, 0.35, 0.25],
    [0.36, 0.10, 0.40],
    [0.62, 0.55, 0.12],
    [0.05, 0.38, 0.50],
    [0.55, 0.20, 0.28],
];
const STANDING: [f32; 3] = [0.34, 0.35, 0.36];
const KINEMATIC: [f32; 3] = [0.20, 0.24, 0.28];
const FLOOR: [[f32; 3]; 2] = [[0.34, 0.36, 0.38], [0.27, 0.29, 0.31]];
/// Brightness of every second square of a floor with its own colour, as a factor.
const MOWN: f32 = 1.2;
const PARTICLE: [f32; 3] = [0.70, 0.34, 0.05];
const SPRING: [f32; 3] = [0.25, 0.22, 0.18];
const JOINT: [f32; 3] = [0.10, 0.11, 0.12];
/// Linear colour of the lines that user-defined objects draw.
const OBJECT: [f32; 3] = [0.70, 0.05, 0.30];
/// Share by which the colour of a sleeping body is mixed with [`PALE`].
const SLEEP: f32 = 0.3;
const PALE: [f32; 3] = [0.75, 0.77, 0.80];

/// Least radius with which a ball is drawn, as a share of the frame's radius.
const SMALLEST: f32 = 0.012;
/// Radius of the rod that shows a spring, as a share of the frame's radius.
const ROD: f32 = 0.004;
/// Largest number of particles and springs that are drawn as balls and rods; more are drawn as lines.
const MOST_SOLID: usize = 1500;

/// Returns the linear colour of an awake body by its number in the order of ids.
pub fn body_color(number: usize) -> [f32; 3] {
    COLORS[number % COLORS.len()]
}

/// Returns the box around the subject of a picture of the world: movable bodies, anchors of joints, drawings of objects; without
/// these, all bounded static shapes. `None` for an empty world.
pub fn subject(world: &World) -> Option<Aabb> {
    let moving = world.body_ids().filter(|&id| world.kind(id) != BodyKind::Static);
    let particles = world.group_ids().map(|id| world.particles(id)).filter(|g| !g.positions().is_empty());
    let particles = particles.map(particle_bounds);
    let lines = lines_of_objects(world);
    let joints = world.joint_ids().flat_map(|id| links(world, id)).flatten();
    let anchors = joints.map(|point| Aabb { min: point, max: point }).chain(lines.bounds());
    let merge = |a: Aabb, b: Aabb| a.merge(&b);
    let active = moving.map(|id| body_bounds(world, id)).chain(particles).chain(anchors).reduce(merge);
    active.or_else(|| {
        let ended = |id: &BodyId| world.shapes(*id).all(|(shape, _)| is_solid(&shape));
        world.body_ids().filter(ended).map(|id| body_bounds(world, id)).reduce(merge)
    })
}

/// Returns true if a picture should contain the whole shape; false for floors and levels, which extend beyond it.
fn is_solid(shape: &Shape) -> bool {
    !matches!(shape, Shape::HalfSpace | Shape::Mesh(_) | Shape::HeightField(_))
}

/// Returns the bounds of the centre of mass and all solid shapes.
fn body_bounds(world: &World, id: BodyId) -> Aabb {
    let center = world.center_of_mass(id);
    let shapes = world.shapes(id).filter(|(shape, _)| is_solid(shape));
    shapes.fold(Aabb { min: center, max: center }, |all, (shape, place)| all.merge(&shape.aabb(&place)))
}

/// Returns the bounds of the particles of a group that has any.
fn particle_bounds(group: &ParticleGroup) -> Aabb {
    let ball = |i: usize| Aabb::around(group.positions()[i], Vec3::splat(group.radii()[i]));
    (1..group.positions().len()).fold(ball(0), |all, i| all.merge(&ball(i)))
}

/// Returns the lines of a joint: from the centre of each moving body to its anchor, and from anchor to anchor.
fn links(world: &World, id: JointId) -> [[Vec3; 2]; 3] {
    let JointDef { body_a, body_b, frame_a, frame_b, kind, motor, .. } = world.joint(id);
    // A pin is drawn to the target of its motor, because its anchor may be anywhere.
    let is_pin = kind == JointKind::SixDof(SixDof::FREE) && world.kind(body_a) != BodyKind::Dynamic;
    let goal = motor.filter(|_| is_pin).map_or(Vec3::ZERO, |motor| motor.target.translation);
    let a = (world.transform(body_a) * frame_a).point(goal);
    let b = world.transform(body_b).point(frame_b.translation);
    let from = |body: BodyId, anchor: Vec3| match world.kind(body) {
        BodyKind::Static => anchor,
        BodyKind::Kinematic | BodyKind::Dynamic => world.center_of_mass(body),
    };
    [[from(body_a, a), a], [a, b], [b, from(body_b, b)]]
}

/// Target for drawing a world: a [`Scene`], or a renderer that draws many equal shapes at once. Colours are linear.
pub trait Canvas {
    /// Adds the surface of a bounded shape, in one colour.
    fn solid(&mut self, shape: &Shape, world_from_shape: Transform, color: [f32; 3]);
    /// Adds a ball of `radius` metres, whose surface has eight fields of two alternating shades, like [`draw::ball`].
    fn ball(&mut self, radius: f32, world_from_ball: Transform, color: [f32; 3]);
    /// Adds a round rod of `radius` between two points, metres, world space.
    fn rod(&mut self, from: Vec3, to: Vec3, radius: f32, color: [f32; 3]);
    /// Adds any other surface.
    fn model(&mut self, model: Model);
    /// Adds a line over the surfaces.
    fn line(&mut self, line: Line);
}

impl Canvas for Scene {
    fn solid(&mut self, shape: &Shape, world_from_shape: Transform, color: [f32; 3]) {
        self.models.push(draw::shape(shape, world_from_shape, RenderMaterial::new(color)));
    }

    fn ball(&mut self, radius: f32, world_from_ball: Transform, color: [f32; 3]) {
        self.models.push(draw::ball(radius, world_from_ball, RenderMaterial::new(color)));
    }

    fn rod(&mut self, from: Vec3, to: Vec3, radius: f32, color: [f32; 3]) {
        self.models.push(draw::rod(from, to, radius, RenderMaterial::new(color)));
    }

    fn model(&mut self, model: Model) {
        self.models.push(model);
    }

    fn line(&mut self, line: Line) {
        self.lines.push(line);
    }
}

/// Paints the world's bodies, particles, springs, joints and the drawings of its objects.
pub fn paint(world: &World, frame: &Frame<'_>, canvas: &mut dyn Canvas) {
    paint_all_but(world, &[], &[], frame, canvas);
}

/// Paints like [`paint`], without the bodies `shown` by other means and their joints, and without particles that are
/// `worn`: these are parts of a character that is drawn by its skin.
pub fn paint_all_but(
    world: &World,
    shown: &[BodyId],
    worn: &[GroupId],
    frame: &Frame<'_>,
    canvas: &mut dyn Canvas,
) {
    let shown: HashSet<BodyId> = shown.iter().copied().collect();
    let colors: HashMap<BodyId, [f32; 3]> = frame.colors.iter().copied().collect();
    for (number, id) in world.body_ids().enumerate() {
        if shown.contains(&id) {
            continue;
        }
        if world.kind(id) == BodyKind::Kinematic && frame.kinematic == Kinematic::Wire {
            let wires = world
                .shapes(id)
                .flat_map(|(shape, place)| draw::wire(&shape, place, KINEMATIC, LineDepth::Tested));
            wires.for_each(|wire| canvas.line(wire));
        } else {
            let color = colors.get(&id).copied();
            paint_body(world, id, color.ok_or(number), frame, canvas);
        }
    }
    for id in world.group_ids().filter(|id| !worn.contains(id)) {
        paint_group(world.particles(id), frame, canvas);
    }
    let is_shown = |id: &JointId| {
        let (a, b) = world.joint_bodies(*id);
        shown.contains(&a) || shown.contains(&b)
    };
    let joints: Vec<_> =
        world.joint_ids().filter(|id| !is_shown(id)).flat_map(|id| links(world, id)).collect();
    thin(&joints, JOINT, frame, canvas);
    lines_of_objects(world).list.into_iter().for_each(|line| canvas.line(line));
}

/// Returns the lines that the world's objects draw.
fn lines_of_objects(world: &World) -> Lines {
    let mut lines = Lines::default();
    // `draw` draws the whole world; most worlds have no objects, and a crowd has many shapes.
    if world.object_ids().next().is_some() {
        world.draw(&mut lines);
    }
    lines
}

/// Draws segments as rods, or as lines if there are too many.
fn thin(segments: &[[Vec3; 2]], color: [f32; 3], frame: &Frame<'_>, canvas: &mut dyn Canvas) {
    let long = segments.iter().filter(|[from, to]| (*to - *from).length() > ROD * frame.radius);
    for &[from, to] in long {
        if segments.len() <= MOST_SOLID {
            canvas.rod(from, to, ROD * frame.radius, color);
        } else {
            canvas.line(Line { from, to, color, depth: LineDepth::Tested });
        }
    }
}

/// Draws a body. `color` is `Ok` with the body's own colour, or `Err` with its number in the order of ids.
fn paint_body(
    world: &World,
    id: BodyId,
    color: Result<[f32; 3], usize>,
    frame: &Frame<'_>,
    canvas: &mut dyn Canvas,
) {
    let kind = world.kind(id);
    let squares = color.map_or(FLOOR, |color| [color.map(|x| MOWN * x), color]);
    let color = match (color, kind) {
        (Ok(color), _) => color,
        (Err(_), BodyKind::Static) => STANDING,
        (Err(_), BodyKind::Kinematic) => KINEMATIC,
        (Err(number), BodyKind::Dynamic) if world.is_awake(id) => body_color(number),
        (Err(number), BodyKind::Dynamic) => pale(body_color(number)),
    };
    let smallest = SMALLEST * frame.radius;
    let mut seen = kind == BodyKind::Static;
    for (shape, place) in world.shapes(id) {
        match shape {
            Shape::Sphere { radius } => canvas.ball(radius, place, color),
            Shape::HalfSpace => canvas.model(floor(&place, squares, frame)),
            _ => canvas.solid(&shape, place, color),
        }
        seen |= shape.bounding_radius() > smallest;
    }
    if !seen {
        let place = Transform::new(world.center_of_mass(id), world.transform(id).rotation);
        canvas.ball(smallest, place, color);
    }
}

fn pale(color: [f32; 3]) -> [f32; 3] {
    core::array::from_fn(|i| color[i] + (PALE[i] - color[i]) * SLEEP)
}

/// Returns the part of a half-space's plane below the frame, in squares of suitable size.
fn floor(place: &Transform, squares: [[f32; 3]; 2], frame: &Frame<'_>) -> Model {
    let up = place.rotation * Vec3::Y;
    let below = frame.center - up * (frame.center - place.translation).dot(up);
    let half_size = max(40.0, 12.0 * frame.radius);
    draw::plane(Transform::new(below, place.rotation), half_size, round_length(0.4 * frame.radius), squares)
}

/// Returns the largest of 1, 2, 5, 10, 20 … metres (or 0.5, 0.2, 0.1 …) up to `length`.
fn round_length(length: f32) -> f32 {
    let mut decade = 1.0;
    while decade > length && decade > 1e-6 {
        decade /= 10.0;
    }
    while decade * 10.0 <= length && decade < 1e6 {
        decade *= 10.0;
    }
    [5.0, 2.0].map(|step| step * decade).into_iter().find(|&size| size <= length).unwrap_or(decade)
}

fn paint_group(group: &ParticleGroup, frame: &Frame<'_>, canvas: &mut dyn Canvas) {
    let positions = group.positions();
    if let Some(model) = surface(group) {
        return canvas.model(model);
    }
    if positions.len() <= MOST_SOLID {
        for (&position, &radius) in positions.iter().zip(group.radii()) {
            let alone = group.springs().is_empty();
            let radius = max(radius, SMALLEST * frame.radius * if alone { 1.0 } else { 0.5 });
            let place = Transform::from_translation(position);
            canvas.solid(&Shape::Sphere { radius }, place, PARTICLE);
        }
    }
    let ends = |spring: &SpringDef| [spring.a, spring.b].map(|i| positions[i as usize]);
    let springs: Vec<_> = group.springs().iter().map(ends).collect();
    thin(&springs, SPRING, frame, canvas);
}

/// Returns the surface of cloth, or of the skins of soft bodies; `None` for ropes and nets, which have none.
fn surface(group: &ParticleGroup) -> Option<Model> {
    let of_volumes = group.volumes().iter().flat_map(|volume| &volume.triangles);
    let triangles: Vec<[u32; 3]> = match group.faces() {
        [] => of_volumes.copied().collect(),
        faces => faces.to_vec(),
    };
    if triangles.is_empty() {
        return None;
    }
    let positions = group.positions().to_vec();
    let mut normals = vec![Vec3::ZERO; positions.len()];
    for triangle in &triangles {
        let [a, b, c] = triangle.map(|i| positions[i as usize]);
        let normal = (b - a).cross(c - a);
        triangle.iter().for_each(|&i| normals[i as usize] += normal);
    }
    let indices = triangles.into_iter().flatten().collect();
    Some(Model { positions, normals, indices, material: RenderMaterial::new(PARTICLE), ..Model::default() })
}

/// Largest number of bodies with drawn trails; more would be indistinguishable.
const MOST_TRAILS: usize = 4;
/// Length of a trail, steps.
const TRAIL_STEPS: usize = 600;

/// Paths of the centres of mass of a few bodies.
#[derive(Clone, Debug, Default)]
pub struct Trails {
    list: Vec<Trail>,
}

#[derive(Clone, Debug)]
struct Trail {
    body: BodyId,
    color: [f32; 3],
    points: VecDeque<Vec3>,
}

impl Trails {
    /// Begins the trails of a world's moving bodies; empty if there are more than four.
    pub fn of(world: &World) -> Self {
        let bodies = world.body_ids().enumerate();
        let moving: Vec<_> = bodies.filter(|&(_, id)| world.kind(id) != BodyKind::Static).collect();
        if moving.len() > MOST_TRAILS {
            return Self::default();
        }
        let start = |(number, body)| Trail {
            body,
            color: body_color(number),
            points: VecDeque::from([world.center_of_mass(body)]),
        };
        Self { list: moving.into_iter().map(start).collect() }
    }

    /// Extends the trails after a step.
    pub fn go_on(&mut self, world: &World) {
        for trail in self.list.iter_mut().filter(|trail| world.contains(trail.body)) {
            if trail.points.len() > TRAIL_STEPS {
                trail.points.pop_front();
            }
            trail.points.push_back(world.center_of_mass(trail.body));
        }
    }

    /// Returns the lines of the trails.
    pub fn lines(&self) -> impl Iterator<Item = Line> {
        self.list.iter().flat_map(|trail| {
            let ends = trail.points.iter().zip(trail.points.iter().skip(1));
            ends.map(|(&from, &to)| Line { from, to, color: trail.color, depth: LineDepth::Tested })
        })
    }
}

/// Collects the lines of [`World::draw`], or of other drawings, that are not replaced by surfaces.
#[derive(Clone, Debug, Default)]
pub struct Lines {
    /// Lines in the order in which they were drawn.
    pub list: Vec<Line>,
}

impl Lines {
    /// Bounds of all lines; `None` without lines.
    pub fn bounds(&self) -> Option<Aabb> {
        let ends = self.list.iter().flat_map(|line| [line.from, line.to]);
        ends.map(|point| Aabb { min: point, max: point }).reduce(|a, b| a.merge(&b))
    }
}

/// Kinds of drawings from which no lines are collected: surfaces, and contacts, which are not drawn.
const SURFACES: [DrawKind; 7] = [
    DrawKind::Static,
    DrawKind::Kinematic,
    DrawKind::Awake,
    DrawKind::Asleep,
    DrawKind::Joint,
    DrawKind::Spring,
    DrawKind::Contact,
];

impl DebugDraw for Lines {
    fn line(&mut self, from: Vec3, to: Vec3, kind: DrawKind) {
        if !SURFACES.contains(&kind) {
            self.list.push(Line { from, to, color: OBJECT, depth: LineDepth::Tested });
        }
    }
}
