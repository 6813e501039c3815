//! Editing of a ragdoll: by fields of the definition, by keys, by handles in the picture; dropped again and saved.

use crate::files::{folder, mannequin_glb};
use crate::hands::{settled, viewer};
use crate::pictures::look;
use egui::Key;
use sinew::anim::roles::{Role, Side};
use sinew::formats::{read_ragdoll, write_ragdoll};
use sinew::math::Range;
use sinew::ragdoll::RagdollDef;
use sinew::ragdoll::settings::{BodyWish, BoneSettings, ShapeWish};
use sinew_viewer::{Headless, Session, Subject, limits};

const SIZE: [u32; 2] = [1280, 760];

/// Returns a viewer of the mannequin as a dropped file, paused.
pub fn bench(name: &str) -> Option<Headless> {
    let mut viewer = viewer("pendulum", SIZE)?;
    let path = folder(name).join("mannequin.glb");
    std::fs::write(&path, mannequin_glb()).expect("the folder exists");
    viewer.app_mut().open_file(&path);
    settled(&mut viewer);
    Some(viewer)
}

fn def(viewer: &Headless) -> &RagdollDef {
    viewer.app().session().workbench().expect("a ragdoll").def()
}

fn place(def: &RagdollDef, role: &str) -> usize {
    def.bodies.iter().position(|body| body.role == role).expect("the ragdoll has this body")
}

/// Returns the ranges of the joint of a body, degrees.
fn degrees(def: &RagdollDef, role: &str) -> [Option<[f32; 2]>; 3] {
    let child = place(def, role);
    let joint =
        def.joints.iter().find(|joint| joint.child == child).expect("the body has a joint to its parent");
    limits(&joint.kind).map(|range| range.map(|Range { lo, hi }| [lo.to_degrees(), hi.to_degrees()]))
}

/// Selects a body by keys.
pub fn choose(viewer: &mut Headless, role: &str) {
    let times = place(def(viewer), role) + 1;
    for _ in 0..times {
        viewer.key(Key::CloseBracket);
        viewer.frame().expect("the card draws");
    }
    let line = viewer.app().message().expect("the message names the body").to_owned();
    assert!(line.starts_with(&format!("chose {role} ")), "{line}");
}

/// Returns the saved file, read again.
fn saved(viewer: &mut Headless) -> RagdollDef {
    viewer.ctrl(Key::S);
    viewer.frame().expect("the card draws");
    let files = viewer.app_mut().take_files();
    let [file] = &files[..] else { panic!("{} files", files.len()) };
    assert_eq!(file.name, "mannequin.sinew.json");
    read_ragdoll(&file.bytes).expect("the written ragdoll can be read")
}

#[test]
fn limit_changed_by_keys_is_saved() {
    let Some(mut viewer) = bench("edited_by_keys") else { return };
    choose(&mut viewer, "leftUpperArm");
    let before = degrees(def(&viewer), "leftUpperArm");
    for _ in 0..4 {
        viewer.key(Key::Minus);
        viewer.frame().expect("the card draws");
    }
    let after = degrees(&saved(&mut viewer), "leftUpperArm");
    println!("{before:.1?} became {after:.1?}");
    let [Some([lo, hi]), ..] = before else { panic!("it swings") };
    let [Some(y), ..] = after else { panic!("it swings") };
    assert!((y[0] - f32::min(lo + 20.0, 0.0)).abs() < 0.01 && (y[1] - f32::max(hi - 20.0, 0.0)).abs() < 0.01);
    assert_eq!(degrees(def(&viewer), "rightUpperArm"), degrees(&saved(&mut viewer), "rightUpperArm"));
    // The ragdoll is dropped again, with the new limits.
    assert_eq!(viewer.app().session().world().step_count(), 0);
    let world = viewer.app().session().world();
    let ragdoll = viewer.app().session().ragdoll();
    let arm = ragdoll[place(def(&viewer), "leftUpperArm")];
    let joint = world.joints_of(arm).map(|id| world.joint(id)).find(|joint| joint.body_b == arm);
    let [Some(range), ..] = limits(&joint.expect("the body has a joint to its parent").kind) else {
        panic!("it swings")
    };
    assert!((range.hi.to_degrees() - y[1]).abs() < 0.01);
}

