//! Converts a triangle mesh to a few oriented boxes.
//!
//! Levels are drawn as triangles, but collide better as boxes, which are solid, few, and have no internal edges.
//! [`cook`] converts a mesh; [`Cooked::deviation`] measures the error.
//!
//! 1. The mesh is checked, its vertices are welded, and it is split into connected parts.
//! 2. A part that is a box within the tolerance becomes that box. Any other part is divided into cells by the planes of
//!    its own facets, and by regular planes where it is slanted or round. Cells that are inside the mesh by its winding
//!    number are covered by boxes as large as possible.
//! 3. Flat regions far from any box, such as sheets without thickness, become plates behind their faces.
//! 4. If there are more than a few hundred boxes, the smallest are merged per cell of a grid, because the search for
//!    merges takes quadratic time.
//! 5. Boxes are dropped or merged until at most the requested number remains. Each step is the one that adds least to
//!    the squared distance between the surfaces.
//! 6. A box with a walkable top is aligned with the mesh's ground: treads stay level and keep their height.
//!
//! A mesh of few triangles gives few, coarse boxes. Then all steps are repeated with half the tolerance, as long as the
//! budget of boxes allows it and the error decreases.

mod box_set;
mod bvh;
mod cells;
mod coarse;
mod fit;
mod fitted;
mod measure;
mod mesh;
mod plates;
mod reduce;
mod sample;
mod settle;
mod solid;

pub use bvh::{ClosestPoint, MeshBvh};
pub use measure::Deviation;
pub use mesh::{CookError, MAX_TRIANGLES, Repairs};

use crate::boxes::Obb;
use mesh::SurfaceMesh;
use reduce::Reduction;
use sinew_math::{Random, Vec3, max};

/// Settings of [`cook`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CookOptions {
    /// Largest number of boxes, at least 1. Default 150.
    pub max_boxes: usize,
    /// Largest distance of a box from its part of the mesh, as a share of the mesh's diagonal, above which the part
    /// gets more boxes. Default 0.01.
    pub tolerance: f32,
}

impl Default for CookOptions {
    fn default() -> Self {
        Self { max_boxes: 150, tolerance: 0.01 }
    }
}

/// Boxes that replace a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Cooked {
    /// Boxes in the mesh's frame.
    pub boxes: Vec<Obb>,
    /// Deviation of the boxes from the mesh.
    pub deviation: Deviation,
    /// Repairs of the mesh.
    pub repairs: Repairs,
    /// Number of connected parts of the mesh.
    pub parts: usize,
}

/// Progress of the cooking, reported during the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// Number of triangles whose boxes are done.
    Triangles(usize),
    /// Number of remaining boxes.
    Boxes(usize),
}

/// Tolerances of one run, metres, and the size of cells.
#[derive(Clone, Copy, Debug)]
struct Scale {
    /// Largest distance of a box from its part of the mesh.
    tolerance: f32,
    /// Smallest half extent of a box.
    thinnest: f32,
    /// Thickness of a plate behind a sheet.
    thickness: f32,
    /// Distance below which a deviation is invisible.
    unseen: f32,
    /// Distance up to which a part is filled even if that closes its holes: solid boxes are more robust than plates.
    /// Depends only on the requested tolerance.
    filled: f32,
    /// Cell size for slanted parts, as a share of the usual size.
    finer: f32,
}

/// Ratio of [`Scale::filled`] to the requested tolerance.
const FILLED: f32 = 2.0;

