//! `sinew ragdoll export`: exported files read back give the same ragdoll.

use crate::contract::check_keys;
use crate::sinew::{Folder, gltf_files, shared_data, sinew};
use needs_data::needs_data;
use serde_json::Value;
use sinew::anim::{Rig, analyze};
use sinew::formats::{
    Document, ReadOptions, load_gltf, no_files, read_gltf, read_mjcf, write_khr, write_mjcf,
};
use sinew::math::limits::hinge_angle;
use sinew::math::{Affine, Rotation, Transform, Vec3};
use sinew::physics::{Hull, JointKind, Shape};
use sinew::ragdoll::mapping::character_from_model;
use sinew::ragdoll::{BuildOptions, RagdollBodyDef, RagdollDef, build};

fn built(rig: &Rig) -> RagdollDef {
    let analysis = analyze(rig).expect("a skin");
    build(rig, &analysis, &BuildOptions::default()).expect("bones").0
}

/// Checks that two transforms agree within 0.1 mm and 1e-3 rad.
fn assert_same(a: Transform, b: Transform, what: &str) {
    let (off, turned) = ((a.translation - b.translation).length(), a.rotation.angle_to(b.rotation));
    assert!(off < 1e-4 && turned < 1e-3, "{what}: error {off} m, {turned} rad");
}

/// Checks that our MuJoCo reader recovers the definition.
fn check_mjcf(def: &RagdollDef, text: &str, what: &str) {
    let model = read_mjcf(text.as_bytes()).unwrap_or_else(|error| panic!("{what}: {error}"));
    let back = model.to_ragdoll().unwrap_or_else(|error| panic!("{what}: {error}")).def;
    assert_eq!(back.bodies.len(), def.bodies.len(), "{what}");
    let own = |name: &str| def.bodies.iter().position(|body| body.bone == name).expect("a bone of ours");
    // The model may be higher if shapes reach below the soles.
    let is_in_place = |body: &&RagdollBodyDef| !is_moved(&def.bodies[own(&body.bone)].shape);
    let fixed = back.bodies.iter().find(is_in_place).expect("a body whose shape is not a hull");
    let height = |body: &RagdollBodyDef| body.character_from_body.translation.y;
    let lift = height(fixed) - height(&def.bodies[own(&fixed.bone)]);
    let lift = Transform::from_translation(Vec3::Y * lift);
    for body in &back.bodies {
        let was = &def.bodies[own(&body.bone)];
        let what = format!("{what} {}", was.role);
        assert!((body.mass.mass / was.mass.mass - 1.0).abs() < 1e-4, "{what}: {} kg", body.mass.mass);
        let (moments, before) = (body.mass.inertia.eigen().0, was.mass.inertia.eigen().0);
        assert!((moments - before).length() < 1e-3 * before.length(), "{what}: inertia {moments}, {before}");
        if !is_moved(&was.shape) {
            assert_same(lift * was.character_from_body, body.character_from_body, &what);
        }
        assert!(
            (body.shape.volume() / was.shape.volume() - 1.0).abs() < 1e-3 || is_changed(&was.shape),
            "{what}"
        );
    }
    for joint in &back.joints {
        let child = own(&back.bodies[joint.child].bone);
        let was = def.joints[child - 1];
        assert_eq!(back.bodies[joint.parent].bone, def.bodies[was.parent].bone, "{what}");
        let at = |def: &RagdollDef, body: usize, frame: Transform| {
            def.bodies[body].character_from_body.point(frame.translation)
        };
        let off = at(&back, joint.child, joint.frame_child) - lift.point(at(def, child, was.frame_child));
        // A weld has no pivot and no friction.
        if was.kind == JointKind::Fixed {
            assert_eq!(joint.kind, JointKind::Fixed, "{what}");
            continue;
        }
        assert!(off.length() < 1e-4, "{what}: a pivot is off by {off} m");
        assert_eq!(joint.friction_torque, was.friction_torque);
        if let (JointKind::Hinge { limit: Some(a) }, JointKind::Hinge { limit: Some(b) }) =
            (joint.kind, was.kind)
        {
            // The reader treats the pose of the file as zero.
            let turn = |body: usize| def.bodies[body].character_from_body.rotation;
            let parent = turn(was.parent) * was.frame_parent.rotation;
            let bind = hinge_angle(parent.inverse() * (turn(child) * was.frame_child.rotation));
            assert!(
                (a.lo + bind - b.lo).abs() + (a.hi + bind - b.hi).abs() < 1e-4,
                "{what}: ranges {a:?}, {b:?}"
            );
        }
    }
    let names = |def: &RagdollDef| {
        let mut pairs: Vec<[String; 2]> = def
            .disabled_pairs
            .iter()
            .map(|&(a, b)| {
                let mut pair = [def.bodies[a].bone.clone(), def.bodies[b].bone.clone()];
                pair.sort();
                pair
            })
            .collect();
        pairs.sort();
        pairs
    };
    let (kept, had) = (names(&back), names(def));
    assert!(had.iter().all(|pair| kept.contains(pair)), "{what}");
}

