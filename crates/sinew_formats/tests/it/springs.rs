//! Tests of springs in VRM files of both versions, and of wrong files.

use crate::data::shared_data;
use needs_data::needs_data;
use sinew_anim::springs::{ColliderShape, LimitKind, Side};
use sinew_anim::{SpringCollider, SpringLink, Springs};
use sinew_formats::{Document, ReadOptions, Result, load_gltf, no_files, read_gltf, read_ragdoll_settings};
use sinew_math::{Rotation, Vec3};
use sinew_ragdoll::settings::SpringSource;

/// Six nodes: a body with a head, a strand of three on the head, and a node beside the body.
const NODES: &str = r#""asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[
    {"name":"body","children":[1]},{"name":"head","translation":[0,1,0],"children":[2,5]},
    {"name":"a","translation":[0,0.1,0],"rotation":[0,0,1,0],"children":[3]},
    {"name":"b","translation":[0,0.2,0],"children":[4]},{"name":"c","translation":[0,0.3,0]},
    {"name":"side","translation":[0.5,0,0]}]"#;

fn read(extensions: &str) -> Result<Document> {
    let json = format!("{{{NODES},\"extensions\":{extensions}}}");
    read_gltf(json.as_bytes(), ReadOptions::default(), &mut no_files)
}

fn springs(extensions: &str) -> Springs {
    read(extensions).unwrap().rig.springs
}

#[test]
fn version_1_springs_are_read_with_extended_colliders_and_limits() {
    let springs = springs(
        r#"{"VRMC_springBone":{"specVersion":"1.0",
        "colliders":[
            {"node":1,"shape":{"sphere":{"offset":[0,0.1,0],"radius":0.2}}},
            {"node":0,"shape":{"capsule":{"radius":0.1,"tail":[0,0,1]}}},
            {"node":1,"shape":{"sphere":{"offset":[0,-10000,0]}},"extensions":{"VRMC_springBone_extended_collider":
                {"specVersion":"1.0","shape":{"sphere":{"radius":0.5,"inside":true}}}}},
            {"node":1,"shape":{"sphere":{}},"extensions":{"VRMC_springBone_extended_collider":
                {"specVersion":"1.0","shape":{"plane":{"offset":[0,0,1],"normal":[0,2,0]}}}}}],
        "colliderGroups":[{"colliders":[0,1]},{"name":"more","colliders":[1,3,2]}],
        "springs":[{"name":"hair","center":0,"colliderGroups":[0,1],"joints":[
            {"node":2,"stiffness":0.7,"gravityPower":0.5,"gravityDir":[0,0,-1],"dragForce":0.3,"hitRadius":0.02,
             "extensions":{"VRMC_springBone_limit":{"limit":{"cone":{"angle":0.8,"rotation":[0,0,2,0]}}}}},
            {"node":3},{"node":4}]}]}}"#,
    );
    let [chain] = &springs.chains[..] else { panic!("{springs:?}") };
    assert_eq!((chain.name.as_str(), chain.center, chain.hits_body), ("hair", Some(0), false));
    assert_eq!(chain.colliders, [0, 1, 3, 2], "each chain once, in the order of the groups");
    let [a, b] = chain.bones[..] else { panic!("the last joint is an end only") };
    assert_eq!((a.joint, a.stiffness, a.drag, a.radius), (2, 0.7, 0.3, 0.02));
    assert_eq!((a.gravity, a.tail), (Vec3::new(0.0, 0.0, -0.5), Vec3::new(0.0, 0.2, 0.0)));
    let limit = a.limit.unwrap();
    assert_eq!(
        (limit.kind, limit.rotation.angle_to(Rotation::from_xyzw(0.0, 0.0, 1.0, 0.0))),
        (LimitKind::Cone { angle: 0.8 }, 0.0)
    );
    // Defaults of the format's schema.
    assert_eq!((b.stiffness, b.drag, b.radius, b.gravity, b.limit), (1.0, 0.5, 0.0, Vec3::ZERO, None));
    let sphere = |offset, radius, keeps| ColliderShape::Sphere { offset, radius, keeps };
    let due = [
        (1, sphere(Vec3::Y * 0.1, 0.2, Side::Outside)),
        (0, ColliderShape::Capsule { offset: Vec3::ZERO, tail: Vec3::Z, radius: 0.1, keeps: Side::Outside }),
        (1, sphere(Vec3::ZERO, 0.5, Side::Inside)),
        (1, ColliderShape::Plane { offset: Vec3::Z, normal: Vec3::Y }),
    ];
    assert_eq!(springs.colliders, due.map(|(joint, shape)| SpringCollider { joint, shape }));
}

