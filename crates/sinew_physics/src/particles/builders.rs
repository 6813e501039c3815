//! Ropes, strands, cloth and blobs: definitions that create groups, with the indices of their particles.

use super::{
    AttachmentDef, AttachmentTarget, BendDef, GroupDef, ParticleDef, SpringDef, SpringScheme, TetherDef,
    VolumeDef,
};
use crate::particles::tuning::ROPE_DAMPING;
use sinew_math::Vec3;

impl GroupDef {
    /// Attaches a particle to a point of the world or of a body.
    ///
    /// # Panics
    /// If the particle does not exist.
    pub fn hold(&mut self, particle: u32, target: AttachmentTarget) {
        assert!(
            (particle as usize) < self.particles.len(),
            "the particle is there, not {particle} of {}",
            self.particles.len()
        );
        self.attachments.push(AttachmentDef { particle, target });
    }

    /// Attaches particles to the world at their positions.
    ///
    /// # Panics
    /// If the particle does not exist.
    pub fn hold_in_world(&mut self, particles: &[u32]) {
        for &particle in particles {
            let place = self.particles[particle as usize].position;
            self.hold(particle, AttachmentTarget::World(place));
        }
    }

    /// Makes each inner particle of a row resist bending from its current shape, as a beam of bending stiffness
    /// `bending` (N·m²) does: the stiffness is `bending / L³`, with the mean length `L` of its two sides.
    ///
    /// # Panics
    /// If a particle does not exist.
    pub fn stiffen(&mut self, row: &[u32], bending: f32) {
        for three in row.windows(3) {
            let [a, b, c] = [0, 1, 2].map(|k| self.particles[three[k] as usize].position);
            let side = 0.5 * ((b - a).length() + (c - b).length());
            self.bends.push(BendDef {
                particles: [three[0], three[1], three[2]],
                rest: (a - b * 2.0 + c).length(),
                stiffness: bending / (side * side * side),
            });
        }
    }

    /// Damps every spring at `ratio` times the critical damping of its two particles alone, see [`SpringDef::damped`];
    /// currently attached particles count as infinitely heavy.
    ///
    /// # Panics
    /// If the ratio is negative or not finite.
    pub fn damp(&mut self, ratio: f32) {
        let mut masses: Vec<f32> = self.particles.iter().map(|p| p.mass).collect();
        for a in &self.attachments {
            masses[a.particle as usize] = f32::INFINITY;
        }
        for s in &mut self.springs {
            *s = s.damped(ratio, [masses[s.a as usize], masses[s.b as usize]]);
        }
    }

    /// Tethers every free particle to the nearest attached one at their current distance, which is the path length in
    /// flat cloth or straight hair. Does nothing if no particle is attached.
    pub fn tether(&mut self) {
        let place = |i: u32| self.particles[i as usize].position;
        let held: Vec<u32> = self.attachments.iter().map(|a| a.particle).collect();
        for particle in (0..self.particles.len() as u32).filter(|i| !held.contains(i)) {
            let mut nearest: Option<TetherDef> = None;
            for &to in &held {
                let length = (place(to) - place(particle)).length();
                if nearest.is_none_or(|tether| length < tether.length) {
                    nearest = Some(TetherDef { particle, to, length });
                }
            }
            self.tethers.extend(nearest.filter(|tether| tether.length > 0.0));
        }
    }
}

/// Number of parts of 0.1 m in a length in metres, limited to `least..=most`.
fn parts(length: f32, [least, most]: [u32; 2]) -> u32 {
    u32::clamp((10.0 * length).round() as u32, least, most)
}

/// Definition of a rope: a row of particles connected by springs that are solved exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RopeDef {
    /// Position of the first particle, world, metres.
    pub from: Vec3,
    /// Position of the last particle, world, metres.
    pub to: Vec3,
    /// Number of springs, at least 1.
    pub links: u32,
    /// Total mass, kg.
    pub mass: f32,
    /// Stiffness of the whole rope, N/m: `force / stretch` between its ends.
    pub stiffness: f32,
    /// Radius of each particle, metres.
    pub radius: f32,
}

/// A rope that is not yet in a world.
#[derive(Clone, Debug, PartialEq)]
pub struct Rope {
    /// Definition for [`World::add_particles`](crate::World::add_particles). Particles are in order, springs too.
    pub group: GroupDef,
    /// Index of the first particle.
    pub first: u32,
    /// Index of the last particle.
    pub last: u32,
}

