//! Pictures of a running scene.

use super::Subject;
use crate::render::framing::haze_distance;
use crate::render::skin;
use crate::report::progress::Progress;
use sinew::math::{Vec3, clamp, max};
use sinew::physics::boxes::Aabb;
use sinew::physics::ray::Ray;
use sinew::physics::{BodyKind, BodyKinds, QueryFilter};
use sinew_picture::world::{self, Frame, Kinematic, Lines, Trails};
use sinew_picture::{
    Camera, Caption, EncodeError, Image, Movie, PictureFormat, RenderMaterial, RenderSettings, Renderer,
    Scene, Sky, Sun, draw,
};
use sinew_scenes::scenes::{CameraHint, Curve, Expected, Figure, Instance, Metric, Trails as DrawnTrails};

/// Pictures per second: a whole number of a GIF's hundredths of a second.
const FPS: u32 = 20;
/// Largest number of metrics on a picture.
const MOST_FIGURES: usize = 3;
/// Number of rays that test for occlusion.
const MOST_RAYS: usize = 64;
/// Largest radius of the visible region around moving bodies, in radii of the largest body.
const WIDEST: f32 = 120.0;
/// Extent of a skin beyond its joints, as a share of the joints' extent.
const FLESH: f32 = 0.08;
/// Margin around the subject, as a share of its size.
const MARGIN: f32 = 0.1;

/// Settings of the pictures, and their captions.
pub struct Reel<'a> {
    /// Title of the pictures.
    pub title: &'a str,
    /// Time at which the subject's expectations apply, seconds.
    pub ends: f32,
    /// Size and quality.
    pub settings: RenderSettings,
}

impl Reel<'_> {
    /// Returns the bytes of a picture `at` seconds from the start.
    pub fn picture(
        &self,
        subject: &Subject<'_>,
        at: f32,
        format: PictureFormat,
    ) -> Result<Vec<u8>, EncodeError> {
        let mut take = Take::new(subject.start());
        let step = take.step_at(at);
        let progress = Progress::new("running", step as usize);
        while take.run.world().step_count() < step {
            take.step();
            progress.step();
        }
        take.turn_to_see();
        let image = take.draw(self, &take.whole, &mut Renderer::new(self.settings));
        sinew_picture::encode::encode(format, &[image], FPS)
    }

    /// Returns the bytes of a movie of the first `seconds`.
    pub fn movie(
        &self,
        subject: &Subject<'_>,
        seconds: f32,
        format: PictureFormat,
    ) -> Result<Vec<u8>, EncodeError> {
        let frames = (seconds * FPS as f32) as u32 + 1;
        let time = |frame: u32| frame as f32 / FPS as f32;
        // The first pass measures the extent of the subject, so that a fixed camera shows all of it. The second pass
        // draws.
        let mut rehearsal = Take::new(subject.start());
        rehearsal.step_to(time(frames - 1));
        rehearsal.turn_to_see();
        let progress = Progress::new("drawing", frames as usize);
        let mut renderer = Renderer::new(self.settings);
        let mut movie = Movie::new(format, FPS);
        let mut take = Take { hint: rehearsal.hint, ..Take::new(subject.start()) };
        for frame in 0..frames {
            take.step_to(time(frame));
            movie.push(&take.draw(self, &rehearsal.whole, &mut renderer))?;
            progress.step();
        }
        movie.finish()
    }
}

/// A running scene with the positions so far.
struct Take {
    run: Instance,
    hint: CameraHint,
    /// Bounds of the subject over time, so far.
    whole: Aabb,
    trails: Trails,
    /// Materials of each character.
    looks: Vec<Vec<RenderMaterial>>,
}

impl Take {
    fn new(run: Instance) -> Self {
        let hint = run.camera_hint();
        let looks = run.figures().iter().map(|figure| skin::looks(figure.rig)).collect();
        let trails =
            if hint.trails == DrawnTrails::None { Trails::default() } else { Trails::of(run.world()) };
        let mut take = Self { hint, whole: Aabb::default(), trails, looks, run };
        take.whole = take.now();
        take
    }

    /// Returns the step nearest to a time.
    fn step_at(&self, time: f32) -> u64 {
        (f64::from(time) / f64::from(self.run.world().def().dt())).round() as u64
    }

