//! Bodies that hang on ropes and carry other bodies: the ropes carry the whole weight.

use crate::build::box_body;
use sinew_math::{Reader, Vec3, Writer};
use sinew_physics::particles::{AttachmentDef, AttachmentTarget, GroupDef, RopeDef, SpringDef};
use sinew_physics::*;

const PLANK: Vec3 = Vec3::new(0.6, 0.02, 0.2);
const PLANK_MASS: f32 = 5.0;
/// Half the side of the box, metres.
const BOX: f32 = 0.1;
/// Force that stretches a rope to twice its length, N; the rope is 1 m long and has 0.1 kg.
const STIFFNESS: f32 = 4e4;
const LINKS: u32 = 4;
const ROPE_MASS: f32 = 0.1;

struct Laden {
    world: World,
    plank: BodyId,
    load: BodyId,
    ropes: Vec<GroupId>,
}

/// Returns a plank that hangs on a rope at each corner, and a box of `mass` at `height` above it. `apart`: each rope is
/// a group of its own.
fn laden(mass: f32, height: f32, apart: bool) -> Laden {
    let mut world = World::new(WorldDef::default());
    let mut def = BodyDef { sleeping: Sleeping::Off, ..box_body(PLANK, Vec3::ZERO) };
    def.shapes[0].density = PLANK_MASS / (8.0 * PLANK.x * PLANK.y * PLANK.z);
    let plank = world.add_body(&def);
    let mut none = GroupDef { sleeping: Sleeping::Off, ..GroupDef::default() };
    none.filter.mask = 0;
    let mut ropes = none.clone();
    let mut ids = Vec::new();
    for (x, z) in [(-0.5, -0.18), (-0.5, 0.18), (0.5, -0.18), (0.5, 0.18)] {
        let corner = Vec3::new(x, 0.0, z);
        let def = RopeDef {
            from: corner + Vec3::Y,
            to: corner,
            links: LINKS,
            mass: ROPE_MASS,
            stiffness: STIFFNESS,
            radius: 0.01,
        };
        let (rope, first) = (def.build().group, ropes.particles.len() as u32);
        ropes.particles.extend(rope.particles);
        // Critical damping of a quarter of the load, for the whole rope.
        let damping = LINKS as f32 * (STIFFNESS * (mass + PLANK_MASS)).sqrt();
        ropes.springs.extend(rope.springs.iter().map(|s| SpringDef {
            a: s.a + first,
            b: s.b + first,
            damping,
            ..*s
        }));
        let held = AttachmentTarget::Body { body: plank, point: corner };
        let place = AttachmentTarget::World(corner + Vec3::Y);
        for (particle, target) in [(first, place), (first + LINKS, held)] {
            ropes.attachments.push(AttachmentDef { particle, target });
        }
        if apart {
            ids.push(world.add_particles(&core::mem::replace(&mut ropes, none.clone())));
        }
    }
    if !apart {
        ids.push(world.add_particles(&ropes));
    }
    let place = Vec3::Y * (PLANK.y + BOX + height);
    let mut def = BodyDef { sleeping: Sleeping::Off, ..box_body(Vec3::splat(BOX), place) };
    def.shapes[0].density = mass / (8.0 * BOX * BOX * BOX);
    let load = world.add_body(&def);
    Laden { world, plank, load, ropes: ids }
}

impl Laden {
    /// Returns the sum of the ropes' forces on their hooks in the last substep, N.
    fn tension(&self) -> f32 {
        let per_second = 60.0 * WorldDef::default().substeps as f32;
        let groups = self.ropes.iter().map(|&id| self.world.particles(id));
        let pulls = groups.flat_map(|group| group.attachments().iter().zip(group.attachment_impulses()));
        let of_world = pulls.filter(|(a, _)| matches!(a.target, AttachmentTarget::World(_)));
        of_world.map(|(_, impulse)| -impulse.y * per_second).sum()
    }

    /// Takes `steps` steps. Returns the largest rise of the energy above its initial value, J, and the range of the
    /// plank's heights in the last second, metres.
    fn run(&mut self, steps: usize) -> (f32, f32) {
        let begin = self.world.energy().total();
        let (mut gain, mut low, mut high) = (0.0_f32, f32::INFINITY, f32::NEG_INFINITY);
        for step in 0..steps {
            self.world.step();
            gain = gain.max(self.world.energy().total() - begin);
            if step + 60 >= steps {
                let y = self.world.center_of_mass(self.plank).y;
                (low, high) = (low.min(y), high.max(y));
            }
        }
        (gain, high - low)
    }
}

/// The ropes' stretch and tension correspond to the weight of the plank and of the box on it.
#[test]
fn ropes_carry_the_load_on_a_plank() {
    check_load_on_ropes(false);
}

/// Ropes in separate groups carry the load like ropes in one group.
#[test]
fn separate_rope_groups_carry_the_load_on_a_plank() {
    check_load_on_ropes(true);
}

fn check_load_on_ropes(apart: bool) {
    for (mass, height) in [(1.0, 0.0), (10.0, 0.0), (100.0, 0.0), (10.0, 0.2), (100.0, 0.2)] {
        let what = format!("{mass} kg from {height} m, apart: {apart}");
        let mut laden = laden(mass, height, apart);
        let (gain, tremble) = laden.run(900);
        let sag = -laden.world.center_of_mass(laden.plank).y;
        // On average each rope carries half of its own weight.
        let due = ((PLANK_MASS + mass) / 4.0 + 0.5 * ROPE_MASS) * 9.81 / STIFFNESS;
        let (tension, weight) = (laden.tension(), (PLANK_MASS + mass + 4.0 * ROPE_MASS) * 9.81);
        let above = laden.world.center_of_mass(laden.load).y + sag - PLANK.y - BOX;
        println!(
            "{what}: sag {sag} for {due}, tension {tension} for {weight}, gain {gain}, tremble {tremble}"
        );
        assert!((tension / weight - 1.0).abs() < 0.01, "{what}: tension {tension} N, weight {weight} N");
        assert!(above.abs() < 1e-3, "{what}: the load is {above} m above the plank");
        assert!(gain < 0.01 * weight * (height + due), "{what}: the energy rose by {gain} J");
        // After the fall of a load of twenty times the plank's mass the plank oscillates longer than this, by 1.4 mm.
        if mass * height < 20.0 {
            assert!((sag / due - 1.0).abs() < 0.005, "{what}: sag {sag} m, expected {due} m");
            assert!(tremble < 1e-5, "{what}: vibrates by {tremble} m");
        }
    }
}

/// Snapshots contain the mass scaling of a body on ropes.
#[test]
fn restored_loaded_plank_continues_with_the_same_bits() {
    for apart in [false, true] {
        let mut laden = laden(20.0, 0.1, apart);
        for step in 0..60 {
            laden.world.step();
            let mut bytes = Writer::new();
            laden.world.save(&mut bytes);
            let mut copy = World::new(WorldDef::default());
            copy.load(&mut Reader::new(bytes.as_bytes())).expect("the snapshot must load");
            let mut other = laden.world.clone();
            for _ in 0..3 {
                copy.step();
                other.step();
                assert_eq!(copy.hash(), other.hash(), "saved after step {step}, apart: {apart}");
            }
        }
    }
}
