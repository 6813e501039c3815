//! Scenes: those of bodies come from `sinew_scenes`, the others are here.

mod boxes;
mod cloth;
mod rays;

pub use boxes::{BoxPair, BoxPairs};
pub use cloth::ClothScene;
pub use rays::{PlacedBox, RayScene};

use sinew_scenes::blueprint::{self, Blueprint};
use sinew_scenes::crowd::CrowdScene;

/// Step length of every scene, seconds.
pub const DT: f32 = 1.0 / 60.0;

/// A scene by its name.
#[derive(Clone, Copy)]
pub struct Scene {
    /// Name on the command line.
    pub name: &'static str,
    /// One-line description.
    pub about: &'static str,
    /// Field of the scene.
    pub field: Field,
    /// Sensitivity of the scene to its start.
    pub course: Course,
    /// Returns the work of an engine.
    pub work: fn() -> Work,
}

/// Sensitivity of a scene's run to a small change of its start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Course {
    /// The runs of the scene differ little: one run suffices.
    Steady,
    /// The run differs: results are those of several starts.
    Chaotic,
}

/// Field of an engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    /// Bodies, joints, cloth, queries of shapes.
    Physics,
    /// Ragdolls with joint limits and friction, awake.
    Figures,
    /// Clips and poses.
    Animation,
}

impl Field {
    /// Returns the field's name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Physics => "physics",
            Self::Figures => "figures",
            Self::Animation => "animation",
        }
    }
}

/// Work of an engine.
pub enum Work {
    /// Bodies and joints.
    Bodies(Blueprint),
    /// A cloth.
    Cloth(ClothScene),
    /// Rays against boxes.
    Rays(RayScene),
    /// Boxes against boxes.
    Boxes(BoxPairs),
    /// Characters that play clips.
    Crowd(CrowdScene),
}

macro_rules! bodies {
    ($name:literal, $about:literal, $blueprint:expr) => {
        bodies!($name, $about, $blueprint, Field::Physics, Course::Steady)
    };
    ($name:literal, $about:literal, $blueprint:expr, $field:expr, $course:expr) => {
        Scene {
            name: $name,
            about: $about,
            field: $field,
            course: $course,
            work: || Work::Bodies($blueprint),
        }
    };
}

/// Bodies in a heap.
macro_rules! heap {
    ($name:literal, $about:literal, $blueprint:expr) => {
        bodies!($name, $about, $blueprint, Field::Physics, Course::Chaotic)
    };
}

