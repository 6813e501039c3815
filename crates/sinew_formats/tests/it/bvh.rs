//! BVH: real files, files with every variation, and round trips.

use crate::data::{files, shared_data};
use needs_data::needs_data;
use sinew_anim::{
    Channel, Clip, Interpolation, Joint, LocalTransform, Property, Rig, Wrap, local_to_model, sample,
};
use sinew_formats::bvh::{
    BvhChannel, BvhDocument, BvhEnds, BvhOptions, BvhRows, BvhUnit, BvhWriteOptions, RestFrame, read_bvh,
    write_bvh,
};
use sinew_math::{Affine, EulerOrder, Random, Rotation, Vec3};

const AS_IT_IS: BvhOptions =
    BvhOptions { unit: BvhUnit::Infer, rest_frame: RestFrame::Keep, rows: BvhRows::AsDeclared };

fn read(text: &str) -> BvhDocument {
    read_bvh(text.as_bytes(), BvhOptions { unit: BvhUnit::Metres(1.0), ..AS_IT_IS }).unwrap()
}

/// Returns the error of the reader for a text, or "" if the text is accepted.
fn complaint(text: &str) -> String {
    read_bvh(text.as_bytes(), AS_IT_IS).err().map(|e| e.to_string()).unwrap_or_default()
}

fn shared(name: &str, options: BvhOptions) -> BvhDocument {
    let path = shared_data().join("mocap").join(name);
    read_bvh(&std::fs::read(path).unwrap(), options).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn pose(document: &BvhDocument, frame: usize) -> Vec<LocalTransform> {
    let mut out = sinew_anim::rest_pose(&document.rig);
    let time = (frame as f64 * document.frame_time) as f32;
    sample(&document.clip, &document.rig, time, Wrap::Clamp, &mut out);
    out
}

fn model(rig: &Rig, pose: &[LocalTransform]) -> Vec<Affine> {
    let mut out = Vec::new();
    local_to_model(rig, pose, &Affine::IDENTITY, &mut out);
    out
}

const TWO_JOINTS: &str = "HIERARCHY
ROOT hips
{
    OFFSET 0 1 0
    CHANNELS 6 Zrotation Xrotation Yrotation Xposition Yposition Zposition
    JOINT arm
    {
        OFFSET 2 0 0
        CHANNELS 3 Yrotation Zrotation Xrotation
        End Site
        {
            OFFSET 1 0 0
        }
    }
}
MOTION
Frames: 2
Frame Time: 0.5
90 0 0 5 6 7 0 0 0
0 90 0 5 6 7 90 90 0
";

#[test]
fn channels_rotate_in_file_order() {
    let found = read(TWO_JOINTS);
    let at = |frame: usize, joint: usize| model(&found.rig, &pose(&found, frame))[joint].translation;
    let near = |a: Vec3, b: [f32; 3]| assert!((a - Vec3::from_array(b)).length() < 1e-5, "{a}");
    // A quarter turn about z moves the arm from x up to y.
    near(at(0, 1), [5.0, 8.0, 7.0]);
    near(at(0, 2), [5.0, 9.0, 7.0]);
    // The arm turns about y, then about its new z, which moves its end from x to y. The hips' turn about x moves it
    // to z.
    near(at(1, 1), [7.0, 6.0, 7.0]);
    near(at(1, 2), [7.0, 6.0, 8.0]);
    assert_eq!((found.frames, found.clip.duration), (2, 0.5));
    let names: Vec<&str> = found.rig.joints.iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["hips", "arm", ""]);
}

#[test]
fn every_order_of_every_number_of_channels_is_read() {
    let mut random = Random::new(3);
    let orders = EulerOrder::ALL.into_iter().filter(|order| !order.is_proper());
    for (order, count) in orders.flat_map(|order| [(order, 1), (order, 2), (order, 3)]) {
        let axes = &order.indices()[..count];
        let names: Vec<&str> = axes.iter().map(|&axis| BvhChannel::rotation(axis).name()).collect();
        let angles: Vec<f32> = axes.iter().map(|_| random.range(-400.0, 400.0)).collect();
        let row: Vec<String> = angles.iter().map(f32::to_string).collect();
        let text = format!(
            "HIERARCHY ROOT a {{ OFFSET 0 0 0 CHANNELS {count} {} }} MOTION Frames: 1 Frame Time: 1\n{}",
            names.join(" "),
            row.join(" ")
        );
        let found = pose(&read(&text), 0)[0].rotation;
        let expected = axes.iter().zip(angles).fold(Rotation::IDENTITY, |outer, (&axis, angle)| {
            outer * Rotation::from_axis_angle(Vec3::AXES[axis], angle.to_radians())
        });
        assert!(found.angle_to(expected) < 3e-6, "{text}");
    }
}

