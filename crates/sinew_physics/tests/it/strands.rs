//! Chains of plain ball joints (strands), up to eight of which are solved together with SIMD. They move like single
//! chains, and like chains solved as islands.

use crate::build::{ball, capsule_body};
use sinew_math::{Random, ReadError, Reader, Transform, Vec3, Writer};
use sinew_physics::*;

const LENGTH: f32 = 0.3;

/// A swinging chain of links of 1 to 50 kg. Chains of different indices never meet.
struct Chain {
    bodies: Vec<BodyId>,
    joints: Vec<JointId>,
}

impl Chain {
    fn new(world: &mut World, i: u32, links: usize, is_held: bool) -> Self {
        let mut random = Random::new(u64::from(i) + 1);
        // Near the origin, because 40 m away the rounding of positions is a speed error of 1 mm/s.
        let origin = Vec3::X * (4.0 * i as f32);
        let mut last = is_held.then(|| {
            world.add_body(&BodyDef { kind: BodyKind::Static, position: origin, ..BodyDef::default() })
        });
        let (mut bodies, mut joints) = (Vec::new(), Vec::new());
        for k in 0..links {
            let at = origin + Vec3::Z * (LENGTH * (k as f32 + 0.5));
            let mut def = capsule_body(0.1, 0.03, at);
            def.shapes[0].density *= random.range(1.0, 50.0);
            if is_held {
                (def.linear_damping, def.angular_damping) = (random.range(0.0, 0.1), random.range(0.0, 0.1));
            }
            let body = world.add_body(&def);
            if let Some(last) = last {
                let joint = ball(world, last, body, at - Vec3::Z * (0.5 * LENGTH));
                // The new link may be body A or body B.
                let flipped = JointDef {
                    body_a: joint.body_b,
                    body_b: joint.body_a,
                    frame_a: joint.frame_b,
                    frame_b: joint.frame_a,
                    ..joint
                };
                joints.push(world.add_joint(if k % 3 == 1 { &flipped } else { &joint }));
            }
            last = Some(body);
            bodies.push(body);
        }
        for &body in &bodies {
            let impulse = random.direction() * world.mass(body).mass;
            world.apply_impulse_at_center(body, impulse);
        }
        Self { bodies, joints }
    }

    fn state(&self, world: &World) -> Vec<(Transform, Velocity)> {
        self.bodies.iter().map(|&id| (world.transform(id), world.velocity(id))).collect()
    }
}

/// Object that pushes bodies by almost nothing, so that their islands are not solved as strands.
struct Touch(Vec<BodyId>);

impl PhysicsObject for Touch {
    fn kind(&self) -> &'static str {
        "touch"
    }
    fn save(&self, _: &mut Writer) {}
    fn load(&mut self, _: &mut Reader<'_>) -> Result<(), ReadError> {
        Ok(())
    }
    fn add_forces(&mut self, forces: &mut Forces<'_>) {
        self.0.iter().for_each(|&id| forces.apply_force_at_center(id, Vec3::X * 1e-30));
    }
}

fn run(world: &mut World, steps: usize) {
    (0..steps).for_each(|_| world.step());
}

#[test]
fn strand_has_the_same_bits_alone_and_beside_others() {
    // A strand of 24 or more links is divided into pieces, one per lane.
    let lengths = |i: u32| [4, 7, 7, 26][i as usize % 4];
    let mut crowd = World::new(WorldDef::default());
    let chains: Vec<_> = (0..15).map(|i| Chain::new(&mut crowd, i, lengths(i), i != 8)).collect();
    run(&mut crowd, 60);
    for i in [0, 1, 3, 8, 13, 14] {
        let mut world = World::new(WorldDef::default());
        let alone = Chain::new(&mut world, i, lengths(i), i != 8);
        run(&mut world, 60);
        assert_eq!(chains[i as usize].state(&crowd), alone.state(&world), "chain {i}");
    }
}

#[test]
fn strands_match_islands() {
    for (i, links, is_held) in [(0, 1, true), (1, 2, true), (2, 9, true), (3, 2, false), (4, 9, false)] {
        let [mut strand, mut island] = [(); 2].map(|()| World::new(WorldDef::default()));
        let [a, b] = [&mut strand, &mut island].map(|world| Chain::new(world, i, links, is_held));
        island.add_object(Box::new(Touch(b.bodies.clone())));
        for step in 1..=20 {
            strand.step();
            island.step();
            for ((pose, v), (expected, w)) in a.state(&strand).into_iter().zip(b.state(&island)) {
                let off = (pose.translation - expected.translation).length();
                assert!(off < 1e-4, "chain {i}, step {step}: pose {pose:?}, expected {expected:?}");
                assert!(
                    pose.rotation.dot(expected.rotation).abs() > 1.0 - 1e-6,
                    "chain {i}, step {step}: the rotations differ"
                );
                assert!(
                    (v.linear - w.linear).length() < 5e-3,
                    "chain {i}, step {step}: velocity {v:?}, expected {w:?}"
                );
                assert!(
                    (v.angular - w.angular).length() < 5e-2,
                    "chain {i}, step {step}: velocity {v:?}, expected {w:?}"
                );
            }
            for (&a, &b) in a.joints.iter().zip(&b.joints) {
                let (of_strand, of_island) = (strand.reaction(a), island.reaction(b));
                let off = (of_strand.force - of_island.force).length();
                assert!(
                    off < 0.01 * of_island.force.length() + 0.1,
                    "chain {i}: force {of_strand:?} as a strand, {of_island:?} as an island"
                );
            }
        }
    }
}