#[test]
fn limits_of_springs_hold_for_their_joints() {
    let limited = |limit: &str| {
        let springs = springs(&format!(
            r#"{{"VRMC_springBone":{{"springs":[{{"extensions":{{"VRMC_springBone_limit":{limit}}},
            "joints":[{{"node":2}},{{"node":4}}]}}]}}}}"#
        ));
        // A joint between the two is skipped: the tip is the next named joint.
        let tail = springs.chains[0].bones[0].tail;
        assert!((tail - Vec3::new(0.0, 0.5, 0.0)).length() < 1e-6, "{tail}");
        springs.chains[0].bones[0].limit.unwrap().kind
    };
    let pi = core::f32::consts::PI;
    assert_eq!(limited(r#"{"hinge":{"angle":9}}"#), LimitKind::Hinge { angle: pi });
    let spherical = LimitKind::Spherical { phi: 1.0, theta: pi / 2.0 };
    assert_eq!(limited(r#"{"limit":{"spherical":{"phi":1,"theta":2}}}"#), spherical);
}

#[test]
fn version_0_springs_include_all_descendants() {
    let springs = springs(
        r#"{"VRM":{"secondaryAnimation":{
        "boneGroups":[{"comment":"hair","stiffiness":2,"gravityPower":0.5,"gravityDir":{"x":0,"y":-1,"z":0.5},
            "dragForce":0.4,"center":-1,"hitRadius":0.03,"bones":[2,-1,3],"colliderGroups":[0]}],
        "colliderGroups":[{"node":1,"colliders":[{"offset":{"x":0.1,"y":0.2,"z":0.3},"radius":0.1}]}]}}}"#,
    );
    let [chain] = &springs.chains[..] else { panic!("its second root hangs on the first: {springs:?}") };
    assert_eq!((chain.name.as_str(), chain.center, &chain.colliders[..]), ("hair", None, &[0][..]));
    let joints: Vec<usize> = chain.bones.iter().map(|bone| bone.joint).collect();
    assert_eq!(joints, [2, 3, 4]);
    // Unity's z axis has the opposite direction.
    assert_eq!(chain.bones[0].gravity, Vec3::new(0.0, -0.5, -0.25));
    assert_eq!((chain.bones[0].stiffness, chain.bones[0].drag, chain.bones[0].radius), (2.0, 0.4, 0.03));
    // The tip is seven centimetres beyond the last joint.
    assert!((chain.bones[2].tail - Vec3::new(0.0, 0.07, 0.0)).length() < 1e-6, "{}", chain.bones[2].tail);
    let offset = Vec3::new(0.1, 0.2, -0.3);
    let shape = ColliderShape::Sphere { offset, radius: 0.1, keeps: Side::Outside };
    assert_eq!(springs.colliders, [SpringCollider { joint: 1, shape }]);
}

