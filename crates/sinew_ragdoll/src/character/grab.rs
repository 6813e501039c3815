//! Grips on the limbs of others, and on whatever forces move: they take hold where they touch, pull no harder than they may, and let go.
//!
//! A grip is a joint with a motor that holds one point of what is held, as stiff as its force is reached at a hundredth of a metre.

use super::Character;
use super::memory::Hold;
use super::tuning::{GRIP_SHARE, GRIP_STRETCH, PARTED};
use crate::owner::together;
use sinew_math::{ReadError, Reader, Rotation, Transform, Vec3, Writer, max, min};
use sinew_physics::boxes::Overlap;
use sinew_physics::{
    Aabb, BodyId, BodyKind, Gains, JointDef, JointId, JointKind, JointState, Motor, SixDof, Softness,
    Velocity, World,
};

/// A way to grab something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grab {
    /// Most force of the grip, N. Default 1300: what drags a man at a walk.
    pub max_force: f32,
    /// Farthest that the surface of what is grabbed may be from the middle of the hand, or from the point, metres. Default 0.25.
    pub reach: f32,
    /// Distance by which the grip slips at its full force before it lets go, metres; of a [`GrabPoint`](super::GrabPoint) the distance from its target.
    /// Default 0.4.
    pub slip: f32,
    /// Point in the frame of the hand's body to which it draws what it holds, at `speed`; `None`: to the hand's surface, where what touches it stays. Default `None`.
    pub to: Option<Vec3>,
    /// Speed at which it draws what it holds, and at which a [`GrabPoint`](super::GrabPoint) moves, m/s. Default 1.
    pub speed: f32,
    /// It lets go when its character goes limp. Default true.
    pub drops: bool,
}

impl Grab {
    /// Grip of a hand.
    pub const HAND: Self =
        Self { max_force: 1300.0, reach: 0.25, slip: 0.4, to: None, speed: 1.0, drops: true };
    /// Grip of a point that a person moves, a mouse's: at most at 2.5 m/s, and it never lets go by itself.
    pub const POINT: Self = Self { slip: f32::INFINITY, speed: 2.5, ..Self::HAND };

    /// # Panics
    /// If a number makes no sense.
    #[track_caller]
    pub(super) fn check(&self) {
        let positive = |x: f32| x > 0.0 && x < f32::INFINITY;
        assert!(positive(self.max_force), "a grip's force is positive and finite, not {}", self.max_force);
        assert!(positive(self.speed), "a grip's speed is positive and finite, not {}", self.speed);
        assert!(self.reach >= 0.0, "a grip's reach is not negative, not {}", self.reach);
        assert!(self.slip > 0.0, "a grip's slip is positive, not {}", self.slip);
        assert!(self.to.is_none_or(Vec3::is_finite), "a grip draws to a finite point, not {:?}", self.to);
    }
}

impl Default for Grab {
    fn default() -> Self {
        Self::HAND
    }
}

/// A grip that holds. Points are seen from the anchor on the hand, in the axes of the hand's body, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grasp {
    /// Where it is to hold.
    pub goal: Vec3,
    /// From there to where it holds now, world axes: what is drawn to a hand from afar does not turn with it.
    pub off: Vec3,
    /// Anchors on the hand's body and on what is held, in their frames.
    anchors: [Vec3; 2],
    max_force: f32,
    slip: f32,
    speed: f32,
    /// N·s/m.
    damping: f32,
}

impl Grasp {
    /// Point of `held` at which a hand at `palm` takes hold, world; `None` where it does not reach.
    pub fn touch(world: &World, held: BodyId, palm: Vec3, reach: f32) -> Option<Vec3> {
        let surface = world.nearest_surface(held, palm)?;
        let point = if surface.distance <= 0.0 { palm } else { surface.point };
        (surface.distance <= reach).then_some(point)
    }