/// All scenes, in the order in which they are printed.
pub const SCENES: &[Scene] = &[
    heap!("ragdoll_pile", "100 ragdolls fall on 50 boxes", blueprint::ragdoll_pile()),
    bodies!("box_pyramid", "1,240 unit cubes in 15 layers", blueprint::box_pyramid()),
    heap!("box_rain", "4,000 boxes fall into a pit", blueprint::box_rain()),
    heap!("boxes_10000", "10,000 boxes sink into one heap in a pit", blueprint::boxes_10000()),
    heap!("crowd_pile", "100 of our own ragdolls fall into one heap in a pit", blueprint::crowd_pile()),
    bodies!("chain_100_links", "10 chains of 100 links, 100 kg at each end", blueprint::chain_100_links()),
    bodies!("joint_grid", "100 × 100 balls, all neighbours joined", blueprint::joint_grid()),
    bodies!("large_pyramid", "a wall of 5,050 unit cubes in 100 rows", blueprint::large_pyramid()),
    heap!("rain", "300 ragdolls fall on the ground", blueprint::rain()),
    bodies!(
        "stack_mass_ratio",
        "10 boxes, each 10 times as heavy as the one below",
        blueprint::stack_mass_ratio(10, 10.0)
    ),
    bodies!("stack_ratio", "6 boxes, each twice as large as the one below", blueprint::stack_ratio(6)),
    bodies!("jenga", "a tower of 18 levels of three blocks of 75 mm", blueprint::jenga(18)),
    bodies!("cards", "a house of 15 cards 2 mm thick", blueprint::cards(3)),
    bodies!("ragdolls", "8 ragdolls with friction in their joints fall asleep", blueprint::ragdolls()),
    bodies!("wave_pile", "100 balls, capsules and boxes on waves fall asleep", blueprint::wave_pile()),
    bodies!("mesh_drop", "400 sticks on waves fall asleep", blueprint::mesh_drop()),
    bodies!(
        "chain_swing_1000",
        "10 level links of 1 m, 1,000 kg at the end",
        blueprint::chain_swing(1e3, 1.0)
    ),
    bodies!("chain_swing_1000_half", "the same with links of 0.5 m", blueprint::chain_swing(1e3, 0.5)),
    bodies!("chain_swing_1000_quarter", "the same with links of 0.25 m", blueprint::chain_swing(1e3, 0.25)),
    bodies!("chain_swing_100", "10 level links of 1 m, 100 kg at the end", blueprint::chain_swing(1e2, 1.0)),
    bodies!("chain_hang_100", "10 plumb links of 1 m, 100 kg at the end", blueprint::chain_hang(1e2)),
    bodies!("chain_hang_1000", "10 plumb links of 1 m, 1,000 kg at the end", blueprint::chain_hang(1e3)),
    bodies!("heavy_rope", "19 level links, at the end 1,800 times one's mass", blueprint::heavy_rope()),
    bodies!("hanging_rope", "48 plumb links, at the end 200 times one's mass", blueprint::hanging_rope()),
    bodies!("net", "12 × 12 knots sag from two corners, 25 kg below", blueprint::net()),
    bodies!(
        "humanoid_lying",
        "one of our own ragdolls lies awake",
        blueprint::humanoid_lying(),
        Field::Figures,
        Course::Steady
    ),
    bodies!(
        "humanoid_pile_10",
        "10 of our own ragdolls fall into a pit and stay awake",
        blueprint::humanoid_pile(10),
        Field::Figures,
        Course::Chaotic
    ),
    bodies!(
        "humanoid_pile_100",
        "100 of our own ragdolls fall into one heap and stay awake",
        blueprint::humanoid_pile(100),
        Field::Figures,
        Course::Chaotic
    ),
    Scene {
        name: "cloth",
        about: "100 × 100 particles fall over a ball and a box",
        field: Field::Physics,
        course: Course::Steady,
        work: || Work::Cloth(ClothScene::new()),
    },
    Scene {
        name: "rays",
        about: "rays of 100 m against 10,000 boxes, 1,000 rays a step",
        field: Field::Physics,
        course: Course::Steady,
        work: || Work::Rays(RayScene::new()),
    },
    Scene {
        name: "obb_tests",
        about: "do two boxes overlap: 4,096 pairs that stay in the cache, all in a step",
        field: Field::Physics,
        course: Course::Steady,
        work: || Work::Boxes(BoxPairs::new(4_096, 4_096)),
    },
    Scene {
        name: "obb_tests_streamed",
        about: "do two boxes overlap: a million pairs from memory, 10,000 a step",
        field: Field::Physics,
        course: Course::Steady,
        work: || Work::Boxes(BoxPairs::new(1_000_000, 10_000)),
    },
    Scene {
        name: "crowd",
        about: "1,000 characters of 50 joints each blend two clips into model space",
        field: Field::Animation,
        course: Course::Steady,
        work: || Work::Crowd(CrowdScene::new(1_000)),
    },
];

/// Returns the scene of that name.
pub fn find(name: &str) -> Option<&'static Scene> {
    SCENES.iter().find(|scene| scene.name == name)
}

impl Work {
    /// Returns the number of measured steps.
    pub fn steps(&self) -> usize {
        match self {
            Self::Bodies(scene) => scene.steps as usize,
            Self::Cloth(_) => 300,
            Self::Rays(_) => 100,
            Self::Boxes(_) => 100,
            Self::Crowd(_) => 240,
        }
    }
}
