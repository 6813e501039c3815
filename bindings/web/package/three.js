// Sinew for three.js: physics that moves meshes, instances and the bones of any rigged model.
import { EventDispatcher, Vector3 } from 'three';
import { World, init } from './index.js';
import { SinewBody, SinewInstances } from './three/bodies.js';
import { SinewCharacter } from './three/character.js';
import { SinewDebug } from './three/debug.js';
import { SinewDrag } from './three/drag.js';
import { SinewGeometry } from './three/particles.js';

/** @import { Camera, InstancedMesh, Object3D, Ray, Raycaster } from 'three' */
/** @import { GLTF } from 'three/addons/loaders/GLTFLoader.js' */
/** @import { ClothOptions, GrabOptions, PhysicsEvent, QueryOptions, RopeOptions, SoftBallOptions, WorldOptions } from './index.js' */
/** @import { InitOptions } from './index.js' */
/** @import { ObjectBodyOptions } from './three/bodies.js' */
/** @import { SinewCharacterOptions } from './three/character.js' */

export { SinewBody, SinewCharacter, SinewDebug, SinewDrag, SinewGeometry, SinewInstances };

/** Longest frame, seconds: a page that was in the background continues from its last state. */
const LONGEST_FRAME = 0.25;
/** Length of a pick's ray, metres. */
const FAR = 1000;

/**
 * The hit of a ray.
 * @typedef {object} Picked
 * @property {bigint} body Id of the body.
 * @property {Vector3} point Position in the world.
 * @property {Vector3} normal Outward unit normal.
 * @property {number} distance Metres from the origin of the ray.
 * @property {SinewBody} [object] The body, if it moves an object.
 * @property {SinewCharacter} [character] The character to which the body belongs.
 * @property {string} [bone] Name of the character's body.
 * @property {SinewInstances} [instances] The bodies of instances to which the body belongs.
 * @property {number} [instance] Index of the instance.
 */

/**
 * Physics of a scene of three.js. Metres and seconds; +Y is up.
 *
 * Events are those of `PhysicsEvent`; `event.a` and `event.b` are ids, `event.targets` the objects to which the bodies belong.
 * @extends {EventDispatcher<Record<string, any>>}
 */
export class Sinew extends EventDispatcher {
  /** @type {Set<SinewBody>} */
  #bodies = new Set();
  /** @type {Set<SinewInstances>} */
  #instances = new Set();
  /** @type {Set<SinewCharacter>} */
  #characters = new Set();
  /** @type {Set<SinewGeometry>} */
  #geometries = new Set();
  /** @type {Set<SinewDrag>} */
  #drags = new Set();
  /** @type {Map<bigint, { object: SinewBody } | { instances: SinewInstances, instance: number }>} Objects to which bodies belong, except characters. */
  #owners = new Map();
  /** Types of events that have listeners. */
  #heard = /** @type {Set<string>} */ (new Set());
  /** @type {SinewDebug | undefined} */
  #debug;

  /**
   * Loads the program and makes a world.
   * @param {WorldOptions} [options]
   * @param {InitOptions} [load]
   */
  static async create(options, load) {
    await init(load);
    return new Sinew(options);
  }

  /**
   * Creates a world; `init` must be done.
   * @param {WorldOptions} [options]
   */
  constructor(options) {
    super();
    /** World of the bodies, with all its methods. */
    this.world = new World(options);
  }

