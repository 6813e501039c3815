//! Characters from files.

use super::*;
use bevy_asset::io::memory::{Dir, MemoryAssetReader};
use bevy_asset::io::{AssetSourceBuilder, AssetSourceId};
use bevy_asset::{AssetApp, AssetPlugin, AssetServer};
use bevy_sinew::sinew::{formats, mannequin};
use std::path::Path;

fn file() -> Vec<u8> {
    let mannequin = mannequin::mannequin();
    formats::write_gltf(&mannequin.rig, &mannequin.clips).expect("the rig can be written as glTF")
}

#[test]
fn one_component_loads_a_character() {
    let dir = Dir::default();
    dir.insert_asset(Path::new("hero.glb"), file());
    let mut app = App::new();
    let reader = move || Box::new(MemoryAssetReader { root: dir.clone() }) as _;
    app.register_asset_source(AssetSourceId::Default, AssetSourceBuilder::new(reader));
    app.add_plugins((bevy_app::TaskPoolPlugin::default(), TimePlugin, AssetPlugin::default()));
    app.add_plugins((SinewPlugin::default(), SinewGltfPlugin));
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    ground(&mut app);
    let hero = app.world().resource::<AssetServer>().load("hero.glb");
    let entity = app.world_mut().spawn(CharacterScene(hero)).id();
    for _ in 0..10_000 {
        app.update();
        if app.world().get::<CharacterHandle>(entity).is_some() {
            break;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let handle = app.world().get::<CharacterHandle>(entity).expect("the entity has this component");
    assert!(handle.bodies().len() > 10);
    assert_eq!(handle.def().rig.skins.len(), 1);
}

#[test]
fn settings_name_clips() {
    let clips = mannequin::mannequin().clips;
    let named = CharacterSettings { walk: Some(clips[0].name.clone()), ..CharacterSettings::default() };
    let read = read_character(&file(), "hero.glb", &named).expect("the file is a character");
    assert_eq!(read.def.motions().looped, Some(0));
    assert!(!read.def.motions().get_ups.is_empty());
    let wrong = CharacterSettings { idle: Some("no such".into()), ..CharacterSettings::default() };
    let error = read_character(&file(), "hero.glb", &wrong).expect_err("the file lacks this clip");
    assert_eq!(error.to_string(), "no clip is called `no such`");
    assert!(read_character(b"no file", "no.glb", &CharacterSettings::default()).is_err());
}
