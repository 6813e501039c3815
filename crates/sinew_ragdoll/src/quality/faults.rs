//! Faults of a ragdoll, or of its bake, that no single metric shows.

use super::Verdict;
use crate::bake::{BakeInput, Baked, Frame, bake};
use crate::character::{CharacterEvent, State};
use crate::def::{RagdollBodyDef, RagdollDef};
use crate::skin::surface::Surface;
use crate::tuning::{
    FALLEN_OUT, GROUND_REACH, HEAVY_PART, LIES_FLAT, NEVER_STILL, OFF_FLOOR, ON_A_SIDE, OTHER_SIZE, PROPPED,
    PROPPED_FOR, PROPPED_SLOW, STARTS_INSIDE, STILL_ON_LEGS, STILL_UPRIGHT, TOPPLES, WALKS_ON_AIR,
    WALKS_ON_AIR_FOR,
};
use sinew_anim::{LocalTransform, Rig, Role, local_to_model};
use sinew_math::{Affine, Transform, Vec3, max, min, trig};
use sinew_physics::ray::Ray;
use sinew_physics::{BodyKind, OverlapWith, PenetrationOf, Probe, Shape, World, WorldDef};

/// Number of joints with skin from which a ragdoll of a single body is a fault. Few characters of one part have as
/// many.
const MANY_JOINTS: usize = 8;
/// Number of frames between two checks of an animated character.
const INSIDE_EVERY: usize = 5;
/// Number of joints with skin up to which a ragdoll of a single body is correct.
const FEW_JOINTS: usize = 2;

/// A fault, and the best verdict that it allows.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Best verdict on a ragdoll that has the fault.
    pub at_most: Verdict,
    /// Reason and remedy, one sentence.
    pub reason: String,
}

impl Fault {
    fn new(at_most: Verdict, reason: String) -> Self {
        Self { at_most, reason }
    }

    /// Lowers a verdict to what these faults allow, and adds their reasons.
    pub fn weigh(faults: &[Self], verdict: &mut Verdict, reasons: &mut Vec<String>) {
        *verdict = faults.iter().map(|fault| fault.at_most).fold(*verdict, Verdict::min);
        reasons.extend(faults.iter().map(|fault| fault.reason.clone()));
    }
}

/// Returns the faults of a definition that no fall is needed to find: a single body for a rig of many joints, and left
/// and right limbs on the same side.
///
/// # Panics
/// If the definition has no body.
pub fn faults_of_ragdoll(rig: &Rig, def: &RagdollDef) -> Vec<Fault> {
    one_body(rig, def).into_iter().chain(sides(def)).collect()
}

fn one_body(rig: &Rig, def: &RagdollDef) -> Option<Fault> {
    let mut skinned: Vec<usize> = rig.skins.iter().flat_map(|skin| skin.joints.iter().copied()).collect();
    skinned.sort_unstable();
    skinned.dedup();
    let [body] = &def.bodies[..] else { return None };
    let joints = skinned.len();
    if joints <= FEW_JOINTS {
        return None;
    }
    let at_most = if joints < MANY_JOINTS { Verdict::Usable } else { Verdict::Bad };
    let reason = format!(
        "one body, on {}, for a rig of {joints} joints with skin: it falls as a statue; --body BONE gives bones bodies, \
         --role ROLE=BONE says what they are",
        body.bone
    );
    Some(Fault::new(at_most, reason))
}

