// The scenes of `examples/native.rs`, with the same calls in the same order.
import { CharacterDef, World } from 'sinew-physics';

const SHOVE = 120;

export function ground() {
  const world = new World();
  world.addBody({ kind: 'static', shape: { type: 'halfSpace' } });
  return world;
}

// Two copies of a character, one shoved after a second: the hash after ten seconds.
export function fall(def) {
  const world = ground();
  const both = [0, 1.5].map((x) => world.spawn(def, [x, 0, 0]));
  world.step(60);
  both[0].hit(def.bones[0], [0, 0, SHOVE]);
  world.step(540);
  const hash = world.hash();
  world.free();
  return hash;
}

// A wall of boxes, a thrown ball, a hanging chain.
export function boxes() {
  const world = ground();
  const cube = { type: 'box', halfExtents: [0.25, 0.25, 0.25] };
  for (let i = 0; i < 20; i++) {
    world.addBody({ shape: cube, position: [0.5 * (i % 5) - 1, 0.25 + 0.5 * Math.floor(i / 5), 0] });
  }
  world.addBody({ shape: { type: 'sphere', radius: 0.25 }, position: [0, 1, 4], linearVelocity: [0, 2, -8] });
  let above = world.addBody({ kind: 'static', shape: cube, position: [3, 3, 0] });
  for (let i = 1; i <= 5; i++) {
    const shape = { type: 'capsule', halfHeight: 0.1, radius: 0.05 };
    const link = world.addBody({ shape, position: [3 + 0.5 * i, 3, 0] });
    world.addJoint({ type: 'ball', a: above, b: link, anchor: [2.75 + 0.5 * i, 3, 0] });
    above = link;
  }
  world.step(600);
  const hash = world.hash();
  world.free();
  return hash;
}

// Milliseconds per step of a limp character, and of 30 walking and 10 falling ones, the best of several rounds; and of
// the first two falls.
export function times(def) {
  const limp = [];
  for (let round = 0; round < 9; round++) {
    const world = ground();
    const one = world.spawn(def);
    world.step(1);
    one.goLimp();
    const start = performance.now();
    for (let i = 0; i < 120; i++) world.step(1);
    limp.push((performance.now() - start) / 120);
    world.free();
  }
  const crowd = [];
  for (let round = 0; round < 5; round++) {
    const world = ground();
    const all = Array.from({ length: 40 }, (_, i) => world.spawn(def, [(i % 8) * 1.5, 0, Math.floor(i / 8) * 1.5]));
    world.step(10);
    all.forEach((one, i) => { if (i % 4 === 0) one.goLimp(); });
    const start = performance.now();
    for (let i = 0; i < 90; i++) world.step(1);
    crowd.push((performance.now() - start) / 90);
    world.free();
  }
  return { limp: Math.min(...limp), first: limp[0], second: limp[1], crowd: Math.min(...crowd) };
}

export function load(bytes, name) {
  return CharacterDef.load(bytes, { name });
}
