// Characters that move the bones of three's models.
import { EventDispatcher, Matrix4, Vector3 } from 'three';
import { clone } from 'three/addons/utils/SkeletonUtils.js';
import { CharacterDef } from '../index.js';

/** @import { Object3D } from 'three' */
/** @import { GLTF } from 'three/addons/loaders/GLTFLoader.js' */
/** @import { Character, CharacterDetail, CharacterOptions, CharacterPreset, CharacterState, DriveMode, HoldOptions, PlayOptions, QuatLike, Vec3Like, World } from '../index.js' */

/** Numbers of a joint in a pose. */
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

  /** A scene for one more character: the one that was loaded, else a copy with a skeleton of its own; and its objects. */
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

/** Kinds by what the loader gave, so that a definition is built once. */
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
 * A character that moves a model which three's loader has loaded. Add `object` to your scene.
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
    /** Objects of its joints, in the order of poses; `undefined` of joints that are no node. */
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
        // Its bounds were computed for its first pose only, so culling is off.
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

  /** Moves the bones to where the physics has them. */
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

  /** Where its first body is, the pelvis of a human, in the world: for cameras that follow it. The vector is the character's own. */
  get position() {
    const joint = this.joints[this.#kind.def.boneJoints[0]];
    return (joint ?? this.object).getWorldPosition(this.#position);
  }

  /** What decides its pose. @returns {CharacterState} */
  get state() {
    return this.core.state;
  }

  /** Its kind, with the names and sizes of all that it has. */
  get def() {
    return this.#kind.def;
  }

  /** Assumptions about the file, and the clips that were chosen, one sentence each. */
  get notes() {
    return this.#kind.def.notes;
  }

  /** Names of its bodies, by which `hit`, `hold` and others know them. */
  get bones() {
    return this.#kind.def.bones;
  }

  /** Names of the clips that `play` accepts. */
  get clips() {
    return this.#kind.def.clips;
  }

  /** Metres. */
  get height() {
    return this.#kind.def.height;
  }

  /** kg. */
  get mass() {
    return this.#kind.def.mass;
  }

  /**
   * Hits a body, by role or bone, with an impulse, N·s: it falls, or flinches if the hit is weak.
   * @param {string} bone
   * @param {Vec3Like} impulse
   */
  hit(bone, impulse) {
    this.core.hit(bone, impulse);
  }

  /** Lets its bodies take over, at the pose and the speed that it has. */
  goLimp() {
    this.core.goLimp();
  }

  /**
   * Makes it move at a velocity over the ground, m/s, and face that way.
   * @param {Vec3Like} velocity
   */
  move(velocity) {
    this.core.setMove(velocity);
    this.core.face(velocity);
  }

  /** Has it stand, by its idle clip, until it is to move. */
  stand() {
    this.core.setMove([0, 0, 0]);
  }

  /** Has it go as its clips go, which it does to begin with. */
  followClips() {
    this.core.followClips();
  }

  /** Has it jump, if it has ground. */
  jump() {
    this.core.jump();
  }

  /**
   * Plays one of its clips.
   * @param {string} clip
   * @param {PlayOptions} [options]
   */
  play(clip, options) {
    this.core.play(clip, options);
  }

  /**
   * Drives all of it by clips, by muscles toward its clips, or not at all.
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
   * Teleports it.
   * @param {Vec3Like} position
   * @param {QuatLike} [rotation]
   */
  teleport(position, rotation) {
    this.core.teleport(position, rotation);
  }

  /**
   * Lowers its level of detail in the distance.
   * @param {CharacterDetail} detail
   */
  setDetail(detail) {
    this.core.setDetail(detail);
  }

  /** Takes it out of the world, and its model out of the scene. */
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
