//! Mistakes of callers return a status and an error text, never crash, and leave the world unchanged.

use sinew_c::*;
use std::ffi::{CStr, CString};
use std::ptr::{null, null_mut};

/// Returns the text of the last error.
fn sentence() -> String {
    // SAFETY: the pointer is always a valid string.
    unsafe { CStr::from_ptr(sinew_last_error()) }.to_str().expect("UTF-8").to_owned()
}

struct Owned(*mut SinewWorld);

impl Drop for Owned {
    fn drop(&mut self) {
        // SAFETY: created below, and freed once.
        unsafe { sinew_world_free(self.0) }
    }
}

fn world() -> Owned {
    let mut world = null_mut();
    // SAFETY: null selects the defaults, and `world` has room for a pointer.
    assert_eq!(unsafe { sinew_world_new(null(), &mut world) }, SinewStatus::Ok);
    Owned(world)
}

fn ball() -> SinewShape {
    SinewShape { kind: SinewShapeKind::Sphere as u32, size: SinewVec3 { x: 0.5, y: 0.0, z: 0.0 } }
}

fn def(shapes: &[SinewShape]) -> SinewBodyDef {
    let mut def = std::mem::MaybeUninit::uninit();
    // SAFETY: the buffer has room for one definition.
    let mut def = unsafe {
        assert_eq!(sinew_body_def_default(def.as_mut_ptr()), SinewStatus::Ok);
        def.assume_init()
    };
    (def.shapes, def.shape_count) = (shapes.as_ptr(), shapes.len());
    def
}

fn add(world: &Owned) -> SinewBodyId {
    let (shapes, mut id) = ([ball()], SinewBodyId::default());
    // SAFETY: all pointers are valid.
    let status = unsafe { sinew_world_add_body(world.0, &def(&shapes), &mut id) };
    assert_eq!(status, SinewStatus::Ok, "{}", sentence());
    id
}

#[test]
fn null_pointers_are_named() {
    let world = world();
    let (shapes, mut steps, mut pose) = ([ball()], 0, SinewPose::default());
    // SAFETY: null must be reported as an error.
    unsafe {
        assert_eq!(sinew_world_new(null(), null_mut()), SinewStatus::NullPointer);
        assert_eq!(sentence(), "world is null");
        assert_eq!(sinew_world_step(null_mut(), 1, 1), SinewStatus::NullPointer);
        assert_eq!(sinew_world_step_count(null(), &mut steps), SinewStatus::NullPointer);
        assert_eq!(sinew_world_step_count(world.0, null_mut()), SinewStatus::NullPointer);
        assert_eq!(sentence(), "steps is null");
        assert_eq!(sinew_world_add_body(world.0, null(), null_mut()), SinewStatus::NullPointer);
        assert_eq!(sinew_world_add_body(world.0, &def(&shapes), null_mut()), SinewStatus::NullPointer);
        let mut count = 7;
        assert_eq!(sinew_world_bodies(world.0, null_mut(), 0, &mut count), SinewStatus::Ok);
        assert_eq!(count, 0, "the call added a body although the id array was full");
        let torn = SinewBodyDef { shapes: null(), shape_count: 3, ..def(&shapes) };
        let mut id = SinewBodyId::default();
        assert_eq!(sinew_world_add_body(world.0, &torn, &mut id), SinewStatus::NullPointer);
        assert_eq!(sinew_world_poses(world.0, null(), 2, &mut pose), SinewStatus::NullPointer);
        assert_eq!(sinew_world_load(world.0, null(), 4), SinewStatus::NullPointer);
        assert_eq!(sinew_character_update(null_mut(), world.0), SinewStatus::NullPointer);
        assert_eq!(sinew_character_despawn(null_mut(), world.0), SinewStatus::NullPointer);
        assert_eq!(sinew_ragdoll_load(null(), null_mut()), SinewStatus::NullPointer);
        sinew_world_free(null_mut());
        sinew_character_free(null_mut());
        sinew_character_def_free(null_mut());
        sinew_ragdoll_free(null_mut());
        assert_eq!(sinew_world_step(world.0, 1, 1), SinewStatus::Ok);
        assert_eq!(sentence(), "", "a successful call left an error text");
    }
}

