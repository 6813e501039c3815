//! A character: animated until a hit makes it fall, limp until it lies still, prepared for a get-up clip if needed,
//! getting up, animated again. Each change is a [`CharacterEvent`].
//!
#![doc = include_str!("states.svg")]
//!
//! The host steps the world, then calls [`Character::update`]; poses and bodies then belong to the same time.
//!
//! ```
//! use sinew_math::{Transform, Vec3};
//! use sinew_physics::{BodyDef, Shape, World, WorldDef};
//! use sinew_ragdoll::{Character, State};
//! use std::sync::Arc;
//!
//! let mut world = World::new(WorldDef::default());
//! world.add_body(&BodyDef::fixed(Shape::HalfSpace));
//! let def = Arc::new(sinew::mannequin::character());
//! let mut hero = Character::spawn(&mut world, &def, Transform::IDENTITY);
//! hero.hit(&mut world, def.body_named("chest").expect("the body exists"), Vec3::Z * -150.0);
//! assert_eq!(hero.state(), State::Limp);
//! for _ in 0..60 {
//!     world.step();
//!     hero.update(&mut world);
//! }
//! let chest = hero.bodies()[def.body_named("chest").expect("the body exists")];
//! assert!(world.center_of_mass(chest).y < 1.0, "it falls");
//! ```

mod activity;
mod blows;
mod calls;
mod changes;
mod clear;
mod clearance;
mod def;
mod detach;
mod distances;
mod event;
mod feet;
mod figure;
mod floor;
mod foot_bodies;
mod foresight;
mod gait;
mod get_up;
mod grab;
mod grab_point;
mod grasp;
mod ground;
mod hit_bodies;
mod hold;
mod in_world;
mod legs;
mod limb;
mod limp;
mod mirror;
mod moves;
mod physique;
mod pose_similarity;
mod powered;
mod prepare;
mod recognise;
mod rises;
mod save;
mod show;
mod size;
mod stumble;
mod travel;
mod tread;
mod tuning;
mod walls;
mod wear;

pub(crate) use floor::moved;
pub(crate) use limp::{is_still, is_sunk, touches_world};
pub(crate) use tuning::STILL_TIME;

pub use def::{AfterSettling, CharacterDef, GettingReady, GroundContact, Locomotion, MotionSet, Opening};
pub use distances::{Detail, Distances};
pub use event::{CharacterEvent, State};
pub use grab_point::GrabPoint;
pub use grasp::Grab;
pub use hold::Grip;
pub use in_world::{Blow, FootPlanting, HitBodies, InWorld, Toughness};
pub use limb::Limb;
pub use moves::MotionError;
pub use powered::{Part, Preset};

use crate::drive::DriveMode;
use activity::Activity;
use event::Events;
use feet::{Feet, Stand};
use figure::{Figure, Moment, Scratch};
use gait::Gait;
use get_up::{Choice, Risen};
use grab::is_entered;
use hold::Grips;
use limp::Lying;
use physique::Physique;
use sinew_math::{Transform, Vec3};
use sinew_physics::{ContactRule, Push, ShapeId, World};
use std::sync::Arc;
use stumble::Balancing;
use tuning::{FLINCH_HALF_LIFE, PULL_FELLS};
use wear::{Bearer, Wear};

/// A character in a world.
#[derive(Clone, Debug)]
pub struct Character {
    def: Arc<CharacterDef>,
    /// State of the character, with its data.
    activity: Activity,
    /// Action that the character takes once it lies still.
    after_settling: AfterSettling,
    /// Level of detail that applies while clips move the character; `None` outside of a world.
    detail: Option<Detail>,
    gait: Gait,
    figure: Figure,
    feet: Feet,
    physique: Physique,
    grips: Grips,
    wear: Wear,
    events: Events,
    scratch: Scratch,
}

