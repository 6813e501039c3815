//! Writes and reads definitions and bodies.

use crate::arena::Arena;
use crate::body::contact_rule::{ContactRule, OneWay, Yields};
use crate::body::def::{BodyKind, Quality, SleepThresholds, Sleeping, WorldDef};
use crate::body::force::BodyForces;
use crate::body::library::{LoadError, ShapeLibrary, save_name};
use crate::body::material::{Combine, CombineRules, Material};
use crate::body::owner::OwnerMark;
use crate::body::shape::{Filter, Sensing, Shape};
use crate::body::surface::{Surface, Surfaces};
use crate::body::{Body, BodyShape, Gain, Rest, Velocity};
use sinew_geometry::DataKind;
use sinew_math::{ReadError, Reader, Transform, Vec3, Writer};

pub(crate) fn save_def(w: &mut Writer, def: &WorldDef) {
    w.vec3(def.gravity);
    w.u64(def.step_nanoseconds);
    w.u32(def.substeps);
    w.u32(def.catch_up_steps);
    save_quality(w, def.quality);
    w.bool(def.sleeping == Sleeping::On);
    let SleepThresholds { time, distance, angle, speed, spin } = def.sleep_thresholds;
    [time, distance, angle, speed, spin].into_iter().for_each(|x| w.f32(x));
    w.f32(def.max_speed);
    w.f32(def.max_turn);
    w.f32(def.hit_speed);
}

pub(crate) fn load_def(r: &mut Reader<'_>) -> Result<WorldDef, ReadError> {
    let gravity = r.vec3()?;
    let (step_nanoseconds, substeps, catch_up_steps) = (r.u64()?, r.u32()?, r.u32()?);
    let quality = load_quality(r)?;
    let sleeping = load_sleeping(r)?;
    let sleep_thresholds = SleepThresholds {
        time: r.f32()?,
        distance: r.f32()?,
        angle: r.f32()?,
        speed: r.f32()?,
        spin: r.f32()?,
    };
    let (max_speed, max_turn, hit_speed) = (r.f32()?, r.f32()?, r.f32()?);
    let def = WorldDef {
        gravity,
        step_nanoseconds,
        substeps,
        quality,
        catch_up_steps,
        sleeping,
        sleep_thresholds,
        max_speed,
        max_turn,
        hit_speed,
    };
    def.check().map_err(|error| r.error(error.what()))?;
    Ok(def)
}

fn save_quality(w: &mut Writer, quality: Quality) {
    w.u8(match quality {
        Quality::Fast => 0,
        Quality::Balanced => 1,
        Quality::Exact => 2,
    });
}

fn load_quality(r: &mut Reader<'_>) -> Result<Quality, ReadError> {
    match r.u8()? {
        0 => Ok(Quality::Fast),
        1 => Ok(Quality::Balanced),
        2 => Ok(Quality::Exact),
        _ => Err(r.error("unknown quality")),
    }
}

fn load_sleeping(r: &mut Reader<'_>) -> Result<Sleeping, ReadError> {
    Ok(if r.bool()? { Sleeping::On } else { Sleeping::Off })
}

/// Bit of a body's kind: the body has an owner, which is written after the body.
const OWNED: u8 = 8;

/// Writes a body without its owner.
pub(crate) fn save_body(w: &mut Writer, body: &Body) {
    let kind = match (body.kind, body.laid_by) {
        (BodyKind::Static, None) => 0,
        (BodyKind::Kinematic, None) => 1,
        (BodyKind::Dynamic, _) => 2,
        (BodyKind::Kinematic, Some(_)) => 3,
        (BodyKind::Static, Some(_)) => 4,
    };
    w.u8(if body.owner.is_some() { kind | OWNED } else { kind });
    if let Some((mass, inertia)) = body.laid_by {
        w.f32(mass);
        w.vec3(inertia);
    }
    w.transform(body.world_from_principal);
    w.transform(body.previous);
    w.vec3(body.velocity.linear);
    w.vec3(body.velocity.angular);
    w.vec3(body.force);
    w.vec3(body.torque);
    body.forces.save(w);
    w.transform(body.principal_from_body);
    w.f32(body.mass);
    w.vec3(body.inertia);
    w.f32(body.linear_damping);
    w.f32(body.angular_damping);
    w.f32(body.gravity_scale);
    w.count(body.surfaces.as_slice().len());
    for surface in body.surfaces.as_slice() {
        save_surface(w, surface);
    }
    w.count(body.shapes.len());
    for shape in &body.shapes {
        save_shape(w, shape);
    }
    match body.rest {
        Rest::Awake { rest_time } if body.gain == Gain::default() => {
            w.u8(0);
            w.f32(rest_time);
        }
        Rest::Awake { rest_time } => {
            w.u8(2);
            w.f32(rest_time);
            w.vec3(body.gain.velocity.linear);
            w.vec3(body.gain.velocity.angular);
            w.f32(body.gain.time);
        }
        Rest::Asleep { island } => {
            w.u8(1);
            w.u32(island);
        }
    }
    w.bool(body.sleeping == Sleeping::On);
    save_option(w, body.quality, save_quality);
    w.transform(body.place);
    w.bool(body.quarantined);
    w.u64(body.user_data);
}

