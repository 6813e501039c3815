//! Border to C: converts pointers, errors and panics.

use sinew_bindings::Failure;
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char};

/// Status of a call.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SinewStatus {
    /// The call succeeded.
    Ok = 0,
    /// A required pointer is null.
    NullPointer = 1,
    /// An id is stale: its object was removed, or belongs to another world.
    StaleId = 2,
    /// A number, a size or a name is invalid.
    BadArgument = 3,
    /// A file cannot be read or written, or is invalid; the message names the file and the place.
    BadFile = 4,
    /// The bytes are no snapshot of this version; the world is unchanged.
    BadSnapshot = 5,
    /// The buffer is too small; the needed count was stored.
    TooSmall = 6,
    /// A bug in the library. The object that was being changed is unusable and can only be freed.
    Panic = 7,
}

/// Error of a call: its status and its text.
#[derive(Debug)]
pub struct CallError {
    /// Status that the call returns.
    pub(crate) status: SinewStatus,
    what: String,
}

pub(crate) type Outcome<T = ()> = Result<T, CallError>;

/// Makes the error of a status, with a text.
pub(crate) fn error(status: SinewStatus, what: impl Into<String>) -> CallError {
    CallError { status, what: what.into() }
}

impl From<Failure> for CallError {
    fn from(failure: Failure) -> Self {
        let status = if failure.is_of_file { SinewStatus::BadFile } else { SinewStatus::BadArgument };
        error(status, failure.what)
    }
}

thread_local! {
    static LAST: RefCell<CString> = RefCell::default();
}

/// Runs the body of a call; a panic becomes an error without printed output.
pub(crate) fn guard(call: impl FnOnce() -> Outcome) -> SinewStatus {
    let (status, what) = match caught(call) {
        Ok(()) => (SinewStatus::Ok, String::new()),
        Err(CallError { status, what }) => (status, what),
    };
    let what = CString::new(what.replace('\0', "?")).unwrap_or_default();
    // The thread-local text may already be destroyed when a thread ends.
    let _ = LAST.try_with(|last| last.replace(what));
    status
}

/// Runs `call`; a panic becomes [`SinewStatus::Panic`].
fn caught<T>(call: impl FnOnce() -> Outcome<T>) -> Outcome<T> {
    sinew_bindings::caught(call).unwrap_or_else(|what| Err(error(SinewStatus::Panic, what)))
}

/// Runs a library call that panics about its arguments before it changes any state; the panic becomes `BadArgument`.
pub(crate) fn refused<T>(call: impl FnOnce() -> T) -> Outcome<T> {
    caught(|| Ok(call())).map_err(|panic| error(SinewStatus::BadArgument, panic.what))
}

/// An object that becomes unusable if a change panics.
pub(crate) struct Handle<T> {
    it: T,
    is_broken: bool,
}

impl<T> Handle<T> {
    pub(crate) fn new(it: T) -> Self {
        Self { it, is_broken: false }
    }

    /// Returns the object for reading.
    pub(crate) fn get(&self) -> Outcome<&T> {
        self.check()?;
        Ok(&self.it)
    }

    /// Changes the object.
    pub(crate) fn change<R>(&mut self, call: impl FnOnce(&mut T) -> Outcome<R>) -> Outcome<R> {
        self.check()?;
        self.is_broken = true;
        let outcome = caught(|| call(&mut self.it));
        self.is_broken = matches!(&outcome, Err(error) if error.status == SinewStatus::Panic);
        outcome
    }

    fn check(&self) -> Outcome {
        if self.is_broken {
            return Err(error(SinewStatus::Panic, "an earlier call panicked: it can only be freed"));
        }
        Ok(())
    }
}

fn null(name: &str) -> CallError {
    error(SinewStatus::NullPointer, format!("{name} is null"))
}

/// Returns a reference to a pointer's target.
///
/// # Safety
/// The pointer is null or points to a `T` that no other thread changes during the borrow.
pub(crate) unsafe fn shared<'a, T>(pointer: *const T, name: &str) -> Outcome<&'a T> {
    // SAFETY: the caller guarantees the conditions under `# Safety`.
    unsafe { pointer.as_ref() }.ok_or_else(|| null(name))
}

/// Returns a mutable reference to a pointer's target.
///
/// # Safety
/// The pointer is null or points to a `T` that no other thread uses during the borrow.
pub(crate) unsafe fn exclusive<'a, T>(pointer: *mut T, name: &str) -> Outcome<&'a mut T> {
    // SAFETY: the caller guarantees the conditions under `# Safety`.
    unsafe { pointer.as_mut() }.ok_or_else(|| null(name))
}