/// True for shapes whose bounding box has another centre: the body frame read back is there.
fn is_moved(shape: &Shape) -> bool {
    matches!(shape, Shape::Hull(_))
}

/// True for shapes that the format lacks.
fn is_changed(shape: &Shape) -> bool {
    matches!(shape, Shape::TaperedCapsule { .. } | Shape::Cone { .. } | Shape::Hull(_))
}

#[test]
fn mujoco_model_reads_back() {
    let folder = Folder::new("mjcf");
    let (file, out) = (folder.mannequin(), folder.path("mannequin.xml"));
    let object = sinew(&["ragdoll", "export", &file, "--as", "mjcf", "-o", &out, "--json"]).json();
    check_keys("ragdoll export", &object);
    let def = built(&load_gltf(&file, ReadOptions::default()).expect("a character").rig);
    let text = std::fs::read_to_string(&out).expect("written");
    check_mjcf(&def, &text, "mannequin");
    assert_eq!(object["bodies"], def.bodies.len());
}

#[needs_data]
#[test]
fn foreign_rigs_read_back_from_mujoco_models() {
    let data = shared_data();
    for file in gltf_files(&data.join("rigs")) {
        let document = load_gltf(&file, ReadOptions::default()).expect("a file of the collection");
        let Ok(analysis) = analyze(&document.rig) else { continue };
        let (def, _) = build(&document.rig, &analysis, &BuildOptions::default()).expect("bones");
        let names: std::collections::BTreeSet<&str> =
            def.bodies.iter().map(|body| body.bone.as_str()).collect();
        if names.len() == def.bodies.len() {
            check_mjcf(&def, &write_mjcf(&def, "x").text, &file);
        }
    }
}

/// A transform from the `translation` and `rotation` of a node.
fn local(node: &Value) -> Transform {
    let list = |key: &str, default: &[f64]| -> Vec<f32> {
        let given = node[key].as_array();
        let given = given.map(|list| list.iter().filter_map(Value::as_f64).collect::<Vec<_>>());
        given.unwrap_or_else(|| default.to_vec()).into_iter().map(|x| x as f32).collect()
    };
    let (t, r) = (list("translation", &[0.0; 3]), list("rotation", &[0.0, 0.0, 0.0, 1.0]));
    Transform::new(Vec3::from_slice(&t), Rotation::from_xyzw(r[0], r[1], r[2], r[3]))
}

