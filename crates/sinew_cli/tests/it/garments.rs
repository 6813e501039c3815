//! Capes and skirts in `bake`, `inspect` and `ragdoll doctor`: rigs with such bones, and invalid settings.

use crate::contract::check_keys;
use crate::sinew::{Folder, glb, sinew};
use serde_json::json;
use sinew::anim::Property;
use sinew::anim::{local_to_model, skin_vertices};
use sinew::formats::{ReadOptions, load_gltf};
use sinew::math::Affine;
use sinew_scenes::dressed::{CAPE, SKIRT, dressed_rig};
use sinew_scenes::skirted::{CELLS, skirted_rig};

#[test]
fn cape_of_the_settings_moves_in_the_bake() {
    let folder = Folder::new("garments");
    let rig = dressed_rig(&[&SKIRT, &CAPE]);
    let file = folder.file("dressed.glb", glb(&rig, &[]));
    let object = sinew(&["inspect", &file, "--json"]).json();
    check_keys("inspect", &object);
    assert_eq!(object["garments"][0]["name"], "cape");
    assert_eq!(
        (&object["garments"][0]["closed"], &object["garments"][1]["closed"]),
        (&json!(false), &json!(true))
    );
    let text = sinew(&["inspect", &file]).stdout;
    assert!(text.contains("Garment by names: cape, open, 5 chains: cape_0_0"), "{text}");
    let doctor = sinew(&["ragdoll", "doctor", &file]).stdout;
    assert!(doctor.contains("cape, skirt could be worn as cloth"), "{doctor}");

    let out = folder.path("fall.glb");
    let bake = |more: &[&str]| {
        let args = [&["bake", &file, "--seconds", "1", "-o", &out, "--json"], more].concat();
        let object = sinew(&args).json();
        check_keys("bake", &object);
        let document = load_gltf(&out, ReadOptions::default()).expect("the glTF can be read");
        let clip = document.clips.last().expect("a clip").clone();
        let turns = |channel: &&sinew::anim::Channel| {
            channel.property == Property::Rotation
                && document.rig.joints[channel.joint].name.starts_with("cape_")
        };
        (object["garments"].clone(), clip.channels.iter().filter(turns).count())
    };
    // Garments are off by default.
    assert_eq!(bake(&[]), (json!({"names": [], "bones": 0, "particles": 0, "left_out": []}), 0));
    let settings = |garments: &str| {
        let text = format!(r#"{{"sinew": "ragdoll-settings", "version": 1, "garments": {garments}}}"#);
        folder.file("dressed.ragdoll.json", text);
    };
    settings(r#"[{"name": "cape", "chains": ["cape_*"]}]"#);
    let (report, moving) = bake(&[]);
    assert_eq!((&report["names"], moving), (&json!(["cape"]), CAPE.columns * CAPE.bones));
    assert_eq!(bake(&["--no-garments"]).1, 0);
    settings(r#""names""#);
    assert_eq!(bake(&[]).0["names"], json!(["cape", "skirt"]));
    settings(r#"[{"chains": ["caep_0_0", "cape_1_0"]}]"#);
    let error = sinew(&["bake", &file, "-o", &out]).stderr;
    assert!(error.contains("garments[0].chains[0]") && error.contains("cape_0_0"), "{error}");
}

/// A skirt mesh becomes cloth in the written file: one joint per particle, with the skirt's vertices weighted to these
/// joints; the rest is unchanged.
#[test]
fn mesh_garment_of_the_settings_becomes_cloth_in_the_bake() {
    let folder = Folder::new("mesh_garments");
    let rig = skirted_rig(CELLS);
    let file = folder.file("skirted.glb", glb(&rig, &[]));
    let settings = |garment: &str| {
        let text = format!(r#"{{"sinew": "ragdoll-settings", "version": 1, "garments": [{garment}]}}"#);
        folder.file("skirted.ragdoll.json", text);
    };
    settings(r#"{"name": "skirt", "mesh": "Skirt"}"#);
    let out = folder.path("fall.glb");
    let bake =
        |more: &[&str]| sinew(&[&["bake", &file, "--seconds", "2", "-o", &out, "--json"], more].concat());
    let object = bake(&[]).json();
    check_keys("bake", &object);
    let particles = object["garments"]["particles"].as_u64().expect("a number") as usize;
    assert!((200..=400).contains(&particles), "{particles}");
    assert!(object["skin"]["covered_share"].as_f64().expect("a number") > 0.95, "{}", object["skin"]);

    let before = load_gltf(&file, ReadOptions::default()).expect("the input").rig;
    let baked = load_gltf(&out, ReadOptions::default()).expect("the glTF can be read");
    assert_eq!(baked.rig.joints.len(), before.joints.len() + particles);
    let skirt =
        |rig: &sinew::anim::Rig| rig.meshes.iter().position(|mesh| mesh.name == "Skirt").expect("a skirt");
    let (old, new) =
        (&before.meshes[skirt(&before)].primitives[0], &baked.rig.meshes[skirt(&baked.rig)].primitives[0]);
    assert_eq!((&old.positions, &old.indices), (&new.positions, &new.indices));
    let skin = &baked.rig.skins[baked.rig.meshes[skirt(&baked.rig)].skin.expect("a skin")];
    let is_cloth = |slot: u16| baked.rig.joints[skin.joints[usize::from(slot)]].name.starts_with("cloth_0_");
    for (slots, weights) in new.joints.iter().zip(&new.weights) {
        let hangs = slots.iter().zip(weights).filter(|(_, weight)| **weight > 0.0);
        assert!(
            hangs.clone().count() > 0 && hangs.clone().all(|(&slot, _)| is_cloth(slot)),
            "part of the mesh is not cloth"
        );
    }
    // At rest the skirt is drawn as in the input.
    let drawn = |rig: &sinew::anim::Rig| {
        let rest: Vec<_> = rig.joints.iter().map(|joint| joint.rest).collect();
        let (mut model, mut places, mut normals) = (Vec::new(), Vec::new(), Vec::new());
        local_to_model(rig, &rest, &Affine::IDENTITY, &mut model);
        skin_vertices(rig, skirt(rig), 0, &model, &mut places, &mut normals);
        places
    };
    let pairs = drawn(&before).into_iter().zip(drawn(&baked.rig));
    let off = pairs.map(|(a, b)| (a - b).length()).fold(0.0, f32::max);
    assert!(off < 1e-5, "off by {off} m");
    let moving = |property: Property| {
        let clip = baked.clips.last().expect("a clip");
        let named = |joint: usize| baked.rig.joints[joint].name.starts_with("cloth_0_");
        clip.channels.iter().filter(|channel| channel.property == property && named(channel.joint)).count()
    };
    assert!(moving(Property::Translation) > particles / 2, "{}", moving(Property::Translation));

    assert_eq!(bake(&["--no-garments"]).json()["garments"]["particles"], 0);
    let bare = load_gltf(&out, ReadOptions::default()).expect("the glTF can be read").rig;
    assert_eq!(bare.meshes, before.meshes, "the meshes changed");
}

/// `inspect` and the doctor report garments of the settings: for a mesh, its particle count, and that triangles are
/// drawn coarser than the cloth.
#[test]
fn garments_of_the_settings_are_reported() {
    let folder = Folder::new("worn_garments");
    let file = folder.file("skirted.glb", glb(&skirted_rig([10, 4]), &[]));
    assert_eq!(sinew(&["inspect", &file, "--json"]).json()["worn"], json!([]));
    let settings = |garment: &str| {
        let text = format!(r#"{{"sinew": "ragdoll-settings", "version": 1, "garments": [{garment}]}}"#);
        folder.file("skirted.ragdoll.json", text);
    };
    settings(r#"{"name": "skirt", "mesh": "Skirt", "backstop": {"distance": 0.01}}"#);
    let object = sinew(&["inspect", &file, "--json"]).json();
    check_keys("inspect", &object);
    let worn = &object["worn"][0];
    assert_eq!(
        (&worn["name"], &worn["mesh"], &worn["chains"]),
        (&json!("skirt"), &json!("Skirt"), &json!(0))
    );
    let number = |key: &str| worn[key].as_f64().expect("a number");
    // Ten around and five down, and a buckle.
    assert_eq!(number("vertices"), 54.0);
    assert!((200.0..=400.0).contains(&number("particles")), "{worn}");
    assert!(number("held") >= 10.0 && number("held") < 0.3 * number("particles"), "{worn}");
    assert!((0.15..0.3).contains(&number("longest_edge_m")) && number("spacing_m") == 0.05, "{worn}");
    assert_eq!(worn["backstop"], json!({"distance_m": 0.01, "radius_m": 0.2}));
    for text in [sinew(&["inspect", &file]).stdout, sinew(&["ragdoll", "doctor", &file]).stdout] {
        assert!(text.contains("skirt is cloth of the mesh Skirt with 54 vertices"), "{text}");
        assert!(text.contains("backstops 0.01 m below it at rest, of 0.2 m"), "{text}");
        assert!(text.contains("skirt is drawn in triangles of up to 0."), "{text}");
        assert!(!text.contains("could be worn"), "{text}");
    }
    folder.file("skirted.glb", glb(&skirted_rig(CELLS), &[]));
    settings(r#"{"name": "skirt", "mesh": "Skirt"}"#);
    let text = sinew(&["inspect", &file]).stdout;
    assert!(text.contains("no backstops") && !text.contains("is drawn in triangles"), "{text}");
    settings(r#"{"mesh": "Skrit"}"#);
    let object = sinew(&["inspect", &file, "--json"]).json();
    assert!(object["worn"] == json!([]) && object["warnings"].to_string().contains("Skirt"), "{object}");
}

#[test]
fn invalid_mesh_garment_settings_name_file_and_place() {
    let folder = Folder::new("mesh_garment_errors");
    let file = folder.file("skirted.glb", glb(&skirted_rig(CELLS), &[]));
    let out = folder.path("fall.glb");
    for (garment, place, told) in [
        (r#"{"mesh": "Skrit"}"#, "garments[0].mesh", "Skirt"),
        (r#"{"mesh": "Skirt", "chains": ["hips"]}"#, "garments[0].chains", "not both"),
        (r#"{"mesh": "Skirt", "held": 2}"#, "garments[0].held", "no part can move"),
        (r#"{"chains": ["hips"], "held": 0.1}"#, "garments[0].held", "only a garment with a `mesh`"),
        (r#"{"mesh": "Skirt", "most_particles": 2}"#, "garments[0].most_particles", "between 4 and 4000"),
        (r#"{"mesh": "Skirt"}, {"mesh": "Tartan"}"#, "garments[1].mesh", "a garment already"),
    ] {
        let text = format!(r#"{{"sinew": "ragdoll-settings", "version": 1, "garments": [{garment}]}}"#);
        folder.file("skirted.ragdoll.json", text);
        let error = sinew(&["bake", &file, "-o", &out]).stderr;
        assert!(
            error.contains(place) && error.contains(told) && error.contains("skirted.ragdoll.json"),
            "{error}"
        );
    }
}
