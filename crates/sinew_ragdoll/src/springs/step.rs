//! Ticks of springs, and interpolation between two of them.

use super::TICK;
use super::collide::{Placed, Surroundings};
use super::rig::{Bone, Node, SpringRig};
use super::tip::{Around, Held};
use super::tuning::{ALIKE, LINK_SWEEPS, SNAP};
use sinew_anim::LocalTransform;
use sinew_math::{Affine, Mat3, Rotation, Transform, Vec3, max, normalize_or};
use sinew_physics::{BodyId, World};

/// Largest number of ticks in one step: a longer step restarts from its last second.
const MOST_TICKS: u32 = 60;

/// Input of a step of springs.
#[derive(Clone, Copy)]
pub struct SpringStep<'a> {
    /// Springs of the kind of character.
    pub rig: &'a SpringRig,
    /// Pose at the end of the step from clips or bodies, one transform per joint of the rig; the springs swing about
    /// this pose.
    pub pose: &'a [LocalTransform],
    /// Transform from the file's model space to the world at the end of the step.
    pub world_from_model: Affine,
    /// World poses of the ragdoll's bodies at the end of the step, for chains that collide with bodies; otherwise
    /// empty.
    pub bodies: &'a [Transform],
    /// The world, and the character's own bodies in this world; `None`: no collisions with the world, and no wind.
    pub world: Option<(&'a World, &'a [BodyId])>,
    /// Length of the step, seconds.
    pub seconds: f32,
}

/// Motion of springs about the pose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Mode {
    /// The springs have not been stepped yet: the first step starts at rest.
    #[default]
    Fresh,
    Swinging,
    /// The springs are distant: their rotation from the pose decays.
    Easing,
    /// The springs equal the pose, and nothing is computed.
    Away,
}

/// State of one character's springs.
#[derive(Clone, Debug, Default)]
pub struct SpringSwing {
    pub(super) mode: Mode,
    /// Share of a tick that has passed since the last one, 0..1.
    pub(super) phase: f32,
    /// Tips at the last tick, and their displacement in it: metres, in the space of the chain's centre, or of the world
    /// without a centre.
    pub(super) tips: Vec<Vec3>,
    pub(super) ways: Vec<Vec3>,
    /// World transforms at the end of the last step of the nodes that do not swing.
    pub(super) before: Vec<Affine>,
    /// Transforms of the non-swinging nodes one step earlier, and the length of that step, seconds. They give the
    /// curvature of the path between two poses.
    pub(super) earlier: Vec<Affine>,
    pub(super) stride: f32,
    /// Local rotation of every bone, as shown.
    pub(super) turns: Vec<Rotation>,
    /// Rotation of every bone from the pose while the springs ease, scaled axis.
    pub(super) offsets: Vec<Vec3>,
    pub(super) now: Vec<Affine>,
    /// Transforms of all nodes at the time of a tick, and the colliders on these nodes.
    pub(super) at: Vec<Affine>,
    placed: Vec<Placed>,
    /// Transforms of the non-swinging nodes at the tick before, and the displacement of each collider since then;
    /// `None` on swinging nodes.
    last: Vec<Affine>,
    moved: Vec<Option<Affine>>,
    /// Displacement that links cause at each tip per tick, metres.
    pulls: Vec<Vec3>,
}

impl SpringSwing {
    /// Creates springs at rest.
    pub fn new() -> Self {
        Self::default()
    }

    /// Makes the springs restart at rest in the next step.
    pub fn reset(&mut self) {
        self.mode = Mode::Fresh;
    }

