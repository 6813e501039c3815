//! Steps by which a powered character regains its balance after a push.
//!
//! A push gives the whole body a velocity. While the point at which the body would come to rest is over the feet,
//! muscles and pins absorb the push. If the point is beyond the feet, the character stumbles: its mover moves as a
//! pendulum on the planted feet, and a foot swings to the position that stops this pendulum, repeatedly. Once the
//! character has its requested speed, each foot steps back to its position in the clips. Muscles and pins drive the
//! bodies; inverse kinematics moves only the legs of their pose.

mod step;
mod support;

use super::event::Events;
use super::figure::Scratch;
use super::gait::Gait;
use super::physique::Physique;
use super::{CharacterDef, CharacterEvent, State, ground};
use crate::character::tuning::{
    AIMS_UNTIL, AIRBORNE, CAPTURE_MARGIN, CAUGHT_SHARE, CAUGHT_SPEED, DROP_TIME, FLIES_AFTER, HOME_TIME,
    HOPELESS, HURRY, LIFT, PELVIS_SINKS, RESUMES, SOLE_RIM, STEP_RANGE, STRAIN_COST, UNTOLD_MARGIN,
    WIDE_STEP,
};
use sinew_anim::ik::hold_feet;
use sinew_anim::{LocalTransform, local_to_model, smoothstep};
use sinew_math::{Affine, ReadError, Reader, Transform, Vec3, Writer, max, min, trig};
use sinew_physics::World;
use step::{Pendulum, Print, STEP_TIMES};
use support::Support;
pub(super) use support::level;

/// Number of steps of the world after which the mover has reached its requested speed.
const FOLLOWS: u32 = 4;

/// Constraint on a foot.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Footing {
    /// The foot follows its clips.
    Free,
    /// The foot stands on the ground, with its ankle at this transform in the world.
    Planted(Transform),
    /// The foot swings from one ankle transform to another; it has swung for `time` of `lasts` seconds. `home` is true
    /// if it returns to its position in the clips.
    Swinging { from: Transform, to: Transform, time: f32, lasts: f32, home: bool },
}

/// The current stumble.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stumble {
    /// Horizontal velocity over the ground, m/s.
    pub velocity: Vec3,
    /// Velocity of the ground, m/s.
    floor: Vec3,
    feet: [Footing; 2],
    steps: u32,
    /// Number of steps of the world since the stumble began.
    age: u32,
    /// True if the character has its requested speed and its feet return to the clips.
    caught: bool,
}

/// The feet and the centre of mass in the clips' pose.
struct Stand {
    center: Vec3,
    ankles: [Transform; 2],
    floor: Vec3,
    wish: Vec3,
    omega: f32,
}

/// Balance of a powered character.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Balance {
    /// Current stumble, with the steps that catch the character.
    pub stumble: Option<Stumble>,
}

/// State of a character on which its balance depends.
#[derive(Clone, Copy)]
pub(super) struct Balancing<'a> {
    pub def: &'a CharacterDef,
    /// Transform from character to world.
    pub place: Transform,
    pub gait: &'a Gait,
    pub physique: &'a Physique,
}

impl Balance {
    /// Adds an impulse that the character's bodies received, N·s; returns false if the character has no ground on which
    /// to step.
    pub fn shove(
        &mut self,
        on: Balancing<'_>,
        impulse: Vec3,
        scratch: &mut Scratch,
        world: &World,
        events: &mut Events,
    ) -> bool {
        let Some(stand) = on.clips_stand(world, scratch) else { return false };
        let push = level(impulse) / on.def.ragdoll.total_mass;
        if let Some(stumble) = &mut self.stumble {
            stumble.velocity += push;
            (stumble.age, stumble.steps) = (0, 0);
            stumble.regain(&stand.ankles);
        } else if on.is_off(&stand, push / stand.omega, CAPTURE_MARGIN) {
            self.begin(on, &stand, push, events);
        }
        true
    }