#[test]
fn invalid_springs_are_rejected_with_their_place() {
    let version_1 = |what: &str| format!("{{\"VRMC_springBone\":{{{what}}}}}");
    let version_0 = |what: &str| format!("{{\"VRM\":{{\"secondaryAnimation\":{{{what}}}}}}}");
    for (extensions, what, place) in [
        (version_1(r#""springs":3"#), "must be an array", "springs"),
        (version_1(r#""springs":[{"joints":[{"node":99}]}]"#), "out of range", "joints[0].node"),
        (version_1(r#""springs":[{"joints":[{}]}]"#), "`node` is missing", "joints[0]"),
        (version_1(r#""springs":[{"colliderGroups":[0]}]"#), "out of range", "colliderGroups[0]"),
        (version_1(r#""colliderGroups":[{"colliders":[0]}]"#), "out of range", "colliders[0]"),
        (version_1(r#""colliders":[{"node":1,"shape":{}}]"#), "must have a sphere", "colliders[0].shape"),
        (version_1(r#""colliders":[{"node":1,"shape":{"sphere":{"radius":-1}}}]"#), "negative", "radius"),
        (
            version_1(r#""springs":[{"joints":[{"node":2,"stiffness":1e99},{"node":3}]}]"#),
            "too large",
            "stiffness",
        ),
        (version_1(r#""springs":[{"center":-1}]"#), "whole number", "center"),
        (version_0(r#""boneGroups":[{"bones":[77]}]"#), "out of range", "bones[0]"),
        (version_0(r#""boneGroups":[{"gravityDir":[0,1,0]}]"#), "must be an object", "gravityDir"),
    ] {
        let error = read(&extensions).expect_err(&extensions);
        assert!(error.what.contains(what) && error.where_.contains(place), "{extensions}: {error}");
    }
}

#[test]
fn unusable_springs_are_skipped_with_a_warning() {
    // One spring has a joint that is not below the previous one; another joint is in two springs.
    let document = read(
        r#"{"VRMC_springBone":{"springs":[{"joints":[{"node":2},{"node":3},{"node":5}]},
        {"joints":[{"node":2},{"node":3},{"node":4}]}]}}"#,
    )
    .unwrap();
    let joints: Vec<Vec<usize>> =
        document.rig.springs.chains.iter().map(|c| c.bones.iter().map(|b| b.joint).collect()).collect();
    assert_eq!(joints, [[2], [3]]);
    assert_eq!(document.warnings.len(), 2, "{:?}", document.warnings);
    assert!(document.warnings[0].contains("must hang on") && document.warnings[0].contains("joints[2]"));
    assert!(document.warnings[1].contains("another spring"));
}

#[test]
fn excessive_collider_groups_are_rejected() {
    // A few kilobytes that would refer to millions of colliders.
    let colliders = vec![r#"{"node":1,"shape":{"sphere":{}}}"#; 2000].join(",");
    let members: Vec<String> = (0..2000).map(|index| index.to_string()).collect();
    let group = format!(r#"{{"colliders":[{}]}}"#, members.join(","));
    let groups = vec!["0"; 3000].join(",");
    let spring = format!(r#"{{"colliderGroups":[{groups}],"joints":[{{"node":2}},{{"node":3}}]}}"#);
    let many = vec![spring; 40].join(",");
    let error = read(&format!(
        r#"{{"VRMC_springBone":{{"colliders":[{colliders}],"colliderGroups":[{group}],"springs":[{many}]}}}}"#
    ))
    .expect_err("1.9 GB of references are rejected");
    assert!(error.what.contains("more than the size of the file"), "{error}");
}

#[test]
fn source_of_springs_follows_from_the_settings() {
    let read = |word: &str| {
        let json = format!(r#"{{"sinew":"ragdoll-settings","version":1,"springs":"{word}"}}"#);
        read_ragdoll_settings(json.as_bytes())
    };
    assert_eq!(read("names").unwrap().springs, Some(SpringSource::Names));
    assert_eq!(read("none").unwrap().springs, Some(SpringSource::None));
    let error = read("name").unwrap_err();
    assert!(error.what.contains("did you mean `names`?"), "{error}");
}

#[test]
fn settings_link_strands() {
    let read = |springs: &str| {
        let json = format!(r#"{{"sinew":"ragdoll-settings","version":1,"springs":{springs}}}"#);
        read_ragdoll_settings(json.as_bytes())
    };
    let settings = read(
        r#"{"comment": "a kilt", "source": "names", "links": [
            {"comment": "all round", "chains": ["Kilt_*"], "closed": true, "share": 0.8, "holds_apart": true}, {"chains": ["a", "b"]}]}"#,
    )
    .unwrap();
    let links = settings.spring_links.unwrap();
    assert_eq!(settings.springs, Some(SpringSource::Names));
    assert_eq!((links[0].chains.as_slice(), links[0].closed), (["Kilt_*".to_owned()].as_slice(), Some(true)));
    assert_eq!((links[0].link.share, links[0].link.holds_apart), (0.8, true));
    assert_eq!((links[1].closed, links[1].link), (None, SpringLink::default()));
    // Without `links` the springs keep their own links; an empty list removes them.
    assert_eq!(read(r#"{"source": "file"}"#).unwrap().spring_links, None);
    let none = read(r#"{"links": []}"#).unwrap();
    assert_eq!((none.springs, none.spring_links), (None, Some(Vec::new())));
    for (springs, at, what) in [
        (r#"{"sorce": "names"}"#, "springs", "did you mean `source`?"),
        (r#"{"source": "nams"}"#, "springs.source", "did you mean `names`?"),
        (r#"{"links": [{}]}"#, "springs.links[0]", "chains"),
        (r#"{"links": [{"chains": ["a"], "shair": 1}]}"#, "springs.links[0]", "did you mean `share`?"),
        (
            r#"{"links": [{"chains": ["a"]}, {"chains": ["b"], "share": 1.5}]}"#,
            "springs.links[1].share",
            "at most 1",
        ),
        (r#"{"links": [{"chains": ["a"], "share": 0}]}"#, "springs.links[0].share", ""),
        (r#"{"links": [{"chains": ["a"], "holds_apart": 1}]}"#, "springs.links[0].holds_apart", ""),
        (r#"{"links": "all"}"#, "springs.links", ""),
        ("7", "springs", ""),
    ] {
        let error = read(springs).unwrap_err().to_string();
        assert!(error.contains(at) && error.contains(what), "{springs}: {error}");
    }
}

#[needs_data]
#[test]
fn shared_avatars_are_read() {
    let folder = shared_data();
    let springs =
        |name: &str| load_gltf(folder.join("rigs").join(name), ReadOptions::default()).unwrap().rig.springs;
    // The first file has one bone group without bones, the second none.
    assert_eq!(springs("CoolLoops_mixamorig_vrm0.vrm"), Springs::default());
    assert_eq!(springs("vrm1_unskinned_humanoid.vrm"), Springs::default());
}
