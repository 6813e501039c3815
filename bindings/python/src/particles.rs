//! Particles: ropes, cloth and soft balls.

use crate::arrays::{array, vec3};
use crate::errors::{bad, guarded, refused};
use crate::world::World;
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use sinew::math::Vec3;
use sinew::physics::GroupId;
use sinew::physics::particles::{AttachmentTarget, BlobDef, ClothDef, GroupDef, RopeDef};

/// Definition of a rope, a cloth or a soft ball.
#[pyclass(frozen, skip_from_py_object, module = "sinew")]
#[derive(Clone)]
pub struct Particles {
    def: GroupDef,
    triangles: Vec<u32>,
    /// Particles, each with the body that holds it.
    held: Vec<(u32, u64)>,
}

impl Particles {
    fn new(def: GroupDef, triangles: Vec<u32>) -> Self {
        Self { def, triangles, held: Vec::new() }
    }

    /// Returns the definition for a world, with the attachments to its bodies.
    pub fn in_world(&self, world: &World) -> PyResult<GroupDef> {
        let mut def = self.def.clone();
        for &(particle, bits) in &self.held {
            let body = world.body(bits)?;
            let point = world.world.transform(body).inverse_point(def.particles[particle as usize].position);
            def.hold(particle, AttachmentTarget::Body { body, point });
        }
        Ok(def)
    }

    pub fn triangles(&self) -> &[u32] {
        &self.triangles
    }
}

#[pymethods]
impl Particles {
    /// Creates a rope between two points, metres.
    #[staticmethod]
    #[pyo3(signature = (start, end, *, links=None, mass=None, radius=None, stiffness=None))]
    fn rope(
        start: &Bound<'_, PyAny>,
        end: &Bound<'_, PyAny>,
        links: Option<u32>,
        mass: Option<f32>,
        radius: Option<f32>,
        stiffness: Option<f32>,
    ) -> PyResult<Self> {
        let (from, to) = (vec3(start, "start")?, vec3(end, "end")?);
        let rope = refused(|| {
            let usual = RopeDef::between(from, to);
            RopeDef {
                links: links.unwrap_or(usual.links),
                mass: mass.unwrap_or(usual.mass),
                radius: radius.unwrap_or(usual.radius),
                stiffness: stiffness.unwrap_or(usual.stiffness),
                ..usual
            }
            .build()
        })?;
        Ok(Self::new(rope.group, Vec::new()))
    }

    /// Creates a rectangle of cloth from a corner along two perpendicular edges, metres.
    #[staticmethod]
    #[pyo3(signature = (corner, across, down, *, columns=None, rows=None, mass=None, hang=false))]
    fn cloth(
        corner: &Bound<'_, PyAny>,
        across: &Bound<'_, PyAny>,
        down: &Bound<'_, PyAny>,
        columns: Option<u32>,
        rows: Option<u32>,
        mass: Option<f32>,
        hang: bool,
    ) -> PyResult<Self> {
        let (corner, across, down) = (vec3(corner, "corner")?, vec3(across, "across")?, vec3(down, "down")?);
        let cloth = refused(|| {
            let usual = ClothDef::sheet(corner, across, down);
            let def = ClothDef {
                columns: columns.unwrap_or(usual.columns),
                rows: rows.unwrap_or(usual.rows),
                mass: mass.unwrap_or(usual.mass),
                ..usual
            };
            let mut cloth = def.build();
            if hang {
                let row = cloth.row(0);
                cloth.hang(&row);
            }
            cloth
        })?;
        let triangles = cloth.group.faces.as_flattened().to_vec();
        Ok(Self::new(cloth.group, triangles))
    }

    /// Creates a soft ball: an elastic skin filled with air.
    #[staticmethod]
    #[pyo3(signature = (center, radius, *, mass=None))]
    fn soft_ball(center: &Bound<'_, PyAny>, radius: f32, mass: Option<f32>) -> PyResult<Self> {
        let center = vec3(center, "center")?;
        let blob = refused(|| {
            let usual = BlobDef::ball(center, radius);
            BlobDef { mass: mass.unwrap_or(usual.mass), ..usual }.build()
        })?;
        let skin = blob.group.volumes.first().map(|skin| skin.triangles.as_flattened().to_vec());
        Ok(Self::new(blob.group, skin.unwrap_or_default()))
    }

