// A character walks, is pushed over a crate every six seconds, gets up and walks on; the camera follows.
import { crate, hero, stage } from './stage.js';

const { physics, scene, camera, controls, run } = await stage();
const { gltf, bytes } = await hero();
const walker = physics.character(gltf, bytes);
scene.add(walker.object);
for (let i = 0; i < 8; i++) {
  const box = crate(0.35);
  box.position.set((i % 2) - 0.5, 0.18, 1.5 + 1.2 * i);
  scene.add(box);
  physics.body(box, { mass: 8 });
}
const text = document.getElementById('text');
setInterval(() => walker.state === 'animated' && walker.hit('chest', [40, 0, 110]), 6000);
run(() => {
  // The camera keeps its position relative to the character.
  const moved = walker.position.clone().setY(0.8).sub(controls.target);
  controls.target.add(moved);
  camera.position.add(moved);
  text.textContent = `${walker.state}: drag its limbs with the mouse`;
});
