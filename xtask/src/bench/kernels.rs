//! Speed of the eight-lane kernels, as a share of the limit of the machine's arithmetic (specification §5).

use super::machine::Machine;
use crate::command;
use anyhow::{Context, Result};
use std::process::Command;

const MANIFEST: &str = "bench/kernels/Cargo.toml";

/// Least share of the limit at the widest level, and the goal.
const SHARES: &[(&str, f64, f64)] = &[
    ("point_in_obb", 0.4, 0.7),
    ("point_obb_distance", 0.4, 0.7),
    ("obb_obb_overlap", 0.3, 0.6),
    ("obb_obb_15_axes", 0.3, 0.6),
];

/// Prefix of the limits in the program's output, in operations on eight lanes.
const LIMIT: &str = "limit.";

/// Result of a kernel, or of the machine.
#[derive(Clone, Debug, PartialEq)]
struct Figure {
    level: String,
    name: String,
    /// Items per second.
    rate: f64,
    /// Limit of the machine.
    limit: f64,
}

impl Figure {
    fn share(&self) -> f64 {
        self.rate / self.limit
    }
}

/// Builds the kernels, measures them, and prints a table. Returns a line for each that misses its share.
///
/// # Errors
/// If the kernels do not build or run.
pub fn measure() -> Result<Vec<String>> {
    let mut build = command::cargo(&["build", "--release", "--manifest-path", MANIFEST]);
    build.arg("--target-dir").arg(command::target().join("bench/kernels"));
    let program = command::build(&mut build, "sinew_kernels")?;
    let figures = parse(&command::output(&mut Command::new(program))?)?;
    print!("{}\n{}", table(&figures), Machine::this());
    let shortfalls = shortfalls(&figures);
    for line in &shortfalls {
        println!("misses its share: {line}");
    }
    Ok(shortfalls)
}

fn parse(output: &str) -> Result<Vec<Figure>> {
    let figure = |line: &str| {
        let mut words = line.split_whitespace();
        let mut next = || words.next().with_context(|| format!("not four words: `{line}`"));
        let (level, name) = (next()?.to_owned(), next()?.to_owned());
        Ok(Figure { level, name, rate: next()?.parse()?, limit: next()?.parse()? })
    };
    output.lines().map(figure).collect()
}

fn table(figures: &[Figure]) -> String {
    let mut table =
        String::from("| level | kernel | million a second | limit | share |\n|---|---|---|---|---|\n");
    for figure in figures {
        let (rate, limit) = (figure.rate / 1e6, figure.limit / 1e6);
        let row = match figure.name.strip_prefix(LIMIT) {
            Some(operation) => format!("| {} | *{operation}* | {rate:.0} | | |\n", figure.level),
            None => {
                let share = figure.share();
                format!("| {} | `{}` | {rate:.0} | {limit:.0} | {share:.2} |\n", figure.level, figure.name)
            }
        };
        table.push_str(&row);
    }
    table
}

/// Returns a line for each kernel that misses its share; the widest level is measured last.
fn shortfalls(figures: &[Figure]) -> Vec<String> {
    let widest = |name: &str| figures.iter().rfind(|figure| figure.name == name);
    let line = |&(name, must, goal): &(&str, f64, f64)| match widest(name) {
        None => Some(format!("{name} was not measured")),
        Some(figure) => {
            let share = figure.share();
            (share < must).then(|| format!("{name}: {share:.2} of the limit, must {must}, goal {goal}"))
        }
    };
    SHARES.iter().filter_map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const OUTPUT: &str = "Sse2 limit.Mul 2e9 2e9\nSse2 obb_obb_15_axes 1e7 6e7\nAvx2 obb_obb_15_axes 6e7 1.2e8\n\
        Avx2 obb_obb_overlap 1e7 1e8\nAvx2 point_in_obb 2e9 3e9\nAvx2 point_obb_distance 1e9 2e9\n";

    #[test]
    fn only_the_widest_level_is_judged() {
        let figures = parse(OUTPUT).expect("well formed");
        assert_eq!(shortfalls(&figures), ["obb_obb_overlap: 0.10 of the limit, must 0.3, goal 0.6"]);
        assert_eq!(shortfalls(&figures[..3]).len(), 3, "an unmeasured kernel counts as met");
    }

    #[test]
    fn rows_of_limits_have_no_share() {
        let table = table(&parse(OUTPUT).expect("well formed"));
        assert!(table.contains("| Sse2 | *Mul* | 2000 | | |\n"), "{table}");
        assert!(table.contains("| Avx2 | `obb_obb_15_axes` | 60 | 120 | 0.50 |\n"), "{table}");
    }

    #[test]
    fn a_malformed_line_is_an_error() {
        assert!(parse("Avx2 point_in_obb 2e9").is_err());
    }
}
