//! Random actions on characters.

use crate::actor::{Actor, say};
use crate::code::rusty;
use crate::deeds::Deed;
use crate::extension::{MOST, Member, chosen, kinds, own, part};
use crate::numbers::{Numbers, Temper};
use sinew_anim::{LocalTransform, LoopMode, TrackDef};
use sinew_math::{Reader, Rotation, Transform, Vec3, Writer};
use sinew_physics::{BodyDef, BodyHit, BodyKind, Shape, Velocity};
use sinew_ragdoll::{AfterSettling, Character, Detail, DriveMode, Muscle, Part, Pin, Preset};

pub const ALL: &[Deed] = &[
    Deed::new("spawn", 10, spawn),
    Deed::new("despawn", 2, despawn),
    Deed::new("hit", 10, hit),
    Deed::new("hit_at", 3, hit_at),
    Deed::new("go_limp", 6, go_limp),
    Deed::new("set_preset", 10, set_preset),
    Deed::new("set_drive", 4, set_drive),
    Deed::new("return_to_clip", 2, return_to_clip),
    Deed::new("set_after_settling", 2, set_after_settling),
    Deed::new("drives_mut", 2, drives_mut),
    Deed::new("animator_mut", 2, animator_mut),
    Deed::new("lead", 10, lead),
    Deed::new("jump", 4, jump),
    Deed::new("teleport_character", 3, teleport),
    Deed::new("set_level_of_detail", 5, set_level_of_detail),
    Deed::new("clear", 2, clear),
    Deed::new("reset_worn", 2, reset_worn),
    Deed::new("reload_character", 2, reload),
    Deed::new("ask_character", 6, ask_character),
    Deed::new("throw_at", 5, throw_at),
    Deed::new("door", 3, door),
    Deed::new("push_part", 3, push_part),
    Deed::new("change_part", 2, change_part),
];

/// Calls a method of a character and records the call.
macro_rules! to {
    ($a:ident[$chosen:expr].$name:ident(world $(, $argument:expr)* $(,)?)) => {{
        $crate::characters::note($a, $chosen, stringify!($name), concat!("Character::", stringify!($name)), &[$(&$argument),*], true);
        let (world, character) = (&mut $a.world, &mut $a.more.cast[$chosen].character);
        character.$name(world $(, $argument)*)
    }};
    ($a:ident[$chosen:expr].$name:ident($($argument:expr),* $(,)?)) => {{
        $crate::characters::note($a, $chosen, stringify!($name), concat!("Character::", stringify!($name)), &[$(&$argument),*], false);
        $a.more.cast[$chosen].character.$name($($argument),*)
    }};
}
pub(crate) use to;

/// Records a call to a character as a line of the program.
pub fn note(
    a: &mut Actor,
    chosen: usize,
    name: &str,
    count: &'static str,
    arguments: &[&dyn core::fmt::Debug],
    with_world: bool,
) {
    a.count(count);
    if a.lines.is_some() {
        let world = with_world.then(|| "&mut world".to_owned());
        let arguments = arguments.iter().map(|argument| rusty(&format!("{argument:?}")));
        let arguments: Vec<String> = world.into_iter().chain(arguments).collect();
        let number = a.more.cast[chosen].number;
        a.line(format!("character_{number}.{name}({});", arguments.join(", ")));
    }
}

/// Largest distance of a character from the origin in a wild life, metres; beyond it, squares of lengths overflow.
const FARTHEST: f32 = 1e12;

/// Returns a transform for a standing character: on the floor or slightly above it; in a wild life anywhere.
fn place(n: &mut Numbers) -> Transform {
    let turn = n.between(-3.0, 3.0);
    let (x, z) = (n.signed(2.0).clamp(-FARTHEST, FARTHEST), n.signed(2.0).clamp(-FARTHEST, FARTHEST));
    let height = if n.chance(0.8) { 0.0 } else { n.between(0.0, 2.0) };
    Transform::new(Vec3::new(x, height, z), Rotation::from_axis_angle(Vec3::Y, turn))
}

