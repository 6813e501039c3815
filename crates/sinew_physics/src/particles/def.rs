//! Definitions: plain data that particle groups are made from.

use crate::id::BodyId;
use crate::shape::{Filter, Material};
use sinew_math::Vec3;

/// A particle to be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParticleDef {
    /// World, metres.
    pub position: Vec3,
    /// m/s.
    pub velocity: Vec3,
    /// kg, positive. To hold a particle in place, attach it.
    pub mass: f32,
    /// Metres, ≥ 0: it keeps this far from shapes.
    pub radius: f32,
}

/// A spring to be made. Force on A toward B: `stiffness × (length − rest_length) + damping × speed of lengthening`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringDef {
    /// Index of the first particle in its group.
    pub a: u32,
    /// Index of the second one.
    pub b: u32,
    /// Length without force, metres, ≥ 0.
    pub rest_length: f32,
    /// N/m, positive.
    pub stiffness: f32,
    /// N·s/m, ≥ 0.
    pub damping: f32,
}

/// What a particle hangs on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AttachmentTarget {
    /// A place in the world, metres.
    World(Vec3),
    /// A point of a body.
    Body {
        /// The body.
        body: BodyId,
        /// In the body's frame, metres.
        point: Vec3,
    },
}

/// A particle held at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttachmentDef {
    /// Index of the particle in its group.
    pub particle: u32,
    /// Where it is held.
    pub target: AttachmentTarget,
}

/// Particles and springs that are made, moved and put to sleep together: rope, strand, cloth, blob.
#[derive(Clone, Debug, PartialEq)]
pub struct GroupDef {
    /// The particles; springs and attachments name them by index.
    pub particles: Vec<ParticleDef>,
    /// The springs. Those that form no loops are solved exactly, see [`particles`](crate::particles).
    pub springs: Vec<SpringDef>,
    /// Held particles; each at most once.
    pub attachments: Vec<AttachmentDef>,
    /// Surface of the particles; `rolling` does not matter.
    pub material: Material,
    /// 1/s: share of velocity lost per second. Default 0.
    pub linear_damping: f32,
    /// Factor on the world's gravity. Default 1.
    pub gravity_scale: f32,
    /// Which shapes it meets.
    pub filter: Filter,
}

impl Default for GroupDef {
    fn default() -> Self {
        Self {
            particles: Vec::new(),
            springs: Vec::new(),
            attachments: Vec::new(),
            material: Material::default(),
            linear_damping: 0.0,
            gravity_scale: 1.0,
            filter: Filter::default(),
        }
    }
}

/// A rope to be made with [`GroupDef::rope`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RopeDef {
    /// First particle, world, metres.
    pub from: Vec3,
    /// Last particle.
    pub to: Vec3,
    /// Number of springs, at least 1.
    pub links: u32,
    /// kg, of the whole rope.
    pub mass: f32,
    /// N/m, of the whole rope: `force / stretch` between its ends.
    pub stiffness: f32,
    /// Metres.
    pub radius: f32,
}

impl GroupDef {
    /// A straight rope at its rest length. Its end particles have half the mass of the others. Each spring is damped
    /// at a tenth of its critical damping.
    ///
    /// # Panics
    /// If `links` is 0.
    pub fn rope(rope: &RopeDef) -> Self {
        assert!(rope.links > 0, "a rope has at least one link");
        let links = rope.links as f32;
        let (link_mass, stiffness) = (rope.mass / links, rope.stiffness * links);
        let particle = |k: u32| ParticleDef {
            position: rope.from + (rope.to - rope.from) * (k as f32 / links),
            velocity: Vec3::ZERO,
            mass: if k == 0 || k == rope.links { 0.5 * link_mass } else { link_mass },
            radius: rope.radius,
        };
        let spring = |k: u32| SpringDef {
            a: k,
            b: k + 1,
            rest_length: (rope.to - rope.from).length() / links,
            stiffness,
            damping: 0.2 * (stiffness * link_mass).sqrt(),
        };
        Self {
            particles: (0..=rope.links).map(particle).collect(),
            springs: (0..rope.links).map(spring).collect(),
            ..Self::default()
        }
    }

    /// Whether its numbers make sense; the phrase says what is wrong.
    ///
    /// # Errors
    /// What is wrong, in lower case.
    pub fn check(&self) -> Result<(), &'static str> {
        // Written so that NaN fails.
        let positive = |x: f32| x > 0.0 && x < f32::INFINITY;
        let not_negative = |x: f32| (0.0..f32::INFINITY).contains(&x);
        let count = self.particles.len();
        let known = |index: u32| (index as usize) < count;
        for p in &self.particles {
            if !(p.position.is_finite() && p.velocity.is_finite()) {
                return Err("a particle's position and velocity must be finite");
            }
            if !(positive(p.mass) && not_negative(p.radius)) {
                return Err("a particle's mass must be positive and its radius not negative");
            }
        }
        for s in &self.springs {
            if !(known(s.a) && known(s.b)) || s.a == s.b {
                return Err("a spring must join two different particles of its group");
            }
            if !(positive(s.stiffness) && not_negative(s.rest_length) && not_negative(s.damping)) {
                return Err("a spring's stiffness must be positive, its length and damping not negative");
            }
        }
        self.material.check()?;
        let finite = |target| match target {
            AttachmentTarget::World(place) => place.is_finite(),
            AttachmentTarget::Body { point, .. } => point.is_finite(),
        };
        if !self.attachments.iter().all(|a| finite(a.target)) {
            return Err("the point of an attachment must be finite");
        }
        let mut held = vec![false; count];
        for a in &self.attachments {
            if !known(a.particle) || core::mem::replace(&mut held[a.particle as usize], true) {
                return Err("an attachment must hold a particle of its group that no other one holds");
            }
        }
        if !(not_negative(self.linear_damping) && self.gravity_scale.is_finite()) {
            return Err("damping must not be negative, and the gravity scale finite");
        }
        Ok(())
    }
}
