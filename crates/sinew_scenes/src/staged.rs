//! A character on the stage of the demo: it walks out of the cabin, is pushed down the stairs, gets up, walks on, and
//! begins again.
//!
//! Unlike the film of [`demo`](crate::demo) it is simulated, so that users can push and pull the character at any time.

use crate::cabin::Site;
use crate::dressed::{CAPE, dressed};
use crate::fallen::{ROOM, middle};
use crate::framework::actors::Figure;
use crate::framework::acts::{Act, Directed};
use crate::framework::camera_hint::{CameraHint, Trails};
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::Metric;
use crate::maned::{HAIR, maned};
use sinew::anim::local_to_model;
use sinew::math::{Affine, ReadError, Reader, Transform, Vec3, Writer};
use sinew::physics::boxes::Aabb;
use sinew::physics::{BodyId, BodyKind, GroupId, World, WorldDef};
use sinew::ragdoll::{Character, CharacterDef, State};
use std::sync::Arc;

/// Height for which the cabin is built, and range of heights of characters that fit its door and stairs, metres.
const MANNEQUIN: f32 = 1.8;
const FITTING: core::ops::RangeInclusive<f32> = 1.3..=2.3;
/// Distance from the position behind the door to the start, metres: the wall hides a character at the start.
const START_DISTANCE: f32 = 0.45;
/// Speed of the walk of a character of the mannequin's height, m/s.
const WALK: f32 = 1.3;
/// Distance before the edge of the porch at which the character is pushed, metres, and time until the push on flat
/// ground, seconds.
const PUSH_BEFORE_EDGE: f32 = 0.45;
const PUSH_AFTER: f32 = 2.5;
/// Speed that the push gives to the mass of the whole character, m/s: a shove with both hands.
const SHOVE: f32 = 1.45;
/// Times after which the run begins again, seconds: with the character on its feet, and down without getting up.
const WALKS_ON: f32 = 4.0;
const STAYS_DOWN: f32 = 12.0;

/// Built-in characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sample {
    /// The mannequin.
    Mannequin,
    /// The mannequin with a ponytail and braids, which swing by springs.
    Braids,
    /// The mannequin with a cape of cloth.
    Cape,
}

impl Sample {
    /// All samples.
    pub const ALL: [Self; 3] = [Self::Mannequin, Self::Braids, Self::Cape];

    /// Name of the sample.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mannequin => "mannequin",
            Self::Braids => "braids",
            Self::Cape => "cape",
        }
    }

    /// The character.
    pub fn character(self) -> CharacterDef {
        match self {
            Self::Mannequin => sinew::mannequin::character(),
            Self::Braids => maned(&HAIR),
            Self::Cape => dressed(&[&CAPE], |_| {}),
        }
    }
}

/// The character on the stage.
pub fn staged(def: CharacterDef) -> Instance {
    let def = Arc::new(def);
    let height = def.ragdoll.height;
    let site = if FITTING.contains(&height) { Site::CabinWithStairs } else { Site::Flat };
    let mut world = World::new(WorldDef::default());
    let colors = site.props().iter().map(|prop| (world.add_body(&prop.body), prop.color)).collect();
    let start = site.spawn().world_from_character * Transform::from_translation(Vec3::Z * START_DISTANCE);
    let character = Character::spawn(&mut world, &def, start);
    let directed = Directed::default();
    let mut stage =
        Staged { def, site, start, colors, character, since: 0, was: None, directed, model: Vec::new() };
    stage.walk();
    stage.show();
    Instance::new(world, stage)
}

struct Staged {
    def: Arc<CharacterDef>,
    site: Site,
    /// World from character.
    start: Transform,
    colors: Vec<(BodyId, [f32; 3])>,
    character: Character,
    /// Number of steps since the character last got up or fell.
    since: u32,
    /// Part of the run; `None` until the push.
    was: Option<Part>,
    /// Instructions of a user, with which the demo ends.
    directed: Directed,
    /// World from joint.
    model: Vec<Affine>,
}

/// Part of a run after the push.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Down,
    Up,
}

impl Staged {
    fn walk(&mut self) {
        if self.directed.is_directed {
            return self.directed.go_on(&mut self.character);
        }
        let speed = WALK * (self.def.ragdoll.height / MANNEQUIN).sqrt();
        let ahead = self.character.world_from_character().rotation * Vec3::Z;
        self.character.set_move(ahead * speed);
    }

