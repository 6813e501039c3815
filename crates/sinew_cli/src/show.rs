//! Pictures of a file with a skeleton, a skin or a clip: what `view FILE` and `convert --picture` draw.

use crate::bones::flesh_out;
use crate::failure::{Failure, Result};
use crate::framing::Framing;
use crate::motion::Motion;
use crate::progress::Progress;
use crate::skin;
use crate::table::shown;
use sinew::anim::{Clip, Rig, RigAnalysis, Wrap, local_to_model, rest_pose, sample};
use sinew::math::{Affine, Transform, Vec3, max};
use sinew::physics::boxes::Aabb;
use sinew_picture::{
    Caption, EncodeError, Material, Model, Movie, PictureFormat, RenderSettings, Renderer, Scene, Sky, Sun,
    draw,
};

/// Pictures a second: a whole number of a GIF's hundredths of a second.
const FPS: u32 = 20;
/// Half-width of the ground that is drawn, in radii of what stands on it.
const GROUND: f32 = 30.0;
const GROUND_COLORS: [[f32; 3]; 2] = [[0.34, 0.36, 0.38], [0.27, 0.29, 0.31]];
/// From what is shown to the camera: from its front left.
const DIRECTION: Vec3 = Vec3::new(0.75, 0.4, 0.75);

/// A rig and what it plays.
pub struct Show {
    rig: Rig,
    clip: Option<Clip>,
    /// From the file's space to the picture's: metres, +Y up, facing +Z.
    root: Affine,
    /// Height of the ground there, if the body's soles tell it.
    floor: Option<f32>,
    looks: Vec<Material>,
    title: String,
}

impl Show {
    /// The file's rig with that clip, or in its rest pose; bones are drawn for a skeleton without a mesh.
    ///
    /// # Errors
    /// A file with nothing to draw.
    pub fn new(motion: Motion, clip: Option<usize>) -> Result<Self> {
        let Motion { name, file, analysis } = motion;
        let mut rig = file.rig;
        // A mesh beside a body that has no skin does not show it.
        if rig.meshes.is_empty() || rig.skins.is_empty() && analysis.is_some() {
            flesh_out(&mut rig, analysis.as_ref());
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

    /// How long it moves, seconds; 0 where it does not.
    pub fn seconds(&self) -> f32 {
        self.clip.as_ref().map_or(0.0, |clip| clip.duration)
    }

    /// The bytes of a picture at a time.
    pub fn picture(
        &self,
        at: f32,
        settings: RenderSettings,
        format: PictureFormat,
    ) -> Result<Vec<u8>, EncodeError> {
        let models = self.models(at);
        let bounds = around(&models).unwrap_or(Aabb::around(Vec3::ZERO, Vec3::ONE));
        let framing = Framing::new(&[bounds], FPS as f32, DIRECTION);
        let image = self.draw(models, at, 0, &framing, &bounds, &mut Renderer::new(settings));
        sinew_picture::encode::encode(format, &[image], FPS)
    }

    /// The bytes of a movie of the first `seconds`.
    pub fn movie(
        &self,
        seconds: f32,
        settings: RenderSettings,
        format: PictureFormat,
    ) -> Result<Vec<u8>, EncodeError> {
        let frames = (seconds * FPS as f32) as usize + 1;
        let time = |frame: usize| frame as f32 / FPS as f32;
        // Once to see how far everything goes, once to draw it.
        let boxes: Vec<Aabb> = (0..frames)
            .map(|frame| around(&self.models(time(frame))).unwrap_or(Aabb::around(Vec3::ZERO, Vec3::ONE)))
            .collect();
        let whole = boxes.iter().copied().reduce(|a, b| a.merge(&b)).expect("there is a frame");
        let framing = Framing::new(&boxes, FPS as f32, DIRECTION);
        let progress = Progress::new("drawing", frames);
        let mut renderer = Renderer::new(settings);
        let mut movie = Movie::new(format, FPS);
        for frame in 0..frames {
            let models = self.models(time(frame));
            movie.push(&self.draw(models, time(frame), frame, &framing, &whole, &mut renderer))?;
            progress.step();
        }
        movie.finish()
    }

    /// Its surface at a time.
    fn models(&self, time: f32) -> Vec<Model> {
        let mut local = rest_pose(&self.rig);
        if let Some(clip) = &self.clip {
            sample(clip, &self.rig, time, Wrap::Clamp, &mut local);
        }
        let mut model = Vec::new();
        local_to_model(&self.rig, &local, &self.root, &mut model);
        skin::models(&self.rig, &model, &self.looks).collect()
    }

    fn draw(
        &self,
        models: Vec<Model>,
        time: f32,
        frame: usize,
        framing: &Framing,
        whole: &Aabb,
        renderer: &mut Renderer,
    ) -> sinew_picture::Image {
        let radius = framing.radius();
        let lowest = self.floor.filter(|floor| *floor <= whole.min.y + 0.5 * radius).unwrap_or(whole.min.y);
        let ground = Transform::from_translation(Vec3::Y * lowest);
        // A metre where that is seen: of what is much larger or smaller, what is.
        let tile = if (0.2..10.0).contains(&radius) { 1.0 } else { radius };
        let mut scene = Scene {
            sun: Sun { shadow_radius: 1.3 * radius, ..Sun::default() },
            sky: Sky { haze_distance: max(45.0, 15.0 * radius), ..Sky::default() },
            models,
            ..Scene::default()
        };
        scene.models.push(draw::plane(ground, max(GROUND * radius, 40.0), tile, GROUND_COLORS));
        let caption = match &self.clip {
            Some(_) => format!("{time:5.2} s  {}", self.title),
            None => self.title.clone(),
        };
        scene.captions = vec![Caption::new(caption)];
        let size = renderer.settings();
        let aspect = size.width as f32 / size.height as f32;
        renderer.render(&scene, &framing.camera(frame, aspect))
    }
}

/// Around all vertices that are finite.
fn around(models: &[Model]) -> Option<Aabb> {
    let points = models.iter().flat_map(|model| &model.positions).filter(|point| point.is_finite());
    points.map(|&point| Aabb { min: point, max: point }).reduce(|a, b| a.merge(&b))
}
