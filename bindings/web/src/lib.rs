//! Sinew for JavaScript: the WebAssembly module of the npm package `sinew-physics`. docs/guide/src/three.md is the guide.
// `forbid` would reject the macros of wasm-bindgen, whose code is `unsafe`; our own sources have no unsafe code.
#![deny(unsafe_code)]

mod border;
mod character;
mod character_def;
mod definitions;
mod drive;
mod events;
mod grab;
mod inner;
mod particles;
mod query;
mod types;
mod values;
mod view;
mod warm;
mod world;

use wasm_bindgen::prelude::*;

/// Initialises the module; called once, when it is instantiated.
#[wasm_bindgen(start)]
fn start() {
    border::keep_panics();
}

/// Returns the version of the library.
#[wasm_bindgen]
#[must_use]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}
