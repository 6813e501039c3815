//! Metrics of a brawl.

use super::readings::Readings;
use super::{Fighter, ROOM};
use crate::framework::metric::{Expected, Metric};
use sinew::math::{ReadError, Reader, Vec3, Writer, max};
use sinew::physics::{BodyId, World};
use sinew::ragdoll::{CharacterEvent, State};

/// States of a character that have separate metrics.
pub(super) const STATES: [State; 6] =
    [State::Animated, State::Flinching, State::Powered, State::Limp, State::Preparing, State::GettingUp];
/// Number of steps between measurements of the penetration into static bodies.
const LOOKS: u64 = 4;
/// Number of steps after a hit in which a limb's speed is attributed to the hit.
const BLOW_LASTS: u32 = 30;
/// Number of steps after which a character that has not got up is stuck.
const STUCK: u32 = 480;
/// Speed of the pelvis below which a fallen character counts as lying, m/s.
const LIES: f32 = 0.3;
/// Distance of standing characters from a fallen character's pelvis that leaves room to get up, metres.
const ROOM_TO_RISE: f32 = 0.6;
/// Depth from which an overlap is visible, metres.
const SEEN: f64 = 0.02;

/// Record of one character from step to step.
#[derive(Clone, Default)]
pub(super) struct Watched {
    /// Joint positions in the last three frames, the latest first.
    frames: [Vec<Vec3>; 3],
    /// For the last two updates, the latest first: the state's index, and whether a hit preceded the update.
    states: [u8; 2],
    blows: [bool; 2],
    /// Steps since the last hit, steps since the fall, and number of steps in which the character lay with room to
    /// get up.
    since_blow: u32,
    down: u32,
    roomy: u32,
    limp: u32,
    lies: bool,
    rises: bool,
}

impl Watched {
    pub fn be_struck(&mut self) {
        self.since_blow = 0;
        self.blows[0] = true;
    }

    pub fn save(&self, out: &mut Writer) {
        for frame in &self.frames {
            out.count(frame.len());
            frame.iter().for_each(|&place| out.vec3(place));
        }
        self.states.iter().for_each(|&state| out.u8(state));
        self.blows.iter().for_each(|&blow| out.bool(blow));
        [self.since_blow, self.down, self.roomy, self.limp].into_iter().for_each(|x| out.u32(x));
        out.bool(self.lies);
        out.bool(self.rises);
    }

    pub fn load(&mut self, bytes: &mut Reader<'_>) -> Result<(), ReadError> {
        for frame in &mut self.frames {
            frame.clear();
            for _ in 0..bytes.count(12)? {
                frame.push(bytes.vec3()?);
            }
        }
        for state in &mut self.states {
            *state = u8::min(bytes.u8()?, STATES.len() as u8 - 1);
        }
        self.blows = [bytes.bool()?, bytes.bool()?];
        (self.since_blow, self.down) = (bytes.u32()?, bytes.u32()?);
        (self.roomy, self.limp) = (bytes.u32()?, bytes.u32()?);
        (self.lies, self.rises) = (bytes.bool()?, bytes.bool()?);
        Ok(())
    }

    /// Largest displacement of a joint in the second to last frame beyond those of the neighbouring frames, metres.
    fn jump(&self, now: &[Vec3]) -> f32 {
        let [c, b, a] = &self.frames;
        if a.len() != now.len() || b.len() != now.len() || c.len() != now.len() {
            return 0.0;
        }
        let way = |from: Vec3, to: Vec3| (to - from).length();
        let beyond = |i: usize| way(b[i], c[i]) - max(way(a[i], b[i]), way(c[i], now[i]));
        (0..now.len()).map(beyond).fold(0.0, max)
    }

    fn push(&mut self, now: Vec<Vec3>, state: u8) {
        self.frames.rotate_right(1);
        self.frames[0] = now;
        self.states = [state, self.states[0]];
        self.blows = [false, self.blows[0]];
    }
}

/// Metrics of all characters.
#[derive(Default)]
pub(super) struct Watch {
    /// Static bodies: floor, walls, stairs.
    stands: Vec<BodyId>,
    /// Counts and sizes, in the order of [`COUNTS`] and [`SIZES`].
    counts: [u32; COUNTS.len()],
    sizes: [f32; SIZES.len()],
    readings: Readings,
    work_in: f32,
}

