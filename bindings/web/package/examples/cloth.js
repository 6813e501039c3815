// A curtain that a character walks through, a sheet that falls on a sphere, a rope with a ball on it.
import * as THREE from 'three';
import { hero, stage } from './stage.js';

const { physics, scene, run } = await stage({ eye: [3.5, 1.8, 4], target: [0, 1, 1] });
const { gltf, bytes } = await hero();
const walker = physics.character(gltf, bytes, { position: [0, 0, -1] });
scene.add(walker.object);

function surface(geometry, color) {
  const mesh = new THREE.Mesh(geometry, new THREE.MeshStandardMaterial({ color, side: THREE.DoubleSide }));
  mesh.frustumCulled = false;
  mesh.castShadow = true;
  scene.add(mesh);
}
surface(physics.cloth({ corner: [-0.8, 2.1, 1], across: [1.6, 0, 0], down: [0, -1.9, 0], hang: 'firstRow' }), 'indianred');

const ball = new THREE.Mesh(new THREE.SphereGeometry(0.35, 32, 16), new THREE.MeshStandardMaterial({ color: 'steelblue' }));
ball.position.set(-1.6, 0.6, 0.5);
scene.add(ball);
physics.collider(ball);
surface(physics.cloth({ corner: [-2.3, 1.4, -0.2], across: [1.4, 0, 0], down: [0, 0, 1.4] }), 'khaki');
surface(physics.softBall({ center: [1.5, 2, 0.5], radius: 0.3 }), 'mediumseagreen');

const weight = new THREE.Mesh(new THREE.SphereGeometry(0.12), new THREE.MeshStandardMaterial({ color: 'black' }));
weight.position.set(2.4, 2.2, 1);
scene.add(weight);
const bob = physics.body(weight, { mass: 2 });
const rope = new THREE.Line(physics.rope({ from: [1.4, 2.2, 1], to: [2.4, 2.2, 1], holdFrom: 'world', holdTo: bob.id }), new THREE.LineBasicMaterial({ color: 'black' }));
rope.frustumCulled = false;
scene.add(rope);
// Back and forth, so that it passes through the curtain repeatedly.
let way = 1;
run(() => {
  const { z } = walker.core.place.position;
  if (z > 2.5) way = -1;
  if (z < -1) way = 1;
  if (walker.state === 'animated') walker.move([0, 0, 1.1 * way]);
});
