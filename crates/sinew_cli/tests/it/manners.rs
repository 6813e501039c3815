//! Behaviour of the commands in unusual cases: outputs, names, notes, pipes.

use crate::sinew::{Folder, Run, command, glb, shared_data, sinew};
use needs_data::needs_data;
use serde_json::Value;
use sinew::anim::Rig;
use sinew::formats::{MotionOptions, ReadOptions, load_gltf, load_motion, write_world};
use sinew::math::Vec3;
use sinew::physics::{BodyDef, BodyKind, Shape, ShapeDef};
use sinew_scenes::mannequin::mannequin;
use std::fs;

fn notes(object: &Value) -> Vec<String> {
    let notes = object["notes"].as_array().expect("notes");
    notes.iter().map(|note| note.as_str().expect("a sentence").to_owned()).collect()
}

#[test]
fn output_with_unknown_extension_is_rejected_with_the_known_ones() {
    let folder = Folder::new("extensions");
    let file = folder.mannequin();
    let commands: [(&[&str], &str); 9] = [
        (&["bake", &file], ".glb, .vrm or .bvh"),
        (&["ragdoll", "build", &file], ".json"),
        (&["ragdoll", "doctor", &file, "--fix"], ".json"),
        (&["ragdoll", "export", &file, "--as", "khr"], ".glb or .vrm"),
        (&["ragdoll", "export", &file, "--as", "mjcf"], ".xml or .mjcf"),
        (&["boxes", &file], ".json"),
        (&["convert", &file], ".glb or .bvh"),
        (&["events", "detect", &file], ".json"),
        (&["view", "pendulum", "--movie", "x.gif"], ".gif, .png or .webp"),
    ];
    for (command, known) in commands {
        let option = if command[0] == "view" { "--picture" } else { "-o" };
        for name in ["out", "out.zip"] {
            let run = sinew(&[command, &[option, &folder.path(name)]].concat());
            let says = run.stderr.contains(&format!("must end in {known}"));
            assert!(run.code == Some(2) && says && run.stdout.is_empty(), "{command:?} {name}: {run:?}");
        }
    }
    let picture = folder.path("same.gif");
    let run = sinew(&["view", "pendulum", "--picture", &picture, "--movie", &picture, "--seconds", "0.1"]);
    assert!(run.refusal(2).ends_with("is given twice: each output needs its own name"));
    assert_eq!(folder.names(), ["mannequin.glb"]);
}

#[cfg(unix)]
#[test]
fn links_are_followed_and_devices_never_replaced() {
    let folder = Folder::new("links");
    let file = folder.mannequin();
    let (target, link) = (folder.file("target.json", "old"), folder.path("link.json"));
    std::os::unix::fs::symlink("target.json", &link).expect("a link");
    assert_eq!(sinew(&["ragdoll", "build", &file, "-o", &link]).code, Some(0));
    assert!(fs::symlink_metadata(&link).expect("the link").is_symlink());
    assert!(fs::read_to_string(&target).expect("the target can be read").starts_with("{"));
    let device = folder.path("device.json");
    std::os::unix::fs::symlink("/dev/null", &device).expect("a link");
    let run = sinew(&["ragdoll", "build", &file, "-o", &device]);
    assert_eq!(run.refusal(1), format!("error: {device}: cannot write: exists and is not a regular file"));
    // A link to an input counts as that input.
    let own = folder.path("own.glb");
    std::os::unix::fs::symlink("mannequin.glb", &own).expect("a link");
    assert_eq!(sinew(&["bake", &file, "-o", &own]).code, Some(2));
}

