//! The embedded world: a cabin made of boxes, with stairs down from its porch.
//!
//! Metres, +Y up. The front edge of the porch is the line z = 0 at [`PORCH_HEIGHT`]; the stairs go down toward +Z and
//! the cabin stands behind, at z < 0. Everything is static.

use sinew::math::{Rotation, Transform, Vec3, trig};
use sinew::physics::def::{BodyDef, BodyKind};
use sinew::physics::shape::{Shape, ShapeDef};

/// World to build.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Site {
    /// The cabin on its posts, with porch and stairs.
    CabinWithStairs,
    /// The meadow without the cabin: flat ground at y = 0 in place of the stairs.
    Flat,
}

/// A static body to collide with and to draw.
#[derive(Clone, Debug, PartialEq)]
pub struct Prop {
    /// Name of the prop; not unique.
    pub name: &'static str,
    /// One shape at the body's origin: a box, or for the ground a half-space.
    pub body: BodyDef,
    /// Linear RGB colour, 0..=1.
    pub color: [f32; 3],
}

/// Start of the character.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spawn {
    /// World from character; the origin is between the soles, facing +Z of the transform.
    pub world_from_character: Transform,
    /// Distance straight ahead to the edge of the first step, metres.
    pub walk_length: f32,
}

/// Number of steps down from porch to ground.
pub const STEPS: usize = 7;
/// Height of one step, metres.
pub const STEP_RISE: f32 = 0.175;
/// Depth of one step, metres.
pub const STEP_RUN: f32 = 0.28;
/// Width of the stairs, metres.
pub const STAIRS_WIDTH: f32 = 1.6;
/// Height of the porch and of the cabin's floor above the ground, metres.
pub const PORCH_HEIGHT: f32 = STEPS as f32 * STEP_RISE;

const PORCH_HALF_WIDTH: f32 = 2.3;
/// Positions of the outer faces of the front and the back wall along z, metres.
const FRONT: f32 = -2.2;
const BACK: f32 = -6.4;
const HALF_WIDTH: f32 = 2.5;
/// Number of courses of squared logs in a wall, and height of a course, metres.
const COURSES: usize = 8;
const COURSE_HEIGHT: f32 = 0.3;
const LOG_HALF: f32 = 0.09;
/// The door reaches up to the bottom of the topmost course.
const DOOR_HALF_WIDTH: f32 = 0.55;
const EAVES: f32 = PORCH_HEIGHT + COURSES as f32 * COURSE_HEIGHT;
/// Slope of the roof, radians (35°).
const ROOF_PITCH: f32 = 0.610_865_2;

const GRASS: [f32; 3] = [0.16, 0.26, 0.09];
const LOGS: [[f32; 3]; 2] = [[0.36, 0.19, 0.085], [0.31, 0.16, 0.070]];
const PLANK: [f32; 3] = [0.45, 0.30, 0.17];
const TREAD: [[f32; 3]; 2] = [[0.50, 0.35, 0.21], [0.43, 0.29, 0.17]];
const BEAM: [f32; 3] = [0.16, 0.085, 0.042];
const SHINGLE: [f32; 3] = [0.24, 0.065, 0.045];
const STONE: [f32; 3] = [0.27, 0.27, 0.26];
const CRATE: [f32; 3] = [0.56, 0.40, 0.20];
const NEEDLES: [f32; 3] = [0.040, 0.130, 0.060];

impl Site {
    /// All props, the ground first.
    pub fn props(self) -> Vec<Prop> {
        let mut props = vec![ground()];
        meadow(&mut props);
        if self == Self::CabinWithStairs {
            floor_and_porch(&mut props);
            railing(&mut props);
            stairs(&mut props);
            walls(&mut props);
            gables(&mut props);
            roof(&mut props);
        }
        props
    }

    /// Start of the character: with a cabin, inside behind the door, facing the stairs; otherwise at the same position
    /// on the ground.
    pub fn spawn(self) -> Spawn {
        let start = FRONT - 0.4;
        let height = if self == Self::CabinWithStairs { PORCH_HEIGHT } else { 0.0 };
        Spawn {
            world_from_character: Transform::from_translation(Vec3::new(0.0, height, start)),
            walk_length: -start,
        }
    }
}

fn fixed(name: &'static str, shape: Shape, pose: Transform, color: [f32; 3]) -> Prop {
    let body = BodyDef {
        kind: BodyKind::Static,
        position: pose.translation,
        rotation: pose.rotation,
        shapes: vec![ShapeDef::new(shape)],
        ..BodyDef::default()
    };
    Prop { name, body, color }
}

fn ground() -> Prop {
    fixed("ground", Shape::HalfSpace, Transform::IDENTITY, GRASS)
}

/// Axis-aligned box between two corners.
fn block(name: &'static str, low: Vec3, high: Vec3, color: [f32; 3]) -> Prop {
    turned(name, (low + high) * 0.5, (high - low) * 0.5, Rotation::IDENTITY, color)
}

fn turned(name: &'static str, center: Vec3, half_extents: Vec3, rotation: Rotation, color: [f32; 3]) -> Prop {
    fixed(name, Shape::Box { half_extents }, Transform::new(center, rotation), color)
}

fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

fn floor_and_porch(props: &mut Vec<Prop>) {
    let top = PORCH_HEIGHT;
    props.push(block("floor", v(-HALF_WIDTH, top - 0.16, BACK), v(HALF_WIDTH, top, FRONT), PLANK));
    let edge = v(PORCH_HALF_WIDTH, top, 0.0);
    props.push(block("porch", v(-PORCH_HALF_WIDTH, top - 0.16, FRONT), edge, PLANK));
    for x in [-PORCH_HALF_WIDTH + 0.15, PORCH_HALF_WIDTH - 0.15] {
        for z in [-0.15, FRONT + 0.1, 0.5 * (FRONT + BACK), BACK + 0.2] {
            let foot = v(x, 0.0, z);
            let half = v(0.11, 0.0, 0.11);
            props.push(block("pile", foot - half, foot + half + Vec3::Y * (top - 0.16), STONE));
        }
    }
}

/// Adds posts and two rails along the open sides of the porch, except at the stairs.
fn railing(props: &mut Vec<Prop>) {
    let (top, outer, inner) = (PORCH_HEIGHT, PORCH_HALF_WIDTH - 0.06, 0.5 * STAIRS_WIDTH + 0.06);
    let rail = |low: Vec3, high: Vec3| block("rail", low, high, BEAM);
    for side in [-1.0, 1.0] {
        for (x, z) in [(outer, -0.06), (inner, -0.06), (0.5 * (outer + inner), -0.06), (outer, -1.1)] {
            let foot = v(side * x, top, z);
            let half = v(0.045, 0.0, 0.045);
            props.push(block("post", foot - half, foot + half + Vec3::Y * 0.92, BEAM));
        }
        for height in [0.48, 0.88] {
            let y = top + height;
            let ends = if side > 0.0 { (inner, outer) } else { (-outer, -inner) };
            props.push(rail(v(ends.0, y - 0.035, -0.085), v(ends.1, y + 0.035, -0.035)));
            let x = side * outer;
            props.push(rail(v(x - 0.025, y - 0.035, FRONT), v(x + 0.025, y + 0.035, -0.06)));
        }
    }
}

/// Adds solid steps down to the ground, so that nothing slips between them, and a stringer on each side.
fn stairs(props: &mut Vec<Prop>) {
    let half_width = 0.5 * STAIRS_WIDTH;
    for step in 1..STEPS {
        let below_porch = step as f32;
        let (top, start) = (PORCH_HEIGHT - below_porch * STEP_RISE, (below_porch - 1.0) * STEP_RUN);
        let (low, high) = (v(-half_width, 0.0, start), v(half_width, top, start + STEP_RUN));
        props.push(block("step", low, high, TREAD[step % 2]));
    }
    let run = (STEPS - 1) as f32 * STEP_RUN;
    let slope = trig::atan2(STEP_RISE, STEP_RUN);
    let length = (run * run + (PORCH_HEIGHT - STEP_RISE) * (PORCH_HEIGHT - STEP_RISE)).sqrt();
    for side in [-1.0, 1.0] {
        // The stringer's centre line runs through the centres of the steps' noses.
        let center = v(side * (half_width + 0.035), 0.5 * PORCH_HEIGHT - 0.04, 0.5 * run);
        let rotation = Rotation::from_axis_angle(Vec3::X, slope);
        props.push(turned("stringer", center, v(0.035, 0.13, 0.5 * length + 0.04), rotation, BEAM));
    }
}

/// Adds courses of logs around the cabin; the front ones, except for the topmost, leave room for the door.
fn walls(props: &mut Vec<Prop>) {
    for course in 0..COURSES {
        let bottom = PORCH_HEIGHT + course as f32 * COURSE_HEIGHT;
        let color = LOGS[course % 2];
        let mut log = |x: [f32; 2], z: [f32; 2]| {
            let top = bottom + COURSE_HEIGHT;
            props.push(block("log wall", v(x[0], bottom, z[0]), v(x[1], top, z[1]), color));
        };
        // Courses cross at the corners alternately, as logs do.
        let jut = if course % 2 == 0 { 0.14 } else { 0.0 };
        let (x, front) = (HALF_WIDTH + jut, [FRONT - 2.0 * LOG_HALF, FRONT]);
        log([-x, x], [BACK, BACK + 2.0 * LOG_HALF]);
        if course + 1 == COURSES {
            log([-x, x], front);
        } else {
            log([-x, -DOOR_HALF_WIDTH], front);
            log([DOOR_HALF_WIDTH, x], front);
        }
        let z = [BACK - 0.14 + jut, FRONT + 0.14 - jut];
        log([-HALF_WIDTH, -HALF_WIDTH + 2.0 * LOG_HALF], z);
        log([HALF_WIDTH - 2.0 * LOG_HALF, HALF_WIDTH], z);
    }
    for side in [-1.0, 1.0] {
        let center = v(side * (DOOR_HALF_WIDTH + 0.04), 0.5 * (PORCH_HEIGHT + EAVES - COURSE_HEIGHT), FRONT);
        let half = v(0.05, 0.5 * (EAVES - COURSE_HEIGHT - PORCH_HEIGHT), 0.03);
        props.push(turned("door frame", center, half, Rotation::IDENTITY, BEAM));
        window(props, side * 1.55);
    }
}

