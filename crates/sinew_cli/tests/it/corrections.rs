//! User corrections: roles, ignored bones, bones with or without bodies, and inexact names.

use crate::sinew::{Folder, glb, shared_data, sinew};
use needs_data::needs_data;
use serde_json::Value;
use sinew::anim::{Clip, Rig};
use sinew_scenes::mannequin::mannequin;

/// The mannequin with numbers for joint names, and its walk.
fn numbered(folder: &Folder) -> (String, Rig) {
    let mannequin = mannequin();
    let mut rig = mannequin.rig;
    rig.joints.iter_mut().enumerate().for_each(|(i, joint)| joint.name = format!("Bone_{i}"));
    let walk = Clip { name: "Armature|Walk_Loop".into(), ..mannequin.clips[mannequin.motions.walk].clone() };
    let idle = Clip { name: "Armature|Idle_Loop".into(), ..walk.clone() };
    (folder.file("numbered.glb", glb(&rig, &[idle, walk])), rig)
}

fn bodies(object: &Value) -> Vec<(String, String)> {
    let text = |body: &Value, key: &str| body[key].as_str().expect("a string").to_owned();
    let bodies = object["bodies"].as_array().expect("bodies");
    bodies.iter().map(|body| (text(body, "role"), text(body, "bone"))).collect()
}

fn bone_of(bodies: &[(String, String)], role: &str) -> Option<String> {
    bodies.iter().find(|(own, _)| own == role).map(|(_, bone)| bone.clone())
}

#[test]
fn given_roles_are_used() {
    let folder = Folder::new("said-roles");
    let (file, _) = numbered(&folder);
    let build = |extra: &[&str]| sinew(&[&["ragdoll", "build", &file, "--json"], extra].concat());
    let before = bodies(&build(&[]).json());
    let [chest, spine] = ["chest", "spine"].map(|role| bone_of(&before, role).expect("a part of the trunk"));
    // The two parts of the trunk get each other's roles. The given roles are used with full confidence.
    let object =
        build(&["--role", &format!("upperChest={chest}"), "--role", &format!("Chest={spine}")]).json();
    let after = bodies(&object);
    assert_eq!(bone_of(&after, "upperChest"), Some(chest.clone()));
    assert_eq!(bone_of(&after, "chest"), Some(spine.clone()));
    assert_eq!((bone_of(&after, "spine"), after.len()), (None, before.len()));
    let body = object["bodies"].as_array().expect("bodies").iter().find(|body| body["role"] == "chest");
    assert_eq!(body.expect("a chest")["confidence"], 1.0);
    // The same by a settings file beside the character, which `bake` and the doctor read as well.
    let settings = format!(
        r#"{{"sinew":"ragdoll-settings","version":1,"bones":{{"{chest}":{{"role":"upperChest"}},"{spine}":{{"role":"chest"}}}}}}"#
    );
    folder.file("numbered.ragdoll.json", settings);
    assert_eq!(bodies(&build(&[]).json()), after);
    let out = folder.path("out.glb");
    let run = sinew(&["bake", &file, "--hit", "spine=0,0,9@0.1", "--seconds", "0.2", "-o", &out, "--json"]);
    let notes = run.json()["notes"].to_string();
    assert!(notes.contains("--hit spine: there is no such body; the nearest is hit, "), "{notes}");
    assert_eq!(sinew(&["ragdoll", "doctor", &file, "--json"]).code, Some(0));
}

#[test]
fn ignored_bones_and_body_choices_are_applied() {
    let folder = Folder::new("said-bodies");
    let (file, _) = numbered(&folder);
    let build =
        |extra: &[&str]| bodies(&sinew(&[&["ragdoll", "build", &file, "--json"], extra].concat()).json());
    let before = build(&[]);
    let forearm = bone_of(&before, "leftLowerArm").expect("a forearm");
    let hand = bone_of(&before, "leftHand").expect("a hand");
    let without = build(&["--no-body", "hand"]);
    assert_eq!(without.len() + 2, before.len(), "a role without a side must stand for both sides");
    let stump = build(&["--ignore", &hand]);
    assert!(stump.iter().all(|(_, bone)| *bone != hand), "{stump:?}");
    assert!(stump.iter().any(|(_, bone)| *bone == forearm), "{stump:?}");
    // Its descendants are ignored as well.
    let shorter = build(&["--ignore", &forearm]);
    assert!(shorter.iter().all(|(_, bone)| *bone != forearm && *bone != hand), "{shorter:?}");
    let arm = bone_of(&before, "leftUpperArm").expect("an arm");
    assert!(shorter.iter().any(|(_, bone)| *bone == arm), "{shorter:?}");
    assert_eq!(build(&["--body", &forearm]), before, "a bone with a body must keep it");
    for command in [["bake"].as_slice(), &["ragdoll", "doctor"], &["ragdoll", "export"]] {
        let run = sinew(&[command, &["--help"]].concat());
        for option in ["--role", "--ignore", "--body", "--no-body", "--height", "--unit", "--mass"] {
            assert!(run.stdout.contains(option), "{command:?} has no {option}");
        }
    }
}