#[test]
fn objects_change_only_their_bodies() {
    let [mut with, mut without] = [(); 2].map(|()| World::new(WorldDef::default()));
    let [with_chains, chains] =
        [&mut with, &mut without].map(|world| [0, 1].map(|i| Chain::new(world, i, 5, true)));
    with.add_object(Box::new(Touch(with_chains[0].bodies.clone())));
    run(&mut with, 60);
    run(&mut without, 60);
    assert_ne!(with_chains[0].state(&with), chains[0].state(&without));
    assert_eq!(with_chains[1].state(&with), chains[1].state(&without));
}

#[test]
fn free_strand_keeps_its_momentum() {
    for links in [6, 24, 29] {
        let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
        let chain = Chain::new(&mut world, 0, links, false);
        let weights = chain.bodies.iter().map(|&id| (id, world.mass(id).mass)).collect::<Vec<_>>();
        let mass: f32 = weights.iter().map(|(_, mass)| mass).sum();
        let momentum = |world: &World| -> Vec3 {
            weights.iter().map(|&(id, mass)| world.velocity(id).linear * mass).sum()
        };
        let before = momentum(&world);
        run(&mut world, 120);
        let lost = (momentum(&world) - before).length();
        assert!(
            before.length() > 0.05 * mass && lost < 1e-4 * mass,
            "{links} links: lost momentum {lost} of {before}"
        );
        let gap = chain.joints.iter().map(|&joint| world.joint_gap(joint)).fold(0.0, f32::max);
        assert!(gap < 2e-4, "{links} links: joint gap {gap} m");
    }
}

#[test]
fn joints_of_a_long_rope_carry_the_weight_below() {
    for links in [24, 31, 49, 100] {
        let mut world = World::new(WorldDef::default());
        let anchor = world.add_body(&BodyDef { kind: BodyKind::Static, ..BodyDef::default() });
        let (mut last, mut joints, mut masses) = (anchor, Vec::new(), Vec::new());
        for k in 0..links {
            let at = Vec3::NEG_Y * (LENGTH * (k as f32 + 0.5));
            let mut def = capsule_body(0.1, 0.03, at);
            def.shapes[0].density *= if k + 1 == links { 500.0 } else { 1.0 };
            let body = world.add_body(&def);
            joints.push(world.add_joint(&ball(&world, last, body, at + Vec3::Y * (0.5 * LENGTH))));
            masses.push(world.mass(body).mass);
            last = body;
        }
        run(&mut world, 60);
        let mut below = 0.0;
        for (joint, mass) in joints.iter().zip(&masses).rev() {
            below += mass * 9.81;
            let force = world.reaction(*joint).force.length();
            assert!(
                (force - below).abs() < 2e-4 * below,
                "{links} links: joint force {force} N, weight below {below} N"
            );
            assert!(world.joint_gap(*joint) < 1e-5, "{links} links: a joint of the rope is open");
        }
    }
}

#[test]
fn joints_of_a_long_whirling_chain_stay_closed() {
    for (seed, links) in [(1, 41), (2, 42), (3, 64), (4, 71), (5, 90)] {
        let mut random = Random::new(seed);
        let mut world = World::new(WorldDef::default());
        let (mut at, mut way, mut last) = (Vec3::ZERO, random.direction(), None);
        let mut joints = Vec::new();
        for _ in 0..links {
            way = (way + random.direction() * 0.4).normalize();
            let shape = ShapeDef {
                density: random.range(500.0, 3000.0),
                filter: Filter { mask: 0, ..Filter::default() },
                ..ShapeDef::new(Shape::Sphere { radius: 0.05 })
            };
            let position = at + way * 0.15;
            let body = world.add_body(&BodyDef { position, shapes: vec![shape], ..BodyDef::default() });
            world.apply_impulse_at_center(body, random.direction() * world.mass(body).mass);
            if let Some(last) = last {
                let joint = ball(&world, last, body, at);
                joints.push(world.add_joint(&joint));
            }
            (at, last) = (at + way * 0.3, Some(body));
        }
        let mut widest = 0.0;
        for _ in 0..90 {
            world.step();
            widest = joints.iter().map(|&joint| world.joint_gap(joint)).fold(widest, f32::max);
        }
        assert!(widest < 2e-5, "{links} links: widest gap {widest} m");
    }
}

#[test]
fn a_joint_that_is_open_closes_as_in_an_island() {
    let [mut strand, mut island] = [(); 2].map(|()| World::new(WorldDef::default()));
    let [a, b] = [&mut strand, &mut island].map(|world| {
        let chain = Chain::new(world, 0, 3, true);
        let body = chain.bodies[2];
        let pose = world.transform(body);
        world.set_transform(body, Transform::new(pose.translation + Vec3::X * 0.2, pose.rotation));
        chain
    });
    island.add_object(Box::new(Touch(b.bodies.clone())));
    run(&mut strand, 1);
    run(&mut island, 1);
    // An open joint is solved by the island solver, so the bits are equal.
    assert_eq!(a.state(&strand), b.state(&island));
    run(&mut strand, 30);
    assert!(
        strand.joint_gap(a.joints[2]) < 1e-5,
        "the joint must close; gap {} m",
        strand.joint_gap(a.joints[2])
    );
}
