//! The verdict of `ragdoll build` and `bake`: both must report each defect put into the mannequin.

use crate::sinew::{Folder, glb, sinew};
use serde_json::Value;
use sinew::anim::sample::sample;
use sinew::anim::weights::lost_weights;
use sinew::anim::{Channel, Clip, Interpolation, Primitive, Property, Rig, Wrap, local_to_model, rest_pose};
use sinew::formats::{ReadOptions, load_gltf};
use sinew::math::{Affine, Rotation, Transform, Vec3};
use sinew::physics::{BodyDef, BodyKind, Shape, ShapeDef};
use sinew_scenes::mannequin::mannequin;

/// Returns verdict and reasons of `ragdoll build` and of `bake` with these options.
fn build_and_bake(folder: &Folder, file: &str, extra: &[&str]) -> [(String, String); 2] {
    let out = folder.path("out.glb");
    let built = sinew(&[&["ragdoll", "build", file, "--json"], extra].concat()).json();
    let baked = sinew(&[&["bake", file, "-o", &out, "--json"], extra].concat()).json();
    let said = |object: &Value| {
        (object["verdict"].as_str().expect("a verdict").to_owned(), object["reasons"].to_string())
    };
    [said(&built["quality"]), said(&baked)]
}

fn joint(rig: &Rig, name: &str) -> usize {
    rig.joints.iter().position(|joint| joint.name == name).unwrap_or_else(|| panic!("no joint {name}"))
}

#[test]
fn mannequin_is_good_in_build_and_bake() {
    let folder = Folder::new("verdict-good");
    for (verdict, reasons) in build_and_bake(&folder, &folder.mannequin(), &[]) {
        assert_eq!(verdict, "good", "{reasons}");
    }
}

/// A walk whose feet are at 0 while the rest pose is 1 m lower: the character stands on the floor before and after the
/// fall, and the baked clip is placed like the walk.
#[test]
fn floor_is_at_the_feet_of_the_clip() {
    let folder = Folder::new("verdict-floor");
    let mannequin = mannequin();
    let mut rig = mannequin.rig.clone();
    let mut walk = Clip { name: "Walk".into(), ..mannequin.clips[mannequin.motions.walk].clone() };
    let down = Vec3::Y * -1.0;
    for (index, joint) in rig.joints.iter_mut().enumerate().filter(|(_, joint)| joint.parent.is_none()) {
        let is_moved =
            |channel: &Channel| channel.joint == index && channel.property == Property::Translation;
        if !walk.channels.iter().any(is_moved) {
            walk.channels.push(Channel {
                joint: index,
                property: Property::Translation,
                interpolation: Interpolation::Linear,
                times: vec![0.0],
                values: joint.rest.translation.to_array().to_vec(),
            });
        }
        joint.rest.translation += down;
    }
    for skin in &mut rig.skins {
        for bind in &mut skin.inverse_bind {
            bind.translation -= bind.linear * down;
        }
    }
    for primitive in rig.meshes.iter_mut().flat_map(|mesh| &mut mesh.primitives) {
        primitive.positions.iter_mut().for_each(|place| *place += down);
    }
    let file = folder.file("shifted.glb", glb(&rig, &[walk]));
    let out = folder.path("out.glb");
    let object = sinew(&["bake", &file, "-o", &out, "--json"]).json();
    for key in ["standing_height_m", "rest_height_m", "up_height_m"] {
        let height = object["skin"][key].as_f64().unwrap_or_else(|| panic!("no {key}: {object:#}"));
        assert!(height.abs() < 0.08, "{key}: {height} m");
    }
    assert_eq!(object["verdict"], "good", "{object:#}");
}

/// Chest skin with weights to a foot tears in both, badly enough for the worst verdict.
#[test]
fn torn_skin_is_bad_in_build_and_bake() {
    let folder = Folder::new("verdict-torn");
    let mut rig = mannequin().rig;
    let (chest, foot) = (joint(&rig, "chest"), joint(&rig, "leftFoot"));
    for skin in &mut rig.skins {
        let slots = [chest, foot].map(|joint| skin.joints.iter().position(|&own| own == joint));
        let [Some(chest), Some(foot)] = slots else { continue };
        // Half of the chest is weighted to a foot.
        for primitive in rig.meshes.iter_mut().flat_map(|mesh| &mut mesh.primitives) {
            for (index, slots) in primitive.joints.iter_mut().enumerate() {
                if primitive.positions[index].x > 0.0 {
                    slots
                        .iter_mut()
                        .filter(|slot| usize::from(**slot) == chest)
                        .for_each(|slot| *slot = foot as u16);
                }
            }
        }
    }
    let file = folder.file("torn.glb", glb(&rig, &[]));
    for (verdict, reasons) in build_and_bake(&folder, &file, &[]) {
        assert_eq!(verdict, "bad", "{reasons}");
        assert!(reasons.contains("stretches one side"), "{reasons}");
    }
}

