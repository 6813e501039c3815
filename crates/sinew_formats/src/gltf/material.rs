//! Materials: base colour and its texture (glTF 2.0 §3.8, §3.9).

use super::Textures;
#[cfg(feature = "pictures")]
use super::picture::decode_picture;
use super::source::Source;
use crate::container::json::At;
use crate::container::uri::{self, Uri};
use crate::error::Result;
use sinew_anim::TextureImage;
use sinew_math::clamp;
use std::collections::BTreeMap;

/// Memory limit of all decoded pictures of a file, bytes.
pub(crate) const MAX_DECODED: usize = 256 << 20;

/// The materials of a file, and the textures decoded so far.
pub(super) struct Materials<'s, 'a> {
    source: &'s Source<'a>,
    materials: Vec<At<'a>>,
    textures_of_file: Vec<At<'a>>,
    images: Vec<At<'a>>,
    external_images: &'s BTreeMap<usize, Vec<u8>>,
    wanted: Textures,
    /// Index into `textures` per requested image; `None` if it could not be decoded.
    decoded: BTreeMap<usize, Option<usize>>,
    pub(super) textures: Vec<TextureImage>,
    pub(super) warnings: Vec<String>,
}

/// Look of a primitive.
pub(super) struct Look {
    pub(super) base_color: [f32; 4],
    pub(super) texture: Option<usize>,
    /// Index of the set of texture coordinates that the texture uses.
    pub(super) uv_set: usize,
    /// Name of the material, or `""`.
    pub(super) name: String,
}

impl<'s, 'a> Materials<'s, 'a> {
    pub(super) fn new(
        source: &'s Source<'a>,
        external_images: &'s BTreeMap<usize, Vec<u8>>,
        wanted: Textures,
    ) -> Result<Self> {
        Ok(Self {
            source,
            materials: source.root.list("materials")?,
            textures_of_file: source.root.list("textures")?,
            images: source.root.list("images")?,
            external_images,
            wanted,
            decoded: BTreeMap::new(),
            textures: Vec::new(),
            warnings: Vec::new(),
        })
    }

    /// Returns the look of a primitive; white without a material.
    pub(super) fn look(&mut self, primitive: At<'a>) -> Result<Look> {
        let mut look = Look { base_color: [1.0; 4], texture: None, uv_set: 0, name: String::new() };
        let Some(material_at) = primitive.get("material")? else { return Ok(look) };
        let material = self.materials[material_at.index(self.materials.len(), "materials")?];
        look.name = material.name();
        let Some(pbr) = material.get("pbrMetallicRoughness")? else { return Ok(look) };
        look.base_color = pbr.numbers_or("baseColorFactor", [1.0; 4])?.map(|x| clamp(x, 0.0, 1.0));
        let Some(texture) = pbr.get("baseColorTexture")? else { return Ok(look) };
        look.uv_set = texture.get("texCoord")?.map_or(Ok(0), At::usize)?;
        look.texture = self.texture(texture.need("index")?)?;
        Ok(look)
    }

    fn texture(&mut self, index: At<'a>) -> Result<Option<usize>> {
        let texture = self.textures_of_file[index.index(self.textures_of_file.len(), "textures")?];
        let Some(source) = texture.get("source")? else { return Ok(None) };
        let image = source.index(self.images.len(), "images")?;
        if self.wanted == Textures::Skip {
            return Ok(None);
        }
        if let Some(&known) = self.decoded.get(&image) {
            return Ok(known);
        }
        let decoded = match self.decode(image) {
            Ok(texture) => {
                self.textures.push(texture);
                Some(self.textures.len() - 1)
            }
            Err(what) => {
                self.warnings.push(format!("picture left out: {what} ({})", self.images[image].path()));
                None
            }
        };
        self.decoded.insert(image, decoded);
        Ok(decoded)
    }

    fn decode(&self, image: usize) -> Result<TextureImage, String> {
        let at = self.images[image];
        let uri = at.get("uri").map_err(|e| e.what)?;
        let from_uri;
        let bytes = if let Some(bytes) = self.external_images.get(&image) {
            bytes.as_slice()
        } else if let Some(uri) = uri {
            match uri::parse(uri.str().map_err(|e| e.what)?)? {
                Uri::Data(bytes) => from_uri = bytes,
                Uri::Relative(_) => return Err("its file is missing".into()),
            }
            &from_uri
        } else {
            let view = at.need("bufferView").map_err(|e| e.what)?;
            self.source.view(view).map_err(|e| e.what)?.0
        };
        let used: usize = self.textures.iter().map(|t| t.rgba.len()).sum();
        decode_picture(bytes, MAX_DECODED - used.min(MAX_DECODED))
    }
}

/// Returns an error, because this build has no picture decoders.
#[cfg(not(feature = "pictures"))]
pub(crate) fn decode_picture(_: &[u8], _: usize) -> Result<TextureImage, String> {
    Err("the feature `pictures` of sinew_formats is off".into())
}
