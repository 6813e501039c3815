//! The mannequin in a mesh skirt: skinned to hips and thighs as artists do, with a seam at the back and a buckle in
//! front.

use crate::dressed::SKIRT;
use sinew::anim::garments::{MOST_PARTICLES, MeshPart, SheetError, SheetOptions, lay_sheet};
use sinew::anim::{Garment, Joint, JointIdx, LocalTransform, Primitive, Rig, RigMesh, analyze};
use sinew::math::{Affine, Vec3, clamp};
use sinew::ragdoll::{BuildOptions, CharacterDef, build};

/// Name of the skirt's mesh and of its node.
pub const NAME: &str = "Skirt";
/// Name of the skirt's material.
pub const MATERIAL: &str = "Tartan";
/// Number of cells of the skirt around and down in the artist's mesh.
pub const CELLS: [usize; 2] = [72, 20];
/// Height of the buckle, below the waistband, and half of its side, metres.
const BUCKLE: [f32; 2] = [0.93, 0.012];

/// Rig of the mannequin with a skirt mesh of that many cells around and down.
///
/// # Panics
/// Never panics, because the mannequin has the joints.
pub fn skirted_rig(cells: [usize; 2]) -> Rig {
    let mut rig = crate::mannequin::mannequin().rig;
    let joint_of =
        |name: &str| rig.joints.iter().position(|joint| joint.name == name).expect("the rig has this joint");
    let slot_of = |name: &str| {
        let joint = joint_of(name);
        rig.skins[0].joints.iter().position(|&at| at == joint).expect("its skin has that joint") as u16
    };
    let [hips, left, right] = ["hips", "leftUpperLeg", "rightUpperLeg"].map(slot_of);
    let mut primitive =
        Primitive { base_color: SKIRT.color, material: MATERIAL.to_owned(), ..Primitive::default() };
    let mut add = |place: Vec3| {
        // Toward the hem, the leg on the vertex's side gets more weight.
        let down = clamp((1.0 - place.y) / 0.45, 0.0, 1.0);
        let (leg, side) = (0.7 * down, clamp(0.5 + 3.0 * place.x, 0.0, 1.0));
        primitive.joints.push([hips, left, right, 0]);
        primitive.weights.push([1.0 - leg, leg * side, leg * (1.0 - side), 0.0]);
        let out = Vec3::new(place.x / (0.165 * 0.165), 0.3, place.z / (0.125 * 0.125));
        primitive.normals.push(out.normalize());
        primitive.positions.push(place);
        primitive.positions.len() as u32 - 1
    };
    let [around, down] = cells;
    let mut rows: Vec<Vec<u32>> = Vec::new();
    for column in 0..=around {
        // The seam has duplicate vertices for its texture coordinates.
        let across = (column % around) as f32 / around as f32;
        rows.push((0..=down).map(|row| add((SKIRT.place)(across, row as f32 / down as f32))).collect());
    }
    let front = (SKIRT.place)(0.0, (1.0 - BUCKLE[0]) / 0.45) + Vec3::Z * 0.004;
    let half = BUCKLE[1];
    let buckle = [[-half, half], [-half, -half], [half, -half], [half, half]]
        .map(|[x, y]| add(front + Vec3::new(x, y, 0.0)));
    for column in 0..around {
        for row in 0..down {
            let [a, b] = [rows[column][row], rows[column + 1][row]];
            let [c, d] = [rows[column + 1][row + 1], rows[column][row + 1]];
            // Add triangles for both sides.
            primitive.indices.extend([a, d, c, a, c, b, a, c, d, a, b, c]);
        }
    }
    let [a, b, c, d] = buckle;
    primitive.indices.extend([a, b, c, a, c, d]);
    let source = rig.joints.len();
    let rest = LocalTransform::default();
    rig.joints.push(Joint { name: NAME.to_owned(), parent: None, rest, source });
    rig.meshes.push(RigMesh {
        name: NAME.to_owned(),
        joint: source,
        skin: Some(0),
        primitives: vec![primitive],
    });
    rig
}

/// Converts the skirt of such a rig to a sheet and returns its index. Particles are at most `spacing` (m) apart if
/// their number allows.
///
/// # Errors
/// Returns the errors of [`lay_sheet`].
///
/// # Panics
/// If the rig has no such skirt.
pub fn lay_skirt(rig: &mut Rig, most_particles: usize, spacing: f32) -> Result<usize, SheetError> {
    let bind_model = analyze(rig).expect("the mannequin has a skin").bind_model;
    let part = MeshPart::named(rig, NAME).expect("the rig has a skirt");
    let first_source = rig.joints.len();
    let options = SheetOptions {
        bind_model: &bind_model,
        metres_from_model: Affine::IDENTITY,
        spacing,
        held: None,
        most_particles,
        first_source,
    };
    lay_sheet(rig, &part, &options)
}

/// The mannequin in that skirt as a character: the motions of [`mannequin::character`](crate::mannequin::character),
/// and the garment changed by `adjust`.
///
/// # Panics
/// Never panics, because the character is valid.
pub fn skirted(adjust: impl Fn(&mut Garment)) -> CharacterDef {
    let bare = crate::mannequin::mannequin().rig;
    let (ragdoll, _) =
        build(&bare, &analyze(&bare).expect("the mannequin has a skin"), &BuildOptions::default())
            .expect("the rig can be built");
    let mut rig = skirted_rig(CELLS);
    let sheet =
        lay_skirt(&mut rig, MOST_PARTICLES, Garment::default().spacing).expect("the skirt can be cloth");
    let mut garment = Garment { name: "skirt".to_owned(), ..Garment::of_sheet(&rig.sheets[sheet]) };
    adjust(&mut garment);
    let analysis = analyze(&rig).expect("the mannequin has a skin");
    let mut def = CharacterDef::new(rig, ragdoll, &analysis.bind_model);
    def.set_motions(crate::mannequin::character().motions().clone())
        .expect("the mannequin's clips are valid");
    def.set_garments(&[garment]);
    def
}

/// Joint of the rig of that name.
///
/// # Panics
/// If the rig has no such joint.
pub fn joint(rig: &Rig, name: &str) -> JointIdx {
    rig.joints.iter().position(|joint| joint.name == name).expect("the rig has this joint")
}
