//! Measured results: the unmodified reports of the peers, and the results in them.

use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Results of all scenes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Results {
    /// Scenes in the order of the peers' list.
    pub scenes: Vec<SceneResult>,
    /// Scenes on each engine at several efforts, which an engine's name contains.
    pub efforts: Vec<SceneResult>,
    /// Simulated seconds per processor second of a bake on one thread, if measured.
    pub bake: Option<f64>,
    /// Number of conversions of a rig of 6,000 vertices to a ragdoll in 100 ms, if measured with the bake.
    pub build: Option<f64>,
    /// Simulated seconds per processor second of limp characters until they sleep: `median` of all rigs and
    /// `slowest_humanoid`, if measured.
    pub limp: BTreeMap<String, f64>,
    /// Wall time on one thread over that on two, by scene, if measured.
    pub threads: BTreeMap<String, f64>,
    /// Machine of the last measurement as text; `None` in older files.
    pub machine: Option<String>,
}

/// Results of a scene on all engines, with interleaved rounds.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneResult {
    /// Name in the peers' list.
    pub name: String,
    /// One-line description.
    pub about: String,
    /// Commit that was measured.
    pub revision: String,
    /// Results of the engines, Sinew first.
    pub engines: Vec<EngineResult>,
}

/// Results of a scene on one engine.
#[derive(Clone, Debug, PartialEq)]
pub struct EngineResult {
    /// Name in the peers' list.
    pub name: String,
    /// One report from each round, unmodified.
    pub reports: Vec<Value>,
}

/// Processor time of a step, milliseconds: each field is a statistic over the steps of a round, and its median over the
/// rounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Times {
    /// Mean step: the time of the whole run divided by its steps, impacts and sleep included.
    pub mean: f64,
    /// Mean step of the best round.
    pub best: f64,
    /// Median step.
    pub median: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Slowest step; older results lack it.
    pub worst: Option<f64>,
    /// Median of the last third of the steps.
    pub last_third: f64,
}

impl Results {
    /// Returns the scene of that name, if it was measured.
    pub fn scene(&self, name: &str) -> Option<&SceneResult> {
        self.scenes.iter().find(|scene| scene.name == name)
    }

    /// Returns true if the scene of that name was measured, or the bake, the limp characters or the threads.
    pub fn has(&self, name: &str) -> bool {
        self.scene(name).is_some()
            || name == super::BAKE && self.bake.is_some()
            || name == super::EFFORT && !self.efforts.is_empty()
            || name == super::LIMP && !self.limp.is_empty()
            || name == super::THREADS && !self.threads.is_empty()
    }

    /// Merges newer results in the order of `names`, and drops scenes not listed there.
    pub fn update(&mut self, newer: Self, names: &[&str]) {
        let older = std::mem::replace(self, newer);
        self.bake = self.bake.or(older.bake);
        self.build = self.build.or(older.build);
        self.machine = self.machine.take().or(older.machine);
        if self.efforts.is_empty() {
            self.efforts = older.efforts;
        }
        for (newer, older) in [(&mut self.threads, older.threads), (&mut self.limp, older.limp)] {
            older.into_iter().for_each(|(name, factor)| {
                newer.entry(name).or_insert(factor);
            });
        }
        let mut found: Vec<SceneResult> = self.scenes.drain(..).chain(older.scenes).collect();
        for name in names {
            if let Some(at) = found.iter().position(|scene| scene.name == *name) {
                self.scenes.push(found.remove(at));
            }
        }
    }

    /// Returns the content of the file.
    pub fn to_json(&self) -> Value {
        let engine = |engine: &EngineResult| (engine.name.clone(), Value::from(engine.reports.clone()));
        let scene = |scene: &SceneResult| {
            json!({
                "scene": scene.name,
                "about": scene.about,
                "revision": scene.revision,
                "engines": Value::Object(scene.engines.iter().map(engine).collect()),
            })
        };
        let [scenes, efforts] =
            [&self.scenes, &self.efforts].map(|scenes| scenes.iter().map(scene).collect::<Vec<Value>>());
        json!({
            "sinew": "benchmarks",
            "version": 1,
            "bake_realtime_factor": self.bake,
            "builds_in_100_ms": self.build,
            "limp_realtime_factor": self.limp,
            "two_threads": self.threads,
            "machine": self.machine,
            "scenes": scenes,
            "efforts": efforts,
        })
    }

