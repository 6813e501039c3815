//! Views of memory: arrays that JavaScript reads without copying.

use js_sys::{Float32Array, Object, WebAssembly};
use std::cell::RefCell;
use wasm_bindgen::JsCast;

/// An array view of numbers in memory. It is recreated only if the numbers or the memory have moved.
#[derive(Default)]
pub struct View(RefCell<Option<Float32Array>>);

impl View {
    /// Returns the array over `numbers`, valid until the next call that may allocate.
    pub fn of(&self, numbers: &[f32]) -> Float32Array {
        let memory: WebAssembly::Memory = wasm_bindgen::memory().unchecked_into();
        let buffer = memory.buffer();
        let (place, length) = (numbers.as_ptr() as usize as u32, numbers.len() as u32);
        let mut view = self.0.borrow_mut();
        if let Some(view) = &*view
            && view.byte_offset() == place
            && view.length() == length
            && Object::is(&view.buffer(), &buffer)
        {
            return view.clone();
        }
        let made = Float32Array::new_with_byte_offset_and_length(&buffer, place, length);
        *view = Some(made.clone());
        made
    }
}