/// An adult of 57 cm and 8 kg.
#[test]
fn adult_of_half_a_metre_is_not_good() {
    let folder = Folder::new("verdict-small");
    let mut rig = mannequin().rig;
    let share = 0.57 / 1.8;
    for root in &mut rig.joints {
        root.rest.translation *= share;
    }
    for skin in &mut rig.skins {
        skin.inverse_bind.iter_mut().for_each(|bind| bind.translation *= share);
    }
    for primitive in rig.meshes.iter_mut().flat_map(|mesh| &mut mesh.primitives) {
        primitive.positions.iter_mut().for_each(|place| *place *= share);
    }
    let file = folder.file("small.glb", glb(&rig, &[]));
    for (verdict, reasons) in build_and_bake(&folder, &file, &[]) {
        let is_taken_larger = verdict == "good" && !reasons.contains("0.57");
        assert!(verdict != "good" || is_taken_larger, "{verdict}: {reasons}");
    }
}

/// The floor is too small, so the character falls out of the world.
#[test]
fn fall_out_of_the_world_is_bad() {
    let folder = Folder::new("verdict-out");
    let slab = BodyDef {
        kind: BodyKind::Static,
        position: Vec3::Y * -0.1,
        shapes: vec![ShapeDef::new(Shape::Box { half_extents: Vec3::new(0.4, 0.1, 0.4) })],
        ..BodyDef::default()
    };
    let world = folder.file("slab.json", sinew::formats::write_world(&[slab]));
    let (file, out) = (folder.mannequin(), folder.path("out.glb"));
    let arguments = ["bake", &file, "--world", &world, "--at", "0,0,0", "--hit", "chest=0,0,200@0.2"];
    let object = sinew(&[&arguments[..], &["--seconds", "4", "-o", &out, "--json"]].concat()).json();
    assert_eq!(object["verdict"], "bad", "{object:#}");
    assert!(object["reasons"].to_string().contains("falls out of the world"), "{object:#}");
}

/// A clip without motion is not a walk, even if its name says so.
#[test]
fn clip_without_motion_is_not_used_as_walk() {
    let folder = Folder::new("verdict-walk");
    let mannequin = mannequin();
    let walk = Clip { name: "Go walking".into(), ..mannequin.clips[mannequin.motions.walk].clone() };
    let mut held = Clip { name: "Walk".into(), ..walk.clone() };
    for channel in &mut held.channels {
        channel.values.truncate(channel.property.width());
        channel.times.truncate(1);
    }
    let file = folder.file("held.glb", glb(&mannequin.rig, &[held, walk]));
    let run = sinew(&["bake", &file, "--seconds", "1", "-o", &folder.path("out.glb")]);
    assert!(run.stdout.contains("Go walking"), "{run:?}");
}

/// A truncated capture is played to its end, with a note.
#[test]
fn bvh_with_fewer_frames_than_declared_is_played() {
    let folder = Folder::new("verdict-cut");
    let (file, bvh, out) = (folder.mannequin(), folder.path("walk.bvh"), folder.path("out.glb"));
    sinew(&["bake", &file, "--seconds", "2", "--limp-at", "9", "-o", &bvh, "--json"]).json();
    let text = std::fs::read_to_string(&bvh).expect("the file can be read");
    std::fs::write(&bvh, text.replace("Frames: 61", "Frames: 500")).expect("the file can be written");
    let object = sinew(&["bake", &file, "--clips", &bvh, "--seconds", "1", "-o", &out, "--json"]).json();
    assert!(object["notes"].to_string().contains("declares 500 frames, has 61"), "{object:#}");
}

/// A skin with lost weights is rejected with a hint at the option, and built with that option.
#[test]
fn lost_weights_are_rebuilt_on_request() {
    let folder = Folder::new("verdict-weights");
    let mut rig = mannequin().rig;
    for mesh in rig.meshes.iter_mut().filter(|mesh| mesh.skin.is_some()) {
        for primitive in &mut mesh.primitives {
            primitive.joints.fill([0; 4]);
            primitive.weights.fill([1.0, 0.0, 0.0, 0.0]);
        }
    }
    let file = folder.file("lost.glb", glb(&rig, &[]));
    let refused = sinew(&["ragdoll", "build", &file]);
    assert_eq!(refused.code, Some(1));
    assert!(refused.stderr.contains("--weights nearest"), "{}", refused.stderr);
    let built = sinew(&["ragdoll", "build", &file, "--weights", "nearest", "--json"]).json();
    let roles: Vec<&Value> =
        built["bodies"].as_array().expect("bodies").iter().map(|body| &body["role"]).collect();
    for role in ["hips", "head", "leftHand", "rightLowerArm", "leftFoot", "rightUpperLeg"] {
        assert!(roles.iter().any(|known| *known == role), "no body for {role}: {roles:?}");
    }
    assert_ne!(built["quality"]["verdict"], "bad", "{}", built["quality"]["reasons"]);
    let out = folder.path("out.glb");
    let baked = sinew(&["bake", &file, "--weights", "nearest", "-o", &out, "--json"]).json();
    assert_ne!(baked["verdict"], "bad", "{}", baked["reasons"]);
    let written = load_gltf(&out, ReadOptions::default()).expect("the glTF can be read");
    assert_eq!(lost_weights(&written.rig), None, "the baked file has the new weights");
}

