//! Grips on the limbs of others, and on whatever forces move: they take hold where they touch, pull no harder than they may, and let go.

use super::Character;
use super::grasp::{Grab, Grasp};
use super::memory::Hold;
use super::tuning::PARTED;
use crate::owner::together;
use sinew_math::Vec3;
use sinew_physics::boxes::Overlap;
use sinew_physics::{Aabb, BodyId, BodyKind, JointId, JointState, World};

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
    #[track_caller]
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

/// Bounds of bodies, with room for a step.
fn around(world: &World, bodies: &[BodyId]) -> Option<Aabb> {
    let bounds = bodies.iter().map(|&body| world.bounds(body)).reduce(|a, b| a.merge(&b))?;
    let room = Vec3::splat(PARTED);
    Some(Aabb { min: bounds.min - room, max: bounds.max + room })
}
