//! A world with the objects that are stepped with it: characters, grab points, and the data that JavaScript reads after each
//! frame.

use crate::border::{Failure, Outcome};
use crate::events::Told;
use crate::view::View;
use sinew::anim::LocalTransform;
use sinew::math::{Reader, Transform, Vec3, Writer};
use sinew::physics::{BodyId, DebugDraw, DrawKind, GroupId, World};
use sinew::ragdoll::{Character, GrabPoint};
use std::time::Duration;

/// First bytes of a saved state; the last one is the version.
const MAGIC: &[u8; 8] = b"sinewwb\x01";
/// Count of numbers per body in the list of poses: position, rotation.
const BODY_NUMBERS: usize = 7;

/// World, and the objects stepped with it.
pub struct Inner {
    pub world: World,
    pub characters: Vec<Option<Member>>,
    pub grabs: Vec<Option<Gripped>>,
    pub groups: Vec<Drawn>,
    pub told: Vec<Told>,
    pub lines: Lines,
    tracked: Vec<Option<BodyId>>,
    poses: Vec<f32>,
    poses_view: View,
    /// Number of characters and grab points created so far.
    serial: u64,
    alpha: f32,
}

/// A character in the world.
pub struct Member {
    pub serial: u64,
    pub character: Character,
    /// Ten numbers for each joint (position, rotation, scale), then the columns of the matrix from the file to the world.
    pub pose: Vec<f32>,
    pub view: View,
    locals: Vec<LocalTransform>,
}

/// A grab point.
pub struct Gripped {
    pub serial: u64,
    pub point: GrabPoint,
}

/// Particles whose positions JavaScript reads.
pub struct Drawn {
    pub group: GroupId,
    pub positions: Vec<f32>,
    pub view: View,
}

/// Lines of a world for debug drawing, with their colours.
#[derive(Default)]
pub struct Lines {
    pub positions: Vec<f32>,
    pub colors: Vec<f32>,
    pub views: [View; 2],
}

/// Colour of a line, linear red, green and blue.
fn color(kind: DrawKind) -> [f32; 3] {
    match kind {
        DrawKind::Static => [0.25, 0.3, 0.25],
        DrawKind::Kinematic => [0.1, 0.4, 0.8],
        DrawKind::Awake => [0.9, 0.55, 0.1],
        DrawKind::Asleep => [0.35, 0.35, 0.4],
        DrawKind::Joint => [0.1, 0.7, 0.6],
        DrawKind::Spring => [0.6, 0.3, 0.8],
        DrawKind::Contact => [0.9, 0.1, 0.15],
        DrawKind::Object => [0.8, 0.8, 0.8],
    }
}

impl DebugDraw for Lines {
    fn line(&mut self, from: Vec3, to: Vec3, kind: DrawKind) {
        self.positions.extend(from.to_array());
        self.positions.extend(to.to_array());
        self.colors.extend([color(kind); 2].as_flattened());
    }
}

impl Member {
    fn write_pose(&mut self, alpha: f32) {
        let place = self.character.interpolated(alpha, &mut self.locals);
        let root = self.character.def().mapping().world_from_model(place);
        self.pose.clear();
        for LocalTransform { translation: t, rotation: q, scale: s } in &self.locals {
            self.pose.extend([t.x, t.y, t.z, q.x, q.y, q.z, q.w, s.x, s.y, s.z]);
        }
        for axis in [root.linear.x_axis, root.linear.y_axis, root.linear.z_axis] {
            self.pose.extend([axis.x, axis.y, axis.z, 0.0]);
        }
        let t = root.translation;
        self.pose.extend([t.x, t.y, t.z, 1.0]);
    }
}

/// Inserts `item` into a list with free slots, and returns its index.
fn settle<T>(list: &mut Vec<Option<T>>, item: T) -> usize {
    let free = list.iter().position(Option::is_none).unwrap_or(list.len());
    if free == list.len() {
        list.push(None);
    }
    list[free] = Some(item);
    free
}

fn step(
    world: &mut World,
    characters: &mut [Option<Member>],
    grabs: &mut [Option<Gripped>],
    told: &mut Vec<Told>,
) {
    for grab in grabs {
        if grab.as_mut().is_some_and(|grab| !grab.point.update(world)) {
            *grab = None;
        }
    }
    world.step();
    crate::events::of_world(world, told);
    for (index, member) in characters.iter_mut().enumerate() {
        if let Some(member) = member {
            member.character.update(world);
            crate::events::of_character(index, &member.character, told);
        }
    }
}

impl Inner {
    pub fn new(world: World) -> Self {
        Self {
            world,
            characters: Vec::new(),
            grabs: Vec::new(),
            groups: Vec::new(),
            told: Vec::new(),
            lines: Lines::default(),
            tracked: Vec::new(),
            poses: Vec::new(),
            poses_view: View::default(),
            serial: 0,
            alpha: 1.0,
        }
    }

    /// Takes steps and exports the last state.
    pub fn step(&mut self, count: u32) {
        self.told.clear();
        let Self { world, characters, grabs, told, .. } = self;
        (0..count).for_each(|_| step(world, characters, grabs, told));
        self.show(1.0);
    }

    /// Takes the steps of a frame and exports the interpolated state; returns the number of steps.
    pub fn update(&mut self, time: Duration) -> u32 {
        self.told.clear();
        let Self { world, characters, grabs, told, .. } = self;
        let update = world.update_with(time, |world| step(world, characters, grabs, told));
        self.show(update.alpha);
        update.steps
    }

