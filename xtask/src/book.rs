//! The pictures of `docs/guide/src/book.md`: one of each scene that it names.

use crate::command::{self, Profile};
use anyhow::{Context, Result, bail, ensure};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

const PAGE: &str = "docs/guide/src/book.md";
/// Folder beside the page; its links start with the last part.
const FOLDER: &str = "docs/guide/src/book";
/// Pixels of a picture.
const SIZE: [&str; 2] = ["560", "315"];
/// Largest total size of the pictures, bytes, to keep clones small.
const MOST_BYTES: u64 = 2_000_000;

/// Times of pictures for scenes whose last state is uninformative, seconds; used when a link is created.
const MOMENTS: &[(&str, &str)] = &[
    ("aabb_vs_obb", "0.75"),
    ("block_overhang", "2.2"),
    ("bounce", "2"),
    ("bouncing_balls", "1"),
    ("dominoes", "1.6"),
    ("double_pendulum", "8"),
    ("elastic_pairs", "0.4"),
    ("explosion", "0.5"),
    ("float", "2"),
    ("free_fall", "1.2"),
    ("gimbal", "1.5"),
    ("newtons_cradle", "1"),
    ("pendulum", "3"),
    ("rope_on_box", "1.5"),
    ("stairs", "3"),
    ("terminal_velocity", "3"),
    ("triple_pendulum", "6"),
    ("wind", "3"),
    ("zero_gravity_pile", "1"),
];

/// `cargo xtask book`: draws the pictures.
///
/// The page shows the picture of a scene as `![NAME](book/NAME.png)`, or `![NAME](book/NAME.png "at 1.5 s")` for
/// another time. If the page runs a scene with `sinew run` without a picture, a link is added after that paragraph.
#[derive(clap::Args)]
pub struct Book {}

impl Book {
    /// # Errors
    /// If the page cannot be read or written, names a scene that does not run, or its pictures are too large.
    pub fn run(&self) -> Result<()> {
        let binary = command::build_sinew(Profile::Debug)?;
        let path = command::root().join(PAGE);
        let page = fs::read_to_string(&path).context(PAGE)?;
        let linked = with_links(&page);
        let folder = command::root().join(FOLDER);
        fs::create_dir_all(&folder).context(FOLDER)?;
        let pictures = pictures(&linked)?;
        for (scene, at) in &pictures {
            draw(&binary, &folder, scene, at.as_deref())?;
        }
        remove_others(&folder, &pictures)?;
        if linked != page {
            fs::write(&path, linked).context(PAGE)?;
        }
        check_size(&folder)
    }
}

/// Returns the page with a link after the first paragraph that runs a scene, if that scene has none.
fn with_links(page: &str) -> String {
    let mut shown: Vec<String> = page.lines().filter_map(link).map(|(scene, _)| scene.to_owned()).collect();
    let mut paragraphs = Vec::new();
    for paragraph in page.trim_end().split("\n\n") {
        paragraphs.push(paragraph.to_owned());
        for scene in run_in(paragraph) {
            if !shown.contains(&scene) {
                paragraphs.push(link_to(&scene));
                shown.push(scene);
            }
        }
    }
    paragraphs.join("\n\n") + "\n"
}

fn link_to(scene: &str) -> String {
    let moment = MOMENTS.iter().find(|(of, _)| *of == scene);
    let title = moment.map_or(String::new(), |(_, at)| format!(" \"at {at} s\""));
    format!("![{scene}](book/{scene}.png{title})")
}

/// Returns the scenes that a paragraph runs, as inline code or in a block of commands.
fn run_in(paragraph: &str) -> Vec<String> {
    let mut scenes = Vec::new();
    for (start, command) in paragraph.match_indices("sinew run ") {
        let rest = &paragraph[start + command.len()..];
        let is_of_name = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
        let scene: String = rest.chars().take_while(|&c| is_of_name(c)).collect();
        if !scene.is_empty() && !scenes.contains(&scene) {
            scenes.push(scene);
        }
    }
    scenes
}