/// Returns a fault if limb roots of a human are on each other's side, or both on one side.
fn sides(def: &RagdollDef) -> Option<Fault> {
    let place = |role: &str| {
        let body = def.bodies.iter().position(|body| body.role == role)?;
        let joint = def.joints.iter().find(|joint| joint.child == body)?;
        let x = (def.bodies[body].character_from_body * joint.frame_child).translation.x;
        Some((x - def.bodies[0].character_from_body.translation.x, def.bodies[body].bone.as_str()))
    };
    let least = ON_A_SIDE * def.height;
    let pairs = ["UpperArm", "UpperLeg"].map(|part| {
        let ((left, left_bone), (right, right_bone)) =
            (place(&format!("left{part}"))?, place(&format!("right{part}"))?);
        Some((left, right, left_bone, right_bone))
    });
    let one_side = |left: f32, right: f32| min(left.abs(), right.abs()) > least && left * right > 0.0;
    let crossed = |left: f32, right: f32| left < -least && right > least;
    let pairs = pairs.into_iter().flatten();
    let mut found: Vec<Fault> = pairs
        .filter_map(|(left, right, left_bone, right_bone)| {
            let help = "--role ROLE=BONE says which is which";
            if one_side(left, right) {
                let reason = format!("{left_bone} and {right_bone} are taken for left and right, but lie on the same side; {help}");
                return Some(Fault::new(Verdict::Bad, reason));
            }
            crossed(left, right).then(|| {
                let reason = format!("{left_bone} is taken for left and {right_bone} for right, but they lie on each other's side; {help}");
                Fault::new(Verdict::Usable, reason)
            })
        })
        .collect();
    found.sort_by_key(|fault| fault.at_most);
    found.into_iter().next()
}

/// Returns the faults of a baked character: out of the world, inside its static bodies, in the air, never still, still
/// upright, propped on its limbs, or drawn at another size during a get-up.
///
/// # Panics
/// If the bake does not belong to the input.
pub fn faults_of_bake(input: &BakeInput<'_>, baked: &Baked) -> Vec<Fault> {
    let fault = fell_out(input, baked).or_else(|| inside(input, baked)).or_else(|| in_air(input, baked));
    let fault = fault.or_else(|| never_still(input, baked));
    let fault = fault.or_else(|| stays_standing(input, baked)).or_else(|| props_itself(input, baked));
    fault.into_iter().chain(changes_size(input, baked)).collect()
}

/// Returns a fault if a character is drawn at another size during a get-up than in the clip before: the clip scales its
/// bones and the get-up does not.
fn changes_size(input: &BakeInput<'_>, baked: &Baked) -> Option<Fault> {
    let first = &input.character.ragdoll.bodies[0];
    let mut model = Vec::new();
    let mut size = |pose: &[LocalTransform]| {
        local_to_model(&input.character.rig, pose, &Affine::IDENTITY, &mut model);
        // Under a parent with unequal scales, rotation changes the lengths of the axes, but not the volume.
        trig::pow(model[first.joint].linear.determinant().abs(), 1.0 / 3.0)
    };
    let by_clip = baked.frames.iter().find(|frame| frame.state == State::Animated)?;
    let by_clip = size(&by_clip.pose);
    // The size of the previous pose fades out in the first frames, so use the frame whose size differs most from it.
    let rising = baked.frames.iter().filter(|frame| frame.state == State::GettingUp);
    let times = rising.map(|frame| size(&frame.pose) / by_clip);
    let off = |times: f32| max(times, 1.0 / times);
    let times = times.reduce(|a, b| if off(b) > off(a) { b } else { a })?;
    // Comparisons with NaN are false.
    let is_alike = times < OTHER_SIZE && times > 1.0 / OTHER_SIZE;
    (!is_alike).then(|| {
        let reason = format!(
            "getting up it is drawn {times:.2} times as large as before its fall, for its clip scales {}; --clips FILE brings a clip to \
             get up by that does so, too, `bake --get-up none` leaves it lying",
            first.bone
        );
        Fault::new(Verdict::Bad, reason)
    })
}

/// Returns time (seconds) and index of the first body of a falling character that is far below all static geometry.
///
/// # Panics
/// If the bake does not belong to the input.
pub fn fallen_out(input: &BakeInput<'_>, baked: &Baked) -> Option<(f32, usize)> {
    let floor = lowest_of(input)?;
    let (rig, def) = (&input.character.rig, &input.character.ragdoll);
    let least = floor - max(FALLEN_OUT, def.height);
    let (mut model, mut bodies) = (Vec::new(), Vec::new());
    for frame in baked.frames.iter().filter(|frame| frame.state != State::Animated) {
        local_to_model(rig, &frame.pose, &Affine::IDENTITY, &mut model);
        let mapping = input.character.mapping();
        mapping.bodies_from_model(&model, input.world_from_character, &mut bodies);
        // NaN counts as out of the world too.
        let is_in = |y: f32| y >= least;
        let is_out = |place: &Transform| !is_in(place.translation.y);
        if let Some(body) = bodies.iter().position(is_out) {
            return Some((frame.time, body));
        }
    }
    None
}

