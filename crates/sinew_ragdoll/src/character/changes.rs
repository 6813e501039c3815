//! State changes of a character that involve several of its components.

use super::activity::{Activity, Flinch};
use super::clearance::Depths;
use super::feet::Depth;
use super::figure::Scratch;
use super::foresight::Foresight;
use super::get_up::{Choice, Rising, Way, choose, is_taken, is_under, standing};
use super::hit_bodies::Strike;
use super::limp::{Lying, Stillness};
use super::prepare::Preparing;
use super::rises::Grounds;
use super::stumble::{Balance, Balancing};
use super::wear::{Bearer, Wear};
use super::{
    Blow, Character, CharacterEvent, Detail, FootPlanting, GettingReady, HitBodies, Locomotion, State,
    Toughness, blows, ground, powered, prepare,
};
use crate::character::tuning::{
    ABOVE_PELVIS, BACK_WITHIN, FELLING_SPEED, FLINCH_KEYS, INTO_GET_UP, INTO_LOOP, INTO_STANDING, LYING_MOVER,
};
use crate::drive::{DriveMode, Muscle};
use crate::ragdoll::BodyState;
use sinew_anim::{LoopMode, Pose, Track, TrackDef, TrackId, local_to_model};
use sinew_math::{Affine, Transform, Vec3};
use sinew_physics::{BodyId, BodyKind, ContactRule, JointId, World, Yields};

impl Character {
    pub(super) fn is_in_world(&self) -> bool {
        self.detail.is_some()
    }

    /// Returns true if the character's feet follow the ground.
    pub(super) fn follows_ground(&self) -> bool {
        self.def.in_world.foot_planting == FootPlanting::OnGround
            && self.def.motions().locomotion != Locomotion::Exact
            && self.def.in_world.hit_bodies != HitBodies::Absent
            && self.detail.is_some_and(|detail| detail > Detail::Frozen)
    }

    pub(super) fn is_frozen(&self) -> bool {
        self.detail == Some(Detail::Frozen) && self.state() == State::Animated
    }

    /// Returns true if the character takes steps to recover from pushes.
    pub(super) fn steps(&self) -> bool {
        matches!(self.activity, Activity::Powered(_))
            && self.def.in_world.most_steps > 0
            && self.def.legs().is_some()
            && self.gait.mover.is_some()
            && self.physique.lost.is_empty()
    }

    // Detail

    /// Adds or removes bodies and mover according to the character's level of detail.
    pub(super) fn settle_detail(&mut self, world: &mut World) {
        let Some(detail) = self.detail else { return };
        if self.state() != State::Animated || self.physique.ragdoll.is_some() {
            return;
        }
        let wants = detail >= Detail::HitBodies && self.def.in_world.hit_bodies != HitBodies::Absent;
        let has = !self.physique.hit.is_empty();
        if wants && !has {
            self.enter_bodies(world);
        } else if !wants && has && self.grips.holds.is_empty() {
            self.wear.garments.take_off(world);
            self.physique.remove_hit(world);
        }
        if detail == Detail::Frozen {
            self.sit_down(world);
        } else {
            self.stand_up(world, 1.0);
        }
    }

    /// Adds hit bodies to the world in the character's pose.
    fn enter_bodies(&mut self, world: &mut World) {
        let HitBodies::Present(yields) = self.def.in_world.hit_bodies else { return };
        let mut poses = Vec::new();
        let pose = self.feet.led(&self.figure.pose);
        self.scratch.hit_bodies_of(&self.def, pose, self.figure.place, &mut poses);
        self.physique.enter(&self.def, &poses, ContactRule::Yields(yields), world);
        self.grips.bearer = None;
        let (wear, bearer) = self.wearing();
        wear.dress(bearer, world);
    }

