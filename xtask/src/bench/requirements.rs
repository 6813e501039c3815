//! Requirements on Sinew, and whether they are met.

use super::figures::{
    ASLEEP, CLOTH, DEPTH, DEPTH_END, DEPTH_P99, Figure, GAP, GAP_PER_LINK, LIMITS, SHIFT, STRETCH,
    STRETCH_END, came_apart, rounded,
};
use super::results::{EngineResult, Results, SceneResult};

/// Verdict on a requirement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The goal is met.
    Goal,
    /// The requirement is met.
    Met,
    /// The requirement is missed.
    Missed,
    /// The requirement is not measurable yet, with the reason.
    Open(String),
    /// The measurement was not requested.
    NotRun,
}

/// A row of the specification's table of speeds.
pub struct Speed {
    /// Wording of the requirement in the specification.
    pub work: &'static str,
    /// Required value.
    pub bar: Bar,
}

/// Required value of a [`Speed`].
pub enum Bar {
    /// A factor with a required minimum and a goal.
    Factor { must: f64, goal: f64, measure: Measure },
    /// The requirement is measured elsewhere.
    Elsewhere { must: &'static str, goal: &'static str, why: &'static str },
}

/// Source of a [`Speed`]'s factor.
#[derive(Clone, Copy)]
pub enum Measure {
    /// A scene: the fastest peer's mean step over Sinew's.
    Peers(&'static str),
    /// A scene: the fastest peer's 99th percentile over Sinew's.
    PeersP99(&'static str),
    /// Like `Peers`, but only against peers whose joints stayed together. If there are none, there is no requirement.
    PeersTogether(&'static str),
    /// Like `Peers`, but only against peers whose metric is within a bound. If Sinew's exceeds it, the requirement is
    /// missed.
    PeersWithin(&'static str, &'static Figure, f64),
    /// A metric of characters that fall limp until they sleep, in seconds per second.
    Limp(&'static str),
    /// The bake of one character, in seconds per second.
    Bake,
    /// Number of conversions of a rig of 6,000 vertices to a ragdoll in 100 ms.
    Build,
    /// Wall time of a scene on one thread over that on two.
    Threads(&'static str),
}

/// The cloth race, and the mean stretch up to which a peer counts: that of Jolt.
const CLOTH_RACE: &str = "cloth, against those that stretch by 3.1 % at most";
const CLOTH_STRETCH: f64 = 0.031;

/// Speeds of limp characters: the median of all rigs, and the slowest humanoid.
const LIMP: [Measure; 2] = [Measure::Limp("median"), Measure::Limp("slowest_humanoid")];

const fn factor(work: &'static str, must: f64, goal: f64, measure: Measure) -> Speed {
    Speed { work, bar: Bar::Factor { must, goal, measure } }
}

/// Returns the requirement on a chain whose joints hold.
const fn together(work: &'static str, scene: &'static str) -> Speed {
    factor(work, 0.8, 1.5, Measure::PeersTogether(scene))
}

const fn elsewhere(work: &'static str, must: &'static str, goal: &'static str, why: &'static str) -> Speed {
    Speed { work, bar: Bar::Elsewhere { must, goal, why } }
}

/// Section 5 of the specification, and an additional requirement on animation speed.
pub const SPEEDS: &[Speed] = &[
    factor("ragdoll pile", 1.0, 1.5, Measure::Peers("ragdoll_pile")),
    factor("ragdoll pile, 99th percentile", 0.6, 1.0, Measure::PeersP99("ragdoll_pile")),
    factor("pile of our own ragdolls", 1.0, 1.5, Measure::Peers("crowd_pile")),
    factor("pile of our own ragdolls, 99th percentile", 0.6, 1.0, Measure::PeersP99("crowd_pile")),
    factor("rain of ragdolls", 1.0, 1.5, Measure::Peers("rain")),
    factor("rain of ragdolls, 99th percentile", 0.6, 1.0, Measure::PeersP99("rain")),
    factor("ragdolls until asleep", 1.0, 1.5, Measure::Peers("ragdolls")),
    factor("wave pile until asleep", 1.0, 1.5, Measure::Peers("wave_pile")),
    factor("mesh drop until asleep", 1.0, 1.5, Measure::Peers("mesh_drop")),
    factor("box pyramid", 1.3, 2.0, Measure::Peers("box_pyramid")),
    factor("box pile", 1.0, 2.0, Measure::Peers("box_rain")),
    factor("wall of boxes", 1.3, 2.0, Measure::Peers("large_pyramid")),
    factor("10,000 boxes in one heap", 1.0, 1.5, Measure::Peers("boxes_10000")),
    together("chains of 100 links", "chain_100_links"),
    factor("hanging rope", 1.2, 1.5, Measure::PeersTogether("hanging_rope")),
    together("heavy rope", "heavy_rope"),
    together("swinging chain, 1,000 kg", "chain_swing_1000"),
    together("swinging chain, 1,000 kg, links of 0.5 m", "chain_swing_1000_half"),
    together("swinging chain, 1,000 kg, links of 0.25 m", "chain_swing_1000_quarter"),
    together("swinging chain, 100 kg", "chain_swing_100"),
    together("hanging chain, 100 kg", "chain_hang_100"),
    together("hanging chain, 1,000 kg", "chain_hang_1000"),
    factor("joint grid", 1.0, 2.0, Measure::Peers("joint_grid")),
    factor("net", 1.0, 2.0, Measure::Peers("net")),
    factor("a humanoid lying awake, against MuJoCo", 5.0, 10.0, Measure::Peers("humanoid_lying")),
    factor("10 humanoids in a heap, against MuJoCo", 5.0, 10.0, Measure::Peers("humanoid_pile_10")),
    factor("100 humanoids in a heap, against MuJoCo", 5.0, 10.0, Measure::Peers("humanoid_pile_100")),
    factor(CLOTH_RACE, 2.4, 3.0, Measure::PeersWithin("cloth", &CLOTH, CLOTH_STRETCH)),
    elsewhere(
        "separating axes of two boxes: share of the limit",
        "≥ 0.6",
        "0.8",
        "`cargo xtask bench --kernels` measures it",
    ),
    elsewhere(
        "point in box, springs: share of the limit",
        "≥ 0.66 and 0.4",
        "0.8",
        "`cargo xtask bench --kernels` measures it",
    ),
    factor("rays against 10,000 boxes", 2.0, 3.0, Measure::Peers("rays")),
    factor("sample and blend two clips of 50 joints", 1.5, 1.5, Measure::Peers("crowd")),
    elsewhere("heap allocations per step", "0", "0", "a test counts them: `a_warm_step_allocates_nothing`"),
    factor("rig file of 6,000 vertices to ragdoll, against 100 ms", 1.0, 10.0, Measure::Build),
    factor(
        "a limp character, from release until it sleeps, against real time: median of all rigs",
        300.0,
        550.0,
        LIMP[0],
    ),
    factor("the same, the slowest humanoid", 200.0, 550.0, LIMP[1]),
    factor("the same, the demo's whole bake beside it", 400.0, 550.0, Measure::Bake),
    factor("two threads on two free cores: box pile", 1.5, 1.8, Measure::Threads("box_rain")),
    factor("two threads on two free cores: ragdoll pile", 1.5, 1.8, Measure::Threads("ragdoll_pile")),
];

impl Speed {
    /// Returns the measured factor and the verdict.
    pub fn judge(&self, results: &Results) -> (Option<f64>, Verdict) {
        let (must, goal, measure) = match self.bar {
            Bar::Factor { must, goal, measure } => (must, goal, measure),
            Bar::Elsewhere { why, .. } => return (None, Verdict::Open(why.to_owned())),
        };
        match measure.take(results) {
            Err(verdict) => (None, verdict),
            Ok(value) if value >= goal => (Some(value), Verdict::Goal),
            Ok(value) if value >= must => (Some(value), Verdict::Met),
            Ok(value) => (Some(value), Verdict::Missed),
        }
    }
}

impl Measure {
    fn take(self, results: &Results) -> Result<f64, Verdict> {
        let factor = match self {
            Self::Limp(figure) => results.limp.get(figure).copied(),
            Self::Bake => results.bake,
            Self::Build => results.build,
            Self::Threads(scene) => results.threads.get(scene).copied(),
            Self::Peers(scene) => raced(results, scene)?.0.speed(),
            Self::PeersP99(scene) => raced(results, scene)?.0.p99_speed(),
            Self::PeersTogether(scene) => Some(speed_together(raced(results, scene)?.0)?),
            Self::PeersWithin(scene, figure, most) => {
                Some(speed_within(raced(results, scene)?.0, figure, most)?)
            }
        };
        factor.ok_or(Verdict::NotRun)
    }
}

/// Returns a scene that Sinew completed. A crash or a timeout misses the requirement; a missing scene is open.
fn raced<'a>(results: &'a Results, scene: &str) -> Result<(&'a SceneResult, &'a EngineResult), Verdict> {
    let scene = results.scene(scene).ok_or(Verdict::NotRun)?;
    let ours = scene.sinew().ok_or(Verdict::NotRun)?;
    match ours.missing_reason() {
        None => Ok((scene, ours)),
        Some(_) if ours.is_failed() => Err(Verdict::Missed),
        Some(why) => Err(Verdict::Open(why.to_owned())),
    }
}

/// Returns the speed like [`SceneResult::speed`], against peers whose joints stay together.
fn speed_together(scene: &SceneResult) -> Result<f64, Verdict> {
    let mut fair = scene.clone();
    fair.engines.retain(|engine| engine.is_sinew() || !came_apart(engine));
    fair.speed().ok_or_else(|| Verdict::Open("no bar: peers come apart".to_owned()))
}

/// Returns the speed like [`SceneResult::speed`], against peers with a metric within the bound, which Sinew's must
/// meet, too.
fn speed_within(scene: &SceneResult, figure: &Figure, most: f64) -> Result<f64, Verdict> {
    let holds = |engine: &EngineResult| (figure.of)(engine).is_some_and(|it| it <= most);
    if !scene.sinew().is_some_and(holds) {
        return Err(Verdict::Missed);
    }
    let mut fair = scene.clone();
    fair.engines.retain(holds);
    fair.speed().ok_or_else(|| Verdict::Open("no bar: peers stretch more".to_owned()))
}

/// A row of a table of requirements.
pub struct Hold {
    /// The scene.
    pub scene: &'static str,
    /// Checked metric.
    pub figure: &'static Figure,
    /// Bound of the requirement.
    pub most: Most,
}

/// Bound on a metric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Most {
    /// At most this value.
    Value(f64),
    /// At most the best peer's.
    BestPeer,
}

const fn hold(scene: &'static str, figure: &'static Figure, most: f64) -> Hold {
    Hold { scene, figure, most: Most::Value(most) }
}

const fn as_peers(scene: &'static str, figure: &'static Figure) -> Hold {
    Hold { scene, figure, most: Most::BestPeer }
}

/// Requirements on joints, which must not open.
pub const HOLDS: &[Hold] = &[
    hold("chain_swing_1000", &GAP, 1e-3),
    hold("chain_swing_1000_half", &GAP, 1e-3),
    hold("chain_swing_1000_quarter", &GAP, 1e-3),
    hold("chain_swing_100", &GAP, 2e-4),
    hold("chain_hang_100", &GAP, 2e-4),
    hold("chain_hang_1000", &GAP, 1e-3),
    hold("chain_100_links", &STRETCH, 1e-3),
    hold("chain_100_links", &STRETCH_END, 1e-3),
    hold("heavy_rope", &GAP_PER_LINK, 5e-3),
    hold("hanging_rope", &GAP_PER_LINK, 5e-3),
    as_peers("joint_grid", &GAP),
    as_peers("net", &GAP),
    hold("ragdoll_pile", &GAP, 2e-3),
    hold("ragdoll_pile", &LIMITS, 0.0),
    hold("crowd_pile", &GAP, 2e-3),
    hold("crowd_pile", &LIMITS, 0.0),
];

/// Requirements on stacks, which must stand, and on heaps, which must fall asleep.
pub const STANDS: &[Hold] = &[
    as_peers("box_pyramid", &SHIFT),
    as_peers("box_pyramid", &DEPTH),
    as_peers("large_pyramid", &SHIFT),
    as_peers("large_pyramid", &DEPTH),
    as_peers("box_rain", &DEPTH),
    as_peers("boxes_10000", &DEPTH),
    as_peers("boxes_10000", &DEPTH_END),
    as_peers("ragdoll_pile", &DEPTH),
    as_peers("ragdoll_pile", &DEPTH_END),
    as_peers("ragdoll_pile", &DEPTH_P99),
    as_peers("crowd_pile", &DEPTH),
    as_peers("crowd_pile", &DEPTH_END),
    as_peers("crowd_pile", &DEPTH_P99),
    as_peers("rain", &GAP),
    as_peers("rain", &DEPTH),
    as_peers("stack_mass_ratio", &SHIFT),
    as_peers("stack_ratio", &SHIFT),
    as_peers("jenga", &SHIFT),
    as_peers("cards", &SHIFT),
    as_peers("arch", &SHIFT),
    as_peers("ragdolls", &ASLEEP),
    as_peers("wave_pile", &ASLEEP),
    as_peers("mesh_drop", &ASLEEP),
];

impl Hold {
    /// Returns the verdict on Sinew's metric.
    pub fn judge(&self, results: &Results) -> Verdict {
        let (scene, ours) = match raced(results, self.scene) {
            Ok(raced) => raced,
            Err(verdict) => return verdict,
        };
        let most = match self.most {
            Most::Value(most) => most,
            Most::BestPeer => {
                scene.peers().filter_map(self.figure.of).min_by(f64::total_cmp).unwrap_or(f64::INFINITY)
            }
        };
        let holds = (self.figure.of)(ours).is_some_and(|figure| figure <= most);
        if holds { Verdict::Met } else { Verdict::Missed }
    }

    /// Returns the requirement in words.
    pub fn must(&self) -> String {
        match self.most {
            Most::Value(0.0) => "0".to_owned(),
            Most::Value(most) => format!("≤ {}", self.figure.unit.show_bound(most)),
            Most::BestPeer => "≤ best peer".to_owned(),
        }
    }
}

/// Returns a line for each missed row of the specification's table, and for each that is not measurable yet.
pub fn shortfalls(results: &Results) -> (Vec<String>, Vec<String>) {
    let (mut missed, mut open) = (Vec::new(), Vec::new());
    for speed in SPEEDS {
        match speed.judge(results) {
            (_, Verdict::Goal | Verdict::Met | Verdict::NotRun) => {}
            (_, Verdict::Open(why)) => open.push(format!("{}: {why}", speed.work)),
            (value, Verdict::Missed) => {
                let value =
                    value.map_or("does not finish".to_owned(), |value| format!("{}×", rounded(value)));
                missed.push(format!("{}: {value}, must be {}", speed.work, speed.bar.must()));
            }
        }
    }
    (missed, open)
}

impl Bar {
    /// Returns the required minimum.
    pub fn must(&self) -> String {
        match self {
            Self::Factor { must, .. } => format!("≥ {must}×"),
            Self::Elsewhere { must, .. } => (*must).to_owned(),
        }
    }

    /// Returns the text of the goal, without the comparison sign.
    pub fn goal(&self) -> String {
        match self {
            Self::Factor { goal, .. } => format!("{goal}×"),
            Self::Elsewhere { goal, .. } => (*goal).to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::results::tests::{engine, scene};
    use super::*;
    use serde_json::{Value, json};

    fn of(name: &str, ours: EngineResult, theirs: EngineResult) -> Results {
        Results { scenes: vec![scene(name, vec![ours, theirs])], ..Results::default() }
    }

    fn speed(work: &str) -> &'static Speed {
        SPEEDS.iter().find(|speed| speed.work == work).expect("the table has the row")
    }

    #[test]
    fn speeds_are_met_and_missed() {
        let pile = |ours: f64| {
            let results = of(
                "ragdoll_pile",
                engine("sinew", &[ours], &Value::Null),
                engine("jolt", &[4.0], &Value::Null),
            );
            speed("ragdoll pile").judge(&results)
        };
        assert_eq!(pile(1.0), (Some(4.0), Verdict::Goal));
        assert_eq!(pile(3.2), (Some(1.25), Verdict::Met));
        assert_eq!(pile(5.0), (Some(0.8), Verdict::Missed));
        assert_eq!(speed("ragdoll pile").judge(&Results::default()).1, Verdict::NotRun);
    }

    #[test]
    fn unsupported_scenes_are_open_and_crashes_are_missed() {
        let ours =
            |key: &str| EngineResult { name: "sinew".into(), reports: vec![json!({ key: "no cloth" })] };
        let cloth = |key| of("cloth", ours(key), engine("jolt", &[3.0], &json!({ "stretch_mean": 0.03 })));
        assert_eq!(speed(CLOTH_RACE).judge(&cloth("unsupported")).1, Verdict::Open("no cloth".into()));
        assert_eq!(speed(CLOTH_RACE).judge(&cloth("failed")).1, Verdict::Missed);
        let (missed, _) = shortfalls(&cloth("failed"));
        assert_eq!(
            missed,
            ["cloth, against those that stretch by 3.1 % at most: does not finish, must be ≥ 2.4×"]
        );
    }

    #[test]
    fn peers_with_open_joints_set_no_bar() {
        let gap = |metres: f64| json!({ "joint_gap_peak_m": metres });
        let judge = |gap_of_peer| {
            let (ours, theirs) =
                (engine("sinew", &[4.0], &gap(0.0)), engine("jolt", &[1.0], &gap(gap_of_peer)));
            speed("hanging chain, 1,000 kg").judge(&of("chain_hang_1000", ours, theirs))
        };
        assert_eq!(judge(0.3), (Some(0.25), Verdict::Missed));
        assert_eq!(judge(30.0), (None, Verdict::Open("no bar: peers come apart".into())));
    }

    #[test]
    fn stretching_cloth_sets_no_bar_and_misses() {
        let cloth = |stretch: f64| json!({ "stretch_mean": stretch });
        let judge = |ours: f64, theirs: f64| {
            let (ours, theirs) =
                (engine("sinew", &[4.0], &cloth(ours)), engine("jolt", &[3.0], &cloth(theirs)));
            speed(CLOTH_RACE).judge(&of("cloth", ours, theirs))
        };
        assert_eq!(judge(0.02, 0.03), (Some(0.75), Verdict::Missed));
        assert_eq!(judge(0.02, 0.08), (None, Verdict::Open("no bar: peers stretch more".into())));
        assert_eq!(judge(0.04, 0.03).1, Verdict::Missed);
    }

    #[test]
    fn scenes_that_never_sleep_miss() {
        let asleep = |step: Option<u32>| json!({ "asleep_step": step });
        let ragdolls = STANDS.iter().find(|hold| hold.scene == "ragdolls").expect("the table has the row");
        let judge = |ours| {
            let peer = engine("box3d", &[1.0], &asleep(Some(307)));
            ragdolls.judge(&of("ragdolls", engine("sinew", &[1.0], &asleep(ours)), peer))
        };
        assert_eq!(judge(Some(307)), Verdict::Met);
        assert_eq!(judge(Some(308)), Verdict::Missed);
        assert_eq!(judge(None), Verdict::Missed);
    }

    #[test]
    fn joints_hold_or_not() {
        let gap = |gap: f64| json!({ "joint_gap_peak_m": gap });
        let net = HOLDS.iter().find(|hold| hold.scene == "net").expect("the table has the row");
        let judge = |ours, theirs| {
            let results =
                of("net", engine("sinew", &[1.0], &gap(ours)), engine("rapier", &[1.0], &gap(theirs)));
            net.judge(&results)
        };
        assert_eq!(judge(0.01, 0.02), Verdict::Met);
        assert_eq!(judge(0.03, 0.02), Verdict::Missed);
        assert_eq!(HOLDS[0].must(), "≤ 1 mm");
    }
}