#[test]
fn removed_and_unknown_ids_are_stale() {
    let (world, other) = (world(), world());
    let id = add(&world);
    let (mut pose, mut gap) = (SinewPose::default(), 0.0);
    // SAFETY: all pointers are valid.
    unsafe {
        assert_eq!(sinew_world_poses(other.0, &id, 1, &mut pose), SinewStatus::StaleId);
        assert_eq!(sinew_world_remove_body(world.0, id), SinewStatus::Ok);
        assert_eq!(sinew_world_remove_body(world.0, id), SinewStatus::StaleId);
        let next = add(&world);
        assert_ne!(next, id, "the id is used again");
        assert_eq!(sinew_world_push(world.0, id, SinewVec3::default(), null()), SinewStatus::StaleId);
        assert_eq!(sinew_world_set_pose(world.0, id, pose), SinewStatus::StaleId);
        assert_eq!(sinew_world_joint_gap(world.0, SinewJointId { bits: 3 }, &mut gap), SinewStatus::StaleId);
        assert!(sentence().contains("no joint 0x3"), "{}", sentence());
        let wild = SinewBodyId { bits: u64::MAX };
        assert_eq!(sinew_world_poses(world.0, &wild, 1, &mut pose), SinewStatus::StaleId);
    }
}

#[test]
fn invalid_numbers_leave_the_world_unchanged() {
    let world = world();
    let id = add(&world);
    let hash = || {
        let mut hash = 0;
        // SAFETY: both pointers are valid.
        assert_eq!(unsafe { sinew_world_hash(world.0, &mut hash) }, SinewStatus::Ok);
        hash
    };
    let before = hash();
    let nan = SinewVec3 { x: f32::NAN, y: 0.0, z: 0.0 };
    let shapes = [ball()];
    let flat = [SinewShape { size: SinewVec3::default(), ..ball() }];
    let unknown = [SinewShape { kind: 99, ..ball() }];
    let plane = [SinewShape { kind: SinewShapeKind::HalfSpace as u32, ..ball() }];
    let (mut out, mut count) = (SinewBodyId::default(), 0);
    // SAFETY: all pointers are valid.
    unsafe {
        let bad = |status: SinewStatus| assert_eq!(status, SinewStatus::BadArgument, "{}", sentence());
        bad(sinew_world_push(world.0, id, nan, null()));
        assert!(sentence().contains("the impulse is not finite"), "{}", sentence());
        bad(sinew_world_set_pose(world.0, id, SinewPose { position: nan, ..SinewPose::default() }));
        bad(sinew_world_add_body(world.0, &def(&flat), &mut out));
        bad(sinew_world_add_body(world.0, &def(&unknown), &mut out));
        bad(sinew_world_add_body(world.0, &def(&plane), &mut out));
        bad(sinew_world_add_body(world.0, &def(&[]), &mut out));
        bad(sinew_world_add_body(world.0, &SinewBodyDef { kind: 5, ..def(&shapes) }, &mut out));
        bad(sinew_world_add_body(world.0, &SinewBodyDef { mass: -1.0, ..def(&shapes) }, &mut out));
        bad(sinew_world_add_body(world.0, &SinewBodyDef { friction: f32::NAN, ..def(&shapes) }, &mut out));
        bad(sinew_world_add_body(
            world.0,
            &SinewBodyDef { shape_count: usize::MAX, ..def(&shapes) },
            &mut out,
        ));
        bad(sinew_world_overlap(world.0, plane[0], SinewPose::default(), null_mut(), 0, &mut count));
        bad(sinew_world_events(world.0, 17, null_mut(), 0, &mut count));
        let mut hinge = SinewJointDef {
            kind: SinewJointKind::Hinge as u32,
            a: id,
            b: id,
            anchor: SinewVec3::default(),
            anchor_b: SinewVec3::default(),
            axis: SinewVec3 { x: 1.0, y: 0.0, z: 0.0 },
            has_range: 0,
            range_lo: 0.0,
            range_hi: 0.0,
        };
        let mut joint = SinewJointId::default();
        bad(sinew_world_add_joint(world.0, &hinge, &mut joint));
        assert!(sentence().contains("two bodies"), "{}", sentence());
        hinge.axis = SinewVec3::default();
        bad(sinew_world_add_joint(world.0, &hinge, &mut joint));
        let mut none = null_mut();
        let no_time = SinewWorldDef {
            gravity: SinewVec3::default(),
            step_nanoseconds: 0,
            substeps: 4,
            quality: 1,
            sleeping: 1,
        };
        bad(sinew_world_new(&no_time, &mut none));
        assert!(none.is_null());
    }
    assert_eq!(hash(), before);
}

