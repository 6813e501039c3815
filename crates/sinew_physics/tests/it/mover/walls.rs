//! Movers at walls, in corners and wedges, on seams, and at speeds at which they move by more than a wall's thickness
//! in a step.

use super::{block, depth, level, settle, turned};
use sinew_math::trig::{cos, sin};
use sinew_math::{Rotation, Vec3};
use sinew_physics::*;

#[test]
fn a_mover_stops_at_its_skin_and_slides_along_a_wall() {
    let mut world = level();
    block(&mut world, Vec3::new(2.0, 0.0, -50.0), Vec3::new(2.2, 3.0, 50.0));
    let id = world.add_mover(&MoverDef::default());
    settle(&mut world, id);
    world.set_mover_walk(id, Vec3::new(3.0, 0.0, 0.0));
    for _ in 0..120 {
        world.step();
    }
    let at = world.mover(id).position();
    assert!((at.x - 1.695).abs() < 2e-3 && at.z.abs() < 1e-4, "{at}");
    world.set_mover_walk(id, Vec3::new(3.0, 0.0, 4.0));
    for _ in 0..20 {
        world.step();
    }
    let before = world.mover(id).position().z;
    for _ in 0..60 {
        world.step();
        assert!(depth(&world, id) == 0.0);
    }
    let gone = world.mover(id).position().z - before;
    assert!((gone - 240.0 * world.def().dt()).abs() < 0.01, "the mover slid {gone} m");
}

#[test]
fn a_mover_reaches_its_walk_speed() {
    let mut world = level();
    let id = world.add_mover(&MoverDef::default());
    settle(&mut world, id);
    world.set_mover_walk(id, Vec3::new(0.0, 0.0, 2.0));
    for _ in 0..60 {
        world.step();
    }
    let before = world.mover(id).position();
    for _ in 0..600 {
        world.step();
        assert!(world.mover(id).is_grounded());
    }
    let gone = world.mover(id).position() - before;
    let seconds = 600.0 * world.def().dt();
    assert!(
        (gone.z - 2.0 * seconds).abs() < 1e-3 && gone.x.abs() < 1e-4 && gone.y.abs() < 1e-3,
        "the mover walked by {gone}"
    );
}

/// Two walls meet at an angle of 90 to 5 degrees; a mover that presses into the corner does not move.
#[test]
fn wedges_hold_a_mover_still() {
    for degrees in [90.0_f32, 60.0, 40.0, 20.0, 10.0, 5.0] {
        for aside in [0.0, 0.3, -0.5] {
            let half = degrees.to_radians() * 0.5;
            let mut world = level();
            for side in [-1.0, 1.0] {
                // The inner face passes through the origin, along the wedge's side.
                let along = Vec3::new(-cos(half), 0.0, side * sin(half));
                let outward = Vec3::new(sin(half), 0.0, side * cos(half));
                let mut wall = BodyDef::fixed(Shape::Box { half_extents: Vec3::new(20.0, 2.0, 0.25) })
                    .at(along * 18.0 + outward * 0.25 + Vec3::Y * 2.0);
                wall.rotation = Rotation::from_arc(Vec3::X, along);
                world.add_body(&wall);
            }
            let start = Vec3::new(-12.0, 0.0, 0.0);
            let id = world.add_mover(&MoverDef::at(start));
            world.set_mover_walk(id, Vec3::new(5.0, 0.0, 5.0 * aside));
            for _ in 0..360 {
                world.step();
            }
            let mut last = world.mover(id).position();
            for _ in 0..120 {
                world.step();
                let now = world.mover(id).position();
                assert!(
                    (now - last).length() < 1e-4,
                    "{degrees}° {aside}: the mover jumps from {last} to {now}"
                );
                assert_eq!(depth(&world, id), 0.0, "{degrees}° {aside}");
                last = now;
            }
            // Position at which a capsule and its skin just fit.
            let deepest = -0.3 / sin(half);
            assert!(last.x < deepest + 1e-3, "{degrees}° {aside}: {last} is beyond the corner at {deepest}");
            assert!(
                last.x > deepest - 0.02 / sin(half),
                "{degrees}° {aside}: {last} is short of the corner at {deepest}"
            );
        }
    }
}

