//! The sheet of a garment: its particles at rest and their connections.

use super::backing::{Backing, backings};
use super::grid::Grid;
use super::mesh;
use crate::def::RagdollDef;
use crate::tuning::{CLEARINGS, SHEET_ITERATIONS, SHORTEST_THREAD};
use sinew_anim::Garment;
use sinew_anim::garments::MeshSheet;
use sinew_math::{Transform, Vec3, max};
use sinew_physics::particles::{GroupDef, ParticleDef, SpringDef, SpringScheme, TetherDef};
use sinew_physics::{Material, Shape};

/// Sheet of a garment. Grid particles are ordered line by line from seam to hem, mesh particles in the order of their
/// joints.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sheet {
    /// Lines and rows, for a sheet on columns.
    pub grid: Option<Grid>,
    /// Particles at rest outside the bodies, character space, metres, with springs, bends and tethers, not attached to
    /// bodies yet.
    pub group: GroupDef,
    /// Offset that moved each particle out of the bodies at rest, character space, metres.
    pub moved_out: Vec<Vec3>,
    /// Largest distance between neighbouring particles, metres.
    pub spacing: f32,
    /// Particles that bodies hold.
    pub is_held: Vec<bool>,
    /// Body that holds each particle, or from which the particle hangs.
    pub held_by: Vec<usize>,
    /// Strand of each particle: its line, or the index of the held particle from which it hangs.
    pub strand: Vec<usize>,
    /// Bodies of the wearer that pass through the sheet, ascending.
    pub passed: Vec<usize>,
    /// Backstops of particles, if the garment has any.
    pub backings: Vec<Backing>,
}

impl Sheet {
    /// Creates the sheet of a garment on `columns` (polylines from the seam to the hem in the bind pose, character
    /// space, metres), each held by a body of the ragdoll.
    pub fn new(garment: &Garment, columns: &[Vec<Vec3>], held_by: &[usize], ragdoll: &RagdollDef) -> Self {
        let passed = passed(garment, held_by, ragdoll);
        let grid = Grid::new(columns, garment.closed, garment.spacing);
        let mut drawn = Vec::new();
        grid.places(columns, &mut drawn);
        let strand: Vec<usize> = (0..drawn.len()).map(|particle| particle / (grid.rows + 1)).collect();
        let is_held: Vec<bool> =
            (0..drawn.len()).map(|particle| particle.is_multiple_of(grid.rows + 1)).collect();
        let places = places_outside(&drawn, &is_held, garment.radius, ragdoll, &passed);
        let moved_out = places.iter().zip(&drawn).map(|(&place, &drawn)| place - drawn).collect();
        let held_by = strand.iter().map(|&line| held_by[grid.nearest_column(line)]).collect();
        let group = Weave { garment, grid: &grid, places: &places }.group();
        let spacing = garment.spacing;
        let backings = backings(garment, &group, &is_held, ragdoll, &passed);
        Self { grid: Some(grid), group, moved_out, spacing, is_held, held_by, strand, passed, backings }
    }

    /// Creates the sheet of a mesh whose particles have these positions in the bind pose, character space, metres; each
    /// particle hangs from a body of the ragdoll.
    pub fn of_mesh(
        garment: &Garment,
        mesh: &MeshSheet,
        drawn: &[Vec3],
        held_by: &[usize],
        ragdoll: &RagdollDef,
    ) -> Self {
        let holders: Vec<usize> =
            held_by.iter().zip(&mesh.held).filter(|(_, held)| **held).map(|(&body, _)| body).collect();
        let passed = passed(garment, &holders, ragdoll);
        let places = places_outside(drawn, &mesh.held, garment.radius, ragdoll, &passed);
        let moved_out = places.iter().zip(drawn).map(|(&place, &drawn)| place - drawn).collect();
        let (group, strand) = mesh::weave(garment, mesh, &places);
        let backings = backings(garment, &group, &mesh.held, ragdoll, &passed);
        Self {
            backings,
            grid: None,
            group,
            moved_out,
            spacing: garment.spacing,
            is_held: mesh.held.clone(),
            held_by: held_by.to_vec(),
            strand,
            passed,
        }
    }
}

