//! Instruction counts of the kernels, compared to the committed ones. Unlike time, they do not depend on other load.

use crate::command;
use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::env::consts::ARCH;
use std::fmt::Write as _;
use std::fs;
use std::process::Command;

/// Committed counts: a line with the compiler, then one line per kernel: name, instructions.
const PATH: &str = "bench/counts/baseline.txt";

const MANIFEST: &str = "bench/counts/Cargo.toml";

/// Share by which a count may differ from the committed one.
const TOLERANCE: f64 = 0.02;

/// Version of the runner, the same as that of the crate `gungraun` in the manifest.
const RUNNER_VERSION: &str = "0.20.0";

/// Instructions per microsecond of long trees on the reference machine (62 million in 8 ms), for orientation.
const PER_MICROSECOND: f64 = 7_500.0;

/// A kernel's cost.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Count {
    kernel: String,
    instructions: u64,
}

/// Counts, with their compiler: counts of different compilers are not comparable.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Counts {
    compiler: String,
    kernels: Vec<Count>,
}

/// Counts and compares with the committed counts. Prints a message if valgrind or its runner is missing and cannot be
/// installed.
///
/// # Errors
/// If a count differs by more than the tolerance, up or down, or nothing can be counted.
pub fn check() -> Result<()> {
    if let Err(missing) = provide() {
        eprintln!("{missing:#}");
        eprintln!("SKIPPED: instructions are not counted on this machine");
        return Ok(());
    }
    let committed = fs::read_to_string(command::root().join(PATH)).context(PATH)?;
    let committed = parse(&committed)?;
    let found = count()?;
    print(&found, Some(&committed));
    let differences = differences(&committed, &found);
    if !differences.is_empty() {
        bail!("{}\nif that is intended: `cargo xtask bench --counts --bless`", differences.join("\n"));
    }
    Ok(())
}

/// Counts, and stores the counts as the expected ones.
///
/// # Errors
/// If nothing can be counted.
pub fn bless() -> Result<()> {
    provide()?;
    let found = count()?;
    print(&found, None);
    fs::write(command::root().join(PATH), text(&found)).context(PATH)
}

/// Installs missing tools for counting.
fn provide() -> Result<()> {
    command::provide("valgrind", "valgrind")?;
    if !command::answers("gungraun-runner") {
        command::run(&mut command::cargo(&["install", "gungraun-runner", "--version", RUNNER_VERSION]))
            .context("gungraun-runner is missing")?;
    }
    Ok(())
}

fn count() -> Result<Counts> {
    let mut bench = command::cargo(&["bench", "--quiet", "--manifest-path", MANIFEST]);
    bench.args(["--target-dir".as_ref(), command::target().join("bench/counts").as_os_str()]);
    let lines = command::output(bench.args(["--", "--output-format=json"]))?;
    let kernels: Result<_> = lines.lines().map(|line| kernel(&serde_json::from_str(line)?)).collect();
    Ok(Counts { compiler: compiler()?, kernels: kernels.context("output of gungraun")? })
}

fn kernel(summary: &Value) -> Result<Count> {
    let name = |key: &str| summary[key].as_str().with_context(|| format!("no `{key}`"));
    let total = &summary["profiles"][0]["data"]["total"]["metrics"];
    let instructions = total["Ir"]["values"]["new"].as_u64().context("no instructions")?;
    Ok(Count { kernel: format!("{}.{}", name("function_name")?, name("id")?), instructions })
}

fn compiler() -> Result<String> {
    let version = command::output(Command::new("rustc").arg("--version"))?;
    let version = version.split_whitespace().nth(1).context("`rustc --version` names no version")?;
    Ok(format!("rustc {version} {ARCH}"))
}

fn text(counts: &Counts) -> String {
    let mut text = format!("# {}\n", counts.compiler);
    for Count { kernel, instructions } in &counts.kernels {
        writeln!(text, "{kernel} {instructions}").expect("writing to a string cannot fail");
    }
    text
}

