// Characters that move the bones of three's models.
import { EventDispatcher, Matrix4, Vector3 } from 'three';
import { clone } from 'three/addons/utils/SkeletonUtils.js';
import { CharacterDef } from '../index.js';

/** @import { Object3D } from 'three' */
/** @import { GLTF } from 'three/addons/loaders/GLTFLoader.js' */
/** @import { Character, CharacterDetail, CharacterOptions, CharacterPreset, CharacterState, DriveMode, HoldOptions, PlayOptions, QuatLike, Vec3Like, World } from '../index.js' */

/** Count of numbers per joint in a pose. */
const JOINT = 10;
const matrix = new Matrix4();
const parentFromWorld = new Matrix4();

/**
 * A kind of character: the shared definition, and the scene object of each joint.
 */
class Kind {
  /** @type {Set<Object3D>} Scenes that characters move. */
  inUse = new Set();

  /**
   * @param {GLTF} gltf
   * @param {Uint8Array} bytes
   * @param {CharacterOptions} options
   */
  constructor(gltf, bytes, options) {
    this.gltf = gltf;
    this.def = CharacterDef.load(bytes, options);
    /** @type {Map<number, Object3D>} */
    const byNode = new Map();
    for (const [object, association] of gltf.parser.associations) {
      const node = /** @type {{ nodes?: number }} */ (association ?? {}).nodes;
      const found = /** @type {Object3D} */ (object);
      if (node !== undefined && found.isObject3D && !byNode.has(node)) byNode.set(node, found);
    }
    /** @type {(Object3D | undefined)[]} The object of each joint, of the scene that was loaded. */
    this.objects = Array.from(this.def.nodes, (node) => byNode.get(node));
  }

  /** Returns a scene for one more character, the loaded one or else a copy with its own skeletons, and the scene's objects. */
  scene() {
    const { scene } = this.gltf;
    if (!this.inUse.has(scene)) return { scene, objects: this.objects };
    const copy = clone(scene);
    /** @type {Object3D[][]} */
    const [from, to] = [[], []];
    scene.traverse((object) => from.push(object));
    copy.traverse((object) => to.push(object));
    const copies = new Map(from.map((object, index) => [object, to[index]]));
    return { scene: copy, objects: this.objects.map((object) => object && copies.get(object)) };
  }
}

/** Kinds of characters by the loader's result, so that a definition is built once. */
/** @type {WeakMap<GLTF, Map<string, Kind>>} */
const kinds = new WeakMap();

/**
 * @param {GLTF} gltf
 * @param {ArrayBuffer | Uint8Array} bytes
 * @param {CharacterOptions} options
 */
function kindOf(gltf, bytes, options) {
  const known = kinds.get(gltf) ?? new Map();
  kinds.set(gltf, known);
  const key = JSON.stringify(options, (name, value) => (name === 'files' ? Object.keys(value) : value));
  let kind = known.get(key);
  if (!kind) {
    kind = new Kind(gltf, bytes instanceof Uint8Array ? bytes : new Uint8Array(bytes), options);
    // A scene used by characters of another definition counts as in use.
    for (const other of known.values()) kind.inUse = other.inUse;
    known.set(key, kind);
  }
  return kind;
}

/**
 * Options of a character: its pose, and how its definition is built.
 * @typedef {CharacterOptions & { position?: Vec3Like, rotation?: QuatLike }} SinewCharacterOptions
 */

/**
 * A character that moves a model loaded by three's loader. Add `object` to your scene.
 *
 * Events have the names of `CharacterEvent`: `limp`, `landed`, `settled`, `gettingUp`, `up`, `struck`, `flinched`, `clip` and others.
 * @extends {EventDispatcher<Record<string, any>>}
 */
export class SinewCharacter extends EventDispatcher {
  #kind;
  #position = new Vector3();
  #wasCulled = /** @type {Map<Object3D, boolean>} */ (new Map());

  /**
   * @param {World} world
   * @param {GLTF} gltf
   * @param {ArrayBuffer | Uint8Array} bytes
   * @param {SinewCharacterOptions} options
   */
  constructor(world, gltf, bytes, { position, rotation, ...options }) {
    super();
    this.#kind = kindOf(gltf, bytes, options);
    const { scene, objects } = this.#kind.scene();
    /** The character in the world of bodies, with all its calls. @type {Character} */
    this.core = world.spawn(this.#kind.def, position, rotation);
    /** Root of its model. @type {Object3D} */
    this.object = scene;
    /** Objects of the joints, in the order of poses; `undefined` for joints that are no node. */
    this.joints = objects;
    this.#kind.inUse.add(scene);
    this.#take(gltf);
  }

  /**
   * Takes control of the model: physics sets the root's matrix, and other animation is disabled.
   * @param {GLTF} gltf
   */
  #take(gltf) {
    this.object.matrixAutoUpdate = false;
    this.object.traverse((part) => {
      if (/** @type {{ isSkinnedMesh?: boolean }} */ (part).isSkinnedMesh) {
        // The bounds were computed only for the first pose, so culling is off.
        this.#wasCulled.set(part, part.frustumCulled);
        part.frustumCulled = false;
      }
    });
    const vrm = gltf.userData?.vrm;
    if (vrm && gltf.scene === this.object) {
      // `vrm.update` then moves only faces and eyes: physics moves bones and hair.
      if (vrm.humanoid) vrm.humanoid.autoUpdateHumanBones = false;
      vrm.springBoneManager = undefined;
    }
  }