    /// Reads results; unreadable entries count as not measured.
    pub fn from_json(value: &Value) -> Self {
        let scenes = |key: &str| value[key].as_array().into_iter().flatten().filter_map(scene).collect();
        let factors = |key: &str| value[key].as_object().into_iter().flatten().filter_map(factor).collect();
        Self {
            scenes: scenes("scenes"),
            efforts: scenes("efforts"),
            bake: value["bake_realtime_factor"].as_f64(),
            build: value["builds_in_100_ms"].as_f64(),
            limp: factors("limp_realtime_factor"),
            threads: factors("two_threads"),
            machine: value["machine"].as_str().map(str::to_owned),
        }
    }
}

fn factor((name, value): (&String, &Value)) -> Option<(String, f64)> {
    Some((name.clone(), value.as_f64()?))
}

fn scene(value: &Value) -> Option<SceneResult> {
    let text = |key: &str| value[key].as_str().map(str::to_owned);
    let engine = |(name, reports): (&String, &Value)| {
        Some(EngineResult { name: name.clone(), reports: reports.as_array()?.clone() })
    };
    Some(SceneResult {
        name: text("scene")?,
        about: text("about")?,
        revision: text("revision")?,
        engines: value["engines"].as_object()?.iter().filter_map(engine).collect(),
    })
}

impl SceneResult {
    /// Returns Sinew's result.
    pub fn sinew(&self) -> Option<&EngineResult> {
        self.engines.iter().find(|engine| engine.is_sinew())
    }

    /// Returns the peers' results.
    pub fn peers(&self) -> impl Iterator<Item = &EngineResult> {
        self.engines.iter().filter(|engine| !engine.is_sinew())
    }

    /// Returns Sinew's speed: the mean step of an engine divided by ours, if both ran.
    pub fn speed_against(&self, engine: &EngineResult) -> Option<f64> {
        self.ratio_against(engine, |times| times.mean)
    }

    /// Returns Sinew's speed by the 99th percentile: that of an engine divided by ours, if both ran.
    pub fn p99_speed_against(&self, engine: &EngineResult) -> Option<f64> {
        self.ratio_against(engine, |times| times.p99)
    }

    fn ratio_against(&self, engine: &EngineResult, of: impl Fn(Times) -> f64) -> Option<f64> {
        Some(of(engine.times()?) / of(self.sinew()?.times()?))
    }

    /// Returns Sinew's speed against the fastest peer, by the mean step.
    pub fn speed(&self) -> Option<f64> {
        self.peers().filter_map(|peer| self.speed_against(peer)).min_by(f64::total_cmp)
    }

    /// Returns Sinew's speed by the 99th percentile, against the peer with the smallest.
    pub fn p99_speed(&self) -> Option<f64> {
        self.peers().filter_map(|peer| self.p99_speed_against(peer)).min_by(f64::total_cmp)
    }

    /// Returns a number that is the same for all engines, such as `bodies`.
    pub fn size(&self, key: &str) -> Option<u64> {
        self.engines.iter().find_map(|engine| engine.reports.first()?[key].as_u64())
    }
}

impl EngineResult {
    /// Returns true for Sinew.
    pub fn is_sinew(&self) -> bool {
        self.name == "sinew"
    }

    /// Returns true if the engine crashed or timed out.
    pub fn is_failed(&self) -> bool {
        self.reports.iter().any(|report| report["failed"].is_string())
    }

    /// Returns the reason for missing results.
    pub fn missing_reason(&self) -> Option<&str> {
        let report = self.reports.last()?;
        report["unsupported"].as_str().or_else(|| report["failed"].as_str())
    }

    /// Returns the processor times, if the engine ran.
    pub fn times(&self) -> Option<Times> {
        let over_rounds = |key: &str| -> Option<Vec<f64>> {
            let mut values: Vec<f64> =
                self.reports.iter().map(|report| report["cpu_ms"][key].as_f64()).collect::<Option<_>>()?;
            values.sort_by(f64::total_cmp);
            (!values.is_empty()).then_some(values)
        };
        let median = |key: &str| over_rounds(key).map(|values| values[values.len() / 2]);
        Some(Times {
            mean: median("mean")?,
            best: over_rounds("mean")?[0],
            median: median("median")?,
            p99: median("p99")?,
            worst: median("worst"),
            last_third: median("last_third")?,
        })
    }

    /// Returns the peak memory of the scene, MiB.
    pub fn memory(&self) -> Option<f64> {
        self.reports.iter().filter_map(|report| report["peak_rss_mib"].as_f64()).min_by(f64::total_cmp)
    }