fn fell_out(input: &BakeInput<'_>, baked: &Baked) -> Option<Fault> {
    let (time, body) = fallen_out(input, baked)?;
    let reason = format!(
        "it falls out of the world: {} is below everything that stands at {time:.1} s; --at X,Y,Z moves it to firm ground, --floor Y \
         adds a floor",
        input.character.ragdoll.bodies[body].bone
    );
    Some(Fault::new(Verdict::Bad, reason))
}

/// Returns a fault if a body starts deep in static geometry, or if the pelvis of a character that its clips move is
/// inside static geometry later.
fn inside(input: &BakeInput<'_>, baked: &Baked) -> Option<Fault> {
    let (rig, def) = (&input.character.rig, &input.character.ragdoll);
    let mut world = World::new(WorldDef::default());
    for body in input.bodies.iter().filter(|body| body.kind == BodyKind::Static) {
        world.add_body(body);
    }
    let (mut model, mut bodies) = (Vec::new(), Vec::new());
    let mut bodies_of = |frame: &Frame| {
        local_to_model(rig, &frame.pose, &Affine::IDENTITY, &mut model);
        input.character.mapping().bodies_from_model(&model, input.world_from_character, &mut bodies);
        bodies.clone()
    };
    let first = baked.frames.first()?;
    let starts = bodies_of(first);
    let depth = |(body, place): (&RagdollBodyDef, &Transform)| {
        let probe = PenetrationOf(Probe::new(body.shape.clone(), *place));
        world.query().first(&probe).map_or(0.0, |found| found.depth)
    };
    let depths = def.bodies.iter().zip(&starts).map(depth).enumerate();
    let (body, deepest) = depths.reduce(|a, b| if b.1 > a.1 { b } else { a })?;
    let help = "--at X,Y,Z sets another place";
    if deepest > STARTS_INSIDE * def.height {
        let bone = &def.bodies[body].bone;
        let reason = format!("it starts inside the world: {bone} is {deepest:.2} m deep in it; {help}");
        return Some(Fault::new(Verdict::Bad, reason));
    }
    let moved = baked.frames.iter().filter(|frame| matches!(frame.state, State::Animated | State::GettingUp));
    let is_inside = |frame: &&Frame| {
        let place = bodies_of(frame)[0];
        let center = place.point(def.bodies[0].mass.center);
        world.query().any(&OverlapWith(Probe::at(Shape::Sphere { radius: 0.01 * def.height }, center)))
    };
    let frame = moved.step_by(INSIDE_EVERY).find(is_inside)?;
    let (bone, time) = (&def.bodies[0].bone, frame.time);
    let reason = format!("its clip moves it into the world: {bone} is inside it at {time:.1} s; {help}");
    Some(Fault::new(Verdict::Bad, reason))
}

/// Returns a fault if clips move a character over nothing: beyond an edge of its ground, or high above ground from the
/// start.
fn in_air(input: &BakeInput<'_>, baked: &Baked) -> Option<Fault> {
    // Keyframed bodies may carry the character.
    if !input.movers.is_empty() || !input.bodies.iter().any(|body| body.kind == BodyKind::Static) {
        return None;
    }
    let mut world = World::new(WorldDef::default());
    for body in input.bodies.iter().filter(|body| body.kind != BodyKind::Dynamic) {
        world.add_body(body);
    }
    let under = |from: Vec3| {
        let ray = Ray { origin: from, direction: Vec3::Y * -GROUND_REACH };
        world.query().first(&ray).map_or(f32::NEG_INFINITY, |hit| hit.point.y)
    };
    let start = input.world_from_character.translation;
    let stood = under(start + Vec3::Y * (0.5 * input.character.ragdoll.height));
    if start.y - stood > WALKS_ON_AIR {
        let reason = format!(
            "it starts in the air, {:.2} m over the ground; --at X,Y,Z sets another place",
            start.y - stood
        );
        return Some(Fault::new(Verdict::Usable, reason));
    }
    let gap = |frame: &Frame| {
        let places = bodies_in(input, frame);
        let lowest = places.iter().zip(&input.character.ragdoll.bodies);
        let lowest = lowest.map(|(place, body)| body.shape.aabb(place).min.y).fold(f32::INFINITY, min);
        let ground = under(places[0].translation);
        if ground < stood - WALKS_ON_AIR { lowest - ground } else { 0.0 }
    };
    let mut in_air = 0;
    for frame in &baked.frames {
        let is_in_air = frame.state == State::Animated && gap(frame) > WALKS_ON_AIR;
        in_air = if is_in_air { in_air + 1 } else { 0 };
        if in_air as f32 > WALKS_ON_AIR_FOR * input.fps {
            let reason = format!(
                "its clip moves it on in the air: nothing is under it at {:.1} s; --at X,Y,Z and --facing DEG keep it on the ground, \
                 --floor Y adds a floor",
                frame.time
            );
            return Some(Fault::new(Verdict::Bad, reason));
        }
    }
    None
}

