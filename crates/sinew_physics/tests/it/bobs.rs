//! Bobs that hang from stones under a plank: the solver of their island neither adds energy to slow swings nor removes
//! energy from them.

use crate::build::ball;
use sinew_math::{Range, Rotation, Vec3, trig};
use sinew_physics::{
    BodyDef, BodyId, BodyKind, JointDef, JointId, JointKind, Shape, ShapeDef, Sleeping, World, WorldDef,
};

/// Stones on the floor under a plank, which makes them one island, with a bob below each stone.
struct Row {
    world: World,
    bobs: Vec<BodyId>,
    joints: Vec<JointId>,
}

/// Numbers of stones: an island that is solved by response, and an island that is solved as a heap.
const STONES: [usize; 2] = [3, 10];
const LENGTH: f32 = 0.5;

impl Row {
    fn new(stones: usize, tilt: f32, hang: impl Fn(&World, BodyId, BodyId, Vec3) -> JointDef) -> Self {
        let mut world = World::new(WorldDef { sleeping: Sleeping::Off, ..WorldDef::default() });
        let add = |world: &mut World, kind, position, half_extents| {
            let shapes = vec![ShapeDef::new(Shape::Box { half_extents })];
            world.add_body(&BodyDef { kind, position, shapes, ..BodyDef::default() })
        };
        let middle = 0.6 * (stones - 1) as f32;
        add(&mut world, BodyKind::Static, Vec3::new(middle, -1.0, 0.0), Vec3::new(20.0, 1.0, 20.0));
        add(&mut world, BodyKind::Dynamic, Vec3::new(middle, 1.05, 0.0), Vec3::new(middle + 0.6, 0.05, 0.4));
        let (mut bobs, mut joints) = (Vec::new(), Vec::new());
        for i in 0..stones {
            let x = 1.2 * i as f32;
            let stone = add(&mut world, BodyKind::Dynamic, Vec3::new(x, 0.5, 0.0), Vec3::splat(0.5));
            let anchor = Vec3::new(x, 0.9, 0.7);
            let down = Vec3::new(trig::sin(tilt), -trig::cos(tilt), 0.0) * LENGTH;
            let bob = add(&mut world, BodyKind::Dynamic, anchor + down, Vec3::splat(0.05));
            let joint = hang(&world, stone, bob, anchor);
            joints.push(world.add_joint(&joint));
            bobs.push(bob);
        }
        Self { world, bobs, joints }
    }

    /// Takes `steps` steps and returns the largest displacement of each bob along x in them, metres.
    fn reach(&mut self, steps: usize) -> Vec<f32> {
        let mut most = vec![0.0; self.bobs.len()];
        for _ in 0..steps {
            self.world.step();
            for (i, (bob, most)) in self.bobs.iter().zip(&mut most).enumerate() {
                *most = f32::max(*most, (self.world.transform(*bob).translation.x - 1.2 * i as f32).abs());
            }
        }
        most
    }

    fn gap(&self) -> f32 {
        self.joints.iter().map(|id| self.world.joint_gap(*id)).fold(0.0, f32::max)
    }
}

#[test]
fn bobs_beneath_stones_keep_their_swing() {
    // Under few stones, slower bobs lose a fifth of their swing in 15 s: a known, unexplained defect.
    let few = [(STONES[0], 0.3)];
    for (stones, tilt) in [0.005, 0.02, 0.1, 0.3].map(|tilt| (STONES[1], tilt)).into_iter().chain(few) {
        let mut row = Row::new(stones, tilt, ball);
        row.reach(900);
        let reach = row.reach(120);
        let start = LENGTH * trig::sin(tilt);
        assert!(
            reach.iter().all(|reach| (reach / start - 1.0).abs() < 0.01),
            "tilt {tilt}: amplitudes {reach:?}, at the start {start}"
        );
        assert!(row.gap() < 2e-5, "tilt {tilt}: joint gap {} m", row.gap());
    }
}

#[test]
fn bobs_released_beyond_a_stop_rest_at_it() {
    let mut row = Row::new(STONES[1], 0.25, |world, stone, bob, anchor| {
        let mut joint = ball(world, stone, bob, anchor);
        let about_z = Rotation::from_axis_angle(Vec3::Y, -std::f32::consts::FRAC_PI_2);
        (joint.frame_a.rotation, joint.frame_b.rotation) = (about_z, about_z);
        joint.kind = JointKind::Hinge { limit: Some(Range::new(-0.15, 0.5)) };
        joint.friction_torque = 0.3;
        joint
    });
    row.reach(600);
    let rest = row.reach(60);
    let stop = LENGTH * trig::sin(0.1);
    assert!(
        rest.iter().all(|reach| (reach - stop).abs() < 5e-4),
        "displacements at rest {rest:?} m, displacement of the stop {stop} m"
    );
    assert!(row.gap() < 2e-5, "joints open by {} m", row.gap());
}
