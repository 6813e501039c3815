//! Serialises infinite numbers as `None`, for formats without infinity. For `serde(with)` of fields.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Writes a number, or `None` if it is infinite.
///
/// # Errors
/// Errors of the serializer.
pub fn serialize<S: Serializer>(x: &f32, serializer: S) -> Result<S::Ok, S::Error> {
    x.is_finite().then_some(*x).serialize(serializer)
}

/// Reads a number; `None` becomes infinity.
///
/// # Errors
/// Errors of the deserializer.
pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f32, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or(f32::INFINITY))
}
