//! Writes the start page and the guide's pages around the viewer's.

use crate::bench;
use crate::chapters::{self, Pages};
use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::Path;

/// Scenes of the gallery: name, steps after which its picture is taken, title, and one line.
pub const GALLERY: [(&str, u32, &str, &str); 12] = [
    ("brawl", 260, "A brawl", "Characters walk among crates, are struck, fall over each other and get up."),
    ("cape", 240, "Cloth on a character", "A cape of cloth follows the walk, the fall and the get-up."),
    ("arena", 400, "Balance", "Powered figures push each other. They step to catch themselves, or fall."),
    (
        "uneven_ground",
        190,
        "Feet on the ground",
        "Inverse kinematics adapts a walk on a flat floor to waves.",
    ),
    ("crowd", 200, "A crowd", "Figures are hit in waves, fall over each other, and all get up again."),
    ("street", 300, "A street", "Movers push crates, flinch and fall when hit, ride a lift and jump."),
    ("rope_bridge", 150, "Ropes", "Two limp figures fall on planks that hang on two ropes."),
    ("skirt", 100, "Skirts and capes of bones", "Chains of bones swing by springs and keep off the legs."),
    ("arch", 60, "Stones without mortar", "An arch of loose blocks stands, as the line of thrust predicts."),
    ("dominoes", 150, "Dominoes", "A ball on a rod strikes the first one."),
    ("curtain", 55, "Cloth", "A ball flies through a curtain, which stays attached."),
    ("retarget", 90, "Any size", "One walk on a child of 0.8 m and on a giant of 14 m."),
];

/// Ways to use Sinew: name, page, one line, and commands from a clone.
const WAYS: [(&str, &str, &str, &str); 6] = [
    (
        "Rust",
        "first_ragdoll.html",
        "The library: worlds, joints, characters, files.",
        "cargo add sinew --path sinew/crates/sinew",
    ),
    (
        "Bevy",
        "bevy.html",
        "A plugin: entities, transforms, gizmos, events.",
        "cargo add bevy_sinew --path sinew/integrations/bevy_sinew",
    ),
    ("Blender", "blender.html", "An extension: falls become actions on your rig.", "cargo xtask blender"),
    (
        "npm and three.js",
        "three.html",
        "A package with an adapter for three.js, workers and Node.",
        "cargo xtask npm\nnpm install out/npm/sinew-physics.tgz three",
    ),
    (
        "Python",
        "python.html",
        "A wheel with batches of worlds, Gymnasium and Ray.",
        "maturin build --release -m bindings/python/Cargo.toml --out wheels\npip install wheels/*.whl",
    ),
    (
        "C",
        "c.html",
        "One header and a library.",
        "cargo build --release --manifest-path bindings/Cargo.toml -p sinew_c",
    ),
];

/// Pages about the API of each language.
const API: [(&str, &str); 6] = [
    ("Rust", "api/sinew/index.html"),
    ("JavaScript", "npm.html"),
    ("Python", "python-api.html"),
    ("C", "c.html"),
    ("Command line", "contract.html"),
    ("World files", "full_world_files.html"),
];

/// Texts outside the guide that become pages: file and name.
const TEXTS: [(&str, &str); 8] = [
    ("docs/python.md", "python"),
    ("docs/python-api.md", "python-api"),
    ("docs/c.md", "c"),
    ("docs/contract.md", "contract"),
    ("docs/benchmarks.md", "benchmarks"),
    ("docs/status.md", "status"),
    ("bindings/web/package/README.md", "npm"),
    ("README.md", "readme"),
];

const CONTENTS: &str = "docs/guide/src/SUMMARY.md";
/// Folder of the start page, and of the gallery's pictures.
const PAGE: &str = "crates/sinew_viewer/page";

/// Facts about a build.
pub struct Facts<'a> {
    /// Address at which the folder will be published, with a slash at its end, or nothing.
    pub address: &'a str,
    /// Bytes of the program, uncompressed.
    pub bytes: u64,
    /// Address of the source, if it is known.
    pub source: Option<&'a str>,
    /// Titles of the book's chapters, as HTML.
    pub chapters: &'a [String],
}

