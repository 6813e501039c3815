//! Runs the commands of the README in order, as a reader would.

use crate::sinew::{Folder, Run, command, shared_data};
use needs_data::needs_data;
use std::fs;

const README: &str = include_str!("../../../../README.md");

/// Text before the arguments of `sinew` in the README.
const LEAD: &str = "cargo run --release -- ";

/// Arguments of the commands below a heading, without comments.
fn lines(heading: &str) -> Vec<Vec<&'static str>> {
    let (_, rest) = README.split_once(heading).unwrap_or_else(|| panic!("no heading {heading}"));
    let (_, block) = rest.split_once("```sh\n").expect("a block of commands");
    let (block, _) = block.split_once("```").expect("the block ends");
    let lines = block.lines().filter_map(|line| line.strip_prefix(LEAD));
    lines.map(|line| line.split('#').next().unwrap_or(line).split_whitespace().collect()).collect()
}

#[needs_data]
#[test]
fn readme_commands_run_in_order() {
    let data = shared_data();
    for rig in ["rigs/quaternius_cyberpunk_Character.glb", "rigs_wild/platformer_game_Character.glb"] {
        let folder = Folder::new("readme");
        let copy = |from: &str, to: &str| {
            fs::copy(data.join(from), folder.path(to)).unwrap_or_else(|error| panic!("{from}: {error}"));
        };
        copy(rig, "character.glb");
        copy("mocap/cmu_12_01_walk.bvh", "walk.bvh");
        copy("worlds/house_2story_stairs.glb", "house.glb");
        let own = lines("## With your own character");
        let others = lines("## The experiments, and a world from a mesh");
        assert!(own.len() >= 7 && others.len() >= 4, "the README has fewer commands than expected");
        // Windows need a display: `window.rs` tests them.
        let opens_window = |line: &&Vec<&str>| {
            line[0] == "view" && !line.iter().any(|part| ["--picture", "--movie"].contains(part))
        };
        for arguments in own.iter().chain(&others).filter(|line| !opens_window(line)) {
            let run = Run::of(command(arguments).current_dir(folder.path("")));
            assert_eq!(run.code, Some(0), "{rig}: sinew {}\n{}", arguments.join(" "), run.stderr);
        }
        for written in
            ["character.sinew.json", "character.xml", "fall.glb", "fall.gif", "walking.glb", "walking.bvh"]
        {
            assert!(folder.names().iter().any(|name| name == written), "{rig}: no {written}");
        }
    }
}