impl Character {
    /// Creates an animated character at `world_from_character` (metres, +Y up, +Z forward), `phase` seconds into its
    /// looped clip.
    ///
    /// # Panics
    /// If `phase` is not finite.
    pub fn new(def: Arc<CharacterDef>, world_from_character: Transform, phase: f32) -> Self {
        let animator = def.opening(phase);
        let figure = Figure::new(animator.pose().iter().collect(), world_from_character);
        Self {
            activity: Activity::Animated,
            after_settling: def.after_settling,
            detail: None,
            gait: Gait::new(animator),
            figure,
            feet: Feet::default(),
            physique: Physique::new(&def),
            grips: Grips::default(),
            wear: Wear::new(),
            events: Events::default(),
            scratch: Scratch::default(),
            def,
        }
    }

    /// Updates the character after a step of the world.
    ///
    /// # Panics
    /// If `world` is not the character's world.
    pub fn update(&mut self, world: &mut World) {
        self.events.begin();
        self.keep_shown();
        if self.def.in_world.tells_contacts {
            self.events.list.extend(self.physique.contacts(world));
        }
        self.grips.mind(self.physique.own(), world, &mut self.events);
        self.physique.mind_parting(world);
        self.grips.mind_freed(self.physique.own(), world);
        if !self.is_frozen() {
            self.follow(world);
            self.settle_detail(world);
            self.go_on_wearing(world);
        }
        self.events.end();
    }

    /// Advances the character's state by a step.
    fn follow(&mut self, world: &mut World) {
        match self.state() {
            State::Animated => self.go_animated(world),
            State::GettingUp => self.go_rising(world),
            State::Flinching | State::Powered => {
                self.feel(world);
                match self.state() {
                    State::Limp => self.follow_bodies(world),
                    _ => self.go_powered(world),
                }
            }
            State::Limp => self.go_lying(world),
            State::Preparing => self.go_preparing(world),
        }
    }

    fn go_animated(&mut self, world: &mut World) {
        self.advance(world);
        self.plant(world);
        self.attend(world);
        self.give_way_to_grips(world);
    }

    fn go_rising(&mut self, world: &mut World) {
        self.advance(world);
        let animator = &self.gait.animator;
        let Activity::GettingUp(rising) = &mut self.activity else { return };
        rising.straighten(&self.def, animator, &mut self.figure);
        match rising.go_on(animator, world.def().dt()) {
            Risen::NotYet => {}
            Risen::ByClip => self.stand(world),
            Risen::Without => self.be_up(),
        }
        self.plant(world);
        self.attend(world);
        self.give_way_to_grips(world);
    }

    /// Advances the clips and the character over the ground by a step.
    fn advance(&mut self, world: &World) {
        let own = self.detail.map(|_| self.physique.hit.as_slice());
        self.gait.advance(&self.def, &self.activity, &mut self.figure, own, world);
        let fired = self.gait.animator.events();
        self.events.list.extend(fired.iter().map(|&fired| CharacterEvent::Clip(fired)));
    }

    /// Plants the feet and computes the shown pose.
    fn plant(&mut self, world: &World) {
        let stand = Stand {
            def: &self.def,
            activity: &self.activity,
            animator: &self.gait.animator,
            figure: &self.figure,
            speed: self.gait.speed,
            lifted: core::mem::take(&mut self.gait.lifted),
            aloft: self.gait.is_aloft(),
            follows: self.follows_ground(),
            own: self.detail.map(|_| self.physique.hit.as_slice()),
        };
        self.feet.plant(&stand, world, &mut self.scratch.model);
    }

    /// Applies the effects of the world on a character that its clips move: falls, hits and wind. Then sets the motion
    /// of its hit bodies and mover for the next step.
    fn attend(&mut self, world: &mut World) {
        // Outside of a world, a character falls only over an edge.
        if self.gait.falls && (self.is_in_world() || self.state() == State::Animated) {
            return self.go_limp(world);
        }
        if !self.is_in_world() {
            return;
        }
        if self.is_swept_off() {
            return self.go_limp(world);
        }
        self.feel(world);
        if self.physique.ragdoll.is_none() {
            self.lead_bodies(world);
        }
        self.steer(world);
    }

