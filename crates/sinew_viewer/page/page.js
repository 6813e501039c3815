// The page around the picture: parameters of the address, buttons, chosen or dropped files, and files for the user.
//
// ?scene=NAME, set=KEY=VALUE (any number), steps=N (taken at full speed, then the hash is shown), gpu=webgl2 (not WebGPU),
// panels=few (without the list of scenes) or none. A page sets its own panels in data-panels of its body.
// Attributes of the canvas: data-scene, data-steps, data-line (last message), data-subject (its position in the picture, in shares),
// data-follows, data-runs; data-ready is the time to the first picture, ms.
import init, { scenes, show } from './sinew.js';

const canvas = document.getElementById('viewer');
const line = document.getElementById('line');
const asked = new URLSearchParams(location.search);
const panels = asked.get('panels') ?? document.body.dataset.panels;
// On the start page characters walk and fall; in the viewer they lie on the workbench.
const onStage = panels === 'none';
let shown;
let isWanted = true;

const element = (id) => document.getElementById(id);
const orders = [...document.querySelectorAll('[data-order]')];

function download(name, blob) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

function say(text) {
  canvas.dataset.line = text;
  if (text && !text.startsWith('drawn by')) line.textContent = text;
}

const page = {
  tell(text) {
    if (text) console.log(text);
    say(text);
  },
  failed(text) {
    console.error(text);
    notice(text);
  },
  shown(title, steps, x, y, runs, follows) {
    if (!canvas.dataset.ready) {
      canvas.dataset.ready = Math.round(performance.now());
      element('loading').hidden = true;
    }
    if (canvas.dataset.scene !== title && panels !== 'none') document.title = `Sinew: ${title}`;
    Object.assign(canvas.dataset, { scene: title, steps, subject: `${x.toFixed(3)} ${y.toFixed(3)}`, runs, follows });
    for (const button of orders) {
      if (button.dataset.order === 'follow') button.ariaPressed = String(follows);
      if (button.dataset.order === 'pause') button.ariaPressed = String(!runs);
    }
  },
  keep(name, bytes) {
    download(name, new Blob([bytes]));
  },
  picture(name) {
    canvas.toBlob((blob) => download(name, blob));
  },
};

// Shows text, and elements after it, over the picture.
function notice(text, ...more) {
  const box = element('notice');
  box.replaceChildren(Object.assign(document.createElement('p'), { textContent: text }), ...more);
  box.hidden = false;
  canvas.dataset.line = text;
}

// Shows all scenes by chapter, as links.
function listed() {
  const chapters = new Map();
  for (const scene of scenes().split('\n')) {
    const [name, chapter, about] = scene.split('\t');
    const link = Object.assign(document.createElement('a'), { href: `?scene=${name}`, textContent: name, title: about });
    const item = document.createElement('li');
    item.append(link);
    if (!chapters.has(chapter)) chapters.set(chapter, []);
    chapters.get(chapter).push(item);
  }
  return [...chapters].flatMap(([chapter, items]) => {
    const list = document.createElement('ul');
    list.append(...items);
    return [Object.assign(document.createElement('b'), { textContent: chapter }), list];
  });
}

// Loads the program, and shows the progress: the server may not report the number of bytes.
async function program() {
  const response = await fetch('sinew_bg.wasm');
  const total = Number(canvas.dataset.bytes);
  const reader = response.clone().body.getReader();
  (async () => {
    let come = 0;
    for (;;) {
      const { done, value } = await reader.read();
      if (done) break;
      come += value.length;
      element('progress').value = (100 * come) / total;
    }
  })().catch(() => {});
  return response;
}

function begin(scene, settings) {
  const steps = Number.parseInt(asked.get('steps') ?? '', 10);
  return show(canvas, page, scene, settings, steps > 0 ? steps : undefined, asked.get('gpu') === 'webgl2', panels);
}

