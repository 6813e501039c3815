//! Surface of the mannequin, in the style of an artist's wooden figure; each part is a closed loft.
//!
//! Sections are tables of measurements in metres: height, width, depth.

use super::loft::{Chain, Loft, Section, mirror};
use super::skeleton::{Bone, FOREARM, UPPER_ARM, bind_position, left_arm_axes};
use crate::anim::{Primitive, RigMesh};
use crate::math::{Vec3, trig};

/// Linear RGBA of the trunk and limbs: pale beech.
const WOOD: [f32; 4] = [0.70, 0.47, 0.27, 1.0];
/// Linear RGBA of ball joints, neck and waist: dark walnut.
const JOINT: [f32; 4] = [0.085, 0.050, 0.032, 1.0];
/// Linear RGBA of shoes, cuffs and visor, which distinguish front from back.
const ACCENT: [f32; 4] = [0.030, 0.170, 0.260, 1.0];

/// Returns the mannequin's only mesh, carried by the root, with one primitive for each colour.
pub(super) fn mesh() -> RigMesh {
    RigMesh {
        name: "mannequin".to_owned(),
        joint: Bone::Root.index(),
        skin: Some(0),
        primitives: vec![
            primitive(WOOD, &[leg, arm, clavicle, hand, thumb], &[pelvis, chest, head, nose]),
            primitive(JOINT, &[knee, elbow, shoulder_ball], &[waist, neck]),
            primitive(ACCENT, &[shoe], &[visor]),
        ],
    }
}

/// Function that returns a part: its surface and the bones that move it.
type Part = fn() -> (Loft, Chain);

fn primitive(color: [f32; 4], left: &[Part], middle: &[Part]) -> Primitive {
    let mut primitive = Primitive { base_color: color, ..Primitive::default() };
    for part in left {
        let (loft, chain) = part();
        loft.build(&chain, &mut primitive);
    }
    mirror(&mut primitive);
    for part in middle {
        let (loft, chain) = part();
        loft.build(&chain, &mut primitive);
    }
    primitive
}

/// A horizontal section: height, half-width, depth in front of and behind `z`, `z`.
type Level = [f32; 5];

fn levels(x: f32, table: &[Level]) -> Vec<Section> {
    let section = |&[y, half_width, front, back, z]: &Level| Section {
        center: Vec3::new(x, y, z),
        u: Vec3::X * half_width,
        v: Vec3::Z * front,
        back: back / front,
        roundness: 1.0,
    };
    table.iter().map(section).collect()
}

fn upright(sections: Vec<Section>, bottom: f32, top: f32, sides: usize) -> Loft {
    Loft { sections, start_tip: Vec3::Y * -bottom, end_tip: Vec3::Y * top, sides, rings_per_span: 2 }
}

fn pelvis() -> (Loft, Chain) {
    let sections = levels(
        0.0,
        &[
            [0.865, 0.060, 0.070, 0.075, 0.000],
            [0.890, 0.118, 0.084, 0.096, 0.000],
            [0.925, 0.152, 0.094, 0.112, 0.000],
            [0.965, 0.157, 0.094, 0.108, 0.000],
            [1.005, 0.145, 0.088, 0.092, 0.000],
        ],
    );
    (upright(sections, 0.02, 0.03, 24), Chain::rigid(Bone::Hips))
}

fn waist() -> (Loft, Chain) {
    let sections = levels(
        0.0,
        &[
            [0.985, 0.120, 0.074, 0.074, -0.002],
            [1.040, 0.126, 0.084, 0.080, -0.004],
            [1.110, 0.116, 0.080, 0.078, -0.006],
            [1.180, 0.126, 0.082, 0.082, -0.008],
            [1.230, 0.112, 0.070, 0.070, -0.010],
        ],
    );
    let chain = Chain::rigid(Bone::Hips).then(bind_position(Bone::Spine), Vec3::Y, 0.045, Bone::Spine).then(
        bind_position(Bone::Chest),
        Vec3::Y,
        0.045,
        Bone::Chest,
    );
    (upright(sections, 0.03, 0.03, 24), chain)
}

