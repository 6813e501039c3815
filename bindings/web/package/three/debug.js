// Draws shapes, joints and contacts as lines.
import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments } from 'three';

/** @import { World } from '../index.js' */

/** Draws shapes, joints and contacts: add it to the scene. It costs no time while it is invisible. */
export class SinewDebug extends LineSegments {
  /** @param {World} world */
  constructor(world) {
    super(new BufferGeometry(), new LineBasicMaterial({ vertexColors: true, depthTest: false, transparent: true }));
    this.world = world;
    this.frustumCulled = false;
    this.renderOrder = 1;
  }

  /** Reads the lines of the present state; `Sinew.update` calls this method. */
  update() {
    if (!this.visible) return;
    const { positions, colors } = this.world.debugLines();
    for (const [name, numbers] of /** @type {const} */ ([['position', positions], ['color', colors]])) {
      let attribute = /** @type {BufferAttribute | undefined} */ (this.geometry.getAttribute(name));
      if (!attribute || attribute.array.length < numbers.length) {
        // Reserves half more, so that a few more bodies need no new buffer.
        attribute = new BufferAttribute(new Float32Array(3 * Math.ceil(numbers.length / 2)), 3);
        this.geometry.setAttribute(name, attribute);
      }
      attribute.array.set(numbers);
      attribute.needsUpdate = true;
    }
    this.geometry.setDrawRange(0, positions.length / 3);
  }

  /** Frees geometry and material. */
  dispose() {
    this.removeFromParent();
    this.geometry.dispose();
    /** @type {LineBasicMaterial} */ (this.material).dispose();
  }
}
