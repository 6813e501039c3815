//! Compares the table of all files with motion in the test data with `tests/data/moving_files.txt`.

use crate::data::{GLTF, files, shared_data};
use needs_data::needs_data;
use sinew_anim::{Channel, Clip, Interpolation, LocalTransform, Property, Rig, Wrap, rest_pose, sample};
use sinew_formats::bvh::{
    BvhChannel, BvhDocument, BvhOptions, BvhUnit, BvhWriteOptions, RestFrame, read_bvh, write_bvh,
};
use sinew_formats::{
    DeepMimicCharacter, ReadOptions, Result, load_gltf, read_deepmimic, read_deepmimic_character,
};
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/moving_files.txt");
const START: &str = "<!-- made by `cargo test -p sinew_formats formats_table`, with UPDATE_EXPECT=1 -->\n";
const END: &str = "<!-- end of what is made -->\n";

/// Returns the largest difference of a clip's keys from samples at their times.
fn key_error(rig: &Rig, clip: &Clip) -> f32 {
    let mut worst = 0.0;
    let mut pose = rest_pose(rig);
    for channel in &clip.channels {
        let per_key = channel.values.len() / channel.times.len();
        let value_at = if channel.interpolation == Interpolation::CubicSpline { per_key / 3 } else { 0 };
        for (time, values) in channel.times.iter().zip(channel.values.chunks_exact(per_key)) {
            sample(clip, rig, *time, Wrap::Clamp, &mut pose);
            let key = &values[value_at..value_at + channel.property.width()];
            worst = sinew_math::max(worst, distance(channel, pose[channel.joint], key));
        }
    }
    worst
}

/// Returns the largest difference of a sample from a key over the components; −q equals q, and quaternions are
/// normalized.
fn distance(channel: &Channel, found: LocalTransform, key: &[f32]) -> f32 {
    let largest = |off: [f32; 4]| off.into_iter().fold(0.0, |a, b: f32| sinew_math::max(a, b.abs()));
    let vector = |v: sinew_math::Vec3| largest([v.x - key[0], v.y - key[1], v.z - key[2], 0.0]);
    match channel.property {
        Property::Translation => vector(found.translation),
        Property::Scale => vector(found.scale),
        Property::Rotation => {
            let q = sinew_math::Rotation::from_xyzw(key[0], key[1], key[2], key[3]).normalize();
            let p = found.rotation.toward(q);
            largest([p.x - q.x, p.y - q.y, p.z - q.z, p.w - q.w])
        }
    }
}

fn joints_moved(clip: &Clip) -> usize {
    clip.channels.iter().map(|channel| channel.joint).collect::<BTreeSet<_>>().len()
}

fn keys(clip: &Clip) -> usize {
    clip.channels.iter().map(|channel| channel.times.len()).sum()
}

fn interpolations(clip: &Clip) -> String {
    let name = |channel: &Channel| match channel.interpolation {
        Interpolation::Step => "step",
        Interpolation::Linear => "linear",
        Interpolation::CubicSpline => "cubic",
    };
    clip.channels.iter().map(name).collect::<BTreeSet<_>>().into_iter().collect::<Vec<_>>().join(", ")
}

/// Escapes text for a cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

fn clip_rows(out: &mut String, folder: &Path) {
    for path in files(folder, &GLTF) {
        let name = path.strip_prefix(folder).unwrap().display().to_string();
        match load_gltf(&path, ReadOptions::default()) {
            Err(error) => {
                let _ = writeln!(
                    out,
                    "| {name} | | | | | | fails: {} ({}) |",
                    cell(&error.what),
                    cell(&error.where_)
                );
            }
            Ok(document) if document.clips.is_empty() => {
                let _ = writeln!(out, "| {name} | no clips | {} | | | | |", document.rig.joints.len());
            }
            Ok(document) => {
                for clip in &document.clips {
                    let error = key_error(&document.rig, clip);
                    let shown = if clip.name.is_empty() { "(unnamed)" } else { &clip.name };
                    let verdict = if error < 1e-6 {
                        "equal at every key".to_owned()
                    } else {
                        format!("off by {error:.1e}")
                    };
                    let _ = writeln!(
                        out,
                        "| {name} | {} | {} of {} | {:.3} | {} | {} | {verdict} |",
                        cell(shown),
                        joints_moved(clip),
                        document.rig.joints.len(),
                        clip.duration,
                        keys(clip),
                        interpolations(clip),
                    );
                    assert!(error < 1e-6, "{name}, {}: {error}", clip.name);
                }
            }
        }
    }
}

/// Returns the rotation orders of a file's joints.
fn orders(document: &BvhDocument) -> String {
    let order = |channels: &Vec<BvhChannel>| -> String {
        channels.iter().filter(|channel| channel.is_rotation()).map(|channel| &channel.name()[..1]).collect()
    };
    let found: BTreeSet<String> =
        document.channels.iter().map(order).filter(|order| !order.is_empty()).collect();
    found.into_iter().collect::<Vec<_>>().join(", ")
}

