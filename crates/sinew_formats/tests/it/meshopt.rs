//! Tests of compressed and quantized glTF. The encoder of these tests is small and does not optimize.

use crate::meshopt_encoder::{attributes, sequence, triangles};
use serde_json::{Value, json};
use sinew_anim::{Clip, Primitive, Rig};
use sinew_formats::{Document, ErrorKind, ReadOptions, no_files, read_gltf};
use sinew_math::{Random, Rotation, Vec3};

/// A glTF that is being written; its views are compressed, or stored raw.
#[derive(Default)]
struct File {
    bin: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

/// Encoding of a view.
#[derive(Clone, Copy, PartialEq)]
enum Storage {
    Plain,
    Ext,
    Khr,
}

impl File {
    fn put(&mut self, bytes: &[u8]) -> (usize, usize) {
        self.bin.resize(self.bin.len().div_ceil(4) * 4, 0);
        self.bin.extend(bytes);
        (self.bin.len() - bytes.len(), bytes.len())
    }

    /// Adds a view over elements of `stride` bytes; `stream` is its encoded form.
    fn view(&mut self, storage: Storage, plain: &[u8], stride: usize, stream: &Stream) -> usize {
        let count = plain.len() / stride;
        let view = if storage == Storage::Plain {
            let (offset, length) = self.put(plain);
            json!({"buffer": 0, "byteOffset": offset, "byteLength": length})
        } else {
            let (offset, length) = self.put(&stream.bytes);
            let extension = json!({"buffer": 0, "byteOffset": offset, "byteLength": length, "byteStride": stride,
                "count": count, "mode": stream.mode, "filter": stream.filter});
            let name =
                if storage == Storage::Ext { "EXT_meshopt_compression" } else { "KHR_meshopt_compression" };
            json!({"buffer": 1, "byteOffset": 0, "byteLength": plain.len(), "extensions": {name: extension}})
        };
        self.views.push(view);
        if stream.mode == "ATTRIBUTES" {
            self.views.last_mut().unwrap()["byteStride"] = stride.into();
        }
        self.views.len() - 1
    }

    fn accessor(&mut self, view: usize, component: u32, kind: &str, count: usize, normalized: bool) -> usize {
        self.accessors
            .push(json!({"bufferView": view, "componentType": component, "type": kind, "count": count,
            "normalized": normalized}));
        self.accessors.len() - 1
    }
}

struct Stream {
    mode: &'static str,
    filter: &'static str,
    bytes: Vec<u8>,
}

const COLUMNS: usize = 20;
const ROWS: usize = 15;
const KEYS: usize = 40;

/// Returns the position of a vertex of a wavy sheet, quantized to 16 bits.
fn place(i: usize) -> [u16; 4] {
    let (x, y) = (i % COLUMNS, i / COLUMNS);
    [(x * 3000) as u16, (y * 4000) as u16, ((x * y * 37) % 500) as u16, 0]
}

fn sheet() -> Vec<u32> {
    let mut indices = Vec::new();
    for y in 0..ROWS - 1 {
        for x in 0..COLUMNS - 1 {
            let at = |dx: usize, dy: usize| ((y + dy) * COLUMNS + x + dx) as u32;
            indices.extend([at(0, 0), at(1, 0), at(0, 1), at(0, 1), at(1, 0), at(1, 1)]);
        }
    }
    indices
}

/// Returns the rotation of the second joint at a key.
fn turn(key: usize) -> Rotation {
    Rotation::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), key as f32 * 0.07 - 1.0)
}

/// Converts a quaternion to four normalised numbers of 16 bits.
fn shorts(r: Rotation) -> [i16; 4] {
    [r.x, r.y, r.z, r.w].map(|x| (x * 32767.0).round() as i16)
}

