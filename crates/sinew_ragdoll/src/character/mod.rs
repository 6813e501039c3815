//! A character: animated until something knocks it over, limp until it lies still, brought to where a get-up clip begins
//! if it lies otherwise, getting up, animated again. Each change is a [`CharacterEvent`].
//!
#![doc = include_str!("states.svg")]
//!
//! The host steps the world, then calls [`Character::update`]; poses and bodies are those of the same moment.
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
//! hero.hit(&mut world, def.body_named("chest").expect("it has one"), Vec3::Z * -150.0);
//! assert_eq!(hero.state(), State::Limp);
//! for _ in 0..60 {
//!     world.step();
//!     hero.update(&mut world);
//! }
//! let chest = hero.bodies()[def.body_named("chest").expect("it has one")];
//! assert!(world.center_of_mass(chest).y < 1.0, "it falls");
//! ```

mod animate;
mod blows;
mod clear;
mod clearance;
mod def;
mod detach;
mod detail;
mod distances;
mod event;
mod feet;
mod floor;
mod get_up;
mod grab;
mod grab_point;
mod grasp;
mod ground;
mod hit_bodies;
mod hold;
mod in_world;
mod limb;
mod limp;
mod memory;
mod mirror;
mod moves;
mod pose_similarity;
mod powered;
mod prepare;
mod recognise;
mod save;
mod show;
mod size;
mod stumble;
mod travel;
mod tuning;
mod walk;
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
pub use in_world::{Blow, HitBodies, InWorld, Toughness};
pub use limb::Limb;
pub use moves::MotionError;
pub use powered::{Part, Preset};

use crate::drive::Drives;
use crate::garments::Worn;
use crate::mapping::Physical;
use crate::ragdoll::Ragdoll;
use crate::springs::SpringSwing;
use clearance::Passage;
use in_world::Presence;
use memory::{Clearing, Planting, Preparation, Rising, Shown, Stillness};
use sinew_anim::{Animator, Inertia, LocalTransform, Pose};
use sinew_math::{Affine, Transform, Vec3};
use sinew_physics::{BodyId, Velocity, World};
use std::sync::Arc;

/// A character in a world.
#[derive(Clone, Debug)]
pub struct Character {
    def: Arc<CharacterDef>,
    state: State,
    animator: Animator,
    rising: Rising,
    /// Slope of the ground on which it gets up, as a turn from the vertical: scaled axis, world axes.
    lean: Vec3,
    /// Ground under its feet where it is not the floor of its clips.
    planting: Planting,
    /// Way from one pose to another on which it is kept out of the floor.
    passage: Passage,
    /// The pose with the feet planted and out of the floor, while that is another.
    planted: Vec<LocalTransform>,
    /// Springs and garments that it wears, and the pose with them; empty of a character that wears none.
    swing: SpringSwing,
    worn: Worn,
    swung: Vec<LocalTransform>,
    /// Speed over the ground in the last step, m/s.
    speed: f32,
    world_from_character: Transform,
    /// Speed at which the ground took the character's origin up in the last step, m/s.
    climbing: f32,
    /// As bodies or clips have it.
    pose: Vec<LocalTransform>,
    earlier: Earlier,
    shown: Shown,
    presence: Option<Presence>,
    /// Seconds until a limb that was struck has come back.
    flinching: f32,
    ragdoll: Option<Ragdoll>,
    drives: Drives,
    /// Bodies that were cut off, by index, with their ids.
    lost: Vec<(usize, BodyId)>,
    /// Bodies that are its own, where some were cut off.
    kept: Vec<BodyId>,
    /// Bodies of its own and others that were cut off, which overlap and pass through each other until they do not.
    parting: Vec<(BodyId, BodyId)>,
    /// Limbs that it has let go of, through whose bodies its own pass until they are apart.
    freed: Vec<BodyId>,
    stillness: Stillness,
    /// Way out of what it was deep in when it went limp.
    clearing: Clearing,
    preparation: Preparation,
    events: Vec<CharacterEvent>,
    /// Number of events that were there at the end of the last update.
    told: usize,
    physical: Physical,
    /// Motion of what neither bodies nor clips move, as it dies away after the bodies took over.
    lingering: Inertia,
    scratch: Scratch,
}

/// The pose a step ago, and where it was.
#[derive(Clone, Debug)]
struct Earlier {
    pose: Vec<LocalTransform>,
    world_from_character: Transform,
}

/// Buffers that are kept to be used again; but for `posed` they hold nothing from one call to the next.
#[derive(Clone, Debug, Default)]
struct Scratch {
    /// Bodies that the present pose was made of, where it will be the same as long as they stay; else nothing. Work that is
    /// saved, not state: the pose is the same without it.
    posed: Vec<Transform>,
    ahead: Option<Animator>,
    pose: Vec<LocalTransform>,
    resting: Pose,
    wanted: Vec<LocalTransform>,
    model: Vec<Affine>,
    frames: Vec<(Transform, f32)>,
    points: Vec<Vec3>,
    before: Vec<Transform>,
    after: Vec<Transform>,
    velocities: Vec<Velocity>,
}