/// Abutting boxes below and beside the mover do not slow it down.
#[test]
fn a_mover_does_not_catch_between_abutting_boxes() {
    let mut world = World::new(WorldDef::default());
    for i in 0..40 {
        let x = i as f32 * 0.5;
        block(&mut world, Vec3::new(x, -0.5, -2.0), Vec3::new(x + 0.5, 0.0, 2.0));
        block(&mut world, Vec3::new(x, 0.0, 0.5), Vec3::new(x + 0.5, 3.0, 1.0));
    }
    let id = world.add_mover(&MoverDef::at(Vec3::new(1.0, 0.01, 0.1)));
    settle(&mut world, id);
    world.set_mover_walk(id, Vec3::new(3.0, 0.0, 2.0));
    for _ in 0..30 {
        world.step();
    }
    let start = world.mover(id).position();
    let mut last = start;
    for _ in 0..240 {
        world.step();
        let now = world.mover(id).position();
        assert!(
            (now.x - last.x - 3.0 * world.def().dt()).abs() < 2e-3,
            "the mover caught on an edge at {now}"
        );
        assert!((now.y - last.y).abs() < 1e-3 && world.mover(id).is_grounded(), "the mover hops at {now}");
        last = now;
    }
}

/// A floor and a wall of many triangles do not slow a mover down.
#[test]
fn a_mover_does_not_catch_on_mesh_seams() {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..=40_u32 {
        let x = i as f32 * 0.37;
        vertices.extend([Vec3::new(x, 0.0, -2.0), Vec3::new(x, 0.0, 0.5), Vec3::new(x, 3.0, 0.5)]);
        if i < 40 {
            let (a, b) = (3 * i, 3 * i + 3);
            triangles.extend([
                [a, a + 1, b],
                [a + 1, b + 1, b],
                [a + 1, a + 2, b + 1],
                [a + 2, b + 2, b + 1],
            ]);
        }
    }
    let mesh = Mesh::new(&vertices, &triangles).expect("the mesh is valid");
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::Mesh(mesh.into())));
    let id = world.add_mover(&MoverDef::at(Vec3::new(1.0, 0.01, 0.1)));
    settle(&mut world, id);
    world.set_mover_walk(id, Vec3::new(3.0, 0.0, 2.0));
    for _ in 0..30 {
        world.step();
    }
    let mut last = world.mover(id).position();
    for _ in 0..180 {
        world.step();
        let now = world.mover(id).position();
        assert!(
            (now.x - last.x - 3.0 * world.def().dt()).abs() < 2e-3,
            "the mover is stuck at {now}, from {last}"
        );
        assert!((now.y - last.y).abs() < 1e-3 && world.mover(id).is_grounded(), "the mover hops at {now}");
        last = now;
    }
}

/// At 50 m/s a step is 0.8 m long; the walls, boxes and one-sided triangles, are 1 cm thick.
#[test]
fn thin_walls_stop_a_mover_at_50_metres_a_second() {
    for turn in 0..16 {
        let angle = turn as f32 * 0.4;
        let way = Vec3::new(cos(angle), 0.0, sin(angle));
        for triangles in [false, true] {
            let mut world = level();
            let mut wall = if triangles {
                let corners = [
                    Vec3::new(0.0, -1.0, -9.0),
                    Vec3::new(0.0, 4.0, -9.0),
                    Vec3::new(0.0, 4.0, 9.0),
                    Vec3::new(0.0, -1.0, 9.0),
                ];
                let mesh = Mesh::new(&corners, &[[0, 2, 1], [0, 3, 2]]).expect("the mesh is valid");
                BodyDef::fixed(Shape::Mesh(mesh.into()))
            } else {
                BodyDef::fixed(Shape::Box { half_extents: Vec3::new(0.005, 4.0, 9.0) })
            };
            wall.position = way * 7.0;
            wall.rotation = Rotation::from_arc(Vec3::X, way);
            world.add_body(&wall);
            let id = world.add_mover(&MoverDef { ground_acceleration: 1e4, ..MoverDef::default() });
            world.set_mover_velocity(id, way * 50.0);
            world.set_mover_walk(id, way * 50.0);
            for _ in 0..60 {
                world.step();
                let far = world.mover(id).position().dot(way);
                assert!(far < 6.71, "distance {far} in direction {way}, triangles {triangles}");
                assert_eq!(depth(&world, id), 0.0);
            }
            assert!(world.mover(id).position().dot(way) > 6.65);
        }
    }
}

