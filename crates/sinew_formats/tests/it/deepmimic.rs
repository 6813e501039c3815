//! DeepMimic characters and clips.

use crate::data::shared_data;
use needs_data::needs_data;
use sinew_anim::{Property, Wrap, local_to_model, rest_pose, sample};
use sinew_formats::deepmimic::{
    DeepMimicCharacter, DeepMimicJoint, read_deepmimic, read_deepmimic_character,
};
use sinew_math::{Affine, Random};

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(shared_data().join("mocap").join(name)).unwrap()
}

fn humanoid() -> DeepMimicCharacter {
    read_deepmimic_character(&bytes("deepmimic_humanoid3d.txt")).unwrap()
}

/// Returns the heights of all joints at a time, metres.
fn heights(character: &DeepMimicCharacter, clip: &sinew_anim::Clip, time: f32) -> Vec<f32> {
    let mut pose = rest_pose(&character.rig);
    sample(clip, &character.rig, time, Wrap::Clamp, &mut pose);
    let mut model = Vec::new();
    local_to_model(&character.rig, &pose, &Affine::IDENTITY, &mut model);
    model.iter().map(|joint| joint.translation.y).collect()
}

#[needs_data]
#[test]
fn clips_match_the_manifest() {
    let character = humanoid();
    assert_eq!(character.rig.joints.len(), 15);
    for (name, frames, duration, wrap) in
        [("deepmimic_run.txt", 25, 0.8, Wrap::Loop), ("deepmimic_getup_faceup.txt", 227, 3.77, Wrap::Clamp)]
    {
        let found = read_deepmimic(&bytes(name), &character).unwrap();
        assert_eq!((found.clip.channels[0].times.len(), found.wrap), (frames, wrap), "{name}");
        assert!((found.clip.duration - duration).abs() < 0.01, "{name}: {}", found.clip.duration);
        // The root has two channels, fixed wrists none.
        let turning = character.joints.iter().filter(|joint| **joint != DeepMimicJoint::Fixed).count();
        assert_eq!(found.clip.channels.len(), turning + 1);
        assert!(found.clip.channels.iter().all(|c| c.times.windows(2).all(|w| w[0] < w[1])));
    }
}

/// The get-up starts on the back and ends on the feet; in the run only the feet touch the ground.
#[needs_data]
#[test]
fn heights_of_joints_match_the_motion() {
    let character = humanoid();
    let up = read_deepmimic(&bytes("deepmimic_getup_faceup.txt"), &character).unwrap().clip;
    let place = |name: &str| character.rig.joints.iter().position(|joint| joint.name == name).unwrap();
    let (neck, ankle) = (place("neck"), place("left_ankle"));
    let lying = heights(&character, &up, 0.0);
    assert!(lying[neck] < 0.5, "{lying:?}");
    let standing = heights(&character, &up, up.duration);
    assert!(standing[neck] > 1.15 && standing[ankle] < 0.2, "{standing:?}");
    let run = read_deepmimic(&bytes("deepmimic_run.txt"), &character).unwrap().clip;
    for frame in 0..25 {
        let height = heights(&character, &run, frame as f32 * 0.0333);
        assert!(height[neck] > 1.0 && height.iter().all(|&y| y > -0.02), "{height:?}");
    }
}

#[test]
fn hinge_rotates_about_z() {
    let character = br#"{"Skeleton":{"Joints":[
        {"Name":"root","Type":"none","Parent":-1,"AttachX":0,"AttachY":0,"AttachZ":0,
         "AttachThetaX":0,"AttachThetaY":0,"AttachThetaZ":0},
        {"Name":"knee","Type":"revolute","Parent":0,"AttachX":0,"AttachY":-1,"AttachZ":0,
         "AttachThetaX":0,"AttachThetaY":0,"AttachThetaZ":0.5}]}}"#;
    let character = read_deepmimic_character(character).unwrap();
    let clip = read_deepmimic(br#"{"Frames":[[0.1, 0,2,0, 1,0,0,0, 0.25]]}"#, &character).unwrap();
    let knee = clip.clip.channels.last().unwrap();
    assert_eq!((knee.joint, knee.property), (1, Property::Rotation));
    assert!((2.0 * sinew_math::trig::atan2(knee.values[2], knee.values[3]) - 0.75).abs() < 1e-6);
}

#[needs_data]
#[test]
fn errors_name_the_place() {
    let character = humanoid();
    for (text, expected) in [
        (r#"{"Frames":[]}"#, "no frames (Frames)"),
        (r#"{"Frames":[[0.1,2]]}"#, "2 numbers; a frame of this character has 44 (Frames[0])"),
        (r#"{"frames":[]}"#, "`Frames` is missing (top level)"),
        (r#"{"Frames":[["#, "not JSON: EOF while parsing a list (line 1 column 12)"),
    ] {
        assert_eq!(read_deepmimic(text.as_bytes(), &character).unwrap_err().to_string(), expected);
    }
    let still = format!("[0{}]", ",0".repeat(43));
    let text = format!(r#"{{"Frames":[{still},{still}]}}"#);
    let error = read_deepmimic(text.as_bytes(), &character).unwrap_err();
    assert_eq!(error.to_string(), "the frame has no duration (Frames[0])");
    let wrong = String::from_utf8(bytes("deepmimic_humanoid3d.txt")).unwrap();
    let said =
        |from: &str, to: &str| read_deepmimic_character(wrong.replacen(from, to, 1).as_bytes()).unwrap_err();
    assert_eq!(said("spherical", "rubber").to_string(), "a joint of type `rubber` (Skeleton.Joints[1].Type)");
    assert_eq!(
        said("\"Parent\": 0", "\"Parent\": 1").to_string(),
        "index 1 is out of range: there are 1 joints before it (Skeleton.Joints[1].Parent)"
    );
}

/// Cuts and changes files at random offsets: the result is an error or a clip, never a panic.
#[needs_data]
#[test]
fn mutated_files_do_not_panic() {
    let character = humanoid();
    let (whole, skeleton) = (bytes("deepmimic_run.txt"), bytes("deepmimic_humanoid3d.txt"));
    let cases = if std::env::var_os("SINEW_FULL").is_some() { 2000 } else { 200 };
    let mut random = Random::new(9);
    for _ in 0..cases {
        let (mut clip, mut body) = (whole.clone(), skeleton.clone());
        for bytes in [&mut clip, &mut body] {
            for _ in 0..=random.index(4) {
                let at = random.index(bytes.len());
                bytes[at] = random.index(256) as u8;
            }
        }
        let _ = read_deepmimic(&clip, &character);
        if let Ok(body) = read_deepmimic_character(&body) {
            let _ = read_deepmimic(&whole, &body);
        }
        assert!(read_deepmimic(&whole[..random.index(whole.len() - 5)], &character).is_err());
    }
}