    /// Removes the character's bodies, joints and mover from the world; its clips continue at its last position.
    pub(super) fn leave(&mut self, world: &mut World) {
        self.grips.release_all(self.physique.own(), false, world, &mut self.events);
        self.wear.garments.take_off(world);
        if let Some(ragdoll) = self.physique.ragdoll.take() {
            self.physique.drives.release(world, &ragdoll);
            ragdoll.despawn(world);
            self.physique.hit.clear();
            self.physique.keep_own();
        }
        self.sit_down(world);
        self.physique.remove_hit(world);
        self.detail = None;
    }

    /// Adds a mover at the character's position, at a share of its full height.
    fn stand_up(&mut self, world: &mut World, share: f32) {
        if self.is_in_world() {
            self.gait.stand_up(&self.def, self.figure.place.translation, world, share);
        }
    }

    /// Removes the mover of a lying character.
    fn sit_down(&mut self, world: &mut World) {
        self.gait.sit_down(world);
        self.grips.spare_bearer(self.physique.own(), None, world);
    }

    // Bodies and clips

    /// Returns the predictor of the clips' poses, and the buffers that it uses.
    fn ahead(&mut self) -> (Foresight<'_>, &mut Scratch) {
        let foresight = Foresight {
            def: &self.def,
            state: self.activity.state(),
            gait: &self.gait,
            figure: &self.figure,
            feet: &self.feet,
            stumble: self.activity.stumble(),
            leads: matches!(self.activity, Activity::Flinching(_)),
        };
        (foresight, &mut self.scratch)
    }

    /// Returns true if every body is near its pose in the clips; false if, for instance, an obstacle keeps a body away.
    pub(super) fn is_at_clips(&mut self, world: &World) -> bool {
        let (foresight, scratch) = self.ahead();
        foresight.next(world.def().dt(), scratch);
        let bodies = self.physique.ids().iter().zip(&self.scratch.before).enumerate();
        bodies.filter(|(index, _)| self.physique.has(*index)).all(|(_, (&id, clip))| {
            (world.transform(id).translation - clip.translation).length() < BACK_WITHIN
        })
    }

    fn carried(&mut self) -> Vec<BodyState> {
        let (foresight, scratch) = self.ahead();
        foresight.carried(scratch)
    }

    /// Drives the bodies toward the pose that the clips will have at the end of the next step.
    pub(super) fn drive_bodies(&mut self, world: &mut World) {
        if self.physique.ragdoll.is_some() {
            let (foresight, scratch) = self.ahead();
            foresight.next(world.def().dt(), scratch);
            self.physique.drive(&self.def, &self.scratch.after, &self.scratch.velocities, world);
        }
    }

    /// Turns the bodies into a ragdoll at the pose and speed of the animation, and sets the drive `mode` for all of
    /// them.
    pub(super) fn take_bodies(&mut self, world: &mut World, mode: DriveMode, half_life: f32) {
        if self.physique.ragdoll.is_none() {
            self.become_bodies(world, self.def.in_world.rule());
            self.physique.drives.set_all(mode, half_life);
        }
    }

    /// Makes the bodies dynamic, with joints between them.
    fn become_bodies(&mut self, world: &mut World, rule: ContactRule) {
        if !self.feet.pose.is_empty() {
            self.figure.pose.clone_from(&self.feet.pose);
            self.feet.pose.clear();
        }
        let mut states = self.carried();
        self.physique.bound_change(&mut states, world);
        self.feet.passage = Default::default();
        self.physique.physical.rebase(self.def.mapping(), &self.def.rig, &self.figure.pose);
        self.scratch.posed.clear();
        self.physique.wake(&self.def, &states, rule, world);
    }

    /// Lets the clips move the bodies again: the bodies leave the world, or stay in it as hit bodies.
    pub(super) fn leave_bodies(&mut self, world: &mut World) {
        self.physique.let_go(&self.def, world);
        let Some(ragdoll) = self.physique.ragdoll.take() else { return };
        if self.physique.hit.is_empty() {
            self.wear.garments.take_off(world);
            ragdoll.despawn(world);
        } else {
            self.physique.before.clear();
            ragdoll.lull(world, self.def.in_world.rule());
        }
        self.physique.keep_own();
    }

