//! Convex hulls of point clouds against brute force in `f64`: a hundredth of the random cases unless `SINEW_FULL`
//! is set, as `cargo xtask ci --full` does.

mod clouds;
mod mass;
mod pairs;

use crate::cases::cases;
use crate::solids::{box_hull, corners, hull_of, pebble};