#[test]
fn white_space_case_and_line_ends_are_ignored() {
    let expected = read(TWO_JOINTS);
    let variants = [
        TWO_JOINTS.replace('\n', "\r\n"),
        TWO_JOINTS.replace('\n', "\r"),
        TWO_JOINTS.replace("    ", "\t").replace("\n0 90 0", "\n\t 0\t90  0\t"),
        TWO_JOINTS.replace("\n{", " {").replace("Frames:", "\n\nFRAMES :"),
        format!(
            "\u{feff}{}\n\n",
            TWO_JOINTS.replace("Zrotation", "ZROTATION").replace("End Site", "End site")
        ),
    ];
    for text in variants {
        assert_eq!(read(&text), expected, "{text:?}");
    }
}

#[test]
fn positions_of_any_joint_are_read_in_both_conventions() {
    let text = |position: &str| {
        format!(
            "HIERARCHY ROOT a {{ OFFSET 0 0 0 CHANNELS 3 Zrotation Yrotation Xrotation
            JOINT b {{ OFFSET 0 10 0 CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation }} }}
            MOTION Frames: 1 Frame Time: 1\n0 0 0 {position} 0 0 0"
        )
    };
    let at = |position: &str| {
        let found = read(&text(position));
        (pose(&found, 0)[1].translation.to_array(), found.notes.len())
    };
    assert_eq!(at("1 11 0"), ([1.0, 11.0, 0.0], 0));
    assert_eq!(at("1 0.5 0"), ([1.0, 10.5, 0.0], 1));
}

#[test]
fn errors_name_the_line() {
    let replaced = |from: &str, to: &str| complaint(&TWO_JOINTS.replacen(from, to, 1));
    for (from, to, expected) in [
        ("HIERARCHY", "hello", "not a BVH file: does not begin with `HIERARCHY` (line 1)"),
        ("ROOT hips", "ROOT", "a joint without a name (line 2)"),
        ("JOINT arm", "JOIN arm", "expected `}`, `JOINT` or `End Site`, found `JOIN` (line 6)"),
        ("OFFSET 2", "OFFSET two", "an offset: `two` is not a number (line 8)"),
        ("CHANNELS 3", "CHANNELS 4", "unknown channel `End` (line 10, joint `arm`)"),
        (
            "CHANNELS 3",
            "CHANNELS 4000000000",
            "4000000000 channels; a joint has 0 to 6 (line 9, joint `arm`)",
        ),
        ("Yrotation Zrotation", "Yrotation Wrotation", "unknown channel `Wrotation` (line 9, joint `arm`)"),
        ("Yrotation Zrotation", "Yrotation Yrotation", "`Yrotation` is listed twice (line 9, joint `arm`)"),
        ("Frames: 2", "Frames: 4000000000", "declares 4000000000 frames, has 2 (line 20)"),
        ("Frames: 2", "Frames: 1", "declares 1 frames, has 2 (line 20)"),
        ("Frames: 2", "Frames: -2", "-2 is not a number of frames (line 17)"),
        ("Frame Time: 0.5", "Frame Time: 0", "a frame time of 0 s (line 18)"),
        ("Frame Time: 0.5", "Frame Time: nan", "the frame time: `nan` is not finite (line 18)"),
        ("90 0 0 5", "90 0 NaN 5", "`NaN` is not finite (line 19, Yrotation of `hips`)"),
        ("90 0 0 5", "90 0 0,5 5", "`0,5` is not a number (line 19, Yrotation of `hips`)"),
        ("90 0 0 5", "1e39 0 0 5", "`1e39` is not finite (line 19, Zrotation of `hips`)"),
        ("90 0 0 5", "90 0 5", "8 numbers in a row of 9 (line 19)"),
        ("90 0 0 5", "90 0 0 0 5", "10 numbers in a row of 9 (line 19)"),
    ] {
        assert_eq!(replaced(from, to), expected);
    }
    assert_eq!(complaint("HIERARCHY\nMOTION"), "no joints (line 2)");
    assert_eq!(complaint("HIERARCHY ROOT a {}\nMOTION"), "no joint has a channel (line 2)");
    let (start, _) = TWO_JOINTS.split_once("90 0 0").unwrap();
    assert_eq!(complaint(start), "no frames (line 18)");
}