    /// Gives those of `bodies` that are kinematic the velocities of their clips. Their present velocities move them to
    /// their pose within a step and would throw them once dynamic, for instance after the mover climbed a kerb.
    fn slow_led(&mut self, world: &mut World, bodies: &[usize]) {
        let (foresight, scratch) = self.ahead();
        foresight.next(world.def().dt(), scratch);
        let ragdoll = self.physique.limp();
        for (id, velocity) in bodies.iter().map(|&body| (ragdoll.bodies[body], self.scratch.velocities[body]))
        {
            if world.kind(id) == BodyKind::Kinematic {
                world.set_velocity(id, velocity);
            }
        }
    }

    // Blows

    pub(super) fn strike(
        &mut self,
        world: &mut World,
        body: usize,
        impulse: Vec3,
        point: Option<Vec3>,
    ) -> f32 {
        assert!(body < self.def.ragdoll.bodies.len(), "the character has no body with the index {body}");
        if self.physique.has(body) && self.react(world, body, impulse) {
            self.physique.push(&self.def, body, impulse, point, world)
        } else {
            0.0
        }
    }

    /// Makes the character flinch or fall after a contact hit one of its bodies. If that body was dynamic, the contact
    /// has already applied the impulse.
    pub(super) fn be_struck(&mut self, world: &mut World, body: usize, strike: Strike) {
        let is_led = world.kind(self.physique.ids()[body]) != BodyKind::Dynamic;
        if self.react(world, body, strike.impulse) && is_led {
            self.physique.take_up(&self.def, body, strike, world);
        }
    }

    /// Makes the character flinch or fall after an impulse on a body; returns false if the impulse must not be applied
    /// to the bodies.
    pub(super) fn react(&mut self, world: &mut World, body: usize, impulse: Vec3) -> bool {
        assert!(impulse.is_finite(), "the impulse must be finite");
        assert!(body < self.def.ragdoll.bodies.len(), "the character has no body with the index {body}");
        if self.stands_blow(Blow { body, impulse, state: self.state() }) {
            return self.flinch(world, body, impulse);
        }
        self.go_limp(world);
        self.events.push(CharacterEvent::Hit { body });
        self.physique.drives.hit(&self.def.ragdoll, body, impulse.length());
        true
    }

    fn stands_blow(&self, blow: Blow) -> bool {
        self.is_in_world()
            && self.state() != State::Limp
            && match self.def.in_world.toughness {
                Toughness::None => false,
                Toughness::Impulse(least) => {
                    let lowness = self.activity.lowness(&self.def, &self.gait.animator);
                    self.steps() || blow.impulse.length() < blows::felling(least, lowness)
                }
                Toughness::Function(fells) => !fells(&self.def, &blow),
            }
    }

    /// Returns true if a field that gave the character this momentum makes it fall. With
    /// [`Toughness::None`](super::Toughness::None) the default threshold applies, so that light wind does not make the
    /// character fall.
    pub(super) fn is_swept_by(&self, blow: Blow) -> bool {
        let lowness = self.activity.lowness(&self.def, &self.gait.animator);
        let fells = |least: f32| blow.impulse.length() >= blows::felling(least, lowness);
        match self.def.in_world.toughness {
            Toughness::None => fells(FELLING_SPEED * self.def.ragdoll.total_mass),
            Toughness::Impulse(least) => fells(least),
            Toughness::Function(decides) => decides(&self.def, &blow),
        }
    }

