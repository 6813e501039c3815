//! `sinew bake` on generated files.

use crate::contract::check_keys;
use crate::sinew::{Folder, glb, shared_data, sinew};
use needs_data::needs_data;
use sinew::anim::{Clip, Joint, Rig, Wrap, local_to_model, rest_pose, sample};
use sinew::formats::bvh::BvhUnit;
use sinew::formats::{BvhDocument, BvhOptions, Document, ReadOptions, load_gltf, read_bvh, write_world};
use sinew::math::{Affine, Rotation, Vec3};
use sinew::physics::{BodyDef, BodyKind, Shape, ShapeDef};
use sinew_scenes::cabin::Site;
use sinew_scenes::mannequin::mannequin;
use std::fs;

#[test]
fn bake_adds_the_fall_to_a_copy_of_the_file() {
    let folder = Folder::new("bake");
    let (file, out) = (folder.mannequin(), folder.path("fall.glb"));
    let picture = folder.path("fall.png");
    let arguments = [
        "bake",
        &file,
        "--clip",
        "Walk",
        "--hit",
        "chest=0,0,40@0.2",
        "--seconds",
        "0.5",
        "--fps",
        "24",
        "-o",
        &out,
        "--picture",
        &picture,
        "--json",
    ];
    let object = sinew(&arguments).json();
    check_keys("bake", &object);
    assert_eq!((&object["seconds"], &object["frames"]), (&0.5.into(), &13.into()));
    assert_eq!(object["outputs"], serde_json::json!([out, picture]));
    let [old, new] =
        [&file, &out].map(|path| load_gltf(path, ReadOptions::default()).expect("the glTF can be read"));
    assert_eq!(new.clips.len(), old.clips.len() + 1);
    assert_eq!(new.clips[0], old.clips[0]);
    let baked = new.clips.last().expect("a clip");
    assert!((baked.duration - 0.5).abs() < 1e-6, "{} s", baked.duration);
    assert!(fs::read(&picture).expect("a picture").starts_with(b"\x89PNG"));
    assert_eq!(folder.names(), ["fall.glb", "fall.png", "mannequin.glb"]);
}

#[test]
fn key_error_bound_removes_keys() {
    let folder = Folder::new("keys");
    let file = folder.mannequin();
    let baked = |error: &[&str]| {
        let out = folder.path("out.glb");
        let arguments = [&["bake", file.as_str(), "--seconds", "3", "-o", &out, "--json"], error].concat();
        let object = sinew(&arguments).json();
        let document = load_gltf(&out, ReadOptions::default()).expect("the glTF can be read");
        let clip = document.clips.last().expect("a clip").clone();
        let keys: usize = clip.channels.iter().map(|channel| channel.times.len()).sum();
        assert_eq!(object["keys"], keys);
        (object, clip)
    };
    let number = |object: &serde_json::Value, key: &str| object[key].as_f64().expect("a number");
    let (all, every_key) = baked(&["--key-error", "0"]);
    assert_eq!(all["keys"], all["keys_of_all_frames"]);
    assert!(every_key.channels.iter().all(|channel| channel.times.len() == 91));
    let (usual, _) = baked(&[]);
    assert!(number(&usual, "keys") < number(&all, "keys"));
    let (coarse, clip) = baked(&["--key-error", "2"]);
    assert!(number(&coarse, "keys") < 0.9 * number(&usual, "keys"), "{coarse:#}");
    for (object, mm) in [(&usual, 0.1), (&coarse, 2.0)] {
        assert!((number(object, "key_error_bound_m") - 1e-3 * mm).abs() < 1e-9);
        assert!((number(object, "key_error_bound_deg") - 0.1 * mm).abs() < 1e-6);
        assert!(number(object, "key_error_max_m") <= 1e-3 * mm, "{object:#}");
        assert!(number(object, "key_error_max_deg") <= 0.1 * mm, "{object:#}");
    }
    assert!((clip.duration - 3.0).abs() < 1e-6);
}

/// Returns the largest distance of a joint in a BVH from the joint of the same name in the last clip of a file with
/// the given unit (metres).
fn between(document: &Document, bvh: &BvhDocument, unit: f32) -> f32 {
    let clip = document.clips.last().expect("a clip");
    let named = |(_, joint): &(usize, &Joint)| !joint.name.is_empty();
    let same = |joint: &Joint| {
        let found = document.rig.joints.iter().position(|other| other.name.replace(' ', "_") == joint.name);
        found.unwrap_or_else(|| panic!("no joint {}", joint.name))
    };
    let pairs: Vec<[usize; 2]> =
        bvh.rig.joints.iter().enumerate().filter(named).map(|(index, joint)| [same(joint), index]).collect();
    assert!(pairs.len() > 10, "{} joints", pairs.len());
    let mut worst = 0.0;
    for frame in 0..bvh.frames {
        let time = (frame as f64 * bvh.frame_time) as f32;
        let places = |rig: &Rig, clip: &Clip, unit: f32| {
            let (mut pose, mut model) = (rest_pose(rig), Vec::new());
            sample(clip, rig, time, Wrap::Clamp, &mut pose);
            let scaled =
                Affine::from_scale_rotation_translation(Vec3::splat(unit), Rotation::IDENTITY, Vec3::ZERO);
            local_to_model(rig, &pose, &scaled, &mut model);
            model
        };
        let [from, to] = [places(&document.rig, clip, unit), places(&bvh.rig, &bvh.clip, 1.0)];
        for &[a, b] in &pairs {
            worst = sinew::math::max(worst, (from[a].translation - to[b].translation).length());
        }
    }
    worst
}

