//! Materials, contact rules and hits, compared with closed forms, and their changes while the world runs.

use crate::build::{box_body, floor, sphere_body};
use sinew_math::{Reader, Rotation, Transform, Vec3, Writer, trig};
use sinew_physics::particles::{GroupDef, ParticleDef};
use sinew_physics::*;

const G: f32 = 9.81;

fn run(world: &mut World, steps: usize) {
    for _ in 0..steps {
        world.step();
    }
}

fn made_of(mut def: BodyDef, material: Material) -> BodyDef {
    def.shapes.iter_mut().for_each(|shape| shape.material = material);
    def
}

fn under_rule(mut def: BodyDef, rule: ContactRule) -> BodyDef {
    def.shapes.iter_mut().for_each(|shape| shape.rule = rule);
    def
}

fn fixed(def: BodyDef) -> BodyDef {
    BodyDef { kind: BodyKind::Static, ..def }
}

fn only_shape(world: &World, body: BodyId) -> ShapeId {
    world.shape_ids(body).next().expect("the body has a shape")
}

fn assert_near(found: f32, expected: f32, share: f32, what: &str) {
    assert!((found / expected - 1.0).abs() < share, "{what}: {found}, expected {expected}");
}

fn reload(world: &World, into: &mut World) {
    let mut w = Writer::new();
    world.save(&mut w);
    into.load(&mut Reader::new(w.as_bytes())).expect("the snapshot must load");
}

/// Returns a block at rest on a slope, both of one material, and the direction down the slope.
fn on_slope(angle: f32, material: Material) -> (World, BodyId, Vec3) {
    let mut world = World::new(WorldDef { sleeping: Sleeping::Off, ..WorldDef::default() });
    let turn = Rotation::from_axis_angle(Vec3::Z, angle);
    let mut slope = fixed(sphere_body(1.0, Vec3::ZERO));
    slope.shapes = vec![ShapeDef { material, ..ShapeDef::new(Shape::HalfSpace) }];
    slope.rotation = turn;
    world.add_body(&slope);
    let mut block = made_of(box_body(Vec3::new(0.3, 0.1, 0.3), turn * (Vec3::Y * 0.1)), material);
    block.rotation = turn;
    let block = world.add_body(&block);
    (world, block, turn * -Vec3::X)
}

#[test]
fn block_sticks_up_to_the_static_angle_and_slides_with_sliding_friction() {
    let material = Material { friction: 0.3, static_friction: Some(0.6), ..Material::DEFAULT };
    let angle = trig::atan2(0.6, 1.0);
    let half_degree = 0.5f32.to_radians();
    let (mut world, block, down) = on_slope(angle - half_degree, material);
    run(&mut world, 60);
    let start = world.transform(block).translation;
    run(&mut world, 600);
    let crept = (world.transform(block).translation - start).length();
    assert!(crept < 1e-3, "the body crept {crept} m in 10 s");
    // A push makes the block slide, and it stops again: the slope is below the friction angle.
    world.apply_impulse_at_center(block, down * world.mass(block).mass);
    run(&mut world, 60);
    assert!(world.velocity(block).linear.dot(down) > 1.5, "{:?}", world.velocity(block));

    let (mut world, block, down) = on_slope(angle + half_degree, material);
    run(&mut world, 60);
    let before = world.velocity(block).linear.dot(down);
    run(&mut world, 60);
    let (sin, cos) = trig::sin_cos(angle + half_degree);
    let gained = world.velocity(block).linear.dot(down) - before;
    assert_near(gained, G * (sin - 0.3 * cos) * 60.0 * world.def().dt(), 0.005, "gain of speed in a second");
}