/// True if the mass (kg) and the principal moments (kg·m²) are valid for a dynamic body.
fn solid(mass: f32, inertia: Vec3) -> bool {
    let positive = |x: f32| x > 0.0 && x < f32::INFINITY;
    [mass, inertia.x, inertia.y, inertia.z].into_iter().all(positive)
}

/// Reads whether a body is asleep, its time at rest or island number, and its velocity gain.
fn load_rest(r: &mut Reader<'_>) -> Result<(Rest, Gain), LoadError> {
    let mut gain = Gain::default();
    let rest = match r.u8()? {
        0 => Rest::Awake { rest_time: r.f32()? },
        1 => Rest::Asleep { island: r.u32()? },
        2 => {
            let rest_time = r.f32()?;
            gain.velocity = Velocity { linear: r.vec3()?, angular: r.vec3()? };
            gain.time = r.f32()?;
            Rest::Awake { rest_time }
        }
        _ => return Err(r.error("a body neither awake nor asleep").into()),
    };
    Ok((rest, gain))
}

/// Reads a body; its owner, if any, follows.
pub(crate) fn load_body(r: &mut Reader<'_>, library: &ShapeLibrary) -> Result<Body, LoadError> {
    let tag = r.u8()?;
    let (number, owner) = (tag & !OWNED, (tag & OWNED != 0).then(OwnerMark::default));
    let kind = match number {
        0 | 4 => BodyKind::Static,
        1 | 3 => BodyKind::Kinematic,
        2 => BodyKind::Dynamic,
        _ => return Err(r.error("unknown kind of body").into()),
    };
    let laid_by = if number >= 3 { Some((r.f32()?, r.vec3()?)) } else { None };
    if laid_by.is_some_and(|(mass, inertia)| !solid(mass, inertia)) {
        return Err(r.error("a body that was dynamic has no mass").into());
    }
    let (world_from_principal, previous) = (r.transform()?, r.transform()?);
    let velocity = Velocity { linear: r.vec3()?, angular: r.vec3()? };
    let (force, torque) = (r.vec3()?, r.vec3()?);
    let forces = BodyForces::load(r)?;
    let principal_from_body = r.transform()?;
    let (mass, inertia) = (r.f32()?, r.vec3()?);
    if kind == BodyKind::Dynamic && !solid(mass, inertia) {
        return Err(r.error("a dynamic body has no mass").into());
    }
    let (linear_damping, angular_damping, gravity_scale) = (r.f32()?, r.f32()?, r.f32()?);
    let surfaces = load_list(r, 29, load_surface)?;
    let shapes = load_list(r, 33, |r| load_shape(r, library, surfaces.len()))?;
    let (rest, gain) = load_rest(r)?;
    let sleeping = load_sleeping(r)?;
    let quality = load_option(r, load_quality)?;
    let (place, quarantined, user_data) = (r.transform()?, r.bool()?, r.u64()?);
    let finite =
        [world_from_principal, previous, principal_from_body, place].into_iter().all(Transform::is_finite)
            && [velocity.linear, velocity.angular, force, torque, inertia].into_iter().all(Vec3::is_finite)
            && gain.velocity.linear.is_finite()
            && gain.velocity.angular.is_finite()
            && gain.time.is_finite()
            && [mass, linear_damping, angular_damping, gravity_scale].into_iter().all(f32::is_finite);
    if !finite {
        return Err(r.error("a body whose state is not finite").into());
    }
    Ok(Body {
        kind,
        world_from_principal,
        previous,
        velocity,
        force,
        torque,
        forces,
        principal_from_body,
        mass,
        inertia,
        laid_by,
        linear_damping,
        angular_damping,
        gravity_scale,
        shapes,
        surfaces: Surfaces::new(surfaces),
        rest,
        sleeping,
        quality,
        place,
        gain,
        quarantined,
        changed: false,
        user_data,
        owner,
    })
}