    /// Makes the struck limb weak; returns false if the character's state does not allow a flinch.
    pub(super) fn flinch(&mut self, world: &mut World, body: usize, impulse: Vec3) -> bool {
        let state = self.state();
        let gives_way = match state {
            State::GettingUp => false,
            State::Animated => self.level_of_detail() == Detail::Full,
            _ => true,
        };
        if gives_way && state != State::Preparing {
            if state == State::Animated {
                self.take_bodies(world, DriveMode::Keyed, FLINCH_KEYS);
                self.activity = Activity::Flinching(Flinch::begun());
            }
            if let Activity::Flinching(flinch) = &mut self.activity {
                blows::give_way(&self.def.ragdoll, body, &mut self.physique.drives);
                *flinch = Flinch::begun();
            }
        }
        if gives_way {
            self.physique.drives.hit(&self.def.ragdoll, body, impulse.length());
        }
        self.events.push(CharacterEvent::Flinched { body });
        if gives_way && state != State::Preparing {
            if self.steps() {
                blows::tense(&self.def.ragdoll, &mut self.physique.drives);
                self.shove(world, impulse);
            }
            self.drive_bodies(world);
        }
        gives_way
    }

    /// Reports an impulse on the bodies of a powered character (N·s) to its balance, which may start a step.
    fn shove(&mut self, world: &mut World, impulse: Vec3) {
        let Activity::Powered(balance) = &mut self.activity else { return };
        let on = Balancing {
            def: &self.def,
            place: self.figure.place,
            gait: &self.gait,
            physique: &self.physique,
        };
        if balance.shove(on, impulse, &mut self.scratch, world, &mut self.events) {
            self.steer(world);
        }
    }

    /// Lets clips move all bodies again.
    pub(super) fn recover(&mut self, world: &mut World) {
        let (foresight, scratch) = self.ahead();
        foresight.next(world.def().dt(), scratch);
        self.leave_bodies(world);
        self.activity = Activity::Animated;
        self.events.push(CharacterEvent::Recovered);
        self.physique.lead_to(&self.scratch.before, &self.scratch.after, world);
    }

    // Powered

    /// Makes muscles and pins drive all bodies to the clips.
    pub(super) fn power(&mut self, world: &mut World) {
        self.end_clearing(world);
        self.take_bodies(world, DriveMode::Powered(Muscle::ALIVE), 0.0);
        powered::set_drives(&self.def, &mut self.physique, world);
        self.become_powered();
        self.drive_bodies(world);
    }

    pub(super) fn become_powered(&mut self) {
        if self.state() != State::Powered {
            self.activity = Activity::Powered(Balance::default());
            self.events.push(CharacterEvent::Powered);
        }
    }

    // Limp characters

    /// Makes an animated character limp at the pose and speed of the animation.
    pub(super) fn fall(&mut self, world: &mut World) {
        if self.physique.ragdoll.is_some() {
            return self.fall_again(world);
        }
        self.grips.release_all(self.physique.own(), true, world, &mut self.events);
        self.become_bodies(world, ContactRule::Push);
        self.feet.leave();
        self.physique.let_linger(&self.figure, world.def().dt(), &mut self.scratch);
        self.sit_down(world);
        self.physique.drives.set_all(self.def.falling, 0.0);
        self.activity = Activity::Limp(Lying::default());
        self.physique.slacken(&self.def, 0.0, world);
        self.events.push(CharacterEvent::WentLimp);
        self.clear(world);
    }

    /// Makes a preparing or powered character limp again.
    fn fall_again(&mut self, world: &mut World) {
        let powered = match self.state() {
            State::Flinching | State::Powered => true,
            State::Preparing => false,
            State::Animated | State::Limp | State::GettingUp => return,
        };
        let all: Vec<usize> =
            (0..self.def.ragdoll.bodies.len()).filter(|&body| self.physique.has(body)).collect();
        self.slow_led(world, &all);
        self.physique.let_go(&self.def, world);
        let stillness = Stillness { touched: !powered, ..Stillness::default() };
        self.activity = Activity::Limp(Lying { stillness, ..Lying::default() });
        self.feet.leave();
        if powered {
            self.grips.release_all(self.physique.own(), true, world, &mut self.events);
            self.physique.let_linger(&self.figure, world.def().dt(), &mut self.scratch);
            self.physique.physical.rebase(self.def.mapping(), &self.def.rig, &self.figure.pose);
            self.scratch.posed.clear();
            self.sit_down(world);
            self.physique.set_rule(world, ContactRule::Push);
            self.physique.slacken(&self.def, 0.0, world);
        }
        self.events.push(CharacterEvent::WentLimp);
        self.clear(world);
    }

