//! A skirt and a cape of bones worn during a walk, a fall, and getting up.

use crate::dressed::{CAPE, SKIRT, dressed};
use crate::framework::actors::Figure;
use crate::framework::camera_hint::{CameraHint, Trails};
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::floor;
use crate::scenes::characters::worn::{Wear, stretch, torn};
use sinew::anim::local_to_model;
use sinew::math::{Affine, ReadError, Reader, Transform, Vec3, Writer, max};
use sinew::physics::boxes::{Aabb, Overlap};
use sinew::physics::particles::ParticleGroup;
use sinew::physics::{BodyId, GroupId, World};
use sinew::ragdoll::Character;
use std::sync::Arc;

pub(in crate::scenes) const SKIRT_SCENE: Scene = Scene {
    chapter: Chapter::Characters,
    name: "skirt",
    about: "the mannequin in a skirt and a cape of bones walks, is hit, lies, gets up and walks on",
    steps: 600,
    settings: &[
        Setting::number("impulse", 110.0, (0.0, 200.0), "impulse of the hit in the side, N·s"),
        Setting::number("area_density", 0.4, (0.1, 2.0), "area density of the cloth, kg/m²"),
    ],
    build: skirt,
};

/// Time of the hit, seconds.
const HIT_AT: f64 = 1.5;
/// Role of the body that is hit.
const SHOULDERS: &str = "chest";

fn skirt(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    let density = setup.number("area_density");
    let def = Arc::new(dressed(&[&SKIRT, &CAPE], |garment| garment.area_density = density));
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    character.set_move(Vec3::Z * sinew::mannequin::WALK_SPEED);
    let mut script = Dressed {
        character,
        impulse: setup.number("impulse"),
        was_hit: false,
        model: Vec::new(),
        watch: Watch::default(),
    };
    script.show();
    Instance::new(world, script)
}

#[derive(Clone, Copy, Default)]
struct Watch {
    /// Largest depth of a free particle's centre in a body of the wearer, metres; 0 if all were outside.
    deepest_in_wearer: f32,
    /// Largest depth of a free particle that is pinched between two bodies, metres.
    deepest_pinched: f32,
    /// Largest depth of a free particle in a body that is not part of the wearer, metres.
    deepest_in_world: f32,
    /// Speed of the fastest particle, m/s.
    fastest: f32,
    wear: Wear,
}

struct Dressed {
    character: Character,
    /// Impulse of the hit, N·s.
    impulse: f32,
    was_hit: bool,
    /// World from joint.
    model: Vec<Affine>,
    watch: Watch,
}

/// Number of springs of a garment along both directions, without the diagonals of cells.
fn threads(group: &ParticleGroup, closed: bool) -> usize {
    let lines = group.attachments().len();
    let rows = group.positions().len() / lines - 1;
    (lines + lines - usize::from(!closed)) * rows
}

impl Dressed {
    fn show(&mut self) {
        let root = self.character.world_from_model();
        local_to_model(&self.character.def().rig, self.character.pose(), &root, &mut self.model);
    }

    /// Returns the largest depths of free particles' centres, metres: in a body of the wearer, in another body, and of
    /// particles that touch two bodies; 0 if all are outside. A particle between two touching bodies, such as thigh and
    /// belly, cannot be outside of both.
    fn deepest(&self, world: &World, id: GroupId) -> [f32; 3] {
        let (group, own) = (world.particles(id), self.character.bodies());
        let bounds = group.bounds();
        let held: Vec<u32> = group.attachments().iter().map(|held| held.particle).collect();
        let met = world.body_ids().filter(|body| group.passes().binary_search(body).is_err());
        let near: Vec<_> = met
            .filter(|&body| world.bounds(body).overlaps(&bounds))
            .flat_map(|body| world.shapes(body).map(move |shape| (own.contains(&body), shape)))
            .collect();
        let mut deepest = [0.0; 3];
        for (particle, (&position, &radius)) in group.positions().iter().zip(group.radii()).enumerate() {
            if held.contains(&(particle as u32)) {
                continue;
            }
            let (mut depths, mut touched) = ([0.0; 2], 0);
            for (is_own, (shape, frame)) in &near {
                let distance = shape.signed_distance(frame, position).0;
                let depth = &mut depths[usize::from(!is_own)];
                *depth = max(*depth, -distance);
                touched += usize::from(distance < 1.1 * radius);
            }
            let [of_own, of_others] = depths;
            if touched > 1 {
                deepest[2] = max(deepest[2], max(of_own, of_others));
            } else {
                deepest = [max(deepest[0], of_own), max(deepest[1], of_others), deepest[2]];
            }
        }
        deepest
    }

