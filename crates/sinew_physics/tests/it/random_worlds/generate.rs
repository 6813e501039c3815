//! Generates random plans of worlds. Equal seeds give equal plans.

use super::joints::{self, Temper};
use super::plan::{BodyPlan, Change, Frames, JointPlan, WorldPlan};
use super::{STEPS, chance, decades};
use sinew_math::{Random, Rotation, Transform, Vec3, max};
use sinew_physics::*;

/// Growth of trees: each new body is joined to the last body, which gives chains, or to any earlier body.
#[derive(Clone, Copy)]
enum Growth {
    Chain,
    Bush,
}

pub fn world(seed: u64) -> WorldPlan {
    let mut random = Random::new(seed);
    let r = &mut random;
    let temper = if chance(r, 0.6) { Temper::Passive } else { Temper::Driven };
    let mut plan = WorldPlan {
        gravity: gravity(r),
        sleeping: if chance(r, 0.7) { Sleeping::On } else { Sleeping::Off },
        floor: chance(r, 0.6),
        parted: temper == Temper::Passive || chance(r, 0.3),
        passive: temper == Temper::Passive,
        bodies: Vec::new(),
        joints: Vec::new(),
        changes: Vec::new(),
        save_at: r.index(STEPS as usize - 100) as u32,
    };
    if chance(r, 0.1) {
        net(r, &mut plan, temper);
    } else {
        forest(r, &mut plan, temper);
    }
    lift(r, &mut plan);
    loops(r, &mut plan, temper);
    if chance(r, 0.7) {
        changes(r, &mut plan, temper);
    }
    plan
}

fn gravity(r: &mut Random) -> Vec3 {
    if chance(r, 0.75) { Vec3::new(0.0, -9.81, 0.0) } else { Vec3::ZERO }
}

/// Returns a random shape, `size` metres across.
fn shape(r: &mut Random, size: f32) -> Shape {
    let half = 0.5 * size;
    match r.index(3) {
        0 => {
            let mut side = || half * decades(r, -1.0, 0.0);
            Shape::Box { half_extents: Vec3::new(half, side(), side()) }
        }
        1 => Shape::Sphere { radius: half },
        _ => {
            let radius = half * r.range(0.1, 0.9);
            Shape::Capsule { half_height: half - radius, radius }
        }
    }
}

/// Ranges of sizes and masses, as powers of ten.
struct Spread {
    size: [f32; 2],
    mass: [f32; 2],
}

impl Spread {
    fn random(r: &mut Random) -> Self {
        let size = if chance(r, 0.5) { [-1.0, -0.3] } else { [-1.7, 0.3] };
        let mass = if chance(r, 0.5) { [0.0, 1.0] } else { [-2.0, 2.0] };
        Self { size, mass }
    }

    fn body(&self, r: &mut Random, pose: Transform, speed: f32) -> BodyPlan {
        let size = decades(r, self.size[0], self.size[1]);
        let restitution = if chance(r, 0.2) { r.range(0.0, 0.8) } else { 0.0 };
        BodyPlan {
            kind: BodyKind::Dynamic,
            shape: shape(r, size),
            material: Material { friction: r.range(0.0, 1.0), restitution, ..Material::DEFAULT },
            mass: decades(r, self.mass[0], self.mass[1]),
            pose,
            velocity: velocity(r, speed),
            collides: true,
        }
    }
}

fn velocity(r: &mut Random, speed: f32) -> Velocity {
    Velocity { linear: r.in_cube() * speed, angular: r.in_cube() * (2.0 * speed) }
}

/// Adds trees whose roots are static, kinematic or dynamic bodies.
fn forest(r: &mut Random, plan: &mut WorldPlan, temper: Temper) {
    let spread = Spread::random(r);
    let count = if chance(r, 0.1) { 9 + r.index(22) } else { 2 + r.index(7) };
    let growth = if chance(r, 0.4) { Growth::Chain } else { Growth::Bush };
    let speed = if chance(r, 0.5) { 0.0 } else { decades(r, -1.0, 1.0) };
    let (self_collision, fixed) = (chance(r, 0.6), r.unit());
    for i in 0..count {
        let pose = Transform::new(r.in_cube() * 3.0, r.rotation());
        let mut body = spread.body(r, pose, speed);
        body.collides = self_collision;
        if i == 0 && fixed < 0.5 {
            body.kind = if fixed < 0.4 { BodyKind::Static } else { BodyKind::Kinematic };
            let still = temper == Temper::Passive || body.kind == BodyKind::Static;
            body.velocity = velocity(r, if still { 0.0 } else { 1.0 });
        }
        if i == 0 || chance(r, 0.08) {
            plan.bodies.push(body);
            continue;
        }
        let parent = match growth {
            Growth::Chain => i - 1,
            Growth::Bush => r.index(i),
        };
        // A static body at a second point, which holds the end of the tree too.
        if chance(r, 0.03) && plan.bodies[parent].kind == BodyKind::Dynamic {
            (body.kind, body.velocity) = (BodyKind::Static, Velocity::default());
        }
        let (at, place) = neighbor(r, &plan.bodies[parent], &body);
        body.pose.translation = place;
        plan.bodies.push(body);
        plan.joints.push(joints::joint(r, plan, [parent, i], at, temper));
    }
}

/// Returns the point at which `child` is joined to `parent`, and the position of `child` with this joint, both in world
/// coordinates.
fn neighbor(r: &mut Random, parent: &BodyPlan, child: &BodyPlan) -> (Vec3, Vec3) {
    let way = r.direction();
    let on = (way + r.in_cube() * 0.5).normalize();
    let at = parent.pose.translation + way * (parent.shape.bounding_radius() * r.range(0.3, 1.0));
    (at, at + on * (child.shape.bounding_radius() * r.range(0.3, 1.0)))
}

