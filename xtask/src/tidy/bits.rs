//! Keeps arithmetic whose bits differ between targets out of the code that decides the state
//! (docs/adr/0006-glam-and-bits.md has the measurements).
//!
//! The rule does not know types, so it is stricter than needed for shared names: `.max(x)` on integers must be
//! recognisable, by its argument (`.max(1)`, `.min(list.len())`) or by a path (`usize::max(a, b)`). It misses
//! methods that a macro defines, or that another crate calls.

use super::lexer::{self, Kind, Token};
use super::{File, Finding, Repo};

/// Crates whose results must have the same bits everywhere.
const EXACT: &[&str] = &[
    "sinew_math",
    "sinew_geometry",
    "sinew_physics",
    "sinew_anim",
    "sinew_ragdoll",
    "sinew_scenes",
    "sinew_picture",
];

/// glam types with a SIMD layout: their sums are ordered differently on each target.
const TYPES: &[&str] = &["Quat", "Vec3A", "Vec4", "Mat4", "Mat3A", "Affine3A", "Affine2"];

/// Files that convert from and to `glam::Quat`.
const CONVERSIONS: &str = "crates/sinew_math/src/rotations/rotation.rs";

/// Methods of floats and of glam vectors that use more than `+ − × ÷ √`, or are contracted on some targets.
const METHODS: &[(&str, &str)] = &[
    ("sin", TRIGONOMETRY),
    ("cos", TRIGONOMETRY),
    ("tan", TRIGONOMETRY),
    ("sin_cos", TRIGONOMETRY),
    ("asin", TRIGONOMETRY),
    ("acos", TRIGONOMETRY),
    ("atan", TRIGONOMETRY),
    ("atan2", TRIGONOMETRY),
    ("sinh", TRIGONOMETRY),
    ("cosh", TRIGONOMETRY),
    ("tanh", TRIGONOMETRY),
    ("exp", TRIGONOMETRY),
    ("exp2", TRIGONOMETRY),
    ("exp_m1", TRIGONOMETRY),
    ("ln", TRIGONOMETRY),
    ("ln_1p", TRIGONOMETRY),
    ("log", TRIGONOMETRY),
    ("log2", TRIGONOMETRY),
    ("log10", TRIGONOMETRY),
    ("cbrt", TRIGONOMETRY),
    ("powf", TRIGONOMETRY),
    ("powi", "multiply"),
    ("hypot", "write the square root"),
    ("mul_add", "write a * b + c"),
    ("angle_between", ROTATION),
    ("rotate_x", ROTATION),
    ("rotate_y", ROTATION),
    ("rotate_z", ROTATION),
    ("rotate_axis", ROTATION),
    ("rotate_towards", ROTATION),
    ("min_element", SELECTION),
    ("max_element", SELECTION),
    ("saturate", SELECTION),
];

const TRIGONOMETRY: &str = "use sinew_math::trig";
const ROTATION: &str = "use sinew_math::Rotation";
const SELECTION: &str = "use sinew_math::{min, max, clamp} (min3, max3 for vectors)";

/// Methods that integers, iterators and orderings share with floats.
const SHARED: &[&str] = &["min", "max", "clamp"];

/// Allowed after `Vec3::`, `Mat3::` and `Vec2::`.
const CONSTRUCTORS: &[&str] = &[
    "new",
    "splat",
    "from",
    "from_array",
    "from_slice",
    "from_cols",
    "from_cols_array",
    "from_cols_array_2d",
    "from_cols_slice",
    "from_diagonal",
    "default",
    "ZERO",
    "ONE",
    "NEG_ONE",
    "IDENTITY",
    "X",
    "Y",
    "Z",
    "NEG_X",
    "NEG_Y",
    "NEG_Z",
    "AXES",
    "MIN",
    "MAX",
    "NAN",
    "INFINITY",
    "NEG_INFINITY",
    "to_array",
    "dot",
    "cross",
    "length",
    "length_squared",
    "distance",
    "distance_squared",
    "normalize",
    "lerp",
    "abs",
    "is_finite",
    "is_nan",
    "transpose",
    "inverse",
    "determinant",
    "mul_vec3",
];

/// Checks that the code of exact crates uses exact arithmetic.
pub fn check(repo: &Repo) -> Vec<Finding> {
    let is_exact = |file: &&File| file.crate_of_source().is_some_and(|name| EXACT.contains(&name));
    repo.rust_files().filter(is_exact).flat_map(check_file).collect()
}

fn check_file(file: &File) -> Vec<Finding> {
    let tokens = file.tokens_without_tests();
    let mut findings = Vec::new();
    for at in 0..tokens.len() {
        if let Some(message) = forbidden(&tokens, at, file.path == CONVERSIONS) {
            findings.push(Finding::new(&file.path, tokens[at].line, message));
        }
    }
    findings
}