impl RopeDef {
    /// Defines a rope of 10 mm nylon between two points (world, metres): 0.1 kg and 40 kN of stiffness per metre, a
    /// link every 0.1 m, at least 4 and at most 64 links.
    ///
    /// # Panics
    /// If the points are not finite, or the same.
    pub fn between(from: Vec3, to: Vec3) -> Self {
        let length = (to - from).length();
        assert!(length > 0.0 && length.is_finite(), "the ends of a rope are finite and apart");
        let links = parts(length, [4, 64]);
        Self { from, to, links, mass: 0.1 * length, stiffness: 40_000.0 / length, radius: 0.01 }
    }

    /// Creates a straight rope at its rest length. Its end particles have half the mass of the others. Each spring is
    /// damped at a tenth of its critical damping.
    ///
    /// # Panics
    /// If `links` is 0.
    pub fn build(&self) -> Rope {
        assert!(self.links > 0, "a rope has at least one link");
        let links = self.links as f32;
        let (link_mass, stiffness) = (self.mass / links, self.stiffness * links);
        let particle = |k: u32| ParticleDef {
            position: self.from + (self.to - self.from) * (k as f32 / links),
            velocity: Vec3::ZERO,
            mass: if k == 0 || k == self.links { 0.5 * link_mass } else { link_mass },
            radius: self.radius,
        };
        let rest_length = (self.to - self.from).length() / links;
        let spring = |k: u32| SpringDef {
            // Critical damping of two inner particles, whose effective mass is `m/2`.
            damping: 2.0 * ROPE_DAMPING * (0.5 * stiffness * link_mass).sqrt(),
            ..SpringDef::new([k, k + 1], rest_length, stiffness)
        };
        let group = GroupDef {
            particles: (0..=self.links).map(particle).collect(),
            springs: (0..self.links).map(spring).collect(),
            ..GroupDef::default()
        };
        Rope { group, first: 0, last: self.links }
    }
}

/// Definition of a strand of hair or grass: a rope that resists bending, clamped at its root.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StrandDef {
    /// Position of the root, and the parameters shared with a rope.
    pub rope: RopeDef,
    /// Bending stiffness `B` = elastic modulus times the section's second moment of area, N·m², positive. A straight
    /// strand that is clamped level sinks at its tip by `w L⁴ / 8B`, with its weight `w` per length.
    pub bending: f32,
}

impl StrandDef {
    /// Defines a strand along a rope, with a bending stiffness in N·m².
    pub fn new(rope: RopeDef, bending: f32) -> Self {
        Self { rope, bending }
    }

    /// Creates a straight strand. To clamp its root, hold its first **two** particles, [`Rope::first`] and the next
    /// one: they define its direction.
    ///
    /// # Panics
    /// If there are no links.
    pub fn build(&self) -> Rope {
        let mut strand = self.rope.build();
        let row: Vec<u32> = (strand.first..=strand.last).collect();
        strand.group.stiffen(&row, self.bending);
        strand
    }
}

/// Definition of a rectangle of cloth: a grid of particles with springs along both threads, along the diagonals, and
/// against bending.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ClothDef {
    /// Position of the first corner, world, metres.
    pub corner: Vec3,
    /// Offset from `corner` along the first row, metres.
    pub across: Vec3,
    /// Offset from `corner` along the first column, metres; perpendicular to `across`.
    pub down: Vec3,
    /// Number of springs in a row, at least 1.
    pub columns: u32,
    /// Number of springs in a column, at least 1.
    pub rows: u32,
    /// Total mass, kg.
    pub mass: f32,
    /// Stiffness of a square of cloth that is pulled along a thread, N/m: elastic modulus times thickness.
    pub stretching: f32,
    /// Shear stiffness of a square pulled along a diagonal, N/m, ≥ 0; with 0 there are no diagonal springs.
    pub shearing: f32,
    /// Bending stiffness per width, N·m, ≥ 0: `E t³/12` for a plate; with 0 the cloth does not resist bending.
    pub bending: f32,
    /// Damping of each spring as a share of its critical damping, ≥ 0.
    pub damping_ratio: f32,
    /// Radius of each particle, metres.
    pub radius: f32,
}

/// Cloth that is not yet in a world.
#[derive(Clone, Debug, PartialEq)]
pub struct Cloth {
    /// Definition for [`World::add_particles`](crate::World::add_particles); projected in two iterations per substep.
    pub group: GroupDef,
    /// Number of springs in a row.
    pub columns: u32,
    /// Number of springs in a column.
    pub rows: u32,
}

impl Cloth {
    /// Returns the index of a particle; columns and rows count from 0 to the number of springs.
    pub fn particle(&self, column: u32, row: u32) -> u32 {
        row * (self.columns + 1) + column
    }

