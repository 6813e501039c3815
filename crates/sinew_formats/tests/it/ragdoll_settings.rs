//! Settings files: the example of the documentation, errors.

use crate::world::documented_example;
use sinew_anim::garments::Backstop;
use sinew_formats::read_ragdoll_settings;
use sinew_math::{Random, Range};
use sinew_ragdoll::settings::{BodyWish, JointWish, ShapeWish, Unit};
use sinew_ragdoll::{Sex, ShapeChoice};

fn example() -> String {
    documented_example(include_str!("../../src/ragdoll/settings.rs"))
}

#[test]
fn documented_example_is_read() {
    let settings = read_ragdoll_settings(example().as_bytes()).unwrap();
    assert_eq!((settings.shapes, settings.mass), (Some(ShapeChoice::Auto), Some(82.0)));
    assert_eq!((settings.sex, settings.unit), (Some(Sex::Male), Some(Unit::Height(1.83))));
    let bone = |name: &str| settings.bones.iter().find(|(own, _)| own == name).expect(name).1;
    assert_eq!((bone("head").shape, bone("head").scale), (Some(ShapeWish::Sphere), Some(0.95)));
    assert_eq!(bone("upperArm").swing_z, Some(Range::degrees(-70.0, 70.0)));
    assert_eq!(
        (bone("lowerLeg").joint, bone("lowerLeg").friction_torque),
        (Some(JointWish::Hinge), Some(2.0))
    );
    assert_eq!(bone("Cape_01").body, Some(BodyWish::Drop));
    assert_eq!(
        (bone("Bone_12").role, settings.ignore),
        (Some(sinew_anim::Role::Hips), vec!["Flag".to_owned()])
    );
    assert_eq!(settings.disable, [["leftHand".to_owned(), "leftUpperLeg".to_owned()]]);
    assert_eq!(settings.enable.len(), 1);
}