    fn step_to(&mut self, time: f32) {
        while self.run.world().step_count() < self.step_at(time) {
            self.step();
        }
    }

    fn step(&mut self) {
        self.run.step();
        self.whole = self.whole.merge(&self.now());
        let world = self.run.world();
        self.trails.go_on(world);
    }

    /// Tries camera directions around the subject in quarter turns and picks the one with the least occlusion.
    fn turn_to_see(&mut self) {
        let Vec3 { x, y, z } = self.hint.direction;
        let sides = [Vec3::new(x, y, z), Vec3::new(z, y, -x), Vec3::new(-z, y, x), Vec3::new(-x, y, -z)];
        // Among equal directions take the first, which is the requested one.
        self.hint.direction = sides.into_iter().min_by_key(|&side| self.hidden(side)).unwrap_or(sides[0]);
    }

    /// Returns the number of hidden bodies among the first moving ones.
    fn hidden(&self, direction: Vec3) -> usize {
        let world = self.run.world();
        let size = (self.whole.max - self.whole.min).length();
        let way = direction.normalize() * (2.0 * size);
        let stands = world.query().filter(QueryFilter::of(BodyKinds::STATIC));
        let moving = world.body_ids().filter(|&id| world.kind(id) != BodyKind::Static).take(MOST_RAYS);
        let rays = moving.map(|id| Ray { origin: world.center_of_mass(id), direction: way });
        rays.filter(|ray| stands.any(ray)).count()
    }

    /// Returns the current bounds of the subject.
    fn now(&self) -> Aabb {
        let moving = world::subject(self.run.world()).into_iter();
        let figures = self.run.figures().into_iter().filter_map(|figure| around(&figure));
        let all = moving.chain(self.lines().bounds()).chain(figures).reduce(|a, b| a.merge(&b));
        self.hint.bounds.or(all).unwrap_or(Aabb::around(Vec3::ZERO, Vec3::ONE))
    }

    /// Returns the lines that the scene draws in addition to its world.
    fn lines(&self) -> Lines {
        let mut lines = Lines::default();
        self.run.draw(&mut lines);
        let curves = self.run.curves();
        lines.list.extend(draw::curves(curves.iter().map(|curve| &curve.pieces[..])));
        lines
    }

    /// Draws the current state with a view of all of `whole`.
    fn draw(&self, reel: &Reel<'_>, whole: &Aabb, renderer: &mut Renderer) -> Image {
        let shown = self.shown(whole);
        let figures = self.run.figures();
        let frame = Frame {
            center: shown.center(),
            radius: 0.5 * (shown.max - shown.min).length(),
            kinematic: if figures.is_empty() { Kinematic::Solid } else { Kinematic::Wire },
            colors: self.run.colors(),
        };
        let mut scene = Scene {
            sun: Sun { shadow_radius: 1.3 * frame.radius, ..Sun::default() },
            sky: Sky { haze_distance: haze_distance(frame.radius), ..Sky::default() },
            captions: self.captions(reel),
            ..Scene::default()
        };
        let (bodies, worn) = (self.run.bodies_of_figures(), self.run.garments_of_figures());
        world::paint_all_but(self.run.world(), &bodies, worn, &frame, &mut scene);
        for (figure, looks) in figures.iter().zip(&self.looks) {
            scene.models.extend(skin::models(figure.rig, figure.world_from_joint, looks));
        }
        scene.lines.extend(self.lines().list);
        scene.lines.extend(self.trails.lines());
        let size = renderer.settings();
        let aspect = size.width as f32 / size.height as f32;
        renderer.render(&scene, &Camera::framing_box(&shown, self.hint.direction, aspect))
    }

    /// Returns the visible part of `whole`: all of it unless objects would be too small, and always all current
    /// objects.
    fn shown(&self, whole: &Aabb) -> Aabb {
        let now = self.now();
        let limit = WIDEST * self.largest();
        let axis = |lo: f32, hi: f32, now_lo: f32, now_hi: f32| {
            let half = max(sinew::math::min(0.5 * (hi - lo), limit), 0.5 * (now_hi - now_lo));
            let center = clamp(0.5 * (lo + hi), now_hi - half, now_lo + half);
            (center - half, center + half)
        };
        let x = axis(whole.min.x, whole.max.x, now.min.x, now.max.x);
        let y = axis(whole.min.y, whole.max.y, now.min.y, now.max.y);
        let z = axis(whole.min.z, whole.max.z, now.min.z, now.max.z);
        let shown = Aabb { min: Vec3::new(x.0, y.0, z.0), max: Vec3::new(x.1, y.1, z.1) };
        shown.expand(max(MARGIN * 0.5 * (shown.max - shown.min).length(), 1e-3))
    }

