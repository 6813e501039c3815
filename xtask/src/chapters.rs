//! Writes pages of the book beside the viewer's: the chapters of `docs/guide/src/book.md`, with scenes that run in
//! place.
//!
//! The text is the guide's; pictures of scenes become buttons that run them, and linked pages are written beside it.

use crate::formulas;
use anyhow::{Context, Result, bail, ensure};
use pulldown_cmark::{CodeBlockKind, CowStr, Event, HeadingLevel, Options, Parser, Tag, TagEnd};
use std::fs;
use std::path::Path;

/// Text of the book.
const BOOK: &str = "docs/guide/src/book.md";
/// Folder of the scenes.
const SCENES: &str = "crates/sinew_scenes/src/scenes";
/// Folder of the book, its linked pages and its pictures.
const GUIDE: &str = "docs/guide/src";

/// A chapter: title and text.
struct Chapter<'a> {
    title: Vec<Event<'a>>,
    text: Vec<Event<'a>>,
}

/// Scenes and links of the pages while they are written.
#[derive(Default)]
struct Site {
    /// Sources of all scenes; none in tests.
    sources: String,
    /// Scenes whose pictures are shown.
    scenes: Vec<String>,
}

/// Writes a page per chapter and a table of contents into the viewer's folder. Returns the chapters' titles as HTML,
/// and the number of scenes.
///
/// # Errors
/// If the book is missing or has no chapters, or if a picture, link or chapter would be lost.
pub fn write(root: &Path, folder: &Path) -> Result<(Vec<String>, usize)> {
    let book = fs::read_to_string(root.join(BOOK)).context(BOOK)?;
    let chapters = chapters(&book);
    ensure!(!chapters.is_empty(), "{BOOK} has no chapters");
    let titles: Vec<String> = chapters.iter().map(|chapter| html(chapter.title.clone())).collect();
    let mut site = Site { sources: sources(root)?, ..Site::default() };
    for (number, chapter) in chapters.into_iter().enumerate() {
        let links = links(&titles, Some(number));
        let text = site.html(chapter.text).with_context(|| format!("{BOOK}, chapter {}", number + 1))?;
        let body = format!("<nav>{links}</nav>\n<h1>{}</h1>\n{text}", titles[number]);
        fs::write(folder.join(file(number)), page(&plain(&titles[number]), &body))?;
    }
    let shown = book.matches("](book/").count();
    ensure!(site.scenes.len() == shown, "{BOOK} has {shown} pictures, its pages {}", site.scenes.len());
    let pictures = folder.join("book");
    fs::create_dir_all(&pictures)?;
    for name in &site.scenes {
        let picture = format!("{name}.png");
        let from = root.join(GUIDE).join("book").join(&picture);
        fs::copy(&from, pictures.join(&picture)).with_context(|| from.display().to_string())?;
    }
    let body = format!(
        "<h1>The book's experiments</h1>\n<p>Each chapter with its scenes beside the formulas: a click on a picture runs it. \
         <a href=\"viewer.html\">All scenes</a> are in the viewer; <a href=\"index.html\">the start page</a> has the demo.</p>\n<ul>{}</ul>",
        list(&titles, None)
    );
    fs::write(folder.join("book.html"), page("The book's experiments", &body))?;
    let scenes = site.scenes.len();
    Ok((titles, scenes))
}

/// Returns the text of a page of the guide, with its included files.
///
/// # Errors
/// If the page or an included file cannot be read.
pub fn guide_page(root: &Path, name: &str) -> Result<String> {
    let path = root.join(GUIDE).join(format!("{name}.md"));
    let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let Some((before, rest)) = text.split_once("{{#include ") else { return Ok(text) };
    let (included, after) =
        rest.split_once("}}").with_context(|| format!("{name}.md: an include without end"))?;
    let path = root.join(GUIDE).join(included);
    let included = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    Ok([before, &included, after].concat())
}

fn file(number: usize) -> String {
    format!("chapter-{}.html", number + 1)
}

/// Returns links to all other chapters, and one to the start.
fn links(titles: &[String], shown: Option<usize>) -> String {
    format!(
        "<a href=\"index.html\">Start</a> · <a href=\"viewer.html\">Viewer</a><ol>{}</ol>",
        list(titles, shown)
    )
}