#[test]
fn missing_and_extra_rows_are_reported() {
    let options = BvhOptions { rows: BvhRows::AsPresent, ..AS_IT_IS };
    for (declared, note) in [(5, "declares 5 frames, has 2"), (1, "declares 1 frames, has 2")] {
        let text = TWO_JOINTS.replace("Frames: 2", &format!("Frames: {declared}"));
        let found = read_bvh(text.as_bytes(), options).unwrap();
        assert_eq!(found.frames, 2);
        assert!(found.notes.iter().any(|said| said.starts_with(note)), "{:?}", found.notes);
    }
}

#[test]
fn file_with_100_000_nested_joints_round_trips() {
    const DEEP: usize = 100_000;
    let text = format!(
        "HIERARCHY ROOT r {{ OFFSET 0 0 0 CHANNELS 1 Xrotation {} {} }} MOTION Frames: 1 Frame Time: 1\n7",
        "JOINT j { OFFSET 0 1 0 ".repeat(DEEP),
        "}".repeat(DEEP)
    );
    let found = read(&text);
    assert_eq!(found.rig.joints.len(), DEEP + 1);
    let again = write_bvh(&found.rig, &found.clip, &options_of(&found)).unwrap();
    assert!(again.text.len() < 300 * DEEP, "{}", again.text.len());
    assert_eq!(read(&again.text).rig.joints.len(), DEEP + 1);
    // Any number of open braces alone is rejected.
    assert!(!complaint(&"HIERARCHY ROOT r {".repeat(DEEP)).is_empty());
}

#[needs_data]
#[test]
fn units_follow_from_bone_lengths() {
    for (name, metres) in [
        ("cmu_12_01_walk.bvh", 0.0254 / 0.45),
        ("cmu_01_01_jumps.bvh", 0.0254 / 0.45),
        ("cmu_02_03_run_iclone.bvh", 0.01),
        ("mixed_rotation_orders.bvh", 0.0254),
        ("sinusoidal.bvh", 0.01),
    ] {
        let found = shared(name, BvhOptions::default());
        assert!((found.metres_per_unit - metres).abs() < 1e-6, "{name}: {:?}", found.notes);
    }
    let options = BvhOptions { unit: BvhUnit::Metres(0.5), ..AS_IT_IS };
    assert_eq!(shared("cmu_12_01_walk.bvh", options).metres_per_unit, 0.5);
}

#[needs_data]
#[test]
fn rest_pose_before_a_motion_is_found() {
    let found = shared("cmu_12_01_walk.bvh", BvhOptions::default());
    assert_eq!((found.frames, found.clip.channels[0].times.len()), (523, 523));
    assert!(found.rest_pose.is_some());
    assert!((found.clip.duration - 522.0 / 120.0).abs() < 1e-5);
    let kept = shared("cmu_12_01_walk.bvh", AS_IT_IS);
    assert_eq!(kept.frames, 524);
    let stated = kept.rest_pose.as_ref().unwrap();
    assert!(pose(&kept, 0).iter().zip(stated).all(|(a, b)| a.rotation.angle_to(b.rotation) < 1e-5));
    for name in
        ["cmu_02_03_run_iclone.bvh", "mixed_rotation_orders.bvh", "sinusoidal.bvh", "rotation_first_root.bvh"]
    {
        let other = shared(name, BvhOptions::default());
        assert!(other.rest_pose.is_none(), "{name}: {:?}", other.notes);
    }
    assert!(shared("cmu_01_01_jumps.bvh", BvhOptions::default()).rest_pose.is_some());
}

