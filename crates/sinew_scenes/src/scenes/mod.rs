//! Named scenarios: each builds a world, drives it, and verifies the physics by metrics.
//!
//! ```
//! let scene = sinew_scenes::scenes::find("pendulum").expect("the scene is registered");
//! let mut settings = scene.settings();
//! settings.assign("amplitude=30")?;
//! let mut run = scene.start(&settings);
//! for _ in 0..scene.steps {
//!     run.step();
//! }
//! assert!(run.metrics().iter().all(|metric| metric.is_met()));
//! # Ok::<(), sinew_scenes::scenes::SettingError>(())
//! ```

mod characters;
mod contacts;
mod fields;
mod free_motion;
mod joints;
mod particles;
mod piles;
mod ragdolls;
mod shows;

pub use crate::framework::actors::Figure;
pub use crate::framework::acts::Act;
pub use crate::framework::camera_hint::{CameraHint, Trails};
pub use crate::framework::curve::Curve;
pub use crate::framework::instance::{Instance, Part, Script};
pub use crate::framework::metric::{Expected, Metric};
pub use crate::framework::scene::{Chapter, Scene};
pub use crate::framework::setting::{Domain, Setting, SettingError, Settings};

/// All scenes, those with closed forms first.
pub fn registry() -> &'static [Scene] {
    REGISTRY
}

const REGISTRY: &[Scene] = &[
    free_motion::ballistics::FREE_FALL,
    free_motion::ballistics::PROJECTILE,
    free_motion::ballistics::BOUNCE,
    free_motion::forces::TWO_MEN,
    free_motion::forces::PUSH,
    free_motion::forces::BULLET,
    free_motion::orbits::KEPLER,
    free_motion::orbits::SUN_EARTH,
    free_motion::orbits::THREE_BODIES,
    fields::air::WIND,
    fields::air::TERMINAL_VELOCITY,
    fields::water::FLOAT,
    fields::blasts::EXPLOSION,
    joints::pendulums::PENDULUM,
    joints::pendulums::DOUBLE_PENDULUM,
    joints::pendulums::TRIPLE_PENDULUM,
    joints::motors::ARM,
    joints::linkages::LINKAGE,
    contacts::incline::HOLDS,
    contacts::incline::SLIDES,
    contacts::incline::ROLLS,
    contacts::rolling::SLIDE_TO_ROLL,
    contacts::rolling::ROLLING_BALLS,
    contacts::coin::COIN,
    contacts::surfaces::STATIC_FRICTION,
    contacts::surfaces::CONVEYOR,
    contacts::surfaces::ONE_WAY,
    contacts::surfaces::SENSORS,
    characters::movers::COURSE,
    characters::street::STREET,
    characters::arena::ARENA,
    characters::brawl::BRAWL,
    contacts::impacts::ELASTIC_PAIRS,
    contacts::impacts::NEWTONS_CRADLE,
    contacts::impacts::BOUNCING_BALLS,
    contacts::overhang::BLOCK_OVERHANG,
    free_motion::tops::DZHANIBEKOV,
    free_motion::tops::SYMMETRIC_TOP,
    free_motion::tops::SPINNING_TOP,
    joints::springs::SPRING,
    joints::springs::SPRING_CHAIN,
    joints::springs::SPRINGS_RATIO,
    joints::strings::CATENARY,
    joints::strings::CHAIN_MODES,
    particles::single::PARTICLE,
    particles::single::FAST_PARTICLE,
    particles::cloths::CLOTH,
    particles::bearing::TRAMPOLINE,
    particles::sheets::FLAG,
    particles::sheets::CURTAIN,
    particles::folded::FOLDED,
    particles::rope_bridge::ROPE_BRIDGE,
    particles::blobs::BLOB,
    particles::blobs::STEEL_VS_BASKETBALL,
    free_motion::gimbal::GIMBAL,
    free_motion::orientation::MATRIX_DRIFT,
    free_motion::orientation::VERSOR,
    free_motion::orientation::HELPERS,
    free_motion::weightless::ZERO_GRAVITY_PILE,
    free_motion::weightless::SPIN_DOUBLE,
    free_motion::weightless::SPIN_TRIPLE,
    free_motion::weightless::SPIN_RAGDOLL,
    shows::cabin::CABIN,
    shows::showroom::SHOWROOM,
    piles::blocks::STACK,
    piles::blocks::PYRAMID,
    piles::blocks::DOMINOES,
    piles::stacks::MASS_RATIO,
    piles::stacks::SIZE_RATIO,
    piles::stacks::JENGA,
    piles::stacks::CARDS,
    piles::arch::ARCH,
    piles::stacks::LARGE_PYRAMID,
    piles::laden::JENGA,
    piles::laden::SIZE_RATIO,
    piles::laden::MASS_RATIO,
    piles::laden::CARDS,
    piles::laden::PYRAMID,
    piles::laden::ARCH,
    piles::laden::STACK,
    joints::springs::ROPE_ON_BOX,
    ragdolls::limp::DROP,
    ragdolls::falls::POSES,
    ragdolls::drives::POWERED,
    ragdolls::drives::HIT_REACTION,
    ragdolls::limp::WALL,
    ragdolls::limp::WALL_FAST,
    ragdolls::limp::STAIRS,
    joints::chains::SWING_1000,
    joints::chains::SWING_100,
    joints::chains::HANG_1000,
    joints::chains::HANG_100,
    joints::chains::LINKS_100,
    joints::chains::HEAVY_ROPE,
    joints::chains::HANGING_ROPE,
    joints::nets::JOINT_GRID,
    joints::nets::NET,
    piles::crowds::PILE,
    ragdolls::throng::CROWD,
    piles::settling::RAGDOLLS,
    piles::settling::WAVE_PILE,
    piles::settling::MESH_DROP,
    piles::settling::ROCKS,
    piles::crowds::RAIN,
    shows::engine::FRAME_RATES,
    shows::engine::TAUTOCHRONE,
    joints::trees::HEAVY_FOOT,
    joints::trees::MASS_RATIO,
    contacts::boxes::AABB_VS_OBB,
    contacts::boxes::POINT_IN_OBB,
    characters::blending::TWO_TRACKS,
    characters::blending::WALK_RUN,
    characters::transitions::TRANSITION,
    characters::callbacks::FOOTSTEPS,
    characters::callbacks::PUNCH,
    characters::walking::ROOT_WALK,
    characters::walking::UNEVEN_GROUND,
    characters::mocap::RETARGET,
    characters::hair::HAIR_RATES,
    characters::cape::CAPE,
    characters::skirt::SKIRT_SCENE,
];

/// Scenes that need a file of the user's, so the registry does not list them.
const OF_FILES: &[Scene] = &[ragdolls::mjcf::DROP, ragdolls::house::HOUSE, characters::mocap::MOCAP];

/// Finds the scene of that name, also among those that need a file.
pub fn find(name: &str) -> Option<&'static Scene> {
    registry().iter().chain(OF_FILES).find(|scene| scene.name == name)
}