#[test]
fn sliding_box_brakes_by_sliding_friction_and_then_sticks() {
    let material = Material { friction: 0.2, static_friction: Some(0.8), ..Material::DEFAULT };
    let (mut world, block, _) = on_slope(0.0, material);
    run(&mut world, 30);
    let start = world.transform(block).translation.x;
    world.set_velocity(block, Velocity { linear: Vec3::X * 3.0, ..Velocity::default() });
    run(&mut world, 120);
    let h = world.def().dt() / 4.0;
    let expected = 0.5 * 3.0 * (3.0 / (0.2 * G) - h);
    assert_near(world.transform(block).translation.x - start, expected, 0.01, "distance until the box stops");
    assert!(world.velocity(block).linear.length() < 1e-3);
}

#[test]
fn belt_accelerates_a_box_to_its_own_speed() {
    let (speed, friction) = (2.0, 0.4);
    let belt = Material { friction, surface_velocity: Vec3::X * speed, ..Material::DEFAULT };
    for kind in [BodyKind::Static, BodyKind::Kinematic] {
        let mut world = World::new(WorldDef::default());
        // The belt is rotated: its velocity is in the shape's frame.
        let turn = Rotation::from_axis_angle(Vec3::Y, 0.7);
        let mut def = made_of(box_body(Vec3::new(20.0, 0.5, 20.0), Vec3::Y * -0.5), belt);
        (def.kind, def.rotation) = (kind, turn);
        world.add_body(&def);
        let material = Material { friction, ..Material::DEFAULT };
        let load = world.add_body(&made_of(box_body(Vec3::splat(0.2), Vec3::Y * 0.2), material));
        let along = turn * Vec3::X;
        let half = (0.5 * speed / (friction * G) / world.def().dt()) as usize;
        run(&mut world, half);
        let expected = friction * G * half as f32 * world.def().dt();
        assert_near(
            world.velocity(load).linear.dot(along),
            expected,
            0.02,
            "speed while the belt accelerates the box",
        );
        run(&mut world, 2 * half);
        let v = world.velocity(load).linear;
        assert!(
            (v - along * speed).length() < 0.01,
            "velocity on the belt {v:?}, expected {speed} m/s along it"
        );
        assert!(world.is_awake(load), "a conveyed body must not sleep");
    }
}

#[test]
fn belt_that_starts_or_stops_acts_immediately() {
    let mut world = World::new(WorldDef::default());
    let belt = world.add_body(&fixed(box_body(Vec3::new(20.0, 0.5, 20.0), Vec3::Y * -0.5)));
    let load = world.add_body(&box_body(Vec3::splat(0.2), Vec3::Y * 0.2));
    run(&mut world, 120);
    assert!(!world.is_awake(load));
    let shape = only_shape(&world, belt);
    let moving = Material { surface_velocity: Vec3::Z, ..Material::DEFAULT };
    world.set_material(shape, moving);
    assert_eq!(world.material(shape), moving);
    run(&mut world, 60);
    assert_near(world.velocity(load).linear.z, 1.0, 0.01, "speed of what the surface carries");
    world.set_material(shape, Material::DEFAULT);
    run(&mut world, 120);
    assert!(!world.is_awake(load), "the box must sleep again on the stopped belt");
}

#[test]
fn a_turntable_turns_a_body_on_its_axis() {
    let mut world = World::new(WorldDef::default());
    let table = Material { surface_spin: Vec3::Y * 2.0, ..Material::DEFAULT };
    world.add_body(&fixed(made_of(box_body(Vec3::new(5.0, 0.5, 5.0), Vec3::Y * -0.5), table)));
    let load = world.add_body(&box_body(Vec3::new(0.3, 0.1, 0.3), Vec3::Y * 0.1));
    run(&mut world, 90);
    assert_near(world.velocity(load).angular.y, 2.0, 0.01, "spin");
    assert!(world.velocity(load).linear.length() < 0.02);
}

