//! Ragdolls fall on planks that hang on two ropes.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::ragdolls::{ragdoll_of_mannequin, spawn_at};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, cuboid, floor};
use sinew::math::{Random, Vec3, max, min};
use sinew::physics::particles::{AttachmentDef, AttachmentTarget, GroupDef, ParticleDef, SpringDef};
use sinew::physics::{BodyId, GroupId, World};
use sinew::ragdoll::Ragdoll;
use sinew::ragdoll::quality::random_pose;

pub(in crate::scenes) const ROPE_BRIDGE: Scene = Scene {
    chapter: Chapter::Particles,
    name: "rope_bridge",
    about: "a bridge of planks on two ropes carries two limp mannequins that fall on it",
    steps: 1500,
    settings: &[
        Setting::whole("figures", 2, (0, 4), "number of mannequins"),
        Setting::whole("first", 5, (0, 10_000), "index of the first mannequin's pose"),
        Setting::number("height", 0.5, (0.1, 3.0), "distance from their lowest points to the deck, m"),
    ],
    build: rope_bridge,
};

const PLANKS: usize = 8;
/// Distance between the centres of neighbouring planks, metres.
const SPACING: f32 = 0.6;
/// Half extents of a plank, metres, and its mass, kg.
const PLANK: Vec3 = Vec3::new(0.28, 0.03, 1.0);
const PLANK_MASS: f32 = 15.0;
/// Position of a hanger relative to the plank's centre, metres.
const TIED: Vec3 = Vec3::new(0.2, 0.0, 0.95);
/// Heights of the deck, and of the ropes at mid-span and at their ends, metres.
const DECK: f32 = 2.0;
const LOW: f32 = 2.6;
const HIGH: f32 = 3.6;
/// Stiffness times length of a spring, N (springs shorter than the distance of two planks are no stiffer), and mass of
/// each knot of the ropes, kg.
const STIFFNESS: f32 = 4e4;
const KNOT: f32 = 0.5;
/// Number of iterations of the ropes in a substep. With fewer iterations a bridge of many planks gains energy.
const PARTS: u32 = 32;
/// Damping of the springs, as a share of the critical one for a plank's corner.
const DAMPED: f32 = 1.0;
/// Drag of planks and ropes, 1/s: swings decay in some seconds.
const AIR: f32 = 1.0;
/// Tolerance of a sum of pulls, as a share of the weight.
const BORNE: f64 = 0.005;

fn rope_bridge(setup: &Setup<'_>) -> Instance {
    let mut world = setup.sleepless_world();
    world.add_body(&floor());
    let planks: Vec<BodyId> = (0..PLANKS)
        .map(|k| {
            let mut plank = cuboid(PLANK, Vec3::new(middle(k), DECK, 0.0));
            plank.shapes[0].density = PLANK_MASS / (8.0 * PLANK.x * PLANK.y * PLANK.z);
            (plank.linear_damping, plank.angular_damping) = (AIR, AIR);
            world.add_body(&plank)
        })
        .collect();
    let (def, held) = ropes(&planks);
    let ropes = world.add_particles(&def);
    let (figures, first) = (setup.whole("figures"), setup.whole("first"));
    let def = ragdoll_of_mannequin();
    let height = DECK + PLANK.y + setup.number("height");
    let figures: Vec<Ragdoll> = (0..figures)
        .map(|k| {
            let mut random = Random::new((first + k) as u64);
            let (turn, pose) = (random.rotation(), random_pose(&def, &mut random));
            let x = (k as f32 - 0.5 * (figures as f32 - 1.0)) * 1.5;
            spawn_at(&mut world, &def, &pose, turn, Vec3::new(x, height, 0.0), Vec3::ZERO)
        })
        .collect();
    let bodies = figures.iter().flat_map(|figure| &figure.bodies).chain(&planks);
    let mass: f32 = bodies.map(|&id| world.mass(id).mass).sum::<f32>()
        + world.particles(ropes).masses().iter().sum::<f32>();
    let weight = mass * GRAVITY;
    let (pulls, places, speeds) = (Vec::new(), Vec::new(), Vec::new());
    Instance::new(world, RopeBridge { planks, figures, ropes, held, weight, pulls, places, speeds })
}

/// Place of a plank along the bridge, metres.
fn middle(plank: usize) -> f32 {
    (plank as f32 - 0.5 * (PLANKS as f32 - 1.0)) * SPACING
}