/// Adds a grid of bodies joined to their neighbours, hung by its corners.
fn net(r: &mut Random, plan: &mut WorldPlan, temper: Temper) {
    let (width, height) = (2 + r.index(4), 2 + r.index(4));
    let (size, mass) = (decades(r, -1.5, -0.5), decades(r, -1.0, 1.0));
    let ratio = if chance(r, 0.3) { 2.0 } else { 0.0 };
    let hung = r.index(3);
    let model = joints::net_kind(r);
    let turned = r.rotation();
    for k in 0..width * height {
        let (x, y) = (k % width, k / width);
        let place = turned * (Vec3::new(x as f32, y as f32, 0.0) * (size * 1.3));
        let mut body =
            Spread { size: [0.0; 2], mass: [0.0; 2] }.body(r, Transform::new(place, Rotation::IDENTITY), 0.0);
        body.shape = Shape::Sphere { radius: 0.5 * size };
        body.mass = mass * decades(r, 0.0, ratio);
        if k == 0 && hung > 0 || k + 1 == width && hung > 1 {
            body.kind = BodyKind::Static;
        }
        plan.bodies.push(body);
        let beside = (x > 0).then(|| k - 1);
        let below = (y > 0).then(|| k - width);
        for other in beside.into_iter().chain(below) {
            if plan.bodies[other].kind == BodyKind::Static && plan.bodies[k].kind == BodyKind::Static {
                continue;
            }
            let at = (plan.bodies[other].pose.translation + place) * 0.5;
            let joint = joints::joint(r, plan, [other, k], at, temper);
            plan.joints.push(JointPlan {
                kind: model,
                limit_softness: None,
                soft_zone: None,
                spring: None,
                motor: None,
                ..joint
            });
        }
    }
}

/// Raises all bodies above the floor.
fn lift(r: &mut Random, plan: &mut WorldPlan) {
    let mut depth = f32::NEG_INFINITY;
    for body in &plan.bodies {
        depth = max(depth, body.shape.bounding_radius() - body.pose.translation.y);
    }
    let above = depth + decades(r, -2.0, 0.5);
    for body in &mut plan.bodies {
        body.pose.translation.y += above;
    }
}

/// Returns two bodies, at least one of which is dynamic.
fn pair(r: &mut Random, plan: &WorldPlan) -> Option<[usize; 2]> {
    let (a, b) = (r.index(plan.bodies.len()), r.index(plan.bodies.len()));
    let moves = |i: usize| plan.bodies[i].kind == BodyKind::Dynamic;
    (a != b && (moves(a) || moves(b))).then_some([a, b])
}

/// Adds joints beyond those of trees; some are redundant.
fn loops(r: &mut Random, plan: &mut WorldPlan, temper: Temper) {
    if chance(r, 0.6) {
        return;
    }
    for _ in 0..=r.index(6) {
        if chance(r, 0.2) && !plan.joints.is_empty() {
            let double = plan.joints[r.index(plan.joints.len())].clone();
            plan.joints.push(double);
        } else if let Some([a, b]) = pair(r, plan) {
            let at = (plan.bodies[a].pose.translation + plan.bodies[b].pose.translation) * 0.5;
            plan.joints.push(joints::joint(r, plan, [a, b], at, temper));
        }
    }
}

fn changes(r: &mut Random, plan: &mut WorldPlan, temper: Temper) {
    for _ in 0..=r.index(8) {
        let step = 1 + r.index(STEPS as usize - 1) as u32;
        if chance(r, 0.2) {
            let Some([a, b]) = pair(r, plan) else { continue };
            // The frame is in A's frame; the later position of A has no effect.
            let at = neighbor(r, &plan.bodies[a], &plan.bodies[b]).0;
            let joint = joints::joint(r, plan, [a, b], at, temper);
            plan.joints.push(JointPlan { born: step, ..joint });
            continue;
        }
        if let Some(change) = change(r, plan, temper) {
            plan.changes.push((step, change));
        }
    }
}

fn change(r: &mut Random, plan: &WorldPlan, temper: Temper) -> Option<Change> {
    let body = r.index(plan.bodies.len());
    match r.index(10) {
        0 => return chance(r, 0.5).then_some(Change::RemoveBody(body)),
        1 | 2 => {
            let hardest = if temper == Temper::Passive { 1.0 } else { 1.5 };
            let speed = decades(r, -1.0, hardest);
            return Some(Change::Kick(body, velocity(r, speed)));
        }
        3 => return Some(Change::Reload),
        _ => {}
    }
    if plan.joints.is_empty() {
        return None;
    }
    let j = r.index(plan.joints.len());
    Some(match r.index(6) {
        0 => Change::RemoveJoint(j),
        1 => Change::SetState(j, JointState::Disabled),
        2 => Change::SetState(j, JointState::Enabled),
        3 if temper == Temper::Driven => Change::SetMotor(j, joints::motor(r)),
        _ => {
            let JointPlan { a, b, .. } = plan.joints[j];
            let at = neighbor(r, &plan.bodies[a], &plan.bodies[b]).0;
            let joint = joints::joint(r, plan, [a, b], at, temper);
            let frames = if chance(r, 0.6) { Frames::Present } else { Frames::Kept };
            Change::Redefine(j, Box::new(joint), frames)
        }
    })
}
