// Functions that `check.mjs` calls in the page.
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { VRMLoaderPlugin } from '@pixiv/three-vrm';
import { init, mannequinGlb, memoryBytes } from 'sinew-physics';
import { Sinew } from 'sinew-physics/three';
import { withBraid } from './braid.mjs';
import { boxes, fall, load, times } from './scenes.mjs';

const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true });
renderer.setSize(960, 600);
document.body.append(renderer.domElement);
const loader = new GLTFLoader();
loader.register((parser) => new VRMLoaderPlugin(parser));

async function bytesOf(name) {
  if (name === 'mannequin') return mannequinGlb();
  return new Uint8Array(await (await fetch(`rigs/${name}`)).arrayBuffer());
}

async function gltfOf(bytes) {
  return loader.parseAsync(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength), '');
}

function stage() {
  const scene = new THREE.Scene().add(new THREE.HemisphereLight('white', 'gray', 3), new THREE.GridHelper(20, 20));
  scene.background = new THREE.Color(0x99aabb);
  const camera = new THREE.PerspectiveCamera(45, 1.6, 0.1, 100);
  camera.position.set(2.5, 1.6, 3.5);
  camera.lookAt(0, 0.8, 0);
  camera.updateMatrixWorld();
  return { scene, camera };
}

const FRAME = 1 / 60 + 1e-9;