fn chest() -> (Loft, Chain) {
    let sections = levels(
        0.0,
        &[
            [1.175, 0.124, 0.082, 0.082, -0.008],
            [1.215, 0.142, 0.098, 0.092, -0.010],
            [1.290, 0.158, 0.112, 0.104, -0.012],
            [1.355, 0.163, 0.108, 0.108, -0.014],
            [1.410, 0.142, 0.086, 0.094, -0.016],
            [1.448, 0.102, 0.064, 0.074, -0.018],
            [1.474, 0.064, 0.054, 0.060, -0.016],
        ],
    );
    let chain = Chain::rigid(Bone::Spine).then(bind_position(Bone::Chest), Vec3::Y, 0.05, Bone::Chest);
    (upright(sections, 0.03, 0.03, 24), chain)
}

fn neck() -> (Loft, Chain) {
    let sections = levels(
        0.0,
        &[
            [1.440, 0.060, 0.058, 0.058, -0.018],
            [1.480, 0.053, 0.054, 0.052, -0.014],
            [1.530, 0.050, 0.052, 0.050, -0.008],
            [1.580, 0.050, 0.052, 0.050, -0.002],
        ],
    );
    let chain = Chain::rigid(Bone::Chest).then(bind_position(Bone::Neck), Vec3::Y, 0.025, Bone::Neck).then(
        bind_position(Bone::Head),
        Vec3::Y,
        0.025,
        Bone::Head,
    );
    (upright(sections, 0.02, 0.02, 18), chain)
}

fn head() -> (Loft, Chain) {
    let sections = levels(
        0.0,
        &[
            [1.535, 0.030, 0.034, 0.026, 0.044],
            [1.553, 0.048, 0.056, 0.052, 0.030],
            [1.585, 0.062, 0.078, 0.082, 0.016],
            [1.625, 0.071, 0.087, 0.096, 0.010],
            [1.665, 0.076, 0.090, 0.104, 0.002],
            [1.698, 0.072, 0.082, 0.098, -0.003],
            [1.724, 0.055, 0.061, 0.075, -0.008],
        ],
    );
    (upright(sections, 0.010, 0.026, 24), Chain::rigid(Bone::Head))
}

fn nose() -> (Loft, Chain) {
    let loft = Loft::ellipsoid(
        Vec3::new(0.0, 1.618, 0.094),
        Vec3::X * 0.011,
        Vec3::new(0.0, 0.004, 0.017),
        Vec3::new(0.0, 0.024, -0.006),
        12,
    );
    (loft, Chain::rigid(Bone::Head))
}

/// A band across the eyes, around the front of the head.
fn visor() -> (Loft, Chain) {
    let section = |step: i32| {
        let angle = step as f32 * 0.2;
        let (sin, cos) = trig::sin_cos(angle);
        let out = Vec3::new(sin, 0.0, cos);
        let center = Vec3::new(0.0748 * sin, 1.658, 0.005 + 0.0885 * cos);
        Section { roundness: 0.7, ..Section::ellipse(center, Vec3::Y * 0.017, out * 0.006) }
    };
    let sections: Vec<Section> = (-6..=6).map(section).collect();
    let tip = Vec3::new(0.006, 0.0, -0.004);
    let start_tip = Vec3::new(-tip.x, tip.y, tip.z);
    (Loft { sections, start_tip, end_tip: tip, sides: 12, rings_per_span: 1 }, Chain::rigid(Bone::Head))
}