fn spawn(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let kind = [0, 0, 0, 0, 0, 0, 0, 1, 1, 2][n.index(10)];
    let (at, begins, phase) = (place(n), n.chance(0.3), n.between(0.0, 2.0));
    if a.more.cast.len() >= MOST {
        return None;
    }
    let (name, number) = (a.name(), a.more.born);
    let def = &kinds()[kind];
    let character = if begins {
        ["Character::new", "Character::enter"].into_iter().for_each(|name| a.count(name));
        let mut character = Character::new(def.clone(), at, phase);
        character.enter(&mut a.world);
        a.line(format!("let mut character_{number} = Character::new(kinds()[{kind}].clone(), {}, {phase:?});\n    character_{number}.enter(&mut world);", rusty(&format!("{at:?}"))));
        character
    } else {
        a.count("Character::spawn");
        a.line(format!(
            "let mut character_{number} = Character::spawn(&mut world, &kinds()[{kind}], {});",
            rusty(&format!("{at:?}"))
        ));
        Character::spawn(&mut a.world, def, at)
    };
    a.more.born += 1;
    a.more.cast.push(Member { name, number, kind, character });
    Some(())
}

fn despawn(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let chosen = chosen(a, n)?;
    let Member { number, character, .. } = a.more.cast.remove(chosen);
    a.count("Character::despawn");
    a.line(format!("character_{number}.despawn(&mut world);"));
    character.despawn(&mut a.world);
    Some(())
}

/// Returns an impulse plausible for the body's mass; in a wild life any impulse.
fn blow(a: &Actor, n: &mut Numbers, chosen: usize, body: usize) -> Vec3 {
    let impulse = n.vector(60.0);
    let mass = a.more.cast[chosen].character.def().ragdoll.bodies[body].mass.mass;
    let most = mass * 12.0;
    if n.temper == Temper::Wild || impulse.length() < most {
        return impulse;
    }
    impulse * (most / impulse.length())
}

fn any_part(a: &Actor, n: &mut Numbers, chosen: usize) -> usize {
    n.index(a.more.cast[chosen].character.def().ragdoll.bodies.len())
}

fn hit(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let chosen = chosen(a, n)?;
    let body = any_part(a, n, chosen);
    let impulse = blow(a, n, chosen, body);
    let work = to!(a[chosen].hit(world, body, impulse));
    say(&mut a.said, "hit", &work);
    Some(())
}

fn hit_at(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let chosen = chosen(a, n)?;
    let part = any_part(a, n, chosen);
    let body = *a.more.cast[chosen].character.bodies().get(part)?;
    let impulse = blow(a, n, chosen, part);
    if !a.world.contains(body) {
        return None;
    }
    let point = a.world.center_of_mass(body) + Vec3::Y * 0.03;
    let hit = BodyHit { body, shape: 0, fraction: 0.5, point, normal: Vec3::Y, start: None };
    let work = to!(a[chosen].hit_at(world, &hit, impulse));
    say(&mut a.said, "hit_at", &work);
    Some(())
}

fn go_limp(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let chosen = chosen(a, n)?;
    to!(a[chosen].go_limp(world));
    Some(())
}

fn set_preset(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let chosen = chosen(a, n)?;
    let preset = n.one_of(&[
        Preset::Powered,
        Preset::Powered,
        Preset::Animated,
        Preset::Animated,
        Preset::Flinching,
        Preset::Limp,
    ]);
    to!(a[chosen].set_preset(world, preset));
    Some(())
}

fn mode(n: &mut Numbers) -> DriveMode {
    let muscle = n.one_of(&[Muscle::RELAXED, Muscle::ALIVE, Muscle::STIFF]);
    match n.index(4) {
        0 => DriveMode::Limp,
        1 => DriveMode::Powered(muscle),
        2 => DriveMode::Pinned(muscle, n.one_of(&[Pin::SOFT, Pin::FIRM])),
        _ => DriveMode::Keyed,
    }
}

