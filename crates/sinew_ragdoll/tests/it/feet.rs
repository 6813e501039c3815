//! Foot placement while a character walks: the drawn sole against the ground, on floor, stairs, slopes, a lift and a
//! turntable.

use crate::actor::{floor, shared};
use sinew_anim::{LocalTransform, local_to_model, skin_vertices};
use sinew_math::{Rotation, Transform, Vec3, max, min};
use sinew_physics::ray::Ray;
use sinew_physics::{BodyDef, BodyId, BodyKind, QueryFilter, Shape, ShapeDef, Velocity, World, WorldDef};
use sinew_ragdoll::{Character, CharacterDef, State};
use std::sync::Arc;

/// Height over the clip's floor (metres) and speed over the ground (m/s) below which a clip's foot stands.
const STANDS: (f32, f32) = (0.02, 0.5);
/// Distance from the ground up to which a drawn sole counts as on it, metres.
const ON: f32 = 0.02;

/// A scene to walk in.
struct Ground {
    name: &'static str,
    bodies: Vec<BodyDef>,
    /// Velocity of the first body over time, if it moves.
    moves: fn(f32) -> Velocity,
    start: Vec3,
    walk: Vec3,
    seconds: f32,
    /// Horizontal distance from a point to the edge of a step, metres; infinite without edges.
    edge: fn(Vec3) -> f32,
}

fn fixed(half_extents: Vec3, position: Vec3, rotation: Rotation) -> BodyDef {
    let shapes = vec![ShapeDef::new(Shape::Box { half_extents })];
    BodyDef { kind: BodyKind::Static, position, rotation, shapes, ..BodyDef::default() }
}

fn moving(half_extents: Vec3, position: Vec3) -> BodyDef {
    BodyDef { kind: BodyKind::Kinematic, ..fixed(half_extents, position, Rotation::IDENTITY) }
}

/// Returns a plane that rises toward +Z by this angle, degrees, starting at the origin.
fn ramp(degrees: f32) -> Vec<BodyDef> {
    let turn = Rotation::from_axis_angle(Vec3::X, -degrees.to_radians());
    vec![fixed(Vec3::new(20.0, 1.0, 20.0), turn * Vec3::NEG_Y, turn)]
}

/// Returns steps of 17 by 30 cm that rise toward +Z, starting at 1 m.
fn stairs() -> Vec<BodyDef> {
    let step = |k: i32| {
        let top = 0.17 * k as f32;
        let half = Vec3::new(10.0, 1.0, 5.0);
        fixed(half, Vec3::new(0.0, top - 1.0, 1.0 + 0.3 * (k - 1) as f32 + 5.0), Rotation::IDENTITY)
    };
    core::iter::once(floor()).chain((1..20).map(step)).collect()
}

/// Returns the horizontal distance by which a point is behind the riser in front of it, metres.
fn riser(at: Vec3) -> f32 {
    let behind = at.z - 1.0;
    if behind < 0.0 { f32::INFINITY } else { behind - 0.3 * (behind / 0.3).floor() }
}

fn endless(_: Vec3) -> f32 {
    f32::INFINITY
}

fn still(_: f32) -> Velocity {
    Velocity::default()
}

fn grounds() -> Vec<Ground> {
    let ahead = Vec3::Z * 1.2;
    let of = |name, bodies, start, walk, seconds| Ground {
        name,
        bodies,
        moves: still,
        start,
        walk,
        seconds,
        edge: endless,
    };
    let top = Vec3::new(0.0, 0.17 * 19.0, 1.0 + 0.3 * 20.0);
    vec![
        of("floor", vec![floor()], Vec3::ZERO, ahead, 5.0),
        of("floor, idle", vec![floor()], Vec3::ZERO, Vec3::ZERO, 3.0),
        of("ramp up 20°", ramp(20.0), Vec3::ZERO, ahead, 5.0),
        of("ramp down 20°", ramp(-20.0), Vec3::ZERO, ahead, 5.0),
        of("ramp across 20°", ramp(20.0), Vec3::ZERO, Vec3::X * 1.2, 5.0),
        of("ramp, idle", ramp(20.0), Vec3::ZERO, Vec3::ZERO, 3.0),
        Ground { edge: riser, ..of("stairs up", stairs(), Vec3::ZERO, Vec3::Z, 6.0) },
        Ground { edge: riser, ..of("stairs down", stairs(), top, Vec3::Z * -1.0, 6.0) },
        Ground {
            moves: |time| Velocity {
                linear: Vec3::Y * if time % 4.0 < 2.0 { 1.0 } else { -1.0 },
                ..Velocity::default()
            },
            ..of("lift", vec![moving(Vec3::new(20.0, 0.5, 20.0), Vec3::Y * -0.5)], Vec3::ZERO, ahead, 5.0)
        },
        Ground {
            moves: |_| Velocity { angular: Vec3::Y * 0.7, ..Velocity::default() },
            ..of(
                "turntable, idle",
                vec![moving(Vec3::new(4.0, 0.5, 4.0), Vec3::Y * -0.5)],
                Vec3::X * 1.5,
                Vec3::ZERO,
                5.0,
            )
        },
    ]
}

