//! Random worlds with every kind of object.

use super::deeds;
use crate::solids::pebble;
use sinew_math::{Random, Transform, Vec3};
use sinew_physics::particles::{BlobDef, ClothDef, RopeDef, StrandDef};
use sinew_physics::*;
use std::sync::Arc;

/// Returns a random solid that extends at most `size` metres from its centre.
pub fn solid(random: &mut Random, size: f32) -> Shape {
    match random.index(8) {
        0..3 => Shape::cuboid(Vec3::new(1.0, random.range(0.3, 1.0), random.range(0.3, 1.0)) * (0.6 * size)),
        3 | 4 => Shape::sphere(size),
        5 => Shape::capsule(0.5 * size, 0.4 * size),
        6 => Shape::cylinder(0.5 * size, 0.6 * size),
        _ => pebble(size, random),
    }
}

pub fn shape(random: &mut Random) -> ShapeDef {
    let sensing = if random.unit() < 0.1 { Sensing::Sensor } else { Sensing::Solid };
    let (size, reach) = (random.range(0.1, 0.3), random.range(0.3, 1.5));
    let mut def = ShapeDef::new(solid(random, if sensing == Sensing::Sensor { reach } else { size }));
    def.sensing = sensing;
    def.material.friction = random.range(0.0, 1.0);
    def.material.restitution = if random.unit() < 0.2 { random.range(0.0, 0.9) } else { 0.0 };
    def.material.rolling = if random.unit() < 0.3 { random.range(0.0, 0.02) } else { 0.0 };
    if random.unit() < 0.1 {
        def.rule = rule(random);
    }
    def
}

pub fn rule(random: &mut Random) -> ContactRule {
    match random.index(4) {
        0 => ContactRule::Ghost,
        1 => ContactRule::OneWay(OneWay::default()),
        2 => ContactRule::Yields(Yields::default()),
        _ => ContactRule::Modified { modifier: 1 },
    }
}

pub fn body(random: &mut Random, at: Vec3) -> BodyDef {
    let kind = match random.index(12) {
        0 => BodyKind::Static,
        1 => BodyKind::Kinematic,
        _ => BodyKind::Dynamic,
    };
    let speed = if kind == BodyKind::Kinematic && random.unit() < 0.7 { 1.0 } else { 0.0 };
    let mut def = BodyDef {
        kind,
        position: at,
        rotation: if random.unit() < 0.5 { random.rotation() } else { sinew_math::Rotation::IDENTITY },
        linear_velocity: random.in_cube() * speed,
        angular_velocity: random.in_cube() * speed,
        shapes: vec![shape(random)],
        user_data: random.index(100) as u64,
        ..BodyDef::default()
    };
    if random.unit() < 0.15 {
        let beside = Transform::new(random.in_cube() * 0.2, random.rotation());
        def.shapes.push(ShapeDef { body_from_shape: beside, ..shape(random) });
    }
    if kind == BodyKind::Dynamic && def.shapes.iter().all(|shape| shape.sensing == Sensing::Sensor) {
        def.mass = Some(Shape::sphere(0.2).mass_properties(1000.0));
    }
    def
}

/// Adds a plane, abutting boxes, a mesh or a height field as ground.
fn ground(world: &mut World, random: &mut Random, width: f32) {
    let cells = (width.ceil() as i32).clamp(2, 12);
    match random.index(4) {
        0 => _ = world.add_body(&BodyDef::fixed(Shape::HalfSpace)),
        1 => {
            for (i, j) in (-cells..cells).flat_map(|i| (-cells..cells).map(move |j| (i, j))) {
                let at = Vec3::new(i as f32 + 0.5, -0.5, j as f32 + 0.5);
                world.add_body(&BodyDef::fixed(Shape::cuboid(Vec3::splat(0.5))).at(at));
            }
        }
        2 => {
            let side = 2 * cells as usize + 1;
            let heights = (0..side * side).map(|_| random.range(-0.1, 0.1)).collect();
            let def =
                HeightFieldDef { columns: side, rows: side, spacing: [1.0, 1.0], heights, holes: Vec::new() };
            let field = Arc::new(HeightField::new(def).expect("the height field is valid"));
            let corner = Vec3::new(-cells as f32, 0.0, -cells as f32);
            world.add_body(&BodyDef::fixed(Shape::HeightField(field)).at(corner));
        }
        _ => {
            let far = cells as f32;
            let corners = [(-far, -far), (far, -far), (far, far), (-far, far)];
            let points = corners.map(|(x, z)| Vec3::new(x, 0.0, z));
            let mesh = Shape::mesh(&points, &[[0, 2, 1], [0, 3, 2]]).expect("the mesh is valid");
            world.add_body(&BodyDef::fixed(mesh));
        }
    }
}

/// Returns a position in a pile of this width, metres.
pub fn place(random: &mut Random, width: f32, height: f32) -> Vec3 {
    Vec3::new(random.range(-width, width), random.range(0.3, height), random.range(-width, width))
}

