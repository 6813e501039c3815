//! Runs a life in several worlds, which must stay equal.

use crate::actor::{Actor, Twin, is_worn};
use crate::life::{Ground, Life};
use crate::planted::{LAST, Plant};
use crate::watch::{Fault, Watch};
use core::cell::RefCell;
use sinew_physics::{BodyId, Events, Threads};
use std::collections::BTreeMap;
use std::panic::AssertUnwindSafe;
use std::sync::Once;

#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    pub step: u32,
    pub fault: Fault,
}

/// Result of a life, the number of its calls of each method, and its metrics.
pub struct Outcome {
    pub result: Result<(), Failure>,
    pub calls: BTreeMap<&'static str, u64>,
    /// Number of deeds that had an object to act on.
    pub deeds: u64,
    /// Largest rise of energy, as a share of the allowed rise.
    pub rise: f32,
    /// Hash of the last state of the first world.
    pub hash: u64,
    /// Lines of the equivalent program, if they were requested.
    pub program: Option<Vec<String>>,
}

/// Largest number of worlds in addition to the first two.
const MOST_TWINS: usize = 2;

thread_local! {
    static CAUGHT: RefCell<Option<String>> = const { RefCell::new(None) };
    static CATCHES: RefCell<bool> = const { RefCell::new(false) };
}

/// Installs a panic hook that stores the messages of panics in lives instead of printing them.
fn catch_panics() {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if CATCHES.with(|catches| *catches.borrow()) {
                CAUGHT.with(|caught| *caught.borrow_mut() = Some(info.to_string()));
            } else {
                before(info);
            }
        }));
    });
}

/// Returns the result of a function, or the message of its panic.
pub fn caught<T>(run: impl FnOnce() -> T) -> Result<T, String> {
    catch_panics();
    CATCHES.with(|catches| *catches.borrow_mut() = true);
    let result = std::panic::catch_unwind(AssertUnwindSafe(run));
    CATCHES.with(|catches| *catches.borrow_mut() = false);
    result.map_err(|_| {
        let text = CAUGHT.with(|caught| caught.borrow_mut().take());
        text.unwrap_or_else(|| "panic on another thread".to_owned())
    })
}

struct Run<'a> {
    life: &'a Life,
    actors: Vec<Actor>,
    /// Descriptions of the actors, for messages.
    names: Vec<String>,
    watch: Watch,
    plant: Option<Plant>,
    step: u32,
    deeds: u64,
}

/// Runs a life, with an injected fault if `plant` has one. If `told`, also records the life as a program.
pub fn run(life: &Life, plant: Option<Plant>, told: bool) -> Outcome {
    let (world, floor) = life.world();
    let mut first = Actor::new(world, floor, None);
    first.lines = told.then(Vec::new);
    let (world, floor) = life.world();
    let second = Actor::new(world, floor, Some(Threads::new(2)));
    let names = vec!["the first world".to_owned(), "the same calls on two threads".to_owned()];
    let watch = Watch::default();
    let mut run = Run { life, actors: vec![first, second], names, watch, plant, step: 0, deeds: 0 };
    let result = caught(|| run.all()).unwrap_or_else(|text| Err(Fault::Panic(text)));
    let step = run.step;
    let first = run.actors.swap_remove(0);
    Outcome {
        result: result.map_err(|fault| Failure { step, fault }),
        calls: first.calls,
        deeds: run.deeds,
        rise: run.watch.rise,
        hash: first.world.hash(),
        program: first.lines,
    }
}