    /// Advances by a step; returns true if the character must fall because it cannot regain its balance. `steps` is
    /// true if the character may step.
    pub fn go_on(
        &mut self,
        on: Balancing<'_>,
        steps: bool,
        scratch: &mut Scratch,
        world: &World,
        events: &mut Events,
    ) -> bool {
        let stand = if steps { on.clips_stand(world, scratch) } else { None };
        let Some(stand) = stand else {
            if !steps || on.gait.air > FLIES_AFTER {
                self.stumble = None;
            }
            return false;
        };
        let Some(mut stumble) = self.stumble.take() else {
            let sway = on.sway(world, &stand);
            if on.is_off(&stand, sway, UNTOLD_MARGIN) {
                self.begin(on, &stand, sway * stand.omega, events);
            }
            return false;
        };
        stumble.age += 1;
        stumble.floor = stand.floor;
        if stumble.age >= FOLLOWS {
            // Take the velocity of the mover, because walls may have stopped it.
            stumble.velocity = level(on.gait.velocity - stand.floor);
        }
        let dt = world.def().dt();
        stumble.carry(dt);
        let falls = if stumble.caught {
            stumble.go_home(&stand, dt);
            false
        } else {
            on.catch(world, &stand, &mut stumble)
        };
        let is_over = stumble.caught && stumble.feet == [Footing::Free; 2];
        if is_over {
            events.push(CharacterEvent::Caught { steps: stumble.steps });
        }
        self.stumble = (!is_over).then_some(stumble);
        falls
    }

    fn begin(&mut self, on: Balancing<'_>, stand: &Stand, push: Vec3, events: &mut Events) {
        let Some(legs) = on.def.legs() else { return };
        let air = on.gait.beside.y + on.place.translation.y + legs.ankle_height + AIRBORNE;
        let footing = |ankle: Transform| {
            if ankle.translation.y < air {
                return Footing::Planted(ankle);
            }
            Footing::Swinging { from: ankle, to: ankle, time: 0.0, lasts: STEP_TIMES[0], home: false }
        };
        self.stumble = Some(Stumble {
            velocity: level(on.gait.velocity - stand.floor) + push,
            floor: stand.floor,
            feet: stand.ankles.map(footing),
            steps: 0,
            age: 0,
            caught: false,
        });
        events.push(CharacterEvent::Stumbled);
    }
}

