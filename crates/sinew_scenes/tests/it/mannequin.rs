//! The mannequin's rig and surface.

use sinew::anim::Primitive;
use sinew::math::{StableHasher, Vec3};
use sinew_scenes::mannequin::mannequin;
use std::collections::BTreeMap;

fn primitives() -> Vec<Primitive> {
    mannequin().rig.meshes.remove(0).primitives
}

fn triangles(primitive: &Primitive) -> impl Iterator<Item = [usize; 3]> {
    primitive.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]].map(|i| i as usize))
}

#[test]
fn mannequin_stands_on_the_floor_and_is_175_cm_high() {
    let all: Vec<f32> = primitives().iter().flat_map(|p| p.positions.iter().map(|v| v.y)).collect();
    let (low, high) = all.iter().fold((f32::MAX, f32::MIN), |(a, b), &y| (a.min(y), b.max(y)));
    assert!(low.abs() < 0.003, "soles at {low}");
    assert!((high - 1.75).abs() < 0.005, "crown at {high}");
    assert!((3_000..=8_000).contains(&all.len()), "{} vertices", all.len());
}

#[test]
fn parents_come_first_and_rest_positions_add_up() {
    let rig = mannequin().rig;
    let mut positions: Vec<Vec3> = Vec::new();
    for (index, joint) in rig.joints.iter().enumerate() {
        let origin = joint.parent.map_or(Vec3::ZERO, |p| positions[p]);
        assert!(joint.parent.is_none_or(|p| p < index));
        positions.push(origin + joint.rest.translation);
    }
    for (slot, &joint) in rig.skins[0].joints.iter().enumerate() {
        let back = rig.skins[0].inverse_bind[slot].point(positions[joint]);
        assert!(back.length() < 1e-6, "{} is bound at {back}", rig.joints[joint].name);
    }
}

#[test]
fn weights_add_up_to_one_and_every_bone_has_skin() {
    let rig = mannequin().rig;
    let slots = rig.skins[0].joints.len();
    let (mut vertices, mut area, mut blended) = (vec![0; slots], vec![0.0; slots], 0);
    for primitive in primitives() {
        for (joints, weights) in primitive.joints.iter().zip(&primitive.weights) {
            assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
            assert!(weights.iter().all(|w| (0.0..=1.0).contains(w)));
            blended += usize::from(weights.iter().filter(|&&w| w > 0.05).count() > 1);
            for (&slot, &weight) in joints.iter().zip(weights) {
                vertices[usize::from(slot)] += usize::from(weight >= 0.5);
            }
        }
        for t in triangles(&primitive) {
            let [a, b, c] = t.map(|i| primitive.positions[i]);
            let size = 0.5 * (b - a).cross(c - a).length();
            for (&slot, &weight) in primitive.joints[t[0]].iter().zip(&primitive.weights[t[0]]) {
                area[usize::from(slot)] += size * weight;
            }
        }
    }
    for slot in 0..slots {
        let name = &rig.joints[rig.skins[0].joints[slot]].name;
        assert!(vertices[slot] >= 24, "{name}: {} vertices", vertices[slot]);
        assert!(area[slot] > 0.004, "{name}: {} m²", area[slot]);
    }
    assert!(blended > 300, "only {blended} blended vertices");
}

/// Checks that each edge of a closed, consistently wound surface exists exactly once in each direction.
#[test]
fn surface_is_closed_and_winds_outward() {
    for primitive in primitives() {
        let mut edges: BTreeMap<(usize, usize), u32> = BTreeMap::new();
        for [a, b, c] in triangles(&primitive) {
            for edge in [(a, b), (b, c), (c, a)] {
                *edges.entry(edge).or_default() += 1;
            }
        }
        for (&(a, b), &count) in &edges {
            assert_eq!(count, 1, "edge {a}-{b}");
            assert_eq!(edges.get(&(b, a)), Some(&1), "edge {a}-{b} has only one triangle");
        }
    }
}

