//! The public calls of a character.

use super::activity::{Activity, Flinch};
use super::grasp::Grab;
use super::hold::Grip;
use super::show::rows;
use super::{
    AfterSettling, Character, CharacterDef, CharacterEvent, Detail, Limb, Part, Preset, State, blows, clear,
};
use crate::character::tuning::{POWERED_HALF_LIFE, RETURNED_AFTER};
use crate::drive::{DriveMode, Drives};
use crate::owner::is_limb;
use crate::ragdoll::Ragdoll;
use sinew_anim::{Animator, JointIdx, LocalTransform, local_to_model};
use sinew_math::{Affine, Transform, Vec3, normalize_or};
use sinew_physics::{BodyHit, BodyId, GroupId, JointId, MoverId, Velocity, World};
use std::sync::Arc;

impl Character {
    // Entering and leaving

    /// Creates an animated character in a world, with a mover and hit bodies according to [`CharacterDef::in_world`].
    /// `world_from_character` is its pose (metres, +Y up, +Z forward). [`despawn`](Self::despawn) removes the character
    /// with all its parts.
    ///
    /// # Panics
    /// If the transform is not finite.
    pub fn spawn(world: &mut World, def: &Arc<CharacterDef>, world_from_character: Transform) -> Self {
        let mut character = Self::new(def.clone(), world_from_character, 0.0);
        character.enter(world);
        character
    }

    /// Adds a character that [`new`](Self::new) created to a world, like [`spawn`](Self::spawn). No effect if it is in
    /// a world already.
    ///
    /// # Panics
    /// If the character's transform is not finite, or the character is not animated.
    pub fn enter(&mut self, world: &mut World) {
        if self.is_in_world() {
            return;
        }
        assert!(self.figure.place.is_finite(), "the character's transform must be finite");
        assert!(self.state() == State::Animated, "only an animated character can enter a world");
        self.detail = Some(Detail::default());
        self.settle_detail(world);
    }

    /// Removes all parts of the character from the world: bodies, joints, drives, mover.
    ///
    /// # Panics
    /// If a part of the character is missing.
    pub fn despawn(mut self, world: &mut World) {
        self.leave(world);
    }

    /// Teleports the character; obstacles in between are not checked. A lying character keeps its pose, springs and
    /// garments keep their swing; [`reset_springs`](Self::reset_springs) and [`reset_garments`](Self::reset_garments)
    /// restart them.
    ///
    /// # Panics
    /// If the transform is not finite.
    pub fn teleport(&mut self, world: &mut World, world_from_character: Transform) {
        assert!(world_from_character.is_finite(), "the character's transform must be finite");
        let moved = world_from_character * self.figure.place.inverse();
        self.figure.carry(world_from_character);
        for &body in self.physique.own() {
            let velocity = world.velocity(body);
            world.set_transform(body, moved * world.transform(body));
            let turned = |v: Vec3| moved.rotation * v;
            let velocity = Velocity { linear: turned(velocity.linear), angular: turned(velocity.angular) };
            world.set_velocity(body, velocity);
        }
        self.scratch.posed.clear();
        self.wear.springs.carry(self.def.springs(), moved);
        self.wear.garments.carry(world, moved);
        self.physique.before.iter_mut().for_each(|pose| *pose = moved * *pose);
        self.gait.teleport(world_from_character.translation, world);
        self.feet.treads = None;
        if let Activity::Powered(balance) = &mut self.activity {
            balance.stumble = None;
        }
        // Pins are fixed to the world, so they would pull the character back to its old position.
        match (self.activity.state(), &self.physique.ragdoll) {
            (State::Flinching | State::Powered, _) => self.drive_bodies(world),
            (State::Preparing, Some(ragdoll)) => self.physique.drives.release(world, ragdoll),
            _ => {}
        }
    }

    /// Returns the character's level of detail. If clips do not move the character now, this is the level that applies
    /// once they do again. Full for a character outside of a world.
    pub fn level_of_detail(&self) -> Detail {
        self.detail.unwrap_or_default()
    }

