use crate::texture::Texture;
use sinew::math::{Vec2, Vec3};
use std::sync::Arc;

/// The complete content of a picture.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Surfaces.
    pub models: Vec<Model>,
    /// Lines over the surfaces: bones, joints, contacts.
    pub lines: Vec<Line>,
    /// Text over everything.
    pub captions: Vec<Caption>,
    /// The one light with shadows.
    pub sun: Sun,
    /// Ambient light, and the background.
    pub sky: Sky,
}

/// Triangles of one material. A vertex array beside `positions` has its length or is empty.
///
/// A triangle with an index out of range, or a vertex that is not finite or farther than 10⁷ m from the origin, is
/// left out.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// World space, metres.
    pub positions: Vec<Vec3>,
    /// World space, any length; empty for flat faces.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, (0, 0) at the top left; or empty.
    pub uvs: Vec<Vec2>,
    /// Linear colour per vertex, multiplied with the material's; or empty.
    pub colors: Vec<[f32; 3]>,
    /// Three a triangle, counter-clockwise seen from outside.
    pub indices: Vec<u32>,
    /// Look of its surface.
    pub material: RenderMaterial,
}

/// The look of a surface: matt, lit by the sun and the sky.
#[derive(Clone, Debug)]
pub struct RenderMaterial {
    /// Linear share of the reflected light, 0..=1. Default a light grey.
    pub color: [f32; 3],
    /// 0 (unseen) to 1 (solid, default). Of several translucent surfaces in a line only the nearest is seen.
    pub opacity: f32,
    /// Multiplied with `color`; needs `uvs`. Default none.
    pub texture: Option<Arc<Texture>>,
    /// Default plain.
    pub pattern: Pattern,
    /// Default both.
    pub faces: Faces,
    /// Default yes.
    pub shadow: ShadowCasting,
}

/// Pattern on a surface beside its colour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Pattern {
    /// Nothing.
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
    /// Both; the normal is turned to the viewer. Right for cloth, hair and meshes of unknown winding.
    #[default]
    Both,
    /// The face is visible only where its corners run counter-clockwise, so that a viewer can look into a room from
    /// outside.
    Outside,
}

/// Shadow casting of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShadowCasting {
    /// It does.
    #[default]
    Yes,
    /// It does not: right for floors with nothing below.
    No,
}

/// A thin straight line in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// World space, metres.
    pub from: Vec3,
    /// World space, metres.
    pub to: Vec3,
    /// Linear.
    pub color: [f32; 3],
    /// Depth test: whether surfaces hide it.
    pub depth: LineDepth,
}

/// Depth test of a line: whether surfaces in front of it hide it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LineDepth {
    /// Hidden behind surfaces.
    #[default]
    Tested,
    /// The lines are always visible.
    OnTop,
}

/// A line of text on the picture. Characters outside ASCII 32..=126 show as `?`.
#[derive(Clone, Debug, PartialEq)]
pub struct Caption {
    /// Text of the caption.
    pub text: String,
    /// Column of its left edge; from the right edge of the picture where negative. Pixels.
    pub x: i32,
    /// Row of its top edge; from the bottom of the picture where negative. Pixels.
    pub y: i32,
    /// Pixels per dot of the 5 × 8 letters, at least 1.
    pub scale: u32,
    /// Linear.
    pub color: [f32; 3],
}

/// A light infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Direction from the world toward the sun, any length above 0. Default high, over the left shoulder of a viewer
    /// who looks along −z.
    pub direction: Vec3,
    /// Linear light on a surface that faces it. Default a warm white.
    pub color: [f32; 3],
    /// Radius in metres around the camera's target in which things throw shadows. Default 7: larger is blurrier.
    pub shadow_radius: f32,
}

/// Light from everywhere, and the distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Linear colour straight up, also the light on surfaces that face up.
    pub zenith: [f32; 3],
    /// Linear colour at the horizon and of the haze before it.
    pub horizon: [f32; 3],
    /// Linear light from below on surfaces that face down.
    pub ground: [f32; 3],
    /// Metres at which haze hides half of a surface. Default 45.
    pub haze_distance: f32,
}

impl Caption {
    /// White text in the upper left corner, two pixels a dot.
    pub fn new(text: impl Into<String>) -> Self {
        Self { text: text.into(), x: 10, y: 10, scale: 2, color: [1.0; 3] }
    }
}

/// Share of the sky's brightness that falls on things. Less than all, as if much of it were hidden: shadows need to be dark to
/// be read.
const SKY_LIGHT: f32 = 0.55;

impl Sky {
    /// Linear light of the sky on a surface that faces up.
    pub fn light_from_above(&self) -> [f32; 3] {
        let Self { zenith, horizon, .. } = self;
        core::array::from_fn(|i| (horizon[i] + (zenith[i] - horizon[i]) * 0.6) * SKY_LIGHT)
    }
}

impl RenderMaterial {
    /// Solid, plain, of one linear colour.
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
