//! Software-rendered pictures without a graphics driver, the same on every target.
//!
//! ```
//! use sinew::math::{Transform, Vec3};
//! use sinew::physics::Shape;
//! use sinew_picture::{Camera, PictureFormat, RenderMaterial, RenderSettings, Renderer, Scene, draw, encode};
//!
//! let place = Transform::from_translation(Vec3::Y * 0.5);
//! let ball = draw::shape(&Shape::sphere(0.5), place, RenderMaterial::new([0.6, 0.1, 0.1]));
//! let floor = draw::floor(Vec3::ZERO, 5.0, [0.4; 3], [0.3; 3]);
//! let scene = Scene { models: vec![floor, ball], ..Scene::default() };
//! let camera = Camera::framing(place.translation, 1.0, Vec3::new(1.0, 0.5, 1.0));
//! let settings = RenderSettings { width: 160, height: 90, ..RenderSettings::default() };
//! let image = Renderer::new(settings).render(&scene, &camera);
//! let png = encode::encode(PictureFormat::Png, &[image], 1)?;
//! assert!(png.starts_with(b"\x89PNG"));
//! # Ok::<(), sinew_picture::EncodeError>(())
//! ```
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
