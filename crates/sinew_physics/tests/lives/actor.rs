//! A world and names for its objects, so that several worlds can get the same calls.

use crate::code::{self, Code, rusty};
use crate::extension::Extension;
use crate::functions;
use crate::numbers::Numbers;
use core::fmt::Write;
use sinew_math::{Reader, Writer};
use sinew_physics::stage::NoProfiler;
use sinew_physics::*;
use std::collections::BTreeMap;

/// Objects of one kind that a life has created, each with its name. The name is a number that does not change when
/// earlier deeds are removed from the life.
pub type Names<T> = Vec<(u64, T)>;

/// Way to create a copy of a world that continues next to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Twin {
    /// A new world that loads a snapshot.
    Stranger,
    /// A clone.
    Clone,
}

pub struct Actor {
    pub world: World,
    pub floor: BodyId,
    pub bodies: Names<BodyId>,
    pub joints: Names<JointId>,
    pub groups: Names<GroupId>,
    pub fields: Names<FieldId>,
    pub movers: Names<MoverId>,
    pub forces: Names<ForceId>,
    pub objects: Names<ObjectId>,
    /// Recorded answers of the current deed.
    pub said: String,
    /// Number of calls by name of the method.
    pub calls: BTreeMap<&'static str, u64>,
    /// Lines of the equivalent program, if one is recorded.
    pub lines: Option<Vec<String>>,
    /// Twin that the current deed requests.
    pub wanted: Option<Twin>,
    pub threads: Option<Threads>,
    /// Objects that are kept next to the world, such as characters.
    pub more: Extension,
    /// Name of the current deed, and the number of objects it has named.
    deed: u64,
    named: u64,
}

/// Calls a method of the actor's world and records it.
macro_rules! call {
    ($actor:ident.$name:ident($($argument:expr),* $(,)?)) => {{
        if $actor.lines.is_some() {
            let arguments = [$($crate::code::argument(stringify!($argument), &$argument)),*];
            $actor.tell(stringify!($name), &arguments);
        }
        $actor.count(stringify!($name));
        $actor.world.$name($($argument),*)
    }};
}

/// Queries the actor's world and records the answer.
macro_rules! ask {
    ($actor:ident.$name:ident($($argument:expr),* $(,)?)) => {{
        let answer = call!($actor.$name($($argument),*));
        $crate::actor::say(&mut $actor.said, stringify!($name), &answer);
    }};
}

/// Queries the actor's world for a list and records its content.
macro_rules! ask_all {
    ($actor:ident.$name:ident($($argument:expr),* $(,)?)) => {{
        let answer: Vec<_> = call!($actor.$name($($argument),*)).collect();
        $crate::actor::say(&mut $actor.said, stringify!($name), &answer);
    }};
}

/// Returns the owner to which deeds assign bodies and joints.
pub fn owner() -> Owner {
    Owner { name: "cart".into(), calls: "`Cart::scrap`".into(), parts: vec!["wheel".into()] }
}

/// Rust code of [`owner`].
const OWNER: &str =
    "&Owner { name: \"cart\".into(), calls: \"`Cart::scrap`\".into(), parts: vec![\"wheel\".into()] }";

/// Records an answer, for the comparison with other worlds.
pub fn say(said: &mut String, name: &str, answer: &dyn core::fmt::Debug) {
    writeln!(said, "{name}: {answer:?}").expect("writing to a string cannot fail");
}

impl Actor {
    /// Records a call that assigns one object to [`owner`].
    pub fn note_owned(&mut self, name: &'static str, id: &dyn core::fmt::Debug) {
        if self.lines.is_some() {
            self.tell(
                name,
                &[OWNER.to_owned(), format!("&[{}]", code::argument("id", id)), "&[0]".to_owned()],
            );
        }
        self.count(name);
    }

    pub fn new(world: World, floor: BodyId, threads: Option<Threads>) -> Self {
        Self {
            world,
            floor,
            bodies: Vec::new(),
            joints: Vec::new(),
            groups: Vec::new(),
            fields: Vec::new(),
            movers: Vec::new(),
            forces: Vec::new(),
            objects: Vec::new(),
            said: String::new(),
            calls: BTreeMap::new(),
            lines: None,
            wanted: None,
            threads,
            more: Extension::new(),
            deed: 0,
            named: 0,
        }
    }