fn parse(text: &str) -> Result<Counts> {
    let (first, rest) = text.split_once('\n').unwrap_or((text, ""));
    let compiler = first.strip_prefix("# ").with_context(|| format!("{PATH}:1: not `# rustc …`"))?;
    let line = |(index, line): (usize, &str)| {
        let count = line.split_once(' ').and_then(|(kernel, count)| {
            Some(Count { kernel: kernel.to_owned(), instructions: count.parse().ok()? })
        });
        count.with_context(|| format!("{PATH}:{}: not `kernel instructions`", index + 2))
    };
    let kernels: Result<_> = rest.lines().enumerate().map(line).collect();
    Ok(Counts { compiler: compiler.to_owned(), kernels: kernels? })
}

fn of<'a>(counts: &'a Counts, kernel: &str) -> Option<&'a Count> {
    counts.kernels.iter().find(|count| count.kernel == kernel)
}

/// Prints a readable table.
fn print(found: &Counts, committed: Option<&Counts>) {
    println!("{:<32} {:>14} {:>9} {:>9}", "kernel", "instructions", "about µs", "change");
    for Count { kernel, instructions } in &found.kernels {
        let old = committed.and_then(|committed| of(committed, kernel));
        let change =
            old.map_or("–".to_owned(), |old| format!("{:+.2} %", 100.0 * change(old, *instructions)));
        let microseconds = *instructions as f64 / PER_MICROSECOND;
        println!("{kernel:<32} {:>14} {microseconds:>9.0} {change:>9}", grouped(*instructions));
    }
}

/// Returns the relative increase of the count.
fn change(old: &Count, new: u64) -> f64 {
    new as f64 / old.instructions as f64 - 1.0
}

/// Formats a number with a comma after every three digits.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut grouped = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    grouped
}

/// Returns one line per kernel that is new, removed or has a different count.
fn differences(committed: &Counts, found: &Counts) -> Vec<String> {
    if committed.compiler != found.compiler {
        return vec![format!(
            "{PATH} was counted by {}, this compiler is {}",
            committed.compiler, found.compiler
        )];
    }
    let mut lines = Vec::new();
    for count in &found.kernels {
        match of(committed, &count.kernel) {
            None => lines.push(format!("{}: not in {PATH}", count.kernel)),
            Some(old) if change(old, count.instructions).abs() > TOLERANCE => lines.push(format!(
                "{}: {} instructions, {:+.1} %",
                count.kernel,
                grouped(count.instructions),
                100.0 * change(old, count.instructions)
            )),
            Some(_) => {}
        }
    }
    let gone = committed.kernels.iter().filter(|count| of(found, &count.kernel).is_none());
    lines.extend(gone.map(|count| format!("{}: in {PATH}, but it is not counted", count.kernel)));
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn written_text_reads_back_equal() {
        let counts = parse("# rustc 1.95.0 x86_64\nstep.a 10\nstep.b 20\n").expect("well formed");
        assert_eq!(parse(&text(&counts)).expect("well formed"), counts);
        let error = parse("# rustc\nstep.a 10\nstep.b many").expect_err("`many` is no number");
        assert_eq!(error.to_string(), "bench/counts/baseline.txt:3: not `kernel instructions`");
    }

    #[test]
    fn added_removed_and_costlier_kernels_are_reported() {
        let committed = parse("# rustc\na 1000\nb 1000\nc 1000\nd 1000\n").expect("well formed");
        assert_eq!(differences(&committed, &committed), [""; 0]);
        let found = parse("# rustc\na 1019\nb 1030\nc 900\ne 1\n").expect("well formed");
        assert_eq!(
            differences(&committed, &found),
            [
                "b: 1,030 instructions, +3.0 %",
                "c: 900 instructions, -10.0 %",
                "e: not in bench/counts/baseline.txt",
                "d: in bench/counts/baseline.txt, but it is not counted"
            ]
        );
    }

    #[test]
    fn counts_of_another_compiler_are_not_compared() {
        let committed = parse("# rustc 1.95.0 x86_64\na 1000\n").expect("well formed");
        let found = parse("# rustc 1.96.0 x86_64\na 2000\n").expect("well formed");
        assert_eq!(
            differences(&committed, &found),
            [
                "bench/counts/baseline.txt was counted by rustc 1.95.0 x86_64, this compiler is rustc 1.96.0 x86_64"
            ]
        );
    }

    #[test]
    fn digits_are_grouped_in_threes() {
        assert_eq!([1, 100, 1000, 1234567].map(grouped), ["1", "100", "1,000", "1,234,567"]);
    }
}
