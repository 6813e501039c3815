//! Characters that play several animation tracks at the same time.

use crate::framework::actors::{Actor, Cast, Figure, Gone};
use crate::framework::camera_hint::CameraHint;
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::mannequin::drills::{Cycle, running, walking};
use crate::mannequin::{Path, RUN_SPEED, WALK_SPEED};
use crate::parts::floor;
use core::f32::consts::TAU;
use sinew::anim::{ClipId, TrackDef, weights_on_line};
use sinew::math::{Transform, Vec3, max, trig};
use sinew::physics::World;
use std::sync::Arc;

pub(in crate::scenes) const TWO_TRACKS: Scene = Scene {
    chapter: Chapter::Characters,
    name: "two_tracks",
    about: "the same walk in two tracks of different weights and slightly different speeds: they beat",
    steps: 660,
    settings: &[
        Setting::number("weight", 0.6, (0.0, 1.0), "weight of the first track; the second has the rest"),
        Setting::number("speed", 1.1, (1.02, 2.0), "speed of the second track; the first has 1"),
    ],
    build: two_tracks,
};

pub(in crate::scenes) const WALK_RUN: Scene = Scene {
    chapter: Chapter::Characters,
    name: "walk_run",
    about: "a blend space of a walk and a run, kept in phase by their footfalls, at four speeds",
    steps: 360,
    settings: &[],
    build: walk_run,
};

/// Yaw of the mannequin's chest against its spine in its walk, degrees: a cosine of the phase.
const CHEST_YAW: f32 = 6.0;

fn two_tracks(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    let (weight, speed) = (setup.number("weight"), setup.number("speed"));
    let mut cast = Cast::mannequin();
    let clip = cast.add_cycle(&walking(Path::Straight), Vec::new());
    let cast = Arc::new(cast);
    let mut actor = |x: f32, tracks: &[(f32, f32)]| {
        let mut actor = Actor::new(&cast, Transform::from_translation(Vec3::X * x));
        for &(weight, speed) in tracks {
            actor.animator.play(&cast.set, &TrackDef { weight, speed, ..TrackDef::new(clip) });
        }
        actor.mark(&mut world);
        actor
    };
    let (first, second) = ((weight, 1.0), (1.0 - weight, speed));
    let shown = [actor(-1.1, &[first]), actor(0.0, &[first, second]), actor(1.1, &[second])];
    let same = actor(-1.1, &[first, (1.0 - weight, 1.0)]);
    let script = TwoTracks {
        shown,
        same,
        clip,
        first,
        second,
        gone: Gone::default(),
        beat: None,
        worst: 0.0,
        differ: 0,
    };
    Instance::new(world, script)
}

struct TwoTracks {
    /// Characters that play the first track alone, both tracks, and the second track alone.
    shown: [Actor; 3],
    /// Character that plays both tracks at the same speed.
    same: Actor,
    clip: ClipId,
    /// Weight and speed of the tracks.
    first: (f32, f32),
    second: (f32, f32),
    gone: Gone,
    /// Time at which the second track was a whole lap ahead, seconds.
    beat: Option<f32>,
    /// Largest deviation of the chest's yaw from the closed form, degrees.
    worst: f32,
    /// Number of joints and steps in which two tracks of equal speed differed from the single track.
    differ: u32,
}

impl TwoTracks {
    fn lap(&self) -> f32 {
        self.shown[1].cast.set.clip(self.clip).clip.duration()
    }

    fn watch(&mut self, time: f32, dt: f32) {
        let both = &self.shown[1];
        let lap = self.lap();
        let yaw = both.animator.pose().get(both.cast.joint("chest")).rotation.twist_angle(Vec3::Y);
        let swing = |(weight, speed): (f32, f32)| weight * trig::cos(TAU * speed * time / lap);
        let expected = CHEST_YAW * (swing(self.first) + swing(self.second));
        self.worst = max(self.worst, (yaw.to_degrees() - expected).abs());
        let mut ways = both.animator.tracks().map(|track| {
            let place = track.playhead();
            place.lap() as f32 * lap + place.clip_time()
        });
        if let (Some(first), Some(second), None) = (ways.next(), ways.next(), self.beat) {
            let ahead = second - first - lap;
            let rate = self.second.1 - self.first.1;
            self.beat = (ahead >= -0.5 * rate * dt).then(|| time - ahead / rate);
        }
        let [alone, same] = [&self.shown[0], &self.same].map(|actor| actor.animator.pose());
        self.differ += alone.iter().zip(same.iter()).filter(|(a, b)| a != b).count() as u32;
    }
}

impl Script for TwoTracks {
    fn before_step(&mut self, world: &mut World) {
        let dt = world.def().dt();
        for step in self.gone.due(world) {
            self.same.update(dt);
            self.shown.iter_mut().for_each(|actor| actor.update(dt));
            self.watch((step + 1) as f32 * dt, dt);
        }
        for actor in self.shown.iter_mut().chain([&mut self.same]) {
            actor.pose();
            actor.lead_marks(world);
        }
    }

