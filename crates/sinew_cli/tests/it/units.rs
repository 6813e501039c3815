//! The file's unit and the body's mass, and notes about implausible values.

use crate::sinew::{Folder, glb, sinew};
use serde_json::Value;
use sinew::anim::{Joint, LocalTransform, Rig};
use sinew::formats::write_world;
use sinew::math::Vec3;
use sinew::physics::{BodyDef, BodyKind, Shape, ShapeDef};
use sinew_scenes::mannequin::mannequin;

/// Returns a rig in another unit: all lengths times `factor`.
fn scaled(mut rig: Rig, factor: f32) -> Rig {
    for joint in &mut rig.joints {
        joint.rest.translation *= factor;
    }
    for bind in rig.skins.iter_mut().flat_map(|skin| &mut skin.inverse_bind) {
        bind.translation *= factor;
    }
    for mesh in &mut rig.meshes {
        for primitive in &mut mesh.primitives {
            primitive.positions.iter_mut().for_each(|position| *position *= factor);
        }
    }
    rig
}

/// Returns a worm of two joints, `length` units long and `girth` times as thick as the mannequin's trunk. A worm is
/// not human, so its mass comes from its volume.
fn worm(length: f32, girth: f32) -> Rig {
    let mut rig = mannequin().rig;
    let keep = ["hips", "spine"];
    let kept = |name: &str| keep.contains(&name);
    for mesh in &mut rig.meshes {
        let Some(skin) = mesh.skin else { continue };
        let slots = rig.skins[skin].joints.clone();
        for primitive in &mut mesh.primitives {
            let of_kept = |vertex: u32| {
                let slot = usize::from(primitive.joints[vertex as usize][0]);
                kept(&rig.joints[slots[slot]].name)
            };
            let corners =
                primitive.indices.chunks_exact(3).filter(|corner| corner.iter().all(|&i| of_kept(i)));
            primitive.indices = corners.flatten().copied().collect();
            let used: Vec<bool> = {
                let mut used = vec![false; primitive.positions.len()];
                primitive.indices.iter().for_each(|&i| used[i as usize] = true);
                used
            };
            for (position, used) in primitive.positions.iter_mut().zip(used) {
                let thick = Vec3::new(girth * position.x, position.y, girth * position.z);
                // Vertices without triangles are moved inside.
                *position = if used { thick } else { Vec3::Y };
            }
        }
    }
    let heights = rig.meshes.iter().flat_map(|mesh| &mesh.primitives).flat_map(|p| &p.positions);
    let (low, high) = heights.fold((f32::MAX, f32::MIN), |(lo, hi), p| (lo.min(p.y), hi.max(p.y)));
    scaled(rig, length / (high - low))
}

fn notes(object: &Value) -> Vec<String> {
    let notes = object["notes"].as_array().expect("notes");
    notes.iter().map(|note| note.as_str().expect("a sentence").to_owned()).collect()
}

#[test]
fn unit_reason_and_alternatives_are_noted() {
    let folder = Folder::new("unit-note");
    let build = |rig: &Rig, extra: &[&str]| {
        let file = folder.file("body.glb", glb(rig, &[]));
        sinew(&[&["ragdoll", "build", &file, "--json"], extra].concat()).json()
    };
    let rig = mannequin().rig;
    let of_unit = |object: &Value| notes(object).into_iter().find(|note| note.contains("taken as"));
    let metres = of_unit(&build(&rig, &[])).expect("a note");
    assert!(metres.contains("taken as metres: 1.") && metres.contains("no other unit fits"), "{metres}");
    let object = build(&scaled(rig.clone(), 100.0), &[]);
    let note = of_unit(&object).expect("a note");
    assert!(note.contains("taken as centimetres: 1.") && note.contains("a human is 0.9 to 3 m"), "{note}");
    assert!(note.ends_with("; --unit or --height sets it"), "{note}");
    // 20 units: two metres in decimetres, half a metre in inches.
    let object = build(&scaled(rig.clone(), 20.0 / 1.75), &[]);
    let note = of_unit(&object).expect("a note");
    assert!(note.contains("taken as decimetres: 2.0") && note.contains("it may also be inches"), "{note}");
    // A given unit is not reported as a guess.
    for extra in [["--unit", "cm"], ["--unit", "0.01"], ["--height", "1.8"]] {
        let object = build(&scaled(rig.clone(), 100.0), &extra);
        assert_eq!(of_unit(&object), None, "{extra:?}");
        let height = object["height_m"].as_f64().expect("a height");
        assert!((1.7..1.9).contains(&height), "{extra:?}: {height}");
    }
    let inches = build(&scaled(rig, 100.0), &["--unit", "in"]);
    assert!(inches["height_m"].as_f64().expect("a height") > 4.0);
}