    /// Joins two bodies at `point` of the one that is held, which is drawn to `to`; world.
    pub fn take(
        world: &mut World,
        [hand, held]: [BodyId; 2],
        [point, to]: [Vec3; 2],
        grab: &Grab,
    ) -> (Self, JointId) {
        let [place, of_held] = [hand, held].map(|body| world.transform(body));
        let anchors = [place.inverse_point(point), of_held.inverse_point(point)];
        let moving = [held, hand].into_iter().filter(|&body| world.kind(body) == BodyKind::Dynamic);
        let mass = moving.map(|body| world.mass(body).mass).fold(f32::INFINITY, min);
        let grasp = Self {
            goal: place.inverse_point(to) - anchors[0],
            off: point - to,
            anchors,
            max_force: grab.max_force,
            slip: grab.slip,
            speed: grab.speed,
            damping: 2.0 * (grab.max_force / GRIP_STRETCH * mass).sqrt(),
        };
        let [frame_a, frame_b] = anchors.map(Transform::from_translation);
        let def = JointDef::between(hand, held, frame_a, frame_b, JointKind::SixDof(SixDof::FREE));
        let joint = world.add_joint(&grasp.pulling(&def, Vec3::ZERO, Vec3::ZERO, Vec3::ZERO));
        (grasp, joint)
    }

    /// Pulls through the next step; `leads`: the point that it holds stays near what it holds, which is not dragged behind. False: it lets go.
    pub fn pull(&mut self, world: &mut World, joint: JointId, leads: bool) -> bool {
        let (dt, def) = (world.def().dt(), world.joint(joint));
        let held = def.frame_a.rotation * world.joint_transform(joint).translation;
        let world_from_hand = world.transform(def.body_a).rotation;
        let before = self.off;
        self.off -= before * min(self.speed * dt / max(before.length(), 1e-9), 1.0);
        let hand_from_world = world_from_hand.inverse();
        let velocity = hand_from_world * ((self.off - before) / dt);
        let mut at = self.goal + hand_from_world * self.off;
        let gap = held - if leads { self.goal } else { at };
        if gap.length() > self.slip {
            return false;
        }
        if leads {
            at = near(at, held);
            self.off = world_from_hand * (at - self.goal);
        }
        world.set_joint(joint, &self.pulling(&def, at, held, velocity));
        true
    }

    /// Has it go to another place, seen from the anchor on a hand that is not turned.
    pub fn lead(&mut self, goal: Vec3) {
        self.off += self.goal - goal;
        self.goal = goal;
    }

    /// The joint as it pulls what is held at a point; `velocity`: of where that is to be.
    ///
    /// Each axis has a cap of its own. The axes lie about the pull, all at the same angle to it: together they give the force, and no more in any direction.
    fn pulling(&self, def: &JointDef, at: Vec3, held: Vec3, velocity: Vec3) -> JointDef {
        let gap = at - held;
        let (about, mut turn) = (Vec3::splat(THIRD), def.frame_a.rotation);
        if gap.length() > LEAST_GAP && (turn * about).dot(gap) < LEAST_ALONG * gap.length() {
            turn = Rotation::from_arc(about, gap.normalize());
        }
        let back = turn.inverse();
        let softness =
            Softness::Stiffness { stiffness: self.max_force / GRIP_STRETCH, damping: self.damping };
        let motor = Motor {
            gains: Gains::Position(softness),
            target: Transform::from_translation(back * near(at, held)),
            velocity: Velocity { linear: back * velocity, angular: Vec3::ZERO },
            max_force: self.max_force * (GRIP_SHARE * THIRD),
            max_torque: 0.0,
        };
        let [hand, held] = self.anchors;
        JointDef {
            frame_a: Transform::new(hand, turn),
            frame_b: Transform::from_translation(held),
            motor: Some(motor),
            ..*def
        }
    }

    pub fn save(&self, w: &mut Writer) {
        let [hand, held] = self.anchors;
        [self.goal, self.off, hand, held].into_iter().for_each(|v| w.vec3(v));
        [self.max_force, self.slip, self.speed, self.damping].into_iter().for_each(|x| w.f32(x));
    }