/// The mouse drags the handle of a limit, and the limit follows.
#[test]
fn dragging_a_handle_changes_a_limit() {
    let Some(mut viewer) = bench("edited_by_handles") else { return };
    choose(&mut viewer, "rightUpperLeg");
    let before = degrees(def(&viewer), "rightUpperLeg");
    settled(&mut viewer);
    let list = viewer.app().handles();
    println!("{list:?}");
    let (_, at) = list.iter().find(|(name, _)| *name == "swing z high").copied().expect("the handle exists");
    viewer.move_to(at.x, at.y);
    viewer.button(at.x, at.y, true);
    viewer.frame().expect("the card draws");
    for i in 1..=10 {
        viewer.move_to(at.x + 4.0 * i as f32, at.y + 3.0 * i as f32);
        viewer.frame().expect("the card draws");
    }
    look("handle", &viewer.frame().expect("the card draws"));
    viewer.button(at.x + 40.0, at.y + 30.0, false);
    viewer.frame().expect("the card draws");
    let after = degrees(def(&viewer), "rightUpperLeg");
    println!("{before:.1?} became {after:.1?}");
    assert_eq!(before[0], after[0], "the other range must not change");
    let [_, Some(z), _] = before.map(|it| it.map(|[_, hi]| hi)) else { panic!("it swings") };
    let [_, Some(new), _] = after.map(|it| it.map(|[_, hi]| hi)) else { panic!("it swings") };
    assert!((z - new).abs() > 3.0, "{z}° and then {new}°");
    settled(&mut viewer);
    let (_, now) = viewer
        .app()
        .handles()
        .into_iter()
        .find(|(name, _)| *name == "swing z high")
        .expect("the handle exists");
    let (was, goal) = (at, egui::pos2(at.x + 40.0, at.y + 30.0));
    assert!((now - goal).length() < (was - goal).length(), "moved from {was:?} to {now:?}, target {goal:?}");
    // Dragging the side of the shape outward enlarges the body.
    let (_, at) =
        viewer.app().handles().into_iter().find(|(name, _)| *name == "size").expect("the handle exists");
    let center = {
        let session = viewer.app().session();
        let body = session.ragdoll()[place(def(&viewer), "rightUpperLeg")];
        viewer.app().on_screen(session.world().center_of_mass(body)).expect("the body is visible")
    };
    let volume =
        |viewer: &Headless| def(viewer).bodies[place(def(viewer), "rightUpperLeg")].shape.bounding_radius();
    let small = volume(&viewer);
    let way = (at - center).normalized() * 12.0;
    viewer.move_to(at.x, at.y);
    viewer.button(at.x, at.y, true);
    viewer.frame().expect("the card draws");
    for i in 1..=3 {
        viewer.move_to(at.x + way.x * i as f32, at.y + way.y * i as f32);
        viewer.frame().expect("the card draws");
    }
    viewer.button(at.x + way.x * 3.0, at.y + way.y * 3.0, false);
    viewer.frame().expect("the card draws");
    look("grown", &settled(&mut viewer));
    assert!(volume(&viewer) > 1.1 * small, "{small} m, then {} m", volume(&viewer));
}

