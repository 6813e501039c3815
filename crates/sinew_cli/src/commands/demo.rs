//! `sinew demo`: the full workflow on the embedded character and world.

use crate::failure::{Failure, Result};
use crate::fall::Fall;
use crate::input::files::Outputs;
use crate::render::film::{FILM_SIZE, FLOOR_HALF_SIZE, Film, View, body_models};
use crate::report::Report;
use sinew::anim::{Joint, LocalTransform, Primitive, Rig, RigMesh};
use sinew::formats::write_gltf;
use sinew::math::Vec3;
use sinew_picture::{PictureFormat, Sun};
use sinew_scenes::cabin::{Prop, Site};
use std::path::{Path, PathBuf};

/// Start time of the film, seconds: by then the mannequin has left the door, which hides it.
const FILM_FROM: f32 = 0.6;
/// Half size of the meadow in the file, metres per side; the picture shows it up to the haze.
const MEADOW_HALF_SIZE: f32 = 12.0;
/// Colour of every second square of the meadow.
const MOWN: [f32; 3] = [0.19, 0.30, 0.11];

/// Show all features at once: a mannequin walks, is hit, falls down the stairs of a cabin, gets up and walks on
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  sinew demo
  sinew demo --out fall --json
  sinew demo --out small --width 320 --height 180

Writes demo.glb (the mannequin with the fall as a clip), demo.gif and report.json.")]
pub struct Demo {
    /// Folder to write into; created if it does not exist
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Width of the picture, pixels
    #[arg(long, value_name = "N", default_value_t = FILM_SIZE[0], value_parser = clap::value_parser!(u32).range(16..=4096))]
    width: u32,
    /// Height of the picture, pixels
    #[arg(long, value_name = "N", default_value_t = FILM_SIZE[1], value_parser = clap::value_parser!(u32).range(16..=4096))]
    height: u32,
}

impl Demo {
    /// Runs the command: simulates, draws the picture and writes the output.
    pub fn run(&self) -> Result<Report> {
        let demo = sinew_scenes::demo::Demo::new(Site::CabinWithStairs);
        let input = demo.input();
        let fall = Fall::simulate(&input, None);
        let [clip, picture, figures] =
            ["demo.glb", "demo.gif", "report.json"].map(|name| self.out.join(name));
        let paths: [&Path; 3] = [&clip, &picture, &figures];
        let json = fall.to_json(&paths);
        let film = film(&fall, &demo.props);
        let picture_bytes = film
            .shoot(PictureFormat::Gif, [self.width, self.height])
            .map_err(|error| Failure::of_file(picture.display().to_string(), error))?;
        std::fs::create_dir_all(&self.out)
            .map_err(|error| Failure::of_file(self.out.display().to_string(), error))?;
        let mut outputs = Outputs::default();
        outputs.add(&clip, write_gltf(&staged(&fall, &demo.props), std::slice::from_ref(&fall.baked.clip))?);
        outputs.add(&picture, picture_bytes);
        outputs.add(&figures, format!("{json:#}\n").into_bytes());
        outputs.write()?;
        let text = format!("A mannequin in the door of a cabin\n{}", fall.to_text(&paths));
        Ok(Report { json, text })
    }
}

/// Returns the character's rig with the props, so that other programs can show the stairs.
fn staged(fall: &Fall<'_>, props: &[Prop]) -> Rig {
    let mut rig = fall.input.character.rig.clone();
    let model_from_world = fall.baked.world_from_model.inverse();
    let mut primitives: Vec<Primitive> = Vec::new();
    for prop in props {
        let [r, g, b] = prop.color;
        let base_color = [r, g, b, 1.0];
        let of_this_color = primitives.iter().position(|part| part.base_color == base_color);
        let index = of_this_color.unwrap_or_else(|| {
            primitives.push(Primitive { base_color, ..Primitive::default() });
            primitives.len() - 1
        });
        for model in body_models(&prop.body, MEADOW_HALF_SIZE, prop.color, MOWN) {
            let part = &mut primitives[index];
            let first = part.positions.len() as u32;
            part.positions.extend(model.positions.iter().map(|&point| model_from_world.point(point)));
            part.indices.extend(model.indices.iter().map(|vertex| first + vertex));
        }
    }
    let rest = LocalTransform::default();
    rig.joints.push(Joint { name: "cabin".into(), parent: None, rest, source: rig.joints.len() });
    rig.meshes.push(RigMesh { name: "cabin".into(), joint: rig.joints.len() - 1, skin: None, primitives });
    rig
}

/// Returns a film of the stairs from the side, a little from the front.
fn film<'a>(fall: &'a Fall<'a>, props: &[Prop]) -> Film<'a> {
    let set =
        props.iter().flat_map(|prop| body_models(&prop.body, FLOOR_HALF_SIZE, prop.color, MOWN)).collect();
    let sun = Sun { direction: Vec3::new(0.45, 0.8, 0.5), ..Sun::default() };
    Film { fall, from: FILM_FROM, set, direction: Vec3::new(0.9, 0.28, 0.42), view: View::Around(1.5), sun }
}
