//! Movers: upright capsules that walk, climb steps and jump.

use crate::arrays::vec3;
use crate::errors::{bad, guarded, refused};
use crate::world::World;
use numpy::PyArray1;
use pyo3::prelude::*;
use sinew::physics::MoverId;

/// Mover in a world.
#[pyclass(frozen, module = "sinew")]
pub struct Mover {
    pub world: Py<World>,
    pub id: MoverId,
}

impl Mover {
    fn read<T>(&self, py: Python<'_>, read: impl FnOnce(&sinew::physics::Mover) -> T) -> PyResult<T> {
        let world = self.world.borrow(py);
        self.check(&world)?;
        Ok(read(world.world.mover(self.id)))
    }

    fn check(&self, world: &World) -> PyResult<()> {
        if world.world.contains_mover(self.id) { Ok(()) } else { Err(bad("the mover was removed")) }
    }

    fn act<T>(
        &self,
        py: Python<'_>,
        act: impl FnOnce(&mut sinew::physics::World, MoverId) -> T,
    ) -> PyResult<T> {
        let mut world = self.world.borrow_mut(py);
        self.check(&world)?;
        refused(|| act(&mut world.world, self.id))
    }
}

#[pymethods]
impl Mover {
    /// Lowest point of the mover, (3,), metres.
    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let at = self.read(py, sinew::physics::Mover::position)?;
        Ok(PyArray1::from_vec(py, at.to_array().to_vec()))
    }

    /// Velocity, (3,), m/s.
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let velocity = self.read(py, sinew::physics::Mover::velocity)?;
        Ok(PyArray1::from_vec(py, velocity.to_array().to_vec()))
    }

    /// True if the mover stands on the ground.
    #[getter]
    fn grounded(&self, py: Python<'_>) -> PyResult<bool> {
        self.read(py, sinew::physics::Mover::is_grounded)
    }

    /// Id of the body that the mover stands on; None in the air and on another mover.
    #[getter]
    fn ground(&self, py: Python<'_>) -> PyResult<Option<u64>> {
        let world = self.world.borrow(py);
        self.check(&world)?;
        let ground = world.world.mover_ground(self.id);
        Ok(ground.and_then(|ground| ground.shape).map(|shape| shape.body.to_bits()))
    }

    /// Sets the walking velocity relative to the ground, m/s.
    fn walk(&self, py: Python<'_>, velocity: &Bound<'_, PyAny>) -> PyResult<()> {
        let velocity = vec3(velocity, "velocity")?;
        self.act(py, |world, id| world.set_mover_walk(id, velocity))
    }

    /// Makes the mover jump in the next step with an upward speed, m/s, if it is on the ground.
    #[pyo3(signature = (speed=3.5))]
    fn jump(&self, py: Python<'_>, speed: f32) -> PyResult<()> {
        self.act(py, |world, id| world.mover_jump(id, speed))
    }

    /// Throws the mover: it leaves the ground with a velocity, m/s.
    fn launch(&self, py: Python<'_>, velocity: &Bound<'_, PyAny>) -> PyResult<()> {
        let velocity = vec3(velocity, "velocity")?;
        self.act(py, |world, id| world.set_mover_velocity(id, velocity))
    }

    /// Teleports the mover's lowest point to a position, metres.
    fn teleport(&self, py: Python<'_>, position: &Bound<'_, PyAny>) -> PyResult<()> {
        let position = vec3(position, "position")?;
        self.act(py, |world, id| world.set_mover_position(id, position))
    }

    /// Changes the height, metres; returns false if there is no space to grow.
    fn set_height(&self, py: Python<'_>, height: f32) -> PyResult<bool> {
        self.act(py, |world, id| world.set_mover_height(id, height))
    }

    /// Removes the mover from the world.
    fn remove(&self, py: Python<'_>) -> PyResult<()> {
        let mut world = self.world.borrow_mut(py);
        self.check(&world)?;
        guarded(|| world.world.remove_mover(self.id))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let at = self.read(py, sinew::physics::Mover::position)?;
        Ok(format!("Mover(at {:.2} {:.2} {:.2})", at.x, at.y, at.z))
    }
}
