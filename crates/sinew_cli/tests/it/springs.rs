//! Hair in `bake`, `inspect` and `ragdoll doctor`: an avatar with springs, and one with hair by joint names only.

use crate::contract::check_keys;
use crate::sinew::{Folder, glb, gltf_files, shared_data, sinew};
use needs_data::needs_data;
use serde_json::{Value, json};
use sinew::anim::springs::{ColliderShape, LimitKind, Side};
use sinew::anim::{Clip, Property, Rig, SpringBone, SpringChain, SpringCollider, SpringLimit, Springs};
use sinew::formats::gltf::SpringFormat;
use sinew::formats::{ReadOptions, load_gltf};
use sinew::math::{Random, Rotation, Vec3};
use sinew_scenes::maned::{HAIR, maned_rig};
use sinew_scenes::mannequin::mannequin;

#[path = "../../../sinew_ragdoll/tests/it/springs/avatar.rs"]
mod avatar;

use avatar::{Calming, random_avatar, strands, vrm};

/// Returns the largest rotation of a hair joint in a clip, radians.
fn swings(clip: &Clip, rig: &Rig) -> f32 {
    let mut most = 0.0_f32;
    for channel in &clip.channels {
        if channel.property == Property::Rotation && rig.joints[channel.joint].name.starts_with("hair_") {
            let turn = |q: &[f32]| Rotation::from_xyzw(q[0], q[1], q[2], q[3]).to_scaled_axis().length();
            most = channel.values.chunks(4).map(turn).fold(most, f32::max);
        }
    }
    most
}

