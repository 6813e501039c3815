//! A random sample of comments, messages, test names and page lines, to be judged by a reader.

use crate::tidy::{File, Repo};
use anyhow::Result;

/// Shortest text that is sampled, characters: shorter ones are headings and single words.
const SHORTEST: usize = 20;

/// `cargo xtask sample`: prints random lines of human-readable text.
#[derive(clap::Args)]
#[command(after_help = "Example: cargo xtask sample --seed 7 --within crates/sinew_physics")]
pub struct Sample {
    /// Seed: equal seeds give equal samples of equal files
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Number of lines
    #[arg(long, default_value_t = 200)]
    count: usize,
    /// Only files whose path starts like this; repeatable
    #[arg(long)]
    within: Vec<String>,
}

impl Sample {
    /// # Errors
    /// If the repository cannot be read.
    pub fn run(&self) -> Result<()> {
        let repo = Repo::read()?;
        let is_within = |file: &&File| {
            self.within.is_empty() || self.within.iter().any(|start| file.path.starts_with(start))
        };
        let lines = repo.files.iter().filter(is_within).flat_map(lines).collect();
        for line in pick(lines, self.seed, self.count) {
            println!("{line}");
        }
        Ok(())
    }
}

/// Returns the lines of a file that contain human-readable text, each with its path and number.
fn lines(file: &File) -> Vec<String> {
    let mut is_code = false;
    let mut lines = Vec::new();
    for (index, line) in file.text.lines().enumerate() {
        let line = line.trim();
        is_code ^= file.path.ends_with(".md") && line.starts_with("```");
        let text = if is_code { None } else { words(&file.path, line) };
        if let Some(text) = text.filter(|text| text.chars().count() >= SHORTEST) {
            lines.push(format!("{}:{}: {text}", file.path, index + 1));
        }
    }
    lines
}

/// Returns the comment, message or test name of a line of code, or a line of a page.
fn words<'a>(path: &str, line: &'a str) -> Option<&'a str> {
    match path.rsplit_once('.')?.1 {
        "md" => Some(line).filter(|line| !line.starts_with("|-")),
        "rs" if line.starts_with("//") => Some(line.trim_start_matches(['/', '!']).trim_start()),
        "rs" if path.contains("/tests/") && line.starts_with("fn ") => line[3..].strip_suffix("() {"),
        "rs" => line.split('"').nth(1).filter(|text| text.contains(' ')),
        "py" | "pyi" => line.strip_prefix("# ").or(line.strip_prefix("\"\"\"")),
        "js" | "mjs" | "ts" | "h" => line.strip_prefix("// ").or(line.strip_prefix("* ")),
        _ => None,
    }
}

/// Returns `count` of the lines, drawn at random.
fn pick(mut lines: Vec<String>, seed: u64, count: usize) -> Vec<String> {
    let mut state = seed;
    for taken in 0..count.min(lines.len()) {
        // SplitMix64 (Steele, Lea and Flood 2014).
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let rest = (lines.len() - taken) as u64;
        lines.swap(taken, taken + ((mixed ^ (mixed >> 31)) % rest) as usize);
    }
    lines.truncate(count);
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_taken_from_comments_messages_names_and_pages() {
        let of = |path, line| words(path, line);
        assert_eq!(of("a.rs", "/// Returns the sum."), Some("Returns the sum."));
        assert_eq!(of("a.rs", "let x = \"is not finite\";"), Some("is not finite"));
        assert_eq!(of("crates/a/tests/it/b.rs", "fn a_ball_rolls() {"), Some("a_ball_rolls"));
        assert_eq!(of("a.md", "A page."), Some("A page."));
        assert_eq!(of("a.md", "|---|"), None);
        assert_eq!(of("a.rs", "let x = 1;"), None);
    }

    #[test]
    fn equal_seeds_give_equal_samples_without_repeats() {
        let all: Vec<String> = (0..50).map(|k| k.to_string()).collect();
        let [one, again, other] = [7, 7, 8].map(|seed| pick(all.clone(), seed, 20));
        assert!(one == again && one != other);
        let mut distinct = one.clone();
        distinct.sort();
        distinct.dedup();
        assert_eq!(distinct.len(), 20);
        assert_eq!(pick(all, 1, 100).len(), 50);
    }
}
