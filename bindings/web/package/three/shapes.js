// Shapes of three's objects.
import { Matrix4, Quaternion, Vector3 } from 'three';

/** @import { BufferGeometry, Mesh, Object3D } from 'three' */
/** @import { Geometry, ShapeOptions } from '../index.js' */

/**
 * Name of a shape fitted to an object: `auto` is a box, sphere, capsule, cylinder or cone for three's geometry of that
 * kind, else a hull, or for a static body a mesh.
 * @typedef {'auto' | 'box' | 'sphere' | 'capsule' | 'cylinder' | 'cone' | 'hull' | 'mesh'} FittedShape
 */

/** Largest relative difference of the three scales of a round shape. */
const ROUND = 1e-3;

/**
 * True if an object is a mesh with triangles.
 * @param {Object3D} object
 * @returns {object is Mesh}
 */
export function isMesh(object) {
  return /** @type {Mesh} */ (object).isMesh === true && /** @type {Mesh} */ (object).geometry.attributes.position !== undefined;
}

/**
 * Returns the pose of an object in the world, and its scale.
 * @param {Object3D} object
 */
export function worldPose(object) {
  object.updateWorldMatrix(true, false);
  const [position, rotation, scale] = [new Vector3(), new Quaternion(), new Vector3()];
  object.matrixWorld.decompose(position, rotation, scale);
  return { position, rotation, scale };
}

/**
 * Returns the shapes of an object and all its descendants, in the frame of a body at the object's pose without scale.
 * @param {Object3D} object
 * @param {FittedShape} fitted
 * @param {boolean} isStatic
 * @returns {ShapeOptions[]}
 */
export function shapesOf(object, fitted, isStatic) {
  const { position, rotation } = worldPose(object);
  const bodyFromWorld = new Matrix4().compose(position, rotation, new Vector3(1, 1, 1)).invert();
  /** @type {ShapeOptions[]} */
  const shapes = [];
  object.updateWorldMatrix(false, true);
  object.traverse((part) => {
    if (isMesh(part)) shapes.push(shapeOf(part, bodyFromWorld.clone().multiply(part.matrixWorld), fitted, isStatic));
  });
  if (shapes.length === 0) throw new Error(`'${object.name || object.type}' has no mesh to take a shape from`);
  return shapes;
}

/**
 * @param {Mesh} mesh
 * @param {Matrix4} bodyFromMesh
 * @param {FittedShape} fitted
 * @param {boolean} isStatic
 * @returns {ShapeOptions}
 */
function shapeOf(mesh, bodyFromMesh, fitted, isStatic) {
  const [position, rotation, scale] = [new Vector3(), new Quaternion(), new Vector3()];
  bodyFromMesh.decompose(position, rotation, scale);
  const own = fitted === 'auto' ? ownShape(mesh.geometry, scale) : fittedShape(mesh.geometry, fitted, scale);
  if (own) {
    const center = own.center.multiply(scale).applyQuaternion(rotation);
    return { ...own.shape, position: position.add(center), rotation };
  }
  const vertices = transformed(mesh.geometry, bodyFromMesh);
  if (fitted === 'mesh' || (fitted === 'auto' && isStatic)) {
    return { type: 'mesh', vertices, indices: indicesOf(mesh.geometry, bodyFromMesh.determinant() < 0) };
  }
  return { type: 'hull', points: vertices };
}

/** @typedef {{ shape: Geometry, center: Vector3 }} Fitted */

/**
 * Returns the shape of one of three's own geometries, if scaling keeps its kind.
 * @param {BufferGeometry} geometry
 * @param {Vector3} scale
 * @returns {Fitted | undefined}
 */
function ownShape(geometry, scale) {
  const { type } = geometry;
  const size = /** @type {any} */ (geometry).parameters ?? {};
  const isRound = Math.abs(scale.x / scale.z - 1) < ROUND;
  const isEven = isRound && Math.abs(scale.x / scale.y - 1) < ROUND;
  const center = new Vector3();
  if (type === 'BoxGeometry') return fittedShape(geometry, 'box', scale);
  if (type === 'SphereGeometry' && isEven) return { shape: { type: 'sphere', radius: size.radius * scale.x }, center };
  if (type === 'CapsuleGeometry' && isEven) {
    const length = size.height ?? size.length;
    return { shape: { type: 'capsule', halfHeight: 0.5 * length * scale.x, radius: size.radius * scale.x }, center };
  }
  if (type === 'CylinderGeometry' && isRound && size.radiusTop === size.radiusBottom) {
    return { shape: { type: 'cylinder', halfHeight: 0.5 * size.height * scale.y, radius: size.radiusTop * scale.x }, center };
  }
  if (type === 'ConeGeometry' && isRound) {
    return { shape: { type: 'cone', halfHeight: 0.5 * size.height * scale.y, radius: size.radius * scale.x }, center };
  }
  return undefined;
}

/**
 * Returns a shape around the bounds of a geometry.
 * @param {BufferGeometry} geometry
 * @param {FittedShape} fitted
 * @param {Vector3} scale
 * @returns {Fitted | undefined}
 */
function fittedShape(geometry, fitted, scale) {
  if (!['box', 'sphere', 'capsule', 'cylinder', 'cone'].includes(fitted)) return undefined;
  if (!geometry.boundingBox) geometry.computeBoundingBox();
  const bounds = geometry.boundingBox;
  if (!bounds) return undefined;
  const center = bounds.getCenter(new Vector3());
  const half = bounds.getSize(new Vector3()).multiplyScalar(0.5).multiply(scale);
  half.set(Math.abs(half.x), Math.abs(half.y), Math.abs(half.z));
  const radius = Math.max(half.x, half.z);
  switch (fitted) {
    case 'box': return { shape: { type: 'box', halfExtents: half }, center };
    case 'sphere': return { shape: { type: 'sphere', radius: Math.max(radius, half.y) }, center };
    case 'capsule': return { shape: { type: 'capsule', halfHeight: Math.max(half.y - radius, 0), radius }, center };
    case 'cylinder': return { shape: { type: 'cylinder', halfHeight: half.y, radius }, center };
    default: return { shape: { type: 'cone', halfHeight: half.y, radius }, center };
  }
}

/**
 * Returns the vertices of a geometry in another frame.
 * @param {BufferGeometry} geometry
 * @param {Matrix4} matrix
 */
function transformed(geometry, matrix) {
  const places = geometry.attributes.position;
  const out = new Float32Array(3 * places.count);
  const place = new Vector3();
  for (let i = 0; i < places.count; i++) place.fromBufferAttribute(places, i).applyMatrix4(matrix).toArray(out, 3 * i);
  return out;
}

/**
 * Returns the triangles; those of a mirrored mesh are reversed.
 * @param {BufferGeometry} geometry
 * @param {boolean} isMirrored
 */
function indicesOf(geometry, isMirrored) {
  const { index } = geometry;
  const indices = index ? Uint32Array.from(index.array) : Uint32Array.from({ length: geometry.attributes.position.count }, (_, i) => i);
  if (isMirrored) {
    for (let i = 0; i + 2 < indices.length; i += 3) [indices[i], indices[i + 1]] = [indices[i + 1], indices[i]];
  }
  return indices;
}