/// Returns the chapters as list items, with links except for the current one.
pub fn list(titles: &[String], shown: Option<usize>) -> String {
    let link = |(number, title): (usize, &String)| {
        if shown == Some(number) {
            format!("<li><b>{title}</b></li>")
        } else {
            format!("<li><a href=\"{}\">{title}</a></li>", file(number))
        }
    };
    titles.iter().enumerate().map(link).collect()
}

/// Returns the sources of all scenes in one text.
///
/// # Errors
/// If they cannot be read.
pub fn sources(root: &Path) -> Result<String> {
    fn collect(folder: &Path, text: &mut String) -> Result<()> {
        for entry in fs::read_dir(folder).with_context(|| folder.display().to_string())? {
            let path = entry?.path();
            if path.is_dir() { collect(&path, text)? } else { *text += &fs::read_to_string(&path)? }
        }
        Ok(())
    }
    let mut text = String::new();
    collect(&root.join(SCENES), &mut text)?;
    Ok(text)
}

/// Returns the one-line description of a scene.
///
/// # Errors
/// If there is no such scene.
pub fn about(root: &Path, scene: &str) -> Result<String> {
    about_in(&sources(root)?, scene)
}

fn about_in(sources: &str, scene: &str) -> Result<String> {
    let after = sources.split_once(&format!("name: \"{scene}\",")).map(|(_, after)| after);
    let line = after.and_then(|after| after.split_once("about: \"")?.1.split_once("\","));
    Ok(line.with_context(|| format!("the scene {scene} has no description"))?.0.to_owned())
}

/// Escapes text for HTML.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

fn events(text: &str) -> Vec<Event<'_>> {
    Parser::new_ext(text, Options::ENABLE_TABLES).collect()
}

/// Splits the book at headings of the second level.
fn chapters(book: &str) -> Vec<Chapter<'_>> {
    let mut chapters: Vec<Chapter<'_>> = Vec::new();
    let mut in_title = false;
    for event in events(book) {
        match event {
            Event::Start(Tag::Heading { level: HeadingLevel::H2, .. }) => {
                chapters.push(Chapter { title: Vec::new(), text: Vec::new() });
                in_title = true;
            }
            Event::End(TagEnd::Heading(HeadingLevel::H2)) => in_title = false,
            event => {
                if let Some(chapter) = chapters.last_mut() {
                    if in_title { chapter.title.push(event) } else { chapter.text.push(event) }
                }
            }
        }
    }
    chapters
}

fn html(events: Vec<Event<'_>>) -> String {
    let mut out = String::new();
    pulldown_cmark::html::push_html(&mut out, events.into_iter());
    out
}

/// Removes the tags from HTML.
fn plain(html: &str) -> String {
    html.split('<').map(|part| part.split_once('>').map_or(part, |(_, text)| text)).collect()
}