/// Returns a label of the connected part of each vertex.
fn parts(primitive: &Primitive) -> Vec<usize> {
    let mut label: Vec<usize> = (0..primitive.positions.len()).collect();
    loop {
        let mut changed = false;
        for t in triangles(primitive) {
            let lowest = t.iter().map(|&i| label[i]).min().unwrap_or(0);
            for i in t {
                changed |= label[i] != lowest;
                label[i] = lowest;
            }
        }
        if !changed {
            return label;
        }
    }
}

#[test]
fn each_part_encloses_volume_and_the_sum_is_that_of_a_person() {
    let (mut count, mut total) = (0, 0.0);
    for primitive in primitives() {
        let label = parts(&primitive);
        let mut volumes: BTreeMap<usize, f32> = BTreeMap::new();
        for t in triangles(&primitive) {
            let [a, b, c] = t.map(|i| primitive.positions[i]);
            *volumes.entry(label[t[0]]).or_default() += a.cross(b).dot(c) / 6.0;
        }
        for (part, volume) in volumes {
            assert!(volume > 2e-6, "part {part}: volume {volume} m³");
            count += 1;
            total += volume;
        }
    }
    assert_eq!(count, 2 * 9 + 7, "expected nine parts on each side and seven in the middle");
    // Parts overlap at the joints, so the sum is above the 0.065 to 0.075 m³ of a slim adult.
    assert!((0.06..0.09).contains(&total), "the parts enclose {total} m³");
}

#[test]
fn normals_are_unit_and_agree_with_the_triangles() {
    for primitive in primitives() {
        assert!(primitive.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-4));
        for t in triangles(&primitive) {
            let [a, b, c] = t.map(|i| primitive.positions[i]);
            let face = (b - a).cross(c - a);
            let sum = t.map(|i| primitive.normals[i]).into_iter().sum::<Vec3>();
            assert!(face.dot(sum) >= 0.0, "triangle at {a}");
        }
    }
}

#[test]
fn left_mirrors_right() {
    let key = |v: Vec3, flip: f32| {
        [v.x * flip, v.y, v.z].map(|x| (x * 1e5 + if x < 0.0 { -0.5 } else { 0.5 }) as i32)
    };
    let near = |all: &BTreeMap<[i32; 3], ()>, k: [i32; 3]| {
        let around = |d: i32| [k[0] + d / 9 % 3 - 1, k[1] + d / 3 % 3 - 1, k[2] + d % 3 - 1];
        (0..27).any(|d| all.contains_key(&around(d)))
    };
    for primitive in primitives() {
        let all: BTreeMap<[i32; 3], ()> = primitive.positions.iter().map(|&v| (key(v, 1.0), ())).collect();
        for &v in &primitive.positions {
            assert!(near(&all, key(v, -1.0)), "{v} has no mirror image");
        }
    }
    let rig = mannequin().rig;
    for joint in &rig.joints {
        let Some(rest) = joint.name.strip_prefix("left") else { continue };
        let twin = rig
            .joints
            .iter()
            .find(|j| j.name == format!("right{rest}"))
            .expect("the joint has a counterpart on the right");
        let t = joint.rest.translation;
        assert_eq!(twin.rest.translation, Vec3::new(-t.x, t.y, t.z), "{}", joint.name);
    }
}

/// The mannequin is in every recording's start state, so a change of its bits is a change of format.
#[test]
fn mannequin_has_the_bits_of_the_release() {
    let mannequin = mannequin();
    let mut hasher = StableHasher::default();
    for primitive in &mannequin.rig.meshes[0].primitives {
        for v in primitive.positions.iter().chain(&primitive.normals) {
            v.to_array().iter().for_each(|x| hasher.write(&x.to_le_bytes()));
        }
        primitive.weights.iter().flatten().for_each(|x| hasher.write(&x.to_le_bytes()));
        primitive.joints.iter().flatten().for_each(|x| hasher.write(&x.to_le_bytes()));
        primitive.indices.iter().for_each(|x| hasher.write(&x.to_le_bytes()));
    }
    for channel in mannequin.clips.iter().flat_map(|clip| &clip.channels) {
        channel.values.iter().for_each(|x| hasher.write(&x.to_le_bytes()));
    }
    assert_eq!(format!("{:016x}", hasher.finish()), "72454b21deb282cd");
}