    fn look(&mut self, world: &World) {
        let mut watch = self.watch;
        let mut mean = 0.0;
        for (garment, &id) in self.character.def().garments().source().iter().zip(self.character.garments()) {
            let group = world.particles(id);
            let [in_wearer, in_world, pinched] = self.deepest(world, id);
            watch.deepest_in_wearer = max(watch.deepest_in_wearer, in_wearer);
            watch.deepest_pinched = max(watch.deepest_pinched, pinched);
            watch.deepest_in_world = max(watch.deepest_in_world, in_world);
            watch.wear.torn = max(watch.wear.torn, torn(world, group));
            watch.fastest = group.velocities().iter().fold(watch.fastest, |most, v| max(most, v.length()));
            mean = max(mean, stretch(group, threads(group, garment.closed)));
        }
        watch.wear.note_stretch(mean);
        self.watch = watch;
    }
}

impl Script for Dressed {
    fn after_step(&mut self, world: &mut World) {
        self.look(world);
        self.watch.wear.follow(world, &mut self.character);
        if !self.was_hit && world.time() >= HIT_AT {
            self.was_hit = true;
            let chest = self.character.def().body_named(SHOULDERS).expect("the character has a chest");
            self.character.hit(world, chest, Vec3::new(0.6, 0.0, -0.8) * self.impulse);
        }
        self.show();
    }

    fn save(&self, out: &mut Writer) {
        self.character.save(out);
        out.bool(self.was_hit);
        let Watch { deepest_in_wearer, deepest_pinched, deepest_in_world, fastest, wear } = self.watch;
        [deepest_in_wearer, deepest_pinched, deepest_in_world, fastest].into_iter().for_each(|x| out.f32(x));
        wear.save(out);
    }

    fn load(&mut self, bytes: &mut Reader<'_>) -> Result<(), ReadError> {
        self.character.load(bytes)?;
        self.was_hit = bytes.bool()?;
        let mut number = || bytes.f32();
        let (deepest_in_wearer, deepest_pinched, deepest_in_world) = (number()?, number()?, number()?);
        let fastest = number()?;
        let wear = Wear::load(bytes)?;
        self.watch = Watch { deepest_in_wearer, deepest_pinched, deepest_in_world, fastest, wear };
        self.show();
        Ok(())
    }

    fn work_in(&self, _: &World) -> f32 {
        self.watch.wear.work_in
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let watch = self.watch;
        let radius = f64::from(self.character.def().garments().source()[0].radius);
        let [of_cloth, of_wearer] = watch.wear.metrics(world, 10.0);
        let mut metrics = vec![
            Metric::new("deepest_in_wearer_m", watch.deepest_in_wearer, Expected::AtMost(radius)),
            Metric::new("deepest_pinched_m", watch.deepest_pinched, Expected::Anything),
            Metric::new("deepest_in_world_m", watch.deepest_in_world, Expected::AtMost(radius)),
        ];
        metrics.extend(of_cloth);
        metrics.push(Metric::new("fastest_m_s", watch.fastest, Expected::Anything));
        metrics.extend(of_wearer);
        metrics
    }

    fn camera_hint(&self) -> CameraHint {
        let bounds = Aabb { min: Vec3::new(-0.6, 0.0, -1.0), max: Vec3::new(0.6, 1.8, 4.0) };
        CameraHint { direction: Vec3::new(1.0, 0.3, 0.4), bounds: Some(bounds), trails: Trails::None }
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