/// Returns the vertices of the two feet, by mesh and primitive.
fn foot_vertices(def: &CharacterDef) -> [Vec<[usize; 3]>; 2] {
    let rig = &def.rig;
    ["left", "right"].map(|side| {
        let parts = [format!("{side}Foot"), format!("{side}Toes")];
        let mut found = Vec::new();
        for (m, mesh) in rig.meshes.iter().enumerate() {
            let Some(skin) = mesh.skin.map(|skin| &rig.skins[skin]) else { continue };
            for (p, primitive) in mesh.primitives.iter().enumerate() {
                let of_foot = |&v: &usize| {
                    let joint = skin.joints[usize::from(primitive.joints[v][0])];
                    parts.contains(&rig.joints[joint].name)
                };
                found.extend((0..primitive.positions.len()).filter(of_foot).map(|v| [m, p, v]));
            }
        }
        found
    })
}

fn places(
    def: &CharacterDef,
    pose: &[LocalTransform],
    place: Transform,
    feet: &[Vec<[usize; 3]>; 2],
) -> [Vec<Vec3>; 2] {
    let (mut model, mut skinned) = (Vec::new(), Vec::new());
    local_to_model(&def.rig, pose, &def.mapping().world_from_model(place), &mut model);
    let (mut positions, mut normals): (Vec<Vec3>, Vec<Vec3>) = (Vec::new(), Vec::new());
    for (m, mesh) in def.rig.meshes.iter().enumerate() {
        for p in 0..mesh.primitives.len() {
            skin_vertices(&def.rig, m, p, &model, &mut positions, &mut normals);
            skinned.push(((m, p), positions.clone()));
        }
    }
    let at = |&[m, p, v]: &[usize; 3]| {
        skinned.iter().find(|(key, _)| *key == (m, p)).map(|(_, places)| places[v]).expect("it is skinned")
    };
    [0, 1].map(|foot| feet[foot].iter().map(at).collect())
}

/// Metrics of a walk.
#[derive(Default)]
struct Found {
    /// Steps in which a clip's foot stands, and of these, steps in which the drawn sole is on the ground.
    stance: u32,
    on: u32,
    /// Largest depth of a drawn sole, metres.
    deepest: f32,
    /// Displacement of the standing point in each stance, metres.
    slides: Vec<f32>,
    /// Largest change of velocity of a foot in a step, m/s.
    jerk: f32,
}

/// A foot in the previous step.
struct Foot {
    shown: Vec<Vec3>,
    clip: Vec<Vec3>,
    stands: bool,
    slide: Vec3,
    steps: u32,
}

/// A walk in progress.
struct Walk<'a> {
    ground: &'a Ground,
    def: Arc<CharacterDef>,
    world: World,
    bodies: Vec<BodyId>,
    character: Character,
    vertices: [Vec<[usize; 3]>; 2],
    found: Found,
    feet: [Option<Foot>; 2],
    ankles: [Vec<Vec3>; 2],
}

fn level(v: Vec3) -> Vec3 {
    Vec3::new(v.x, 0.0, v.z)
}

