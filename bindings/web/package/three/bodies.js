// Bodies that move three's objects.
import { EventDispatcher, Matrix4, Quaternion, Vector3 } from 'three';
import { shapesOf, worldPose } from './shapes.js';

/** @import { InstancedMesh, Object3D } from 'three' */
/** @import { BodyKind, BodyOptions, ShapeOptions, Vec3Like, World } from '../index.js' */
/** @import { FittedShape } from './shapes.js' */

/** Count of numbers per index in the world's list of poses. */
const POSE = 7;
const ONE = new Vector3(1, 1, 1);
const position = new Vector3();
const rotation = new Quaternion();
const scale = new Vector3();
const matrix = new Matrix4();
const parentFromWorld = new Matrix4();

/**
 * A body's options; its pose is the object's, and its shape is taken from the object unless it is given.
 * @typedef {Omit<BodyOptions, 'shape' | 'shapes' | 'position' | 'rotation'> & { shape?: FittedShape | ShapeOptions | ShapeOptions[] }} ObjectBodyOptions
 */

/**
 * @param {Object3D} object
 * @param {ObjectBodyOptions} options
 * @returns {BodyOptions}
 */
function bodyOptions(object, { shape = 'auto', ...rest }) {
  const { position, rotation } = worldPose(object);
  const kind = rest.kind ?? 'dynamic';
  if (typeof shape === 'string') return { ...rest, kind, position, rotation, shapes: shapesOf(object, shape, kind !== 'dynamic') };
  return { ...rest, kind, position, rotation, shapes: Array.isArray(shape) ? shape : [shape] };
}

/**
 * A body that moves an object of three.
 * @extends {EventDispatcher<Record<string, any>>}
 */
export class SinewBody extends EventDispatcher {
  /** @type {number | undefined} */
  #place;

  /**
   * @param {World} world
   * @param {Object3D} object
   * @param {ObjectBodyOptions} options
   */
  constructor(world, object, options) {
    super();
    this.world = world;
    this.object = object;
    /** Id of the body in `world`. */
    this.id = world.addBody(bodyOptions(object, options));
    /** @type {BodyKind} */
    this.kind = options.kind ?? 'dynamic';
    if (this.kind !== 'static') this.#place = world.track(this.id);
  }

  /**
   * Moves the object to the body's pose.
   * @param {Float32Array} poses
   */
  write(poses) {
    if (this.#place === undefined) return;
    const at = POSE * this.#place;
    position.fromArray(poses, at);
    rotation.fromArray(poses, at + 3);
    place(this.object, position, rotation);
  }

  /**
   * Pushes the body with an impulse, N·s, at a point in the world, else at its centre of mass.
   * @param {Vec3Like} impulse
   * @param {Vec3Like} [point]
   */
  push(impulse, point) {
    this.world.applyImpulse(this.id, impulse, point);
  }

  /**
   * Teleports body and object.
   * @param {Vec3Like} to
   * @param {Quaternion} [turn]
   */
  teleport(to, turn) {
    this.world.setPose(this.id, to, turn);
    const pose = this.world.pose(this.id);
    place(this.object, position.copy(pose.position), rotation.copy(/** @type {Quaternion} */ (pose.rotation)));
  }

  /** Removes the body from the world; the object stays in place. */
  dispose() {
    if (this.#place !== undefined) this.world.untrack(this.#place);
    if (this.world.hasBody(this.id)) this.world.removeBody(this.id);
    this.#place = undefined;
  }
}

/**
 * Sets an object's world pose, for any parents.
 * @param {Object3D} object
 * @param {Vector3} at
 * @param {Quaternion} turn
 */
function place(object, at, turn) {
  const { parent } = object;
  if (parent && parent.parent) {
    parent.updateWorldMatrix(true, false);
    parentFromWorld.copy(parent.matrixWorld).invert();
    matrix.compose(at, turn, ONE).premultiply(parentFromWorld).decompose(object.position, object.quaternion, scale);
  } else {
    object.position.copy(at);
    object.quaternion.copy(turn);
  }
}

/** Bodies that move the instances of a mesh, one per instance. */
export class SinewInstances {
  /** @type {number[]} */
  #places = [];
  /** @type {Vector3[]} */
  #scales = [];

  /**
   * @param {World} world
   * @param {InstancedMesh} object
   * @param {ObjectBodyOptions} options
   */
  constructor(world, object, options) {
    this.world = world;
    this.object = object;
    /** @type {bigint[]} Ids of the bodies in `world`, in the order of the instances. */
    this.ids = [];
    object.updateWorldMatrix(true, false);
    const { shape = 'auto', ...rest } = options;
    for (let i = 0; i < object.count; i++) {
      object.getMatrixAt(i, matrix);
      matrix.premultiply(object.matrixWorld);
      const [at, turn, size] = [new Vector3(), new Quaternion(), new Vector3()];
      matrix.decompose(at, turn, size);
      const shapes = typeof shape === 'string' ? instanceShapes(object, shape, size) : [shape].flat();
      const id = world.addBody({ ...rest, position: at, rotation: turn, shapes });
      this.ids.push(id);
      this.#places.push(world.track(id));
      this.#scales.push(size);
    }
    // Instances move freely, so their bounds are unknown.
    object.frustumCulled = false;
  }

  /**
   * Moves the instances to the bodies' poses.
   * @param {Float32Array} poses
   */
  write(poses) {
    parentFromWorld.copy(this.object.matrixWorld).invert();
    this.#places.forEach((placed, i) => {
      position.fromArray(poses, POSE * placed);
      rotation.fromArray(poses, POSE * placed + 3);
      this.object.setMatrixAt(i, matrix.compose(position, rotation, this.#scales[i]).premultiply(parentFromWorld));
    });
    this.object.instanceMatrix.needsUpdate = true;
  }

  /** Removes the bodies from the world; the instances stay in place. */
  dispose() {
    this.#places.forEach((placed) => this.world.untrack(placed));
    this.ids.filter((id) => this.world.hasBody(id)).forEach((id) => this.world.removeBody(id));
    this.ids = [];
    this.#places = [];
  }
}

/**
 * @param {InstancedMesh} object
 * @param {FittedShape} fitted
 * @param {Vector3} size
 */
function instanceShapes(object, fitted, size) {
  // A mesh of the same geometry at the origin, with the scale of the instance.
  const one = /** @type {any} */ ({
    isMesh: true, geometry: object.geometry, matrixWorld: new Matrix4().makeScale(size.x, size.y, size.z),
    updateWorldMatrix() {}, traverse(/** @type {(part: any) => void} */ visit) { visit(one); }, name: object.name, type: object.type,
  });
  return shapesOf(one, fitted, false);
}
