//! `sinew ragdoll doctor`, and definitions of ragdolls read by the commands.

use crate::contract::check_keys;
use crate::sinew::{Folder, glb, gltf_files, shared_data, sinew};
use needs_data::needs_data;
use serde_json::Value;
use sinew::formats::{read_ragdoll, write_ragdoll};
use sinew::physics::JointKind;
use sinew::ragdoll::RagdollDef;
use sinew_scenes::mannequin::mannequin;

/// Writes the mannequin's definition by `ragdoll build`; returns its path and the definition.
fn built(folder: &Folder) -> (String, RagdollDef) {
    let (file, out) = (folder.mannequin(), folder.path("mannequin.sinew.json"));
    let run = sinew(&["ragdoll", "build", &file, "-o", &out]);
    assert_eq!(run.code, Some(0), "{run:?}");
    let def = read_ragdoll(&std::fs::read(&out).expect("a definition")).expect("ours");
    (out, def)
}

fn codes(object: &Value) -> Vec<&str> {
    let findings = object["findings"].as_array().expect("findings");
    findings.iter().map(|finding| finding["code"].as_str().expect("a code")).collect()
}

#[test]
fn doctor_finds_and_repairs_without_changing_the_input() {
    let folder = Folder::new("doctor");
    let (healthy, mut def) = built(&folder);
    let object = sinew(&["ragdoll", "doctor", &healthy, "--json"]).json();
    assert_eq!(codes(&object), [""; 0], "{object:#}");
    let neck = def.bodies.iter().position(|body| body.role == "neck").expect("a neck");
    def.joints[neck - 1].kind = JointKind::Ball { limit: None };
    let ill = folder.file("ill.sinew.json", write_ragdoll(&def));
    let before = std::fs::read(&ill).expect("the file");
    let object = sinew(&["ragdoll", "doctor", &ill, "--json"]).json();
    check_keys("ragdoll doctor", &object);
    assert_eq!(codes(&object), ["limits-missing"]);
    assert_eq!(object["findings"][0]["bone"], "neck");
    let mended = folder.path("mended.sinew.json");
    let object = sinew(&["ragdoll", "doctor", &ill, "--fix", "-o", &mended, "--json"]).json();
    assert_eq!(
        (&object["findings"][0]["fixed"], &object["outputs"][0]),
        (&true.into(), &mended.as_str().into())
    );
    assert_eq!(codes(&sinew(&["ragdoll", "doctor", &mended, "--json"]).json()), [""; 0]);
    assert_eq!(std::fs::read(&ill).expect("the file"), before);
    let line = sinew(&["ragdoll", "doctor", &ill, "--fix", "-o", &ill]).refusal(2).to_owned();
    assert!(line.ends_with("is an input: write to another file"), "{line}");
}

#[test]
fn missing_head_is_restored_from_the_rig() {
    let folder = Folder::new("head");
    let (_, mut def) = built(&folder);
    let head = def.bodies.iter().position(|body| body.role == "head").expect("a head");
    // Later bodies move up by one index.
    def.bodies.remove(head);
    def.joints.remove(head - 1);
    for joint in &mut def.joints {
        joint.parent -= usize::from(joint.parent > head);
        joint.child -= usize::from(joint.child > head);
    }
    def.disabled_pairs.retain(|&(a, b)| a != head && b != head);
    for (a, b) in &mut def.disabled_pairs {
        *a -= usize::from(*a > head);
        *b -= usize::from(*b > head);
    }
    let ill = folder.file("headless.sinew.json", write_ragdoll(&def));
    let (rig, mended) = (folder.path("mannequin.glb"), folder.path("mended.sinew.json"));
    let run = sinew(&["ragdoll", "doctor", &ill, "--rig", &rig, "--fix", "-o", &mended, "--json"]);
    let object = run.json();
    assert_eq!(codes(&object), ["head-without-body"]);
    assert_eq!(object["findings"][0]["fixed"], true);
    let mended = read_ragdoll(&std::fs::read(&mended).expect("written")).expect("ours");
    assert!(mended.bodies.iter().any(|body| body.role == "head"));
}

