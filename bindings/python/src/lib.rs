//! Sinew for Python: the module `sinew._sinew`, which the package `sinew` is made of. docs/python.md of the repository is the guide.
// `forbid` would refuse the macros of PyO3, whose code is `unsafe`; no source of ours is.
#![deny(unsafe_code)]

mod arrays;
mod bake;
mod batch;
mod errors;
mod file;
mod ragdoll;
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
    module.add_class::<bake::Bake>()?;
    module.add_class::<world::World>()?;
    module.add_class::<batch::BatchWorlds>()?;
    module.add_function(wrap_pyfunction!(file::load, module)?)?;
    module.add_function(wrap_pyfunction!(file::mannequin, module)?)?;
    module.add_function(wrap_pyfunction!(ragdoll::load_ragdoll, module)?)?;
    module.add_function(wrap_pyfunction!(ragdoll::load_model, module)?)
}