/// Every command that builds a ragdoll applies every correction.
#[test]
fn every_build_command_applies_every_correction() {
    let folder = Folder::new("said-everywhere");
    let (file, _) = numbered(&folder);
    let hand =
        bone_of(&bodies(&sinew(&["ragdoll", "build", &file, "--json"]).json()), "leftHand").expect("a hand");
    let (fall, model) = (folder.path("fall.glb"), folder.path("body.xml"));
    let commands: [&[&str]; 4] = [
        &["ragdoll", "build", &file, "--json"],
        &["bake", &file, "--seconds", "0.3", "--limp-at", "0", "-o", &fall, "--json"],
        &["ragdoll", "doctor", &file, "--json"],
        &["ragdoll", "export", &file, "--as", "mjcf", "-o", &model, "--json"],
    ];
    for command in commands {
        let run = |extra: &[&str]| {
            let mut object = sinew(&[command, extra].concat()).json();
            // Timings differ from run to run.
            if let Some(object) = object.as_object_mut() {
                object.retain(|key, _| !["realtime_factor", "build_ms"].contains(&key.as_str()));
            }
            // The model file contains values that the report omits.
            (object, std::fs::read(&model).unwrap_or_default())
        };
        let plain = run(&[]);
        let measures = [["--height", "1.2"], ["--unit", "0.7"], ["--mass", "4000"]];
        let bones = [["--no-body", "hand"], ["--ignore", hand.as_str()]];
        // The doctor reports nothing about missing hands.
        let of_bones = if command.contains(&"doctor") { &[][..] } else { &bones[..] };
        for extra in measures.iter().chain(of_bones) {
            assert_ne!(run(extra), plain, "{command:?} ignores {extra:?}");
        }
        let odd = ["--role", "hips=Bnoe_0"];
        assert!(sinew(&[command, &odd].concat()).refusal(1).ends_with("(--role hips=Bnoe_0)"), "{command:?}");
    }
}

#[test]
fn unknown_names_are_reported_with_the_nearest() {
    let folder = Folder::new("said-names");
    let (file, rig) = numbered(&folder);
    let line =
        |extra: &[&str]| sinew(&[&["ragdoll", "build", file.as_str()], extra].concat()).refusal(1).to_owned();
    // The file also has a node for the mesh.
    let near = format!("the nearest of {} are Bone_0, Bone_1, Bone_2", rig.joints.len() + 1);
    assert_eq!(
        line(&["--role", "hips=Bnoe_0"]),
        format!("error: {file}: no bone `Bnoe_0`; {near} (--role hips=Bnoe_0)")
    );
    assert_eq!(
        line(&["--ignore", "Bnoe_0"]),
        format!("error: {file}: no bone `Bnoe_0`; {near} (--ignore Bnoe_0)")
    );
    for option in ["--body", "--no-body"] {
        let line = line(&[option, "lefthnd"]);
        assert!(line.contains("no bone or role `lefthnd`; the nearest of "), "{line}");
        assert!(line.contains(" are leftHand, ") && line.ends_with(&format!("({option} lefthnd)")), "{line}");
    }
    let run = sinew(&["ragdoll", "build", &file, "--role", "hisp=Bone_0"]);
    assert!(
        run.code == Some(2) && run.stderr.contains("no role `hisp`; the nearest of 22 are hips, "),
        "{run:?}"
    );
    let twice = ["ragdoll", "build", &file, "--role", "hips=Bone_0", "--role", "hips=Bone_1"];
    assert!(sinew(&twice).refusal(2).contains("--role hips=Bone_1 is given twice"));
    let all = line(&["--ignore", "Bone_0"]);
    assert!(all.ends_with("nothing that moves skin is left (--ignore)"), "{all}");
}

#[test]
fn clips_are_found_by_words_ignoring_case() {
    let folder = Folder::new("said-clips");
    let (file, _) = numbered(&folder);
    let out = folder.path("out.glb");
    let bake = |clip: &str| {
        sinew(&["bake", &file, "--clip", clip, "--seconds", "0.1", "--limp-at", "0", "-o", &out])
    };
    for clip in ["Armature|Walk_Loop", "armature|walk_loop", "walk", "Walk Loop", "1"] {
        assert_eq!(bake(clip).code, Some(0), "{clip}");
    }
    let line = bake("loop").refusal(1).to_owned();
    assert!(
        line.contains("'loop' matches 2 clips: Armature|Idle_Loop, Armature|Walk_Loop (--clip)"),
        "{line}"
    );
    let bvh = folder.path("walk.bvh");
    assert_eq!(sinew(&["convert", &file, "--clip", "WALK", &bvh]).code, Some(0));
}

