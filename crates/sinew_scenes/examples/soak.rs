//! A long run of all scenes, checked in every step: `cargo xtask soak --hours 1`.
//!
//! Each scene runs for its share of the time and restarts after its usual number of steps. Checks after each step: no
//! body is lost, no joint is open by more than 5 mm, no body is faster than 30 m/s. Checks over the run: memory and
//! step time do not grow.

use sinew::math::{Vec3, max};
use sinew::physics::{BodyKind, JointState, World};
use sinew_scenes::scenes::{Instance, find};
use std::process::ExitCode;

/// A part of the soak test: a scene, its settings with `#` in place of the round's number, and the number of steps of a
/// round (`None`: a single round).
struct Part {
    name: &'static str,
    scene: &'static str,
    settings: &'static [&'static str],
    round: Option<u64>,
    /// Largest speed that one of the scene's hits gives to a limb, m/s. It is the speed limit if it exceeds `FAST`.
    blows: f32,
}

const PARTS: &[Part] = &[
    Part { name: "street", scene: "street", settings: &[], round: None, blows: 0.0 },
    Part { name: "arena", scene: "arena", settings: &[], round: None, blows: 0.0 },
    Part { name: "crowd", scene: "crowd", settings: &["impulse=#"], round: Some(900), blows: 0.0 },
    Part { name: "rope_bridge", scene: "rope_bridge", settings: &["first=#"], round: Some(1500), blows: 0.0 },
    Part {
        name: "level",
        scene: "brawl",
        settings: &["tiles=1", "crates=40", "hits=1"],
        round: None,
        blows: BLOW,
    },
    Part { name: "brawl", scene: "brawl", settings: &[], round: None, blows: BLOW },
];

/// Speed that the brawl's hit of 90 N·s gives the lightest limb, a hand of 0.4 kg, m/s.
const BLOW: f32 = 225.0;
/// Largest joint gap, metres, and largest speed, m/s.
const GAP: f32 = 5e-3;
const FAST: f32 = 30.0;
/// Depth below the floor and distance from the centre at which a body counts as lost, metres.
const SUNK: f32 = 0.5;
const FAR: f32 = 60.0;
/// Largest allowed growth of memory, bytes, and largest ratio of the last step time to the first, over a run.
const GROWTH: f64 = 8e6;
const SLOWER: f64 = 1.5;

/// Measurements of a part.
#[derive(Default)]
struct Seen {
    steps: u64,
    gap: f32,
    gap_at: u64,
    open: u64,
    speed: f32,
    speed_at: u64,
    fast: u64,
    lost: u64,
    /// Memory, bytes, and step time, seconds, in the second and in the last tenth of the run.
    memory: [f64; 2],
    seconds: [f64; 2],
}

impl Seen {
    fn look(&mut self, world: &World) {
        let step = self.steps;
        let enabled = |&joint: &sinew::physics::JointId| world.joint(joint).state == JointState::Enabled;
        let gap = world.joint_ids().filter(enabled).map(|joint| world.joint_gap(joint)).fold(0.0, max);
        self.open += u64::from(gap > GAP);
        if gap > self.gap {
            (self.gap, self.gap_at) = (gap, step);
        }
        let mut fastest: f32 = 0.0;
        for body in world.body_ids().filter(|&body| world.kind(body) == BodyKind::Dynamic) {
            fastest = max(fastest, world.velocity(body).linear.length());
            let at = world.center_of_mass(body);
            let is_lost = at.y < -SUNK || (at * Vec3::new(1.0, 0.0, 1.0)).length() > FAR || !at.is_finite();
            self.lost += u64::from(is_lost);
        }
        self.lost += world.events().quarantined.len() as u64;
        self.fast += u64::from(fastest > FAST);
        if fastest > self.speed {
            (self.speed, self.speed_at) = (fastest, step);
        }
    }