/// Two ropes with hangers to the corners of the planks, and the particles at their fixed ends.
fn ropes(planks: &[BodyId]) -> (GroupDef, Vec<usize>) {
    let mut group = GroupDef { iterations: PARTS, ..GroupDef::default() };
    group.filter.mask = 0;
    group.linear_damping = AIR;
    let mut held = Vec::new();
    let half = 0.5 * SPACING * PLANKS as f32;
    for side in [-TIED.z, TIED.z] {
        let (mut last, mut edge) = (None, None);
        let places: Vec<(f32, Option<usize>)> = core::iter::once((-half, None))
            .chain((0..PLANKS).flat_map(|k| [-TIED.x, TIED.x].map(|by| (middle(k) + by, Some(k)))))
            .chain(core::iter::once((half, None)))
            .collect();
        for (x, plank) in places {
            let share = x / half;
            let at = Vec3::new(x, LOW + (HIGH - LOW) * share * share, side);
            let knot = add_particle(&mut group, at);
            if let Some(last) = last {
                tie(&mut group, [last, knot]);
            }
            last = Some(knot);
            match plank {
                None => {
                    held.push(group.attachments.len());
                    group
                        .attachments
                        .push(AttachmentDef { particle: knot, target: AttachmentTarget::World(at) });
                }
                Some(k) => {
                    let corner = Vec3::new(x, DECK, side);
                    let end = add_particle(&mut group, corner);
                    tie(&mut group, [knot, end]);
                    // Hangers from plank to plank.
                    if let Some((_, edge)) = edge.filter(|(of, _)| *of != k) {
                        tie(&mut group, [edge, end]);
                    }
                    edge = Some((k, end));
                    let point = corner - Vec3::new(middle(k), DECK, 0.0);
                    let target = AttachmentTarget::Body { body: planks[k], point };
                    group.attachments.push(AttachmentDef { particle: end, target });
                }
            }
        }
    }
    (group, held)
}

fn add_particle(group: &mut GroupDef, position: Vec3) -> u32 {
    group.particles.push(ParticleDef { position, velocity: Vec3::ZERO, mass: KNOT, radius: 0.02 });
    group.particles.len() as u32 - 1
}

fn tie(group: &mut GroupDef, ends: [u32; 2]) {
    let [a, b] = ends.map(|end| group.particles[end as usize].position);
    let length = (b - a).length();
    let spring = SpringDef::new(ends, length, STIFFNESS / max(length, SPACING));
    group.springs.push(spring.damped(DAMPED, [PLANK_MASS / 4.0; 2]));
}

struct RopeBridge {
    planks: Vec<BodyId>,
    figures: Vec<Ragdoll>,
    ropes: GroupId,
    /// Particles that are attached to the world.
    held: Vec<usize>,
    /// Total weight of planks, ropes and ragdolls, N.
    weight: f32,
    /// Pull of the attached particles in each step, N.
    pulls: Vec<f64>,
    /// Centres of the planks after the last step, metres.
    places: Vec<Vec3>,
    /// Speed of the fastest plank in each step by its displacement, m/s: velocities after a step already include the
    /// gravity of the next.
    speeds: Vec<f32>,
}

impl Script for RopeBridge {
    fn after_step(&mut self, world: &mut World) {
        let substeps = 60.0 * world.def().substeps as f32;
        let given = world.particles(self.ropes).attachment_impulses();
        let pull: f32 = self.held.iter().map(|&at| -given[at].y * substeps).sum();
        self.pulls.push(f64::from(pull));
        let places: Vec<Vec3> = self.planks.iter().map(|&id| world.center_of_mass(id)).collect();
        let ways = places.iter().zip(&self.places).map(|(now, before)| (*now - *before).length());
        self.speeds.push(ways.fold(0.0, max) / world.def().dt());
        self.places = places;
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let last = &self.pulls[self.pulls.len().saturating_sub(60)..];
        let borne = last.iter().sum::<f64>() / last.len().max(1) as f64;
        let height = |id: &BodyId| world.center_of_mass(*id).y;
        let lowest = |figure: &Ragdoll| figure.bodies.iter().map(height).fold(f32::INFINITY, min);
        let through = self.figures.iter().map(lowest).fold(f32::INFINITY, min);
        let speeds = &self.speeds[self.speeds.len().saturating_sub(60)..];
        let deck = self.planks.iter().map(height).fold(f32::INFINITY, min);
        vec![
            Metric::new("borne_n", borne as f32, Expected::near(f64::from(self.weight), BORNE)),
            Metric::new("deck_sags_m", DECK - deck, Expected::AtMost(0.3)),
            Metric::new("figures_below_deck_m", DECK - through, Expected::AtMost(0.3)),
            Metric::new("plank_speed_mps", speeds.iter().copied().fold(0.0, max), Expected::AtMost(0.02)),
        ]
    }
}