/// Roles, shapes and masses: each change builds the rig anew.
#[test]
fn edited_roles_shapes_and_masses_apply() {
    let path = folder("edited_all").join("mannequin.glb");
    std::fs::write(&path, mannequin_glb()).expect("the folder exists");
    let mut session = Session::start(Subject::file(&path).expect("the file can be read"))
        .expect("the character can be opened");
    let def = |session: &Session| session.workbench().expect("a ragdoll").def().clone();
    let head = place(&def(&session), "head");
    let wish = BoneSettings { shape: Some(ShapeWish::Sphere), mass: Some(7.5), ..BoneSettings::default() };
    session.edit(head, wish).expect("the edited ragdoll can be built");
    let built = def(&session);
    assert!(matches!(built.bodies[head].shape, sinew::physics::Shape::Sphere { .. }));
    assert!((built.bodies[head].mass.mass - 7.5).abs() < 1e-3);
    let world = session.world();
    assert!(
        (world.mass(session.ragdoll()[head]).mass - 7.5).abs() < 1e-3,
        "the body must have the edited mass"
    );
    // A body without hips is refused with a message, and nothing changes.
    let dropped = BoneSettings { body: Some(BodyWish::Drop), ..BoneSettings::default() };
    let line = session.edit(place(&built, "hips"), dropped).expect_err("the hips cannot be removed");
    println!("{line}");
    assert_eq!(def(&session), built);
    // Another role: the left shin gets the given one.
    let (shin, foot) = (place(&built, "leftLowerLeg"), place(&built, "leftFoot"));
    let bone = built.bodies[foot].bone.clone();
    let told = BoneSettings { role: Some(Role::Toes(Side::Left)), ..BoneSettings::default() };
    session.edit(foot, told).expect("the edited ragdoll can be built");
    let other = def(&session);
    let now = other.bodies.iter().find(|body| body.bone == bone || body.role == "leftToes");
    println!("{bone}: {now:?}");
    assert!(
        other.bodies.iter().all(|body| body.role != "leftFoot" || body.bone != bone),
        "the bone must lose the role of a foot"
    );
    assert_eq!(other.bodies[shin].role, "leftLowerLeg");
    let foot = other.bodies.iter().position(|body| body.bone == bone);
    if let Some(foot) = foot {
        session.edit(foot, BoneSettings::default()).expect("the edited ragdoll can be built");
        assert_eq!(def(&session).bodies.len(), built.bodies.len());
    }
    assert_eq!(session.workbench().expect("a ragdoll").wish(head), wish);
    session.edit(head, BoneSettings::default()).expect("the edited ragdoll can be built");
    assert!(def(&session).bodies[head].mass.mass < 6.0);
}

/// A ragdoll file has no rig: masses and limits change, shapes and roles are refused with a message.
#[test]
fn definition_without_a_rig_rejects_changes_of_shape() {
    let mannequin = sinew::mannequin::character();
    let path = folder("edited_file").join("mannequin.sinew.json");
    std::fs::write(&path, write_ragdoll(&mannequin.ragdoll)).expect("the folder exists");
    let mut session = Session::start(Subject::file(&path).expect("the file can be read"))
        .expect("the ragdoll can be opened");
    let arm = place(&mannequin.ragdoll, "leftLowerArm");
    let wish =
        BoneSettings { mass: Some(3.0), twist: Some(Range::degrees(-5.0, 60.0)), ..BoneSettings::default() };
    session.edit(arm, wish).expect("the edited ragdoll can be built");
    let bench = session.workbench().expect("a ragdoll");
    assert!((bench.def().bodies[arm].mass.mass - 3.0).abs() < 1e-6);
    let twist = degrees(bench.def(), "leftLowerArm")[2].expect("an elbow has an angle");
    assert!((twist[0] + 5.0).abs() < 1e-3 && (twist[1] - 60.0).abs() < 1e-3, "{twist:?}");
    assert_eq!(session.ragdoll().len(), bench.def().bodies.len());
    let round = BoneSettings { shape: Some(ShapeWish::Box), ..wish };
    assert!(session.edit(arm, round).expect_err("no rig").contains("rig"));
    assert_eq!(session.workbench().expect("a ragdoll").wish(arm), wish);
}