    fn faults(&self, part: &Part) -> Vec<String> {
        let mut faults = Vec::new();
        if self.lost > 0 {
            faults.push(format!("bodies are lost in {} steps", self.lost));
        }
        if self.gap > GAP {
            faults.push(format!(
                "a joint is open by {:.1} mm at {:.2} s, some in {} steps",
                1e3 * self.gap,
                self.gap_at as f32 / 60.0,
                self.open
            ));
        }
        if self.speed > max(FAST, part.blows) {
            faults.push(format!(
                "the fastest body moves at {:.1} m/s at {:.2} s",
                self.speed,
                self.speed_at as f32 / 60.0
            ));
        }
        if self.memory[1] > self.memory[0] + GROWTH {
            faults.push(format!(
                "memory grows from {:.1} to {:.1} MB",
                1e-6 * self.memory[0],
                1e-6 * self.memory[1]
            ));
        }
        if self.seconds[1] > SLOWER * self.seconds[0] {
            faults.push(format!(
                "the step time grows from {:.2} to {:.2} ms",
                1e3 * self.seconds[0],
                1e3 * self.seconds[1]
            ));
        }
        faults
    }
}

/// Memory of the process, bytes; 0 if it is unknown.
fn memory() -> f64 {
    let pages = std::fs::read_to_string("/proc/self/statm").ok();
    let pages = pages.and_then(|text| text.split(' ').nth(1)?.parse::<f64>().ok());
    pages.unwrap_or(0.0) * 4096.0
}

/// CPU time of this thread, which excludes that of other processes, seconds; 0 if it is unknown.
fn processor_seconds() -> f64 {
    let statistics = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = statistics.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    1e-9 * nanoseconds.unwrap_or(0.0)
}

fn started(part: &Part, round: u64) -> Instance {
    let scene = find(part.scene).expect("the scene is registered");
    let mut settings = scene.settings();
    for setting in part.settings {
        // Skip the round numbers that the setting does not allow.
        let number = if part.scene == "crowd" { 50 + round % 40 } else { round };
        settings.assign(&setting.replace('#', &number.to_string())).expect("the value is in range");
    }
    scene.start(&settings)
}

fn soaked(part: &Part, steps: u64) -> Seen {
    let mut seen = Seen::default();
    let mut run = started(part, 0);
    let tenth = u64::max(steps / 10, 1);
    while seen.steps < steps {
        if let Some(round) = part.round.filter(|&round| seen.steps > 0 && seen.steps.is_multiple_of(round)) {
            run = started(part, seen.steps / round);
        }
        let began = processor_seconds();
        run.step();
        let took = processor_seconds() - began;
        for (place, of) in [1, 9].into_iter().enumerate() {
            if seen.steps / tenth == of {
                seen.seconds[place] += took / tenth as f64;
                seen.memory[place] = memory();
            }
        }
        seen.look(run.world());
        seen.steps += 1;
        if seen.steps.is_multiple_of(tenth) {
            eprintln!("{}: {:.1} min of {:.1}", part.name, seen.steps as f32 / 3600.0, steps as f32 / 3600.0);
        }
    }
    seen
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let hours: f64 =
        arguments.first().map_or(1.0, |hours| hours.parse().expect("hours of game, such as 0.25"));
    let is_asked = |part: &&Part| arguments.len() < 2 || arguments[1..].iter().any(|name| name == part.name);
    let parts: Vec<&Part> = PARTS.iter().filter(is_asked).collect();
    let steps = (hours * 216_000.0 / parts.len() as f64) as u64;
    let mut is_well = true;
    println!("scene        minutes  gap mm  speed m/s  fast  lost  memory MB        ms a step");
    for part in parts {
        let seen = soaked(part, steps);
        let ([m, n], [s, t]) =
            (seen.memory.map(|bytes| 1e-6 * bytes), seen.seconds.map(|seconds| 1e3 * seconds));
        println!(
            "{:12} {:7.1} {:7.2} {:10.1} {:5} {:5}  {m:6.1} → {n:6.1}  {s:5.2} → {t:5.2}",
            part.name,
            seen.steps as f32 / 3600.0,
            1e3 * seen.gap,
            seen.speed,
            seen.fast,
            seen.lost
        );
        for fault in seen.faults(part) {
            println!("  {fault}");
            is_well = false;
        }
    }
    if is_well { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