/// Converts formulas in inline code to MathML.
fn typeset(events: Vec<Event<'_>>) -> Vec<Event<'_>> {
    let mut out: Vec<Event<'_>> = Vec::with_capacity(events.len());
    let mut events = events.into_iter().peekable();
    while let Some(event) = events.next() {
        match &event {
            Event::Code(code) => match formulas::mathml(code, false) {
                Some(math) => out.push(Event::InlineHtml(math.into())),
                None => out.push(event),
            },
            Event::Start(Tag::CodeBlock(CodeBlockKind::Fenced(kind))) if &**kind == "text" => {
                let math = match events.peek() {
                    Some(Event::Text(text)) => formulas::mathml(text, true),
                    _ => None,
                };
                let Some(math) = math else {
                    out.push(event);
                    continue;
                };
                // Skips the text and the end of the block.
                events.by_ref().take(2).for_each(drop);
                out.push(Event::Html(format!("{math}\n").into()));
            }
            _ => out.push(event),
        }
    }
    out
}

/// Output files by the names of their sources, for links between them.
#[derive(Default)]
pub struct Pages(Vec<(String, String)>);

impl Pages {
    /// Registers the output file of a source.
    pub fn add(&mut self, source: &str, file: &str) {
        self.0.push((source.to_owned(), file.to_owned()));
    }

    /// Converts text from a folder of the repository to HTML. Links to pages in the list point to their output, links
    /// to other files become plain text, and pictures are copied.
    ///
    /// # Errors
    /// If a picture is missing.
    pub fn html(&self, root: &Path, folder: &Path, text: &str, place: &str) -> Result<String> {
        let mut is_open = Vec::new();
        let mut kept = Vec::new();
        for event in events(&without_hidden(text)) {
            match event {
                Event::Start(Tag::Link { link_type, dest_url, title, id }) => {
                    let to = self.link(&dest_url);
                    is_open.push(to.is_some());
                    let dest_url = CowStr::from(to.unwrap_or_default());
                    if is_open.last() == Some(&true) {
                        kept.push(Event::Start(Tag::Link { link_type, dest_url, title, id }).into_static());
                    }
                }
                Event::End(TagEnd::Link) => {
                    if is_open.pop() == Some(true) {
                        kept.push(event.into_static());
                    }
                }
                Event::Start(Tag::Image { link_type, dest_url, title, id }) if !dest_url.contains(':') => {
                    let from = root.join(place).join(&*dest_url);
                    let name = dest_url.rsplit('/').next().unwrap_or_default().to_owned();
                    fs::create_dir_all(folder.join("pictures"))?;
                    let to = folder.join("pictures").join(&name);
                    fs::copy(&from, to).with_context(|| from.display().to_string())?;
                    let dest_url = CowStr::from(format!("pictures/{name}"));
                    kept.push(Event::Start(Tag::Image { link_type, dest_url, title, id }).into_static());
                }
                event => kept.push(event.into_static()),
            }
        }
        Ok(html(kept))
    }

    /// Returns the page that a link of a text refers to.
    fn link(&self, address: &str) -> Option<String> {
        if address.starts_with("https://") || address.starts_with('#') {
            return Some(address.to_owned());
        }
        let (path, anchor) =
            address.split_once('#').map_or((address, None), |(path, anchor)| (path, Some(anchor)));
        let name = path.rsplit('/').next().unwrap_or(path);
        let (_, file) = self.0.iter().find(|(source, _)| source == name)?;
        Some(anchor.map_or_else(|| file.clone(), |anchor| format!("{file}#{anchor}")))
    }
}

/// Removes lines of Rust that only tests need.
fn without_hidden(text: &str) -> String {
    let mut is_rust = false;
    let mut is_code = false;
    let mut out = String::with_capacity(text.len());
    for line in text.lines() {
        if let Some(kind) = line.trim_start().strip_prefix("```") {
            is_rust = !is_code && kind.starts_with("rust");
            is_code = !is_code;
        } else if is_rust && is_code && (line.trim() == "#" || line.trim_start().starts_with("# ")) {
            continue;
        }
        out += line;
        out.push('\n');
    }
    out
}

impl Site {
    /// Converts text to HTML: pictures of scenes become buttons, links to guide pages become links to output files.
    ///
    /// # Errors
    /// If a picture belongs to no scene, or a link has no target in the site.
    fn html(&mut self, events: Vec<Event<'_>>) -> Result<String> {
        let mut out: Vec<Event<'_>> = Vec::with_capacity(events.len());
        let mut in_picture = false;
        for event in typeset(events) {
            match event {
                Event::Start(Tag::Image { dest_url, .. }) => {
                    let scene = dest_url.strip_prefix("book/").and_then(|file| file.strip_suffix(".png"));
                    let scene = scene.with_context(|| format!("the picture {dest_url} is not of a scene"))?;
                    // A picture becomes a figure outside paragraphs.
                    let begins = matches!(out.last(), Some(Event::Start(Tag::Paragraph)));
                    ensure!(begins, "the picture {dest_url} is inside a paragraph");
                    out.pop();
                    let about = about_in(&self.sources, scene).unwrap_or_default();
                    ensure!(self.sources.is_empty() || !about.is_empty(), "there is no scene {scene}");
                    out.push(Event::Html(figure(scene, &about).into()));
                    self.scenes.push(scene.to_owned());
                    in_picture = true;
                }
                Event::End(TagEnd::Image) => {}
                Event::End(TagEnd::Paragraph) if in_picture => in_picture = false,
                _ if in_picture => {}
                Event::Start(Tag::Link { link_type, dest_url, title, id }) => {
                    let to = self.link(&dest_url)?;
                    out.push(Event::Start(Tag::Link { link_type, dest_url: CowStr::from(to), title, id }));
                }
                event => out.push(event),
            }
        }
        Ok(html(out))
    }

    /// Returns the output address of a link of the guide.
    fn link(&self, address: &str) -> Result<String> {
        if address.starts_with("https://") {
            return Ok(address.to_owned());
        }
        let (file, anchor) = address.split_once('#').unwrap_or((address, ""));
        let Some(name) = file.strip_suffix(".md").filter(|name| !name.contains('/')) else {
            bail!("the link to {address} has no target in the pages of the book");
        };
        Ok(if anchor.is_empty() { format!("{name}.html") } else { format!("{name}.html#{anchor}") })
    }
}

/// Returns a picture that runs its scene on a click, with the scene's description.
fn figure(scene: &str, about: &str) -> String {
    let about = escaped(about);
    format!(
        "<figure class=\"run\"><button data-scene=\"{scene}\" title=\"Run it here\"><img src=\"book/{scene}.png\" width=\"560\" height=\"315\" \
         alt=\"{scene}: {about}\" loading=\"lazy\"><span>Run {scene} here</span></button></figure>\n"
    )
}

/// Returns a page of text.
pub fn page(title: &str, body: &str) -> String {
    let title = escaped(title);
    format!(
        r#"<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:">
<title>{title} · Sinew</title>
<meta name="description" content="{title}: a page about Sinew, a physics engine for characters.">
<link rel="icon" href="data:,">
<link rel="stylesheet" href="page.css">
<script type="module" src="chapter.js"></script>
</head>
<body>
<main class="text">
{body}
</main>
</body>
</html>
"#
    )
}

#[cfg(test)]
mod tests {
    use super::{Site, chapters, events, html};
    use crate::command;

    const TEXT: &str = "# Book\n\n## 1. Forces\n\nA **force** is `a < b`, see [there](there.md).\n\n![two_men](book/two_men.png \"at 3 s\")\n\n\
                        | a | b |\n|---|---|\n| 1 | 2 |\n\n## 2. Words\n\nNo scene.\n";

    #[test]
    fn chapter_becomes_a_page() {
        let chapters = chapters(TEXT);
        assert_eq!(chapters.len(), 2);
        assert_eq!(html(chapters[0].title.clone()), "1. Forces");
        let mut site = Site::default();
        let page = site.html(chapters[0].text.clone()).expect("the text converts to a page");
        assert!(
            page.contains("<p>A <strong>force</strong> is <code>a &lt; b</code>, see <a href=\"there.html\">there</a>.</p>"),
            "{page}"
        );
        assert!(
            page.contains("data-scene=\"two_men\"") && page.contains("src=\"book/two_men.png\""),
            "{page}"
        );
        assert!(page.contains("<td>1</td><td>2</td>"), "{page}");
        assert!(!page.contains("<p><figure>"), "{page}");
        assert_eq!(site.scenes, ["two_men"]);
    }

    #[test]
    fn unconvertible_text_is_rejected() {
        for text in ["![x](other/x.png)\n", "See [here](../code.rs).\n", "A ![x](book/x.png) in a line.\n"] {
            assert!(Site::default().html(events(text)).is_err(), "{text}");
        }
    }

    #[test]
    fn formulas_are_typeset_and_code_is_not() {
        let text = "So `a = F/m` by `World::step`.\n\n```text\nT = 4π √(r/g) = 2.00607 s.\n```\n\n```text\nplain text\n```\n";
        let page = Site::default().html(events(text)).expect("the text converts to a page");
        assert!(page.contains("<math><mi>a</mi>") && page.contains("<code>World::step</code>"), "{page}");
        assert!(page.contains("<math display=\"block\"><mi>T</mi>") && page.contains("plain text"), "{page}");
    }

    #[test]
    fn guide_links_point_to_output_pages() {
        let mut pages = super::Pages::default();
        pages.add("joints.md", "joints.html");
        let text = "See [joints](../guide/src/joints.md#limits), [code](../src/lib.rs).\n\n```rust\n# hidden\nlet x = 1;\n```\n";
        let here = command::root();
        let html = pages.html(&here, &here, text, "").expect("the text converts to a page");
        assert!(html.contains("<a href=\"joints.html#limits\">joints</a>, code."), "{html}");
        assert!(html.contains("let x = 1;") && !html.contains("hidden"), "{html}");
    }

    /// The whole book is converted: every heading is a chapter, every picture a button.
    #[test]
    fn whole_book_is_converted() {
        let folder = command::target().join("tmp/chapters");
        std::fs::create_dir_all(&folder).expect("the folder can be created");
        let (written, scenes) = super::write(&command::root(), &folder).expect("the book can be converted");
        let book =
            std::fs::read_to_string(command::root().join(super::BOOK)).expect("the book can be converted");
        assert_eq!(written.len(), book.lines().filter(|line| line.starts_with("## ")).count());
        assert_eq!(scenes, book.lines().filter(|line| line.starts_with("![")).count());
    }
}
