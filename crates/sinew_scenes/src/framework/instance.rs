//! A running scene.

use super::actors::Figure;
use super::acts::Act;
use super::camera_hint::CameraHint;
use super::curve::Curve;
use super::metric::{Expected, Metric};
use core::time::Duration;
use sinew::math::{ReadError, Reader, Vec3, Writer, max};
use sinew::physics::stage::{NoProfiler, Profiler};
use sinew::physics::{
    BodyId, BodyKind, DebugDraw, Energy, GroupId, LoadError, Serial, TaskRunner, Update, World,
};
use sinew::ragdoll::Character;

/// The part of a scene that accompanies its world.
pub trait Script: Send {
    /// Runs before each step and moves scripted bodies, such as those that follow an animation. Like
    /// [`after_step`](Self::after_step), it depends on the world alone.
    fn before_step(&mut self, _world: &mut World) {}

    /// Runs after each step: measures, and applies impulses for the next step. The impulses depend on the world alone,
    /// so that a restored world continues as the saved one did.
    fn after_step(&mut self, _world: &mut World) {}

    /// [`after_step`](Self::after_step) for a host that measures time: `done` is called after each part of the work.
    /// The work and its order are the same.
    fn after_step_in_parts(&mut self, world: &mut World, _done: &mut dyn FnMut(Part)) {
        self.after_step(world);
    }

    /// Writes the script's own state that affects the future, if it has any.
    fn save(&self, _out: &mut Writer) {}

    /// Reads the state that [`save`](Self::save) wrote.
    ///
    /// # Errors
    /// If the bytes are not those of the same scene with the same settings.
    fn load(&mut self, _bytes: &mut Reader<'_>) -> Result<(), ReadError> {
        Ok(())
    }

    /// Net energy that drives have given the world since the start, J; called after [`after_step`](Self::after_step).
    fn work_in(&self, _world: &World) -> f32 {
        0.0
    }

    /// Returns the metrics so far.
    fn metrics(&self, world: &World) -> Vec<Metric>;

    /// View of the scene in a picture.
    fn camera_hint(&self) -> CameraHint {
        CameraHint::default()
    }

    /// Draws additional content of a picture, such as query results.
    fn draw(&self, _world: &World, _out: &mut dyn DebugDraw) {}

    /// Curves that a picture compares, each in its own colour.
    fn curves(&self) -> Vec<Curve> {
        Vec::new()
    }

    /// Characters that a picture draws by their skins.
    fn figures(&self) -> Vec<Figure<'_>> {
        Vec::new()
    }

    /// Bodies that a picture does not draw, because the skins of [`figures`](Self::figures) replace them.
    fn bodies_of_figures(&self) -> Vec<BodyId> {
        Vec::new()
    }

    /// Cloth that a picture does not draw, because the skins of [`figures`](Self::figures) show it.
    fn garments_of_figures(&self) -> &[GroupId] {
        &[]
    }

    /// Colours (linear) of bodies that have their own in a picture.
    fn colors(&self) -> &[(BodyId, [f32; 3])] {
        &[]
    }

    /// Called when a user pushes a kinematic body with an impulse, N·s, at a point, world space. An impulse does not
    /// move such a body, but a character falls.
    fn strike(&mut self, _world: &mut World, _body: BodyId, _impulse: Vec3, _point: Vec3) {}

    /// Sets the velocity of the character that a user may control, from the next step on, m/s, world space. Most scenes
    /// have none.
    fn steer(&mut self, _way: Vec3) {}

    /// Position of the character that a user may control, metres, world space.
    fn steered(&self) -> Option<Vec3> {
        None
    }

    /// Carries out an instruction to the character that a user may control.
    fn act(&mut self, _world: &mut World, _act: Act) {}

    /// Returns the character that carries out instructions, if the scene has one.
    fn directed(&self) -> Option<&Character> {
        None
    }
}

/// A part of the work of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Name of the part, such as characters in a state; the parts are always in the same order.
    pub name: &'static str,
    /// Number of items in the part, for example characters.
    pub count: u32,
}

/// Script of a world without measurements.
struct Unwatched;

impl Script for Unwatched {
    fn metrics(&self, _: &World) -> Vec<Metric> {
        Vec::new()
    }
}

/// A scene that runs.
pub struct Instance {
    world: World,
    script: Box<dyn Script>,
    health: Health,
}

impl Instance {
    pub(crate) fn new(world: World, script: impl Script + 'static) -> Self {
        Self { world, script: Box::new(script), health: Health::default() }
    }

    /// Creates the instance of a world that no scene created, such as that of a file.
    pub fn of_world(world: World) -> Self {
        Self::new(world, Unwatched)
    }

    /// View of the scene in a picture.
    pub fn camera_hint(&self) -> CameraHint {
        self.script.camera_hint()
    }

    /// Draws the additions to the picture of the world.
    pub fn draw(&self, out: &mut dyn DebugDraw) {
        self.script.draw(&self.world, out);
    }

    /// Curves that a picture compares, each in its own colour.
    pub fn curves(&self) -> Vec<Curve> {
        self.script.curves()
    }