fn options_of(document: &BvhDocument) -> BvhWriteOptions<'_> {
    BvhWriteOptions {
        frame_time: document.frame_time,
        metres_per_unit: document.metres_per_unit,
        channels: Some(&document.channels),
        ..BvhWriteOptions::default()
    }
}

/// Returns the largest difference of two motions of one skeleton over all frames: radians, metres. Compares in model
/// space, so that rigs whose joints have other rest axes may have the same motion.
fn difference(a: &BvhDocument, b: &BvhDocument) -> (f32, f32) {
    assert_eq!(a.frames, b.frames);
    let (mut turn, mut shift) = (0.0, 0.0);
    for frame in 0..a.frames {
        let (x, y) = (model(&a.rig, &pose(a, frame)), model(&b.rig, &pose(b, frame)));
        let (p, q) = (pose(a, frame), pose(b, frame));
        for i in 0..x.len() {
            turn = sinew_math::max(turn, p[i].rotation.angle_to(q[i].rotation));
            shift = sinew_math::max(shift, (p[i].translation - q[i].translation).length());
            shift = sinew_math::max(shift, (x[i].translation - y[i].translation).length());
        }
    }
    (turn, shift)
}

#[needs_data]
#[test]
fn every_file_round_trips() {
    let data = shared_data();
    let found = files(&data.join("mocap"), &["bvh"]);
    assert!(found.len() >= 6);
    for path in found {
        let before = read_bvh(&std::fs::read(&path).unwrap(), AS_IT_IS).unwrap();
        let text = write_bvh(&before.rig, &before.clip, &options_of(&before)).unwrap();
        assert_eq!(text.notes, [""; 0]);
        let unit = BvhUnit::Metres(before.metres_per_unit);
        let after = read_bvh(text.text.as_bytes(), BvhOptions { unit, ..AS_IT_IS }).unwrap();
        assert_eq!((&before.channels, before.frames), (&after.channels, after.frames));
        let names =
            |d: &BvhDocument| d.rig.joints.iter().map(|j| (j.name.clone(), j.parent)).collect::<Vec<_>>();
        assert_eq!(names(&before), names(&after));
        let (turn, shift) = difference(&before, &after);
        println!("{}: errors {turn:.1e} rad, {shift:.1e} m", path.display());
        assert!(turn < 1e-4 && shift < 1e-4, "{}: errors {turn} rad, {shift} m", path.display());
    }
}

/// Returns a skeleton and a motion with all features of the format.
fn random_motion(random: &mut Random) -> (Rig, Clip, Vec<Vec<BvhChannel>>) {
    let (joints, frames) = (1 + random.index(12), 1 + random.index(5));
    let (mut rig, mut clip, mut layout) = (Rig::default(), Clip::default(), Vec::new());
    let times: Vec<f32> = (0..frames).map(|i| (i as f64 * 0.125) as f32).collect();
    clip.duration = times[frames - 1];
    for i in 0..joints {
        // Some joints are exactly at their parents.
        let translation = if random.index(4) == 0 { Vec3::ZERO } else { random.in_cube() };
        let parent = (i > 0).then(|| random.index(i));
        let rest = LocalTransform { translation, ..LocalTransform::default() };
        rig.joints.push(Joint { name: format!("j{i}"), parent, rest, source: i });
        let mut channels: Vec<BvhChannel> = (0..3).map(BvhChannel::rotation).collect();
        let moves = i == 0 || random.index(3) == 0;
        if moves {
            channels.extend(BvhChannel::POSITIONS);
        }
        for k in (1..channels.len()).rev() {
            channels.swap(k, random.index(k + 1));
        }
        layout.push(channels);
        let turns = (0..frames).map(|_| random.rotation());
        let turns: Vec<f32> = turns.flat_map(|q| [q.x, q.y, q.z, q.w]).collect();
        let shifts = (0..frames).flat_map(|_| (random.in_cube() * 2.0).to_array()).collect();
        for (property, values) in [(Property::Rotation, turns), (Property::Translation, shifts)] {
            if property == Property::Rotation || moves {
                let interpolation = Interpolation::Linear;
                clip.channels.push(Channel {
                    joint: i,
                    property,
                    interpolation,
                    times: times.clone(),
                    values,
                });
            }
        }
    }
    (rig, clip, layout)
}

