//! A picture of the window at a time, with a check that it shows the moving bodies.

use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured, save_to_disk};
use bevy::time::TimeUpdateStrategy;
use bevy_sinew::{CharacterBody, CharacterHandle, CharacterJoints, Physics, RigidBody};
use std::path::PathBuf;

/// Least difference of a channel between a visible body and the sky or the ground, of 255.
const SEEN: u8 = 25;

/// A requested picture.
#[derive(Resource)]
pub struct Picture {
    path: PathBuf,
    /// Time of the world, seconds.
    at: f32,
    taken: bool,
}

impl Picture {
    /// Returns the picture requested by the arguments, if any.
    ///
    /// # Errors
    /// If an option is unknown or lacks its value.
    pub fn from_args(mut args: impl Iterator<Item = String>) -> Result<Option<Self>, String> {
        let (mut path, mut at) = (None, 1.0);
        while let Some(arg) = args.next() {
            match arg.as_str() {
                "--picture" => path = Some(args.next().ok_or("--picture needs a file")?),
                "--at" => {
                    let seconds = args.next().ok_or("--at needs seconds")?;
                    at = seconds.parse().map_err(|_| format!("--at needs seconds, not {seconds}"))?;
                }
                file if file.ends_with(".glb") => {} // of the example
                other => return Err(format!("unknown option {other}")),
            }
        }
        Ok(path.map(|path| Self { path: path.into(), at, taken: false }))
    }
}

/// Takes the picture, then exits. Each frame is a step until then, so that the picture does not depend on the machine.
pub fn add(app: &mut App, picture: Picture) {
    app.insert_resource(picture);
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app.insert_resource(bevy_sinew::Interpolation::Off);
    app.add_systems(Last, take);
}

/// Waits for the time and for the skins of all characters; meanwhile the world does not advance.
fn take(
    mut commands: Commands,
    mut picture: ResMut<Picture>,
    mut time: ResMut<TimeUpdateStrategy>,
    physics: Res<Physics>,
    without_skin: Query<(), (With<CharacterBody>, Without<CharacterJoints>)>,
    mut frames: Local<usize>,
) {
    *frames += 1;
    let due = physics.time() >= f64::from(picture.at);
    let waits = due || (*frames > 2 && !without_skin.is_empty());
    *time = TimeUpdateStrategy::FixedTimesteps(if waits { 0 } else { 1 });
    if due && without_skin.is_empty() && !picture.taken {
        picture.taken = true;
        let mut screenshot = commands.spawn(Screenshot::primary_window());
        screenshot.observe(save_to_disk(picture.path.clone())).observe(check);
    }
}

/// Exits, with an error unless the pixel of each moving object differs from the sky and from the ground.
fn check(
    captured: On<ScreenshotCaptured>,
    camera: Single<(&Camera, &GlobalTransform)>,
    characters: Query<(Entity, &CharacterHandle)>,
    bodies: Query<(Entity, &RigidBody, &GlobalTransform)>,
    physics: Res<Physics>,
    mut exit: MessageWriter<AppExit>,
) {
    let (camera, eye) = *camera;
    let chest = |(entity, character): (Entity, &CharacterHandle)| {
        let body = character.def().body_named("chest").unwrap_or(0);
        let place = character.bodies().get(body).map(|&body| physics.center_of_mass(body));
        place.map(|place| (entity, place))
    };
    let moves = |&(_, body, _): &(Entity, &RigidBody, &GlobalTransform)| *body == RigidBody::Dynamic;
    let bodies = bodies.iter().filter(moves).map(|(entity, _, place)| (entity, place.translation()));
    let image = &captured.image;
    let color = |at: Vec2| {
        let color = image.get_color_at(at.x as u32, at.y as u32).ok()?.to_srgba();
        Some([color.red, color.green, color.blue].map(|channel| (channel * 255.0) as u8))
    };
    let (mut seen, mut missed) = (0, 0);
    for (entity, place) in characters.iter().filter_map(chest).chain(bodies) {
        let Some(color) = camera.world_to_viewport(eye, place).ok().and_then(color) else { continue };
        // Sky and ground are shades of grey and blue; moving bodies are orange or wooden.
        let is_seen = color[0] > color[2].saturating_add(SEEN);
        println!(
            "{entity} at {place:.2}: {color:?}{}",
            if is_seen { "" } else { ", the colour of the background" }
        );
        if is_seen { seen += 1 } else { missed += 1 }
    }
    println!("{seen} seen, {missed} hidden");
    exit.write(if seen > missed { AppExit::Success } else { AppExit::error() });
}