  /** Moves the bones to their poses in the physics. */
  write() {
    const { pose } = this.core;
    const { joints } = this;
    for (let i = 0; i < joints.length; i++) {
      const joint = joints[i];
      if (!joint) continue;
      const at = JOINT * i;
      joint.position.fromArray(pose, at);
      joint.quaternion.fromArray(pose, at + 3);
      joint.scale.fromArray(pose, at + 7);
    }
    matrix.fromArray(pose, JOINT * joints.length);
    const { parent } = this.object;
    if (parent && parent.parent) {
      parent.updateWorldMatrix(true, false);
      matrix.premultiply(parentFromWorld.copy(parent.matrixWorld).invert());
    }
    this.object.matrix.copy(matrix);
    this.object.matrixWorldNeedsUpdate = true;
  }

  /** Position of the first body, the pelvis of a human, in the world; for cameras that follow the character. The vector is the character's own. */
  get position() {
    const joint = this.joints[this.#kind.def.boneJoints[0]];
    return (joint ?? this.object).getWorldPosition(this.#position);
  }

  /** State, which determines the source of the pose. @returns {CharacterState} */
  get state() {
    return this.core.state;
  }

  /** Kind of the character, with its names and sizes. */
  get def() {
    return this.#kind.def;
  }

  /** Assumptions about the file, and chosen clips, one sentence each. */
  get notes() {
    return this.#kind.def.notes;
  }

  /** Names of the bodies for `hit`, `hold` and others. */
  get bones() {
    return this.#kind.def.bones;
  }

  /** Names of the clips that `play` accepts. */
  get clips() {
    return this.#kind.def.clips;
  }

  /** Height, metres. */
  get height() {
    return this.#kind.def.height;
  }

  /** Mass, kg. */
  get mass() {
    return this.#kind.def.mass;
  }

  /**
   * Hits a body, given by role or bone, with an impulse, N·s. The character falls, or flinches if the hit is weak.
   * @param {string} bone
   * @param {Vec3Like} impulse
   */
  hit(bone, impulse) {
    this.core.hit(bone, impulse);
  }

  /** Makes the character limp at its present pose and velocity. */
  goLimp() {
    this.core.goLimp();
  }

  /**
   * Sets the velocity over the ground, m/s, and turns the character in that direction.
   * @param {Vec3Like} velocity
   */
  move(velocity) {
    this.core.setMove(velocity);
    this.core.face(velocity);
  }

  /** Makes the character stand, by its idle clip, until it moves again. */
  stand() {
    this.core.setMove([0, 0, 0]);
  }

  /** Makes the character follow its clips, as at the start. */
  followClips() {
    this.core.followClips();
  }

  /** Makes the character jump, if it is on the ground. */
  jump() {
    this.core.jump();
  }

  /**
   * Plays one of the character's clips.
   * @param {string} clip
   * @param {PlayOptions} [options]
   */
  play(clip, options) {
    this.core.play(clip, options);
  }

  /**
   * Drives the whole character by clips, by muscles toward its clips, or not at all.
   * @param {CharacterPreset} preset
   */
  setPreset(preset) {
    this.core.setPreset(preset);
  }

  /**
   * Changes the drive of a body, or with `below` of all its descendants.
   * @param {string | undefined} bone
   * @param {DriveMode} mode
   * @param {{ below?: boolean, halfLife?: number }} [options]
   */
  setDrive(bone, mode, { below, halfLife } = {}) {
    this.core.setDrive(bone, mode, below, halfLife);
  }

  /**
   * Makes a hand, or any body by role or bone, hold a body of the world, which is moved there.
   * @param {string} bone
   * @param {{ id: bigint } | bigint} held
   * @param {HoldOptions} [options]
   */
  hold(bone, held, options) {
    this.core.hold(bone, typeof held === 'bigint' ? held : held.id, options);
  }

  /**
   * Releases a held body.
   * @param {{ id: bigint } | bigint} held
   */
  release(held) {
    return this.core.release(typeof held === 'bigint' ? held : held.id);
  }

  /**
   * Teleports the character.
   * @param {Vec3Like} position
   * @param {QuatLike} [rotation]
   */
  teleport(position, rotation) {
    this.core.teleport(position, rotation);
  }

  /**
   * Lowers the level of detail of the character in the distance.
   * @param {CharacterDetail} detail
   */
  setDetail(detail) {
    this.core.setDetail(detail);
  }

  /** Removes the character from the world, and its model from the scene. */
  dispose() {
    this.core.remove();
    this.core.free();
    this.#kind.inUse.delete(this.object);
    this.#wasCulled.forEach((was, part) => { part.frustumCulled = was; });
    this.object.matrixAutoUpdate = true;
    this.object.removeFromParent();
    if (this.object !== this.#kind.gltf.scene) {
      // A copy shares geometry and materials, but has its own skeletons.
      this.object.traverse((part) => /** @type {any} */ (part).skeleton?.dispose());
    }
  }
}
