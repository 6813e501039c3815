//! Random actions with grips: held and grabbed bodies, grab points, and detached limbs.

use crate::actor::{Actor, pick, say};
use crate::characters::to;
use crate::code::rusty;
use crate::deeds::Deed;
use crate::extension::{chosen, kinds, part};
use crate::numbers::Numbers;
use sinew_math::{Affine, Reader, Transform, Vec3, Writer};
use sinew_physics::{BodyId, BodyKind, Strength};
use sinew_ragdoll::{Grab, GrabPoint, Grip, Limb};

pub const ALL: &[Deed] = &[
    Deed::new("grab", 10, grab),
    Deed::new("hold", 4, hold),
    Deed::new("release", 4, release),
    Deed::new("detach", 4, detach),
    Deed::new("take", 5, take),
    Deed::new("ask_point", 2, ask_point),
    Deed::new("move_point", 5, move_point),
    Deed::new("release_point", 3, release_point),
    Deed::new("ask_limb", 3, ask_limb),
    Deed::new("detach_limb", 2, detach_limb),
    Deed::new("despawn_limb", 2, despawn_limb),
];

/// Returns a body of the world or of a character.
fn thing(a: &Actor, n: &mut Numbers) -> Option<BodyId> {
    if n.chance(0.4) { a.dynamic(n) } else { part(a, n) }
}

/// Returns a bone of a character; a hand in half of the cases.
fn bone(a: &Actor, n: &mut Numbers, chosen: usize) -> String {
    let bodies = &a.more.cast[chosen].character.def().ragdoll.bodies;
    let any = bodies[1 + n.index(bodies.len() - 1)].role.clone();
    if n.chance(0.5) { n.one_of(&["leftHand", "rightHand"]).to_owned() } else { any }
}

fn grip(n: &mut Numbers) -> Grab {
    Grab {
        max_force: n.between(50.0, 2000.0),
        reach: n.one_of(&[0.25, 0.8]),
        slip: n.between(0.1, 1.0),
        to: n.chance(0.3).then(|| Vec3::new(0.0, n.between(-0.2, 0.2), 0.0)),
        speed: n.between(0.5, 3.0),
        drops: n.chance(0.5),
    }
}

fn grab(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let chosen = chosen(a, n)?;
    let (bone, held, grab) = (bone(a, n, chosen), thing(a, n)?, grip(n));
    let joint = to!(a[chosen].grab(world, &bone, held, &grab));
    say(&mut a.said, "grab", &joint);
    joint.map(|_| ())
}

fn hold(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let chosen = chosen(a, n)?;
    let bone = bone(a, n, chosen);
    let held =
        a.body(n, |world, id| world.kind(id) == BodyKind::Dynamic && world.body_owner(id).is_none())?;
    let strength = n.one_of(&[Strength::UNBREAKABLE, Strength { force: 500.0, torque: 100.0 }]);
    let at = Vec3::new(0.0, 0.0, n.between(0.0, 0.3));
    let grip = Grip { bone_from_held: Transform::from_translation(at), strength, drops: n.chance(0.5) };
    let character = &a.more.cast[chosen].character;
    let body = character.def().body_named(&bone).expect("it has that bone");
    let may = character.has_body(body)
        && !character.bodies().is_empty()
        && character.held().all(|other| other != held);
    if !may {
        return None;
    }
    let joint = to!(a[chosen].hold(world, &bone, held, &grip));
    say(&mut a.said, "hold", &joint);
    Some(())
}

fn release(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let chosen = chosen(a, n)?;
    let held: Vec<BodyId> = a.more.cast[chosen].character.held().collect();
    if held.is_empty() {
        return None;
    }
    let held = n.one_of(&held);
    let lets_go = to!(a[chosen].release(world, held));
    say(&mut a.said, "release", &lets_go);
    Some(())
}

fn detach(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let chosen = chosen(a, n)?;
    let (bone, kind) = (bone(a, n, chosen), a.more.cast[chosen].kind);
    if a.more.cast[chosen].character.bodies().is_empty() && n.chance(0.5) {
        return None;
    }
    let limb = to!(a[chosen].detach(world, &bone))?;
    let name = a.name();
    a.more.limbs.push((name, kind, limb));
    Some(())
}

/// Returns the index of one of the limbs, if there are any.
fn limb(a: &Actor, n: &mut Numbers) -> Option<usize> {
    let names: Vec<(u64, usize)> =
        a.more.limbs.iter().enumerate().map(|(i, &(name, ..))| (name, i)).collect();
    pick(&names, n.bits(), |_| true)
}

