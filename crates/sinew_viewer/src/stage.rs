//! Content of a picture: bodies by their shapes, characters by their skins, and additional drawings of a
//! scene.

use sinew::math::{Transform, Vec3, normalize_or};
use sinew::physics::Shape;
use sinew_picture::world::Canvas;
use sinew_picture::{Line, Model, Scene};
use sinew_scenes::scenes::Figure;

/// Complete content of a picture. All shapes of a kind are drawn by one call.
#[derive(Debug, Default)]
pub struct Stage<'a> {
    /// Surfaces, lines, text, sun and sky.
    pub scene: Scene,
    /// Characters, drawn by their skins.
    pub figures: Vec<Figure<'a>>,
    pub(crate) solids: Vec<Solid>,
}

impl Stage<'_> {
    /// Returns a stage with the content of a scene.
    pub fn of(scene: Scene) -> Self {
        Self { scene, ..Self::default() }
    }
}

/// A surface with a common mesh.
#[derive(Debug)]
pub(crate) struct Solid {
    pub form: Form,
    pub place: Transform,
    /// Scale along the axes of `place`.
    pub scale: Vec3,
    /// Linear colour.
    pub color: [f32; 3],
}

/// Surface before it is scaled.
#[derive(Debug)]
pub(crate) enum Form {
    Shape(Shape),
    /// A ball of radius 1 with eight fields.
    Fields,
    /// A ball of radius 1.
    Ball,
    /// A cube with half extents of 1.
    Cube,
    /// A cylinder with a radius and half height of 1.
    Cylinder,
    /// A cone with a base radius and half height of 1.
    Cone,
}

impl Canvas for Stage<'_> {
    fn solid(&mut self, shape: &Shape, place: Transform, color: [f32; 3]) {
        let (form, scale) = match *shape {
            Shape::Box { half_extents } => (Form::Cube, half_extents),
            Shape::Sphere { radius } => (Form::Ball, Vec3::splat(radius)),
            Shape::Cylinder { half_height, radius } => {
                (Form::Cylinder, Vec3::new(radius, half_height, radius))
            }
            Shape::Cone { half_height, radius } => (Form::Cone, Vec3::new(radius, half_height, radius)),
            _ => (Form::Shape(shape.clone()), Vec3::ONE),
        };
        self.solids.push(Solid { form, place, scale, color });
    }

    fn ball(&mut self, radius: f32, place: Transform, color: [f32; 3]) {
        self.solids.push(Solid { form: Form::Fields, place, scale: Vec3::splat(radius), color });
    }

    fn rod(&mut self, from: Vec3, to: Vec3, radius: f32, color: [f32; 3]) {
        let along = to - from;
        let turn = sinew::math::Rotation::from_arc(Vec3::Y, normalize_or(along, Vec3::Y));
        let place = Transform::new((from + to) * 0.5, turn);
        let scale = Vec3::new(radius, 0.5 * along.length(), radius);
        self.solids.push(Solid { form: Form::Cylinder, place, scale, color });
    }

    fn model(&mut self, model: Model) {
        self.scene.models.push(model);
    }

    fn line(&mut self, line: Line) {
        self.scene.lines.push(line);
    }
}
