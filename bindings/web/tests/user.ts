// A user's program in TypeScript: compiled against the package's types, not run.
import { CharacterDef, World, init, type BodyOptions, type Hit, type PhysicsEvent } from 'sinew-physics';
import { Sinew, type SinewCharacter } from 'sinew-physics/three';
import { Mesh, PerspectiveCamera, Raycaster, Vector3 } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

await init();
const world = new World({ gravity: [0, -9.81, 0], quality: 'exact' });
const options: BodyOptions = { shape: { type: 'capsule', halfHeight: 0.5, radius: 0.2 }, position: new Vector3(0, 2, 0) };
const body: bigint = world.addBody(options);
const hit: Hit | undefined = world.castRay([0, 5, 0], [0, -10, 0], { kinds: ['dynamic'], except: [body] });
const heights: number[] = world.events().map((event: PhysicsEvent) => (event.type === 'hit' ? event.point.y : (hit?.point.y ?? 0)));
// @ts-expect-error: a shape has a type
world.addBody({ shape: { radius: 1 } });

const physics = await Sinew.create({ substeps: 8 });
const bytes = new Uint8Array(heights.length);
const gltf = await new GLTFLoader().parseAsync(bytes.buffer, '');
const hero: SinewCharacter = physics.character(gltf, bytes, { height: 1.8, position: { x: 1, y: 0, z: 0 } });
hero.setDrive('leftUpperArm', { muscle: 'relaxed', pin: { hertz: 2, maxForce: 100, maxTorque: 10 } }, { below: true });
hero.addEventListener('up', () => hero.play(hero.clips[0] ?? 'walk'));
const crate = physics.body(new Mesh(), { mass: 3, shape: 'hull' });
physics.drag(new PerspectiveCamera(), document.createElement('canvas'));
const picked = physics.pick(new Raycaster(), { far: 10 });
if (picked?.object === crate) crate.push([0, 1, 0], picked.point);
const def: CharacterDef = hero.def;
physics.world.spawn(def, [0, 0, 0], [0, 0, 0, 1]).free();
physics.dispose();
