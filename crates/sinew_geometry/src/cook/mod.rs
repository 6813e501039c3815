//! From a triangle mesh to a few oriented boxes.
//!
//! A level is drawn as triangles and collides better as boxes: they are solid, few, and have no inner edges to stumble
//! over. [`cook`] goes from one to the other, [`Cooked::deviation`] says how far it went astray.
//!
//! 1. The mesh is checked and welded, and falls into its connected parts.
//! 2. A part that is a box within the tolerance becomes that box. Another is divided by the planes of its own facets
//!    into cells (with even planes between where it is slanted or round), those inside the mesh by its winding
//!    number are full, and the full ones are covered by boxes as large as they can be.
//! 3. Flat regions that no box is near, as of a sheet without thickness, become plates behind their faces.
//! 4. Of more than a few hundred boxes the smallest are put together, cell by cell of a grid: searching all for what
//!    to merge would take the square of the time.
//! 5. Steps that add least to the squared distance between the surfaces, dropping a box or merging two, follow until
//!    no more are left than were asked for.
//! 6. A box on which one can stand is laid against the ground that it stands for: treads stay level, and as high as drawn.

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
    /// Most boxes, at least 1. Default 150.
    pub max_boxes: usize,
    /// Most distance of a box from the part of the mesh that it stands for, as a share of the mesh's diagonal, before
    /// more boxes are tried. Default 0.01.
    pub tolerance: f32,
}

impl Default for CookOptions {
    fn default() -> Self {
        Self { max_boxes: 150, tolerance: 0.01 }
    }
}

/// Boxes instead of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Cooked {
    /// The boxes, in the mesh's frame.
    pub boxes: Vec<Obb>,
    /// Their distance from it.
    pub deviation: Deviation,
    /// Repairs that were made to the mesh.
    pub repairs: Repairs,
    /// Connected parts of the mesh.
    pub parts: usize,
}

/// Progress of the cooking: told as it goes, for whoever waits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// So many triangles have their boxes.
    Triangles(usize),
    /// So many boxes are left.
    Boxes(usize),
}

/// Lengths that decisions are made by, metres.
#[derive(Clone, Copy, Debug)]
struct Scale {
    /// Most distance of a box from its part.
    tolerance: f32,
    /// Least half extent of a box.
    thinnest: f32,
    /// Thickness of a plate behind a sheet.
    thickness: f32,
    /// Distances that nobody sees.
    unseen: f32,
}

/// Boxes for a mesh given by its vertices (metres) and triangles, counter-clockwise seen from outside. The same boxes for
/// the same mesh, always.
///
/// # Errors
/// See [`CookError`].
///
/// # Panics
/// If the options ask for no box, or the tolerance is not between 0 and 1.
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
    let mut random = Random::new(mesh.triangles.len() as u64);
    let scale = scale(&mesh, options);
    let blocks = first_boxes(&mesh, &bvh, scale, &mut random, progress);
    let blocks =
        coarse::at_most(usize::max(MOST_FIRST, options.max_boxes.saturating_mul(2)), blocks, scale.thinnest);
    let all: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
    let (points, area) = sample::sample(&mesh, &all, POINTS, &mut random);
    let area = area / POINTS as f32;
    let reduction = Reduction::new(&bvh, &points, area, scale, &blocks);
    let boxes = reduction.run(options.max_boxes, &mut |left| progress(Progress::Boxes(left)));
    let deviation = measure::measure(&mesh, &bvh, &boxes, &mut random);
    Ok(Cooked { boxes, deviation, repairs: mesh.repairs, parts: mesh.parts })
}

/// Points of the mesh by which boxes are judged.
const POINTS: usize = 16_384;
/// Boxes that the search for good merges begins with, at most, unless nearly as many are to remain.
const MOST_FIRST: usize = 768;

fn scale(mesh: &SurfaceMesh, options: &CookOptions) -> Scale {
    let diagonal = mesh.diagonal();
    Scale {
        tolerance: options.tolerance * diagonal,
        // What the engine can hold apart at least: a box thinner than its slop is no obstacle.
        thinnest: max(5e-4 * diagonal, 1e-6),
        thickness: 0.5 * options.tolerance * diagonal,
        unseen: 0.15 * options.tolerance * diagonal,
    }
}

/// As many boxes as the mesh asks for.
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
