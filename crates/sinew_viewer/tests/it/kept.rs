//! Stored pictures of the viewer: each is compared with one that a person has checked, and again after a change that the
//! comparison must detect.
//!
//! Ignored unless asked for: `cargo xtask ci --full` runs them. Without a driver they print that they skip. Drivers round
//! differently, so pictures may differ a little. `SINEW_BLESS=1` writes them to `tests/pictures`.

use crate::editor::choose;
use crate::files::mannequin_glb;
use crate::hands::settled;
use crate::pictures::{camera, gpu, look, paint};
use crate::timeline::recorded;
use egui::Key;
use sinew::math::Vec3;
use sinew_picture::{Image, PictureFormat, Scene, Sun, encode};
use sinew_viewer::{App, Headless, Layer, NamedFile, Offscreen, Options, Orbit, Stage, Subject};
use std::path::{Path, PathBuf};

/// Size of the viewer, points; stored pictures are half as large.
const SIZE: [u32; 2] = [880, 496];
/// Side of a tile, pixels of a stored picture.
const TILE: u32 = 12;
/// Largest difference of the means of a tile, of 255. Edges and rounding of another driver stay below a third of this
/// value.
const MOST_OF_TILE: f64 = 6.0;
/// Largest share of pixels that differ by more than 40 in one channel.
const MOST_FAR: f64 = 0.01;
/// Limit on the bytes of a stored picture.
const MOST_BYTES: usize = 40 << 10;

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pictures").join(format!("{name}.png"))
}

/// Returns the picture at half the size, with colours in steps of 8, which hides rounding of drivers and keeps files
/// small.
fn halved(image: &Image) -> Image {
    let (width, height) = (image.width / 2, image.height / 2);
    let mut rgba = Vec::new();
    for y in 0..height {
        for x in 0..width {
            for channel in 0..4 {
                let of = |dx: u32, dy: u32| u32::from(image.pixel(2 * x + dx, 2 * y + dy)[channel]);
                let mean = (of(0, 0) + of(1, 0) + of(0, 1) + of(1, 1) + 2) / 4;
                rgba.push(if channel == 3 { 255 } else { (((mean + 4) / 8) * 8).min(255) as u8 });
            }
        }
    }
    Image { width, height, rgba }
}

/// Returns the largest difference of the means of a tile, and the share of pixels that are far off.
fn difference(a: &Image, b: &Image) -> (f64, f64) {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let (mut worst, mut far) = (0.0, 0);
    for top in (0..a.height).step_by(TILE as usize) {
        for left in (0..a.width).step_by(TILE as usize) {
            let mut sums = [0_i64; 3];
            let mut count = 0;
            for y in top..(top + TILE).min(a.height) {
                for x in left..(left + TILE).min(a.width) {
                    let (p, q) = (a.pixel(x, y), b.pixel(x, y));
                    let by: [i64; 3] = core::array::from_fn(|i| i64::from(p[i]) - i64::from(q[i]));
                    far += i64::from(by.iter().any(|it| it.abs() > 40));
                    (0..3).for_each(|i| sums[i] += by[i]);
                    count += 1;
                }
            }
            worst =
                sums.iter().fold(worst, |worst: f64, &sum| worst.max(sum.abs() as f64 / f64::from(count)));
        }
    }
    (worst, far as f64 / f64::from(a.width * a.height))
}

fn is_alike((tile, far): (f64, f64)) -> bool {
    tile <= MOST_OF_TILE && far <= MOST_FAR
}

fn read(name: &str) -> Image {
    let bytes = std::fs::read(path(name)).expect("the picture is in tests/pictures");
    assert!(bytes.len() <= MOST_BYTES, "{name} has {} bytes", bytes.len());
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("the file is a PNG");
    let (width, height) = (reader.info().width, reader.info().height);
    let mut rgba = vec![0; reader.output_buffer_size().expect("the picture fits into memory")];
    let info = reader.next_frame(&mut rgba).expect("the picture is complete");
    rgba.truncate(info.buffer_size());
    if info.color_type == png::ColorType::Rgb {
        rgba = rgba.chunks_exact(3).flat_map(|p| [p[0], p[1], p[2], 255]).collect();
    }
    Image { width, height, rgba }
}

