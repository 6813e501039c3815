//! Ticks of springs, and what is shown between two of them.

use super::TICK;
use super::collide::{Gap, Surroundings, gap};
use super::rig::{Bone, SpringRig};
use super::tuning::{ALIKE, SLIGHT_DRAG, SNAP};
use sinew_anim::LocalTransform;
use sinew_math::trig::pow;
use sinew_math::{Affine, Mat3, Rotation, Transform, Vec3, direction, max, min, normalize_or};
use sinew_physics::{BodyId, World};

/// Most ticks of one step: what takes longer than a second at once starts over from its last second.
const MOST_TICKS: u32 = 60;
/// Times that a tip is pushed out of the world within a tick: a corner has two sides.
const PUSHES: usize = 2;

/// Input of a step of springs.
#[derive(Clone, Copy)]
pub struct SpringStep<'a> {
    /// Springs of the kind of character.
    pub rig: &'a SpringRig,
    /// Pose at the end of the step as clips or bodies have it, one transform per joint of the rig: what the springs swing about.
    pub pose: &'a [LocalTransform],
    /// From the file's model space to the world at the end of the step.
    pub world_from_model: Affine,
    /// Poses of the ragdoll's bodies in the world at the end of the step, for chains that meet them; else empty.
    pub bodies: &'a [Transform],
    /// The world, and the bodies in it that are the character's own; `None`: nothing to come up against, and no wind.
    pub world: Option<(&'a World, &'a [BodyId])>,
    /// Length of the step, seconds, ≥ 0.
    pub seconds: f32,
}

/// Springs as they swing: the state of one character's.
#[derive(Clone, Debug, Default)]
pub struct SpringSwing {
    /// Nothing has been stepped yet: the first step starts at rest.
    pub(super) started: bool,
    /// Part of a tick that has passed since the last, 0..1.
    pub(super) phase: f32,
    /// Tips at the last tick, and their way in it: metres, in the space of the chain's centre, else of the world.
    pub(super) tips: Vec<Vec3>,
    pub(super) ways: Vec<Vec3>,
    /// Nodes at the end of the last step, in the world; those that swing are not looked at.
    pub(super) before: Vec<Affine>,
    /// The same a step earlier, and the length of that step, seconds: what the way between two poses is bent by.
    pub(super) earlier: Vec<Affine>,
    pub(super) stride: f32,
    /// Local rotation of every bone, as it is shown.
    pub(super) turns: Vec<Rotation>,
    now: Vec<Affine>,
    at: Vec<Affine>,
}

impl SpringSwing {
    /// Springs at rest.
    pub fn new() -> Self {
        Self::default()
    }

    /// Has the next step start at rest, whatever has been before.
    pub fn reset(&mut self) {
        self.started = false;
    }

    /// Takes the springs along to where the character was put, as they are.
    pub fn carry(&mut self, rig: &SpringRig, moved: Transform) {
        if !self.started {
            return;
        }
        let affine = Affine::from(moved);
        self.before.iter_mut().chain(&mut self.earlier).for_each(|node| *node = affine * *node);
        for (index, bone) in rig.bones.iter().enumerate() {
            if rig.chains[bone.chain].center.is_none() {
                self.tips[index] = moved.point(self.tips[index]);
                self.ways[index] = moved.rotation * self.ways[index];
            }
        }
    }

    /// Local rotations of the bones, in the order of [`SpringRig::joints`].
    pub fn turns(&self) -> &[Rotation] {
        &self.turns
    }

    /// Follows the character by a step. Allocates the first time only.
    ///
    /// # Panics
    /// If the pose is not as long as the rig the springs were made from.
    pub fn step(&mut self, step: &SpringStep<'_>) {
        self.look(step);
        if !self.now.iter().all(Affine::is_finite) {
            self.started = false;
        }
        if !self.started {
            return self.rest(step);
        }
        let meets = step.world.map(|(world, own)| Surroundings { world, own });
        let meets = meets.filter(|around| self.are_near(step.rig, around));
        let span = step.seconds / TICK;
        let end = self.phase + span;
        let ticks = (end + SNAP).floor();
        let first = max(ticks - MOST_TICKS as f32, 0.0) as u32 + 1;
        for tick in first..=ticks as u32 {
            let due = tick as f32;
            let share = if end - due < SNAP { 1.0 } else { max((due - self.phase) / span, 0.0) };
            self.advance(step, meets, share, 1.0);
        }
        let phase = end - ticks;
        self.phase = if phase < SNAP { 0.0 } else { phase };
        if self.phase > 0.0 {
            self.advance(step, meets, 1.0, self.phase);
        }
        core::mem::swap(&mut self.earlier, &mut self.before);
        core::mem::swap(&mut self.before, &mut self.now);
        self.stride = step.seconds;
    }