#[test]
fn errors_name_the_option_that_helps() {
    let folder = Folder::new("help");
    let bvh = "HIERARCHY\nROOT hips\n{\n OFFSET 0 0 0\n CHANNELS 3 Zrotation Yrotation Xrotation\n End Site\n {\n  OFFSET 0 9 0\n }\n}\n\
        MOTION\nFrames: 3\nFrame Time: 0.05\n0 0 0\n1 1 1\n";
    let short = folder.file("short.bvh", bvh);
    let line = sinew(&["convert", &short, &folder.path("out.glb")]).refusal(1).to_owned();
    assert!(
        line.contains("declares 3 frames, has 2; 'sinew convert --any-rows' accepts the existing ones"),
        "{line}"
    );
    assert_eq!(sinew(&["convert", &short, &folder.path("out.glb"), "--any-rows"]).code, Some(0));
    let mimic = folder.file("run.txt", r#"{"Loop":"wrap","Frames":[[0.1,0,1,0,1,0,0,0]]}"#);
    let line = sinew(&["inspect", &mimic]).refusal(1).to_owned();
    assert!(
        line.contains("its character's file is needed; none beside it, in its folder with .txt, fits"),
        "{line}"
    );
    let rig = mannequin().rig;
    let clips = mannequin().clips;
    let many = folder.file("many.glb", glb(&rig, &clips[..2]));
    let line = sinew(&["convert", &many, &folder.path("many.bvh")]).refusal(1).to_owned();
    assert!(
        line.contains("there are 2 clips, of which a BVH holds one: choose it with --clip NAME, "),
        "{line}"
    );
}

#[test]
fn two_bakes_give_two_clips() {
    let folder = Folder::new("names-of-clips");
    let file = folder.mannequin();
    let bake = |from: &str, to: &str, extra: &[&str]| {
        let to = folder.path(to);
        let run = sinew(&[&["bake", from, "--seconds", "0.2", "--limp-at", "0", "-o", &to], extra].concat());
        (run, to)
    };
    let names = |path: &str| -> Vec<String> {
        let document = load_gltf(path, ReadOptions::default()).expect("the glTF can be read");
        document.clips.into_iter().map(|clip| clip.name).collect()
    };
    let (_, first) = bake(&file, "first.glb", &[]);
    let (_, second) = bake(&first, "second.glb", &["--clip", "Walk"]);
    let (_, third) = bake(&second, "third.glb", &["--clip", "Walk", "--name", "stumbles"]);
    assert_eq!(names(&third), ["Walk", "sinew", "sinew 2", "stumbles"]);
    // A baked clip is not chosen as the motion before the next fall.
    let still = folder.file("still.glb", glb(&mannequin().rig, &[]));
    let (_, once) = bake(&still, "once.glb", &[]);
    let (run, twice) = bake(&once, "twice.glb", &[]);
    assert!(run.stdout.contains("stands in its rest pose"), "{run:?}");
    assert_eq!(names(&twice), ["sinew", "sinew 2"]);
    let (run, _) = bake(&third, "fourth.glb", &["--clip", "Walk", "--name", "stumbles"]);
    assert!(
        run.refusal(1)
            .ends_with("there is a clip 'stumbles' already: give the new one another name (--name)")
    );
}

#[test]
fn steps_that_do_not_happen_are_reported() {
    let folder = Folder::new("said");
    let (file, out) = (folder.mannequin(), folder.path("out.glb"));
    let bake = |extra: &[&str]| sinew(&[&["bake", file.as_str(), "-o", &out], extra].concat());
    let check_output = |extra: &[&str], what: &str| {
        let object = bake(&[extra, &["--json"]].concat()).json();
        let all = notes(&object);
        assert_eq!(all.iter().filter(|note| note.contains(what)).count(), 1, "{what}: {all:?}");
        assert!(bake(extra).stdout.contains("note: "), "the text output has no note");
        all
    };
    let late =
        check_output(&["--seconds", "1", "--limp-at", "2"], "--limp-at 2 s is not before the end, at 1 s");
    assert!(
        late.iter().all(|note| !note.contains("does not get up")),
        "a note about getting up without a fall: {late:?}"
    );
    check_output(
        &["--seconds", "6", "--no-builtin-motions"],
        "it does not get up: it has no get-up clip, and --no-builtin-motions leaves out the built-in ones",
    );
    let empty = folder.file("empty.json", r#"{"sinew":"world","version":1,"bodies":[]}"#);
    let nowhere = bake(&["--seconds", "1", "--world", &empty]);
    assert!(nowhere.refusal(1).contains("no ground to stand on; --at X,Y,Z sets its place"), "{nowhere:?}");
    let nowhere = bake(&["--seconds", "1", "--world", &empty, "--at", "0,0,0"]);
    assert!(nowhere.refusal(1).contains("no ground under the character at 0,0,0; --floor"), "{nowhere:?}");
    let all = check_output(&["--seconds", "1", "--at", "0,9,0"], "it does not get up: it touches nothing");
    assert!(all.iter().any(|note| note.contains("the floor is 9.00 m below the character")), "{all:?}");
    assert!(!all.iter().any(|note| note.contains("it stands at")), "{all:?}");
    let half_extents = Vec3::new(9.0, 0.5, 9.0);
    let low = BodyDef {
        kind: BodyKind::Static,
        position: Vec3::Y * -3.0,
        shapes: vec![ShapeDef::new(Shape::Box { half_extents })],
        ..BodyDef::default()
    };
    let low = folder.file("low.json", write_world(&[low]));
    check_output(
        &["--seconds", "1", "--world", &low, "--at", "0,0,0"],
        "low.json is 2.50 m below the character",
    );
    check_output(&["--seconds", "1", "--world", &low], "it stands at 0.00,-2.50,0.00, the free place");
}

/// The nodes of a file may be in any order; the list is a tree.
#[test]
fn joints_are_listed_as_a_tree() {
    let folder = Folder::new("tree");
    let nodes = r#"[{"name":"hand"},{"name":"arm","children":[0]},{"name":"leg"},{"name":"hips","children":[1,2]},{"name":"foot"}]"#;
    let nodes = nodes.replace(r#"{"name":"leg"}"#, r#"{"name":"leg","children":[4]}"#);
    let file = folder.file(
        "tree.gltf",
        format!(r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[3]}}],"nodes":{nodes}}}"#),
    );
    let object = sinew(&["inspect", &file, "--json"]).json();
    let joints = object["joints"].as_array().expect("joints");
    let names: Vec<&str> = joints.iter().map(|joint| joint["name"].as_str().expect("a name")).collect();
    assert_eq!(names, ["hips", "arm", "hand", "leg", "foot"]);
    for (index, joint) in joints.iter().enumerate() {
        assert!(joint["parent"].as_u64().is_none_or(|parent| (parent as usize) < index), "{joint}");
    }
    let text = sinew(&["inspect", &file]).stdout;
    assert!(text.contains("  hips\n    arm\n      hand\n    leg\n      foot\n"), "{text}");
}

