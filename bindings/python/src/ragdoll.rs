//! Ragdolls and models as data.

use crate::arrays::{array, push_pose};
use crate::errors::{bad, failed, guarded, of_file};
use numpy::{PyArray1, PyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use sinew::formats::{
    MjcfModel, MjcfText, read_bytes, read_model, read_ragdoll, write_atomic, write_mjcf, write_ragdoll,
};
use sinew::math::Range;
use sinew::physics::{JointKind, Shape};
use sinew::ragdoll::doctor::Finding;
use sinew::ragdoll::{
    BuildReport, FallQuality, RagdollBodyDef, RagdollDef, Repair, cure, doctor, drop_test, torque_caps,
};
use std::path::PathBuf;

/// Ragdoll: bodies and joints, parents before children; joint `i` attaches body `i + 1` to its parent.
#[pyclass(frozen, module = "sinew")]
pub struct Ragdoll {
    pub repair: Repair,
    notes: Vec<String>,
    mean_error: Option<f32>,
}

/// Model of bodies and joints, as in MuJoCo's format, with all its shapes.
#[pyclass(frozen, module = "sinew")]
pub struct Model {
    pub model: MjcfModel,
}

/// Reads a ragdoll definition (.json) or an MJCF or URDF model (.xml, .urdf), or builds the ragdoll of a character.
#[pyfunction]
pub fn load_ragdoll(py: Python<'_>, path: PathBuf) -> PyResult<Ragdoll> {
    let repair = py.detach(|| guarded(|| sinew_bindings::load_ragdoll(&path)))?.map_err(failed)?;
    Ok(Ragdoll { repair, notes: Vec::new(), mean_error: None })
}

/// Reads an MJCF model (.xml), a URDF (.urdf) or the physics of a glTF (.gltf, .glb): bodies, joints, and a floor if it has one.
#[pyfunction]
pub fn load_model(py: Python<'_>, path: PathBuf) -> PyResult<Model> {
    let read = || {
        let model = read_bytes(&path).and_then(|bytes| read_model(&bytes));
        model.map_err(|error| error.with_file(path.display().to_string()))
    };
    Ok(Model { model: py.detach(|| guarded(read))?.map_err(of_file)? })
}

impl Ragdoll {
    pub fn built(def: RagdollDef, report: BuildReport) -> Self {
        let repair = Repair { reference: Some(def.clone()), ..Repair::new(def) };
        Self { repair, notes: report.notes, mean_error: Some(report.mean_error) }
    }
}

/// Metrics of a fall, with the names in docs/contract.md.
pub fn quality_dict<'py>(py: Python<'py>, q: &FallQuality) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (key, value) in [
        ("energy_gain_max", q.energy_gain_max),
        ("work_in_j", q.work_in_j),
        ("joint_gap_max_m", q.joint_gap_max_m),
        ("joint_gap_p99_m", q.joint_gap_p99_m),
        ("limit_overshoot_max_deg", q.limit_overshoot_max_deg),
        ("limit_overshoot_p99_deg", q.limit_overshoot_p99_deg),
        ("penetration_max_m", q.penetration_max_m),
        ("penetration_rest_max_m", q.penetration_rest_max_m),
    ] {
        dict.set_item(key, value)?;
    }
    for (key, value) in [("first_contact_s", q.first_contact_s), ("settled_s", q.settled_s), ("up_s", q.up_s)]
    {
        dict.set_item(key, value)?;
    }
    dict.set_item("nan", q.nan)?;
    Ok(dict)
}

/// Returns a shape scaled by a factor.
fn scaled_shape(shape: &Shape, factor: f32) -> PyResult<Shape> {
    Ok(match *shape {
        Shape::Box { half_extents } => Shape::Box { half_extents: half_extents * factor },
        Shape::Sphere { radius } => Shape::Sphere { radius: radius * factor },
        Shape::Capsule { half_height, radius } => {
            Shape::Capsule { half_height: half_height * factor, radius: radius * factor }
        }
        Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => Shape::TaperedCapsule {
            half_height: half_height * factor,
            radius_bottom: radius_bottom * factor,
            radius_top: radius_top * factor,
        },
        _ => return Err(bad("this shape cannot be scaled; give a new one")),
    })
}

