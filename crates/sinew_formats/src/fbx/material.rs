//! Materials: base colour and its picture, inside the file or next to it.

use crate::gltf::{MAX_DECODED, Resolver, Textures, decode_picture};
use sinew_anim::TextureImage;
use sinew_math::clamp;
use std::collections::BTreeMap;
use ufbx::{Material, MeshPart, Node};

/// The pictures of a file, decoded on demand.
pub(super) struct Materials<'a, 'r> {
    resolve: &'a mut Resolver<'r>,
    wanted: Textures,
    /// Index into `textures` per texture of the file; `None` if the picture does not exist.
    known: BTreeMap<u32, Option<usize>>,
    pub textures: Vec<TextureImage>,
    pub notes: Vec<String>,
}

impl<'a, 'r> Materials<'a, 'r> {
    pub fn new(wanted: Textures, resolve: &'a mut Resolver<'r>) -> Self {
        Self { resolve, wanted, known: BTreeMap::new(), textures: Vec::new(), notes: Vec::new() }
    }

    /// Returns the linear RGBA of a part, white without a material, and the index of its picture.
    pub fn look(&mut self, node: &Node, mesh: &ufbx::Mesh, part: &MeshPart) -> ([f32; 4], Option<usize>) {
        let Some(map) = of_part(node, mesh, part).map(|material| &material.pbr.base_color) else {
            return ([1.0; 4], None);
        };
        // A picture replaces the colour; the colour does not tint it.
        if let Some(picture) = map.texture.as_ref().and_then(|texture| self.picture(texture)) {
            return ([1.0; 4], Some(picture));
        }
        if !map.has_value {
            return ([1.0; 4], None);
        }
        let c = &map.value_vec4;
        let part = |x: f64| if x.is_finite() { clamp(x as f32, 0.0, 1.0) } else { 1.0 };
        ([part(c.x), part(c.y), part(c.z), 1.0], None)
    }

    fn picture(&mut self, texture: &ufbx::Texture) -> Option<usize> {
        // Of several layers, uses the first that is a picture.
        let texture = texture.file_textures.first().map_or(texture, |file| &**file);
        let id = texture.element.typed_id;
        if self.wanted == Textures::Skip {
            return None;
        }
        if let Some(&known) = self.known.get(&id) {
            return known;
        }
        let picture = match self.decode(texture) {
            Ok(picture) => {
                self.textures.push(picture);
                Some(self.textures.len() - 1)
            }
            Err(what) => {
                self.notes.push(format!("picture left out: {what} (texture {:?})", &*texture.element.name));
                None
            }
        };
        self.known.insert(id, picture);
        picture
    }

    fn decode(&mut self, texture: &ufbx::Texture) -> Result<TextureImage, String> {
        let used: usize = self.textures.iter().map(|texture| texture.rgba.len()).sum();
        let budget = MAX_DECODED - usize::min(used, MAX_DECODED);
        let inside = [Some(&texture.content), texture.video.as_ref().map(|video| &video.content)];
        if let Some(bytes) = inside.into_iter().flatten().find(|content| content.size > 0) {
            return decode_picture(bytes, budget);
        }
        let mut missing = "it names no file".to_owned();
        for path in beside(&texture.relative_filename, &texture.filename) {
            match (self.resolve)(&path) {
                Ok(bytes) => return decode_picture(&bytes, budget),
                Err(error) => missing = format!("{:?}: {}", path, error.what),
            }
        }
        Err(missing)
    }
}

/// Returns the paths at which a picture is searched: relative to the file as when it was written, and in the file's
/// own folder. Absolute paths of other machines and paths outside the folder are skipped.
fn beside(relative: &str, any: &str) -> Vec<String> {
    let relative = relative.replace('\\', "/");
    let is_beside =
        !relative.starts_with('/') && !relative.contains(':') && relative.split('/').all(|part| part != "..");
    let name = |path: &str| path.replace('\\', "/").rsplit('/').next().unwrap_or_default().to_owned();
    let mut paths = vec![name(&relative), name(any)];
    if is_beside {
        paths.insert(0, relative);
    }
    paths.retain(|path| !path.is_empty());
    paths.dedup();
    paths
}

/// Returns the material of a part.
fn of_part<'a>(node: &'a Node, mesh: &'a ufbx::Mesh, part: &MeshPart) -> Option<&'a Material> {
    let at = part.index as usize;
    node.materials.get(at).or_else(|| mesh.materials.get(at)).map(|material| &**material)
}

/// Returns the name of a part's material, or `""`.
pub fn name(node: &Node, mesh: &ufbx::Mesh, part: &MeshPart) -> String {
    of_part(node, mesh, part).map_or(String::new(), |material| material.element.name.to_string())
}