/// For formats that list joints level by level, the list still shows children below their parent.
#[needs_data]
#[test]
fn level_order_joints_are_shown_as_a_tree() {
    let data = shared_data();
    let file = data.join("mocap/deepmimic_humanoid3d.txt").display().to_string();
    let object = sinew(&["inspect", &file, "--json"]).json();
    let joints = object["joints"].as_array().expect("joints");
    let text = sinew(&["inspect", &file]).stdout;
    let (_, list) = text.split_once("\nJoints\n").expect("a list of joints");
    let rows: Vec<(usize, &str)> = list
        .lines()
        .skip(1)
        .take(joints.len())
        .map(|line| {
            (line.len() - line.trim_start().len(), line.split_whitespace().next().unwrap_or_default())
        })
        .collect();
    for (index, &(indent, name)) in rows.iter().enumerate() {
        let above = rows[..index].iter().rev().find(|row| row.0 < indent).map(|row| row.1);
        let joint = joints.iter().find(|joint| joint["name"] == name).expect("the joint is listed");
        let parent = joint["parent"].as_u64().map(|parent| joints[parent as usize]["name"].as_str());
        assert_eq!(parent.flatten(), above, "{name}\n{list}");
    }
}

#[test]
fn roles_state_their_evidence() {
    let folder = Folder::new("rests-on");
    let file = folder.mannequin();
    let object = sinew(&["inspect", &file, "--json"]).json();
    let joints = object["joints"].as_array().expect("joints");
    for joint in joints {
        assert_eq!(joint["role"].is_null(), joint["rests_on"].is_null(), "{joint}");
    }
    assert!(joints.iter().any(|joint| joint["rests_on"] == "shape and name"), "{object:#}");
    let text = sinew(&["inspect", &file]).stdout;
    assert!(text.contains("rests on") && text.contains("shape and name"), "{text}");
}

#[test]
fn every_shape_of_a_body_is_in_the_contract() {
    let contract = include_str!("../../../../docs/contract.md");
    let source = include_str!("../../src/report/ragdoll_report.rs");
    let row = |key: &str| contract.lines().any(|line| line.starts_with(&format!("- `bodies[].{key}` (")));
    let shapes = ["box", "capsule", "sphere", "hull", "tapered_capsule", "cylinder", "cone"];
    let line = contract.lines().find(|line| line.contains("`bodies[].shape`")).expect("a row for shapes");
    for shape in shapes {
        assert!(source.contains(&format!("\"{shape}\"")), "{shape} is not written");
        assert!(line.contains(&format!("`{shape}`")), "{shape} is written");
    }
    let keys = source.split("put(\"").skip(1).filter_map(|rest| rest.split('"').next());
    let missing: Vec<&str> = keys.filter(|key| !row(key)).collect();
    assert!(missing.is_empty(), "no row for {missing:?}");
}