fn save_shape(w: &mut Writer, s: &BodyShape) {
    save_geometry(w, &s.shape);
    w.transform(s.principal_from_shape);
    w.u32(s.surface);
}

fn load_shape(r: &mut Reader<'_>, library: &ShapeLibrary, surfaces: usize) -> Result<BodyShape, LoadError> {
    let shape = load_geometry(r, library)?;
    let shape = BodyShape { shape, principal_from_shape: r.transform()?, surface: r.u32()? };
    if !shape.principal_from_shape.is_finite() {
        return Err(r.error("a shape's pose is not finite").into());
    }
    if shape.surface as usize >= surfaces {
        return Err(r.error("a shape names a surface that is not there").into());
    }
    Ok(shape)
}

fn save_surface(w: &mut Writer, surface: &Surface) {
    w.f32(surface.density);
    save_material(w, surface.material);
    save_filter(w, surface.filter);
    w.bool(surface.sensing == Sensing::Sensor);
    save_rule(w, surface.rule);
}

fn load_surface(r: &mut Reader<'_>) -> Result<Surface, ReadError> {
    let surface = Surface {
        density: r.f32()?,
        material: load_material(r)?,
        filter: load_filter(r)?,
        sensing: if r.bool()? { Sensing::Sensor } else { Sensing::Solid },
        rule: load_rule(r)?,
    };
    if surface.density.is_finite() { Ok(surface) } else { Err(r.error("a density is not finite")) }
}

/// Reads a list of items of at least `least` bytes each.
fn load_list<'a, T, E: From<ReadError>>(
    r: &mut Reader<'a>,
    least: usize,
    mut item: impl FnMut(&mut Reader<'a>) -> Result<T, E>,
) -> Result<Vec<T>, E> {
    let count = r.count(least)?;
    let mut list = Vec::with_capacity(count);
    for _ in 0..count {
        list.push(item(r)?);
    }
    Ok(list)
}

pub(crate) fn save_geometry(w: &mut Writer, shape: &Shape) {
    if save_name(shape, w) {
        return;
    }
    match *shape {
        Shape::Box { half_extents } => {
            w.u8(0);
            w.vec3(half_extents);
        }
        Shape::Sphere { radius } => {
            w.u8(1);
            w.f32(radius);
        }
        Shape::Capsule { half_height, radius } => {
            w.u8(2);
            w.f32(half_height);
            w.f32(radius);
        }
        Shape::HalfSpace => w.u8(3),
        Shape::Hull(_) => unreachable!("it has a name"),
        Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
            w.u8(4);
            w.f32(half_height);
            w.f32(radius_bottom);
            w.f32(radius_top);
        }
        Shape::Cylinder { half_height, radius } => {
            w.u8(5);
            w.f32(half_height);
            w.f32(radius);
        }
        Shape::Cone { half_height, radius } => {
            w.u8(6);
            w.f32(half_height);
            w.f32(radius);
        }
        Shape::Mesh(_) | Shape::HeightField(_) => unreachable!("shapes with data are saved by name"),
    }
}

pub(crate) fn load_geometry(r: &mut Reader<'_>, library: &ShapeLibrary) -> Result<Shape, LoadError> {
    let tag = r.u8()?;
    if let Some(kind) = DataKind::of_tag(tag) {
        return library.find(r, kind);
    }
    let shape = match tag {
        0 => Shape::Box { half_extents: r.vec3()? },
        1 => Shape::Sphere { radius: r.f32()? },
        2 => Shape::Capsule { half_height: r.f32()?, radius: r.f32()? },
        3 => Shape::HalfSpace,
        4 => Shape::TaperedCapsule { half_height: r.f32()?, radius_bottom: r.f32()?, radius_top: r.f32()? },
        5 => Shape::Cylinder { half_height: r.f32()?, radius: r.f32()? },
        6 => Shape::Cone { half_height: r.f32()?, radius: r.f32()? },
        _ => return Err(r.error("unknown shape").into()),
    };
    shape.check().map_err(|error| r.error(error.what()))?;
    Ok(shape)
}