#[test]
fn belts_carry_particles_and_ghosts_let_them_pass() {
    let mut world = World::new(WorldDef::default());
    let belt = Material { friction: 0.5, surface_velocity: Vec3::X * 1.5, ..Material::DEFAULT };
    world.add_body(&fixed(made_of(box_body(Vec3::new(20.0, 0.5, 20.0), Vec3::Y * -0.5), belt)));
    let over = |y| fixed(box_body(Vec3::new(1.0, 0.1, 1.0), Vec3::Y * y));
    world.add_body(&under_rule(over(0.5), ContactRule::Ghost));
    let mut sensor = over(1.0);
    sensor.shapes[0].sensing = Sensing::Sensor;
    world.add_body(&sensor);
    let particle = ParticleDef { position: Vec3::Y * 1.5, velocity: Vec3::ZERO, mass: 0.1, radius: 0.02 };
    let group = GroupDef {
        particles: vec![particle],
        material: Material { friction: 0.5, ..Material::DEFAULT },
        ..GroupDef::default()
    };
    let group = world.add_particles(&group);
    run(&mut world, 150);
    let particles = world.particles(group);
    assert!((particles.positions()[0].y - 0.02).abs() < 1e-3, "{:?}", particles.positions()[0]);
    assert_near(particles.velocities()[0].x, 1.5, 0.01, "speed of what the surface carries");
}

#[test]
fn rolling_resistance_brakes_a_ball() {
    let (radius, rolling) = (0.25, 0.01);
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    let material = Material { rolling, ..Material::DEFAULT };
    let mut ball = made_of(sphere_body(radius, Vec3::Y * radius), material);
    (ball.linear_velocity, ball.angular_velocity) = (Vec3::X * 3.0, -Vec3::Z * (3.0 / radius));
    let ball = world.add_body(&ball);
    run(&mut world, 30);
    let before = world.velocity(ball).linear.x;
    run(&mut world, 60);
    // A ball that rolls without slipping has the inertia of 7/5 of its mass; the torque ρ m g resists at its radius.
    let expected = rolling * G / (1.4 * radius);
    let lost = (before - world.velocity(ball).linear.x) / (60.0 * world.def().dt());
    assert_near(lost, expected, 0.01, "m/s² against rolling");
}

/// Adds a platform 10 cm thick with its top at the height `top`.
fn platform(world: &mut World, top: f32) -> BodyId {
    let slab = fixed(box_body(Vec3::new(2.0, 0.05, 2.0), Vec3::Y * (top - 0.05)));
    world.add_body(&under_rule(slab, ContactRule::OneWay(OneWay::default())))
}

#[test]
fn one_way_platform_lets_bodies_rise_through_it_and_carries_them() {
    for (speed, radius) in [(6.0, 0.2), (8.0, 0.02), (30.0, 0.1)] {
        let mut world = World::new(WorldDef::default());
        floor(&mut world);
        platform(&mut world, 1.0);
        let mut ball = sphere_body(radius, Vec3::Y * radius);
        ball.linear_velocity = Vec3::Y * speed;
        let ball = world.add_body(&ball);
        let mut highest = 0.0;
        for _ in 0..480 {
            world.step();
            highest = sinew_math::max(highest, world.transform(ball).translation.y);
        }
        assert_near(highest, radius + speed * speed / (2.0 * G), 0.02, "apex of the ball above the platform");
        let y = world.transform(ball).translation.y;
        assert!((y - 1.0 - radius).abs() < 3e-3, "the body must lie on top; its height is {y} m");
        assert!(!world.is_awake(ball));
    }
}

#[test]
fn body_inside_a_one_way_platform_keeps_passing_after_a_restore() {
    // The apex is inside the platform: the ball must fall out again, not be placed on top.
    let start = || {
        let mut world = World::new(WorldDef::default());
        floor(&mut world);
        platform(&mut world, 1.0);
        let mut ball = sphere_body(0.1, Vec3::Y * 0.1);
        ball.linear_velocity = Vec3::Y * launch_speed(0.85);
        let ball = world.add_body(&ball);
        (world, ball)
    };
    let (mut world, ball) = start();
    let (mut other, _) = start();
    for step in 0..180 {
        world.step();
        other.step();
        assert_eq!(world.events(), other.events(), "step {step}");
        assert_eq!(world.hash(), other.hash(), "step {step}");
        let mut fresh = World::new(WorldDef::default());
        reload(&other, &mut fresh);
        other = fresh;
    }
    assert!((world.transform(ball).translation.y - 0.1).abs() < 3e-3);
}