/// Adds a dark pane in a frame on the front wall.
fn window(props: &mut Vec<Prop>, x: f32) {
    let center = v(x, PORCH_HEIGHT + 1.35, FRONT);
    props.push(turned("window frame", center, v(0.42, 0.42, 0.025), Rotation::IDENTITY, BEAM));
    props.push(turned("window", center, v(0.34, 0.34, 0.035), Rotation::IDENTITY, [0.10, 0.16, 0.20]));
}

/// Adds shrinking courses that fill the triangles under the roof on both sides.
fn gables(props: &mut Vec<Prop>) {
    let half_depth = 0.5 * (FRONT - BACK);
    let middle = 0.5 * (FRONT + BACK);
    let slope = trig::tan(ROOF_PITCH);
    let courses = (half_depth * slope / COURSE_HEIGHT) as usize;
    for course in 0..courses {
        let bottom = EAVES + course as f32 * COURSE_HEIGHT;
        let reach = half_depth - (course + 1) as f32 * COURSE_HEIGHT / slope;
        for x in [-HALF_WIDTH, HALF_WIDTH - 2.0 * LOG_HALF] {
            let low = v(x, bottom, middle - reach);
            let high = v(x + 2.0 * LOG_HALF, bottom + COURSE_HEIGHT, middle + reach);
            props.push(block("gable", low, high, LOGS[course % 2]));
        }
    }
}

/// Adds two tilted slabs that meet in the ridge, along x, and a chimney.
fn roof(props: &mut Vec<Prop>) {
    let (sin, cos) = trig::sin_cos(ROOF_PITCH);
    let (half_depth, middle) = (0.5 * (FRONT - BACK), 0.5 * (FRONT + BACK));
    let thickness = 0.08;
    // A slab reaches from the tip of the overhang to a little past the ridge, so that the upper faces meet.
    let past_ridge = 2.0 * thickness * sin / cos;
    let length = half_depth / cos + 0.5 + past_ridge;
    let ridge = EAVES + half_depth * sin / cos;
    for side in [-1.0, 1.0] {
        let down = v(0.0, -sin, side * cos);
        let out = v(0.0, cos, side * sin);
        let center = v(0.0, ridge, middle) + down * (0.5 * length - past_ridge) + out * thickness;
        let rotation = Rotation::from_axis_angle(Vec3::X, side * ROOF_PITCH);
        let half = v(HALF_WIDTH + 0.4, thickness, 0.5 * length);
        props.push(turned("roof", center, half, rotation, SHINGLE));
    }
    let low = v(1.1, EAVES + 0.6, middle - 1.15);
    props.push(block("chimney", low, v(1.65, ridge + 0.75, middle - 0.6), STONE));
}

/// Adds props on the grass beside the path: crates, a wood pile, pines.
fn meadow(props: &mut Vec<Prop>) {
    let yaw = |degrees: f32| Rotation::from_axis_angle(Vec3::Y, degrees.to_radians());
    props.push(turned("crate", v(2.95, 0.3, -0.7), v(0.3, 0.3, 0.3), yaw(18.0), CRATE));
    props.push(turned("crate", v(3.0, 0.2, 0.0), v(0.2, 0.2, 0.2), yaw(-25.0), CRATE));
    props.push(turned("crate", v(2.92, 0.78, -0.68), v(0.18, 0.18, 0.18), yaw(40.0), CRATE));
    for (x, y) in [(-3.3, 0.11), (-3.06, 0.11), (-2.82, 0.11), (-3.18, 0.33), (-2.94, 0.33), (-3.06, 0.55)] {
        props.push(turned(
            "firewood",
            v(x, y, -0.8),
            v(0.11, 0.11, 0.5),
            Rotation::IDENTITY,
            LOGS[usize::from(y > 0.2)],
        ));
    }
    for (x, z, height) in [(-5.4, -5.2, 5.0), (5.0, -8.2, 5.8), (-4.0, -8.6, 6.4)] {
        pine(props, v(x, 0.0, z), height);
    }
}

/// Adds a trunk under four shrinking tiers, each rotated a little.
fn pine(props: &mut Vec<Prop>, foot: Vec3, height: f32) {
    let trunk = v(0.025 * height, 0.16 * height, 0.025 * height);
    props.push(turned("pine", foot + Vec3::Y * trunk.y, trunk, Rotation::IDENTITY, BEAM));
    for tier in 0..5 {
        let t = tier as f32;
        let width = (0.19 - 0.033 * t) * height;
        let center = foot + Vec3::Y * ((0.30 + 0.145 * t) * height);
        let rotation = Rotation::from_axis_angle(Vec3::Y, 0.5 * t);
        props.push(turned("pine", center, v(width, 0.075 * height, width), rotation, NEEDLES));
    }
}
