//! Sinew from this repository.

use crate::engine::{
    BodyState, CharacterPose, ClothSimulation, Crowd, Description, Effort, Engine, OverlapTester,
    ParticleState, RayCaster, Simulation, Unsupported,
};
use crate::scenes::{BoxPair, BoxPairs, ClothScene, Field, PlacedBox, RayScene};
use core::ops::Range;
use sinew::anim::Pose;
use sinew::math::Transform;
use sinew::physics::boxes::Obb;
use sinew::physics::boxes::batch::Pairs;
use sinew::physics::particles::{ClothDef, GroupDef};
use sinew::physics::ray::Ray;
use sinew::physics::{
    BodyDef, BodyHit, BodyId, BodyKind, GroupId, Shape, ShapeDef, Sleeping, World, WorldDef,
};
use sinew_scenes::blueprint::Blueprint;
use sinew_scenes::crowd::CrowdScene;

/// Engine Sinew.
pub struct Sinew;

impl Engine for Sinew {
    fn describe(&self) -> Description {
        let def = WorldDef::default();
        Description {
            name: "sinew",
            version: env!("SINEW_VERSION").into(),
            flags: env!("PEERS_FLAGS").into(),
            settings: format!("defaults: {} substeps", def.substeps),
        }
    }

    fn fields(&self) -> &'static [Field] {
        &[Field::Physics, Field::Figures, Field::Animation]
    }

    fn build_at(&self, scene: &Blueprint, effort: Effort) -> Result<Box<dyn Simulation>, Unsupported> {
        let (mut world, bodies, _) = scene.build();
        match effort {
            Effort::Default => {}
            Effort::Quality(quality) => world.set_world_quality(quality),
            Effort::Substeps(_) => return Err(Unsupported::new("an effort in substeps: use a quality")),
        }
        Ok(Box::new(SinewWorld { world, bodies }))
    }

    fn build_rays(&self, scene: &RayScene) -> Result<Box<dyn RayCaster>, Unsupported> {
        let mut world = World::new(WorldDef::default());
        for place in &scene.boxes {
            world.add_body(&BodyDef {
                kind: BodyKind::Static,
                position: place.world_from_box.translation,
                rotation: place.world_from_box.rotation,
                shapes: vec![ShapeDef::new(box_shape(place))],
                ..BodyDef::default()
            });
        }
        Ok(Box::new(SinewRays { world, rays: scene.rays.clone(), hits: vec![None; scene.rays.len()] }))
    }

    fn build_cloth(&self, scene: &ClothScene) -> Result<Box<dyn ClothSimulation>, Unsupported> {
        let mut world = World::new(WorldDef { sleeping: Sleeping::Off, ..WorldDef::default() });
        for obstacle in scene.obstacles() {
            world.add_body(&obstacle);
        }
        let cloth = world.add_particles(&cloth(scene));
        Ok(Box::new(SinewCloth { world, cloth }))
    }

    fn build_boxes(&self, pairs: &BoxPairs) -> Result<Box<dyn OverlapTester>, Unsupported> {
        Ok(Box::new(SinewBoxes::new(pairs)))
    }

    fn build_crowd<'a>(&self, scene: &'a CrowdScene) -> Result<Box<dyn Crowd + 'a>, Unsupported> {
        Ok(Box::new(SinewCrowd(sinew_scenes::crowd::Crowd::new(scene.clone()))))
    }
}

fn box_shape(place: &PlacedBox) -> Shape {
    Shape::Box { half_extents: place.half_extents }
}

struct SinewWorld {
    world: World,
    bodies: Vec<BodyId>,
}

impl Simulation for SinewWorld {
    fn step(&mut self) {
        self.world.step();
    }

    fn states(&self, out: &mut Vec<BodyState>) {
        out.clear();
        out.extend(self.bodies.iter().map(|&id| {
            let velocity = self.world.velocity(id);
            BodyState {
                world_from_body: self.world.transform(id),
                linear_velocity: velocity.linear,
                angular_velocity: velocity.angular,
            }
        }));
    }