/// Requested changes of one body and of the joint to its parent.
struct Edit {
    mass: Option<f32>,
    shape: Option<Shape>,
    scale: Option<f32>,
    swing_y: Option<(f32, f32)>,
    swing_z: Option<(f32, f32)>,
    twist: Option<(f32, f32)>,
    friction_torque: Option<f32>,
}

impl Edit {
    fn apply(self, def: &mut RagdollDef, index: usize) -> PyResult<()> {
        let body = &mut def.bodies[index];
        let positive = |number: Option<f32>, what: &str| match number {
            Some(number) if !(number > 0.0 && number < f32::INFINITY) => {
                Err(bad(format!("{what} must be positive and finite, not {number}")))
            }
            other => Ok(other),
        };
        let (mass, scale) = (positive(self.mass, "a mass")?, positive(self.scale, "a scale")?);
        if self.shape.is_some() || scale.is_some() {
            let shape = self.shape.unwrap_or_else(|| body.shape.clone());
            body.shape = scale.map_or(Ok(shape.clone()), |scale| scaled_shape(&shape, scale))?;
            let solid = body.shape.mass_properties(1.0);
            body.mass = solid.scaled_to(body.mass.mass);
        }
        if let Some(mass) = mass {
            def.total_mass += mass - body.mass.mass;
            body.mass = body.mass.scaled_to(mass);
        }
        let Some(joint) = index.checked_sub(1).map(|joint| &mut def.joints[joint]) else {
            let any =
                self.swing_y.or(self.swing_z).or(self.twist).is_some() || self.friction_torque.is_some();
            return if any { Err(bad("the first body has no joint")) } else { Ok(()) };
        };
        joint.friction_torque = self.friction_torque.unwrap_or(joint.friction_torque);
        let range = |(lo, hi): (f32, f32)| Range { lo, hi };
        match &mut joint.kind {
            JointKind::Ball { limit: Some(limit) } | JointKind::Universal { limit: Some(limit) } => {
                limit.swing_y = self.swing_y.map_or(limit.swing_y, range);
                limit.swing_z = self.swing_z.map_or(limit.swing_z, range);
                limit.twist = self.twist.map_or(limit.twist, range);
            }
            JointKind::Hinge { limit } if self.swing_y.is_none() && self.swing_z.is_none() => {
                *limit = self.twist.map(range).or(*limit);
            }
            _ if self.swing_y.or(self.swing_z).or(self.twist).is_some() => {
                return Err(bad("this joint has no such limit"));
            }
            _ => {}
        }
        Ok(())
    }
}

