//! Pipeline from triangles to colours: clipped, rasterised, shadowed, shaded.

pub(crate) mod clip;
pub(crate) mod raster;
pub(crate) mod shade;
pub(crate) mod shadow;
