//! Writing a clip into the user's own file.
use super::Document;
use crate::error::Result;
use sinew_anim::Clip;

/// Stub.
#[allow(clippy::missing_errors_doc)]
pub fn append_clip(_d: &Document, _c: &Clip, _name: &str, _e: Option<serde_json::Value>) -> Result<Vec<u8>> {
    Err(crate::Error::io("not yet"))
}
