//! Definitions of particle groups, as plain data.

use crate::body::def::Sleeping;
use crate::body::material::Material;
use crate::body::shape::Filter;
use crate::id::BodyId;
use sinew_math::Vec3;

/// Definition of a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ParticleDef {
    /// World, metres.
    pub position: Vec3,
    /// m/s.
    pub velocity: Vec3,
    /// kg, positive. To hold a particle in place, attach it.
    pub mass: f32,
    /// Metres, ≥ 0: distance kept from shapes.
    pub radius: f32,
}

/// Deformations resisted by a spring: stretch only, or compression as well.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Resists {
    /// Longer or shorter than at rest, it pulls or pushes. Default.
    #[default]
    Both,
    /// It pulls; shorter than at rest it is slack, like a string.
    Stretch,
}

/// Definition of a spring. Force on A toward B: `stiffness × (length − rest_length) + damping × lengthening speed`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SpringDef {
    /// Index of the first particle in its group.
    pub a: u32,
    /// Index of the second one.
    pub b: u32,
    /// Length without force, metres, ≥ 0.
    pub rest_length: f32,
    /// N/m, positive.
    pub stiffness: f32,
    /// N·s/m, ≥ 0. Default 0; see [`damped`](Self::damped).
    pub damping: f32,
    /// Deformations that it resists. Default both.
    pub resists: Resists,
}

impl SpringDef {
    /// Creates a spring without damping.
    pub fn new([a, b]: [u32; 2], rest_length: f32, stiffness: f32) -> Self {
        Self { a, b, rest_length, stiffness, damping: 0.0, resists: Resists::Both }
    }

    /// Damped at a share `ratio` (≥ 0) of the critical damping of two particles of these masses (kg, infinite for a
    /// held one) on this spring alone: `2 ratio √(k m)` with `m = m₁ m₂ / (m₁ + m₂)`. At 1 they settle without
    /// oscillation.
    ///
    /// # Panics
    /// If the ratio is negative or not finite, or a mass is not positive.
    pub fn damped(self, ratio: f32, masses: [f32; 2]) -> Self {
        assert!(
            (0.0..f32::INFINITY).contains(&ratio),
            "a damping ratio is finite and not negative, not {ratio}"
        );
        assert!(masses.iter().all(|m| *m > 0.0), "masses are positive, not {masses:?}");
        let inverse = 1.0 / masses[0] + 1.0 / masses[1];
        let damping = if inverse > 0.0 { 2.0 * ratio * (self.stiffness / inverse).sqrt() } else { 0.0 };
        Self { damping, ..self }
    }
}

/// A bend keeps three consecutive particles straight, or at their initial curvature: a force `stiffness × (c − rest)`
/// along `x₁ − 2 x₂ + x₃`, whose length is `c`, on the outer two, and twice its opposite on the middle one. A beam of
/// bending stiffness `B` (N·m²) with a particle every `L` metres has a stiffness of `B/L³`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BendDef {
    /// Indices of the particles in their group, the middle one in the middle.
    pub particles: [u32; 3],
    /// `|x₁ − 2 x₂ + x₃|` without force, metres, ≥ 0: 0 is straight.
    pub rest: f32,
    /// N/m, positive.
    pub stiffness: f32,
}

/// A tether limits a particle's distance from an attached one: long-range attachment (Kim, Chentanez and Müller 2012).
/// It never pushes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TetherDef {
    /// Index of the particle in its group.
    pub particle: u32,
    /// Index of the attached one.
    pub to: u32,
    /// Metres, positive.
    pub length: f32,
}

/// Air or water in a closed surface of triangles.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct VolumeDef {
    /// Particles of each triangle, counterclockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Volume without pressure, m³, positive.
    pub rest_volume: f32,
    /// Bulk modulus, Pa, positive: of an adiabatic gas at pressure `p`, `1.4 p`.
    pub bulk_modulus: f32,
}

/// Scheme by which the springs of a group are solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum SpringScheme {
    /// Solves all springs together in an implicit step: for ropes, strands, bridges, and nets with loads many times
    /// heavier than themselves. The cost is linear in springs for trees; with loops, it is springs times the net's
    /// width in particles. Default.
    #[default]
    Implicit,
    /// Projects the springs one after the other: for cloth and blobs, at a tenth of the cost. A body ten times heavier
    /// than the group sinks through it.
    Projected,
}

/// Point that a particle is attached to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum AttachmentTarget {
    /// A fixed point of the world, metres.
    World(Vec3),
    /// A point of a body.
    Body {
        /// The body.
        body: BodyId,
        /// Point in the body's frame, metres.
        point: Vec3,
    },
}