/// Checks a joint against the draft: no linear motion, and the joint's range about each axis.
fn check_limits(kind: &JointKind, limits: &[Value], what: &str) {
    let of = |key: &str, axes: &[u64]| {
        let is = |limit: &&Value| {
            limit[key]
                .as_array()
                .is_some_and(|list| list.iter().filter_map(Value::as_u64).eq(axes.iter().copied()))
        };
        let limit = limits.iter().find(is)?;
        Some([limit["min"].as_f64()? as f32, limit["max"].as_f64()? as f32])
    };
    assert_eq!(of("linearAxes", &[0, 1, 2]), Some([0.0, 0.0]), "{what}");
    let range = |range: sinew::math::Range| Some([range.lo, range.hi]);
    match kind {
        JointKind::Ball { limit: Some(l) } => {
            let axes = [of("angularAxes", &[0]), of("angularAxes", &[1]), of("angularAxes", &[2])];
            assert_eq!(axes, [range(l.twist), range(l.swing_y), range(l.swing_z)], "{what}");
            let ends = [-l.swing_y.lo, l.swing_y.hi, -l.swing_z.lo, l.swing_z.hi];
            let widest = ends.into_iter().fold(0.0, sinew::math::max);
            assert_eq!(of("angularAxes", &[1, 2]), Some([0.0, widest]), "{what}");
        }
        JointKind::Universal { limit: Some(l) } => {
            assert_eq!(of("angularAxes", &[0]), Some([0.0, 0.0]), "{what}");
            assert_eq!(of("angularAxes", &[1]), range(l.swing_y), "{what}");
        }
        JointKind::Hinge { limit: Some(angle) } => {
            assert_eq!(of("angularAxes", &[0]), range(*angle), "{what}");
            assert_eq!(of("angularAxes", &[1, 2]), Some([0.0, 0.0]), "{what}");
        }
        JointKind::Fixed => assert_eq!(of("angularAxes", &[0, 1, 2]), Some([0.0, 0.0]), "{what}"),
        _ => {}
    }
}

/// A file with physics and its sources.
struct Written<'a> {
    def: &'a RagdollDef,
    document: &'a Document,
    bind_model: &'a [Affine],
    json: Value,
    what: &'a str,
}

impl Written<'_> {
    fn extension(&self, node: usize) -> &Value {
        &self.json["nodes"][node]["extensions"]["KHR_physics_rigid_bodies"]
    }

    fn physics(&self) -> &Value {
        &self.json["extensions"]["KHR_physics_rigid_bodies"]
    }

    fn children(&self, node: usize) -> Vec<usize> {
        let list = self.json["nodes"][node]["children"].as_array();
        list.into_iter().flatten().filter_map(Value::as_u64).map(|child| child as usize).collect()
    }

    fn node_of(&self, body: usize) -> usize {
        self.document.rig.joints[self.def.bodies[body].joint].source
    }

    /// A node under a body's bone, in character space.
    fn place(&self, body: usize, node: usize) -> Transform {
        let bone = self.bind_model[self.def.bodies[body].joint];
        let node = Affine::from(local(&self.json["nodes"][node]));
        (character_from_model(self.def) * bone * node).to_rigid()
    }

    fn check_body(&self, index: usize) {
        let body = &self.def.bodies[index];
        let what = format!("{} {}", self.what, body.role);
        let mass = self.extension(self.node_of(index))["motion"]["mass"].as_f64();
        assert_eq!(mass.map(|mass| mass as f32), Some(body.mass.mass), "{what}");
        let has_collider = |node: &usize| self.extension(*node).get("collider").is_some();
        let collider = self.children(self.node_of(index)).into_iter().find(has_collider);
        let collider = collider.unwrap_or_else(|| panic!("{what} has no collider"));
        if !is_changed(&body.shape) {
            assert_same(self.place(index, collider), body.character_from_body, &what);
        }
        let number = self.extension(collider)["collider"]["geometry"]["shape"].as_u64().expect("a shape");
        let shape = &self.json["extensions"]["KHR_implicit_shapes"]["shapes"][number as usize];
        let metre = self.def.unit_scale * self.bind_model[body.joint].linear.x_axis.length();
        let size = |of: &Value| of.as_f64().map(|size| size as f32 * metre);
        let sizes = match body.shape {
            Shape::Sphere { radius } => vec![(size(&shape["sphere"]["radius"]), radius)],
            Shape::Capsule { radius, half_height } if half_height > 0.0 => vec![
                (size(&shape["capsule"]["height"]), 2.0 * half_height),
                (size(&shape["capsule"]["radiusTop"]), radius),
            ],
            Shape::Box { half_extents } => vec![(size(&shape["box"]["size"][2]), 2.0 * half_extents.z)],
            _ => Vec::new(),
        };
        for (written, meant) in sizes {
            assert!(
                written.is_some_and(|size| (size - meant).abs() < 1e-3),
                "{what}: size of {shape}, expected {meant} m"
            );
        }
        assert!(shape[shape["type"].as_str().expect("a type")].is_object(), "{what}: {shape}");
    }

    fn check_joint(&self, index: usize) {
        let (joint, what) = (&self.def.joints[index], self.what);
        let is_link = |node: &usize| self.extension(*node)["joint"]["joint"] == index;
        let link = self.children(self.node_of(joint.parent)).into_iter().find(is_link);
        let link = link.unwrap_or_else(|| panic!("{what}: no node of joint {index}"));
        let pivot = self.extension(link)["joint"]["connectedNode"].as_u64().expect("a node") as usize;
        assert!(self.children(self.node_of(joint.child)).contains(&pivot), "{what}");
        let frame = |body: usize, frame: Transform| self.def.bodies[body].character_from_body * frame;
        assert_same(self.place(joint.parent, link), frame(joint.parent, joint.frame_parent), what);
        assert_same(self.place(joint.child, pivot), frame(joint.child, joint.frame_child), what);
        let described = &self.physics()["physicsJoints"][index];
        check_limits(&joint.kind, described["limits"].as_array().expect("limits"), what);
        let friction = described["extras"]["sinew"]["friction_torque"].as_f64();
        assert_eq!(friction.map(|torque| torque as f32), Some(joint.friction_torque), "{what}");
    }
}

