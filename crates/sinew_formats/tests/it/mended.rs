//! Numbers that are not finite: they are replaced with a note where they do not matter, and rejected
//! elsewhere.

use crate::data::shared_data;
use needs_data::needs_data;
use serde_json::{Value, json};
use sinew_formats::{Document, ReadOptions, Result, load_gltf, no_files, read_gltf};
use std::fmt::Write as _;

const NAN: f32 = f32::NAN;

/// Number of vertices of two separate triangles, with one unused.
const VERTICES: usize = 7;

/// Returns a file with attributes by name; weights use slots 0 and 1 of a skin with two joints.
fn file(attributes: &[(&str, usize, Vec<f32>)]) -> Result<Document> {
    let mut bin: Vec<u8> = Vec::new();
    let (mut views, mut accessors, mut named) = (Vec::new(), Vec::new(), serde_json::Map::new());
    let mut put = |name: &str, component: u32, width: usize, bytes: &[u8]| {
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][width - 1];
        let count = if name.is_empty() { 6 } else { VERTICES };
        views.push(json!({"buffer": 0, "byteOffset": bin.len(), "byteLength": bytes.len()}));
        accessors.push(
            json!({"bufferView": views.len() - 1, "componentType": component, "type": kind, "count": count}),
        );
        bin.extend(bytes);
        if !name.is_empty() {
            named.insert(name.into(), (accessors.len() - 1).into());
        }
    };
    let indices: Vec<u8> = (0..6u32).flat_map(u32::to_le_bytes).collect();
    put("", 5125, 1, &indices);
    for (name, width, numbers) in attributes {
        let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        put(name, 5126, *width, &bytes);
    }
    put("JOINTS_0", 5121, 4, &[0, 1, 0, 0].repeat(VERTICES));
    let mut uri = String::from("data:;base64,");
    const DIGITS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for three in bin.chunks(3) {
        let bits = three.iter().chain([0, 0].iter()).take(3).fold(0u32, |bits, &b| bits << 8 | u32::from(b));
        for k in 0..4 {
            let digit = char::from(DIGITS[(bits >> (18 - 6 * k)) as usize & 63]);
            write!(uri, "{}", if k <= three.len() { digit } else { '=' }).unwrap();
        }
    }
    let root: Value = json!({
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": bin.len(), "uri": uri}],
        "bufferViews": views,
        "accessors": accessors,
        "nodes": [{"mesh": 0, "skin": 0}, {}, {}],
        "skins": [{"joints": [1, 2]}],
        "meshes": [{"primitives": [{"indices": 0, "attributes": named}]}],
    });
    read_gltf(root.to_string().as_bytes(), ReadOptions::default(), &mut no_files)
}

fn positions() -> Vec<f32> {
    (0..VERTICES).flat_map(|i| [i as f32, (i * i) as f32, (i % 3) as f32]).collect()
}

/// Returns weight 1 for slot 0 in the first triangle, for slot 1 after it.
fn weights() -> Vec<f32> {
    (0..VERTICES).flat_map(|i| if i < 3 { [1.0, 0.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0, 0.0] }).collect()
}

fn spoilt(mut numbers: Vec<f32>, at: usize, with: f32) -> Vec<f32> {
    numbers[at] = with;
    numbers
}

#[test]
fn cosmetic_values_are_replaced_with_a_note() {
    let up: Vec<f32> = [0.0, 1.0, 0.0].repeat(VERTICES);
    for with in [NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let document = file(&[
            ("POSITION", 3, positions()),
            ("NORMAL", 3, spoilt(up.clone(), 5, with)),
            ("TANGENT", 4, spoilt(weights(), 2, with)),
            ("TEXCOORD_0", 2, spoilt(vec![0.5; 2 * VERTICES], 4, with)),
            ("COLOR_0", 4, spoilt(vec![0.25; 4 * VERTICES], 9, with)),
            ("WEIGHTS_0", 4, weights()),
        ])
        .unwrap();
        let part = &document.rig.meshes[0].primitives[0];
        assert!(part.normals.iter().all(|n| n.is_finite() && (n.length() - 1.0).abs() < 1e-6));
        assert_eq!((part.uvs[2].x, part.uvs[2].y, part.uvs[1].x), (0.0, 0.5, 0.5));
        assert_eq!((part.colors[2], part.colors[1]), ([1.0; 4], [0.25; 4]));
        let expected = [
            "1 of 7 elements are not finite: taken as 0 (meshes[0].primitives[0].attributes.NORMAL)",
            "1 of 7 elements are not finite: taken as 0 (meshes[0].primitives[0].attributes.TEXCOORD_0)",
            "1 of 7 elements are not finite: taken as white (meshes[0].primitives[0].attributes.COLOR_0)",
        ];
        assert_eq!(document.warnings, expected);
    }
}

#[test]
fn nonfinite_weights_are_replaced_by_those_of_the_nearest_skin() {
    let mut lost = weights();
    lost[20..24].fill(NAN);
    // One of several weights is not finite; the others remain.
    lost[1] = NAN;
    let document = file(&[("POSITION", 3, positions()), ("WEIGHTS_0", 4, lost)]).unwrap();
    let part = &document.rig.meshes[0].primitives[0];
    assert_eq!((part.joints[5], part.weights[5]), ([1, 0, 0, 0], [1.0, 0.0, 0.0, 0.0]), "as vertex 4 and 6");
    assert_eq!(part.weights[0], [1.0, 0.0, 0.0, 0.0]);
    let expected = [
        "2 of 7 elements are not finite: taken as 0 (meshes[0].primitives[0].attributes.WEIGHTS_0)",
        "1 vertex has no bone: it follows the nearest skin",
    ];
    assert_eq!(document.warnings, expected);
}

#[test]
fn nonfinite_positions_are_rejected_only_in_triangles() {
    let spare = file(&[("POSITION", 3, spoilt(positions(), 18, NAN)), ("WEIGHTS_0", 4, weights())]).unwrap();
    let part = &spare.rig.meshes[0].primitives[0];
    assert_eq!(part.positions[6], part.positions[0], "inside the body");
    assert_eq!(spare.warnings.len(), 1, "{:?}", spare.warnings);
    let used =
        file(&[("POSITION", 3, spoilt(positions(), 4, NAN)), ("WEIGHTS_0", 4, weights())]).unwrap_err();
    assert_eq!(used.to_string(), "element 1 holds a number that is not finite (accessors[1])");
}

#[needs_data]
#[test]
fn public_rigs_with_lost_weights_are_read() {
    let data = shared_data();
    for (file, notes) in [
        ("easy_enemies_Wasp", 2),
        ("modular_women_Adventurer", 3),
        ("platformer_game_Bee", 2),
        ("platformer_game_Crab", 1),
    ] {
        let path = data.join(format!("rigs_wild/{file}.glb"));
        let document = load_gltf(&path, ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
        crate::rigs::assert_sound(&document);
        let about = document.warnings.iter().filter(|note| note.contains("taken as 0 (")).count();
        assert_eq!(about, notes, "{file}: {:?}", document.warnings);
    }
}
