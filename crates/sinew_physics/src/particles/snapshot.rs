//! Writes and reads particle groups.

use super::contact::Grip;
use super::{
    AddedMass, AttachmentDef, AttachmentTarget, BackstopDef, BendDef, GroupDef, ParticleDef, ParticleGroup,
    Resists, SpringDef, SpringScheme, TetherDef, VolumeDef,
};
use crate::body::snapshot::{load_filter, load_material, save_filter, save_material};
use crate::id::BodyId;
use sinew_math::{ReadError, Reader, Vec3, Writer};

/// Bytes of a particle: position, velocity, mass, radius, contact impulse, grip, position before the step.
const PARTICLE_BYTES: usize = 4 * (3 + 3 + 1 + 1 + 3 + 3) + 1;
const SPRING_BYTES: usize = 4 * 5 + 1;
const BEND_BYTES: usize = 4 * 5;
const TETHER_BYTES: usize = 4 * 3;
const BACKSTOP_BYTES: usize = 4 + 8 + 4 * 4;
/// Bytes of a volume without triangles.
const VOLUME_BYTES: usize = 4 * 3;
const TRIANGLE_BYTES: usize = 4 * 3;
/// Bytes of the shortest attachment.
const ATTACHMENT_BYTES: usize = 4 + 1 + 12;

impl ParticleGroup {
    /// Writes all data that the next substep depends on.
    pub fn save(&self, out: &mut Writer) {
        save_material(out, self.material);
        out.f32(self.linear_damping);
        out.f32(self.gravity_scale);
        save_filter(out, self.filter);
        let (projected, thickness) = (self.scheme == SpringScheme::Projected, self.thickness());
        let (passes, faces) = (!self.passes.is_empty(), !self.faces().is_empty());
        let has = u8::from(projected) | u8::from(thickness > 0.0) << 1;
        let backstops = !self.backstops.is_empty();
        out.u8(has | u8::from(passes) << 2 | u8::from(faces) << 3 | u8::from(backstops) << 4);
        if thickness > 0.0 {
            out.f32(thickness);
        }
        if passes {
            out.count(self.passes.len());
            self.passes.iter().for_each(|body| out.u64(body.to_bits()));
        }
        if faces {
            out.count(self.faces().len());
            self.faces().iter().flatten().for_each(|&i| out.u32(i));
        }
        if backstops {
            out.count(self.backstops.len());
            self.backstops.iter().for_each(|backstop| save_backstop(backstop, out));
        }
        out.u32(self.iterations);
        out.f32(self.span);
        out.count(self.positions.len());
        for i in 0..self.positions.len() {
            out.vec3(self.positions[i]);
            out.vec3(self.velocities[i]);
            out.f32(self.masses[i]);
            out.f32(self.radii[i]);
            out.vec3(self.contact_impulses[i]);
            out.u8(match self.grips[i] {
                Grip::Off => 0,
                // The next iteration starts with the last friction as a force.
                Grip::Slide | Grip::Slow => 1,
                // A wedged grip lasts for one iteration.
                Grip::Stick | Grip::Wedged => 2,
            });
            out.vec3(self.drawn_from[i]);
        }
        out.count(self.springs.len());
        for s in &self.springs {
            out.u32(s.a);
            out.u32(s.b);
            out.f32(s.rest_length);
            out.f32(s.stiffness);
            out.f32(s.damping);
            out.u8(u8::from(s.resists == Resists::Stretch));
        }
        self.save_net(out);
        out.count(self.attachments.len());
        self.attachments.iter().for_each(|a| self.save_attachment(a, out));
        self.save_rest(out);
    }

