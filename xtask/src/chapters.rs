//! Pages of the book beside the viewer's: the chapters of `docs/guide/src/book.md`, with each of their scenes to be run in place.
//!
//! The text is the guide's own; pictures of scenes become what runs at a click, and pages that a chapter links to lie beside it.

use anyhow::{Context, Result, bail, ensure};
use pulldown_cmark::{CowStr, Event, HeadingLevel, Options, Parser, Tag, TagEnd};
use std::fs;
use std::path::Path;

/// Text of the book.
const BOOK: &str = "docs/guide/src/book.md";
/// Folder of the book, of the pages that it links to, and of its pictures.
const GUIDE: &str = "docs/guide/src";

/// A chapter: its title, and its text.
struct Chapter<'a> {
    title: Vec<Event<'a>>,
    text: Vec<Event<'a>>,
}

/// Contents of pages as they are made: what they show and lead to.
#[derive(Default)]
struct Site {
    /// Scenes whose pictures are shown.
    scenes: Vec<String>,
    /// Pages of the guide that are linked to, by file name without its ending.
    pages: Vec<String>,
}

/// Writes a page for each chapter and one with their titles into the folder of the viewer's page; returns the number of chapters, and that of scenes.
///
/// # Errors
/// If the book is not there or has no chapters, or if one of its pictures, links or chapters would be lost.
pub fn write(root: &Path, folder: &Path) -> Result<(usize, usize)> {
    let book = fs::read_to_string(root.join(BOOK)).context(BOOK)?;
    let chapters = chapters(&book);
    ensure!(!chapters.is_empty(), "{BOOK} has no chapters");
    let titles: Vec<String> = chapters.iter().map(|chapter| html(chapter.title.clone())).collect();
    let mut site = Site::default();
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
    for name in &site.pages {
        let text = guide_page(root, name)?;
        let body =
            format!("<nav><a href=\"book.html\">The book</a></nav>\n{}", html(without_links(events(&text))));
        fs::write(folder.join(format!("{name}.html")), page(name, &body))?;
    }
    let body = format!(
        "<h1>The book's experiments</h1>\n<p>Each chapter with its scenes beside the formulas: a click on a picture runs it. \
         <a href=\"index.html\">All scenes</a> are in the viewer.</p>\n<ul>{}</ul>",
        links(&titles, None)
    );
    fs::write(folder.join("book.html"), page("The book's experiments", &body))?;
    Ok((titles.len(), site.scenes.len()))
}

/// Text of a page of the guide, with what it includes.
fn guide_page(root: &Path, name: &str) -> Result<String> {
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

/// Links to all chapters, but for the one that is shown.
fn links(titles: &[String], shown: Option<usize>) -> String {
    let link = |(number, title): (usize, &String)| {
        if shown == Some(number) {
            format!("<li><b>{title}</b></li>")
        } else {
            format!("<li><a href=\"{}\">{title}</a></li>", file(number))
        }
    };
    let list: Vec<String> = titles.iter().enumerate().map(link).collect();
    if shown.is_some() {
        format!("<a href=\"index.html\">Viewer</a><ol>{}</ol>", list.concat())
    } else {
        list.concat()
    }
}

fn events(text: &str) -> Vec<Event<'_>> {
    Parser::new_ext(text, Options::ENABLE_TABLES).collect()
}

/// Parts of the book below its headings of the second level.
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

/// Text of HTML without its tags.
fn plain(html: &str) -> String {
    html.split('<').map(|part| part.split_once('>').map_or(part, |(_, text)| text)).collect()
}

