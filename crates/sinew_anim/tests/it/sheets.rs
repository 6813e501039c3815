//! Meshes as sheets of cloth: welded, reduced, held, hung on joints.

use sinew_anim::garments::{MOST_PARTICLES, MeshPart, SheetError, SheetOptions, lay_sheet};
use sinew_anim::{
    GarmentColumn, Joint, LocalTransform, Primitive, Rig, RigMesh, Skin, guess_springs, local_to_model,
    rest_pose, skin_vertices,
};
use sinew_math::{Affine, Rotation, Vec3};

const SPACING: f32 = 0.05;

/// A cloth of a metre by a metre that hangs from y = 1 in the plane of x and y, of so many cells along each side, on two joints: one above the other.
fn rig(cells: usize) -> Rig {
    let turned = Rotation::from_axis_angle(Vec3::Z, 0.3);
    let joint =
        |name: &str, parent, rest: LocalTransform, source| Joint { name: name.into(), parent, rest, source };
    let upper = LocalTransform { translation: Vec3::Y, rotation: turned, ..LocalTransform::default() };
    let lower = LocalTransform { translation: Vec3::NEG_Y, ..LocalTransform::default() };
    let mut rig = Rig {
        joints: vec![
            joint("upper", None, upper, 0),
            joint("lower", Some(0), lower, 1),
            joint("Flag", None, LocalTransform::default(), 2),
        ],
        ..Rig::default()
    };
    let bind = bind(&rig);
    let inverse_bind = [0, 1].map(|at: usize| bind[at].inverse()).to_vec();
    rig.skins.push(Skin { name: String::new(), joints: vec![0, 1], inverse_bind });
    let mut primitive = Primitive { material: "silk".into(), ..Primitive::default() };
    for row in 0..=cells {
        for column in 0..=cells {
            let [x, y] = [column, row].map(|at| at as f32 / cells as f32);
            primitive.positions.push(Vec3::new(x, 1.0 - y, 0.0));
            primitive.normals.push(Vec3::Z);
            primitive.joints.push([0, 1, 0, 0]);
            primitive.weights.push([1.0 - y, y, 0.0, 0.0]);
        }
    }
    for row in 0..cells {
        for column in 0..cells {
            let a = (row * (cells + 1) + column) as u32;
            let c = a + cells as u32 + 1;
            primitive.indices.extend([a, c, c + 1, a, c + 1, a + 1]);
        }
    }
    rig.meshes.push(RigMesh {
        name: "flag_mesh".into(),
        joint: 2,
        skin: Some(0),
        primitives: vec![primitive],
    });
    rig
}

fn bind(rig: &Rig) -> Vec<Affine> {
    let mut model = Vec::new();
    local_to_model(rig, &rest_pose(rig), &Affine::IDENTITY, &mut model);
    model
}

fn lay(rig: &mut Rig, most_particles: usize, held: Option<f32>) -> Result<usize, SheetError> {
    let bind_model = bind(rig);
    let part = MeshPart::named(rig, "Flag")?;
    let first_source = rig.joints.len();
    let options = SheetOptions {
        bind_model: &bind_model,
        metres_from_model: Affine::IDENTITY,
        spacing: SPACING,
        held,
        most_particles,
        first_source,
    };
    lay_sheet(rig, &part, &options)
}

fn drawn(rig: &Rig, pose: &[LocalTransform]) -> Vec<Vec3> {
    let (mut model, mut places, mut normals) = (Vec::new(), Vec::new(), Vec::new());
    local_to_model(rig, pose, &Affine::IDENTITY, &mut model);
    skin_vertices(rig, 0, 0, &model, &mut places, &mut normals);
    places
}

fn farthest(a: &[Vec3], b: &[Vec3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (*a - *b).length()).fold(0.0, f32::max)
}

#[test]
fn a_fine_mesh_is_reduced_to_its_spacing_and_drawn_as_it_was() {
    let mut it = rig(80);
    let before = drawn(&it, &rest_pose(&it));
    let sheet = lay(&mut it, 2000, None).expect("it can be cloth");
    let sheet = &it.sheets[sheet];
    assert_eq!(sheet.vertices, 81 * 81);
    // Particles that cover a square metre so that none of it is farther than 25 mm from one; of a hexagonal grid it takes 616, of a square one 800.
    assert!((616..1400).contains(&sheet.joints.len()), "{}", sheet.joints.len());
    let place = bind(&it);
    let at = |particle: u32| place[sheet.joints[particle as usize]].translation;
    let longest = sheet.links.iter().map(|&[a, b]| (at(a) - at(b)).length()).fold(0.0, f32::max);
    assert!(longest <= SPACING + 2.0 / 80.0, "{longest}");
    let area: f32 =
        sheet.faces.iter().map(|f| (at(f[1]) - at(f[0])).cross(at(f[2]) - at(f[0])).length() / 2.0).sum();
    assert!((0.97..1.01).contains(&area), "its borders stay where they are: {area} m²");
    assert!(farthest(&before, &drawn(&it, &rest_pose(&it))) < 1e-5);
    // Nothing moves its joints, and it goes along with the old ones.
    let mut pose = rest_pose(&it);
    pose[0].translation += Vec3::X * 3.0;
    let moved: Vec<Vec3> = before.iter().map(|&place| place + Vec3::X * 3.0).collect();
    assert!(farthest(&moved, &drawn(&it, &pose)) < 1e-5);
    // A particle takes its own vertex along, and none a metre away.
    let mut pose = rest_pose(&it);
    pose[sheet.joints[0]].translation += Vec3::Z;
    let bulge: Vec<f32> = drawn(&it, &pose).iter().map(|place| place.z.abs()).collect();
    assert!(bulge.iter().copied().fold(0.0, f32::max) > 0.99);
    assert!(bulge.iter().filter(|z| **z > 1e-4).count() < 81 * 81 / 50);
}