/// Returns scene and time of a line with a picture.
fn link(line: &str) -> Option<(&str, Option<&str>)> {
    let (_, rest) = line.trim().strip_prefix("![")?.split_once("](book/")?;
    let target = rest.strip_suffix(')')?;
    let (file, title) = target.split_once(' ').map_or((target, None), |(file, title)| (file, Some(title)));
    let at = title.and_then(|title| title.trim_matches('"').strip_prefix("at ")?.strip_suffix(" s"));
    Some((file.strip_suffix(".png")?, at))
}

/// Returns the scenes with the times of their pictures.
fn pictures(page: &str) -> Result<BTreeMap<String, Option<String>>> {
    let mut pictures = BTreeMap::new();
    for (scene, at) in page.lines().filter_map(link) {
        let is_first = pictures.insert(scene.to_owned(), at.map(str::to_owned)).is_none();
        ensure!(is_first, "{PAGE}: two pictures of {scene}");
    }
    Ok(pictures)
}

fn draw(binary: &Path, folder: &Path, scene: &str, at: Option<&str>) -> Result<()> {
    let [width, height] = SIZE;
    let mut view = Command::new(binary);
    view.args(["view", scene, "--width", width, "--height", height, "--picture"]);
    view.arg(folder.join(format!("{scene}.png")));
    if let Some(at) = at {
        view.args(["--at", at]);
    }
    command::output(&mut view).map(drop)
}

/// Removes pictures without a link.
fn remove_others(folder: &Path, pictures: &BTreeMap<String, Option<String>>) -> Result<()> {
    for entry in fs::read_dir(folder).context(FOLDER)? {
        let path = entry.context(FOLDER)?.path();
        let scene = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
        if path.extension().is_some_and(|kind| kind == "png") && !pictures.contains_key(scene) {
            fs::remove_file(&path).with_context(|| path.display().to_string())?;
        }
    }
    Ok(())
}

fn check_size(folder: &Path) -> Result<()> {
    let mut bytes = 0;
    for entry in fs::read_dir(folder).context(FOLDER)? {
        bytes += entry.context(FOLDER)?.metadata().context(FOLDER)?.len();
    }
    eprintln!("{FOLDER}: {} kB", bytes / 1000);
    if bytes > MOST_BYTES {
        bail!("{FOLDER} has {bytes} bytes, more than {MOST_BYTES}");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scene_with_a_command_gets_one_picture() {
        let page = "# Book\n\nA planet: `sinew run kepler`.\n\nAgain: `sinew run kepler --steps 3`.\n\n\
                    `sinew run wind`\n\n![wind](book/wind.png \"at 2.5 s\")\n";
        let linked = with_links(page);
        let expected = "# Book\n\nA planet: `sinew run kepler`.\n\n![kepler](book/kepler.png)\n\n\
                        Again: `sinew run kepler --steps 3`.\n\n`sinew run wind`\n\n\
                        ![wind](book/wind.png \"at 2.5 s\")\n";
        assert_eq!(linked, expected);
        assert_eq!(with_links(&linked), linked);
        let found = pictures(&linked).expect("each scene is shown once");
        let expected = [("kepler".to_owned(), None), ("wind".to_owned(), Some("2.5".to_owned()))];
        assert_eq!(found, BTreeMap::from(expected));
    }

    #[test]
    fn new_link_has_the_scenes_picture_time() {
        assert!(with_links("`sinew run bounce`\n").ends_with("![bounce](book/bounce.png \"at 2 s\")\n"));
    }

    #[test]
    fn link_is_added_at_the_end_of_the_page() {
        assert_eq!(with_links("`sinew run spring`\n"), "`sinew run spring`\n\n![spring](book/spring.png)\n");
    }

    #[test]
    fn two_pictures_of_a_scene_are_rejected() {
        assert!(pictures("![a](book/a.png)\n\n![a](book/a.png \"at 1 s\")\n").is_err());
    }
}
