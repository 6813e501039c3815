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
    /// Position, world, metres.
    pub position: Vec3,
    /// Velocity, m/s.
    pub velocity: Vec3,
    /// Mass, kg, positive. To hold a particle in place, attach it.
    pub mass: f32,
    /// Radius, metres, ≥ 0: distance kept from shapes.
    pub radius: f32,
}

/// Deformations resisted by a spring: stretch only, or compression as well.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Resists {
    /// The spring pulls when it is longer than at rest, and pushes when it is shorter. Default.
    #[default]
    Both,
    /// The spring only pulls; when it is shorter than at rest it is slack, like a string.
    Stretch,
}

/// Definition of a spring. Force on A toward B: `stiffness × (length − rest_length) + damping × lengthening speed`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SpringDef {
    /// Index of the first particle in its group.
    pub a: u32,
    /// Index of the second particle in its group.
    pub b: u32,
    /// Length without force, metres, ≥ 0.
    pub rest_length: f32,
    /// Stiffness, N/m, positive.
    pub stiffness: f32,
    /// Damping, N·s/m, ≥ 0. Default 0; see [`damped`](Self::damped).
    pub damping: f32,
    /// Deformations that the spring resists. Default both.
    pub resists: Resists,
}

impl SpringDef {
    /// Creates a spring without damping.
    pub fn new([a, b]: [u32; 2], rest_length: f32, stiffness: f32) -> Self {
        Self { a, b, rest_length, stiffness, damping: 0.0, resists: Resists::Both }
    }

    /// Sets the damping to `ratio` (≥ 0) times the critical damping of two particles of these masses (kg, infinite for
    /// an attached one) on this spring alone: `2 ratio √(k m)` with `m = m₁ m₂ / (m₁ + m₂)`. At 1 they settle without
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

/// A bend keeps three consecutive particles straight, or at their initial curvature. With the length `c` of
/// `x₁ − 2 x₂ + x₃`, it applies the force `stiffness × (c − rest)` along that vector to the outer two, and twice the
/// opposite force to the middle one. A beam of bending stiffness `B` (N·m²) with a particle every `L` metres has a
/// stiffness of `B/L³`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BendDef {
    /// Indices of the particles in their group, in order along the bend.
    pub particles: [u32; 3],
    /// Length `|x₁ − 2 x₂ + x₃|` without force, metres, ≥ 0; 0 is straight.
    pub rest: f32,
    /// Stiffness, N/m, positive.
    pub stiffness: f32,
}

/// A tether limits a particle's distance from an attached one: long-range attachment (Kim, Chentanez and Müller 2012).
/// Tethers never push.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TetherDef {
    /// Index of the particle in its group.
    pub particle: u32,
    /// Index of the attached particle.
    pub to: u32,
    /// Largest distance, metres, positive.
    pub length: f32,
}

/// Air or water in a closed surface of triangles.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct VolumeDef {
    /// Particles of each triangle, counterclockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Volume without pressure, m³, positive.
    pub rest_volume: f32,
    /// Bulk modulus, Pa, positive; `1.4 p` for an adiabatic gas at pressure `p`.
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
        /// Body that the particle is attached to.
        body: BodyId,
        /// Point in the body's frame, metres.
        point: Vec3,
    },
}

/// Attachment of a particle to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AttachmentDef {
    /// Index of the particle in its group.
    pub particle: u32,
    /// Point that the particle is attached to.
    pub target: AttachmentTarget,
}

impl AttachmentDef {
    /// Attaches a particle to a point of the world, metres.
    pub fn to_world(particle: u32, point: Vec3) -> Self {
        Self { particle, target: AttachmentTarget::World(point) }
    }

    /// Attaches a particle to a point of a body, in the body's frame, metres.
    pub fn to_body(particle: u32, body: BodyId, point: Vec3) -> Self {
        Self { particle, target: AttachmentTarget::Body { body, point } }
    }
}

/// A backstop: a ball fixed to a body that only one particle collides with. It limits how deep cloth sinks into the
/// drawn body, also where the body has no shape. The particle pushes the body back like a shape, but a backstop
/// transmits nothing to the floor, and has neither friction nor bounce.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BackstopDef {
    /// Index of the particle in its group; the particle keeps its radius as distance from the ball.
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
    /// Particles; springs and attachments refer to them by index.
    pub particles: Vec<ParticleDef>,
    /// Springs. The scheme decides how they are solved, see [`particles`](crate::particles).
    pub springs: Vec<SpringDef>,
    /// Bends, which resist bending; projected after the springs.
    pub bends: Vec<BendDef>,
    /// Tethers, which limit the distance of particles from attached ones; projected before the springs.
    pub tethers: Vec<TetherDef>,
    /// Volumes that particles enclose; projected last.
    pub volumes: Vec<VolumeDef>,
    /// Faces of a sheet, each with three of its particles in any order, and at most once: [`Wind`](crate::Wind) acts on
    /// the faces from either side, instead of on balls. Leave them empty for a closed volume: the wind would also press
    /// on its lee side. Default none.
    pub faces: Vec<[u32; 3]>,
    /// Attachments of particles; at most one per particle.
    pub attachments: Vec<AttachmentDef>,
    /// Balls behind single particles, at most one per particle, none for an attached one. They act regardless of the
    /// filter and of `passes`. Default none.
    pub backstops: Vec<BackstopDef>,
    /// Scheme by which springs are solved. Default implicit.
    pub scheme: SpringScheme,
    /// Number of iterations of a world substep, 1 to 64: projection is stiffer and loses less energy with more
    /// iterations. Default 1.
    pub iterations: u32,
    /// Material of the particles; `rolling` is ignored.
    pub material: Material,
    /// Share of the velocity lost per second, 1/s, ≥ 0. Default 0.
    pub linear_damping: f32,
    /// Factor on the world's gravity, finite. Default 1.
    pub gravity_scale: f32,
    /// Thickness for self-collision, metres, ≥ 0: particles without a common spring keep this distance, with the
    /// friction of the material. Default 0: off.
    ///
    /// Use 1.4 times the grid spacing. Below 0.8 a sheet passes through itself; above 2 the thickness pushes it apart.
    /// Six layers on the ground carry a body of 30 times the mass of the particles under it, dropped from 10 cm (0.4 kg
    /// on scene `folded`); a body of 1 kg slides off and squeezes through in places. Particles that move by the
    /// thickness within a substep pass through. Bodies on a slope creep down on the sheet.
    pub thickness: f32,
    /// Collision filter of the group.
    pub filter: Filter,
    /// Bodies that the group never collides with: arms that swing past the wearer's skirt. Default none.
    pub passes: Vec<BodyId>,
    /// Permission for the group to fall asleep with its island. Default on.
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