    /// Writes an attachment; the first attachment of each body includes the added mass.
    fn save_attachment(&self, a: &AttachmentDef, out: &mut Writer) {
        out.u32(a.particle);
        match a.target {
            AttachmentTarget::World(place) => {
                out.u8(0);
                out.vec3(place);
            }
            AttachmentTarget::Body { body, point } => {
                let added = self.added_by_first(a.particle).filter(AddedMass::is_some);
                out.u8(if added.is_some() { 2 } else { 1 });
                out.u64(body.to_bits());
                out.vec3(point);
                added.iter().for_each(|added| added.save(out));
            }
        }
    }

    /// Added mass of the body that a particle is attached to, if the particle is the first of that body.
    fn added_by_first(&self, particle: u32) -> Option<AddedMass> {
        let hub = self.forest.hub_of(particle as usize);
        self.forest.hubs().get(hub).filter(|held| held[0] == particle).map(|_| self.added[hub])
    }

    fn save_net(&self, out: &mut Writer) {
        out.count(self.bends.len());
        for b in &self.bends {
            b.particles.iter().for_each(|&i| out.u32(i));
            out.f32(b.rest);
            out.f32(b.stiffness);
        }
        out.count(self.tethers.len());
        for t in &self.tethers {
            out.u32(t.particle);
            out.u32(t.to);
            out.f32(t.length);
        }
        out.count(self.volumes.len());
        for v in &self.volumes {
            out.f32(v.rest_volume);
            out.f32(v.bulk_modulus);
            out.count(v.triangles.len());
            v.triangles.iter().flatten().for_each(|&i| out.u32(i));
        }
    }

    /// Reads the format of [`save`](Self::save). The caller checks that bodies of attachments and backstops exist.
    ///
    /// # Errors
    /// If the bytes end too early or [`GroupDef::check`] rejects them.
    pub fn load(input: &mut Reader<'_>) -> Result<Self, ReadError> {
        let material = load_material(input)?;
        let (linear_damping, gravity_scale) = (input.f32()?, input.f32()?);
        let filter = load_filter(input)?;
        let has = input.u8()?;
        if has > 0b1_1111 {
            return Err(input.error("a group has no such flags"));
        }
        let scheme = if has & 1 == 0 { SpringScheme::Implicit } else { SpringScheme::Projected };
        let thickness = if has & 0b10 == 0 { 0.0 } else { input.f32()? };
        let passes = if has & 0b100 == 0 { Vec::new() } else { read_bodies(input)? };
        let faces = if has & 0b1000 == 0 { Vec::new() } else { read_triangles(input)? };
        let backstops = if has & 0b1_0000 == 0 { Vec::new() } else { read_backstops(input)? };
        let (iterations, span) = (input.u32()?, input.f32()?);
        let mut def = GroupDef {
            material,
            linear_damping,
            gravity_scale,
            filter,
            scheme,
            thickness,
            passes,
            faces,
            backstops,
            iterations,
            ..GroupDef::default()
        };
        let (mut contact_impulses, mut grips, mut drawn_from) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..input.count(PARTICLE_BYTES)? {
            def.particles.push(read_particle(input)?);
            contact_impulses.push(input.vec3()?);
            grips.push(match input.u8()? {
                0 => Grip::Off,
                1 => Grip::Slide,
                2 => Grip::Stick,
                _ => return Err(input.error("a grip is none of the three")),
            });
            drawn_from.push(input.vec3()?);
        }
        for _ in 0..input.count(SPRING_BYTES)? {
            def.springs.push(read_spring(input)?);
        }
        load_net(input, &mut def)?;
        let mut added = Vec::new();
        for _ in 0..input.count(ATTACHMENT_BYTES)? {
            let (attachment, of_body) = read_attachment(input)?;
            added.extend(of_body.map(|of_body| (attachment.particle, of_body)));
            def.attachments.push(attachment);
        }
        def.check().map_err(|error| input.error(error.what()))?;
        let finite = contact_impulses.iter().chain(&drawn_from).all(|v: &Vec3| v.is_finite());
        if !(finite && span.is_finite()) {
            return Err(input.error("an impulse, a place or a time is not finite"));
        }
        let mut group = Self { span, contact_impulses, grips, drawn_from, ..Self::new(&def) };
        for (particle, of_body) in added {
            if group.added_by_first(particle).is_none() {
                return Err(input.error("an added mass stands with the first particle of its body"));
            }
            group.added[group.forest.hub_of(particle as usize)] = of_body;
        }
        group.load_rest(input)?;
        Ok(group)
    }
}

