// Shared by the tests: commands, a server of files on the loopback, a browser.
import { execFileSync } from 'node:child_process';
import { createServer } from 'node:http';
import { mkdir, readFile, rm, writeFile } from 'node:fs/promises';
import { extname, join } from 'node:path';
import puppeteer from 'puppeteer-core';

// Input from `cargo xtask npm`: paths of the tarball, the repository and the rigs, and results of the native library.
export const told = JSON.parse(process.argv[2]);

const KINDS = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.wasm': 'application/wasm' };
const FLAGS = ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
  '--ignore-gpu-blocklist', '--enable-precise-memory-info', '--js-flags=--expose-gc'];

export function check(holds, what) {
  if (!holds) throw new Error(`not so: ${what}`);
}

// Runs a program, forwards its output, and returns its stdout.
export function run(folder, program, ...words) {
  console.error(`$ ${program} ${words.join(' ')}`);
  return execFileSync(program, words, { cwd: folder, encoding: 'utf8', stdio: ['ignore', 'pipe', 'inherit'] });
}

export async function emptyFolder(name) {
  const folder = join(told.out, name);
  await rm(folder, { recursive: true, force: true });
  await mkdir(folder, { recursive: true });
  return folder;
}

// Fenced blocks of a page: [language, text], in order.
export function blocks(page) {
  return [...page.matchAll(/^```(\w+)\n([\s\S]*?)^```$/gm)].map(([, language, text]) => [language, text]);
}

export async function write(folder, files) {
  for (const [name, text] of Object.entries(files)) await writeFile(join(folder, name), text);
}

// Files of some folders, by the first part of the path; the last folder has the rest.
export async function serve(folders, rest) {
  const server = createServer(async (request, response) => {
    const path = decodeURIComponent(new URL(request.url, 'http://localhost').pathname).slice(1) || 'index.html';
    const [first, ...others] = path.split('/');
    const file = folders[first] ? join(folders[first], ...others) : join(rest, path);
    try {
      const bytes = await readFile(file);
      response.writeHead(200, { 'content-type': KINDS[extname(file)] ?? 'application/octet-stream' }).end(bytes);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  return { address: `http://127.0.0.1:${server.address().port}`, close: () => server.close() };
}

export async function browse() {
  return puppeteer.launch({ executablePath: '/usr/bin/chromium', headless: true, protocolTimeout: 600_000, args: FLAGS });
}

// A page whose errors end the test.
export async function open(browser, url, size = { width: 960, height: 600 }) {
  const page = await browser.newPage();
  const errors = [];
  await page.setViewport(size);
  page.on('pageerror', (error) => errors.push(error.stack ?? String(error)));
  page.on('console', (message) => {
    const { url = '' } = message.location();
    if (url.endsWith('/favicon.ico')) return;
    if (message.type() === 'error') errors.push(`${message.text()} ${url}`);
    else console.error(`  page: ${message.text()}`);
  });
  page.fine = () => check(errors.length === 0, `no error in the page: ${errors.join('\n')}`);
  await page.goto(url);
  return page;
}

export async function until(page, what, condition, ...values) {
  try {
    await page.waitForFunction(condition, { timeout: 300_000, polling: 100 }, ...values);
  } catch (error) {
    page.fine();
    throw new Error(`nothing came of ${what}: ${error.message}`);
  }
  page.fine();
}
