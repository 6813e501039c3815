//! Sinew for JavaScript: the WebAssembly module of the npm package `sinew-physics`. docs/guide/src/three.md is the guide.
// `forbid` would refuse the macros of wasm-bindgen, whose code is `unsafe`; no source of ours is.
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

/// Called once, when the module is instantiated.
#[wasm_bindgen(start)]
fn start() {
    border::keep_panics();
}

/// Version of the library.
#[wasm_bindgen]
#[must_use]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}
