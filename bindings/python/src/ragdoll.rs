//! Ragdolls and models as data.

use crate::arrays::{array, push_pose};
use crate::errors::{failed, guarded, of_file};
use numpy::{PyArray1, PyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use sinew::formats::{MjcfModel, read_bytes, read_mjcf, write_atomic, write_ragdoll};
use sinew::ragdoll::{BuildReport, FallQuality, RagdollDef, Repair, doctor, drop_test, torque_caps};
use std::path::PathBuf;

/// Ragdoll: bodies and joints, parents before children; joint `i` holds body `i + 1`.
#[pyclass(frozen, module = "sinew")]
pub struct Ragdoll {
    pub repair: Repair,
    notes: Vec<String>,
    mean_error: Option<f32>,
}

/// Model of bodies and joints of MuJoCo's format, with all of its shapes.
#[pyclass(frozen, module = "sinew")]
pub struct Model {
    pub model: MjcfModel,
}

/// Reads a ragdoll: a definition (.json), an MJCF model (.xml), or a character, of which it is built.
#[pyfunction]
pub fn load_ragdoll(py: Python<'_>, path: PathBuf) -> PyResult<Ragdoll> {
    let repair = py.detach(|| guarded(|| sinew_bindings::load_ragdoll(&path)))?.map_err(failed)?;
    Ok(Ragdoll { repair, notes: Vec::new(), mean_error: None })
}

/// Reads an MJCF model: bodies, joints, and a floor where it has one.
#[pyfunction]
pub fn load_model(py: Python<'_>, path: PathBuf) -> PyResult<Model> {
    let read = || {
        let model = read_bytes(&path).and_then(|bytes| read_mjcf(&bytes));
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

/// Figures of a fall, by the names of docs/contract.md.
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

    /// kg, body by body.
    #[getter]
    fn masses<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_vec(py, self.repair.def.bodies.iter().map(|body| body.mass.mass).collect())
    }

    /// Body above each, -1 for the first.
    #[getter]
    fn parents<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        let joints = self.repair.def.joints.iter().map(|joint| joint.parent as i64);
        PyArray1::from_vec(py, std::iter::once(-1).chain(joints).collect())
    }

    /// Most that the muscles of each joint can do, N·m, joint by joint.
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

    /// Frames of the joints in their parents, (n - 1, 7): the first axis is the twist's or the hinge's.
    #[getter]
    fn joint_frames<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let mut numbers = Vec::new();
        let joints = &self.repair.def.joints;
        joints.iter().for_each(|joint| push_pose(&mut numbers, &joint.frame_parent));
        array(py, numbers, &[joints.len(), 7])
    }

    /// kg.
    #[getter]
    fn total_mass(&self) -> f32 {
        self.repair.def.total_mass
    }

    /// Metres.
    #[getter]
    fn height(&self) -> f32 {
        self.repair.def.height
    }

    /// Report of the build: notes, and the mean distance between skin and shapes in metres, if it was built.
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
        let findings = PyList::empty(py);
        for finding in found {
            let dict = PyDict::new(py);
            dict.set_item("code", finding.code.name())?;
            dict.set_item("severity", finding.severity.name())?;
            dict.set_item("bones", &finding.bones)?;
            dict.set_item("cause", finding.code.cause())?;
            dict.set_item("evidence", &finding.evidence)?;
            dict.set_item("fix", &finding.fix)?;
            findings.append(dict)?;
        }
        let report = PyDict::new(py);
        report.set_item("findings", findings)?;
        Ok(report)
    }

    /// Drops it and throws it at a wall: `{"verdict", "reasons", "drop", "wall"}`.
    fn drop_test<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let tested = py.detach(|| guarded(|| drop_test(&self.repair.def)))?;
        let dict = PyDict::new(py);
        dict.set_item("verdict", tested.verdict.name())?;
        dict.set_item("reasons", &tested.reasons)?;
        dict.set_item("drop", quality_dict(py, &tested.drop)?)?;
        dict.set_item("wall", quality_dict(py, &tested.wall)?)?;
        Ok(dict)
    }

    /// Text of its definition, as a .sinew.json file has it.
    fn to_json(&self) -> String {
        write_ragdoll(&self.repair.def)
    }

    /// Writes its definition to a .sinew.json file, whole or not at all.
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
    /// Name in the file.
    #[getter]
    fn name(&self) -> &str {
        &self.model.name
    }

    /// Names of the bodies; the first is the world, which stands.
    #[getter]
    fn bodies(&self) -> Vec<&str> {
        self.model.bodies.iter().map(|body| body.name.as_str()).collect()
    }

    /// Names of the joints.
    #[getter]
    fn joints(&self) -> Vec<&str> {
        self.model.joints.iter().map(|joint| joint.name.as_str()).collect()
    }

    /// Notes on what was left out or changed, a sentence each.
    #[getter]
    fn notes(&self) -> Vec<&str> {
        self.model.notes.iter().map(String::as_str).collect()
    }
}