fn leg() -> (Loft, Chain) {
    let sections = levels(
        bind_position(Bone::LeftUpperLeg).x,
        &[
            [0.100, 0.030, 0.030, 0.033, -0.010],
            [0.150, 0.031, 0.031, 0.036, -0.008],
            [0.220, 0.036, 0.036, 0.044, -0.004],
            [0.310, 0.046, 0.042, 0.058, 0.000],
            [0.380, 0.050, 0.045, 0.062, 0.004],
            [0.440, 0.046, 0.045, 0.050, 0.008],
            [0.490, 0.044, 0.047, 0.043, 0.010],
            [0.550, 0.050, 0.054, 0.050, 0.009],
            [0.630, 0.061, 0.066, 0.060, 0.007],
            [0.720, 0.071, 0.076, 0.072, 0.005],
            [0.810, 0.079, 0.083, 0.084, 0.002],
            [0.890, 0.083, 0.084, 0.092, 0.000],
        ],
    );
    let chain = Chain::rigid(Bone::LeftFoot)
        .then(Vec3::Y * 0.115, Vec3::Y, 0.03, Bone::LeftLowerLeg)
        .then(bind_position(Bone::LeftLowerLeg), Vec3::Y, 0.05, Bone::LeftUpperLeg)
        .then(bind_position(Bone::LeftUpperLeg) + Vec3::Y * 0.03, Vec3::Y, 0.04, Bone::Hips);
    (upright(sections, 0.02, 0.075, 20), chain)
}

fn knee() -> (Loft, Chain) {
    let center = bind_position(Bone::LeftLowerLeg) + Vec3::Z * 0.002;
    let loft = Loft::ellipsoid(center, Vec3::X * 0.049, Vec3::Z * 0.052, Vec3::Y * 0.046, 20);
    (loft, Chain::rigid(Bone::LeftLowerLeg))
}

/// Builds the shoe from sections along it. Each has z, half-width, height of the top of the sole's curve, and height
/// above that.
fn shoe() -> (Loft, Chain) {
    const TABLE: [[f32; 4]; 9] = [
        [-0.066, 0.027, 0.030, 0.036],
        [-0.048, 0.034, 0.032, 0.058],
        [-0.012, 0.038, 0.034, 0.074],
        [0.022, 0.040, 0.034, 0.060],
        [0.060, 0.043, 0.030, 0.040],
        [0.095, 0.047, 0.026, 0.030],
        [0.125, 0.049, 0.024, 0.025],
        [0.155, 0.045, 0.021, 0.021],
        [0.176, 0.035, 0.019, 0.016],
    ];
    let x = bind_position(Bone::LeftFoot).x;
    let section = |&[z, half_width, sole, above]: &[f32; 4]| Section {
        center: Vec3::new(x, sole, z),
        u: Vec3::X * half_width,
        v: Vec3::Y * above,
        back: sole / above,
        roundness: 0.75,
    };
    let loft = Loft {
        sections: TABLE.iter().map(section).collect(),
        start_tip: Vec3::new(0.0, -0.006, -0.012),
        end_tip: Vec3::new(0.0, -0.006, 0.016),
        sides: 20,
        rings_per_span: 2,
    };
    let chain =
        Chain::rigid(Bone::LeftFoot).then(bind_position(Bone::LeftToes), Vec3::Z, 0.022, Bone::LeftToes);
    (loft, chain)
}

/// A section across the arm or hand: distance from the start, half-width toward the thumb, half-thickness toward the
/// palm.
type Across = [f32; 3];

fn across(origin: Vec3, along: Vec3, table: &[Across]) -> Vec<Section> {
    let axes = left_arm_axes();
    let side = axes.palm.cross(along);
    let section =
        |&[s, wide, thick]: &Across| Section::ellipse(origin + along * s, side * wide, axes.palm * thick);
    table.iter().map(section).collect()
}

fn arm() -> (Loft, Chain) {
    let axes = left_arm_axes();
    let (shoulder, elbow) = (bind_position(Bone::LeftUpperArm), bind_position(Bone::LeftLowerArm));
    let mut sections = across(
        shoulder,
        axes.upper,
        &[
            [0.000, 0.060, 0.058],
            [0.050, 0.056, 0.054],
            [0.110, 0.049, 0.047],
            [0.180, 0.043, 0.041],
            [0.245, 0.038, 0.036],
            [UPPER_ARM, 0.034, 0.033],
        ],
    );
    sections.extend(across(
        elbow,
        axes.fore,
        &[
            [0.045, 0.039, 0.037],
            [0.095, 0.040, 0.037],
            [0.160, 0.034, 0.031],
            [0.220, 0.028, 0.025],
            [FOREARM - 0.005, 0.026, 0.021],
        ],
    ));
    let loft = Loft {
        sections,
        start_tip: axes.upper * -0.056,
        end_tip: axes.fore * 0.018,
        sides: 16,
        rings_per_span: 2,
    };
    let chain = Chain::rigid(Bone::LeftUpperArm)
        .then(elbow, axes.upper + axes.fore, 0.045, Bone::LeftLowerArm)
        .then(bind_position(Bone::LeftHand), axes.fore, 0.03, Bone::LeftHand);
    (loft, chain)
}