#[test]
fn bvh_output_has_the_bones_and_every_frame() {
    let folder = Folder::new("bvh");
    let file = folder.mannequin();
    for (fps, frames) in [("24", 49), ("25", 51), ("120", 241)] {
        let arguments = ["bake", &file, "--seconds", "2", "--fps", fps, "--json", "-o"];
        let run = |out: &str, extra: &[&str]| sinew(&[&arguments[..], &[out], extra].concat()).json();
        let (bvh, glb) = (folder.path("fall.bvh"), folder.path("fall.glb"));
        let (of_bvh, of_glb) = (run(&bvh, &[]), run(&glb, &["--key-error", "0"]));
        check_keys("bake", &of_bvh);
        assert_eq!((&of_bvh["hash"], &of_bvh["frames"]), (&of_glb["hash"], &frames.into()));
        assert_eq!(of_bvh["key_error_max_m"], 0.0);
        let lost = |object: &serde_json::Value| object["notes"].to_string().contains("mesh");
        assert!(lost(&of_bvh) && !lost(&of_glb), "{of_bvh:#}");
        let text = fs::read(&bvh).expect("the file can be read");
        let read = read_bvh(&text, BvhOptions { unit: BvhUnit::Metres(0.01), ..BvhOptions::default() })
            .expect("the BVH can be read");
        assert_eq!(
            (read.frames, (1.0 / read.frame_time).round() as u32),
            (frames, fps.parse().expect("a number"))
        );
        let worst =
            between(&load_gltf(&glb, ReadOptions::default()).expect("the glTF can be read"), &read, 1.0);
        // Tolerance: six decimals, of degrees and centimetres.
        assert!(worst < 2e-5, "{fps}: {worst} m off");
    }
    let run = sinew(&["bake", &file, "-o", &folder.path("x.bvh"), "--key-error", "1"]);
    assert_eq!(run.refusal(2), "error: --key-error does not apply to a BVH, which holds every frame");
    let run = sinew(&["bake", &file, "-o", "x.gltf"]);
    assert!(run.code == Some(2) && run.stderr.contains("must end in .glb, .vrm or .bvh"), "{run:?}");
}

#[test]
fn equal_commands_write_equal_bytes() {
    let folder = Folder::new("twice");
    let file = folder.mannequin();
    let baked = |name: &str| {
        let out = folder.path(name);
        let hash = sinew(&["bake", &file, "--seconds", "1.5", "-o", &out, "--json"]).json()["hash"].clone();
        (hash, fs::read(out).expect("the output"))
    };
    assert_eq!(baked("a.glb"), baked("b.glb"));
}

#[test]
fn character_goes_limp_at_half_a_second_by_default() {
    let folder = Folder::new("limp");
    let (file, out) = (folder.mannequin(), folder.path("out.glb"));
    let object = sinew(&["bake", &file, "--seconds", "5", "-o", &out, "--json"]).json();
    let number = |key: &str| object[key].as_f64().unwrap_or_else(|| panic!("{key} in {object:#}"));
    assert!((0.5..0.8).contains(&number("first_contact_s")));
    assert!(number("settled_s") > 1.0);
    assert!(number("penetration_rest_max_m") < 0.005);
    assert_eq!((&object["nan"], &object["up_s"]), (&0.into(), &serde_json::Value::Null));
    let text = sinew(&["bake", &file, "--limp-at", "0.25", "--seconds", "0.5", "-o", &out]).stdout;
    assert!(text.contains("   0.25 s  goes limp"), "{text}");
}

