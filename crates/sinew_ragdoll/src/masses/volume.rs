//! Volume that a skin encloses, and the density of the body.
//!
//! ```
//! use sinew_math::Vec3;
//! use sinew_ragdoll::masses::volume::enclosed;
//!
//! // A tetrahedron whose corners are the origin and one metre along each axis.
//! let (o, x, y, z) = (Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z);
//! let volume = enclosed(&[[o, y, x], [o, x, z], [o, z, y], [x, y, z]]).expect("the mesh is closed");
//! assert!((volume - 1.0 / 6.0).abs() < 0.005, "{volume} m³");
//! ```

use crate::tuning::{CLOSED, FLESH, MACHINE};
use sinew_anim::Rig;
use sinew_math::{Vec3, clamp, max, max3, min, min3};

/// Number of sample lines along each side of the grid that is perpendicular to an axis.
const LINES: usize = 64;
/// Position of the lines in their cells, as shares of a cell: off the centre, where symmetric meshes have their edges.
const OFF_MIDDLE: [f32; 2] = [0.513_7, 0.487_1];

/// Returns the volume that triangles enclose, m³, the median over the three axes: overlapping volumes count once, and
/// so do inverted ones. Sample lines cross the volume along each axis. A line through a hole is ignored, and the other
/// lines are scaled up to replace it. `None` if most lines along every axis are ignored.
pub fn enclosed(triangles: &[[Vec3; 3]]) -> Option<f32> {
    let corners = || triangles.iter().flatten().copied();
    let low = corners().reduce(min3)?;
    let high = corners().reduce(max3)?;
    let mut volumes: Vec<f32> = (0..3).filter_map(|axis| along(triangles, low, high, axis)).collect();
    volumes.sort_by(f32::total_cmp);
    volumes.get(volumes.len() / 2).copied()
}

/// Crossings of one line with the skin: position, and true if the line leaves the volume.
type Crossings = Vec<(f32, bool)>;

fn along(triangles: &[[Vec3; 3]], low: Vec3, high: Vec3, axis: usize) -> Option<f32> {
    let (across, up) = ((axis + 1) % 3, (axis + 2) % 3);
    let step = [across, up].map(|side| (high[side] - low[side]) / LINES as f32);
    if step.iter().any(|step| *step <= 0.0) {
        return None;
    }
    let mut lines: Vec<Crossings> = vec![Vec::new(); LINES * LINES];
    for corners in triangles {
        // Convert to grid cells, so that lines are at integer coordinates.
        let flat = corners.map(|corner| {
            [
                (corner[across] - low[across]) / step[0] - OFF_MIDDLE[0],
                (corner[up] - low[up]) / step[1] - OFF_MIDDLE[1],
            ]
        });
        cross(flat, corners.map(|corner| corner[axis]), &mut lines);
    }
    let (mut sum, mut closed, mut met) = (0.0, 0, 0);
    for line in lines.iter_mut().filter(|line| !line.is_empty()) {
        met += 1;
        if let Some(length) = inside(line) {
            closed += 1;
            sum += length;
        }
    }
    let is_closed = closed as f32 > CLOSED * met as f32;
    is_closed.then(|| sum * step[0] * step[1] * met as f32 / closed as f32)
}

/// Adds the crossings of a triangle with the lines at integer coordinates.
fn cross(flat: [[f32; 2]; 3], heights: [f32; 3], lines: &mut [Crossings]) {
    let [a, b, c] = flat;
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    if area == 0.0 {
        return;
    }
    let range = |side: usize| {
        let (lo, hi) = (min(a[side], min(b[side], c[side])), max(a[side], max(b[side], c[side])));
        let cell = |x: f32| clamp(x, 0.0, (LINES - 1) as f32);
        cell(lo.ceil()) as usize..=cell(hi.floor()) as usize
    };
    for row in range(1) {
        for column in range(0) {
            let p = [column as f32, row as f32];
            // Twice the area on the far side of each edge; an edge belongs to exactly one of its two triangles.
            let side = |from: [f32; 2], to: [f32; 2]| {
                (to[0] - from[0]) * (p[1] - from[1]) - (p[0] - from[0]) * (to[1] - from[1])
            };
            let shares = [side(b, c), side(c, a), side(a, b)];
            if shares.iter().all(|share| (*share > 0.0) == (area > 0.0) && *share != 0.0) {
                let height = (0..3).map(|i| shares[i] * heights[i]).sum::<f32>() / area;
                lines[row * LINES + column].push((height, area > 0.0));
            }
        }
    }
}

/// Returns the length of a line within the skin; `None` if the line enters and leaves a different number of times.
fn inside(line: &mut Crossings) -> Option<f32> {
    line.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut depth, mut length) = (0_i32, 0.0);
    for (index, &(at, goes_out)) in line.iter().enumerate() {
        if depth != 0 {
            length += at - line[index - 1].0;
        }
        depth += if goes_out { -1 } else { 1 };
    }
    (depth == 0).then_some(length)
}

/// Words in names of machines.
const MACHINES: [&str; 14] = [
    "tank",
    "robot",
    "mech",
    "gun",
    "turret",
    "wheel",
    "wheels",
    "cannon",
    "engine",
    "rotor",
    "propeller",
    "chassis",
    "piston",
    "drone",
];

/// Returns the density of a body's matter, kg/m³, and the name of the matter, from words in the names of its joints.
pub fn density(rig: &Rig) -> (f32, &'static str) {
    let is_machine =
        rig.joints.iter().any(|joint| words(&joint.name).any(|word| MACHINES.contains(&word.as_str())));
    if is_machine { (MACHINE, "a machine") } else { (FLESH, "flesh") }
}

/// Splits a name into words in lower case: `TankTrack22.L` is `tank`, `track`, `l`.
fn words(name: &str) -> impl Iterator<Item = String> {
    let mut words: Vec<String> = Vec::new();
    let mut before = ' ';
    for letter in name.chars() {
        if letter.is_alphabetic() {
            let begins = !before.is_alphabetic() || before.is_lowercase() && letter.is_uppercase();
            match words.last_mut().filter(|_| !begins) {
                Some(word) => word.extend(letter.to_lowercase()),
                None => words.push(letter.to_lowercase().collect()),
            }
        }
        before = letter;
    }
    words.into_iter()
}