/// Returns the height of the lowest point of all static geometry, metres; `None` without any.
fn lowest_of(input: &BakeInput<'_>) -> Option<f32> {
    let mut world = World::new(WorldDef::default());
    let standing =
        input.bodies.iter().filter(|body| body.kind == BodyKind::Static && !body.shapes.is_empty());
    let heights = standing.map(|body| {
        let is_plane = body.shapes.iter().any(|shape| shape.shape == sinew_physics::Shape::HalfSpace);
        let id = world.add_body(body);
        if is_plane { body.position.y } else { world.bounds(id).min.y }
    });
    heights.reduce(min)
}

fn never_still(input: &BakeInput<'_>, baked: &Baked) -> Option<Fault> {
    let limp = baked.frames.iter().filter(|frame| frame.state == State::Limp).count() as f32 / input.fps;
    let settles = |(_, event): &(f32, CharacterEvent)| matches!(event, CharacterEvent::Settled { .. });
    let is_still = baked.quality.settled_s.is_some() || baked.events.iter().any(settles);
    (limp >= NEVER_STILL && !is_still).then(|| {
        let root = &input.character.ragdoll.bodies[0].bone;
        let reason = format!(
            "it never lies still in {limp:.1} s, seen at {root}; `ragdoll doctor` says which bodies and limits are at odds"
        );
        Fault::new(Verdict::Usable, reason)
    })
}

/// Returns the input of a bake with the weakest [push](BakeInput::topple) after which the character lies flat: forward,
/// or sideways for a creature on its legs, also on folded ones. If the character stays upright or on its legs and lies
/// flat after none of the pushes, returns the weakest push that makes it fall. `None` if it lies flat without a push,
/// or if no push makes it fall.
///
/// # Panics
/// If the bake does not belong to the input.
pub fn toppled<'a>(input: &BakeInput<'a>, baked: &Baked) -> Option<BakeInput<'a>> {
    let forward = input.world_from_character.rotation * Vec3::Z;
    let sideways = input.world_from_character.rotation * Vec3::X;
    let held = held_on_legs(input, baked).map_or(0.0, |held| held.share());
    let way = if stays_upright(input, baked).is_some() {
        forward
    } else if held > LIES_FLAT {
        sideways
    } else {
        return None;
    };
    let speed = (input.world.gravity.length() * input.character.ragdoll.height).sqrt();
    let mut fallen = None;
    for share in TOPPLES {
        let pushed = BakeInput { topple: way * (share * speed), ..input.clone() };
        let result = bake(&pushed);
        if stays_standing(&pushed, &result).is_some() {
            continue;
        }
        if held_on_legs(&pushed, &result).is_none_or(|held| held.share() <= LIES_FLAT) {
            return Some(pushed);
        }
        fallen = fallen.or(Some(pushed));
    }
    fallen.filter(|_| stays_standing(input, baked).is_some())
}

/// Returns a fault if a character that goes limp does not fall.
fn stays_standing(input: &BakeInput<'_>, baked: &Baked) -> Option<Fault> {
    stays_upright(input, baked).or_else(|| stays_on_legs(input, baked))
}