#[test]
fn character_falls_into_a_world_file() {
    let folder = Folder::new("world");
    let file = folder.mannequin();
    let bodies: Vec<_> = Site::CabinWithStairs.props().into_iter().map(|prop| prop.body).collect();
    let world = folder.file("cabin.json", write_world(&bodies));
    let hash = |extra: &[&str]| {
        let out = folder.path("out.glb");
        let arguments = [&["bake", file.as_str(), "--seconds", "1", "-o", &out, "--json"], extra].concat();
        sinew(&arguments).json()["hash"].clone()
    };
    assert_ne!(hash(&["--world", &world]), hash(&[]));
    let broken = folder.file("broken.json", r#"{"sinew":"world","version":1,"bodies":[{"shapes":[{}]}]}"#);
    let out = folder.path("none.glb");
    let run = sinew(&["bake", &file, "--world", &broken, "-o", &out]);
    assert!(run.refusal(1).starts_with(&format!("error: {broken}: ")), "{run:?}");
}

#[test]
fn degenerate_and_duplicate_triangles_are_counted() {
    let folder = Folder::new("left_out");
    let (file, out) = (folder.mannequin(), folder.path("out.glb"));
    let triangles = "v -9 0 -9\nv -9 0 9\nv 9 0 9\nf 1 2 3\nf 1 2 3\nf 1 1 2\nf 1 2 2\n";
    let level = folder.file("level.obj", triangles);
    let run = sinew(&["bake", &file, "--world", &level, "--limp-at", "0", "--seconds", "0.1", "-o", &out]);
    let line = "  left out of the world: 2 triangles without area, 1 that are duplicates\n";
    assert!(run.stdout.contains(line), "{run:?}");
}

#[test]
fn unknown_names_are_reported_with_the_known_ones() {
    let folder = Folder::new("names");
    let (file, out) = (folder.mannequin(), folder.path("out.glb"));
    let line = |extra: &[&str]| {
        let arguments = [&["bake", file.as_str(), "-o", &out], extra].concat();
        sinew(&arguments).refusal(1).to_owned()
    };
    assert_eq!(line(&["--clip", "Fly"]), format!("error: {file}: no clip 'Fly'; there is Walk (--clip)"));
    let hit = line(&["--hit", "haed=0,0,1@1"]);
    assert!(hit.contains("no bone 'haed' to hit; the nearest of ") && hit.contains(" are head, "), "{hit}");
    assert_eq!(folder.names(), ["mannequin.glb"]);
}

#[test]
fn outputs_are_written_all_or_none_and_never_over_an_input() {
    let folder = Folder::new("outputs");
    let (file, out) = (folder.mannequin(), folder.path("out.glb"));
    let picture = folder.path("missing/out.gif");
    let run = sinew(&["bake", &file, "--seconds", "0.1", "-o", &out, "--picture", &picture]);
    assert_eq!(run.refusal(1), format!("error: {picture}: cannot write: no such folder"));
    assert_eq!(folder.names(), ["mannequin.glb"]);
    let settings = folder.file("mannequin.ragdoll.json", r#"{ "sinew": "ragdoll-settings", "version": 1 }"#);
    let before = [&file, &settings].map(|path| fs::read(path).expect("the file"));
    for input in [&file, &settings] {
        for command in [
            &["bake", &file, "-o", input][..],
            &["ragdoll", "build", &file, "-o", input],
            &["ragdoll", "doctor", &file, "--fix", "-o", input],
            &["ragdoll", "export", &file, "--as", "mjcf", "-o", input],
        ] {
            // `bake` writes another extension.
            if command[0] != "bake" || input == &file {
                let run = sinew(command);
                assert_eq!(run.refusal(2), format!("error: {input} is an input: write to another file"));
            }
        }
    }
    assert_eq!([&file, &settings].map(|path| fs::read(path).expect("the file")), before);
}

#[test]
fn options_that_cannot_take_effect_are_rejected() {
    let folder = Folder::new("late");
    let (file, out) = (folder.mannequin(), folder.path("out.glb"));
    let line = |extra: &[&str]| {
        sinew(&[&["bake", file.as_str(), "-o", &out, "--seconds", "2"], extra].concat()).refusal(2).to_owned()
    };
    assert_eq!(
        line(&["--hit", "chest=0,0,9@1", "--hit", "chest=0,0,9@3"]),
        "error: --hit at 3 s is after the end, at 2 s (--seconds)"
    );
    for (option, why) in [("--key-error", "between 0 and 100 mm"), ("--limp-at", "between 0 and 600 s")] {
        let run = sinew(&["bake", &file, "-o", &out, option, "-1"]);
        assert!(run.code == Some(2) && run.stderr.contains(why), "{run:?}");
    }
    for option in ["--mass", "--height"] {
        let run = sinew(&["ragdoll", "build", &file, option, "-4"]);
        assert!(run.code == Some(2) && run.stderr.contains("must be above 0"), "{run:?}");
    }
}

#[needs_data]
#[test]
fn foreign_rigs_are_baked() {
    let data = shared_data();
    let folder = Folder::new("strangers");
    for name in [
        "CesiumMan.glb",
        "kaykit_Knight.glb",
        "quaternius_cyberpunk_Character.glb",
        "CoolLoops_mixamorig_vrm0.vrm",
        "Fox.glb",
    ] {
        let (file, out) = (data.join("rigs").join(name).display().to_string(), folder.path("out.glb"));
        let object = sinew(&["bake", &file, "--seconds", "2", "-o", &out, "--json"]).json();
        assert_eq!(object["nan"], 0, "{name}");
        assert!(object["first_contact_s"].is_number(), "{name}: {object:#}");
        assert!(load_gltf(&out, ReadOptions::default()).is_ok(), "{name}");
    }
}

#[needs_data]
#[test]
fn foreign_rigs_are_written_as_bvh() {
    let data = shared_data();
    let folder = Folder::new("strangers-bvh");
    for name in ["CesiumMan.glb", "kaykit_Knight.glb", "Fox.glb", "quaternius_cyberpunk_Character.glb"] {
        let file = data.join("rigs").join(name).display().to_string();
        let (bvh, glb) = (folder.path("fall.bvh"), folder.path("fall.glb"));
        let arguments = ["bake", &file, "--seconds", "1.5", "--json"];
        let object = sinew(&[&arguments[..], &["-o", &bvh]].concat()).json();
        sinew(&[&arguments[..], &["--key-error", "0", "-o", &glb]].concat()).json();
        let unit = sinew(&["inspect", &file, "--json"]).json()["unit_scale"].as_f64().expect("a unit") as f32;
        let text = fs::read(&bvh).expect("the file can be read");
        let options = BvhOptions { unit: BvhUnit::Metres(0.01), ..BvhOptions::default() };
        let read = read_bvh(&text, options).expect("the BVH can be read");
        assert_eq!(object["frames"], read.frames, "{name}");
        let document = load_gltf(&glb, ReadOptions::default()).expect("the glTF can be read");
        let worst = between(&document, &read, unit);
        println!("{name}: {worst} m, {}", object["notes"]);
        assert!(worst < 2e-4, "{name}: largest error {worst} m, {object:#}");
    }
}

#[needs_data]
#[test]
fn human_without_clips_gets_up_by_builtin_motions() {
    let folder = Folder::new("builtin");
    let bare = folder.file("bare.glb", glb(&mannequin().rig, &[]));
    let out = folder.path("out.glb");
    let baked = |file: &str, extra: &[&str]| {
        sinew(&[&["bake", file, "--seconds", "9", "-o", &out, "--json"], extra].concat()).json()
    };
    let says = |object: &serde_json::Value, what: &str| {
        let notes = object["notes"].as_array().expect("notes");
        assert!(notes.iter().any(|note| note.as_str().is_some_and(|note| note.contains(what))), "{notes:?}");
    };
    let object = baked(&bare, &[]);
    let up = object["up_s"].as_f64().expect("the character got up") as f32;
    says(&object, "gets up by built-in motions");
    let document = load_gltf(&out, ReadOptions::default()).expect("the glTF can be read");
    let hips = |time: f32| {
        let (rig, clip) = (&document.rig, document.clips.last().expect("a clip"));
        let (mut local, mut model) = (rest_pose(rig), Vec::new());
        let rest = local.clone();
        sample(clip, rig, time, Wrap::Clamp, &mut local);
        local_to_model(rig, &local, &Affine::IDENTITY, &mut model);
        let joint = rig.joints.iter().position(|joint| joint.name == "hips").expect("hips");
        let turned = local.iter().zip(&rest).map(|(a, b)| a.rotation.angle_to(b.rotation));
        (model[joint].translation, turned.fold(0.0, f32::max))
    };
    assert!(hips(0.0).1 < 1e-3, "the character does not begin in its rest pose");
    assert!((hips(0.0).0.y - hips(up + 1.0).0.y).abs() < 0.1, "the character does not stand again");
    let way = (hips(up + 1.5).0 - hips(up + 0.5).0) * Vec3::new(1.0, 0.0, 1.0);
    assert!((way.length() - 1.25).abs() < 0.1, "the character does not walk: displacement {way} m");

    let object = baked(&bare, &["--no-builtin-motions"]);
    assert!(object["up_s"].is_null());
    says(&object, "--no-builtin-motions leaves out the built-in ones");
    let data = shared_data();
    let object = baked(&data.join("rigs/Fox.glb").display().to_string(), &[]);
    assert!(object["up_s"].is_null());
    says(&object, "it does not get up: the built-in motions are for humans, and this character is not human");
}

#[test]
fn get_up_is_chosen_by_name_or_left_out() {
    let folder = Folder::new("get_up");
    let whole = mannequin();
    let (file, out) = (folder.file("whole.glb", glb(&whole.rig, &whole.clips)), folder.path("out.glb"));
    let arguments = ["bake", &file, "--seconds", "9", "-o", &out, "--json", "--get-up"];
    let get_up = &whole.clips[whole.motions.get_up_supine].name;
    assert!(!sinew(&[&arguments[..], &[get_up]].concat()).json()["up_s"].is_null());
    let object = sinew(&[&arguments[..], &["none"]].concat()).json();
    assert!(object["up_s"].is_null());
    assert!(!object["notes"].to_string().contains("does not get up"), "{}", object["notes"]);
    let line = sinew(&[&arguments[..], &["Fly"]].concat()).refusal(1).to_owned();
    assert!(line.contains("no clip 'Fly'") && line.ends_with("(--get-up)"), "{line}");
}

#[test]
fn clip_that_ends_lying_is_played_backwards_to_get_up() {
    let folder = Folder::new("death");
    let whole = mannequin();
    let walk = whole.clips[whole.motions.walk].clone();
    let mut death = whole.clips[whole.motions.get_up_supine].reversed();
    death.name = "Death".to_owned();
    let file = folder.file("mortal.glb", glb(&whole.rig, &[walk.clone(), death]));
    let out = folder.path("out.glb");
    let arguments = ["bake", &file, "--seconds", "9", "-o", &out, "--json", "--no-builtin-motions"];
    let down = sinew(&arguments).json();
    assert!(down["up_s"].is_null());
    let notes = down["notes"].to_string();
    assert!(notes.contains("--get-up 'Death' plays that clip backwards"), "{notes}");
    let arguments = [&arguments[..7], &["--get-up"]].concat();
    let up = sinew(&[&arguments[..], &["Death"]].concat()).json();
    assert!(!up["up_s"].is_null(), "{up}");
    let notes = up["notes"].to_string();
    assert!(notes.contains("it gets up by 'Death' played backwards"), "{notes}");
    let line = sinew(&[&arguments[..], &[&walk.name]].concat()).refusal(1).to_owned();
    assert!(line.contains("begins and ends standing"), "{line}");
}

#[test]
fn character_in_place_of_a_definition_is_named() {
    let folder = Folder::new("definition");
    let (file, out) = (folder.mannequin(), folder.path("out.glb"));
    let line = sinew(&["bake", &file, "--ragdoll", &file, "-o", &out]).refusal(1).to_owned();
    assert!(line.contains("a character, not the definition of a ragdoll"), "{line}");
    assert!(sinew(&["doctor", &file]).stderr.contains("the command is 'sinew ragdoll doctor'"));
}

fn block(min: [f32; 3], max: [f32; 3]) -> BodyDef {
    let (min, max) = (Vec3::from_array(min), Vec3::from_array(max));
    let half_extents = (max - min) * 0.5;
    BodyDef {
        kind: BodyKind::Static,
        position: (min + max) * 0.5,
        shapes: vec![ShapeDef::new(Shape::Box { half_extents })],
        ..BodyDef::default()
    }
}

/// The centre of this world is a pillar; beside it is a low roof, and around it a ramp. Only the terrace has room.
#[test]
fn character_is_placed_where_there_is_room() {
    let folder = Folder::new("place");
    let (file, out) = (folder.mannequin(), folder.path("out.glb"));
    let mut ramp = block([-30.0, -1.0, -30.0], [30.0, 0.0, 30.0]);
    ramp.rotation = Rotation::from_axis_angle(Vec3::Z, 0.3);
    let world = [
        ramp,
        block([-0.5, 0.0, -0.5], [0.5, 9.0, 0.5]),
        block([-4.0, -3.0, -4.0], [4.0, 2.0, 4.0]),
        block([-4.0, 4.0, -4.0], [4.0, 4.2, 4.0]),
        block([12.0, 0.0, -4.0], [20.0, 7.0, 4.0]),
    ];
    let world = folder.file("world.json", write_world(&world));
    let bake = |extra: &[&str]| {
        let arguments = ["bake", &file, "--world", &world, "--seconds", "1", "-o", &out, "--json"];
        sinew(&[&arguments[..], extra].concat())
    };
    let notes = bake(&[]).json()["notes"].to_string();
    let (_, stands) = notes.split_once("it stands at ").expect("the note names a position");
    let (place, _) = stands.split_once(", the free place").expect("the note gives the reason");
    let at: Vec<f32> = place.split(',').map(|number| number.parse().expect("a number")).collect();
    assert!((12.0..20.0).contains(&at[0]) && at[1] == 7.0 && at[2].abs() < 4.0, "{at:?}");
    // Below the roof there is 1.7 m, too little for a fall. An explicit position is used anyway, without a search.
    let under = bake(&["--at", "2,2,2"]).json();
    assert!(!under["notes"].to_string().contains("it stands at"), "{under:#}");
    assert!(under["penetration_max_m"].as_f64().expect("a number") < 0.05, "{under:#}");
    let beside = bake(&["--at", "200,0,0"]);
    assert!(beside.refusal(1).contains("no ground under the character at 200,0,0; --floor Y"), "{beside:?}");
    let floored = bake(&["--at", "200,0,0", "--floor", "-0.02"]).json();
    assert!(floored["first_contact_s"].is_number(), "{floored:#}");
}

#[test]
fn fall_depends_on_facing_and_not_on_height() {
    let folder = Folder::new("facing");
    let (file, out) = (folder.mannequin(), folder.path("out.glb"));
    let notes = |extra: &[&str]| {
        let arguments = ["bake", &file, "--seconds", "2", "-o", &out, "--json"];
        sinew(&[&arguments[..], extra].concat()).json()
    };
    let (plain, raised) = (notes(&[]), notes(&["--floor", "3"]));
    for key in ["first_contact_s", "penetration_max_m"] {
        let [a, b] = [&plain, &raised].map(|object| object[key].as_f64().expect("a number"));
        assert!((a - b).abs() < 0.02, "{key}: {a} and {b}");
    }
    // With other facings the push throws it on its back or face, not on its side, so the fall differs.
    assert_ne!(
        notes(&["--hit", "chest=60,0,0@0.2"])["hash"],
        notes(&["--hit", "chest=60,0,0@0.2", "--facing", "90"])["hash"]
    );
    let run = sinew(&["bake", &file, "-o", &out, "--at", "1,2"]);
    assert!(run.code == Some(2) && run.stderr.contains("must be three numbers"), "{run:?}");
}

/// Feet that are children of the root, as in rigs for inverse kinematics, fall with their legs and are written back to
/// their position in the hierarchy.
#[test]
fn feet_on_the_root_follow_their_legs_and_keep_their_parent() {
    let folder = Folder::new("feet-on-root");
    let mut rig = mannequin().rig;
    let mut model = Vec::new();
    local_to_model(&rig, &rest_pose(&rig), &Affine::IDENTITY, &mut model);
    let named = |rig: &Rig, name: &str| rig.joints.iter().position(|joint| joint.name == name).expect(name);
    let feet = ["leftFoot", "rightFoot"].map(|name| named(&rig, name));
    let shanks = feet.map(|foot| rig.joints[foot].parent.expect("a shank"));
    for foot in feet {
        // The mannequin's joints have no rest rotation.
        rig.joints[foot].rest.translation = model[foot].translation;
        rig.joints[foot].parent = None;
    }
    let [file, out] = ["feet.glb", "fall.glb"].map(|name| folder.path(name));
    fs::write(&file, glb(&rig, &[])).expect("the file can be written");
    let arguments = ["bake", &file, "--limp-at", "0", "--seconds", "3", "--no-builtin-motions"];
    let object = sinew(&[&arguments[..], &["-o", &out, "--json"]].concat()).json();
    assert!(object["skin"]["contiguous"] == true && object["verdict"] != "bad", "{object:#}");
    let Document { rig: written, clips, .. } =
        load_gltf(&out, ReadOptions::default()).expect("the glTF can be read");
    let clip = clips.last().expect("the fall");
    let mut pose = rest_pose(&written);
    let mut lowest = f32::INFINITY;
    for frame in 0..=90 {
        sample(clip, &written, frame as f32 / 30.0, Wrap::Clamp, &mut pose);
        let mut now = Vec::new();
        local_to_model(&written, &pose, &Affine::IDENTITY, &mut now);
        for (foot, shank) in feet.into_iter().zip(shanks) {
            let [foot_now, shank_now] =
                [foot, shank].map(|joint| named(&written, &rig.joints[joint].name)).map(|joint| now[joint]);
            let bound = (model[foot].translation - model[shank].translation).length();
            let length = (foot_now.translation - shank_now.translation).length();
            assert!(
                (length - bound).abs() < 2e-3,
                "frame {frame}: shank length {length} m, {bound} m in the bind pose"
            );
        }
        lowest = sinew::math::min(lowest, now[named(&written, "hips")].translation.y);
    }
    assert!(lowest < 0.4, "the character did not fall: lowest height of the hips {lowest} m");
    for foot in feet {
        let foot = named(&written, &rig.joints[foot].name);
        let above = written.joints[foot].parent.map(|joint| written.joints[joint].name.as_str());
        assert!(!matches!(above, Some("leftLowerLeg" | "rightLowerLeg")), "{above:?}");
    }
}

/// A bake with a hit, a travelling clip and a world is judged by the same thresholds as a drop test, and reports
/// violations.
#[needs_data]
#[test]
fn bake_is_judged_by_the_bars_of_a_drop() {
    let folder = Folder::new("bake-judged");
    let (character, out) = (folder.mannequin(), folder.path("fall.glb"));
    let bodies: Vec<_> = Site::CabinWithStairs.props().into_iter().map(|prop| prop.body).collect();
    let world = folder.file("cabin.json", write_world(&bodies));
    let baked = sinew(&[
        "bake",
        &character,
        "--world",
        &world,
        "--hit",
        "chest=0,0,90@1.0",
        "--seconds",
        "4",
        "-o",
        &out,
        "--json",
    ])
    .json();
    assert_eq!(baked["verdict"], "good", "{baked:#}");
    assert_eq!(baked["reasons"], serde_json::json!([]));
    let data = shared_data();
    // While motors roll the ogre over, only they add energy: the gain was once 0.15 in a step.
    let ogre = data.join("rigs_wild/ultimate_space_Enemy_Large-transformed.glb").display().to_string();
    let baked = sinew(&["bake", &ogre, "--seconds", "6", "-o", &out, "--json"]).json();
    assert!(baked["energy_gain_max"].as_f64().expect("a number") < 0.01, "{baked:#}");
    // In a drop the ogre sits upright for a second before it tips over, and falls asleep late; no other reason is
    // reported.
    let reasons = baked["reasons"].as_array().expect("reasons").iter();
    let reason_list: Vec<&str> = reasons.map(|reason| reason.as_str().expect("a sentence")).collect();
    assert!(reason_list.iter().all(|reason| reason.starts_with("time from calm")), "{baked:#}");
    assert!(baked["up_s"].is_number() && baked["verdict"] != "bad", "{baked:#}");
    // The skull's skin rests above the floor, although its bodies touch it.
    let skull = data.join("rigs_wild/platformer_game_Skull.glb").display().to_string();
    let baked =
        sinew(&["bake", &skull, "--no-builtin-motions", "--seconds", "4", "-o", &out, "--json"]).json();
    assert_eq!(baked["verdict"], "usable", "{baked:#}");
    let mut reasons = baked["reasons"].as_array().expect("reasons").iter();
    assert!(
        reasons.any(|reason| reason.as_str().is_some_and(|reason| reason.starts_with("skin: at rest"))),
        "{baked:#}"
    );
}

/// A mannequin with very stiff joints stays upright when limp: it is pushed over, unless a time to go limp or a hit is
/// given.
#[test]
fn upright_limp_character_is_pushed_over_by_default() {
    let folder = Folder::new("pushed");
    let file = folder.file("rusted.glb", glb(&mannequin().rig, &[]));
    let bones: Vec<String> = ["spine", "chest", "neck", "head", "upperLeg", "lowerLeg", "foot"]
        .into_iter()
        .map(|role| format!(r#""{role}": {{ "friction_torque": 10000 }}"#))
        .collect();
    let bones = bones.join(", ");
    let settings = format!(r#"{{ "sinew": "ragdoll-settings", "version": 1, "bones": {{ {bones} }} }}"#);
    folder.file("rusted.ragdoll.json", settings);
    let out = folder.path("out.glb");
    let baked = |extra: &[&str]| {
        let arguments = ["bake", &file, "--no-builtin-motions", "--seconds", "5", "-o", &out, "--json"];
        sinew(&[&arguments[..], extra].concat()).json()
    };
    let is_said = |object: &serde_json::Value, key: &str, what: &str| {
        let texts = object[key].as_array().expect("sentences");
        texts.iter().any(|texts| texts.as_str().is_some_and(|texts| texts.contains(what)))
    };
    let object = baked(&[]);
    assert!(is_said(&object, "notes", "it is pushed over at 0.5 s"), "{object:#}");
    assert!(!is_said(&object, "reasons", "stays upright"), "{object:#}");
    for extra in [["--limp-at", "0.5"], ["--hit", "leftHand=0,0.1,0@0.5"]] {
        let object = baked(&extra);
        assert!(!is_said(&object, "notes", "it is pushed over"), "{object:#}");
    }
    assert!(is_said(&baked(&["--limp-at", "0.5"]), "reasons", "stays upright"));
}

/// A character that lies in its file, and sinks during its clip before the fall, is placed so that its lowest point
/// touches the floor.
#[test]
fn lying_character_is_placed_with_its_lowest_point_on_the_floor() {
    let folder = Folder::new("lies");
    let mut rig = mannequin().rig;
    let root = rig.joints.iter().position(|joint| joint.parent.is_none()).expect("a root");
    let hips = rig.joints.iter().position(|joint| joint.name == "hips").expect("hips");
    let turn = Rotation::from_axis_angle(Vec3::X, -core::f32::consts::FRAC_PI_2);
    rig.joints[root].rest.rotation = turn;
    let back = Affine::from_scale_rotation_translation(Vec3::ONE, turn, Vec3::ZERO).inverse();
    for skin in &mut rig.skins {
        skin.inverse_bind.iter_mut().for_each(|inverse| *inverse = *inverse * back);
    }
    let turned = |at: &mut Vec3| *at = turn * *at;
    rig.meshes.iter_mut().flat_map(|mesh| &mut mesh.primitives).for_each(|part| {
        part.positions.iter_mut().for_each(turned);
        part.normals.iter_mut().for_each(turned);
    });
    // Down and up along the file's up axis, which is the direction of the body's back.
    let at = rig.joints[hips].rest.translation;
    let sunk = at - turn.inverse() * Vec3::Y * 0.25;
    let channel = sinew::anim::Channel {
        joint: hips,
        property: sinew::anim::Property::Translation,
        interpolation: sinew::anim::Interpolation::Linear,
        times: vec![0.0, 0.3, 0.6],
        values: [at, sunk, at].iter().flat_map(sinew::prelude::Vec3::to_array).collect(),
    };
    let clip = Clip { name: "Idle".into(), duration: 0.6, channels: vec![channel] };
    let file = folder.file("lies.glb", glb(&rig, &[clip]));
    let out = folder.path("out.glb");
    let object = sinew(&["bake", &file, "--clip", "Idle", "--seconds", "2", "-o", &out, "--json"]).json();
    let lowest = object["skin"]["standing_height_m"].as_f64().expect("a height");
    assert!(lowest.abs() < 0.02, "lowest point at {lowest} m; {object:#}");
}

#[test]
fn speed_moves_a_walk_on_the_spot_ahead() {
    let folder = Folder::new("speed");
    let (file, out) = (folder.mannequin(), folder.path("out.glb"));
    let bake = |extra: &[&str]| {
        let arguments = ["bake", &file, "--clip", "Walk", "--limp-at", "2", "--seconds", "2", "-o", &out];
        sinew(&[&arguments[..], extra].concat())
    };
    let way = |extra: &[&str]| {
        let object = bake(&[extra, &["--json"]].concat()).json();
        let Document { rig, clips, .. } =
            load_gltf(&out, ReadOptions::default()).expect("the glTF can be read");
        let (mut pose, mut model) = (rest_pose(&rig), Vec::new());
        sample(clips.last().expect("a clip"), &rig, 2.0, Wrap::Clamp, &mut pose);
        local_to_model(&rig, &pose, &Affine::IDENTITY, &mut model);
        let hips = rig.joints.iter().position(|joint| joint.name == "hips").expect("the rig has this joint");
        (model[hips].translation.z, object["notes"].to_string())
    };
    let (on_the_spot, notes) = way(&[]);
    assert!(on_the_spot.abs() < 0.2 && notes.contains("--speed feet"), "moved by {on_the_spot} m: {notes}");
    let (by_feet, notes) = way(&["--speed", "feet"]);
    assert!((1.8..4.0).contains(&by_feet) && !notes.contains("--speed"), "{by_feet} m: {notes}");
    let (given, _) = way(&["--speed", "-0.5"]);
    assert!((given + 1.0).abs() < 0.1, "{given} m");
    for (speed, says) in
        [("fast", "neither a number nor 'feet'"), ("nan", "must lie between"), ("99", "must lie between")]
    {
        let run = bake(&["--speed", speed]);
        assert!(run.code == Some(2) && run.stderr.contains(says), "{run:?}");
    }
}

/// A get-up that begins sitting used to begin in the crouch after it, to which a lying body snapped.
#[needs_data]
#[test]
fn get_up_that_begins_sitting_starts_there() {
    let folder = Folder::new("sits");
    let file = shared_data().join("rigs/kaykit_Knight.glb").display().to_string();
    let out = folder.path("out.glb");
    let baked =
        sinew(&["bake", &file, "--get-up", "Sit_Floor_StandUp", "--seconds", "7", "-o", &out]).stdout.clone();
    let moment = |what: &str| {
        let line = baked.lines().find(|line| line.ends_with(what)).unwrap_or_else(|| panic!("{baked}"));
        let seconds = line.split_whitespace().next().expect("a time");
        seconds.parse::<f32>().expect("a number")
    };
    let rises = moment("plays clip Walking_A again") - moment("gets up by clip Sit_Floor_StandUp");
    // The clip lasts 1.13 s; it was entered after 0.31 s.
    assert!(rises > 0.9, "{rises} s");
}

#[needs_data]
#[test]
fn hit_on_a_joint_without_a_body_meets_the_nearest() {
    let folder = Folder::new("bodiless");
    let file = shared_data().join("rigs/quaternius_Spider.glb").display().to_string();
    let out = folder.path("out.glb");
    let arguments = ["bake", &file, "--hit", "Body=0,0,5@0.4", "--seconds", "1", "-o", &out, "--json"];
    let notes = sinew(&arguments).json()["notes"].to_string();
    assert!(notes.contains("--hit Body: there is no such body; the nearest is hit"), "{notes}");
}
