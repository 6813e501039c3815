// Tests the packed package as users have it: the programs of its README, in Node, in Vite, and in the page of the tests.
import { spawn } from 'node:child_process';
import { cp, mkdir, readFile } from 'node:fs/promises';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { blocks, browse, check, emptyFolder, open, run, serve, told, until, write } from './harness.mjs';

const here = dirname(fileURLToPath(import.meta.url));
// Widths of the front page on a desktop and on a phone.
const SIZES = [[1280, 720], [390, 844]];
const pictures = join(told.out, 'pictures');
const names = Object.keys(told.native.hashes).filter((name) => name !== 'boxes');

function lines(text) {
  return text.trim().split('\n').map((line) => line.replace(/\s+#.*$/, '').replace('sinew-physics', told.tarball));
}

// Runs the commands and writes the files of the README in order in an empty folder; `npx vite` keeps running.
async function typed() {
  const folder = await emptyFolder('readme');
  const page = await readFile(join(told.root, 'bindings/web/package/README.md'), 'utf8');
  const files = { html: 'index.html', js: 'main.js', mjs: 'fall.mjs' };
  let vite;
  for (const [language, text] of blocks(page)) {
    if (files[language]) await write(folder, { [files[language]]: text });
    if (language !== 'sh') continue;
    for (const line of lines(text)) {
      const [program, ...words] = line.split(' ');
      if (line === 'npx vite') vite = await serving(folder);
      else console.log(run(folder, program, ...words).trim());
    }
  }
  return { folder, vite };
}

// Starts a server and returns its address.
async function serving(folder) {
  const server = spawn('npx', ['vite', '--port', '0', '--host', '127.0.0.1'], { cwd: folder, detached: true });
  const address = await new Promise((done, failed) => {
    let said = '';
    server.stdout.on('data', (data) => {
      said += data;
      const found = said.replace(/\x1b\[\d+m/g, '').match(/http:\/\/127\.0\.0\.1:\d+/);
      if (found) done(found[0]);
    });
    server.stderr.on('data', (data) => { said += data; });
    server.on('exit', () => failed(new Error(said)));
  });
  return { address, end: () => process.kill(-server.pid) };
}

// The README's page by the development server: the hero falls, gets up and walks on. The built page starts too.
async function readme(browser) {
  const { folder, vite } = await typed();
  try {
    const page = await open(browser, vite.address);
    await page.evaluate(() => { addEventListener('error', (event) => console.error(event.message)); });
    const up = new Promise((done) => page.on('console', (message) => message.text() === 'it is up again' && done()));
    await until(page, 'a canvas', () => document.querySelector('canvas'));
    await new Promise((done) => setTimeout(done, 4000));
    await page.screenshot({ path: join(pictures, 'readme_fall.png') });
    await Promise.race([up, new Promise((_, failed) => setTimeout(() => failed(new Error('the hero of the README does not get up')), 240_000))]);
    await page.screenshot({ path: join(pictures, 'readme_up.png') });
    page.fine();
    await page.close();
  } finally {
    vite.end();
  }
  run(folder, 'npx', 'vite', 'build');
  const server = await serve({}, join(folder, 'dist'));
  const page = await open(browser, server.address);
  await until(page, 'the built page', () => document.querySelector('canvas'));
  page.fine();
  await page.close();
  server.close();
  return folder;
}

async function scenes(browser, folder) {
  const modules = join(here, 'node_modules');
  const folders = {
    'sinew-physics': join(folder, 'node_modules/sinew-physics'),
    three: join(folder, 'node_modules/three'),
    'three-vrm': join(modules, '@pixiv/three-vrm'),
    rigs: told.rigs ?? '/nowhere',
  };
  const server = await serve(folders, here);
  const page = await open(browser, `${server.address}/page.html`);
  await until(page, 'the page of the tests', () => window.tests);
  const ask = (name, ...values) => page.evaluate((name, values) => window.tests[name](...values), name, values);
  await hashes(ask);
  const { height } = await ask('worker');
  check(Math.abs(height - 0.5) < 0.01, `a ball lies on the ground in a worker, ${height} m high`);
  for (const name of names) await falls(page, ask, name);
  await rest(page, ask);
  await hair(page, ask);
  await memory(ask);
  await drags(page, ask);
  page.fine();
  await page.close();
  server.close();
}

async function hashes(ask) {
  const found = await ask('hashes', names);
  for (const [name, hash] of Object.entries(told.native.hashes)) {
    check(found[name] === hash, `${name} has the native hash ${hash} after 600 steps, not ${found[name]}`);
  }
  console.log(`hashes after 600 steps as native: ${Object.keys(found).join(', ')}`);
}

async function falls(page, ask, name) {
  const fell = await ask('falls', name);
  await page.screenshot({ path: join(pictures, `fall_${name}.png`) });
  console.log(`${name}: ${fell.bound} of ${fell.joints} joints bound, fell ${fell.fell.toFixed(2)} m, ${fell.heard.join(' ')}, ${fell.state}`);
  // Missing ankles are added.
  check(fell.bound >= fell.joints - 2, `${name}: the joints are bound`);
  check(fell.heard.includes('limp') && fell.heard.includes('landed'), `${name} falls`);
}

async function rest(page, ask) {
  const found = await ask('rest');
  await page.screenshot({ path: join(pictures, 'rest.png') });
  console.log(JSON.stringify(found));
  check(found.begins > 0 && found.apart < 0.02 && found.picked && found.back, 'bodies, rays, events and states');
}

async function hair(page, ask) {
  const found = await ask('hair');
  await page.screenshot({ path: join(pictures, 'hair.png') });
  console.log(JSON.stringify(found));
  check(found.vrm && found.isSound && found.chains > 0 && found.swing > 0.02, 'the hair of a VRM swings');
}

// 200 spawns and disposals of two characters, five bodies and a piece of cloth.
async function memory(ask) {
  const { taken, heap, left } = await ask('memory', 10, 20);
  const shown = (bytes) => bytes.map((each) => (each * 1e-6).toFixed(1)).join(' ');
  console.log(`memory of the program ${shown(taken)} MB, heap of the page ${shown(heap)} MB, left ${JSON.stringify(left)}`);
  check(left.bodies === 1 && left.objects === 2, 'nothing is left of what was removed');
  check(taken.at(-1) === taken[2], 'the memory of the program is flat');
  check(heap.at(-1) < 1.1 * heap[2] + 2e6, 'the heap of the page is flat');
}

// The mouse drags the chest of the mannequin up.
async function drags(page, ask) {
  const [x, y] = await ask('stand', 'mannequin');
  await page.mouse.move(x, y);
  await page.mouse.down();
  check(await page.evaluate(() => !window.drag.isDragging && window.hero.state === 'animated'), 'a press alone takes hold of nothing');
  await page.mouse.move(x + 10, y);
  check(await page.evaluate(() => window.drag.isDragging), 'the pointer holds the chest');
  await page.mouse.move(x + 150, y - 60, { steps: 8 });
  await until(page, 'it to be dragged', () => window.hero.position.x > 0.25);
  await page.screenshot({ path: join(pictures, 'dragged.png') });
  await page.mouse.up();
  check(await page.evaluate(() => !window.drag.isDragging && window.hero.state === 'limp'), 'it was let go, limp');
}

// Wrong calls throw errors with a message, in Node.
async function errors(folder) {
  await cp(join(here, 'errors.mjs'), join(folder, 'errors.mjs'));
  console.log(run(folder, 'node', 'errors.mjs').trim());
}

// A program in TypeScript fits the types of the package.
async function types(folder) {
  const { devDependencies } = JSON.parse(await readFile(join(here, 'package.json'), 'utf8'));
  const packages = ['typescript', '@types/three'].map((name) => `${name}@${devDependencies[name]}`);
  run(folder, 'npm', 'install', '--no-audit', '--no-fund', '--save-dev', ...packages);
  await cp(join(here, 'user.ts'), join(folder, 'user.ts'));
  const strict = ['--noEmit', '--strict', '--target', 'es2022', '--module', 'esnext', '--moduleResolution', 'bundler'];
  run(folder, 'npx', 'tsc', ...strict, '--lib', 'es2022,dom,dom.iterable,esnext.disposable', 'user.ts');
  console.log('a program in TypeScript fits the types');
}

// Each example builds, and its page shows something without an error.
async function examples(browser, folder) {
  const source = join(told.root, 'bindings/web/package/examples');
  const target = join(folder, 'examples');
  await cp(source, target, { recursive: true });
  const { devDependencies } = JSON.parse(await readFile(join(here, 'package.json'), 'utf8'));
  const react = ['react', 'react-dom', '@react-three/fiber'].map((name) => `${name}@${devDependencies[name]}`);
  run(folder, 'npm', 'install', '--no-audit', '--no-fund', ...react);
  run(target, join(folder, 'node_modules/.bin/vite'), 'build');
  const server = await serve({}, join(target, 'dist'));
  for (const name of ['falling', 'crowd', 'shooter', 'cloth', 'react']) {
    const page = await open(browser, `${server.address}/${name}.html`);
    await until(page, `the example ${name}`, () => document.querySelector('canvas') && window.ready);
    await new Promise((done) => setTimeout(done, 5000));
    await page.screenshot({ path: join(pictures, `example_${name}.png`) });
    page.fine();
    await page.close();
  }
  for (const [width, height] of SIZES) {
    const page = await open(browser, `${server.address}/`, { width, height });
    await until(page, 'the front page', () => window.ready);
    await new Promise((done) => setTimeout(done, 5000));
    await page.screenshot({ path: join(pictures, `front_${width}x${height}.png`) });
    await page.click('#push');
    await until(page, 'it to be pushed over', () => document.getElementById('state').textContent.startsWith('It falls'));
    page.fine();
    await page.close();
  }
  server.close();
  console.log('the front page in two sizes and five examples are built and run');
}

await mkdir(pictures, { recursive: true });
const browser = await browse();
try {
  const folder = await readme(browser);
  await errors(folder);
  await types(folder);
  await scenes(browser, folder);
  await examples(browser, folder);
  console.log(`all as it should be; pictures in ${pictures}`);
} finally {
  await browser.close();
}
