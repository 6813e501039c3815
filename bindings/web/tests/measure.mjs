// Measures the package in headless Chromium beside the native library, which `cargo xtask npm --measure` has timed just before. Prints a table.
import { brotliCompressSync, gzipSync } from 'node:zlib';
import { readFile } from 'node:fs/promises';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { browse, emptyFolder, open, run, serve, told, until } from './harness.mjs';

const here = dirname(fileURLToPath(import.meta.url));
const folder = await emptyFolder('measure');
run(folder, 'npm', 'install', '--no-audit', '--no-fund', told.tarball, 'three');
const installed = join(folder, 'node_modules/sinew-physics');
const program = await readFile(join(installed, 'wasm/sinew_web_bg.wasm'));
const text = await readFile(join(installed, 'wasm/sinew_web.js'));
const megabytes = (bytes) => `${(bytes * 1e-6).toFixed(2)} MB`;

const server = await serve({
  'sinew-physics': installed,
  three: join(folder, 'node_modules/three'),
  'three-vrm': join(here, 'node_modules/@pixiv/three-vrm'),
  rigs: told.rigs ?? '/nowhere',
}, here);
const browser = await browse();
const ask = async (name, ...values) => {
  // A page for each, so that none uses code that another has warmed up.
  const page = await open(browser, `${server.address}/page.html`);
  await until(page, 'the page', () => window.tests);
  const found = await page.evaluate((name, values) => window.tests[name](...values), name, values);
  await page.close();
  return found;
};
const rows = [
  ['program, after gzip; after brotli', `${megabytes(gzipSync(program, { level: 9 }).length)}; ${megabytes(brotliCompressSync(program).length)}`],
  ['JavaScript around it, after gzip', megabytes(gzipSync(text, { level: 9 }).length)],
  ['`init` without warm-up', `${(await ask('started', false)).toFixed(0)} ms`],
  ['`init` with warm-up', `${(await ask('started', true)).toFixed(0)} ms`],
];
for (const [name, native] of Object.entries(told.native.times)) {
  const { loaded, copied, spawned, limp, first, second, crowd } = await ask('times', name);
  rows.push([`${name}: definition built`, `${loaded.toFixed(0)} ms`]);
  rows.push([`${name}: a further copy, its model cloned; without model`, `${copied.toFixed(1)}; ${spawned.toFixed(1)} ms`]);
  const narrow = told.native.narrow[name];
  const beside = (here, wide, thin, digits) => `${here.toFixed(digits)}; ${wide.toFixed(digits)}; ${thin.toFixed(digits)} ms; ${(here / wide).toFixed(2)}; ${(here / thin).toFixed(2)}`;
  rows.push([`${name}: step limp; native; native of 128 bits; ratios`, beside(limp, native.limp, narrow.limp, 3)]);
  rows.push([`${name}: first fall beside the second`, (first / second).toFixed(2)]);
  rows.push([`${name}: step of 30 walking, 10 falling; native; native of 128 bits; ratios`, beside(crowd, native.crowd, narrow.crowd, 2)]);
}
await browser.close();
server.close();
console.log('| measured | found |\n|---|---|');
for (const [what, found] of rows) console.log(`| ${what} | ${found} |`);