/// Returns a slice of a pointer's elements; the pointer may be null if there are none.
///
/// # Safety
/// The pointer is null or points to `count` elements that no other thread changes during the borrow.
pub(crate) unsafe fn elements<'a, T>(pointer: *const T, count: usize, name: &str) -> Outcome<&'a [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    check_count::<T>(count, name)?;
    if pointer.is_null() {
        return Err(null(name));
    }
    // SAFETY: the caller guarantees the pointer and the count, which is not larger than memory.
    Ok(unsafe { core::slice::from_raw_parts(pointer, count) })
}

fn check_count<T>(count: usize, name: &str) -> Outcome {
    let most = isize::MAX as usize / size_of::<T>().max(1);
    if count <= most {
        Ok(())
    } else {
        Err(error(SinewStatus::BadArgument, format!("too many {name}: {count}")))
    }
}

/// Checks that the pointer for a result is not null, before any state is changed.
pub(crate) fn room<T>(pointer: *mut T, name: &str) -> Outcome {
    if pointer.is_null() { Err(null(name)) } else { Ok(()) }
}

/// Writes a value to the caller's memory.
///
/// # Safety
/// The pointer is null or points to room for a `T`.
pub(crate) unsafe fn give<T>(pointer: *mut T, name: &str, value: T) -> Outcome {
    room(pointer, name)?;
    // SAFETY: the caller guarantees a valid pointer; the old content may be uninitialized, so it is not dropped.
    unsafe { pointer.write(value) };
    Ok(())
}

/// Writes values into a buffer, and their number into `count`. If the buffer is too small, writes only the number.
///
/// # Safety
/// `buffer` is null or has room for `capacity` elements, `count` is null or points to a number.
pub(crate) unsafe fn fill<T: Copy>(
    values: &[T],
    buffer: *mut T,
    capacity: usize,
    count: *mut usize,
) -> Outcome {
    // SAFETY: the caller guarantees the conditions under `# Safety`.
    unsafe { give(count, "count", values.len()) }?;
    if values.len() > capacity {
        let what = format!("room for {capacity} of {}", values.len());
        return Err(error(SinewStatus::TooSmall, what));
    }
    if values.is_empty() {
        return Ok(());
    }
    room(buffer, "the buffer")?;
    // SAFETY: the caller guarantees the capacity; the buffer is the caller's, so it does not overlap ours.
    unsafe { core::ptr::copy_nonoverlapping(values.as_ptr(), buffer, values.len()) };
    Ok(())
}

/// Returns UTF-8 text of the caller.
///
/// # Safety
/// The pointer is null or points to text that ends with a zero.
pub(crate) unsafe fn text<'a>(pointer: *const c_char, name: &str) -> Outcome<&'a str> {
    if pointer.is_null() {
        return Err(null(name));
    }
    // SAFETY: the caller guarantees the conditions under `# Safety`.
    let text = unsafe { CStr::from_ptr(pointer) }.to_str();
    text.map_err(|_| error(SinewStatus::BadArgument, format!("{name} is not UTF-8")))
}

/// Allocates a handle and writes its pointer.
///
/// # Safety
/// As [`give`].
pub(crate) unsafe fn give_handle<T>(pointer: *mut *mut T, name: &str, value: T) -> Outcome {
    room(pointer, name)?;
    // SAFETY: the caller guarantees the conditions under `# Safety`.
    unsafe { give(pointer, name, Box::into_raw(Box::new(value))) }
}

/// Frees a handle; null is allowed.
///
/// # Safety
/// The pointer is null or came from [`give_handle`], and is not used afterwards.
pub(crate) unsafe fn free<T>(pointer: *mut T) {
    if !pointer.is_null() {
        guard(|| {
            // SAFETY: the caller guarantees the conditions under `# Safety`.
            drop(unsafe { Box::from_raw(pointer) });
            Ok(())
        });
    }
}

/// Returns the error text of the last call of this thread, or "" if it returned `SINEW_STATUS_OK`. The text names the file and the
/// place. It is valid until the thread's next call.
#[unsafe(no_mangle)]
pub extern "C" fn sinew_last_error() -> *const c_char {
    LAST.try_with(|last| last.borrow().as_ptr()).unwrap_or(c"".as_ptr())
}

/// Returns the version of the library, such as "0.1.0".
#[unsafe(no_mangle)]
pub extern "C" fn sinew_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}
