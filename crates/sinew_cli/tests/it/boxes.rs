//! `sinew boxes` on generated meshes, on the house of the shared data, and on invalid files.

use crate::contract::check_keys;
use crate::sinew::{Folder, gltf_files, shared_data, sinew};
use needs_data::needs_data;
use serde_json::Value;
use sinew::formats::read_world;
use sinew::math::Vec3;
use sinew::physics::{BodyDef, BodyId, BodyKind, Material, Shape, ShapeDef, World, WorldDef};
use std::fmt::Write;
use std::fs;

/// Returns an OBJ of boxes, given by lowest and highest corner.
fn obj_of_boxes(boxes: &[[[f32; 3]; 2]]) -> String {
    let mut text = String::new();
    for (index, [low, high]) in boxes.iter().enumerate() {
        for corner in 0..8 {
            let p = [0, 1, 2].map(|axis| if corner >> axis & 1 == 1 { high[axis] } else { low[axis] });
            writeln!(text, "v {} {} {}", p[0], p[1], p[2]).expect("a string takes it");
        }
        for face in [[1, 5, 7, 3], [2, 4, 8, 6], [1, 2, 6, 5], [3, 7, 8, 4], [1, 3, 4, 2], [5, 6, 8, 7]] {
            let [a, b, c, d] = face.map(|corner| corner + 8 * index);
            writeln!(text, "f {a} {b} {c} {d}").expect("a string takes it");
        }
    }
    text
}

fn bodies(path: &str) -> Vec<BodyDef> {
    read_world(&fs::read(path).expect("the world is written")).expect("and can be read")
}

fn number(object: &Value, key: &str) -> f64 {
    object[key].as_f64().unwrap_or_else(|| panic!("{key} is a number: {object:#}"))
}

#[test]
fn mesh_of_boxes_gives_the_same_boxes() {
    let folder = Folder::new("boxes");
    let table = [[[-1.0, 0.7, -0.5], [1.0, 0.8, 0.5]], [[-0.9, 0.0, -0.4], [-0.8, 0.7, -0.3]]];
    let (file, out) = (folder.file("table.obj", obj_of_boxes(&table)), folder.path("table.json"));
    let object = sinew(&["boxes", &file, "-o", &out, "--json"]).json();
    check_keys("boxes", &object);
    assert_eq!(
        (&object["boxes"], &object["triangles"], &object["parts"]),
        (&2.into(), &24.into(), &2.into())
    );
    assert!((number(&object, "volume_ratio") - 1.0).abs() < 0.01, "{object:#}");
    assert!(number(&object, "distance_max_m") < 1e-4, "{object:#}");
    let bodies = bodies(&out);
    for ([low, high], body) in table.iter().zip(&bodies) {
        let (low, high) = (Vec3::from_array(*low), Vec3::from_array(*high));
        let Shape::Box { half_extents } = body.shapes[0].shape else { panic!("a box: {body:?}") };
        assert!((body.position - (low + high) * 0.5).length() < 1e-5, "{body:?}");
        assert!((half_extents - (high - low) * 0.5).length() < 1e-5, "{body:?}");
        assert_eq!((body.kind, body.shapes.len()), (BodyKind::Static, 1));
    }
    assert_eq!(folder.names(), ["table.json", "table.obj"]);
}

#[needs_data]
#[test]
fn house_keeps_its_stairs_and_serves_as_a_world() {
    let data = shared_data();
    let folder = Folder::new("house");
    let file = data.join("worlds/house_2story_stairs.glb").display().to_string();
    let (out, picture) = (folder.path("house.json"), folder.path("house.png"));
    let object = sinew(&["boxes", &file, "-o", &out, "--picture", &picture, "--json"]).json();
    check_keys("boxes", &object);
    let height = number(&object, "height_m");
    assert!(number(&object, "boxes") <= 150.0, "{object:#}");
    assert!(number(&object, "distance_p95_m") <= 0.05 * height, "{object:#}");
    assert!(object["volume_ratio"].is_null(), "the house is open below: {object:#}");
    assert!(fs::metadata(&picture).expect("the picture is written").len() > 10_000);
    let bodies = bodies(&out);
    assert_eq!(bodies.len() as f64, number(&object, "boxes"));
    bounce_down(&bodies);
    let (character, fall) = (folder.mannequin(), folder.path("fall.glb"));
    let baked =
        sinew(&["bake", &character, "--world", &out, "--seconds", "0.2", "-o", &fall, "--json"]).json();
    assert_eq!(baked["nan"], 0);
}

/// Heights of the house's three steps as drawn, from the door down, metres.
const STEPS: [f32; 3] = [0.177, 0.128, 0.080];
const BALL: f32 = 0.04;

