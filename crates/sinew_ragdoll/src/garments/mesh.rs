//! Sheets made from meshes: the connections of their particles, and the rotation of each particle's joint.

use super::sheet::{Sheet, particles, unsprung};
use crate::tuning::{SHORTEST_THREAD, SQUARE, STRAIGHT};
use sinew_anim::Garment;
use sinew_anim::garments::{MeshSheet, Ways};
use sinew_math::{Mat3, Rotation, Vec3, any_orthonormal, direction, max};
use sinew_physics::particles::{GroupDef, SpringDef, TetherDef};
use std::collections::BTreeMap;

/// Particle that is a joint.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Grain {
    pub node: usize,
    pub sheet: usize,
    pub particle: usize,
    /// Corners of the sheet's triangles at the particle, each triangle with the particle first.
    around: Vec<[u32; 3]>,
    /// Neighbour particles with their coefficients for the direction x, 1/m: `Σ coefficient (place − own)` points along
    /// x at rest.
    beside: Vec<(u32, f32)>,
    /// Rotation of the bone in the frame of the sheet at the particle, at rest.
    pub frame_from_bone: Rotation,
    /// Vector from the drawn position at rest to the simulated position, in the sheet's frame, metres.
    moved_out: Vec3,
}

/// Surroundings of all particles of a sheet.
pub(super) struct Around {
    places: Vec<Vec3>,
    /// Triangles at each particle.
    faces: Vec<Vec<[u32; 3]>>,
    /// Neighbours of each particle.
    beside: Vec<Vec<u32>>,
}

impl Around {
    /// Finds the triangles and neighbours of each particle in a sheet of a mesh.
    pub fn new(sheet: &Sheet, mesh: &MeshSheet) -> Self {
        let places: Vec<Vec3> = sheet.group.particles.iter().map(|particle| particle.position).collect();
        let (mut faces, mut beside) = (vec![Vec::new(); places.len()], vec![Vec::new(); places.len()]);
        for &[a, b, c] in &mesh.faces {
            for face in [[a, b, c], [b, c, a], [c, a, b]] {
                faces[face[0] as usize].push(face);
            }
        }
        for &[a, b] in &mesh.links {
            beside[a as usize].push(b);
            beside[b as usize].push(a);
        }
        Self { places, faces, beside }
    }
}

impl Grain {
    /// Creates the particle whose joint has this rotation in the bind pose.
    pub fn new(
        node: usize,
        number: usize,
        sheet: &Sheet,
        around: &Around,
        particle: usize,
        bone: Rotation,
    ) -> Self {
        let places = around.places.as_slice();
        let mut grain = Self {
            node,
            sheet: number,
            particle,
            around: around.faces[particle].clone(),
            beside: Vec::new(),
            frame_from_bone: Rotation::IDENTITY,
            moved_out: sheet.moved_out[particle],
        };
        let normal = grain.normal(places).unwrap_or(Vec3::Z);
        let x = any_orthonormal(normal);
        for &other in &around.beside[particle] {
            let way = places[other as usize] - places[particle];
            if way.length_squared() > 0.0 {
                grain.beside.push((other, way.dot(x) / way.length_squared()));
            }
        }
        if let Some(frame) = grain.frame(places) {
            let back = frame.inverse();
            grain.frame_from_bone = back * bone;
            grain.moved_out = back * grain.moved_out;
        } else {
            // If the particle has no frame at rest, its joint moves but does not rotate.
            grain.around.clear();
            grain.moved_out = Vec3::ZERO;
        }
        grain
    }

    fn normal(&self, places: &[Vec3]) -> Option<Vec3> {
        let area = |[a, b, c]: [u32; 3]| {
            let [a, b, c] = [a, b, c].map(|at| places[at as usize]);
            (b - a).cross(c - a)
        };
        direction(self.around.iter().map(|&face| area(face)).sum())
    }

