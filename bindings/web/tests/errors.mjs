// Wrong calls throw an `Error` with a message, and change nothing. Run in Node, in the folder where the package is installed.
import assert from 'node:assert/strict';
import { CharacterDef, World, init, mannequinGlb } from 'sinew-physics';

assert.throws(() => new World(), /call `init` and wait for it/);
assert.throws(() => mannequinGlb(), /call `init` and wait for it/);
await init({ warm: false });
const world = new World();
const ground = world.addBody({ kind: 'static', shape: { type: 'halfSpace' } });
const box = world.addBody({ shape: { type: 'box', halfExtents: [0.5, 0.5, 0.5] }, position: [0, 2, 0] });
const def = CharacterDef.load(mannequinGlb());
const hero = world.spawn(def, [3, 0, 0]);
const gone = world.addBody({ shape: { type: 'sphere', radius: 0.1 } });
world.removeBody(gone);
const hash = world.hash();

const WRONG = [
  [/no field 'shpe'/, () => world.addBody({ shpe: 1 })],
  [/one of box, sphere/, () => world.addBody({ shape: { type: 'bax' } })],
  [/halfExtents\.z must be a finite number, not NaN/, () => world.addBody({ shape: { type: 'box', halfExtents: [1, 2, NaN] } })],
  [/positive, finite mass/, () => world.addBody({})],
  [/half-spaces are static/, () => world.addBody({ shape: { type: 'halfSpace' } })],
  [/radius must be positive/, () => world.addBody({ shape: { type: 'sphere', radius: -1 } })],
  [/hull/, () => world.addBody({ shape: { type: 'hull', points: [0, 0, 0, 1, 0, 0] } })],
  [/no body \d+ in this world/, () => world.pose(gone)],
  [/two bodies/, () => world.addJoint({ type: 'ball', a: box, b: box, anchor: [0, 0, 0] })],
  [/axis must not be 0/, () => world.addJoint({ type: 'hinge', a: ground, b: box, anchor: [0, 0, 0], axis: [0, 0, 0] })],
  [/finite and not negative/, () => world.update(-1)],
  [/whole and not negative, not -1/, () => world.step(-1)],
  [/whole and not negative, not 0\.5/, () => world.step(0.5)],
  [/character/, () => world.removeBody(hero.bodies()[0])],
  [/no body is called 'tail'; there are hips/, () => hero.hit('tail', [0, 0, 1])],
  [/no clip is called 'fly'; there are walk/, () => hero.play('fly')],
  [/a preset is animated/, () => hero.setPreset('asleep')],
  [/a muscle is relaxed/, () => hero.setDrive('head', { muscle: 'tense' })],
  [/state of this world/, () => world.load(new Uint8Array([1, 2, 3]))],
  [/not a glTF file/, () => CharacterDef.load(new Uint8Array([1, 2, 3]))],
  [/hero\.glb/, () => CharacterDef.load(mannequinGlb().subarray(0, 5000), { name: 'hero.glb' })],
  [/no clip is called 'fly'/, () => CharacterDef.load(mannequinGlb(), { looped: 'fly' })],
];
for (const [message, call] of WRONG) assert.throws(call, (error) => error instanceof Error && message.test(error.message), String(message));
assert.equal(world.hash(), hash, 'nothing has changed');
world.step(60);
const state = world.save();
world.step(30);
const later = world.hash();
world.load(state);
world.step(30);
assert.equal(world.hash(), later, 'a state leads to the same');
hero.remove();
assert.throws(() => hero.hit('chest', [0, 0, 1]), /was removed/);
assert.throws(() => world.load(state), /other characters/);
world.free();
console.log(`${WRONG.length} wrong calls are errors with a sentence`);