    pub fn load(r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let (goal, off, anchors) = (r.vec3()?, r.vec3()?, [r.vec3()?, r.vec3()?]);
        let (max_force, slip, speed, damping) = (r.f32()?, r.f32()?, r.f32()?, r.f32()?);
        let positive = |x: f32| x > 0.0 && x < f32::INFINITY;
        let numbers = positive(max_force) && positive(speed) && damping >= 0.0 && damping < f32::INFINITY;
        if !(numbers && slip > 0.0 && [goal, off, anchors[0], anchors[1]].into_iter().all(Vec3::is_finite)) {
            return Err(r.error("a grip whose numbers make no sense"));
        }
        Ok(Self { goal, off, anchors, max_force, slip, speed, damping })
    }
}

/// Gap below which it has no direction, metres.
const LEAST_GAP: f32 = 1e-4;
/// Cosine of the angle between the pull and where the axes lie from which on they are laid anew.
const LEAST_ALONG: f32 = 0.98;
/// Each component of a direction at the same angle to all axes.
const THIRD: f32 = 0.577_350_26;

/// Bounds of bodies, with room for a step.
fn around(world: &World, bodies: &[BodyId]) -> Option<Aabb> {
    let bounds = bodies.iter().map(|&body| world.bounds(body)).reduce(|a, b| a.merge(&b))?;
    let room = Vec3::splat(PARTED);
    Some(Aabb { min: bounds.min - room, max: bounds.max + room })
}

/// The point nearest to `at` to which a grip stretches at its full force.
fn near(at: Vec3, held: Vec3) -> Vec3 {
    let gap = at - held;
    held + gap * min(GRIP_STRETCH / max(gap.length(), 1e-9), 1.0)
}

impl Character {
    /// Has one of its bodies (by role or bone) take hold of a body of the world: another's limb, a crate. It holds the point of its surface that is nearest
    /// to the hand, where that is, so that nothing snaps, and draws what is not yet at the hand there at [`speed`](Grab::speed); what is held turns freely about the point. From then on it drags and lifts with
    /// [`max_force`](Grab::max_force), and lets go where that does not do: [`CharacterEvent::LetGo`](super::CharacterEvent::LetGo). [`release`](Self::release) lets go
    /// at once. What is held passes through the character's own bodies, and through movers.
    ///
    /// Forces must move one of the two: a hand that clips lead drags what is limp or powered. Who is held stays limp, and does not get up.
    ///
    /// `None` if what is to be grabbed is out of reach, its own, held by it already, or no force moves either of them; or if it has no such body
    /// in the world, since that was cut off or it has none at all.
    ///
    /// ```
    /// use sinew_math::{Rotation, Transform, Vec3};
    /// use sinew_physics::{BodyDef, Shape, World, WorldDef};
    /// use sinew_ragdoll::{Character, Grab};
    /// use std::sync::Arc;
    ///
    /// let mut world = World::new(WorldDef::default());
    /// world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    /// let def = Arc::new(sinew::mannequin::character());
    /// let mut hero = Character::spawn(&mut world, &def, Transform::IDENTITY);
    /// let mut other = Character::spawn(&mut world, &def, Transform::from_translation(Vec3::X * 0.5));
    /// other.go_limp(&mut world);
    /// let wrist = other.bodies()[def.body_named("rightLowerArm").expect("it has one")];
    /// let grab = Grab { reach: 0.5, ..Grab::HAND };
    /// let grip = hero.grab(&mut world, "leftHand", wrist, &grab).expect("it is in reach");
    /// for _ in 0..60 {
    ///     world.step();
    ///     hero.update(&mut world);
    ///     other.update(&mut world);
    ///     assert!(!world.contains_joint(grip) || world.reaction(grip).force.length() < 1.05 * grab.max_force);
    /// }
    /// ```
    ///
    /// # Panics
    /// If no body is called so, or a number of the grip makes no sense.
    pub fn grab(&mut self, world: &mut World, bone: &str, held: BodyId, grab: &Grab) -> Option<JointId> {
        grab.check();
        let body = self.def.body_named(bone).unwrap_or_else(|| panic!("no body is called '{bone}'"));
        let hand = *self.bodies().get(body).filter(|_| self.has_body(body))?;
        let moves = |body: BodyId| world.kind(body) == BodyKind::Dynamic;
        let is_own = self.body_index(held).is_some() || self.held().any(|other| other == held);
        if self.presence.is_none() || is_own || !(moves(hand) || moves(held)) {
            return None;
        }
        let point = Grasp::touch(world, held, world.center_of_mass(hand), grab.reach)?;
        self.set_passes(world, held, true);
        let to = match grab.to {
            Some(to) => world.transform(hand).point(to),
            None => Grasp::touch(world, hand, point, f32::INFINITY).unwrap_or(point),
        };
        let (grasp, joint) = Grasp::take(world, [hand, held], [point, to], grab);
        let hold = Hold { held, joint, body: body as u32, drops: grab.drops, grasp: Some(grasp) };
        self.presence.as_mut().expect("it is in the world").holds.push(hold);
        Some(joint)
    }