fn save_backstop(backstop: &BackstopDef, out: &mut Writer) {
    out.u32(backstop.particle);
    out.u64(backstop.body.to_bits());
    out.vec3(backstop.center);
    out.f32(backstop.radius);
}

fn read_backstops(input: &mut Reader<'_>) -> Result<Vec<BackstopDef>, ReadError> {
    let mut backstops = Vec::new();
    for _ in 0..input.count(BACKSTOP_BYTES)? {
        backstops.push(BackstopDef {
            particle: input.u32()?,
            body: BodyId::from_bits(input.u64()?),
            center: input.vec3()?,
            radius: input.f32()?,
        });
    }
    Ok(backstops)
}

fn read_bodies(input: &mut Reader<'_>) -> Result<Vec<BodyId>, ReadError> {
    let count = input.count(8)?;
    (0..count).map(|_| Ok(BodyId::from_bits(input.u64()?))).collect()
}

fn load_net(input: &mut Reader<'_>, def: &mut GroupDef) -> Result<(), ReadError> {
    for _ in 0..input.count(BEND_BYTES)? {
        let particles = read_triangle(input)?;
        def.bends.push(BendDef { particles, rest: input.f32()?, stiffness: input.f32()? });
    }
    for _ in 0..input.count(TETHER_BYTES)? {
        def.tethers.push(TetherDef { particle: input.u32()?, to: input.u32()?, length: input.f32()? });
    }
    for _ in 0..input.count(VOLUME_BYTES)? {
        let (rest_volume, bulk_modulus) = (input.f32()?, input.f32()?);
        let triangles = read_triangles(input)?;
        def.volumes.push(VolumeDef { triangles, rest_volume, bulk_modulus });
    }
    Ok(())
}

fn read_triangles(input: &mut Reader<'_>) -> Result<Vec<[u32; 3]>, ReadError> {
    let count = input.count(TRIANGLE_BYTES)?;
    (0..count).map(|_| read_triangle(input)).collect()
}

fn read_triangle(input: &mut Reader<'_>) -> Result<[u32; 3], ReadError> {
    Ok([input.u32()?, input.u32()?, input.u32()?])
}

fn read_spring(input: &mut Reader<'_>) -> Result<SpringDef, ReadError> {
    Ok(SpringDef {
        a: input.u32()?,
        b: input.u32()?,
        rest_length: input.f32()?,
        stiffness: input.f32()?,
        damping: input.f32()?,
        resists: match input.u8()? {
            0 => Resists::Both,
            1 => Resists::Stretch,
            _ => return Err(input.error("a spring resists neither way")),
        },
    })
}

fn read_particle(input: &mut Reader<'_>) -> Result<ParticleDef, ReadError> {
    Ok(ParticleDef {
        position: input.vec3()?,
        velocity: input.vec3()?,
        mass: input.f32()?,
        radius: input.f32()?,
    })
}

fn read_attachment(input: &mut Reader<'_>) -> Result<(AttachmentDef, Option<AddedMass>), ReadError> {
    let particle = input.u32()?;
    let kind = input.u8()?;
    let target = match kind {
        0 => AttachmentTarget::World(input.vec3()?),
        1 | 2 => AttachmentTarget::Body { body: BodyId::from_bits(input.u64()?), point: input.vec3()? },
        _ => return Err(input.error("attachment is neither to the world nor to a body")),
    };
    let added = if kind == 2 { Some(AddedMass::load(input)?) } else { None };
    Ok((AttachmentDef { particle, target }, added))
}
