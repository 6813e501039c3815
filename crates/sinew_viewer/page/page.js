// The page around the viewer: what the address asks for, files that are dropped, files to be kept.
//
// ?scene=NAME, set=KEY=VALUE (any number), steps=N (steps so far at once, then tells the hash), gpu=webgl2 (not WebGPU),
// panels=few (without the list of scenes).
// The canvas says what it shows: data-scene, data-steps, data-line; data-ready is the time to the first picture, ms.
import init, { show } from './sinew.js';

const canvas = document.getElementById('viewer');
const line = document.getElementById('line');

function download(name, blob) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

const page = {
  tell(text) {
    canvas.dataset.line = text;
    if (text) console.log(text);
  },
  failed(text) {
    console.error(text);
    line.textContent = text;
    line.hidden = false;
  },
  shown(title, steps) {
    if (!canvas.dataset.ready) {
      canvas.dataset.ready = Math.round(performance.now());
      line.hidden = true;
    }
    if (canvas.dataset.scene !== title) document.title = `Sinew: ${title}`;
    canvas.dataset.scene = title;
    canvas.dataset.steps = steps;
  },
  keep(name, bytes) {
    download(name, new Blob([bytes]));
  },
  picture(name) {
    canvas.toBlob((blob) => download(name, blob));
  },
};

async function begin() {
  await init();
  const asked = new URLSearchParams(location.search);
  const steps = Number.parseInt(asked.get('steps') ?? '', 10);
  const shown = show(
    canvas,
    page,
    asked.get('scene') ?? undefined,
    asked.getAll('set'),
    steps > 0 ? steps : undefined,
    asked.get('gpu') === 'webgl2',
    asked.get('panels') === 'few',
  );
  document.addEventListener('dragover', (event) => event.preventDefault());
  document.addEventListener('drop', async (event) => {
    event.preventDefault();
    const files = [...event.dataTransfer.files];
    const contents = await Promise.all(files.map((file) => file.arrayBuffer()));
    files.forEach((file, index) => shown.file(file.name, new Uint8Array(contents[index])));
    if (files.length > 0) shown.open();
  });
  canvas.focus();
}

begin().catch((error) => page.failed(String(error)));
