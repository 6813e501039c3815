//! Reads definitions of shapes, bodies and joints from JavaScript objects.

use crate::border::{Failure, Outcome, refused};
use crate::values::{Options, object};
use js_sys::Array;
use sinew::math::{Range, Rotation, SwingTwistLimit, Transform, Vec3};
use sinew::physics::{
    BodyDef, BodyId, BodyKind, Filter, HeightField, HeightFieldDef, JointCollision, JointDef, JointId,
    JointKind, MassProperties, Material, Motor, Quality, Sensing, Shape, ShapeDef, Sleeping, Softness,
    Spring, Strength, World, WorldDef,
};
use std::sync::Arc;
use wasm_bindgen::{JsCast, JsValue};

const QUALITIES: [(&str, Quality); 3] =
    [("fast", Quality::Fast), ("balanced", Quality::Balanced), ("exact", Quality::Exact)];

/// Fields that a shape may have, and a body for all its shapes.
const SURFACE: [&str; 6] = ["density", "friction", "restitution", "sensor", "layers", "mask"];

fn failed(error: impl core::fmt::Display) -> Failure {
    Failure(error.to_string())
}

fn sleeping(options: &Options<'_>) -> Outcome<Sleeping> {
    Ok(if options.flag("sleeping")? == Some(false) { Sleeping::Off } else { Sleeping::On })
}

fn quality(options: &Options<'_>) -> Outcome<Option<Quality>> {
    let chosen = options.word("quality", &QUALITIES.map(|(word, _)| word))?;
    Ok(chosen.map(|index| QUALITIES[index].1))
}

/// Reads the settings of a world.
pub fn world_def(value: &JsValue) -> Outcome<WorldDef> {
    let known = ["gravity", "stepSeconds", "substeps", "quality", "sleeping", "catchUpSteps", "hitSpeed"];
    let options = Options::of(value, "options", &known)?;
    let default = WorldDef::default();
    let seconds = options.double("stepSeconds")?;
    let def = WorldDef {
        gravity: options.vec3("gravity")?.unwrap_or(default.gravity),
        step_nanoseconds: seconds.map_or(default.step_nanoseconds, |s| (s * 1e9).round() as u64),
        substeps: options.whole("substeps")?.unwrap_or(default.substeps),
        quality: quality(&options)?.unwrap_or_default(),
        sleeping: sleeping(&options)?,
        catch_up_steps: options.whole("catchUpSteps")?.unwrap_or(default.catch_up_steps),
        hit_speed: options.number("hitSpeed")?.unwrap_or(default.hit_speed),
        ..default
    };
    def.check().map_err(failed)?;
    Ok(def)
}

const SHAPES: [&str; 10] = [
    "box",
    "sphere",
    "capsule",
    "taperedCapsule",
    "cylinder",
    "cone",
    "halfSpace",
    "hull",
    "mesh",
    "heightField",
];

/// Reads a shape from its `type` and sizes.
fn shape(options: &Options<'_>) -> Outcome<Shape> {
    let number = |key: &str| options.needed_number(key);
    Ok(match SHAPES[options.needed_word("type", &SHAPES)?] {
        "box" => Shape::cuboid(options.needed_vec3("halfExtents")?),
        "sphere" => Shape::sphere(number("radius")?),
        "capsule" => Shape::capsule(number("halfHeight")?, number("radius")?),
        "taperedCapsule" => Shape::TaperedCapsule {
            half_height: number("halfHeight")?,
            radius_bottom: number("radiusBottom")?,
            radius_top: number("radiusTop")?,
        },
        "cylinder" => Shape::cylinder(number("halfHeight")?, number("radius")?),
        "cone" => Shape::cone(number("halfHeight")?, number("radius")?),
        "halfSpace" => Shape::HalfSpace,
        "hull" => Shape::hull(&options.points("points")?).map_err(failed)?,
        "mesh" => {
            let indices = options.indices("indices")?;
            if indices.len() % 3 != 0 {
                return Err(Failure::new("a mesh must have three indices for each triangle"));
            }
            let triangles: Vec<[u32; 3]> = indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
            Shape::mesh(&options.points("vertices")?, &triangles).map_err(failed)?
        }
        _ => {
            let [columns, rows] = [options.needed_whole("columns")?, options.needed_whole("rows")?];
            let heights = options.floats("heights")?;
            let def = HeightFieldDef::new(columns as usize, rows as usize, number("spacing")?, heights);
            Shape::HeightField(Arc::new(HeightField::new(def).map_err(failed)?))
        }
    })
}