    /// Characters that a picture draws by their skins.
    pub fn figures(&self) -> Vec<Figure<'_>> {
        self.script.figures()
    }

    /// Bodies that a picture does not draw, because the skins of [`figures`](Self::figures) replace them.
    pub fn bodies_of_figures(&self) -> Vec<BodyId> {
        self.script.bodies_of_figures()
    }

    /// Cloth that a picture does not draw, because the skins of [`figures`](Self::figures) show it.
    pub fn garments_of_figures(&self) -> &[GroupId] {
        self.script.garments_of_figures()
    }

    /// Colours (linear) of bodies that have their own in a picture.
    pub fn colors(&self) -> &[(BodyId, [f32; 3])] {
        self.script.colors()
    }

    /// Pushes a kinematic body of a character, N·s at a point, world space.
    pub(crate) fn push(&mut self, body: BodyId, impulse: Vec3, point: Vec3) {
        if self.world.contains(body) && self.world.kind(body) == BodyKind::Kinematic {
            self.script.strike(&mut self.world, body, impulse, point);
        }
    }

    /// Sets the velocity of the character that a user may control, from the next step on, m/s, world space.
    pub fn steer(&mut self, way: Vec3) {
        self.script.steer(way);
    }

    /// Position of the character that a user may control, metres, world space; `None` in scenes without one.
    pub fn steered(&self) -> Option<Vec3> {
        self.script.steered()
    }

    /// Carries out an instruction to the character that a user may control; in scenes without one, nothing happens.
    pub fn act(&mut self, act: Act) {
        self.script.act(&mut self.world, act);
    }

    /// Returns the character that carries out instructions; `None` in scenes without one.
    pub fn directed(&self) -> Option<&Character> {
        self.script.directed()
    }

    /// World of the instance, for queries, drawing and snapshots.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// World of the instance, to change it or to load a snapshot of the same scene into it.
    pub fn world_mut(&mut self) -> &mut World {
        &mut self.world
    }

    /// Takes one step on the calling thread.
    pub fn step(&mut self) {
        self.step_with(&Serial, &NoProfiler);
    }

    /// Takes one step with the host's threads and stage times.
    pub fn step_with(&mut self, runner: &dyn TaskRunner, profiler: &dyn Profiler) {
        self.step_in_parts(runner, profiler, &mut |_| {});
    }

    /// Takes one step, like [`step_with`](Self::step_with). `done` is called after the world's step (a part named
    /// [`WORLD`](Self::WORLD), for all its bodies) and after each further part of the work, so that a host can measure
    /// the time of each.
    pub fn step_in_parts(
        &mut self,
        runner: &dyn TaskRunner,
        profiler: &dyn Profiler,
        done: &mut dyn FnMut(Part),
    ) {
        let Self { world, script, health } = self;
        step(world, script.as_mut(), health, &|world| world.step_with(runner, profiler), done);
    }

    /// Name of the part that is the world's step.
    pub const WORLD: &'static str = "world";

    /// Writes the world and the script's state.
    pub fn save(&self, out: &mut Writer) {
        self.world.save(out);
        self.script.save(out);
    }

    /// Reads the state that [`save`](Self::save) wrote.
    ///
    /// # Errors
    /// If the bytes are not those of the same scene with the same settings.
    pub fn load(&mut self, bytes: &mut Reader<'_>) -> Result<(), LoadError> {
        self.world.load(bytes)?;
        self.script.load(bytes)?;
        self.health.work_in = self.script.work_in(&self.world);
        Ok(())
    }

    /// Takes all whole steps due after another `time`, as [`World::update`] does; the script runs for each.
    pub fn update(&mut self, time: Duration) -> Update {
        let Self { world, script, health } = self;
        world.update_with(time, |world| step(world, script.as_mut(), health, &World::step, &mut |_| {}))
    }

    /// Number of metrics that follow the scene's own metrics, the same for every scene.
    pub const METRICS_OF_EVERY_SCENE: usize = 2;

    /// Returns the metrics so far: those of the scene, then `energy_gain_max` and `nan`, which every scene has.
    pub fn metrics(&self) -> Vec<Metric> {
        let mut metrics = self.script.metrics(&self.world);
        metrics.extend(self.health.metrics());
        metrics
    }
}

/// Takes one step, with the scene's own actions.
fn step(
    world: &mut World,
    script: &mut dyn Script,
    health: &mut Health,
    step: &dyn Fn(&mut World),
    done: &mut dyn FnMut(Part),
) {
    script.before_step(world);
    let before = world.energy();
    step(world);
    // Exclude the work that the script does by pushes, releases and restarted animations.
    let (after, mass) = (world.energy(), mass_of(world));
    done(Part { name: Instance::WORLD, count: world.body_ids().count() as u32 });
    script.after_step_in_parts(world, done);
    health.after_step(world, [before, after], mass, script.work_in(world));
}

/// Mass of all bodies moved by forces, kg; characters count while no clip moves them.
fn mass_of(world: &World) -> f32 {
    let of_bodies: f32 = world.body_ids().map(|id| world.mass(id).mass).sum();
    let of_particles: f32 = world.group_ids().flat_map(|id| world.particles(id).masses()).sum();
    of_bodies + of_particles
}

/// Errors that no scene may show, for any length of run.
#[derive(Default)]
struct Health {
    /// Energy that drives have put in, J.
    work_in: f32,
    energy_gain_max: f32,
    quarantined: u32,
}

impl Health {
    fn after_step(&mut self, world: &World, [before, after]: [Energy; 2], mass: f32, work_in: f32) {
        // Subtract each kind of energy separately, because their sums are large and lose digits.
        let rise = (after.kinetic - before.kinetic) + (after.potential - before.potential)
            - (work_in - self.work_in);
        self.work_in = work_in;
        let most = max(before.kinetic, mass);
        // A world without masses has no energy.
        self.energy_gain_max = max(self.energy_gain_max, if most > 0.0 { rise / most } else { 0.0 });
        self.quarantined += world.events().quarantined.len() as u32;
    }

    fn metrics(&self) -> [Metric; Instance::METRICS_OF_EVERY_SCENE] {
        [
            Metric::new("energy_gain_max", self.energy_gain_max, Expected::AtMost(0.01)),
            Metric::new("nan", self.quarantined, Expected::AtMost(0.0)),
        ]
    }
}