    /// Moves the springs with a character that was teleported, without changing their shape.
    pub fn carry(&mut self, rig: &SpringRig, moved: Transform) {
        if self.mode != Mode::Swinging {
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

    /// Scales the springs with a character that was scaled by `factor` about a world position, metres.
    pub fn resize(&mut self, rig: &SpringRig, about: Vec3, factor: f32) {
        if self.mode != Mode::Swinging {
            return;
        }
        let larger = |at: Vec3| about + (at - about) * factor;
        for node in self.before.iter_mut().chain(&mut self.earlier) {
            let l = &node.linear;
            let linear = Mat3::from_cols(l.x_axis * factor, l.y_axis * factor, l.z_axis * factor);
            *node = Affine { linear, translation: larger(node.translation) };
        }
        for (index, bone) in rig.bones.iter().enumerate() {
            // The space of a centre is scaled with the character.
            if rig.chains[bone.chain].center.is_none() {
                self.tips[index] = larger(self.tips[index]);
                self.ways[index] *= factor;
            }
        }
    }

    /// Returns the local rotations of the bones, in the order of [`SpringRig::joints`]; empty while they equal the
    /// pose.
    pub fn turns(&self) -> &[Rotation] {
        &self.turns
    }

    /// Moves the springs with the character by a step, from rest in the first step; a step of zero length changes
    /// nothing. Allocates only in the first step.
    ///
    /// # Panics
    /// If the pose does not have one transform per joint of the springs' rig.
    pub fn step(&mut self, step: &SpringStep<'_>) {
        self.look(step);
        if !self.now.iter().all(Affine::is_finite) {
            self.mode = Mode::Fresh;
        }
        if self.mode != Mode::Swinging {
            return self.rest(step);
        }
        // A step of zero length (a pause) does not change the motion.
        if step.seconds == 0.0 {
            return;
        }
        let meets = step.world.map(|(world, own)| Surroundings { world, own });
        let meets = meets.filter(|around| self.are_near(step.rig, around));
        let span = step.seconds / TICK;
        let end = self.phase + span;
        let ticks = (end + SNAP).floor();
        self.look_back();
        let first = max(ticks - MOST_TICKS as f32, 0.0) as u32 + 1;
        for tick in first..=ticks as u32 {
            let due = tick as f32;
            let share = if end - due < SNAP { 1.0 } else { max((due - self.phase) / span, 0.0) };
            self.advance(step, meets, share, 1.0);
            self.last.copy_from_slice(&self.at[..step.rig.stills]);
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

    /// Computes the positions of the non-swinging nodes at the last tick, on the line through the ends of the last two
    /// steps.
    fn look_back(&mut self) {
        let back = if self.stride > 0.0 { self.phase * TICK / self.stride } else { 0.0 };
        self.last.clear();
        for (earlier, before) in self.earlier.iter().zip(&self.before) {
            let column = |a: Vec3, b: Vec3| b - (b - a) * back;
            let (a, b) = (&earlier.linear, &before.linear);
            let linear = Mat3::from_cols(
                column(a.x_axis, b.x_axis),
                column(a.y_axis, b.y_axis),
                column(a.z_axis, b.z_axis),
            );
            self.last.push(Affine { linear, translation: column(earlier.translation, before.translation) });
        }
    }

    /// Computes the positions of the non-swinging nodes.
    pub(super) fn look(&mut self, step: &SpringStep<'_>) {
        self.now.clear();
        for node in &step.rig.nodes[..step.rig.stills] {
            let parent = node.parent.map_or(step.world_from_model, |parent| self.now[parent]);
            self.now.push(parent * step.pose[node.joint].to_affine());
        }
    }

    /// Puts every bone at rest.
    fn rest(&mut self, step: &SpringStep<'_>) {
        let rig = step.rig;
        self.turns.clear();
        self.turns.extend(rig.joints().map(|joint| step.pose[joint].rotation));
        self.place_all(rig, step.world_from_model, |node| step.pose[node.joint]);
        self.mode = if self.now.iter().all(Affine::is_finite) { Mode::Swinging } else { Mode::Fresh };
        self.phase = 0.0;
        self.tips.clear();
        for index in 0..rig.bones.len() {
            let tip = self.placed_tip(rig, index);
            self.tips.push(tip);
        }
        self.ways.clear();
        self.ways.resize(rig.bones.len(), Vec3::ZERO);
        self.earlier.clone_from(&self.now);
        core::mem::swap(&mut self.before, &mut self.now);
        self.stride = 0.0;
    }

    /// Moves all nodes to a pose.
    pub(super) fn place_all(
        &mut self,
        rig: &SpringRig,
        root: Affine,
        local: impl Fn(&Node) -> LocalTransform,
    ) {
        self.at.clear();
        for node in &rig.nodes {
            let parent = node.parent.map_or(root, |parent| self.at[parent]);
            self.at.push(parent * local(node).to_affine());
        }
    }

    /// Returns the position of a tip for the new transform of its node, in the space of its chain's centre.
    pub(super) fn placed_tip(&self, rig: &SpringRig, index: usize) -> Vec3 {
        let bone = &rig.bones[index];
        let tip = self.at[bone.node].point(bone.tail);
        self.center(rig, bone).map_or(tip, |center| center.inverse().point(tip))
    }

    fn center(&self, rig: &SpringRig, bone: &Bone) -> Option<&Affine> {
        rig.chains[bone.chain].center.map(|node| &self.at[node])
    }

    /// Returns true if some part of the world is within reach of a bone.
    fn are_near(&self, rig: &SpringRig, around: &Surroundings<'_>) -> bool {
        let place = |anchor: usize| self.now[anchor].translation;
        let sum = rig.anchors.iter().fold(Vec3::ZERO, |sum, &(anchor, _)| sum + place(anchor));
        let middle = sum / max(rig.anchors.len() as f32, 1.0);
        let reach = |&(anchor, reach): &(usize, f32)| (place(anchor) - middle).length() + reach;
        around.are_near(middle, rig.anchors.iter().map(reach).fold(0.0, max))
    }

    /// Advances the bones from the last tick by the share `rho` of a tick; a whole tick is stored. `share` is the
    /// elapsed share of the step.
    fn advance(&mut self, step: &SpringStep<'_>, meets: Option<Surroundings<'_>>, share: f32, rho: f32) {
        let ratio = self.stride / step.seconds;
        let rig = step.rig;
        self.at.resize(rig.nodes.len(), Affine::IDENTITY);
        for (k, at) in self.at[..rig.stills].iter_mut().enumerate() {
            *at = between([&self.earlier[k], &self.before[k], &self.now[k]], ratio, share);
        }
        if rig.swinging_colliders {
            self.placed.clear();
            self.turn_all(step, None, 0.0);
        }
        self.placed.clear();
        let placed =
            rig.colliders.iter().map(|collider| Placed::new(&collider.shape, &self.at[collider.node]));
        self.placed.extend(placed);
        self.moved.clear();
        let still = |node: usize| (node < rig.stills).then(|| self.at[node] * self.last[node].inverse());
        self.moved.extend(rig.colliders.iter().map(|collider| still(collider.node)));
        self.pull(rig);
        self.turn_all(step, meets, rho);
    }

    /// Rotates all swinging nodes. Tips collide with the colliders that are already placed.
    fn turn_all(&mut self, step: &SpringStep<'_>, meets: Option<Surroundings<'_>>, rho: f32) {
        let rig = step.rig;
        for (k, node) in rig.nodes.iter().enumerate().skip(rig.stills) {
            let local = &step.pose[node.joint];
            let parent = node.parent.map_or(&step.world_from_model, |parent| &self.at[parent]);
            let mut turn = local.rotation;
            let mut moved = None;
            let place = parent.point(local.translation);
            if let Some(index) = node.bone {
                let bone = &rig.bones[index];
                let held = Held::new(bone, local, &parent.linear, place);
                if held.has_length() {
                    let next = self.next(step, meets, index, rho, &held);
                    turn = held.turn_to(next);
                    moved = Some(next);
                }
            }
            let linear =
                if node.carries { parent.linear * scaled(turn, local.scale) } else { Mat3::IDENTITY };
            if let Some(index) = node.bone {
                self.turns[index] = turn;
                if let Some(next) = moved.filter(|_| rho == 1.0) {
                    self.keep(rig, index, next);
                }
            }
            if node.carries {
                self.at[k] = Affine { linear, translation: place };
                if rig.swinging_colliders {
                    self.place_on(rig, k);
                }
            }
        }
    }

    /// Places the colliders of a swinging node.
    fn place_on(&mut self, rig: &SpringRig, node: usize) {
        for (placed, collider) in self.placed.iter_mut().zip(&rig.colliders) {
            if collider.node == node {
                *placed = Placed::new(&collider.shape, &self.at[node]);
            }
        }
    }

    /// Returns the position of a tip after the share `rho` of a tick.
    #[inline]
    fn next(
        &self,
        step: &SpringStep<'_>,
        meets: Option<Surroundings<'_>>,
        index: usize,
        rho: f32,
        held: &Held<'_>,
    ) -> Vec3 {
        let bone = held.bone;
        let (mut tip, mut way) = (self.tips[index], self.ways[index]);
        if let Some(center) = self.center(step.rig, bone) {
            (tip, way) = (center.point(tip), center.vector(way));
        }
        if rho == 0.0 {
            return held.hold(tip, Vec3::ZERO);
        }
        let wind = step.world.map_or(Vec3::ZERO, |(world, _)| world.air_velocity(held.place));
        let force = held.axis * bone.stiffness + bone.gravity + wind * bone.drag;
        let push = force * TICK + self.pulls.get(index).copied().unwrap_or(Vec3::ZERO);
        let from = self.last_place(step.rig, index, tip);
        let around = Around { placed: &self.placed, moved: &self.moved, step, meets, index, held };
        let whole = around.tick(tip, from, way, push);
        let next = if rho < 1.0 { around.part(tip, way, whole, rho) } else { whole };
        // A non-finite state restarts at rest.
        if next.is_finite() { next } else { held.rest() }
    }

    /// Returns the world position of a tip at the last tick; `tip` has moved with the chain's centre since.
    #[inline]
    fn last_place(&self, rig: &SpringRig, index: usize, tip: Vec3) -> Vec3 {
        match rig.chains[rig.bones[index].chain].center {
            Some(center) if center < rig.stills => self.last[center].point(self.tips[index]),
            _ => tip,
        }
    }

    /// Applies the links' pull to the tips at their predicted positions.
    fn pull(&mut self, rig: &SpringRig) {
        self.pulls.clear();
        if rig.links.is_empty() {
            return;
        }
        // The vectors contain the predicted positions first, and the displacement from them at the end.
        for (index, bone) in rig.bones.iter().enumerate() {
            let free = self.tips[index] + self.ways[index] * (1.0 - bone.drag);
            self.pulls.push(self.center(rig, bone).map_or(free, |center| center.point(free)));
        }
        for _ in 0..LINK_SWEEPS {
            for link in &rig.links {
                let [a, b] = link.bones;
                let apart = self.pulls[b] - self.pulls[a];
                let length = apart.length();
                let beyond = length - link.length;
                if beyond > 0.0 || (link.holds_apart && beyond < 0.0) {
                    let by = apart * (0.5 * link.share * beyond / max(length, f32::MIN_POSITIVE));
                    self.pulls[a] += by;
                    self.pulls[b] -= by;
                }
            }
        }
        for (index, bone) in rig.bones.iter().enumerate() {
            let free = self.tips[index] + self.ways[index] * (1.0 - bone.drag);
            let free = self.center(rig, bone).map_or(free, |center| center.point(free));
            self.pulls[index] -= free;
        }
    }

    /// Stores the position of a tip after a whole tick.
    #[inline]
    fn keep(&mut self, rig: &SpringRig, index: usize, next: Vec3) {
        let tip = self.center(rig, &rig.bones[index]).map_or(next, |center| center.inverse().point(next));
        self.ways[index] = tip - self.tips[index];
        self.tips[index] = tip;
    }
}

/// Returns the matrix of a rotation after a scale.
#[inline]
fn scaled(turn: Rotation, scale: Vec3) -> Mat3 {
    let m = turn.to_mat3();
    if scale == Vec3::ONE {
        return m;
    }
    Mat3::from_cols(m.x_axis * scale.x, m.y_axis * scale.y, m.z_axis * scale.z)
}

/// Returns the position of a node at a share of the step from the second position to the third, on the parabola through
/// all three positions; `ratio` is the previous step's length over this step's. Columns keep their lengths, because
/// bones do.
fn between([a, b, c]: [&Affine; 3], ratio: f32, share: f32) -> Affine {
    if share == 1.0 {
        return *c;
    }
    // If the step lengths differ strongly, the curvature is unknown.
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
