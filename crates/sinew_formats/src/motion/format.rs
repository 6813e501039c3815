//! Detects the format of a file from its bytes.

use crate::error::{Error, Result};
use crate::{container::glb, container::json};

/// Format of a file with clips.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionFormat {
    /// glTF in its binary container; also VRM and VRMA.
    Glb,
    /// glTF as JSON text.
    Gltf,
    /// Biovision Hierarchy.
    Bvh,
    /// A clip of DeepMimic.
    DeepMimic,
    /// A character of DeepMimic: joints without clips.
    DeepMimicCharacter,
    /// FBX, text or binary.
    Fbx,
    /// A ragdoll or an animation of Jolt Physics as text.
    Jolt,
}

/// Describes a kind of file that users often pass instead of a file with clips; `None` for other bytes.
pub(crate) fn foreign(bytes: &[u8]) -> Option<&'static str> {
    // Length of the start of the file in which XML elements are searched, after the header and comments.
    const NEAR: usize = 4096;
    let near = &bytes[..bytes.len().min(NEAR)];
    let has = |element: &[u8]| near.windows(element.len()).any(|window| window == element);
    match bytes {
        [0x1f, 0x8b, ..] => Some("a file compressed by gzip: unpack it first"),
        [b'P', b'K', 3, 4, ..] => Some("a ZIP archive: unpack it first"),
        _ if has(b"<robot") => Some("a URDF robot, which is not read; as MJCF it is"),
        _ if has(b"<mujoco") => Some(
            "an MJCF model, which has no skin and no clips; 'ragdoll doctor' and 'ragdoll export' read it",
        ),
        _ => None,
    }
}

impl MotionFormat {
    /// Detects the format of bytes.
    ///
    /// # Errors
    /// If the bytes match no known format.
    pub fn of(bytes: &[u8]) -> Result<Self> {
        if glb::is_glb(bytes) {
            return Ok(Self::Glb);
        }
        let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes).trim_ascii_start();
        let begins = |word: &[u8]| text.get(..word.len()).is_some_and(|b| b.eq_ignore_ascii_case(word));
        match text.first() {
            None => Err(Error::malformed("file is empty", "byte 0")),
            Some(b'{') => Self::of_json(bytes),
            _ if crate::jolt::is_jolt(text) => Ok(Self::Jolt),
            _ if begins(b"HIERARCHY") => Ok(Self::Bvh),
            _ if begins(b"Kaydara FBX Binary") || begins(b"; FBX ") || begins(b"FBXHeaderExtension") => {
                Ok(Self::Fbx)
            }
            _ => Err(match foreign(bytes) {
                Some(what) => Error::unsupported(what, "byte 0"),
                None => Error::malformed(
                    "not a glTF file, nor BVH, FBX, DeepMimic or Jolt: unknown first bytes",
                    "byte 0",
                ),
            }),
        }
    }

    /// Detects one of the two DeepMimic formats in JSON, which have no key in common, or glTF.
    fn of_json(bytes: &[u8]) -> Result<Self> {
        let root = json::parse(bytes)?;
        Ok(if root.get("Frames").is_some() {
            Self::DeepMimic
        } else if root.get("Skeleton").is_some() {
            Self::DeepMimicCharacter
        } else {
            Self::Gltf
        })
    }

    /// Name as a word: `glb`, `gltf`, `bvh`, `deepmimic`, `fbx`, `tof`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Glb => "glb",
            Self::Gltf => "gltf",
            Self::Bvh => "bvh",
            Self::DeepMimic | Self::DeepMimicCharacter => "deepmimic",
            Self::Fbx => "fbx",
            Self::Jolt => "tof",
        }
    }
}
