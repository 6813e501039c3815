// Plays a scene in a worker, without an import map.
import { World, init } from '/sinew-physics/index.js';

await init();
const world = new World();
world.addBody({ kind: 'static', shape: { type: 'halfSpace' } });
const ball = world.addBody({ shape: { type: 'sphere', radius: 0.5 }, position: [0, 3, 0] });
world.step(120);
postMessage({ height: world.pose(ball).position.y });