    /// Returns the radius of the largest moving shape, metres; infinite if there is none.
    fn largest(&self) -> f32 {
        let world = self.run.world();
        let moving = world.body_ids().filter(|&id| world.kind(id) != BodyKind::Static);
        let radii = moving.flat_map(|id| world.shapes(id)).map(|(shape, _)| shape.bounding_radius());
        radii.reduce(max).unwrap_or(f32::INFINITY)
    }

    fn captions(&self, reel: &Reel<'_>) -> Vec<Caption> {
        let world = self.run.world();
        let is_over = world.time() as f32 > reel.ends - 0.5 * world.def().dt();
        let moment = if is_over { Moment::AtTheEnd } else { Moment::OnTheWay };
        let head = Caption::new(format!("{}  {:.2} s", reel.title, world.time()));
        let lines = figures(&self.run.metrics(), moment);
        let count = lines.len() as i32;
        let place = |(i, text): (usize, String)| Caption {
            y: -8 - 12 * (count - 1 - i as i32),
            scale: 1,
            ..Caption::new(text)
        };
        let legend = |(number, curve): (usize, Curve)| Caption {
            x: -10,
            y: 10 + 12 * number as i32,
            scale: 1,
            // A paler colour than the curve's, for contrast on the caption's background.
            color: draw::curve_color(number).map(|part| part + 0.4 * (1.0 - part)),
            ..Caption::new(curve.name)
        };
        let legend = self.run.curves().into_iter().enumerate().map(legend);
        let lines = lines.into_iter().enumerate().map(place);
        std::iter::once(head).chain(lines).chain(legend).collect()
    }
}

/// Returns the bounds of a character's joints and its estimated skin.
fn around(figure: &Figure<'_>) -> Option<Aabb> {
    let joints = figure.world_from_joint.iter().map(|joint| joint.translation);
    let bones = joints.map(|at| Aabb { min: at, max: at }).reduce(|a, b| a.merge(&b))?;
    Some(bones.expand(FLESH * (bones.max - bones.min).max_element()))
}

/// State of a scene: running, or at the end, when every expectation applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Moment {
    OnTheWay,
    AtTheEnd,
}

/// Returns the main metrics of a scene: those with a closed form, else its other metrics, never those
/// common to all scenes. Expectations apply at the end; before that only the satisfied ones are shown.
fn figures(metrics: &[Metric], moment: Moment) -> Vec<String> {
    let own = &metrics[..metrics.len().saturating_sub(Instance::METRICS_OF_EVERY_SCENE)];
    let is_closed = |metric: &&Metric| matches!(metric.expected, Expected::Near { .. });
    let any_closed = own.iter().any(|metric| is_closed(&metric));
    let chosen = own.iter().filter(|metric| !any_closed || is_closed(metric));
    chosen.filter_map(|metric| figure(metric, moment)).take(MOST_FIGURES).collect()
}

fn figure(metric: &Metric, moment: Moment) -> Option<String> {
    let found = digits(metric.value?);
    Some(match metric.expected {
        Expected::Near { value, .. } if moment == Moment::AtTheEnd || metric.is_met() => {
            format!("{} {found} (closed form {})", metric.name, digits(value))
        }
        _ => format!("{} {found}", metric.name),
    })
}

/// Formats a number with five digits.
fn digits(x: f64) -> String {
    let size = x.abs();
    if size == 0.0 {
        return "0".to_owned();
    }
    if !(1e-3..1e5).contains(&size) {
        return format!("{x:.3e}");
    }
    let decimals = [1.0, 10.0, 100.0, 1000.0].iter().filter(|&&bound| size < bound).count();
    format!("{x:.*}", decimals + usize::from(size < 1.0))
}