    /// Exports all data for JavaScript, interpolated by `alpha` between the last two steps.
    pub fn show(&mut self, alpha: f32) {
        self.alpha = alpha;
        self.characters.iter_mut().flatten().for_each(|member| member.write_pose(alpha));
        let Self { world, tracked, poses, groups, .. } = self;
        for (place, body) in poses.chunks_exact_mut(BODY_NUMBERS).zip(tracked) {
            let Some(body) = body.filter(|&body| world.contains(body)) else { continue };
            let Transform { translation: t, rotation: q } = world.interpolated(body, alpha);
            place.copy_from_slice(&[t.x, t.y, t.z, q.x, q.y, q.z, q.w]);
        }
        for drawn in groups {
            drawn.positions.clear();
            let places = world.particles(drawn.group).interpolated(alpha);
            places.for_each(|place| drawn.positions.extend(place.to_array()));
        }
    }

    /// Remaining time as a share of a step, 0 to 1.
    pub fn alpha(&self) -> f32 {
        self.alpha
    }

    /// Exports the pose of a body from now on; returns its index in the list of poses.
    pub fn track(&mut self, body: BodyId) -> usize {
        let place = settle(&mut self.tracked, body);
        self.poses.resize(BODY_NUMBERS * self.tracked.len(), 0.0);
        let Transform { translation: t, rotation: q } = self.world.transform(body);
        let numbers = [t.x, t.y, t.z, q.x, q.y, q.z, q.w];
        self.poses[BODY_NUMBERS * place..][..BODY_NUMBERS].copy_from_slice(&numbers);
        place
    }

    /// Stops exporting the pose at index `place`.
    pub fn untrack(&mut self, place: usize) {
        if let Some(tracked) = self.tracked.get_mut(place) {
            *tracked = None;
        }
    }

    /// Poses of the exported bodies.
    pub fn poses(&self) -> js_sys::Float32Array {
        self.poses_view.of(&self.poses)
    }

    /// Adds a character; returns its index and its serial number.
    pub fn settle_character(&mut self, character: Character) -> (usize, u64) {
        self.serial += 1;
        let mut member = Member {
            serial: self.serial,
            character,
            pose: Vec::new(),
            view: View::default(),
            locals: Vec::new(),
        };
        member.write_pose(1.0);
        (settle(&mut self.characters, member), self.serial)
    }

    /// Adds a grab point; returns its serial number.
    pub fn settle_grab(&mut self, point: GrabPoint) -> u64 {
        self.serial += 1;
        settle(&mut self.grabs, Gripped { serial: self.serial, point });
        self.serial
    }

    /// Returns the index of a grab point while it exists.
    pub fn grab_place(&self, serial: u64) -> Option<usize> {
        self.grabs.iter().position(|grab| grab.as_ref().is_some_and(|grab| grab.serial == serial))
    }

    /// Saves the state of world, characters and grab points.
    pub fn save(&self) -> Vec<u8> {
        let mut w = Writer::new();
        w.raw(MAGIC);
        w.block(|w| self.world.save(w));
        w.count(self.characters.iter().flatten().count());
        for member in self.characters.iter().flatten() {
            w.u64(member.serial);
            w.block(|w| member.character.save(w));
        }
        w.count(self.grabs.iter().flatten().count());
        for grab in self.grabs.iter().flatten() {
            w.u64(grab.serial);
            grab.point.save(&mut w);
        }
        w.into_bytes()
    }

    /// Restores a saved state; if the bytes are invalid, the world is unchanged.
    pub fn load(&mut self, bytes: &[u8]) -> Outcome {
        let failed = |what: &dyn core::fmt::Display| Failure(format!("not a state of this world: {what}"));
        let mut r = Reader::new(bytes);
        if r.raw(MAGIC.len()).ok() != Some(MAGIC) {
            return Err(failed(&"it does not have the first bytes of this version"));
        }
        let mut world = r.block().map_err(|what| failed(&what))?;
        let characters = self.load_characters(&mut r)?;
        let grabs = self.load_grabs(&mut r)?;
        self.world.load(&mut world).map_err(|what| failed(&what))?;
        for (place, character) in characters {
            if let Some(member) = &mut self.characters[place] {
                member.character = character;
            }
        }
        self.grabs = grabs;
        self.told.clear();
        self.show(1.0);
        Ok(())
    }

    fn load_characters(&self, r: &mut Reader<'_>) -> Outcome<Vec<(usize, Character)>> {
        let failed = |what: sinew::math::ReadError| Failure(format!("not a state of this world: {what}"));
        let count = r.count(8).map_err(failed)?;
        if count != self.characters.iter().flatten().count() {
            return Err(Failure::new("the state is of a world with other characters"));
        }
        let mut loaded = Vec::new();
        for _ in 0..count {
            let serial = r.u64().map_err(failed)?;
            let is_it =
                |member: &Option<Member>| member.as_ref().is_some_and(|member| member.serial == serial);
            let place = self.characters.iter().position(is_it);
            let place = place.ok_or_else(|| Failure::new("the state is of a world with other characters"))?;
            let Some(member) = &self.characters[place] else { continue };
            let mut character = member.character.clone();
            character.load(&mut r.block().map_err(failed)?).map_err(failed)?;
            loaded.push((place, character));
        }
        Ok(loaded)
    }

    fn load_grabs(&self, r: &mut Reader<'_>) -> Outcome<Vec<Option<Gripped>>> {
        let failed = |what: sinew::math::ReadError| Failure(format!("not a state of this world: {what}"));
        let mut grabs: Vec<Option<Gripped>> = self.grabs.iter().map(|_| None).collect();
        for _ in 0..r.count(8).map_err(failed)? {
            let (serial, point) = (r.u64().map_err(failed)?, GrabPoint::load(r).map_err(failed)?);
            match self.grab_place(serial) {
                Some(place) => grabs[place] = Some(Gripped { serial, point }),
                None => grabs.push(Some(Gripped { serial, point })),
            }
        }
        Ok(grabs)
    }
}