/// Checks the file against the definition.
fn check_khr(def: &RagdollDef, document: &Document, bind_model: &[Affine], bytes: &[u8], what: &str) {
    let back = read_gltf(bytes, ReadOptions::default(), &mut no_files)
        .unwrap_or_else(|error| panic!("{what}: {error}"));
    for name in ["KHR_physics_rigid_bodies", "KHR_implicit_shapes"] {
        assert!(back.extensions().contains(&name), "{what}");
    }
    assert_eq!(back.clips.len(), document.clips.len(), "{what}");
    let written = Written { def, document, bind_model, json: back.json, what };
    (0..def.bodies.len()).for_each(|body| written.check_body(body));
    (0..def.joints.len()).for_each(|joint| written.check_joint(joint));
    let filters = &written.physics()["collisionFilters"];
    for &(a, b) in &def.disabled_pairs {
        let others = filters[a]["notCollideWithSystems"].as_array().expect("a list");
        assert!(others.contains(&filters[b]["collisionSystems"][0]), "{what}");
    }
}

#[test]
fn physics_added_to_the_users_file_reads_back() {
    let folder = Folder::new("khr");
    let (file, out) = (folder.mannequin(), folder.path("mannequin.khr.glb"));
    let object = sinew(&["ragdoll", "export", &file, "--as", "khr", "--json"]).json();
    check_keys("ragdoll export", &object);
    assert_eq!(object["outputs"][0], out.as_str());
    let document = load_gltf(&file, ReadOptions::default()).expect("a character");
    let analysis = analyze(&document.rig).expect("a skin");
    let bytes = std::fs::read(&out).expect("written");
    check_khr(&built(&document.rig), &document, &analysis.bind_model, &bytes, "mannequin");
    // The new nodes are not bones.
    let with_physics = load_gltf(&out, ReadOptions::default()).expect("a character still");
    let (before, after) = (built(&document.rig), built(&with_physics.rig));
    let sizes = |def: &RagdollDef| {
        def.bodies.iter().map(|body| (body.bone.clone(), body.shape.clone())).collect::<Vec<_>>()
    };
    assert_eq!(sizes(&before), sizes(&after));
    // A second export is an error.
    let again = sinew(&["ragdoll", "export", &out, "--as", "khr", "-o", &folder.path("twice.glb")]);
    assert!(again.refusal(1).contains("the file already has physics"), "{again:?}");
    let definition = folder.path("m.sinew.json");
    assert_eq!(sinew(&["ragdoll", "build", &file, "-o", &definition]).code, Some(0));
    let run = sinew(&["ragdoll", "export", &definition, "--as", "khr"]);
    assert!(run.refusal(1).contains("give that file, and this one with --ragdoll"), "{run:?}");
    let run = sinew(&["ragdoll", "export", &file, "--ragdoll", &definition, "--as", "khr", "-o", &out]);
    assert_eq!(run.code, Some(0), "{run:?}");
    assert_eq!(std::fs::read(&out).expect("written"), bytes);
}

