//! Meshes compressed by Draco: they are read within the quantization error, and bad streams give errors.

use crate::data::shared_data;
use draco_core::{
    DataType, EncoderBuffer, EncoderOptions, FaceIndex, GeometryAttributeType, Mesh, MeshEncoder,
    PointAttribute, PointIndex,
};
use needs_data::needs_data;
use serde_json::{Value, json};
use sinew_formats::{Document, ErrorKind, ReadOptions, Result, load_gltf, no_files, read_gltf};
use sinew_math::{Random, Vec3};

/// Number of vertices along a side of the sheet.
const SIDE: usize = 12;

/// Returns the position of vertex `i` of a bent sheet of `SIDE` × `SIDE` vertices, bound to two joints.
fn place(i: usize) -> Vec3 {
    let (x, y) = ((i % SIDE) as f32, (i / SIDE) as f32);
    Vec3::new(x * 0.1, y * 0.1, x * y * 0.01)
}

fn triangles() -> Vec<[usize; 3]> {
    let quads = (0..SIDE - 1).flat_map(|y| (0..SIDE - 1).map(move |x| y * SIDE + x));
    quads.flat_map(|i| [[i, i + 1, i + SIDE], [i + 1, i + SIDE + 1, i + SIDE]]).collect()
}

/// Returns the weight of the second joint.
fn weight(i: usize) -> f32 {
    (i / SIDE) as f32 / (SIDE - 1) as f32
}

fn attribute(kind: GeometryAttributeType, width: usize, data: DataType, bytes: &[u8]) -> PointAttribute {
    let mut attribute = PointAttribute::new();
    attribute.init(kind, u8::try_from(width).unwrap(), data, false, SIDE * SIDE);
    attribute.buffer_mut().write(0, bytes);
    attribute
}

/// Returns the sheet as a stream: positions, texture coordinates, slots and weights, by unique ids 0 to 3.
fn stream(method: i32) -> Vec<u8> {
    let mut mesh = Mesh::new();
    let all = 0..SIDE * SIDE;
    let floats = |of: &dyn Fn(usize) -> Vec<f32>| -> Vec<u8> {
        all.clone().flat_map(of).flat_map(f32::to_le_bytes).collect()
    };
    let slots: Vec<u8> = all.clone().flat_map(|_| [0, 1, 0, 0]).collect();
    let positions = floats(&|i| place(i).to_array().to_vec());
    let uvs = floats(&|i| vec![place(i).x, place(i).y]);
    let weights = floats(&|i| vec![1.0 - weight(i), weight(i), 0.0, 0.0]);
    mesh.add_attribute(attribute(GeometryAttributeType::Position, 3, DataType::Float32, &positions));
    mesh.add_attribute(attribute(GeometryAttributeType::TexCoord, 2, DataType::Float32, &uvs));
    mesh.add_attribute(attribute(GeometryAttributeType::Generic, 4, DataType::Uint8, &slots));
    mesh.add_attribute(attribute(GeometryAttributeType::Generic, 4, DataType::Float32, &weights));
    let triangles = triangles();
    mesh.set_num_faces(triangles.len());
    for (face, corners) in (0..).zip(&triangles) {
        mesh.set_face(FaceIndex(face), corners.map(|corner| PointIndex(u32::try_from(corner).unwrap())));
    }
    let mut options = EncoderOptions::new();
    options.set_encoding_method(method);
    for (id, bits) in [(0, 14), (1, 12), (3, 12)] {
        options.set_attribute_quantization(id, bits);
    }
    let mut encoder = MeshEncoder::new();
    encoder.set_mesh(mesh);
    let mut out = EncoderBuffer::new();
    encoder.encode(&options, &mut out).unwrap();
    out.data().to_vec()
}

/// Returns a file with the stream as its only mesh.
fn file(stream: &[u8]) -> Value {
    let vertices = SIDE * SIDE;
    let accessor = |component: u32, kind: &str, count: usize| json!({"componentType": component, "type": kind, "count": count});
    json!({
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_draco_mesh_compression"],
        "extensionsRequired": ["KHR_draco_mesh_compression"],
        "buffers": [{"byteLength": stream.len()}],
        "bufferViews": [{"buffer": 0, "byteLength": stream.len()}],
        "accessors": [
            accessor(5125, "SCALAR", 3 * triangles().len()), accessor(5126, "VEC3", vertices),
            accessor(5126, "VEC2", vertices), accessor(5121, "VEC4", vertices), accessor(5126, "VEC4", vertices),
        ],
        "nodes": [{"mesh": 0, "skin": 0}, {}, {}],
        "skins": [{"joints": [1, 2]}],
        "meshes": [{"primitives": [{
            "indices": 0,
            "attributes": {"POSITION": 1, "TEXCOORD_0": 2, "JOINTS_0": 3, "WEIGHTS_0": 4},
            "extensions": {"KHR_draco_mesh_compression": {
                "bufferView": 0, "attributes": {"POSITION": 0, "TEXCOORD_0": 1, "JOINTS_0": 2, "WEIGHTS_0": 3}}},
        }]}],
    })
}