    /// Makes the character flinch or fall if its bodies were hit in the last step.
    fn feel(&mut self, world: &mut World) {
        if !self.is_in_world() {
            return;
        }
        self.apply_pushes(world);
        if self.state() == State::Limp {
            return;
        }
        if let Some((body, strike)) = self.physique.felt(&self.def, self.steps(), world) {
            self.events.push(CharacterEvent::Struck { body, impulse: strike.impulse.length() });
            self.be_struck(world, body, strike);
        }
    }

    /// Applies the effects of blasts, other impulses on kinematic bodies, and fields.
    fn apply_pushes(&mut self, world: &mut World) {
        let pushes = self.physique.pushes(world);
        let blown = self.physique.field_impulse(world);
        let total: Vec3 = pushes.iter().map(|(_, push)| push.impulse).sum();
        if self.gait.mover.is_some() {
            self.gait.blown += (total + blown) / self.def.ragdoll.total_mass;
        }
        let harder = |a: (usize, Push), b: (usize, Push)| {
            if b.1.impulse.length() > a.1.impulse.length() { b } else { a }
        };
        let Some((body, _)) = pushes.iter().copied().reduce(harder) else { return };
        if total.length() < self.def.in_world.feels {
            return;
        }
        self.events.push(CharacterEvent::Struck { body, impulse: total.length() });
        if self.react(world, body, total) {
            self.physique.take_pushes(&pushes, world);
        }
    }

    /// Returns true if a field, such as wind, has swept the character off its feet.
    fn is_swept_off(&self) -> bool {
        let momentum = Vec3 { y: 0.0, ..self.gait.shoved } * self.def.ragdoll.total_mass;
        let blow = Blow { body: 0, impulse: momentum, state: self.state() };
        momentum != Vec3::ZERO && self.gait.air == 0.0 && self.is_swept_by(blow)
    }

    /// Sets the motion of the hit bodies toward the predicted pose for the next step.
    fn lead_bodies(&mut self, world: &mut World) {
        let pose = self.feet.led(&self.figure.pose);
        self.physique.lead(&self.def, pose, self.figure.place, &mut self.scratch, world);
    }

    /// Sets the mover's motion for the next step.
    fn steer(&mut self, world: &mut World) {
        let mover = self.gait.mover;
        self.grips.spare_bearer(self.physique.own(), mover, world);
        let (rotation, steps) = (self.figure.place.rotation, self.steps());
        self.gait.steer(&self.def, &self.activity, rotation, steps, world);
    }

    /// Advances a flinching or powered character by a step: clips and physics together move its bodies.
    fn go_powered(&mut self, world: &mut World) {
        self.advance(world);
        self.plant(world);
        let in_vain = self.keep_balance(world);
        let def = &self.def;
        let mut resting = core::mem::take(&mut self.scratch.pose);
        resting.clone_from(&self.figure.pose);
        self.physique.poses(def, world, &mut self.scratch);
        let (place, pose) = (self.figure.place, &mut self.figure.pose);
        let bodies = &self.scratch.after;
        self.physique.physical.pose_over(def.mapping(), &def.rig, &resting, place, bodies, pose);
        self.scratch.pose = resting;
        if self.gait.falls || in_vain || self.is_toppled(world) || self.is_swept_off() {
            return self.go_limp(world);
        }
        if self.is_pulled_over(world) {
            return self.go_limp(world);
        }
        if self.goes_on_flinching(world) {
            self.drive_bodies(world);
        } else {
            self.recover(world);
        }
        self.steer(world);
    }

    /// Advances a flinch; returns false once its limb has returned to the clips, and true while powered.
    fn goes_on_flinching(&mut self, world: &World) -> bool {
        let Activity::Flinching(flinch) = &mut self.activity else { return true };
        if self.grips.is_gripped(&self.physique, world) {
            flinch.go_on();
        }
        if flinch.turns_back(world.def().dt()) {
            self.physique.drives.set_all(DriveMode::Keyed, FLINCH_HALF_LIFE);
        }
        flinch.seconds > 0.0 || !self.is_at_clips(world)
    }