impl Walk<'_> {
    /// Returns the distance of a point from the ground, negative inside.
    fn gap(&self, at: Vec3) -> f32 {
        let ray = Ray { origin: at + Vec3::Y * 0.6, direction: Vec3::Y * -3.0 };
        let hit = self.world.query().filter(QueryFilter::without(self.character.bodies())).first(&ray);
        let over = at.y - hit.map_or(-100.0, |hit| hit.point.y);
        if over < 0.0 { -min(-over, (self.ground.edge)(at)) } else { over }
    }

    fn step(&mut self, time: f32) -> Transform {
        if self.ground.bodies[0].kind == BodyKind::Kinematic {
            self.world.set_velocity(self.bodies[0], (self.ground.moves)(time));
        }
        let from = self.world.transform(self.bodies[0]);
        self.world.step();
        self.character.update(&mut self.world);
        self.world.transform(self.bodies[0]) * from.inverse()
    }

    fn look(&mut self, carried: Transform) {
        let place = self.character.world_from_character();
        let shown = places(&self.def, self.character.pose(), place, &self.vertices);
        let pose: Vec<LocalTransform> = self.character.animator().pose().iter().collect();
        let clip = places(&self.def, &pose, place, &self.vertices);
        for (foot, (shown, clip)) in shown.into_iter().zip(clip).enumerate() {
            self.look_at(foot, shown, clip, carried);
        }
    }

    fn look_at(&mut self, foot: usize, shown: Vec<Vec3>, clip: Vec<Vec3>, carried: Transform) {
        let dt = self.world.def().dt();
        let gaps: Vec<f32> = shown.iter().map(|&at| self.gap(at)).collect();
        let nearest = (0..gaps.len()).reduce(|a, b| if gaps[b] < gaps[a] { b } else { a });
        let nearest = nearest.expect("a foot has skin");
        let least = gaps[nearest];
        self.found.deepest = max(self.found.deepest, -least);
        self.ankles[foot].push(shown[0]);
        if let [.., a, b, c] = self.ankles[foot][..] {
            self.found.jerk = max(self.found.jerk, (c - b - (b - a)).length() / dt);
        }
        let floor = self.character.world_from_character().translation.y;
        let low = lowest(&clip);
        let over_ground = |now: Vec3, before: Vec3| level(now - carried.point(before));
        let (mut stands, mut slide, mut steps) = (false, Vec3::ZERO, 0);
        if let Some(was) = &self.feet[foot] {
            let speed = over_ground(clip[low], was.clip[low]).length() / dt;
            stands = clip[low].y - floor < STANDS.0 && speed < STANDS.1;
            if stands {
                self.found.stance += 1;
                self.found.on += u32::from(least.abs() <= ON);
                let way = over_ground(shown[nearest], was.shown[nearest]);
                (slide, steps) = if was.stands { (was.slide + way, was.steps + 1) } else { (Vec3::ZERO, 1) };
            } else if was.stands && was.steps > 5 {
                self.found.slides.push(was.slide.length());
            }
        }
        self.feet[foot] = Some(Foot { shown, clip, stands, slide, steps });
    }
}

fn lowest(places: &[Vec3]) -> usize {
    (0..places.len()).reduce(|a, b| if places[b].y < places[a].y { b } else { a }).expect("a foot has skin")
}

fn walks(def: &Arc<CharacterDef>, ground: &Ground) -> Found {
    let mut world = World::new(WorldDef::default());
    let bodies: Vec<BodyId> = ground.bodies.iter().map(|body| world.add_body(body)).collect();
    let mut character = Character::spawn(&mut world, def, Transform::from_translation(ground.start));
    character.set_move(ground.walk);
    character.face(ground.walk);
    let mut walk = Walk {
        ground,
        def: def.clone(),
        world,
        bodies,
        character,
        vertices: foot_vertices(def),
        found: Found::default(),
        feet: [None, None],
        ankles: Default::default(),
    };
    for step in 0..(ground.seconds * 60.0) as u32 {
        let carried = walk.step(step as f32 / 60.0);
        // The first steps start in the air, at the mover's margin, and in mid-stride.
        if step >= 45 {
            assert!(walk.character.state() == State::Animated, "{}", ground.name);
            walk.look(carried);
        }
    }
    let last = walk.feet.iter().flatten().filter(|foot| foot.stands && foot.steps > 5);
    walk.found.slides.extend(last.map(|foot| foot.slide.length()).collect::<Vec<_>>());
    walk.found.slides.sort_unstable_by(f32::total_cmp);
    walk.found
}