fn elbow() -> (Loft, Chain) {
    let axes = left_arm_axes();
    let side = axes.palm.cross(axes.fore);
    let loft = Loft::ellipsoid(
        bind_position(Bone::LeftLowerArm),
        side * 0.038,
        axes.palm * 0.037,
        axes.fore * 0.037,
        16,
    );
    (loft, Chain::rigid(Bone::LeftLowerArm))
}

/// The collar, from the base of the neck to the shoulder ball.
fn clavicle() -> (Loft, Chain) {
    let (start, end) = (bind_position(Bone::LeftShoulder), bind_position(Bone::LeftUpperArm));
    let section = |t: f32, up: f32, deep: f32| {
        Section::ellipse(start + (end - start) * t, Vec3::Y * up, Vec3::Z * deep)
    };
    let sections = vec![
        section(0.05, 0.040, 0.058),
        section(0.35, 0.045, 0.064),
        section(0.70, 0.048, 0.062),
        section(0.95, 0.047, 0.054),
    ];
    let tip = Vec3::X * 0.03;
    let chain =
        Chain::rigid(Bone::Chest).then(start + (end - start) * 0.3, Vec3::X, 0.04, Bone::LeftShoulder);
    (Loft { sections, start_tip: -tip, end_tip: tip, sides: 16, rings_per_span: 2 }, chain)
}

/// The ball of the shoulder, visible in the gap between collar and arm when the arm is raised.
fn shoulder_ball() -> (Loft, Chain) {
    let center = bind_position(Bone::LeftUpperArm);
    let loft = Loft::ellipsoid(center, Vec3::X * 0.046, Vec3::Z * 0.054, Vec3::Y * 0.050, 16);
    let chain = Chain::rigid(Bone::LeftShoulder).then(center, Vec3::X, 0.04, Bone::LeftUpperArm);
    (loft, chain)
}

fn hand() -> (Loft, Chain) {
    let axes = left_arm_axes();
    let wrist = bind_position(Bone::LeftHand);
    let sections = across(
        wrist,
        axes.fore,
        &[
            [0.004, 0.027, 0.020],
            [0.035, 0.035, 0.018],
            [0.070, 0.042, 0.017],
            [0.105, 0.042, 0.016],
            [0.140, 0.037, 0.014],
            [0.166, 0.027, 0.011],
        ],
    );
    let loft = Loft {
        sections,
        start_tip: axes.fore * -0.018,
        end_tip: axes.fore * 0.014,
        sides: 16,
        rings_per_span: 2,
    };
    (loft, Chain::rigid(Bone::LeftLowerArm).then(wrist, axes.fore, 0.02, Bone::LeftHand))
}

fn thumb() -> (Loft, Chain) {
    let axes = left_arm_axes();
    let side = axes.palm.cross(axes.fore) * axes.palm.cross(axes.fore).z;
    let base = bind_position(Bone::LeftHand) + axes.fore * 0.030 + side * 0.018;
    let along = (axes.fore * 0.78 + side * 0.58 + axes.palm * 0.22).normalize();
    let mut sections =
        across(base, along, &[[0.0, 0.016, 0.015], [0.03, 0.014, 0.013], [0.062, 0.010, 0.010]]);
    for section in &mut sections {
        let u = section.v.cross(along).normalize() * section.u.length();
        section.v = along.cross(u).normalize() * section.v.length();
        section.u = u;
    }
    let loft =
        Loft { sections, start_tip: along * -0.012, end_tip: along * 0.010, sides: 12, rings_per_span: 2 };
    (loft, Chain::rigid(Bone::LeftHand))
}
