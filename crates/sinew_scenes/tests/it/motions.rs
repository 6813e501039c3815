//! The mannequin's clips.

use sinew::anim::{Clip, Wrap, local_to_model, rest_pose, sample, skin_vertices};
use sinew::math::{Affine, Rotation, Vec3};
use sinew_scenes::mannequin::drills::{punch, running, walking};
use sinew_scenes::mannequin::{Mannequin, Path, WALK_SPEED, mannequin};

/// Samples per second, which fall between the keys as well as on them.
const RATE: f32 = 120.0;

fn model_at(character: &Mannequin, clip: &Clip, time: f32) -> Vec<Affine> {
    let mut local = rest_pose(&character.rig);
    sample(clip, &character.rig, time, Wrap::Clamp, &mut local);
    let mut model = Vec::new();
    local_to_model(&character.rig, &local, &Affine::IDENTITY, &mut model);
    model
}

fn times(clip: &Clip) -> impl Iterator<Item = f32> + use<> {
    let count = (clip.duration * RATE) as usize;
    (0..=count).map(|k| k as f32 / RATE)
}

fn joint(character: &Mannequin, name: &str) -> usize {
    character.rig.joints.iter().position(|j| j.name == name).expect("the rig has the joint")
}

fn skin_at(character: &Mannequin, clip: &Clip, time: f32) -> Vec<Vec<Vec3>> {
    let model = model_at(character, clip, time);
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    let count = character.rig.meshes[0].primitives.len();
    let skin = (0..count).map(|primitive| {
        skin_vertices(&character.rig, 0, primitive, &model, &mut positions, &mut normals);
        positions.clone()
    });
    skin.collect()
}

fn end_values(clip: &Clip) -> (Vec<f32>, Vec<f32>) {
    let ends = clip.channels.iter().map(|channel| {
        let width = channel.property.width();
        (&channel.values[..width], &channel.values[channel.values.len() - width..])
    });
    let (first, last): (Vec<&[f32]>, Vec<&[f32]>) = ends.unzip();
    (first.concat(), last.concat())
}

fn assert_close(a: &[f32], b: &[f32], what: &str) {
    let worst = a.iter().zip(b).fold(0.0, |worst: f32, (x, y)| worst.max((x - y).abs()));
    assert!(a.len() == b.len() && worst < 1e-5, "{what}: off by {worst}");
}

#[test]
fn cycles_close_and_getting_up_ends_where_idling_begins() {
    let character = mannequin();
    let motions = character.motions;
    for cycle in [motions.walk, motions.idle] {
        let (first, last) = end_values(&character.clips[cycle]);
        assert_close(&first, &last, &character.clips[cycle].name);
    }
    let (standing, _) = end_values(&character.clips[motions.idle]);
    for get_up in [motions.get_up_supine, motions.get_up_prone] {
        let (_, last) = end_values(&character.clips[get_up]);
        assert_close(&last, &standing, &character.clips[get_up].name);
    }
}

/// A foot's contact points in the foot's bind axes, and the times in the foot's cycle when each carries weight.
const HEEL: (Vec3, [f32; 2]) = (Vec3::new(0.0, -0.08, -0.055), [0.0, 0.3125]);
const BALL: (Vec3, [f32; 2]) = (Vec3::new(0.0, -0.056, 0.135), [0.09375, 0.625]);

#[test]
fn planted_feet_do_not_slide_at_the_walking_speed() {
    let character = mannequin();
    let walk = &character.clips[character.motions.walk];
    for (name, offset) in [("leftFoot", 0.0), ("rightFoot", 0.5)] {
        let foot = joint(&character, name);
        for (point, [start, end]) in [HEEL, BALL] {
            let on_ground = |phase: f32| {
                let in_clip = (phase + offset) % 1.0 * walk.duration;
                let at = model_at(&character, walk, in_clip)[foot].point(point);
                at + Vec3::Z * (WALK_SPEED * phase * walk.duration)
            };
            let track: Vec<Vec3> =
                (0..=40).map(|k| on_ground(start + (end - start) * k as f32 / 40.0)).collect();
            let slide = track.iter().fold(0.0, |worst: f32, p| worst.max((*p - track[0]).length()));
            assert!(slide < 0.01, "{name} at {point}: slides {slide} m");
        }
    }
}

/// Signed bend of a hinge about its bind axis, degrees, and its rotation about any other axis.
fn hinge(character: &Mannequin, clip: &Clip, time: f32, name: &str, axis: Vec3) -> (f32, f32) {
    let mut local = rest_pose(&character.rig);
    sample(clip, &character.rig, time, Wrap::Clamp, &mut local);
    let rotation = local[joint(character, name)].rotation;
    let (swing, _) = rotation.swing_twist(axis);
    (rotation.twist_angle(axis).to_degrees(), swing.angle_to(Rotation::IDENTITY).to_degrees())
}