/// A rig with every kind of remark produces each remark once.
#[test]
fn notes_are_not_repeated() {
    let folder = Folder::new("once");
    let twice = |rig: Rig| folder.file("twice.glb", glb(&rig, &[]));
    let file = twice(mannequin().rig);
    let model = folder.path("twice.xml");
    let commands: [&[&str]; 4] = [
        &["ragdoll", "build", &file],
        &["ragdoll", "doctor", &file],
        &["ragdoll", "export", &file, "--as", "mjcf", "-o", &model],
        &["bake", &file, "--seconds", "0.3", "-o", &folder.path("twice.bvh")],
    ];
    for command in commands {
        let mut all = notes(&sinew(&[command, &["--json"]].concat()).json());
        let count = all.len();
        all.sort();
        all.dedup();
        assert_eq!(all.len(), count, "{command:?}: {all:?}");
    }
    let motion = load_motion(&file, &MotionOptions::default()).expect("the motion can be read");
    assert!(motion.notes.is_empty());
}

/// On a full disk the command writes nothing and reports it in one line.
#[cfg(target_os = "linux")]
#[test]
fn unwritable_output_fails_with_one_line() {
    let folder = Folder::new("full-disk");
    let file = folder.mannequin();
    let bad = folder.file("bad.glb", "nothing");
    let commands: [&[&str]; 9] = [
        &["inspect", &file, "--json"],
        &["inspect", &file],
        &["inspect", &bad, "--json"],
        &["run", "pendulum", "--steps", "5"],
        &["scenes"],
        &["scenes", "--json"],
        &["ragdoll", "doctor", &file],
        &["--help"],
        &["--version"],
    ];
    for arguments in commands {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").expect("Linux has it");
        let run = Run::of(command(arguments).stdout(full));
        let last = run.stderr.lines().last().unwrap_or_default();
        let says = last.starts_with("error: standard output: cannot write: No space left");
        assert!(run.code == Some(1) && says, "{arguments:?}: {run:?}");
        assert_eq!(
            run.stderr.lines().count(),
            1 + usize::from(arguments[1..].contains(&bad.as_str())),
            "{run:?}"
        );
    }
}

/// A pipe closed early by its reader is no error.
#[cfg(unix)]
#[test]
fn closed_pipe_is_no_failure() {
    use std::process::Stdio;
    let mut child =
        command(&["scenes", "--json"]).stdout(Stdio::piped()).spawn().expect("the command starts");
    drop(child.stdout.take());
    assert_eq!(child.wait().expect("the command ends").code(), Some(0));
}

#[test]
fn numbers_out_of_range_are_reported_with_the_range() {
    let folder = Folder::new("ranges");
    let (file, out) = (folder.mannequin(), folder.path("out.glb"));
    let cases: [(&[&str], &str); 8] = [
        (&["bake", &file, "-o", &out, "--fps", "-5"], "between 1 and 240 a second"),
        (&["bake", &file, "-o", &out, "--fps", "nan"], "between 1 and 240 a second"),
        (&["convert", &file, &out, "--fps", "0"], "between 1 and 240 a second"),
        (&["view", "pendulum", "--picture", "a.png", "--at", "-1"], "between 0 and 600 s"),
        (&["run", "pendulum", "--steps", "-1"], "-1 is not in 1.."),
        (&["bake", &file, "-o", &out, "--mass", "0"], "must be above 0"),
        (&["bake", &file, "-o", &out, "--height", "0"], "must be above 0"),
        (&["boxes", &file, "-o", "a.json", "--scale", "-1"], "must be above 0"),
    ];
    for (arguments, range) in cases {
        let run = sinew(arguments);
        assert!(run.code == Some(2) && run.stderr.contains(range), "{arguments:?}: {run:?}");
        assert!(!run.stderr.contains("to pass"), "{arguments:?}: {run:?}");
    }
}

#[test]
fn fractional_frame_rate_is_accepted() {
    let folder = Folder::new("rate");
    let (file, out) = (folder.mannequin(), folder.path("out.glb"));
    let object = sinew(&["bake", &file, "--fps", "29.97", "--seconds", "1", "-o", &out, "--json"]).json();
    assert_eq!(object["frames"], 30);
}

