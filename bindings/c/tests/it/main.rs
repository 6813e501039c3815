//! The library as C sees it: by its functions, and its header.

mod header;
mod misuse;
mod same_bits;