impl Character {
    /// An animated character that stands at `world_from_character` (metres, its +Y up, +Z the way it faces), `phase`
    /// seconds into its looped clip.
    ///
    /// # Panics
    /// If `phase` is not finite.
    pub fn new(def: Arc<CharacterDef>, world_from_character: Transform, phase: f32) -> Self {
        let animator = def.opening(phase);
        let pose: Vec<LocalTransform> = animator.pose().iter().collect();
        Self {
            state: State::Animated,
            animator,
            rising: Rising::Without(0.0),
            lean: Vec3::ZERO,
            planting: Planting::default(),
            passage: Passage::default(),
            planted: Vec::new(),
            swing: SpringSwing::new(),
            worn: Worn::default(),
            swung: Vec::new(),
            speed: 0.0,
            climbing: 0.0,
            earlier: Earlier { pose: pose.clone(), world_from_character },
            shown: Shown { pose: pose.clone(), world_from_character },
            world_from_character,
            pose,
            presence: None,
            flinching: 0.0,
            ragdoll: None,
            drives: Drives::new(&def.ragdoll),
            lost: Vec::new(),
            kept: Vec::new(),
            parting: Vec::new(),
            freed: Vec::new(),
            stillness: Stillness::default(),
            clearing: Clearing::default(),
            preparation: Preparation::default(),
            events: Vec::new(),
            told: 0,
            physical: Physical::default(),
            lingering: Inertia::default(),
            scratch: Scratch::default(),
            def,
        }
    }

    /// Definition that it shares with its kind.
    pub fn def(&self) -> &Arc<CharacterDef> {
        &self.def
    }

    /// State of the character: what decides its pose.
    pub fn state(&self) -> State {
        self.state
    }

    /// Its bodies, while it has any: limp, or preparing to get up.
    pub fn ragdoll(&self) -> Option<&Ragdoll> {
        self.ragdoll.as_ref()
    }

    /// Drives of its bodies, while it has any.
    pub fn drives(&self) -> &Drives {
        &self.drives
    }

    /// Local transform of every joint of the rig, springs, garments and all; nodes above the pelvis are at rest (see [`crate::mapping`]).
    pub fn pose(&self) -> &[LocalTransform] {
        if self.swung.is_empty() { self.pose_without_springs() } else { &self.swung }
    }

    /// [`pose`](Self::pose) as clips and bodies have it, with all springs and garments at rest.
    pub fn pose_without_springs(&self) -> &[LocalTransform] {
        self.led_pose()
    }

    /// The pose that the clips lead to, with feet on the ground and nothing deep in the floor.
    fn led_pose(&self) -> &[LocalTransform] {
        if self.is_planted() { &self.planted } else { &self.pose }
    }

    /// True while what is shown is not quite the clips' pose.
    fn is_planted(&self) -> bool {
        !self.planting.is_over() || self.is_passing()
    }

    /// Pose of the character in the world. While it is limp: the one in which it went limp.
    pub fn world_from_character(&self) -> Transform {
        self.world_from_character
    }

    /// From the file's model space to the world: what a renderer puts above the pose.
    pub fn world_from_model(&self) -> Affine {
        self.def.mapping().world_from_model(self.world_from_character)
    }

    /// Animator that plays its clips: those of [`CharacterDef::set`].
    pub fn animator(&self) -> &Animator {
        &self.animator
    }

    /// Animator that plays its clips, to be given others: tracks, crossfades, layers. To begin with it plays the looped clip, and
    /// again after getting up; getting up stops all other tracks of layer 0. While the character is limp, what plays still moves
    /// the joints that no body does ([`Mapping::free`](crate::Mapping::free)), and events go on.
    pub fn animator_mut(&mut self) -> &mut Animator {
        &mut self.animator
    }

    /// Events of the last [`update`](Self::update) and since the one before it ended, in order, and what calls have brought about
    /// since. Who reads it after each update, and only then, is told of everything exactly once.
    pub fn events(&self) -> &[CharacterEvent] {
        &self.events
    }

    /// Follows the world by the step that it has just taken.
    ///
    /// # Panics
    /// If the world is not the one that the character is in.
    pub fn update(&mut self, world: &mut World) {
        self.events.drain(..self.told);
        self.keep_shown();
        self.note_contacts(world);
        self.mind_holds(world);
        self.mind_parting(world);
        self.mind_freed(world);
        if !self.is_frozen() {
            self.follow(world);
            self.settle_detail(world);
            self.wear(world);
        }
        self.told = self.events.len();
    }

    fn follow(&mut self, world: &mut World) {
        match self.state {
            State::Limp => self.lie(world),
            State::Preparing => self.go_on_preparing(world),
            State::Flinching | State::Powered => {
                self.feel(world);
                match self.state {
                    State::Limp => self.follow_bodies(world),
                    _ => self.go_on_powered(world),
                }
            }
            State::Animated => {
                self.animate(world);
                self.plant(world);
                self.attend(world);
            }
            State::GettingUp => {
                self.animate(world);
                self.straighten();
                self.rise(world);
                self.plant(world);
                self.attend(world);
            }
        }
    }

    /// Exchange of a character that its clips move with the world: blows, hit bodies, steering.
    fn attend(&mut self, world: &mut World) {
        if self.presence.is_none() {
            return;
        }
        if self.falls() {
            return self.go_limp(world);
        }
        self.feel(world);
        if self.ragdoll.is_none() {
            self.lead_bodies(world);
        }
        self.steer(world);
    }
}