#[needs_data]
#[test]
fn foreign_rigs_read_back_with_physics() {
    let data = shared_data();
    for file in gltf_files(&data.join("rigs")) {
        let document = load_gltf(&file, ReadOptions::default()).expect("a file of the collection");
        let Ok(analysis) = analyze(&document.rig) else { continue };
        let (def, _) = build(&document.rig, &analysis, &BuildOptions::default()).expect("bones");
        let written = write_khr(&document, &analysis.bind_model, &def);
        let written = written.unwrap_or_else(|error| panic!("{file}: {error}"));
        check_khr(&def, &document, &analysis.bind_model, &written.bytes, &file);
    }
}

/// Shapes, joints and names that the build never produces, but a person may write.
#[test]
fn every_shape_joint_and_name_is_written() {
    let folder = Folder::new("kinds");
    let document = load_gltf(folder.mannequin(), ReadOptions::default()).expect("a character");
    let analysis = analyze(&document.rig).expect("a skin");
    let mut def = built(&document.rig);
    let corner = |i: u8| {
        let side = |bit: u8| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
        Vec3::new(0.03 * side(0), 0.08 * side(1), 0.05 * side(2))
    };
    let hull = Hull::new(&(0..8).map(corner).collect::<Vec<_>>()).expect("a box is a hull");
    let shapes = [
        Shape::Hull(hull.into()),
        Shape::TaperedCapsule { half_height: 0.1, radius_bottom: 0.04, radius_top: 0.06 },
        Shape::Cone { half_height: 0.1, radius: 0.05 },
        Shape::Cylinder { half_height: 0.1, radius: 0.05 },
        Shape::Sphere { radius: 0.07 },
        Shape::Capsule { half_height: 0.0, radius: 0.07 },
    ];
    for (body, shape) in def.bodies.iter_mut().zip(shapes) {
        body.shape = shape;
    }
    def.joints[0].kind = JointKind::Fixed;
    def.joints[1].kind = JointKind::Ball { limit: None };
    def.joints[2].kind = JointKind::Hinge { limit: None };
    let khr = write_khr(&document, &analysis.bind_model, &def).expect("a file");
    check_khr(&def, &document, &analysis.bind_model, &khr.bytes, "kinds");
    assert!(khr.notes.iter().any(|note| note.contains("became the box around it")), "{:?}", khr.notes);
    def.bodies[3].bone = "<\"&'> \u{e9}".into();
    let mjcf = write_mjcf(&def, "a \"name\"");
    check_mjcf(&def, &mjcf.text, "kinds");
    for what in ["a hull became a box", "mean radius", "a cone became a cylinder", "hinges at right angles"] {
        assert!(mjcf.notes.iter().any(|note| note.contains(what)), "{what}: {:?}", mjcf.notes);
    }
    // Equal names of two bodies are made distinct.
    def.bodies[4].bone = def.bodies[3].bone.clone();
    let model = read_mjcf(write_mjcf(&def, "twins").text.as_bytes()).expect("a model");
    assert_eq!(model.bodies.len(), def.bodies.len() + 1);
}