/// Returns the rig below a node with a scale, with all lengths divided by the scale: the drawing is unchanged.
fn below_a_node(rig: &Rig, scale: f32) -> Rig {
    let mut rig = scaled(rig.clone(), 1.0 / scale);
    for joint in &mut rig.joints {
        joint.parent = Some(joint.parent.map_or(0, |parent| parent + 1));
        joint.source += 1;
    }
    let rest = LocalTransform { scale: Vec3::splat(scale), ..LocalTransform::default() };
    rig.joints.insert(0, Joint { name: "RootNode".into(), parent: None, rest, source: 0 });
    rig.skins.iter_mut().flat_map(|skin| &mut skin.joints).for_each(|joint| *joint += 1);
    rig.meshes.iter_mut().for_each(|mesh| mesh.joint += 1);
    rig
}

#[test]
fn scaled_root_node_changes_nothing() {
    let folder = Folder::new("unit-node");
    let rig = mannequin().rig;
    let build = |rig: &Rig| {
        let file = folder.file("body.glb", glb(rig, &[]));
        sinew(&["ragdoll", "build", &file, "--json"]).json()
    };
    let plain = build(&rig);
    let close = |a: &Value, b: &Value, share: f64| {
        let (a, b) = (a.as_f64().expect("a number"), b.as_f64().expect("a number"));
        (a - b).abs() <= share * a
    };
    for scale in [0.01, 39.37] {
        let other = build(&below_a_node(&rig, scale));
        // The size is measured as drawn, in metres; lengths below the node alone would give another unit.
        assert_eq!(of_unit(&other), of_unit(&plain), "{scale}");
        assert!(close(&plain["unit_scale"], &other["unit_scale"], 1e-3), "{scale}");
        assert!(close(&plain["height_m"], &other["height_m"], 1e-3), "{scale}: {}", other["height_m"]);
        assert_eq!(plain["quality"]["verdict"], other["quality"]["verdict"], "{scale}");
        let bodies = |object: &Value| object["bodies"].as_array().expect("bodies").clone();
        let (plain, other) = (bodies(&plain), bodies(&other));
        assert_eq!(plain.len(), other.len(), "{scale}");
        for (a, b) in plain.iter().zip(&other) {
            assert_eq!((&a["bone"], &a["role"]), (&b["bone"], &b["role"]), "{scale}");
            assert!(close(&a["mass_kg"], &b["mass_kg"], 0.02), "{scale}: {a} {b}");
        }
    }
}

/// 66 units tall: a man in inches, or a dwarf in centimetres.
fn of_66_units() -> Rig {
    scaled(mannequin().rig, 66.0 / 1.75)
}

fn of_unit(object: &Value) -> String {
    notes(object).into_iter().find(|note| note.contains("taken as")).expect("a note")
}

#[test]
fn neighbouring_files_decide_an_ambiguous_unit() {
    let folder = Folder::new("unit-kin");
    let file = folder.file("dwarf.glb", glb(&of_66_units(), &[]));
    let build = || of_unit(&sinew(&["ragdoll", "build", &file, "--json"]).json());
    assert!(build().contains("taken as inches"), "{}", build());
    let in_centimetres = glb(&scaled(mannequin().rig, 100.0), &[]);
    folder.file("man.glb", in_centimetres.clone());
    folder.file("noise.glb", b"no character at all");
    folder.file("woman.glb", in_centimetres);
    let note = build();
    assert!(note.contains("taken as centimetres: 0.6"), "{note}");
    assert!(note.contains("files beside it are in centimetres, "), "{note}");
    assert!(note.contains("; it may also be inches (1.6"), "{note}");
    let seen = sinew(&["inspect", &file, "--json"]).json();
    assert!(of_unit(&seen).contains("taken as centimetres"), "{seen:#}");
}

