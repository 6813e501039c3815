//! Deeds that change forces, fields, particles, movers and objects.

use super::{Deed, parts};
use crate::actor::Actor;
use crate::functions::{NUMBER, Tug};
use crate::numbers::Numbers;
use sinew_math::{Transform, Vec3};
use sinew_physics::particles::{
    AttachmentTarget, BlobDef, ClothDef, GroupDef, RopeDef, SpringScheme, StrandDef,
};
use sinew_physics::*;

pub const ALL: &[Deed] = &[
    Deed::new("impulse", 3, impulse),
    Deed::new("force", 2, force),
    Deed::new("bullet", 1, bullet),
    Deed::new("explode", 1, explode),
    Deed::new("add_force", 1, add_force),
    Deed::new("set_force", 1, set_force),
    Deed::new("remove_force", 1, remove_force),
    Deed::new("add_field", 1, add_field),
    Deed::new("set_field", 1, set_field),
    Deed::new("remove_field", 1, remove_field),
    Deed::new("add_particles", 2, add_particles),
    Deed::new("remove_particles", 1, remove_particles),
    Deed::new("push_particle", 2, push_particle),
    Deed::new("add_mover", 1, add_mover),
    Deed::new("remove_mover", 1, remove_mover),
    Deed::new("lead_mover", 3, lead_mover),
    Deed::new("change_mover", 1, change_mover),
    Deed::new("add_object", 1, add_object),
    Deed::new("change_object", 1, change_object),
    Deed::new("remove_object", 1, remove_object),
];

fn impulse(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.any_body(n)?;
    let impulse = n.vector(20.0);
    match n.index(3) {
        0 => call!(a.apply_impulse_at_center(id, impulse)),
        1 => call!(a.apply_angular_impulse(id, impulse)),
        _ => {
            let point = a.world.center_of_mass(id) + Vec3::new(n.between(-0.2, 0.2), 0.1, 0.0);
            call!(a.apply_impulse(id, impulse, point));
        }
    }
    Some(())
}

fn force(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.any_body(n)?;
    let force = n.vector(200.0);
    match n.index(3) {
        0 => call!(a.apply_force_at_center(id, force)),
        1 => call!(a.apply_torque(id, force)),
        _ => {
            let point = a.world.center_of_mass(id) + Vec3::new(n.between(-0.2, 0.2), 0.1, 0.0);
            call!(a.apply_force(id, force, point));
        }
    }
    Some(())
}

fn bullet(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.any_body(n)?;
    let velocity = n.direction() * n.between(10.0, 900.0);
    let point = a.world.center_of_mass(id) + Vec3::new(n.between(-0.1, 0.1), 0.05, 0.0);
    ask!(a.apply_bullet_impact(id, 0.01, velocity, point));
    Some(())
}

fn explode(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let center = n.place();
    let mut explosion = Explosion::new(center, n.least(0.1, 3.0), n.least(0.0, 50.0));
    if n.chance(0.3) {
        explosion.occlusion = Occlusion::Static;
    }
    explosion.check().is_ok().then(|| call!(a.explode(&explosion)))
}

fn force_def(n: &mut Numbers) -> ForceDef {
    let frame = n.one_of(&[ForceFrame::World, ForceFrame::Body]);
    let point = n.chance(0.5).then(|| Vec3::new(n.between(0.0, 0.3), 0.0, 0.0));
    ForceDef { force: n.vector(50.0), torque: n.vector(2.0), point, frame }
}

fn add_force(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let body = a.any_body(n)?;
    let def = force_def(n);
    a.add_force(body, &def);
    Some(())
}

fn set_force(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.force(n)?;
    let def = force_def(n);
    call!(a.set_force(id, &def));
    ask!(a.force(id));
    Some(())
}

fn remove_force(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.force(n)?;
    call!(a.remove_force(id));
    Some(())
}

