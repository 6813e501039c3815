//! A crowd that walks, is hit in waves, falls and gets up again.

use crate::demo::walking_mannequin;
use crate::framework::actors::Figure;
use crate::framework::camera_hint::{CameraHint, Trails};
use crate::framework::instance::Part;
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::floor;
use sinew::anim::local_to_model;
use sinew::math::{Affine, Random, ReadError, Reader, Rotation, Transform, Vec3, Writer, max};
use sinew::physics::{BodyId, World};
use sinew::ragdoll::{Character, CharacterDef, State};
use std::sync::Arc;

pub(in crate::scenes) const CROWD: Scene = Scene {
    chapter: Chapter::Ragdolls,
    name: "crowd",
    about: "mannequins walk together, are hit in waves, fall over each other, and all get up again",
    steps: 900,
    settings: &[
        Setting::whole("n", 12, (1, 2_000), "number of mannequins"),
        Setting::whole("waves", 3, (1, 100), "number of waves of hits, 1.5 s apart"),
        Setting::number("impulse", 70.0, (0.0, 500.0), "impulse of a hit, N·s"),
    ],
    build: crowd,
};

/// Distance from one character to the next at the start, metres.
const SPACING: f32 = 0.9;
/// Time of the first wave, and time between waves, seconds.
const FIRST_HIT: f32 = 0.75;
const BETWEEN_WAVES: f32 = 1.5;
/// Longest time from the hit until the character is up, seconds. A body under others has six seconds to come to
/// rest, one and a half for the roll, and three for the get-up.
const UP_WITHIN: f64 = 10.6;
/// States in the order in which characters are updated, with the names under which their cost is reported.
const STATES: [(State, &str); 4] = [
    (State::Animated, "animated"),
    (State::Limp, "limp"),
    (State::Preparing, "preparing"),
    (State::GettingUp, "getting_up"),
];

/// Rows of characters that all walk in about the same direction, each pushed forward or back, and a little sideways.
fn crowd(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    let def = Arc::new(walking_mannequin().0);
    let (count, waves) = (setup.whole("n"), setup.whole("waves"));
    let mut random = Random::new(5);
    let side = (1..).find(|side| side * side >= count).unwrap_or(1);
    let extent = 0.5 * SPACING * (side - 1) as f32;
    let chest = def.body_named("chest").expect("the mannequin has a chest");
    let member = |index: usize| {
        let (row, column) = (index / side, index % side);
        let jitter = random.in_cube() * (0.3 * SPACING);
        let spot = Vec3::new(column as f32, 0.0, row as f32) * SPACING;
        let place = spot - Vec3::new(extent - jitter.x, 0.0, extent - jitter.z);
        let heading = random.range(-0.4, 0.4);
        let stands = Transform::new(place, Rotation::from_axis_angle(Vec3::Y, heading));
        let way = Rotation::from_axis_angle(Vec3::Y, random.range(-0.8, 0.8)) * stands.rotation * Vec3::Z;
        let back_or_front = if random.unit() < 0.5 { -1.0 } else { 1.0 };
        let hit = way * (back_or_front * setup.number("impulse") * random.range(0.8, 1.2));
        let time = FIRST_HIT + BETWEEN_WAVES * (index % waves) as f32;
        let step = (time / world.def().dt()) as u64;
        let character = Character::new(def.clone(), stands, random.range(0.0, 1.0));
        Member { character, hit, hit_at: step, up_at: None, model: Vec::new() }
    };
    let members: Vec<Member> = (0..count).map(member).collect();
    let states = Vec::with_capacity(count);
    let mut throng =
        Throng { def, chest, members, states, spent: [0; 4], most_bodies: 0, work_in: 0.0, waves };
    throng.members.iter_mut().for_each(Member::show);
    Instance::new(world, throng)
}

/// A member of the crowd.
struct Member {
    character: Character,
    /// Impulse of its hit, N·s.
    hit: Vec3,
    /// Step after which the member is hit.
    hit_at: u64,
    /// Step after which the member was up again.
    up_at: Option<u64>,
    /// World from joint.
    model: Vec<Affine>,
}

impl Member {
    /// Updates the joints for pictures.
    fn show(&mut self) {
        let character = &self.character;
        local_to_model(
            &character.def().rig,
            character.pose(),
            &character.world_from_model(),
            &mut self.model,
        );
    }
}

struct Throng {
    def: Arc<CharacterDef>,
    chest: usize,
    members: Vec<Member>,
    /// States at the start of the step.
    states: Vec<State>,
    /// Number of steps that characters have spent in each of [`STATES`].
    spent: [u32; 4],
    most_bodies: u32,
    work_in: f32,
    waves: usize,
}