#[test]
fn random_motions_round_trip() {
    let mut random = Random::new(11);
    for case in 0..500 {
        let (rig, clip, layout) = random_motion(&mut random);
        let options =
            BvhWriteOptions { frame_time: 0.125, channels: Some(&layout), ..BvhWriteOptions::default() };
        let text = write_bvh(&rig, &clip, &options).unwrap().text;
        let unit = BvhUnit::Metres(0.01);
        let after = read_bvh(text.as_bytes(), BvhOptions { unit, ..AS_IT_IS })
            .unwrap_or_else(|error| panic!("case {case}: {error}\n{text}"));
        // Joints are written depth first, so they are found by name.
        let place = |i: usize| after.rig.joints.iter().position(|j| j.name == rig.joints[i].name).unwrap();
        for frame in 0..after.frames {
            let mut before = sinew_anim::rest_pose(&rig);
            sample(&clip, &rig, frame as f32 * 0.125, Wrap::Clamp, &mut before);
            let found = pose(&after, frame);
            for (i, local) in before.iter().enumerate() {
                let other = found[place(i)];
                assert!(local.rotation.angle_to(other.rotation) < 1e-4, "case {case}, joint {i}\n{text}");
                assert!(
                    (local.translation - other.translation).length() < 1e-4,
                    "case {case}, joint {i}\n{text}"
                );
            }
        }
    }
}

/// Joints of a glTF rig have their own rest axes; in the file they have those of the model.
#[needs_data]
#[test]
fn rig_with_rotated_joints_keeps_its_motion() {
    let data = shared_data();
    let path = data.join("rigs/CesiumMan.glb");
    let document = sinew_formats::load_gltf(path, sinew_formats::ReadOptions::default()).unwrap();
    let (rig, clip) = (&document.rig, &document.clips[0]);
    let text =
        write_bvh(rig, clip, &BvhWriteOptions { frame_time: 0.02, ..BvhWriteOptions::default() }).unwrap();
    let options = BvhOptions { unit: BvhUnit::Metres(0.01), ..AS_IT_IS };
    let after = read_bvh(text.text.as_bytes(), options).unwrap();
    assert!(after.frames > 90, "{}", after.frames);
    for frame in [0, 30, 77] {
        let mut before = sinew_anim::rest_pose(rig);
        sample(clip, rig, frame as f32 * 0.02, Wrap::Clamp, &mut before);
        let (expected, found) = (model(rig, &before), model(&after.rig, &pose(&after, frame)));
        for (i, joint) in rig.joints.iter().enumerate().filter(|(_, joint)| !joint.name.is_empty()) {
            let name = joint.name.replace(' ', "_");
            let k = after.rig.joints.iter().position(|other| other.name == name).unwrap();
            let off = (expected[i].translation - found[k].translation).length();
            assert!(off < 1e-4, "frame {frame}, {name}: off by {off} m");
        }
    }
}

#[test]
fn invalid_clips_are_not_written() {
    let (rig, clip, layout) = random_motion(&mut Random::new(1));
    let with = |options: BvhWriteOptions<'_>| write_bvh(&rig, &clip, &options).unwrap_err().to_string();
    let plain = BvhWriteOptions::default;
    assert_eq!(with(BvhWriteOptions { frame_time: 0.0, ..plain() }), "must be above 0 (frame time)");
    assert!(with(BvhWriteOptions { frame_time: 1e-300, ..plain() }).starts_with("too many frames: "));
    assert_eq!(
        with(BvhWriteOptions { metres_per_unit: f32::NAN, ..plain() }),
        "must be above 0 (metres per unit)"
    );
    let order = EulerOrder::Zxz;
    assert_eq!(
        with(BvhWriteOptions { rotation_order: order, ..plain() }),
        "names an axis twice (rotation order)"
    );
    let channels = Some(&layout[1..]);
    assert_eq!(with(BvhWriteOptions { channels, ..plain() }), "must be as many as the joints (channels)");
    assert!(write_bvh(&Rig::default(), &clip, &plain()).is_err());
}

