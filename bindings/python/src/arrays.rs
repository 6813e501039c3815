//! Converts numpy arrays.

use crate::errors::bad;
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods, dtype};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sinew::math::{Affine, Rotation, Transform, Vec3};
use sinew::physics::Velocity;

/// Makes an array of `shape` with these elements.
pub fn array<'py, T: numpy::Element>(
    py: Python<'py>,
    elements: Vec<T>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    PyArray1::from_vec(py, elements).reshape(shape.to_vec())
}

/// Returns the elements of a value that numpy converts to an array of this shape; `None` is a free length.
pub fn elements<T: numpy::Element + Copy>(
    given: &Bound<'_, PyAny>,
    shape: &[Option<usize>],
    name: &str,
) -> PyResult<Vec<T>> {
    let py = given.py();
    let keywords = PyDict::new(py);
    keywords.set_item("dtype", dtype::<T>(py))?;
    let array = py.import("numpy")?.call_method("ascontiguousarray", (given,), Some(&keywords))?;
    let array: PyReadonlyArrayDyn<'_, T> = array.extract()?;
    let fits = array.ndim() == shape.len()
        && array.shape().iter().zip(shape).all(|(have, want)| want.is_none_or(|want| want == *have));
    if !fits {
        let want: Vec<String> = shape.iter().map(|n| n.map_or("n".to_owned(), |n| n.to_string())).collect();
        return Err(bad(format!("{name} has shape {:?}, must be ({})", array.shape(), want.join(", "))));
    }
    Ok(array.as_slice()?.to_vec())
}

/// Returns finite numbers, by [`elements`].
pub fn floats(given: &Bound<'_, PyAny>, shape: &[Option<usize>], name: &str) -> PyResult<Vec<f32>> {
    let numbers = elements::<f32>(given, shape, name)?;
    match numbers.iter().position(|number| !number.is_finite()) {
        None => Ok(numbers),
        Some(at) => Err(bad(format!("{name} is not finite: {} at place {at}", numbers[at]))),
    }
}

/// Returns a vector of three finite numbers.
pub fn vec3(given: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec3> {
    let v = floats(given, &[Some(3)], name)?;
    Ok(Vec3::new(v[0], v[1], v[2]))
}

/// Converts rows of three numbers to vectors.
pub fn vectors(numbers: &[f32]) -> Vec<Vec3> {
    numbers.chunks_exact(3).map(|v| Vec3::new(v[0], v[1], v[2])).collect()
}

/// Converts rows of seven numbers to poses: position, and quaternion x, y, z, w, which is normalised.
pub fn poses(numbers: &[f32], name: &str) -> PyResult<Vec<Transform>> {
    let pose = |p: &[f32]| {
        let rotation = Rotation { x: p[3], y: p[4], z: p[5], w: p[6] };
        let length = rotation.length();
        if length.is_nan() || length < 1e-6 {
            return Err(bad(format!("{name}: a quaternion must not be zero")));
        }
        // A unit quaternion keeps its bits, so that setting poses that were read changes no bits.
        let rotation = if (length - 1.0).abs() < 1e-6 { rotation } else { rotation.normalize() };
        Ok(Transform::new(Vec3::new(p[0], p[1], p[2]), rotation))
    };
    numbers.chunks_exact(7).map(pose).collect()
}

/// Appends a pose as seven numbers.
pub fn push_pose(numbers: &mut Vec<f32>, pose: &Transform) {
    let (p, q) = (pose.translation, pose.rotation);
    numbers.extend([p.x, p.y, p.z, q.x, q.y, q.z, q.w]);
}

/// Makes the array of a matrix, (3, 4).
pub fn affine<'py>(py: Python<'py>, matrix: &Affine) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
    let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| matrix.vector(axis));
    let t = matrix.translation;
    array(py, vec![x.x, y.x, z.x, t.x, x.y, y.y, z.y, t.y, x.z, y.z, z.z, t.z], &[3, 4])
}

/// Converts rows of six numbers to velocities: linear and angular.
pub fn velocities(numbers: &[f32]) -> Vec<Velocity> {
    let velocity =
        |v: &[f32]| Velocity { linear: Vec3::new(v[0], v[1], v[2]), angular: Vec3::new(v[3], v[4], v[5]) };
    numbers.chunks_exact(6).map(velocity).collect()
}

/// Appends a velocity as six numbers.
pub fn push_velocity(numbers: &mut Vec<f32>, velocity: &Velocity) {
    numbers.extend(velocity.linear.to_array());
    numbers.extend(velocity.angular.to_array());
}
