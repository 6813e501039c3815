//! Pictures of a file with a skeleton, a skin or a clip, for `view FILE` and `convert --picture`.

use crate::failure::{Failure, Result};
use crate::input::motion::Motion;
use crate::render::bones::add_bone_models;
use crate::render::framing::{Framing, haze_distance};
use crate::render::skin;
use crate::report::progress::Progress;
use crate::report::table::shown;
use sinew::anim::{Clip, Rig, RigAnalysis, Wrap, local_to_model, rest_pose, sample, skin_vertices};
use sinew::math::{Affine, Transform, Vec3, max};
use sinew::physics::boxes::Aabb;
use sinew_picture::{
    Caption, EncodeError, Movie, PictureFormat, RenderMaterial, RenderSettings, Renderer, Scene, Sky, Sun,
    draw,
};

/// Pictures per second: a whole number of a GIF's hundredths of a second.
const FPS: u32 = 20;
/// Half-width of the drawn ground, in radii of the subject.
const GROUND: f32 = 30.0;
const GROUND_COLORS: [[f32; 3]; 2] = [[0.34, 0.36, 0.38], [0.27, 0.29, 0.31]];
/// Direction from the subject to the camera: front left.
const DIRECTION: Vec3 = Vec3::new(0.75, 0.4, 0.75);

/// A rig and its motion.
pub struct Show {
    rig: Rig,
    clip: Option<Clip>,
    /// Transform from the file's space to the picture's: metres, +Y up, facing +Z.
    root: Affine,
    /// Height of the ground, if the body's soles define it.
    floor: Option<f32>,
    looks: Vec<RenderMaterial>,
    title: String,
}

impl Show {
    /// Creates a view of the file's rig with that clip, or in the rest pose; a skeleton without a mesh gets
    /// drawn bones.
    ///
    /// # Errors
    /// If the file has nothing to draw.
    pub fn new(motion: Motion, clip: Option<usize>) -> Result<Self> {
        let Motion { name, file, analysis } = motion;
        let mut rig = file.rig;
        // A mesh next to a skeleton without a skin does not show the body's motion.
        if rig.meshes.is_empty() || rig.skins.is_empty() && analysis.is_some() {
            add_bone_models(&mut rig, analysis.as_ref());
        }
        let drawn = rig.meshes.iter().flat_map(|mesh| &mesh.primitives).any(|part| !part.indices.is_empty());
        if !drawn {
            return Err(Failure::of_file(&name, "there is no skeleton, mesh or clip to draw"));
        }
        let unit = Affine::from_scale_rotation_translation(
            Vec3::splat(file.metres_per_unit.unwrap_or(1.0)),
            sinew::math::Rotation::IDENTITY,
            Vec3::ZERO,
        );
        let stem = std::path::Path::new(&name).file_stem().map(|stem| stem.to_string_lossy().into_owned());
        let clip = clip.map(|index| file.clips[index].clone());
        let title = clip.as_ref().filter(|clip| !clip.name.is_empty()).map(|clip| shown(&clip.name));
        Ok(Self {
            root: analysis.as_ref().map_or(unit, RigAnalysis::character_from_file),
            floor: analysis.map(|analysis| analysis.floor),
            looks: skin::looks(&rig),
            title: title.or(stem).unwrap_or_default(),
            clip,
            rig,
        })
    }

    /// Returns the duration of the motion, seconds; 0 if the rig does not move.
    pub fn seconds(&self) -> f32 {
        self.clip.as_ref().map_or(0.0, |clip| clip.duration)
    }

    /// Returns the bytes of a picture at a time.
    pub fn picture(
        &self,
        at: f32,
        settings: RenderSettings,
        format: PictureFormat,
    ) -> Result<Vec<u8>, EncodeError> {
        let bounds = around(&skin::outline(&self.rig), &self.pose(at));
        let framing = Framing::new(&[bounds], FPS as f32, DIRECTION);
        let image = Stage::new(self, framing, bounds, settings).draw(at, 0);
        sinew_picture::encode::encode(format, &[image], FPS)
    }

