// Click to shoot: a ray finds the bone, and the bullet's impulse hits it. Characters flinch at the first shots and fall at hard ones.
import * as THREE from 'three';
import { crate, hero, stage } from './stage.js';

const { physics, scene, camera, renderer, drag, run } = await stage({ eye: [0, 1.6, 7] });
drag.enabled = false;
const { gltf, bytes } = await hero();
for (const x of [-2, 0, 2]) {
  const target = physics.character(gltf, bytes, { position: [x, 0, 0] });
  target.stand();
  scene.add(target.object);
}
for (let i = 0; i < 6; i++) {
  const box = crate(0.5);
  box.position.set(-3.2, 0.25 + 0.5 * i, -1);
  scene.add(box);
  physics.body(box);
}
const mark = new THREE.Mesh(new THREE.SphereGeometry(0.03), new THREE.MeshBasicMaterial({ color: 'yellow' }));
scene.add(mark);
const text = document.getElementById('text');
text.textContent = 'click to shoot';
const raycaster = new THREE.Raycaster();
renderer.domElement.addEventListener('pointerdown', (event) => {
  raycaster.setFromCamera(new THREE.Vector2((2 * event.clientX) / innerWidth - 1, 1 - (2 * event.clientY) / innerHeight), camera);
  const hit = physics.pick(raycaster);
  if (!hit) return;
  mark.position.copy(hit.point);
  const impulse = raycaster.ray.direction.clone().multiplyScalar(45);
  if (hit.character) hit.character.core.hitAt(hit.body, hit.point, impulse);
  else hit.object?.push(impulse, hit.point);
  text.textContent = hit.bone ?? 'a crate or the floor';
});
run();
