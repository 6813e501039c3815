//! Tests of the C functions, and of the header.

mod header;
mod misuse;
mod same_bits;