/// `inspect` used to ignore the file's name and its settings.
#[test]
fn inspect_and_build_agree_on_the_size() {
    let folder = Folder::new("unit-agree");
    let heights = |file: &str, extra: &[&str]| {
        let seen = sinew(&[&["inspect", file, "--json"], extra].concat()).json();
        let built = sinew(&[&["ragdoll", "build", file, "--json"], extra].concat()).json();
        [seen, built].map(|object| object["height_m"].as_f64().expect("a height"))
    };
    for name in ["spider.glb", "creature.glb"] {
        let file = folder.file(name, glb(&worm(5.9, 1.0), &[]));
        let [seen, built] = heights(&file, &[]);
        assert!((seen / built - 1.0).abs() < 1e-5, "{name}: {seen} and {built} m");
    }
    let file = folder.path("creature.glb");
    let settings = r#"{"sinew": "ragdoll-settings", "version": 1, "height": 0.7}"#;
    folder.file("creature.ragdoll.json", settings);
    let [seen, built] = heights(&file, &[]);
    assert!((seen - 0.7).abs() < 1e-3 && (built - 0.7).abs() < 1e-3, "{seen} and {built} m");
    let [seen, built] = heights(&file, &["--unit", "cm"]);
    assert!((seen / built - 1.0).abs() < 1e-5, "{seen} and {built} m");
}

/// Masses that nothing of the size has used to be called good when they were given.
#[test]
fn given_masses_and_heights_are_judged() {
    let folder = Folder::new("unit-given");
    let file = folder.file("body.glb", glb(&mannequin().rig, &[]));
    let build = |extra: &[&str]| {
        let object = sinew(&[&["ragdoll", "build", &file, "--json"], extra].concat()).json();
        let reasons = object["quality"]["reasons"].to_string();
        (object["quality"]["verdict"].as_str().expect("a verdict").to_owned(), reasons)
    };
    for extra in [["--mass", "0.5"], ["--mass", "9000"], ["--height", "180"]] {
        let (verdict, reasons) = build(&extra);
        assert!(verdict != "good" && reasons.contains("is given"), "{extra:?}: {verdict}, {reasons}");
    }
    let (verdict, reasons) = build(&["--mass", "90"]);
    assert!(verdict == "good" && !reasons.contains("is given"), "{reasons}");
}

fn block(low: [f32; 3], high: [f32; 3]) -> BodyDef {
    let (low, high) = (Vec3::from_array(low), Vec3::from_array(high));
    let shapes = vec![ShapeDef::new(Shape::Box { half_extents: (high - low) * 0.5 })];
    BodyDef { kind: BodyKind::Static, position: (low + high) * 0.5, shapes, ..BodyDef::default() }
}

#[test]
fn doors_decide_an_ambiguous_unit() {
    let folder = Folder::new("unit-door");
    let file = folder.file("dwarf.glb", glb(&of_66_units(), &[]));
    let out = folder.path("fall.glb");
    // Two rooms with a door between them, `size` times as large as a dwarf's.
    let rooms = |size: f32| {
        let walls = [
            ([-3.0, -0.1, -3.0], [3.0, 0.0, 3.0]),
            ([-3.0, 1.0, -3.0], [3.0, 1.1, 3.0]),
            ([-3.0, 0.0, -0.05], [-0.4, 1.0, 0.05]),
            ([0.4, 0.0, -0.05], [3.0, 1.0, 0.05]),
            ([-0.4, 0.8, -0.05], [0.4, 1.0, 0.05]),
        ];
        let walls = walls.map(|(low, high)| block(low.map(|x| x * size), high.map(|x| x * size)));
        folder.file("world.json", write_world(&walls))
    };
    let bake = |size: f32| {
        let world = rooms(size);
        let at = format!("0,0,{}", 1.5 * size);
        let arguments = ["bake", &file, "--world", &world, "--at", &at, "--limp-at", "0", "--seconds", "0.2"];
        of_unit(&sinew(&[&arguments[..], &["-o", &out, "--json"]].concat()).json())
    };
    let (small, large) = (bake(1.0), bake(2.6));
    assert!(
        small.contains("taken as centimetres") && small.contains("doors of its world are 0.80 m"),
        "{small}"
    );
    assert!(large.contains("taken as inches") && large.contains("doors of its world are 2.08 m"), "{large}");
}