// Shows the subject of the address; if that fails, the demo and a list of the available subjects.
function beginAsked() {
  const scene = asked.get('scene') ?? undefined;
  try {
    return begin(scene, asked.getAll('set'));
  } catch (error) {
    const text = String(error);
    const isUnknown = text.startsWith('no scene');
    notice(isUnknown ? `There is no scene '${scene}'. The demo runs instead; these scenes exist:` : text, ...(isUnknown ? listed() : []));
    return begin(undefined, []);
  }
}

async function start() {
  element('play').hidden = true;
  element('loading').hidden = false;
  await init({ module_or_path: await program() });
  shown = beginAsked();
  watch();
  return shown;
}

// The simulation pauses while the page is hidden.
function watch() {
  if (!onStage) return;
  new IntersectionObserver(([entry]) => {
    const runs = canvas.dataset.runs === 'true';
    if (entry.isIntersecting ? isWanted && canvas.dataset.runs === 'false' : runs) shown.order('pause');
  }).observe(canvas);
}

let starting;
const started = () => (starting ??= start().catch((error) => page.failed(String(error))));

async function act(what) {
  await started();
  isWanted = true;
  try {
    what();
  } catch (error) {
    say(String(error));
  }
}

async function openFiles(files) {
  const contents = await Promise.all(files.map((file) => file.arrayBuffer()));
  await act(() => {
    files.forEach((file, index) => shown.file(file.name, new Uint8Array(contents[index])));
    if (files.length > 0) shown.open(onStage);
  });
  if (onStage) element('stage').scrollIntoView({ block: 'nearest' });
}

for (const button of orders) {
  button.addEventListener('click', () => {
    const runs = canvas.dataset.runs === 'true';
    act(() => shown.order(button.dataset.order)).then(() => {
      if (button.dataset.order === 'pause') isWanted = !runs;
    });
    element('hint')?.remove();
  });
}
for (const button of document.querySelectorAll('[data-sample]')) {
  button.addEventListener('click', async () => {
    await act(() => shown.sample(button.dataset.sample));
    element('stage').scrollIntoView({ block: 'nearest' });
  });
}
// Links to scenes run them here; with a key held they open the viewer.
for (const link of document.querySelectorAll('a.scene')) {
  link.addEventListener('click', async (event) => {
    if (event.ctrlKey || event.metaKey || event.shiftKey || event.button !== 0) return;
    event.preventDefault();
    await act(() => shown.scene(link.dataset.scene));
    element('full').href = link.href;
    element('stage').scrollIntoView({ block: 'center' });
  });
}
for (const button of document.querySelectorAll('[data-pick]')) button.addEventListener('click', () => element('file').click());
element('file').addEventListener('change', ({ target }) => openFiles([...target.files]));
element('play').addEventListener('click', started);
document.addEventListener('dragover', (event) => {
  event.preventDefault();
  element('drop')?.classList.add('over');
});
document.addEventListener('dragleave', () => element('drop')?.classList.remove('over'));
document.addEventListener('drop', (event) => {
  event.preventDefault();
  element('drop')?.classList.remove('over');
  openFiles([...event.dataTransfer.files]);
});
canvas.addEventListener('pointerdown', () => element('hint')?.remove());
canvas.addEventListener('keydown', (event) => {
  // Tab leaves the picture, which handles all other keys.
  if (event.key === 'Tab') event.stopImmediatePropagation();
  if (!onStage) return;
  if (event.key === 'Enter') act(() => shown.order('push'));
  if (event.key === ' ') event.preventDefault();
}, { capture: true });

// Users who prefer reduced motion, or little data, press a button first.
const isStill = matchMedia('(prefers-reduced-motion: reduce)').matches || navigator.connection?.saveData;
if (isStill && onStage && !asked.has('scene')) {
  element('play').hidden = false;
  element('loading').hidden = true;
} else {
  started();
  if (!onStage) canvas.focus({ preventScroll: true });
  if (onStage && matchMedia('(pointer: coarse)').matches) element('hint').textContent = 'Tap to push him';
}
