// Tests of the start page in a browser, and its pictures: called by `browser.mjs`.
import { basename } from 'node:path';

// Width and height: a phone, a tablet, a laptop, a large screen, a small window.
const SIZES = [[390, 844], [768, 1024], [1280, 800], [1920, 1080], [800, 600]];
// Seconds of the demo for which its subject is watched: all of it on a phone, whose small picture is drawn fast, and the fall on other
// screens. Then the seconds at which pictures are taken.
const WATCHED_S = 15;
const FALL_S = 3.2;
const MOMENTS_S = [0.6, 1.8, 3, 5, 8, 11, 14];
// Least distance of the subject's middle from the edges, as a share of the picture.
const EDGE = 0.12;
// Least contrast of text, by WCAG 2 AA.
const CONTRAST = 4.5;
const STEPS_PER_S = 60;

const canvas = "document.getElementById('viewer')";

function demand(isSo, what) {
  if (!isSo) throw new Error(`start page: ${what}`);
}

async function opened(browser, url) {
  await browser.open(url);
  await browser.until('the demo', async () => (await browser.said()).steps > 1);
}

// Returns the rectangle of an element in the window.
function place(browser, element) {
  return browser.ask(`(() => { const { x, y, width, height } = ${element}.getBoundingClientRect(); return { x, y, width, height }; })()`);
}

async function clicked(browser, element) {
  await browser.ask(`${element}.scrollIntoView({ block: 'nearest', behavior: 'instant' })`);
  const { x, y, width, height } = await place(browser, element);
  await browser.mouse('mousePressed', x + width / 2, y + height / 2, 1);
  await browser.mouse('mouseReleased', x + width / 2, y + height / 2, 0);
}

const button = (order) => `document.querySelector('[data-order=${order}]')`;

// Checks that the subject stays in the picture for the whole run, and that the picture is in the window without scrolling.
async function watched(browser, name, seconds) {
  const { y, height } = await place(browser, canvas);
  const inner = await browser.ask('innerHeight');
  demand(y + 0.7 * height < inner && height > 200, `${name}: the picture is ${height} high at ${y} of ${inner}`);
  const wide = await browser.ask('document.scrollingElement.scrollWidth - innerWidth');
  demand(wide <= 0, `${name}: the page is ${wide} wider than the window`);
  const moments = MOMENTS_S.filter((moment) => moment <= seconds);
  let outermost = 0;
  for (;;) {
    const { steps, subject } = await browser.until('a frame', () => browser.said());
    const [left, top] = subject.split(' ').map(Number);
    const off = Math.max(Math.abs(left - 0.5), Math.abs(top - 0.5));
    demand(off < 0.5 - EDGE, `${name}: the subject is at ${subject} after ${steps} steps`);
    outermost = Math.max(outermost, off);
    if (steps / STEPS_PER_S >= moments[0]) await browser.picture(`start-${name}-${moments.shift()}s`);
    if (steps / STEPS_PER_S >= seconds) return Number(outermost.toFixed(3));
  }
}

// Checks pushes by the button, by a click on the figure and by a key, a thrown ball, and that the camera does not move.
async function pushed(browser, url) {
  await opened(browser, url);
  await clicked(browser, button('push'));
  await browser.line('pushed');
  await browser.until('it to fall', async () => (await browser.said()).steps > 60);
  await browser.picture('start-pushed');
  await opened(browser, url);
  const { subject } = await browser.said();
  const { x, y, width, height } = await place(browser, canvas);
  const [left, top] = subject.split(' ').map(Number);
  await browser.mouse('mouseMoved', x + left * width, y + top * height, 0);
  await browser.mouse('mousePressed', x + left * width, y + top * height, 1);
  await browser.mouse('mouseReleased', x + left * width, y + top * height, 0);
  await browser.line('pushed');
  demand(!(await browser.ask("document.getElementById('hint')")), 'the hint stays after a click');
  await clicked(browser, button('throw'));
  await browser.line('threw a ball');
  await clicked(browser, button('follow'));
  await browser.until('a camera that stands', async () => (await browser.said()).follows === 'false');
  demand((await browser.ask(`${button('follow')}.ariaPressed`)) === 'false', 'the button does not say that the camera stands');
  await clicked(browser, button('pause'));
  await browser.until('a pause', async () => (await browser.said()).runs === 'false');
  await clicked(browser, button('restart'));
  await browser.until('it to begin again', async () => (await browser.said()).runs === 'true' && (await browser.said()).steps < 60);
}

async function wrongScene(browser, site, way) {
  await opened(browser, `${site}?gpu=${way}&scene=nonsense`);
  const told = await browser.ask("document.getElementById('notice').textContent");
  demand(told.includes("no scene 'nonsense'") && told.includes('kepler'), `of a wrong scene it says ${told}`);
  const links = await browser.ask("document.querySelectorAll('#notice a').length");
  demand(links > 90, `${links} scenes are listed`);
  const hidden = await browser.ask("document.getElementById('notice').hidden");
  demand(!hidden && (await browser.said()).scene === 'mannequin', 'the demo runs beside it');
  return links;
}

// Checks built-in characters, files of the picker, and a scene of the gallery.
async function chosen(browser, url, files) {
  await opened(browser, url);
  for (const sample of ['braids', 'cape', 'mannequin']) {
    await clicked(browser, `document.querySelector('[data-sample=${sample}]')`);
    await browser.until(sample, async () => { const { scene, steps } = await browser.said(); return scene === sample && steps > 20; });
    await browser.picture(`start-${sample}`);
  }
  for (const path of files) {
    const { root } = await browser.send('DOM.getDocument');
    const { nodeId } = await browser.send('DOM.querySelector', { nodeId: root.nodeId, selector: '#file' });
    await browser.send('DOM.setFileInputFiles', { nodeId, files: [path] });
    await browser.until(path, async () => { const { scene, steps } = await browser.said(); return scene === basename(path) && steps > 150; });
    await browser.picture(`start-${basename(path)}`);
  }
  await clicked(browser, "document.querySelector('a.scene')");
  const scene = await browser.ask("document.querySelector('a.scene').dataset.scene");
  await browser.until(scene, async () => { const said = await browser.said(); return said.scene === scene && said.steps > 5; });
}