    /// Continues the displacement out of a wall in the next step, or lets the bodies fall once it has ended.
    pub(super) fn go_out(&mut self, world: &mut World) {
        let Activity::Limp(lying) = &mut self.activity else { return };
        if !lying.clearing.go_on(self.physique.own(), world) {
            self.end_clearing(world);
        }
    }

    /// Ends a displacement out of a wall: the bodies fall from their current positions.
    pub(super) fn end_clearing(&mut self, world: &mut World) {
        let Activity::Limp(lying) = &mut self.activity else { return };
        let clearing = core::mem::take(&mut lying.clearing);
        if !clearing.velocities.is_empty() {
            clearing.end(self.physique.own(), world);
            self.physique.set_rule(world, ContactRule::Push);
        }
    }

    // Getting up

    /// Starts a get-up, or first drives the body to the start of a get-up clip.
    pub(super) fn prepare(&mut self, world: &mut World) {
        let def = self.def.clone();
        let lies = self.figure.stance(&def, &mut self.scratch);
        let choice = choose(&def, &lies).filter(|choice| {
            def.getting_ready == GettingReady::RollOver && !choice.is_near(&def, lies.pelvis)
        });
        self.scratch.points = lies.points;
        let Some(choice) = choice else { return self.get_up_where_free(world) };
        let rolls = choice.rolls(lies.pelvis);
        let stillness = self.activity.stillness().copied().unwrap_or_default();
        self.activity = Activity::Preparing(Preparing::toward(&def, &choice, rolls, stillness));
        self.events.push(CharacterEvent::Preparing { rolls });
        prepare::set_drives(&def, rolls, &mut self.physique, world);
        prepare::draw(&def, &choice, &mut self.physique, &mut self.scratch, world);
    }

    /// Starts a get-up if no body loads the character and no mover is in the way; otherwise the character waits.
    pub(super) fn get_up_where_free(&mut self, world: &mut World) {
        let lies = self.figure.stance(&self.def, &mut self.scratch);
        let moves = self.def.moves();
        let place = match choose(&self.def, &lies) {
            Some(choice) => choice.pose_similarity.motion,
            None => moves.landmarks.compare(&moves.upright, &lies).motion,
        };
        self.scratch.points = lies.points;
        let steps = self.activity.stillness().map_or(0, |still| still.steps);
        let waits = self.is_in_world()
            && (is_taken(&self.def, world, place.translation)
                || is_under(&self.def, self.physique.own(), steps, world));
        let Some(still) = self.activity.stillness_mut() else { return };
        // Wait for one more update: a character on top may have got up in this update, and its bodies move away only in
        // the next step.
        if core::mem::replace(&mut still.free, !waits) && !waits {
            self.get_up(world);
        }
    }