fn save_rule(w: &mut Writer, rule: ContactRule) {
    match rule {
        ContactRule::Push => w.u8(0),
        ContactRule::Ghost => w.u8(1),
        ContactRule::OneWay(OneWay { direction, tolerance }) => {
            w.u8(2);
            w.vec3(direction);
            w.f32(tolerance);
        }
        ContactRule::Modified { modifier } => {
            w.u8(3);
            w.u32(modifier);
        }
        ContactRule::Yields(Yields { max_force, max_impulse }) => {
            w.u8(4);
            w.f32(max_force);
            w.f32(max_impulse);
        }
    }
}

fn load_rule(r: &mut Reader<'_>) -> Result<ContactRule, ReadError> {
    let rule = match r.u8()? {
        0 => ContactRule::Push,
        1 => ContactRule::Ghost,
        2 => ContactRule::OneWay(OneWay { direction: r.vec3()?, tolerance: r.f32()? }),
        3 => ContactRule::Modified { modifier: r.u32()? },
        4 => ContactRule::Yields(Yields { max_force: r.f32()?, max_impulse: r.f32()? }),
        _ => return Err(r.error("unknown contact rule")),
    };
    rule.check().map_err(|error| r.error(error.what()))?;
    Ok(rule)
}

pub(crate) fn save_option<T>(w: &mut Writer, value: Option<T>, save: impl FnOnce(&mut Writer, T)) {
    w.bool(value.is_some());
    if let Some(value) = value {
        save(w, value);
    }
}

pub(crate) fn load_option<'a, T>(
    r: &mut Reader<'a>,
    load: impl FnOnce(&mut Reader<'a>) -> Result<T, ReadError>,
) -> Result<Option<T>, ReadError> {
    if r.bool()? { load(r).map(Some) } else { Ok(None) }
}

fn load_combine(r: &mut Reader<'_>) -> Result<Combine, ReadError> {
    match r.u8()? {
        0 => Ok(Combine::Average),
        1 => Ok(Combine::GeometricMean),
        2 => Ok(Combine::Minimum),
        3 => Ok(Combine::Multiply),
        4 => Ok(Combine::Maximum),
        _ => Err(r.error("unknown combine rule")),
    }
}

pub(crate) fn save_material(w: &mut Writer, material: Material) {
    w.f32(material.friction);
    w.f32(material.restitution);
    w.f32(material.rolling);
    save_option(w, material.static_friction, Writer::f32);
    w.bool(material.runs());
    if material.runs() {
        w.vec3(material.surface_velocity);
        w.vec3(material.surface_spin);
    }
    let CombineRules { friction, restitution, rolling } = material.combine;
    for rule in [friction, restitution, rolling] {
        save_option(w, rule, |w, rule| w.u8(rule as u8));
    }
    w.u32(material.tag);
}

pub(crate) fn load_material(r: &mut Reader<'_>) -> Result<Material, ReadError> {
    let (friction, restitution, rolling) = (r.f32()?, r.f32()?, r.f32()?);
    let static_friction = load_option(r, Reader::f32)?;
    let (surface_velocity, surface_spin) =
        if r.bool()? { (r.vec3()?, r.vec3()?) } else { Default::default() };
    let mut rule = || load_option(r, load_combine);
    let combine = CombineRules { friction: rule()?, restitution: rule()?, rolling: rule()? };
    let material = Material {
        friction,
        static_friction,
        restitution,
        rolling,
        surface_velocity,
        surface_spin,
        combine,
        tag: r.u32()?,
    };
    material.check().map_err(|error| r.error(error.what()))?;
    Ok(material)
}

pub(crate) fn save_filter(w: &mut Writer, filter: Filter) {
    w.u32(filter.layers);
    w.u32(filter.mask);
    w.u32(filter.group.cast_unsigned());
}

pub(crate) fn load_filter(r: &mut Reader<'_>) -> Result<Filter, ReadError> {
    Ok(Filter { layers: r.u32()?, mask: r.u32()?, group: r.u32()?.cast_signed() })
}

pub(crate) fn body_index(r: &mut Reader<'_>, bodies: &Arena<Body>) -> Result<u32, ReadError> {
    let index = r.u32()?;
    if bodies.try_at(index).is_some() { Ok(index) } else { Err(r.error("names a body that is not there")) }
}