const COUNTS: [&str; 11] =
    ["blows", "seen", "down", "falls", "rises", "rises_up", "rises_fall", "deep", "outside", "stuck", "lost"];
const SIZES: [&str; 15] = [
    "animated_ms",
    "flinching_ms",
    "powered_ms",
    "limp_ms",
    "preparing_ms",
    "getting_up_ms",
    "struck_ms",
    "depth_m",
    "to_animated_m",
    "to_flinching_m",
    "to_powered_m",
    "to_limp_m",
    "to_preparing_m",
    "to_getting_up_m",
    "up_after_s",
];

fn state_index(state: State) -> usize {
    STATES.iter().position(|&other| other == state).expect("`STATES` lists every state")
}

impl Watch {
    pub fn new(stands: Vec<BodyId>) -> Self {
        Self { stands, ..Self::default() }
    }

    pub fn add_work(&mut self, work: f32) {
        self.work_in += work;
    }

    pub fn work_in(&self) -> f32 {
        self.work_in
    }

    pub fn count_blow(&mut self) {
        self.count("blows", 1);
    }

    fn count(&mut self, name: &str, by: u32) {
        self.counts[COUNTS.iter().position(|&other| other == name).expect("`COUNTS` lists the name")] += by;
    }

    fn size(&mut self, name: &str, value: f32) {
        let at = SIZES.iter().position(|&other| other == name).expect("`SIZES` lists the name");
        self.sizes[at] = max(self.sizes[at], value);
    }

    pub fn look(&mut self, world: &World, fighters: &mut [Fighter]) {
        self.count("lost", world.events().quarantined.len() as u32);
        let movers: Vec<Vec3> = fighters
            .iter()
            .map(|fighter| fighter.character.mover().map_or(Vec3::Y * -100.0, |m| world.mover(m).position()))
            .collect();
        for (index, fighter) in fighters.iter_mut().enumerate() {
            self.look_at(world, fighter);
            let hips = fighter.character.bodies()[0];
            let place = world.transform(hips).translation;
            let away = |mover: &Vec3| ((*mover - place) * Vec3::new(1.0, 0.0, 1.0)).length();
            let is_free = |(other, mover): (usize, &Vec3)| {
                other == index || mover.y < -50.0 || away(mover) > ROOM_TO_RISE
            };
            let has_room = movers.iter().enumerate().all(is_free) && !is_touched(world, fighter);
            let lies = world.velocity(hips).linear.length() < LIES;
            self.follow_fall(fighter, has_room, lies);
        }
        if world.step_count().is_multiple_of(LOOKS) {
            self.look_deep(world, fighters);
        }
    }

    fn look_at(&mut self, world: &World, fighter: &mut Fighter) {
        let def = fighter.character.def().clone();
        let state = state_index(fighter.character.state());
        let joints: Vec<Vec3> =
            def.ragdoll.bodies.iter().map(|body| fighter.model[body.joint].translation).collect();
        let watched = &mut fighter.watched;
        let [last, before] = watched.states;
        if last != before && !watched.blows[1] {
            let jump = watched.jump(&joints);
            self.size(SIZES[8 + last as usize], jump);
        }
        let is_long = watched.frames.iter().all(|frame| frame.len() == joints.len());
        if is_long && !watched.blows[0] {
            for (index, &now) in joints.iter().enumerate() {
                let before = [0, 1, 2].map(|frame| watched.frames[frame][index]);
                self.readings.add_joint(state, before, now);
            }
        }
        watched.push(joints, state as u8);
        watched.since_blow = watched.since_blow.saturating_add(1);
        let fastest = fighter
            .character
            .bodies()
            .iter()
            .map(|&body| world.velocity(body).linear.length())
            .fold(0.0, max);
        let struck = watched.since_blow <= BLOW_LASTS;
        self.size(if struck { "struck_ms" } else { SIZES[state] }, fastest);
        let place = world.transform(fighter.character.bodies()[0]).translation;
        let is_out = [place.x, place.z].iter().any(|x| x.abs() > ROOM + 0.2) || place.y < -0.5;
        self.count("outside", u32::from(is_out));
        self.count("seen", 1);
    }

