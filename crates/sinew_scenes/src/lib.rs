//! Sinew.
#![forbid(unsafe_code)]