    fn show(&mut self) {
        let root = self.character.world_from_model();
        local_to_model(&self.def.rig, self.character.pose(), &root, &mut self.model);
    }

    fn is_at_the_push(&self, dt: f32) -> bool {
        let place = self.character.world_from_character().translation;
        match self.site {
            Site::CabinWithStairs => place.z > -PUSH_BEFORE_EDGE,
            Site::Flat => self.since as f32 * dt > PUSH_AFTER,
        }
    }

    /// Pushes the character from behind.
    fn shove(&mut self, world: &mut World) {
        let chest = self.def.body_named("chest").unwrap_or(0);
        let ahead = self.character.world_from_character().rotation * Vec3::Z;
        self.character.hit(world, chest, ahead * (SHOVE * self.def.ragdoll.total_mass));
    }

    /// Puts a new character at the start, and removes objects thrown by users.
    fn begin_again(&mut self, world: &mut World) {
        let next = Character::new(self.def.clone(), self.start, 0.0);
        core::mem::replace(&mut self.character, next).despawn(world);
        let thrown: Vec<BodyId> =
            world.body_ids().filter(|&id| world.kind(id) == BodyKind::Dynamic).collect();
        for body in thrown {
            world.remove_body(body);
        }
        self.character.enter(world);
        (self.since, self.was) = (0, None);
    }
}

impl Script for Staged {
    fn after_step(&mut self, world: &mut World) {
        self.directed.work += world.work().total();
        self.character.update(world);
        let is_up = self.character.state() == State::Animated;
        let part = match (self.was, is_up) {
            (None, true) => None,
            (_, false) => Some(Part::Down),
            (Some(_), true) => Some(Part::Up),
        };
        self.since = if part == self.was { self.since + 1 } else { 0 };
        self.was = part;
        let dt = world.def().dt();
        let passed = self.since as f32 * dt;
        let is_demo = !self.directed.is_directed;
        match part {
            None if is_demo && self.is_at_the_push(dt) => self.shove(world),
            Some(Part::Up) if is_demo && passed > WALKS_ON => self.begin_again(world),
            Some(Part::Down) if is_demo && passed > STAYS_DOWN => self.begin_again(world),
            _ => {}
        }
        self.walk();
        self.show();
    }

    fn save(&self, out: &mut Writer) {
        self.character.save(out);
        out.u32(self.since);
        out.u8(self.was.map_or(0, |part| 1 + part as u8));
        self.directed.save(out);
    }

    fn load(&mut self, bytes: &mut Reader<'_>) -> Result<(), ReadError> {
        self.character.load(bytes)?;
        self.since = bytes.u32()?;
        self.was = [None, Some(Part::Down), Some(Part::Up)].get(usize::from(bytes.u8()?)).copied().flatten();
        self.directed = Directed::load(bytes)?;
        self.show();
        Ok(())
    }

    fn work_in(&self, _: &World) -> f32 {
        self.directed.work
    }

    fn metrics(&self, _: &World) -> Vec<Metric> {
        Vec::new()
    }

    /// View from the right of the stairs, a little from the front; the box moves along with the character.
    fn camera_hint(&self) -> CameraHint {
        let half = ROOM * self.def.ragdoll.height;
        let bounds = Aabb::around(middle(&self.model), half);
        CameraHint { direction: Vec3::new(0.9, 0.28, 0.42), bounds: Some(bounds), trails: Trails::None }
    }

    fn figures(&self) -> Vec<Figure<'_>> {
        vec![Figure { rig: &self.def.rig, world_from_joint: &self.model }]
    }

    fn bodies_of_figures(&self) -> Vec<BodyId> {
        self.character.bodies().to_vec()
    }

    fn garments_of_figures(&self) -> &[GroupId] {
        self.character.garments()
    }

    fn colors(&self) -> &[(BodyId, [f32; 3])] {
        &self.colors
    }

    fn strike(&mut self, world: &mut World, body: BodyId, impulse: Vec3, _: Vec3) {
        if let Some(body) = self.character.body_index(body) {
            self.character.hit(world, body, impulse);
        }
    }

    fn steer(&mut self, way: Vec3) {
        self.directed.steer(way, &mut self.character);
    }

    fn steered(&self) -> Option<Vec3> {
        Some(self.character.world_from_character().translation)
    }

    fn act(&mut self, world: &mut World, act: Act) {
        self.directed.act(act, &mut self.character, world);
    }

    fn directed(&self) -> Option<&Character> {
        Some(&self.character)
    }
}