/// Returns the initial speed with which a body rises to a height, m/s.
fn launch_speed(height: f32) -> f32 {
    (2.0 * G * height).sqrt()
}

#[test]
fn ghost_contact_is_reported_without_a_push() {
    let mut world = World::new(WorldDef::default());
    let ghost = fixed(box_body(Vec3::splat(0.5), Vec3::ZERO));
    let ghost = world.add_body(&under_rule(ghost, ContactRule::Ghost));
    let ball = world.add_body(&sphere_body(0.1, Vec3::Y * 1.0));
    let (mut begun, mut ended) = (0, 0);
    for _ in 0..60 {
        world.step();
        begun += world.events().begin.iter().filter(|pair| **pair == (ghost, ball)).count();
        ended += world.events().end.len();
        assert!(world.events().hits.is_empty());
        assert!(world.contacts_of(ball).all(|contact| contact.effect == Effect::Pass));
    }
    assert_eq!((begun, ended), (1, 1));
    let (t, h) = (60.0 * world.def().dt(), world.def().dt() / 4.0);
    assert_near(
        1.0 - world.transform(ball).translation.y,
        0.5 * G * t * (t + h),
        1e-3,
        "distance of free fall",
    );
}

/// Modifier that lets bodies with user data 7 pass, and throws those with 8 up at 5 m/s.
fn bouncer(found: &FoundContact<'_>, mut material: ContactMaterial) -> Option<ContactMaterial> {
    assert!(!found.points.is_empty());
    let number = found.sides[0].user_data + found.sides[1].user_data;
    material.launch = if number == 8 { 5.0 } else { 0.0 };
    (number != 7).then_some(material)
}

fn with_bouncer() -> (World, [BodyId; 3]) {
    let mut world = World::new(WorldDef::default());
    world.register_modifier(3, bouncer);
    let slab = fixed(box_body(Vec3::new(5.0, 0.5, 5.0), Vec3::Y * -0.5));
    world.add_body(&under_rule(slab, ContactRule::Modified { modifier: 3 }));
    let balls = [7, 8, 9].map(|user_data| {
        let x = user_data as f32 - 8.0;
        world.add_body(&BodyDef { user_data, ..sphere_body(0.1, Vec3::new(x, 0.11, 0.0)) })
    });
    (world, balls)
}

#[test]
fn modifier_drops_contacts_and_throws_bodies() {
    let (mut world, [dropped, thrown, held]) = with_bouncer();
    let mut highest = 0.0;
    for _ in 0..40 {
        world.step();
        highest = sinew_math::max(highest, world.transform(thrown).translation.y);
    }
    assert!(world.transform(dropped).translation.y < -1.0);
    assert_near(highest - 0.1, 25.0 / (2.0 * G), 0.03, "rise of the thrown body");
    assert!((world.transform(held).translation.y - 0.1).abs() < 2e-3);
    let mut w = Writer::new();
    world.save(&mut w);
    let mut other = World::new(WorldDef::default());
    let before = other.hash();
    let error = other.load(&mut Reader::new(w.as_bytes())).expect_err("the modifier is not registered");
    assert!(format!("{error:?}").contains("modifier"), "{error:?}");
    assert_eq!(other.hash(), before);
    other.register_modifier(3, bouncer);
    other.load(&mut Reader::new(w.as_bytes())).expect("the snapshot must load");
    run(&mut world, 60);
    run(&mut other, 60);
    assert_eq!(world.hash(), other.hash());
}

/// Pair function: bodies whose user data have an odd sum do not collide.
fn even(a: &PairSide, b: &PairSide) -> bool {
    (a.user_data + b.user_data).is_multiple_of(2)
}

