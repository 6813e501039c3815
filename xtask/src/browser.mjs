// Tries the page of `cargo xtask web` in a headless Chromium, by the DevTools protocol: node browser.mjs check FOLDER PICTURES
// CASES, where CASES is JSON: {"scenes": [[NAME, STEPS], …], "drop": [PATH of a GLB, …]}, and "ways" to draw if not all. Prints JSON: for each of the ways to draw
// what it draws by, milliseconds to the first picture, hashes, what was dragged and dropped; errors of the console end it.
// `pictures` in place of `check` draws those of the start page: {"gallery": [[NAME, STEPS], …]}.
import { spawn } from 'node:child_process';
import { createServer } from 'node:http';
import { mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { basename, extname, join } from 'node:path';
import { drawn, startPage } from './start_page.mjs';

const [task, folder, pictures, cases] = process.argv.slice(2);
const { scenes, drop, ways, gallery } = JSON.parse(cases);
// Software drivers on a busy machine.
const PATIENCE_MS = 180_000;
const SIZE = { width: 1280, height: 760 };
const WAYS = {
  webgl2: ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
  // Without Vulkan for the page as well the frames of WebGPU are never shown.
  webgpu: ['--enable-unsafe-webgpu', '--use-webgpu-adapter=swiftshader', '--enable-features=Vulkan',
    '--use-vulkan=swiftshader', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
};
const KINDS = {
  '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.wasm': 'application/wasm', '.jpg': 'image/jpeg', '.png': 'image/png',
};

const sleep = (ms) => new Promise((done) => setTimeout(done, ms));

// Serves the files of the folder alone, on the loopback.
async function serve() {
  const server = createServer(async (request, response) => {
    // The parser has removed any '..' from the path of a URL.
    const name = new URL(request.url, 'http://localhost').pathname.slice(1) || 'index.html';
    try {
      const bytes = await readFile(join(folder, name));
      response.writeHead(200, { 'content-type': KINDS[extname(name)] ?? 'application/octet-stream' }).end(bytes);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  return server;
}

// Opens a browser with one page, and collects the messages of its console.
class Browser {
  static async start(flags) {
    const browser = new Browser();
    browser.home = await mkdtemp(join(tmpdir(), 'sinew-browser-'));
    const general = ['--headless=new', '--no-sandbox', '--no-first-run', '--disable-background-networking',
      '--ignore-gpu-blocklist', '--hide-scrollbars', `--user-data-dir=${browser.home}`, '--remote-debugging-port=0',
      `--window-size=${SIZE.width},${SIZE.height}`];
    browser.process = spawn('chromium', [...general, ...flags, 'about:blank'], { stdio: 'ignore' });
    const port = await browser.until('the browser to start', async () => {
      const told = await readFile(join(browser.home, 'DevToolsActivePort'), 'utf8').catch(() => '');
      return told.split('\n')[0];
    });
    const pages = await (await fetch(`http://127.0.0.1:${port}/json/list`)).json();
    browser.socket = new WebSocket(pages.find((page) => page.type === 'page').webSocketDebuggerUrl);
    browser.pending = new Map();
    browser.errors = [];
    browser.socket.onmessage = ({ data }) => browser.hear(JSON.parse(data));
    await new Promise((done, failed) => Object.assign(browser.socket, { onopen: done, onerror: failed }));
    for (const domain of ['Page', 'Runtime', 'Log', 'Network']) await browser.send(`${domain}.enable`);
    await browser.send('Emulation.setDeviceMetricsOverride', { ...SIZE, deviceScaleFactor: 1, mobile: false });
    return browser;
  }

  hear({ id, result, error, method, params }) {
    if (id) {
      const { done, failed } = this.pending.get(id);
      this.pending.delete(id);
      return error ? failed(new Error(JSON.stringify(error))) : done(result);
    }
    if (method === 'Runtime.exceptionThrown') this.errors.push(JSON.stringify(params.exceptionDetails));
    if (method === 'Log.entryAdded' && params.entry.level === 'error') this.errors.push(params.entry.text);
    if (method === 'Runtime.consoleAPICalled' && params.type === 'error') {
      this.errors.push(params.args.map((arg) => arg.value ?? arg.description).join(' '));
    }
  }

  send(method, params = {}) {
    const id = (this.last = (this.last ?? 0) + 1);
    this.socket.send(JSON.stringify({ id, method, params }));
    return new Promise((done, failed) => this.pending.set(id, { done, failed }));
  }

  // State that the canvas reports.
  async said() {
    const expression = "JSON.stringify({...document.getElementById('viewer')?.dataset})";
    const { result } = await this.send('Runtime.evaluate', { expression });
    return JSON.parse(result.value ?? '{}');
  }

  async until(what, found) {
    const end = Date.now() + PATIENCE_MS;
    while (Date.now() < end) {
      if (this.errors?.length) throw new Error(`waiting for ${what}: ${this.errors.join('\n')}`);
      const it = await found();
      if (it) return it;
      await sleep(50);
    }
    throw new Error(`nothing came of ${what}: ${JSON.stringify(await this.said().catch(String))}`);
  }

  line(start) {
    return this.until(`'${start}'`, async () => {
      const { line } = await this.said();
      return line?.startsWith(start) && line;
    });
  }

  async open(url) {
    await this.send('Page.navigate', { url });
    await this.until(url, async () => (await this.said()).ready);
    return this.said();
  }

  // Returns the value of an expression in the page.
  async ask(expression) {
    const { result, exceptionDetails } = await this.send('Runtime.evaluate', { expression, awaitPromise: true, returnByValue: true });
    if (exceptionDetails) throw new Error(`${expression}: ${JSON.stringify(exceptionDetails)}`);
    return result.value;
  }

  size(width, height, mobile = false) {
    return this.send('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1, mobile });
  }

  mouse(type, x, y, buttons) {
    return this.send('Input.dispatchMouseEvent', { type, x, y, button: 'left', buttons, clickCount: 1 });
  }

  // Returns a picture of the page, or of a part of it as a JPEG.
  async picture(name, clip) {
    const how = clip ? { format: 'jpeg', quality: 80, clip: { ...clip, scale: 1 } } : {};
    const { data } = await this.send('Page.captureScreenshot', how);
    await writeFile(join(pictures, `${name}.${clip ? 'jpg' : 'png'}`), Buffer.from(data, 'base64'));
  }

  async end() {
    this.process.kill();
    await new Promise((done) => (this.process.exitCode === null ? this.process.once('exit', done) : done()));
    await rm(this.home, { recursive: true, force: true, maxRetries: 5 });
  }
}

// Drags from the middle of the picture, where a single falling body is.
async function drag(browser, url) {
  await browser.open(`${url}&scene=free_fall&steps=1`);
  await browser.line('hash');
  await browser.mouse('mouseMoved', 620, 357, 0);
  await browser.mouse('mousePressed', 620, 357, 1);
  await browser.mouse('mouseMoved', 632, 350, 1);
  const held = await browser.line('holds body');
  await browser.mouse('mouseMoved', 760, 250, 1);
  for (const type of ['keyDown', 'keyUp']) {
    await browser.send('Input.dispatchKeyEvent', { type, key: 'n', code: 'KeyN', text: type === 'keyDown' ? 'n' : undefined });
  }
  await browser.until('a step', async () => (await browser.said()).steps > 1);
  await browser.mouse('mouseReleased', 760, 250, 0);
  await browser.line('let go');
  return held;
}

async function dropped(browser, url, path) {
  await browser.open(url);
  const data = { items: [], files: [path], dragOperationsMask: 1 };
  for (const type of ['dragEnter', 'dragOver', 'drop']) {
    await browser.send('Input.dispatchDragEvent', { type, x: 620, y: 357, data });
  }
  const name = basename(path);
  await browser.until(`${name} to be shown`, async () => (await browser.said()).scene === name);
  await browser.until('it to fall', async () => (await browser.said()).steps > 30);
  await browser.picture(name);
  return name;
}

// Checks a chapter of the book: its pictures exist, and a click on the first one runs it.
async function chapter(browser, url) {
  const address = new URL('chapter-1.html', url);
  address.search = new URL(url).search;
  const ask = (expression) => browser.ask(expression);
  await browser.send('Page.navigate', { url: String(address) });
  const button = "document.querySelector('button[data-scene]')";
  await browser.until('a chapter', () => ask(`document.readyState === 'complete' && ${button}?.dataset.scene`));
  const scene = await ask(`${button}.dataset.scene`);
  await ask(`${button}.scrollIntoView()`);
  await browser.until('its picture', () => ask(`${button}.querySelector('img').naturalWidth > 0`));
  await ask(`${button}.click()`);
  const shown = "document.querySelector('iframe')?.contentDocument?.getElementById('viewer')?.dataset";
  await browser.until(`${scene} in its chapter`, () => ask(`${shown}?.scene === '${scene}' && ${shown}.steps > 2`));
  return scene;
}

async function tried(way, site) {
  const browser = await Browser.start(WAYS[way]);
  const url = `${site}viewer.html?gpu=${way}`;
  try {
    const { ready } = await browser.open(url);
    const by = await browser.line('drawn by');
    // The browser keeps compiled code from the second load on.
    const { ready: again } = await browser.open(url);
    await browser.picture(`${way}-first`);
    const hashes = {};
    for (const [scene, steps] of scenes) {
      await browser.open(`${url}&scene=${scene}&steps=${steps}`);
      hashes[scene] = (await browser.line('hash')).split(' ')[1];
      await browser.picture(`${way}-${scene}`);
    }
    const held = await drag(browser, url);
    await browser.picture(`${way}-dragged`);
    const shown = [];
    for (const path of drop) shown.push(await dropped(browser, url, path));
    const run = await chapter(browser, url);
    await browser.picture(`${way}-chapter`);
    const start = await startPage(browser, way, site, drop);
    if (browser.errors.length) throw new Error(browser.errors.join('\n'));
    return { by, ready_ms: Number(ready), ready_again_ms: Number(again), hashes, held, dropped: shown, chapter: run, start };
  } finally {
    await browser.end();
  }
}

const server = await serve();
const site = `http://127.0.0.1:${server.address().port}/`;
const outcome = {};
try {
  if (task === 'pictures') {
    const browser = await Browser.start(WAYS.webgl2);
    await drawn(browser, site, gallery).finally(() => browser.end());
  } else {
    for (const way of ways ?? Object.keys(WAYS)) outcome[way] = await tried(way, site);
  }
  console.log(JSON.stringify(outcome, null, 1));
} catch (error) {
  console.error(String(error));
  process.exitCode = 1;
} finally {
  server.close();
}