#[test]
fn hit_on_a_bone_without_body_uses_the_nearest_with_a_note() {
    let folder = Folder::new("said-hits");
    let (file, _) = numbered(&folder);
    let out = folder.path("out.glb");
    let baked = |extra: &[&str], hit: &str| {
        let hit = format!("{hit}=0,0,9@0.1");
        let base = ["bake", &file, "--seconds", "0.2", "-o", &out, "--json", "--hit", &hit];
        sinew(&[&base, extra].concat()).json()
    };
    let hits = |object: &Value| object["notes"].to_string().matches("--hit ").count();
    assert_eq!(hits(&baked(&[], "chest")), 0);
    assert_eq!(hits(&baked(&[], "CHEST")), 0, "roles have no case");
    let gone = ["--no-body", "chest"];
    let object = baked(&gone, "chest");
    assert!(
        object["notes"].to_string().contains("--hit chest: it moves with the body of spine")
            || hits(&object) == 1,
        "{object:#}"
    );
    let object = baked(&["--no-body", "hand"], "leftHand");
    assert!(object["notes"].to_string().contains("leftLowerArm"), "{object:#}");
    assert_eq!(hits(&baked(&[], "leftToes")), 1);
}

/// A creature has spine roles with other names.
#[needs_data]
#[test]
fn hit_on_the_chest_of_a_creature_uses_its_spine() {
    let data = shared_data();
    let folder = Folder::new("said-fox");
    let (file, out) = (data.join("rigs/Fox.glb").display().to_string(), folder.path("out.glb"));
    let run = |hit: &str| sinew(&["bake", &file, "--hit", hit, "--seconds", "0.2", "-o", &out, "--json"]);
    let object = run("chest=0,0,2@0.1").json();
    let notes = object["notes"].to_string();
    assert!(notes.contains("--hit chest: there is no such body; the nearest is hit, spine_"), "{notes}");
    let line = run("leftHand=0,0,2@0.1").refusal(1).to_owned();
    assert!(line.contains("no bone 'leftHand' to hit; the nearest of "), "{line}");
}

/// Two mannequins in one file, the second half as tall and a metre aside.
fn couple() -> Rig {
    let mut rig = mannequin().rig;
    let mut child = rig.clone();
    let (joints, skins) = (rig.joints.len(), rig.skins.len());
    for joint in &mut child.joints {
        joint.rest.translation *= 0.6;
        match &mut joint.parent {
            Some(parent) => *parent += joints,
            None => joint.rest.translation.x += 1.0,
        }
        joint.source += joints;
        joint.name += "_child";
    }
    for skin in &mut child.skins {
        skin.joints.iter_mut().for_each(|joint| *joint += joints);
        skin.inverse_bind.iter_mut().for_each(|bind| bind.translation *= 0.6);
    }
    for mesh in &mut child.meshes {
        mesh.joint += joints;
        mesh.skin = mesh.skin.map(|skin| skins + skin);
        let positions = mesh.primitives.iter_mut().flat_map(|primitive| &mut primitive.positions);
        positions.for_each(|position| *position *= 0.6);
    }
    rig.joints.extend(child.joints);
    rig.skins.extend(child.skins);
    rig.meshes.extend(child.meshes);
    rig.stated_roles.clear();
    rig
}

#[test]
fn character_option_picks_one_of_several() {
    let folder = Folder::new("couple");
    let file = folder.file("couple.glb", glb(&couple(), &[]));
    let build = |extra: &[&str]| sinew(&[&["ragdoll", "build", &file, "--json"], extra].concat());
    let height = |object: &Value| object["height_m"].as_f64().expect("a height");
    let [first, second] = ["1", "2"].map(|number| build(&["--character", number]).json());
    assert!((height(&second) / height(&first) - 0.6).abs() < 0.01, "{} {}", height(&first), height(&second));
    assert_eq!(bodies(&first).len(), bodies(&second).len());
    assert!(bodies(&second).iter().all(|(_, bone)| bone.ends_with("_child")), "{second:#}");
    let note = "there are 2 characters in the file, and this is number 1: --character 1 to 2 picks one";
    assert!(build(&[]).json()["notes"].to_string().contains(note));
    assert!(!first["notes"].to_string().contains("--character"));
    let third = build(&["--character", "3"]);
    let refused = third.refusal(1);
    assert!(refused.ends_with("there is no character 3 but 2 characters (--character)"), "{refused}");
    let out = folder.path("fall.glb");
    let baked = sinew(&["bake", &file, "--character", "2", "--seconds", "1", "-o", &out, "--json"]).json();
    assert_eq!(baked["bodies"].as_u64(), Some(bodies(&second).len() as u64));
}
