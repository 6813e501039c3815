//! `sinew demo`: the main job on the embedded character and world.

use crate::failure::{Failure, Result};
use crate::fall::Fall;
use crate::files::Outputs;
use crate::film::{Film, body_models};
use crate::report::Report;
use sinew::anim::analyze;
use sinew::formats::write_gltf;
use sinew::math::Vec3;
use sinew::physics::BodyDef;
use sinew::ragdoll::{BakeInput, BuildOptions, CharacterDef, Hit, Locomotion, build};
use sinew_picture::{PictureFormat, Sun};
use sinew_scenes::cabin::{Prop, Site};
use sinew_scenes::mannequin::{Mannequin, mannequin};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Length, seconds: the walk, the fall, getting up, and a few steps.
const SECONDS: f32 = 12.0;
/// How far before the edge of the stairs the hit comes, metres.
const HIT_BEFORE_EDGE: f32 = 0.35;
/// In the back, N·s.
const IMPULSE: Vec3 = Vec3::new(0.0, 0.0, 110.0);
const HIT_ROLE: &str = "chest";
/// Every second square of the meadow.
const MOWN: [f32; 3] = [0.19, 0.30, 0.11];

/// See it all at once: a mannequin walks, is hit, falls down the stairs of a cabin, gets up and walks on
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  sinew demo
  sinew demo --out /tmp/demo --json

Writes demo.glb (the mannequin with the fall as a clip), demo.gif and report.json.")]
pub struct Demo {
    /// Folder to write into; it is made if it is not there
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
}

impl Demo {
    /// Simulates, draws, writes.
    pub fn run(&self) -> Result<Report> {
        let Mannequin { rig, clips, motions } = mannequin();
        let internal = |what: &dyn std::fmt::Display| Failure::of_file("demo", what);
        let analysis = analyze(&rig).map_err(|error| internal(&error))?;
        let (ragdoll, _) =
            build(&rig, &analysis, &BuildOptions::default()).map_err(|error| internal(&error))?;
        let mut character = CharacterDef::new(rig, ragdoll, &analysis.bind_model);
        character.clips = clips;
        character.looped = Some(motions.walk);
        character.get_ups = vec![motions.get_up_supine, motions.get_up_prone];
        character.locomotion = Locomotion::Forward { speed: motions.walk_speed };

        let site = Site::CabinWithStairs;
        let (props, spawn) = (site.props(), site.spawn());
        let bodies: Vec<BodyDef> = props.iter().map(|prop| prop.body.clone()).collect();
        let body = character.body_named(HIT_ROLE).unwrap_or(0);
        let time = (spawn.walk_length - HIT_BEFORE_EDGE) / motions.walk_speed;
        let hits = [Hit { time, body, impulse: IMPULSE }];
        let input = BakeInput {
            world_from_character: spawn.world_from_character,
            bodies: &bodies,
            hits: &hits,
            seconds: SECONDS,
            name: "fall down the stairs",
            ..BakeInput::new(Arc::new(character))
        };
        self.finish(&Fall::simulate(&input), &props)
    }

    /// Draws and writes.
    fn finish(&self, fall: &Fall<'_>, props: &[Prop]) -> Result<Report> {
        let [clip, picture, figures] =
            ["demo.glb", "demo.gif", "report.json"].map(|name| self.out.join(name));
        let paths: [&Path; 3] = [&clip, &picture, &figures];
        let json = fall.to_json(&paths);
        let film = film(fall, props);
        let picture_bytes = film
            .shoot(PictureFormat::Gif)
            .map_err(|error| Failure::of_file(picture.display().to_string(), error))?;
        let mut outputs = Outputs::default();
        outputs.add(&clip, write_gltf(&fall.input.character.rig, std::slice::from_ref(&fall.baked.clip))?);
        outputs.add(&picture, picture_bytes);
        outputs.add(&figures, format!("{json:#}\n").into_bytes());
        std::fs::create_dir_all(&self.out)
            .map_err(|error| Failure::of_file(self.out.display().to_string(), error))?;
        outputs.write()?;
        let text = format!("A mannequin on the porch of a cabin\n{}", fall.to_text(&paths));
        Ok(Report { json, text })
    }
}

/// The stairs from the side, a little from the front.
fn film<'a>(fall: &'a Fall<'a>, props: &[Prop]) -> Film<'a> {
    let set = props.iter().flat_map(|prop| body_models(&prop.body, prop.color, MOWN)).collect();
    let sun = Sun { direction: Vec3::new(0.45, 0.8, 0.5), ..Sun::default() };
    Film { fall, set, direction: Vec3::new(0.8, 0.3, 0.5), radius: 1.7, sun }
}