const SIZES: [&str; 15] = [
    "type",
    "halfExtents",
    "radius",
    "halfHeight",
    "radiusBottom",
    "radiusTop",
    "points",
    "vertices",
    "indices",
    "columns",
    "rows",
    "spacing",
    "heights",
    "position",
    "rotation",
];

/// Reads a shape without surface fields, for queries.
pub fn probe_shape(value: &JsValue) -> Outcome<Shape> {
    let shape = shape(&Options::of(value, "shape", &SIZES)?)?;
    if shape.is_solid() && shape != Shape::HalfSpace {
        shape.check().map_err(failed)?;
        return Ok(shape);
    }
    Err(Failure::new("the shape of a query must be convex and bounded"))
}

/// Reads surface and filter of a shape; missing fields are taken from `default`.
fn surfaced(options: &Options<'_>, default: &ShapeDef) -> Outcome<ShapeDef> {
    let friction = options.number("friction")?.unwrap_or(default.material.friction);
    let restitution = options.number("restitution")?.unwrap_or(default.material.restitution);
    let sensing = match options.flag("sensor")? {
        Some(true) => Sensing::Sensor,
        Some(false) => Sensing::Solid,
        None => default.sensing,
    };
    Ok(ShapeDef {
        density: options.number("density")?.unwrap_or(default.density),
        material: Material { friction, restitution, ..default.material },
        filter: Filter {
            layers: options.whole("layers")?.unwrap_or(default.filter.layers),
            mask: options.whole("mask")?.unwrap_or(default.filter.mask),
            group: 0,
        },
        sensing,
        ..default.clone()
    })
}

fn shape_def(value: &JsValue, default: &ShapeDef) -> Outcome<ShapeDef> {
    let known: Vec<&str> = SIZES.into_iter().chain(SURFACE).collect();
    let options = Options::of(value, "shape", &known)?;
    let body_from_shape = Transform::new(
        options.vec3("position")?.unwrap_or(Vec3::ZERO),
        options.rotation("rotation")?.unwrap_or(Rotation::IDENTITY),
    );
    let def = ShapeDef { shape: shape(&options)?, body_from_shape, ..surfaced(&options, default)? };
    def.check().map_err(failed)?;
    Ok(def)
}

/// Kinds of bodies, by their names.
pub const KINDS: [(&str, BodyKind); 3] =
    [("dynamic", BodyKind::Dynamic), ("static", BodyKind::Static), ("kinematic", BodyKind::Kinematic)];

/// Reads the definition of a body.
pub fn body_def(value: &JsValue) -> Outcome<BodyDef> {
    let own = [
        "kind",
        "position",
        "rotation",
        "linearVelocity",
        "angularVelocity",
        "linearDamping",
        "angularDamping",
        "gravityScale",
        "shape",
        "shapes",
        "mass",
        "sleeping",
        "quality",
    ];
    let known: Vec<&str> = own.into_iter().chain(SURFACE).collect();
    let options = Options::of(value, "body", &known)?;
    let kind = options.word("kind", &KINDS.map(|(word, _)| word))?.unwrap_or(0);
    let default = surfaced(&options, &ShapeDef::new(Shape::HalfSpace))?;
    let mut shapes = Vec::new();
    for value in [options.get("shape"), options.get("shapes")].into_iter().flatten() {
        match value.dyn_ref::<Array>() {
            Some(all) => {
                shapes.extend(all.iter().map(|one| shape_def(&one, &default)).collect::<Outcome<Vec<_>>>()?)
            }
            None => shapes.push(shape_def(&value, &default)?),
        }
    }
    let usual = BodyDef::default();
    let mut def = BodyDef {
        kind: KINDS[kind].1,
        position: options.vec3("position")?.unwrap_or(Vec3::ZERO),
        rotation: options.rotation("rotation")?.unwrap_or(Rotation::IDENTITY),
        linear_velocity: options.vec3("linearVelocity")?.unwrap_or(Vec3::ZERO),
        angular_velocity: options.vec3("angularVelocity")?.unwrap_or(Vec3::ZERO),
        linear_damping: options.number("linearDamping")?.unwrap_or(usual.linear_damping),
        angular_damping: options.number("angularDamping")?.unwrap_or(usual.angular_damping),
        gravity_scale: options.number("gravityScale")?.unwrap_or(usual.gravity_scale),
        shapes,
        sleeping: sleeping(&options)?,
        quality: quality(&options)?,
        ..usual
    };
    if let Some(mass) = options.number("mass")? {
        def.mass = Some(spread(mass, &def)?);
    }
    Ok(def)
}

