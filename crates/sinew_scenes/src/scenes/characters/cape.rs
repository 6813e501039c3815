//! A cape worn during a walk, a fall down the stairs, and getting up.

use crate::cabin::Site;
use crate::framework::actors::Figure;
use crate::framework::camera_hint::{CameraHint, Trails};
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::scenes::characters::worn::{Wear, stretch, torn};
use sinew::anim::local_to_model;
use sinew::math::{Affine, ReadError, Reader, Vec3, Writer, max};
use sinew::physics::boxes::{Aabb, Overlap};
use sinew::physics::particles::{AttachmentDef, AttachmentTarget, ClothDef, GroupDef};
use sinew::physics::{BodyId, GroupId, Material, World};
use sinew::ragdoll::Character;
use std::sync::Arc;

pub(in crate::scenes) const CAPE: Scene = Scene {
    chapter: Chapter::Characters,
    name: "cape",
    about: "the mannequin in a cape walks, is hit, falls down the stairs, gets up and walks on, still in its cape",
    steps: 720,
    settings: &[
        Setting::number("impulse", 110.0, (0.0, 200.0), "impulse of the hit in the back, N·s"),
        Setting::number("mass", 0.6, (0.1, 3.0), "mass of the cape, kg"),
    ],
    build: cape,
};

/// Position of the midpoint of the cape's upper edge, on the back between the shoulders, relative to the soles, metres.
const NAPE: Vec3 = Vec3::new(0.0, 1.42, -0.09);
/// Width and length of the cape, metres.
const WIDE: f32 = 0.36;
const LONG: f32 = 0.96;
/// Number of springs along the cape's edges; its particles are less than two radii apart.
const COLUMNS: u32 = 9;
const ROWS: u32 = 24;
/// Number of springs, from the upper edge down, that start horizontally backward from the shoulders, clear of the arms.
const STANDS_OFF: u32 = 2;
/// Radius of each particle, metres.
const RADIUS: f32 = 0.02;
/// Distance before the edge of the porch at which the wearer is hit, metres.
const HIT_BEFORE_EDGE: f32 = 0.45;
/// Role of the body that carries the cape and is hit.
const SHOULDERS: &str = "chest";

fn cape(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    let site = Site::CabinWithStairs;
    for prop in site.props() {
        world.add_body(&prop.body);
    }
    let def = Arc::new(sinew::mannequin::character());
    let spawn = site.spawn();
    let mut character = Character::spawn(&mut world, &def, spawn.world_from_character);
    character.set_move(Vec3::Z * sinew::mannequin::WALK_SPEED);
    let chest = character.bodies()[def.body_named(SHOULDERS).expect("the character has a chest")];
    let nape = spawn.world_from_character.point(NAPE);
    let group = worn(&world, chest, nape, setup.number("mass"));
    let cape = world.add_particles(&group);
    let mut script = Worn {
        character,
        cape,
        impulse: setup.number("impulse"),
        was_hit: false,
        model: Vec::new(),
        watch: Watch::default(),
    };
    script.show();
    Instance::new(world, script)
}

/// Cloth with its first row attached to points of a body.
fn worn(world: &World, body: BodyId, nape: Vec3, mass: f32) -> GroupDef {
    let mut cloth = ClothDef {
        corner: nape + Vec3::X * (0.5 * WIDE),
        across: Vec3::X * -WIDE,
        down: Vec3::NEG_Y * LONG,
        columns: COLUMNS,
        rows: ROWS,
        mass,
        stretching: 2000.0,
        shearing: 100.0,
        bending: 1e-4,
        damping_ratio: 0.2,
        radius: RADIUS,
    }
    .build();
    let thread = LONG / ROWS as f32;
    for (k, particle) in cloth.group.particles.iter_mut().enumerate() {
        let row = k as u32 / (COLUMNS + 1);
        particle.position += (Vec3::Y - Vec3::Z) * (thread * u32::min(row, STANDS_OFF) as f32);
    }
    for particle in cloth.row(0) {
        let place = cloth.group.particles[particle as usize].position;
        let target = AttachmentTarget::Body { body, point: world.transform(body).inverse_point(place) };
        cloth.group.attachments.push(AttachmentDef { particle, target });
    }
    cloth.group.tether();
    cloth.group.iterations = 4;
    cloth.group.linear_damping = 0.5;
    cloth.group.material = Material { friction: 0.3, ..Material::default() };
    cloth.group
}

#[derive(Clone, Copy, Default)]
struct Watch {
    /// Largest depth of a free particle's centre in a body of the wearer, and in any other body, metres; 0 if all were
    /// outside.
    deepest_in_wearer: f32,
    deepest_in_world: f32,
    wear: Wear,
}

struct Worn {
    character: Character,
    cape: GroupId,
    /// Impulse of the hit, N·s.
    impulse: f32,
    was_hit: bool,
    /// World from joint.
    model: Vec<Affine>,
    watch: Watch,
}