/// Returns boxes for a mesh of vertices (metres) and triangles, counter-clockwise seen from outside. The same mesh
/// always gives the same boxes.
///
/// # Errors
/// See [`CookError`].
///
/// # Panics
/// If the options request no box, or the tolerance is not between 0 and 1.
pub fn cook(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    options: &CookOptions,
    progress: &mut dyn FnMut(Progress),
) -> Result<Cooked, CookError> {
    assert!(options.max_boxes > 0, "at least one box");
    assert!(options.tolerance > 0.0 && options.tolerance < 1.0, "the tolerance is a share");
    let mesh = SurfaceMesh::new(positions, triangles)?;
    let corners: Vec<[Vec3; 3]> = (0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect();
    let bvh = MeshBvh::new(&corners);
    drop(corners);
    let (mut boxes, mut deviation) = cook_once(&mesh, &bvh, options, 1.0, progress);
    let finest = if mesh.triangles.len() <= FEW_TRIANGLES { FINER } else { 0 };
    let mut finer = 1.0;
    for _ in 0..finest {
        let is_close = deviation.distance_p95 <= CLOSE * options.tolerance * mesh.diagonal();
        if is_close || 2 * boxes.len() > options.max_boxes {
            break;
        }
        finer *= 0.5;
        let (more, closer) = cook_once(&mesh, &bvh, options, finer, progress);
        if closer.distance_p95 < WORTH * deviation.distance_p95 {
            (boxes, deviation) = (more, closer);
        }
    }
    Ok(Cooked { boxes, deviation, repairs: mesh.repairs, parts: mesh.parts })
}

/// Largest number of triangles of a mesh that is cooked again because it gave few boxes.
const FEW_TRIANGLES: usize = 4096;
/// Largest number of times that the tolerance is halved.
const FINER: usize = 2;
/// Share of the tolerance within which 95 % of the surfaces must be for the boxes to be close enough: a plate is half
/// as thick as the tolerance.
const CLOSE: f32 = 0.55;
/// Largest ratio of the new error to the old error at which a result with more boxes is used.
const WORTH: f32 = 0.9;

/// Returns boxes, and their deviation from the mesh, for the requested tolerance times `finer`.
fn cook_once(
    mesh: &SurfaceMesh,
    bvh: &MeshBvh,
    options: &CookOptions,
    finer: f32,
    progress: &mut dyn FnMut(Progress),
) -> (Vec<Obb>, Deviation) {
    let mut random = Random::new(mesh.triangles.len() as u64);
    let scale = scale(mesh, options, finer);
    let blocks = first_boxes(mesh, bvh, scale, &mut random, progress);
    let blocks =
        coarse::at_most(usize::max(MOST_FIRST, options.max_boxes.saturating_mul(2)), blocks, scale.thinnest);
    let all: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
    let (points, area) = sample::sample(mesh, &all, POINTS, &mut random);
    let area = area / POINTS as f32;
    let reduction = Reduction::new(bvh, &points, area, scale, &blocks);
    let boxes = reduction.run(options.max_boxes, &mut |left| progress(Progress::Boxes(left)));
    let deviation = measure::measure(mesh, bvh, &boxes, &mut random);
    (boxes, deviation)
}

/// Number of sample points of the mesh from which errors of boxes are computed.
const POINTS: usize = 16_384;
/// Largest number of boxes at the start of the search for merges, unless nearly as many are requested.
const MOST_FIRST: usize = 768;

fn scale(mesh: &SurfaceMesh, options: &CookOptions, finer: f32) -> Scale {
    let diagonal = mesh.diagonal();
    Scale {
        tolerance: finer * options.tolerance * diagonal,
        // Least thickness of an obstacle: bodies sink into a box by the contact slop, so a thinner box would not stop
        // them.
        thinnest: max(5e-4 * diagonal, 1e-6),
        thickness: 0.5 * options.tolerance * diagonal,
        unseen: 0.15 * finer * options.tolerance * diagonal,
        filled: FILLED * options.tolerance * diagonal,
        finer,
    }
}

/// Returns as many boxes as the mesh needs.
fn first_boxes(
    mesh: &SurfaceMesh,
    bvh: &MeshBvh,
    scale: Scale,
    random: &mut Random,
    progress: &mut dyn FnMut(Progress),
) -> Vec<Obb> {
    let parts = mesh.triangles_by_part();
    let mut boxes = Vec::new();
    let mut done = 0;
    for triangles in &parts {
        boxes.extend(solid::blocks_of_part(mesh, bvh, triangles, scale, random));
        done += triangles.len();
        progress(Progress::Triangles(done));
    }
    boxes
}
