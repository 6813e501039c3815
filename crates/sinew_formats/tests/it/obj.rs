//! OBJ files: accepted content, and rejected content with its line.

use sinew_formats::read_obj;
use sinew_math::Vec3;

fn refusal(text: impl AsRef<[u8]>) -> String {
    read_obj(text.as_ref()).expect_err("a bad file").to_string()
}

#[test]
fn faces_of_every_kind_are_read() {
    let text = "# a comment\nmtllib none.mtl\no thing\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0\nv 0 1 0\r\nvn 0 0 1\nvt 0 0\n\
        usemtl stone\ns off\nf 1//1 2//1 3//1 # with a comment\nf -4/1 \\\n  -2/1 -1/1\nf 1 2 3 4\n";
    let mesh = read_obj(text.as_bytes()).expect("a good file");
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]);
    assert_eq!(mesh.triangles[..2], [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.triangles.len(), 4);
    assert_eq!(mesh.colors.len(), 4);
}

/// An arrow head, which cannot be triangulated as a fan from its first corner.
#[test]
fn concave_faces_keep_their_area() {
    let text = "v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 1 2 3 4\nf 2 3 4 1\nf 3 4 1 2\nf 4 1 2 3\n";
    let mesh = read_obj(text.as_bytes()).expect("a good file");
    assert_eq!(mesh.triangles.len(), 8);
    for pair in mesh.triangles.chunks(2) {
        let areas = pair.iter().map(|t| {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            (b - a).cross(c - a).z * 0.5
        });
        let areas: Vec<f32> = areas.collect();
        assert!(areas.iter().all(|&area| area > 0.0), "triangles are turned over; areas {areas:?}");
        assert!((areas.iter().sum::<f32>() - 4.0).abs() < 1e-5, "{areas:?}");
    }
}

#[test]
fn invalid_lines_are_rejected_with_their_number() {
    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let many = format!("{SQUARE}f{}\n", " 1".repeat(5000));
    for (text, expected) in [
        ("", "not an OBJ file, or an empty one: it has neither vertices nor faces (line 1)".to_owned()),
        ("hello world\n", "not an OBJ file: unknown word `hello` (line 1)".into()),
        ("v 0 0\n", "a vertex without z (line 1)".into()),
        ("v 0 0 zero\n", "`zero` is not a number (line 1)".into()),
        ("v 0 0 0\nv 0 nan 0\n", "`nan` is not finite (line 2)".into()),
        ("v 0 0 1e39\n", "`1e39` is not finite (line 1)".into()),
        (
            &format!("{SQUARE}f 1 2 9\n"),
            "index 9 is out of range: there are 3 vertices before it (line 4)".into(),
        ),
        (
            &format!("{SQUARE}f 0 1 2\n"),
            "index 0 is out of range: there are 3 vertices before it (line 4)".into(),
        ),
        (
            &format!("{SQUARE}f -4 1 2\n"),
            "index -4 is out of range: there are 3 vertices before it (line 4)".into(),
        ),
        (
            &format!("{SQUARE}f -9223372036854775808 1 2\n"),
            "index -9223372036854775808 is out of range: there are 3 vertices before it (line 4)".into(),
        ),
        (
            &format!("{SQUARE}f 1 2 99999999999999999999\n"),
            "`99999999999999999999` is not an index (line 4)".into(),
        ),
        (&format!("{SQUARE}f 1 2\n"), "a face with 2 corners (line 4)".into()),
        (&format!("{SQUARE}f\n"), "a face with 0 corners (line 4)".into()),
        (&format!("{SQUARE}f 1 2 x/y\n"), "`x/y` is not an index (line 4)".into()),
        (&many, "a face with 5000 corners; the most is 1024 (line 4)".into()),
    ] {
        assert_eq!(refusal(text), expected);
    }
    assert_eq!(refusal([b'v', b' ', 0xff, 0xfe]), "not an OBJ file: not text in UTF-8 (byte 2)");
}

#[test]
fn twisted_faces_finish_quickly() {
    let text = "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nf 1 2 3 4 5\nf 1 1 1 1 1\n";
    assert_eq!(read_obj(text.as_bytes()).expect("odd, but a file").triangles.len(), 6);
}

#[test]
fn trailing_backslash_does_not_continue_a_comment() {
    let text = "# made from C:\\models\\\nv 0 0 0\nv 1 0 0\nv 0 1 0\n  # \\\nf 1 \\\n2 \\\n3\n";
    let mesh = read_obj(text.as_bytes()).expect("a good file");
    assert_eq!((mesh.positions.len(), mesh.triangles), (3, vec![[0, 1, 2]]));
}

/// If each line were joined to all earlier lines, 80 GB would be copied.
#[test]
fn many_continued_lines_finish_quickly() {
    let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 \\\n{}2 3\n", "\\\n".repeat(400_000));
    assert_eq!(read_obj(text.as_bytes()).expect("a good file").triangles, [[0, 1, 2]]);
}

/// A star, in which every other corner is reflex, keeps its area.
#[test]
fn large_jagged_face_keeps_its_area() {
    let corner = |k: usize| {
        let (sin, cos) = sinew_math::trig::sin_cos(k as f32 * core::f32::consts::TAU / 256.0);
        Vec3::new(cos, sin, 0.0) * if k.is_multiple_of(2) { 1.0 } else { 0.8 }
    };
    let mut text: String = (0..256).map(corner).map(|p| format!("v {} {} 0\n", p.x, p.y)).collect();
    text += "f";
    text.extend((1..=256).map(|k| format!(" {k}")));
    let mesh = read_obj(text.as_bytes()).expect("a good file");
    let areas = mesh.triangles.iter().map(|t| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        (b - a).cross(c - a).z * 0.5
    });
    let expected = 128.0 * 0.8 * sinew_math::trig::sin_cos(core::f32::consts::TAU / 256.0).0;
    assert_eq!(mesh.triangles.len(), 254);
    assert!((areas.sum::<f32>() - expected).abs() < 1e-4);
}

/// A hundred twisted faces of the maximum size would take an hour without a bound.
#[test]
fn large_twisted_faces_finish_quickly() {
    let mut random = sinew_math::Random::new(3);
    let point = |p: Vec3| format!("v {} {} {}\n", p.x, p.y, p.z);
    let mut text: String = (0..1024).map(|_| point(random.in_cube())).collect();
    let face: String = (1..=1024).map(|k| format!(" {k}")).collect();
    for _ in 0..100 {
        text += &format!("f{face}\n");
    }
    assert_eq!(read_obj(text.as_bytes()).expect("odd, but a file").triangles.len(), 100 * 1022);
}