/// Findings of the doctor: `{"findings": [{"code", "severity", "bones", "cause", "evidence", "fix", "fixed"}]}`.
fn findings_dict(py: Python<'_>, found: Vec<Finding>) -> PyResult<Bound<'_, PyDict>> {
    let findings = PyList::empty(py);
    for finding in found {
        let dict = PyDict::new(py);
        dict.set_item("code", finding.code.name())?;
        dict.set_item("severity", finding.severity.name())?;
        dict.set_item("bones", &finding.bones)?;
        dict.set_item("cause", finding.code.cause())?;
        dict.set_item("evidence", &finding.evidence)?;
        dict.set_item("fix", &finding.fix)?;
        dict.set_item("fixed", finding.fixed)?;
        findings.append(dict)?;
    }
    let report = PyDict::new(py);
    report.set_item("findings", findings)?;
    Ok(report)
}

#[pymethods]
impl Ragdoll {
    /// Names of the rig joints that carry the bodies.
    #[getter]
    fn bones(&self) -> Vec<&str> {
        self.repair.def.bodies.iter().map(|body| body.bone.as_str()).collect()
    }

    /// Roles of the bodies.
    #[getter]
    fn roles(&self) -> Vec<&str> {
        self.repair.def.bodies.iter().map(|body| body.role.as_str()).collect()
    }

    /// Masses, kg, body by body.
    #[getter]
    fn masses<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_vec(py, self.repair.def.bodies.iter().map(|body| body.mass.mass).collect())
    }

    /// Index of each body's parent, -1 for the first.
    #[getter]
    fn parents<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        let joints = self.repair.def.joints.iter().map(|joint| joint.parent as i64);
        PyArray1::from_vec(py, std::iter::once(-1).chain(joints).collect())
    }

    /// Largest torque of the muscles at each joint, N·m, joint by joint.
    #[getter]
    fn torques<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_vec(py, torque_caps(&self.repair.def).into_iter().skip(1).collect())
    }

    /// Poses of the bodies in character space in the bind pose, (n, 7).
    #[getter]
    fn bind_poses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let mut numbers = Vec::new();
        let bodies = &self.repair.def.bodies;
        bodies.iter().for_each(|body| push_pose(&mut numbers, &body.character_from_body));
        array(py, numbers, &[bodies.len(), 7])
    }

    /// Frames of the joints relative to their parent bodies, (n - 1, 7); the first axis is that of the twist or the hinge.
    #[getter]
    fn joint_frames<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let mut numbers = Vec::new();
        let joints = &self.repair.def.joints;
        joints.iter().for_each(|joint| push_pose(&mut numbers, &joint.frame_parent));
        array(py, numbers, &[joints.len(), 7])
    }

    /// Total mass, kg.
    #[getter]
    fn total_mass(&self) -> f32 {
        self.repair.def.total_mass
    }

    /// Height, metres.
    #[getter]
    fn height(&self) -> f32 {
        self.repair.def.height
    }

    /// Metres per unit of the file.
    #[getter]
    fn unit_scale(&self) -> f32 {
        self.repair.def.unit_scale
    }

    /// Returns a copy with the doctor's cures applied, and the doctor's findings.
    fn cured<'py>(&self, py: Python<'py>) -> PyResult<(Self, Bound<'py, PyDict>)> {
        let (repair, found) = py.detach(|| guarded(|| cure(&self.repair)))?;
        let ragdoll = Self { repair, notes: self.notes.clone(), mean_error: self.mean_error };
        Ok((ragdoll, findings_dict(py, found)?))
    }

    /// Converts the definition to a MuJoCo model; also returns notes on losses, one sentence each.
    #[pyo3(signature = (name="ragdoll"))]
    fn to_mjcf(&self, py: Python<'_>, name: &str) -> PyResult<(String, Vec<String>)> {
        let MjcfText { text, notes } = py.detach(|| guarded(|| write_mjcf(&self.repair.def, name)))?;
        Ok((text, notes))
    }

    /// Report of the build: notes, and, if the ragdoll was built, the mean distance between skin and shapes in metres.
    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        dict.set_item("bodies", self.repair.def.bodies.len())?;
        dict.set_item("total_mass_kg", self.repair.def.total_mass)?;
        dict.set_item("height_m", self.repair.def.height)?;
        dict.set_item("dropped_bones", &self.repair.def.dropped_bones)?;
        dict.set_item("skin_error_m", self.mean_error)?;
        dict.set_item("notes", &self.notes)?;
        Ok(dict)
    }

    /// Findings of the doctor: `{"findings": [{"code", "severity", "bones", "cause", "evidence", "fix"}]}`.
    fn doctor<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let found = py.detach(|| guarded(|| doctor(&self.repair)))?;
        findings_dict(py, found)
    }

    /// Drops the ragdoll and throws it at a wall: `{"verdict", "reasons", "drop", "wall"}`.
    fn drop_test<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let tested = py.detach(|| guarded(|| drop_test(&self.repair.def)))?;
        let dict = PyDict::new(py);
        dict.set_item("verdict", tested.verdict.name())?;
        dict.set_item("reasons", &tested.reasons)?;
        dict.set_item("drop", quality_dict(py, &tested.drop)?)?;
        dict.set_item("wall", quality_dict(py, &tested.wall)?)?;
        Ok(dict)
    }

    /// Reads the ragdoll from the text of a definition, as returned by `to_json`.
    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Self> {
        let def = read_ragdoll(text.as_bytes()).map_err(of_file)?;
        Ok(Self { repair: Repair::new(def), notes: Vec::new(), mean_error: None })
    }

    /// Returns a copy with changes of one body and its joint: omitted values stay. Ranges are in radians.
    #[pyo3(signature = (bone, *, mass=None, shape=None, size=None, scale=None, swing_y=None, swing_z=None, twist=None, friction_torque=None))]
    fn edited(
        &self,
        bone: &str,
        mass: Option<f32>,
        shape: Option<&str>,
        size: Option<Vec<f32>>,
        scale: Option<f32>,
        swing_y: Option<(f32, f32)>,
        swing_z: Option<(f32, f32)>,
        twist: Option<(f32, f32)>,
        friction_torque: Option<f32>,
    ) -> PyResult<Self> {
        let mut def = self.repair.def.clone();
        let named = |body: &RagdollBodyDef| body.role == bone || body.bone == bone;
        let index = def.bodies.iter().position(named);
        let index = index.ok_or_else(|| bad(format!("no body is called '{bone}'")))?;
        let new_shape = match (shape, size) {
            (Some(kind), Some(size)) => Some(crate::world::shape(kind, &size)?),
            (None, None) => None,
            _ => return Err(bad("a shape needs its kind and its size")),
        };
        let wanted = Edit { mass, shape: new_shape, scale, swing_y, swing_z, twist, friction_torque };
        wanted.apply(&mut def, index)?;
        // Writes and reads the definition, so that invalid ones are rejected with the reader's message.
        let def = read_ragdoll(write_ragdoll(&def).as_bytes()).map_err(|error| bad(error.to_string()))?;
        let repair = Repair { reference: self.repair.reference.clone(), ..Repair::new(def) };
        Ok(Self { repair, notes: self.notes.clone(), mean_error: self.mean_error })
    }

    /// Returns the text of the definition, as in a .sinew.json file.
    fn to_json(&self) -> String {
        write_ragdoll(&self.repair.def)
    }

    /// Writes the definition to a .sinew.json file atomically.
    fn save(&self, path: PathBuf) -> PyResult<()> {
        write_atomic(&path, self.to_json().as_bytes()).map_err(of_file)
    }

    fn __len__(&self) -> usize {
        self.repair.def.bodies.len()
    }

    fn __repr__(&self) -> String {
        let def = &self.repair.def;
        format!("Ragdoll({} bodies, {:.1} kg, {:.2} m)", def.bodies.len(), def.total_mass, def.height)
    }
}

#[pymethods]
impl Model {
    /// Name of the model in the file.
    #[getter]
    fn name(&self) -> &str {
        &self.model.name
    }

    /// Names of the bodies; the first is the world, which is static.
    #[getter]
    fn bodies(&self) -> Vec<&str> {
        self.model.bodies.iter().map(|body| body.name.as_str()).collect()
    }

    /// Names of the joints.
    #[getter]
    fn joints(&self) -> Vec<&str> {
        self.model.joints.iter().map(|joint| joint.name.as_str()).collect()
    }

    /// Notes on omissions and changes, one sentence each.
    #[getter]
    fn notes(&self) -> Vec<&str> {
        self.model.notes.iter().map(String::as_str).collect()
    }
}