/// Distributes a mass over the shapes; returns the mass properties.
fn spread(mass: f32, def: &BodyDef) -> Outcome<MassProperties> {
    if mass.is_nan() || mass <= 0.0 {
        return Err(Failure(format!("body.mass must be positive, not {mass}")));
    }
    let by_density = refused(|| {
        let mut world = World::new(WorldDef::default());
        let shapes = def.shapes.iter().map(|shape| ShapeDef { density: 1.0, ..shape.clone() });
        let id = world.add_body(&BodyDef { shapes: shapes.collect(), ..BodyDef::default() });
        world.mass(id)
    })?;
    Ok(MassProperties { mass, inertia: by_density.inertia * (mass / by_density.mass), ..by_density })
}

/// Returns the body of an id, if it exists.
pub fn body(world: &World, bits: u64) -> Outcome<BodyId> {
    let id = BodyId::from_bits(bits);
    if world.contains(id) { Ok(id) } else { Err(Failure(format!("there is no body {bits} in this world"))) }
}

/// Returns the joint of an id, if it exists.
pub fn joint(world: &World, bits: u64) -> Outcome<JointId> {
    let id = JointId::from_bits(bits);
    if world.contains_joint(id) {
        Ok(id)
    } else {
        Err(Failure(format!("there is no joint {bits} in this world")))
    }
}

const JOINTS: [&str; 5] = ["ball", "hinge", "slider", "fixed", "distance"];

/// Reads a joint definition, at the present poses of its bodies.
pub fn joint_def(value: &JsValue, world: &World) -> Outcome<JointDef> {
    let known = [
        "type",
        "a",
        "b",
        "anchor",
        "anchorB",
        "axis",
        "range",
        "swing",
        "twist",
        "collide",
        "friction",
        "breakForce",
        "breakTorque",
        "spring",
        "motor",
    ];
    let options = Options::of(value, "joint", &known)?;
    let kind = JOINTS[options.needed_word("type", &JOINTS)?];
    let [a, b] = [body(world, options.needed_id("a")?)?, body(world, options.needed_id("b")?)?];
    let range = range(&options, "range")?;
    let axial = || -> Outcome<(Vec3, Vec3)> {
        let axis = options.needed_vec3("axis")?;
        if axis == Vec3::ZERO {
            return Err(Failure::new("joint.axis must not be 0"));
        }
        Ok((options.needed_vec3("anchor")?, axis))
    };
    let def = match kind {
        "ball" => {
            let cone = cone(&options)?;
            let def = match options.vec3("axis")? {
                None => world.ball(a, b, options.needed_vec3("anchor")?),
                // The axis is that of the twist.
                Some(_) => axial().map(|(anchor, axis)| world.hinge(a, b, anchor, axis))?,
            };
            JointDef { kind: JointKind::Ball { limit: cone }, ..def }
        }
        "hinge" => axial().map(|(at, axis)| JointDef {
            kind: JointKind::Hinge { limit: range },
            ..world.hinge(a, b, at, axis)
        })?,
        "slider" => axial().map(|(at, axis)| JointDef {
            kind: JointKind::Slider { limit: range },
            ..world.slider(a, b, at, axis)
        })?,
        "fixed" => world.fixed(a, b),
        _ => {
            let (from, to) = (options.needed_vec3("anchor")?, options.needed_vec3("anchorB")?);
            let length = (to - from).length();
            world.distance(a, b, from, to, range.unwrap_or(Range { lo: length, hi: length }))
        }
    };
    let strength = Strength {
        force: options.bound("breakForce")?.unwrap_or(f32::INFINITY),
        torque: options.bound("breakTorque")?.unwrap_or(f32::INFINITY),
    };
    let collides = options.flag("collide")?.unwrap_or(false);
    let spring = options.get("spring").map(|value| spring(&value)).transpose()?;
    Ok(JointDef {
        strength,
        collision: if collides { JointCollision::Enabled } else { JointCollision::Disabled },
        friction_torque: options.number("friction")?.unwrap_or(0.0),
        spring,
        motor: options.get("motor").map(|value| motor(&value)).transpose()?,
        ..def
    })
}

