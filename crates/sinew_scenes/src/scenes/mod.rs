//! Named scenarios: each builds a world, drives it, and says by figures whether the physics holds.
//!
//! ```
//! let scene = sinew_scenes::scenes::find("pendulum").expect("it is one of the registry's");
//! let mut settings = scene.settings();
//! settings.assign("amplitude=30")?;
//! let mut run = scene.start(&settings);
//! for _ in 0..scene.steps {
//!     run.step();
//! }
//! assert!(run.metrics().iter().all(|metric| metric.is_met()));
//! # Ok::<(), sinew_scenes::scenes::SettingError>(())
//! ```

mod actors;
mod camera_hint;
mod flight;
mod instance;
mod metric;
mod setting;
mod stand;

mod air;
mod arch;
mod arena;
mod ballistics;
mod blasts;
mod blending;
mod blobs;
mod boxes;
mod cabin;
mod callbacks;
mod chains;
mod cloths;
mod coin;
mod crowds;
mod drives;
mod engine;
mod falls;
mod forces;
mod gimbal;
mod house;
mod impacts;
mod incline;
mod laden;
mod linkages;
mod mjcf;
mod mocap;
mod motors;
mod movers;
mod nets;
mod orbits;
mod orientation;
mod overhang;
mod particles;
mod pendulums;
mod piles;
mod ragdolls;
mod rolling;
mod settling;
mod showroom;
mod springs;
mod stacks;
mod street;
mod strings;
mod support;
mod surfaces;
mod throng;
mod tops;
mod transitions;
mod trees;
mod walking;
mod water;
mod weightless;

pub use actors::Figure;
pub use camera_hint::{CameraHint, Trails};
pub use instance::{Instance, Part, Script};
pub use metric::{Expected, Metric};
pub use setting::{Domain, Setting, SettingError, Settings};

use crate::parts;
use setting::Setup;

/// A named scenario.
#[derive(Clone, Copy, Debug)]
pub struct Scene {
    /// Name of the scene for `sinew run`.
    pub name: &'static str,
    /// One line for people.
    pub about: &'static str,
    /// Steps of 1/60 s after which its expectations hold.
    pub steps: u32,
    settings: &'static [Setting],
    build: fn(&Setup<'_>) -> Instance,
}

impl Scene {
    /// Its settings, all at their defaults.
    pub fn settings(&self) -> Settings {
        Settings::new(self.settings)
    }

    /// Builds it.
    ///
    /// # Panics
    /// If the settings are those of another scene, or one that has to be set is not: see [`Settings::check`].
    pub fn start(&self, settings: &Settings) -> Instance {
        self.start_under(settings, 1.0)
    }

    /// Builds it in a world whose gravity is wrong by a factor, while its expectations remain those of the right one:
    /// they must fail wherever gravity matters.
    ///
    /// # Panics
    /// If the settings are those of another scene.
    pub fn start_under(&self, settings: &Settings, gravity_factor: f32) -> Instance {
        (self.build)(&Setup { settings, gravity_factor })
    }
}

/// All scenes, closed forms first.
pub fn registry() -> &'static [Scene] {
    REGISTRY
}

const REGISTRY: &[Scene] = &[
    ballistics::FREE_FALL,
    ballistics::PROJECTILE,
    ballistics::BOUNCE,
    forces::TWO_MEN,
    forces::PUSH,
    forces::BULLET,
    orbits::KEPLER,
    orbits::SUN_EARTH,
    orbits::THREE_BODIES,
    air::WIND,
    air::TERMINAL_VELOCITY,
    water::FLOAT,
    blasts::EXPLOSION,
    pendulums::PENDULUM,
    pendulums::DOUBLE_PENDULUM,
    pendulums::TRIPLE_PENDULUM,
    motors::ARM,
    linkages::LINKAGE,
    incline::HOLDS,
    incline::SLIDES,
    incline::ROLLS,
    rolling::SLIDE_TO_ROLL,
    rolling::ROLLING_BALLS,
    coin::COIN,
    surfaces::STATIC_FRICTION,
    surfaces::CONVEYOR,
    surfaces::ONE_WAY,
    surfaces::SENSORS,
    movers::COURSE,
    street::STREET,
    arena::ARENA,
    impacts::ELASTIC_PAIRS,
    impacts::NEWTONS_CRADLE,
    impacts::BOUNCING_BALLS,
    overhang::BLOCK_OVERHANG,
    tops::DZHANIBEKOV,
    tops::SYMMETRIC_TOP,
    tops::SPINNING_TOP,
    springs::SPRING,
    springs::SPRING_CHAIN,
    springs::SPRINGS_RATIO,
    strings::CATENARY,
    strings::CHAIN_MODES,
    particles::PARTICLE,
    particles::FAST_PARTICLE,
    cloths::CLOTH,
    blobs::BLOB,
    blobs::STEEL_VS_BASKETBALL,
    gimbal::GIMBAL,
    orientation::MATRIX_DRIFT,
    orientation::VERSOR,
    orientation::HELPERS,
    weightless::ZERO_GRAVITY_PILE,
    weightless::SPIN_DOUBLE,
    weightless::SPIN_TRIPLE,
    weightless::SPIN_RAGDOLL,
    cabin::CABIN,
    showroom::SHOWROOM,
    piles::STACK,
    piles::PYRAMID,
    piles::DOMINOES,
    stacks::MASS_RATIO,
    stacks::SIZE_RATIO,
    stacks::JENGA,
    stacks::CARDS,
    arch::ARCH,
    stacks::LARGE_PYRAMID,
    laden::JENGA,
    laden::SIZE_RATIO,
    laden::MASS_RATIO,
    laden::CARDS,
    laden::PYRAMID,
    laden::ARCH,
    laden::STACK,
    springs::ROPE_ON_BOX,
    ragdolls::DROP,
    falls::POSES,
    drives::POWERED,
    drives::HIT_REACTION,
    ragdolls::WALL,
    ragdolls::WALL_FAST,
    ragdolls::STAIRS,
    chains::SWING_1000,
    chains::SWING_100,
    chains::HANG_1000,
    chains::HANG_100,
    chains::LINKS_100,
    chains::HEAVY_ROPE,
    chains::HANGING_ROPE,
    nets::JOINT_GRID,
    nets::NET,
    crowds::PILE,
    throng::CROWD,
    settling::RAGDOLLS,
    settling::WAVE_PILE,
    settling::MESH_DROP,
    settling::ROCKS,
    crowds::RAIN,
    engine::FRAME_RATES,
    engine::TAUTOCHRONE,
    trees::HEAVY_FOOT,
    trees::MASS_RATIO,
    boxes::AABB_VS_OBB,
    boxes::POINT_IN_OBB,
    blending::TWO_TRACKS,
    blending::WALK_RUN,
    transitions::TRANSITION,
    callbacks::FOOTSTEPS,
    callbacks::PUNCH,
    walking::ROOT_WALK,
    walking::UNEVEN_GROUND,
    mocap::RETARGET,
];

/// Scenes that need a file of the user's, and so are in no list.
const OF_FILES: &[Scene] = &[mjcf::DROP, house::HOUSE, mocap::MOCAP];

/// The scene of that name; of those that need a file, too, which the registry does not list.
pub fn find(name: &str) -> Option<&'static Scene> {
    registry().iter().chain(OF_FILES).find(|scene| scene.name == name)
}