#[test]
fn small_buffers_return_the_needed_size() {
    let world = world();
    add(&world);
    add(&world);
    let (mut one, mut count) = ([SinewBodyId { bits: 42 }], 0);
    // SAFETY: the capacity is that of the buffer.
    unsafe {
        assert_eq!(sinew_world_bodies(world.0, one.as_mut_ptr(), 1, &mut count), SinewStatus::TooSmall);
        assert_eq!((one[0].bits, count), (42, 2), "nothing is written");
        let mut size = 0;
        assert_eq!(sinew_world_save(world.0, null_mut(), 0, &mut size), SinewStatus::TooSmall);
        let mut bytes = vec![0; size];
        assert_eq!(sinew_world_save(world.0, bytes.as_mut_ptr(), size, &mut size), SinewStatus::Ok);
        for cut in [0, 1, 8, size / 2, size - 1] {
            assert_eq!(
                sinew_world_load(world.0, bytes.as_ptr(), cut),
                SinewStatus::BadSnapshot,
                "{cut} bytes"
            );
        }
        assert_eq!(sinew_world_load(world.0, bytes.as_ptr(), size), SinewStatus::Ok);
    }
}

#[test]
fn errors_of_files_name_the_file_and_the_place() {
    let mut def = null_mut();
    let mut ragdoll = null_mut();
    let folder = std::env::temp_dir();
    let broken = folder.join(format!("sinew-c-{}.glb", std::process::id()));
    std::fs::write(&broken, b"glTF but not for long").expect("the file can be written");
    let path = |path: &std::path::Path| CString::new(path.display().to_string()).expect("no zeros");
    // SAFETY: text and buffer are valid.
    unsafe {
        let none = path(&folder.join("there is no such file.glb"));
        assert_eq!(sinew_character_def_load(none.as_ptr(), &mut def), SinewStatus::BadFile);
        assert!(sentence().contains("there is no such file.glb"), "{}", sentence());
        assert_eq!(sinew_character_def_load(path(&broken).as_ptr(), &mut def), SinewStatus::BadFile);
        assert!(sentence().contains("sinew-c-") && sentence().contains("("), "{}", sentence());
        assert_eq!(sinew_ragdoll_load(path(&broken).as_ptr(), &mut ragdoll), SinewStatus::BadFile);
        assert_eq!(sinew_ragdoll_load(c"\xff".as_ptr(), &mut ragdoll), SinewStatus::BadArgument);
        assert!(def.is_null() && ragdoll.is_null());
    }
    std::fs::remove_file(&broken).expect("the file can be removed");
}

#[test]
fn a_character_in_a_world_that_is_not_its_own_is_an_error() {
    let (here, elsewhere) = (world(), world());
    let (mut def, mut character) = (null_mut(), null_mut());
    let origin = SinewPose::default();
    // SAFETY: all pointers are valid; each handle is freed once.
    unsafe {
        assert_eq!(sinew_character_def_load(null(), &mut def), SinewStatus::Ok, "{}", sentence());
        assert_eq!(
            sinew_character_spawn(def, here.0, origin, &mut character),
            SinewStatus::Ok,
            "{}",
            sentence()
        );
        assert_eq!(sinew_character_update(character, elsewhere.0), SinewStatus::StaleId);
        let wrong = sinew_character_hit(character, here.0, c"wing".as_ptr(), SinewVec3::default());
        assert_eq!(wrong, SinewStatus::BadArgument);
        assert!(sentence().contains("'wing'") && sentence().contains("leftUpperArm"), "{}", sentence());
        assert_eq!(sinew_character_load(character, [1, 2, 3].as_ptr(), 3), SinewStatus::BadSnapshot);
        assert_eq!(sinew_character_update(character, here.0), SinewStatus::Ok, "{}", sentence());
        assert_eq!(sinew_character_despawn(character, here.0), SinewStatus::Ok, "{}", sentence());
        let mut count = 7;
        assert_eq!(sinew_world_bodies(here.0, null_mut(), 0, &mut count), SinewStatus::Ok);
        assert_eq!(count, 0, "bodies remain");
        sinew_character_def_free(def);
    }
}