    /// Sets the character's level of detail: immediately if clips move it, otherwise once they do again, because a
    /// flinch, a fall or a get-up finishes first. Pose and position do not change. Below [`Detail::HitBodies`] its
    /// bodies leave the world, unless it holds a body; they return with other ids. Its springs then fade to the pose
    /// and are no longer simulated; when they return, they start with the motion of the pose. No effect outside of a
    /// world.
    pub fn set_level_of_detail(&mut self, world: &mut World, detail: Detail) {
        if self.is_in_world() {
            self.detail = Some(detail);
        }
        self.settle_detail(world);
    }

    // Properties

    /// Returns the definition that the character shares with others of its kind.
    pub fn def(&self) -> &Arc<CharacterDef> {
        &self.def
    }

    /// Returns the character's current state.
    pub fn state(&self) -> State {
        self.activity.state()
    }

    /// Returns true while the character takes steps to regain its balance.
    pub fn stumbles(&self) -> bool {
        self.activity.stumble().is_some()
    }

    /// Returns the transform of the character in the world. While the character lies, the transform follows the body
    /// without rotating: it is under the pelvis, as high as the lowest body.
    pub fn world_from_character(&self) -> Transform {
        self.figure.place
    }

    /// Returns the transform from the file's model space to the world, for a renderer's root node.
    pub fn world_from_model(&self) -> Affine {
        self.def.mapping().world_from_model(self.figure.place)
    }

    /// Returns the local transform of every joint of the rig, including springs and garments; nodes above the pelvis
    /// are at rest (see [`crate::mapping`]).
    pub fn pose(&self) -> &[LocalTransform] {
        if self.wear.pose.is_empty() { self.pose_without_springs() } else { &self.wear.pose }
    }

    /// Returns [`pose`](Self::pose) as given by clips and bodies, with all springs and garments at rest.
    pub fn pose_without_springs(&self) -> &[LocalTransform] {
        self.feet.led(&self.figure.pose)
    }

    /// Computes pose and transform between the last step (`alpha` 0) and the present one (1): `pose` is cleared and
    /// gets one local transform per joint; returns the character's transform. A [loaded](Self::load) character shows
    /// the present step at every `alpha` until its next update, because snapshots do not contain the last shown pose.
    pub fn interpolated(&self, alpha: f32, pose: &mut Vec<LocalTransform>) -> Transform {
        self.figure.between(self.pose(), alpha, pose)
    }

    /// Computes skinning matrices for a renderer, between the last step (`alpha` 0) and the present one (1): `palette`
    /// is cleared and gets one matrix per joint of the skin, from the mesh's bind pose to the world in metres. Each is
    /// the upper three rows of a 4×4 matrix for column vectors, **row by row**: `[m00, m01, m02, m03, m10, …, m23]`,
    /// with the translation in `m03`, `m13`, `m23`. [Detached](Self::detach) parts shrink to the cut. Allocates a pose.
    ///
    /// # Panics
    /// If the rig has no such skin.
    pub fn skin_palette(&self, skin: usize, alpha: f32, palette: &mut Vec<[f32; 12]>) {
        let (mut pose, mut model) = (Vec::new(), Vec::new());
        let place = self.interpolated(alpha, &mut pose);
        let root = self.def.mapping().world_from_model(place);
        sinew_anim::local_to_model(&self.def.rig, &pose, &root, &mut model);
        let skin = &self.def.rig.skins[skin];
        palette.clear();
        palette.extend(skin.joints.iter().zip(&skin.inverse_bind).map(|(&joint, bind)| {
            rows(
                &self.physique.shrunk_joint(&self.def, joint, &model).unwrap_or_else(|| model[joint] * *bind),
            )
        }));
    }

    /// Returns the animator that plays the character's clips, those of [`CharacterDef::set`].
    pub fn animator(&self) -> &Animator {
        &self.gait.animator
    }

    /// Returns the animator that plays the character's clips, mutable; add tracks, crossfades and layers to it. It
    /// starts with the looped clip, and plays this clip again after getting up; getting up stops all other tracks of
    /// layer 0. While the character is limp, clips still move the joints without a body
    /// ([`Mapping::free`](crate::Mapping::free)), and events continue.
    pub fn animator_mut(&mut self) -> &mut Animator {
        &mut self.gait.animator
    }

