//! Objects in snapshots: they are restored exactly, and damaged bytes give errors.

use super::kinds::{Bump, Counter, Leash, Spring};
use super::{mixed, panics};
use sinew_math::{ReadError, Reader, Vec3, Writer};
use sinew_physics::stage::NoProfiler;
use sinew_physics::*;

/// Returns the mixed world with objects that push a box, hold a link and deflect the rope.
pub fn inhabited() -> World {
    let mut world = mixed();
    let bodies: Vec<BodyId> = world.body_ids().collect();
    let group = world.group_ids().next().expect("the world has a rope");
    let place = Vec3::new(-0.5, 1.5, 0.0);
    world.add_object(Box::new(Spring { body: bodies[3], place, stiffness: 300.0 }));
    world.add_object(Box::new(Counter::default()));
    let place = world.center_of_mass(bodies[13]) + Vec3::Y * 0.5;
    world.add_object(Box::new(Leash { body: bodies[13], place, length: 0.5 }));
    world.add_object(Box::new(Bump { center: Vec3::new(-1.5, 0.3, 0.0), radius: 0.4, group }));
    world
}

fn run(world: &mut World, steps: usize) -> Vec<u64> {
    let step = |_| {
        world.step();
        world.hash()
    };
    (0..steps).map(step).collect()
}

fn saved(world: &World) -> Vec<u8> {
    let mut w = Writer::new();
    world.save(&mut w);
    w.into_bytes()
}

#[test]
fn object_results_do_not_depend_on_threads() {
    let mut alone = inhabited();
    let hashes = run(&mut alone, 240);
    for threads in [1, 2, 4] {
        let mut world = inhabited();
        for (step, hash) in hashes.iter().enumerate() {
            world.step_with(&Threads::new(threads), &NoProfiler);
            assert_eq!(world.hash(), *hash, "{threads} threads, step {step}: the hashes differ");
        }
    }
}

#[test]
fn restored_world_with_objects_continues_with_the_same_bits() {
    let mut world = inhabited();
    run(&mut world, 50);
    let bytes = saved(&world);
    let then = run(&mut world, 100);
    world.load(&mut Reader::new(&bytes)).expect("the snapshot must load");
    assert_eq!(saved(&world), bytes);
    assert_eq!(run(&mut world, 100), then);
}

#[test]
fn reset_restores_objects_ids_and_remaining_time() {
    let mut world = inhabited();
    run(&mut world, 30);
    world.update(core::time::Duration::from_millis(7));
    let removed = world.add_body(&BodyDef { kind: BodyKind::Static, ..BodyDef::default() });
    world.remove_body(removed);
    world.mark();
    let marked = saved(&world);
    let add = |world: &mut World| {
        let body = world.add_body(&BodyDef { kind: BodyKind::Static, ..BodyDef::default() });
        let object = world.add_object(Box::new(Counter::default()));
        (body, object, run(world, 60))
    };
    let first = add(&mut world);
    assert!(first.0 != removed);
    for _ in 0..3 {
        world.reset();
        assert_eq!(saved(&world), marked, "the reset must restore the time left for the next step");
        assert_eq!(*world.events(), Events::default());
        assert!(!world.contains(first.0) && !world.contains_object(first.1));
        assert_eq!(add(&mut world), first, "ids must repeat after the reset");
    }
}

#[test]
fn snapshots_add_and_remove_objects() {
    let mut world = mixed();
    let [first, second] = [3, 5].map(|asked| world.add_object(Box::new(Counter { asked })));
    let both = saved(&world);
    world.remove_object(first);
    let one = saved(&world);
    let third = world.add_object(Box::new(Counter { asked: 7 }));
    assert!(third != first, "a reused slot must get a new id");
    let other = saved(&world);

    // A world that lacks an object of a snapshot can load it only if the object's kind is registered.
    let unknown = world.load(&mut Reader::new(&both)).expect_err("the kind is not registered");
    assert!(unknown.to_string().starts_with("an object that is not there, of no known kind"), "{unknown}");
    assert_eq!(saved(&world), other, "a refused snapshot must not change the world");
    world.load(&mut Reader::new(&one)).expect("the snapshot with the second object must load");
    assert_eq!(world.object_ids().collect::<Vec<_>>(), [second]);
    world.register_kind(|| Box::new(Counter::default()));
    world.load(&mut Reader::new(&other)).expect("loading must create the third object");
    assert_eq!(world.object::<Counter>(third).asked, 7);
    world.load(&mut Reader::new(&both)).expect("loading must create the first object");
    assert!(!world.contains_object(third));
    assert_eq!([first, second].map(|id| world.object::<Counter>(id).asked), [3, 5]);

    let mut new = World::new(WorldDef::default());
    new.register_kind(|| Box::new(Counter::default()));
    new.load(&mut Reader::new(&both)).expect("a world with both kinds registered must load the snapshot");
    assert_eq!(new.hash(), { world.hash() });
}

/// Object that reads one byte less or more than it wrote.
struct Careless {
    reads: usize,
}

impl PhysicsObject for Careless {
    fn kind(&self) -> &'static str {
        "careless"
    }
    fn save(&self, w: &mut Writer) {
        w.u32(7);
    }
    fn load(&mut self, r: &mut Reader<'_>) -> Result<(), ReadError> {
        r.raw(self.reads).map(|_| ())
    }
}

#[test]
fn failed_object_load_returns_an_error_and_changes_nothing() {
    let mut world = mixed();
    let counter = world.add_object(Box::new(Counter { asked: 3 }));
    let careless = world.add_object(Box::new(Careless { reads: 4 }));
    let bytes = saved(&world);
    world.object_mut::<Counter>(counter).asked = 8;
    let before = saved(&world);
    // The failed load is undone, so the second object must be able to load its own state.
    for cut in (0..bytes.len()).step_by(41).chain(bytes.len() - 40..bytes.len()) {
        assert!(world.load(&mut Reader::new(&bytes[..cut])).is_err());
        assert_eq!(saved(&world), before, "cut at {cut}");
    }
    for reads in [3, 5] {
        world.object_mut::<Careless>(careless).reads = reads;
        assert!(
            panics(|| drop(world.load(&mut Reader::new(&bytes)))),
            "loading must panic if an object reads more or fewer bytes than it wrote"
        );
    }
}

#[test]
fn damaged_snapshots_with_objects_give_errors() {
    let mut world = inhabited();
    run(&mut world, 5);
    let bytes = saved(&world);
    let mut other = inhabited();
    let objects = bytes.len() - 150;
    for at in (0..objects).step_by(97).chain(objects..bytes.len()) {
        for flip in [0x01, 0x80, 0xff] {
            let mut wrong = bytes.clone();
            wrong[at] ^= flip;
            // Many damaged snapshots are valid, because the damage only changes a number.
            drop(other.load(&mut Reader::new(&wrong)));
        }
    }
}

#[test]
#[should_panic(expected = "is no ")]
fn object_of_another_type_is_refused() {
    let mut world = mixed();
    let id = world.add_object(Box::new(Counter::default()));
    world.object::<Bump>(id);
}

#[test]
#[should_panic(expected = "was removed")]
fn a_removed_object_is_refused() {
    let mut world = mixed();
    let id = world.add_object(Box::new(Counter::default()));
    world.remove_object(id);
    world.object::<Counter>(id);
}