#[test]
fn implausible_mass_is_not_good() {
    let folder = Folder::new("unit-mass");
    for (length, girth, mass) in [(0.15, 0.3, " g at"), (9.9, 1.0, " t at")] {
        let file = folder.file("worm.glb", glb(&worm(length, girth), &[]));
        let build = |extra: &[&str]| sinew(&[&["ragdoll", "build", &file, "--json"], extra].concat()).json();
        let object = build(&[]);
        let reasons = object["quality"]["reasons"].to_string();
        let kg = object["total_mass_kg"].as_f64().expect("a mass");
        assert!(!(0.1..=3000.0).contains(&kg), "{length}: {kg} kg");
        assert_ne!(object["quality"]["verdict"], "good", "{length}: {kg} kg");
        assert!(reasons.contains(mass) && reasons.contains("--mass the mass"), "{length}: {reasons}");
        let in_notes = |object: &Value| notes(object).iter().any(|note| note.contains("--mass the mass"));
        assert!(in_notes(&object));
        for given in [["--mass", "70"], ["--height", "1.2"], ["--unit", "0.5"]] {
            let object = build(&given);
            assert!(!object["quality"]["reasons"].to_string().contains("--mass the mass"), "{given:?}");
            assert!(!in_notes(&object), "{given:?}");
        }
        let (fall, model) = (folder.path("fall.glb"), folder.path("worm.xml"));
        let bake = |extra: &[&str]| {
            let arguments = ["bake", &file, "--limp-at", "0", "--seconds", "0.5", "-o", &fall, "--json"];
            sinew(&[&arguments[..], extra].concat()).json()
        };
        let baked = bake(&[]);
        assert!(in_notes(&baked));
        // A bake is judged like the drop tests: even a flawless fall of an implausible body is not good.
        assert_ne!(baked["verdict"], "good", "{length}: {kg} kg");
        let first = baked["reasons"][0].as_str().expect("a reason");
        assert!(first.contains(mass) && first.contains("--mass the mass"), "{length}: {first}");
        let given = bake(&["--mass", "70"]);
        assert!(!given["reasons"].to_string().contains("--mass the mass") && !in_notes(&given));
        let definition = folder.path("worm.sinew.json");
        sinew(&["ragdoll", "build", &file, "-o", &definition, "--json"]).json();
        let baked = bake(&["--ragdoll", &definition]);
        assert_ne!(baked["verdict"], "good", "{length}: {kg} kg");
        let first = baked["reasons"][0].as_str().expect("a reason");
        assert!(first.contains(mass) && first.contains("--mass of `ragdoll build`"), "{length}: {first}");
        assert!(notes(&baked).iter().any(|note| note == first));
        assert!(in_notes(&sinew(&["ragdoll", "doctor", &file, "--json"]).json()));
        assert!(in_notes(
            &sinew(&["ragdoll", "export", &file, "--as", "mjcf", "-o", &model, "--json"]).json()
        ));
    }
}

#[test]
fn invalid_units_and_heights_are_usage_errors() {
    for arguments in [["--unit", "0"], ["--unit", "ell"], ["--height", "-1"], ["--height", "NaN"]] {
        let run = sinew(&[&["ragdoll", "build", "a.glb"][..], &arguments].concat());
        assert!(run.code == Some(2), "{arguments:?}: {run:?}");
    }
    let run = sinew(&["ragdoll", "build", "a.glb", "--unit", "cm", "--height", "2"]);
    assert!(run.code == Some(2) && run.stderr.contains("cannot be used with"), "{run:?}");
}