fn field_def(n: &mut Numbers) -> FieldDef {
    let kind = match n.index(7) {
        0 => FieldKind::Uniform(UniformGravity { acceleration: n.vector(3.0) }),
        1 => FieldKind::Point(PointGravity {
            center: n.place(),
            strength: n.signed(20.0),
            softening: n.between(0.1, 1.0),
        }),
        2 => FieldKind::Mutual(MutualGravity {
            constant: n.between(0.0, 1e-3),
            softening: n.between(0.1, 1.0),
        }),
        3 => FieldKind::Drag(Drag {
            linear: n.between(0.0, 2.0),
            quadratic: n.between(0.0, 1.0),
            angular: n.between(0.0, 1.0),
            flow: n.vector(2.0),
        }),
        4 => FieldKind::Buoyancy(Buoyancy { density: n.between(100.0, 1500.0), ..Buoyancy::default() }),
        5 => {
            let center = n.place();
            FieldKind::Custom {
                function: NUMBER,
                parameters: [center.x, center.y, center.z, n.between(0.0, 5.0), 0.0, 0.0, 0.0, 0.0],
            }
        }
        _ => FieldKind::Wind(Wind { velocity: n.vector(4.0), ..Wind::default() }),
    };
    let everywhere = n.chance(0.2) || matches!(kind, FieldKind::Mutual(_));
    let (center, radius) = (n.place(), n.between(0.5, 3.0));
    let fade = n.one_of(&[Fade::None, Fade::Linear, Fade::Smooth]);
    let region = if everywhere { Region::Everywhere } else { Region::ball(center, radius, fade) };
    FieldDef { region, ..FieldDef::new(kind) }
}

fn add_field(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let def = field_def(n);
    def.check().is_ok().then(|| a.add_field(&def))
}

fn set_field(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.field(n)?;
    let def = field_def(n);
    def.check().is_ok().then(|| call!(a.set_field(id, &def)))
}

fn remove_field(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.field(n)?;
    call!(a.remove_field(id));
    Some(())
}

/// Returns a rope, a strand, cloth or a blob.
fn group(n: &mut Numbers, at: Vec3) -> GroupDef {
    let to = at + Vec3::new(n.between(0.3, 1.0), n.between(-0.5, 0.0), 0.0);
    let rope = RopeDef {
        from: at,
        to,
        links: 3 + n.index(6) as u32,
        mass: n.between(0.1, 1.0),
        stiffness: 2e4,
        radius: 0.02,
    };
    match n.index(4) {
        0 => rope.build().group,
        1 => StrandDef { rope, bending: 1e-2 }.build().group,
        2 => {
            ClothDef {
                corner: at,
                across: Vec3::X * 0.8,
                down: Vec3::Z * 0.8,
                columns: 3 + n.index(4) as u32,
                rows: 3 + n.index(4) as u32,
                mass: n.between(0.1, 1.0),
                stretching: 1000.0,
                shearing: 100.0,
                bending: 1e-5,
                damping_ratio: 0.2,
                radius: 0.02,
            }
            .build()
            .group
        }
        _ => {
            BlobDef {
                center: at,
                radius: 0.25,
                subdivisions: 1,
                mass: n.between(0.5, 2.0),
                stiffness: 400.0,
                damping_ratio: 0.2,
                bulk_modulus: 5e3,
                skin: 0.02,
            }
            .build()
            .group
        }
    }
}

fn add_particles(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let at = n.place();
    if at.length() > 100.0 {
        return None;
    }
    let mut def = group(n, at);
    match n.index(4) {
        0 => def.hold_in_world(&[0]),
        1 => {
            let body = a.any_body(n)?;
            let point = a.world.transform(body).inverse_point(at);
            if point.length() < 3.0 {
                def.hold(0, AttachmentTarget::Body { body, point });
            }
        }
        _ => {}
    }
    def.linear_damping = n.between(0.0, 1.0);
    if n.chance(0.2) {
        def.scheme = SpringScheme::Projected;
    }
    if n.chance(0.1) {
        def.filter = parts::filter(n);
    }
    if n.chance(0.1) {
        def.thickness = n.between(0.0, 0.1);
    }
    def.check().is_ok().then(|| a.add_particles(&def))
}

fn remove_particles(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.group(n)?;
    call!(a.remove_particles(id));
    Some(())
}

