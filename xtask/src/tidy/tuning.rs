//! Constants of behaviour stand in the `tuning.rs` of their room, where each says what turning it does.

use super::lexer::{self, Kind};
use super::rooms::is_test;
use super::{Finding, Repo};

/// Crates whose constants of behaviour have such a home.
const CRATES: &[&str] = &["sinew_physics"];

/// Numbers that are none of behaviour: bounds of rounding, of what can be represented, of a series; a unit; sizes that are only drawn.
/// By file and name; may only shrink.
const OTHERS: &[(&str, &str)] = &[
    ("body/force.rs", "HUGE"),
    ("body/force.rs", "MOST"),
    ("body/force.rs", "SCALE"),
    ("body/mod.rs", "SMALLEST_MOMENT"),
    ("contact/proxies.rs", "BLUR"),
    ("contact/proxies.rs", "SLACK"),
    ("contact/recycled.rs", "ON_FACE"),
    ("field/mutual.rs", "ASTRONOMICAL"),
    ("mover/planes.rs", "FORGIVEN"),
    ("mover/planes.rs", "FORGIVEN_LENGTH"),
    ("mover/planes.rs", "PARALLEL"),
    ("mover/planes.rs", "UP"),
    ("mover/segment.rs", "ALONG_FACE"),
    ("mover/segment.rs", "NEARER"),
    ("mover/sweep.rs", "ALONG"),
    ("particles/contact.rs", "IMPACT_DEPTH"),
    ("particles/contact.rs", "NO_SPEED"),
    ("particles/impact.rs", "ROUNDING"),
    ("particles/sweep.rs", "SUNK"),
    ("query/candidates.rs", "FARTHEST"),
    ("query/candidates.rs", "SHORTEST"),
    ("solver/contact_rows/row.rs", "NEVER"),
    ("solver/contacts/geometry.rs", "FAR"),
    ("solver/motion/turn.rs", "MOST_SERIES"),
    ("solver/motion/turn.rs", "OF_HUGE"),
    ("world/draw.rs", "PLANE_SIZE"),
];

/// Every float constant is in a `tuning.rs` or listed, and every constant in a `tuning.rs` says where it is to be seen.
pub fn check(repo: &Repo) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut needed = vec![false; OTHERS.len()];
    let files =
        repo.rust_files().filter(|file| file.crate_of_source().is_some_and(|name| CRATES.contains(&name)));
    for file in files.filter(|file| !is_test(file, repo)) {
        let inside = file.path.splitn(4, '/').nth(3).unwrap_or_default();
        let is_home = inside.ends_with("/tuning.rs");
        let tokens = file.tokens_without_tests();
        for at in lexer::find(&tokens, "const")
            .filter(|&at| tokens.get(at + 1).is_some_and(|next| next.kind == Kind::Word))
        {
            let (name, line) = (tokens[at + 1].text, tokens[at].line);
            if is_home {
                let explained = file.text.lines().take(line - 1).collect::<Vec<_>>();
                let docs = explained.iter().rev().take_while(|line| line.starts_with("///"));
                let text: String = docs.copied().collect();
                // Its own scene or test, or the constant that it goes with.
                if !["hown by", "No scene", "[`"].iter().any(|told| text.contains(told)) {
                    let message = format!("`{name}` does not say where it is to be seen");
                    findings.push(Finding::new(&file.path, line, message));
                }
                continue;
            }
            let is_float = tokens.get(at + 2).is_some_and(|mark| mark.text == ":")
                && tokens.get(at + 3).is_some_and(|kind| matches!(kind.text, "f32" | "f64"));
            if !is_float {
                continue;
            }
            match OTHERS.iter().position(|&other| other == (inside, name)) {
                Some(other) => needed[other] = true,
                None => {
                    let message = format!(
                        "`{name}` belongs into a `tuning.rs`, with unit, reason and consequences; or it is none of behaviour: see xtask/src/tidy/tuning.rs"
                    );
                    findings.push(Finding::new(&file.path, line, message));
                }
            }
        }
    }
    let is_planted = repo.file("crates/sinew_physics/src/lib.rs").is_none();
    let gone = OTHERS.iter().zip(needed).filter(|(_, needed)| !needed && !is_planted);
    findings.extend(gone.map(|((file, name), _)| {
        Finding::new(
            "xtask/src/tidy/tuning.rs",
            1,
            format!("`{name}` of {file} is gone: remove it from the list"),
        )
    }));
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(file: &str, text: &str) -> Vec<usize> {
        let path = format!("crates/sinew_physics/src/{file}");
        check(&Repo::planted(&[(&path, text)])).iter().map(|finding| finding.line).collect()
    }

    #[test]
    fn a_planted_stray_is_found() {
        let stray = "const COUNT: usize = 3;\nconst SLOW: f32 = 0.5;\nfn f() { const FAST: f64 = 2.0; }\nconst fn g() {}";
        assert_eq!(lines("step/sleep.rs", stray), [2, 3]);
        assert!(lines("world/draw.rs", "const PLANE_SIZE: f32 = 10.0;").is_empty());
        assert!(lines("step/sleep.rs", "#[cfg(test)]\nmod tests { const SLOW: f32 = 0.5; }").is_empty());
    }

    #[test]
    fn a_constant_says_where_it_is_to_be_seen() {
        assert_eq!(lines("step/tuning.rs", "/// Speed, m/s.\npub const SLOW: f32 = 0.5;"), [2]);
        let told = "/// Speed, m/s.\n///\n/// Larger: it sleeps. Shown by `coin`.\npub const SLOW: f32 = 0.5;\n\n/// Spin, rad/s.\n///\n/// As [`SLOW`].\nconst SPIN: f32 = 1.0;";
        assert!(lines("step/tuning.rs", told).is_empty());
    }
}