    /// Returns the events of the last [`update`](Self::update), in order: those since the end of the update before, and
    /// those that calls have caused since. Poll once after each update to receive every event exactly once.
    pub fn events(&self) -> &[CharacterEvent] {
        &self.events.list
    }

    /// Returns the character's ragdoll, if any: while it is limp, or prepares to get up.
    pub fn ragdoll(&self) -> Option<&Ragdoll> {
        self.physique.ragdoll.as_ref()
    }

    /// Returns the drives of the character's bodies.
    pub fn drives(&self) -> &Drives {
        &self.physique.drives
    }

    /// Returns the drives of the character's bodies, mutable; they act while it has bodies.
    /// [`set_drive`](Self::set_drive) creates them.
    pub fn drives_mut(&mut self) -> &mut Drives {
        &mut self.physique.drives
    }

    /// Returns the character's mover in the world; `None` without a mover, and while the character lies.
    pub fn mover(&self) -> Option<MoverId> {
        self.gait.mover
    }

    /// Returns the character's bodies in the world, in the order of the definition: hit bodies or those of its ragdoll;
    /// empty outside of a world. [Detached](Self::detach) bodies keep their entries.
    pub fn bodies(&self) -> &[BodyId] {
        self.physique.ids()
    }

    /// Returns the index in the definition of one of the character's bodies, for instance one that a ray hit.
    pub fn body_index(&self, id: BodyId) -> Option<usize> {
        self.physique.index_of(id)
    }

    /// Returns true if a body, by index in the definition, was not detached.
    pub fn has_body(&self, body: usize) -> bool {
        self.physique.has(body)
    }

    /// Returns the joints of the rig whose skin was detached, ascending.
    pub fn lost_joints(&self) -> Vec<JointIdx> {
        self.physique.lost_joints(&self.def)
    }

    // Movement

    /// Sets the velocity over the ground, m/s, which replaces root motion: clips play at the real speed. The component
    /// along up is ignored. No effect without a mover.
    ///
    /// # Panics
    /// If the velocity is not finite.
    pub fn set_move(&mut self, velocity: Vec3) {
        assert!(velocity.is_finite(), "the velocity must be finite");
        if self.is_in_world() {
            self.gait.wish = Some(velocity);
        }
    }

    /// Returns to root motion, the initial setting.
    pub fn follow_clips(&mut self) {
        self.gait.follow_clips(&self.def);
    }

    /// Turns the character toward a direction, at [`InWorld::turn_speed`](super::InWorld::turn_speed), once it stands.
    /// A vertical direction has no effect.
    ///
    /// # Panics
    /// If the direction is not finite.
    pub fn face(&mut self, direction: Vec3) {
        assert!(direction.is_finite(), "the direction must be finite");
        let level = normalize_or(direction * Vec3::new(1.0, 0.0, 1.0), Vec3::ZERO);
        if self.is_in_world() && level != Vec3::ZERO {
            self.gait.facing = Some(level);
        }
    }

    /// Makes the character jump in the next step, if it is then on the ground.
    pub fn jump(&mut self, world: &mut World) {
        if let Some(mover) = self.gait.mover {
            world.mover_jump(mover, self.def.in_world.jump_speed);
        }
    }

    // Blows, drives and obstacles

    /// Hits a body with an impulse (N·s, world axes) at its centre of mass; the part that would make the body faster
    /// than 12 m/s goes to the bodies above it in its chain. A character that is in a world and
    /// [tough](super::InWorld::toughness) enough flinches; any other goes limp at its present speed. Returns the work
    /// of the impulse, joules; 0 for a [detached](Self::detach) body.
    ///
    /// # Panics
    /// If there is no such body or the impulse is not finite.
    pub fn hit(&mut self, world: &mut World, body: usize, impulse: Vec3) -> f32 {
        self.strike(world, body, impulse, None)
    }

    /// Like [`hit`](Self::hit), at the point where a ray or a shape hit one of the character's bodies. `None`, with no
    /// effect, if the hit body is not one of them.
    ///
    /// # Panics
    /// If the impulse is not finite.
    pub fn hit_at(&mut self, world: &mut World, hit: &BodyHit, impulse: Vec3) -> Option<f32> {
        let body = self.body_index(hit.body)?;
        Some(self.strike(world, body, impulse, Some(hit.point)))
    }

