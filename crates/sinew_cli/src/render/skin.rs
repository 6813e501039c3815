//! Characters as posed models.

use sinew::anim::{Primitive, Rig, skin_vertices};
use sinew::math::{Affine, Vec2, Vec3};
use sinew_picture::{Model, RenderMaterial, Texture};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Returns all primitives of a rig under a pose, one transform per joint; `looks` are those of [`looks`].
pub fn models<'a>(
    rig: &'a Rig,
    model: &'a [Affine],
    looks: &'a [RenderMaterial],
) -> impl Iterator<Item = Model> + 'a {
    let parts = rig.meshes.iter().enumerate().flat_map(|(mesh, of)| {
        of.primitives.iter().enumerate().map(move |(part, primitive)| (mesh, part, primitive))
    });
    parts.zip(looks).map(|((mesh, part, primitive), look)| {
        let (mut positions, mut normals) = (Vec::new(), Vec::new());
        skin_vertices(rig, mesh, part, model, &mut positions, &mut normals);
        surface(primitive, positions, normals, look.clone())
    })
}

/// Updates the result of [`models`] for the same rig and looks: only positions and normals change.
pub fn pose(rig: &Rig, model: &[Affine], models: &mut [Model]) {
    let parts = rig
        .meshes
        .iter()
        .enumerate()
        .flat_map(|(mesh, of)| (0..of.primitives.len()).map(move |part| (mesh, part)));
    for ((mesh, part), surface) in parts.zip(models) {
        skin_vertices(rig, mesh, part, model, &mut surface.positions, &mut surface.normals);
    }
}

/// Returns the directions in which a skin part can be outermost: along the axes, edges and corners of a cube.
fn directions() -> impl Iterator<Item = Vec3> {
    let steps = [-1.0, 0.0, 1.0];
    let all = steps
        .into_iter()
        .flat_map(move |x| steps.into_iter().flat_map(move |y| steps.map(|z| Vec3::new(x, y, z))));
    all.filter(|way| *way != Vec3::ZERO)
}

/// Returns the rig with only the outermost skin vertices of each joint, without normals: enough to compute its
/// extent in any pose at a small cost.
pub fn outline(rig: &Rig) -> Rig {
    let mut rig = Rig { textures: Vec::new(), ..rig.clone() };
    for primitive in rig.meshes.iter_mut().flat_map(|mesh| &mut mesh.primitives) {
        let slot = |vertex: usize| {
            let pulls = primitive.joints.get(vertex).into_iter().flatten().zip(&primitive.weights[vertex]);
            pulls
                .fold((0, 0.0), |most, (&slot, &weight)| if weight > most.1 { (slot, weight) } else { most })
                .0
        };
        let slots: Vec<u16> = if primitive.joints.is_empty() {
            vec![0; primitive.positions.len()]
        } else {
            (0..primitive.positions.len()).map(slot).collect()
        };
        let mut farthest: BTreeMap<(u16, usize), (f32, usize)> = BTreeMap::new();
        for (vertex, position) in primitive.positions.iter().enumerate().filter(|(_, at)| at.is_finite()) {
            for (way, direction) in directions().enumerate() {
                let reach = position.dot(direction);
                let best = farthest.entry((slots[vertex], way)).or_insert((reach, vertex));
                if reach > best.0 {
                    *best = (reach, vertex);
                }
            }
        }
        let kept: BTreeSet<usize> = farthest.into_values().map(|(_, vertex)| vertex).collect();
        let of = |list: &[Vec3]| kept.iter().map(|&vertex| list[vertex]).collect();
        *primitive = Primitive {
            positions: of(&primitive.positions),
            joints: kept.iter().filter_map(|&vertex| primitive.joints.get(vertex).copied()).collect(),
            weights: kept.iter().filter_map(|&vertex| primitive.weights.get(vertex).copied()).collect(),
            ..Primitive::default()
        };
    }
    rig
}

fn surface(part: &Primitive, positions: Vec<Vec3>, normals: Vec<Vec3>, material: RenderMaterial) -> Model {
    Model {
        positions,
        normals,
        uvs: part.uvs.iter().map(|uv| Vec2::new(uv.x, uv.y)).collect(),
        colors: part.colors.iter().map(|&[r, g, b, _]| [r, g, b]).collect(),
        indices: part.indices.clone(),
        material,
    }
}

/// Returns one material per primitive, in the order of the meshes.
pub fn looks(rig: &Rig) -> Vec<RenderMaterial> {
    // A texture that cannot be decoded leaves its surface in its plain colour.
    let picture = |texture: &sinew::anim::TextureImage| {
        Texture::new(texture.width, texture.height, texture.rgba.clone()).ok().map(Arc::new)
    };
    let textures: Vec<Option<Arc<Texture>>> = rig.textures.iter().map(picture).collect();
    let look = |part: &Primitive| {
        let [r, g, b, _] = part.base_color;
        let texture = part.texture.and_then(|index| textures.get(index).cloned().flatten());
        RenderMaterial { texture, ..RenderMaterial::new([r, g, b]) }
    };
    rig.meshes.iter().flat_map(|mesh| mesh.primitives.iter().map(look)).collect()
}
