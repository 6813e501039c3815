//! Mass of creatures, from the volume inside their skin and their tissue.

use crate::build::built;
use needs_data::needs_data;
use sinew_anim::{Joint, LocalTransform, Primitive, Rig, RigMesh, Skin};
use sinew_math::{Affine, Random, Rotation, Vec3};
use sinew_ragdoll::BuildOptions;
use sinew_ragdoll::masses::volume::{density, enclosed};

/// Returns the corners and triangles of a box, counter-clockwise seen from outside.
fn block(center: Vec3, half: Vec3) -> ([Vec3; 8], [[usize; 3]; 12]) {
    let sign = |i: usize, bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
    let corners = core::array::from_fn(|i| center + half * Vec3::new(sign(i, 0), sign(i, 1), sign(i, 2)));
    let faces = [
        [0, 2, 3],
        [0, 3, 1],
        [4, 5, 7],
        [4, 7, 6],
        [0, 1, 5],
        [0, 5, 4],
        [2, 6, 7],
        [2, 7, 3],
        [0, 4, 6],
        [0, 6, 2],
        [1, 3, 7],
        [1, 7, 5],
    ];
    (corners, faces)
}

fn triangles(center: Vec3, half: Vec3) -> Vec<[Vec3; 3]> {
    let (corners, faces) = block(center, half);
    faces.map(|face| face.map(|i| corners[i])).to_vec()
}

#[test]
fn overlapping_volumes_count_once() {
    let half = Vec3::new(0.5, 1.0, 1.5);
    let one = triangles(Vec3::ZERO, half);
    let is = |triangles: &[[Vec3; 3]], wanted: f32| {
        let volume = enclosed(triangles).expect("the mesh is closed");
        assert!((volume / wanted - 1.0).abs() < 0.02, "volume {volume}, expected {wanted}");
    };
    is(&one, 6.0);
    let mut random = Random::new(3);
    for _ in 0..20 {
        let turn = Rotation::from_scaled_axis(random.in_cube() * 3.0);
        let turned: Vec<_> =
            one.iter().map(|corners| corners.map(|corner| turn * corner + Vec3::X * 9.0)).collect();
        is(&turned, 6.0);
    }
    // Half of the second box is inside the first.
    let two = [one.clone(), triangles(Vec3::X * 0.5, half)].concat();
    is(&two, 9.0);
    let inside_out: Vec<_> = one.iter().map(|[a, b, c]| [*a, *c, *b]).collect();
    is(&inside_out, 6.0);
    // An inner closed surface (an eye) adds nothing, and an opening in the bottom is closed.
    is(&[one.clone(), triangles(Vec3::ZERO, Vec3::splat(0.1))].concat(), 6.0);
    is(&one[2..], 6.0);
    assert_eq!(enclosed(&one[..2]), None, "a sheet");
    assert_eq!(enclosed(&[]), None);
}

/// Returns a worm of thick links that overlap by half, with joints of these names.
fn worm(names: [&str; 3]) -> Rig {
    let mut rig = Rig::default();
    let mut skin = Skin { name: String::new(), joints: vec![], inverse_bind: vec![] };
    let mut part = Primitive::default();
    for (i, name) in names.into_iter().enumerate() {
        let at = Vec3::new(0.0, 0.3, 0.4 * i as f32);
        let parent = i.checked_sub(1);
        let rest = LocalTransform {
            translation: if parent.is_some() { Vec3::Z * 0.4 } else { at },
            ..LocalTransform::default()
        };
        rig.joints.push(Joint { name: name.into(), parent, rest, source: i });
        skin.joints.push(i);
        skin.inverse_bind.push(Affine { translation: -at, ..Affine::IDENTITY });
        let first = u32::try_from(part.positions.len()).expect("the count fits");
        let (corners, faces) = block(at + Vec3::Z * 0.2, Vec3::new(0.3, 0.3, 0.4));
        part.positions.extend(corners);
        part.joints.extend([[u16::try_from(i).expect("the count fits"), 0, 0, 0]; 8]);
        part.weights.extend([[1.0, 0.0, 0.0, 0.0]; 8]);
        part.indices
            .extend(faces.as_flattened().iter().map(|&i| first + u32::try_from(i).expect("the count fits")));
    }
    rig.skins = vec![skin];
    rig.meshes = vec![RigMesh { name: String::new(), joint: 0, skin: Some(0), primitives: vec![part] }];
    rig
}

#[needs_data]
#[test]
fn creature_mass_follows_the_enclosed_volume() {
    // The worm is from -0.2 to 1.4 m long, 0.6 m wide and high: 576 litres; the volumes of its links sum to 864.
    let (def, report) = built(&worm(["a", "b", "c"]), &BuildOptions::default());
    assert!((def.total_mass / 576.0 - 1.0).abs() < 0.03, "{} kg", def.total_mass);
    let note = report.notes.iter().find(|note| note.contains("of flesh, which the skin encloses"));
    assert!(note.is_some_and(|note| note.contains("0.5")), "{:?}", report.notes);
    let (machine, _) = built(&worm(["TankRoot", "Wheel2.L", "c"]), &BuildOptions::default());
    assert!((machine.total_mass / (0.5 * def.total_mass) - 1.0).abs() < 1e-3, "{} kg", machine.total_mass);
    assert_eq!(density(&worm(["a", "wheelbarrow", "Mechthild"])).1, "flesh", "whole words");
    let given = BuildOptions { mass: Some(80.0), ..BuildOptions::default() };
    assert!((built(&worm(["a", "b", "c"]), &given).0.total_mass - 80.0).abs() < 1e-3);
}