fn forbidden(tokens: &[Token<'_>], at: usize, converts: bool) -> Option<String> {
    let name = tokens[at].text;
    if tokens[at].kind != Kind::Word {
        return None;
    }
    if TYPES.contains(&name) && !(converts && name == "Quat") {
        return Some(format!("`{name}`: its bits differ between targets; use sinew_math"));
    }
    let text =
        |index: Option<usize>| index.and_then(|index| tokens.get(index)).map_or("", |token| token.text);
    let before = text(at.checked_sub(1));
    let owner = text(at.checked_sub(2));
    let is_call = text(Some(at + 1)) == "(";
    if before == "::" && matches!(owner, "Vec3" | "Mat3" | "Vec2") {
        let allowed = CONSTRUCTORS.contains(&name);
        return (!allowed).then(|| format!("`{owner}::{name}` is not on the list of exact methods"));
    }
    let of_floats = before == "::" && matches!(owner, "f32" | "f64");
    if of_floats || (before == "." && is_call) {
        if let Some((_, instead)) = METHODS.iter().find(|&&(method, _)| method == name) {
            return Some(format!("`{name}`: its bits differ between targets; {instead}"));
        }
        if SHARED.contains(&name) && (of_floats || !is_of_integers(tokens, at + 1)) {
            return Some(format!(
                "`{name}`: NaN and −0 differ between targets; {SELECTION}; integers say `u32::{name}(a, b)`"
            ));
        }
    }
    None
}

/// Returns true if the arguments in the bracket at `open` show that the call is on integers or on an iterator.
fn is_of_integers(tokens: &[Token<'_>], open: usize) -> bool {
    let arguments = &tokens[open + 1..lexer::closing(tokens, open)];
    let is_integer = |token: &Token<'_>| match token.kind {
        Kind::Number => !token.text.contains('.') && !token.text.ends_with("f32"),
        Kind::Word => matches!(token.text, "len" | "usize" | "u8" | "u16" | "u32" | "u64" | "i32" | "i64"),
        _ => false,
    };
    let mentions_floats = arguments.iter().any(|token| matches!(token.text, "f32" | "f64"));
    arguments.is_empty() || (!mentions_floats && arguments.iter().any(is_integer))
}

#[cfg(test)]
mod tests {
    use super::super::tests::check_lines;
    use super::*;

    const FILE: &str = "crates/sinew_physics/src/solve.rs";

    #[test]
    fn planted_violations_are_found() {
        check_lines(check, FILE, "use glam::Quat;\nfn f(m: Mat4) {}", &[1, 2]);
        check_lines(check, FILE, "let a = x.sin();\nlet b = f32::atan2(y, x);", &[1, 2]);
        check_lines(check, FILE, "let a = x\n    .mul_add(y, z);", &[2]);
        check_lines(check, FILE, "let r = Mat3::from_rotation_x(a);\nlet s = v.slerp(w, 0.5);", &[1]);
        check_lines(check, FILE, "list.fold(f32::MAX, f32::min)", &[1]);
        check_lines(
            check,
            FILE,
            "let a = x.max(0.0);\nlet b = x.clamp(lo, hi);\nlet c = v.min(w);",
            &[1, 2, 3],
        );
        check_lines(check, FILE, "let angle = a.angle_between(b);\nlet x = v.min_element();", &[1, 2]);
        check_lines(check, FILE, "let a = x.powi(2) + x.powf(0.5) + x.hypot(y) + x.exp() + x.ln();", &[1; 5]);
        check_lines(check, FILE, "let c = Vec3::max(a, b);", &[1]);
    }

    #[test]
    fn exact_arithmetic_passes() {
        check_lines(check, FILE, "let (sin, cos) = trig::sin_cos(a); let x = sinew_math::max(a, b);", &[]);
        check_lines(
            check,
            FILE,
            "let n = list.len().max(1).min(list.len() - 1); let m = list.iter().max();",
            &[],
        );
        check_lines(check, FILE, "let v = Vec3::new(1.0, 0.0, 0.0).normalize() + Vec3::X; // x.sin()", &[]);
        check_lines(
            check,
            FILE,
            "let l = usize::max(a, b); let s = x.sqrt().abs(); let t = a.slerp(b, t);",
            &[],
        );
        check_lines(check, FILE, "#[cfg(test)]\nmod tests { fn f(x: f64) -> f64 { x.sin() } }", &[]);
        check_lines(check, CONVERSIONS, "impl From<glam::Quat> for Rotation {}", &[]);
        check_lines(check, "crates/sinew_cli/src/main.rs", "let a = x.sin();", &[]);
    }
}
