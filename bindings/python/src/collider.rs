//! Bodies of a world besides characters: shapes, meshes, and keyframed bodies.

use crate::arrays::{elements, floats, poses, vectors};
use crate::errors::{bad, guarded, of_file};
use crate::world::shape;
use pyo3::prelude::*;
use sinew::formats::load_world;
use sinew::geometry::{Hull, Mesh};
use sinew::math::Transform;
use sinew::physics::{BodyDef, BodyKind, Material, Shape, ShapeDef};
use sinew::ragdoll::BakeMover;
use std::path::PathBuf;
use std::sync::Arc;

/// Body of a world: a shape or a mesh, static, dynamic, or moved by keyframes.
#[pyclass(frozen, skip_from_py_object, module = "sinew")]
#[derive(Clone)]
pub struct Collider {
    pub def: BodyDef,
    /// Times and poses of the keyframes, if there are any.
    pub keys: Option<(Vec<f32>, Vec<Transform>)>,
}

fn place(pose: Option<&Bound<'_, PyAny>>) -> PyResult<Transform> {
    Ok(match pose {
        Some(pose) => poses(&floats(pose, &[Some(7)], "pose")?, "pose")?[0],
        None => Transform::IDENTITY,
    })
}

fn collider(
    shape: Shape,
    pose: Option<&Bound<'_, PyAny>>,
    friction: f32,
    restitution: f32,
) -> PyResult<Collider> {
    let at = place(pose)?;
    let material = Material { friction, restitution, ..Material::DEFAULT };
    let def = BodyDef {
        kind: BodyKind::Static,
        position: at.translation,
        rotation: at.rotation,
        shapes: vec![ShapeDef { material, ..ShapeDef::new(shape) }],
        ..BodyDef::default()
    };
    Ok(Collider { def, keys: None })
}

#[pymethods]
impl Collider {
    /// Creates a body from a kind of shape and sizes in metres, as in `World.add_body`.
    #[new]
    #[pyo3(signature = (kind, size, *, pose=None, friction=0.6, restitution=0.0))]
    fn new(
        kind: &str,
        size: Vec<f32>,
        pose: Option<&Bound<'_, PyAny>>,
        friction: f32,
        restitution: f32,
    ) -> PyResult<Self> {
        collider(shape(kind, &size)?, pose, friction, restitution)
    }

    /// Creates a floor: all points below a height, metres, are solid.
    #[staticmethod]
    #[pyo3(signature = (height=0.0, *, friction=0.6))]
    fn floor(height: f32, friction: f32) -> PyResult<Self> {
        let mut floor = collider(Shape::HalfSpace, None, friction, 0.0)?;
        floor.def.position.y = height;
        Ok(floor)
    }

    /// Creates a surface of triangles: vertices (v, 3) in metres, triangles (t, 3), counter-clockwise seen from
    /// outside.
    #[staticmethod]
    #[pyo3(signature = (vertices, triangles, *, pose=None, friction=0.6, restitution=0.0))]
    fn mesh(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        triangles: &Bound<'_, PyAny>,
        pose: Option<&Bound<'_, PyAny>>,
        friction: f32,
        restitution: f32,
    ) -> PyResult<Self> {
        let vertices = vectors(&floats(vertices, &[None, Some(3)], "vertices")?);
        let corners: Vec<u32> = elements(triangles, &[None, Some(3)], "triangles")?;
        let triangles: Vec<[u32; 3]> = corners.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
        let mesh = py.detach(|| guarded(|| Mesh::new(&vertices, &triangles)))?;
        let mesh = mesh.map_err(|what| bad(what.to_string()))?;
        collider(Shape::Mesh(Arc::new(mesh)), pose, friction, restitution)
    }

    /// Creates the convex hull of points (n, 3), metres.
    #[staticmethod]
    #[pyo3(signature = (points, *, pose=None, friction=0.6, restitution=0.0))]
    fn hull(
        points: &Bound<'_, PyAny>,
        pose: Option<&Bound<'_, PyAny>>,
        friction: f32,
        restitution: f32,
    ) -> PyResult<Self> {
        let points = vectors(&floats(points, &[None, Some(3)], "points")?);
        let hull = guarded(|| Hull::new(&points))?.map_err(|what| bad(what.to_string()))?;
        collider(Shape::Hull(Arc::new(hull)), pose, friction, restitution)
    }

    /// Reads all bodies of a world file (.json) or a mesh (.glb, .obj).
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Vec<Self>> {
        let bodies = load_world(&path).map_err(of_file)?;
        Ok(bodies.into_iter().map(|def| Self { def, keys: None }).collect())
    }

    /// Returns a dynamic copy; density in kg/m³.
    #[pyo3(signature = (*, density=1000.0))]
    fn dynamic(&self, density: f32) -> PyResult<Self> {
        let mut def = BodyDef { kind: BodyKind::Dynamic, ..self.def.clone() };
        def.shapes.iter_mut().for_each(|shape| shape.density = density);
        if def.shapes.iter().any(|shape| matches!(shape.shape, Shape::Mesh(_) | Shape::HalfSpace)) {
            return Err(bad("a mesh or a half-space has no mass: it must be static or keyed"));
        }
        Ok(Self { def, keys: None })
    }

    /// Returns a copy that moves to poses (n, 7) at times (n,) in seconds, through obstacles.
    fn keyed(&self, times: &Bound<'_, PyAny>, poses: &Bound<'_, PyAny>) -> PyResult<Self> {
        let times = floats(times, &[None], "times")?;
        let keys = crate::arrays::poses(&floats(poses, &[Some(times.len()), Some(7)], "poses")?, "poses")?;
        if times.is_empty() || !times.is_sorted() {
            return Err(bad("times of keys must ascend, and at least one is needed"));
        }
        if self.def.shapes.iter().any(|shape| shape.shape == Shape::HalfSpace) {
            return Err(bad("a half-space must be static"));
        }
        Ok(Self { def: self.def.clone(), keys: Some((times, keys)) })
    }

    fn __repr__(&self) -> String {
        let kind = if self.keys.is_some() {
            "Keyed"
        } else {
            ["Static", "Kinematic", "Dynamic"][self.def.kind as usize]
        };
        format!("Collider({} shapes, {})", self.def.shapes.len(), kind.to_lowercase())
    }
}

/// Returns the bodies of a bake's world, from a file's name or colliders; by default a floor.
pub fn world_of(given: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<Collider>> {
    let Some(given) = given else { return Ok(vec![Collider::floor(0.0, Material::DEFAULT.friction)?]) };
    if let Ok(path) = given.extract::<PathBuf>() {
        return Collider::load(path);
    }
    let list: Vec<PyRef<'_, Collider>> =
        given.extract().map_err(|_| bad("a world is the name of a file, or a list of Collider"))?;
    Ok(list.iter().map(|collider| Collider::clone(collider)).collect())
}

/// Separates static and dynamic bodies from keyframed bodies.
pub fn parted(colliders: &[Collider]) -> (Vec<BodyDef>, Vec<BakeMover<'_>>) {
    let still = colliders.iter().filter(|collider| collider.keys.is_none());
    let keyed = colliders.iter().filter_map(|collider| {
        let (times, poses) = collider.keys.as_ref()?;
        Some(BakeMover { body: collider.def.clone(), times, poses })
    });
    (still.map(|collider| collider.def.clone()).collect(), keyed.collect())
}
