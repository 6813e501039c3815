//! Deltas between snapshots are exact, are small for small changes, and are refused if damaged.

use crate::lies::at_each_step;
use sinew_math::Random;
use sinew_physics::*;

/// Returns the snapshots after the first steps of a life, between which objects are added and removed.
fn snapshots(seed: u64) -> Vec<Snapshot> {
    let mut all = Vec::new();
    at_each_step(seed, |world| all.push(Snapshot::of(world)));
    all
}

#[test]
fn a_delta_restores_the_later_snapshot() {
    for seed in 0..20 {
        let all = snapshots(seed);
        for (i, j) in [(0, 1), (1, 2), (5, 6), (0, 14), (14, 0), (13, 14), (7, 7)] {
            let delta = all[j].delta(&all[i]);
            assert_eq!(
                Snapshot::from_delta(&all[i], &delta).as_ref(),
                Ok(&all[j]),
                "life {seed}, snapshots {i} to {j}"
            );
            assert!(
                delta.len() <= all[j].as_bytes().len() + 64,
                "life {seed}, snapshots {i} to {j}: {} bytes",
                delta.len()
            );
        }
    }
    let (nothing, all) = (Snapshot::default(), snapshots(3));
    for (a, b) in [(&nothing, &all[4]), (&all[4], &nothing), (&nothing, &nothing)] {
        assert_eq!(Snapshot::from_delta(a, &b.delta(a)).as_ref(), Ok(b));
    }
}

#[test]
fn resting_bodies_add_almost_nothing_to_a_delta() {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    for i in 0..200 {
        let at = sinew_math::Vec3::new(i as f32, 0.25, 0.0);
        world.add_body(&BodyDef::dynamic(Shape::cuboid(sinew_math::Vec3::splat(0.25))).at(at));
    }
    (0..120).for_each(|_| world.step());
    assert!(world.body_ids().skip(1).all(|id| !world.is_awake(id)));
    let ball = BodyDef::dynamic(Shape::sphere(0.2)).at([0.0, 30.0, 9.0].into());
    let ball = world.add_body(&ball);
    let earlier = Snapshot::of(&world);
    world.step();
    let later = Snapshot::of(&world);
    let delta = later.delta(&earlier);
    assert!(delta.len() < 200, "{} of {} bytes", delta.len(), later.as_bytes().len());
    let mut other = World::new(WorldDef::default());
    let back = Snapshot::from_delta(&earlier, &delta).expect("the delta must apply to its base");
    back.load_into(&mut other).expect("the snapshot must load");
    assert_eq!((other.hash(), other.transform(ball)), (world.hash(), world.transform(ball)));
}

#[test]
fn damaged_deltas_and_other_bases_are_refused() {
    let all = snapshots(5);
    let delta = all[9].delta(&all[8]);
    assert!(Snapshot::from_delta(&all[7], &delta).is_err(), "a delta must be refused for another base");
    for end in 0..usize::min(delta.len(), 2000) {
        assert!(Snapshot::from_delta(&all[8], &delta[..end]).is_err(), "cut at {end}");
    }
    let mut random = Random::new(11);
    for _ in 0..10_000 {
        let mut lie = delta.clone();
        let at = random.index(lie.len());
        lie[at] ^= 1 << random.index(8);
        if let Ok(taken) = Snapshot::from_delta(&all[8], &lie) {
            assert!(taken == all[9], "a flipped bit of byte {at} must not load as another snapshot");
        }
    }
}