    /// Returns the bytes of a movie of the first `seconds`.
    pub fn movie(
        &self,
        seconds: f32,
        settings: RenderSettings,
        format: PictureFormat,
    ) -> Result<Vec<u8>, EncodeError> {
        let frames = (seconds * FPS as f32) as usize + 1;
        let time = |frame: usize| frame as f32 / FPS as f32;
        // The first pass measures the extent, the second draws.
        let outline = skin::outline(&self.rig);
        let boxes: Vec<Aabb> = (0..frames).map(|frame| around(&outline, &self.pose(time(frame)))).collect();
        let whole = boxes.iter().copied().reduce(|a, b| a.merge(&b)).expect("the movie has a frame");
        let framing = Framing::new(&boxes, FPS as f32, DIRECTION);
        let progress = Progress::new("drawing", frames);
        let mut stage = Stage::new(self, framing, whole, settings);
        let mut movie = Movie::new(format, FPS);
        for frame in 0..frames {
            movie.push(&stage.draw(time(frame), frame))?;
            progress.step();
        }
        movie.finish()
    }

    /// Returns the transforms of the joints at a time, in the picture's space.
    fn pose(&self, time: f32) -> Vec<Affine> {
        let mut local = rest_pose(&self.rig);
        if let Some(clip) = &self.clip {
            sample(clip, &self.rig, time, Wrap::Clamp, &mut local);
        }
        let mut model = Vec::new();
        local_to_model(&self.rig, &local, &self.root, &mut model);
        model
    }

    /// Returns the static scene of every picture.
    fn scene(&self, framing: &Framing, whole: &Aabb) -> Scene {
        let radius = framing.radius();
        let lowest = self.floor.filter(|floor| *floor <= whole.min.y + 0.5 * radius).unwrap_or(whole.min.y);
        let ground = Transform::from_translation(Vec3::Y * lowest);
        // Tiles of a metre if they are visible, else of the subject's own scale.
        let tile = if (0.2..10.0).contains(&radius) { 1.0 } else { radius };
        let mut scene = Scene {
            sun: Sun { shadow_radius: 1.3 * radius, ..Sun::default() },
            sky: Sky { haze_distance: haze_distance(radius), ..Sky::default() },
            models: skin::models(&self.rig, &self.pose(0.0), &self.looks).collect(),
            ..Scene::default()
        };
        scene.models.push(draw::plane(ground, max(GROUND * radius, 40.0), tile, GROUND_COLORS));
        scene
    }

    fn caption(&self, time: f32) -> String {
        match &self.clip {
            Some(_) => format!("{time:5.2} s  {}", self.title),
            None => self.title.clone(),
        }
    }
}

/// A rig ready to be drawn, with its constant parts.
struct Stage<'a> {
    show: &'a Show,
    framing: Framing,
    scene: Scene,
    renderer: Renderer,
}

impl<'a> Stage<'a> {
    /// Prepares pictures within `whole`.
    fn new(show: &'a Show, framing: Framing, whole: Aabb, settings: RenderSettings) -> Self {
        let scene = show.scene(&framing, &whole);
        Self { show, framing, scene, renderer: Renderer::new(settings) }
    }

    /// Draws the picture at a time; `frame` is its index in the framing.
    fn draw(&mut self, time: f32, frame: usize) -> sinew_picture::Image {
        skin::pose(&self.show.rig, &self.show.pose(time), &mut self.scene.models);
        self.scene.captions = vec![Caption::new(self.show.caption(time))];
        let size = self.renderer.settings();
        let aspect = size.width as f32 / size.height as f32;
        self.renderer.render(&self.scene, &self.framing.camera(frame, aspect))
    }
}

/// Returns the bounds of all finite vertices of an outline; a cubic metre without any.
fn around(outline: &Rig, pose: &[Affine]) -> Aabb {
    let (mut bounds, mut positions, mut normals): (Option<Aabb>, _, _) = (None, Vec::new(), Vec::new());
    for (mesh, of) in outline.meshes.iter().enumerate() {
        for part in 0..of.primitives.len() {
            skin_vertices(outline, mesh, part, pose, &mut positions, &mut normals);
            for &point in positions.iter().filter(|point: &&Vec3| point.is_finite()) {
                let own = Aabb { min: point, max: point };
                bounds = Some(bounds.map_or(own, |all| all.merge(&own)));
            }
        }
    }
    bounds.unwrap_or(Aabb::around(Vec3::ZERO, Vec3::ONE))
}
