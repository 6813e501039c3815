//! Conversion of fields to bytes and back.

use super::{
    Buoyancy, Drag, Fade, FieldDef, FieldKind, Functions, Gusts, MutualGravity, PARAMETERS, PointGravity,
    Region, UniformGravity, Wind,
};
use crate::body::library::{LoadError, ShapeLibrary};
use crate::body::snapshot::{load_geometry, save_geometry};
use sinew_math::{ReadError, Reader, Writer};

impl FieldDef {
    /// Writes all fields.
    pub(crate) fn save(&self, w: &mut Writer) {
        w.u32(self.layers);
        save_region(w, &self.region);
        save_kind(w, &self.kind);
    }

    /// Reads the format of [`save`](Self::save).
    ///
    /// # Errors
    /// If the bytes end too early, [`check`](Self::check) rejects a value, a user function is not registered, or the
    /// region's shape is not in the library.
    pub(crate) fn load(
        r: &mut Reader<'_>,
        functions: &Functions,
        library: &ShapeLibrary,
    ) -> Result<Self, LoadError> {
        let layers = r.u32()?;
        let region = load_region(r, library)?;
        let field = Self { kind: load_kind(r)?, region, layers };
        field.check().map_err(|error| r.error(error.what()))?;
        match field.kind {
            FieldKind::Custom { function, .. } if !functions.has(function) => {
                Err(r.error("names a field function that is not registered").into())
            }
            _ => Ok(field),
        }
    }
}

fn save_region(w: &mut Writer, region: &Region) {
    match region {
        Region::Everywhere => w.u8(0),
        Region::Inside { shape, world_from_shape, margin, fade } => {
            w.u8(1);
            save_geometry(w, shape);
            w.transform(*world_from_shape);
            w.f32(*margin);
            w.u8(match fade {
                Fade::None => 0,
                Fade::Linear => 1,
                Fade::Smooth => 2,
                Fade::Square => 3,
            });
        }
    }
}

fn load_region(r: &mut Reader<'_>, library: &ShapeLibrary) -> Result<Region, LoadError> {
    if !r.bool()? {
        return Ok(Region::Everywhere);
    }
    let (shape, world_from_shape, margin) = (load_geometry(r, library)?, r.transform()?, r.f32()?);
    let fade = match r.u8()? {
        0 => Fade::None,
        1 => Fade::Linear,
        2 => Fade::Smooth,
        3 => Fade::Square,
        _ => return Err(r.error("a field that fades in an unknown way").into()),
    };
    Ok(Region::Inside { shape, world_from_shape, margin, fade })
}

fn save_kind(w: &mut Writer, kind: &FieldKind) {
    match kind {
        FieldKind::Uniform(field) => {
            w.u8(0);
            w.vec3(field.acceleration);
        }
        FieldKind::Point(field) => {
            w.u8(1);
            w.vec3(field.center);
            w.f32(field.strength);
            w.f32(field.softening);
        }
        FieldKind::Mutual(field) => {
            w.u8(2);
            w.f32(field.constant);
            w.f32(field.softening);
        }
        FieldKind::Wind(field) => {
            w.u8(3);
            save_wind(w, field);
        }
        FieldKind::Drag(field) => {
            w.u8(4);
            w.f32(field.linear);
            w.f32(field.quadratic);
            w.f32(field.angular);
            w.vec3(field.flow);
        }
        FieldKind::Buoyancy(field) => {
            w.u8(5);
            w.transform(field.world_from_surface);
            w.f32(field.density);
            w.vec3(field.flow);
            w.f32(field.damping);
            w.f32(field.drag);
        }
        FieldKind::Custom { function, parameters } => {
            w.u8(6);
            w.u32(*function);
            for x in parameters {
                w.f32(*x);
            }
        }
    }
}

fn load_kind(r: &mut Reader<'_>) -> Result<FieldKind, ReadError> {
    Ok(match r.u8()? {
        0 => FieldKind::Uniform(UniformGravity { acceleration: r.vec3()? }),
        1 => FieldKind::Point(PointGravity { center: r.vec3()?, strength: r.f32()?, softening: r.f32()? }),
        2 => FieldKind::Mutual(MutualGravity { constant: r.f32()?, softening: r.f32()? }),
        3 => FieldKind::Wind(load_wind(r)?),
        4 => FieldKind::Drag(Drag {
            linear: r.f32()?,
            quadratic: r.f32()?,
            angular: r.f32()?,
            flow: r.vec3()?,
        }),
        5 => FieldKind::Buoyancy(Buoyancy {
            world_from_surface: r.transform()?,
            density: r.f32()?,
            flow: r.vec3()?,
            damping: r.f32()?,
            drag: r.f32()?,
        }),
        6 => {
            let function = r.u32()?;
            let mut parameters = [0.0; PARAMETERS];
            for x in &mut parameters {
                *x = r.f32()?;
            }
            FieldKind::Custom { function, parameters }
        }
        _ => return Err(r.error("unknown kind of field")),
    })
}

fn save_wind(w: &mut Writer, wind: &Wind) {
    w.vec3(wind.velocity);
    w.f32(wind.density);
    w.f32(wind.drag);
    w.f32(wind.lift);
    w.bool(wind.gusts.is_some());
    if let Some(gusts) = &wind.gusts {
        w.f32(gusts.speed);
        w.f32(gusts.length);
        w.f32(gusts.time);
        w.u64(gusts.seed);
    }
}

fn load_wind(r: &mut Reader<'_>) -> Result<Wind, ReadError> {
    let (velocity, density, drag, lift) = (r.vec3()?, r.f32()?, r.f32()?, r.f32()?);
    let gusts = if r.bool()? {
        Some(Gusts { speed: r.f32()?, length: r.f32()?, time: r.f32()?, seed: r.u64()? })
    } else {
        None
    };
    Ok(Wind { velocity, density, drag, lift, gusts })
}