fn told(def: &Arc<CharacterDef>, ground: &Ground) -> ([f32; 4], String) {
    let found = walks(def, ground);
    let on = found.on as f32 / found.stance as f32;
    let (median, most) = (found.slides[found.slides.len() / 2], found.slides[found.slides.len() - 1]);
    let text = format!(
        "{}: {:.0} % of {} steps of stance within 2 cm, deepest {:.1} cm, slide {:.1} cm, at most {:.1}, {:.1} m/s in a step",
        ground.name,
        100.0 * on,
        found.stance,
        100.0 * found.deepest,
        100.0 * median,
        100.0 * most,
        found.jerk
    );
    println!("{text}");
    ([on, found.deepest, median, most], text)
}

/// A sole stands on the ground. Toes briefly pass through the edge of a step as the foot is lifted over it.
#[test]
fn feet_stand_on_the_ground_in_every_scene() {
    let def = shared(sinew::mannequin::character());
    for ground in grounds() {
        let ([on, deepest, median, most], text) = told(&def, &ground);
        let may_be = match ground.name {
            "stairs up" => 0.07,
            "stairs down" => 0.05,
            _ => 0.04,
        };
        assert!(on >= 0.95 && deepest < may_be && median < 0.01 && most < 0.03, "{text}");
    }
}

/// The box of a walking foot does not bend at the toes; it rotates about the ankle instead of entering the floor.
#[test]
fn bodies_of_feet_stay_out_of_the_floor() {
    let def = shared(sinew::mannequin::character());
    let mut world = World::new(WorldDef::default());
    let ground = world.add_body(&floor());
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    character.set_move(Vec3::Z * 1.2);
    let mut deepest = 0.0;
    for step in 0..300 {
        world.step();
        character.update(&mut world);
        // The first steps start in the air, at the mover's margin, and in mid-stride.
        if step >= 45 {
            let depth = |&body: &BodyId| world.overlap(body, ground);
            deepest = character.bodies().iter().map(depth).fold(deepest, max);
        }
    }
    assert!(deepest < 0.01, "a foot's body is {:.1} cm in the floor", 100.0 * deepest);
}

/// No joint of a walker jumps for a frame: it would move back and forth in three frames.
#[test]
fn joints_of_a_walker_do_not_shake() {
    let def = shared(sinew::mannequin::character());
    for speed in [0.5, 0.8, 1.0, 1.1, 1.2, 1.3, 1.4, 1.7] {
        let mut world = World::new(WorldDef::default());
        world.add_body(&floor());
        let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
        let (mut frames, mut model): (Vec<Vec<Vec3>>, _) = (Vec::new(), Vec::new());
        for step in 0..300 {
            let turn = Rotation::from_axis_angle(Vec3::Y, 0.01 * step as f32);
            character.set_move(turn * Vec3::Z * speed);
            character.face(turn * Vec3::Z);
            world.step();
            character.update(&mut world);
            let root = def.mapping().world_from_model(character.world_from_character());
            local_to_model(&def.rig, character.pose(), &root, &mut model);
            frames.push(def.ragdoll.bodies.iter().map(|body| model[body.joint].translation).collect());
            let [.., a, b, c, d] = &frames[..] else { continue };
            for (index, body) in def.ragdoll.bodies.iter().enumerate() {
                let ways = [b[index] - a[index], c[index] - b[index], d[index] - c[index]];
                let reverses = ways.windows(2).all(|pair| pair[0].dot(pair[1]) < 0.0);
                let shakes = reverses && ways.iter().all(|way| way.length() > 0.003);
                assert!(!shakes, "{speed} m/s, step {step}: {} moves by {ways:?} m", body.role);
            }
        }
    }
}

/// In the past a body that its pose had left behind moved twice as far, and back in the next step.
#[test]
fn bodies_do_not_overshoot_a_jump() {
    let def = shared(sinew::mannequin::character());
    let mut world = World::new(WorldDef::default());
    world.add_body(&floor());
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    let mut fastest = 0.0;
    for step in 0..70 {
        if step == 60 {
            let mover = character.mover().expect("the character stands");
            let place = world.mover(mover).position();
            world.set_mover_position(mover, place + Vec3::X * 0.15);
        }
        world.step();
        character.update(&mut world);
        if step >= 60 {
            let speed = |&body: &BodyId| world.velocity(body).linear.length();
            fastest = character.bodies().iter().map(speed).fold(fastest, max);
        }
    }
    // The jump itself is 9 m/s.
    assert!(fastest < 12.0, "a body moves at {fastest} m/s");
}