export const tests = {
  async hashes(names) {
    await init();
    const found = { boxes: boxes() };
    for (const name of names) found[name] = fall(load(await bytesOf(name), name));
    return found;
  },

  worker() {
    const worker = new Worker('worker.mjs', { type: 'module' });
    return new Promise((done, failed) => {
      worker.onmessage = ({ data }) => done(data);
      worker.onerror = (event) => failed(new Error(event.message));
    });
  },

  // A rig falls over a crate and is drawn.
  async falls(name) {
    const physics = await Sinew.create();
    const { scene, camera } = stage();
    const bytes = await bytesOf(name);
    const hero = physics.character(await gltfOf(bytes), bytes, { name });
    scene.add(hero.object);
    physics.ground();
    const crate = new THREE.Mesh(new THREE.BoxGeometry(1, 0.3, 0.5), new THREE.MeshStandardMaterial({ color: 'peru' }));
    crate.position.set(0, 0.15, 0.8);
    scene.add(crate);
    physics.body(crate);
    const heard = [];
    for (const type of ['limp', 'landed', 'settled', 'up']) hero.addEventListener(type, () => heard.push(type));
    const bound = hero.joints.filter(Boolean).length;
    for (let i = 0; i < 30; i++) physics.update(FRAME);
    const before = hero.position.clone();
    hero.hit(hero.bones[0], { x: 0, y: 0, z: 120 });
    for (let i = 0; i < 90; i++) physics.update(FRAME);
    camera.lookAt(hero.position);
    renderer.render(scene, camera);
    const told = { bound, joints: hero.joints.length, fell: before.y - hero.position.y, heard, state: hero.state, notes: hero.notes };
    physics.dispose();
    return told;
  },

  // A scene at rest until the test uses the mouse.
  async stand(name) {
    const physics = await Sinew.create();
    const { scene, camera } = stage();
    const bytes = await bytesOf(name);
    const hero = physics.character(await gltfOf(bytes), bytes, { name });
    hero.stand();
    scene.add(hero.object, physics.debug);
    physics.ground();
    const drag = physics.drag(camera, renderer.domElement);
    Object.assign(window, { physics, hero, drag });
    renderer.setAnimationLoop(() => {
      physics.update(FRAME);
      renderer.render(scene, camera);
    });
    const bone = new THREE.Vector3().copy(physics.world.pose(hero.core.body('chest')).position).project(camera);
    return [480 * (1 + bone.x), 300 * (1 - bone.y)];
  },

  // The hair of a VRM swings while the character is moved back and forth; three-vrm moves only the face.
  async hair() {
    const physics = await Sinew.create();
    const { scene, camera } = stage();
    const bytes = withBraid(mannequinGlb());
    const gltf = await gltfOf(bytes);
    const hero = physics.character(gltf, bytes, { name: 'braid.vrm' });
    hero.stand();
    scene.add(hero.object);
    physics.ground();
    const swinging = Array.from(hero.def.springJoints, (joint) => hero.joints[joint]);
    for (const joint of swinging) {
      joint.add(new THREE.Mesh(new THREE.CapsuleGeometry(0.02, 0.07).rotateX(Math.PI / 2), new THREE.MeshStandardMaterial({ color: 'crimson' })));
    }
    let before = swinging.map((joint) => joint.quaternion.clone());
    let swing = 0;
    for (let i = 0; i < 120; i++) {
      hero.teleport([0.3 * Math.sin(i / 5), 0, 0]);
      physics.update(FRAME);
      gltf.userData.vrm?.update(FRAME);
      if (i % 10 !== 0) continue;
      swinging.forEach((joint, k) => { swing = Math.max(swing, joint.quaternion.angleTo(before[k])); });
      before = swinging.map((joint) => joint.quaternion.clone());
    }
    camera.position.set(-1.2, 1.7, -1.2);
    camera.lookAt(0, 1.5, 0);
    renderer.render(scene, camera);
    const isSound = hero.joints.every((joint) => !joint || joint.quaternion.toArray().every(Number.isFinite));
    physics.dispose();
    return { chains: hero.def.springs, swing, isSound, vrm: Boolean(gltf.userData.vrm) };
  },

  // Adds and removes characters, bodies, instances and cloth; returns the bytes of the program's memory and of the
  // page's heap after each round.
  async memory(rounds, each) {
    const physics = await Sinew.create();
    const { scene } = stage();
    const bytes = await bytesOf('mannequin');
    const gltf = await gltfOf(bytes);
    physics.ground();
    const [taken, heap] = [[], []];
    const box = new THREE.BoxGeometry(0.3, 0.3, 0.3);
    for (let round = 0; round < rounds; round++) {
      for (let i = 0; i < each; i++) {
        const hero = physics.character(gltf, bytes);
        const two = physics.character(gltf, bytes, { position: [1, 0, 0] });
        const crate = physics.body(new THREE.Mesh(box), { mass: 5 });
        const many = physics.instances(Object.assign(new THREE.InstancedMesh(box, undefined, 3)), { mass: 1 });
        const cloth = physics.cloth({ corner: [0, 3, 0], across: [1, 0, 0], down: [0, 0, 1] });
        scene.add(hero.object, two.object);
        hero.goLimp();
        for (let k = 0; k < 10; k++) physics.update(FRAME);
        for (const member of [hero, two, crate, many, cloth]) {
          // Both ways do the same, once.
          if (round % 2) member.dispose();
          physics.remove(member);
        }
        physics.update(FRAME);
      }
      globalThis.gc?.();
      taken.push(memoryBytes());
      heap.push(performance.memory?.usedJSHeapSize ?? 0);
    }
    const left = { bodies: physics.world.bodies().length, objects: scene.children.length };
    physics.dispose();
    return { taken, heap, left };
  },

  // Tests the rest of the adapter: colliders, height fields, rays, joints, ropes, soft balls, snapshots, a rotated parent.
  async rest() {
    const physics = await Sinew.create({ gravity: [0, -9.81, 0] });
    const { scene, camera } = stage();
    const told = {};
    const ramp = new THREE.Mesh(new THREE.BoxGeometry(2, 0.1, 4), new THREE.MeshStandardMaterial({ color: 'gray' }));
    ramp.rotation.x = 0.4;
    ramp.position.set(-1.5, 0.8, 0);
    const knot = new THREE.Mesh(new THREE.TorusKnotGeometry(0.4, 0.12), new THREE.MeshStandardMaterial({ color: 'teal' }));
    knot.position.set(1.2, 0.6, -1);
    const turned = new THREE.Group();
    turned.rotation.y = 1;
    turned.position.set(0.3, 0, 0.2);
    const ball = new THREE.Mesh(new THREE.SphereGeometry(0.2), new THREE.MeshStandardMaterial({ color: 'crimson' }));
    ball.position.set(0, 2, 0);
    turned.add(ball);
    const many = new THREE.InstancedMesh(new THREE.CylinderGeometry(0.15, 0.15, 0.3), new THREE.MeshStandardMaterial({ color: 'gold' }), 12);
    for (let i = 0; i < 12; i++) many.setMatrixAt(i, new THREE.Matrix4().makeTranslation(-1.5 + 0.1 * (i % 3), 2 + 0.4 * i, -0.5));
    scene.add(ramp, knot, turned, many);
    physics.collider(ramp);
    physics.collider(knot);
    const rolled = physics.body(ball, { restitution: 0.5 });
    physics.instances(many);
    physics.heightField({ columns: 3, rows: 3, spacing: 20, heights: [0, 0, 0, 0, 0, 0, 0, 0, 0] });
    const sheet = physics.cloth({ corner: [0.7, 2, -1.5], across: [1, 0, 0], down: [0, 0, 1] });
    const rope = physics.rope({ from: [2, 2, 0], to: [3, 2, 0], holdFrom: 'world' });
    const soft = physics.softBall({ center: [-0.3, 2.5, 1], radius: 0.3 });
    const cloth = new THREE.Mesh(sheet, new THREE.MeshStandardMaterial({ color: 'white', side: THREE.DoubleSide }));
    const line = new THREE.Line(rope, new THREE.LineBasicMaterial({ color: 'black' }));
    const blob = new THREE.Mesh(soft, new THREE.MeshStandardMaterial({ color: 'violet' }));
    for (const drawn of [cloth, line, blob]) drawn.frustumCulled = false;
    scene.add(cloth, line, blob);
    let begins = 0;
    physics.addEventListener('begin', (event) => { begins += event.targets.some((target) => target.object === rolled) ? 1 : 0; });
    for (let i = 0; i < 120; i++) physics.update(FRAME);
    told.begins = begins;
    const at = ball.getWorldPosition(new THREE.Vector3());
    const pose = physics.world.pose(rolled.id).position;
    told.apart = at.distanceTo(new THREE.Vector3().copy(pose));
    const picked = physics.pick(new THREE.Ray(new THREE.Vector3(at.x, 5, at.z), new THREE.Vector3(0, -1, 0)));
    told.picked = picked?.object === rolled;
    const state = physics.world.save();
    const hash = physics.world.hash();
    physics.world.step(10);
    physics.world.load(state);
    told.back = physics.world.hash() === hash;
    physics.update(FRAME);
    renderer.render(scene, camera);
    physics.dispose();
    return told;
  },

  async times(name) {
    await init();
    const bytes = await bytesOf(name);
    const start = performance.now();
    const def = load(bytes, name);
    const loaded = performance.now() - start;
    const physics = await Sinew.create();
    const gltf = await gltfOf(bytes);
    physics.character(gltf, bytes, { name });
    const second = performance.now();
    physics.character(gltf, bytes, { name });
    const copied = performance.now() - second;
    const spawning = performance.now();
    physics.world.spawn(def);
    const spawned = performance.now() - spawning;
    physics.dispose();
    return { loaded, copied, spawned, ...times(def) };
  },

  async started(warm) {
    const start = performance.now();
    await init({ warm });
    return performance.now() - start;
  },
};
window.tests = tests;
