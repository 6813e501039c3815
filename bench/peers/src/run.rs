//! Runs one scene on one engine: for the time, and optionally again for the quality.

use crate::engine::{BodyState, Effort, Engine, Unsupported};
use crate::measure::{Memory, StepTimes};
use crate::quality::{ClothMeter, CrowdMeter, QualityMeter};
use crate::scenes::{BoxPairs, ClothScene, RayScene, Scene, Work};
use serde_json::{Value, json};
use sinew_scenes::blueprint::Blueprint;
use sinew_scenes::crowd::CrowdScene;

/// Interval of the steps at which depths are measured.
const PENETRATION_EVERY: usize = 10;

/// Divisor of a crowd: one of this many characters is measured, a different one after each step.
const CHARACTERS_EVERY: usize = 37;

/// Measurement of the quality by a second run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Judging {
    /// Measures only the time.
    Off,
    /// A second run, which is not timed, is measured after every step.
    On,
}

/// Largest displacement of a body in a perturbed start, metres.
const ASIDE: f32 = 1e-4;

/// Start of a scene: its blueprint's, or perturbed by a seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Start of the blueprint.
    Own,
    /// Start with bodies moved by up to 0.1 mm by this seed, equally in every engine.
    Perturbed(u64),
}

impl Start {
    /// Returns the work with this start.
    pub fn of(self, work: Work) -> Work {
        match (self, work) {
            (Self::Perturbed(seed), Work::Bodies(scene)) => Work::Bodies(scene.perturbed(seed, ASIDE)),
            (_, work) => work,
        }
    }
}

/// Returns the result as one JSON object; `"unsupported"` gives the reason for missing results.
///
/// `steps` is the number of steps; `None`: the scene's own. `effort` is that of scenes of bodies; others run with the engine's default.
pub fn run(
    engine: &dyn Engine,
    scene: &Scene,
    start: Start,
    steps: Option<usize>,
    (judging, effort): (Judging, Effort),
) -> Value {
    let work = start.of((scene.work)());
    let steps = steps.unwrap_or(work.steps());
    let mut report = engine.describe().to_json();
    report["scene"] = json!(scene.name);
    report["steps"] = json!(steps);
    let figures = match &work {
        Work::Bodies(blueprint) => run_bodies(engine, blueprint, steps, (judging, effort)),
        Work::Cloth(cloth) => run_cloth(engine, cloth, steps, judging),
        Work::Rays(rays) => run_rays(engine, rays, steps),
        Work::Boxes(pairs) => run_boxes(engine, pairs, steps),
        Work::Crowd(crowd) => run_crowd(engine, crowd, steps, judging),
    };
    match figures {
        Ok(Value::Object(figures)) => {
            report.as_object_mut().expect("a report is an object").extend(figures);
        }
        Ok(_) => unreachable!("figures are an object"),
        Err(unsupported) => report["unsupported"] = json!(unsupported.to_string()),
    }
    report
}

fn run_bodies(
    engine: &dyn Engine,
    scene: &Blueprint,
    steps: usize,
    (judging, effort): (Judging, Effort),
) -> Result<Value, Unsupported> {
    let memory = Memory::now();
    let mut simulation = engine.build_at(scene, effort)?;
    let times = StepTimes::measure(steps, |_| simulation.step());
    drop(simulation);
    let mut figures = json!({
        "bodies": scene.bodies.len(),
        "joints": scene.joints.len(),
        "cpu_ms": times.to_json(),
        "peak_rss_mib": memory.peak_above_mib(),
    });
    if judging == Judging::On {
        figures["quality"] = judge_bodies(engine, scene, steps, effort)?;
    }
    Ok(figures)
}