    /// Starts the get-up clip that fits the pose best, at the time that fits best.
    pub(super) fn get_up(&mut self, world: &mut World) {
        let def = self.def.clone();
        let moves = def.moves();
        let lies = self.figure.stance(&def, &mut self.scratch);
        let lying = self.scratch.before.clone();
        let own = self.detail.map(|_| self.physique.own());
        let lean = ground::slope(world, &lies.points, own, def.ragdoll.total_mass);
        let choice = choose(&def, &lies);
        let way = match choice {
            Some(Choice { get_up, start, pose_similarity }) => {
                self.settle_into(world, pose_similarity.motion, lean, INTO_GET_UP);
                self.pass(world, get_up.deepest, INTO_GET_UP);
                self.feet.pass_to(&def, &lying, pose_similarity.motion, &start.bodies);
                let once =
                    TrackDef { start: start.time, loop_mode: LoopMode::Once, ..TrackDef::new(get_up.id) };
                Way::ByClip(self.gait.animator.play(def.set(), &once))
            }
            None => {
                let upright = moves.landmarks.compare(&moves.upright, &lies).motion;
                self.settle_into(world, upright, lean, INTO_STANDING);
                self.pass(world, moves.deepest, INTO_STANDING);
                def.play_looped(&mut self.gait.animator, 0.0);
                Way::Without(INTO_STANDING)
            }
        };
        let clip = choice.map(|choice| choice.get_up.clip);
        self.events.push(CharacterEvent::GettingUp { clip });
        self.leave_bodies(world);
        self.activity = Activity::GettingUp(Rising { way, lean });
        if self.feet.are_placed() {
            self.feet.show(&def, State::GettingUp, &self.figure, &mut self.scratch.model);
        }
        self.stand_up(world, LYING_MOVER);
    }

    /// Blends from the end of a get-up clip into the looped clip.
    pub(super) fn stand(&mut self, world: &World) {
        let def = self.def.clone();
        let moves = def.moves();
        let stands = self.figure.stance(&def, &mut self.scratch);
        let own = self.detail.map(|_| self.physique.own());
        let from =
            self.feet.shown_depths(&def, &self.figure, Grounds { world, own }, &mut self.scratch.model);
        let upright = moves.landmarks.compare(&moves.upright, &stands).motion;
        self.settle_into(world, upright, Vec3::ZERO, INTO_LOOP);
        self.pass_from(world, from, moves.deepest, INTO_LOOP);
        def.play_looped(&mut self.gait.animator, 0.0);
        self.be_up();
    }

    pub(super) fn be_up(&mut self) {
        self.activity = Activity::Animated;
        self.events.push(CharacterEvent::Up);
    }

    /// Starts a transition of this many seconds to a pose no deeper than `to`, from the shown pose.
    fn pass(&mut self, world: &World, to: Depths, seconds: f32) {
        let own = self.detail.map(|_| self.physique.own());
        let (grounds, model) = (Grounds { world, own }, &mut self.scratch.model);
        let from = self.feet.shown_depths(&self.def, &self.figure, grounds, model);
        self.pass_from(world, from, to, seconds);
    }

    /// Starts a transition from a pose with the depths `from`.
    fn pass_from(&mut self, world: &World, from: Depth, to: Depths, seconds: f32) {
        let own = self.detail.map(|_| self.physique.own());
        let (grounds, model) = (Grounds { world, own }, &mut self.scratch.model);
        self.feet.pass(&self.def, from, to, seconds);
        if self.feet.is_passing() {
            self.feet.passage.follow_ground(&self.def, &self.figure, grounds, model);
        }
    }

    /// Moves the character to the ground at `place`, tilted by `lean`, stops all tracks of the whole body, and lets the
    /// present pose and motion decay within `seconds`. Does not change the world.
    fn settle_into(&mut self, world: &World, place: Transform, lean: Vec3, seconds: f32) {
        let def = self.def.clone();
        let own = self.detail.map(|_| self.physique.own());
        let here = self.figure.place;
        let model = &mut self.scratch.model;
        local_to_model(&def.rig, &self.figure.pose, &Affine::IDENTITY, model);
        let pelvis = model[def.ragdoll.bodies[0].joint].translation;
        let pelvis = def.mapping().world_from_model(here).point(pelvis);
        let height = ground::below(world, pelvis, ABOVE_PELVIS, own).unwrap_or(here.translation.y);
        self.take_over(world, standing(place, lean, pelvis, height), seconds);
    }