  /**
   * Steps the physics and moves all objects to their poses. Call it once per frame.
   * @param {number} seconds Time since the last frame.
   */
  update(seconds) {
    this.world.update(Math.min(Math.max(seconds, 0), LONGEST_FRAME));
    this.#tell();
    const { poses } = this.world;
    for (const body of this.#bodies) body.write(poses);
    for (const instances of this.#instances) instances.write(poses);
    for (const character of this.#characters) character.write();
    for (const geometry of this.#geometries) geometry.write();
    this.#debug?.update();
  }

  /**
   * @template {string} T
   * @param {T} type
   * @param {(event: any) => void} listener
   */
  addEventListener(type, listener) {
    this.#heard.add(type);
    super.addEventListener(type, listener);
  }

  #tell() {
    const events = this.world.events();
    if (events.length === 0) return;
    /** @type {Map<number, SinewCharacter>} */
    const characters = new Map();
    for (const character of this.#characters) characters.set(character.core.index, character);
    for (const event of events) {
      if ('character' in event) {
        const { character: index, ...rest } = event;
        const character = characters.get(index);
        character?.dispatchEvent({ ...rest });
        if (this.#heard.has(event.type)) this.dispatchEvent({ ...rest, character });
      } else if (this.#heard.has(event.type)) {
        this.dispatchEvent({ ...event, targets: 'a' in event ? [this.owner(event.a), this.owner(event.b)] : [] });
      }
    }
  }

  /**
   * Returns the object or character to which a body belongs.
   * @param {bigint} body
   * @returns {{ object?: SinewBody, character?: SinewCharacter, bone?: string, instances?: SinewInstances, instance?: number }}
   */
  owner(body) {
    const known = this.#owners.get(body);
    if (known) return known;
    for (const character of this.#characters) {
      const bone = character.core.bone(body);
      if (bone !== undefined) return { character, bone };
    }
    return {};
  }

  /**
   * Adds a character that moves a model loaded by three's loader. The ragdoll is built from the file's `bytes`, once for all characters of
   * one `gltf`. The first character moves `gltf.scene`, each further one a copy: add its `object` to your scene.
   * @param {GLTF} gltf
   * @param {ArrayBuffer | Uint8Array} bytes
   * @param {SinewCharacterOptions} [options]
   */
  character(gltf, bytes, options = {}) {
    const character = new SinewCharacter(this.world, gltf, bytes, options);
    this.#keep(this.#characters, character);
    character.write();
    return character;
  }

  /**
   * Adds a body that moves a mesh or an object of meshes, starting at the object's pose.
   * @param {Object3D} object
   * @param {ObjectBodyOptions} [options]
   */
  body(object, options = {}) {
    const body = new SinewBody(this.world, object, options);
    this.#keep(this.#bodies, body);
    this.#owners.set(body.id, { object: body });
    return body;
  }

  /**
   * Adds a static body for an object, such as a wall or a level, with the shapes of its meshes.
   * @param {Object3D} object
   * @param {Omit<ObjectBodyOptions, 'kind'>} [options]
   */
  collider(object, options = {}) {
    return this.body(object, { ...options, kind: 'static' });
  }

  /**
   * Adds a body for each instance of a mesh, which moves the instance.
   * @param {InstancedMesh} object
   * @param {ObjectBodyOptions} [options]
   */
  instances(object, options = {}) {
    const instances = new SinewInstances(this.world, object, options);
    this.#keep(this.#instances, instances);
    instances.ids.forEach((id, instance) => this.#owners.set(id, { instances, instance }));
    return instances;
  }

  /**
   * Adds an infinite level ground, and returns the id of its body.
   * @param {number} [height] Metres.
   */
  ground(height = 0) {
    return this.world.addBody({ kind: 'static', position: [0, height, 0], shape: { type: 'halfSpace' } });
  }

  /**
   * Adds terrain: heights of a grid, row after row along x, around its origin; returns the id of its body.
   * @param {{ columns: number, rows: number, spacing: number, heights: ArrayLike<number> }} field
   * @param {Vector3} [position]
   */
  heightField(field, position = new Vector3()) {
    return this.world.addBody({ kind: 'static', position, shape: { type: 'heightField', ...field } });
  }

  /**
   * Adds cloth, and returns the geometry of a mesh for it.
   * @param {ClothOptions} options
   */
  cloth(options) {
    return this.#geometry(new SinewGeometry(this.world.addCloth(options)));
  }

  /**
   * Adds a soft ball, and returns the geometry of a mesh for it.
   * @param {SoftBallOptions} options
   */
  softBall(options) {
    return this.#geometry(new SinewGeometry(this.world.addSoftBall(options)));
  }

  /**
   * Adds a rope, and returns the geometry of a line for it.
   * @param {RopeOptions} options
   */
  rope(options) {
    return this.#geometry(new SinewGeometry(this.world.addRope(options)));
  }

  /** @param {SinewGeometry} geometry */
  #geometry(geometry) {
    this.#keep(this.#geometries, geometry);
    return geometry;
  }

  /**
   * Returns the first body on a ray, for example of a raycaster set from the pointer.
   * @param {Ray | Raycaster} ray
   * @param {QueryOptions & { far?: number }} [options] `far`: metres, 1000 by default.
   * @returns {Picked | undefined}
   */
  pick(ray, { far = FAR, ...options } = {}) {
    const { origin, direction } = 'ray' in ray ? ray.ray : ray;
    const hit = this.world.castRay(origin, direction.clone().setLength(far), options);
    if (!hit) return undefined;
    return {
      body: hit.body,
      point: new Vector3().copy(hit.point),
      normal: new Vector3().copy(hit.normal),
      distance: hit.fraction * far,
      ...this.owner(hit.body),
    };
  }

  /**
   * Lets the pointer drag bodies and limbs.
   * @param {Camera} camera
   * @param {HTMLElement} element The canvas.
   * @param {GrabOptions} [options]
   */
  drag(camera, element, options = {}) {
    const drag = new SinewDrag(this, camera, element, options);
    this.#keep(this.#drags, drag);
    return drag;
  }

  /** Shapes, joints and contacts as lines: add them to your scene. */
  get debug() {
    this.#debug ??= new SinewDebug(this.world);
    return this.#debug;
  }

  /**
   * Removes an object from this world, and frees it.
   * @param {SinewBody | SinewInstances | SinewCharacter | SinewGeometry | SinewDrag} member
   */
  remove(member) {
    member.dispose();
  }

  /**
   * Keeps an object until it is removed from this world or disposes itself; afterwards both do nothing.
   * @param {Set<any>} set
   * @param {SinewBody | SinewInstances | SinewCharacter | SinewGeometry | SinewDrag} member
   */
  #keep(set, member) {
    set.add(member);
    const free = member.dispose.bind(member);
    member.dispose = () => {
      if (!set.delete(member)) return;
      if (member instanceof SinewBody) this.#owners.delete(member.id);
      if (member instanceof SinewInstances) member.ids.forEach((id) => this.#owners.delete(id));
      free();
    };
  }

  /** Frees the world with all its objects; models and meshes stay in place. */
  dispose() {
    for (const set of [this.#drags, this.#characters, this.#bodies, this.#instances, this.#geometries]) {
      for (const member of /** @type {Set<any>} */ (set)) this.remove(member);
    }
    this.#debug?.dispose();
    this.#debug = undefined;
    this.world.free();
  }
}
