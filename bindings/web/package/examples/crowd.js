// Forty characters of one file, walking in circles; a ball rolls through them.
import * as THREE from 'three';
import { hero, stage } from './stage.js';

const { physics, scene, run } = await stage({ eye: [9, 7, 12], target: [0, 0, 0] });
const { gltf, bytes } = await hero();
const crowd = [];
for (let i = 0; i < 40; i++) {
  const angle = (2 * Math.PI * (i % 20)) / 20;
  const radius = i < 20 ? 4 : 6;
  const one = physics.character(gltf, bytes, { position: [radius * Math.cos(angle), 0, radius * Math.sin(angle)] });
  scene.add(one.object);
  crowd.push(one);
}
const ball = new THREE.Mesh(new THREE.SphereGeometry(0.6, 32, 16), new THREE.MeshStandardMaterial({ color: 'crimson' }));
ball.castShadow = true;
ball.position.set(-14, 0.6, 0);
scene.add(ball);
const rolling = physics.body(ball, { mass: 300 });
setInterval(() => rolling.teleport([-14, 0.6, 6 * Math.random() - 3]), 8000);
const text = document.getElementById('text');
run(() => {
  for (const one of crowd) {
    const { x, z } = one.core.place.position;
    const far = Math.hypot(x, z) || 1;
    one.move([(-1.1 * z) / far, 0, (1.1 * x) / far]);
  }
  if (ball.position.x < -13) physics.world.setVelocity(rolling.id, [6, 0, 0]);
  text.textContent = `${crowd.filter((one) => one.state === 'animated').length} of ${crowd.length} walk`;
});