    /// Returns an actor with the same names and a copy of the world.
    pub fn twin(&self, kind: Twin) -> Self {
        let world = match kind {
            Twin::Clone => self.world.clone(),
            Twin::Stranger => stranger(&self.world),
        };
        Self {
            bodies: self.bodies.clone(),
            joints: self.joints.clone(),
            groups: self.groups.clone(),
            fields: self.fields.clone(),
            movers: self.movers.clone(),
            forces: self.forces.clone(),
            objects: self.objects.clone(),
            more: self.more.twin(kind),
            ..Self::new(world, self.floor, None)
        }
    }

    /// Starts a deed.
    pub fn begin(&mut self, deed: u64) {
        (self.deed, self.named) = (deed, 0);
        self.said.clear();
        self.wanted = None;
    }

    /// Returns a name for a new object.
    pub fn name(&mut self) -> u64 {
        self.named += 1;
        self.deed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(self.named)
    }

    pub fn count(&mut self, name: &'static str) {
        *self.calls.entry(name).or_insert(0) += 1;
    }

    /// Records a call as a line of the program.
    pub fn tell(&mut self, name: &str, arguments: &[String]) {
        self.line(format!("world.{name}({});", arguments.join(", ")));
    }

    pub fn line(&mut self, line: String) {
        if let Some(lines) = &mut self.lines {
            lines.push(line);
        }
    }

    /// Binds the result of the last line of the program to the name of an id.
    pub fn let_be(&mut self, id: &dyn core::fmt::Debug) {
        if let Some(last) = self.lines.as_mut().and_then(|lines| lines.last_mut()) {
            *last = format!("let {} = {last}", rusty(&format!("{id:?}")));
        }
    }

    pub fn add_body(&mut self, def: &BodyDef) -> BodyId {
        self.tell("add_body", &[format!("&{}", code::body_def(def))]);
        self.count("add_body");
        let id = self.world.add_body(def);
        self.let_be(&id);
        let name = self.name();
        self.bodies.push((name, id));
        id
    }

    pub fn add_joint(&mut self, def: &JointDef) -> JointId {
        self.tell("add_joint", &[format!("&{}", code::joint_def(def))]);
        self.count("add_joint");
        let id = self.world.add_joint(def);
        self.name_joint(id);
        id
    }

    /// Gives a new name to a joint that the last call created.
    pub fn name_joint(&mut self, id: JointId) {
        self.let_be(&id);
        let name = self.name();
        self.joints.push((name, id));
    }

    pub fn add_particles(&mut self, def: &particles::GroupDef) {
        let def = def.clone();
        let id = call!(self.add_particles(&def));
        self.let_be(&id);
        let name = self.name();
        self.groups.push((name, id));
    }

    pub fn add_field(&mut self, def: &FieldDef) {
        let def = def.clone();
        let id = call!(self.add_field(&def));
        self.let_be(&id);
        let name = self.name();
        self.fields.push((name, id));
    }

    pub fn add_mover(&mut self, def: &MoverDef) {
        let def = def.clone();
        let id = call!(self.add_mover(&def));
        self.let_be(&id);
        let name = self.name();
        self.movers.push((name, id));
    }

    pub fn add_force(&mut self, body: BodyId, def: &ForceDef) {
        let def = *def;
        let id = call!(self.add_force(body, &def));
        self.let_be(&id);
        let name = self.name();
        self.forces.push((name, id));
    }

    pub fn add_object(&mut self, tug: functions::Tug) {
        self.tell("add_object", &[format!("Box::new({})", tug.code())]);
        self.count("add_object");
        let id = self.world.add_object(Box::new(tug));
        self.let_be(&id);
        let name = self.name();
        self.objects.push((name, id));
    }

    /// Returns a body other than the floor that meets a condition, if there is one.
    pub fn body(&self, numbers: &mut Numbers, is: impl Fn(&World, BodyId) -> bool) -> Option<BodyId> {
        let there = |id: BodyId| self.world.contains(id) && is(&self.world, id);
        pick(&self.bodies, numbers.bits(), there)
    }

    pub fn any_body(&self, numbers: &mut Numbers) -> Option<BodyId> {
        self.body(numbers, |_, _| true)
    }

    pub fn dynamic(&self, numbers: &mut Numbers) -> Option<BodyId> {
        self.body(numbers, |world, id| world.kind(id) == BodyKind::Dynamic)
    }

    pub fn joint(&self, numbers: &mut Numbers) -> Option<JointId> {
        pick(&self.joints, numbers.bits(), |id| self.world.contains_joint(id))
    }