#[test]
fn there_are_never_more_particles_than_were_asked_for() {
    for most in [4, 30, MOST_PARTICLES] {
        let mut it = rig(60);
        let sheet = lay(&mut it, most, None).expect("it can be cloth");
        let count = it.sheets[sheet].joints.len();
        assert!(count <= most && count > most / 2, "{count} of {most}");
    }
}

#[test]
fn a_coarse_mesh_has_a_particle_for_each_vertex_and_is_held_as_deep_as_was_said() {
    for (held, rows) in [(None, 2), (Some(0.35), 4), (Some(0.0), 1)] {
        let mut it = rig(10);
        let sheet = lay(&mut it, 400, held).expect("it can be cloth");
        let sheet = &it.sheets[sheet];
        assert_eq!((sheet.joints.len(), sheet.faces.len(), sheet.links.len()), (121, 200, 320));
        assert_eq!(sheet.held.iter().filter(|held| **held).count(), 11 * rows, "{held:?}");
        // Each hangs from the joint that moved its vertex most.
        let parents: Vec<_> = sheet.joints.iter().map(|&joint| it.joints[joint].parent).collect();
        assert_eq!((parents[0], parents[120]), (Some(0), Some(1)));
        assert_eq!(it.joints[sheet.joints[7]].source, 3 + 7);
    }
}

#[test]
fn meshes_are_named_by_node_mesh_or_material() {
    let mut it = rig(4);
    for name in ["Flag", "flag_mesh", "silk"] {
        let part = MeshPart::named(&it, name).expect("it is there");
        assert_eq!((part.mesh, part.primitives), (0, vec![0]));
    }
    assert_eq!(MeshPart::names(&it), ["Flag", "flag_mesh", "silk"]);
    assert_eq!(MeshPart::named(&it, "flag"), Err(SheetError::Unknown));
    it.meshes.push(RigMesh { name: "other".into(), joint: 0, ..it.meshes[0].clone() });
    assert_eq!(MeshPart::named(&it, "silk"), Err(SheetError::Several(vec!["Flag".into(), "upper".into()])));
    assert!(MeshPart::named(&it, "other").is_ok());
}

/// A cape that hangs on a bone as a whole; what cannot be cloth leaves the rig as it was.
#[test]
fn a_mesh_without_a_skin_gets_one_and_errors_change_nothing() {
    let mut it = rig(10);
    it.meshes[0].skin = None;
    it.joints[2].parent = Some(0);
    it.joints[2].rest = LocalTransform { translation: Vec3::NEG_Y, ..LocalTransform::default() };
    it.meshes[0].primitives[0].joints.clear();
    it.meshes[0].primitives[0].weights.clear();
    let (untouched, before) = (it.clone(), drawn(&it, &rest_pose(&it)));
    assert_eq!(lay(&mut it, 400, Some(2.0)), Err(SheetError::AllHeld));
    assert_eq!(it, untouched);
    let sheet = lay(&mut it, 400, None).expect("it can be cloth");
    assert!(it.sheets[sheet].joints.iter().all(|&joint| it.joints[joint].parent == Some(2)));
    assert!(farthest(&before, &drawn(&it, &rest_pose(&it))) < 1e-5);
    assert_eq!(lay(&mut it, 400, None), Err(SheetError::Twice));
    let mut flat = rig(3);
    flat.meshes[0].primitives[0].positions.iter_mut().for_each(|place| *place = Vec3::ZERO);
    assert_eq!(lay(&mut flat, 400, None), Err(SheetError::Empty));
}

/// A strand of springs, or of a garment of chains, on the bones that bear a sheet is what it is without.
#[test]
fn joints_of_a_sheet_are_no_bones_of_a_strand() {
    let mut it = rig(10);
    it.joints[0].name = "cape_1".into();
    it.joints[1].name = "cape_2".into();
    let (springs, column) = (guess_springs(&it, Vec3::Y), GarmentColumn::below(&it, 0));
    assert_eq!((springs.bone_count(), column.joints.as_slice()), (1, &[0, 1][..]));
    let sheet = lay(&mut it, 400, None).expect("it can be cloth");
    let borne = it.sheets[sheet].joints.iter().filter(|&&joint| it.joints[joint].parent == Some(1));
    assert!(borne.count() > 0, "the last bone bears some of it");
    assert_eq!(guess_springs(&it, Vec3::Y), springs);
    // What is cloth now is no skin of its last bone.
    assert_eq!(GarmentColumn::below(&it, 0).joints, column.joints);
}