/// Returns the first and the last frame of the first limp phase, if the character lies still there.
fn let_go_and_still(baked: &Baked) -> Option<[&Frame; 2]> {
    baked.quality.settled_s?;
    let is_limp = |frame: &Frame| frame.state == State::Limp;
    let first = baked.frames.iter().position(is_limp)?;
    let last = first + baked.frames[first..].iter().take_while(|frame| is_limp(frame)).count() - 1;
    Some([first, last].map(|frame| &baked.frames[frame]))
}

/// Returns the positions of the bodies in a frame, world.
fn bodies_in(input: &BakeInput<'_>, frame: &Frame) -> Vec<Transform> {
    let (mut model, mut bodies) = (Vec::new(), Vec::new());
    local_to_model(&input.character.rig, &frame.pose, &Affine::IDENTITY, &mut model);
    input.character.mapping().bodies_from_model(&model, input.world_from_character, &mut bodies);
    bodies
}

/// Returns the height of the lowest point of each body's skin in a frame, world; ∞ for a body without skin.
fn lowest_skin(input: &BakeInput<'_>, baked: &Baked, frame: &Frame) -> Vec<f32> {
    let (rig, def) = (&input.character.rig, &input.character.ragdoll);
    let surface = Surface::of(rig, def);
    let (mut model, mut palette) = (Vec::new(), Vec::new());
    local_to_model(rig, &frame.pose, &baked.world_from_model, &mut model);
    surface.palette(&model, &mut palette);
    let mut lowest = vec![f32::INFINITY; def.bodies.len()];
    for &vertex in &surface.sample {
        if let Some(body) = surface.owner(vertex) {
            lowest[body] = min(lowest[body], surface.place(&palette, vertex).y);
        }
    }
    lowest
}

/// Returns a fault if a body taller than wide has its highest part at rest about as high as at release.
fn stays_upright(input: &BakeInput<'_>, baked: &Baked) -> Option<Fault> {
    let def = &input.character.ragdoll;
    let floor = input.world_from_character.translation.y;
    let [start, end] = let_go_and_still(baked)?
        .map(|frame| bodies_in(input, frame).iter().map(|place| place.translation).collect::<Vec<_>>());
    let top = (0..start.len()).reduce(|a, b| if start[b].y > start[a].y { b } else { a })?;
    let [begins, ends] = [&start, &end].map(|places| places[top].y - floor);
    let flat = |a: Vec3, b: Vec3| Vec3::new(a.x - b.x, 0.0, a.z - b.z).length();
    // Measure by the footprint, so that outstretched arms do not count. If no part is low, use the whole body.
    let is_low = |at: &&Vec3| at.y - floor < 0.5 * begins;
    let low: Vec<Vec3> = end.iter().filter(is_low).copied().collect();
    let stance = if low.is_empty() { &end } else { &low };
    let wide = stance.iter().flat_map(|&a| stance.iter().map(move |&b| flat(a, b))).fold(0.0, max);
    (begins > wide && ends > STILL_UPRIGHT * begins).then(|| {
        let bone = &def.bodies[top].bone;
        let reason = format!(
            "limp, it stays upright: {bone} is {ends:.2} m over the floor, {begins:.2} m when it was let go; {} pushes it over",
            stronger(input)
        );
        Fault::new(Verdict::Usable, reason)
    })
}

/// Returns a fault if a limp human holds its hips up for long while it hardly moves: on hands and feet, on its head, or
/// kneeling. It may lie down later.
fn props_itself(input: &BakeInput<'_>, baked: &Baked) -> Option<Fault> {
    let def = &input.character.ragdoll;
    let hips = (def.bodies[0].role == "hips").then_some(def.bodies[0].joint)?;
    let high = PROPPED * (input.character.bind()[hips].translation.y);
    let floor = input.world_from_character.translation.y;
    let (mut longest, mut run, mut top) = (0.0_f32, 0.0, 0.0_f32);
    let mut last: Option<(Vec3, f32)> = None;
    let mut model = Vec::new();
    for frame in &baked.frames {
        if frame.state != State::Limp {
            last = None;
            continue;
        }
        local_to_model(&input.character.rig, &frame.pose, &baked.world_from_model, &mut model);
        let place = model[hips].translation;
        if let Some((before, time)) = last {
            let seconds = frame.time - time;
            let is_slow = (place - before).length() < PROPPED_SLOW * seconds;
            run = if is_slow && place.y - floor > high { run + seconds } else { 0.0 };
            if run > longest {
                (longest, top) = (run, place.y - floor);
            }
        }
        last = Some((place, frame.time));
    }
    (longest > PROPPED_FOR).then(|| {
        let reason = format!(
            "limp, it props its hips up {top:.2} m over the floor for {longest:.1} s, longer than {PROPPED_FOR} s; \
             --hit or --limp-at gives another fall"
        );
        Fault::new(Verdict::Usable, reason)
    })
}

