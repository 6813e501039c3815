//! `sinew boxes`: approximates a render mesh by a world of few boxes.

use crate::failure::{Failure, Result};
use crate::input::files::{Outputs, must_end_in};
use crate::input::picture_file::PictureFile;
use crate::input::source::load_mesh;
use crate::render::film::body_models;
use crate::report::progress::Progress;
use crate::report::table::{Table, shown};
use crate::report::{Report, number};
use serde_json::json;
use sinew::formats::{TriangleMesh, write_world};
use sinew::math::Vec3;
use sinew::physics::BodyDef;
use sinew::physics::cook::{self, CookOptions, Cooked, cook};
use sinew_picture::{
    Camera, Caption, Model, Movie, PictureFormat, RenderMaterial, RenderSettings, Renderer, Scene, Sky, Sun,
};
use std::path::{Path, PathBuf};

/// Turn a render mesh into a world of boxes to collide with, and report their distance from it
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  sinew boxes house.glb -o house.json
  sinew boxes dungeon.obj --max 40 -o dungeon.json --picture dungeon.png
  sinew bake character.glb --world house.json -o fall.glb")]
pub struct Boxes {
    /// A glTF, GLB or OBJ file
    mesh: PathBuf,
    /// Largest number of boxes
    #[arg(long, value_name = "N", default_value = "150", value_parser = clap::value_parser!(u16).range(1..=10_000))]
    max: u16,
    /// Factor for all lengths of the mesh, as 0.01 for one in centimetres
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = factor)]
    scale: f32,
    /// World file to write
    #[arg(short, long, value_name = "WORLD.json")]
    output: PathBuf,
    /// Also draw it, the boxes next to the mesh: a .gif, .png or .webp file
    #[arg(long, value_name = "OUT.(gif|png|webp)")]
    picture: Option<PictureFile>,
}

/// Parses a number above 0.
fn factor(text: &str) -> Result<f32, String> {
    let number: f32 = text.parse().map_err(|_| format!("'{text}' is not a number"))?;
    if number > 0.0 && number.is_finite() { Ok(number) } else { Err("must be above 0".to_owned()) }
}

impl Boxes {
    /// Runs the command: reads the mesh, computes boxes, draws the picture and writes the world file.
    pub fn run(&self) -> Result<Report> {
        self.check_outputs()?;
        let name = self.mesh.display().to_string();
        let mut mesh = load_mesh(&self.mesh)?;
        mesh.positions.iter_mut().for_each(|position| *position *= self.scale);
        let cooked = self.cook(&name, &mesh)?;
        let bodies: Vec<BodyDef> = cooked.boxes.iter().map(BodyDef::fixed_box).collect();
        let mut outputs = Outputs::default();
        outputs.add(&self.output, write_world(&bodies).into_bytes());
        if let Some(picture) = &self.picture {
            let failed = |error| Failure::of_file(picture.path().display().to_string(), error);
            outputs.add(picture.path(), draw(&mesh, &bodies, picture.format).map_err(failed)?);
        }
        outputs.write()?;
        Ok(self.report(&name, &mesh, &cooked))
    }

    fn cook(&self, name: &str, mesh: &TriangleMesh) -> Result<Cooked> {
        let options = CookOptions { max_boxes: usize::from(self.max), ..CookOptions::default() };
        let bar = Progress::new("cooking", mesh.triangles.len());
        let cooked = cook(&mesh.positions, &mesh.triangles, &options, &mut |progress| match progress {
            cook::Progress::Triangles(done) => bar.reach(done),
            cook::Progress::Boxes(_) => {}
        });
        cooked.map_err(|error| Failure::at(name, error, error.place()))
    }

    /// Rejects the mesh itself as an output.
    fn check_outputs(&self) -> Result<()> {
        let real = |path: &Path| std::fs::canonicalize(path).ok();
        let input = real(&self.mesh);
        match self.outputs().find(|path| input.is_some() && real(path) == input) {
            Some(path) => {
                Err(Failure::Usage(format!("{} is an input: write to another file", path.display())))
            }
            None => must_end_in(&self.output, &["json"]),
        }
    }

    /// Returns the files that the command writes.
    fn outputs(&self) -> impl Iterator<Item = &Path> {
        std::iter::once(self.output.as_path()).chain(self.picture.iter().map(PictureFile::path))
    }