    pub fn group(&self, numbers: &mut Numbers) -> Option<GroupId> {
        let there: Vec<GroupId> = self.world.group_ids().collect();
        pick(&self.groups, numbers.bits(), |id| there.contains(&id))
    }

    pub fn field(&self, numbers: &mut Numbers) -> Option<FieldId> {
        pick(&self.fields, numbers.bits(), |id| self.world.contains_field(id))
    }

    pub fn mover(&self, numbers: &mut Numbers) -> Option<MoverId> {
        pick(&self.movers, numbers.bits(), |id| self.world.contains_mover(id))
    }

    pub fn object(&self, numbers: &mut Numbers) -> Option<ObjectId> {
        pick(&self.objects, numbers.bits(), |id| self.world.contains_object(id))
    }

    pub fn force(&self, numbers: &mut Numbers) -> Option<ForceId> {
        let there = |id: ForceId| {
            let body = id.body();
            self.world.contains(body) && self.world.forces_of(body).any(|other| other == id)
        };
        pick(&self.forces, numbers.bits(), there)
    }

    /// Returns one shape of a body, if the body has any.
    pub fn shape(&self, numbers: &mut Numbers, body: BodyId) -> Option<ShapeId> {
        let count = self.world.shape_ids(body).count();
        let number = numbers.index(count.max(1)) as u32;
        (count > 0).then_some(ShapeId { body, shape: number })
    }

    /// Returns a body that may be removed.
    pub fn removable(&self, numbers: &mut Numbers) -> Option<BodyId> {
        self.body(numbers, |world, id| !is_worn(world, id) && world.body_owner(id).is_none())
    }

    pub fn step(&mut self) {
        self.more.before_step(&mut self.world);
        self.line("world.step();".to_owned());
        match &self.threads {
            Some(threads) => {
                self.world.step_with(threads, &NoProfiler);
                self.count("step_with");
            }
            None if self.world.step_count().is_multiple_of(2) => {
                self.world.step_with(&Serial, &NoProfiler);
                self.count("step_with");
            }
            None => {
                self.world.step();
                self.count("step");
            }
        }
        self.more.after_step(&mut self.world);
    }
}

/// Returns whether a body cannot be removed because particles are attached to it or an object needs it.
pub fn is_worn(world: &World, id: BodyId) -> bool {
    let by_particles = world.group_ids().any(|group| {
        let group = world.particles(group);
        let held = |target| matches!(target, particles::AttachmentTarget::Body { body, .. } if body == id);
        group.attachments().iter().any(|attachment| held(attachment.target))
            || group.backstops().iter().any(|backstop| backstop.body == id)
    });
    by_particles || world.object_ids().any(|object| world.object::<functions::Tug>(object).body == id)
}

/// Returns a new world that loads the original's snapshot.
pub fn stranger(original: &World) -> World {
    let mut world = World::new(WorldDef::default());
    functions::register(&mut world);
    let (mut shapes, mut state) = (Writer::new(), Writer::new());
    original.save_shapes(&mut shapes);
    original.save(&mut state);
    world.load_shapes(&mut Reader::new(shapes.as_bytes())).expect("the saved shape library must load");
    world.load(&mut Reader::new(state.as_bytes())).expect("the snapshot must load");
    world
}

/// Makes a world load its own snapshot.
pub fn reload(world: &mut World) {
    let (mut shapes, mut state) = (Writer::new(), Writer::new());
    world.save_shapes(&mut shapes);
    world.save(&mut state);
    world.load_shapes(&mut Reader::new(shapes.as_bytes())).expect("the saved shape library must load");
    world.load(&mut Reader::new(state.as_bytes())).expect("the snapshot must load");
}

/// Returns the object whose name ranks highest for the key, among those that meet the condition. The rank of an object
/// does not depend on the others.
pub fn pick<T: Copy>(all: &[(u64, T)], key: u64, is: impl Fn(T) -> bool) -> Option<T> {
    let rank = |name: u64| {
        let mixed = (name ^ key).wrapping_mul(0xff51_afd7_ed55_8ccd);
        (mixed ^ mixed >> 33).wrapping_mul(0xc4ce_b9fe_1a85_ec53)
    };
    all.iter().filter(|&&(_, thing)| is(thing)).min_by_key(|&&(name, _)| rank(name)).map(|&(_, thing)| thing)
}