/// Returns a skinned, quantized sheet with an animation, with every view in the given encoding.
fn file(storage: Storage, version: u8) -> (Value, Vec<u8>, Vec<u32>) {
    let mut file = File::default();
    let vertices = COLUMNS * ROWS;
    let plain = |mode: &'static str, bytes: Vec<u8>| Stream { mode, filter: "NONE", bytes };
    let places: Vec<u8> = (0..vertices).flat_map(place).flat_map(u16::to_le_bytes).collect();
    let stream = plain("ATTRIBUTES", attributes(&places, 8, version));
    let view = file.view(storage, &places, 8, &stream);
    let position = file.accessor(view, 5123, "VEC3", vertices, true);
    let slots: Vec<u8> = (0..vertices).flat_map(|i| [0, 1, 0, (i % 2) as u8]).collect();
    let view = file.view(storage, &slots, 4, &plain("ATTRIBUTES", attributes(&slots, 4, version)));
    let joints = file.accessor(view, 5121, "VEC4", vertices, false);
    let weights: Vec<u8> =
        (0..vertices).flat_map(|i| [255 - (i % 200) as u8, (i % 200) as u8, 0, 0]).collect();
    let view = file.view(storage, &weights, 4, &plain("ATTRIBUTES", attributes(&weights, 4, version)));
    let weights = file.accessor(view, 5121, "VEC4", vertices, true);
    let (stream, indices) = triangles(&sheet());
    let bytes: Vec<u8> = indices.iter().flat_map(|&i| (i as u16).to_le_bytes()).collect();
    let view = file.view(storage, &bytes, 2, &plain("TRIANGLES", stream));
    let corners = file.accessor(view, 5123, "SCALAR", indices.len(), false);
    let times: Vec<u8> = (0..KEYS).flat_map(|key| (key as f32 * 0.05).to_le_bytes()).collect();
    let view = file.view(storage, &times, 4, &plain("ATTRIBUTES", attributes(&times, 4, version)));
    let times = file.accessor(view, 5126, "SCALAR", KEYS, false);
    let turns: Vec<u8> = (0..KEYS).flat_map(|key| shorts(turn(key))).flat_map(i16::to_le_bytes).collect();
    let view = file.view(storage, &turns, 8, &plain("ATTRIBUTES", attributes(&turns, 8, version)));
    let turns = file.accessor(view, 5122, "VEC4", KEYS, true);
    let length = file.bin.len();
    let name = if storage == Storage::Khr { "KHR_meshopt_compression" } else { "EXT_meshopt_compression" };
    let root = json!({
        "asset": {"version": "2.0"}, "extensionsUsed": [name], "extensionsRequired": [name, "KHR_mesh_quantization"],
        "nodes": [{"mesh": 0, "skin": 0}, {"name": "a", "children": [2]}, {"name": "b", "translation": [0, 1, 0]}],
        "skins": [{"joints": [1, 2]}],
        "meshes": [{"primitives": [{"indices": corners, "attributes":
            {"POSITION": position, "JOINTS_0": joints, "WEIGHTS_0": weights}}]}],
        "animations": [{"samplers": [{"input": times, "output": turns}],
            "channels": [{"sampler": 0, "target": {"node": 2, "path": "rotation"}}]}],
        "accessors": file.accessors, "bufferViews": file.views,
        "buffers": [{"byteLength": length}, {"byteLength": 1_000_000, "extensions": {name: {"fallback": true}}}],
    });
    (root, file.bin, indices)
}

fn glb(root: &Value, bin: &[u8]) -> Vec<u8> {
    let mut json = root.to_string().into_bytes();
    json.resize(json.len().div_ceil(4) * 4, b' ');
    let mut bin = bin.to_vec();
    bin.resize(bin.len().div_ceil(4) * 4, 0);
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend((28 + json.len() as u32 + bin.len() as u32).to_le_bytes());
    for (kind, data) in [(b"JSON", json), (b"BIN\0", bin)] {
        out.extend((data.len() as u32).to_le_bytes());
        out.extend(kind);
        out.extend(data);
    }
    out
}

fn read(bytes: &[u8]) -> sinew_formats::Result<Document> {
    read_gltf(bytes, ReadOptions::default(), &mut no_files)
}

fn part(rig: &Rig) -> &Primitive {
    &rig.meshes[0].primitives[0]
}

#[test]
fn quantized_numbers_decode_exactly() {
    let (root, bin, indices) = file(Storage::Plain, 0);
    let document = read(&glb(&root, &bin)).unwrap();
    let part = part(&document.rig);
    for (i, p) in part.positions.iter().enumerate() {
        let [x, y, z, _] = place(i).map(|n| f32::from(n) / 65535.0);
        assert!((*p - Vec3::new(x, y, z)).length() < 1e-6);
        let second = (i % 200) as f32 / 255.0;
        assert!(
            (part.weights[i][1] - second).abs() < 1e-6 && (part.weights[i][0] + second - 1.0).abs() < 1e-6
        );
    }
    assert_eq!(part.indices, indices);
    let clip: &Clip = &document.clips[0];
    for (key, value) in clip.channels[0].values.chunks_exact(4).enumerate() {
        let r = Rotation::from_xyzw(value[0], value[1], value[2], value[3]);
        assert!(
            r.angle_to(turn(key)) < 2e-4 && (clip.channels[0].times[key] - key as f32 * 0.05).abs() < 1e-6
        );
    }
}