    /// Takes steps that keep a powered character's balance; returns true if they cannot prevent a fall.
    fn keep_balance(&mut self, world: &World) -> bool {
        let steps = self.steps();
        let Activity::Powered(balance) = &mut self.activity else { return false };
        let on = Balancing {
            def: &self.def,
            place: self.figure.place,
            gait: &self.gait,
            physique: &self.physique,
        };
        balance.go_on(on, steps, &mut self.scratch, world, &mut self.events)
    }

    /// Makes a limb that another object holds weak. A character that is held by the pelvis, or is held while it gets
    /// up, goes limp.
    fn give_way_to_grips(&mut self, world: &mut World) {
        if self.physique.hit.is_empty() || self.physique.ragdoll.is_some() {
            return;
        }
        let Some(body) = self.grips.gripped(&self.physique, world) else { return };
        let gives_way = body > 0 && self.state() == State::Animated;
        if !(gives_way && self.flinch(world, body, Vec3::ZERO)) {
            self.go_limp(world);
        }
    }

    /// Makes a flinching character follow its held limb; returns true if the limb is pulled too far from its clip.
    fn is_pulled_over(&mut self, world: &World) -> bool {
        if !matches!(self.activity, Activity::Flinching(_)) {
            return false;
        }
        let Some(body) = self.grips.gripped(&self.physique, world) else { return false };
        let mut clip = core::mem::take(&mut self.scratch.wanted);
        clip.clear();
        clip.extend(self.gait.animator.pose().iter());
        let mut bodies = core::mem::take(&mut self.scratch.before);
        self.scratch.bodies_of(&self.def, &clip, self.figure.place, &mut bodies);
        let held = self.physique.limp().bodies[body];
        let off = world.transform(held).translation - bodies[body].translation;
        (self.scratch.wanted, self.scratch.before) = (clip, bodies);
        let height = self.def.ragdoll.height;
        self.gait.follow_pull(off, world.velocity(held).linear, height);
        off.length() > PULL_FELLS * height
    }

    fn is_toppled(&mut self, world: &World) -> bool {
        let (animator, place) = (&self.gait.animator, self.figure.place);
        matches!(self.activity, Activity::Powered(_))
            && powered::is_toppled(&self.def, animator, place, &self.physique, &mut self.scratch, world)
    }

    /// Advances a lying character by a step, until the bodies lie still.
    fn go_lying(&mut self, world: &mut World) {
        self.follow_bodies(world);
        if self.activity.is_clearing() {
            return self.go_out(world);
        }
        if self.def.falling != DriveMode::Limp {
            // Muscles drive the bodies toward the pose of the clips.
            self.drive_bodies(world);
        }
        let dt = world.def().dt();
        let on_ground = self.is_in_world();
        let Activity::Limp(lying) = &mut self.activity else { return };
        let still = &mut lying.stillness;
        let is_slack = still.friction_share(dt) >= 1.0;
        still.steps += 1;
        if !is_slack {
            self.physique.slacken(&self.def, still.friction_share(dt), world);
        }
        let lain = still.look(world, self.physique.own(), on_ground);
        if lain.touched {
            self.events.push(CharacterEvent::Touched);
        }
        if let Some(calm) = lain.settled {
            self.events.push(CharacterEvent::Settled { since: world.time() as f32 - calm });
        }
        if self.mind_grips(world) {
            return;
        }
        let gets_up = self.after_settling == AfterSettling::GetUp && self.physique.may_get_up(&self.def);
        let is_down = self.lies_on_ground(world);
        let Activity::Limp(Lying { stillness: still, .. }) = &mut self.activity else { return };
        let impatient = !still.settled && still.steps as f32 * dt >= self.def.patience;
        if !gets_up || !(still.settled || impatient) {
            return;
        }
        if !is_down {
            return still.wait(dt);
        }
        if impatient {
            self.events.push(CharacterEvent::NeverSettled);
            still.settled = true;
        }
        self.prepare(world);
    }