// Checks names, alternative texts, contrast, and that the keyboard can leave the picture.
async function accessible(browser) {
  const nameless = await browser.ask(`[...document.querySelectorAll('a, button, input')].filter((it) =>
    !(it.innerText.trim() || it.ariaLabel || it.querySelector('img')?.alt)).map((it) => it.outerHTML)`);
  demand(nameless.length === 0, `without a name: ${nameless}`);
  const blind = await browser.ask("[...document.images].filter((it) => !(it.alt.length > 10)).map((it) => it.src)");
  demand(blind.length === 0, `without a description: ${blind}`);
  const faint = await browser.ask(`(() => {
    const light = (color) => {
      const parts = color.match(/[\\d.]+/g).map(Number);
      const [r, g, b] = parts.map((x) => { const s = x / 255; return s <= 0.04045 ? s / 12.92 : ((s + 0.055) / 1.055) ** 2.4; });
      return { value: 0.2126 * r + 0.7152 * g + 0.0722 * b, isSolid: (parts[3] ?? 1) > 0.6 };
    };
    const ground = (it) => {
      for (; it; it = it.parentElement) {
        const found = light(getComputedStyle(it).backgroundColor);
        if (found.isSolid) return found.value;
      }
      return 1;
    };
    const texts = [...document.querySelectorAll('main *, header *, footer *')].filter((it) =>
      it.checkVisibility() && [...it.childNodes].some((node) => node.nodeType === 3 && node.data.trim()));
    return texts.map((it) => {
      const style = getComputedStyle(it);
      const [a, b] = [light(it.closest('svg') ? style.fill : style.color).value, ground(it)];
      return [(Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05), it.textContent.trim().slice(0, 40)];
    }).filter(([contrast]) => contrast < ${CONTRAST});
  })()`);
  demand(faint.length === 0, `faint: ${JSON.stringify(faint)}`);
  await browser.ask(`${canvas}.focus()`);
  for (const type of ['keyDown', 'keyUp']) {
    await browser.send('Input.dispatchKeyEvent', { type, key: 'Tab', code: 'Tab', windowsVirtualKeyCode: 9 });
  }
  const held = await browser.ask(`document.activeElement === ${canvas}`);
  demand(!held, 'Tab does not leave the picture');
}

// With reduced motion the user starts it.
async function still(browser, url) {
  await browser.send('Emulation.setEmulatedMedia', { features: [{ name: 'prefers-reduced-motion', value: 'reduce' }] });
  await browser.send('Page.navigate', { url });
  const play = "document.getElementById('play')";
  await browser.until('a button to start', () => browser.ask(`${play} && !${play}.hidden`));
  demand(!(await browser.said()).ready, 'it moves by itself');
  await browser.picture('start-still');
  await clicked(browser, play);
  await browser.until('a start', async () => (await browser.said()).ready);
  await browser.send('Emulation.setEmulatedMedia', { features: [] });
}

// Tests the start page with one way to draw: all of it with the first way, the demo alone with others.
export async function startPage(browser, way, site, drop) {
  const url = `${site}?gpu=${way}`;
  const told = {};
  await browser.size(1280, 800);
  await opened(browser, url);
  const [paint] = await browser.ask("performance.getEntriesByName('first-contentful-paint').map((it) => it.startTime)");
  told.first_paint_ms = Math.round(paint);
  told.first_picture_ms = Number((await browser.said()).ready);
  if (way !== 'webgl2') {
    told.outermost = await watched(browser, `${way}-1280x800`, 1);
    return told;
  }
  told.outermost = {};
  for (const [width, height] of SIZES) {
    await browser.size(width, height, width < 500);
    await opened(browser, url);
    const name = `${width}x${height}`;
    told.outermost[name] = await watched(browser, name, width < 500 ? WATCHED_S : FALL_S);
    await accessible(browser);
  }
  await browser.size(390, 844, true);
  await pushed(browser, url);
  told.scenes = await wrongScene(browser, site, way);
  await chosen(browser, url, drop);
  await still(browser, url);
  await browser.size(390, 844, true);
  await browser.open(`${site}viewer.html?gpu=${way}&scene=stack`);
  await browser.until('steps', async () => (await browser.said()).steps > 30);
  await browser.picture('viewer-390x844');
  const { height } = await place(browser, canvas);
  demand(height > 500, `the viewer's picture is ${height} high on a phone`);
  await browser.size(1280, 800);
  return told;
}

// Draws the pictures of the start page: the first frame of the demo, and the scenes of the gallery.
export async function drawn(browser, site, gallery) {
  const shoot = async (name, address, width, height) => {
    await browser.size(width, height);
    await browser.open(`${site}viewer.html?gpu=webgl2&panels=none&${address}`);
    await browser.line('hash');
    await browser.ask("document.querySelector('.bar').style.display = 'none'");
    // The picture takes its final size in the next frames.
    await new Promise((done) => setTimeout(done, 1500));
    await browser.picture(name, await place(browser, canvas));
  };
  await shoot('poster', 'steps=24', 1280, 720);
  for (const [scene, steps] of gallery) await shoot(`gallery/${scene}`, `scene=${scene}&steps=${steps}`, 480, 270);
}