#[test]
fn compressed_files_equal_the_uncompressed_ones() {
    let (root, bin, _) = file(Storage::Plain, 0);
    let plain = read(&glb(&root, &bin)).unwrap();
    for (storage, version) in [(Storage::Ext, 0), (Storage::Khr, 0), (Storage::Khr, 1)] {
        let (root, small, _) = file(storage, version);
        assert!(small.len() < bin.len(), "{} of {}", small.len(), bin.len());
        let document = read(&glb(&root, &small)).unwrap();
        assert_eq!((&document.rig, &document.clips), (&plain.rig, &plain.clips));
    }
}

/// Passes one view through a filter and reads it back as floats through the translations of a node.
fn filtered(filter: &'static str, bytes: &[u8], stride: usize, component: u32, kind: &str) -> Vec<f32> {
    let mut file = File::default();
    let count = bytes.len() / stride;
    let times: Vec<u8> = (0..count).flat_map(|key| (key as f32).to_le_bytes()).collect();
    let stream = |filter, bytes| Stream { mode: "ATTRIBUTES", filter, bytes };
    let view = file.view(Storage::Plain, &times, 4, &stream("NONE", Vec::new()));
    let times = file.accessor(view, 5126, "SCALAR", count, false);
    let view = file.view(Storage::Ext, bytes, stride, &stream(filter, attributes(bytes, stride, 0)));
    let values = file.accessor(view, component, kind, count, component != 5126);
    let path = if kind == "VEC4" { "rotation" } else { "translation" };
    let root = json!({
        "asset": {"version": "2.0"}, "nodes": [{}],
        "animations": [{"samplers": [{"input": times, "output": values}],
            "channels": [{"sampler": 0, "target": {"node": 0, "path": path}}]}],
        "accessors": file.accessors, "bufferViews": file.views,
        "buffers": [{"byteLength": file.bin.len()}, {"byteLength": 1_000_000}],
    });
    read(&glb(&root, &file.bin)).unwrap().clips[0].channels[0].values.clone()
}

#[test]
fn filters_round_trip() {
    let mut random = Random::new(7);
    // Quaternions: the three smaller numbers with 15 bits each; the largest is omitted.
    let turns: Vec<Rotation> = (0..200).map(|_| random.rotation()).collect();
    let encode = |r: &Rotation| {
        let q = [r.x, r.y, r.z, r.w];
        let at = (0..4).max_by(|&a, &b| q[a].abs().total_cmp(&q[b].abs())).unwrap();
        let sign = if q[at] < 0.0 { -1.0 } else { 1.0 };
        let three =
            [1, 2, 3].map(|k| (q[(at + k) & 3] * sign * core::f32::consts::SQRT_2 * 32767.0).round() as i16);
        [three[0], three[1], three[2], (32767 & !3) | at as i16]
    };
    let bytes: Vec<u8> = turns.iter().flat_map(encode).flat_map(i16::to_le_bytes).collect();
    for (value, r) in filtered("QUATERNION", &bytes, 8, 5122, "VEC4").chunks_exact(4).zip(&turns) {
        assert!(Rotation::from_xyzw(value[0], value[1], value[2], value[3]).normalize().angle_to(*r) < 2e-3);
    }
    // Floats: a mantissa of 24 bits, an exponent of 8.
    let numbers: Vec<[i32; 3]> = (0..200)
        .map(|_| {
            [0; 3].map(|_| {
                (random.index(20_000) as i32 - 10_000) & 0xFF_FFFF | (random.index(40) as i32 - 20) << 24
            })
        })
        .collect();
    let wanted = numbers
        .as_flattened()
        .iter()
        .map(|&v| (v << 8 >> 8) as f32 * f32::from_bits((((v >> 24) + 127) as u32) << 23));
    let bytes: Vec<u8> = numbers.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect();
    assert_eq!(filtered("EXPONENTIAL", &bytes, 12, 5126, "VEC3"), wanted.collect::<Vec<f32>>());
    // Unit vectors, as the unfolded octahedron in a square.
    for bits in [8_u32, 16] {
        let most = f32::from((1_i16 << (bits - 2)) - 1) * 2.0 + 1.0;
        let directions: Vec<Vec3> = (0..200).map(|_| random.direction()).collect();
        let encode = |n: &Vec3| {
            let sum = n.x.abs() + n.y.abs() + n.z.abs();
            let [mut u, mut v] = [n.x / sum, n.y / sum];
            if n.z < 0.0 {
                [u, v] = [(1.0 - v.abs()).copysign(u), (1.0 - u.abs()).copysign(v)];
            }
            [(u * most).round() as i16, (v * most).round() as i16, most as i16, 0]
        };
        let shorts = directions.iter().flat_map(encode);
        let bytes: Vec<u8> = match bits {
            8 => shorts.map(|n| n as u8).collect(),
            _ => shorts.flat_map(i16::to_le_bytes).collect(),
        };
        let component = if bits == 8 { 5120 } else { 5122 };
        let read = filtered("OCTAHEDRAL", &bytes, bits as usize / 2, component, "VEC3");
        for (value, n) in read.chunks_exact(3).zip(&directions) {
            assert!((Vec3::from_slice(value) - *n).length() < 3.0 / most, "{value:?} {n}");
        }
    }
}