impl Balancing<'_> {
    /// Advances the pendulum on the planted feet, and swings the feet to their goals. Returns true if the steps cannot
    /// stop the fall.
    fn catch(&self, world: &World, stand: &Stand, stumble: &mut Stumble) -> bool {
        let dt = world.def().dt();
        let mut body = self.pendulum(stand, stumble.velocity);
        let support = self.support(stumble.feet.map(Footing::planted));
        let on = support.nearest(body.brake());
        stumble.velocity += body.pushed(on, dt);
        body.velocity = stumble.velocity;
        for foot in 0..2 {
            self.aim(world, &body, stumble, foot);
        }
        if stumble.feet.iter().any(|foot| matches!(foot, Footing::Swinging { .. })) {
            return false;
        }
        let outside = support.outside(body.capture());
        let off = (body.velocity - body.wish).length();
        // Allow a larger speed error while the character walks, because its speed varies within each step and is
        // largest when a foot lands.
        let calm = CAUGHT_SPEED + CAUGHT_SHARE * body.wish.length();
        if support.outside(body.center + body.velocity / body.omega - body.goes_on()) <= CAPTURE_MARGIN
            && off < calm
        {
            stumble.caught = true;
        } else if outside > CAPTURE_MARGIN {
            if stumble.steps >= self.def.in_world.most_steps {
                return true;
            }
            self.begin_step(world, &body, stumble);
        }
        false
    }

    /// Updates the goal of a swinging foot, or puts the foot down soon if only the other foot can stop the fall.
    fn aim(&self, world: &World, body: &Pendulum, stumble: &mut Stumble, foot: usize) {
        let Footing::Swinging { from, to, time, lasts, home: false } = stumble.feet[foot] else { return };
        let Some(stance) = stumble.feet[1 - foot].planted().filter(|_| time < AIMS_UNTIL * lasts) else {
            return;
        };
        let mut print = self.print(body, foot, to, stance, lasts - time);
        let mut lasts = lasts;
        if from == to {
            // While both feet are in the air, the body keeps its velocity.
            print = self.print(body, foot, from, stance, lasts - time);
            if print.miss > HOPELESS * body.height {
                lasts = DROP_TIME;
                print = self.print(body, foot, from, stance, lasts - time);
            }
        }
        let at = print.at;
        let to = self.tread(world, foot, at);
        stumble.feet[foot] = Footing::Swinging { from, to, time, lasts, home: false };
    }

    /// Starts a step of the foot and with the duration for which the landing error, the reach and the time together
    /// cost least.
    fn begin_step(&self, world: &World, body: &Pendulum, stumble: &mut Stumble) {
        let plans = (0..2).flat_map(|foot| STEP_TIMES.map(|lasts| (foot, lasts)));
        let plans = plans.filter_map(|(foot, lasts)| {
            let (from, stance) = (stumble.feet[foot].planted()?, stumble.feet[1 - foot].planted()?);
            let print = self.print(body, foot, from, stance, lasts);
            let cost = print.miss + STRAIN_COST * print.strain + HURRY * (STEP_TIMES[0] - lasts);
            Some((cost, foot, from, print.at, lasts))
        });
        let Some((_, foot, from, at, lasts)) = plans.reduce(|a, b| if b.0 < a.0 { b } else { a }) else {
            return;
        };
        let to = self.tread(world, foot, at);
        stumble.feet[foot] = Footing::Swinging { from, to, time: 0.0, lasts, home: false };
    }

    fn print(&self, body: &Pendulum, foot: usize, from: Transform, stance: Transform, seconds: f32) -> Print {
        let other = 1 - foot;
        let on = self.support([0, 1].map(|foot| (foot == other).then_some(stance))).nearest(body.brake());
        let middle = |ankle: Transform, foot: usize| {
            let sole = self.sole(ankle, foot);
            level(sole[0] + sole[1]) * 0.5
        };
        body.print(foot, middle(from, foot), middle(stance, other), on, seconds)
    }

    /// Returns the transform of the ankle of a foot whose sole has its centre on the ground at `at`.
    fn tread(&self, world: &World, foot: usize, at: Vec3) -> Transform {
        let def = self.def;
        let legs = def.legs().expect("the character stands on feet");
        let place = self.place;
        let ankle = def.bind()[legs.chains[foot].end].to_rigid();
        let rotation = (place.rotation * ankle.rotation).normalize();
        let translation = at - level(rotation * legs.balls[foot]) * 0.5;
        let floor = place.translation.y;
        let own = self.physique.own();
        let over = Vec3::new(at.x, floor, at.z);
        let ground =
            ground::below(world, over, STEP_RANGE, Some(own)).filter(|y| (y - floor).abs() < STEP_RANGE);
        Transform::new(translation + Vec3::Y * (ground.unwrap_or(floor) + legs.ankle_height), rotation)
    }

    /// Returns the positions of heel and ball of a foot whose ankle has this transform.
    fn sole(&self, ankle: Transform, foot: usize) -> [Vec3; 2] {
        let legs = self.def.legs().expect("the character stands on feet");
        [ankle.translation, ankle.point(legs.balls[foot])]
    }

    /// Returns the area that the planted feet support; `ankles` are the left and the right one, `None` for a foot in
    /// the air.
    fn support(&self, ankles: [Option<Transform>; 2]) -> Support {
        let mut support = Support::new(SOLE_RIM * self.def.ragdoll.height);
        for (foot, ankle) in ankles.into_iter().enumerate() {
            if let Some(ankle) = ankle {
                support.add(self.sole(ankle, foot));
            }
        }
        support
    }

    fn pendulum(&self, stand: &Stand, velocity: Vec3) -> Pendulum {
        Pendulum {
            center: stand.center,
            velocity,
            wish: stand.wish,
            omega: stand.omega,
            heading: self.place.rotation,
            height: self.def.ragdoll.height,
        }
    }

    /// Returns true if a capture point at the offset `away` from the centre of mass is more than `margin` metres
    /// outside of the feet in the clips' pose.
    fn is_off(&self, stand: &Stand, away: Vec3, margin: f32) -> bool {
        let support = self.support(stand.ankles.map(Some));
        let center = support.nearest(stand.center);
        support.outside(center + away) > margin
    }

    /// Returns the planted feet in the clips' pose, if any.
    fn clips_stand(&self, world: &World, scratch: &mut Scratch) -> Option<Stand> {
        let ground = world.mover_ground(self.gait.mover?)?;
        let def = self.def;
        let legs = def.legs()?;
        let place = self.place;
        let mut wanted = core::mem::take(&mut scratch.wanted);
        wanted.clear();
        wanted.extend(self.gait.animator.pose().iter());
        let mut bodies = core::mem::take(&mut scratch.before);
        local_to_model(&def.rig, &wanted, &Affine::IDENTITY, &mut scratch.model);
        def.mapping().bodies_from_model(&scratch.model, place, &mut bodies);
        let weighed = bodies.iter().zip(&def.ragdoll.bodies);
        let sum =
            weighed.fold(Vec3::ZERO, |sum, (pose, body)| sum + pose.point(body.mass.center) * body.mass.mass);
        (scratch.wanted, scratch.before) = (wanted, bodies);
        let center = sum / def.ragdoll.total_mass;
        let root = def.mapping().world_from_model(place);
        let ankle = |foot: usize| (root * scratch.model[legs.chains[foot].end]).to_rigid();
        let height = max(center.y - place.translation.y, 0.2 * def.ragdoll.height);
        Some(Stand {
            center,
            ankles: [ankle(0), ankle(1)],
            floor: ground.velocity,
            wish: level(self.gait.wanted_walk(def, State::Powered, place.rotation, world.def().dt())),
            omega: (world.def().gravity.length() / height).sqrt(),
        })
    }

    /// Returns the offset of the bodies' capture point from that of the clips. It is large after a push that no hit
    /// reported.
    fn sway(&self, world: &World, stand: &Stand) -> Vec3 {
        let Some(ragdoll) = &self.physique.ragdoll else { return Vec3::ZERO };
        let (mut place, mut momentum) = (Vec3::ZERO, Vec3::ZERO);
        for (&id, body) in ragdoll.bodies.iter().zip(&self.def.ragdoll.bodies) {
            place += world.center_of_mass(id) * body.mass.mass;
            momentum += world.velocity(id).linear * body.mass.mass;
        }
        let mass = self.def.ragdoll.total_mass;
        let velocity = momentum / mass - self.gait.velocity;
        level(place / mass - stand.center + velocity / stand.omega)
    }
}