impl Throng {
    fn count(&self, state: State) -> u32 {
        self.members.iter().filter(|member| member.character.state() == state).count() as u32
    }

    fn figure<'a>(def: &'a CharacterDef, member: &'a Member) -> Figure<'a> {
        Figure { rig: &def.rig, world_from_joint: &member.model }
    }

    /// Members that were hit first.
    fn first_wave(&self) -> impl Iterator<Item = &Member> {
        self.members.iter().step_by(self.waves)
    }
}

impl Script for Throng {
    fn after_step(&mut self, world: &mut World) {
        self.after_step_in_parts(world, &mut |_| {});
    }

    fn after_step_in_parts(&mut self, world: &mut World, done: &mut dyn FnMut(Part)) {
        self.work_in += world.work().total();
        let now = world.step_count();
        self.states.clear();
        self.states.extend(self.members.iter().map(|member| member.character.state()));
        for (index, (state, name)) in STATES.into_iter().enumerate() {
            let mut count = 0;
            for (member, _) in self.members.iter_mut().zip(&self.states).filter(|(_, was)| **was == state) {
                member.character.update(world);
                if state == State::GettingUp && member.character.state() == State::Animated {
                    member.up_at = Some(now);
                }
                count += 1;
            }
            self.spent[index] += count;
            done(Part { name, count });
        }
        for member in self.members.iter_mut().filter(|member| member.hit_at == now) {
            member.character.hit(world, self.chest, member.hit);
        }
        self.members.iter_mut().for_each(Member::show);
        self.most_bodies = u32::max(self.most_bodies, world.body_ids().count() as u32);
        done(Part { name: "shown", count: self.members.len() as u32 });
    }

    fn save(&self, out: &mut Writer) {
        for member in &self.members {
            member.character.save(out);
            out.u64(member.up_at.unwrap_or(u64::MAX));
        }
        self.spent.iter().for_each(|&steps| out.u32(steps));
        out.u32(self.most_bodies);
        out.f32(self.work_in);
    }

    fn load(&mut self, bytes: &mut Reader<'_>) -> Result<(), ReadError> {
        for member in &mut self.members {
            member.character.load(bytes)?;
            member.up_at = Some(bytes.u64()?).filter(|&step| step != u64::MAX);
            member.show();
        }
        for steps in &mut self.spent {
            *steps = bytes.u32()?;
        }
        (self.most_bodies, self.work_in) = (bytes.u32()?, bytes.f32()?);
        Ok(())
    }

    fn work_in(&self, _: &World) -> f32 {
        self.work_in
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let dt = world.def().dt();
        let up = self.first_wave().filter(|member| member.up_at.is_some()).count();
        let took = |member: &Member| member.up_at.map(|up| (up - member.hit_at) as f32 * dt);
        let slowest = self.members.iter().filter_map(took).reduce(max);
        let down = self.first_wave().count() - up;
        let [animated, limp, preparing, getting_up] = STATES.map(|(state, _)| self.count(state));
        let [of_animated, of_limp, of_preparing, of_getting_up] = self.spent;
        vec![
            Metric::new("first_wave_down", down as u32, Expected::AtMost(0.0)),
            Metric::awaited("up_slowest_s", slowest, Expected::AtMost(UP_WITHIN)),
            Metric::new("animated", animated, Expected::Anything),
            Metric::new("limp", limp, Expected::AtMost(0.0)),
            Metric::new("preparing", preparing, Expected::AtMost(0.0)),
            Metric::new("getting_up", getting_up, Expected::AtMost(0.0)),
            Metric::new("steps_animated", of_animated, Expected::Anything),
            Metric::new("steps_limp", of_limp, Expected::Anything),
            Metric::new("steps_preparing", of_preparing, Expected::Anything),
            Metric::new("steps_getting_up", of_getting_up, Expected::Anything),
            Metric::new("bodies_most", self.most_bodies, Expected::Anything),
        ]
    }

    fn camera_hint(&self) -> CameraHint {
        CameraHint { direction: Vec3::new(0.6, 0.55, 1.0), bounds: None, trails: Trails::None }
    }

    fn figures(&self) -> Vec<Figure<'_>> {
        let figure = |member| Self::figure(&self.def, member);
        self.members.iter().map(figure).collect()
    }

    fn bodies_of_figures(&self) -> Vec<BodyId> {
        let ragdolls = self.members.iter().filter_map(|member| member.character.ragdoll());
        ragdolls.flat_map(|ragdoll| ragdoll.bodies.iter().copied()).collect()
    }
}