fn range(options: &Options<'_>, key: &str) -> Outcome<Option<Range>> {
    let Some(value) = options.get(key) else { return Ok(None) };
    match crate::values::floats(&value, key)?[..] {
        [lo, hi] if lo <= hi => Ok(Some(Range { lo, hi })),
        _ => Err(Failure(format!("{key} must be two numbers, the smaller one first"))),
    }
}

/// Reads the limits of a ball joint: half angle of its cone, and range of its twist.
fn cone(options: &Options<'_>) -> Outcome<Option<SwingTwistLimit>> {
    let (swing, twist) = (options.number("swing")?, range(options, "twist")?);
    if swing.is_none() && twist.is_none() {
        return Ok(None);
    }
    let swing = Range::symmetric(swing.unwrap_or(core::f32::consts::PI));
    let twist = twist.unwrap_or(Range::symmetric(core::f32::consts::PI));
    Ok(Some(SwingTwistLimit { twist, swing_y: swing, swing_z: swing }))
}

fn softness(options: &Options<'_>, hertz: f32) -> Outcome<Softness> {
    Ok(Softness::Frequency {
        hertz: options.number("hertz")?.unwrap_or(hertz),
        damping_ratio: options.number("dampingRatio")?.unwrap_or(1.0),
    })
}

fn spring(value: &JsValue) -> Outcome<Spring> {
    let options = Options::of(value, "spring", &["hertz", "dampingRatio"])?;
    Ok(Spring { softness: softness(&options, 1.0)?, rest: Transform::IDENTITY })
}

/// Reads a motor toward a speed or a pose.
pub fn motor(value: &JsValue) -> Outcome<Motor> {
    let known = ["speed", "target", "turn", "hertz", "dampingRatio", "maxForce", "maxTorque"];
    let options = Options::of(value, "motor", &known)?;
    let force = options.bound("maxForce")?.unwrap_or(f32::INFINITY);
    let torque = options.bound("maxTorque")?.unwrap_or(f32::INFINITY);
    if let Some(speed) = options.number("speed")? {
        let velocity = sinew::physics::Velocity { linear: Vec3::X * speed, angular: Vec3::X * speed };
        return Ok(Motor { velocity, max_force: force, max_torque: torque, ..Motor::spin(0.0, 0.0) });
    }
    let along = Vec3::X * options.number("target")?.unwrap_or(0.0);
    let turn =
        options.vec3("turn")?.map_or_else(|| Rotation::from_scaled_axis(along), Rotation::from_scaled_axis);
    let toward = Motor::toward(Transform::new(along, turn), softness(&options, 5.0)?);
    Ok(Motor { max_force: force, max_torque: torque, ..toward })
}

/// Converts mass and centre of mass to a JavaScript object.
pub fn mass(properties: MassProperties) -> JsValue {
    object([("mass", properties.mass.into()), ("center", crate::values::vector(properties.center))])
}