/// Compares a picture with the stored one; `changed`, in which something is missing or moved, must differ.
fn check(name: &str, picture: &Image, changed: &Image) {
    let [picture, changed] = [picture, changed].map(halved);
    let png =
        |image: &Image| encode::encode(PictureFormat::Png, std::slice::from_ref(image), 1).expect("a PNG");
    if std::env::var_os("SINEW_BLESS").is_some() {
        std::fs::create_dir_all(path(name).parent().expect("a folder")).expect("the folder can be created");
        std::fs::write(path(name), png(&picture)).expect("the file can be written");
    }
    look(name, &picture);
    look(&format!("{name}_changed"), &changed);
    let kept = read(name);
    let (found, other) = (difference(&kept, &picture), difference(&kept, &changed));
    println!(
        "{name}: tile {:.2}, far {:.3} %; changed: tile {:.1}, far {:.2} %",
        found.0,
        100.0 * found.1,
        other.0,
        100.0 * other.1
    );
    if !is_alike(found) {
        let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.png"));
        std::fs::write(&place, png(&picture)).expect("the target folder exists");
        panic!("{} differs from the stored picture: {found:?}; SINEW_BLESS=1 replaces it", place.display());
    }
    assert!(!is_alike(other), "{name}: the comparison misses a change: {other:?}");
}

/// Returns a paused viewer of a subject without times.
fn open(subject: Option<Subject>) -> Option<Headless> {
    let options = Options { subject, paused: true, hides_times: true, ..Options::default() };
    let mut viewer = Headless::new(App::new(options).expect("the viewer starts"), gpu()?, SIZE);
    settled(&mut viewer);
    Some(viewer)
}

fn scene(name: &str, settings: &[&str], steps: u32) -> Option<Headless> {
    let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
    let mut viewer = open(Some(Subject::scene(name, &settings).expect("the scene exists")))?;
    step(&mut viewer, steps);
    Some(viewer)
}

fn step(viewer: &mut Headless, steps: u32) {
    for _ in 0..steps {
        viewer.app_mut().step();
    }
}

/// Moves the camera nearer.
fn near(viewer: &mut Headless, by: f32) {
    let orbit = viewer.app().orbit();
    viewer.app_mut().set_orbit(Orbit { distance: by * orbit.distance, ..orbit });
}

/// Checks the picture now against the one after a change.
fn check_change(name: &str, viewer: &mut Headless, change: impl FnOnce(&mut Headless)) {
    let picture = settled(viewer);
    change(viewer);
    check(name, &picture, &settled(viewer));
}

/// Checks the picture with a layer against the one without.
fn check_layer(name: &str, viewer: &mut Headless, layer: Layer) {
    viewer.app_mut().toggle(layer);
    check_change(name, viewer, |viewer| viewer.app_mut().toggle(layer));
}

fn mannequin() -> Vec<NamedFile> {
    vec![NamedFile { name: "mannequin.glb".into(), bytes: mannequin_glb() }]
}

#[test]
#[ignore = "compares pictures: cargo xtask ci --full"]
fn first_minute() {
    let Some(mut viewer) = open(None) else { return };
    check_change("first_minute", &mut viewer, |viewer| viewer.key(Key::Escape));
}

#[test]
#[ignore = "compares pictures: cargo xtask ci --full"]
fn help() {
    let Some(mut viewer) = scene("pendulum", &[], 0) else { return };
    viewer.text("?");
    check_change("help", &mut viewer, |viewer| viewer.text("?"));
}

#[test]
#[ignore = "compares pictures: cargo xtask ci --full"]
fn search() {
    let Some(mut viewer) = scene("pendulum", &[], 0) else { return };
    viewer.text("/");
    settled(&mut viewer);
    viewer.text("rope");
    check_change("search", &mut viewer, |viewer| viewer.text("x"));
}

#[test]
#[ignore = "compares pictures: cargo xtask ci --full"]
fn figures() {
    let Some(mut viewer) = scene("pendulum", &[], 150) else { return };
    check_change("figures", &mut viewer, |viewer| step(viewer, 40));
}

#[test]
#[ignore = "compares pictures: cargo xtask ci --full"]
fn crowd() {
    let Some(mut viewer) = scene("street", &["n=20"], 60) else { return };
    near(&mut viewer, 0.35);
    check_change("crowd", &mut viewer, |viewer| viewer.app_mut().toggle(Layer::Bones));
}