impl Footing {
    fn planted(self) -> Option<Transform> {
        match self {
            Self::Planted(ankle) => Some(ankle),
            Self::Free | Self::Swinging { .. } => None,
        }
    }
}

impl Stumble {
    /// Moves the legs of a pose of the clips to where the feet of the stumble will be after the given seconds. `way` is
    /// the displacement of the character until then, `place` its transform then.
    pub fn hold_feet(
        &self,
        def: &CharacterDef,
        place: Transform,
        way: Transform,
        seconds: f32,
        pose: &mut [LocalTransform],
        model: &mut Vec<Affine>,
    ) {
        let Some(legs) = def.legs() else { return };
        local_to_model(&def.rig, pose, &def.mapping().character_from_model(), model);
        let seen = (place * way).inverse();
        let lift = LIFT * def.ragdoll.height;
        let goals = [0, 1].map(|foot| {
            let clips = model[legs.chains[foot].end].to_rigid();
            let at = |ankle: Transform| {
                seen * Transform::new(ankle.translation + self.floor * seconds, ankle.rotation)
            };
            match self.feet[foot] {
                Footing::Free => clips,
                Footing::Planted(ankle) => at(ankle),
                Footing::Swinging { from, to, time, lasts, home } => {
                    let share = smoothstep((time + seconds) / lasts);
                    let (from, to) = (at(from), if home { clips } else { at(to) });
                    let way = from.translation * (1.0 - share) + to.translation * share;
                    let wide = min((to.translation - from.translation).length() / WIDE_STEP, 1.0);
                    let up = 4.0 * share * (1.0 - share) * lift * wide;
                    Transform::new(way + Vec3::Y * up, from.rotation.nlerp(to.rotation, share))
                }
            }
        });
        hold_feet(
            &def.rig,
            legs.pelvis,
            &legs.chains,
            &goals,
            [0.0, PELVIS_SINKS * def.ragdoll.height],
            pose,
            model,
        );
    }

