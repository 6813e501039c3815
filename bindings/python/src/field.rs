//! Fields: wind, water, gravity and drag, everywhere or in a region.

use crate::arrays::vec3;
use crate::errors::bad;
use crate::live::one_pose;
use crate::world::shape;
use pyo3::prelude::*;
use sinew::math::{Transform, Vec3};
use sinew::physics::{
    Buoyancy, Drag, Fade, FieldDef, FieldKind, Gusts, MutualGravity, PointGravity, Region, UniformGravity,
    Wind,
};

/// Field that acts on all bodies, on movers and on particles.
#[pyclass(frozen, skip_from_py_object, module = "sinew")]
#[derive(Clone)]
pub struct Field {
    pub def: FieldDef,
    kind: &'static str,
}

fn checked(kind: &'static str, def: FieldDef) -> PyResult<Field> {
    def.check().map_err(|what| bad(what.to_string()))?;
    Ok(Field { def, kind })
}

fn vec3_or_zero(given: Option<&Bound<'_, PyAny>>, name: &str) -> PyResult<Vec3> {
    Ok(given.map(|given| vec3(given, name)).transpose()?.unwrap_or(Vec3::ZERO))
}

pub fn fade_named(name: &str) -> PyResult<Fade> {
    Ok(match name {
        "none" => Fade::None,
        "linear" => Fade::Linear,
        "smooth" => Fade::Smooth,
        "square" => Fade::Square,
        other => return Err(bad(format!("a fade is none, linear, smooth or square, not '{other}'"))),
    })
}

#[pymethods]
impl Field {
    /// Creates wind with a velocity in m/s; gusts with a speed (m/s), a length (m) and a time (s) may be added.
    #[staticmethod]
    #[pyo3(signature = (velocity, *, density=1.225, drag=1.0, lift=0.0, gust_speed=0.0, gust_length=3.0, gust_time=1.0, seed=0))]
    pub fn wind(
        velocity: &Bound<'_, PyAny>,
        density: f32,
        drag: f32,
        lift: f32,
        gust_speed: f32,
        gust_length: f32,
        gust_time: f32,
        seed: u64,
    ) -> PyResult<Self> {
        let gusts = Gusts { speed: gust_speed, length: gust_length, time: gust_time, seed };
        let gusts = (gust_speed != 0.0).then_some(gusts);
        let wind = Wind { velocity: vec3(velocity, "velocity")?, density, drag, lift, gusts };
        checked("wind", FieldDef::new(FieldKind::Wind(wind)))
    }

    /// Creates water below a height in metres.
    #[staticmethod]
    #[pyo3(signature = (height=0.0, *, density=1000.0, flow=None, damping=1.0, drag=0.5))]
    fn water(
        height: f32,
        density: f32,
        flow: Option<&Bound<'_, PyAny>>,
        damping: f32,
        drag: f32,
    ) -> PyResult<Self> {
        let world_from_surface = Transform::from_translation(Vec3::Y * height);
        let flow = vec3_or_zero(flow, "flow")?;
        let water = Buoyancy { world_from_surface, density, flow, damping, drag };
        checked("water", FieldDef::new(FieldKind::Buoyancy(water)))
    }

    /// Creates an acceleration in addition to the world's gravity, m/s².
    #[staticmethod]
    fn gravity(acceleration: &Bound<'_, PyAny>) -> PyResult<Self> {
        let acceleration = vec3(acceleration, "acceleration")?;
        checked("gravity", FieldDef::new(FieldKind::Uniform(UniformGravity { acceleration })))
    }

    /// Creates an attraction to a point with a strength G·M in m³/s²; a negative strength repels.
    #[staticmethod]
    #[pyo3(signature = (center, strength, *, softening=0.0))]
    fn attraction(center: &Bound<'_, PyAny>, strength: f32, softening: f32) -> PyResult<Self> {
        let center = vec3(center, "center")?;
        let point = PointGravity { center, strength, softening };
        checked("attraction", FieldDef::new(FieldKind::Point(point)))
    }

    /// Creates the mutual attraction of all bodies with a gravitational constant, m³/(kg s²).
    #[staticmethod]
    #[pyo3(signature = (constant=6.6743e-11, *, softening=0.0))]
    fn mutual_gravity(constant: f32, softening: f32) -> PyResult<Self> {
        checked("mutual gravity", FieldDef::new(FieldKind::Mutual(MutualGravity { constant, softening })))
    }

    /// Creates a drag, linear (N·s/m), quadratic (N·s²/m²) and angular (N·m·s), in a medium that flows with a velocity.
    #[staticmethod]
    #[pyo3(signature = (*, linear=0.0, quadratic=0.0, angular=0.0, flow=None))]
    fn drag(linear: f32, quadratic: f32, angular: f32, flow: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let drag = Drag { linear, quadratic, angular, flow: vec3_or_zero(flow, "flow")? };
        checked("drag", FieldDef::new(FieldKind::Drag(drag)))
    }

    /// Returns a copy that acts only inside a shape at a pose, with full strength from `margin` metres below the surface on.
    #[pyo3(signature = (kind, size, *, pose=None, margin=0.0, fade="none"))]
    fn inside(
        &self,
        kind: &str,
        size: Vec<f32>,
        pose: Option<&Bound<'_, PyAny>>,
        margin: f32,
        fade: &str,
    ) -> PyResult<Self> {
        let world_from_shape = pose.map(one_pose).transpose()?.unwrap_or(Transform::IDENTITY);
        let region =
            Region::Inside { shape: shape(kind, &size)?, world_from_shape, margin, fade: fade_named(fade)? };
        checked(self.kind, FieldDef { region, ..self.def.clone() })
    }

    fn __repr__(&self) -> String {
        let place = if self.def.region == Region::Everywhere { "everywhere" } else { "in a region" };
        format!("Field({}, {place})", self.kind)
    }
}