fn judge_bodies(
    engine: &dyn Engine,
    scene: &Blueprint,
    steps: usize,
    effort: Effort,
) -> Result<Value, Unsupported> {
    let mut simulation = engine.build_at(scene, effort)?;
    let mut meter = QualityMeter::new(scene, PENETRATION_EVERY);
    let mut states: Vec<BodyState> = Vec::new();
    let mut asleep_step = None;
    for step in 1..=steps {
        simulation.step();
        simulation.states(&mut states);
        meter.observe(&states);
        if asleep_step.is_none() && !simulation.is_awake() {
            asleep_step = Some(step);
        }
    }
    let mut quality = meter.finish(&states).to_json();
    quality["asleep_step"] = json!(asleep_step);
    Ok(quality)
}

fn run_cloth(
    engine: &dyn Engine,
    scene: &ClothScene,
    steps: usize,
    judging: Judging,
) -> Result<Value, Unsupported> {
    let memory = Memory::now();
    let mut simulation = engine.build_cloth(scene)?;
    let times = StepTimes::measure(steps, |_| simulation.step());
    let mut figures = json!({
        "bodies": scene.boxes.len() + scene.spheres.len(),
        "particles": scene.side * scene.side,
        "joints": 0,
        "cpu_ms": times.to_json(),
        "peak_rss_mib": memory.peak_above_mib(),
    });
    if judging == Judging::On {
        // Nothing was measured during the run, so only its end is judged.
        let mut particles = Vec::new();
        simulation.particles(&mut particles);
        figures["quality"] = ClothMeter::new(scene).finish(&particles).to_json();
    }
    Ok(figures)
}

fn run_rays(engine: &dyn Engine, scene: &RayScene, steps: usize) -> Result<Value, Unsupported> {
    let memory = Memory::now();
    let mut caster = engine.build_rays(scene)?;
    let (mut rays, mut hits) = (0, 0);
    let times = StepTimes::measure(steps, |step| {
        let range = scene.rays_of_step(step);
        rays += range.len();
        hits += caster.count_hits(range);
    });
    Ok(json!({
        "bodies": scene.boxes.len(),
        "joints": 0,
        "cpu_ms": times.to_json(),
        "peak_rss_mib": memory.peak_above_mib(),
        "per_step": rays / times.count(),
        "hit_share": hits as f64 / rays as f64,
    }))
}

fn run_boxes(engine: &dyn Engine, scene: &BoxPairs, steps: usize) -> Result<Value, Unsupported> {
    let memory = Memory::now();
    let mut tester = engine.build_boxes(scene)?;
    let (mut pairs, mut overlaps) = (0, 0);
    let times = StepTimes::measure(steps, |step| {
        let range = scene.pairs_of_step(step);
        pairs += range.len();
        overlaps += tester.count_overlaps(range);
    });
    Ok(json!({
        "bodies": 0,
        "joints": 0,
        "cpu_ms": times.to_json(),
        "peak_rss_mib": memory.peak_above_mib(),
        "per_step": pairs / times.count(),
        "hit_share": overlaps as f64 / pairs as f64,
    }))
}

fn run_crowd(
    engine: &dyn Engine,
    scene: &CrowdScene,
    steps: usize,
    judging: Judging,
) -> Result<Value, Unsupported> {
    let memory = Memory::now();
    let mut crowd = engine.build_crowd(scene)?;
    let times = StepTimes::measure(steps, |step| crowd.step(step));
    let mut figures = json!({
        "characters": scene.characters.len(),
        "joints": scene.rig.joints.len(),
        "cpu_ms": times.to_json(),
        "peak_rss_mib": memory.peak_above_mib(),
    });
    if judging == Judging::On {
        let mut meter = CrowdMeter::new(scene);
        for step in steps..2 * steps {
            crowd.step(step);
            for character in (step % CHARACTERS_EVERY..scene.characters.len()).step_by(CHARACTERS_EVERY) {
                meter.observe(character, step, &crowd.pose(character, step));
            }
        }
        figures["quality"] = meter.finish().to_json();
    }
    Ok(figures)
}