    /// Returns a copy in which a particle is held at its position: by a body, or by the world if none is given. A negative particle
    /// counts from the end.
    #[pyo3(signature = (particle, body=None))]
    fn attached(&self, particle: i64, body: Option<u64>) -> PyResult<Self> {
        let count = self.def.particles.len() as i64;
        let index = if particle < 0 { particle + count } else { particle };
        if !(0..count).contains(&index) {
            return Err(bad(format!("there is no particle {particle} of {count}")));
        }
        let (index, mut made) = (index as u32, self.clone());
        match body {
            Some(body) => made.held.push((index, body)),
            None => made.def.hold_in_world(&[index]),
        }
        Ok(made)
    }

    fn __len__(&self) -> usize {
        self.def.particles.len()
    }

    fn __repr__(&self) -> String {
        let (particles, springs) = (self.def.particles.len(), self.def.springs.len());
        format!("Particles({particles} particles, {springs} springs)")
    }
}

/// Particles in a world.
#[pyclass(frozen, module = "sinew")]
pub struct LiveParticles {
    pub world: Py<World>,
    pub group: GroupId,
    pub triangles: Vec<u32>,
}

impl LiveParticles {
    fn read<T>(
        &self,
        py: Python<'_>,
        read: impl FnOnce(&sinew::physics::particles::ParticleGroup) -> T,
    ) -> PyResult<T> {
        let world = self.world.borrow(py);
        self.check(&world)?;
        Ok(read(world.world.particles(self.group)))
    }

    fn check(&self, world: &World) -> PyResult<()> {
        let is_there = world.world.group_ids().any(|group| group == self.group);
        if is_there { Ok(()) } else { Err(bad("the particles were removed")) }
    }

    fn change(
        &self,
        py: Python<'_>,
        particle: u32,
        change: impl FnOnce(&mut sinew::physics::particles::ParticleGroup),
    ) -> PyResult<()> {
        let mut world = self.world.borrow_mut(py);
        self.check(&world)?;
        let group = world.world.particles_mut(self.group);
        let count = group.positions().len();
        if particle as usize >= count {
            return Err(bad(format!("there is no particle {particle} of {count}")));
        }
        guarded(|| change(group))
    }
}

#[pymethods]
impl LiveParticles {
    /// Positions of all particles, (n, 3), metres.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        rows(py, &self.read(py, |group| group.positions().to_vec())?)
    }

    /// Velocities of all particles, (n, 3), m/s.
    #[getter]
    fn velocities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        rows(py, &self.read(py, |group| group.velocities().to_vec())?)
    }

    /// Triangles of the surface, (t, 3); empty for a rope.
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<u32>>> {
        array(py, self.triangles.clone(), &[self.triangles.len() / 3, 3])
    }

    /// Applies an impulse to a particle, N·s.
    fn push(&self, py: Python<'_>, particle: u32, impulse: &Bound<'_, PyAny>) -> PyResult<()> {
        let impulse = vec3(impulse, "impulse")?;
        self.change(py, particle, |group| group.apply_impulse(particle, impulse))
    }

    /// Moves a particle, metres.
    fn set_position(&self, py: Python<'_>, particle: u32, position: &Bound<'_, PyAny>) -> PyResult<()> {
        let position = vec3(position, "position")?;
        self.change(py, particle, |group| group.set_position(particle, position))
    }

    /// Removes the particles from the world.
    fn remove(&self, py: Python<'_>) -> PyResult<()> {
        let mut world = self.world.borrow_mut(py);
        self.check(&world)?;
        guarded(|| world.world.remove_particles(self.group))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("LiveParticles({})", self.read(py, |group| group.positions().len())?))
    }
}

fn rows<'py>(py: Python<'py>, vectors: &[Vec3]) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
    array(py, vectors.iter().flat_map(|v| v.to_array()).collect(), &[vectors.len(), 3])
}