    /// Places of the nodes that do not swing.
    fn look(&mut self, step: &SpringStep<'_>) {
        self.now.clear();
        for node in &step.rig.nodes {
            let parent = node.parent.map_or(step.world_from_model, |parent| self.now[parent]);
            let now = if node.swings { Affine::IDENTITY } else { parent * step.pose[node.joint].to_affine() };
            self.now.push(now);
        }
    }

    /// Starts with every bone at rest.
    fn rest(&mut self, step: &SpringStep<'_>) {
        let count = step.rig.bones.len();
        self.started = self.now.iter().all(Affine::is_finite);
        self.phase = 0.0;
        for list in [&mut self.tips, &mut self.ways] {
            list.clear();
            list.resize(count, Vec3::ZERO);
        }
        self.turns.clear();
        self.turns.extend(step.rig.bones.iter().map(|b| step.pose[step.rig.nodes[b.node].joint].rotation));
        self.at.clone_from(&self.now);
        for (k, node) in step.rig.nodes.iter().enumerate() {
            if node.swings {
                let parent = node.parent.map_or(step.world_from_model, |parent| self.at[parent]);
                self.at[k] = parent * step.pose[node.joint].to_affine();
            }
            if let Some(index) = node.bone {
                let bone = &step.rig.bones[index];
                let tip = self.at[k].point(bone.tail);
                self.tips[index] =
                    self.center(step.rig, bone).map_or(tip, |center| center.inverse().point(tip));
            }
        }
        self.earlier.clone_from(&self.now);
        core::mem::swap(&mut self.before, &mut self.now);
        self.stride = 0.0;
    }

    fn center(&self, rig: &SpringRig, bone: &Bone) -> Option<Affine> {
        rig.chains[bone.chain].center.map(|node| self.at[node])
    }

    /// True if something of the world is where a bone could come.
    fn are_near(&self, rig: &SpringRig, around: &Surroundings<'_>) -> bool {
        let place = |anchor: usize| self.now[anchor].translation;
        let sum = rig.anchors.iter().fold(Vec3::ZERO, |sum, &(anchor, _)| sum + place(anchor));
        let middle = sum / max(rig.anchors.len() as f32, 1.0);
        let reach = |&(anchor, reach): &(usize, f32)| (place(anchor) - middle).length() + reach;
        around.are_near(middle, rig.anchors.iter().map(reach).fold(0.0, max))
    }

    /// Brings the bones from the last tick on by the share `rho` of one; a whole tick is kept. `share` says how far the step has come
    /// by then.
    fn advance(&mut self, step: &SpringStep<'_>, meets: Option<Surroundings<'_>>, share: f32, rho: f32) {
        let ratio = self.stride / step.seconds;
        self.at.clear();
        for ((earlier, before), now) in self.earlier.iter().zip(&self.before).zip(&self.now) {
            self.at.push(between([earlier, before, now], ratio, share));
        }
        if step.rig.swinging_colliders {
            self.turn_all(step, None, 0.0);
        }
        self.turn_all(step, meets, rho);
    }

    fn turn_all(&mut self, step: &SpringStep<'_>, meets: Option<Surroundings<'_>>, rho: f32) {
        for (k, node) in step.rig.nodes.iter().enumerate().filter(|(_, node)| node.swings) {
            let parent = node.parent.map_or(step.world_from_model, |parent| self.at[parent]);
            let mut local = step.pose[node.joint];
            self.at[k] = parent * local.to_affine();
            if let Some(index) = node.bone {
                local.rotation = self.turn(step, meets, index, rho, local.rotation);
                self.turns[index] = local.rotation;
                self.at[k] = parent * local.to_affine();
            }
        }
    }