#[test]
fn unsupported_file_kinds_are_named() {
    let folder = Folder::new("foreign");
    fs::write(folder.path("packed.glb"), [0x1f, 0x8b, 8, 0]).expect("the file can be written");
    let urdf = r#"<?xml version="1.0"?><robot name="arm"><link name="base"/></robot>"#;
    let robot = folder.file("robot.urdf", urdf);
    for (file, what) in [(folder.path("packed.glb"), "compressed by gzip"), (robot, "a URDF robot")] {
        for arguments in [&["inspect", &file][..], &["bake", &file, "-o", "out.glb"]] {
            let line = sinew(arguments).refusal(1).to_owned();
            assert!(line.contains(what), "{line}");
        }
    }
    let bvh = folder.path("walk.bvh");
    assert_eq!(sinew(&["convert", &folder.mannequin(), &bvh]).code, Some(0));
    for arguments in [&["bake", &bvh, "-o", "out.glb"][..], &["ragdoll", "build", &bvh]] {
        assert!(sinew(arguments).refusal(1).contains("a motion without a skin"), "{arguments:?}");
    }
    let absent = sinew(&["bake", &folder.path("no/such.glb"), "-o", "out.glb"]);
    assert!(absent.refusal(1).ends_with("such.glb: no such folder"), "{absent:?}");
    // A folder that cannot be created because a file has its name.
    let file = folder.file("taken", "");
    let demo = sinew(&["demo", "--out", &format!("{file}/out"), "--width", "16", "--height", "16"]);
    assert!(!demo.refusal(1).contains("os error"), "{demo:?}");
}

#[test]
fn written_files_are_reported_in_one_form() {
    let folder = Folder::new("wrote");
    let (file, world) = (folder.mannequin(), folder.path("w.json"));
    let (glb, picture, record) = (folder.path("a.glb"), folder.path("a.png"), folder.path("a.sinewrec"));
    let commands: [(&[&str], &[&str]); 4] = [
        (&["bake", &file, "--seconds", "0.2", "-o", &glb], &[&glb]),
        (&["boxes", &file, "-o", &world, "--scale", "2", "--max", "2"], &[&world]),
        (&["view", "pendulum", "--at", "0", "--picture", &picture], &[&picture]),
        (&["record", "pendulum", "--steps", "2", "-o", &record], &[&record]),
    ];
    for (arguments, written) in commands {
        let run = sinew(arguments);
        for path in written {
            assert!(run.stdout.lines().any(|line| line == format!("wrote {path}")), "{run:?}");
        }
    }
    // The mannequin is 1.8 m tall, scaled by two 3.6 m.
    let scaled = sinew(&["boxes", &file, "-o", &world, "--scale", "2", "--max", "2", "--json"]).json();
    let plain = sinew(&["boxes", &file, "-o", &world, "--max", "2", "--json"]).json();
    let height = |object: &Value| object["height_m"].as_f64().expect("a height");
    assert!((height(&scaled) / height(&plain) - 2.0).abs() < 1e-4, "{scaled} {plain}");
}

#[test]
fn dash_reads_standard_input() {
    let folder = Folder::new("stdin");
    let file = folder.file("man.glb", glb(&mannequin().rig, &mannequin().clips));
    let piped = |arguments: &[&str]| {
        let input = std::fs::File::open(&file).expect("the file was just written");
        Run::of(command(arguments).stdin(input))
    };
    let [from_file, from_pipe] =
        [sinew(&["inspect", &file, "--json"]).json(), piped(&["inspect", "-", "--json"]).json()];
    assert_eq!(from_file["joints"], from_pipe["joints"]);
    assert_eq!(from_pipe["file"], "standard input");
    let [a, b] = [folder.path("a.json"), folder.path("b.json")];
    assert_eq!(sinew(&["ragdoll", "build", &file, "-o", &a]).code, Some(0));
    assert_eq!(piped(&["ragdoll", "build", "-", "-o", &b]).code, Some(0));
    assert_eq!(std::fs::read(a).expect("a ragdoll"), std::fs::read(b).expect("another"));
    let refused = Run::of(command(&["inspect", "-"]).stdin(std::process::Stdio::null()));
    assert!(refused.refusal(1).starts_with("error: standard input: "), "{refused:?}");
}

