use crate::texture::Texture;
use sinew::math::{Vec2, Vec3};
use std::sync::Arc;

/// The complete content of a picture.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Surfaces.
    pub models: Vec<Model>,
    /// Lines drawn over the surfaces, for instance bones, joints and contacts.
    pub lines: Vec<Line>,
    /// Text drawn over everything else.
    pub captions: Vec<Caption>,
    /// The only light with shadows.
    pub sun: Sun,
    /// Ambient light, and background.
    pub sky: Sky,
}

/// Triangles of one material. A vertex array beside `positions` has the same length or is empty.
///
/// A triangle with an index out of range, or a vertex that is not finite or farther than 10⁷ m from the origin, is
/// left out.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// Vertices, world space, metres.
    pub positions: Vec<Vec3>,
    /// Normals of the vertices, world space, any length; empty for flat faces.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, (0, 0) at the top left; or empty.
    pub uvs: Vec<Vec2>,
    /// Linear colour per vertex, multiplied with the material's; or empty.
    pub colors: Vec<[f32; 3]>,
    /// Three indices a triangle, counter-clockwise seen from outside.
    pub indices: Vec<u32>,
    /// Look of the surface.
    pub material: RenderMaterial,
}

/// The look of a surface: matt, lit by the sun and the sky.
#[derive(Clone, Debug)]
pub struct RenderMaterial {
    /// Linear share of reflected light, 0..=1. Default a light grey.
    pub color: [f32; 3],
    /// Opacity from 0 (invisible) to 1 (solid, default). Of several translucent surfaces behind each other only the nearest is
    /// drawn.
    pub opacity: f32,
    /// Texture, which is multiplied with `color`; needs `uvs`. Default none.
    pub texture: Option<Arc<Texture>>,
    /// Pattern. Default plain.
    pub pattern: Pattern,
    /// Sides that are drawn. Default both.
    pub faces: Faces,
    /// Shadow casting. Default yes.
    pub shadow: ShadowCasting,
}

/// Pattern on a surface beside its colour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Pattern {
    /// No pattern.
    #[default]
    Plain,
    /// Squares over the world's x and z, for floors.
    Checker {
        /// Side of a square, metres, above 0.
        size: f32,
        /// Linear colour of every second square, instead of the material's.
        other: [f32; 3],
    },
}

/// Sides of a triangle that are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Faces {
    /// Both sides; the normal is turned to the viewer. Right for cloth, hair and meshes of unknown winding.
    #[default]
    Both,
    /// Only the side on which the corners run counter-clockwise, so that a viewer can look into a room from outside.
    Outside,
}

/// Shadow casting of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShadowCasting {
    /// The surface casts a shadow.
    #[default]
    Yes,
    /// The surface casts no shadow; suitable for floors.
    No,
}

/// A thin straight line in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Start of the line, world space, metres.
    pub from: Vec3,
    /// End of the line, world space, metres.
    pub to: Vec3,
    /// Linear colour.
    pub color: [f32; 3],
    /// Depth test: whether surfaces hide the line.
    pub depth: LineDepth,
}

/// Depth test of a line: whether surfaces in front hide the line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LineDepth {
    /// Surfaces in front of the line hide it.
    #[default]
    Tested,
    /// The line is always visible.
    OnTop,
}

/// A line of text on the picture. Characters outside ASCII 32..=126 show as `?`.
#[derive(Clone, Debug, PartialEq)]
pub struct Caption {
    /// Text of the caption.
    pub text: String,
    /// Column of the left edge, pixels; negative: from the right edge of the picture.
    pub x: i32,
    /// Row of the top edge, pixels; negative: from the bottom of the picture.
    pub y: i32,
    /// Pixels per dot of the 5 × 8 letters, at least 1.
    pub scale: u32,
    /// Linear colour.
    pub color: [f32; 3],
}

/// A light infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Direction from the world toward the sun, any length above 0. Default high, over the left shoulder of a viewer
    /// who looks along −z.
    pub direction: Vec3,
    /// Linear light on a surface that faces the sun. Default a warm white.
    pub color: [f32; 3],
    /// Radius around the camera's target in which shadows are drawn, metres. Default 7; larger is blurrier.
    pub shadow_radius: f32,
}

/// Ambient light, and haze.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Linear colour straight up, and light on surfaces that face up.
    pub zenith: [f32; 3],
    /// Linear colour of the horizon and the haze.
    pub horizon: [f32; 3],
    /// Linear light from below on surfaces that face down.
    pub ground: [f32; 3],
    /// Distance at which haze hides half of a surface, metres. Default 45.
    pub haze_distance: f32,
}

impl Caption {
    /// Creates white text in the upper left corner, two pixels a dot.
    pub fn new(text: impl Into<String>) -> Self {
        Self { text: text.into(), x: 10, y: 10, scale: 2, color: [1.0; 3] }
    }
}

/// Share of the sky's brightness that lights surfaces. It is below 1, as if much of the sky were hidden: visible shadows must
/// be dark.
const SKY_LIGHT: f32 = 0.55;

impl Sky {
    /// Returns the linear light of the sky on a surface that faces up.
    pub fn light_from_above(&self) -> [f32; 3] {
        let Self { zenith, horizon, .. } = self;
        core::array::from_fn(|i| (horizon[i] + (zenith[i] - horizon[i]) * 0.6) * SKY_LIGHT)
    }
}

impl RenderMaterial {
    /// Creates a solid, plain material of one linear colour.
    pub fn new(color: [f32; 3]) -> Self {
        Self { color, ..Self::default() }
    }
}

impl Default for RenderMaterial {
    fn default() -> Self {
        Self {
            color: [0.6; 3],
            opacity: 1.0,
            texture: None,
            pattern: Pattern::Plain,
            faces: Faces::Both,
            shadow: ShadowCasting::Yes,
        }
    }
}

impl Default for Sun {
    fn default() -> Self {
        Self { direction: Vec3::new(-0.45, 0.8, 0.4), color: [1.12, 1.04, 0.92], shadow_radius: 7.0 }
    }
}

impl Default for Sky {
    fn default() -> Self {
        Self {
            zenith: [0.26, 0.44, 0.72],
            horizon: [0.78, 0.85, 0.91],
            ground: [0.13, 0.115, 0.10],
            haze_distance: 45.0,
        }
    }
}
