//! Integration tests through the public interface.

mod drawing;
mod files;
mod golden;
mod stairs;
mod symptoms;
