//! Films of a fall.

use crate::fall::Fall;
use crate::render::framing::{Framing, haze_distance};
use crate::render::skin;
use crate::report::progress::Progress;
use crate::report::story;
use sinew::anim::{Wrap, local_to_model, sample};
use sinew::math::{Affine, Rotation, Transform, Vec3, min};
use sinew::physics::boxes::Aabb;
use sinew::physics::ray::Ray;
use sinew::physics::{BodyDef, BodyKind, BodyKinds, QueryFilter, Shape, World, WorldDef};
use sinew::ragdoll::quality::fallen_out;
use sinew_picture::draw;
use sinew_picture::{
    Caption, EncodeError, FollowCamera, Image, Model, Movie, PictureFormat, RenderMaterial, RenderSettings,
    Renderer, Scene, Sun,
};

/// Default width and height of a film in pixels.
pub const FILM_SIZE: [u32; 2] = [640, 360];

/// Pictures per second: a whole number of a GIF's hundredths of a second, and enough to follow a fall.
const FPS: u32 = 20;
/// Seconds for which a hit's arrow is shown.
const ARROW_SECONDS: f32 = 0.35;
const ARROW_COLOR: [f32; 3] = [0.85, 0.06, 0.03];

/// Subject of a film, and its camera direction.
pub struct Film<'a> {
    /// The fall.
    pub fall: &'a Fall<'a>,
    /// Start time, seconds.
    pub from: f32,
    /// Models of the static surroundings.
    pub set: Vec<Model>,
    /// Direction from the character to the camera.
    pub direction: Vec3,
    /// View of the film's camera.
    pub view: View,
    /// Light of the scene.
    pub sun: Sun,
}

/// View of a camera on a fall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// A ball of that radius (metres) around the character, which the camera follows.
    Around(f32),
    /// The whole character over its whole path, from the side with the least occlusion.
    Whole,
}

impl Film<'_> {
    /// Returns the bytes of a picture file of this many pixels across and down.
    pub fn shoot(self, format: PictureFormat, [width, height]: [u32; 2]) -> Result<Vec<u8>, EncodeError> {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let settings = RenderSettings { width, height, threads, ..RenderSettings::default() };
        let mut renderer = Renderer::new(settings);
        let mut movie = Movie::new(format, FPS);
        let frames = (self.fall.input.seconds * FPS as f32) as u32 + 1;
        let first = (self.from * FPS as f32) as u32;
        let progress = Progress::new("drawing", (frames - first) as usize);
        let mut shots = Shots::new(self, frames);
        for frame in first..frames {
            movie.push(&shots.shoot(&mut renderer, frame))?;
            progress.step();
        }
        movie.finish()
    }
}

/// Mode of the camera.
enum Shooting {
    Following { radius: f32, camera: Option<FollowCamera> },
    Framing(Framing),
}

/// A film in progress.
struct Shots<'a> {
    fall: &'a Fall<'a>,
    scene: Scene,
    /// Number of scene models that persist from picture to picture; the models of the character follow.
    standing: usize,
    looks: Vec<RenderMaterial>,
    phases: Vec<story::Phase>,
    camera: Shooting,
    direction: Vec3,
    /// Joint and body transforms at the time, in the world.
    model: Vec<Affine>,
    bodies: Vec<Transform>,
}

impl<'a> Shots<'a> {
    fn new(film: Film<'a>, frames: u32) -> Self {
        let Film { fall, set, direction, view, sun, .. } = film;
        let rig = &fall.input.character.rig;
        let radius = if let View::Around(radius) = view { radius } else { 0.0 };
        let mut shots = Self {
            fall,
            standing: set.len(),
            scene: Scene { models: set, sun, ..Scene::default() },
            looks: skin::looks(rig),
            phases: story::phases(&fall.input.character, &fall.baked.events),
            camera: Shooting::Following { radius, camera: None },
            direction,
            model: Vec::new(),
            bodies: Vec::new(),
        };
        if view == View::Whole {
            // A camera that followed a fall out of the world would show nothing else.
            let end = fallen_out(fall.input, &fall.baked).map_or(f32::INFINITY, |(time, _)| time);
            let boxes: Vec<Aabb> = (0..frames)
                .map(|frame| {
                    shots.pose(min(frame as f32 / FPS as f32, end));
                    shots.around()
                })
                .collect();
            let framing = Framing::new(&boxes, FPS as f32, direction);
            let side = clear_side(fall.input.bodies, &framing, &boxes, direction);
            shots.scene.sky.haze_distance = haze_distance(framing.radius());
            shots.camera = Shooting::Framing(framing.seen_from(side));
        }
        shots
    }