#[test]
fn mover_walks_on_slopes_up_to_its_limit_and_slides_on_steeper_ones() {
    for (degrees, walks) in [(10.0_f32, true), (30.0, true), (48.0, true), (52.0, false), (70.0, false)] {
        let angle = degrees.to_radians();
        let mut world = level();
        // The upper face starts at the origin.
        let up = Vec3::new(-sin(angle), cos(angle), 0.0);
        let along = Vec3::new(cos(angle), sin(angle), 0.0);
        turned(&mut world, Vec3::new(10.0, 0.5, 4.0), along * 9.0 - up * 0.5, angle);
        let id = world.add_mover(&MoverDef::at(Vec3::new(-2.0, 0.0, 0.0)));
        settle(&mut world, id);
        world.set_mover_walk(id, Vec3::X * 2.0);
        for _ in 0..180 {
            world.step();
            assert_eq!(depth(&world, id), 0.0, "{degrees}°");
        }
        let at = world.mover(id).position();
        let seconds = 180.0 * world.def().dt();
        if walks {
            assert!((at.x - (2.0 * seconds - 2.0)).abs() < 0.15, "{degrees}°: at {at} after {seconds} s");
            assert!(world.mover(id).is_grounded() && at.y > 2.0 * sin(angle), "{degrees}°: {at}");
            let ground = world.mover_ground(id).expect("the mover stands on the slope");
            assert!((ground.normal - up).length() < 1e-3, "{degrees}°: {}", ground.normal);
            // A mover that does not walk stays in place.
            world.set_mover_walk(id, Vec3::ZERO);
            for _ in 0..30 {
                world.step();
            }
            let stood = world.mover(id).position();
            for _ in 0..240 {
                world.step();
            }
            assert!((world.mover(id).position() - stood).length() < 1e-4, "{degrees}°");
        } else {
            assert!(at.y < 0.4 && at.x < 0.8, "{degrees}°: the mover climbed to {at}");
            // Dropped from above, the mover moves down to the floor.
            world.set_mover_walk(id, Vec3::ZERO);
            world.set_mover_position(id, along * 4.0 + up * 0.2);
            for _ in 0..240 {
                world.step();
            }
            assert!(world.mover(id).position().y < 0.02, "{degrees}°: {}", world.mover(id).position());
        }
    }
}

/// Two walls are closer to each other than the mover and its skin are wide, and lean slightly apart, so that the skin
/// fits only high above the floor.
#[test]
fn an_upward_cleft_does_not_eject_a_mover() {
    for lean in [0.0006_f32, 0.001, 0.002, 0.005] {
        for walk in [Vec3::ZERO, Vec3::Z, Vec3::new(0.5, 0.0, 0.5)] {
            let mut world = level();
            let MoverDef { radius, skin, height, .. } = MoverDef::default();
            for side in [-1.0, 1.0] {
                let turn = Rotation::from_axis_angle(Vec3::Z, -side * lean);
                let face = Vec3::new(side * (radius + 0.5 * skin), 0.5 * height, 0.0);
                let half_extents = Vec3::new(0.25, 10.0, 5.0);
                let at = face + turn * Vec3::new(side * half_extents.x, 0.0, 0.0);
                world.add_body(&BodyDef::fixed(Shape::Box { half_extents }).at(at).turned(turn));
            }
            let id = world.add_mover(&MoverDef::at(Vec3::Y * skin));
            world.set_mover_walk(id, walk);
            for step in 0..120 {
                world.step();
                let at = world.mover(id).position();
                assert!(at.y < 0.1, "lean {lean}, walk {walk}, step {step}: at {at}");
            }
        }
    }
}
