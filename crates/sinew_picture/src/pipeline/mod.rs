//! Pipeline from triangles to colours: clipping, rasterising, shadows, shading.

pub(crate) mod clip;
pub(crate) mod raster;
pub(crate) mod shade;
pub(crate) mod shadow;
