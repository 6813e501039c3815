// Sinew: physics for characters. Call `init` once and wait for it, then use the classes.
import load, { warmUp } from './wasm/sinew_web.js';

export * from './wasm/sinew_web.js';

/** @type {Promise<void> | undefined} */
let loading;
/** @type {WebAssembly.Memory | undefined} */
let memory;

/** True in Node, where `fetch` cannot read files. */
function isNode() {
  const { process } = /** @type {any} */ (globalThis);
  return Boolean(process?.versions?.node) && import.meta.url.startsWith('file:');
}

/** @param {InitOptions} options */
async function start({ wasm, warm = true }) {
  let source = wasm;
  if (source === undefined && isNode()) {
    // The name is in a variable, so that bundlers for browsers do not resolve the module.
    const files = 'node:fs/promises';
    const { readFile } = await import(/* @vite-ignore */ /* webpackIgnore: true */ files);
    source = await readFile(new URL('./wasm/sinew_web_bg.wasm', import.meta.url));
  }
  const exports = await load(source === undefined ? undefined : { module_or_path: source });
  memory = exports.memory;
  if (warm) warmUp();
}

/**
 * Options of `init`.
 * @typedef {object} InitOptions
 * @property {string | URL | Request | Response | BufferSource | WebAssembly.Module | Promise<Response>} [wasm]
 *   The program or its address. By default it is next to this file.
 * @property {boolean} [warm] False: the first falls are slower, since the browser compiles code when it is first called. Default true.
 */

/**
 * Loads the program. All calls wait for the same load; a failed load is retried.
 * @param {InitOptions} [options]
 * @returns {Promise<void>}
 */
export function init(options = {}) {
  loading ??= start(options).catch((error) => {
    loading = undefined;
    throw error;
  });
  return loading;
}

/**
 * Bytes of memory that the program has allocated. It never shrinks, but reuses freed memory.
 * @returns {number}
 */
export function memoryBytes() {
  return memory?.buffer.byteLength ?? 0;
}

export default init;
