//! Tests of the library by its C functions, and of its header.

mod header;
mod misuse;
mod same_bits;
