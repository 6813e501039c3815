//! Deeds that only query the world. Equal worlds must return equal answers.

use super::{Deed, others, parts};
use crate::actor::{Actor, say};
use crate::functions::Tug;
use crate::numbers::Numbers;
use core::fmt::Write;
use sinew_math::Vec3;
use sinew_physics::ray::Ray;
use sinew_physics::*;

pub const ALL: &[Deed] = &[
    Deed::new("ask_body", 2, ask_body),
    Deed::new("ask_pair", 1, ask_pair),
    Deed::new("ask_shape", 1, ask_shape),
    Deed::new("ask_joint", 1, ask_joint),
    Deed::new("ask_world", 2, ask_world),
    Deed::new("ask_others", 1, ask_others),
    Deed::new("query", 2, query),
    Deed::new("draw", 1, draw),
];

fn ask_body(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.any_body(n)?;
    let point = others::near_pose(n).translation;
    ask!(a.contains(id));
    ask!(a.transform(id));
    ask!(a.interpolated(id, 0.5));
    ask!(a.center_of_mass(id));
    ask!(a.velocity(id));
    ask!(a.kind(id));
    ask!(a.mass(id));
    ask!(a.user_data(id));
    ask!(a.is_awake(id));
    ask!(a.sleeping(id));
    ask!(a.quality(id));
    ask!(a.linear_damping(id));
    ask!(a.angular_damping(id));
    ask!(a.bounds(id));
    ask!(a.nearest_surface(id, point));
    ask!(a.contains_point(id, point));
    ask!(a.point_penetration(id, point));
    ask!(a.body_energy(id));
    ask!(a.penetration(id));
    ask!(a.get(id));
    ask_all!(a.neighbors(id));
    ask_all!(a.contacts_of(id));
    ask_all!(a.joints_of(id));
    ask_all!(a.forces_of(id));
    ask_all!(a.shape_ids(id));
    a.count("shapes");
    let count = a.world.shapes(id).count();
    say(&mut a.said, "shapes", &count);
    Some(())
}

fn ask_pair(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let (p, q) = (a.any_body(n)?, a.any_body(n)?);
    ask!(a.overlap(p, q));
    Some(())
}

fn ask_shape(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let body = a.any_body(n)?;
    let id = a.shape(n, body)?;
    ask!(a.body_from_shape(id));
    ask!(a.material(id));
    ask!(a.filter(id));
    ask!(a.sensing(id));
    ask!(a.contact_rule(id));
    a.count("shape");
    a.count("shape_def");
    let volume = a.world.shape(id).mass_properties(1.0).mass;
    let density = a.world.shape_def(id).density;
    say(&mut a.said, "shape", &(volume, density));
    Some(())
}

fn ask_joint(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.joint(n)?;
    ask!(a.contains_joint(id));
    ask!(a.joint(id));
    ask!(a.joint_bodies(id));
    ask!(a.reaction(id));
    ask!(a.joint_transform(id));
    ask!(a.joint_gap(id));
    ask!(a.joint_overshoot(id));
    ask!(a.joint_energy(id));
    Some(())
}

fn ask_world(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let point = others::near_pose(n).translation;
    ask!(a.def());
    ask!(a.step_count());
    ask!(a.time());
    ask!(a.energy());
    ask!(a.momentum());
    ask!(a.air_velocity(point));
    ask_all!(a.body_ids());
    ask_all!(a.joint_ids());
    ask_all!(a.group_ids());
    ask_all!(a.field_ids());
    ask_all!(a.mover_ids());
    ask_all!(a.object_ids());
    ask_all!(a.bodies());
    ask_all!(a.contacts());
    // Snapshots do not contain the changes since the step.
    a.count("bodies_moved");
    _ = a.world.bodies_moved().count();
    Some(())
}

fn ask_others(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let (field, group, body, mover) = (a.field(n), a.group(n), a.any_body(n), a.mover(n));
    if let Some(id) = mover {
        ask!(a.contains_mover(id));
        ask!(a.mover(id));
        ask!(a.mover_ground(id));
    }
    if let Some(id) = group {
        ask!(a.group_energy(id));
        a.count("particles");
        let sum: Vec3 = a.world.particles(id).positions().iter().copied().sum();
        say(&mut a.said, "particles", &sum);
    }
    if let Some(id) = field {
        ask!(a.contains_field(id));
        ask!(a.field(id));
        ask!(a.field_energy(id));
        if let Some(body) = body {
            ask!(a.field_force(id, body));
        }
        if let Some(group) = group {
            ask!(a.field_force_on_particle(id, group, 0));
        }
    }
    let object = a.object(n);
    if let Some(id) = object {
        ask!(a.contains_object(id));
        a.count("object");
        let Tug { asked, .. } = *a.world.object::<Tug>(id);
        say(&mut a.said, "object", &asked);
    }
    Some(())
}

fn query(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let pose = others::near_pose(n);
    let ray = Ray { origin: pose.translation, direction: n.direction() * n.between(0.0, 10.0) };
    let probe = Probe::new(parts::shape(n, 0.1, 0.5), pose);
    let cast = ShapeCast { probe: probe.clone(), translation: n.direction() * n.between(0.0, 5.0) };
    a.count("query");
    let query = a.world.query().filter(QueryFilter {
        sensors: n.one_of(&[Sensors::Ignored, Sensors::Included]),
        ..QueryFilter::default()
    });
    let (mut hits, mut shapes, mut bodies, mut near) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    query.all(&ray, &mut hits);
    query.all(&OverlapWith(probe.clone()), &mut shapes);
    query.bodies(&PenetrationOf(probe.clone()), &mut bodies);
    query.all(&NearestTo { point: pose.translation, within: 1.0 }, &mut near);
    let firsts = (query.first(&ray), query.first(&cast), query.any(&ContainsPoint(pose.translation)));
    let nearest = query.first(&NearestToShape { probe, within: 2.0 });
    assert_eq!(firsts.0, hits.first().copied(), "`all` must list the hit that `first` returns first");
    let mut each = [None; 2];
    query.first_each(&[ray, ray], &mut each);
    assert_eq!(each, [firsts.0; 2], "a batch of rays must return the hits of single rays");
    writeln!(a.said, "{hits:?} {shapes:?} {bodies:?} {near:?} {firsts:?} {nearest:?}")
        .expect("writing to a string cannot fail");
    Some(())
}

/// Renderer that adds up the end points of all lines.
struct Sum(Vec3);

impl DebugDraw for Sum {
    fn line(&mut self, from: Vec3, to: Vec3, _: DrawKind) {
        self.0 += from + to;
    }
}

fn draw(a: &mut Actor, _: &mut Numbers) -> Option<()> {
    let mut sum = Sum(Vec3::ZERO);
    a.count("draw");
    a.world.draw(&mut sum);
    say(&mut a.said, "draw", &sum.0);
    Some(())
}