/// Returns positions of particles outside the bodies with which they collide; held particles keep their positions.
fn places_outside(
    drawn: &[Vec3],
    is_held: &[bool],
    radius: f32,
    ragdoll: &RagdollDef,
    passed: &[usize],
) -> Vec<Vec3> {
    let met = ragdoll.bodies.iter().enumerate().filter(|(body, _)| !passed.contains(body));
    let bodies = met.map(|(_, body)| (&body.shape, body.character_from_body));
    let place = |(&place, &held): (&Vec3, &bool)| if held { place } else { cleared(place, radius, &bodies) };
    drawn.iter().zip(is_held).map(place).collect()
}

/// Returns a group of cloth of a garment, without springs.
pub(super) fn unsprung(garment: &Garment, particles: Vec<ParticleDef>) -> GroupDef {
    GroupDef {
        particles,
        scheme: SpringScheme::Projected,
        iterations: SHEET_ITERATIONS,
        material: Material { friction: garment.friction, ..Material::default() },
        linear_damping: garment.drag,
        thickness: garment.thickness,
        ..GroupDef::default()
    }
}

/// Returns particles of cloth, each with the mass of its area (m²).
pub(super) fn particles(garment: &Garment, places: &[Vec3], areas: &[f32]) -> Vec<ParticleDef> {
    // No particle is more than a hundred times lighter than the mean: where columns meet in a point, cells have no
    // area.
    let least = 0.01 * areas.iter().sum::<f32>() / areas.len() as f32;
    let particle = |(&position, &area): (&Vec3, &f32)| ParticleDef {
        position,
        velocity: Vec3::ZERO,
        mass: garment.area_density * max(area, max(least, f32::MIN_POSITIVE)),
        radius: garment.radius,
    };
    places.iter().zip(areas).map(particle).collect()
}

/// Returns the bodies of the wearer that pass through a garment: arms, unless the garment collides with them.
fn passed(garment: &Garment, held_by: &[usize], ragdoll: &RagdollDef) -> Vec<usize> {
    let role = |body: usize| ragdoll.bodies[body].role.as_str();
    let is_arm = |body: &usize| ["Shoulder", "Arm", "Hand"].iter().any(|part| role(*body).ends_with(part));
    let is_low = |&body: &usize| role(body) == "hips" || role(body).ends_with("Leg");
    let meets_arms = garment.meets_arms.unwrap_or(!held_by.iter().any(is_low));
    (0..ragdoll.bodies.len()).filter(is_arm).filter(|_| !meets_arms).collect()
}

/// Returns a position at least `radius` outside the bodies, near the given one.
pub(super) fn cleared<'a>(
    place: Vec3,
    radius: f32,
    bodies: &(impl Iterator<Item = (&'a Shape, Transform)> + Clone),
) -> Vec3 {
    let mut place = place;
    for _ in 0..CLEARINGS {
        let mut nearest = (radius, Vec3::ZERO);
        for (shape, frame) in bodies.clone() {
            let (distance, outward) = shape.signed_distance(&frame, place);
            if distance < nearest.0 {
                nearest = (distance, outward);
            }
        }
        if nearest.0 >= radius {
            break;
        }
        place += nearest.1 * (radius - nearest.0);
    }
    place
}

/// A sheet built from a grid.
struct Weave<'a> {
    garment: &'a Garment,
    grid: &'a Grid,
    places: &'a [Vec3],
}