    /// Returns the median of a metric over the judged runs; `None` if one lacks it.
    pub fn judged(&self, figure: impl Fn(&Map<String, Value>) -> Option<f64>) -> Option<f64> {
        let runs = self.reports.iter().filter_map(|report| report["quality"].as_object());
        let mut values: Vec<f64> = runs.map(figure).collect::<Option<_>>()?;
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied()
    }

    /// Returns a text such as `version`.
    pub fn text(&self, key: &str) -> Option<&str> {
        self.reports.first()?[key].as_str()
    }

    /// Returns a number listed beside the times.
    pub fn number(&self, key: &str) -> Option<f64> {
        self.reports.first()?[key].as_f64()
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// Returns an engine with a round for each of these mean times.
    pub fn engine(name: &str, means: &[f64], quality: &Value) -> EngineResult {
        let report = |&mean: &f64| {
            json!({
                "engine": name, "version": "1", "flags": "-O3", "settings": "defaults",
                "steps": 100, "bodies": 10, "joints": 5, "peak_rss_mib": 2.5,
                "cpu_ms": { "mean": mean, "median": 0.5 * mean, "p99": 2.0 * mean, "last_third": mean },
                "quality": quality,
            })
        };
        EngineResult { name: name.into(), reports: means.iter().map(report).collect() }
    }

    /// Returns a scene of these engines.
    pub fn scene(name: &str, engines: Vec<EngineResult>) -> SceneResult {
        SceneResult { name: name.into(), about: "a scene".into(), revision: "abc".into(), engines }
    }

    #[test]
    fn times_are_medians_over_the_rounds() {
        let times = engine("sinew", &[3.0, 1.0, 2.0], &Value::Null).times().expect("the engine ran");
        assert_eq!(
            times,
            Times { mean: 2.0, best: 1.0, median: 1.0, p99: 4.0, worst: None, last_third: 2.0 }
        );
        let failed = EngineResult { name: "x".into(), reports: vec![json!({ "failed": "stopped" })] };
        assert_eq!((failed.times(), failed.missing_reason()), (None, Some("stopped")));
    }

    #[test]
    fn figures_of_several_starts_are_medians() {
        let runs = |gaps: &[Value]| {
            let report = |gap: &Value| json!({ "quality": { "joint_gap_peak_m": gap } });
            let reports = gaps.iter().map(report).chain([json!({})]).collect();
            let gap = |quality: &Map<String, Value>| quality.get("joint_gap_peak_m")?.as_f64();
            EngineResult { name: "sinew".into(), reports }.judged(gap)
        };
        assert_eq!(runs(&[json!(3.0), json!(1.0), json!(2.0)]), Some(2.0));
        assert_eq!(runs(&[json!(3.0), json!(null)]), None, "not a number in one of them");
        assert_eq!(runs(&[]), None);
    }

    #[test]
    fn speed_is_against_the_fastest_peer() {
        let ours = engine("sinew", &[2.0], &Value::Null);
        let peers = [engine("rapier", &[3.0], &Value::Null), engine("jolt", &[4.0], &Value::Null)];
        let pile = scene("pile", [vec![ours.clone()], peers.into()].concat());
        assert_eq!((pile.speed(), pile.p99_speed()), (Some(1.5), Some(1.5)));
        assert_eq!(scene("pile", vec![ours]).speed(), None);
    }

    #[test]
    fn newer_figures_replace_older_ones_and_keep_the_order() {
        let of = |name: &str, time| scene(name, vec![engine("sinew", &[time], &Value::Null)]);
        let mut results = Results {
            scenes: vec![of("c", 1.0), of("gone", 1.0), of("a", 1.0)],
            efforts: vec![of("a", 3.0)],
            bake: Some(5.0),
            machine: Some("a machine".to_owned()),
            limp: BTreeMap::from([("median".to_owned(), 3.0)]),
            threads: BTreeMap::from([("a".to_owned(), 1.5)]),
            ..Results::default()
        };
        let newer = Results { scenes: vec![of("b", 2.0), of("a", 2.0)], ..Results::default() };
        results.update(newer, &["a", "b", "c"]);
        assert_eq!(results.scenes, [of("a", 2.0), of("b", 2.0), of("c", 1.0)]);
        assert_eq!((results.bake, results.limp["median"], results.threads["a"]), (Some(5.0), 3.0, 1.5));
        assert_eq!(results.efforts, [of("a", 3.0)]);
        assert_eq!(Results::from_json(&results.to_json()), results);
    }
}