impl Run<'_> {
    fn all(&mut self) -> Result<(), Fault> {
        let mut acts = self.life.acts.iter().peekable();
        for step in 0..self.life.steps {
            self.step = step;
            while let Some(act) = acts.next_if(|act| act.step == step) {
                self.act(act)?;
            }
            self.advance()?;
        }
        self.empty()
    }

    /// Does a deed in all worlds, and compares the answers.
    fn act(&mut self, act: &crate::life::Act) -> Result<(), Fault> {
        let steps = self.actors[0].world.step_count();
        let mut done = false;
        for i in 0..self.actors.len() {
            let actor = &mut self.actors[i];
            actor.begin(act.number);
            let mut numbers = self.life.numbers(act);
            let did = (act.deed.run)(actor, &mut numbers).is_some();
            if i == 0 {
                done = did;
                continue;
            }
            let same = did == done && self.actors[i].said == self.actors[0].said;
            if !same {
                let (p, q) = differing(&self.actors[0].said, &self.actors[i].said);
                let text =
                    format!("{}: `{}` returns {q}, in the first world {p}", self.names[i], act.deed.name);
                return Err(Fault::Differs(text));
            }
        }
        self.deeds += u64::from(done);
        let asks = act.deed.name.starts_with("ask") || act.deed.name == "query" || act.deed.name == "draw";
        if done && !asks {
            self.watch.disturb();
        }
        if self.actors[0].world.step_count() != steps {
            self.actors.iter_mut().for_each(|actor| actor.more.after_step(&mut actor.world));
            self.compare()?;
        }
        match self.actors[0].wanted.take() {
            Some(kind) => self.join(kind),
            None => Ok(()),
        }
    }

    /// Adds a world that continues from the state of the first one, unless there are enough.
    fn join(&mut self, kind: Twin) -> Result<(), Fault> {
        if self.actors.len() >= 2 + MOST_TWINS {
            return Ok(());
        }
        let mut twin = self.actors[0].twin(kind);
        if let Some(plant) = self.plant {
            plant.in_twin(&mut twin.world);
        }
        for name in ["new", "save", "load", "hash", "save_shapes", "load_shapes", "clone"] {
            self.actors[0].count(name);
        }
        let number = self.actors.len();
        let line = match kind {
            Twin::Stranger => format!(
                "let mut twin_{number} = stranger(&world); // from here on, all calls are made on it too"
            ),
            Twin::Clone => {
                format!(
                    "let mut twin_{number} = world.clone(); // from here on, all calls are made on it too"
                )
            }
        };
        self.actors[0].line(line);
        self.names.push(format!("{kind:?} of step {}", self.step));
        self.actors.push(twin);
        self.same_state()
    }

    fn advance(&mut self) -> Result<(), Fault> {
        for actor in &mut self.actors {
            actor.begin(0);
            actor.step();
        }
        self.compare()
    }

    /// Checks all worlds after a step, and that they are equal.
    fn compare(&mut self) -> Result<(), Fault> {
        let is_due = self.step + LAST >= self.life.steps;
        if let Some(plant) = self.plant {
            self.actors.iter_mut().for_each(|actor| plant.in_all(is_due, &mut actor.world));
            plant.in_threads(is_due, &mut self.actors[1].world);
        }
        let plant = self.plant;
        let seen = |velocity| plant.map_or(velocity, |plant| plant.seen(is_due, velocity));
        self.watch.look(self.life, &mut self.actors[0], seen)?;
        // The checks need both methods.
        ["events", "work"].into_iter().for_each(|name| self.actors[0].count(name));
        let events = self.actors[0].world.events().clone();
        if let Some(plant) = self.plant {
            self.watch.events(&plant.events(is_due, &events))?;
        }
        for (actor, name) in self.actors.iter().zip(&self.names).skip(1) {
            if *actor.world.events() != events {
                return Err(Fault::Differs(format!(
                    "{name}: the events differ: {}",
                    unlike(actor.world.events(), &events)
                )));
            }
            let (first, other) = (self.actors[0].more.events(), actor.more.events());
            if other != first {
                return Err(Fault::Differs(format!(
                    "{name}: events beside the world {other}, for the first world {first}"
                )));
            }
        }
        self.same_state()
    }

    fn same_state(&mut self) -> Result<(), Fault> {
        let hash = self.actors[0].world.hash();
        for (actor, name) in self.actors.iter().zip(&self.names).skip(1) {
            if actor.world.hash() != hash {
                let (first, other) = (&self.actors[0].world, &actor.world);
                let body = first.body_ids().find(|&id| {
                    !other.contains(id)
                        || first.transform(id) != other.transform(id)
                        || first.velocity(id) != other.velocity(id)
                        || first.is_awake(id) != other.is_awake(id)
                });
                return Err(Fault::Differs(format!(
                    "{name}: the state of the world differs, first at {body:?}"
                )));
            }
            if actor.more.state() != self.actors[0].more.state() {
                return Err(Fault::Differs(format!("{name}: the state beside the world differs")));
            }
        }
        Ok(())
    }

    /// Removes all objects and checks that every contact and sensor overlap that began has ended.
    fn empty(&mut self) -> Result<(), Fault> {
        for actor in &mut self.actors {
            actor.begin(1);
            actor.more.empty(&mut actor.world);
            for id in actor.world.group_ids().collect::<Vec<_>>() {
                call!(actor.remove_particles(id));
            }
            for id in actor.world.object_ids().collect::<Vec<_>>() {
                _ = call!(actor.remove_object(id));
            }
            for id in actor.world.body_ids().collect::<Vec<BodyId>>() {
                assert!(!is_worn(&actor.world, id), "no particles or objects may need the body");
                call!(actor.disown_body(id));
                call!(actor.remove_body(id));
            }
        }
        self.watch.disturb();
        self.advance()?;
        self.watch.end()
    }
}

