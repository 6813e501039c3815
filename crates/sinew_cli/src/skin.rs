//! Characters as models: their meshes, posed.

use sinew::anim::{Primitive, Rig, skin_vertices};
use sinew::math::{Affine, Vec2, Vec3};
use sinew_picture::{Material, Model, Texture};
use std::sync::Arc;

/// All primitives of a rig under a pose, one transform per joint; `looks` are those of [`looks`].
pub fn models<'a>(
    rig: &'a Rig,
    model: &'a [Affine],
    looks: &'a [Material],
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

fn surface(part: &Primitive, positions: Vec<Vec3>, normals: Vec<Vec3>, material: Material) -> Model {
    Model {
        positions,
        normals,
        uvs: part.uvs.iter().map(|uv| Vec2::new(uv.x, uv.y)).collect(),
        colors: part.colors.iter().map(|&[r, g, b, _]| [r, g, b]).collect(),
        indices: part.indices.clone(),
        material,
    }
}

/// One material per primitive, in the order of the meshes.
pub fn looks(rig: &Rig) -> Vec<Material> {
    // A picture that is none leaves its surface in its plain colour.
    let picture = |texture: &sinew::anim::Texture| {
        Texture::new(texture.width, texture.height, texture.rgba.clone()).ok().map(Arc::new)
    };
    let textures: Vec<Option<Arc<Texture>>> = rig.textures.iter().map(picture).collect();
    let look = |part: &Primitive| {
        let [r, g, b, _] = part.base_color;
        let texture = part.texture.and_then(|index| textures.get(index).cloned().flatten());
        Material { texture, ..Material::new([r, g, b]) }
    };
    rig.meshes.iter().flat_map(|mesh| mesh.primitives.iter().map(look)).collect()
}