    /// Returns the indices of the corners: the ends of the first row, then those of the last row.
    pub fn corners(&self) -> [u32; 4] {
        let (columns, rows) = (self.columns, self.rows);
        [(0, 0), (columns, 0), (0, rows), (columns, rows)].map(|(c, r)| self.particle(c, r))
    }

    /// Returns the indices of the particles in a row, in order.
    pub fn row(&self, row: u32) -> Vec<u32> {
        (0..=self.columns).map(|column| self.particle(column, row)).collect()
    }

    /// Returns the indices of the particles in a column, in order.
    pub fn column(&self, column: u32) -> Vec<u32> {
        (0..=self.rows).map(|row| self.particle(column, row)).collect()
    }

    /// Attaches particles to the world at their positions, and tethers all others to the nearest of them.
    ///
    /// # Panics
    /// If a particle does not exist.
    pub fn hang(&mut self, particles: &[u32]) {
        self.group.hold_in_world(particles);
        self.group.tethers.clear();
        self.group.tether();
    }
}

impl ClothDef {
    /// Defines a cotton sheet from a corner along two sides (world, metres; perpendicular): 0.2 kg/m², cells of 0.1 m,
    /// at least 4 and at most 32 along each side.
    ///
    /// # Panics
    /// If the corner or a side is not finite, or a side has no length.
    pub fn sheet(corner: Vec3, across: Vec3, down: Vec3) -> Self {
        let [width, height] = [across, down].map(Vec3::length);
        let is_whole = corner.is_finite() && width > 0.0 && height > 0.0 && (width * height).is_finite();
        assert!(is_whole, "the corner and the sides of a sheet are finite, and the sides have a length");
        Self {
            corner,
            across,
            down,
            columns: parts(width, [4, 32]),
            rows: parts(height, [4, 32]),
            mass: 0.2 * width * height,
            stretching: 1000.0,
            shearing: 100.0,
            bending: 1e-5,
            damping_ratio: 0.2,
            radius: 0.01,
        }
    }

    /// Creates flat cloth at its rest lengths. Particles at edges have half the mass of the others, at corners a
    /// quarter.
    ///
    /// # Panics
    /// If there are no columns or rows.
    pub fn build(&self) -> Cloth {
        assert!(
            self.columns > 0 && self.rows > 0,
            "cloth has columns and rows, not {} by {}",
            self.columns,
            self.rows
        );
        let (columns, rows) = (self.columns, self.rows);
        let mut cloth = Cloth { group: GroupDef::default(), columns, rows };
        let cell_mass = self.mass / (columns * rows) as f32;
        let share = |at: u32, last: u32| if at == 0 || at == last { 0.5 } else { 1.0 };
        for row in 0..=rows {
            for column in 0..=columns {
                let (u, v) = (column as f32 / columns as f32, row as f32 / rows as f32);
                cloth.group.particles.push(ParticleDef {
                    position: self.corner + self.across * u + self.down * v,
                    velocity: Vec3::ZERO,
                    mass: cell_mass * share(column, columns) * share(row, rows),
                    radius: self.radius,
                });
            }
        }
        let (wide, high) = (self.across.length() / columns as f32, self.down.length() / rows as f32);
        for row in 0..=rows {
            let stiffness = self.stretching * high * share(row, rows) / wide;
            join_row(&mut cloth, [1, 0], (0..columns).map(|column| [column, row]), wide, stiffness);
        }
        for row in 0..rows {
            for column in 0..=columns {
                let stiffness = self.stretching * wide * share(column, columns) / high;
                join_row(&mut cloth, [0, 1], [[column, row]], high, stiffness);
            }
        }
        for row in 0..rows {
            for column in 0..columns {
                let [a, b] = [row, row + 1].map(|row| cloth.particle(column, row));
                cloth.group.faces.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
            }
        }
        if self.shearing > 0.0 {
            self.brace(&mut cloth, (wide * wide + high * high).sqrt());
        }
        if self.bending > 0.0 {
            for row in 0..=rows {
                cloth.group.stiffen(&cloth.row(row), self.bending * high * share(row, rows));
            }
            for column in 0..=columns {
                cloth.group.stiffen(&cloth.column(column), self.bending * wide * share(column, columns));
            }
        }
        cloth.group.damp(self.damping_ratio);
        cloth.group.scheme = SpringScheme::Projected;
        cloth.group.iterations = 2;
        cloth
    }