#[test]
#[ignore = "compares pictures: cargo xtask ci --full"]
fn shapes_and_shadows() {
    let Some(gpu) = gpu() else { return };
    let mut offscreen = Offscreen::new(gpu, SIZE);
    let mut picture = |sun: Sun| {
        let mut stage = Stage::of(Scene { sun, ..Scene::default() });
        paint(&mut stage);
        offscreen.render(&stage, &camera()).expect("the card draws")
    };
    let sun = Sun { shadow_radius: 4.0, ..Sun::default() };
    let (here, elsewhere) = (picture(sun), picture(Sun { direction: Vec3::new(-0.5, 1.0, 0.2), ..sun }));
    check("shapes_and_shadows", &here, &elsewhere);
}

#[test]
#[ignore = "compares pictures: cargo xtask ci --full"]
fn joint_limits() {
    let Some(mut viewer) = scene("ragdoll_drop", &[], 20) else { return };
    viewer.app_mut().toggle(Layer::Bones);
    check_layer("joint_limits", &mut viewer, Layer::Limits);
}

#[test]
#[ignore = "compares pictures: cargo xtask ci --full"]
fn contacts() {
    let Some(mut viewer) = scene("stack", &[], 60) else { return };
    check_layer("contacts", &mut viewer, Layer::Contacts);
}

/// Half of the dominoes are still awake.
#[test]
#[ignore = "compares pictures: cargo xtask ci --full"]
fn islands() {
    let Some(mut viewer) = scene("dominoes", &[], 90) else { return };
    near(&mut viewer, 0.6);
    check_layer("islands", &mut viewer, Layer::Islands);
}

#[test]
#[ignore = "compares pictures: cargo xtask ci --full"]
fn fields() {
    let Some(mut viewer) = scene("float", &[], 60) else { return };
    near(&mut viewer, 0.5);
    check_layer("fields", &mut viewer, Layer::Fields);
}

#[test]
#[ignore = "compares pictures: cargo xtask ci --full"]
fn cloth() {
    let Some(mut viewer) = scene("curtain", &[], 60) else { return };
    check_change("cloth", &mut viewer, |viewer| step(viewer, 60));
}

#[test]
#[ignore = "compares pictures: cargo xtask ci --full"]
fn particles() {
    let Some(mut viewer) = scene("blob", &[], 50) else { return };
    check_change("particles", &mut viewer, |viewer| step(viewer, 60));
}

#[test]
#[ignore = "compares pictures: cargo xtask ci --full"]
fn dropped_file() {
    let Some(mut viewer) = open(None) else { return };
    viewer.app_mut().open_dropped(mannequin());
    settled(&mut viewer);
    step(&mut viewer, 35);
    near(&mut viewer, 0.6);
    check_change("dropped_file", &mut viewer, |viewer| step(viewer, 60));
}

#[test]
#[ignore = "compares pictures: cargo xtask ci --full"]
fn edited_limit() {
    let Some(mut viewer) = open(None) else { return };
    viewer.app_mut().open_dropped(mannequin());
    settled(&mut viewer);
    choose(&mut viewer, "leftUpperArm");
    let orbit = Orbit { distance: 1.3, pitch: -0.12, ..viewer.app().orbit() };
    viewer.app_mut().set_orbit(Orbit { target: Vec3::new(0.1, 1.9, 0.3), ..orbit });
    check_change("edited_limit", &mut viewer, |viewer| {
        for _ in 0..3 {
            viewer.key(Key::Minus);
            viewer.frame().expect("the card draws");
        }
    });
}

/// A recording that was rewound, and a second run that diverges from it.
#[test]
#[ignore = "compares pictures: cargo xtask ci --full"]
fn timeline_with_ghost() {
    let first = recorded("stack", 100, None);
    let Some(mut viewer) = open(Some(Subject::Recording("first.sinewrec".into(), Box::new(first)))) else {
        return;
    };
    viewer.app_mut().compare_with("second.sinewrec", recorded("stack", 100, Some(30)));
    for step in [100, 60] {
        viewer.app_mut().seek(step);
        (0..200).for_each(|_| viewer.app_mut().advance());
        assert_eq!(viewer.app().session().world().step_count(), step);
    }
    check_change("timeline_with_ghost", &mut viewer, |viewer| {
        viewer.app_mut().seek(20);
        (0..200).for_each(|_| viewer.app_mut().advance());
    });
}

#[test]
#[ignore = "compares pictures: cargo xtask ci --full"]
fn refused_file() {
    let Some(mut viewer) = scene("coin", &[], 100) else { return };
    viewer.app_mut().open_dropped(vec![NamedFile { name: "cut.glb".into(), bytes: b"glTF".to_vec() }]);
    check_change("refused_file", &mut viewer, |viewer| viewer.app_mut().tell(""));
}