    fn report(&self, name: &str, mesh: &TriangleMesh, cooked: &Cooked) -> Report {
        let Cooked { boxes, deviation, repairs, parts } = cooked;
        let height = height(mesh);
        let warnings = warnings(mesh, cooked);
        let outputs: Vec<String> = self.outputs().map(|path| path.display().to_string()).collect();
        let json = json!({
            "boxes": boxes.len(),
            "volume_ratio": deviation.volume_ratio.map(number),
            "distance_p95_m": number(deviation.distance_p95),
            "distance_max_m": number(deviation.distance_max),
            "height_m": number(height),
            "triangles": mesh.triangles.len(),
            "parts": parts,
            "degenerate": repairs.degenerate,
            "repeated": repairs.repeated,
            "open_edges": repairs.open_edges,
            "warnings": warnings,
            "outputs": outputs,
        });
        let mut table = Table::default();
        let mut row = |what: &str, value: String| table.row([what.to_owned(), value]);
        let length =
            |metres: f32| format!("{metres:.4} m, {:.2} % of the height", 100.0 * metres / height.max(1e-9));
        row(
            "mesh",
            format!("{} triangles in {parts} connected parts, {height:.3} m high", mesh.triangles.len()),
        );
        row("boxes", boxes.len().to_string());
        row("distance, 95 %", length(deviation.distance_p95));
        row("distance, largest", length(deviation.distance_max));
        row(
            "volume ratio",
            deviation.volume_ratio.map_or("none: the mesh is open".into(), |ratio| format!("{ratio:.3}")),
        );
        let lines = |sentences: &[String], lead: &str| {
            sentences.iter().map(|sentence| format!("{lead}{}\n", shown(sentence))).collect::<String>()
        };
        let text = format!(
            "{}\n{}\n{}{}",
            shown(name),
            table.to_text(),
            lines(&warnings, "note: "),
            lines(&outputs, "wrote "),
        );
        Report { json, text }
    }
}

/// Returns the height from the lowest to the highest vertex, metres.
fn height(mesh: &TriangleMesh) -> f32 {
    let used = || mesh.triangles.iter().flatten().map(|&i| mesh.positions[i as usize].y);
    used().fold(f32::MIN, f32::max) - used().fold(f32::MAX, f32::min)
}

/// Returns warnings of omissions and repairs.
fn warnings(mesh: &TriangleMesh, cooked: &Cooked) -> Vec<String> {
    let repairs = cooked.repairs;
    let mut warnings = mesh.warnings.clone();
    let mut count = |n: usize, what: &str| {
        if n > 0 {
            warnings.push(format!("{n} {what}"));
        }
    };
    count(repairs.degenerate, "triangles without area left out");
    count(repairs.repeated, "duplicate triangles left out");
    count(
        repairs.open_edges,
        "open edges: holes were taken as closed where the mesh winds around them, sheets as plates",
    );
    warnings
}

/// Draws the mesh on the left and its boxes on the right, each body in its own colour.
fn draw(
    mesh: &TriangleMesh,
    bodies: &[BodyDef],
    format: PictureFormat,
) -> Result<Vec<u8>, sinew_picture::EncodeError> {
    let (low, high) = bounds(&mesh.positions);
    let (center, radius) = ((low + high) * 0.5, 0.5 * (high - low).length());
    let toward_camera = Vec3::new(0.6, 0.45, 0.75);
    // The two are placed along the picture's lower edge.
    let right = Vec3::Y.cross(toward_camera).normalize();
    let apart = right * (1.02 * radius);
    let mut models = vec![Model {
        positions: mesh.positions.iter().map(|&p| p - apart).collect(),
        colors: mesh.colors.clone(),
        indices: mesh.triangles.as_flattened().to_vec(),
        material: RenderMaterial::new([1.0; 3]),
        ..Model::default()
    }];
    for (index, body) in bodies.iter().enumerate() {
        let moved = BodyDef { position: body.position + apart, ..body.clone() };
        let color = COLORS[index % COLORS.len()];
        models.extend(body_models(&moved, 0.0, color, color));
    }
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let settings = RenderSettings { width: 1280, height: 640, threads, ..RenderSettings::default() };
    let scene = Scene {
        models,
        sun: Sun { shadow_radius: 2.1 * radius, ..Sun::default() },
        sky: Sky { haze_distance: 100.0 * radius, ..Sky::default() },
        captions: vec![
            Caption::new(format!("{} triangles", mesh.triangles.len())),
            Caption { x: 650, ..Caption::new(format!("{} boxes", bodies.len())) },
        ],
        ..Scene::default()
    };
    let camera = Camera::framing(center, 1.05 * radius, toward_camera);
    let mut movie = Movie::new(format, 1);
    movie.push(&Renderer::new(settings).render(&scene, &camera))?;
    movie.finish()
}

/// Linear RGB colours that distinguish neighbours.
const COLORS: [[f32; 3]; 7] = [
    [0.55, 0.20, 0.14],
    [0.16, 0.34, 0.52],
    [0.55, 0.42, 0.14],
    [0.20, 0.42, 0.20],
    [0.40, 0.24, 0.46],
    [0.14, 0.42, 0.42],
    [0.46, 0.34, 0.28],
];

fn bounds(positions: &[Vec3]) -> (Vec3, Vec3) {
    let start = (Vec3::splat(f32::MAX), Vec3::splat(f32::MIN));
    positions.iter().fold(start, |(low, high), &p| (low.min(p), high.max(p)))
}