fn set_drive(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let chosen = chosen(a, n)?;
    let (body, mode, half_life) = (any_part(a, n, chosen), mode(n), n.between(0.0, 1.0));
    let def = a.more.cast[chosen].character.def().clone();
    let role = def.ragdoll.bodies[body].role.as_str();
    let part = match n.index(4) {
        0 => Part::All,
        1 => Part::Body(body),
        2 => Part::Named(role),
        _ => Part::From(role),
    };
    to!(a[chosen].set_drive(world, part, mode, half_life));
    Some(())
}

fn drives_mut(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let chosen = chosen(a, n)?;
    let (body, mode, half_life) = (any_part(a, n, chosen), mode(n), n.between(0.0, 1.0));
    to!(a[chosen].drives_mut()).set(body, mode, half_life);
    Some(())
}

fn animator_mut(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let chosen = chosen(a, n)?;
    let def = a.more.cast[chosen].character.def().clone();
    let clip = def.clip(n.index(def.motions().clips.len()));
    let weight = n.between(0.0, 1.0);
    let track = TrackDef {
        weight,
        speed: n.between(-2.0, 2.0),
        loop_mode: n.one_of(&[LoopMode::Loop, LoopMode::Once]),
        layer: n.one_of(&[0, 1]),
        ..TrackDef::new(clip)
    };
    to!(a[chosen].animator_mut()).play(def.set(), &track);
    Some(())
}

fn lead(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let chosen = chosen(a, n)?;
    let way = n.vector(2.5);
    match n.index(4) {
        0 | 1 => to!(a[chosen].set_move(way)),
        2 => to!(a[chosen].face(way)),
        _ => to!(a[chosen].follow_clips()),
    }
    Some(())
}

fn jump(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let chosen = chosen(a, n)?;
    to!(a[chosen].jump(world));
    Some(())
}

fn return_to_clip(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let chosen = chosen(a, n)?;
    let (at, phase, seconds) = (place(n), n.between(0.0, 3.0), n.between(0.0, 1.2));
    to!(a[chosen].return_to_clip(world, at, phase, seconds));
    Some(())
}

fn set_after_settling(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let chosen = chosen(a, n)?;
    let after = n.one_of(&[AfterSettling::GetUp, AfterSettling::StayDown]);
    to!(a[chosen].set_after_settling(after));
    Some(())
}

fn teleport(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let chosen = chosen(a, n)?;
    let at = place(n);
    to!(a[chosen].teleport(world, at));
    Some(())
}

fn set_level_of_detail(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let chosen = chosen(a, n)?;
    let detail = n.one_of(&[Detail::Full, Detail::Full, Detail::Keyed, Detail::HitBodies, Detail::Frozen]);
    to!(a[chosen].set_level_of_detail(world, detail));
    Some(())
}

fn clear(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let chosen = chosen(a, n)?;
    let clears = to!(a[chosen].clear(world));
    say(&mut a.said, "clear", &clears);
    Some(())
}

fn reset_worn(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let chosen = chosen(a, n)?;
    if n.chance(0.5) {
        to!(a[chosen].reset_springs());
    } else {
        to!(a[chosen].reset_garments(world));
    }
    Some(())
}

/// Recreates a character from its bytes.
fn reload(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let chosen = chosen(a, n)?;
    let mut w = Writer::new();
    ["Character::save", "Character::load"].into_iter().for_each(|name| a.count(name));
    let Member { kind, number, character, .. } = &mut a.more.cast[chosen];
    character.save(&mut w);
    let mut other = Character::new(kinds()[*kind].clone(), Transform::IDENTITY, 0.0);
    other.load(&mut Reader::new(w.as_bytes())).expect("a saved character is valid");
    *character = other;
    let line = format!("character_{number} = loaded(&character_{number});");
    a.line(line);
    Some(())
}