/// A human that lies in its file starts its fall lying, unless `--up` stands it up.
#[test]
fn character_lying_in_its_file_starts_lying() {
    let folder = Folder::new("verdict-lying");
    let mut rig = mannequin().rig;
    let back = Rotation::from_axis_angle(Vec3::X, -core::f32::consts::FRAC_PI_2);
    for joint in rig.joints.iter_mut().filter(|joint| joint.parent.is_none()) {
        joint.rest.translation = back * joint.rest.translation;
        joint.rest.rotation = back * joint.rest.rotation;
    }
    let turn = Affine::from(Transform::new(Vec3::ZERO, back));
    for bind in rig.skins.iter_mut().flat_map(|skin| &mut skin.inverse_bind) {
        *bind = *bind * turn.inverse();
    }
    for primitive in
        rig.meshes.iter_mut().filter(|mesh| mesh.skin.is_some()).flat_map(|mesh| &mut mesh.primitives)
    {
        primitive.positions.iter_mut().for_each(|at| *at = turn.point(*at));
        primitive.normals.iter_mut().for_each(|normal| *normal = back * *normal);
    }
    let file = folder.file("lying.glb", glb(&rig, &[]));
    // Direction from hips to head at the start and later, in the file's axes.
    let trunks = |extra: &[&str], later: f32| {
        let out = folder.path("out.glb");
        let arguments = [&["bake", file.as_str(), "-o", &out, "--seconds", "2", "--json"], extra].concat();
        let object = sinew(&arguments).json();
        let document = load_gltf(&out, ReadOptions::default()).expect("the glTF can be read");
        let (rig, clip) = (&document.rig, document.clips.last().expect("a clip"));
        let trunk = |time: f32| {
            let (mut pose, mut model) = (rest_pose(rig), Vec::new());
            sample(clip, rig, time, Wrap::Clamp, &mut pose);
            local_to_model(rig, &pose, &Affine::IDENTITY, &mut model);
            model[joint(rig, "head")].translation - model[joint(rig, "hips")].translation
        };
        ([trunk(0.0), trunk(later)], object["notes"].to_string())
    };
    let ([start, end], notes) = trunks(&[], 1.0);
    assert!(start.y.abs() < 0.05 && start.z < -0.4, "the character does not start on its back: {start}");
    assert!(end.y.abs() < 0.15 && end.z < -0.4, "the character does not stay on its back: {end}");
    assert!(notes.contains("--up"), "{notes}");
    // With another up axis the character stands, and falls.
    let ([start, end], _) = trunks(&["--up", "-z"], 2.0);
    assert!(start.z < -0.4, "{start}");
    assert!(end.z > -0.3, "the character has not fallen: {end}");
}

/// A human in a hoop that no get-up keeps out of the floor stays down: usable at most, with the reason.
#[test]
fn a_human_that_stays_down_is_not_good() {
    let folder = Folder::new("verdict-down");
    let mut rig = mannequin().rig;
    let hips = joint(&rig, "hips");
    let (mut model, rest) = (Vec::new(), rest_pose(&rig));
    local_to_model(&rig, &rest, &Affine::IDENTITY, &mut model);
    let middle = model[hips].translation;
    let mesh = rig.meshes.iter_mut().find(|mesh| mesh.skin.is_some()).expect("a skin");
    let slot = rig.skins[mesh.skin.expect("a skin")].joints.iter().position(|&joint| joint == hips);
    let slot = u16::try_from(slot.expect("the hips have skin")).expect("few");
    let corners = [Vec3::X, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Z].map(|way| middle + way * 1.2);
    let thick = corners.iter().flat_map(|&at| [at - Vec3::Y * 0.02, at + Vec3::Y * 0.02]);
    mesh.primitives.push(Primitive {
        positions: thick.collect(),
        normals: vec![Vec3::Y; 8],
        joints: vec![[slot, 0, 0, 0]; 8],
        weights: vec![[1.0, 0.0, 0.0, 0.0]; 8],
        indices: vec![1, 3, 5, 1, 5, 7, 0, 4, 2, 0, 6, 4],
        ..Primitive::default()
    });
    let file = folder.file("hoop.glb", glb(&rig, &[]));
    for (verdict, reasons) in build_and_bake(&folder, &file, &[]) {
        assert!(reasons.contains("it does not get up: "), "{verdict}: {reasons}");
        assert_ne!(verdict, "good", "{reasons}");
    }
}
