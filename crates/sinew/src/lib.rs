//! Sinew.
#![forbid(unsafe_code)]

pub use sinew_anim as anim;
pub use sinew_formats as formats;
pub use sinew_math as math;
pub use sinew_physics as physics;
pub use sinew_ragdoll as ragdoll;
