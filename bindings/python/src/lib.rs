//! Sinew for Python: the module `sinew._sinew` of the package `sinew`. docs/python.md of the repository is the guide.
// `forbid` would reject the macros of PyO3, whose code is `unsafe`; our own sources have no unsafe code.
#![deny(unsafe_code)]

mod arrays;
mod bake;
mod batch;
mod character_settings;
mod collider;
mod drive;
mod errors;
mod field;
mod file;
mod live;
mod mover;
mod particles;
mod ragdoll;
mod rig_arrays;
mod world;

use pyo3::prelude::*;

#[pymodule]
fn _sinew(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("SinewError", module.py().get_type::<errors::SinewError>())?;
    module.add("FileError", module.py().get_type::<errors::FileError>())?;
    module.add_class::<file::CharacterFile>()?;
    module.add_class::<ragdoll::Ragdoll>()?;
    module.add_class::<ragdoll::Model>()?;
    module.add_class::<bake::Character>()?;
    module.add("Cancelled", module.py().get_type::<errors::Cancelled>())?;
    module.add_class::<bake::Actor>()?;
    module.add_class::<bake::Bake>()?;
    module.add_class::<collider::Collider>()?;
    module.add_class::<drive::Drive>()?;
    module.add_class::<field::Field>()?;
    module.add_class::<particles::Particles>()?;
    module.add_class::<particles::LiveParticles>()?;
    module.add_class::<mover::Mover>()?;
    module.add_class::<live::LiveCharacter>()?;
    module.add_class::<world::World>()?;
    module.add_class::<batch::BatchWorlds>()?;
    module.add_function(wrap_pyfunction!(file::load, module)?)?;
    module.add_function(wrap_pyfunction!(file::load_bytes, module)?)?;
    module.add_function(wrap_pyfunction!(file::load_arrays, module)?)?;
    module.add_function(wrap_pyfunction!(bake::bake, module)?)?;
    module.add_function(wrap_pyfunction!(file::mannequin, module)?)?;
    module.add_function(wrap_pyfunction!(ragdoll::load_ragdoll, module)?)?;
    module.add_function(wrap_pyfunction!(ragdoll::load_model, module)?)
}