    fn shoot(&mut self, renderer: &mut Renderer, frame: u32) -> Image {
        let time = frame as f32 / FPS as f32;
        self.pose(time);
        self.scene.models.truncate(self.standing);
        self.add_character();
        self.add_arrows(time);
        let subject = self.around().center();
        let size = renderer.settings();
        let aspect = size.width as f32 / size.height as f32;
        let camera = match &mut self.camera {
            Shooting::Following { radius, camera } => {
                let camera =
                    camera.get_or_insert_with(|| FollowCamera::new(subject, *radius, self.direction));
                camera.update(subject, 1.0 / FPS as f32);
                camera.camera()
            }
            Shooting::Framing(framing) => framing.camera(frame as usize, aspect),
        };
        let phase = self.phases.iter().rev().find(|(since, _)| *since <= time).map_or("", |(_, what)| what);
        self.scene.captions = vec![Caption::new(format!("{time:5.2} s  {phase}"))];
        renderer.render(&self.scene, &camera)
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

    /// Returns the bounds of all bodies, in the world.
    fn around(&self) -> Aabb {
        let bodies = &self.fall.input.character.ragdoll.bodies;
        let boxes = bodies.iter().zip(&self.bodies).map(|(body, place)| body.shape.aabb(place));
        boxes.reduce(|all, one| all.merge(&one)).unwrap_or_default()
    }

    fn add_character(&mut self) {
        self.scene.models.extend(skin::models(&self.fall.input.character.rig, &self.model, &self.looks));
    }

    /// Adds an arrow for each recent hit, with its tip at the hit position.
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

/// Returns the camera direction with the least occlusion of a moving subject: the first of the best in eighths of a
/// turn, then from higher up.
fn clear_side(bodies: &[BodyDef], framing: &Framing, boxes: &[Aabb], wanted: Vec3) -> Vec3 {
    let mut world = World::new(WorldDef::default());
    for body in bodies.iter().filter(|body| body.kind == BodyKind::Static) {
        world.add_body(body);
    }
    let stands = world.query().filter(QueryFilter::of(BodyKinds::STATIC));
    let hidden = |direction: Vec3| {
        let seen = framing.seen_from(direction);
        let looks = boxes.iter().enumerate().step_by(LOOK_EVERY).flat_map(|(frame, bounds)| {
            let (center, camera) = (bounds.center(), seen.camera(frame, 1.0).position);
            let height = bounds.max.y - bounds.min.y;
            [-0.3, 0.0, 0.4].map(|share| center + Vec3::Y * (share * height)).map(|from| (from, camera))
        });
        looks.filter(|&(from, camera)| stands.any(&Ray { origin: from, direction: camera - from })).count()
    };
    let turned = |eighths: u8, lift: f32| {
        let turn = Rotation::from_axis_angle(Vec3::Y, f32::from(eighths) * core::f32::consts::FRAC_PI_4);
        turn * (wanted + Vec3::Y * lift)
    };
    let sides = [0, 7, 1, 6, 2, 5, 3, 4];
    let ways = [0.0, 0.8, 3.0].into_iter().flat_map(|lift| sides.map(|eighths| turned(eighths, lift)));
    ways.min_by_key(|&way| hidden(way)).unwrap_or(wanted)
}

/// Number of pictures between two occlusion tests.
const LOOK_EVERY: usize = 4;

/// Returns an arrow (shaft and head) that ends at `tip`, along the unit vector `along`.
fn arrow(tip: Vec3, along: Vec3) -> [Model; 2] {
    let turn = Rotation::from_arc(Vec3::Y, along);
    let part = |behind: f32, shape: Shape| {
        draw::shape(&shape, Transform::new(tip - along * behind, turn), RenderMaterial::new(ARROW_COLOR))
    };
    [
        part(0.55, Shape::Capsule { half_height: 0.3, radius: 0.025 }),
        part(0.22, Shape::Capsule { half_height: 0.02, radius: 0.07 }),
    ]
}

/// Half size of the drawn part of an unbounded floor around a human, metres per side: as far as the haze allows.
pub const FLOOR_HALF_SIZE: f32 = 40.0;

/// Returns the surface of a world body in one colour (linear); half-spaces become floors, `half_size` metres per
/// side, with a checker of `other`.
pub fn body_models(body: &BodyDef, half_size: f32, color: [f32; 3], other: [f32; 3]) -> Vec<Model> {
    let world_from_body = Transform::new(body.position, body.rotation);
    let model = |shape: &sinew::physics::ShapeDef| {
        let place = world_from_body * shape.body_from_shape;
        match &shape.shape {
            Shape::HalfSpace => draw::plane(place, half_size, 1.0, [color, other]),
            shape => draw::shape(shape, place, RenderMaterial::new(color)),
        }
    };
    body.shapes.iter().map(model).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew::physics::ShapeDef;
    use sinew::ragdoll::CharacterEvent;
    use sinew_picture::Antialiasing;
    use sinew_scenes::cabin::Site;

    /// Captions name the character's state at their time.
    #[test]
    fn captions_follow_the_state() {
        let demo = sinew_scenes::demo::Demo::new(Site::CabinWithStairs);
        let input = demo.input();
        let fall = Fall::simulate(&input, None);
        let events = &fall.baked.events;
        let at = |what: fn(&CharacterEvent) -> bool| {
            events.iter().find(|(_, event)| what(event)).expect("the event must occur").0
        };
        let hit = at(|event| matches!(event, CharacterEvent::Hit { .. }));
        let settled = events.iter().find_map(|(_, event)| match event {
            CharacterEvent::Settled { since } => Some(*since),
            _ => None,
        });
        let rises = at(|event| matches!(event, CharacterEvent::GettingUp { .. }));
        let up = at(|event| matches!(event, CharacterEvent::Up));
        let settled = settled.expect("the character must come to rest");
        let frames = (fall.input.seconds * FPS as f32) as u32 + 1;
        let film = Film {
            fall: &fall,
            from: 0.0,
            set: vec![],
            direction: Vec3::Z,
            view: View::Whole,
            sun: Sun::default(),
        };
        let mut shots = Shots::new(film, frames);
        let mut renderer = Renderer::new(RenderSettings {
            width: 32,
            height: 18,
            antialiasing: Antialiasing::Off,
            shadow_texels: 16,
            threads: 1,
        });
        // Times of two events; a picture between them has the expected caption.
        for (from, to, expected) in [
            (0.0, hit, "walks"),
            (hit, hit + story::HIT_SECONDS, "is hit"),
            (hit + story::HIT_SECONDS, settled, "falls"),
            (settled, rises, "lies still"),
            (rises, up, "gets up"),
            (up, fall.input.seconds, "walks"),
        ] {
            let frame = (0.5 * (from + to) * FPS as f32).round() as u32;
            shots.shoot(&mut renderer, frame);
            let said = shots.scene.captions[0].text.clone();
            let time = frame as f32 / FPS as f32;
            assert_eq!(said, format!("{time:5.2} s  {expected}"), "between {from} and {to} s");
        }
    }

    /// The camera avoids a wall that would hide the subject.
    #[test]
    fn camera_avoids_a_wall() {
        let block = |center: Vec3, half_extents: Vec3| BodyDef {
            kind: BodyKind::Static,
            position: center,
            shapes: vec![ShapeDef::new(Shape::Box { half_extents })],
            ..BodyDef::default()
        };
        let bodies = [block(Vec3::new(0.0, 2.0, 2.0), Vec3::new(6.0, 2.0, 0.1))];
        let boxes: Vec<Aabb> = (0..30)
            .map(|frame| Aabb::around(Vec3::new(0.05 * frame as f32, 0.9, 0.0), Vec3::new(0.4, 0.9, 0.4)))
            .collect();
        let framing = Framing::new(&boxes, FPS as f32, Vec3::Z);
        let mut world = World::new(WorldDef::default());
        world.add_body(&bodies[0]);
        let stands = world.query().filter(QueryFilter::of(BodyKinds::STATIC));
        let hidden = |side: Vec3| {
            let seen = framing.seen_from(side);
            let looks = boxes.iter().enumerate().filter(|(frame, bounds)| {
                let (origin, camera) = (bounds.center(), seen.camera(*frame, 1.6).position);
                stands.any(&Ray { origin, direction: camera - origin })
            });
            looks.count()
        };
        assert_eq!(hidden(Vec3::Z), boxes.len(), "the wall must hide the character in every frame");
        assert_eq!(hidden(clear_side(&bodies, &framing, &boxes, Vec3::Z)), 0);
        // Without a wall the camera stays at the requested position.
        assert_eq!(clear_side(&[], &framing, &boxes, Vec3::Z), Vec3::Z);
    }
}