/// Returns the largest difference after writing and reading again, radians and metres.
fn round_trip(bytes: &[u8]) -> Result<(f32, f32)> {
    let keep = BvhOptions { rest_frame: RestFrame::Keep, ..BvhOptions::default() };
    let before = read_bvh(bytes, keep)?;
    let options = BvhWriteOptions {
        frame_time: before.frame_time,
        metres_per_unit: before.metres_per_unit,
        channels: Some(&before.channels),
        ..BvhWriteOptions::default()
    };
    let text = write_bvh(&before.rig, &before.clip, &options)?.text;
    let unit = BvhUnit::Metres(before.metres_per_unit);
    let after = read_bvh(text.as_bytes(), BvhOptions { unit, ..keep })?;
    let (mut turn, mut shift) = (0.0, 0.0);
    let (mut a, mut b) = (rest_pose(&before.rig), rest_pose(&after.rig));
    for &time in &before.clip.channels[0].times {
        sample(&before.clip, &before.rig, time, Wrap::Clamp, &mut a);
        sample(&after.clip, &after.rig, time, Wrap::Clamp, &mut b);
        for (x, y) in a.iter().zip(&b) {
            turn = sinew_math::max(turn, x.rotation.angle_to(y.rotation));
            shift = sinew_math::max(shift, (x.translation - y.translation).length());
        }
    }
    Ok((turn, shift))
}

fn bvh_row(bytes: &[u8]) -> Result<String> {
    let document = read_bvh(bytes, BvhOptions::default())?;
    let (turn, shift) = round_trip(bytes)?;
    assert!(turn < 1e-4 && shift < 1e-4, "{turn} rad, {shift} m");
    Ok(format!(
        "{} | {:.3} | {} | {} | {:.6} | {turn:.0e} rad, {:.0e} mm | {}",
        document.rig.joints.len(),
        document.clip.duration,
        document.frames,
        orders(&document),
        document.metres_per_unit,
        1e3 * shift,
        cell(&document.notes.join("; "))
    ))
}

fn deepmimic_row(bytes: &[u8], character: &DeepMimicCharacter) -> Result<String> {
    if let Ok(body) = read_deepmimic_character(bytes) {
        return Ok(format!(
            "{} | | | | 1 | | a character: the skeleton of these clips",
            body.rig.joints.len()
        ));
    }
    let found = read_deepmimic(bytes, character)?;
    let frames = found.clip.channels[0].times.len();
    let loops = if found.wrap == Wrap::Loop { "starts over" } else { "ends" };
    let joints = character.rig.joints.len();
    Ok(format!("{joints} | {:.3} | {frames} | | 1 | | {loops}", found.clip.duration))
}

fn capture_rows(out: &mut String, folder: &Path) {
    let read = |path: &Path| std::fs::read(path).unwrap();
    let character = read_deepmimic_character(&read(&folder.join("deepmimic_humanoid3d.txt"))).unwrap();
    for path in files(folder, &["bvh", "txt"]) {
        let bytes = read(&path);
        let is_bvh = path.extension().is_some_and(|extension| extension == "bvh");
        let row = if is_bvh { bvh_row(&bytes) } else { deepmimic_row(&bytes, &character) };
        let row = row.unwrap_or_else(|error| format!("| | | | | | fails: {}", cell(&error.to_string())));
        let _ = writeln!(out, "| {} | {row} |", path.file_name().unwrap().display());
    }
}

#[needs_data]
#[test]
fn formats_table_is_up_to_date() {
    let data = shared_data();
    let mut table = String::from(START);
    table.push_str("\n### Captured motions\n\n");
    table.push_str("| file | joints | seconds | frames | rotations | metres per unit | written and read again | notes |\n");
    table.push_str("|---|---|---|---|---|---|---|---|\n");
    capture_rows(&mut table, &data.join("mocap"));
    table.push_str("\n### Clips of rigs\n\n");
    table.push_str("| file | clip | joints | seconds | keys | interpolation | sampled |\n|---|---|---|---|---|---|---|\n");
    clip_rows(&mut table, &data.join("rigs"));
    table.push_str(END);
    let page = std::fs::read_to_string(PAGE).unwrap();
    let (before, rest) = page.split_once(START).expect("the page marks the start of the table");
    let (_, after) = rest.split_once(END).expect("the page marks the end of the table");
    let wanted = format!("{before}{table}{after}");
    if std::env::var_os("UPDATE_EXPECT").is_some() {
        std::fs::write(PAGE, wanted).unwrap();
    } else if page != wanted {
        panic!("{PAGE} is out of date: run the test with UPDATE_EXPECT=1");
    }
}