    /// Updates a limp character's contact rule and returns true while it is held. Movers pass through a held character,
    /// so that it does not block the character that drags it.
    fn mind_grips(&mut self, world: &mut World) -> bool {
        let is_gripped = self.grips.is_gripped(&self.physique, world);
        let ragdoll = self.physique.limp();
        let now = world.contact_rule(ShapeId { body: ragdoll.bodies[0], shape: 0 });
        if is_gripped && now == ContactRule::Push {
            ragdoll.set_rule(world, self.def.in_world.rule());
        } else if !is_gripped && now != ContactRule::Push && !is_entered(world, self.physique.own()) {
            ragdoll.set_rule(world, ContactRule::Push);
        }
        if let Some(still) = self.activity.stillness_mut().filter(|_| is_gripped) {
            still.wait(world.def().dt());
        }
        is_gripped
    }

    /// Advances a preparing character by a step. It gets up once its body is near the start of the clip, or its time to
    /// prepare is over.
    fn go_preparing(&mut self, world: &mut World) {
        self.follow_bodies(world);
        let stays = self.after_settling == AfterSettling::StayDown || !self.lies_on_ground(world);
        if stays || self.grips.is_gripped(&self.physique, world) {
            return self.go_limp(world);
        }
        let Activity::Preparing(preparing) = &mut self.activity else { return };
        preparing.stillness.steps += 1;
        preparing.seconds -= world.def().dt();
        let preparing = *preparing;
        let def = self.def.clone();
        let moves = def.moves();
        let lies = self.figure.stance(&def, &mut self.scratch);
        let get_up = &moves.get_ups[preparing.get_up as usize];
        let start = &get_up.starts[preparing.start as usize];
        let choice = Choice { get_up, start, pose_similarity: moves.landmarks.compare(&start.stance, &lies) };
        let is_over = preparing.seconds <= 0.0 || choice.is_reached(&def, lies.pelvis);
        self.scratch.points = lies.points;
        if is_over {
            return self.get_up_where_free(world);
        }
        prepare::draw(&def, &choice, &mut self.physique, &mut self.scratch, world);
    }

    /// Returns true if the ground supports the lying character; a character that is carried does not get up. Always
    /// true outside of a world.
    fn lies_on_ground(&self, world: &World) -> bool {
        !self.is_in_world() || ground::bears(&self.def.ragdoll, self.physique.own(), world)
    }

    /// Takes transform and pose from the bodies, except for joints without a body.
    fn follow_bodies(&mut self, world: &World) {
        self.figure.keep_earlier();
        if self.is_in_world() {
            self.physique.take_along(&mut self.figure.place, world, &mut self.scratch);
        }
        let animator = &mut self.gait.animator;
        animator.update(self.def.set(), world.def().dt());
        self.physique.pose(&self.def, &mut self.figure, world, &mut self.scratch);
        for &joint in self.def.mapping().free() {
            self.figure.pose[joint] = self.gait.animator.pose().get(joint);
        }
    }

    /// Advances springs and garments.
    fn go_on_wearing(&mut self, world: &mut World) {
        let is_far = self.level_of_detail() <= Detail::Keyed;
        let mends = self.state() == State::Animated;
        let bearer = Bearer {
            def: &self.def,
            pose: self.feet.led(&self.figure.pose),
            place: self.figure.place,
            physique: &self.physique,
        };
        self.wear.go_on(bearer, &self.figure.shown, (is_far, mends), &mut self.scratch, world);
    }

    /// Stores the shown pose for [`interpolated`](Self::interpolated).
    fn keep_shown(&mut self) {
        let mut pose = core::mem::take(&mut self.figure.shown.pose);
        pose.clear();
        pose.extend_from_slice(self.pose());
        self.figure.shown = Moment { pose, place: self.figure.place };
    }
}
