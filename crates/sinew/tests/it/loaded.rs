//! Characters from a file in one call.

use crate::your_character;
use sinew::anim::{Clip, Rig};
use sinew::formats::{Container, Document, ReadOptions, no_files, read_gltf, write_gltf};
use sinew::mannequin::{Mannequin, WALK_SPEED, mannequin};
use sinew::ragdoll::{AfterSettling, Locomotion, Settings};
use sinew::{LoadedCharacter, character_of, load_character};

fn read(rig: &Rig, clips: &[Clip]) -> Document {
    let bytes = write_gltf(rig, clips).expect("the rig can be written as glTF");
    read_gltf(&bytes, ReadOptions::default(), &mut no_files).expect("the glTF can be read")
}

fn loaded(rig: &Rig, clips: &[Clip]) -> LoadedCharacter {
    character_of(read(rig, clips), "hero.glb", &Settings::default()).expect("a character")
}

#[test]
fn clips_of_a_file_are_recognised() {
    let Mannequin { rig, clips, motions } = mannequin();
    // Another order of the clips, as files may have it.
    let order = [motions.get_up_prone, motions.idle, motions.walk, motions.get_up_supine];
    let shuffled: Vec<Clip> = order.map(|clip| clips[clip].clone()).to_vec();
    let hero = loaded(&rig, &shuffled);
    let own = hero.def.motions();
    assert_eq!((own.looped, own.idle, own.get_ups.as_slice()), (Some(2), Some(1), &[0, 3][..]));
    assert_eq!(hero.def.after_settling, AfterSettling::GetUp);
    let Locomotion::Forward { speed } = own.locomotion else { panic!("{:?}", own.locomotion) };
    assert!((speed - WALK_SPEED).abs() < 0.05, "an in-place walk moves at {speed} m/s");
    let steps: Vec<&str> = own.events.iter().map(|(_, event)| event.payload.as_str()).collect();
    assert_eq!(steps, ["left", "right"], "{:?}", own.events);
    assert!(own.events.iter().all(|(clip, event)| *clip == 2 && event.name == "footstep"));
}

#[test]
fn missing_motions_are_built_in_and_noted() {
    let hero = loaded(&mannequin().rig, &[]);
    let own = hero.def.motions();
    assert!(own.looped.is_some() && own.idle.is_some() && own.get_ups.len() == 2);
    assert_eq!(own.events.len(), 2, "footsteps of the built-in walk: {:?}", own.events);
    for said in ["it walks by the built-in motions", "it gets up by the built-in motions"] {
        assert!(hero.notes.iter().any(|note| note == said), "{said}: {:?}", hero.notes);
    }
}

#[test]
fn shortest_idle_name_wins_and_a_held_pose_is_not_a_walk() {
    let Mannequin { rig, clips, motions } = mannequin();
    let named = |clip: usize, name: &str| Clip { name: name.to_owned(), ..clips[clip].clone() };
    let mut held = named(motions.walk, "Walk_Pose");
    for channel in &mut held.channels {
        let width = channel.property.width();
        channel.times.truncate(1);
        channel.values.truncate(width);
    }
    let all =
        [held, named(motions.idle, "2H_Idle"), named(motions.idle, "Idle"), named(motions.walk, "Walking_A")];
    let hero = loaded(&rig, &all);
    assert_eq!((hero.def.motions().looped, hero.def.motions().idle), (Some(3), Some(2)), "{:?}", hero.notes);
}

#[test]
fn run_is_blended_with_the_walk() {
    let Mannequin { rig, clips, motions } = mannequin();
    let run = sinew::mannequin::drills::running().clip;
    let named = |clip: &Clip, name: &str| Clip { name: name.to_owned(), ..clip.clone() };
    let back = named(&run, "Run_Back");
    let all = [back, named(&run, "Running_A"), named(&clips[motions.walk], "Walking_A")];
    let hero = loaded(&rig, &all);
    let own = hero.def.motions();
    assert_eq!(
        (own.looped, own.faster.as_slice()),
        (Some(2), &[(1, Locomotion::ByClip)][..]),
        "{:?}",
        hero.notes
    );
    let sides = |clip: usize| -> Vec<&str> {
        let of = own.events.iter().filter(|(index, _)| *index == clip);
        of.map(|(_, event)| event.payload.as_str()).collect()
    };
    assert_eq!((sides(2), sides(1)), (vec!["left", "right"], vec!["left", "right"]));
}

#[test]
fn file_without_a_skin_is_rejected_by_name() {
    let rig = Rig { meshes: Vec::new(), ..mannequin().rig };
    let document = read(&rig, &[]);
    assert_eq!(document.container, Container::Glb);
    let error = character_of(document, "crate.glb", &Settings::default()).expect_err("the file has no skin");
    assert!(error.to_string().starts_with("crate.glb: "), "{error}");
    let error = load_character("no/such.glb").expect_err("there is no such file");
    assert!(error.to_string().starts_with("no/such.glb: "), "{error}");
}

#[test]
fn settings_beside_a_file_are_applied() {
    let path = std::env::temp_dir().join(format!("sinew_loaded_{}.glb", std::process::id()));
    let own = mannequin();
    std::fs::write(&path, write_gltf(&own.rig, &own.clips).expect("the rig can be written as glTF"))
        .expect("a file");
    let beside = sinew::formats::settings_path(&path);
    std::fs::write(&beside, r#"{"sinew": "ragdoll-settings", "version": 1, "mass": 55}"#)
        .expect("the file can be written");
    let hero = load_character(&path).expect("a character");
    std::fs::remove_file(&beside).expect("the file can be removed");
    std::fs::remove_file(&path).expect("the file can be removed");
    assert!((hero.def.ragdoll.total_mass - 55.0).abs() < 1e-3, "{} kg", hero.def.ragdoll.total_mass);
}

#[test]
fn example_character_walks_falls_and_gets_up() {
    your_character::run(your_character::mannequin());
}
