//! Pages of the book beside the viewer's: the chapters of `docs/guide/src/book.md`, with each of their scenes to be run in place.
//!
//! The text is the guide's own, in the few forms of Markdown that it has; pictures become what runs at a click.

use anyhow::{Context, Result, ensure};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// Text of the book.
const BOOK: &str = "docs/guide/src/book.md";

/// A chapter: its title, and its text as Markdown.
struct Chapter {
    title: String,
    text: String,
}

/// Writes a page for each chapter and one with their titles into the folder of the viewer's page; their number, and that of scenes.
///
/// # Errors
/// If the book is not there, or has no chapters.
pub fn write(root: &Path, folder: &Path) -> Result<(usize, usize)> {
    let book = fs::read_to_string(root.join(BOOK)).context(BOOK)?;
    let chapters = chapters(&book);
    ensure!(!chapters.is_empty(), "{BOOK} has no chapters");
    let pictures = folder.join("book");
    fs::create_dir_all(&pictures)?;
    let mut scenes = 0;
    for (number, chapter) in chapters.iter().enumerate() {
        for name in scenes_of(&chapter.text) {
            let picture = format!("{name}.png");
            let from = root.join("docs/guide/src/book").join(&picture);
            fs::copy(&from, pictures.join(&picture)).with_context(|| from.display().to_string())?;
            scenes += 1;
        }
        let links = links(&chapters, Some(number));
        let body =
            format!("<nav>{links}</nav>\n<h1>{}</h1>\n{}", inline(&chapter.title), html(&chapter.text));
        fs::write(folder.join(file(number)), page(&chapter.title, &body))?;
    }
    let body = format!(
        "<h1>The book's experiments</h1>\n<p>Each chapter with its scenes beside the formulas: a click on a picture runs it. \
         <a href=\"index.html\">All scenes</a> are in the viewer.</p>\n<ul>{}</ul>",
        links(&chapters, None)
    );
    fs::write(folder.join("book.html"), page("The book's experiments", &body))?;
    Ok((chapters.len(), scenes))
}

fn file(number: usize) -> String {
    format!("chapter-{}.html", number + 1)
}

/// Links to all chapters, but for the one that is shown.
fn links(chapters: &[Chapter], shown: Option<usize>) -> String {
    let link = |(number, chapter): (usize, &Chapter)| {
        let title = inline(&chapter.title);
        if shown == Some(number) {
            format!("<li><b>{title}</b></li>")
        } else {
            format!("<li><a href=\"{}\">{title}</a></li>", file(number))
        }
    };
    let list: Vec<String> = chapters.iter().enumerate().map(link).collect();
    if shown.is_some() {
        format!("<a href=\"index.html\">Viewer</a><ol>{}</ol>", list.concat())
    } else {
        list.concat()
    }
}

/// Parts of the book below its headings of the second level; such as have no scene are no chapters.
fn chapters(book: &str) -> Vec<Chapter> {
    let parts = book.split("\n## ").skip(1).filter_map(|part| {
        let (title, text) = part.split_once('\n')?;
        Some(Chapter { title: title.trim().to_owned(), text: text.to_owned() })
    });
    parts.filter(|chapter| !scenes_of(&chapter.text).is_empty()).collect()
}

/// Scenes whose pictures a text has.
fn scenes_of(text: &str) -> Vec<&str> {
    text.lines().filter_map(picture).collect()
}

/// Name of the scene whose picture stands on a line alone.
fn picture(line: &str) -> Option<&str> {
    let (name, path) = line.trim().strip_prefix("![")?.split_once("](book/")?;
    let name = if path == format!("{name}.png)") { name } else { path.strip_suffix(".png)")? };
    Some(name)
}

