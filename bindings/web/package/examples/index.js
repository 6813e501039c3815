// The front page: a character walks, is pushed over, gets up and walks on, in a loop; click to push it, drag to pull it, drop your own.
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { hero, stage } from './stage.js';

// Seconds between automatic pushes.
const EVERY = 7;
// Impulse per mass, N·s/kg: 1.6 m/s for the whole character.
const PUSH = 1.6;

const say = (text) => { document.getElementById('state').textContent = text; };
const bar = document.getElementById('bar');
bar.style.width = '30%';
const { physics, scene, camera, controls, renderer, run } = await stage({ eye: [2.2, 1.5, 3.6] });
bar.style.width = '80%';

let walker;
let since = 0;
let follows = true;

function show({ gltf, bytes, name = 'the mannequin' }) {
  const next = physics.character(gltf, bytes, { name });
  if (walker) physics.remove(walker);
  walker = next;
  scene.add(walker.object);
  since = EVERY - 2;
  console.log(walker.notes.join('\n'));
}

function push() {
  // Direction away from the camera and forward.
  const way = camera.getWorldDirection(new THREE.Vector3()).setY(0).normalize().multiplyScalar(PUSH * walker.mass);
  walker.hit(walker.bones.includes('chest') ? 'chest' : walker.bones[0], way);
  since = 0;
}

const balls = [];
function toss() {
  const ball = new THREE.Mesh(new THREE.SphereGeometry(0.16, 32, 16), new THREE.MeshStandardMaterial({ color: 'crimson' }));
  ball.castShadow = true;
  ball.position.copy(camera.position).lerp(walker.position, 0.3);
  scene.add(ball);
  const body = physics.body(ball, { mass: 8 });
  const aim = walker.position.clone().sub(ball.position).normalize().multiplyScalar(14);
  physics.world.setVelocity(body.id, aim.add(new THREE.Vector3(0, 1.5, 0)));
  balls.push(body);
  if (balls.length > 12) {
    const old = balls.shift();
    old.object.removeFromParent();
    physics.remove(old);
  }
}

async function take(file) {
  say(`reading ${file.name}…`);
  try {
    const bytes = new Uint8Array(await file.arrayBuffer());
    const gltf = await new GLTFLoader().parseAsync(bytes.buffer.slice(0), '');
    gltf.scene.traverse((part) => { part.castShadow = part.isMesh; });
    show({ gltf, bytes, name: file.name });
  } catch (error) {
    say(error.message);
    since = -10;
  }
}

show(await hero());
bar.remove();
document.getElementById('push').onclick = push;
document.getElementById('throw').onclick = toss;
document.getElementById('follow').onclick = ({ target }) => {
  follows = !follows;
  target.setAttribute('aria-pressed', String(follows));
};
document.getElementById('file').onchange = ({ target }) => target.files[0] && take(target.files[0]);
addEventListener('keydown', (event) => event.code === 'Space' && event.target === document.body && push());
for (const type of ['dragover', 'dragleave', 'drop']) {
  addEventListener(type, (event) => {
    event.preventDefault();
    document.body.classList.toggle('over', type === 'dragover');
    if (type === 'drop' && event.dataTransfer.files[0]) take(event.dataTransfer.files[0]);
  });
}
// A click without a drag pushes the object under the pointer.
let down = [0, 0];
const raycaster = new THREE.Raycaster();
addEventListener('pointerdown', (event) => { down = [event.clientX, event.clientY]; }, { capture: true });
renderer.domElement.addEventListener('click', (event) => {
  if (Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4) return;
  raycaster.setFromCamera(new THREE.Vector2((2 * event.clientX) / innerWidth - 1, 1 - (2 * event.clientY) / innerHeight), camera);
  const hit = physics.pick(raycaster);
  const impulse = raycaster.ray.direction.clone().multiplyScalar(PUSH * walker.mass);
  if (hit?.character) hit.character.core.hitAt(hit.body, hit.point, impulse);
});

const still = matchMedia('(prefers-reduced-motion: reduce)').matches;
const WORDS = {
  animated: 'It walks. Click to push it, drag its limbs.',
  flinching: 'It keeps its feet.',
  powered: 'It keeps its feet.',
  limp: 'It falls: every bone is a body, every joint has its limits.',
  preparing: 'It turns over to get up.',
  gettingUp: 'It gets up.',
};
const clock = new THREE.Timer();
run(() => {
  since += clock.update().getDelta();
  if (!still && walker.state === 'animated' && since > EVERY) push();
  if (since >= 0) say(WORDS[walker.state]);
  if (!follows) return;
  // The camera keeps its position relative to the character; characters of any size are fully visible.
  const goal = walker.position.clone().setY(Math.max(0.35, 0.45 * walker.height));
  const moved = goal.sub(controls.target).multiplyScalar(0.12);
  controls.target.add(moved);
  camera.position.add(moved.setY(0));
});