    fn metrics(&self, _: &World) -> Vec<Metric> {
        let beat = self.lap() / (self.second.1 - self.first.1);
        vec![
            Metric::awaited("beat_s", self.beat, Expected::near(beat, 1e-4)),
            Metric::new("chest_yaw_error_max_deg", self.worst, Expected::AtMost(0.1)),
            Metric::new("same_speed_differs", self.differ, Expected::AtMost(0.0)),
        ]
    }

    fn camera_hint(&self) -> CameraHint {
        facing()
    }

    fn figures(&self) -> Vec<Figure<'_>> {
        self.shown.iter().map(Actor::figure).collect()
    }
}

/// Camera at the left and in front of characters that face +Z.
pub(in crate::scenes) fn facing() -> CameraHint {
    CameraHint { direction: Vec3::new(0.75, 0.28, 1.0), ..CameraHint::default() }
}

/// Requested speeds, m/s.
const SPEEDS: [f32; 4] = [WALK_SPEED, 1.8, 2.4, RUN_SPEED];
/// Distance from one runner to the next, metres.
const APART: f32 = 1.0;

fn walk_run(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    let cycles = [walking(Path::Straight), running()];
    let mut cast = Cast::mannequin();
    let clips = [0, 1].map(|i| cast.add_cycle(&cycles[i], Vec::new()));
    let cast = Arc::new(cast);
    let mut runner = |i: usize| {
        let place = Transform::from_translation(Vec3::X * (APART * (i as f32 - 1.5)));
        Runner::new(&mut world, &cast, clips, &cycles, SPEEDS[i], place)
    };
    let runners: Vec<Runner> = (0..SPEEDS.len()).map(&mut runner).collect();
    Instance::new(world, Runners { runners, gone: Gone::default() })
}

/// A runner in place.
struct Runner {
    actor: Actor,
    /// Requested speed, m/s.
    speed: f32,
    /// Laps per second at that speed, the same for both clips, because they are in phase.
    cadence: f32,
    /// Distance along z so far, metres.
    way: f32,
    /// Largest difference between the two tracks' phases, in laps.
    phase_gap: f32,
}

impl Runner {
    fn new(
        world: &mut World,
        cast: &Arc<Cast>,
        clips: [ClipId; 2],
        cycles: &[Cycle; 2],
        speed: f32,
        place: Transform,
    ) -> Self {
        let mut weights = [0.0; 2];
        weights_on_line(&[cycles[0].speed, cycles[1].speed], speed, &mut weights);
        let mut actor = Actor::new(cast, place);
        for (clip, weight) in clips.into_iter().zip(weights) {
            actor.animator.play(&cast.set, &TrackDef { weight, sync_group: Some(0), ..TrackDef::new(clip) });
        }
        actor.mark(world);
        let stride: f32 = cycles.iter().zip(weights).map(|(c, w)| w * c.speed * c.clip.duration).sum();
        Self { actor, speed, cadence: speed / stride, way: 0.0, phase_gap: 0.0 }
    }

    fn update(&mut self, dt: f32) {
        self.actor.update(dt);
        self.way += self.actor.animator.root_motion().translation.z;
        self.phase_gap = max(self.phase_gap, self.apart());
    }

    /// Difference of the two tracks' lap counts.
    fn apart(&self) -> f32 {
        let mut laps = self.laps();
        laps.next().zip(laps.next()).map_or(0.0, |(walk, run)| (walk - run).abs() as f32)
    }

    /// Laps of each track so far.
    fn laps(&self) -> impl Iterator<Item = f64> {
        let set = &self.actor.cast.set;
        self.actor.animator.tracks().map(|track| {
            let (playhead, duration) = (track.playhead(), set.clip(track.def().clip).clip.duration());
            playhead.lap() as f64 + f64::from(playhead.clip_time()) / f64::from(duration)
        })
    }
}

struct Runners {
    runners: Vec<Runner>,
    gone: Gone,
}

impl Script for Runners {
    fn before_step(&mut self, world: &mut World) {
        let dt = world.def().dt();
        for _ in self.gone.due(world) {
            self.runners.iter_mut().for_each(|runner| runner.update(dt));
        }
        for Runner { actor, .. } in &mut self.runners {
            actor.pose();
            actor.lead_marks(world);
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let time = world.time();
        let way = |i: usize| self.runners[i].way;
        let near = |i: usize| Expected::near(f64::from(self.runners[i].speed) * time, 1e-3);
        let error = |runner: &Runner| {
            let expected = f64::from(runner.cadence) * time;
            runner.laps().map(|laps| (laps - expected).abs() as f32).fold(0.0, max)
        };
        let laps = self.runners.iter().map(error);
        let gap = self.runners.iter().map(|runner| runner.phase_gap);
        vec![
            Metric::new("way_walking_m", way(0), near(0)),
            Metric::new("way_jogging_m", way(1), near(1)),
            Metric::new("way_between_m", way(2), near(2)),
            Metric::new("way_running_m", way(3), near(3)),
            Metric::new("laps_error_max", laps.fold(0.0, max), Expected::AtMost(1e-4)),
            Metric::new("phase_gap_max", gap.fold(0.0, max), Expected::AtMost(1e-6)),
        ]
    }

    fn camera_hint(&self) -> CameraHint {
        facing()
    }

    fn figures(&self) -> Vec<Figure<'_>> {
        self.runners.iter().map(|runner| runner.actor.figure()).collect()
    }
}