    /// True if a hand, a grip or a joint holds one of its bodies that is not its own: another character's, or one that no force moves.
    pub(super) fn is_gripped(&self, world: &World) -> bool {
        let own = self.own();
        own.iter().any(|&body| {
            // Those of ragdolls have owners.
            world.joints_of(body).filter(|&joint| world.joint_owner(joint).is_none()).any(|joint| {
                let (a, b) = world.joint_bodies(joint);
                let other = if a == body { b } else { a };
                let holds = world.kind(other) != BodyKind::Dynamic || world.body_owner(other).is_some();
                let is_others = !own.contains(&other) && !self.is_own_joint(joint);
                holds && is_others && world.joint(joint).state == JointState::Enabled
            })
        })
    }

    /// True of pins of its drives, and of what it holds itself.
    fn is_own_joint(&self, joint: JointId) -> bool {
        let holds = self.presence.iter().flat_map(|presence| &presence.holds);
        self.drives.is_pin(joint) || holds.into_iter().any(|hold| hold.joint == joint)
    }

    /// True of a body through which its own pass because it hangs on what it holds, or has let go of.
    pub(super) fn passes_through(&self, world: &World, body: BodyId) -> bool {
        let mut all = self.held().chain(self.freed.iter().copied()).filter(|&held| world.contains(held));
        all.any(|held| held == body || together(world, held).contains(&body))
    }

    /// Has its bodies collide with what it let go of, as soon as the two are apart.
    pub(super) fn mind_freed(&mut self, world: &mut World) {
        if self.freed.is_empty() {
            return;
        }
        let mut freed = core::mem::take(&mut self.freed);
        freed.retain(|&body| {
            if !world.contains(body) || self.held().any(|held| held == body) {
                return false;
            }
            let whole = together(world, body);
            let (Some(own), Some(other)) = (around(world, self.own()), around(world, &whole)) else {
                return false;
            };
            let is_near = own.overlaps(&other);
            for (&own, &other) in
                self.own().iter().flat_map(|own| whole.iter().map(move |other| (own, other)))
            {
                if !is_near {
                    world.enable_pair(own, other);
                }
            }
            is_near
        });
        self.freed = freed;
    }

    /// True if a mover stands in its bodies: one that has dragged it, for one.
    pub(super) fn is_entered(&self, world: &World) -> bool {
        let Some(own) = around(world, self.own()) else { return false };
        world.mover_ids().any(|id| {
            let mover = world.mover(id);
            let (radius, height) = (mover.def().radius, mover.def().height);
            let out = Vec3::new(radius, 0.0, radius);
            let feet = mover.position();
            own.overlaps(&Aabb { min: feet - out, max: feet + out + Vec3::Y * height })
        })
    }

    /// Has its grips pull through the next step; gives what one lets go of.
    pub(super) fn pull_grips(&mut self, world: &mut World) -> Option<BodyId> {
        let holds = self.presence.as_mut().map(|presence| presence.holds.iter_mut());
        for hold in holds.into_iter().flatten() {
            if let Some(grasp) = &mut hold.grasp
                && !grasp.pull(world, hold.joint, false)
            {
                return Some(hold.held);
            }
        }
        None
    }
}