fn read(json: &Value, stream: &[u8]) -> Result<Document> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().div_ceil(4) * 4, b' ');
    let mut bin = stream.to_vec();
    bin.resize(bin.len().div_ceil(4) * 4, 0);
    let length = |bytes: &[u8]| u32::try_from(bytes.len()).unwrap().to_le_bytes();
    let mut glb = [b"glTF".as_slice(), &2u32.to_le_bytes(), &[0; 4]].concat();
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &bin)] {
        glb.extend([length(chunk).as_slice(), kind.as_slice(), chunk].concat());
    }
    let total = length(&glb);
    glb[8..12].copy_from_slice(&total);
    read_gltf(&glb, ReadOptions::default(), &mut no_files)
}

#[test]
fn compressed_meshes_round_trip() {
    // Sequential and edgebreaker encoding.
    for method in [0, 1] {
        let stream = stream(method);
        let document = read(&file(&stream), &stream).unwrap();
        crate::rigs::assert_sound(&document);
        let mesh = &document.rig.meshes[0];
        let part = &mesh.primitives[0];
        assert_eq!((mesh.skin, part.positions.len()), (Some(0), SIDE * SIDE), "method {method}");
        // The encoder reorders vertices, so they are compared by position.
        let known = |at: Vec3| {
            let i = (0..SIDE * SIDE)
                .min_by(|&a, &b| (place(a) - at).length().total_cmp(&(place(b) - at).length()));
            i.filter(|&i| (place(i) - at).length() < 2e-4).unwrap_or_else(|| panic!("nothing at {at}"))
        };
        for (v, &at) in part.positions.iter().enumerate() {
            let i = known(at);
            assert!((part.uvs[v].x - place(i).x).abs() < 1e-3 && (part.uvs[v].y - place(i).y).abs() < 1e-3);
            let moved: f32 = part.joints[v]
                .iter()
                .zip(part.weights[v])
                .filter(|(slot, _)| **slot == 1)
                .map(|(_, w)| w)
                .sum();
            assert!((moved - weight(i)).abs() < 1e-3, "method {method}: weight {moved} at {at}");
        }
        let corner = |&index: &u32| known(part.positions[index as usize]);
        let turned = |t: [usize; 3]| {
            let first = (0..3).min_by_key(|&k| t[k]).unwrap();
            [t[first], t[(first + 1) % 3], t[(first + 2) % 3]]
        };
        let mut found: Vec<[usize; 3]> = part
            .indices
            .chunks_exact(3)
            .map(|t| turned([corner(&t[0]), corner(&t[1]), corner(&t[2])]))
            .collect();
        let mut wanted: Vec<[usize; 3]> = triangles().into_iter().map(turned).collect();
        found.sort_unstable();
        wanted.sort_unstable();
        assert_eq!(found, wanted, "method {method}");
    }
}

#[test]
fn errors_of_a_stream_name_its_place() {
    let good = stream(1);
    let path = "meshes[0].primitives[0].extensions.KHR_draco_mesh_compression";
    let case = |change: &dyn Fn(&mut Value), stream: &[u8]| {
        let mut json = file(stream);
        change(&mut json);
        let error = read(&json, stream).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Malformed, "{error}");
        assert!(error.where_.starts_with(path) && !error.what.contains('\n'), "{error}");
        error.what
    };
    let extension = |json: &mut Value| {
        json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"].take()
    };
    assert!(case(&|_| (), &good[..good.len() / 2]).contains("cannot be decoded"));
    assert!(case(&|_| (), b"nothing").contains("cannot be decoded"));
    let with = |change: fn(&mut Value)| {
        move |json: &mut Value| {
            let mut own = extension(json);
            change(&mut own);
            json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = own;
        }
    };
    let said = case(&with(|own| own["attributes"]["WEIGHTS_0"] = 9.into()), &good);
    assert_eq!(said, "the Draco stream has no attribute 9");
    let said = case(&with(|own| own["attributes"]["JOINTS_0"] = 0.into()), &good);
    assert_eq!(said, "elements have 3 numbers in the Draco stream, not 4");
    let said = case(&with(|own| own["bufferView"] = 4.into()), &good);
    assert_eq!(said, "index 4 is out of range: there are 1 buffer views");
    // The stream has more triangles than the file declares, or the file declares more than the stream has.
    assert!(
        case(&|json| json["accessors"][0]["count"] = 30.into(), &good)
            .contains("has more than its accessors say")
    );
    let said = case(&|json| json["accessors"][0]["count"] = 4_000_000_000u64.into(), &good);
    assert_eq!(said, "1333333333 elements are more than the size of the file justifies");
}

