//! Ids of what was removed and of other worlds are refused, with what is wrong, at the caller.

use crate::build::sphere_body;
use sinew_math::{Reader, Vec3, Writer};
use sinew_physics::*;
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Once;

thread_local! {
    /// File in which the last panic of this thread is said to be.
    static PLACE: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Text of the panic of `f`, and the file in which it is said to be.
fn panic_of<T>(f: impl FnOnce() -> T) -> (String, String) {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            PLACE.set(info.location().map_or_else(String::new, |place| place.file().to_owned()));
            before(info);
        }));
    });
    let payload = catch_unwind(AssertUnwindSafe(f)).err().expect("it panics");
    let text = payload.downcast_ref::<String>().cloned().expect("a text with an id");
    (text, PLACE.take())
}

fn world() -> World {
    World::new(WorldDef::default())
}

#[test]
fn what_was_removed_is_named_at_the_caller() {
    let mut world = world();
    let gone = world.add_body(&sphere_body(0.1, Vec3::ZERO));
    world.remove_body(gone);
    let (text, file) = panic_of(|| world.velocity(gone));
    assert_eq!(text, "BodyId 0v0 was removed");
    assert!(file.ends_with("ids.rs"), "{file}");
    world.add_body(&sphere_body(0.1, Vec3::ZERO));
    assert_eq!(panic_of(|| world.transform(gone)).0, "BodyId 0v0 was removed");
    assert_eq!(panic_of(|| world.apply_impulse(gone, Vec3::X, Vec3::ZERO)).0, "BodyId 0v0 was removed");
    assert!(!world.contains(gone));
}

#[test]
fn ids_of_another_world_are_refused() {
    let (mut one, mut other) = (world(), world());
    let mine = one.add_body(&sphere_body(0.1, Vec3::ZERO));
    let theirs = other.add_body(&sphere_body(0.1, Vec3::X));
    let (text, file) = panic_of(|| one.transform(theirs));
    assert_eq!(text, "BodyId 0v0 is of another world");
    assert!(file.ends_with("ids.rs"), "{file}");
    assert!(!one.contains(theirs) && one.contains(mine));
    assert_eq!(panic_of(|| one.remove_body(theirs)).0, "BodyId 0v0 is of another world");
    assert!(one.contains(mine));
    let field = other.add_field(&FieldDef::new(FieldKind::Mutual(MutualGravity::default())));
    assert_eq!(panic_of(|| one.field(field)).0, "FieldId 0v0 is of another world");
}

/// Bits do not tell the world: a game keeps them in its own files.
#[test]
fn ids_from_bits_go_with_any_world() {
    let (mut one, mut other) = (world(), world());
    let mine = one.add_body(&sphere_body(0.1, Vec3::ZERO));
    let theirs = other.add_body(&sphere_body(0.1, Vec3::X));
    let bits = BodyId::from_bits(theirs.to_bits());
    assert_eq!(one.transform(bits).translation, Vec3::ZERO);
    assert_eq!(bits, mine);
    assert_eq!(panic_of(|| one.transform(BodyId::from_bits(7))).0, "BodyId 7v0 was never in this world");
}

/// Who loads the snapshot of another world goes on using that one's ids, and neither hash tells which world it is.
#[test]
fn a_snapshot_goes_with_any_world() {
    let (mut one, mut other) = (world(), world());
    let mine = one.add_body(&sphere_body(0.1, Vec3::ZERO));
    let theirs = other.add_body(&sphere_body(0.1, Vec3::ZERO));
    assert_eq!(one.hash(), other.hash());
    let mut bytes = Writer::new();
    other.save(&mut bytes);
    one.load(&mut Reader::new(bytes.as_bytes())).expect("a snapshot");
    one.step();
    other.step();
    assert_eq!(one.hash(), other.hash());
    assert_eq!(one.transform(mine), other.transform(theirs));
    assert_eq!(one.transform(theirs), other.transform(theirs));
    one.remove_body(theirs);
    assert_eq!(panic_of(|| one.transform(mine)).0, "BodyId 0v0 was removed");
}
