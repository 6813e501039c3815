//! Constants that tune behaviour are in a file `tuning.rs` of their module, where each states the effect of a change.

use super::lexer::{self, Kind};
use super::rooms::is_test;
use super::{Finding, Repo};

/// Crates whose constants of behaviour are in such files.
const CRATES: &[&str] = &["sinew_physics", "sinew_anim", "sinew_ragdoll"];

/// Constants that do not tune behaviour, by file and name: bounds of rounding, of representable values and of series,
/// units, sizes in drawings, anatomical tables, the specified drop test, the verdict's thresholds. Entries may only be
/// removed.
const OTHERS: &[(&str, &str)] = &[
    ("sinew_anim/src/animator/advance.rs", "SHORTEST"),
    ("sinew_anim/src/animator/fire.rs", "MOMENT"),
    ("sinew_anim/src/built/code.rs", "HALF"),
    ("sinew_anim/src/built/code.rs", "ROTATION_BOUND"),
    ("sinew_anim/src/built/code.rs", "STEP"),
    ("sinew_anim/src/built/cursor.rs", "FOREVER"),
    ("sinew_anim/src/clip/root_motion.rs", "TURN"),
    ("sinew_anim/src/roles/units.rs", "GRAVITY"),
    ("sinew_anim/src/roles/units.rs", "HEAD"),
    ("sinew_physics/src/body/force.rs", "HUGE"),
    ("sinew_physics/src/body/force.rs", "MOST"),
    ("sinew_physics/src/body/force.rs", "SCALE"),
    ("sinew_physics/src/body/mod.rs", "SMALLEST_MOMENT"),
    ("sinew_physics/src/contact/proxies/motion.rs", "BLUR"),
    ("sinew_physics/src/contact/proxies/motion.rs", "SLACK"),
    ("sinew_physics/src/contact/recycled.rs", "ON_FACE"),
    ("sinew_physics/src/contact/seams.rs", "AS_FOUND"),
    ("sinew_physics/src/field/mutual.rs", "ASTRONOMICAL"),
    ("sinew_physics/src/mover/planes.rs", "FORGIVEN"),
    ("sinew_physics/src/mover/planes.rs", "FORGIVEN_LENGTH"),
    ("sinew_physics/src/mover/planes.rs", "PARALLEL"),
    ("sinew_physics/src/mover/planes.rs", "UP"),
    ("sinew_physics/src/mover/segment.rs", "ALONG_FACE"),
    ("sinew_physics/src/mover/segment.rs", "NEARER"),
    ("sinew_physics/src/mover/sweep.rs", "ALONG"),
    ("sinew_physics/src/particles/contact.rs", "IMPACT_DEPTH"),
    ("sinew_physics/src/particles/system.rs", "MERIT_ROUNDING"),
    ("sinew_physics/src/particles/sweep.rs", "SUNK"),
    ("sinew_physics/src/query/candidates.rs", "FARTHEST"),
    ("sinew_physics/src/query/candidates.rs", "SHORTEST"),
    ("sinew_physics/src/solver/contact_rows/row.rs", "NEVER"),
    ("sinew_physics/src/solver/contacts/geometry.rs", "FAR"),
    ("sinew_physics/src/solver/motion/turn.rs", "MOST_SERIES"),
    ("sinew_physics/src/solver/motion/turn.rs", "OF_HUGE"),
    ("sinew_physics/src/world/draw.rs", "PLANE_SIZE"),
    ("sinew_ragdoll/src/bake/keys.rs", "ROUNDING"),
    ("sinew_ragdoll/src/doctor/exam.rs", "STEP"),
    ("sinew_ragdoll/src/doctor/mirror.rs", "STEP"),
    ("sinew_ragdoll/src/drive/torque.rs", "HEAD"),
    ("sinew_ragdoll/src/drive/torque.rs", "REFERENCE"),
    ("sinew_ragdoll/src/masses/de_leva.rs", "GIRDLE_OF_UPPER_TRUNK"),
    ("sinew_ragdoll/src/masses/de_leva.rs", "NECK_OF_HEAD"),
    ("sinew_ragdoll/src/masses/de_leva.rs", "TOES_OF_FOOT"),
    ("sinew_ragdoll/src/quality/drop_test.rs", "DROP_SECONDS"),
    ("sinew_ragdoll/src/quality/drop_test.rs", "HEIGHT"),
    ("sinew_ragdoll/src/quality/drop_test.rs", "IN_THE_AIR"),
    ("sinew_ragdoll/src/quality/drop_test.rs", "WALL_SECONDS"),
    ("sinew_ragdoll/src/quality/drop_test.rs", "WALL_SPEED"),
    ("sinew_ragdoll/src/quality/gate.rs", "POSE_SHARE"),
    ("sinew_ragdoll/src/quality/gate.rs", "SECONDS"),
    ("sinew_ragdoll/src/quality/meter.rs", "CALM"),
    ("sinew_ragdoll/src/skin/judge.rs", "AIRBORNE"),
    ("sinew_ragdoll/src/skin/judge.rs", "ASYMMETRY"),
    ("sinew_ragdoll/src/skin/judge.rs", "COVERED"),
    ("sinew_ragdoll/src/skin/judge.rs", "HEIGHT"),
    ("sinew_ragdoll/src/skin/judge.rs", "LEAST_OFF"),
    ("sinew_ragdoll/src/skin/judge.rs", "RAISED"),
    ("sinew_ragdoll/src/skin/judge.rs", "SUNK"),
];

/// Checks that every float constant is in a `tuning.rs` or listed, and that every constant in a `tuning.rs` names a
/// scene or test.
pub fn check(repo: &Repo) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut needed = vec![false; OTHERS.len()];
    let files =
        repo.rust_files().filter(|file| file.crate_of_source().is_some_and(|name| CRATES.contains(&name)));
    for file in files.filter(|file| !is_test(file, repo)) {
        let inside = file.path.strip_prefix("crates/").unwrap_or_default();
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
                // A constant needs its own scene or test, or the constant that it follows.
                if !["hown by", "No scene", "[`"].iter().any(|told| text.contains(told)) {
                    let message = format!("`{name}` does not name the scene or test that shows it");
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
                        "`{name}` belongs in a `tuning.rs`, with unit, reason and consequences; if it is another kind of number, list it in xtask/src/tidy/tuning.rs"
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
            format!("`{name}` of {file} no longer exists: remove it from the list"),
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
    fn a_constant_names_its_scene_or_test() {
        assert_eq!(lines("step/tuning.rs", "/// Speed, m/s.\npub const SLOW: f32 = 0.5;"), [2]);
        let told = "/// Speed, m/s.\n///\n/// Larger: it sleeps. Shown by `coin`.\npub const SLOW: f32 = 0.5;\n\n/// Spin, rad/s.\n///\n/// As [`SLOW`].\nconst SPIN: f32 = 1.0;";
        assert!(lines("step/tuning.rs", told).is_empty());
    }
}