/// A clip without a name is offered by its number.
#[test]
fn clip_without_a_name_is_chosen_by_number() {
    let folder = Folder::new("nameless");
    let mut clips = mannequin().clips[..1].to_vec();
    clips[0].name.clear();
    let file = folder.file("nameless.glb", glb(&mannequin().rig, &clips));
    let bake = |clip: &str| {
        sinew(&["bake", &file, "--clip", clip, "--seconds", "0.1", "-o", &folder.path("out.glb")])
    };
    let wrong = bake("Walk");
    assert!(
        wrong.refusal(1).ends_with("no clip 'Walk'; there is number 0, which has no name (--clip)"),
        "{wrong:?}"
    );
    assert_eq!(bake("0").code, Some(0));
}

/// `inspect` and `convert` use the same unit of a BVH.
#[test]
fn unit_of_a_bvh_is_the_same_for_all_commands() {
    let folder = Folder::new("bvh-unit");
    let mannequin = folder.mannequin();
    let [centimetres, inches] = ["cm", "in"].map(|unit| {
        let bvh = folder.path(&format!("{unit}.bvh"));
        assert_eq!(sinew(&["convert", &mannequin, &bvh, "--unit", unit]).code, Some(0));
        bvh
    });
    let height =
        |arguments: &[&str]| sinew(&[&["inspect", "--json"], arguments].concat()).json()["height_m"].as_f64();
    let is_tall = |found: Option<f64>, due: f64| {
        let found = found.expect("a human");
        assert!((found / due - 1.0).abs() < 0.01, "height {found} m, expected {due} m");
    };
    let out = folder.path("out.glb");
    let converted = |bvh: &str, unit: &[&str]| {
        let run = sinew(&[&["convert", bvh, &out], unit].concat());
        assert_eq!(run.code, Some(0), "{run:?}");
        height(&[&out, "--unit", "m"])
    };
    let bones = height(&[&centimetres]).expect("a human");
    is_tall(height(&[&inches, "--unit", "in"]), bones);
    is_tall(height(&[&centimetres, "--unit", "in"]), 2.54 * bones);
    // A converted file has drawn bones, which are a little thicker than the skeleton.
    let drawn = converted(&centimetres, &[]).expect("a human");
    assert!((1.0..1.15).contains(&(drawn / bones)), "{drawn} m, {bones} m");
    is_tall(converted(&inches, &["--unit-in", "in"]), drawn);
    // The same option with a file of another format.
    let tall = height(&[&mannequin]).expect("a human");
    is_tall(height(&[&mannequin, "--unit", "ft"]), 0.3048 * tall);
    let steps = |unit: &str| {
        sinew(&["events", "detect", &mannequin, "--clip", "Walk", "--unit", unit, "--json"]).json()["clips"]
            [0]["events"]
            .as_array()
            .map(Vec::len)
    };
    // Steps are found by shares of the body's size.
    assert!(steps("m") > Some(1) && steps("100") == steps("m"), "{:?} {:?}", steps("m"), steps("100"));
}

#[test]
fn who_starts_inside_the_world_is_bad() {
    let folder = Folder::new("inside");
    let (file, out) = (folder.mannequin(), folder.path("out.glb"));
    let bake = |at: &str| sinew(&["bake", &file, "--at", at, "--seconds", "1", "-o", &out, "--json"]).json();
    let inside = bake("0,-1,0");
    let reasons = inside["reasons"].to_string();
    assert!(inside["verdict"] == "bad" && reasons.contains("it starts inside the world"), "{inside:#}");
    assert!(!bake("0,0,0")["reasons"].to_string().contains("inside the world"));
}

/// `ragdoll build` and `ragdoll doctor` report the same character: its size, their notes, and whether it can be
/// used.
#[needs_data]
#[test]
fn build_and_doctor_agree() {
    let data = shared_data();
    for (rig, can_be_used) in [("rigs/CesiumMan.glb", true), ("rigs/kaykit_Knight.glb", true)] {
        let file = data.join(rig).display().to_string();
        let built = sinew(&["ragdoll", "build", &file, "--json"]).json();
        let examined = sinew(&["ragdoll", "doctor", &file, "--json"]).json();
        let (of_build, of_doctor) = (notes(&built), notes(&examined));
        assert!(
            of_doctor.iter().all(|note| of_build.contains(note)),
            "notes of the doctor {of_doctor:?}, of the build {of_build:?}"
        );
        assert_eq!(built["quality"]["verdict"] != "bad", can_be_used, "{built:#}");
        let errors = examined["findings"].as_array().expect("findings").iter();
        assert_eq!(
            errors.filter(|finding| finding["severity"] == "error").count() == 0,
            can_be_used,
            "{examined:#}"
        );
    }
}
