//! Capes and skirts in `bake`, `inspect` and `ragdoll doctor`: of a rig with such bones, and of settings that are wrong.

use crate::contract::check_keys;
use crate::sinew::{Folder, glb, sinew};
use serde_json::json;
use sinew::anim::Property;
use sinew::formats::{ReadOptions, load_gltf};
use sinew_scenes::dressed::{CAPE, SKIRT, dressed_rig};

#[test]
fn a_cape_moves_in_the_bake_that_settings_ask_for() {
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
        let document = load_gltf(&out, ReadOptions::default()).expect("it can be read");
        let clip = document.clips.last().expect("a clip").clone();
        let turns = |channel: &&sinew::anim::Channel| {
            channel.property == Property::Rotation
                && document.rig.joints[channel.joint].name.starts_with("cape_")
        };
        (object["garments"].clone(), clip.channels.iter().filter(turns).count())
    };
    // Not by default.
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