    fn is_awake(&self) -> bool {
        let moves = |id| self.world.kind(id) == BodyKind::Dynamic;
        self.bodies.iter().any(|&id| moves(id) && self.world.is_awake(id))
    }
}

/// Stiffness of a square of the cloth along its threads and along its diagonals, N/m.
const STRETCHING: f32 = 2e3;
/// Bending stiffness per width, N·m: a bend then resists as much as a distance over two cells does in Jolt's cloth.
const BENDING: f32 = 1e-3;

/// Returns the scene as built by [`ClothDef`]: both threads, both diagonals of each cell, bends over two cells; two iterations per substep.
fn cloth(scene: &ClothScene) -> GroupDef {
    let last = scene.side - 1;
    let cells = last as u32;
    let corner = scene.position(0, 0);
    let mut cloth = ClothDef {
        corner,
        across: scene.position(0, last) - corner,
        down: scene.position(last, 0) - corner,
        columns: cells,
        rows: cells,
        mass: scene.particle_mass * (cells * cells) as f32,
        stretching: STRETCHING,
        shearing: STRETCHING,
        bending: BENDING,
        damping_ratio: 0.0,
        radius: scene.particle_radius,
    }
    .build();
    for particle in &mut cloth.group.particles {
        particle.mass = scene.particle_mass;
    }
    cloth.group.hold_in_world(&scene.pinned().map(|index| index as u32));
    cloth.group.linear_damping = scene.damping;
    cloth.group.material.friction = scene.friction;
    cloth.group
}

struct SinewCloth {
    world: World,
    cloth: GroupId,
}

impl ClothSimulation for SinewCloth {
    fn step(&mut self) {
        self.world.step();
    }

    fn particles(&self, out: &mut Vec<ParticleState>) {
        let cloth = self.world.particles(self.cloth);
        let states = cloth.positions().iter().zip(cloth.velocities());
        out.clear();
        out.extend(states.map(|(&position, &velocity)| ParticleState { position, velocity }));
    }
}

struct SinewRays {
    world: World,
    rays: Vec<Ray>,
    hits: Vec<Option<BodyHit>>,
}

impl RayCaster for SinewRays {
    fn count_hits(&mut self, range: Range<usize>) -> usize {
        let hits = &mut self.hits[range.clone()];
        self.world.query().first_each(&self.rays[range], hits);
        hits.iter().flatten().count()
    }
}

/// Pairs of boxes, tested eight at a time and stored as users would: the pairs of each step together.
struct SinewBoxes {
    steps: Vec<Pairs>,
    overlapping: Vec<u8>,
}

impl SinewBoxes {
    fn new(scene: &BoxPairs) -> Self {
        let obb = |place: &PlacedBox| {
            let Transform { translation, rotation } = place.world_from_box;
            Obb::new(translation, rotation, place.half_extents)
        };
        let together = |step: &[BoxPair]| {
            let mut pairs = Pairs::new();
            step.iter().for_each(|BoxPair { a, b }| pairs.push(&obb(a), &obb(b)));
            pairs
        };
        let steps = scene.pairs.chunks(scene.per_step).map(together).collect();
        Self { steps, overlapping: vec![0; scene.per_step.div_ceil(8)] }
    }
}

impl OverlapTester for SinewBoxes {
    fn count_overlaps(&mut self, range: Range<usize>) -> usize {
        let pairs = &self.steps[range.start / range.len()];
        pairs.overlaps(&mut self.overlapping);
        self.overlapping.iter().map(|eight| eight.count_ones() as usize).sum()
    }
}

struct SinewCrowd(sinew_scenes::crowd::Crowd);

impl Crowd for SinewCrowd {
    fn step(&mut self, step: usize) {
        self.0.step(step);
    }

    fn pose(&mut self, character: usize, step: usize) -> CharacterPose {
        let rotations = |pose: &Pose| pose.iter().map(|local| local.rotation).collect();
        CharacterPose {
            sampled: self.0.sample(character, step).each_ref().map(rotations),
            places: self.0.model(character).iter().map(|joint| joint.translation).collect(),
        }
    }
}
