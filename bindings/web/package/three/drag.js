// Dragging with the pointer.
import { Plane, Raycaster, Vector2, Vector3 } from 'three';

/** @import { Camera } from 'three' */
/** @import { GrabOptions, GrabPoint } from '../index.js' */
/** @import { Sinew } from '../three.js' */

/**
 * Lets the pointer drag bodies and limbs by a spring with a bounded force. A character that clips move goes limp when it is taken hold of. The
 * pointer's events reach nobody else while something is dragged, so that controls of the camera rest.
 */
export class SinewDrag {
  #raycaster = new Raycaster();
  #plane = new Plane();
  #pointer = new Vector2();
  #target = new Vector3();
  /** @type {GrabPoint | undefined} */
  #grab;
  /** @type {number | undefined} */
  #pointerId;

  /**
   * @param {Sinew} physics
   * @param {Camera} camera
   * @param {HTMLElement} element The canvas.
   * @param {GrabOptions} options
   */
  constructor(physics, camera, element, options) {
    this.physics = physics;
    this.camera = camera;
    this.element = element;
    this.options = options;
    /** False: the pointer drags nothing. */
    this.enabled = true;
    element.addEventListener('pointerdown', this.#down, { capture: true });
    element.addEventListener('pointermove', this.#move, { capture: true });
    element.addEventListener('pointerup', this.#up, { capture: true });
    element.addEventListener('pointercancel', this.#up, { capture: true });
  }

  /** True while something is dragged. */
  get isDragging() {
    return this.#grab !== undefined;
  }

  /** @param {PointerEvent} event */
  #aim(event) {
    const bounds = this.element.getBoundingClientRect();
    const x = (event.clientX - bounds.left) / bounds.width;
    const y = (event.clientY - bounds.top) / bounds.height;
    this.#raycaster.setFromCamera(this.#pointer.set(2 * x - 1, 1 - 2 * y), this.camera);
    return this.#raycaster.ray;
  }

  #down = (/** @type {PointerEvent} */ event) => {
    if (!this.enabled || this.#grab || event.button !== 0) return;
    const ray = this.#aim(event);
    const hit = this.physics.pick(ray);
    if (!hit) return;
    const limp = hit.character && ['animated', 'flinching', 'gettingUp'].includes(hit.character.state);
    if (limp) hit.character?.goLimp();
    // A character that went limp has other bodies.
    const body = hit.character && hit.bone ? hit.character.core.body(hit.bone) : hit.body;
    this.#grab = body === undefined ? undefined : this.physics.world.grab(body, hit.point, this.options);
    if (!this.#grab) return;
    this.#plane.setFromNormalAndCoplanarPoint(this.camera.getWorldDirection(this.#target), hit.point);
    this.#pointerId = event.pointerId;
    this.element.setPointerCapture?.(event.pointerId);
    event.stopImmediatePropagation();
  };

  #move = (/** @type {PointerEvent} */ event) => {
    if (!this.#grab || event.pointerId !== this.#pointerId) return;
    if (!this.#grab.holds) return this.#release();
    const target = this.#aim(event).intersectPlane(this.#plane, this.#target);
    if (target) this.#grab.setTarget(target);
    event.stopImmediatePropagation();
  };

  #up = (/** @type {PointerEvent} */ event) => {
    if (!this.#grab || event.pointerId !== this.#pointerId) return;
    this.#release();
    event.stopImmediatePropagation();
  };

  #release() {
    this.#grab?.release();
    this.#grab?.free();
    this.#grab = undefined;
  }

  /** Lets go and listens no more. */
  dispose() {
    this.#release();
    for (const [type, listener] of /** @type {const} */ ([
      ['pointerdown', this.#down], ['pointermove', this.#move], ['pointerup', this.#up], ['pointercancel', this.#up],
    ])) this.element.removeEventListener(type, listener, { capture: true });
  }
}
