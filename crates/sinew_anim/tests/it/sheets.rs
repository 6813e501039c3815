//! Tests of meshes as cloth sheets: welded, reduced, held at the top, and attached to joints.

use sinew_anim::garments::{MOST_PARTICLES, MeshPart, SheetError, SheetOptions, lay_sheet};
use sinew_anim::{
    GarmentColumn, Joint, LocalTransform, Primitive, Rig, RigMesh, Skin, guess_springs, local_to_model,
    rest_pose, skin_vertices,
};
use sinew_math::{Affine, Rotation, Vec3};

const SPACING: f32 = 0.05;
/// Spacing at which the ten cells across remain.
const COARSE: f32 = 0.11;

/// Returns a cloth of 1 m × 1 m that hangs from y = 1 in the xy plane, with `cells` cells along each side, weighted to
/// an upper and a lower joint.
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
    lay_at(rig, most_particles, held, SPACING)
}

fn lay_at(
    rig: &mut Rig,
    most_particles: usize,
    held: Option<f32>,
    spacing: f32,
) -> Result<usize, SheetError> {
    let bind_model = bind(rig);
    let part = MeshPart::named(rig, "Flag")?;
    let first_source = rig.joints.len();
    let options = SheetOptions {
        bind_model: &bind_model,
        metres_from_model: Affine::IDENTITY,
        spacing,
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
fn fine_mesh_is_reduced_and_drawn_unchanged() {
    let mut it = rig(80);
    let before = drawn(&it, &rest_pose(&it));
    let sheet = lay(&mut it, 2000, None).expect("the mesh can be cloth");
    let sheet = &it.sheets[sheet];
    assert_eq!(sheet.vertices, 81 * 81);
    // Numbers of particles such that no point of a square metre is farther than 25 mm from one: 616 in a hexagonal
    // grid, 800 in a square grid.
    assert!((616..1400).contains(&sheet.joints.len()), "{}", sheet.joints.len());
    let place = bind(&it);
    let at = |particle: u32| place[sheet.joints[particle as usize]].translation;
    let longest = sheet.links.iter().map(|&[a, b]| (at(a) - at(b)).length()).fold(0.0, f32::max);
    assert!(longest <= SPACING + 2.0 / 80.0, "{longest}");
    let area: f32 =
        sheet.faces.iter().map(|f| (at(f[1]) - at(f[0])).cross(at(f[2]) - at(f[0])).length() / 2.0).sum();
    assert!((0.97..1.01).contains(&area), "the borders moved; area {area} m²");
    assert!(farthest(&before, &drawn(&it, &rest_pose(&it))) < 1e-5);
    // The particles' joints have no motion of their own, and the mesh follows the original joints.
    let mut pose = rest_pose(&it);
    pose[0].translation += Vec3::X * 3.0;
    let moved: Vec<Vec3> = before.iter().map(|&place| place + Vec3::X * 3.0).collect();
    assert!(farthest(&moved, &drawn(&it, &pose)) < 1e-5);
    // A particle moves its own vertex, but no vertex a metre away.
    let mut pose = rest_pose(&it);
    pose[sheet.joints[0]].translation += Vec3::Z;
    let bulge: Vec<f32> = drawn(&it, &pose).iter().map(|place| place.z.abs()).collect();
    assert!(bulge.iter().copied().fold(0.0, f32::max) > 0.99);
    assert!(bulge.iter().filter(|z| **z > 1e-4).count() < 81 * 81 / 50);
}

#[test]
fn particle_count_stays_below_its_limit() {
    for most in [4, 30, MOST_PARTICLES] {
        let mut it = rig(60);
        let sheet = lay(&mut it, most, None).expect("the mesh can be cloth");
        let count = it.sheets[sheet].joints.len();
        assert!(count <= most && count > most / 2, "{count} of {most}");
    }
}

#[test]
fn coarse_mesh_gets_a_particle_per_vertex_and_the_given_held_depth() {
    for (held, rows) in [(None, 2), (Some(0.35), 4), (Some(0.0), 1)] {
        let mut it = rig(10);
        let sheet = lay_at(&mut it, 400, held, COARSE).expect("the mesh can be cloth");
        let sheet = &it.sheets[sheet];
        assert_eq!((sheet.joints.len(), sheet.faces.len(), sheet.links.len()), (121, 200, 320));
        assert_eq!(sheet.held.iter().filter(|held| **held).count(), 11 * rows, "{held:?}");
        // Each particle's parent is the joint with the largest weight at its vertex.
        let parents: Vec<_> = sheet.joints.iter().map(|&joint| it.joints[joint].parent).collect();
        assert_eq!((parents[0], parents[120]), (Some(0), Some(1)));
        assert_eq!(it.joints[sheet.joints[7]].source, 3 + 7);
    }
}

/// Cells wider than the spacing are halved until they fit; square cells stay square. Mesh vertices keep their own
/// particles, and the drawing is unchanged.
#[test]
fn mesh_coarser_than_its_spacing_is_split() {
    let mut it = rig(4);
    let before = drawn(&it, &rest_pose(&it));
    let sheet = lay_at(&mut it, 400, None, 0.07).expect("the mesh can be cloth");
    let sheet = it.sheets[sheet].clone();
    assert_eq!((sheet.vertices, sheet.joints.len(), sheet.faces.len()), (25, 17 * 17, 2 * 16 * 16));
    assert!((sheet.longest_edge - 0.25 * 2.0_f32.sqrt()).abs() < 1e-5, "{}", sheet.longest_edge);
    assert_eq!(sheet.held.iter().filter(|held| **held).count(), 2 * 17);
    let place = bind(&it);
    let at = |particle: u32| place[sheet.joints[particle as usize]].translation;
    let lengths: Vec<f32> = sheet.links.iter().map(|&[a, b]| (at(a) - at(b)).length()).collect();
    let [cell, across] = [1.0 / 16.0, 2.0_f32.sqrt() / 16.0];
    assert!(lengths.iter().all(|l| (l - cell).abs() < 1e-5 || (l - across).abs() < 1e-5), "square cells");
    for face in &sheet.faces {
        let normal = (at(face[1]) - at(face[0])).cross(at(face[2]) - at(face[0]));
        assert!(
            normal.z > 0.0 && (normal.length() - cell * cell).abs() < 1e-5,
            "the winding changed; normal {normal}"
        );
    }
    let sum: f32 = sheet.areas.iter().sum();
    assert!((sum - 1.0).abs() < 1e-4, "{sum} m²");
    assert!(farthest(&before, &drawn(&it, &rest_pose(&it))) < 1e-5);
    // A vertex moves only with its own particle; a particle between vertices moves no vertex.
    for (particle, moves) in [(12, 1), (25, 0), (100, 0)] {
        let mut pose = rest_pose(&it);
        pose[sheet.joints[particle]].translation += Vec3::Z;
        let moved = drawn(&it, &pose).iter().filter(|place| place.z.abs() > 1e-4).count();
        assert_eq!(moved, moves, "particle {particle}");
    }
    // Splitting stops at the particle limit, and parts without cloth are not split.
    let mut it = rig(4);
    let sheet = lay_at(&mut it, 60, None, 0.07).expect("the mesh can be cloth");
    assert_eq!(it.sheets[sheet].joints.len(), 60);
    let mut it = rig(4);
    let primitive = &mut it.meshes[0].primitives[0];
    for place in [Vec3::new(0.4, 0.1, 0.1), Vec3::new(0.8, 0.1, 0.1), Vec3::new(0.4, 0.5, 0.1)] {
        primitive.indices.push(primitive.positions.len() as u32);
        primitive.positions.push(place);
        primitive.normals.push(Vec3::Z);
        primitive.joints.push([1, 0, 0, 0]);
        primitive.weights.push([1.0, 0.0, 0.0, 0.0]);
    }
    let sheet = lay_at(&mut it, 400, None, 0.07).expect("the mesh can be cloth");
    assert_eq!((it.sheets[sheet].vertices, it.sheets[sheet].joints.len()), (28, 17 * 17));
}

#[test]
fn meshes_are_named_by_node_mesh_or_material() {
    let mut it = rig(4);
    for name in ["Flag", "flag_mesh", "silk"] {
        let part = MeshPart::named(&it, name).expect("the rig has this mesh");
        assert_eq!((part.mesh, part.primitives), (0, vec![0]));
    }
    assert_eq!(MeshPart::names(&it), ["Flag", "flag_mesh", "silk"]);
    assert_eq!(MeshPart::named(&it, "flag"), Err(SheetError::Unknown));
    it.meshes.push(RigMesh { name: "other".into(), joint: 0, ..it.meshes[0].clone() });
    assert_eq!(MeshPart::named(&it, "silk"), Err(SheetError::Several(vec!["Flag".into(), "upper".into()])));
    assert!(MeshPart::named(&it, "other").is_ok());
}

/// A cape is rigidly attached to a bone. Meshes that cannot be cloth leave the rig unchanged.
#[test]
fn rigid_mesh_gets_a_skin_and_errors_change_nothing() {
    let mut it = rig(10);
    it.meshes[0].skin = None;
    it.joints[2].parent = Some(0);
    it.joints[2].rest = LocalTransform { translation: Vec3::NEG_Y, ..LocalTransform::default() };
    it.meshes[0].primitives[0].joints.clear();
    it.meshes[0].primitives[0].weights.clear();
    let (untouched, before) = (it.clone(), drawn(&it, &rest_pose(&it)));
    assert_eq!(lay(&mut it, 400, Some(2.0)), Err(SheetError::AllHeld));
    assert_eq!(it, untouched);
    let sheet = lay(&mut it, 400, None).expect("the mesh can be cloth");
    assert!(it.sheets[sheet].joints.iter().all(|&joint| it.joints[joint].parent == Some(2)));
    assert!(farthest(&before, &drawn(&it, &rest_pose(&it))) < 1e-5);
    assert_eq!(lay(&mut it, 400, None), Err(SheetError::Twice));
    let mut flat = rig(3);
    flat.meshes[0].primitives[0].positions.iter_mut().for_each(|place| *place = Vec3::ZERO);
    assert_eq!(lay(&mut flat, 400, None), Err(SheetError::Empty));
}

/// Returns the cloth as separate strips of `across` cells.
fn strips(cells: usize, across: usize) -> Rig {
    let mut it = rig(cells);
    let primitive = &mut it.meshes[0].primitives[0];
    let column = |vertex: u32| vertex as usize % (cells + 1);
    let at = |face: &[u32]| face.iter().map(|&vertex| column(vertex)).min().unwrap_or(0);
    let faces = primitive.indices.chunks_exact(3).filter(|face| at(face).is_multiple_of(across));
    primitive.indices = faces.flatten().copied().collect();
    it
}

#[test]
fn each_piece_gets_a_particle_or_an_error() {
    let mut it = strips(10, 2);
    let untouched = it.clone();
    assert_eq!(lay(&mut it, 4, None), Err(SheetError::TooManyPieces(5)));
    assert_eq!(it, untouched);
    let sheet = lay(&mut it, 12, None).expect("there is room");
    assert!(it.sheets[sheet].held.iter().filter(|held| **held).count() >= 5);
}

#[test]
fn tiny_spacing_terminates() {
    let mut it = rig(20);
    let bind_model = bind(&it);
    let part = MeshPart::named(&it, "Flag").expect("the rig has this mesh");
    let first_source = it.joints.len();
    let options = SheetOptions {
        bind_model: &bind_model,
        metres_from_model: Affine::IDENTITY,
        spacing: 1e-45,
        held: None,
        most_particles: 100,
        first_source,
    };
    let sheet = lay_sheet(&mut it, &part, &options).expect("the mesh can be cloth");
    assert!((50..=100).contains(&it.sheets[sheet].joints.len()));
}

/// Each piece of a reduced sheet is held, also if only the highest vertices are held.
#[test]
fn every_piece_of_a_reduced_sheet_is_held() {
    for most in [4, 20, 100] {
        let mut it = rig(80);
        // One corner is slightly higher, so that one vertex is held, which is not the first on the border.
        it.meshes[0].primitives[0].positions[37].y += 1e-3;
        let sheet = lay(&mut it, most, Some(0.0)).expect("the mesh can be cloth");
        assert_eq!(it.sheets[sheet].held.iter().filter(|held| **held).count(), 1, "{most}");
    }
    let mut it = strips(40, 5);
    let sheet = lay(&mut it, 40, Some(0.0)).expect("the mesh can be cloth");
    assert!(it.sheets[sheet].held.iter().filter(|held| **held).count() >= 8);
}

/// A ribbon reduced to one row of particles keeps its mass.
#[test]
fn sheet_area_equals_the_mesh_area() {
    for (across, most, area) in [(1, 2000, 1.0), (1, 30, 1.0), (80, 40, 1.0 / 80.0)] {
        let mut it = strips(80, across);
        let sheet = lay(&mut it, most, None).expect("the mesh can be cloth");
        let sheet = &it.sheets[sheet];
        assert_eq!(sheet.areas.len(), sheet.joints.len());
        assert!(sheet.areas.iter().all(|area| *area > 0.0));
        let sum: f32 = sheet.areas.iter().sum();
        assert!((sum / area - 1.0).abs() < 1e-4, "{sum} of {area} m²");
        assert_eq!(sheet.faces.is_empty(), across == 80);
    }
}

/// A brooch above a cape is a separate piece.
#[test]
fn piece_above_the_cloth_does_not_take_its_held_vertices() {
    let mut it = rig(10);
    let primitive = &mut it.meshes[0].primitives[0];
    let first = primitive.positions.len() as u32;
    for place in [Vec3::new(0.4, 1.3, 0.0), Vec3::new(0.6, 1.3, 0.0), Vec3::new(0.5, 1.4, 0.0)] {
        primitive.positions.push(place);
        primitive.normals.push(Vec3::Z);
        primitive.joints.push([0; 4]);
        primitive.weights.push([1.0, 0.0, 0.0, 0.0]);
    }
    primitive.indices.extend([first, first + 1, first + 2]);
    let untouched = it.clone();
    assert_eq!(lay(&mut it, 400, None), Err(SheetError::MostlyLoose));
    assert_eq!(it, untouched);
    assert!(lay_at(&mut it, 400, Some(0.6), COARSE).is_ok());
    // Triangles without area do not count.
    let mut it = untouched;
    it.meshes[0].primitives[0].positions[first as usize + 2] = Vec3::new(0.5, 1.3, 0.0);
    let sheet = lay_at(&mut it, 400, None, COARSE).expect("the mesh can be cloth");
    assert_eq!(it.sheets[sheet].held.iter().filter(|held| **held).count(), 22 + 3);
}

/// A degenerate triangle, of which two corners coincide when bound, beside loose parts that are bound to the nearest
/// triangle.
#[test]
fn degenerate_triangles_give_finite_weights() {
    let mut it = rig(10);
    let primitive = &mut it.meshes[0].primitives[0];
    let first = primitive.positions.len() as u32;
    // A point so close to a cloth vertex that the difference vanishes after rotation, and a loose vertex in front of
    // the triangle's centre.
    for place in [
        Vec3::new(1.0, 0.5, 1e-30),
        Vec3::new(2.0, 0.5, 0.1),
        Vec3::new(1.6, 0.4, 0.1),
        Vec3::new(1.6, 0.5, 0.1),
    ] {
        primitive.positions.push(place);
        primitive.normals.push(Vec3::Z);
        primitive.joints.push([0; 4]);
        primitive.weights.push([1.0, 0.0, 0.0, 0.0]);
    }
    let edge = 5 * 11 + 10;
    primitive.indices.splice(0..0, [edge, first, edge - 1, first + 1, first + 2, first + 3]);
    lay(&mut it, 400, None).expect("the mesh can be cloth");
    let weights = &it.meshes[0].primitives[0].weights;
    assert!(weights.iter().flatten().all(|weight| weight.is_finite()), "{:?}", &weights[first as usize..]);
}

#[test]
fn rigid_part_of_a_skinned_mesh_is_rejected() {
    let mut it = rig(4);
    let mut rigid = it.meshes[0].clone();
    rigid.skin = None;
    rigid.primitives[0].joints.clear();
    rigid.primitives[0].weights.clear();
    it.meshes.push(rigid);
    let part = MeshPart { name: "Flag".into(), mesh: 1, primitives: vec![0] };
    let (bind_model, untouched) = (bind(&it), it.clone());
    let options = SheetOptions {
        bind_model: &bind_model,
        metres_from_model: Affine::IDENTITY,
        spacing: SPACING,
        held: None,
        most_particles: 400,
        first_source: it.joints.len(),
    };
    assert_eq!(lay_sheet(&mut it, &part, &options), Err(SheetError::NoSkin));
    assert_eq!(it, untouched);
}

/// A strand of springs or of a chain garment on the bones above a sheet equals the one without the sheet.
#[test]
fn sheet_joints_do_not_count_as_strand_bones() {
    let mut it = rig(10);
    it.joints[0].name = "cape_1".into();
    it.joints[1].name = "cape_2".into();
    let (springs, column) = (guess_springs(&it, Vec3::Y), GarmentColumn::below(&it, 0));
    assert_eq!((springs.bone_count(), column.joints.as_slice()), (1, &[0, 1][..]));
    let sheet = lay(&mut it, 400, None).expect("the mesh can be cloth");
    let borne = it.sheets[sheet].joints.iter().filter(|&&joint| it.joints[joint].parent == Some(1));
    assert!(borne.count() > 0, "some particles are children of the last bone");
    assert_eq!(guess_springs(&it, Vec3::Y), springs);
    // Vertices that are cloth do not count as skin of the column's last bone.
    assert_eq!(GarmentColumn::below(&it, 0).joints, column.joints);
}
