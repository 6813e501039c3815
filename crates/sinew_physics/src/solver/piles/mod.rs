//! Piles of free bodies: how high each body stands, the loads that contacts begin with, and mass scaling of what is squeezed.

pub(in crate::solver) mod loads;
pub(in crate::solver) mod mass_scaling;
pub(in crate::solver) mod support_depth;
pub(in crate::solver) mod touch;
