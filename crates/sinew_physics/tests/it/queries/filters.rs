//! Filters of queries: which shapes a query includes.

use sinew_math::Vec3;
use sinew_physics::ray::Ray;
use sinew_physics::*;

/// Returns balls of radius 0.4 m in a row, one per metre, and a ray through all of them.
fn row(defs: Vec<(BodyKind, ShapeDef)>) -> (World, Vec<BodyId>, Ray) {
    let mut world = World::new(WorldDef::default());
    let add = |(k, (kind, shape)): (usize, (BodyKind, ShapeDef))| {
        let position = Vec3::X * k as f32;
        world.add_body(&BodyDef { kind, position, shapes: vec![shape], ..BodyDef::default() })
    };
    let ids = defs.into_iter().enumerate().map(add).collect();
    (world, ids, Ray { origin: Vec3::X * -1.0, direction: Vec3::X * 100.0 })
}

fn ball() -> ShapeDef {
    ShapeDef::new(Shape::Sphere { radius: 0.4 })
}

fn filtered(layers: u32, mask: u32, group: i32) -> ShapeDef {
    ShapeDef { filter: Filter { layers, mask, group }, ..ball() }
}

/// Returns the indices of the bodies that a ray hits.
fn met(world: &World, ids: &[BodyId], ray: &Ray, filter: QueryFilter<'_>) -> Vec<usize> {
    let mut hits = Vec::new();
    world.query().filter(filter).all(ray, &mut hits);
    hits.iter()
        .map(|hit| ids.iter().position(|id| *id == hit.body).expect("the hit body is one of the row"))
        .collect()
}

#[test]
fn query_filter_applies_layers_masks_and_groups_like_a_shape() {
    let defs = [
        filtered(1, u32::MAX, 0),
        filtered(2, u32::MAX, 0),
        filtered(1, 4, 0),
        filtered(1, 0, 0),
        filtered(1, 1, -3),
    ];
    let (world, ids, ray) = row(defs.map(|shape| (BodyKind::Static, shape)).to_vec());
    let meets = |layers, mask, group| {
        let meets = Filter { layers, mask, group };
        met(&world, &ids, &ray, QueryFilter { meets, ..QueryFilter::default() })
    };
    assert_eq!(met(&world, &ids, &ray, QueryFilter::default()), [0, 1, 2, 4]);
    assert_eq!(meets(u32::MAX, 2, 0), [1]);
    assert_eq!(meets(1, u32::MAX, 0), [0, 1, 4]);
    assert_eq!(meets(4, 1, 0), [0, 2]);
    assert_eq!(meets(u32::MAX, u32::MAX, -3), [0, 1, 2]);
    assert_eq!(meets(0, u32::MAX, 0), [] as [usize; 0]);
}

#[test]
fn query_filter_selects_kinds_sensors_and_exceptions() {
    let sensor = ShapeDef { sensing: Sensing::Sensor, ..ball() };
    let defs = vec![
        (BodyKind::Static, ball()),
        (BodyKind::Kinematic, ball()),
        (BodyKind::Dynamic, ball()),
        (BodyKind::Static, sensor),
    ];
    let (world, ids, ray) = row(defs);
    let of = |kinds| met(&world, &ids, &ray, QueryFilter::of(kinds));
    assert_eq!(of(BodyKinds::ALL), [0, 1, 2]);
    assert_eq!(of(BodyKinds::STATIC), [0]);
    assert_eq!(of(BodyKinds::KINEMATIC | BodyKinds::DYNAMIC), [1, 2]);
    assert_eq!(of(BodyKind::Dynamic.into()), [2]);
    let sensors = QueryFilter { sensors: Sensors::Included, ..QueryFilter::default() };
    assert_eq!(met(&world, &ids, &ray, sensors), [0, 1, 2, 3]);
    assert_eq!(met(&world, &ids, &ray, QueryFilter::without(&[ids[0], ids[2]])), [1]);
}

#[test]
fn predicates_get_the_body_and_the_shape_index() {
    let mut world = World::new(WorldDef::default());
    let shapes = vec![
        ball(),
        ShapeDef { body_from_shape: sinew_math::Transform::from_translation(Vec3::X), ..ball() },
    ];
    let id = world.add_body(&BodyDef { kind: BodyKind::Static, shapes, ..BodyDef::default() });
    let ray = Ray { origin: Vec3::X * -1.0, direction: Vec3::X * 9.0 };
    let query = world.query();
    let of = |wanted: u32| query.accept(move |body, shape| body == id && shape == wanted).first(&ray);
    assert_eq!(of(0).map(|hit| hit.shape), Some(0));
    assert_eq!(of(1).map(|hit| hit.shape), Some(1));
    assert_eq!(of(2), None);
}
