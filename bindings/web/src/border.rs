//! Border to JavaScript: converts errors, panics, and shared handles.

use std::cell::{Cell, RefCell};
use std::panic::{PanicHookInfo, set_hook};
use std::rc::Rc;
use wasm_bindgen::prelude::*;

/// Result of a call from JavaScript; a failure is thrown as an `Error` with the text.
pub type Outcome<T = ()> = Result<T, Failure>;

/// Text of an error.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure(pub String);

impl Failure {
    pub fn new(what: impl Into<String>) -> Self {
        Self(what.into())
    }
}

impl From<Failure> for JsValue {
    fn from(failure: Failure) -> Self {
        js_sys::Error::new(&failure.0).into()
    }
}

#[wasm_bindgen(module = "/src/attempt.js")]
extern "C" {
    /// Calls `call`; returns the thrown value, or `undefined`.
    fn attempt(call: &mut dyn FnMut()) -> JsValue;
}

thread_local! {
    /// Message of the last panic, and its source location.
    static LAST_PANIC: Cell<Option<(String, String)>> = const { Cell::new(None) };
}

/// Keeps the message of each panic for [`caught`]. Called once, when the module starts.
pub fn keep_panics() {
    set_hook(Box::new(|info: &PanicHookInfo<'_>| {
        let payload = info.payload();
        let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
        let text = text.or_else(|| payload.downcast_ref::<String>().cloned());
        let place = info.location().map(ToString::to_string).unwrap_or_default();
        LAST_PANIC.set(Some((text.unwrap_or_else(|| "a panic".to_owned()), place)));
    }));
}

/// Runs `call`; a panic or any other trap becomes its message and its source location. Frames in between are not unwound: their memory is
/// not freed, and their changes stay.
pub fn caught<T>(call: impl FnOnce() -> T) -> Result<T, (String, String)> {
    let (mut call, mut outcome) = (Some(call), None);
    let thrown = attempt(&mut || {
        if let Some(call) = call.take() {
            outcome = Some(call());
        }
    });
    match outcome {
        Some(value) => Ok(value),
        None => Err(LAST_PANIC.take().unwrap_or_else(|| (format!("{thrown:?}"), String::new()))),
    }
}

/// Runs a call that may panic about its arguments before it changes any state.
pub fn refused<T>(call: impl FnOnce() -> T) -> Outcome<T> {
    caught(call).map_err(|(what, _)| Failure(what))
}

/// A value shared by several JavaScript objects. A panic during a change makes it unusable, and every later call reports this.
pub struct Shared<T>(Rc<Handle<T>>);

struct Handle<T> {
    value: RefCell<T>,
    broken: RefCell<Option<String>>,
}

impl<T> Clone for Shared<T> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
}

impl<T> Shared<T> {
    pub fn new(value: T) -> Self {
        Self(Rc::new(Handle { value: RefCell::new(value), broken: RefCell::new(None) }))
    }

    fn check(&self) -> Outcome {
        match &*self.0.broken.borrow() {
            None => Ok(()),
            Some(what) => {
                Err(Failure(format!("this world was broken by an earlier error, make a new one: {what}")))
            }
        }
    }

    /// Reads the value.
    pub fn read<R>(&self, call: impl FnOnce(&T) -> Outcome<R>) -> Outcome<R> {
        self.check()?;
        let value = self.0.value.try_borrow().map_err(|_| in_use())?;
        refused(|| call(&value))?
    }

    /// Changes the value by a call that may panic about its arguments before it changes any state.
    pub fn change<R>(&self, call: impl FnOnce(&mut T) -> Outcome<R>) -> Outcome<R> {
        self.check()?;
        let mut value = self.0.value.try_borrow_mut().map_err(|_| in_use())?;
        refused(|| call(&mut value))?
    }

    /// Changes the value by a call that must not panic; a panic makes the value unusable.
    pub fn run<R>(&self, call: impl FnOnce(&mut T) -> Outcome<R>) -> Outcome<R> {
        self.check()?;
        let mut value = self.0.value.try_borrow_mut().map_err(|_| in_use())?;
        caught(|| call(&mut value)).unwrap_or_else(|(what, place)| {
            let report_text = format!("{what} ({place})");
            *self.0.broken.borrow_mut() = Some(report_text.clone());
            Err(Failure(report_text))
        })
    }
}

fn in_use() -> Failure {
    Failure::new("the world is in use by a call that has not returned")
}