#[test]
fn avatar_hair_moves_in_the_bake() {
    let folder = Folder::new("springs");
    let file = folder.file("avatar.vrm", vrm(&maned_rig(&HAIR), SpringFormat::Vrm1));
    let object = sinew(&["inspect", &file, "--json"]).json();
    check_keys("inspect", &object);
    assert_eq!(object["springs"][0]["name"], "hair_back");
    assert_eq!(object["springs"][0]["joints"].as_array().map(Vec::len), Some(5));
    assert_eq!(
        object["spring_colliders"][0],
        json!({"joint": "head", "shape": "sphere", "offset": [0.0, 0.1, 0.0], "tail": null, "normal": null,
            "radius": 0.09, "inside": false})
    );
    let text = sinew(&["inspect", &file]).stdout;
    assert!(text.contains("Springs (VRM 1): 3 chains of 13 bones") && text.contains("hair_left"), "{text}");

    let out = folder.path("fall.vrm");
    let bake = |more: &[&str]| {
        let object = sinew(&[&["bake", &file, "--seconds", "3", "-o", &out, "--json"], more].concat()).json();
        check_keys("bake", &object);
        let document = load_gltf(&out, ReadOptions::default()).expect("the glTF can be read");
        let clip = document.clips.last().expect("a clip");
        (object["springs"].clone(), swings(clip, &document.rig), object["hash"].clone())
    };
    let (springs, moved, hash) = bake(&[]);
    assert_eq!(springs, json!({"chains": 3, "bones": 13, "links": 0, "left_out": []}));
    assert!(moved > 0.3, "the hair rotates only by {moved} rad in the fall");
    let (springs, moved, bare) = bake(&["--no-springs"]);
    assert_eq!((&springs["bones"], moved), (&json!(0), 0.0));
    assert_ne!(hash, bare);
    folder.file("avatar.ragdoll.json", r#"{"sinew":"ragdoll-settings","version":1,"springs":"none"}"#);
    assert_eq!(bake(&[]).0["bones"], 0);
    assert_eq!(bake(&["--guess-springs"]).0["bones"], 13, "springs of the file have priority over names");
}

#[test]
fn settings_link_braids() {
    let folder = Folder::new("links");
    let file = folder.file("avatar.vrm", vrm(&maned_rig(&HAIR), SpringFormat::Vrm1));
    let out = folder.path("fall.vrm");
    let settings = |springs: &str| {
        let text = format!(r#"{{"sinew":"ragdoll-settings","version":1,"springs":{springs}}}"#);
        folder.file("avatar.ragdoll.json", text);
    };
    let bake = || {
        let object = sinew(&["bake", &file, "--seconds", "1", "-o", &out, "--json"]).json();
        check_keys("bake", &object);
        (object["springs"]["links"].clone(), object["hash"].clone())
    };
    let (none, loose) = bake();
    settings(r#"{"links": [{"chains": ["hair_left_0", "hair_right_0"], "share": 1}]}"#);
    let (four, tied) = bake();
    assert_eq!((none, four), (json!(0), json!(4)));
    assert_ne!(loose, tied, "linked and loose braids must swing differently");
    let object = sinew(&["inspect", &file, "--json"]).json();
    check_keys("inspect", &object);
    let first = json!({"joints": ["hair_left_0", "hair_right_0"], "share": 1.0, "holds_apart": false});
    assert_eq!(
        (&object["spring_links"][0], object["spring_links"].as_array().map(Vec::len)),
        (&first, Some(4))
    );
    let text = sinew(&["inspect", &file]).stdout;
    let table = text.split("Links of springs").nth(1).expect("a table");
    let row = table.lines().nth(2).expect("a row").split_whitespace().collect::<Vec<_>>();
    assert_eq!(row, ["hair_left_0", "hair_right_0", "1", "no"], "{table}");
    println!("{text}");
    for (springs, place, what) in [
        (
            r#"{"links": [{"chains": ["hair_left_0", "hair_rihgt_0"]}]}"#,
            "springs.links[0].chains[1]",
            "hair_right_0",
        ),
        (r#"{"links": [{"chains": ["hair_left_0"]}]}"#, "springs.links[0].chains", "names 1"),
        (
            r#"{"links": [{"chains": ["hips", "hair_left_0"]}]}"#,
            "springs.links[0].chains[0]",
            "has no spring",
        ),
        (r#"{"links": [{"chians": []}]}"#, "springs.links[0]", "did you mean `chains`?"),
    ] {
        settings(springs);
        let error = sinew(&["bake", &file, "-o", &out]).stderr;
        println!("{error}");
        let is_found = error.contains(place) && error.contains(what) && error.contains("avatar.ragdoll.json");
        assert!(is_found, "{springs}: {error}");
        let warned = sinew(&["inspect", &file]).stdout;
        assert!(warned.contains(what), "{springs}: {warned}");
    }
}

/// Two strands with every kind of setting in a file.
fn stated(rig: &mut Rig) {
    let hair = strands(rig);
    let bone = |strand: usize, link: usize| SpringBone {
        joint: hair[strand][link],
        tail: rig.joints[hair[strand][link + 1]].rest.translation,
        ..SpringBone::default()
    };
    let limited = |kind| Some(SpringLimit { kind, rotation: Rotation::IDENTITY });
    let cone = |degrees: f32| limited(LimitKind::Cone { angle: degrees.to_radians() });
    let down = Vec3::NEG_Y;
    let first = vec![
        SpringBone {
            stiffness: 2.0,
            gravity: down * 0.5,
            drag: 0.4,
            radius: 0.02,
            limit: cone(60.0),
            ..bone(0, 0)
        },
        SpringBone {
            stiffness: 1.0,
            gravity: down * 0.25,
            drag: 0.4,
            radius: 0.01,
            limit: cone(30.0),
            ..bone(0, 1)
        },
        SpringBone { stiffness: 0.5, drag: 0.4, radius: 0.01, ..bone(0, 2) },
    ];
    let turn = limited(LimitKind::Spherical { phi: 1.0, theta: 0.5 });
    let second = vec![SpringBone { gravity: Vec3::X * 0.3, limit: turn, ..bone(1, 0) }];
    let head = rig.joints[hair[0][0]].parent.expect("the head is its parent");
    let ball = ColliderShape::Sphere { offset: Vec3::Y * 0.1, radius: 0.09, keeps: Side::Outside };
    let (offset, tail) = (Vec3::ZERO, Vec3::Y * 0.5);
    let shapes = [
        ball,
        ColliderShape::Capsule { offset, tail, radius: 0.25, keeps: Side::Inside },
        ColliderShape::Plane { offset: Vec3::Z * -0.5, normal: Vec3::Z },
    ];
    let chain = |name: &str, bones, center, colliders: &[usize]| SpringChain {
        name: name.to_owned(),
        bones,
        center,
        colliders: colliders.to_vec(),
        hits_body: false,
    };
    rig.springs = Springs {
        chains: vec![chain("braid", first, Some(head), &[0, 1, 2]), chain("", second, None, &[0, 2])],
        colliders: shapes.map(|shape| SpringCollider { joint: head, shape }).to_vec(),
        ..Springs::default()
    };
}

/// Every setting of every joint is reported, in the text as a number or a range.
#[test]
fn inspect_reports_all_settings_of_springs() {
    let folder = Folder::new("settings");
    let mut rig = mannequin().rig;
    stated(&mut rig);
    let file = folder.file("avatar.vrm", vrm(&rig, SpringFormat::Vrm1));
    let text = sinew(&["inspect", &file]).stdout;
    let row = |with: &str| {
        let line =
            text.lines().find(|line| line.contains(with)).unwrap_or_else(|| panic!("no {with}: {text}"));
        line.split("  ").map(str::trim).filter(|cell| !cell.is_empty()).collect::<Vec<_>>()
    };
    assert!(text.contains("Springs (VRM 1): 2 chains of 4 bones"), "{text}");
    assert_eq!(
        row("  braid "),
        [
            "braid",
            "strand_0_0 to strand_0_2",
            "3",
            "0.5 to 2",
            "0 to 0.5",
            "0.4",
            "0.01 to 0.02",
            "cone 30 to 60° (2 of 3)",
            "head",
            "0-2"
        ]
    );
    assert_eq!(
        row("  -  "),
        [
            "-",
            "strand_1_0",
            "1",
            "1",
            "0.3 along (1, 0, 0)",
            "0.5",
            "0",
            "spherical 57.3° × 28.65°",
            "-",
            "0, 2"
        ]
    );
    assert_eq!(row("capsule"), ["1", "head", "capsule, inside", "0.25", "(0, 0, 0) to (0, 0.5, 0)"]);
    assert_eq!(row("plane"), ["2", "head", "plane", "-", "(0, 0, -0.5), normal (0, 0, 1)"]);
    let object = sinew(&["inspect", &file, "--json"]).json();
    check_keys("inspect", &object);
    assert_eq!(
        object["springs"][0]["bones"][2],
        json!({"joint": "strand_0_2", "tail": [0.0, -0.06, -0.02], "stiffness": 0.5, "gravity": [0.0, 0.0, 0.0],
            "drag": 0.4, "radius": 0.01, "limit": null, "limit_deg": null})
    );
    assert_eq!(object["springs"][1]["bones"][0]["limit_deg"], json!([57.29578, 28.64789]));
}

/// For random avatars of both versions, `inspect` reports as many spring bones as the reader finds.
#[test]
fn inspect_reports_springs_of_both_versions() {
    let folder = Folder::new("versions");
    let mut rig = mannequin().rig;
    let hair = strands(&mut rig);
    let mut random = Random::new(8);
    let kinds = [(SpringFormat::Vrm1, Calming::Soon, 54), (SpringFormat::Vrm0, Calming::Late, 66)];
    for (format, calming, bones) in kinds {
        rig.springs = random_avatar(&rig, &hair, calming, &mut random);
        let file = folder.file("avatar.vrm", vrm(&rig, format));
        let object = sinew(&["inspect", &file, "--json"]).json();
        check_keys("inspect", &object);
        assert_eq!(object["spring_format"], format.name());
        let bone_count = object["springs"].as_array().expect("chains").iter();
        let bone_count: usize = bone_count.map(|chain| chain["bones"].as_array().map_or(0, Vec::len)).sum();
        assert_eq!((bone_count, object["springs"].as_array().map(Vec::len)), (bones, Some(12)));
        assert!(sinew(&["inspect", &file]).stdout.contains(&format!("Springs ({})", format.name())));
    }
    rig.springs = Springs::default();
    let none = folder.file("none.vrm", vrm(&rig, SpringFormat::Vrm0));
    let text = sinew(&["inspect", &none]).stdout;
    assert!(text.contains("Springs (VRM 0): none has a joint to swing"), "{text}");
    let bare = folder.file("bare.glb", glb(&rig, &[]));
    assert_eq!(sinew(&["inspect", &bare, "--json"]).json()["spring_format"], Value::Null);
}

#[test]
fn springs_by_name_are_off_by_default() {
    let folder = Folder::new("guessed");
    let mut rig = maned_rig(&HAIR);
    rig.springs = sinew::anim::Springs::default();
    let file = folder.file("maned.glb", glb(&rig, &[]));
    let note = sinew(&["ragdoll", "doctor", &file]).stdout;
    assert!(note.contains("hair_back_0, hair_left_0, hair_right_0 could swing"), "{note}");
    let out = folder.path("fall.glb");
    let springs = |more: &[&str]| {
        let arguments = [&["bake", &file, "--seconds", "1", "-o", &out, "--json"], more].concat();
        sinew(&arguments).json()["springs"].clone()
    };
    assert_eq!(springs(&[])["bones"], 0);
    // Strands protrude and have no skin: without springs of the file, they count as props, each with a body.
    let guessed = springs(&["--guess-springs"]);
    assert_eq!(
        (&guessed["bones"], &guessed["left_out"]),
        (&json!(10), &json!(["hair_back_0", "hair_left_0", "hair_right_0"]))
    );
    assert_eq!(springs(&["--guess-springs", "--no-body", "hair_back_0"])["bones"], 11);
    let both = sinew(&["bake", &file, "-o", &out, "--no-springs", "--guess-springs"]);
    assert_eq!(both.code, Some(2));
    assert!(both.stderr.contains("cannot be used with"), "{both:?}");
}

/// A file with invalid springs fails with one line.
#[test]
fn invalid_springs_fail_with_one_line() {
    let folder = Folder::new("lying");
    let json = r#"{"asset":{"version":"2.0"},"nodes":[{}],
        "extensions":{"VRMC_springBone":{"springs":[{"joints":[{"node":7}]}]}}}"#;
    let file = folder.file("liar.gltf", json);
    let line = sinew(&["inspect", &file]);
    let line = line.refusal(1);
    assert!(line.contains("index 7 is out of range") && line.contains("springs[0].joints[0].node"), "{line}");
}

/// Every avatar of the shared data can be baked with its springs.
#[needs_data]
#[test]
fn shared_avatars_can_be_baked() {
    let data = shared_data();
    let folder = Folder::new("avatars");
    let out = folder.path("fall.vrm");
    for file in gltf_files(&data.join("rigs")).iter().filter(|file| file.ends_with(".vrm")) {
        if file.contains("unskinned") {
            // There is no skin to build a ragdoll from.
            continue;
        }
        let object = sinew(&["bake", file, "--seconds", "1", "-o", &out, "--json"]).json();
        assert!(object["springs"]["bones"].is_u64() && object["nan"] == 0, "{file}: {object:#}");
    }
}