/// Text as HTML.
fn html(text: &str) -> String {
    let mut out = String::new();
    for block in text.split("\n\n").map(str::trim).filter(|block| !block.is_empty()) {
        let first = block.lines().next().unwrap_or_default();
        if let Some(name) = picture(first) {
            let _ = writeln!(
                out,
                "<figure><button data-scene=\"{name}\" title=\"run it here\"><img src=\"book/{name}.png\" alt=\"{name}\" \
                 loading=\"lazy\"><span>Run {name} here</span></button></figure>"
            );
        } else if first.starts_with('#') {
            let level = first.chars().take_while(|&it| it == '#').count().min(6);
            let _ = writeln!(out, "<h{level}>{}</h{level}>", inline(first.trim_start_matches('#').trim()));
            let rest = block.lines().skip(1).collect::<Vec<_>>().join("\n");
            out += &html(&rest);
        } else if first.starts_with('|') {
            out += &table(block);
        } else if first.starts_with("```") {
            let code: Vec<&str> = block.lines().filter(|line| !line.starts_with("```")).collect();
            let _ = writeln!(out, "<pre>{}</pre>", escaped(&code.join("\n")));
        } else if first.starts_with("- ") {
            let items = block.split("\n- ").map(|item| item.trim_start_matches("- "));
            let items: Vec<String> = items.map(|item| format!("<li>{}</li>", inline(item))).collect();
            let _ = writeln!(out, "<ul>{}</ul>", items.concat());
        } else {
            let _ = writeln!(out, "<p>{}</p>", inline(block));
        }
    }
    out
}

fn table(block: &str) -> String {
    let cells = |line: &str, tag: &str| {
        let line = line.trim().trim_start_matches('|').trim_end_matches('|');
        let cells: Vec<String> =
            line.split('|').map(|cell| format!("<{tag}>{}</{tag}>", inline(cell.trim()))).collect();
        format!("<tr>{}</tr>", cells.concat())
    };
    let mut lines = block.lines();
    let head = lines.next().map(|line| cells(line, "th")).unwrap_or_default();
    let rows: Vec<String> = lines.skip(1).map(|line| cells(line, "td")).collect();
    format!("<table>{head}{}</table>\n", rows.concat())
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Code, strong and stressed words and links of a text. Links lead nowhere here: what they lead to is not in the folder.
fn inline(text: &str) -> String {
    let mut out = String::new();
    for (place, part) in text.split('`').enumerate() {
        if place % 2 == 1 {
            let _ = write!(out, "<code>{}</code>", escaped(part));
            continue;
        }
        let part = marked(&unlinked(&escaped(part)), "**", "b");
        out += &marked(&part, "*", "i");
    }
    // Code between stars: the stars are in two parts.
    marked(&out, "**", "b")
}

/// Text between two marks in a tag.
fn marked(text: &str, mark: &str, tag: &str) -> String {
    let parts: Vec<&str> = text.split(mark).collect();
    if parts.len() < 3 || parts.len().is_multiple_of(2) {
        return text.to_owned();
    }
    let tagged = |(place, part): (usize, &&str)| {
        if place % 2 == 1 { format!("<{tag}>{part}</{tag}>") } else { (*part).to_owned() }
    };
    parts.iter().enumerate().map(tagged).collect()
}

/// Text of links without where they lead.
fn unlinked(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('[') {
        out += before;
        let link = after.split_once("](").and_then(|(words, tail)| Some((words, tail.split_once(')')?.1)));
        match link {
            Some((words, tail)) if !words.contains('[') => {
                out += words;
                rest = tail;
            }
            _ => {
                out.push('[');
                rest = after;
            }
        }
    }
    out + rest
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
    use super::{chapters, html, picture};

    const TEXT: &str = "# Book\n\n## 1. Forces\n\nA **force** is `a < b`, see [there](there.md).\n\n![two_men](book/two_men.png)\n\n\
                        | a | b |\n|---|---|\n| 1 | 2 |\n\n## 2. Words\n\nNo scene.\n";

    #[test]
    fn a_chapter_is_a_page() {
        let chapters = chapters(TEXT);
        assert_eq!(chapters.len(), 1);
        assert_eq!(chapters[0].title, "1. Forces");
        let page = html(&chapters[0].text);
        assert!(page.contains("<p>A <b>force</b> is <code>a &lt; b</code>, see there.</p>"), "{page}");
        assert!(
            page.contains("data-scene=\"two_men\"") && page.contains("src=\"book/two_men.png\""),
            "{page}"
        );
        assert!(page.contains("<tr><th>a</th><th>b</th></tr><tr><td>1</td><td>2</td></tr>"), "{page}");
        assert_eq!(picture("![kepler](book/kepler.png)"), Some("kepler"));
        assert_eq!(picture("text ![kepler](book/kepler.png)"), None);
    }
}