    fn follow_fall(&mut self, fighter: &mut Fighter, has_room: bool, lies: bool) {
        let state = fighter.character.state();
        let is_down = matches!(state, State::Limp | State::Preparing | State::GettingUp);
        let events: Vec<CharacterEvent> = fighter.character.events().to_vec();
        let watched = &mut fighter.watched;
        if watched.rises && matches!(state, State::Limp | State::Preparing) {
            watched.rises = false;
            self.count("rises_fall", 1);
        }
        for event in events {
            match event {
                CharacterEvent::WentLimp => {
                    self.count(
                        "falls",
                        u32::from(!matches!(STATES[watched.states[1] as usize], State::Preparing)),
                    );
                    (watched.down, watched.roomy, watched.lies) = (0, 0, false);
                }
                CharacterEvent::GettingUp { .. } => {
                    watched.rises = true;
                    self.count("rises", 1);
                }
                CharacterEvent::Up => {
                    watched.rises = false;
                    self.count("rises_up", 1);
                    self.size("up_after_s", watched.roomy as f32 / 60.0);
                }
                _ => {}
            }
        }
        self.count("down", u32::from(is_down));
        watched.down = if is_down { watched.down + 1 } else { 0 };
        watched.lies |= is_down && lies;
        watched.roomy += u32::from(is_down && watched.lies && has_room);
        let is_limp = matches!(state, State::Limp | State::Preparing);
        watched.limp = if is_limp { watched.limp + 1 } else { 0 };
        self.count("stuck", u32::from(watched.limp == STUCK));
    }

    fn look_deep(&mut self, world: &World, fighters: &[Fighter]) {
        for fighter in fighters {
            let def = fighter.character.def();
            let state = state_index(fighter.character.state());
            for (&body, part) in fighter.character.bodies().iter().zip(&def.ragdoll.bodies) {
                let depth = self.stands.iter().map(|&stand| world.overlap(body, stand)).fold(0.0, max);
                self.size("depth_m", depth);
                if f64::from(depth) > SEEN {
                    self.count("deep", 1);
                    self.readings.add_deep(state, &part.role);
                }
            }
        }
    }

    pub fn save(&self, out: &mut Writer) {
        self.counts.iter().for_each(|&count| out.u32(count));
        self.sizes.iter().for_each(|&size| out.f32(size));
        self.readings.save(out);
        out.f32(self.work_in);
    }

    pub fn load(&mut self, bytes: &mut Reader<'_>) -> Result<(), ReadError> {
        for count in &mut self.counts {
            *count = bytes.u32()?;
        }
        for size in &mut self.sizes {
            *size = bytes.f32()?;
        }
        self.readings.load(bytes)?;
        self.work_in = bytes.f32()?;
        Ok(())
    }

    /// Returns the metrics so far, with the expectations of a crowd in a game.
    pub fn metrics(&self) -> Vec<Metric> {
        let count = |name: &str| {
            f64::from(
                self.counts[COUNTS.iter().position(|&other| other == name).expect("`COUNTS` lists the name")],
            )
        };
        let share = |part: f64, of: f64| if of > 0.0 { part / of } else { 0.0 };
        let ended = count("rises_up") + count("rises_fall");
        let mut metrics = vec![
            Metric::new("down_share", share(count("down"), count("seen")), Expected::AtMost(0.45)),
            Metric::new("rises_lost_share", share(count("rises_fall"), ended), Expected::AtMost(0.3)),
        ];
        let expected = |name: &str| match name {
            "outside" | "stuck" | "lost" => Expected::AtMost(0.0),
            "struck_ms" => Expected::Anything,
            "depth_m" => Expected::AtMost(SEEN),
            "up_after_s" => Expected::AtMost(4.0),
            name if name.ends_with("_ms") => Expected::AtMost(15.0),
            name if name.ends_with("_m") => Expected::AtMost(0.08),
            _ => Expected::Anything,
        };
        let counts = COUNTS.iter().zip(self.counts);
        metrics.extend(counts.map(|(&name, value)| Metric::new(name, value, expected(name))));
        let sizes = SIZES.iter().zip(self.sizes);
        metrics.extend(sizes.map(|(&name, value)| Metric::new(name, value, expected(name))));
        metrics.extend(self.readings.metrics());
        metrics
    }
}

/// Returns true if another character's body touches a body of `fighter`.
fn is_touched(world: &World, fighter: &Fighter) -> bool {
    let own = fighter.character.bodies();
    let owned = |body: BodyId| world.body_owner(body).is_some();
    own.iter().any(|&body| world.neighbors(body).any(|other| !own.contains(&other) && owned(other)))
}
