//! The examples of `bevy_sinew` in a window: `cargo run -p window -- character`.
//!
//! `cargo run -p window -- NAME [FILE.glb] [--picture OUT.png [--at SECONDS]]`, where NAME is `hello`, `door`, `character`, `shooter`
//! or `crowd`. With `--picture` it writes a picture, checks that moving bodies are visible at their positions, and ends.
#![forbid(unsafe_code)]

mod examples;
mod looks;
mod picture;

use bevy::prelude::*;
use bevy_sinew::SinewPlugin;
use examples::{character, crowd, door, hello, shooter};
use picture::Picture;

const USAGE: &str = "window hello|door|character|shooter|crowd [FILE.glb] [--picture OUT.png [--at SECONDS]]";

/// An example, and its camera position.
struct Example {
    name: &'static str,
    plugin: fn(&mut App),
    eye: Vec3,
    target: Vec3,
}

const EXAMPLES: &[Example] = &[
    Example { name: "hello", plugin: hello::plugin, eye: Vec3::new(3.0, 2.5, 5.0), target: Vec3::Y },
    Example {
        name: "door",
        plugin: door::plugin,
        eye: Vec3::new(3.5, 3.0, -4.5),
        target: Vec3::new(0.4, 1.1, 1.2),
    },
    Example {
        name: "character",
        plugin: character::plugin,
        eye: Vec3::new(4.0, 1.8, 4.5),
        target: Vec3::new(0.0, 0.8, 1.2),
    },
    Example {
        name: "shooter",
        plugin: shooter::plugin,
        eye: Vec3::new(-3.5, 2.2, 8.5),
        target: Vec3::new(1.5, 0.7, 1.5),
    },
    Example {
        name: "crowd",
        plugin: crowd::plugin,
        eye: Vec3::new(0.0, 4.0, -9.0),
        target: Vec3::new(0.0, 0.0, 8.0),
    },
];

fn main() -> AppExit {
    let mut args = std::env::args().skip(1);
    let name = args.next();
    let Some(example) = EXAMPLES.iter().find(|example| Some(example.name) == name.as_deref()) else {
        eprintln!("usage: {USAGE}");
        return AppExit::from_code(2);
    };
    let picture = match Picture::from_args(args) {
        Ok(picture) => picture,
        Err(what) => {
            eprintln!("error: {what}\nusage: {USAGE}");
            return AppExit::from_code(2);
        }
    };
    let mut app = App::new();
    let files = looks::files(&mut app);
    let window = Window { title: format!("Sinew: {name}", name = example.name), ..Window::default() };
    let window = WindowPlugin { primary_window: Some(window), ..WindowPlugin::default() };
    app.add_plugins((DefaultPlugins.set(window), SinewPlugin::default(), example.plugin));
    looks::add(&mut app, files, Transform::from_translation(example.eye).looking_at(example.target, Vec3::Y));
    if let Some(picture) = picture {
        picture::add(&mut app, picture);
    }
    app.run()
}
