//! Piles of free bodies: support depth, initial loads of contacts, and mass scaling of squeezed bodies.

pub(in crate::solver) mod loads;
pub(in crate::solver) mod mass_scaling;
pub(in crate::solver) mod support_depth;
pub(in crate::solver) mod touch;
