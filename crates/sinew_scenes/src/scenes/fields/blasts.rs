//! An explosion: its impulse by distance, and bodies that it does not reach.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, ball, cuboid, fixed, ghost};
use core::f32::consts::PI;
use sinew::math::{Vec3, max};
use sinew::physics::{BodyDef, BodyId, Explosion, Occlusion, World};

pub(in crate::scenes) const EXPLOSION: Scene = Scene {
    chapter: Chapter::Fields,
    name: "explosion",
    about: "a blast throws balls according to their distance; one behind a wall and one out of reach stay",
    steps: 90,
    settings: &[Setting::number("impulse", 3000.0, (0.0, 10_000.0), "impulse at the centre, N·s/m²")],
    build: explosion,
};

const RADIUS: f32 = 0.1;
/// Reach of the blast, metres.
const REACH: f32 = 4.0;
/// Distance from the centre of the blast to the nearest point of the balls beside the blast and of the ball
/// above, metres.
const NEAR: f32 = 1.0;
const FAR: f32 = 3.0;
const ABOVE: f32 = 2.0;

fn explosion(setup: &Setup<'_>) -> Instance {
    let mut world = setup.sleepless_world();
    let mut add = |away: Vec3, gap: f32, gravity_scale: f32| {
        let def = ghost(ball(RADIUS, away * (gap + RADIUS)));
        world.add_body(&BodyDef { gravity_scale, ..def })
    };
    let near = add(Vec3::X, NEAR, 0.0);
    let far = add(Vec3::NEG_X, FAR, 0.0);
    let spared = [add(Vec3::Z, ABOVE, 0.0), add(Vec3::NEG_Z, REACH, 0.0)];
    let above = add(Vec3::Y, ABOVE, 1.0);
    let wall = cuboid(Vec3::new(0.5, 0.5, 0.05), Vec3::Z);
    world.add_body(&fixed(wall));
    let blast = Explosion::new(Vec3::ZERO, REACH, setup.number("impulse"));
    world.explode(&Explosion { occlusion: Occlusion::Static, ..blast });
    Instance::new(world, Blast { near, far, above, spared, impulse: setup.number("impulse"), highest: 0.0 })
}

struct Blast {
    near: BodyId,
    far: BodyId,
    above: BodyId,
    /// Bodies behind the wall and out of reach.
    spared: [BodyId; 2],
    impulse: f32,
    /// Greatest rise of the ball above the blast, metres.
    highest: f32,
}

impl Blast {
    /// Returns the expected impulse at a distance: linear fall-off on a disk, `J = i (1 − d/R) π r²`.
    fn expected(&self, gap: f32) -> f32 {
        self.impulse * (1.0 - gap / REACH) * PI * RADIUS * RADIUS
    }
}

impl Script for Blast {
    fn after_step(&mut self, world: &mut World) {
        let rise = world.center_of_mass(self.above).y - (ABOVE + RADIUS);
        self.highest = max(self.highest, rise);
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let momentum = |body| world.velocity(body).linear * world.mass(body).mass;
        let spared: f32 = self.spared.iter().map(|&body| momentum(body).length()).sum();
        let speed = self.expected(ABOVE) / world.mass(self.above).mass;
        // Height `v²/2g`, less the lead of symplectic Euler.
        let h = world.def().dt() / world.def().substeps as f32;
        let rise = speed * speed / (2.0 * GRAVITY) - 0.5 * speed * h;
        let near = |gap: f32| Expected::near(self.expected(gap), 1e-4);
        vec![
            Metric::new("near_n_s", momentum(self.near).x, near(NEAR)),
            Metric::new("far_n_s", -momentum(self.far).x, near(FAR)),
            Metric::new("spared_n_s", spared, Expected::AtMost(0.0)),
            Metric::new("rise_m", self.highest, Expected::near(rise, 1e-3)),
        ]
    }
}