impl Weave<'_> {
    fn group(&self) -> GroupDef {
        let (grid, garment) = (self.grid, self.garment);
        let mut group = unsprung(garment, self.particles());
        group.faces = self.faces();
        let lines = grid.lines.len();
        for line in 0..lines {
            let [before, after] = grid.beside(line);
            for row in 0..=grid.rows {
                if after != line && row > 0 {
                    let high =
                        self.span([line, row.saturating_sub(1)], [line, usize::min(row + 1, grid.rows)]);
                    self.join(&mut group, [[line, row], [after, row]], garment.stretching * 0.5 * high);
                }
                if row < grid.rows {
                    let wide = self.span([before, row], [after, row]);
                    self.join(&mut group, [[line, row], [line, row + 1]], garment.stretching * 0.5 * wide);
                }
            }
        }
        if garment.shearing > 0.0 {
            self.brace(&mut group);
        }
        if garment.bending > 0.0 {
            self.stiffen(&mut group);
        }
        group.tethers = (0..lines).flat_map(|line| self.tethers(line)).collect();
        group
    }

    fn place(&self, [line, row]: [usize; 2]) -> Vec3 {
        self.places[self.grid.particle(line, row)]
    }

    fn span(&self, from: [usize; 2], to: [usize; 2]) -> f32 {
        (self.place(to) - self.place(from)).length()
    }

    /// Returns particles, each with a quarter of the mass of each adjacent cell.
    fn particles(&self) -> Vec<ParticleDef> {
        let grid = self.grid;
        let mut areas = vec![0.0; self.places.len()];
        for line in 0..grid.lines.len() {
            let after = grid.beside(line)[1];
            for row in (0..grid.rows).filter(|_| after != line) {
                let corners = [[line, row], [after, row], [after, row + 1], [line, row + 1]];
                let [a, b, c, d] = corners.map(|at| self.place(at));
                let area = 0.5 * (c - a).cross(d - b).length();
                corners.iter().for_each(|&[line, row]| areas[grid.particle(line, row)] += 0.25 * area);
            }
        }
        particles(self.garment, self.places, &areas)
    }

    /// Returns two triangles per cell.
    fn faces(&self) -> Vec<[u32; 3]> {
        let grid = self.grid;
        let cells = (0..grid.lines.len()).flat_map(|line| (0..grid.rows).map(move |row| (line, row)));
        let cells = cells.filter(|&(line, _)| grid.beside(line)[1] != line);
        let split = |(line, row)| {
            let after = grid.beside(line)[1];
            let [a, b, c, d] = [[line, row], [after, row], [after, row + 1], [line, row + 1]]
                .map(|[line, row]| grid.particle(line, row) as u32);
            [[a, b, c], [a, c, d]]
        };
        cells.flat_map(split).collect()
    }

    /// Adds a spring with the stiffness `strip` (N) divided by its length.
    fn join(&self, group: &mut GroupDef, ends: [[usize; 2]; 2], strip: f32) {
        let length = self.span(ends[0], ends[1]);
        let stiffness = strip / max(length, SHORTEST_THREAD * self.garment.spacing);
        if stiffness > 0.0 {
            let [a, b] = ends.map(|[line, row]| self.grid.particle(line, row));
            let mass =
                |at: usize, row: usize| if row == 0 { f32::INFINITY } else { group.particles[at].mass };
            let masses = [mass(a, ends[0][1]), mass(b, ends[1][1])];
            let spring = SpringDef::new([a as u32, b as u32], length, stiffness);
            group.springs.push(spring.damped(self.garment.damping_ratio, masses));
        }
    }

    /// Adds springs along both diagonals of each cell.
    fn brace(&self, group: &mut GroupDef) {
        for line in 0..self.grid.lines.len() {
            let after = self.grid.beside(line)[1];
            for row in (0..self.grid.rows).filter(|_| after != line) {
                for ends in [[[line, row], [after, row + 1]], [[after, row], [line, row + 1]]] {
                    let strip = 0.5 * self.garment.shearing * self.span(ends[0], ends[1]);
                    self.join(group, ends, strip);
                }
            }
        }
    }

    /// Adds bends along every line, and across every row.
    fn stiffen(&self, group: &mut GroupDef) {
        let (grid, bending) = (self.grid, self.garment.bending);
        let particle = |line, row| grid.particle(line, row) as u32;
        for line in 0..grid.lines.len() {
            let [before, after] = grid.beside(line);
            let down: Vec<u32> = (0..=grid.rows).map(|row| particle(line, row)).collect();
            let middle = grid.rows / 2;
            group.stiffen(&down, bending * 0.5 * self.span([before, middle], [after, middle]));
            for row in (0..=grid.rows).filter(|_| before != line && after != line && before != after) {
                let high =
                    0.5 * self.span([line, row.saturating_sub(1)], [line, usize::min(row + 1, grid.rows)]);
                let across = [before, line, after].map(|line| particle(line, row));
                group.stiffen(&across, bending * high);
            }
        }
        // Coincident particles determine no bend.
        group.bends.retain(|bend| bend.stiffness > 0.0 && bend.stiffness.is_finite());
    }

    /// Returns tethers of a line's particles to its seam, with the distance along the line as length.
    fn tethers(&self, line: usize) -> impl Iterator<Item = TetherDef> {
        let mut length = 0.0;
        let tether = move |row: usize| {
            length += self.span([line, row - 1], [line, row]);
            let [particle, to] = [row, 0].map(|row| self.grid.particle(line, row) as u32);
            TetherDef { particle, to, length }
        };
        (1..=self.grid.rows).map(tether).filter(|tether| tether.length > 0.0)
    }
}