/// Returns the first pair of lines that differ.
fn differing(p: &str, q: &str) -> (String, String) {
    let lines = p.lines().zip(q.lines()).find(|(p, q)| p != q);
    let (p, q) = lines.unwrap_or((p, q));
    let short = |text: &str| text.chars().take(300).collect();
    (short(p), short(q))
}

fn unlike(p: &Events, q: &Events) -> String {
    let (p, q) = (format!("{p:#?}"), format!("{q:#?}"));
    let (p, q) = differing(&p, &q);
    format!("{p}, in the first world {q}")
}

/// Returns the program that repeats a life until its failure.
pub fn program(life: &Life, lines: &[String]) -> String {
    let mut out =
        String::from("use crate::actor::{reload, stranger};\nuse crate::functions::{Tug, register};\n");
    out += "use sinew_math::*;\nuse sinew_physics::particles::*;\nuse sinew_physics::*;\n\npub fn program() -> World {\n";
    let def = crate::code::world_def(&life.def);
    out += &format!("    let mut world = World::new({def});\n    register(&mut world);\n");
    out += match life.ground {
        Ground::HalfSpace => "    let body_0v0 = world.add_body(&BodyDef::fixed(Shape::HalfSpace));\n",
        Ground::Box => {
            "    let body_0v0 = world.add_body(&BodyDef::fixed(Shape::cuboid(Vec3::new(50.0, 10.0, 50.0))).at(Vec3::NEG_Y * 10.0));\n"
        }
        Ground::Boxes => {
            "    for (x, z) in (-3..=3).flat_map(|x| (-3..=3).map(move |z| (2.0 * x as f32, 2.0 * z as f32))) {\n        world.add_body(&BodyDef::fixed(Shape::cuboid(Vec3::splat(1.0))).at(Vec3::new(x, -1.0, z)));\n    }\n"
        }
        Ground::Mesh => {
            "    let points = [(-50.0, -50.0), (50.0, -50.0), (50.0, 50.0), (-50.0, 50.0)].map(|(x, z)| Vec3::new(x, 0.0, z));\n    let body_0v0 = world.add_body(&BodyDef::fixed(Shape::mesh(&points, &[[0, 2, 1], [0, 3, 2]]).expect(\"a mesh\")));\n"
        }
    };
    for same in lines.chunk_by(|p, q| p == q && p == "world.step();") {
        match same {
            [line] => out += &format!("    {line}\n"),
            steps => out += &format!("    (0..{}).for_each(|_| world.step());\n", steps.len()),
        }
    }
    out + "    world\n}\n"
}
