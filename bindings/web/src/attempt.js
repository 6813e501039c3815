// Calls back into the program and returns what was thrown on the way, `undefined` if nothing was. A trap of WebAssembly
// unwinds no frame of Rust, so JavaScript is where a panic can be caught.
export function attempt(call) {
  try {
    call();
    return undefined;
  } catch (error) {
    return error ?? new Error('an unknown error');
  }
}
