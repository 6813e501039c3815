//! Characters as bodies: limp, driven, in heaps.

pub(super) mod drives;
pub(super) mod falls;
pub(super) mod house;
pub(super) mod limp;
pub(super) mod mjcf;
pub(super) mod throng;