    /// Restarts the stumble when a character that had regained its balance loses it again: feet that do not swing are
    /// planted at their present ankles.
    fn regain(&mut self, ankles: &[Transform; 2]) {
        self.caught = false;
        for (foot, &ankle) in self.feet.iter_mut().zip(ankles) {
            *foot = match *foot {
                Footing::Free => Footing::Planted(ankle),
                Footing::Swinging { from, time, lasts, .. } => {
                    Footing::Swinging { from, to: ankle, time: min(time, 0.5 * lasts), lasts, home: false }
                }
                planted => planted,
            };
        }
    }

    /// Moves planted feet with the ground, and swings the others.
    fn carry(&mut self, dt: f32) {
        let by = self.floor * dt;
        for foot in &mut self.feet {
            match foot {
                Footing::Free => {}
                Footing::Planted(ankle) => ankle.translation += by,
                Footing::Swinging { from, to, time, lasts, home } => {
                    from.translation += by;
                    to.translation += by;
                    *time += dt;
                    let (landed, home) = (*to, *home);
                    if *time >= *lasts {
                        *foot = if home { Footing::Free } else { Footing::Planted(landed) };
                        self.steps += u32::from(!home);
                    }
                }
            }
        }
    }

    /// Approaches the requested velocity, and returns the feet to the clips one by one.
    fn go_home(&mut self, stand: &Stand, dt: f32) {
        self.velocity += (stand.wish - self.velocity) * -trig::exp_m1(-RESUMES * dt);
        let swings = self.feet.iter().any(|foot| matches!(foot, Footing::Swinging { .. }));
        let off = |foot: usize| -> Option<(usize, Transform, f32)> {
            let from = self.feet[foot].planted()?;
            Some((foot, from, level(from.translation - stand.ankles[foot].translation).length()))
        };
        let farthest = [off(0), off(1)].into_iter().flatten().reduce(|a, b| if b.2 > a.2 { b } else { a });
        if let Some((foot, from, _)) = farthest.filter(|_| !swings) {
            self.feet[foot] =
                Footing::Swinging { from, to: stand.ankles[foot], time: 0.0, lasts: HOME_TIME, home: true };
        }
    }

    pub fn save(&self, w: &mut Writer) {
        w.vec3(self.velocity);
        w.vec3(self.floor);
        for foot in self.feet {
            let (tag, from, to, times) = match foot {
                Footing::Free => (0, Transform::IDENTITY, Transform::IDENTITY, [0.0; 2]),
                Footing::Planted(ankle) => (1, ankle, ankle, [0.0; 2]),
                Footing::Swinging { from, to, time, lasts, home } => {
                    (2 + u8::from(home), from, to, [time, lasts])
                }
            };
            w.u8(tag);
            w.transform(from);
            w.transform(to);
            times.into_iter().for_each(|x| w.f32(x));
        }
        w.u32(self.steps);
        w.u32(self.age);
        w.bool(self.caught);
    }

    pub fn load(r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let (velocity, floor) = (r.vec3()?, r.vec3()?);
        let mut foot = || {
            let (tag, from, to) = (r.u8()?, r.transform()?, r.transform()?);
            let (time, lasts) = (r.f32()?, r.f32()?);
            match tag {
                0 => Ok(Footing::Free),
                1 => Ok(Footing::Planted(from)),
                2 | 3 => Ok(Footing::Swinging { from, to, time, lasts, home: tag == 3 }),
                _ => Err(r.error("unknown constraint on a foot")),
            }
        };
        let feet = [foot()?, foot()?];
        Ok(Self { velocity, floor, feet, steps: r.u32()?, age: r.u32()?, caught: r.bool()? })
    }
}
