//! A point that holds and drags a body, for example the pointer of a mouse or the hook of a crane.

use super::grasp::{Grab, Grasp};
use sinew_math::{ReadError, Reader, Vec3, Writer};
use sinew_physics::{BodyDef, BodyId, BodyKind, JointId, World};

/// First bytes of a saved point; the last one is the version.
const MAGIC: &[u8; 8] = b"sinew-g\x01";

/// A point of the world that holds a body, such as a limb, and drags it: for instance a mouse. The point moves at
/// [`Grab::speed`], and stays ahead of its body by at most the stretch at which the grip pulls with its full force, so
/// that a jump of the target does not throw the body.
///
/// ```
/// use sinew_math::{Transform, Vec3};
/// use sinew_physics::{BodyDef, Shape, World, WorldDef};
/// use sinew_ragdoll::{Character, Grab, GrabPoint};
/// use std::sync::Arc;
///
/// let mut world = World::new(WorldDef::default());
/// world.add_body(&BodyDef::fixed(Shape::HalfSpace));
/// let def = Arc::new(sinew::mannequin::character());
/// let mut puppet = Character::spawn(&mut world, &def, Transform::IDENTITY);
/// puppet.go_limp(&mut world);
/// let hand = puppet.bodies()[def.body_named("rightHand").expect("the character has hands")];
/// let at = world.center_of_mass(hand);
/// let mut mouse = GrabPoint::take(&mut world, hand, at, &Grab::POINT).expect("the hand is there");
/// mouse.set_target(at + Vec3::Y * 0.5);
/// for _ in 0..180 {
///     mouse.update(&mut world);
///     world.step();
///     puppet.update(&mut world);
/// }
/// assert!((world.center_of_mass(hand) - mouse.target()).length() < 0.05, "it hangs there");
/// mouse.release(&mut world);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct GrabPoint {
    /// Static body without shape, at the origin.
    ground: BodyId,
    joint: JointId,
    held: BodyId,
    /// Point at which the body was grabbed, world.
    origin: Vec3,
    grasp: Grasp,
}

impl GrabPoint {
    /// Grabs a body at the surface point nearest to `point` (metres, world), or at `point` itself if it is inside.
    /// `None` if that point is further away than [`Grab::reach`], or the body is not dynamic. For a limb of an animated
    /// character see [`Character::grab`](super::Character::grab).
    ///
    /// # Panics
    /// If a number of the grip is invalid, the point is not finite, or the body is missing.
    #[track_caller]
    pub fn take(world: &mut World, held: BodyId, point: Vec3, grab: &Grab) -> Option<Self> {
        grab.check();
        assert!(point.is_finite(), "a point is finite, not {point:?}");
        if world.kind(held) != BodyKind::Dynamic {
            return None;
        }
        let origin = Grasp::touch(world, held, point, grab.reach)?;
        let ground = world.add_body(&BodyDef { kind: BodyKind::Static, ..BodyDef::default() });
        let (grasp, joint) = Grasp::take(world, [ground, held], [origin, point], grab);
        Some(Self { ground, joint, held, origin, grasp })
    }

    /// Sets the target of the point, metres, world.
    ///
    /// # Panics
    /// If the target is not finite.
    #[track_caller]
    pub fn set_target(&mut self, point: Vec3) {
        assert!(point.is_finite(), "a point is finite, not {point:?}");
        self.grasp.lead(point - self.origin);
    }

    /// Returns the target position, metres, world.
    pub fn target(&self) -> Vec3 {
        self.origin + self.grasp.goal
    }

    /// Returns the body that the point holds, or has held until it released the body.
    pub fn held(&self) -> BodyId {
        self.held
    }

    /// Returns the point's joint in the world, whose [reaction](World::reaction) is the force of the grip.
    pub fn joint(&self) -> JointId {
        self.joint
    }

    /// Sets the pull for the next step; call it before each step. Returns false once the point holds nothing, because
    /// the body was removed or is further from the target than [`Grab::slip`].
    pub fn update(&mut self, world: &mut World) -> bool {
        let is_there = world.contains_joint(self.joint) && world.contains(self.held);
        if is_there && self.grasp.pull(world, self.joint, true) {
            return true;
        }
        self.leave(world);
        false
    }

    /// Releases the body.
    pub fn release(self, world: &mut World) {
        self.leave(world);
    }

    fn leave(&self, world: &mut World) {
        if world.contains(self.ground) {
            world.remove_body(self.ground);
        }
    }

    /// Writes the state that the world's snapshot does not contain.
    pub fn save(&self, w: &mut Writer) {
        w.raw(MAGIC);
        w.u64(self.ground.to_bits());
        w.u64(self.joint.to_bits());
        w.u64(self.held.to_bits());
        w.vec3(self.origin);
        self.grasp.save(w);
    }

    /// Reads a saved point, which belongs to the world's snapshot of the same time.
    ///
    /// # Errors
    /// If the bytes are not a saved point of this version.
    pub fn load(r: &mut Reader<'_>) -> Result<Self, ReadError> {
        if r.raw(MAGIC.len())? != MAGIC {
            return Err(r.error("these bytes are not a grab point saved by this version"));
        }
        let (ground, joint) = (BodyId::from_bits(r.u64()?), JointId::from_bits(r.u64()?));
        let (held, origin) = (BodyId::from_bits(r.u64()?), r.vec3()?);
        if !origin.is_finite() {
            return Err(r.error("invalid settings of a grip"));
        }
        Ok(Self { ground, joint, held, origin, grasp: Grasp::load(r)? })
    }
}