#[test]
fn errors_name_the_place_and_the_nearest_key() {
    let text = example();
    for (from, to, expected) in [
        (r#""shapes""#, r#""shape""#, "unknown key `shape`; did you mean `shapes`? (top level)"),
        (r#""scale""#, r#""scael""#, "unknown key `scael`; did you mean `scale`? (bones.head)"),
        (
            r#""friction_torque": 2"#,
            r#""wobble": 2"#,
            "unknown key `wobble`; known are comment, role, body, shape, scale, mass, type, limits_deg, friction_torque (bones.lowerLeg)",
        ),
        (r#""sphere""#, r#""spere""#, "unknown word `spere`; did you mean `sphere`? (bones.head.shape)"),
        (
            r#""role": "hips""#,
            r#""role": "hisp""#,
            "no role `hisp`; the nearest of 22 are hips, chest, head; of a creature spine_0, tail_0, limb_0_0 and so on (bones.Bone_12.role)",
        ),
        (r#"["Flag"]"#, r#"[7]"#, "must be a string (ignore[0])"),
        (r#""mass": 82"#, r#""mass": -1"#, "must be more than 0 (mass)"),
        (
            r#""mass": 82"#,
            r#""unit_scale": 0.01"#,
            "`unit_scale` sets the same: give one of the two (height)",
        ),
        ("[-80, 80]", "[10, 80]", "a swing's range must contain zero (bones.upperArm.limits_deg.swing_y)"),
        ("[-2, 130]", "[130, -2]", "the lower end comes first (bones.lowerLeg.limits_deg.twist)"),
        (r#"["leftHand", "leftUpperLeg"]"#, r#"["leftHand"]"#, "must name two bones (disable_pairs[0])"),
        (r#""version": 1"#, r#""version": 2"#, "version 2 is newer than 1, the last one known (version)"),
        (
            r#""ragdoll-settings""#,
            r#""ragdoll""#,
            "this is a `ragdoll` file, not a `ragdoll-settings` (sinew)",
        ),
    ] {
        assert!(text.contains(from), "{from}");
        let error = read_ragdoll_settings(text.replacen(from, to, 1).as_bytes()).unwrap_err();
        assert_eq!(error.to_string(), expected);
    }
}

#[test]
fn randomly_changed_bytes_do_not_panic() {
    let whole = example().into_bytes();
    let mut random = Random::new(7);
    for _ in 0..2000 {
        let mut bytes = whole.clone();
        for _ in 0..=random.index(4) {
            let at = random.index(bytes.len());
            bytes[at] = random.index(256) as u8;
        }
        let _ = read_ragdoll_settings(&bytes);
    }
}

/// Checks that the documented settings are the ones that the reader accepts.
#[test]
fn examples_of_the_page_are_read() {
    let page = include_str!("../../../../docs/ragdoll.md");
    let examples: Vec<&str> =
        page.split("```json\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    let [definition, settings] = examples[..] else { panic!("the page has {} examples", examples.len()) };
    assert!(sinew_formats::read_ragdoll(definition.as_bytes()).is_ok());
    assert_eq!(read_ragdoll_settings(settings.as_bytes()), read_ragdoll_settings(example().as_bytes()));
}

#[test]
fn garments_are_read_by_name_or_as_a_list() {
    use sinew_ragdoll::settings::GarmentSource;
    let read = |garments: &str| {
        let text = format!(r#"{{"sinew": "ragdoll-settings", "version": 1, "garments": {garments}}}"#);
        read_ragdoll_settings(text.as_bytes())
    };
    assert_eq!(read(r#""names""#).unwrap().garments, GarmentSource::Names);
    assert_eq!(read(r#""none""#).unwrap().garments, GarmentSource::None);
    let all = r#"[{"comment": "wool", "name": "kilt", "chains": ["Kilt_*"], "closed": true, "area_density": 0.8, "radius": 0.01,
        "spacing": 0.04, "stretching": 900, "shearing": 0, "bending": 0, "damping_ratio": 0.1, "drag": 0, "friction": 0.5,
        "meets_arms": true, "thickness": 0.02}]"#;
    let GarmentSource::Listed(listed) = read(all).unwrap().garments else { panic!("a list") };
    assert_eq!(
        (listed[0].chains.as_slice(), listed[0].closed),
        (["Kilt_*".to_owned()].as_slice(), Some(true))
    );
    let cloth = &listed[0].cloth;
    assert_eq!((cloth.name.as_str(), cloth.area_density, cloth.meets_arms), ("kilt", 0.8, Some(true)));
    assert_eq!((cloth.spacing, cloth.stretching, cloth.thickness), (0.04, 900.0, 0.02));
    let backstop = |text: &str| {
        let all = format!(r#"[{{"mesh": "a", "backstop": {text}}}]"#);
        let GarmentSource::Listed(listed) = read(&all).unwrap().garments else { panic!("a list") };
        listed[0].cloth.backstop
    };
    assert_eq!(listed[0].cloth.backstop, None);
    assert_eq!(backstop(r#"{"distance": 0.01}"#), Some(Backstop { distance: 0.01, ..Backstop::default() }));
    let both = Backstop { distance: 0.02, radius: 0.1 };
    assert_eq!(backstop(r#"{"distance": 0.02, "radius": 0.1}"#), Some(both));
    for (garments, message) in [
        (r#""all""#, "names"),
        (r#"[{}]"#, "chains"),
        (r#"[{"chains": ["a"], "raduis": 1}]"#, "radius"),
        (r#"[{"chains": ["a"], "radius": 0}]"#, "garments[0].radius"),
        (r#"[{"chains": ["a"]}, {"chains": ["b"], "closed": 1}]"#, "garments[1].closed"),
        (r#"[{"chains": ["a"], "shearing": -1}]"#, "garments[0].shearing"),
        // Values that no particle or spring can have.
        (r#"[{"chains": ["a"], "area_density": 3e38}]"#, "between 0.001 and 1000"),
        (r#"[{"chains": ["a"], "area_density": 1e-44}]"#, "between 0.001 and 1000"),
        (r#"[{"mesh": "a", "spacing": 1e-30}]"#, "garments[0].spacing"),
        (r#"[{"mesh": "a", "backstop": {"distance": 3e38}}]"#, "garments[0].backstop.distance"),
        (r#"[{"mesh": "a", "backstop": {"distance": 0, "radius": 3e38}}]"#, "garments[0].backstop.radius"),
        (r#"[{"mesh": "a", "radius": 11}]"#, "garments[0].radius"),
        (r#"[{"mesh": "a", "stretching": 1e38}]"#, "garments[0].stretching"),
        (r#"[{"mesh": "a", "bending": 1e38}]"#, "garments[0].bending"),
        (r#"[{"mesh": "a", "damping_ratio": 3e38}]"#, "garments[0].damping_ratio"),
        (r#"[{"mesh": "a", "drag": 101}]"#, "garments[0].drag"),
        (r#"[{"mesh": "a", "friction": 101}]"#, "garments[0].friction"),
        (r#"[{"mesh": "a", "thickness": 1.5}]"#, "garments[0].thickness"),
        (r#"[{"mesh": "a", "backstop": {"distance": -0.1}}]"#, "garments[0].backstop.distance"),
        (r#"[{"mesh": "a", "backstop": {"distance": 0, "radius": 0}}]"#, "garments[0].backstop.radius"),
        (r#"[{"mesh": "a", "backstop": {"depth": 0.1}}]"#, "distance"),
    ] {
        let error = read(garments).unwrap_err().to_string();
        assert!(error.contains(message), "{garments}: {error}");
    }
}
