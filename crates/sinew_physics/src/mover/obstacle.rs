//! Obstacles around a mover: shapes, triangles and other movers, collected once per step.

use super::Mover;
use super::segment::axis_to_triangle;
use crate::arena::Arena;
use crate::body::Body;
use crate::body::contact_rule::ContactRule;
use crate::body::def::BodyKind;
use crate::body::shape::{Sensing, Shape};
use crate::boxes::{Aabb, Overlap};
use crate::contact::proxies::thick;
use crate::convex::{Gap, gap};
use crate::mover::tuning::FLYING_SPEED;
use crate::triangles::Triangle;
use crate::world::World;
use core::ops::ControlFlow;
use sinew_math::{Rotation, Transform, Vec3, abs3, max3, min3};

/// Identity of an obstacle; ordered, so that collection has a defined order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Owner {
    /// Body, shape, and triangle index among the nearby ones.
    Shape(u32, u32, u32),
    Mover(u32),
}

/// A possible obstacle of a mover in this step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Obstacle {
    pub owner: Owner,
    pub bounds: Aabb,
    pub kind: BodyKind,
    form: Form,
}

#[derive(Clone, Copy, Debug)]
enum Form {
    Solid(Transform),
    /// A triangle in the world.
    Triangle(Triangle),
    Capsule {
        center: Vec3,
        half: f32,
        radius: f32,
    },
}

impl Obstacle {
    pub fn body(&self) -> Option<u32> {
        match self.owner {
            Owner::Shape(body, ..) => Some(body),
            Owner::Mover(_) => None,
        }
    }
}

/// Capsule of a mover, and its possible obstacles.
pub(super) struct Surroundings<'a> {
    pub bodies: &'a Arena<Body>,
    pub obstacles: &'a [Obstacle],
    pub shape: Shape,
    pub rotation: Rotation,
    pub up: Vec3,
    pub half: f32,
    pub radius: f32,
    /// Body that the sweeps ignore while it carries the mover.
    pub without: Option<u32>,
}

impl<'a> Surroundings<'a> {
    pub fn new(bodies: &'a Arena<Body>, obstacles: &'a [Obstacle], mover: &Mover) -> Self {
        let (radius, half) = (mover.def.radius, mover.half_height());
        Self {
            bodies,
            obstacles,
            shape: Shape::Capsule { half_height: half, radius },
            rotation: Rotation::from_arc(Vec3::Y, mover.def.up),
            up: mover.def.up,
            half,
            radius,
            without: None,
        }
    }

    /// Returns the bounds of the capsule's motion from `center` by `way`, enlarged by `margin`, metres.
    pub fn bounds(&self, center: Vec3, way: Vec3, margin: f32) -> Aabb {
        let half = abs3(self.up * self.half) + Vec3::splat(self.radius + margin);
        let to = center + way;
        Aabb { min: min3(center, to) - half, max: max3(center, to) + half }
    }

    pub fn is_there(&self, obstacle: &Obstacle) -> bool {
        self.without.is_none() || obstacle.body() != self.without
    }

    /// Returns the gap from an obstacle to the capsule; `None` without one, or if a neighbouring triangle is nearer.
    pub fn gap(&self, obstacle: &Obstacle, center: Vec3) -> Option<Gap> {
        self.look(obstacle, center).filter(|(_, hidden)| !hidden).map(|(gap, _)| gap)
    }

    /// Returns the gap from an obstacle to the capsule, and true if the gap is to the plane of a face because the
    /// nearest edge is internal.
    pub fn look(&self, obstacle: &Obstacle, center: Vec3) -> Option<(Gap, bool)> {
        let shown = |gap: Gap| (gap, false);
        match &obstacle.form {
            Form::Solid(world_from_shape) => {
                let Owner::Shape(body, shape, _) = obstacle.owner else { return None };
                let other = &self.bodies.at(body).shapes[shape as usize].shape;
                gap(other, world_from_shape, &self.shape, &Transform::new(center, self.rotation)).map(shown)
            }
            Form::Triangle(triangle) => {
                let along = self.up * self.half;
                let moved = triangle.moved(-center);
                let near = axis_to_triangle(&moved, [-along, along])?;
                let (on_a, distance) = (near.point + center, near.distance - self.radius);
                let on_b = on_a + near.normal * distance;
                Some((Gap { distance, normal: near.normal, on_a, on_b }, near.hidden))
            }
            &Form::Capsule { center: other, half, radius } => {
                let shape = Shape::Capsule { half_height: half, radius };
                let at = |center| Transform::new(center, self.rotation);
                gap(&shape, &at(other), &self.shape, &at(center)).map(shown)
            }
        }
    }
}

