//! Pictures as a user makes them.

mod drawing;
mod files;
mod golden;
mod stairs;