    /// Makes the character limp: bodies take over at the pose and speed of the animation. No effect on a limp
    /// character.
    pub fn go_limp(&mut self, world: &mut World) {
        self.fall(world);
    }

    /// Sets the drive of all bodies.
    ///
    /// # Panics
    /// If the character is not in the world.
    pub fn set_preset(&mut self, world: &mut World, preset: Preset) {
        let may_get_up = self.physique.may_get_up(&self.def);
        match (preset, self.state()) {
            (Preset::Limp, _) => self.fall(world),
            (Preset::Animated, State::Powered) => {
                self.physique.drives.set_all(DriveMode::Keyed, POWERED_HALF_LIFE);
                self.activity = Activity::Flinching(Flinch { seconds: RETURNED_AFTER * POWERED_HALF_LIFE });
            }
            // Kinematic bodies that clips move would tear off the bodies that they hold.
            (Preset::Animated, State::Limp | State::Preparing)
                if may_get_up && !self.grips.is_gripped(&self.physique, world) =>
            {
                self.get_up(world);
            }
            (Preset::Flinching, State::Animated | State::Flinching) => {
                for body in blows::pelvis_children(&self.def.ragdoll) {
                    self.flinch(world, body, Vec3::ZERO);
                }
            }
            (Preset::Powered, _) if may_get_up => self.power(world),
            _ => {}
        }
    }

    /// Sets the character's action once it lies still, instead of [`CharacterDef::after_settling`]. For a dead
    /// character set [`StayDown`](AfterSettling::StayDown), before or after it falls; a get-up in progress continues.
    /// With [`GetUp`](AfterSettling::GetUp), a character that lies still gets up.
    pub fn set_after_settling(&mut self, after_settling: AfterSettling) {
        self.after_settling = after_settling;
    }

    /// Returns the character's action once it lies still.
    pub fn after_settling(&self) -> AfterSettling {
        self.after_settling
    }

    /// Returns the character to its looped clip from any state: at `place`, `phase` seconds into the clip. Its pose and
    /// motion fade to the clip within `seconds`, during which it counts as getting up. It passes through obstacles on
    /// the way, so choose a suitable moment. No effect on a character that cannot get up because [a leg was
    /// detached](Self::detach).
    ///
    /// # Panics
    /// If the transform or the phase is not finite, or `seconds` is negative or not finite.
    pub fn return_to_clip(&mut self, world: &mut World, place: Transform, phase: f32, seconds: f32) {
        assert!(place.is_finite() && phase.is_finite(), "the transform and the phase must be finite");
        assert!(
            (0.0..f32::INFINITY).contains(&seconds),
            "the transition must take 0 s or longer, not {seconds} s"
        );
        if self.physique.may_get_up(&self.def) {
            self.return_to(world, place, phase, seconds);
        }
    }

    /// Changes the drive of a part of the character: half of the change is made within `half_life` seconds. A standing
    /// character is powered from then on; its other parts follow the clips.
    ///
    /// # Panics
    /// If no body has this name, or as for [`Drives::set`].
    pub fn set_drive(&mut self, world: &mut World, part: Part<'_>, mode: DriveMode, half_life: f32) {
        let def = self.def.clone();
        let named = |name: &str| def.body_named(name).unwrap_or_else(|| panic!("no body is called '{name}'"));
        if self.state() == State::Animated {
            self.take_bodies(world, DriveMode::Keyed, 0.0);
        }
        if matches!(self.state(), State::Animated | State::Flinching) {
            self.become_powered();
        }
        match part {
            Part::All => self.physique.drives.set_all(mode, half_life),
            Part::Body(body) => self.physique.drives.set(body, mode, half_life),
            Part::Named(name) => self.physique.drives.set(named(name), mode, half_life),
            Part::From(name) => self.physique.drives.set_from(&def.ragdoll, named(name), mode, half_life),
        }
        if self.state() == State::Powered {
            self.drive_bodies(world);
        }
    }

