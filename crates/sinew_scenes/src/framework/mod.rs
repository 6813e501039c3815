//! Framework of the scenes: the interface of a scene, its settings and metrics, and measurements that scenes share.

pub(crate) mod actors;
pub(crate) mod acts;
pub(crate) mod camera_hint;
pub(crate) mod curve;
pub(crate) mod flight;
pub(crate) mod instance;
pub(crate) mod metric;
pub(crate) mod performance;
pub(crate) mod ragdolls;
pub(crate) mod scene;
pub(crate) mod setting;
pub(crate) mod stand;
pub(crate) mod support;
pub(crate) mod turn;