    /// Returns the rotation of the sheet at the particle: z along the normal, x along the direction to the neighbours
    /// as at rest. `None` where the sheet has no area.
    fn frame(&self, places: &[Vec3]) -> Option<Rotation> {
        let z = self.normal(places)?;
        let own = places[self.particle];
        let along: Vec3 =
            self.beside.iter().map(|&(other, share)| (places[other as usize] - own) * share).sum();
        let x = direction(along - z * along.dot(z)).unwrap_or_else(|| any_orthonormal(z));
        Some(Rotation::from_mat3(&Mat3::from_cols(x, z.cross(x), z)))
    }

    /// Returns the position where the particle is drawn, and the rotation of the sheet there, for particles at
    /// `places`.
    pub fn drawn(&self, places: &[Vec3]) -> (Vec3, Option<Rotation>) {
        let frame = self.frame(places);
        let out = frame.map_or(Vec3::ZERO, |frame| frame * self.moved_out);
        (places[self.particle] - out, frame)
    }
}

/// Returns the particle group of a mesh's sheet with its springs, bends and tethers, and each particle's strand: the
/// held particle from which it hangs.
pub(super) fn weave(garment: &Garment, mesh: &MeshSheet, places: &[Vec3]) -> (GroupDef, Vec<usize>) {
    let weave = Weave { garment, mesh, places };
    let mut group = unsprung(garment, particles(garment, places, &mesh.areas));
    group.faces.clone_from(&mesh.faces);
    weave.join_all(&mut group);
    weave.stiffen(&mut group, &mesh.areas);
    let strand = weave.tether(&mut group);
    (group, strand)
}

struct Weave<'a> {
    garment: &'a Garment,
    mesh: &'a MeshSheet,
    places: &'a [Vec3],
}

