//! `sinew boxes` on meshes of its own making, on the house of the shared data, and on bad files.

use crate::contract::check_keys;
use crate::sinew::{Folder, sinew};
use serde_json::Value;
use sinew::formats::read_world;
use sinew::math::Vec3;
use sinew::physics::shape::Shape;
use sinew::physics::{BodyDef, BodyKind};
use std::fmt::Write;
use std::fs;

/// An OBJ of boxes, each with its lowest and highest corner.
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
fn boxes_come_back_as_they_were() {
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
