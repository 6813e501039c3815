//! Wind on sheets of particles, by their faces.

use super::closed_forms::{close, run, weightless};
use sinew_math::{Reader, Rotation, Vec3, Writer};
use sinew_physics::particles::{ClothDef, GroupDef};
use sinew_physics::*;

/// Returns a square metre of cloth of 0.2 kg in the plane of x and z, tilted about z; each particle has a third of the
/// mass of its faces.
fn sheet(angle: f32) -> GroupDef {
    let turn = Rotation::from_axis_angle(Vec3::Z, angle);
    let def = ClothDef {
        corner: turn * Vec3::new(-0.5, 0.0, -0.5),
        across: turn * Vec3::X,
        down: turn * Vec3::Z,
        columns: 5,
        rows: 4,
        mass: 0.2,
        stretching: 2000.0,
        shearing: 500.0,
        bending: 1.0,
        damping_ratio: 0.2,
        radius: 0.01,
    };
    let mut group = GroupDef { sleeping: Sleeping::Off, ..def.build().group };
    let share = 0.2 / (3 * group.faces.len()) as f32;
    group.particles.iter_mut().for_each(|particle| particle.mass = 0.0);
    for &corner in group.faces.iter().flatten() {
        group.particles[corner as usize].mass += share;
    }
    group
}

fn wind(velocity: Vec3) -> Wind {
    Wind { velocity, density: 1.2, drag: 1.3, ..Wind::default() }
}

/// Returns the force of a field on a group in its current pose, N: the sum over its particles.
fn total_force(world: &World, field: FieldId, group: GroupId) -> Vec3 {
    let count = world.particles(group).positions().len() as u32;
    (0..count).map(|i| world.field_force_on_particle(field, group, i)).sum()
}

/// Returns the force of a wind on a square metre of cloth at rest, N.
fn blown(angle: f32, wind: Wind) -> Vec3 {
    let mut world = weightless();
    let group = world.add_particles(&sheet(angle));
    let field = world.add_field(&FieldDef::new(FieldKind::Wind(wind)));
    total_force(&world, field, group)
}

#[test]
fn sheet_force_follows_normal_speed_squared() {
    for degrees in [0.0f32, 25.0, 60.0, 85.0, 120.0, 180.0] {
        let angle = degrees.to_radians();
        let (sin, cos) = sinew_math::trig::sin_cos(angle);
        // From above and from below: both sides get the pressure.
        for down in [1.0, -1.0] {
            let force = blown(angle, wind(Vec3::NEG_Y * (8.0 * down)));
            close(force.length(), 0.5 * 1.2 * 1.3 * 64.0 * cos * cos, 1e-4, "pressure");
            let normal = Vec3::new(-sin, cos, 0.0) * (if cos < 0.0 { -down } else { down });
            assert!(
                (force.normalize() + normal).length() < 1e-4,
                "{degrees}°: force {force}, expected along {normal}"
            );
        }
    }
    assert!(
        blown(90f32.to_radians(), wind(Vec3::Y * 8.0)).length() < 1e-6,
        "wind along the sheet must exert no force"
    );
}

/// Lift of a plate: `½ ρ C_l |w|² A cos θ sin θ`, across the stream.
#[test]
fn a_tilted_sheet_gets_lift() {
    let angle = 30f32.to_radians();
    let lifts = |lift| Wind { drag: 0.0, lift, ..wind(Vec3::NEG_Y * 8.0) };
    let force = blown(angle, lifts(0.7));
    let (sin, cos) = sinew_math::trig::sin_cos(angle);
    close(force.x, 0.5 * 1.2 * 0.7 * 64.0 * cos * sin, 1e-4, "lift");
    assert!(
        force.y.abs() < 1e-4 && force.z.abs() < 1e-4,
        "the force must be along the expected axis: {force}"
    );
}

#[test]
fn a_flat_sheet_reaches_terminal_velocity() {
    let mut world =
        World::new(WorldDef { gravity: Vec3::Y * -9.81, sleeping: Sleeping::Off, ..WorldDef::default() });
    let group = world.add_particles(&sheet(0.0));
    let still = world.add_field(&FieldDef::new(FieldKind::Wind(wind(Vec3::ZERO))));
    run(&mut world, 240);
    let velocities = world.particles(group).velocities();
    let mean = velocities.iter().copied().sum::<Vec3>() / velocities.len() as f32;
    close(-mean.y, (2.0f32 * 0.2 * 9.81 / (1.2 * 1.3)).sqrt(), 2e-3, "terminal speed of the sheet");
    close(total_force(&world, still, group).y, 0.2 * 9.81, 5e-3, "wind force must equal the sheet's weight");
}

/// Silk of one gram never moves faster than the storm. An explicitly integrated force would give it a hundred times the
/// storm's speed.
#[test]
fn light_sheets_never_exceed_the_wind() {
    let mut world = weightless();
    let mut silk = sheet(0.0);
    silk.particles.iter_mut().for_each(|particle| particle.mass *= 1e-3 / 0.2);
    silk.springs.clear();
    silk.bends.clear();
    let group = world.add_particles(&silk);
    world.add_field(&FieldDef::new(FieldKind::Wind(wind(Vec3::Y * 60.0))));
    for _ in 0..60 {
        world.step();
        let bad = world.particles(group).velocities().iter().find(|v| !(v.y > 0.0 && v.y < 60.001));
        assert_eq!(bad, None, "step {}", world.step_count());
    }
    assert!(
        world.particles(group).velocities().iter().all(|v| v.y > 50.0),
        "the sheet must move with the wind"
    );
}

#[test]
fn wind_on_particles_without_faces_acts_as_on_balls() {
    let mut world = weightless();
    let grains = GroupDef { faces: Vec::new(), ..sheet(0.0) };
    let count = grains.particles.len() as f32;
    let group = world.add_particles(&grains);
    let field = world.add_field(&FieldDef::new(FieldKind::Wind(wind(Vec3::Y * 8.0))));
    let shadow = core::f32::consts::PI * 1e-4 * count;
    close(total_force(&world, field, group).y, 0.5 * 1.2 * 1.3 * 64.0 * shadow, 1e-4, "balls");
}

#[test]
fn invalid_or_duplicate_faces_are_rejected() {
    let with = |faces: Vec<[u32; 3]>| GroupDef { faces, ..sheet(0.0) }.check();
    assert!(with(vec![[0, 1, 2], [2, 1, 3]]).is_ok());
    for bad in [vec![[0, 1, 1]], vec![[0, 1, 30]], vec![[0, 1, 2], [3, 4, 5], [2, 0, 1]]] {
        let error = with(bad.clone()).expect_err("refused");
        assert!(error.what().starts_with("a face must"), "{bad:?}: {}", error.what());
    }
}

#[test]
fn a_restored_sheet_continues_equally() {
    let mut world = World::new(WorldDef::default());
    world.add_particles(&sheet(0.4));
    let gusts = Some(Gusts { speed: 3.0, length: 0.5, time: 0.3, seed: 9 });
    world.add_field(&FieldDef::new(FieldKind::Wind(Wind { gusts, ..wind(Vec3::X * 5.0) })));
    run(&mut world, 30);
    let mut w = Writer::new();
    world.save(&mut w);
    let mut copy = World::new(WorldDef::default());
    copy.load(&mut Reader::new(w.as_bytes())).expect("the snapshot must load");
    for _ in 0..30 {
        world.step();
        copy.step();
    }
    assert_eq!(copy.hash(), world.hash());
    let group = copy.group_ids().next().expect("the world has the sheet");
    assert_eq!(copy.particles(group).faces(), sheet(0.4).faces);
}