/// Calls all getters of a character.
fn ask_character(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    macro_rules! asked {
        ($character:ident, $code_text:ident, $calls:ident, $($name:ident)*) => {
            $($calls.push(concat!("Character::", stringify!($name)));
            say(&mut $code_text, stringify!($name), &$character.$name());)*
        };
    }
    let chosen = chosen(a, n)?;
    let (alpha, body) = (n.between(0.0, 1.0), any_part(a, n, chosen));
    let character = a.more.cast[chosen].character.clone();
    let (mut code_text, mut calls) = (String::new(), vec!["Character::clone"]);
    asked!(character, code_text, calls, state level_of_detail lost_joints mover bodies stumbles garments);
    asked!(character, code_text, calls, pose pose_without_springs world_from_character world_from_model ragdoll drives);
    asked!(character, code_text, calls, after_settling);
    let held: Vec<_> = character.held().collect();
    say(&mut code_text, "held", &held);
    say(&mut code_text, "has_body", &character.has_body(body));
    let index = own(&character).next().map(|body| character.body_index(body));
    say(&mut code_text, "body_index", &index);
    say(&mut code_text, "animator", &character.animator().tracks().collect::<Vec<_>>());
    let mut pose: Vec<LocalTransform> = Vec::new();
    // A loaded character interpolates only after its first step; the poses at the end of a step are equal at once.
    let _ = character.interpolated(alpha, &mut pose);
    let shown = character.interpolated(1.0, &mut pose);
    say(&mut code_text, "interpolated", &(shown, pose));
    let mut palette: Vec<[f32; 12]> = Vec::new();
    if !character.def().rig.skins.is_empty() {
        character.skin_palette(0, alpha, &mut palette);
        character.skin_palette(0, 1.0, &mut palette);
    }
    say(&mut code_text, "skin_palette", &palette);
    calls.extend(["Character::held", "Character::has_body", "Character::body_index", "Character::animator"]);
    calls.extend([
        "Character::interpolated",
        "Character::skin_palette",
        "Character::def",
        "Character::events",
        "Character::update",
    ]);
    calls.into_iter().for_each(|call| a.count(call));
    a.said += &code_text;
    Some(())
}

/// Throws a ball at a character.
fn throw_at(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let target = part(a, n)?;
    let (way, speed, radius) = (n.direction(), n.between(3.0, 20.0), n.between(0.05, 0.25));
    let at = a.world.center_of_mass(target);
    let from = at - way * 1.5 + Vec3::Y * 0.2;
    if !from.is_finite() || from.y < radius {
        return None;
    }
    let ball = BodyDef { linear_velocity: way * speed, ..BodyDef::dynamic(Shape::sphere(radius)).at(from) };
    a.add_body(&ball);
    Some(())
}

/// Moves an unstoppable slab toward a character.
fn door(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let target = part(a, n)?;
    let (side, speed) = (n.one_of(&[Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z]), n.between(0.2, 1.0));
    let at = a.world.center_of_mass(target) - side * 1.0;
    if at.length() > 1e6 {
        return None;
    }
    let half = Vec3::new(if side.x == 0.0 { 0.6 } else { 0.05 }, 1.1, if side.z == 0.0 { 0.6 } else { 0.05 });
    let at = Vec3 { y: 1.1, ..at };
    let slab = BodyDef {
        kind: BodyKind::Kinematic,
        linear_velocity: side * speed,
        ..BodyDef::fixed(Shape::cuboid(half)).at(at)
    };
    a.add_body(&slab);
    Some(())
}

fn push_part(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let body = part(a, n)?;
    let by = n.vector(4.0);
    let mass = a.world.mass(body).mass;
    let impulse = by * mass;
    if n.chance(0.5) && impulse.is_finite() {
        call!(a.apply_impulse_at_center(body, impulse));
    } else {
        let velocity = Velocity { linear: by, angular: n.vector(5.0) };
        call!(a.set_velocity(body, velocity));
    }
    Some(())
}

/// Makes calls to the world on a character's body, as a game may.
fn change_part(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let body = part(a, n)?;
    a.more.is_meddled_with = true;
    match n.index(4) {
        0 => {
            let kind = n.one_of(&[BodyKind::Dynamic, BodyKind::Kinematic, BodyKind::Static]);
            call!(a.set_kind(body, kind));
        }
        1 => call!(a.put_to_sleep(body)),
        2 => call!(a.wake(body)),
        _ => {
            let to = Transform {
                translation: a.world.transform(body).translation + n.vector(0.05),
                ..a.world.transform(body)
            };
            if to.translation.is_finite() {
                call!(a.set_transform(body, to));
            }
        }
    }
    Some(())
}