/// Writes the start page, the viewer's page, and the pages of the guide.
///
/// # Errors
/// If a text, a picture or a figure is missing.
pub fn write(root: &Path, folder: &Path, facts: &Facts<'_>) -> Result<()> {
    let (charts, machine) = bench::charts()?;
    let guide = contents(root)?;
    let links = |list: &[(String, String)]| -> String {
        list.iter().map(|(title, file)| format!("<li><a href=\"{file}\">{title}</a></li>")).collect()
    };
    let api = API.map(|(name, file)| (name.to_owned(), file.to_owned()));
    let chapters: String = chapters::list(facts.chapters, None);
    let machine = machine.lines().next().unwrap_or_default().to_owned();
    let values = [
        ("address", facts.address.to_owned()),
        ("bytes", facts.bytes.to_string()),
        ("gallery", gallery(root, folder)?),
        ("scenes", scene_count(root)?.to_string()),
        ("charts", charts),
        ("machine", format!("Measured on {}", chapters::escaped(&machine))),
        ("ways", ways(facts.source)),
        ("chapters", chapters),
        ("guide", links(&guide)),
        ("api", links(&api)),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
    ];
    for file in ["index.html", "viewer.html"] {
        let from = root.join(PAGE).join(file);
        let mut html = fs::read_to_string(&from).with_context(|| from.display().to_string())?;
        for (name, value) in &values {
            html = html.replace(&format!("{{{{{name}}}}}"), value);
        }
        ensure!(!html.contains("{{"), "{file}: a value is missing");
        fs::write(folder.join(file), html)?;
    }
    pages(root, folder, &guide)?;
    let list = |title: &str, about: &str, list: &str| {
        chapters::page(
            title,
            &format!(
                "<nav><a href=\"index.html\">Start</a></nav><h1>{title}</h1><p>{about}</p><ul>{list}</ul>"
            ),
        )
    };
    fs::write(
        folder.join("guide.html"),
        list("The guide", "From the first ragdoll to rollback and tuning.", &links(&guide)),
    )?;
    fs::write(folder.join("api.html"), list("The API", "All calls, by language.", &links(&api)))?;
    Ok(())
}

/// Returns titles and files of the guide's pages, in their order; the book is elsewhere.
fn contents(root: &Path) -> Result<Vec<(String, String)>> {
    let text = fs::read_to_string(root.join(CONTENTS)).context(CONTENTS)?;
    let page = |line: &str| {
        let (title, rest) = line.trim_start_matches(['-', ' ']).strip_prefix('[')?.split_once("](")?;
        let name = rest.strip_suffix(".md)")?;
        (name != "book").then(|| (title.to_owned(), format!("{name}.html")))
    };
    Ok(text.lines().filter_map(page).collect())
}

/// Writes the guide's pages, and the texts beside it.
fn pages(root: &Path, folder: &Path, guide: &[(String, String)]) -> Result<()> {
    let mut known = Pages::default();
    let last = |path: &str| path.rsplit('/').next().unwrap_or(path).to_owned();
    for (_, file) in guide {
        let name = file.strip_suffix(".html").unwrap_or(file);
        known.add(&format!("{name}.md"), file);
        // Included files are named as in the repository.
        let text = fs::read_to_string(root.join(format!("docs/guide/src/{name}.md")))?;
        if let Some((path, _)) = text.split_once("{{#include ").and_then(|(_, rest)| rest.split_once("}}")) {
            known.add(&last(path), file);
        }
    }
    for (path, name) in TEXTS.into_iter().filter(|(path, _)| path.starts_with("docs/")) {
        known.add(&last(path), &format!("{name}.html"));
    }
    known.add("book.md", "book.html");
    let write = |title: &str, file: &str, text: &str, place: &str| -> Result<()> {
        let html = known.html(root, folder, text, place)?;
        let body = format!(
            "<nav><a href=\"index.html\">Start</a> · <a href=\"guide.html\">Guide</a> · <a href=\"book.html\">Book</a></nav>\n{html}"
        );
        fs::write(folder.join(file), chapters::page(title, &body))?;
        Ok(())
    };
    for (title, file) in guide {
        let name = file.strip_suffix(".html").unwrap_or(file);
        write(title, file, &chapters::guide_page(root, name)?, "docs/guide/src")?;
    }
    for (path, name) in TEXTS {
        let text = fs::read_to_string(root.join(path)).with_context(|| path.to_owned())?;
        let title = text.lines().find_map(|line| line.strip_prefix("# ")).unwrap_or(name).to_owned();
        let place = path.rsplit_once('/').map_or("", |(place, _)| place);
        write(&title, &format!("{name}.html"), &text, place)?;
    }
    Ok(())
}