    /// Local rotation of a bone after the share `rho` of a tick; `at` has its joint at rest.
    fn turn(
        &mut self,
        step: &SpringStep<'_>,
        meets: Option<Surroundings<'_>>,
        index: usize,
        rho: f32,
        rest: Rotation,
    ) -> Rotation {
        let bone = &step.rig.bones[index];
        let joint = self.at[bone.node];
        let along = joint.vector(bone.tail);
        let Some(axis) = direction(along) else { return rest };
        let center = self.center(step.rig, bone);
        let tip = center.map_or(self.tips[index], |center| center.point(self.tips[index]));
        let way = center.map_or(self.ways[index], |center| center.vector(self.ways[index]));
        let wind = step.world.map_or(Vec3::ZERO, |(world, _)| world.air_velocity(joint.translation));
        let force = axis * bone.stiffness + bone.gravity + wind * bone.drag;
        let held = Held {
            joint: &joint,
            joint_from_world: joint.linear.inverse(),
            length: along.length(),
            axis,
            bone,
        };
        let around = Around { swing: self, step, meets, index, held: &held };
        let mut next = if rho > 0.0 {
            let whole = around.tick(tip, way, force * TICK);
            if rho < 1.0 { around.part(tip, way, whole, rho) } else { whole }
        } else {
            held.hold(tip)
        };
        let mut to = normalize_or(held.joint_from_world * (next - joint.translation), bone.axis);
        if !(next.is_finite() && to.is_finite()) {
            // What numbers cannot hold starts over at rest.
            next = joint.point(bone.tail);
            to = bone.axis;
        }
        if rho == 1.0 {
            let tip = center.map_or(next, |center| center.inverse().point(next));
            self.ways[index] = tip - self.tips[index];
            self.tips[index] = tip;
        }
        (rest * Rotation::from_arc(bone.axis, to)).normalize()
    }
}

/// A bone with all that holds its tip or pushes it.
struct Around<'a> {
    swing: &'a SpringSwing,
    step: &'a SpringStep<'a>,
    meets: Option<Surroundings<'a>>,
    index: usize,
    held: &'a Held<'a>,
}

impl Around<'_> {
    /// Place of the tip a tick on, from where and on which way it is, pushed by `push` a tick.
    fn tick(&self, tip: Vec3, way: Vec3, push: Vec3) -> Vec3 {
        let [keeps, pushed] = flight(self.held.bone.drag, 1.0);
        self.push_out(self.held.hold(tip + (way * keeps + push * pushed)), None)
    }

    /// Place of the tip the share `rho` of a tick on, which leads to `whole`: what holds and pushes it acts as evenly in time as its spring
    /// does, so that a tip at rest is where it is. Colliders let it as deep into them as they let it at the end of the tick.
    fn part(&self, tip: Vec3, way: Vec3, whole: Vec3, rho: f32) -> Vec3 {
        let drag = self.held.bone.drag;
        let acts = whole - tip - way * flight(drag, 1.0)[0];
        let [keeps, pushed] = flight(drag, rho);
        self.push_out(self.held.hold(tip + (way * keeps + acts * pushed)), Some(whole))
    }

    /// Out of every collider, one after the other; where a place is given, only as far as that one is.
    fn push_out(&self, mut next: Vec3, as_far_as: Option<Vec3>) -> Vec3 {
        let (rig, bone) = (self.step.rig, self.held.bone);
        let depth = |gap: &dyn Fn(Vec3) -> Gap| as_far_as.map_or(0.0, |there| min(gap(there).distance, 0.0));
        for &collider in &rig.chains[bone.chain].colliders {
            let collider = &rig.colliders[collider];
            let gap = |tip| gap(&collider.shape, &self.swing.at[collider.node], tip, bone.radius);
            next = self.held.out_of(gap(next), depth(&gap), next);
        }
        for (body, (shape, frame)) in rig.bodies.iter().zip(self.step.bodies).enumerate() {
            if rig.meets[self.index] >> body & 1 == 1 {
                let gap = |tip| {
                    let (distance, direction) = shape.signed_distance(frame, tip);
                    Gap { direction, distance: distance - bone.radius }
                };
                next = self.held.out_of(gap(next), depth(&gap), next);
            }
        }
        let Some(meets) = self.meets else { return next };
        let free = Gap { direction: Vec3::Y, distance: 0.0 };
        for _ in 0..PUSHES {
            match meets.gap(next, bone.radius) {
                Some(gap) if gap.distance < 0.0 => {
                    let depth = depth(&|tip| meets.gap(tip, bone.radius).unwrap_or(free));
                    next = self.held.out_of(gap, depth, next);
                }
                _ => break,
            }
        }
        next
    }
}