/// A particle held at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AttachmentDef {
    /// Index of the particle in its group.
    pub particle: u32,
    /// Point at which it is held.
    pub target: AttachmentTarget,
}

impl AttachmentDef {
    /// Holds a particle at a point of the world, metres.
    pub fn to_world(particle: u32, point: Vec3) -> Self {
        Self { particle, target: AttachmentTarget::World(point) }
    }

    /// Holds a particle at a point of a body, in the body's space, metres.
    pub fn to_body(particle: u32, body: BodyId, point: Vec3) -> Self {
        Self { particle, target: AttachmentTarget::Body { body, point } }
    }
}

/// A backstop: a ball fixed to a body that only one particle collides with. It limits how deep cloth sinks into the
/// drawn body, also where no shape of a body is. It pushes the body back like a shape, but transmits nothing to the
/// floor, and has neither friction nor bounce.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BackstopDef {
    /// Index of the particle in its group, which keeps its radius from the ball.
    pub particle: u32,
    /// Body that the ball is fixed to.
    pub body: BodyId,
    /// Centre of the ball in the body's frame, metres.
    pub center: Vec3,
    /// Radius of the ball, metres, positive.
    pub radius: f32,
}

/// Particles and springs that are created, moved and put to sleep together: rope, strand, cloth, blob.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct GroupDef {
    /// The particles; springs and attachments name them by index.
    pub particles: Vec<ParticleDef>,
    /// The springs. The scheme decides how they are solved, see [`particles`](crate::particles).
    pub springs: Vec<SpringDef>,
    /// Bends, which resist bending; projected after the springs.
    pub bends: Vec<BendDef>,
    /// Tethers, which limit how far particles may go from attached ones; projected before the springs.
    pub tethers: Vec<TetherDef>,
    /// Volumes that particles enclose; projected last.
    pub volumes: Vec<VolumeDef>,
    /// Faces of a sheet, each with three of its particles in any order, and at most once: [`Wind`](crate::Wind) acts on
    /// them from either side, instead of on balls. Leave them empty for a closed volume: its lee side would be pressed
    /// on as well. Default none.
    pub faces: Vec<[u32; 3]>,
    /// Held particles; each at most once.
    pub attachments: Vec<AttachmentDef>,
    /// Balls behind single particles, at most one per particle, none for a held one. They act whatever the filter and
    /// `passes` say. Default none.
    pub backstops: Vec<BackstopDef>,
    /// Scheme by which springs are solved. Default implicit.
    pub scheme: SpringScheme,
    /// Number of parts of a world substep, 1 to 64: projection is stiffer and loses less energy with more parts.
    /// Default 1.
    pub iterations: u32,
    /// Surface of the particles; `rolling` is ignored.
    pub material: Material,
    /// Drag in proportion to velocity, 1/s, ≥ 0: share of it lost per second. Default 0.
    pub linear_damping: f32,
    /// Factor on the world's gravity, finite. Default 1.
    pub gravity_scale: f32,
    /// Thickness for self-collision, metres, ≥ 0: particles without a common spring keep this distance, with the
    /// friction of the material. Default 0: off.
    ///
    /// 1.4 times the grid spacing is good; less than 0.8 lets a sheet pass through itself, more than twice pushes it
    /// apart. Six layers on the ground carry a body of 30 times the mass of the particles under it, dropped from 10 cm
    /// (0.4 kg on scene `folded`); 1 kg slides off and squeezes through in places. Particles that move by the thickness
    /// within a substep pass. Bodies on a slope creep down on it.
    pub thickness: f32,
    /// Collision filter.
    pub filter: Filter,
    /// Bodies that it never collides with: arms that swing past the wearer's skirt. Default none.
    pub passes: Vec<BodyId>,
    /// Permission to fall asleep with its island. Default on.
    pub sleeping: Sleeping,
}

impl Default for GroupDef {
    fn default() -> Self {
        Self {
            particles: Vec::new(),
            springs: Vec::new(),
            bends: Vec::new(),
            tethers: Vec::new(),
            volumes: Vec::new(),
            faces: Vec::new(),
            attachments: Vec::new(),
            backstops: Vec::new(),
            scheme: SpringScheme::Implicit,
            iterations: 1,
            material: Material::default(),
            linear_damping: 0.0,
            gravity_scale: 1.0,
            thickness: 0.0,
            filter: Filter::default(),
            passes: Vec::new(),
            sleeping: Sleeping::On,
        }
    }
}