/// Number of springs along both directions, without the diagonals of cells.
const THREADS: u32 = COLUMNS * (ROWS + 1) + ROWS * (COLUMNS + 1);

impl Worn {
    fn show(&mut self) {
        let root = self.character.world_from_model();
        local_to_model(&self.character.def().rig, self.character.pose(), &root, &mut self.model);
    }

    fn chest(&self) -> usize {
        self.character.def().body_named(SHOULDERS).expect("the character has a chest")
    }

    /// Returns the depth of the deepest free particle's centre in one of the bodies, metres; negative if all are
    /// outside.
    fn deepest(&self, world: &World, bodies: impl Iterator<Item = BodyId>) -> f32 {
        let group = world.particles(self.cape);
        let bounds = group.bounds();
        let free = &group.positions()[COLUMNS as usize + 1..];
        let mut deepest = -RADIUS;
        let near = bodies.filter(|&body| world.bounds(body).overlaps(&bounds));
        for (shape, frame) in near.flat_map(|body| world.shapes(body)) {
            for &position in free {
                deepest = max(deepest, -shape.signed_distance(&frame, position).0);
            }
        }
        deepest
    }

    fn look(&mut self, world: &World) {
        let own = self.character.bodies();
        let others = world.body_ids().filter(|body| !own.contains(body));
        let [in_wearer, in_world] = [self.deepest(world, own.iter().copied()), self.deepest(world, others)];
        let group = world.particles(self.cape);
        let watch = &mut self.watch;
        watch.deepest_in_wearer = max(watch.deepest_in_wearer, in_wearer);
        watch.deepest_in_world = max(watch.deepest_in_world, in_world);
        watch.wear.torn = max(watch.wear.torn, torn(world, group));
        watch.wear.note_stretch(stretch(group, THREADS as usize));
    }

    /// Vector from the midpoint of the first row to that of the last, in the wearer's axes, metres.
    fn hem(&self, world: &World) -> Vec3 {
        let positions = world.particles(self.cape).positions();
        let row = COLUMNS as usize + 1;
        let mean = |row: &[Vec3]| row.iter().copied().sum::<Vec3>() / row.len() as f32;
        let way = mean(&positions[positions.len() - row..]) - mean(&positions[..row]);
        self.character.world_from_character().rotation.inverse() * way
    }
}

impl Script for Worn {
    fn after_step(&mut self, world: &mut World) {
        self.look(world);
        self.watch.wear.follow(world, &mut self.character);
        if !self.was_hit && self.character.world_from_character().translation.z > -HIT_BEFORE_EDGE {
            self.was_hit = true;
            self.character.hit(world, self.chest(), Vec3::Z * self.impulse);
        }
        self.show();
    }

    fn save(&self, out: &mut Writer) {
        self.character.save(out);
        out.bool(self.was_hit);
        out.f32(self.watch.deepest_in_wearer);
        out.f32(self.watch.deepest_in_world);
        self.watch.wear.save(out);
    }

    fn load(&mut self, bytes: &mut Reader<'_>) -> Result<(), ReadError> {
        self.character.load(bytes)?;
        self.was_hit = bytes.bool()?;
        let (deepest_in_wearer, deepest_in_world) = (bytes.f32()?, bytes.f32()?);
        self.watch = Watch { deepest_in_wearer, deepest_in_world, wear: Wear::load(bytes)? };
        self.show();
        Ok(())
    }

    fn work_in(&self, _: &World) -> f32 {
        self.watch.wear.work_in
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let Watch { deepest_in_wearer, deepest_in_world, wear } = self.watch;
        let radius = f64::from(RADIUS);
        let hem = self.hem(world);
        let [of_cloth, of_wearer] = wear.metrics(world, 12.0);
        let mut metrics = vec![
            Metric::new("deepest_in_wearer_m", deepest_in_wearer, Expected::AtMost(radius)),
            Metric::new("deepest_in_world_m", deepest_in_world, Expected::AtMost(radius)),
        ];
        metrics.extend(of_cloth);
        metrics.extend(of_wearer);
        metrics.extend([
            Metric::new("hem_over_shoulders_m", hem.y, Expected::AtMost(f64::from(-0.7 * LONG))),
            Metric::new("hem_before_shoulders_m", hem.z, Expected::AtMost(0.0)),
        ]);
        metrics
    }

    fn camera_hint(&self) -> CameraHint {
        let bounds = Aabb { min: Vec3::new(-0.6, 0.0, -1.0), max: Vec3::new(0.6, 2.6, 4.6) };
        CameraHint { direction: Vec3::new(1.0, 0.3, -0.25), bounds: Some(bounds), trails: Trails::None }
    }

    fn figures(&self) -> Vec<Figure<'_>> {
        vec![Figure { rig: &self.character.def().rig, world_from_joint: &self.model }]
    }

    fn bodies_of_figures(&self) -> Vec<BodyId> {
        self.character.bodies().to_vec()
    }

    fn garments_of_figures(&self) -> &[GroupId] {
        self.character.garments()
    }
}