/// Hold of a joint on the tip of its bone.
struct Held<'a> {
    joint: &'a Affine,
    joint_from_world: Mat3,
    /// Metres.
    length: f32,
    /// Direction at rest, world.
    axis: Vec3,
    bone: &'a Bone,
}

impl Held<'_> {
    /// The nearest place at the bone's length, in a direction that its limit allows.
    fn hold(&self, tip: Vec3) -> Vec3 {
        let from = self.joint.translation;
        let mut direction = normalize_or(tip - from, self.axis);
        if let Some(limit) = &self.bone.limit {
            let seen = normalize_or(self.joint_from_world * direction, self.bone.axis);
            let held = limit.hold(seen);
            if held != seen {
                direction = normalize_or(self.joint.vector(held), self.axis);
            }
        }
        from + direction * self.length
    }

    /// Out of a collider until it is no deeper in it than `depth`, ≤ 0.
    fn out_of(&self, gap: Gap, depth: f32, tip: Vec3) -> Vec3 {
        let by = gap.distance - depth;
        if by < 0.0 { self.hold(tip - gap.direction * by) } else { tip }
    }
}

/// Way of a free tip in the share `rho` of a tick, as shares of its way in the tick before and of what pushes it in a tick.
fn flight(drag: f32, rho: f32) -> [f32; 2] {
    let keeps = 1.0 - drag;
    if rho == 1.0 {
        return [keeps, 1.0];
    }
    if drag < SLIGHT_DRAG {
        return [keeps * rho, 0.5 * rho * (rho + 1.0)];
    }
    let slowed = if keeps > 0.0 { keeps * (1.0 - pow(keeps, rho)) / drag } else { 0.0 };
    [slowed, (rho - slowed) / drag]
}

/// Place of a node at a share of the step from the second place to the third, on the parabola through all three; `ratio` is the length
/// of the step before over this one's. Columns keep their lengths, for bones do.
fn between([a, b, c]: [&Affine; 3], ratio: f32, share: f32) -> Affine {
    if share == 1.0 {
        return *c;
    }
    // Steps of wholly different lengths tell nothing of the way's bend.
    let is_alike = ratio > 1.0 / ALIKE && ratio < ALIKE;
    let bend = if is_alike { share * (share - 1.0) / (1.0 + ratio) } else { 0.0 };
    let ratio = if is_alike { ratio } else { 1.0 };
    let point = |a: Vec3, b: Vec3, c: Vec3| {
        let way = c - b;
        b + way * share + (way - (b - a) / ratio) * bend
    };
    let column = |a: Vec3, b: Vec3, c: Vec3| {
        let length = b.length() * (1.0 - share) + c.length() * share;
        normalize_or(point(a, b, c), Vec3::ZERO) * length
    };
    let (l, m, n) = (&a.linear, &b.linear, &c.linear);
    Affine {
        linear: Mat3::from_cols(
            column(l.x_axis, m.x_axis, n.x_axis),
            column(l.y_axis, m.y_axis, n.y_axis),
            column(l.z_axis, m.z_axis, n.z_axis),
        ),
        translation: point(a.translation, b.translation, c.translation),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_a_tick_leads_to_the_whole() {
        let (way, push) = (Vec3::new(0.03, -0.01, 0.02), Vec3::new(0.0, 0.016, -0.004));
        for drag in [0.0, 5e-4, 0.01, 0.4, 0.9, 1.0] {
            let flight = |way: Vec3, push: Vec3, drag, rho| {
                let [keeps, pushed] = flight(drag, rho);
                way * keeps + push * pushed
            };
            let near = flight(way, push, drag, 0.999_999);
            let whole = flight(way, push, drag, 1.0);
            assert!((near - whole).length() < 1e-4 * (1.0 + drag) * 0.1, "drag {drag}: {near} {whole}");
            assert_eq!(flight(way, push, drag, 0.0), Vec3::ZERO);
        }
        // Free flight against drag, closed form: half a tick twice is a tick, where nothing pushes.
        let [half, _] = flight(0.64, 0.5);
        assert!((half - 0.36 * 0.4 / 0.64).abs() < 1e-7, "{half}");
    }
}
