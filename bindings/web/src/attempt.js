// Calls back into the program and returns the thrown value, or `undefined`. A WebAssembly trap unwinds no Rust frame,
// so only JavaScript can catch a panic.
export function attempt(call) {
  try {
    call();
    return undefined;
  } catch (error) {
    return error ?? new Error('an unknown error');
  }
}
