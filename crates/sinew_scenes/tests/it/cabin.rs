//! The cabin and the meadow.

use sinew::math::{Vec3, abs3};
use sinew::physics::shape::Shape;
use sinew::physics::{BodyDef, BodyKind};
use sinew_scenes::cabin::{PORCH_HEIGHT, Prop, STAIRS_WIDTH, STEP_RISE, STEP_RUN, STEPS, Site};

fn half_extents(prop: &Prop) -> Option<Vec3> {
    match prop.body.shapes[0].shape {
        Shape::Box { half_extents } => Some(half_extents),
        _ => None,
    }
}

/// Returns the highest surface under the point (x, z) among level props and the ground.
fn height(props: &[Prop], x: f32, z: f32) -> f32 {
    let over = |prop: &Prop| -> Option<f32> {
        let half = half_extents(prop)?;
        let d = abs3(prop.body.position - Vec3::new(x, prop.body.position.y, z));
        (d.x < half.x && d.z < half.z).then_some(prop.body.position.y + half.y)
    };
    props.iter().filter(|p| ["step", "porch", "floor"].contains(&p.name)).filter_map(over).fold(0.0, f32::max)
}

#[test]
fn props_are_static_boxes_on_one_ground() {
    for site in [Site::CabinWithStairs, Site::Flat] {
        let props = site.props();
        let grounds = props.iter().filter(|p| p.body.shapes[0].shape == Shape::HalfSpace).count();
        assert_eq!(grounds, 1);
        for Prop { name, body, .. } in &props {
            let BodyDef { kind, shapes, rotation, .. } = body;
            assert_eq!(*kind, BodyKind::Static, "{name}");
            assert_eq!(shapes.len(), 1, "{name}");
            assert!((rotation.dot(*rotation) - 1.0).abs() < 1e-5, "{name}");
        }
        for half in props.iter().filter_map(half_extents) {
            assert!(half.x > 0.02 && half.y > 0.02 && half.z > 0.02, "a box is thinner than 4 cm: {half}");
        }
    }
}

#[test]
fn stairs_go_down_to_the_ground_in_equal_steps() {
    let props = Site::CabinWithStairs.props();
    let treads = (0..=STEPS).map(|k| height(&props, 0.3, (k as f32 - 0.5) * STEP_RUN));
    for (k, top) in treads.enumerate() {
        let expected = PORCH_HEIGHT - k as f32 * STEP_RISE;
        assert!((top - expected).abs() < 1e-4, "height after step {k}: {top} m, expected {expected} m");
    }
    let step = props.iter().find(|p| p.name == "step").and_then(half_extents).expect("the cabin has steps");
    assert!((2.0 * step.x - STAIRS_WIDTH).abs() < 1e-5);
}

/// A walker's box, 0.8 m wide and 1.8 m high, touches nothing from the start to the first step.
#[test]
fn path_to_the_stairs_is_level_and_free() {
    for site in [Site::CabinWithStairs, Site::Flat] {
        let (props, spawn) = (site.props(), site.spawn());
        let start = spawn.world_from_character.translation;
        let end = spawn.world_from_character.point(Vec3::Z * spawn.walk_length);
        assert!(end.z.abs() < 1e-5, "the porch must end at z = 0");
        for k in 0..20 {
            let z = start.z + (end.z - start.z) * k as f32 / 20.0;
            assert!((height(&props, 0.0, z) - start.y).abs() < 1e-5, "{site:?} at {z}");
        }
        let center = (start + end) * 0.5 + Vec3::Y * 0.92;
        let walker = Vec3::new(0.4, 0.9, 0.5 * spawn.walk_length);
        for prop in props.iter().filter(|p| !["roof", "stringer"].contains(&p.name)) {
            let Some(half) = half_extents(prop) else { continue };
            // The bounding ball of props rotated about the vertical is wide enough here.
            let reach = if prop.body.rotation.y == 0.0 { half } else { Vec3::splat(half.length()) };
            let gap = abs3(prop.body.position - center) - (reach + walker);
            assert!(gap.max_element() > 0.0, "{site:?}: {} is in the way", prop.name);
        }
    }
}

#[test]
fn flat_site_is_the_same_meadow_without_the_cabin() {
    let (cabin, flat) = (Site::CabinWithStairs.props(), Site::Flat.props());
    assert_eq!(&cabin[..flat.len()], &flat[..]);
    assert!(flat.iter().all(|p| !["step", "porch", "log wall"].contains(&p.name)));
    assert_eq!(height(&flat, 0.0, 0.5), 0.0);
    assert_eq!(Site::Flat.spawn().world_from_character.translation.y, 0.0);
}
