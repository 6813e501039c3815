//! Reads Wavefront OBJ: vertices and faces; ignores materials, normals and texture coordinates.
//!
//! ```
//! let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
//! let mesh = sinew_formats::read_obj(text.as_bytes())?;
//! assert_eq!(mesh.triangles.len(), 2); // a face of four corners
//! let error = sinew_formats::read_obj(b"v 0 0\nf 1 2 3").expect_err("a number is missing");
//! assert!(error.to_string().contains("line 1"), "{error}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{Error, Result, quoted};
use crate::mesh::TriangleMesh;
use sinew_math::Vec3;
use std::borrow::Cow;

/// Largest number of corners of a face; triangulating a larger one would take too long.
const MOST_CORNERS: usize = 1024;
/// Number of corner tests per corner while triangulating a face: enough for any real outline, and few enough that the
/// reader also ends on a malicious file.
const WORK: usize = 256;
/// Colour of surfaces, because materials are not read.
const GREY: [f32; 3] = [0.6; 3];

/// Reads the triangles of an OBJ file. Faces with more than three corners are triangulated, also concave ones. For a
/// face so jagged or twisted that this would take too long, the rest becomes a fan from one corner.
///
/// # Errors
/// Returns an error that names the line: an invalid or non-finite number, an index out of range, a face with fewer than
/// three corners.
pub fn read_obj(bytes: &[u8]) -> Result<TriangleMesh> {
    let text = core::str::from_utf8(bytes).map_err(|error| {
        Error::malformed("not an OBJ file: not text in UTF-8", format!("byte {}", error.valid_up_to()))
    })?;
    let mut mesh = TriangleMesh::default();
    let mut elements = 0;
    for (number, line) in logical_lines(text) {
        let mut words = line.split_ascii_whitespace();
        let place = || format!("line {number}");
        match words.next() {
            Some("v") => {
                mesh.positions.push(read_vertex(words).map_err(|what| Error::malformed(what, place()))?);
            }
            Some("f") => {
                let face =
                    read_face(words, mesh.positions.len()).map_err(|what| Error::malformed(what, place()))?;
                cut(&mesh.positions, face, &mut mesh.triangles);
            }
            Some(word) if !KNOWN.contains(&word) && !word.starts_with('#') => {
                return Err(Error::malformed(
                    format!("not an OBJ file: unknown word {}", quoted(word)),
                    place(),
                ));
            }
            _ => continue,
        }
        elements += 1;
    }
    if elements == 0 {
        return Err(Error::malformed(
            "not an OBJ file, or an empty one: it has neither vertices nor faces",
            "line 1",
        ));
    }
    mesh.colors = vec![GREY; mesh.positions.len()];
    Ok(mesh)
}

/// First words of ignored lines.
const KNOWN: [&str; 34] = [
    "vt",
    "vn",
    "vp",
    "g",
    "o",
    "s",
    "mg",
    "l",
    "p",
    "usemtl",
    "mtllib",
    "usemap",
    "maplib",
    "curv",
    "curv2",
    "surf",
    "deg",
    "bmat",
    "step",
    "cstype",
    "parm",
    "trim",
    "hole",
    "scrv",
    "sp",
    "end",
    "con",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "shadow_obj",
    "trace_obj",
    "call",
];

/// Iterates over lines with their numbers; a line that ends in `\` is joined with the next.
fn logical_lines(text: &str) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let mut lines = text.lines().enumerate();
    core::iter::from_fn(move || {
        let (index, line) = lines.next()?;
        let Some(start) = continued(line) else { return Some((index + 1, Cow::Borrowed(line))) };
        let mut whole = start.to_owned();
        for (_, line) in lines.by_ref() {
            let start = continued(line);
            whole.push(' ');
            whole.push_str(start.unwrap_or(line));
            if start.is_none() {
                break;
            }
        }
        Some((index + 1, Cow::Owned(whole)))
    })
}

/// Returns a line without the `\` that continues it on the next; `None` if it is not continued. A `\` at the end of a
/// comment continues nothing.
fn continued(line: &str) -> Option<&str> {
    if line.trim_start().starts_with('#') { None } else { line.trim_end().strip_suffix('\\') }
}

