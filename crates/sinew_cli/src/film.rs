//! Moving pictures of a fall.

use crate::fall::Fall;
use crate::progress::Progress;
use crate::skin;
use crate::story;
use sinew::anim::{Wrap, local_to_model, sample};
use sinew::math::{Affine, Rotation, Transform, Vec3};
use sinew::physics::{BodyDef, Shape};
use sinew_picture::draw;
use sinew_picture::{
    Caption, EncodeError, FollowCamera, Image, Material, Model, Movie, PictureFormat, RenderSettings,
    Renderer, Scene, Sun,
};

/// Pictures a second: a whole number of a GIF's hundredths of a second, and enough to follow a fall.
const FPS: u32 = 20;
/// Seconds for which a hit's arrow is shown.
const ARROW_SECONDS: f32 = 0.35;
const ARROW_COLOR: [f32; 3] = [0.85, 0.06, 0.03];

/// What is filmed, and from where.
pub struct Film<'a> {
    /// The fall.
    pub fall: &'a Fall<'a>,
    /// What stands around.
    pub set: Vec<Model>,
    /// From the character to the camera.
    pub direction: Vec3,
    /// What the camera shows around the character, metres.
    pub radius: f32,
    /// Light.
    pub sun: Sun,
}

impl Film<'_> {
    /// The bytes of a picture file.
    pub fn shoot(self, format: PictureFormat) -> Result<Vec<u8>, EncodeError> {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let mut renderer = Renderer::new(RenderSettings { threads, ..RenderSettings::default() });
        let mut movie = Movie::new(format, FPS);
        let frames = (self.fall.input.seconds * FPS as f32) as u32 + 1;
        let progress = Progress::new("drawing", frames as usize);
        let mut shots = Shots::new(self);
        for frame in 0..frames {
            movie.push(&shots.shoot(&mut renderer, frame as f32 / FPS as f32))?;
            progress.step();
        }
        movie.finish()
    }
}

/// A film on its way.
struct Shots<'a> {
    fall: &'a Fall<'a>,
    scene: Scene,
    /// Models of the scene that stay from picture to picture; the character's come after them.
    standing: usize,
    looks: Vec<Material>,
    phases: Vec<story::Phase>,
    camera: Option<FollowCamera>,
    direction: Vec3,
    radius: f32,
    /// The character at the time: joints and bodies, in the world.
    model: Vec<Affine>,
    bodies: Vec<Transform>,
}

impl<'a> Shots<'a> {
    fn new(film: Film<'a>) -> Self {
        let Film { fall, set, direction, radius, sun } = film;
        let rig = &fall.input.character.rig;
        Self {
            fall,
            standing: set.len(),
            scene: Scene { models: set, sun, ..Scene::default() },
            looks: skin::looks(rig),
            phases: story::phases(&fall.input.character, &fall.baked.events),
            camera: None,
            direction,
            radius,
            model: Vec::new(),
            bodies: Vec::new(),
        }
    }

    fn shoot(&mut self, renderer: &mut Renderer, time: f32) -> Image {
        self.pose(time);
        self.scene.models.truncate(self.standing);
        self.add_character();
        self.add_arrows(time);
        let subject = self.middle();
        let (direction, radius) = (self.direction, self.radius);
        let camera = self.camera.get_or_insert_with(|| FollowCamera::new(subject, radius, direction));
        camera.update(subject, 1.0 / FPS as f32);
        let phase = self.phases.iter().rev().find(|(since, _)| *since <= time).map_or("", |(_, what)| what);
        self.scene.captions = vec![Caption::new(format!("{time:5.2} s  {phase}"))];
        renderer.render(&self.scene, &camera.camera())
    }

    fn pose(&mut self, time: f32) {
        let Fall { input, baked, .. } = self.fall;
        let character = &input.character;
        let mut local = character.rest().to_vec();
        sample(&baked.clip, &character.rig, time, Wrap::Clamp, &mut local);
        local_to_model(&character.rig, &local, &Affine::IDENTITY, &mut self.model);
        character.mapping().bodies_from_model(&self.model, input.world_from_character, &mut self.bodies);
        for joint in &mut self.model {
            *joint = baked.world_from_model * *joint;
        }
    }

    /// The middle of the box around all bodies, in the world.
    fn middle(&self) -> Vec3 {
        let bodies = &self.fall.input.character.ragdoll.bodies;
        let boxes = bodies.iter().zip(&self.bodies).map(|(body, place)| body.shape.aabb(place));
        boxes.reduce(|all, one| all.merge(&one)).map_or(Vec3::ZERO, |all| all.center())
    }

    fn add_character(&mut self) {
        self.scene.models.extend(skin::models(&self.fall.input.character.rig, &self.model, &self.looks));
    }

    /// An arrow for each hit that has just happened, its tip where it struck.
    fn add_arrows(&mut self, time: f32) {
        for hit in self.fall.input.hits {
            let since = time - hit.time;
            if (0.0..ARROW_SECONDS).contains(&since) && hit.impulse.length() > 0.0 {
                let tip = self.bodies[hit.body].translation;
                self.scene.models.extend(arrow(tip, hit.impulse.normalize()));
            }
        }
    }
}

/// A shaft and a head that end at `tip`, along the unit vector `along`.
fn arrow(tip: Vec3, along: Vec3) -> [Model; 2] {
    let turn = Rotation::from_arc(Vec3::Y, along);
    let part = |behind: f32, shape: Shape| {
        draw::shape(&shape, Transform::new(tip - along * behind, turn), Material::new(ARROW_COLOR))
    };
    [
        part(0.55, Shape::Capsule { half_height: 0.3, radius: 0.025 }),
        part(0.22, Shape::Capsule { half_height: 0.02, radius: 0.07 }),
    ]
}

/// How much of a floor without end is drawn, metres to each side: as far as the haze lets see.
pub const FLOOR_HALF_SIZE: f32 = 40.0;

/// The surface of a body of the world in one colour (linear); half-spaces become floors, `half_size` metres to each
/// side, with a checker of `other`.
pub fn body_models(body: &BodyDef, half_size: f32, color: [f32; 3], other: [f32; 3]) -> Vec<Model> {
    let world_from_body = Transform::new(body.position, body.rotation);
    let model = |shape: &sinew::physics::ShapeDef| {
        let place = world_from_body * shape.body_from_shape;
        match &shape.shape {
            Shape::HalfSpace => draw::plane(place, half_size, 1.0, [color, other]),
            shape => draw::shape(shape, place, Material::new(color)),
        }
    };
    body.shapes.iter().map(model).collect()
}
