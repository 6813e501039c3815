// Shared by the examples: a renderer, a lit scene with a floor, a camera, and the loop.
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { mannequinGlb } from 'sinew-physics';
import { Sinew } from 'sinew-physics/three';

export async function stage({ eye = [4, 2.2, 5], target = [0, 0.8, 0] } = {}) {
  const physics = await Sinew.create();
  const renderer = new THREE.WebGLRenderer({ antialias: true });
  renderer.shadowMap.enabled = true;
  document.body.append(renderer.domElement);
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0xb8c4d0);
  const sun = new THREE.DirectionalLight('white', 2);
  sun.position.set(4, 8, 3);
  sun.castShadow = true;
  sun.shadow.mapSize.set(2048, 2048);
  Object.assign(sun.shadow.camera, { left: -12, right: 12, top: 12, bottom: -12 });
  const floor = new THREE.Mesh(new THREE.PlaneGeometry(60, 60).rotateX(-Math.PI / 2), new THREE.MeshStandardMaterial({ color: 0x8d9aa5 }));
  floor.receiveShadow = true;
  // Lines that make motion over the floor visible.
  const lines = new THREE.GridHelper(60, 60, 0x748391, 0x7f8e9a);
  lines.position.y = 0.002;
  scene.add(new THREE.HemisphereLight(0xddeeff, 0x886644, 1.5), sun, floor, lines);
  physics.ground();
  const camera = new THREE.PerspectiveCamera(45, 1, 0.1, 200);
  camera.position.set(...eye);
  const drag = physics.drag(camera, renderer.domElement);
  const controls = new OrbitControls(camera, renderer.domElement);
  controls.target.set(...target);
  const resize = () => {
    renderer.setSize(innerWidth, innerHeight);
    camera.aspect = innerWidth / innerHeight;
    camera.updateProjectionMatrix();
  };
  addEventListener('resize', resize);
  resize();
  const run = (each = () => {}) => {
    let last = performance.now();
    renderer.setAnimationLoop((now) => {
      physics.update((now - last) / 1000);
      last = now;
      each();
      controls.update();
      renderer.render(scene, camera);
      window.ready = true;
    });
  };
  return { physics, scene, camera, controls, renderer, drag, run };
}

// Loads the file of `?file=`, else the mannequin; returns its bytes, and the result of three's loader.
export async function hero() {
  const file = new URLSearchParams(location.search).get('file');
  const bytes = file ? new Uint8Array(await (await fetch(file)).arrayBuffer()) : mannequinGlb();
  const gltf = await new GLTFLoader().parseAsync(bytes.buffer, '');
  gltf.scene.traverse((part) => { part.castShadow = part.isMesh; });
  return { bytes, gltf };
}

export function crate(size, color = 0xb07a45) {
  const mesh = new THREE.Mesh(new THREE.BoxGeometry(size, size, size), new THREE.MeshStandardMaterial({ color }));
  mesh.castShadow = mesh.receiveShadow = true;
  return mesh;
}