/// Returns the cards of the gallery, and copies their pictures.
fn gallery(root: &Path, folder: &Path) -> Result<String> {
    let mut html = String::new();
    fs::create_dir_all(folder.join("gallery"))?;
    for (scene, _, title, about) in GALLERY {
        let about_scene = chapters::about(root, scene)?;
        let from = root.join(PAGE).join(format!("gallery/{scene}.jpg"));
        fs::copy(&from, folder.join(format!("gallery/{scene}.jpg")))
            .with_context(|| from.display().to_string())?;
        html += &format!(
            "    <li><a class=\"scene\" data-scene=\"{scene}\" href=\"viewer.html?scene={scene}\"><img src=\"gallery/{scene}.jpg\" \
             width=\"480\" height=\"270\" loading=\"lazy\" alt=\"{}\"><div><b>{title}</b><p>{about}</p></div></a></li>\n",
            chapters::escaped(&about_scene)
        );
    }
    Ok(html)
}

fn ways(source: Option<&str>) -> String {
    let card = |name: &str, file: &str, about: &str, command: &str| {
        format!(
            "    <li><div><b><a href=\"{file}\">{name}</a></b><p>{about}</p><pre>{}</pre></div></li>\n",
            chapters::escaped(command)
        )
    };
    let mut html: String =
        WAYS.iter().map(|(name, file, about, command)| card(name, file, about, command)).collect();
    html += &match source {
        Some(address) => {
            card("Source", address, "All of it, with its tests.", &format!("git clone {address}"))
        }
        None => card("Source", "readme.html", "All of it, with its tests.", "cargo run --release -- demo"),
    };
    html
}

/// Returns the number of scenes in the sources.
fn scene_count(root: &Path) -> Result<usize> {
    Ok(chapters::sources(root)?.matches("    chapter: Chapter::").count())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command;

    /// Every linked page of the start page is written, and every link has a target.
    #[test]
    fn every_link_has_a_target() {
        let folder = command::target().join("tmp/landing");
        _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).expect("the folder can be created");
        let root = command::root();
        let (chapters, _) = chapters::write(&root, &folder).expect("the book can be converted");
        let facts = Facts { address: "", bytes: 1, source: None, chapters: &chapters };
        write(&root, &folder, &facts).expect("the pages can be written");
        let copied = ["page.js", "page.css", "chapter.js", "poster.jpg"];
        for entry in fs::read_dir(&folder).expect("the folder can be read") {
            let path = entry.expect("the folder's entry can be read").path();
            if path.extension().is_none_or(|kind| kind != "html") {
                continue;
            }
            let html = fs::read_to_string(&path).expect("the page can be read");
            // Skips blocks of code.
            let code = |part: &str| part.split_once("</pre>").map(|(_, after)| after.to_owned());
            let html: String = html
                .split("<pre>")
                .enumerate()
                .filter_map(|(at, part)| if at == 0 { Some(part.to_owned()) } else { code(part) })
                .collect();
            for attribute in ["href=\"", "src=\""] {
                for (at, _) in html.match_indices(attribute) {
                    let to = html[at + attribute.len()..].split('"').next().unwrap_or_default();
                    let file = to.split(['#', '?']).next().unwrap_or_default();
                    let is_elsewhere = file.is_empty() || to.contains(':') || copied.contains(&file);
                    // The reference of Rust is written by rustdoc.
                    let leads = is_elsewhere || file.starts_with("api/") || folder.join(file).exists();
                    assert!(leads, "{}: the link to {to} has no target", path.display());
                }
            }
        }
    }
}
