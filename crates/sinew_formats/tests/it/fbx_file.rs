//! A small FBX file as text, also used by the tests of the command line.

use std::fmt::Write as _;

/// Ticks per second.
const SECOND: u64 = 46_186_158_000;

/// Corners of the box bound to the leg, centimetres, z up: 10 × 10 × 80.
pub fn corners() -> [[i32; 3]; 8] {
    core::array::from_fn(|i| {
        let at = |bit: usize, low, high| if i >> bit & 1 == 0 { low } else { high };
        [at(0, 5, 15), at(1, -5, 5), at(2, 20, 100)]
    })
}

fn array(name: &str, numbers: &[f64]) -> String {
    let text: Vec<String> = numbers.iter().map(ToString::to_string).collect();
    format!("{name}: *{} {{\n a: {}\n}}\n", numbers.len(), text.join(","))
}

fn limb(id: u32, name: &str, at: [i32; 3]) -> String {
    let [x, y, z] = at;
    format!(
        "Model: {id}, \"Model::{name}\", \"LimbNode\" {{\n Version: 232\n Properties70: {{\n \
         P: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",{x},{y},{z}\n }}\n}}\n"
    )
}

/// Returns a cluster of the corners in `range`, on a limb at `at` without rotation.
fn cluster(id: u32, range: core::ops::Range<usize>, at: [f64; 3]) -> String {
    let matrix =
        |[x, y, z]: [f64; 3]| [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, y, z, 1.0];
    let indices: Vec<f64> = range.map(|i| i as f64).collect();
    format!(
        "Deformer: {id}, \"SubDeformer::\", \"Cluster\" {{\n Version: 100\n{}{}{}{}}}\n",
        array("Indexes", &indices),
        array("Weights", &vec![1.0; indices.len()]),
        array("Transform", &matrix(at.map(|x| -x))),
        array("TransformLink", &matrix(at)),
    )
}

/// Returns hips at a height of 1 m, a thigh 10 cm to the side and a shank 40 cm below, z up in centimetres. The thigh
/// rotates by 90° about x within a second; a box is bound to thigh (upper four corners) and shank (lower four).
pub fn leg() -> String {
    let mut text = String::from(
        "; FBX 7.4.0 project file\nFBXHeaderExtension: {\n FBXHeaderVersion: 1003\n FBXVersion: 7400\n Creator: \"tests\"\n}\n\
         GlobalSettings: {\n Version: 1000\n Properties70: {\n",
    );
    for (name, value) in [
        ("UpAxis", 2),
        ("UpAxisSign", 1),
        ("FrontAxis", 1),
        ("FrontAxisSign", -1),
        ("CoordAxis", 0),
        ("CoordAxisSign", 1),
        ("UnitScaleFactor", 1),
        ("TimeMode", 6),
    ] {
        let _ = writeln!(text, " P: \"{name}\", \"int\", \"Integer\", \"\",{value}");
    }
    text.push_str(" }\n}\nObjects: {\n");
    text += &limb(100, "hips", [0, 0, 100]);
    text += &limb(101, "thigh", [10, 0, 0]);
    text += &limb(102, "shank", [0, 0, -40]);
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let polygons: Vec<f64> =
        faces.iter().flat_map(|&[a, b, c, d]| [a, b, c, -d - 1]).map(f64::from).collect();
    let positions: Vec<f64> = corners().as_flattened().iter().map(|&x| f64::from(x)).collect();
    let _ = write!(
        text,
        "Geometry: 200, \"Geometry::box\", \"Mesh\" {{\n{}{}}}\n",
        array("Vertices", &positions),
        array("PolygonVertexIndex", &polygons)
    );
    text += "Model: 201, \"Model::box\", \"Mesh\" {\n Version: 232\n}\n";
    text += "Deformer: 300, \"Deformer::\", \"Skin\" {\n Version: 101\n}\n";
    text += &cluster(301, 4..8, [10.0, 0.0, 100.0]);
    text += &cluster(302, 0..4, [10.0, 0.0, 60.0]);
    let _ = write!(
        text,
        "AnimationStack: 400, \"AnimStack::bend\", \"\" {{\n Properties70: {{\n \
         P: \"LocalStop\", \"KTime\", \"Time\", \"\",{SECOND}\n }}\n}}\n\
         AnimationLayer: 401, \"AnimLayer::base\", \"\" {{\n}}\n\
         AnimationCurveNode: 402, \"AnimCurveNode::R\", \"\" {{\n Properties70: {{\n \
         P: \"d|X\", \"Number\", \"\", \"A\",0\n }}\n}}\n\
         AnimationCurve: 403, \"AnimCurve::\", \"\" {{\n Default: 0\n KeyVer: 4008\n{}{}{}{}{}}}\n}}\n",
        array("KeyTime", &[0.0, SECOND as f64]),
        array("KeyValueFloat", &[0.0, 90.0]),
        array("KeyAttrFlags", &[4.0]),
        array("KeyAttrDataFloat", &[0.0; 4]),
        array("KeyAttrRefCount", &[2.0]),
    );
    text.push_str("Connections: {\n");
    for (from, to) in [
        (100, 0),
        (101, 100),
        (102, 101),
        (201, 0),
        (200, 201),
        (300, 200),
        (301, 300),
        (302, 300),
        (101, 301),
        (102, 302),
        (401, 400),
        (402, 401),
    ] {
        let _ = writeln!(text, " C: \"OO\",{from},{to}");
    }
    text += " C: \"OP\",402,101, \"Lcl Rotation\"\n C: \"OP\",403,402, \"d|X\"\n}\n";
    text
}

/// Returns the [`leg`] with a material on its box and a picture, either with the picture's bytes in the file, or only
/// with its name.
pub fn pictured_leg(picture: Option<&[u8]>, name: &str) -> String {
    let content = picture.map_or(String::new(), |bytes| format!(" Content: ,\n \"{}\"\n", base64(bytes)));
    let objects = format!(
        "Material: 500, \"Material::skin\", \"\" {{\n Version: 102\n ShadingModel: \"phong\"\n Properties70: {{\n \
         P: \"DiffuseColor\", \"Color\", \"\", \"A\",0.5,0.25,1\n }}\n}}\n\
         Texture: 501, \"Texture::skin\", \"\" {{\n Type: \"TextureVideoClip\"\n Version: 202\n \
         FileName: \"C:\\art\\{name}\"\n RelativeFilename: \"..\\art\\{name}\"\n}}\n\
         Video: 502, \"Video::skin\", \"Clip\" {{\n Type: \"Clip\"\n FileName: \"C:\\art\\{name}\"\n \
         RelativeFilename: \"..\\art\\{name}\"\n{content}}}\n"
    );
    let links = "C: \"OO\",500,201\n C: \"OP\",501,500, \"DiffuseColor\"\n C: \"OO\",502,501\n ";
    leg()
        .replace("AnimationStack:", &(objects + "AnimationStack:"))
        .replace("Connections: {\n ", &("Connections: {\n ".to_owned() + links))
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for three in bytes.chunks(3) {
        let bits =
            three.iter().enumerate().fold(0u32, |bits, (i, &byte)| bits | u32::from(byte) << (16 - 8 * i));
        for digit in 0..4 {
            let at = (bits >> (18 - 6 * digit) & 63) as usize;
            text.push(if digit <= three.len() { char::from(DIGITS[at]) } else { '=' });
        }
    }
    text
}