/// Option of `bake` that pushes over a character that stays upright.
fn stronger(input: &BakeInput<'_>) -> &'static str {
    if input.hits.is_empty() { "--hit" } else { "a stronger --hit" }
}

/// Height of a creature's trunk over the floor while limp.
struct OnLegs {
    /// Body of the trunk that is held highest at rest.
    body: usize,
    /// Mean height of the trunk at release, metres.
    begins: f32,
    /// Height of `body` at rest, metres.
    ends: f32,
}

impl OnLegs {
    /// Height at rest as a share of that at release.
    fn share(&self) -> f32 {
        self.ends / self.begins
    }
}

/// Returns how high the trunk of a creature that stood on its legs is held at rest.
fn held_on_legs(input: &BakeInput<'_>, baked: &Baked) -> Option<OnLegs> {
    let def = &input.character.ragdoll;
    let floor = input.world_from_character.translation.y;
    // The hind part of a trunk may count as the root of the tail, or as that of a limb with two legs on it.
    let is_trunk = |&i: &usize| match Role::from_name(&def.bodies[i].role) {
        Some(Role::SpineSegment(_) | Role::TailSegment(_)) => true,
        Some(Role::LimbSegment { .. }) => def.joints.iter().filter(|joint| joint.parent == i).count() > 1,
        _ => false,
    };
    let trunk: Vec<usize> = (0..def.bodies.len()).filter(is_trunk).collect();
    if trunk.is_empty() || def.bodies[0].role == "hips" {
        return None;
    }
    let all: f32 = trunk.iter().map(|&i| def.bodies[i].mass.mass).sum();
    let share = |i: usize| def.bodies[i].mass.mass / all;
    let [first, last] = let_go_and_still(baked)?;
    let skin = lowest_skin(input, baked, last);
    let [first, last] = [first, last].map(|frame| bodies_in(input, frame));
    let under = |places: &[Transform], i: usize| max(def.bodies[i].shape.aabb(&places[i]).min.y - floor, 0.0);
    let begins: f32 = trunk.iter().map(|&i| share(i) * under(&first, i)).sum();
    // A rotated shape reaches lower than the skin; where legs hold a part up, the skin counts.
    let is_limb =
        |body: usize| matches!(Role::from_name(&def.bodies[body].role), Some(Role::LimbSegment { .. }));
    let bears_limb = |i: usize| def.joints.iter().any(|joint| joint.parent == i && is_limb(joint.child));
    let held = |i: usize| {
        let skin = if bears_limb(i) && skin[i].is_finite() { skin[i] - floor } else { 0.0 };
        max(under(&last, i), skin)
    };
    let heavy = trunk.iter().filter(|&&i| share(i) > HEAVY_PART);
    let (ends, body) = heavy.map(|&i| (held(i), i)).reduce(|a, b| if b.0 > a.0 { b } else { a })?;
    (begins > OFF_FLOOR * def.height).then_some(OnLegs { body, begins, ends })
}

/// Returns a fault if a heavy part of the trunk of a creature that stood on its legs is held off the floor at rest.
fn stays_on_legs(input: &BakeInput<'_>, baked: &Baked) -> Option<Fault> {
    let held = held_on_legs(input, baked)?;
    (held.share() > STILL_ON_LEGS).then(|| {
        let bone = &input.character.ragdoll.bodies[held.body].bone;
        let reason = format!(
            "limp, it stays on its legs: {bone} is {:.2} m over the floor, its trunk {:.2} m when it was let go; {} pushes it over",
            held.ends,
            held.begins,
            stronger(input)
        );
        Fault::new(Verdict::Usable, reason)
    })
}