/// Text whose links are words: of a page that a chapter leads to, whose own links lead into the repository.
fn without_links(events: Vec<Event<'_>>) -> Vec<Event<'_>> {
    let is_link = |event: &Event<'_>| matches!(event, Event::Start(Tag::Link { dest_url, .. }) if !dest_url.starts_with("https://"));
    let mut is_open = Vec::new();
    let mut kept = Vec::with_capacity(events.len());
    for event in events {
        let is_left_out = match &event {
            Event::Start(Tag::Link { .. }) => {
                is_open.push(is_link(&event));
                is_link(&event)
            }
            Event::End(TagEnd::Link) => is_open.pop() == Some(true),
            _ => false,
        };
        if !is_left_out {
            kept.push(event);
        }
    }
    kept
}

impl Site {
    /// Text as HTML: pictures of scenes as buttons, links to pages of the guide as links to files beside this one.
    ///
    /// # Errors
    /// On a picture that is no scene's, and a link that leads nowhere here.
    fn html(&mut self, events: Vec<Event<'_>>) -> Result<String> {
        let mut out: Vec<Event<'_>> = Vec::with_capacity(events.len());
        let mut in_picture = false;
        for event in events {
            match event {
                Event::Start(Tag::Image { dest_url, .. }) => {
                    let scene = dest_url.strip_prefix("book/").and_then(|file| file.strip_suffix(".png"));
                    let scene = scene.with_context(|| format!("the picture {dest_url} is no scene's"))?;
                    // A picture is a figure of its own, in no paragraph.
                    let begins = matches!(out.last(), Some(Event::Start(Tag::Paragraph)));
                    ensure!(begins, "the picture {dest_url} stands within a paragraph");
                    out.pop();
                    out.push(Event::Html(figure(scene).into()));
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

    /// Address of what a link of the guide leads to.
    fn link(&mut self, address: &str) -> Result<String> {
        if address.starts_with("https://") {
            return Ok(address.to_owned());
        }
        let (file, anchor) = address.split_once('#').unwrap_or((address, ""));
        let Some(name) = file.strip_suffix(".md").filter(|name| !name.contains('/')) else {
            bail!("the link to {address} leads nowhere in the pages of the book");
        };
        if !self.pages.iter().any(|known| known == name) {
            self.pages.push(name.to_owned());
        }
        Ok(if anchor.is_empty() { format!("{name}.html") } else { format!("{name}.html#{anchor}") })
    }
}

/// Picture of a scene that runs at a click.
fn figure(scene: &str) -> String {
    format!(
        "<figure><button data-scene=\"{scene}\" title=\"run it here\"><img src=\"book/{scene}.png\" alt=\"Picture of the scene {scene}\" \
         loading=\"lazy\"><span>Run {scene} here</span></button></figure>\n"
    )
}

fn page(title: &str, body: &str) -> String {
    format!(
        r#"<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:">
<title>{title}</title>
<link rel="icon" href="data:,">
<style>
  body {{ margin: 0 auto; max-width: 900px; padding: 1em; background: #1b1e24; color: #e1e5eb; font: 16px/1.55 system-ui, sans-serif; }}
  a {{ color: #58a6ff; }} code {{ background: #14161b; padding: 0 .25em; border-radius: 3px; }} pre {{ background: #14161b; padding: 1em; overflow: auto; }}
  nav {{ font-size: 14px; }} nav ol {{ columns: 2; padding-left: 1.2em; list-style: none; }}
  table {{ border-collapse: collapse; margin: 1em 0; }} th, td {{ border: 1px solid #3a404b; padding: .25em .7em; text-align: left; }}
  figure {{ margin: 1em 0; }} figure button {{ border: 0; padding: 0; background: none; color: #58a6ff; cursor: pointer; font: inherit; }}
  figure img {{ display: block; max-width: 100%; }} iframe {{ width: 100%; height: 520px; border: 1px solid #3a404b; }}
</style>
<script type="module" src="chapter.js"></script>
</head>
<body>
{body}
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
    fn a_chapter_is_a_page() {
        let chapters = chapters(TEXT);
        assert_eq!(chapters.len(), 2);
        assert_eq!(html(chapters[0].title.clone()), "1. Forces");
        let mut site = Site::default();
        let page = site.html(chapters[0].text.clone()).expect("a page");
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
        assert_eq!((site.scenes, site.pages), (vec!["two_men".to_owned()], vec!["there".to_owned()]));
    }

    #[test]
    fn what_would_be_lost_is_refused() {
        for text in ["![x](other/x.png)\n", "See [here](../code.rs).\n", "A ![x](book/x.png) in a line.\n"] {
            assert!(Site::default().html(events(text)).is_err(), "{text}");
        }
    }

    /// Nothing of the book itself is lost: every heading is a chapter, every picture a button.
    #[test]
    fn the_whole_book_is_written() {
        let folder = command::target().join("tmp/chapters");
        std::fs::create_dir_all(&folder).expect("a folder");
        let (written, scenes) = super::write(&command::root(), &folder).expect("the book");
        let book = std::fs::read_to_string(command::root().join(super::BOOK)).expect("the book");
        assert_eq!(written, book.lines().filter(|line| line.starts_with("## ")).count());
        assert_eq!(scenes, book.lines().filter(|line| line.starts_with("![")).count());
    }
}