#[test]
fn pair_function_disables_pairs_and_is_part_of_snapshots() {
    let mut world = World::new(WorldDef::default());
    world.register_pair_function(1, even);
    let ground = world.add_body(&fixed(box_body(Vec3::new(5.0, 0.5, 5.0), Vec3::Y * -0.5)));
    let [even_one, odd] = [2, 3].map(|user_data| {
        let at = Vec3::new(user_data as f32, 0.1, 0.0);
        world.add_body(&BodyDef { user_data, ..sphere_body(0.1, at) })
    });
    run(&mut world, 120);
    assert!(!world.is_awake(odd));
    world.set_pair_function(Some(1));
    world.step();
    assert_eq!(world.events().end, [(ground, odd)]);
    run(&mut world, 30);
    assert!(world.transform(odd).translation.y < -0.5);
    assert!((world.transform(even_one).translation.y - 0.1).abs() < 2e-3);
    let mut w = Writer::new();
    world.save(&mut w);
    let mut other = World::new(WorldDef::default());
    assert!(other.load(&mut Reader::new(w.as_bytes())).is_err());
    other.register_pair_function(1, even);
    other.load(&mut Reader::new(w.as_bytes())).expect("the snapshot must load");
    assert_eq!(other.pair_function(), Some(1));
}

#[test]
fn disabling_and_enabling_a_pair_wakes_it() {
    let mut world = World::new(WorldDef::default());
    let ground = floor(&mut world);
    let below = world.add_body(&box_body(Vec3::splat(0.5), Vec3::Y * 0.5));
    let above = world.add_body(&box_body(Vec3::splat(0.4), Vec3::Y * 1.4));
    run(&mut world, 120);
    assert!(!world.is_awake(above));
    world.disable_pair(below, above);
    world.step();
    assert_eq!(world.events().end, [(below, above)]);
    run(&mut world, 60);
    assert!(
        (world.transform(above).translation.y - 0.4).abs() < 3e-3,
        "the upper body must fall to the floor"
    );
    assert!(world.contacts_of(above).all(|contact| contact.a.body == ground));
    world.enable_pair(above, below);
    world.step();
    assert_eq!(world.events().begin, [(below, above)]);
}

#[test]
fn filter_rule_and_sensing_changes_act_at_once_and_wake() {
    let mut world = World::new(WorldDef::default());
    let slab = world.add_body(&fixed(box_body(Vec3::new(5.0, 0.5, 5.0), Vec3::Y * -0.5)));
    let ball = world.add_body(&sphere_body(0.1, Vec3::Y * 0.1));
    run(&mut world, 120);
    let (shape, pair) = (only_shape(&world, ball), (slab, ball));
    let ids = (only_shape(&world, slab), shape);
    world.set_sensing(shape, Sensing::Sensor);
    world.step();
    assert_eq!((&world.events().end[..], &world.events().sensor_begin[..]), (&[pair][..], &[pair][..]));
    assert_eq!(world.events().sensor_shapes_begin, [ids]);
    world.set_sensing(shape, Sensing::Solid);
    world.step();
    assert_eq!((&world.events().begin[..], &world.events().sensor_end[..]), (&[pair][..], &[pair][..]));
    world.set_filter(shape, Filter { mask: 0, ..Filter::default() });
    world.step();
    assert_eq!((&world.events().end[..], &world.events().shapes_end[..]), (&[pair][..], &[ids][..]));
    assert!(world.velocity(ball).linear.y < -0.1, "the ball must fall");
    world.set_filter(shape, Filter::default());
    world.set_contact_rule(shape, ContactRule::Ghost);
    run(&mut world, 5);
    assert!(world.contacts_of(ball).all(|contact| contact.effect == Effect::Pass));
}