    /// Moves a limp character out of static shapes in which it is deep, at 1.9 m/s, all bodies together; it falls as
    /// soon as it is clear. Returns false if nothing is done: the character is not limp, or held, no body is deeper
    /// than 0.1 m, or no displacement of at most 1.2 m leads out.
    ///
    /// A moving character leaves a wall on the side from which it came, a resting one on the nearer side. Going limp
    /// calls this; call it yourself if a wall was placed or a door has closed on a limp character.
    pub fn clear(&mut self, world: &mut World) -> bool {
        let is_gripped = self.grips.is_gripped(&self.physique, world);
        let Activity::Limp(lying) = &mut self.activity else { return false };
        if !lying.clearing.velocities.is_empty() || is_gripped {
            return false;
        }
        let Some(clearing) = clear::begin(self.physique.own(), world) else { return false };
        lying.clearing = clearing;
        self.physique.set_rule(world, self.def.in_world.rule());
        self.go_out(world);
        true
    }

    // Holding and detaching

    /// Makes one of the character's bodies (by role or bone) hold a dynamic body, which is moved to the hand, on a
    /// fixed joint. While held, this body passes through the character's own bodies and through movers. Use
    /// [`grab`](Self::grab) for limbs of others.
    ///
    /// # Panics
    /// If no body has that name or it was [detached](Self::detach), the character has no bodies in the world, it holds
    /// `held` already, or `held` is part of a character or ragdoll.
    #[track_caller]
    pub fn hold(&mut self, world: &mut World, bone: &str, held: BodyId, grip: &Grip) -> JointId {
        let body = self.def.body_named(bone).unwrap_or_else(|| panic!("no body is called '{bone}'"));
        assert!(self.physique.has(body), "the body '{bone}' was detached from the character");
        assert!(
            !self.physique.ids().is_empty(),
            "a character needs bodies in the world to hold another body"
        );
        assert!(self.grips.held().all(|other| other != held), "the character holds this body already");
        if let Some((owner, part)) = world.body_owner(held).filter(|_| !is_limb(world, held)) {
            panic!("{held:?} is the {}'s {part}: `Character::grab` takes hold of it", owner.name);
        }
        let bodies = (self.physique.ids(), self.physique.own());
        self.grips.hold(bodies, body, held, grip, world)
    }

    /// Releases a held body; returns false if the character does not hold it.
    pub fn release(&mut self, world: &mut World, held: BodyId) -> bool {
        self.grips.release(self.physique.own(), held, world, &mut self.events)
    }

    /// Returns the held bodies, in the order in which the character took them.
    pub fn held(&self) -> impl Iterator<Item = BodyId> {
        self.grips.held()
    }

    /// Makes one of the character's bodies (by role or bone) grab a body: another's limb, a crate. The grip holds the
    /// surface point nearest to the hand, in place, so that nothing snaps, and pulls this point to the hand at
    /// [`speed`](Grab::speed); the body rotates freely about the point. The grip drags and lifts with at most
    /// [`max_force`](Grab::max_force), and lets go if that does not suffice: [`CharacterEvent::LetGo`].
    /// [`release`](Self::release) lets go immediately. A grabbed body passes through the character's own bodies and
    /// through movers.
    ///
    /// One of the two bodies must be dynamic: a kinematic hand drags limp or powered bodies. A grabbed character stays
    /// limp and does not get up. A limb of an animated character is kinematic until a hit makes it weak:
    /// [`hit`](Self::hit) it with an impulse of 0 before. While held, the limb stays weak; its character follows the
    /// limb at up to 2 m/s, and falls if the limb is drawn 0.3 of the character's height from the clip.
    ///
    /// Returns `None` if the target is out of reach, a body of the character, or held already, if neither body is
    /// dynamic, or if the character has no such body in the world.
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
    /// let wrist = other.bodies()[def.body_named("rightLowerArm").expect("the body exists")];
    /// let grab = Grab { reach: 0.5, ..Grab::HAND };
    /// let grip = hero.grab(&mut world, "leftHand", wrist, &grab).expect("the point is in reach");
    /// for _ in 0..60 {
    ///     world.step();
    ///     hero.update(&mut world);
    ///     other.update(&mut world);
    ///     assert!(!world.contains_joint(grip) || world.reaction(grip).force.length() < 1.05 * grab.max_force);
    /// }
    /// ```
    ///
    /// # Panics
    /// If no body has that name, or a number of the grip is invalid.
    #[track_caller]
    pub fn grab(&mut self, world: &mut World, bone: &str, held: BodyId, grab: &Grab) -> Option<JointId> {
        grab.check();
        let body = self.def.body_named(bone).unwrap_or_else(|| panic!("no body is called '{bone}'"));
        if !self.is_in_world() {
            return None;
        }
        self.grips.grab(&self.physique, body, held, grab, world)
    }