    /// Moves the character to `place` and plays its looped clip from `phase` seconds on. The present pose and motion
    /// decay within `seconds`.
    pub(super) fn return_to(&mut self, world: &mut World, place: Transform, phase: f32, seconds: f32) {
        self.end_clearing(world);
        self.grips.release_all(self.physique.own(), false, world, &mut self.events);
        if !self.feet.pose.is_empty() {
            self.figure.pose.clone_from(&self.feet.pose);
        }
        self.feet.leave();
        self.feet.passage = Default::default();
        self.take_over(world, place, seconds);
        let def = self.def.clone();
        def.play_looped(&mut self.gait.animator, phase);
        self.gait.teleport(place.translation, world);
        self.events.push(CharacterEvent::GettingUp { clip: None });
        self.leave_bodies(world);
        self.activity = Activity::GettingUp(Rising { way: Way::Without(seconds), lean: Vec3::ZERO });
        self.stand_up(world, 1.0);
    }

    /// Moves the character's frame to `place` while every joint keeps its world pose, stops all tracks of the whole
    /// body, and blends the present pose and motion into the next tracks within `seconds`.
    fn take_over(&mut self, world: &World, place: Transform, seconds: f32) {
        let def = self.def.clone();
        self.figure.reframe(&def, place);
        self.gait.climbing = 0.0;
        let pose = |pose: &[sinew_anim::LocalTransform]| -> Pose { pose.iter().copied().collect() };
        let (earlier, now) = (pose(&self.figure.earlier.pose), pose(&self.figure.pose));
        let animator = &mut self.gait.animator;
        animator.take_over(&earlier, &now, world.def().dt(), seconds);
        let stopped: Vec<TrackId> =
            animator.tracks().filter(|track| track.def().layer == 0).map(Track::id).collect();
        stopped.into_iter().for_each(|track| animator.stop(def.set(), track));
    }

    // Detached limbs

    /// Removes a limb's bodies and joints from the character and returns them. A character without bodies or joints in
    /// the world gets new ones for this.
    pub(super) fn part_with(&mut self, world: &mut World, parts: &[usize]) -> (Vec<BodyId>, Vec<JointId>) {
        let (bodies, joints) = if self.physique.ragdoll.is_some() {
            self.slow_led(world, parts);
            self.physique.cut(&self.def, parts, world)
        } else {
            let states = self.carried();
            self.physique.cut_led(&self.def, parts, states, world)
        };
        for &body in &bodies {
            // A detached body collides like any other body, but does not stop movers.
            let rule = ContactRule::Yields(Yields::default());
            world.set_contact_rule(sinew_physics::ShapeId { body, shape: 0 }, rule);
        }
        self.physique.lose(parts, &bodies);
        self.physique.part_bodies(&bodies, world);
        (bodies, joints)
    }

    /// Updates the character after a limb was detached: it continues without the limb's bodies, or goes limp.
    pub(super) fn live_on(&mut self, world: &mut World) {
        self.scratch.posed.clear();
        match &mut self.activity {
            // A character that lay still may fall again.
            Activity::Limp(lying) => {
                (lying.stillness.settled, lying.stillness.calm_steps) = (false, 0);
            }
            Activity::Preparing(_) => self.fall(world),
            Activity::Powered(balance) => balance.stumble = None,
            _ => {}
        }
        if self.state() != State::Limp && !self.physique.may_get_up(&self.def) {
            self.fall(world);
        }
        let (wear, bearer) = self.wearing();
        wear.rehang(bearer, world);
    }

    /// Returns the springs and garments, and the character's state on which they depend.
    pub(super) fn wearing(&mut self) -> (&mut Wear, Bearer<'_>) {
        let bearer = Bearer {
            def: &self.def,
            pose: self.feet.led(&self.figure.pose),
            place: self.figure.place,
            physique: &self.physique,
        };
        (&mut self.wear, bearer)
    }
}