#[test]
fn a_hit_reports_speed_and_impulse_once() {
    for (restitution, tolerance) in [(0.0, 0.01), (0.5, 0.02)] {
        for i in 0..40 {
            let height = 0.3 + 0.07 * i as f32;
            let mut world = World::new(WorldDef { sleeping: Sleeping::Off, ..WorldDef::default() });
            let ground = floor(&mut world);
            let material = Material { restitution, tag: 7, ..Material::DEFAULT };
            let ball = world.add_body(&made_of(sphere_body(0.1, Vec3::Y * (0.1 + height)), material));
            let mut hits = Vec::new();
            let steps = (launch_speed(height) / G / world.def().dt()) as usize + 4;
            for _ in 0..steps {
                world.step();
                hits.extend_from_slice(&world.events().hits);
            }
            let [hit] = hits[..] else { panic!("a ball from {height} m must report one hit: {hits:?}") };
            let (mass, speed) = (world.mass(ball).mass, launch_speed(height));
            assert_eq!((hit.a.body, hit.b.body, hit.normal), (ground, ball, Vec3::Y));
            assert_eq!(hit.materials[1].tag, 7);
            // The approach speed is that at the start of the step, so up to one step of falling is missing.
            assert!(hit.approach < speed * 1.001 && hit.approach > speed - 1.1 * G / 60.0, "{hit:?} {speed}");
            // In the rest of the step the contact also carries the ball's weight.
            let weight = mass * G * 2.0 / 60.0;
            let expected = mass * speed * (1.0 + restitution);
            let slack = tolerance * expected + weight;
            assert!(
                (hit.impulse - expected).abs() < slack,
                "dropped from {height} m: {hit:?}, expected impulse {expected}"
            );
            assert!(hit.point.length() < 1e-3 && hit.greatest == hit.impulse, "{hit:?}");
        }
    }
}

#[test]
fn a_pile_at_rest_reports_no_hit() {
    let mut world = World::new(WorldDef { sleeping: Sleeping::Off, ..WorldDef::default() });
    floor(&mut world);
    for i in 0..5 {
        world.add_body(&box_body(Vec3::splat(0.2), Vec3::Y * (0.2 + 0.4 * i as f32)));
    }
    for _ in 0..300 {
        world.step();
        assert!(
            world.events().hits.is_empty(),
            "a pile at rest must report no hit: {:?}",
            world.events().hits
        );
    }
}

#[test]
fn contacts_report_their_load() {
    let angle = 0.3;
    let (mut world, block, down) = on_slope(angle, Material::DEFAULT);
    run(&mut world, 120);
    let weight = world.mass(block).mass * G * world.def().dt();
    let contacts: Vec<BodyContact> = world.contacts_of(block).collect();
    let [contact] = contacts[..] else { panic!("the block must have one contact: {contacts:?}") };
    assert_eq!((contact.effect, contact.points().len()), (Effect::Push, 4));
    assert_near(contact.impulse(), weight * trig::cos(angle), 0.01, "N·s along the normal");
    assert_near(contact.friction.dot(-down), weight * trig::sin(angle), 0.01, "N·s of friction");
    assert_eq!(contact.material.friction, 0.6);
    assert_eq!(world.contacts().count(), 1);
}