/// Collects the possible obstacles of a mover within `region`: shapes, and the movers in `others`.
pub(super) fn gather(
    world: &World,
    (movers, others): (&Arena<Mover>, impl Iterator<Item = u32>),
    index: u32,
    region: &Aabb,
    obstacles: &mut Vec<Obstacle>,
) {
    obstacles.clear();
    let mover = movers.at(index);
    let _ = world.broad.proxies.overlapping(&thick(region), |owner| {
        gather_shape(world, mover, (owner.body, owner.shape), region, obstacles);
        ControlFlow::<()>::Continue(())
    });
    for other in others {
        let at = movers.at(other);
        if other == index || !mover.def.filter.meets(at.def.filter) {
            continue;
        }
        let (half, radius, center) = (at.half_height(), at.def.radius, at.center());
        let around = at.half_extents();
        let bounds = Aabb { min: center - around, max: center + around };
        if bounds.overlaps(region) {
            let form = Form::Capsule { center, half, radius };
            obstacles.push(Obstacle { owner: Owner::Mover(other), bounds, kind: BodyKind::Kinematic, form });
        }
    }
    // DETERMINISM: the order in which trees report items depends on their history.
    obstacles.sort_unstable_by_key(|obstacle| obstacle.owner);
}

fn gather_shape(
    world: &World,
    mover: &Mover,
    (index, number): (u32, u32),
    region: &Aabb,
    obstacles: &mut Vec<Obstacle>,
) {
    let body = world.bodies.at(index);
    let surface = body.surface(number as usize);
    let passes = matches!(surface.rule, ContactRule::Ghost | ContactRule::Yields(_));
    let solid = surface.sensing == Sensing::Solid && !passes;
    let flies = body.kind == BodyKind::Dynamic && flies_past(body, mover) && !hangs(world, index);
    if flies || !solid || body.quarantined || !mover.def.filter.meets(surface.filter) {
        return;
    }
    let shape = &body.shapes[number as usize].shape;
    let pose = body.world_from_shape(number as usize);
    let (kind, owner) = (body.kind, |part| Owner::Shape(index, number, part));
    if let Some(triangles) = shape.surface() {
        let mut part = 0;
        triangles.overlapping(&into_frame(region, &pose), |triangle| {
            let corners = triangle.corners.map(|corner| pose.point(corner));
            let triangle = Triangle { corners, normal: pose.rotation * triangle.normal, ..triangle };
            let [a, b, c] = corners;
            let bounds = Aabb { min: min3(min3(a, b), c), max: max3(max3(a, b), c) };
            obstacles.push(Obstacle { owner: owner(part), bounds, kind, form: Form::Triangle(triangle) });
            part += 1;
        });
        return;
    }
    let bounds = if *shape == Shape::HalfSpace { *region } else { shape.aabb(&pose) };
    if !bounds.overlaps(region) {
        return;
    }
    let obstacle = Obstacle { owner: owner(0), bounds, kind, form: Form::Solid(pose) };
    if let ContactRule::OneWay(one_way) = surface.rule {
        let sight = Surroundings::new(&world.bodies, &[], mover);
        let gap = sight.gap(&obstacle, mover.center());
        let holds = |gap: Gap| gap.distance >= 0.0 && one_way.holds(pose.rotation.inverse() * gap.normal);
        if !gap.is_some_and(holds) {
            return;
        }
    }
    obstacles.push(obstacle);
}

/// True if a body is so fast and light that it passes through the mover.
fn flies_past(body: &Body, mover: &Mover) -> bool {
    let speed = body.velocity.linear.length();
    speed > FLYING_SPEED && speed <= mover.def.lets_pass * body.inverse_mass()
}

/// True if a joint connects a body to a static or kinematic one: a door leaf transfers more than its own momentum, and
/// swings back.
fn hangs(world: &World, index: u32) -> bool {
    world.activity.joints_of.body(index).iter().any(|&joint| {
        let joint = world.joints.at(joint);
        [joint.a, joint.b].into_iter().any(|body| world.bodies.at(body).kind != BodyKind::Dynamic)
    })
}

/// Converts world bounds to bounds in another frame.
fn into_frame(bounds: &Aabb, world_from_frame: &Transform) -> Aabb {
    let to_frame = world_from_frame.rotation.inverse();
    let half = bounds.half_extents();
    let axes = [Vec3::X * half.x, Vec3::Y * half.y, Vec3::Z * half.z].map(|axis| abs3(to_frame * axis));
    let center = world_from_frame.inverse_point(bounds.center());
    thick(&Aabb::reaching(center, axes[0] + axes[1] + axes[2]))
}
