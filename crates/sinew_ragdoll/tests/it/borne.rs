//! A box rests on a cloth that is held by two heavy blocks. It falls asleep and wakes together with them.

use crate::actor::floor;
use sinew_math::Vec3;
use sinew_physics::particles::{AttachmentTarget, ClothDef};
use sinew_physics::{BodyDef, BodyId, GroupId, Shape, ShapeDef, World, WorldDef};

/// Half extents (metres) and mass (kg) of a block that holds an edge.
const BLOCK: Vec3 = Vec3::new(1.3, 0.3, 0.5);
const BLOCK_MASS: f32 = 2000.0;
/// Gap between the blocks, and length and width of the cloth, metres. The cloth is longer than the gap and sags.
const GAP: f32 = 1.0;
const LENGTH: f32 = 2.4;
const WIDTH: f32 = 1.2;
/// Half extents (metres) and mass (kg) of the load. From 15 kg the blocks creep apart, and nothing falls asleep.
const LOAD: Vec3 = Vec3::new(0.7, 0.1, 0.2);
const LOAD_MASS: f32 = 5.0;

/// Two blocks on a floor, a cloth hung between them, and a load on the cloth.
#[derive(Clone)]
struct Hammock {
    world: World,
    bodies: [BodyId; 3],
    cloth: GroupId,
}

fn block(half_extents: Vec3, mass: f32, position: Vec3) -> BodyDef {
    let density = mass / (8.0 * half_extents.x * half_extents.y * half_extents.z);
    let shape = ShapeDef { density, ..ShapeDef::new(Shape::Box { half_extents }) };
    BodyDef { position, shapes: vec![shape], ..BodyDef::default() }
}

impl Hammock {
    fn new() -> Self {
        let mut world = World::new(WorldDef::default());
        world.add_body(&floor());
        let top = 2.0 * BLOCK.y;
        let [left, right] = [-1.0, 1.0].map(|side| {
            let position = Vec3::new(0.0, BLOCK.y, side * (0.5 * GAP + BLOCK.z));
            world.add_body(&block(BLOCK, BLOCK_MASS, position))
        });
        let mut cloth = ClothDef {
            corner: Vec3::new(-0.5 * LENGTH, top, -0.5 * WIDTH),
            across: Vec3::X * LENGTH,
            down: Vec3::Z * WIDTH,
            columns: 24,
            rows: 12,
            mass: 5.0,
            stretching: 2e4,
            shearing: 5e3,
            bending: 1e-3,
            damping_ratio: 1.0,
            radius: 0.02,
        }
        .build();
        for (row, body) in [(0, left), (12, right)] {
            let center = world.center_of_mass(body);
            for particle in cloth.row(row) {
                let place = &mut cloth.group.particles[particle as usize].position;
                // Particles are moved over the inner edge of the block, without contact.
                *place = Vec3::new(place.x, top + 0.03, 0.5 * GAP * place.z.signum());
                let point = *place - center;
                cloth.group.hold(particle, AttachmentTarget::Body { body, point });
            }
        }
        cloth.group.linear_damping = 4.0;
        let cloth = world.add_particles(&cloth.group);
        let load = world.add_body(&block(LOAD, LOAD_MASS, Vec3::Y * (top + 0.2)));
        Self { world, bodies: [left, right, load], cloth }
    }

    /// Returns the number of bodies and particle groups that are awake, out of four.
    fn awake(&self) -> usize {
        let bodies = self.bodies.iter().filter(|&&id| self.world.is_awake(id)).count();
        bodies + usize::from(self.world.particles(self.cloth).is_awake())
    }

    fn places(&self) -> Vec<Vec3> {
        let bodies = self.bodies.iter().map(|&id| self.world.center_of_mass(id));
        bodies.chain(self.world.particles(self.cloth).positions().iter().copied()).collect()
    }
}

#[test]
fn load_on_a_held_cloth_sleeps_and_wakes_with_it() {
    let mut hammock = Hammock::new();
    let mut steps = 0;
    while hammock.awake() > 0 {
        assert_eq!(hammock.awake(), 4, "only some bodies sleep in step {steps}");
        hammock.world.step();
        steps += 1;
        assert!(steps < 1200, "the hammock never comes to rest");
    }
    let places = hammock.places();
    let load = places[2];
    assert!(
        load.x.abs() < 0.1 && load.z.abs() < 0.1 && load.y < 2.0 * BLOCK.y,
        "the load is not on the cloth but at {load}"
    );
    for step in 0..600 {
        hammock.world.step();
        assert_eq!(hammock.awake(), 0, "awake after {step} steps of sleep");
    }
    assert_eq!(hammock.places(), places);
    let wakes = |what: &str, hit: &dyn Fn(&mut Hammock)| {
        let mut woken = hammock.clone();
        hit(&mut woken);
        woken.world.step();
        assert_eq!(woken.awake(), 4, "{what} must wake all bodies");
    };
    wakes("a hit on the load", &|it| it.world.apply_impulse_at_center(it.bodies[2], Vec3::Y * 0.1));
    wakes("a hit on the cloth", &|it| {
        it.world.particles_mut(it.cloth).apply_impulse(5 * 25 + 3, Vec3::Y * 0.01);
    });
    wakes("a hit on a block", &|it| it.world.apply_impulse_at_center(it.bodies[0], Vec3::X));
}