fn push_particle(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.group(n)?;
    let count = a.world.particles(id).positions().len();
    let (particle, by) = (n.index(count) as u32, n.vector(1.0));
    if a.world.particles(id).velocities()[particle as usize].length() > 1e30 {
        return None;
    }
    let by = if by.length() < 1e6 { by } else { Vec3::Y };
    let pin = a
        .world
        .particles(id)
        .attachments()
        .iter()
        .position(|pin| matches!(pin.target, AttachmentTarget::World(_)));
    a.count("particles_mut");
    let world = format!("world.particles_mut({})", crate::code::Code::code(&id));
    let group = a.world.particles_mut(id);
    let call = match (n.index(5), pin) {
        (0, _) => {
            group.apply_impulse(particle, by * 0.1);
            format!("apply_impulse({particle}, {})", crate::code::Code::code(&(by * 0.1)))
        }
        (1, _) => {
            group.set_velocity(particle, by);
            format!("set_velocity({particle}, {})", crate::code::Code::code(&by))
        }
        (2, _) => {
            group.correct(particle, by * 0.01, 1.0);
            format!("correct({particle}, {}, 1.0)", crate::code::Code::code(&(by * 0.01)))
        }
        (3, Some(pin)) => {
            let to = group.positions()[particle as usize] + by * 0.1;
            group.move_pin(pin, to);
            format!("move_pin({pin}, {})", crate::code::Code::code(&to))
        }
        _ => {
            let to = group.positions()[particle as usize] + by * 0.05;
            group.set_position(particle, to);
            format!("set_position({particle}, {})", crate::code::Code::code(&to))
        }
    };
    a.line(format!("{world}.{call};"));
    Some(())
}

fn add_mover(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let radius = n.between(0.1, 0.3);
    let def = MoverDef { radius, height: n.between(2.0 * radius, 1.8), ..MoverDef::at(n.place()) };
    def.check().is_ok().then(|| a.add_mover(&def))
}

fn remove_mover(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.mover(n)?;
    call!(a.remove_mover(id));
    Some(())
}

fn lead_mover(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.mover(n)?;
    let velocity = n.vector(3.0);
    match n.index(4) {
        0 | 1 => call!(a.set_mover_walk(id, velocity)),
        2 => call!(a.set_mover_velocity(id, velocity)),
        _ => {
            let speed = n.least(0.0, 6.0);
            call!(a.mover_jump(id, speed));
        }
    }
    Some(())
}

fn change_mover(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.mover(n)?;
    match n.index(3) {
        0 => {
            let position = n.place();
            call!(a.set_mover_position(id, position));
        }
        1 => {
            let radius = a.world.mover(id).def().radius;
            let height = n.between(2.0 * radius, 2.0);
            ask!(a.set_mover_height(id, height));
        }
        _ => {
            let filter = parts::filter(n);
            call!(a.set_mover_filter(id, filter));
        }
    }
    Some(())
}

fn add_object(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    if a.objects.iter().filter(|&&(_, id)| a.world.contains_object(id)).count() > 2 {
        return None;
    }
    let body = a.dynamic(n)?;
    let place = n.place();
    let place = if place.length() < 100.0 { place } else { Vec3::Y };
    a.add_object(Tug { body, place, stiffness: n.between(0.0, 200.0), asked: 0 });
    Some(())
}

fn change_object(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.object(n)?;
    let stiffness = n.between(0.0, 200.0);
    a.count("object_mut");
    a.line(format!("world.object_mut::<Tug>({}).stiffness = {stiffness:?};", crate::code::Code::code(&id)));
    a.world.object_mut::<Tug>(id).stiffness = stiffness;
    a.count("object");
    let Tug { asked, .. } = *a.world.object::<Tug>(id);
    crate::actor::say(&mut a.said, "asked", &asked);
    Some(())
}

fn remove_object(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.object(n)?;
    _ = call!(a.remove_object(id));
    Some(())
}

/// Returns a pose for queries with a shape.
pub fn near_pose(n: &mut Numbers) -> Transform {
    let at = n.place();
    Transform::new(if at.length() < 1e6 { at } else { Vec3::Y }, n.rotation())
}
