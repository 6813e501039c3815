//! Software-rendered pictures without a graphics driver, the same on every target.
//!
//! Plain data in, pixels out: describe a [`Scene`] (models come from [`draw`] or from any mesh), place a [`Camera`], and
//! [`Renderer::render`] returns an [`Image`]. [`Movie`] converts images to a GIF, APNG or WebP file. All numbers are computed by `+ − × ÷
//! √` and by `sinew::math`, so the same scene has the same bits on every target.
//!
//! World space is right-handed with +Y up, in metres; colours are linear unless a name says sRGB.
#![forbid(unsafe_code)]

mod camera;
mod color;
pub mod draw;
pub mod encode;
mod image;
mod overlay;
mod pipeline;
mod render;
mod scene;
mod texture;
pub mod world;

pub use camera::{Camera, FollowCamera, NEAR, PictureAxes};
pub use encode::{EncodeError, Movie, PictureFormat};
pub use image::Image;
pub use overlay::add_captions;
pub use render::{Antialiasing, RenderSettings, Renderer};
pub use scene::{
    Caption, Faces, Line, LineDepth, Model, Pattern, RenderMaterial, Scene, ShadowCasting, Sky, Sun,
};
pub use texture::{Texture, TextureError};
