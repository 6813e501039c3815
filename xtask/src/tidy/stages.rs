//! Checks that the code's list of stages equals the manual's.

use super::lexer::{self, Kind};
use super::{Finding, Repo};

const STEP: &str = "crates/sinew_physics/src/step/mod.rs";
const STAGE: &str = "crates/sinew_physics/src/stage.rs";
const MANUAL: &str = "docs/step.md";
const STEP_LINES_MAX: usize = 80;

/// Checks that `step/mod.rs` is short, and `enum Stage` has the stages of `docs/step.md` in the same order.
pub fn check(repo: &Repo) -> Vec<Finding> {
    let mut findings = Vec::new();
    if let Some(step) = repo.file(STEP) {
        let lines = step.text.lines().count();
        if STEP_LINES_MAX < lines {
            let message = format!("{lines} lines, at most {STEP_LINES_MAX}: one call and one zone per stage");
            findings.push(Finding::new(STEP, 1, message));
        }
    }
    let (Some(stage), Some(manual)) = (repo.file(STAGE), repo.file(MANUAL)) else { return findings };
    let coded = variants(&stage.text);
    let documented = headings(&manual.text);
    for (name, line) in &coded {
        if !documented.iter().any(|(other, _)| other == name) {
            findings.push(Finding::new(STAGE, *line, format!("stage `{name}` has no heading in {MANUAL}")));
        }
    }
    for (name, line) in &documented {
        if !coded.iter().any(|(other, _)| other == name) {
            findings.push(Finding::new(
                MANUAL,
                *line,
                format!("stage `{name}` is no variant of `Stage` in {STAGE}"),
            ));
        }
    }
    let mut pairs = coded.iter().zip(&documented);
    if findings.is_empty()
        && let Some(((name, line), (other, _))) = pairs.find(|(coded, documented)| coded.0 != documented.0)
    {
        findings.push(Finding::new(STAGE, *line, format!("stage `{name}` is where {MANUAL} has `{other}`")));
    }
    if findings.is_empty() && drawn(&manual.text, &coded).is_some_and(|drawn| drawn != coded.len()) {
        findings.push(Finding::new(MANUAL, 1, "the diagram does not have all stages in their order"));
    }
    findings
}

/// Returns the number of words in the manual's first diagram that are the stages in their order; `None` if there is no
/// diagram.
fn drawn(text: &str, stages: &[(String, usize)]) -> Option<usize> {
    let diagram = text.split("```").nth(1)?.strip_prefix("text\n")?;
    let words = diagram.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty());
    let mut left = stages.iter().map(|(name, _)| name.as_str()).peekable();
    Some(words.filter(|word| left.next_if_eq(word).is_some()).count())
}

/// Returns stages by heading: "## `name`".
fn headings(text: &str) -> Vec<(String, usize)> {
    let stage = |line: &str| Some(line.strip_prefix("## `")?.strip_suffix('`')?.to_owned());
    text.lines().enumerate().filter_map(|(index, line)| Some((stage(line)?, index + 1))).collect()
}

/// Returns the variants of `enum Stage`, in snake case.
fn variants(text: &str) -> Vec<(String, usize)> {
    let tokens = lexer::tokens(text);
    let Some(open) = lexer::find(&tokens, "enum Stage {").next().map(|at| at + 2) else { return Vec::new() };
    let body = &tokens[open..=lexer::closing(&tokens, open)];
    // A variant is before a comma or the closing brace, and not part of an attribute.
    let pairs =
        body.windows(2).filter(|pair| pair[0].kind == Kind::Word && matches!(pair[1].text, "," | "}"));
    pairs.map(|pair| (snake_case(pair[0].text), pair[0].line)).collect()
}

fn snake_case(name: &str) -> String {
    let mut snake = String::new();
    for c in name.chars() {
        if c.is_uppercase() && !snake.is_empty() {
            snake.push('_');
        }
        snake.extend(c.to_lowercase());
    }
    snake
}

#[cfg(test)]
mod tests {
    use super::super::tests::check_lines;
    use super::*;

    fn check_stages(code: &str, manual: &str) -> Vec<String> {
        let repo = Repo::planted(&[(STAGE, code), (MANUAL, manual)]);
        check(&repo).iter().map(ToString::to_string).collect()
    }

    const CODE: &str = "pub enum Stage {\n /// Doc.\n Pairs,\n #[default]\n IntegrateVelocity\n}";

    #[test]
    fn same_stages_in_the_same_order_are_accepted() {
        assert!(check_stages(CODE, "# Step\n## `pairs`\n## Notes\n## `integrate_velocity`\n").is_empty());
    }

    #[test]
    fn the_diagram_has_all_stages_in_order() {
        let with = |diagram: &str| {
            check_stages(CODE, &format!("```text\n{diagram}\n```\n## `pairs`\n## `integrate_velocity`\n"))
        };
        assert!(with("pairs → 4 × { integrate_velocity }").is_empty());
        assert_eq!(with("integrate_velocity → pairs").len(), 1);
        assert_eq!(with("pairs").len(), 1);
    }

    #[test]
    fn differences_are_found() {
        assert_eq!(
            check_stages(CODE, "## `pairs`\n## `solve`\n"),
            [
                "crates/sinew_physics/src/stage.rs:5: stage `integrate_velocity` has no heading in docs/step.md",
                "docs/step.md:2: stage `solve` is no variant of `Stage` in crates/sinew_physics/src/stage.rs"
            ]
        );
        assert_eq!(
            check_stages(CODE, "## `integrate_velocity`\n## `pairs`\n"),
            [
                "crates/sinew_physics/src/stage.rs:3: stage `pairs` is where docs/step.md has `integrate_velocity`"
            ]
        );
    }

    #[test]
    fn a_long_step_is_found() {
        check_lines(check, STEP, &"\n".repeat(80), &[]);
        check_lines(check, STEP, &"\n".repeat(81), &[1]);
    }
}