impl Weave<'_> {
    fn way(&self, [a, b]: [u32; 2]) -> Vec3 {
        self.places[b as usize] - self.places[a as usize]
    }

    fn area(&self, &[a, b, c]: &[u32; 3]) -> f32 {
        0.5 * self.way([a, b]).cross(self.way([a, c])).length()
    }

    /// Returns true if two sides meet at nearly a right angle, or a larger one.
    fn is_square(&self, at: u32, ends: [u32; 2]) -> bool {
        let [a, b] = ends.map(|end| direction(self.way([at, end])).unwrap_or(Vec3::ZERO));
        a.dot(b) < SQUARE
    }

    /// Adds springs along edges, each with the stiffness of the adjacent triangles in its direction (Van Gelder,
    /// "Approximate Simulation of Elastic Membranes", 1998), and weaker springs across the edges from corner to corner.
    /// In a cell between threads both diagonals are equally weak, and no spring crosses the threads of such cells.
    fn join_all(&self, group: &mut GroupDef) {
        let mut beside: BTreeMap<[u32; 2], Vec<usize>> =
            self.mesh.links.iter().map(|&link| (link, Vec::new())).collect();
        for (index, &[a, b, c]) in self.mesh.faces.iter().enumerate() {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                beside.entry([u32::min(from, to), u32::max(from, to)]).or_default().push(index);
            }
        }
        let tip = |edge: [u32; 2], face: usize| {
            let corners = self.mesh.faces[face];
            corners.into_iter().find(|corner| !edge.contains(corner)).unwrap_or(corners[0])
        };
        let is_diagonal = |edge: [u32; 2], faces: &[usize]| {
            faces.len() == 2 && faces.iter().all(|&face| self.is_square(tip(edge, face), edge))
        };
        let mut in_cell = vec![false; self.mesh.faces.len()];
        for (&edge, faces) in beside.iter().filter(|(edge, faces)| is_diagonal(**edge, faces)) {
            debug_assert!(edge[0] < edge[1], "the smaller index of an edge must come first");
            faces.iter().for_each(|&face| in_cell[face] = true);
        }
        let shear = 0.5 * self.garment.shearing;
        for (&edge, faces) in &beside {
            let length = max(self.way(edge).length(), SHORTEST_THREAD * self.garment.spacing);
            let area: f32 = faces.iter().map(|&face| self.area(&self.mesh.faces[face])).sum();
            let diagonal = is_diagonal(edge, faces);
            self.join(
                group,
                edge,
                match faces.as_slice() {
                    _ if diagonal => shear,
                    // An edge that belongs to no triangle is also a thread.
                    [] => self.garment.stretching,
                    _ => self.garment.stretching * area / (length * length),
                },
            );
            if let [left, right] = *faces.as_slice() {
                let pair = [tip(edge, left), tip(edge, right)];
                let pair = [u32::min(pair[0], pair[1]), u32::max(pair[0], pair[1])];
                let is_loose = diagonal || !in_cell[left] && !in_cell[right];
                if is_loose && pair[0] != pair[1] && !beside.contains_key(&pair) {
                    self.join(group, pair, shear);
                }
            }
        }
    }

    fn join(&self, group: &mut GroupDef, ends: [u32; 2], stiffness: f32) {
        // Held particles do not move relative to each other.
        let is_free = ends.iter().any(|&end| !self.mesh.held[end as usize]);
        if is_free && stiffness > 0.0 && stiffness.is_finite() {
            let mass = |at: u32| {
                let held = self.mesh.held[at as usize];
                if held { f32::INFINITY } else { group.particles[at as usize].mass }
            };
            let spring = SpringDef::new(ends, self.way(ends).length(), stiffness);
            group.springs.push(spring.damped(self.garment.damping_ratio, ends.map(mass)));
        }
    }

    /// Adds bends through each particle, between neighbours on its opposite sides.
    fn stiffen(&self, group: &mut GroupDef, areas: &[f32]) {
        if self.garment.bending <= 0.0 {
            return;
        }
        let mut beside: Vec<Vec<u32>> = vec![Vec::new(); self.places.len()];
        for &[a, b] in &self.mesh.links {
            beside[a as usize].push(b);
            beside[b as usize].push(a);
        }
        for (middle, others) in (0..).zip(&beside) {
            let facing = |other: u32| direction(self.way([middle, other])).unwrap_or(Vec3::ZERO);
            let across = |from: u32| {
                let cosine = |&to: &u32| facing(from).dot(facing(to));
                let farther = |a: u32, b: u32| if cosine(&b) < cosine(&a) { b } else { a };
                others.iter().copied().reduce(farther).filter(|to| cosine(to) < STRAIGHT)
            };
            for &from in others {
                let Some(to) = across(from).filter(|&to| from < to && across(to) == Some(from)) else {
                    continue;
                };
                if [from, middle, to].iter().all(|&at| self.mesh.held[at as usize]) {
                    continue;
                }
                let side = 0.5 * (self.way([from, middle]).length() + self.way([middle, to]).length());
                group.stiffen(&[from, middle, to], self.garment.bending * areas[middle as usize] / side);
            }
        }
        group.bends.retain(|bend| bend.stiffness > 0.0 && bend.stiffness.is_finite());
    }

    /// Tethers each particle to the nearest held particle along the edges, with this distance as the tether's length;
    /// returns the held particle of each.
    fn tether(&self, group: &mut GroupDef) -> Vec<usize> {
        let (way, from) = ways_from_held(self.mesh, self.places);
        for particle in (0..way.len()).filter(|&particle| way[particle] > 0.0 && way[particle].is_finite()) {
            let [to, own] = [from[particle], particle].map(|at| at as u32);
            group.tethers.push(TetherDef { particle: own, to, length: way[particle] });
        }
        from
    }
}

/// Returns the distance along the edges from each particle to the nearest held one, metres, and the index of this held
/// particle; the particle itself if there is no path.
pub(super) fn ways_from_held(mesh: &MeshSheet, places: &[Vec3]) -> (Vec<f32>, Vec<usize>) {
    let count = places.len();
    let mut beside: Vec<Vec<(usize, f32)>> = vec![Vec::new(); count];
    for &link in &mesh.links {
        let [a, b] = link.map(|at| at as usize);
        let length = (places[b] - places[a]).length();
        beside[a].push((b, length));
        beside[b].push((a, length));
    }
    let mut ways = Ways::new(count);
    ways.add(&beside, (0..count).filter(|&particle| mesh.held[particle]));
    let from = (0..).zip(ways.from).map(|(own, from)| if from == usize::MAX { own } else { from });
    (ways.length, from.collect())
}