/// A build from a good rig has no errors.
#[needs_data]
#[test]
fn foreign_rigs_have_no_errors() {
    let data = shared_data();
    for file in gltf_files(&data.join("rigs")) {
        let run = sinew(&["ragdoll", "doctor", &file, "--json"]);
        if run.code == Some(1) {
            assert!(run.refusal(1).ends_with("no skin: nothing to build a ragdoll from"), "{file}: {run:?}");
            continue;
        }
        let object = run.json();
        let findings = object["findings"].as_array().expect("findings");
        assert!(findings.iter().all(|finding| finding["severity"] != "error"), "{file}: {object:#}");
    }
}

/// The fish's skin extends far beyond its bodies and sinks into the floor: the finding names the bone and a remedy.
#[needs_data]
#[test]
fn skin_in_the_floor_is_reported() {
    let data = shared_data();
    let file = data.join("rigs/quaternius_MandarinFish.glb").display().to_string();
    let object = sinew(&["ragdoll", "doctor", &file, "--json"]).json();
    check_keys("ragdoll doctor", &object);
    let findings = object["findings"].as_array().expect("findings");
    let found =
        findings.iter().find(|finding| finding["code"] == "skin-off-floor").expect("the finding is reported");
    assert_eq!((&found["bone"], &found["fixed"]), (&"Main1".into(), &false.into()));
    let built = sinew(&["ragdoll", "build", &file, "--json"]).json();
    assert_eq!(built["quality"]["verdict"], "usable");
    let reasons = built["quality"]["reasons"].as_array().expect("reasons");
    assert!(reasons.iter().any(|reason| reason.as_str().is_some_and(|r| r.starts_with("skin: at rest"))));
}

#[needs_data]
#[test]
fn foreign_models_are_examined() {
    let data = shared_data();
    for name in ["mujoco_humanoid.xml", "bullet_humanoid.urdf"] {
        let file = data.join("robots").join(name).display().to_string();
        let object = sinew(&["ragdoll", "doctor", &file, "--json"]).json();
        let findings = object["findings"].as_array().expect("findings");
        assert!(findings.iter().all(|f| f["severity"] != "error"), "{name}: {object:#}");
    }
    // The model's joints are spherical, and the file gives them no range.
    let urdf = data.join("robots/bullet_humanoid.urdf").display().to_string();
    let object = sinew(&["ragdoll", "doctor", &urdf, "--json"]).json();
    assert!(codes(&object).contains(&"limits-missing"), "{object:#}");
}