fn detach_limb(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let which = limb(a, n)?;
    let kind = a.more.limbs[which].1;
    let bodies = &kinds()[kind].ragdoll.bodies;
    let bone = bodies[1 + n.index(bodies.len() - 1)].role.clone();
    a.count("Limb::detach");
    a.line(format!("limb_{which}.detach(&mut world, {bone:?});"));
    let off = a.more.limbs[which].2.detach(&mut a.world, &bone)?;
    let name = a.name();
    a.more.limbs.push((name, kind, off));
    Some(())
}

fn despawn_limb(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let which = limb(a, n)?;
    a.count("Limb::despawn");
    a.line(format!("limb_{which}.despawn(&mut world);"));
    a.more.limbs.remove(which).2.despawn(&mut a.world);
    Some(())
}

fn ask_limb(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let which = limb(a, n)?;
    let alpha = n.between(0.0, 1.0);
    let (_, kind, limb) = &a.more.limbs[which];
    let limb = limb.clone();
    let mut code_text = String::new();
    say(&mut code_text, "parts", &limb.parts());
    say(&mut code_text, "bodies", &limb.bodies());
    say(&mut code_text, "joints", &limb.joints());
    say(&mut code_text, "skin_joints", &limb.skin_joints().collect::<Vec<_>>());
    let mut w = Writer::new();
    limb.save(&mut w);
    let loaded = Limb::load(&kinds()[*kind], &mut Reader::new(w.as_bytes())).expect("a saved limb is valid");
    let mut places: Vec<Affine> = Vec::new();
    loaded.world_from_joints(&a.world, alpha, &mut places);
    say(&mut code_text, "world_from_joints", &places);
    let mut palette: Vec<[f32; 12]> = Vec::new();
    if !loaded.def().rig.skins.is_empty() {
        loaded.skin_palette(&a.world, 0, alpha, &mut palette);
    }
    say(&mut code_text, "skin_palette", &palette);
    let calls =
        ["Limb::clone", "Limb::parts", "Limb::bodies", "Limb::joints", "Limb::skin_joints", "Limb::save"];
    calls.into_iter().for_each(|call| a.count(call));
    let calls = ["Limb::load", "Limb::world_from_joints", "Limb::skin_palette", "Limb::def"];
    calls.into_iter().for_each(|call| a.count(call));
    a.said += &code_text;
    Some(())
}

fn take(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let held = thing(a, n)?;
    let at = a.world.center_of_mass(held);
    let grab = Grab { speed: n.between(0.5, 3.0), ..Grab::POINT };
    if a.more.points.len() >= 3 || !at.is_finite() {
        return None;
    }
    a.count("GrabPoint::take");
    a.line(format!(
        "points.extend(GrabPoint::take(&mut world, {}, {}, &Grab {{ speed: {:?}, ..Grab::POINT }}));",
        rusty(&format!("{held:?}")),
        rusty(&format!("{at:?}")),
        grab.speed
    ));
    let point = GrabPoint::take(&mut a.world, held, at, &grab)?;
    let name = a.name();
    a.more.points.push((name, point));
    Some(())
}

/// Returns the index of one of the grab points, if there are any.
fn point(a: &Actor, n: &mut Numbers) -> Option<usize> {
    let names: Vec<(u64, usize)> =
        a.more.points.iter().enumerate().map(|(i, &(name, _))| (name, i)).collect();
    pick(&names, n.bits(), |_| true)
}

fn move_point(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let which = point(a, n)?;
    let to = a.more.points[which].1.target() + n.vector(1.0);
    if !to.is_finite() {
        return None;
    }
    a.count("GrabPoint::set_target");
    a.count("GrabPoint::update");
    a.line(format!("points[{which}].set_target({});", rusty(&format!("{to:?}"))));
    a.more.points[which].1.set_target(to);
    Some(())
}

fn release_point(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let which = point(a, n)?;
    a.count("GrabPoint::release");
    a.line(format!("points.remove({which}).release(&mut world);"));
    a.more.points.remove(which).1.release(&mut a.world);
    Some(())
}

fn ask_point(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let which = point(a, n)?;
    let point = a.more.points[which].1.clone();
    let mut w = Writer::new();
    point.save(&mut w);
    let loaded = GrabPoint::load(&mut Reader::new(w.as_bytes())).expect("a saved point is valid");
    say(&mut a.said, "point", &(loaded.target(), loaded.held(), loaded.joint()));
    let calls = ["GrabPoint::clone", "GrabPoint::target", "GrabPoint::held", "GrabPoint::joint"];
    calls.into_iter().for_each(|call| a.count(call));
    ["GrabPoint::save", "GrabPoint::load"].into_iter().for_each(|call| a.count(call));
    Some(())
}