    /// Detaches a limb: the named body (by role or bone) and all bodies below it. They become independent bodies at
    /// their present velocity, in any state; grips on them continue. Bodies that they held are dropped; garments hang
    /// on the remaining bodies.
    ///
    /// Without an arm or a hand the character continues. Without a leg, a foot, the head or a part of the trunk it goes
    /// limp and does not get up again. [`bodies`](Self::bodies) keeps its order: the ids of the limb's bodies keep
    /// their indices, and [`has_body`](Self::has_body) is false for them.
    ///
    /// Returns `None` if that body is detached already.
    ///
    /// ```
    /// use sinew_math::Transform;
    /// use sinew_physics::{BodyDef, Shape, World, WorldDef};
    /// use sinew_ragdoll::Character;
    /// use std::sync::Arc;
    ///
    /// let mut world = World::new(WorldDef::default());
    /// world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    /// let def = Arc::new(sinew::mannequin::character());
    /// let mut knight = Character::spawn(&mut world, &def, Transform::IDENTITY);
    /// let arm = knight.detach(&mut world, "leftUpperArm").expect("it has that arm");
    /// assert_eq!(arm.parts().len(), 3, "upper arm, lower arm and hand");
    /// assert!(knight.detach(&mut world, "leftHand").is_none(), "the hand went with the arm");
    /// for _ in 0..90 {
    ///     world.step();
    ///     knight.update(&mut world);
    /// }
    /// assert!(world.transform(arm.bodies()[0]).translation.y < 0.2, "it lies on the ground");
    /// ```
    ///
    /// # Panics
    /// If no body has this name, or it is the first of the definition, the pelvis.
    #[track_caller]
    pub fn detach(&mut self, world: &mut World, bone: &str) -> Option<Limb> {
        let def = self.def.clone();
        let first = def.body_named(bone).unwrap_or_else(|| panic!("no body is called '{bone}'"));
        assert!(first > 0, "the pelvis cannot be detached: detach the legs or the trunk instead");
        if !self.physique.has(first) {
            return None;
        }
        let parts = self.physique.limb_from(&def, first);
        let was_clearing = self.activity.is_clearing();
        self.end_clearing(world);
        self.grips.drop_from(self.physique.own(), &parts, world, &mut self.events);
        let mut world_from_joint = Vec::new();
        local_to_model(&def.rig, self.pose(), &self.world_from_model(), &mut world_from_joint);
        let (bodies, joints) = self.part_with(world, &parts);
        let poses: Vec<Transform> = bodies.iter().map(|&body| world.transform(body)).collect();
        let limb = Limb::new(def, parts, bodies, joints, &world_from_joint, &poses);
        limb.own(world);
        self.live_on(world);
        if was_clearing {
            self.clear(world);
        }
        self.events.push(CharacterEvent::Detached { body: first });
        Some(limb)
    }

    // Springs and garments

    /// Restarts the character's springs at rest with the next step, for instance after a camera cut.
    pub fn reset_springs(&mut self) {
        self.wear.springs.reset();
    }

    /// Restarts the character's garments at rest, for instance after a camera cut.
    ///
    /// # Panics
    /// If `world` is not the character's world.
    pub fn reset_garments(&mut self, world: &mut World) {
        if !self.wear.garments.groups.is_empty() {
            self.wear.garments.take_off(world);
            let (wear, bearer) = self.wearing();
            wear.dress(bearer, world);
        }
    }

    /// Returns the particles of the character's garments in the world, in the order of
    /// [`CharacterDef::garments`](super::CharacterDef::garments); empty while the character has no bodies.
    pub fn garments(&self) -> &[GroupId] {
        &self.wear.garments.groups
    }
}
