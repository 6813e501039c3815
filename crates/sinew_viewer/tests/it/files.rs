//! Files that are dropped on the viewer.

use crate::hands::viewer;
use crate::pictures::look;
use sinew::formats::write_gltf;
use std::path::{Path, PathBuf};

/// A folder of this test alone, empty.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    if folder.exists() {
        std::fs::remove_dir_all(&folder).expect("it is ours");
    }
    std::fs::create_dir_all(&folder).expect("the target folder is there");
    folder
}

#[test]
fn a_character_that_is_dropped_falls() {
    let Some(mut viewer) = viewer("pendulum", [640, 360]) else { return };
    let path = folder("dropped_character").join("mannequin.glb");
    let mannequin = sinew::mannequin::mannequin();
    let bytes = write_gltf(&mannequin.rig, &mannequin.clips).expect("it can be written");
    std::fs::write(&path, bytes).expect("the folder is there");
    viewer.app_mut().open_file(&path);
    let session = viewer.app().session();
    assert_eq!(session.subject().title(), "mannequin.glb");
    assert!(session.report()[0].ends_with("4 clips"), "{:?}", session.report());
    let height = |viewer: &sinew_viewer::Headless| {
        let world = viewer.app().session().world();
        let heights = world.body_ids().map(|id| world.transform(id).translation.y);
        heights.fold(0.0, f32::max)
    };
    let before = height(&viewer);
    for _ in 0..120 {
        viewer.key(egui::Key::N);
        viewer.frame().expect("the card draws");
    }
    look("dropped", &viewer.frame().expect("the card draws"));
    assert_eq!(viewer.app().session().world().step_count(), 120);
    let after = height(&viewer);
    assert!(before > 1.2 && after < 0.5 * before, "highest body at {before} m, then at {after} m");
}

#[test]
fn what_cannot_be_read_is_a_line_and_changes_nothing() {
    let Some(mut viewer) = viewer("pendulum", [640, 360]) else { return };
    let folder = folder("dropped_nonsense");
    let nonsense: [(&str, &[u8]); 6] = [
        ("cut.glb", b"glTF\x02\0\0\0\xff\0\0\0"),
        ("empty.vrm", b""),
        ("noise.fbx", b"Kaydara FBX Binary  \0\x1a\0\xff\xff\xff\xff"),
        ("world.json", b"{\"bodies\": ["),
        ("cut.sinewrec", b"sinewrec\x01\0"),
        ("picture.png", b"\x89PNG"),
    ];
    for (name, bytes) in nonsense {
        let path = folder.join(name);
        std::fs::write(&path, bytes).expect("the folder is there");
        viewer.app_mut().open_file(&path);
        let line = viewer.app().message().expect("a line").to_owned();
        println!("{line}");
        assert!(line.contains(name) && !line.contains('\n'), "{name}: {line}");
        assert_eq!(viewer.app().session().subject().title(), "pendulum", "{name}");
    }
}