#[test]
fn index_sequences_and_triangles_round_trip() {
    let mut random = Random::new(3);
    for size in [0, 3, 30, 300] {
        let indices: Vec<u32> = (0..size).map(|_| random.index(60) as u32).collect();
        let (stream, wanted) = triangles(&indices);
        assert_eq!(decoded("TRIANGLES", &stream, size), wanted);
        assert_eq!(decoded("INDICES", &sequence(&indices), size), indices);
    }
}

/// Returns the indices of a primitive that are stored in the given mode.
fn decoded(mode: &'static str, stream: &[u8], count: usize) -> Vec<u32> {
    let mut file = File::default();
    let (offset, length) = file.put(stream);
    let root = json!({
        "asset": {"version": "2.0"}, "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"indices": 0, "attributes": {"POSITION": 1}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5125, "type": "SCALAR", "count": count},
            {"componentType": 5126, "type": "VEC3", "count": 1000}],
        "bufferViews": [{"buffer": 1, "byteLength": 4 * count, "extensions": {"EXT_meshopt_compression":
            {"buffer": 0, "byteOffset": offset, "byteLength": length, "byteStride": 4, "count": count, "mode": mode}}}],
        "buffers": [{"byteLength": file.bin.len()}, {"byteLength": 4 * count}],
    });
    read(&glb(&root, &file.bin))
        .map_or_else(|error| panic!("{mode} of {count} elements: {error}"), |d| part(&d.rig).indices.clone())
}

#[test]
fn invalid_streams_are_rejected() {
    let (root, bin, _) = file(Storage::Ext, 0);
    let whole = glb(&root, &bin);
    let mut random = Random::new(11);
    let start = whole.len() - bin.len();
    let mut refused = 0;
    for _ in 0..300 {
        let mut bytes = whole.clone();
        let at = start + random.index(bin.len());
        bytes[at] = random.index(256) as u8;
        refused += usize::from(read(&bytes).is_err());
    }
    assert!(refused > 20, "{refused}");
    for view in 0..root["bufferViews"].as_array().unwrap().len() {
        let claimed = root["bufferViews"][view]["extensions"]["EXT_meshopt_compression"]["byteLength"]
            .as_u64()
            .unwrap();
        for length in 0..claimed {
            let mut root = root.clone();
            root["bufferViews"][view]["extensions"]["EXT_meshopt_compression"]["byteLength"] = length.into();
            let error = read(&glb(&root, &bin)).unwrap_err();
            let place = format!("bufferViews[{view}].extensions.EXT_meshopt_compression");
            assert!(error.kind == ErrorKind::Malformed && error.where_ == place, "{length}: {error}");
        }
    }
    // A count that the bytes do not justify is rejected before any allocation.
    let mut greedy = root;
    greedy["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["count"] = json!(1_u64 << 40);
    assert!(read(&glb(&greedy, &bin)).unwrap_err().what.contains("justifies"));
}