/// Defects in another author's model are reported.
#[needs_data]
#[test]
fn defects_in_foreign_models_are_reported() {
    let data = shared_data();
    let folder = Folder::new("models");
    let text = std::fs::read_to_string(data.join("robots/mujoco_humanoid.xml")).expect("the model");
    for (from, to, code) in [
        (r#"range="-160 2""#, r#"range="-90 90""#, "bends-both-ways"),
        (r#"range="-160 2""#, r#"range="-180 180""#, "limits-missing"),
        (r#"stiffness="10""#, r#"stiffness="100000""#, "stiffness-above-nyquist"),
        (
            r#"<geom name="head" type="sphere" size=".09""#,
            r#"<geom name="head" type="sphere" mass="3" size=".4""#,
            "overlap-at-start",
        ),
    ] {
        assert!(text.contains(from), "{from}");
        let file = folder.file("model.xml", text.replace(from, to));
        let object = sinew(&["ragdoll", "doctor", &file, "--json"]).json();
        let mut found = codes(&object);
        found.dedup();
        assert_eq!(found, [code], "{from} {to}: {object:#}");
    }
}

#[test]
fn files_without_a_ragdoll_are_rejected_with_one_line() {
    let folder = Folder::new("doctor-refusals");
    for (name, text, reason) in [
        (
            "world.json",
            r#"{"sinew":"world","version":1,"bodies":[]}"#,
            "this is a `world` file, not a `ragdoll`",
        ),
        ("later.json", r#"{"sinew":"ragdoll","version":9}"#, "version 9 is newer than 1"),
        ("half.json", r#"{"sinew":"ragdoll","version":1,"bod"#, "not JSON"),
        (
            "empty.json",
            r#"{"sinew":"ragdoll","version":1,"total_mass":1,"height":1,"unit_scale":1,"up_axis":[0,1,0],"bodies":[]}"#,
            "at least one body",
        ),
        ("nan.json", r#"{"sinew":"ragdoll","version":1,"total_mass":NaN}"#, "not JSON"),
        ("large.json", r#"{"sinew":"ragdoll","version":1,"total_mass":1e99,"bodies":[]}"#, "(bodies)"),
        ("other.xml", "<svg/>", "not an MJCF file"),
        ("robot.xml", "<robot/>", "at least one link"),
        ("still.xml", "<mujoco><worldbody/></mujoco>", "no body moves"),
    ] {
        let file = folder.file(name, text);
        let run = sinew(&["ragdoll", "doctor", &file]);
        let line = run.refusal(1);
        assert!(line.starts_with(&format!("error: {file}: ")) && line.contains(reason), "{line}");
    }
}

#[test]
fn settings_beside_the_character_are_applied() {
    let folder = Folder::new("settings");
    let file = folder.mannequin();
    let build = |more: &[&str]| sinew(&[&["ragdoll", "build", &file, "--json"], more].concat());
    let mass = |object: &Value| object["total_mass_kg"].as_f64().expect("a mass");
    let plain = build(&[]).json();
    let text = r#"{"sinew":"ragdoll-settings","version":1,"mass":90,"bones":{"head":{"shape":"sphere"}}}"#;
    folder.file("mannequin.ragdoll.json", text);
    let settled = build(&[]).json();
    assert!((mass(&settled) - 90.0).abs() < 1e-3 && (mass(&plain) - 90.0).abs() > 1.0);
    let bodies = settled["bodies"].as_array().expect("bodies");
    let head = bodies.iter().find(|body| body["role"] == "head").expect("a head");
    assert_eq!(head["shape"], "sphere");
    assert!(settled["notes"][0].as_str().is_some_and(|note| note.starts_with("with the settings of ")));
    // The command line has priority.
    assert!((mass(&build(&["--mass", "50"]).json()) - 50.0).abs() < 1e-3);
    let (settings, _) = (folder.path("mannequin.ragdoll.json"), built(&folder));
    let definition = folder.path("mannequin.sinew.json");
    let run = sinew(&["ragdoll", "doctor", &definition, "--settings", &settings]);
    assert!(run.refusal(2).ends_with("name a character, not a definition or a model"), "{run:?}");
    let wrong = folder.file("wrong.json", text.replace("head", "haed"));
    let run = build(&["--settings", &wrong]);
    let line = run.refusal(1);
    assert!(line.contains("wrong.json: no bone or role `haed`; the nearest of "), "{line}");
    assert!(line.contains(" are head, ") && line.ends_with(" (bones.haed)"), "{line}");
}

#[test]
fn edited_definition_is_used_by_bake() {
    let folder = Folder::new("edited");
    let (path, mut def) = built(&folder);
    let (rig, out) = (folder.path("mannequin.glb"), folder.path("fall.glb"));
    let bake =
        |ragdoll: &str| sinew(&["bake", &rig, "--ragdoll", ragdoll, "--seconds", "2", "-o", &out, "--json"]);
    let hash = |run: crate::sinew::Run| run.json()["hash"].clone();
    let unedited = hash(bake(&path));
    assert_eq!(unedited, hash(sinew(&["bake", &rig, "--seconds", "2", "-o", &out, "--json"])));
    for joint in &mut def.joints {
        joint.kind = JointKind::Fixed;
    }
    let stiff = folder.file("stiff.sinew.json", write_ragdoll(&def));
    assert_ne!(unedited, hash(bake(&stiff)));
    def.bodies[3].bone = "elsewhere".into();
    let other = folder.file("other.sinew.json", write_ragdoll(&def));
    let run = bake(&other);
    let line = run.refusal(1);
    assert!(line.contains("bone `elsewhere` is not in this rig") && line.ends_with("(bodies[3])"), "{line}");
}

/// Definitions with wrong numbers: a command either works or fails with one line.
#[test]
fn wrong_numbers_give_results_or_errors() {
    let folder = Folder::new("lies");
    let (path, _) = built(&folder);
    let text = std::fs::read_to_string(&path).expect("a definition");
    let rig = folder.path("mannequin.glb");
    let mut random = sinew::math::Random::new(9);
    let numbers: Vec<(usize, usize)> = {
        let is_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | 'e');
        let mut found = Vec::new();
        let mut start = None;
        for (at, c) in text.char_indices() {
            match (start, is_number(c)) {
                (None, true) if text[..at].ends_with([' ', '[']) => start = Some(at),
                (Some(from), false) => {
                    found.push((from, at));
                    start = None;
                }
                _ => {}
            }
        }
        found
    };
    assert!(numbers.len() > 200, "{} numbers", numbers.len());
    let cases = if std::env::var_os("SINEW_FULL").is_some() { 300 } else { 12 };
    for _ in 0..cases {
        let (from, to) = numbers[random.index(numbers.len())];
        let lie = ["0", "-1", "1e-30", "1e30", "3e38", "-7.5", "1e6", "179.9"][random.index(8)];
        let file = folder.file("lie.sinew.json", format!("{}{lie}{}", &text[..from], &text[to..]));
        let (out, fall) = (folder.path("out.sinew.json"), folder.path("out.glb"));
        let commands: [&[&str]; 3] = [
            &["ragdoll", "doctor", &file, "--fix", "-o", &out],
            &["bake", &rig, "--ragdoll", &file, "--seconds", "1", "-o", &fall],
            &["ragdoll", "export", &file, "--as", "mjcf"],
        ];
        for arguments in commands {
            let run = sinew(arguments);
            if run.code != Some(0) {
                assert!(run.refusal(1).starts_with(&format!("error: {file}: ")), "{lie} at {from}: {run:?}");
            }
        }
    }
}

/// Single falls of a gate can be repeated by number, and threads change nothing.
#[test]
fn gate_falls_can_be_repeated_by_number() {
    let folder = Folder::new("gate");
    let file = folder.mannequin();
    let gate = |more: &[&str]| {
        let run = sinew(&[&["ragdoll", "build", &file, "--json"], more].concat());
        run.json()["quality"]["gate"].clone()
    };
    let whole = gate(&["--gate", "3"]);
    assert_eq!(gate(&["--gate", "3", "--threads", "2"]), whole);
    let parts: Vec<Value> =
        ["0", "1", "2"].iter().map(|from| gate(&["--gate", "1", "--gate-from", from])).collect();
    let deepest = |gate: &Value| gate["worst"]["penetration_max_m"].as_f64().expect("a number");
    assert_eq!(parts.iter().map(deepest).fold(0.0, f64::max), deepest(&whole));
    assert!(parts.iter().any(|part| deepest(part) != deepest(&whole)), "the falls differ");
    assert_eq!(sinew(&["ragdoll", "build", &file, "--gate-from", "7"]).code, Some(2));
}

/// Limits are learned from the file's clips if the command line or the settings ask for it; a file without clips is
/// rejected with one line.
#[test]
fn limits_can_be_learned_from_clips() {
    let folder = Folder::new("limits");
    let file = folder.mannequin();
    let build = |more: &[&str]| sinew(&[&["ragdoll", "build", &file, "--json"], more].concat()).json();
    let from = |object: &Value| -> Vec<String> {
        let joints = object["joints"].as_array().expect("joints");
        joints.iter().map(|joint| joint["limits_from"].as_str().expect("a word").to_owned()).collect()
    };
    let (table, learned) = (build(&[]), build(&["--limits", "clips"]));
    check_keys("ragdoll build", &learned);
    assert!(from(&table).iter().all(|from| from == "anatomy"));
    let moved = from(&learned).iter().filter(|from| *from == "clips").count();
    assert!(2 * moved > from(&learned).len(), "a walk must move most joints: {:?}", from(&learned));
    let settings = r#"{"sinew":"ragdoll-settings","version":1,"limits":"clips"}"#;
    let settings = folder.file("slow.ragdoll.json", settings);
    assert_eq!(build(&["--settings", &settings])["joints"], learned["joints"]);
    let still = folder.file("still.glb", glb(&mannequin().rig, &[]));
    let run = sinew(&["ragdoll", "build", &still, "--limits", "clips"]);
    let line = format!("error: {still}: no clip moves a joint: there are no limits to learn");
    assert_eq!(run.refusal(1), line);
}