    /// Adds springs along both diagonals of each cell.
    fn brace(&self, cloth: &mut Cloth, diagonal: f32) {
        for row in 0..self.rows {
            for column in 0..self.columns {
                for [from, to] in [[[0, 0], [1, 1]], [[1, 0], [0, 1]]] {
                    let ends = [from, to].map(|[c, r]| cloth.particle(column + c, row + r));
                    cloth.group.springs.push(SpringDef::new(ends, diagonal, 0.5 * self.shearing));
                }
            }
        }
    }
}

/// Adds springs from the given grid positions to their neighbours.
fn join_row(
    cloth: &mut Cloth,
    [right, below]: [u32; 2],
    places: impl IntoIterator<Item = [u32; 2]>,
    rest_length: f32,
    stiffness: f32,
) {
    for [column, row] in places {
        let ends = [cloth.particle(column, row), cloth.particle(column + right, row + below)];
        cloth.group.springs.push(SpringDef::new(ends, rest_length, stiffness));
    }
}

/// Definition of a ball with a skin filled with air.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BlobDef {
    /// Position of the centre, world, metres.
    pub center: Vec3,
    /// Radius of the skin, metres.
    pub radius: f32,
    /// Number of times that the faces of an icosahedron are split in four, 0 to 5: 12, 42, 162, 642, 2,562 or 10,242
    /// particles.
    pub subdivisions: u32,
    /// Total mass, kg.
    pub mass: f32,
    /// Stiffness of each spring of the skin, N/m.
    pub stiffness: f32,
    /// Damping of each spring as a share of its critical damping, ≥ 0.
    pub damping_ratio: f32,
    /// Bulk modulus of the content, Pa, see [`VolumeDef`].
    pub bulk_modulus: f32,
    /// Radius of each particle, metres: the contact thickness of the skin.
    pub skin: f32,
}

/// A blob that is not yet in a world.
#[derive(Clone, Debug, PartialEq)]
pub struct Blob {
    /// Definition for [`World::add_particles`](crate::World::add_particles); projected in four iterations per substep. All
    /// particles belong to the skin, and `volumes[0]` is the enclosed volume.
    pub group: GroupDef,
    /// Index of the highest particle (+Y).
    pub top: u32,
    /// Index of the lowest particle.
    pub bottom: u32,
}

impl BlobDef {
    /// Defines a soft ball of 162 particles around a centre (world, metres): 100 kg/m³, filled with compressible air.
    ///
    /// # Panics
    /// If the centre is not finite, or the radius is not positive and finite.
    pub fn ball(center: Vec3, radius: f32) -> Self {
        assert!(
            center.is_finite() && radius > 0.0 && radius.is_finite(),
            "a ball has a finite place and radius"
        );
        Self {
            center,
            radius,
            subdivisions: 2,
            mass: 100.0 * 4.0 / 3.0 * core::f32::consts::PI * radius * radius * radius,
            stiffness: 400.0,
            damping_ratio: 0.2,
            bulk_modulus: 2e4,
            skin: 0.05 * radius,
        }
    }

    /// Creates a geodesic ball at rest.
    ///
    /// # Panics
    /// If there are more than 5 subdivisions.
    pub fn build(&self) -> Blob {
        assert!(self.subdivisions <= 5, "a blob has at most five subdivisions, not {}", self.subdivisions);
        let (directions, triangles) = super::geodesic::sphere(self.subdivisions);
        let mass = self.mass / directions.len() as f32;
        let particle = |d: &Vec3| ParticleDef {
            position: self.center + *d * self.radius,
            velocity: Vec3::ZERO,
            mass,
            radius: self.skin,
        };
        let particles: Vec<ParticleDef> = directions.iter().map(particle).collect();
        let spring = |[a, b]: [u32; 2]| {
            let length = (particles[b as usize].position - particles[a as usize].position).length();
            SpringDef::new([a, b], length, self.stiffness).damped(self.damping_ratio, [mass, mass])
        };
        let springs = super::geodesic::edges(&triangles).into_iter().map(spring).collect();
        let positions: Vec<Vec3> = particles.iter().map(|p| p.position).collect();
        let rest_volume = super::net::enclosed_volume(&triangles, &positions, |_, _| ());
        let extreme = |sign: f32| {
            let mut best = 0;
            for (i, d) in directions.iter().enumerate() {
                if d.y * sign > directions[best].y * sign {
                    best = i;
                }
            }
            best as u32
        };
        let (top, bottom) = (extreme(1.0), extreme(-1.0));
        let volumes = vec![VolumeDef { triangles, rest_volume, bulk_modulus: self.bulk_modulus }];
        let scheme = SpringScheme::Projected;
        let group = GroupDef { particles, springs, volumes, scheme, iterations: 4, ..GroupDef::default() };
        Blob { group, top, bottom }
    }
}