#[test]
fn knees_and_elbows_do_not_hyperextend() {
    let character = mannequin();
    let direction = |from: &str, to: &str| {
        let along = character.rig.joints[joint(&character, to)].rest.translation.normalize();
        assert_eq!(character.rig.joints[joint(&character, to)].parent, Some(joint(&character, from)));
        along
    };
    let mut hinges = Vec::new();
    for side in ["left", "right"] {
        hinges.push((format!("{side}LowerLeg"), Vec3::X, 4.1));
        let along = direction(&format!("{side}UpperArm"), &format!("{side}LowerArm"));
        hinges.push((format!("{side}LowerArm"), along.cross(Vec3::Z).normalize(), 8.0));
    }
    let drills = [walking(Path::Circle(2.0)).clip, running().clip, punch()];
    for clip in character.clips.iter().chain(&drills) {
        for (name, axis, bind_bend) in &hinges {
            for time in times(clip) {
                let (bend, off_axis) = hinge(&character, clip, time, name, *axis);
                let straight = bend + bind_bend;
                assert!(
                    (0.0..=146.0).contains(&straight),
                    "{} {name}: hyperextended: {straight}° at {time} s",
                    clip.name
                );
                assert!(off_axis < 1.0, "{} {name}: {off_axis}° off the hinge axis at {time} s", clip.name);
            }
        }
    }
}

#[test]
fn skin_stays_above_the_floor_and_touches_it() {
    let character = mannequin();
    for clip in &character.clips {
        for time in times(clip).step_by(2) {
            let skin = skin_at(&character, clip, time);
            let lowest = skin.iter().flatten().fold(f32::MAX, |low, v| low.min(v.y));
            assert!((-0.02..0.02).contains(&lowest), "{} at {time} s: lowest point {lowest} m", clip.name);
        }
    }
}

#[test]
fn skins_of_runners_and_boxers_do_not_sink_into_the_floor() {
    let character = mannequin();
    // A run has a phase of flight.
    for (clip, highest) in [(walking(Path::Circle(2.0)).clip, 0.02), (running().clip, 0.08), (punch(), 0.02)]
    {
        for time in times(&clip).step_by(4) {
            let skin = skin_at(&character, &clip, time);
            let lowest = skin.iter().flatten().fold(f32::MAX, |low, v| low.min(v.y));
            assert!((-0.02..highest).contains(&lowest), "{} at {time} s: lowest point {lowest} m", clip.name);
        }
    }
}

#[test]
fn balls_of_planted_feet_do_not_slide() {
    let character = mannequin();
    for cycle in [walking(Path::Straight), walking(Path::Circle(2.0)), running()] {
        for (name, offset) in [("leftToes", 0.0), ("rightToes", 0.5)] {
            let ball = joint(&character, name);
            let [start, end] = cycle.ball_down;
            let at = |k: usize| {
                let phase = start + (end - start) * k as f32 / 40.0 + offset;
                let laps = phase.floor();
                let model = model_at(&character, &cycle.clip, (phase - laps) * cycle.clip.duration);
                let gone = cycle.path.at(cycle.speed * cycle.clip.duration * laps);
                gone.point(model[ball].translation)
            };
            let slide = (1..=40).fold(0.0, |worst: f32, k| worst.max((at(k) - at(0)).length()));
            assert!(slide < 0.012, "{}, {name}: {slide} m", cycle.clip.name);
        }
    }
}

#[test]
fn getting_up_starts_lying_and_ends_upright() {
    let character = mannequin();
    let motions = character.motions;
    let (hips, head) = (joint(&character, "hips"), joint(&character, "head"));
    for (index, belly_up) in [(motions.get_up_supine, 1.0), (motions.get_up_prone, -1.0)] {
        let clip = &character.clips[index];
        let start = model_at(&character, clip, 0.0);
        assert!(
            start[hips].translation.y < 0.13 && start[head].translation.y < 0.2,
            "{}: does not start lying on the floor",
            clip.name
        );
        assert!(start[hips].vector(Vec3::Z).y * belly_up > 0.95, "{}: lies on the wrong side", clip.name);
        let along = (start[head].translation - start[hips].translation) * -belly_up;
        assert!(along.z > 0.5, "{}: does not lie toward +Z", clip.name);
        let end = model_at(&character, clip, clip.duration);
        assert!(end[head].translation.y > 1.5 && end[hips].vector(Vec3::Z).z > 0.99);
        assert!((2.0..3.5).contains(&clip.duration));
    }
}

/// Joints must not jump between samples. The fastest joint, a swinging foot, moves at about 4 m/s.
#[test]
fn joints_move_at_human_speed() {
    let character = mannequin();
    for clip in &character.clips {
        let mut before = model_at(&character, clip, 0.0);
        for time in times(clip).skip(1) {
            let now = model_at(&character, clip, time);
            for (index, (a, b)) in before.iter().zip(&now).enumerate() {
                let speed = (b.translation - a.translation).length() * RATE;
                let name = &character.rig.joints[index].name;
                assert!(speed < 4.5, "{} {name}: moves at {speed} m/s at {time} s", clip.name);
            }
            before = now;
        }
    }
}

#[test]
fn feet_pass_each_other_without_touching() {
    let character = mannequin();
    let walk = &character.clips[character.motions.walk];
    let primitive = &character.rig.meshes[0].primitives[2];
    let moved_by = |vertex: usize, prefix: &str| {
        let slot = usize::from(primitive.joints[vertex][0]);
        character.rig.joints[character.rig.skins[0].joints[slot]].name.starts_with(prefix)
    };
    for time in times(walk).step_by(4) {
        let skin = &skin_at(&character, walk, time)[2];
        let of = |prefix: &str| -> Vec<Vec3> {
            (0..skin.len()).filter(|&i| moved_by(i, prefix)).map(|i| skin[i]).collect()
        };
        let (left, right) = (of("left"), of("right"));
        let gap = left.iter().flat_map(|a| right.iter().map(move |b| (*a - *b).length()));
        let nearest = gap.fold(f32::MAX, f32::min);
        assert!(nearest > 0.01, "bodies are {nearest} m apart at {time} s");
    }
}