#[test]
fn sensors_report_static_moving_sleeping_and_removed_bodies() {
    let mut world = World::new(WorldDef::default());
    let ground = floor(&mut world);
    let mut gate = fixed(box_body(Vec3::splat(0.5), Vec3::Y * 0.5));
    gate.shapes[0].sensing = Sensing::Sensor;
    let gate = world.add_body(&gate);
    let sleeper = world.add_body(&box_body(Vec3::splat(0.2), Vec3::new(0.2, 0.2, 0.0)));
    let mut door = box_body(Vec3::splat(0.1), Vec3::new(0.0, 2.0, 0.0));
    (door.kind, door.linear_velocity) = (BodyKind::Kinematic, Vec3::Y * -2.0);
    let door = world.add_body(&door);
    world.step();
    // Floor and gate are static, so the gate does not detect the floor.
    assert_eq!(world.events().sensor_begin, [(gate, sleeper)]);
    assert!(!world.events().sensor_begin.iter().any(|pair| pair.0 == ground));
    // A distance of 0.9 m at 2 m/s takes 27 steps.
    let seen = (1..40).find(|_| {
        world.step();
        world.events().sensor_begin == [(gate, door)]
    });
    assert!((26..30).contains(&seen.expect("the body must reach the gate")), "{seen:?}");
    run(&mut world, 10);
    world.set_velocity(door, Velocity::default());
    for _ in 0..90 {
        world.step();
        assert!(world.events().sensor_begin.is_empty() && world.events().sensor_end.is_empty());
    }
    assert!(!world.is_awake(sleeper), "falling asleep must not end contacts");
    world.set_transform(door, Transform::from_translation(Vec3::Y * 5.0));
    world.step();
    assert_eq!(world.events().sensor_end, [(gate, door)]);
    world.set_transform(door, Transform::from_translation(Vec3::Y * 0.5));
    world.step();
    assert_eq!(world.events().sensor_begin, [(gate, door)]);
    world.remove_body(sleeper);
    world.step();
    assert_eq!(world.events().sensor_end, [(gate, sleeper)]);
    assert_eq!(world.events().end, [(ground, sleeper)]);
}

#[test]
fn a_pair_of_many_shapes_is_reported_once() {
    let mut world = World::new(WorldDef::default());
    let ground = floor(&mut world);
    let mut table = box_body(Vec3::splat(0.1), Vec3::Y * 0.12);
    for x in [-0.5, 0.5] {
        let mut foot = table.shapes[0].clone();
        foot.body_from_shape = Transform::from_translation(Vec3::X * x);
        table.shapes.push(foot);
    }
    let table = world.add_body(&table);
    let (mut bodies, mut shapes) = (0, 0);
    for _ in 0..60 {
        world.step();
        bodies += world.events().begin.len();
        shapes += world.events().shapes_begin.len();
        assert!(world.events().begin.iter().all(|pair| *pair == (ground, table)));
    }
    assert_eq!((bodies, shapes), (1, 3));
}

#[test]
#[should_panic(expected = "friction")]
fn a_nan_material_is_refused() {
    let (mut world, block, _) = on_slope(0.0, Material::DEFAULT);
    let shape = only_shape(&world, block);
    world.set_material(shape, Material { friction: f32::NAN, ..Material::DEFAULT });
}

#[test]
#[should_panic(expected = "velocity of a surface")]
fn a_surface_velocity_that_is_not_finite_is_refused() {
    let (mut world, block, _) = on_slope(0.0, Material::DEFAULT);
    let shape = only_shape(&world, block);
    world.set_material(shape, Material { surface_velocity: Vec3::X * f32::INFINITY, ..Material::DEFAULT });
}

#[test]
#[should_panic(expected = "direction")]
fn a_one_way_rule_without_direction_is_refused() {
    let (mut world, block, _) = on_slope(0.0, Material::DEFAULT);
    let shape = only_shape(&world, block);
    let rule = OneWay { direction: Vec3::ZERO, ..OneWay::default() };
    world.set_contact_rule(shape, ContactRule::OneWay(rule));
}

#[test]
#[should_panic(expected = "registered")]
fn a_modifier_that_is_not_registered_is_refused() {
    let mut world = World::new(WorldDef::default());
    let body = sphere_body(0.1, Vec3::ZERO);
    world.add_body(&under_rule(body, ContactRule::Modified { modifier: 1 }));
}

#[test]
#[should_panic(expected = "registered")]
fn a_pair_function_that_is_not_registered_is_refused() {
    World::new(WorldDef::default()).set_pair_function(Some(2));
}

#[test]
#[should_panic(expected = "speed of a hit")]
fn a_nan_hit_speed_is_refused() {
    let _ = World::new(WorldDef { hit_speed: f32::NAN, ..WorldDef::default() });
}