/// A rubber ball dropped on the top step touches each step in turn at its height, and then the ground.
fn bounce_down(house: &[BodyDef]) {
    let mut world = World::new(WorldDef::default());
    let ids: Vec<BodyId> = house.iter().map(|body| world.add_body(body)).collect();
    let ground = ShapeDef::new(Shape::HalfSpace);
    let ground =
        world.add_body(&BodyDef { kind: BodyKind::Static, shapes: vec![ground], ..BodyDef::default() });
    let rubber = Material { restitution: 0.3, ..Material::default() };
    let ball = ShapeDef { material: rubber, ..ShapeDef::new(Shape::Sphere { radius: BALL }) };
    let ball = world.add_body(&BodyDef {
        position: Vec3::new(0.0, STEPS[0] + BALL + 0.05, 1.07),
        linear_velocity: Vec3::new(0.0, 0.0, 0.35),
        shapes: vec![ball],
        ..BodyDef::default()
    });
    // Bodies that the ball touches, in the order of first contacts.
    let mut met: Vec<BodyId> = Vec::new();
    for _ in 0..240 {
        world.step();
        let of_ball = |&(a, b): &(BodyId, BodyId)| match ball {
            id if id == a => Some(b),
            id => (id == b).then_some(a),
        };
        for other in world.events().begin.iter().filter_map(of_ball) {
            if !met.contains(&other) {
                met.push(other);
            }
        }
    }
    let index = |id: &BodyId| ids.iter().position(|other| other == id);
    let tops: Vec<f32> = met
        .iter()
        .filter_map(index)
        .map(|index| {
            let body = &house[index];
            let Shape::Box { half_extents } = body.shapes[0].shape else { panic!("a box: {body:?}") };
            body.position.y + half_extents.y
        })
        .collect();
    assert_eq!(tops.len(), 3, "one box for each step: {tops:?}");
    for (top, step) in tops.iter().zip(STEPS) {
        assert!((top - step).abs() < 0.005, "{tops:?}");
    }
    assert_eq!(met.last(), Some(&ground), "the ball does not come to rest on the ground");
}

#[needs_data]
#[test]
fn dungeon_pieces_give_few_accurate_boxes() {
    let data = shared_data();
    let folder = Folder::new("dungeon");
    // For the floor tile the only error is its missing underside.
    for (piece, share) in [("stairs", 0.05), ("wall", 0.05), ("floor_tile_large", 1.01)] {
        let file = data.join(format!("worlds/kaykit_dungeon/{piece}.obj")).display().to_string();
        let object = sinew(&["boxes", &file, "-o", &folder.path("out.json"), "--json"]).json();
        assert!(number(&object, "boxes") <= 150.0, "{object:#}");
        let (p95, height) = (number(&object, "distance_p95_m"), number(&object, "height_m"));
        assert!(p95 <= share * height, "{object:#}");
    }
}

/// Checks that the command fails with a line that names the file, and writes no output.
fn check_refused(folder: &Folder, file: &str, reason: &str) {
    let before = folder.names();
    let run = sinew(&["boxes", file, "-o", &folder.path("out.json")]);
    let line = run.refusal(1);
    assert!(line.starts_with(&format!("error: {file}: ")) && line.contains(reason), "{line}");
    assert_eq!((run.stdout.as_str(), folder.names()), ("", before));
}

#[test]
fn invalid_objs_are_rejected() {
    let folder = Folder::new("lies");
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    for (name, text, reason) in [
        ("empty.obj", String::new(), "not an OBJ file"),
        ("prose.obj", "To whom it may concern\n".into(), "unknown word `To` (line 1)"),
        ("points.obj", square.into(), "there are no triangles"),
        ("nan.obj", format!("{square}v nan 0 0\nf 1 2 5\n"), "`nan` is not finite (line 5)"),
        ("infinite.obj", "v 1e999 0 0\nf 1 1 1\n".into(), "is not finite (line 1)"),
        ("far.obj", "v 1e9 0 0\nv 0 0 0\nv 0 1 0\nf 1 2 3\n".into(), "beyond 10⁶ m (triangle 0, vertex 0)"),
        ("beyond.obj", format!("{square}f 1 2 5\n"), "index 5 is out of range"),
        ("zero.obj", format!("{square}f 0 1 2\n"), "index 0 is out of range"),
        ("below.obj", format!("{square}f -5 1 2\n"), "index -5 is out of range"),
        ("word.obj", format!("{square}f a b c\n"), "`a` is not an index (line 5)"),
        ("line.obj", format!("{square}f 1 2\n"), "a face with 2 corners (line 5)"),
        ("flat.obj", format!("{square}f 1 1 2\nf 3 3 3\n"), "none of the 2 triangles has an area"),
        ("short.obj", "v 0 0\n".into(), "a vertex without z (line 1)"),
    ] {
        let file = folder.file(name, text);
        check_refused(&folder, &file, reason);
    }
    let binary = folder.file("binary.obj", [0xff, 0xfe, 0x00, 0x01]);
    check_refused(&folder, &binary, "not text in UTF-8 (byte 0)");
    check_refused(&folder, &folder.path("missing.obj"), "no such file");
    let good = folder.file("good.obj", format!("{square}f 1 2 3 4\n"));
    let run = sinew(&["boxes", &good, "-o", &good]);
    assert!(run.refusal(2).ends_with("is an input: write to another file"), "{run:?}");
}

#[needs_data]
#[test]
fn bad_input_gives_boxes_or_an_error() {
    let data = shared_data();
    let folder = Folder::new("bad-boxes");
    for file in gltf_files(&data.join("bad_input")) {
        let run = sinew(&["boxes", &file, "-o", &folder.path("out.json")]);
        match run.code {
            Some(0) => assert!(run.stderr.is_empty() && !run.stdout.is_empty(), "{file}: {run:?}"),
            _ => assert!(run.refusal(1).starts_with(&format!("error: {file}: ")), "{file}: {run:?}"),
        }
    }
}