/// A stream whose header claims more data than it has is rejected without allocating memory for it.
#[test]
fn oversized_counts_allocate_nothing() {
    let honest = stream(1);
    let mut random = Random::new(5);
    for case in 0..cases() {
        let mut lying = honest.clone();
        // Changes the header and the counts after it: numbers of vertices, faces, symbols.
        for _ in 0..3 {
            let at = 5 + random.index(40.min(lying.len() - 5));
            lying[at] = if random.index(2) == 0 { 0xff } else { random.index(256) as u8 };
        }
        let used = peak(|| drop(read(&file(&lying), &lying)));
        assert!(used < 40 << 20, "case {case}: allocates {used} bytes");
    }
}

#[test]
fn mutated_streams_do_not_panic() {
    let mut random = Random::new(11);
    for method in [0, 1] {
        let whole = stream(method);
        for _ in 0..10 * cases() {
            let mut bytes = whole.clone();
            for _ in 0..=random.index(6) {
                let at = random.index(bytes.len());
                bytes[at] = random.index(256) as u8;
            }
            bytes.truncate(if random.index(4) == 0 { random.index(bytes.len() + 1) } else { bytes.len() });
            match read(&file(&bytes), &bytes) {
                Ok(document) => crate::rigs::assert_sound(&document),
                Err(error) => assert!(!error.what.is_empty() && !error.to_string().contains('\n'), "{error}"),
            }
        }
    }
}

/// Returns the number of random cases: all with `SINEW_FULL` set.
fn cases() -> usize {
    if std::env::var_os("SINEW_FULL").is_some() { 5000 } else { 100 }
}

/// Returns the peak memory of a call, bytes.
fn peak(call: impl FnOnce()) -> u64 {
    allocation_counter::measure(call).bytes_max
}

#[needs_data]
#[test]
fn compressed_public_rigs_are_read() {
    let data = shared_data();
    for (file, vertices, triangles) in [
        ("Astronaut_RaeTheRedPanda", 5382, 17052 / 3),
        ("Enemy_Flying", 2848, 11460 / 3),
        ("Enemy_Large", 3485, 14172 / 3),
        ("Mech_FinnTheFrog", 6269, 17538 / 3),
    ] {
        let path = data.join(format!("rigs_wild/ultimate_space_{file}-transformed.glb"));
        let document = load_gltf(&path, ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
        crate::rigs::assert_sound(&document);
        let mesh = document.rig.meshes.iter().find(|mesh| mesh.skin.is_some()).unwrap();
        let part = &mesh.primitives[0];
        assert_eq!((part.positions.len(), part.indices.len() / 3), (vertices, triangles), "{file}");
        // The file has the bounds of the unquantized positions.
        let accessor =
            document.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].as_u64().unwrap();
        let accessor = &document.json["accessors"][usize::try_from(accessor).unwrap()];
        for axis in 0..3 {
            let (low, high) =
                (accessor["min"][axis].as_f64().unwrap(), accessor["max"][axis].as_f64().unwrap());
            let of = |p: &Vec3| f64::from(p.to_array()[axis]);
            let lowest = part.positions.iter().map(of).fold(f64::INFINITY, f64::min);
            let highest = part.positions.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
            let off = (lowest - low).abs().max((highest - high).abs());
            assert!(off < 2e-3 * (high - low), "{file}: range {lowest}..{highest}, expected {low}..{high}");
        }
    }
}

/// Seeds of the fuzzer: a stream of each method, after the counts declared by its file.
#[test]
fn fuzzer_seeds_are_readable_streams() {
    for (method, name) in [(0, "sequential"), (1, "edgebreaker")] {
        let path = format!("{}/../../fuzz/seeds/draco/{name}.bin", env!("CARGO_MANIFEST_DIR"));
        if std::env::var_os("SINEW_BLESS").is_some() {
            let counts = [SIDE * SIDE, triangles().len()].map(|count| u8::try_from(count).unwrap());
            std::fs::write(&path, [counts.as_slice(), &stream(method)].concat()).unwrap();
        }
        let seed = std::fs::read(&path).unwrap();
        let [vertices, faces, stream @ ..] = seed.as_slice() else { panic!("{name}: too short") };
        assert_eq!([*vertices, *faces].map(usize::from), [SIDE * SIDE, triangles().len()]);
        assert!(read(&file(stream), stream).is_ok(), "{name}");
    }
}