/// Adds boxes in rows and layers, which soon fall asleep.
fn wall(world: &mut World, random: &mut Random, count: usize) {
    let (rows, corner) = (1 + random.index(4), random.in_cube() * Vec3::new(2.0, 0.0, 2.0));
    for i in 0..count {
        let (layer, along, across) = (i % 6, i / 6 % 6, i / 36 % rows);
        let at = corner + Vec3::new(along as f32 * 0.41, 0.2 + layer as f32 * 0.405, across as f32 * 0.41);
        world.add_body(&BodyDef::dynamic(Shape::cuboid(Vec3::splat(0.2))).at(at));
    }
}

/// Adds a chain of links that hangs from the ground body or is free.
fn chain(world: &mut World, random: &mut Random, ground: BodyId) {
    let start = place(random, 3.0, 4.0);
    let mut last = (random.unit() < 0.6).then_some(ground);
    let way = random.direction() * 0.3;
    let same = random.unit() < 0.5;
    for i in 0..2 + random.index(10) {
        let at = start + way * i as f32;
        let shape = ShapeDef::new(if same { Shape::sphere(0.1) } else { solid(random, 0.12) });
        let link = world.add_body(&BodyDef::dynamic(shape).at(at));
        if let Some(last) = last {
            let def = deeds::joint(world, random, last, link, at - way * 0.5);
            world.add_joint(&def);
        }
        last = Some(link);
    }
}

/// Adds a rope, a strand, cloth or a blob, partly held by a body or in the world.
fn particles(world: &mut World, random: &mut Random) {
    let at = Vec3::new(random.range(-2.0, 2.0), random.range(1.5, 3.0), random.range(-2.0, 2.0));
    let links = 4 + random.index(8) as u32;
    let rope =
        RopeDef { from: at, to: at + random.in_cube(), links, mass: 0.5, stiffness: 2e4, radius: 0.02 };
    let mut group = match random.index(4) {
        0 => {
            let mut rope = rope.build();
            rope.group.hold_in_world(&[rope.first]);
            rope.group
        }
        1 => StrandDef { rope, bending: 1e-2 }.build().group,
        2 => {
            let (columns, rows) = (3 + random.index(6) as u32, 3 + random.index(6) as u32);
            let mut cloth = ClothDef {
                corner: at,
                across: Vec3::X * 0.8,
                down: Vec3::Z * 0.8,
                columns,
                rows,
                mass: 0.4,
                stretching: 1000.0,
                shearing: 100.0,
                bending: 1e-5,
                damping_ratio: 0.2,
                radius: 0.02,
            }
            .build();
            if random.unit() < 0.5 {
                let [a, b, ..] = cloth.corners();
                cloth.hang(&[a, b]);
            }
            cloth.group
        }
        _ => {
            BlobDef {
                center: at,
                radius: 0.25,
                subdivisions: 1,
                mass: 1.0,
                stiffness: 400.0,
                damping_ratio: 0.2,
                bulk_modulus: 5e3,
                skin: 0.02,
            }
            .build()
            .group
        }
    };
    group.linear_damping = random.range(0.0, 1.0);
    world.add_particles(&group);
}

fn field(random: &mut Random) -> FieldDef {
    let kind = match random.index(3) {
        0 => FieldKind::Uniform(UniformGravity { acceleration: random.in_cube() }),
        1 => FieldKind::Buoyancy(Buoyancy::default()),
        _ => FieldKind::Wind(Wind { velocity: random.in_cube() * 3.0, ..Wind::default() }),
    };
    let region = Region::ball(place(random, 2.0, 2.0), 2.0, Fade::None);
    FieldDef { region, ..FieldDef::new(kind) }
}

/// Returns a world of 10 to `most` bodies.
pub fn world(random: &mut Random, most: usize) -> World {
    let mut def = WorldDef::default();
    if random.unit() < 0.1 {
        def.sleeping = Sleeping::Off;
    }
    if random.unit() < 0.2 {
        def.quality = [Quality::Fast, Quality::Exact][random.index(2)];
    }
    let mut world = World::new(def);
    deeds::register(&mut world);
    let count = if random.unit() < 0.5 { 10 + random.index(50) } else { 60 + random.index(most - 60) };
    let width = (count as f32).sqrt() * 0.3;
    ground(&mut world, random, width);
    let walled = if random.unit() < 0.6 { random.index(count) } else { 0 };
    wall(&mut world, random, walled);
    for _ in walled..count {
        let at = place(random, width, 1.5 + 0.02 * count as f32);
        world.add_body(&body(random, at));
    }
    let ground = world.body_ids().next().expect("the world has ground");
    for _ in 0..random.index(5) {
        chain(&mut world, random, ground);
    }
    if random.unit() < 0.4 {
        (0..1 + random.index(2)).for_each(|_| particles(&mut world, random));
    }
    if random.unit() < 0.4 {
        for _ in 0..1 + random.index(4) {
            let at = place(random, width + 1.0, 2.0);
            world.add_mover(&MoverDef { radius: 0.2, height: 1.0, ..MoverDef::at(at) });
        }
    }
    if random.unit() < 0.3 {
        world.add_field(&field(random));
    }
    let pusher =
        BodyDef::kinematic(Shape::cuboid(Vec3::new(0.3, 1.0, 2.0))).at(Vec3::new(-width - 5.0, 1.0, 0.0));
    world.add_body(&BodyDef { linear_velocity: Vec3::X * random.range(0.5, 8.0), ..pusher });
    world
}
