//! Convex hulls in worlds and as bytes.

mod bytes;
mod stacks;

use crate::solids::{box_hull, pebble};