fn read_vertex<'a>(mut words: impl Iterator<Item = &'a str>) -> Result<Vec3, String> {
    let mut p = [0.0_f32; 3];
    for (coordinate, axis) in p.iter_mut().zip(["x", "y", "z"]) {
        let word = words.next().ok_or_else(|| format!("a vertex without {axis}"))?;
        *coordinate = word.parse().map_err(|_| format!("{} is not a number", quoted(word)))?;
        if !coordinate.is_finite() {
            return Err(format!("{} is not finite", quoted(word)));
        }
    }
    Ok(Vec3::from_array(p))
}

/// Returns the vertex indices of a face, from 0. In the file they count from 1, or from −1 backward from the last
/// vertex so far.
fn read_face<'a>(words: impl Iterator<Item = &'a str>, vertices: usize) -> Result<Vec<u32>, String> {
    let mut face = Vec::new();
    for word in words.take_while(|word| !word.starts_with('#')) {
        let index = word.split('/').next().unwrap_or_default();
        let number: i64 = index.parse().map_err(|_| format!("{} is not an index", quoted(word)))?;
        let from_zero = match number {
            1.. => number - 1,
            ..=0 => number.saturating_add(if number == 0 { -1 } else { vertices as i64 }),
        };
        if !(0..vertices as i64).contains(&from_zero) {
            return Err(format!("index {number} is out of range: there are {vertices} vertices before it"));
        }
        face.push(u32::try_from(from_zero).map_err(|_| "more vertices than 32 bits can count".to_owned())?);
    }
    match face.len() {
        0..3 => Err(format!("a face with {} corners", face.len())),
        n if n > MOST_CORNERS => Err(format!("a face with {n} corners; the most is {MOST_CORNERS}")),
        _ => Ok(face),
    }
}

/// Triangulates a polygon by ear clipping (Meisters 1975): an ear is a convex corner without another corner in its
/// triangle. If a twisted polygon has no ear left, the next corner is used; after [`WORK`] tests per corner the rest
/// becomes a fan.
fn cut(positions: &[Vec3], mut face: Vec<u32>, triangles: &mut Vec<[u32; 3]>) {
    let at = |i: u32| positions[i as usize];
    // Newell's normal, relative to the first corner so that polygons far from the origin keep their precision.
    let origin = at(face[0]);
    let normal: Vec3 =
        (0..face.len()).map(|k| (at(face[k]) - origin).cross(at(face[(k + 1) % face.len()]) - origin)).sum();
    let is_left = |a: Vec3, b: Vec3, c: Vec3| (b - a).cross(c - a).dot(normal) > 0.0;
    let turns_inward = |face: &[u32], k: usize| {
        let [a, b, c] = around(face, k).map(at);
        !is_left(a, b, c)
    };
    // Only reflex corners can be inside an ear.
    let mut inward: Vec<u32> = (0..face.len()).filter(|&k| turns_inward(&face, k)).map(|k| face[k]).collect();
    let mut work = WORK * face.len();
    let mut start = 0;
    while face.len() > 3 && work > 0 {
        let n = face.len();
        let mut is_ear = |k: usize| {
            work = work.saturating_sub(1);
            let corners = around(&face, k);
            let [a, b, c] = corners.map(at);
            is_left(a, b, c)
                && inward.iter().all(|other| {
                    work = work.saturating_sub(1);
                    let p = at(*other);
                    corners.contains(other) || !(is_left(a, b, p) && is_left(b, c, p) && is_left(c, a, p))
                })
        };
        let k = (0..n).map(|i| (start + i) % n).find(|&k| is_ear(k)).unwrap_or(1);
        triangles.push(around(&face, k));
        for changed in [(k + n - 1) % n, k, (k + 1) % n] {
            if turns_inward(&face, changed)
                && let Some(i) = inward.iter().position(|&corner| corner == face[changed])
            {
                inward.swap_remove(i);
            }
        }
        face.remove(k);
        let changed = [(k + n - 2) % (n - 1), k % (n - 1)];
        inward.extend(changed.into_iter().filter(|&k| turns_inward(&face, k)).map(|k| face[k]));
        start = k.saturating_sub(1);
    }
    triangles.extend((1..face.len() - 1).map(|k| [face[0], face[k], face[k + 1]]));
}

/// Returns a corner between the corner before it and the corner after it.
fn around(face: &[u32], k: usize) -> [u32; 3] {
    let n = face.len();
    [face[(k + n - 1) % n], face[k], face[(k + 1) % n]]
}
