//! Convex hulls in worlds and in bytes.

mod bytes;
mod stacks;

use crate::solids::{box_hull, pebble};
