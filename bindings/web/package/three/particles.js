// Cloth, soft balls and ropes as geometries of three.
import { BufferAttribute, BufferGeometry, DynamicDrawUsage } from 'three';

/** @import { Particles } from '../index.js' */

/** Geometry of particles: the surface of cloth and soft balls, the line of a rope. Use it in a `Mesh` or a `Line`, with frustum culling off. */
export class SinewGeometry extends BufferGeometry {
  /** @param {Particles} particles */
  constructor(particles) {
    super();
    /** Particles in the world, with all their methods. */
    this.particles = particles;
    this.setAttribute('position', new BufferAttribute(new Float32Array(particles.positions), 3).setUsage(DynamicDrawUsage));
    const { triangles } = particles;
    this.isSurface = triangles.length > 0;
    if (this.isSurface) {
      this.setIndex(new BufferAttribute(triangles, 1));
      this.computeVertexNormals();
    }
  }

  /** Reads the present positions; `Sinew.update` calls this method. */
  write() {
    const { position } = this.attributes;
    /** @type {Float32Array} */ (position.array).set(this.particles.positions);
    position.needsUpdate = true;
    if (this.isSurface) this.computeVertexNormals();
  }

  /** Removes the particles from the world and frees the geometry. */
  dispose() {
    super.dispose();
    this.particles.remove();
    this.particles.free();
  }
}