/// Reads the bytes and, if that works, checks the promises of the types.
fn read_and_check(bytes: &[u8]) -> Option<String> {
    let options = BvhOptions { rows: BvhRows::AsPresent, ..BvhOptions::default() };
    let strict = read_bvh(bytes, BvhOptions::default());
    match read_bvh(bytes, options) {
        Ok(found) => {
            assert!(found.frames >= 1 && found.frame_time > 0.0 && found.metres_per_unit > 0.0);
            assert!(found.rig.joints.iter().enumerate().all(|(i, j)| j.parent.is_none_or(|p| p < i)));
            for channel in &found.clip.channels {
                assert!(channel.joint < found.rig.joints.len() && channel.times.len() == found.frames);
                assert_eq!(channel.values.len(), found.frames * channel.property.width());
                assert!(channel.times.windows(2).all(|w| w[0] < w[1]));
            }
        }
        Err(error) => {
            let said = error.to_string();
            assert!(
                !said.chars().any(char::is_control) && said.len() < 600 && !error.where_.is_empty(),
                "{said}"
            );
            assert!(strict.is_err());
        }
    }
    strict.err().map(|error| error.to_string())
}

#[needs_data]
#[test]
fn truncated_file_is_rejected() {
    let end = TWO_JOINTS.trim_end().len();
    for length in 0..end {
        // If only the last number loses digits, the file remains valid.
        assert!(read_and_check(&TWO_JOINTS.as_bytes()[..length]).is_some(), "{length}");
    }
    let data = shared_data();
    let mut random = Random::new(5);
    for path in files(&data.join("mocap"), &["bvh"]) {
        let whole = std::fs::read(&path).unwrap();
        let whole = &whole[..whole.len().min(300_000)];
        let last_row = whole.trim_ascii_end().iter().rposition(|&b| b == b'\n').unwrap();
        for _ in 0..20 {
            let length = random.index(last_row);
            assert!(read_and_check(&whole[..length]).is_some(), "{}: {length}", path.display());
            let mut flipped = whole.to_vec();
            let at = random.index(flipped.len());
            flipped[at] ^= 1 << random.index(8);
            read_and_check(&flipped);
        }
    }
}

/// Changes random bytes: 10,000 cases with `SINEW_FULL` set, otherwise a tenth.
#[test]
fn mutated_files_do_not_panic() {
    let cases = if std::env::var_os("SINEW_FULL").is_some() { 10_000 } else { 1000 };
    let mut whole = vec![TWO_JOINTS.as_bytes().to_vec()];
    let data = shared_data();
    if data.is_dir() {
        let small = |name: &str| std::fs::read(data.join("mocap").join(name)).unwrap();
        whole.extend([small("rotation_first_root.bvh"), small("sinusoidal.bvh")]);
    }
    let words: [&[u8]; 8] = [b"}", b"{ ", b"nan", b"-1e99", b"\r", b"99999999999", b"JOINT a {", b"\xff\xfe"];
    let mut random = Random::new(6);
    for case in 0..cases {
        let mut bytes = whole[case % whole.len()].clone();
        for _ in 0..=random.index(6) {
            let at = random.index(bytes.len());
            match random.index(4) {
                0 => drop(bytes.splice(at..at, words[random.index(words.len())].iter().copied())),
                1 => drop(bytes.drain(at..bytes.len().min(at + random.index(40)))),
                _ => bytes[at] = random.index(256) as u8,
            }
            if bytes.is_empty() {
                bytes.push(b' ');
            }
        }
        read_and_check(&bytes);
    }
}

#[test]
fn chains_get_end_sites_on_request() {
    let (rig, clip) = crate::data::bar();
    let options = BvhWriteOptions { metres_per_unit: 1.0, ..BvhWriteOptions::default() };
    let unit = BvhUnit::Metres(1.0);
    let read = |ends| {
        let text = write_bvh(&rig, &clip, &BvhWriteOptions { ends, ..options }).unwrap().text;
        read_bvh(text.as_bytes(), BvhOptions { unit, ..BvhOptions::default() }).unwrap().rig
    };
    let plain = read(BvhEnds::AsInRig);
    assert_eq!(plain.joints, rig.joints);
    let ended = read(BvhEnds::EveryChain);
    assert_eq!(ended.joints[..3], rig.joints);
    let [end] = &ended.joints[3..] else { panic!("one end more") };
    assert_eq!((end.name.as_str(), end.parent, end.rest.translation), ("", Some(2), Vec3::Y * 0.5));
}
